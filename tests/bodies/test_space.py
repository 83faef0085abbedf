"""Rigid bodies in space: what theory says of them, and the same bits everywhere."""

import os
import pathlib
import re
import sys

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("FP3_BUILD", ROOT / "build"))
os.environ["FP3_HOME"] = str(BUILD)
sys.path.insert(0, str(ROOT / "python"))
if BUILD.name != "build" and "libasan" not in os.environ.get("LD_PRELOAD", ""):
    pytest.skip("sanitizers have to be there before Python", allow_module_level=True)

import fp3  # noqa: E402

UP = (0.0, -10.0, 0.0)


def world(gravity=UP, **options):
    made = fp3.Bodies(dimensions=3, gravity=gravity, **options)
    return made


def ground(made, **material):
    body = made.add(type="static")
    made.attach(body, fp3.plane(**material))
    return body


def turned(q, v):
    w, p = q[..., :1], q[..., 1:]
    x = 2 * np.cross(p, v)
    return v + w * x + np.cross(p, x)


# ---- theory ----

@pytest.mark.parametrize("e", [0.2, 0.6, 1.0])
def test_what_falls_flat_bounces_to_e_squared_of_its_height(e):
    made = world(bounce=0, rest_speed=0)
    ground(made, restitution=e)
    bodies = made.add(x=[(0, 5.5, 0), (4, 5.5, 0)])
    made.attach(bodies[:1], fp3.sphere(0.5))
    made.attach(bodies[1:], fp3.box(0.5, 0.5, 0.5))
    y = []
    for _ in range(150):
        made.step()
        y.append(made.read("x_y", bodies) - 0.5)
    y = np.array(y)
    for of in y.T:
        top = next(b for a, b, c in zip(of, of[1:], of[2:]) if a < b >= c)
        assert top == pytest.approx(5 * e * e, rel=2e-3)


def test_the_last_ball_of_a_cradle_leaves_alone():
    made = world(gravity=(0, 0, 0), bounce=0, rest_speed=0)
    balls = made.add(x=[(i, 0, 0) for i in range(5)] + [(-3, 0, 0)], v=[(0, 0, 0)] * 5 + [(3, 0, 0)])
    made.attach(balls, fp3.sphere(0.5, restitution=1, friction=0))
    made.step(120)
    assert np.allclose(made.read("v_x", balls), [0, 0, 0, 0, 3, 0], atol=1e-5)


def test_friction_is_the_same_in_all_directions():
    made = world(rest_speed=0)
    ground(made, friction=0.5)
    way = np.arange(8) * np.pi / 4 + 0.1
    out = np.stack([np.cos(way), 0 * way, np.sin(way)], 1)
    boxes = made.add(x=20 * out + (0, 0.5, 0), v=5 * out)
    made.attach(boxes, fp3.box(0.5, 0.5, 0.5, friction=0.5))
    before = made.read("x", boxes)
    made.step(120)
    slid = np.linalg.norm(made.read("x", boxes) - before, axis=1)
    assert np.all(np.abs(slid - 2.5) < 0.013) and np.ptp(slid) < 1e-4


def test_a_sphere_that_slid_rolls():
    made = world(rest_speed=0)
    ground(made)
    ball = made.add(x=(0, 0.5, 0), v=(6, 0, 0))
    made.attach(ball, fp3.sphere(0.5))
    made.step(120)
    assert made.read("v_x", ball)[0] == pytest.approx(6 * 5 / 7, rel=1e-4)
    assert made.read("spin", ball)[0, 2] == pytest.approx(-2 * 6 * 5 / 7, rel=1e-4)


def test_a_belt_takes_what_lies_on_it_along():
    made = world(rest_speed=0)
    ground(made, surface=(1, 0, 2))
    box = made.add(x=(0, 0.5, 0))
    made.attach(box, fp3.box(0.5, 0.5, 0.5))
    made.step(120)
    assert np.allclose(made.read("v", box), [[1, 0, 2]], atol=1e-4)


def test_rolling_resistance_stops_a_ball():
    """By the torque reach m g about the contact: 5/7 of reach g/r is its deceleration."""
    made = world(rest_speed=0)
    ground(made, rolling=0.05)
    ball = made.add(x=(0, 0.5, 0), v=(3, 0, 0), spin=(0, 0, -6))
    made.attach(ball, fp3.sphere(0.5))
    made.step(60)
    assert made.read("v_x", ball)[0] == pytest.approx(3 - 5 / 7 * 0.05 * 10 / 0.5, rel=0.01)
    made.step(240)
    assert abs(made.read("v_x", ball)[0]) < 1e-5


