#!/usr/bin/env python3
"""Error against run time of heyoka.py, Taylor's method in float64. tools/bench.py starts it in .venv-bench/.

    tools/bench_heyoka.py PROBLEM.json OUTPUT.json       PROBLEM: of `bench points MODEL --problem`

One object after another (`taylor`), or as many at once as a vector of the processor has numbers (`taylor batch`), on one processor. Its code is
compiled once for each tolerance, which is not timed. States are divided by their scale, so that one tolerance is relative to the
size of each, as it is for the other solvers.
"""

import json
import math
import os
import statistics
import sys
import time

import heyoka as hy
import numpy as np

COPIES = 4                # of each variant, in one run: 256 objects
REPEATS = 9
STEPS_MOST = 4096
SECONDS_MOST = 1.0        # a run that takes longer, or does not reach the end, is the last of its method
DIGITS = range(2, 15)     # tolerances; beyond 10^-10, where others end, as its order grows with them
REACHED = hy.taylor_outcome.time_limit


class Functions:
    """What the equations call: those of jax.numpy, on heyoka's expressions."""
    sqrt, sin, cos, tan, exp, log, tanh, arcsin, arccos, arctan, arctan2 = hy.sqrt, hy.sin, hy.cos, hy.tan, hy.exp, hy.log, hy.tanh, hy.asin, hy.acos, hy.atan, hy.atan2

    @staticmethod
    def power(base, exponent):
        return base ** exponent


def system(problem, scale):
    """The equations of states divided by their scale."""
    names = {"jnp": Functions}
    exec(problem["equations"], names)
    states = [hy.make_vars(f"y{i}") for i in range(len(scale))]
    params = [hy.par[i] for i in range(len(problem["params"][0]))]
    slopes = names["slopes"](hy.time, [y * s for y, s in zip(states, scale)], params)
    return [(y, hy.expression(0.0) + slope / s) for y, slope, s in zip(states, slopes, scale)]


class Solver:
    """Of all objects of a run, `width` at once."""

    def __init__(self, equations, tolerance, width, params):
        self.width = width
        start, given = np.zeros((len(equations), width)), np.zeros((params, width))
        self.integrator = hy.taylor_adaptive_batch(equations, start, tol=tolerance, pars=given)

    def run(self, starts, params, end, ends):
        """Each a column for a state or a param and an object; False: one does not reach the end."""
        ta, width = self.integrator, self.width
        for i in range(0, starts.shape[1], width):
            ta.state[:], ta.pars[:] = starts[:, i:i + width], params[:, i:i + width]
            ta.set_time(0.0)
            ta.propagate_until(end, max_steps=STEPS_MOST)
            if any(one[0] != REACHED for one in ta.propagate_res):
                return False
            ends[:, i:i + width] = ta.state
        return True


def errors(problem, ends, scale):
    """Of each variant, as sw/lab/measure/problem.c has it."""
    found = []
    for end, truth in zip(ends.T * scale, problem["truth"]):
        terms = [((a - b) / s) ** 2 for a, b, s in zip(end, truth, problem["scale"][0]) if s > 0]
        found.append(math.sqrt(sum(terms) / len(terms)))
    return found


def timed(run):
    begin = time.perf_counter()
    is_good = run()
    return is_good, time.perf_counter() - begin


def sweep(problem, equations, scale, method, width, points, left_out):
    about = {"model": problem["model"], "engine": "heyoka", "method": method, "integrator": None, "arithmetic": "float64", "config": None, "h": None}
    count = len(problem["truth"])
    starts = np.tile((np.array(problem["initial"]) / scale).T, (1, COPIES))
    params = np.tile(np.array(problem["params"]).reshape(count, -1).T, (1, COPIES))
    ends = np.empty_like(starts)
    for digits in DIGITS:
        solver = Solver(equations, 10.0 ** -digits, width, len(params))
        is_good, first = timed(lambda: solver.run(starts, params, problem["span"], ends))
        if not is_good or first > SECONDS_MOST:
            why = f"more than {STEPS_MOST} steps, or a value without a number" if not is_good else f"{starts.shape[1]} objects: more than {SECONDS_MOST:g} s"
            left_out.append(about | {"tolerance": 10.0 ** -digits, "why": why})
            return
        seconds = [timed(lambda: solver.run(starts, params, problem["span"], ends))[1] for _ in range(REPEATS)]
        found = errors(problem, ends[:, :count], scale)
        if not all(map(math.isfinite, found)) or statistics.median(found) >= 0.5:
            continue
        points.append(about | {"threads": 1, "objects": starts.shape[1], "steps": None, "tolerance": 10.0 ** -digits,
                               "error_median": statistics.median(found), "error_worst": max(found),
                               "ns_per_object": statistics.median(seconds) * 1e9 / starts.shape[1], "cycles": None, "repeats": REPEATS})


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        problem = json.load(file)
    points, left_out = [], []
    scale = np.array([s or 1 for s in problem["scale"][0]])
    for method, width in (("taylor", 1), ("taylor batch", hy.recommended_simd_size())):
        print(f"{problem['model']}: heyoka, {method}", file=sys.stderr)
        try:
            sweep(problem, system(problem, scale), scale, method, width, points, left_out)
        except (AttributeError, TypeError, ValueError) as why:
            left_out.append({"model": problem["model"], "engine": "heyoka", "method": method, "integrator": None, "arithmetic": "float64", "config": None,
                             "h": None, "tolerance": None, "why": f"the equations are none that it takes: {why}"})
    temporary = f"{sys.argv[2]}.{os.getpid()}"
    with open(temporary, "w", encoding="utf-8") as file:
        json.dump({"points": points, "left_out": left_out, "versions": {"heyoka.py": hy.__version__}}, file, indent=1)
    os.replace(temporary, sys.argv[2])


if __name__ == "__main__":
    main()
