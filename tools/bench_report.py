"""Error against run time as pictures and tables, for tools/pages.py: docs/benchmarks.md and docs/benchmarks.html from build/results/bench.json.

Both pages name the data that they are made from: a hash. The figures are medians, the pictures plain SVG; what stands under the pointer says what a
point is.
"""

import hashlib
import html
import json
import math
import re

from fp3bench.figures import PEERS, curves, fast_of, fronts, in_fp32, speed_grids, summary
from fp3gen.text import evidence, table
from plot import inline

LEAST_RATIO = 20        # fast is to be so many times as fast as GSL at the same error
INTRODUCTION = """\
Every method here integrates every model of `programs/` from 0 to its span. The tables and pictures have the error at the end and the time that one object
takes.

- *Objects* are 64 variants of the model: the params of each are 0.1 % larger than those of the previous variant, and its start 0.2 %.
- *Errors* are relative to the largest magnitude that each state reaches, and the root mean square over the states. Tables and pictures have the median of
  the variants. Errors are measured against the [truth](truth.md). A model has no results if one of its variants has no truth.
- *Times* are nanoseconds for one object over the whole span, medians of repeats. Methods that solve the same model alternate on the same machine, so a
  slow machine slows all of them. A run of `fast` has up to 16,384 objects. Compiling the program and writing the start are not timed.
- *Fixed time steps* are the span over 1, 2, 4, 8, ..., until smaller steps gain nothing, or down to 1,024 times below the first that solves the
  model. A time is of a run, so it may be up to twice that of the best step for its error. A step is not timed if it takes more than 8 times the instructions of one that is at least as accurate. Two such steps in a row, in the same
  arithmetic, end the list, if they are at least 16 times below the first; of tolerances any two do. Points within 1.5 times the fastest equally
  accurate point of their engine are run up to 3 times, and with all threads, too. All others are run once.
- *Adaptive steps* (`dopri5 adaptive` and so on) have tolerances from 1e-2 down, until an object does not reach the end or the arithmetic has no such
  tolerance. `absolute` is the tolerance times the smallest size of a state.
- *Events.* Fixed steps are measured as they are, so that an event happens up to a step late, and cut at events (`rk4 cut`), with a condition located to
  2^-14 of the step.
- *Cycles* of adaptive and of cut steps are measured under Verilator, from the coarsest steps on, until the runs of an integrator in an arithmetic have
  300,000 instructions together, and only where no other way takes a quarter of the cycles.
- *Checks.* Before it is timed, `fast` must have the bits of `isa` and of the Verilated hardware, and the hardware the cycles that the compiler predicts.
- *Peers* run in double, one object after another, with tolerances from 1e-2 to 1e-10 relative to the size of each state. Their right-hand side is C,
  compiled with `cc -O3 -march=native`. Memory is allocated once, not for each object. Jacobians are differences. GSL's `rk4` has fixed steps, and makes two
  of h/2 for each h. The sweep of a peer ends when two tolerances in a row are no better than the best, or when a run of the 64 objects takes more than half
  a second. Models with events are measured without peers, because these do not look for events.
- *`plain_c`* is the loop that a game has: rk4 in FP32, one object at a time (`scalar`, -O2) or 64 in columns (`vectors`, -O3), with libm's functions. It
  handles events.

Models whose objects see each other (springs, contact, gravity) are measured on [their own page](world.md#beside-loops-written-by-hand), beside Warp,
Taichi, MuJoCo, Bullet, LAMMPS, Box2D and REBOUND."""


def number(x):
    """Three figures; all of a whole number."""
    if x is None:
        return "–"
    if isinstance(x, int) or x >= 100:
        return f"{x:,.0f}"
    return f"{x:.{max(0, 2 - math.floor(math.log10(x)))}f}" if x > 0 else "0"


def digest(data):
    """Of the figures."""
    return hashlib.sha256(json.dumps([data["points"], data["speed"]], sort_keys=True).encode()).hexdigest()[:16]


