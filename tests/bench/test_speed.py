"""bench speed: who runs, by how many objects and steps; all with the bits of the loop by hand."""

import json
import os
import subprocess

import pytest

pytestmark = pytest.mark.xdist_group("speed")    # it is measured once

ENGINE = "fast"
FIELDS = {"program", "engine", "method", "threads", "flags", "objects", "steps", "ns_per_object_step", "ratio_to_hand", "repeats"}


def bench(build, root, *arguments):
    return subprocess.run([build / "bench/bench", "speed", "--engine", ENGINE, "--quick", *arguments], cwd=root,
                          capture_output=True, text=True, timeout=300)


@pytest.fixture(scope="module")
def rows(build, root, tmp_path_factory):
    path = tmp_path_factory.mktemp("bench") / "speed.json"
    done = bench(build, root, "--json", path)
    assert done.returncode == 0, done.stderr
    return json.loads(path.read_text())["speed"]


def test_every_field_and_everybody_is_there(rows):
    assert all(set(row) == FIELDS and row["ns_per_object_step"] > 0 and row["ratio_to_hand"] > 0 for row in rows)
    assert {("hand", f"{n} vector{'s'[:n > 1]}") for n in (1, 2, 4, 8)} | {("plain_c", "scalar"), ("plain_c", "vectors"),
            ("gsl", "rk4"), ("gsl", "rk8pd"), (ENGINE, None), ("rtl", None)} <= {(row["engine"], row["method"]) for row in rows}
    assert {row["objects"] for row in rows} == {1, 1024, 16384}


def test_physics_engines_are_there_where_they_are_installed(rows):
    engines = {row["engine"] for row in rows}
    for engine, header in (("box2d", "/usr/include/box2d/box2d.h"), ("ode", "/usr/include/ode/ode.h")):
        assert (engine in engines) == os.path.exists(header)


def test_ratios_are_those_of_the_cell(rows):
    for objects, steps in {(row["objects"], row["steps"]) for row in rows}:
        cell = [row for row in rows if (row["objects"], row["steps"]) == (objects, steps)]
        best = min(row["ns_per_object_step"] for row in cell if row["engine"] == "hand")
        for row in cell:
            assert row["ratio_to_hand"] == pytest.approx(row["ns_per_object_step"] / best, rel=1e-6)


def test_a_wrong_bit_stops_it(build, root, tmp_path):
    done = bench(build, root, "--flip", "--json", tmp_path / "x.json")
    assert done.returncode == 1 and "other bits than in the loop by hand" in done.stderr and not (tmp_path / "x.json").exists()


def test_the_fast_engine_is_measured_in_all_its_ways(rows):
    ways = {(row["method"], row["threads"], row["flags"]) for row in rows if row["engine"] == "fast"}
    assert {(None, 1, False), (None, 1, True), ("interpreter", 1, False)} <= ways
    assert os.cpu_count() == 1 or (None, os.cpu_count(), False) in ways


def test_the_interpreter_is_no_native_code(rows):
    """By far slower: it would not be if FP3_FAST were not read."""
    def of(method):
        return next(row["ns_per_object_step"] for row in rows
                    if (row["engine"], row["method"], row["threads"], row["flags"], row["objects"], row["steps"]) == ("fast", method, 1, False, 1024, 1000))
    assert of("interpreter") > 1.5 * of(None)
