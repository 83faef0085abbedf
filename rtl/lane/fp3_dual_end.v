// SPDX-License-Identifier: Apache-2.0
// fp3_dual_end: the end of instructions if a sum and a product may end at once: which object
// executes them.
//
// Purpose   No object sleeps, and objects come in order: an instruction is executed if its context
//           has an object. Says which words move between registers and store.
//
//           cycle    W-4                          W-1             W
//                    retire_i, store to be read   its word there  ends_o
//
// Latency   As shown.
// Hazard    One context does not come twice within GAP cycles (checked in two_streams). retire_i is
//           about the instructions of TO_END cycles ago. The host's accesses come when no
//           instruction is in the lane.
`default_nettype none
`include "lane/bundles.vh"
module fp3_dual_end #(
`include "config/config.vh"
) (
    input  wire                      clk_i,
    input  wire                      rst_i,
    input  wire [`FP3_DUAL_ISSUE_W-1:0]  issue_i,
    input  wire [`FP3_DUAL_RETIRE_W-1:0] retire_i,
    input  wire                      host_count_i,   // set the count
    input  wire [ROW_W:0]            host_data_i,
    output wire [`FP3_MOVE_W-1:0]        move_o,
    output wire [2*`FP3_END_W-1:0]       ends_o,         // of the product, of the sum
    output wire                      load_o,         // W-1: a value that is not the arithmetic's is a loaded word
    output wire [ROW_W:0]            count_o         // objects that are visited
);
    `FP3_DUAL_ISSUE_FIELDS
    `FP3_DUAL_RETIRE_FIELDS
    `FP3_MOVE_FIELDS
    assign `FP3_DUAL_ISSUE  = issue_i;      // cycle 0
    assign `FP3_DUAL_RETIRE = retire_i;     // cycle W-4

    // The number of objects, which are in the rows below
    reg [ROW_W:0] count_q;
    always @(posedge clk_i)
        if (rst_i)             count_q <= {ROW_W+1{1'b0}};
        else if (host_count_i) count_q <= host_data_i;
    assign count_o = count_q;

    assign move_record_shift = issue_record_shift;
    assign move_st        = issue_st;
    assign move_in_last   = 1'b1;
    assign move_register  = issue_register;
    assign move_st_row    = issue_st_row;                    // two cycles later than the rest
    assign move_st_absent = {1'b0, issue_st_row} >= count_q;
    assign move_st_asleep = 1'b0;
    // Objects do not see each other here.
    assign {move_st_upper, move_load_upper, move_load_place, move_st_whole, move_load_whole, move_place,
            move_st_list, move_st_ended, move_st_place} = {7+2*STORE_W{1'b0}};
    assign move_load          = retire_sum_loads || retire_product_loads;
    assign move_load_row      = retire_load_row;
    assign move_load_register = retire_load_register;
    assign move_o = `FP3_MOVE;
    fp3_delay #(.W(1), .N(TIMING_DUAL_END-1)) u_load (.clk_i(clk_i), .rst_i(1'b0), .d_i(move_load), .q_o(load_o));

    genvar p;
    generate
        for (p = 0; p < 2; p = p + 1) begin : g_stream
            `FP3_END_FIELDS
            wire [ROW_W-1:0] row   = p == 0 ? retire_sum_row : retire_product_row;
            wire             there = {1'b0, row} < count_q;
            wire             writes, there_w0;
            fp3_delay #(.W(2), .N(TIMING_DUAL_END)) u_end (.clk_i(clk_i), .rst_i(rst_i),
                .d_i(p == 0 ? {retire_sum_adds || retire_sum_loads, retire_sum_adds}
                            : {retire_product_valid, retire_product_valid && !retire_product_loads}),
                .q_o({writes, end_arithmetic}));
            fp3_delay #(.W(1), .N(TIMING_DUAL_END)) u_valid (.clk_i(clk_i), .rst_i(rst_i),
                .d_i(p == 0 ? retire_sum_valid : retire_product_valid), .q_o(end_valid));
            fp3_delay #(.W(1), .N(TIMING_DUAL_END)) u_there (.clk_i(clk_i), .rst_i(1'b0), .d_i(there), .q_o(there_w0));
            fp3_delay #(.W(REG_W), .N(TIMING_DUAL_END)) u_register (.clk_i(clk_i), .rst_i(1'b0),
                .d_i(p == 0 ? {retire_sum_context, retire_sum_register} : {retire_product_context, retire_product_register}),
                .q_o(end_register));
            fp3_delay #(.W(ROW_W), .N(TIMING_DUAL_END+1)) u_row (.clk_i(clk_i), .rst_i(1'b0), .d_i(row), .q_o(end_row));
            assign end_absent   = !there_w0;
            assign end_executed = end_valid && there_w0;
            assign end_writes   = writes && there_w0;
            assign ends_o[`FP3_END_W*p +: `FP3_END_W] = `FP3_END;
        end
    endgenerate
endmodule
`default_nettype wire
`include "config/undefine.vh"
