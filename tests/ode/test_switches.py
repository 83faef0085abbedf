"""Equations that jump or bend at a time or at a state: the truth stops there, and no pulse is too short for it."""

import math
import subprocess

import pytest

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
