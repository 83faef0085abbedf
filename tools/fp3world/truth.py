"""How far what a scene's steps give is from what they should give: the column `error` of the scenes' speeds.

A net's steps are made again in double precision. Bodies that attract each other keep their energy.
"""

import math

import numpy as np
from fp3scenes import problems
from fp3world import bodies
from fp3world import cases
from fp3world import scene as ws

# ---- where fp3 has the objects ----

def at(lab, case, steps):
    """Positions and velocities, [object, axis], after so many steps of engine fast."""
    path = ws.put(lab.folder, case.text(lab.quick), "truth")
    words, names = ws.words_of(ws.call(lab.fp3, path, "--engine", "fast", "--steps", steps, "--all"))
    columns = dict(zip(names, words.view(np.float32).T.astype(float)))
    return ws.vectors(columns, "x"), ws.vectors(columns, "v")


# ---- springs ----

class Net:
    """programs/world/net.scene. Object k is at (k % columns, k // columns); the first row is held."""
    spacing, w, g, stiffness = (problems.NET[name] for name in ("apart", "w", "g", "k"))
    h = 2.0 ** -12

    def __init__(self, quick):
        self.case = cases.find("net")
        self.columns, self.rows = (40, 20) if quick else (128, 128)
        self.objects, self.steps = self.columns * self.rows, 64 if quick else 1024
        self.size = self.spacing * (max(self.columns, self.rows) - 1)
        self.made = problems.NET | {"columns": self.columns, "rows": self.rows, "held": tuple(range(self.columns))}

    def ways(self):
        """Half of the neighbours of an object: columns and rows to go, and the stiffness of the spring."""
        for kind, k in self.stiffness.items():
            for x, y in ws.grid_ways((kind,), 2):
                yield x, y, k

    def start(self):
        k = np.arange(self.objects)
        return np.stack([self.spacing * (k % self.columns), np.ones(self.objects), self.spacing * (k // self.columns)], -1)

    def in_double(self):
        """Positions after the steps, made in double precision."""
        x = self.start().reshape(self.rows, self.columns, 3)
        v, total = np.zeros_like(x), np.empty_like(x)
        for _ in range(self.steps):
            total[:] = 0, -self.g / self.w, 0
            for to, across, k in self.ways():
                ends = np.s_[:self.rows - across, max(0, -to):self.columns - max(0, to)], np.s_[across:, max(0, to):self.columns + min(0, to)]
                way = x[ends[1]] - x[ends[0]]
                way *= (k * (1 - self.spacing * math.hypot(to, across) / np.sqrt(np.einsum("ijk,ijk->ij", way, way))))[..., None]
                total[ends[0]] += way
                total[ends[1]] -= way
            v[1:] += self.h * self.w * total[1:]
            x += self.h * v
        return x.reshape(-1, 3)

    def error(self, lab, found):
        """Largest difference of a coordinate after the steps, as a share of the net's length."""
        return below(1e-4, self.case.name(lab.quick), self.difference(lab, found))

    def difference(self, lab, found):
        kept = lab.folder / "net.npy"  # it takes some seconds, and each peer asks
        if not kept.exists():
            np.save(kept, self.in_double())
        return abs(found - np.load(kept)).max() / self.size

    def check(self, found):
        """A net that bursts says nothing about time."""
        if not (np.abs(found).max() < 2 and (self.start()[:, 1] - found[:, 1]).max() > 0):
            raise ws.Failed("the net bursts, or does not fall")


# ---- gravity ----

class Stars:
    """programs/world/stars.scene: bodies of the mass 1/objects."""
    h, soft = 2.0 ** -10, 0.1

    def __init__(self, label, quick):
        self.case, self.name, self.objects = cases.find(label), cases.find(label).name(quick), 70 if quick else int(label.split()[-1])
        self.steps = 64 if quick else 2048
        self.made = {"soft": self.soft, "m": 1 / self.objects}

    def start(self, lab):
        return at(lab, self.case, 0)

    def energy(self, x, v):
        return bodies.energy(x, v, np.full(self.objects, 1 / self.objects), self.soft)

    def error(self, lab, x, v):
        """Change of the energy after the steps, as a share of it."""
        return below(1e-3, self.name, abs(self.energy(x, v) / self.energy(*self.start(lab)) - 1))


# ---- balls ----

class Heap:
    """programs/world/heap.scene, at rest."""
    made, h = problems.HEAP | {"side": 3.2}, 2.0 ** -10

    def __init__(self, quick):
        self.case, self.objects = cases.find("heap"), 90 if quick else 10000
        self.before, self.steps = 2048 if quick else self.case.before, 64 if quick else 256

    def start(self, lab):
        return at(lab, self.case, self.before)

    def error(self, lab, x):
        """Largest difference of a coordinate from where fp3 has the balls, as a share of the box."""
        return below(1e-3, self.case.name(lab.quick), abs(x - at(lab, self.case, self.before + self.steps)[0]).max() / self.made["side"])


def below(most, scene, error):
    """Whoever is farther off solves other equations."""
    if not error < most:
        raise ws.Failed(f"{scene}: an error of {error:.3g}, expected less than {most:g}")
    return float(error)


def of_fp3(lab, case):
    """The error of fp3 itself in a case; None: there is none to tell."""
    if case.label == "net":
        net = Net(lab.quick)
        return net.error(lab, at(lab, case, net.steps)[0])
    if case.label == "stars, 1024":
        stars = Stars(case.label, lab.quick)
        return stars.error(lab, *at(lab, case, stars.steps))
    return None
