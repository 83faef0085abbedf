// SPDX-License-Identifier: Apache-2.0
// fp3_uart_rx: bytes from a serial line, 8N1 (a start bit, eight data bits with the lowest first, a
// stop bit).
//
// Purpose   Finds the start bit's falling edge, then samples the middle of each bit.
// Latency   valid_o is high for one cycle, two to three cycles after the middle of the stop bit.
// Promise   bad_o: the stop bit was low, so the byte is noise, a break, or of another baud rate.
//           The next byte begins only after the line was high again, so a break of any length is
//           one bad byte.
// Hazard    The line cannot be stopped: a byte that is not taken in its cycle is lost.
//
//     rxd_i     ‾\_s_/b0\b1\b2\ ... b7\‾p‾|      one bit = DIVISOR cycles
//     sampled      ^  ^  ^  ^       ^   ^
//     valid_o                            1
`default_nettype none
module fp3_uart_rx #(
    parameter DIVISOR = 104            // clock cycles in a bit, >= 4
) (
    input  wire       clk_i,
    input  wire       rst_i,
    input  wire       rxd_i,           // of no clock
    output wire       valid_o,
    output wire [7:0] byte_o,
    output wire       bad_o
);
    localparam W = $clog2(DIVISOR);
    localparam integer BIT = DIVISOR - 1, HALF = DIVISOR / 2 - 1;
    localparam [3:0] IDLE = 4'd0, START = 4'd1, STOP = 4'd10;

    (* ASYNC_REG = "TRUE" *)
    reg [2:0]   line_q;                // two flip-flops for metastability, and what the line was before
    reg [3:0]   bit_q;                 // which bit's middle is awaited: data bits are 2 .. 9
    reg [W-1:0] left_q;                // cycles until then
    reg [7:0]   byte_q;
    reg         valid_q, bad_q;

    wire line   = line_q[1];
    wire falls  = line_q[2] && !line;
    wire sample = bit_q != IDLE && left_q == {W{1'b0}};
    always @(posedge clk_i) begin
        if (rst_i) {line_q, bit_q, valid_q} <= {3'b111, IDLE, 1'b0};
        else begin
            line_q  <= {line_q[1:0], rxd_i};
            valid_q <= sample && bit_q == STOP;
            if (bit_q == IDLE)                bit_q <= falls ? START : IDLE;
            else if (sample)                  bit_q <= bit_q == STOP || (bit_q == START && line) ? IDLE : bit_q + 4'd1;
        end
        left_q <= bit_q == IDLE ? HALF[W-1:0] : sample ? BIT[W-1:0] : left_q - 1'b1;
        if (sample && bit_q != STOP) byte_q <= {line, byte_q[7:1]};
        if (sample) bad_q <= !line;
    end
    assign valid_o = valid_q;
    assign byte_o  = byte_q;
    assign bad_o   = bad_q;
endmodule
`default_nettype wire
