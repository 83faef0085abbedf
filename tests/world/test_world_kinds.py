"""Objects of two groups that see each other have the words, and fail like, one group that has them all."""

import subprocess

import pytest

ENGINES = ["isa", "fast", "fast-interpreted", "rtl", "fabric"]


def run(build, *arguments):
    done = subprocess.run([build / "tests/world_kinds", *map(str, arguments)], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0 and "differing 0" in done.stdout, done.stdout + done.stderr
    return done.stdout


@pytest.mark.parametrize("engine", ENGINES)
def test_words(build, long, engine):
    for seed in range(1, {"rtl": 5, "fabric": 5 if long else 3}.get(engine, 21)):
        run(build, engine, 6, seed)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("how, why", [("far", "object 0 in step 1"), ("same", "invalid, at the same place as object 15")])
def test_failures(build, engine, how, why):
    assert why in run(build, engine, 3, 1, how)


@pytest.mark.parametrize("engine", ENGINES)
def test_births_and_ends(build, long, engine):
    for seed in range(1, {"rtl": 4, "fabric": 4 if long else 3}.get(engine, 16)):
        run(build, engine, 9, seed, "lives")


@pytest.mark.parametrize("engine", ENGINES)
def test_pairs_of_another_kind_are_forgotten(build, long, engine):
    for seed in range(1, {"rtl": 3, "fabric": 3 if long else 2}.get(engine, 6)):
        run(build, engine, 3, seed, "turn")
