"""Scenes by Warp: float32, one thread. Launches are recorded, and Python starts one after another: some microseconds each."""

import time

import numpy as np
import warp as wp
from fp3scenes.problems import ways


class Scene:
    """calls: the launches of a step, each a function."""

    def __init__(self, problem, _, h, start, folder):
        wp.config.kernel_cache_dir, wp.config.quiet = str(folder / "warp"), True     # not in the home of who runs it
        self.problem, self.h, self.count = problem, h, len(start[0])
        self.start = [np.pad(values, ((0, 0), (0, 3 - values.shape[1]))) for values in start]
        self.position, self.v = (wp.array(values, dtype=wp.vec3, device="cpu") for values in self.start)
        self.calls = self.build(**problem.made)

    def launch(self, kernel, *inputs):
        return wp.launch(kernel, dim=self.count, inputs=list(inputs), device="cpu", record_cmd=True).launch

    def go(self):
        self.reset()
        for call in self.calls:                                 # it is compiled now
            call()
        self.reset()
        begin = time.process_time()
        for _ in range(self.problem.steps(self.h)):
            for call in self.calls:
                call()
        took = time.process_time() - begin
        self.x, self.velocity = (array.numpy()[:, :len(self.problem.axes)].astype(float) for array in (self.position, self.v))
        return took

    def reset(self):
        for array, values in zip((self.position, self.v), self.start):
            array.assign(values)


@wp.kernel
def drift(x: wp.array(dtype=wp.vec3), v: wp.array(dtype=wp.vec3), h: float):
    k = wp.tid()
    x[k] += h * v[k]


@wp.kernel
def kick_and_drift(x: wp.array(dtype=wp.vec3), v: wp.array(dtype=wp.vec3), a: wp.array(dtype=wp.vec3), h: float):
    k = wp.tid()
    v[k] += h * a[k]
    x[k] += h * v[k]


class Springs(Scene):
    """Semi-implicit Euler. Neighbours by a stencil, whose loop is unrolled."""

    def build(self, columns, rows, apart, held, w, g, damp, air, k):
        along = list(ways(self.problem.made))
        tables = [wp.types.vector(len(along), kind)([way[n] for way in along]) for n, kind in enumerate((int, int, float, float))]
        to, across, stiffness, rest = map(wp.constant, tables)
        count, weight, columns, rows, damp, air = wp.constant(len(along)), wp.constant(g / w), wp.constant(columns), wp.constant(rows), wp.constant(damp), wp.constant(air)

        @wp.kernel(module="unique")
        def force(x: wp.array(dtype=wp.vec3), v: wp.array(dtype=wp.vec3), a: wp.array(dtype=wp.vec3), w: wp.array(dtype=float)):
            k = wp.tid()
            i, j = k % columns, k // columns
            total = wp.vec3(0.0, -weight, 0.0) - air * v[k]
            for n in range(count):
                p, q = i + to[n], j + across[n]
                if p >= 0 and p < columns and q >= 0 and q < rows:
                    o = p + columns * q
                    way = x[o] - x[k]
                    total += (stiffness[n] * (1.0 - rest[n] / wp.length(way))) * way + damp * (v[o] - v[k])
            a[k] = w[k] * total
        self.a = wp.zeros(self.count, dtype=wp.vec3, device="cpu")
        self.w = wp.array(np.where(np.isin(np.arange(self.count), held), 0, w), dtype=float, device="cpu")
        return [self.launch(force, self.position, self.v, self.a, self.w), self.launch(kick_and_drift, self.position, self.v, self.a, self.h)]


@wp.kernel
def attract(x: wp.array(dtype=wp.vec3), v: wp.array(dtype=wp.vec3), hm: float, soft_square: float, objects: int):
    k = wp.tid()
    total = wp.vec3(0.0, 0.0, 0.0)
    for o in range(objects):
        way = x[o] - x[k]
        square = wp.dot(way, way) + soft_square
        total += (1.0 / (square * wp.sqrt(square))) * way
    v[k] += hm * total


class Stars(Scene):
    """Leapfrog, drift-kick-drift: all pairs."""

    def build(self, soft, m):
        half = self.launch(drift, self.position, self.v, self.h / 2)
        return [half, self.launch(attract, self.position, self.v, self.h * m, soft ** 2, self.count), half]


@wp.kernel
def push(grid: wp.uint64, x: wp.array(dtype=wp.vec3), v: wp.array(dtype=wp.vec3), a: wp.array(dtype=wp.vec3), radius: float, m: float, stiff: float, damp: float,
         side: float, g: float):
    k = wp.tid()
    p = x[k]
    total = wp.vec3(0.0, 0.0, 0.0)
    for o in wp.hash_grid_query(grid, p, 2.0 * radius):
        way = x[o] - p
        d = wp.length(way)
        if o != k and d < 2.0 * radius:
            total += (stiff * (d - 2.0 * radius) / d) * way + damp * (v[o] - v[k])
    low = wp.vec3(wp.max(0.0, radius - p[0]), wp.max(0.0, radius - p[1]), wp.max(0.0, radius - p[2]))
    high = wp.vec3(wp.max(0.0, p[0] + radius - side), 0.0, wp.max(0.0, p[2] + radius - side))
    total += stiff * (low - high)
    if low[0] + low[1] + low[2] + high[0] + high[2] > 0.0:
        total -= damp * v[k]
    a[k] = total / m - wp.vec3(0.0, g, 0.0)


