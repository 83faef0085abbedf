// turns_spec: the promises of fp3_turns.v, for a host and a transfer that ask for what they like when they like, and a hub that answers
// reads and writes in an order of their own, as fp3_hub.v does: both at once, perhaps.
`default_nettype none
module turns_spec #(
    parameter TURN   = 64,
    parameter REST   = 4,
    parameter LEMMAS = 1
) (
    input wire       clk_i,
    input wire       rst_i,
    input wire       host_valid_i, host_write_i, move_valid_i, move_streams_i, move_write_i,
    input wire [1:0] host_what_i, move_what_i,
    input wire       req_ready_i, wrote_i, read_i
);
    // Cycles that who asks waits while nothing is under way: a rest, a turn's change, and back if the other one asks no more
    localparam BOUND  = REST + 3;
    localparam OPEN_W = 6, W = 8;
    localparam [OPEN_W-1:0] MOST = {OPEN_W{1'b1}};
    localparam [W-1:0] TURN_R = TURN, REST_R = REST;

    wire              host_ready, move_ready, moves, req_valid, req_write;
    wire [1:0]        req_what;
    wire [OPEN_W-1:0] open;
    fp3_turns #(.W(2), .TURN(TURN), .REST(REST), .OPEN_W(OPEN_W)) u_turns (.clk_i(clk_i), .rst_i(rst_i),
        .host_valid_i(host_valid_i), .host_ready_o(host_ready), .host_write_i(host_write_i), .host_what_i(host_what_i),
        .move_valid_i(move_valid_i), .move_ready_o(move_ready), .move_streams_i(move_streams_i), .move_write_i(move_write_i),
        .move_what_i(move_what_i), .moves_o(moves), .open_o(open),
        .req_valid_o(req_valid), .req_ready_i(req_ready_i), .req_write_o(req_write), .req_what_o(req_what),
        .wrote_i(wrote_i), .read_i(read_i));
    wire host = host_valid_i && host_ready, move = move_valid_i && move_ready, taken = req_valid && req_ready_i;

    // Requests under way: writes and reads of the host, and of the transfer
    reg [OPEN_W-1:0] hw_q, hr_q, mw_q, mr_q;
    wire             hosts  = hw_q != 0 || hr_q != 0, theirs = mw_q != 0 || mr_q != 0;
    wire [OPEN_W:0]  total  = hw_q + hr_q + mw_q + mr_q;
    reg              started_q = 1'b0, reset_q;
    reg              lone_q;                               // what is under way is alone
    reg              last_q;                               // the last request was the transfer's
    reg [W-1:0]      rest_q, lone_rest_q;                  // cycles until REST are over since an answer; since one to what was alone
    reg [W-1:0]      host_passed_q, move_passed_q;         // requests of the other one, since this one has asked
    reg [3:0]        host_waits_q, move_waits_q;           // cycles with nothing under way, since this one has asked
    wire             calm   = total == 0 && !req_valid;
    always @(posedge clk_i) begin
        {started_q, reset_q} <= {1'b1, rst_i};
        if (rst_i) begin
            {hw_q, hr_q, mw_q, mr_q} <= {4*OPEN_W{1'b0}};
            {lone_q, last_q}         <= 2'b00;
            {rest_q, lone_rest_q, host_passed_q, move_passed_q} <= {4*W{1'b0}};
            {host_waits_q, move_waits_q} <= 8'd0;
        end else begin
            hw_q <= hw_q + (host && host_write_i)  - (wrote_i && hw_q != 0);
            hr_q <= hr_q + (host && !host_write_i) - (read_i && hr_q != 0);
            mw_q <= mw_q + (move && move_write_i)  - (wrote_i && mw_q != 0);
            mr_q <= mr_q + (move && !move_write_i) - (read_i && mr_q != 0);
            if (taken) last_q <= move;
            lone_q        <= (move && !move_streams_i) || (lone_q && !wrote_i && !read_i);
            rest_q        <= wrote_i || read_i ? REST_R : rest_q == 0 ? rest_q : rest_q - 1'b1;
            lone_rest_q   <= lone_q && (wrote_i || read_i) ? REST_R : lone_rest_q == 0 ? lone_rest_q : lone_rest_q - 1'b1;
            host_passed_q <= !host_valid_i || host ? {W{1'b0}} : host_passed_q + move;
            move_passed_q <= !move_valid_i || move ? {W{1'b0}} : move_passed_q + host;
            host_waits_q  <= host_valid_i && calm ? host_waits_q + 1'b1 : 4'd0;
            move_waits_q  <= move_valid_i && calm ? move_waits_q + 1'b1 : 4'd0;
        end
    end

    always @* begin
        assume (started_q || rst_i);
        assume (!wrote_i || (started_q && (hw_q != 0 || mw_q != 0)));
        assume (!read_i || (started_q && (hr_q != 0 || mr_q != 0)));
        assume (!req_ready_i || total < {1'b0, MOST});
    end

    always @* if (started_q) begin
        assert (!hosts || !theirs);                               // of one alone, and its answers are
        if (hosts)  assert (!moves);
        if (theirs) assert (moves);
        assert ({1'b0, open} == total);
        // Who is taken goes to the hub, as it asked
        assert (!(host_ready && !host_valid_i) && !(move_ready && !move_valid_i) && !(host && move));
        assert (taken == (host || move));
        if (req_valid) assert (moves ? move_valid_i && {req_write, req_what} == {move_write_i, move_what_i}
                                     : host_valid_i && {req_write, req_what} == {host_write_i, host_what_i});
        if (host) assert (!moves);
        // Alone
        if (move && !move_streams_i)       assert (total == 0);
        if (lone_q || lone_rest_q != 0)    assert (!taken);
        if (last_q != moves)               assert (rest_q == 0 && total == 0);      // a change of turns
        // Both get their turn
        assert (host_passed_q <= TURN_R && move_passed_q <= TURN_R);
        assert (host_waits_q <= BOUND && move_waits_q <= BOUND);
        if (reset_q) assert (!moves && open == 0);
    end

    localparam TURN_W = $clog2(TURN);
    (* hierconn *) wire              \u_turns.alone_q , \u_turns.wants_q ;
    (* hierconn *) wire [TURN_W:0]   \u_turns.made_q ;
    (* hierconn *) wire [2:0]        \u_turns.rest_q ;
    wire [W-1:0] made = \u_turns.made_q ;
    generate
        if (LEMMAS != 0) begin : g_lemmas
            always @* if (started_q) begin
                assert (\u_turns.rest_q == rest_q && rest_q <= REST_R && lone_rest_q <= rest_q);
                assert (lone_rest_q == 0 || lone_rest_q == rest_q);
                assert (made <= TURN_R);
                assert (!\u_turns.alone_q || (moves && (total == 0 || lone_q)));
                assert (!lone_q || (\u_turns.alone_q && moves && total == 1));
                assert (lone_rest_q == 0 || (\u_turns.alone_q && moves));
                assert (host_passed_q <= (moves ? made : {W{1'b0}}) || (!moves && made == 0));
                assert (move_passed_q <= (moves ? {W{1'b0}} : made) || (moves && made == 0));
                assert (last_q == moves || made == 0);
                if (made != 0 && (moves ? host_passed_q : move_passed_q) != 0) assert (\u_turns.wants_q );
                // Cycles that are left until who waits may ask
                assert (host_waits_q + (moves ? rest_q + \u_turns.alone_q + 1 : made == TURN_R && \u_turns.wants_q ? rest_q + 2 : 0) <= BOUND);
                assert (move_waits_q + (moves ? rest_q + \u_turns.alone_q + (made == TURN_R && (\u_turns.wants_q || rest_q != 0 || \u_turns.alone_q ) ? 2 : 0) : rest_q + 1) <= BOUND);
            end
        end
    endgenerate
endmodule
`default_nettype wire