def test_a_free_top_keeps_its_energy_and_its_angular_momentum():
    """About the axis of the middle moment it flips again and again (Dzhanibekov)."""
    made = world(gravity=(0, 0, 0), rest_speed=0)
    top = made.add(spin=(0.01, 2, 0.01))
    made.attach(top, fp3.box(0.3, 0.5, 1.0))
    about = made.read("inertia", top)[0]
    axes = np.array([1 / 3 * 4, 1 / 3 * 4.36, 1 / 3 * 1.36])  # over the mass 1.2 / 4: by the sides
    assert sorted(about) == pytest.approx(sorted(1.2 * np.array([0.5**2 + 1, 0.3**2 + 1, 0.3**2 + 0.5**2]) / 3), rel=1e-6) and axes.size == 3

    def kept():
        q, w = made.read("q", top)[0], made.read("spin", top)[0]
        own = turned(q * (1, -1, -1, -1), w)
        of = 1.2 * np.array([0.5**2 + 1, 0.3**2 + 1, 0.3**2 + 0.5**2]) / 3 * own
        return own @ of / 2, turned(q, of), own[1]
    energy, momentum, _ = kept()
    middle = []
    for _ in range(600):
        made.step(2)
        middle.append(kept()[2])
    flips = np.sum(np.diff(np.sign(middle)) != 0)
    after = kept()
    assert flips >= 2
    assert after[0] == pytest.approx(energy, rel=1e-5) and np.linalg.norm(after[1] - momentum) < 1e-5 * np.linalg.norm(momentum)


# ---- standing, sleeping ----

def test_a_wall_of_bricks_stands_and_sleeps():
    made = world()
    floor = ground(made)
    rows = [(i + (0.5 if j % 2 else 0.0), 0.25 + 0.5 * j, 0.0) for j in range(8) for i in range(12 - j % 2)]
    bricks = made.add(x=rows)
    made.attach(bricks, fp3.box(0.5, 0.25, 0.25))
    made.step(240)
    assert made.awake == 0 and np.abs(made.read("x", bricks) - rows).max() < 0.02
    made.remove(floor)
    made.step()
    assert made.awake == len(bricks)


def test_a_high_wall_of_one_brick_stands():
    """4 m high and 0.2 m thick. It buckles if arms follow each lean, and waves if friction acts while overlaps are pushed apart."""
    made, wide = world(rest_speed=0), 50
    made.attach(made.add(type="static"), fp3.box(50, 1, 5, centre=(0, -1, 0)))
    edge = 0.2 * wide
    courses = [[(0.2, 0.4 * k + 0.2 - edge) for k in range(wide)], [(0.1, 0.1 - edge), *((0.2, 0.4 * k + 0.4 - edge) for k in range(wide - 1)), (0.1, edge - 0.1)]]
    at = [(half, (x, 0.2 * row + 0.1, 0)) for row in range(20) for half, x in courses[row % 2]]
    bricks = made.add(x=[x for _, x in at])
    for brick, (half, _) in zip(bricks, at):
        made.attach([brick], fp3.box(half, 0.1, 0.1, density=1000))
    made.step(300)
    before = made.read("x", bricks)
    made.step(60)
    assert np.abs(before - [x for _, x in at]).max() < 0.07 and np.abs(made.read("x", bricks) - before).max() < 5e-3
    assert np.abs(made.read("v", bricks)).max() < 0.02


def test_ground_of_triangles_and_of_heights_carries():
    made = world(gravity=(0, 0, -10))
    place = made.add(type="static", x=[(-10, -10, 0), (100, 0, 0)])
    x, y = np.meshgrid(np.arange(21), np.arange(21))
    made.heights(place[:1], 1.0, 1.0, 0.02 * ((x - 10) ** 2 + (y - 10) ** 2))
    made.mesh(place[1:], [(-5, -5, 0), (5, -5, 0), (5, 5, 0), (-5, 5, 0)], [(0, 1, 2), (0, 2, 3)])
    bodies = made.add(x=[(2, 1, 2), (100, 0, 1), (100.3, 0.2, 2.5)])
    made.attach(bodies[:1], fp3.sphere(0.5, rolling=0.03))
    made.attach(bodies[1:], fp3.box(0.5, 0.5, 0.5))
    made.step(400)
    x = made.read("x", bodies)
    assert np.all(np.abs(x[0, :2]) < 1.5) and np.all(made.read("at_rest", bodies[1:]) == -1)
    assert x[1:, 2] == pytest.approx([0.5, 1.5], abs=0.01)


def test_compound_bodies_have_their_centre():
    made = world(gravity=(0, 0, 0))
    hammer = made.add(spin=(0, 0, 1))
    made.attach(hammer, fp3.box(1, 0.1, 0.1))
    made.attach(hammer, fp3.box(0.2, 0.5, 0.2, centre=(1.2, 0, 0), density=5))
    assert made.read("mass", hammer)[0] == pytest.approx(0.08 + 5 * 0.16, rel=1e-6)
    v = made.read("v", hammer)[0]
    made.step(30)
    assert np.allclose(made.read("v", hammer)[0], v, atol=1e-6)  # it turns about its centre of mass, which goes straight on


# ---- the same bits ----

def scene(engine=None, columns=True, count=24, **options):
    rng = np.random.default_rng(5)
    made = world(engine=engine, **options)
    ground(made, rolling=0.01)
    lift = made.add(type="kinematic", x=(3, 0, 0), spin=(0, 1, 0))
    made.attach(lift, fp3.box(1, 0.5, 0.2))
    shapes = [fp3.box(0.5, 0.3, 0.4), fp3.sphere(0.4, rolling=0.02), fp3.capsule((-0.4, 0, 0), (0.4, 0, 0), 0.2),
              fp3.hull(rng.normal(size=(12, 3)) * 0.4, restitution=0.3)]
    x = np.column_stack([rng.uniform(-1, 3, count), 1 + 0.15 * np.arange(count), rng.uniform(-1, 1, count)])
    q, spin = rng.normal(size=(count, 4)), rng.normal(size=(count, 3))
    bodies = made.add(x=x, q=q, spin=spin) if columns else np.concatenate([made.add(x=x[i], q=q[i], spin=spin[i]) for i in range(count)])
    for i, body in enumerate(bodies):
        made.attach([body], shapes[i % 4])
    return made


