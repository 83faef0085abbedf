"""fp3 tune --plot: each run of the sample is a point, each candidate a curve in the colour of its family; the bound and the choice."""

import json
import math
import os
import re
import shutil
import subprocess
import tomllib
import xml.etree.ElementTree as xml

import pytest

pytestmark = pytest.mark.skipif(not shutil.which("gnuplot"), reason="needs gnuplot: make setup")
SVG = "{http://www.w3.org/2000/svg}"
MODEL = "model m \"a decay\"\nstate x = 1\nparam k = 1\nx' = -k*x\nexact x = exp(-k*t)\nstep 0.03125\nspan 2\n"


@pytest.fixture
def tune(fp3, tmp_path):
    (tmp_path / "m.ode").write_text(MODEL)

    def tune(*arguments, **environment):
        return subprocess.run([fp3, "tune", "m.ode", *arguments], cwd=tmp_path, capture_output=True, text=True, timeout=300, env=os.environ | environment)
    return tune


def plots(path):
    """The groups of the picture, each a curve or a line of the legend: its name, and its marks as colour, number of the mark, x, y."""
    for group in xml.parse(path).iter(f"{SVG}g"):
        if group.get("id", "").startswith("gnuplot_plot"):
            marks = [(tuple(map(int, re.findall(r"\d+", use.get("color", "0,0,0").replace("black", "0,0,0")))), int(re.search(r"\d+$", use.attrib["{http://www.w3.org/1999/xlink}href"])[0]),
                      *map(float, re.match(r"translate\(([\d.]+),([\d.]+)\)", use.attrib["transform"]).groups())) for use in group.iter(f"{SVG}use")]
            yield group.find(f"{SVG}title").text, marks


def families(root):
    with open(root / "programs/integrators/families.toml", "rb") as file:
        return {member: tuple(bytes.fromhex(family["colour"][1:])) for family in tomllib.load(file)["integrators"] for member in family["members"]}


def test_the_picture_has_what_was_tried(tune, tmp_path, root):
    done = tune("--tolerance", "1e-4", "--spread", "k=0.5:2", "--plot", "a.svg", "--json", "a.json")
    assert done.returncode == 0, done.stderr
    row = json.loads((tmp_path / "a.json").read_text())
    of = families(root)
    for r in row["tried"]:
        r["looks"] = sorted((cycles, error) for cycles, error in r["looks"] if error is not None and 0 < error <= 10)
    tried = [r for r in row["tried"] if r["looks"]]
    found = list(plots(tmp_path / "a.svg"))
    curves = [marks for _, marks in found[:len(tried)]]
    assert len(tried) > 20 and all((r["cycles"], r["error"]) in r["looks"] and r["lowest"] == min(error for _, error in r["looks"]) for r in tried)
    for r, marks in zip(tried, curves):
        assert len(marks) == len(r["looks"]) and {mark[0] for mark in marks} == {of[r["integrator"]]}, r["integrator"]
        # A mark for each arithmetic, open where steps are adaptive; its number in the file is one below that of the script.
        assert {mark[1] for mark in marks} == {{"plain": 6, "compensated": 4, "folded": 8, "double_single": 12}[r["arithmetic"]] - r["adaptive"]}
    # Decades: the same number of pixels for each. A point lies where its figures say.
    points = [(*figures, *mark[2:]) for r, marks in zip(tried, curves) for figures, mark in zip(r["looks"], marks)]
    for value, place in ((0, 2), (1, 3)):
        least, most = (of_all(points, key=lambda point: point[value]) for of_all in (min, max))
        decade = (most[place] - least[place]) / math.log10(most[value] / least[value])
        assert all(point[place] == pytest.approx(least[place] + decade * math.log10(point[value] / least[value]), abs=0.1) for point in points)
    names = [name for name, _ in found]
    chosen = dict(found)["chosen"]
    best = next(marks for r, marks in zip(tried, curves) if (r["integrator"], r["arithmetic"], r["error"], r["cycles"]) == (row["integrator"], row["arithmetic"], row["error"], row["cycles"]))
    assert any(chosen[0][2:] == pytest.approx(mark[2:], abs=0.1) for mark in best)
    assert {"tolerance 0.0001", "the sample must meet 8e-05", "rk4 with the step of the model", "Runge-Kutta, order 4", "plain", "fixed steps"} <= set(names)
    said = "".join(xml.parse(tmp_path / "a.svg").getroot().itertext())
    assert "m from 0 to 2: error against cost of all that was tried" in said and f"chosen: {row['integrator']}, {row['arithmetic']}" in said
    assert "cycles of many_full for one object, all steps" in said and "largest error of a state, relative, of the worst object" in said


@pytest.mark.long
def test_where_nothing_holds_there_is_a_picture_without_a_choice(tune, tmp_path):
    (tmp_path / "m.ode").write_text("state x = 1\nx' = x + 0.001*tanh(x)*atan(sin(x)*exp(-x))\nwhen x > 2: x = x - 1\nstep 0.0625\nspan 10\n")
    done = tune("--tolerance", "1e-6", "--plot", "a.svg")
    assert done.returncode == 3 and "nothing meets the tolerance" in done.stderr and "chosen" not in "".join(xml.parse(tmp_path / "a.svg").getroot().itertext())


@pytest.mark.parametrize("arguments, message, code", [
    ("--plot a.pdf", "a.pdf: expected the name of a picture that ends in .svg or .png", 2), ("--plot nowhere/a.svg", "nowhere/a.svg: cannot write: ", 2),
    ("--plot a.svg --json a.svg", "are one file", 2), ("--plot m.svg", "--plot m.svg would overwrite INPUT m.ode", 2)])
def test_what_is_refused(tune, tmp_path, arguments, message, code):
    (tmp_path / "m.svg").symlink_to("m.ode")
    done = tune("--tolerance", "1e-3", *arguments.split())
    assert (done.returncode, done.stdout) == (code, "") and message in done.stderr, done.stderr
    assert (tmp_path / "m.ode").read_text() == MODEL and sorted(path.name for path in tmp_path.iterdir()) == ["m.ode", "m.svg"]


def test_without_gnuplot_nothing_is_tried(tune, tmp_path):
    done = tune("--tolerance", "1e-3", "--plot", "a.svg", PATH=str(tmp_path))
    assert (done.returncode, done.stdout) == (1, "") and "which is not installed" in done.stderr
