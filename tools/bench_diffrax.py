#!/usr/bin/env python3
"""Error against run time of diffrax (JAX, on the CPU), in float32 and float64. tools/bench.py starts it in .venv-bench/.

    tools/bench_diffrax.py PROBLEM.json OUTPUT.json       PROBLEM: of `bench points MODEL --problem`

All objects at once, by vmap and jit; compilation is not timed. States are divided by their scale, so that one tolerance is
relative to the size of each, as it is for the other solvers. Its implicit solvers are left out: a run of 1,024 objects takes minutes.
A run is of the variants alone, or of 256 copies of each.
"""

import concurrent.futures
import json
import math
import os
import statistics
import sys
import time

import jax

jax.config.update("jax_enable_x64", True)
jax.config.update("jax_platforms", "cpu")

import diffrax            # noqa: E402
import jax.numpy as jnp   # noqa: E402

COPIES = (1, 256)         # of each variant, in one run: 64 objects, and 16,384
REPEATS = 3
STEPS_MOST = 4096
SECONDS_MOST = 1.0        # a run that takes longer, or does not reach the end, is the last of its solver
SOLVERS = {"tsit5": diffrax.Tsit5, "dopri8": diffrax.Dopri8}
METHODS = {"float32": ["tsit5"], "float64": ["tsit5", "dopri8"]}          # compiling each takes seconds
TOLERANCES = {"float32": range(2, 8), "float64": range(2, 11)}            # many objects: every other one


def solver(problem, method, scale):
    names = {"jnp": jnp}
    exec(problem["equations"], names)

    def field(t, z, p):
        return jnp.stack([jnp.asarray(slope, z.dtype) for slope in names["slopes"](t, z * scale, p)]) / scale

    def one(p, y, tolerance):
        end = jnp.asarray(problem["span"], y.dtype)
        found = diffrax.diffeqsolve(diffrax.ODETerm(field), SOLVERS[method](), jnp.zeros_like(end), end, None, y / scale, p,
                                    saveat=diffrax.SaveAt(t1=True), max_steps=STEPS_MOST, throw=False,
                                    stepsize_controller=diffrax.PIDController(rtol=0.0, atol=tolerance))
        return found.ys[0] * scale, found.result == diffrax.RESULTS.successful
    return jax.jit(jax.vmap(one, (0, 0, None)))


def errors(problem, ends):
    """Of each variant, as bench/problem.c has it."""
    scale, found = problem["scale"][0], []
    for end, truth in zip(ends, problem["truth"]):
        terms = [((a - b) / s) ** 2 for a, b, s in zip(end, truth, scale) if s > 0]
        found.append(math.sqrt(sum(terms) / len(terms)))
    return found


def timed(run):
    begin = time.perf_counter()
    found = jax.block_until_ready(run())
    return found, time.perf_counter() - begin


class Sweep:
    """A solver on one number of objects, compiled: of fixed shapes, so that several are compiled at once."""

    def __init__(self, problem, method, dtype, copies):
        self.problem, self.method, self.dtype, self.copies = problem, method, dtype, copies
        scale = jnp.array([s or 1 for s in problem["scale"][0]], dtype)
        self.p, self.y = (jnp.tile(jnp.array(problem[name], dtype).reshape(len(problem["truth"]), -1), (copies, 1)) for name in ("params", "initial"))
        self.lowered = solver(problem, method, scale).lower(self.p, self.y, jnp.asarray(0.1, dtype))

    def compile(self):
        self.solve = self.lowered.compile()
        return self


def sweep(made, points, left_out):
    problem, method, dtype, copies, p, y, solve = made.problem, made.method, made.dtype, made.copies, made.p, made.y, made.solve
    about = {"model": problem["model"], "engine": "diffrax", "method": method, "integrator": None, "arithmetic": dtype, "config": None, "h": None}
    count = len(problem["truth"])
    for digits in TOLERANCES[dtype][::1 if copies == 1 else 2]:
        tolerance = jnp.asarray(10.0 ** -digits, dtype)
        (ends, is_good), first = timed(lambda: solve(p, y, tolerance))
        if digits == TOLERANCES[dtype][0]:
            (ends, is_good), first = timed(lambda: solve(p, y, tolerance))
        if not bool(is_good.all()) or first > SECONDS_MOST:
            why = f"{len(p)} objects: more than {STEPS_MOST} steps, or too small ones" if first <= SECONDS_MOST else f"{len(p)} objects: more than {SECONDS_MOST:g} s"
            left_out.append(about | {"tolerance": 10.0 ** -digits, "why": why})
            return
        seconds = [timed(lambda: solve(p, y, tolerance))[1] for _ in range(REPEATS if first < 0.1 else 1)]
        found = errors(problem, ends[:count].tolist())
        if not all(map(math.isfinite, found)) or statistics.median(found) >= 0.5:
            continue
        points.append(about | {"threads": os.cpu_count(), "objects": len(p), "steps": None, "tolerance": 10.0 ** -digits,
                               "error_median": statistics.median(found), "error_worst": max(found),
                               "ns_per_object": statistics.median(seconds) * 1e9 / len(p), "cycles": None, "repeats": len(seconds)})


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        problem = json.load(file)
    points, left_out = [], []
    print(f"{problem['model']}: diffrax, compiled", file=sys.stderr)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        compiled = list(pool.map(Sweep.compile, [Sweep(problem, method, dtype, copies) for dtype in TOLERANCES for method in METHODS[dtype] for copies in COPIES]))
    for made in compiled:
        print(f"{problem['model']}: diffrax, {made.method}, {made.dtype}, {len(made.p)} objects", file=sys.stderr)
        sweep(made, points, left_out)
    temporary = f"{sys.argv[2]}.{os.getpid()}"
    with open(temporary, "w", encoding="utf-8") as file:
        json.dump({"points": points, "left_out": left_out, "versions": {"diffrax": diffrax.__version__, "JAX": jax.__version__}}, file, indent=1)
    os.replace(temporary, sys.argv[2])


if __name__ == "__main__":
    main()