def test_each_engine_has_the_same_bits():
    built_in = scene()
    built_in.step(15)
    for made in (scene("isa"), scene("fast"), scene(columns=False)):
        made.step(15)
        assert made.hash == built_in.hash


def test_hardware_has_the_same_bits():
    built_in, rtl = scene(count=8, substeps=1), scene("rtl", count=8, substeps=1)
    for made in (built_in, rtl):
        made.step(3)
    assert built_in.hash == rtl.hash and built_in.touching >= 3


def test_a_world_goes_back_with_the_same_bits():
    made = scene()
    made.step(40)
    saved = made.save()
    made.step(40)
    after = made.hash
    made.remove(made.handles[5:9])
    made.attach(made.add(x=(0, 9, 0)), fp3.sphere(0.3))
    made.step(5)
    made.restore(saved)
    made.step(20)
    assert made.save(saved) is saved
    made.step(20)
    assert made.hash == after
    made.restore(saved)
    made.step(20)
    assert made.hash == after
    for wrong in (scene().save(), 1):
        with pytest.raises(fp3.ArgumentError, match="into: found"):
            made.save(wrong)


@pytest.mark.parametrize("shape", [fp3.box(0.4, 0.3, 0.5), fp3.capsule((-0.3, 0, 0), (0.3, 0, 0), 0.2)], ids=["boxes", "capsules"])
def test_a_falling_heap_goes_back_from_wherever_it_is(shape):
    """What a step keeps of the one before, as colours while contacts stay, is of the world that it was."""
    made, place = world(), np.random.default_rng(2).uniform(-1.2, 1.2, (24, 3))
    ground(made)
    place[:, 1] = 0.6 + 0.5 * np.arange(24)
    made.attach(made.add(x=place), shape)
    for _ in range(8):
        made.step(13)
        saved = made.save()
        made.step()
        after = made.hash
        for steps in (1, 20):
            made.step(steps)
            made.restore(saved)
            made.step()
            assert made.hash == after


def lowest_corner(made, body, half):
    """Above the plane y = 0."""
    w, x, y, z = made.read("q", body).T
    up = np.abs(np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], 1))  # how high each axis of the body goes
    return made.read("x_y", body) - up @ half


@pytest.mark.parametrize("half", [(1, 0.15, 0.15), (0.5, 0.1, 0.5)])
def test_what_lies_still_may_look_anywhere(half):
    """Gaps follow a body in the world's axes: in its own ones, a bar that looked the other way rocked more and more."""
    made, angle = world(rest_speed=0), np.arange(0, 6.3, 0.3)
    ground(made)
    q = np.stack([np.cos(angle / 2), 0 * angle, np.sin(angle / 2), 0 * angle], 1)
    bars = made.add(x=np.stack([4.0 * np.arange(angle.size), half[1] + 0 * angle, 0 * angle], 1), q=q, spin=(0.01, 0, 0.01))
    made.attach(bars, fp3.box(*half))
    made.step(240)
    assert np.all(np.abs(lowest_corner(made, bars, half)) < 2e-4)
    assert np.all(np.abs(made.read("spin", bars)) < 1e-5)


@pytest.mark.parametrize("friction", [0.0, 0.6])
def test_plates_that_spin_stay_on_the_ground(friction):
    """All their corners are within a step's reach of it: the lower ones hold them. Energy falls."""
    made = world(rest_speed=0)
    made.attach(made.add(type="static"), fp3.plane(friction=friction))
    for k, (half, spin) in enumerate([((0.5, 0.1, 0.5), 20), ((1, 0.02, 0.15), 12), ((0.5, 0.5, 0.5), 20), ((0.3, 0.02, 0.3), 60)]):
        body = made.add(x=(4 * k, half[1], 0), spin=(0, spin, 0))
        made.attach(body, fp3.box(*half, friction=friction))
        turning, lowest = float(spin), 0.0
        for _ in range(240 if friction else 120):
            made.step()
            now = np.linalg.norm(made.read("spin", body))
            assert now < turning + 1e-4 * spin
            turning, lowest = now, min(lowest, lowest_corner(made, body, half)[0])
            assert abs(made.read("x_y", body)[0] - half[1]) < 1e-3
        assert lowest > -1.5e-3


@pytest.mark.parametrize("dimensions", [2, 3])
@pytest.mark.parametrize("half, size, g, sag", [(0.05, 0.1, 9.81, 0.01), (0.5, 1, 100, 0.01), (0.5, 1, 10, 0.004)])
def test_small_boxes_stand_and_boxes_under_much_gravity(dimensions, half, size, g, sag):
    """Contacts are stiffer where gravity over size is more than usual: with 30 Hz ten boxes of 10 cm fell into each other. 1 m as ever: the same bits."""
    made = fp3.Bodies(dimensions=dimensions, gravity=(0, -g, 0)[:dimensions], size=size)
    made.attach(made.add(type="static", x=(0, -half, 0)[:dimensions]), fp3.box(*(100 * half, half, 100 * half)[:dimensions]))
    boxes = made.add(x=np.stack([0 * np.arange(10), half * (1 + 2 * np.arange(10)), 0 * np.arange(10)][:dimensions], 1))
    made.attach(boxes, fp3.box(*(half,) * dimensions))
    made.step(300)
    assert (1 - sag) * 19 * half < made.read("x_y", boxes)[-1] < 19 * half


