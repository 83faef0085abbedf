"""The package from the sources, over the library and the command of the build."""

import csv
import os
import pathlib
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("FP3_BUILD", ROOT / "build"))
os.environ["FP3_HOME"] = str(BUILD)
sys.path.insert(0, str(ROOT / "python"))


def pytest_collection_modifyitems(items):
    """A library with sanitizers cannot be loaded by a Python without them: LD_PRELOAD=$(gcc -print-file-name=libasan.so)."""
    for item in items:
        if BUILD.name != "build" and "libasan" not in os.environ.get("LD_PRELOAD", "") and pathlib.Path(item.fspath).parent == pathlib.Path(__file__).parent:
            item.add_marker(pytest.mark.skip("sanitizers have to be there before Python"))


@pytest.fixture(scope="session")
def environment():
    """Of a Python of its own that imports the package."""
    return {**os.environ, "PYTHONPATH": str(ROOT / "python")}


@pytest.fixture
def python(environment, tmp_path):
    """Runs a text in a Python of its own; what it printed."""
    def python(text, status=0, **options):
        done = subprocess.run([sys.executable, "-c", text], cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=300, **options)
        assert done.returncode == status, done.stdout + done.stderr
        return done.stdout
    return python


@pytest.fixture
def ran(fp3, root, tmp_path):
    """{name: rows of objects} for each time, as `fp3 run` writes them."""
    def ran(model, *options, status=0):
        out = tmp_path / "run.csv"
        path = root / "programs" / f"{model}.ode" if "/" not in str(model) else model
        done = subprocess.run([fp3, "run", path, "--output", out, *map(str, options)], capture_output=True, text=True, timeout=300)
        assert done.returncode == status, done.stderr
        head, *rows = list(csv.reader(out.open()))
        names = [word.split(" ")[0] for word in head]
        table = {}
        for row in rows:
            of = dict(zip(names, row))
            for name in names:
                table.setdefault((int(of["step"]), name), []).append(float(of[name]))
        steps = sorted({step for step, _ in table})
        return [{name: table[step, name] for name in names} for step in steps]
    return ran
