"""The results as tables, for tools/pages.py: build/results/*.json and docs/synth.json to docs/results.md and to README's table.

Every figure in docs/results.md and between README's marks comes from here.
"""

import sys

from fp3gen.text import between, evidence, table

PAPER = {"first": 445, "next": 418, "ns": 3715.184}

# From the paper's machine to `single`, one change at a time: configuration, program, the change.
WALK = [
    ("paper", "ship_paper", "the paper's machine, our calibration"),
    ("paper", "ship", "another program: no register initialisation; other instructions fill the cycles in which the chain waits"),
    ("walk_slot", "ship", "write slots reserved at issue instead of a stall at each write"),
    ("walk_bypass", "ship", "results are bypassed straight to waiting operands"),
    ("single", "ship", "shallow cores: fewer cycles each, a slower clock"),
    ("single", "ship_madd", "chained multiply-add"),
]


def mark(name):
    return "\n".join(["", *evidence(name), ""])


def number(x, digits=0):
    return "–" if x is None else f"{x:,.{digits}f}"


def find(rows, what, **keys):
    for row in rows:
        if all(row[key] == value for key, value in keys.items()):
            return row
    sys.exit(f"{what}: nothing measured for " + ", ".join(f"{k} {v}" for k, v in keys.items()))


def nanoseconds(run, synth, grade):
    """At the best seed; None for a configuration that was not placed."""
    for row in synth:
        if (row["top"], row["config"], row["grade"]) == ("fp3", run["config"], grade):
            return run["cycles_per_object_step"] * 1000 / row["fmax_best"]
    return None


def ship(runs, synth):
    rows = []
    for run in runs:
        times = [nanoseconds(run, synth, grade) for grade in (6, 8)]
        if any(times):
            rows.append([f"`{run['config']}`", f"`{run['program']}`", number(run["first_cycles"]), number(run["next_cycles"]), run["objects"],
                         number(run["cycles_per_object_step"], 2), *(number(ns, 0 if run["objects"] == 1 else 1) for ns in times),
                         f"{run['rel_err_v']:.1e}", f"{run['rel_err_s']:.1e}"])
    return table(["configuration", "program", "first", "next", "objects", "cycles per object-step", "ns per object-step, grade 6", "grade 8",
                  "error of v", "error of s"], rows)


def walk(runs, synth):
    rows = [["the paper, Virtex-II grade 4", "", PAPER["first"], PAPER["next"], number(PAPER["ns"]), ""]]
    before = None
    for config, program, change in WALK:
        run = find(runs, "sim.json", config=config, program=program)
        ns = nanoseconds(run, synth, 6)
        rows.append([change, f"`{config}`, `{program}`", number(run["first_cycles"]), number(run["next_cycles"]),
                     number(ns), f"{ns - before:+,.0f}" if before else ""])
        before = ns
    return table(["change", "configuration, program", "first", "next", "ns, grade 6", "difference, ns"], rows)


# One row for each kind of machine: configuration, the cheapest program of the ship for it.
MACHINES = [("paper", "ship"), ("single", "ship_madd"), ("many", "ship_madd"), ("dual", "ship_dual"), ("lanes", "ship_madd")]


def clock(place):
    seeds = len(place["seeds"])
    return number(place["fmax_best"], 1) + (f" (best of {seeds})" if seeds > 1 else "")


def machines(runs, synth):
    rows = [["the paper's FPGA (Virtex-II, grade 4)", "the paper's", 1, number(PAPER["next"], 2), number(1000 * PAPER["next"] / PAPER["ns"], 1), "",
             number(PAPER["ns"], 1)]]
    for config, program in MACHINES:
        run = find(runs, "sim.json", config=config, program=program)
        place = find(synth, "synth.json", top="fp3", config=config, grade=6)
        rows.append([f"`{config}`", f"`{program}`", run["objects"], number(run["cycles_per_object_step"], 2), clock(place), number(place["lut4"]),
                     number(nanoseconds(run, synth, 6), 1)])
    return table(["machine", "program", "objects in flight", "cycles per object-step", "MHz", "LUT4", "ns per object-step"], rows)


def merged(rows):
    """Rows that differ in their first cell alone become one, with all of these cells."""
    found = {}
    for first, *rest in rows:
        found.setdefault(tuple(rest), []).append(first)
    return [[", ".join(firsts), *rest] for rest, firsts in found.items()]


def stalls(runs):
    """Every run starts and drains; a row is a run that waits for something else, too."""
    causes = list(runs[0]["stalls"])
    waits = [r for r in runs if any(r["stalls"][cause] for cause in causes if cause not in ("fetch", "drain"))]
    return table(["configuration", "program", *causes], merged(
        [f"`{r['config']}`", f"`{r['program']}`", *(number(r["stalls"][c]) for c in causes)] for r in waits))


