"""The promises of the modules that run a program over many objects."""

from subject import Subject


def named(*names, **keys):
    return [{"CONFIG": name, **keys} for name in names]


# ---- the rounds ----------------------------------------------------------------------------------

# Rest soon, so that a run from reset reaches a second round.
PHASES, = named("world_keep", SETTLE=2)
COPIES, = named("fabric", SETTLE=2)

ROUNDS = Subject(
    "rounds_spec", ("fp3_rounds.v",), "", [*named("many_full", "world_keep", "fabric"), PHASES, COPIES], [
        ("a full store counts as nobody awake", "count_i == {ROW_W+1{1'b0}}", "count_i[ROW_W-1:0] == {ROW_W{1'b0}}", PHASES),
        ("nobody is awake, and the run goes on", "|| count_i == {ROW_W+1{1'b0}}", "", PHASES),
        ("a run ends within a step", "(none_left_q && !partial_i)", "none_left_q", PHASES),
        ("the last round is made again", "none_left_q <= left_q == 32'd0", "none_left_q <= 1'b0", PHASES),
        ("the first visit is the last", "steps_q <= all_q ? left_q : setting_visit", "steps_q <= left_q", PHASES),
        ("a visit of more steps than there are", "steps_q <= all_q ? left_q : setting_visit", "steps_q <= no_visit_q ? left_q : setting_visit", PHASES),
        ("only the lower half is compared", "high_more_q || (high_same_q && low_more_q)", "low_more_q", PHASES),
        ("each phase is a step", "partial_i ? left_q : left_q - steps_q", "left_q - steps_q", PHASES),
        ("the clock goes on in a step", "state_q == PLAN && !partial_i", "state_q == PLAN", PHASES),
        ("the clock stands still", "base_q  <= base_q + steps_q;", "base_q  <= base_q;", PHASES),
        ("steps of the run before", "{setting_steps, setting_clock, 32'd0}", "{setting_steps, setting_clock, steps_q}", PHASES),
        ("the last step is that of the round before", "end_q  <= base_q + steps_q;", "end_q  <= base_q;", PHASES),
        ("a cycle too little rest", "settle_q - 1'b1 : SETTLE[SETTLE_W-1:0]", "settle_q - 1'b1 : SETTLE[SETTLE_W-1:0] - 1'b1", PHASES),
        ("a rest that goes on after it was long enough", "state_q == WAIT ? settle_q - 1'b1", "state_q != IDLE ? settle_q - 1'b1", PHASES),
        ("a stop between stores", "stopping && !storing_i", "stopping", PHASES),
        ("a stop that waits is lost", "(stop_i || stopping_q)", "stop_i", PHASES),
        ("a stop survives its run", "running_o && !stop_q && (stop_i", "!stop_q && (stop_i", PHASES),
        ("a stop acts twice", "running_o && !stop_q &&", "running_o &&", PHASES),
        ("an illegal word does not end it", "stop_q || illegal_i", "stop_q", PHASES),
        ("a round begins though aborted", "begin_o   = open_o && !aborted_q", "begin_o   = open_o", PHASES),
        ("an abort is forgotten", "running_o && (aborted_q || abort_o)", "running_o && abort_o", PHASES),
        ("an abort survives its run", "running_o && (aborted_q || abort_o)", "aborted_q || abort_o", PHASES),
        ("an aborted round has closed", "!issuing_i && !abort_o && !aborted_q", "!issuing_i && !abort_o", PHASES),
        ("no room, and the run goes on", "if (KEEP != 0 && running_o && no_room_i) aborted_q <= 1'b1;", "", PHASES),
        ("a run survives reset", "state_q   <= IDLE;\n            aborted_q", "aborted_q", PHASES),
        ("a round without copies", "over ? IDLE : EXCHANGE != 0 ? COPY : PLAN", "over ? IDLE : PLAN", COPIES),
        ("copies for a run that is over", "EXCHANGE != 0 && settled_o && !over", "EXCHANGE != 0 && settled_o", COPIES),
        ("copies are not waited for", "else if (copied_i) state_q <= PLAN", "else state_q <= PLAN", COPIES),
        ("after an abort copies are waited for", "if (aborted_q)     state_q <= WAIT;", "if (1'b0)     state_q <= WAIT;", COPIES),
    ], cycles=18)

