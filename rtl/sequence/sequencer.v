// sequencer: runs a program over the objects of its lanes, as many at a time as there are contexts.
//
// Purpose   Tells its lanes, every cycle, which instruction to execute for which context. Each
//           instruction issues for all contexts of the batch in turn (a sweep) before the next is
//           fetched, so that its latency passes while others issue.
//
//           rounds ──► fetch ─► decode ──► sweep ─────────► issue ─► lanes
//                      batch: its contexts   │ pace: not yet           │
//                        ▲                                             │
//                        └────────────────── reports ◄─────────────────┘
//
// Latency   From the sweep to the lane two cycles. A sweep of GAP contexts or more needs no
//           pause; a shorter one is followed by the cycles that are missing (stall_dependency).
// Hazard    Nothing but pace protects a context from itself: between two issues of one context
//           at least GAP cycles pass.
//           Every running cycle is an issue or exactly one stall, and no other cycle is either.
//           Once the last part of a visit has begun to issue, no stop comes before its end.
`default_nettype none
`include "front/decoded.vh"
`include "sequence/marks.vh"
`include "lane/issue.vh"
`include "lane/retire.vh"
`include "lane/report.vh"
module sequencer #(
`include "config/config.vh"
) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    // A run; what describes it is stable from start_i to its end
    input  wire                 start_i,
    input  wire                 stop_i,
    input  wire [31:0]          steps_i,        // >= 1
    input  wire [31:0]          visit_i,        // steps per visit; 0: all
    input  wire [31:0]          clock_i,        // steps before this run
    input  wire [1:0]           record_i,       // a record has 8 << record_i words
    input  wire [PROGRAM_W-1:0] step_i,
    input  wire [PROGRAM_W-1:0] step_end_i,
    input  wire [PROGRAM_W-1:0] end_i,
    output wire                 running_o,
    output wire                 illegal_o,      // the word at illegal_pc_o ends the run
    output wire [PROGRAM_W-1:0] illegal_pc_o,
    // The host writes the program
    input  wire                 program_write_i,
    input  wire [PROGRAM_W-1:0] program_addr_i,
    input  wire [31:0]          program_word_i,
    // Units shared with other schedulers
    output wire                 adds_o,         // this instruction needs the adder
    output wire                 muls_o,
    output wire                 lasts_o,        // the last of a sweep
    input  wire                 grant_i,
    // To the first lane, from the last
    output wire [`ISSUE_W-1:0]  issue_o,
    output wire [`RETIRE_W-1:0] retire_o,
    output wire [31:0]          step_o,         // the number of the step
    input  wire [`REPORT_W-1:0] report_i,
    // What happens in this cycle, for counters and traces
    output wire [4:0]           issued_o,       // memory, sleep, chain, mul, add
    output wire                 retired_o,
    output wire                 stall_fetch_o,
    output wire                 stall_dependency_o,
    output wire                 stall_unit_o,
    output wire                 stall_asleep_o,
    output wire                 stall_drain_o,
    output wire                 trace_o,
    output wire [PROGRAM_W-1:0] trace_pc_o,
    output wire [CONTEXT_W-1:0] trace_context_o,
    output wire [31:0]          trace_word_o
);
    localparam COUNT_W = $clog2(GAP + CONTEXTS + 1);
    `REPORT_FIELDS
    assign `REPORT = report_i;

    wire        open, starts, in_round, issuing, storing, abort;
    wire [31:0] steps, base, last;
    reg         illegal_q;
    rounds #(.CONFIG(CONFIG)) u_rounds (.clk_i(clk_i), .rst_i(rst_i),
        .start_i(start_i), .stop_i(stop_i), .illegal_i(illegal_q), .steps_i(steps_i), .visit_i(visit_i), .clock_i(clock_i),
        .running_o(running_o), .count_i(report_count), .issuing_i(issuing), .storing_i(storing),
        .open_o(open), .begin_o(starts), .round_o(in_round), .abort_o(abort), .steps_o(steps), .base_o(base), .end_o(last));

    // Fetch and decode ---------------------------------------------------------------------------
    `MARKS_FIELDS
    wire [`DECODED_W-1:0] decoded;
    wire                  d_ready, fetched, fetch_empty, again, more, skip;
    wire [PROGRAM_W-1:0]  fetch_pc;
    wire [31:0]           fetch_word;
    fetch #(.ADDR_W(PROGRAM_W)) u_fetch (.clk_i(clk_i), .rst_i(rst_i),
        .write_i(program_write_i), .write_addr_i(program_addr_i), .write_word_i(program_word_i),
        .start_i(starts), .stop_i(abort), .steps_i(steps), .step_i(step_i), .step_end_i(step_end_i), .end_i(end_i),
        .skip_i(skip), .more_i(more), .again_o(again),
        .advance_i(d_ready), .valid_o(fetched), .pc_o(fetch_pc), .word_o(fetch_word),
        .begins_o(begins), .ends_o(ends), .steps_o(newstep), .lasts_o(lasts), .empty_o(fetch_empty));
    decode #(.CONFIG(CONFIG)) u_decode (.word_i(fetch_word), .decoded_o(decoded));

    wire [CONTEXTS-1:0] mask;
    wire                batch;
    batch #(.CONFIG(CONFIG)) u_batch (.clk_i(clk_i), .rst_i(rst_i), .open_i(open), .count_i(report_count),
        .again_i(again), .more_o(more), .skip_o(skip),
        .take_i(d_ready && fetched), .begins_i(begins), .lasts_i(lasts), .mask_o(mask), .batch_o(batch),
        .valid_i(report_valid), .asleep_i(report_asleep), .reported_batch_i(report_batch), .reported_context_i(report_context));

    // The next instruction: it waits here until its sweep may begin ----------------------------------
    reg                      d_valid_q, d_seen_q;             // valid for a cycle: what follows is known
    reg                      d_goes_q, d_drops_q, d_traps_q;  // to the sweep, nowhere (nobody is awake), illegal
    reg                      d_lasts_q;
    reg [`DECODED_W-1:0]     d_decoded_q;
    reg [`MARKS_W-1:0]       d_marks_q;
    reg [PROGRAM_W+31:0]     d_trace_q;
    reg [CONTEXTS-1:0]       d_mask_q;
    wire                     s_busy, s_last;
    wire                     d_known, d_may;
    wire                     d_empty = d_mask_q == {CONTEXTS{1'b0}};
    wire                     d_load = d_may && d_goes_q;
    wire                     d_take = d_load || (d_known && d_drops_q);
    `DECODED_FIELDS
    assign `DECODED = d_decoded_q;
    wire unused = &{`DECODED, report_flags, report_answer};   // issue's; the host's
    assign d_ready = !d_valid_q;       // a sweep is long enough for a cycle without one
    always @(posedge clk_i) begin
        if (rst_i || abort || d_take) d_valid_q <= 1'b0;
        else if (d_ready)             d_valid_q <= fetched;
        if (d_ready) begin
            {d_decoded_q, d_marks_q, d_lasts_q} <= {decoded, `MARKS, lasts};
            d_trace_q <= {fetch_pc, fetch_word};
            d_mask_q  <= mask;
        end
        d_seen_q  <= d_valid_q;
        d_goes_q  <= legal && !d_empty;
        d_drops_q <= legal && d_empty;
        d_traps_q <= !legal;
        illegal_q <= !rst_i && d_known && d_traps_q && !s_busy && !illegal_q;
    end
    assign illegal_o    = illegal_q;
    assign illegal_pc_o = d_trace_q[PROGRAM_W+31:32];

    // The sweep -----------------------------------------------------------------------------------
    wire                s_issue = s_busy && grant_i;
    wire [CONTEXTS-1:0] s_current;
    wire [COUNT_W-1:0]  count;
    pace #(.CONTEXTS(CONTEXTS), .GAP(GAP), .COUNT_W(COUNT_W)) u_pace (.clk_i(clk_i), .rst_i(rst_i), .start_i(open),
        .valid_i(d_valid_q), .mask_i(d_mask_q), .take_i(d_take), .known_o(d_known), .count_o(count), .may_o(d_may),
        .busy_i(s_busy), .over_i(s_issue && s_last));
    sweep #(.CONTEXTS(CONTEXTS), .COUNT_W(COUNT_W)) u_sweep (.clk_i(clk_i), .rst_i(rst_i || abort), .load_i(d_load),
        .mask_i(d_mask_q), .count_i(count), .next_i(s_issue), .busy_o(s_busy), .current_o(s_current), .last_o(s_last));

    reg                      s_first_q, s_batch_q, s_lasts_q;
    reg [`DECODED_W-1:0]     s_decoded_q;
    reg [`MARKS_W-1:0]       s_marks_q;
    reg [PROGRAM_W+31:0]     s_trace_q;
    always @(posedge clk_i)
        if (d_load) begin
            {s_decoded_q, s_marks_q, s_lasts_q} <= {d_decoded_q, d_marks_q, d_lasts_q};
            s_batch_q <= batch;
            s_trace_q <= d_trace_q;
            s_first_q <= 1'b1;
        end else if (s_issue) s_first_q <= 1'b0;
    assign issuing = !fetch_empty || d_valid_q || s_busy;
    assign storing = (d_valid_q && d_lasts_q) || (s_busy && s_lasts_q);

    wire adds, muls;
    issue #(.CONFIG(CONFIG)) u_issue (.clk_i(clk_i), .rst_i(rst_i),
        .record_i(record_i), .open_i(open), .base_i(base), .end_i(last),
        .issue_i(s_issue), .first_i(s_first_q), .batch_i(s_batch_q), .current_i(s_current),
        .decoded_i(s_decoded_q), .marks_i(s_marks_q),
        .adds_o(adds), .muls_o(muls), .issued_o(issued_o), .issue_o(issue_o), .retire_o(retire_o), .step_o(step_o),
        .valid_o(trace_o), .context_o(trace_context_o), .retired_o(retired_o));
    assign {adds_o, muls_o, lasts_o} = {s_busy && adds, s_busy && muls, s_last};
    delay #(.W(PROGRAM_W+32), .N(1)) u_trace (.clk_i(clk_i), .rst_i(1'b0), .d_i(s_trace_q), .q_o({trace_pc_o, trace_word_o}));

    // Every running cycle is an issue or exactly one stall -----------------------------------------
    wire quiet = running_o && !s_busy;
    assign stall_unit_o       = s_busy && !grant_i;
    assign stall_asleep_o     = quiet && d_valid_q && d_seen_q && d_drops_q;
    assign stall_dependency_o = quiet && d_known && d_goes_q && !d_may;
    assign stall_fetch_o      = quiet && in_round && issuing && !stall_asleep_o && !stall_dependency_o;
    assign stall_drain_o      = quiet && !stall_asleep_o && !stall_dependency_o && !stall_fetch_o;

