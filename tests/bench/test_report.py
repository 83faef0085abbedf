"""tools/bench_report.py and bench_check.py: pages and verdicts from a small result that stands here."""

import copy
import importlib.util
import json
import pathlib
import re
import shutil
import subprocess
import sys
import types
import xml.etree.ElementTree as xml

import pytest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "tools"))
import bench          # noqa: E402
import bench_check    # noqa: E402
from fp3bench import figures  # noqa: E402
import bench_report   # noqa: E402
import measured       # noqa: E402
import pages          # noqa: E402


pictures = pytest.mark.skipif(not importlib.util.find_spec("matplotlib"), reason="needs matplotlib: make setup-bench")


@pytest.fixture
def data():
    return json.loads((HERE / "fixture.json").read_text())


def tool(root, name, *arguments):
    return subprocess.run([sys.executable, root / "tools" / name, *arguments], capture_output=True, text=True)


# ---- tables ---------------------------------------------------------------------------------------

def test_the_best_at_an_error(data):
    first, second, third = figures.summary(data["points"], "fast")
    assert first["error"] == 0.1 and first["fast"]["ns_per_object"] == 100 and first["gsl"]["method"] == "rkf45" and first["ratio"] == 30
    assert first["all"]["integrator"] == "rk6" and first["hardware"]["cycles"] == 6400 and first["plain_c"]["method"] == "scalar"
    assert second["error"] == 0.01 and second["fast"]["ns_per_object"] == 200 and second["ratio"] == 15
    assert third["error"] == 0.001 and third["hardware"] is None and third["diffrax"] is None


def test_a_better_point_that_is_less_accurate_does_not_count(data):
    data["points"][1]["error_median"] = 0.0011
    assert [row["error"] for row in figures.summary(data["points"], "fast")] == [0.1, 0.01]


def test_the_page_says_where_fast_falls_short(data):
    page = bench_report.markdown(data)
    assert "| **15.0** |" in page and "| no: 15.0 at 1e-02, 15.0 at 1e-03 |" in page
    data["points"][1]["ns_per_object"] = 110.0
    page = bench_report.markdown(data)
    assert "| yes |" in page and "**" not in page.replace("**fast**", "")


def test_what_double_single_reaches_is_not_said_of_fp32(data):
    data["points"][1]["arithmetic"] = "double_single"
    page = bench_report.markdown(data)
    assert "| yes |" in page and "| **15.0** |" in page
    assert [row["is_fp32"] for row in figures.summary(data["points"], "fast")] == [True, False, False]


def test_what_is_left_out_for_one_reason_is_one_row(data):
    text = "the program needs {} words of instruction memory, configuration 'many' has 512; 'many_full' has 2048"
    data["left_out"] = [{"engine": "rtl", "method": None, "integrator": name, "model": "kepler", "why": text.format(513 + i)}
                        for i, name in enumerate(("rk4", "rk6"))]
    data["left_out"].append({"engine": "rtl", "method": None, "integrator": "euler", "model": "kepler",
                             "why": "16:17: error: sin(x): needs `round`, which configuration 'many' does not have; it is in 'many_full'"})
    page = bench_report.markdown(data)
    assert "| rtl | more than the 512 words of program that 'many' has | rk4, rk6 | kepler |" in page
    assert "| rtl | configuration 'many' has no `round` | euler | kepler |" in page


def test_the_page_has_machine_and_versions(data):
    page = bench_report.markdown(data)
    for word in ("a processor", "a system", "a compiler 1", "GSL 1.2", "SUNDIALS 3.4", "100.0 MHz",
                 "took too long", "diffrax (JAX) was not measured", "heyoka.py was not measured"):
        assert word in page, word
    assert "1,000,000 objects of `ship`, 100 snapshots of 2 states: 800 MB in 2.00 s" in page and "reaches 75 % of that" in page
    assert "| fast, 2 threads | 0.130 |" in page and "| fast | 16,384 | 1,000 | 0.250 | 4,000 | 1.25 |" in page


def test_adaptive_steps_and_peers_have_columns_where_they_were_measured(data):
    """heyoka is no engine of fp3: what it takes changes no ratio to GSL."""
    before = bench_report.markdown(data)
    assert "| error | fast, one thread, ns | by | adaptive steps, ns |" in before and "| diffrax, ns | heyoka, ns | GSL / fast |" in before
    data["points"].append(data["points"][0] | {"integrator": "rk4 adaptive", "h": None, "steps": None, "tolerance": 1e-3, "ns_per_object": 345.0})
    data["points"].append({key: None for key in data["points"][0]} | {"model": "kepler", "engine": "heyoka", "method": "taylor batch", "arithmetic": "float64", "threads": 1,
                                                                     "error_median": 1e-12, "ns_per_object": 50.0})
    page = bench_report.markdown(data)
    assert "345 (rk4 adaptive, plain)" in page and "50.0 (taylor batch)" in page and "heyoka.py (Taylor's method in double" in page
    assert [line.split("|")[-2] for line in page.splitlines() if line.startswith("| 1e-0")] == [line.split("|")[-2] for line in before.splitlines() if line.startswith("| 1e-0")]
    assert "Not measured" not in page
    data["problems"] += [data["problems"][0] | {"model": "ship"}, data["problems"][0] | {"model": "ball", "has_events": True}]
    assert "to 1e-14. Not measured: `ship`.\n" in bench_report.markdown(data)
    assert figures.label(data["points"][-1], "fast") in figures.METHODS
    looks = {one["name"]: one for one in figures.curves(data["points"], "fast")}
    assert looks["rk4 adaptive"]["look"] == looks["rk4"]["look"] and looks["rk4 adaptive"]["is_open"] and not looks["rk4"]["is_open"]