def test_thin_rods_make_no_energy():
    """Thrown at ground, they spin by hundreds of rad/s about their axes: an impulse has to be taken back as it was given, though a rod has turned."""
    place, half, g = np.random.default_rng(3), (0.5, 0.01, 0.01), 10.0
    made = world(gravity=(0, -g, 0), rest_speed=0)
    made.attach(made.add(type="static"), fp3.plane())
    tilt = np.radians(place.uniform(0, 80, 60))
    q = np.stack([np.cos(tilt / 2), 0 * tilt, 0 * tilt, np.sin(tilt / 2)], 1)
    x = np.stack([3.0 * np.arange(60), half[0] * np.sin(tilt) + half[1] * np.cos(tilt) + 0.001, 0 * tilt], 1)
    rods = made.add(x=x, q=q, spin=place.uniform(-10, 10, (60, 3)))
    made.attach(rods, fp3.box(*half))
    m, inertia = made.read("mass", rods), made.read("inertia", rods)

    def energy():
        v, q, w = made.read("v", rods), made.read("q", rods), made.read("spin", rods)
        back = -q[:, 1:]
        own = w + 2 * np.cross(back, np.cross(back, w) + q[:, :1] * w)  # in the rod's axes
        return m * (v ** 2).sum(1) / 2 + (inertia * own ** 2).sum(1) / 2 + m * g * made.read("x", rods)[:, 1]
    before = energy()
    for _ in range(120):
        made.step()
        assert np.all(energy() < 1.001 * before)


# ---- questions, refusals ----

def test_questions_find_what_is_there():
    made = world()
    ground(made)
    ball, box = made.add(x=[(0, 3, 0), (4, 1, 0)])
    made.attach([ball], fp3.sphere(1))
    made.attach([box], fp3.box(1, 1, 1))
    mesh = made.add(type="static", x=(20, 0, 0))
    made.mesh(mesh, [(-5, 1, -5), (-5, 1, 5), (5, 1, 5), (5, 1, -5)], [(0, 1, 2), (0, 2, 3)])
    down = made.ray([(0, 9, 0), (4, 9, 0), (9, 9, 0), (20, 9, 0), (0, 9, 0)], [(0, -9, 0)] * 4 + [(0, 9, 0)])
    assert down["distance"][:4] == pytest.approx([5, 7, 9, 8], abs=2e-4) and down["body"][4] == 0
    assert np.allclose(down["normal"][:4], [0, 1, 0], atol=1e-5)
    cast = made.cast(fp3.box(0.5, 0.5, 0.5), (0, 9, 0), (0, -9, 0))
    assert cast["body"] == ball and cast["distance"] == pytest.approx(4.5, abs=2e-3)
    assert made.overlap(fp3.sphere(0.5), (0, 4.2, 0))["body"].tolist() == [ball]
    near = made.nearest([(0, 0.5, 0), (4, 2.5, 0), (20, 1.25, 0)])
    assert near["distance"] == pytest.approx([0.5, 0.5, 0.25], abs=1e-5) and near["body"].tolist() == [made.handles[0], box, mesh[0]]


@pytest.mark.parametrize("wrong, said", [
    (lambda w, b: w.add(angle=1.0), "angle is 1, expected 0 in space"),
    (lambda w, b: w.add(q=(0, 0, 0, 0)), "the length of q is 0"),
    (lambda w, b: w.attach(b, fp3.circle(1)), "expected FP3_SPHERE"),
    (lambda w, b: w.attach(b, fp3.box(1, 1)), "side"),
    (lambda w, b: w.attach(b, fp3.sphere(0)), "a sphere has radius 0"), (lambda w, b: w.cast(fp3.sphere(0), (0, 0, 0), (1, 0, 0)), "a sphere has radius 0"),
    (lambda w, b: w.ray([(0, 0, 0), (0, np.nan, 0)], [(1, 0, 0)] * 2), "from[1][1] is nan, expected -1e9 to 1e9"),
    (lambda w, b: w.ray((0, 0, 0), (1, 0, np.inf)), "way[0][2] is inf"), (lambda w, b: w.nearest([(0, 0, 0), (2e9, 0, 0)]), "points[1][0] is 2e+09"),
    (lambda w, b: w.cast(fp3.sphere(1), (0, 0, 0), (1, 0, 0), q=(1, 0, 0, np.nan)), "turn[3] is nan"),
    (lambda w, b: w.attach(b, fp3.plane()), "a plane is ground"),
    (lambda w, b: w.attach(b, fp3.sphere(1, belt=1)), "belt is 1, expected 0 in space"),
    (lambda w, b: w.chain(b, [(0, 0), (1, 0)]), "a chain is in a plane"),
    (lambda w, b: w.heights(b, 1, 1, np.zeros((3, 3))), "must not be dynamic"),
    (lambda w, b: w.write("q", b, (0, 0, 0, 0)), "q[0] has the length 0"),
    (lambda w, b: w.write("q_x", b, 1), "cannot be written alone"),
    (lambda w, b: w.write("x", b, (0, np.nan, 0)), "x_y[0] is nan"),
    (lambda w, b: w.read("angle", b), "bodies have no value 'angle' (did you mean 'q'"), (lambda w, b: w.cast(fp3.sphere(1), (0, 0, 0), (1, 0, 0), angle=1.0), "in space q says"),
    (lambda w, b: w.write("inertia", b, (1, 0, 1)), "inertia[0] is 0"),
])
def test_what_is_wrong_is_refused(wrong, said):
    made = world()
    body = made.add()
    made.attach(body, fp3.sphere(0.5))
    before = made.hash
    with pytest.raises(fp3.ArgumentError, match=re.escape(said)):
        wrong(made, body)
    assert made.hash == before


