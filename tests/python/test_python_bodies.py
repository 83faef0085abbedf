"""fp3.Bodies as an object of Python: what it takes and gives, what it refuses in words, closed, forked, interrupted."""

import copy
import pickle
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import fp3
from test_hostile import NAN, NO_NUMBERS, Closes, ClosesAsNumber

INF = float("inf")


@pytest.fixture
def world():
    """Four boxes on a floor."""
    world = fp3.Bodies(gravity=(0, -10))
    world.attach(world.add(type="static"), fp3.box(50, 1, centre=(0, -1)))
    world.attach(world.add(x=[(2.0 * k, 0.5) for k in range(4)]), fp3.box(0.5, 0.5))
    return world


def test_columns(world):
    """Rows are bodies; what is one value is for all of them. What comes back is a copy, in the order of numbers."""
    assert len(world) == 5 and world and repr(world) == "fp3.Bodies(5 bodies)" and not len(fp3.Bodies()) and fp3.Bodies()
    made = world.add(type="kinematic", x=[(1, 2), (3, 4), (5, 6)], v=(7, 8), w=np.float32([1, 2, 3]), angle=2)
    assert made.dtype == np.uint64 and made.shape == (3,) and len(set(world.handles.tolist())) == 8 and world.handles[-3:].tolist() == made.tolist()
    assert world.read("x", made).tolist() == [[1, 2], [3, 4], [5, 6]] and world.read("v", made).tolist() == [[7, 8]] * 3
    assert world.read("w", made[::-1]).tolist() == [3, 2, 1] and world.read("angle", made[1]).tolist() == [2]
    assert world["x"].shape == (8, 2) and world["w"].shape == (8,) and world["x"].dtype == np.float64
    for name in ("x", "v", "force"):
        assert np.array_equal(world[name], np.stack([world[name + "_x"], world[name + "_y"]], 1))
    world.write("x", made, [(0, 1), (2, 3), (4, 5)])
    world.write("v_y", made, 9)
    world.write("w", list(made.tolist()), (6, 5, 4))
    assert world.read("x", made).tolist() == [[0, 1], [2, 3], [4, 5]] and world.read("v", made).tolist() == [[7, 9]] * 3
    assert world.read("w", made).tolist() == [6, 5, 4]
    world["x"][:] = 0
    assert world["x"].any()
    assert all(name in world for name in ("x", "x_y", "angle", "v", "w", "force", "torque", "mass", "inertia", "at_rest"))
    assert "y" not in world and 3 not in world and "x\0" not in world and "\ud800" not in world
    assert world.add(x=np.zeros((0, 2))).shape == (0,) and world.read("x", []).shape == (0, 2) and world.read("w", []).shape == (0,)
    world.remove(made)
    world.remove([])
    assert len(world) == 5


def test_ten_thousand_in_one_call():
    world = fp3.Bodies()
    made = world.add(x=np.stack(np.divmod(np.arange(10_000.0), 100), 1), gravity=np.linspace(0, 1, 10_000))
    world.attach(made, fp3.circle(0.1))
    world.step()
    assert len(np.unique(made)) == 10_000 and world.awake == 10_000 and np.allclose(world["v_y"], -9.81 / 60 * np.linspace(0, 1, 10_000))


@pytest.mark.parametrize("options, told", [
    ({"gravity": 3}, "gravity"), ({"gravity": (1, 2, 3)}, r"gravity\[2\]"), ({"gravity": (1, 2, 3, 4)}, "two numbers"), ({"gravity": (0, NAN)}, r"gravity\[1\]"), ({"gravity": "ab"}, "gravity"),
    ({"gravity": (0, 1e10)}, "gravity"),
    ({"h": 0}, "h is 0"), ({"h": 2}, "h is 2"), ({"h": NAN}, "h is"), ({"h": "x"}, "h"), ({"h": [1]}, "h"), ({"substeps": 0}, "substeps"),
    ({"substeps": 65}, "substeps"),
    ({"substeps": 2.5}, "whole"), ({"substeps": True}, "whole"), ({"substeps": 2**32}, "substeps"), ({"size": 0}, "size"), ({"size": INF}, "size"),
    ({"push": -1}, "push"),
    ({"bounce": NAN}, "bounce"), ({"rest_speed": -1}, "rest_speed"), ({"rest_time": INF}, "rest_time"), ({"engine": "quick"}, "quick"),
    ({"engine": "fa\0st"}, "NUL"),
    ({"laws": "/nowhere"}, "expected an engine")])
