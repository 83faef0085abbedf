// SPDX-License-Identifier: Apache-2.0
// fp3_video_rows: draws one row of the picture while the row before it is shown.
//
// Purpose   Goes through the places of all objects. Where one's shape has pixels in this row, these
//           go to a line buffer, one in a cycle; an object with a higher number lies above.
//
//           shape_i   digit d (of 16) is for the rows d above and d below an object's own: 0 no pixel,
//                     n the pixels from n - 1 to its left up to n - 1 to its right
//
// Latency   At most a cycle for each object and one for each of its pixels in this row: objects without
//           any are passed while pixels are drawn.
// Promise   When the line ends before all is drawn, or there is nothing to draw from, unfinished_o is
//           high while this row is shown.
// Hazard    Nothing is drawn while busy_i. The memory of places keeps what it read.
`default_nettype none
module fp3_video_rows #(
    parameter OBJECTS_W = 10,
    parameter WIDTH     = 640
) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    // In the last cycle of a line: what is to be drawn in the next one
    input  wire                 ends_i,
    input  wire                 draw_i,
    input  wire [8:0]           row_i,
    input  wire                 shows_i,         // there is something to draw from
    input  wire                 busy_i,
    output wire                 unfinished_o,
    // Settings
    input  wire [OBJECTS_W:0]   objects_i,
    input  wire [31:0]          shape_i,
    input  wire [3:0]           shift_i,         // an object's colour: its number, shifted to the right
    // The memory of places
    output wire                 read_o,
    output wire [OBJECTS_W-1:0] read_number_o,
    input  wire [18:0]          place_i,         // {y, x}, 8 and 32 more than the pixel's
    // The line buffer
    output wire                 pixel_o,
    output wire [9:0]           pixel_x_o,
    output wire [3:0]           pixel_colour_o
);
    localparam integer LEFT = 32, RIGHT = WIDTH + 32;

    reg                 draws_q, blind_q, unfinished_q;
    reg  [8:0]          row_q;
    // An object goes through two stages: its place is read; it is known whether it has pixels here.
    reg  [OBJECTS_W:0]  next_q;
    reg                 read_q, known_q, hit_q;
    reg  [OBJECTS_W-1:0] read_number_q;
    reg  [3:0]          half_q, known_colour_q;
    reg  [9:0]          known_x_q;
    // The pixels that are drawn
    reg                 runs_q;
    reg  [9:0]          x_q;
    reg  [4:0]          left_q;
    reg  [3:0]          colour_q;

    wire signed [9:0]   below = $signed({1'b0, row_q}) + 10'sd8 - $signed({1'b0, place_i[18:10]});
    wire [9:0]          away  = below[9] ? -below : below;
    wire [3:0]          half  = away[9:3] == 7'd0 ? shape_i[{away[2:0], 2'd0} +: 4] : 4'd0;
    wire [OBJECTS_W+15:0] colours = {16'd0, read_number_q} >> shift_i;

    wire                starts = known_q && hit_q && (!runs_q || left_q == 5'd1);
    wire                free   = !known_q || !hit_q || starts;            // of the second stage
    wire                more   = next_q != objects_i;
    wire                fetch  = draws_q && !blind_q && !busy_i && more && (!read_q || free);
    wire                over   = !more && !read_q && !known_q && !runs_q;
    always @(posedge clk_i) begin
        if (rst_i || ends_i) begin
            {read_q, known_q, runs_q} <= 3'd0;
            next_q <= {OBJECTS_W+1{1'b0}};
        end else begin
            read_q  <= fetch || (read_q && !free);
            known_q <= free ? read_q : known_q;
            runs_q  <= starts || (runs_q && left_q != 5'd1);
            if (fetch) next_q <= next_q + 1'b1;
        end
        if (fetch) read_number_q <= next_q[OBJECTS_W-1:0];
        if (free)  {hit_q, half_q, known_x_q, known_colour_q} <= {half != 4'd0, half, place_i[9:0], colours[3:0]};
        if (starts) {x_q, left_q, colour_q} <= {known_x_q - {6'd0, half_q} + 10'd1, {half_q, 1'b0} - 5'd1, known_colour_q};
        else        {x_q, left_q} <= {x_q + 10'd1, left_q - 5'd1};
        if (rst_i) begin
            {draws_q, blind_q, unfinished_q} <= 3'd0;
        end else if (ends_i) begin
            draws_q      <= draw_i;
            blind_q      <= !shows_i;
            unfinished_q <= draws_q && (blind_q || !over);
        end
        if (ends_i) row_q <= row_i;
    end
    assign unfinished_o   = unfinished_q;
    assign read_o         = fetch;
    assign read_number_o  = next_q[OBJECTS_W-1:0];
    assign pixel_o        = runs_q && x_q >= LEFT[9:0] && x_q < RIGHT[9:0];
    assign pixel_x_o      = x_q - LEFT[9:0];
    assign pixel_colour_o = colour_q;
    wire unused = &colours;
endmodule
`default_nettype wire