class Balls(Scene):
    """Semi-implicit Euler. Neighbours by a grid, which each step fills again."""

    def build(self, radius, mass, stiff, damp, side, g):
        self.a, self.grid = wp.zeros(self.count, dtype=wp.vec3, device="cpu"), wp.HashGrid(16, 32, 16, device="cpu")
        self.grid.build(self.position, 2 * radius)
        return [lambda: self.grid.build(self.position, 2 * radius),
                self.launch(push, self.grid.id, self.position, self.v, self.a, radius, mass, stiff, damp, side, g),
                self.launch(kick_and_drift, self.position, self.v, self.a, self.h)]


@wp.kernel
def flow(grid: wp.uint64, x: wp.array(dtype=wp.vec3), v: wp.array(dtype=wp.vec3), rho: wp.array(dtype=float), a: wp.array(dtype=wp.vec3), more: wp.array(dtype=float),
         apart: float, wide: float, c: float, thick: float):
    k = wp.tid()
    p, m = x[k], apart * apart
    steep = 35.0 / (4.0 * 3.14159265 * wide ** 4.0)
    own = c * c * (rho[k] - 1.0) / (rho[k] * rho[k])
    total, change = wp.vec3(0.0, 0.0, 0.0), float(0.0)
    for o in wp.hash_grid_query(grid, p, 2.0 * wide):
        way = x[o] - p
        d = wp.length(way)
        if o != k and d < 2.0 * wide:
            q = 1.0 - d / (2.0 * wide)
            share = m * steep * q * q * q
            meet = wp.dot(v[o] - v[k], way)
            change -= share * meet
            there = c * c * (rho[o] - 1.0) / (rho[o] * rho[o])
            total -= (share * (own + there - thick * c * wide * wp.min(0.0, meet) / (d * d + 0.01 * wide * wide))) * way
    stiff = (c / apart) * (c / apart)
    total += stiff * wp.vec3(wp.max(0.0, 0.5 * apart - p[0]), wp.max(0.0, 0.5 * apart - p[1]), 0.0)
    a[k] = total + wp.vec3(0.0, -1.0, 0.0)
    more[k] = change


@wp.kernel
def guess(x: wp.array(dtype=wp.vec3), v: wp.array(dtype=wp.vec3), rho: wp.array(dtype=float), a: wp.array(dtype=wp.vec3), more: wp.array(dtype=float),
          to_x: wp.array(dtype=wp.vec3), to_v: wp.array(dtype=wp.vec3), to_rho: wp.array(dtype=float), h: float):
    k = wp.tid()
    to_x[k] = x[k] + h * v[k]
    to_v[k] = v[k] + h * a[k]
    to_rho[k] = rho[k] + h * more[k]


@wp.kernel
def mean(x: wp.array(dtype=wp.vec3), v: wp.array(dtype=wp.vec3), rho: wp.array(dtype=float), a: wp.array(dtype=wp.vec3), more: wp.array(dtype=float),
         guess_v: wp.array(dtype=wp.vec3), guess_a: wp.array(dtype=wp.vec3), guess_more: wp.array(dtype=float), h: float):
    k = wp.tid()
    x[k] += (h / 2.0) * (v[k] + guess_v[k])
    v[k] += (h / 2.0) * (a[k] + guess_a[k])
    rho[k] += (h / 2.0) * (more[k] + guess_more[k])


class Dam(Scene):
    """Heun's method. Neighbours by a grid, which each of both evaluations fills again."""

    def build(self, **made):
        def room(kind):
            return wp.zeros(self.count, dtype=kind, device="cpu")
        self.grid, reach = wp.HashGrid(32, 32, 1, device="cpu"), 2 * made["wide"]
        self.rho, *first = room(float), room(wp.vec3), room(float)
        guessed, second = [room(wp.vec3), room(wp.vec3), room(float)], [room(wp.vec3), room(float)]
        here = [self.position, self.v, self.rho]
        self.grid.build(self.position, reach)
        numbers = [made[name] for name in ("apart", "wide", "c", "thick")]
        self.kept = first, second, guessed                      # launches do not own their arrays
        return [lambda: self.grid.build(self.position, reach), self.launch(flow, self.grid.id, *here, *first, *numbers),
                self.launch(guess, *here, *first, *guessed, self.h),
                lambda: self.grid.build(guessed[0], reach), self.launch(flow, self.grid.id, *guessed, *second, *numbers),
                self.launch(mean, *here, *first, guessed[1], *second, self.h)]

    def reset(self):
        super().reset()
        self.rho.fill_(1.0)


SCENES = {"cloth": Springs, "net": Springs, "stars": Stars, "balls": Balls, "heap": Balls, "dam": Dam}
