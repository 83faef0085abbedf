"""Compensated runs of every built-in integrator: coefficients rounded to FP32 add up, so that phases do not drift with time."""

import cmath

import pytest
from runs import fp3
from tables import NAMES, read, step

CIRCLE = """model circle "a mass on a spring"

state v = 0 "velocity"
state x = 1 "position"

step 0.015625
span 4096

v' = -x
x' = v
"""
H, TIME = 2.0**-6, 4096
SAME = {"stoermer_verlet": "verlet"}  # the same positions, and a table with substeps


def power(matrix, n):
    """Of two rows and columns, by squares."""
    result, square = ((1, 0), (0, 1)), matrix
    while n:
        if n % 2:
            result = product(result, square)
        square, n = product(square, square), n // 2
    return result


def product(a, b):
    return tuple(tuple(sum(a[i][k] * b[k][j] for k in range(2)) for j in range(2)) for i in range(2))


def in_double(table, steps):
    """x + i v from x = 1 by the same integrator, so that its own error is in both."""
    columns = [step(table, lambda x, v: [-x[0]], [x], [v], H) for x, v in ((1.0, 0.0), (0.0, 1.0))]
    (x, _), (v, _) = power(tuple(zip(*((x[0], v[0]) for x, v in columns))), steps)
    return complex(x, v)


@pytest.mark.parametrize("name", NAMES)
def test_phase_and_amplitude_do_not_drift(name, root, tmp_path):
    path = tmp_path / "circle.ode"
    path.write_text(CIRCLE)
    steps = round(TIME / H)
    out = fp3("run", path, "-i", name, "-k", "-e", "fast", "-c", "many_full", "-N", 1, "--steps", steps).stdout
    state = {line.split()[0]: float(line.split()[1]) for line in out.splitlines()[:2]}
    ratio = complex(state["x"], state["v"]) / in_double(read(root / f"programs/integrators/{SAME.get(name, name)}.cfg"), steps)
    assert abs(cmath.log(ratio)) / TIME < 5e-9, cmath.log(ratio) / TIME
