// transact_spec: the promises of fp3_transact.v, for requests as request_rx makes them and a slave that keeps to the rules
// of AXI and takes and answers a transfer within PATIENCE cycles.
//
// The spec keeps the request, how many of its words have a response, and one word of the store: of any number,
// chosen once (one_word.v).
`default_nettype none
module transact_spec #(
    parameter ADDRESS_W = 8,
    parameter PATIENCE  = 2,
    parameter LEMMAS    = 1
) (
    input wire        clk_i,
    input wire        rst_i,
    input wire        request_i, write_i, store_i, done_i,
    input wire [7:0]  sequence_i,
    input wire [5:0]  last_i, store_at_i, word_at_i,
    input wire [31:0] address_i, store_word_i,
    input wire        awready_i, wready_i, arready_i, bvalid_i, rvalid_i,
    input wire [1:0]  bresp_i, rresp_i,
    input wire [31:0] rdata_i
);
    // Without a response: a cycle in the store, then the slower of address and data, then the response.
    localparam BOUND = 2 * PATIENCE + 2;
    localparam W = 6;

    wire                 idle, answer, awvalid, wvalid, arvalid, bready, rready;
    wire [7:0]           sequence, status;
    wire [6:0]           words;
    wire [31:0]          word, wdata;
    wire [ADDRESS_W-1:0] awaddr, araddr;
    wire [2:0]           awprot, arprot;
    wire [3:0]           wstrb;
    fp3_transact #(.ADDRESS_W(ADDRESS_W)) u_transact (.clk_i(clk_i), .rst_i(rst_i), .idle_o(idle), .request_i(request_i),
        .sequence_i(sequence_i), .write_i(write_i), .last_i(last_i), .address_i(address_i), .store_i(store_i),
        .store_at_i(store_at_i), .store_word_i(store_word_i), .answer_o(answer), .done_i(done_i), .sequence_o(sequence),
        .status_o(status), .words_o(words), .word_at_i(word_at_i), .word_o(word),
        .m_axi_awaddr(awaddr), .m_axi_awprot(awprot), .m_axi_awvalid(awvalid), .m_axi_awready(awready_i),
        .m_axi_wdata(wdata), .m_axi_wstrb(wstrb), .m_axi_wvalid(wvalid), .m_axi_wready(wready_i),
        .m_axi_bresp(bresp_i), .m_axi_bvalid(bvalid_i), .m_axi_bready(bready),
        .m_axi_araddr(araddr), .m_axi_arprot(arprot), .m_axi_arvalid(arvalid), .m_axi_arready(arready_i),
        .m_axi_rdata(rdata_i), .m_axi_rresp(rresp_i), .m_axi_rvalid(rvalid_i), .m_axi_rready(rready));
    (* hierconn *) wire [5:0] \u_transact.u_store.which ;
    wire [5:0] which = \u_transact.u_store.which ;

    wire aw = awvalid && awready_i, w = wvalid && wready_i, ar = arvalid && arready_i;
    wire b = bvalid_i && bready, r = rvalid_i && rready;

    // The cycle before
    reg                     started_q = 1'b0, reset_q, looks_q;
    reg                     aw_held_q, w_held_q, ar_held_q, b_held_q, r_held_q;
    reg [46:0]              request_q;
    reg [2*ADDRESS_W+5:0]   addresses_q;
    reg [35:0]              w_q;
    reg [1:0]               b_q;
    reg [33:0]              r_q;
    always @(posedge clk_i) begin
        {started_q, reset_q} <= {1'b1, rst_i};
        aw_held_q   <= awvalid && !awready_i;
        w_held_q    <= wvalid && !wready_i;
        ar_held_q   <= arvalid && !arready_i;
        b_held_q    <= bvalid_i && !bready;
        r_held_q    <= rvalid_i && !rready;
        looks_q     <= answer && word_at_i == which;
        request_q   <= {sequence_i, write_i, last_i, address_i};
        addresses_q <= {awaddr, awprot, araddr, arprot};
        w_q         <= {wstrb, wdata};
        {b_q, r_q}  <= {bresp_i, rresp_i, rdata_i};
    end
    wire follows = started_q && !reset_q;

    // The request that is carried out or answered ----------------------------------------------------------
    reg        busy_q, over_q;
    reg        write_q;
    reg [7:0]  sequence_q;
    reg [5:0]  last_q;
    reg [31:0] address_q;
    reg [6:0]  count_q;                // words that have their response
    reg [6:0]  status_q;
    reg        kept_q;                 // the request before was a write
    reg        aw_done_q, w_done_q, ar_done_q;
    reg        known_q;                // the one word of the store has been written since reset ...
    reg [31:0] word_q;                 // ... and is this
    reg [W-1:0] aw_waits_q, w_waits_q, ar_waits_q, thinks_q, since_q;
    wire [31:0] at      = address_q + {23'd0, count_q, 2'b00};
    wire        outside = busy_q && !over_q && |at[31:ADDRESS_W];
    wire        over    = over_q || outside;
    wire [6:0]  number  = count_q + 7'd1;
    wire [6:0]  fault   = outside ? number : status_q;
    wire        again   = kept_q && write_i && sequence_i == sequence_q;
    wire        other   = !known_q || count_q[5:0] != which;
    wire        fails   = b && bresp_i[1] || r && rresp_i[1];
    always @(posedge clk_i) begin
        if (rst_i) begin
            {busy_q, over_q, kept_q, aw_done_q, w_done_q, ar_done_q} <= 6'd0;
            {aw_waits_q, w_waits_q, ar_waits_q, thinks_q, since_q}   <= {5*W{1'b0}};
        end else begin
            if (!busy_q && request_i) begin
                {busy_q, over_q, write_q} <= {1'b1, again, write_i};       // the write before: nothing to do
                if (!again) begin
                    {sequence_q, last_q, address_q, kept_q} <= {sequence_i, last_i, address_i, write_i};
                    {count_q, status_q} <= 14'd0;
                end
            end
            if (outside) {over_q, status_q} <= {1'b1, number};
            if (b || r) begin
                count_q <= number;
                over_q  <= fails || count_q == {1'b0, last_q};
                if (fails) status_q <= number;
            end
            if (answer && done_i) busy_q <= 1'b0;
            aw_done_q  <= (aw_done_q || aw) && !b;
            w_done_q   <= (w_done_q || w) && !b;
            ar_done_q  <= (ar_done_q || ar) && !r;
            aw_waits_q <= awvalid && !aw ? aw_waits_q + 1'b1 : {W{1'b0}};
            w_waits_q  <= wvalid && !w ? w_waits_q + 1'b1 : {W{1'b0}};
            ar_waits_q <= arvalid && !ar ? ar_waits_q + 1'b1 : {W{1'b0}};
            thinks_q   <= (aw_done_q && w_done_q && !b) || (ar_done_q && !r) ? thinks_q + 1'b1 : {W{1'b0}};
            since_q    <= idle || answer || outside || b || r ? {W{1'b0}} : since_q + 1'b1;
        end
        if (rst_i) known_q <= 1'b0;
        else if (store_i && store_at_i == which)  {known_q, word_q} <= {1'b1, store_word_i};
        else if (r && count_q[5:0] == which)      {known_q, word_q} <= {1'b1, rdata_i};
    end

    // What the line and the slave do -----------------------------------------------------------------------
    always @* begin
        assume (started_q || rst_i);
        assume (idle || !(request_i || store_i));
        if (follows) begin
            if (busy_q)   assume ({sequence_i, write_i, last_i, address_i} == request_q);     // until done_i
            if (b_held_q) assume (bvalid_i && bresp_i == b_q);
            if (r_held_q) assume (rvalid_i && {rresp_i, rdata_i} == r_q);
        end
        assume (!bvalid_i || ((aw_done_q || aw) && (w_done_q || w)));
        assume (!rvalid_i || ar_done_q || ar);
        assume (aw_waits_q < PATIENCE || awready_i || !awvalid);
        assume (w_waits_q < PATIENCE || wready_i || !wvalid);
        assume (ar_waits_q < PATIENCE || arready_i || !arvalid);
        assume (thinks_q < PATIENCE || (ar_done_q ? rvalid_i : bvalid_i) || !(ar_done_q || (aw_done_q && w_done_q)));
    end

    // The promises -----------------------------------------------------------------------------------------
    always @* if (follows) begin
        if (aw_held_q) assert (awvalid && {awaddr, awprot} == addresses_q[ADDRESS_W+3 +: ADDRESS_W+3]);
        if (w_held_q)  assert (wvalid && wstrb == w_q[35:32] && (wdata == w_q[31:0] || other));
        if (ar_held_q) assert (arvalid && {araddr, arprot} == addresses_q[ADDRESS_W+2:0]);
        if (bvalid_i)  assert (bready);                    // each response is taken, and at once
        if (rvalid_i)  assert (rready);
        // One transfer at a time: the next word of the request, to or from its address.
        if (awvalid) assert (busy_q && !over && write_q && !aw_done_q && awaddr == at[ADDRESS_W-1:0] && awprot == 3'd0);
        if (wvalid)  assert (busy_q && !over && write_q && !w_done_q && wstrb == 4'b1111
                             && (wdata == word_q || other));
        if (arvalid) assert (busy_q && !over && !write_q && !ar_done_q && araddr == at[ADDRESS_W-1:0] && arprot == 3'd0);
        // Nothing is answered before it is done, and then as it went.
        if (answer) begin
            assert (busy_q && over && !aw_done_q && !w_done_q && !ar_done_q && sequence == sequence_q && status == {1'b0, fault});
            assert (words == (write_q ? 7'd0 : fault != 7'd0 ? fault - 7'd1 : {1'b0, last_q} + 7'd1));
            if (looks_q && known_q && {1'b0, which} < words) assert (word == word_q);
        end
        assert (since_q <= BOUND);                         // no hang
    end
    always @* if (started_q) begin
        assert (idle == !busy_q);
        if (reset_q) assert (idle && !answer && !awvalid && !wvalid && !arvalid);
    end

    (* hierconn *) wire        \u_transact.aw_q , \u_transact.w_q , \u_transact.ar_q , \u_transact.kept_q , \u_transact.u_store.it_q ;
    (* hierconn *) wire [1:0]  \u_transact.state_q ;
    (* hierconn *) wire [5:0]  \u_transact.word_q ;
    (* hierconn *) wire [6:0]  \u_transact.status_q ;
    (* hierconn *) wire [7:0]  \u_transact.sequence_q ;
    (* hierconn *) wire [31:0] \u_transact.address_q , \u_transact.u_store.word_q , \u_transact.u_store.read_q ;
    wire fetches = \u_transact.state_q == 2'd1, waits = \u_transact.state_q == 2'd2;
    generate
        if (LEMMAS != 0) begin : g_lemmas
            always @* if (started_q) begin
                assert (answer == (busy_q && over_q));
                assert (\u_transact.aw_q == (waits && write_q && !aw_done_q));
                assert (\u_transact.w_q == (waits && write_q && !w_done_q));
                assert (\u_transact.ar_q == (waits && !write_q && !ar_done_q));
                assert (waits || !(aw_done_q || w_done_q || ar_done_q));
                assert (write_q ? !ar_done_q : !(aw_done_q || w_done_q));
                assert (!waits || !outside);
                assert (\u_transact.kept_q == kept_q);
                if (kept_q || busy_q) assert (\u_transact.sequence_q == sequence_q && \u_transact.status_q == status_q);
                if (busy_q) assert (request_q[38] == write_q && (!write_q || kept_q));
                if (busy_q && !(write_q && over_q)) assert (request_q[37:32] == last_q);
                if (busy_q && !over_q)
                    assert (\u_transact.word_q == count_q[5:0] && \u_transact.address_q == at && status_q == 7'd0 && count_q <= {1'b0, last_q});
                // The store
                if (known_q) assert (\u_transact.u_store.word_q == word_q);
                if (waits) assert (\u_transact.u_store.it_q == (count_q[5:0] == which));
                if (answer && looks_q) assert (\u_transact.u_store.it_q );
                if (\u_transact.u_store.it_q && (waits && write_q || answer && looks_q))
                    assert (\u_transact.u_store.read_q == \u_transact.u_store.word_q );
                // How long it takes
                assert (aw_waits_q <= PATIENCE && w_waits_q <= PATIENCE && ar_waits_q <= PATIENCE && thinks_q <= PATIENCE);
                if (!waits) assert ({aw_waits_q, w_waits_q, ar_waits_q, thinks_q, since_q} == {5*W{1'b0}});
                if (awvalid) assert (since_q == aw_waits_q + 1'b1);
                if (wvalid)  assert (since_q == w_waits_q + 1'b1);
                if (arvalid) assert (since_q == ar_waits_q + 1'b1);
                assert (since_q <= thinks_q + PATIENCE + 2'd2);
                if (ar_done_q || (aw_done_q && w_done_q)) assert (!awvalid && !wvalid && !arvalid);
                else                                      assert (thinks_q == {W{1'b0}});
            end
        end
    endgenerate
endmodule
`default_nettype wire
