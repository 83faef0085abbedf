"""Rigid bodies in a plane, through Python: what mechanics says of them, who sleeps and wakes, and the same bits by every engine."""

import math
import os
import pathlib
import sys
import time

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("FP3_BUILD", ROOT / "build"))
os.environ["FP3_HOME"] = str(BUILD)
sys.path.insert(0, str(ROOT / "python"))
if BUILD.name != "build" and "libasan" not in os.environ.get("LD_PRELOAD", ""):
    pytest.skip("sanitizers have to be there before Python", allow_module_level=True)

import fp3  # noqa: E402

G = 10.0
BOX, DISC = fp3.box(0.5, 0.5), fp3.circle(0.5)


def floor(gravity=(0, -G), friction=0.6, **options):
    """A world with a floor whose surface is the axis x."""
    world = fp3.Bodies(gravity=gravity, **options)
    ground = world.add(type="static")
    world.attach(ground, fp3.box(500, 1, centre=(0, -1), friction=friction))
    return world, ground


def body(world, shape=BOX, x=(0, 0.5), **how):
    made = world.add(x=x, **how)
    world.attach(made, shape)
    return made


def pyramid(base):
    return np.array([(1.05 * (column - (base - row) / 2 + 0.5), row + 0.5) for row in range(base) for column in range(base - row)])


# ---- one body ----

@pytest.mark.parametrize("angle, friction", [(0.5, 0.0), (0.5, 0.3), (0.5, 0.5), (0.9, 0.9)])
def test_a_block_on_a_slope_above_the_friction_angle(angle, friction):
    """Within 0.3 % of g (sin a - mu cos a), 0.02 m/s^2 where little is left of it."""
    world = fp3.Bodies(gravity=(0, -G), rest_speed=0)
    ground = world.add(type="static", angle=-angle)
    world.attach(ground, fp3.box(500, 1, centre=(0, -1), friction=friction))
    block = body(world, fp3.box(0.5, 0.5, friction=friction), (0.5 * math.sin(angle), 0.5 * math.cos(angle)), angle=-angle)
    speeds = []
    for _ in range(2):
        world.step(60)
        speeds.append(world.read("v", block)[0] @ (math.cos(angle), -math.sin(angle)))
    wanted = G * (math.sin(angle) - friction * math.cos(angle))
    assert abs(speeds[1] - speeds[0] - wanted) < max(0.003 * wanted, 0.02)


def test_a_block_on_a_slope_below_the_friction_angle():
    """It stays where it is after a moment, within 1e-4 m in 10 s, though it may not sleep."""
    angle = 0.5
    world, _ = floor((G * math.sin(angle), -G * math.cos(angle)), rest_speed=0)
    block = body(world)
    world.step(30)
    before = world.read("x", block)
    world.step(600)
    assert abs(world.read("x", block) - before).max() < 1e-4 and abs(before[0, 0]) < 1e-3


def test_braking():
    """v^2 / (2 mu g), within 0.5 %."""
    world, _ = floor(friction=0.5)
    block = body(world, fp3.box(0.5, 0.5, friction=0.5), v=(10, 0))
    world.step(300)
    assert world.read("x_x", block)[0] == pytest.approx(10, rel=0.005)


def test_a_disc_slides_and_then_rolls():
    """At 2/3 of its speed, within 1e-4 of it, and on without a loss; it rolled from v / (3 mu g) on."""
    world, _ = floor(friction=0.4)
    disc = body(world, fp3.circle(0.5, friction=0.4), v=(6, 0))
    world.step(29)                     # 0.483 s of 0.5
    assert world.read("v_x", disc)[0] > 4.02
    world.step(31)
    assert world.read("v_x", disc)[0] == pytest.approx(4, abs=6e-4) and world.read("w", disc)[0] == pytest.approx(-8, abs=1.2e-3)
    world.step(300)
    assert world.read("v_x", disc)[0] == pytest.approx(4, abs=6e-4)


def test_a_disc_down_a_slope():
    """2/3 g sin a, within 0.2 %, as long as friction is above tan a / 3."""
    angle = 0.5
    for friction in (1.05 * math.tan(angle) / 3, 1):
        world, _ = floor((G * math.sin(angle), -G * math.cos(angle)), friction)
        disc = body(world, fp3.circle(0.5, friction=friction))
        world.step(60)
        before = world.read("v_x", disc)[0]
        world.step(60)
        assert world.read("v_x", disc)[0] - before == pytest.approx(2 / 3 * G * math.sin(angle), rel=0.002)


def test_rolling_resistance():
    """A disc that rolls stops after v^2 / (2 a), a = rolling g / (1.5 R), within 1 %."""
    world, _ = floor()
    disc = body(world, fp3.circle(0.5, rolling=0.05), v=(2, 0), w=-4)
    world.step(300)
    assert world.read("x_x", disc)[0] == pytest.approx(4 / (2 * 0.05 * G / 0.75), rel=0.01)


def test_free_fall():
    """A parabola, within 3e-6 of the way."""
    world = fp3.Bodies(gravity=(0, -G))
    body(world, v=(1, 2), w=3)
    light = body(world, x=(5, 0), gravity=0.5)
    world.step(120)
    assert world["x"] == pytest.approx(np.array([[2, 0.5 + 4 - G * 2], [5, -G]]), rel=3e-6)
    assert world["angle"] == pytest.approx([6, 0], abs=1e-5) and world.read("v_y", light)[0] == pytest.approx(-G, rel=1e-5)


def test_damping():
    """exp(-c t) of speed and of spin, within 1 %."""
    world = fp3.Bodies(gravity=(0, 0))
    block = body(world, v=(3, 4), w=5, damping=0.7, spin_damping=1.4)
    world.step(60)
    assert world.read("v", block)[0] == pytest.approx(np.array([3, 4]) * math.exp(-0.7), rel=0.01)
    assert world.read("w", block)[0] == pytest.approx(5 * math.exp(-1.4), rel=0.01)


