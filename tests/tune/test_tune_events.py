"""fp3 tune on models with events: at the end of the span, at the start, and with cut steps."""

import json
import math
import re
import subprocess

import pytest

AT_END = """param T = {T}
state x = 1
state n = 0
x' = {rate}
n' = 0
at t = {times}*T: x = x + 3, n = 1
step 0.015625
span 1
"""
# A ball on its way up that is reflected by a ceiling, which it reaches as the span ends.
CEILING = "state x = 0\nstate v = 1\nx' = v\nv' = 0\nwhen root(x - 1) rising: v = -1, x = 1\nstep 0.015625\nspan 1\n"
# What is warmed does not depend on what `on` was before anybody looked.
WARM = "param low = 3\nstate T = 1\nstate on = 0.5\nT' = on - 0.125*T\non' = 0\nwhen T < low: on = 1\nwhen T > low + 1: on = 0\nstep 0.0625\nspan 4\n"


@pytest.fixture
def tune(fp3, tmp_path):
    def tune(text, *arguments):
        (tmp_path / "m.ode").write_text(text)
        done = subprocess.run([fp3, "tune", "m.ode", *map(str, arguments), "--json", "out.json", "--output", "m.scene"],
                              cwd=tmp_path, capture_output=True, text=True, timeout=300)
        return done, json.loads((tmp_path / "out.json").read_text()) if done.returncode == 0 else None
    return tune


def states(fp3, folder, *arguments):
    out = subprocess.run([fp3, "run", *map(str, arguments)], cwd=folder, capture_output=True, text=True, timeout=300, check=True).stdout
    return {name: float(value) for name, value in re.findall(r"^(\w+) +(\S+) +0x\S+ +object 0$", out, re.M)}


# 10 T is 1 in FP32, and 1.5e-8 more in double; from 1 on sqrt(1 - t) has no value, so that no solution follows the event.
@pytest.mark.parametrize("T, times, rate", [pytest.param(0.5, 2, "-x", marks=pytest.mark.long), pytest.param(0.1, 10, "-x", marks=pytest.mark.long), (0.5, 2, "-sqrt(1 - t)")])
def test_an_event_at_the_end_of_the_span_counts(tune, fp3, tmp_path, T, times, rate):
    done, row = tune(AT_END.format(T=T, times=times, rate=rate), "--tolerance", "1e-3")
    assert done.returncode == 0 and row["met"] and row["cost_ratio"] < 1, done.stderr
    after = (1 if "t" in rate else 2.718281828) ** -1 + 3 - (2/3 if "t" in rate else 0)
    for arguments in (["--scene", "m.scene"], *(["m.ode", "-c", "many_full", "--until", "1", "-e", engine] for engine in ("isa", "fast", "rtl"))):
        found = states(fp3, tmp_path, *arguments)
        assert found["n"] == 1 and found["x"] == pytest.approx(after, rel=2e-3), arguments


def test_a_root_at_the_end_of_the_span_has_two_sides(tune, fp3, tmp_path):
    done, row = tune(CEILING, "--tolerance", "1e-3")
    assert done.returncode == 0 and row["met"] and row["cost_ratio"] < 1, done.stderr
    assert states(fp3, tmp_path, "m.ode", "-c", "many_full", "--until", "1")["v"] == -1


# ---- at the start ----

@pytest.mark.parametrize("steps", [["--until", "2"], ["--until", "2", "--tolerance", "1e-4"]])
@pytest.mark.parametrize("engine", ["isa", "fast", "rtl"])
def test_a_condition_that_is_true_at_the_start_happens_there(fp3, tmp_path, engine, steps):
    """T is 8 (1 - exp(-t/8)) + exp(-t/8) with `on` at 1, whatever it starts with."""
    (tmp_path / "m.ode").write_text(WARM)
    found = [states(fp3, tmp_path, "m.ode", "-c", "many_full", "-e", engine, *steps, "--set", "h=0.5" if len(steps) == 2 else "h_next=0.5",
                    "--set", f"on={on}", "--set", "locate=0.0001") for on in (0, 1)]
    assert [one["on"] for one in found] == [1, 1]
    assert found[0]["T"] == pytest.approx(8 - 7 * 2.718281828 ** -0.25, abs=2e-4)
    assert found[0]["T"] == pytest.approx(found[1]["T"], abs=1.1e-4)


def test_a_start_at_which_a_condition_is_true_costs_no_order(tune):
    done, row = tune(WARM, "--tolerance", "1e-4", "--spread", "on=0:0.5")
    assert done.returncode == 0 and row["met"] and row["cost_ratio"] < 8, (row and row["cost_ratio"], done.stderr)


# ---- steps that are cut ----

# An oscillator that hits a wall: each bounce loses a tenth of the speed.
WALL = """param e = 0.9
state x = 1
state v = 0
state n = 0
x' = v
v' = -x
n' = 0
when root(x + 0.5) falling: x = -0.5, v = -e*v, n = n + 1
step 0.03125
span 16
"""


