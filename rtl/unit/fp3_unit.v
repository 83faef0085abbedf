// SPDX-License-Identifier: Apache-2.0
// fp3_unit: the arithmetic of one stream of a lane, behind its socket.
//
// Purpose   The only place that selects a configuration's arithmetic: z +/- x * y in one stream,
//           rounded twice or once; or, with DUAL, z +/- y in the first stream and x * y in the
//           second, independent of each other.
// Latency   UNIT_LATENCY: of two units that of the slower one; new operands every cycle.
//
//     unit #(.CONFIG(CONFIG)) u_unit (.clk_i(clk_i), .operands_i(operands), .result_o(result));
`default_nettype none
`include "unit/socket.vh"
module fp3_unit #(
    parameter STREAM = 0,
`include "config/config.vh"
) (
    input  wire                   clk_i,
    input  wire [`FP3_OPERANDS_W-1:0] operands_i,
    output wire [`FP3_RESULT_W-1:0]   result_o
);
    `FP3_OPERANDS_FIELDS
    assign `FP3_OPERANDS = operands_i;
    generate
        if (FUSED != 0) begin : g_fused
            fp3_fused_arith #(.CONFIG(CONFIG)) u_arith (.clk_i(clk_i), .operands_i(operands_i), .result_o(result_o));
        end else if (LOGARITHMIC != 0) begin : g_logarithmic
            fp3_log_arith #(.CONFIG(CONFIG)) u_arith (.clk_i(clk_i), .operands_i(operands_i), .result_o(result_o));
        end else if (DUAL == 0) begin : g_single
            fp3_lane_arith #(.CONFIG(CONFIG)) u_arith (.clk_i(clk_i), .operands_i(operands_i), .result_o(result_o));
        end else if (STREAM == 0) begin : g_sum                  // y is scaled already
            `FP3_RESULT_FIELDS
            fp3_adder #(.WAIT(UNIT_LATENCY - ADD_LATENCY), .CONFIG(CONFIG)) u_add (.clk_i(clk_i),
                .subtract_i(operands_subtract),
                .a_i(operands_z), .b_i(operands_y), .value_o(result_value), .flags_o(result_flags));
            assign result_o = `FP3_RESULT;
        end else begin : g_product
            fp3_product #(.WAIT(UNIT_LATENCY - MUL_LATENCY), .CONFIG(CONFIG)) u_product (.clk_i(clk_i),
                .operands_i(operands_i), .result_o(result_o));
        end
    endgenerate
endmodule
`default_nettype wire
`include "config/undefine.vh"