def test_what_cannot_be_opened(options, told):
    with pytest.raises(fp3.ArgumentError, match=told):
        fp3.Bodies(**options)


@pytest.mark.parametrize("make, told", [
    (lambda: fp3.circle(0), "radius 0"), (lambda: fp3.circle(NAN), "radius"), (lambda: fp3.circle(1e300), "radius"), (lambda: fp3.circle(-1), "radius"),
    (lambda: fp3.circle(1, centre=(1, 1e7)), "within"), (lambda: fp3.box(0, 1), "half a box"), (lambda: fp3.box(1, NAN), "half a box"),
    (lambda: fp3.box(1, 1, angle=INF), "angle is inf"),
    (lambda: fp3.box(1e-3, 1e-3, centre=(1e5, 0)), "too small"), (lambda: fp3.capsule((0, 0), (0, 0), 1), "one point"), (lambda: fp3.capsule((0, 0),
    (1, 0), -1), "radius"),
    (lambda: fp3.polygon([(0, 0), (1, 0)]), "3 to 8"), (lambda: fp3.polygon([(0, 0), (1, 0), (2, 0)]), "on a line"), (lambda: fp3.polygon([(0, 0), (1, 0),
    (NAN, 1)]), "corner 2"),
    (lambda: fp3.polygon([(k, k * k) for k in range(9)]), "at most 8"), (lambda: fp3.polygon([]), "points"), (lambda: fp3.polygon([1, 2, 3]), "points"),
    (lambda: fp3.circle(1, density=-1), "density"), (lambda: fp3.circle(1, density=1e-40), "density"), (lambda: fp3.circle(1, friction=NAN), "friction"),
    (lambda: fp3.circle(1, restitution=1.1), "restitution"), (lambda: fp3.circle(1, rolling=-1), "rolling"), (lambda: fp3.circle(1, belt=INF), "belt"),
    (lambda: fp3.circle(1, category=2**32), "category"), (lambda: fp3.circle(1, mask=-1), "mask"), (lambda: fp3.circle(1, is_sensor=1), "True or False"),
    (lambda: "box", "what fp3.circle"), (lambda: None, "what fp3.circle"), (lambda: 0.5, "what fp3.circle")])
def test_what_is_no_shape(world, make, told):
    before = world.hash, world["mass"].tolist()
    with pytest.raises(fp3.ArgumentError, match=told):
        world.attach(world.handles, make())
    assert (world.hash, world["mass"].tolist()) == before
    world.step()
    assert world.awake == 4


