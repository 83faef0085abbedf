"""Logarithmic arithmetic: its model against MPFR for every input, its hardware against the model, and both with bugs put in on purpose."""

import re
import subprocess

import pytest

from bugs import Bug, few, source

INPUTS = {"sum": 2**28, "difference": 2**28 - 1, "from_float": 2**23, "to_float": 2**23, "to_float, subnormal": 2**23 - 1, "rcp": 2**23,
          "rcp from 2^126": 2**23, "rcp from 2^127": 2**23, "rsqrt, exponent even": 2**23, "rsqrt, exponent odd": 2**23}
UNITS = ["add", "sub", "mul", "div", "sqrt", "rsqrt", "from_float", "to_float", "float_rcp", "float_rsqrt"]
OPERATIONS = ["mul", "div", "add", "sub", "sqrt", "rsqrt", "rcp", "from_float", "to_float", "float_rcp", "float_rsqrt"]


def start(*command, **options):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=600, **options)


def test_inputs_are_within_the_bound(build):
    """A sixteenth of what the next test looks at."""
    done = start(build / "tests/lns_certify", 16)
    found = dict(re.findall(r"^(.+): (\d+) of \d+ inputs checked", done.stdout, re.M))
    assert done.returncode == 0 and set(found) == set(INPUTS) and all(int(found[name]) > INPUTS[name] / 17 for name in INPUTS), done.stdout


@pytest.mark.long
def test_every_input_is_within_the_bound(root, build):
    """All distances of two operands, all fractions of the converters; the page tells the same errors."""
    done = start(build / "tests/lns_certify")
    assert done.returncode == 0, done.stdout
    found = dict(re.findall(r"^(.+): (\d+) of \2 inputs checked", done.stdout, re.M))
    assert {name: int(count) for name, count in found.items()} == INPUTS
    page = (root / "docs/logarithmic.md").read_text(encoding="utf-8")
    for name, error in re.findall(r"^(.+): .* largest error (\d\.\d+) of", done.stdout, re.M):
        assert re.search(rf"^\| {re.escape(name)} \|.* {error} \|", page, re.M), f"{name}: {error}"


@pytest.mark.smoke
def test_operations_of_all_kinds_of_operands(build, long):
    done = start(build / "tests/lns_pairs", 10**6 if long else 20000)
    assert done.returncode == 0, done.stdout
    assert re.findall(r"^(\w+): .*: 0 wrong$", done.stdout, re.M) == OPERATIONS


def passes(done):
    return done.returncode == 0 and re.findall(r"^(\w+): .*[1-9]\d* random pairs.*: 0 mismatches$", done.stdout, re.M) == UNITS


def test_hardware(build, long):
    """Every operation: all pairs of special words, and 3*10^5 random pairs (10^7)."""
    done = start(build / "tests/lns_rtl", 10**7 if long else 3 * 10**5)
    assert passes(done), done.stdout


