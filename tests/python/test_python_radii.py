"""A reach for each pair, `near touch(x, R + o.R)`: the words of one reach for all with a condition, on every engine; who is near; what is refused."""

import subprocess

import fp3
import numpy
import pytest

MODEL = """model gravel
param  R = 0.05 [m]
param  m = 0.01 [kg]
shared stiff = 100 [N/m]
shared gap = 0.01 [m]
shared drag = 0.1 [kg/s]
shared far = 4 [m]
state x[2] = (0, 0) [m]
state v[2] = (0, 0) [m/s]
near touch(x, {reach}{fields})
{rest}
step 0.0009765625 [s]
pull = sum(o in touch: {condition}stiff*(1 - (R + o.R + gap)/norm(o.x - x))*(o.x - x){otherwise}) - drag*v
x' = v
v' = pull/m
{remember}
"""
PAIR = {"reach": "R + o.R + gap", "condition": "", "otherwise": ""}
ONE = {"reach": "far", "condition": "dot(o.x - x, o.x - x) < (R + o.R + gap)*(R + o.R + gap) ? ", "otherwise": " : (-0.0, -0.0)"}
NONE = {"fields": "", "rest": "", "remember": ""}
NAMES = ["x_x", "x_y", "v_x", "v_y"]


def text(form, **more):
    return MODEL.format(**{**NONE, **form, **more})


def stones(seed, n):
    """Most are gravel, a few are boulders, and radii go over three decades; some have none."""
    random = numpy.random.default_rng(seed)
    radii = numpy.where(random.random(n) < 0.9, 0.02, 0.002*10**random.uniform(0, 3, n))*(random.random(n) > 0.05)
    side = 0.08*n**0.5
    return {"x_x": random.uniform(0, side, n), "x_y": random.uniform(0, side, n), "v_x": random.normal(0, 0.3, n), "v_y": random.normal(0, 0.3, n),
            "R": radii, "m": 0.01 + 10*radii**2}


