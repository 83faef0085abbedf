#!/usr/bin/env python3
"""The gallery: scenes of at most 20 lines, each with its picture, its error and what a step costs on each engine.

    tools/gallery.py --fp3 build/bin/fp3 --measure      runs every scene, writes docs/gallery.json, and all that follows
    tools/gallery.py --fp3 build/bin/fp3                draws docs/gallery/*.png and writes docs/gallery.md from that file
    tools/gallery.py --fp3 build/bin/fp3 --only eight dam

The exit code is 1 if the engines differ in a bit, or one of them runs what it is said to refuse.
"""

import argparse
import dataclasses
import json
import pathlib
import re
import resource
import sys
import tempfile
import time
import types

import bench
from fp3gallery import errors as gallery_errors
from fp3gallery import page
import measured
from fp3world import chip
from fp3world import hashes
from fp3world import physics
from fp3world import scene as ws

ROOT = ws.ROOT
HERE, WORLD, BODIES = ROOT / "programs/gallery", ROOT / "programs/world", ROOT / "programs/bodies"
DATA, PAGE, PICTURES = ROOT / "docs/gallery.json", ROOT / "docs/gallery.md", ROOT / "docs/gallery"
TURNS, ENOUGH = 20, 2.0                     # runs that are timed, at most, and seconds: the shortest counts
LONG = 0.02                                 # seconds of a run that others interrupt: the time that the processor gave it counts
FIRST = 60                                  # stars of the small form


@dataclasses.dataclass
class Scene:
    """A scene, and the form of it that all engines run. Without steps that is the scene as it is."""
    name: str
    title: str
    folder: pathlib.Path = HERE
    steps: int = 0
    changes: tuple = ()                     # of the text, as world_hashes has them
    small: str = ""                         # what these make of it, in words
    engines: tuple = ("isa", "rtl")         # that run this form, beside fast
    configs: tuple = ("",)                  # of the hardware; "": that of the scene

    @property
    def path(self):
        return self.folder / f"{self.name}.scene"

    @property
    def is_bodies(self):
        return self.folder == BODIES

    @property
    def form(self):
        return ", ".join(filter(None, [self.small, f"{self.steps} steps" if self.steps else ""]))

    def text(self, folder, is_small=False):
        """The scene, readable from any folder. A file of points that is cut short stands in the folder."""
        text = ws.text_of(self.name, self.folder)
        for old, new in self.changes if is_small else ():
            text = ws.replace(text, old, new(folder) if callable(new) else new)
        return text


def first_stars(folder):
    """The head of Plummer's file and the first of its stars."""
    head, rows = [], []
    for line in (WORLD / "plummer.csv").read_text(encoding="utf-8").splitlines(True):
        (rows if re.match(r"[-\d]", line) else head).append(line)
    path = pathlib.Path(folder) / "points.csv"
    path.write_text("".join(head + rows[:FIRST]), encoding="utf-8")
    return f'points  = "{path}";'


def of_world(name, title, **more):
    """With the small form that make world has of it, if any."""
    return Scene(name, title, WORLD, **{"changes": tuple(hashes.SMALL.get(name, ("", ()))[1]), **more})


SCENES = [
    Scene("flag", "A flag in the wind", steps=100, changes=((r"count = \[20, 32\]", "count = [8, 8]"), (r'"0\.\.19"', '"0..7"')), small="8 x 8 masses"),
    of_world("heap", "10,000 balls fall into a box", steps=100, small="60 balls in a corner of the box"),
    of_world("plummer", "A Plummer sphere", steps=50, changes=((r'points  = "[^"]*";', first_stars),), small=f"the first {FIRST} stars"),
    of_world("dam", "A dam breaks", steps=100, small="6 x 12 particles"),
    of_world("eight", "Three bodies on a figure of eight"),
    Scene("pendulums", "400 double pendulums fan out", steps=32),
    Scene("arenstorf", "Arenstorf's orbit"),
    Scene("van_der_pol", "Van der Pol's oscillator, stiff"),
    Scene("duffing", "Duffing's strange attractor", steps=32),
    Scene("ships", "Ships that leave one after the other"),
    of_world("chain", "A chain in the hardware", configs=("world", "fabric")),
    Scene("lorenz", "An ensemble on Lorenz's attractor", steps=32),
    Scene("pyramid", "A pyramid is shot", BODIES, steps=4, changes=((r'count = \(40, "40 - i"\)', 'count = (3, "3 - i")'),), small="6 bricks"),
    Scene("ragdolls", "Dolls fall down stairs", BODIES, steps=4),
    Scene("car", "A car on a bridge", BODIES, steps=4),
    Scene("dominoes", "A run of dominoes", BODIES, steps=4, changes=((r"count = 60", "count = 6"),), small="6 dominoes"),
    Scene("tumbler", "400 bodies in a drum", BODIES, steps=4, changes=((r"count = \(20, 20\)", "count = (3, 3)"),), small="9 bodies"),
    Scene("castle", "A tower is shot, in space", BODIES, steps=4, changes=((r"count = \[12, 12\]", "count = [2, 3]"),), small="6 bricks"),
    Scene("top", "A handle that flips", BODIES, steps=4),
    Scene("tippe", "A top that stands on its head", BODIES, steps=4),
]


