// lane_group: lanes that hear the same in the same cycle, and answer as one.
//
// Purpose   What goes from group to group is registered once in each, for all its lanes. As the lanes are
//           told the same, what they only pass on (an instruction's end, six cycles long) is the same in
//           each: synthesis finds equal registers and keeps one copy.
//
//           issue_i ──► register ──┬────────┬────────┬────────┬──► issue_o
//                                lane     lane     lane     lane
//           report_i ──────────────┴────────┴────────┴────────┴──► register ──► report_o
//
// Latency   One cycle from what is heard to what is said on, and one from report_i to report_o; the count
//           takes a cycle for each lane: it is read when nothing moves.
// Reset     Goes from group to group as an instruction does; the lanes have it with what they hear.
`default_nettype none
`include "lane/issue.vh"
`include "lane/retire.vh"
`include "lane/dual_issue.vh"
`include "lane/dual_retire.vh"
`include "lane/access.vh"
`include "lane/report.vh"
module lane_group #(
    parameter N = 1,                   // lanes
`include "config/config.vh"
) (
    input  wire                  clk_i,
    input  wire [LANE_W-1:0]     first_i,      // the number of the first lane; does not change
    input  wire                  rst_i,
    input  wire [`LANE_ISSUE_W-1:0]   issue_i,
    input  wire [`LANE_RETIRE_W-1:0]  retire_i,
    input  wire [`ACCESS_W-1:0]  access_i,
    input  wire [31:0]           data_i,
    output wire                  rst_o,
    output wire [`LANE_ISSUE_W-1:0]   issue_o,
    output wire [`LANE_RETIRE_W-1:0]  retire_o,
    output wire [`ACCESS_W-1:0]  access_o,
    output wire [31:0]           data_o,
    input  wire [`REPORT_W-1:0]  report_i,
    output wire [`REPORT_W-1:0]  report_o,
    // The arithmetic, a part for each lane
    output wire [N-1:0]          subtract_o,
    output wire [N-1:0]          twice_o,
    output wire [N-1:0]          half_o,
    output wire [CHOICE_W*N-1:0] choice_o,
    output wire [32*N-1:0]       x_o,
    output wire [32*N-1:0]       y_o,
    output wire [32*N-1:0]       z_o,
    input  wire [32*N-1:0]       value_i,
    input  wire [5*N-1:0]        value_flags_i,
    // Trace, likewise, or two parts for each
    output wire [2*STREAMS*N-1:0]          written_end_o,
    output wire [STREAMS*N-1:0]            written_o,
    output wire [CONTEXT_W*STREAMS*N-1:0]  written_context_o,
    output wire [ROW_W*STREAMS*N-1:0]      written_row_o,
    output wire [REGISTER_W*STREAMS*N-1:0] written_register_o,
    output wire [32*STREAMS*N-1:0]         written_value_o,
    output wire [5*STREAMS*N-1:0]          written_flags_o
);
    reg                 rst_q = 1'b1;  // at power-up, until the first reset arrives
    reg [`LANE_ISSUE_W-1:0]  issue_q;
    reg [`LANE_RETIRE_W-1:0] retire_q;
    reg [`ACCESS_W-1:0] access_q;
    reg [31:0]          data_q;
    always @(posedge clk_i) begin
        rst_q    <= rst_i;
        issue_q  <= issue_i  & {`LANE_ISSUE_W{!rst_i}};
        retire_q <= retire_i & {`LANE_RETIRE_W{!rst_i}};
        access_q <= access_i & {`ACCESS_W{!rst_i}};
        data_q   <= data_i;
    end
    assign {rst_o, issue_o, retire_o, access_o, data_o} = {rst_q, issue_q, retire_q, access_q, data_q};

    wire [`REPORT_W*(N+1)-1:0] reports;        // lane l adds to what is at l
    assign reports[0 +: `REPORT_W] = report_i;
    genvar l;
    generate
        if (DUAL != 0) begin : g_no_operands               // the arithmetic is in the lane
            assign {subtract_o, twice_o, half_o, choice_o} = {(3+CHOICE_W)*N{1'b0}};
            assign {x_o, y_o, z_o} = {96*N{1'b0}};
            wire unused = |{value_i, value_flags_i};
        end
        for (l = 0; l < N && DUAL != 0; l = l + 1) begin : g_dual
            localparam S = STREAMS;
            localparam [LANE_W-1:0] L = l;
            dual_lane #(.CONFIG(CONFIG)) u_lane (
                .clk_i(clk_i), .rst_i(rst_q), .index_i(first_i + L),
                .issue_i(issue_q), .retire_i(retire_q), .access_i(access_q), .data_i(data_q),
                .report_i(reports[`REPORT_W*l +: `REPORT_W]), .report_o(reports[`REPORT_W*(l+1) +: `REPORT_W]),
                .written_end_o(written_end_o[2*S*l +: 2*S]), .written_o(written_o[S*l +: S]),
                .written_context_o(written_context_o[CONTEXT_W*S*l +: CONTEXT_W*S]),
                .written_row_o(written_row_o[ROW_W*S*l +: ROW_W*S]),
                .written_register_o(written_register_o[REGISTER_W*S*l +: REGISTER_W*S]),
                .written_value_o(written_value_o[32*S*l +: 32*S]), .written_flags_o(written_flags_o[5*S*l +: 5*S]));
        end
        for (l = 0; l < N && DUAL == 0; l = l + 1) begin : g_lane
            localparam [LANE_W-1:0] L = l;
            lane #(.CONFIG(CONFIG)) u_lane (
                .clk_i(clk_i), .rst_i(rst_q), .index_i(first_i + L),
                .issue_i(issue_q), .retire_i(retire_q), .access_i(access_q), .data_i(data_q),
                .report_i(reports[`REPORT_W*l +: `REPORT_W]), .report_o(reports[`REPORT_W*(l+1) +: `REPORT_W]),
                .subtract_o(subtract_o[l]), .twice_o(twice_o[l]), .half_o(half_o[l]), .choice_o(choice_o[CHOICE_W*l +: CHOICE_W]),
                .x_o(x_o[32*l +: 32]), .y_o(y_o[32*l +: 32]), .z_o(z_o[32*l +: 32]),
                .value_i(value_i[32*l +: 32]), .value_flags_i(value_flags_i[5*l +: 5]),
                .written_end_o(written_end_o[2*l +: 2]), .written_o(written_o[l]),
                .written_context_o(written_context_o[CONTEXT_W*l +: CONTEXT_W]), .written_row_o(written_row_o[ROW_W*l +: ROW_W]),
                .written_register_o(written_register_o[REGISTER_W*l +: REGISTER_W]),
                .written_value_o(written_value_o[32*l +: 32]), .written_flags_o(written_flags_o[5*l +: 5]));
        end
    endgenerate

    // The group's report
    `REPORT_FIELDS
    assign `REPORT = reports[`REPORT_W*N +: `REPORT_W];
    reg [4:0]           flags_q;
    reg [31:0]          answer_q;
    reg                 valid_q, asleep_q, batch_q;
    reg [CONTEXT_W-1:0] context_q;
    always @(posedge clk_i) begin
        {flags_q, valid_q} <= {report_flags, report_valid} & {6{!rst_q}};
        {answer_q, asleep_q, batch_q, context_q} <= {report_answer, report_asleep, report_batch, report_context};
    end
    assign report_o = {report_count, flags_q, answer_q, valid_q, asleep_q, batch_q, context_q};
endmodule
`default_nettype wire