def run(model, values, n, steps=24, parts=2, config=None, change=None, **options):
    with fp3.Batch(fp3.Model(model) if isinstance(model, str) else model, n, method="leapfrog", config=config or "world", **options) as batch:
        for name, value in values.items():
            batch[name] = value
        for part in range(parts):
            if part and change:
                change(batch)
            batch.run(steps // parts)
        return numpy.array([batch.read(name) for name in NAMES]).tobytes()


def grow(batch):
    """Between runs: a pebble becomes a boulder, and another one a point."""
    radii = batch.read("R")
    radii[[3, 5]] = 1.5, 0
    batch["R"] = radii


def test_lists_are_those_of_a_search_over_all(build):
    done = subprocess.run([build / "tests/world_radii"], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout.split(",")[1]) == (0, " 0 wrong"), done.stdout


@pytest.mark.parametrize("seed, n, usual", [(1, 60, "isa"), (2, 300, "fast"), (3, 300, "fast")])  # from 256 on engine fast puts objects in order
def test_a_reach_for_each_pair_changes_no_bit(seed, n, usual):
    values = stones(seed, n)
    pair, one = fp3.Model(text(PAIR)), fp3.Model(text(ONE))
    wanted = run(one, values, n, engine=usual, change=grow)
    for options in ({"engine": usual}, {"engine": "fast", "threads": 1}, {"engine": "fast", "threads": 2}, {"engine": "fast", "threads": 2, "skin": 3.0},
                    {"engine": usual, "skin": 0.01}):
        assert run(pair, values, n, change=grow, **options) == wanted, options
    assert wanted != run(one, values, n, engine=usual)


def test_on_hardware():
    values = stones(4, 40)
    assert run(text(PAIR), values, 40, steps=6, engine="rtl", change=grow) == run(text(ONE), values, 40, steps=6, engine="isa", change=grow)


@pytest.mark.parametrize("config", ["world_log", "world_bfloat"])
def test_in_other_arithmetic(config):
    values = stones(5, 60)
    wanted = run(text(PAIR), values, 60, steps=8, config=config, engine="isa")
    assert run(text(ONE), values, 60, steps=8, config=config, engine="isa", skin=0.5) == wanted
    assert run(text(PAIR), values, 60, steps=8, config=config, engine="fast", skin=2.0) == wanted


def test_who_is_near():
    values = stones(6, 400)
    with fp3.Batch(fp3.Model(text(PAIR)), 400) as batch:
        for name, value in values.items():
            batch[name] = value
        x, radii = numpy.array([batch.read("x_x"), batch.read("x_y")], dtype=float), batch.read("R").astype(float)
        square = ((x[:, :, None] - x[:, None, :])**2).sum(0)
        reach = radii[:, None] + radii[None, :] + float(numpy.float32(0.01))
        wanted = numpy.argwhere(numpy.triu(square < reach**2, 1))
        assert len(wanted) > 300
        assert numpy.array_equal(numpy.array(batch.pairs("touch")).T, wanted)
        assert len(batch.contacts("touch").began_a) == len(wanted)
        assert len(batch.pairs("touch", 0.05)[0]) == numpy.triu(square < 0.05**2, 1).sum()


def test_pairs_remember():
    more = {"fields": ", s = 0 [1]", "remember": "remember o in touch: o.s = {}o.s + 1{}"}
    values = stones(7, 80)
    got = {}
    for name, form, condition, otherwise in (("pair", PAIR, "", ""), ("one", ONE, ONE["condition"], " : 0")):
        model = text(form, **more).replace("{}o.s + 1{}", f"{condition}o.s + 1{otherwise}").replace(
            "stiff*(1", "(1 + o.s)*stiff*(1")
        got[name] = [run(model, values, 80, engine=engine, **options) for engine, options in (("isa", {}), ("fast", {"threads": 2}))]
    assert len(set(got["pair"] + got["one"])) == 1


def test_objects_that_rest_wake_by_the_reach_of_the_pair():
    """A boulder that moves wakes gravel at the distance of both radii; with the reach of gravel it would wake none."""
    more = {"rest": "rest when norm(v) < 0.001 for 0.01"}
    n = 40
    x = numpy.append(numpy.arange(n - 1)*0.2, 3.0)
    values = {"x_x": x, "x_y": numpy.append(numpy.zeros(n - 1), 3.0), "v_x": 0.0, "v_y": numpy.append(numpy.zeros(n - 1), -8.0),
              "R": numpy.append(numpy.full(n - 1, 0.05), 1.5), "m": numpy.append(numpy.full(n - 1, 1), 1e4)}
    got = []
    for engine, options in (("isa", {}), ("fast", {"threads": 2}), ("fast", {"skin": 4.0})):
        with fp3.Batch(fp3.Model(text(PAIR, **more)), n, method="semi_implicit_euler", config="world", engine=engine, **options) as batch:
            for name, value in values.items():
                batch[name] = value
            batch.run(64)
            asleep = batch.read("at_rest")
            batch.run(192)
            got.append((tuple(asleep), tuple(batch.read("at_rest")), batch.read("v_y").tobytes()))
    assert len(set(got)) == 1
    before, after, _ = got[0]
    assert before.count(-1) == n - 1 and 3 < before.count(-1) - after.count(-1) < n - 5, (before, after)


def test_births():
    n = 30
    values = stones(8, n)
    got = set()
    for form, engine in ((PAIR, "isa"), (PAIR, "fast"), (ONE, "isa")):
        with fp3.Batch(fp3.Model(text(form)), n, method="leapfrog", config="world", engine=engine, empty=True) as batch:
            batch.add(20, **{name: value[:20] for name, value in values.items()})
            batch.run(6)
            batch.remove(batch.handles[[2, 7]])
            batch.run(6)
            batch.add(1, x_x=0.2, x_y=0.2, R=0.3)
            batch.run(6)
            got.add(numpy.array([batch.read(name) for name in NAMES])[:, [*range(7), *range(8, 20)]].tobytes())
    assert len(got) == 1


REFUSED = {
    "2*R + o.R": "expected a distance in the unit of 'x', of numbers and shared params, to which one param of both objects may be added, as in R + o.R",
    "R": "to which one param of both objects may be added, as in R + o.R",
    "R + o.mass": "one param of both objects", "R + R": "one param of both objects", "R - o.R": "one param of both objects", "R*o.R": "one param of both objects",
    "R + o.x.x": "expected a param of the neighbour ('x_x' is a state: who is near is found before a step, by what the step does not change)",
    "R + o.q": "expected a name that is defined above", "R + o.m": "two values with the same unit"}


@pytest.mark.parametrize("reach", REFUSED)
def test_other_reaches_are_refused(reach):
    with pytest.raises(fp3.Error) as caught:
        fp3.Model(text({**PAIR, "reach": reach}).replace("param  m =", "param  mass = 1 [m]\nparam  m ="))
    assert REFUSED[reach] in str(caught.value)


@pytest.mark.parametrize("radius", [-0.25, 2.0**-52, 2.0**62])
@pytest.mark.parametrize("engine", ["isa", "fast"])
def test_what_cannot_be_added_is_refused_by_the_object(radius, engine):
    with fp3.Batch(fp3.Model(text(PAIR)), 4, engine=engine, config="world") as batch:
        batch["x_x"] = numpy.arange(4.0)
        batch["R"] = [0.1, 0, 2.0**-50, radius]
        with pytest.raises(fp3.Error, match="object 3 adds .* to the reach of 'touch': expected 0, or 2.-50 to 2.61"):
            batch.run()
        with pytest.raises(fp3.Error, match="'R' of object 3 is .*: expected 0, or 2.-50 to 2.61"):
            batch.pairs("touch")
        batch["R"] = [0.1, 0, 2.0**-50, 0]
        batch.run()
        batch["R"] = [0.1, 0, 2.0**-50, 2.0**61]
        assert [list(numbers) for numbers in batch.pairs("touch")] == [[0, 1, 2], [3, 3, 3]]
