#!/usr/bin/env python3
"""Error against run time, and speed: runs build/bench/bench, one model at a time, and gathers what it wrote.

    tools/bench.py                 every model, every integrator: minutes for each model
    tools/bench.py --quick         two models, few points: half a minute
    tools/bench.py --models kepler lorenz       these alone; the others stay as they were measured

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
import time

from measured import clocks

ROOT = pathlib.Path(__file__).resolve().parents[1]
QUICK = {"ship": ["euler"], "kepler": ["leapfrog"]}
OTHERS = ("speed", "output")        # what is measured beside models
PEERS = ("diffrax", "heyoka")       # Python packages, each measured by tools/bench_NAME.py


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

class Failed(Exception):
    """One measurement; the others go on."""


def is_fresh(path, *sources):
    return path.exists() and all(path.stat().st_mtime >= source.stat().st_mtime for source in sources)


def run(command):
    """What it says on standard error is passed on; its last line is why it failed."""
    last = "no word"
    with subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, text=True) as program:
        for line in program.stderr:
            sys.stderr.write(line)
            last = line.strip() or last
    if program.returncode:
        raise Failed(f"exit code {program.returncode}: {last}")


def measure(path, command, *sources):
    """Has a program write path, unless what is there is newer than the sources; adds when, and of which revision."""
    if is_fresh(path, *sources):
        print(f"bench: {path.stem}: kept", file=sys.stderr)
        return path
    new, begin = path.with_name(f"{path.name}.new"), time.monotonic()
    try:
        run([*command, new])
        part = json.loads(new.read_text(encoding="utf-8"))
    finally:
        new.unlink(missing_ok=True)
    measured = {"revision": revision(), "date": datetime.date.today().isoformat(), "seconds": round(time.monotonic() - begin, 1)}
    for problem in part.get("problems", []):
        problem["measured"] = measured
    write(path, json.dumps(part | {"measured": measured}, indent=1) + "\n")
    return path


def quick(options):
    return ["--quick"] if options.quick else []


def measure_model(options, name):
    """The file of its points; beside it, the problem for PEERS."""
    model = ROOT / f"programs/{name}.ode"
    words = [word for i in (QUICK.get(name, ["rk4"]) if options.quick else []) for word in ("-i", i)]
    command = [options.bench, "points", model, "--engine", options.engine, *words, *quick(options),
               "--problem", options.parts / f"{name}.problem.json", "--json"]
    return measure(options.parts / f"{name}.json", command, options.bench, model)


def measure_speed(options):
    return measure(options.parts / "speed.json", [options.bench, "speed", "--engine", options.engine, *quick(options), "--json"], options.bench)


def measure_output(options):
    """How fast a recording is written; fp3 stands beside the program's folder."""
    tool, fp3 = ROOT / "tools/bench_output.py", options.bench.parents[1] / "fp3"
    return measure(options.parts / "output.json", [sys.executable, tool, "--fp3", fp3, *quick(options)], tool, fp3)


def measure_peer(options, name, peer):
    """The same with a Python package, if `make setup-bench` has put it into .venv-bench/; None: it has not, or there are events."""
    python, path = ROOT / ".venv-bench/bin/python", options.parts / f"{name}.{peer}.json"
    tool, problem = ROOT / f"tools/bench_{peer}.py", options.parts / f"{name}.problem.json"
    if options.quick or not any(ROOT.glob(f".venv-bench/lib/python3*/site-packages/{peer}")) or not problem.exists():
        return None
    return measure(path, [python, tool, problem], tool, problem)


def try_all(options, names):
    """The files of all parts, and what failed: its name and why."""
    begin, parts, failed = time.monotonic(), [], []
    work = [(name, (lambda name=name: measure_model(options, name), *(lambda name=name, peer=peer: measure_peer(options, name, peer) for peer in PEERS)))
            for name in names if name not in OTHERS]
    work += [(name, (lambda make=make: make(options),)) for name, make in zip(OTHERS, (measure_speed, measure_output)) if name in names]
    for number, (name, actions) in enumerate(work, 1):
        print(f"bench: {name}, {number} of {len(work)}, {time.monotonic() - begin:.0f} s so far", file=sys.stderr)
        try:
            for action in actions:
                parts.append(action())
        except Failed as why:
            print(f"bench: {name}: failed: {why}", file=sys.stderr)
            failed.append({"name": name, "why": str(why)})
    return [part for part in parts if part], failed


