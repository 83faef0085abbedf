#!/usr/bin/env python3
"""What each arithmetic does to the error of models, and what it costs: `make arithmetic`.

    tools/arithmetic.py --fp3 build/bin/fp3 --output build/results/arithmetic.json    measures

A configuration stands for an arithmetic: the same machine but for that. `fp3 bench MODEL --config` has the error of each integrator and time
step against the truth, over 64 objects that differ, and the cycles of the hardware, whose bits must be those of engine fast or isa. LUTs and clock
are those of `make synth TOP=fp3`.

The result is an object. `rows` has arithmetic, model, integrator (with its update, and its steps), error_median, error_worst, cycles of an object over
the model's span, lut4, mhz (null: not placed) and words_differing. `units` has the cores: unit, lut4, ff, dsp, ebr, cuts, mhz_median,
error_bound_ulp, inputs_checked. `left_out` says which arithmetic cannot run what, and why.
"""

import argparse
import collections
import concurrent.futures
import datetime
import io
import json
import pathlib
import re
import subprocess
import sys
import tempfile

from fp3gen.text import evidence, markdown
import measured
import plot

ROOT = pathlib.Path(__file__).resolve().parents[1]
# Configuration, and what pages call its arithmetic. `pairs` is not among them: it is another machine, which has neighbours and neither sleep nor status.
ARITHMETICS = {"many_full": "binary32", "flush": "flushed", "cell": "Cell's", "fused_full": "fused", "log": "logarithmic", "middle": "15 bits", "bfloat": "bfloat16"}
INTEGRATORS = ("euler", "semi_implicit_euler", "leapfrog", "rk4", "dopri5")
# Cores: the worst error of an operation in units of the last place, and the inputs that were checked. By proof: to nearest half a unit, truncated one, for all pairs;
# of the multiply-add no number, as its proof leaves out subnormal factors. Logarithms: all inputs of their functions (docs/logarithmic.md).
UNITS = [(top, config, 1 if config == "cell" else 0.5, 2 ** (18 + 2 * fraction))
         for config, fraction in (("many_full", 23), ("flush", 23), ("cell", 23), ("middle", 15), ("bfloat", 7)) for top in ("fp_add", "fp_mul")]
UNITS += [("fp_fma", "fused_full", 0.5, None), ("lns_add", "log", 0.65, 2 ** 29), ("lns_mul", "log", 0, None), ("lns_root", "log", 0.5, None),
          ("lns_from_float", "log", 0.57, 2 ** 23), ("lns_to_float", "log", 0.57, 2 ** 24)]
