// SPDX-License-Identifier: Apache-2.0
// fp3_lane: the registers of some objects, the store behind them, and the end of each instruction.
//
// Purpose   Executes the sequencer's orders: in each cycle one instruction of each stream, for one
//           context. Everything that depends on an object's data is decided here. There is one
//           stream, or with DUAL one of sums and one of products; these differ in the registers
//           (lane_operands, dual_operands) and in the ends (lane_end, dual_end).
//
//           cycle    0         1, 2       3         .. W = TO_RESULT        W+1
//           issue    operands  registers  operands  arithmetic, result   written, retired
//                    named     read       to it
//           retire             told ENDED before W; the store's word there in W (W-1)
//
//           A signal's suffix counts up from the issue (_i2 is in cycle 2) or from the cycle of
//           RETIRE (_e3), or down to the result (_w1 is in cycle W-1). Where objects see each other,
//           the read of the store is named AHEAD before cycle 0 (REACH), and suffixes count up from
//           there (_r3). Its word comes TIMING_END later, beside the registers in cycle 2; a loaded
//           word waits from then on. Where a sum and a product issue at once, a sum's y is named
//           TIMING_EARLY before cycle 0, which is that much later for all else.
//
// Latency   A register read GAP cycles after the issue of the instruction that writes it, or later,
//           has the new value. All results have the same latency, so everything happens in the
//           order of issue.
// Hazard    There are no interlocks: one context does not come twice within GAP cycles. The host's
//           accesses come when no instruction is in the lane.
`default_nettype none
`include "lane/bundles.vh"
module fp3_lane #(
`include "config/config.vh"
) (
    input  wire                           clk_i,
    input  wire                           rst_i,
    input  wire [LANE_W-1:0]              index_i,       // this lane's number; does not change
    // From the sequencer and the host
    input  wire [`FP3_REACH_W-1:0]            reach_i,
    input  wire [`FP3_LANE_ISSUE_W-1:0]       issue_i,
    input  wire [`FP3_LANE_RETIRE_W-1:0]      retire_i,
    input  wire [`FP3_ACCESS_W-1:0]           access_i,
    input  wire [31:0]                    data_i,        // the number of the step; of an access: its word
    input  wire [DRAW_W-1:0]              draw_i,        // of a store
    // To the sequencer and the host, gathered from lane to lane
    input  wire [`FP3_REPORT_W-1:0]           report_i,
    output wire [`FP3_REPORT_W-1:0]           report_o,
    // The arithmetic and the trace, a part for each stream
    output wire [`FP3_OPERANDS_W*STREAMS-1:0] operands_o,
    input  wire [`FP3_RESULT_W*STREAMS-1:0]   result_i,
    output wire [`FP3_WRITTEN_W*STREAMS-1:0]  written_o
);
`include "host/lane_host.vh"
    localparam S = STREAMS;
    `FP3_ACCESS_FIELDS
    `FP3_MOVE_FIELDS
    wire [`FP3_MOVE_W-1:0] move;
    assign `FP3_ACCESS = access_i;
    assign `FP3_MOVE   = move;
    wire mine         = access_valid && access_lane == index_i;
    wire write        = mine && access_write;
    // Not where a write leaves the other port to an instruction, or to another lane's word.
    wire reads        = access_valid && !((EXCHANGE != 0 || OVERLAP != 0) && access_write);
    wire to_store     = (write && access_space == HOST_OBJECT)
                     || (EXCHANGE != 0 && access_valid && access_write && access_space == HOST_EVERY);
    wire to_constants = access_valid && access_write && access_space == HOST_CONSTANT;     // of all lanes

    // Operands and ends
    // ---------------------------------------------------------
    wire [S-1:0]         writes;                // W+1
    wire [REG_W*S-1:0]   registers;
    wire [32*S-1:0]      values;
    wire [`FP3_END_W*S-1:0]  ends;                  // W
    wire [31:0]          st_value_i3, word;     // of a store; read of the store
    wire [31:0]          loaded;                // W: the word that was read for this instruction
    wire [31:0]          other;                 // W: the word that is written without a result
    wire                 constant;              // W: the host writes a register
    wire [REG_W-1:0]     constant_register;
    wire                 over;                  // W: a store made a number infinite
    wire [4:0]           scale_flags;           // W: of the scaling of a sum's operand
    wire [ROW_W:0]       count;
    wire [LENGTH_W-1:0]  longest;
    wire                 sleeps, batch, asleep, loads;
    wire [CONTEXT_W-1:0] context_number;
    generate
        if (DUAL != 0) begin : g_two
            reg                  constant_q;
            reg [REGISTER_W-1:0] register_q;
            reg [31:0]           other_q;
            always @(posedge clk_i) begin
                constant_q <= !rst_i && to_constants;
                register_q <= access_address[REGISTER_W-1:0];
                other_q    <= loads ? loaded : data_i;
            end
            assign {constant, constant_register, other} = {constant_q, {CONTEXT_W-1{1'b1}}, register_q, 1'b0, other_q};   // of both banks
            assign longest = {LENGTH_W{1'b0}};
            assign {sleeps, batch, asleep, context_number} = {CONTEXT_W+3{1'b0}};
            fp3_dual_operands #(.CONFIG(CONFIG)) u_operands (.clk_i(clk_i),
                .write_i(writes), .write_register_i(registers), .write_value_i(values),
                .issue_i(issue_i), .operands_o(operands_o), .stored_o(st_value_i3), .scale_flags_o(scale_flags));
            fp3_dual_end #(.CONFIG(CONFIG)) u_end (.clk_i(clk_i), .rst_i(rst_i), .issue_i(issue_i), .retire_i(retire_i),
                .host_count_i(write && access_space == HOST_AWAKE), .host_data_i(data_i[ROW_W:0]),
                .move_o(move), .ends_o(ends), .load_o(loads), .count_o(count));
        end else begin : g_one
            localparam [CONTEXT_W-1:0] SHARED = CONTEXTS[CONTEXT_W-1:0];
            wire less;
            assign {constant, constant_register} = {to_constants, SHARED, access_address[REGISTER_W-1:0]};
            assign other       = loads ? loaded : data_i;
            assign scale_flags = 5'd0;
            fp3_lane_operands #(.CONFIG(CONFIG)) u_operands (.clk_i(clk_i),
                .write_i(writes), .write_register_i(registers), .write_value_i(values),
                .issue_i(issue_i), .word_i2_i(word), .operands_o(operands_o), .stored_o(st_value_i3), .less_o(less));
            fp3_lane_end #(.CONFIG(CONFIG)) u_end (.clk_i(clk_i), .rst_i(rst_i), .reach_i(reach_i),
                .issue_i(issue_i), .retire_i(retire_i),
                .access_i(access_i), .mine_i(mine), .data_i(data_i), .less_i(less), .word_i(word),
                .stored_i3_i(st_value_i3),
                .move_o(move), .end_o(ends), .load_o(loads),
                .count_o(count), .longest_o(longest), .sleeps_o(sleeps), .batch_o(batch),
                .context_o(context_number), .asleep_o(asleep));
        end
    endgenerate

    // Results: written in W+1
    // -------------------------------------------------------------------------
    wire [S-1:0]   raises;                      // W
    wire [5*S-1:0] raised, flags;               // W; W+1
    genvar p;
    generate
        for (p = 0; p < S; p = p + 1) begin : g_result
            `FP3_RESULT_FIELDS
            `FP3_END_FIELDS
            assign `FP3_RESULT = result_i[`FP3_RESULT_W*p +: `FP3_RESULT_W];
            assign `FP3_END    = ends[`FP3_END_W*p +: `FP3_END_W];
            assign raises[p]        = (FLAGS != 0 && end_writes && end_arithmetic) || (FLAGS != 0 && p == 0 && over);
            assign raised[5*p +: 5] = p == 0 && over ? 5'b00101 : result_flags | (p == 0 ? scale_flags : 5'd0);      // overflow, inexact
            fp3_lane_result #(.CONFIG(CONFIG)) u_result (.clk_i(clk_i), .rst_i(rst_i),
                .end_i(ends[`FP3_END_W*p +: `FP3_END_W]), .raises_i(raises[p]), .flags_i(raised[5*p +: 5]),
                .value_i(end_arithmetic ? result_value : other),
                .constant_i(constant), .constant_register_i(constant_register),
                .write_o(writes[p]), .register_o(registers[REG_W*p +: REG_W]), .value_o(values[32*p +: 32]),
                .flags_o(flags[5*p +: 5]), .written_o(written_o[`FP3_WRITTEN_W*p +: `FP3_WRITTEN_W]));
        end
    endgenerate

    // A list that is made: its word is the result
    // ------------------------------------------------------------------------------
    wire               keep_i3, keeps_i4, raises_now, no_room;
    wire [STORE_W-1:0] keep_place_i3;
    wire [ROW_W-1:0]   keep_row_i3;
    wire [31:0]        list_i4;
    generate
        if (KEEP != 0) begin : g_keep
            `FP3_ISSUE_FIELDS
            `FP3_OPERANDS_FIELDS
            assign `FP3_ISSUE    = issue_i;
            assign `FP3_OPERANDS = operands_o;
            fp3_keep #(.CONFIG(CONFIG)) u_keep (.clk_i(clk_i), .rst_i(rst_i),
                .keep_i(issue_keep), .raise_i(issue_raise), .first_i(issue_first), .other_r3_i(move_load_row),
                .away_i2_i(move_st_absent || move_st_ended),
                .list_i3_i(st_value_i3), .room_i3_i(operands_y), .takes_i3_i(operands_z[31]),
                .write_o(keep_i3), .place_o(keep_place_i3), .row_o(keep_row_i3),
                .keeps_i4_o(keeps_i4), .list_i4_o(list_i4), .raised_o(raises_now), .no_room_o(no_room));
        end else begin : g_no_keep
            assign {keep_i3, keeps_i4, raises_now, no_room} = 4'd0;
            assign {keep_place_i3, keep_row_i3, list_i4} = {STORE_W+ROW_W+32{1'b0}};
        end
    endgenerate

    fp3_lane_store #(.CONFIG(CONFIG)) u_store (.clk_i(clk_i), .rst_i(rst_i), .index_i(index_i), .move_i(move),
        .value_i3_i(st_value_i3), .keep_i3_i(keep_i3), .keep_place_i3_i(keep_place_i3), .keep_row_i3_i(keep_row_i3),
        .draw_i(draw_i), .word_o(word), .over_o(over),
        .host_i(OVERLAP != 0 ? to_store : access_valid), .host_read_i(reads), .host_write_i(to_store), .host_address_i(access_address),
        .host_whole_i(access_whole), .host_word_i(data_i));

    // Before the operands it is too early for the loaded word.
    generate
        if (KEEP != 0) begin : g_early_or_kept
            wire [31:0] word_i4;
            fp3_delay #(.W(32), .N(2)) u_word (.clk_i(clk_i), .rst_i(1'b0), .d_i(word), .q_o(word_i4));
            fp3_delay_ram #(.W(32), .N(TO_RESULT-4)) u_loaded (.clk_i(clk_i), .rst_i(rst_i),
                .d_i(keeps_i4 ? list_i4 : word_i4), .q_o(loaded));
        end else if (NEIGHBOURS != 0) begin : g_early
            wire unused_kept = &{keeps_i4, list_i4};
            fp3_delay_ram #(.W(32), .N(TO_RESULT-2)) u_loaded (.clk_i(clk_i), .rst_i(rst_i), .d_i(word), .q_o(loaded));
        end else begin : g_in_time
            assign loaded = word;
            wire unused_reach = &{reach_i, keeps_i4, list_i4};
        end
    endgenerate

    // A word of this lane's store, for another lane.
    wire copied;                                // W
    generate
        if (EXCHANGE != 0) begin : g_copied
            `FP3_REACH_FIELDS
            `FP3_AROUND_FIELDS
            assign `FP3_REACH  = reach_i;
            assign `FP3_AROUND = reach_around;
            wire              copy_w1;
            wire [LANE_W-1:0] lane_w1;
            reg               copied_q;
            fp3_delay #(.W(1+LANE_W), .N(TIMING_END-1)) u_copy (.clk_i(clk_i), .rst_i(rst_i),
                .d_i({reach_copy, around_turn[LANE_W-1:0]}), .q_o({copy_w1, lane_w1}));
            always @(posedge clk_i) copied_q <= !rst_i && copy_w1 && lane_w1 == index_i;
            assign copied = copied_q;
        end else begin : g_not_copied
            assign copied = 1'b0;
        end
    endgenerate

    // Reports
    // ----------------------------------------------------------------------------------
    wire [31:0]      status;
    wire [ROW_W-1:0] row_w3;
    fp3_delay #(.W(ROW_W), .N(WIDENED)) u_row (.clk_i(clk_i), .rst_i(1'b0), .d_i(move_load_row), .q_o(row_w3));
    fp3_lane_status #(.STATUS(STATUS), .ROW_W(ROW_W)) u_status (.clk_i(clk_i), .rst_i(rst_i),
        .row_w3_i(row_w3), .raises_i(raises[0]), .flags_i(raised[4:0]), .step_i(data_i[26:0]), .status_o(status),
        .host_i(access_valid), .host_write_i(write && access_space == HOST_STATUS),
        .host_row_i(access_address[ROW_W-1:0]), .host_word_i(data_i));
    fp3_lane_report #(.CONFIG(CONFIG)) u_report (.clk_i(clk_i), .rst_i(rst_i), .report_i(report_i),
        .count_i(count), .longest_i(longest), .flags_i(flags[4:0] | flags[5*S-1 -: 5]), .raised_i(raises_now), .no_room_i(no_room),
        .asleep_i(asleep),
        .valid_i(sleeps), .batch_i(batch), .context_i(context_number),
        .mine_i(EXCHANGE != 0 ? mine && reads : mine), .space_i(access_space), .copied_i(copied), .stored_i(word),
        .status_i(status), .report_o(report_o));
endmodule
`default_nettype wire
`include "config/undefine.vh"
