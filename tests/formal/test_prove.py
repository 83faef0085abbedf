"""The proofs of the floating-point cores and the control modules, a test for each part of tests/formal/prove.py."""

import subprocess
import sys

import pytest


@pytest.mark.parametrize("part", ["add", "mutants", "mul", "cuts", "control", "scale"])
def test_everything_is_proved(root, build, part):
    done = subprocess.run([sys.executable, str(root / "tests/formal/prove.py"), "--jobs", "1", "--only", part,
                           "--results", str(build / f"results/prove-{part}.json")],
                          cwd=root, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
