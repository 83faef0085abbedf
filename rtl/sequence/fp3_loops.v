// SPDX-License-Identifier: Apache-2.0
// fp3_loops: the next word of a program with neighbours: loops, phases, batches.
//
// Purpose   Fetch delivers one word after the other. This module looks at each word that decode
//           takes, and says whether it issues and where fetch jumps. `phase` never issues. `each`
//           issues, and then no word is taken until the lanes have reported the longest list: if
//           all lists are empty, words are dropped up to `next`. `next` finds the next neighbours
//           and jumps back; in the last turn it does not issue.
//
//           A phase is a round (rounds). At its end, which is a `phase` or the program's end, the
//           next batch begins the same phase; after the last batch the next round begins behind the
//           `phase`. `repeat` and `again` are such ends, too: after `again` the next round begins
//           behind `repeat`, until its phases have been made as often as it says. `hold` is such an
//           end, too, of a phase that stores nothing published: the halves of the store stay as they
//           are, and the words behind it, as many as it says, are left out unless an object has raised
//           in this phase. An object says so some cycles after the phase is over, and before the next
//           one opens.
//
//           An entry ends behind the last field that a turn has read or written, by `ldl` or by number.
//
//           Loops are not nested, and no phase ends within a loop; software checks this.
//
//           Words of published registers are in both halves of the store: a phase loads from one
//           and stores in the other.
//
// Latency   around_o and drop_o are about the word that is taken in this cycle, jump_o comes a
//           cycle later.
// Hazard    jump_o comes while hold_o is high: fetch drops what it has fetched. half_o is stable
//           from a run's end to the next start: the host reads it, also after an abort.
//
//     lists of 2, 0, 1 entries:   each  ldn ..  next  ldn ..  next       turns 0 and 1
//     issues                      yes   yes     yes   yes     no
`default_nettype none
`include "front/decoded.vh"
`include "gen/settings.vh"
`include "lane/bundles.vh"
module fp3_loops #(
`include "config/config.vh"
) (
    input  wire                   clk_i,
    input  wire                   rst_i,
    // The run and its rounds
    input  wire                   start_i,       // a run starts
    input  wire                   abort_i,       // it ends early
    input  wire [`FP3_SETTINGS_W-1:0] settings_i,
    input  wire                   open_i,        // a round begins
    input  wire                   round_end_i,   // a round has come to its end
    input  wire                   raised_i,      // an object has raised in it
    // The word that is taken
    input  wire                   take_i,
    input  wire [`FP3_DECODED_W-1:0]  decoded_i,
    input  wire [PROGRAM_W-1:0]   pc_i,
    input  wire                   ends_i,        // the program's last
    input  wire                   more_i,        // there is another batch
    output wire                   drop_o,        // it does not issue
    output wire [AROUND_W-1:0]   around_o,
    output wire                   hold_o,        // no word may be taken
    input  wire                   still_i,       // no instruction waits or issues
    input  wire [LENGTH_W-1:0]    longest_i,     // list of all that have issued `each`
    // Fetch
    output wire                   jump_o,
    output wire                   jump_on_o,     // 0: nothing is left
    output wire                   jump_begins_o, // the next batch begins
    output wire [PROGRAM_W-1:0]   jump_pc_o,     // also where a round begins
    // The rounds
    output wire                   partial_o,     // the step has phases left
    output wire                   held_o,        // the round has come to a `hold`; until the next one opens
    output wire                   half_o         // which half of the store has the published words
);
    localparam [31:0] WAIT_32 = LANES + GROUPS + TIMING_LIST;
    localparam WAIT_W = $clog2(WAIT_32 + 1);
    `FP3_DECODED_FIELDS
    `FP3_SETTINGS_FIELDS
    `FP3_AROUND_FIELDS
    assign `FP3_DECODED  = decoded_i;
    assign `FP3_SETTINGS = settings_i;
    assign around_o  = `FP3_AROUND;

    reg                 inside_q, skips_q;             // in a loop; in a loop whose words are dropped
    reg                 waits_q, knows_q;              // its length is not yet known; was not known a cycle ago
    reg [WAIT_W-1:0]    wait_q;
    reg [LENGTH_W-1:0]  turn_q, turns_q;
    reg                 final_q;                       // this turn is the last one
    reg [STORE_W-1:0]   fields_q, load_q, end_q;       // an entry's first field, next `ldl`, end
    reg                 entry_q, field_q;              // the word taken a cycle ago begins an entry; reads or writes a field ...
    reg [STORE_W-1:0]   offset_q;                      // ... at this offset
    reg [PROGRAM_W-1:0] loop_q, phase_q;               // where they begin
    reg [PROGRAM_W-1:0] first_q;                       // where the phases begin that are repeated
    reg [REGISTER_W-1:0] left_q;                       // how often they are still made after this
    reg                 jump_q, on_q, begins_q, partial_q, half_q;
    reg [PROGRAM_W-1:0] target_q;

    wire [PROGRAM_W-1:0] behind = pc_i + 1'b1;
    wire begins = take_i && legal && each && !skips_q;
    wire turns  = take_i && legal && next && !skips_q;
    wire back   = turns && !final_q;
    wire over   = take_i && ((legal && phase) || ends_i) && !back;
    wire round = over && !more_i;                      // all batches have ended the phase
    wire [PROGRAM_W-1:0] left_out, there;              // words behind `hold`; where the words are that are left out, ...
    wire returns_there;                                // ... which are made
    wire once_more = returns && left_q != {REGISTER_W{1'b0}};
    wire [PROGRAM_W-1:0] ahead = once_more ? first_q : ends_i ? {PROGRAM_W{1'b0}} : behind + left_out;
    wire of_entry = ldl || stl;
    wire by_number = takes || stl;
    wire field  = take_i && legal && of_entry && !skips_q;
    wire known  = waits_q && still_i && wait_q == {WAIT_W{1'b0}};

    always @(posedge clk_i)
        if (rst_i || start_i || abort_i) begin
            {inside_q, skips_q, waits_q, knows_q, jump_q, partial_q} <= 6'd0;
            phase_q  <= {PROGRAM_W{1'b0}};
            target_q <= {PROGRAM_W{1'b0}};
        end else begin
            jump_q <= back || (over && (more_i || !ends_i));
            if (begins)                                 inside_q <= 1'b1;
            else if (over || (take_i && next && !back)) inside_q <= 1'b0;
            if (begins)                       waits_q <= 1'b1;
            else if (known)                   waits_q <= 1'b0;
            knows_q <= known;
            if (known)                        skips_q <= longest_i == {LENGTH_W{1'b0}};
            else if (over || (take_i && next)) skips_q <= 1'b0;
            if (back)                         target_q <= loop_q;
            else if (over && more_i)          target_q <= phase_q;
            else if (over)                    target_q <= ahead;
            else if (returns_there)           target_q <= there;
            if (returns_there) phase_q <= there;
            if (round) begin
                phase_q   <= ahead;
                partial_q <= once_more || !ends_i;
            end
        end
    always @(posedge clk_i) begin
        on_q     <= back || more_i;
        begins_q <= over;
        wait_q   <= waits_q && still_i ? wait_q - 1'b1 : WAIT_32[WAIT_W-1:0];
        if (known)  turns_q <= longest_i;
        if (begins) loop_q <= behind;
        if (begins)    turn_q <= {LENGTH_W{1'b0}};
        else if (back) turn_q <= turn_q + 1'b1;
        final_q  <= turn_q + 1'b1 == turns_q;
        // Words that are not dropped are taken in every second cycle at most, so there is time for
        // a register in between.
        {entry_q, field_q} <= {begins || back, field};
        offset_q           <= around_offset;
        if (entry_q) {fields_q, load_q, end_q} <= {3{offset_q + 1'b1}};
        else begin
            if (field && !by_number)             load_q <= load_q + 1'b1;
            if (field_q && offset_q >= end_q) end_q  <= offset_q + 1'b1;
        end
        if (round && repeats) {first_q, left_q} <= {behind, d - 1'b1};
        else if (round && returns) left_q <= left_q - 1'b1;
        if (start_i)          half_q <= setting_half;
        else if (round_end_i && !held_o) half_q <= !half_q;
    end
    // Between a `hold` and the next round: the words that it leaves out are made if an object has
    // raised.
    generate
        if (KEEP != 0) begin : g_hold
            reg                  held_q, chooses_q, raised_q;
            reg  [PROGRAM_W-1:0] there_q;
            wire [31:0]          words = {{32-REGISTER_W{1'b0}}, d};
            always @(posedge clk_i) begin
                if (rst_i || start_i || open_i) {held_q, chooses_q, raised_q} <= 3'd0;
                else begin
                    if (round && legal && holds) {held_q, chooses_q} <= {1'b1, !ends_i};
                    raised_q <= raised_q || raised_i;
                end
                if (round) there_q <= behind;
            end
            assign left_out      = legal && holds ? words[PROGRAM_W-1:0] : {PROGRAM_W{1'b0}};
            assign there         = there_q;
            assign returns_there = chooses_q && raised_q;
            assign held_o        = held_q;
            wire   unused_words  = &words;
        end else begin : g_no_hold
            assign {left_out, there} = {2*PROGRAM_W{1'b0}};
            assign {returns_there, held_o} = 2'd0;
            wire   unused_raised = &{open_i, raised_i};
        end
    endgenerate
    assign drop_o = skips_q || (legal && (phase || (next && final_q)));
    assign hold_o = waits_q || knows_q || jump_q;
    assign {jump_o, jump_on_o, jump_begins_o, jump_pc_o} = {jump_q, on_q, begins_q, target_q};
    assign {partial_o, half_o} = {partial_q, half_q};

    // Of the word that is taken
    wire [63:0] published = {setting_published_more, setting_published};
    wire [REGISTER_W-1:0] word = ldn ? b[REGISTER_W-1:0] : d;      // ldn has no b: it repeats a
    wire [5:0]  number = {{6-REGISTER_W{1'b0}}, word};
    wire [STORE_W-1:0] numbered = fields_q + {{STORE_W-REGISTER_W{1'b0}}, b[REGISTER_W-1:0]};
    assign around_each   = each;
    assign around_entry  = each || next;
    assign around_ldn    = ldn;
    assign around_ldl    = of_entry;
    assign around_inside = inside_q && !next;
    assign around_half   = (to_memory || ldn) && !of_entry && !around_entry && published[number] && half_q != st;
    assign around_turn   = each ? {LENGTH_W{1'b0}} : turn_q + 1'b1;
    assign around_offset = of_entry ? (by_number ? numbered : load_q)
                         : next ? end_q : each ? {STORE_W{1'b0}} : {{STORE_W-REGISTER_W{1'b0}}, word};

`ifdef FP3_CHECK
    always @(posedge clk_i)
        if (!rst_i) begin
            if (take_i && hold_o) begin
                $display("%m: a word is taken while none may be"); $stop;
            end
        end
`endif
endmodule
`default_nettype wire
`include "config/undefine.vh"
