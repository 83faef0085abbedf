#!/usr/bin/env python3
"""Scenes of rigid bodies by one engine, told line by line. tools/bodies.py starts it for each engine.

    tools/bodies_peers.py list         who is installed for this Python
    tools/bodies_peers.py box2d        reads a command in JSON from each line, and answers with a line

    {"do": "truth", "test": "slope"}                 rows, and what is refused
    {"do": "stand", "scene": "pyramid 40", "seconds": 60, "most": 200}
    {"do": "make", "scene": "pyramid 40", "steps": 300, "most": 60}    a scene, settled; no longer than so many seconds
    {"do": "error", "run": "chain", "substeps": 4}   how far it is from theory
    {"do": "pace", "run": "chain", "substeps": 4}    what a step costs
    {"do": "turn", "steps": 10}                      seconds that so many steps of the last scene take

One thread, and processor time; of an engine with several threads the time of the wall. An answer with "refused" says what the engine has not, one with "error" that it failed.
"""

import sys
import time

import worker
from fp3bodies import engines
from fp3bodies import error
from fp3bodies import scene as sc
from fp3bodies import standing
from fp3bodies import truths


class Worker:
    def __init__(self, name):
        self.open, self.engine = engines.find(name), None

    def truth(self, test):
        rows, refused = truths.measure(next(truth for truth in truths.TRUTHS if truth.__name__ == test), self.open)
        return {"rows": rows, "refuses": refused}

    def stand(self, scene, seconds, most):
        made = standing.SCENES[scene][0]()
        return standing.stand(self.open(made), made, seconds, most)

    def now(self):
        """Processor time; of several threads together that of the wall."""
        return time.process_time() if self.open.THREADS == 1 else time.perf_counter()

    def make(self, scene, steps, most):
        scene = next(one for one in (make() for make in sc.FAST) if one.name == scene)
        self.engine = None  # two large ones at once would share the caches
        scene.substeps = scene.substeps if self.open.SUBSTEPS else 1
        self.engine = self.open(scene)
        begin, taken = self.now(), 0
        while taken < steps and self.now() - begin < most:
            self.engine.step(1)
            taken += 1
        return {"steps": taken, "substeps": scene.substeps, "seconds": self.now() - begin, "threads": self.open.THREADS,
                "bodies": int(scene.loose().sum()), "arithmetic": self.engine.ARITHMETIC, "note": self.engine.NOTE}

    def turn(self, steps):
        begin = self.now()
        self.engine.step(steps)
        return {"seconds": self.now() - begin}

    def error(self, run, substeps):
        return {"off": error.error(run, self.open(error.scene(run, substeps)))}

    def pace(self, run, substeps):
        return {"ns": error.pace(run, self.open(error.scene(run, substeps)))}


def main():
    return worker.serve(__doc__, engines.ENGINES, engines.installed, Worker, sc.Refused)


if __name__ == "__main__":
    sys.exit(main())
