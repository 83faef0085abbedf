// axi_lite: an AXI4-Lite slave in front of a host port.
//
// Purpose   A bus that processors, interconnects and vendor tools know. One word of 32 bits for each
//           transfer (Arm IHI 0022, chapter B1). A write of all four bytes and a read become requests of
//           the host port, one after the other; what the host port refuses is answered with SLVERR. A write
//           of no byte is answered with OKAY and does nothing; one of some bytes with SLVERR, and does nothing.
// Latency   One cycle from the handshakes of the address (and the data) to the request, one from the response
//           to bvalid or rvalid.
// Promise   Every transfer gets one response, in its channel's order. A read is answered although nobody takes
//           the response to a write, and a write although nobody takes that to a read. Of both, they take turns.
// Hazard    A read that is to come after a write has to wait for bvalid. A request that is not taken may give
//           way to another one.
//
//     cycle          0     1     2    ...   n    n+1   n+2
//     s_axi_awvalid  1     0                                  address and data come in any order
//     s_axi_wvalid   0     1     0
//     req_valid_o    0     0     1
//     rsp_valid_i                           1     0
//     s_axi_bvalid   0     0     0          0     1     0     bready = 1
`default_nettype none
module axi_lite #(
    parameter ADDRESS_W = 24
) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    // The bus
    input  wire                 s_axi_awvalid,
    output wire                 s_axi_awready,
    input  wire [ADDRESS_W-1:0] s_axi_awaddr,
    input  wire                 s_axi_wvalid,
    output wire                 s_axi_wready,
    input  wire [31:0]          s_axi_wdata,
    input  wire [3:0]           s_axi_wstrb,
    output wire                 s_axi_bvalid,
    input  wire                 s_axi_bready,
    output wire [1:0]           s_axi_bresp,
    input  wire                 s_axi_arvalid,
    output wire                 s_axi_arready,
    input  wire [ADDRESS_W-1:0] s_axi_araddr,
    output wire                 s_axi_rvalid,
    input  wire                 s_axi_rready,
    output wire [31:0]          s_axi_rdata,
    output wire [1:0]           s_axi_rresp,
    // The host port
    output wire                 req_valid_o,
    input  wire                 req_ready_i,
    output wire                 req_write_o,
    output wire [ADDRESS_W-1:0] req_addr_o,
    output wire [31:0]          req_wdata_o,
    input  wire                 rsp_valid_i,
    output wire                 rsp_ready_o,
    input  wire [31:0]          rsp_rdata_i,
    input  wire                 rsp_error_i
);
    // One transfer of each channel waits here; behind it the channel is not ready.
    reg                 aw_q, w_q, ar_q;
    reg [ADDRESS_W-1:0] awaddr_q, araddr_q;
    reg [31:0]          wdata_q;
    reg [3:0]           wstrb_q;
    // One response of each kind waits here. A request begins only when there is room for its response.
    reg                 b_q, r_q, berror_q, rerror_q;
    reg [31:0]          rdata_q;
    // The request that the host port has, and whether the last one was a write.
    reg                 asked_q, write_q;

    wire write    = aw_q && w_q && !b_q && !(asked_q && write_q);
    wire read     = ar_q && !r_q && !(asked_q && !write_q);
    wire whole    = &wstrb_q;
    wire skip     = write && !whole;                       // answered here
    wire asks     = write && whole && !(read && write_q);  // both wish: not the one that was last
    assign req_valid_o = !asked_q && (asks || read);
    assign req_write_o = asks;
    assign req_addr_o  = asks ? awaddr_q : araddr_q;
    assign req_wdata_o = wdata_q;
    assign rsp_ready_o = asked_q;

    wire taken      = req_valid_o && req_ready_i;
    wire write_goes = skip || (taken && asks);
    wire read_goes  = taken && !asks;
    wire answered   = asked_q && rsp_valid_i;
    always @(posedge clk_i) begin
        if (rst_i) {aw_q, w_q, ar_q, b_q, r_q, asked_q, write_q} <= 7'd0;
        else begin
            aw_q    <= aw_q ? !write_goes : s_axi_awvalid;
            w_q     <= w_q  ? !write_goes : s_axi_wvalid;
            ar_q    <= ar_q ? !read_goes  : s_axi_arvalid;
            b_q     <= b_q  ? !s_axi_bready : skip || (answered && write_q);
            r_q     <= r_q  ? !s_axi_rready : answered && !write_q;
            asked_q <= asked_q ? !rsp_valid_i : taken;
            if (taken) write_q <= asks;
        end
        if (!aw_q) awaddr_q <= s_axi_awaddr;
        if (!w_q)  {wdata_q, wstrb_q} <= {s_axi_wdata, s_axi_wstrb};
        if (!ar_q) araddr_q <= s_axi_araddr;
        if (!b_q)  berror_q <= skip ? |wstrb_q : rsp_error_i;
        if (!r_q)  {rdata_q, rerror_q} <= {rsp_rdata_i, rsp_error_i};
    end

    localparam [1:0] OKAY = 2'b00, SLVERR = 2'b10;
    assign s_axi_awready = !aw_q;
    assign s_axi_wready  = !w_q;
    assign s_axi_arready = !ar_q;
    assign s_axi_bvalid  = b_q;
    assign s_axi_bresp   = berror_q ? SLVERR : OKAY;
    assign s_axi_rvalid  = r_q;
    assign s_axi_rdata   = rdata_q;
    assign s_axi_rresp   = rerror_q ? SLVERR : OKAY;
endmodule
`default_nettype wire
