// SPDX-License-Identifier: Apache-2.0
// fp3_video_lines: two line buffers: one is shown, and cleared behind the beam; one is drawn.
//
// Latency   1 from show_i to pixel_o, which then stands until the next one.
// Promise   What was shown once is empty: in each line all pixels are shown, also in the blanking. So
//           whatever is in the memories at power-up is gone before the first row is drawn.
// Hazard    bank_i changes between two lines.
`default_nettype none
module fp3_video_lines #(
    parameter W = 4                    // of a pixel's colour
) (
    input  wire         clk_i,
    input  wire         bank_i,        // the one that is shown
    input  wire         show_i,
    input  wire [9:0]   show_x_i,
    output wire         there_o,       // an object is there
    output wire [W-1:0] colour_o,
    input  wire         draw_i,
    input  wire [9:0]   draw_x_i,
    input  wire [W-1:0] draw_colour_i
);
    reg          clear_q;
    reg  [9:0]   clear_x_q;
    wire [W:0]   value [0:1];
    always @(posedge clk_i) {clear_q, clear_x_q} <= {show_i, show_x_i};
    genvar b;
    generate
        for (b = 0; b < 2; b = b + 1) begin : g_bank
            wire shown = bank_i == (b == 1);
            fp3_ram_1r1w #(.ADDR_W(10), .W(W + 1)) u_ram (.clk_i(clk_i),
                .write_i(shown ? clear_q : draw_i), .write_addr_i(shown ? clear_x_q : draw_x_i),
                .write_value_i(shown ? {W+1{1'b0}} : {1'b1, draw_colour_i}),
                .read_i(shown && show_i), .read_addr_i(show_x_i), .read_value_o(value[b]));
        end
    endgenerate
    assign {there_o, colour_o} = value[bank_i];
endmodule
`default_nettype wire