@pytest.mark.parametrize("misuse, told", [
    (lambda w: w.add(type="solid"), "'dynamic', 'kinematic' or 'static'"), (lambda w: w.add(type=0), "'dynamic'"),
    (lambda w: w.add(type=["static"]), "'dynamic'"),
    (lambda w: w.add(x=1), r"x: found shape \(\), expected \(2,\) or \(bodies, 2\)"), (lambda w: w.add(x=(1, 2, 3)), "x"),
    (lambda w: w.add(x=np.zeros((2, 2, 2))), "x"),
    (lambda w: w.add(angle=np.zeros((2, 2))), "angle"), (lambda w: w.add(x=np.zeros((3, 2)), w=[1, 2]), "different numbers of bodies: x 3, w 2"),
    (lambda w: w.add(x=[(0, 0), (0, NAN)]), r"body 1: x\[1\]"), (lambda w: w.add(damping=-1), "damping"), (lambda w: w.add(gravity=1e13), "gravity"),
    (lambda w: w.add(may_not_turn=1), "True or False"), (lambda w: w.add(may_not_sleep=[True]), "True or False"),
    (lambda w: w["y"], "no value 'y'"), (lambda w: w["vx"], "did you mean 'x'"), (lambda w: w.read("x", [3]), "no such body"),
    (lambda w: w.read("x", 1.5), "handles"),
    (lambda w: w.read("x", [-1]), "handles"), (lambda w: w.read("x", [[1]]), "handles"), (lambda w: w.read("x", "a"), "handles"),
    (lambda w: w.read("x", None), "handles"),
    (lambda w: w.write("x", w.handles[1:], 3), r"found shape \(\), expected \(2,\) or \(4, 2\)"),
    (lambda w: w.write("x", w.handles[1:], [1, 2, 3, 4]), "shape"),
    (lambda w: w.write("w", w.handles[1:], [1, 2]), "shape"), (lambda w: w.write("x", w.handles[1:], [[0, 0]] * 3 + [[0, NAN]]), r"x_y\[3\] is"),
    (lambda w: w.write("q", w.handles, 1), "no value 'q'"),
    (lambda w: w.write("w", w.handles, 1), r"w\[0\]: the body is static"), (lambda w: w.write("mass", w.handles, 1), r"mass\[0\]"),
    (lambda w: w.write("at_rest", w.handles, 1), "at_rest"),
    (lambda w: w.chain(w.handles, [(1, 0), (0, 0)]), "found 5, expected one"), (lambda w: w.chain(w.handles[0], [(1, 0)]), "1 corners, expected 2"),
    (lambda w: w.chain(w.handles[0], [(1, 0), (0, 0)], True), "2 corners, expected 3"), (lambda w: w.chain(w.handles[0], []), "corners"),
    (lambda w: w.chain(w.handles[0], np.zeros((0, 2))), "0 corners"),
    (lambda w: w.chain(w.handles[0], [(1, 0), (1, 0)]), "one point"), (lambda w: w.chain(w.handles[0], [(1, 0), (0, NAN)]), "corner 1"),
    (lambda w: w.chain(w.handles[0], [(1, 0), (0, 0)], 1), "True or False"),
    (lambda w: w.chain(w.handles[0], [(1, 0), (0, 0)], friction=-1), "friction"), (lambda w: w.chain(w.handles[1], [(1, 0), (0, 0)]), "dynamic"),
    (lambda w: w.step(-1), "steps"), (lambda w: w.step(1.5), "whole"), (lambda w: w.step(2**32), "steps"), (lambda w: w.step(None), "whole"),
    (lambda w: w.remove([1]), "no such body")])
def test_what_is_refused(world, misuse, told):
    """With nothing changed."""
    world.step(3)
    before = world.hash, len(world), world.handles.tolist(), world.touching
    with pytest.raises(fp3.ArgumentError, match=told):
        misuse(world)
    assert (world.hash, len(world), world.handles.tolist(), world.touching) == before
    world.step()


NUMBERS = {"x": lambda w, v: w.add(x=v), "x_x": lambda w, v: w.add(x=(v, 0)), "w": lambda w, v: w.add(w=v),
           "write": lambda w, v: w.write("w", w.handles[1:], v), "step": lambda w, v: w.step(v),
           "handles": lambda w, v: w.read("x", v), "radius": lambda w, v: fp3.circle(v), "half": lambda w, v: fp3.box(1, v),
           "end": lambda w, v: fp3.capsule((0, 0), v, 1),
           "points": lambda w, v: fp3.polygon(v), "friction": lambda w, v: fp3.circle(1, friction=v), "mask": lambda w, v: fp3.circle(1, mask=v),
           "corners": lambda w, v: w.chain(w.handles[0], v),
           "gravity": lambda w, v: fp3.Bodies(gravity=v), "h": lambda w, v: fp3.Bodies(h=v), "substeps": lambda w, v: fp3.Bodies(substeps=v)}


@pytest.mark.filterwarnings("ignore:Warning. converting a masked element:UserWarning")
@pytest.mark.parametrize("use", NUMBERS)
def test_what_is_no_number(world, use):
    """NaN is one for a shape, until a body gets it."""
    before = world.hash
    for value in [value for value in NO_NUMBERS if not (value is NAN and use in ("radius", "half", "friction"))] + [True] * (use != "x_x"):
        with pytest.raises((fp3.ArgumentError, TypeError), match="[a-z0-9 ']+"):
            print(use, type(value), NUMBERS[use](world, value))
    assert world.hash == before and len(world) == 5


