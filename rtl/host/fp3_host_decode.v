// SPDX-License-Identifier: Apache-2.0
// fp3_host_decode: decodes a host's address.
//
// Purpose   Part of host_port: tells registers, counters, program and other memories apart.
//           host_port checks whether an access is legal.
// Latency   1.
// Hazard    An address is in at most one part of the map; an address that is not a multiple of 4 is
//           in none.
`default_nettype none
module fp3_host_decode #(
`include "config/config.vh"
) (
    input  wire        clk_i,
    input  wire        write_i,
    input  wire [23:0] addr_i,
    output wire        registers_o,
    output wire        counters_o,
    output wire        program_o,
    output wire        memory_o,
    output wire [5:0]  counter_o,      // which one
    output wire [2:0]  space_o,        // which memory: lane_host.vh
    output wire [19:0] address_o       // its word
);
`include "gen/registers.vh"
`include "host/lane_host.vh"
    localparam [31:0] REGISTERS_32  = REGISTERS;
    localparam [31:0] PROGRAM_32    = PROGRAM_WORDS;
    // Which lanes have a store, and which pieces of the objects' window there are: a lane's store,
    // or the registers of the one object. Both lengths are powers of two. A table of 64 bits is
    // shorter than a comparison's carries.
    localparam integer STORES     = STORE_WORDS != 0 ? LANES : 0;
    localparam integer PIECE_W    = STORE_WORDS != 0 ? STORE_W : REGISTER_W;
    localparam [63:0]  HAS_STORE  = ~(~64'd0 << STORES);
    localparam [63:0]  HAS_PIECE  = STORE_WORDS != 0 ? HAS_STORE : 64'd1;
    localparam [63:0]  HAS_STATUS = STATUS != 0 ? HAS_STORE : 64'd0;
    localparam [1:0]  COPIES = SPACE_COPIES, OBJECTS = SPACE_OBJECTS, STATUSES = SPACE_STATUS;

    wire [1:0]  part  = addr_i[SPACE_BIT +: 2];
    wire [31:0] word  = ({8'd0, addr_i} & ~(32'hffffffff << SPACE_BIT)) >> 2;
    wire [5:0]  index = addr_i[7:2];
    wire [31:0] piece = word >> PIECE_W;
    wire        near  = piece[31:6] == 26'd0;
    wire        low   = part == 2'd0 && word[19:14] == 6'd0;         // 64 KB
    wire [5:0]  counter = {addr_i[8:7] - ADDR_COUNTERS[8:7], addr_i[6:3]};

    wire whole = addr_i[1:0] == 2'd0;
    wire registers_d = low && addr_i[15:0] < ADDR_COUNTERS;
    wire counters_d  = COUNTERS != 0 && low && addr_i[15:9] == ADDR_COUNTERS[15:9] && addr_i[8:7] != 2'd0
                    && {26'd0, counter} < COUNTER_COUNT;
    wire program_d   = low && addr_i[15] == ADDR_WINDOW_PROGRAM[15] && {19'd0, addr_i[14:2]} < PROGRAM_32;
    wire constants_d = low && addr_i[15:8] == ADDR_WINDOW_CONSTANTS[15:8] && {26'd0, index} < REGISTERS_32;
    wire awake_d     = low && addr_i[15:8] == ADDR_WINDOW_AWAKE[15:8] && HAS_STORE[index];
    wire wake_d      = low && addr_i[15:8] == ADDR_WINDOW_WAKE[15:8] && HAS_STORE[index] && write_i && SLEEP != 0;
    wire copies_d    = EXCHANGE != 0 && part == COPIES && piece == 32'd0 && write_i;
    wire objects_d   = part == OBJECTS && near && HAS_PIECE[piece[5:0]];
    wire status_d    = part == STATUSES && near && HAS_STATUS[piece[5:0]];

    reg        registers_q, counters_q, program_q, memory_q;
    reg [2:0]  space_q;
    reg [5:0]  counter_q;
    reg [19:0] address_q;
    always @(posedge clk_i) begin
        registers_q <= whole && registers_d;
        counters_q  <= whole && counters_d;
        program_q   <= whole && program_d;
        memory_q    <= whole && (constants_d || awake_d || wake_d || copies_d || objects_d || status_d);
        space_q     <= constants_d ? HOST_CONSTANT : awake_d ? HOST_AWAKE : wake_d ? HOST_WAKE
                     : copies_d ? HOST_COPIES : status_d ? HOST_STATUS : HOST_OBJECT;
        counter_q   <= counter;
        address_q   <= low ? {7'd0, addr_i[14:2]} : word[19:0];
    end
    assign {registers_o, counters_o, program_o, memory_o} = {registers_q, counters_q, program_q, memory_q};
    assign {counter_o, space_o, address_o}                = {counter_q, space_q, address_q};

`ifdef FP3_CHECK
    wire [8:0] parts = {copies_d, registers_d, counters_d, program_d, constants_d, awake_d, wake_d, objects_d, status_d};
    always @(posedge clk_i)
        if (|(parts & (parts - 9'd1))) begin
            $display("%m: address %h is in several parts of the map: %b", addr_i, parts); $stop;
        end
`endif
endmodule
`default_nettype wire
