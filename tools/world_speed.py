"""How long a step of an object takes on engine fast, beside loops written by hand that make the same words."""

import json
import subprocess

import world_scene as ws


class Case:
    """A form of a scene; what a turn is, in the full form and in the quick one."""

    def __init__(self, label, scene, changes=(), loop=None, steps=20, before=1, quick=None):
        self.label, self.scene, self.changes, self.loop, self.steps, self.before, self.quick = label, scene, changes, loop, steps, before, quick


def stars(objects):
    return [(r"objects = 300", f"objects = {objects}"), (r"m = 0.00333", f'm = "1.0/{objects}"')]


CASES = [Case("net", "net", loop="net", quick=[(r"count = \[128, 128\]", "count = [40, 20]"), (r'"0\.\.127"', '"0..39"')]),
         Case("cloth 128 x 128", "cloth", [(r"count = \[20, 20\]", "count = [128, 128]"), (r"objects = \[0, 19\]", "objects = [0, 127]")]),
         Case("heap", "heap", loop="balls", before=16384, steps=50, quick=[(r"objects = 10000", "objects = 90"), (r"to = \[3.15, 2.2, 3.15\]", "to = [0.7, 0.5, 0.7]")]),
         Case("heap, 100000", "heap", [("objects = 10000", "objects = 100000"), (r"to = \[3.15, 2.2, 3.15\]", "to = [9.95, 2.2, 9.95]"), (r"side = 3.2", "side = 10.0")],
              loop="balls", before=8192, steps=10),
         Case("stars, 1024", "stars", stars(1024), loop="stars", quick=stars(70)),
         Case("stars, 16384", "stars", stars(16384), loop="stars", steps=1)]


def text_of(case, quick):
    text = ws.text_of(case.scene)
    for change in case.quick if quick else case.changes:
        text = ws.replace(text, *change)
    return text


def run(command, output, what):
    try:
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True)
    except OSError as why:
        raise ws.Failed(f"{command[0]}: {why.strerror}") from why
    if done.returncode:
        lines = done.stderr.strip().splitlines()
        raise ws.Failed(f"{what}: {lines[-1] if lines else f'exit code {done.returncode}'}")
    return json.loads(output.read_text(encoding="utf-8"))


def beside_hand(row, rows):
    """A row with how many times the loop by hand of its scene it takes."""
    hand = [other["ns_per_object_step"] for other in rows if other["engine"] == "hand" and (other["scene"], other["objects"]) == (row["scene"], row["objects"])]
    return row | {"ratio_to_hand": row["ns_per_object_step"] / hand[0]} if hand else row


def measure(program, peers, folder, quick, say):
    """peers: a Python that may have the packages of others; where it is not, they are left out."""
    rows, output = [], folder / "speed.json"

    def keep(row):
        rows.append(row)
        say(f"{row['scene']}, {row['engine']} {row['variant']}, threads {row['threads']}: {row['ns_per_object_step']:.2f} ns")
    for case in CASES:
        if quick and not case.quick:
            continue
        path = ws.put(folder, text_of(case, quick), "speed")
        turns = ["--steps", 5, "--repeats", 3] if quick else ["--steps", case.steps, "--before", case.before, "--repeats", 15]
        command = [program, "--scene", path, "--json", output, *turns, *(["--loop", case.loop] if case.loop else [])]
        for row in run(command, output, case.label):
            keep({"scene": case.label + (", small" if quick else "")} | row)
    if peers.exists():
        for row in run([peers, ws.ROOT / "tools/world_peers.py", output, *(["--quick"] if quick else [])], output, "peers"):
            keep(beside_hand(row, rows))
    return rows