@pytest.mark.parametrize("wrong, said", [
    (lambda w, b: w.add(q=(0, 1, 0, 0)), "expected 0 in a plane"), (lambda w, b: w.attach(b, fp3.sphere(1)), "expected FP3_CIRCLE"),
    (lambda w, b: w.attach(b, fp3.capsule((0, 0, 1), (1, 0, 2), 0.1)), "corner\\[0\\]\\[2\\] is 1"), (lambda w, b: w.attach(b, fp3.box(1, 1, q=(1, 1, 0, 0))), "q\\[1\\] is 1"),
    (lambda w, b: w.read("spin", b), "did you mean 'w'"), (lambda w, b: w.attach(b, fp3.box(1, 1, 1)), "half\\[2\\] is 1, expected 0 in a plane"), (lambda w, b: w.mesh(b, np.zeros((3, 3)), [(0, 1, 2)]), "in space"),
    (lambda w, b: fp3.Bodies(dimensions=4), "dimensions is 4"), (lambda w, b: fp3.Bodies(gravity=(0, 0, 1)), "gravity\\[2\\] is 1")])
def test_a_plane_is_no_space(wrong, said):
    made = fp3.Bodies()
    body = made.add()
    with pytest.raises(fp3.ArgumentError, match=said):
        wrong(made, body)


@pytest.mark.parametrize("how, said", [({"type": "hinge", "axis": (0, 0, 1)}, "axis[2] is 1, expected 0 in a plane"), ({"type": "hinge", "ratio": -1}, "a hinge has no ratio"),
                                       ({"type": "gear", "limits": (0, 1)}, "a gear has no limits"), ({"type": "gear", "hertz": 1}, "a gear has no spring: hertz must be 0"),
                                       ({"type": "weld", "most": 1}, "a weld has no motor"), ({"type": "ball"}, "a ball is in space alone")])
def test_joints_that_cannot_be_in_a_plane(how, said):
    made = fp3.Bodies()
    a, b = made.add(x=[(0, 0), (1, 0)])
    with pytest.raises(fp3.ArgumentError, match=re.escape(said)):
        made.join(how.pop("type"), [a], [b], **how)
    assert made.joints == 0


@pytest.mark.parametrize("restitution", [0.0, 0.5])
@pytest.mark.parametrize("is_first", [False, True])
def test_a_ball_that_lands_rolls_whoever_has_the_lower_number(is_first, restitution):
    """Friction acts at its surface, however far away it was when the contact was found: 5/7 of the speed is left, and it rolls."""
    made, bodies = world(), {}
    for name in ("ball", "floor") if is_first else ("floor", "ball"):
        bodies[name] = made.add(x=(0, 3, 0), v=(4, -5, 0)) if name == "ball" else made.add(type="static")
        made.attach(bodies[name], fp3.sphere(0.5, restitution=restitution) if name == "ball" else fp3.box(50, 1, 50, centre=(0, -1, 0)))
    while made.read("v_y", bodies["ball"])[0] < -1:
        made.step()
    assert made.read("v_x", bodies["ball"])[0] == pytest.approx(20 / 7, rel=2e-3)
    assert made.read("spin", bodies["ball"])[0] == pytest.approx([0, 0, -40 / 7], rel=2e-3)


# ---- joints ----

def hung(type, x, anchor, shape=None, gravity=UP, **how):
    """Something that hangs from the origin by a joint."""
    made = world(gravity=gravity, rest_speed=0)
    wall, body = made.add(type="static"), made.add(x=x)
    made.attach(body, shape or fp3.box(0.5, 0.2, 0.1))
    return made, body, made.join(type, wall, body, anchor_b=anchor, **how)


def test_a_ball_joint_swings_as_a_pendulum():
    """T = 2 pi sqrt(I/(m g l))/agm(1, cos 1/2) from 1 rad."""
    made, body, _ = hung("ball", (np.sin(1), -np.cos(1), 0), (-np.sin(1), np.cos(1), 0), fp3.sphere(0.1))
    last, times = 0.0, []
    for _ in range(400):
        made.step()
        v = made.read("v_x", body)[0]
        if last * v < 0:
            times.append(made.time - v / (v - last) / 60)
        last = v
    a, b = 1.0, np.cos(0.5)
    for _ in range(6):
        a, b = (a + b) / 2, np.sqrt(a * b)
    assert 2 * np.diff(times).mean() == pytest.approx(2 * np.pi * np.sqrt((0.4 * 0.01 + 1) / 10) / a, rel=5e-4)
    assert np.linalg.norm(made.read("x", body)) == pytest.approx(1, abs=2e-3)


