"""Scenes of programs/world by others, in the forms of truth.py: by the kernels and calls of tools/fp3scenes/by_*.py. Bullet and Box2D are here alone.

Each is a function of a lab that yields rows.
"""

import dataclasses
import importlib
import subprocess

import numpy as np
from fp3scenes import problems
from world_peers import row, shortest
from fp3world.scene import Failed
from fp3world.truth import Heap
from fp3world.truth import Net
from fp3world.truth import Stars

METHODS = {"mujoco": "Euler", "rebound": "leapfrog"}     # of those that have several
TURNS, MOST = 5, 5.0                # of a run, until it has taken so many seconds


def measured(lab, name, form, start, steps, error):
    """A row; error: of the run when it has ended."""
    problem = dataclasses.replace(problems.find(form.case.scene), objects=form.objects, seconds=steps * form.h, made=form.made)
    run = importlib.import_module(f"fp3scenes.by_{name}").SCENES[problem.name](problem, METHODS.get(name), form.h, start, lab.folder)
    took = [run.go()]
    found = error(run)
    while len(took) < TURNS and sum(took) < MOST and not lab.quick:
        took.append(run.go())
    return row(form.case.name(lab.quick), form.objects, min(took) / steps, found)


def net(lab, name):
    of = Net(lab.quick)
    x = of.start()

    def error(run):
        of.check(run.x)
        return of.error(lab, run.x)
    yield measured(lab, name, of, (x, np.zeros_like(x)), of.steps, error)


def stars(lab, name):
    """Of the larger form a step takes too long for as many as an energy needs."""
    for label in ("stars, 1024",) if lab.quick else ("stars, 1024", "stars, 16384"):
        of = Stars(label, lab.quick)
        is_long = label == "stars, 1024"

        def error(run):
            return of.error(lab, run.x, run.velocity) if is_long else None  # pylint: disable=cell-var-from-loop
        yield measured(lab, name, of, of.start(lab), of.steps if is_long else 1, error)


def heap(lab, name):
    """From where fp3 has the balls at rest."""
    of = Heap(lab.quick)
    yield measured(lab, name, of, of.start(lab), of.steps, lambda run: of.error(lab, run.x))


def bullet(lab):
    """float32, by bench/world/bullet.cpp: springs as in fp3; and another model, threads that each step makes as long as they were, in one pass."""
    of = Net(lab.quick)
    steps, repeats = (5, 3) if lab.quick else (10, 5)
    for kind, variant in (("springs", ""), ("threads", "another model: threads of the same number")):
        done = subprocess.run(list(map(str, [lab.bullet, kind, of.columns, of.rows, of.steps, steps, repeats])), capture_output=True, text=True)
        if done.returncode:
            raise Failed(done.stderr.strip() or f"exit code {done.returncode}")
        numbers = np.array(done.stdout.split(), float)
        if len(numbers) != 6 * of.objects + 1:
            raise Failed(f"{len(numbers)} numbers, expected {6 * of.objects + 1}")
        found, later = numbers[:-1].reshape(2, -1, 3)
        error = of.error(lab, found) if kind == "springs" else None
        if not of.difference(lab, found) < 0.05:
            raise Failed(f"{kind}: {of.difference(lab, found):.3g} of its length from where the net is, expected less than 0.05")
        of.check(later)
        yield row(of.case.name(lab.quick), of.objects, float(numbers[-1]), error, variant)


def box2d(lab):
    """float32, in two dimensions: another scene. Circles without friction, 31 deep, in a box; contacts are solved as constraints."""
    import pyb2d3 as b2
    count, wide = (90, 10) if lab.quick else (10000, 321)
    radius, side = Heap.made["radius"], 2 * Heap.made["radius"] * wide
    smooth = {"friction": 0.0, "restitution": 0.0}
    world, bodies, place = b2.World(gravity=(0, -Heap.made["g"])), b2.Bodies(), np.random.default_rng(1)
    world.sleeping_enabled = False
    for ends in (((0, 0), (side, 0)), ((0, 0), (0, side)), ((side, 0), (side, side))):
        world.create_static_body().create_shape(b2.shape_def(material=b2.surface_material(**smooth)), b2.segment(*ends))
    for k in range(count):
        x, y = k % (wide - 1), k // (wide - 1)
        ball = world.body_factory().dynamic().position((2 * radius * (x + 0.55) + radius * (y % 2) * 0.4 + place.uniform(0, radius / 4), 2 * radius * (1.01 * y + 0.5)))
        bodies.append(ball.add_circle(center=(0, 0), radius=radius).surface_material(**smooth).create().id)

    def turn(steps):
        for _ in range(steps):
            world.step(1 / 60, 4)
    turn(300 if lab.quick else 900)
    fastest, lowest = abs(bodies.get_linear_velocities()).max(), bodies.get_positions().min()
    if not (fastest < 0.1 and lowest > 0.8 * radius):
        raise Failed(f"not at rest: a speed of {fastest:.3g} m/s, a ball {lowest:.3g} m from the box")
    yield row("heap, 2D" + ", small" * lab.quick, count, shortest(turn, *((5, 3) if lab.quick else (20, 9))), None, "1/60 s in 4 substeps")


def rows(lab, name, scene):
    own = {("bullet", "net"): bullet, ("box2d", "heap"): box2d}.get((name, scene))
    return own(lab) if own else {"net": net, "stars": stars, "heap": heap}[scene](lab, name)
