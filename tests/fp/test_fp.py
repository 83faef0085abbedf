"""The floating-point cores: against this machine's FPU, against tables, and with bugs put in on purpose."""

import re
import shlex
import subprocess
from typing import NamedTuple

import pytest

from bugs import few

PAIR_OPS = ("add", "sub", "mul")
OPS = (*PAIR_OPS, "madd", "msub")
MODES = {"flushed_truncated": 0, "flushed_nearest": 1, "gradual_truncated": 2, "gradual_nearest": 3, "cell": 4}
BINARY16 = 5


def start(program, *arguments, **options):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, timeout=600, **options)
    if done.returncode == 77:
        pytest.skip(done.stderr.strip())   # fp_host, where the host's FPU differs
    return done


def passes(done):
    """The program ran something and found nothing."""
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.search(r"\b[1-9]\d* (random )?pairs\b.*: 0 mismatches", done.stdout), done.stdout


# ---- the cores ----------------------------------------------------------------------------------

@pytest.mark.parametrize("op", OPS)
def test_host(build, op, long):
    """30,000 random pairs (10^7) and all pairs of special values, uncut and with every configuration's cuts. Of multiply-add some
    triples of special values (all of them)."""
    passes(start(build / "tests/fp_host", "--op", op, "--pairs", 10**7 if long else 30_000))


@pytest.mark.smoke
@pytest.mark.parametrize("op, mode", [(op, mode) for mode in MODES for op in (PAIR_OPS if mode == "cell" else OPS)])
def test_small(build, op, mode, long):
    """All pairs of the 8-bit format; of its multiply-add 3*10^5 triples (all of them)."""
    passes(start(build / "tests/fp_small", "--op", op, "--row", MODES[mode], "--pairs", 2**24 if long else 3 * 10**5))


@pytest.mark.parametrize("op", OPS)
def test_binary16(build, op):
    passes(start(build / "tests/fp_small", "--op", op, "--row", BINARY16))


@pytest.mark.parametrize("op", PAIR_OPS)
def test_cell(build, op, long):
    """Cell's arithmetic in binary32's format: the cores and the functions of the engine isa, 10^6 random pairs (10^8)."""
    passes(start(build / "tests/fp_cell", "--op", op, "--pairs", 10**8 if long else 10**6))


@pytest.mark.smoke
def test_estimates(build):
    """All fractions: bounds, bias, and that no table of this size is better."""
    done = start(build / "tests/fp_estimates")
    assert done.returncode == 0 and re.search(r"^7\d{7} estimates, .* 0 wrong$", done.stdout), done.stdout


# ---- vectors of TestFloat -----------------------------------------------------------------------

VECTOR, TIE = "3F800000 34000000 3F800001 00\n", "3F800000 33800000 3F800000 01\n"
STREAMS = {
    "one": (VECTOR, True),
    "many": (TIE * 5000, True),
    "wrong_value": ("3F800000 34000000 3F800000 00\n", False),
    "wrong_flags": ("3F800000 34000000 3F800001 01\n", False),
    "last_wrong": (TIE * 5000 + "3F800000 34000000 3F800000 00\n", False),
    "cut_short": (VECTOR + "3F800000 34000000 3F800001", False),
    "none": ("", False),
}


@pytest.mark.smoke
@pytest.mark.parametrize("stream", STREAMS)
def test_testfloat_counts_every_vector(build, stream):
    vectors, good = STREAMS[stream]
    done = start(build / "tests/fp_testfloat", "--op", "add", input=vectors)
    assert (done.returncode == 0) == good, done.stdout + done.stderr
    assert not good or f"add: {len(vectors.splitlines())} vectors, 0 mismatches" in done.stdout


@pytest.mark.smoke
@pytest.mark.parametrize("generator", ["", "/nowhere/testfloat_gen"], ids=["unnamed", "no_such_file"])
def test_testfloat_says_what_is_missing(root, build, generator):
    done = start(root / "tests/fp/testfloat.sh", generator, build / "tests/fp_testfloat")
    assert done.returncode == 2 and "TESTFLOAT_GEN=" in done.stderr