def test_a_motor_turns_a_hinge_about_its_axis():
    made, body, hinge = hung("hinge", (1, 0, 0), (-1, 0, 0), gravity=(0, 0, 0), axis=(0, 1, 1), speed=2, most=100)
    made.step(60)
    assert np.allclose(made.read("spin", body), [[0, np.sqrt(2), np.sqrt(2)]], atol=2e-3)
    assert made.read_joint("at", hinge)[0] == pytest.approx(2, abs=2e-3)


def test_a_hinge_stops_at_its_limit_and_carries():
    made, body, hinge = hung("hinge", (1, 0, 0), (-1, 0, 0), axis=(0, 0, 1), limits=(-0.5, 0.5))
    made.step(240)
    assert made.read_joint("at", hinge)[0] == pytest.approx(-0.5, abs=2e-3)
    weight = 10 * made.read("mass", body)[0]
    assert made.read_joint("force_y", hinge)[0] == pytest.approx(weight, rel=1e-3)
    assert made.read_joint("torque_z", hinge)[0] == pytest.approx(weight * np.cos(0.5), rel=2e-3)


def test_a_slider_keeps_its_line_and_its_turn():
    made, body, slider = hung("slider", (0, 0, 0), (0, 0, 0), axis=(0, 1, 0), hertz=1, damping=0.7)
    made.write("torque", body, (1, 2, 3))
    made.step(600)
    assert made.read_joint("at", slider)[0] == pytest.approx(-10 / (2 * np.pi) ** 2, rel=1e-3)
    assert np.allclose(made.read("x", body)[0, [0, 2]], 0, atol=1e-4) and np.allclose(made.read("q", body)[0], [1, 0, 0, 0], atol=1e-4)


def test_welds_hold_what_sticks_out_of_a_wall():
    made = world(rest_speed=0)
    wall, row = made.add(type="static"), made.add(x=[(1 + i, 0, 0) for i in range(4)])
    made.attach(row, fp3.box(0.5, 0.2, 0.2))
    first = made.join("weld", wall, row[:1], anchor_a=(0.5, 0, 0), anchor_b=(-0.5, 0, 0))
    made.join("weld", row[:-1], row[1:], anchor_a=(0.5, 0, 0), anchor_b=(-0.5, 0, 0))
    made.step(600)
    x = made.read("x", row)
    assert np.abs(x - [(1 + i, 0, 0) for i in range(4)]).max() < 0.05 and np.abs(made.read("v", row)).max() < 1e-3
    weight = 40 * made.read("mass", row)[0]
    assert made.read_joint("force_y", first)[0] == pytest.approx(weight, rel=1e-3)
    assert made.read_joint("torque_z", first)[0] == pytest.approx(2 * weight, rel=2e-3)


def test_a_ball_joint_stays_within_its_cone():
    made, body, ball = hung("ball", (0.5, -1, 0), (0, 0.6, 0), fp3.box(0.1, 0.5, 0.1), anchor_a=(0.5, -0.4, 0), axis=(0, -1, 0), limits=(0, 0.3))
    made.write("v", body, (5, 0, 3))
    swing = []
    for _ in range(120):
        made.step()
        swing.append(made.read_joint("at", ball)[0])
    assert 0.29 < max(swing) < 0.31


def test_a_car_on_four_wheels_drives():
    made = world(rest_speed=0)
    ground(made)
    car, wheels = made.add(x=(0, 1, 0)), made.add(x=[(x, 0.4, z) for x in (-0.8, 0.8) for z in (-0.7, 0.7)])
    made.attach(car, fp3.box(1, 0.2, 0.5, density=2))
    made.attach(wheels, fp3.sphere(0.4, friction=1))
    for i, wheel in enumerate(wheels):
        x, _, z = made.read("x", [wheel])[0]
        made.join("wheel", car, [wheel], anchor_a=(x, -0.6, z), axis=(0, 1, 0), axle=(0, 0, 1), hertz=4, damping=0.7, speed=-5, most=20 if i < 2 else 0)
    made.step(240)
    assert np.allclose(made.read("v", car), [[2, 0, 0]], atol=5e-3)
    assert np.allclose(made.read("spin", wheels), [[0, 0, -5]] * 4, atol=5e-3)


def test_joints_have_the_same_bits_and_go_back():
    def chain(**options):
        made = world(**options)
        wall, links = made.add(type="static"), made.add(x=[(0.5 + i, 0, 0.1 * i) for i in range(6)])
        made.attach(links, fp3.box(0.4, 0.1, 0.2))
        before = np.concatenate([wall, links[:-1]])
        kinds = ["ball", "hinge", "weld", "slider", "rod", "wheel"]
        for i, kind in enumerate(kinds):
            made.join(kind, before[i:i + 1], links[i:i + 1], anchor_a=(0.5 if i else 0, 0, 0), anchor_b=(-0.5, 0, 0), hertz=3 if kind == "wheel" else 0, most=0 if kind in ("ball", "weld") else 1,
                      speed=1, **({"limits": (-0.4, 0.4)} if kind in ("hinge", "slider") else {}))
        return made
    built_in, isa = chain(), chain(engine="isa")
    for made in (built_in, isa):
        made.step(12)
    assert built_in.hash == isa.hash
    saved = built_in.save()
    built_in.step(30)
    after = built_in.hash
    built_in.restore(saved)
    built_in.step(30)
    assert built_in.hash == after