def before(options, names, every):
    """The files of what is not asked for now and was measured earlier."""
    paths = [options.parts / f"{name}{kind}.json" for name in every if name not in names for kind in ("", *(f".{peer}" for peer in PEERS))]
    return [path for path in paths if path.exists()]


# ---- where it is measured ---------------------------------------------------------------------------

def said(*command):
    try:
        return subprocess.run(command, capture_output=True, text=True, cwd=ROOT).stdout.splitlines()[0].strip()
    except (OSError, IndexError):
        return None


def revision():
    return said("git", "describe", "--always", "--dirty")


def processor():
    try:
        return re.search(r"model name\s*:\s*(.*)", pathlib.Path("/proc/cpuinfo").read_text())[1]
    except (OSError, TypeError):
        return platform.processor()


def about(options):
    return {"date": datetime.date.today().isoformat(), "form": "quick" if options.quick else "full",
            "command": "make bench" + (" QUICK=1" if options.quick else ""), "processor": processor(), "processors": os.cpu_count(),
            "load": os.getloadavg()[0], "system": platform.platform(), "compiler": said("cc", "--version"),
            "revision": revision()}


def put_times(points, mhz):
    """Of hardware: cycles at its clock, where it was placed."""
    for point in points:
        if point["engine"] == "rtl" and point["config"] in mhz:
            point["ns_per_object"] = point["cycles"] * 1000 / mhz[point["config"]]


def kept(options):
    """What was found before in the same form: a part that is not measured now stays."""
    try:
        data = json.loads(options.output.read_text(encoding="utf-8"))
        return data if data["about"]["form"] == about(options)["form"] else {}
    except (OSError, ValueError, KeyError, TypeError):
        return {}


# ---- all of it --------------------------------------------------------------------------------------

def gather(options, paths, failed):
    found = {"about": about(options), "problems": [], "points": [], "left_out": [], "speed": [], "output": [], "failed": failed}
    versions, mhz = {}, clocks()
    for path in paths:
        part = json.loads(path.read_text(encoding="utf-8"))
        for name in ("problems", "points", "left_out", "speed", "output"):
            found[name] += part.get(name, [])
        versions.update(part.get("versions", {}))
        if "target" in part:
            found["about"]["target"] = part["target"]
    put_times(found["points"], mhz)
    found["about"] |= {"versions": versions, "mhz": mhz}
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bench", type=pathlib.Path, default=ROOT / "build/bench/bench", help="the program")
    parser.add_argument("--engine", default="fast", help="of fp3: fast (default) or isa")
    parser.add_argument("--quick", action="store_true", help="two models, few points")
    parser.add_argument("--models", nargs="+", help="only these, or speed or output; the others stay as they were (default: all)")
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "build/results/bench.json", help="the file to write")
    options = parser.parse_args()
    all_models = sorted(path.stem for path in ROOT.glob("programs/*.ode"))
    every = [*all_models, *OTHERS]
    for name in options.models or []:
        if name not in every:
            parser.error(f"no model '{name}': there are {', '.join(every)}")
    options.bench, options.output = options.bench.resolve(), options.output.resolve()
    options.parts = options.output.parent / "bench" / ("quick" if options.quick else ".")
    options.parts.mkdir(parents=True, exist_ok=True)
    names = options.models or ([*QUICK, *OTHERS] if options.quick else every)
    paths, failed = try_all(options, names)
    found = gather(options, sorted(paths + before(options, names, every)), failed)
    write(options.output, json.dumps(found, indent=1) + "\n")
    write_csv(options.output.with_suffix(".csv"), found["points"])
    write_csv(options.output.with_name(f"{options.output.stem}_speed.csv"), found["speed"])
    print(f"{len(found['points'])} points of {len(found['problems'])} models, {len(found['speed'])} figures of speed, "
          f"{len(found['left_out'])} left out")
    for one in found["failed"]:
        print(f"failed: {one['name']}: {one['why']}")
    return 3 if found["failed"] else 0


if __name__ == "__main__":
    sys.exit(main())
