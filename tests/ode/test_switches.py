"""Equations that jump or bend at a time or at a state: the truth stops there, as adaptive steps do, and no pulse is too short."""

import math
import re
import subprocess

import pytest
from runs import fp3

pytestmark = pytest.mark.smoke
PULSE = "state x = 0\nstep 0.5\nspan 6\nx' = -x + ((t > 5 and t < 5.0625) ? 160 : 0)\n"
NERVE = """state v = -1.1994
state w = -0.6243
step 0.0625
span 60
v' = v - v^3/3 - w + ({current})
w' = 0.08*(v + 0.7 - 0.8*w)
"""


@pytest.fixture
def truth(build, tmp_path):
    def truth(text, time, **starts):
        (tmp_path / "m.ode").write_text(text)
        done = subprocess.run([build / "tests/models", "truth", "m.ode", repr(time), *(f"{k}={v!r}" for k, v in starts.items())],
                              cwd=tmp_path, text=True, capture_output=True, timeout=60)
        return {line.split()[0]: float(line.split()[1]) for line in done.stdout.splitlines()} if not done.returncode else done.stderr

    return truth


@pytest.mark.parametrize("condition", ["t > 5 and t < 5.0625", "t >= 5 and not (t >= 5.0625)", "abs(t - 5.03125) < 0.03125",
                                       "(t - 5)*(t - 5.0625) < 0", "min(t - 5, 5.0625 - t) > 0"])
def test_a_short_pulse_is_seen(condition, truth):
    text = PULSE.replace("t > 5 and t < 5.0625", condition)
    top = 160*(1 - math.exp(-0.0625))
    assert truth(text, 5.0)["x"] == 0
    assert truth(text, 5.0625)["x"] == pytest.approx(top, rel=1e-12)
    assert truth(text, 6.0)["x"] == pytest.approx(top*math.exp(-0.9375), rel=1e-12)


def test_a_hat_is_seen(truth):
    assert truth("state x = 0\nstep 0.5\nspan 6\nx' = max(0, 1 - 100*abs(t - 5))\n", 6.0)["x"] == pytest.approx(0.01, rel=1e-10)


def test_before_the_start_pulses_are_seen_too(truth):
    assert truth("state x = 0\nstep 0.5\nspan 6\nx' = (t < -5 and t > -5.0625) ? 160 : 0\n", -6.0)["x"] == pytest.approx(-10, rel=1e-12)


def test_a_nerve_feels_a_short_current(truth):
    """The same as three runs of a constant current, one after the other."""
    state = truth(NERVE.format(current="0"), 30.0)
    state = truth(NERVE.format(current="20"), 0.125, **state)
    state = truth(NERVE.format(current="0"), 5.0, **state)
    assert state["v"] > 1
    got = truth(NERVE.format(current="t > 30 and t < 30.125 ? 20 : 0"), 35.125)
    assert got == pytest.approx(state, rel=1e-9)


def test_it_stops_where_a_state_crosses(truth):
    """x = t - 1: a window of x is one of t, and the root of max(x, 0) has no value before it."""
    text = "state x = -1\nstate y = 0\nstep 0.5\nspan 6\nx' = 1\ny' = (x > 0.5 and x < 0.500001 ? 1e6 : 0) + sqrt(max(x, 0))\n"
    assert truth(text, 3.0)["y"] == pytest.approx(1 + 2/3*2**1.5, rel=1e-9)


def test_a_clock_of_many_pulses(truth):
    """Each of 100 pulses lasts as long as the sine is above 0.999."""
    text = "state x = 0\nstep 0.5\nspan 6\nx' = sin(2*pi*t) > 0.999 ? 1 : 0\n"
    assert truth(text, 100.0)["x"] == pytest.approx(100*(0.5 - math.asin(0.999)/math.pi), rel=1e-9)
    assert "conditions in t change more than 2048 times up to time 100" in truth(text.replace("2*pi", "200*pi"), 100.0)


def test_an_event_in_a_short_time_happens(truth):
    text = "state x = 0\nstate n = 0\nstep 0.5\nspan 6\nx' = 1\nn' = 0\nwhen t > 5 and t < 5.000001 and n == 0: n = 1\n"
    assert truth(text, 6.0)["n"] == 1


def test_a_solution_that_stays_on_a_switch_has_no_truth(truth):
    text = "state v = 1\nstep 0.5\nspan 6\nv' = v > 0 ? -1 : 1\n"
    assert truth(text, 0.5)["v"] == pytest.approx(0.5)
    assert "no truth from time 1 on: the solution does not leave a point at which a condition of the equations changes" in truth(text, 2.0)