# name, file, what is there once, the bug, the test that sees it
BUGS = [
    ("a coefficient is one too large", "sw/gen/logarithms.h", "{268435470, 262143, 2837, 5}", "{268435470, 262142, 2837, 5}", "lns_certify"),
    ("the pole's table is read at the wrong shift", "sw/machine/lns.c", "(int64_t)(n + 1) << 24", "(int64_t)(n + 2) << 24", "lns_certify"),
    ("the upper part of r is dropped", "sw/machine/lns.c", "r >> band & 0x3ffff", "r & 0x3ffff", "lns_certify"),
    ("a difference is not inverted", "sw/machine/lns.c", "sum = ~sum;", "sum = -sum + 32;", "lns_certify"),
    ("the sign is that of the first operand", "sw/machine/lns.c", "limited(big & SIGN,", "limited(a & SIGN,", "lns_pairs"),
    ("2x - x raises inexact", "sw/machine/lns.c", "subtract ? r == UINT32_C(1) << 23 : r == 0", "!subtract && r == 0", "lns_pairs"),
    ("a root is cut", "sw/machine/lns.c", "(twice + (twice >> 1 & 1)) >> 1", "twice >> 1", "lns_pairs"),
    ("an inverse is cut", "sw/machine/lns.c", "(8 - log) >> 4", "-log >> 4", "lns_certify"),
    ("a reciprocal below 2^-127 is rounded as one above", "sw/machine/lns.c", "(32 << -e)", "32", "lns_certify"),
    ("a subnormal number is not normalised", "sw/machine/lns.c", "m << zeros & 0x7fffff", "m & 0x7fffff", "lns_pairs"),
    ("2 is taken for a power of four", "sw/machine/lns.c", "logarithm(a, &log) && !(log & WHOLE)", "logarithm(a, &log)", "lns_pairs"),
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


# Bugs of one model together, where it shows which unit has one: the operations that must fail, and no others.
HARDWARE_BUGS = [
    ({"sub", "add", "div", "sqrt", "rsqrt", "from_float", "to_float", "float_rcp", "float_rsqrt"}, [
        Bug("a difference without its logarithm", "fp3_lns_add.v", "{whole, log}", "{whole, 28'd0}"),
        Bug("a quotient is out by one", "fp3_lns_mul.v", "22'd0, divide_i}", "22'd0, 1'b0}"),
        Bug("a root's tie goes up", "fp3_lns_root.v", "a_i[0] && a_i[1]", "a_i[0]"),
        Bug("a subnormal number is not moved", "fp3_lns_from_float.v", "{a_i[21:0], 2'b00}", "{a_i[22:0], 1'b0}"),
        Bug("an inverse is not rounded", "fp3_lns_inverse.v", "5'd17 : 5'd9", "5'd1 : 5'd1"),
        Bug("a subnormal result is rounded as others", "fp3_lns_to_float.v", "is_tiny ? power_q[5] : power_q[4]", "power_q[4]")]),
    ({"sub", "add", "float_rcp"}, [
        Bug("a near difference is inverted", "fp3_lns_add.v", "minus_q && !near, nan", "minus_q, nan"),
        Bug("a reciprocal below 2^-127 is packed as one above", "fp3_lns_inverse.v", "e[9] ? {10'd1, power_q[27:13]} : ", "")]),
    ({"sub", "add", "float_rcp", "float_rsqrt"}, [
        Bug("a step of the shift is forgotten", "fp3_lns_add.v", "~{1'b0, upper_q, by4", "~{2'b00, upper_q[0], by4"),
        Bug("the last step of the shift is forgotten", "fp3_lns_inverse.v", "upper_q, by4, by2, by1};", "upper_q, by4, by2, 1'b0};")]),
    ({"sub", "add", "float_rsqrt"}, [
        Bug("overflow of a sum without inexact", "fp3_lns_add.v", "is_inexact_q || over ||", "is_inexact_q ||"),
        Bug("a root of 2 is exact", "fp3_lns_inverse.v", "!(root && !whole_q[0])", "1'b1")]),
]


@pytest.mark.parametrize("wrong, bugs", few((bugs[0].name.replace(" ", "_"), wrong, bugs) for wrong, bugs in HARDWARE_BUGS))
def test_hardware_bugs_are_found(root, build, tmp_path, wrong, bugs):
    for bug in bugs:
        (tmp_path / bug.file).write_text(bug.put(source(root, bug.file).read_text(encoding="utf-8")), encoding="utf-8")
    done = start("verilator", "--cc", "-Wno-lint", "-y", tmp_path, "-y", "tests/lns", "-f", "rtl/fp3.f", "--top-module", "lns_bench", "--Mdir", tmp_path / "cc",
                 "tests/lns/lns_bench.v", cwd=root)
    assert done.returncode == 0, done.stderr
    # One file, unoptimised: the shortest way to a program that runs for a tenth of a second.
    files = [*sorted((tmp_path / "cc").glob("*.cpp")), root / "sim/lns_bench_shim.cpp"]
    (tmp_path / "all.cc").write_text("".join(f'#include "{file}"\n' for file in files))
    verilator = start("verilator", "--getenv", "VERILATOR_ROOT").stdout.strip() + "/include"
    done = start("gcc", "-std=c11", "-D_GNU_SOURCE", "-c", "-I", root / "sim", "-I", root / "sw/include", "-I", root / "sw", root / "tests/lns/lns_rtl.c",
                 "-o", tmp_path / "lns_rtl.o")
    assert done.returncode == 0, done.stderr
    done = start("g++", "-std=c++17", "-O0", "-I", tmp_path / "cc", "-I", root / "sim", "-isystem", verilator, tmp_path / "all.cc", tmp_path / "lns_rtl.o",
                 build / "lib/libfp3.a", build / "obj/verilator/verilated.o", build / "obj/verilator/verilated_threads.o", "-o", tmp_path / "lns_rtl",
                 "-lgsl", "-lgslcblas", "-lm", "-pthread")
    assert done.returncode == 0, done.stderr
    done = start(tmp_path / "lns_rtl", 20000)
    assert set(re.findall(r"^(\w+): .*: [1-9]\d* mismatches$", done.stdout, re.M)) == wrong, done.stdout
