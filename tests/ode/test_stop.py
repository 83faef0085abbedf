"""`stop`: an event after which an object keeps its states and its time, on every engine and in the truth."""
import math
import re

import pytest
from runs import fp3, number, truth

FALL = """
param g = 9.81 [m/s^2]
state v = 0 [m/s]
state x = 1 [m]
x' = v
v' = -g
exact x = x(0) + v(0)*t - g*t^2/2
when root(x) falling: stop
step 0.0078125 [s]
span 2 [s]
"""
# Two ways to stop, one after another event at the same instant; what decays has no end of its own.
TANK = """
param low = 0.3
param late = 1.25 [s]
param rate = 1 [1/s]
state y = 1
state n = 0
y' = -rate*y
n' = 0
when y < low: n = n + 1, stop
at t = late: n = n + 10, stop
when root(y - 0.5) falling: n = n + 100
step 0.03125 [s]
span 3 [s]
"""
FALL_HOW = [["--until", 2], ["--until", 2, "-k"], ["--tolerance", 1e-5, "--until", 2], ["--until", 2, "-i", "pefrl"]]


def run(path, *arguments, engine="isa", status=0):
    out = fp3("run", path, "-e", engine, *arguments, status=status).stdout
    found = {}
    for name, bits, of in re.findall(r"^(\w+) +\S+ +(0x[0-9a-f]{8})(?: 0x[0-9a-f]{8})? +object (\d+)$", out, re.M):
        found.setdefault(int(of), {})[name] = number(bits)
    return found, out


@pytest.mark.parametrize("how", FALL_HOW)
def test_what_has_stopped_stays(written, how):
    found, out = run(written(FALL), *how)
    o, t = found[0], math.sqrt(2/9.81)
    assert o["t"] == pytest.approx(t, abs=3e-7) and abs(o["x"]) < 2e-6 and o["v"] == pytest.approx(-9.81*t, rel=1e-6)
    assert "\nstopped          1 of 1, at events\n" in out
    assert math.copysign(1, o["h_next"]) == -1 and o["h_next"] == 0 and o.get("h_cut", 2.0**100) == 2.0**100


@pytest.mark.parametrize("how", FALL_HOW)
@pytest.mark.parametrize("config", ["many_full", "sixteen"])
def test_each_object_for_itself(written, how, config):
    """Those that fall from higher are not down yet, and go on."""
    seen = [run(written(FALL), *how, "-c", config, "-N", 5, "--spread", "x=1:40", "--all", engine=engine) for engine in ("isa", "fast", "rtl")]
    assert seen[0][0] == seen[1][0] == seen[2][0]
    found, out = seen[0]
    assert [o["t"] for o in found.values()] == pytest.approx([math.sqrt(2/9.81), math.sqrt(2*10.75/9.81), 2, 2, 2], abs=3e-6)
    assert "\nstopped          2 of 5, at events\n" in out


@pytest.mark.parametrize("values, t, n", [([], 1.2039728, 101), (["rate=0.7"], 1.25, 110), (["rate=0.3"], 1.25, 10)])
@pytest.mark.parametrize("how", [["--until", 3], ["--tolerance", 1e-5, "--until", 3]])
def test_the_first_of_several_stops(written, how, values, t, n):
    path = written(TANK)
    o = run(path, *how, "--set", "locate=1e-6", *(x for v in values for x in ("--set", v)))[0][0]
    assert o["t"] == pytest.approx(t, abs=3e-6) and o["n"] == n


def test_the_truth_stops(written):
    assert truth(written(FALL), 2)["v"] == pytest.approx(-math.sqrt(2*9.81), rel=1e-12)
    assert truth(written(TANK), 3)["y"] == pytest.approx(0.3, rel=1e-9) and truth(written(TANK), 3)["n"] == 101
    assert truth(written(TANK), 1)["n"] == 100


