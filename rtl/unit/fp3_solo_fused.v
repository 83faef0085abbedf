// SPDX-License-Identifier: Apache-2.0
// fp3_solo_fused: a multiply-add that is rounded once, and a multiplier beside it, for one object.
//
// Purpose   Like solo_arith, with a fused multiply-add. Sums use it, too: a sum alone is z + x * 1.
//           So there is no adder and no chain. A product alone is earlier: the multiplier rounds
//           it. The result of fp_value replaces a product.
//
//               z, x, y ─┬► fused_adder ──► sum_o
//                        └► product ──────► product_o
//
//           Both multiply x by y. If both have the same cuts, synthesis makes one product for both.
// Latency   sum_o: PRODUCT_LATENCY + ADD_LATENCY; product_o: MUL_LATENCY. New operands every cycle.
//
//     solo_fused #(.CONFIG(CONFIG)) u_arith (.clk_i(clk_i), .operands_i(operands), .sum_o(sum),
//     .product_o(product)); // with 2 and 2, z 40400000, x 3F800000, y 40000000  ->  product
//     40000000 two edges later, sum 40A00000 three edges later
`default_nettype none
`include "unit/socket.vh"
module fp3_solo_fused #(
`include "config/config.vh"
) (
    input  wire                   clk_i,
    input  wire [`FP3_OPERANDS_W-1:0] operands_i,
    output wire [`FP3_RESULT_W-1:0]   sum_o,
    output wire [`FP3_RESULT_W-1:0]   product_o
);
    `FP3_OPERANDS_FIELDS
    assign `FP3_OPERANDS = operands_i;

    fp3_fused_adder #(.CONFIG(CONFIG)) u_fma (.clk_i(clk_i), .no_product_i(1'b0), .subtract_i(operands_subtract),
        .z_i(operands_z), .x_i(operands_x), .y_i(operands_y), .result_o(sum_o));

    fp3_product #(.CONFIG(CONFIG)) u_product (.clk_i(clk_i), .operands_i(operands_i), .result_o(product_o));
endmodule
`default_nettype wire
`include "config/undefine.vh"
