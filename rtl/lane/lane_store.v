// lane_store: the records of a lane's objects, loaded and stored word by word.
//
// Purpose   A record has 8 << record words, one for each register. A store knows its row two cycles after
//           its issue, a load reads in time for its result.
//
//           With STORAGE a word has 16 bits: it is rounded as it is stored, and widened as it is loaded. The host writes halves.
//
// Latency   Stored five cycles after the issue (cycle 5 has the new word), with STORAGE ROUNDED + 2. Loaded: row_w3_i to word_o three
//           cycles.
// Hazard    No word is loaded (W-2) in the cycle in which it is written (4): between rounds everything drains,
//           and within a round no object loads what another stores (checked).
//           Published words are loaded from one half of the store and stored in the other, whose rows are then as many.
//           The host accesses words when no instruction is in the lane (checked there).
//
//     cycle    0      2                    3         4        5
//     store    st_i   row_i2_i, absent..   value_i3  written  there
//     cycle    W-3    W-2   W-1   W
//     load     row    read        word_o
`default_nettype none
`include "lane/move.vh"
`include "lane/draw.vh"
module lane_store #(
`include "config/config.vh"
) (
    input  wire                  clk_i,
    input  wire                  rst_i,
    input  wire [LANE_W-1:0]     index_i,        // the lane's number; does not change
    input  wire [`MOVE_W-1:0]    move_i,
    input  wire [31:0]           value_i3_i,     // of a store
    input  wire [DRAW_W-1:0]     draw_i,         // TIMING_MIX + 1: how it is rounded
    output wire [31:0]           word_o,         // of a load
    output wire                  over_o,         // W: a store made a finite number infinite
    // The host
    input  wire                  host_i,         // host_address_i is what is written
    input  wire                  host_read_i,    // ... and read
    input  wire                  host_write_i,
    input  wire [STORE_W-1:0]    host_address_i,
    input  wire [31:0]           host_word_i
);
    `MOVE_FIELDS
    assign `MOVE = move_i;
    wire                  st_i2, lasts_i2, upper_i2;
    wire [REGISTER_W-1:0] register_i2;
    delay #(.W(3+REGISTER_W), .N(2)) u_st (.clk_i(clk_i), .rst_i(rst_i), .d_i({move_st, move_lasts, move_st_upper, move_register}),
        .q_o({st_i2, lasts_i2, upper_i2, register_i2}));

    wire [STORE_W-1:0] st_base = {move_st_row, 3'd0} << move_record;
    wire [STORE_W-1:0] ld_base = {move_load_row, 3'd0} << move_record;
    reg                st_q, write_q;                                  // cycle 3, 4
    reg  [STORE_W-1:0] st_address_q, write_address_q, read_address_q;  // cycle 3, 4; W-2
    reg  [STORED_W-1:0] write_word_q;
    wire                stored;                                        // what is written a cycle later
    wire [STORE_W-1:0]  stored_address;
    wire [STORED_W-1:0] stored_word, read_word;
    always @(posedge clk_i) begin
        st_q            <= !rst_i && st_i2 && !move_st_absent && !(move_st_asleep && !lasts_i2);
        st_address_q    <= st_base | {{STORE_W-REGISTER_W{1'b0}}, register_i2} | {upper_i2, {STORE_W-1{1'b0}}};
        write_q         <= !rst_i && (stored || host_write_i);
        write_address_q <= host_i ? host_address_i : stored_address;
        write_word_q    <= host_i ? host_word_i[STORED_W-1:0] : stored_word;
        read_address_q  <= host_read_i ? host_address_i : move_load_place ? move_place
                         : ld_base | {{STORE_W-REGISTER_W{1'b0}}, move_load_register} | {move_load_upper, {STORE_W-1{1'b0}}};
    end
    ram_registered #(.ADDR_W(STORE_W), .W(STORED_W)) u_store (.clk_i(clk_i), .write_i(write_q && !rst_i),
        .write_addr_i(write_address_q), .write_value_i(write_word_q),
        .read_i(1'b1), .read_addr_i(read_address_q), .read_value_o(read_word));

    generate
        if (STORAGE != 0) begin : g_halves
            localparam LATE = ROUNDED - TIMING_HALVE - 3;              // from the value in cycle 3 to its rounding
            `DRAW_FIELDS
            assign `DRAW = draw_i;
            reg                draws_q;
            reg  [31:0]        number_q;
            wire               draws, over;
            wire [31:0]        random, value;
            wire [STORE_W-1:0] address;
            always @(posedge clk_i) begin
                draws_q  <= draw_draws;
                number_q <= draw_number + {{32-LANE_W{1'b0}}, index_i};
            end
            mix u_mix (.clk_i(clk_i), .number_i(number_q), .mixed_o(random));
            delay #(.W(1), .N(TIMING_MIX)) u_draws (.clk_i(clk_i), .rst_i(1'b0), .d_i(draws_q), .q_o(draws));
            delay_ram #(.W(32+STORE_W), .N(LATE)) u_late (.clk_i(clk_i), .rst_i(rst_i), .d_i({value_i3_i, st_address_q}), .q_o({value, address}));
            halve #(.CONFIG(CONFIG)) u_halve (.clk_i(clk_i), .word_i(value), .draws_i(draws), .random_i(random[15:0]), .half_o(stored_word), .over_o(over));
            delay #(.W(STORE_W), .N(TIMING_HALVE)) u_address (.clk_i(clk_i), .rst_i(1'b0), .d_i(address), .q_o(stored_address));
            delay #(.W(1), .N(ROUNDED-3)) u_stored (.clk_i(clk_i), .rst_i(rst_i), .d_i(st_q), .q_o(stored));
            delay #(.W(1), .N(TO_RESULT-ROUNDED)) u_over (.clk_i(clk_i), .rst_i(rst_i), .d_i(stored && over), .q_o(over_o));
            widen #(.CONFIG(CONFIG)) u_widen (.half_i(read_word), .word_o(word_o));
            wire unused_random = &{random[31:16], host_word_i[31:16]};
        end else begin : g_words
            assign {stored, stored_address, stored_word} = {st_q, st_address_q, value_i3_i};
            assign {word_o, over_o} = {read_word, 1'b0};
            wire unused_draw = &{index_i, draw_i};
        end
    endgenerate

`ifdef FP3_CHECK
    reg load_q;                                                        // W-2
    always @(posedge clk_i) begin
        load_q <= !rst_i && move_load;
        if (!rst_i && load_q && write_q && write_address_q == read_address_q) begin
            $display("%m: word %0d is loaded in the cycle in which it is stored", read_address_q); $stop;
        end
    end
`else
    wire unused = move_load;
`endif
endmodule
`default_nettype wire