def test_it_is_stopped_in_all_snapshots(written):
    for how in (["--until", 2], ["--tolerance", 1e-5], ["--until", 2, "-c", "many_full", "-e", "fast", "-N", 3]):
        out = fp3("run", written(FALL), *how, "--times", "0.25,0.5,1,2", "--output", "-", "--observe", "x,v,t,accepted,h_cut" if "--tolerance" in how else "x,v,t,accepted").stdout
        rows = [line.split(",") for line in out.splitlines() if re.match(r"\d+,.*,0,", line)]
        assert len(rows) == 4 and rows[1][3:] == rows[2][3:] == rows[3][3:] != rows[0][3:]
        assert float(rows[3][5]) == pytest.approx(math.sqrt(2/9.81), abs=3e-6)


def test_an_image_and_a_scene_stop(written, tmp_path):
    path = written(FALL)
    fp3("compile", path, "--until", 2, "-c", "many_full", "--image", tmp_path/"m.fp3", "--params", tmp_path/"m.cfg", "-o", tmp_path/"m.s")
    image = fp3("run", tmp_path/"m.fp3", "-c", "many_full", "-e", "isa", "-N", 2, "--params", tmp_path/"m.cfg").stdout
    assert "\nstopped          2 of 2, at events\n" in image
    (tmp_path / "s.scene").write_text('config = "shared_full";\nengine = "fast";\nh = 0.0078125;\ngroups = (\n'
                                      '{ program = "m.ode"; objects = 2; until = 2.0; spread = { x = [1.0, 30.0]; }; },\n'
                                      '{ program = "m.ode"; objects = 3; tolerance = 1e-4; until = 2.0; });\n')
    out = fp3("run", "--scene", tmp_path / "s.scene").stdout
    assert re.findall(r"^stopped +(.*)$", out, re.M) == ["1 of 2, at events", "3 of 3, at events"]


def test_the_check_knows_what_has_stopped(written):
    out = fp3("run", written(FALL), "--until", 2, "--check", "-e", "isa").stdout
    assert float(re.search(r"^v .* error (\S+),", out, re.M)[1]) < 1e-5


def test_without_steps_of_its_own_nothing_stops(written):
    path = written(FALL)
    for command in (["run", path], ["run", path, "--steps", 4], ["compile", path], ["run", path, "-i", "euler"]):
        assert "line 8: `stop` needs each object to choose its own end" in fp3(*command, status=2).stderr


@pytest.mark.parametrize("line, message", [
    ("when root(x) falling: stop, x = 0", "4:27: error: found ',', expected the end of the line (`stop` comes last)"),
    ("when root(x) falling: x = 0, stop, n = 1", "4:34: error: found ',', expected the end of the line (`stop` comes last)"),
    ("when root(x) falling: stop now", "4:28: error: found 'now', expected the end of the line (`stop` comes last)"),
    ("project x = 1, stop", "4:1: error: found 'project', expected an event (a projection stops nothing)"),
    ("when root(x) falling: halt", "4:27: error: found end of line, expected '='"),
])
def test_what_does_not_stop(written, line, message):
    path = written(f"state x = 1\nx' = -1\nstep 0.1\n{line}\n")
    assert message in fp3("compile", path, "--until", 1, status=2).stderr


def test_stop_is_a_name_as_well(written):
    path = written("state stop = 1\nstate q[2] = (1, 1)\nstop' = -1\nq' = (0, 0)\nwhen root(stop) falling: q.x = 7, stop = 3, q[2] = 5\nstep 0.125\n")
    o = run(path, "--until", 2)[0][0]
    assert o["q_x"] == 7 and o["q_y"] == 5 and o["stop"] == pytest.approx(2, abs=1e-6)


def test_compare_has_the_words_of_the_equations(written):
    out = fp3("compare", written(FALL), "--tolerance", "1e-4", "-i", "cash_karp", "--quick").stdout
    assert re.findall(r"(\d+) of \d+$", out, re.M) and set(re.findall(r"(\d+) of \d+$", out, re.M)) == {"0"}
