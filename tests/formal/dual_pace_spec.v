// dual_pace_spec: the promises of fp3_dual_pace.v, for any sequence of sums, products, loads and stops that its header allows.
//
// A sweep of a sum or a product issues contexts 0, 1 .. size_i - 1, one in each cycle; what needs both units is swept by one of
// them while the other rests (other_i: by the multiplier). who_i is one context, chosen once: the promise is about its issues.
`default_nettype none
module dual_pace_spec #(
    parameter CONTEXTS = 24,
    parameter GAP      = 13,
    parameter LEMMAS   = 1
) (
    input wire clk_i,
    input wire rst_i,
    input wire start_i,
    input wire stop_i,                         // drops the sweeps under way and the next one
    input wire valid_i,
    input wire [$clog2(GAP+CONTEXTS+1)-1:0] size_i,
    input wire adds_i,
    input wire muls_i,
    input wire legal_i,
    input wire other_i,
    input wire take_i,
    input wire [$clog2(GAP+CONTEXTS+1)-1:0] who_i
);
    localparam W = $clog2(GAP + CONTEXTS + 1);
    localparam [W-1:0] GAP_W = GAP, ALL = CONTEXTS, ZERO = {W{1'b0}}, ONE = 1;
    localparam HALF = CONTEXTS / 2;
    localparam [W-1:0] HALF_W = HALF;

    // The sweeps under way: of sums at 0, of products at 1 --------------------------------------------
    reg          busy0_q, busy1_q, both_q;
    reg  [W-1:0] at0_q, at1_q, size0_q, size1_q;
    wire         over0 = busy0_q && at0_q + ONE == size0_q, over1 = busy1_q && at1_q + ONE == size1_q;
    wire         free0 = !busy0_q || over0, free1 = !busy1_q || over1;
    wire         issue0 = busy0_q && at0_q == who_i, issue1 = busy1_q && at1_q == who_i;
    wire         to1 = adds_i && muls_i ? other_i : muls_i;
    wire         known, may;
    wire [W-1:0] count;
    wire [CONTEXTS-1:0] mask = ~({CONTEXTS{1'b1}} << size_i);
    fp3_dual_pace #(.CONTEXTS(CONTEXTS), .GAP(GAP), .COUNT_W(W)) u_pace (.clk_i(clk_i), .rst_i(rst_i), .start_i(start_i),
        .valid_i(valid_i), .mask_i(mask), .adds_i(adds_i || both_q), .muls_i(muls_i || both_q), .legal_i(legal_i), .take_i(take_i),
        .known_o(known), .count_o(count), .may_o(may), .adder_i(free0), .multiplier_i(free1));

    reg          started_q = 1'b0, stopped_q, valid_q, take_q, adds_q, muls_q, legal_q;
    reg          last_q;                       // the sweep that began last is of products
    reg  [W-1:0] size_q, who_q;
    reg  [W-1:0] age_q;                        // cycles since who_i was issued, GAP at most
    reg  [W-1:0] since_q;                      // since the last sweep was taken, GAP at most
    reg  [2:0]   seen_q;                       // cycles that the mask has been there, 5 at most
    always @(posedge clk_i) begin
        {started_q, valid_q, take_q} <= {1'b1, valid_i && !rst_i, take_i && !rst_i};
        {size_q, who_q, adds_q, muls_q, legal_q} <= {size_i, who_i, adds_i, muls_i, legal_i};
        seen_q <= rst_i || !valid_i ? 3'd0 : seen_q == 3'd5 ? 3'd5 : seen_q + 3'd1;
        if (rst_i || stop_i) stopped_q <= 1'b1;
        else if (start_i)    stopped_q <= 1'b0;
        {busy0_q, busy1_q} <= {busy0_q && !over0, busy1_q && !over1};
        {at0_q, at1_q}     <= {at0_q + ONE, at1_q + ONE};
        if (take_i) {last_q, both_q} <= {to1, adds_i && muls_i};
        if (take_i && !to1) {busy0_q, at0_q, size0_q} <= {1'b1, ZERO, size_i};
        if (take_i && to1)  {busy1_q, at1_q, size1_q} <= {1'b1, ZERO, size_i};
        if (start_i) both_q <= 1'b0;
        if (rst_i || stop_i) {busy0_q, busy1_q} <= 2'b00;
        age_q   <= issue0 || issue1 ? ONE : age_q >= GAP_W ? GAP_W : age_q + ONE;
        since_q <= start_i ? GAP_W : take_i ? ONE : since_q >= GAP_W ? GAP_W : since_q + ONE;
    end

    always @* begin
        assume (started_q ? who_i == who_q : rst_i);
        assume (who_i < ALL && size_i != ZERO && size_i <= ALL && (adds_i || muls_i));
        assume (!(valid_q && valid_i) || (!take_q && size_i == size_q && adds_i == adds_q && muls_i == muls_q && legal_i == legal_q));
        assume (!take_i || may);
        assume (!take_i || !(stopped_q || stop_i || rst_i || start_i));
        assume (!start_i || (!busy0_q && !busy1_q && !valid_i && age_q >= GAP_W));
    end

    always @* if (started_q && !rst_i) begin
        assert (!(issue0 || issue1) || age_q >= GAP_W);       // no context issues again too early
        assert (!(issue0 && issue1));
        assert (!take_i || ((to1 || free0) && (!to1 || free1)));
        assert (known == (valid_i && seen_q == 3'd5));
        if (valid_i && seen_q >= 3'd2) assert (count == size_i);
        // And none waits longer.
        if (!stopped_q) assert (may == (known && legal_i && since_q >= GAP_W && (both_q ? free0 && free1 : (!adds_i || free0) && (!muls_i || free1))));
    end

    (* hierconn *) wire [4:0]   \u_pace.age_q ;
    (* hierconn *) wire [W-1:0] \u_pace.low_q ;
    (* hierconn *) wire [W-1:0] \u_pace.high_q ;
    (* hierconn *) wire [W-1:0] \u_pace.since_q ;
    (* hierconn *) wire         \u_pace.ready_q ;
    (* hierconn *) wire         \u_pace.adds_q ;
    (* hierconn *) wire         \u_pace.muls_q ;
    wire         young  = last_q ? busy1_q : busy0_q,   old    = last_q ? busy0_q : busy1_q;      // the sweep taken last, the other one
    wire [W-1:0] at     = last_q ? at1_q : at0_q,       before = last_q ? at0_q : at1_q;
    wire [W-1:0] size   = last_q ? size1_q : size0_q,   sized  = last_q ? size0_q : size1_q;
    wire         comes  = young && at <= who_i && who_i < size;
    wire         sooner = old && before <= who_i && who_i < sized;
    generate
        if (LEMMAS != 0) begin : g_lemmas
            always @* if (started_q) begin
                assert (!stopped_q || (!busy0_q && !busy1_q));
                assert ((!busy0_q || (at0_q < size0_q && size0_q <= ALL)) && (!busy1_q || (at1_q < size1_q && size1_q <= ALL)));
                assert (age_q <= GAP_W && (stopped_q || (since_q <= GAP_W && since_q != ZERO)));
                if (!stopped_q) begin
                    // The older sweep is GAP contexts ahead.
                    if (young) assert (at >= since_q - ONE && (since_q == GAP_W || at == since_q - ONE));
                    if (old)   assert ({1'b0, before} + 1'b1 >= {1'b0, since_q} + {1'b0, GAP_W});
                    if (young && old) assert ({1'b0, before} >= {1'b0, at} + {1'b0, GAP_W});
                    // Cycles from the last issue of who_i to its next one
                    if (sooner)              assert ({1'b0, age_q} + {1'b0, who_i} >= {1'b0, GAP_W} + {1'b0, before});
                    else if (comes)          assert ({1'b0, age_q} + {1'b0, who_i} >= {1'b0, GAP_W} + {1'b0, at});
                    else                     assert ({1'b0, age_q} + {1'b0, who_i} + 1'b1 >= {1'b0, since_q});
                end
                // The registers of dual_pace
                assert (seen_q <= 3'd5 && (valid_q || seen_q == 3'd0));
                assert (!valid_q || seen_q != 3'd0);
                assert (\u_pace.age_q == ~(5'h1f << seen_q));
                if (!stopped_q) assert (\u_pace.since_q == since_q);
                if (!stopped_q && valid_i) assert (\u_pace.ready_q == (seen_q == 3'd5 && legal_i && since_q == GAP_W));
                if (valid_i && seen_q != 3'd0) assert ({\u_pace.adds_q , \u_pace.muls_q } == {adds_i || both_q, muls_i || both_q});
                if (valid_i) begin
                    if (seen_q >= 3'd1) assert (\u_pace.low_q == (size_i <= HALF_W ? size_i : ZERO)
                                                && \u_pace.high_q == (size_i <= HALF_W ? ZERO : size_i));
                    if (seen_q >= 3'd2) assert (count == size_i);
                end
            end
        end
    endgenerate
endmodule
`default_nettype wire
