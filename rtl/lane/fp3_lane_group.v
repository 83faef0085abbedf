// SPDX-License-Identifier: Apache-2.0
// fp3_lane_group: lanes with the same control in the same cycle, which answer as one.
//
// Purpose   Control from group to group is registered once in each group, for all its lanes.
//           Registers that only pass control on (an instruction's end, six cycles long) are equal
//           in all lanes: synthesis finds equal registers and keeps one copy.
//
//           issue_i ──► register ──┬────────┬────────┬────────┬──► issue_o
//                                lane     lane     lane     lane
//           report_i ──────────────┴────────┴────────┴────────┴──► register ──► report_o
//
// Latency   One cycle from group to group, and one from report_i to report_o. The count takes a
//           cycle for each lane: it is read when no instruction is in the lanes.
// Reset Goes from group to group as an instruction does, and reaches the lanes with the control.
`default_nettype none
`include "lane/bundles.vh"
module fp3_lane_group #(
    parameter N = 1,                   // lanes
`include "config/config.vh"
) (
    input  wire                  clk_i,
    input  wire [LANE_W-1:0]     first_i,      // the number of the first lane; does not change
    input  wire                  rst_i,
    input  wire [`FP3_REACH_W-1:0]        reach_i,
    input  wire [`FP3_LANE_ISSUE_W-1:0]   issue_i,
    input  wire [`FP3_LANE_RETIRE_W-1:0]  retire_i,
    input  wire [`FP3_ACCESS_W-1:0]  access_i,
    input  wire [31:0]           data_i,
    input  wire [DRAW_W-1:0]     draw_i,
    output wire                  rst_o,
    output wire [`FP3_REACH_W-1:0]        reach_o,
    output wire [`FP3_LANE_ISSUE_W-1:0]   issue_o,
    output wire [`FP3_LANE_RETIRE_W-1:0]  retire_o,
    output wire [`FP3_ACCESS_W-1:0]  access_o,
    output wire [31:0]           data_o,
    output wire [DRAW_W-1:0]     draw_o,
    input  wire [`FP3_REPORT_W-1:0]  report_i,
    output wire [`FP3_REPORT_W-1:0]  report_o,
    // The arithmetic and the trace, STREAMS parts for each lane
    output wire [`FP3_OPERANDS_W*STREAMS*N-1:0] operands_o,
    input  wire [`FP3_RESULT_W*STREAMS*N-1:0]   result_i,
    output wire [`FP3_WRITTEN_W*STREAMS*N-1:0]  written_o
);
    reg                 rst_q;
    initial             rst_q = 1'b1;  // at power-up, until the first reset arrives
    reg [`FP3_REACH_W-1:0]       reach_q;
    reg [`FP3_LANE_ISSUE_W-1:0]  issue_q;
    reg [`FP3_LANE_RETIRE_W-1:0] retire_q;
    reg [`FP3_ACCESS_W-1:0] access_q;
    reg [31:0]          data_q;
    reg [DRAW_W-1:0]    draw_q;
    always @(posedge clk_i) begin
        rst_q    <= rst_i;
        reach_q  <= reach_i  & {`FP3_REACH_W{!rst_i}};
        issue_q  <= issue_i  & {`FP3_LANE_ISSUE_W{!rst_i}};
        retire_q <= retire_i & {`FP3_LANE_RETIRE_W{!rst_i}};
        access_q <= access_i & {`FP3_ACCESS_W{!rst_i}};
        data_q   <= data_i;
        draw_q   <= draw_i;
    end
    assign reach_o = reach_q;
    assign draw_o  = draw_q;
    assign {rst_o, issue_o, retire_o, access_o, data_o} = {rst_q, issue_q, retire_q, access_q, data_q};

    wire [`FP3_REPORT_W*(N+1)-1:0] reports;        // before lane l at l, behind it at l + 1
    assign reports[0 +: `FP3_REPORT_W] = report_i;
    genvar l;
    generate
        for (l = 0; l < N; l = l + 1) begin : g_lane
            localparam S = STREAMS;
            localparam [LANE_W-1:0] L = l;
            fp3_lane #(.CONFIG(CONFIG)) u_lane (
                .clk_i(clk_i), .rst_i(rst_q), .index_i(first_i + L),
                .reach_i(reach_q), .issue_i(issue_q), .retire_i(retire_q), .access_i(access_q), .data_i(data_q),
                .draw_i(draw_q),
                .report_i(reports[`FP3_REPORT_W*l +: `FP3_REPORT_W]),
                .report_o(reports[`FP3_REPORT_W*(l+1) +: `FP3_REPORT_W]),
                .operands_o(operands_o[`FP3_OPERANDS_W*S*l +: `FP3_OPERANDS_W*S]),
                .result_i(result_i[`FP3_RESULT_W*S*l +: `FP3_RESULT_W*S]),
                .written_o(written_o[`FP3_WRITTEN_W*S*l +: `FP3_WRITTEN_W*S]));
        end
    endgenerate

    // The group's report
    `FP3_REPORT_FIELDS
    assign `FP3_REPORT = reports[`FP3_REPORT_W*N +: `FP3_REPORT_W];
    reg [4:0]           flags_q;
    reg [31:0]          answer_q;
    reg                 valid_q, asleep_q, batch_q, raised_q, no_room_q;
    reg [CONTEXT_W-1:0] context_q;
    always @(posedge clk_i) begin
        {flags_q, valid_q} <= {report_flags, report_valid} & {6{!rst_q}};
        {raised_q, no_room_q} <= {report_raised, report_no_room} & {2{!rst_q}};
        {answer_q, asleep_q, batch_q, context_q} <= {report_answer, report_asleep, report_batch, report_context};
    end
    assign report_o = `FP3_REPORT_OF(report_count, report_longest, flags_q, raised_q, no_room_q, answer_q, valid_q, asleep_q, batch_q, context_q);
endmodule
`default_nettype wire
`include "config/undefine.vh"
