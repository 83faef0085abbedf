#!/usr/bin/env python3
"""The processor with a memory of its own, simulated: `make alone`.

    tools/alone.py                  all rows: two hours and a half on two processors
    tools/alone.py --quick          the same of a few objects, for the tests

Prints rows, and writes them into build/results/alone.json; those of parts that were not asked for stay there. Exit code 1: a row misses its goal.
"""

import argparse
import concurrent.futures
import json
import os
import pathlib
import subprocess
import sys

from fp3gen.text import between, markdown

ROOT = pathlib.Path(__file__).resolve().parents[1]
CONFIG = "many_memory"
LANES = "lanes_memory"
WORLD = "world_memory"
OVERLAP = "world_overlap"
LATENCY = 20                              # cycles of memory
RATES = (1000, 400, 3000)                 # words of memory in 1,000 cycles
GOAL = 1.1                                # cycles a word that memory can give in each
# Steps of a visit of a chunk, by the rate of memory. Eight lanes compute faster and share one port, so their visits are longer.
STEPS = {CONFIG: {3000: 16, 400: 32}, LANES: {3000: 96, 400: 256}}
OBJECTS = 100_000
SLOWER = 1.02                             # goal: cycles of chunks over those of objects in the store
LINKED = {"programs/gallery/flag.scene": (400, 3000), "bench/alone/cloth.scene": (3000,)}   # scenes of objects with links, and the rates of memory
# Scenes of near objects: how far these may go in the steps of a row, and after which step it begins.
NEAR = {"programs/world/heap.scene": ((0.055, 0), (0.01, 8192)), "programs/world/dam.scene": ((0.03, 0),)}
LINKED_SLOWER = {WORLD: 1.3, OVERLAP: 1.15}          # goals: likewise, with a memory that gives a word in each cycle


