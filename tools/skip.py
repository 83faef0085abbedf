#!/usr/bin/env python3
"""What a scene does not need, done and left out: runs `build/bench/bench skip` and writes its figures.

    tools/skip.py --bench build/bench/bench --output build/results/skip.json            minutes
    tools/skip.py ... --quick                                                           seconds; for the tests

Exit code 1: a side ends with other bits than the first one of its case.
"""

import argparse
import json
import pathlib
import re
import sys

import bench
from fp3gen.text import evidence, markdown

RESULTS = "docs/results.md"
TRIM = {"no flags at all": "no flags", "no status of objects": "no status of objects", "no sleep": "no `sleep`"}


def measure(options):
    path = pathlib.Path(options.output)
    path.parent.mkdir(parents=True, exist_ok=True)
    parts = path.with_name(f"{path.name}.part")
    try:
        bench.run([options.bench, "skip", *(["--quick"] if options.quick else []), "--json", parts])
        data = json.loads(parts.read_text(encoding="utf-8"))
    finally:
        parts.unlink(missing_ok=True)
    data["about"] = bench.about(options) | {"command": "make skip" + (" QUICK=1" if options.quick else "")}
    bench.write(path, json.dumps(data, indent=1) + "\n")
    return data


def other(rows):
    return [row for row in rows if row["other_words"]]


# ---- the page ---------------------------------------------------------------------------------------

TEXT = {
    "unobserved outputs": """\
`--observe v`: the compiler leaves out states that nobody observes, and whatever only they need (the pass `dead`). "All" is the same
program with `--without dead`; the observed states are compared.""",
    "coefficients 0": """\
A coefficient 0 of an integrator's table has no term (the pass `zero`). "Done" is `--without zero`: a product with 0 and an addition.
A stage that nothing else reads is left out as a whole: the seventh of `dopri5`, which is there for the error estimate of adaptive steps.
One object alone need not gain: what is left out may have stood in cycles in which it waits for itself.""",
    "coefficients 1": """\
x 1, + -0 and - 0 cost nothing (the pass `identity`). "Done" is `--without identity`.""",
    "shared constants": """\
What all objects have alike is a constant of the scheduler (the pass `share`). "In each object" is `--without share`: registers of each
object, which a visit loads. Loads are of a visit, not of a step, so visits have one step here.""",
    "sleep": """\
Objects that sleep or that the host has put to rest, evenly among the others. Time and cycles are for each object, idle or not, so a
perfect machine would have the share of the awake. The first row is the full cost.""",
    "lifetimes": """\
The same with objects that are not born yet ([scenes.md](scenes.md#lifetimes)), in programs that have no `sleep`.""",
    "flags": """\
The exceptions of each object and its first failing step, which the configuration keeps or does not (`exceptions`). The hardware keeps them beside
its arithmetic and without a cycle.""",
}
ORDER = list(TEXT)


def name(row):
    program = pathlib.Path(row["program"])
    return f"`{program.stem}`" + (f", {row['integrator']}" if row["integrator"] else "")


def cells(rows, row, config):
    """Cycles, and the share of those of the first side of the case."""
    if config not in row["cycles"]:
        return "", ""
    now, first = row["cycles"][config], rows[0]["cycles"][config]
    return f"{now:.2f}", f"{now / first:.3f}"


def result(row):
    if not row["percent"]:
        return "no object to compare"
    return f"{row['other_words']} words differ" if row["other_words"] else "the same bits"


def table(cases):
    configs = [config for config in ("many_full", "single_full") if config in cases[0][0]["cycles"]]
    head = ["program", "", "instructions", "fast, ns", "share"]
    for config in configs:
        head += [f"`{config}`, cycles", "share"]
    lines = []
    for rows in cases:
        for row in rows:
            figures = [f"{row['ns_per_object_step']:.3f}", f"{row['ratio']:.3f}"]
            for config in configs:
                figures += cells(rows, row, config)
            lines.append([name(row) if row is rows[0] else "", row["side"], row["instructions"], *figures, result(row)])
    return markdown([*head, "result"], lines)


