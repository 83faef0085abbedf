"""What theory says of the scenes, beside what their objects do: springs along lines and in nets.

A check is a function of a Lab that yields rows. Each row has the figure that is expected, the one that is found, and how
far apart they may be, with the reason.
"""

import numpy as np
from fp3world import scene as ws


class Lab:
    def __init__(self, fp3, folder, quick):
        self.fp3, self.folder, self.quick = fp3, folder, quick

    def record(self, text, *options):
        return ws.record(self.fp3, ws.put(self.folder, text, "physics"), *options)


def runge_kutta(slopes, y, steps, h):
    """What the classical method makes of y, after each step."""
    found = []
    for _ in range(steps):
        a = slopes(y)
        b = slopes(y + h / 2 * a)
        c = slopes(y + h / 2 * b)
        y = y + h / 6 * (a + 2 * b + 2 * c + slopes(y + h * c))
        found.append(y)
    return np.array(found)


def row(scene, what, expected, found, within, why):
    """within: how far apart they may be, in the unit of both."""
    return {"scene": scene, "what": what, "expected": float(expected), "found": float(found), "within": float(within), "why": why,
            "holds": bool(abs(found - expected) <= within)}


def relative(scene, what, expected, found, share, why):
    return row(scene, what, expected, found, share * abs(expected), why)


def frequency(values, interval, about):
    """Angular frequency of a cosine: q(t + s) + q(t - s) = 2 cos(w s) q(t), by least squares with s about a quarter of a period."""
    s = max(1, round(np.pi / 2 / about / interval))
    middle, ends = values[s:-s], values[2 * s:] + values[:-2 * s]
    return np.arccos(np.clip((middle @ ends) / (2 * middle @ middle), -1, 1)) / (s * interval)


# ---- energy of springs ----

class Springs:
    """Links of a grid, in double: forces and energies of all snapshots' positions."""

    def __init__(self, links, k, rest, objects):
        self.a, self.b = (np.array([link[i] for link in links]) for i in range(2))
        self.k, self.rest, self.objects = np.array(k, dtype=float), np.array(rest, dtype=float), objects

    def ways(self, x):
        way = x[self.b] - x[self.a]
        return way, np.linalg.norm(way, axis=1)

    def forces(self, x, v=None, damping=0.0):
        way, length = self.ways(x)
        pull = (self.k * (1 - self.rest / length))[:, None] * way
        if v is not None:
            pull = pull + damping * (v[self.b] - v[self.a])
        total = np.zeros((self.objects, 3))
        np.add.at(total, self.a, pull)
        np.add.at(total, self.b, -pull)
        return total

    def energy(self, x):
        return float((self.k * (self.ways(x)[1] - self.rest) ** 2).sum() / 2)


def springs_of_grid(count, spacing, blocks):
    """blocks: kinds, and k of each."""
    parts = [(ws.grid_links(count, spacing, kinds), k) for kinds, k in blocks]
    links = [link for part, _ in parts for link in part]
    return Springs(links, [k for part, k in parts for _ in part], [link[2] for link in links], int(np.prod(count)))


# ---- checks ----

def chain(lab):
    """Goldstein, Classical Mechanics, chapter 13: angular frequencies 2 sqrt(k/m) sin(n pi/(2 (N + 1)))."""
    found, times = lab.record(ws.text_of("chain"), "--every", 1)
    shape = np.sin(np.pi * np.outer(np.arange(34), np.arange(1, 33)) / 33)
    modes = found["u"] @ shape
    expected = 20 * np.sin(np.pi * np.arange(1, 33) / 66)
    measured = np.array([frequency(modes[:, n], times[1] - times[0], expected[n]) for n in range(32)])
    why = "rk4 errs by (w h)^4/120 < 5e-6, rounding of u by 2^-24 of it"
    for n in (1, 8, 32):
        yield relative("chain", f"angular frequency of mode {n}, 1/s", expected[n - 1], measured[n - 1], 2e-5, why)
    yield row("chain", "largest error of the 32 frequencies, as a share", 0, abs(measured / expected - 1).max(), 2e-5, why)