# ---- loops over neighbours -------------------------------------------------------------------------

# Lists are told soon, for the runs from reset.
LOOP, = named("world_keep", TIMING_LIST=0)

LOOPS = Subject(
    "loops_spec", ("fp3_loops.v",), "", [*named("world", "world_keep", "fabric"), LOOP], [
        ("neighbours see r32 and above of this step", "published = {setting_published_more, setting_published}", "published = {32'd0, setting_published}", LOOP),
        ("a published word is loaded of the other half", "&& half_q != st;", "&& half_q == st;", LOOP),
        ("a word of a list has a half", "(to_memory || ldn) && !of_entry &&", "(to_memory || ldn) &&", LOOP),
        ("the neighbour's word by the own register's number", "ldn ? b[REGISTER_W-1:0] : d", "d", LOOP),
        ("words are taken while lists are not told", "hold_o = waits_q || knows_q || jump_q", "hold_o = knows_q || jump_q", LOOP),
        ("words are taken in the cycle of a jump", "hold_o = waits_q || knows_q || jump_q", "hold_o = waits_q || knows_q", LOOP),
        ("lists are told a cycle early", "wait_q - 1'b1 : WAIT_32[WAIT_W-1:0]", "wait_q - 1'b1 : WAIT_32[WAIT_W-1:0] - 1'b1", LOOP),
        ("lists are told while `each` issues", "waits_q && still_i ? wait_q", "waits_q ? wait_q", LOOP),
        ("an empty list has a turn", "skips_q <= longest_i == {LENGTH_W{1'b0}}", "skips_q <= 1'b0", LOOP),
        ("words behind the loop are dropped, too", "else if (over || (take_i && next)) skips_q <= 1'b0", "else if (over) skips_q <= 1'b0", LOOP),
        ("a turn too few", "final_q  <= turn_q + 1'b1 == turns_q", "final_q  <= turn_q + 2'd2 == turns_q", LOOP),
        ("turns go on from the loop before", "if (begins)    turn_q <= {LENGTH_W{1'b0}};", "if (1'b0)    turn_q <= {LENGTH_W{1'b0}};", LOOP),
        ("`next` issues in the last turn", "(phase || (next && final_q))", "phase", LOOP),
        ("a turn begins at `each`", "if (begins) loop_q <= behind", "if (begins) loop_q <= pc_i", LOOP),
        ("the first entry again", "next ? end_q : each", "next ? fields_q : each", LOOP),
        ("an entry ends with the last field read in order", "if (field_q && offset_q >= end_q) end_q  <= offset_q + 1'b1", "if (field_q && offset_q >= end_q) end_q  <= load_q", LOOP),
        ("an entry ends behind the field touched last", "field_q && offset_q >= end_q", "field_q", LOOP),
        ("fields by number from the list's begin", "numbered = fields_q +", "numbered =", LOOP),
        ("a field by number moves those in order", "if (field && !by_number)", "if (field)", LOOP),
        ("behind a loop words are of it", "around_inside = inside_q && !next", "around_inside = 1'b1", LOOP),
        ("`next` in the turn before", "each ? {LENGTH_W{1'b0}} : turn_q + 1'b1", "each ? {LENGTH_W{1'b0}} : turn_q", LOOP),
        ("a batch begins at the program's first word", "target_q <= phase_q;", "target_q <= {PROGRAM_W{1'b0}};", LOOP),
        ("a round begins with the phase that is over", "phase_q   <= ahead;", "phase_q   <= phase_q;", LOOP),
        ("a step is over after a phase", "partial_q <= once_more || !ends_i", "partial_q <= 1'b0", LOOP),
        ("phases are made once more", "{behind, d - 1'b1}", "{behind, d}", LOOP),
        ("phases are made once", "returns && left_q != {REGISTER_W{1'b0}}", "1'b0", LOOP),
        ("they begin with `repeat` itself", "{first_q, left_q} <= {behind,", "{first_q, left_q} <= {pc_i,", LOOP),
        ("the halves stay", "else if (round_end_i && !held_o) half_q <= !half_q", "", LOOP),
        ("`hold` changes the halves", "round_end_i && !held_o", "round_end_i", LOOP),
        ("`hold` leaves out nothing", "left_out      = legal && holds ? words[PROGRAM_W-1:0]", "left_out      = legal && holds ? {PROGRAM_W{1'b0}}", LOOP),
        ("`hold` leaves out its words though one has raised", "returns_there = chooses_q && raised_q", "returns_there = 1'b0", LOOP),
        ("who has raised counts in the next phase", "if (rst_i || start_i || open_i) {held_q, chooses_q, raised_q} <= 3'd0;", "if (rst_i || start_i) {held_q, chooses_q, raised_q} <= 3'd0; else if (open_i) {held_q, chooses_q} <= 2'd0;", LOOP),
    ])

