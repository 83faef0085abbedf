"""tools/everywhere.py: one hash a scene on all platforms, and what it says where one differs."""

import json
import subprocess
import sys

import pytest

SCENES = ["kepler, compensated", "overflow", "almost 2^-126, of neighbours", "below 2^-126, of neighbours", "balls"]


@pytest.fixture
def everywhere(root, tmp_path):
    def everywhere(fp3, *words):
        done = subprocess.run([sys.executable, root / "tools/everywhere.py", "--fp3", fp3, "--output", tmp_path / "x.json", *words],
                              capture_output=True, text=True, timeout=600)
        return done, json.loads((tmp_path / "x.json").read_text())
    return everywhere


def test_all_platforms_have_one_hash(everywhere, fp3):
    """Those of other families, too, where `make everywhere` has compiled for them."""
    done, found = everywhere(fp3, "--only", *SCENES)
    assert done.returncode == 0 and found["failed"] == [], done.stdout + done.stderr
    assert {"isa", "x86-64", "interpreter", "rtl-verilator"} <= {row["platform"] for row in found["rows"]}
    for scene in SCENES:
        assert len({row["hash"] for row in found["rows"] if row["scene"] == scene}) == 1
    assert len({row["hash"] for row in found["rows"]}) == len(SCENES)


def test_flags_are_in_the_hash(fp3, root):
    """A product that is tiny before rounding alone raises no underflow; of those that are tiny some would, if they were not."""
    def flags(*words):
        done = subprocess.run([fp3, "run", *words], cwd=root, capture_output=True, text=True, check=True)
        return next(line.split()[1:] for line in done.stdout.splitlines() if line.startswith("flags"))
    for engine in ("isa", "fast", "rtl"):
        near = ["tests/everywhere/edge.ode", "-i", "euler", "-N", "24", "-n", "3", "--engine", engine]
        assert flags("tests/everywhere/edge.s", "-c", "many_full", "-N", "24", "--set", "x=0", "--engine", engine) == ["inexact"]
        assert flags(*near) == ["inexact"] and flags(*near, "--set", "q=1e-19") == ["underflow", "inexact"]


@pytest.mark.parametrize("spoil, expected", [
    ('sed -i "s/1/2/" "$file"', "not that of isa"),
    ('rm "$file"', "exit code 0"),
    ("exit 3", "exit code 3")])
def test_another_word_is_told(everywhere, fp3, tmp_path, spoil, expected):
    """By an fp3 that does something else where it interprets."""
    liar = tmp_path / "fp3"
    liar.write_text(f'#!/bin/sh\n"{fp3}" "$@" || exit\ntest "$FP3_FAST" = interpreter || exit 0\n'
                    f'while [ "$1" != --output ]; do shift; done; file=$2\n{spoil}\n')
    liar.chmod(0o755)
    done, found = everywhere(liar, "--only", "overflow")
    assert done.returncode == 1 and expected in done.stderr, done.stderr
    assert len(found["rows"]) > 3


def test_native_code_of_another_kind_is_no_row(everywhere, fp3, tmp_path):
    liar = tmp_path / "fp3"
    liar.write_text(f'#!/bin/sh\n"{fp3}" "$@" | sed "s/native x86-64;*$/native x86-64-v9/"\n')
    liar.chmod(0o755)
    done, found = everywhere(liar, "--only", "overflow")
    assert done.returncode == 1 and "executed by native x86-64-v9, expected native x86-64" in done.stderr, done.stderr
    assert "x86-64" not in {row["platform"] for row in found["rows"]}
