"""Events at roots and at times: located within a step, on every engine, without a loss of order."""
import math
import random
import re

import pytest
from runs import fp3, number, truth

BALL = """
param e = 0.8
param g = 9.81 [m/s^2]
state v = 0 [m/s]
state x = 1 [m]
state n = 0
x' = v
v' = -g
n' = 0
when root(x) falling: x = 0, v = -e*v, n = n + 1
step 0.0078125 [s]
span 2 [s]
"""
IMPACT = """
param wall = 0.7
param e = 0.9
state v = 0
state x = 0
x' = v
v' = -x - 0.1*v + 1.1*cos(1.3*t)
when root(x - wall) rising: x = wall, v = -e*v
step 0.03125
span 7
"""
HEATER = """
state T = 15
state on = 1
T' = -0.3*(T - 10) + 5*on
on' = 0
when root(T - 20) rising: on = 0
when root(T - 18) falling: on = 1
step 0.0625
span 9.5
"""
ROCKET = """
state v = 0
state x = 0
state m = 3
state burn = 0.5
x' = v
v' = burn*4/m - 0.2*v/m - 1
m' = -burn
burn' = 0
when root(m - 2) falling: m = 1.5
when root(m - 1) falling: burn = 0
at t = 0.3: burn = 0.8
step 0.0625
span 4
"""
PULSE = """
param T = 0.7
state y = 0
state u = 0
y' = u - y
u' = 0
at t = T: u = 1
at t = T + 0.3001: u = -1
step 0.0078125
span 2
"""


def run(path, *arguments, engine="isa", status=0):
    done = fp3("run", path, "-e", engine, *arguments, status=status)
    return {name: number(bits) for name, bits in re.findall(r"^(\w+) +\S+ +(0x[0-9a-f]{8}).* object 0$", done.stdout, re.M)}, done


def doubles(path, *arguments):
    """Sums of both words."""
    out = fp3("run", path, "--double-single", "-c", "many_full", "-N", 1, "-e", "fast", *arguments).stdout
    return {name: number(high) + number(low) for name, high, low in
            re.findall(r"^(\w+) +\S+ +(0x[0-9a-f]{8}) (0x[0-9a-f]{8}) +object 0$", out, re.M)}


def ball(until, e=0.8, g=9.81):
    t, v, n = math.sqrt(2/g), math.sqrt(2*g)*e, 1
    while t + 2*v/g < until:
        t, v, n = t + 2*v/g, v*e, n + 1
    after = until - t
    return v - g*after, v*after - g*after**2/2, n


# ---- the language ----

@pytest.mark.parametrize("line, message", [
    ("when root(x): x = 0", "5:13: error: found ':', expected rising, falling or any"),
    ("when root(x) up: x = 0", "5:14: error: found 'up', expected rising, falling or any"),
    ("when root((x, x)) rising: x = 0", "5:11: error: found '(', expected a number as the root (this is a vector of 2)"),
    ("when root(x - L) rising: x = 0", "5:13: error: found '-', expected"),
    ("when root(x rising: x = 0", "5:13: error: found 'rising', expected an operator or ')'"),
    ("when root(x) rising, x = 0", "5:20: error: found ',', expected an operator or ':'"),
    ("at t = x: x = 0", "5:8: error: found 'x', expected numbers and params, which are known before the start"),
    ("at t = t + 1: x = 0", "5:8: error: found 't', expected"),
    ("at t = L: x = 0", "5:4: error: found 't', expected two values with the same unit (these are in [kg] and [s])"),
])
def test_what_is_no_event(written, line, message):
    path = written(f"state x = 1 [m]\nparam L = 1 [kg]\nx' = -1\nstep 0.1 [s]\n{line}\n")
    assert message in fp3("compile", path, status=2).stderr


def test_root_and_at_are_names_as_well(written):
    path = written("state root = 1\nstate at = 0\nroot' = -1\nat' = 1\nwhen root < 0.5: at = 7, root = 9\nstep 0.125\n")
    assert run(path, "-n", 5)[0] == {"root": 9, "at": 7}


# ---- fixed steps that are not cut: at their ends, once ----

