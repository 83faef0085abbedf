"""Kanata logs of real runs: what the log counts is what the hardware counted."""

import collections
import re
import subprocess

import check
import pytest

# Program, configuration, schedulers, contexts, and how it is run.
RUNS = [("ship", "paper", 1, 1, ["--steps", "20"]),
        ("ship", "single", 1, 1, ["--steps", "20"]),
        ("ship_madd", "single", 1, 1, ["--steps", "20"]),
        ("ship_madd", "many", 1, 24, ["--steps", "3"]),
        ("ship", "many", 1, 24, ["--steps", "4", "--visit", "3", "--objects", "40"]),
        ("ship", "many", 1, 24, ["--steps", "2", "--objects", "3"]),
        ("ship_madd", "shared", 2, 24, ["--steps", "2"]),
        ("ship_madd", "array", 4, 24, ["--steps", "2", "--objects", "50"]),
        ("ship", "lanes", 1, 24, ["--steps", "2"]),
        ("ship_dual", "dual", 1, 30, ["--steps", "2"])]
UNIT_OF = {"add": "add", "sub": "add", "addh": "add", "addt": "add", "mul": "mul", "madd": "chain", "msub": "chain", "fmadd": "chain", "fmsub": "chain", "sleep": "sleep", "ld": "memory",
           "lds": "memory", "st": "memory"}


def start(*command, cwd):
    return subprocess.run([str(word) for word in command], cwd=cwd, capture_output=True, text=True, timeout=300)


@pytest.fixture
def run(root, fp3, tmp_path):
    """A run with --kanata: what the command said and the log's path."""
    def command(program, config, *options):
        image, log = tmp_path / "x.fp3", tmp_path / "x.kanata"
        assert start(fp3, "asm", f"programs/{program}.s", "-o", image, cwd=root).returncode == 0
        return start(fp3, "run", image, "-c", config, "--params", "programs/ship.cfg", *options, "--kanata", log,
                     cwd=root), log
    return command


def counters(done):
    return {name: int(number) for name, number in re.findall(
        r"^(cycles|retired|paired|issued_\w+|stall_\w+) +(\d+)$", done.stdout, re.M)}


def compare(log, counted, schedulers, contexts):
    found = check.read(log.read_text(), schedulers, contexts, 2 if counted["paired"] else 1)
    assert max(collections.Counter(one.issued for one in found).values()) <= schedulers + (counted["paired"] > 0)
    assert len({one.issued for one in found}) == counted["retired"] or schedulers > 1
    assert len(found) == counted["retired"] + counted["paired"] > 0
    issued = collections.Counter(UNIT_OF[one.label.split()[1]] for one in found)
    assert {name: issued[name] for name in set(UNIT_OF.values())} == {
        name: counted[f"issued_{name}"] for name in set(UNIT_OF.values())}
    assert max(one.ended for one in found) - found[0].issued <= counted["cycles"]
    return found


@pytest.mark.parametrize("program, config, schedulers, contexts, options", RUNS)
def test_the_log_counts_what_the_hardware_counted(run, program, config, schedulers, contexts, options):
    done, log = run(program, config, *options)
    assert done.returncode == 0, done.stderr
    found = compare(log, counters(done), schedulers, contexts)
    assert not any(one.flushed for one in found)
    objects = int(options[options.index("--objects") + 1]) if "--objects" in options else schedulers * contexts
    assert len({one.thread for one in found}) == min(objects, schedulers * contexts)
    assert all(re.search(r"object \d+: (\w+ = \S+ \(0x[0-9a-f]{8}\)|stored)", one.detail) for one in found)


def test_the_log_ends_with_the_values_that_the_run_printed(run):
    """Of each object the last v that the log shows is the one that was read back."""
    done, log = run("ship_madd", "many", "--steps", "3", "--objects", "8")
    last = {}
    for one in check.read(log.read_text(), 1, 24):
        for number, bits in re.findall(r"object (\d+): v = \S+ \((0x[0-9a-f]{8})\)", one.detail):
            last[number] = bits
    printed = re.findall(r"^v +\S+ +(0x[0-9a-f]{8}) +object (\d+)$", done.stdout, re.M)
    assert len(last) == 8 and last == {number: bits for bits, number in printed}


def test_objects_that_fall_asleep(run):
    """All do in the same step. What was on its way to issue is issued in vain, then the last part stores them."""
    done, log = run("ship_sleep", "many", "--steps", "12", "--objects", "30", "--set", "eps=0.0026", "--set", "slept=0")
    found = compare(log, counters(done), 1, 24)
    slept = {step for one in found for step in re.findall(r"slept = step (\d+) ", one.detail)}
    assert len(slept) == 1 and 1 < int(*slept) < 12
    vain = [one for one in found if one.flushed]
    assert vain and all(one.detail.endswith(": not executed, the object sleeps") for one in vain)
    for thread in range(24):
        mine = [one for one in found if one.thread == thread]
        ends = [i for i, one in enumerate(mine) if "slept = step" in one.detail]
        assert len(ends) == (2 if thread < 6 else 1)
        for end in ends:
            rest = mine[end + 1:]
            while rest and rest[0].flushed:
                rest.pop(0)
            stores = [one for one in rest[:3] if one.detail.endswith(": stored")]
            assert len(stores) == 3                       # v, s, slept


def test_a_run_that_is_stopped_has_its_log(run):
    done, log = run("ship_madd", "many", "--steps", "1000", "--cycle-limit", "2000")
    assert done.returncode == 1
    compare(log, counters(done), 1, 24)


def test_the_occupancy_adds_up(run):
    """The table of each scheduler, as it is printed."""
    done, _ = run("ship_madd", "array", "--steps", "2")
    tables = done.stdout.split("occupancy of scheduler ")[1:]
    assert len(tables) == 4
    for table in tables:
        rows = [re.split(r"  +", row.strip()) for row in table.splitlines()[1:]]
        shares = [row for row in rows if row[0].startswith(("issued_", "stall_"))]
        (cycles,) = [int(row[1]) for row in rows if row[0] == "cycles"]
        assert sum(int(row[1]) for row in shares) == cycles > 0
        assert sum(round(10 * float(row[2].split()[0])) for row in shares) == 1000
