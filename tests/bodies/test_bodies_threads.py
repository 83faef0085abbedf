"""Threads that step rigid bodies: the same bits with any number of them, and no more of them than asked for."""

import ctypes
import os
import pathlib
import resource
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("FP3_BUILD", ROOT / "build"))
os.environ["FP3_HOME"] = str(BUILD)
sys.path.insert(0, str(ROOT / "python"))
if BUILD.name != "build" and not {"libasan", "libtsan"} & {name[:7] for name in os.environ.get("LD_PRELOAD", "").split("/")}:
    pytest.skip("sanitizers have to be there before Python", allow_module_level=True)

import fp3  # noqa: E402

BOX = fp3.box(0.5, 0.5)


def floor(**how):
    world = fp3.Bodies(**how)
    ground = world.add(type="static")
    world.attach(ground, fp3.box(500, 1, centre=(0, -1)))
    return world


def pyramid(base=32, **how):
    """All rests, and sleeps; then a bullet wakes it."""
    world = floor(rest_time=0.2, **how)
    bricks = world.add(x=[(1.05 * (column - (base - row) / 2), row + 0.5) for row in range(base) for column in range(base - row)])
    world.attach(bricks, BOX)

    def shoot():
        bullet = world.add(x=(-60, 4), v=(200, 0), is_fast=True)
        world.attach(bullet, fp3.circle(0.5, density=20))
    return world, {24: shoot}


