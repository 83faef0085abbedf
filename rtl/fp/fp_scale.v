// fp_scale: twice or half of a number, without a multiplier.
//
// Purpose   The same bits and flags as a product with 2 or 1/2. Only the exponent changes, unless
//           the result is not a normal number.
// Latency   0, or 1 with CUTS.
// Options   SUBNORMAL = 0 and NEAREST = 0 as in fp_mul.
// Promise   With neither twice_i nor half_i, z_o is d_i, bit by bit, and no flag rises: a subnormal
//           passes even with SUBNORMAL = 0, where the adder behind reads it as zero.
//           A NaN passes unchanged: the adder behind makes it quiet, and raises invalid for a
//           signalling one as a product would.
//           Proved for every number and option: tests/formal/scale_cases.v.
// Hazard    Never twice_i and half_i together (shared_arith checks it).
//
//     d_i 00800001, half_i 1  ->  z_o 00400000 (a tie, to even), flags_o underflow, inexact
`default_nettype none
module fp_scale #(
    parameter EXP        = 8,
    parameter FRAC       = 23,
    parameter SUBNORMAL  = 1,
    parameter NEAREST    = 1,
    parameter [0:0] CUTS = 1'b0        // a register between what kind of number it is and the result
) (
    input  wire              clk_i,
    input  wire              twice_i,  // times 2
    input  wire              half_i,   // times 1/2; neither: as it is
    input  wire [EXP+FRAC:0] d_i,
    output wire [EXP+FRAC:0] z_o,
    output wire [4:0]        flags_o   // {NV, DZ, OF, UF, NX}
);
    localparam [EXP-1:0] ONE = 1;
    wire [EXP-1:0] e       = d_i[EXP+FRAC-1:FRAC];
    wire           top     = &e;                          // infinity or NaN
    wire           low     = e == {EXP{1'b0}};            // zero or subnormal
    wire           double  = twice_i && !top;
    wire           halve   = half_i && !top;
    wire [EXP-1:0] next    = double ? e + 1'b1 : halve ? e - 1'b1 : e;
    wire           over    = double && e == {{EXP-1{1'b1}}, 1'b0};
    wire           up      = double && low;
    wire           down    = halve && (low || e == ONE);  // is or becomes subnormal
    wire           flushed = SUBNORMAL == 0 && (down || up);

    wire            sign_1, low_1, over_1, up_1, down_1, flushed_1;
    wire [EXP-1:0]  next_1;
    wire [FRAC-1:0] f;
    cut #(.W(EXP+FRAC+6), .ON(CUTS[0])) u_0 (.clk_i(clk_i),
        .d_i({low, over, up, down, flushed, d_i[EXP+FRAC], next, d_i[FRAC-1:0]}),
        .q_o({low_1, over_1, up_1, down_1, flushed_1, sign_1, next_1, f}));

    // Twice: a subnormal's fraction moves, its top bit into the exponent; the largest overflow.
    wire [EXP+FRAC-1:0] moved_up = {{EXP-1{1'b0}}, f, 1'b0};
    wire [EXP+FRAC-1:0] most     = NEAREST != 0 ? {{EXP{1'b1}}, {FRAC{1'b0}}} : {{EXP-1{1'b1}}, 1'b0, {FRAC{1'b1}}};

    // Half: what is or becomes subnormal moves and is rounded.
    wire [FRAC:0] moved = {1'b0, !low_1, f[FRAC-1:1]};
    wire          round = NEAREST != 0 && f[0] && f[1];
    wire [FRAC:0] tiny  = moved + {{FRAC{1'b0}}, round};

    wire [EXP+FRAC-1:0] z = flushed_1 ? {EXP+FRAC{1'b0}} : over_1 ? most : up_1 ? moved_up
                          : down_1 ? {{EXP-1{1'b0}}, tiny} : {next_1, f};
    wire uf = down_1 && (SUBNORMAL != 0 ? f[0] : !low_1);
    assign z_o     = {sign_1, z};
    assign flags_o = {2'b00, over_1, uf, over_1 || uf};
endmodule
`default_nettype wire
