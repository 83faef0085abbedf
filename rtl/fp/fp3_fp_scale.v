// SPDX-License-Identifier: Apache-2.0
// fp3_fp_scale: twice or half of a number, without a multiplier.
//
// Purpose   The same bits and flags as a product with 2 or 1/2. Only the exponent changes, unless
//           the result is not a normal number.
// Latency   0, or 1 with CUTS.
// Options   SUBNORMAL = 0, NEAREST = 0 and FINITE = 1 as in fp_mul. SUM_LAST = 1: the same bits,
//           the result comes out of an adder.
// Promise   With neither twice_i nor halve_i, z_o is d_i, bit by bit, and no flag rises: a subnormal
//           passes even with SUBNORMAL = 0, where the adder behind reads it as zero.
//           A NaN passes unchanged: the adder behind makes it quiet, and raises invalid for a
//           signalling one as a product would.
//           Proved for every number and option: tests/formal/scale_cases.v.
// Hazard    Never twice_i and halve_i together (shared_arith checks it).
//
//     d_i 00800001, halve_i 1  ->  z_o 00400000 (a tie, to even), flags_o underflow, inexact
`default_nettype none
module fp3_fp_scale #(
    parameter EXP        = 8,
    parameter FRAC       = 23,
    parameter SUBNORMAL  = 1,
    parameter NEAREST    = 1,
    parameter FINITE     = 0,
    parameter SUM_LAST   = 0,          // 1: nothing is chosen behind the sum, so that a register may be in its cells; slower without CUTS
    parameter [0:0] CUTS = 1'b0        // a register between what kind of number it is and the result
) (
    input  wire              clk_i,
    input  wire              twice_i,  // times 2
    input  wire              halve_i,   // times 1/2; neither: as it is
    input  wire [EXP+FRAC:0] d_i,
    output wire [EXP+FRAC:0] z_o,
    output wire [4:0]        flags_o   // {NV, DZ, OF, UF, NX}
);
    localparam [EXP-1:0] ONE = 1;
    localparam [1:0] SAME = 2'd0, MOVED = 2'd1, OVER = 2'd2, ZERO = 2'd3;       // what the fraction becomes

    wire [EXP-1:0] e       = d_i[EXP+FRAC-1:FRAC];
    wire           top     = FINITE == 0 && &e;         // infinity or NaN
    wire           low     = e == {EXP{1'b0}};            // zero or subnormal
    wire           over    = twice_i && e == {{EXP-1{1'b1}}, FINITE != 0};
    wire           up      = twice_i && low;
    wire           down    = halve_i && (low || e == ONE); // is or becomes subnormal
    wire [1:0]     kind    = over ? OVER : SUBNORMAL == 0 && (down || up) ? ZERO : down ? MOVED : SAME;
    wire [EXP-1:0] next;                                  // the exponent of a normal number moves by one
    generate
        if (SUM_LAST != 0) begin : g_one_sum
            wire unused_carry;
            assign {next, unused_carry} = {e, 1'b1} + {{EXP{halve_i}}, twice_i};
        end else begin : g_two_sums
            assign next = top ? e : twice_i ? e + 1'b1 : halve_i ? e - 1'b1 : e;
        end
    endgenerate

    wire            sign_1, top_1, low_1, up_1, tie;
    wire [1:0]      kind_1;
    wire [EXP-1:0]  next_1;
    wire [FRAC-1:0] f;
    fp3_cut #(.W(EXP+FRAC+7), .ON(CUTS[0])) u_0 (.clk_i(clk_i),
        .d_i({top, low, up && SUBNORMAL != 0, kind, d_i[EXP+FRAC], &d_i[1:0], next, d_i[FRAC-1:0]}),
        .q_o({top_1, low_1, up_1, kind_1, sign_1, tie, next_1, f}));

    // Twice a subnormal is f + f; half of a number is rounded up where two ones would be cut.
    wire [FRAC-1:0] moved = {!low_1, f[FRAC-1:1]};
    wire            round = NEAREST != 0 && tie;
    wire [EXP+FRAC-1:0] z;
    generate
        if (SUM_LAST != 0) begin : g_sum_last
            reg [FRAC-1:0] x;
            always @* case (kind_1)
                SAME:    x = f;
                MOVED:   x = moved;
                OVER:    x = {FRAC{NEAREST == 0}};
                default: x = {FRAC{1'b0}};
            endcase
            wire [FRAC-1:0] more = {f[FRAC-1:1] & {FRAC-1{up_1}}, up_1 ? f[0] : round && kind_1 == MOVED};
            wire           lesser = NEAREST == 0 && kind_1 == OVER && FINITE == 0;     // the largest finite number
            wire           ones   = top_1 || (FINITE != 0 && kind_1 == OVER);
            wire [EXP-1:0] y = ones ? {EXP{1'b1}} : low_1 ? {EXP{1'b0}} : {next_1[EXP-1:1], next_1[0] && !lesser};
            assign z = {y, x} + {{EXP{1'b0}}, more};
        end else begin : g_choice_last
            wire [FRAC:0]       tiny = {1'b0, moved} + {{FRAC{1'b0}}, round};
            wire [EXP+FRAC-1:0] most = NEAREST != 0 ? {{EXP{1'b1}}, {FRAC{1'b0}}} : {{EXP-1{1'b1}}, FINITE != 0, {FRAC{1'b1}}};
            assign z = kind_1 == ZERO ? {EXP+FRAC{1'b0}} : kind_1 == OVER ? most : up_1 ? {{EXP-1{1'b0}}, f, 1'b0}
                     : kind_1 == MOVED ? {{EXP-1{1'b0}}, tiny} : {next_1, f};
            wire unused = top_1;
        end
    endgenerate

    wire is_over = kind_1 == OVER;
    wire uf      = SUBNORMAL != 0 ? kind_1 == MOVED && f[0] : kind_1 == ZERO && !low_1;
    assign z_o     = {sign_1 && !(FINITE != 0 && kind_1 == ZERO), z};
    assign flags_o = {2'b00, is_over, uf, is_over || uf};
endmodule
`default_nettype wire
