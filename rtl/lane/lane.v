// lane: the registers of some objects, the store behind them, and what becomes of each result.
//
// Purpose   Does what its sequencer says, one instruction per cycle, for as many objects as there are
//           contexts. Whatever depends on an object's data is decided here and nowhere else.
//
//           cycle    0         1, 2       3         .. W = RESULT       W+1
//           issue    operands  registers  operands  arithmetic, result   written, retired
//                    named     read       to it
//           retire             told in W-6, row W-3, store read from W-2   word there in W
//
//           A signal's suffix counts up from the issue (_i2 is in cycle 2) or down to the result (_w6 is in
//           cycle W-6).
//
// Latency   A register that is named GAP cycles after the issue of the instruction that
//           writes it, or later, has the new value. All results are equally late, so everything
//           happens in the order of issue.
// Hazard    Nothing is interlocked here: one context does not come twice within GAP cycles.
//           retire_i is about the instruction of END cycles ago; data_i, of RESULT (checked in issue).
//           The host's accesses come when no instruction is in the lane.
`default_nettype none
`include "lane/lane.vh"
module lane #(
`include "config/config.vh"
) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    input  wire [LANE_W-1:0]    index_i,        // this lane's number; does not change
    // What the sequencer and the host say
    input  wire [`ISSUE_W-1:0]  issue_i,
    input  wire [`RETIRE_W-1:0] retire_i,
    input  wire [`ACCESS_W-1:0] access_i,
    input  wire [31:0]          data_i,         // the number of the step; of an access: its word
    // What they hear, gathered from lane to lane
    input  wire [`REPORT_W-1:0] report_i,
    output wire [`REPORT_W-1:0] report_o,
    // The arithmetic
    output wire [`OPERANDS_W-1:0] operands_o,
    input  wire [`RESULT_W-1:0]   result_i,
    output wire [`WRITTEN_W-1:0]  written_o     // trace
);
`include "host/lane_host.vh"
    localparam [CONTEXT_W-1:0] SHARED = CONTEXTS[CONTEXT_W-1:0];

    `ISSUE_FIELDS
    `RETIRE_FIELDS
    `ACCESS_FIELDS
    `RESULT_FIELDS
    assign `RESULT = result_i;
    assign `ISSUE  = issue_i;           // cycle 0
    assign `RETIRE = retire_i;          // cycle W-6
    assign `ACCESS = access_i;
    wire mine  = access_valid && access_lane == index_i;
    wire write = mine && access_write;

    // The end of the instruction, later
    wire [CONTEXT_W-1:0]  context_w4, context_w1, context_w0;
    wire [REGISTER_W-1:0] register_w3, register_w0;
    wire                  load_w3;
    delay #(.W(1), .N(TIMING_END-3)) u_load_w3 (.clk_i(clk_i), .rst_i(rst_i), .d_i(retire_valid && retire_load), .q_o(load_w3));
    wire take_w4, valid_w0, begins_w0, ends_w0, lasts_w0, lds_w0, sleep_w0, load_w0, arithmetic_w0, batch_w0;
    delay #(.W(1+CONTEXT_W), .N(TIMING_END-4)) u_w4 (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({retire_valid && retire_begins, retire_context}), .q_o({take_w4, context_w4}));
    delay #(.W(CONTEXT_W), .N(3)) u_context_w1 (.clk_i(clk_i), .rst_i(1'b0), .d_i(context_w4), .q_o(context_w1));
    delay #(.W(CONTEXT_W), .N(1)) u_context_w0 (.clk_i(clk_i), .rst_i(1'b0), .d_i(context_w1), .q_o(context_w0));
    delay #(.W(REGISTER_W), .N(TIMING_END-3)) u_register_w3 (.clk_i(clk_i), .rst_i(1'b0), .d_i(retire_register), .q_o(register_w3));
    delay #(.W(REGISTER_W), .N(3)) u_register_w0 (.clk_i(clk_i), .rst_i(1'b0), .d_i(register_w3), .q_o(register_w0));
    delay #(.W(9), .N(TIMING_END)) u_w0 (.clk_i(clk_i), .rst_i(rst_i),
        .d_i({retire_valid, retire_begins, retire_ends, retire_lasts, retire_lds, retire_sleep, retire_load, retire_arithmetic, retire_batch}),
        .q_o({valid_w0, begins_w0, ends_w0, lasts_w0, lds_w0, sleep_w0, load_w0, arithmetic_w0, batch_w0}));

    // Operands: read, forced, compared -------------------------------------------------------------
    wire             writes_now;                // W+1
    wire [REG_W-1:0] write_register;
    wire [31:0]      write_value, st_value_i3;
    wire             less_w0;
    lane_operands #(.CONFIG(CONFIG)) u_operands (.clk_i(clk_i),
        .write_i(writes_now), .write_register_i(write_register), .write_value_i(write_value),
        .issue_i(issue_i), .operands_o(operands_o), .stored_o(st_value_i3), .less_o(less_w0));
    wire unused_issue = &{issue_choice, issue_subtract, issue_twice, issue_half, issue_one, issue_zero, issue_x, issue_y, issue_z};

    // Whose turn it is -----------------------------------------------------------------------------
    wire [ROW_W-1:0] row_w3, row_late, st_row_i2;
    wire             executed, sleeps, absent, st_absent_i2, st_asleep_i2, asleep;
    wire [31:0]      stored_w0, status_w0;      // the store's word
    wire [ROW_W:0]   count;
    wire             host_count = write && access_space == HOST_AWAKE;
    generate
        if (SLEEP != 0) begin : g_sleep
            reg nonzero_q;                      // W+1
            always @(posedge clk_i) nonzero_q <= |stored_w0;
            visits #(.CONFIG(CONFIG)) u_visits (
                .clk_i(clk_i), .rst_i(rst_i), .round_i(retire_round), .take_i(retire_valid && retire_begins),
                .take_w4_i(take_w4), .context_w4_i(context_w4), .row_w3_o(row_w3), .row_late_o(row_late),
                .context_w1_i(context_w1), .valid_i(valid_w0), .begins_i(begins_w0), .ends_i(ends_w0),
                .lasts_i(lasts_w0), .lds_i(lds_w0), .sleep_i(sleep_w0), .context_i(context_w0),
                .less_i(less_w0), .executed_o(executed), .absent_o(absent), .sleeps_o(sleeps), .nonzero_i(nonzero_q), .asleep_o(asleep),
                .st_context_i(issue_context), .st_row_o(st_row_i2), .st_absent_o(st_absent_i2), .st_asleep_o(st_asleep_i2),
                .host_clear_i(host_count), .host_wake_i(write && access_space == HOST_WAKE),
                .host_row_i(data_i[ROW_W-1:0]), .count_o(count));
            wire unused = &{issue_row, retire_row};
        end else begin : g_order
            visits_in_order #(.CONFIG(CONFIG)) u_visits (
                .clk_i(clk_i), .rst_i(rst_i), .row_i(retire_row), .row_w3_o(row_w3), .row_late_o(row_late),
                .valid_i(valid_w0), .executed_o(executed), .absent_o(absent),
                .st_row_i(issue_row), .st_row_o(st_row_i2), .st_absent_o(st_absent_i2),
                .host_count_i(host_count), .host_data_i(data_i[ROW_W:0]), .count_o(count));
            assign {sleeps, asleep, st_asleep_i2} = 3'b000;
            wire unused = &{issue_context, retire_round, take_w4, context_w4, context_w1, begins_w0, ends_w0, lasts_w0, less_w0};
        end
    endgenerate

    lane_store #(.CONFIG(CONFIG)) u_store (.clk_i(clk_i), .rst_i(rst_i), .record_i(issue_record),
        .st_i(issue_st), .lasts_i(issue_lasts), .register_i(issue_register),
        .row_i2_i(st_row_i2), .absent_i2_i(st_absent_i2), .asleep_i2_i(st_asleep_i2), .value_i3_i(st_value_i3),
        .load_i(load_w3), .row_w3_i(row_w3), .register_w3_i(register_w3), .word_o(stored_w0),
        .host_i(access_valid), .host_write_i(write && access_space == HOST_OBJECT), .host_address_i(access_address),
        .host_word_i(data_i));

    // A result: written in W+1 ------------------------------------------------------------------------
    wire writes   = (executed && (arithmetic_w0 || load_w0)) || sleeps;
    wire raises   = FLAGS != 0 && executed && arithmetic_w0;
    wire constant = access_valid && access_write && access_space == HOST_CONSTANT;     // of all lanes
    wire [4:0] flags;
    lane_result #(.CONFIG(CONFIG)) u_result (.clk_i(clk_i), .rst_i(rst_i),
        .valid_i(valid_w0), .absent_i(absent), .executed_i(executed), .writes_i(writes), .raises_i(raises), .constant_i(constant),
        .register_i(constant ? {SHARED, access_address[REGISTER_W-1:0]} : {context_w0, register_w0}),
        .value_i(arithmetic_w0 ? result_value : load_w0 ? stored_w0 : data_i), .flags_i(result_flags), .row_late_i(row_late),
        .write_o(writes_now), .register_o(write_register), .value_o(write_value), .flags_o(flags), .written_o(written_o));
    lane_status #(.CONFIG(CONFIG)) u_status (.clk_i(clk_i), .rst_i(rst_i),
        .row_w3_i(row_w3), .raises_i(raises), .flags_i(result_flags), .step_i(data_i[26:0]), .status_o(status_w0),
        .host_i(access_valid), .host_write_i(write && access_space == HOST_STATUS),
        .host_row_i(access_address[ROW_W-1:0]), .host_word_i(data_i));

    // What the sequencer and the host hear ---------------------------------------------------------------
    lane_report #(.CONFIG(CONFIG)) u_report (.clk_i(clk_i), .rst_i(rst_i), .report_i(report_i),
        .count_i(count), .flags_i(flags), .asleep_i(asleep),
        .valid_i(valid_w0 && (sleep_w0 || lds_w0)), .batch_i(batch_w0), .context_i(context_w0),
        .mine_i(mine), .space_i(access_space), .stored_i(stored_w0), .status_i(status_w0), .report_o(report_o));

