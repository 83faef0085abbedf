// fp_bench: the floating-point cores in every form that the tests look at, side by side.
//
// Purpose   Row r is one adder, one multiplier and one fused multiply-add of the same format, mode and cuts:
//             0..3  4-bit exponent, 3-bit fraction: truncate flushed, nearest flushed,
//                   truncate gradual, nearest gradual
//             4     the same format, without infinities: Cell's arithmetic
//             5     binary16, 6 binary32 in Cell's arithmetic, 7 binary32, uncut
//             8..   binary32 with the cuts that named configurations have, each pair of masks once
//           Unit 3r is the adder of row r, unit 3r+1 its multiplier, unit 3r+2 the fused multiply-add, which has the
//           adder's cuts behind the multiplier's first four. Cell's arithmetic has no fused multiply-add: in rows 4 and 6
//           that unit has infinities, truncates and flushes, and no test looks at it.
// Latency   Operand register, core, result register: popcount(cuts) + 2 edges of the unit's clock.
// Hazard    Each unit has a clock and registers of its own, so that a simulator pays only for the
//           unit under test; results of units whose clock stands still are stale.
//
//     clk_i[22] rises twice with a_i, b_i held: z_o[32*22 +: 32] is a * b in binary32.
//     info_o[32*u +: 32] = {0, exponent width, fraction width, subnormal, nearest, finite, cuts} of unit u.
`default_nettype none
module fp_bench (clk_i, sub_i, a_i, b_i, c_i, z_o, flags_o, info_o);
    `include "configs.vh"
    parameter  ONLY = -1;                        // a row: the others have no cores, for quick builds
    localparam UNITS = 3 * (8 + CUT_PAIRS);

    input  wire [UNITS-1:0]    clk_i;
    input  wire                sub_i;            // adders subtract, c - a * b
    input  wire [31:0]         a_i, b_i, c_i;    // right-aligned; c + a * b
    output wire [32*UNITS-1:0] z_o;
    output wire [32*UNITS-1:0] flags_o;          // {NV, DZ, OF, UF, NX} in the low bits
    output wire [32*UNITS-1:0] info_o;

    genvar u;
    generate
        for (u = 0; u < UNITS; u = u + 1) begin : g_unit
            localparam ROW       = u / 3;
            localparam OP        = u % 3;
            localparam EXP       = ROW < 5 ? 4 : ROW == 5 ? 5 : 8;
            localparam FRAC      = ROW < 5 ? 3 : ROW == 5 ? 10 : 23;
            localparam FINITE    = ROW == 4 || ROW == 6 ? 1 : 0;
            localparam SUBNORMAL = FINITE != 0 ? 0 : ROW < 4 ? ROW / 2 : 1;
            localparam NEAREST   = FINITE != 0 ? 0 : ROW < 4 ? ROW % 2 : 1;
            localparam PAIR      = ROW < 8 ? 0 : ROW - 8;
            localparam [6:0]  ADD  = ROW < 8 ? 7'd0 : ADD_CUTS[7*PAIR +: 7];
            localparam [6:0]  MUL  = ROW < 8 ? 7'd0 : MUL_CUTS[7*PAIR +: 7];
            localparam [10:0] CUTS = OP == 0 ? {4'd0, ADD} : OP == 1 ? {4'd0, MUL} : {ADD, MUL[3:0]};
            localparam W = 1 + EXP + FRAC;

            reg          sub_q;
            reg  [W-1:0] a_q, b_q, z_q;
            reg  [4:0]   flags_q;
            wire [W-1:0] z;
            wire [4:0]   flags;

            always @(posedge clk_i[u]) begin
                sub_q   <= sub_i;
                a_q     <= a_i[W-1:0];
                b_q     <= b_i[W-1:0];
                z_q     <= z;
                flags_q <= flags;
            end

            if (ONLY >= 0 && ONLY != ROW) begin : g_none
                wire unused = sub_q;
                assign z     = a_q ^ b_q;
                assign flags = 5'd0;
            end else if (OP == 2) begin : g_fma
                // c waits for the product.
                localparam N = {31'd0, CUTS[0]} + {31'd0, CUTS[1]} + {31'd0, CUTS[2]} + {31'd0, CUTS[3]};
                reg  [W-1:0] c_q;
                wire [W-1:0] c;
                wire         sub;
                always @(posedge clk_i[u]) c_q <= c_i[W-1:0];
                fp3_delay #(.W(W+1), .N(N)) u_c (.clk_i(clk_i[u]), .rst_i(1'b0), .d_i({sub_q, c_q}), .q_o({sub, c}));
                fp3_fp_fma #(.EXP(EXP), .FRAC(FRAC), .SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .CUTS(CUTS))
                    u_fma (.clk_i(clk_i[u]), .x_i(a_q), .y_i(b_q), .no_product_i(1'b0), .subtract_i(sub), .z_i(c),
                        .z_o(z), .flags_o(flags));
            end else if (OP == 1) begin : g_mul
                // A multiplier has nothing to subtract.
                wire unused = sub_q;
                fp3_fp_mul #(.EXP(EXP), .FRAC(FRAC), .SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .FINITE(FINITE), .CUTS(MUL))
                    u_mul (.clk_i(clk_i[u]), .a_i(a_q), .b_i(b_q), .z_o(z), .flags_o(flags));
            end else begin : g_add
                fp3_fp_add #(.EXP(EXP), .FRAC(FRAC), .SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .FINITE(FINITE), .CUTS(ADD))
                    u_add (.clk_i(clk_i[u]), .sub_i(sub_q), .a_i(a_q), .b_i(b_q), .z_o(z), .flags_o(flags));
            end

            if (W < 32) begin : g_pad
                assign z_o[32*u+W +: 32-W] = {(32-W){1'b0}};
            end
            assign z_o[32*u +: W]      = z_q;
            assign flags_o[32*u +: 32] = {27'd0, flags_q};
            assign info_o[32*u +: 32]  = {2'd0, EXP[5:0], FRAC[5:0], SUBNORMAL[0], NEAREST[0], FINITE[0], 4'd0, CUTS};
        end
    endgenerate
endmodule
`default_nettype wire