@pytest.mark.parametrize("peer", bench.PEERS)
def test_a_peer_that_is_not_installed_is_left_out(monkeypatch, tmp_path, peer):
    """And one that is, is started."""
    monkeypatch.setattr(bench, "ROOT", tmp_path)
    asked = []
    monkeypatch.setattr(bench, "measure", lambda path, command, *sources: asked.append(command) or path)
    options = types.SimpleNamespace(parts=tmp_path, quick=False)
    (tmp_path / "ship.problem.json").write_text("{}")
    (tmp_path / ".venv-bench/bin").mkdir(parents=True)
    (tmp_path / ".venv-bench/bin/python").write_text("")
    assert bench.measure_peer(options, "ship", peer) is None and asked == []
    (tmp_path / f".venv-bench/lib/python3.11/site-packages/{peer}").mkdir(parents=True)
    assert bench.measure_peer(options, "ship", peer) == tmp_path / f"ship.{peer}.json" and asked[0][1] == tmp_path / f"tools/bench_{peer}.py"
    assert bench.measure_peer(options, "nonesuch", peer) is None and len(asked) == 1


def test_the_page_says_what_failed(data):
    data["failed"] = [{"name": "lorenz", "why": "no luck"}]
    assert "`lorenz` failed: no luck." in bench_report.markdown(data)


def test_a_quick_form_makes_no_page_of_the_project(root, data, tmp_path):
    data["about"]["form"] = "quick"
    (tmp_path / "bench.json").write_text(json.dumps(data))
    done = tool(root, "pages.py", "bench", "--results", tmp_path)
    assert done.returncode == 1 and "quick form" in done.stderr


# ---- pictures -------------------------------------------------------------------------------------

@pictures
def test_pictures_load_nothing_and_say_what_a_point_is(root, tmp_path):
    shutil.copy(HERE / "fixture.json", tmp_path / "bench.json")
    done = tool(root, "pages.py", "bench", "--results", tmp_path, "--docs", tmp_path)
    page = (tmp_path / "benchmarks.html").read_text()
    assert done.returncode == 0 and not any(word in page for word in ("http:", "https:", "src=", "<script", "@import", "<link"))
    assert "a planet &lt;&amp;&gt;" in page and page.count("<svg") == 2
    assert "<title>fp3, one thread: rk4, plain, h = 0.2, 64 steps: error 2.00e-02, 100 ns</title>" in page
    assert "time for one object over the whole span" in page and "error at the end, relative" in page


@pictures
def test_a_page_that_would_be_too_large_has_no_pictures_of_all_integrators(data):
    for most, count in ((2.5e6, 2), (1000, 1)):
        assert bench_report.page_of(data, most).count("<svg") == count


def test_an_integrator_has_its_look_in_every_model(data):
    of = {one["name"]: one["look"] for one in figures.curves(data["points"], "fast")}
    less = [point for point in data["points"] if point["integrator"] != "euler"]
    assert "euler" in of and {one["name"]: one["look"] for one in figures.curves(less, "fast")} == {k: v for k, v in of.items() if k != "euler"}


@pytest.mark.parametrize("table", [figures.METHODS, figures.INTEGRATORS])
def test_curves_are_told_apart(table):
    """No two look alike, and there are few colours: one for a family."""
    assert len(set(table.values())) == len(table) and len({colour for colour, _, _ in table.values()}) <= 7


def test_every_integrator_and_method_has_a_look(root, data):
    assert {path.stem for path in root.glob("programs/integrators/*.cfg")} <= set(figures.INTEGRATORS)
    assert {figures.label(point, "fast") for point in data["points"]} <= set(figures.METHODS)


@pictures
def test_points_lie_where_the_axes_say_and_the_legend_outside(data):
    import plot
    svg = plot.inline(figures.fronts(data["points"], "fast"), "time", "error", unit="s")
    tree = xml.fromstring(re.sub(r"(?<= )([\w-]+)=([^'\"\s>/]+)", r"\1='\2'", svg))
    ticks = {"".join(text.itertext()).strip(): float(text.attrib["x"]) for text in tree.iter("text") if "x" in text.attrib}
    points = [(use.find("title").text, float(use.attrib["x"])) for use in tree.iter("use") if use.find("title") is not None]
    assert len(points) == sum(len(one["points"]) for one in figures.fronts(data["points"], "fast"))
    assert dict((note.partition(":")[0], x) for note, x in points if note.endswith(" 100 ns"))["fp3, one thread"] == pytest.approx(ticks["100 ns"], abs=0.2)
    names = [text for text in tree.iter("text") if "".join(text.itertext()).strip() in figures.METHODS]
    assert len(names) == len(figures.fronts(data["points"], "fast")) and min(float(text.attrib["x"]) for text in names) > max(x for _, x in points)


