"""Short runs of the command whose output decides a figure: the words that a compiler makes, the hash of a scene.

A source may change and its program not. So a figure about a program depends on the program's words, not on the compiler's text. What a
probe said is kept in build/evidence/ for as long as the command and the probed files are the same.
"""

import concurrent.futures
import functools
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[2]
KEPT = pathlib.Path(os.environ.get("FP3_BUILD", ROOT / "build")) / "evidence/probes.json"
WAYS = ((), ("-k",), ("--double-single",))
LISTED = ROOT / "isa/configs.toml"
CONFIGS = [row["name"] for row in tomllib.loads(LISTED.read_text(encoding="utf-8"))["config"]] if LISTED.exists() else []
THOROUGH = ("kepler", "oscillator")         # whose tables have a row for each integrator


class Failed(Exception):
    """A probe without an answer."""


def image(fp3, model, *words):
    """The bytes of a program, or that there is none."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "x.fp3"
        done = subprocess.run([fp3, "compile", model, *words, "--image", path], cwd=ROOT, capture_output=True, text=True)
        if done.returncode not in (0, 2):
            raise Failed(f"fp3 compile {model} {' '.join(words)}: exit code {done.returncode}: {done.stderr.strip()}")
        return path.read_bytes() if done.returncode == 0 else b"refused"


def names(pattern):
    return sorted(str(path.relative_to(ROOT)) for path in ROOT.glob(pattern))


def words_of_models():
    """Every model by rk4, and two by each integrator."""
    integrators = [pathlib.PurePath(name).stem for name in names("programs/integrators/*.cfg")]
    asked = [(model, "-c", "many_full", *way) for model in names("programs/*.ode") for way in WAYS]
    asked += [(f"programs/{model}.ode", "-c", "many_full", "-i", integrator, *way) for model in THOROUGH for integrator in integrators for way in WAYS[:2]]
    return asked


def words_of_model(model):
    """Of one model, by an integrator of each kind."""
    return [(f"programs/{model}.ode", "-c", "many_full", *way, *by) for way in WAYS for by in ((), ("-i", "dopri5"), ("-i", "leapfrog"))]


def words_of_scenes():
    """What scenes of programs/world run, and the laws of bodies."""
    asked = set()
    for scene in names("programs/world/*.scene"):
        text = (ROOT / scene).read_text(encoding="utf-8")
        for program, more in re.findall(r'program\s*=\s*"(\w+\.ode)"([^}]*)', text):
            found = re.search(r'integrator\s*=\s*"(\w+)"', more)
            asked.add((f"programs/world/{program}", *(("-i", found[1]) if found else ())))
    return sorted(asked) + [(law,) for law in names("programs/bodies/*.ode")]


def hashes_everywhere(fp3):
    """By the engine isa alone; `make everywhere` asks all others."""
    import everywhere
    with tempfile.TemporaryDirectory() as folder:
        machine = everywhere.Machine(pathlib.Path(folder), [fp3])
        try:
            return [f"{scene} {machine.run(scene, 'isa')[0]}" for scene in everywhere.SCENES]
        except everywhere.Failed as why:
            raise Failed(str(why)) from None


def hashes_of_bodies(fp3):
    """By laws that are built in, of the scenes that one thread steps."""
    from fp3bodies import hashes
    with tempfile.TemporaryDirectory() as folder:
        def one(name):
            return f"{name} {hashes.stepped(hashes.write(pathlib.Path(folder), hashes.SCENES[name]()), hashes.STEPS[False])}"
        try:
            return [one(make().name) for make in hashes.MAKERS]
        except hashes.Failed as why:
            raise Failed(str(why)) from None


def compiled(listed):
    """A probe of programs that are compiled."""
    def probe(fp3):
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            return [hashlib.sha256(found).hexdigest() for found in pool.map(lambda words: image(fp3, *words), listed())]
    return probe


@functools.cache
def verilator():
    """Its version. None: it is not installed."""
    if not shutil.which("verilator"):
        return None
    return subprocess.run(["verilator", "--version"], capture_output=True, text=True, check=True).stdout.split()[1]


@functools.cache
def described():
    from fp3gen.read import load
    return load(ROOT)


@functools.cache
def made_of(config):
    """What Verilator makes of a configuration, as a hash. Several probes ask for the same one."""
    import tops
    machine = described()
    row = next(row for row in machine.configs if row["name"] == config)
    with tempfile.TemporaryDirectory() as folder:
        top, model = tops.write(row, machine, pathlib.Path(folder)), pathlib.Path(folder) / "model"
        done = subprocess.run(["verilator", "-f", "rtl/fp3.f", "-O3", "--cc", "--prefix", "V", "--top-module", top.stem, "--Mdir", model, top],
                              cwd=ROOT, capture_output=True, text=True)
        if done.returncode:
            raise Failed(f"verilator {top.name}: {done.stderr.strip()}")
        found = hashlib.sha256()
        for path in sorted([*model.glob("*.cpp"), *model.glob("*.h")]):
            found.update(path.read_bytes().replace(os.fsencode(folder), b""))
        return f"{config} {found.hexdigest()}"


def hardware(*configs):
    """What Verilator makes of configurations: comments, layout, and parts that a configuration does not have are not in it. Another version
    makes something else of them, so the version is said as well."""
    def probe(_):
        if not verilator():
            return None
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            return list(pool.map(made_of, configs))
    return probe, ("rtl/**/*.v", "rtl/**/*.vh", "rtl/fp3.f", "isa/*.toml", "tools/tops.py", "tools/fp3gen/*.py"), verilator


# Name, what it does, the files that it reads beside the command, and, if what it says comes from a tool, the tool's version.
PROBES = {
    "words of models": (compiled(words_of_models), ("programs/*.ode", "programs/integrators/*")),
    "words of scenes": (compiled(words_of_scenes), ("programs/world/*", "programs/bodies/*.ode")),
    "hashes everywhere": (hashes_everywhere, ("programs/**/*", "tests/everywhere/*", "tools/everywhere.py")),
    "hashes of bodies": (hashes_of_bodies, ("tools/fp3bodies/*.py",)),
} | {"hardware": hardware(*CONFIGS)} | {f"hardware {name}": hardware(name) for name in CONFIGS} \
  | {f"words of {model}": (compiled(functools.partial(words_of_model, model)), (f"programs/{model}.ode", "programs/integrators/*"))
     for model in (path.stem for path in ROOT.glob("programs/*.ode"))}


def key(fp3, patterns):
    """Of all that a probe's answer comes from. The binary of bodies is linked from the same library."""
    found = hashlib.sha256(pathlib.Path(__file__).read_bytes() + pathlib.Path(fp3).resolve().read_bytes())
    for pattern in patterns:
        for path in sorted(ROOT.glob(pattern)):
            if path.is_file():
                found.update(path.read_bytes())
    return found.hexdigest()


def ask(name, fp3):
    """The hash of what a probe says. None: nothing is built that could be asked, or whom it asks is not installed."""
    if not pathlib.Path(fp3).exists():
        return None
    probe, patterns, *version = PROBES[name]
    by = f"{version[0]()} " if version else ""
    try:
        kept = json.loads(KEPT.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        kept = {}
    of = by + key(fp3, patterns)
    if kept.get(name, {}).get("of") != of:
        said = probe(fp3)
        if said is None:
            return None
        kept[name] = {"of": of, "said": by + hashlib.sha256("\n".join(said).encode()).hexdigest()[:16]}
        KEPT.parent.mkdir(parents=True, exist_ok=True)
        temporary = KEPT.with_name(f"{KEPT.name}.{os.getpid()}")
        temporary.write_text(json.dumps(kept), encoding="utf-8")
        os.replace(temporary, KEPT)
    return kept[name]["said"]
