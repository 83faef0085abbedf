"""Modules alone, each against a small model of what its header promises (MODULE_bench.py, cocotb in Icarus); and broken ones."""

import pytest

import simulate
from bugs import Bug, few, source, tree

TILE = {"CONTEXTS": 4, "STORE_WORDS": 128, "REGISTERS": 16, "ADD_LATENCY": 2, "MUL_LATENCY": 2}
# The parameters with which each is tested.
BENCHES = {
    "rounds": {**TILE, "LANES": 2},
    "lane_report": {**TILE, "LANES": 3},
    "issue": {**TILE, "MULTIPLY_ADD": 1},
    "keep": {**TILE, "MULTIPLY_ADD": 1, "NEIGHBOURS": 1, "SELECT": 1, "KEEP": 1},
    "exchange": {**TILE, "REGISTERS": 64, "LANES": 6, "ADD_LATENCY": 4, "MUL_LATENCY": 4, "NEIGHBOURS": 1},
    "lane": {**TILE, "MULTIPLY_ADD": 1, "LANES": 2, "EXCEPTIONS": 2, "CONTEXTS": 2, "STORE_WORDS": 64, "REGISTERS": 4},
}
# ... and those that have parameters of their own.
OWN = {"visits": {"CONTEXTS": 6, "CONTEXT_W": 3, "ROW_W": 4, "ENDED": 6}}
# By the promise that must be seen to be broken.
BUGS = {
    "rounds_divides_the_steps_into_visits": [
        Bug("the first visit is the last", "fp3_rounds.v", "steps_q <= all_q ? left_q : setting_visit", "steps_q <= left_q"),
        Bug("a visit of as many steps as there are is none", "fp3_rounds.v", "no_visit_q || high_more_q", "no_visit_q && high_more_q"),
        Bug("the clock stands still", "fp3_rounds.v", "base_q  <= base_q + steps_q;", "base_q  <= base_q;"),
        Bug("the last step of a round is that of the one before", "fp3_rounds.v", "end_q  <= base_q + steps_q;", "end_q  <= base_q;"),
        Bug("who sleeps is visited", "fp3_rounds.v", "(none_left_q && !partial_i) || count_i == {ROW_W+1{1'b0}}", "(none_left_q && !partial_i)"),
        Bug("no rest", "fp3_rounds.v", "settle_q - 1'b1 : SETTLE[SETTLE_W-1:0]", "settle_q - 1'b1 : SETTLE[SETTLE_W-1:0] - 1'b1"),
    ],
    "rounds_visits_beyond_65536_steps": [
        Bug("the upper half does not count", "fp3_rounds.v", "no_visit_q || high_more_q || (high_same_q && low_more_q)", "no_visit_q || low_more_q"),
        Bug("the lower half alone does not count", "fp3_rounds.v", "(high_same_q && low_more_q)", "1'b0"),
        Bug("the lower half counts for all", "fp3_rounds.v", "(high_same_q && low_more_q)", "low_more_q"),
    ],
    "rounds_compares_all_bits": [
        Bug("a bit of the upper half is not compared", "fp3_rounds.v", "setting_visit[31:16] == left_q[31:16]", "(setting_visit[31:16] | 16'd16) == (left_q[31:16] | 16'd16)"),
        Bug("a bit of the steps does not count", "fp3_rounds.v", "none_left_q <= left_q == 32'd0", "none_left_q <= (left_q & ~32'd64) == 32'd0"),
    ],
    "rounds_never_begins_fetch_after_an_abort": [
        Bug("fetch begins though aborted", "fp3_rounds.v", "begin_o   = open_o && !aborted_q", "begin_o   = open_o"),
        Bug("an abort is forgotten", "fp3_rounds.v", "aborted_q <= running_o && (aborted_q || abort_o)", "aborted_q <= running_o && abort_o"),
        Bug("a stop between stores", "fp3_rounds.v", "stopping && !storing_i", "stopping"),
        Bug("a stop that waits is lost", "fp3_rounds.v", "(stop_i || stopping_q)", "stop_i"),
        Bug("an illegal word does not end it", "fp3_rounds.v", "stop_q || illegal_i", "stop_q"),
    ],
    "rounds_starts_again_after_a_stop": [
        Bug("an abort outlives its run", "fp3_rounds.v", "running_o && (aborted_q || abort_o)", "(aborted_q || abort_o)"),
    ],
    "rounds_goes_on_with_a_step_of_several_phases": [
        Bug("a step is over after a phase", "fp3_rounds.v", "(none_left_q && !partial_i)", "none_left_q"),
        Bug("each phase is a step", "fp3_rounds.v", "rest_q <= partial_i ? left_q : left_q - steps_q", "rest_q <= left_q - steps_q"),
        Bug("the clock goes on in a step", "fp3_rounds.v", "state_q == PLAN && !partial_i", "state_q == PLAN"),
        Bug("an aborted phase counts", "fp3_rounds.v", "!issuing_i && !abort_o && !aborted_q", "!issuing_i"),
    ],
    "visits_visits_each_object_once_a_round": [
        Bug("an object is taken twice", "fp3_visits.v", "head_q  <= head_q + {{ROW_W-1{1'b0}}, take}", "head_q  <= head_q + {{ROW_W-1{1'b0}}, take && left_q[0]}"),
        Bug("a round goes on with those put back in it", "fp3_visits.v", "left_q <= left_q - 1'b1;", "left_q <= left_q - !put_q;"),
        Bug("the host wakes the row that was put back last", "fp3_visits.v", "write_value_i(put_q ? put_row_q : host_row_i)", "write_value_i(put_row_q)"),
        Bug("the row of the context's last object", "fp3_visits.v", "row_q        <= take_e2_i ? next_row : row_e2;", "row_q        <= row_e2;"),
        Bug("a store's row is not the object's", "fp3_visits.v", "st_row_q     <= st_row;", "st_row_q     <= row_e2;"),
        Bug("the list is not cleared", "fp3_visits.v", "if (rst_i || host_clear_i) begin", "if (rst_i) begin"),
    ],
    "visits_puts_back_nobody_who_is_absent": [
        Bug("absent objects are put back", "fp3_visits.v", "ends_q && !absent_d && !new_asleep_q", "ends_q && !new_asleep_q"),
        Bug("found asleep and put back", "fp3_visits.v", "ends_q && !absent_d && !new_asleep_q", "ends_q && !new_absent_q && !new_asleep_q"),
        Bug("found asleep and executed", "fp3_visits.v", "new_absent_q || (finds_q && nonzero_i)", "new_absent_q"),
        Bug("every load finds sleepers", "fp3_visits.v", "finds_q   <= lds_i && executed;", "finds_q   <= executed;"),
        Bug("executed for nobody", "fp3_visits.v", "valid_i && !absent && !(asleep && !in_last_i)", "valid_i && !(asleep && !in_last_i)"),
        Bug("a context's last object was absent, too", "fp3_visits.v", "begins_i ? !present_w0 : absent_q", "absent_q || (begins_i && !present_w0)"),
        Bug("an absent object is stored", "fp3_visits.v", "{st_absent_q, st_asleep_q} <= {st_absent, st_asleep};", "{st_absent_q, st_asleep_q} <= {1'b0, st_asleep};"),
    ],
    "visits_never_lets_an_object_fall_asleep_twice": [
        Bug("asleep, and falls asleep again", "fp3_visits.v", "executed && sleep_i && less_i && !asleep;", "executed && sleep_i && less_i;"),
        Bug("asleep without a small change", "fp3_visits.v", "executed && sleep_i && less_i && !asleep;", "executed && sleep_i && !asleep;"),
        Bug("awake in the next instruction", "fp3_visits.v", "new_asleep_q <= asleep || sleeps;", "new_asleep_q <= sleeps;"),
        Bug("still asleep in the next visit", "fp3_visits.v", "asleep   = !begins_i && asleep_q", "asleep   = asleep_q"),
        Bug("not stored in the last part", "fp3_visits.v", "!(asleep && !in_last_i)", "!asleep"),
        Bug("an object that sleeps is reported awake", "fp3_visits.v", "asleep_o    = state_absent_q || state_asleep_q", "asleep_o    = state_absent_q"),
        Bug("sleep changes nothing", "fp3_visits.v", "valid_i && (begins_i || lds_i || sleep_i)", "valid_i && (begins_i || lds_i)"),
    ],
    "visits_visits_nobody_who_fell_asleep": [
        Bug("asleep and put back", "fp3_visits.v", "ends_q && !absent_d && !new_asleep_q", "ends_q && !absent_d"),
    ],
    "lane_report_is_asleep_only_where_every_lane_is": [
        Bug("the last lane alone is heard", "fp3_lane_report.v", "report_asleep && asleep_i", "asleep_i"),
        Bug("one lane that sleeps is enough", "fp3_lane_report.v", "report_asleep && asleep_i", "report_asleep || asleep_i"),
        Bug("the news are of another context", "fp3_lane_report.v", ".d_i({batch_i, context_i})", ".d_i({batch_i, report_context})"),
    ],
    "lane_report_has_the_largest_count_and_all_flags": [
        Bug("the smallest count", "fp3_lane_report.v", "count_i > report_count ? count_i : report_count", "count_i > report_count ? report_count : count_i"),
        Bug("no room in a lane before", "fp3_lane_report.v", "report_no_room || no_room_i", "no_room_i"),
        Bug("this lane's room is not asked", "fp3_lane_report.v", "report_no_room || no_room_i", "report_no_room"),
        Bug("what this lane raises is lost", "fp3_lane_report.v", "report_raised || raised_i", "report_raised"),
        Bug("flags of this lane alone", "fp3_lane_report.v", "report_flags | flags_i", "flags_i"),
    ],
    "lane_report_answers_the_host_for_its_lane": [
        Bug("a copied word is the count", "fp3_lane_report.v", "copied_i || space == HOST_OBJECT", "space == HOST_OBJECT"),
        Bug("nobody says what is copied", "fp3_lane_report.v", "{32{mine || copied_i}}", "{32{mine}}"),
        Bug("an answer of the lane that was not asked", "fp3_lane_report.v", "(answer & {32{mine || copied_i}})", "answer"),
        Bug("an answer is lost on its way", "fp3_lane_report.v", "report_answer | (answer & {32{mine || copied_i}})", "(answer & {32{mine || copied_i}})"),
        Bug("a status in place of an object", "fp3_lane_report.v", "space == HOST_OBJECT ? stored_i", "space == HOST_OBJECT ? status_i"),
    ],
    "issue_names_operands_and_ends_of_each_instruction": [
        Bug("a constant is the object's register", "fp3_issue.v", "{x_q[REGISTER_W] ? SHARED : issue_context, x_q", "{issue_context, x_q"),
        Bug("a store of another register", "fp3_issue.v", "x_q    <= st || each || keeps || raises ? {1'b0, d} : a;", "x_q    <= a;"),
        Bug("a chain adds what it multiplies", "fp3_issue.v", "z_q    <= to_chain || valued ? c : a;", "z_q    <= valued ? c : a;"),
        Bug("a value is multiplied with one", "fp3_issue.v", "to_add && !valued", "to_add"),
        Bug("a product is added to a register", "fp3_issue.v", "zero_q <= to_mul;", "zero_q <= 1'b0;"),
        Bug("a store writes a register", "fp3_issue.v", "to_sleep, to_memory && !st && !each", "to_sleep, to_memory && !each"),
        Bug("z is told too soon", "fp3_issue.v", ".N(Z_LATE)) u_z", ".N(Z_LATE - 1)) u_z"),
        Bug("the end is told a cycle late", "fp3_issue.v", ".N(AHEAD+TO_END)) u_retire", ".N(AHEAD+TO_END+1)) u_retire"),
        Bug("first and last are mixed up", "fp3_issue.v", "assign retire_begins     = begins_q", "assign retire_begins     = ends_q"),
        Bug("two batches are one", "fp3_issue.v", "assign retire_batch      = batch_q", "assign retire_batch      = 1'b0"),
        Bug("a chain does not need the multiplier", "fp3_issue.v", "muls_o   = to_mul || to_chain", "muls_o   = to_mul"),
    ],
    "issue_gives_each_object_its_row": [
        Bug("every batch has the first rows", "fp3_issue.v", "base_q + BATCH", "base_q"),
        Bug("rows go on from round to round", "fp3_issue.v", "opened_q <= open_i || (opened_q && !issue_i)", "opened_q <= 1'b0"),
        Bug("the third batch has the rows of the second", "fp3_issue.v", "opened_q ? {ROW_W{1'b0}} : base_q + BATCH", "opened_q ? {ROW_W{1'b0}} : BATCH"),
        Bug("all contexts have one row", "fp3_issue.v", "assign row = base_q + place[ROW_W-1:0]", "assign row = base_q"),
    ],
    "issue_counts_the_steps": [
        Bug("a first part is in the first step", "fp3_issue.v", "{31'd0, late_newstep};", "{31'd0, late_newstep || late_begins};"),
        Bug("the next batch goes on counting", "fp3_issue.v", "(late_begins ? base_i : step_q)", "step_q"),
        Bug("a last part has the number of its step", "fp3_issue.v", "late_in_last ? end_i\n", "1'b0 ? end_i\n"),
        Bug("the number is a cycle late", "fp3_issue.v", ".N(AHEAD+TO_RESULT-1)) u_late", ".N(AHEAD+TO_RESULT)) u_late"),
    ],
    "keep_writes_the_rows_of_others": [
        Bug("an object without a neighbour has one", "fp3_keep.v", "takes_i3_i && !away_q", "takes_i3_i"),
        Bug("everybody is near", "fp3_keep.v", "keep_i3 && takes_i3_i", "keep_i3"),
        Bug("the neighbour of the instruction before", "fp3_keep.v", ".N(AHEAD)) u_other", ".N(AHEAD+1)) u_other"),
        Bug("the list is not begun anew", "fp3_keep.v", "& {LENGTH_W{!first_i3}}", "& {LENGTH_W{1'b1}}"),
        Bug("an entry beyond its room", "fp3_keep.v", "write_o = takes && !full", "write_o = takes"),
        Bug("room for one less", "fp3_keep.v", "length >= room_i3_i[LENGTH_W-1:0]", "length + 1'b1 >= room_i3_i[LENGTH_W-1:0]"),
        Bug("all bits of the room count", "fp3_keep.v", "length >= room_i3_i[LENGTH_W-1:0]", "{20'd0, length} >= room_i3_i"),
    ],
    "keep_counts_the_entries": [
        Bug("who is not near is counted", "fp3_keep.v", "length + {{LENGTH_W-1{1'b0}}, takes}", "length + 1'b1"),
        Bug("a list without room has its length", "fp3_keep.v", "takes && full ? {LENGTH_W{1'b1}} :", ""),
        Bug("no room for whom nobody wants", "fp3_keep.v", "no_room_q <= !rst_i && takes && full", "no_room_q <= !rst_i && keep_i3 && full"),
        Bug("an absent object raises", "fp3_keep.v", "raise_i3 && !away_q && list_i3_i[31]", "raise_i3 && list_i3_i[31]"),
        Bug("all raise", "fp3_keep.v", "raise_i3 && !away_q && list_i3_i[31]", "raise_i3 && !away_q"),
    ],
    "exchange_copies_each_published_word_of_the_list": [
        Bug("the first copy of a list alone", "fp3_exchange.v", "if (index_q == end_index_q) state_q <= LOW", "state_q <= LOW"),
        Bug("a copy is left out", "fp3_exchange.v", "setting_copies[STORE_W-1:1] - 1'b1", "setting_copies[STORE_W-1:1] - 2'd2"),
        Bug("words from 32 on are not copied", "fp3_exchange.v", "{setting_published_more, setting_published};", "{32'd0, setting_published};"),
        Bug("a word is left out", "fp3_exchange.v", "left_q <= left_q & ~low_q", "left_q <= left_q & ~{low_q[62:0], 1'b0} & ~low_q"),
        Bug("the lane of another copy", "fp3_exchange.v", "to_index_q <= to_reads ? to_index_q + 1'b1", "to_index_q <= to_reads ? to_index_q"),
        Bug("a word of the wrong number", "fp3_exchange.v", ".N(WAY)) u_to_register", ".N(WAY-4)) u_to_register"),
        Bug("a copy comes a cycle early", "fp3_exchange.v", ".N(WAY)) u_to_reads", ".N(WAY-1)) u_to_reads"),
        Bug("the lower half always", "fp3_exchange.v", "around_half   = half_i", "around_half   = 1'b0"),
        Bug("nothing goes to all", "fp3_exchange.v", "to_all ? HOST_EVERY : HOST_OBJECT", "HOST_OBJECT"),
        Bug("small records", "fp3_exchange.v", "{to_row, 3'd0} << setting_record", "{to_row, 3'd0}"),
        Bug("the end comes at once", "fp3_exchange.v", "state_q == DRAIN ? drain_q - 1'b1 : WAY_32[DRAIN_W-1:0]", "{DRAIN_W{1'b0}}"),
    ],
    "exchange_takes_a_cycle_for_each_copy": [
        Bug("an empty list has copies", "fp3_exchange.v", "left_q != 64'd0 && !none", "left_q != 64'd0"),
    ],
    "exchange_is_silent_after_an_abort": [
        Bug("copies go on", "fp3_exchange.v", "if (rst_i || abort_i) begin", "if (rst_i) begin"),
        Bug("the last words go on", "fp3_exchange.v", "u_to (.clk_i(clk_i), .rst_i(rst_i || abort_i)", "u_to (.clk_i(clk_i), .rst_i(rst_i)"),
    ],
    "lane_executes_for_the_objects_that_are_there": [
        Bug("an absent object writes", "fp3_lane_end.v", "(executed && (arithmetic_w0 || load_w0)) || sleeps", "(valid_w0 && (arithmetic_w0 || load_w0)) || sleeps"),
        Bug("flags of an absent object", "fp3_lane.v", "FLAGS != 0 && end_writes && end_arithmetic", "FLAGS != 0 && end_valid && end_arithmetic"),
        Bug("an absent object is stored", "fp3_lane_store.v", "st_i2 && !move_st_absent &&", "st_i2 &&"),
        Bug("a load raises flags", "fp3_lane.v", "FLAGS != 0 && end_writes && end_arithmetic", "FLAGS != 0 && end_writes"),
        Bug("a load has the result", "fp3_lane.v", ".value_i(end_arithmetic ? result_value : other)", ".value_i(result_value)"),
        Bug("a store of every lane", "fp3_lane.v", "to_store     = (write && access_space == HOST_OBJECT)", "to_store     = (access_valid && access_write && access_space == HOST_OBJECT)"),
        Bug("a constant of this lane alone", "fp3_lane.v", "to_constants = access_valid && access_write", "to_constants = write"),
        Bug("a half is a quarter", "fp3_lane_operands.v", "!twice_i2 && !halve_i2", "!twice_i2"),
        Bug("-0 is 0", "fp3_lane_operands.v", "z_q <= BITS_MINUS_ZERO", "z_q <= 32'd0"),
        Bug("one row for all", "fp3_lane_end.v", ".d_i(retire_row)", ".d_i({ROW_W{1'b0}})"),
        Bug("a full store counts as nobody", "fp3_lane_end.v", "count_q <= data_i[ROW_W:0];", "count_q <= {1'b0, data_i[ROW_W-1:0]};"),
        Bug("one object too many", "fp3_lane_end.v", "{1'b0, retire_row} >= count_q", "{1'b0, retire_row} > count_q"),
    ],
    "lane_keeps_the_step_of_the_first_failure": [
        Bug("the last failure counts", "fp3_lane_status.v", "status_o[31:5] == 27'd0 && (flags_i[4] || flags_i[2])", "(flags_i[4] || flags_i[2])"),
        Bug("an overflow is none", "fp3_lane_status.v", "(flags_i[4] || flags_i[2])", "flags_i[4]"),
        Bug("every exception is a failure", "fp3_lane_status.v", "(flags_i[4] || flags_i[2])", "|flags_i"),
        Bug("earlier exceptions are forgotten", "fp3_lane_status.v", "status_o[4:0] | flags_i", "flags_i"),
    ],
}


