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
    world.step()
    world.write("force", heap[2], (1.0, 2.0))
    pair = world.contacts()[["body_a", "body_b"]][-1]
    world.join("rod", pair[0], pair[1])
    return world, np.concatenate([heap, flat]), joints


def told(world):
    return {change: world.changes(change).tobytes() for change in ("began", "ended", "hit")}


def crowd3():
    """In space: hulls that are shared, a mesh, heights and a plane, each kind of joint, sleepers, what came and went, what rolls, bounces and is told alone."""
    world = fp3.Bodies(dimensions=3, gravity=(0, -10, 0), size=0.5, rest_time=0.1)
    ground = world.add(type="static")
    world.attach(ground, fp3.plane(centre=(0, -0.5, 0)))
    hill = world.add(type="static", x=(-6, -0.2, 6), q=(1, -1, 0, 0))           # z is up for heights
    world.heights(hill, 0.75, 1.0, 0.1 * np.random.default_rng(3).random((9, 17)), friction=0.8)
    valley = world.add(type="kinematic", x=(8, -0.2, 0))
    world.mesh(valley, [(-3, 0, -3), (3, 0, -3), (3, 0.5, 3), (-3, 0.5, 3), (0, -0.2, 0)], [(0, 4, 1), (1, 4, 2), (2, 4, 3), (3, 4, 0)])
    gone = world.add(x=[(20.0, 0.0, 0), (22.0, 0.0, 0)])
    world.attach(gone, fp3.sphere(0.3))
    heap = world.add(x=[(0.7 * (k % 4) - 1, 0.7 + 0.7 * (k // 4), 0.1 * k) for k in range(12)], q=[(1, 0.1 * k, 0, 0.2) for k in range(12)])
    world.attach(heap[::3], fp3.box(0.3, 0.2, 0.25, restitution=0.3, surface=(0, 0, 0.1)))
    world.attach(heap[1::3], fp3.hull([(0, 0.3, 0), (-0.3, -0.2, 0), (0.4, -0.2, 0.1), (0, 0, 0.3), (0, 0, 0)], rolling=0.02))
    world.attach(heap[2::3], fp3.capsule((-0.2, 0, 0), (0.2, 0, 0), 0.2))
    world.attach(heap[5], fp3.sphere(0.1, centre=(0.3, 0.2, 0)))
    world.attach(heap[6], fp3.sphere(0.5, is_sensor=True))
    flat = world.add(x=[(7, 0.4, 1), (-3, 0.4, 3), (-3, 0.8, 3), (-3.2, 1.2, 3)])
    world.attach(flat, fp3.box(0.4, 0.2, 0.3))
    still = world.add(x=[(-12, -0.25, 0), (-12, 0.25, 0), (-14, -0.25, 0)])
    world.attach(still, fp3.box(0.25, 0.25, 0.25))
    arm = world.add(x=[(-3 + k, 3, -3) for k in range(7)], damping=0.1, spin_damping=0.2, q=[(1, 0, 0.1 * k, 0) for k in range(7)], spin=(0, 0, 1))
    world.attach(arm, fp3.box(0.4, 0.1, 0.2, radius=0.05))
    ends = {"anchor_a": (0.5, 0, 0), "anchor_b": (-0.5, 0, 0)}
    joints = np.concatenate([
        world.join("hinge", ground, arm[0], anchor_a=(-3.5, 3, -3), anchor_b=(-0.5, 0, 0), axis=(0, 0, 1), speed=2.0, most=3.0),
        world.join("ball", arm[0], arm[1], limits=(0, 0.5), **ends), world.join("weld", arm[1], arm[2], hertz=4.0, **ends),
        world.join("slider", arm[2], arm[3], axis=(1, 0, 0.1), limits=(-0.2, 0.3), **ends),
        world.join("wheel", arm[3], arm[4], axis=(0, 1, 0), hertz=3, **ends), world.join("rod", arm[4], arm[5], **ends),
        world.join("weld", arm[5], arm[6], force=5.0, **ends)])
    world.remove(gone[:1])
    world.step(40)
    world.step()
    world.write("force", heap[2], (1.0, 2.0, 0.5))
    world.write("torque", heap[3], (0.1, 0.2, 0.5))
    pair = world.contacts()[["body_a", "body_b"]][-1]
    world.join("rod", pair[0], pair[1])
    assert np.any(world.read("at_rest", still) < 0) and len(np.unique(world.contacts()["body_a"])) > 4
    return world, np.concatenate([heap, flat, still, arm]), joints


@pytest.mark.parametrize("crowd, names", [(crowd, ("angle", "w")), (crowd3, ("q", "spin", "torque"))])
def test_a_restart_in_contact(tmp_path, crowd, names):
    """Bit by bit, with its handles, values and joints; engines and one more restart change nothing; what was there before stays as .1."""
    world, heap, joints = crowd()
    path = tmp_path / "w.ck"
    world.checkpoint(path)
    first = path.read_bytes()
    assert world.touching > 8 and world.awake < len(world)
    found, by_isa = fp3.Bodies.restart(path), fp3.Bodies.restart(path, engine="isa")
    assert found.hash == world.hash and found.time == world.time and found.awake == world.awake and found.touching == world.touching
    for name in ("x", "v", "force", "mass", "inertia", "at_rest", *names):
        assert np.array_equal(found.read(name, heap), world.read(name, heap))
    assert np.array_equal(found.handles, world.handles) and found.contacts().tobytes() == world.contacts().tobytes()
    assert told(found) == told(world)
    torque, up = ("torque_x", (0, 1, 0)) if "q" in names else ("torque", (0, 1))
    for k in range(80):
        for one in (world, found):
            one.step()
            if k == 15:
                one.write("v", heap[-1], up)  # wakes who sleeps with it
        assert found.hash == world.hash and told(found) == told(world)
        whole = joints[world.is_joined(joints)]
        assert np.array_equal(whole, joints[found.is_joined(joints)])
        assert np.array_equal(found.read_joint(torque, whole), world.read_joint(torque, whole))
        assert found.awake == world.awake
        if k == 5:
            by_isa.step(6)
            assert by_isa.hash == world.hash
        if k == 40:
            found.checkpoint(path)
            assert path.with_name("w.ck.1").read_bytes() == first
            found = fp3.Bodies.restart(path)
    assert np.array_equal(found.add(x=(0, *(9 * np.array(up[1:])))), world.add(x=(0, *(9 * np.array(up[1:])))))


@pytest.mark.parametrize("dimensions", [2, 3])
def test_what_a_removal_has_ended_is_told_after_a_restart(tmp_path, dimensions):
    """With the next step, as without it; and a state that was saved keeps it, too."""
    world = fp3.Bodies(dimensions=dimensions)
    up = np.eye(dimensions)[1]
    world.attach(world.add(type="static"), fp3.box(*[9, 1, 9][:dimensions], centre=-up))
    boxes = world.add(x=[0.5 * up, 0.5 * up + 3 * np.eye(dimensions)[0]])
    world.attach(boxes, fp3.box(*[0.5] * dimensions))
    world.step(5)
    world.step()
    world.remove(boxes[:1])
    world.checkpoint(tmp_path / "w.ck")
    found, state = fp3.Bodies.restart(tmp_path / "w.ck"), world.save()
    assert len(world.changes("ended")) == 1 and told(found) == told(world)
    world.step()
    found.step()
    assert len(world.changes("ended")) == 1 and told(found) == told(world)
    world.restore(state)
    world.step()
    assert told(found) == told(world) and found.hash == world.hash


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


@pytest.fixture(scope="module")
def whole3(tmp_path_factory):
    path = tmp_path_factory.mktemp("space") / "w.ck"
    crowd3()[0].checkpoint(path)
    return path.read_bytes()


@pytest.fixture
def refused(whole, whole3, tmp_path):
    """Why a file is refused."""
    path = tmp_path / "w.ck"

    def refused(data=None, change=None, is_space=False):
        path.write_bytes(data if data is not None else whole3 if is_space else whole)
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
    (without("bodies.w"), "'bodies.w'"), (without("bodies.at"), "'"), (without("boxes.low"), "'boxes.low'"), (without("world.steps"), "'world.steps'"),
    (put("bodies.v", 3.0, 3), "do not have the hash"), (attribute("bodies", "1"), "of form 1"), (attribute("laws", "0" * 64), "laws of contacts and joints"),
    (lambda file: file.attrs.pop("bodies"), "not one of bodies")])
def test_a_file_that_was_made_up(refused, change, told):
    """Whole by its sum, but what it says cannot be."""
    assert told in refused(change=change)


def no_ring(file):
    """Sleepers who are not behind one other each: to go around would not end."""
    asleep, behind = np.flatnonzero(file["bodies.rest"][:, 0] < 0), file["bodies.next_asleep"][...]
    assert len(asleep) > 1
    behind[asleep] = asleep[0]
    file["bodies.next_asleep"][...] = behind


@pytest.mark.parametrize("change, told", [
    (no_ring, "'bodies'"), (put("bodies.next_asleep", 5), "'bodies'"), (put("bodies.q", 2.0, 5), "'bodies'"), (put("bodies.axes", 0.0, 5), "'bodies'"),
    (put("bodies.spin", np.nan, 3), "'bodies.spin'"),
    (put("shapes.form", 99, 5), "shape 5 has none of its forms"), (put("bodies.type", 0, 0), "shape 0 has none of its forms"),
    (put("forms.type", 7, 0), "type is 0, expected FP3_SPHERE"), (put("forms.type", 3, 0), "type is 3, expected FP3_SPHERE"),
    (put("forms.radius", -1.0, 3), "radius"),
    (put("forms.corners", 1 << 30, 4), "more corners than there are"), (put("forms.triangles", 1 << 30, 1), "more corners than there are"),
    (put("corners.x", np.inf, 7), "'corners.x'"), (put("corners.x", 0.0), "on a line"), (put("triangles.corners", 1 << 30, 5), "triangle 5 has corner"),
    (put("touches.first_patch", 1 << 30, -1), "'patches'"), (put("touches.patches", 1 << 31, -1), "'patches'"), (put("touches.m.count", 3, 0), "'touches'"),
    (put("patches.a", 1 << 30), "'patches'"), (put("patches.m.count", 5), "'patches'"),
    (put("joints.def.type", 5, 0), "'joints'"), (put("joints.def.type", 7, 0), "'joints'"), (put("joints.laws", 16, 0), "'joints'"),
    (put("joints.def.a", 3, 0), "'joints'"), (put("joints.def.axle", 0.0, 1), "'joints'"),
    (put("world.told", 1 << 30), "'world'"), (put("world.def.dimensions", 4), "dimensions is 4, expected 2 to 3"),
    (put("world.def.dimensions", 2), "laws of contacts"),
    (without("bodies.q"), "'bodies.q'"), (without("forms.q"), "'forms.q'"), (without("shapes.form"), "'shapes.form'"), (without("patches.p"), "'patches.p'"),
    (without("forms.type"), "shape 0 has none of its forms"), (put("patches.p", 3.0, 0), "do not have the hash")])
def test_a_file_of_space_that_was_made_up(refused, change, told):
    assert told in refused(change=change, is_space=True)


@pytest.mark.parametrize("mutants", [30, pytest.param(6000, marks=pytest.mark.long)])
def test_random_numbers_in_a_file_are_refused_or_run(whole, whole3, tmp_path, mutants):
    """Whole by its sum: one number of one dataset is another. It is refused with the file's name, or the world makes steps, in which a body may fail."""
    path, rng, opened = tmp_path / "w.ck", np.random.default_rng(mutants), 0
    values = [0, 1, 2, 3, 7, 8, 255, 1 << 16, (1 << 31) - 1, 1 << 31, (1 << 32) - 1, -1, 0.5, 1e-30, 1e30, -1e30, np.nan, np.inf, -np.inf]
    for k in range(mutants):
        path.write_bytes(whole3 if k % 2 else whole)
        with h5py.File(path, "r+") as file:
            names = sorted(file)
            data = file[names[rng.integers(len(names))]]
            flat, value = data[...].ravel(), values[rng.integers(len(values))]
            if data.dtype.kind == "u":
                value = int(min(max(value, 0), np.iinfo(data.dtype).max)) if np.isfinite(value) else 5
            with np.errstate(over="ignore"):
                flat[rng.integers(len(flat))] = value
            data[...] = flat.reshape(data.shape)
        sealed(path)
        try:
            world = fp3.Bodies.restart(path)
        except fp3.ArgumentError as why:
            assert str(why).startswith(f"{path}: "), why
            continue
        opened += 1
        try:
            world.step(2)
        except fp3.FailedError as why:
            assert "finite" in str(why)
    assert mutants / 10 < opened < mutants


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
