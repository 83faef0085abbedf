"""Engines in a process that forks, and no more threads than they need: tests/hostile/child.c."""

import subprocess

import pytest


@pytest.mark.parametrize("engine", ["isa", "fast", "rtl"])
def test_a_child_goes_on_with_the_engine_of_its_parent(root, build, engine):
    done = subprocess.run([build / "tests/child", root / "programs/ship.ode", engine], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0 and done.stdout == "1 threads, the same\n", done.stdout + done.stderr