@pytest.mark.parametrize("restitution, what, h", [(1, "circle", 1 / 60), (0.8, "circle", 1 / 60), (0.8, "box", 1 / 60), (0.5, "circle", 1 / 60), (0.9, "box", 1 / 960)])
def test_bounces(restitution, what, h):
    """Each top, as long as they are above 0.1 m, is within 0.1 % of e^(2n) H, of what lands flat, too. The top follows from place and speed behind it."""
    world, _ = floor(h=h)
    shape = fp3.circle(0.5, restitution=restitution) if what == "circle" else fp3.box(0.5, 0.5, restitution=restitution)
    thing, tops, before = body(world, shape, (0, 4.5)), [], (4.0, 0.0)
    for _ in range(int(7 / h)):
        world.step()
        now = world.read("x_y", thing)[0] - 0.5, world.read("v_y", thing)[0]
        if now[1] <= 0 < before[1]:
            tops.append(now[0] + now[1]**2 / (2 * G))
        before = now
    wanted = 4 * restitution ** (2 * (1 + np.arange(len(tops))))
    count = int((wanted > 0.1).sum())
    assert count >= 2 and tops[:count] == pytest.approx(wanted[:count], rel=0.001)


@pytest.mark.parametrize("lean, falls", [(0.995, False), (1.005, True)])
def test_a_box_tips(lean, falls):
    """Where gravity leans by more than width over height, within 0.5 %."""
    angle = math.atan(0.5 * lean)
    world, _ = floor((G * math.sin(angle), -G * math.cos(angle)), friction=4)
    block = body(world, fp3.box(0.25, 0.5, friction=4), may_not_sleep=True)
    world.step(600)
    assert (abs(world.read("angle", block)[0]) > 0.5) == falls


def test_a_force_acts_in_the_next_step_alone():
    world = fp3.Bodies(gravity=(0, 0))
    block = body(world)
    world.write("force", block, (6, 3))
    world.write("torque", block, 1)
    for _ in range(2):
        world.step()
        assert world.read("v", block)[0] == pytest.approx([0.1, 0.05], rel=1e-5) and world.read("w", block)[0] == pytest.approx(6 / 60, rel=1e-5)
    assert not world.read("force", block).any() and not world.read("torque", block).any()


def test_what_bodies_weigh():
    """Of two shapes together: mass, centre and inertia, within rounding; the origin stays where it was."""
    world = fp3.Bodies(gravity=(0, 0))
    both = world.add(x=(1, 2), angle=math.pi / 2, w=1)
    world.attach(both, fp3.box(1, 0.5, centre=(1, 0)))                # 2 kg
    world.attach(both, fp3.circle(0.5, centre=(-1, 0), density=4))   # pi kg
    mass, disc = 2 + math.pi, math.pi
    centre = (2 - disc) / mass
    inertia = 2 * (4 + 1) / 12 + 2 * (1 - centre) ** 2 + disc * 0.25 / 2 + disc * (1 + centre) ** 2
    assert world["mass"][0] == pytest.approx(mass, rel=1e-6) and world["inertia"][0] == pytest.approx(inertia, rel=1e-6)
    assert world["x"][0] == pytest.approx([1, 2], abs=1e-6)
    assert world["v"][0] == pytest.approx([-centre, 0], abs=1e-6)     # of the centre of mass, which is above the origin


# ---- several ----

def test_the_momentum_of_a_collision():
    """Linear momentum stays within 1e-5 of 3 kg m/s: roundings. Arms are those of the begin of a step, so angular momentum may change by the impulse,
    2.5 kg m/s, times the way in a step, 8 mm. Energy goes by friction alone."""
    world = fp3.Bodies(gravity=(0, 0), h=1 / 480)
    body(world, fp3.circle(0.5, restitution=1), (-3, 0), v=(3, 0))
    body(world, fp3.box(0.5, 0.4, angle=0.3, density=3, restitution=1), (3, 0.3), v=(-1, 0))
    mass, inertia = world["mass"], world["inertia"]

    def totals():
        x, v, w = world["x"], world["v"], world["w"]
        spin = mass * (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]) + inertia * w
        return (mass[:, None] * v).sum(0), spin.sum(), (mass * (v**2).sum(1) + inertia * w**2).sum() / 2
    momentum, spin, energy = totals()
    world.step(1440)
    after = totals()
    assert world["w"].all() and after[0] == pytest.approx(momentum, abs=1e-5) and abs(after[1] - spin) < 0.02
    assert 0.95 * energy < after[2] < energy


def test_two_equal_discs_swap_their_speeds():
    world = fp3.Bodies(gravity=(0, 0))
    discs = world.add(x=[(0, 0), (3, 0)], v=[(2.5, 0), (0, 0)])
    world.attach(discs, fp3.circle(0.5, restitution=1))
    world.step(120)
    assert world.read("v", discs) == pytest.approx(np.array([[0, 0], [2.5, 0]]), abs=1e-5)


def test_a_pyramid_stands_and_sleeps():
    """10 s of base 10: no box is more than 1 cm from its place; after 2 s all sleep, and then no word changes. The floor holds the weight.

    From there a world goes back to when it was awake.
    """
    world, _ = floor()
    places = pyramid(10)
    boxes = world.add(x=places)
    world.attach(boxes, BOX)
    world.step(20)
    moving = world.save()
    world.step(100)
    assert world.awake == 0 and world.touching == 100 and (world.read("at_rest", boxes) == -1).all()
    slept = world.hash
    world.step(480)
    assert world.hash == slept and world.time == 10 and abs(world.read("x", boxes) - places).max() < 0.01 and not world["v"].any()
    world.restore(moving)
    world.step(10)
    assert world.awake == len(boxes) and world["v"].any()
    world.step(90)
    assert world.hash == slept


