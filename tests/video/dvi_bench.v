// dvi_bench: pixels into fp3_video_dvi and fp3_pictures_serial; prints them, and the bits of the four lines.
//
//     p VISIBLE SYNCS RGB      a pixel
//     b CRGB                   one bit of each line: clock, red, green, blue
//     a NS                     how long words have stood when the shift registers take them
`timescale 1ns/1ps
`default_nettype none
// The lower bit goes out while the clock is high.
module ODDRX1F (
    input  wire SCLK, RST, D0, D1,
    output wire Q
);
    reg high_q, low_q;
    always @(posedge SCLK) {high_q, low_q} <= {D0 && !RST, D1 && !RST};
    assign Q = SCLK ? high_q : low_q;
endmodule

module dvi_bench;
    parameter LATE = 0;                // ns
    reg         clk = 1'b0, bit_clk = 1'b0, rst = 1'b1, pixel = 1'b0, visible = 1'b0, hsync = 1'b0, vsync = 1'b0;
    reg  [23:0] rgb = 24'd0;
    wire        word;
    wire [29:0] words;
    wire [3:0]  lines;
    integer     i, seed = 1, left = 0, came = 0, taken = 0;
    fp3_video_dvi u_dvi (.clk_i(clk), .rst_i(rst), .pixel_i(pixel), .visible_i(visible), .hsync_i(hsync), .vsync_i(vsync), .rgb_i(rgb),
        .word_o(word), .words_o(words));
    fp3_pictures_serial u_serial (.clk_i(clk), .rst_i(rst), .word_i(word), .words_i({10'b0000011111, words}), .bit_clk_i(bit_clk), .lines_o(lines));

    always #10 clk = !clk;
    initial begin
        #(8 - LATE);
        forever #4 bit_clk = !bit_clk;
    end
    always @(bit_clk) begin
        #2 if (!rst) $display("b %b", lines);
    end

    always @(u_serial.toggle_q) came = $time;
    always @(posedge bit_clk)
        if (came != 0 && u_serial.cycle_q == 3'd4) begin
            taken = taken + 1;
            if (taken > 3) $display("a %0d", $time - came);
        end

    // As in fp3_pictures_top, where the first words leave four cycles after the reset.
    initial begin
        repeat (8) @(posedge clk);
        rst <= 1'b0;
        repeat (3) @(negedge clk);
        for (i = 0; i < 2200; i = i + 1) begin
            if (left == 0) begin
                visible = !visible;
                left = visible ? 1 + $unsigned($random(seed)) % 200 : 1 + $unsigned($random(seed)) % 20;
            end
            left = left - 1;
            {hsync, vsync, rgb} = $random(seed);
            if (i % 300 > 250) rgb = {8{i[2:0]}};
            if (!visible) $display("p 0 %h 000000", {vsync, hsync});
            else          $display("p 1 0 %h", rgb);
            pixel = 1'b1;
            @(negedge clk) pixel = 1'b0;
            @(negedge clk);
        end
        $finish;
    end
endmodule
`default_nettype wire
