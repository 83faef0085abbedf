#!/usr/bin/env python3
"""Objects that are divided among ranks: the same bits, runs that are killed, what the exchange costs, and a model of it.

    tools/cluster.py                                     all of it, at its full length: `make cluster`
    tools/cluster.py --quick                             the same in seconds, for the tests
    tools/cluster.py --parts hashes model

Writes build/results/cluster.json; parts that are not measured stay as they were in it. Exit code 1: a scene has two hashes, a killed run does not
end with the hash of an undisturbed one, or a run fails.
"""

import argparse
import json
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time

import bench
from fp3cluster import costs as cluster_costs
from fp3world import hashes as world_hashes
from fp3world import scene as world_scene
from fp3cluster.lab import Failed, Lab, environment

RANKS = {False: (1, 2, 3, 4, 8), True: (1, 2, 3)}
# Scene, how others see it, engines, steps in the full form. All are small enough for the hardware.
SCENES = (
    ("cloth", "links", ("isa", "fast", "rtl"), 40),
    ("balls", "near", ("isa", "fast", "rtl"), 40),
    ("stars", "all others", ("isa", "fast", "rtl"), 40),
    ("dam", "near, two phases", ("isa", "fast", "rtl"), 40),
    ("sleep", "nobody; a ship sleeps when it has arrived", ("isa", "fast", "rtl"), 200),
    ("mixed", "nobody; two groups", ("isa", "fast", "rtl"), 64),
)
SHIPS = """config = "many";
steps = 200;
h = 0.0078125;
groups = ( {{ program = "{root}/programs/ship_sleep.s"; objects = 48; params = "{root}/programs/ship.cfg";
    set = {{ eps = 0.0026; slept = 0.0; }}; spread = {{ T = [2.4e5, 3.3e5]; }}; }} );
"""


def text_of(name):
    if name == "sleep":
        return SHIPS.format(root=bench.ROOT)
    if name == "mixed":
        return world_scene.text_of(name, bench.ROOT / "programs")
    return world_hashes.form_of(name, world_hashes.SMALL)[1]


# ---- hashes ----

def hashes(lab, say):
    """One hash for each scene, whatever computes it."""
    rows, refused = [], []
    for name, sees, engines, steps in SCENES[:3] + SCENES[4:] if lab.quick else SCENES:
        scene = lab.scene(name, text_of(name))
        for engine in engines[1:2] if lab.quick else engines:
            for ranks in RANKS[lab.quick]:
                try:
                    said = lab.run(ranks, "--scene", scene, "-e", engine, "--steps", 8 if lab.quick else steps, "--checkpoint", "hash.ck",
                                   *(("--threads", 1) if engine == "fast" else ()))
                except Failed as why:
                    if engine != "rtl" or ranks == 1 or not any(limit in str(why) for limit in world_scene.LIMITS):
                        raise
                    refused.append({"scene": name, "ranks": ranks, "engine": engine, "why": str(why).rpartition(": ")[2]})
                    continue
                rows.append({"scene": name, "sees": sees, "steps": 8 if lab.quick else steps, "ranks": ranks, "engine": engine,
                             "exchange": "none" if not said.times else "shared memory", "hash": said.hash})
        found = {row["hash"] for row in rows if row["scene"] == name}
        say(f"hashes of {name}: {len(found)}")
        if len(found) != 1 or None in found:
            each = ", ".join(f"{row['engine']} on {row['ranks']} {str(row['hash'])[:8]}" for row in rows if row["scene"] == name)
            raise Failed(f"{name} has {len(found)} hashes: {each}")
    return {"hashes": rows, "refused": refused}


# ---- kills ----

def children_of(pid):
    try:
        return list(map(int, pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="ascii").split()))
    except OSError:
        return []