def test_a_stack_wakes_when_its_support_goes():
    """By removal, by a write, and by a kinematic floor that moves away. Who does not touch it sleeps on."""
    for how in ("remove", "write", "kinematic"):
        world = fp3.Bodies(gravity=(0, -G))
        ground = world.add(type="kinematic" if how == "kinematic" else "static")
        world.attach(ground, fp3.box(5, 1, centre=(0, -1)))
        stack = world.add(x=[(0, 0.5), (0, 1.5), (0, 2.5)])
        world.attach(stack, BOX)
        other = world.add(type="static", x=(50, 0))
        world.attach(other, BOX)
        far = body(world, x=(50, 1))
        world.step(120)
        assert world.awake == 0, how
        if how == "remove":
            world.remove(ground)
        else:
            world.write("v" if how == "kinematic" else "x", ground, (0, -30))
        world.step(30)
        assert world.awake == 3 and (world.read("x_y", stack) < [0, 1, 2]).all() and world.read("at_rest", far)[0] == -1, how


@pytest.mark.parametrize("what", ["written", "added", "attached", "kinematic"])
def test_who_gets_into_a_sleeper_wakes_it(what):
    """A body that never moves by itself, too. One that is near and does not touch wakes nobody."""
    for gap in (-0.2, 0.05):
        world, _ = floor()
        block = body(world)
        wall = world.add(type="static", x=(5, 0.5))
        world.attach(wall, BOX)
        world.step(120)
        assert world.awake == 0
        if what == "written":
            world.write("x", wall, (1.05, 0.5))        # their boxes overlap from here on
            world.step(2)
            assert world.awake == 0
            world.write("x", wall, (1 + gap, 0.5))
        elif what == "attached":
            world.attach(wall, fp3.box(0.5, 0.5, centre=(gap - 4, 0)))
        else:
            world.attach(world.add(type="kinematic" if what == "kinematic" else "static", x=(1 + gap, 0.5)), BOX)
        world.step(30)
        assert world.awake == (gap < 0) and (world.read("x_x", block)[0] < -0.15) == (gap < 0)


def test_each_write_wakes():
    for name, value in {"x": (0, 0.6), "angle": 0.1, "v": (0, 1), "w": 1, "force": (0, 1), "torque": 1, "mass": 2, "inertia": 2}.items():
        world, _ = floor()
        low, high = body(world), body(world, x=(0, 1.5))
        world.step(120)
        before = world.hash
        world.write(name, high, value)
        assert world.hash != before and (world.read("at_rest", [low[0], high[0]]) == 0).all(), name


def test_heavy_on_light():
    """A box of 100 times the mass of the one that carries it stands, 5 cm too low at most."""
    world, _ = floor()
    body(world)
    body(world, fp3.box(0.5, 0.5, density=100), (0, 1.5))
    world.step(600)
    assert world.awake == 0 and world["x"][1:] == pytest.approx(np.array([[0, 0.5], [0, 1.5]]), abs=0.05)


def test_a_chain_takes_a_time_that_is_linear_in_its_corners():
    """0.1 s of processor time for 40,000 corners; if it grew with their square it would be 6 s."""
    world = fp3.Bodies()
    ground, way = world.add(type="static"), np.column_stack([np.linspace(0, -4000, 40000), np.zeros(40000)])
    begin = time.process_time()
    world.chain(ground, way)
    assert time.process_time() - begin < 1.5


@pytest.mark.parametrize("shape", [fp3.box(0.5, 0.5, friction=0.1), fp3.circle(0.5, friction=0.1), fp3.capsule((-0.5, -0.2), (0.5, -0.2), 0.3, friction=0.1)])
def test_nothing_catches_on_a_chain(shape):
    """Over 160 joints what slides comes as far as over none, within 1 cm of 14 m."""
    found = []
    for corners in (2, 161):
        world = fp3.Bodies(gravity=(0, -G))
        world.chain(world.add(type="static"), [(x, 0) for x in np.linspace(40, -40, corners)], friction=0.1)
        slider = body(world, shape, (-20, 0.5), v=(8, 0))
        world.step(120)
        found.append(world.read("x", slider)[0])
    assert found[0] == pytest.approx(found[1], abs=0.01) and found[0][0] > -6.1


def test_a_loop_holds_from_inside_or_outside():
    """Its ground is on the left of its way: clockwise it is a room, which nothing leaves."""
    world = fp3.Bodies(gravity=(0, -G))
    world.chain(world.add(type="static"), [(-3, 0), (-3, 6), (3, 6), (3, 0)], loop=True)
    discs = world.add(x=[(x, y) for x in (-2, 0, 2) for y in (1, 3)], v=(7, 9))
    world.attach(discs, fp3.circle(0.5, restitution=0.9))
    world.step(600)
    assert (abs(world.read("x_x", discs)) < 2.6).all() and (abs(world.read("x_y", discs) - 3) < 2.6).all()


def test_a_belt_and_a_floor_that_moves():
    """What lies on a belt has its speed after v / (mu g); anticlockwise around a box is to the left above it."""
    world = fp3.Bodies(gravity=(0, -G))
    belt, lift = world.add(type="static"), world.add(type="kinematic", x=(0, -10), v=(2, 1))
    world.attach(belt, fp3.box(50, 1, centre=(0, -1), belt=2))
    world.attach(lift, fp3.box(50, 1, centre=(0, -1)))
    on_belt, on_lift = body(world), body(world, x=(0, -9.5))
    crawler = body(world, fp3.box(0.5, 0.5, belt=3), (-5, -9.5), v=(2, 1))          # to the right below it: the floor pushes it to the left
    world.step(60)
    assert world.read("v", crawler)[0] == pytest.approx([-1, 1], abs=1e-3)
    assert world.read("v", on_belt)[0] == pytest.approx([-2, 0], abs=1e-3) and world.read("v", on_lift)[0] == pytest.approx([2, 1], abs=1e-3)
    assert world.read("x", lift)[0] == pytest.approx([2, -9], abs=1e-5)


