// SPDX-License-Identifier: Apache-2.0
// fp3_pictures: between a host and the processor's bus; draws the objects that are in the processor.
//
// Purpose   In the blanking between two frames, when no run is under way, all positions are read over
//           the processor's own bus, where the host's requests go as well; then each row is drawn
//           while the one before is shown. There is no frame buffer. docs/pictures.md is the guide.
//
//           host ──► axi_lite ──┬───────────────────────► turns ──► video_port ──► processor
//                               └► video_registers ► video_reader ─┘
//                                                         │ places
//           video_timing ──────────────────────────► video_rows ──► video_lines ──► pixels
//
// Window    Addresses of s_axi have a bit more than the processor's: 1 for the registers here.
// Latency   Three cycles more than the processor's bus for a host's access, and while positions are
//           read as long as that takes. A pixel leaves two cycles after video_timing
//           has it.
// Promise   As axi_lite for the host, whose accesses are one at a time; a run begins before or after
//           positions are read. A row in which not all objects are drawn has the colour of warnings
//           where no object is, and is counted.
`default_nettype none
module fp3_pictures #(
    parameter ADDRESS_W = 18,          // of the processor, 18 to 26
    parameter TICKS     = 2,           // clock cycles in a pixel
    parameter OBJECTS_W = 10,          // 2^OBJECTS_W objects at most
    parameter WIDTH     = 640, H_FRONT = 16, H_SYNC = 96, H_BACK = 48,  // WIDTH at most 978, and 1,023 in all
    parameter HEIGHT    = 480, V_FRONT = 10, V_SYNC = 2,  V_BACK = 33,  // HEIGHT at most 495, and 1,023 in all
    parameter SPARE     = 10           // lines before the picture in which reading does not begin
) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    // The host
    input  wire [ADDRESS_W:0]   s_axi_awaddr,
    input  wire                 s_axi_awvalid,
    output wire                 s_axi_awready,
    input  wire [31:0]          s_axi_wdata,
    input  wire [3:0]           s_axi_wstrb,
    input  wire                 s_axi_wvalid,
    output wire                 s_axi_wready,
    output wire [1:0]           s_axi_bresp,
    output wire                 s_axi_bvalid,
    input  wire                 s_axi_bready,
    input  wire [ADDRESS_W:0]   s_axi_araddr,
    input  wire                 s_axi_arvalid,
    output wire                 s_axi_arready,
    output wire [31:0]          s_axi_rdata,
    output wire [1:0]           s_axi_rresp,
    output wire                 s_axi_rvalid,
    input  wire                 s_axi_rready,
    // The processor
    output wire [ADDRESS_W-1:0] m_axi_awaddr,
    output wire [2:0]           m_axi_awprot,
    output wire                 m_axi_awvalid,
    input  wire                 m_axi_awready,
    output wire [31:0]          m_axi_wdata,
    output wire [3:0]           m_axi_wstrb,
    output wire                 m_axi_wvalid,
    input  wire                 m_axi_wready,
    input  wire [1:0]           m_axi_bresp,
    input  wire                 m_axi_bvalid,
    output wire                 m_axi_bready,
    output wire [ADDRESS_W-1:0] m_axi_araddr,
    output wire [2:0]           m_axi_arprot,
    output wire                 m_axi_arvalid,
    input  wire                 m_axi_arready,
    input  wire [31:0]          m_axi_rdata,
    input  wire [1:0]           m_axi_rresp,
    input  wire                 m_axi_rvalid,
    output wire                 m_axi_rready,
    // The picture
    output wire                 pixel_o,         // the first cycle of a pixel
    output wire                 visible_o,       // outside of the picture rgb_o is black
    output wire                 hsync_o,         // both negative
    output wire                 vsync_o,
    output wire [23:0]          rgb_o            // {red, green, blue}
);
    localparam OPEN_W = 6;                       // more than the processor's bus accepts
    localparam integer LINES = HEIGHT + V_FRONT + V_SYNC + V_BACK, LATEST = LINES - SPARE;

    // ---- the host's requests, here or to the processor ----
    wire               host_valid, host_ready, host_write, hub_ready, moves;
    wire [ADDRESS_W:0] host_addr;
    wire [31:0]        host_wdata;
    wire               told, told_write, told_error;
    wire [31:0]        told_rdata;
    wire               wrote, write_error, read, read_error;
    wire [31:0]        rdata;
    wire               ours = host_addr[ADDRESS_W];
    fp3_axi_lite #(.ADDRESS_W(ADDRESS_W + 1)) u_axi (.clk_i(clk_i), .rst_i(rst_i),
        .s_axi_awvalid(s_axi_awvalid), .s_axi_awready(s_axi_awready), .s_axi_awaddr(s_axi_awaddr),
        .s_axi_wvalid(s_axi_wvalid), .s_axi_wready(s_axi_wready), .s_axi_wdata(s_axi_wdata), .s_axi_wstrb(s_axi_wstrb),
        .s_axi_bvalid(s_axi_bvalid), .s_axi_bready(s_axi_bready), .s_axi_bresp(s_axi_bresp),
        .s_axi_arvalid(s_axi_arvalid), .s_axi_arready(s_axi_arready), .s_axi_araddr(s_axi_araddr),
        .s_axi_rvalid(s_axi_rvalid), .s_axi_rready(s_axi_rready), .s_axi_rdata(s_axi_rdata), .s_axi_rresp(s_axi_rresp),
        .req_valid_o(host_valid), .req_ready_i(host_ready), .req_write_o(host_write), .req_addr_o(host_addr), .req_wdata_o(host_wdata),
        .wrote_i((wrote && !moves) || (told && told_write)), .write_error_i(told ? told_error : write_error),
        .read_i((read && !moves) || (told && !told_write)), .read_error_i(told ? told_error : read_error),
        .rdata_i(told ? told_rdata : rdata));
    assign host_ready = ours || hub_ready;

    // ---- settings ----
    wire                  on, hold, busy, shows, taken;
    wire [ADDRESS_W-1:0]  x, y, upper;
    wire [15:0]           step;
    wire [OBJECTS_W:0]    objects, outside, numberless;
    wire [3:0]            shift;
    wire signed [11:0]    x_origin, y_origin;
    wire signed [7:0]     x_scale, y_scale;
    wire [31:0]           shape;
    wire [23:0]           background, warning, paint_value;
    wire                  paint;
    wire [3:0]            paint_number;
    reg  [31:0]           frames_q, taken_q;
    reg  [9:0]            unfinished_q, counted_q;
    fp3_video_registers #(.ADDRESS_W(ADDRESS_W), .OBJECTS_W(OBJECTS_W)) u_registers (.clk_i(clk_i), .rst_i(rst_i),
        .ask_i(host_valid && ours), .ask_write_i(host_write), .ask_addr_i(host_addr[ADDRESS_W-1:0]), .ask_wdata_i(host_wdata),
        .told_o(told), .told_write_o(told_write), .told_error_o(told_error), .told_rdata_o(told_rdata),
        .on_o(on), .hold_o(hold), .x_o(x), .y_o(y), .upper_o(upper), .step_o(step), .objects_o(objects), .shift_o(shift),
        .x_origin_o(x_origin), .y_origin_o(y_origin), .x_scale_o(x_scale), .y_scale_o(y_scale), .shape_o(shape),
        .background_o(background), .warning_o(warning),
        .colour_o(paint), .colour_number_o(paint_number), .colour_value_o(paint_value),
        .shows_i(shows), .busy_i(busy), .frames_i(frames_q), .taken_i(taken_q), .outside_i(outside), .numberless_i(numberless),
        .unfinished_i(unfinished_q));

    // ---- positions ----
    wire                  move_valid, move_ready, move_streams, place;
    wire [ADDRESS_W-1:0]  move_addr;
    wire [OBJECTS_W-1:0]  place_number;
    wire [18:0]           place_value;
    wire                  tick, across, visible, hsync, vsync, ends;
    wire [9:0]            column, next;
    reg                   old_q;                 // positions have not been read in this blanking
    wire                  blank = next >= HEIGHT[9:0] && next < LATEST[9:0];
    fp3_video_reader #(.ADDRESS_W(ADDRESS_W), .OBJECTS_W(OBJECTS_W), .WIDTH(WIDTH), .HEIGHT(HEIGHT)) u_reader (.clk_i(clk_i), .rst_i(rst_i),
        .on_i(on), .begin_i(ends && blank && !hold && (old_q || next == HEIGHT[9:0])), .busy_o(busy), .shows_o(shows), .taken_o(taken),
        .x_i(x), .y_i(y), .upper_i(upper), .step_i(step), .objects_i(objects),
        .x_origin_i(x_origin), .y_origin_i(y_origin), .x_scale_i(x_scale), .y_scale_i(y_scale),
        .outside_o(outside), .numberless_o(numberless),
        .req_valid_o(move_valid), .req_ready_i(move_ready), .req_streams_o(move_streams), .req_addr_o(move_addr),
        .answer_i(read && moves), .answer_error_i(read_error), .answer_rdata_i(rdata),
        .place_o(place), .place_number_o(place_number), .place_value_o(place_value));

    // While the reader has its turn and asks, turns does not see the host, who could start a run.
    wire                  req_valid, req_ready, req_write;
    wire [ADDRESS_W-1:0]  req_addr;
    wire [31:0]           req_wdata;
    wire [OPEN_W-1:0]     open_unused;
    fp3_turns #(.W(ADDRESS_W + 32), .OPEN_W(OPEN_W)) u_turns (.clk_i(clk_i), .rst_i(rst_i),
        .host_valid_i(host_valid && !ours && !(moves && move_valid)), .host_ready_o(hub_ready), .host_write_i(host_write),
        .host_what_i({host_addr[ADDRESS_W-1:0], host_wdata}),
        .move_valid_i(move_valid), .move_ready_o(move_ready), .move_streams_i(move_streams), .move_write_i(1'b0),
        .move_what_i({move_addr, 32'd0}), .moves_o(moves), .open_o(open_unused),
        .req_valid_o(req_valid), .req_ready_i(req_ready), .req_write_o(req_write), .req_what_o({req_addr, req_wdata}),
        .wrote_i(wrote), .read_i(read));
    fp3_video_port #(.ADDRESS_W(ADDRESS_W)) u_port (.clk_i(clk_i), .rst_i(rst_i),
        .req_valid_i(req_valid), .req_ready_o(req_ready), .req_write_i(req_write), .req_addr_i(req_addr), .req_wdata_i(req_wdata),
        .wrote_o(wrote), .write_error_o(write_error), .read_o(read), .read_error_o(read_error), .rdata_o(rdata),
        .m_axi_awaddr(m_axi_awaddr), .m_axi_awprot(m_axi_awprot), .m_axi_awvalid(m_axi_awvalid), .m_axi_awready(m_axi_awready),
        .m_axi_wdata(m_axi_wdata), .m_axi_wstrb(m_axi_wstrb), .m_axi_wvalid(m_axi_wvalid), .m_axi_wready(m_axi_wready),
        .m_axi_bresp(m_axi_bresp), .m_axi_bvalid(m_axi_bvalid), .m_axi_bready(m_axi_bready),
        .m_axi_araddr(m_axi_araddr), .m_axi_arprot(m_axi_arprot), .m_axi_arvalid(m_axi_arvalid), .m_axi_arready(m_axi_arready),
        .m_axi_rdata(m_axi_rdata), .m_axi_rresp(m_axi_rresp), .m_axi_rvalid(m_axi_rvalid), .m_axi_rready(m_axi_rready));

    // ---- rows ----
    wire                  rows_read, draw, there, unfinished;
    wire [OBJECTS_W-1:0]  rows_number;
    wire [18:0]           rows_place;
    wire [9:0]            draw_x;
    wire [3:0]            draw_colour, colour;
    wire [23:0]           painted;
    reg                   bank_q;
    // Behind the line that begins comes the row that is drawn meanwhile.
    wire [9:0]            after = next == LINES[9:0] - 10'd1 ? 10'd0 : next + 10'd1;
    fp3_video_timing #(.TICKS(TICKS), .WIDTH(WIDTH), .H_FRONT(H_FRONT), .H_SYNC(H_SYNC), .H_BACK(H_BACK),
        .HEIGHT(HEIGHT), .V_FRONT(V_FRONT), .V_SYNC(V_SYNC), .V_BACK(V_BACK)) u_timing (.clk_i(clk_i), .rst_i(rst_i),
        .tick_o(tick), .x_o(column), .ends_o(ends), .next_o(next), .across_o(across), .visible_o(visible), .hsync_o(hsync), .vsync_o(vsync));
    fp3_ram_1r1w #(.ADDR_W(OBJECTS_W), .W(19)) u_places (.clk_i(clk_i),
        .write_i(place), .write_addr_i(place_number), .write_value_i(place_value),
        .read_i(rows_read), .read_addr_i(rows_number), .read_value_o(rows_place));
    fp3_video_rows #(.OBJECTS_W(OBJECTS_W), .WIDTH(WIDTH)) u_rows (.clk_i(clk_i), .rst_i(rst_i),
        .ends_i(ends), .draw_i(on && after < HEIGHT[9:0]), .row_i(after[8:0]), .shows_i(shows), .busy_i(busy), .unfinished_o(unfinished),
        .objects_i(objects), .shape_i(shape), .shift_i(shift),
        .read_o(rows_read), .read_number_o(rows_number), .place_i(rows_place),
        .pixel_o(draw), .pixel_x_o(draw_x), .pixel_colour_o(draw_colour));
    fp3_video_lines #(.W(4)) u_lines (.clk_i(clk_i), .bank_i(bank_q), .show_i(tick && across), .show_x_i(column),
        .there_o(there), .colour_o(colour), .draw_i(draw), .draw_x_i(draw_x), .draw_colour_i(draw_colour));
    fp3_lutram_1r1w #(.ADDR_W(4), .W(24)) u_colours (.clk_i(clk_i), .write_i(paint), .write_addr_i(paint_number), .write_value_i(paint_value),
        .read_addr_i(colour), .read_value_o(painted));

    // ---- the picture ----
    reg                   tick_q, visible_q, hsync_q, vsync_q, pixel_q, shown_q, hsync_q2, vsync_q2;
    reg  [23:0]           rgb_q;
    always @(posedge clk_i) begin
        if (rst_i) begin
            {bank_q, old_q, tick_q, pixel_q, hsync_q, hsync_q2, vsync_q, vsync_q2, visible_q, shown_q} <= 10'd0;
            {frames_q, taken_q, unfinished_q, counted_q} <= 84'd0;
        end else begin
            {tick_q, visible_q, hsync_q, vsync_q} <= {tick, visible, hsync, vsync};
            pixel_q <= tick_q;
            if (tick_q) {shown_q, hsync_q2, vsync_q2} <= {visible_q, hsync_q, vsync_q};
            if (ends) begin
                bank_q <= !bank_q;
                if (next == HEIGHT[9:0]) begin
                    frames_q     <= frames_q + 32'd1;
                    unfinished_q <= counted_q + {9'd0, unfinished};
                    counted_q    <= 10'd0;
                end else
                    counted_q    <= counted_q + {9'd0, unfinished};
            end
            if (taken)                               taken_q <= taken_q + 32'd1;
            if (ends && next == HEIGHT[9:0])         old_q   <= 1'b1;
            else if (taken)                          old_q   <= 1'b0;
        end
        if (tick_q) rgb_q <= !visible_q ? 24'd0 : there ? painted : unfinished ? warning : background;
    end
    assign pixel_o   = pixel_q;
    assign visible_o = shown_q;
    assign hsync_o   = !hsync_q2;
    assign vsync_o   = !vsync_q2;
    assign rgb_o     = rgb_q;
    wire unused = &open_unused;

    generate
        if (WIDTH > 978 || HEIGHT > 495 || WIDTH + H_FRONT + H_SYNC + H_BACK > 1023 || LINES > 1023) begin : g_format
            WIDTH_is_978_and_HEIGHT_495_at_most_and_a_line_1023_pixels_and_a_frame_1023_lines u_error ();
        end
        if (SPARE < 0 || LATEST <= HEIGHT) begin : g_spare
            SPARE_leaves_no_line_in_which_reading_begins u_error ();
        end
    endgenerate
endmodule
`default_nettype wire
