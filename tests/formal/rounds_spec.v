// rounds_spec: the promises of fp3_rounds.v, for each run: any steps and visits, objects that fall asleep, phases, stops at any time.
`default_nettype none
`include "gen/settings.vh"
module rounds_spec #(
    parameter LEMMAS = 1,
`include "config/config.vh"
) (
    input wire           clk_i,
    input wire           rst_i,
    input wire           start_i, stop_i, illegal_i, no_room_i,
    input wire [`FP3_SETTINGS_W-1:0] settings_i,
    input wire [ROW_W:0] count_i,
    input wire           issuing_i, storing_i, partial_i, copied_i
);
    // Cycles from the last issue until a round opens or the run ends, at most: all is at rest, the decision, the plan
    localparam BOUND = SETTLE + 3;
    localparam W = $clog2(BOUND + 2);
    localparam [W-1:0] SETTLE_R = SETTLE, BOUND_R = BOUND;
    `FP3_SETTINGS_FIELDS
    assign `FP3_SETTINGS = settings_i;

    wire        running, copy, opens, begins, in_round, closed, settled, abort;
    wire [31:0] steps, base, last;
    fp3_rounds #(.CONFIG(CONFIG), .SETTLE(SETTLE)) u_rounds (.clk_i(clk_i), .rst_i(rst_i),
        .start_i(start_i), .stop_i(stop_i), .illegal_i(illegal_i), .no_room_i(no_room_i), .settings_i(settings_i), .running_o(running),
        .count_i(count_i), .issuing_i(issuing_i), .storing_i(storing_i), .partial_i(partial_i), .copied_i(copied_i),
        .copy_o(copy), .open_o(opens), .begin_o(begins), .round_o(in_round), .closed_o(closed), .settled_o(settled), .abort_o(abort),
        .steps_o(steps), .base_o(base), .end_o(last));

    // The run: what the rounds up to this one have of its steps, and why it may end
    reg        started_q = 1'b0, reset_q;
    reg        running_q;                                  // a run is under way
    reg [31:0] left_q, base_q, steps_q;                    // steps of no round yet; before this round; of it
    reg        wants_q, acts_q;                            // a stop waits; it ends the run in this cycle
    reg        ends_q;                                     // the run ends early: no round begins or closes
    reg        copies_q, plans_q, opens_q, round_q;        // copies are under way; a round is planned, opens, has opened
    reg [W-1:0] rest_q;                                    // cycles without an issue
    reg [W-1:0] waits_q;                                   // cycles outside of a round, and without copies
    wire [31:0] next  = setting_visit == 32'd0 || setting_visit > left_q ? left_q : setting_visit;
    wire        over  = ends_q || (left_q == 32'd0 && !partial_i) || count_i == 0;
    wire        goes  = settled && !over;
    wire        wants = running_q && !acts_q && (stop_i || wants_q);
    wire        early = abort || (KEEP != 0 && no_room_i);
    always @(posedge clk_i) begin
        {started_q, reset_q} <= {1'b1, rst_i};
        if (rst_i) begin
            {running_q, wants_q, acts_q, ends_q, copies_q, plans_q, opens_q, round_q} <= 8'd0;
            {rest_q, waits_q} <= {2*W{1'b0}};
        end else begin
            running_q <= start_i || (running_q && !(settled && over));
            wants_q   <= wants;
            acts_q    <= wants && !storing_i;
            ends_q    <= running_q && (ends_q || early);
            copies_q  <= EXCHANGE != 0 && (goes || (copies_q && !copied_i && !ends_q));
            plans_q   <= EXCHANGE != 0 ? copies_q && copied_i && !ends_q : goes;
            opens_q   <= plans_q;
            round_q   <= opens || (round_q && issuing_i);
            waits_q   <= round_q || !running_q || copies_q ? {W{1'b0}} : waits_q + 1'b1;
            rest_q    <= issuing_i || start_i ? {W{1'b0}} : rest_q == BOUND_R ? rest_q : rest_q + 1'b1;
        end
        if (start_i) {left_q, base_q, steps_q} <= {setting_steps, setting_clock, 32'd0};
        else if (plans_q && !partial_i) {left_q, base_q, steps_q} <= {left_q - next, base_q + steps_q, next};
    end

    // The run before, for what stays
    reg [`FP3_SETTINGS_W-1:0] settings_q;
    reg                       partial_q;
    always @(posedge clk_i) {settings_q, partial_q} <= {settings_i, partial_i};
    always @* begin
        assume (started_q || rst_i);
        assume (!start_i || (!running && setting_steps != 32'd0 && !rst_i));
        assume (!running_q || settings_i == settings_q);
        assume (!start_i || !partial_i);
        assume (NEIGHBOURS != 0 || !partial_i);
        // Issues are of a round, and what it leaves of a step is known at its end
        assume (!issuing_i || round_q);
        assume (!running_q || round_q || partial_i == partial_q);
        assume (!(copied_i && !copies_q));
        assume (!illegal_i || issuing_i);
    end

    always @* if (started_q) begin
        assert (running == running_q);
        if (reset_q) assert (!running);
        // A round opens when all is at rest, and its steps are those that come next
        assert (opens == opens_q);
        if (opens) assert (rest_q >= SETTLE_R);
        if (settled) assert (running_q && !round_q && rest_q >= SETTLE_R);
        if (opens || round_q) assert (steps == steps_q && base == base_q && steps != 32'd0);
        if (round_q) assert (last == base_q + steps_q);
        assert (in_round == round_q);
        // ... and is one of the run, unless that ends early
        assert (begins == (opens && !ends_q));
        assert (closed == (round_q && !issuing_i && !ends_q && !abort));
        // Without copies nothing delays a round; with them it waits for all
        assert (copy == (EXCHANGE != 0 && settled && !over));
        assert (waits_q <= BOUND_R);
        // A stop waits for the stores of a visit, and is not lost
        assert (abort == (acts_q || illegal_i));
    end

    localparam S = $clog2(SETTLE + 1);
    localparam [2:0] IDLE = 3'd0, WAIT = 3'd1, PLAN = 3'd2, OPEN = 3'd3, RUN = 3'd4, COPY = 3'd5;
    (* hierconn *) wire [2:0]   \u_rounds.state_q ;
    (* hierconn *) wire [31:0]  \u_rounds.left_q , \u_rounds.rest_q , \u_rounds.steps_q , \u_rounds.base_q , \u_rounds.end_q ;
    (* hierconn *) wire         \u_rounds.aborted_q , \u_rounds.stopping_q , \u_rounds.stop_q ;
    (* hierconn *) wire [S-1:0] \u_rounds.settle_q ;
    (* hierconn *) wire         \u_rounds.none_left_q , \u_rounds.all_q , \u_rounds.no_visit_q , \u_rounds.high_more_q , \u_rounds.high_same_q ,
                                \u_rounds.low_more_q ;
    wire waits = running_q && !round_q && !copies_q && !plans_q && !opens_q;
    reg  first_q;                                          // the first cycle of a round that has opened
    always @(posedge clk_i) first_q <= opens && !rst_i;
    generate
        if (LEMMAS != 0) begin : g_lemmas
            always @* if (started_q) begin
                assert (\u_rounds.state_q == (!running_q ? IDLE : round_q ? RUN : opens_q ? OPEN : plans_q ? PLAN : copies_q ? COPY : WAIT));
                assert ({2'd0, round_q} + copies_q + plans_q + opens_q <= {2'd0, running_q});
                assert (\u_rounds.aborted_q == ends_q);
                assert (\u_rounds.stop_q == acts_q && \u_rounds.stopping_q == (wants_q || acts_q));
                // The wait, and the two registers of the comparison with the visit
                assert (rest_q <= BOUND_R);
                if (waits) assert (waits_q <= SETTLE_R && \u_rounds.settle_q == SETTLE_R - waits_q && rest_q >= waits_q);
                else if (running_q && !round_q) assert (rest_q >= SETTLE_R && waits_q <= SETTLE_R + 1 + opens_q);
                if (waits ? waits_q != 0 : copies_q || plans_q) begin
                    assert (\u_rounds.none_left_q == (left_q == 0) && \u_rounds.no_visit_q == (setting_visit == 0));
                    assert (\u_rounds.high_more_q == (setting_visit[31:16] > left_q[31:16]) && \u_rounds.low_more_q == (setting_visit[15:0] > left_q[15:0]));
                    assert (\u_rounds.high_same_q == (setting_visit[31:16] == left_q[31:16]));
                end
                if (waits ? waits_q > 1 : copies_q || plans_q) assert (\u_rounds.all_q == (setting_visit == 0 || setting_visit > left_q));
                // The steps
                if (running_q) assert (\u_rounds.steps_q == steps_q && \u_rounds.base_q == base_q);
                if (running_q) assert (\u_rounds.left_q == left_q + ((opens_q || first_q) && !partial_q ? steps_q : 0));
                if (round_q) assert (\u_rounds.rest_q == left_q);
                if (first_q) assert (round_q);
                if (running_q && steps_q == 0) assert (!round_q && !opens_q && !partial_q);
                if (copies_q || plans_q)       assert (left_q != 0 || partial_q);
            end
        end
    endgenerate
endmodule
`default_nettype wire
`include "config/undefine.vh"
