"""Modules alone, each against a small model of what its header promises (MODULE_bench.py, cocotb in Icarus); and broken ones."""

import pytest

import simulate
from bugs import Bug, source, tree

TILE = {"INTERLEAVE": 1, "CONTEXTS": 4, "STORE_WORDS": 128, "REGISTERS": 16, "ADD_LATENCY": 2, "MUL_LATENCY": 2}
# The parameters with which each is tested.
BENCHES = {
    "rounds": {**TILE, "LANES": 2},
    "visits": {**TILE, "SLEEP": 1},
}
# By the promise that must be seen to be broken.
BUGS = {
    "rounds_divides_the_steps_into_visits": [
        Bug("the first visit is the last", "rounds.v", "steps_q <= all_q ? left_q : setting_visit", "steps_q <= left_q"),
        Bug("a visit of as many steps as there are is none", "rounds.v", "no_visit_q || high_more_q", "no_visit_q && high_more_q"),
        Bug("the clock stands still", "rounds.v", "base_q  <= base_q + steps_q;", "base_q  <= base_q;"),
        Bug("the last step of a round is that of the one before", "rounds.v", "end_q  <= base_q + steps_q;", "end_q  <= base_q;"),
        Bug("who sleeps is visited", "rounds.v", "over = aborted_q || none_left_q || count_i == {ROW_W+1{1'b0}}", "over = aborted_q || none_left_q"),
        Bug("no rest", "rounds.v", "settle_q - 1'b1 : SETTLE[SETTLE_W-1:0]", "settle_q - 1'b1 : SETTLE[SETTLE_W-1:0] - 1'b1"),
    ],
    "rounds_visits_beyond_65536_steps": [
        Bug("the upper half does not count", "rounds.v", "no_visit_q || high_more_q || (high_same_q && low_more_q)", "no_visit_q || low_more_q"),
        Bug("the lower half alone does not count", "rounds.v", "(high_same_q && low_more_q)", "1'b0"),
        Bug("the lower half counts for all", "rounds.v", "(high_same_q && low_more_q)", "low_more_q"),
    ],
    "rounds_never_begins_fetch_after_an_abort": [
        Bug("fetch begins though aborted", "rounds.v", "begin_o   = open_o && !aborted_q", "begin_o   = open_o"),
        Bug("an abort is forgotten", "rounds.v", "aborted_q <= running_o && (aborted_q || abort_o)", "aborted_q <= running_o && abort_o"),
        Bug("a stop between stores", "rounds.v", "stopping && !storing_i", "stopping"),
        Bug("a stop that waits is lost", "rounds.v", "(stop_i || stopping_q)", "stop_i"),
        Bug("an illegal word does not end it", "rounds.v", "stop_q || illegal_i", "stop_q"),
    ],
    "rounds_starts_again_after_a_stop": [
        Bug("an abort outlives its run", "rounds.v", "running_o && (aborted_q || abort_o)", "(aborted_q || abort_o)"),
    ],
    "visits_visits_each_object_once_a_round": [
        Bug("an object is taken twice", "visits.v", "head_q  <= head_q + {{ROW_W-1{1'b0}}, take}", "head_q  <= head_q + {{ROW_W-1{1'b0}}, take && left_q[0]}"),
        Bug("a round goes on with those put back in it", "visits.v", "left_q <= left_q - 1'b1;", "left_q <= left_q - !put_q;"),
        Bug("the host wakes the row that was put back last", "visits.v", "write_value_i(put_q ? put_row_q : host_row_i)", "write_value_i(put_row_q)"),
        Bug("the row of the context's last object", "visits.v", "row_q        <= take_w4_i ? next_row : row_w4;", "row_q        <= row_w4;"),
        Bug("a store's row is not the object's", "visits.v", "st_row_q     <= st_row;", "st_row_q     <= row_w4;"),
        Bug("the list is not cleared", "visits.v", "if (rst_i || host_clear_i) begin", "if (rst_i) begin"),
    ],
    "visits_puts_back_nobody_who_is_absent": [
        Bug("absent objects are put back", "visits.v", "ends_q && !absent_d && !new_asleep_q", "ends_q && !new_asleep_q"),
        Bug("found asleep and put back", "visits.v", "ends_q && !absent_d && !new_asleep_q", "ends_q && !new_absent_q && !new_asleep_q"),
        Bug("found asleep and executed", "visits.v", "new_absent_q || (finds_q && nonzero_i)", "new_absent_q"),
        Bug("every load finds sleepers", "visits.v", "finds_q   <= lds_i && executed;", "finds_q   <= executed;"),
        Bug("executed for nobody", "visits.v", "valid_i && !absent && !(asleep && !lasts_i)", "valid_i && !(asleep && !lasts_i)"),
        Bug("a context's last object was absent, too", "visits.v", "begins_i ? !present_w0 : absent_q", "absent_q || (begins_i && !present_w0)"),
        Bug("an absent object is stored", "visits.v", "{st_absent_q, st_asleep_q} <= {st_absent, st_asleep};", "{st_absent_q, st_asleep_q} <= {1'b0, st_asleep};"),
    ],
    "visits_never_lets_an_object_fall_asleep_twice": [
        Bug("asleep, and falls asleep again", "visits.v", "executed && sleep_i && less_i && !asleep;", "executed && sleep_i && less_i;"),
        Bug("asleep without a small change", "visits.v", "executed && sleep_i && less_i && !asleep;", "executed && sleep_i && !asleep;"),
        Bug("awake in the next instruction", "visits.v", "new_asleep_q <= asleep || sleeps;", "new_asleep_q <= sleeps;"),
        Bug("still asleep in the next visit", "visits.v", "asleep   = !begins_i && asleep_q", "asleep   = asleep_q"),
        Bug("not stored in the last part", "visits.v", "!(asleep && !lasts_i)", "!asleep"),
        Bug("an object that sleeps is reported awake", "visits.v", "asleep_o    = state_absent_q || state_asleep_q", "asleep_o    = state_absent_q"),
        Bug("sleep changes nothing", "visits.v", "valid_i && (begins_i || lds_i || sleep_i)", "valid_i && (begins_i || lds_i)"),
    ],
    "visits_visits_nobody_who_fell_asleep": [
        Bug("asleep and put back", "visits.v", "ends_q && !absent_d && !new_asleep_q", "ends_q && !absent_d"),
    ],
}


def bench(root, folder, name, tree, *options, **environment):
    chosen = [f"-P{name}.{key}={value}" for key, value in BENCHES[name].items()]
    vvp = simulate.compiled(tree, folder, name, source(tree, f"{name}.v"), *chosen, *options)
    return simulate.cocotb(root, folder, vvp, root / f"tests/modules/{name}_bench.py", **environment)


@pytest.mark.parametrize("name", BENCHES)
def test_a_module_keeps_its_promises(root, tmp_path, name):
    """... and the bench keeps the module's conditions: its own checks are silent."""
    done = bench(root, tmp_path, name, root, "-DFP3_CHECK")
    assert done.passed, done.said


@pytest.mark.parametrize("promise, bug", [pytest.param(promise, bug, id=f"{promise}: {bug.name}") for promise in BUGS for bug in BUGS[promise]])
def test_a_broken_promise_is_seen(root, tmp_path, promise, bug):
    done = bench(root, tmp_path, promise.split("_")[0], tree(root, tmp_path, bug), TESTCASE=promise)
    assert done.failed == [promise], done.said
