"""Scenes of programs/world, as they are and changed: run by the command, and what their objects hold in every bit."""

import hashlib
import itertools
import os
import pathlib
import re
import subprocess
import tomllib

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = ROOT / "programs/world"
STATE = re.compile(r"^(\S+) +\S+ +((?:0x[0-9a-f]{8} )+)  object (\d+)$", re.M)  # two words in double-single


# What an engine cannot do, and says so: no error of the scene.
LIMITS = ("room for", "no room")


class Failed(Exception):
    """A run that fp3 refuses or that fails."""

    def is_limit(self):
        return any(limit in str(self) for limit in LIMITS)


def names():
    return sorted(path.stem for path in FOLDER.glob("*.scene"))


def text_of(name, folder=FOLDER):
    """The text of a scene in the folder, which may stand in any other."""
    text = (folder / f"{name}.scene").read_text(encoding="utf-8")
    return re.sub(r'(\b(?:program|points|file|params) *= *")([^/"][^"]*")', lambda found: f"{found[1]}{folder}/{found[2]}", text)


def replace(text, old, new):
    """Exactly one place, or the scene is no longer the one that is meant."""
    if len(re.findall(old, text)) != 1:
        raise Failed(f"'{old}' is in the scene {len(re.findall(old, text))} times, expected once")
    return re.sub(old, lambda _: new, text)


def add(text, setting):
    """Another setting of its only group."""
    return replace(text, r"groups = \( \{", f"groups = ( {{ {setting}")


def put(folder, text, name="x"):
    path = pathlib.Path(folder) / f"{name}.scene"
    path.write_text(text, encoding="utf-8")
    return path


def call(fp3, path, *options, fast=None):
    """What fp3 run prints."""
    environment = {**os.environ, **({"FP3_FAST": fast} if fast else {})}
    try:
        done = subprocess.run([fp3, "run", "--scene", path, *map(str, options)], capture_output=True, text=True, env=environment)
    except OSError as why:
        raise Failed(f"{fp3}: {why.strerror}") from why
    if done.returncode:
        raise Failed(done.stderr.strip().splitlines()[-1] if done.stderr.strip() else f"exit code {done.returncode}")
    return done.stdout


def words_of(said):
    """[object, state] in the order of the program, and the states' names. Recorded hashes are without the one state of two words that adaptive steps have, t."""
    columns, count, found = {}, {}, [(name, words.split(), number) for name, words, number in STATE.findall(said)]
    least = min((len(words) for _, words, _ in found), default=0)
    for name, words, number in found:
        for word, bits in enumerate(words if len(words) == least else ()):
            columns.setdefault(name + word * "_low", []).append(int(bits, 16))
            count.setdefault(name + word * "_low", []).append(int(number))
    if not columns or any(numbers != list(range(len(numbers))) for numbers in count.values()) or len({len(c) for c in columns.values()}) != 1:
        raise Failed("fp3 run --all prints no state of each object")
    return np.array(list(columns.values()), dtype=np.uint32).T, list(columns)


def all_words(said):
    """All words of a scene of several groups, whose objects hold states of their own, in the order of the objects."""
    found = STATE.findall(said)
    numbers = [int(number) for *_, number in found]
    if not found or sorted(set(numbers)) != list(range(numbers[-1] + 1)) or numbers != sorted(numbers):
        raise Failed("fp3 run --all prints no state of each object")
    return np.array([int(bits, 16) for _, words, _ in found for bits in words.split()], dtype=np.uint32)


def words(fp3, path, engine, steps, threads=1, fast=None, config=None):
    """All words of all states in the end, as [object, state]; those of several groups in a row."""
    options = ["--engine", engine, "--steps", steps, "--all", *(["--threads", threads] if engine == "fast" else []), *(["--config", config] if config else [])]
    said = call(fp3, path, *options, fast=fast)
    if fast and not re.search(fr"; {'' if fast == 'interpreter' else 'native '}{fast}\b", said):
        raise Failed(f"'{said.strip().splitlines()[-1]}': expected a run by {fast}")
    return words_of(said)[0] if len(re.findall(r"^group \d", said, re.M)) < 2 else all_words(said)


def hash_of(found):
    return hashlib.sha256(np.ascontiguousarray(found, dtype="<u4").tobytes()).hexdigest()[:16]


def differing(found, wanted):
    return int((found != wanted).sum()) if found.shape == wanted.shape else max(found.size, wanted.size)


# ---- grids ----

def grid_ways(kinds, axes):
    """From an object to those of higher numbers that it is linked with, in the order of sw/world/grid.c."""
    kind_of = {(1, 1): "structural", (2, 2): "shear", (3, 3): "shear", (1, 4): "bending"}
    for z, y, x in itertools.product(range(3), range(-2, 3), range(-2, 3)):
        way = (x, y, z)[:axes]
        if (z, y, x) > (0, 0, 0) and not any((x, y, z)[axes:]) and kind_of.get((sum(map(bool, way)), sum(d * d for d in way))) in kinds:
            yield way


def grid_links(count, spacing, kinds):
    """The two objects of each link, and its length on the grid, in the order of the scene."""
    numbers = np.arange(int(np.prod(count)))
    at = np.array(np.unravel_index(numbers, count[::-1]))[::-1]
    links = []
    for order, way in enumerate(grid_ways(kinds, len(count))):
        to = at + np.array(way)[:, None]
        inside = ((to >= 0) & (to < np.array(count)[:, None])).all(0)
        length = np.float32(np.sqrt(sum((d * spacing) ** 2 for d in way)))
        links += zip(numbers[inside].tolist(), [order] * int(inside.sum()), np.ravel_multi_index(to[::-1, inside], count[::-1]).tolist(), itertools.repeat(float(length)))
    return [(a, b, length) for a, _, b, length in sorted(links)]


# ---- recordings ----

def record(fp3, path, *options):
    """What is observed, by name, as [time, object], and the times."""
    output = path.with_suffix(".csv")
    call(fp3, path, "--engine", "fast", "--output", output, *options)
    with open(output, encoding="utf-8") as file:
        head = [re.sub(r" \[.*", "", name) for name in file.readline().strip().split(",")]
        rows = np.loadtxt(file, delimiter=",", ndmin=2)
    output.unlink()
    columns = dict(zip(head, rows.T))
    objects = int(columns["object"].max()) + 1
    found = {name: column.reshape(-1, objects) for name, column in columns.items()}
    return found, found["time"][:, 0]


def vectors(found, name):
    """[time, object, component]."""
    return np.stack([found[f"{name}_{axis}"] for axis in "xyz"], -1)


def worlds():
    """The configurations whose objects may see each other, and have the same words: not those with another arithmetic, and no second time
    those with a port to memory or with lists of their own, whose lanes are the same."""
    found = tomllib.loads((ROOT / "isa/configs.toml").read_text(encoding="utf-8"))["config"]
    ieee = {"arithmetic": "ieee", "reciprocal": "estimate", "fraction": 23}
    return [keys["name"] for keys in found if keys.get("neighbours") and not keys.get("master") and not keys.get("keep") and all(keys.get(name, value) == value for name, value in ieee.items())]


def kinds():
    """Of processors for which engine fast has code, as this one can run it: the best one is what nobody asks for."""
    flags = pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").split()
    return ["x86-64"] + ["x86-64-v3"] * ("avx2" in flags) + ["x86-64-v4"] * ("avx512vl" in flags)
