// SPDX-License-Identifier: Apache-2.0
// fp3_axi_lite: an AXI4-Lite slave in front of a host port.
//
// Purpose   A bus that processors, interconnects and vendor tools know. One word of 32 bits for
//           each transfer (Arm IHI 0022, chapter B1). A write of all four bytes and a read become
//           requests of the host port; refused requests are answered with SLVERR. A write of no
//           byte does nothing and is answered with OKAY; a write of some bytes does nothing and is
//           answered with SLVERR. Requests with a bit of STREAM in their address are pipelined, up
//           to one in each cycle. Any other request is alone: it waits until all requests before it
//           are answered, and the next request waits for its answer.
// Latency   One cycle from the handshakes of the address (and the data) to the request, one from
//           the answer to bvalid or rvalid.
// Promise   Every transfer gets one response, in its channel's order. A read is answered even if
//           the response to a write is not taken, and vice versa. If both wait, reads and writes
//           alternate.
// Hazard    A master that reads after a write has to wait for bvalid. A request that is not taken
//           may be replaced by another one. Answers come in the order of requests, separately for
//           reads and writes, and cannot be delayed.
//
//     cycle          0     1     2     3    ...   n    n+1   n+2   n+3
//     s_axi_awvalid  1     1     0                                        address and data come in any order
//     s_axi_wvalid   0     1     1     0
//     req_valid_o    0     0     1     1     0                            req_ready_i = 1
//     wrote_i        0     0     0     0          1     1     0
//     s_axi_bvalid   0     0     0     0          0     1     1     0     bready = 1
`default_nettype none
module fp3_axi_lite #(
    parameter ADDRESS_W = 24,
    parameter [ADDRESS_W-1:0] STREAM = 0,
    parameter WRITES_W  = 1,           // 2^WRITES_W writes without a response at most, at least 2
    parameter READS_W   = 1            // likewise
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
    input  wire                 wrote_i,        // a write is answered
    input  wire                 write_error_i,
    input  wire                 read_i,         // a read is answered
    input  wire                 read_error_i,
    input  wire [31:0]          rdata_i
);
    // One transfer of each channel waits here; a channel is ready when the place is free, or
    // becomes free.
    reg                 aw_q, w_q, ar_q;
    reg [ADDRESS_W-1:0] awaddr_q, araddr_q;
    reg [31:0]          wdata_q;
    reg [3:0]           wstrb_q;
    // No request is under way; the request under way is alone; the last request was a write.
    reg                 idle_q, alone_q, write_q;

    wire write_room, read_room, write_idle, read_idle;
    wire whole         = &wstrb_q;
    wire write_streams = whole && |(awaddr_q & STREAM);
    wire read_streams  = |(araddr_q & STREAM);
    wire write_next    = aw_q && w_q && write_room && !(ar_q && read_room && write_q);   // of two the kind that was not last
    wire read_next     = ar_q && read_room && !write_next;
    wire write_may     = write_next && (idle_q || (write_streams && !alone_q));
    wire read_may      = read_next && (idle_q || (read_streams && !alone_q));
    assign req_valid_o = (write_may && whole) || read_may;
    assign req_write_o = write_next;
    assign req_addr_o  = write_next ? awaddr_q : araddr_q;
    assign req_wdata_o = wdata_q;

    wire skip       = write_may && !whole;                 // answered here
    wire write_goes = skip || (write_may && req_ready_i);
    wire read_goes  = read_may && req_ready_i;
    always @(posedge clk_i) begin
        if (rst_i) {aw_q, w_q, ar_q, idle_q, alone_q, write_q} <= 6'd0;
        else begin
            aw_q    <= (aw_q && !write_goes) || s_axi_awvalid;
            w_q     <= (w_q  && !write_goes) || s_axi_wvalid;
            ar_q    <= (ar_q && !read_goes)  || s_axi_arvalid;
            idle_q  <= write_idle && read_idle && !write_goes && !read_goes;
            alone_q <= (write_goes && !write_streams) || (read_goes && !read_streams) || (alone_q && !idle_q);
            if (write_goes || read_goes) write_q <= write_goes;
        end
        if (s_axi_awready) awaddr_q <= s_axi_awaddr;
        if (s_axi_wready)  {wdata_q, wstrb_q} <= {s_axi_wdata, s_axi_wstrb};
        if (s_axi_arready) araddr_q <= s_axi_araddr;
    end
    assign s_axi_awready = !aw_q || write_goes;
    assign s_axi_wready  = !w_q  || write_goes;
    assign s_axi_arready = !ar_q || read_goes;

    wire berror, rerror;
    fp3_responses #(.W(1), .DEPTH_W(WRITES_W)) u_writes (.clk_i(clk_i), .rst_i(rst_i), .room_o(write_room),
        .idle_o(write_idle),
        .go_i(write_goes), .answered_i(skip || wrote_i), .value_i(skip ? |wstrb_q : write_error_i),
        .valid_o(s_axi_bvalid), .ready_i(s_axi_bready), .value_o(berror));
    fp3_responses #(.W(33), .DEPTH_W(READS_W)) u_reads (.clk_i(clk_i), .rst_i(rst_i), .room_o(read_room),
        .idle_o(read_idle),
        .go_i(read_goes), .answered_i(read_i), .value_i({read_error_i, rdata_i}),
        .valid_o(s_axi_rvalid), .ready_i(s_axi_rready), .value_o({rerror, s_axi_rdata}));
    localparam [1:0] OKAY = 2'b00, SLVERR = 2'b10;
    assign s_axi_bresp = berror ? SLVERR : OKAY;
    assign s_axi_rresp = rerror ? SLVERR : OKAY;
endmodule
`default_nettype wire
