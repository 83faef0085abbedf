"""A reader of programs/integrators/*.cfg and steppers that are not the library's, in double."""

import cmath
import functools
import math
import pathlib
import re

NAMES = sorted(path.stem for path in (pathlib.Path(__file__).resolve().parents[2] / "programs/integrators").glob("*.cfg"))

TOKEN = re.compile(r'"[^"]*"|[][{}();,=]|[^][\s{}();,="]+')


def number(text):
    """A number, or a formula in a string."""
    return float(eval(text.strip('"').replace("^", "**"), {"sqrt": math.sqrt}))


def read(path):
    """A table as a dictionary; lists stay lists of text, a substep is (name, text)."""
    tokens = TOKEN.findall(re.sub(r"#.*", "", path.read_text()))

    def value():
        token = tokens.pop(0)
        if token == "{":
            name, _, number, _, _ = (tokens.pop(0) for _ in range(5))
            return name, number
        if token != "(":
            return token
        members = []
        while tokens[0] != ")":
            members.append(value())
            if tokens[0] == ",":
                tokens.pop(0)
        tokens.pop(0)
        return members

    table = {}
    while tokens:
        key, equals = tokens.pop(0), tokens.pop(0)
        table[key] = value()
        assert equals == "=" and tokens.pop(0) == ";"
    table = {key: v.strip('"') if isinstance(v, str) else v for key, v in table.items()}
    if "A" in table:
        table["A"] = [[number(a) for a in row] for row in table["A"]]
        table["b"] = [number(b) for b in table["b"]]
    if "embedded" in table:
        table["embedded"] = [number(b) for b in table["embedded"]]
    if "G" in table:
        table["gamma"] = number(table["gamma"])
        table["G"] = [[number(g) for g in row] for row in table["G"]]
    if "substeps" in table:
        table["substeps"] = [(name, number(x)) for name, x in table["substeps"]]
    if "stages" in table:
        table["stages"], table["damping"] = int(table["stages"]), number(table["damping"])
    table["order"] = int(table["order"])
    table["late_position"] = table.get("late_position") == "true"
    return table


def accelerations(table):
    """Per step, where a kick at the end and one at the beginning of the next step share one."""
    if table["kind"] == "runge-kutta":
        return len(table["b"]) - (table["b"][-1] == 0)  # the last stage serves an error estimate
    if table["kind"] == "rosenbrock":  # stages at the same place share one
        return len({tuple(row + [0] * (len(table["b"]) - len(row))) for row in map(list, table["A"])})
    if table["kind"] in ("stoermer", "chebyshev"):
        return table.get("stages", 1)
    kicks = [name == "kick" for name, _ in table["substeps"]]
    return sum(kicks) - (kicks[0] and kicks[-1])


def plus(u, *terms):
    """u + sum of factor * vector."""
    for factor, vector in terms:
        u = [a + factor * b for a, b in zip(u, vector)]
    return u