@pictures
def test_a_picture_is_the_same_each_time(data):
    import plot
    series = figures.curves(data["points"], "fast")
    assert plot.draw(series, "x", "y") == plot.draw(series, "x", "y") and "date" not in plot.draw(series, "x", "y")


def test_a_front_has_no_point_that_another_beats(data):
    fast = [point for point in data["points"] if point["engine"] == "fast" and point["threads"] == 1]
    assert [point["ns_per_object"] for point in figures.front(fast)] == [100, 200]


# ---- clocks ---------------------------------------------------------------------------------------

def test_hardware_gets_the_time_of_its_placed_clock(data):
    mhz = measured.clocks()
    assert {"many_full", "single_full"} <= set(mhz) and all(20 < clock < 400 for clock in mhz.values())
    point = {"engine": "rtl", "config": "many_full", "cycles": 500.0, "ns_per_object": None}
    bench.put_times([point], {"many_full": 125.0})
    assert point["ns_per_object"] == 4000.0


# ---- the baseline -----------------------------------------------------------------------------------

def test_a_ratio_that_grew_fails_and_seconds_do_not_count(data):
    baseline = {"margin": 1.2, "ratios": bench_check.ratios(data["speed"])}
    slower = copy.deepcopy(data)
    for row in slower["speed"]:
        row["ns_per_object_step"] *= 10
    assert bench_check.check(baseline, lambda: slower) == []
    slower["speed"][1]["ratio_to_hand"] = 1.6
    lines = bench_check.check(baseline, lambda: slower)
    assert len(lines) == 1 and lines[0].startswith("fast, 1 thread, 16384 objects, 1000 steps: 1.60 times") and "at most 1.50" in lines[0]


def test_once_slow_is_forgiven_always_slow_is_not(data):
    baseline = {"margin": 1.2, "ratios": bench_check.ratios(data["speed"])}
    slower = copy.deepcopy(data)
    slower["speed"][2]["ratio_to_hand"] *= 2
    runs = [slower, data]
    assert bench_check.check(baseline, lambda: runs.pop(0)) == [] and runs == []


def test_a_cell_that_was_not_measured_fails(data):
    baseline = {"margin": 1.2, "ratios": {"fast, 1 thread, 7 objects, 1000 steps": 1.0}}
    assert bench_check.check(baseline, lambda: data) == ["fast, 1 thread, 7 objects, 1000 steps: not measured"]


def test_a_new_baseline_holds(root, data, tmp_path):
    path = tmp_path / "baseline.json"
    words = ["--baseline", path, "--input", HERE / "fixture.json"]
    assert tool(root, "bench_check.py", *words, "--write").returncode == 0
    done = tool(root, "bench_check.py", *words)
    assert done.returncode == 0 and "2 ratios within 1.5 times" in done.stdout
    stored = json.loads(path.read_text())
    stored["ratios"]["fast, 1 thread, 16384 objects, 1000 steps"] = 0.5
    path.write_text(json.dumps(stored))
    done = tool(root, "bench_check.py", *words)
    assert done.returncode == 1 and "1.25 times the loop by hand, the baseline 0.50, at most 0.75" in done.stdout


def test_one_model_renews_its_section_alone(data):
    """Where nothing else was measured: the page's speed and recording stay."""
    whole = bench_report.markdown(data)
    del data["about"]["target"]
    alone = bench_report.markdown(data | {"speed": [], "output": []})
    assert "## Speed" in whole and "## Speed" not in alone and "None" not in alone
    text = pages.joined(alone, whole, ".md")
    assert sorted(re.findall("^## .*", text, re.M)) == sorted(re.findall("^## .*", whole, re.M))
    assert re.search(r"^## Speed\n.*?(?=^## )", text, re.M | re.S)[0].strip() == re.search(r"^## Speed\n.*?(?=^## )", whole, re.M | re.S)[0].strip()
    assert pages.joined(whole, text, ".md") == whole


def test_a_recording_alone_leaves_the_models(data):
    whole = bench_report.markdown(data)
    alone = bench_report.markdown(data | {"problems": [], "points": [], "speed": [], "left_out": []})
    text = pages.joined(bench_report.completed(alone, whole), whole, ".md")
    rows = re.findall(r"^\| \[`.*", whole, re.M)
    assert rows and re.findall(r"^\| \[`.*", text, re.M) == rows and sorted(re.findall("^##.*", text, re.M)) == sorted(re.findall("^##.*", whole, re.M))