# ---- bugs put in on purpose ---------------------------------------------------------------------

class Bug(NamedTuple):
    name: str
    op: str              # the operation that shows it
    row: int             # of fp_bench.v, likewise
    file: str
    right: str           # must be in the file once
    wrong: str


ADD, SWAP, NEAR, ROUND = "rtl/fp/fp3_fp_add.v", "rtl/fp/fp3_fp_add_swap.v", "rtl/fp/fp3_fp_add_near.v", "rtl/fp/fp3_fp_add_round.v"
MUL, SCALE, PRODUCT, CUT = "rtl/fp/fp3_fp_mul.v", "rtl/fp/fp3_fp_mul_scale.v", "rtl/fp/fp3_fp_mul_product.v", "rtl/lib/fp3_cut.v"
FMA, FMA_PRODUCT, ALIGN = "rtl/fp/fp3_fp_fma.v", "rtl/fp/fp3_fp_fma_product.v", "rtl/fp/fp3_fp_fma_align.v"
NORMALIZE, FMA_ROUND = "rtl/fp/fp3_fp_fma_normalize.v", "rtl/fp/fp3_fp_fma_round.v"
BUGS = [
    Bug("sum sticky forgets a shift", "add", 3, ADD, "(lost2 || more2 ||", "(lost2 ||"),
    Bug("sum truncated without its borrow", "sub", 2, ADD, "(NEAREST != 0 || !sticky3)", "1'b1"),
    Bug("sum ties go away from zero", "sub", 3, ROUND, "(s[3] || s[1] || s[0] || sticky)", "1'b1"),
    Bug("sum rounded where it is truncated", "add", 2, ROUND, "NEAREST != 0 && up,", "up,"),
    Bug("sum overflows unseen at rounding", "add", 3, ROUND, "rounded_over = last1 &&", "rounded_over = 1'b0 &&"),
    Bug("sum flushed without a flag", "sub", 0, ROUND, "rest || sticky || tiny", "rest || sticky"),
    Bug("sum keeps a subnormal operand", "add", 1, SWAP, "y & {FRAC{SUBNORMAL != 0 || y_some}}", "y"),
    Bug("difference zero keeps its sign", "sub", 3, SWAP, "&& !(nought && (FINITE != 0 || differ0))", ""),
    Bug("difference moved too far", "sub", 3, NEAR, "== D - i", "== D - 1 - i"),
    Bug("product sticky forgets a shift", "mul", 3, MUL, "stick = lost_4 ||", "stick ="),
    Bug("product tiny before rounding", "mul", 3, MUL, "near ? {1'b1, top || place_low} : ALL_1", "ALL_1"),
    Bug("product overflows unseen at rounding", "mul", 3, MUL, "beyond[i] ? ALL_1 : brink[i] ? rounded : ALL_0",
        "beyond[i] ? ALL_1 : ALL_0"),
    Bug("product truncated to no number", "mul", 2, MUL, "lowest   = beyond[i] && !HALF && FINITE == 0 ? ALL_0 : exponent",
        "lowest   = exponent"),
    Bug("product not flushed", "mul", 1, MUL, "flush  = tiny & {2{SUBNORMAL == 0}}", "flush  = tiny & 2'b00"),
    Bug("product loses a carry between tiles", "mul", 7, PRODUCT, "{1'b0, lh_c} + {1'b0, hl_c}",
        "{1'b0, lh_c + hl_c}"),
    Bug("sum without infinities overflows too early", "add", 4, ROUND, "TOP = FINITE != 0;", "TOP = 1'b0;"),
    Bug("sum without infinities is -0", "add", 4, SWAP, "(FINITE != 0 || differ0)", "differ0"),
    Bug("sum without infinities underflows to -0", "sub", 4, ROUND, "sign0 && !(FINITE != 0 && tiny)", "sign0"),
    Bug("product without infinities overflows too early", "mul", 4, SCALE, "(FINITE == 0 ? 1 : 0)", "1"),
    Bug("product without infinities is -0", "mul", 4, MUL, "sign_5 && !(FINITE != 0 && exponent_5 == ALL_0)", "sign_5"),
    Bug("fused forgets what z loses", "madd", 3, FMA, "more_9 || lost_9", "more_9"),
    Bug("fused distance one short", "madd", 3, FMA_PRODUCT, "FRAC + 4 - ", "FRAC + 5 - "),
    Bug("fused moves a product of zero", "madd", 3, FMA, "px_zero || distance", "distance"),
    Bug("fused keeps a subnormal operand", "msub", 1, FMA, "z_i[FRAC-1:0] & {FRAC{SUBNORMAL != 0 || z_normal}}", "z_i[FRAC-1:0]"),
    Bug("fused shifts beyond the exponent", "madd", 3, NORMALIZE, "(!known_tight || limit != 2'd0)", "1'b1"),
    Bug("fused ties of a negative sum", "msub", 3, FMA_ROUND, "(tie && t[0])", "tie"),
    Bug("fused tiny before rounding", "madd", 3, FMA_ROUND, "&& !(NEAREST != 0 && SUBNORMAL", "&& !(1'b0 && SUBNORMAL"),
    Bug("fused zero keeps its sign", "msub", 3, FMA_ROUND, "!(zero_1 && minus_1 && usual_1)", "1'b1"),
    Bug("fused flushed without a flag", "madd", 0, FMA_ROUND, "!exact || flush}", "!exact}"),
    Bug("fused infinities of two signs", "madd", 3, FMA, "z_inf && px_inf && !px_nan && minus", "1'b0"),
    Bug("fused zero times infinity valid", "madd", 3, FMA_PRODUCT, "&& !y_quiet_0) || clash}", "&& !y_quiet_0)}"),
    Bug("fused loses bits without a word", "madd", 7, ALIGN, "lost[n_1]", "lost[7] && n_1 > 4"),
    Bug("register inverts a bit", "add", 8, CUT, "d_q <= d_i;", "d_q <= d_i ^ 1'b1;"),
]


