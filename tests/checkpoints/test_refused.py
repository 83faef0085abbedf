"""What a restart refuses, and what is left of a checkpoint that cannot be written."""

import resource
import subprocess

import h5py
import pytest

STEPS = ("--steps", 40, "-e", "fast")


@pytest.fixture
def made(start, world, tmp_path):
    """Two generations of a cloth's checkpoint, after 40 and 30 steps."""
    start("run", *world("cloth"), *STEPS, "--checkpoint", "a.ck", "--checkpoint-every", 15)
    return tmp_path / "a.ck"


def flip(data, at):
    return data[:at] + bytes([data[at] ^ 4]) + data[at + 1:]


@pytest.mark.parametrize("change, told", [
    (lambda data: data[:20000], "cut off: 19488 of "), (lambda data: data[:600], "cut off: 88 of "), (lambda data: data[:300], "cut off: 0 of "),
    (lambda data: flip(data, 9000), "damaged"), (lambda data: flip(data, len(data) - 1), "damaged"), (lambda data: flip(data, 24), "damaged"),
    (lambda data: data + b"x", "damaged"), (lambda data: b"", "no checkpoint"), (lambda data: b"x,y\n1,2\n", "no checkpoint"),
    (lambda data: data.replace(b"checkpoint 1", b"checkpoint 7", 1), "of version 7, and this fp3 reads version 1"), (None, "No such file")])
def test_a_file_that_is_not_whole(start, world, made, change, told):
    data = made.read_bytes()
    made.unlink()
    if change:
        made.write_bytes(change(data))
    done = start("run", *world("cloth"), *STEPS, "--restart", made.name, code=2)
    assert done.stderr.startswith("fp3 run: a.ck: ") and told in done.stderr and done.stdout == ""
    assert done.stderr.endswith("; a.ck.1 is whole, after 30 steps\n")
    made.with_name("a.ck.1").write_bytes(b"x")
    assert "is whole" not in start("run", *world("cloth"), *STEPS, "--restart", made.name, code=2).stderr


def test_a_recording_is_no_checkpoint(start, world):
    start("run", *world("cloth"), *STEPS, "--output", "r.h5")
    assert "r.h5: no checkpoint" in start("run", *world("cloth"), *STEPS, "--restart", "r.h5", code=2).stderr


def test_another_run(start, root, world, made, tmp_path):
    scene = (root / "programs/world/cloth.scene").read_text().replace('"cloth.ode"', f'"{root}/programs/world/cloth.ode"')

    def told(text, *options):
        (tmp_path / "x.scene").write_text(text)
        return start("run", "--scene", "x.scene", "-e", "fast", *(options or ("--steps", 40)), "--restart", "a.ck", code=2).stderr

    assert scene.count("k = 10.0") == 1 and scene.count("steps = 8192;") == 1
    assert "its group 0 runs another program" in told(scene.replace("semi_implicit_euler", "verlet"))
    assert "other links between objects" in told(scene.replace("k = 10.0", "k = 11.0"))
    assert "a.ck: h is 0.0009765625 in the checkpoint and 0.00048828125 in this run" in told(scene.replace("steps = 8192;", "steps = 8192; h = 0.00048828125;"))
    assert "other start values" in told(scene.replace("origin = [0.0, 2.0, 0.0]", "origin = [0.0, 2.5, 0.0]"))
    assert "has 400 objects, and this run has 600" in told(scene.replace("[20, 20]", "[20, 30]"))
    assert "after 40 steps, and the whole run has 39" in told(scene, "--steps", 39)


def test_other_lifetimes_and_configurations(start, root, tmp_path):
    group = f'{{ program = "{root}/programs/kepler.ode"; objects = 3; gone = %d; }}'
    for name, gone in (("a", 50), ("b", 60)):
        (tmp_path / f"{name}.scene").write_text(f'config = "many_full"; engine = "fast"; steps = 40; groups = ( {group % gone} );\n')
    start("run", "--scene", "a.scene", "--checkpoint", "a.ck")
    assert "a.ck: its run began with other lifetimes" in start("run", "--scene", "b.scene", "--restart", "a.ck", code=2).stderr
    assert "of configuration 'many_full', and this run has 'shared_full'" in \
        start("run", "--scene", "a.scene", "-c", "shared_full", "--restart", "a.ck", code=2).stderr


def test_other_partners(start, tmp_path):
    """As many links, of as many objects and without fields: who is linked with whom is all that differs."""
    (tmp_path / "x.s").write_text(".state x y\n.temp ties n\nstep:\n    ld ties\n    add y, -0.0, 0.5\n    each ties\n    ldn n, x\n    add y, y, n\n    next\n"
                                  "    add x, x, 1.0\n    st x\n    st y\n")
    for name, pairs in (("one", "0,1\n2,3\n"), ("other", "0,2\n1,3\n")):
        (tmp_path / f"{name}.csv").write_text("a,b\n" + pairs)
    run = ("x.s", "-c", "world", "-e", "fast", "-N", 4, "--spread", "x=1:4", "--set", "y=0", "-n", 5)
    start("run", *run, "--links", "ties=one.csv", "--checkpoint", "a.ck", "--checkpoint-every", 3)
    assert start("run", *run, "--links", "ties=one.csv", "--restart", "a.ck.1").hash
    assert "a.ck.1: its run began with other links between objects" in start("run", *run, "--links", "ties=other.csv", "--restart", "a.ck.1", code=2).stderr


def test_a_part_that_cannot_be_cut(start, tmp_path):
    (tmp_path / "x.s").write_text(".state x\nfirst: add x, x, 1.0\nstep: add x, x, 1.0\n")
    run = ("x.s", "-e", "isa", "-c", "single", "--set", "x=0", "-n", 9, "--checkpoint", "a.ck")
    assert "cannot be split by checkpoints" in start("run", *run, "--checkpoint-every", 4, code=2).stderr
    assert start("run", *run).hash


def test_adaptive_steps(start, root):
    done = start("run", root / "programs/kepler.ode", "--tolerance", "1e-5", "--checkpoint", "a.ck", code=2)
    assert "objects choose their own steps" in done.stderr


def test_options(start, world):
    for options, told in ((("--checkpoint-every", 5), "expected --checkpoint FILE"), (("--checkpoint", "-"), "no regular file"),
                          (("--checkpoint", "/dev/null"), "no regular file"), (("--checkpoint", "/nonesuch/a"), "No such file"),
                          (("--checkpoint", "a.ck", "--output", "a.ck.1"), "are one file"), (("--checkpoint", "a\nb"), "line break")):
        assert told in start("run", *world("cloth"), *STEPS, *options, code=2).stderr, options


@pytest.mark.parametrize("bytes_most", [300, 5000, 30000])
def test_a_file_that_cannot_grow_leaves_the_one_before(command, world, made, tmp_path, bytes_most):
    before = made.read_bytes(), made.with_name("a.ck.1").read_bytes()
    words, environment = command("run", *world("cloth"), *STEPS, "--checkpoint", "a.ck")
    done = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=60,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (bytes_most, bytes_most)))
    assert done.returncode == 1 and "a.ck: cannot write: File too large" in done.stderr
    assert before == (made.read_bytes(), made.with_name("a.ck.1").read_bytes())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.ck", "a.ck.1"]


def test_the_file_before_is_kept(made):
    with h5py.File(made) as now, h5py.File(made.with_name("a.ck.1")) as before:
        assert (now.attrs["step"], before.attrs["step"]) == (40, 30)
