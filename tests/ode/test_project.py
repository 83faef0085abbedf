"""`project`: what steps put back, on every engine, compensated or not; the truth does without."""
import math
import re

import pytest
from runs import fp3, number, truth

TOP = """
param w[3] = (0.3, 1, 0.2)
state q0 = 1
state q[3] = (0, 0, 0)
n = sqrt(q0^2 + dot(q, q))
q0' = -0.5*dot(w, q)
q' = 0.5*(q0*w + cross(q, w))
{}
step 0.015625
span 1000
"""
PROJECT = "project q0 = q0/n, q = q/n"


def run(path, *arguments, engine="fast"):
    out = fp3("run", path, "-e", engine, "-c", "many_full", "-N", 1, *arguments).stdout
    return {name: number(bits) for name, bits in re.findall(r"^(q\w*) +\S+ +(0x[0-9a-f]{8}).* object 0$", out, re.M)}


def errors(path, *arguments):
    """Of the states against the truth, which has the length 1, and of the square of the length."""
    found, true = run(path, "-n", 64000, *arguments), truth(path, 1000)
    return max(abs(found[q] - true[q]) for q in true), abs(sum(found[q]**2 for q in true) - 1)


@pytest.mark.parametrize("line, arguments, error, length", [
    ("", [], 5.9e-6, 7.6e-6), ("", ["-k"], 2.2e-6, 1.3e-6),
    (PROJECT, [], 2.1e-5, 3.4e-8), (PROJECT, ["-k"], 1.2e-6, 7.3e-8),
    ("f = 1/n\nproject q0 = q0*f, q = f*q", ["-k"], 1.3e-6, 7.4e-8)])
def test_the_figures_in_the_docs(written, line, arguments, error, length):
    assert errors(written(TOP.format(line)), *arguments) == pytest.approx((error, length), rel=0.05)


def test_an_event_instead(written):
    """Every step sets the states anew, and what was lost of them is gone; there is no truth."""
    path = written(TOP.format(PROJECT.replace("project", "when 1:")))
    assert "write a projection as `project q = q/norm(q)`" in truth(path, 1000, status=1)
    found, true = run(path, "-n", 64000, "-k"), truth(written(TOP.format(""), "t.ode"), 1000)
    assert max(abs(found[q] - true[q]) for q in true) == pytest.approx(1.7e-5, rel=0.05)


@pytest.mark.parametrize("how", [["-n", 40], ["-n", 40, "-k"], ["-n", 40, "-i", "tsit5"], ["--tolerance", 1e-5, "--until", 2],
                                 ["--tolerance", 1e-5, "--until", 2, "-i", "dopri5", "-k"], ["--until", 1]])
def test_every_engine_has_the_same_bits(written, how):
    path = written(TOP.format(PROJECT))
    seen = [fp3("run", path, *how, "-e", engine, "-c", "many_full", "-N", 9, "--spread", "w_x=0:2", "--all").stdout.split("object_steps")[0]
            for engine in ("isa", "fast", "rtl")]
    assert seen[0] == seen[1] == seen[2] and "object 8" in seen[0]


def test_the_result_is_projected(written):
    """Whatever the step and the steps' choice have made, the last thing is the projection, and then events."""
    path = written("state x = 3\nstate y = 0\nx' = 1\ny' = 0\nproject x = 2*x/abs(x)\nwhen x == 2: y = x\nstep 0.5\n")
    for how in (["-n", 3], ["-n", 3, "-k"], ["--until", 1.5], ["--tolerance", 1e-3, "--until", 1.5]):
        out = fp3("run", path, "-e", "isa", *how).stdout
        assert {name: float(x) for name, x in re.findall(r"^([xy]) +(\S+)", out, re.M)} == {"x": 2, "y": 2}


def test_all_values_are_those_before_it(written):
    path = written("state a = 1\nstate b = 2\na' = 0\nb' = 0\nproject a = b, b = a\nproject a = a + b\nstep 0.5\n")
    for arguments in ([], ["-k"]):
        out = fp3("run", path, "-e", "isa", "-n", 1, *arguments).stdout
        assert {name: float(x) for name, x in re.findall(r"^([ab]) +(\S+)", out, re.M)} == {"a": 3, "b": 1}


def test_the_order_is_kept_and_dead_states_need_none(written):
    path = written("state x = 1\nstate y = 1\nx' = -x\ny' = -y\nproject y = y + x - x\nstep 0.125\n")
    assert "Order 6." in fp3("compile", path, "-i", "rk6").stdout
    assert "line 5" not in fp3("compile", path, "--observe", "x").stdout
    assert "line 5" in fp3("compile", path, "--observe", "y").stdout


BEAD = """
param R = 1
{}state x[2] = (1, 0)
state v[2] = (0, 0)
x' = v
v' = (0*R, -9.81)
project x = R*x/norm(x)
project v = {}
step 0.0078125
"""


