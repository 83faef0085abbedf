#!/usr/bin/env python3
"""Judges fp3 tune from outside: fresh objects run by the scene that it wrote, against a truth of its own.

    tools/judge.py --output build/results/judge.json [--models kepler,relay] [--tolerances 1e-3,1e-5] [--around 0.02] [--objects 256]

Objects are at random in the ranges, and are looked at all the time. A row holds if 95 % of them are within the tolerance. Needs NumPy. Where SciPy
is, the truth is its DOP853 or Radau on equations that tools/ode_reader.py reads; else it is that of build/tests/truths.
"""

import argparse
import csv
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from ode_reader import expression, read

try:
    from scipy.integrate import solve_ivp
except ImportError:
    solve_ivp = None

ROOT = pathlib.Path(__file__).parents[1]
LOOKS = 400               # steps of a run that are looked at
LOOKS_TIMED = 60          # attempts of a run with steps of its own that are looked at
LINES = 16                # of objects, each through two random points of the ranges
HOLDS = 0.95
BESIDE = 1e-6             # of the span: an event so close to a look is at it
TIGHT = 1e-12             # tolerance of the truth
STIFF = {"robertson", "van_der_pol_stiff", "rc_ladder"}
FEW = 32                  # objects where each has a solution of its own
AROUND_OF = {"arenstorf": 1e-4}
SPAN_OF = {"bouncing_ball": 1.9}
# What passes 0 where a condition becomes true, for SciPy, which has no conditions.
ROOTS_OF = {"bouncing_ball": [("x", -1)], "thermostat": [("T - low", -1), ("T - high", 1)]}


# ---- objects ----

def spread_of(scene):
    block = re.search(r"spread = \{(.*?)\};\n", scene)
    return {name: (float(a), float(b)) for name, a, b in re.findall(r"([\w.\[\]]+) = \[([^,]+), ([^\]]+)\];", block[1] if block else "")}


def on_a_line(scene, objects, rng):
    """The scene with other objects, from one random point of the ranges to another; and their values."""
    ends = {name: a + (b - a) * rng.random(2) for name, (a, b) in spread_of(scene).items()}
    text = re.sub(r"objects = \d+;", f"objects = {objects};", scene)
    inside = " ".join(f"{name} = [{a!r}, {b!r}];" for name, (a, b) in ((n, map(float, e)) for n, e in ends.items()))
    share = np.arange(objects) / (objects - 1)
    return re.sub(r"spread = \{.*?\};\n", f"spread = {{ {inside} }};\n", text), {name: (1 - share) * a + share * b for name, (a, b) in ends.items()}


def run_timed(fp3, folder, names):
    """Of objects that have times of their own, after a number of attempts: snapshots at times (--times) would make other steps."""
    def after(attempts):
        done = subprocess.run([fp3, "run", "--scene", folder / "line.scene", "--all", "--allow-failures", "--steps", str(attempts)], capture_output=True, text=True)
        columns = {}
        for name, value in re.findall(r"^(\w+) +(\S+) +.*0x\S+   object \d+$", done.stdout, re.M):
            columns.setdefault(name, []).append(float(value))
        if done.returncode or len(columns) < len(names):
            raise RuntimeError(f"fp3 run: {done.stderr.strip()}")
        return np.array(columns["t"]), np.array([columns[name] for name in names]), max(map(sum, zip(columns["accepted"], columns["rejected"])))
    most = int(after(1000000)[2])
    counts = range(1, most + 1) if most <= LOOKS_TIMED else sorted({round(most * (i + 1) / LOOKS_TIMED) for i in range(LOOKS_TIMED)})
    found = [after(n) for n in counts]
    return np.array([t for t, _, _ in found]), np.array([states for _, states, _ in found])


