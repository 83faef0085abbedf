// SPDX-License-Identifier: Apache-2.0
// fp3_fused_arith: z + x * y or z - x * y, rounded once.
//
// Purpose   Like lane_arith, with a fused multiply-add. A product alone is -0 + x * y, a sum alone
//           z + x * 1; rounding once keeps both correct. The result of fp_value is added to -0.
// Latency   MUL_LATENCY + ADD_LATENCY; new operands every cycle. z comes Z_LATE cycles after the
//           rest.
//
//     fused_arith #(.CONFIG(CONFIG)) u_arith (.clk_i(clk_i), .operands_i(operands),
//     .result_o(result)); // with 5 and 8, subtract 1, z 40400000, x 3F800000, y 40000000  -> 
//     3F800000, thirteen edges later
`default_nettype none
`include "unit/socket.vh"
module fp3_fused_arith #(
`include "config/config.vh"
) (
    input  wire                   clk_i,
    input  wire [`FP3_OPERANDS_W-1:0] operands_i,
    output wire [`FP3_RESULT_W-1:0]   result_o
);
    `FP3_OPERANDS_FIELDS
    assign `FP3_OPERANDS = operands_i;

    wire        no_product;                // in the next cycle
    wire        subtract;
    wire [31:0] z;
    fp3_delay #(.W(1), .N(MUL_LATENCY)) u_subtract (.clk_i(clk_i), .rst_i(1'b0), .d_i(operands_subtract),
        .q_o(subtract));
    fp3_fp_value #(.CONFIG(CONFIG)) u_z (.clk_i(clk_i), .choice_i(operands_choice),
        .a_i(operands_z), .b_i(operands_y), .true_i(|operands_x[30:NONZERO_FROM]), .z_o(z), .no_product_o(no_product));
    fp3_fused_adder #(.CONFIG(CONFIG)) u_fma (.clk_i(clk_i), .no_product_i(no_product), .subtract_i(subtract),
        .z_i(z), .x_i(operands_x), .y_i(operands_y), .result_o(result_o));
endmodule
`default_nettype wire
`include "config/undefine.vh"
