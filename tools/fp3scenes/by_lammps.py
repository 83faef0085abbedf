"""Balls by LAMMPS: gran/hooke in double by velocity Verlet, one thread. Nothing turns the balls, so that their damping is that of the scene;
a ball that touches two walls is damped by both, where the scene damps it once."""

import time

import numpy as np
from fp3world import granular


class Balls:
    def __init__(self, problem, _, h, start, __):
        self.problem, self.h, self.start = problem, h, start

    def go(self):
        made, (x, v) = self.problem.made, self.start
        forces, damp, side = f"{made['stiff']} 0", made["damp"] / made["mass"], made["side"]
        box = granular.lammps().lammps(cmdargs=["-log", "none", "-screen", "none"])
        box.commands_string(f"""units si
            atom_style sphere
            atom_modify map array
            boundary f f f
            comm_modify vel yes
            region box block 0 {side} 0 4 0 {side}
            create_box 1 box""")
        box.create_atoms(len(x), list(range(1, len(x) + 1)), [1] * len(x), x.ravel().tolist(), v.ravel().tolist())
        walls = "\n".join(f"fix {axis} all wall/gran hooke {forces} {damp} {damp} 10000 1 {axis}plane 0 {high}" for axis, high in (("x", side), ("y", "NULL"), ("z", side)))
        box.commands_string(f"""set group all diameter {2 * made['radius']}
            set group all mass {made['mass']}
            neighbor {0.4 * made['radius']} bin
            neigh_modify every 1 delay 0 check yes
            pair_style gran/hooke {forces} {2 * damp} {2 * damp} 10000 1
            pair_coeff * *
            timestep {self.h!r}
            fix gravity all gravity {made['g']} vector 0 -1 0
            {walls}
            fix steps all nve
            thermo 0
            thermo_modify lost ignore
            run 0 post no""")
        begin = time.process_time()
        box.command(f"run {self.problem.steps(self.h)} pre no post no")
        took = time.process_time() - begin
        count = int(box.get_natoms())
        self.x = np.full(x.shape, np.nan)                       # who left the box is nowhere: it bursts
        self.x[box.numpy.extract_atom("id")[:count] - 1] = box.numpy.extract_atom("x")[:count]
        box.close()
        return took


SCENES = {"balls": Balls, "heap": Balls}
