#!/usr/bin/env python3
"""Error against run time, and speed: runs build/bench/bench, one model at a time, and gathers what it wrote.

    tools/bench.py                 every model, every integrator: minutes for each model
    tools/bench.py --quick         two models, few points: half a minute
    tools/bench.py --models kepler lorenz

Each model's results are kept in build/results/bench/MODEL.json (a quick form's in quick/), so that a run that was
stopped goes on where it was; what is older than the program or the model is measured again. All of them, with machine
and versions, go to build/results/bench.json, its points to bench.csv and bench_speed.csv.
"""

import argparse
import csv
import datetime
import json
import os
import pathlib
import platform
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
QUICK = {"ship": ["rk4", "euler"], "kepler": ["rk4", "leapfrog"]}
CLOCKS = "docs/results.md"          # the table of placed configurations


def write(path, text):
    """All or nothing, as a reader may come at any time."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f"{path.name}.{os.getpid()}")
    temporary.write_text(text, encoding="utf-8")
    os.replace(temporary, path)


def write_csv(path, rows):
    names = list(dict.fromkeys(name for row in rows for name in row))
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f"{path.name}.{os.getpid()}")
    with open(temporary, "w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, names)
        table.writeheader()
        table.writerows(rows)
    os.replace(temporary, path)


# ---- what is measured -------------------------------------------------------------------------------

def is_fresh(path, *sources):
    return path.exists() and all(path.stat().st_mtime >= source.stat().st_mtime for source in sources)


def run(command):
    done = subprocess.run(command, cwd=ROOT)
    if done.returncode:
        sys.exit(f"bench.py: {' '.join(map(str, command))}: exit code {done.returncode}")


def measure_model(options, name):
    """The file of its points."""
    model, path = ROOT / f"programs/{name}.ode", options.parts / f"{name}.json"
    if is_fresh(path, options.bench, model):
        print(f"bench: {name}: kept", file=sys.stderr)
        return path
    words = [word for i in (QUICK.get(name, ["rk4"]) if options.quick else []) for word in ("-i", i)]
    run([options.bench, "points", model, "--engine", options.engine, "--json", path, *words, *(["--quick"] if options.quick else [])])
    return path


def measure_speed(options):
    path = options.parts / "speed.json"
    if not is_fresh(path, options.bench):
        run([options.bench, "speed", "--engine", options.engine, "--json", path, *(["--quick"] if options.quick else [])])
    return path


def measure_diffrax(options, name):
    """The same with diffrax, if `make setup-bench` has put it into .venv-bench/; None: it has not, or there are events."""
    python, path = ROOT / ".venv-bench/bin/python", options.parts / f"{name}.diffrax.json"
    tool, part = ROOT / "tools/bench_diffrax.py", options.parts / f"{name}.json"
    if options.quick or not python.exists() or not tool.exists():
        return None
    if not is_fresh(path, tool, part):
        if json.loads(part.read_text(encoding="utf-8"))["has_events"]:
            return None
        problem = options.parts / f"{name}.problem.json"
        run([options.bench, "points", ROOT / f"programs/{name}.ode", "--problem", "--json", problem])
        run([python, tool, problem, path])
        problem.unlink()
    return path


# ---- where it is measured ---------------------------------------------------------------------------

def said(*command):
    try:
        return subprocess.run(command, capture_output=True, text=True, cwd=ROOT).stdout.splitlines()[0].strip()
    except (OSError, IndexError):
        return None


def processor():
    try:
        return re.search(r"model name\s*:\s*(.*)", pathlib.Path("/proc/cpuinfo").read_text())[1]
    except (OSError, TypeError):
        return platform.processor()


def about(options):
    return {"date": datetime.date.today().isoformat(), "form": "quick" if options.quick else "full",
            "command": "make bench" + (" QUICK=1" if options.quick else ""), "processor": processor(), "processors": os.cpu_count(),
            "load": os.getloadavg()[0], "system": platform.platform(), "compiler": said("cc", "--version"),
            "revision": said("git", "describe", "--always", "--dirty")}


def clocks(text):
    """MHz of each configuration: the best seed, speed grade 6, as docs/results.md has it."""
    rows = re.findall(r"^\| `(\w+)` \|(?: \d+ \|){5} ([\d.]+) / [\d.]+ \| [\d.]+ / [\d.]+ \|$", text, re.M)
    return {name: float(mhz) for name, mhz in rows}


def put_times(points, mhz):
    """Of hardware: cycles at its clock, where it was placed."""
    for point in points:
        if point["engine"] == "rtl" and point["config"] in mhz:
            point["ns_per_object"] = point["cycles"] * 1000 / mhz[point["config"]]


# ---- all of it --------------------------------------------------------------------------------------

def gather(options, models):
    points, left_out, problems, versions = [], [], [], {}
    for path in models:
        part = json.loads(path.read_text(encoding="utf-8"))
        points += part.pop("points")
        left_out += part.pop("left_out")
        versions.update(part.pop("versions", {}))
        if "states" in part:
            problems.append(part)
    mhz = clocks((ROOT / CLOCKS).read_text(encoding="utf-8"))
    put_times(points, mhz)
    return {"about": about(options) | {"versions": versions, "mhz": mhz}, "problems": problems, "points": points,
            "left_out": left_out}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bench", type=pathlib.Path, default=ROOT / "build/bench/bench", help="the program")
    parser.add_argument("--engine", default="fast", help="of fp3: fast (default) or isa")
    parser.add_argument("--quick", action="store_true", help="two models, few points")
    parser.add_argument("--models", nargs="+", help="only these (default: all in programs/)")
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "build/results/bench.json", help="the file to write")
    options = parser.parse_args()
    all_models = sorted(path.stem for path in ROOT.glob("programs/*.ode"))
    for name in options.models or []:
        if name not in all_models:
            parser.error(f"no model '{name}': there are {', '.join(all_models)}")
    options.bench, options.output = options.bench.resolve(), options.output.resolve()
    options.parts = options.output.parent / "bench" / ("quick" if options.quick else ".")
    options.parts.mkdir(parents=True, exist_ok=True)
    names = options.models or (list(QUICK) if options.quick else all_models)
    parts = []
    for number, name in enumerate(names, 1):
        print(f"bench: {name}, {number} of {len(names)}", file=sys.stderr)
        parts += [measure_model(options, name), measure_diffrax(options, name)]
    print("bench: speed", file=sys.stderr)
    speed = json.loads(measure_speed(options).read_text(encoding="utf-8"))
    found = gather(options, [part for part in parts if part])
    found["about"]["target"] = speed["target"]
    found["speed"] = speed["speed"]
    write(options.output, json.dumps(found, indent=1) + "\n")
    write_csv(options.output.with_suffix(".csv"), found["points"])
    write_csv(options.output.with_name(f"{options.output.stem}_speed.csv"), found["speed"])
    print(f"{len(found['points'])} points of {len(found['problems'])} models, {len(found['speed'])} figures of speed, "
          f"{len(found['left_out'])} left out")


if __name__ == "__main__":
    sys.exit(main())