def kill(going, ranks, is_all, chance):
    """One rank, or all and mpirun with them."""
    each = children_of(going.pid) if ranks > 1 else [going.pid]
    for pid in each if is_all else chance.sample(each, min(1, len(each))):
        try:
            os.kill(pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
    if is_all and going.poll() is None:
        going.kill()


def wait_for_change(path, going):
    def now():
        return path.stat().st_mtime_ns if path.exists() else 0
    before, end = now(), time.monotonic() + 30
    while now() == before and going.poll() is None and time.monotonic() < end:
        time.sleep(0.005)


def kills(lab, say):
    """Runs that are killed again and again, and restarted, until they end."""
    chance, tried, right, alone, stuck, runs = random.Random(1), 0, 0, 0, 0, 0
    wanted = 3 if lab.quick else 100
    scene = bench.ROOT / "programs/world/cloth.scene"
    base = ("--scene", scene, "-e", "fast", "--threads", 1, "--steps", 6000, "--checkpoint-every", 20)
    whole = lab.run(1, *base, "--checkpoint", "whole.ck").hash
    while tried < wanted:
        ranks, of_this_run, path = chance.randint(1, 3), 0, lab.folder / f"kill{tried}.ck"
        while True:
            restart = ("--restart", path) if path.exists() else ()
            going = subprocess.Popen(lab.words(ranks, lab.fp3, "run", *base, "--checkpoint", path, *restart), cwd=lab.folder, env=environment(ranks),
                                     stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            if tried + of_this_run < wanted and of_this_run < 4:
                wait_for_change(path, going)
                time.sleep(chance.uniform(0, 0.1))
                is_all = chance.random() < 0.5
                kill(going, ranks, is_all, chance)
            each = children_of(going.pid)
            try:
                said = going.communicate(timeout=20)[0]
            except subprocess.TimeoutExpired:  # a mpirun that was hit while it started may wait for ever
                for pid in [*each, *children_of(going.pid), going.pid]:
                    subprocess.run(["kill", "-9", str(pid)], capture_output=True)
                said, stuck = going.communicate(timeout=60)[0], stuck + 1
                if stuck > wanted // 3 + 1:
                    raise Failed("runs that were killed do not end") from None
            if going.returncode == 0:
                break
            if tried + of_this_run >= wanted or of_this_run >= 4:
                raise Failed(f"a restart on {ranks} ranks fails: {said.strip().splitlines()[:1]}")
            of_this_run += 1
            alone += not is_all
        tried, runs = tried + of_this_run, runs + 1
        if runs > 2 * wanted + 10:
            raise Failed(f"{runs} runs, and {tried} of them could be killed: the others had ended")
        right += of_this_run * (f"hash             {whole}\n" in said)
    say(f"{right} of {tried} kills end with the hash of an undisturbed run, {alone} of them of one rank")
    if right != tried:
        raise Failed(f"{tried - right} of {tried} kills end with another hash")
    return {"kills": {"tried": tried, "right": right, "one_rank": alone, "whole_job": tried - alone, "stuck": stuck, "scene": "cloth"}}


# ---- all of it ----

PARTS = {"hashes": hashes, "kills": kills, "exchange": cluster_costs.exchange, "scale": cluster_costs.scale, "model": cluster_costs.model}


def kept(options):
    """What was found before in the same form."""
    try:
        data = json.loads(options.output.read_text(encoding="utf-8"))
        return data if data["about"]["form"] == bench.about(options)["form"] else {}
    except (OSError, ValueError, KeyError, TypeError):
        return {}


def measure_all(options, folder):
    begin, data = time.monotonic(), kept(options)
    lab = Lab(options.fp3, folder, options.quick, options.first)

    def say(text):
        print(f"cluster: {text}, {time.monotonic() - begin:.0f} s so far", file=sys.stderr, flush=True)
    for part in options.parts:
        data |= {"about": bench.about(options) | {"command": "make cluster" + (" QUICK=1" if options.quick else "")}}
        data |= PARTS[part](lab, say) if part in ("hashes", "kills") else PARTS[part](lab, say, options.wire, data)
        bench.write(options.output, json.dumps(data, indent=1) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--fp3", type=pathlib.Path, default=bench.ROOT / "build/bin/fp3", help="the command")
    parser.add_argument("--wire", type=pathlib.Path, default=bench.ROOT / "build/bench/wire", help="the program that delays packets")
    parser.add_argument("--quick", action="store_true", help="few steps, few ranks")
    parser.add_argument("--first", action="store_true", help="time runs on one node as real-time processes (chrt, root): for a machine with other work")
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=list(PARTS), help="only these (default: all)")
    parser.add_argument("--output", type=pathlib.Path, default=bench.ROOT / "build/results/cluster.json", help="the file to write")
    options = parser.parse_args()
    try:
        with tempfile.TemporaryDirectory() as folder:
            measure_all(options, pathlib.Path(folder))
    except (Failed, world_scene.Failed, subprocess.TimeoutExpired) as why:
        print(f"cluster: {why}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
