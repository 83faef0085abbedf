"""Logarithmic arithmetic: its model against MPFR for every input, and with bugs put in on purpose."""

import re
import subprocess

import pytest

INPUTS = {"sum": 2**28, "difference": 2**28 - 1, "from_float": 2**23, "to_float": 2**23, "to_float, subnormal": 2**23 - 1}
OPERATIONS = ["mul", "div", "add", "sub", "sqrt", "rsqrt", "rcp", "from_float", "to_float"]


def start(*command, **options):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=600, **options)


def test_every_input_is_within_the_bound(root, build):
    """All distances of two operands, all fractions of the converters; the page tells the same errors."""
    done = start(build / "tests/lns_certify")
    assert done.returncode == 0, done.stdout
    found = dict(re.findall(r"^(.+): (\d+) of \2 inputs checked", done.stdout, re.M))
    assert {name: int(count) for name, count in found.items()} == INPUTS
    page = (root / "docs/logarithmic.md").read_text(encoding="utf-8")
    for name, error in re.findall(r"^(.+): .* largest error (\d\.\d+) of", done.stdout, re.M):
        assert re.search(rf"^\| {name} \|.* {error} \|", page, re.M), f"{name}: {error}"


@pytest.mark.smoke
def test_operations_of_all_kinds_of_operands(build, long):
    done = start(build / "tests/lns_pairs", 10**6 if long else 20000)
    assert done.returncode == 0, done.stdout
    assert re.findall(r"^(\w+): .*: 0 wrong$", done.stdout, re.M) == OPERATIONS


# name, file, what is there once, the bug, the test that sees it
BUGS = [
    ("a coefficient is one too large", "sw/gen/logarithms.h", "{268435470, 262143, 2837, 5}", "{268435470, 262142, 2837, 5}", "lns_certify"),
    ("the pole's table is read at the wrong shift", "sw/machine/lns.c", "(int64_t)(n + 1) << 24", "(int64_t)(n + 2) << 24", "lns_certify"),
    ("the upper part of r is dropped", "sw/machine/lns.c", "r >> band & 0x3ffff", "r & 0x3ffff", "lns_certify"),
    ("a difference is not inverted", "sw/machine/lns.c", "sum = ~sum;", "sum = -sum + 32;", "lns_certify"),
    ("the sign is that of the first operand", "sw/machine/lns.c", "limited(big & SIGN,", "limited(a & SIGN,", "lns_pairs"),
    ("2x - x raises inexact", "sw/machine/lns.c", "subtract ? r == UINT32_C(1) << 23 : r == 0", "!subtract && r == 0", "lns_pairs"),
    ("a root is cut", "sw/machine/lns.c", "(twice + (twice >> 1 & 1)) >> 1", "twice >> 1", "lns_pairs"),
    ("2^-127 is a number", "sw/machine/lns.c", "if (n <= 0)", "if (n < 0)", "lns_pairs"),
]


@pytest.mark.parametrize("name, file, right, wrong, test", BUGS, ids=[row[0].replace(" ", "_") for row in BUGS])
def test_bug_is_found(root, tmp_path, name, file, right, wrong, test):
    for path in ("sw/machine/lns.c", "sw/gen/logarithms.h"):
        text = (root / path).read_text(encoding="utf-8")
        if path == file:
            assert text.count(right) == 1, f"{file} has this {text.count(right)} times, expected once: {right!r}; see BUGS"
            text = text.replace(right, wrong)
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text, encoding="utf-8")
    done = start("gcc", "-std=c11", "-D_GNU_SOURCE", "-O1", "-ffp-contract=off", "-I", tmp_path / "sw", "-I", root / "sw/include", "-I", root / "sw", "-I", root / "sw/machine",
                 root / f"tests/lns/{test}.c", tmp_path / "sw/machine/lns.c", "-o", tmp_path / test, "-lgsl", "-lgslcblas", "-lmpfr", "-lgmp", "-lm")
    assert done.returncode == 0, done.stderr
    assert start(tmp_path / test, 101).returncode == 1
