"""Every input that the fuzzer has found, without the fuzzer: nothing crashes, hangs or breaks a promise.

Under `make SAN=1 test` the same with sanitizers and their leak check.
"""

import subprocess

import pytest

pytestmark = pytest.mark.smoke

PLACES = ["tests/fuzz/corpus/*", "tests/fuzz/seeds/*", "programs/*.ode"]


@pytest.mark.parametrize("place", PLACES)
def test_each_file_keeps_the_promises(build, root, place):
    files = sorted(root.glob(place))
    assert files
    got = subprocess.run([build / "tests" / "fuzz_model", *files], capture_output=True, text=True,
                         errors="replace", timeout=120)
    last = got.stderr.splitlines()[-5:]
    assert got.returncode == 0, f"{got.returncode}: {last}"
    assert got.stdout == f"{len(files)} files\n"


READERS = {"assembly": "programs/*.s", "image": None, "integrator": "programs/integrators/*.cfg", "params": "programs/*.cfg", "links": "programs/world/*.csv",
           "scene": "programs/world/*.scene", "packet": None}


@pytest.mark.parametrize("reader", READERS)
def test_the_other_readers_keep_theirs(build, root, reader):
    """Assembly, images, integrators, values, links, scenes, and the line of a board."""
    files = sorted(root.glob(f"tests/fuzz/readers/{reader}/*"))
    assert len(files) >= 10
    files += sorted(root.glob(READERS[reader])) if READERS[reader] else []
    got = subprocess.run([build / "tests" / "fuzz_reader", reader, *files], cwd=root, capture_output=True, text=True, errors="replace", timeout=120)
    assert got.returncode == 0, f"{got.returncode}: {got.stderr.splitlines()[-5:]}"
    assert got.stdout == f"{len(files)} files\n"


def test_there_is_no_other_reader(build):
    got = subprocess.run([build / "tests" / "fuzz_reader", "hdf5"], capture_output=True, text=True)
    assert got.returncode == 2 and f"no reader 'hdf5': there are {' '.join(READERS)}" in got.stderr


@pytest.mark.parametrize("place, accepted", [("tests/fuzz/seeds/*", 2), ("programs/*.ode", 8)])
def test_the_seeds_are_models(build, root, place, accepted):
    """The fuzzer needs accepted models to start from."""
    files = sorted(root.glob(place))
    assert len(files) >= accepted
    for file in files:
        got = subprocess.run([build / "tests" / "language", "model", file], capture_output=True, timeout=60)
        assert (got.returncode, got.stderr) == (0, b""), file
