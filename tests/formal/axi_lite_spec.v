// axi_lite_spec: the promises of axi_lite.v, for a master that keeps to the rules of AXI and a host port that
// answers each request within PATIENCE cycles.
//
// Of each kind the spec keeps what was accepted and has no response yet, the oldest first.
`default_nettype none
module axi_lite_spec #(
    parameter ADDRESS_W = 2,
    parameter PATIENCE  = 2,           // cycles until the host port takes a request, and until it answers
    parameter LEMMAS    = 1
) (
    input wire                 clk_i,
    input wire                 rst_i,
    input wire                 awvalid_i, wvalid_i, arvalid_i, bready_i, rready_i,
    input wire [ADDRESS_W-1:0] awaddr_i, araddr_i,
    input wire [31:0]          wdata_i,
    input wire [3:0]           wstrb_i,
    input wire                 req_ready_i, rsp_valid_i, rsp_error_i,
    input wire [31:0]          rsp_rdata_i
);
    // A transfer waits for at most one of the other kind and itself, each to be taken and to be answered.
    localparam BOUND = 2 * (2 * PATIENCE + 3);
    localparam W = 6;

    wire                 awready, wready, arready, bvalid, rvalid, req_valid, req_write, rsp_ready;
    wire [1:0]           bresp, rresp;
    wire [31:0]          rdata, req_wdata;
    wire [ADDRESS_W-1:0] req_addr;
    axi_lite #(.ADDRESS_W(ADDRESS_W)) u_axi (.clk_i(clk_i), .rst_i(rst_i),
        .s_axi_awvalid(awvalid_i), .s_axi_awready(awready), .s_axi_awaddr(awaddr_i),
        .s_axi_wvalid(wvalid_i), .s_axi_wready(wready), .s_axi_wdata(wdata_i), .s_axi_wstrb(wstrb_i),
        .s_axi_bvalid(bvalid), .s_axi_bready(bready_i), .s_axi_bresp(bresp),
        .s_axi_arvalid(arvalid_i), .s_axi_arready(arready), .s_axi_araddr(araddr_i),
        .s_axi_rvalid(rvalid), .s_axi_rready(rready_i), .s_axi_rdata(rdata), .s_axi_rresp(rresp),
        .req_valid_o(req_valid), .req_ready_i(req_ready_i), .req_write_o(req_write), .req_addr_o(req_addr),
        .req_wdata_o(req_wdata), .rsp_valid_i(rsp_valid_i), .rsp_ready_o(rsp_ready), .rsp_rdata_i(rsp_rdata_i),
        .rsp_error_i(rsp_error_i));

    wire aw = awvalid_i && awready, w = wvalid_i && wready, ar = arvalid_i && arready;
    wire b = bvalid && bready_i, r = rvalid && rready_i;
    wire taken = req_valid && req_ready_i, answered = rsp_valid_i && rsp_ready;

    // The cycle before
    reg                 started_q = 1'b0, reset_q;
    reg                 aw_held_q, w_held_q, ar_held_q, b_held_q, r_held_q, rsp_held_q;
    reg [ADDRESS_W-1:0] awaddr_q, araddr_q;
    reg [35:0]          w_q;
    reg [1:0]           bresp_q;
    reg [33:0]          r_q;
    reg [32:0]          rsp_q;
    always @(posedge clk_i) begin
        {started_q, reset_q} <= {1'b1, rst_i};
        aw_held_q  <= awvalid_i && !awready;
        w_held_q   <= wvalid_i && !wready;
        ar_held_q  <= arvalid_i && !arready;
        b_held_q   <= bvalid && !bready_i;
        r_held_q   <= rvalid && !rready_i;
        rsp_held_q <= rsp_valid_i && !rsp_ready;
        {awaddr_q, araddr_q, w_q} <= {awaddr_i, araddr_i, wstrb_i, wdata_i};
        {bresp_q, r_q, rsp_q}     <= {bresp, rresp, rdata, rsp_error_i, rsp_rdata_i};
    end
    wire follows = started_q && !reset_q;

    // Transfers without a response, at most two of a kind: the oldest, and the one after it -----------
    reg [1:0]             aws_q, ws_q, ars_q;
    reg [2*ADDRESS_W-1:0] write_to_q, read_from_q;
    reg [71:0]            write_q;                         // strobes and data
    reg                   owed_q, of_write_q;              // the host port owes an answer
    reg                   wrote_q, wrote_error_q, has_read_q;    // the oldest has its answer
    reg [32:0]            has_read_value_q;
    reg [W-1:0]           refused_q, thinks_q, write_waits_q, read_waits_q;
    wire [1:0] aws_left = aws_q - b, ws_left = ws_q - b, ars_left = ars_q - r;
    always @(posedge clk_i)
        if (rst_i) begin
            {aws_q, ws_q, ars_q, owed_q, wrote_q, has_read_q} <= 9'd0;
            {refused_q, thinks_q, write_waits_q, read_waits_q} <= {4*W{1'b0}};
        end else begin
            aws_q <= aws_left + aw;
            ws_q  <= ws_left + w;
            ars_q <= ars_left + ar;
            if (b) {write_to_q[ADDRESS_W-1:0], write_q[35:0]} <= {write_to_q[ADDRESS_W +: ADDRESS_W], write_q[36 +: 36]};
            if (r) read_from_q[ADDRESS_W-1:0] <= read_from_q[ADDRESS_W +: ADDRESS_W];
            if (aw) write_to_q[ADDRESS_W*aws_left[0] +: ADDRESS_W]  <= awaddr_i;
            if (w)  write_q[36*ws_left[0] +: 36]                    <= {wstrb_i, wdata_i};
            if (ar) read_from_q[ADDRESS_W*ars_left[0] +: ADDRESS_W] <= araddr_i;
            owed_q <= owed_q ? !answered : taken;
            if (taken) of_write_q <= req_write;
            wrote_q    <= answered && of_write_q  ? 1'b1 : wrote_q && !b;
            has_read_q <= answered && !of_write_q ? 1'b1 : has_read_q && !r;
            if (answered && of_write_q)  wrote_error_q    <= rsp_error_i;
            if (answered && !of_write_q) has_read_value_q <= {rsp_error_i, rsp_rdata_i};
            refused_q     <= req_valid && !req_ready_i ? refused_q + 1'b1 : {W{1'b0}};
            thinks_q      <= owed_q && !answered ? thinks_q + 1'b1 : {W{1'b0}};
            write_waits_q <= aws_q != 0 && ws_q != 0 && !bvalid ? write_waits_q + 1'b1 : {W{1'b0}};
            read_waits_q  <= ars_q != 0 && !rvalid ? read_waits_q + 1'b1 : {W{1'b0}};
        end

    // What the master and the host port do ------------------------------------------------------------
    always @* begin
        assume (started_q || rst_i);
        if (follows) begin
            if (aw_held_q)  assume (awvalid_i && awaddr_i == awaddr_q);
            if (w_held_q)   assume (wvalid_i && {wstrb_i, wdata_i} == w_q);
            if (ar_held_q)  assume (arvalid_i && araddr_i == araddr_q);
            if (rsp_held_q) assume (rsp_valid_i && {rsp_error_i, rsp_rdata_i} == rsp_q);
            assume (owed_q || !rsp_valid_i);
            assume (!owed_q || !req_ready_i);
            assume (owed_q || refused_q < PATIENCE || req_ready_i || !req_valid);
            assume (!owed_q || thinks_q < PATIENCE || rsp_valid_i);
        end
    end

    // The promises -------------------------------------------------------------------------------------
    wire [3:0] strobes = write_q[35:32];
    always @* if (follows) begin
        assert (!owed_q || !req_valid);                           // one request at a time
        if (b_held_q) assert (bvalid && bresp == bresp_q);        // responses stand until they are taken
        if (r_held_q) assert (rvalid && {rresp, rdata} == r_q);
        if (req_valid && req_write)                               // a request is the oldest transfer of its kind
            assert (aws_q != 0 && ws_q != 0 && !wrote_q && !bvalid && strobes == 4'b1111
                    && req_addr == write_to_q[ADDRESS_W-1:0] && req_wdata == write_q[31:0]);
        if (req_valid && !req_write)
            assert (ars_q != 0 && !has_read_q && req_addr == read_from_q[ADDRESS_W-1:0]);
        if (bvalid)                                               // one response for each, and the right one
            assert (aws_q != 0 && ws_q != 0
                    && (strobes == 4'b1111 ? wrote_q && bresp == {wrote_error_q, 1'b0} : bresp == {|strobes, 1'b0}));
        if (rvalid)
            assert (ars_q != 0 && has_read_q && {rresp, rdata} == {has_read_value_q[32], 1'b0, has_read_value_q[31:0]});
        assert (rsp_ready || !rsp_valid_i);                       // the host port never waits
        // No hang, and neither kind waits for a response of the other kind to be taken.
        assert (write_waits_q <= BOUND && read_waits_q <= BOUND);
    end
    always @* if (started_q && reset_q) assert (!bvalid && !rvalid && !req_valid);

    (* hierconn *) wire \u_axi.aw_q , \u_axi.w_q , \u_axi.ar_q , \u_axi.b_q , \u_axi.r_q , \u_axi.asked_q , \u_axi.write_q ;
    (* hierconn *) wire [ADDRESS_W-1:0] \u_axi.awaddr_q , \u_axi.araddr_q ;
    (* hierconn *) wire [31:0] \u_axi.wdata_q ;
    (* hierconn *) wire [3:0]  \u_axi.wstrb_q ;
    wire busy_write = \u_axi.b_q || (\u_axi.asked_q && \u_axi.write_q );
    wire busy_read  = \u_axi.r_q || (\u_axi.asked_q && !\u_axi.write_q );
    generate
        if (LEMMAS != 0) begin : g_lemmas
            always @* if (follows) begin
                assert (aws_q == \u_axi.aw_q + busy_write);
                assert (ws_q == \u_axi.w_q + busy_write);
                assert (ars_q == \u_axi.ar_q + busy_read);
                assert (!(\u_axi.b_q && \u_axi.asked_q && \u_axi.write_q ));
                assert (!(\u_axi.r_q && \u_axi.asked_q && !\u_axi.write_q ));
                if (\u_axi.aw_q ) assert (\u_axi.awaddr_q == write_to_q[ADDRESS_W*busy_write +: ADDRESS_W]);
                if (\u_axi.w_q )  assert ({\u_axi.wstrb_q , \u_axi.wdata_q } == write_q[36*busy_write +: 36]);
                if (\u_axi.ar_q ) assert (\u_axi.araddr_q == read_from_q[ADDRESS_W*busy_read +: ADDRESS_W]);
                if (\u_axi.asked_q && \u_axi.write_q ) assert (strobes == 4'b1111);
                assert (owed_q == \u_axi.asked_q );
                if (owed_q) assert (of_write_q == \u_axi.write_q );
                assert (wrote_q == (\u_axi.b_q && strobes == 4'b1111));
                assert (has_read_q == \u_axi.r_q );
                assert (thinks_q <= PATIENCE && refused_q <= PATIENCE);
            end
        end
    endgenerate
endmodule
`default_nettype wire
