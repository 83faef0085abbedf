"""Hinges and welds of trees that heavy bodies pull at (sw/bodies/trees.h): what they carry, by statics; lengths and energy; the same bits by each engine."""

import math
import os
import pathlib
import sys

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python"))
BUILD = pathlib.Path(os.environ.get("FP3_BUILD", ROOT / "build"))
os.environ["FP3_HOME"] = str(BUILD)
if BUILD.name != "build" and "libasan" not in os.environ.get("LD_PRELOAD", ""):
    pytest.skip("sanitizers have to be there before Python", allow_module_level=True)

import fp3  # noqa: E402

G = 10.0


def column(value):
    return np.ravel(value)


class Tree:
    """Links of 1 kg and 1 m from the origin along an angle, and a disc at the end."""

    def __init__(self, links, heavy, joint="hinge", turn=-math.pi / 2, **options):
        self.world = fp3.Bodies(gravity=(0, -G), rest_speed=0.0, bounce=0.0, **options)
        self.ground = self.world.add(type="static")
        self.joints, self.bodies, before = [], [], self.ground
        for k in range(links + 1):
            along = k + 0.5 if k < links else links
            body = self.world.add(x=(along * math.cos(turn), along * math.sin(turn)), angle=turn)
            self.world.attach(body, fp3.box(0.5, 0.125, density=4.0) if k < links else fp3.circle(0.5, density=heavy / (math.pi / 4)))
            self.joints.append(self.world.join(joint, before, body, anchor_a=(0.5 if k else 0, 0), anchor_b=(-0.5 if k < links else 0, 0)))
            self.bodies.append(body)
            before = body

    def of(self, name, body=-1):
        return column(self.world.read(name, self.bodies[body]))

    def pull(self, k):
        return np.array([float(column(self.world.read_joint(name, self.joints[k]))[0]) for name in ("force_x", "force_y")])


@pytest.mark.parametrize("heavy, substeps", [(1000.0, 4), (1e5, 1), (1e5, 4)])
def test_a_chain_carries_what_hangs_on_it(heavy, substeps):
    """And is as long as it was, from the first step on."""
    tree = Tree(20, heavy, substeps=substeps)
    for steps in (1, 59, 120):
        tree.world.step(steps)
        for k in range(21):
            assert tree.pull(k) == pytest.approx([0, G * (heavy + 20 - k)], rel=1e-3, abs=1e-3 * G * heavy)
        assert math.hypot(*tree.of("x")) == pytest.approx(20, abs=1e-4)


def test_a_chain_that_swings_keeps_its_length_and_its_energy():
    tree = Tree(20, 1000.0, turn=1.0 - math.pi / 2)
    begin = 1000 * G * tree.of("x")[1]
    for _ in range(10):
        tree.world.step(30)
        x, v = tree.of("x"), tree.of("v")
        assert math.hypot(*x) == pytest.approx(20, rel=1e-4)
        assert 500 * v @ v + 1000 * G * x[1] == pytest.approx(begin, abs=0.01 * 200000)


def test_a_beam_of_welds_holds_its_end():
    """Of 10 links from a wall, with 1,000 kg 10 m from it: the torque is that of all weights."""
    tree = Tree(10, 1000.0, "weld", turn=0.0)
    tree.world.step(120)
    torque = sum(G * (k + 0.5) for k in range(10)) + 10 * 1000 * G
    assert tree.of("x") == pytest.approx([10, 0], abs=2e-3) and tree.of("v") == pytest.approx([0, 0], abs=1e-3)
    assert abs(float(column(tree.world.read_joint("torque", tree.joints[0]))[0])) == pytest.approx(torque, rel=1e-3)


def test_what_swings_into_the_ground_comes_to_rest():
    """Contacts have the last word: nothing is below the ground, and nothing moves in the end."""
    tree = Tree(10, 500.0, turn=0.3)
    tree.world.attach(tree.world.add(type="static", x=(0, -4)), fp3.box(30, 1))
    tree.world.step(1800)
    assert min(tree.of("x", k)[1] for k in range(11)) > -3.05
    assert max(math.hypot(*tree.of("v", k)) for k in range(11)) < 0.5  # of 8 m/s


@pytest.mark.parametrize("kind", ["hinge", "weld"])
def test_what_nothing_holds_keeps_its_momentum(kind):
    """A light rod between a heavy and a light disc, thrown and spinning: its centre flies on, its spin stays, and it is as long as it was."""
    world = fp3.Bodies(gravity=(0, 0), rest_speed=0.0)
    mass, bodies = [5000.0, 1.0, 20.0], []
    for k, m in enumerate(mass):
        bodies.append(world.add(x=(k, 0.0), v=(3.0, k - 1.0), w=1.0))
        world.attach(bodies[k], fp3.circle(0.4, density=m / (0.16 * math.pi)))
    for a, b in zip(bodies, bodies[1:]):
        world.join(kind, a, b, anchor_a=(0.5, 0), anchor_b=(-0.5, 0))

    def sums():
        x, v, w = (np.array([column(world.read(name, body)) for body in bodies]) for name in ("x", "v", "w"))
        inertia = np.array([m * 0.08 for m in mass])
        m = np.array(mass)
        return np.array([*(m @ v), m @ (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]) + inertia @ w[:, 0]]), x
    begin, _ = sums()
    world.step(120)
    end, x = sums()
    assert end == pytest.approx(begin, rel=1e-3) and np.linalg.norm(x[2] - x[0]) == pytest.approx(2, abs=1e-3)


def test_a_tree_may_hang_on_what_the_caller_moves_and_not_turn():
    """A crane: its hook is at rest, seen from what carries it."""
    world = fp3.Bodies(gravity=(0, -G), rest_speed=0.0)
    crane = world.add(type="kinematic", v=(0.0, 2.0))
    light = world.add(x=(0, -1), may_not_turn=True)
    load = world.add(x=(0, -2))
    world.attach(light, fp3.circle(0.1, density=10.0))
    world.attach(load, fp3.circle(0.5, density=2000.0))
    world.join("hinge", crane, light, anchor_b=(0, 1))
    world.join("hinge", light, load, anchor_a=(0, -0.5), anchor_b=(0, 0.5))
    world.step(60)
    assert column(world.read("x", load)) == pytest.approx([0, 0], abs=1e-3) and column(world.read("angle", light))[0] == 0


@pytest.mark.parametrize("engine", ["isa", "fast", pytest.param("rtl", marks=pytest.mark.long)])
def test_each_engine_has_the_same_bits(engine):
    """And a world that went back in time."""
    links, step = (2, 1) if engine == "rtl" else (4, 3)
    own, other = (Tree(links, 400.0, turn=0.2, **more) for more in ({}, {"engine": engine}))
    for tree in (own, other):
        tree.world.step(step)
    saved = own.world.save()
    own.world.step(step)
    other.world.step(step)
    assert own.world.hash == other.world.hash
    own.world.restore(saved)
    own.world.step(step)
    assert own.world.hash == other.world.hash
