// SPDX-License-Identifier: Apache-2.0
// fp3_log_arith: z + x * y or z - x * y of logarithmic words.
//
// Purpose   Like lane_arith, in the arithmetic of docs/logarithmic.md: the product is exact, and
//           1/a or 1/sqrt(a) is computed beside it. fp_value does the same as for binary32.
// Latency   MUL_LATENCY + ADD_LATENCY, of which 2 and 10 are needed; new operands every cycle. z
//           comes Z_LATE cycles after the rest.
// Flags     Those of the product or those of the sum.
//
//     log_arith #(.CONFIG(CONFIG)) u_arith (.clk_i(clk_i), .operands_i(operands),
//     .result_o(result));
//     // with 2 and 10, subtract 1, z 40800000, x 40000000, y 3F800000  ->  40000000, twelve edges later      (4 - 2)
`default_nettype none
`include "unit/socket.vh"
module fp3_log_arith #(
`include "config/config.vh"
) (
    input  wire                   clk_i,
    input  wire [`FP3_OPERANDS_W-1:0] operands_i,
    output wire [`FP3_RESULT_W-1:0]   result_o
);
`include "gen/isa.vh"
`include "gen/choices.vh"
    localparam MUL_CORE = 1, ADD_CORE = 9;                 // registers inside
    `FP3_OPERANDS_FIELDS
    `FP3_RESULT_FIELDS
    assign `FP3_OPERANDS = operands_i;
    assign result_o  = `FP3_RESULT;

    // A reciprocal takes the place of the product; fp_value gives -0, to which it is added.
    wire        root    = ESTIMATE != 0 && operands_choice == CHOICE_RSQRT;
    wire        inverse = ESTIMATE != 0 && operands_choice == CHOICE_RCP;
    wire [31:0] quotient, rooted, rooted_q;
    wire [4:0]  quotient_flags, rooted_flags, rooted_flags_q;
    wire        is_root;
    fp3_lns_mul #(.CUT(1)) u_mul (.clk_i(clk_i), .divide_i(inverse), .a_i(inverse ? BITS_ONE : operands_x),
        .b_i(inverse ? operands_z : operands_y), .z_o(quotient), .flags_o(quotient_flags));
    generate
        if (ESTIMATE != 0) begin : g_root
            fp3_lns_root u_root (.inverse_i(1'b1), .a_i(operands_z), .z_o(rooted), .flags_o(rooted_flags));
        end else begin : g_no_root
            assign {rooted, rooted_flags} = 37'd0;
        end
    endgenerate
    fp3_delay #(.W(38), .N(MUL_CORE)) u_root_late (.clk_i(clk_i), .rst_i(1'b0), .d_i({root, rooted_flags, rooted}),
        .q_o({is_root, rooted_flags_q, rooted_q}));

    wire        no_product, reciprocal;                    // in the next cycle
    fp3_delay #(.W(1), .N(MUL_LATENCY - 1)) u_reciprocal (.clk_i(clk_i), .rst_i(1'b0), .d_i(root || inverse),
        .q_o(reciprocal));
    wire [31:0] product_late;
    wire [4:0]  flags_late;
    fp3_delay #(.W(37), .N(MUL_LATENCY - MUL_CORE - 1)) u_late (.clk_i(clk_i), .rst_i(1'b0),
        .d_i(is_root ? {rooted_flags_q, rooted_q} : {quotient_flags, quotient}), .q_o({flags_late, product_late}));
    reg  [31:0] product_q;
    reg  [4:0]  flags_q;
    always @(posedge clk_i) {flags_q, product_q} <= no_product && !reciprocal ? {5'd0, BITS_MINUS_ZERO} : {flags_late, product_late};

    wire        subtract;
    wire [31:0] z;
    fp3_delay #(.W(1), .N(MUL_LATENCY)) u_subtract (.clk_i(clk_i), .rst_i(1'b0), .d_i(operands_subtract),
        .q_o(subtract));
    fp3_fp_value #(.CONFIG(CONFIG)) u_z (.clk_i(clk_i), .choice_i(operands_choice),
        .a_i(operands_z), .b_i(operands_y), .true_i(|operands_x[30:0]), .z_o(z), .no_product_o(no_product));

    wire [31:0] sum;
    wire [4:0]  sum_flags, earlier_flags;
    fp3_lns_add u_add (.clk_i(clk_i), .sub_i(subtract), .a_i(z), .b_i(product_q), .z_o(sum), .flags_o(sum_flags));
    fp3_delay #(.W(5), .N(ADD_CORE)) u_flags (.clk_i(clk_i), .rst_i(1'b0), .d_i(flags_q), .q_o(earlier_flags));
    fp3_delay #(.W(37), .N(ADD_LATENCY - ADD_CORE)) u_result (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({sum_flags | earlier_flags, sum}),
        .q_o(`FP3_RESULT));
endmodule
`default_nettype wire
`include "config/undefine.vh"
