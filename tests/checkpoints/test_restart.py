"""A run that goes on from a checkpoint has the bits of one that was never cut off, on any engine and any number of ranks."""

import csv
import hashlib
import re
import struct
import time

import h5py
import pytest

LIVES = """config = "many_full"; steps = 60;
groups = ( { program = "PROGRAMS/kepler.ode"; objects = 24; spread = { v_y = [0.6, 1.2]; }; born = [0, 46]; gone = [30, 76]; } );
"""
SLEEP = ("--params", "PROGRAMS/ship.cfg", "--set", "eps=2e-3", "--spread", "T=2e5:4e5", "-N", 6, "-c", "shared", "PROGRAMS/ship_sleep.s", "-n", 700)


def spelled(root, options):
    return [str(option).replace("PROGRAMS", str(root / "programs")) for option in options]


@pytest.fixture
def lives(root, tmp_path):
    (tmp_path / "lives.scene").write_text(LIVES.replace("PROGRAMS", str(root / "programs")))
    return ("--scene", "lives.scene")


def digest(words):
    return hashlib.sha256(words).digest()


def contents(path):
    """All but what says where the run was made."""
    with h5py.File(path) as file:
        return ({name: data[()].tobytes() for name, data in file.items()},
                {name: value for name, value in file.attrs.items() if name not in ("engine", "command")})


def agree(start, folder, run, every, others, engine="fast"):
    """Cut at a checkpoint in the middle; each of the others (engine, ranks) goes on from there."""
    whole = start("run", *run, "-e", engine, "--checkpoint", "a.ck", "--checkpoint-every", every)
    assert whole.hash and whole.chain
    for engine_of, on in others:
        done = start("run", *run, "-e", engine_of, "--restart", "a.ck.1", "--checkpoint", "b.ck", "--checkpoint-every", every, on=on)
        assert (done.hash, done.chain) == (whole.hash, whole.chain), (engine_of, on)
        assert contents(folder / "b.ck") == contents(folder / "a.ck"), (engine_of, on)
    return whole


@pytest.mark.smoke
@pytest.mark.parametrize("name", ["cloth", "balls", "stars"])
def test_objects_that_see_each_other(start, world, ranks, name, tmp_path):
    """Links, those that are near, and all."""
    agree(start, tmp_path, (*world(name), "--steps", 40), 15, [("isa", 1), *(("fast", on) for on in ranks)])


@pytest.mark.parametrize("name", ["cloth", "balls", "stars"])
def test_births_and_ends_among_objects_that_see_each_other(start, root, name, tmp_path):
    text = (root / f"programs/world/{name}.scene").read_text().replace('"' + name, f'"{root}/programs/world/{name}')
    for change in (("[20, 20]", "[9, 9]"), ("objects = 300", "objects = 80"), ("integrator", "born = [0, 30]; gone = [20, 60]; integrator")):
        text = text.replace(*change)
    (tmp_path / "x.scene").write_text(text)
    run = ("--scene", "x.scene", "--steps", 40)
    whole = agree(start, tmp_path, run, 15, [("isa", 1), ("fast", 1)])
    assert start("run", *run, "-e", "rtl", "--restart", "a.ck.1").hash == whole.hash
    assert re.search(r"^alive +\d\d of 8., 0 not born yet, [34]\d gone$", whole.stdout, re.M), whole.stdout
    (tmp_path / "x.scene").write_text(text.replace("[0, 30]", "[0, 29]"))
    assert "lifetimes" in start("run", *run, "-e", "fast", "--restart", "a.ck.1", code=2).stderr


