// SPDX-License-Identifier: Apache-2.0
// fp3_uart_tx: bytes onto a serial line, 8N1 (a start bit, eight data bits with the lowest first, a
// stop bit).
//
// Purpose   The other end of uart_rx.
// Latency   The start bit begins in the cycle after a byte is taken; the next byte is taken when
//           the stop bit is over.
// Promise   txd_o comes straight from a flip-flop, so the line has no glitches; it is high when
//           nothing is sent.
`default_nettype none
module fp3_uart_tx #(
    parameter DIVISOR = 104            // clock cycles in a bit, >= 4
) (
    input  wire       clk_i,
    input  wire       rst_i,
    input  wire       valid_i,
    output wire       ready_o,
    input  wire [7:0] byte_i,
    output wire       txd_o
);
    localparam W = $clog2(DIVISOR);
    localparam integer BIT = DIVISOR - 1;

    reg [3:0]   bits_q;                // bits still to go, the one on the line included
    reg [W-1:0] left_q;                // cycles that it still has
    reg [8:0]   line_q;                // the bit on the line, and the bits after it
    initial line_q = 9'h1ff;

    wire over = left_q == {W{1'b0}};
    assign ready_o = !rst_i && bits_q == 4'd0;
    always @(posedge clk_i) begin
        if (rst_i) {bits_q, line_q} <= {4'd0, 9'h1ff};
        else if (valid_i && ready_o) {bits_q, line_q} <= {4'd10, byte_i, 1'b0};
        else if (bits_q != 4'd0 && over) {bits_q, line_q} <= {bits_q - 4'd1, 1'b1, line_q[8:1]};
        left_q <= ready_o || over ? BIT[W-1:0] : left_q - 1'b1;
    end
    assign txd_o = line_q[0];
endmodule
`default_nettype wire