# ---- copies from lane to lane ----------------------------------------------------------------------

# A short way, for the runs from reset.
LANES, = named("fabric", lanes=2, TIMING_END=1)

EXCHANGE = Subject(
    "exchange_spec", ("fp3_exchange.v", "fp3_delay.v"), "", [*named("fabric"), LANES], [
        ("r32 and above are not copied", "left_q <= {setting_published_more, setting_published}", "left_q <= {32'd0, setting_published}", LANES),
        ("the first copy of a list alone", "if (index_q == end_index_q) state_q <= LOW", "state_q <= LOW", LANES),
        ("a copy is left out", "setting_copies[STORE_W-1:1] - 1'b1", "setting_copies[STORE_W-1:1] - 2'd2", LANES),
        ("a word is left out", "left_q <= left_q & ~low_q", "left_q <= left_q & ~{low_q[62:0], 1'b0} & ~low_q", LANES),
        ("a word is copied for ever", "left_q <= left_q & ~low_q", "left_q <= left_q", LANES),
        ("the row of the first copy for all", "index_q <= state_q == WALK ? index_q + 1'b1", "index_q <= state_q == WALK && index_q != 0 ? index_q + 1'b1", LANES),
        ("the lane of another copy", "to_index_q <= to_reads ? to_index_q + 1'b1", "to_index_q <= to_reads ? to_index_q", LANES),
        ("a word of the wrong number", ".N(WAY)) u_to_register (.clk_i(clk_i), .rst_i(1'b0), .d_i(from_register)", ".N(1)) u_to_register (.clk_i(clk_i), .rst_i(1'b0), .d_i(register_q)", LANES),
        ("a copy comes a cycle early", ".N(WAY)) u_to_reads", ".N(WAY-1)) u_to_reads", LANES),
        ("the lower half is read always", "around_half   = half_i", "around_half   = 1'b0", LANES),
        ("the lower half is written always", "{half_i, {STORE_W-1{1'b0}}}", "{STORE_W{1'b0}}", LANES),
        ("nothing goes to all", "to_all ? HOST_EVERY : HOST_OBJECT", "HOST_OBJECT", LANES),
        ("small records", "{to_row, 3'd0} << setting_record", "{to_row, 3'd0}", LANES),
        ("the end comes at once", "state_q == DRAIN ? drain_q - 1'b1 : WAY_32[DRAIN_W-1:0]", "{DRAIN_W{1'b0}}", LANES),
        ("an empty list has copies", "left_q != 64'd0 && !none", "left_q != 64'd0", LANES),
        ("copies go on after an abort", "if (rst_i || abort_i) begin", "if (rst_i) begin", LANES),
        ("the last words go on after an abort", "u_to (.clk_i(clk_i), .rst_i(rst_i || abort_i)", "u_to (.clk_i(clk_i), .rst_i(rst_i)", LANES),
        ("the other half of the list is written", "to_write = write_i && write_addr_i[0]", "to_write = write_i && !write_addr_i[0]", LANES),
    ], models=("one_late_word.v",), cycles=14)