def membrane(lab):
    """Rayleigh, The Theory of Sound, chapter 9: pi c/L sqrt(p^2 + q^2); of masses on threads, sines in place of p and q."""
    found, times = lab.record(ws.text_of("membrane"), "--every", 4)
    side, stretched, rest, k, w = 20, 0.05, 0.025, 60, 1000
    pull = k * (stretched - rest)
    height = found["x_y"].reshape(len(times), side + 1, side + 1)
    for p, q in ((1, 1), (1, 2), (2, 2), (3, 1)):
        sines = [np.sin(np.pi * n * np.arange(side + 1) / side) for n in (p, q)]
        mode = np.einsum("tij,j,i->t", height, *sines)
        masses = np.sqrt(4 * w * pull / stretched * sum(np.sin(np.pi * n / (2 * side)) ** 2 for n in (p, q)))
        measured = frequency(mode, times[1] - times[0], masses)
        yield relative("membrane", f"mode ({p}, {q}): discrete masses, rad/s", masses, measured, 5e-5,
                       "leapfrog errs by (w h)^2/24 < 1e-5, the deflection of 2e-3 of a thread by its square, 4e-6")
        skin = np.pi * np.sqrt(w * pull * stretched * (p * p + q * q))
        yield relative("membrane", f"mode ({p}, {q}): continuous membrane, rad/s", skin, measured, 1.2 * (np.pi * max(p, q) / side) ** 2 / 24,
                       "masses at a distance a swing slower, by up to (pi p a)^2/24")


def cloth(lab):
    """What dampers take is missing from the energy of masses and springs."""
    steps, h, m, c, air = (256 if lab.quick else 2048), 2.0 ** -10, 0.001, 0.005, 0.001
    found, times = lab.record(ws.text_of("cloth"), "--every", 1, "--steps", steps)
    springs = springs_of_grid((20, 20), 0.05, [(["structural", "shear"], 100), (["bending"], 10)])
    mass = np.full(400, m)
    mass[[0, 19]] = 0
    energy, lost = [], []
    for x, v in zip(ws.vectors(found, "x"), ws.vectors(found, "v")):
        pull = springs.forces(x, v, c) - air * v
        now = v + np.where(mass > 0, h / 2, 0)[:, None] * (pull / m + np.array([0, -9.81, 0]))
        apart = now[springs.b] - now[springs.a]
        energy.append((mass * (now ** 2).sum(1)).sum() / 2 + springs.energy(x) + 9.81 * (mass * x[:, 1]).sum())
        lost.append(c * (apart ** 2).sum() + air * (now ** 2).sum())
    taken = h * (sum(lost) - (lost[0] + lost[-1]) / 2)
    yield relative("cloth", f"energy that is missing after {times[-1]:g} s, beside what dampers took, J", taken, energy[0] - energy[-1], 5e-3 if lab.quick else 1e-4,
                   "leapfrog keeps an energy that differs by (w h)^2/8 of what the fastest springs have: little, when they have come to rest")