`ifdef FP3_CHECK
    reg  [15:0] age [0:CONTEXTS-1];    // cycles since a context issued
    reg         stores_q;              // a last part has begun to issue, and has not ended
    wire [5:0]  causes = {s_issue, stall_unit_o, stall_asleep_o, stall_dependency_o, stall_fetch_o, stall_drain_o};
    reg         d_ends_q, s_ends_q;    // the last of a visit
    integer     k;
    always @(posedge clk_i) begin
        if (d_ready) d_ends_q <= ends;
        if (d_load)  s_ends_q <= d_ends_q;
        stores_q <= !rst_i && !abort && ((s_issue && s_lasts_q) || stores_q) && !(s_issue && s_last && s_ends_q);
        for (k = 0; k < CONTEXTS; k = k + 1) begin
            age[k] <= rst_i ? 16'hffff : s_issue && s_current[k] ? 16'd1 : age[k] == 16'hffff ? age[k] : age[k] + 1'b1;
            if (!rst_i && s_issue && s_current[k] && {16'd0, age[k]} < GAP) begin
                $display("%m: context %0d issued again after %0d cycles, %0d are needed", k, age[k], GAP); $stop;
            end
        end
        if (!rst_i && (running_o ? causes == 6'd0 || |(causes & (causes - 1'b1)) : |causes)) begin
            $display("%m: issue and stalls %b in a cycle, running is %b", causes, running_o); $stop;
        end
        if (!rst_i && abort && !illegal_q && stores_q) begin
            $display("%m: a stop between the stores of a visit"); $stop;
        end
    end
`endif
endmodule
`default_nettype wire
