"""Stiff models: linearly implicit methods, their Jacobians, and steps that explicit methods cannot take."""
import json
import math
import os
import re
import subprocess

import pytest
from runs import BUILD, fp3

PROGRAMS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../programs")
ROBERTSON = os.path.join(PROGRAMS, "robertson.ode")
# Everything that has a derivative: an order that holds says that all of the Jacobian is right.
EVERY = """param a = 0.3
state x = 0.4
state y = 0.7
x' = sin(x*y)/3 + exp(-x) - atan(y)/(2 + x^2) + a*tanh(x - t) + log(2 + y)*cosh(x/2) - y^1.5 + t*cos(t*y)
y' = cos(x)/4 + sqrt(1 + x*y)/2 - tan(y/3) + sinh(x/3) - asin(x/4)*acos(y/4) + atan2(y, 1 + x) - y^-2/8 - x/(1 + y) + a^2*(2 + x)^a
step 0.0625
span 1
"""
PIECES = """state x = 1
state y = 0.5
x' = -(x < 2 ? 3*x : x^2) - min(y, 4)*max(x, -1)
y' = abs(y + 1) - 50*y
step 0.0625
span 1
"""


@pytest.fixture
def model(tmp_path):
    def write(text):
        (tmp_path / "m.ode").write_text(text)
        return tmp_path / "m.ode"

    return write


def rows(tmp_path, path, *arguments):
    fp3("compare", path, *arguments, "--json", tmp_path / "rows.json")
    return json.loads((tmp_path / "rows.json").read_text())["rows"]


def states(out):
    return {name: float(value) for name, value in re.findall(r"^(\w+) +(\S+) +0x[0-9a-f]{8} +object 0$", out, re.M)}


def cycles(out):
    return int(re.search(r"^cycles +(\d+)$", out, re.M)[1])


METHODS = ["ros2", "ros3p", "rodas3"]


@pytest.mark.smoke
@pytest.mark.parametrize("text", [EVERY, PIECES], ids=["every", "pieces"])
def test_the_order_holds_with_every_function_and_with_t(model, tmp_path, text):
    """A partial derivative that is wrong or missing, by a state or by t, costs an order of ros3p and rodas3."""
    for row in rows(tmp_path, model(text), "--quick", "--arithmetic", "plain", "--most-steps", 128, "-i", "ros3p", "-i", "rodas3"):
        assert row["order"] == 3 and row["method_order"] > 2.4, row


RULES = ["sin(x)", "cos(x)", "tan(x)", "atan(x)", "asin(x)", "acos(x)", "exp(x)", "log(x)", "log2(x)", "sinh(x)", "cosh(x)", "tanh(x)", "expm1(x)", "log1p(x)",
         "logistic(x)", "sqrt(x)",
         "x^3", "x^-2", "x^2", "x^1", "x^0", "x^1.5", "x^0.3", "1/x", "x/(1 + x)", "(2 - x)*x", "-x", "3 - x", "atan2(x, 2)", "atan2(2, x)",
         "min(x, 1)", "min(x, 0)", "max(x, 1)", "max(x, 0)", "abs(x)", "abs(-x)", "x < 1 ? x^2 : 5*x", "x > 1 ? x^2 : 5*x", "2*(x < 1) + x",
         "5", "sin(x^2)*exp(-x)/sqrt(1 + x)"]
HOST = {name: getattr(math, name) for name in "sin cos tan atan asin acos exp log log2 expm1 log1p sinh cosh tanh sqrt atan2".split()} | {
    "min": min, "max": max, "abs": abs, "logistic": lambda x: 1/(1 + math.exp(-x))}


def value(text, x):
    """What Python makes of an expression of the language."""
    text = re.sub(r"^(.*) \? (.*) : (.*)$", r"(\2) if (\1) else (\3)", text).replace("^", "**")
    return eval(text, HOST | {"x": x})


@pytest.mark.parametrize("rule", RULES)
def test_each_rule_of_differentiation(model, rule):
    """One step of the linearly implicit method of Euler, gamma = 1, tells f': x1 = x0 + h f/(1 - h f'). As a function
    of t it tells f_t: x1 = x0 + h f + h^2 f_t."""
    h, at = 0.25, 0.4
    slope = (value(rule, at + 1e-6) - value(rule, at - 1e-6))/2e-6
    table = model("").parent / "one.cfg"
    table.write_text('name = "one"; doc = "d"; source = "s"; kind = "rosenbrock"; order = 1; gamma = 1; A = (()); G = (()); b = (1);\n')
    run = ("run", table.parent / "m.ode", "-i", table, "-c", "many_full", "-e", "isa", "-N", 1, "--steps", 1)
    model(f"state x = {at}\nx' = {rule}\nstep {h}\n")
    x = states(fp3(*run).stdout)["x"]
    assert x == pytest.approx(at + h*value(rule, at)/(1 - h*slope), rel=2e-6)
    of_time = re.sub(r"\bx\b", f"({at} + t)", rule)
    model(f"state y = 1\ny' = {of_time}\nstep {h}\n")
    y = states(fp3(*run).stdout)["y"]
    assert y == pytest.approx(1 + h*value(rule, at) + h*h*slope, rel=2e-6)


