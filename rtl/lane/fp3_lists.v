// SPDX-License-Identifier: Apache-2.0
// fp3_lists: where each context is in its object's list of neighbours.
//
// Purpose   `each` notes the place and the length of each object's list, from the object's
//           register. All contexts go through their lists at the same pace, so the sequencer gives
//           the offset from the place. The first word of an entry, the row of the neighbour, is
//           kept for the loads of the neighbour's words.
//
//           cycle    0          3         4
//           each     each_i     word_i3   noted, compared           longest_o is there from 5 on
//           cycle    R          R+1        R+2      R+3             R+6       R+7
//           load     around_i   list read  place    row, address    word_i    an entry's row is noted
//
//           The place of a field that is stored waits for its value, which comes with the issue.
//           With KEEP an object is not its own neighbour: in a turn in which the entry is its own
//           row, it executes nothing, as behind the list's end. So all may share a list of all.
//
// Latency   As shown. ended_o comes with the result, AHEAD + TO_RESULT cycles after R.
// Hazard    One context does not come twice within GAP cycles. R+1 of an `each` comes after its
//           place is noted (issue).
`default_nettype none
`include "lane/bundles.vh"
module fp3_lists #(
`include "config/config.vh"
) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    // 0: `each`, `keep`
    input  wire                 each_i,
    input  wire                 keep_i,
    input  wire                 first_i,        // of its contexts
    input  wire [CONTEXT_W-1:0] context_i,
    input  wire                 absent_i2,      // 2: there is no object
    input  wire [31:0]          word_i3,        // 3: its register
    output wire [LENGTH_W-1:0]  longest_o,
    // R: an instruction
    input  wire                 valid_i,
    input  wire [CONTEXT_W-1:0] reach_context_i,
    input  wire [ROW_W-1:0]     own_i,          // the row of its object
    input  wire [AROUND_W-1:0]  around_i,
    // R+3: the word that is read
    output wire                 of_list_o,      // a word of the list, at ...
    output wire [STORE_W-1:0]   place_o,
    output wire [ROW_W-1:0]     row_o,          // ... or a word of the neighbour or of the object itself: the row, the word's number
    output wire [REGISTER_W-1:0] number_o,
    output wire                 half_o,
    // Cycle 2: a store to a field of the entry, at ...; the context has no such entry
    output wire                 st_list_o,
    output wire [STORE_W-1:0]   st_place_o,
    output wire                 st_ended_o,
    input  wire [31:0]          word_i,         // R+6
    output wire                 ended_o         // W: this context's list has ended: it does not execute
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
    fp3_delay #(.W(2), .N(3)) u_each (.clk_i(clk_i), .rst_i(rst_i), .d_i({each_i, each_i && first_i}),
        .q_o({each_i3, first_i3}));
    fp3_delay #(.W(2), .N(1)) u_each_late (.clk_i(clk_i), .rst_i(rst_i), .d_i({each_i3, first_i3}),
        .q_o({each_i4, first_i4}));
    fp3_delay #(.W(CONTEXT_W), .N(3)) u_context (.clk_i(clk_i), .rst_i(1'b0), .d_i(context_i), .q_o(context_i3));
    always @(posedge clk_i) begin
        absent_q  <= absent_i2;
        context_q <= context_i3;
        length_q  <= word_i3[OBJECTS_LENGTH_HI:OBJECTS_LENGTH_LO] & {LENGTH_W{!absent_q}};
        place_q   <= word_i3[STORE_W-1:0];
        if (each_i4 && (first_i4 || length_q > longest_q)) longest_q <= length_q;
    end
    assign longest_o = longest_q;

    wire [CONTEXT_W-1:0] context_r1, context_r2;
    wire [LENGTH_W-1:0]  length_r1;
    wire [STORE_W-1:0]   place_r1;
    fp3_lutram_1r1w #(.ADDR_W(CONTEXT_W), .W(LIST_W)) u_list (.clk_i(clk_i),
        .write_i(each_i4), .write_addr_i(context_q), .write_value_i({length_q, place_q}),
        .read_addr_i(context_r1), .read_value_o({length_r1, place_r1}));

    // R+1 to R+3
    wire [AROUND_W-1:0] around_r1;
    wire                valid_r1, other_r2;
    wire [ROW_W-1:0]    own_r2;
    `FP3_AROUND_FIELDS
    assign `FP3_AROUND = around_r1;
    fp3_delay #(.W(AROUND_W+CONTEXT_W), .N(1)) u_r1 (.clk_i(clk_i), .rst_i(1'b0), .d_i({around_i, reach_context_i}),
        .q_o({around_r1, context_r1}));
    fp3_delay #(.W(1), .N(1)) u_valid (.clk_i(clk_i), .rst_i(rst_i), .d_i(valid_i), .q_o(valid_r1));
    fp3_delay #(.W(CONTEXT_W), .N(1)) u_context_r2 (.clk_i(clk_i), .rst_i(1'b0), .d_i(context_r1), .q_o(context_r2));
    fp3_delay #(.W(1), .N(1)) u_other_r2 (.clk_i(clk_i), .rst_i(1'b0), .d_i(around_ldn), .q_o(other_r2));
    fp3_delay #(.W(ROW_W), .N(2)) u_own_r2 (.clk_i(clk_i), .rst_i(1'b0), .d_i(own_i), .q_o(own_r2));
    wire unused = &{word_i, word_i3};

    wire [ROW_W-1:0]   row_r2;
    wire               there_r2;
    reg                turns_q;                         // R+2: this turn has an entry
    reg  [STORE_W-1:0] base_q, offset_q, sum_q;         // R+2; R+3
    reg                there_q;                         // R+3: the last entry was there, and with KEEP another object
    reg  [ROW_W-1:0]   row_q;
    always @(posedge clk_i) begin
        turns_q <= around_turn < length_r1;
        {base_q, offset_q} <= {place_r1, around_offset};
        sum_q   <= base_q + offset_q;
        there_q <= there_r2 && (KEEP == 0 || row_r2 != own_r2);
        row_q   <= other_r2 ? row_r2 : own_r2;
    end
    wire inside_r3;
    fp3_delay #(.W(3), .N(2)) u_r3 (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({around_entry || around_ldl, around_half, around_inside}),
        .q_o({of_list_o, half_o, inside_r3}));
    fp3_delay #(.W(REGISTER_W), .N(1)) u_number (.clk_i(clk_i), .rst_i(1'b0), .d_i(offset_q[REGISTER_W-1:0]),
        .q_o(number_o));
    assign {place_o, row_o} = {sum_q, row_q};
    // The first turn begins a list that is made anew, also that of an object which has no entry then: `keep` is executed.
    wire keep_i2;
    generate
        if (KEEP != 0) begin : g_keep
            fp3_delay #(.W(1), .N(2)) u_keep (.clk_i(clk_i), .rst_i(1'b0), .d_i(keep_i), .q_o(keep_i2));
        end else begin : g_no_keep
            assign keep_i2 = keep_i;                    // there is none
        end
    endgenerate
    fp3_delay #(.W(1), .N(KEEP != 0 ? TO_RESULT-2 : AHEAD+TO_RESULT-3)) u_ended (.clk_i(clk_i), .rst_i(1'b0),
        .d_i(KEEP != 0 ? st_ended_o && !keep_i2 : inside_r3 && !there_q), .q_o(ended_o));

    fp3_delay #(.W(2+STORE_W), .N(AHEAD-1)) u_stored (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({of_list_o, inside_r3 && !there_q, sum_q}), .q_o({st_list_o, st_ended_o, st_place_o}));

    // R+7: the neighbour
    wire                 entry_r6, turns_r6;
    reg                  entry_q, found_q;
    reg  [ROW_W-1:0]     found_row_q;
    reg  [CONTEXT_W-1:0] found_context_q;
    wire [CONTEXT_W-1:0] context_r6;
    fp3_delay #(.W(1), .N(5)) u_entry (.clk_i(clk_i), .rst_i(rst_i), .d_i(valid_r1 && around_entry), .q_o(entry_r6));
    fp3_delay #(.W(1), .N(4)) u_turns (.clk_i(clk_i), .rst_i(1'b0), .d_i(turns_q), .q_o(turns_r6));
    fp3_delay #(.W(CONTEXT_W), .N(4)) u_context_r6 (.clk_i(clk_i), .rst_i(1'b0), .d_i(context_r2), .q_o(context_r6));
    always @(posedge clk_i) begin
        entry_q         <= !rst_i && entry_r6;
        found_q         <= turns_r6;
        found_row_q     <= word_i[ROW_W-1:0];
        found_context_q <= context_r6;
    end
    fp3_lutram_1r1w #(.ADDR_W(CONTEXT_W), .W(1+ROW_W)) u_other (.clk_i(clk_i),
        .write_i(entry_q), .write_addr_i(found_context_q), .write_value_i({found_q, found_row_q}),
        .read_addr_i(context_r2), .read_value_o({there_r2, row_r2}));

`ifdef FP3_CHECK
    // Invariant: a place is noted before it is read.
    reg [(1<<CONTEXT_W)-1:0] fresh_q;                   // `each` has been noted, its entry not yet read
    always @(posedge clk_i) begin
        if (each_i4) fresh_q[context_q] <= 1'b1;
        if (valid_r1 && around_each) begin
            fresh_q[context_r1] <= 1'b0;
            if (!rst_i && fresh_q[context_r1] !== 1'b1) begin
                $display("%m: the list of context %0d is read before it is noted", context_r1); $stop;
            end
        end
    end
`endif
endmodule
`default_nettype wire
`include "config/undefine.vh"
