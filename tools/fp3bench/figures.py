"""What the pictures and tables of the benchmark show: who is the fastest at an error, and which points belong together."""

import pathlib

from fp3gen.families import families

ERRORS = [10.0 ** -digits for digits in range(1, 14)]
PEERS = {"plain_c": "plain C", "gsl": "GSL", "sundials": "SUNDIALS", "diffrax": "diffrax", "heyoka": "heyoka"}
# How a curve looks: a family has a colour, its members have dashes and marks of their own. The same everywhere.
DASHES, MARKS = ["-", "--", ":", "-."], "os^Dv*X"
FAMILIES = families(pathlib.Path(__file__).resolve().parents[2])
COLOURS = {member: family["colour"] for family in FAMILIES["solvers"] for member in family["members"]}


def looks(members):
    """members: colours, each with the names of its curves."""
    return {name: (colour, DASHES[i % len(DASHES)], MARKS[i]) for colour, names in members for i, name in enumerate(names)}


METHODS = looks([
    (COLOURS["fast"], ["fp3, one thread", "fp3, all threads"]),
    (COLOURS["rtl"], [f"hardware {name}" for name in ("many_full", "single_full", "many", "single", "lanes", "uncut", "paper")]),
    (COLOURS["plain_c"], ["plain C scalar", "plain C vectors"]),
    (COLOURS["gsl"], [f"GSL {name}" for name in ("rkf45", "rk8pd", "msadams", "msbdf", "rk4")]),
    (COLOURS["sundials"], [f"SUNDIALS {name}" for name in ("cvode adams", "cvode bdf", "arkode erk3", "arkode erk4", "arkode erk5", "arkode erk8")]),
    (COLOURS["diffrax"], ["diffrax float32", "diffrax float64"]),
    (COLOURS["heyoka"], ["heyoka taylor", "heyoka taylor batch"]),
])
INTEGRATORS = looks((family["colour"], family["members"]) for family in FAMILIES["integrators"])
OTHER = ("#888888", "-", "P")   # what is in no list
ADAPTIVE = " adaptive"
KINDS = (ADAPTIVE, " cut")      # behind the name of an integrator, of steps that are not all h: its curve with open marks


def fast_of(data):
    """The engine of fp3 that was measured: fast, or isa where it was asked for."""
    engines = {point["engine"] for point in data["points"]}
    return "fast" if "fast" in engines else "isa"


def is_timed(point):
    return point["ns_per_object"] is not None and point["error_median"] is not None and point["error_median"] > 0


def best(points, error, **keys):
    """The shortest time below an error."""
    good = [point for point in points if is_timed(point) and point["error_median"] <= error
            and all(point[key] == value for key, value in keys.items())]
    return min(good, key=lambda point: point["ns_per_object"], default=None)


def in_fp32(points, fast):
    """Of the fast engine: without double-single, whose numbers have 48 bits."""
    return [point for point in points if point["engine"] == fast and point["arithmetic"] != "double_single"]


def summary(points, fast):
    """A row for each error that fast reaches with one thread; is_fp32: in FP32 at that."""
    threads = max((point["threads"] for point in points if point["engine"] == fast), default=1)
    rows = []
    for error in ERRORS:
        ours = best(points, error, engine=fast, threads=1)
        if ours is None:
            break
        row = {"error": error, "fast": ours, "all": best(points, error, engine=fast, threads=threads) if threads > 1 else None,
               "hardware": best(points, error, engine="rtl")}
        row |= {who: best(points, error, engine=who) for who in PEERS}
        row["adaptive"] = best([point for point in points if (point["integrator"] or "").endswith(ADAPTIVE)], error, engine=fast, threads=1)
        row["is_fp32"] = best(in_fp32(points, fast), error, threads=1) is not None
        row["ratio"] = row["gsl"] and row["gsl"]["ns_per_object"] / ours["ns_per_object"]
        rows.append(row)
    return rows