def test_filters_and_sensors():
    """Shapes collide if each one's mask has the other's category. A sensor counts and does not push."""
    fall = []
    for category, mask, is_sensor in ((1, 1, False), (2, 1, False), (1, 2, False), (3, 5, False), (1, 1, True)):
        world = fp3.Bodies(gravity=(0, -G))
        world.attach(world.add(type="static"), fp3.box(50, 1, centre=(0, -1), mask=1))
        block = body(world, fp3.box(0.5, 0.5, category=category, mask=mask, is_sensor=is_sensor))
        world.step(3)
        touching = world.touching
        world.step(57)
        fall.append((bool(world.read("x_y", block)[0] < -4), touching))
    assert fall == [(False, 1), (True, 0), (True, 0), (False, 1), (True, 1)]


@pytest.mark.parametrize("speed", [20, 430])
def test_who_is_fast_stops_at_a_wall(speed):
    """Of 0.1 m: if it is ground all do, if it may move others pass."""
    for kind in ("static", "dynamic"):
        world = fp3.Bodies(gravity=(0, 0))
        body(world, fp3.box(0.05, 3, density=1e9), (9.845, 0), type=kind)
        fast, other = body(world, fp3.circle(0.1), (0, 1), v=(speed, 0), is_fast=True), body(world, fp3.circle(0.1), (0, -1), v=(speed, 0))
        world.step(120)
        x, y = world.read("x_x", fast)[0], world.read("x_x", other)[0]
        assert x == pytest.approx(9.695, abs=1e-3)
        assert y == pytest.approx(9.695, abs=1e-3) if kind == "static" else y > 20


def test_who_spins_and_is_fast_is_not_thrown_where_it_hits():
    """A disc of 1 cm at 20 m/s that spins by 10 rad/s: friction takes it along by a third of that, not by its way in a step times it."""
    world, _ = floor(rest_speed=0)
    disc = body(world, fp3.circle(0.01), (0, 1.013), v=(0, -20), w=-10, is_fast=True)
    world.step(30)
    assert world.read("v_x", disc)[0] == pytest.approx(10 * 0.01 / 3, rel=0.02)


def test_a_grid_of_pins_and_a_row_of_welds_come_to_rest():
    """Springs that hold must not make energy: softer ones do not."""
    world = fp3.Bodies(gravity=(0, -G), rest_speed=0)
    wall, side = world.add(type="static"), 12
    discs = world.add(x=[(column, -row) for row in range(side) for column in range(side)]).reshape(side, side)
    world.attach(discs.ravel(), fp3.circle(0.4))
    for column in range(side):
        world.join("hinge", wall, discs[0, column:column + 1], anchor_a=(column, 0))
    world.join("hinge", discs[:, :-1].ravel(), discs[:, 1:].ravel(), anchor_a=(0.5, 0), anchor_b=(-0.5, 0))
    world.join("hinge", discs[:-1].ravel(), discs[1:].ravel(), anchor_a=(0, -0.5), anchor_b=(0, 0.5))
    row = world.add(x=[(101 + i, 0) for i in range(4)])
    world.attach(row, fp3.box(0.5, 0.2))
    world.join("weld", wall, row[:1], anchor_a=(100.5, 0), anchor_b=(-0.5, 0))
    world.join("weld", row[:-1], row[1:], anchor_a=(0.5, 0), anchor_b=(-0.5, 0))
    world.step(600)
    assert np.abs(world["v"]).max() < 0.02


def test_who_may_not_turn_or_sleep():
    world, _ = floor()
    stiff = body(world, x=(0, 3), angle=0.3, may_not_turn=True)
    body(world, x=(5, 0.5), may_not_sleep=True)
    world.step(180)
    assert world.read("angle", stiff)[0] == 0.3 and world.awake == 1 and world.read("inertia", stiff)[0] == 0


# ---- bits ----

