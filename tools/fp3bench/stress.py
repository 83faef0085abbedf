"""What docs/stress.md says: what each section of the stress suite measures and finds, what does not hold and why, pictures."""

import re

from fp3bench.figures import INTEGRATORS, OTHER
from fp3gen.text import evidence, table
from plot import draw

# In pictures of errors: a colour for each integrator, a dash for each arithmetic.
COLOURS = {name: INTEGRATORS[name][0] for name in ("rk4", "verlet", "yoshida6")}
DASHES = {"plain": "-", "compensated": "--", "cell": ":"}

INTRODUCTION = """\
The stress suite measures what integrators and arithmetics do, and compares it with what they should do: by theory, computed from the integrator's table, or
as published. A result holds if it is within its tolerance.

- `fp3 stress` runs the suite on equations of its own, `fp3 stress MODEL` on a model. `make stress` does both, for every integrator and every model of
  `programs/`; `make report PAGES=stress` makes this page from its results.
- Everything runs on the engine `fast`, as on `many_full`. The arithmetics are *plain*, *compensated*, *double_single* (if the program fits), and plain on the
  configurations with [another arithmetic](arithmetic.md). `flush` and `fused_full` round numbers of ordinary size as *plain* does, and make a million steps
  only with `--arithmetic`.
- *In double* means the same steps without roundings, with the coefficients of the program (`fp3_compiled_exact_given`).

In the table of a section a row is a kind of result, with what is expected and measured in all results of the kind, from the least to the most. ± is the
tolerance, if all have the same. If a name has …, its figures differ. Each single result, with its model, integrator and arithmetic, is in
`build/results/stress.json`, which `make stress` writes."""

FARTHEST = 8    # what goes further along the axis (stabilised methods) would make the picture of regions too flat to see

# section: heading, of equations or of models, text
SECTIONS = {
    "stability": ("Stability limits", """\
The equation is x' = v, v' = -k x - c v. Its eigenvalues λ are at an angle from the negative real axis (0 degrees: x' = -a x), and the step is 1. 512
objects differ in |hλ|. The limit is next to the first object that grows, found with 512 more objects there. Theory: |R| = 1 for the stability
polynomial R(z) = 1 + sum of z^j b A^(j-1) 1, or for the largest eigenvalue of the matrix of a step, both in double. For linearly implicit methods R is
rational. ∞ means: nothing grows, in theory up to |hλ| = 1e6, measured up to 512. The tolerance is 0.1 %. Some methods grow at every step (limit 0), or too
slowly for a million steps; their figure is the step from which growth in 2^14 steps is a quarter. The picture leaves out stabilised methods, which go far
along the axis."""),
    "steps": ("Errors by step size", """\
The equations are x'' = -x, and x'' = -x + cos(2 t) (`driven`), to t = 8, for 64 objects. Errors are root mean squares. On the left of the picture the error
falls with the order p; its slope has to be that of the same 8 objects in double. On the right rounding errors grow with the number N of steps: with N^(1/2)
if they are independent, with up to N otherwise (Higham, Accuracy and Stability of Numerical Algorithms, 2002, section 2.8). Truncated (`cell`), all have one
direction. With compensated updates and with double-single only a random walk of roundings at the end of the second word grows. Stoermer's method turns a
rounding r of x into one of the velocity, r/h. Below h = u^(1/3) = 0.005, u = 2^-23, its roundings are alike from step to step where the acceleration is
stationary: they grow with h^-3, truncated with h^-2. Compensated, the method carries h v as one float, and the error is a random walk of its roundings."""),
    "events": ("Order under events", """\
A bouncing ball, 4,096 objects. Events happen at the ends of steps ([models.md](models.md#when-it-happens)), so every integrator has order 1."""),
    "drift": ("A million steps", """\
Kepler's problem with eccentricity 0.2, for 64 orbits that differ by a turn, so that their roundings are independent (65,536 steps in double-single and in `cell`). Their
mean shows the effect of the method and of its coefficients, which are FP32 numbers. Their spread is the random walk of roundings. A symplectic method keeps
energy and momentum; another method drifts as in double. A rounding is 2.5e-8 of a number, root mean square, and the tolerance is four standard deviations of
the walk. The error of a coefficient c is less than half a unit of c k; rounding may remove or double this error, alike in all orbits. So the tolerance has
the effect of rounded coefficients in double once more. Truncation takes 4.3e-8 of each update on average, which is a linear drift. An error of place, over an orbit and
since the first, grows with t (symplectic) or t^2, and its spread with t^(3/2) (Hairer, Lubich and Wanner, Geometric Numerical Integration, X.3; Brouwer
1937)."""),
    "reversal": ("There and back", """\
A planet goes to t = 12, its velocity is reversed, and it goes as far again. A symmetric method comes back to the start, but for roundings. Another method is
off by h^p for an odd order p, and by h^(p+1) for an even order."""),
    "chance": ("Params over many decades", """\
4,096 oscillators with k from 1e-6 to 1e3 and any damping below the critical one make 512 steps of 1. By theory, an oscillator fails if its growth reaches the
end of FP32. The engine has to report each failure, with its step."""),
    "stagnation": ("Where nothing moves", """\
`move`: 1 + h f stays 1 if h f is up to half a unit (2^-24; the tie goes to the even 1), truncated below a unit. `calm`: x' = p - q x stops where h f is
below half a unit of x. That bounds the distance from p/q, which is given as a share of this bound. In double-single all sums of `move` are exact."""),
    "subnormal": ("The lower end", """\
A decay by a at each step ends exactly at floor(1/(2 a)) units of 2^-149, truncated at ceil(1/a) - 1. Flushed, it ends above 2^-126."""),
    "failures": ("Overflow and NaN", """\
One object of 600 gets a number that overflows later, a NaN or an infinity. The engine has to name the object and the step. In double-single a number
overflows from 2^116 on, when it is split. In `cell` all three are numbers from 2^128 on, and reported as such."""),
    "chaos": ("Chaos", """\
The largest Lyapunov exponent of Lorenz's equations, from the linearised equations of 512 objects. Published: 0.9056 (Sprott, Chaos and Time-Series
Analysis, 2003; Viswanath 1998). The tolerance is 5 %."""),
    "invariants": ("Invariants of the models", """\
The largest change of each `invariant`. It may be as large as in double, plus four standard deviations of a random walk: one rounding of each state in each
step, by the derivatives of the invariant."""),
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


FIGURE = r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w.^]*\w)"