def test_what_was_before_the_step(written):
    """As a model says that keeps it in states of its own: the same bits, in every arithmetic, also where each step has a length of its own."""
    kept = BEAD.format("state b[2] = (1, 0)\nb' = (0*R, 0)\n", "(x - b)/H, b = x").replace("param R", "param H = 0.0078125\nparam R")
    short = BEAD.format("", "(x - prev(x))/h")
    for arguments in (["-i", "semi_implicit_euler"], ["-i", "rk4"], ["-i", "rk4", "--double-single"]):
        seen = [re.findall(r"^[xv]_.*(0x[0-9a-f]{8})", fp3("run", written(text), "-e", "isa", "-n", 40, *arguments).stdout, re.M) for text in (kept, short)]
        assert seen[0] == seen[1] and len(seen[0]) == 4
    assert "over_h" in fp3("compile", written(short), "-i", "semi_implicit_euler").stdout
    path = written("state x = 3\nstate y = 0\nstate z = 0\nstate n = 0\nx' = 0\ny' = 2\nz' = 0\nn' = 0\nproject z = z + h, x = prev(y), n = n + (y - prev(y))/h\nstep 0.5\n")
    out = fp3("run", path, "-e", "isa", "--tolerance", 1e-3, "--until", 3).stdout
    found = {name: float(x) for name, x in re.findall(r"^([xyzn]) +(\S+)", out, re.M)}
    assert found["z"] == pytest.approx(3) and found["y"] == pytest.approx(6) and found["x"] < 6 and found["n"] > 3 and found["n"]/2 == pytest.approx(round(found["n"]/2), abs=1e-5)


def test_the_truth_has_no_steps(written):
    for term in ("x*(1 + 0*h)", "0*prev(x) + x"):
        path = written(f"state x = 1\nx' = -x\nproject x = {term}\nstep 0.5\nspan 1\n")
        done = fp3("bench", path, status=2)
        assert "its projection in line 3 moves the states by what happened within a step" in done.stderr and not done.stdout


@pytest.mark.parametrize("text, message", [
    ("project x = x*h", None), ("prev = 2\nproject x = prev*x", None),
    ("f = h", "3:5: error: found 'h', expected a name that is defined above"),
    ("when x > h: x = 0", "3:10: error: found 'h', expected a name that is defined above"),
    ("f = prev(x)", "3:5: error: found 'prev', expected a function"),
    ("project x = prev(2)", "3:18: error: found '2', expected the name of a state, as in prev(x)"),
    ("param k = 1\nproject x = prev(k)", "4:18: error: found 'k', expected the name of a state, as in prev(x)"),
    ("project x = prev(x + 1)", "3:20: error: found '+', expected ')'"),
    ("project y = 2", "3:9: error: found 'y', expected a name that is defined above"),
    ("project x = 2, x = 3", "3:16: error: found 'x', expected another state"),
    ("project x", "3:10: error: found end of line, expected '='"),
    ("project = 3\nproject x = project", None),
])
def test_what_is_refused(written, text, message):
    path = written("state x = 1\nx' = 1\n" + text + "\nstep 0.5\n")
    done = fp3("compile", path, status=2 if message else 0)
    assert not message or message in done.stderr


def test_positions_of_two_steps(written):
    path = written("state v = 0\nstate x = 1\nx' = v\nv' = -x\nproject x = x\nstep 0.125\n")
    assert "found a projection, which would change only one of them" in fp3("compile", path, "-i", "stoermer_verlet", status=2).stderr


MAP = "state q = {}\nstate q2 = 3\nproject q = 0.5*q, q2 = q2 + q\nstep 1"


@pytest.mark.parametrize("engine", ["fast", "isa", "rtl"])
@pytest.mark.parametrize("arguments", [[], ["-k"]])
def test_a_model_without_equations_is_a_map(written, engine, arguments):
    """A step is its projections, each of all values before it; nothing is added to a state that stays, not even to -0."""
    found = run(written(MAP.format(8)), "-n", 3, *arguments, engine=engine)
    assert (found["q"], found["q2"]) == (1, 3 + 8 + 4 + 2)
    found = run(written(MAP.format("-0")), "-n", 2, engine=engine)
    assert math.copysign(1, found["q"]) == -1 and found["q2"] == 3


def test_a_map_has_no_truth_and_needs_a_projection(written):
    assert "its projections alone move the states" in truth(written(MAP.format(8)), 1, status=1)
    for text in ("state q = 1\nstep 1", "state q = 1\nstate v = 1\nq' = v\nproject v = 0.5*v\nstep 1"):
        assert "an equation for this state" in fp3("compile", written(text), status=2).stderr
    for arguments, status in ((["--tolerance", "1e-4", "--until", 3], 2), (["--until", 3], 2), (["-n", 3, "--check"], 2)):
        assert "has no equations, so its steps have no length" in fp3("run", written(MAP.format(8)), "-e", "fast", *arguments, status=status).stderr