# ---- adaptive steps on the machine ----

TOP = 160*(1 - math.exp(-0.0625))
SHORT = TOP*math.exp(-0.9375)


@pytest.fixture
def run(tmp_path):
    def run(text, *arguments, config="single_full", engine="isa", status=0):
        (tmp_path / "m.ode").write_text(text)
        done = fp3("run", tmp_path / "m.ode", "-e", engine, "-c", config, "--all", *arguments, status=status)
        found = re.findall(r"^(\w+) +(\S+) +0x[0-9a-f]{8}(?: 0x[0-9a-f]{8})? +object (\d+)$", done.stdout, re.M)
        return {(name, int(n)) if config == "many_full" else name: float(x) for name, x, n in found}, done

    return run


@pytest.mark.parametrize("condition", ["t > 5 and t < 5.0625", "t >= 5 and t <= 5.0625", "2*t - 3 >= 7 and 1 - t/2 > -1.53125", "t > from and from + 0.0625 - t > 0"])
@pytest.mark.parametrize("integrator", ["heun", "ralston3", "cash_karp", "dopri5", "tsit5", "rk8", "rodas3", "rkc8"])
def test_adaptive_steps_end_where_a_condition_in_t_changes(condition, integrator, run):
    got, _ = run("param from = 5\n" + PULSE.replace("t > 5 and t < 5.0625", condition), "-i", integrator, "--tolerance", "1e-5")
    assert got["x"] == pytest.approx(SHORT, rel=1e-4)


@pytest.mark.parametrize("arithmetic", [["-k"], ["--double-single", "-i", "ralston3"], ["--double-single", "-i", "heun"]])
def test_in_every_arithmetic(arithmetic, run):
    got, _ = run(PULSE.replace("5.0625", "5.1").replace("t > 5 ", "t > 4.9 "), "--tolerance", "1e-7", *arithmetic)
    assert got["x"] == pytest.approx(160*(1 - math.exp(-0.2))*math.exp(-0.9), rel=3e-6)


def test_an_expression_of_many_readers_is_solved_once(run):
    doubled = "a0 = t + 0\n" + "".join(f"a{i + 1} = a{i} + a{i}\n" for i in range(60))
    text = PULSE.replace("x' =", doubled + "x' =").replace("t > 5 and t < 5.0625", "a60 > 5*2^60 and a60 < 5.0625*2^60")
    assert run(text, "--tolerance", "1e-5")[0]["x"] == pytest.approx(SHORT, rel=1e-4)


def test_each_object_has_its_own_times_on_every_engine(run):
    text = "param from = 1\n" + PULSE.replace("t > 5 and t < 5.0625", "t > from and t < from + 0.0625")
    spread = ["--tolerance", "1e-4", "--spread", "from=0:7", "--spread", "until=5:6", "-N", "8"]
    seen = [run(text, *spread, config="many_full", engine=e)[0] for e in ("isa", "rtl", "fast")]
    assert seen[0] == seen[1] == seen[2]
    for n in range(8):
        end, begin = 5 + n/7, float(n)
        expected = TOP*math.exp(begin + 0.0625 - end) if begin < end else 0
        assert seen[0]["x", n] == pytest.approx(expected, rel=1e-3, abs=1e-6)
        alone, _ = run(text, "--tolerance", "1e-4", "--set", f"from={begin}", "--set", f"until={end!r}")
        assert {name: alone[name] for name in ("x", "t", "accepted")} == {name: seen[0][name, n] for name in ("x", "t", "accepted")}


def test_the_step_after_a_switch_is_the_one_before_it(run):
    """What a switch cuts off says nothing about the next step."""
    got, _ = run("state x = 0\nstep 0.5\nspan 6\nx' = t > 0.50390625 and t < 5 ? 1 : 1\n", "--tolerance", "1e-3", "--set", "h_next=0.5")
    assert got["accepted"] <= 5 and got["rejected"] == 0


def test_an_event_in_a_short_time_is_seen(run):
    text = "state x = 0\nstate n = 0\nstep 0.5\nspan 6\nx' = 1\nn' = 0\nwhen {} and n == 0: n = 1, x = 0\n"
    for condition in ("t > 5 and t < 5.0625", "t >= 5 and t <= 5.0625"):
        got, _ = run(text.format(condition), "--tolerance", "1e-3")
        assert got["n"] == 1 and 1 - 0.006 <= got["x"] <= 1


