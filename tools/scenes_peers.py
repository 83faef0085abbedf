#!/usr/bin/env python3
"""Scenes of curves by one engine, told line by line. tools/scenes.py starts it for each engine.

    tools/scenes_peers.py list         who is installed for this Python
    tools/scenes_peers.py warp         reads a command in JSON from each line, and answers with a line

    {"do": "go", "scene": "cloth", "method": "leapfrog", "k": 10, "folder": DIR, "quick": false}     the whole scene with steps of 2^-10 s

DIR has SCENE.npz with start and truth, and room for files. An answer has the seconds of the run, its steps, and how far off its end is. One thread, and processor time. An answer with "error" says why it failed.
"""

import os
import pathlib
import sys

import worker
from fp3scenes import peers


class Worker:
    """Runs of one scene are kept, as another turn of each follows."""

    def __init__(self, name):
        self.module, self.scene, self.runs = peers.module(name), None, {}

    def go(self, scene, method, k, folder, quick):
        import numpy as np                                      # who only lists does not need it
        from fp3scenes import problems
        os.chdir(folder)                                        # some write what they warn of where they are
        if scene != self.scene:
            with np.load(pathlib.Path(folder) / f"{scene}.npz") as file:
                self.start, self.truth = (file["x"], file["v"]), file["truth"]
            self.scene, self.runs, self.problem = scene, {}, problems.find(scene, quick)
        run = self.runs.get((method, k))
        if run is None:
            run = self.runs[method, k] = self.module.SCENES[scene](self.problem, method, 2.0 ** -k, self.start, pathlib.Path(folder))
        seconds = run.go()
        found = self.problem.error(self.truth, run.x)
        return {"seconds": seconds, "steps": getattr(run, "steps", self.problem.steps(2.0 ** -k)), "off": found if found < 1 else None}


def main():
    return worker.serve(__doc__, peers.PEERS, peers.installed, Worker)


if __name__ == "__main__":
    sys.exit(main())
