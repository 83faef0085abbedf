"""What synthesis, place and route have measured, for tools/synth.py, tools/chip.py and the pages that come from it.

build/results/synth.json has what was measured in this folder, docs/synth.json what the pages of docs/ show. Whoever writes
a page takes the former into the latter, row by row: a part that is measured again renews its rows alone.
"""

import json
import pathlib

ROOT = pathlib.Path(__file__).resolve().parents[1]
HERE = ROOT / "build/results/synth.json"
KEPT = ROOT / "docs/synth.json"
DEVICE, GRADE = "LFE5U-85F", 6       # where a configuration has its clock
CELLS = ("lut4", "carry", "ff", "dsp", "ebr")
RUNS = [ROOT / "build/results" / name for name in ("sim.json", "chip.json")]    # of a bench, of `make chip-run`


def read(path):
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {"rows": [], "trims": []}


def write(path, rows, trims):
    """A line for each row, so that a change shows which one it is."""
    def lines(part):
        return "[\n" + ",\n".join(map(json.dumps, part)) + "\n]" if part else "[]"

    path.parent.mkdir(parents=True, exist_ok=True)
    path.with_suffix(".tmp").write_text(f'{{"rows": {lines(rows)},\n"trims": {lines(trims)}}}\n', encoding="utf-8")
    path.with_suffix(".tmp").replace(path)


def key(row):
    return row["top"], row["config"], row["device"], row["grade"]


def changes(before, row):
    """The figures of cells that differ, as text."""
    return [f"{figure} {before[figure]} is {row[figure]}" for figure in CELLS if before[figure] != row[figure]]


def merged(old, new):
    """Results with rows in place of those of the same top, configuration, device and grade; trims in place of all. A row whose cycles
    are not known here has those of before. One that was only synthesised, to the cells that were placed before, leaves that row."""
    rows = {key(row): row for row in old["rows"]}
    for row in new["rows"]:
        if not row["seeds"] and (before := rows.get(key(row))) and not changes(before, row):
            continue
        rows[key(row)] = row if row["cycles"] else timed(row, rows.get(key(row), {}).get("cycles"))
    return {"rows": [rows[k] for k in sorted(rows)], "trims": new["trims"] or old["trims"]}


def clocks(device=DEVICE, grade=GRADE):
    """MHz of each configuration that was placed there, at the best of its seeds, as the pages have it."""
    return {row["config"]: row["fmax_best"] for row in read(KEPT)["rows"]
            if (row["top"], row["device"], row["grade"]) == ("fp3", device, grade) and row["fmax_best"]}


def add(rows, trims=()):
    """To what was measured here."""
    write(HERE, **merged(read(HERE), {"rows": rows, "trims": trims}))


def known():
    """All there is: what was kept, and what was measured here."""
    return merged(read(KEPT), read(HERE))


def compared(rows):
    """Lines on the kept rows that these cells are not those of, and how many are."""
    kept = {key(row): row for row in read(KEPT)["rows"]}
    known = [row for row in rows if key(row) in kept]
    others = [(row, found) for row in known if (found := changes(kept[key(row)], row))]
    yield from (f"{row['top']} {row['config']}, {row['device']} grade {row['grade']}: {', '.join(found)}" for row, found in others)
    yield f"{len(known) - len(others)} of {len(known)} rows have the cells that docs/synth.json says"


def keep():
    """Puts all there is into docs/synth.json."""
    if HERE.exists():
        write(KEPT, **known())


def cycles_per_step(config):
    """Cycles per object-step of the ship, by the cheapest of the programs that a bench, or `make chip-run`, has run."""
    runs = [run for path in RUNS if path.exists() for run in json.loads(path.read_text(encoding="utf-8"))["runs"]]
    return min((run["next_cycles"] / run["objects"] for run in runs if run["config"] == config), default=None)


def timed(row, cycles):
    """A row with the cycles, and with what they make of its clock."""
    best = row["fmax_best"]
    return row | {
        "cycles": cycles, "latency_ns": round(cycles * 1000 / best, 2) if cycles and best else None,
        "object_steps_per_second": round(best * 1e6 / cycles) if cycles and best and row["top"] in ("fp3", "chip") else None,
    }
