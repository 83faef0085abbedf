// tile: schedulers and lanes with the arithmetic that they work on.
//
// Purpose   Two ways to share. Several schedulers, each with a program of its own, share one adder
//           and one multiplier (the paper's Figure 3). Or one scheduler drives several lanes, each
//           with an adder and a multiplier: control is shared. Lanes under several schedulers are not
//           built (config_rules refuses them).
//
//           scheduler ──┐ arbiter                         ┌─► lane ◄─► multiplier ─► adder
//           scheduler ──┴───► multiplier, adder           scheduler ─► lane ◄─► multiplier ─► adder
//
// Latency   See lane: MUL_LATENCY + ADD_LATENCY, one more where schedulers share.
// Hazard    In each cycle at most one scheduler has the adder, and one the multiplier.
`default_nettype none
`include "host/answer.vh"
module tile #(
`include "config/config.vh"
) (
    input  wire                     clk_i,
    input  wire                     rst_i,
    // A host port for each scheduler
    input  wire [SCHEDULERS-1:0]    req_valid_i,
    input  wire                     req_write_i,
    input  wire [23:0]              req_addr_i,
    input  wire [31:0]              req_wdata_i,
    output wire [`ANSWER_W*SCHEDULERS-1:0] answer_o,
    output wire [SCHEDULERS-1:0]    irq_o,
    // Trace: STREAMS parts for each scheduler, and for each lane of each
    output wire [SCHEDULERS*STREAMS-1:0]          issue_valid_o,
    output wire [16*SCHEDULERS*STREAMS-1:0]       issue_pc_o,
    output wire [16*SCHEDULERS*STREAMS-1:0]       issue_context_o,
    output wire [32*SCHEDULERS*STREAMS-1:0]       issue_word_o,
    output wire [2*SCHEDULERS*LANES*STREAMS-1:0]  retire_end_o,
    output wire [SCHEDULERS*LANES*STREAMS-1:0]    retire_valid_o,
    output wire [16*SCHEDULERS*LANES*STREAMS-1:0] retire_context_o,
    output wire [32*SCHEDULERS*LANES*STREAMS-1:0] retire_object_o,
    output wire [6*SCHEDULERS*LANES*STREAMS-1:0]  retire_register_o,
    output wire [32*SCHEDULERS*LANES*STREAMS-1:0] retire_value_o,
    output wire [5*SCHEDULERS*LANES*STREAMS-1:0]  retire_flags_o
);
    localparam N = SCHEDULERS * LANES, I = STREAMS, R = LANES * STREAMS;    // parts of a scheduler's trace

    wire [SCHEDULERS-1:0] running, adds, muls, lasts, grant;
    wire [N-1:0]          subtract, twice, half;
    wire [CHOICE_W*N-1:0] choice;
    wire [32*N-1:0]       xs, ys, zs, value;
    wire [5*N-1:0]        flags;

    genvar s, l;
    generate
        for (s = 0; s < SCHEDULERS; s = s + 1) begin : g_scheduler
            tile_scheduler #(.CONFIG(CONFIG)) u_scheduler (
                .clk_i(clk_i), .rst_i(rst_i),
                .req_valid_i(req_valid_i[s]), .req_write_i(req_write_i),
                .req_addr_i(req_addr_i), .req_wdata_i(req_wdata_i),
                .answer_o(answer_o[`ANSWER_W*s +: `ANSWER_W]), .irq_o(irq_o[s]),
                .running_o(running[s]), .adds_o(adds[s]), .muls_o(muls[s]), .lasts_o(lasts[s]), .grant_i(grant[s]),
                .subtract_o(subtract[LANES*s +: LANES]),
                .twice_o(twice[LANES*s +: LANES]), .half_o(half[LANES*s +: LANES]), .choice_o(choice[CHOICE_W*LANES*s +: CHOICE_W*LANES]),
                .x_o(xs[32*LANES*s +: 32*LANES]),
                .y_o(ys[32*LANES*s +: 32*LANES]), .z_o(zs[32*LANES*s +: 32*LANES]),
                .value_i(value[32*LANES*s +: 32*LANES]), .value_flags_i(flags[5*LANES*s +: 5*LANES]),
                .issue_valid_o(issue_valid_o[I*s +: I]), .issue_pc_o(issue_pc_o[16*I*s +: 16*I]),
                .issue_context_o(issue_context_o[16*I*s +: 16*I]), .issue_word_o(issue_word_o[32*I*s +: 32*I]),
                .retire_end_o(retire_end_o[2*R*s +: 2*R]), .retire_valid_o(retire_valid_o[R*s +: R]),
                .retire_context_o(retire_context_o[16*R*s +: 16*R]), .retire_object_o(retire_object_o[32*R*s +: 32*R]),
                .retire_register_o(retire_register_o[6*R*s +: 6*R]), .retire_value_o(retire_value_o[32*R*s +: 32*R]),
                .retire_flags_o(retire_flags_o[5*R*s +: 5*R]));
        end

        if (DUAL != 0) begin : g_inside                // each lane has its arithmetic
            assign {grant, value, flags} = {SCHEDULERS+37*N{1'b0}};
            wire unused = |{running, adds, muls, lasts, twice, half, subtract, choice, xs, ys, zs};
        end else if (SCHEDULERS == 1) begin : g_own
            assign grant = 1'b1;
            wire unused = &{running, adds, muls, lasts, twice, half};     // x * 2 is a product there
            for (l = 0; l < LANES; l = l + 1) begin : g_lane
                lane_arith #(.CONFIG(CONFIG)) u_arith (
                    .clk_i(clk_i), .subtract_i(subtract[l]), .choice_i(choice[CHOICE_W*l +: CHOICE_W]), .x_i(xs[32*l +: 32]), .y_i(ys[32*l +: 32]),
                    .z_i(zs[32*l +: 32]), .value_o(value[32*l +: 32]), .flags_o(flags[5*l +: 5]));
            end
        end else begin : g_shared
            wire [SCHEDULERS-1:0] adds_late, muls_late;
            reg idle_q;                              // the order begins anew, so that a run's cycles do not
            always @(posedge clk_i) idle_q <= running == {SCHEDULERS{1'b0}};        // depend on runs before it
            arbiter #(.N(SCHEDULERS)) u_arbiter (.clk_i(clk_i), .rst_i(rst_i || idle_q),
                .adds_i(adds), .muls_i(muls), .lasts_i(lasts), .grant_o(grant));
            delay #(.W(2*SCHEDULERS), .N(TIMING_OPERANDS+2)) u_granted (.clk_i(clk_i), .rst_i(1'b0),
                .d_i({adds & grant, muls & grant}), .q_o({adds_late, muls_late}));
            shared_arith #(.CONFIG(CONFIG)) u_arith (
                .clk_i(clk_i), .adds_i(adds_late), .muls_i(muls_late), .subtract_i(subtract),
                .twice_i(twice), .half_i(half), .choice_i(choice),
                .x_i(xs), .y_i(ys), .z_i(zs), .value_o(value), .flags_o(flags));
        end
    endgenerate

`ifdef FP3_CHECK
    wire [SCHEDULERS-1:0] adding = adds & grant, multiplying = muls & grant;
    always @(posedge clk_i)
        if (!rst_i && (|(adding & (adding - 1'b1)) || |(multiplying & (multiplying - 1'b1)))) begin
            $display("%m: granted to more than one: adder %b, multiplier %b", adding, multiplying); $stop;
        end
`endif
endmodule
`default_nettype wire
