"""One hash a scene of bodies: laws that are built in and as programs, by every engine, on every kind of processor, added and stepped in other calls."""

import os
import pathlib
import shutil
import subprocess
import tempfile

from fp3bodies import by_fp3
from fp3bodies import scene as sc
from fp3world.scene import kinds

BUILD = pathlib.Path(os.environ.get("FP3_BUILD", pathlib.Path(__file__).resolve().parents[2] / "build"))
SCENES = {one.name: make for make in (lambda: sc.pyramid(10), sc.ragdolls, sc.car, lambda: sc.mixed(200, restitution=0.5), lambda: sc.dominoes(30))
          for one in [make()]}
QUICK = {"2 ragdolls": [], "30 dominoes, 0.35 apart": ["world"]}  # and the hardware's configurations
STEPS = {True: 60, False: 360}
STEPS_RTL = {True: 1, False: 2}
CONFIGS = ["world", "fabric"]
ABROAD = {"arm64": "aarch64", "riscv64": "riscv64"}  # as tools/everywhere.py has them
WAYS = ("calls", "restored")


class Failed(Exception):
    """A run without a hash."""


def write(folder, scene):
    """The file that tests/bodies/stepped.c reads."""
    path = folder / f"{scene.name.replace(' ', '_')}.scene"
    path.write_bytes(by_fp3.Definitions(by_fp3._library.library(), scene).bytes())
    return path


def elsewhere():
    """Machines of other families under qemu, where `make everywhere` has compiled for them."""
    for platform, family in ABROAD.items():
        program, qemu = BUILD / f"everywhere/{family}-linux-gnu/tests/stepped", shutil.which(f"qemu-{family}")
        if program.exists() and qemu:
            yield platform, [qemu, "-L", f"/usr/{family}-linux-gnu", program]


def said(path, steps, engine="-", config="-", way="whole", fast="", cache="", by=(BUILD / "tests/stepped",)):
    mine = {name: value for name, value in os.environ.items() if not name.startswith("FP3_")}
    mine |= {"FP3_FAST": fast, "FP3_RTL_DIR": str(BUILD / "lib/fp3")} | ({"FP3_CACHE_DIR": str(cache)} if cache else {})
    done = subprocess.run([*by, path, str(steps), engine, config, way], env=mine, capture_output=True, text=True)
    if done.returncode:
        raise Failed(f"{path.stem}, {engine}, {way}: exit code {done.returncode}: {done.stderr.strip()}")
    return done.stdout


def stepped(*words, **more):
    """The hash alone."""
    return said(*words, **more).split()[0]


def native(folder, path, steps, kind):
    """Each law has left its code in the cache, or it was interpreted."""
    cache = folder / kind
    found = stepped(path, steps, "native", fast=kind, cache=cache)
    if not any(cache.rglob("*.so")):
        raise Failed(f"{path.stem}: no native code for {kind} was made")
    return found


def of_scene(name, path, folder, quick):
    """Engine, variant, steps and hash. The first row of so many steps is what the others are compared with."""
    steps, few = STEPS[quick], STEPS_RTL[quick]
    for kind in kinds():
        yield "built in", kind, steps, stepped(path, steps, fast=kind)
    for way in WAYS:
        yield "built in", way, steps, stepped(path, steps, way=way)
    yield "isa", "whole", few if quick else steps, stepped(path, few if quick else steps, "isa")
    yield "fast", "interpreter", steps, stepped(path, steps, "fast", fast="interpreter")
    yield "built in", "whole", few, stepped(path, few)
    for config in QUICK[name] if quick else CONFIGS[:1]:
        yield "rtl", config, few, stepped(path, few, "rtl", config)
    yield "built in", f"file, last {steps // 2}", steps, stepped(path, steps, way=f"file{steps // 2}")
    yield "isa", f"file, last {few}", steps, stepped(path, steps, "isa", way=f"file{few}")
    for config in [] if quick else CONFIGS:
        yield "rtl", f"{config}, file, last {few}", steps, stepped(path, steps, "rtl", config, f"file{few}")
    if quick:
        return
    for kind in kinds():
        yield "fast", f"native {kind}", steps, native(folder, path, steps, kind)
    for platform, by in elsewhere():
        for way in ("whole", "calls", "restored"):
            yield "built in", f"{platform}, {way}", steps, stepped(path, steps, way=way, by=by)
        yield "fast", f"{platform}, interpreter", steps, stepped(path, steps, "fast", fast="interpreter", by=by)


def measure(quick, say, names=()):
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name in names or (QUICK if quick else SCENES):
            path = write(pathlib.Path(folder), SCENES[name]())
            for engine, variant, steps, found in of_scene(name, path, pathlib.Path(folder), quick):
                rows.append({"scene": name, "engine": engine, "variant": variant, "steps": steps, "hash": found})
                say(f"{name}, {engine}, {variant}: {found}")
    return rows


def differing(rows):
    """Those that have not the hash of the first one of the same scene and steps."""
    first = {}
    for row in rows:
        first.setdefault((row["scene"], row["steps"]), row["hash"])
    return [row for row in rows if row["hash"] != first[row["scene"], row["steps"]]]
