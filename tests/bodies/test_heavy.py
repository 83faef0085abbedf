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


ASIDE = 0.5  # rad about y: what lies in a plane is in none of two axes in space


def place(x, y, dimensions):
    return (x, y) if dimensions == 2 else (x * math.cos(ASIDE), y, -x * math.sin(ASIDE))


def turned(angle, dimensions):
    """Words of a body that is turned by an angle, in that plane."""
    c, s, a, b = math.cos(angle / 2), math.sin(angle / 2), math.cos(ASIDE / 2), math.sin(ASIDE / 2)
    return {"angle": angle} if dimensions == 2 else {"q": (c * a, s * b, c * b, s * a)}


def block(half_x, half_y, mass, dimensions, **material):
    """In space as deep as it is wide."""
    sizes = (half_x, half_y, half_x)[:dimensions]
    return fp3.box(*sizes, density=mass / np.prod(2 * np.array(sizes)), **material)


def ball(radius, mass, dimensions, **material):
    volume = math.pi * radius**2 if dimensions == 2 else 4 / 3 * math.pi * radius**3
    return (fp3.circle if dimensions == 2 else fp3.sphere)(radius, density=mass / volume, **material)


def empty(dimensions, gravity=G, **options):
    return fp3.Bodies(dimensions=dimensions, gravity=(0, -gravity, 0)[:dimensions], rest_speed=0.0, **options)


class Tree:
    """Links of 1 kg and 1 m from the origin along an angle, and a disc or a ball at the end."""

    def __init__(self, links, heavy, joint="hinge", turn=-math.pi / 2, dimensions=2, drive=None, **options):
        self.world, self.dimensions = empty(dimensions, bounce=0.0, **options), dimensions
        self.ground = self.world.add(type="static", **turned(0.0, dimensions))
        self.joints, self.bodies, before = [], [], self.ground
        end = (0,) * (dimensions - 1)
        for k in range(links + 1):
            along = k + 0.5 if k < links else links
            body = self.world.add(x=place(along * math.cos(turn), along * math.sin(turn), dimensions), **turned(turn, dimensions))
            self.world.attach(body, fp3.box(0.5, *(0.125,) * (dimensions - 1), density=4.0 ** (dimensions - 1)) if k < links else ball(0.5, heavy, dimensions))
            more = (drive or {}) | ({"axis": (0, 0, 1)} if joint == "hinge" and dimensions == 3 else {})
            self.joints.append(self.world.join(joint, before, body, anchor_a=(0.5 if k else 0, *end), anchor_b=(-0.5 if k < links else 0, *end), **more))
            self.bodies.append(body)
            before = body

    def of(self, name, body=-1):
        return column(self.world.read(name, self.bodies[body]))

    def told(self, name, k):
        return float(column(self.world.read_joint(name, self.joints[k]))[0])

    def pull(self, k):
        return np.array([self.told(name, k) for name in ("force_x", "force_y", "force_z")[:self.dimensions]])


KINDS = [("hinge", 2), ("hinge", 3), ("ball", 3)]


@pytest.mark.parametrize("heavy, substeps", [(1000.0, 4), (1e5, 1), (1e5, 4)])
@pytest.mark.parametrize("joint, dimensions", KINDS)
def test_a_chain_carries_what_hangs_on_it(joint, dimensions, heavy, substeps):
    """And is as long as it was, from the first step on."""
    tree = Tree(20, heavy, joint, dimensions=dimensions, substeps=substeps)
    for steps in (1, 59, 60):
        tree.world.step(steps)
        for k in range(21):
            assert tree.pull(k) == pytest.approx([0, G * (heavy + 20 - k), 0][:dimensions], rel=1e-3, abs=1e-3 * G * heavy)
        assert np.linalg.norm(tree.of("x")) == pytest.approx(20, abs=1e-4)


@pytest.mark.parametrize("links", [3, 35])
@pytest.mark.parametrize("dimensions", [2, 3])
def test_a_chain_carries_as_much_by_hinges_with_all_that_hinges_may_have(dimensions, links):
    """A lock of the point and of the turn, a spring, a motor and both limits: the most rows of a joint."""
    everything = {"hertz": 1.0, "damping": 1.0, "rest": 0.0, "most": 1.0, "limits": (-1.0, 1.0)}
    tree = Tree(links, 1000.0, dimensions=dimensions, drive=everything)
    tree.world.step(60)
    for k in range(links + 1):
        assert tree.pull(k) == pytest.approx([0, G * (1000 + links - k), 0][:dimensions], rel=1e-3, abs=1e-2 * G)


