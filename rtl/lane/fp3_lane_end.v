// SPDX-License-Identifier: Apache-2.0
// fp3_lane_end: the end of an instruction, if one ends in each cycle: whether the object in its
// context executes it.
//
// Purpose   Takes the end of an instruction, finds the object in its context, and decides: is there
//           an object, is it awake, does it fall asleep. Says which words move between registers
//           and store.
//
//           cycle    E         E+3                    W = E + ENDED
//                    retire_i  row, store to be read  end_o; word_i is there
//
//           A suffix counts up from E (_e3 is in cycle E+3) or down to W (_w1 is in W-1). Where
//           objects see each other, the read of the store follows from reach_i instead, and its
//           word comes as many cycles later (lists).
//
// Latency   As shown; of a store's row, two cycles after issue_i.
// Hazard    One context does not come twice within GAP cycles. retire_i is about the instruction of
//           TO_END cycles ago, data_i in W about the same (checked in issue). The host's accesses
//           come when no instruction is in the lane.
`default_nettype none
`include "lane/bundles.vh"
module fp3_lane_end #(
`include "config/config.vh"
) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    input  wire [`FP3_REACH_W-1:0]  reach_i,
    input  wire [`FP3_ISSUE_W-1:0]  issue_i,
    input  wire [`FP3_RETIRE_W-1:0] retire_i,
    input  wire [`FP3_ACCESS_W-1:0] access_i,
    input  wire                 mine_i,         // the access is of this lane
    input  wire [31:0]          data_i,
    // W: the comparison of sleep, the word of lds
    input  wire                 less_i,
    input  wire [31:0]          word_i,
    input  wire [31:0]          stored_i3_i,    // cycle 3: the register that `each` names
    output wire [`FP3_MOVE_W-1:0]   move_o,
    output wire [`FP3_END_W-1:0]    end_o,
    output wire                 load_o,         // W: a value that is not the arithmetic's is a loaded word
    // Report
    output wire [ROW_W:0]       count_o,        // objects that are visited
    output wire [LENGTH_W-1:0]  longest_o,      // list of neighbours
    output wire                 sleeps_o,       // W: this instruction may change whether its object sleeps ...
    output wire                 batch_o,
    output wire [CONTEXT_W-1:0] context_o,
    output wire                 asleep_o        // ... two cycles later: it does
);
`include "host/lane_host.vh"
    `FP3_ISSUE_FIELDS
    `FP3_RETIRE_FIELDS
    `FP3_ACCESS_FIELDS
    `FP3_MOVE_FIELDS
    `FP3_END_FIELDS
    assign `FP3_ISSUE  = issue_i;           // cycle 0
    assign `FP3_RETIRE = retire_i;          // cycle W - ENDED
    assign `FP3_ACCESS = access_i;
    assign {move_record_shift, move_st, move_in_last, move_register}
        = {issue_record_shift, issue_st, issue_in_last, issue_register};
    assign {move_o, end_o} = {`FP3_MOVE, `FP3_END};
    wire unused_data = &data_i;

    // Of the instruction, later
    wire [REGISTER_W-1:0] register_e3, register_w0;
    wire [CONTEXT_W-1:0]  context_e2, context_w1, context_w0;
    wire take_e2, valid_w0, begins_w0, ends_w0, in_last_w0, lds_w0, sleep_w0, load_w0, arithmetic_w0, batch_w0;
    fp3_delay #(.W(1+CONTEXT_W), .N(TIMING_END-4)) u_e2 (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({retire_valid && retire_begins, retire_context}), .q_o({take_e2, context_e2}));
    fp3_delay #(.W(CONTEXT_W), .N(3+WIDENED)) u_context_w1 (.clk_i(clk_i), .rst_i(1'b0), .d_i(context_e2),
        .q_o(context_w1));
    fp3_delay #(.W(CONTEXT_W), .N(1)) u_context_w0 (.clk_i(clk_i), .rst_i(1'b0), .d_i(context_w1), .q_o(context_w0));
    fp3_delay #(.W(REGISTER_W), .N(TIMING_END-3)) u_register_e3 (.clk_i(clk_i), .rst_i(1'b0), .d_i(retire_register),
        .q_o(register_e3));
    fp3_delay #(.W(REGISTER_W), .N(3+WIDENED)) u_register_w0 (.clk_i(clk_i), .rst_i(1'b0), .d_i(register_e3),
        .q_o(register_w0));
    fp3_delay #(.W(9), .N(ENDED)) u_w0 (.clk_i(clk_i), .rst_i(rst_i),
        .d_i({retire_valid, retire_begins, retire_ends, retire_in_last, retire_lds, retire_sleep,
              retire_load, retire_arithmetic, retire_batch}),
        .q_o({valid_w0, begins_w0, ends_w0, in_last_w0, lds_w0, sleep_w0, load_w0, arithmetic_w0, batch_w0}));

    // Which object executes it
    // --------------------------------------------------------------------------
    wire executed, absent, sleeps;
    wire executes, missing, ended;              // the first two as if there were no loops
    wire [ROW_W-1:0] own_row_e3;
    wire host_count = mine_i && access_write && access_space == HOST_AWAKE;
    generate
        if (SLEEP != 0) begin : g_sleep
            reg nonzero_q;                      // W+1
            always @(posedge clk_i) nonzero_q <= |word_i;
            fp3_visits #(.CONTEXTS(CONTEXTS), .CONTEXT_W(CONTEXT_W), .ROW_W(ROW_W), .ENDED(ENDED)) u_visits (
                .clk_i(clk_i), .rst_i(rst_i), .round_i(retire_round), .take_i(retire_valid && retire_begins),
                .take_e2_i(take_e2), .context_e2_i(context_e2), .row_e3_o(own_row_e3), .row_late_o(end_row),
                .context_w1_i(context_w1), .valid_i(valid_w0), .begins_i(begins_w0), .ends_i(ends_w0),
                .in_last_i(in_last_w0), .lds_i(lds_w0), .sleep_i(sleep_w0), .context_i(context_w0),
                .less_i(less_i), .executed_o(executes), .absent_o(missing), .sleeps_o(sleeps),
                .nonzero_i(nonzero_q), .asleep_o(asleep_o),
                .st_context_i(issue_context), .st_row_o(move_st_row), .st_absent_o(move_st_absent),
                .st_asleep_o(move_st_asleep),
                .host_clear_i(host_count), .host_wake_i(mine_i && access_write && access_space == HOST_WAKE),
                .host_row_i(data_i[ROW_W-1:0]), .count_o(count_o));
        end else begin : g_order
            // Rows 0, 1 .. in the order in which contexts issue: the sequencer knows them. The
            // count changes only between runs.
            reg [ROW_W:0] count_q;
            always @(posedge clk_i)
                if (rst_i)           count_q <= {ROW_W+1{1'b0}};
                else if (host_count) count_q <= data_i[ROW_W:0];
            assign count_o = count_q;
            fp3_delay #(.W(ROW_W), .N(TIMING_END-3)) u_row_e3 (.clk_i(clk_i), .rst_i(1'b0), .d_i(retire_row),
                .q_o(own_row_e3));
            fp3_delay #(.W(ROW_W), .N(4+WIDENED)) u_row_late (.clk_i(clk_i), .rst_i(1'b0), .d_i(own_row_e3),
                .q_o(end_row));
            fp3_delay #(.W(1), .N(ENDED)) u_absent (.clk_i(clk_i), .rst_i(1'b0),
                .d_i({1'b0, retire_row} >= count_q), .q_o(missing));
            fp3_delay #(.W(ROW_W+1), .N(2)) u_st (.clk_i(clk_i), .rst_i(1'b0),
                .d_i({{1'b0, issue_row} >= count_q, issue_row}), .q_o({move_st_absent, move_st_row}));
            assign executes = valid_w0 && !missing;
            assign {sleeps, asleep_o, move_st_asleep} = 3'b000;
            wire unused = &{take_e2, context_e2, context_w1, begins_w0, ends_w0, in_last_w0, less_i, word_i};
        end
    endgenerate

    // Neighbours: the words that are loaded, and the contexts whose list has ended
    // --------------------------------------------
    generate
        if (NEIGHBOURS != 0) begin : g_lists
            `FP3_REACH_FIELDS
            assign `FP3_REACH = reach_i;
            fp3_lists #(.CONFIG(CONFIG)) u_lists (.clk_i(clk_i), .rst_i(rst_i),
                .each_i(issue_each), .keep_i(issue_keep), .first_i(issue_first), .context_i(issue_context), .absent_i2(move_st_absent),
                .word_i3(stored_i3_i),
                .longest_o(longest_o), .valid_i(reach_valid), .reach_context_i(reach_context), .own_i(reach_row),
                .around_i(reach_around),
                .of_list_o(move_load_place), .place_o(move_place), .row_o(move_load_row), .number_o(move_load_register),
                .half_o(move_load_upper),
                .st_list_o(move_st_list), .st_place_o(move_st_place), .st_ended_o(move_st_ended), .word_i(word_i), .ended_o(ended));
            fp3_delay #(.W(1), .N(3)) u_load (.clk_i(clk_i), .rst_i(rst_i), .d_i(reach_load), .q_o(move_load));
            assign move_load_whole = 1'b0;
            wire unused_lists = &{own_row_e3, register_e3};
        end else begin : g_no_lists
            fp3_delay #(.W(1), .N(TIMING_END-3)) u_load_e3 (.clk_i(clk_i), .rst_i(rst_i),
                .d_i(retire_valid && retire_load), .q_o(move_load));
            fp3_delay #(.W(1), .N(TIMING_END-3)) u_whole_e3 (.clk_i(clk_i), .rst_i(1'b0), .d_i(retire_whole),
                .q_o(move_load_whole));
            assign {ended, move_load_place, move_load_upper} = 3'd0;
            assign {longest_o, move_place} = {LENGTH_W+STORE_W{1'b0}};
            assign {move_st_list, move_st_ended, move_st_place} = {2+STORE_W{1'b0}};
            assign move_load_row      = own_row_e3;
            assign move_load_register = register_e3;
            wire unused_lists = &{stored_i3_i, reach_i};
        end
    endgenerate
    assign executed      = executes && !ended;
    assign absent        = missing || ended;
    assign {move_st_upper, move_st_whole} = {issue_upper, issue_whole};

    assign end_valid      = valid_w0;
    assign end_absent     = absent;
    assign end_executed   = executed;
    assign end_writes     = (executed && (arithmetic_w0 || load_w0)) || sleeps;
    assign end_arithmetic = arithmetic_w0;
    assign end_register   = {context_w0, register_w0};
    assign {load_o, batch_o, context_o} = {load_w0, batch_w0, context_w0};
    assign sleeps_o       = valid_w0 && (sleep_w0 || lds_w0);

`ifdef FP3_CHECK
    wire [REG_W-1:0] named;                     // by the instruction of TO_END cycles ago
    reg  [15:0]      age [0:CONTEXTS-1];        // cycles since a context came
    reg  [15:0]      since_q;                   // since an access
    wire             lone = access_valid && !(OVERLAP != 0 && access_space == HOST_OBJECT);     // of the store: checked there
    reg  [ENDED+1:0] valid_q;                   // W - ENDED + 1 .. W + 2
    integer          k;
    fp3_delay #(.W(REG_W), .N(TO_END)) u_named (.clk_i(clk_i), .rst_i(1'b0), .d_i({issue_context, issue_register}),
        .q_o(named));
    always @(posedge clk_i) begin
        valid_q <= {valid_q[ENDED:0], retire_valid} & {ENDED+2{!rst_i}};
        since_q <= rst_i ? 16'hffff : lone ? 16'd1 : since_q == 16'hffff ? since_q : since_q + 1'b1;
        for (k = 0; k < CONTEXTS; k = k + 1) begin
            age[k] <= rst_i ? 16'hffff : retire_valid && retire_context == k[CONTEXT_W-1:0] ? 16'd1
                    : age[k] == 16'hffff ? age[k] : age[k] + 1'b1;
            if (!rst_i && retire_valid && retire_context == k[CONTEXT_W-1:0] && {16'd0, age[k]} < GAP) begin
                $display("%m: context %0d comes again after %0d cycles", k, age[k]); $stop;
            end
        end
        if (!rst_i && retire_valid && named != {retire_context, retire_register}) begin
            $display("%m: the end of another instruction than the one of %0d cycles ago", TO_END); $stop;
        end
        if (!rst_i && (lone ? retire_valid || |valid_q : retire_valid && {16'd0, since_q} <= TO_END)) begin
            $display("%m: an access of the host while instructions are in the lane"); $stop;
        end
    end
`endif
endmodule
`default_nettype wire
`include "config/undefine.vh"
