// SPDX-License-Identifier: Apache-2.0
// fp3_lane_store: the records of a lane's objects, loaded and stored word by word.
//
// Purpose   A record has 8 << record words, one for each register. A store knows its row two cycles
//           after its issue, a load reads in time for its result.
//
//           With STORAGE a word has 16 bits: it is rounded as it is stored, and widened as it is
//           loaded. The host writes narrow words. One word of each record is kept whole if objects
//           sleep: its high 16 bits are in a memory of their own, by rows.
//
// Latency   Stored five cycles after the issue (cycle 5 has the new word), with STORAGE ROUNDED +
//           2. Loaded: three cycles from the row to word_o, with STORAGE WIDENED more.
// Hazard    No word is loaded (W-2) in the cycle in which it is written (4): between rounds
//           everything drains, and within a round no object loads what another stores (checked).
//           Published words are loaded from one half of the store and stored in the other half. The
//           host accesses words when no instruction is in the lane (checked there). With OVERLAP it
//           may, of the part that the run leaves out, if in this cycle no instruction has the port
//           (checked): instructions reach one part of each half, wherever the program points.
//
//     cycle    0      2                    3         4        5
//     store    st_i   row_i2_i, absent..   value_i3  written  there
//     cycle    W-3    W-2   W-1   W
//     load     row    read        word_o
//     cycle    W-5    W-4   W-3   W-2        W-1       W
//     STORAGE  row    read        read_word  narrow_q  word_o
`default_nettype none
`include "lane/bundles.vh"
module fp3_lane_store #(
`include "config/config.vh"
) (
    input  wire                  clk_i,
    input  wire                  rst_i,
    input  wire [LANE_W-1:0]     index_i,        // the lane's number; does not change
    input  wire [`FP3_MOVE_W-1:0]    move_i,
    input  wire [31:0]           value_i3_i,     // of a store
    input  wire                  keep_i3_i,      // not a store, but a row of a list, at ...
    input  wire [STORE_W-1:0]    keep_place_i3_i,
    input  wire [ROW_W-1:0]      keep_row_i3_i,
    input  wire [DRAW_W-1:0]     draw_i,         // TIMING_MIX + 1: how it is rounded; with OVERLAP, PART
    output wire [31:0]           word_o,         // of a load
    output wire                  over_o,         // W: a store made a finite number infinite
    // The host
    input  wire                  host_i,         // the write port has host_address_i
    input  wire                  host_read_i,    // ... and the read port
    input  wire                  host_write_i,
    input  wire [STORE_W-1:0]    host_address_i,
    input  wire                  host_whole_i,   // all 32 bits of the word
    input  wire [31:0]           host_word_i
);
    `FP3_MOVE_FIELDS
    assign `FP3_MOVE = move_i;
    wire                  st_i2, in_last_i2, upper_i2;
    wire [REGISTER_W-1:0] register_i2;
    fp3_delay #(.W(3+REGISTER_W), .N(2)) u_st (.clk_i(clk_i), .rst_i(rst_i),
        .d_i({move_st, move_in_last, move_st_upper, move_register}),
        .q_o({st_i2, in_last_i2, upper_i2, register_i2}));

    wire [STORE_W-1:0] st_base, ld_base, st_place, load_place, keep_place;
    generate
        if (OVERLAP != 0) begin : g_part
            localparam PART = STORE_W - 2;                             // the bit of an address that says which part
            wire               runs_in_part, upper;
            wire [STORE_W-1:0] st_whole = {move_st_row, 3'd0} << move_record_shift;
            wire [STORE_W-1:0] ld_whole = {move_load_row, 3'd0} << move_record_shift;
            assign {runs_in_part, upper} = draw_i;
            function [STORE_W-1:0] in_part(input [STORE_W-1:0] at, input given, input to);
                in_part = {at[STORE_W-1], given ? to : at[PART], at[PART-1:0]};
            endfunction
            assign {st_base, st_place}   = {in_part(st_whole, runs_in_part, upper), in_part(move_st_place, runs_in_part, upper)};
            assign {ld_base, load_place} = {in_part(ld_whole, runs_in_part, upper), in_part(move_place, runs_in_part, upper)};
            assign keep_place            = in_part(keep_place_i3_i, runs_in_part, upper);
        end else begin : g_whole
            assign st_base = {move_st_row, 3'd0} << move_record_shift;
            assign ld_base = {move_load_row, 3'd0} << move_record_shift;
            assign {st_place, load_place, keep_place} = {move_st_place, move_place, keep_place_i3_i};
        end
    endgenerate
    reg                st_q, write_q;                                  // cycle 3, 4
    reg  [STORE_W-1:0] st_address_q, write_address_q, read_address_q;  // cycle 3, 4; W-2
    reg  [STORED_W-1:0] write_word_q;
    wire                stored;                                        // the word that is written a cycle later
    wire [STORE_W-1:0]  stored_address;
    wire [STORED_W-1:0] stored_word, read_word;
    always @(posedge clk_i) begin
        st_q            <= !rst_i && st_i2 && !move_st_absent && !(NEIGHBOURS != 0 && move_st_ended)
                                  && !(move_st_asleep && !in_last_i2);
        st_address_q    <= NEIGHBOURS != 0 && move_st_list ? st_place
                         : st_base | {{STORE_W-REGISTER_W{1'b0}}, register_i2} | {upper_i2, {STORE_W-1{1'b0}}};
        write_q         <= !rst_i && (stored || host_write_i);
        write_address_q <= host_i ? host_address_i : stored_address;
        write_word_q    <= host_i ? host_word_i[STORED_W-1:0] : stored_word;
        read_address_q  <= host_read_i ? host_address_i : move_load_place ? load_place
                         : ld_base | {{STORE_W-REGISTER_W{1'b0}}, move_load_register} | {move_load_upper, {STORE_W-1{1'b0}}};
    end
    fp3_ram_registered #(.ADDR_W(STORE_W), .W(STORED_W)) u_store (.clk_i(clk_i), .write_i(write_q && !rst_i),
        .write_addr_i(write_address_q), .write_value_i(write_word_q),
        .read_i(1'b1), .read_addr_i(read_address_q), .read_value_o(read_word));

    generate
        if (STORAGE != 0) begin : g_narrow
            localparam LATE = ROUNDED - TIMING_NARROW - 3;             // from the value in cycle 3 to its rounding
            `FP3_DRAW_FIELDS
            assign `FP3_DRAW = draw_i;
            reg                draws_q;
            reg  [31:0]        number_q;
            wire               draws, over;
            wire [31:0]        random, object;                         // object: what the lane adds to the number, in TIMING_MIX + 1
            always @(posedge clk_i) begin
                draws_q  <= draw_draws;
                number_q <= draw_number + object;
            end
            fp3_mix u_mix (.clk_i(clk_i), .number_i(number_q), .mixed_o(random));
            fp3_delay #(.W(1), .N(TIMING_MIX)) u_draws (.clk_i(clk_i), .rst_i(1'b0), .d_i(draws_q), .q_o(draws));

            // Stored: rounded, or whole.
            wire [31:0]        value, value_late;
            wire [15:0]        narrow;
            wire [STORE_W-1:0] address;
            wire               st_whole_i3, whole, whole_late;
            fp3_delay #(.W(1), .N(3)) u_st_whole (.clk_i(clk_i), .rst_i(1'b0), .d_i(move_st_whole), .q_o(st_whole_i3));
            fp3_delay_ram #(.W(33+STORE_W), .N(LATE)) u_late (.clk_i(clk_i), .rst_i(rst_i),
                .d_i({st_whole_i3, value_i3_i, st_address_q}),
                .q_o({whole, value, address}));
            fp3_narrow #(.STORAGE(STORAGE)) u_narrow (.clk_i(clk_i), .word_i(value), .draws_i(draws),
                .random_i(random[15:0]), .narrow_o(narrow), .over_o(over));
            fp3_delay #(.W(33+STORE_W), .N(TIMING_NARROW)) u_value (.clk_i(clk_i), .rst_i(1'b0),
                .d_i({whole, value, address}),
                .q_o({whole_late, value_late, stored_address}));
            fp3_delay #(.W(1), .N(ROUNDED-3)) u_stored (.clk_i(clk_i), .rst_i(rst_i), .d_i(st_q), .q_o(stored));
            fp3_delay #(.W(1), .N(TO_RESULT-ROUNDED)) u_over (.clk_i(clk_i), .rst_i(rst_i),
                .d_i(stored && over && !whole_late), .q_o(over_o));
            assign stored_word = whole_late ? value_late[15:0] : narrow;

            // Loaded: widened, or with its high 16 bits.
            wire [31:0]        widened;
            wire [15:0]        high_word;
            wire               loaded_whole;
            reg  [15:0]        narrow_q, high_q;                       // W-1
            reg                whole_q;
            reg  [31:0]        word_q;
            fp3_widen #(.STORAGE(STORAGE)) u_widen (.narrow_i(narrow_q), .word_o(widened));
            always @(posedge clk_i) begin
                {narrow_q, high_q, whole_q} <= {read_word, high_word, loaded_whole};
                word_q <= whole_q ? {high_q, narrow_q} : widened;
            end
            assign word_o = word_q;
            if (WHOLE != 0) begin : g_whole
                reg              write_high_q;
                reg  [15:0]      write_high_word_q;
                reg  [ROW_W-1:0] write_row_q, read_row_q;
                wire [STORE_W-1:0] row = ((host_i ? host_address_i : stored_address) >> 3) >> move_record_shift;
                always @(posedge clk_i) begin
                    write_high_q <= !rst_i && (host_i ? host_write_i && host_whole_i : stored && whole_late);
                    write_high_word_q  <= host_i ? host_word_i[31:16] : value_late[31:16];
                    write_row_q   <= row[ROW_W-1:0];
                    read_row_q    <= host_i ? row[ROW_W-1:0] : move_load_row;
                end
                fp3_ram_registered #(.ADDR_W(ROW_W), .W(16)) u_high (.clk_i(clk_i), .write_i(write_high_q && !rst_i),
                    .write_addr_i(write_row_q), .write_value_i(write_high_word_q),
                    .read_i(1'b1), .read_addr_i(read_row_q), .read_value_o(high_word));
                fp3_delay #(.W(1), .N(3)) u_load_whole (.clk_i(clk_i), .rst_i(1'b0),
                    .d_i(host_i ? host_whole_i : move_load_whole), .q_o(loaded_whole));
                wire unused_row = &row;
            end else begin : g_narrow_alone
                assign {loaded_whole, high_word} = 17'd0;
                wire unused_whole = &{host_whole_i, host_word_i[31:16], value_late};
            end
            wire unused_random = &{random[31:16], keep_i3_i, keep_place, keep_row_i3_i};

            // The object's number: which row it has is known in cycle 2.
            if (SLEEP != 0) begin : g_object
                reg [31:0] own_q, product_q, late_q;
                always @(posedge clk_i) begin
                    own_q     <= draw_first + {{32-LANE_W{1'b0}}, index_i};
                    product_q <= {{32-ROW_W{1'b0}}, move_st_row} * {19'd0, draw_stride};
                    late_q    <= product_q + own_q;
                end
                fp3_delay #(.W(32), .N(TIMING_MIX-3)) u_object (.clk_i(clk_i), .rst_i(1'b0), .d_i(late_q),
                    .q_o(object));
            end else begin : g_order
                assign object = {{32-LANE_W{1'b0}}, index_i};
            end
        end else begin : g_words
            if (KEEP != 0) begin : g_keep
                assign stored         = st_q || keep_i3_i;
                assign stored_address = keep_i3_i ? keep_place : st_address_q;
                assign stored_word    = keep_i3_i ? {{32-ROW_W{1'b0}}, keep_row_i3_i} : value_i3_i;
            end else begin : g_no_keep
                wire unused_keep = &{keep_i3_i, keep_place, keep_row_i3_i};
                assign {stored, stored_address, stored_word} = {st_q, st_address_q, value_i3_i};
            end
            assign {word_o, over_o} = {read_word, 1'b0};
            wire unused_draw = &{index_i, draw_i, host_whole_i};
        end
    endgenerate

`ifdef FP3_CHECK
    reg load_q;                                                        // W-2
    always @(posedge clk_i) begin
        load_q <= !rst_i && move_load;
        if (!rst_i && load_q && write_q && write_address_q == read_address_q) begin
            $display("%m: word %0d is loaded in the cycle in which it is stored", read_address_q); $stop;
        end
        if (!rst_i && OVERLAP != 0 && ((host_read_i && move_load) || (host_write_i && stored))) begin
            $display("%m: the host has a port in the cycle of an instruction"); $stop;
        end
    end
`endif
endmodule
`default_nettype wire
`include "config/undefine.vh"
