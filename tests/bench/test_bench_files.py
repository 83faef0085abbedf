"""fp3 bench MODEL --csv --plot --html: the figures of the JSON as a table, those of the printed table as a picture and as a page."""

import collections
import csv
import html.parser
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
import bench_figures    # noqa: E402

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


class Page(html.parser.HTMLParser):
    """A page: rows of its tables, notes of its points with their places, what it would load, names of its elements."""
    def __init__(self, text):
        super().__init__()
        self.rows, self.notes, self.loads, self.names, self.at = [], [], [], [], None
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        of = dict(attributes)
        self.loads += [value for name, value in attributes if name in ("src", "href", "xlink:href", "data", "action") and not value.startswith("#")]
        self.names += [of["id"]] if "id" in of else []
        if tag == "tr":
            self.rows.append([])
        elif tag in ("td", "th"):
            self.rows[-1].append("")
        elif tag == "use" and "transform" in of:
            self.place = re.match(r"translate\(([\d.]+),([\d.]+)\)", of["transform"])
        elif tag == "title" and getattr(self, "place", None):
            self.notes.append(["", *map(float, self.place.groups())])
        self.at = tag

    def handle_endtag(self, tag):
        self.at = None

    def handle_data(self, text):
        if self.at in ("td", "button") and self.rows:
            self.rows[-1][-1] += text
        elif self.at == "title" and self.notes:
            self.notes[-1][0] += text


@pytest.mark.skipif(not shutil.which("gnuplot"), reason="needs gnuplot: make setup")
def test_a_table_and_a_picture(bench, tmp_path):
    done = bench("oscillator", "-i", "rk4", "--quick", "--json", tmp_path / "a.json", "--csv", tmp_path / "a.csv",
                 "--plot", tmp_path / "a.svg", "--html", tmp_path / "a.html")
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
        assert colours[curve] == tuple(bytes.fromhex(bench_figures.COLOURS[engine][1:]))
    assert "oscillator: error against time" in text and "oscillator: error against cycles of hardware" in text


    look_at_the_page(tmp_path / "a.html", done.stdout)


def look_at_the_page(path, printed):
    """It has the rows that are printed, in their order; a note at each point, where the axes say; and loads nothing."""
    text = path.read_text()
    page = Page(text)
    assert page.loads == [] and not any(word in text for word in ("http:", "https:", "@import", "url(")) and "default-src 'none'" in text
    assert len(set(page.names)) == len(page.names) and text.count("<svg") == 2 and "prefers-color-scheme:dark" in text
    lines = [re.split(" {2,}", line.strip()) for line in printed.splitlines()[4:] if line]
    assert page.rows[0] == ["engine", "how", "step", "error", "worst", "ns", "cycles"]
    assert [[cell for cell in row if cell] for row in page.rows[1:]] == [line[:3] + " ".join(line[3:]).split() for line in lines]
    points = [(float(cost), x) for note, x, _ in page.notes for cost in re.findall(r"error \S+, (\S+) ns$", note)]
    assert len(points) == sum(bool(row[5]) for row in page.rows[1:]) > 10 and len(page.notes) == len(lines)
    (least, x0), (most, x1) = min(points), max(points)
    assert all(x == pytest.approx(x0 + (x1 - x0) * math.log(cost / least) / math.log(most / least), abs=0.1) for cost, x in points)
    assert re.search(r"<code>fp3 bench -i rk4 --quick --json .* oscillator</code>", text) and re.search(r"Measured 20\d\d-\d\d-\d\d by fp3 \S+ on \d+ processors", text)
    for word in ("engine", "how", "step", "error, worst", "ns", "cycles"):
        assert f"<dt>{word}</dt>" in text


REFUSED = {("--plot", "a.pdf"): "a.pdf: expected the name of a picture that ends in .svg or .png",
           ("--plot", "nowhere/a.svg"): "nowhere/a.svg: cannot write: ",
           ("--html", "nowhere/a.html"): "nowhere/a.html: cannot write: ",
           ("--html", "programs/oscillator.ode"): "--html programs/oscillator.ode would overwrite MODEL"}


@pytest.mark.skipif(not shutil.which("gnuplot"), reason="needs gnuplot: make setup")
@pytest.mark.parametrize("arguments", REFUSED)
def test_a_picture_is_refused_before_the_work(bench, arguments):
    done = bench("oscillator", "--quick", *arguments)
    assert (done.returncode, done.stdout) == (2, "") and REFUSED[arguments] in done.stderr


@pytest.mark.parametrize("option", ["--plot", "--html"])
def test_without_gnuplot_nothing_is_measured(bench, tmp_path, option):
    done = bench("oscillator", "--quick", option, tmp_path / "a.svg", PATH=str(tmp_path))
    assert (done.returncode, done.stdout) == (1, "") and "which is not installed" in done.stderr


@pytest.mark.parametrize("option", ["--csv", "--plot", "--html"])
def test_they_are_of_a_model(bench, option):
    done = bench(option, "a.svg")
    assert done.returncode == 2 and f"found {option}, expected MODEL" in done.stderr
