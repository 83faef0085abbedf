#!/usr/bin/env python3
"""The stress suite: runs `fp3 stress` on its own equations and on the models of programs/, and gathers what it found.

    tools/stress.py                  everything: minutes
    tools/stress.py --quick          three integrators, three models, fewer steps
"""

import argparse
import concurrent.futures
import json
import pathlib
import subprocess
import sys
import tempfile

from bench import about, write
from fp3bench.stress import SECTIONS

ROOT = pathlib.Path(__file__).resolve().parents[1]
MOST = 8        # models of one command
QUICK = ["kepler", "pendulum", "bouncing_ball"]


def stress(options, *arguments):
    """What the command wrote. 3: something does not hold, and it is there."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "part.json"
        command = [options.fp3, "stress", "--json", path, *(["--quick"] if options.quick else []), *arguments]
        done = subprocess.run(command, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        if done.returncode not in (0, 3) or not path.exists():
            sys.exit(f"stress.py: {' '.join(map(str, command))}: exit code {done.returncode}: {done.stderr}")
        return json.loads(path.read_text(encoding="utf-8"))


def run(options):
    models = [ROOT / f"programs/{name}.ode" for name in QUICK] if options.quick else sorted(ROOT.glob("programs/*.ode"))
    work = [("--only", name) for name in SECTIONS if name != "invariants"]      # those are of models alone
    work += [models[i:i + MOST] for i in range(0, len(models), MOST)]
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        parts = list(pool.map(lambda arguments: stress(options, *arguments), work))
    found = {"about": about(options) | {"command": "make stress" + (" QUICK=1" if options.quick else "")},
             "results": [row for part in parts for row in part["results"]],
             "curves": [curve for part in parts for curve in part["curves"]]}
    write(options.output, json.dumps(found, indent=1) + "\n")
    return found


def summary(results):
    wrong = [row for row in results if not row["holds"]]
    for row in wrong:
        print(f"{row['section']}: {row['model']}, {row['integrator']}, {row['arithmetic']}: {row['name']}\n    {row['why']}")
    print(f"{len(results)} results, {len(results) - len(wrong)} hold, {len(wrong)} do not")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--fp3", type=pathlib.Path, default=ROOT / "build/fp3", help="the command")
    parser.add_argument("--quick", action="store_true", help="three integrators, three models, fewer steps")
    parser.add_argument("--jobs", type=int, default=1, help="how many commands at a time (default 1)")
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "build/results/stress.json", help="the file to write")
    options = parser.parse_args()
    options.fp3, options.output = options.fp3.resolve(), options.output.resolve()
    summary(run(options)["results"])


if __name__ == "__main__":
    sys.exit(main())
