// axi_lite_spec: the promises of fp3_axi_lite.v, for a master that keeps to the rules of AXI, with as many transfers under way
// as it is let, and a host port that takes each request within PATIENCE cycles and answers within as many.
//
// Of each kind the spec keeps what was accepted and has no response yet, the oldest first. An address with its
// upper bit streams, any other is alone.
`default_nettype none
module axi_lite_spec #(
    parameter PATIENCE = 2,            // cycles until the host port takes a request, and until it answers
    parameter PLACES_W = 1,            // 2^PLACES_W places for responses of each kind
    parameter LEMMAS   = 1
) (
    input wire        clk_i,
    input wire        rst_i,
    input wire        awvalid_i, wvalid_i, arvalid_i, bready_i, rready_i,
    input wire [1:0]  awaddr_i, araddr_i,
    input wire [31:0] wdata_i,
    input wire [3:0]  wstrb_i,
    input wire        req_ready_i, wrote_i, write_error_i, read_i, read_error_i,
    input wire [31:0] rdata_i
);
    // Cycles in which nothing is under way, and none goes: until that is known, and for a write of some bytes.
    localparam BOUND = 3;
    localparam W = 3;
    localparam ADDRESS_W = 2;
    localparam N = 1 << PLACES_W;
    localparam T = N + 1;              // transfers of a kind at most: one waits for a place
    localparam C = $clog2(T + 1);      // counts them
    localparam [T-1:0] OLDEST = 1;

    wire        awready, wready, arready, bvalid, rvalid, req_valid, req_write;
    wire [1:0]  bresp, rresp, req_addr;
    wire [31:0] rdata, req_wdata;
    fp3_axi_lite #(.ADDRESS_W(ADDRESS_W), .STREAM(2), .WRITES_W(PLACES_W), .READS_W(PLACES_W)) u_axi (.clk_i(clk_i), .rst_i(rst_i),
        .s_axi_awvalid(awvalid_i), .s_axi_awready(awready), .s_axi_awaddr(awaddr_i),
        .s_axi_wvalid(wvalid_i), .s_axi_wready(wready), .s_axi_wdata(wdata_i), .s_axi_wstrb(wstrb_i),
        .s_axi_bvalid(bvalid), .s_axi_bready(bready_i), .s_axi_bresp(bresp),
        .s_axi_arvalid(arvalid_i), .s_axi_arready(arready), .s_axi_araddr(araddr_i),
        .s_axi_rvalid(rvalid), .s_axi_rready(rready_i), .s_axi_rdata(rdata), .s_axi_rresp(rresp),
        .req_valid_o(req_valid), .req_ready_i(req_ready_i), .req_write_o(req_write), .req_addr_o(req_addr),
        .req_wdata_o(req_wdata), .wrote_i(wrote_i), .write_error_i(write_error_i), .read_i(read_i),
        .read_error_i(read_error_i), .rdata_i(rdata_i));

    wire aw = awvalid_i && awready, w = wvalid_i && wready, ar = arvalid_i && arready;
    wire b = bvalid && bready_i, r = rvalid && rready_i;
    wire taken = req_valid && req_ready_i;

    // The cycle before
    reg        started_q = 1'b0, reset_q;
    reg        aw_held_q, w_held_q, ar_held_q, b_held_q, r_held_q;
    reg [1:0]  awaddr_q, araddr_q;
    reg [35:0] w_q;
    reg [1:0]  bresp_q;
    reg [33:0] r_q;
    always @(posedge clk_i) begin
        {started_q, reset_q} <= {1'b1, rst_i};
        aw_held_q <= awvalid_i && !awready;
        w_held_q  <= wvalid_i && !wready;
        ar_held_q <= arvalid_i && !arready;
        b_held_q  <= bvalid && !bready_i;
        r_held_q  <= rvalid && !rready_i;
        {awaddr_q, araddr_q, w_q} <= {awaddr_i, araddr_i, wstrb_i, wdata_i};
        {bresp_q, r_q}            <= {bresp, rresp, rdata};
    end
    wire follows = started_q && !reset_q;

    // Transfers without a response, at most T of a kind: place 0 has the oldest. -------------------------------
    reg [C-1:0] aws_q, ws_q, ars_q;
    reg [1:0]   to_q [0:T-1], from_q [0:T-1];
    reg [35:0]  write_q [0:T-1];                           // strobes and data
    reg [T-1:0] w_asked_q, w_answered_q, w_error_q, r_asked_q, r_answered_q;
    reg [32:0]  r_value_q [0:T-1];
    reg [W-1:0] refused_q, w_thinks_q, r_thinks_q, write_stalls_q, read_stalls_q;
    wire [T-1:0] whole, written, reading, w_streams, r_streams, lone;
    genvar t;
    generate
        for (t = 0; t < T; t = t + 1) begin : g_transfer
            assign whole[t]     = &write_q[t][35:32];
            assign written[t]   = ws_q > t && aws_q > t;
            assign reading[t]   = ars_q > t;
            assign w_streams[t] = to_q[t][1];
            assign r_streams[t] = from_q[t][1];
            assign lone[t]      = (aws_q > t && !w_streams[t]) || (ws_q > t && !whole[t]) || (ars_q > t && !r_streams[t]);
        end
    endgenerate
    // Which is the next to be asked, and the next to be answered: the oldest that is not yet
    wire [T-1:0] w_free = written & whole & ~w_asked_q, w_next = w_free & (~w_free + OLDEST);
    wire [T-1:0] w_due  = w_asked_q & ~w_answered_q,    w_first = w_due & (~w_due + OLDEST);
    wire [T-1:0] r_free = reading & ~r_asked_q,         r_next = r_free & (~r_free + OLDEST);
    wire [T-1:0] r_due  = r_asked_q & ~r_answered_q,    r_first = r_due & (~r_due + OLDEST);
    wire alone = |(w_due & ~w_streams) || |(r_due & ~r_streams);             // is not yet answered
    // How long all that is there streams; whether fewer than all places but one are taken, and were
    reg  [1:0]  calm_q;
    reg  [C-1:0] w_places, r_places;
    reg         w_few_q, r_few_q;
    integer     p;
    always @* begin
        {w_places, r_places} = {2*C{1'b0}};
        for (p = 0; p < T; p = p + 1) {w_places, r_places} = {w_places + w_asked_q[p], r_places + r_asked_q[p]};
    end
    wire w_few = w_places < N - 1, r_few = r_places < N - 1;
    always @(posedge clk_i) begin
        calm_q <= rst_i || lone != 0 ? 2'd0 : calm_q == 2'd3 ? 2'd3 : calm_q + 2'd1;
        {w_few_q, r_few_q} <= {w_few, r_few};
    end
    reg        rest_q;                                                        // was, in the last cycle
    reg        last_q, read_waited_q, write_waited_q, unseen_q;                     // the last request taken was a write
    always @(posedge clk_i) begin
        if (rst_i)      last_q <= 1'b0;
        else if (taken) last_q <= req_write;
        // A write of some bytes has its turn, too, but nobody sees when.
        unseen_q       <= !rst_i && (|(written & ~whole) || (unseen_q && !taken));
        read_waited_q  <= !rst_i && r_free != 0 && r_asked_q == 0;
        write_waited_q <= !rst_i && written[0] && whole[0] && w_asked_q == 0;
    end
    wire [C-1:0] aws_left = aws_q - b, ws_left = ws_q - b, ars_left = ars_q - r;
    wire [T-1:0] w_asked_d = w_asked_q | (w_next & {T{taken && req_write}});
    wire [T-1:0] w_answered_d = w_answered_q | (w_first & {T{wrote_i}});
    wire [T-1:0] w_error_d = (w_error_q & ~w_first) | (w_first & {T{wrote_i && write_error_i}}) | (w_error_q & {T{!wrote_i}});
    wire [T-1:0] r_asked_d = r_asked_q | (r_next & {T{taken && !req_write}});
    wire [T-1:0] r_answered_d = r_answered_q | (r_first & {T{read_i}});
    wire still = w_due == 0 && r_due == 0 && !req_valid;
    integer k;
    always @(posedge clk_i) begin
        if (rst_i) begin
            {aws_q, ws_q, ars_q, rest_q} <= {3*C+1{1'b0}};
            {w_asked_q, w_answered_q, r_asked_q, r_answered_q} <= {4*T{1'b0}};
            {refused_q, w_thinks_q, r_thinks_q, write_stalls_q, read_stalls_q} <= {5*W{1'b0}};
        end else begin
            aws_q  <= aws_left + aw;
            ws_q   <= ws_left + w;
            ars_q  <= ars_left + ar;
            rest_q <= alone;
            {w_asked_q, w_answered_q} <= {w_asked_d >> b, w_answered_d >> b};
            {r_asked_q, r_answered_q} <= {r_asked_d >> r, r_answered_d >> r};
            refused_q     <= req_valid && !req_ready_i ? refused_q + 1'b1 : {W{1'b0}};
            w_thinks_q    <= w_due != 0 && !wrote_i ? w_thinks_q + 1'b1 : {W{1'b0}};
            r_thinks_q    <= r_due != 0 && !read_i  ? r_thinks_q + 1'b1 : {W{1'b0}};
            write_stalls_q <= still && written[0] && w_asked_q == 0 && !bvalid ? write_stalls_q + 1'b1 : {W{1'b0}};
            read_stalls_q  <= still && reading[0] && r_asked_q == 0 ? read_stalls_q + 1'b1 : {W{1'b0}};
        end
        w_error_q <= w_error_d >> b;
        for (k = 0; k < T; k = k + 1) begin
            if (aw && aws_left == k)  to_q[k] <= awaddr_i;
            else if (b && k < T - 1)  to_q[k] <= to_q[k < T - 1 ? k + 1 : k];
            if (w && ws_left == k)    write_q[k] <= {wstrb_i, wdata_i};
            else if (b && k < T - 1)  write_q[k] <= write_q[k < T - 1 ? k + 1 : k];
            if (ar && ars_left == k)  from_q[k] <= araddr_i;
            else if (r && k < T - 1)  from_q[k] <= from_q[k < T - 1 ? k + 1 : k];
            if (read_i && r_first == OLDEST << (k + r))      r_value_q[k] <= {read_error_i, rdata_i};
            else if (r && k < T - 1)  r_value_q[k] <= r_value_q[k < T - 1 ? k + 1 : k];
        end
    end

    // What the master and the host port do ------------------------------------------------------------
    always @* begin
        assume (started_q || rst_i);
        if (follows) begin
            if (aw_held_q) assume (awvalid_i && awaddr_i == awaddr_q);
            if (w_held_q)  assume (wvalid_i && {wstrb_i, wdata_i} == w_q);
            if (ar_held_q) assume (arvalid_i && araddr_i == araddr_q);
            assume (!wrote_i || w_due != 0);
            assume (!read_i || r_due != 0);
            assume (refused_q < PATIENCE || req_ready_i || !req_valid);
            assume (w_due == 0 || w_thinks_q < PATIENCE || wrote_i);
            assume (r_due == 0 || r_thinks_q < PATIENCE || read_i);
        end else begin
            assume (!wrote_i && !read_i);
        end
    end

    // The promises -------------------------------------------------------------------------------------
    reg [1:0]  next_to, next_from;
    reg [31:0] next_word;
    integer    m;
    always @* begin
        {next_to, next_from, next_word} = 36'd0;
        for (m = 0; m < T; m = m + 1) begin
            if (w_next[m]) {next_to, next_word} = {to_q[m], write_q[m][31:0]};
            if (r_next[m]) next_from = from_q[m];
        end
    end
    always @* if (follows) begin
        assert (aws_q < T || !aw || b);                           // so much for the T places
        assert (ws_q < T || !w || b);
        assert (ars_q < T || !ar || r);
        if (b_held_q) assert (bvalid && bresp == bresp_q);        // responses stand until they are taken
        if (r_held_q) assert (rvalid && {rresp, rdata} == r_q);
        if (req_valid && req_write)                               // a request is the oldest transfer of its kind
            assert (w_free != 0 && req_addr == next_to && req_wdata == next_word);
        if (req_valid && !req_write)
            assert (r_free != 0 && req_addr == next_from);
        if (req_valid) begin                                      // alone: none before it is due; then a rest
            assert (req_addr[1] || (w_due == 0 && r_due == 0));
            assert (!alone && !rest_q);
        end
        // They take turns: not twice the same kind, where the other one had waited and had nothing under way
        if (req_valid && req_write == last_q && !unseen_q && !(|(written & ~whole))) assert (!(last_q ? r_free != 0 && read_waited_q : w_free != 0 && write_waited_q));
        // What streams goes while there are places, up to one request in each cycle
        if (calm_q == 2'd3 && lone == 0 && ((w_free != 0 && w_few && w_few_q) || (r_free != 0 && r_few && r_few_q))) assert (req_valid);
        if (bvalid)                                               // one response for each, and the right one
            assert (written[0] && (whole[0] ? w_answered_q[0] && bresp == {w_error_q[0], 1'b0} : bresp == {|write_q[0][35:32], 1'b0}));
        if (rvalid)
            assert (reading[0] && r_answered_q[0] && {rresp, rdata} == {r_value_q[0][32], 1'b0, r_value_q[0][31:0]});
        // No hang, whatever response is not taken: what is answered stands at once, and what waits goes when nothing is
        // under way, if it is not held up by responses of its own kind.
        if (written[0] && w_answered_q[0]) assert (bvalid);
        if (reading[0] && r_answered_q[0]) assert (rvalid);
        assert (write_stalls_q <= BOUND && read_stalls_q <= BOUND);
    end
    always @* if (started_q && reset_q) assert (!bvalid && !rvalid && !req_valid);

    // The registers: gone, filled and taken count in a bit more than a place's number has.
    (* hierconn *) wire \u_axi.aw_q , \u_axi.w_q , \u_axi.ar_q , \u_axi.idle_q , \u_axi.alone_q , \u_axi.write_q ;
    (* hierconn *) wire [1:0] \u_axi.awaddr_q , \u_axi.araddr_q ;
    (* hierconn *) wire [31:0] \u_axi.wdata_q ;
    (* hierconn *) wire [3:0]  \u_axi.wstrb_q ;
    (* hierconn *) wire \u_axi.u_writes.room_q , \u_axi.u_reads.room_q ;
    (* hierconn *) wire [PLACES_W:0] \u_axi.u_writes.gone_q , \u_axi.u_writes.filled_q , \u_axi.u_writes.taken_q ;
    (* hierconn *) wire [PLACES_W:0] \u_axi.u_reads.gone_q , \u_axi.u_reads.filled_q , \u_axi.u_reads.taken_q ;
    (* hierconn *) wire [N-1:0]    \u_axi.u_writes.values ;
    (* hierconn *) wire [33*N-1:0] \u_axi.u_reads.values ;
    wire [PLACES_W:0] w_kept = \u_axi.u_writes.gone_q - \u_axi.u_writes.taken_q ;
    wire [PLACES_W:0] w_full = \u_axi.u_writes.filled_q - \u_axi.u_writes.taken_q ;
    wire [PLACES_W:0] r_kept = \u_axi.u_reads.gone_q - \u_axi.u_reads.taken_q ;
    wire [PLACES_W:0] r_full = \u_axi.u_reads.filled_q - \u_axi.u_reads.taken_q ;
    // The oldest place first
    wire [N-1:0]    w_values = {2{\u_axi.u_writes.values }} >> \u_axi.u_writes.taken_q [PLACES_W-1:0];
    wire [33*N-1:0] r_values = {2{\u_axi.u_reads.values }} >> 33 * \u_axi.u_reads.taken_q [PLACES_W-1:0];
    generate
        if (LEMMAS != 0) begin : g_lemmas
            integer n;
            always @* if (follows) begin
                assert (w_kept <= N && w_full <= w_kept && (!\u_axi.u_writes.room_q || w_kept < N));
                assert (r_kept <= N && r_full <= r_kept && (!\u_axi.u_reads.room_q || r_kept < N));
                assert (aws_q == \u_axi.aw_q + w_kept && ws_q == \u_axi.w_q + w_kept && ars_q == \u_axi.ar_q + r_kept);
                for (n = 0; n < T; n = n + 1) begin
                    assert (w_asked_q[n] == (n < w_kept && whole[n]));
                    assert (w_answered_q[n] == (n < w_full && whole[n]));
                    assert (!(n < w_kept && n >= w_full) || whole[n]);
                    assert (r_asked_q[n] == (n < r_kept));
                    assert (r_answered_q[n] == (n < r_full));
                    if (n < N && n < w_full) assert (w_values[n] == (whole[n] ? w_error_q[n] : |write_q[n][35:32]));
                    if (n < N && n < r_full) assert (r_values[33*n +: 33] == r_value_q[n]);
                    if (n == w_kept && \u_axi.aw_q ) assert (\u_axi.awaddr_q == to_q[n]);
                    if (n == w_kept && \u_axi.w_q )  assert ({\u_axi.wstrb_q , \u_axi.wdata_q } == write_q[n]);
                    if (n == r_kept && \u_axi.ar_q ) assert (\u_axi.araddr_q == from_q[n]);
                end
                assert (\u_axi.write_q == last_q || unseen_q);
                if (\u_axi.idle_q ) assert (w_due == 0 && r_due == 0 && !rest_q);
                if (alone) assert (\u_axi.alone_q && (w_kept - w_full) + (r_kept - r_full) == 1);
                if (\u_axi.alone_q && (w_due != 0 || r_due != 0)) assert (alone);
                if (rest_q) assert (\u_axi.alone_q || \u_axi.idle_q );
                assert (refused_q <= PATIENCE && w_thinks_q <= PATIENCE && r_thinks_q <= PATIENCE);
            end
        end
    endgenerate
endmodule
`default_nettype wire
