// SPDX-License-Identifier: Apache-2.0
// fp3_exchange: copies published words from lane to lane, before each round.
//
// Purpose   A neighbour in another lane has a ghost: a row of this lane's store with copies of the
//           published words. This module goes through the list of copies once for each published
//           word, one copy per cycle: the lane of the object reads the word as for the host, and
//           the lane of the ghost writes the word as from the host.
//
//           list ──► from: row, lane ──► reach_o ───► lanes ──► answer ──┐
//           list ──► to: row, lane ────► access_o ──► lanes ◄── data ◄───┘    TIMING_END + 1 + GROUPS cycles later
//
// Latency   Two cycles between two words, and WAY + 3 behind the last word: then the last copy is
//           on its way through the lanes.
// Hazard    copy_i comes between rounds: no instruction is in the lanes, and the host has no
//           access. While busy_o is high, only this module controls the lanes. No copy reads a row
//           that another copy writes, so the order of copies does not matter.
//
//     two published words, three copies:   from   0 1 2 - - 0 1 2 - - ..
//                                          to     ..      0 1 2 - - 0 1 2     then copied_o
`default_nettype none
`include "gen/settings.vh"
`include "lane/bundles.vh"
module fp3_exchange #(
`include "config/config.vh"
) (
    input  wire                  clk_i,
    input  wire                  rst_i,
    // The host writes the list
    input  wire                  write_i,
    input  wire [STORE_W-1:0]    write_addr_i,
    input  wire [31:0]           write_value_i,
    // The rounds
    input  wire [`FP3_SETTINGS_W-1:0] settings_i,
    input  wire                  half_i,        // of the store: it has the published words
    input  wire                  copy_i,        // a round is about to begin
    input  wire                  abort_i,
    output wire                  copied_o,
    // The lanes
    output wire                  busy_o,
    output wire [`FP3_REACH_W-1:0]   reach_o,
    output wire [`FP3_ACCESS_W-1:0]  access_o       // its word is what the lanes answer
);
`include "gen/registers.vh"
`include "host/lane_host.vh"
    localparam INDEX_W = STORE_W - 1;
    localparam WAY     = TIMING_END + 1 + GROUPS;      // from reach_o to the answer
    localparam DRAIN_W = $clog2(WAY + 1);
    localparam FROM_W  = LANE_W + ROW_W;
    localparam [31:0] WAY_32 = WAY;
    localparam [2:0] IDLE = 3'd0, LOW = 3'd1, PICK = 3'd2, WALK = 3'd3, DRAIN = 3'd4;
    `FP3_SETTINGS_FIELDS
    assign `FP3_SETTINGS = settings_i;

    // Word by word
    // ---------------------------------------------------------------------------------
    reg  [2:0]            state_q;
    reg  [63:0]           left_q, low_q;       // published words that are still to be copied; the first of them
    reg                   any_q, copied_q;
    reg  [REGISTER_W-1:0] register_q;
    reg  [INDEX_W-1:0]    index_q, end_index_q;
    reg  [DRAIN_W-1:0]    drain_q;
    wire                  none = setting_copies[31:1] == 31'd0;
    wire                  over = state_q == DRAIN && drain_q == {DRAIN_W{1'b0}};
    function [REGISTER_W-1:0] number(input [63:0] one);
        integer i;
        begin
            number = {REGISTER_W{1'b0}};
            for (i = 0; i < REGISTERS; i = i + 1)
                if (one[i]) number = number | i[REGISTER_W-1:0];
        end
    endfunction
    always @(posedge clk_i)
        if (rst_i || abort_i) begin
            state_q  <= IDLE;
            copied_q <= 1'b0;
        end else begin
            copied_q <= over;
            case (state_q)
                IDLE:    if (copy_i) state_q <= LOW;
                LOW:     state_q <= PICK;
                PICK:    state_q <= any_q ? WALK : DRAIN;
                WALK:    if (index_q == end_index_q) state_q <= LOW;
                default: if (over) state_q <= IDLE;
            endcase
        end
    always @(posedge clk_i) begin
        low_q  <= left_q & (~left_q + 64'd1);
        any_q  <= left_q != 64'd0 && !none;
        end_index_q <= setting_copies[STORE_W-1:1] - 1'b1;
        if (state_q == IDLE)      left_q <= {setting_published_more, setting_published};
        else if (state_q == PICK) left_q <= left_q & ~low_q;
        if (state_q == PICK)      register_q <= number(low_q);
        index_q <= state_q == WALK ? index_q + 1'b1 : {INDEX_W{1'b0}};
        drain_q <= state_q == DRAIN ? drain_q - 1'b1 : WAY_32[DRAIN_W-1:0];
    end
    assign copied_o = copied_q;
    assign busy_o   = state_q != IDLE;

    // From: the list is read in two cycles
    // ---------------------------------------------------------------
    wire                  walks = state_q == WALK;
    wire                  from_valid, to_reads, to_valid;
    wire [REGISTER_W-1:0] from_register, to_register;
    wire [FROM_W-1:0]     from;
    wire                  to_all;
    wire [LANE_W-1:0]     to_lane;
    wire [ROW_W-1:0]      to_row;
    fp3_delay #(.W(1), .N(2)) u_from (.clk_i(clk_i), .rst_i(rst_i || abort_i), .d_i(walks), .q_o(from_valid));
    fp3_delay #(.W(REGISTER_W), .N(2)) u_from_register (.clk_i(clk_i), .rst_i(1'b0), .d_i(register_q),
        .q_o(from_register));
    wire from_write = write_i && !write_addr_i[0], to_write = write_i && write_addr_i[0];
    wire [FROM_W-1:0] write_place = {write_value_i[COPIES_LANE_LO +: LANE_W], write_value_i[COPIES_ROW_LO +: ROW_W]};
    fp3_ram_registered #(.ADDR_W(INDEX_W), .W(FROM_W)) u_froms (.clk_i(clk_i),
        .write_i(from_write), .write_addr_i(write_addr_i[STORE_W-1:1]), .write_value_i(write_place),
        .read_i(1'b1), .read_addr_i(index_q), .read_value_o(from));
    `FP3_REACH_FIELDS
    `FP3_AROUND_FIELDS
    assign {around_each, around_entry, around_ldn, around_ldl, around_inside} = 5'd0;
    assign around_half   = half_i;
    assign around_turn   = {{LENGTH_W-LANE_W{1'b0}}, from[FROM_W-1:ROW_W]};
    assign around_offset = {{STORE_W-REGISTER_W{1'b0}}, from_register};
    assign {reach_valid, reach_load} = 2'd0;
    assign reach_context  = {CONTEXT_W{1'b0}};
    assign reach_row      = from[ROW_W-1:0];
    assign reach_around   = `FP3_AROUND;
    assign reach_copy     = from_valid;
    assign reach_o        = `FP3_REACH;

    // To: likewise, as the answer comes
    // ----------------------------------------------------------------
    reg [INDEX_W-1:0] to_index_q;
    fp3_delay #(.W(1), .N(WAY)) u_to_reads (.clk_i(clk_i), .rst_i(rst_i || abort_i), .d_i(walks), .q_o(to_reads));
    fp3_delay #(.W(1), .N(2)) u_to (.clk_i(clk_i), .rst_i(rst_i || abort_i), .d_i(to_reads), .q_o(to_valid));
    fp3_delay #(.W(REGISTER_W), .N(WAY)) u_to_register (.clk_i(clk_i), .rst_i(1'b0), .d_i(from_register),
        .q_o(to_register));
    always @(posedge clk_i) to_index_q <= to_reads ? to_index_q + 1'b1 : {INDEX_W{1'b0}};
    fp3_ram_registered #(.ADDR_W(INDEX_W), .W(1+FROM_W)) u_tos (.clk_i(clk_i),
        .write_i(to_write), .write_addr_i(write_addr_i[STORE_W-1:1]),
        .write_value_i({write_value_i[COPIES_EVERY_LO], write_place}),
        .read_i(1'b1), .read_addr_i(to_index_q), .read_value_o({to_all, to_lane, to_row}));
    `FP3_ACCESS_FIELDS
    wire [STORE_W-1:0] base   = {to_row, 3'd0} << setting_record;
    assign access_valid   = to_valid;
    assign {access_write, access_whole} = {to_valid, 1'b0};
    assign access_space   = to_all ? HOST_EVERY : HOST_OBJECT;
    assign access_lane    = to_lane;
    assign access_address = base | {{STORE_W-REGISTER_W{1'b0}}, to_register} | {half_i, {STORE_W-1{1'b0}}};
    assign access_o       = `FP3_ACCESS;
    wire unused = &write_value_i;

`ifdef FP3_CHECK
    always @(posedge clk_i)
        if (!rst_i) begin
            if (copy_i && busy_o) begin
                $display("%m: copies begin while others are made"); $stop;
            end
            if (copied_q && (from_valid || to_valid || to_reads)) begin
                $display("%m: a copy is left behind the last"); $stop;
            end
        end
`endif
endmodule
`default_nettype wire
`include "config/undefine.vh"
