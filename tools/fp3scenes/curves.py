"""Error against run time: scenes whose end is known, by fp3 and by others, each at several step lengths. A chain of rigid bodies is that of tools/bodies.py."""

import argparse
import concurrent.futures
import itertools
import math
import os
import pathlib
import sys

import bodies
import numpy as np
from fp3scenes import peers
from fp3scenes import problems
from fp3scenes.page import pages                                # noqa: F401  (tools/scenes.py asks for it)
from fp3world.scene import Failed

CHAIN, RODS = problems.CHAIN.name, ["fp3", "box2d", "rapier", "mujoco, Euler", "mujoco, RK4"]      # who steps the scene of bodies
SCENES = [*(problem.name for problem in problems.PROBLEMS), CHAIN]
TURNS, MOST = 7, 1.0                # of each row, until it has taken so many seconds
OTHER = 0.25                        # a peer's error, beside fp3's by the same method and step, is the same within this share
FLOOR = 1e-5                        # below it float32 decides


def engines(options):
    """Each in a process of its own."""
    pythons = {name: python for python in (options.peers, pathlib.Path(sys.executable)) for name in bodies.listed(python, "scenes_peers")}
    return {name: bodies.Engine(name, pythons[name], "scenes_peers") for name in peers.PEERS if name in pythons}


def prepare(options, scene):
    """Start and truth, for all."""
    problem = problems.find(scene, options.quick)
    folder = options.folder / f"truth_{scene}"
    folder.mkdir(exist_ok=True)
    x, v = problems.start(problem, options.fp3, folder)
    np.savez(options.folder / f"{scene}.npz", x=x, v=v, truth=problems.truth(problem, options.fp3, folder))


def turns(options, scene, made, failed):
    """Answers of each row, by engine, method and k: all make their turns one after another."""
    found = {(name, method, k): [] for name in made for method, many in peers.ways(name, options.quick).get(scene, {}).items() for k in many}
    for _, key in itertools.product(range(1 if options.quick else TURNS), list(found)):
        answers = found[key]
        if answers is None or sum(answer["seconds"] for answer in answers) > MOST:
            continue
        name, method, k = key
        try:
            answers.append(made[name].ask(do="go", scene=scene, method=method, k=k, folder=str(options.folder), quick=options.quick))
        except bodies.Failed as why:
            failed.append({"scene": scene, "engine": name, "method": method, "k": k, "failed": str(why)})
            found[key] = None
    return {key: answers for key, answers in found.items() if answers}


def chain(options, say):
    """Its rows in the form of these: a step is a substep."""
    lab = bodies.Lab(argparse.Namespace(peers=options.peers, engines=RODS, quick=False, scenes=[CHAIN], limit=bodies.LIMIT), say)
    try:
        for row in lab.error()["error"]:
            engine, _, method = row["engine"].partition(", ")
            yield {"scene": CHAIN, "engine": engine, "method": method or "substeps", "h": 1 / 60 / row["substeps"], "steps": 120 * row["substeps"], "objects": 160,
                   "error": row["error"] and row["error"] / problems.CHAIN.size, "ns_per_object_step": row["ns_per_body_step"] / row["substeps"]}
        yield from ({"scene": CHAIN, "engine": why.partition(":")[0], "failed": why} for why in lab.failed)
    finally:
        for engine in lab.engines.values():
            engine.end()


def measure(options, say):
    names = problems.QUICK if options.quick else [problem.name for problem in problems.PROBLEMS]
    scenes = [name for name in names if not options.scenes or name in options.scenes]
    made, rows = engines(options), []
    if "fp3" not in made:
        raise Failed("curves: no Python here has numpy, which fp3 needs: make setup")
    try:
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            for scene, _ in zip(scenes, pool.map(lambda scene: prepare(options, scene), scenes)):
                say(f"the truth of {scene}")
        for scene in scenes:
            problem = problems.find(scene, options.quick)
            for (name, method, k), answers in turns(options, scene, made, rows).items():
                steps = answers[0]["steps"] if method in peers.CHOSEN else problem.steps(2.0 ** -k)
                rows.append({"scene": scene, "engine": name, "method": method, "k": k, "h": problem.seconds / steps, "steps": steps, "objects": problem.objects,
                             "error": answers[0]["off"], "ns_per_object_step": 1e9 * min(answer["seconds"] for answer in answers) / (steps * problem.objects)})
            say(f"{scene}, {sum(row['scene'] == scene for row in rows)} rows")
    finally:
        for engine in made.values():
            engine.end()
    if not options.quick and (not options.scenes or CHAIN in options.scenes):
        rows += chain(options, say)
    return rows


# ---- what is wrong -----------------------------------------------------------------------------------

def name_of(row):
    return ", ".join([row["scene"], row["engine"], *([row["method"], f"2^-{row['k']} s"] if "k" in row else [])])


def wrong(rows):
    """Who steps as fp3 does has its error, or solves other equations; and a method of first order halves its error with its step."""
    yield from (f"{name_of(row)}: {row['failed']}" for row in rows if "failed" in row)
    own = {(row["scene"], row["method"], row["k"]): row["error"] for row in rows if row["engine"] == "fp3" and "error" in row and "k" in row}
    for scene in dict.fromkeys(row["scene"] for row in rows):
        if not any(row.get("error") for row in rows if (row["scene"], row["engine"]) == (scene, "fp3")):
            yield f"{scene}: fp3 never ends near the truth"
    for row in rows:
        error = row.get("error")
        if "k" not in row or problems.find(row["scene"]).is_chaotic or not error or error < FLOOR:
            continue
        ours = own.get((row["scene"], row["method"], row["k"]))
        if ours and not abs(error / ours - 1) < OTHER:
            yield f"{name_of(row)}: an error of {error:.3g}, and fp3 has {ours:.3g} by the same method"
        longer = own.get((row["scene"], row["method"], row["k"] - 1))
        if row["engine"] == "fp3" and row["method"] == peers.EULER and longer and not abs(math.log2(longer / error) - 1) < OTHER:
            yield f"{name_of(row)}: an error of {error:.3g}, and {longer:.3g} with twice the step: expected half"
