"""What it costs to divide objects: the exchange on one node and between two, shares, memory, and a model of a step's time."""

import json
import os
import subprocess
import sys
import time

import bench
from fp3cluster import model as cluster_model
from fp3cluster.lab import Failed, environment, round_trip_us, two_nodes, why_no_nodes

DELAYS = {False: (0, 50, 200, 1000), True: (0, 200)}
REACH = 2          # of the cloth's links, in masses
WORDS = 6          # of each mass, that its neighbours read
# Peak memory of the command that it starts, in a file for each process.
WATCH = """import os, resource, subprocess, sys
code = subprocess.run(sys.argv[2:]).returncode
with open(f"{sys.argv[1]}.{os.getpid()}", "w") as file:
    file.write(str(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss))
sys.exit(code)
"""


def cloth(lab, side):
    """A square cloth with as many masses along each edge."""
    text = f"""steps = 1;
groups = ( {{ program = "{bench.ROOT}/programs/world/cloth.ode"; integrator = "semi_implicit_euler";
    grid  = {{ position = "x"; along = "xz"; count = [{side}, {side}]; spacing = {1 / side}; origin = [0.0, 2.0, 0.0]; }};
    links = ( {{ relation = "springs"; grid = ["structural", "shear"]; rest = "rest"; }},
              {{ relation = "springs"; grid = "bending"; rest = "rest"; set = {{ k = 10.0; }}; }} );
    only  = {{ objects = [0, {side - 1}]; set = {{ w = 0.0; }}; }}; }} );
"""
    return lab.scene(f"cloth{side}", text)


def balls(lab, count):
    """Balls that fall into a box whose height is half of its width."""
    side = 0.1 * (2.6 * 2 * count) ** (1 / 3)
    text = f"""steps = 1;
groups = ( {{ program = "{bench.ROOT}/programs/world/balls.ode"; integrator = "semi_implicit_euler"; objects = {count};
    random = {{ position = "x"; from = [0.05, 0.05, 0.05]; to = [{side - 0.05}, {side / 2}, {side - 0.05}]; apart = 0.1; seed = 1; }};
    set    = {{ side = {side}; stiff = 1000.0; damp = 1.0; }}; }} );
"""
    return lab.scene(f"balls{count}", text)


class Timed:
    """Microseconds of a step and of its exchange, each the least of several runs, and bytes that all ranks send in a step."""

    def __init__(self, lab, runs, repeats):
        """runs: name to (ranks, scene, nodes, threads, steps). They take turns, so that a busy moment does not meet one alone."""
        self.step, self.exchange, self.bytes = {}, {}, {}
        for _ in range(repeats):
            for name, (ranks, scene, nodes, threads, steps) in runs.items():
                said = lab.run(ranks, "--scene", scene, "-e", "fast", "--threads", threads, "--steps", steps, nodes=nodes, is_timed=True)
                took = 1e6 * said.seconds / steps
                self.step[name] = min(self.step.get(name, took), took)
                if said.times:
                    took = 1e6 * said.exchange / said.times
                    self.exchange[name] = min(self.exchange.get(name, took), took)
                    self.bytes[name] = said.bytes / said.times


def row_of(timed, name, **more):
    return more | {"us_per_step": round(timed.exchange[name], 3), "step_us": round(timed.step[name], 3), "bytes_per_step": timed.bytes[name]}


def way_of(ranks, nodes):
    return "shared memory" if nodes == 1 else "messages" if ranks == 2 else "shared memory and messages"


