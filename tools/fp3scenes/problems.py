"""The scenes of curves: forms of programs/world whose end is known, up to what time, and how far from it an engine is.

The numbers of engines without fp3's language stand here once, for all of them. Starts and truths are fp3's: its own start of the scene, and what
its laboratory computes in double from the equations (docs/truth.md), which shares no code with compiler and engines.
"""

import csv
import dataclasses
import re
import subprocess

import numpy as np
from fp3world import scene as ws


@dataclasses.dataclass
class Problem:
    """A form of a scene. An error is measured at its end."""
    name: str
    objects: int
    seconds: float
    size: float                 # of what an error is a share
    truth: tuple                # steps of 2^-k s from which the solution is halved, and within; or of a statistic its integrator, and k
    made: dict                  # numbers of the scene, for peers
    changes: tuple = ()
    axes: str = "xyz"
    what: str = "the root mean square of the distance of an object from where it should be"     # an error is of
    is_chaotic: bool = False    # rounding alone sends objects other ways
    is_chance: bool = False     # ... and changes what is measured

    def text(self, integrator=None, h=None, more=""):
        text = ws.text_of(self.name)
        for change in self.changes:
            text = ws.replace(text, *change)
        if integrator:
            text = ws.replace(text, r'integrator = "\w+"', f'integrator = "{integrator}"')
        if h:
            text = re.sub(r" h = [\d.]+;", "", text)
            text = ws.replace(text, r"set     = \{", f"set     = {{ h = {h!r};") if "    set     = {" in text else ws.add(text, f"set = {{ h = {h!r}; }};")
        return ws.add(text, more) if more else text

    def steps(self, h):
        return round(self.seconds / h)

    def error(self, truth, x):
        """Root mean square of the distance from the truth, as a share of the size."""
        return float(np.sqrt(((x - truth) ** 2).sum(1).mean()) / self.size)


class Front(Problem):
    """How far the water has come along the floor: truth is one number."""
    def error(self, truth, x):
        return float(abs(x[:, 0].max() - truth[:, 0].max()) / self.size)


class Height(Problem):
    """How high the balls are in the mean."""
    def error(self, truth, x):
        return float(abs(x[:, 1].mean() - truth[:, 1].mean()) / self.size)


# Springs of grids: columns, rows, distance, those that are held, 1/m, gravity, damping along springs and by the air, k of each kind of link.
CLOTH = {"columns": 20, "rows": 20, "apart": 0.05, "held": (0, 19), "w": 1000.0, "g": 9.81, "damp": 0.005, "air": 0.001, "k": {"structural": 100.0, "shear": 100.0, "bending": 10.0}}
NET = {"columns": 48, "rows": 48, "apart": 2.0 ** -7, "held": tuple(range(48)), "w": 81920.0, "g": 9.81, "damp": 0.0, "air": 0.0, "k": {"structural": 60.0, "shear": 60.0, "bending": 6.0}}
BALLS = {"radius": 0.05, "mass": 0.01, "stiff": 100.0, "damp": 0.2, "side": 1.0, "g": 9.81}
HEAP = BALLS | {"stiff": 1000.0, "damp": 1.0, "side": 1.0}
DAM = {"apart": 0.05, "wide": 0.065, "c": 20.0, "thick": 0.1}

PROBLEMS = [
    Problem("cloth", 400, 0.5, 1.0, (10, 1e-6), CLOTH),
    Problem("net", 2304, 2.0 ** -4, 0.375, (12, 1e-5), NET, ((r"count = \[128, 128\]", "count = [48, 48]"), (r'"0\.\.127"', '"0..47"'))),
    Problem("balls", 300, 0.25, 1.0, (10, 1e-3), BALLS),
    Problem("stars", 300, 1.5, 1.0, (4, 1e-6), {"soft": 0.1, "m": 0.00333}),
    Height("heap", 1000, 4.0, 1.0, ("heun", 10), HEAP,
           ((r"objects = 10000", "objects = 1000"), (r"to = \[3.15, 2.2, 3.15\]", "to = [0.95, 2.2, 0.95]"), ("side = 3.2", "side = 1.0")),
           what="the difference of the balls' mean height", is_chaotic=True, is_chance=True),
    Front("dam", 800, 1.0, 2.0, ("rk4", 11), DAM, axes="xy", what="the difference of how far the water has run along the floor", is_chaotic=True),
]


# Of this one tools/bodies.py knows the rest.
CHAIN = Problem("chain", 160, 2.0, 5.0, (), {}, what="the root mean square of the distance of the lowest tip from theory, over all frames")
QUICK = {"cloth": 2.0 ** -4, "stars": 0.5}      # in the quick form: these, and up to when


def find(name, is_quick=False):
    found = next(one for one in PROBLEMS if one.name == name)
    return dataclasses.replace(found, seconds=QUICK[name]) if is_quick else found


def ways(made):
    """From a mass to all that a spring joins it with: columns and rows to go, k, length."""
    for kind, k in made["k"].items():
        for x, y in ws.grid_ways((kind,), 2):
            for sign in (-1, 1):
                yield sign * x, sign * y, k, made["apart"] * (x * x + y * y) ** 0.5


# ---- starts and truths ----

def states(problem, fp3, folder, text, *options):
    """Columns of the last step in fp3's table of states, [object, axis]."""
    path, output = ws.put(folder, text, "truth"), folder / "truth.csv"
    done = subprocess.run([fp3, "compare", path, "--halvings", "0", "--states", output, *map(str, options)], capture_output=True, text=True)
    if done.returncode not in (0, 3) or not output.exists():
        raise ws.Failed(f"{problem.name}: {(done.stderr.strip() or 'fp3 compare wrote no states').splitlines()[-1]}")
    found = {}
    with open(output, encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["state"].startswith("x_")]
    output.unlink()
    last = rows[-1]["step"]
    for column in ("method", "solution"):
        values = {axis: [float(row[column] or "nan") for row in rows if row["step"] == last and row["state"] == f"x_{axis}"] for axis in problem.axes}
        found[column] = np.array(list(values.values())).T
    return found, done.stderr.strip()


def truth(problem, fp3, folder):
    """Positions at the end."""
    if isinstance(problem.truth[0], str):
        integrator, k = problem.truth
        h = 2.0 ** -k
        return states(problem, fp3, folder, problem.text(integrator, h), "--steps", problem.steps(h), "--work", 1)[0]["method"]
    k, within = problem.truth
    h = 2.0 ** -k
    found, why = states(problem, fp3, folder, problem.text(None, h), "--steps", problem.steps(h), "--within", within, "--work", 1e11)
    if not np.isfinite(found["solution"]).all():
        raise ws.Failed(f"{problem.name}: no truth at {problem.seconds:g} s: {why}")
    return found["solution"]


def start(problem, fp3, folder):
    """Positions and velocities."""
    words, names = ws.words_of(ws.call(fp3, ws.put(folder, problem.text(), "start"), "--engine", "fast", "--steps", 0, "--all"))
    columns = dict(zip(names, words.view(np.float32).T.astype(float)))
    return tuple(np.stack([columns[f"{name}_{axis}"] for axis in problem.axes], -1) for name in "xv")