# ---- what is measured ----

def setting(text, name, default):
    found = re.search(rf'^{name}\s*= "?([^";]+)"?;', text, re.M)
    return found[1] if found else default


def seconds_of(said):
    return float(re.search(r"^(?:time|simulator) +([\d.e+-]+) s", said, re.M)[1])


def timed(fp3, path, options, turns):
    """What is said, and the shortest time of several runs: by the clock, and what the processor gave the whole command."""
    end, clock, given, said = time.monotonic() + ENOUGH, [], [], ""
    while not said or len(clock) < turns and time.monotonic() < end:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        said = ws.call(fp3, path, *options)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        clock.append(seconds_of(said))
        given.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return said, min(clock), min(given)


def run(fp3, folder, scene, engine, is_small=False, config=""):
    """A row: what ran, what a step of an object took, and the hash of all words of all states."""
    text = scene.text(folder, is_small)
    path = ws.put(folder, text, scene.name)
    options = ["--engine", engine, "--all", *(["--config", config] if config else []), *(["--threads", 1] if engine == "fast" else [])]
    is_timed = engine == "isa" or engine == "fast" and not is_small       # a start-up is longer than a few steps by native code
    said, clock, given = timed(fp3, path, [*options, *(["--steps", scene.steps] if is_small else [])], TURNS if is_timed else 1)
    count, (found, _) = chip.counters(said), ws.words_of(said)
    row = {"engine": engine, "config": config or setting(text, "config", "world"), "objects": len(found), "object_steps": count["object_steps"],
           "form": scene.form if is_small else "", "hash": ws.hash_of(found)}
    if engine == "rtl":
        return row | {"cycles": count["cycles"], "cycles_per_object_step": count["cycles"] / count["object_steps"]}
    if not is_timed:
        return row
    steps = count["object_steps"]
    if clock > LONG:
        first, _, start = timed(fp3, path, [*options, "--steps", 1], TURNS)
        clock, steps = min(clock, given - start), steps - chip.counters(first)["object_steps"]
    return row | {"ns_per_object_step": round(1e9 * clock / steps, 3)}


def run_bodies(fp3, folder, scene, engine, is_small=False):
    """Likewise, of rigid bodies: laws of contacts are built in, or an engine executes them."""
    path = ws.put(folder, scene.text(folder, is_small), scene.name)
    options = [*(["--engine", engine] if engine else []), *(["--steps", scene.steps] if is_small else [])]
    said, clock, given = timed(fp3, path, options, 1 if is_small else TURNS)
    objects, steps = (int(re.search(rf"^{name} +(\d+)", said, re.M)[1]) for name in ("bodies", "steps"))
    row = {"engine": engine or page.BUILT_IN, "config": "", "objects": objects, "object_steps": objects * steps, "form": scene.form if is_small else "",
           "hash": re.search(r"^hash +(\w{16})$", said, re.M)[1]}
    if is_small:
        return row
    if clock > LONG:
        _, _, start = timed(fp3, path, ["--steps", 1], TURNS)
        clock = min(clock, (given - start) * steps / (steps - 1))
    return row | {"ns_per_object_step": round(1e9 * clock / row["object_steps"], 3)}


