// SPDX-License-Identifier: Apache-2.0
// fp3_video_tmds: the encoder of one channel of DVI.
//
// Purpose   DVI 1.0, 3.2 and figure 3-5: eight bits become nine with few transitions, by XOR or XNOR of
//           neighbours, then ten: they are inverted where that brings as many ones as zeros onto the
//           line. In the blanking one of four words says two control bits.
// Latency   One cycle from pixel_i; the word stands until the next one.
`default_nettype none
module fp3_video_tmds (
    input  wire       clk_i,
    input  wire       rst_i,
    input  wire       pixel_i,
    input  wire       visible_i,
    input  wire [7:0] value_i,
    input  wire [1:0] control_i,
    output wire [9:0] word_o
);
    function [3:0] ones(input [7:0] of);
        ones = {3'd0, of[0]} + {3'd0, of[1]} + {3'd0, of[2]} + {3'd0, of[3]} + {3'd0, of[4]} + {3'd0, of[5]} + {3'd0, of[6]} + {3'd0, of[7]};
    endfunction

    wire [3:0] set   = ones(value_i);
    wire       alike = set > 4'd4 || (set == 4'd4 && !value_i[0]);     // XNOR
    // Bit i is the parity of the bits up to i; with XNOR every second one is inverted.
    wire [7:0] parity = {^value_i[7:0], ^value_i[6:0], ^value_i[5:0], ^value_i[4:0], ^value_i[3:0], ^value_i[2:0], ^value_i[1:0], value_i[0]};
    wire [7:0] few    = parity ^ (alike ? 8'haa : 8'h00);

    // Both are halves: how many ones more than zeros the eight bits have, and all words before.
    reg  signed [4:0] balance_q;
    wire signed [4:0] more   = $signed({1'b0, ones(few)}) - 5'sd4;
    wire              even   = balance_q == 5'sd0 || more == 5'sd0;
    wire              invert = even ? alike : balance_q[4] == more[4];
    wire signed [4:0] change = (invert ? -more : more) + (even ? 5'sd0 : invert ? {4'd0, !alike} : -{4'd0, alike});
    reg  [9:0]        word_q;
    always @(posedge clk_i)
        if (rst_i) begin
            balance_q <= 5'sd0;
            word_q    <= 10'd0;
        end else if (pixel_i) begin
            balance_q <= visible_i ? balance_q + change : 5'sd0;
            if (visible_i)
                word_q <= {invert, !alike, invert ? ~few : few};
            else
                case (control_i)
                2'd0:    word_q <= 10'b1101010100;
                2'd1:    word_q <= 10'b0010101011;
                2'd2:    word_q <= 10'b0101010100;
                default: word_q <= 10'b1010101011;
                endcase
        end
    assign word_o = word_q;
endmodule
`default_nettype wire
