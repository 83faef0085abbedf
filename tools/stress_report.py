"""What docs/stress.md says: a table for each section of the stress suite, what does not hold and why, pictures."""

from bench_figures import INTEGRATORS, OTHER
from fp3gen.text import table
from plot import draw

# In pictures of errors: a colour for each integrator, a dash for each arithmetic.
COLOURS = {name: INTEGRATORS[name][0] for name in ("rk4", "verlet", "yoshida6")}
DASHES = {"plain": "-", "compensated": "--", "truncated": ":"}

INTRODUCTION = """\
Every figure here stands beside what it should be: by theory, computed from the integrator's table, or as published. A result holds if
it is within its tolerance. `fp3 stress` is the suite on equations of its own, `fp3 stress MODEL` what applies to a model; `make stress` is both, for
every integrator and every model of `programs/`, into `build/results/stress.json`, and `make stress-report` writes this page from it.

Everything runs on the engine `fast`, as `many_full` runs it, in five arithmetics: *plain*; *compensated* updates (`-k`); *flushed*, plain without gradual
underflow; *truncated*, plain and rounded to zero; *double_single* (`--double-single`), where the program fits `many_full`. Flushed and truncated are configurations
with the keys `subnormal` and `nearest` at 0, which no named one has. *In double* means the same steps by the same table without roundings, by the
coefficients that the program has (`fp3_compiled_exact_given`)."""

FARTHEST = 8    # what goes further along the axis (stabilised methods) would make the picture of regions too flat to see

# section: heading, of equations or of models, text
SECTIONS = {
    "stability": ("Stability limits", """\
x' = v, v' = -k x - c v with eigenvalues at an angle from the decay (0 degrees: x' = -a x), and a step of 1. 512 objects differ in h |lambda|; the first one that
grows is found, and then, in 512 more between its neighbours, the limit. Theory: |R| = 1 of the stability polynomial R(z) = 1 + sum of z^j b A^(j-1) 1, or
the largest eigenvalue of the matrix of a step; both from the table, in double. Where a method grows at every step (limit 0), or so slowly above its limit that
a million steps do not show it within the tolerance, it is the step from which growth in 2^14 steps is a quarter. Tolerance 0.1 %. Of linearly implicit methods R is
rational; ∞: nothing grows up to h |lambda| = 1e6 in theory, up to 512 as measured. Stabilised methods, which go far along the axis, are not in the picture."""),
    "steps": ("Errors by step size", """\
x'' = -x to t = 8, and x'' = -x + cos(2 t) (`driven`), 64 objects, root of the mean square. On the left the error falls with the order p: its slope is that of the
same 8 objects in double. On the right roundings grow: with N^(1/2) where they are independent, up to N (Higham, Accuracy and Stability of Numerical Algorithms, 2002,
section 2.8); all in one direction where they are cut off. Of compensated updates and of double-single, nothing grows but a walk of roundings at the end of the second
word. Stoermer's method takes a rounding r of x for one of the velocity, r/h, and below h = u^(1/3) = 0.005, u = 2^-23, its roundings are alike from step to step where
the acceleration is stationary: they grow with h^-3, cut off with h^-2. Compensated, it carries h v as one float: a walk of its roundings."""),
    "events": ("Order under events", """\
A bouncing ball, 4,096 objects. An event happens at the end of a step ([models.md](models.md#events)), so the order is 1 for every integrator."""),
    "drift": ("A million steps", """\
Kepler's problem with eccentricity 0.2, 64 orbits that differ by a turn, so that their roundings are independent; 65,536 steps in double-single. Their mean is what the
method does, and its coefficients, which are FP32 numbers; their spread is the random walk of roundings. A symplectic method keeps energy and momentum; another drifts as in
double. A rounding is 2.5e-8 of a number, root of the mean square, and the tolerance is four standard deviations of the walk. The error of a coefficient c is less than half a
unit of c k, and may be rounded away or doubled with it, alike in all orbits: the tolerance has once more what rounded coefficients do in double. Truncation takes 4.3e-8
of each update in the mean: a linear drift. An error of place, over an orbit and since the first, grows with t (symplectic) or t^2, the spread with t^(3/2) (Hairer, Lubich and
Wanner, Geometric Numerical Integration, X.3; Brouwer 1937)."""),
    "reversal": ("Forth and back", """\
A planet goes to t = 12, its velocity is turned, and it goes as far again. A symmetric method comes back but for roundings; another is off by h^p for an odd order p, h^(p+1) for an even one."""),
    "chance": ("Parameters over many decades", """\
4,096 oscillators with k from 1e-6 to 1e3 and any damping below the critical one, 512 steps of 1. Those fail whose growth reaches the end of FP32, by theory; each is told, with its step."""),
    "stagnation": ("Where nothing moves", """\
`move`: 1 + h f is 1 up to half a unit (2^-24; the tie goes to the even 1), truncated below a unit. `calm`: x' = p - q x stops where h f is below half a unit of x, so
the distance from p/q has a bound, which is 1 here. In double-single all sums of `move` are exact."""),
    "subnormal": ("The lower end", """\
A decay by a at each step ends, exactly, at floor(1/(2 a)) units of 2^-149, truncated at ceil(1/a) - 1; flushed it ends above 2^-126."""),
    "failures": ("Overflow and NaN", "One object of 600 gets a number that overflows later, a NaN or an infinity; the engine names it and the step. In double-single a number overflows from 2^116 on, when it is split."),
    "chaos": ("Chaos", """\
The largest Lyapunov exponent of Lorenz's equations, of 512 objects, by the linearised equations. Published: 0.9056 (Sprott, Chaos and Time-Series Analysis, 2003; Viswanath 1998). Tolerance 5 %."""),
    "invariants": ("Invariants of the models", """\
The largest change of each `invariant`, at most that in double and four standard deviations of a random walk: one rounding of each state in each step, by the derivatives of the invariant."""),
}