@pytest.mark.parametrize("name", [None, 3, b"x", {"x": 1}, ("x", 1), ["x"]])
def test_names_are_strings(world, name):
    for use in (lambda: world[name], lambda: world.read(name, world.handles), lambda: world.write(name, world.handles[1:], 1),
    lambda: fp3.Bodies(engine=name or 0)):
        with pytest.raises(TypeError, match="expected a string|unhashable"):
            use()


CLOSING = [lambda w, v: w.add(x=v), lambda w, v: w.add(w=v), lambda w, v: w.write("w", v, 1), lambda w, v: w.write("w", w.handles[1:], v), lambda w, v: w.read("x", v),
           lambda w, v: w.step(v),
           lambda w, v: w.remove(v), lambda w, v: w.attach(v, fp3.circle(1)), lambda w, v: w.chain(v, [(1, 0), (0, 0)]), lambda w, v: w.chain(w.handles[0], v)]


@pytest.mark.parametrize("number", range(len(CLOSING)))
def test_arguments_that_close_the_world(number):
    for kind in (Closes, ClosesAsNumber):
        world = fp3.Bodies()
        world.add(x=np.zeros((5, 2)))
        with pytest.raises((fp3.ArgumentError, TypeError)):
            CLOSING[number](world, kind(world))


def test_a_closed_world(world):
    handles = world.handles
    with world as same:
        assert same is world
    world.close()
    for use in (lambda: len(world), lambda: world.add(), lambda: world.step(), lambda: world["x"], lambda: world.read("x", handles),
    lambda: world.write("w", handles, 1), lambda: world.time,
                lambda: world.hash, lambda: world.awake, lambda: world.touching, lambda: world.handles, lambda: world.remove(handles), lambda: "x" in world,
                lambda: world.attach(handles, fp3.circle(1)), lambda: world.chain(handles[:1], [(1, 0), (0, 0)])):
        with pytest.raises(fp3.ArgumentError, match="this world of bodies is closed"):
            use()
    assert repr(world) == "fp3.Bodies(closed)"
    for use in (copy.copy, copy.deepcopy, pickle.dumps):
        with pytest.raises(TypeError, match="a world of bodies cannot be pickled or copied"):
            use(world)
    with pytest.raises(TypeError, match="not iterable"):
        list(world)


def test_threads_follow_each_other(world):
    threads = [threading.Thread(target=lambda: [world.step() or world["x"] for _ in range(30)]) for _ in range(4)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert world.time == 2


def test_a_fork(python):
    told = python("""
import os, fp3
world = fp3.Bodies()
world.add()
child = os.fork()
if not child:
    try:
        world.step()
    except fp3.ArgumentError as error:
        print("forked" in str(error), len(fp3.Bodies()), flush=True)
    os._exit(0)
os.waitpid(child, 0)
world.step()
print(world.time > 0)
""")
    assert told.split() == ["True", "0", "True"]


def test_ctrl_c_ends_steps(environment):
    """Within a second of time on a machine that is busy, after whole steps: the world goes on as one that was never stopped."""
    script = """
import signal, sys, fp3
signal.signal(signal.SIGINT, signal.default_int_handler)
world = fp3.Bodies()
world.add(x=[(k, 0) for k in range(500)], may_not_sleep=True)
print("begun", flush=True)
try:
    world.step(2**32 - 1)
except KeyboardInterrupt:
    steps = round(world.time * 60)
    other = fp3.Bodies()
    other.add(x=[(k, 0) for k in range(500)], may_not_sleep=True)
    other.step(steps)
    print(steps > 0 and other.hash == world.hash)
"""
    with subprocess.Popen([sys.executable, "-c", script], env=environment, stdout=subprocess.PIPE, text=True) as run:
        assert run.stdout.readline() == "begun\n"
        time.sleep(0.3)
        run.send_signal(signal.SIGINT)
        assert run.communicate(timeout=60)[0] == "True\n"
