"""Every count of the public headers at its ends: tests/hostile/counts.c has the rows."""

import subprocess

import pytest

pytestmark = pytest.mark.smoke


@pytest.mark.parametrize("engine", ["isa", "fast"])
def test_counts(root, build, engine):
    done = subprocess.run([build / "tests/counts", root / "programs/kepler.ode", engine], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0 and done.stdout == "0 failed\n", done.stdout + done.stderr
