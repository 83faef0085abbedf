"""Numbers with fewer fraction bits than binary32: sw/machine/narrow.c against doubles (tests/isa/narrow.c)."""

import re
import subprocess

import pytest

from bugs import few

FRACTIONS = (7, 15, 18, 22)


def narrow(program, *arguments):
    return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, timeout=600)


@pytest.mark.parametrize("subnormal", [0, 1], ids=["flushed", "gradual"])
@pytest.mark.parametrize("nearest", [0, 1], ids=["truncated", "nearest"])
@pytest.mark.parametrize("fraction", FRACTIONS)
def test_results_and_flags(build, fraction, nearest, subnormal, long):
    """All pairs of special numbers and 3*10^4 random triples (10^7); of one operand, with up to 9 bits every number."""
    done = narrow(build / "tests/narrow", fraction, nearest, subnormal, 10**7 if long else 3 * 10**4)
    assert done.returncode == 0 and re.fullmatch(r"\d{6,} results, 0 wrong\n", done.stdout), done.stdout


BUGS = {
    "ties go up": ("(rest == half && kept & 1)", "rest == half"),
    "what is far below does not count": ("distance > TOP ? 1", "distance > TOP ? 0"),
    "tininess before rounding": ("e < 0 || shortened", "e < 1 || shortened"),
    "low bits count": ("word & UINT32_MAX << below(config)", "word + 0 * below(config)"),
    "a truncated overflow is infinite": ("config->nearest ? INFINITE", "1 ? INFINITE"),
}


@pytest.mark.parametrize("bug", few((bug, bug) for bug in BUGS))
def test_a_bug_is_found(root, build, tmp_path, bug):
    text = (root / "sw/machine/narrow.c").read_text()
    right, wrong = BUGS[bug]
    assert text.count(right) == 1, right
    (tmp_path / "narrow_own.c").write_text(text.replace(right, wrong).replace('"narrow.h"', '"machine/narrow.h"'))
    subprocess.run(["gcc", "-O1", "-std=c11", "-D_GNU_SOURCE", "-Isw", "-Isw/include", "-o", tmp_path / "narrow", build / "obj/tests/isa/narrow.o",
                    tmp_path / "narrow_own.c", build / "lib/libfp3.a", "-lm"], cwd=root, check=True)
    done = [narrow(tmp_path / "narrow", 7, nearest, 1, 10**4) for nearest in (0, 1)]
    assert any(run.returncode for run in done), bug