def number(x, nothing="–"):
    if x is None:
        return nothing
    if x == 0 or 1e-3 <= abs(x) < 1e5:
        return f"{x:.6g}"
    return f"{x:.3g}"


def overview(results):
    names = list(dict.fromkeys(row["section"] for row in results))
    rows = []
    for name in names:
        of = [row for row in results if row["section"] == name]
        rows.append([SECTIONS[name][0], len(of), sum(row["holds"] for row in of), sum(not row["holds"] for row in of)])
    return table(["section", "results", "hold", "do not"], rows)


def details(rows):
    body = []
    for row in rows:
        nothing = "∞" if row["section"] == "stability" else "–"
        expected, measured = number(row["expected"], nothing), number(row["measured"], nothing)
        body.append([row["model"], row["integrator"], row["arithmetic"], row["name"], expected, row["relation"],
                     measured if row["holds"] else f"**{measured}**", number(row["tolerance"])])
    return table(["model", "integrator", "arithmetic", "what", "expected", "", "measured", "tolerance"], body)


def failures(results):
    wrong = [row for row in results if not row["holds"]]
    if not wrong:
        return "Everything holds."
    return table(["section", "model", "integrator", "arithmetic", "what", "why"],
                 [[row["section"], row["model"], row["integrator"], row["arithmetic"], row["name"], row["why"]] for row in wrong])


def limit(x):
    return "∞" if x is None else f"{x:.4f}"


def limits(results):
    """Stability as a matrix: theory and what was measured, by angle."""
    rows = [row for row in results if row["section"] == "stability" and row["arithmetic"] == "plain"]
    angles = sorted({row["name"].split(" at ")[1].split()[0] for row in rows}, key=int)
    cells = {(row["integrator"], row["name"].split(" at ")[1].split()[0]): row for row in rows}
    body = []
    for name in dict.fromkeys(row["integrator"] for row in rows):
        line = [f"`{name}`"]
        for angle in angles:
            row = cells.get((name, angle))
            mark = "" if row is None or "limit" in row["name"] else " *"
            line.append("–" if row is None else f"{limit(row['expected'])} / {limit(row['measured'])}{mark}")
        body.append(line)
    return (table(["theory / measured", *(f"{angle}°" for angle in angles)], body) +
            "\n\n\\* grows at every step, or slowly: where growth in 2^14 steps is a quarter.")


def section(results, name):
    rows = [row for row in results if row["section"] == name]
    if not rows:
        return ""
    heading, text = SECTIONS[name]
    parts = [f"## {heading}", text]
    if name == "stability":
        parts += ["![stability regions](stress_regions.svg)", limits(results), "The other arithmetics, at the end of the range of each kind:"]
        rows = [row for row in rows if row["arithmetic"] != "plain"]
    parts += {"steps": ["![error by step size](stress_steps.svg)"], "drift": ["![energy](stress_energy.svg)", "![place](stress_place.svg)"]}.get(name, [])
    parts.append(details(rows))
    return "\n\n".join(parts)


def page(data):
    results, a = data["results"], data["about"]
    held = sum(row["holds"] for row in results)
    return "\n\n".join(part for part in [
        "<!-- Generated by tools/stress.py (make stress-report): do not edit. -->", "# Stress", INTRODUCTION,
        f"Measured {a['date']} by `{a['command']}`, revision `{a['revision']}`: {len(results)} results, of which {held} hold.",
        overview(results), "## What does not hold", failures(results), *(section(results, name) for name in SECTIONS)] if part) + "\n"


# ---- pictures -----------------------------------------------------------------------------------------

def named(curves, figure):
    found = {}
    for curve in curves:
        if curve["figure"] == figure:
            found.setdefault(curve["series"], []).extend(zip(curve["x"], curve["y"]))
    return found


def regions(curves):
    theory, dots = named(curves, "region"), named(curves, "region measured")
    series = []
    for name, points in theory.items():
        if points and min(x for x, _ in points) >= -FARTHEST:
            colour, dash, mark = INTEGRATORS.get(name, OTHER)
            series.append({"name": name, "look": (colour, dash, None), "points": points})
            if dots.get(name):
                series.append({"look": (colour, None, mark), "points": dots[name]})
    return draw(series, "real part of h lambda", "imaginary part", is_map=True)


def by_arithmetic(curves, figure, x_label, y_label):
    series = []
    for name, points in named(curves, figure).items():
        integrator, arithmetic = name.split(", ")
        points = [(x, y) for x, y in points if x and y and y < 10]
        if integrator in COLOURS and arithmetic in DASHES and points:
            series.append({"name": name, "look": (COLOURS[integrator], DASHES[arithmetic], None), "points": points})
    return draw(series, x_label, y_label)


def pictures(curves):
    """Of each file the text."""
    return {"stress_regions.svg": regions(curves),
            "stress_steps.svg": by_arithmetic(curves, "steps", "time step", "error at t = 8, relative"),
            "stress_energy.svg": by_arithmetic(curves, "energy", "time", "change of the energy, relative"),
            "stress_place.svg": by_arithmetic(curves, "place", "time", "error of place along the way")}
