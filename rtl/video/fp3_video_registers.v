// SPDX-License-Identifier: Apache-2.0
// fp3_video_registers: what the host says of the picture, and what it is told.
//
// Purpose   The registers of docs/pictures.md. A value that is not possible, a place that is none and,
//           while positions are or may be read, a setting of the reader's are refused.
// Latency   One cycle from a request to its answer.
`default_nettype none
module fp3_video_registers #(
    parameter ADDRESS_W = 18,
    parameter OBJECTS_W = 10
) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    // A request, which is always taken
    input  wire                 ask_i,
    input  wire                 ask_write_i,
    input  wire [ADDRESS_W-1:0] ask_addr_i,      // within the window
    input  wire [31:0]          ask_wdata_i,
    output wire                 told_o,
    output wire                 told_write_o,
    output wire                 told_error_o,
    output wire [31:0]          told_rdata_o,
    // Settings
    output wire                 on_o,
    output wire                 hold_o,          // positions stay as they are
    output wire [ADDRESS_W-1:0] x_o, y_o, upper_o,
    output wire [15:0]          step_o,
    output wire [OBJECTS_W:0]   objects_o,
    output wire [3:0]           shift_o,
    output wire signed [11:0]   x_origin_o, y_origin_o,
    output wire signed [7:0]    x_scale_o, y_scale_o,
    output wire [31:0]          shape_o,
    output wire [23:0]          background_o, warning_o,
    output wire                 colour_o,        // write a colour of objects: the low bits of the address say which
    output wire [3:0]           colour_number_o,
    output wire [23:0]          colour_value_o,
    // What the host reads
    input  wire                 shows_i,
    input  wire                 busy_i,
    input  wire [31:0]          frames_i, taken_i,
    input  wire [OBJECTS_W:0]   outside_i, numberless_i,
    input  wire [9:0]           unfinished_i
);
    localparam [31:0] ID = 32'h46505630;                   // FPV, 0
    localparam [4:0] ID_AT = 5'd0, CONTROL = 5'd1, X = 5'd2, Y = 5'd3, UPPER = 5'd4, STEP = 5'd5, OBJECTS = 5'd6, ACROSS = 5'd7, DOWN = 5'd8,
        SHAPE = 5'd9, BACKGROUND = 5'd10, WARNING = 5'd11, STATUS = 5'd12, FRAMES = 5'd13, TAKEN = 5'd14, OUTSIDE = 5'd15, NUMBERLESS = 5'd16,
        UNFINISHED = 5'd17;
    localparam [OBJECTS_W:0] MOST = {1'b1, {OBJECTS_W{1'b0}}};

    reg                 on_q, hold_q;
    reg [ADDRESS_W-1:0] x_q, y_q, upper_q;
    reg [15:0]          step_q;
    reg [OBJECTS_W:0]   objects_q;
    reg [3:0]           shift_q;
    reg [11:0]          x_origin_q, y_origin_q;
    reg [7:0]           x_scale_q, y_scale_q;
    reg [31:0]          shape_q;
    reg [23:0]          background_q, warning_q;

    // ---- which register, and whether it takes this value ----
    wire [31:0] value   = ask_wdata_i;
    wire        here    = ask_addr_i[ADDRESS_W-1:8] == {ADDRESS_W-8{1'b0}} && ask_addr_i[1:0] == 2'd0;
    wire        colours = here && ask_addr_i[7:6] == 2'b10;
    wire        known   = here && ask_addr_i[7] == 1'b0;
    wire [4:0]  at      = ask_addr_i[6:2];
    wire        place   = value[31:ADDRESS_W] == {32-ADDRESS_W{1'b0}} && value[1:0] == 2'd0;
    wire        origin  = value[31:24] == 8'd0 && (value[15:11] == 5'd0 || value[15:11] == 5'd31);
    wire        number  = value[31:20] == 12'd0 && value[15:0] <= {{15-OBJECTS_W{1'b0}}, MOST};
    wire        colour  = value[31:24] == 8'd0;
    reg         takes;
    always @* begin
        case (at)
        CONTROL:             takes = value[31:2] == 30'd0;
        X, Y, UPPER:         takes = place;
        STEP:                takes = value[31:16] == 16'd0 && value[1:0] == 2'd0;
        OBJECTS:             takes = number;
        ACROSS, DOWN:        takes = origin;
        SHAPE:               takes = 1'b1;
        BACKGROUND, WARNING: takes = colour;
        default:             takes = 1'b0;
        endcase
    end
    // Those that the reader follows stand still while it may read.
    wire        still   = at >= X && at <= DOWN;
    wire        sets    = ask_i && ask_write_i && known && takes && !(still && (on_q || busy_i));
    wire        paints  = ask_i && ask_write_i && colours && colour;
    always @(posedge clk_i)
        if (rst_i) begin
            {hold_q, on_q} <= 2'd0;
            {x_q, y_q, upper_q} <= {3*ADDRESS_W{1'b0}};
            {step_q, objects_q, shift_q} <= {OBJECTS_W+21{1'b0}};
            {x_origin_q, y_origin_q, x_scale_q, y_scale_q} <= 40'd0;
            shape_q <= 32'd1;
            {background_q, warning_q} <= {24'h000000, 24'hff0000};
        end else if (sets)
            case (at)
            CONTROL:    {hold_q, on_q} <= value[1:0];
            X:          x_q        <= value[ADDRESS_W-1:0];
            Y:          y_q        <= value[ADDRESS_W-1:0];
            UPPER:      upper_q    <= value[ADDRESS_W-1:0];
            STEP:       step_q     <= value[15:0];
            OBJECTS:    {shift_q, objects_q} <= {value[19:16], value[OBJECTS_W:0]};
            ACROSS:     {x_scale_q, x_origin_q} <= {value[23:16], value[11:0]};
            DOWN:       {y_scale_q, y_origin_q} <= {value[23:16], value[11:0]};
            SHAPE:      shape_q    <= value;
            BACKGROUND: background_q <= value[23:0];
            default:    warning_q  <= value[23:0];
            endcase
    assign {hold_o, on_o} = {hold_q, on_q};
    assign {x_o, y_o, upper_o} = {x_q, y_q, upper_q};
    assign {step_o, objects_o, shift_o} = {step_q, objects_q, shift_q};
    assign {x_origin_o, y_origin_o, x_scale_o, y_scale_o} = {x_origin_q, y_origin_q, x_scale_q, y_scale_q};
    assign {shape_o, background_o, warning_o} = {shape_q, background_q, warning_q};
    assign colour_o        = paints;
    assign colour_number_o = ask_addr_i[5:2];
    assign colour_value_o  = value[23:0];

    // ---- answers ----
    reg         told_q, told_write_q, told_error_q;
    reg  [31:0] rdata_q, rdata;
    reg         has;
    always @* begin
        has = known;
        case (at)
        ID_AT:      rdata = ID;
        CONTROL:    rdata = {30'd0, hold_q, on_q};
        X:          rdata = {{32-ADDRESS_W{1'b0}}, x_q};
        Y:          rdata = {{32-ADDRESS_W{1'b0}}, y_q};
        UPPER:      rdata = {{32-ADDRESS_W{1'b0}}, upper_q};
        STEP:       rdata = {16'd0, step_q};
        OBJECTS:    rdata = {12'd0, shift_q, {15-OBJECTS_W{1'b0}}, objects_q};
        ACROSS:     rdata = {8'd0, x_scale_q, {4{x_origin_q[11]}}, x_origin_q};
        DOWN:       rdata = {8'd0, y_scale_q, {4{y_origin_q[11]}}, y_origin_q};
        SHAPE:      rdata = shape_q;
        BACKGROUND: rdata = {8'd0, background_q};
        WARNING:    rdata = {8'd0, warning_q};
        STATUS:     rdata = {30'd0, busy_i, shows_i};
        FRAMES:     rdata = frames_i;
        TAKEN:      rdata = taken_i;
        OUTSIDE:    rdata = {{31-OBJECTS_W{1'b0}}, outside_i};
        NUMBERLESS: rdata = {{31-OBJECTS_W{1'b0}}, numberless_i};
        UNFINISHED: rdata = {22'd0, unfinished_i};
        default:    {has, rdata} = 33'd0;
        endcase
    end
    always @(posedge clk_i) begin
        told_q <= ask_i && !rst_i;
        if (ask_i) begin
            told_write_q <= ask_write_i;
            told_error_q <= ask_write_i ? !sets && !paints : !has;
            rdata_q      <= has ? rdata : 32'd0;
        end
    end
    assign {told_o, told_write_o, told_error_o, told_rdata_o} = {told_q, told_write_q, told_error_q, rdata_q};
endmodule
`default_nettype wire
