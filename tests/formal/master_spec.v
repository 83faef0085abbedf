// master_spec: the promises of fp3_master.v as far as they are its own: whoever asks gets the answer, the host's registers of the transfer
// are those of the map, and what the transfer says on AXI4 goes out as it is. The transfer is any (any_transfer.v); the host keeps to what
// axi_lite promises, and the hub answers reads and writes as late as it likes, both at once, perhaps.
`default_nettype none
module master_spec #(
    parameter ADDRESS_W = 20,
    parameter INSIDE    = 18,
    parameter READS_W   = 5,
    parameter LEMMAS    = 1
) (
    input wire                 clk_i,
    input wire                 rst_i,
    input wire                 host_valid_i, host_write_i,
    input wire [ADDRESS_W-1:0] host_addr_i,
    input wire [31:0]          host_wdata_i,
    input wire                 req_ready_i, wrote_i, write_error_i, read_i, read_error_i,
    input wire [31:0]          rdata_i,
    input wire                 awready_i, wready_i, bvalid_i, arready_i, rvalid_i, bid_i, rid_i, rlast_i,
    input wire [1:0]           bresp_i, rresp_i,
    input wire [31:0]          memory_i
);
    localparam OPEN_W = READS_W + 1;
    localparam [ADDRESS_W-1:0] STREAM = 1 << INSIDE - 1;
    wire                 host_ready, host_wrote, host_write_error, host_read, host_read_error, req_valid, req_write;
    wire [31:0]          host_rdata, req_wdata, awaddr, wdata, araddr;
    wire [ADDRESS_W-1:0] req_addr;
    wire                 awid, awlock, awvalid, wlast, wvalid, bready, arid, arlock, arvalid, rready;
    wire [7:0]           awlen, arlen;
    wire [2:0]           awsize, awprot, arsize, arprot;
    wire [1:0]           awburst, arburst;
    wire [3:0]           awcache, arcache, wstrb;
    fp3_master #(.ADDRESS_W(ADDRESS_W), .INSIDE(INSIDE), .STREAM(STREAM), .READS_W(READS_W)) u_master (.clk_i(clk_i), .rst_i(rst_i),
        .host_valid_i(host_valid_i), .host_ready_o(host_ready), .host_write_i(host_write_i), .host_addr_i(host_addr_i),
        .host_wdata_i(host_wdata_i), .host_wrote_o(host_wrote), .host_write_error_o(host_write_error),
        .host_read_o(host_read), .host_read_error_o(host_read_error), .host_rdata_o(host_rdata),
        .req_valid_o(req_valid), .req_ready_i(req_ready_i), .req_write_o(req_write), .req_addr_o(req_addr), .req_wdata_o(req_wdata),
        .wrote_i(wrote_i), .write_error_i(write_error_i), .read_i(read_i), .read_error_i(read_error_i), .rdata_i(rdata_i),
        .m_axi_awid(awid), .m_axi_awaddr(awaddr), .m_axi_awlen(awlen), .m_axi_awsize(awsize), .m_axi_awburst(awburst), .m_axi_awlock(awlock),
        .m_axi_awcache(awcache), .m_axi_awprot(awprot), .m_axi_awvalid(awvalid), .m_axi_awready(awready_i),
        .m_axi_wdata(wdata), .m_axi_wstrb(wstrb), .m_axi_wlast(wlast), .m_axi_wvalid(wvalid), .m_axi_wready(wready_i),
        .m_axi_bid(bid_i), .m_axi_bresp(bresp_i), .m_axi_bvalid(bvalid_i), .m_axi_bready(bready),
        .m_axi_arid(arid), .m_axi_araddr(araddr), .m_axi_arlen(arlen), .m_axi_arsize(arsize), .m_axi_arburst(arburst), .m_axi_arlock(arlock),
        .m_axi_arcache(arcache), .m_axi_arprot(arprot), .m_axi_arvalid(arvalid), .m_axi_arready(arready_i),
        .m_axi_rid(rid_i), .m_axi_rdata(memory_i), .m_axi_rresp(rresp_i), .m_axi_rlast(rlast_i), .m_axi_rvalid(rvalid_i), .m_axi_rready(rready));

    // The transfer's side
    (* hierconn *) wire        \u_master.u_transfer.ask_i , \u_master.u_transfer.ask_write_i , \u_master.u_transfer.told_error_o ;
    (* hierconn *) wire [2:0]  \u_master.u_transfer.ask_register_i ;
    (* hierconn *) wire [31:0] \u_master.u_transfer.ask_wdata_i , \u_master.u_transfer.told_rdata_o ;
    (* hierconn *) wire        \u_master.u_transfer.req_valid_o , \u_master.u_transfer.req_ready_i , \u_master.u_transfer.req_write_o ;
    (* hierconn *) wire [31:2] \u_master.u_transfer.req_place_o , \u_master.u_transfer.address_o ;
    (* hierconn *) wire [31:0] \u_master.u_transfer.req_wdata_o , \u_master.u_transfer.answer_rdata_i , \u_master.u_transfer.rdata_i ;
    (* hierconn *) wire        \u_master.u_transfer.answered_i , \u_master.u_transfer.answer_error_i , \u_master.u_transfer.wstrobe_o ;
    (* hierconn *) wire        \u_master.u_transfer.awvalid_o , \u_master.u_transfer.arvalid_o , \u_master.u_transfer.wvalid_o ;
    (* hierconn *) wire        \u_master.u_transfer.bvalid_i , \u_master.u_transfer.berror_i , \u_master.u_transfer.rvalid_i ;
    (* hierconn *) wire        \u_master.u_transfer.rerror_i , \u_master.u_transfer.awready_i , \u_master.u_transfer.arready_i ;
    (* hierconn *) wire        \u_master.u_transfer.wready_i , \u_master.u_transfer.wlast_o ;
    (* hierconn *) wire [7:0]  \u_master.u_transfer.length_o ;
    (* hierconn *) wire [31:0] \u_master.u_transfer.wdata_o ;
    wire        move   = \u_master.u_transfer.req_valid_o && \u_master.u_transfer.req_ready_i ;
    wire        move_write = \u_master.u_transfer.req_write_o ;
    wire [31:0] bytes  = {\u_master.u_transfer.req_place_o , 2'd0};

    // The map: eight words from 0x2800 on, of whatever scheduler
    wire        ours   = host_addr_i[INSIDE-1:0] >= 'h2800 && host_addr_i[INSIDE-1:0] < 'h2820 && host_addr_i[1:0] == 2'd0;
    wire        accepted = host_valid_i && host_ready;

    // The host's request that is taken, and waits for the hub; or is for the transfer
    reg                 held_q, ours_q, write_q;
    reg [ADDRESS_W-1:0] addr_q;
    reg [31:0]          wdata_q;
    wire        asks   = held_q && ours_q;
    wire        host   = held_q && !ours_q && req_valid && req_ready_i && !move;

    reg [OPEN_W:0] hw_q, hr_q, mw_q, mr_q;
    wire [OPEN_W+2:0] total = hw_q + hr_q + mw_q + mr_q;
    reg started_q = 1'b0, reset_q, asked_q, asked_write_q;
    always @(posedge clk_i) begin
        {started_q, reset_q} <= {1'b1, rst_i};
        asked_q       <= asks && !rst_i;
        asked_write_q <= write_q;
        held_q        <= !rst_i && (accepted || (held_q && !asks && !host));
        if (accepted) {ours_q, write_q, addr_q, wdata_q} <= {ours, host_write_i, host_addr_i, host_wdata_i};
        if (rst_i) {hw_q, hr_q, mw_q, mr_q} <= {4*(OPEN_W+1){1'b0}};
        else begin
            hw_q <= hw_q + (host && write_q)  - (wrote_i && hw_q != 0);
            hr_q <= hr_q + (host && !write_q) - (read_i && hr_q != 0);
            mw_q <= mw_q + (move && move_write)    - (wrote_i && mw_q != 0);
            mr_q <= mr_q + (move && !move_write)   - (read_i && mr_q != 0);
        end
    end
    always @* begin
        assume (started_q || rst_i);
        assume (!wrote_i || (started_q && (hw_q != 0 || mw_q != 0)));
        assume (!read_i || (started_q && (hr_q != 0 || mr_q != 0)));
        assume (!req_ready_i || total < (1 << OPEN_W) - 1);
        assume (!(host_valid_i && ours) || (hw_q == 0 && hr_q == 0 && !held_q));      // alone
        assume (!(asks || asked_q) || !host_valid_i);
    end
    wire error_of = wrote_i && mw_q != 0 ? write_error_i : read_error_i;
    always @* if (started_q && !reset_q) begin
        // The host: one answer for each request, its own
        assert (host_wrote == ((wrote_i && hw_q != 0) || (asked_q && asked_write_q)));
        assert (host_read == ((read_i && hr_q != 0) || (asked_q && !asked_write_q)));
        if (asked_q) assert (host_wrote ? host_write_error == \u_master.u_transfer.told_error_o
                                        : host_read_error == \u_master.u_transfer.told_error_o && host_rdata == \u_master.u_transfer.told_rdata_o );
        else begin
            if (host_wrote) assert (host_write_error == write_error_i);
            if (host_read)  assert (host_read_error == read_error_i && host_rdata == rdata_i);
        end
        assert (host_ready == !(held_q && !asks && !host));                   // one waits for its turn, a register of the transfer for none
        assert (\u_master.u_transfer.ask_i == asks);
        if (asks) assert (\u_master.u_transfer.ask_write_i == write_q && \u_master.u_transfer.ask_register_i == addr_q[4:2]
                          && \u_master.u_transfer.ask_wdata_i == wdata_q);
        // The transfer likewise
        assert (\u_master.u_transfer.answered_i == ((wrote_i && mw_q != 0) || (read_i && mr_q != 0)));
        if (\u_master.u_transfer.answered_i ) assert (\u_master.u_transfer.answer_error_i == error_of && \u_master.u_transfer.answer_rdata_i == rdata_i);
        // The hub is asked what was asked for; of a place that has too many bits, nothing that is there
        assert ((req_valid && req_ready_i) == (host || move));
        if (host) assert (req_write == write_q && req_addr == addr_q && (!req_write || req_wdata == wdata_q));
        if (move) begin
            assert (req_write == move_write && (!req_write || req_wdata == \u_master.u_transfer.req_wdata_o ));
            if (bytes < (1 << ADDRESS_W)) assert (req_addr == bytes[ADDRESS_W-1:0]);
            else                          assert (req_addr[1:0] != 2'd0);
        end
        // Memory
        assert ({awid, arid, awlock, arlock, awprot, arprot} == 0);
        assert (awsize == 3'd2 && arsize == 3'd2 && awburst == 2'd1 && arburst == 2'd1 && awcache == 4'd3 && arcache == 4'd3);
        assert (awvalid == \u_master.u_transfer.awvalid_o && arvalid == \u_master.u_transfer.arvalid_o && wvalid == \u_master.u_transfer.wvalid_o );
        if (awvalid) assert (awaddr == {\u_master.u_transfer.address_o , 2'd0} && awlen == \u_master.u_transfer.length_o );
        if (arvalid) assert (araddr == {\u_master.u_transfer.address_o , 2'd0} && arlen == \u_master.u_transfer.length_o );
        if (wvalid)  assert (wdata == \u_master.u_transfer.wdata_o && wlast == \u_master.u_transfer.wlast_o && wstrb == {4{\u_master.u_transfer.wstrobe_o }});
        assert (\u_master.u_transfer.awready_i == awready_i && \u_master.u_transfer.arready_i == arready_i && \u_master.u_transfer.wready_i == wready_i);
        assert (\u_master.u_transfer.bvalid_i == bvalid_i && \u_master.u_transfer.rvalid_i == rvalid_i);
        if (bvalid_i) assert (\u_master.u_transfer.berror_i == (bresp_i >= 2'd2));
        if (rvalid_i) assert (\u_master.u_transfer.rerror_i == (rresp_i >= 2'd2) && \u_master.u_transfer.rdata_i == memory_i);
    end
    always @* if (started_q && reset_q) assert (!host_wrote && !host_read);

    (* hierconn *) wire              \u_master.u_turns.moves_q , \u_master.u_turns.alone_q ;
    (* hierconn *) wire [OPEN_W-1:0] \u_master.u_turns.open_q ;
    (* hierconn *) wire              \u_master.held_q , \u_master.ours_q , \u_master.write_q ;
    (* hierconn *) wire [ADDRESS_W-1:0] \u_master.addr_q ;
    (* hierconn *) wire [31:0]       \u_master.wdata_q ;
    (* hierconn *) wire              \u_master.u_transfer.asked_q , \u_master.u_transfer.told_q , \u_master.u_transfer.write_q ;
    generate
        if (LEMMAS != 0) begin : g_lemmas
            always @* if (started_q) begin
                assert (\u_master.u_turns.open_q == total && total < (1 << OPEN_W));
                if (hw_q != 0 || hr_q != 0) assert (!\u_master.u_turns.moves_q && mw_q == 0 && mr_q == 0);
                if (mw_q != 0 || mr_q != 0) assert (\u_master.u_turns.moves_q && hw_q == 0 && hr_q == 0 && (mw_q != 0) == \u_master.u_transfer.asked_q
                                                    && (mr_q != 0) == !\u_master.u_transfer.asked_q );
                assert (\u_master.u_transfer.told_q == asked_q && (!asked_q || \u_master.u_transfer.write_q == asked_write_q));
                if (asked_q) assert (hw_q == 0 && hr_q == 0 && !held_q);
                assert (\u_master.held_q == held_q);
                if (held_q) assert ({\u_master.ours_q , \u_master.write_q , \u_master.addr_q , \u_master.wdata_q } == {ours_q, write_q, addr_q, wdata_q});
                if (asks) assert (hw_q == 0 && hr_q == 0);
            end
        end
    endgenerate
endmodule
`default_nettype wire
