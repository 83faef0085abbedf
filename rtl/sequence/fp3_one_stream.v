// SPDX-License-Identifier: Apache-2.0
// fp3_one_stream: the instruction under way, where one issues in each cycle.
//
// Purpose   An instruction waits until pace lets its sweep begin. The sweep issues the instruction
//           for one context in each cycle in which the shared units are granted.
//
//           the next instruction ──► pace: not yet ──► sweep ──► issue ──► lanes
//
// Latency   Two cycles from the sweep to the lane's REACH, AHEAD more to its operands. A sweep of
//           GAP contexts or more needs no pause.
// Hazard    Only pace prevents hazards: between two issues of one context at least GAP cycles pass.
//           The inputs of the next instruction stay while valid_i is high. take_i ends this: with
//           load_o, or with known_o if the mask is empty.
`default_nettype none
`include "gen/settings.vh"
`include "front/decoded.vh"
`include "front/marks.vh"
`include "sequence/issued.vh"
`include "lane/bundles.vh"
module fp3_one_stream #(
`include "config/config.vh"
) (
    input  wire                  clk_i,
    input  wire                  rst_i,
    // The run and the round
    input  wire                  open_i,        // a round begins
    input  wire                  abort_i,       // drop everything
    input  wire [`FP3_SETTINGS_W-1:0]    settings_i,
    input  wire [31:0]           base_i,        // the number of the last step before the round
    input  wire [31:0]           end_i,         // of its last step
    // The next instruction
    input  wire                  valid_i,
    input  wire                  goes_i,        // it has a sweep
    input  wire                  take_i,
    input  wire [`FP3_DECODED_W-1:0] decoded_i,
    input  wire [`FP3_MARKS_W-1:0]   marks_i,
    input  wire [PROGRAM_W-1:0]  pc_i,
    input  wire [31:0]           word_i,
    input  wire [CONTEXTS-1:0]   mask_i,        // for which contexts
    input  wire [AROUND_W-1:0]  around_i,
    input  wire                  batch_i,       // two batches in a row differ in it
    output wire                  known_o,       // its mask is counted: it waits only for earlier sweeps
    output wire                  load_o,        // its sweep begins in the next cycle
    // The sweep
    output wire                  busy_o,
    output wire                  adds_o,        // this instruction needs the adder
    output wire                  muls_o,
    output wire                  sweep_end_o,   // the last of its sweep
    input  wire                  grant_i,
    output wire [4:0]            kinds_o,       // it issues: memory, sleep, chain, mul, add
    output wire                  issued_late_o, // it has issued in the cycle before
    // Lanes and trace
    output wire [`FP3_REACH_W-1:0]   reach_o,
    output wire [`FP3_ISSUE_W-1:0]   issue_o,
    output wire [`FP3_RETIRE_W-1:0]  retire_o,
    output wire [31:0]           step_o,        // the number of the step
    output wire [DRAW_W-1:0]     draw_o,
    output wire [`FP3_ISSUED_W-1:0]  issued_o
);
    localparam COUNT_W = $clog2(GAP + CONTEXTS + 1);

    wire                may, busy, sweep_end;
    wire                issue = busy && grant_i;
    wire [CONTEXTS-1:0] current;
    wire [COUNT_W-1:0]  count;
    fp3_pace #(.CONTEXTS(CONTEXTS), .GAP(GAP), .COUNT_W(COUNT_W)) u_pace (.clk_i(clk_i), .rst_i(rst_i),
        .start_i(open_i),
        .valid_i(valid_i), .mask_i(mask_i), .take_i(take_i), .known_o(known_o), .count_o(count), .may_o(may),
        .busy_i(busy), .over_i(issue && sweep_end));
    fp3_sweep #(.CONTEXTS(CONTEXTS), .COUNT_W(COUNT_W)) u_sweep (.clk_i(clk_i), .rst_i(rst_i || abort_i),
        .load_i(load_o),
        .mask_i(mask_i), .count_i(count), .next_i(issue), .busy_o(busy), .current_o(current), .sweep_end_o(sweep_end));
    assign load_o = may && goes_i;
    assign busy_o = busy;

    reg                  first_q, batch_q;
    reg [`FP3_DECODED_W-1:0] decoded_q;
    reg [`FP3_MARKS_W-1:0]   marks_q;
    reg [AROUND_W-1:0]  around_q;
    reg [PROGRAM_W-1:0]  pc_q, pc_late_q;
    reg [31:0]           word_q, word_late_q;
    always @(posedge clk_i) begin
        if (load_o) begin
            {decoded_q, marks_q, batch_q, pc_q, word_q} <= {decoded_i, marks_i, batch_i, pc_i, word_i};
            around_q <= around_i;
            first_q <= 1'b1;
        end else if (issue) first_q <= 1'b0;
        {pc_late_q, word_late_q} <= {pc_q, word_q};
    end

    `FP3_ISSUED_FIELDS
    wire                 adds, muls;
    wire [CONTEXT_W-1:0] context_number;
    fp3_issue #(.CONFIG(CONFIG)) u_issue (.clk_i(clk_i), .rst_i(rst_i),
        .settings_i(settings_i), .open_i(open_i), .base_i(base_i), .end_i(end_i),
        .issue_i(issue), .first_i(first_q), .batch_i(batch_q), .current_i(current),
        .decoded_i(decoded_q), .marks_i(marks_q), .around_i(around_q),
        .adds_o(adds), .muls_o(muls), .issued_o(kinds_o), .reach_o(reach_o), .issue_o(issue_o), .retire_o(retire_o),
        .step_o(step_o),
        .valid_o(issued_valid), .context_o(context_number));
    generate
        if (STORAGE != 0) begin : g_draws
            `FP3_DECODED_FIELDS
            assign `FP3_DECODED = decoded_q;
            fp3_draws #(.CONFIG(CONFIG)) u_draws (.clk_i(clk_i), .settings_i(settings_i), .open_i(open_i),
                .base_i(base_i), .end_i(end_i),
                .issue_i(issue), .first_i(first_q), .marks_i(marks_q), .register_i(d), .draw_o(draw_o));
        end else begin : g_no_draws
            assign draw_o = {DRAW_W{1'b0}};
        end
    endgenerate
    assign {adds_o, muls_o, sweep_end_o} = {busy && adds, busy && muls, sweep_end};
    assign issued_pc      = {{16-PROGRAM_W{1'b0}}, pc_late_q};
    assign issued_context = {{16-CONTEXT_W{1'b0}}, context_number};
    assign issued_word    = word_late_q;
    assign issued_o       = `FP3_ISSUED;
    assign issued_late_o  = issued_valid;

`ifdef FP3_CHECK
    reg  [15:0] age [0:CONTEXTS-1];    // cycles since a context issued
    integer     k;
    always @(posedge clk_i)
        for (k = 0; k < CONTEXTS; k = k + 1) begin
            age[k] <= rst_i ? 16'hffff : issue && current[k] ? 16'd1 : age[k] == 16'hffff ? age[k] : age[k] + 1'b1;
            if (!rst_i && issue && current[k] && {16'd0, age[k]} < GAP) begin
                $display("%m: context %0d issued again after %0d cycles, %0d are needed", k, age[k], GAP); $stop;
            end
        end
`endif
endmodule
`default_nettype wire
`include "config/undefine.vh"