def alone(build, *arguments):
    done = subprocess.run([build / "bench/alone", *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"alone.py: {done.stderr.strip()}")
    return json.loads(done.stdout)


# What to measure: the arguments of build/bench/alone for each row of a part.

def loads(_, quick):
    """Cycles a word to the processor, back, and through AXI4-Lite by a master that waits for no response or for each."""
    return [("load", CONFIG, 2500 if quick else 10_000, rate, LATENCY, 0) for rate in RATES]


def chunks(build, quick):
    """Kepler by rk4, more objects than the store holds; build/bench/alone compares their words with those of the engine fast."""
    image = build / "results/kepler.fp3"
    image.parent.mkdir(parents=True, exist_ok=True)
    subprocess.run([build / "bin/fp3", "compile", ROOT / "programs/kepler.ode", "-i", "rk4", "-c", CONFIG, "--image", image, "--params", image.with_suffix(".cfg")],
                   check=True, stdout=subprocess.DEVNULL)
    return [("chunks", config, image, 2100 if quick else OBJECTS, 2 if quick else steps, rate, LATENCY)
            for config, visits in STEPS.items() for rate, steps in visits.items()]


def linked(_, quick):
    """Scenes whose objects have links, one list of transfers for all steps; build/bench/alone compares their words with those of the engine fast."""
    return [("linked", WORLD, ROOT / scene, 2 if quick else 100, rate, LATENCY) for scene in list(LINKED)[:1 if quick else None] for rate in LINKED[scene]]


def near(_, quick):
    """Scenes whose objects are near each other, likewise; the hardware makes their lists. tests/bare/test_linked.py has small ones."""
    return [] if quick else [("linked", WORLD, ROOT / scene, 100, max(RATES), LATENCY, *run) for scene, runs in NEAR.items() for run in runs]


def overlap(_, quick):
    """Some of both kinds, whose words move while lanes run."""
    flag, cloth = LINKED
    heap, runs = next(iter(NEAR.items()))
    rows = [(flag, 2 if quick else 100, 3000), (flag, 2 if quick else 100, 400), (cloth, 10, 3000), (heap, 100, 3000, runs[0])]
    return [("linked", OVERLAP, ROOT / scene, steps, rate, LATENCY, *(run[0] if run else ())) for scene, steps, rate, *run in rows[:2 if quick else None]]


PARTS = {part.__name__: part for part in (loads, chunks, linked, near, overlap)}


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
        return row["memory"] >= 1 and row["cycles_per_object_step"] > LINKED_SLOWER[row["config"]] * row["in_store"]
    if "cycles_per_word" not in row:
        return row["visit"] >= min(STEPS[row["config"]].values()) and row["cycles_per_object_step"] > SLOWER * row["in_store"]
    return max(row["cycles_per_word"], row["back"]) > GOAL * max(1, 1 / row["memory"])


# ---- docs/memory.md ----

def table(part, rows):
    """The lines of a part's table."""
    if part == "loads":
        head = "| how | " + " | ".join(f"{row['memory']:g} word{'' if row['memory'] == 1 else 's'} a cycle" for row in rows) + " |"
        how = {"cycles_per_word": "by transfers, to the processor", "back": "by transfers, back to memory",
               "slave_streams": "through AXI4-Lite, by a master that waits for no response", "slave_waits": "... by one that waits for each"}
        return [head, "|---|" + "---|" * len(rows), *(f"| {text} | " + " | ".join(f"{row[key]:.3f}" for row in rows) + " |" for key, text in how.items())]
    costs = [[f"{row['cycles_per_object_step']:.{2 if part == 'chunks' else 1}f}", f"{row['in_store']:.{2 if part == 'chunks' else 1}f}",
              f"{row['cycles_per_object_step'] / row['in_store']:.3f}"] for row in rows]
    if part == "chunks":
        return markdown(["configuration", "objects", "words a cycle", "steps of a visit", "by the list", "in the store", "ratio"],
                        [[f"`{row['config']}`", f"{row['objects']:,}", f"{row['memory']:g}", row["visit"], *cost] for row, cost in zip(rows, costs)])
    return markdown(["scene", "objects", "words a cycle", "from step", "steps", "`roam`", "chunks", "ghosts", "by the list", "in the store", "ratio", "lanes", "memory"],
                    [[row["scene"].partition(".")[0], f"{row['objects']:,}", f"{row['memory']:g}", f"{row['from']:,}", row["steps"], f"{row['roam']:g}" if row["roam"] else "–",
                      row["chunks"], f"{row['ghosts']:,}", *cost, f"{row['lanes_busy']:.0%}", f"{row['memory_busy']:.0%}"] for row, cost in zip(rows, costs)])


def page(text, found):
    """docs/memory.md with the tables of what was measured."""
    for part in PARTS:
        rows = [row for row in found["rows"] if row["part"] == part]
        text = between(text, part, table(part, rows)) if rows else text
    return text


def kept(path, form, parts):
    """Rows of other parts, measured in the same form."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return []
    return [row for row in found["rows"] if row.get("part") not in parts] if found.get("about") == {"form": form} else []


def main():
    parser = argparse.ArgumentParser(description="the processor with a memory of its own, simulated")
    parser.add_argument("--quick", action="store_true", help="few objects, and none that are near each other")
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=[*PARTS], help="these alone")
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "build/results/alone.json", help="where rows go (%(default)s)")
    args = parser.parse_args()
    build, form, rows = pathlib.Path(os.environ.get("FP3_BUILD", ROOT / "build")), "quick" if args.quick else "full", []
    asked = [(part, arguments) for part in PARTS if part in args.parts for arguments in PARTS[part](build, args.quick)]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        try:
            for (part, _), row in zip(asked, pool.map(lambda one: alone(build, *one[1]), asked)):
                rows.append({"part": part} | row)
                print(text(row), flush=True)
        except SystemExit:                  # the first that fails ends all that have not begun
            pool.shutdown(cancel_futures=True)
            raise
    rows += kept(args.output, form, args.parts)
    args.output.parent.mkdir(parents=True, exist_ok=True)
    args.output.write_text(json.dumps({"about": {"form": form}, "rows": sorted(rows, key=lambda row: [*PARTS].index(row["part"]))}, indent=1) + "\n", encoding="utf-8")
    if any(map(misses, rows)):
        sys.exit("alone.py: a word or a step takes too long")


if __name__ == "__main__":
    main()