def about(data):
    a = data["about"]
    versions = "; " * bool(a["versions"]) + ", ".join(f"{name} {version}" for name, version in sorted(a["versions"].items()))
    failed = "".join(f" `{one['name']}` failed: {one['why']}." for one in data["failed"])
    hand = f"; the loop by hand is for `{a['target']}`" if "target" in a else ""        # of `speed`, which may not have been measured yet
    return (f"Last measured on {a['processors']} processors: {a['processor']}, {a['system']}; load at the end {a['load']:.1f}; {a['compiler']}{versions}"
            f"{hand}. Each section says when it was measured.{failed}")


# ---- the page in Markdown ---------------------------------------------------------------------------

def name_of(point):
    if point is None:
        return "–"
    if point["integrator"] and point["engine"] != "plain_c":
        return f"{point['integrator']}, {point['arithmetic']}"
    return point["method"]


def model_table(data, model):
    points = [point for point in data["points"] if point["model"] == model]
    fast = fast_of(data)
    rows = []
    for row in summary(points, fast):
        cells = [f"{row['error']:.0e}", number(row["fast"]["ns_per_object"]), name_of(row["fast"])]
        for who in ("adaptive", "all", "hardware", *PEERS):
            point = row[who]
            cells.append("–" if point is None else
                         number(point["ns_per_object"]) + ("" if who == "all" else f" ({name_of(point)})"))
        ratio = row["ratio"]
        cells.append("–" if ratio is None else digits(ratio) if ratio >= LEAST_RATIO else f"**{digits(ratio)}**")
        rows.append(cells)
    if not rows:
        return "No time step that was tried gets below an error of 1e-1."
    return table(["error", f"{fast}, one thread, ns", "by", "adaptive steps, ns", "all threads, ns", "hardware, ns", *(f"{name}, ns" for name in PEERS.values()),
                  "GSL / fast"], rows)


def digits(ratio):
    return f"{ratio:.1f}" if ratio < LEAST_RATIO else f"{ratio:.0f}"


def overview(data):
    rows = []
    for problem in data["problems"]:
        points = [point for point in data["points"] if point["model"] == problem["model"]]
        found = summary(points, fast_of(data))
        ratios = {row["error"]: row["ratio"] for row in found if row["is_fp32"] and row["ratio"] is not None}
        smallest = min((point["error_median"] for point in in_fp32(points, fast_of(data))), default=None)
        rows.append([f"[`{problem['model']}`](#{problem['model']})", problem["doc"], "–" if smallest is None else f"{smallest:.1e}",
                     f"{digits(min(ratios.values()))} to {digits(max(ratios.values()))}" if ratios else "–",
                     "–" if not ratios else "yes" if min(ratios.values()) >= LEAST_RATIO else
                     "no: " + ", ".join(f"{digits(ratio)} at {error:.0e}" for error, ratio in sorted(ratios.items(), reverse=True) if ratio < LEAST_RATIO)])
    return table(["model", "", "smallest error in FP32", "GSL / fast", f"{LEAST_RATIO} times at every error"], rows)


def speed_tables(data):
    for title, head, rows in speed_grids(data["speed"]):
        yield f"{title}\n\n" + table(head, [[row[0]] + [number(cell) for cell in row[1:]] for row in rows])


def bodies(data):
    if {"box2d", "ode"} & {row["engine"] for row in data["speed"]}:
        yield ("`box2d` and `ode` are free bodies of Box2D and of the Open Dynamics Engine: thrust as a force, drag as their linear damping, no shapes and so "
               "no contacts, one step with one iteration (`dWorldQuickStep` in ODE); making the bodies is not timed. They do more than the ship asks for: two or "
               "three dimensions, a rotation, a search for islands of bodies that touch. They do less: one evaluation of the drag for each step, where rk4 has "
               "four. Their results are within 1 % of the ship's speed.")


def recording(data):
    for row in data["output"]:
        yield from ("## Recording", "\n".join(evidence("bench.output")))
        yield (f"`fp3 run --engine fast --output FILE.h5` with {row['objects']:,} objects of `{row['program']}`, {row['snapshots']} snapshots of {row['states']} states: "
               f"{row['bytes'] / 1e6:,.0f} MB in {row['seconds']:.2f} s, with all bytes on the disk ({row['bytes'] / 1e6 / row['seconds']:,.0f} MB/s), "
               f"and at most {row['memory_mb']:.0f} MB of memory. `dd` writes the same bytes to the same disk in {row['dd_seconds']:.2f} s: the recording "
               f"reaches {100 * row['ratio_to_dd']:.0f} % of that. Medians of {row['repeats']} alternating repeats.")


