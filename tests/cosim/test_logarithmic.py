"""A configuration whose words are logarithms: the hardware and the fast engine against the isa engine, and numbers that go in and come out."""

import re
import subprocess

import pytest


@pytest.fixture
def run(fp3, tmp_path):
    def run(program, *options, status=0):
        path = tmp_path / "x.s"
        path.write_text(program)
        done = subprocess.run([fp3, "run", path, "-c", "log", *map(str, options)], capture_output=True, text=True, timeout=300)
        assert done.returncode == status, done.stdout + done.stderr
        return done.stdout + done.stderr

    return run


def value(out, name, of=0):
    return float(re.search(rf"^{name} +(\S+) +0x\w+ +object {of}$", out, re.M)[1])


@pytest.mark.parametrize("engine", ["isa", "fast", "rtl"])
def test_the_host_speaks_binary32(run, engine):
    """Start values, what all share, constants of the image, and what comes back; words of this arithmetic would be far off."""
    out = run(".state x\n.state y\n.shared k\nstep:\nmul x, x, k\nmadd y, x, 0.375, y\n", "-e", engine, "-N", 2, "-n", 3, "--all",
              "--set", "x=1.7", "--set", "y=-3", "--set", "k=-1.3")
    x, y = [1.7 * (-1.3) ** n for n in range(1, 4)], -3 + 0.375 * sum(1.7 * (-1.3) ** n for n in range(1, 4))
    for n in range(2):
        assert value(out, "x", n) == pytest.approx(x[-1], rel=4e-7) and value(out, "y", n) == pytest.approx(y, rel=4e-7)


@pytest.mark.parametrize("engine", ["isa", "fast", "rtl"])
def test_what_has_no_word_is_refused(run, engine):
    program = ".state x\n.shared k\nstep:\nadd x, x, {}\n"
    for x, k in (("1e-39", 1), (1, "1e-40")):  # what the host gives becomes 0
        assert value(run(program.format("k"), "-e", engine, "--set", f"x={x}", "--set", f"k={k}"), "x") == 1
    assert "the program's constant 1e-39 is nearer to 0" in run(program.format("1e-39"), "-e", engine, status=2)
    assert value(run(program.format("k"), "-e", engine, "--set", "x=inf", "--set", "k=1", status=3), "x") == float("inf")
    assert value(run(program.format("k"), "-e", engine, "--set", "x=6e-39", "--set", "k=0", "--all"), "x") == pytest.approx(6e-39, rel=1e-6)


@pytest.mark.parametrize("engine", ["isa", "fast", "rtl"])
def test_objects_sleep_and_wake(run, engine):
    """The word in which an object sleeps is the number of a step, on both sides."""
    program = ".state x\n.state s\nstep:\nadd x, x, -1.0\nsleep s, x, 0.25\n"
    out = run(program, "-e", engine, "-N", 1, "-n", 9, "--set", "x=5", "--all")
    assert abs(value(out, "x")) < 1e-6 and re.search(r"^s +5 ", out, re.M), out


@pytest.mark.parametrize("engine", ["isa", "rtl"])
def test_a_program_counts_its_steps_as_far_as_it_can(run, engine):
    program = ".state steps\n.state x\nstep:\nadd steps, steps, 1.0\nadd x, x, 0.5\n"
    out = run(program, "-e", engine, "-N", 1, "-n", 8192, "--set", "x=0")
    assert value(out, "steps") == pytest.approx(8192, abs=0.0625)
    assert "the program counts its steps in log, which ends at 8192" in run(program, "-e", engine, "-N", 1, "-n", 8193, "--set", "x=0", status=2)
    assert "'steps' is 9000, expected a whole number from -8192" in run(program, "-e", engine, "-N", 1, "-n", 1, "--set", "steps=9000", "--set", "x=0", status=2)
