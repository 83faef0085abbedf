"""Short runs of the command whose output decides a figure: the words that a compiler makes, the hash of a scene.

A source may change and its program not. So a figure about a program depends on the program's words, not on the compiler's text. What a
probe said is kept in build/evidence/ for as long as the command and the probed files are the same.
"""

import collections
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
CONSTANT = re.compile(r"^localparam +(?:\[\S+\] +)?(\w+) *=[^;\n]*;[^\n]*\n", re.M)
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


def modules_of(top):
    """The modules that are left of a top once its parameters are known, by Icarus Verilog."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "x.vvp"
        done = subprocess.run(["iverilog", "-g2012", "-c", "rtl/fp3.f", "-s", top.stem, "-o", path, top], cwd=ROOT, capture_output=True, text=True)
        if done.returncode:
            raise Failed(f"iverilog {top}: {done.stderr.strip()}")
        return set(re.findall(r'^S_\w+ \.scope module, "[^"]*" "(\w+)"', path.read_text(encoding="utf-8"), re.M)) - {top.stem}


def with_headers(paths):
    """Sources, and what they include, and so on."""
    found, left = set(), set(paths)
    headers = {path.name: path for path in ROOT.glob("rtl/**/*.vh")}
    while left:
        found |= left
        named = {name for path in left for name in re.findall(r'^\s*`include\s+"(?:[^"]*/)?(\w+\.vh)"', path.read_text(encoding="utf-8"), re.M)}
        left = {headers[name] for name in named} - found
    return sorted(found)


def without_unused(texts):
    """Without the constants of headers that are named nowhere else: those of parts that a configuration does not have."""
    count = collections.Counter(word for text in texts for word in re.findall(r"\w+", text))
    return [CONSTANT.sub(lambda line: "" if count[line[1]] == 1 else line[0], text) for text in texts]


@functools.cache
def described():
    from fp3gen.read import load
    return load(ROOT)


def hardware(config):
    """The sources that a configuration is made of, and no others: another one's parts may change."""
    def probe(_):
        if not shutil.which("iverilog"):
            return None
        import tops
        from fp3evidence import inputs
        machine = described()
        row = next(row for row in machine.configs if row["name"] == config)
        with tempfile.TemporaryDirectory() as made:
            top = tops.write(row, machine, pathlib.Path(made))
            modules = modules_of(top)
            folders = re.findall(r"^-y (\S+)", (ROOT / "rtl/fp3.f").read_text(encoding="utf-8"), re.M)
            files = with_headers(path for folder in folders for path in (ROOT / folder).glob("*.v") if path.stem in modules)
            texts = [path.read_text(encoding="utf-8") for path in (top, *files)]
            return [f"{path.name} {inputs.bare(path.name, text)}" for path, text in zip((top, *files), without_unused(texts))]
    return probe, ("rtl/**/*.v", "rtl/**/*.vh", "rtl/fp3.f", "isa/*.toml", "tools/tops.py", "tools/fp3gen/*.py")


# Name, what it does, and the files that it reads beside the command.
PROBES = {
    "words of models": (compiled(words_of_models), ("programs/*.ode", "programs/integrators/*")),
    "words of scenes": (compiled(words_of_scenes), ("programs/world/*", "programs/bodies/*.ode")),
    "hashes everywhere": (hashes_everywhere, ("programs/**/*", "tests/everywhere/*", "tools/everywhere.py")),
    "hashes of bodies": (hashes_of_bodies, ("tools/fp3bodies/*.py",)),
} | {f"hardware {name}": hardware(name) for name in CONFIGS} \
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
    probe, patterns = PROBES[name]
    try:
        kept = json.loads(KEPT.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        kept = {}
    of = key(fp3, patterns)
    if kept.get(name, {}).get("of") != of:
        said = probe(fp3)
        if said is None:
            return None
        kept[name] = {"of": of, "said": hashlib.sha256("\n".join(said).encode()).hexdigest()[:16]}
        KEPT.parent.mkdir(parents=True, exist_ok=True)
        temporary = KEPT.with_name(f"{KEPT.name}.{os.getpid()}")
        temporary.write_text(json.dumps(kept), encoding="utf-8")
        os.replace(temporary, KEPT)
    return kept[name]["said"]