@pytest.mark.parametrize("joint, dimensions", KINDS)
def test_a_chain_that_swings_keeps_its_length_and_its_energy(joint, dimensions):
    tree = Tree(20, 1000.0, joint, turn=1.0 - math.pi / 2, dimensions=dimensions)
    begin = 1000 * G * tree.of("x")[1]
    for _ in range(10):
        tree.world.step(30)
        x, v = tree.of("x"), tree.of("v")
        assert np.linalg.norm(x) == pytest.approx(20, rel=1e-4)
        assert 500 * v @ v + 1000 * G * x[1] == pytest.approx(begin, abs=0.01 * 200000)


@pytest.mark.parametrize("joint, dimensions", KINDS)
def test_a_chain_with_a_heavy_end_is_a_pendulum(joint, dimensions):
    """It is as far on the other side after half a period, of 0.1 rad: 2 pi sqrt(l/g) (1 + 0.1^2/16)."""
    tree = Tree(6, 1000.0, joint, turn=0.1 - math.pi / 2, dimensions=dimensions)
    half = math.pi * math.sqrt(6 / G) * (1 + 0.1**2 / 16)
    tree.world.step(int(half * 60))
    x, v = tree.of("x"), tree.of("v")
    at = x + v * (half - int(half * 60) / 60)
    assert at == pytest.approx(place(-6 * math.sin(0.1), -6 * math.cos(0.1), dimensions), abs=3e-3)
    assert np.linalg.norm(x) == pytest.approx(6, abs=1e-3) and np.linalg.norm(v) < 0.02


@pytest.mark.parametrize("dimensions", [2, 3])
def test_a_beam_of_welds_holds_its_end(dimensions):
    """Of 10 links from a wall, with 1,000 kg 10 m from it: the torque is that of all weights."""
    tree = Tree(10, 1000.0, "weld", turn=0.0, dimensions=dimensions)
    tree.world.step(120)
    torque = sum(G * (k + 0.5) for k in range(10)) + 10 * 1000 * G
    assert tree.of("x") == pytest.approx(place(10, 0, dimensions), abs=2e-3) and np.abs(tree.of("v")).max() < 1e-3
    about = ["torque"] if dimensions == 2 else ["torque_x", "torque_y", "torque_z"]
    assert np.linalg.norm([tree.told(name, 0) for name in about]) == pytest.approx(torque, rel=1e-3)


def arm_with(load, dimensions, **hinge):
    """A light arm of 1 kg and 1 m on a hinge in a wall, and a load that is welded to its end."""
    world, end = empty(dimensions), (0,) * (dimensions - 1)
    arm, far = world.add(x=(0.5, *end)), world.add(x=(1, *end))
    world.attach(arm, fp3.box(0.5, *(0.05,) * (dimensions - 1), density=10.0 ** (dimensions - 1)))
    world.attach(far, ball(0.1, load, dimensions))
    axis = {"axis": (0, 0, 1)} if dimensions == 3 else {}
    joint = world.join("hinge", world.add(type="static"), arm, anchor_b=(-0.5, *end), **axis, **hinge)
    world.join("weld", arm, far, anchor_a=(0.5, *end))

    def told():
        x = column(world.read("x", far))
        assert math.hypot(*x) == pytest.approx(1, abs=2e-3)
        return float(column(world.read_joint("at", joint))[0])
    return world, told


@pytest.mark.parametrize("dimensions", [2, 3])
@pytest.mark.parametrize("load", [10.0, 300.0, 1e4])
def test_a_motor_turns_what_hangs_on_a_light_arm(load, dimensions):
    """Without and with a heavy set; a motor that is too weak lets it fall."""
    for most, holds in ((2 * G * load, True), (0.9 * G * load, False)):
        world, told = arm_with(load, dimensions, speed=0.5, most=most)
        world.step(60)
        assert told() == pytest.approx(0.5, abs=0.02) if holds else told() < -0.3


