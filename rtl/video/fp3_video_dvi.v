// SPDX-License-Identifier: Apache-2.0
// fp3_video_dvi: pixels as words of the three channels of DVI.
//
// Purpose   DVI 1.0, chapter 3: blue on channel 0 with both syncs in the blanking, green on 1, red on 2.
// Latency   One cycle from pixel_i to word_o; words stand until the next ones.
`default_nettype none
module fp3_video_dvi (
    input  wire        clk_i,
    input  wire        rst_i,
    input  wire        pixel_i,
    input  wire        visible_i,
    input  wire        hsync_i,
    input  wire        vsync_i,
    input  wire [23:0] rgb_i,
    output wire        word_o,
    output wire [29:0] words_o
);
    reg word_q;
    always @(posedge clk_i) word_q <= pixel_i && !rst_i;
    genvar c;
    generate
        for (c = 0; c < 3; c = c + 1) begin : g_channel
            fp3_video_tmds u_tmds (.clk_i(clk_i), .rst_i(rst_i), .pixel_i(pixel_i), .visible_i(visible_i), .value_i(rgb_i[8*c +: 8]),
                .control_i(c == 0 ? {vsync_i, hsync_i} : 2'b00), .word_o(words_o[10*c +: 10]));
        end
    endgenerate
    assign word_o = word_q;
endmodule
`default_nettype wire
