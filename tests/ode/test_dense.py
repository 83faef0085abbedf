"""Results at times between the ends of steps: with the order of the method, as a step ends at each of them."""
import math
import re

import pytest
from runs import fp3

OSCILLATOR = """
state v = 0
state x = 1
x' = v
v' = -x
step 0.125
span 7
"""
TIMES = [0.317, 1.71, 2.003, 3.9, 5.777, 6.41]


def worst(path, integrator, h):
    """The largest distance from the solution at the times, and the steps in all; compensated, as else rounding is what is left."""
    out = fp3("run", path, "-i", integrator, "-k", "--set", f"h={h}", "--until", 7, "-e", "isa", "--times", ",".join(map(str, TIMES)),
              "--output", "-", "--observe", "x,v,t,accepted").stdout
    rows = [line.split(",") for line in out.splitlines() if re.match(r"^\d+,", line)]
    assert [float(row[5]) for row in rows] == pytest.approx(TIMES, abs=3e-7) and len(rows) == len(TIMES)
    return max(math.hypot(float(row[3]) - math.cos(float(row[5])), float(row[4]) + math.sin(float(row[5]))) for row in rows), float(rows[-1][6])


@pytest.mark.parametrize("integrator, order, steps", [("rk4", 4, (0.5, 0.25, 0.125)), ("dopri5", 5, (0.5, 0.25)), ("rk8", 8, (1.9, 1.3))])
def test_the_order_between_grid_points(written, integrator, order, steps):
    path = written(OSCILLATOR)
    errors = [worst(path, integrator, h)[0] for h in steps]
    found = math.log(errors[0]/errors[-1])/math.log(steps[0]/steps[-1])
    assert order - 0.4 < found < order + 1.2 and errors[-1] > 1e-6, (found, errors)


def test_a_time_costs_one_step_more_at_most(written):
    assert math.ceil(6.41/0.125) <= worst(written(OSCILLATOR), "rk4", 0.125)[1] <= math.ceil(6.41/0.125) + len(TIMES)
