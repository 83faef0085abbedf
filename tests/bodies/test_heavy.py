"""Heavy bodies on light ones, by joints and by contacts (sw/bodies/heavy.h): what they carry, by statics; lengths and energy; the same bits by each engine."""

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
    """Nothing is below the ground; the disc lies still, and the slack chain swings on with no more energy than it had."""
    tree = Tree(10, 500.0, turn=0.3)
    tree.world.attach(tree.world.add(type="static", x=(0, -4)), fp3.box(30, 1))
    energies = []
    for _ in range(2):
        tree.world.step(900)
        x, v, w = (np.array([tree.of(name, k) for k in range(11)]) for name in ("x", "v", "w"))
        m, about = np.array([1.0] * 10 + [500.0]), np.array([1.0625 / 12] * 10 + [62.5])
        energies.append(m @ ((v**2).sum(1) / 2 + G * x[:, 1]) + about @ w[:, 0] ** 2 / 2)
        assert x[:, 1].min() > -3.05 and np.hypot(*v[10]) < 0.05 and np.hypot(*v.T).max() < 0.5
    assert energies[1] < energies[0] + 0.05


def span(substeps):
    """Twenty links of 1 kg between two walls, 3 m deep in the middle, where 1,000 kg hang."""
    world, tilt = fp3.Bodies(gravity=(0, -G), rest_speed=0.0, substeps=substeps), math.asin(0.3)
    wall = world.add(type="static")
    at, before, joints = np.zeros(2), wall, []
    for k in range(20):
        turn = -tilt if k < 10 else tilt
        way = np.array([math.cos(turn), math.sin(turn)])
        link = world.add(x=at + way / 2, angle=turn)
        world.attach(link, fp3.box(0.5, 0.05, density=10.0))
        joints.append(world.join("hinge", before, link, anchor_a=(0.5, 0) if k else (0, 0), anchor_b=(-0.5, 0)))
        if k == 10:
            load = world.add(x=at)
            world.attach(load, fp3.circle(0.3, density=1000 / (0.09 * math.pi), mask=0))
            world.join("hinge", link, load, anchor_a=(-0.5, 0))
        at, before = at + way, link
    world.join("hinge", before, wall, anchor_a=(0.5, 0), anchor_b=at)
    return world, load, joints


@pytest.mark.parametrize("substeps", [1, 4])
def test_light_links_carry_a_heavy_body_between_two_walls(substeps):
    """Links of a loop, too: their weight bends them, so the pull is a little off; with one substep they still swing."""
    world, load, joints = span(substeps)
    world.step(300)
    assert column(world.read("x", load)) == pytest.approx([10 * math.cos(math.asin(0.3)), -3], abs=1e-3)
    pull = [float(column(world.read_joint(name, joints[10]))[0]) for name in ("force_x", "force_y")]
    assert math.hypot(*pull) == pytest.approx(1000 * G / 2 / 0.3, rel=0.01 if substeps > 1 else 0.05)


def stack(masses, apart=0.0, x=0.0, **options):
    """Boxes of 1 m on each other; every other one is aside."""
    world = fp3.Bodies(gravity=(0, -G), rest_speed=0.0, **options)
    world.attach(world.add(type="static", x=(0, -1)), fp3.box(20, 1))
    return world, pile(world, masses, apart, x)


def pile(world, masses, apart=0.0, x=0.0):
    boxes = [world.add(x=(x + apart * (k % 2), 0.5 + k)) for k in range(len(masses))]
    for box, mass in zip(boxes, masses):
        world.attach(box, fp3.box(0.5, 0.5, density=mass))
    return boxes


@pytest.mark.parametrize("substeps", [1, 4, 64])
@pytest.mark.parametrize("masses", [(1, 1000), (1, 1, 1, 1, 1000), (1000, 1, 1000), (1, 300, 1, 300, 1, 300), (1, 1e6), (1, 51)])
def test_heavy_boxes_stand_on_light_ones(masses, substeps):
    """For 20 s; 5 with many substeps, when they still sink a little. The floor carries the weight."""
    world, boxes = stack(masses, substeps=substeps)
    world.step(1200 if substeps < 64 else 300)
    x, v = (np.array([column(world.read(name, box)) for box in boxes]) for name in ("x", "v"))
    sag = 0.5 + np.arange(len(masses)) - x[:, 1]
    assert np.abs(x[:, 0]).max() < 1e-6 and np.abs(v).max() < 1e-4
    assert -1e-5 < sag.min() and sag.max() < (0.006 if substeps > 1 else 0.02)
    floor = [float(one["impulse"]) for one in world.contacts() if min(one["point"][1], one["normal"][1]) < 0.3]
    assert len(floor) == 1 and floor[0] == pytest.approx(sum(masses) * G / 60 / substeps, rel=1e-4 if substeps < 64 else 0.02)