def mixed(steps, **options):
    """Each kind of shape, tumbling into a heap with a chain below and a paddle that turns in it."""
    world = fp3.Bodies(gravity=(0, -G), **options)
    world.chain(world.add(type="static"), [(5, 6), (4, 0), (0, -0.5), (-4, 0), (-5, 6)])
    paddle = world.add(type="kinematic", x=(1, 1), w=2)
    world.attach(paddle, fp3.box(1.5, 0.1, radius=0.05))
    places = [(0.9 * (k % 4) - 1.6 + 0.1 * (k // 4), 2.5 + k // 4) for k in range(12)]
    made = world.add(x=places, angle=0.3 * np.arange(12))
    for k, shape in enumerate((fp3.box(0.4, 0.3, restitution=0.3), fp3.circle(0.4, rolling=0.02), fp3.capsule((-0.3, 0), (0.3, 0.1), 0.2, density=5),
                               fp3.polygon([(0, 0.5), (-0.4, -0.3), (0.5, -0.2)], belt=0.5))):
        world.attach(made[k::4], shape)
    world.step(steps)
    return world.hash, world


def test_engines_have_the_same_bits():
    """Laws that are built in, and their programs by isa and fast."""
    wanted, world = mixed(40)
    assert world.touching > 4 and {mixed(40, engine=engine)[0] for engine in ("isa", "fast")} == {wanted}


def test_hardware_has_the_same_bits():
    """Two boxes that fall on each other, three steps."""
    found = set()
    for engine in (None, "rtl"):
        world = fp3.Bodies(gravity=(0, -G), substeps=2, engine=engine)
        body(world, x=(0, 0), v=(0, 2), w=1)
        body(world, x=(0.3, 1.0), v=(0, -2))
        world.step(3)
        assert world.touching == 1
        found.add(world.hash)
    assert len(found) == 1


def test_lesser_processors_have_the_same_bits(monkeypatch):
    wanted = mixed(240)[0]
    monkeypatch.setenv("FP3_FAST", "x86-64" if os.uname().machine == "x86_64" else "armv8-a" if os.uname().machine == "aarch64" else "rv64gc")
    assert mixed(240)[0] == wanted
    monkeypatch.setenv("FP3_FAST", "z80")
    with pytest.raises(fp3.ArgumentError, match="FP3_FAST: found 'z80'"):
        fp3.Bodies()


def test_steps_in_parts_and_other_numbers_of_shapes_change_no_bit():
    """One step at a time is as all at once. What lies far away, and what came and went, is not seen."""
    wanted, world = mixed(90)
    parts = mixed(0)[1]
    for _ in range(90):
        parts.step()
    assert parts.hash == wanted
    gone = mixed(0)[1]
    more = gone.add(x=np.arange(40.0).reshape(20, 2) + 1000)
    gone.attach(more, DISC)
    gone.step(0)
    gone.remove(more)
    gone.step(90)
    assert gone.hash == wanted and np.array_equal(gone["x"], world["x"])


def test_units_of_another_size_scale_exactly():
    """Eight times as large, with `size` 8: each position is eight times as far, to the last bit, also where things bounce, overlap and sleep."""
    found = []
    for s in (1, 8):
        world = fp3.Bodies(gravity=(0, -8 * s), size=s)
        world.attach(world.add(type="static"), fp3.box(50 * s, s, centre=(0, -s)))
        made = world.add(x=[(0, 2 * s), (0.25 * s, 2.5 * s), (s, 5 * s)], angle=0.3)
        world.attach(made, fp3.box(0.5 * s, 0.5 * s, density=1 / s**2, restitution=0.25))
        for steps in (10, 290):
            world.step(steps)
            found.append((world["x"] / s, world.awake))
    assert np.array_equal(found[0][0], found[2][0]) and np.array_equal(found[1][0], found[3][0]) and found[1][1] == found[3][1] == 0


# ---- what goes wrong ----

def test_a_body_that_fails_is_named_and_may_be_mended():
    """All others go on. Once its mass is right again, nothing is left of it in its contacts."""
    world, _ = floor()
    low, high, far = body(world), body(world, x=(0, 1.5)), body(world, x=(5, 3))
    world.step(5)
    world.write("mass", low, 1e-36)
    world.write("force", low, (1e12, 0))
    before = world.read("x_y", far)[0]
    with pytest.raises(fp3.FailedError, match="body 1 in step 6"):
        world.step(3)
    assert world.read("x_y", far)[0] < before - 0.03 and np.isfinite(world["x"]).all() and world.time == 8 / 60
    world.write("mass", low, 1)
    world.write("force", low, (0, 0))
    world.step(300)
    assert world.read("x", [low[0], high[0]]) == pytest.approx(np.array([[0, 0.5], [0, 1.5]]), abs=0.02)


@pytest.mark.parametrize("shape", [BOX, fp3.box(1, 0.1), DISC, fp3.box(0.5, 0.3, radius=0.2)])
def test_a_fast_spin_gains_no_energy(shape):
    """On a floor, of up to 50 rad in a substep: energy is never above what it was, within 1 %."""
    for substeps, spin in ((1, 300), (2, 1000), (4, 300), (4, -3000)):
        world, _ = floor(substeps=substeps)
        spinner = body(world, shape, (0, 0.9), w=spin)
        mass, inertia = world.read("mass", spinner)[0], world.read("inertia", spinner)[0]
        most = 1.01 * (inertia * spin**2 / 2 + mass * G * 0.9)
        for _ in range(60):
            world.step()
            v, w = world.read("v", spinner)[0], world.read("w", spinner)[0]
            assert (mass * v @ v + inertia * w * w) / 2 + mass * G * world.read("x_y", spinner)[0] <= most


def test_fast_spins_and_far_places_stay_numbers():
    world = fp3.Bodies(gravity=(0, 0))
    made = world.add(x=[(1e12, -1e12), (-1e12, -1e12), (0, 0)], v=[(1e12, 0), (0, 0), (1, 1)], w=[1e12, -1e12, 300])
    world.attach(made, fp3.box(0.5, 0.5, centre=(1, 0)))
    world.step(60)
    assert np.isfinite(world["x"]).all() and np.isfinite(world["angle"]).all()
    assert abs(world.read("v", made[2:]) - [1, 301]).max() < 1e-3          # 300 turns around the centre of mass, 1 m from the origin
    centre = world.read("x", made[2:])[0] + [math.cos(300), math.sin(300)]
    assert centre == pytest.approx([2, 301], abs=1e-2)


def test_handles_and_values_that_are_refused():
    """One that was removed, one of a body that has its number now, none, one twice: with nothing changed."""
    world, ground = floor()
    old, block = body(world), body(world, x=(3, 0.5))
    world.remove(old)
    new = body(world, x=(-3, 0.5))
    world.step(5)
    assert new[0] != old[0] and int(new[0]) % 2**32 == int(old[0]) % 2**32
    before, count = world.hash, len(world)
    for wrong in (old[0], 0, 2**64 - 1, int(block[0]) + 1, int(block[0]) + 2**32):
        for use in (lambda h: world.remove(h), lambda h: world.write("x", h, (9, 9)), lambda h: world.read("x", h), lambda h: world.attach(h, BOX)):
            with pytest.raises(fp3.ArgumentError, match="handle 1, [0-9a-f]+: there is no such body"):
                use(np.array([block[0], wrong], np.uint64))
        with pytest.raises(fp3.ArgumentError, match="there is no such body"):
            world.chain(wrong, [(1, 0), (0, 0)])
    with pytest.raises(fp3.ArgumentError, match="handle 1"):
        world.remove(np.array([block[0], block[0]]))
    for name, values in (("x", [(1, 2), (3, math.nan)]), ("mass", [1, 0]), ("mass", [1, 1e-40]), ("inertia", [1, -1]), ("w", [1, 1e13]), ("at_rest", [0, 0])):
        with pytest.raises(fp3.ArgumentError, match=name):
            world.write(name, [block[0], new[0]], values)
    for name in ("v", "w", "force", "torque", "mass"):
        with pytest.raises(fp3.ArgumentError, match=rf"{name}\[1\]"):
            world.write(name, [block[0], ground[0]], (1, 1) if name in ("v", "force") else 1)
    with pytest.raises(fp3.ArgumentError, match="body 2: v"):
        world.add(v=[(0, 0), (1, 1), (0, math.inf), (0, 0)])
    with pytest.raises(fp3.ArgumentError, match="must not be dynamic"):
        world.chain(block, [(1, 0), (0, 0)])
    assert (world.hash, len(world)) == (before, count)
    assert world.handles.tolist() == [ground[0], new[0], block[0]]


# ---- joints, contacts, back in time ----

def test_a_hinge_swings_and_tells_its_force():
    """T = 2 pi sqrt(I/(m g l))/agm(1, cos(angle/2)); the mean of the force's vertical part is the weight."""
    world = fp3.Bodies(gravity=(0, -10), rest_speed=0)
    angle = 1.0
    pivot, bob = world.add(type="static"), world.add(x=(np.sin(angle), -np.cos(angle)), angle=angle)
    world.attach(bob, fp3.circle(0.1))
    joint = world.join("hinge", pivot, bob, anchor_b=(0, 1))
    assert world.joints == 1 and world.is_joined(joint).tolist() == [True]
    times, before, pulls = [], angle, []
    for step in range(20 * 60):
        world.step()
        now = angle + world.read_joint("at", joint)[0]
        pulls.append(world.read_joint("force_y", joint)[0])
        if before > 0 >= now:
            times.append((step + before / (before - now)) / 60)
        before = now
    m, inertia = world.read("mass", bob)[0], world.read("inertia", bob)[0]
    mean = [1.0, np.cos(angle / 2)]
    for _ in range(20):
        mean = [sum(mean) / 2, np.sqrt(mean[0] * mean[1])]
    period = 2 * np.pi * np.sqrt((m + inertia) / (m * 10)) / mean[0]
    assert np.diff(times).mean() == pytest.approx(period, rel=2e-4)
    assert np.mean(pulls) == pytest.approx(m * 10, rel=0.01)
    world.unjoin(joint)
    assert world.joints == 0 and not world.is_joined(joint).any()
    with pytest.raises(fp3.ArgumentError):
        world.read_joint("at", joint)


@pytest.mark.parametrize("type, words, name, expected", [
    ("slider", {"axis": (0, 1), "limits": (-2, 0)}, "at", -2), ("rod", {"limits": (0, 2)}, "at", 2), ("rod", {"hertz": 2.0, "rest": 1.0}, "at", 1 + 10 / (4 * np.pi) ** 2),
    ("wheel", {"axis": (0, 1), "hertz": 2.0, "rest": 0.0}, "at", -10 / (4 * np.pi) ** 2), ("weld", {"anchor_b": (-1, 0)}, "at", 0),
    ("hinge", {"anchor_b": (-1, 0), "limits": (-0.5, 0.5)}, "at", -0.5), ("slider", {"axis": (0, 1), "speed": 0.5, "most": 1e3}, "at", 3)])
def test_joints_hold(type, words, name, expected):
    """Where a body comes to rest that hangs on each joint: at a limit, or where a spring of k = (2 pi f)^2 m carries it."""
    world = fp3.Bodies(gravity=(0, -10), rest_speed=0)
    frame, load = world.add(type="static"), world.add(x=(1, 0) if "anchor_b" in words else (0, 0) if type != "rod" else (0, -1))
    world.attach(load, fp3.circle(0.2))
    joint = world.join(type, frame, load, **words)
    world.step(360)
    assert world.read_joint(name, joint)[0] == pytest.approx(expected, abs=0.01)


def test_a_joint_breaks_and_gears_turn():
    world = fp3.Bodies(gravity=(0, -10), rest_speed=0)
    frame, loads = world.add(type="static"), world.add(x=[[0, -1], [5, -1]])
    world.attach(loads, fp3.circle(0.5))
    weight = world.read("mass", loads)[0] * 10
    joints = [world.join("rod", frame, loads[k], anchor_a=(5 * k, 0), force=weight * (0.9 + 0.4 * k))[0] for k in (0, 1)]
    world.step(60)
    assert world.is_joined(joints).tolist() == [False, True] and world.read("x", loads)[0, 1] < -4
    wheels = world.add(x=[[0, 20], [2, 20]], w=[3, 0], gravity=0.0)
    world.attach(wheels, fp3.circle(0.5))
    world.join("hinge", frame, wheels[0], anchor_a=(0, 20))
    world.join("hinge", frame, wheels[1], anchor_a=(2, 20))
    world.join("gear", wheels[0], wheels[1], ratio=0.5)
    world.step(60)
    w = world.read("w", wheels)
    assert w[1] == pytest.approx(-0.5 * w[0], rel=1e-3) and w[0] == pytest.approx(3 / 1.25, rel=0.01)


def test_contacts_are_told_and_a_world_goes_back():
    world = fp3.Bodies(gravity=(0, -10))
    floor, balls = world.add(type="static", x=(0, -1)), world.add(x=[[0, 2.5], [3, 0.5]])
    world.attach(floor, fp3.box(50, 1))
    world.attach(balls, fp3.circle(0.5, restitution=0.5))
    world.step()
    assert world.changes("began")["body_b"].tolist() == [balls[1]] and len(world.changes("hit")) == 0
    saved, hits = world.save(), []
    for _ in range(100):
        world.step()
        hits += world.changes("hit").tolist()
    assert len(hits) >= 2 and hits[0][1] == balls[0] and hits[0][6] == pytest.approx(np.sqrt(40), rel=0.03)
    assert hits[0][7] == pytest.approx(1.5 * world.read("mass", balls)[0] * np.sqrt(40), rel=0.03)
    after = world.hash
    world.restore(saved)
    world.step(100)
    assert world.hash == after and set(world.contacts()["body_a"]) == {floor[0]}
    world.remove(floor)
    assert balls[1] in world.changes("ended")["body_b"].tolist()
    with pytest.raises(fp3.ArgumentError):
        world.changes("stopped")
    with pytest.raises(fp3.ArgumentError):
        world.restore(None)


def test_rays_casts_overlaps_and_who_is_nearest():
    world = fp3.Bodies()
    bodies = world.add(type="static", x=[[0, 0], [10, 0], [10, 5]], angle=[0, np.pi / 4, 0])
    world.attach(bodies[0], fp3.circle(1))
    world.attach(bodies[1], fp3.box(1, 1))
    world.attach(bodies[2], fp3.capsule((-1, 0), (1, 0), 0.5, category=2))
    hits = world.ray([(-5, 0.6), (5, 0), (10, 8), (0, 0), (5, 3)], [(20, 0), (10, 0), (0, -9), (1, 0), (10, 0)])
    assert hits["body"].tolist() == [bodies[0], bodies[1], bodies[2], bodies[0], 0]
    assert hits["distance"] == pytest.approx([5 - 0.8, 5 - np.sqrt(2), 2.5, 0, np.inf], abs=1e-5)
    assert hits["point"][0] == pytest.approx([-0.8, 0.6], abs=1e-5) and hits["normal"][0] == pytest.approx([-0.8, 0.6], abs=1e-5)
    assert world.ray((10, 8), (0, -9), mask=1)["distance"] == pytest.approx([8 - np.sqrt(2)], abs=1e-5)
    cast = world.cast(fp3.circle(0.5), (-5, 0), (20, 0))
    assert cast["body"] == bodies[0] and cast["distance"][0] == pytest.approx(3.5, abs=1.1e-3)
    assert world.cast(fp3.box(0.1, 0.1), (0, 3), (3, 0))["body"] == 0
    over = world.overlap(fp3.box(6, 1), (5, 0))
    assert over["body"].tolist() == bodies[:2].tolist() and (over["distance"] < 0).all()
    assert len(world.overlap(fp3.circle(0.5), (5, 0))) == 0
    near = world.nearest([(0, 3), (10, 2.5), (0.5, 0)])
    assert near["body"].tolist() == [bodies[0], bodies[1], bodies[0]] and near["distance"] == pytest.approx([2, 2.5 - np.sqrt(2), -0.5], abs=1e-5)
    assert near["normal"][0] == pytest.approx([0, 1], abs=1e-6) and near["point"][1] == pytest.approx([10, np.sqrt(2)], abs=1e-5)
    for wrong in (lambda: world.ray((0, np.nan), (1, 0)), lambda: world.nearest((2e9, 0)), lambda: world.cast(3, (0, 0), (1, 0)), lambda: world.overlap(fp3.circle(1), (0, np.inf))):
        with pytest.raises(fp3.ArgumentError):
            wrong()


def test_questions_follow_bodies_and_agree_with_a_search():
    """Of 200 bodies by chance, after steps, far from the origin: the nearest of all discs, by their places."""
    rng, far = np.random.default_rng(3), np.array([1e5, -2e5])
    world = fp3.Bodies(gravity=(0, 0))
    x = rng.uniform(-20, 20, (200, 2))
    balls = world.add(x=far + x, v=rng.uniform(-3, 3, (200, 2)))
    world.attach(balls, fp3.circle(0.3))
    world.step(30)
    now, points = world.read("x", balls) - far, rng.uniform(-20, 20, (50, 2))
    apart = np.linalg.norm(now[None] - points[:, None], axis=2) - 0.3
    near = world.nearest(far + points)
    assert near["distance"] == pytest.approx(apart.min(1), abs=1e-4) and (near["body"] == balls[apart.argmin(1)]).mean() > 0.97


def test_changes_are_those_of_all_steps_of_a_call():
    """However many calls of the library a long step() takes, and with what the caller has ended before."""
    def run(how):
        world, ground = floor()
        balls = world.add(x=np.stack([np.arange(8) * 2.0, 1 + np.arange(8)], 1))
        world.attach(balls, fp3.circle(0.5, restitution=0.7))
        world.remove(balls[0])
        return how(world)
    def single(world):
        found = {"began": [], "ended": [], "hit": []}
        for _ in range(300):
            world.step()
            for change in found:
                found[change] += world.changes(change)["body_b"].tolist()
        return found
    def whole(world):
        world.step(300)
        return {change: world.changes(change)["body_b"].tolist() for change in ("began", "ended", "hit")}
    assert run(single) == run(whole) and len(run(whole)["hit"]) > 20


def test_a_lift_keeps_its_load_awake_and_a_ball_bounces_on_it():
    world = fp3.Bodies(gravity=(0, -10))
    lift = world.add(type="kinematic", x=(0, -1), v=(0, 0.02))
    load = world.add(x=(0, 0.5))
    hook, lamp = world.add(type="kinematic", x=(10, 0), v=(0.02, 0)), world.add(x=(10, -1))
    world.attach(lift, fp3.box(5, 1))
    world.attach(load, fp3.box(0.5, 0.5))
    world.attach(lamp, fp3.circle(0.2))
    world.join("rod", hook, lamp)
    world.step(600)
    assert world.read("x", load)[0, 1] == pytest.approx(0.7, abs=1e-3) and world.awake == 2
    assert world.read("x", lamp)[0, 0] == pytest.approx(10.2, abs=0.01)


def test_it_is_enough_if_the_floor_bounces():
    world = fp3.Bodies(gravity=(0, -10), bounce=0)
    for type, x in (("static", 0), ("kinematic", 20)):
        ground, ball = world.add(type=type, x=(x, -1)), world.add(x=(x, 4.5))
        world.attach(ground, fp3.box(5, 1, restitution=0.8))
        world.attach(ball, fp3.circle(0.5))
        highest = 0
        for step in range(120):
            world.step()
            highest = max(highest, world.read("x_y", ball)[0] - 0.5) if step > 60 else 0
        assert highest == pytest.approx(0.64 * 4, rel=2e-3)


def test_a_weld_with_a_spring_bends_where_it_is_held():
    """g m l/2 over the angle is (2 pi f)^2 times the inertia about the joint, for a board that its weight bends a little."""
    world = fp3.Bodies(gravity=(0, -10), rest_speed=0)
    wall, board = world.add(type="static"), world.add(x=(1, 0))
    world.attach(board, fp3.box(1, 0.05))
    joint = world.join("weld", wall, board, anchor_b=(-1, 0), hertz=3.0, damping=1.0)
    world.step(600)
    mass, inertia = world.read("mass", board)[0], world.read("inertia", board)[0]
    angle = world.read("angle", board)[0]
    assert -0.2 < angle < -0.01 and world.read("x", board)[0] == pytest.approx([np.cos(angle), np.sin(angle)], abs=2e-3)
    assert angle == pytest.approx(-mass * 10 * np.cos(angle) / ((2 * np.pi * 3) ** 2 * inertia), rel=0.05)
    assert world.read_joint("torque", joint)[0] == pytest.approx(mass * 10 * np.cos(angle), rel=0.02)


def test_what_may_not_turn_does_not_and_other_worlds_states_are_refused(tmp_path):
    world, _ = floor()
    post = world.add(x=(0, 2), w=3, may_not_turn=True)
    world.attach(post, fp3.box(0.2, 0.5))
    for name in ("w", "inertia"):
        with pytest.raises(fp3.ArgumentError):
            world.write(name, post, 1.0)
    world.step(60)
    assert world.read("angle", post)[0] == 0
    with pytest.raises(fp3.ArgumentError):
        fp3.Bodies().restore(world.save())
    with pytest.raises(fp3.ArgumentError):
        fp3.Bodies(engine="isa", laws=str(tmp_path))
    sleepy = fp3.Bodies(rest_time=0)
    falling = sleepy.add()
    sleepy.step(10)
    assert sleepy.read("v_y", falling)[0] < -1


@pytest.mark.parametrize("dimensions", [2, 3])
def test_pairs_of_few_that_leave_their_boxes_are_those_that_all_find(dimensions):
    """A rain onto a heap, of which few leave their boxes in a step, has the bits that it has while hundreds fly far away, after all others."""
    def run(many):
        random, up = np.random.default_rng(3), np.eye(dimensions)[1]
        world = fp3.Bodies(dimensions=dimensions)
        ground, mover = world.add(type="static", x=-0.5 * up), world.add(type="kinematic", x=1.2 * up, v=np.eye(dimensions)[0] * 2)
        world.attach(ground, fp3.box(*(20, 0.5, 20)[:dimensions]))
        world.attach(mover, fp3.box(*(4, 0.3, 4)[:dimensions]))
        drops = world.add(x=random.uniform(-3, 3, (60, dimensions)) * (1 - up) + np.outer(2 + 0.9 * np.arange(60), up))
        for k, drop in enumerate(drops):
            world.attach(drop, fp3.box(*(0.4, 0.3, 0.4)[:dimensions]) if k % 2 else fp3.circle(0.3) if dimensions == 2 else fp3.sphere(0.3))
        world.join("rod", drops[0], drops[1])
        if many:
            far = world.add(x=np.column_stack([np.full(200, 1e4), *([3.0 * np.arange(200)] * (dimensions - 1))]), v=100 * up)
            world.attach(far, fp3.circle(0.3) if dimensions == 2 else fp3.sphere(0.3))
        told = []
        for _ in range(90):
            world.step()
            told.append((world.read("x", drops).tobytes(), world.read("v", drops).tobytes(), world.changes("began")["body_b"].tolist()))
        return told, world.touching
    few, touching = run(0)
    assert run(1) == (few, touching) and touching > 5


def test_joints_have_the_bits_of_the_hardware():
    """One step of each law of joints, with a contact beside them."""
    def run(engine):
        world = fp3.Bodies(gravity=(0, -10), engine=engine, substeps=1)
        frame, loads = world.add(type="static", x=(0, -1)), world.add(x=[[0, 0.5], [3, 2], [6, 2], [9, 2]], v=(0.5, -0.5), w=0.5)
        world.attach(frame, fp3.box(20, 1))
        world.attach(loads, fp3.box(0.5, 0.5))
        world.join("rod", frame, loads[1], anchor_a=(3, 5), hertz=3.0)
        world.join("hinge", loads[1], loads[2], anchor_a=(1.5, 0), anchor_b=(-1.5, 0), limits=(-0.1, 0.1))
        world.join("slider", frame, loads[3], anchor_a=(9, 3), axis=(0.1, 1), speed=1.0, most=50.0)
        world.step(2)
        return world.hash, world["x"].tobytes()
    assert run("rtl") == run("isa") == run(None) and np.isfinite(np.frombuffer(run(None)[1])).all()