def occupancy(runs):
    rows = []
    for run in runs:
        if run["objects"] == 1:
            continue
        use = run["unit_utilisation"]
        rows.append([f"`{run['config']}`", f"`{run['program']}`", run["objects"],
                     number(run["cycles_per_object_step"], 3), number(run["bound"], 3),
                     number(100 * run["bound"] / run["cycles_per_object_step"], 1),
                     *(number(100 * use[unit], 1) for unit in ("issue", "mul", "add"))])
    return table(["configuration", "program", "objects", "cycles per object-step", "bound", "% of the bound",
                  "issue slots used, %", "multiplier, %", "adder, %"], merged(rows))


def scenes(rows):
    full = {row["program"]: row for row in rows if row["scene"] in ("resident", "all awake")}
    return table(["scene", "program", "objects", "awake", "steps", "cycles", "cycles per object-step",
                  "against", "cycles, %", "cycles per object-step, %", "mismatches"],
                 [[row["scene"], f"`{row['program']}`", number(row["objects"]), number(row["awake"]), row["steps"],
                   number(row["cycles"]), number(row["cycles_per_object_step"], 2), full[row["program"]]["scene"],
                   number(100 * row["cycles"] / full[row["program"]]["cycles"], 2)
                   if row["steps"] == full[row["program"]]["steps"] and row["objects"] == full[row["program"]]["objects"] else "–",
                   number(100 * row["cycles_per_object_step"] / full[row["program"]]["cycles_per_object_step"], 1),
                   f"{row['mismatches']} of {row['words']:,}"] for row in rows])


def lanes(synth):
    rows = []
    for row in synth:
        other = next((one for one in synth if (one["top"], one["config"], one["grade"]) == ("lane", row["config"], 8)), None)
        if row["top"] != "lane" or row["grade"] != 6 or not other:      # other arithmetics are placed at grade 6 alone: docs/arithmetic_results.md
            continue
        rows.append([f"`{row['config']}`", row["lut4"], row["comb"], row["ff"], row["dsp"], row["ebr"],
                     f"{row['fmax_best']:.1f} / {row['fmax_median']:.1f}",
                     f"{other['fmax_best']:.1f} / {other['fmax_median']:.1f}"])
    return table(["lane of", "LUT4", "cells", "FF", "DSP", "EBR", "MHz grade 6, best / median", "MHz grade 8"], rows)


def trims(rows):
    bases = {row["what"]: row["lut4"] for row in rows}
    return table(["", "LUT4", "against the base", "carry cells", "FF", "DSP", "EBR"],
                 [[row["what"], number(row["lut4"]), f"{row['lut4'] - bases[row.get('base', rows[0]['what'])]:+,d}", number(row["carry"]), number(row["ff"]),
                   row["dsp"], row["ebr"]] for row in rows])


def cores(synth):
    rows = []
    for row in synth:
        if not row["config"].startswith("cuts") or row["grade"] != 6:
            continue
        other = find(synth, "synth.json", top=row["top"], config=row["config"], grade=8)
        rows.append([f"`{row['top']}`", row["cuts"], row["lut4"], row["comb"], row["ff"], row["dsp"],
                     f"{row['fmax_best']:.1f} / {row['fmax_median']:.1f}",
                     f"{other['fmax_best']:.1f} / {other['fmax_median']:.1f}", number(row["latency_ns"], 1),
                     number(other["latency_ns"], 1)])
    rows.sort(key=lambda r: (r[0], r[1]))
    return table(["core", "cuts", "LUT4", "cells", "FF", "DSP", "MHz grade 6, best / median", "MHz grade 8",
                  "ns grade 6", "ns grade 8"], rows)


def proofs(rows):
    groups = {}
    for row in rows:
        group = groups.setdefault(row["core"], {"questions": 0, "seconds": 0.0, "verdicts": set()})
        group["questions"] += 1
        group["seconds"] += row["seconds"]
        group["verdicts"].add(row["verdict"].split(":")[0].split(",")[0])
    return table(["what", "questions", "seconds on one core", "verdicts"],
                 [[core, g["questions"], number(g["seconds"], 1), ", ".join(sorted(g["verdicts"]))]
                  for core, g in groups.items()])


