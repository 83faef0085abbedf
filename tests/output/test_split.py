"""A run in parts is the same run: bits, steps, sleep, failures, counted steps; and it makes no visit too many."""

import re
import struct
import subprocess
import sys
import zlib

import pytest

WHERE = [("fast", "single_full"), ("fast", "many_full"), ("isa", "single_full"), ("rtl", "single_full"), ("isa", "many_full"), ("rtl", "many_full"), ("rtl", "array"), ("rtl", "shared_full")]


def which(engine, config, objects=3):
    return ("-e", engine, "-c", config, *(["-N", objects] if not config.startswith("single") else []))


@pytest.mark.parametrize("engine, config", WHERE)
@pytest.mark.parametrize("every", [1, 7, 20])
def test_the_bits_of_one_run(start, root, engine, config, every):
    for program, options in (("kepler.ode", ()), ("duffing.ode", ("-k",)), ("bouncing_ball.ode", ()), ("ship.s", ("--params", root / "programs/ship.cfg"))):
        if config == "array" and program != "ship.s":
            continue
        whole = start(program, *which(engine, config), *options, "-n", "22", output=None)
        split = start(program, *which(engine, config), *options, "-n", "22", "--every", every)
        assert split.printed() == whole.printed() and len(whole.printed()) >= 2
        assert split.counter("object_steps") == whole.counter("object_steps")
        # steps is counted along.
        if program == "duffing.ode":
            assert split.printed()["steps", 0][0] == "22"


@pytest.mark.parametrize("config", ["single_full", "many_full"])
def test_engines_agree_at_every_snapshot(start, config):
    texts = {engine: start("elastic_pendulum.ode", *which(engine, config), "-n", "30", "--every", "1").path.read_bytes()
             for engine in ("isa", "rtl", "fast")}
    assert texts["isa"] == texts["rtl"] == texts["fast"] and texts["isa"].count(b"\n") > 30


@pytest.mark.parametrize("engine, config", [("isa", "shared"), ("rtl", "shared"), ("fast", "shared")])
def test_who_sleeps_sleeps_in_the_same_step(start, root, engine, config):
    options = (*which(engine, config, 9), "--params", root / "programs/ship.cfg", "--set", "eps=2.4e-3", "--spread", "T=2.6e5:3.2e5", "-n", "200")
    whole = start("ship_sleep.s", *options, output=None)
    for every in (25, 99):
        split = start("ship_sleep.s", *options, "--every", every)
        assert split.printed() == whole.printed() and split.counter("object_steps") == whole.counter("object_steps")
        asleep = re.search("^asleep .*$", whole.stdout, re.M)[0]
        assert asleep in split.stdout and "9 of 9" not in asleep and "0 of 9" not in asleep
        # A row has the step from the first snapshot on that comes after it.
        slept = int(split.of(200, 2)["slept"])
        for row in split.rows:
            if row["object"] == "2":
                assert int(row["slept"]) == (slept if int(row["step"]) >= slept else 0)


@pytest.mark.parametrize("config", ["many_full", "array", "shared_full"])
def test_a_part_is_a_visit(start, root, config):
    """As many instructions as one run with visits of that length."""
    options = (*which("rtl", config, 50), "--params", root / "programs/ship.cfg", "-n", "60")
    for every, visit in ((20, 20), (20, 5), (7, 7)):
        one = start("ship_madd.s", *options, "--visit", visit, output=None)
        parts = start("ship_madd.s", *options, "--visit", visit, "--every", every)
        for name in ("issued_add", "issued_mul", "issued_chain", "issued_memory", "retired"):
            assert parts.counter(name) == one.counter(name), name
        assert parts.counter("cycles") < 1.1 * one.counter("cycles") + 200
        # Of each scheduler, and of all.
        rows = [int(n) for n in re.findall(r"^  cycles +(\d+) ", parts.stdout, re.M)]
        assert max(rows) <= parts.counter("cycles") <= sum(rows)


def test_one_object_executes_first_and_last_part_for_each_part(start, tmp_path):
    (tmp_path / "x.s").write_text(".state x y\n.temp t\nfirst: add t, 1.0, 0.0\nstep: add x, x, t\nlast: add y, x, x\n")
    for engine in ("isa", "rtl"):
        done = start("x.s", "-e", engine, "--set", "x=0", "--set", "y=0", "-n", "10", "--every", "3")
        assert done.counter("retired") == 10 + 4 * 2 and done.of(10)["y"] == "20"


@pytest.mark.parametrize("engine, config", [("isa", "single"), ("rtl", "many")])
@pytest.mark.parametrize("source", ["first: add x, x, 1.0\nstep: add x, x, 1.0\n", "step: add x, x, 1.0\nlast: add x, x, 1.0\n",
                                    "first: add t, -0.0, -0.0\nstep: add t, t, 1.0\n add x, t, 0.0\n"])
