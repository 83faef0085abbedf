"""tools/report.py: every figure of docs/results.md and of README's table comes from results, or there is no table."""

import json
import shutil
import subprocess
import sys


def report(tree):
    return subprocess.run([sys.executable, tree / "tools/report.py"], capture_output=True, text=True)


def test_missing_results_are_named_and_nothing_is_written(root, tmp_path):
    shutil.copytree(root / "tools", tmp_path / "tools")
    done = report(tmp_path)
    assert done.returncode != 0 and "build/results/sim.json" in done.stderr and not (tmp_path / "docs").exists()
    results = tmp_path / "build/results"
    results.mkdir(parents=True)
    for name, what in (("sim", {"runs": []}), ("synth", {"rows": [{"device": "x", "seeds": [1]}]}), ("prove", [])):
        (results / f"{name}.json").write_text(json.dumps(what))
    done = report(tmp_path)
    assert done.returncode != 0 and not (tmp_path / "docs").exists()


def test_each_arithmetic_has_its_name(root, monkeypatch):
    monkeypatch.syspath_prepend(root / "tools")
    import report
    rows = [{"model": "kepler", "integrator": "rk4", "arithmetic": arithmetic, "errors": {"steps": [8], "error": [1e-9]}, "many_full": {"measured": 20.0}}
            for arithmetic in ("plain", "compensated", "folded", "double_single")]
    assert [line.split(" | ")[0] for line in report.precision(rows, "kepler").splitlines()[2:]] == ["| `rk4`", "| `rk4`, compensated", "| `rk4`, double-single"]