def net(lab):
    """Nothing damps it: kinetic, potential and springs' energy stay as they are."""
    steps = 512 if lab.quick else 4096
    found, times = lab.record(ws.text_of("net"), "--every", steps // 8, "--steps", steps)
    springs = springs_of_grid((128, 128), 0.0078125, [(["structural", "shear"], 60), (["bending"], 6)])
    m, h = 0.2 / 16384, 2.0 ** -12
    mass = np.where(np.arange(16384) < 128, 0, m)
    energy, moving = [], []
    for x, v in zip(ws.vectors(found, "x"), ws.vectors(found, "v")):
        now = v + np.where(mass > 0, h / 2, 0)[:, None] * (springs.forces(x) / m + np.array([0, -9.81, 0]))
        moving.append((mass * (now ** 2).sum(1)).sum() / 2)
        energy.append(moving[-1] + springs.energy(x) + 9.81 * (mass * (x[:, 1] - 1)).sum())
    yield row("net", f"largest change of energy within {times[-1]:g} s, of the largest kinetic energy", 0,
              max(abs(e - energy[0]) for e in energy) / max(moving), 5e-4, "leapfrog keeps an energy that differs by (w h)^2/8 of what the fastest springs have")


def rope_at_rest(links, rest, k, weight, span):
    """Springs between weights, by the statics of their joints: half of the tension along is found by bisection. (sag, tension along)"""
    def shape(along):
        down = weight * (np.arange(links) - (links - 1) / 2)
        pull = np.hypot(along, down)
        length = rest + pull / k
        return (length * along / pull).sum(), (length * down / pull)
    low, high = 1e-9, 1e3
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (middle, high) if shape(middle)[0] < span else (low, middle)
    return -np.cumsum(shape(low)[1]).min(), low


def rope(lab):
    """The catenary: Goldstein, Classical Mechanics, chapter 2. y = a cosh(x/a), length 2 a sinh(span/2a)."""
    links, rest, k, m, span = 40, 0.06, 2000, 0.001, 2.0
    found, _ = lab.record(ws.text_of("rope"))
    x = ws.vectors(found, "x")[-1]
    sag, along = rope_at_rest(links, rest, k, m * 9.81, span)
    yield relative("rope", "sag of weights on springs, m", sag, x[0, 1] - x[:, 1].min(), 1e-4, "what still moves, and rounding of 2^-24 of 2 m in each of 40 places")
    low, high = 0.1, 100.0
    for _ in range(100):
        a = (low + high) / 2
        low, high = (a, high) if 2 * a * np.sinh(span / 2 / a) > links * rest else (low, a)
    yield row("rope", "sag of a catenary, m", a * (np.cosh(span / 2 / a) - 1), x[0, 1] - x[:, 1].min(), 4e-3,
              "40 springs are longer by 1e-4 m each, and no curve: 1/40^2 of it")
    way = x[1] - x[0]
    length = np.linalg.norm(way)
    pull = k * (1 - rest / length) * way
    yield relative("rope", "what an end carries, N", (links - 1) / 2 * m * 9.81, -pull[1], 5e-3, "a spring's force is k times a rounding of 2^-24 of 2 m: 2.4e-4 N of 0.19 N")
    yield relative("rope", "pull along at an end, N", along, pull[0], 5e-3, "likewise")


def truss(points, bars, k, loads):
    """Small deflections of joints of which some are held: K u = f, by NumPy."""
    stiff = np.zeros((len(points), 2, len(points), 2))
    for a, b in bars:
        way = (points[b] - points[a]) / np.linalg.norm(points[b] - points[a])
        part = k * np.outer(way, way)
        for i, j, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
            stiff[i, :, j] += sign * part
    free = np.ravel([[2 * i, 2 * i + 1] for i in range(len(points)) if np.isfinite(loads[i]).all()])
    found = np.zeros(2 * len(points))
    found[free] = np.linalg.solve(stiff.reshape(2 * len(points), -1)[np.ix_(free, free)], loads.ravel()[free])
    return found.reshape(-1, 2)


def bridge(lab):
    """A Warren girder of bars that only pull and push: Timoshenko and Young, Theory of Structures, chapter 2."""
    found, _ = lab.record(ws.text_of("bridge"))
    k, weight, held = 1e5, 9.81, [0, 6]
    points, bars = (np.loadtxt(ws.FOLDER / name, delimiter=",", skiprows=2) for name in ("bridge.csv", "bridge_bars.csv"))
    springs = Springs(bars[:, :2].astype(int).tolist(), np.full(len(bars), k), bars[:, 2], len(points))
    start, x = ws.vectors(found, "x")
    loads = np.tile([0, -weight], (len(points), 1))
    loads[held] = np.nan
    expected = truss(points[:, :2], bars[:, :2].astype(int), k, loads)
    yield relative("bridge", "deflection of the middle, m", expected[3, 1], x[3, 1] - start[3, 1], 0.01, "K u = f takes bars to be as they were: they turn by 6e-3 and change by 9e-4")
    worst = abs((x - start)[:, :2] - expected).max() / abs(expected).max()
    yield row("bridge", "largest error of a joint's deflection, of the largest deflection", 0, worst, 0.01, "likewise")
    carried = -springs.forces(x)[held, 1]
    rounding = "a bar's force is k times a rounding of 2^-24 of 3 m: 0.02 N"
    yield row("bridge", "what the ends carry, N", (len(points) - 2) * weight, carried.sum(), 0.1, rounding)
    yield row("bridge", "difference of what the ends carry, N", 0, carried[0] - carried[1], 0.1, rounding)