def wall(e, end=16.0):
    """Where the oscillator is at the end, from one bounce to the next: x = a cos(phase + t) between them."""
    t, x, v, n = 0.0, 1.0, 0.0, 0
    while True:
        a = math.hypot(x, v)
        phase = math.atan2(-v, x)                                # x = a cos(phase + t)
        late = (math.acos(-0.5 / a) - phase) % (2 * math.pi) if a > 0.5 else math.inf
        if t + late > end:
            return a * math.cos(phase + end - t), -a * math.sin(phase + end - t), n
        t, x, v, n = t + late, -0.5, e * a * math.sin(phase + late), n + 1


def test_steps_that_are_cut_keep_their_order(tune, fp3, tmp_path):
    """At 1e-5 an event at the end of its step would take 1e5 steps and more."""
    done, row = tune(WALL, "--tolerance", "1e-5", "--spread", "e=0.85:0.95", "--objects", "5")
    assert done.returncode == 0 and row["met"] and row["cut"] and row["h"] > 0.125 and row["cost_ratio"] < 0.6, done.stderr
    assert "cut at events" in done.stdout and row["attempts"] < 250
    out = subprocess.run([fp3, "run", "--all", "--scene", "m.scene"], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    found = {name: [float(x) for x in re.findall(rf"^{name} +(\S+) .* object \d", out, re.M)] for name in ("x", "v", "n", "accepted", "rejected")}
    assert len(found["x"]) == 5
    for i in range(5):
        x, v, n = wall(0.85 + 0.1 * i / 4)
        assert found["n"][i] == n and abs(found["x"][i] - x) <= 1e-5 and abs(found["v"][i] - v) <= 1.1e-5, (i, x, v, n)
    assert (sum(found["accepted"]) + sum(found["rejected"])) / 5 == pytest.approx(row["attempts"], rel=0.1)


def test_only_events_cut_steps(tune):
    row = tune("state x = 1\nx' = -x\nstep 0.0625\nspan 1\n", "--tolerance", "1e-2")[1]
    assert row["met"] and not any(r["cut"] for r in row["tried"])
    row = tune("state x = 1\nx' = -x\nwhen root(x - 0.5) falling: x = 1\nstep 0.0625\nspan 1\n", "--tolerance", "1e-3")[1]
    cut = {(r["integrator"], r["arithmetic"]) for r in row["tried"] if r["cut"]}
    assert row["met"] and cut > {("rk4", "plain"), ("rk4", "compensated")} and not any(a == "folded" for _, a in cut)


# ---- fp3 compare judges as fp3 tune does ----

# A hill at a quarter of the span that is gone at each of eight even times.
HILL = "state x = 1\nx' = -400*(t - 0.8)*x/(1 + 200*(t - 0.8)^2)\nexact x = x(0)*(1 + 200*0.64)/(1 + 200*(t - 0.8)^2)\nstep 0.015625\nspan 4\n"


def test_compare_has_the_error_of_tune(tune, fp3, tmp_path):
    row = next(r for r in tune(HILL, "--tolerance", "1e-2")[1]["tried"] if r["integrator"] == "rk4" and r["arithmetic"] == "plain" and r["steps"])
    out = subprocess.run([fp3, "compare", "m.ode", "-i", "rk4", "--arithmetic", "plain", "--quick", "--errors", "--most-steps", "4096", "--json", "c.json"],
                         cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert re.search(r" floor +largest mismatches$", out, re.M)
    found = json.loads((tmp_path / "c.json").read_text())["rows"][0]
    steps, error, largest = (found["errors"][name] for name in ("steps", "error", "largest"))
    assert min(largest) == found["largest"] and all(b > 2 * a for a, b in zip(error, largest) if b < 0.1)
    near = min(range(len(steps)), key=lambda i: abs(steps[i] - row["steps"]))
    assert largest[near] == pytest.approx(row["error"], rel=1) and 0 < row["error"] < 0.5


def test_compare_looks_at_each_step(fp3, tmp_path):
    """Explicit Euler, followed by hand: the largest error is where none of the eight looks is."""
    (tmp_path / "d.ode").write_text("state x = 1\nx' = -x\nstep 0.0625\nspan 2\n")
    subprocess.run([fp3, "compare", "d.ode", "-i", "euler", "--arithmetic", "plain", "--quick", "--errors", "--most-steps", "64", "--json", "c.json"], cwd=tmp_path, check=True, capture_output=True)
    errors = json.loads((tmp_path / "c.json").read_text())["rows"][0]["errors"]
    for steps, largest in zip(errors["steps"], errors["largest"]):
        h = 2 / steps
        assert largest == pytest.approx(max(abs((1 - h) ** n - math.exp(-n * h)) for n in range(1, steps + 1)), rel=1e-5)
