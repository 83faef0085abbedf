"""How long a step of an object takes on engine fast, beside loops written by hand that make the same words, and beside others."""

import json
import math
import subprocess

from fp3world import cases
from fp3world import kinds
from fp3world import scene as ws
from fp3world import truth
from fp3world.physics import Lab


def run(command, what, seconds=None):
    """What it prints."""
    try:
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True, errors="replace", timeout=seconds)
    except subprocess.TimeoutExpired as why:
        raise ws.Failed(f"{what}: no end after {seconds} s") from why
    except OSError as why:
        raise ws.Failed(f"{command[0]}: {why.strerror}") from why
    if done.returncode:
        lines = done.stderr.strip().splitlines()
        raise ws.Failed(f"{what}: {lines[-1] if lines else f'exit code {done.returncode}'}")
    return done.stdout


def beside_hand(row, rows):
    """A row with how many times the loop by hand of its scene it takes."""
    hand = [other["ns_per_object_step"] for other in rows if other["engine"] == "hand" and (other["scene"], other["objects"]) == (row["scene"], row["objects"])]
    return row | {"ratio_to_hand": row["ns_per_object_step"] / hand[0]} if hand else row


def of_case(case, program, lab):
    """By hand and by engine fast."""
    output = lab.folder / "speed.json"
    path = kinds.put(lab, case) if case.kinds == 2 else ws.put(lab.folder, case.text(lab.quick), "speed")
    turns = ["--steps", 5, "--repeats", 3] if lab.quick else ["--steps", case.steps, "--before", case.before, "--repeats", 9]
    run([program, "--scene", path, "--json", output, *turns, *(["--loop", case.loop] if case.loop else [])], case.label)
    error = truth.of_fp3(lab, case)
    for row in json.loads(output.read_text(encoding="utf-8")):
        yield {"scene": case.name(lab.quick)} | row | {"error": error}


class Peers:
    """Others, run by a Python that may have their packages; where it is not, there are none."""
    most = 3600  # seconds for one of them

    def __init__(self, python, bullet, lab):
        self.lab = lab
        self.command = [python, ws.ROOT / "tools/world_peers.py"]
        self.options = ["--bullet", bullet]
        self.names = run([*self.command, "list", *self.options], "peers").split() if python.exists() else []

    def rows(self, name):
        output = self.lab.folder / "peer.json"
        run([*self.command, name, *self.options, "--fp3", self.lab.fp3.resolve(), "--folder", self.lab.folder, "--output", output, *(["--quick"] if self.lab.quick else [])], name, self.most)
        try:
            rows = json.loads(output.read_text(encoding="utf-8"))
        except (OSError, ValueError) as why:
            raise ws.Failed(f"{name}: wrote no rows: {why}") from why
        finally:
            output.unlink(missing_ok=True)
        for row in rows:
            ns, error = row["ns_per_object_step"], row["error"]
            if not (0 < ns < math.inf and (error is None or 0 <= error < math.inf)):
                raise ws.Failed(f"{name}: found {ns} ns and an error of {error}, expected a time above 0, and an error or none")
        return rows


def measure(options, folder, say):
    """The rows, and why a peer has none."""
    lab, rows, failed = Lab(options.fp3, folder, options.quick), [], []

    def keep(row):
        rows.append(row)
        error = "" if row["error"] is None else f", error {row['error']:.2g}"
        say(f"{row['scene']}, {row['engine']} {row['variant']}, threads {row['threads']}: {row['ns_per_object_step']:.2f} ns{error}")
    for case in cases.CASES:
        if case.quick or not options.quick:
            for row in of_case(case, options.bench, lab):
                keep(row)
    peers = Peers(options.peers, options.bench.parent / "bullet", lab)
    for name in peers.names:
        try:
            for row in peers.rows(name):
                keep(beside_hand(row, rows))
        except ws.Failed as why:
            failed.append(str(why))
    return rows, failed
