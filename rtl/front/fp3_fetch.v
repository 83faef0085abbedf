// SPDX-License-Identifier: Apache-2.0
// fp3_fetch: instruction memory, program counter and the step loop.
//
// Purpose   Delivers a visit's instructions in order: the first part once, the step part
//           `steps` times, the last part once; then the next visit's. The loops cost no
//           instruction and no cycle.
//
//           0 ........ step ........ last ........ size
//           first part |  step part  |  last part  |
//
// Latency   3: the first word is on word_o three cycles after start_i, then one per cycle
//           in which advance_i is high.
//           skip_i ends the steps of this visit early: it may come at any time, and takes effect at
//           the end of a step. jump_i drops what was fetched and not taken; advance_i is low with
//           it.
// Hazard    advance_i low holds everything but start and stop. stop_i drops what was fetched and
//           not taken.
`default_nettype none
`include "front/marks.vh"
`include "gen/settings.vh"
module fp3_fetch #(
`include "config/config.vh"
) (
    input  wire              clk_i,
    input  wire              rst_i,
    // Program memory
    input  wire              write_i,
    input  wire [PROGRAM_W-1:0] write_addr_i,
    input  wire [31:0]       write_word_i,
    // A run; its settings are stable from start_i to its end
    input  wire              start_i,
    input  wire              stop_i,
    input  wire [`FP3_SETTINGS_W-1:0] settings_i,
    input  wire [31:0]       steps_i,   // of this visit, >= 1
    input  wire              skip_i,    // no more steps
    input  wire              more_i,    // another visit follows this one
    output wire              again_o,   // it begins
    // With NEIGHBOURS: it goes on elsewhere (loops), and not by itself at a visit's end
    input  wire              jump_i,
    input  wire              jump_on_i,     // 0: nowhere
    input  wire              jump_begins_i, // the next visit begins
    input  wire [PROGRAM_W-1:0] jump_pc_i,  // also where a run begins
    // To decode
    input  wire              advance_i,
    output wire              valid_o,
    output wire [PROGRAM_W-1:0] pc_o,
    output wire [31:0]       word_o,
    output wire [`FP3_MARKS_W-1:0] marks_o, // its place in its visit
    output wire              empty_o    // nothing left to deliver
);
    // step and last are at most size <= PROGRAM_WORDS, and last and size at least 1: the words
    // where the parts begin and end fit the program counter.
    `FP3_SETTINGS_FIELDS
    assign `FP3_SETTINGS = settings_i;
    wire [PROGRAM_W-1:0] step = setting_step[PROGRAM_W-1:0];
    reg  [PROGRAM_W-1:0] step_end_q, end_q;   // the last words of the step part and of the program
    always @(posedge clk_i) begin
        step_end_q <= setting_last[PROGRAM_W-1:0] - 1'b1;
        end_q      <= setting_size[PROGRAM_W-1:0] - 1'b1;
    end

    reg [PROGRAM_W-1:0] pc_q;
    reg [31:0]       steps_q;           // step parts left to end, this one too; with pending_q one less
    reg              pending_q;         // so that a late advance_i enables no 32 flip-flops
    reg              none_q;            // none left
    reg              active_q;          // pc_q points to a word to be fetched

    reg                begins_q, in_last_q;

    reg  steps_over, ends;              // pc_q is at the end of the step part; of the program
    wire [31:0] fewer = steps_q - 1'b1;
    wire one        = steps_q == (pending_q ? 32'd3 : 32'd2);   // the next is the last
    wire again      = steps_over && !none_q && !skip_i;
    wire jump       = NEIGHBOURS != 0 && jump_i;
    wire wraps      = NEIGHBOURS == 0 && more_i;                // by itself
    wire anew       = start_i || (advance_i && active_q && ends && !again && wraps) || (jump && jump_begins_i);
    wire [PROGRAM_W-1:0] from = NEIGHBOURS != 0 ? jump_pc_i : {PROGRAM_W{1'b0}};
    wire unused     = &{jump_on_i, jump_begins_i, jump_pc_i, more_i};
    assign again_o  = anew && !start_i;

    // Both are computed a cycle ahead, for each word that may come next.
    reg  again_over, again_ends, zero_over, zero_ends;
    reg  [PROGRAM_W-1:0] before_step_end_q, before_end_q;
    always @(posedge clk_i) begin
        {again_over, again_ends} <= {step == step_end_q, step == end_q};
        {zero_over, zero_ends}   <= {step_end_q == {PROGRAM_W{1'b0}}, end_q == {PROGRAM_W{1'b0}}};
        before_step_end_q        <= step_end_q - 1'b1;
        before_end_q             <= end_q - 1'b1;
        if (anew || jump)               {steps_over, ends} <= NEIGHBOURS != 0 ? {from == step_end_q, from == end_q} : {zero_over, zero_ends};
        else if (advance_i && active_q) {steps_over, ends} <= again ? {again_over, again_ends}
                                                                    : {pc_q == before_step_end_q, pc_q == before_end_q};
    end

    always @(posedge clk_i) begin
        pending_q <= advance_i && active_q && again && !start_i;
        if (anew)           steps_q <= steps_i;
        else if (pending_q) steps_q <= fewer;
    end

    always @(posedge clk_i)
        if (anew) begin
            pc_q     <= from;
            none_q   <= steps_i == 32'd1;
            begins_q <= 1'b1;
            in_last_q  <= 1'b0;
        end else if (jump) begin
            pc_q     <= from;
            begins_q <= 1'b0;
            in_last_q  <= 1'b0;
        end else if (advance_i && active_q) begin
            pc_q     <= again ? step : pc_q + 1'b1;
            none_q   <= none_q || (again && one);
            begins_q <= 1'b0;
            in_last_q  <= in_last_q || (steps_over && !again);
        end

    // The word is registered behind the memory, whose own output is late in its cycle.
    reg [PROGRAM_W-1:0] pc_1q, pc_2q;
    reg [`FP3_MARKS_W-1:0] marks_1q, marks_2q;
    reg              valid_1q, valid_2q;

    fp3_ram_registered #(.ADDR_W(PROGRAM_W)) u_program (
        .clk_i(clk_i), .write_i(write_i), .write_addr_i(write_addr_i), .write_value_i(write_word_i),
        .read_i(advance_i), .read_addr_i(pc_q), .read_value_o(word_o));

    always @(posedge clk_i)
        if (rst_i || stop_i) begin
            active_q <= 1'b0;
            valid_1q <= 1'b0;
            valid_2q <= 1'b0;
        end else if (start_i) begin
            active_q <= 1'b1;
        end else if (jump) begin
            active_q <= jump_on_i;
            valid_1q <= 1'b0;
            valid_2q <= 1'b0;
        end else if (advance_i) begin
            active_q <= active_q && (again || !ends || wraps);
            valid_1q <= active_q;
            valid_2q <= valid_1q;
        end

    always @(posedge clk_i)
        if (advance_i) begin
            pc_1q    <= pc_q;
            pc_2q    <= pc_1q;
            marks_1q <= {begins_q, ends && !again, pc_q == step, in_last_q};       // as marks.vh has them
            marks_2q <= marks_1q;
        end

    assign valid_o = valid_2q;
    assign pc_o    = pc_2q;
    assign marks_o = marks_2q;
    assign empty_o = !active_q && !valid_1q && !valid_2q;

`ifdef FP3_CHECK
    reg                 held_q, stop_q;
    reg [PROGRAM_W+31+4:0] shown_q;
    always @(posedge clk_i) begin
        held_q  <= valid_o && !advance_i && !stop_i && !jump && !rst_i;
        stop_q  <= stop_i && !rst_i;
        shown_q <= {pc_o, word_o, marks_2q};
        if (!rst_i && held_q && (!valid_o || {pc_o, word_o, marks_2q} != shown_q)) begin
            $display("%m: a word changes before it is taken"); $stop;
        end
        if (!rst_i && stop_q && !empty_o) begin
            $display("%m: something is left to deliver after a stop"); $stop;
        end
    end
`endif
endmodule
`default_nettype wire
`include "config/undefine.vh"
