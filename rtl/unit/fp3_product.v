// SPDX-License-Identifier: Apache-2.0
// fp3_product: x * y, rounded, or in its place what fp_value makes of z, y and whether x is 0.
//
// Purpose   The multiplier where its result goes to a register, and not on to an adder.
//
//               x, y ────► multiplier ─┬► register ─► result_o
//               z, y, x ─► fp_value ───┘
//
//           What fp_value makes becomes what the sum of it and -0 would be: a NaN is the quiet one,
//           and invalid if it was signalling; a number has the fraction's bits, and may be flushed.
// Latency   MUL_LATENCY + WAIT, at least 2 with fp_value, which is a cycle early for the register in
//           the multiplier. New operands every cycle.
//
//     product #(.CONFIG(CONFIG)) u_product (.clk_i(clk_i), .operands_i(operands),
//     .result_o(result)); // x 40400000, y 40000000  ->  result 40C00000, MUL_LATENCY edges later
`default_nettype none
`include "unit/socket.vh"
module fp3_product #(
    parameter WAIT = 0,                // more registers
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
    assign result_o = `FP3_RESULT;

    wire        valued;
    wire [36:0] value;
    generate
        if (VALUES != 0) begin : g_value
            wire [31:0] made;
            wire        unused_no_product;
            fp3_delay #(.W(1), .N(MUL_LATENCY-1+WAIT)) u_valued (.clk_i(clk_i), .rst_i(1'b0),
                .d_i(operands_choice != CHOICE_NONE), .q_o(valued));
            fp3_fp_value #(.EARLY(1-WAIT), .CONFIG(CONFIG)) u_value (.clk_i(clk_i), .choice_i(operands_choice),
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
    fp3_multiplier #(.WAIT(WAIT), .CONFIG(CONFIG)) u_mul (.clk_i(clk_i), .no_product_i(valued), .instead_i(value),
        .a_i(operands_x), .b_i(operands_y), .value_o(result_value), .flags_o(result_flags));
endmodule
`default_nettype wire
`include "config/undefine.vh"
