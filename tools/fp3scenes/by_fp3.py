"""Scenes by engine fast of FP3, one thread, float32: the Python package of this folder over the library of its build."""

import pathlib
import sys
import time

import numpy as np
from fp3scenes.problems import PROBLEMS
from fp3world import scene as ws

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "python"))

import fp3  # noqa: E402


class Run:
    """Opening the scene, which compiles it, is not in the time."""

    def __init__(self, problem, method, h, _, folder):
        integrator, _, arithmetic = method.partition(", ")
        self.problem, self.steps = problem, problem.steps(h)
        self.path = ws.put(folder, problem.text(integrator, h, f"{arithmetic} = true;" if arithmetic else ""), f"{problem.name}.by")

    def go(self):
        scene = fp3.Scene(self.path, engine="fast", threads=1)
        begin = time.process_time()
        scene.run(self.steps, check_failures=False)
        took = time.process_time() - begin
        self.x = np.stack([scene.groups[0][f"x_{axis}"] for axis in self.problem.axes], -1).astype(float)
        return took


SCENES = dict.fromkeys((problem.name for problem in PROBLEMS), Run)