def group(rows):
    """By way, then by case: a case begins with a new program or way."""
    found = {}
    for row in rows:
        cases = found.setdefault(row["way"], [])
        if not cases or (cases[-1][0]["program"], cases[-1][0]["integrator"]) != (row["program"], row["integrator"]):
            cases.append([])
        cases[-1].append(row)
    return found


def luts():
    """What the units cost that a configuration may lack, from the page of results."""
    text = (bench.ROOT / RESULTS).read_text(encoding="utf-8")
    rows = {}
    for label, total, change in re.findall(r"^\| ([^|]+) \| ([\d,]+) \| ([+-]\d+) \|", text, re.M):
        rows.setdefault(label, (total, change))
    if "base" not in rows or not set(TRIM) <= set(rows):
        return
    yield f"LUTs of the hardware, of {rows['base'][0]} ([results.md](results.md#what-each-feature-costs-make-synth-toptrim)): " + ", ".join(
        f"{text} {rows[label][1].replace('-', '−')}" for label, text in TRIM.items()) + "."
    yield ""


def verdict(found):
    """The figure for 1 %: the share of the full cost, on the engine and in cycles."""
    for way in ("sleep", "lifetimes"):
        for rows in found.get(way, []):
            for row in rows:
                if row["percent"] == 1:
                    share = row["cycles"]["many_full"] / rows[0]["cycles"]["many_full"]
                    yield [name(row), row["side"], f"{100 * row['ratio']:.2f} %", f"{100 * share:.2f} %"]


def page(data):
    about, found = data["about"], group(data["rows"])
    yield "<!-- Generated by tools/pages.py (make report PAGES=skip): do not edit. -->"
    yield "# What skipping saves"
    yield ""
    yield "*Measured, for FPGAs.*"
    yield ""
    yield ("Work that a scene does not need, done and left out, side by side. Times are of "
           f"{about['processors']} processors: {about['processor']}, {about['system']}; load at the end {about['load']:.1f}; {about['compiler']}.")
    yield from ("", *evidence("skip.cycles", "skip.times"), "")
    yield f"- *fast, ns*: nanoseconds of the processor for a step of each object on the engine `fast`, one thread, {data['objects']:,} objects,"
    yield f"  {data['steps']} steps: the shortest of {data['repeats']} runs. The sides of a case alternate. Loading and the first step are not part of it."
    yield f"- *cycles*: clock cycles of the Verilated hardware for a step of each object, loads and stores included, in a run of {data['rtl_steps']} steps."
    yield "- *share*: of the first row of the same program. Cycles and instructions are exact; where other processes were busy, as the load tells,"
    yield "  nanoseconds are off by some percent."
    yield "- *result*: observed states of all objects that are not idle, on `fast` and on the hardware, against the first row."
    yield "- *instructions*: of the step part."
    yield ""
    yield "`make skip` measures and writes `build/results/skip.json`; `make report PAGES=skip` makes this page of it."
    yield ""
    yield "## 1 % awake"
    yield ""
    yield "The share of the full cost that is left when 1 % of the objects are awake or alive:"
    yield ""
    yield from markdown(["program", "", "engine `fast`", "cycles on `many_full`"], verdict(found))
    yield ""
    yield ("An instruction takes one cycle per object in flight, but never less than its latency. With fewer awake objects than that, "
           "each costs more than its share; " + f"`many_full` has {data['idle_objects']:,} objects here.")
    yield ""
    for way in ORDER:
        if way in found:
            yield f"## {way[0].upper() + way[1:]}"
            yield ""
            yield TEXT[way]
            yield ""
            yield from table(found[way])
            yield ""
            if way == "flags":
                yield from luts()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bench", type=pathlib.Path, required=True, help="the program that measures")
    parser.add_argument("--output", required=True, help="the JSON file to write")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    try:
        data = measure(options)
    except bench.Failed as why:
        print(f"skip: {why}", file=sys.stderr)
        return 1
    print("\n".join(page(data)))
    for row in other(data["rows"]):
        print(f"skip: {row['way']}, {row['program']}, {row['side']}: {row['other_words']} words differ", file=sys.stderr)
    return 1 if other(data["rows"]) else 0


if __name__ == "__main__":
    sys.exit(main())
