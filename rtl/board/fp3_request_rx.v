// SPDX-License-Identifier: Apache-2.0
// fp3_request_rx: a request of the host, from the bytes of a packet.
//
// Purpose   Checks a packet while it arrives: command, length, CRC-32. Its words go to the bridge's
//           store at once; they count only if the packet is right at its end.
// Latency   0 from the packet's end to request_o.
// Promise   request_o is high for one cycle, for a whole and right packet only. The outputs that
//           describe the request stay until the first byte of the next packet that is received.
// Hazard    A packet whose first byte comes while listen_i is low is dropped like a bad packet.
//
//     packet     sequence  command  address (4)  word (4) ...  CRC-32 (4)  end
//     state     SEQUENCE  COMMAND  BODY                                   WHOLE
//     word_q                       0            1 ...         last
`default_nettype none
module fp3_request_rx (
    input  wire        clk_i,
    input  wire        rst_i,
    // The packet
    input  wire        valid_i,
    input  wire [7:0]  byte_i,
    input  wire        end_i,
    input  wire        bad_i,
    // The request
    input  wire        listen_i,
    output wire        request_o,
    output wire [7:0]  sequence_o,
    output wire        write_o,
    output wire [5:0]  last_o,         // the number of words - 1
    output wire [31:0] address_o,
    // A word to write
    output wire        store_o,
    output wire [5:0]  store_at_o,
    output wire [31:0] store_word_o
);
    localparam [2:0] SEQUENCE = 3'd0, COMMAND = 3'd1, BODY = 3'd2, WHOLE = 3'd3, BAD = 3'd4;
    localparam [31:0] RIGHT = 32'hdebb20e3;

    reg [2:0]  state_q;
    reg [7:0]  sequence_q;
    reg        write_q;
    reg [5:0]  last_q;
    reg [31:0] address_q, crc_q;
    reg [23:0] part_q;                 // the bytes of a word before its last
    reg [1:0]  byte_q;                 // of a word: which one
    reg [6:0]  word_q;                 // of the body: which one

    wire [31:0] word = {byte_i, part_q};
    wire [31:0] crc;
    fp3_crc32 u_crc (.crc_i(crc_q), .byte_i(byte_i), .crc_o(crc));

    wire       begins   = valid_i && state_q == SEQUENCE && listen_i;
    wire       commands = valid_i && state_q == COMMAND;
    wire       fills    = valid_i && state_q == BODY;
    wire       filled   = fills && byte_q == 2'd3;
    wire [6:0] last     = write_q ? {1'b0, last_q} + 7'd2 : 7'd1;
    reg  [2:0] next;
    always @* begin
        next = state_q;
        case (state_q)
        SEQUENCE: next = listen_i ? COMMAND : BAD;
        COMMAND:  next = byte_i[6] ? BAD : BODY;
        BODY:     next = filled && word_q == last ? WHOLE : BODY;
        default:  next = BAD;          // longer than it says
        endcase
    end
    always @(posedge clk_i) begin
        if (rst_i || end_i) {state_q, crc_q} <= {SEQUENCE, 32'hffffffff};
        else if (bad_i)     state_q <= BAD;
        else if (valid_i)   {state_q, crc_q} <= {next, crc};
        if (begins)   sequence_q <= byte_i;
        if (commands) {write_q, last_q, word_q, byte_q} <= {byte_i[7], byte_i[5:0], 7'd0, 2'd0};
        if (fills) begin
            part_q <= word[31:8];
            byte_q <= byte_q + 2'd1;
            if (filled) word_q <= word_q + 7'd1;
            if (filled && word_q == 7'd0) address_q <= word;
        end
    end

    wire [6:0] store_at = word_q - 7'd1;
    assign store_o      = filled && word_q != 7'd0 && word_q != last;
    assign store_at_o   = store_at[5:0];
    assign store_word_o = word;
    assign request_o    = end_i && !bad_i && state_q == WHOLE && crc_q == RIGHT;
    assign sequence_o   = sequence_q;
    assign write_o      = write_q;
    assign last_o       = last_q;
    assign address_o    = address_q;
    wire unused = store_at[6];
endmodule
`default_nettype wire