def front(points):
    """Those that no other beats, the slowest first."""
    kept = []
    for point in sorted(filter(is_timed, points), key=lambda point: (point["ns_per_object"], point["error_median"])):
        if not kept or point["error_median"] < kept[-1]["error_median"]:
            kept.append(point)
    return kept


def label(point, fast):
    if point["engine"] == fast:
        return "fp3, one thread" if point["threads"] == 1 else "fp3, all threads"
    if point["engine"] == "rtl":
        return f"hardware {point['config']}"
    return f"{PEERS[point['engine']]} " + (point["arithmetic"] if point["engine"] == "diffrax" else point["method"])


def text(point, fast):
    """What the pointer says."""
    how = ", ".join(str(word) for word in (point["method"], point["integrator"], point["arithmetic"]) if word)
    what = f"h = {point['h']:.3g}, {point['steps']} steps" if point["h"] else f"tolerance {point['tolerance']:.0e}"
    return f"{label(point, fast)}: {how}, {what}: error {point['error_median']:.2e}, {point['ns_per_object']:.4g} ns"


def series(name, look, points, fast):
    """Of the points those that no other beats."""
    kept = front(points)
    return {"name": name, "look": look, "is_open": name.endswith(KINDS), "notes": [text(point, fast) for point in kept],
            "points": [(point["ns_per_object"] / 1e9, point["error_median"]) for point in kept]}


def by(points, key):
    groups = {}
    for point in points:
        groups.setdefault(key(point), []).append(point)
    return groups


def fronts(points, fast):
    """Of one model: a line for each way to solve it."""
    groups = by(points, lambda point: label(point, fast))
    return [series(name, look, groups[name], fast) for name, look in METHODS.items() if name in groups]


def curves(points, fast):
    """Of one model: a line for each integrator, in the best of its arithmetics."""
    groups = by((point for point in points if point["engine"] == fast and point["threads"] == 1), lambda point: point["integrator"])
    return [series(name, INTEGRATORS.get(name.partition(" ")[0], OTHER), groups[name], fast) for name in sorted(groups)]


# ---- speed --------------------------------------------------------------------------------------------

def runner(row):
    name = row["engine"] + (f", {row['method']}" if row["method"] else "")
    return name + (f", {row['threads']} threads" if row["threads"] > 1 else "") + (", flags" if row["flags"] and row["engine"] == "fast" else "")


def grid(rows, across):
    """A row for each runner, a column for each value of `across`."""
    values = sorted({row[across] for row in rows})
    lines = []
    for name in dict.fromkeys(map(runner, rows)):
        by_value = {row[across]: row for row in rows if runner(row) == name}
        lines.append([name] + [by_value[value]["ns_per_object_step"] if value in by_value else None for value in values])
    return values, lines


def speed_grids(rows):
    """Title, head and rows: by objects at 1,000 steps or the nearest, by steps at 16,384 objects, and of one object."""
    steps = sorted({row["steps"] for row in rows}, key=lambda n: abs(n - 1000))[:1]
    for chosen in steps:
        values, lines = grid([row for row in rows if row["steps"] == chosen], "objects")
        yield f"By the number of objects, {chosen:,} steps:", ["", *(f"{value:,} object{'s'[:value > 1]}" for value in values)], lines
    for objects in (16384, 1):
        of = [row for row in rows if row["objects"] == objects]
        if of:
            values, lines = grid(of, "steps")
            yield f"By the number of steps, {objects:,} object{'s'[:objects > 1]}:", ["", *(f"{value:,} step{'s'[:value > 1]}" for value in values)], lines
    ratios = [[runner(row), row["objects"], row["steps"], row["ns_per_object_step"], 1e3 / row["ns_per_object_step"], row["ratio_to_hand"]]
              for row in rows if row["steps"] in steps and row["objects"] in (1, 16384)]
    yield "Beside the loop by hand:", ["", "objects", "steps", "ns", "million object-steps per second", "time by that of the loop"], ratios
