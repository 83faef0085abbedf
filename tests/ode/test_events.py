"""`when`: what an event does to the states, on every engine, and what it leaves alone."""
import json
import os
import re
import struct

import pytest
from runs import fp3, number, truth

HERE = os.path.dirname(os.path.abspath(__file__))
BALL = os.path.join(os.path.dirname(os.path.dirname(HERE)), "programs", "bouncing_ball.ode")


@pytest.fixture
def model(tmp_path):
    """A model of states that only events change, by one line each; or of any lines."""
    def write(*lines, still="", name="m.ode"):
        lines = [*lines, *(f"{state}' = 0" for state in still), "step 0.125"]
        (tmp_path / name).write_text("\n".join(lines) + "\n")
        return tmp_path / name

    return write


def ends(*arguments, names=None):
    """The values that object 0 ends with, by name."""
    out = fp3("run", *arguments, *([] if "-e" in arguments else ["-e", "isa"])).stdout
    found = {name: number(bits) for name, bits in re.findall(r"^(\w+) +\S+ +(0x[0-9a-f]{8}) +object 0$", out, re.M)}
    return {name: found[name] for name in names} if names else found


# ---- what an event does ----

ENGINES = [(engine, config) for engine in ("isa", "rtl") for config in ("single_full", "many_full")]


@pytest.mark.parametrize("engine, config", ENGINES)
def test_all_values_are_those_before_it(model, engine, config):
    path = model("state a = 1", "state b = 2", "state c = 3", "when 1: a = b, b = c, c = a", still="abc")
    assert ends(path, "-e", engine, "-c", config, "-n", 1) == {"a": 2, "b": 3, "c": 1}
    assert ends(path, "-e", engine, "-c", config, "-n", 5) == {"a": 3, "b": 1, "c": 2}


@pytest.mark.parametrize("engine, config", ENGINES)
def test_each_sees_what_those_before_it_left(model, engine, config):
    path = model("state a = 1", "state b = 0", "state c = 0", "double = 2*a", "when a > 0: a = -3, b = double",
                 "when a < 0 and b == 2: c = double, b = 7", "when b == 2: a = 99", still="abc")
    assert ends(path, "-e", engine, "-c", config, "-n", 1) == {"a": -3, "b": 7, "c": -6}


def test_the_states_and_the_time_are_those_after_the_step(model):
    path = model("state x = 0", "state at = 0", "x' = 8", "at' = 0", "when x == 3: at = t, x = 0")
    assert ends(path, "-n", 3) == {"x": 0, "at": 0.375, "steps": 3}
    assert ends(path, "-n", 2)["at"] == 0


def test_a_condition_is_true_unless_it_is_0(model):
    for value, fires in (("0", 0), ("-0", 0), ("-2", 1), ("1e-30", 1)):
        assert ends(model("state a = " + value, "state b = 0", "when -a: b = 1", still="ab"), "-n", 1)["b"] == fires


def test_vectors_as_a_whole_and_by_component(model):
    path = model("state r[3] = (1, 2, 3)", "state v[2] = (4, 5)", "r' = (0, 0, 0)", "v' = (0, 0)",
                 "when norm(v) > 6: r = 2*r, v.y = r.x", "when v.y < 2: v = (v.y, v.x)")
    assert ends(path, "-n", 1) == {"r_x": 2, "r_y": 4, "r_z": 6, "v_x": 1, "v_y": 4}


def test_t_after_a_million_steps_is_exact_to_one_rounding(model):
    path = model("state y = 0", "when 1: y = t", still="y")
    h = struct.unpack("<f", struct.pack("<f", 0.01))[0]
    end = ends(path, "-n", 10**6, "--set", "h=0.01")
    assert end["steps"] == 10**6 and end["y"] == struct.unpack("<f", struct.pack("<f", 10**6 * h))[0]


# ---- how it is compiled ----

def test_what_was_lost_of_a_state_is_forgotten(model):
    """A state that an event sets has no rounding error of its past."""
    path = model("state x = 1", "state y = 1", "x' = 0.3", "y' = 0.3", "when x > 1.2: x = 1")
    before, after = (ends(path, "-k", "-i", "euler", "-n", n) for n in (5, 6))
    assert before["x_lost"] == before["y_lost"] != 0 and before["x"] > 1.1
    assert (after["x"], after["x_lost"]) == (1, 0) and after["y_lost"] != 0


@pytest.mark.parametrize("integrator", ["rk4", "rk4_paper", "verlet", "pefrl", "dopri5"])
def test_every_engine_has_the_bits_of_the_equations(model, tmp_path, integrator):
    """Where a value is kept from the step before, where t is; three objects' worth of starts, three machines."""
    path = model("param w = 9", "state v = 2", "state x = 0.1", "state n = 0", "x' = v", "v' = -w*x + t", "n' = 0",
                 "when x < 0 and v < 0: x = -x, v = -v/2, n = n + 1", "when n > 1: n = 0, v = v + t")
    fp3("compare", path, "-i", integrator, "--span", 1, "--most-steps", 8, "--json", tmp_path / "rows.json")
    rows = json.loads((tmp_path / "rows.json").read_text())["rows"]
    assert rows and all(row["mismatches"] == 0 < row["compared"] for row in rows)


