"""Worlds of bodies by chance (random_bodies.c says what is checked): nothing crashes, what fails is named, energy is not made, and bits are those of
all engines."""

import subprocess

import pytest


def worlds(build, *words):
    done = subprocess.run([build / "tests/random_bodies", *map(str, words)], capture_output=True, text=True, timeout=3000)
    assert done.returncode == 0, done.stderr
    words = done.stdout.split()
    return words[1::3], words[2::3].count("1")


@pytest.mark.parametrize("first, count", [(0, 150), (7615, 1), pytest.param(1000, 10000, marks=pytest.mark.long)])
def test_worlds_by_chance(build, first, count):
    """7615: a thin body turns by 18 degrees in a substep as it meets the ground."""
    hashes, gained = worlds(build, first, count)
    failed = hashes.count("0" * 16)
    assert len(hashes) == count and failed <= 0.01 * count + 2
    assert gained <= 0.0005 * count  # of joined bodies, in each fourth world
    assert len(set(hashes)) > 0.98 * (count - failed)


@pytest.mark.parametrize("first, count", [(0, 12), pytest.param(1000, 1000, marks=pytest.mark.long)])
def test_a_checkpoint_in_the_middle(build, tmp_path, first, count):
    """The world that is opened from it makes the same steps."""
    assert len(set(worlds(build, first, count, "-", tmp_path / "w.ck")[0])) > 0.9 * count


def test_engines_agree(build):
    for first, count in ((3, 4), (172, 1)):  # 172: a body turns far in a step
        assert worlds(build, first, count, "isa") == worlds(build, first, count, "fast") == worlds(build, first, count, "built-in")
