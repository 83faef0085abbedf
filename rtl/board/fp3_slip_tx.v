// SPDX-License-Identifier: Apache-2.0
// fp3_slip_tx: bytes of a line, from bytes of packets (SLIP, RFC 1055).
//
// Purpose   The other end of slip_rx.
// Latency   0; a byte that has to be escaped is taken after two bytes of the line.
// Hazard    A byte that is offered stands until it is taken.
`default_nettype none
module fp3_slip_tx (
    input  wire       clk_i,
    input  wire       rst_i,
    // The packet
    input  wire       valid_i,
    output wire       ready_o,
    input  wire       end_i,           // an end, in place of a byte
    input  wire [7:0] byte_i,
    // The line
    output wire       valid_o,
    input  wire       ready_i,
    output wire [7:0] byte_o
);
    localparam [7:0] END = 8'hc0, ESCAPE = 8'hdb, AS_END = 8'hdc, AS_ESCAPE = 8'hdd;

    reg  escape_q;                     // the ESCAPE has been sent
    wire special = !end_i && (byte_i == END || byte_i == ESCAPE);
    wire escape  = special && !escape_q;
    always @(posedge clk_i)
        if (rst_i)                   escape_q <= 1'b0;
        else if (valid_i && ready_i) escape_q <= escape;

    assign valid_o = valid_i;
    assign ready_o = ready_i && !escape;
    assign byte_o  = end_i ? END : escape ? ESCAPE : !special ? byte_i : byte_i == END ? AS_END : AS_ESCAPE;
endmodule
`default_nettype wire