# What a message says of one program, and what remains of it for many.
KINDS = [(r".*needs `([^`]+)`, which configuration '(\w+)' does not have.*", r"configuration '\2' has no `\1`"),
         (r"the program needs \d+ words of instruction memory, configuration '(\w+)' has (\d+).*", r"more than the \2 words of program that '\1' has"),
         (r"the program needs \d+ (object registers|shared constants), configuration '(\w+)' has (\d+).*", r"more than the \3 \1 that '\2' has"),
         (r"[\d:]+ error: (.*)", r"\1")]


def kind_of(why):
    why = why.split("\n")[0]
    for pattern, kind in KINDS:
        if re.fullmatch(pattern, why):
            return re.sub(pattern, kind, why)
    return why


def listed(names, all_of_them):
    return "all" if names == all_of_them and len(names) > 1 else ", ".join(sorted(names))


def left_out(data):
    """A row for each engine and reason: what was left out for it, methods and models."""
    by_why, methods = {}, {}
    for row in data["left_out"]:
        method = row["method"] or row["integrator"] or "all"
        methods.setdefault(row["engine"], set()).add(method)
        of = by_why.setdefault((row["engine"], kind_of(row["why"])), (set(), set()))
        of[0].add(method)
        of[1].add(row["model"])
    models = {problem["model"] for problem in data["problems"]}
    return table(["engine", "why", "methods, some or all of whose points", "of models"],
                 [[engine, why, listed(of[0], methods[engine]), listed(of[1], models)]
                  for (engine, why), of in sorted(by_why.items())])


def without(data, engine):
    """A sentence on the models that a peer was not run on, though it could."""
    measured = {row["model"] for row in data["points"] + data["left_out"] if row["engine"] == engine}
    models = [f"`{one['model']}`" for one in data["problems"] if one["model"] not in measured and not one.get("has_events")]
    return f" Not measured: {', '.join(models)}." if models else ""


def markdown(data):
    engines = {point["engine"] for point in data["points"]}
    parts = [f"<!-- Generated by tools/pages.py (make report PAGES=bench) from data {digest(data)}: do not edit. -->", "# Error against run time",
             "*Measured, for numerics.*", about(data),
             INTRODUCTION,
             "diffrax (JAX) is in the tables: `make setup-bench` installs it. All its objects are solved at once, by vmap and jit, on all processors: the 64 "
             "variants, and 256 copies of each. Compiling is not timed. Its implicit solvers are left out." + without(data, "diffrax") if "diffrax" in engines else
             "diffrax (JAX) was not measured: `make setup-bench` installs it.",
             "heyoka.py (Taylor's method in double, compiled for each model and tolerance) is in the tables: `make setup-bench` installs it. 256 objects, on one processor: one "
             "after another (`taylor`), or as many at once as a vector has numbers (`taylor batch`). Compiling is not timed. Tolerances are from 1e-2 to 1e-14." + without(data, "heyoka") if "heyoka" in engines else
             "heyoka.py was not measured: `make setup-bench` installs it.",
             "The same as pictures: [benchmarks.html](benchmarks.html), for a browser; it loads nothing. `make bench` writes `build/results/benchmarks.html`, "
             "with a picture of all integrators for each model, and the data behind it, `bench.json`, `bench.csv` and `bench_speed.csv`.",
             "## The models side by side", "*GSL / fast* is the shortest time of GSL divided by that of the engine `fast` with one thread, "
             "at each error from 1e-1 down to the smallest that FP32 reaches. Only the tables of the models have smaller errors, which need double-single. "
             f"There a ratio below {LEAST_RATIO} is bold.", overview(data),
             "## Model by model", "The shortest time of each engine to get below an error (median of the variants). Hardware is the better of `many_full` and "
             "`single_full`, at its routed clock (speed grade 6, " +
             ", ".join(f"`{name}` {data['about']['mhz'][name]:.1f} MHz" for name in ("many_full", "single_full") if name in data["about"]["mhz"]) +
             ", from [sizes](sizes.md)); `many_full` has 24 objects in flight, and the figure is the time for one of them."]
    for problem in data["problems"]:
        parts += [f"### {problem['model']}", "\n".join(evidence(f"bench.{problem['model']}")), f"{problem['doc']}; {problem['span']:g} time units, {problem['states']} states.",
                  model_table(data, problem["model"])]
    speed = ["## Speed", "\n".join(evidence("bench.speed")), "Nanoseconds for a step of one object: the ship, Equations (1), as `programs/ship.s` has it. The loop by hand "
              "(`bench/ship.c`) has vectors of 16 floats, 1 to 8 of them interleaved. All results have its bits, except those of GSL and of physics engines. "
              "The figure in brackets is the time relative to the best loop by hand in the same cell.", *bodies(data), *speed_tables(data)]
    parts += [*(speed if data["speed"] else []), *recording(data), "## Left out", left_out(data) if data["left_out"] else "Nothing."]
    return "\n\n".join(parts) + "\n"


