"""The proofs of the floating-point cores and the control modules, a test for each part of tests/formal/prove.py."""

import subprocess
import sys

import pytest

PARTS = ["add", "mutants", "mul", "fma", "cuts", "control", "scale"]

# What is asked for without --long, in place of the whole part.
SHORT = {
    "add in 9 bits": ["add", "--exp", "4", "--frac", "4"],
    "mutants in 12 bits": ["mutants", "--exp", "5", "--frac", "6", "--case", "seeded: sticky dropped"],
    "control": ["control", "--case", "^(?!pace, (16|24) |dual_pace, [39] |scoreboard, latencies 14|arbiter, [3-8] schedulers, patience 127"
                "|(rounds|loops), (?!world_keep$)|exchange, fabric$|fetch, world|host_port, world_keep|hub, (40|64) |fp_estimate|fp_(rint|exponent), cut 0|narrow, storage"
                "|axi_lite, 2.[24]|transfer,|master, 24|scoreboard, latencies (2 and 2|3 and 5|3 and 2|5 and 3|1 and 1, bypass (0, chain 0|1, chain 1))|seeded: (?!a (flag falls a cycle late|grant in)))"],
    "mul in 12 bits": ["mul", "--exp", "5", "--frac", "6"],
    "fma in 7 bits": ["fma", "--exp", "3", "--frac", "3", "--case", "^(?![23] zeros)"],
    "product": ["mul", "--case", "^(?!all pairs)"],
    "cuts in 12 bits": ["cuts", "--exp", "5", "--frac", "6", "--case", "0x7f$"],
    "scale": ["scale", "--case", "^(scale(, (truncated|finite))?$|cuts 0x1$|seeded: a tie)"],
}


def prove(root, build, part, *more):
    done = subprocess.run([sys.executable, str(root / "tests/formal/prove.py"), "--jobs", "1", "--only", part, *more,
                           "--results", str(build / f"results/prove-{part}.json")],
                          cwd=root, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]


@pytest.mark.parametrize("name", SHORT)
def test_much_is_proved(root, build, name):
    prove(root, build, *SHORT[name])


@pytest.mark.long
@pytest.mark.parametrize("part", PARTS)
def test_everything_is_proved(root, build, part):
    prove(root, build, part)


@pytest.mark.long
@pytest.mark.parametrize("mode", ["--flush", "--truncate"])
def test_cuts_are_proved_in_other_modes(root, build, mode):
    prove(root, build, "cuts", "--exp", "5", "--frac", "6", "--cuts-add", "0x7f,0x6e", "--cuts-mul", "0x7f,0x2b", mode)


@pytest.mark.long
@pytest.mark.parametrize("fraction", ["15", "18"])
def test_fewer_fraction_bits_are_proved(root, build, fraction):
    prove(root, build, "add", "--only", "mul", "--frac", fraction)


@pytest.mark.long
@pytest.mark.parametrize("part", ["add", "mul"])
def test_cells_arithmetic_is_proved(root, build, part):
    prove(root, build, part, "--cell")


@pytest.mark.long
def test_bfloat16_is_proved(root, build):
    prove(root, build, "add", "--only", "mul", "--exp", "8", "--frac", "7")