def heap(count=700, **how):
    """Of all shapes, some bouncy and some sensors, which fall onto a chain and what the caller moves."""
    random = np.random.default_rng(1)
    world = fp3.Bodies(**how)
    ground = world.add(type="static")
    world.chain(ground, [(30, 40), (30, 0), (10, -2), (-10, -1), (-30, 0), (-30, 40)])
    mover = world.add(type="kinematic", x=(-5, 2), v=(2, 0), w=1.0)
    world.attach(mover, fp3.box(3, 0.3))
    shapes = [BOX, fp3.circle(0.4, rolling=0.02), fp3.capsule((-0.4, 0), (0.4, 0), 0.2), fp3.polygon([(-0.5, -0.4), (0.5, -0.4), (0, 0.6)]),
              fp3.circle(0.5, restitution=0.7), fp3.box(0.4, 0.4, is_sensor=True)]
    for k, shape in enumerate(shapes):
        some = np.arange(k, count, len(shapes))
        bodies = world.add(x=np.column_stack([some % 40 - 20 + 0.2 * random.random(len(some)), 3 + 1.1 * (some // 40)]), angle=random.random(len(some)))
        world.attach(bodies, shape)
    return world, {}


def net(side=28, **how):
    """A grid of hinges that hangs on four welds, with springs, a tree with a heavy body, and a ball on it."""
    world = floor(**how)
    at = [(0.5 * (i % side), 12 + 0.5 * (i // side)) for i in range(side * side)]
    knots = world.add(x=at)
    world.attach(knots, fp3.circle(0.1))
    post = world.add(type="static", x=(0, 20))
    for i in range(side * side):
        if i % side:
            world.join("hinge", knots[i - 1], knots[i], anchor_a=(0.25, 0), anchor_b=(-0.25, 0))
        if i >= side:
            world.join("rod", knots[i - side], knots[i], hertz=8.0 if i % 3 else 0.0)
    for i in (0, side - 1):
        world.join("weld", post[0], knots[-1 - i], anchor_a=np.subtract(at[-1 - i], (0, 20)), anchor_b=(0, 0))
    ball = world.add(x=(6, 30))
    world.attach(ball, fp3.circle(1, density=100))
    return world, {}


def cubes(side=8, **how):
    """Towers in space that lean on each other, and balls that fall onto them."""
    world = fp3.Bodies(dimensions=3, **how)
    ground = world.add(type="static")
    world.attach(ground, fp3.plane())
    towers = world.add(x=[(1.01 * x + 0.02 * z, 0.5 + y, 1.01 * z) for x in range(side) for y in range(5) for z in range(side)])
    world.attach(towers, fp3.box(0.5, 0.5, 0.5))
    balls = world.add(x=[(2.0 * x, 6.5, 2.0 * z) for x in range(4) for z in range(4)], v=(0, -3, 1))
    world.attach(balls, fp3.sphere(0.4, restitution=0.5))
    return world, {}


def rods(count=90, side=12, **how):
    """Thin rods that turn far in a step are thrown onto hills, and a net of joints of all types hangs over them."""
    random = np.random.default_rng(2)
    world = fp3.Bodies(dimensions=3, **how)
    ground = world.add(type="static")
    world.heights(ground, 1.0, 1.0, 0.3 * random.random((24, 24)))
    thrown = world.add(x=np.column_stack([3 + 17 * random.random((count, 2)), 1 + 0.1 * np.arange(count)]), q=random.normal(size=(count, 4)),
                       spin=random.normal(size=(count, 3)) * 8, v=random.normal(size=(count, 3)))
    world.attach(thrown, fp3.box(1.0, 0.04, 0.04))
    knots = world.add(x=[(3.0 + x, 3.0 + y, 12.0) for y in range(side) for x in range(side)])
    world.attach(knots, fp3.sphere(0.2))
    kinds = ({"kind": "ball", "hertz": 2.0}, {"kind": "hinge", "axis": (0, 0, 1), "limits": (-1.0, 1.0)}, {"kind": "wheel", "axis": (0, 0, 1), "axle": (0, 1, 0), "hertz": 3.0},
             {"kind": "weld"}, {"kind": "slider", "axis": (1, 0, 0), "limits": (-0.2, 0.2)}, {"kind": "ball", "limits": (0.0, 0.4)})
    for i in range(side * side):
        more = dict(kinds[i % len(kinds)])
        if i % side:
            world.join(more.pop("kind"), knots[i - 1], knots[i], anchor_a=(0.5, 0, 0), anchor_b=(-0.5, 0, 0), **more)
        if i >= side:
            world.join("rod", knots[i - side], knots[i])
    return world, {}


def trace(make, steps, **how):
    """After each step who touches, what changed, and all bits; half way back to where it was before."""
    world, acts = make(**how)
    told = []
    for step in range(steps):
        if step in acts:
            acts[step]()
        if step == steps // 2:
            saved = world.save()
            world.step(3)
            world.restore(saved)
        world.step()
        told.append((world.hash, world.awake, world.touching, *(world.changes(what)["body_a"].tolist() for what in ("began", "ended", "hit"))))
    return told


def helpers():
    return len(os.listdir("/proc/self/task"))


@pytest.mark.parametrize("make, steps", [(pyramid, 30), (heap, 20), (net, 12), (cubes, 8), (rods, 10)])
def test_the_number_of_threads_changes_no_bit(make, steps):
    alone = trace(make, steps)
    for threads in (2, 3, 5):
        assert trace(make, steps, threads=threads) == alone, f"{threads} threads"


def test_there_are_as_many_threads_as_asked_for():
    before = helpers()
    small = floor(threads=3)
    small.attach(small.add(x=(0, 1)), BOX)
    small.step(10)
    assert helpers() == before        # nothing to do for another
    world, _ = pyramid(threads=3)
    world.step(2)
    assert helpers() == before + 2
    world.close()
    assert helpers() == before
    every, _ = pyramid(threads=0)
    every.step(2)
    assert helpers() == before + len(os.sched_getaffinity(0)) - 1
    every.close()


def in_child(world, do):
    """What do() returns in the child of a fork, which may use the world as a program in C may: fp3.Bodies refuses it."""
    read, write = os.pipe()
    child = os.fork()
    if not child:
        signal.alarm(20)
        try:
            world._pid = os.getpid()
            os.write(write, str(do()).encode())
        finally:
            os._exit(0)
    os.close(write)
    with os.fdopen(read) as told:
        text = told.read()
    assert os.waitpid(child, 0)[1] == 0
    return text


@pytest.mark.parametrize("nap", [0, 0.05])
def test_a_child_of_a_fork_goes_on_without_the_threads_of_its_parent(nap):
    """They look for work when the process forks, or sleep: the child waits for neither."""
    world, _ = pyramid(threads=3)

    def go_on():
        world.step(3)
        world.add(x=(0, 90))
        world.step()
        return world.hash

    def go_on_and_close():
        hashed, most = go_on(), helpers()
        world._lib.fp3_bodies_close(ctypes.byref(world._handle.pointer))
        return hashed, most, helpers()

    world.step(2)
    time.sleep(nap)
    assert in_child(world, go_on_and_close) == str((go_on(), 3, 1))
    world.close()


def test_threads_that_cannot_start_leave_their_parts_to_the_others():
    alone, _ = pyramid()
    alone.step(4)
    world, _ = pyramid(threads=64)

    def step_with_no_more_processes():
        if not os.getuid():  # for whom there is no such bound
            os.setuid(65534)
        resource.setrlimit(resource.RLIMIT_NPROC, (1, 1))
        world.step(4)
        with open("/proc/thread-self/stat") as stat:
            return world.hash, int(stat.read().rsplit(")")[1].split()[17])
    assert in_child(world, step_with_no_more_processes) == str((alone.hash, 1))


def test_a_file_is_opened_with_any_number(tmp_path):
    world, _ = pyramid(threads=2)
    world.step(4)
    world.checkpoint(tmp_path / "world.ck")
    again = fp3.Bodies.restart(tmp_path / "world.ck", threads=3)
    world.step(4)
    again.step(4)
    assert again.hash == world.hash


@pytest.mark.parametrize("threads, engine, message", [
    (-1, None, "threads"), (1025, None, "threads"), (1.5, None, "threads"), (2, "isa", "threads is 2, expected 1 with an engine"),
    (0, "fast", "threads is 0, expected 1 with an engine")])
def test_what_is_no_number_of_threads_is_refused(threads, engine, message):
    with pytest.raises(fp3.ArgumentError, match=message):
        fp3.Bodies(threads=threads, engine=engine)


def test_the_most_that_there_can_be():
    world = floor(threads=1024)
    world.attach(world.add(x=(0, 1)), BOX)
    world.step(2)
    world.close()


def test_no_two_threads_have_a_word_at_once(tmp_path):
    """By the thread sanitizer, for the threads alone; worlds under it are a matter of `--long`."""
    sources = [ROOT / path for path in ("tests/bodies/crew.c", "sw/base/threads.c", "sw/base/laps.c", "sw/base/status.c")]
    flags = ["-fsanitize=thread", "-std=c11", "-D_GNU_SOURCE", "-O1", "-g", "-pthread", "-ffp-contract=off", f"-I{ROOT}/sw", f"-I{ROOT}/sw/include"]
    subprocess.run(["gcc", *flags, *sources, "-o", tmp_path / "crew", "-lm"], check=True)
    for threads, rounds in ((1, 10), (2, 200), (3, 200), (7, 20)):
        done = subprocess.run([tmp_path / "crew", str(threads), str(rounds)], env={**os.environ, "LD_PRELOAD": ""}, capture_output=True, text=True, timeout=100)
        assert (done.returncode, done.stdout, done.stderr) == (0, "", ""), f"{threads} threads"


@pytest.mark.long
def test_worlds_under_the_thread_sanitizer(root):
    """The worlds above, of a plane and of space."""
    env = {name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL", "FP3_BUILD")}
    subprocess.run(["make", "-C", root, "SAN=thread", "build-tsan/lib/libfp3.so.0"], env=env, check=True, capture_output=True, timeout=3000)
    sanitizer = subprocess.run(["gcc", "-print-file-name=libtsan.so"], check=True, capture_output=True, text=True).stdout.strip()
    done = subprocess.run([sys.executable, "-m", "pytest", "-q", "-n0", __file__, "-k", "changes_no_bit"], capture_output=True, text=True, timeout=3000,
                          env={**env, "FP3_BUILD": str(root / "build-tsan"), "LD_PRELOAD": sanitizer})
    assert done.returncode == 0 and "5 passed" in done.stdout and "WARNING" not in done.stdout + done.stderr, done.stdout + done.stderr
