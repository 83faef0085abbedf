// SPDX-License-Identifier: Apache-2.0
// fp3_video_port: requests as a master of AXI4-Lite.
//
// Purpose   The way back from the requests of axi_lite and turns to a bus.
// Latency   One cycle from a request to its channels, none from a response to its answer.
// Promise   What is valid stands until it is taken. Responses are always taken.
`default_nettype none
module fp3_video_port #(
    parameter ADDRESS_W = 18
) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    input  wire                 req_valid_i,
    output wire                 req_ready_o,
    input  wire                 req_write_i,
    input  wire [ADDRESS_W-1:0] req_addr_i,
    input  wire [31:0]          req_wdata_i,
    output wire                 wrote_o,
    output wire                 write_error_o,
    output wire                 read_o,
    output wire                 read_error_o,
    output wire [31:0]          rdata_o,
    output wire [ADDRESS_W-1:0] m_axi_awaddr,
    output wire [2:0]           m_axi_awprot,
    output wire                 m_axi_awvalid,
    input  wire                 m_axi_awready,
    output wire [31:0]          m_axi_wdata,
    output wire [3:0]           m_axi_wstrb,
    output wire                 m_axi_wvalid,
    input  wire                 m_axi_wready,
    input  wire [1:0]           m_axi_bresp,
    input  wire                 m_axi_bvalid,
    output wire                 m_axi_bready,
    output wire [ADDRESS_W-1:0] m_axi_araddr,
    output wire [2:0]           m_axi_arprot,
    output wire                 m_axi_arvalid,
    input  wire                 m_axi_arready,
    input  wire [31:0]          m_axi_rdata,
    input  wire [1:0]           m_axi_rresp,
    input  wire                 m_axi_rvalid,
    output wire                 m_axi_rready
);
    reg                 aw_q, w_q, ar_q;                   // not taken yet
    reg [ADDRESS_W-1:0] awaddr_q, araddr_q;
    reg [31:0]          wdata_q;
    wire                aw_stays = aw_q && !m_axi_awready, w_stays = w_q && !m_axi_wready, ar_stays = ar_q && !m_axi_arready;
    wire                ready  = req_write_i ? !aw_stays && !w_stays : !ar_stays;
    wire                writes = req_valid_i && ready && req_write_i;
    wire                reads  = req_valid_i && ready && !req_write_i;
    always @(posedge clk_i) begin
        if (rst_i) {aw_q, w_q, ar_q} <= 3'd0;
        else       {aw_q, w_q, ar_q} <= {aw_stays || writes, w_stays || writes, ar_stays || reads};
        if (writes) {awaddr_q, wdata_q} <= {req_addr_i, req_wdata_i};
        if (reads)  araddr_q <= req_addr_i;
    end
    assign req_ready_o   = ready;
    assign {m_axi_awvalid, m_axi_wvalid, m_axi_arvalid} = {aw_q, w_q, ar_q};
    assign {m_axi_awaddr, m_axi_wdata, m_axi_araddr}    = {awaddr_q, wdata_q, araddr_q};
    assign {m_axi_awprot, m_axi_arprot, m_axi_wstrb}    = {6'd0, 4'b1111};
    assign {m_axi_bready, m_axi_rready}                 = 2'b11;
    assign {wrote_o, write_error_o}       = {m_axi_bvalid, m_axi_bresp[1]};
    assign {read_o, read_error_o, rdata_o} = {m_axi_rvalid, m_axi_rresp[1], m_axi_rdata};
    wire unused = &{m_axi_bresp[0], m_axi_rresp[0]};
endmodule
`default_nettype wire
