// SPDX-License-Identifier: Apache-2.0
// fp3_fp_mul_product: the exact product of two significands, by multipliers that are as wide, or
// nearly.
//
// Purpose   Takes the place of rtl/fp/fp3_fp_mul_product.v where synthesis knows the device's
//           multipliers, their registers and the adder behind them: a DSP48 of AMD has 25 bits by
//           18, so that two make a product of 24 by 24; one of Intel has 27 by 27. The hidden bit
//           is multiplied as any other.
// Latency   As there, popcount(CUTS). Places: 0 operands, 1 partial products, 2 first sums, 3
//           product: here the product is registered at each of the last three, which synthesis may
//           move into the multipliers.
// Range     As there. It has no primitive of a device.
//
//     fp_mul_product #(.FRAC(23), .CUTS(4'b0011)) u (.clk_i(clk), .a_i(x), .b_i(y), .p_o(p));
//     // two edges later p == x * y
`default_nettype none
module fp3_fp_mul_product #(
    parameter       FRAC = 23,         // fraction bits, 2 to 30: fp_mul checks it
    parameter [3:0] CUTS = 0
) (
    input  wire              clk_i,
    input  wire [FRAC:0]     a_i, b_i, // hidden bit and fraction
    output wire [2*FRAC+1:0] p_o
);
    wire [FRAC:0]     a, b;
    wire [2*FRAC+1:0] p_1, p_2;
    fp3_cut #(.W(2*FRAC+2), .ON(CUTS[0])) u_operands (.clk_i(clk_i), .d_i({a_i, b_i}), .q_o({a, b}));
    wire [2*FRAC+1:0] p = a * b;
    fp3_cut #(.W(2*FRAC+2), .ON(CUTS[1])) u_tiles (.clk_i(clk_i), .d_i(p), .q_o(p_1));
    fp3_cut #(.W(2*FRAC+2), .ON(CUTS[2])) u_sums (.clk_i(clk_i), .d_i(p_1), .q_o(p_2));
    fp3_cut #(.W(2*FRAC+2), .ON(CUTS[3])) u_product (.clk_i(clk_i), .d_i(p_2), .q_o(p_o));
endmodule
`default_nettype wire