def bench(root, folder, name, tree, *options, **environment):
    parameters = OWN[name] if name in OWN else {"CONFIG": simulate.config_word(tree, BENCHES[name])}
    chosen = [f"-Pfp3_{name}.{key}={value}" for key, value in parameters.items()]
    vvp = simulate.compiled(tree, folder, f"fp3_{name}", source(tree, f"fp3_{name}.v"), *chosen, *options)
    return simulate.cocotb(root, folder, vvp, root / f"tests/modules/{name}_bench.py", FP3_RTL=tree / "rtl", **environment)


@pytest.mark.parametrize("name", [*BENCHES, *OWN])
def test_a_module_keeps_its_promises(root, tmp_path, name):
    """... and the bench keeps the module's conditions: its own checks are silent."""
    done = bench(root, tmp_path, name, root, "-DFP3_CHECK")
    assert done.passed, done.said


def bench_of(promise):
    return max((name for name in (*BENCHES, *OWN) if promise.startswith(name)), key=len)


@pytest.mark.parametrize("promise, bug", few(((f"{promise}: {bug.name}", promise, bug) for promise in BUGS for bug in BUGS[promise]),
                                             lambda row: bench_of(row[0])))
def test_a_broken_promise_is_seen(root, tmp_path, promise, bug):
    done = bench(root, tmp_path, bench_of(promise), tree(root, tmp_path, bug), TESTCASE=promise)
    assert done.failed == [promise] and "AssertionError" in done.said, done.said
