"""One hash a scene of bodies: laws that are built in and as programs, by every engine, on every kind of processor, added and stepped in other calls."""

import dataclasses
import math
import os
import pathlib
import shutil
import subprocess
import tempfile

from fp3bodies import by_fp3
from fp3bodies import scene as sc
from fp3bodies.scene import Body, Joint, Pin, Scene
from fp3world.scene import kinds

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("FP3_BUILD", ROOT / "build"))


def tops():
    """A box that turns about its middle axis and flips, a gyroscope on a pin, and a top that falls over."""
    bodies = [Body("box", (0.3, 0.2, 0.1), (-4.0, 60.0, 0.0), w=(0.05, 5.0, 0.05)), Body("box", (0.3, 0.05, 0.3), (0.4, 2.0, 0.0), w=(40.0, 0.0, 0.0)),
              Body("box", (0.2, 0.2, 0.2), (4.0, 0.25, 0.0), q=(0.9, 0.3, 0.1, 0.2), w=(0.0, 20.0, 0.0))]
    return Scene("tops", [*bodies, floor(8.0)], [Pin(-1, 1, (0.0, 2.0, 0.0))], gravity=(0.0, -10.0, 0.0))


def floor(half, **more):
    return Body("box", (half, 1.0, half), (0.0, -1.0, 0.0), fixed=True, **more)


def spheres(side=4):
    """Balls of two sizes bounce into a heap in a box."""
    walls = [Body("box", size, at, fixed=True) for k in (-3.5, 3.5) for size, at in (((1.0, 4.0, 4.0), (k, 3.0, 0.0)), ((4.0, 4.0, 1.0), (0.0, 3.0, k)))]
    balls = [Body("disc", (0.4 + 0.1 * ((i + j + k) % 2),), (1.1 * i - 1.7 + 0.05 * j, 0.6 + 1.1 * j, 1.1 * k - 1.7 + 0.03 * i), restitution=0.5)
             for j in range(side) for i in range(side) for k in range(side)]
    return Scene(f"{len(balls)} spheres", [floor(6.0), *walls, *balls], gravity=(0.0, -10.0, 0.0))


def joints_in_space():
    """Each joint of space holds a box to another one, and both fall onto the ground."""
    types = [("ball", {"has_limits": 1, "low": 0.0, "high": 1.0}), ("hinge", {"axis": (0.0, 1.0, 0.0), "speed": 3.0, "most": 2.0}),
             ("slider", {"axis": (1.0, 0.0, 0.0), "has_limits": 1, "low": -0.1, "high": 0.4}), ("weld", {"hertz": 5.0}),
             ("rod", {"anchor_b": (0.0, 0.1, 0.0), "hertz": 3.0}), ("wheel", {"axis": (0.0, 1.0, 0.0), "axle": (0.0, 0.0, 1.0), "hertz": 4.0})]
    bodies, joints = [floor(20.0, friction=0.4)], []
    for k, (type, more) in enumerate(types):
        at = 3.0 * k - 9.0
        joints.append(Joint(type, len(bodies), len(bodies) + 1, {"anchor_a": (0.6, 0.0, 0.0), "anchor_b": (-0.4, 0.0, 0.0)} | more))
        bodies += [Body("box", (0.5, 0.2, 0.1), (at, 2.5, 0.0)), Body("box", (0.2, 0.1, 0.3), (at + 1.0, 2.5, 0.0), w=(1.0, 2.0, 3.0))]
    return Scene("joints in space", bodies, joints=joints, gravity=(0.0, -10.0, 0.0))


def by_density(scene):
    """Without masses and inertias, which tests/bodies/stepped.c does not know: a disc of a mass has the density that gives it."""
    def made(body):
        density = body.mass / (math.pi * body.size[0] ** 2) if body.mass and body.shape == "disc" else body.density
        return dataclasses.replace(body, mass=0.0, inertia=(), density=density)
    return dataclasses.replace(scene, bodies=[made(body) for body in scene.bodies])


def swinging():
    """A heavy body on light links that swings: at rest it would sleep."""
    made = by_density(sc.chain(20, heavy=1000.0))
    return dataclasses.replace(made, bodies=[*made.bodies[:-1], dataclasses.replace(made.bodies[-1], v=(4.0, 0.0))])


MAKERS = (lambda: sc.pyramid(10), sc.ragdolls, sc.car, lambda: sc.mixed(200, restitution=0.5), lambda: sc.dominoes(30), swinging,
          lambda: by_density(sc.pyramid_in_space(5)), joints_in_space, tops, spheres)
LARGE = (lambda: sc.pyramid(32),)  # one thread alone steps fewer than 1,000 bodies and pairs; engines would take long
SCENES = {make().name: make for make in (*MAKERS, *LARGE)}
QUICK = {"2 ragdolls": [], "30 dominoes, 0.35 apart": ["world"], "joints in space": []}  # and the hardware's configurations
STEPS = {True: 60, False: 360}
STEPS_ISA, STEPS_RTL = 60, {True: 1, False: 2}
CONFIGS = ["world", "fabric"]
RANKS = THREADS = (2, 3)
ABROAD = {"arm64": "aarch64", "riscv64": "riscv64"}  # as tools/everywhere.py has them
WAYS = ("calls", "restored", "far")
MPI = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_mpi_yield_when_idle": "1"}


