// SPDX-License-Identifier: Apache-2.0
// fp3_rounds: divides a run into rounds; a round visits every awake object once.
//
// Purpose   Divides the steps of a run into rounds, begins each round when all is at rest, and ends
//           the run: after its last step, when no object is awake, or early.
//
//           start_i ─► WAIT ─────────► PLAN ─► OPEN ─► RUN ──┐     PLAN: the steps of the round
//                       │  ▲  at rest                        │     OPEN: open_o, one cycle
//              idle ◄───┘  └────── nothing left to issue ◄───┘
//
//           With EXCHANGE, COPY comes before PLAN: until copied_i, or an abort.
//
// Latency   At rest means SETTLE cycles after the last issue, when every report has come.
// Hazard    start_i comes only when running_o is low. The settings then stay as they are until the
//           end of the run; steps is not 0. A stop waits for the end of a last part that has begun,
//           so no object is stored partly.
//
//     steps = 5, visit = 2, clock = 100:
//     round      1    2    3
//     steps_o    2    2    1
//     base_o   100  102  104        the number of the last step before it
`default_nettype none
`include "gen/settings.vh"
module fp3_rounds #(
`include "config/config.vh"
) (
    input  wire           clk_i,
    input  wire           rst_i,
    // A run
    input  wire           start_i,
    input  wire           stop_i,
    input  wire           illegal_i,   // an instruction that this build does not have: the run ends
    input  wire           no_room_i,   // a list has no room: the run ends behind the round
    input  wire [`FP3_SETTINGS_W-1:0] settings_i,
    output wire           running_o,
    // The state of the run
    input  wire [ROW_W:0] count_i,     // objects to be visited
    input  wire           issuing_i,   // something is left to issue
    input  wire           storing_i,   // a last part has begun
    input  wire           partial_i,   // the step has phases left: the next round goes on with it
    input  wire           copied_i,    // lanes have the copies that they need
    // Rounds
    output wire           copy_o,      // a round is about to begin: lanes need copies
    output wire           open_o,      // a round begins
    output wire           begin_o,     // a round begins and is not aborted: fetch begins
    output wire           round_o,     // a round has begun
    output wire           closed_o,    // the round has come to its end
    output wire           settled_o,   // every report about it has come
    output wire           abort_o,     // drop everything
    output wire [31:0]    steps_o,     // of this round
    output wire [31:0]    base_o,      // the number of the last step before the round
    output wire [31:0]    end_o        // the number of its last step
);
    `FP3_SETTINGS_FIELDS
    assign `FP3_SETTINGS = settings_i;
    localparam integer SETTLE_W = $clog2(SETTLE + 1);
    localparam [2:0] IDLE = 3'd0, WAIT = 3'd1, PLAN = 3'd2, OPEN = 3'd3, RUN = 3'd4, COPY = 3'd5;

    reg  [2:0]          state_q;
    reg  [SETTLE_W-1:0] settle_q;
    reg  [31:0]         left_q;        // steps after the rounds that have begun
    reg  [31:0]         rest_q;        // what left_q becomes as this round begins
    reg  [31:0]         steps_q, base_q, end_q;
    reg                 aborted_q;
    // These are stable in WAIT, which lasts long enough for two registers, so the 32-bit
    // comparisons need not fit into PLAN.
    reg                 none_left_q, all_q;
    reg                 no_visit_q, high_more_q, high_same_q, low_more_q;
    wire                over = aborted_q || (none_left_q && !partial_i) || count_i == {ROW_W+1{1'b0}};

    reg                 stopping_q, stop_q;
    wire                stopping = running_o && !stop_q && (stop_i || stopping_q);
    always @(posedge clk_i) begin
        stopping_q <= !rst_i && stopping;
        stop_q     <= !rst_i && stopping && !storing_i;
    end

    always @(posedge clk_i)
        if (rst_i) begin
            state_q   <= IDLE;
            aborted_q <= 1'b0;
        end else begin
            aborted_q <= running_o && (aborted_q || abort_o);
            if (KEEP != 0 && running_o && no_room_i) aborted_q <= 1'b1;
            case (state_q)
                IDLE:    if (start_i) state_q <= WAIT;
                WAIT:    if (settled_o) state_q <= over ? IDLE : EXCHANGE != 0 ? COPY : PLAN;
                PLAN:    state_q <= OPEN;
                OPEN:    state_q <= RUN;
                default: if (EXCHANGE != 0 && state_q == COPY) begin
                             if (aborted_q)     state_q <= WAIT;
                             else if (copied_i) state_q <= PLAN;
                         end else if (!issuing_i) state_q <= WAIT;
            endcase
        end

    always @(posedge clk_i) begin
        settle_q <= state_q == WAIT ? settle_q - 1'b1 : SETTLE[SETTLE_W-1:0];
        if (start_i) {left_q, base_q, steps_q} <= {setting_steps, setting_clock, 32'd0};
        else if (state_q == PLAN && !partial_i) begin
            steps_q <= all_q ? left_q : setting_visit;
            base_q  <= base_q + steps_q;
        end else if (round_o) left_q <= rest_q;
        if (open_o) rest_q <= partial_i ? left_q : left_q - steps_q;
        end_q  <= base_q + steps_q;
        none_left_q <= left_q == 32'd0;
        no_visit_q  <= setting_visit == 32'd0;
        high_more_q <= setting_visit[31:16] > left_q[31:16];
        high_same_q <= setting_visit[31:16] == left_q[31:16];
        low_more_q  <= setting_visit[15:0] > left_q[15:0];
        all_q       <= no_visit_q || high_more_q || (high_same_q && low_more_q);
    end
    assign running_o = state_q != IDLE;
    assign settled_o = state_q == WAIT && settle_q == {SETTLE_W{1'b0}};
    assign copy_o    = EXCHANGE != 0 && settled_o && !over;
    assign open_o    = state_q == OPEN;
    assign begin_o   = open_o && !aborted_q;
    assign round_o   = state_q == RUN;
    assign closed_o  = round_o && !issuing_i && !abort_o && !aborted_q;
    assign abort_o   = stop_q || illegal_i;
    assign {steps_o, base_o, end_o} = {steps_q, base_q, end_q};

`ifdef FP3_CHECK
    reg [`FP3_SETTINGS_W-1:0] run_q;
    always @(posedge clk_i)
        if (!rst_i) begin
            if (start_i) run_q <= settings_i;
            if (start_i && (running_o || setting_steps == 32'd0)) begin
                $display("%m: a run starts within a run, or has no steps"); $stop;
            end
            if (running_o && run_q != settings_i) begin
                $display("%m: a setting of the run changes within it"); $stop;
            end
        end
`endif
endmodule
`default_nettype wire
`include "config/undefine.vh"
