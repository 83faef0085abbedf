// SPDX-License-Identifier: Apache-2.0
// fp3_fp_fma_product: the front of fp_fma: the exact product of x and y, its place, and its class.
//
// Purpose   Rounds nothing. The product is the integer p_o. place_o is the exponent field of an
//           addend whose last bit is FRAC + 4 places above the product's first bit; fp_fma
//           subtracts the addend's exponent from place_o to get the shift distance.
// Latency   As many cycles as CUTS has ones, one operation per cycle. Places: 0 operands, 1 partial
//           products, 2 first sums, 3 product. With AHEAD all but p_o comes at once.
// Result For finite operands p_o is 0 exactly if zero_o is 1. For an infinity or a NaN p_o is
// meaningless.
//
//     1.5 * 2.0  ->  p_o 24'hC00000 * 24'h800000, place_o 127 + 128 - 100 = 155
`default_nettype none
module fp3_fp_fma_product #(
    parameter       EXP       = 8,
    parameter       FRAC      = 23,
    parameter       SUBNORMAL = 1,
    parameter       PLACE     = 10,    // bits of place_o, a signed number
    parameter       AHEAD     = 0,
    parameter [3:0] CUTS      = 0
) (
    input  wire                clk_i,
    input  wire [EXP+FRAC:0]   x_i, y_i,
    output wire [2*FRAC+1:0]   p_o,
    output wire [PLACE-1:0]    place_o,
    input  wire [PLACE-1:0]    e_z_i,      // of an addend, beside x_i and y_i
    output wire [PLACE-1:0]    distance_o, // place_o - e_z_i, where AHEAD
    output wire                sign_o,
    output wire                zero_o,
    output wire                inf_o,
    output wire                nan_o,      // of an operand, or of infinity times zero
    output wire                invalid_o
);
    localparam [3:0] BESIDE = AHEAD != 0 ? 4'd0 : CUTS;
    localparam integer SHIFT = FRAC + 4 - ((1 << EXP) - 1) / 2;

    wire [EXP-1:0]  ex = x_i[FRAC +: EXP], ey = y_i[FRAC +: EXP];
    wire x_normal = |ex, y_normal = |ey;
    wire [FRAC-1:0] fx = x_i[FRAC-1:0] & {FRAC{SUBNORMAL != 0 || x_normal}};
    wire [FRAC-1:0] fy = y_i[FRAC-1:0] & {FRAC{SUBNORMAL != 0 || y_normal}};
    fp3_fp_mul_product #(.FRAC(FRAC), .CUTS(CUTS)) u_product (
        .clk_i(clk_i), .a_i({x_normal, fx}), .b_i({y_normal, fy}), .p_o(p_o));

    wire [EXP-1:0] ex_0, ey_0;
    wire x_some_0, y_some_0, x_quiet_0, y_quiet_0, sign_0;
    fp3_cut #(.W(2*EXP+5), .ON(BESIDE[0])) u_0 (.clk_i(clk_i),
        .d_i({ex, ey, |fx, |fy, fx[FRAC-1], fy[FRAC-1], x_i[EXP+FRAC] ^ y_i[EXP+FRAC]}),
        .q_o({ex_0, ey_0, x_some_0, y_some_0, x_quiet_0, y_quiet_0, sign_0}));

    wire x_low  = ex_0 == 0, y_low = ey_0 == 0, x_top = &ex_0, y_top = &ey_0;
    wire x_zero = x_low && !x_some_0, y_zero = y_low && !y_some_0;
    wire x_nan  = x_top && x_some_0,  y_nan  = y_top && y_some_0;
    wire clash  = (x_top && !x_some_0 && y_zero) || (y_top && !y_some_0 && x_zero);
    wire [4:0] kind = {sign_0, x_zero || y_zero, x_top || y_top, x_nan || y_nan || clash,
                        (x_nan && !x_quiet_0) || (y_nan && !y_quiet_0) || clash};
    // A subnormal number has the exponent of the smallest normal one.
    wire [PLACE-1:0] e_x = {{PLACE-EXP{1'b0}}, ex_0[EXP-1:1], ex_0[0] || x_low};
    wire [PLACE-1:0] e_y = {{PLACE-EXP{1'b0}}, ey_0[EXP-1:1], ey_0[0] || y_low};
    wire [PLACE-1:0] sum = e_x + e_y;
    generate
        if (AHEAD != 0) begin : g_distance                 // one sum of four, which is earlier than one of two after the other
            assign distance_o = e_x + (SHIFT[PLACE-1:0] - e_z_i) + e_y;
        end else begin : g_no_distance
            wire unused = &e_z_i;
            assign distance_o = {PLACE{1'b0}};
        end
    endgenerate
    wire [PLACE-1:0] sum_1;
    wire [4:0]       kind_1;
    fp3_cut #(.W(PLACE+5), .ON(BESIDE[1])) u_1 (.clk_i(clk_i), .d_i({sum, kind}), .q_o({sum_1, kind_1}));

    wire [PLACE-1:0] place_2;
    wire [4:0]       kind_2;
    fp3_cut #(.W(PLACE+5), .ON(BESIDE[2])) u_2 (.clk_i(clk_i), .d_i({sum_1 + SHIFT[PLACE-1:0], kind_1}),
        .q_o({place_2, kind_2}));
    fp3_cut #(.W(PLACE+5), .ON(BESIDE[3])) u_3 (.clk_i(clk_i), .d_i({place_2, kind_2}),
        .q_o({place_o, sign_o, zero_o, inf_o, nan_o, invalid_o}));
endmodule
`default_nettype wire
