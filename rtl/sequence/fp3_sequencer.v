// SPDX-License-Identifier: Apache-2.0
// fp3_sequencer: runs a program over the objects of its lanes, one batch at a time.
//
// Purpose   Tells its lanes, every cycle, which instruction to execute for which context; with two
//           streams, which sum and which product. Each instruction issues for all contexts of the
//           batch, one per cycle (a sweep), which hides its latency. The stream modules hold the
//           instruction under way, and decide when the next one may begin.
//
//           rounds ──► fetch ─► decode ──► the next instruction ──► one_stream, two_streams ──► lanes
//                      batch: its contexts        ▲                                               │
//                        ▲                        └ legal, and for an object?                      │
//                        └────────────────────────── reports ◄────────────────────────────────────┘
//
// Latency   See one_stream and two_streams. A sweep that has to wait for the one before is counted
//           (stall_dependency). With NEIGHBOURS a register stands behind decode, so a round's first
//           instruction comes a cycle later.
// Hazard    Every running cycle is an issue or exactly one stall; no other cycle is one of these.
//           Once the last part of a visit has begun to issue, no stop comes before its end.
`default_nettype none
`include "front/decoded.vh"
`include "gen/settings.vh"
`include "gen/events.vh"
`include "front/marks.vh"
`include "sequence/issued.vh"
`include "lane/bundles.vh"
module fp3_sequencer #(
`include "config/config.vh"
) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    // A run; its settings are stable from start_i to its end
    input  wire                 start_i,
    input  wire                 stop_i,
    input  wire [`FP3_SETTINGS_W-1:0] settings_i,
    output wire                 running_o,
    output wire                 illegal_o,      // the word at illegal_pc_o ends the run
    output wire [PROGRAM_W-1:0] illegal_pc_o,
    output wire                 half_o,         // of the store: it has the published words
    output wire                 settled_o,      // every report about a round has come ...
    output wire                 held_o,         // ... which ended with `hold`
    // Copies from lane to lane (exchange)
    output wire                 copy_o,         // a round is about to begin
    output wire                 abort_o,        // there will be none
    input  wire                 copied_i,       // it may
    // The host writes the program
    input  wire                 program_write_i,
    input  wire [PROGRAM_W-1:0] program_addr_i,
    input  wire [31:0]          program_word_i,
    // Units shared with other schedulers
    output wire                 adds_o,         // this instruction needs the adder
    output wire                 muls_o,
    output wire                 sweep_end_o,    // the last of its sweep
    input  wire                 grant_i,
    // To the first lane, from the last
    output wire [`FP3_REACH_W-1:0]       reach_o,
    output wire [`FP3_LANE_ISSUE_W-1:0]  issue_o,
    output wire [`FP3_LANE_RETIRE_W-1:0] retire_o,
    output wire [31:0]               step_o,    // the number of the step
    output wire [DRAW_W-1:0]         draw_o,    // DRAW
    input  wire [`FP3_REPORT_W-1:0]      report_i,
    // What happens in this cycle
    output wire [`FP3_EVENTS_W-1:0]         events_o,
    output wire [`FP3_ISSUED_W*STREAMS-1:0] issued_o
);
    `FP3_REPORT_FIELDS
    assign `FP3_REPORT = report_i;

    wire        open, starts, in_round, issuing, storing, abort, closed, partial;
    wire [31:0] steps, base, end_step;
    reg         illegal_q;
    fp3_rounds #(.CONFIG(CONFIG)) u_rounds (.clk_i(clk_i), .rst_i(rst_i),
        .start_i(start_i), .stop_i(stop_i), .illegal_i(illegal_q), .no_room_i(report_no_room), .settings_i(settings_i),
        .running_o(running_o), .count_i(report_count), .issuing_i(issuing), .storing_i(storing), .partial_i(partial),
        .copied_i(copied_i), .copy_o(copy_o), .closed_o(closed), .settled_o(settled_o),
        .open_o(open), .begin_o(starts), .round_o(in_round), .abort_o(abort), .steps_o(steps), .base_o(base),
        .end_o(end_step));

    assign abort_o = abort;

    // Fetch and decode ---------------------------------------------------------------------------
    `FP3_MARKS_FIELDS
    wire [`FP3_MARKS_W-1:0]   marks;
    wire [`FP3_DECODED_W-1:0] decoded;
    assign `FP3_MARKS = marks;
    wire                  ready, fetched, fetch_empty, again, more, skip;
    wire [PROGRAM_W-1:0]  fetch_pc;
    wire [31:0]           fetch_word;
    wire                  advance, delivered, decoded_empty;
    wire [PROGRAM_W-1:0]  delivered_pc;
    wire [31:0]           delivered_word;
    wire [`FP3_MARKS_W-1:0]   delivered_marks;
    wire [`FP3_DECODED_W-1:0] delivered_decoded;
    wire                  hold, drop, jump, jump_on, jump_begins;
    wire [PROGRAM_W-1:0]  jump_pc;
    fp3_fetch #(.CONFIG(CONFIG)) u_fetch (.clk_i(clk_i), .rst_i(rst_i),
        .write_i(program_write_i), .write_addr_i(program_addr_i), .write_word_i(program_word_i),
        .start_i(starts), .stop_i(abort), .settings_i(settings_i), .steps_i(steps),
        .skip_i(skip), .more_i(more), .again_o(again),
        .jump_i(jump), .jump_on_i(jump_on), .jump_begins_i(jump_begins), .jump_pc_i(jump_pc),
        .advance_i(advance), .valid_o(delivered), .pc_o(delivered_pc), .word_o(delivered_word),
        .marks_o(delivered_marks), .empty_o(fetch_empty));
    fp3_decode #(.CONFIG(CONFIG)) u_decode (.word_i(delivered_word), .decoded_o(delivered_decoded));
    generate
        if (NEIGHBOURS != 0) begin : g_decoded
            // The word decides where fetch goes on (loops), so a register stands between.
            reg                  valid_q;
            reg [PROGRAM_W-1:0]  pc_q;
            reg [31:0]           word_q;
            reg [`FP3_MARKS_W-1:0]   marks_q;
            reg [`FP3_DECODED_W-1:0] decoded_q;
            always @(posedge clk_i) begin
                if (rst_i || abort || jump) valid_q <= 1'b0;
                else if (advance)           valid_q <= delivered;
                if (advance)
                    {pc_q, word_q, marks_q, decoded_q} <= {delivered_pc, delivered_word, delivered_marks, delivered_decoded};
            end
            assign advance       = (ready || !valid_q) && !jump;
            assign decoded_empty = !valid_q;
            assign {fetched, fetch_pc, fetch_word, marks, decoded} = {valid_q, pc_q, word_q, marks_q, decoded_q};
        end else begin : g_not_decoded
            assign advance       = ready;
            assign decoded_empty = 1'b1;
            assign {fetched, fetch_pc, fetch_word, marks, decoded}
                = {delivered, delivered_pc, delivered_word, delivered_marks, delivered_decoded};
        end
    endgenerate

    wire [CONTEXTS-1:0] mask;
    wire                batch;
    fp3_batch #(.CONTEXTS(CONTEXTS), .CONTEXT_W(CONTEXT_W), .ROW_W(ROW_W)) u_batch (.clk_i(clk_i), .rst_i(rst_i),
        .open_i(open), .count_i(report_count),
        .again_i(again), .more_o(more), .skip_o(skip),
        .take_i(ready && fetched), .begins_i(begins), .in_last_i(in_last), .mask_o(mask), .batch_o(batch),
        .valid_i(report_valid), .asleep_i(report_asleep), .reported_batch_i(report_batch),
        .reported_context_i(report_context));

    // The next instruction: it waits here until its sweep may begin
    // ----------------------------------
    reg                      valid_q, seen_q;           // valid for a cycle: what follows is known
    reg                      goes_q, drops_q, traps_q;  // to its sweep, nowhere (no object is awake), illegal
    reg [`FP3_DECODED_W-1:0]     decoded_q;
    reg [`FP3_MARKS_W-1:0]       marks_q;
    reg                      in_last_q;                   // in the last part
    reg [PROGRAM_W-1:0]      pc_q;
    reg [31:0]               word_q;
    wire [AROUND_W-1:0]     around;
    reg  [AROUND_W-1:0]     around_q;
    reg [CONTEXTS-1:0]       mask_q;
    reg [ROW_W-1:0]          row_q, next_row_q;         // of context 0; of the next batch's
    wire                     known, load, busy;
    wire                     empty = mask_q == {CONTEXTS{1'b0}};
    wire                     take  = load || (known && drops_q);
    `FP3_DECODED_FIELDS
    assign `FP3_DECODED = decoded_q;
    assign ready    = !valid_q && !hold;                // a sweep is long enough for a cycle without one
    always @(posedge clk_i) begin
        if (rst_i || abort || take) valid_q <= 1'b0;
        else if (ready)             valid_q <= fetched && !drop;
        if (ready) begin
            {decoded_q, marks_q, in_last_q} <= {decoded, marks, in_last};
            {pc_q, word_q, mask_q}        <= {fetch_pc, fetch_word, mask};
            around_q                      <= around;
        end
        if (open) next_row_q <= {ROW_W{1'b0}};
        else if (ready && fetched && begins) begin
            row_q      <= next_row_q;
            next_row_q <= next_row_q + CONTEXTS[ROW_W-1:0];
        end
        seen_q    <= valid_q;
        goes_q    <= legal && !empty;
        drops_q   <= legal && empty && SLEEP != 0;      // else each batch has an object
        traps_q   <= !legal;
        illegal_q <= !rst_i && known && traps_q && !busy && !illegal_q;
    end
    assign {illegal_o, illegal_pc_o} = {illegal_q, pc_q};

    // Where the program goes on in which objects see each other
    // --------------------------------------
    generate
        if (NEIGHBOURS != 0) begin : g_loops
            fp3_loops #(.CONFIG(CONFIG)) u_loops (.clk_i(clk_i), .rst_i(rst_i),
                .start_i(start_i), .abort_i(abort), .settings_i(settings_i), .open_i(open), .round_end_i(closed),
                .raised_i(report_raised),
                .take_i(ready && fetched), .decoded_i(decoded), .pc_i(fetch_pc), .ends_i(ends), .more_i(more),
                .drop_o(drop), .around_o(around), .hold_o(hold), .still_i(!valid_q && !busy),
                .longest_i(report_longest),
                .jump_o(jump), .jump_on_o(jump_on), .jump_begins_o(jump_begins), .jump_pc_o(jump_pc),
                .partial_o(partial), .held_o(held_o), .half_o(half_o));
        end else begin : g_no_loops
            assign {hold, drop, jump, jump_on, jump_begins, partial, held_o, half_o} = 8'd0;
            assign jump_pc = {PROGRAM_W{1'b0}};
            assign around  = {AROUND_W{1'b0}};
            wire unused_loops = closed;
        end
    endgenerate

    // What is under way
    // -----------------------------------------------------------------------------
    wire [4:0] kinds;                  // that issue: memory, sleep, chain, mul, add
    wire       retired, paired, issued_late;
    generate
        if (DUAL != 0) begin : g_two
            fp3_two_streams #(.CONFIG(CONFIG)) u_streams (.clk_i(clk_i), .rst_i(rst_i),
                .open_i(open), .abort_i(abort), .settings_i(settings_i),
                .valid_i(valid_q), .take_i(take), .decoded_i(decoded_q), .pc_i(pc_q), .word_i(word_q),
                .mask_i(mask_q), .row_i(row_q), .known_o(known), .load_o(load), .busy_o(busy),
                .kinds_o(kinds), .paired_o(paired), .issued_late_o(issued_late),
                .issue_o(issue_o), .retire_o(retire_o), .issued_o(issued_o));
            assign reach_o = {`FP3_REACH_W{1'b0}};
            assign draw_o  = {DRAW_W{1'b0}};
            assign {adds_o, muls_o, sweep_end_o, step_o} = 35'd0;       // no unit is shared, no lane needs the step
            wire unused_one = &{base, end_step, batch, marks_q, around_q};
        end else begin : g_one
            fp3_one_stream #(.CONFIG(CONFIG)) u_streams (.clk_i(clk_i), .rst_i(rst_i),
                .open_i(open), .abort_i(abort), .settings_i(settings_i), .base_i(base), .end_i(end_step),
                .valid_i(valid_q), .goes_i(goes_q), .take_i(take), .decoded_i(decoded_q), .marks_i(marks_q),
                .pc_i(pc_q), .word_i(word_q),
                .mask_i(mask_q), .around_i(around_q), .batch_i(batch), .known_o(known), .load_o(load), .busy_o(busy),
                .adds_o(adds_o), .muls_o(muls_o), .sweep_end_o(sweep_end_o), .grant_i(grant_i),
                .kinds_o(kinds), .issued_late_o(issued_late),
                .reach_o(reach_o), .issue_o(issue_o), .retire_o(retire_o), .step_o(step_o), .draw_o(draw_o),
                .issued_o(issued_o));
            assign paired = 1'b0;
            wire unused_two = &row_q;
        end
    endgenerate
    fp3_delay #(.W(1), .N(TIMING_TOLD + AHEAD + TO_RESULT + TIMING_WRITE - 1)) u_retired (.clk_i(clk_i),
        .rst_i(rst_i), .d_i(issued_late), .q_o(retired));
    reg under_in_last_q;                 // the last that was taken is in a last part
    always @(posedge clk_i) if (load) under_in_last_q <= in_last_q;
    assign issuing = !fetch_empty || !decoded_empty || valid_q || busy || jump;
    assign storing = (valid_q && in_last_q) || (busy && under_in_last_q);

    // Every running cycle is an issue or exactly one stall
    // -----------------------------------------
    wire quiet = running_o && !busy;
    `FP3_EVENTS_FIELDS
    assign event_cycles = running_o;
    assign {event_issued_memory, event_issued_sleep, event_issued_chain, event_issued_mul, event_issued_add} = kinds;
    assign event_retired          = retired;
    assign event_stall_fetch      = quiet && in_round && issuing && !event_stall_asleep && !event_stall_dependency;
    assign event_stall_dependency = quiet && known && goes_q && !load;
    assign event_stall_unit       = busy && !grant_i;
    assign event_stall_writeback  = 1'b0;
    assign event_stall_asleep     = quiet && valid_q && seen_q && drops_q;
    assign event_stall_drain      = quiet && !event_stall_asleep && !event_stall_dependency && !event_stall_fetch;
    assign event_paired           = paired;
    assign events_o               = `FP3_EVENTS;

`ifdef FP3_CHECK
    wire [5:0] causes = {busy && grant_i, event_stall_unit, event_stall_asleep, event_stall_dependency, event_stall_fetch, event_stall_drain};
    reg        ends_q, under_ends_q;   // the last of a visit
    reg        part_q;                 // a last part has begun to issue, and was not dropped
    always @(posedge clk_i) begin
        if (ready) ends_q <= ends;
        if (load)  under_ends_q <= ends_q;
        part_q <= !rst_i && !abort && (load ? in_last_q : part_q);
        if (!rst_i && (running_o ? causes == 6'd0 || |(causes & (causes - 1'b1)) : |causes)) begin
            $display("%m: issue and stalls %b in a cycle, running is %b", causes, running_o); $stop;
        end
        if (!rst_i && abort && !illegal_q && part_q && (busy || !under_ends_q)) begin
            $display("%m: a stop between the stores of a visit"); $stop;
        end
    end
`endif
endmodule
`default_nettype wire
`include "config/undefine.vh"