def refusal(fp3, folder, scene, engine, is_small=False):
    """The last line of what an engine says that does not run a scene; None: it runs it."""
    try:
        path = ws.put(folder, scene.text(folder, is_small), scene.name)
        ws.call(fp3, path, "--engine", engine, "--steps", 1)
    except ws.Failed as why:
        if not why.is_limit():
            raise
        return {"engine": engine, "form": scene.form if is_small else "", "why": re.sub(r"^fp3 run: (?:\S+:\d+: )?", "", str(why))}
    return None


def engines_of(fp3, folder, scene, is_small):
    for engine in ("fast", *scene.engines):
        for config in scene.configs if engine == "rtl" else ("",):
            yield run(fp3, folder, scene, engine, is_small, config)


def measure(fp3, folder, scene):
    """All that the page has of a scene."""
    if scene.is_bodies:
        rows = [run_bodies(fp3, folder, scene, "")] + [run_bodies(fp3, folder, scene, engine, True) for engine in ("", "fast", *scene.engines)]
        if len({row["hash"] for row in rows[1:]}) > 1:
            raise ws.Failed(f"{scene.name}: engines differ: {', '.join(row['engine'] + ' ' + row['hash'] for row in rows[1:])}")
        return {"rows": rows, "errors": list(gallery_errors.of_bodies(fp3, folder, scene)), "refused": []}
    whole = [run(fp3, folder, scene, "fast")] if scene.steps else list(engines_of(fp3, folder, scene, False))
    small = list(engines_of(fp3, folder, scene, True)) if scene.steps else []
    for rows in (whole, small):
        if len({row["hash"] for row in rows}) > 1:
            raise ws.Failed(f"{scene.name}: engines differ: {', '.join(row['engine'] + ' ' + row['hash'] for row in rows)}")
    refused = [refusal(fp3, folder, scene, engine) for engine in ("isa", "rtl") if scene.changes]
    of_small = [refusal(fp3, folder, scene, engine, is_small=True) for engine in ("isa", "rtl") if engine not in scene.engines]
    if None in of_small:
        raise ws.Failed(f"{scene.name}: an engine runs what it is said to refuse")
    errors = list(gallery_errors.of(physics.Lab(fp3, folder, quick=False), scene))
    return {"rows": whole + small, "errors": errors, "refused": [row for row in refused + of_small if row]}


def take(fp3, folder, scenes, data):
    """The file, with these scenes measured again."""
    found = data.get("scenes", {})
    for scene in scenes:
        print(f"gallery: {scene.name}", file=sys.stderr, flush=True)
        about = bench.about(types.SimpleNamespace(quick=False))
        found[scene.name] = {name: about[name] for name in ("date", "processor", "processors", "load", "revision")} | measure(fp3, folder, scene)
    found = {scene.name: found[scene.name] for scene in SCENES if scene.name in found}
    configs = {row["config"] for part in found.values() for row in part["rows"] if row["engine"] == "rtl"}
    return {"device": measured.DEVICE, "grade": measured.GRADE, "mhz": {config: mhz for config, mhz in measured.clocks().items() if config in configs},
            "scenes": found}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--fp3", required=True, type=pathlib.Path, help="the command")
    parser.add_argument("--measure", action="store_true", help="measure before anything is drawn")
    parser.add_argument("--only", nargs="+", choices=[scene.name for scene in SCENES], help="measure and draw only these")
    options = parser.parse_args()
    scenes = [scene for scene in SCENES if not options.only or scene.name in options.only]
    fp3 = options.fp3.resolve()
    data = json.loads(DATA.read_text(encoding="utf-8")) if DATA.exists() else {}
    try:
        with tempfile.TemporaryDirectory() as folder:
            if options.measure:
                data = take(fp3, pathlib.Path(folder), scenes, data)
                bench.write(DATA, json.dumps(data, indent=1) + "\n")
            from fp3gallery import pictures         # which needs matplotlib
            PICTURES.mkdir(exist_ok=True)
            for scene in scenes:
                pictures.draw(fp3, pathlib.Path(folder), scene, PICTURES / f"{scene.name}.png")
    except ws.Failed as why:
        print(f"gallery: {why}", file=sys.stderr)
        return 1
    bench.write(PAGE, page.page(SCENES, data))
    return 0


if __name__ == "__main__":
    sys.exit(main())