def test_an_uncut_step_sees_a_root_at_its_end_once(written):
    """x rises through 2.3 in the fourth step and stays above: a condition would be true again and again."""
    path = written("state x = 0\nstate n = 0\nx' = 6\nn' = 0\nwhen root(x - 2.3) rising: n = n + 1\nstep 0.125\n")
    for engine in ("isa", "fast", "rtl"):
        assert [run(path, "-n", n, engine=engine)[0]["n"] for n in (3, 4, 9)] == [0, 1, 1]


@pytest.mark.parametrize("way, n", [("rising", 1), ("falling", 1), ("any", 2)])
def test_ways(written, way, n):
    """A sine to t = 7: it begins at its root, goes down through it at pi and up at 2 pi."""
    path = written(f"state x = 0\nstate v = 1\nstate n = 0\nx' = v\nv' = -x\nn' = 0\nwhen root(x) {way}: n = n + 1\nstep 0.125\nspan 7\n")
    assert run(path, "-n", 56)[0]["n"] == n
    assert run(path, "--until", 7)[0]["n"] == n
    assert run(path, "--tolerance", "1e-5", "--until", 7)[0]["n"] == n
    assert truth(path, 7)["n"] == n


# ---- located ----

@pytest.mark.parametrize("how", [["--until", 1.9], ["--until", 1.9, "--set", "h=2^-4"], ["--until", 1.9, "-k"],
                                 ["--tolerance", 1e-3, "--until", 1.9], ["--tolerance", 1e-6, "--until", 1.9]])
def test_a_ball(written, how):
    """Its flight is a parabola, which rk4 has exactly: what is left is when it bounces. One unit of t is 1.2e-7."""
    v, x, n = ball(1.9)
    found = run(written(BALL), *how)[0]
    assert found["n"] == n == 3 and abs(found["x"] - x) < 1e-6 and abs(found["v"] - v) < 1.2e-5


@pytest.mark.parametrize("text, state, until, steps", [(IMPACT, "x", 7, (4, 6)), (HEATER, "T", 9.5, (3, 5)), (ROCKET, "x", 4, (3, 5))])
def test_the_order_is_kept(written, text, state, until, steps):
    path = written(text)
    true = truth(path, until)
    first, last = (abs(doubles(path, "--until", until, "--set", f"h=2^-{k}", "--set", "locate=1e-11")[state] - true[state]) for k in steps)
    assert math.log2(first/last)/(steps[1] - steps[0]) > 3.8 and last > 1e-10
    assert "Order 4." in fp3("compile", path, "-i", "rk4", "--until", 1).stdout


def test_whole_steps_follow_an_event(written):
    """After an event in the middle of a step come steps of h, and the last one up to the end."""
    path = written("state x = 0\nstate n = 0\nx' = 1\nn' = 0\nwhen root(x - 0.3) rising: n = 1\nstep 0.125\n")
    until = {t: run(path, "--until", t)[0] for t in (0.25, 0.3, 0.3 + 0.125, 0.3 + 0.1875, 1)}
    assert [o["n"] for o in until.values()] == [0, 1, 1, 1, 1] and until[1]["x"] == 1
    assert all(o["h_next"] == 2.0**100 for o in until.values())
    assert until[0.25]["accepted"] == 2
    assert [o["accepted"] - until[0.425]["accepted"] for o in until.values()][2:] == [0, 1, 5]


@pytest.mark.parametrize("how", [["--until", 2], ["--tolerance", 1e-6, "--until", 2]])
def test_times_are_exact(written, how):
    """Both times are ends of steps, so no attempt is lost, and the error is that of the method."""
    path = written(PULSE)
    y = 1 - math.exp(-0.3001)
    found = run(path, *how)[0]
    assert found["u"] == -1 and found["y"] == pytest.approx(-1 + (y + 1)*math.exp(-(2 - 1.0001)), abs=1e-6)
    assert how[0] == "--tolerance" or found["rejected"] == 0
    assert truth(path, 2)["y"] == pytest.approx(-1 + (y + 1)*math.exp(-(2 - 1.0001)), abs=1e-10)


