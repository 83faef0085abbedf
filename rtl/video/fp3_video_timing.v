// SPDX-License-Identifier: Apache-2.0
// fp3_video_timing: where in a frame the pixel is, and the two sync signals.
//
// Purpose   640x480 at 60 Hz: VESA's DMT, identifier 0x04, whose borders are counted as porches; CEA-861
//           has the same format as VIC 1. Both syncs are negative, so they are low where sync_o is high.
//           The leading edge of the vertical sync is one of the horizontal sync.
//
//           pixels   640 visible, 16 front porch, 96 sync, 48 back porch: 800
//           lines    480 visible, 10 front porch,  2 sync, 33 back porch: 525
//
// Promise   Every pixel has TICKS cycles, and tick_o is high in the first one. In the last cycle of a
//           line ends_o is high, and next_o is the number of the line that follows.
// Reset     The frame begins with its blanking.
`default_nettype none
module fp3_video_timing #(
    parameter TICKS   = 2,             // clock cycles in a pixel
    parameter WIDTH   = 640, H_FRONT = 16, H_SYNC = 96, H_BACK = 48,    // 1023 in all, at most
    parameter HEIGHT  = 480, V_FRONT = 10, V_SYNC = 2,  V_BACK = 33
) (
    input  wire       clk_i,
    input  wire       rst_i,
    output wire       tick_o,
    output wire [9:0] x_o,
    output wire       ends_o,
    output wire [9:0] next_o,
    output wire       across_o,        // x_o is in the picture
    output wire       visible_o,       // the pixel is
    output wire       hsync_o,
    output wire       vsync_o
);
    localparam integer COLUMNS = WIDTH + H_FRONT + H_SYNC + H_BACK, LINES = HEIGHT + V_FRONT + V_SYNC + V_BACK;
    localparam integer SYNC = WIDTH + H_FRONT, SYNC_END = SYNC + H_SYNC;                      // in a line
    localparam integer DOWN = HEIGHT + V_FRONT - 1, DOWN_END = DOWN + V_SYNC;                 // from SYNC of this line
    localparam integer LAST_TICK = TICKS - 1, LAST_COLUMN = COLUMNS - 1, LAST_LINE = LINES - 1;
    localparam TICK_W = TICKS > 1 ? $clog2(TICKS) : 1;

    reg [TICK_W-1:0] tick_q;
    reg [9:0]        x_q, y_q;
    wire             pixel_ends = tick_q == LAST_TICK[TICK_W-1:0];
    wire             line_ends  = pixel_ends && x_q == LAST_COLUMN[9:0];
    wire [9:0]       next       = y_q == LAST_LINE[9:0] ? 10'd0 : y_q + 10'd1;
    wire             late       = x_q >= SYNC[9:0];
    always @(posedge clk_i)
        if (rst_i) begin
            tick_q <= {TICK_W{1'b0}};
            x_q    <= 10'd0;
            y_q    <= HEIGHT[9:0];
        end else begin
            tick_q <= pixel_ends ? {TICK_W{1'b0}} : tick_q + 1'b1;
            if (pixel_ends) x_q <= line_ends ? 10'd0 : x_q + 10'd1;
            if (line_ends)  y_q <= next;
        end
    assign tick_o    = tick_q == {TICK_W{1'b0}};
    assign x_o       = x_q;
    assign ends_o    = line_ends;
    assign next_o    = next;
    assign across_o  = x_q < WIDTH[9:0];
    assign visible_o = across_o && y_q < HEIGHT[9:0];
    assign hsync_o   = late && x_q < SYNC_END[9:0];
    assign vsync_o   = (y_q > DOWN[9:0] || (y_q == DOWN[9:0] && late)) && (y_q < DOWN_END[9:0] || (y_q == DOWN_END[9:0] && !late));
endmodule
`default_nettype wire
