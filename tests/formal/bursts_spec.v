// bursts_spec: the promises of fp3_bursts.v, for each range, and however long the channel waits for room and for memory.
`default_nettype none
module bursts_spec #(
    parameter WORDS_W = 24,
    parameter LEMMAS  = 1
) (
    input wire               clk_i,
    input wire               rst_i,
    input wire               start_i, room_i, stop_i, ready_i,
    input wire [31:2]        address_i,
    input wire [WORDS_W-1:0] words_i
);
    wire        over, valid;
    wire [31:2] address;
    wire [7:0]  length;
    fp3_bursts #(.WORDS_W(WORDS_W)) u_bursts (.clk_i(clk_i), .rst_i(rst_i),
        .start_i(start_i), .address_i(address_i), .words_i(words_i), .room_i(room_i), .stop_i(stop_i), .over_o(over),
        .valid_o(valid), .ready_i(ready_i), .address_o(address), .length_o(length));

    // What of the range is still to be asked for
    reg  [31:2]        from_q;
    reg  [WORDS_W-1:0] left_q;
    wire [WORDS_W:0]   beats = length + 1'b1;
    wire               taken = valid && ready_i;
    wire               quits = stop_i && !valid && !start_i;

    // The cycle before
    reg        started_q = 1'b0, reset_q, held_q, stop_q, quits_q;
    reg [37:0] what_q;
    reg [1:0]  waits_q;                // cycles in which another burst may be asked for, and is not
    always @(posedge clk_i) begin
        {started_q, reset_q} <= {1'b1, rst_i};
        held_q  <= valid && !ready_i;
        stop_q  <= stop_i && !start_i && !rst_i;
        quits_q <= quits && !rst_i;
        what_q  <= {address, length};
        waits_q <= rst_i || start_i || valid || left_q == 0 || !room_i || stop_i ? 2'd0 : waits_q + 1'b1;
        if (rst_i)        left_q <= {WORDS_W{1'b0}};
        else if (start_i) {from_q, left_q} <= {address_i, words_i};
        else if (taken)   {from_q, left_q} <= {from_q + {{29-WORDS_W{1'b0}}, beats}, left_q - beats[WORDS_W-1:0]};
        else if (quits)   left_q <= {WORDS_W{1'b0}};
    end
    wire follows = started_q && !reset_q;

    always @* begin
        assume (started_q || rst_i);
        assume (!start_i || over);
        if (follows && stop_q && !over) assume (stop_i);          // it stays
    end

    always @* if (started_q) begin
        if (valid) begin                                          // the next words of the range, up to its end or that of 1 KB
            assert (address == from_q && beats <= {1'b0, left_q});
            assert ({1'b0, address[9:2]} + {1'b0, length} <= 9'd255);
            assert ({1'b0, address[9:2]} + {1'b0, length} == 9'd255 || beats == {1'b0, left_q});
        end
        if (follows && held_q) assert (valid && {address, length} == what_q);
        if (follows && stop_q && !held_q) assert (!valid);
        if (follows && quits_q) assert (over);
        if (reset_q) assert (!valid && over);
        assert (over == (!valid && left_q == 0));
        if (follows) assert (waits_q <= 2'd1);
    end

    (* hierconn *) wire [31:2]        \u_bursts.address_q ;
    (* hierconn *) wire [WORDS_W-1:0] \u_bursts.left_q ;
    generate
        if (LEMMAS != 0) begin : g_lemmas
            always @* if (started_q) begin
                assert (\u_bursts.left_q == left_q);
                if (left_q != 0) assert (\u_bursts.address_q == from_q);
                if (waits_q != 0) assert (valid);
            end
        end
    endgenerate
endmodule
`default_nettype wire
