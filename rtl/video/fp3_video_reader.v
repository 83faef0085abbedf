// SPDX-License-Identifier: Apache-2.0
// fp3_video_reader: reads the positions of all objects between two runs, and keeps their pixels.
//
// Purpose   A request for register `status`; if no run is under way one for `half`, where words are
//           published; then two for each object. Each pair of answers becomes a place, or a mark that
//           nothing of the object can be in the picture.
//
//           begin_i ─► status ─► half ─► x, y, x, y ..  ─► video_pixel ─► the memory of places
//
// Latency   One request in a cycle if the bus takes it.
// Promise   A request is asked for from the first one to the last, without a pause, so that nobody
//           else need be let in between. If a run is under way nothing changes. shows_o is low until
//           positions were read, and after a request that was refused.
// Hazard    turns takes no request before the answer to `status` and to `half`, which do not stream.
//           The settings stand still from begin_i until busy_o is low.
`default_nettype none
module fp3_video_reader #(
    parameter ADDRESS_W = 18,          // bits of a byte address of the processor, 26 at most
    parameter OBJECTS_W = 10,          // 2^OBJECTS_W objects at most
    parameter WIDTH  = 640,
    parameter HEIGHT = 480
) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    input  wire                 on_i,
    input  wire                 begin_i,         // ignored while busy_o
    output wire                 busy_o,
    output wire                 shows_o,         // places are those of all objects
    output wire                 taken_o,         // they are new ones from this cycle on
    // Settings: fp3_video_registers
    input  wire [ADDRESS_W-1:0] x_i, y_i, upper_i,
    input  wire [15:0]          step_i,
    input  wire [OBJECTS_W:0]   objects_i,
    input  wire signed [11:0]   x_origin_i, y_origin_i,
    input  wire signed [7:0]    x_scale_i, y_scale_i,
    // What was found
    output wire [OBJECTS_W:0]   outside_o,
    output wire [OBJECTS_W:0]   numberless_o,
    // To turns, and its answers
    output wire                 req_valid_o,
    input  wire                 req_ready_i,
    output wire                 req_streams_o,
    output wire [ADDRESS_W-1:0] req_addr_o,
    input  wire                 answer_i,
    input  wire                 answer_error_i,
    input  wire [31:0]          answer_rdata_i,
    // To the memory: x is 32 more than the pixel's, y is 8 more
    output wire                 place_o,
    output wire [OBJECTS_W-1:0] place_number_o,
    output wire [18:0]          place_value_o    // {y, x}
);
`include "gen/registers.vh"
    localparam [2:0] IDLE = 3'd0, STATUS = 3'd1, HALF = 3'd2, WORDS = 3'd3, DRAIN = 3'd4;
    localparam [ADDRESS_W-1:0] NOWHERE = 1;                // no multiple of 4: the bus refuses it
    localparam [8:0] NO_ROW = 9'd511;

    // ---- what is asked for ----
    reg  [2:0]         state_q;
    reg                second_q;                           // the next request is for y
    reg  [OBJECTS_W:0] number_q;
    reg  [31:0]        offset_q;
    wire               asked  = req_valid_o && req_ready_i;
    wire               last   = number_q + 1'b1 == objects_i;
    wire               halves = upper_i != {ADDRESS_W{1'b0}};
    wire               none   = objects_i == {OBJECTS_W+1{1'b0}};

    // ---- what is answered: status, half, words ----
    reg                first_q, half_due_q, upper_q, failed_q;
    wire               running = answer_i && first_q && (answer_error_i || answer_rdata_i[STATUS_RUNNING_LO]);
    wire               drained;
    reg  [2:0]         next;
    always @* begin
        case (state_q)
        IDLE:    next = on_i && begin_i ? STATUS : IDLE;
        STATUS:  next = !asked ? STATUS : halves ? HALF : none ? DRAIN : WORDS;
        HALF:    next = running ? IDLE : !asked ? HALF : none ? DRAIN : WORDS;
        WORDS:   next = running ? IDLE : asked && second_q && last ? DRAIN : WORDS;
        default: next = running || drained ? IDLE : DRAIN;
        endcase
    end

    // From where the words of the first object are; beyond all addresses, nowhere.
    wire [31:0] bytes  = {{32-ADDRESS_W{1'b0}}, second_q ? y_i : x_i} + (upper_q ? {{32-ADDRESS_W{1'b0}}, upper_i} : 32'd0) + offset_q;
    wire        begins = state_q == IDLE && next == STATUS;
    wire        word   = answer_i && !first_q && !half_due_q;
    always @(posedge clk_i) begin
        if (rst_i) state_q <= IDLE;
        else       state_q <= next;
        if (begins) begin
            {second_q, number_q} <= {OBJECTS_W+2{1'b0}};
            offset_q             <= 32'd0;
            upper_q              <= 1'b0;
            first_q              <= 1'b1;
            half_due_q           <= halves;
        end else begin
            if (asked && state_q == WORDS) begin
                second_q <= !second_q;
                if (second_q) begin
                    number_q <= number_q + 1'b1;
                    offset_q <= offset_q + {16'd0, step_i};
                end
            end
            if (answer_i) begin
                first_q <= 1'b0;
                if (!first_q) half_due_q <= 1'b0;
                if (!first_q && half_due_q) upper_q <= answer_rdata_i[HALF_UPPER_LO];
            end
        end
        if (begins)                                     failed_q <= 1'b0;
        else if (answer_i && !first_q && answer_error_i) failed_q <= 1'b1;
    end
    assign req_valid_o   = state_q == STATUS || state_q == HALF || state_q == WORDS;
    assign req_streams_o = state_q == WORDS;
    assign req_addr_o    = state_q == STATUS ? {{ADDRESS_W-16{1'b0}}, ADDR_STATUS} : state_q == HALF ? {{ADDRESS_W-16{1'b0}}, ADDR_HALF} :
                           |bytes[31:ADDRESS_W] ? NOWHERE : bytes[ADDRESS_W-1:0];

    // ---- words become pixels, and those places ----
    reg                 word_q, second_word_q, shifts_q, second_shifts_q, from_second_q;
    reg  [31:0]         value_q;
    wire                number, far;
    wire signed [13:0]  pixel;
    fp3_video_pixel u_pixel (.clk_i(clk_i), .word_i(value_q), .scale_i(second_word_q ? y_scale_i : x_scale_i),
        .origin_i(second_shifts_q ? y_origin_i : x_origin_i), .down_i(second_shifts_q), .number_o(number), .far_o(far), .pixel_o(pixel));
    reg                 pixel_q, down_q, number_found_q, far_q, left_number_q, left_far_q;
    reg  signed [13:0]  row_q, column_q;
    reg  [OBJECTS_W:0]  placed_q, outside_q, numberless_q;

    localparam signed [13:0] RIGHT = WIDTH[13:0], BELOW = HEIGHT[13:0];
    wire        numbers = left_number_q && number_found_q;
    wire        near    = numbers && !left_far_q && !far_q;
    // As far as the largest shape reaches: 14 columns and 7 rows.
    wire        reaches = near && column_q >= -14'sd14 && column_q < RIGHT + 14'sd14 && row_q >= -14'sd7 && row_q < BELOW + 14'sd7;
    wire        centred = near && column_q >= 14'sd0 && column_q < RIGHT && row_q >= 14'sd0 && row_q < BELOW;
    wire        place   = pixel_q && down_q;
    wire [13:0] right32 = column_q + 14'd32, down8 = row_q + 14'd8;
    always @(posedge clk_i) begin
        word_q  <= word && !rst_i;
        {shifts_q, second_shifts_q} <= {word_q && !rst_i, second_word_q};
        pixel_q <= shifts_q && !rst_i;
        if (word) {second_word_q, value_q} <= {from_second_q, answer_rdata_i};
        if (begins)    from_second_q <= 1'b0;
        else if (word) from_second_q <= !from_second_q;
        {down_q, number_found_q, far_q, row_q} <= {second_shifts_q, number, far, pixel};
        if (pixel_q && !down_q) {left_number_q, left_far_q, column_q} <= {number_found_q, far_q, row_q};
        if (begins) begin
            {placed_q, outside_q, numberless_q} <= {3*OBJECTS_W+3{1'b0}};
        end else if (place) begin
            placed_q     <= placed_q + 1'b1;
            outside_q    <= outside_q + {{OBJECTS_W{1'b0}}, numbers && !centred};
            numberless_q <= numberless_q + {{OBJECTS_W{1'b0}}, !numbers};
        end
    end
    assign place_o        = place;
    assign place_number_o = placed_q[OBJECTS_W-1:0];
    assign place_value_o  = {reaches ? down8[8:0] : NO_ROW, right32[9:0]};

    // ---- the end ----
    reg                 shows_q, taken_q;
    reg  [OBJECTS_W:0]  outside_found_q, numberless_found_q;
    assign drained = state_q == DRAIN && placed_q == objects_i && !first_q && !half_due_q;
    always @(posedge clk_i) begin
        taken_q <= drained && !failed_q && !rst_i;
        if (rst_i || !on_i) shows_q <= 1'b0;
        else if (drained)   shows_q <= !failed_q;
        if (rst_i)                     {outside_found_q, numberless_found_q} <= {2*OBJECTS_W+2{1'b0}};
        else if (drained && !failed_q) {outside_found_q, numberless_found_q} <= {outside_q, numberless_q};
    end
    assign busy_o       = state_q != IDLE;
    assign shows_o      = shows_q;
    assign taken_o      = taken_q;
    assign outside_o    = outside_found_q;
    assign numberless_o = numberless_found_q;
    wire unused = &{answer_rdata_i, right32[13:10], down8[13:9]};
endmodule
`default_nettype wire