UNKNOWN = "state x = 0\nstep 0.5\nspan 6\nx' = sin(10*t) > 0.99 ? 10 : 0\n"


def test_times_that_are_not_known_need_a_longest_step(run):
    _, done = run(UNKNOWN, "--tolerance", "1e-3", status=2)
    assert "line 4 changes with t at times that are not known before the run" in done.stderr and "'maxstep'" in done.stderr
    got, _ = run(UNKNOWN, "--tolerance", "1e-4", "--set", "maxstep=0.0078125")
    assert got["x"] == pytest.approx(10*math.acos(0.99)/10*2*10, rel=2e-2) and got["largest"] == 0.0078125
    many = "x' = " + " + ".join(f"(t > {k} ? 1 : 0)" for k in range(1, 18)) + "\n"
    _, done = run("state x = 0\nstep 0.5\nspan 6\n" + many, "--tolerance", "1e-3", status=2)
    assert "'maxstep'" in done.stderr


def test_a_longest_step_of_any_model(run):
    text = "state x = 1\nstep 0.5\nspan 4\nx' = -x\n"
    got, _ = run(text, "--tolerance", "1e-3", "--set", "maxstep=0.0625")
    assert got["largest"] == 0.0625 and got["accepted"] >= 64
    for bad in ("-1", "inf"):
        _, done = run(text, "--tolerance", "1e-3", "--set", f"maxstep={bad}", status=2)
        assert "maxstep" in done.stderr
    _, done = run(text, "-n", "2", "--set", "maxstep=1", status=2)
    assert "no 'maxstep'" in done.stderr
    _, done = run("param maxstep = 1\n" + text, "--tolerance", "1e-3", status=2)
    assert "adaptive steps add a 'maxstep' of their own" in done.stderr


def test_a_scene_has_a_longest_step(run, tmp_path):
    expected, _ = run(UNKNOWN, "--tolerance", "1e-4", "--set", "maxstep=0.0078125")
    group = 'program = "m.ode"; tolerance = 1e-4; until = 6; objects = 1;'
    for values in ("maxstep = 0.0078125;", "set = { maxstep = 0.0078125; };"):
        (tmp_path / "s.scene").write_text(f'config = "many_full"; engine = "isa"; groups = ({{ {group} {values} }});\n')
        done = fp3("run", "--scene", tmp_path / "s.scene")
        assert float(re.search(r"^x +(\S+)", done.stdout, re.M)[1]) == expected["x"]


def test_an_image_has_a_longest_step(run, tmp_path):
    expected, _ = run(UNKNOWN, "--tolerance", "1e-4", "--set", "maxstep=0.0078125")
    image, values = tmp_path / "m.fp3", tmp_path / "m.cfg"
    fp3("compile", tmp_path / "m.ode", "--tolerance", "1e-4", "--set", "maxstep=0.0078125", "--image", image, "--params", values)
    done = fp3("run", image, "--params", values, "-e", "isa", "-c", "single_full")
    assert float(re.search(r"^x +(\S+)", done.stdout, re.M)[1]) == expected["x"]
    done = fp3("run", image, "--params", values, "--set", "maxstep=0", "-e", "isa", "-c", "single_full", status=2)
    assert "'maxstep' is 0: expected a finite number above 0" in done.stderr


# ---- what is measured against the truth ----

def test_compare_sees_a_pulse_and_says_when_there_is_nothing_to_see(tmp_path):
    def compare(text, status):
        (tmp_path / "m.ode").write_text(text)
        return fp3("compare", tmp_path / "m.ode", "--quick", "-i", "euler", "--arithmetic", "plain", "--most-steps", "4096", status=status)

    row = compare(PULSE, 0).stdout.splitlines()[1].split()
    assert float(row[9]) == pytest.approx(1, abs=0.5) and float(row[12]) > 1e-4  # the measured order, the floor
    done = compare("state x = 0\nstep 0.5\nspan 6\nx' = -x\n", 3)
    assert "no reference: every state is 0 up to time 6, so no error can be relative to its size" in done.stderr


def test_a_projection_has_no_truth(truth):
    text = "state q[2] = (1, 0)\nstep 0.125\nspan 6\nq' = (-q.y, q.x)\nwhen 1: q = q/norm(q)\n"
    assert "the event of line 5 happens again and again, because its condition stays true" in truth(text, 6.0)
    assert "projection" in truth(text, 6.0)
