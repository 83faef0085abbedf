"""Scenes by Taichi: float32, one thread. All steps of a run are made within one kernel, so that no call from Python counts."""

import time

import numpy as np
import taichi as ti
from fp3scenes.problems import ways

ti.init(arch=ti.cpu, cpu_max_num_threads=1, log_level=ti.ERROR, offline_cache=False)


@ti.data_oriented
class Scene:
    def __init__(self, problem, _, h, start, __):
        self.problem, self.h, self.start, self.count = problem, h, start, len(start[0])
        self.position, self.v, self.force = (ti.Vector.field(3, ti.f32, shape=self.count) for _ in range(3))
        self.build(**problem.made)

    def go(self):
        for field, values in zip((self.position, self.v), self.start):
            field.from_numpy(values.astype("f4"))
        self.make(0)                                            # it is compiled now
        begin = time.process_time()
        self.make(self.problem.steps(self.h))
        ti.sync()
        took = time.process_time() - begin
        self.x = self.position.to_numpy().astype(float)
        return took


class Springs(Scene):
    """Semi-implicit Euler. Neighbours by a stencil."""

    def build(self, columns, rows, apart, held, w, g, damp, air, k):
        self.columns, self.rows, self.g, self.damp, self.air = columns, rows, g, damp, air
        self.ways = list(ways(self.problem.made))
        self.w = ti.field(ti.f32, shape=self.count)
        self.w.from_numpy(np.where(np.isin(np.arange(self.count), held), 0, w).astype("f4"))
        self.weight = g / w

    @ti.kernel
    def make(self, steps: int):
        ti.loop_config(serialize=True)
        for _ in range(steps):
            for k in range(self.count):
                i, j = k % self.columns, k // self.columns
                force = ti.Vector([0.0, -self.weight, 0.0]) - self.air * self.v[k]
                for n in ti.static(range(len(self.ways))):
                    p, q = i + self.ways[n][0], j + self.ways[n][1]
                    if 0 <= p < self.columns and 0 <= q < self.rows:
                        o = p + self.columns * q
                        way = self.position[o] - self.position[k]
                        force += self.ways[n][2] * (1 - self.ways[n][3] / way.norm()) * way
                        if ti.static(self.damp > 0):
                            force += self.damp * (self.v[o] - self.v[k])
                self.force[k] = self.w[k] * force
            for k in range(self.count):
                self.v[k] += self.h * self.force[k]
                self.position[k] += self.h * self.v[k]


class Stars(Scene):
    """Leapfrog, drift-kick-drift: all pairs."""

    def build(self, soft, m):
        self.soft_square, self.m = soft ** 2, m

    @ti.kernel
    def make(self, steps: int):
        ti.loop_config(serialize=True)
        for _ in range(steps):
            for k in range(self.count):
                self.position[k] += self.h / 2 * self.v[k]
            for k in range(self.count):
                total = ti.Vector([0.0, 0.0, 0.0])
                for o in range(self.count):
                    way = self.position[o] - self.position[k]
                    square = way.dot(way) + self.soft_square
                    total += way / (square * ti.sqrt(square))
                self.v[k] += self.h * self.m * total
            for k in range(self.count):
                self.position[k] += self.h / 2 * self.v[k]


SCENES = {"cloth": Springs, "net": Springs, "stars": Stars}
