"""`pip install .` as others use it: a wheel of this platform, in an environment of its own, away from the sources."""

import os
import subprocess
import sys
import zipfile

import pytest

# It builds in the directory of make install.
pytestmark = pytest.mark.xdist_group("install")


def succeeds(*command, **options):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=900, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def clean():
    """An environment in which nothing but an installation can be found."""
    return {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "FP3_HOME", "FP3_RTL_DIR", "MAKEFLAGS", "MFLAGS", "MAKELEVEL", "FP3_BUILD")}


@pytest.fixture(scope="module")
def wheel(root, clean, tmp_path_factory):
    pytest.importorskip("setuptools", reason="no setuptools: make setup-packages installs it")
    pytest.importorskip("wheel", reason="no wheel: make setup-packages installs it")
    where = tmp_path_factory.mktemp("wheel")
    before = set(root.iterdir())
    succeeds(sys.executable, "-m", "pip", "wheel", root, "--no-build-isolation", "--no-deps", "--no-index", "-w", where, env=clean)
    assert set(root.iterdir()) - before <= {root / "build"}, "setup.py writes below build/ alone"
    return next(where.glob("*.whl"))


@pytest.fixture(scope="module")
def installed(wheel, clean, tmp_path_factory):
    where = tmp_path_factory.mktemp("venv")
    succeeds(sys.executable, "-m", "venv", "--system-site-packages", where, env=clean)
    succeeds(where / "bin/python", "-m", "pip", "install", "--no-index", "--no-deps", wheel, env=clean)
    return where / "bin/python"


def test_the_wheel_is_of_this_platform_and_any_python(wheel):
    assert wheel.name.startswith("fp3-0.1.0-py3-none-linux_")
    names = zipfile.ZipFile(wheel).namelist()
    assert {"fp3/py.typed", "fp3/_declarations.py", "fp3/_native/lib/libfp3.so.0", "fp3/_native/bin/fp3", "fp3/_native/lib/fp3/fp3_single_full.so"} <= set(names)
    assert not [name for name in names if not name.startswith(("fp3/", "fp3-0.1.0.dist-info/"))]


def test_it_runs_elsewhere_with_the_bits_of_the_command(installed, clean, root, tmp_path, ran):
    text = f"""
import fp3, numpy as np
assert "site-packages" in fp3.__file__
solution = fp3.solve_ivp({str(root / 'programs/kepler.ode')!r}, (0, 1), {{"v_y": np.linspace(1.6, 1.8, 5)}})
print(*solution.y[:, 2, -1])
hardware = fp3.solve_ivp({str(root / 'programs/kepler.ode')!r}, (0, 1), engine="rtl", config="single_full")
print(*hardware.y[:, -1])
print(all(row["holds"] for row in fp3.stress("state x = 1\\nstep 0.125\\nspan 1\\nx' = -x\\n", quick=True)))
"""
    lines = succeeds(installed, "-c", text, env=clean, cwd=tmp_path).splitlines()
    expected = ran("kepler", "-e", "isa", "-c", "many_full", "-N", 5, "-n", 64, "--spread", "v_y=1.6:1.8")[-1]
    single = ran("kepler", "-e", "isa", "-n", 64)[-1]
    assert [f"{float(word):.9g}" for word in lines[0].split()] == [f"{value:.9g}" for value in expected["r_x"]]
    assert [f"{float(word):.9g}" for word in lines[1].split()] == [f"{single[name][0]:.9g}" for name in ("v_x", "v_y", "r_x", "r_y")]
    assert lines[2] == "True"
