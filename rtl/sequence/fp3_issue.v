// SPDX-License-Identifier: Apache-2.0
// fp3_issue: tells the lanes of each instruction the word of the store that it reads, its operands,
// and its end.
//
// Purpose   Makes operand addresses (ISSUE) of the instruction and of the context that sweep shows,
//           and some cycles later the fields of the instruction's end (RETIRE, and the number of
//           its step). Operands: x is a or the word to store (of `keep` and `raise` d), y is b or a
//           neighbour's word, z is c, or a of a sum and of `keep`. With NEIGHBOURS the read of the
//           store (REACH) comes first, and everything else AHEAD cycles later than without. `each`
//           reads its register before it finds an entry, so its REACH waits until the lane's lists
//           have the register's word.
//
// Latency   reach_o one cycle after issue_i, issue_o AHEAD cycles later; z, minus and zero in
//           issue_o are Z_LATE cycles later still. retire_o TO_END cycles after issue_o, step_o
//           TO_RESULT: a lane needs them ENDED cycles before the result, and with the result.
// Hazard    first_i comes with the first context of each sweep, and base_i and end_i are those of
//           the round from its first issue to its last. After `each` no instruction issues for LATE
//           cycles (loops), so its REACH slot is free (checked).
//
//     cycle     0          1          1 + AHEAD    1 + AHEAD + TO_END    1 + AHEAD + TO_RESULT
//               issue_i    reach_o    issue_o      retire_o              step_o
`default_nettype none
`include "gen/settings.vh"
`include "front/decoded.vh"
`include "front/marks.vh"
`include "lane/bundles.vh"
module fp3_issue #(
`include "config/config.vh"
) (
    input  wire                        clk_i,
    input  wire                        rst_i,
    // The run and the round
    input  wire [`FP3_SETTINGS_W-1:0]      settings_i,
    input  wire                        open_i,        // a round begins
    input  wire [31:0]                 base_i,        // the number of the last step before it
    input  wire [31:0]                 end_i,         // of its last step
    // What issues
    input  wire                        issue_i,
    input  wire                        first_i,       // of its sweep
    input  wire                        batch_i,
    input  wire [CONTEXTS-1:0]         current_i,     // one context
    input  wire [`FP3_DECODED_W-1:0]       decoded_i,
    input  wire [`FP3_MARKS_W-1:0]         marks_i,
    input  wire [AROUND_W-1:0]        around_i,
    // Units
    output wire                        adds_o,        // the instruction needs the adder
    output wire                        muls_o,
    output wire [4:0]                  issued_o,      // it issues: memory, sleep, chain, mul, add
    // Lanes
    output wire [`FP3_REACH_W-1:0]   reach_o,
    output wire [`FP3_ISSUE_W-1:0]         issue_o,
    output wire [`FP3_RETIRE_W-1:0]        retire_o,
    output wire [31:0]                 step_o,
    output wire                        valid_o,       // an instruction issues, for ...
    output wire [CONTEXT_W-1:0]        context_o
);
`include "gen/choices.vh"
    localparam [CONTEXT_W-1:0] SHARED = CONTEXTS[CONTEXT_W-1:0];
    `FP3_DECODED_FIELDS
    `FP3_MARKS_FIELDS
    `FP3_ISSUE_FIELDS
    `FP3_RETIRE_FIELDS
    assign `FP3_DECODED = decoded_i;
    assign `FP3_MARKS   = marks_i;
    wire valued     = choice != CHOICE_NONE;
    wire arithmetic = to_add || to_mul || to_chain;
    assign adds_o   = to_add || to_chain;
    assign muls_o   = to_mul || to_chain;
    assign issued_o = {to_memory, to_sleep, to_chain, to_mul, to_add} & {5{issue_i && legal}};

    reg                  valid_q, first_q, batch_q, begins_q, ends_q, newstep_q, in_last_q;
    reg                  lds_q, sleep_q, load_q, arithmetic_q, st_q, subtract_q, one_q, zero_q, twice_q, halve_q;
    reg                  each_q, keep_q, raise_q;
    reg [CHOICE_W-1:0]   choice_q;
    reg [CONTEXTS-1:0]   current_q;
    reg [REGISTER_W-1:0] d_q;
    reg [REGISTER_W:0]   x_q, y_q, z_q;         // {shared constant, index}
    always @(posedge clk_i) begin
        {valid_q, first_q} <= {issue_i, issue_i && first_i} & {2{!rst_i}};
        {lds_q, sleep_q, load_q, arithmetic_q, st_q, subtract_q}
            <= {lds, to_sleep, to_memory && !st && !each && !next && !raises, arithmetic, st, subtract}
             & {6{issue_i && legal && !rst_i}};
        {begins_q, ends_q, newstep_q, in_last_q} <= {begins, ends, newstep, in_last};
        each_q   <= each && issue_i && legal && !rst_i;
        {keep_q, raise_q} <= {keeps, raises} & {2{issue_i && legal && !rst_i}};
        {batch_q, current_q, choice_q} <= {batch_i, current_i, choice};
        {twice_q, halve_q} <= {twice, halve};
        one_q  <= to_add && !valued;        // a sum is z +/- 1 * y
        zero_q <= to_mul;                  // a product -0 + x * y
        d_q    <= d;
        x_q    <= st || each || keeps || raises ? {1'b0, d} : a;
        y_q    <= b;
        z_q    <= to_chain || valued ? c : a;
    end

    function [CONTEXT_W-1:0] number(input [CONTEXTS-1:0] one);
        integer i;
        begin
            number = {CONTEXT_W{1'b0}};
            for (i = 0; i < CONTEXTS; i = i + 1)
                if (one[i]) number = number | i[CONTEXT_W-1:0];
        end
    endfunction
    wire [CONTEXT_W-1:0] context_now = number(current_q);
    assign issue_context  = context_now;

    // The object's row if all objects are visited in order: contexts take the next rows, batch
    // after batch. If objects can sleep, a list has the row.
    wire [ROW_W-1:0] row;
    generate
        if (SLEEP != 0) begin : g_list
            assign row = {ROW_W{1'b0}};
        end else begin : g_order
            localparam [ROW_W-1:0] BATCH = CONTEXTS[ROW_W-1:0];
            reg             opened_q;           // the first batch of a round is still to come
            reg [ROW_W-1:0] base_q;             // the row in context 0
            always @(posedge clk_i) begin
                opened_q <= open_i || (opened_q && !issue_i);
                if (issue_i && first_i && begins) base_q <= opened_q ? {ROW_W{1'b0}} : base_q + BATCH;
            end
            wire [ROW_W+CONTEXT_W-1:0] place = {{ROW_W{1'b0}}, context_now};
            assign row = base_q + place[ROW_W-1:0];
            wire unused = &place;
        end
    endgenerate
    assign issue_choice   = choice_q;
    assign issue_subtract = subtract_q;
    assign issue_twice    = twice_q;
    assign issue_halve    = halve_q;
    assign issue_one      = one_q;
    assign issue_st       = st_q;
    assign issue_in_last  = in_last_q;
    assign issue_each     = each_q;
    assign issue_keep     = keep_q;
    assign issue_raise    = raise_q;
    wire minus;
    generate
        if (NEIGHBOURS != 0) begin : g_around
            reg                 reads_q, takes_q, flips_q, upper_q, begins_list_q;
            reg [AROUND_W-1:0]  around_q;
            localparam [LENGTH_W-1:0] FIRST_TURN = 1;          // the next one, in a loop's first
            `FP3_AROUND_FIELDS
            assign `FP3_AROUND = around_i;
            always @(posedge clk_i) begin
                {takes_q, flips_q, upper_q} <= {takes, flips, around_half};
                reads_q  <= issue_i && legal && !rst_i && ((to_memory && !st && !each && !keeps && !raises) || takes);
                begins_list_q <= KEEP != 0 && keeps && around_turn == FIRST_TURN;
                around_q <= around_i;
            end
            assign {issue_upper, issue_given, minus} = {upper_q, takes_q, flips_q};
            assign issue_first = (each_q && first_q) || begins_list_q;

            // The place of a list is noted four cycles after issue_o, and read in the cycle after
            // reach_o.
            localparam LATE = AHEAD + 4;
            wire                 finds;
            wire [CONTEXT_W-1:0] context_late;
            fp3_delay #(.W(1), .N(LATE)) u_finds (.clk_i(clk_i), .rst_i(rst_i), .d_i(each_q), .q_o(finds));
            fp3_delay #(.W(CONTEXT_W), .N(LATE)) u_context_late (.clk_i(clk_i), .rst_i(1'b0), .d_i(context_now),
                .q_o(context_late));
            // Its entry is the first: all of AROUND is 0 but that it is an entry, and that of
            // `each`.
            localparam [AROUND_W-1:0] FIRST = {2'b11, {AROUND_W-2{1'b0}}};
            `FP3_REACH_FIELDS
            assign reach_valid   = finds || (valid_q && !each_q);
            assign reach_load    = finds || reads_q;
            assign reach_copy    = 1'b0;
            assign reach_context = finds ? context_late : context_now;
            assign reach_row     = row;
            assign reach_around  = finds ? FIRST : around_q;
            assign reach_o       = `FP3_REACH;
`ifdef FP3_CHECK
            always @(posedge clk_i)
                if (!rst_i && finds && valid_q && !each_q) begin
                    $display("%m: an entry is found in the cycle of another instruction"); $stop;
                end
