"""fp3 bench MODEL --csv --plot: the figures of the JSON as a table, those of the printed table as a picture."""

import collections
import csv
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree

import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
from fp3bench import figures    # noqa: E402

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture
def bench(fp3, root):
    def bench(*arguments, **environment):
        return subprocess.run([fp3, "bench", *arguments], cwd=root, capture_output=True, text=True, timeout=300,
                              env=os.environ | environment)
    return bench


def curves(path):
    """How many points each curve has, by its name, and its colour: its group has a mark for each, and one for the legend."""
    groups = [group for group in xml.etree.ElementTree.parse(path).iter(f"{SVG}g") if group.get("id", "").startswith("gnuplot_plot")]
    return ({next(group.iter(f"{SVG}text")).text: len(list(group.iter(f"{SVG}use"))) - 1 for group in groups},
            {next(group.iter(f"{SVG}text")).text: tuple(map(int, re.findall(r"\d+", next(group.iter(f"{SVG}use")).get("color").replace("black", "0,0,0")))) for group in groups})


@pytest.mark.skipif(not shutil.which("gnuplot"), reason="needs gnuplot: make setup")
def test_a_table_and_a_picture(bench, tmp_path):
    done = bench("oscillator", "-i", "rk4", "--quick", "--json", tmp_path / "a.json", "--csv", tmp_path / "a.csv",
                 "--plot", tmp_path / "a.svg")
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
    lines = [re.split(" {2,}", line)[0] for line in done.stdout.splitlines()[4:] if line]
    drawn, colours = curves(tmp_path / "a.svg")
    assert drawn == collections.Counter(lines) and {"fast, 1 thread", "gsl, 1 thread", "rtl many_full"} <= set(drawn)
    text = "".join(xml.etree.ElementTree.parse(tmp_path / "a.svg").getroot().itertext())
    # As tools/ have them: hardware black, fp3 and GSL in colours of their own.
    for engine, curve in (("fast", "fast, 1 thread"), ("gsl", "gsl, 1 thread"), ("rtl", "rtl many_full"), ("plain_c", "plain_c, 1 thread")):
        assert colours[curve] == tuple(bytes.fromhex(figures.COLOURS[engine][1:]))
    assert "oscillator: error against time" in text and "oscillator: error against cycles of hardware" in text


REFUSED = {("--plot", "a.pdf"): "a.pdf: expected the name of a picture that ends in .svg or .png",
           ("--plot", "nowhere/a.svg"): "nowhere/a.svg: cannot write: ",
           ("--plot", "programs/oscillator.ode"): "expected the name of a picture that ends in .svg or .png"}


@pytest.mark.skipif(not shutil.which("gnuplot"), reason="needs gnuplot: make setup")
@pytest.mark.parametrize("arguments", REFUSED)
def test_a_picture_is_refused_before_the_work(bench, arguments):
    done = bench("oscillator", "--quick", *arguments)
    assert (done.returncode, done.stdout) == (2, "") and REFUSED[arguments] in done.stderr


def test_without_gnuplot_nothing_is_measured(bench, tmp_path):
    done = bench("oscillator", "--quick", "--plot", tmp_path / "a.svg", PATH=str(tmp_path))
    assert (done.returncode, done.stdout) == (1, "") and "which is not installed" in done.stderr


@pytest.mark.parametrize("option", ["--csv", "--plot"])
def test_they_are_of_a_model(bench, option):
    done = bench(option, "a.svg")
    assert done.returncode == 2 and f"found {option}, expected MODEL" in done.stderr
