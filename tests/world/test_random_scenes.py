"""Scenes with many features at once have the same words on every engine, with any threads, skin and number of processes, and after a restart."""

import random
import shutil

import pytest
import random_scenes


def several(build):
    return (2, 3) if shutil.which("mpirun") and (build / "lib/fp3/fp3_mpi.so").exists() else ()


@pytest.mark.parametrize("count", [3, pytest.param(200, marks=pytest.mark.long)])
def test_everything_at_once(fp3, build, tmp_path, count):
    """Fresh seeds each time; a message has the seed."""
    tried = 0
    for seed in random.sample(range(10 ** 9), 2 * count):
        try:
            if tried < count:
                differ = random_scenes.disagree(fp3, random_scenes.Scene(seed, tmp_path / str(seed)), several(build))
                assert differ == [], f"seed {seed}: python3 tests/world/random_scenes.py build/fp3 {seed} 1"
                tried += 1
        except random_scenes.TooMuch:
            pass
    assert tried == count