DEVICE, GRADE = "LFE5U-85F", 6
COLOURS = ("#0072b2", "#009e73", "#d55e00", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
TARGETS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
WORTH = 0.95    # of the cost of binary32: below it another is worth the change


def placed(rows, top, config):
    """The row of make synth, or nothing."""
    return next((row for row in rows if (row["top"], row["config"], row["device"], row["grade"]) == (top, config, DEVICE, GRADE)), None)


def models():
    return sorted(path.stem for path in (ROOT / "programs").glob("*.ode"))


def bench(fp3, model, config, integrators):
    """The points of the hardware, or why there are none."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "x.json"
        done = subprocess.run([fp3, "bench", f"programs/{model}.ode", "--no-times", "--config", config, "--json", path,
                               *(f"--integrator={name}" for name in integrators)], cwd=ROOT, capture_output=True, text=True)
        if done.returncode == 2:
            return [], re.sub(r"^fp3 bench: |\x1b\[[0-9;]*m", "", done.stderr.strip().splitlines()[-1])
        if done.returncode:
            sys.exit(f"tools/arithmetic.py: {model}, {config}: {done.stderr.strip()}")
        points = json.loads(path.read_text())["points"]
        return [point for point in points if point["engine"] == "rtl" and point["arithmetic"] != "double_single"], None    # not all have it


def unit_of(synth, top, config, bound, checked):
    """A core as make synth has placed it, or nothing. One that any configuration has is of none."""
    of = placed(synth, top, config) or placed(synth, top, "any")
    return of and {"unit": top, "arithmetic": ARITHMETICS[config], "lut4": of["lut4"], "ff": of["ff"], "dsp": of["dsp"], "ebr": of["ebr"],
                   "cuts": of["cuts"], "mhz_median": of["fmax_median"], "error_bound_ulp": bound, "inputs_checked": checked}


def measure(fp3, wanted, integrators, synth, jobs):
    """Yields what there is after each model."""
    rows, left_out, done = [], [], []
    revision = subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=ROOT, capture_output=True, text=True).stdout.strip()
    units = [unit for unit in (unit_of(synth, *of) for of in UNITS) if unit]
    tasks = [(model, config) for model in wanted for config in ARITHMETICS]
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:       # errors and cycles do not depend on time
        for (model, config), (points, why) in zip(tasks, pool.map(lambda task: bench(fp3, *task, integrators), tasks)):
            print(f"{model}, {config}", file=sys.stderr, flush=True)
            arithmetic = ARITHMETICS[config]
            if why:
                left_out.append({"arithmetic": arithmetic, "model": model, "why": why})
            of = placed(synth, "fp3", config)
            rows += [{"arithmetic": arithmetic, "model": model,
                      "integrator": f"{point['integrator']}, {point['arithmetic']}", "h": point["h"], "tolerance": point["tolerance"],
                      "error_median": point["error_median"], "error_worst": point["error_worst"], "cycles": point["cycles"],
                      "lut4": of and of["lut4"], "mhz": of and of["fmax_median"], "words_differing": 0} for point in points]     # bench stops where one differs
            if config == list(ARITHMETICS)[-1]:
                done.append(model)
                yield {"measured": datetime.date.today().isoformat(), "revision": revision, "integrators": integrators, "models": done, "rows": rows,
                       "units": units, "left_out": left_out}


# ---- page and picture ---------------------------------------------------------------------------

def cost(row):
    """LUT4 times ns of an object over the span, or nothing."""
    return row["lut4"] * row["cycles"] * 1e3 / row["mhz"] if row["mhz"] else None


def cheapest(rows, target):
    """The row with the fewest cycles whose median error is at most the target."""
    good = [row for row in rows if row["error_median"] <= target]
    return min(good, key=lambda row: row["cycles"]) if good else None


def front(rows):
    """Points that no cheaper one is as accurate as."""
    kept = []
    for row in sorted((row for row in rows if cost(row)), key=cost):
        if not kept or row["error_median"] < kept[-1]["error_median"]:
            kept.append(row)
    return kept


def relative(rows, base, target):
    """What the target costs, relative to the base; nothing if either does not reach it or was not placed."""
    one, other = cheapest(rows, target), cheapest(base, target)
    return cost(one) / cost(other) if one and other and cost(one) and cost(other) else None


def best_error(rows):
    best = min(rows, key=lambda row: row["error_median"], default=None)
    if not best:
        return "–"
    worst = "∞" if best["error_worst"] is None else f"{best['error_worst']:.1e}"
    return f"{best['error_median']:.1e} ({worst})"


def median_cost(by, models_of, name, target):
    ratios = sorted(ratio for model in models_of if (ratio := relative(by[model, name], by[model, "binary32"], target)))
    reached = sum(cheapest(by[model, name], target) is not None for model in models_of)
    return f"{ratios[len(ratios) // 2]:.2f} ({reached})" if ratios else f"– ({reached})"


def pick(by, model, names, target):
    """The cheapest arithmetic, if it saves something; what reaches the target at all, if binary32 does not."""
    ratios = {name: ratio for name in names if (ratio := relative(by[model, name], by[model, "binary32"], target))}
    if not ratios:
        others = [name for name in names if cheapest(by[model, name], target)]
        return f"only {others[0]}" if others else "–"
    name = min(ratios, key=ratios.get)
    return f"{name} {ratios[name]:.2f}" if ratios[name] <= WORTH else "binary32"


def lines(head, rows):
    return "\n".join([*markdown(head, rows), ""])


def page(found):
    by = collections.defaultdict(list)
    for row in found["rows"]:
        by[row["model"], row["arithmetic"]].append(row)
    names = [name for name in ARITHMETICS.values() if any(key[1] == name for key in by)]
    all_models = sorted({key[0] for key in by})
    yield "Of 64 objects that differ; integrators: " \
          f"{', '.join(f'`{name}`' for name in found['integrators'])}, plain, compensated and folded, with fixed and with adaptive steps.\n\n"
    yield "\n".join([*evidence("arithmetic.models"), "", ""])
    yield "The first table has the smallest error of each model (median of the objects, relative to the size of each state) in each arithmetic, " \
          "and the worst object's, in brackets. *–*: it cannot run the model.\n\n"
    yield lines(["model", *names], [[f"`{model}`", *(best_error(by[model, name]) for name in names)] for model in all_models])
    yield "\nThe second table has the cost of reaching an error: the fewest cycles of an object over the model's span, times the time of a cycle, times the LUT4 of " \
          "the machine, relative to binary32. Less than 1 is cheaper. The median over the models, and in brackets how many of them reach that error. LUT4 are not all: " \
          "`log` has six multipliers and 61 block RAMs where `many_full` has three and 56, and `middle` and `bfloat` have one multiplier.\n\n"
    yield lines(["error", *names], [[f"{target:.0e}", *(median_cost(by, all_models, name, target) for name in names)] for target in TARGETS])
    yield "\nThe third table says what to pick for a model and an error: the arithmetic of the lowest cost and this cost relative to binary32, or binary32 if nothing saves " \
          f"{1 - WORTH:.0%}. *–*: nothing reaches the error.\n\n"
    yield lines(["model", *(f"{target:.0e}" for target in TARGETS)],
                     [[f"`{model}`", *(pick(by, model, names, target) for target in TARGETS)] for model in all_models])
    yield "\n![Error against cost for each model, a line for each arithmetic](arithmetic.svg)\n\n"
    yield "*Error (median) against LUT4 times µs of an object over the span, the best of all integrators and steps. Further left is cheaper, further down more accurate.*\n"


def draw(found):
    """The picture."""
    by = collections.defaultdict(list)
    for row in found["rows"]:
        by[row["model"]].append(row)
    columns = 4
    lines = -(-len(by) // columns)
    figure = plot.figure((12, 2.4 * lines))
    axes = figure.subplots(lines, columns, squeeze=False)
    for ax in axes.flat[len(by):]:
        ax.set_visible(False)
    for ax, model in zip(axes.flat, sorted(by)):
        for name, colour in zip(ARITHMETICS.values(), COLOURS):
            points = front([row for row in by[model] if row["arithmetic"] == name])
            if points:
                ax.loglog([cost(row) / 1e3 for row in points], [row["error_median"] for row in points], color=colour, linewidth=1.2, label=name)
        ax.minorticks_off()
        ax.set_title(model, fontsize=9)
        ax.tick_params(labelsize=7)
        ax.grid(alpha=0.3)
    axes.flat[0].legend(fontsize=7)
    figure.supxlabel("LUT4 times µs of an object over the span", fontsize=9)
    figure.supylabel("error, median", fontsize=9)
    figure.tight_layout()
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
    return plot.for_dark(re.sub(r"'DejaVu Sans'[^;\"]*", "sans-serif", text.getvalue()))


def main():
    parser = argparse.ArgumentParser(description="What each arithmetic does to the error of models, and what it costs.")
    parser.add_argument("--fp3", required=True, help="the program")
    parser.add_argument("--output", type=pathlib.Path, required=True, help="the figures, JSON")
    parser.add_argument("--model", action="append", help="only this model of programs/; may be repeated")
    parser.add_argument("--integrator", action="append", help=f"only this integrator; may be repeated (default: {', '.join(INTEGRATORS)})")
    parser.add_argument("--jobs", type=int, default=1, help="runs at a time (default: %(default)s)")
    args = parser.parse_args()
    args.output.parent.mkdir(parents=True, exist_ok=True)
    for found in measure(args.fp3, args.model or models(), args.integrator or INTEGRATORS, measured.known()["rows"], args.jobs):
        args.output.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
