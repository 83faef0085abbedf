#!/usr/bin/env python3
"""The processor with a memory of its own, simulated: `make alone`.

    tools/alone.py                  all rows
    tools/alone.py --quick          the same of a few objects, for the tests

Writes build/results/alone.json, and prints its rows. Exit code 1: a row misses its goal.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
CONFIG = "many_memory"
LATENCY = 20                              # cycles of memory
RATES = (1000, 400, 3000)                 # words of memory in 1,000 cycles
GOAL = 1.1                                # cycles a word that memory can give in each


def alone(build, *arguments):
    done = subprocess.run([build / "bench/alone", *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"alone.py: {done.stderr.strip()}")
    return json.loads(done.stdout)


def loads(build, objects):
    """Rows of loads: cycles a word to the processor, back, and through AXI4-Lite by a master that waits for no response or for each."""
    return [alone(build, "load", CONFIG, objects, rate, LATENCY, 0) for rate in RATES]


def misses(row):
    """A word takes a cycle, or as long as memory takes for it."""
    return max(row["cycles_per_word"], row["back"]) > GOAL * max(1, 1 / row["memory"])


def main():
    parser = argparse.ArgumentParser(description="the processor with a memory of its own, simulated")
    parser.add_argument("--quick", action="store_true", help="few objects")
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "build/results/alone.json", help="where rows go (%(default)s)")
    args = parser.parse_args()
    build = pathlib.Path(os.environ.get("FP3_BUILD", ROOT / "build"))
    rows = loads(build, 2500 if args.quick else 10_000)
    for row in rows:
        print(f"{row['scene']:8} {row['config']:12} {row['objects']:6} objects, memory of {row['memory']:g} words a cycle: {row['cycles_per_word']:.3f} cycles "
              f"a word, back {row['back']:.3f}; through AXI4-Lite {row['slave_streams']:.3f}, waiting for each {row['slave_waits']:.3f}")
    args.output.parent.mkdir(parents=True, exist_ok=True)
    args.output.write_text(json.dumps({"rows": rows}, indent=1) + "\n", encoding="utf-8")
    if any(map(misses, rows)):
        sys.exit("alone.py: a word takes too long")


if __name__ == "__main__":
    main()
