"""A reach for each pair of two kinds: the words of one reach with a condition, on every engine; what is refused."""

import numpy
import pytest

# Balls see plates, which stay where they are or, in the second scene, are pushed back.
BALLS = """model balls
kind plates(x[2] [m], {words})
param R = 0.05 [m]
shared far = 3 [m]
shared rate = 900 [1/s^2]
state x[2] = (0, 0) [m]
state v[2] = (0, 0) [m/s]
near touch(x, plates.x, {reach}{fields})
step 0.0009765625 [s]
F = sum(o in touch: {condition}(1 - ({sum})/norm(o.x - x))*(o.x - x){otherwise})
x' = v
v' = rate*F
{remember}
"""
PLATES = """model plates
kind balls(x[2] [m], R [m])
{kind} {declared} = 0.3 [m]
shared rate = 900 [1/s^2]
shared one = 1 [s]
shared most = 0.3 [m]
state x[2] = (0, 0) [m]
state v[2] = (0, 0) [m/s]
near touch(x, balls.x, {back})
step 0.0009765625 [s]
x' = v
v' = rate*sum(o in touch: (1 - ({back})/norm(o.x - x))*(o.x - x))
{rest}
"""
SUMS = {"R + o.R": "R + o.R", "o.R + far/8 + R": "R + o.R + far/8", "o.R": "o.R", "R": "R", "R + far/8": "R + far/8", "far/8 + o.R": "o.R + far/8"}
SCENE = """steps = 48;
groups = ( { program = "balls.ode"; integrator = "leapfrog"; points = "balls.csv"; },
           { program = "plates.ode"; integrator = "leapfrog"; points = "plates.csv"; } );
"""


@pytest.fixture
def write(folder):
    def write(reach, is_one=False, remember="", kind="param", declared="R", back="R + o.R"):
        total = SUMS.get(reach, reach)
        far = f"dot(o.x - x, o.x - x) < ({total})*({total})"
        words = {"words": "R [m]", "reach": "far" if is_one else reach, "sum": total, "condition": f"{far} ? " if is_one else "",
                 "otherwise": " : (-0.0, -0.0)" if is_one else "", "fields": ", s = 0 [1]" if remember else "",
                 "remember": f"remember o in touch: o.s = {far + ' ? o.s + 1 : 0' if is_one else 'o.s + 1'}" if remember else ""}
        if remember:
            words["condition"] += "(1 + o.s)*"
        rest = "R' = 0*R/one" if kind == "state" else ""
        (folder / "balls.ode").write_text(BALLS.format(**words))
        (folder / "plates.ode").write_text(PLATES.format(kind=kind, declared=declared, rest=rest, back=back))
        random = numpy.random.default_rng(5)
        for name, count, radii in (("balls", 40, 0.01*10**random.uniform(0, 2, 40)), ("plates", 20, numpy.where(random.random(20) < 0.8, 0.02, 0.8))):
            columns = "x_x,x_y" + (",R" if kind == "param" or name == "balls" else "")
            rows = [f"{x},{y}" + (f",{r}" if "R" in columns else "") for x, y, r in zip(random.uniform(0, 1.5, count), random.uniform(0, 1.5, count), radii)]
            (folder / f"{name}.csv").write_text("\n".join([columns, *rows]) + "\n")
    return write


@pytest.mark.parametrize("reach", SUMS)
def test_each_form_has_the_words_of_one_reach(write, record, reach):
    write(reach, is_one=True)
    wanted = record(SCENE, "--group", "balls", "--engine", "isa")
    write(reach)
    engines = [("--engine", "isa"), ("--engine", "fast", "--threads", "2")] + ([("--engine", "rtl")] if reach == "o.R + far/8 + R" else [])
    for options in engines:
        assert record(SCENE, "--group", "balls", *options) == wanted, options
    assert any(row["v_x"] for row in wanted[-1])


def test_skins(write, record):
    write("R + o.R")
    wanted = record(SCENE, "--group", "balls", "--engine", "isa")
    for skin in ("0.01", "2.0"):
        assert record(SCENE.replace('csv"; }', f'csv"; skin = {skin}; }}'), "--group", "balls", "--engine", "fast") == wanted


def test_what_pairs_remember(write, record):
    write("R + o.R", is_one=True, remember=True)
    wanted = record(SCENE, "--group", "balls", "--engine", "isa")
    write("R + o.R", remember=True)
    assert record(SCENE, "--group", "balls", "--engine", "fast") == record(SCENE, "--group", "balls", "--engine", "isa") == wanted


def test_a_word_that_is_a_state_is_refused(write, refused):
    write("R + o.R", kind="state", back="o.R + most")
    assert "'R' is a state in the model of group 'plates', and a reach changes with params alone" in refused(SCENE)


def test_a_shared_word(write, record, refused):
    write("R + o.R", kind="shared")
    assert record(SCENE, "--group", "balls", "--engine", "isa") == record(SCENE, "--group", "balls", "--engine", "fast")


@pytest.mark.parametrize("reach", ["2*R + o.R", "R*o.R", "R + R"])
def test_other_forms_are_refused(write, refused, reach):
    write(reach)
    assert "to which a param of either object may be added, as in R + o.R" in refused(SCENE)


def test_a_radius_below_0_is_refused(write, start, folder):
    write("R + o.R")
    (folder / "plates.csv").write_text("x_x,x_y,R\n0,0,1\n1,1,-0.5\n")
    (folder / "x.scene").write_text(SCENE)
    assert start("--scene", "x.scene").stderr == "fp3 run: group 1: object 1 adds -0.5 to the reach of 'touch': expected 0, or 2^-50 to 2^61\n"
