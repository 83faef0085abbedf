// SPDX-License-Identifier: Apache-2.0
// fp3_slip_rx: bytes of packets, from bytes of a line (SLIP, RFC 1055).
//
// Purpose   8'hc0 ends a packet; 8'hdb 8'hdc stands for a 8'hc0 within it, 8'hdb 8'hdd for a 8'hdb.
// Latency   0
// Promise   bad_o: a byte is bad, or an escape is broken, so the packet is worthless. An end counts
//           even if it breaks an escape, so the next packet is whole.
`default_nettype none
module fp3_slip_rx (
    input  wire       clk_i,
    input  wire       rst_i,
    // The line
    input  wire       valid_i,
    input  wire [7:0] byte_i,
    input  wire       bad_i,
    // The packet
    output wire       valid_o,
    output wire [7:0] byte_o,
    output wire       end_o,
    output wire       bad_o
);
    localparam [7:0] END = 8'hc0, ESCAPE = 8'hdb, AS_END = 8'hdc, AS_ESCAPE = 8'hdd;

    reg  escape_q;                     // the byte before was an ESCAPE
    wire good    = valid_i && !bad_i;
    wire escape  = good && byte_i == ESCAPE && !escape_q;
    wire escaped = byte_i == AS_END || byte_i == AS_ESCAPE;
    always @(posedge clk_i)
        if (rst_i)        escape_q <= 1'b0;
        else if (valid_i) escape_q <= escape;

    assign end_o   = good && byte_i == END;
    assign bad_o   = valid_i && (bad_i || (escape_q && !escaped));
    assign valid_o = good && !end_o && !escape && !bad_o;
    assign byte_o  = !escape_q ? byte_i : byte_i == AS_END ? END : ESCAPE;
endmodule
`default_nettype wire
