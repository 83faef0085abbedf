// lane_store: the records of a lane's objects, loaded and stored word by word.
//
// Purpose   A record has 8 << record words, one for each register. A store knows its row two cycles after
//           its issue, a load reads in time for its result.
//
// Latency   Stored five cycles after the issue (cycle 5 has the new word). Loaded: row_w3_i to word_o three
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
module lane_store #(
`include "config/config.vh"
) (
    input  wire                  clk_i,
    input  wire                  rst_i,
    input  wire [`MOVE_W-1:0]    move_i,
    input  wire [31:0]           value_i3_i,     // of a store
    output wire [31:0]           word_o,         // of a load
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
    reg  [31:0]        write_word_q;
    always @(posedge clk_i) begin
        st_q            <= !rst_i && st_i2 && !move_st_absent && !(move_st_asleep && !lasts_i2);
        st_address_q    <= st_base | {{STORE_W-REGISTER_W{1'b0}}, register_i2} | {upper_i2, {STORE_W-1{1'b0}}};
        write_q         <= !rst_i && (st_q || host_write_i);
        write_address_q <= host_i ? host_address_i : st_address_q;
        write_word_q    <= host_i ? host_word_i : value_i3_i;
        read_address_q  <= host_read_i ? host_address_i : move_load_place ? move_place
                         : ld_base | {{STORE_W-REGISTER_W{1'b0}}, move_load_register} | {move_load_upper, {STORE_W-1{1'b0}}};
    end
    ram_registered #(.ADDR_W(STORE_W)) u_store (.clk_i(clk_i), .write_i(write_q && !rst_i),
        .write_addr_i(write_address_q), .write_value_i(write_word_q),
        .read_i(1'b1), .read_addr_i(read_address_q), .read_value_o(word_o));

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
