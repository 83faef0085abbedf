"""Checkpoints of bodies: the same bits as without a restart, and files that are cut off, damaged, of something else or made up are refused."""

import hashlib
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("FP3_BUILD", ROOT / "build"))
os.environ["FP3_HOME"] = str(BUILD)
sys.path.insert(0, str(ROOT / "python"))
if BUILD.name != "build" and "libasan" not in os.environ.get("LD_PRELOAD", ""):
    pytest.skip("sanitizers have to be there before Python", allow_module_level=True)
h5py = pytest.importorskip("h5py")

import fp3  # noqa: E402


def crowd():
    """Sleepers, a heap, joints with motors and limits, what may not turn, a chain, numbers that came and went, a force to come."""
    world = fp3.Bodies(gravity=(0, -10), size=0.5, rest_time=0.2)
    ground = world.add(type="static")
    world.chain(ground, [(8, 3), (7, 0), (-7, 0.2), (-8, 3)], friction=0.7)
    gone = world.add(x=[(20.0, 0.0), (22.0, 0.0)])
    world.attach(gone, fp3.circle(0.3))
    heap = world.add(x=[(0.7 * (k % 4), 0.7 + 0.8 * (k // 4)) for k in range(12)], angle=0.2 * np.arange(12))
    world.attach(heap[::2], fp3.box(0.3, 0.2, restitution=0.3))
    world.attach(heap[1::2], fp3.polygon([(0, 0.3), (-0.3, -0.2), (0.4, -0.2)], belt=0.1))
    world.attach(heap[5], fp3.circle(0.1, centre=(0.3, 0.2)))
    flat = world.add(x=[(-5, 0.4), (-5, 0.8)])
    world.attach(flat, fp3.box(0.4, 0.2))
    arm = world.add(x=[(-3, 2), (-2, 2)], v=(0, 1), damping=0.1, spin_damping=0.2)
    world.attach(arm, fp3.capsule((-0.4, 0), (0.4, 0), 0.1))
    joints = np.concatenate([world.join("hinge", ground, arm[0], anchor_a=(-3.4, 2), anchor_b=(-0.4, 0), speed=2.0, most=3.0),
                             world.join("weld", arm[0], arm[1], anchor_a=(0.5, 0), anchor_b=(-0.5, 0), hertz=4.0)])
    world.remove(gone[:1])
    world.step(60)
    world.write("force", heap[2], (1.0, 2.0))
    pair = world.contacts()[["body_a", "body_b"]][-1]
    world.join("rod", pair[0], pair[1])
    return world, np.concatenate([heap, flat]), joints


def test_a_restart_in_contact(tmp_path):
    """Bit by bit, with its handles, values and joints; engines and one more restart change nothing; what was there before stays as .1."""
    world, heap, joints = crowd()
    path = tmp_path / "w.ck"
    world.checkpoint(path)
    first = path.read_bytes()
    assert world.touching > 8 and world.awake < len(world)
    found, by_isa = fp3.Bodies.restart(path), fp3.Bodies.restart(path, engine="isa")
    assert found.hash == world.hash and found.time == world.time and found.awake == world.awake and found.touching == world.touching
    for name in ("x", "v", "angle", "w", "force", "mass", "inertia", "at_rest"):
        assert np.array_equal(found.read(name, heap), world.read(name, heap))
    assert np.array_equal(found.handles, world.handles) and found.contacts().tobytes() == world.contacts().tobytes()
    for k in range(80):
        for one in (world, found):
            one.step()
            if k == 15:
                one.write("v", heap[-1], (0, 1))  # wakes who sleeps with it
        assert found.hash == world.hash and np.array_equal(found.read_joint("torque", joints), world.read_joint("torque", joints))
        assert {change: found.changes(change).tobytes() for change in ("began", "ended", "hit")} == \
            {change: world.changes(change).tobytes() for change in ("began", "ended", "hit")}
        assert found.awake == world.awake
        if k == 5:
            by_isa.step(6)
            assert by_isa.hash == world.hash
        if k == 40:
            found.checkpoint(path)
            assert path.with_name("w.ck.1").read_bytes() == first
            found = fp3.Bodies.restart(path)
    assert np.array_equal(found.add(x=(0, 9)), world.add(x=(0, 9)))


def test_all_sleep(tmp_path):
    """The first step of what is opened has no contact to look at."""
    world = fp3.Bodies(rest_time=0.1)
    world.attach(world.add(type="static"), fp3.box(5, 1, centre=(0, -1)))
    box = world.add(x=(0, 0.5))
    world.attach(box, fp3.box(0.5, 0.5))
    world.step(60)
    world.checkpoint(tmp_path / "w.ck")
    found = fp3.Bodies.restart(tmp_path / "w.ck")
    for one in (world, found):
        one.step(3)
        one.write("v", box, (0, 1))
        one.step(30)
    assert world.awake == found.awake and found.hash == world.hash


def test_a_body_that_failed(tmp_path):
    """Its contacts have impulses that are no numbers."""
    world = fp3.Bodies()
    world.attach(world.add(type="static"), fp3.box(5, 1, centre=(0, -1)))
    boxes = world.add(x=[(0, 0.5), (0, 1.5)])
    world.attach(boxes, fp3.box(0.5, 0.5))
    world.step(5)
    world.write("mass", boxes[:1], 1e-36)
    world.write("force", boxes[:1], (1e12, 0))
    with pytest.raises(fp3.FailedError):
        world.step()
    world.checkpoint(tmp_path / "w.ck")
    found = fp3.Bodies.restart(tmp_path / "w.ck")
    for one in (world, found):
        one.write("mass", boxes[:1], 1)
        one.write("force", boxes[:1], (0, 0))
        one.step(30)
    assert found.hash == world.hash


def sealed(path):
    """With the sum of what it holds now, so that only what it holds can be refused."""
    data = path.read_bytes()
    step = data.split(b"\n")[1]
    head = b"fp3 checkpoint 1\n" + step + f"\nbytes {len(data) - 512}\nsha256 {hashlib.sha256(data[512:]).hexdigest()}\n".encode()
    path.write_bytes(head.ljust(512, b"\0") + data[512:])


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    path = tmp_path_factory.mktemp("bodies") / "w.ck"
    crowd()[0].checkpoint(path)
    return path.read_bytes()


@pytest.fixture
def refused(whole, tmp_path):
    """Why a file is refused."""
    path = tmp_path / "w.ck"

    def refused(data=None, change=None):
        path.write_bytes(whole if data is None else data)
        if change:
            with h5py.File(path, "r+") as file:
                change(file)
            sealed(path)
        with pytest.raises(fp3.ArgumentError) as why:
            fp3.Bodies.restart(path)
        assert str(why.value).startswith(f"{path}: ")
        return str(why.value)
    return refused


def test_a_file_that_is_not_whole(refused, whole, tmp_path):
    for size in (0, 10, 300, 512, 600, len(whole) // 2, len(whole) - 1):
        assert "cut off" in refused(whole[:size]) or size < 20
    rng = np.random.default_rng(1)
    for at in [5, 17, 30, 60, 512, len(whole) - 1, *rng.integers(0, len(whole), 60)]:
        data = bytearray(whole)
        data[at] ^= 1 << int(rng.integers(8))
        assert any(word in refused(bytes(data)) for word in ("damaged", "cut off", "no checkpoint", "version")), at
    assert "of version 7, and this fp3 reads version 1" in refused(whole.replace(b"checkpoint 1", b"checkpoint 7", 1))
    assert "no checkpoint" in refused(b"x,y\n1,2\n")
    with pytest.raises(fp3.ArgumentError, match="No such file"):
        fp3.Bodies.restart(tmp_path / "none.ck")


def put(name, value, at=...):
    def put(file):
        assert file[name][at].size
        file[name][at] = value
    return put


def attribute(name, value):
    return lambda file: file.attrs.modify(name, np.bytes_(value))


def without(name):
    def without(file):
        del file[name]
    return without


@pytest.mark.parametrize("change, told", [
    (put("bodies.first_shape", 1 << 30, 3), "'bodies'"), (put("bodies.type", 7, 3), "'bodies'"), (put("bodies.rest", -1.0), "'bodies'"),
    (put("bodies.at", np.nan, 3), "'bodies.at'"), (put("bodies.v", np.inf, 3), "'bodies.v'"), (put("bodies.generation", 2, 3), "'"),
    (put("shapes.next", 4, 4), "'bodies'"), (put("shapes.body", 1 << 31), "'shapes'"), (put("shapes.given.core.count", 9, -1), "'shapes'"),
    (put("shapes.shape.core.count", 0, -1), "'shapes'"), (put("touches.b", 0), "'touches'"), (put("touches.b", 1 << 31, -1), "'touches'"),
    (put("touches.m.count", 3, 0), "'touches'"), (put("touches.found.count", 3, 0), "'touches'"), (put("touches.points", 3, 0), "'touches'"),
    (put("joints.a", 1 << 20, 0), "'joints'"), (put("joints.def.type", 6, 0), "'joints'"), (put("joints.laws", 255, 0), "'joints'"),
    (put("world.free_body", 1 << 20), "'world'"), (put("world.steps", 7), "'world'"), (put("world.def.push", -1.0), "'world'"),
    (without("bodies.w"), "'bodies.w'"), (without("bodies.at"), "'"), (without("boxes.low"), "'boxes'"), (without("world.steps"), "'world.steps'"),
    (put("bodies.v", 3.0, 3), "do not have the hash"), (attribute("bodies", "2"), "of form 2"), (attribute("laws", "0" * 64), "laws of contacts and joints"),
    (lambda file: file.attrs.pop("bodies"), "not one of bodies")])
def test_a_file_that_was_made_up(refused, change, told):
    """Whole by its sum, but what it says cannot be."""
    assert told in refused(change=change)


@pytest.mark.parametrize("name, value", [("world.def.h", 0.0), ("world.def.substeps", 0), ("world.def.size", 1e30)])
def test_values_that_no_world_has(whole, tmp_path, name, value):
    path = tmp_path / "w.ck"
    path.write_bytes(whole)
    with h5py.File(path, "r+") as file:
        file[name][...] = value
    sealed(path)
    with pytest.raises(fp3.ArgumentError, match=f"{name.split('.')[-1]} is .*, expected"):
        fp3.Bodies.restart(path)


def test_more_rows_than_the_file_has_bytes(refused):
    def change(file):
        del file["touches.a"]
        file.create_dataset("touches.a", (1 << 31, 1), "<u4", chunks=(1024, 1))
    assert "'touches.a'" in refused(change=change)


def test_laws_of_ones_own(tmp_path):
    """They are part of what a checkpoint is of."""
    for text in (ROOT / "programs/bodies").glob("*2.ode"):
        (tmp_path / text.name).write_text(text.read_text() + "\n# mine\n")
    path, own = tmp_path / "w.ck", {"engine": "fast", "laws": str(tmp_path)}
    fp3.Bodies(**own).checkpoint(path)
    assert len(fp3.Bodies.restart(path, **own)) == 0
    with pytest.raises(fp3.ArgumentError, match="its laws"):
        fp3.Bodies.restart(path)


def test_what_cannot_be_written(whole, tmp_path):
    """What was there stays, also where the disk is full."""
    path = tmp_path / "w.ck"
    path.write_bytes(whole)
    world = fp3.Bodies.restart(path)
    os.mkfifo(tmp_path / "pipe")
    for wrong in (tmp_path / "none" / "w.ck", tmp_path, tmp_path / "pipe"):
        with pytest.raises(fp3.Error):
            world.checkpoint(wrong)
    text = f"""
import resource, signal, sys
sys.path.insert(0, {str(ROOT / 'python')!r})
import fp3
world = fp3.Bodies.restart({str(path)!r})
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))
try:
    world.checkpoint({str(path)!r})
except fp3.Error as why:
    print(why)
"""
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True)
    assert "w.ck: " in done.stdout
    assert path.read_bytes() == whole and sorted(one.name for one in tmp_path.iterdir()) == ["pipe", "w.ck"]
