// dual_sequencer: as sequencer, where a sweep of sums and one of products may be under way at once.
//
// Purpose   Tells its lanes, every cycle, which sum to make for which context, and which product. An instruction
//           begins GAP cycles after the one before at the soonest, and when its unit is free: a product is
//           usually half a sweep ahead of the sum behind it. A load or a store takes both units.
//
//           rounds ──► fetch ─► decode ──┬► turn of sums ──────┬─► lanes
//                      batch: contexts   └► turn of products ──┘
//                      pace: not yet
//
// Latency   From a turn to the lane two cycles for a sum's y, TIMING_EARLY more for all else.
// Hazard    Nothing but dual_pace protects a context from itself: between two issues of one context
//           at least GAP cycles pass.
//           Every running cycle is an issue, of one or two instructions, or exactly one stall, and no other
//           cycle is either. Once the last part of a visit has begun to issue, no stop comes before its end.
`default_nettype none
`include "front/decoded.vh"
`include "sequence/marks.vh"
`include "lane/dual_issue.vh"
`include "lane/dual_retire.vh"
`include "lane/report.vh"
module dual_sequencer #(
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
    // To the first lane, from the last
    output wire [`DUAL_ISSUE_W-1:0]  issue_o,
    output wire [`DUAL_RETIRE_W-1:0] retire_o,
    input  wire [`REPORT_W-1:0]      report_i,
    // What happens in this cycle, for counters and traces: of sums and loads and stores, of products
    output wire [4:0]           issued_o,       // memory, sleep, chain, mul, add
    output wire                 paired_o,       // two instructions issue
    output wire                 retired_o,
    output wire                 stall_fetch_o,
    output wire                 stall_dependency_o,
    output wire                 stall_drain_o,
    output wire [1:0]             trace_o,
    output wire [2*PROGRAM_W-1:0] trace_pc_o,
    output wire [2*CONTEXT_W-1:0] trace_context_o,
    output wire [63:0]            trace_word_o
);
    localparam COUNT_W = $clog2(GAP + CONTEXTS + 1);
    localparam TRACE_W = PROGRAM_W + 32;
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
        .skip_i(1'b0), .more_i(more), .again_o(again),
        .advance_i(d_ready), .valid_o(fetched), .pc_o(fetch_pc), .word_o(fetch_word),
        .begins_o(begins), .ends_o(ends), .steps_o(newstep), .lasts_o(lasts), .empty_o(fetch_empty));
    decode #(.CONFIG(CONFIG)) u_decode (.word_i(fetch_word), .decoded_o(decoded));

    wire [CONTEXTS-1:0] mask;
    wire                batch;
    batch #(.CONFIG(CONFIG)) u_batch (.clk_i(clk_i), .rst_i(rst_i), .open_i(open), .count_i(report_count),
        .again_i(again), .more_o(more), .skip_o(skip),
        .take_i(d_ready && fetched), .begins_i(begins), .lasts_i(lasts), .mask_o(mask), .batch_o(batch),
        .valid_i(1'b0), .asleep_i(1'b0), .reported_batch_i(1'b0), .reported_context_i({CONTEXT_W{1'b0}}));

    // The next instruction: it waits here until its sweep may begin ----------------------------------
    reg                      d_valid_q, d_lasts_q;
    reg [`DECODED_W-1:0]     d_decoded_q;
    reg [TRACE_W-1:0]        d_trace_q;
    reg [CONTEXTS-1:0]       d_mask_q;
    reg [ROW_W-1:0]          d_base_q, next_base_q;          // the row of context 0; of the next batch
    wire                     known, d_take;
    wire [COUNT_W-1:0]       count;
    `DECODED_FIELDS
    assign `DECODED = d_decoded_q;
    assign d_ready = !d_valid_q;       // a sweep is long enough for a cycle without one
    always @(posedge clk_i) begin
        if (rst_i || abort || d_take) d_valid_q <= 1'b0;
        else if (d_ready)             d_valid_q <= fetched;
        if (d_ready) begin
            {d_decoded_q, d_lasts_q} <= {decoded, lasts};
            d_trace_q <= {fetch_pc, fetch_word};
            d_mask_q  <= mask;
        end
        if (open) next_base_q <= {ROW_W{1'b0}};
        else if (d_ready && fetched && begins) begin
            d_base_q    <= next_base_q;
            next_base_q <= next_base_q + CONTEXTS[ROW_W-1:0];
        end
        illegal_q <= !rst_i && known && !legal && !busy && !illegal_q;
    end
    assign illegal_o    = illegal_q;
    assign illegal_pc_o = d_trace_q[TRACE_W-1:32];

    // Operands: x from the bank of sums, y from that of products; either may be a constant instead.
    wire                turned = (!a[REGISTER_W] && a[0]) || (!b[REGISTER_W] && !b[0]);
    wire [REGISTER_W:0] x = st ? {1'b0, d} : turned ? b : a;
    wire [REGISTER_W:0] y = st ? {1'b0, d} : turned ? a : b;

    // The turns ---------------------------------------------------------------------------------------
    localparam SUM_W = TRACE_W + 10 + REGISTER_W + 2 * (REGISTER_W + 1), PRODUCT_W = TRACE_W + 2 + REGISTER_W + 2 * (REGISTER_W + 1);
    reg                  memory_q;         // both units are taken
    wire                 to_products = to_mul || (to_memory && !st && d[0]);
    wire                 sum_busy, sum_free, product_busy, product_free, sum_valid, product_valid;
    wire                 busy = sum_busy || product_busy;
    wire [CONTEXT_W-1:0] sum_context, product_context;
    wire [ROW_W-1:0]     sum_row, product_row;
    dual_pace #(.CONTEXTS(CONTEXTS), .GAP(GAP), .COUNT_W(COUNT_W)) u_pace (.clk_i(clk_i), .rst_i(rst_i), .start_i(open),
        .valid_i(d_valid_q), .mask_i(d_mask_q), .adds_i(to_add || to_memory || memory_q), .muls_i(to_mul || to_memory || memory_q),
        .legal_i(legal), .take_i(d_take), .known_o(known), .count_o(count), .may_o(d_take),
        .adder_i(sum_free), .multiplier_i(product_free));
    always @(posedge clk_i) if (d_take) memory_q <= to_memory; else if (open) memory_q <= 1'b0;

    wire [SUM_W-1:0]      sum_what;
    wire [PRODUCT_W-1:0]  product_what;
    wire [TRACE_W-1:0]    sum_trace, product_trace;
    wire                  sum_lasts, sum_adds, sum_loads, sum_memory, product_lasts, product_loads;
    wire [REGISTER_W-1:0] sum_register, product_register;
    wire [REGISTER_W:0]   sum_x, sum_y, product_x, product_y;
    dual_turn #(.CONFIG(CONFIG), .WHAT_W(SUM_W), .COUNT_W(COUNT_W)) u_sums (.clk_i(clk_i), .rst_i(rst_i || abort),
        .load_i(d_take && !to_products), .count_i(count), .base_i(d_base_q),
        .what_i({d_trace_q, d_lasts_q, to_memory, to_add, to_memory && !st, subtract && turned, subtract && !turned,
                 twice, half, st, st && d[0], d, x, y}),
        .busy_o(sum_busy), .free_o(sum_free), .valid_o(sum_valid), .context_o(sum_context), .what_o(sum_what), .row_o(sum_row));
    dual_turn #(.CONFIG(CONFIG), .WHAT_W(PRODUCT_W), .COUNT_W(COUNT_W)) u_products (.clk_i(clk_i), .rst_i(rst_i || abort),
        .load_i(d_take && to_products), .count_i(count), .base_i(d_base_q),
        .what_i({d_trace_q, d_lasts_q, to_memory, d, x, y}),
        .busy_o(product_busy), .free_o(product_free), .valid_o(product_valid), .context_o(product_context),
        .what_o(product_what), .row_o(product_row));
    assign {product_trace, product_lasts, product_loads, product_register, product_x, product_y} = product_what;
    assign issuing = !fetch_empty || d_valid_q || busy;
    reg lasts_q;                           // the last that was taken is in a last part
    always @(posedge clk_i) if (d_take) lasts_q <= d_lasts_q;
    assign storing = (d_valid_q && d_lasts_q) || (busy && lasts_q);

    // What the lanes are told ---------------------------------------------------------------------------
    function [BANK_W-1:0] spot(input [REGISTER_W:0] of, input [CONTEXT_W-1:0] context_number);
        spot = of[REGISTER_W] ? {{CONTEXT_W-1{1'b1}}, of[REGISTER_W-1:0]} : {context_number, of[REGISTER_W-1:1]};
    endfunction
    // A sum's y at once, the rest later.
    `DUAL_ISSUE_FIELDS
    wire [5:0] sum_kind;
    wire       issue_st_now, valid_late;
    assign {sum_trace, sum_lasts, sum_memory, sum_adds, sum_loads, sum_kind, sum_register, sum_x, sum_y} = sum_what;
    delay #(.W(6+REGISTER_W+3*BANK_W), .N(TIMING_EARLY)) u_issue (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({sum_kind, sum_register, spot(sum_x, sum_context), spot(product_x, product_context), spot(product_y, product_context)}),
        .q_o({issue_minus_x, issue_minus_y, issue_twice, issue_half, issue_st_now, issue_st_y, issue_register,
              issue_sum_x, issue_product_x, issue_product_y}));
    delay #(.W(1), .N(TIMING_EARLY)) u_valid (.clk_i(clk_i), .rst_i(rst_i), .d_i(sum_valid), .q_o(valid_late));
    delay #(.W(ROW_W), .N(1+TIMING_EARLY)) u_st_row (.clk_i(clk_i), .rst_i(1'b0), .d_i(sum_row), .q_o(issue_st_row));
    assign issue_st     = issue_st_now && valid_late;
    assign issue_record = record_i;
    assign issue_sum_y  = spot(sum_y, sum_context);
    assign issue_o      = `DUAL_ISSUE;

    `DUAL_RETIRE_FIELDS
    delay #(.W(5), .N(LATENCY-1)) u_ends (.clk_i(clk_i), .rst_i(rst_i),
        .d_i({sum_valid, sum_valid && sum_adds, sum_valid && sum_loads, product_valid, product_valid && product_loads}),
        .q_o({retire_sum_valid, retire_sum_adds, retire_sum_loads, retire_product_valid, retire_product_loads}));
    delay #(.W(2*REG_W), .N(LATENCY-1)) u_registers (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({sum_context, sum_register, product_context, product_register}),
        .q_o({retire_sum_context, retire_sum_register, retire_product_context, retire_product_register}));
    delay #(.W(2*ROW_W), .N(LATENCY-2)) u_rows (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({sum_row, product_row}), .q_o({retire_sum_row, retire_product_row}));
    assign retire_load_row      = retire_product_loads ? retire_product_row : retire_sum_row;
    assign retire_load_register = retire_product_loads ? retire_product_register : retire_sum_register;
    assign retire_o = `DUAL_RETIRE;

    // Every running cycle is an issue or exactly one stall -----------------------------------------
    wire [4:0] of_sums, of_products;
    reg  [4:0] sum_kind_q, product_kind_q;
    always @(posedge clk_i) if (d_take) begin
        if (to_products) product_kind_q <= {to_memory, 2'b00, to_mul, 1'b0};
        else             sum_kind_q     <= {to_memory, 3'b000, to_add};
    end
    assign of_sums     = sum_kind_q & {5{sum_busy}};
    assign of_products = product_kind_q & {5{product_busy}};
    assign issued_o    = of_sums | of_products;
    assign paired_o    = sum_busy && product_busy;
    delay #(.W(1), .N(LATENCY+6)) u_retired (.clk_i(clk_i), .rst_i(rst_i), .d_i(busy), .q_o(retired_o));
    wire quiet = running_o && !busy;
    assign stall_dependency_o = quiet && known && legal && !d_take;
    assign stall_fetch_o      = quiet && in_round && issuing && !stall_dependency_o;
    assign stall_drain_o      = quiet && !stall_dependency_o && !stall_fetch_o;

    assign trace_o         = {product_valid, sum_valid};
    assign trace_pc_o      = {product_trace[TRACE_W-1:32], sum_trace[TRACE_W-1:32]};
    assign trace_word_o    = {product_trace[31:0], sum_trace[31:0]};
    assign trace_context_o = {product_context, sum_context};

    // Nobody sleeps, and nobody asks for the number of the step.
    wire unused = &{base, last, batch, skip, ends, newstep, to_chain, to_sleep, lds, choice, c, sum_lasts, product_lasts,
                    sum_memory, report_flags, report_answer, report_valid, report_asleep, report_batch, report_context};

`ifdef FP3_CHECK
    reg  [15:0] age [0:CONTEXTS-1];    // cycles since a context issued
    wire [3:0]  causes = {busy, stall_dependency_o, stall_fetch_o, stall_drain_o};
    integer     k;
    always @(posedge clk_i) begin
        for (k = 0; k < CONTEXTS; k = k + 1) begin
            age[k] <= rst_i ? 16'hffff
                    : (sum_valid && sum_context == k[CONTEXT_W-1:0]) || (product_valid && product_context == k[CONTEXT_W-1:0])
                    ? 16'd1 : age[k] == 16'hffff ? age[k] : age[k] + 1'b1;
            if (!rst_i && {16'd0, age[k]} < GAP
                && ((sum_valid && sum_context == k[CONTEXT_W-1:0]) || (product_valid && product_context == k[CONTEXT_W-1:0]))) begin
                $display("%m: context %0d issued again after %0d cycles, %0d are needed", k, age[k], GAP); $stop;
            end
        end
        if (!rst_i && sum_valid && product_valid && (sum_context == product_context || sum_memory || product_loads)) begin
            $display("%m: context %0d issues twice in a cycle, or a load or a store beside another instruction", sum_context); $stop;
        end
        if (!rst_i && (running_o ? causes == 4'd0 || |(causes & (causes - 1'b1)) : |causes)) begin
            $display("%m: issue and stalls %b in a cycle, running is %b", causes, running_o); $stop;
        end
    end
`endif
endmodule
`default_nettype wire
