#!/usr/bin/env python3
"""The processor with a memory of its own, simulated: `make alone`.

    tools/alone.py                  all rows: four hours
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
LANES = "lanes_memory"
WORLD = "world_memory"
LATENCY = 20                              # cycles of memory
RATES = (1000, 400, 3000)                 # words of memory in 1,000 cycles
GOAL = 1.1                                # cycles a word that memory can give in each
# Steps of a visit of a chunk, by the rate of memory. Eight lanes compute faster and share one port, so their visits are longer.
STEPS = {CONFIG: {3000: 16, 400: 32}, LANES: {3000: 96, 400: 256}}
OBJECTS = {CONFIG: 100_000, LANES: 10_000}
SLOWER = 1.02                             # goal: cycles of chunks over those of objects in the store
PARTS = ("loads", "chunks", "linked", "near")
LINKED = {"programs/gallery/flag.scene": (400, 3000), "bench/alone/cloth.scene": (3000,)}   # scenes of objects with links, and the rates of memory
# Scenes of near objects: how far these may go in the steps of a row, and after which step it begins.
NEAR = {"programs/world/heap.scene": ((0.055, 0), (0.01, 8192)), "programs/world/dam.scene": ((0.03, 0),)}
LINKED_SLOWER = 1.3                       # goal: likewise, with a memory that gives a word in each cycle


def alone(build, *arguments):
    done = subprocess.run([build / "bench/alone", *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"alone.py: {done.stderr.strip()}")
    return json.loads(done.stdout)


def loads(build, objects):
    """Rows of loads: cycles a word to the processor, back, and through AXI4-Lite by a master that waits for no response or for each."""
    return [alone(build, "load", CONFIG, objects, rate, LATENCY, 0) for rate in RATES]


def chunks(build, objects, steps):
    """Rows of kepler by rk4, more objects than the store holds; build/bench/alone compares their words with those of the engine fast."""
    image = build / "results/kepler.fp3"
    image.parent.mkdir(parents=True, exist_ok=True)
    subprocess.run([build / "bin/fp3", "compile", ROOT / "programs/kepler.ode", "-i", "rk4", "-c", CONFIG, "--image", image, "--params", image.with_suffix(".cfg")],
                   check=True, stdout=subprocess.DEVNULL)
    return [alone(build, "chunks", config, image, objects or OBJECTS[config], steps or of, rate, LATENCY)
            for config, visits in STEPS.items() for rate, of in visits.items()]


def linked(build, scenes, steps):
    """Rows of scenes whose objects have links, one list of transfers for all steps; build/bench/alone compares their words with those of the engine fast."""
    return [alone(build, "linked", WORLD, ROOT / scene, steps, rate, LATENCY) for scene in scenes for rate in LINKED[scene]]


def near(build, scenes, steps):
    """Rows of scenes whose objects are near each other, likewise; the hardware makes their lists."""
    return [alone(build, "linked", WORLD, ROOT / scene, steps, max(RATES), LATENCY, *run) for scene in scenes for run in NEAR[scene]]


def text(row):
    where = f"{row['scene']:10} {row['config']:12} {row['objects']:6} objects, memory of {row['memory']:g} words a cycle"
    if "cycles_per_word" in row:
        return (f"{where}: {row['cycles_per_word']:.3f} cycles a word, back {row['back']:.3f}; through AXI4-Lite {row['slave_streams']:.3f}, "
                f"waiting for each {row['slave_waits']:.3f}")
    if "chunks" in row:
        return (f"{where}: {row['cycles_per_object_step']:.2f} cycles per object-step in {row['chunks']} chunks, {row['in_store']:.2f} in the store; "
                f"busy: lanes {row['lanes_busy']:.0%}, memory {row['memory_busy']:.0%}")
    return f"{where}: {row['cycles_per_object_step']:.2f} cycles per object-step with {row['visit']} steps a visit, {row['in_store']:.2f} in the store"


def misses(row):
    """A word takes a cycle, or as long as memory takes for it; chunks cost little."""
    if "chunks" in row:
        return row["memory"] >= 1 and row["cycles_per_object_step"] > LINKED_SLOWER * row["in_store"]
    if "cycles_per_word" not in row:
        return row["visit"] >= min(STEPS[row["config"]].values()) and row["cycles_per_object_step"] > SLOWER * row["in_store"]
    return max(row["cycles_per_word"], row["back"]) > GOAL * max(1, 1 / row["memory"])


def main():
    parser = argparse.ArgumentParser(description="the processor with a memory of its own, simulated")
    parser.add_argument("--quick", action="store_true", help="few objects, and none that are near each other: tests/bare/test_linked.py has those")
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=PARTS, help="these alone")
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "build/results/alone.json", help="where rows go (%(default)s)")
    args = parser.parse_args()
    build = pathlib.Path(os.environ.get("FP3_BUILD", ROOT / "build"))
    made = {"loads": lambda: loads(build, 2500 if args.quick else 10_000), "chunks": lambda: chunks(build, *((2100, 2) if args.quick else (None, None))),
            "linked": lambda: linked(build, *((list(LINKED)[:1], 2) if args.quick else (LINKED, 100))),
            "near": lambda: near(build, *(((), 2) if args.quick else (NEAR, 100)))}
    rows = [row for part in made if part in args.parts for row in made[part]()]
    for row in rows:
        print(text(row))
    args.output.parent.mkdir(parents=True, exist_ok=True)
    args.output.write_text(json.dumps({"rows": rows}, indent=1) + "\n", encoding="utf-8")
    if any(map(misses, rows)):
        sys.exit("alone.py: a word or a step takes too long")


if __name__ == "__main__":
    main()