`ifdef FP3_CHECK
    wire [REG_W-1:0] named;                     // by the instruction of END cycles ago
    reg  [15:0]      age [0:CONTEXTS-1];        // cycles since a context came
    reg  [15:0]      since_q;                   // since an access
    reg  [7:0]       valid_q;                   // W-5 .. W+2
    integer          k;
    delay #(.W(REG_W), .N(END)) u_named (.clk_i(clk_i), .rst_i(1'b0), .d_i({issue_context, issue_register}), .q_o(named));
    always @(posedge clk_i) begin
        valid_q <= {valid_q[6:0], retire_valid} & {8{!rst_i}};
        since_q <= rst_i ? 16'hffff : access_valid ? 16'd1 : since_q == 16'hffff ? since_q : since_q + 1'b1;
        for (k = 0; k < CONTEXTS; k = k + 1) begin
            age[k] <= rst_i ? 16'hffff : retire_valid && retire_context == k[CONTEXT_W-1:0] ? 16'd1
                    : age[k] == 16'hffff ? age[k] : age[k] + 1'b1;
            if (!rst_i && retire_valid && retire_context == k[CONTEXT_W-1:0] && {16'd0, age[k]} < GAP) begin
                $display("%m: context %0d comes again after %0d cycles", k, age[k]); $stop;
            end
        end
        if (!rst_i && retire_valid && named != {retire_context, retire_register}) begin
            $display("%m: the end of another instruction than the one of %0d cycles ago", END); $stop;
        end
        if (!rst_i && (access_valid ? retire_valid || |valid_q : retire_valid && {16'd0, since_q} <= END)) begin
            $display("%m: an access of the host while instructions are in the lane"); $stop;
        end
    end
`endif
endmodule
`default_nettype wire
