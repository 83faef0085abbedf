"""What theory says of the scenes, beside what their objects do: links that remember, and break or yield."""

import numpy as np
from fp3world import scene as ws
from fp3world.physics import Springs, relative, row

# ---- a girder that breaks ----

H, K, C, LIMIT, RATE, LOADED = 2.0 ** -12, 1e5, 400.0, 300.0, 120.0, 2


class Girder:
    """The joints of programs/world/bridge.csv on springs, in double."""

    def __init__(self):
        self.points, bars = (np.loadtxt(ws.FOLDER / name, delimiter=",", skiprows=2) for name in ("bridge.csv", "bridge_bars.csv"))
        self.springs = Springs(bars[:, :2].astype(int).tolist(), np.full(len(bars), K), bars[:, 2], len(self.points))
        self.free = np.flatnonzero(np.repeat(self.points[:, 2] > 0, 2))

    def forces(self, moved):
        """On the free joints, as they are moved; and in the bars."""
        x = np.zeros((len(self.points), 3))
        flat = self.points[:, :2].flatten()
        flat[self.free] += moved
        x[:, :2] = flat.reshape(-1, 2)
        return self.springs.forces(x)[:, :2].ravel()[self.free], K * (self.springs.ways(x)[1] - self.springs.rest)

    def carries(self, load):
        """What is in each bar at rest, by Newton's method: joints stand where springs hold the load."""
        wanted = np.zeros(2 * len(self.points))
        wanted[2 * LOADED + 1] = load
        moved = np.zeros(len(self.free))
        for _ in range(8):
            left = self.forces(moved)[0] - wanted[self.free]
            slopes = np.stack([(self.forces(moved + 1e-6 * one)[0] - self.forces(moved - 1e-6 * one)[0]) / 2e-6 for one in np.eye(len(moved))], 1)
            moved = moved - np.linalg.solve(slopes, left)
        return self.forces(moved)[1]


def breaking(lab):
    """Statics say with which load the first bar carries its limit (Timoshenko and Young, Theory of Structures, chapter 2); dampers c beside springs k
    follow a load that grows as t by c/k later."""
    found, _ = lab.record(ws.text_of("breaking"), "--steps", 8192)
    seen = found["broken"][-1]
    girder, load = Girder(), LIMIT
    first = int(np.argmax(abs(girder.carries(load))))
    for _ in range(4):  # what a bar carries is a straight line but for how far joints move
        load *= LIMIT / abs(girder.carries(load)[first])
    step = (load / RATE + C / K) / H
    begin = np.sort(seen[seen > 0])[0]
    yield row("breaking", "step in which the first bar breaks", step, begin / H - 1, 2,
              "the first one after that; a bar's force is k times a rounding of 2^-23 of a metre, 0.012 N, or a third of a step; what still swings as much")
    ends = np.flatnonzero(seen == begin)
    broken = [k for k, (a, b) in enumerate(zip(girder.springs.a, girder.springs.b)) if list(ends) == sorted((a, b))]
    yield row("breaking", "which bar it is", first, broken[0] if broken else -1, 0, "the next one carries less by a tenth")


def plastic(lab):
    """Of a rod that yields at k d, moved to and fro by a: 4 k d (a - d) in a turn (Lubliner, Plasticity Theory, chapter 2)."""
    found, times = lab.record(ws.text_of("plastic"), "--every", 2)
    k, d = 100, 0.05
    loop = (times >= 0.25) & (times <= 2.25)  # two turns
    for rod, far in ((1, 0.04), (2, 0.1), (3, 0.2)):
        x, F = found["x"][loop, rod], -found["F"][loop, rod]
        work = ((F[1:] + F[:-1]) / 2 * np.diff(x)).sum() / 2
        wanted = 4 * k * d * max(0, far - d)
        why = "a step in which it begins to yield: k (a w h)^2 at most, four times a turn"
        yield row("plastic", f"work of a turn that moves the end by {far:g} m, J", wanted, work, 5e-4 * (wanted or 0.1), why)
        yield relative("plastic", f"largest force, moved by {far:g} m, N", k * min(far, d), F.max(), 1e-4, "places have a rounding of 2^-24 of a metre in each step")
