// sequencer: runs a program over the objects of its lanes, as many at a time as there are contexts.
//
// Purpose   Says to its lanes, in every cycle, which instruction for which context. A run is a
//           sequence of rounds; in a round every awake object is visited once: loaded, advanced by
//           so many steps, stored. Each instruction issues for all contexts of the visit in turn
//           (a sweep) before the next is fetched, so that its latency passes while others issue.
//
//           fetch ─► decode, ──► sweep ──► contexts ──► issue_o ──► lanes
//                    its contexts          to numbers   retire_o, so many cycles later
//
// Latency   From the sweep to the lane two cycles. A sweep of LATENCY + 5 contexts or more needs no
//           pause; a shorter one is followed by the cycles that are missing (stall_dependency).
// Hazard    The pause is all that protects a context from itself: between two sweeps of n and m
//           contexts, one set within the other, the same context issues at least min(n, m) cycles
//           apart, whoever waited in between.
//           A report that a context's objects sleep comes late. Until then its instructions are
//           issued in vain; no lane executes them.
`default_nettype none
`include "front/decoded.vh"
module sequencer #(
    parameter ISSUE_W    = 1,
    parameter RETIRE_W   = 1,
    parameter HOST_W     = 1,
`include "config.vh"
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
    // The host: program, and what lanes hold (lane_host.vh)
    input  wire                 host_program_i,
    input  wire [PROGRAM_W-1:0] host_program_addr_i,
    input  wire [HOST_W-1:0]    host_i,
    input  wire [31:0]          host_wdata_i,
    // Units shared with other schedulers
    output wire                 adds_o,         // this instruction needs the adder
    output wire                 muls_o,
    output wire                 lasts_o,        // the last of a sweep
    input  wire                 grant_i,
    // The first lane
    output wire [ISSUE_W-1:0]   issue_o,
    output wire [RETIRE_W-1:0]  retire_o,
    output wire [HOST_W-1:0]    host_o,
    output wire [31:0]          data_o,
    // The last lane
    input  wire [STORE_W-3:0]   count_i,        // the most objects that a lane will visit
    input  wire                 report_i,
    input  wire                 report_asleep_i,
    input  wire                 report_batch_i,
    input  wire [CONTEXT_W-1:0] report_context_i,
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
`include "gen/choices.vh"
    localparam GAP    = LATENCY + 5;
    localparam GAP_W  = $clog2(GAP + CONTEXTS + 1);
    localparam SETTLE = LATENCY + LANES + 14;             // from an issue to the last report of it
    localparam SETTLE_W = $clog2(SETTLE + 1);
    localparam [CONTEXT_W-1:0] SHARED   = CONTEXTS[CONTEXT_W-1:0];
    localparam [ROW_W:0]       CONTEXTS_R = CONTEXTS[ROW_W:0];
    localparam [31:0] SETTLE_32 = SETTLE;
    localparam [SETTLE_W-1:0]  SETTLE_S = SETTLE_32[SETTLE_W-1:0];

    // Rounds -----------------------------------------------------------------------------------
    localparam [2:0] IDLE = 3'd0, WAIT = 3'd1, PLAN = 3'd2, OPEN = 3'd3, RUN = 3'd4;
    reg  [2:0]          state_q;
    reg  [SETTLE_W-1:0] settle_q;
    reg  [31:0]         left_q;        // steps after this round
    reg  [31:0]         steps_q;       // of this round
    reg  [31:0]         base_q;        // the number of the last step before it
    reg  [31:0]         end_q;         // of its last step
    reg                 aborted_q;
    wire                issuing;       // something is left to issue
    wire                over  = aborted_q || left_q == 32'd0 || count_i == {ROW_W+1{1'b0}};
    wire                open  = state_q == OPEN;
    // A stop waits for the end of a last part that has begun: no object is stored by halves.
    reg                 stopping_q, stop_q, illegal_q;
    wire                storing;
    wire                abort = stop_q || illegal_q;
    always @(posedge clk_i) begin
        stopping_q <= !rst_i && running_o && !stop_q && (stop_i || stopping_q);
        stop_q     <= !rst_i && running_o && !stop_q && (stop_i || stopping_q) && !storing;
    end

    always @(posedge clk_i)
        if (rst_i) begin
            state_q   <= IDLE;
            aborted_q <= 1'b0;
        end else begin
            aborted_q <= state_q != IDLE && (aborted_q || abort);
            case (state_q)
                IDLE:    if (start_i) state_q <= WAIT;
                WAIT:    if (settle_q == {SETTLE_W{1'b0}}) state_q <= over ? IDLE : PLAN;
                PLAN:    state_q <= OPEN;
                OPEN:    state_q <= RUN;
                default: if (!issuing) state_q <= WAIT;
            endcase
        end
    always @(posedge clk_i) begin
        settle_q <= state_q == WAIT ? settle_q - 1'b1 : SETTLE_S;
        if (start_i)                {left_q, base_q, steps_q} <= {steps_i, clock_i, 32'd0};
        else if (state_q == PLAN)   begin
            steps_q <= visit_i == 32'd0 || visit_i > left_q ? left_q : visit_i;
            base_q  <= base_q + steps_q;
        end else if (open)          left_q <= left_q - steps_q;
        end_q <= base_q + steps_q;
    end
    assign running_o = state_q != IDLE;

    // Fetch: visit after visit, as long as objects are left ---------------------------------------
    reg                  fetch_batch_q, more_q, skip_q, batch_q;
    reg  [ROW_W:0]       fetch_left_q; // objects not yet in a visit that fetch has begun
    wire                 fetched, fetch_empty, again, begins, ends, newstep, lasts, d_ready;
    wire [PROGRAM_W-1:0] fetch_pc;
    wire [31:0]          fetch_word;
    fetch #(.ADDR_W(PROGRAM_W)) u_fetch (
        .clk_i(clk_i), .rst_i(rst_i),
        .write_i(host_program_i), .write_addr_i(host_program_addr_i), .write_word_i(host_wdata_i),
        .start_i(open && !aborted_q), .stop_i(abort),
        .steps_i(steps_q), .step_i(step_i), .step_end_i(step_end_i), .end_i(end_i),
        .skip_i(skip_q && fetch_batch_q == batch_q), .more_i(more_q), .again_o(again),
        .advance_i(d_ready), .valid_o(fetched), .pc_o(fetch_pc), .word_o(fetch_word),
        .begins_o(begins), .ends_o(ends), .steps_o(newstep), .lasts_o(lasts), .empty_o(fetch_empty));
    always @(posedge clk_i)
        if (open) begin
            fetch_left_q  <= count_i;
            fetch_batch_q <= 1'b1;
            more_q        <= count_i > CONTEXTS_R;
        end else if (again) begin
            fetch_left_q  <= fetch_left_q - CONTEXTS_R;
            fetch_batch_q <= !fetch_batch_q;
            more_q        <= {1'b0, fetch_left_q} > {CONTEXTS_R, 1'b0};
        end

    // Decode, and which contexts the instruction is for ---------------------------------------------
    wire [`DECODED_W-1:0] decoded;
    decode #(.CONFIG(CONFIG)) u_decode (.word_i(fetch_word), .decoded_o(decoded));

    reg                  d_valid_q;
    reg                  d_seen_q;     // valid for a cycle: what follows is known
    reg                  d_goes_q, d_drops_q, d_traps_q;  // to the sweep, nowhere (nobody is awake), illegal
    reg  [`DECODED_W-1:0] d_decoded_q;
    reg  [3:0]           d_marks_q;    // begins, ends, newstep, lasts
    reg  [PROGRAM_W-1:0] d_pc_q;
    reg  [31:0]          d_word_q;
    reg  [CONTEXTS-1:0]  d_mask_q, next_q, visit_q, awake_q;
    reg  [ROW_W:0]       next_left_q;  // objects not yet in a visit that decode has begun
    wire [GAP_W-1:0]     d_count;
    wire                 d_known, d_may; // its pause is known; it may begin
    wire                 d_take;       // it goes on, to the sweep or nowhere
    assign d_ready = !d_valid_q;       // a sweep is long enough for the gap
    wire   d_entry = d_ready && fetched;
    wire   d_legal = d_decoded_q[`DECODED_W-1];
    wire   d_empty = d_mask_q == {CONTEXTS{1'b0}};

    wire [CONTEXTS-1:0] reported = {{CONTEXTS-1{1'b0}}, 1'b1} << report_context_i;

    integer n;
    always @(posedge clk_i) begin
        if (rst_i || abort || d_take) d_valid_q <= 1'b0;
        else if (d_ready)             d_valid_q <= fetched;
        if (d_ready) begin
            d_decoded_q <= decoded;
            d_marks_q   <= {begins, ends, newstep, lasts};
            d_pc_q      <= fetch_pc;
            d_word_q    <= fetch_word;
            d_mask_q    <= begins ? next_q : lasts ? visit_q : awake_q;
        end
        d_seen_q   <= d_valid_q;
        d_goes_q   <= d_legal && !d_empty;
        d_drops_q  <= d_legal && d_empty;
        d_traps_q  <= !d_legal;

        // Who is in the visit, and awake
        if (open)                   next_left_q <= count_i;
        else if (d_entry && begins) next_left_q <= next_left_q - CONTEXTS_R;
        for (n = 0; n < CONTEXTS; n = n + 1) next_q[n] <= next_left_q > n[ROW_W:0];
        if (open)                   batch_q <= 1'b0;
        else if (d_entry && begins) batch_q <= !batch_q;
        if (d_entry && begins) begin
            visit_q <= next_q;
            awake_q <= next_q;
        end else if (report_i && report_asleep_i && report_batch_i == batch_q)
            awake_q <= awake_q & ~reported;
        skip_q <= !(d_entry && begins) && awake_q == {CONTEXTS{1'b0}};
    end

    // The sweep -----------------------------------------------------------------------------------
    reg  [`DECODED_W-1:0] s_decoded_q;
    reg  [3:0]           s_marks_q;
    reg  [PROGRAM_W-1:0] s_pc_q;
    reg  [31:0]          s_word_q;
    reg                  s_first_q, s_batch_q;
    wire                 s_busy, s_last;
    wire [CONTEXTS-1:0]  s_current;
    wire                 s_issue = s_busy && grant_i;
    wire                 s_over  = s_issue && s_last;
    wire                 d_load  = d_may && d_goes_q;
    assign d_take       = d_load || (d_known && d_drops_q);
    always @(posedge clk_i) illegal_q <= !rst_i && d_known && d_traps_q && !s_busy && !illegal_q;
    assign illegal_o    = illegal_q;
    assign illegal_pc_o = d_pc_q;
    pace #(.CONTEXTS(CONTEXTS), .GAP(GAP), .COUNT_W(GAP_W)) u_pace (.clk_i(clk_i), .rst_i(rst_i), .start_i(open),
        .valid_i(d_valid_q), .mask_i(d_mask_q), .take_i(d_take), .known_o(d_known), .count_o(d_count), .may_o(d_may),
        .busy_i(s_busy), .over_i(s_over));
    sweep #(.CONTEXTS(CONTEXTS), .COUNT_W(GAP_W)) u_sweep (.clk_i(clk_i), .rst_i(rst_i || abort), .load_i(d_load),
        .mask_i(d_mask_q), .count_i(d_count), .next_i(s_issue), .busy_o(s_busy), .current_o(s_current), .last_o(s_last));

    always @(posedge clk_i) begin
        if (d_load) begin
            s_decoded_q <= d_decoded_q;
            s_marks_q   <= d_marks_q;
            s_pc_q      <= d_pc_q;
            s_word_q    <= d_word_q;
            s_batch_q   <= batch_q;
            s_first_q   <= 1'b1;
        end else if (s_issue) s_first_q <= 1'b0;
    end
    assign issuing = !fetch_empty || d_valid_q || s_busy;
    assign storing = (d_valid_q && d_marks_q[0]) || (s_busy && s_marks_q[0]);

    `DECODED_FIELDS
    assign `DECODED = s_decoded_q;
    wire value = choice != CHOICE_NONE;
    assign adds_o = s_busy && (to_add || to_chain);
    assign muls_o = s_busy && (to_mul || to_chain);
    assign lasts_o = s_last;

    // To the lanes: x is b, y is a or what is stored, z is c or a ------------------------------------
    reg  [3:0]           o_value_q;
    reg                  o_valid_q, o_first_q, o_batch_q;
    reg  [CONTEXTS-1:0]  o_current_q;
    reg  [3:0]           o_marks_q;
    reg  [5:0]           o_kind_q;     // ends of an instruction: lds, sleep, load, arithmetic; st, subtract
    reg                  o_one_q, o_zero_q, o_twice_q, o_half_q;
    reg  [REGISTER_W-1:0] o_d_q;
    reg  [REGISTER_W:0]  o_x_q, o_y_q, o_z_q;
    reg  [PROGRAM_W-1:0] o_pc_q;
    reg  [31:0]          o_word_q;
    always @(posedge clk_i) begin
        o_valid_q   <= s_issue && !rst_i;
        o_first_q   <= s_issue && s_first_q && !rst_i;
        o_current_q <= s_current;
        o_batch_q   <= s_batch_q;
        o_marks_q   <= s_marks_q;
        o_kind_q    <= {lds, to_sleep, to_memory && !st, to_add || to_mul || to_chain, st, subtract}
                     & {6{s_issue && legal && !rst_i}};
        o_one_q     <= to_add && !value;
        o_value_q   <= choice;
        o_zero_q    <= to_mul;
        o_twice_q   <= twice;
        o_half_q    <= half;
        o_d_q       <= d;
        o_x_q       <= b;
        o_y_q       <= st ? {1'b0, d} : a;
        o_z_q       <= to_chain || value ? c : a;
        o_pc_q      <= s_pc_q;
        o_word_q    <= s_word_q;
    end
    function [CONTEXT_W-1:0] number(input [CONTEXTS-1:0] one);
        integer i;
        begin
            number = {CONTEXT_W{1'b0}};
            for (i = 0; i < CONTEXTS; i = i + 1)
                if (one[i]) number = number | i[CONTEXT_W-1:0];
        end
    endfunction
    wire [CONTEXT_W-1:0] o_context = number(o_current_q);
    wire o_lds, o_sleep, o_load, o_arithmetic, o_st, o_subtract, o_begins, o_ends, o_newstep, o_lasts;
    assign {o_lds, o_sleep, o_load, o_arithmetic, o_st, o_subtract} = o_kind_q;
    assign {o_begins, o_ends, o_newstep, o_lasts} = o_marks_q;
    assign issue_o = {o_value_q, o_subtract, o_twice_q, o_half_q, o_one_q, o_zero_q, o_st, o_lasts, o_context, o_d_q,
                      o_x_q[REGISTER_W] ? SHARED : o_context, o_x_q[REGISTER_W-1:0],
                      o_y_q[REGISTER_W] ? SHARED : o_context, o_y_q[REGISTER_W-1:0],
                      o_z_q[REGISTER_W] ? SHARED : o_context, o_z_q[REGISTER_W-1:0]};

    // The end of an instruction, LATENCY - 3 cycles later --------------------------------------------
    wire [RETIRE_W-3:0] retire;
    delay #(.W(RETIRE_W-2), .N(LATENCY-3)) u_retire (.clk_i(clk_i), .rst_i(rst_i),
        .d_i({open, o_valid_q, o_begins, o_ends, o_lasts, o_lds, o_sleep, o_load, o_arithmetic,
              o_batch_q, o_context, o_d_q}), .q_o(retire));
    assign retire_o = {record_i, retire};

    // The number of the step, for results that are in V when it is in the lane
    wire late, late_begins, late_newstep, late_lasts;
    reg  [31:0] number_q;
    delay #(.W(4), .N(LATENCY+2)) u_late (.clk_i(clk_i), .rst_i(rst_i),
        .d_i({o_first_q, o_begins, o_newstep, o_lasts}),
        .q_o({late, late_begins, late_newstep, late_lasts}));
    always @(posedge clk_i)
        if (late)
            number_q <= late_lasts ? end_q
                      : (late_begins ? base_q : number_q) + {31'd0, late_newstep};
    assign data_o = running_o ? number_q : host_wdata_i;
    assign host_o = host_i;

    // Every running cycle is an issue or exactly one stall -----------------------------------------
    wire quiet = running_o && !s_busy;
    assign issued_o           = {to_memory, to_sleep, to_chain, to_mul, to_add} & {5{s_issue && legal}};
    delay #(.W(1), .N(LATENCY+5)) u_retired (.clk_i(clk_i), .rst_i(rst_i), .d_i(o_valid_q), .q_o(retired_o));
    assign stall_unit_o       = s_busy && !grant_i;
    assign stall_asleep_o     = quiet && d_valid_q && d_seen_q && d_drops_q;
    assign stall_dependency_o = quiet && d_known && d_goes_q && !d_may;
    assign stall_fetch_o      = quiet && state_q == RUN && issuing && !stall_asleep_o && !stall_dependency_o;
    assign stall_drain_o      = quiet && !stall_asleep_o && !stall_dependency_o && !stall_fetch_o;
    assign trace_o            = o_valid_q;
    assign trace_pc_o         = o_pc_q;
    assign trace_context_o    = o_context;
    assign trace_word_o       = o_word_q;

`ifdef FP3_CHECK
    // The invariant that stands for busy flags: whatever a context named GAP cycles ago is written.
    reg [15:0] age [0:CONTEXTS-1];
    integer    k;
    always @(posedge clk_i)
        for (k = 0; k < CONTEXTS; k = k + 1) begin
            age[k] <= rst_i ? 16'hffff : o_valid_q && o_current_q[k] ? 16'd1 : age[k] == 16'hffff ? age[k] : age[k] + 1'b1;
            if (!rst_i && o_valid_q && o_current_q[k] && {16'd0, age[k]} < GAP) begin
                $display("%m: context %0d issued again after %0d cycles, %0d are needed", k, age[k], GAP);
                $stop;
            end
        end
`endif
endmodule
`default_nettype wire
