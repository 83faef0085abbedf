// fetch_spec: the promises of fp3_fetch.v, for every program and number of steps: the words of a visit in order, each as many cycles
// behind the one before as its taker waits. One word of the memory is followed, whichever.
`default_nettype none
`include "front/marks.vh"
`include "gen/settings.vh"
module fetch_spec #(
    parameter LEMMAS = 1,
`include "config/config.vh"
) (
    input wire                       clk_i,
    input wire                       rst_i,
    input wire                       write_i,
    input wire [PROGRAM_W-1:0]       write_addr_i,
    input wire [31:0]                write_word_i,
    input wire                       start_i, stop_i, over_i, skip_i, more_i, jump_i, jump_on_i, jump_begins_i, advance_i,
    input wire [`FP3_SETTINGS_W-1:0] settings_i,
    input wire [31:0]                steps_i,
    input wire [PROGRAM_W-1:0]       jump_pc_i
);
    `FP3_SETTINGS_FIELDS
    `FP3_MARKS_FIELDS
    assign `FP3_SETTINGS = settings_i;
    wire                    again_o, valid, empty;
    wire [PROGRAM_W-1:0]    pc;
    wire [31:0]             word;
    wire [`FP3_MARKS_W-1:0] marks;
    assign `FP3_MARKS = marks;
    fp3_fetch #(.CONFIG(CONFIG)) u_fetch (.clk_i(clk_i), .rst_i(rst_i), .write_i(write_i), .write_addr_i(write_addr_i), .write_word_i(write_word_i),
        .start_i(start_i), .stop_i(stop_i), .settings_i(settings_i), .steps_i(steps_i), .skip_i(skip_i), .more_i(more_i), .again_o(again_o),
        .jump_i(jump_i), .jump_on_i(jump_on_i), .jump_begins_i(jump_begins_i), .jump_pc_i(jump_pc_i),
        .advance_i(advance_i), .valid_o(valid), .pc_o(pc), .word_o(word), .marks_o(marks), .empty_o(empty));

    // The next word: the first part, the step part as often as there are steps left, the last part, and the next visit
    reg                  started_q = 1'b0, reset_q;
    reg                  run_q;                            // a run is under way: until nothing is left, and the round's end is the run's (over_i)
    reg                  live_q, first_q, last_q;          // there is one; the first of its visit; in the last part
    reg [PROGRAM_W-1:0]  at_q;
    reg [31:0]           left_q;                           // steps, this one too
    wire [PROGRAM_W:0]   behind = at_q + 1'b1;
    wire                 again  = behind == setting_last && left_q > 1 && !skip_i;
    wire                 ended  = behind == setting_size && !again;
    wire                 jumps  = NEIGHBOURS != 0 && jump_i, wraps = NEIGHBOURS == 0 && more_i;
    wire [PROGRAM_W-1:0] from   = NEIGHBOURS != 0 ? jump_pc_i : {PROGRAM_W{1'b0}};
    wire                 goes   = advance_i && live_q;
    wire                 anew   = start_i || (jumps && jump_begins_i) || (goes && !jumps && ended && wraps);
    // Two words on their way
    reg                     live_1q, live_2q;
    reg [PROGRAM_W-1:0]     at_1q, at_2q;
    reg [`FP3_MARKS_W-1:0]  marks_1q, marks_2q;
    reg [2:0]               same_q;                        // cycles in which the settings have stayed, up to 4
    reg [`FP3_SETTINGS_W-1:0] settings_q;
    always @(posedge clk_i) begin
        {started_q, reset_q} <= {1'b1, rst_i};
        settings_q <= settings_i;
        run_q      <= !rst_i && !stop_i && (start_i || (run_q && !(empty && over_i && !jumps)));
        same_q     <= !started_q || settings_i != settings_q ? 3'd0 : same_q == 3'd4 ? 3'd4 : same_q + 1'b1;
        if (rst_i || stop_i)  {live_q, live_1q, live_2q} <= 3'd0;
        else if (start_i)     live_q <= 1'b1;
        else if (jumps)       {live_q, live_1q, live_2q} <= {jump_on_i, 2'b00};
        else if (advance_i)   {live_q, live_1q, live_2q} <= {live_q && (!ended || wraps), live_q, live_1q};
        if (anew)             {at_q, left_q, first_q, last_q} <= {from, steps_i, 2'b10};
        else if (jumps)       {at_q, first_q, last_q} <= {from, 2'b00};
        else if (goes)        {at_q, left_q, first_q, last_q} <= {again ? setting_step[PROGRAM_W-1:0] : behind[PROGRAM_W-1:0], left_q - again, 1'b0,
                                                                  last_q || (behind == setting_last && !again)};
        if (advance_i) begin
            {at_1q, marks_1q} <= {at_q, first_q, ended, at_q == setting_step, last_q};
            {at_2q, marks_2q} <= {at_1q, marks_1q};
        end
    end

    // The memory
    (* hierconn *) wire [PROGRAM_W-1:0] \u_fetch.u_program.which ;
    (* hierconn *) wire [31:0]          \u_fetch.u_program.kept_q ;
    reg [31:0] kept_q;
    always @(posedge clk_i) if (write_i && write_addr_i == \u_fetch.u_program.which ) kept_q <= write_word_i;

    always @* begin
        assume (started_q || rst_i);
        assume (started_q || kept_q == \u_fetch.u_program.kept_q );                        // at power-up
        assume (setting_step < setting_last && setting_last <= setting_size && setting_size <= PROGRAM_WORDS);
        assume (steps_i != 32'd0);
        assume (!start_i || (empty && settings_i == settings_q && same_q == 3'd4 && !jump_i && !stop_i && !rst_i));
        assume (!run_q || (settings_i == settings_q && !write_i));
        assume (!jump_i || (run_q && !advance_i && NEIGHBOURS != 0));
        assume (!start_i || !write_i);
    end
    always @* if (started_q) begin
        assert (valid == live_2q && empty == (!live_q && !live_1q && !live_2q));
        if (valid) assert (pc == at_2q && {begins, ends, newstep, in_last} == marks_2q);
        if (valid && pc == \u_fetch.u_program.which ) assert (word == kept_q);
        assert (again_o == (anew && !start_i));                                              // fetch begins the next visit
        if (reset_q) assert (empty);
    end

    (* hierconn *) wire                 \u_fetch.active_q , \u_fetch.valid_1q , \u_fetch.valid_2q , \u_fetch.begins_q , \u_fetch.in_last_q , \u_fetch.none_q ;
    (* hierconn *) wire                 \u_fetch.pending_q , \u_fetch.steps_over , \u_fetch.ends , \u_fetch.again_over , \u_fetch.again_ends ;
    (* hierconn *) wire                 \u_fetch.zero_over , \u_fetch.zero_ends ;
    (* hierconn *) wire [PROGRAM_W-1:0] \u_fetch.pc_q , \u_fetch.pc_1q , \u_fetch.pc_2q , \u_fetch.step_end_q , \u_fetch.end_q ;
    (* hierconn *) wire [PROGRAM_W-1:0] \u_fetch.before_step_end_q , \u_fetch.before_end_q ;
    (* hierconn *) wire [31:0]          \u_fetch.steps_q ;
    (* hierconn *) wire [`FP3_MARKS_W-1:0] \u_fetch.marks_1q , \u_fetch.marks_2q ;
    (* hierconn *) wire                 \u_fetch.u_program.it_q , \u_fetch.u_program.late_q ;
    (* hierconn *) wire [31:0]          \u_fetch.u_program.word_q , \u_fetch.u_program.read_q ;
    wire [PROGRAM_W:0] step_end = setting_last - 1'b1, size_end = setting_size - 1'b1;
    generate
        if (LEMMAS != 0) begin : g_lemmas
            always @* if (started_q) begin
                assert (\u_fetch.active_q == live_q && \u_fetch.valid_1q == live_1q && \u_fetch.valid_2q == live_2q);
                assert (same_q <= 3'd4 && (empty || run_q) && (!run_q || same_q == 3'd4) && \u_fetch.u_program.kept_q == kept_q);
                if (settings_i == settings_q) assert (\u_fetch.step_end_q == step_end[PROGRAM_W-1:0] && \u_fetch.end_q == size_end[PROGRAM_W-1:0]);
                if (settings_i == settings_q && same_q >= 3'd1) begin
                    assert (\u_fetch.again_over == (setting_step == step_end) && \u_fetch.again_ends == (setting_step == size_end));
                    assert (\u_fetch.zero_over == (step_end == 0) && \u_fetch.zero_ends == (size_end == 0));
                    assert (\u_fetch.before_step_end_q == \u_fetch.step_end_q - 1'b1 && \u_fetch.before_end_q == \u_fetch.end_q - 1'b1);
                end
                if (live_q) begin
                    assert (\u_fetch.pc_q == at_q && \u_fetch.begins_q == first_q && \u_fetch.in_last_q == last_q);
                    assert (\u_fetch.steps_over == (at_q == \u_fetch.step_end_q ) && \u_fetch.ends == (at_q == \u_fetch.end_q ));
                end
                if (run_q) assert (left_q != 0 && \u_fetch.none_q == (left_q == 1) && \u_fetch.steps_q - \u_fetch.pending_q == left_q);
                if (live_1q) assert (\u_fetch.pc_1q == at_1q && \u_fetch.marks_1q == marks_1q);
                if (live_2q) assert (\u_fetch.pc_2q == at_2q && \u_fetch.marks_2q == marks_2q);
                if (live_1q) assert (\u_fetch.u_program.it_q == (at_1q == \u_fetch.u_program.which ) && (!\u_fetch.u_program.it_q || \u_fetch.u_program.word_q == kept_q));
                if (live_2q) assert (\u_fetch.u_program.late_q == (at_2q == \u_fetch.u_program.which ) && (!\u_fetch.u_program.late_q || \u_fetch.u_program.read_q == kept_q));
            end
        end
    endgenerate
endmodule
`default_nettype wire
`include "config/undefine.vh"