@pytest.fixture(scope="session")
def objects(root, tmp_path_factory):
    """The tests, compiled without sanitizers whatever the build has: a mutant takes seconds, not minutes."""
    at = tmp_path_factory.mktemp("objects")
    for name in ("fp_host", "fp_small"):
        succeeds("gcc", "-std=c11", "-D_GNU_SOURCE", "-O1", "-ffp-contract=off", "-I", root / "sim", "-I",
                 root / "sw/include", "-I", root / "sw", "-c", root / f"tests/fp/{name}.c", "-o", at / f"{name}.o")
    return at


def succeeds(*command, **options):
    done = start(*command, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.parametrize("bug", few(((bug.name.replace(" ", "_"), bug) for bug in BUGS), lambda row: row[0].name.split()[0]))
def test_bug_is_found(root, build, tmp_path, objects, bug):
    """The mutant fails, and so does the replay line that it prints."""
    text = (root / bug.file).read_text()
    assert text.count(bug.right) == 1, (
        f"{bug.file} has this {text.count(bug.right)} times, expected once: {bug.right!r}; see BUGS")
    (tmp_path / bug.file).parent.mkdir(parents=True)
    (tmp_path / bug.file).write_text(text.replace(bug.right, bug.wrong))

    small = bug.row < BINARY16
    succeeds("verilator", "--cc", "-Wno-lint", f"-GONLY={bug.row}", "-y", tmp_path / "rtl/fp", "-y",
             tmp_path / "rtl/lib", "-f", "rtl/fp3.f", "--top-module", "fp_bench", "--Mdir", tmp_path / "cc",
             "tests/fp/fp_bench.v", cwd=root)
    # One file, unoptimised: the shortest way to a program that runs for a tenth of a second.
    files = [*sorted((tmp_path / "cc").glob("*.cpp")), root / "sim/fp_bench_shim.cpp"]
    (tmp_path / "all.cc").write_text("".join(f'#include "{file}"\n' for file in files))
    test = "fp_small" if small else "fp_host"
    verilator = succeeds("verilator", "--getenv", "VERILATOR_ROOT").strip() + "/include"
    succeeds("g++", "-std=c++17", "-O0", "-I", tmp_path / "cc", "-I", root / "sim", "-isystem", verilator,
             tmp_path / "all.cc", objects / f"{test}.o", build / "obj/verilator/verilated.o",
             build / "obj/verilator/verilated_threads.o", "-o", tmp_path / test, "-lgsl", "-lgslcblas", "-lm",
             "-pthread")

    done = start(tmp_path / test, "--op", bug.op, "--row", bug.row, "--pairs", 20000)
    assert done.returncode == 1 and "FAIL" in done.stdout, done.stdout + done.stderr
    replay = re.search(r"replay: +(.*)", done.stdout)[1]
    again = start(*shlex.split(replay))
    assert again.returncode == 1 and "FAIL" in again.stdout, f"{replay}\n{again.stdout}{again.stderr}"


FORMATS = [("fp3_fp_mul", "rtl/fp", 8, 2, None), ("fp3_fp_mul", "rtl/fp", 8, 30, None), ("fp3_fp_mul", "rtl/fp", 3, 23, None),
           ("fp3_fp_mul", "rtl/fp", 8, 1, "FRAC_must_be_2_to_30"), ("fp3_fp_mul", "rtl/fp", 8, 31, "FRAC_must_be_2_to_30"),
           ("fp3_fp_mul", "rtl/fp", 2, 23, "EXP_must_be_at_least_3"),
           ("fp3_fp_fma", "rtl/fp", 3, 2, None), ("fp3_fp_fma", "rtl/fp", 8, 30, None),
           ("fp3_fp_fma", "rtl/fp", 8, 1, "FRAC_must_be_2_to_30"), ("fp3_fp_fma", "rtl/fp", 8, 31, "FRAC_must_be_2_to_30"),
           ("fp3_fp_fma", "rtl/fp", 2, 23, "EXP_must_be_at_least_3"),
           ("fp3_fp_add", "rtl/fp", 4, 2, None), ("fp3_fp_add", "rtl/fp", 7, 30, None),
           ("fp3_fp_add", "rtl/fp", 8, 1, "FRAC_must_be_2_to_30"), ("fp3_fp_add", "rtl/fp", 8, 31, "FRAC_must_be_2_to_30"),
           ("fp3_fp_add", "rtl/fp", 3, 2, "EXP_must_be_more_than_clog2_of_FRAC_plus_4"),
           ("fp3_fp_mul_product", "rtl/fpga/ecp5", None, 24, "FRAC_must_be_at_most_23_with_the_multipliers_of_an_ECP5"),
           *(("fp3_fp_mul_product", "rtl/fpga/ice40", None, frac, "FRAC_must_be_16_to_23_with_the_multipliers_of_an_iCE40") for frac in (7, 15, 24))]


@pytest.mark.parametrize("module, folder, exp, frac, message", FORMATS)
def test_a_format_that_a_core_does_not_have_is_refused(root, tmp_path, module, folder, exp, frac, message):
    done = subprocess.run(["iverilog", "-g2005", "-I", "rtl", "-y", "rtl/fp", "-y", "rtl/lib", *([f"-P{module}.EXP={exp}"] if exp else []),
                           f"-P{module}.FRAC={frac}", "-s", module, "-o", tmp_path / "x", f"{folder}/{module}.v"],
                          cwd=root, capture_output=True, text=True)
    assert (done.returncode != 0) == bool(message), done.stderr
    assert not message or message in done.stderr, done.stderr