# ---- fetch ----------------------------------------------------------------------------------------

STRAIGHT, = named("many")
JUMPS, = named("world")

FETCH = Subject(
    "fetch_spec", ("fp3_fetch.v",), "", [STRAIGHT, JUMPS], [
        ("the step part once too often", "again      = steps_over && !none_q && !skip_i", "again      = steps_over && !skip_i && steps_q != 32'd0", STRAIGHT),
        ("the step part once", "none_q   <= steps_i == 32'd1", "none_q   <= 1'b1", STRAIGHT),
        ("the last step is not the last", "(pending_q ? 32'd3 : 32'd2)", "32'd2", STRAIGHT),
        ("a step counts twice", "else if (pending_q) steps_q <= fewer", "else steps_q <= fewer", STRAIGHT),
        ("steps are not left out", "!none_q && !skip_i", "!none_q", STRAIGHT),
        ("a step begins at the first word", "again ? step : pc_q + 1'b1", "again ? {PROGRAM_W{1'b0}} : pc_q + 1'b1", STRAIGHT),
        ("the last word of a step part is left out", "step_end_q <= setting_last[PROGRAM_W-1:0] - 1'b1", "step_end_q <= setting_last[PROGRAM_W-1:0] - 2'd2", STRAIGHT),
        ("the program's last word is left out", "end_q      <= setting_size[PROGRAM_W-1:0] - 1'b1", "end_q      <= setting_size[PROGRAM_W-1:0] - 2'd2", STRAIGHT),
        ("a step of one word", "again ? {again_over, again_ends}", "again ? {1'b0, again_ends}", STRAIGHT),
        ("a program of one word", "{zero_over, zero_ends};", "{1'b0, 1'b0};", STRAIGHT),
        ("no other visit", "again || !ends || wraps", "again || !ends", STRAIGHT),
        ("another visit always", "again || !ends || wraps", "1'b1", STRAIGHT),
        ("a visit begins unseen", "again_o  = anew && !start_i", "again_o  = 1'b0", STRAIGHT),
        ("the last part is none", "in_last_q || (steps_over && !again)", "in_last_q", STRAIGHT),
        ("each step part ends in the last one", "in_last_q || (steps_over && !again)", "in_last_q || steps_over", STRAIGHT),
        ("the end is marked within steps", "{begins_q, ends && !again,", "{begins_q, ends,", STRAIGHT),
        ("each word begins a visit", "none_q   <= none_q || (again && one);\n            begins_q <= 1'b0;", "none_q   <= none_q || (again && one);", STRAIGHT),
        ("a word is lost while its taker waits", "pc_2q    <= pc_1q;", "pc_2q    <= pc_q;", STRAIGHT),
        ("memory goes on while its taker waits", ".read_i(advance_i)", ".read_i(1'b1)", STRAIGHT),
        ("a stop leaves a word", "if (rst_i || stop_i) begin", "if (rst_i) begin", STRAIGHT),
        ("a jump leaves words", "active_q <= jump_on_i;\n            valid_1q <= 1'b0;", "active_q <= jump_on_i;", JUMPS),
        ("a jump to nowhere goes on", "active_q <= jump_on_i;", "active_q <= 1'b1;", JUMPS),
        ("a batch begins within its visit", "|| (jump && jump_begins_i)", "", JUMPS),
        ("a jump to the end is none", "{from == step_end_q, from == end_q}", "{from == step_end_q, 1'b0}", JUMPS),
        ("a visit goes on by itself", "wraps      = NEIGHBOURS == 0 && more_i", "wraps      = more_i", JUMPS),
    ], models=("one_late_word.v",), cycles=18)

SUBJECTS = [ROUNDS, LOOPS, EXCHANGE, FETCH]