def test_a_time_may_belong_to_the_object(written):
    path = written("param T = 1\nstate u = 0\nu' = 0\nat t = 2*T: u = t\nstep 0.125\n")
    out = fp3("run", path, "-N", 5, "--spread", "T=0.1:0.9", "--until", 1, "-c", "many_full", "-e", "fast", "--all").stdout
    found = [float(u) for u in re.findall(r"^u +(\S+)", out, re.M)]
    assert found[3:] == [0, 0] and found[:3] == pytest.approx([0.2, 0.6, 1.0], rel=1e-6)


@pytest.mark.parametrize("how", [["--steps", 8], ["--until", 1], ["--tolerance", 1e-3]])
def test_a_time_at_the_start_is_refused(written, how):
    """It would never happen. An event before a start that is late is past."""
    path = written("param T = 0\nstate x = 0\nx' = 1\nat t = T: x = 5\nstep 0.125\nspan 1\n")
    for values in ([], ["--set", "T=-1"], ["--set", "T=1e-50"], ["-N", 3, "-c", "many_full", "--spread", "T=0:1"]):
        said = fp3("run", path, *how, "-e", "isa", *values, status=2).stderr
        assert "line 4: the event at t = " in said and "never happens, as the object starts at t = 0: expected a time after the start" in said
    assert run(path, *how, "--set", "T=0.5")[0]["x"] == 5.5
    if "--until" in how:
        assert run(path, "--until", 3, "--set", "t=2", "--set", "T=1")[0]["x"] == 1 and run(path, "--until", 1, "--set", "t=-1")[0]["x"] == 6


@pytest.mark.parametrize("how", [["-n", 8], ["--until", 1], ["--until", 1, "-k"], ["--until", 1, "-i", "euler"],
                                 ["--tolerance", 1e-3, "--until", 1, "--set", "maxstep=0.125"]])
def test_every_step_begins_and_ends_on_a_root(written, how):
    """Which side it begins on, only the slope tells; what rests on a root passes none."""
    g = "*".join(f"(x - {k}/8)" for k in range(1, 8))
    path = written("state x = 0\nstate n = 0\nstate m = 0\nstate z = 0\nx' = 1\nn' = 0\nm' = 0\nz' = 0\n"
                   f"when root({g}) any: n = n + 1\nwhen root(z) any: m = m + 1\nstep 0.125\nspan 1\n")
    found = run(path, *how)[0]
    assert found["n"] == 7 and found["m"] == 0 and truth(path, 1)["n"] == 7


def test_from_one_root_to_the_next(written):
    """y' = 2t - 3 from 2: y is 0 at 1 and at 2, below 0 between them, where no step ends."""
    path = written("state y = 2\nstate n = 0\ny' = 2*t - 3\nn' = 0\nwhen root(y) any: n = n + 1\nstep 1\nspan 4\n")
    for how in (["-n", 4], ["--until", 4], ["--tolerance", 1e-3, "--until", 4, "--set", "maxstep=1"]):
        seen = [run(path, *how, engine=engine)[0] for engine in ("isa", "fast", "rtl")]
        assert seen[0] == seen[1] == seen[2] and seen[0]["n"] == 2
    assert truth(path, 4)["n"] == 2


def test_a_long_step_may_pass_over_roots_and_says_so(written):
    """A cubic, which the method has exactly: its three roots are in one step unless that has an end."""
    path = written("state x = -8\nstate y = -120\nstate n = 0\nx' = 1\ny' = 3*x^2 + 12*x - 4\nn' = 0\nwhen root(y) any: n = n + 1\n"
                   "at t = 3: x = x\nstep 0.0625\nspan 12\n")
    warning = "warning: line 7: a step that is as long as the tolerance allows may pass over this event"
    assert warning in run(path, "--tolerance", 1e-3)[1].stderr
    found, done = run(path, "--tolerance", 1e-3, "--set", "maxstep=2")
    assert "warning" not in done.stderr and found["n"] == 3 == truth(path, 12)["n"]
    assert "warning" not in run(path, "--until", 12)[1].stderr


def test_exactly_on_the_root(written):
    """x is 0.5 at the end of the fourth step, which is the event, and not a second one when it goes on."""
    path = written("state x = 0\nstate n = 0\nx' = 1\nn' = 0\nwhen root(x - 0.5) rising: n = n + 1\nstep 0.125\n")
    for how in (["-n", 8], ["--until", 1], ["--tolerance", 1e-4, "--until", 1]):
        assert run(path, *how)[0]["n"] == 1
    assert truth(path, 1)["n"] == 1


