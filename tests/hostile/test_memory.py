"""Memory that runs out once, at any allocation: tests/hostile/memory.c."""

import subprocess


def test_each_allocation_fails_once(root, build):
    done = subprocess.run([build / "tests/memory", root / "programs/ship.ode", root / "programs/fleet.scene"],
                          capture_output=True, text=True, timeout=600)
    assert done.returncode == 0 and done.stdout == "0 failed\n", done.stdout + done.stderr
