"""The command in WebAssembly: the same words as the other one's, and what it has not, it says."""

import os
import subprocess

import pytest


@pytest.fixture(scope="session")
def wasm(root):
    """Runs it with arguments, in a directory."""
    path, python = root / "build/wasm/fp3.wasm", root / ".venv/bin/python"
    if not path.exists():
        pytest.skip("no build/wasm/fp3.wasm: make setup-playground playground")

    def wasm(cwd, *words):
        clean = {name: value for name, value in os.environ.items() if not name.startswith("FP3_")}
        return subprocess.run([python, root / "tools/wasi.py", path, *map(str, words)], cwd=cwd, env=clean, capture_output=True, text=True, timeout=120)
    return wasm


@pytest.mark.parametrize("words", [
    ["compile", "programs/pendulum.ode", "-i", "rk4", "-c", "many_full"],
    ["compile", "programs/kepler.ode", "-c", "many_full", "--report"],
    ["run", "tests/everywhere/overflow.ode", "-c", "many_full", "-e", "isa", "-N", 3, "-n", 40, "--spread", "a=1:1e6"],
    ["run", "programs/ship.s", "-e", "isa", "-n", 9, "--params", "programs/ship.cfg"],
    ["run", "programs/kepler.ode", "-e", "isa", "--set", "mu=none"],
    ["run", "--scene", "programs/bodies/car.scene", "--steps", 20],
    ["run", "--scene", "programs/bodies/heap.scene", "--steps", 5, "-e", "isa"],
    ["run", "nowhere.ode", "-e", "isa"],
    ["run", "programs/kepler.ode", "--hepl"],
    ["run", "programs/kepler.ode", "programs/lorenz.ode"],
    ["frobnicate"],
    ["--version"]])
def test_it_says_what_the_other_says(wasm, fp3, root, words):
    def said(done):
        keep = [line for line in done.stdout.splitlines() if not line.startswith(("simulator", "time"))]
        return done.returncode, keep, done.stderr
    here = subprocess.run([fp3, *map(str, words)], cwd=root, capture_output=True, text=True, timeout=120)
    assert said(wasm(root, *words)) == said(here)


def test_a_mistake_has_its_place_and_writes_nothing(wasm, tmp_path):
    (tmp_path / "a.ode").write_text("state x = 1\nx' = -x + * 2\nstep 1\n")
    done = wasm(tmp_path, "run", "a.ode", "-e", "isa", "--output", "a.csv")
    assert done.returncode == 2 and "a.ode:2:11: " in done.stderr, done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["a.ode"]


@pytest.mark.parametrize("words, code, expected", [
    (["run", "k.ode"], 1, "loads no libraries"),
    (["run", "k.ode", "-e", "isa", "--output", "k.h5"], 1, "no library for HDF5 files"),
    (["run", "k.ode", "-e", "isa", "--plot", "k.svg"], 1, "cannot start gnuplot"),
    (["run", "k.ode", "-e", "isa", "--output", "-"], 2, "name a file"),
    (["run", "k.ode", "-e", "board", "--port", "/dev/ttyUSB0"], 1, "no serial ports"),
    (["compile", "k.ode", "-c", "many_full", "--native", "-o", "k.so"], 1, "native code"),
    *[([name], 1, "not in WebAssembly") for name in ("compare", "view", "tune", "bench", "stress", "board")]])
def test_what_it_has_not_it_says(wasm, root, tmp_path, words, code, expected):
    (tmp_path / "k.ode").write_bytes((root / "programs/kepler.ode").read_bytes())
    done = wasm(tmp_path, *words)
    assert done.returncode == code and expected in done.stderr, done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["k.ode"]


def test_help_lists_options(wasm, root):
    done = wasm(root, "run", "--help")
    assert done.returncode == 0 and "Usage: fp3 run [OPTION...] PROGRAM\n  or:  fp3 run [OPTION...] --scene FILE" in done.stdout
    assert "--double-single" in done.stdout and "-i, --integrator=NAME" in done.stdout
