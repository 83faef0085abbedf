"""What an engine must be able to do for the laboratory, and who does it."""

import importlib
import importlib.util

import numpy as np
from fp3bodies.scene import Refused, lifted

# Name: the module of this folder and its class, and the package that it needs beside NumPy.
ENGINES = {"fp3": ("by_fp3", "Made", None), "fp3, laws on fast": ("by_fp3", "ByEngine", None), "fp3, threads 2": ("by_fp3", "ByTwo", None), "box2d": ("by_box2d", "Made", "pyb2d3"), "own box2d": ("by_own_box2d", "Made", None),
           "own box3d": ("by_box3d", "Made", None),
           "chipmunk": ("by_chipmunk", "Made", "pymunk"), "rapier": ("by_rapier", "Made", "rapier3d"), "mujoco": ("by_mujoco", "Made", "mujoco"),
           "mujoco, RK4": ("by_mujoco", "RungeKutta", "mujoco"),
           "mujoco, Euler": ("by_mujoco", "Euler", "mujoco"), "mujoco, implicit": ("by_mujoco", "Implicit", "mujoco"),
           "bullet": ("by_bullet", "Made", "pybullet")}


class Engine:
    """One scene in one engine. Bodies are in the scene's order; arrays have the scene's dimensions."""
    ARITHMETIC = NOTE = ""
    THREADS = 1
    SUBSTEPS = False  # it has substeps of its own; if not, it takes steps as short as a scene's substeps, but a scene's steps where it is timed

    def __init__(self, scene):
        self.scene = scene
        self.build(scene)

    def build(self, scene):
        raise NotImplementedError

    def step(self, count=1):
        """So many steps of the scene."""
        raise NotImplementedError

    def places(self):
        raise NotImplementedError

    def turns(self):
        """An angle of each body, or w, x, y, z in space."""
        raise NotImplementedError

    def speeds(self):
        raise NotImplementedError

    def spins(self):
        raise NotImplementedError

    def push(self, body, force):
        """A force on the centre of a body, for the next step alone."""
        raise Refused("no force from outside in this adapter")

    def pulls(self):
        """How strong each pin pulls, N."""
        raise Refused("its joints do not tell their force")


class InSpace(Engine):
    """An engine that has only space: a scene in the plane is lifted, and what it says is put back."""

    def __init__(self, scene):
        self.scene, self.flat = scene, scene.dimensions == 2
        self.build(lifted(scene))

    def state(self):
        """Places, turns (w, x, y, z), speeds and spins of all bodies in space."""
        raise NotImplementedError

    def places(self):
        return self.state()[0][:, :self.scene.dimensions]

    def turns(self):
        q = self.state()[1]
        return 2 * np.arctan2(q[:, 3], q[:, 0]) if self.flat else q

    def speeds(self):
        return self.state()[2][:, :self.scene.dimensions]

    def spins(self):
        w = self.state()[3]
        return w[:, 2] if self.flat else w


def find(name):
    """Its class."""
    module, own, _ = ENGINES[name]
    return getattr(importlib.import_module(f"fp3bodies.{module}"), own)


def installed():
    from fp3bodies import by_box3d, by_own_box2d
    own = {"own box2d": by_own_box2d, "own box3d": by_box3d}
    return [name for name, (_, _, package) in ENGINES.items() if importlib.util.find_spec(package or "numpy") and (name not in own or own[name].is_there())]
