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
         Case("stars, 1024", "stars", stars(1024), loop="stars", quick=stars(70)),
         Case("stars, 16384", "stars", stars(16384), loop="stars", steps=1)]


def text_of(case, quick):
    text = ws.text_of(case.scene)
    for change in case.quick if quick else case.changes:
        text = ws.replace(text, *change)
    return text


def measure(program, folder, quick, say):
    rows = []
    for case in CASES:
        if quick and not case.quick:
            continue
        path, output = ws.put(folder, text_of(case, quick), "speed"), folder / "speed.json"
        turns = ["--steps", 5, "--repeats", 3] if quick else ["--steps", case.steps, "--before", case.before, "--repeats", 15]
        try:
            done = subprocess.run([program, "--scene", path, "--json", output, *map(str, turns), *(["--loop", case.loop] if case.loop else [])],
                                  capture_output=True, text=True)
        except OSError as why:
            raise ws.Failed(f"{program}: {why.strerror}") from why
        if done.returncode:
            raise ws.Failed(done.stderr.strip() or f"{program}: exit code {done.returncode}")
        for row in json.loads(output.read_text(encoding="utf-8")):
            rows.append({"scene": case.label + (", small" if quick else "")} | row)
            say(f"{rows[-1]['scene']}, {row['engine']} {row['variant']}, threads {row['threads']}: {row['ns_per_object_step']:.2f} ns")
    return rows
