// SPDX-License-Identifier: Apache-2.0
// fp3_keep: a list of neighbours that the lane itself makes, and the flag that objects raise.
//
// Purpose   `keep` goes through other objects in a loop. If its condition is negative, the row of the
//           neighbour is written behind the list's last entry, as a field of an entry is (lane_store),
//           and the list's word, place and length, goes back to its register by the way of a load. The
//           first turn of a loop begins the list anew. A list that has no room left gets no entry; its
//           length is then all ones, which no other list has.
//
//           cycle    0               2                   3                        4
//           keep     keep_i          away_i2_i           list_i3_i, write_o ..    list_i4_o, no_room_o
//           cycle    R+3 = 3 - AHEAD
//           row      other_r3_i
//
// Latency   As shown. raised_o like no_room_o.
// Hazard    One context does not come twice before its register is written (GAP, lane).
//
//     list {length 2, place 100}, room 3, condition -1.0, neighbour in row 7:
//                  word 102 of the store is 7, the list {length 3, place 100}; the next one has no room
`default_nettype none
module fp3_keep #(
`include "config/config.vh"
) (
    input  wire                clk_i,
    input  wire                rst_i,
    // 0: an instruction
    input  wire                keep_i,
    input  wire                raise_i,
    input  wire                first_i,        // of `keep`: the loop's first turn
    input  wire [ROW_W-1:0]    other_r3_i,     // R+3: the neighbour's row
    // 2
    input  wire                away_i2_i,      // there is no object, or no other one
    // 3
    input  wire [31:0]         list_i3_i,      // the list's word; of `raise`: the condition
    input  wire [31:0]         room_i3_i,
    input  wire                takes_i3_i,
    output wire                write_o,        // a row is written, at ...
    output wire [STORE_W-1:0]  place_o,
    output wire [ROW_W-1:0]    row_o,
    // 4
    output wire                keeps_i4_o,
    output wire [31:0]         list_i4_o,
    output wire                raised_o,
    output wire                no_room_o
);
`include "gen/registers.vh"
    wire                keep_i3, raise_i3, first_i3;
    wire [ROW_W-1:0]    other_i3;
    reg                 away_q;                             // 3
    fp3_delay #(.W(3), .N(3)) u_i3 (.clk_i(clk_i), .rst_i(rst_i), .d_i({keep_i, raise_i, first_i}),
        .q_o({keep_i3, raise_i3, first_i3}));
    fp3_delay #(.W(ROW_W), .N(AHEAD)) u_other (.clk_i(clk_i), .rst_i(1'b0), .d_i(other_r3_i), .q_o(other_i3));

    wire [LENGTH_W-1:0] length = list_i3_i[OBJECTS_LENGTH_HI:OBJECTS_LENGTH_LO] & {LENGTH_W{!first_i3}};
    wire                takes  = keep_i3 && takes_i3_i && !away_q;
    wire                full   = length >= room_i3_i[LENGTH_W-1:0];
    assign write_o = takes && !full;
    wire [31:0]         length_32 = {{32-LENGTH_W{1'b0}}, length};
    assign place_o = list_i3_i[STORE_W-1:0] + length_32[STORE_W-1:0];
    assign row_o   = other_i3;

    reg                 keeps_q, raised_q, no_room_q;       // 4
    reg  [31:0]         list_q;
    always @(posedge clk_i) begin
        away_q    <= away_i2_i;
        keeps_q   <= !rst_i && keep_i3;
        raised_q  <= !rst_i && raise_i3 && !away_q && list_i3_i[31];
        no_room_q <= !rst_i && takes && full;
        list_q    <= list_i3_i;
        list_q[OBJECTS_LENGTH_HI:OBJECTS_LENGTH_LO] <= takes && full ? {LENGTH_W{1'b1}} : length + {{LENGTH_W-1{1'b0}}, takes};
    end
    assign {keeps_i4_o, list_i4_o, raised_o, no_room_o} = {keeps_q, list_q, raised_q, no_room_q};
    wire unused = &{room_i3_i, length_32};
endmodule
`default_nettype wire
