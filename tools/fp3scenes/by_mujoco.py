"""The net by MuJoCo: double, one thread. Bodies that slide along three axes, and flexes of dimension 1 as springs."""

import time

import mujoco
import numpy as np
from fp3world import scene as ws


class Net:
    def __init__(self, problem, method, h, start, _):
        made, self.problem, self.h = problem.made, problem, h
        slides = "".join(f'<joint type="slide" axis="{axis}"/>' for axis in ("1 0 0", "0 1 0", "0 0 1"))
        bodies = "".join(f'<body name="b{k}" pos="{x} {y} {z}"><inertial pos="0 0 0" mass="{1 / made["w"]!r}" diaginertia="1e-9 1e-9 1e-9"/>'
                         f'{"" if k in made["held"] else slides}</body>' for k, (x, y, z) in enumerate(start[0].tolist()))
        names, vertices, k = " ".join(f"b{k}" for k in range(len(start[0]))), "0 0 0 " * len(start[0]), np.arange(len(start[0]))

        def flex(stiffness, kinds):
            elements = ""
            for to, across in ws.grid_ways(kinds, 2):
                p, q = k % made["columns"] + to, k // made["columns"] + across
                inside = (p >= 0) & (p < made["columns"]) & (q < made["rows"])
                elements += "".join(f"{a} {b} " for a, b in zip(k[inside], (p + made["columns"] * q)[inside]))
            return (f'<flex dim="1" radius="0.001" body="{names}" vertex="{vertices}" element="{elements}"><edge stiffness="{stiffness}" damping="0"/>'
                    '<contact contype="0" conaffinity="0" selfcollide="none"/></flex>')
        flexes = "".join(flex(stiffness, [kind for kind, one in made["k"].items() if one == stiffness]) for stiffness in sorted(set(made["k"].values())))
        self.model = mujoco.MjModel.from_xml_string(
            f'<mujoco><option timestep="{h!r}" gravity="0 {-made["g"]} 0" integrator="{method}"><flag contact="disable" constraint="disable"/></option>'
            f"<worldbody>{bodies}</worldbody><deformable>{flexes}</deformable></mujoco>")

    def go(self):
        data = mujoco.MjData(self.model)
        begin = time.process_time()
        mujoco.mj_step(self.model, data, self.problem.steps(self.h))
        took = time.process_time() - begin
        mujoco.mj_kinematics(self.model, data)
        # Where it bursts, MuJoCo warns, and begins anew.
        self.x = data.xpos[1:] + (np.nan if any(warning.number for warning in data.warning) else 0)
        return took


SCENES = {"net": Net}
