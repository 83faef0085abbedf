"""tools/arithmetic.py: its tables and picture, from figures whose answers are known; and a measurement, of one model."""

import importlib
import json
import subprocess
import sys

import pytest


@pytest.fixture
def tool(root):
    sys.path.insert(0, str(root / "tools"))
    yield importlib.import_module("arithmetic")
    sys.path.remove(str(root / "tools"))


def row(arithmetic, error, cycles, lut4=1000, mhz=100.0, model="m"):
    return {"arithmetic": arithmetic, "model": model, "integrator": "rk4, plain", "h": 0.1, "tolerance": None, "error_median": error,
            "error_worst": 2 * error, "cycles": cycles, "lut4": lut4, "mhz": mhz, "words_differing": 0}


def found(rows):
    return {"measured": "2026-01-01", "revision": "abc", "integrators": ["rk4"], "rows": rows, "units": [], "left_out": []}


def test_costs_are_relative_to_binary32(tool):
    text = "".join(tool.page(found([row("binary32", 1e-3, 200), row("binary32", 1e-5, 800), row("Cell's", 1e-3, 100, lut4=500, mhz=200.0)])))
    assert "| `m` | 1.0e-05 (2.0e-05) | 1.0e-03 (2.0e-03) |" in text
    assert "| 1e-03 | 1.00 (1) | 0.12 (1) |" in text                   # half the cycles of half the LUTs at twice the clock: 1/8
    assert "| 1e-05 | 1.00 (1) | – (0) |" in text
    assert "| `m` | Cell's 0.12 | Cell's 0.12 | binary32 | binary32 | – |" in text


def test_what_nothing_else_reaches_is_told(tool):
    text = "".join(tool.page(found([row("binary32", 1e-3, 200), row("fused", 1e-5, 199)])))
    assert "| `m` | binary32 | binary32 | only fused | only fused | – |" in text


def test_the_front_has_no_point_that_a_cheaper_one_beats(tool):
    rows = [row("binary32", 1e-2, 10), row("binary32", 1e-3, 20), row("binary32", 5e-3, 30), row("binary32", 1e-4, 40), row("binary32", 1e-9, 5, mhz=None)]
    assert [one["cycles"] for one in tool.front(rows)] == [10, 20, 40]


def test_one_model_is_measured(tool, root, fp3, tmp_path):
    done = subprocess.run([sys.executable, root / "tools/arithmetic.py", "--fp3", fp3, "--output", tmp_path / "x.json", "--model", "oscillator",
                           "--integrator", "rk4"], cwd=root, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    of = json.loads((tmp_path / "x.json").read_text())
    assert {one["arithmetic"] for one in of["rows"]} == set(tool.ARITHMETICS.values()) and not of["left_out"]
    best = {name: min(one["error_median"] for one in of["rows"] if one["arithmetic"] == name) for name in ("binary32", "Cell's")}
    assert best["binary32"] < best["Cell's"] < 1e-4
    assert all(0 < one["error_median"] <= one["error_worst"] and one["cycles"] > 0 and one["words_differing"] == 0 for one in of["rows"])
