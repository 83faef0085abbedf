// SPDX-License-Identifier: Apache-2.0
// fp3_uart_bridge: a serial line as a master of AXI4-Lite.
//
// Purpose   Lets a host that has a serial port read and write words on the bus. docs/board.md has
//           the packets.
//
//           rxd ──► uart_rx ──► slip_rx ──► request_rx ─┐
//           txd ◄── uart_tx ◄── slip_tx ◄── answer_tx ◄─┴─ transact ◄─► the bus
//
// Latency   An answer's first byte leaves some cycles after the request's last byte, plus the time
//           of the bus.
// Promise   Every whole and right packet that begins while no other packet is executed or answered
//           gets one answer. Anything else on the line changes nothing and gets no answer; the next
//           end restores the initial state.
`default_nettype none
module fp3_uart_bridge #(
    parameter DIVISOR   = 104,         // clock cycles in a bit of the line, >= 4
    parameter ADDRESS_W = 24           // bits of a byte address on the bus, < 32
) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    // The line
    input  wire                 uart_rxd,
    output wire                 uart_txd,
    // The bus
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
    // From the line to a request
    wire        heard, noise, in_valid, in_end, in_bad;
    wire [7:0]  heard_byte, in_byte;
    wire        idle, request, write, store;
    wire [7:0]  sequence_in;
    wire [5:0]  last, store_at;
    wire [31:0] address, store_word;
    fp3_uart_rx #(.DIVISOR(DIVISOR)) u_uart_rx (
        .clk_i(clk_i), .rst_i(rst_i), .rxd_i(uart_rxd), .valid_o(heard), .byte_o(heard_byte), .bad_o(noise));
    fp3_slip_rx u_slip_rx (
        .clk_i(clk_i), .rst_i(rst_i), .valid_i(heard), .byte_i(heard_byte), .bad_i(noise),
        .valid_o(in_valid), .byte_o(in_byte), .end_o(in_end), .bad_o(in_bad));
    fp3_request_rx u_request_rx (
        .clk_i(clk_i), .rst_i(rst_i), .valid_i(in_valid), .byte_i(in_byte), .end_i(in_end), .bad_i(in_bad),
        .listen_i(idle), .request_o(request), .sequence_o(sequence_in), .write_o(write), .last_o(last),
        .address_o(address), .store_o(store), .store_at_o(store_at), .store_word_o(store_word));

    // From an answer to the line
    wire        answer, done, out_valid, out_ready, out_end, says, said;
    wire [7:0]  sequence_out, status, out_byte, said_byte;
    wire [6:0]  words;
    wire [5:0]  word_at;
    wire [31:0] word;
    fp3_answer_tx u_answer_tx (
        .clk_i(clk_i), .rst_i(rst_i), .answer_i(answer), .done_o(done), .sequence_i(sequence_out), .status_i(status),
        .words_i(words), .word_at_o(word_at), .word_i(word),
        .valid_o(out_valid), .ready_i(out_ready), .end_o(out_end), .byte_o(out_byte));
    fp3_slip_tx u_slip_tx (
        .clk_i(clk_i), .rst_i(rst_i), .valid_i(out_valid), .ready_o(out_ready), .end_i(out_end), .byte_i(out_byte),
        .valid_o(says), .ready_i(said), .byte_o(said_byte));
    fp3_uart_tx #(.DIVISOR(DIVISOR)) u_uart_tx (
        .clk_i(clk_i), .rst_i(rst_i), .valid_i(says), .ready_o(said), .byte_i(said_byte), .txd_o(uart_txd));

    fp3_transact #(.ADDRESS_W(ADDRESS_W)) u_transact (
        .clk_i(clk_i), .rst_i(rst_i),
        .idle_o(idle), .request_i(request), .sequence_i(sequence_in), .write_i(write), .last_i(last),
        .address_i(address),
        .store_i(store), .store_at_i(store_at), .store_word_i(store_word),
        .answer_o(answer), .done_i(done), .sequence_o(sequence_out), .status_o(status), .words_o(words),
        .word_at_i(word_at), .word_o(word),
        .m_axi_awaddr(m_axi_awaddr), .m_axi_awprot(m_axi_awprot), .m_axi_awvalid(m_axi_awvalid),
        .m_axi_awready(m_axi_awready),
        .m_axi_wdata(m_axi_wdata), .m_axi_wstrb(m_axi_wstrb), .m_axi_wvalid(m_axi_wvalid), .m_axi_wready(m_axi_wready),
        .m_axi_bresp(m_axi_bresp), .m_axi_bvalid(m_axi_bvalid), .m_axi_bready(m_axi_bready),
        .m_axi_araddr(m_axi_araddr), .m_axi_arprot(m_axi_arprot), .m_axi_arvalid(m_axi_arvalid),
        .m_axi_arready(m_axi_arready),
        .m_axi_rdata(m_axi_rdata), .m_axi_rresp(m_axi_rresp), .m_axi_rvalid(m_axi_rvalid), .m_axi_rready(m_axi_rready));
endmodule
`default_nettype wire
