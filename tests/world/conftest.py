"""Scenes of objects that see each other: run, and what they hold."""

import csv
import shutil
import re
import subprocess

import pytest


@pytest.fixture
def folder(root, tmp_path):
    """The models of programs/world, to write scenes beside."""
    for path in (root / "programs/world").iterdir():
        shutil.copy(path, tmp_path)
    return tmp_path


@pytest.fixture
def start(fp3, folder):
    def start(*arguments):
        return subprocess.run([fp3, "run", *map(str, arguments)], cwd=folder, capture_output=True, text=True, timeout=300)
    return start


@pytest.fixture
def record(start, folder):
    """What each object holds in the end, by name, or at several times: lists of dictionaries. Text is a scene, else it is a file's name."""
    def record(scene, *options):
        name = scene
        if "\n" in scene or "=" in scene:
            (folder / "x.scene").write_text(scene)
            name = "x.scene"
        done = start("--scene", name, "--output", "x.csv", *options)
        assert done.returncode == 0, done.stderr
        head, *rows = list(csv.reader((folder / "x.csv").open()))
        names = [word.split(" ")[0] for word in head]
        snapshots = {}
        for row in rows:
            one = dict(zip(names, map(float, row)))
            snapshots.setdefault(one["step"], []).append(one)
        return list(snapshots.values())
    return record


@pytest.fixture
def refused(start, folder):
    """The message about a scene, behind the file's name."""
    def refused(scene, *options):
        (folder / "x.scene").write_text(scene)
        done = start("--scene", "x.scene", *options)
        assert done.returncode == 2, done.stdout + done.stderr
        assert done.stderr.startswith("fp3 run: x.scene:"), done.stderr
        return done.stderr[len("fp3 run: x.scene:"):].strip()
    return refused


@pytest.fixture
def together(start, folder):
    """What each object holds in the end: of each name a list of words, all groups in a row. Or what is said, if the run fails."""
    def run(*groups, engine="fast", code=0):
        for i, (model, _) in enumerate(groups):
            (folder / f"{i}.ode").write_text(model)
        told = ", ".join(f'{{ program = "{i}.ode"; {settings} }}' for i, (_, settings) in enumerate(groups))
        (folder / "m.scene").write_text(f"groups = ( {told} );\n")
        done = start("--scene", "m.scene", "--engine", engine, "--all")
        assert done.returncode == code, done.stdout + done.stderr
        words = {}
        for name, word, low in re.findall(r"^(\w+) +\S+ +0x([0-9a-f]{8})(?: 0x([0-9a-f]{8}))?   object \d+$", done.stdout, re.M):
            words.setdefault(name, []).append(word + low)
        return done.stderr if code else words
    return run
