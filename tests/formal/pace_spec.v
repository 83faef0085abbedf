// pace_spec: the promises of fp3_pace.v, for any sequence of sweeps, stalls and stops that its header allows.
//
// A sweep issues its contexts lowest first, one in each cycle in which go_i is high. who_i is one
// context, chosen once: the promise is about its issues.
`default_nettype none
module pace_spec #(
    parameter CONTEXTS = 24,
    parameter GAP      = 17,
    parameter LEMMAS   = 1
) (
    input wire                clk_i,
    input wire                rst_i,
    input wire                start_i,
    input wire                stop_i,    // drops the sweep under way and the next one
    input wire                valid_i,
    input wire [CONTEXTS-1:0] mask_i,
    input wire                take_i,
    input wire                go_i,
    input wire [CONTEXTS-1:0] who_i      // one bit
);
    localparam W = $clog2(GAP + CONTEXTS + 1);
    localparam [W-1:0] GAP_W = GAP, ONE = 1;
    localparam [CONTEXTS-1:0] LOW = ~({CONTEXTS{1'b1}} << CONTEXTS / 2);

    // The sweep under way ------------------------------------------------------------------------
    reg  [CONTEXTS-1:0] rest_q, sweep_q; // contexts of the last sweep that are yet to issue, and all
    wire                busy  = |rest_q;
    wire [CONTEXTS-1:0] left  = rest_q & (rest_q - 1'b1);
    wire [CONTEXTS-1:0] issue = go_i ? rest_q & ~left : {CONTEXTS{1'b0}};
    wire                over  = busy && go_i && left == {CONTEXTS{1'b0}};
    wire                known, may;
    wire [W-1:0]        count;
    fp3_pace #(.CONTEXTS(CONTEXTS), .GAP(GAP), .COUNT_W(W)) u_pace (.clk_i(clk_i), .rst_i(rst_i), .start_i(start_i),
        .valid_i(valid_i), .mask_i(mask_i), .take_i(take_i), .known_o(known), .count_o(count), .may_o(may),
        .busy_i(busy), .over_i(over));

    function [W-1:0] ones(input [CONTEXTS-1:0] mask);
        integer i;
        begin
            ones = {W{1'b0}};
            for (i = 0; i < CONTEXTS; i = i + 1) ones = ones + {{W-1{1'b0}}, mask[i]};
        end
    endfunction
    wire [CONTEXTS-1:0] under = who_i - 1'b1;
    wire [W-1:0]        total = ones(mask_i & LOW) + ones(mask_i & ~LOW);

    reg                 started_q = 1'b0, stopped_q, valid_q, take_q;
    reg  [CONTEXTS-1:0] mask_q, who_q;
    reg  [W-1:0]        age_q;           // cycles since who_i was issued, GAP at most
    reg  [W-1:0]        idle_q;          // cycles since the sweep, this one included, GAP at most
    reg  [W-1:0]        before_q;        // contexts of the mask that was taken last
    reg                 first_q;         // none was since the start
    reg  [2:0]          seen_q;          // cycles that the mask has been there, 5 at most
    always @(posedge clk_i) begin
        {started_q, valid_q, take_q, mask_q, who_q} <= {1'b1, valid_i && !rst_i, take_i && !rst_i, mask_i, who_i};
        seen_q <= rst_i || !valid_i ? 3'd0 : seen_q == 3'd5 ? 3'd5 : seen_q + 3'd1;
        if (rst_i || stop_i) stopped_q <= 1'b1;
        else if (start_i)    stopped_q <= 1'b0;
        if (rst_i || stop_i) rest_q <= {CONTEXTS{1'b0}};
        else if (take_i && |mask_i) rest_q <= mask_i;
        else if (go_i)       rest_q <= left;
        if (take_i && |mask_i) sweep_q <= mask_i;
        if (start_i)         sweep_q <= {CONTEXTS{1'b0}};
        if (start_i)         first_q <= 1'b1;
        else if (take_i)     {first_q, before_q} <= {1'b0, total};
        age_q  <= |(issue & who_i) ? ONE : age_q >= GAP_W ? GAP_W : age_q + ONE;
        idle_q <= busy ? ONE : idle_q >= GAP_W || start_i ? GAP_W : idle_q + ONE;
    end

    always @* begin
        assume (started_q ? who_i == who_q : rst_i);
        assume (|who_i && (who_i & under) == {CONTEXTS{1'b0}});
        assume (!(valid_q && valid_i) || (!take_q && mask_i == mask_q));
        assume (!take_i || (|mask_i ? may : known));
        assume (!take_i || !(stopped_q || stop_i || rst_i || start_i));
        assume (!(take_i && |mask_i && |sweep_q) || (mask_i & ~sweep_q) == {CONTEXTS{1'b0}}
                                                 || (sweep_q & ~mask_i) == {CONTEXTS{1'b0}}
                                                 || (mask_i & (mask_i + 1'b1)) == {CONTEXTS{1'b0}});
        assume (!start_i || (!busy && !valid_i && age_q >= GAP_W));
    end

    wire [W-1:0] least = first_q || total < before_q ? total : before_q;
    wire [W-1:0] pause = least >= GAP_W ? {W{1'b0}} : GAP_W - least;
    always @* if (started_q && !rst_i) begin
        assert (!(|(issue & who_i)) || age_q >= GAP_W);       // no context issues again too early
        assert (known == (valid_i && seen_q == 3'd5));
        if (valid_i && seen_q >= 3'd2) assert (count == total);
        // And none waits longer than the pause.
        if (!stopped_q) assert (may == (known && (busy ? over && pause == {W{1'b0}} : idle_q >= pause)));
    end

    (* hierconn *) wire [4:0]   \u_pace.age_q ;
    (* hierconn *) wire [W-1:0] \u_pace.low_q ;
    (* hierconn *) wire [W-1:0] \u_pace.high_q ;
    (* hierconn *) wire [W-1:0] \u_pace.least_q ;
    (* hierconn *) wire [W-1:0] \u_pace.pause_q ;
    (* hierconn *) wire [W-1:0] \u_pace.before_q ;
    (* hierconn *) wire [W-1:0] \u_pace.since_q ;
    (* hierconn *) wire         \u_pace.unpaused_q ;
    (* hierconn *) wire         \u_pace.rested_q ;
    wire [CONTEXTS-1:0] gone  = sweep_q & ~rest_q;            // of the sweep under way, or of the last one
    wire [CONTEXTS-1:0] after = gone & ~(|(sweep_q & who_i) ? under | who_i : {CONTEXTS{1'b0}});
    wire [W:0]          needs = ones(after) + ONE + (busy ? {W{1'b0}} : idle_q - ONE);
    generate
        if (LEMMAS != 0) begin : g_lemmas
            always @* if (started_q) begin
                assert ((stopped_q ? rest_q : rest_q & ~sweep_q) == {CONTEXTS{1'b0}});
                assert (stopped_q || !busy || gone < (rest_q & ~left));
                assert (stopped_q || !first_q || (sweep_q == {CONTEXTS{1'b0}} && idle_q == GAP_W && age_q == GAP_W));
                // Issues and idle cycles since who_i was issued
                if (!stopped_q) assert (|(rest_q & who_i) ? age_q + ones(rest_q & under) >= GAP_W
                                                          : age_q >= GAP_W || age_q >= needs);
                assert (age_q <= GAP_W && (stopped_q || idle_q <= GAP_W));
                // The registers of pace
                assert (seen_q <= 3'd5 && (valid_q || seen_q == 3'd0));
                assert (!valid_q || seen_q != 3'd0);
                assert (\u_pace.age_q == ~(5'h1f << seen_q));
                if (!stopped_q) assert ((first_q || \u_pace.before_q == before_q) && \u_pace.since_q == idle_q);
                if (valid_i) begin
                    if (seen_q >= 3'd1) assert (\u_pace.low_q == ones(mask_i & ~({CONTEXTS{1'b1}} << CONTEXTS / 2))
                                                && \u_pace.high_q == ones(mask_i >> CONTEXTS / 2));
                    if (seen_q >= 3'd2) assert (count == total);
                    // The first sweep has rested for any pause.
                    if (seen_q >= 3'd3 && !stopped_q && !first_q) assert (\u_pace.least_q == least);
                    if (seen_q >= 3'd4 && !stopped_q && !first_q)
                        assert (\u_pace.pause_q == pause && \u_pace.unpaused_q == (pause == {W{1'b0}}));
                    if (seen_q >= 3'd4) assert (\u_pace.pause_q <= GAP_W);
                    if (seen_q >= 3'd5 && !stopped_q) assert (\u_pace.rested_q == (idle_q >= pause));
                end
                assert (stopped_q || first_q || before_q == {W{1'b0}} || before_q == ones(sweep_q & LOW) + ones(sweep_q & ~LOW));
            end
        end
    endgenerate
endmodule
`default_nettype wire