@pytest.mark.parametrize("dimensions", [2, 3])
def test_springs_and_limits_hold_what_hangs_on_a_light_arm(dimensions):
    """1,000 kg: on a limit, which it does not pass; and on a spring, whose stiffness is that of the arm's inertia."""
    world, told = arm_with(1000.0, dimensions, limits=(-0.3, 0.2))
    world.step(300)
    assert told() == pytest.approx(-0.3, abs=2e-3)
    world, told = arm_with(1000.0, dimensions, hertz=100.0, damping=50.0)
    world.step(300)
    stiffness = 1.01 / 12 * (2 * math.pi * 100) ** 2
    assert -told() * stiffness == pytest.approx((1000 + 0.5) * G * math.cos(told()), rel=2e-3)


def test_what_runs_on_rails_in_space_carries_what_hangs_on_a_rod():
    """A slider of 1 kg, driven at 1 m/s up to its limit; 1,000 kg hang on it, and go there with the motor's help alone."""
    world = empty(3)
    rail, car, load = world.add(type="static"), world.add(), world.add(x=(0, -2, 0))
    world.attach(car, fp3.box(0.1, 0.1, 0.1, density=125.0))
    world.attach(load, ball(0.3, 1000.0, 3))
    line = world.join("slider", rail, car, axis=(1, 0, 0), speed=1.0, most=1e5, limits=(-1.0, 0.5))
    rod = world.join("rod", car, load)
    world.step(240)
    assert column(world.read("x", car)) == pytest.approx([0.5, 0, 0], abs=2e-3)
    assert np.linalg.norm(column(world.read("x", load)) - column(world.read("x", car))) == pytest.approx(2, abs=1e-3)
    force = [np.array([float(column(world.read_joint(name, one))[0]) for name in ("force_x", "force_y", "force_z")]) for one in (line, rod)]
    assert force[0] == pytest.approx(force[1] + [0, G, 0], rel=1e-2, abs=200)
    assert np.linalg.norm(force[1]) > 0.5 * 1000 * G


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


@pytest.mark.parametrize("dimensions", [2, 3])
@pytest.mark.parametrize("heavy", [60.0, 1000.0])
@pytest.mark.parametrize("apart, arm", [(0.01, 0.01), (0.05, 0.02)])
def test_joints_that_contradict_each_other_make_as_much_energy_as_they_may(dimensions, heavy, apart, arm):
    """Two joints pull one light body up at one side and down at the other, so that it would spin fast. A half percent of what the heavy body would have at the speed of
    the pull is what a substep makes (sw/bodies/heavy.c): no more, and no less, else what is apart would stay apart."""
    world, h = empty(dimensions, gravity=0.0, substeps=1), 1 / 60
    bodies = world.add(x=np.zeros((2, dimensions)))
    for body, mass in zip(bodies, (heavy, 1.0)):
        world.attach([body], ball(0.5, mass, dimensions, mask=0))
    for side in (1, -1):
        anchors = (side * arm, side * apart, 0.0)[:dimensions], (side * arm, 0.0, 0.0)[:dimensions]
        world.join("hinge" if dimensions == 2 else "ball", bodies[:1], bodies[1:], anchor_a=anchors[0], anchor_b=anchors[1])
    world.step()  # where bodies are, they have come by the speeds that the pull gave them
    way, masses, inertias = world.read("x", bodies) / h, world.read("mass", bodies), world.read("inertia", bodies).reshape(2, -1)[:, 0]
    turn = world.read("angle", bodies) / h if dimensions == 2 else 2 * np.linalg.norm(world.read("q", bodies)[:, 1:], axis=1) / h
    omega = 2 * math.pi * 60  # a spring of 60 Hz and five times critical damping, over one implicit step
    pull = omega / (10 + h * omega) * apart
    assert masses @ (way**2).sum(1) / 2 + inertias @ turn**2 / 2 == pytest.approx(0.005 * heavy * pull**2 / 2, rel=3e-3)


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


def stack(masses, apart=0.0, x=0.0, dimensions=2, **options):
    """Boxes of 1 m on each other; every other one is aside."""
    world = empty(dimensions, **options)
    world.attach(world.add(type="static", x=(0, -1, 0)[:dimensions]), fp3.box(*(20, 1, 20)[:dimensions]))
    return world, pile(world, masses, apart, x, dimensions)