def solve(matrix, right):
    """By Gauss' elimination with pivots."""
    rows = [[*row, b] for row, b in zip(matrix, right)]
    for i in range(len(rows)):
        pivot = max(range(i, len(rows)), key=lambda k: abs(rows[k][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        for k in range(i + 1, len(rows)):
            rows[k] = [a - rows[k][i] / rows[i][i] * b for a, b in zip(rows[k], rows[i])]
    for i in reversed(range(len(rows))):
        rows[i] = [a / rows[i][i] for a in rows[i]]
        for k in range(i):
            rows[k] = [a - rows[k][i] * b for a, b in zip(rows[k], rows[i])]
    return [row[-1] for row in rows]


def implicit_step(table, acceleration, x, v, h):
    """By Rosenbrock's formula as it is written, with a Jacobian from central differences."""
    n, y = len(x), [*x, *v]

    def f(y):
        return [*y[n:], *acceleration(y[:n], y[n:])]

    apart = 1e-5
    columns = [[(a - b) / (2 * apart) for a, b in zip(*(f([c + (i == j) * s for j, c in enumerate(y)]) for s in (apart, -apart)))]
               for i in range(2 * n)]
    jacobian = list(zip(*columns))
    matrix = [[(i == j) - h * table["gamma"] * a for j, a in enumerate(row)] for i, row in enumerate(jacobian)]
    k = []
    for row, gammas in zip(table["A"], table["G"]):
        slope = f(plus(y, *((a, one) for a, one in zip(row, k))))
        mixed = plus([0.0] * len(y), *((g, one) for g, one in zip(gammas, k)))
        k.append(solve(matrix, [h * a + h * sum(b * c for b, c in zip(line, mixed)) for a, line in zip(slope, jacobian)]))
    y = plus(y, *((b, one) for b, one in zip(table["b"], k)))
    return y[:n], y[n:]


@functools.cache
def chebyshev_coefficients(s, damping):
    """The first one, and mu, nu, mu~ and gamma~ of each stage: equations (2.4) of Sommeijer, Shampine and Verwer, with T_j(cosh u) = cosh(j u)."""
    w = 1 + damping / s**2
    u = math.acosh(w)
    value = [math.cosh(j * u) for j in range(s + 1)]
    slope = [j * math.sinh(j * u) / math.sinh(u) for j in range(s + 1)]
    bend = [(j * j * t - w * d) / (w * w - 1) for j, (t, d) in enumerate(zip(value, slope))]
    w1 = slope[s] / bend[s]
    b = [bend[max(j, 2)] / slope[max(j, 2)] ** 2 for j in range(s + 1)]
    stages = []
    for j in range(2, s + 1):
        share = 2 * b[j] * w1 / b[j - 1]
        stages.append((2 * b[j] * w / b[j - 1], -b[j] / b[j - 2], share, -(1 - b[j - 1] * value[j - 1]) * share))
    return b[1] * w1, stages


def chebyshev_step(table, f, y, h):
    first, stages = chebyshev_coefficients(table["stages"], table["damping"])
    at_y = f(y)
    before, now = y, plus(y, (first * h, at_y))
    for mu, nu, share, rest in stages:
        before, now = now, plus([(1 - mu - nu) * a for a in y], (mu, now), (nu, before), (share * h, f(now)), (rest * h, at_y))
    return now


def step(table, acceleration, x, v, h):
    """One step of x' = v, v' = acceleration(x, v), by Runge-Kutta or a splitting."""
    if table["kind"] == "splitting":
        for name, coefficient in table["substeps"]:
            if name == "kick":
                v = plus(v, (coefficient * h, acceleration(x, v)))
            else:
                x = plus(x, (coefficient * h, v))
        return x, v
    if table["kind"] == "rosenbrock":
        return implicit_step(table, acceleration, x, v, h)
    if table["kind"] == "chebyshev":
        n = len(x)
        y = chebyshev_step(table, lambda y: [*y[n:], *acceleration(y[:n], y[n:])], [*x, *v], h)
        return y[:n], y[n:]
    kx, kv = [], []
    for row in table["A"]:
        at_x = x if table["late_position"] else plus(x, *((h * a, k) for a, k in zip(row, kx)))
        at_v = plus(v, *((h * a, k) for a, k in zip(row, kv)))
        kx.append(at_v)
        kv.append(acceleration(at_x, at_v))
    v = plus(v, *((h * b, k) for b, k in zip(table["b"], kv)))
    x = plus(x, (h, v)) if table["late_position"] else plus(x, *((h * b, k) for b, k in zip(table["b"], kx)))
    return x, v


def run(table, acceleration, x, v, h, steps):
    for _ in range(steps):
        x, v = step(table, acceleration, x, v, h)
    return x, v


def run_stoermer(acceleration, before, x, h, steps):
    for _ in range(steps):
        before, x = x, [2 * a - b + h * h * c for a, b, c in zip(x, before, acceleration(x, None))]
    return x


# ---- Kepler's problem: gravity 1, semi-major axis 1, so that an orbit takes 2 pi -----------------

def gravity(x, _):
    r = math.hypot(*x)
    return [-a / r**3 for a in x]


def kepler(e, t):
    """Position and velocity at time t after the pericentre."""
    E = t
    for _ in range(50):
        E -= (E - e * math.sin(E) - t) / (1 - e * math.cos(E))
    rate, b = 1 / (1 - e * math.cos(E)), math.sqrt(1 - e * e)
    return [math.cos(E) - e, b * math.sin(E)], [-rate * math.sin(E), rate * b * math.cos(E)]


def energy(x, v):
    return sum(a * a for a in v) / 2 - 1 / math.hypot(*x)


# ---- stability --------------------------------------------------------------------------------------

def linear_step(table, z):
    """Of y' = lambda y, from 1, with z = h lambda: the end of a step by Runge-Kutta, and the estimate of its error (None: the table has none)."""
    if table["kind"] == "chebyshev":
        y = chebyshev_step(table, lambda y: [z * y[0]], [1.0], 1.0)[0]
        return y, 0.8 * (1 - y) + 0.4 * (z + z * y)  # the paper's
    k = []
    for row, gammas in zip(table["A"], table.get("G", [[]] * len(table["A"]))):
        known = 1 + sum(a * y for a, y in zip(row, k)) + sum(g * y for g, y in zip(gammas, k))
        k.append(z * known / (1 - z * table.get("gamma", 0)))
    estimate = sum((b - e) * y for b, e, y in zip(table["b"], table["embedded"], k)) if "embedded" in table else None
    return 1 + sum(b * y for b, y in zip(table["b"], k)), estimate


def growth(table, z):
    """|y1/y0| of y' = lambda y with z = h lambda."""
    return abs(linear_step(table, z)[0])


def has_estimate(table):
    return table["kind"] == "chebyshev" or "embedded" in table


def estimate_to_error(table, z):
    y, estimate = linear_step(table, z)
    return abs(estimate) / abs(y - cmath.exp(z))


def swing(table, z):
    """The largest eigenvalue of a step of x'' = -x with h = z, by a splitting."""
    (a, c), (b, d) = (sum(step(table, lambda x, _: [-x[0]], [x], [v], z), []) for x, v in ((1.0, 0.0), (0.0, 1.0)))
    root = cmath.sqrt((a + d) ** 2 / 4 - (a * d - b * c))
    return max(abs((a + d) / 2 + root), abs((a + d) / 2 - root))


def stable_up_to(grows, noise=1e-12, fine=1e-3):
    """The end of the first interval from 0 where nothing grows; 0 where something does at once."""
    at = 0.2
    if all(grows(10.0**n) <= 1 + noise for n in range(-3, 9)):  # everywhere, for all that a table can do
        return math.inf
    if grows(at) > 1 + noise:
        return 0.0
    while grows(at) <= 1 + noise:
        at += fine
    low, high = at - fine, at
    while high - low > 1e-9:
        middle = (low + high) / 2
        low, high = (middle, high) if grows(middle) <= 1 + noise else (low, middle)
    return low


def stability(table):
    """Limits of h*lambda where y' = -lambda y decays and x'' = -lambda^2 x swings; None: not its business."""
    if table["kind"] == "stoermer":  # z^2 + (h^2 - 2) z + 1 has its roots on the unit circle
        return None, 2.0
    if table["kind"] == "splitting":
        return None, stable_up_to(lambda z: swing(table, z), 1e-9)
    # Extrema of Chebyshev's polynomial are more than 1 apart.
    decay = stable_up_to(lambda z: growth(table, -z), fine=0.05 if table["kind"] == "chebyshev" else 1e-3)
    if table["late_position"]:
        return decay, stable_up_to(lambda z: swing(table, z), 1e-9)
    return decay, stable_up_to(lambda z: growth(table, 1j * z))


def energy_error(table, e=0.5, orbits=30, per_orbit=1200):
    """The worst relative error of the energy at this price."""
    n = per_orbit // accelerations(table)
    x, v = kepler(e, 0)
    start, worst = energy(x, v), 0.0
    for _ in range(orbits * n):
        x, v = step(table, gravity, x, v, 2 * math.pi / n)
        worst = max(worst, abs(energy(x, v) / start - 1))
    return worst
