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


@pytest.mark.parametrize("place, accepted", [("tests/fuzz/seeds/*", 2), ("programs/*.ode", 8)])
def test_the_seeds_are_models(build, root, place, accepted):
    """The fuzzer needs accepted models to start from."""
    files = sorted(root.glob(place))
    assert len(files) >= accepted
    for file in files:
        got = subprocess.run([build / "tests" / "language", "model", file], capture_output=True, timeout=60)
        assert (got.returncode, got.stderr) == (0, b""), file
