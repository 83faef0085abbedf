"""Runs with a known path: how far an engine is from it, and what its steps cost.

A run is there sixteen times side by side, so that what a step costs beside its bodies counts less. The first one's error is measured.
"""

import dataclasses
import functools
import math
import time

import numpy as np
from fp3bodies import formulas
from fp3bodies.scene import Body, Pin, Scene, ground

G, COPIES = 10.0, 16
SUBSTEPS = (1, 2, 4, 8, 16, 32, 64)
HIGH, RESTITUTION = 5.0, 0.8
SPEED, FRICTION = 5.0, 0.5


@dataclasses.dataclass
class Run:
    bodies: list            # of one copy
    pins: list
    apart: float            # of copies, so that none reaches another
    seconds: float
    expected: object        # of the frames, the place of a point in each
    found: object           # of an engine, the place of that point


def hung(count, length):
    """Rods of 1 kg from the origin along x."""
    rods = [Body("box", (length / 2, 0.05 * length), (length * (k + 0.5), 0.0), mass=1.0, inertia=(length ** 2 / 12,)) for k in range(count)]
    return rods, [Pin(k - 1, k, (length * k, 0.0)) for k in range(count)]


@functools.lru_cache(maxsize=None)
def tips(count, length, frames, seconds):
    """Of the last rod, after each frame."""
    angles = formulas.rods((math.pi / 2,) * count, length, length ** 2 / 12, 1.0, G, seconds, 40 * frames)[40::40]
    return np.stack([length * np.sin(angles).sum(1), -length * np.cos(angles).sum(1)], 1)


def tip(count, length):
    def found(engine):
        turn = float(engine.turns()[count - 1])
        return engine.places()[count - 1] + length / 2 * np.array([math.cos(turn), math.sin(turn)])
    return found


def swings(count, length, seconds):
    bodies, pins = hung(count, length)
    return Run(bodies, pins, 2.5 * count * length, seconds, lambda frames: tips(count, length, frames, seconds), tip(count, length))


def bounces():
    floor, ball = ground(0.9, friction=0.0, restitution=RESTITUTION), Body("disc", (0.5,), (0.0, 0.5 + HIGH), friction=0.0, restitution=RESTITUTION)
    return Run([floor, ball], [], 2.0, 4.0,
               lambda frames: np.array([(0.0, 0.5 + formulas.bounced(HIGH, RESTITUTION, G, 4.0 * (k + 1) / frames)) for k in range(frames)]),
               lambda engine: engine.places()[1])


def slides():
    floor = Body("box", (3.0, 1.0), (1.5, -1.0), fixed=True, friction=FRICTION)
    return Run([floor, Body("box", (0.5, 0.25), (0.0, 0.25), v=(SPEED, 0.0), friction=FRICTION)], [], 7.0, 1.5,
               lambda frames: np.array([(formulas.braked(SPEED, FRICTION, G, 1.5 * (k + 1) / frames), 0.25) for k in range(frames)]),
               lambda engine: engine.places()[1])


RUNS = {"double pendulum": swings(2, 1.0, 3.0), "bounces": bounces(), "sliding block": slides(), "chain": swings(10, 0.5, 2.0)}
QUICK = ["sliding block", "bounces"]


def scene(name, substeps):
    """All its copies."""
    run, bodies, pins = RUNS[name], [], []
    for copy in range(COPIES):
        first, off = len(bodies), copy * run.apart
        bodies += [dataclasses.replace(body, at=(body.at[0] + off, body.at[1])) for body in run.bodies]
        pins += [Pin(pin.a + first if pin.a >= 0 else -1, pin.b + first, (pin.at[0] + off, pin.at[1])) for pin in run.pins]
    return Scene(name, bodies, pins, substeps=substeps)


def frames(name):
    return round(RUNS[name].seconds * 60)


def error(name, engine):
    """Root mean square of the distance from theory, over all frames."""
    found = []
    for _ in range(frames(name)):
        engine.step()
        found.append(RUNS[name].found(engine))
    return float(math.sqrt(((np.array(found) - RUNS[name].expected(len(found))) ** 2).sum(1).mean()))


def pace(name, engine):
    """Nanoseconds of processor time for a frame of a body that is loose, from the beginning to the end."""
    begin = time.process_time()
    engine.step(frames(name))
    return 1e9 * (time.process_time() - begin) / (frames(name) * int(engine.scene.loose().sum()))
