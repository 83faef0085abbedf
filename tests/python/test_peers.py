"""tools/python_peers.py: the table of an ensemble by fp3 and others, at equal error."""

import importlib.util
import json
import subprocess
import sys

import numpy as np
import pytest


@pytest.fixture(scope="module")
def peers(root):
    spec = importlib.util.spec_from_file_location("python_peers", root / "tools/python_peers.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_truth_is_that_of_another_method(peers):
    integrate = pytest.importorskip("scipy.integrate")
    speeds = np.array([1.6, 1.75])
    for y0, true in zip(peers.starts(speeds), peers.truth(speeds)):
        found = integrate.solve_ivp(lambda t, y: [-y[2] / np.hypot(y[2], y[3])**3, -y[3] / np.hypot(y[2], y[3])**3, y[0], y[1]], (0, peers.SPAN), y0,
                                    method="DOP853", rtol=1e-12, atol=1e-12)
        assert found.y[:, -1] == pytest.approx(true, abs=1e-8)
    assert peers.error_of(peers.truth(speeds), speeds) == 0 and peers.error_of(peers.truth(speeds) + 1e-3, speeds) > 1e-4


def test_each_row_keeps_the_error(root, tmp_path, environment):
    done = subprocess.run([sys.executable, root / "tools/python_peers.py", "--tools", "fp3", "--objects", "64", "--errors", "1e-2,1e-4", "--json", tmp_path / "rows.json"],
                          capture_output=True, text=True, timeout=300, env=environment)
    assert done.returncode == 0, done.stderr
    rows = json.loads((tmp_path / "rows.json").read_text())
    assert len(rows) == 16 and all(row["error"] <= row["asked"] and row["us_per_object"] > 0 for row in rows) and min(row["ratio"] for row in rows) == 1
    assert done.stdout.count("\n| ") == len(rows) and "| fp3, rk4, plain |" in done.stdout
    # A coarser error takes no more steps.
    steps = {(row["asked"], row["tool"]): row["setting"] for row in rows}
    assert steps[1e-2, "fp3, rk4, plain"] < steps[1e-4, "fp3, rk4, plain"]


def test_a_tool_that_does_not_exist(root, environment):
    done = subprocess.run([sys.executable, root / "tools/python_peers.py", "--tools", "matlab"], capture_output=True, text=True, timeout=60, env=environment)
    assert done.returncode == 2 and "found 'matlab', expected fp3, scipy, diffrax, heyoka" in done.stderr
