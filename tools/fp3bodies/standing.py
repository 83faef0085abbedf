"""How scenes stand: what drifts, sags, overlaps and still moves, and what the floor carries."""

import dataclasses
import math
import time

import numpy as np
from fp3bodies import scene as sc


def heavy_on_light(ratio=1000.0):
    return sc.Scene(f"{ratio:g} kg on 1 kg", [sc.ground(5.0), sc.Body("box", (0.5, 0.5), (0.0, 0.5), mass=1.0),
                                               sc.Body("box", (0.5, 0.5), (0.0, 1.5), mass=ratio)])


def heavy_cube_on_light():
    made = sc.lifted(heavy_on_light())  # nothing keeps it in the plane
    wide = dataclasses.replace(made.bodies[0], size=(5.0, 1.0, 5.0))
    return dataclasses.replace(made, name=f"{made.name} in space", planar=False, bodies=[wide, *made.bodies[1:]])


# Name: the scene, and how many seconds it stands.
SCENES = {"pyramid 10": (lambda: sc.pyramid(10), 10), "pyramid 40": (lambda: sc.pyramid(40), 60), "pyramid 100": (lambda: sc.pyramid(100), 60),
          "10 stacks of 10": (sc.stacks, 60),
          "1000 kg on 1 kg": (heavy_on_light, 20), "1000 kg on 1 kg in space": (heavy_cube_on_light, 20), "wall of 1010 bricks": (sc.wall, 30),
          "pyramid 20 of cubes": (lambda: sc.pyramid_in_space(20), 30)}
QUICK = ["pyramid 10", "1000 kg on 1 kg"]


def near(x, reach):
    """Pairs of points nearer than that, by the cells of a grid."""
    cells = {}
    for k, cell in enumerate(map(tuple, np.floor(x / reach).astype(int))):
        cells.setdefault(cell, []).append(k)
    ways = [(1, 0), (1, 1), (0, 1), (-1, 1)]
    for cell, own in cells.items():
        for k, one in enumerate(own):
            for other in own[k + 1:] + [other for way in ways for other in cells.get((cell[0] + way[0], cell[1] + way[1]), [])]:
                yield one, other


def deepest(scene, x, angle):
    """The deepest overlap of two boxes in the plane, by their four axes; 0: there is none."""
    sizes = np.array([body.size if body.shape == "box" else (0.0, 0.0) for body in scene.bodies])
    boxes, loose = np.array([body.shape == "box" for body in scene.bodies]), scene.loose()
    own = np.flatnonzero(boxes & loose)
    pairs = [(own[a], own[b]) for a, b in near(x[own], 2 * np.hypot(*sizes[own].T).max())]
    pairs += [(held, one) for held in np.flatnonzero(boxes & ~loose) for one in own]
    a, b = np.array(pairs).T
    axes = np.stack([np.cos(angle), np.sin(angle)], 1)
    axes = np.stack([axes, np.stack([-axes[:, 1], axes[:, 0]], 1)], 1)  # [body, axis, x or y]
    gaps = []
    for of in (a, b):
        for axis in range(2):
            n = axes[of, axis]
            reach = sum((abs((axes[side] * n[:, None]).sum(2)) * sizes[side]).sum(1) for side in (a, b))
            gaps.append(abs(((x[b] - x[a]) * n).sum(1)) - reach)
    return float(max(0.0, -np.max(gaps, 0).min()))


def stand(engine, scene, seconds, most=math.inf):
    """After so long; refused if it takes more than so many seconds of processor time. What the floor carries is what changes the
    momentum: weight and its change within the last second."""
    loose, up = scene.loose(), 1
    begin = engine.places()
    masses = np.array([sc.mass(body, scene.dimensions)[0] for body in scene.bodies])[loose]
    second = round(1 / scene.step)
    start, steps = time.process_time(), (seconds - 1) * second
    for done in range(steps):
        engine.step()
        if time.process_time() - start > most:
            raise sc.Refused(f"slower than {most:g} s: {done + 1} of {steps} steps")

    def momentum():
        return float((masses * engine.speeds()[loose, up]).sum())
    before = momentum()
    engine.step(second)
    x, v, w = engine.places(), engine.speeds(), engine.spins()
    weight = masses.sum() * -scene.gravity[up]
    moved = (x - begin)[loose]
    return {"seconds": seconds, "bodies": int(loose.sum()), "drift": float(abs(np.delete(moved, up, 1)).max()), "sag": float(-moved[:, up].min()),
            "overlap": deepest(scene, x, engine.turns()) if scene.dimensions == 2 else None, "energy_per_body": sc.energy(scene, v, w) / int(loose.sum()),
            "floor_force": (weight + momentum() - before) / weight}
