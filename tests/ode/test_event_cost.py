"""What a step costs when no event happens: the instructions of docs/adaptive.md, and no more."""
import re

import pytest
from runs import fp3
from test_roots import BALL, HEATER, IMPACT, ROCKET

KEPLER = """
state v[2] = (0, 1.2)
state r[2] = (1, 0)
state n = 0
r' = v
v' = -r/norm(r)^3
n' = 0
when root(r.y) rising: n = n + 1
step 0.015625
"""
MODELS = {"ball": BALL, "heater": HEATER, "impact": IMPACT, "rocket": ROCKET, "kepler": KEPLER}


def cost(path, states, *how):
    out = fp3("compile", path, "-c", "many_full", *how, *(x for s in states for x in ("--observe", s))).stdout
    return int(re.search(r"in (\d+) instructions", out)[1])


@pytest.mark.parametrize("name, plain, until, steps, located", [
    ("ball", 9, 21, 17, 46), ("heater", 19, 30, 31, 62), ("impact", 70, 77, 78, 102), ("rocket", 62, 68, 81, 114), ("kepler", 90, 90, 96, 115)])
def test_instructions_of_a_step(written, name, plain, until, steps, located):
    text = MODELS[name]
    states = ["r_x", "r_y", "v_x", "v_y", "n"] if name == "kepler" else re.findall(r"^state (\w+)", text, re.M)
    without = written(re.sub(r"^(when|at t).*$", "", text, flags=re.M), "without.ode")
    found = [cost(without, states), cost(without, states, "--until", 2), cost(written(text), states), cost(written(text), states, "--until", 2)]
    assert found == [plain, until, steps, located]
