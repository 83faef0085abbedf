#!/usr/bin/env python3
"""The picture of README.md: equations, the motion they make, the error of it over time, and what it costs beside others.

    tools/picture.py --fp3 build/bin/fp3 --output docs/picture.svg --measure docs/picture.json   measures, and draws
    tools/picture.py --fp3 build/bin/fp3 --output docs/picture.svg --figures docs/picture.json   draws what was measured
"""

import argparse
import collections
import csv
import datetime
import io
import json
import math
import pathlib
import platform
import re
import subprocess
import sys
import tempfile

from fp3bench.figures import COLOURS as OF_ENGINES
from fp3bench.figures import INTEGRATORS
from plot import figure as empty
from plot import for_dark

ROOT = pathlib.Path(__file__).resolve().parents[1]
MODEL = "programs/kepler.ode"
COLOURS = ["#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#666666"]
ORBITS = ["-c", "many_full", "-N", 7, "--spread", "v_y=1.25:1.75", "-n", 1000, "--every", 4]
# How the error grows: the integrator's in two of them, that of FP32 in the third.
ERRORS = [("leapfrog", []), ("rk4", []), ("yoshida6", ["-k"])]
STEPS, EVERY, H = 12800, 16, 0.0078125
PEERS = [("fast", "FP3"), ("plain_c", "a loop in C"), ("gsl", "GSL, double")]


def run(fp3, *options):
    """The columns of a recording."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "x.csv"
        subprocess.run([fp3, "run", MODEL, *map(str, options), "-e", "isa", "--output", path], cwd=ROOT, check=True, capture_output=True)
        return list(csv.DictReader(io.StringIO("".join(line for line in path.read_text().splitlines(True) if not line.startswith("#")))))


def place(t, e=0.5):
    """Kepler's equation M = E - e sin E by Newton's method: the truth, for a semi-major axis of 1 and mu = 1."""
    anomaly = t % (2 * math.pi)
    for _ in range(50):
        anomaly -= (anomaly - e * math.sin(anomaly) - t % (2 * math.pi)) / (1 - e * math.cos(anomaly))
    return math.cos(anomaly) - e, math.sqrt(1 - e * e) * math.sin(anomaly)


def off(row):
    x, y = place(float(row["time"]))
    return math.hypot(float(row["r_x"]) - x, float(row["r_y"]) - y)


def frontier(points, engine):
    """The runs of one thread that no faster one is as accurate as. A coarse step may be right by luck: it has the largest error of
    the finer ones, too, down to the best."""
    ways = collections.defaultdict(list)
    for point in points:
        if point["engine"] == engine and point["threads"] == 1 and point["ns_per_object"] and point["error_worst"]:
            way = tuple(point[name] for name in ("method", "integrator", "arithmetic"))
            ways[(*way, point["h"] is None)].append((point["h"] or point["tolerance"], point["ns_per_object"], point["error_worst"]))
    found = []
    for runs in ways.values():
        best, reached = min(error for *_, error in runs), 0
        for _, ns, error in sorted(runs):
            reached = max(reached, error) if reached or error == best else 0
            if reached:
                found.append((ns, reached))
    kept = []
    for ns, error in sorted(found):
        if not kept or error < kept[-1][1]:
            kept.append([ns, error])
    return kept


def measure(fp3):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "x.json"
        subprocess.run([fp3, "bench", MODEL, "--json", path], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
        points = json.loads(path.read_text())["points"]
    processor = re.search(r"model name\s*: (.*)", pathlib.Path("/proc/cpuinfo").read_text())
    return {"measured": datetime.date.today().isoformat(), "processor": processor[1] if processor else platform.processor(),
            "ns": {engine: frontier(points, engine) for engine, _ in PEERS}}


def equations():
    """The model's lines, without its comments."""
    lines = [re.sub(r"\s*#.*|\s+\"[^\"]*\"", "", line) for line in (ROOT / MODEL).read_text().splitlines()]
    return [line for line in lines if re.match(r"(shared|state|step|\w+')", line)]


def draw(fp3, figures):
    """Two panels in a row, so that a telephone shows letters that can be read."""
    import matplotlib
    figure = empty((6.6, 6.8))
    matplotlib.rcParams.update({"path.simplify": True, "font.size": 11.5, "legend.fontsize": 10.5, "legend.handlelength": 1.2, "lines.linewidth": 1.8,
                                "axes.titlesize": 12, "axes.titleweight": "bold"})
    figure.set(facecolor="white", layout_engine="constrained")
    figure.get_layout_engine().set(wspace=0.06, hspace=0.08)
    (words, motion), (error, cost) = figure.subplots(2, 2)
    words.set_axis_off()
    words.set_title("1. The equations", loc="left")
    words.text(0, 0.92, "\n".join(equations()), family="monospace", size=11.5, va="top", linespacing=2, transform=words.transAxes)
    motion.set_title("2. Seven of its orbits", loc="left")
    rows = run(fp3, *ORBITS, "--observe", "r_x,r_y")
    for n in range(7):
        motion.plot(*zip(*((float(row["r_x"]), float(row["r_y"])) for row in rows if row["object"] == str(n))), color=COLOURS[n], linewidth=1.5)
    motion.plot([0], [0], "o", color="#e69f00", markersize=11)
    motion.set(aspect="equal", xlabel="x", ylabel="y")
    error.set_title("3. Its error over 16 orbits", loc="left")
    for name, options in ERRORS:
        rows = run(fp3, "-i", name, *options, "-c", "many_full", "--set", f"h={H}", "-n", STEPS, "--every", EVERY, "--observe", "r_x,r_y")
        error.plot(*zip(*((float(row["time"]) / (2 * math.pi), off(row)) for row in rows if float(row["time"]) > 0)), color=INTEGRATORS[name][0],
                   label=f"{name}, compensated" if options else name)
    error.set(yscale="log", xlabel="orbits", ylabel="distance from truth")
    error.legend(frameon=False, loc="lower right")
    cost.set_title("4. What an error costs", loc="left")
    for engine, name in PEERS:
        cost.plot(*zip(*((error, ns) for ns, error in figures["ns"][engine])), "o-", color=OF_ENGINES[engine], markersize=4, label=name)
    cost.set(xscale="log", yscale="log", xlabel="largest relative error", ylabel="nanoseconds per object")
    cost.invert_xaxis()
    cost.legend(frameon=False)
    for one in (error, cost):
        one.minorticks_off()
    out = io.StringIO()
    figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None})
    clips = {}      # their names are made of addresses, which differ from run to run
    text = re.sub(r"\bp[0-9a-f]{10}\b", lambda found: clips.setdefault(found[0], f"clip{len(clips)}"), out.getvalue())
    return for_dark(re.sub(r"'DejaVu Sans( Mono)?'[^;\"]*", lambda found: "monospace" if found[1] else "sans-serif", text))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--fp3", required=True, type=pathlib.Path, help="the command")
    parser.add_argument("--output", required=True, type=pathlib.Path, help="the SVG")
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--measure", type=pathlib.Path, metavar="FILE", help="run fp3 bench, and keep what was measured")
    what.add_argument("--figures", type=pathlib.Path, metavar="FILE", help="what was measured before")
    given = parser.parse_args()
    given.fp3 = given.fp3.resolve()
    if given.measure:
        figures = measure(given.fp3)
        given.measure.write_text(json.dumps(figures, indent=1) + "\n")
    else:
        figures = json.loads(given.figures.read_text())
    given.output.write_text(draw(given.fp3, figures))


if __name__ == "__main__":
    sys.exit(main())