def test_from_the_root_into_it(written):
    """What lies on the floor and falls does not fall through it."""
    path = written("state x = 0\nstate v = 0\nx' = v\nv' = -1\nwhen root(x) falling: x = 0, v = -0.5*v\nstep 0.125\n")
    assert run(path, "-n", 8)[0]["x"] == 0
    assert abs(run(path, "--until", 0.25, "--steps", 1000, status=3)[0]["x"]) < 1e-6


@pytest.mark.parametrize("how", [["--until", 2], ["--tolerance", 1e-4, "--until", 2]])
def test_a_root_that_has_no_value_beyond(written, how):
    """sqrt(x) has none below 0: a step that ends there may have passed the root, and is made again up to where there is one."""
    lines = "state x = 1\nstate n = 0\nx' = {}\nn' = 0\nwhen root(sqrt(x) - 0.2) falling: n = n + 1{}\nstep 0.125\n"
    assert run(written(lines.format("n - 1", "")), *how)[0]["n"] == 1
    assert run(written(lines.format("-1", ", x = x - 1")), *how)[0]["n"] == 1
    _, done = run(written("state x = 1\nstate n = 0\nx' = -1\nn' = 0\nwhen root(sqrt(x) + 1) falling: n = 1\nstep 0.125\n"), *how, "-n", 1000, status=3)
    assert re.search(r"object 0 at t = (1|0\.75) of 2, .* no attempt is left", done.stderr)


@pytest.mark.parametrize("roots, config", [("when root(z) any: m = m + 1", "cell"),
                                           ("when root(z - 1.5e38) rising: m = 7\nwhen root(z - 2e38) rising: m = 8", "many_full")])
def test_roots_that_are_not_reached_disturb_no_search(written, roots, config):
    """One that rests, and two whose sum is beyond FP32, while a condition begins: no flag, no failure."""
    path = written(f"state x = 0\nstate n = 0\nstate m = 0\nstate z = 0\nx' = 1\nn' = 0\nm' = 0\nz' = 0\n{roots}\n"
                   "when x > 0.3 and n < 0.5: n = 1\nstep 0.125\nspan 1\n")
    seen = [run(path, "--tolerance", 1e-3, "-n", 200, "-c", config, "-N", 1, engine=engine) for engine in ("isa", "fast", "rtl")]
    assert seen[0][0] == seen[1][0] == seen[2][0] and (seen[0][0]["n"], seen[0][0]["m"]) == (1, 0)
    assert all(re.search(r"^flags +inexact$", done.stdout, re.M) for _, done in seen)


def test_what_rests_on_its_root_raises_no_flag(written):
    """Its event holds it there, so it happens again and again, and no attempt is left: but 0 was not divided by 0."""
    path = written("state x = 0\nx' = 0\nwhen root(x) falling: x = 0\nstep 0.125\nspan 1\n")
    for engine in ("isa", "fast", "rtl"):
        done = run(path, "--tolerance", 1e-3, "-n", 100, engine=engine, status=3)[1]
        assert "no attempt is left" in done.stderr and re.search(r"^flags +inexact$", done.stdout, re.M)


def test_what_rests_ends_with_a_message(written):
    """Infinitely many bounces before 4.2 s: no attempts are left, and the run says where."""
    found, done = run(written(BALL), "--until", 5, "--steps", 20000, status=3)
    assert re.search(r"object 0 at t = 4\.\d+ of 5, after \d+ steps and \d+ rejected attempts: no attempt is left", done.stderr)
    assert found["x"] >= 0 and found["x"] < 1e-3


# Of u = x - r, whose root every one of them has at u = 0 alone.
MONOTONE = ["{u}", "({u})^3", "({u})^5", "({u})*abs({u})", "expm1({k}*({u}))", "-expm1(-{k}*({u}))", "tanh({k}*({u}))", "atan({k}*({u}))",
            "({u})/sqrt(abs({u}) + 1e-6)", "({u} > 0 ? {k}*({u}) : ({u})/{k})", "({u} >= 0 ? 1 : -1)", "exp({k}*({u})) - 1"]