@pytest.mark.parametrize("integrator", ["rk4", "verlet"])
def test_visits_change_no_bit(model, integrator):
    path = model("state v = 0", "state x = 1", "x' = v", "v' = -9", "when x < 0.7: x = 2*0.7 - x, v = -v")
    arguments = (path, "-i", integrator, "-c", "many_full", "-N", 3, "-n", 20, "--all")
    assert fp3("run", *arguments, "-e", "isa").stdout.split("object_steps")[0] == \
        fp3("run", *arguments, "-e", "rtl", "--visit", 3).stdout.split("object_steps")[0]


def test_what_only_dead_states_need_is_left_out(model):
    path = model("state x = 1", "state n = 0", "state m = 0", "x' = m", "n' = 0", "m' = t", "when n > 2: x = n",
                 "when m > 1: m = 0, x = 5")
    of_n = fp3("compile", path, "--observe", "n").stdout.split("\n\n", 1)[1]
    assert "line" not in of_n and "steps" not in of_n
    assert "line 8: new x" not in fp3("compile", path, "--observe", "m").stdout
    of_x = fp3("compile", path, "--observe", "x").stdout
    assert "line 7: new x" in of_x and "line 8: new m" in of_x and ".state  n" in of_x and "steps" in of_x


def test_the_order_is_1(model):
    path = model("state x = 1", "x' = -x", "when x < 0.5: x = 1")
    assert "Order 1." in fp3("compile", path, "-i", "rk6").stdout


# ---- what is refused ----

def test_a_configuration_without_selection(model):
    path = model("state x = 1", "x' = -x", "", "when x < 0.5: x = 1")
    refused = fp3("compile", path, "-c", "many", status=2)
    assert "line 4: x < 0.5: needs `select`, which configuration 'many' does not have; it is in 'many_full', 'many_memory', 'world', 'world_keep', 'world_memory', 'world_overlap', 'sixteen', 'shared_full', 'lanes_memory', 'fabric'" in refused.stderr


def test_positions_of_two_steps(model):
    lines = ("state v = 0", "state x = 1", "x' = v", "v' = -x", "when {}: {} = 0")
    for state in "xv":
        path = model(*lines[:-1], lines[-1].format("x < 0", state))
        refused = fp3("compile", path, "-i", "stoermer_verlet", status=2).stderr
        assert "line 5: integrator 'stoermer_verlet' works from the positions of two steps: found an event" in refused


# ---- the truth ----

def test_an_event_happens_where_its_condition_begins(model):
    path = model("state x = 0", "state n = 0", "x' = 1", "n' = 0", "when x > 0.3: x = 0, n = n + 1")
    assert truth(path, 1) == pytest.approx({"x": 0.1, "n": 3}, abs=1e-12)
    late = model("state x = 0", "state n = 0", "x' = 1", "n' = 0", "when t > 0.3 and n == 0: n = t")
    assert truth(late, 1)["n"] == pytest.approx(0.3, abs=1e-12)
    now = model("state x = 5", "x' = 1", "when x > 3: x = 0")
    assert truth(now, 1) == pytest.approx({"x": 1}, abs=1e-12)


def test_what_changes_nothing_does_not_happen(model):
    """A heater that is off already; else it would be switched off at every time."""
    assert truth(model("state x = 0", "state off = 0", "x' = 1", "off' = 0", "when x > 0.5: off = 1"), 2) == pytest.approx({"x": 2, "off": 1})


@pytest.mark.parametrize("event, t, expected", [
    ("when x < 0: v = -v/2", 10, "no truth from time 1.41421356 on: the event of line 5 happens again and again, because its condition stays true"),
    ("when x < 0: x = 0, v = -v/2", 10, "no truth from time 4.24264069 on: more than 1000 events happened until then"),
    ("when x < 0: x = 0, v = -v/2", -1, "no truth at time -1: events cannot be followed back"),
    ("when 1: v = v + 1", 1, "no truth from time 0 on: the event of line 5 happens again and again, because its condition stays true"),
])
def test_where_there_is_no_truth_it_says_why(model, event, t, expected):
    path = model("state x = 1", "state v = 0", "x' = v", "v' = -1", event)
    assert expected in truth(path, t, status=1)


# ---- the order ----

def errors(path, tmp_path, integrator, *arguments):
    fp3("compare", path, "--quick", "-i", integrator, "--errors", *arguments, "--json", tmp_path / "e.json")
    row = [r for r in json.loads((tmp_path / "e.json").read_text())["rows"] if r["arithmetic"] == "compensated"][0]
    return dict(zip(row["errors"]["steps"], row["errors"]["error"]))


def test_an_event_within_a_step_is_late_by_a_part_of_it(model, tmp_path):
    lines = ["state v = 1", "state on = 0", "on' = 0", "v' = -v + on"]
    within = errors(model(*lines, "when t > 0.654321 and not on: on = 1", "span 2"), tmp_path, "rk4", "--most-steps", 4096)
    upon = errors(model(*lines, "when t >= 1 and not on: on = 1", "span 2"), tmp_path, "rk4", "--most-steps", 64)
    assert all(error < 0.8 / steps for steps, error in within.items()) and max(list(within.values())[-4:]) > 1e-4
    assert upon[16] / upon[32] > 12 and upon[64] < 1e-6


def test_the_figure_in_the_docs(root):
    """docs/models.md says what `fp3 compare programs/bouncing_ball.ode -i rk4` measures."""
    said = re.search(r"falls with the power ([0-9.]+) of h", (root / "docs/models.md").read_text())[1]
    line = [row for row in fp3("compare", BALL, "--quick", "-i", "rk4").stdout.splitlines() if " plain " in row][0]
    assert said in line.split(), line
