// SPDX-License-Identifier: Apache-2.0
// fp3_lane_report: adds a lane's report to the report of the lanes before it.
//
// Purpose   From lane to lane the largest count, all flags, whether a context's objects all sleep,
//           and the answer of the lane that the host asked. The sequencer hears the last lane.
// Latency   One cycle from report_i for the count and the longest list, none for the others:
//           lane_group registers them. A lane answers the host three cycles after mine_i, WIDENED
//           more with STORAGE, and reports two cycles after valid_i.
// Hazard    Lanes are in step: all lanes report an instruction in the same cycle. Lanes that are
//           not asked answer 0.
//
//     counts of three lanes 5, 7, 6:     report_count of the last is 7
`default_nettype none
`include "lane/bundles.vh"
module fp3_lane_report #(
`include "config/config.vh"
) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    input  wire [`FP3_REPORT_W-1:0] report_i,
    // This lane's
    input  wire [ROW_W:0]       count_i,
    input  wire [LENGTH_W-1:0]  longest_i,
    input  wire [4:0]           flags_i,
    input  wire                 raised_i,
    input  wire                 no_room_i,
    input  wire                 valid_i,
    input  wire                 batch_i,
    input  wire [CONTEXT_W-1:0] context_i,
    input  wire                 asleep_i,       // two cycles after valid_i
    input  wire                 mine_i,         // the host asks this lane
    input  wire [2:0]           space_i,        // for what: lane_host.vh
    input  wire                 copied_i,       // three cycles later, as the words (without STORAGE): another lane gets it
    input  wire [31:0]          stored_i,       // as late as the answer
    input  wire [31:0]          status_i,       // three cycles later
    output wire [`FP3_REPORT_W-1:0] report_o
);
`include "host/lane_host.vh"
    `FP3_REPORT_FIELDS
    assign `FP3_REPORT = report_i;
    wire [2:0]           space;
    wire                 mine, valid, batch;
    wire [CONTEXT_W-1:0] context_number;
    reg  [ROW_W:0]       count_q;
    reg  [LENGTH_W-1:0]  longest_q;
    fp3_delay #(.W(4), .N(3+WIDENED)) u_host (.clk_i(clk_i), .rst_i(1'b0), .d_i({mine_i, space_i}),
        .q_o({mine, space}));
    fp3_delay #(.W(1), .N(2)) u_valid (.clk_i(clk_i), .rst_i(rst_i), .d_i(valid_i), .q_o(valid));
    fp3_delay #(.W(1+CONTEXT_W), .N(2)) u_context (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({batch_i, context_i}), .q_o({batch, context_number}));
    always @(posedge clk_i) count_q <= count_i > report_count ? count_i : report_count;
    always @(posedge clk_i) longest_q <= longest_i > report_longest ? longest_i : report_longest;
    wire [31:0] status;
    fp3_delay #(.W(32), .N(WIDENED)) u_status (.clk_i(clk_i), .rst_i(1'b0), .d_i(status_i), .q_o(status));
    wire [31:0] answer = copied_i || space == HOST_OBJECT ? stored_i : space == HOST_STATUS ? status : {{31-ROW_W{1'b0}}, count_i};
    assign report_o = `FP3_REPORT_OF(count_q, longest_q, report_flags | flags_i, report_raised || raised_i, report_no_room || no_room_i,
                                 report_answer | (answer & {32{mine || copied_i}}), valid, report_asleep && asleep_i, batch, context_number);

`ifdef FP3_CHECK
    // The lanes are in step: the lanes before have reported the same instruction.
    always @(posedge clk_i)
        if (!rst_i && report_valid && !(valid && {batch, context_number} == {report_batch, report_context})) begin
            $display("%m: not in step with the lane before, which reported context %0d", report_context); $stop;
        end
`endif
endmodule
`default_nettype wire
`include "config/undefine.vh"