@pytest.mark.parametrize("name, integrator", [("robertson", "ros3p"), ("rc_ladder", "ros2"), ("van_der_pol_stiff", "ros2")])
def test_hardware_engines_and_equations_agree(tmp_path, name, integrator):
    made = rows(tmp_path, os.path.join(PROGRAMS, f"{name}.ode"), "-i", integrator, "--arithmetic", "plain", "--most-steps", 64, "--span", 0.01)
    assert made
    for row in made:
        assert row["mismatches"] == 0 and row["compared"] > 0
        assert all(row[machine]["predicted"] == row[machine]["measured"] for machine in ("many_full", "single_full", "sixteen"))


def test_double_single_solves_systems_too(tmp_path):
    row, = rows(tmp_path, os.path.join(PROGRAMS, "van_der_pol.ode"), "-i", "ros2", "--arithmetic", "double_single", "--most-steps", 16, "--span", 1)
    assert row["mismatches"] == 0 and row["compared"] > 0


def test_the_ladder_takes_steps_that_rk4_cannot(tmp_path):
    """Fixed steps 11 times as long as those that rk4 needs, which overflows."""
    ladder = os.path.join(PROGRAMS, "rc_ladder.ode")
    run = ("run", ladder, "-c", "many_full", "-e", "isa", "-N", 1, "--set", f"h={0.125/16!r}", "--steps", 16)
    good = states(fp3("run", ladder, "-i", "rk4", "-c", "many_full", "-e", "isa", "-N", 1, "--set", f"h={0.125/1024!r}", "--steps", 1024).stdout)
    got = states(fp3(*run, "-i", "ros3p").stdout)
    assert max(abs(got[name] - good[name]) for name in good) < 1e-3
    assert any(abs(x) > 1e10 or math.isnan(x) for x in states(fp3(*run, "-i", "rk4", "--allow-failures").stdout).values())


def test_robertson_with_adaptive_steps_in_two_hundredths_of_the_cycles_of_rk4():
    """Truth: fp3_model_truth. rk4 is stable up to h = 2.78 over the largest eigenvalue, some 2,600."""
    out = fp3("run", ROBERTSON, "-i", "rodas3", "-c", "many_full", "-e", "isa", "-N", 1, "--tolerance", "1e-3", "--set", "absolute=1e-8").stdout
    got = states(out)
    truth = {"y1": 0.8319337, "y2": 1.5508606e-05, "y3": 0.1680508}
    assert all(abs(got[name]/x - 1) < 1e-3 for name, x in truth.items()), got
    rk4 = float(re.search(r"cycles per object-step +(\S+)", fp3("compile", ROBERTSON, "-c", "many_full", "--report").stdout)[1])
    assert cycles(out) < 0.02*rk4*11.25/(2.785/2600)


def test_van_der_pol_over_more_than_a_period():
    """x(2000) = 1.706167732 (Test Set for Initial Value Problem Solvers). Steps in the jumps are shorter than the last place of t."""
    out = fp3("run", os.path.join(PROGRAMS, "van_der_pol_stiff.ode"), "-i", "rodas3", "-c", "many_full", "-e", "isa", "-N", 1, "--until", 2000,
              "--tolerance", "1e-4").stdout
    assert abs(states(out)["x"]/1.706167732 - 1) < 1e-3 and cycles(out) < 65000


def test_a_pivot_that_cancels_fails_the_object(model):
    """1/(gamma h) - J is nearly singular on purpose, in the second pivot and in the first: the run says so."""
    text = "state x = 1\nstate y = 1\nx' = -3*x + 8*y\ny' = 2*x\nstep 1\nspan 4\n"
    path = model(text)
    table = path.parent / "one.cfg"
    table.write_text('name = "one"; doc = "d"; source = "s"; kind = "rosenbrock"; order = 1; gamma = 1; A = (()); G = (()); b = (1);\n')
    # The second pivot is 1 - 8*2/4; with 1.9999 for 8 it is 5e-5.
    run = ("run", path, "-i", table, "-c", "many_full", "-e", "isa", "-N", 1, "--steps", 1)
    fp3(*run)
    path.write_text(text.replace("8*y", "1.9999*y"))
    done = fp3(*run, status=3)
    assert "invalid" in done.stdout + done.stderr
    path.write_text(text.replace("-3*x", "0.9999*x"))  # the first pivot, 1 - 0.9999
    assert "invalid" in fp3(*run, status=3).stderr


def test_registers_limit_the_states(model):
    """One more than fit where each depends on all, and a chain of more than twice as many."""
    def text(rates):
        return "".join(f"state x{i} = 1\n" for i in range(len(rates))) + "".join(f"x{i}' = {rate}\n" for i, rate in enumerate(rates)) + "step 0.0078125\n"

    everyone = " + ".join(f"x{i}" for i in range(13))
    refused = fp3("compile", model(text([f"-{i + 1}*x{i}*({everyone})" for i in range(13)])), "-i", "ros2", "-c", "many_full", status=2)
    assert "the program needs 143 object registers" in refused.stderr
    chain = model(text([f"{'x' + str(i - 1) if i else '0'} - 2*x{i} + {'x' + str(i + 1) if i < 29 else '0'}" for i in range(30)]))
    ran = [states(fp3("run", chain, "-i", "ros2", "-c", "many_full", "-e", engine, "-N", 1, "-n", 128).stdout) for engine in ("isa", "fast")]
    assert ran[0] == ran[1] and len(ran[0]) == 30
    assert ran[0]["x0"] == pytest.approx(0.5237776, abs=1e-4)  # exp(-2)(I0(2) + I1(2))