`endif
        end else begin : g_no_around
            assign {issue_upper, issue_given, minus, issue_first} = 4'd0;
            assign reach_o = 1'b0;
            wire unused_around = &around_i;
        end
    endgenerate
    `FP3_SETTINGS_FIELDS
    assign `FP3_SETTINGS      = settings_i;
    assign issue_record_shift = setting_record;
    assign issue_register = d_q;
    wire   whole          = WHOLE != 0 && setting_whole == {{7-REGISTER_W{1'b0}}, d_q};
    assign issue_whole    = st_q && whole;
    assign issue_row      = row;
    assign issue_x        = {x_q[REGISTER_W] ? SHARED : issue_context, x_q[REGISTER_W-1:0]};
    assign issue_y        = {y_q[REGISTER_W] ? SHARED : issue_context, y_q[REGISTER_W-1:0]};
    fp3_delay #(.W(2+REG_W), .N(Z_LATE)) u_z (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({minus, zero_q, z_q[REGISTER_W] ? SHARED : issue_context, z_q[REGISTER_W-1:0]}),
        .q_o({issue_minus, issue_zero, issue_z}));
    fp3_delay #(.W(`FP3_ISSUE_W), .N(AHEAD)) u_issue (.clk_i(clk_i), .rst_i(rst_i), .d_i(`FP3_ISSUE), .q_o(issue_o));

    assign retire_round      = open_i;
    assign retire_valid      = valid_q;
    assign retire_begins     = begins_q;
    assign retire_ends       = ends_q;
    assign retire_in_last    = in_last_q;
    assign retire_lds        = lds_q;
    assign retire_sleep      = sleep_q;
    assign retire_load       = load_q;
    assign retire_arithmetic = arithmetic_q;
    assign retire_whole      = load_q && whole;
    assign retire_batch      = batch_q;
    assign retire_context    = issue_context;
    assign retire_register   = d_q;
    assign retire_row        = row;
    fp3_delay #(.W(`FP3_RETIRE_W), .N(AHEAD+TO_END)) u_retire (.clk_i(clk_i), .rst_i(rst_i), .d_i(`FP3_RETIRE),
        .q_o(retire_o));
    assign valid_o   = valid_q;
    assign context_o = context_now;

    // The number of the step changes with the first of a sweep.
    wire       late, late_begins, late_newstep, late_in_last;
    reg [31:0] step_q;
    fp3_delay #(.W(4), .N(AHEAD+TO_RESULT-1)) u_late (.clk_i(clk_i), .rst_i(rst_i),
        .d_i({first_q, begins_q, newstep_q, in_last_q}),
        .q_o({late, late_begins, late_newstep, late_in_last}));
    always @(posedge clk_i)
        if (late)
            step_q <= late_in_last ? end_i
                    : (late_begins ? base_i : step_q) + {31'd0, late_newstep};
    assign step_o = step_q;

`ifdef FP3_CHECK
    // The number of the step, counted as instructions issue, and delayed.
    reg  [31:0]          now_q;
    wire [31:0]          now = !(issue_i && first_i) ? now_q : in_last ? end_i
                             : (begins ? base_i : now_q) + {31'd0, newstep};
    wire                 valid_late;
    wire [31:0]          now_late;
    fp3_delay #(.W(33), .N(AHEAD+TO_RESULT+1)) u_now (.clk_i(clk_i), .rst_i(rst_i), .d_i({issue_i, now}),
        .q_o({valid_late, now_late}));
    reg                  swept_q;              // an instruction has issued: instruction_q for batch_q
    reg  [`FP3_DECODED_W+`FP3_MARKS_W:0] instruction_q;
    always @(posedge clk_i) begin
        now_q <= now;
        if (issue_i) instruction_q <= {batch_i, decoded_i, marks_i};
        swept_q <= !rst_i && !open_i && (swept_q || issue_i);
        if (!rst_i && valid_late && now_late != step_q) begin
            $display("%m: step %0d for an instruction of step %0d", step_q, now_late); $stop;
        end
        if (!rst_i && issue_i && !first_i && !(swept_q && instruction_q == {batch_i, decoded_i, marks_i})) begin
            $display("%m: an instruction begins within a sweep"); $stop;
        end
        if (!rst_i && issue_i && (current_i == {CONTEXTS{1'b0}} || |(current_i & (current_i - 1'b1)))) begin
            $display("%m: contexts %b issue in one cycle", current_i); $stop;
        end
    end
`endif
endmodule
`default_nettype wire
`include "config/undefine.vh"