def handwritten(runs, rows):
    """The ship by the paper's integrator: as people wrote it, compiled, and with h/m folded."""
    by_hand = [("by hand, `ship`", "ship"), ("by hand, `ship_madd`", "ship_madd")]
    lines = []
    for text, program in by_hand:
        cycles = [find(runs, "sim", config=config, program=program) for config in ("single", "many")]
        lines.append([text, number(cycles[0]["next_cycles"]), number(cycles[1]["cycles_per_object_step"], 2), "", "", ""])
    for arithmetic in ("plain", "folded", "compensated"):
        row = find(rows, "models", model="ship", integrator="rk4_paper", arithmetic=arithmetic)
        lines.append([f"compiled, {arithmetic}", number(row["single_full"]["measured"]), number(row["many_full"]["measured"], 2),
                      row["operations"], row["instructions"], f"{row['floor']:.1e}"])
    return table(["program", "cycles, one object", "cycles per object-step, many", "operations", "instructions",
                  "smallest error"], lines)


def slope(x):
    return "–" if x is None else f"{x:.2f}"


def error(x):
    return "–" if x is None else f"{x:.1e}"


def models(rows):
    lines = []
    for row in rows:
        if row["integrator"] == "rk4" and row["arithmetic"] == "plain":
            more = find(rows, "models", model=row["model"], integrator="rk4", arithmetic="compensated")
            single = row["single_full"]
            lines.append([f"`{row['model']}`", row["operations"], row["instructions"], number(row["many_full"]["measured"], 2),
                          number(single["measured"], 1), number(single["bound"], 1), slope(row["measured_order"]),
                          slope(row["method_order"]), slope(row["finest_order"]), error(row["floor"]),
                          error(more["floor"]), number(more["many_full"]["measured"], 2)])
    return table(["model", "operations", "instructions", "cycles, many", "cycles, one object", "its bound", "slope in FP32",
                  "in double, same steps", "in double, finest", "smallest error", "compensated", "its cycles, many"], lines)


def cheapest(row, tolerance):
    """Cycles per object of the cheapest run over the span that is within the tolerance."""
    runs = [steps for steps, error in zip(row["errors"]["steps"], row["errors"]["error"])
            if error is not None and error <= tolerance]
    return min(runs) * row["many_full"]["measured"] if runs else None


def precision(rows, model):
    """What takes at most twice the cycles of the cheapest, at some error."""
    costs = {(row["integrator"], row["arithmetic"]): [cheapest(row, 10.0 ** -n) for n in range(2, 8)]
             for row in rows if row["model"] == model and row["arithmetic"] != "folded"}
    least = [min(filter(None, column), default=0) for column in zip(*costs.values())]
    lines = [[f"`{integrator}`" + ("" if arithmetic == "plain" else f", {arithmetic.replace('_', '-')}"), *map(number, cost)]
             for (integrator, arithmetic), cost in costs.items() if any(one and one <= 2 * best for one, best in zip(cost, least))]
    return table(["integrator", *[f"10^-{n}" for n in range(2, 8)]], lines)


def compared(rows):
    words = sum(row["compared"] for row in rows)
    lines = [f"{len(rows)} rows, each a model, an integrator and an arithmetic; {sum(row['mismatches'] for row in rows)} of "
             f"{words:,} words differ between hardware, the engines isa and fast, and the equations."]
    for machine in ("many_full", "single_full", "sixteen"):
        ratios = sorted(row[machine]["predicted"] / row[machine]["bound"] for row in rows)
        close = sum(ratio <= 1.05 for ratio in ratios)
        exact = sum(row[machine]["predicted"] == row[machine]["measured"] for row in rows)
        lines.append(f"- `{machine}`: {exact} predicted to the cycle; {close} within 5 % of the bound, "
                     f"{100 * (sum(ratios) / len(ratios) - 1):.1f} % above it on average, the worst "
                     f"{100 * (ratios[-1] - 1):.1f} %" + (
                         "; a step takes one cycle per instruction, and the bound leaves out instructions that only keep an old value "
                         "(a compensated update needs one)" if machine != "single_full" else ""))
    for text, name, other in (("slopes in FP32 within 0.2 of the order", "measured_order", "order"),
                              ("slopes in FP32 within 0.2 of the same in double", "measured_order", "method_order"),
                              ("slopes in double, steps as fine as they go, within 0.2 of the order", "finest_order", "order")):
        both = [abs(row[name] - row[other]) for row in rows if row[name] is not None and row[other] is not None]
        lines.append(f"- {text}: {sum(x <= 0.2 for x in both)} of {len(both)} rows")
    return "\n".join(lines)


