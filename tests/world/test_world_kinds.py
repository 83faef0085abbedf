"""Objects of two groups that see each other have the words, and fail like, one group that has them all."""

import subprocess

import pytest

ENGINES = ["isa", "fast", "fast-interpreted", "rtl", "rtl@fabric", "isa@world_log", "fast@world_log", "rtl@world_log", "fast@world_bfloat"]


def run(build, *arguments):
    done = subprocess.run([build / "tests/world_kinds", *map(str, arguments)], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0 and "differing 0" in done.stdout, done.stdout + done.stderr
    return done.stdout


def seeds(engine, long, hardware, software):
    """Half of them on eight lanes (all), which are simulated slowly."""
    count = hardware if engine.startswith("rtl") else software
    return range(1, 1 + (count if long or engine != "rtl@fabric" else (count + 1) // 2))


@pytest.mark.parametrize("engine", ENGINES)
def test_words(build, long, engine):
    for seed in seeds(engine, long, 4, 20):
        run(build, engine, 6, seed)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("how, why", [("far", "object 0 in step 1"), ("same", "invalid, at the same place as object 15")])
def test_failures(build, engine, how, why):
    assert why in run(build, engine, 3, 1, how)


@pytest.mark.parametrize("engine", ENGINES)
def test_births_and_ends(build, long, engine):
    for seed in seeds(engine, long, 3, 15):
        run(build, engine, 9, seed, "lives")


@pytest.mark.parametrize("engine", ENGINES)
def test_pairs_of_another_kind_are_forgotten(build, long, engine):
    for seed in seeds(engine, long, 2, 5):
        run(build, engine, 3, seed, "turn")


@pytest.mark.parametrize("engine", ["isa", "fast", "rtl"])
def test_words_that_all_objects_compare(build, engine):
    """By hand, of -1, 3 and 2 in one group and -7 and 0.5 in the other: the largest x, and the largest -x, for all; stored in other phases, refused."""
    done = subprocess.run([build / "tests/world_worst", engine], capture_output=True, text=True, timeout=120)
    why = "group 0: phase 0 stores the .worst 'other', and that of group 1 does not: objects of all groups compare it"
    assert done.stdout.splitlines() == [" ".join(["3,7"] * 5)] * 2 + [why], done.stdout + done.stderr
