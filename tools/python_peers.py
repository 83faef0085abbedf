#!/usr/bin/env python3
"""The same ensemble from Python by fp3, SciPy, diffrax and heyoka.py, at equal error: a table.

    .venv-bench/bin/python tools/python_peers.py [--objects 16384] [--errors 1e-3,1e-4] [--json FILE]

What is not installed is left out and named. The ensemble: planets of programs/kepler.ode, the speed at the pericentre from
1.6 to 1.8, to t = 12.5. The truth is Kepler's equation. The error of an object is the distance of its four states from the truth,
relative to their sizes, as a root mean square; that of a run is the median. Each tool takes the loosest of its tolerances, or the
longest of its steps, that keeps the error. A time is that of the call, with the compiled code there already: the shortest of
turns in which all tools take part one after the other, as other load then meets all.
"""

import argparse
import importlib.util
import json
import math
import os
import pathlib
import sys
import time

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "python"))
SPAN, NEAR = 12.5, 0.5
SPEEDS = (1.6, 1.8)
FEW = 64                # objects of what takes one after the other; its time is that of an object, times the objects
TURNS = 5


def truth(speeds):
    """By Kepler's equation, in double."""
    a = 1 / (2 / NEAR - speeds**2)
    e = 1 - NEAR / a
    mean = SPAN / a**1.5
    anomaly = mean + e * np.sin(mean)
    for _ in range(60):
        anomaly -= (anomaly - e * np.sin(anomaly) - mean) / (1 - e * np.cos(anomaly))
    rate, side = 1 / (a**1.5 * (1 - e * np.cos(anomaly))), np.sqrt(1 - e * e)
    return np.stack([-a * np.sin(anomaly) * rate, a * side * np.cos(anomaly) * rate, a * (np.cos(anomaly) - e), a * side * np.sin(anomaly)], axis=1)


def error_of(ends, speeds):
    """Median over the objects. The sizes are those at the pericentre: the largest speed, and the largest distance."""
    a = 1 / (2 / NEAR - speeds**2)
    scale = np.stack([speeds, speeds, 2 * a - NEAR, 2 * a - NEAR], axis=1)
    return float(np.median(np.sqrt(np.mean(((ends - truth(speeds)) / scale) ** 2, axis=1))))


def starts(speeds):
    return np.stack([np.zeros_like(speeds), speeds, np.full_like(speeds, NEAR), np.zeros_like(speeds)], axis=1)


# ---- the tools: each yields (name, settings, run(setting, speeds) -> ends, how many objects it gets) ----


def by_fp3(objects):
    import fp3
    model = fp3.Model(ROOT / "programs/kepler.ode")

    def fixed(method, arithmetic):
        return lambda steps, speeds: fp3.solve_ivp(model, (0, SPAN), starts(speeds), h=SPAN / steps, method=method, arithmetic=arithmetic,
                                                   cut=False).y[:, :, -1]
    for method in ("rk4", "rk6", "rk8"):
        for arithmetic in ("plain", "compensated"):
            yield f"fp3, {method}, {arithmetic}", [round(50 * 2 ** (k / 4)) for k in range(28)], fixed(method, arithmetic), objects
    for arithmetic in ("plain", "compensated"):
        yield (f"fp3, cash_karp adaptive, {arithmetic}", [10 ** -(k / 2) for k in range(4, 15)],
               lambda rtol, speeds, arithmetic=arithmetic: fp3.solve_ivp(model, (0, SPAN), starts(speeds), rtol=rtol, arithmetic=arithmetic).y[:, :, -1], objects)


def by_scipy(objects):
    from scipy.integrate import solve_ivp

    def slopes(t, y):
        cube = math.hypot(y[2], y[3]) ** 3
        return (-y[2] / cube, -y[3] / cube, y[0], y[1])

    def alone(method):
        return lambda rtol, speeds: np.array([solve_ivp(slopes, (0, SPAN), y0, method=method, rtol=rtol, atol=rtol).y[:, -1] for y0 in starts(speeds)])

    def together(rtol, speeds):
        def all_slopes(t, y):
            v, r = y.reshape(2, 2, -1)
            return np.concatenate([(-r / np.hypot(*r) ** 3).ravel(), v.ravel()])
        return solve_ivp(all_slopes, (0, SPAN), starts(speeds).T.ravel(), method="DOP853", rtol=rtol, atol=rtol).y[:, -1].reshape(4, -1).T
    settings = [10 ** -(k / 2) for k in range(4, 20)]
    for method in ("RK45", "DOP853"):
        yield f"SciPy, {method}, one by one", settings, alone(method), FEW
    yield "SciPy, DOP853, all as one system", settings, together, min(objects, 2048)