def of_runs(runs, all_scenes, synth):
    """Sections that come from `make all sim`."""
    return f"""## The ship, Equations (1): `make all sim`, `make synth`
{mark("results.ship")}
The paper's machine takes {PAPER['first']} cycles for the first step and {PAPER['next']} for each next one, which is {PAPER['ns']:,.0f} ns.
The columns *first* and *next* have the cycles of our configurations. In {len(runs)} runs {sum(run['mismatches'] for run in runs)} of
{sum(run['words'] for run in runs):,} words differ from those of the ship in C (`sw/lab/golden`). The table has the configurations that were placed.
Errors are relative, against GSL's rk8pd in double. `s = s + h*v1` is of first order in the position, so the error of s comes from the formula, not
from rounding.

{ship(runs, synth)}

## From the paper's machine to `single`, one change at a time
{walk(runs, synth)}

## Many objects: `make all sim`
The *bound* is the largest of what an object-step needs of the configuration's issue slots, adders and multipliers. The next column says how close the cycles
come to it, the last three how much of these the run used.

{occupancy(runs)}

## Ten thousand objects from the store, on `crowd`: `make all sim`
{scenes(all_scenes)}
"""


def of_models(runs, rows):
    return f"""## Models and integrators: `make models`
{mark("results.models")}
{compared(rows)}

The ship of Equations (1):

{handwritten(runs, rows)}

Every model by `rk4`. A *slope* is that of log(error) over log(h), over a factor of 2.8 in h, where the error is five times what FP32 adds to it. The
*smallest error* is that of the best step: relative, the root mean square over the states at eight times. A folded program has h and known
factors in one number.

{models(rows)}

The next two tables have the cycles that an object takes on `many_full` over the whole span to stay within a relative error, of
the integrators that take at most twice the cycles of the cheapest at some error. Kepler's problem, two orbits with eccentricity 0.5:

{precision(rows, "kepler")}

The damped oscillator, whose acceleration depends on the velocity:

{precision(rows, "oscillator")}
"""


def of_lanes(synth):
    return f"""## One lane alone: `make synth TOP=lane`
{mark("results.synth")}
A lane has its arithmetic and its store. `-inferred` leaves out the registers inside the device's multipliers and block RAM.

{lanes(synth)}
"""


def of_trims(found):
    return f"""## What each feature costs: `make synth TOP=trim`
{mark("results.trims")}
The base is `many`, and below it `many_full`, with a store of 1,024 words. Each row makes one change. Cells are counted after synthesis, not placed.
Programs that still run give the same bits.

{trims(found)}
"""


def of_stalls(runs):
    return f"""## Where the cycles went
{mark("results.ship")}
The columns are the stall cycles of the whole run, by cause. Runs that wait only for their first instruction and their last result are left out.

{stalls(runs)}
"""


def of_cores(synth):
    return f"""## Floating-point cores: `make synth TOP=fp_add`, `make synth TOP=fp_mul`
{mark("results.synth")}
The cores round correctly (IEEE 754 binary32), with gradual underflow and flags. The latency in ns is (cuts + 1) periods at the best seed.

{cores(synth)}
"""


def of_proofs(proved):
    return f"""## Proofs: `make prove`
{mark("results.proofs")}
{proofs(proved)}
"""


def page(sim, rows, proved, placed):
    """The page, less the sections of what was not measured (None)."""
    synth = placed_here(placed)
    fields = max(synth, key=lambda row: len(row["seeds"]))
    runs = sim and sim["runs"]
    parts = [f"""<!-- Generated by tools/pages.py (make report PAGES=results): do not edit. -->
# Results

*Measured, for FPGAs.*

Cycles are exact and the same on every machine. Clock rates are estimates after place and route on LFE5U-85F (CABGA381; other devices:
[sizes.md](sizes.md)), by yosys and nextpnr-ecp5 in the versions that `make setup-fpga` pins. They are of the whole processor, at the best of the seeds that
sizes.md lists, or of a lane or a core from operand register to result register, with the seeds {', '.join(map(str, fields['seeds']))} (some only with the first).
*LUT4* counts logic alone. *Cells* are what nextpnr places (TRELLIS_COMB): logic, two for each carry cell, and distributed RAM.
Nanoseconds are cycles divided by the clock rate.
"""]
    parts += [of_runs(runs, sim["scenes"], synth)] if runs else []
    parts += [of_models(runs, rows)] if runs and rows else []
    parts += [of_lanes(synth), of_trims(placed["trims"])]
    parts += [of_stalls(runs)] if runs else []
    parts += [of_cores(synth)]
    parts += [of_proofs(proved)] if proved else []
    return "\n".join(parts)


def placed_here(placed):
    """Other devices: docs/sizes.md."""
    return [row for row in placed["rows"] if row["device"] == "LFE5U-85F" and row["fmax_best"]]


def readme(text, sim, placed):
    """README with its table of machines."""
    return between(text, "machines", machines(sim["runs"], placed_here(placed)).splitlines())
