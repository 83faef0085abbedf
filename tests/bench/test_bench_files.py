"""fp3 bench MODEL --csv: the figures of the JSON as a table."""

import csv
import json
import math
import os
import subprocess

import pytest


@pytest.fixture
def bench(fp3, root):
    def bench(*arguments, **environment):
        return subprocess.run([fp3, "bench", *arguments], cwd=root, capture_output=True, text=True, timeout=300,
                              env=os.environ | environment)
    return bench


def test_a_table(bench, tmp_path):
    done = bench("oscillator", "-i", "rk4", "--quick", "--json", tmp_path / "a.json", "--csv", tmp_path / "a.csv")
    assert done.returncode == 0, done.stderr
    points = json.loads((tmp_path / "a.json").read_text())["points"]
    with open(tmp_path / "a.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(points) > 20
    for row, point in zip(rows, points):
        assert list(row) == list(point)
        for name, value in point.items():
            if isinstance(value, float):
                assert math.isclose(float(row[name]), value, rel_tol=1e-8)
            else:
                assert row[name] == ("" if value is None else str(value))


def test_it_is_of_a_model(bench):
    done = bench("--csv", "a.csv")
    assert done.returncode == 2 and "found --csv, expected MODEL" in done.stderr
