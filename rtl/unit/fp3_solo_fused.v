// SPDX-License-Identifier: Apache-2.0
// fp3_solo_fused: a multiply-add that is rounded once, and a multiplier beside it, for one object.
//
// Purpose   Like solo_arith, with a fused multiply-add. Sums use it, too: a sum alone is z + x * 1.
//           So there is no adder and no chain. A product alone is earlier: the multiplier rounds
//           it. The result of fp_value replaces a product.
//
//               z, x, y ──► fused_adder ──────────────► sum_o
//                  │ x, y ► multiplier ─┬► register ──► product_o
//                  └──────► fp_value ───┘
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
`include "gen/isa.vh"
`include "gen/choices.vh"
    `FP3_OPERANDS_FIELDS
    assign `FP3_OPERANDS = operands_i;

    fp3_fused_adder #(.CONFIG(CONFIG)) u_fma (.clk_i(clk_i), .no_product_i(1'b0), .subtract_i(operands_subtract),
        .z_i(operands_z), .x_i(operands_x), .y_i(operands_y), .result_o(sum_o));

    // What fp_value makes, as the sum of it and -0 would be: a NaN is the quiet one, and invalid if
    // it was signalling; a number has the fraction's bits, and may be flushed. fp_value is a cycle
    // early, for the register in the multiplier.
    wire        valued;
    wire [36:0] value;
    generate
        if (VALUES != 0) begin : g_value
            wire [31:0] made;
            wire        unused_no_product;
            fp3_delay #(.W(1), .N(MUL_LATENCY-1)) u_valued (.clk_i(clk_i), .rst_i(1'b0),
                .d_i(operands_choice != CHOICE_NONE), .q_o(valued));
            fp3_fp_value #(.EARLY(1), .CONFIG(CONFIG)) u_value (.clk_i(clk_i), .choice_i(operands_choice),
                .a_i(operands_z), .b_i(operands_y),
                .true_i(|operands_x[30:NONZERO_FROM]), .z_o(made), .no_product_o(unused_no_product));
            wire [31:0] kept  = made & KEPT;
            wire        nan   = &kept[30:23] && |kept[22:0];
            wire        flush = SUBNORMAL == 0 && kept[30:23] == 8'd0;
            assign value = {nan && !kept[22], 4'd0, nan ? BITS_NAN : {kept[31], kept[30:0] & {31{!flush}}}};
        end else begin : g_none
            assign {valued, value} = 38'd0;
        end
    endgenerate
    fp3_multiplier #(.CONFIG(CONFIG)) u_mul (.clk_i(clk_i), .no_product_i(valued), .instead_i(value),
        .a_i(operands_x), .b_i(operands_y), .value_o(product_o[31:0]), .flags_o(product_o[36:32]));
endmodule
`default_nettype wire
`include "config/undefine.vh"
