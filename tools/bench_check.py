#!/usr/bin/env python3
"""Holds the speed of a build against a baseline: ratios to the loop by hand, never seconds.

    tools/bench_check.py                 fails if a ratio is larger than the baseline's by more than its margin
    tools/bench_check.py --write         makes what is measured now the baseline, bench/baseline.json

It runs the quick form of `bench speed` and compares each cell of the baseline. A machine that does other things can make
any ratio large, and none small for long: a cell fails only if it is too large in each of three runs.

Commands of the compiler and of scenes have limits in seconds of the processor; the best of three runs counts.
"""

import argparse
import json
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile

from bench import ROOT, write

TRIES = 3
MARGIN = 1.5            # of a new baseline
CELLS = [(16384, 1000), (1024, 1000), (1, 1000)]
ENGINES = ("fast", "isa", "plain_c", "gsl")


def key(row):
    name = row["engine"] + (f" {row['method']}" if row["method"] else "") + (" flags" if row["flags"] else "")
    return f"{name}, {row['threads']} thread{'s'[:row['threads'] > 1]}, {row['objects']} object{'s'[:row['objects'] > 1]}, {row['steps']} steps"


def ratios(rows):
    return {key(row): row["ratio_to_hand"] for row in rows}


def measure(options):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "speed.json"
        command = [options.bench, "speed", "--quick", "--engine", options.engine, "--json", path]
        done = subprocess.run(command, cwd=ROOT, stderr=subprocess.PIPE, text=True)
        if done.returncode:
            sys.exit(f"bench_check.py: {done.stderr}")
        return json.loads(path.read_text())


def too_large(baseline, found):
    """Cells that are slower than they may be, or were not measured: with a line for each."""
    rows = {}
    for name, ratio in baseline["ratios"].items():
        most = ratio * baseline["margin"]
        if name not in found:
            rows[name] = f"{name}: not measured"
        elif found[name] > most:
            rows[name] = f"{name}: {found[name]:.2f} times the loop by hand, the baseline {ratio:.2f}, at most {most:.2f}"
    return rows


def check(baseline, measured):
    """measured: a function that measures. Lines of what is too slow in every try; those of the last."""
    slow = None
    for _ in range(TRIES):
        rows = too_large(baseline, ratios(measured()["speed"]))
        slow = rows if slow is None else {name: line for name, line in rows.items() if name in slow}
        if not slow:
            break
    return list(slow.values())


def commands(folder):
    """(what it does, its arguments, seconds of the processor that it may take, its exit code)."""
    def scene(name, groups):
        group = '{ program = "none.s"; objects = 2; set = { m = 4.2e5; T = 1.1e5; }; }'
        (folder / name).write_text('config = "array"; groups = (' + ",\n".join(groups * [group]) + ");")
        return ["run", "--engine", "isa", "--scene", str(folder / name)]
    for config in ("single_full", "many_full"):
        yield f"arenstorf by rk6 for {config}", ["compile", "programs/arenstorf.ode", "-i", "rk6", "-k", "-c", config], 0.1, 0
    yield "a scene of 4,000 groups is refused", scene("few.scene", 4_000), 0.1, 2
    yield "a scene of 100,000 groups is refused", scene("many.scene", 100_000), 2, 2


def processor_seconds(fp3, arguments, code):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([fp3, *arguments], cwd=ROOT, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != code:
        sys.exit(f"bench_check.py: {done.stderr}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def slow_commands(fp3):
    """Lines of those that take longer than they may."""
    with tempfile.TemporaryDirectory() as folder:
        for name, arguments, most, code in commands(pathlib.Path(folder)):
            took = min(processor_seconds(fp3, arguments, code) for _ in range(TRIES))
            if took > most:
                yield f"{name}: {took:.3f} s of the processor, at most {most}"


def new_baseline(measured):
    """The median of some runs."""
    runs = [measured() for _ in range(TRIES)]
    found = [ratios([row for row in run["speed"] if (row["objects"], row["steps"]) in CELLS and row["engine"] in ENGINES
                     and row["threads"] == 1]) for run in runs]          # others have other numbers of processors
    return {"target": runs[0].get("about", runs[0])["target"], "margin": MARGIN,
            "ratios": {name: round(statistics.median(one[name] for one in found), 3) for name in found[0]}}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bench", type=pathlib.Path, default=ROOT / "build/bench/bench", help="the program")
    parser.add_argument("--fp3", type=pathlib.Path, default=ROOT / "build/fp3", help="the command")
    parser.add_argument("--engine", default="fast", help="of fp3: fast (default) or isa")
    parser.add_argument("--baseline", type=pathlib.Path, default=ROOT / "bench/baseline.json", help="the file of ratios")
    parser.add_argument("--write", action="store_true", help="make what is measured now the baseline")
    parser.add_argument("--input", type=pathlib.Path, help="figures that were measured before, bench.json or speed.json")
    options = parser.parse_args()

    def measured():
        return json.loads(options.input.read_text()) if options.input else measure(options)
    if options.write:
        write(options.baseline, json.dumps(new_baseline(measured), indent=1) + "\n")
        return 0
    baseline = json.loads(options.baseline.read_text())
    slow = check(baseline, measured) + ([] if options.input else list(slow_commands(options.fp3)))
    print(f"baseline: for {baseline['target']}")
    print("\n".join(slow) if slow else f"{len(baseline['ratios'])} ratios within {baseline['margin']} times those of {options.baseline.name}")
    return 1 if slow else 0


if __name__ == "__main__":
    sys.exit(main())
