"""docs/results.md: every figure of docs/results.md and of README's table comes from results, or there is no table."""

import json
import pathlib
import re
import shutil
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
from fp3evidence.told import bare  # noqa: E402


def results(tree):
    return subprocess.run([sys.executable, tree / "tools/pages.py", "results"], capture_output=True, text=True)


def test_missing_results_are_named_and_nothing_is_written(root, tmp_path):
    shutil.copytree(root / "tools", tmp_path / "tools")
    (tmp_path / "docs").mkdir()
    shutil.copy(root / "docs/synth.json", tmp_path / "docs")
    folder = tmp_path / "build/results"
    done = results(tmp_path)
    assert done.returncode == 1 and f"{folder} has nothing of it: run `make all sim models prove` first" in done.stderr
    folder.mkdir(parents=True)
    for name, what in (("sim", {"runs": []}), ("prove", [])):
        (folder / f"{name}.json").write_text(json.dumps(what))
    done = results(tmp_path)
    assert done.returncode == 1 and "sim.json is not whole" in done.stderr and not (tmp_path / "docs/results.md").exists()


def test_what_was_not_measured_stays_on_the_page(root, tmp_path):
    """Here everything but the proofs and what is in docs/synth.json."""
    shutil.copytree(root / "tools", tmp_path / "tools")
    (tmp_path / "docs").mkdir()
    for name in ("synth.json", "results.md"):
        shutil.copy(root / "docs" / name, tmp_path / "docs")
    (tmp_path / "build/results").mkdir(parents=True)
    row = {"core": "a new part", "seconds": 1.0, "verdict": "proved"}
    (tmp_path / "build/results/prove.json").write_text(json.dumps([row]))
    before = (root / "docs/results.md").read_text()
    done = results(tmp_path)
    assert done.returncode == 0, done.stderr
    after = (tmp_path / "docs/results.md").read_text()
    head, proofs = re.split("(?=^## Proofs)", before, flags=re.M)
    assert "a new part" in after and proofs not in after and bare(after).startswith(bare(head).rstrip())


def test_each_arithmetic_has_its_name(root, monkeypatch):
    monkeypatch.syspath_prepend(root / "tools")
    import report
    rows = [{"model": "kepler", "integrator": "rk4", "arithmetic": arithmetic, "errors": {"steps": [8], "error": [1e-9]}, "many_full": {"measured": 20.0}}
            for arithmetic in ("plain", "compensated", "folded", "double_single")]
    assert [line.split(" | ")[0] for line in report.precision(rows, "kepler").splitlines()[2:]] == ["| `rk4`", "| `rk4`, compensated", "| `rk4`, double-single"]
