// SPDX-License-Identifier: Apache-2.0
// fp3_video_pixel: the column or the row of a position.
//
// Purpose   origin + floor(word * 2^scale), or, where rows are counted downwards, origin - floor(..).
//           Exact: the fraction is shifted, and what is shifted out makes a negative number one less.
// Latency   1 from the word and its scale; origin_i and down_i are looked at in the cycle of pixel_o.
// Ranges    far_o: the floor is 4,096 pixels or more away from 0. number_o low: infinite, or a NaN.
//           In both cases pixel_o says nothing.
`default_nettype none
module fp3_video_pixel (
    input  wire               clk_i,
    input  wire [31:0]        word_i,      // FP32
    input  wire signed [7:0]  scale_i,
    input  wire signed [11:0] origin_i,
    input  wire               down_i,      // origin - floor
    output wire               number_o,
    output wire               far_o,
    output wire signed [13:0] pixel_o
);
    wire [7:0]  exponent = word_i[30:23];
    wire        tiny     = exponent == 8'd0;                          // subnormal, or 0

    // The fraction is an integer times 2^(exponent - 150). A subnormal one goes right by 22 at least.
    // 12 places of it can be in no pixel.
    wire signed [9:0] base = 10'sd138 - $signed({2'd0, exponent | {7'd0, tiny}});
    reg               negative_q, number_q, low_q;
    reg  [11:0]       high_q;
    reg  signed [9:0] by_q;
    always @(posedge clk_i) begin
        {negative_q, number_q} <= {word_i[31], exponent != 8'd255};
        {high_q, low_q}        <= {!tiny, word_i[22:12], |word_i[11:0]};
        by_q                   <= base - $signed({{2{scale_i[7]}}, scale_i});
    end
    wire        none  = by_q > 10'sd11;                               // nothing of it is left
    wire [11:0] whole = none ? 12'd0 : high_q >> by_q[3:0];
    wire        lost  = low_q || |(none ? high_q : high_q & ~(12'hfff << by_q[3:0]));
    wire [12:0] away  = {1'b0, whole} + {12'd0, negative_q && lost};
    wire signed [13:0] amount = {1'b0, away};
    wire signed [13:0] origin = {{2{origin_i[11]}}, origin_i};

    assign number_o = number_q;
    assign far_o    = by_q < 10'sd0 || away[12];
    assign pixel_o  = negative_q != down_i ? origin - amount : origin + amount;
endmodule
`default_nettype wire
