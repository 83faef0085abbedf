#!/usr/bin/env python3
"""Changes one place of the C software after another, and says which test sees it: `make mutate-c`.

    tools/mutate_c.py                                 100 changes of each part that tests/mutants.toml names
    tools/mutate_c.py --parts checkpoints --count 0   every change of one part
    tools/mutate_c.py --seed 7                        the same choice again

A change (a mutant) is a comparison that changes at its end, another operator, one side of && or ||, another number, a statement that is not there. A
test that fails, crashes or hangs has killed it. One from which the compiler makes the same code is equivalent. What is left is open: no test that was asked
sees it. `not reached` says that none even comes there. Writes build/results/mutation_c.json, with the rows of other parts as they were.
"""

import argparse
import collections
import concurrent.futures
import json
import os
import pathlib
import random
import shutil
import sys
import tempfile
import threading
import tomllib

from fp3cmutants import ladder
from fp3gen.text import between, markdown

ROOT = pathlib.Path(__file__).resolve().parents[1]
LISTED = ROOT / "tests/mutants.toml"
NOT_REACHED = "not reached"


def judge(tree, rungs, mutant):
    """By the rungs that reach it, cheapest first; then by the compiler."""
    reached = [rung for rung in rungs if mutant.number in rung.seen]
    for rung in reached:
        if rung.kills(tree, mutant):
            mutant.state, mutant.by = "killed", rung.text
            return
    if ladder.is_equivalent(tree, mutant):
        mutant.state = "equivalent"
    elif not reached:
        mutant.by = NOT_REACHED


def measure(part, count, seed, jobs, folder, say):
    """A row for each file of a part."""
    rungs = [ladder.Rung(text) for text in part["rungs"]]
    tree = ladder.Tree(folder, part["files"], ladder.programs(rungs) | set(part.get("programs", ())))
    chosen = tree.mutants if not count or count >= len(tree.mutants) else random.Random(seed).sample(tree.mutants, count)
    for rung in rungs:
        rung.begin(tree)
        say(f"{part['name']}: {rung.text}: {rung.seconds:.1f} s, reaches {len(rung.seen)} of {len(tree.mutants)} mutants")
    rungs.sort(key=lambda rung: rung.seconds)
    lock, done = threading.Lock(), [0]

    def one(mutant):
        judge(tree, rungs, mutant)
        with lock:
            done[0] += 1
            if done[0] % 20 == 0:
                say(f"{part['name']}: {done[0]} of {len(chosen)} judged")

    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        list(pool.map(one, chosen))
    return [row(part["name"], path, [mutant for mutant in chosen if mutant.file == path], sum(mutant.file == path for mutant in tree.mutants), seed)
            for path in part["files"]]


def row(part, path, chosen, of, seed):
    states = collections.Counter(mutant.state for mutant in chosen)
    judged = len(chosen) - states["equivalent"]
    return {"name": path, "part": part, "mutants": len(chosen), "of": of, "seed": seed, "killed": states["killed"], "equivalent": states["equivalent"],
            "open": states["open"], "score": round(states["killed"] / judged, 4) if judged else None,
            "rungs": dict(collections.Counter(mutant.by for mutant in chosen if mutant.state == "killed")),
            "holes": [{"line": mutant.line, "column": mutant.column, "change": mutant.text} | ({"why": mutant.by} if mutant.by else {})
                      for mutant in sorted(chosen, key=lambda one: one.number) if mutant.state == "open"]}


def kept(path, parts):
    try:
        return [row for row in json.loads(path.read_text(encoding="utf-8"))["modules"] if row["part"] not in parts]
    except (OSError, ValueError):
        return []


def text(found):
    score = "–" if found["score"] is None else f"{found['score']:.1%}"
    return (f"{found['name']}: {found['mutants']} of {found['of']} mutants, {found['killed']} killed, {found['equivalent']} equivalent, {found['open']} open: {score}"
            + "".join(f"\n    {found['name']}:{hole['line']}:{hole['column']}: {hole['change']}{' (not reached)' if 'why' in hole else ''}" for hole in found["holes"]))


def page(text, found):
    """docs/mutation_c.md with the tables of what was measured."""
    rows = found["modules"]
    total = {key: sum(row[key] for row in rows) for key in ("mutants", "of", "killed", "equivalent", "open")}
    shown = [[f"`{row['name']}`", f"{row['mutants']} of {row['of']}", row["killed"], row["equivalent"], row["open"],
              sum("why" in hole for hole in row["holes"]), "–" if row["score"] is None else f"{row['score']:.0%}"] for row in rows]
    shown.append(["all", f"{total['mutants']} of {total['of']}", total["killed"], total["equivalent"], total["open"],
                  sum("why" in hole for row in rows for hole in row["holes"]), f"{total['killed'] / max(1, total['mutants'] - total['equivalent']):.0%}"])
    holes = [[f"`{row['name']}`", hole["line"], f"`{hole['change']}`", "" if "why" in hole else "yes"] for row in rows for hole in row["holes"]]
    text = between(text, "files", markdown(["file", "mutants", "killed", "equivalent", "open", "of these not reached", "score"], shown))
    return between(text, "holes", markdown(["file", "line", "change", "reached"], holes))


def main():
    parser = argparse.ArgumentParser(description="Changes one place of the C software after another, and says which test sees it.")
    parser.add_argument("--list", type=pathlib.Path, default=LISTED, help="the parts and their tests (%(default)s)")
    parser.add_argument("--parts", nargs="+", metavar="PART", help="these alone")
    parser.add_argument("--count", type=int, default=100, help="mutants of a part, by chance; 0: all (%(default)s)")
    parser.add_argument("--seed", type=int, help="of the choice (by chance, printed)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="at a time (%(default)s)")
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "build/results/mutation_c.json", help="where rows go (%(default)s)")
    args = parser.parse_args()
    described = tomllib.loads(args.list.read_text(encoding="utf-8"))["part"]
    names = [part["name"] for part in described]
    for name in args.parts or ():
        if name not in names:
            parser.error(f"no part '{name}': there are {', '.join(names)}")
    if args.count < 0 or args.jobs < 1:
        parser.error("expected --count 0 or more, --jobs 1 or more")
    seed = random.SystemRandom().randrange(1 << 32) if args.seed is None else args.seed

    def say(what):
        print(f"mutate-c: {what}", file=sys.stderr, flush=True)

    say(f"seed {seed}")
    for part in described:
        if part["name"] not in (args.parts or names):
            continue
        folder = pathlib.Path(tempfile.mkdtemp(prefix="mutants", dir=ladder.BUILD))
        try:
            rows = measure(part, args.count, seed, args.jobs, folder, say)
        except ladder.Failed as why:
            sys.exit(f"mutate-c: {part['name']}: {why}")
        finally:
            shutil.rmtree(folder, ignore_errors=True)
        for found in rows:
            print(text(found), flush=True)
        args.output.parent.mkdir(parents=True, exist_ok=True)
        temporary = args.output.with_suffix(".tmp")
        temporary.write_text(json.dumps({"modules": kept(args.output, {part["name"]}) + rows}, indent=1) + "\n", encoding="utf-8")
        temporary.replace(args.output)


if __name__ == "__main__":
    main()
