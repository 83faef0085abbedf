// lists: where each context is in its object's list of neighbours.
//
// Purpose   `each` notes the place and the length of each object's list, which its register holds. All contexts go through their
//           lists at the same pace, so what is added to the place comes from the sequencer. What an entry's first word
//           says, the row of the neighbour, stays for the words that are loaded of it.
//
//           cycle    0          3         4
//           each     each_i     word_i3   noted, compared           longest_o is there from 5 on
//           cycle    W-6        W-5       W-4       W-3             W              W+1
//           load     around_i   list read  place    row, address    word_i, there  an entry's row is noted
//
// Latency   As shown.
// Hazard    One context does not come twice within GAP cycles. W-5 of an `each` comes after its place is noted (config_rules).
`default_nettype none
`include "lane/around.vh"
module lists #(
`include "config/config.vh"
) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    // 0: `each`
    input  wire                 each_i,
    input  wire                 first_i,        // of its contexts
    input  wire [CONTEXT_W-1:0] context_i,
    input  wire                 absent_i2,      // 2: there is no object
    input  wire [31:0]          word_i3,        // 3: its register
    output wire [LENGTH_W-1:0]  longest_o,
    // W-6: an instruction
    input  wire                 valid_i,
    input  wire [CONTEXT_W-1:0] retire_context_i,
    input  wire [AROUND_W-1:0] around_i,
    // W-3: what is loaded
    output wire                 of_list_o,      // a word of the list, at ...
    output wire [STORE_W-1:0]   place_o,
    output wire                 of_other_o,     // a word of the neighbour: its row, the word's number
    output wire [ROW_W-1:0]     row_o,
    output wire [REGISTER_W-1:0] number_o,
    output wire                 half_o,
    // W
    input  wire [31:0]          word_i,
    output wire                 ended_o         // not for this context: its list has ended
);
`include "gen/registers.vh"
    localparam LIST_W = LENGTH_W + STORE_W;

    // Cycles 3 to 5: the lists' places and lengths
    wire                 each_i3, first_i3, each_i4, first_i4;
    wire [CONTEXT_W-1:0] context_i3;
    reg  [CONTEXT_W-1:0] context_q;
    reg                  absent_q;
    reg  [LENGTH_W-1:0]  length_q, longest_q;           // 4; 5
    reg  [STORE_W-1:0]   place_q;
    delay #(.W(2), .N(3)) u_each (.clk_i(clk_i), .rst_i(rst_i), .d_i({each_i, each_i && first_i}), .q_o({each_i3, first_i3}));
    delay #(.W(2), .N(1)) u_each_late (.clk_i(clk_i), .rst_i(rst_i), .d_i({each_i3, first_i3}), .q_o({each_i4, first_i4}));
    delay #(.W(CONTEXT_W), .N(3)) u_context (.clk_i(clk_i), .rst_i(1'b0), .d_i(context_i), .q_o(context_i3));
    always @(posedge clk_i) begin
        absent_q  <= absent_i2;
        context_q <= context_i3;
        length_q  <= word_i3[OBJECTS_LENGTH_HI:OBJECTS_LENGTH_LO] & {LENGTH_W{!absent_q}};
        place_q   <= word_i3[STORE_W-1:0];
        if (each_i4 && (first_i4 || length_q > longest_q)) longest_q <= length_q;
    end
    assign longest_o = longest_q;

    wire [CONTEXT_W-1:0] context_w5, context_w4;
    wire [LENGTH_W-1:0]  length_w5;
    wire [STORE_W-1:0]   place_w5;
    lutram_1r1w #(.ADDR_W(CONTEXT_W), .W(LIST_W)) u_list (.clk_i(clk_i),
        .write_i(each_i4), .write_addr_i(context_q), .write_value_i({length_q, place_q}),
        .read_addr_i(context_w5), .read_value_o({length_w5, place_w5}));

    // W-5 to W-3
    wire [AROUND_W-1:0] around_w5;
    wire                 valid_w5;
    delay #(.W(AROUND_W+CONTEXT_W), .N(1)) u_w5 (.clk_i(clk_i), .rst_i(1'b0), .d_i({around_i, retire_context_i}), .q_o({around_w5, context_w5}));
    delay #(.W(1), .N(1)) u_valid (.clk_i(clk_i), .rst_i(rst_i), .d_i(valid_i), .q_o(valid_w5));
    delay #(.W(CONTEXT_W), .N(1)) u_context_w4 (.clk_i(clk_i), .rst_i(1'b0), .d_i(context_w5), .q_o(context_w4));
    `AROUND_FIELDS
    assign `AROUND = around_w5;
    wire unused = &{around_each, word_i, word_i3};

    wire [ROW_W-1:0]   row_w4;
    wire               there_w4;
    reg                turns_q;                         // W-4: this turn has an entry
    reg  [STORE_W-1:0] base_q, offset_q, sum_q;         // W-4; W-3
    reg                there_q;                         // W-3: the last entry was there
    reg  [ROW_W-1:0]   other_q;
    always @(posedge clk_i) begin
        turns_q <= around_turn < length_w5;
        {base_q, offset_q} <= {place_w5, around_offset};
        sum_q   <= base_q + offset_q;
        {there_q, other_q} <= {there_w4, row_w4};
    end
    wire inside_w3;
    delay #(.W(4), .N(2)) u_w3 (.clk_i(clk_i), .rst_i(1'b0), .d_i({around_entry || around_ldl, around_ldn, around_half, around_inside}),
        .q_o({of_list_o, of_other_o, half_o, inside_w3}));
    delay #(.W(REGISTER_W), .N(1)) u_number (.clk_i(clk_i), .rst_i(1'b0), .d_i(offset_q[REGISTER_W-1:0]), .q_o(number_o));
    assign {place_o, row_o} = {sum_q, other_q};
    delay #(.W(1), .N(3)) u_ended (.clk_i(clk_i), .rst_i(1'b0), .d_i(inside_w3 && !there_q), .q_o(ended_o));

    // W+1: the neighbour
    wire                 entry_w0, turns_w0;
    reg                  entry_q, found_q;
    reg  [ROW_W-1:0]     found_row_q;
    reg  [CONTEXT_W-1:0] found_context_q;
    wire [CONTEXT_W-1:0] context_w0;
    delay #(.W(1), .N(5)) u_entry (.clk_i(clk_i), .rst_i(rst_i), .d_i(valid_w5 && around_entry), .q_o(entry_w0));
    delay #(.W(1), .N(4)) u_turns (.clk_i(clk_i), .rst_i(1'b0), .d_i(turns_q), .q_o(turns_w0));
    delay #(.W(CONTEXT_W), .N(4)) u_context_w0 (.clk_i(clk_i), .rst_i(1'b0), .d_i(context_w4), .q_o(context_w0));
    always @(posedge clk_i) begin
        entry_q         <= !rst_i && entry_w0;
        found_q         <= turns_w0;
        found_row_q     <= word_i[ROW_W-1:0];
        found_context_q <= context_w0;
    end
    lutram_1r1w #(.ADDR_W(CONTEXT_W), .W(1+ROW_W)) u_other (.clk_i(clk_i),
        .write_i(entry_q), .write_addr_i(found_context_q), .write_value_i({found_q, found_row_q}),
        .read_addr_i(context_w4), .read_value_o({there_w4, row_w4}));

`ifdef FP3_CHECK
    // What all this rests on: a place is noted before it is read.
    reg [(1<<CONTEXT_W)-1:0] fresh_q;                   // `each` has been noted, its entry not yet read
    always @(posedge clk_i) begin
        if (each_i4) fresh_q[context_q] <= 1'b1;
        if (valid_w5 && around_each) begin
            fresh_q[context_w5] <= 1'b0;
            if (!rst_i && fresh_q[context_w5] !== 1'b1) begin
                $display("%m: the list of context %0d is read before it is noted", context_w5); $stop;
            end
        end
    end
`endif
endmodule
`default_nettype wire
