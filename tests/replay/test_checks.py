"""The RTL's own checks (FP3_CHECK) say so when the module that makes a promise breaks it: bugs put in on purpose."""

import shutil
import subprocess

import pytest

import simulate
from bugs import few

BUGS = {
    # what is wrong: (file, right, wrong, what the check says)
    "asleep in the last part": ("lane/fp3_visits.v", "!(asleep && !in_last_i)", "!asleep",
                                "u_visits: context 0, there 1, asleep 1, in the last part 1: executed 0"),
    "executed though asleep": ("lane/fp3_visits.v", "&& !(asleep && !in_last_i)", "",
                               "u_visits: context 0, there 1, asleep 1, in the last part 0: executed 1"),
}


@pytest.fixture(scope="module")
def session(root, fp3, tmp_path_factory):
    """Three ships that fall asleep in their first step."""
    at = tmp_path_factory.mktemp("session")
    subprocess.run([fp3, "asm", root / "programs/ship_sleep.s", "-o", at / "x.fp3"], check=True)
    subprocess.run([fp3, "run", at / "x.fp3", "-c", "many", "-N", "3", "--steps", "2", "--params", root / "programs/ship.cfg",
                    "--set", "eps=1e9", "--bus-log", at / "x.session"], check=True, capture_output=True)
    return at / "x.session"


def replay(tree, session, bench):
    built = subprocess.run(["iverilog", "-g2012", "-DFP3_CHECK", "-DFP3_TOP=fp3_many", "-s", "replay", "-c", "rtl/fp3.f", "-o", bench,
                            "sim/replay.v", simulate.top("many")], cwd=tree, capture_output=True, text=True)
    assert built.returncode == 0, built.stderr
    return subprocess.run(["vvp", "-n", bench, f"+session={session}"], capture_output=True, text=True, timeout=120).stdout


def test_a_sound_machine_is_silent(root, session, tmp_path):
    assert replay(root, session, tmp_path / "x.vvp").startswith("PASS ")


@pytest.mark.parametrize("bug", few((bug, bug) for bug in BUGS))
def test_a_broken_promise_is_told(root, session, tmp_path, bug):
    file, right, wrong, message = BUGS[bug]
    shutil.copytree(root / "rtl", tmp_path / "rtl", ignore=shutil.ignore_patterns("fpga"))
    shutil.copytree(root / "sim", tmp_path / "sim")
    text = (root / "rtl" / file).read_text()
    assert text.count(right) == 1, f"{file} has this {text.count(right)} times, expected once: {right!r}"
    (tmp_path / "rtl" / file).write_text(text.replace(right, wrong))
    said = replay(tmp_path, session, tmp_path / "x.vvp")
    assert message in said and "PASS" not in said, said
