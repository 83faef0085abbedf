"""examples/back.ode: a planet goes forward, its velocity is turned, and it comes back to the same bits."""

import pathlib

import numpy as np
import pytest

import fp3

ROOT = pathlib.Path(__file__).resolve().parents[2]
BACK = (ROOT / "examples/back.ode").read_text(encoding="utf-8")
STATES = ["v_x", "v_y", "r_x", "r_y"]


def there_and_back(model, steps, objects=16, fastest=0.55, grids=2.0 ** 22, **options):
    """The states at the start, in the middle and at the end, with v turned once more."""
    planets = fp3.Batch(model, objects, h=2.0 ** -6, **options)
    e = np.linspace(0, fastest, objects)
    for name, start in (("r_x", 1 - e), ("v_y", np.sqrt((1 + e) / (1 - e)))):
        planets.write(name, np.round(start * grids) / grids)
    states = [planets.read(STATES)]
    for _ in range(2):
        planets.run(steps)
        states.append(planets.read(STATES))
        planets.write("v_x", -planets.read("v_x"))
        planets.write("v_y", -planets.read("v_y"))
    return states[0], states[1], planets.read(STATES)


@pytest.fixture(scope="module")
def middle():
    return there_and_back(BACK, 300)[1]


@pytest.mark.parametrize("options", [{"engine": "isa", "config": "many_full"}, {"engine": "fast", "config": "fused_full"}, {"engine": "rtl", "config": "many_full"},
                                     {"engine": "fast", "threads": 2}], ids=["isa", "fused", "rtl", "threads"])
def test_it_comes_back_bit_for_bit(middle, options):
    start, there, end = there_and_back(BACK, 300, **options)
    assert np.array_equal(start, end) and not np.array_equal(start, there)
    if options.get("config") != "fused_full":  # another arithmetic goes another way, and comes back, too
        assert np.array_equal(there, middle)


def test_it_comes_back_from_far(long):
    start, _, end = there_and_back(BACK, 1000000 if long else 30000)
    assert np.array_equal(start, end)


def test_leapfrog_does_not():
    start, _, end = there_and_back((ROOT / "programs/kepler.ode").read_text(encoding="utf-8"), 1000, method="leapfrog")
    assert not np.array_equal(start, end)


def test_a_way_that_is_cut_off_is_not_symmetric():
    """`cell` rounds towards 0, so -y is not rounded to the grid as y is."""
    start, _, end = there_and_back(BACK, 1000, config="cell")
    assert not np.array_equal(start, end)


def test_who_starts_off_the_grid_does_not():
    start, _, end = there_and_back(BACK, 1000, grids=2.0 ** 24)
    assert not np.array_equal(start, end)


@pytest.mark.parametrize("engine", ["isa", "fast"])
def test_beyond_the_grid_it_fails(engine):
    with pytest.raises(fp3.FailedError, match="overflow"):
        there_and_back(BACK, 2000, objects=2, fastest=0.95, engine=engine)