def exchange(lab, say, wire, _):
    """On one node, and between two whose packets take longer and longer."""
    steps, repeats, scene = (100, 1, cloth(lab, 20)) if lab.quick else (1000, 5, cloth(lab, 20))
    runs = {ranks: (ranks, scene, 1, 1, steps) for ranks in ((2,) if lab.quick else (2, 4, 8))}
    timed = Timed(lab, runs, repeats)
    rows = [row_of(timed, ranks, way=way_of(ranks, 1), ranks=ranks, nodes=1, delay_us=0) for ranks in runs]
    say("exchange on one node: " + ", ".join(f"{row['ranks']} ranks {row['us_per_step']:.2f} us" for row in rows))
    why = why_no_nodes(wire)
    if why or not lab.is_open_mpi:
        say(f"no exchange between nodes: {why or 'only Open MPI is started on them'}")
        return {"exchange": rows, "no_nodes": why}
    for delay in DELAYS[lab.quick]:
        with two_nodes(wire, delay):
            trip = round_trip_us()
            runs = {ranks: (ranks, scene, 2, 1, steps if delay < 1000 else steps // 2) for ranks in ((2,) if lab.quick else (2, 4))}
            timed = Timed(lab, runs, 1 if lab.quick else 3)
        rows += [row_of(timed, ranks, way=way_of(ranks, 2), ranks=ranks, nodes=2, delay_us=delay, round_trip_us=round(trip, 1)) for ranks in runs]
        say(f"exchange of two nodes, {delay} us: a packet there and back {trip:.0f} us, " +
            ", ".join(f"{row['ranks']} ranks {row['us_per_step']:.0f} us" for row in rows[-len(runs):]))
    return {"exchange": rows, "no_nodes": None}


# ---- a cloth in two, a million objects ----

def memory_of(lab, ranks, scene):
    """Peak memory of each rank, in MB."""
    path = lab.folder / f"memory-{scene.stem}-{ranks}"
    words = lab.words(ranks, sys.executable, "-c", WATCH, path, lab.fp3, "run", "--scene", scene, "-e", "fast", "--threads", 1, "--steps", 1)
    done = subprocess.run(words, cwd=lab.folder, env=environment(ranks), capture_output=True, text=True, timeout=300)
    found = sorted(int(file.read_text()) / 1024 for file in lab.folder.glob(f"{path.name}.*"))
    if done.returncode or len(found) != ranks:
        raise Failed(f"memory of {ranks} ranks: {done.stderr.strip().splitlines()[:1]}")
    return found


def startup(lab, ranks, scene, repeats):
    """Seconds of a run of one step, from the call of the command to its end."""
    found = []
    for _ in range(repeats):
        begin = time.monotonic()
        lab.run(ranks, "--scene", scene, "-e", "fast", "--threads", 1, "--steps", 1, is_timed=True)
        found.append(time.monotonic() - begin)
    return min(found)


def everybody(lab):
    """Stars all see each other: each word goes to all other ranks, and no other word goes anywhere."""
    scene, objects = bench.ROOT / "programs/world/stars.scene", 300
    for ranks in (2, 3):
        said = lab.run(ranks, "--scene", scene, "-e", "fast", "--steps", 10)
        needed = objects * 3 * 4 * (ranks - 1)
        if said.bytes != needed * said.times:
            raise Failed(f"{ranks} ranks send {said.bytes / said.times:.0f} bytes a step, and {needed} are needed")
        yield {"scene": "stars", "ranks": ranks, "sent": said.bytes / said.times, "needed": needed, "needed_is": "exact"}


def scale(lab, say, *_):
    """A large cloth on two ranks beside two threads, bytes beside what is needed, a million objects."""
    side, steps, repeats = (64, 20, 1) if lab.quick else (512, 60, 3)
    scene = cloth(lab, side)
    timed = Timed(lab, {"ranks": (2, scene, 1, 1, steps), "threads": (1, scene, 1, 2, steps)}, repeats)
    share = timed.exchange["ranks"] / timed.step["ranks"]
    ratio = timed.step["threads"] / timed.step["ranks"]
    straight = 2 * REACH * side * WORDS * 4
    ghosts = [*everybody(lab), {"scene": f"cloth {side} x {side}", "ranks": 2, "sent": timed.bytes["ranks"], "needed": straight, "needed_is": "a straight cut"}]
    if not straight <= timed.bytes["ranks"] < 2 * straight:
        raise Failed(f"the cloth's ranks send {timed.bytes['ranks']:.0f} bytes a step, a straight cut needs {straight}")
    say(f"cloth {side} x {side}: exchange {100 * share:.2f} % of a step, {ratio:.3f} times the speed of two threads, "
        f"{timed.bytes['ranks'] / straight:.3f} of the bytes of a straight cut")
    found = {"side": side, "step_us": timed.step["ranks"], "exchange_us": timed.exchange["ranks"], "share": share,
             "threads_step_us": timed.step["threads"], "ratio": ratio}
    large, small = [], cloth(lab, 20)
    for scene in (cloth(lab, 40 if lab.quick else 1000), balls(lab, 1600 if lab.quick else 10 ** 6)):
        row = {"scene": scene.stem, "memory_mb": {}, "seconds": {}}
        for ranks in (1, 2) if lab.quick else (1, 2, 4):
            row["memory_mb"][str(ranks)] = [round(mb, 1) for mb in memory_of(lab, ranks, scene)]
            row["seconds"][str(ranks)] = round(startup(lab, ranks, scene, 1 if lab.quick else 2) - startup(lab, ranks, small, 1 if lab.quick else 2), 3)
        large.append(row)
        say(f"{scene.stem}: ready and one step made after {row['seconds']} s, at most {({k: max(v) for k, v in row['memory_mb'].items()})} MB for a rank")
    return {"share": found, "ghosts": ghosts, "million": large}


# ---- a model ----

def model(lab, say, wire, data):
    """Its constants from some runs, and how it meets others."""
    repeats = 1 if lab.quick else 4
    sides = (20, 32, 64) if lab.quick else (20, 64, 256)
    scenes = {side: cloth(lab, side) for side in sides}
    steps = dict(zip(sides, (100, 100, 100) if lab.quick else (1000, 300, 50)))
    ranks = (1, 2) if lab.quick else (1, 2, 3, 4, 8)
    runs = {(side, count): (count, scenes[side], 1, 1, steps[side]) for side in sides for count in ranks}
    one = Timed(lab, runs, repeats)
    rows = [{"side": side, "ranks": count, "nodes": 1, "delay_us": 0, "measured": one.step[side, count], "exchange": one.exchange.get((side, count), 0.0),
             "bytes": one.bytes.get((side, count), 0.0), "is_fitted": side != sides[1] and count in (1, 2, 4)} for side, count in runs]
    for delay in () if why_no_nodes(wire) or not lab.is_open_mpi else DELAYS[lab.quick][-1:] if lab.quick else DELAYS[False]:
        with two_nodes(wire, delay):
            trip = round_trip_us()
            two = Timed(lab, {side: (2, scenes[side], 2, 1, min(steps[side], 500)) for side in sides}, 1 if lab.quick else 2)
        rows += [{"side": side, "ranks": 2, "nodes": 2, "delay_us": delay, "round_trip_us": trip, "measured": two.step[side], "exchange": two.exchange[side],
                  "bytes": two.bytes[side], "is_fitted": delay == (200 if lab.quick else 0) and side != sides[1]} for side in sides]
        say(f"model, two nodes, {delay} us: measured")
    balls_count = 1000 if lab.quick else 100000
    others = Timed(lab, {"balls": (1, balls(lab, balls_count), 1, 1, 50), "stars": (1, bench.ROOT / "programs/world/stars.scene", 1, 1, 500)}, repeats).step
    constants = cluster_model.fit(rows) | {"balls_object_us": others["balls"] / balls_count, "stars_pair_us": others["stars"] / 300 ** 2}
    for row in rows:
        row["predicted"] = cluster_model.step(constants, row)
    off = [abs(row["predicted"] / row["measured"] - 1) for row in rows if not row["is_fitted"]]
    say("model: " + json.dumps({name: round(value, 5) for name, value in constants.items()}) +
        f"; of {len(off)} runs that it was not fitted to the median is {100 * sorted(off)[len(off) // 2]:.0f} % off, the worst {100 * max(off):.0f} %")
    return {"model": rows, "constants": constants}