def run(fp3, scene, folder, row, names):
    """Times behind the start as [time, object], and states as [time, state, object]."""
    (folder / "line.scene").write_text(scene)
    if row["h"] is None or row["cut"]:
        return run_timed(fp3, folder, names)
    at = ["--every", str(max(1, row["steps"] // LOOKS))]
    done = subprocess.run([fp3, "run", "--scene", folder / "line.scene", "--output", folder / "line.csv", *at], capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"fp3 run: {done.stderr.strip()}")
    with open(folder / "line.csv") as lines:
        rows = list(csv.reader(lines))
    head, cells = rows[0], np.array(rows[1:])
    step, number = cells[:, head.index("step")].astype(int), cells[:, head.index("object")].astype(int)
    first = 1 + max(head.index(name) for name in ("step", "time", "object", "group") if name in head)
    values = np.empty((len(set(step)), len(head) - first, number.max() + 1))
    index = {s: i for i, s in enumerate(sorted(set(step)))}
    for s, n, line in zip(step, number, cells):
        values[index[s], :, n] = line[first:].astype(float)
    return np.repeat(np.array(sorted(index))[1:, None] * row["h"], number.max() + 1, 1), values[1:]


# ---- the truth ----

def with_values(model, names, values, objects):
    """Params as FP32 has them."""
    params = {name: np.repeat(np.float32(p)[..., None], objects, -1).astype(float) for name, p in model.params.items()}
    for name, column in values.items():
        base, _, part = name.rpartition("_")
        if name in params:
            params[name] = np.float32(column).astype(float)
        elif base in params and part in "xyz":
            params[base]["xyz".index(part)] = np.float32(column)
    return params


def start_of(model, names, values, params, objects):
    y0 = model.start(params, objects)
    for name, column in values.items():
        if name in names:
            y0[names.index(name)] = np.float32(column)
    return y0


def solve(model, y0, params, times, scale, stiff):
    """All objects in one system; stiff ones one by one."""
    states, objects = y0.shape
    if stiff and objects > 1:
        return np.concatenate([solve(model, y0[:, [i]], {k: p[..., [i]] for k, p in params.items()}, times, scale, True) for i in range(objects)], 2)
    found = solve_ivp(lambda t, y: model.slopes(t, y.reshape(states, objects), params).ravel(), (0, times[-1]), y0.ravel(), t_eval=times,
                      method="Radau" if stiff else "DOP853", rtol=1e-10 if stiff else TIGHT, atol=np.repeat((1e-12 if stiff else TIGHT) * scale, objects),
                      **({} if stiff else {"max_step": times[-1] / 500}))
    if not found.success:
        raise RuntimeError(found.message)
    return np.moveaxis(found.y.reshape(states, objects, -1), 2, 0)


class Events:
    """One object, from event to event."""

    def __init__(self, model, name, params):
        self.model, self.params, self.events = model, params, []
        for i, (kind, code, way, sets) in enumerate(model.events):
            if kind == "condition":
                text, way = ROOTS_OF[name][i]
                self.events.append(("root", expression(text), way, sets, code))
            else:
                self.events.append((kind, code, way, sets, None))

    def value(self, code, t, y):
        return self.model.value(code, self.model.values(t, y[:, None], self.params))

    def fire(self, sets, t, y):
        v, after = self.model.values(t, y[:, None], self.params), y.copy()
        for left, code in sets:
            after[self.model.place(left)] = np.ravel(self.model.value(code, v))
        return after

    def follow(self, y, times, scale, beyond):
        """States at the times, and what happened until so long after the last: (when, before, after)."""
        found, happened, now, end = np.empty((len(times), len(y))), [], 0.0, times[-1] + beyond
        for kind, _, _, sets, condition in self.events:
            if condition and np.ravel(self.value(condition, 0, y))[0]:
                y = self.fire(sets, 0, y)
        at = [float(np.ravel(self.value(code, 0, y))[0]) for kind, code, *_ in self.events if kind == "time"]
        while now < end:
            until = min([t for t in at if t > now + 1e-12] + [end])
            roots = []
            for kind, code, way, sets, _ in self.events:
                if kind == "root":
                    def g(t, y, code=code):
                        return float(np.ravel(self.value(code, t, y))[0])
                    g.terminal, g.direction, g.sets = True, way, sets
                    roots.append(g)
            part = solve_ivp(lambda t, y: self.model.slopes(t, y[:, None], self.params)[:, 0], (now, until), y, method="DOP853", rtol=TIGHT, atol=TIGHT * scale,
                             dense_output=True, max_step=end / 200, events=roots or None)
            to, y, before = part.t[-1], part.y[:, -1], part.y[:, -1]
            inside = (times >= now) & (times < to if to < end else times <= end)
            if inside.any():
                found[inside] = part.sol(times[inside]).T
            fired = False
            for g, when in zip(roots, part.t_events or []):
                if len(when):
                    y, fired = self.fire(g.sets, to, y), True
            for kind, code, _, sets, _ in self.events:
                if kind == "time" and abs(float(np.ravel(self.value(code, 0, y))[0]) - to) < 1e-12:
                    y, fired = self.fire(sets, to, y), True
            if fired:
                happened.append((to, before, y))
            now = to
        return found, happened


def by_our_own(truths, path, names, values, y0, times):
    """Without SciPy."""
    parts = []
    for i in range(y0.shape[1]):
        given = [f"{name}={float(np.float32(column[i]))!r}" for name, column in values.items()]
        given = given or [f"{names[0]}={float(y0[0, i])!r}"]
        done = subprocess.run([truths, path, *given], input=" ".join(map(repr, map(float, times))), capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(f"truths: {done.stderr.strip()}")
        parts.append([[float(x) for x in line.split()] for line in done.stdout.splitlines()[:-1]])
    return np.moveaxis(np.array(parts), 0, 2)


def with_sides(truths, path, names, values, y0, times):
    """Likewise of a model with events: a jump between just before a time and just after it is one at that time."""
    beside = BESIDE * times[-1]
    all_times = np.unique(np.concatenate([np.maximum(times - beside, beside / 2), times, times + beside]))
    found = by_our_own(truths, path, names, values, y0, all_times)
    at, before, after = (np.searchsorted(all_times, t) for t in (times, np.maximum(times - beside, beside / 2), times + beside))
    jumps = (np.abs(found[after] - found[before]) > 1000 * BESIDE * np.abs(found).max(0)).any(1)
    return found[at], [[(times[k], found[before[k], :, i], found[after[k], :, i]) for k in np.flatnonzero(jumps[:, i])] for i in range(y0.shape[1])]


# ---- a row ----

def apart(one, other, sizes):
    with np.errstate(divide="ignore", invalid="ignore"):
        e = np.abs(one - other)
        return np.where(e == 0, 0, e / sizes).max(-1 if e.ndim == 1 else 1)


def errors_of(values, y0, truth, happened, times, span, tolerance):
    """Of each object; times, values and truth are of the same looks. Around an event of the truth it may be on the other side, as docs/tuner.md says."""
    sizes = np.maximum(np.abs(truth).max(0), np.abs(y0))
    worst = apart(values, truth, sizes[None])
    for i, events in enumerate(happened):
        for when, before, after in events:
            for k in np.flatnonzero(np.abs(times[:, i] - when) <= tolerance * span):
                other = after if times[k, i] < when else before
                worst[k, i] = min(worst[k, i], max(abs(times[k, i] - when) / span, apart(values[k, :, i], other, np.maximum(sizes[:, i], np.abs(after)))))
    return worst.max(0)


def truth_of(path, model, values, names, params, y0, looks, scale, truths, beyond):
    """At the looks of each object: the truth at all times, of which each has its own. Who has not moved is at its start."""
    times = np.unique(looks[looks > 0])
    found, happened = truth_at(path, model, values, names, params, y0, times, scale, truths, beyond)
    found = np.concatenate([y0[None], found])
    return np.stack([found[np.where(looks[:, i] > 0, 1 + np.searchsorted(times, looks[:, i]), 0), :, i] for i in range(looks.shape[1])], 2), happened


def truth_at(path, model, values, names, params, y0, times, scale, truths, beyond):
    if solve_ivp is None:
        given = (truths, path, names, values, y0, times)
        return with_sides(*given) if model.events else (by_our_own(*given), [])
    if not model.events:
        return solve(model, y0, params, times, scale, path.stem in STIFF), []
    parts = [Events(model, path.stem, {k: p[..., [i]] for k, p in params.items()}).follow(y0[:, i], times, scale, beyond) for i in range(y0.shape[1])]
    return np.moveaxis(np.array([rows for rows, _ in parts]), 0, 2), [events for _, events in parts]


def judge(fp3, truths, path, tolerance, around, objects, seed):
    begin, folder = time.time(), pathlib.Path(tempfile.mkdtemp())
    row = {"model": path.stem, "tolerance": tolerance, "around": around, "truth": "SciPy" if solve_ivp else "GSL"}
    span = ["--span", str(SPAN_OF[path.stem])] if path.stem in SPAN_OF else []
    try:
        done = subprocess.run([fp3, "tune", path, "--tolerance", repr(tolerance), "--around", repr(around), "--output", folder / "m.scene", "--json", folder / "m.json", *span],
                              capture_output=True, text=True, timeout=300)
    except subprocess.TimeoutExpired:
        return row | {"holds": None, "why": "fp3 tune takes more than 300 s"}
    row["tuned_s"] = round(time.time() - begin, 1)
    if done.returncode:
        return row | {"holds": None, "why": done.stderr.strip()}
    choice, model, rng = json.loads((folder / "m.json").read_text()), read(path), np.random.default_rng(seed)
    row |= {key: choice[key] for key in ("integrator", "arithmetic", "h", "cut", "adaptive_tolerance", "cost_ratio", "error_held_out")}
    single = path.stem in STIFF or model.events or not solve_ivp
    lines = LINES if objects >= 4 * LINES else max(1, objects // 4)
    each = max(2, (min(objects, FEW) if single and objects > FEW and path.stem in STIFF else objects) // lines)
    found = []
    for _ in range(lines):
        scene, values = on_a_line((folder / "m.scene").read_text(), each, rng)
        try:
            times, states = run(fp3, scene.replace('program = "', f'program = "{path.parent}/').replace(f"{path.parent}/" + re.search(r'program = "([^"]*)"', scene)[1], str(path)), folder, choice, model.names)
            states = states[:, :len(model.names)]
            params = with_values(model, model.names, values, each)
            y0 = start_of(model, model.names, values, params, each)
            scale = np.abs(states).max((0, 2)) + 1e-300
            truth, happened = truth_of(path, model, values, model.names, params, y0, times, scale, truths, tolerance * choice["span"])
        except RuntimeError as why:
            return row | {"holds": None, "why": str(why)}
        found.extend(errors_of(states, y0, truth, happened, times, choice["span"], tolerance))
    found = np.array(found)
    row |= {"objects": len(found), "within": float((found <= tolerance).mean()), "worst": float(found.max()), "median": float(np.median(found))}
    return row | {"holds": bool(row["within"] >= HOLDS), "seconds": round(time.time() - begin, 1)}


def text_of(row):
    if row["holds"] is None:
        return f"{row['model']:18} {row['tolerance']:g}, {row['around']:g}: no answer: {row['why']}"
    return (f"{row['model']:18} {row['tolerance']:g}, {row['around']:g}: {'holds' if row['holds'] else 'FAILS'}, {100 * row['within']:.1f} % of {row['objects']} within, worst {row['worst']:.2e}, "
            f"{row['integrator']} {row['arithmetic']}{' cut' if row['cut'] else ''}, {row['cost_ratio']:.3f} of rk4, {row['seconds']} s")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--fp3", default=ROOT / "build/fp3", type=pathlib.Path, help="the command")
    parser.add_argument("--truths", default=ROOT / "build/tests/truths", type=pathlib.Path, help="of `make`, where there is no SciPy")
    parser.add_argument("--output", help="the file to write")
    parser.add_argument("--models", help="names with commas between them (default: programs/ and tests/tune/judged/)")
    parser.add_argument("--tolerances", default="1e-3,1e-5", help="(default: %(default)s)")
    parser.add_argument("--around", default="0.02", help="shares to both sides of defaults (default: %(default)s)")
    parser.add_argument("--objects", type=int, default=256, help="in a row (default: %(default)s)")
    parser.add_argument("--jobs", type=int, default=1, help="rows at a time (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of the objects (default: %(default)s)")
    o = parser.parse_args()
    paths = sorted([*(ROOT / "programs").glob("*.ode"), *(ROOT / "tests/tune/judged").glob("*.ode")], key=lambda path: path.stem)
    if o.models:
        paths = [path for path in paths if path.stem in o.models.split(",")]
    tasks = [(path, float(t), AROUND_OF.get(path.stem, float(a))) for path in paths for t in o.tolerances.split(",") for a in o.around.split(",")]
    rows = []
    with ThreadPoolExecutor(o.jobs) as pool:
        for row in pool.map(lambda task: judge(o.fp3, o.truths, *task, o.objects, o.seed), tasks):
            rows.append(row)
            print(text_of(row), flush=True)
            if o.output:
                pathlib.Path(o.output).write_text(json.dumps({"rows": rows}, indent=1) + "\n")
    judged = [row for row in rows if row["holds"] is not None]
    print(f"{sum(row['holds'] for row in judged)} of {len(judged)} rows hold; {len(rows) - len(judged)} have no answer")
    sys.exit(any(not row["holds"] for row in judged))


if __name__ == "__main__":
    main()
