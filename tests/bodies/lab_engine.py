"""Stands for a Python that has one engine of rigid bodies, for tests/bodies/test_lab.py: nothing touches anything there, and pins do not hold."""

import pathlib
import sys
import time

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))

import bodies_peers  # noqa: E402
from fp3bodies import engines  # noqa: E402
from fp3bodies.scene import Refused  # noqa: E402


class Falls(engines.Engine):
    ARITHMETIC, NOTE, SUBSTEPS = "double", "a test's", True

    def build(self, scene):
        if scene.dimensions != 2:
            raise Refused("it has no space")
        self.x = np.array([body.at for body in scene.bodies], dtype=float)
        self.v = np.array([body.v or (0.0, 0.0) for body in scene.bodies], dtype=float)

    def step(self, count=1):
        for _ in range(count):
            self.v += self.scene.loose()[:, None] * np.array(self.scene.gravity) * self.scene.step
            self.x += self.v * self.scene.step

    def places(self):
        return self.x.copy()

    def speeds(self):
        return self.v.copy()

    def turns(self):
        return np.array([body.angle for body in self.scene.bodies])

    def spins(self):
        return np.zeros(len(self.x))


class Fails(Falls):
    def step(self, count=1):
        raise ValueError("it fails")


class Hangs(Falls):
    def step(self, count=1):
        time.sleep(1000)


engines.ENGINES = {"falls": ("falls", "Falls", "numpy"), "fails": ("fails", "Fails", "numpy"), "hangs": ("hangs", "Hangs", "numpy")}
engines.find = lambda name: {"falls": Falls, "fails": Fails, "hangs": Hangs}[name]
sys.exit(bodies_peers.main())