@pytest.mark.parametrize("how, said", [({"type": "gear"}, "a gear is in a plane alone"), ({"type": "hinge", "axis": (0, 0, 0)}, "its axis has no direction"),
                                       ({"type": "wheel", "axle": (0, 0, 0)}, "its axle has no direction"),
                                       ({"type": "hinge", "limits": (-5, 5)}, "expected angles from -pi to pi"), ({"type": "ball", "limits": (-2, -1)}, "from 0 to pi"),
                                       ({"type": "ball", "limits": (-1, 1)}, "limits of a ball are -1 and 1, expected 0"), ({"type": "ball", "rest": 1}, "rest is 1, and a ball in space has none"),
                                       ({"type": "weld", "rest": 0, "hertz": 2}, "rest is 0, and a weld in space has none, expected NaN"),
                                       ({"type": "ball", "most": 4, "speed": 3}, "a ball has no motor: most must be 0"),
                                       ({"type": "weld", "limits": (-1, 1)}, "a weld has no limits"), ({"type": "hinge", "ratio": 2}, "joint 0: a hinge has no ratio: it must be 1"),
                                       ({"type": "wheel", "axis": (1, 0, 0), "axle": (1, 0, 0)}, "expected across it")])
def test_joints_that_cannot_be(how, said):
    made = world()
    a, b = made.add(x=[(0, 0, 0), (1, 0, 0)])
    with pytest.raises(fp3.ArgumentError, match=said):
        made.join(how.pop("type"), [a], [b], **how)
    assert made.joints == 0


@pytest.mark.parametrize("dimensions, types", [(2, ("gear", "weld")), (3, ("ball", "weld"))])
def test_a_joint_gets_no_motor_later_that_it_cannot_have(dimensions, types):
    made = fp3.Bodies(dimensions=dimensions)
    a, b = made.add(x=np.eye(2, dimensions))
    for kind in types:
        joint = made.join(kind, [a], [b])
        with pytest.raises(fp3.ArgumentError, match=rf"most\[0\]: a {kind} has no motor"):
            made.write_joint("most", joint, 1)
        made.write_joint("most", joint, 0)


def test_a_joint_in_space_gets_no_word_later_that_it_cannot_have():
    made = world()
    a, b = made.add(x=np.eye(2, 3))
    ball, weld, hinge = made.join("ball", [a], [b], limits=(0, 1)), made.join("weld", [a], [b], hertz=2), made.join("hinge", [a], [b], limits=(-1, 1), hertz=2)
    for name, joint, value in (("rest", ball, 0), ("rest", weld, 0), ("low", ball, -1), ("low", ball, 0.5)):
        with pytest.raises(fp3.ArgumentError, match=rf"{name}\[0\] is {value}, which this joint cannot have"):
            made.write_joint(name, joint, value)
        made.write_joint(name, hinge, value)
    made.write_joint("low", ball, 0)
    made.write_joint("high", ball, 0.5)


def test_impulses_without_a_root_do_no_harm():
    """Cubes that just touch have impulses so small that their squares are no ordinary numbers."""
    made = world(rest_speed=0, bounce=0)
    made.attach(made.add(type="static"), fp3.box(50, 1, 5, centre=(0, -1, 0)))
    x = [(column - (30 - row) / 2, row + 0.5, 0) for row in range(30) for column in range(30 - row)]
    cubes = made.add(x=x)
    made.attach(cubes, fp3.box(0.5, 0.5, 0.5))
    made.step(10)
    assert np.abs(made.read("x", cubes) - x).max() < 0.06


# ---- what a reader found ----

@pytest.mark.parametrize("yaw", [1.0, 6.0])
@pytest.mark.parametrize("kind", ["hinge", "wheel"])
def test_a_flywheel_keeps_its_spin_on_a_body_that_turns(kind, yaw):
    made = world(gravity=(0, 0, 0), rest_speed=0)
    base, wheel = made.add(type="kinematic", spin=(0, yaw, 0)), made.add(spin=(0, yaw, 5))
    made.attach(wheel, fp3.sphere(0.5))
    made.join(kind, base, wheel, axis=(0, 0, 1) if kind == "hinge" else (0, 1, 0), axle=(0, 0, 1))
    made.step(300)
    w = made.read("spin", wheel)[0]
    about = np.array([np.sin(5 * yaw), 0, np.cos(5 * yaw)])
    assert w @ about == pytest.approx(5, rel=0.03)


def test_the_impulse_of_a_contact_is_that_of_its_step():
    made = world(rest_speed=0)
    ground(made)
    box = made.add(x=(0, 0.5, 0))
    made.attach(box, fp3.box(0.5, 0.5, 0.5))
    made.step(60)
    assert made.contacts()["impulse"] == pytest.approx([10 / 240], rel=0.02)
    made.write("x", box, (0, 0.512, 0))
    made.write("v", box, (0, 1, 0))
    made.step()
    assert made.touching == 0