def kinds(rows):
    """Results whose names differ in a subject (`energy: `) and figures alone, under what they share."""
    found = {}
    for row in rows:
        subject, name = re.match(r"(?:([^=:,]{1,16}): )?(.*)", row["name"]).groups()
        key = re.sub(FIGURE, "…", name), row["relation"]
        found.setdefault(key, []).append((row, subject or "", re.findall(FIGURE, name)))
    for (name, relation), of in found.items():
        varies = [len(set(figures)) > 1 for figures in zip(*(figures for _, _, figures in of))]
        same = iter([figure for figure, differs in zip(of[0][2], varies) if not differs])
        which = iter(varies)
        yield re.sub("…", lambda _: "…" if next(which) else next(same), name), relation, [
            (row, subject, [figure for figure, differs in zip(figures, varies) if differs])
            for row, subject, figures in of]


def spread(values, nothing):
    """The least and the most."""
    known = sorted(value for value in values if value is not None)
    texts = [number(known[0]), number(known[-1])] if known else []
    return " to ".join(dict.fromkeys([*texts, *([nothing] if len(known) < len(values) else [])]))


def expected_of(rows, nothing):
    """With the tolerance, if all have the same."""
    tolerances = {row["tolerance"] or 0 for row in rows}
    text = spread([row["expected"] for row in rows], nothing)
    return f"{text} ± {number(tolerances.pop())}" if len(tolerances) == 1 and any(tolerances) else text


def details(rows):
    """A row for each kind of result, from what there is most of."""
    nothing = "∞" if rows[0]["section"] == "stability" else "–"
    lines = []
    for name, relation, of in kinds(rows):
        for subject in dict.fromkeys(subject for _, subject, _ in of):
            some = [row for row, other, _ in of if other == subject]
            lines.append([f"{subject}: {name}" if subject else name, relation, expected_of(some, nothing), spread([row["measured"] for row in some], nothing), len(some)])
    return table(["what", "has to be", "expected", "measured", "results"], sorted(lines, key=lambda line: (-line[-1], line[0])))


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
        rows = [row for row in rows if row["arithmetic"] != "plain"]
        parts += ["![stability regions](stress_regions.svg)", limits(results), *(["The other arithmetics:"] if rows else [])]
    parts += {"steps": ["![error by step size](stress_steps.svg)"], "drift": ["![energy](stress_energy.svg)", "![place](stress_place.svg)"]}.get(name, [])
    return "\n\n".join([*parts, *([details(rows)] if rows else [])])


def page(data):
    results = data["results"]
    held = sum(row["holds"] for row in results)
    return "\n\n".join(part for part in [
        "<!-- Generated by tools/pages.py (make report PAGES=stress): do not edit. -->", "# Stress", "*Measured, for numerics.*", INTRODUCTION,
        f"There are {len(results)} results, of which {held} hold.", "\n".join(evidence("stress")),
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
