"""fp3 tune on models with events: at the end of the span, at the start, and with cut steps."""

import json
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
@pytest.mark.parametrize("T, times, rate", [(0.5, 2, "-x"), (0.1, 10, "-x"), (0.5, 2, "-sqrt(1 - t)")])
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
