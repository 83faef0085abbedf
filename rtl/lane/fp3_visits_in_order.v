// SPDX-License-Identifier: Apache-2.0
// fp3_visits_in_order: which object each context has if no object can sleep: one row after the
// other.
//
// Purpose   Replaces visits without SLEEP. A round goes through rows 0, 1 .. in the order in which
//           contexts issue, so the sequencer knows the row; the lane keeps only its number of
//           objects.
//
//           cycle  W-6       W-3       W            W+1
//           row_i            row_w3_o  executed_o   row_late_o
//
// Latency   As shown; with STORAGE W-6 and W-3, w3 in names too, are WIDENED earlier. Of a store's
//           row, two cycles after st_row_i.
// Hazard    The count changes only between runs.
//
//     a lane of 5 objects, row_i = 5:     ENDED cycles later absent_o = 1, executed_o = 0
`default_nettype none
module fp3_visits_in_order #(
`include "config/config.vh"
) (
    input  wire             clk_i,
    input  wire             rst_i,
    input  wire [ROW_W-1:0] row_i,          // W-6
    output wire [ROW_W-1:0] row_w3_o,       // W-3
    output wire [ROW_W-1:0] row_late_o,     // W+1
    // W: an instruction
    input  wire             valid_i,
    output wire             executed_o,
    output wire             absent_o,       // trace: the context has no object
    // The row of a store
    input  wire [ROW_W-1:0] st_row_i,
    output wire [ROW_W-1:0] st_row_o,       // two cycles later
    output wire             st_absent_o,
    // The host
    input  wire             host_count_i,   // set the count
    input  wire [ROW_W:0]   host_data_i,
    output wire [ROW_W:0]   count_o
);
    reg [ROW_W:0] count_q;
    always @(posedge clk_i)
        if (rst_i)             count_q <= {ROW_W+1{1'b0}};
        else if (host_count_i) count_q <= host_data_i;
    assign count_o = count_q;

    fp3_delay #(.W(ROW_W), .N(TIMING_END-3)) u_row_w3 (.clk_i(clk_i), .rst_i(1'b0), .d_i(row_i), .q_o(row_w3_o));
    fp3_delay #(.W(ROW_W), .N(4+WIDENED)) u_row_late (.clk_i(clk_i), .rst_i(1'b0), .d_i(row_w3_o), .q_o(row_late_o));
    fp3_delay #(.W(1), .N(ENDED)) u_absent (.clk_i(clk_i), .rst_i(1'b0), .d_i({1'b0, row_i} >= count_q), .q_o(absent_o));
    fp3_delay #(.W(ROW_W+1), .N(2)) u_st (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({{1'b0, st_row_i} >= count_q, st_row_i}), .q_o({st_absent_o, st_row_o}));
    assign executed_o = valid_i && !absent_o;
endmodule
`default_nettype wire
