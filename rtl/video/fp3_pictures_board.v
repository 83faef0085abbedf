// SPDX-License-Identifier: Apache-2.0
// fp3_pictures_board: the processor behind a serial line, and a picture of its objects.
//
// Purpose   fp3_board with fp3_pictures on the processor's bus, and the picture as words of DVI.
//
//           line ◄──► uart_bridge ◄──► pictures ◄──► a named configuration (build/rtl/fp3_<name>.v)
//                                         └──► tmds (blue, green, red) ──► words
//
// Use       As fp3_board. ADDRESS_W is that of the configuration's ports; the bridge has one bit more.
`default_nettype none
`ifndef FP3_TOP
`define FP3_TOP fp3_world
`endif
module fp3_pictures_board #(
    parameter DIVISOR   = 434,         // as of fp3_board: 50 MHz and 115,200 baud
    parameter ADDRESS_W = 18,
    parameter TICKS     = 2            // clock cycles in a pixel
) (
    input  wire        clk_i,
    input  wire        rst_i,
    input  wire        uart_rxd,
    output wire        uart_txd,
    output wire        irq,
    output wire        word_o,         // the first cycle of new words
    output wire [29:0] words_o         // {red, green, blue}, of each the lowest bit goes first
);
    wire [ADDRESS_W:0]   awaddr, araddr;
    wire [ADDRESS_W-1:0] m_awaddr, m_araddr;
    wire [2:0]           awprot, arprot, m_awprot, m_arprot;
    wire                 awvalid, awready, wvalid, wready, bvalid, bready, arvalid, arready, rvalid, rready;
    wire                 m_awvalid, m_awready, m_wvalid, m_wready, m_bvalid, m_bready, m_arvalid, m_arready, m_rvalid, m_rready;
    wire [31:0]          wdata, rdata, m_wdata, m_rdata;
    wire [3:0]           wstrb, m_wstrb;
    wire [1:0]           bresp, rresp, m_bresp, m_rresp;
    wire                 pixel, visible, hsync, vsync;
    wire [23:0]          rgb;
    fp3_uart_bridge #(.DIVISOR(DIVISOR), .ADDRESS_W(ADDRESS_W + 1)) u_bridge (
        .clk_i(clk_i), .rst_i(rst_i), .uart_rxd(uart_rxd), .uart_txd(uart_txd),
        .m_axi_awaddr(awaddr), .m_axi_awprot(awprot), .m_axi_awvalid(awvalid), .m_axi_awready(awready),
        .m_axi_wdata(wdata), .m_axi_wstrb(wstrb), .m_axi_wvalid(wvalid), .m_axi_wready(wready),
        .m_axi_bresp(bresp), .m_axi_bvalid(bvalid), .m_axi_bready(bready),
        .m_axi_araddr(araddr), .m_axi_arprot(arprot), .m_axi_arvalid(arvalid), .m_axi_arready(arready),
        .m_axi_rdata(rdata), .m_axi_rresp(rresp), .m_axi_rvalid(rvalid), .m_axi_rready(rready));
    fp3_pictures #(.ADDRESS_W(ADDRESS_W), .TICKS(TICKS)) u_pictures (
        .clk_i(clk_i), .rst_i(rst_i),
        .s_axi_awaddr(awaddr), .s_axi_awvalid(awvalid), .s_axi_awready(awready),
        .s_axi_wdata(wdata), .s_axi_wstrb(wstrb), .s_axi_wvalid(wvalid), .s_axi_wready(wready),
        .s_axi_bresp(bresp), .s_axi_bvalid(bvalid), .s_axi_bready(bready),
        .s_axi_araddr(araddr), .s_axi_arvalid(arvalid), .s_axi_arready(arready),
        .s_axi_rdata(rdata), .s_axi_rresp(rresp), .s_axi_rvalid(rvalid), .s_axi_rready(rready),
        .m_axi_awaddr(m_awaddr), .m_axi_awprot(m_awprot), .m_axi_awvalid(m_awvalid), .m_axi_awready(m_awready),
        .m_axi_wdata(m_wdata), .m_axi_wstrb(m_wstrb), .m_axi_wvalid(m_wvalid), .m_axi_wready(m_wready),
        .m_axi_bresp(m_bresp), .m_axi_bvalid(m_bvalid), .m_axi_bready(m_bready),
        .m_axi_araddr(m_araddr), .m_axi_arprot(m_arprot), .m_axi_arvalid(m_arvalid), .m_axi_arready(m_arready),
        .m_axi_rdata(m_rdata), .m_axi_rresp(m_rresp), .m_axi_rvalid(m_rvalid), .m_axi_rready(m_rready),
        .pixel_o(pixel), .visible_o(visible), .hsync_o(hsync), .vsync_o(vsync), .rgb_o(rgb));

    // With FP3_TRACE, its ports stay open.
    // verilator lint_off PINMISSING
    `FP3_TOP u_fp3 (
        .s_axi_aclk(clk_i), .s_axi_aresetn(!rst_i),
        .s_axi_awaddr(m_awaddr), .s_axi_awprot(m_awprot), .s_axi_awvalid(m_awvalid), .s_axi_awready(m_awready),
        .s_axi_wdata(m_wdata), .s_axi_wstrb(m_wstrb), .s_axi_wvalid(m_wvalid), .s_axi_wready(m_wready),
        .s_axi_bresp(m_bresp), .s_axi_bvalid(m_bvalid), .s_axi_bready(m_bready),
        .s_axi_araddr(m_araddr), .s_axi_arprot(m_arprot), .s_axi_arvalid(m_arvalid), .s_axi_arready(m_arready),
        .s_axi_rdata(m_rdata), .s_axi_rresp(m_rresp), .s_axi_rvalid(m_rvalid), .s_axi_rready(m_rready), .irq(irq));
    // verilator lint_on PINMISSING

    fp3_video_dvi u_dvi (.clk_i(clk_i), .rst_i(rst_i), .pixel_i(pixel), .visible_i(visible), .hsync_i(hsync), .vsync_i(vsync), .rgb_i(rgb),
        .word_o(word_o), .words_o(words_o));
    wire unused = &{awprot, arprot};
endmodule
`default_nettype wire
