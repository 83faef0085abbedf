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

SUBJECTS = [ROUNDS]