def pile(world, masses, apart=0.0, x=0.0, dimensions=2):
    boxes = [world.add(x=(x + apart * (k % 2), 0.5 + k, 0)[:dimensions]) for k in range(len(masses))]
    for box, mass in zip(boxes, masses):
        world.attach(box, block(0.5, 0.5, mass, dimensions))
    return boxes


@pytest.mark.parametrize("dimensions, substeps", [(2, 1), (2, 4), (2, 64), (3, 1), (3, 4), pytest.param(3, 64, marks=pytest.mark.long)])
@pytest.mark.parametrize("masses", [(1, 1000), (1, 1, 1, 1, 1000), (1000, 1, 1000), (1, 300, 1, 300, 1, 300), (1, 1e6), (1, 51)])
def test_heavy_boxes_stand_on_light_ones(masses, dimensions, substeps):
    """For 20 s; 10 in space; 5 with many substeps, when they still sink a little. The floor carries the weight."""
    world, boxes = stack(masses, substeps=substeps, dimensions=dimensions)
    world.step((1200 if dimensions == 2 else 600) if substeps < 64 else 300)
    x, v = (np.array([column(world.read(name, box)) for box in boxes]) for name in ("x", "v"))
    sag = 0.5 + np.arange(len(masses)) - x[:, 1]
    assert np.abs(np.delete(x, 1, 1)).max() < 1e-6 and np.abs(v).max() < 1e-4
    assert -1e-5 < sag.min() and sag.max() < (0.006 if substeps > 1 else 0.02)
    floor = [float(one["impulse"]) for one in world.contacts() if min(one["point"][1], one["normal"][1]) < 0.3]
    assert len(floor) == 1 and floor[0] == pytest.approx(sum(masses) * G / 60 / substeps, rel=1e-4 if substeps < 64 else 0.02)


@pytest.mark.parametrize("dimensions", [2, 3])
def test_a_stack_that_is_not_straight_stands_and_one_over_its_edge_falls(dimensions):
    for apart, stands in ((0.4, True), (0.6, False)):
        world, boxes = stack([1, 1000], apart=apart, dimensions=dimensions)
        world.step(300)
        assert (column(world.read("x", boxes[1]))[1] > 1.4) == stands


@pytest.mark.parametrize("dimensions", [2, 3])
def test_a_heavy_box_slides_on_a_light_one_as_friction_has_it(dimensions):
    """1,000 kg at 2 m/s on a plank of 1 kg, which lies on a rough floor: v^2 / (2 mu g), straight on."""
    world = empty(dimensions)
    world.attach(world.add(type="static", x=(0, -1, 0)[:dimensions]), fp3.box(*(20, 1, 20)[:dimensions], friction=1.0))
    plank, box = world.add(x=(0, 0.1, 0)[:dimensions]), world.add(x=(-1, 0.7, 0)[:dimensions], v=place(2.0, 0.0, dimensions))
    world.attach(plank, block(2, 0.1, 1.0, dimensions, friction=1.0))
    world.attach(box, block(0.5, 0.5, 1000.0, dimensions, friction=0.09))
    world.step(120)
    way = column(world.read("x", box)) - (-1, 0.7, 0)[:dimensions]
    assert way == pytest.approx(place(4 / (2 * 0.3 * G), 0.0, dimensions), rel=0.02, abs=2e-3)
    assert np.abs(column(world.read("x", plank)) - (0, 0.1, 0)[:dimensions]).max() < 1e-3


@pytest.mark.parametrize("way", range(8))
def test_a_light_block_under_a_heavy_one_slides_beyond_the_friction_angle(way):
    """In each direction alike, and with what it carries; below that angle both stay."""
    angle = 2 * math.pi * way / 8 + 0.1
    for tangent in (0.58, 0.65):
        down, along = G / math.hypot(1, tangent), np.array([math.cos(angle), 0, math.sin(angle)])
        world = fp3.Bodies(dimensions=3, gravity=down * (tangent * along + [0, -1, 0]), rest_speed=0.0)
        world.attach(world.add(type="static"), fp3.plane())
        low, high = world.add(x=(0, 0.1, 0)), world.add(x=(0, 0.3, 0))
        world.attach(low, block(0.5, 0.1, 1.0, 3))
        world.attach(high, block(0.5, 0.1, 1000.0, 3, friction=0.8))
        world.step(60)
        expected = max(tangent - 0.6, 0) * down / 2
        for body, y in ((low, 0.1), (high, 0.3)):
            assert column(world.read("x", body)) == pytest.approx(expected * along + [0, y, 0], abs=2e-3), tangent


