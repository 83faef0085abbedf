// SPDX-License-Identifier: Apache-2.0
// fp3_two_streams: the instructions under way, where a sum and a product may issue at once.
//
// Purpose   An instruction begins at least GAP cycles after the instruction before, and when its
//           unit is free: a product is usually half a sweep ahead of the next sum. A load or a
//           store takes both units.
//
//           the next instruction ──► dual_pace: not yet ──┬► dual_sweep of sums ───────┬─► lanes
//                                                         └► dual_sweep of products ───┘
//
// Latency   Two cycles from a dual_sweep to the lane for a sum's y, TIMING_EARLY more for everything
//           else.
// Hazard    Only dual_pace prevents hazards: between two issues of one context at least GAP cycles
//           pass. The inputs of the next instruction stay while valid_i is high. take_i, which
//           comes with load_o, ends this.
`default_nettype none
`include "gen/settings.vh"
`include "front/decoded.vh"
`include "sequence/issued.vh"
`include "lane/bundles.vh"
module fp3_two_streams #(
`include "config/config.vh"
) (
    input  wire                      clk_i,
    input  wire                      rst_i,
    // The run and the round
    input  wire                      open_i,       // a round begins
    input  wire                      abort_i,      // drop everything
    input  wire [`FP3_SETTINGS_W-1:0]    settings_i,
    // The next instruction
    input  wire                      valid_i,
    input  wire                      take_i,
    input  wire [`FP3_DECODED_W-1:0]     decoded_i,
    input  wire [PROGRAM_W-1:0]      pc_i,
    input  wire [31:0]               word_i,
    input  wire [CONTEXTS-1:0]       mask_i,       // for which contexts
    input  wire [ROW_W-1:0]          row_i,        // of context 0
    output wire                      known_o,      // its mask is counted: it waits only for earlier sweeps
    output wire                      load_o,       // its sweep begins in the next cycle
    // The sweeps
    output wire                      busy_o,
    output wire [4:0]                kinds_o,      // what issues: memory, sleep, chain, mul, add
    output wire                      paired_o,     // two instructions issue
    output wire                      issued_late_o,// an instruction has issued in the cycle before
    // Lanes and trace: of sums and loads and stores, of products in the high bits
    output wire [`FP3_DUAL_ISSUE_W-1:0]  issue_o,
    output wire [`FP3_DUAL_RETIRE_W-1:0] retire_o,
    output wire [2*`FP3_ISSUED_W-1:0]    issued_o
);
    localparam COUNT_W = $clog2(GAP + CONTEXTS + 1);
    localparam TRACE_W = PROGRAM_W + 32;
    `FP3_DECODED_FIELDS
    assign `FP3_DECODED = decoded_i;

    // Operands: x from the bank of sums, y from that of products; either may be a constant instead.
    wire                swapped = (!a[REGISTER_W] && a[0]) || (!b[REGISTER_W] && !b[0]);
    wire [REGISTER_W:0] x = st ? {1'b0, d} : swapped ? b : a;
    wire [REGISTER_W:0] y = st ? {1'b0, d} : swapped ? a : b;

    // The sweeps
    // ---------------------------------------------------------------------------------------
    localparam SUM_W = TRACE_W + 9 + REGISTER_W + 2 * (REGISTER_W + 1), PRODUCT_W = TRACE_W + 1 + CHOICE_W + REGISTER_W + 2 * (REGISTER_W + 1);
    reg                  memory_q;         // both units are taken
    wire                 to_products = to_mul || (to_memory && !st && d[0]);
    wire                 sum_busy, sum_free, product_busy, product_free, sum_valid, product_valid;
    wire [COUNT_W-1:0]   count;
    wire [CONTEXT_W-1:0] sum_context, product_context;
    wire [ROW_W-1:0]     sum_row, product_row;
    fp3_dual_pace #(.CONTEXTS(CONTEXTS), .GAP(GAP), .COUNT_W(COUNT_W)) u_pace (.clk_i(clk_i), .rst_i(rst_i),
        .start_i(open_i),
        .valid_i(valid_i), .mask_i(mask_i), .adds_i(to_add || to_memory || memory_q),
        .muls_i(to_mul || to_memory || memory_q),
        .legal_i(legal), .take_i(take_i), .known_o(known_o), .count_o(count), .may_o(load_o),
        .adder_i(sum_free), .multiplier_i(product_free));
    always @(posedge clk_i) if (load_o) memory_q <= to_memory; else if (open_i) memory_q <= 1'b0;
    assign busy_o = sum_busy || product_busy;

    wire [SUM_W-1:0]      sum_what;
    wire [PRODUCT_W-1:0]  product_what;
    wire [TRACE_W-1:0]    sum_trace, product_trace;
    wire                  sum_adds, sum_loads, sum_memory, product_loads;
    wire [CHOICE_W-1:0]   product_choice;
    wire [REGISTER_W-1:0] sum_register, product_register;
    wire [REGISTER_W:0]   sum_x, sum_y, product_x, product_y;
    fp3_dual_sweep #(.WHAT_W(SUM_W), .COUNT_W(COUNT_W), .CONTEXT_W(CONTEXT_W), .ROW_W(ROW_W)) u_sums (.clk_i(clk_i),
        .rst_i(rst_i || abort_i),
        .load_i(load_o && !to_products), .count_i(count), .base_i(row_i),
        .what_i({pc_i, word_i, to_memory, to_add, to_memory && !st, subtract && swapped, subtract && !swapped,
                 twice, halve, st, st && d[0], d, x, y}),
        .busy_o(sum_busy), .free_o(sum_free), .valid_o(sum_valid), .context_o(sum_context), .what_o(sum_what),
        .row_o(sum_row));
    fp3_dual_sweep #(.WHAT_W(PRODUCT_W), .COUNT_W(COUNT_W), .CONTEXT_W(CONTEXT_W), .ROW_W(ROW_W)) u_products (
        .clk_i(clk_i), .rst_i(rst_i || abort_i),
        .load_i(load_o && to_products), .count_i(count), .base_i(row_i),
        .what_i({pc_i, word_i, to_memory, choice, d, x, y}),
        .busy_o(product_busy), .free_o(product_free), .valid_o(product_valid), .context_o(product_context),
        .what_o(product_what), .row_o(product_row));
    assign {product_trace, product_loads, product_choice, product_register, product_x, product_y} = product_what;

    // To the lanes
    // ----------------------------------------------------------------------------------------
    function [BANK_W-1:0] spot(input [REGISTER_W:0] of, input [CONTEXT_W-1:0] context_number);
        spot = of[REGISTER_W] ? {{CONTEXT_W-1{1'b1}}, of[REGISTER_W-1:0]} : {context_number, of[REGISTER_W-1:1]};
    endfunction
    // A sum's y at once, the rest later.
    `FP3_DUAL_ISSUE_FIELDS
    wire [5:0] sum_kind;
    wire       issue_st_now, valid_late;
    assign {sum_trace, sum_memory, sum_adds, sum_loads, sum_kind, sum_register, sum_x, sum_y} = sum_what;
    fp3_delay #(.W(6+CHOICE_W+REGISTER_W+3*BANK_W), .N(TIMING_EARLY)) u_issue (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({sum_kind, product_choice, sum_register, spot(sum_x, sum_context), spot(product_x, product_context), spot(product_y, product_context)}),
        .q_o({issue_minus_x, issue_minus_y, issue_twice, issue_halve, issue_st_now, issue_st_y, issue_choice, issue_register,
              issue_sum_x, issue_product_x, issue_product_y}));
    fp3_delay #(.W(1), .N(TIMING_EARLY)) u_valid (.clk_i(clk_i), .rst_i(rst_i), .d_i(sum_valid), .q_o(valid_late));
    fp3_delay #(.W(ROW_W), .N(1+TIMING_EARLY)) u_st_row (.clk_i(clk_i), .rst_i(1'b0), .d_i(sum_row),
        .q_o(issue_st_row));
    assign issue_st     = issue_st_now && valid_late;
    `FP3_SETTINGS_FIELDS
    assign `FP3_SETTINGS    = settings_i;
    assign issue_record_shift = setting_record;
    assign issue_sum_y  = spot(sum_y, sum_context);
    assign issue_o      = `FP3_DUAL_ISSUE;

    `FP3_DUAL_RETIRE_FIELDS
    fp3_delay #(.W(5), .N(TO_END)) u_ends (.clk_i(clk_i), .rst_i(rst_i),
        .d_i({sum_valid, sum_valid && sum_adds, sum_valid && sum_loads, product_valid, product_valid && product_loads}),
        .q_o({retire_sum_valid, retire_sum_adds, retire_sum_loads, retire_product_valid, retire_product_loads}));
    fp3_delay #(.W(2*REG_W), .N(TO_END)) u_registers (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({sum_context, sum_register, product_context, product_register}),
        .q_o({retire_sum_context, retire_sum_register, retire_product_context, retire_product_register}));
    fp3_delay #(.W(2*ROW_W), .N(TO_END-1)) u_rows (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({sum_row, product_row}), .q_o({retire_sum_row, retire_product_row}));
    assign retire_load_row      = retire_product_loads ? retire_product_row : retire_sum_row;
    assign retire_load_register = retire_product_loads ? retire_product_register : retire_sum_register;
    assign retire_o = `FP3_DUAL_RETIRE;

    // Counters and trace
    // ----------------------------------------------------------------------------------
    reg [4:0] sum_kind_q, product_kind_q;
    always @(posedge clk_i) if (load_o) begin
        if (to_products) product_kind_q <= {to_memory, 2'b00, to_mul, 1'b0};
        else             sum_kind_q     <= {to_memory, 3'b000, to_add};
    end
    assign kinds_o  = (sum_kind_q & {5{sum_busy}}) | (product_kind_q & {5{product_busy}});
    assign paired_o = sum_busy && product_busy;
    assign issued_late_o = sum_valid || product_valid;

    genvar p;
    generate
        for (p = 0; p < 2; p = p + 1) begin : g_trace
            `FP3_ISSUED_FIELDS
            wire [TRACE_W-1:0]   trace          = p == 0 ? sum_trace : product_trace;
            wire [CONTEXT_W-1:0] context_number = p == 0 ? sum_context : product_context;
            assign issued_valid   = p == 0 ? sum_valid : product_valid;
            assign issued_pc      = {{16-PROGRAM_W{1'b0}}, trace[TRACE_W-1:32]};
            assign issued_context = {{16-CONTEXT_W{1'b0}}, context_number};
            assign issued_word    = trace[31:0];
            assign issued_o[`FP3_ISSUED_W*p +: `FP3_ISSUED_W] = `FP3_ISSUED;
        end
    endgenerate
    wire unused = sum_memory;

`ifdef FP3_CHECK
    reg  [15:0]         age [0:CONTEXTS-1];    // cycles since a context issued
    reg  [CONTEXTS-1:0] comes;
    integer             k, n;
    always @*
        for (k = 0; k < CONTEXTS; k = k + 1)
            comes[k] = (sum_valid && sum_context == k[CONTEXT_W-1:0]) || (product_valid && product_context == k[CONTEXT_W-1:0]);
    always @(posedge clk_i) begin
        for (n = 0; n < CONTEXTS; n = n + 1) begin
            age[n] <= rst_i ? 16'hffff : comes[n] ? 16'd1 : age[n] == 16'hffff ? age[n] : age[n] + 1'b1;
            if (!rst_i && comes[n] && {16'd0, age[n]} < GAP) begin
                $display("%m: context %0d issued again after %0d cycles, %0d are needed", n, age[n], GAP); $stop;
            end
        end
        if (!rst_i && sum_valid && product_valid && (sum_context == product_context || sum_memory || product_loads)) begin
            $display("%m: context %0d issues twice in a cycle, or a load or a store beside another instruction", sum_context); $stop;
        end
    end
`endif
endmodule
`default_nettype wire
`include "config/undefine.vh"