def test_a_mesh_that_turns_takes_along_what_it_meets():
    found = []
    for is_mesh in (False, True):
        made = world(gravity=(0, 0, 0), rest_speed=0)
        beam, ball = made.add(type="kinematic", spin=(0, -0.5, 0)), made.add(x=(0, 0, 8))
        made.attach(ball, fp3.sphere(0.4))
        if is_mesh:
            corners = [(x, y, z) for x in (-10, 10) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
            made.mesh(beam, corners, [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)])
        else:
            made.attach(beam, fp3.box(10, 0.5, 0.5))
        made.step(240)
        found.append(made.read("x", ball)[0])
    assert abs(found[0][0]) > 1 and np.allclose(found[0], found[1], atol=5e-2)


def test_an_impact_turns_a_ball_by_its_spin():
    made = world(rest_speed=0, bounce=0)
    ground(made, friction=1.0)
    ball = made.add(x=(0, 0.25, 0), v=(20, -10, 0))
    made.attach(ball, fp3.sphere(0.1, friction=1.0, restitution=0.9))
    made.step()
    spin, q = made.read("spin", ball)[0, 2], made.read("q", ball)[0]
    assert 2 * np.arctan2(q[3], q[0]) == pytest.approx(spin * (1 / 60 - 0.015), rel=0.1)


def test_a_ball_joint_with_a_cone_does_not_brake():
    lost = []
    for limits in (None, (0, 1.5)):
        made, body, _ = hung("ball", (np.sin(0.5), -np.cos(0.5), 0), (-np.sin(0.5), np.cos(0.5), 0), fp3.sphere(0.1), axis=(0, 1, 0), limits=limits)
        y = []
        for _ in range(300):
            made.step()
            y.append(made.read("x_y", body)[0])
        lost.append(max(y[150:]))
    assert lost[0] == pytest.approx(lost[1], abs=1e-6)


@pytest.mark.parametrize("radius, speed", [(0.01, 20), (0.01, 100), (0.2, 50)])
def test_a_ball_that_spins_is_not_thrown_where_it_hits(radius, speed):
    for is_fast in (False, True):
        made = world(gravity=(0, 0, 0), rest_speed=0)
        ground(made)
        ball = made.add(x=(0, 1.013, 0), v=(0, -speed, 0), spin=(0, 0, -10), is_fast=is_fast)
        made.attach(ball, fp3.sphere(radius))
        made.step(30)
        assert np.allclose(made.read("v", ball), [[2 / 7 * radius * 10, 0, 0]], atol=1e-4)


@pytest.mark.parametrize("speed", [8, 13, 100])
def test_nothing_falls_through_ground(speed):
    made = world(gravity=(0, 0, 0))
    made.mesh(made.add(type="static"), [(-5, -5, 0), (5, -5, 0), (5, 5, 0), (-5, 5, 0)], [(0, 1, 2), (0, 2, 3)])
    made.attach(made.add(type="static", x=(20, 0, 0)), fp3.box(5, 5, 0.001))
    at = [(0.03 * i - 1.5 + dx, 0.2, 1 + 0.003 * i) for i in range(60) for dx in (0, 20)]
    balls = made.add(x=at, v=(0, 0, -speed))
    made.attach(balls, fp3.sphere(0.1, category=2, mask=1))
    made.step(60)
    assert made.read("x_z", balls).min() > 0


@pytest.mark.parametrize("shape", [fp3.box(1e6, 1e6, 1e6, density=1e12), fp3.sphere(1e-6, density=1e-12), fp3.capsule((0, 0, 0), (100, 0, 0), 1e-8, density=1e-12)], ids=str)
def test_an_inertia_has_to_be_a_number(shape):
    made = world()
    body = made.add()
    with pytest.raises(fp3.ArgumentError, match="a body would have an? (mass|inertia)"):
        made.attach(body, shape)
    with pytest.raises(fp3.ArgumentError, match="expected all three numbers"):
        made.write("inertia_y", body, 1)
    made.write("inertia", body, (1, 2, 3))
    made.step()


def test_heights_of_ten_thousand_columns():
    made = world()
    made.heights(made.add(type="static"), 1.0, 1.0, np.zeros((2, 10000)))
    with pytest.raises(fp3.ArgumentError, match="10,000"):
        made.heights(made.add(type="static"), 1.0, 1.0, np.zeros((2, 10001)))


@pytest.mark.parametrize("dimensions, spin", [(2, {"w": 5}), (3, {"spin": (1, 2, 5)})])
def test_a_body_without_mass_does_not_turn(dimensions, spin):
    """Else it would be a motor without end for what is joined with it. It turns once it has a shape that weighs something."""
    made = fp3.Bodies(dimensions=dimensions, gravity=(0,) * dimensions)
    ball, name = fp3.sphere if dimensions == 3 else fp3.circle, next(iter(spin))
    empty, sensor, heavy = made.add(x=np.eye(3)[:, :dimensions] * 9, **spin)
    made.attach([sensor], ball(1, is_sensor=True))
    made.attach([heavy], ball(1))
    made.step(10)
    turned = made.read(name, [empty, sensor, heavy]).reshape(3, -1)
    assert np.all(turned[:2] == 0) and np.allclose(turned[2], spin[name])