def test_a_run_that_cannot_be_split_is_refused(start, tmp_path, engine, config, source):
    (tmp_path / "x.s").write_text(".state x\n.temp t\n" + source)
    done = start("x.s", *which(engine, config), "--set", "x=0", "-n", "9", "--every", "3", code=2)
    assert "cannot be split by snapshots: after 4 steps 'x' is" in done.stderr and not done.path.exists() and done.stdout == ""
    # With a snapshot at its end alone it is one run.
    one = start("x.s", *which(engine, config), "--set", "x=0", "-n", "9", output=None)
    whole = start("x.s", *which(engine, config), "--set", "x=0", "-n", "9")
    assert whole.printed() == one.printed() and whole.of(9)["x"] == one.printed()["x", 0][0]


# ---- failures ----

GROWS = ".state x\n.param a\nstep: mul x, x, a\n"
WORDS = r"(object \d+ [^;]*); (\d+) of (\d+) objects failed"


@pytest.mark.parametrize("engine, config", [("isa", "single"), ("rtl", "single"), ("isa", "many"), ("rtl", "many"), ("rtl", "lanes"), ("fast", "many")])
@pytest.mark.parametrize("every", [1, 4, 6, 50])
def test_the_first_failure_of_all_parts_is_told(start, tmp_path, engine, config, every):
    (tmp_path / "x.s").write_text(GROWS)
    spread = ("--set", "a=2^20", "-n", "12", "--set", "x=1") if config == "single" else \
        ("-n", "12", "--set", "x=1", "--spread", "a=2:40000")
    whole = start("x.s", *which(engine, config, 9), *spread, code=3, output=None)
    split = start("x.s", *which(engine, config, 9), *spread, "--every", every, code=3)
    assert re.search(WORDS, split.stderr).groups() == re.search(WORDS, whole.stderr).groups()
    assert re.search("^failed .*$", split.stdout, re.M)[0] == re.search("^failed .*$", whole.stdout, re.M)[0]
    assert int(re.search(WORDS, whole.stderr)[2]) == (1 if config == "single" else 8)
    assert split.of(12, 0 if config == "single" else 8)["x"] == "inf"
    assert start("x.s", *which(engine, config, 9), *spread, "--every", every, "--allow-failures").stderr == ""


def test_many_failures_are_counted_once_and_fast(start, tmp_path):
    (tmp_path / "x.s").write_text(GROWS)
    done = start("x.s", "-c", "many", "-e", "fast", "-N", "200000", "--set", "x=1", "--spread", "a=2^10:2^21", "-n", "12", "--every", "2",
                 code=3, output="/dev/null")   # in minutes, if each is asked about in turn
    assert int(re.search(WORDS, done.stderr)[2]) == sum((2**10 + i * (2**21 - 2**10) / 199999)**12 >= 2**128 for i in range(200000))


@pytest.mark.parametrize("engine", ["isa", "rtl", "fast"])
def test_what_fails_in_the_middle_alone_is_a_failure(start, tmp_path, engine):
    # x is infinite after step 1 without an exception, and 1 again after step 2: min(inf, 1).
    (tmp_path / "x.s").write_text(".state x y\nstep: add x, y, 0.0\n mul y, 1.0, 1.0\n")
    options = ("-c", "single", "-e", engine, "--set", "x=1", "--set", "y=inf", "-n", "3")
    done = start("x.s", *options, "--every", "1", code=3)
    assert "object 0 before its first step: state y is infinite; 1 of 1" in done.stderr
    assert [row["x"] for row in done.rows] == ["1", "inf", "1", "1"]


@pytest.mark.parametrize("engine", ["isa", "rtl"])
def test_an_illegal_word_writes_nothing(start, tmp_path, engine, fp3):
    (tmp_path / "x.s").write_text(".state x\nstep: add x, x, 1.0\n add x, x, 1.0\n")
    subprocess.run([fp3, "asm", "x.s", "-o", "x.fp3"], cwd=tmp_path, check=True)
    words = list(struct.unpack("<%dI" % ((tmp_path / "x.fp3").stat().st_size // 4), (tmp_path / "x.fp3").read_bytes()))
    words[10] = 0xffffffff
    body = struct.pack("<%dI" % (len(words) - 1), *words[:-1])
    (tmp_path / "x.fp3").write_bytes(body + struct.pack("<I", zlib.crc32(body)))
    done = start("x.fp3", "-c", "single", "-e", engine, "--set", "x=0", "-n", "3", "--every", "1", code=2)
    assert not done.path.exists() and "word 1 is 0xffffffff, no instruction" in done.stderr
    assert not list(tmp_path.glob(".fp3-*"))


def test_logs_go_on_over_the_parts(start, root, tmp_path):
    done = start("ship.s", "--params", root / "programs/ship.cfg", "-c", "many", "-N", "8", "-n", "6", "--every", "2", "--kanata", "log", "--bus-log", "bus")
    check = subprocess.run([sys.executable, root / "tests/kanata/check.py", "log", "--schedulers", "1", "--contexts", "16"],
                           cwd=tmp_path, capture_output=True, text=True)
    assert check.returncode == 0 and f"{done.counter('retired')} instructions" in check.stdout, check.stdout + check.stderr
    assert len(re.findall("^h ", (tmp_path / "bus").read_text(), re.M)) == 3
