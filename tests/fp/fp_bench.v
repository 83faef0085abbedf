// fp_bench: the floating-point cores in every form that the tests look at, side by side.
//
// Purpose   Row r is one adder and one multiplier of the same format, mode and cuts:
//             0..3  4-bit exponent, 3-bit fraction: truncate flushed, nearest flushed,
//                   truncate gradual, nearest gradual
//             4     the same format, without infinities: Cell's arithmetic
//             5     binary16, 6 binary32 in Cell's arithmetic, 7 binary32, uncut
//             8..   binary32 with the cuts that named configurations have, each pair of masks once
//           Unit 2r is the adder of row r, unit 2r+1 its multiplier.
// Latency   Operand register, core, result register: popcount(cuts) + 2 edges of the unit's clock.
// Hazard    Each unit has a clock and registers of its own, so that a simulator pays only for the
//           unit under test; results of units whose clock stands still are stale.
//
//     clk_i[15] rises twice with a_i, b_i held: z_o[32*15 +: 32] is a * b in binary32.
//     info_o[32*u +: 32] = {0, exponent width, fraction width, subnormal, nearest, finite, cuts} of unit u.
`default_nettype none
module fp_bench (clk_i, sub_i, a_i, b_i, z_o, flags_o, info_o);
    `include "configs.vh"
    parameter  SMALL_ONLY = 0;                   // 1: rows 0..4, for quick builds
    localparam UNITS = 2 * (SMALL_ONLY != 0 ? 5 : 8 + CUT_PAIRS);

    input  wire [UNITS-1:0]    clk_i;
    input  wire                sub_i;            // adders subtract
    input  wire [31:0]         a_i, b_i;         // right-aligned
    output wire [32*UNITS-1:0] z_o;
    output wire [32*UNITS-1:0] flags_o;          // {NV, DZ, OF, UF, NX} in the low bits
    output wire [32*UNITS-1:0] info_o;

    genvar u;
    generate
        for (u = 0; u < UNITS; u = u + 1) begin : g_unit
            localparam ROW       = u / 2;
            localparam MUL       = u % 2;
            localparam EXP       = ROW < 5 ? 4 : ROW == 5 ? 5 : 8;
            localparam FRAC      = ROW < 5 ? 3 : ROW == 5 ? 10 : 23;
            localparam FINITE    = ROW == 4 || ROW == 6 ? 1 : 0;
            localparam SUBNORMAL = FINITE != 0 ? 0 : ROW < 4 ? ROW / 2 : 1;
            localparam NEAREST   = FINITE != 0 ? 0 : ROW < 4 ? ROW % 2 : 1;
            localparam PAIR      = ROW < 8 ? 0 : ROW - 8;
            localparam [6:0]  CUTS = ROW < 8 ? 7'd0
                                   : MUL != 0 ? MUL_CUTS[7*PAIR +: 7]
                                              : ADD_CUTS[7*PAIR +: 7];
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

            if (MUL != 0) begin : g_mul
                // A multiplier has nothing to subtract.
                wire unused = sub_q;
                fp_mul #(.EXP(EXP), .FRAC(FRAC), .SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .FINITE(FINITE), .CUTS(CUTS))
                    u_mul (.clk_i(clk_i[u]), .a_i(a_q), .b_i(b_q), .z_o(z), .flags_o(flags));
            end else begin : g_add
                fp_add #(.EXP(EXP), .FRAC(FRAC), .SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .FINITE(FINITE), .CUTS(CUTS))
                    u_add (.clk_i(clk_i[u]), .sub_i(sub_q), .a_i(a_q), .b_i(b_q), .z_o(z), .flags_o(flags));
            end

            if (W < 32) begin : g_pad
                assign z_o[32*u+W +: 32-W] = {(32-W){1'b0}};
            end
            assign z_o[32*u +: W]      = z_q;
            assign flags_o[32*u +: 32] = {27'd0, flags_q};
            assign info_o[32*u +: 32]  = {2'd0, EXP[5:0], FRAC[5:0], SUBNORMAL[0], NEAREST[0], FINITE[0], 8'd0, CUTS};
        end
    endgenerate
endmodule
`default_nettype wire
