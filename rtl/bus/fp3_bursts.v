// SPDX-License-Identifier: Apache-2.0
// fp3_bursts: the bursts of AXI4 that a range of memory is moved in.
//
// Purpose   Part of transfer: the address channel of reads or of writes. A burst has up to 256 words
//           of 32 bits and ends where its address is a multiple of 1 KB, or where the range ends.
//           So none crosses 4 KB, and who moves the words knows the last one of a burst by its
//           address alone.
// Latency   A burst is asked for two cycles after start_i, the next one two cycles after the one
//           before was taken.
// Promise   The bursts are the range: each word once, in order. What is asked for stays until it is
//           taken. After stop_i no other burst is asked for.
// Hazard    start_i only while over_o.
//
//     cycle      0     1     2     3     4
//     start_i    1     0                         address_i = 0x7fc, words_i = 3
//     valid_o    0     0     1     0     1       ready_i = 1
//     address_o              7fc         800
//     length_o               0           1       beats - 1
`default_nettype none
module fp3_bursts #(
    parameter WORDS_W = 24             // bits of a number of words, above 8
) (
    input  wire               clk_i,
    input  wire               rst_i,
    input  wire               start_i,
    input  wire [31:2]        address_i,
    input  wire [WORDS_W-1:0] words_i,
    input  wire               room_i,         // another burst may be asked for
    input  wire               stop_i,
    output wire               over_o,         // nothing is asked for, nor will be
    // The channel
    output wire               valid_o,
    input  wire               ready_i,
    output wire [31:2]        address_o,
    output wire [7:0]         length_o
);
    reg                valid_q;
    reg  [31:2]        address_q;
    reg  [7:0]         length_q;
    reg  [WORDS_W-1:0] left_q;         // words from this address on
    wire               none = left_q == {WORDS_W{1'b0}};
    wire               goes = valid_o && ready_i;
    wire [7:0]         up   = ~address_q[9:2];                // words up to 1 KB, less one
    wire               ends = left_q <= {{WORDS_W-8{1'b0}}, up};
    always @(posedge clk_i) begin
        if (rst_i)                     valid_q <= 1'b0;
        else if (valid_q)              valid_q <= !ready_i;
        else                           valid_q <= !none && room_i && !stop_i;
        if (!valid_q)                  length_q <= ends ? left_q[7:0] - 8'd1 : up;
        if (start_i)                   address_q <= address_i;
        else if (goes)                 address_q <= {address_q[31:10] + 22'd1, 8'd0};
        if (rst_i)                     left_q <= {WORDS_W{1'b0}};
        else if (start_i)              left_q <= words_i;
        else if (goes)                 left_q <= left_q - {{WORDS_W-8{1'b0}}, length_q} - {{WORDS_W-1{1'b0}}, 1'b1};
        else if (stop_i && !valid_q)   left_q <= {WORDS_W{1'b0}};
    end
    assign over_o    = !valid_q && none;
    assign valid_o   = valid_q;
    assign address_o = address_q;
    assign length_o  = length_q;
endmodule
`default_nettype wire
