#!/usr/bin/env python3
"""The scenes net and stars by others: Taichi and REBOUND, where they are installed. tools/world.py starts it.

    tools/world_peers.py OUTPUT.json [--quick]

One thread each. Taichi has the springs as a stencil, in float32; REBOUND has double precision. Compilation is not timed; the figure is
the shortest of several turns.
"""

import importlib.util
import json
import random
import sys
import time


def shortest(turn, steps, repeats):
    turn(1)
    found = []
    for _ in range(repeats):
        begin = time.process_time()
        turn(steps)
        found.append((time.process_time() - begin) / steps)
    return min(found)


def taichi_net(quick):
    """Of programs/world/net.scene: 12 springs at a mass, semi-implicit Euler."""
    import taichi as ti
    ti.init(arch=ti.cpu, cpu_max_num_threads=1, log_level=ti.ERROR, offline_cache=False)
    n, a, w, h = (32 if quick else 128), 0.0078125, 81920.0, 2.0 ** -12
    ways = [(x, y, 6.0 if max(abs(x), abs(y)) == 2 else 60.0) for y in range(-2, 3) for x in range(-2, 3) if 0 < x * x + y * y <= 2 or x * x + y * y == 4]
    x, v = (ti.Vector.field(3, ti.f32, shape=(n, n)) for _ in range(2))

    @ti.kernel
    def begin():
        for i, j in x:
            x[i, j] = ti.Vector([a * i, 1.0, a * j])

    @ti.kernel
    def kick():
        for i, j in x:
            force = ti.Vector([0.0, -9.81 / w, 0.0])
            for k in ti.static(range(len(ways))):
                p, q = i + ways[k][0], j + ways[k][1]
                if 0 <= p < n and 0 <= q < n:
                    way = x[p, q] - x[i, j]
                    force += ways[k][2] * (1 - a * ti.static((ways[k][0] ** 2 + ways[k][1] ** 2) ** 0.5) / way.norm()) * way
            if j > 0:
                v[i, j] += h * w * force

    @ti.kernel
    def drift():
        for i, j in x:
            x[i, j] += h * v[i, j]

    def turn(steps):
        for _ in range(steps):
            kick()
            drift()
        ti.sync()
    begin()
    seconds = shortest(turn, 5 if quick else 50, 3 if quick else 15)
    assert abs(x.to_numpy()[:, :, 1].max() - 1) < 1e-3  # the edge that is held
    yield {"scene": "net", "engine": "taichi", "objects": n * n, "ns_per_object_step": 1e9 * seconds / n ** 2}


def rebound_stars(quick):
    """Of programs/world/stars.scene: all pairs, leapfrog."""
    import rebound
    for n in (70,) if quick else (1024, 16384):
        simulation, place = rebound.Simulation(), random.Random(1)
        for _ in range(n):
            simulation.add(m=1 / n, x=place.uniform(-1, 1), y=place.uniform(-1, 1), z=place.uniform(-1, 1))
        simulation.integrator, simulation.gravity, simulation.softening, simulation.dt = "leapfrog", "basic", 0.1, 2.0 ** -10
        seconds = shortest(simulation.steps, 5 if quick else max(1, 10 ** 8 // n ** 2), 3)
        yield {"scene": f"stars, {n}", "engine": "rebound", "objects": n, "ns_per_object_step": 1e9 * seconds / n}


PEERS = {"taichi": taichi_net, "rebound": rebound_stars}


def main():
    rows = [row | {"variant": "", "threads": 1} for name, run in PEERS.items() if importlib.util.find_spec(name) for row in run("--quick" in sys.argv)]
    with open(sys.argv[1], "w", encoding="utf-8") as file:
        json.dump(rows, file)


if __name__ == "__main__":
    main()
