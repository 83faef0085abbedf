// arbiter_spec: the promises of fp3_arbiter.v, for requesters that do what its header asks of them.
//
// The order is kept as a queue: place 0 comes first, whose sweep ends goes to the end. DROPS = 1: a
// request may vanish, as when a run is stopped; the bound on refusals is then not promised.
`default_nettype none
module arbiter_spec #(
    parameter N        = 2,
    parameter PATIENCE = 127,
    parameter SWEEP    = 24,           // requests of a sweep at most
    parameter DROPS    = 0,
    parameter LEMMAS   = 1
) (
    input wire         clk_i,
    input wire         rst_i,
    input wire [N-1:0] adds_i,
    input wire [N-1:0] muls_i,
    input wire [N-1:0] sweep_end_i
);
    localparam BOUND = PATIENCE + 1 + (N - 1) * SWEEP;
    localparam P = $clog2(N + 1), W = $clog2(BOUND + 2), G = $clog2(SWEEP + 1);

    wire [N-1:0] grant;
    fp3_arbiter #(.N(N), .PATIENCE(PATIENCE)) u_arbiter (.clk_i(clk_i), .rst_i(rst_i),
        .adds_i(adds_i), .muls_i(muls_i), .sweep_end_i(sweep_end_i), .grant_o(grant));

    wire [N-1:0] needs   = adds_i | muls_i;
    wire [N-1:0] granted = needs & grant;
    wire [N-1:0] over    = granted & sweep_end_i;
    wire [N-1:0] stays   = needs & ~over;
    reg          started_q = 1'b0, reset_q;
    reg  [N-1:0] adds_q, muls_q, sweep_end_q, stays_q, granted_q;
    always @(posedge clk_i) begin
        {started_q, reset_q} <= {1'b1, rst_i};
        {adds_q, muls_q, sweep_end_q, stays_q, granted_q} <= {adds_i, muls_i, sweep_end_i, stays, granted};
    end

    // The queue, refusals in a row, and grants of the present sweep ------------------------------
    reg  [P*N-1:0] place_q, move;
    reg  [W*N-1:0] refused_q;
    reg  [G*N-1:0] done_q;
    reg  [N-1:0]   urgent_q;
    integer        i, j, k, s;
    always @* begin
        move = {P*N{1'b0}};            // places that are taken before this one
        for (i = 0; i < N; i = i + 1)
            for (j = 0; j < N; j = j + 1)
                if (i != j && (over[i] == over[j] ? place_q[P*j +: P] < place_q[P*i +: P] : over[i]))
                    move[P*i +: P] = move[P*i +: P] + 1'b1;
    end
    always @(posedge clk_i) begin
        place_q <= move;
        for (k = 0; k < N; k = k + 1) begin
            if (rst_i || granted[k]) refused_q[W*k +: W] <= {W{1'b0}};
            else if (needs[k])       refused_q[W*k +: W] <= refused_q[W*k +: W] + 1'b1;
            if (rst_i || over[k])    done_q[G*k +: G] <= {G{1'b0}};
            else if (granted[k])     done_q[G*k +: G] <= done_q[G*k +: G] + 1'b1;
            if (rst_i || over[k])    urgent_q[k] <= 1'b0;
            else if (needs[k] && !granted[k] && refused_q[W*k +: W] == PATIENCE - 1) urgent_q[k] <= 1'b1;
            if (rst_i)               place_q[P*k +: P] <= k;
        end
    end

    // What the requesters do: a request stays until the sweep's last one is granted ----------------
    reg [N-1:0] dropped;
    always @* begin
        assume (started_q || rst_i);
        dropped = {N{1'b0}};
        for (s = 0; s < N; s = s + 1) begin
            if (started_q && !reset_q && stays_q[s]) begin
                dropped[s] = !needs[s];
                assume (dropped[s] ? DROPS != 0
                                   : {adds_i[s], muls_i[s]} == {adds_q[s], muls_q[s]}
                                     && (granted_q[s] || sweep_end_i[s] == sweep_end_q[s]));
            end
            if (DROPS == 0 && done_q[G*s +: G] >= SWEEP - 1) assume (!needs[s] || sweep_end_i[s]);
        end
    end

    // Whose request comes before whose: those of the cycle before, which grant_o answers ------------
    reg  [N*N-1:0] first_q, first;     // N*a + b: b's comes before a's, and they need the same unit
    reg  [2*N-1:0] class;
    reg  [N-1:0]   expected;
    reg  [W+P-1:0] ahead;
    integer        a, b, x, y, u, v;
    always @* begin
        for (a = 0; a < N; a = a + 1) class[2*a +: 2] = urgent_q[a] ? 2'd0 : muls_i[a] ? 2'd1 : 2'd2;
        for (a = 0; a < N; a = a + 1)
            for (b = 0; b < N; b = b + 1)
                first[N*a + b] = a != b && |({adds_i[a], muls_i[a]} & {adds_i[b], muls_i[b]})
                              && (class[2*a +: 2] == class[2*b +: 2] ? place_q[P*b +: P] < place_q[P*a +: P]
                                                                     : class[2*b +: 2] < class[2*a +: 2]);
    end
    always @(posedge clk_i) first_q <= first;

    always @* begin
        for (x = 0; x < N; x = x + 1) expected[x] = stays_q[x] && !reset_q && !(|(first_q[N*x +: N] & granted));
        if (started_q) begin
            assert ((grant | needs) == {N{1'b1}});            // what needs nothing is granted
            for (x = 0; x < N; x = x + 1)
                for (y = 0; y < x; y = y + 1)                 // one for the adder, one for the multiplier
                    assert (!(granted[x] && granted[y] && ((adds_i[x] && adds_i[y]) || (muls_i[x] && muls_i[y]))));
            // Whoever asked, and is not over, is granted unless one that comes first takes a unit it needs.
            if (dropped == {N{1'b0}}) assert (granted == expected);
            else                      assert ((granted & ~stays_q) == {N{1'b0}});
            if (DROPS == 0)
                for (x = 0; x < N; x = x + 1) assert (refused_q[W*x +: W] <= BOUND);
        end
    end

    (* hierconn *) wire [N*N-1:0] \u_arbiter.before_q ;
    (* hierconn *) wire [8*N-1:0] \u_arbiter.waited_q ;
    generate
        if (LEMMAS != 0) begin : g_lemmas
            always @* if (started_q)
                for (u = 0; u < N; u = u + 1) begin
                    ahead = refused_q[W*u +: W];              // and what those ahead may still be granted
                    assert (place_q[P*u +: P] < N);
                    assert (\u_arbiter.waited_q [8*u +: 8] == (urgent_q[u] ? PATIENCE : refused_q[W*u +: W]));
                    assert (urgent_q[u] || refused_q[W*u +: W] < PATIENCE);
                    if (DROPS == 0) assert (done_q[G*u +: G] < SWEEP);
                    if (DROPS == 0 && !stays_q[u])            // between sweeps
                        assert (!urgent_q[u] && refused_q[W*u +: W] == 0 && done_q[G*u +: G] == 0);
                    for (v = 0; v < N; v = v + 1) begin
                        assert (u == v || place_q[P*u +: P] != place_q[P*v +: P]);
                        assert (\u_arbiter.before_q [N*u + v] == (place_q[P*v +: P] < place_q[P*u +: P]));
                        if (place_q[P*v +: P] < place_q[P*u +: P]) ahead = ahead + SWEEP - done_q[G*v +: G];
                    end
                    if (DROPS == 0) assert (ahead <= BOUND);
                end
        end
    endgenerate
endmodule
`default_nettype wire