@pytest.mark.parametrize("name, steps", [("pyramid", 60), ("plastic", 40), ("breaking", 40)])
def test_what_pairs_remember(start, world, name, steps, tmp_path):
    """Of near objects, of another kind, of links. The hash has it, too."""
    run = (*world(name), "--steps", steps)
    whole = agree(start, tmp_path, run, steps // 2 + 3, [("isa", 1), ("fast", 1)])
    assert start("run", *run, "-e", "rtl", "--restart", "a.ck.1").hash == whole.hash
    assert "agrees" in start("verify", "a.ck", "-e", "isa").stdout
    with h5py.File(tmp_path / "a.ck") as file:
        step, words = int(file.attrs["step"]), b""
        for name in sorted((name for name in file if name.startswith("words:")), key=lambda name: int(name[6:])):
            pairs = sorted((int(at.split(":")[2]), file[at][()]) for at in file if at.startswith(f"pairs:{name[6:]}:"))
            words += file[name][()].astype("<u4").tobytes() + b"".join(struct.pack("<I", len(p)) + p.astype("<u4").tobytes() for _, p in pairs)
        assert digest(struct.pack("<Q", step) + words).hex() == file.attrs["hash"]


DROPS = """model drops
state x[2] = (0, 0)
state v[2] = (0, 0)
kind plates(x[2])
links ties(k = 8)
near rests(x, plates.x, 0.3, s = 0)
step 0.0078125
x' = v
v' = sum(o in ties: o.k*(o.x - x)) + sum(o in rests: (15 + o.s)*(x - o.x)) - v
remember o in rests: o.s = o.s + h
rest when norm(v) < 30 for 0.0625
"""
PLATES = """model plates
state x[2] = (0, 0)
state v[2] = (0, 0)
step 0.0078125
x' = v
v' = 0*v
"""


def test_who_sleeps_beside_one_that_is_not_born_yet(start, tmp_path):
    """What a restart writes touches nobody, and nobody has just gone: who sleeps at the checkpoint sleeps on."""
    (tmp_path / "drops.ode").write_text(DROPS)
    (tmp_path / "plates.ode").write_text(PLATES)
    (tmp_path / "ties.csv").write_text("a,b\n0,1\n2,3\n0,5\n")
    (tmp_path / "x.scene").write_text("""config = "world"; steps = 60; groups = (
        { program = "drops.ode"; integrator = "semi_implicit_euler"; objects = 6; spread = { x_x = [0, 1]; v_y = [0.1, 0.2]; };
          links = { relation = "ties"; file = "ties.csv"; }; born = [0, 50]; },
        { program = "plates.ode"; integrator = "semi_implicit_euler"; objects = 3; spread = { x_x = [0.1, 0.9]; }; } );
""")
    run = ("--scene", "x.scene")
    agree(start, tmp_path, run, 40, [("isa", 1), ("fast", 1)])
    with h5py.File(tmp_path / "a.ck.1") as file:
        assert struct.pack("<f", -1) in [word.tobytes() for word in file["words:0"][()].ravel()]  # somebody sleeps


def test_sleepers_keep_their_steps(start, root, tmp_path):
    run = spelled(root, SLEEP)
    whole = agree(start, tmp_path, run, 400, [("isa", 1), ("fast", 1), ("rtl", 1)])
    done = start("run", *run, "-e", "isa", "--restart", "a.ck.1")
    asleep = re.compile(r"^(asleep .*|slept .*|flags .*)$", re.M)
    assert asleep.findall(done.stdout) == asleep.findall(whole.stdout) and "since steps" in done.stdout


def test_groups(start, root, ranks, tmp_path):
    agree(start, tmp_path, ("--scene", root / "programs/fleet.scene", "--steps", 40), 15, [("isa", 1), ("rtl", 1), ("fast", ranks[-1])])


def test_lifetimes(start, lives, ranks, tmp_path):
    whole = agree(start, tmp_path, lives, 21, [("isa", 1), ("fast", ranks[-1])])
    assert start("run", *lives, "-e", "rtl", "--restart", "a.ck.1").hash == whole.hash
    assert re.search(r"^alive +8 of 24, 0 not born yet, 16 gone$", whole.stdout, re.M)


def test_one_object_without_a_store(start, root, tmp_path):
    agree(start, tmp_path, (root / "programs/double_spring.ode", "-n", 100, "-k"), 40, [("isa", 1), ("rtl", 1)], "isa")


def test_cuts_change_no_bit(start, world):
    """Of a state the hash is the same however often the run was cut, its chain is another."""
    run = (*world("balls"), "--steps", 60, "-e", "fast", "--checkpoint", "a.ck")
    one, many = start("run", *run), start("run", *run, "--checkpoint-every", 7)
    assert one.hash == many.hash and one.chain != many.chain


def test_failures_are_not_forgotten(start, tmp_path):
    """Of what failed before the checkpoint the restarted run knows."""
    (tmp_path / "x.s").write_text(".state x\n.param a\nstep: mul x, x, a\n")
    run = ("x.s", "-c", "many", "-e", "fast", "-N", 9, "--set", "x=1", "--spread", "a=2:40000", "-n", 12, "--checkpoint", "a.ck", "--checkpoint-every")
    first = start("run", *run, 11, code=3)
    before = contents(tmp_path / "a.ck")
    again = start("run", *run, 11, "--restart", "a.ck.1", code=3)
    assert again.stderr == first.stderr and "object 4 in step 9: overflow; 8 of 9" in first.stderr and again.hash == first.hash
    assert contents(tmp_path / "a.ck") == before and any(before[0]["status"])
    flags = re.compile(r"^flags .*$", re.M)
    assert flags.findall(again.stdout) == flags.findall(first.stdout)


def test_a_failure_before_the_first_step_stays_one(start, tmp_path):
    (tmp_path / "x.s").write_text(".state x\nstep: add x, x, 1.0\n")
    run = ("x.s", "-c", "many", "-e", "isa", "-N", 3, "--set", "x=nan", "-n", 9)
    first = start("run", *run, "--checkpoint", "a.ck", "--checkpoint-every", 5, code=3)
    assert "object 0 before its first step: state x is NaN" in first.stderr
    assert start("run", *run, "--restart", "a.ck.1", code=3).stderr == first.stderr


def test_failures_of_groups_are_told_apart(start, root, tmp_path):
    (tmp_path / "x.s").write_text(".state x\n.param a\nstep: mul x, x, a\n")
    group = '{ program = "x.s"; objects = 3; set = { x = 1.0; a = %s; }; }'
    (tmp_path / "x.scene").write_text('config = "shared"; engine = "isa"; steps = 12;\ngroups = ( %s, %s );\n' % (group % "2.0", group % "1e5"))
    whole = start("run", "--scene", "x.scene", code=3)
    parts = start("run", "--scene", "x.scene", "--checkpoint", "a.ck", "--checkpoint-every", 5, code=3)
    told = re.compile(r"^(?:failed|group|object_steps) .*$", re.M)
    assert told.findall(parts.stdout) == told.findall(whole.stdout) and parts.stderr == whole.stderr
    assert re.findall(r"^failed +3 of 3, first object 3 in step 8: overflow$", parts.stdout, re.M)


# ---- recordings ----

def test_equal_runs_write_equal_files(start, world, tmp_path):
    """Made in different seconds: no time of day is in them."""
    run = (*world("cloth"), "--steps", 20, "-e", "fast", "--every", 10, "--checkpoint", "a.ck")
    made = []
    for is_first in (True, False):
        start("run", *run, "--output", "a.h5", "--compress")
        made.append([(tmp_path / name).read_bytes() for name in ("a.ck", "a.h5")])
        if is_first:
            time.sleep(1.05 - time.time() % 1)
    assert made[0] == made[1]


def test_a_recording_begins_at_the_restart(start, world, tmp_path):
    run = (*world("cloth"), "--steps", 50, "-e", "fast", "--every", 20)
    start("run", *run, "--checkpoint", "a.ck", "--checkpoint-every", 30, "--output", "all.csv")
    start("run", *run, "--restart", "a.ck.1", "--output", "rest.csv")
    whole, rest = (list(csv.reader(open(tmp_path / name, newline="", encoding="ascii"))) for name in ("all.csv", "rest.csv"))
    assert rest == whole[:1] + [row for row in whole[1:] if int(row[0]) >= 30] and {row[0] for row in rest[1:]} == {"40", "50"}


def test_a_recording_goes_on_with_the_chain_of_the_checkpoint(start, world, tmp_path):
    run = (*world("cloth"), "--steps", 50, "-e", "fast")
    start("run", *run, "--checkpoint", "a.ck", "--checkpoint-every", 30)
    start("run", *run, "--restart", "a.ck.1", "--every", 20, "--output", "rest.h5")
    with h5py.File(tmp_path / "rest.h5") as rest, h5py.File(tmp_path / "a.ck.1") as checkpoint:
        assert rest.attrs["hash:before"] == checkpoint.attrs["chain"] and list(rest["step"]) == [40, 50]


# ---- anyone can make the hashes again ----

def test_hashes_are_those_of_the_words(start, world, tmp_path):
    """As docs/checkpoints.md defines them, from the file alone."""
    done = start("run", *world("balls"), "--steps", 25, "-e", "fast", "--checkpoint", "a.ck", "--checkpoint-every", 10)
    chain, blocks = bytes(32), {}
    for name in ("a.ck.1", "a.ck"):
        data = (tmp_path / name).read_bytes()
        assert data[:512].rstrip(b"\0").decode().split("\n")[3] == "sha256 " + hashlib.sha256(data[512:]).hexdigest()
        with h5py.File(tmp_path / name) as file:
            step = int(file.attrs["step"])
            blocks[step] = digest(struct.pack("<Q", step) + file["words:0"][()].astype("<u4").tobytes())
            assert blocks[step].hex() == file.attrs["hash"]
            if chain != bytes(32):
                assert file.attrs["before"] == chain.hex()
            chain = digest(bytes.fromhex(file.attrs["before"]) + blocks[step])
            assert chain.hex() == file.attrs["chain"]
            x = file["words:0"][()][list(file["registers:0"][()]).index(0)].view("f4")
            assert len(x) == 300 and abs(x).max() < 10
    assert sorted(blocks) == [20, 25] and (done.hash, done.chain) == (blocks[25].hex(), chain.hex())


@pytest.mark.parametrize("config", ["log", "bfloat", "many_half"])
def test_words_that_are_no_floats(start, root, tmp_path, config):
    """A checkpoint has the machine's words: logarithms would lose digits as floats."""
    run = (root / "programs/kepler.ode", "-c", config, "-N", 9, "--spread", "v_y=0.8:1.2", "-n", 20)
    agree(start, tmp_path, run, 6, [("isa", 1), ("fast", 1)], engine="isa")
