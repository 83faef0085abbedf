// SPDX-License-Identifier: Apache-2.0
// fp3_lane_arith: z + x * y or z - x * y, multiplied, rounded, added, rounded.
//
// Purpose   The one operation of the throughput machine's lane: a multiplier whose results all go
//           to an adder. A product alone is -0 + x * y, a sum alone z + x * 1. The result of
//           fp_value is added to -0. With MIXED, lns_inverse computes 1/a and 1/sqrt(a) beside
//           them.
// Latency   MUL_LATENCY + ADD_LATENCY; new operands every cycle. z comes Z_LATE cycles after the
//           rest. Flags Of the product or the sum; of rcp and rsqrt with MIXED, of lns_inverse.
//
//     lane_arith #(.CONFIG(CONFIG)) u_arith (.clk_i(clk_i), .operands_i(operands),
//     .result_o(result)); // with 8 and 8, subtract 1, z 40400000, x 3F800000, y 40000000  -> 
//     3F800000, sixteen edges later
`default_nettype none
`include "unit/socket.vh"
module fp3_lane_arith #(
`include "config/config.vh"
) (
    input  wire                   clk_i,
    input  wire [`FP3_OPERANDS_W-1:0] operands_i,
    output wire [`FP3_RESULT_W-1:0]   result_o
);
`include "gen/isa.vh"
`include "gen/choices.vh"
    `FP3_OPERANDS_FIELDS
    `FP3_RESULT_FIELDS
    assign `FP3_OPERANDS = operands_i;
    assign result_o  = `FP3_RESULT;

    wire        no_product;                // in the next cycle
    wire [31:0] product;
    wire [4:0]  product_flags;
    fp3_multiplier #(.CONFIG(CONFIG)) u_mul (.clk_i(clk_i), .no_product_i(no_product),
        .instead_i({5'd0, BITS_MINUS_ZERO}),
        .a_i(operands_x), .b_i(operands_y), .value_o(product), .flags_o(product_flags));

    // The adder's other operand waits for the product.
    wire        subtract;
    wire [31:0] z;
    fp3_delay #(.W(1), .N(MUL_LATENCY)) u_subtract (.clk_i(clk_i), .rst_i(1'b0), .d_i(operands_subtract),
        .q_o(subtract));
    fp3_fp_value #(.CONFIG(CONFIG)) u_z (.clk_i(clk_i), .choice_i(operands_choice),
        .a_i(operands_z), .b_i(operands_y), .true_i(|operands_x[30:NONZERO_FROM]), .z_o(z), .no_product_o(no_product));

    wire [4:0]  sum_flags, earlier_flags;
    wire [31:0] sum;
    fp3_adder #(.CONFIG(CONFIG)) u_add (.clk_i(clk_i), .subtract_i(subtract),
        .a_i(z), .b_i(product), .value_o(sum), .flags_o(sum_flags));
    fp3_delay #(.W(5), .N(ADD_LATENCY)) u_flags (.clk_i(clk_i), .rst_i(1'b0), .d_i(product_flags), .q_o(earlier_flags));

    // An inverse replaces the sum, which is then +0 or a NaN.
    generate
        if (MIXED != 0) begin : g_inverse
            localparam INVERSE = 13;                       // registers inside
            wire        root = operands_choice == CHOICE_RSQRT;
            wire [31:0] inverse, inverse_late;
            wire [4:0]  flags, flags_late;
            fp3_lns_inverse u_inverse (.clk_i(clk_i), .on_i(root || operands_choice == CHOICE_RCP), .root_i(root),
                .a_i(operands_z),
                .z_o(inverse), .flags_o(flags));
            fp3_delay #(.W(37), .N(MUL_LATENCY + ADD_LATENCY - INVERSE)) u_late (.clk_i(clk_i), .rst_i(1'b0),
                .d_i({flags, inverse}), .q_o({flags_late, inverse_late}));
            assign result_value = sum | inverse_late;
            assign result_flags = sum_flags | earlier_flags | flags_late;
        end else begin : g_sum
            assign result_value = sum;
            assign result_flags = sum_flags | earlier_flags;
        end
    endgenerate
endmodule
`default_nettype wire
`include "config/undefine.vh"