def test_a_stack_that_is_not_straight_stands_and_one_over_its_edge_falls():
    for apart, stands in ((0.4, True), (0.6, False)):
        world, boxes = stack([1, 1000], apart=apart)
        world.step(300)
        assert (column(world.read("x", boxes[1]))[1] > 1.4) == stands


def test_a_heavy_box_slides_on_a_light_one_as_friction_has_it():
    """1,000 kg at 2 m/s on a plank of 1 kg, which lies on a rough floor: v^2 / (2 mu g)."""
    world = fp3.Bodies(gravity=(0, -G), rest_speed=0.0)
    world.attach(world.add(type="static", x=(0, -1)), fp3.box(20, 1, friction=1.0))
    plank, box = world.add(x=(0, 0.1)), world.add(x=(-1, 0.7), v=(2.0, 0.0))
    world.attach(plank, fp3.box(2, 0.1, density=1 / 0.8, friction=1.0))
    world.attach(box, fp3.box(0.5, 0.5, density=1000.0, friction=0.09))
    world.step(120)
    assert column(world.read("x", box))[0] + 1 == pytest.approx(4 / (2 * 0.3 * G), rel=0.02)
    assert abs(column(world.read("x", plank))[0]) < 1e-3


def test_who_is_far_away_changes_no_bit():
    """Sets are found one by one."""
    found = []
    for others in (0, 3):
        world, boxes = stack([1, 1000, 1], apart=0.1)
        for k in range(others):
            pile(world, [1] * (k + 1) + [400.0 * (k + 1)], 0.05, 4.0 * (k + 1))
        world.step(60)
        found.append(np.array([column(world.read(name, box)) for name in ("x", "v") for box in boxes]))
    assert np.array_equal(*found)


def heap(number):
    """Boxes and discs of 1 g to 1 t, which fall between two walls: energies after each step, over that at first; and who is how far down at last."""
    chance = np.random.default_rng(number)
    world = fp3.Bodies(gravity=(0, -G), rest_speed=0.0)
    for x, y, a, b in ((0, -1, 20, 1), (-4, 5, 1, 20), (4, 5, 1, 20)):
        world.attach(world.add(type="static", x=(x, y)), fp3.box(a, b))
    bodies = world.add(x=[(chance.uniform(-1.5, 1.5), 0.6 + 1.2 * k) for k in range(int(chance.integers(3, 16)))])
    for body in bodies:
        size, mass = chance.uniform(0.2, 0.5), 10 ** chance.uniform(-3, 3)
        world.attach([body], fp3.circle(size, density=mass / (math.pi * size**2)) if chance.random() < 0.5 else fp3.box(size, size / 2, density=mass / (2 * size**2)))
    m, about = (column(world.read(name, bodies)) for name in ("mass", "inertia"))

    def energy():
        x, v, w = (world.read(name, bodies) for name in ("x", "v", "w"))
        return m @ ((v**2).sum(1) / 2 + G * x[:, 1]) + about @ column(w) ** 2 / 2
    found = [energy()]
    for _ in range(200):
        world.step()
        found.append(energy())
    return np.array(found) / found[0], world.read("x_y", bodies).min()


def test_heaps_of_light_and_heavy_bodies_make_no_energy(long):
    """Where a body is crushed between others of a million times its mass, too."""
    for number in range(200 if long else 8):
        energies, low = heap(number)
        assert energies.max() < 1.02 and energies[-1] < 0.9 and low > 0, number


@pytest.mark.parametrize("engine", ["isa", "fast"])
def test_stacks_have_the_same_bits_on_each_engine(engine):
    found = []
    for options in ({}, {"engine": engine}):
        world, _ = stack([1, 1, 1000, 2], apart=0.1, **options)
        world.step(3)
        found.append(world.hash)
    assert found[0] == found[1]


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