class Failed(Exception):
    """A run without a hash."""


def write(folder, scene):
    """The file that tests/bodies/stepped.c reads."""
    path = folder / f"{scene.name.replace(' ', '_')}.scene"
    path.write_bytes(by_fp3.Definitions(by_fp3._library.library(), scene).bytes())
    return path


def elsewhere():
    """Machines of other families under qemu, where `make everywhere` has compiled for them, and WebAssembly under wasmtime; or why not."""
    for platform, family in ABROAD.items():
        program, qemu = BUILD / f"everywhere/{family}-linux-gnu/tests/stepped", shutil.which(f"qemu-{family}")
        yield platform, [qemu, "-L", f"/usr/{family}-linux-gnu", program] if program.exists() and qemu else None
    program, python = BUILD / "wasm/stepped.wasm", ROOT / ".venv/bin/python"
    yield "wasm", [python, ROOT / "tools/wasi.py", program] if program.exists() and python.exists() else None


def on_ranks(count):
    """None: there is no MPI."""
    if not shutil.which("mpirun") or not (BUILD / "lib/fp3/fp3_mpi.so").exists():
        return None
    is_open = "Open" in subprocess.run(["mpirun", "--version"], capture_output=True, text=True).stdout
    return ["mpirun", *(["--oversubscribe"] if is_open else []), "-n", str(count), BUILD / "tests/stepped"]


def said(path, steps, engine="-", config="-", way="whole", fast="", cache="", by=(BUILD / "tests/stepped",)):
    mine = {name: value for name, value in os.environ.items() if not name.startswith("FP3_")} | MPI
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


NO_MPI, NO_COMPILER = "make setup-cluster all", "make setup-everywhere setup-playground everywhere"


def of_scene(name, path, folder, quick):
    """Engine, variant, steps and hash, or why there is none. The first row of so many steps is what the others are compared with."""
    steps, few = STEPS[quick], STEPS_RTL[quick]
    if SCENES[name] in LARGE:
        for count in (1, *THREADS):
            yield "built in", f"{count} thread{'s' * (count > 1)}", steps, stepped(path, steps, way=f"threads{count}")
        return
    isa = few if quick else STEPS_ISA
    for kind in kinds():
        yield "built in", kind, steps, stepped(path, steps, fast=kind)
    for way in WAYS:
        yield "built in", way, steps, stepped(path, steps, way=way)
    for count in RANKS[:1] if quick else RANKS:
        by = on_ranks(count)
        yield "built in", f"{count} ranks", steps, stepped(path, steps, way="ranks", by=by) if by else NO_MPI
    yield "fast", "interpreter", steps, stepped(path, steps, "fast", fast="interpreter")
    for count in () if quick else {isa, few}:
        yield "built in", "whole", count, stepped(path, count)
    yield from ([("built in", "whole", few, stepped(path, few))] if quick else ())
    yield "isa", "whole", isa, stepped(path, isa, "isa")
    for config in QUICK[name] if quick else CONFIGS[:1]:
        yield "rtl", config, few, stepped(path, few, "rtl", config)
    for engine, config, last in [("-", "-", steps // 2), ("isa", "-", few), *([] if quick else [("rtl", config, few) for config in CONFIGS])]:
        variant = ("" if config == "-" else f"{config}, ") + f"file, last {last}"
        yield "built in" if engine == "-" else engine, variant, steps, stepped(path, steps, engine, config, f"file{last}")
    if quick:
        return
    for kind in kinds():
        yield "fast", f"native {kind}", steps, native(folder, path, steps, kind)
    yield "isa", "2 ranks", few, stepped(path, few, "isa", way="ranks", by=on_ranks(2)) if on_ranks(2) else NO_MPI
    for platform, by in elsewhere():
        for way in ("whole", "calls", "restored"):
            yield "built in", f"{platform}, {way}", steps, stepped(path, steps, way=way, by=by) if by else NO_COMPILER
        yield "fast", f"{platform}, interpreter", steps // 6, stepped(path, steps // 6, "fast", fast="interpreter", by=by) if by else NO_COMPILER


def measure(quick, say, names=()):
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name in names or (QUICK if quick else SCENES):
            path = write(pathlib.Path(folder), SCENES[name]())
            for engine, variant, steps, found in of_scene(name, path, pathlib.Path(folder), quick):
                rows.append({"scene": name, "engine": engine, "variant": variant, "steps": steps} | ({"why": found} if " " in found else {"hash": found}))
                say(f"{name}, {engine}, {variant}: {found}")
    return rows


def differing(rows):
    """Those that have not the hash of the first one of the same scene and steps."""
    first, made = {}, [row for row in rows if "hash" in row]
    for row in made:
        first.setdefault((row["scene"], row["steps"]), row["hash"])
    return [row for row in made if row["hash"] != first[row["scene"], row["steps"]]]
