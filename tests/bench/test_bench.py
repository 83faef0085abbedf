"""make bench in its quick form: what bench.json has, and that a run goes on where it was."""

import json
import shutil
import subprocess
import sys

import pytest

ENGINE = "fast"
pytestmark = pytest.mark.xdist_group("bench")  # measured once


@pytest.fixture(scope="module")
def measured(root, build, tmp_path_factory):
    folder = tmp_path_factory.mktemp("results")
    done = run(root, build, folder)
    assert done.returncode == 0, done.stderr
    return folder


def run(root, build, folder, *more):
    return subprocess.run([sys.executable, root / "tools/bench.py", "--bench", build / "bench/bench", "--engine", ENGINE, "--quick",
                           "--output", folder / "bench.json", *more], capture_output=True, text=True, timeout=300)


def test_everything_is_in_one_file(measured):
    data = json.loads((measured / "bench.json").read_text())
    assert {"about", "problems", "points", "left_out", "speed", "output", "failed"} == set(data) and data["failed"] == []
    assert {"date", "command", "processor", "processors", "system", "compiler", "revision", "versions", "mhz", "target", "form",
            "load"} == set(data["about"]) and {"GSL", "SUNDIALS"} <= set(data["about"]["versions"])
    assert [problem["model"] for problem in data["problems"]] == ["kepler", "ship"]  # by name
    assert {"fast" if ENGINE == "fast" else ENGINE, "rtl", "gsl", "sundials", "plain_c"} == {point["engine"] for point in data["points"]}
    for point in data["points"]:
        if point["engine"] == "rtl":
            assert point["ns_per_object"] == pytest.approx(point["cycles"] * 1000 / data["about"]["mhz"][point["config"]])
        assert point["ns_per_object"] > 0
    assert all(row["ns_per_object_step"] > 0 for row in data["speed"])
    row, = data["output"]
    assert row["bytes"] > row["objects"] * row["snapshots"] * row["states"] * 4 and 0 < row["memory_mb"] < 200
    assert row["ratio_to_dd"] == pytest.approx(row["dd_seconds"] / row["seconds"])


def test_the_data_are_there_as_tables(measured):
    data = json.loads((measured / "bench.json").read_text())
    assert len((measured / "bench.csv").read_text().splitlines()) == len(data["points"]) + 1
    assert len((measured / "bench_speed.csv").read_text().splitlines()) == len(data["speed"]) + 1


def test_what_was_measured_is_kept_and_what_is_gone_is_measured_again(root, build, measured, tmp_path):
    shutil.copytree(measured, tmp_path, dirs_exist_ok=True)
    before = json.loads((tmp_path / "bench.json").read_text())
    part = tmp_path / "bench/quick/ship.json"
    part.unlink()
    done = run(root, build, tmp_path)
    assert done.returncode == 0 and "kepler: kept" in done.stderr and "ship: kept" not in done.stderr and part.exists()
    after = json.loads((tmp_path / "bench.json").read_text())
    assert [point for point in before["points"] if point["model"] == "kepler"] == [point for point in after["points"] if point["model"] == "kepler"]


def test_an_unknown_model_is_told(root, build, tmp_path):
    done = run(root, build, tmp_path, "--models", "nonesuch")
    assert done.returncode != 0 and "nonesuch" in done.stderr and "Traceback" not in done.stderr and not (tmp_path / "bench.json").exists()


# ---- with a program that measures nothing ---------------------------------------------------------

FAKE = """#!/usr/bin/env python3
import json, pathlib, sys
name = pathlib.Path(sys.argv[2]).stem if sys.argv[1] == "points" else "speed"
pathlib.Path(__file__).parents[2].joinpath("log").open("a").write(name + "\\n")
if pathlib.Path(__file__).parents[2].joinpath("fails").read_text() == name:
    sys.exit("bench: no luck today")
part = {"points": [], "left_out": [], "problems": [{"model": name}]} if name != "speed" else {"speed": [], "target": "none"}
pathlib.Path(sys.argv[sys.argv.index("--json") + 1]).write_text(json.dumps(part))
"""


def fake(root, folder, fails, *models):
    """What it was asked for, and how it ended."""
    (folder / "fails").write_text(fails)
    (folder / "log").write_text("")
    program = folder / "build/bench/bench"
    program.parent.mkdir(parents=True, exist_ok=True)
    (folder / "build/fp3").write_text("#!/bin/sh\nwhile [ $# -gt 1 ]; do shift; done\necho twelve bytes >$1\n")
    (folder / "build/fp3").chmod(0o755)
    if not program.exists():
        program.write_text(FAKE)
        program.chmod(0o755)
    done = subprocess.run([sys.executable, root / "tools/bench.py", "--bench", program, "--quick", "--output", folder / "out/bench.json",
                           "--models", *models], capture_output=True, text=True, timeout=60)
    return (folder / "log").read_text().split(), done


def test_a_model_that_fails_is_told_and_the_others_are_measured(root, tmp_path):
    asked, done = fake(root, tmp_path, "lorenz", "kepler", "lorenz", "ship", "speed", "output")
    assert asked == ["kepler", "lorenz", "ship", "speed"] and done.returncode == 3
    assert "failed: lorenz: exit code 1: bench: no luck today" in done.stdout
    data = json.loads((tmp_path / "out/bench.json").read_text())
    assert [problem["model"] for problem in data["problems"]] == ["kepler", "ship"]
    assert data["failed"] == [{"name": "lorenz", "why": "exit code 1: bench: no luck today"}]
    assert "bench: lorenz, 2 of 5, " in done.stderr and "s so far" in done.stderr


def test_a_run_goes_on_with_what_is_missing(root, tmp_path):
    fake(root, tmp_path, "lorenz", "kepler", "lorenz")
    asked, done = fake(root, tmp_path, "", "kepler", "lorenz")
    assert asked == ["lorenz"] and done.returncode == 0 and "kepler: kept" in done.stderr


def test_one_model_is_measured_and_the_others_stay(root, tmp_path):
    fake(root, tmp_path, "", "kepler", "ship", "speed")
    (tmp_path / "out/bench/quick/ship.json").unlink()
    asked, done = fake(root, tmp_path, "", "ship")
    data = json.loads((tmp_path / "out/bench.json").read_text())
    assert asked == ["ship"] and done.returncode == 0 and [problem["model"] for problem in data["problems"]] == ["kepler", "ship"]
    assert data["about"]["target"] == "none"


def test_each_part_says_what_revision_it_is_of(root, tmp_path):
    fake(root, tmp_path, "", "kepler")
    data = json.loads((tmp_path / "out/bench.json").read_text())
    assert set(data["problems"][0]["measured"]) == {"revision", "date", "seconds"}
    assert data["problems"][0]["measured"]["revision"] == data["about"]["revision"]
