// SPDX-License-Identifier: Apache-2.0
// fp3_answer_tx: the bytes of a packet, from the answer to a request.
//
// Purpose   Sends an end, sequence number, status, words, CRC-32 and an end. The first end closes
//           any noise on the line as a packet of its own.
// Latency   The first byte is offered in the first cycle of answer_i.
// Promise   done_o is high for one cycle: the last byte is taken. answer_i falls in the next.
// Hazard    word_i is the word at word_at_o of two cycles ago; the line is slower than that.
`default_nettype none
module fp3_answer_tx (
    input  wire        clk_i,
    input  wire        rst_i,
    // The answer
    input  wire        answer_i,
    output wire        done_o,
    input  wire [7:0]  sequence_i,
    input  wire [7:0]  status_i,
    input  wire [6:0]  words_i,
    output wire [5:0]  word_at_o,
    input  wire [31:0] word_i,
    // The packet
    output wire        valid_o,
    input  wire        ready_i,
    output wire        end_o,
    output wire [7:0]  byte_o
);
    localparam [2:0] OPEN = 3'd0, SEQUENCE = 3'd1, STATUS = 3'd2, WORDS = 3'd3, CHECK = 3'd4, CLOSE = 3'd5;

    reg [2:0]  state_q, next;
    reg [1:0]  byte_q;                 // of a word or of the CRC: which one
    reg [6:0]  word_q;
    reg [31:0] crc_q;

    wire        taken = answer_i && ready_i;
    wire        last  = byte_q == 2'd3;
    wire [6:0]  after = word_q + 7'd1;
    wire [31:0] part  = word_i >> {byte_q, 3'd0};
    wire [31:0] crc;
    fp3_crc32 u_crc (.crc_i(crc_q), .byte_i(byte_o), .crc_o(crc));
    always @* begin
        case (state_q)
        OPEN:     next = SEQUENCE;
        SEQUENCE: next = STATUS;
        STATUS:   next = words_i == 7'd0 ? CHECK : WORDS;
        WORDS:    next = last && after == words_i ? CHECK : WORDS;
        CHECK:    next = last ? CLOSE : CHECK;
        default:  next = OPEN;
        endcase
    end
    always @(posedge clk_i) begin
        if (rst_i)      state_q <= OPEN;
        else if (taken) state_q <= next;
        if (taken) begin
            byte_q <= state_q == WORDS || state_q == CHECK ? byte_q + 2'd1 : 2'd0;
            word_q <= state_q != WORDS ? 7'd0 : last ? after : word_q;
            crc_q  <= state_q == OPEN ? 32'hffffffff : state_q == CHECK ? {8'd0, crc_q[31:8]} : crc;
        end
    end

    assign word_at_o = word_q[5:0];
    assign valid_o   = answer_i;
    assign end_o     = state_q == OPEN || state_q == CLOSE;
    assign byte_o    = state_q == SEQUENCE ? sequence_i : state_q == STATUS ? status_i
                     : state_q == WORDS ? part[7:0] : ~crc_q[7:0];
    assign done_o    = taken && state_q == CLOSE;
    wire unused = &part[31:8];
endmodule
`default_nettype wire