RUNS = [[], ["-k"], ["-i", "rk8"], ["--tolerance", "1e-3"], ["--tolerance", "1e-5", "-i", "rodas3"], ["--tolerance", "1e-4", "-i", "dopri5", "-k"]]


@pytest.mark.parametrize("seed", range(24))
def test_an_event_is_at_its_root(written, seed):
    """What models.md promises of any function: once, not before the root, and at most `locate` behind it, or 2^-21 of the step. FP32 rounds x
    and t."""
    draw = random.Random(seed)
    g = MONOTONE[seed % len(MONOTONE)].format(u="x - r", k=draw.choice([3, 30, 0.125, 8]))
    rate, step, until = draw.choice([1, -1, 0.5, -3]), draw.choice([0.0625, 1, 0.3]), 6
    way = draw.choice(["any", "rising" if rate > 0 else "falling"])
    path = written(f"param r = 0\nstate x = {-2.25*rate}\nstate n = 0\nstate hit = -1\nx' = {rate}\nn' = 0\nhit' = 0\n"
                   f"when root({g}) {way}: n = n + 1, hit = t\nstep {step}\nspan {until}\n")
    locate = draw.choice([2**-8, 2**-12, 2**-18])
    config = draw.choice(["many_full", "flush"] if re.search("exp|tanh|atan", g) else ["flush", "cell"])
    how = [path, "--until", until, *RUNS[seed // 4], "-c", config, "-N", 12, "--set", f"locate={locate}", "--spread", f"r={-2*rate}:{3.6*rate}", "--all"]
    out = fp3("run", *how, "-e", "isa").stdout
    found = {name: [float(v) for v in re.findall(rf"^{name} +(\S+)", out, re.M)] for name in ("n", "hit")}
    rounded = 2**-20*until if config == "cell" else 2**-21*until
    for i, (n, hit) in enumerate(zip(found["n"], found["hit"])):
        true = 2.25 + (-2 + 5.6*i/11)
        assert n == 1 and -rounded <= hit - true <= locate + rounded, (g, how, i, hit, true)


def test_a_ball_keeps_its_energy(written):
    """An event that is always late by half of `locate` would give it 1.5e-4 in 35 bounces."""
    path = written("state x = 10\nstate v = 0\nstate n = 0\nx' = v\nv' = -9.81\nn' = 0\nwhen root(x) falling: x = 0, v = -v, n = n + 1\n"
                   "step 0.0625\nspan 100\n")
    for h in ("2^-4", "0.001"):
        o = run(path, "--until", 100, "--set", f"h={h}", "-c", "many_full", "-N", 1, engine="fast")[0]
        assert o["n"] == 35 and o["v"]**2/2 + 9.81*o["x"] == pytest.approx(98.1, rel=1e-5)


# ---- engines ----

@pytest.mark.parametrize("text, spread", [(BALL, "x=0.5:1.5"), (IMPACT, "wall=0.5:0.9"), (ROCKET, "m=2.5:3.5")])
@pytest.mark.parametrize("how", [["--until", 2, "-n", 4000], ["--until", 2, "-n", 4000, "-k", "-i", "cash_karp"],
                                 ["--tolerance", 1e-4, "--until", 2, "-n", 4000], ["-n", 64]])
def test_every_engine_has_the_same_bits(written, text, spread, how):
    """Objects whose events come at different times, in attempts of different number."""
    path = written(text)
    seen = []
    for engine in ("isa", "fast", "rtl"):
        out = fp3("run", path, *how, "-e", engine, "-c", "many_full", "-N", 20, "--spread", spread, "--all").stdout
        seen.append(re.findall(r"^(\w+ .*object \d+)$", out, re.M))
    assert seen[0] == seen[1] == seen[2] and len(seen[0]) >= 60
    one = [run(path, *how, engine=engine)[0] for engine in ("isa", "rtl")]
    assert one[0] == one[1] and one[0]


# ---- around it ----

def test_stoermer_needs_equal_steps(written):
    path = written("state v = 0\nstate x = 1\nx' = v\nv' = -x\nstep 0.125\n")
    refused = fp3("run", path, "-i", "stoermer_verlet", "--until", 1, status=2).stderr
    assert "works from the positions of two steps of the same length" in refused


def test_locate_has_an_end(written):
    for value, status in (("1e-30", 2), ("0", 2), ("2^-44", 0)):
        done = fp3("run", written(BALL), "--until", 1, "--set", f"locate={value}", status=status)
        assert status == 0 or f"'locate' is {float(value):.9g}: expected a finite number above 0, at least 2^-45 of 'until'" in done.stderr


def test_a_scene_of_fixed_steps_up_to_a_time(written, tmp_path):
    written(BALL)
    (tmp_path / "s.scene").write_text('config = "many_full";\nengine = "fast";\nh = 0.0625;\ngroups = (\n'
                                      '{ program = "m.ode"; objects = 2; until = 1.9; spread = { x = [1.0, 2.0]; }; });\n')
    out = fp3("run", "--scene", tmp_path / "s.scene").stdout
    found = float(re.search(r"^x +(\S+)", out, re.M)[1])
    assert found == pytest.approx(ball(1.9)[1], abs=1e-6)


def test_snapshots(written):
    out = fp3("run", written(BALL), "--until", 1.9, "--times", "0.3,1.9", "--output", "-", "--observe", "x,t").stdout
    rows = [line.split(",") for line in out.splitlines() if re.match(r"^\d", line)]
    assert float(rows[0][-2]) == pytest.approx(1 - 9.81*0.09/2, abs=1e-6)
    assert float(rows[1][-2]) == pytest.approx(ball(1.9)[1], abs=1e-6)


def test_the_check_knows_the_order(written):
    """With half the step the error of rk4 is a sixteenth: the estimate is near what it is against the truth."""
    path = written(IMPACT)
    out = fp3("run", path, "--until", 7, "--set", "h=2^-3", "--check", "-e", "isa").stdout
    said = float(re.search(r"^x .* error (\S+),", out, re.M)[1])
    found = abs(run(path, "--until", 7, "--set", "h=2^-3")[0]["x"] - truth(path, 7)["x"])
    assert found/1.5 < said < 1.5*found


@pytest.mark.parametrize("how", [["--until", 2], ["--tolerance", 1e-4, "--until", 2, "--set", "maxstep=0.05"]])
def test_more_times_than_steps_end_at(written, how):
    """Steps end at sixteen of them; the others are looked for as roots are."""
    lines = [f"at t = {0.07*(i + 1):.2f}: n = n + 1" for i in range(20)]
    path = written("\n".join(["state n = 0", "state y = 0", "n' = 0", "y' = n", *lines, "step 0.0625", ""]))
    assert run(path, *how)[0]["y"] == pytest.approx(sum(2 - 0.07*(i + 1) for i in range(20)), abs=2e-5)


@pytest.mark.parametrize("h", ["2^-4", "0.5"])
@pytest.mark.parametrize("how", [["--until", 2], ["--tolerance", 1e-4, "--until", 2]])
def test_a_condition_that_is_true_at_the_start(written, how, h):
    """Its event happens at once, and not at the end of the first step, where it may be no longer true."""
    path = written("state n = 0\nstate y = 0.4\nn' = 0\ny' = 1 + n\nwhen y < 0.5 and n < 0.5: n = 1\nstep 0.0625\n")
    assert truth(path, 2)["y"] == pytest.approx(4.4)
    for locate, late in (("1e-6", 1e-6), (None, 2e-3)):
        given = ["--set", f"locate={locate}"] if locate else []
        found = [run(path, *how, "--set", f"{'h_next' if '--tolerance' in how else 'h'}={h}", *given, engine=engine)[0] for engine in ("isa", "fast", "rtl")]
        assert found[0] == found[1] == found[2]
        assert found[0]["n"] == 1 and abs(found[0]["y"] - 4.4) < late + 1e-6


@pytest.mark.parametrize("start, until", [(-1, 1), (1e6, 1000002), (16777216, 16777218)])
@pytest.mark.parametrize("how", [[], ["--tolerance", 1e-6]])
def test_a_run_that_begins_late(written, start, until, how):
    """How late an event may be is a part of the step then: 2^-24 of the end is a second."""
    v, x, n = ball(until - start)
    found = run(written(BALL), *how, "--until", until, "--set", f"t={start}")[0]
    assert found["n"] == n == 3 and abs(found["x"] - x) < 4e-4 and abs(found["v"] - v) < 2e-3