HEAD, ROW = re.compile(r"^\| model \|.*\n\|[-|]+\n", re.M), re.compile(r"^\| \[`(\w+)`\]\(#\w+\) \|.*\n", re.M)       # of the models side by side
LEFT_OUT = "## Left out\n"


def completed(text, old):
    """With the rows and reasons that an older page has of models that were not measured here; sections are joined by tools/pages.py."""
    new = {row[1]: row[0] for row in ROW.finditer(text)}
    rows = {row[1]: row[0] for row in ROW.finditer(old)} | new
    if rows.keys() == new.keys():
        return text
    at = HEAD.search(text).end()
    text = text[:at] + "".join(rows[name] for name in sorted(rows)) + ROW.sub("", text[at:])
    return text.partition(LEFT_OUT)[0] + "".join(old.partition(LEFT_OUT)[1:])


# ---- the page in HTML -------------------------------------------------------------------------------

STYLE = """body{font:15px/1.5 sans-serif;max-width:1180px;margin:2em auto;padding:0 1em;color:#222}
table{border-collapse:collapse;font-size:13px;margin:1em 0}td,th{border:1px solid #ccc;padding:2px 8px;text-align:right}
svg{display:block;margin:1em 0;max-width:100%;height:auto}h2{margin-top:2em}code{background:#f4f4f4}use:hover{stroke-width:3}
nav{display:flex;flex-wrap:wrap;gap:.2em .8em}"""
AXES = "time for one object over the whole span", "error at the end, relative, median of the variants"


def blocks(text):
    """Markdown's paragraphs and lists as HTML; of links and emphasis the words."""
    for block in html.escape(re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", text)).replace("`", "").replace("*", "").split("\n\n"):
        if block.startswith("- "):
            yield "<ul>\n" + "\n".join(f"<li>{item}</li>" for item in block[2:].split("\n- ")) + "\n</ul>"
        else:
            yield f"<p>{block}</p>"


def page(data, has_integrators):
    """has_integrators: also a picture of all of them for each model."""
    def figure(series):
        return inline(series, *AXES, unit="s", size=(11, 6))

    parts = ["<!doctype html><html lang=en><meta charset=utf-8><title>FP3: error against run time</title><style>", STYLE, "</style>",
             f"<!-- Generated by tools/pages.py from data {digest(data)} -->", "<h1>FP3: error against run time</h1>", f"<p>{html.escape(about(data)).replace('`', '')}</p>"]
    parts += blocks(INTRODUCTION)
    parts.append("<p>Both axes are logarithmic. Lines join the points that nothing of the same colour beats; the pointer over a point "
                 "says what it is.</p><nav>" + "".join(f"<a href='#{p['model']}'>{p['model']}</a>" for p in data["problems"]) + "</nav>")
    for problem in data["problems"]:
        points = [point for point in data["points"] if point["model"] == problem["model"]]
        parts += [f"<h2 id='{problem['model']}'>{problem['model']}: {html.escape(problem['doc'])}</h2>", figure(fronts(points, fast_of(data)))]
        if has_integrators:
            parts += [f"<p>All integrators on the engine {fast_of(data)}, one thread:</p>", figure(curves(points, fast_of(data)))]
    return "\n".join(parts) + "</html>\n"


def page_of(data, most=2.5e6):
    """With the pictures of all integrators, unless it were larger than so many bytes."""
    text = page(data, True)
    return text if len(text.encode()) <= most else page(data, False)