@pytest.mark.parametrize("mass", [15000.0, 1e6])
def test_a_plate_lies_on_four_balls(mass):
    """Of 1 kg each, which do not roll away."""
    world = empty(3)
    world.attach(world.add(type="static"), fp3.plane())
    balls, plate = [world.add(x=(x, 0.3, z)) for x in (-1, 1) for z in (-1, 1)], world.add(x=(0, 0.7, 0))
    for body in balls:
        world.attach(body, ball(0.3, 1.0, 3))
    world.attach(plate, block(1.5, 0.1, mass, 3))
    world.step(300)
    assert column(world.read("x", plate)) == pytest.approx([0, 0.7, 0], abs=1e-3)
    assert [float(one["impulse"]) for one in world.contacts() if one["point"][1] < 0.3] == pytest.approx([(mass / 4 + 1) * G / 240] * 4, rel=1e-3)


def test_a_heavy_box_on_a_light_one_stands_on_triangles():
    world = empty(3)
    corners = [(x, 0, z) for x in (-3, 0.1, 3) for z in (-3, 0.2, 3)]
    cells = [(3 * i + j, 3 * i + j + 1, 3 * i + j + 4, 3 * i + j + 3) for i in range(2) for j in range(2)]
    world.mesh(world.add(type="static"), corners, [t for a, b, c, d in cells for t in ((a, b, c), (a, c, d))])
    boxes = pile(world, [1, 1e4], dimensions=3)
    world.step(300)
    assert [column(world.read("x", box)) for box in boxes] == [pytest.approx([0, 0.5 + k, 0], abs=5e-3) for k in range(2)]


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


def heap(number, dimensions):
    """Boxes and discs or balls of 1 g to 1 t, which fall between walls: energies after each step, over that at first; and who is how far down at last."""
    chance = np.random.default_rng(number)
    world = empty(dimensions)
    walls = ((0, -1, 0, 20, 1, 20), (-4, 5, 0, 1, 20, 20), (4, 5, 0, 1, 20, 20), (0, 5, -4, 20, 20, 1), (0, 5, 4, 20, 20, 1))
    for x, y, z, a, b, c in walls[:2 * dimensions - 1]:
        world.attach(world.add(type="static", x=(x, y, z)[:dimensions]), fp3.box(*(a, b, c)[:dimensions]))
    bodies = world.add(x=[(chance.uniform(-1.5, 1.5), 0.6 + 1.2 * k, 0.5 * (-1) ** k)[:dimensions] for k in range(int(chance.integers(3, 16)))])
    for body in bodies:
        size, mass = chance.uniform(0.2, 0.5), 10 ** chance.uniform(-3, 3)
        world.attach([body], (ball if chance.random() < 0.5 else lambda r, *more: block(r, r / 2 if dimensions == 2 else r, *more))(size, mass, dimensions))
    m, about = (column(world.read(name, bodies)) for name in ("mass", "inertia"))
    spin = "w" if dimensions == 2 else "spin"

    def energy():
        x, v, w = (world.read(name, bodies) for name in ("x", "v", spin))
        return m @ ((v**2).sum(1) / 2 + G * x[:, 1]) + about @ column(w) ** 2 / 2  # in space, cubes: about all axes alike
    found = [energy()]
    for _ in range(200):
        world.step()
        found.append(energy())
    return np.array(found) / found[0], world.read("x_y", bodies).min()


@pytest.mark.parametrize("dimensions", [2, 3])
def test_heaps_of_light_and_heavy_bodies_make_no_energy(dimensions, long):
    """Where a body is crushed between others of a million times its mass, too."""
    for number in range(200 if long else 8 if dimensions == 2 else 3):
        energies, low = heap(number, dimensions)
        assert energies.max() < 1.02 and energies[-1] < 0.9 and low > 0, number