def by_diffrax(objects):
    import jax
    jax.config.update("jax_enable_x64", True)
    jax.config.update("jax_platforms", "cpu")
    import diffrax
    import jax.numpy as jnp

    def field(t, y, args):
        cube = (y[2] * y[2] + y[3] * y[3]) ** 1.5
        return jnp.stack([-y[2] / cube, -y[3] / cube, y[0], y[1]])

    def solver(method, dtype):
        def one(y, tolerance):
            end = jnp.asarray(SPAN, dtype)
            return diffrax.diffeqsolve(diffrax.ODETerm(field), method(), jnp.zeros_like(end), end, None, y, saveat=diffrax.SaveAt(t1=True), max_steps=4096,
                                       stepsize_controller=diffrax.PIDController(rtol=tolerance, atol=tolerance)).ys[0]
        solve = jax.jit(jax.vmap(one, (0, None)))
        return lambda rtol, speeds: np.asarray(solve(jnp.asarray(starts(speeds), dtype), jnp.asarray(rtol, dtype)), np.float64)
    for name, method in (("tsit5", diffrax.Tsit5), ("dopri8", diffrax.Dopri8)):
        for dtype in ("float32", "float64"):
            yield f"diffrax, {name}, {dtype}", [10 ** -(k / 2) for k in range(4, 13 if dtype == "float32" else 20)], solver(method, dtype), objects


def by_heyoka(objects):
    import heyoka as hy
    vx, vy, rx, ry = hy.make_vars("vx", "vy", "rx", "ry")
    cube = (rx * rx + ry * ry) ** 1.5
    equations = [(vx, -rx / cube), (vy, -ry / cube), (rx, vx), (ry, vy)]
    width = hy.recommended_simd_size()
    made = {}

    def run(rtol, speeds):
        if rtol not in made:
            made[rtol] = hy.taylor_adaptive_batch(equations, np.zeros((4, width)), tol=rtol)
        ta, columns = made[rtol], starts(speeds).T
        ends = np.empty_like(columns)
        for i in range(0, columns.shape[1], width):
            ta.state[:] = columns[:, i:i + width]
            ta.set_time(0.0)
            ta.propagate_until(SPAN)
            ends[:, i:i + width] = ta.state
        return ends.T
    yield f"heyoka.py, Taylor, float64, {width} at once", [10 ** -(k / 2) for k in range(4, 20)], run, objects


PACKAGES = {"fp3": by_fp3, "scipy": by_scipy, "diffrax": by_diffrax, "heyoka": by_heyoka}


# ---- measuring ----


def timed(run, setting, speeds):
    begin = time.perf_counter()
    ends = run(setting, speeds)
    return ends, time.perf_counter() - begin


def loosest(name, settings, run, count, most):
    """The first setting that keeps the error, or None."""
    speeds = np.linspace(*SPEEDS, count)
    for setting in settings:
        try:
            ends, _ = timed(run, setting, speeds)
        except Exception as why:  # a tool's own refusal: this setting is not for it
            print(f"{name}, {setting:.3g}: {type(why).__name__}", file=sys.stderr)
            continue
        if error_of(ends, speeds) <= most:
            return setting
    return None


def measure(tools, most):
    chosen = [(name, setting, run, np.linspace(*SPEEDS, count)) for name, settings, run, count in tools
              if (setting := loosest(name, settings, run, min(count, 1024), most)) is not None]
    best = {}
    for _ in range(TURNS):
        for name, setting, run, speeds in chosen:
            ends, seconds = timed(run, setting, speeds)
            if name not in best or seconds < best[name]["seconds"]:
                best[name] = {"tool": name, "setting": setting, "objects": len(speeds), "error": error_of(ends, speeds), "seconds": seconds}
    rows = sorted(best.values(), key=lambda row: row["seconds"] / row["objects"])
    ours = min((row["seconds"] / row["objects"] for row in rows if row["tool"].startswith("fp3")), default=math.nan)
    return [row | {"asked": most, "us_per_object": row["seconds"] / row["objects"] * 1e6, "ratio": row["seconds"] / row["objects"] / ours} for row in rows]


def markdown(rows):
    yield "| error at most | tool | setting | objects at once | error | us per object | times the fastest of fp3 |"
    yield "|---|---|---|---|---|---|---|"
    for row in rows:
        setting = f"{row['setting']} steps" if isinstance(row["setting"], int) else f"rtol {row['setting']:.1e}"
        yield f"| {row['asked']:g} | {row['tool']} | {setting} | {row['objects']:,} | {row['error']:.1e} | {row['us_per_object']:,.2f} | {row['ratio']:,.1f} |"


def main():
    parser = argparse.ArgumentParser(description="an ensemble from Python by fp3 and others, at equal error")
    parser.add_argument("--objects", type=int, default=16384)
    parser.add_argument("--errors", default="1e-3,1e-4", help="largest errors, with commas between them")
    parser.add_argument("--tools", default=",".join(PACKAGES), help="packages, with commas between them")
    parser.add_argument("--json", type=pathlib.Path, help="also write the rows to this file")
    args = parser.parse_args()
    tools = []
    for name in args.tools.split(","):
        if name not in PACKAGES:
            parser.error(f"--tools: found '{name}', expected {', '.join(PACKAGES)}")
        if name != "fp3" and importlib.util.find_spec(name) is None:
            print(f"python_peers.py: without {name}, which is not installed (make setup-bench)", file=sys.stderr)
            continue
        tools += PACKAGES[name](args.objects)
    rows = [row for most in args.errors.split(",") for row in measure(tools, float(most))]
    if args.json:
        temporary = args.json.with_name(f"{args.json.name}.{os.getpid()}")
        temporary.write_text(json.dumps(rows, indent=1))
        temporary.replace(args.json)
    print("\n".join(markdown(rows)))


if __name__ == "__main__":
    main()
