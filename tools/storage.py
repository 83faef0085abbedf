#!/usr/bin/env python3
"""What rounding to nearest and at random do to long runs whose records have 16 bits: `make storage`.

    tools/storage.py --fp3 build/bin/fp3 --output build/results/storage.json

Each row is a model over some steps, with an object stored every VISIT steps. 256 objects begin with different values. Of each we take a quantity at
the end, and its difference from that of the same object with records of 32 bits, as a share of the latter. `mean` is the mean of these differences,
the bias, and `spread` their standard deviation.
"""

import argparse
import json
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

from bench import write

ROOT = pathlib.Path(__file__).resolve().parents[1]
OBJECTS = 256
DECAY = """model decay
shared tau = {steps}
state x = 1
step 1
span {steps}
x' = -x/tau
"""


def decay(s):
    return s["x"]


def spring(s):
    return (s["v"]**2 + 40 * s["x"]**2) / 2


def planet(s):
    return (s["v_x"]**2 + s["v_y"]**2) / 2 - 1 / (s["r_x"]**2 + s["r_y"]**2)**0.5


def height(s):
    return s["z"]


# Name, program (text of a model, or a file), what is looked at, its name, options, steps.
CASES = (
    ("decay", DECAY, decay, "x", ["-i", "euler", "--spread", "x=1:2"], (100_000, 1_000_000)),
    ("oscillator", "programs/oscillator.ode", spring, "energy", ["-i", "leapfrog", "--set", "c=0", "--spread", "x=0.5:1.5"], (100_000, 1_000_000)),
    ("kepler", "programs/kepler.ode", planet, "energy", ["-i", "leapfrog", "--spread", "r_x=0.5:0.7"], (100_000, 1_000_000)),
    ("lorenz", "programs/lorenz.ode", height, "z", ["-i", "rk4", "--spread", "x=0:1"], (100_000,)),
)
VISITS = (1, 16)


def final(fp3, program, config, steps, *options):
    """The quantity's states of each object at the end."""
    done = subprocess.run([fp3, "run", program, "--config", config, "--engine", "fast", "--objects", str(OBJECTS), "--steps", str(steps), "--all",
                           "--allow-failures", *options], cwd=ROOT, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"tools/storage.py: {program}: {done.stderr.strip()}")
    found = [{} for _ in range(OBJECTS)]
    for name, value, number in re.findall(r"^(\S+) +(\S+) +0x\w+ +object (\d+)$", done.stdout, re.M):
        found[int(number)][name] = float(value)
    return found


def compared(of, true, quantity):
    shares = [(quantity(a) - quantity(b)) / abs(quantity(b)) for a, b in zip(of, true)]
    return statistics.fmean(shares), statistics.stdev(shares)


def rows(fp3, folder):
    for name, program, quantity, of, options, lengths in CASES:
        for steps in lengths:
            path = program
            if "\n" in program:
                path = pathlib.Path(folder) / f"{name}.ode"
                path.write_text(program.format(steps=steps))
            true = final(fp3, path, "many_full", steps, *options)
            for visit in VISITS:
                ways = [final(fp3, path, "many_half", steps, *options, "--visit", str(visit), *seed) for seed in ([], ["--seed", "1"])]
                yield (name, of, steps, visit, *(figure for way in ways for figure in compared(way, true, quantity)))


def table(found):
    lines = ["| model | quantity | steps | steps per visit | nearest: mean | spread | at random: mean | spread |", "|---|---|---|---|---|---|---|---|"]
    return lines + [f"| {name} | {of} | {steps:,} | {visit} | " + " | ".join(f"{100 * figure:+.3g} %" if i % 2 == 0 else f"{100 * figure:.3g} %"
                                                                          for i, figure in enumerate(figures)) + " |"
                    for name, of, steps, visit, *figures in found]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fp3", required=True, type=pathlib.Path)
    parser.add_argument("--output", required=True, type=pathlib.Path, help="the rows, JSON")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        found = list(rows(given.fp3.resolve(), folder))
    write(given.output, json.dumps({"rows": found}, indent=1) + "\n")
    print("\n".join(table(found)))


if __name__ == "__main__":
    main()