@pytest.mark.parametrize("engine", ["isa", "fast"])
@pytest.mark.parametrize("dimensions", [2, 3])
def test_stacks_have_the_same_bits_on_each_engine(dimensions, engine):
    found = []
    for options in ({}, {"engine": engine}):
        world, _ = stack([1, 1, 1000, 2], apart=0.1, dimensions=dimensions, **options)
        world.step(3)
        found.append(world.hash)
    assert found[0] == found[1]


@pytest.mark.parametrize("kind, dimensions", [*KINDS, ("weld", 2), ("weld", 3)])
def test_what_nothing_holds_keeps_its_momentum(kind, dimensions):
    """A light body between a heavy one and another, thrown and spinning: the centre flies on, the spin stays, and all is as long as it was."""
    world = empty(dimensions, gravity=0.0)
    mass, bodies, spin = np.array([5000.0, 1.0, 20.0]), [], "w" if dimensions == 2 else "spin"
    turning = {"w": 1.0} if dimensions == 2 else {"spin": (0, -0.3, 1.0)}
    for k, m in enumerate(mass):
        bodies.append(world.add(x=(k, 0.0, 0.0)[:dimensions], v=(3.0, k - 1.0, 0.3 * (k - 1))[:dimensions], **turning))
        world.attach(bodies[k], ball(0.4, m, dimensions))
    for a, b in zip(bodies, bodies[1:]):
        axis = {"axis": (0, 0, 1)} if kind == "hinge" and dimensions == 3 else {}
        world.join(kind, a, b, anchor_a=(0.5, 0, 0)[:dimensions], anchor_b=(-0.5, 0, 0)[:dimensions], **axis)

    def sums():
        x, v, w = (np.array([column(world.read(name, body)) for body in bodies]) for name in ("x", "v", spin))
        deep = [np.pad(one, ((0, 0), (0, 3 - one.shape[1]))) for one in (x, v)]
        own = (mass[:, None] * (0.08 if dimensions == 2 else 0.064) * w).sum(0)
        about = mass @ np.cross(*deep)
        return np.array([*(mass @ v), *((about[2:] if dimensions == 2 else about) + own)]), x
    begin, _ = sums()
    world.step(120)
    end, x = sums()
    assert end == pytest.approx(begin, rel=1e-3, abs=1e-6 * np.abs(begin).max()) and np.linalg.norm(x[2] - x[0]) == pytest.approx(2, abs=1e-3)


@pytest.mark.parametrize("dimensions", [2, 3])
def test_a_tree_may_hang_on_what_the_caller_moves_and_not_turn(dimensions):
    """A crane: its hook is at rest, seen from what carries it."""
    world, joint = empty(dimensions), "hinge" if dimensions == 2 else "ball"
    crane = world.add(type="kinematic", v=(0.0, 2.0, 0.0)[:dimensions])
    light = world.add(x=(0, -1, 0)[:dimensions], may_not_turn=True)
    load = world.add(x=(0, -2, 0)[:dimensions])
    world.attach(light, ball(0.1, 0.3, dimensions))
    world.attach(load, ball(0.5, 1600.0, dimensions))
    world.join(joint, crane, light, anchor_b=(0, 1, 0)[:dimensions])
    world.join(joint, light, load, anchor_a=(0, -0.5, 0)[:dimensions], anchor_b=(0, 0.5, 0)[:dimensions])
    world.step(60)
    assert column(world.read("x", load)) == pytest.approx((0, 0, 0)[:dimensions], abs=1e-3)
    assert list(column(world.read("q" if dimensions == 3 else "angle", light))) == ([1, 0, 0, 0] if dimensions == 3 else [0])


@pytest.mark.parametrize("engine", ["isa", "fast", pytest.param("rtl", marks=pytest.mark.long)])
@pytest.mark.parametrize("joint, dimensions", KINDS)
def test_each_engine_has_the_same_bits(joint, dimensions, engine):
    """And a world that went back in time."""
    links, step = (2, 1) if engine == "rtl" else (4, 3)
    own, other = (Tree(links, 800.0, joint, turn=0.2, dimensions=dimensions, **more) for more in ({}, {"engine": engine}))
    for tree in (own, other):
        tree.world.step(step)
    saved = own.world.save()
    own.world.step(step)
    other.world.step(step)
    assert own.world.hash == other.world.hash
    own.world.restore(saved)
    own.world.step(step)
    assert own.world.hash == other.world.hash
