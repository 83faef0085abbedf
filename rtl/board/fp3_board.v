// SPDX-License-Identifier: Apache-2.0
// fp3_board: the processor behind a serial line, without any vendor's parts.
//
// Purpose   What a board's own top and the simulated board instantiate: all but clock, reset and
//           pins.
//
//           line ◄──► uart_bridge ◄── AXI4-Lite ──► a named configuration (build/rtl/fp3_<name>.v)
//
// Use       Define FP3_TOP as the configuration's module, fp3_single if it is not defined; DIVISOR
//           is the clock's frequency over the baud rate, rounded; ADDRESS_W is that of the
//           configuration's ports.
// Hazard    rst_i is synchronous to clk_i; at power-up it is high for at least two cycles.
`default_nettype none
`ifndef FP3_TOP
`define FP3_TOP fp3_single
`endif
module fp3_board #(
    parameter DIVISOR   = 104,         // clock cycles in a bit of the line, >= 4: 12 MHz and 115,200 baud
    parameter ADDRESS_W = 18
) (
    input  wire clk_i,
    input  wire rst_i,
    input  wire uart_rxd,
    output wire uart_txd,
    output wire irq
);
    wire [ADDRESS_W-1:0] awaddr, araddr;
    wire [2:0]           awprot, arprot;
    wire                 awvalid, awready, wvalid, wready, bvalid, bready, arvalid, arready, rvalid, rready;
    wire [31:0]          wdata, rdata;
    wire [3:0]           wstrb;
    wire [1:0]           bresp, rresp;
    fp3_uart_bridge #(.DIVISOR(DIVISOR), .ADDRESS_W(ADDRESS_W)) u_bridge (
        .clk_i(clk_i), .rst_i(rst_i), .uart_rxd(uart_rxd), .uart_txd(uart_txd),
        .m_axi_awaddr(awaddr), .m_axi_awprot(awprot), .m_axi_awvalid(awvalid), .m_axi_awready(awready),
        .m_axi_wdata(wdata), .m_axi_wstrb(wstrb), .m_axi_wvalid(wvalid), .m_axi_wready(wready),
        .m_axi_bresp(bresp), .m_axi_bvalid(bvalid), .m_axi_bready(bready),
        .m_axi_araddr(araddr), .m_axi_arprot(arprot), .m_axi_arvalid(arvalid), .m_axi_arready(arready),
        .m_axi_rdata(rdata), .m_axi_rresp(rresp), .m_axi_rvalid(rvalid), .m_axi_rready(rready));

    // With FP3_TRACE, its ports stay open.
    // verilator lint_off PINMISSING
    `FP3_TOP u_fp3 (
        .s_axi_aclk(clk_i), .s_axi_aresetn(!rst_i),
        .s_axi_awaddr(awaddr), .s_axi_awprot(awprot), .s_axi_awvalid(awvalid), .s_axi_awready(awready),
        .s_axi_wdata(wdata), .s_axi_wstrb(wstrb), .s_axi_wvalid(wvalid), .s_axi_wready(wready),
        .s_axi_bresp(bresp), .s_axi_bvalid(bvalid), .s_axi_bready(bready),
        .s_axi_araddr(araddr), .s_axi_arprot(arprot), .s_axi_arvalid(arvalid), .s_axi_arready(arready),
        .s_axi_rdata(rdata), .s_axi_rresp(rresp), .s_axi_rvalid(rvalid), .s_axi_rready(rready), .irq(irq));
    // verilator lint_on PINMISSING
endmodule
`default_nettype wire
