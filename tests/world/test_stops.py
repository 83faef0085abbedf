"""`stop` where objects see each other: with fixed steps an object that has stopped keeps its states and its time, and others see it there."""

import re

import numpy as np
import pytest

MODEL = """\
state x = 0
state v = 0.5
near ties(x, 0.35)
step 0.0078125
F = sum(o in ties: 4*(x - o.x)) + 0.25*t
x' = v
v' = F
when x > 1: stop
"""
H, OBJECTS = 0.0078125, 6


@pytest.fixture
def stopped(start, folder):
    def stopped(integrator, engine, steps, *options):
        (folder / "m.ode").write_text(MODEL)
        done = start("m.ode", "-i", integrator, "--engine", engine, "--objects", OBJECTS, "--steps", steps, "--spread", "x=0:0.9", "--all", *options)
        assert done.returncode == 0, done.stderr
        return re.findall(r"^(\w+) +(\S+) +0x([0-9a-f]{8})   object (\d+)$", done.stdout, re.M)
    return stopped


def column(said, name):
    return np.array([float(value) for one, value, _, _ in said if one == name])


def force(x, t):
    way = x[:, None] - x[None]
    return (4*way*(np.abs(way) < np.float32(0.35))).sum(1) + 0.25*t


def rates(x, v, t, moves):
    return np.where(moves, v, 0), np.where(moves, force(x, t), 0)


def leapfrog(x, v, t, moves):
    half = x + np.where(moves, H/2*v, 0)
    v = v + np.where(moves, H*force(half, t + H/2), 0)
    return half + np.where(moves, H/2*v, 0), v


def rk4(x, v, t, moves):
    k = [rates(x, v, t, moves)]
    for share in (0.5, 0.5, 1):
        k.append(rates(x + share*H*k[-1][0], v + share*H*k[-1][1], t + share*H, moves))
    return (z + H/6*(k[0][i] + 2*k[1][i] + 2*k[2][i] + k[3][i]) for i, z in enumerate((x, v)))


@pytest.mark.parametrize("integrator, step", [("leapfrog", leapfrog), ("rk4", rk4)])
def test_in_double(stopped, integrator, step):
    """One that has stopped stands where it is at all stages of the others' steps."""
    x, v, moves, steps = np.linspace(0, np.float32(0.9), OBJECTS).astype(np.float32).astype(float), np.full(OBJECTS, 0.5), np.ones(OBJECTS, bool), 150
    made = np.zeros(OBJECTS)
    for n in range(steps):
        made += moves
        x, v = step(x, v, n*H, moves)
        moves &= ~(x > 1)
    said = stopped(integrator, "isa", steps)
    assert list(column(said, "stopped")) == list(1.0*~moves) and 0 < moves.sum() < OBJECTS
    assert np.abs(column(said, "x") - x).max() < 2e-5 and np.abs(column(said, "v") - v).max() < 2e-4
    assert list(column(said, "steps")) == list(made)


@pytest.mark.parametrize("integrator, options", [
    ("euler", ()), ("leapfrog", ("-k",)), ("rk4", ()),
    *[pytest.param(*row, marks=pytest.mark.long) for row in [
        ("euler", ("-k",)), ("leapfrog", ()), ("rk4", ("-k",)), ("verlet", ()), ("verlet", ("-k",)), ("heun", ()), ("heun", ("-k",))]]])
def test_words_are_the_same_everywhere(stopped, long, integrator, options):
    """Eight lanes by one integrator (all): they are simulated slowly."""
    lanes = [("rtl", "--config", "fabric")] if long or integrator == "euler" else []
    found = [stopped(integrator, engine, 150, *options, *more) for engine, *more in (("isa",), ("fast", "--threads", 2), ("rtl",), *lanes)]
    assert all(one == found[0] for one in found) and 1 in column(found[0], "stopped")
    later = stopped(integrator, "isa", 180, *options)
    who = {number for name, _, bits, number in found[0] if name == "stopped" and bits == "3f800000"}
    assert [one for one in later if one[3] in who] == [one for one in found[0] if one[3] in who]
