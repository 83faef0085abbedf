"""Double-single where objects see each other: against the same methods in longer arithmetic, against exact sums, at the reach of lists, and the same words
on every engine."""

import csv
import fractions
import io
import subprocess

import numpy
import pytest

ENGINES = [("isa", 1), ("fast", 2), ("rtl", 1)]    # beside fast with one thread
LONG = numpy.longdouble
DOUBLE = "double_single = true;"
SPRINGS = """
model springs
param m = 1.1
shared k = 7.3
state x[2] = (0, 0)
state v[2] = (0, 0)
links ties(rest = 0.1)
step 2^-10
F = sum(o in ties: k*(1 - o.rest/norm(o.x - x))*(o.x - x))
x' = v
v' = F/m
"""
BODIES = """
model bodies
param m = 1.1
state x[2] = (0, 0)
state v[2] = (0, 0)
all others
step 2^-10
x' = v
v' = sum(o in others: o.m*(o.x - x)/norm(o.x - x)^3)
"""
PLACES = numpy.array([[0, 0, 0.3, -0.2], [0.13, 0.02, -0.1, 0.1], [0.19, 0.11, 0.2, 0.3], [0.33, 0.07, -0.4, -0.2]])


def given(value):
    """A number as a program in double-single has it."""
    high = numpy.float32(value)
    return LONG(high) + LONG(numpy.float32(LONG(value) - LONG(high)))


@pytest.fixture
def words(start, folder):
    """What a scene prints, and its last snapshot as rows of numbers."""
    def words(model, points, *options, engine="fast", threads=1, settings="", steps=64, integrator="leapfrog", every=None):
        (folder / "m.ode").write_text(model)
        (folder / "points.csv").write_text(points)
        (folder / "x.scene").write_text(f'steps = {steps};\n'
                                        f'groups = ( {{ program = "m.ode"; integrator = "{integrator}"; points = "points.csv"; {settings} }} );\n')
        done = start("--scene", "x.scene", "-e", engine, *(["--threads", threads] if engine == "fast" else []), "--all", "--output", "x.csv",
                     *(["--every", every] if every else []), *options)
        assert done.returncode == 0, done.stderr
        rows = list(csv.DictReader(io.StringIO((folder / "x.csv").read_text())))
        return [line for line in done.stdout.splitlines() if "   object " in line], rows
    return words


def csv_of(names, rows):
    return "\n".join([",".join(names), *(",".join(repr(float(value)) for value in row) for row in rows)]) + "\n"


def numbers(rows, names, count):
    """Of the last snapshot."""
    return numpy.array([[float(row[name]) for name in names] for row in rows[-count:]])


def springs_force(x, m):  # pylint: disable=unused-argument
    f = numpy.zeros_like(x)
    for i, rest in ((0, 0.1), (1, 0.07), (2, 0.13)):
        way = x[i + 1] - x[i]
        pull = given(7.3)*(1 - given(rest)/numpy.sqrt((way*way).sum()))*way
        f[i] += pull
        f[i + 1] -= pull
    return f


def bodies_force(x, m):
    f = numpy.zeros_like(x)
    for i, j in ((i, j) for i in range(len(x)) for j in range(len(x)) if i != j):
        way = x[j] - x[i]
        f[i] += m[i]*m[j]*way/numpy.sqrt((way*way).sum())**3
    return f


def in_long(force, rows, m, integrator, steps, h=LONG(2)**-10):
    x, v = rows[:, :2].copy(), rows[:, 2:].copy()
    for _ in range(steps):
        if integrator == "leapfrog":
            x = x + h/2*v
            v = v + h*force(x, m)/m[:, None]
            x = x + h/2*v
            continue
        k = [(v, force(x, m)/m[:, None])]
        for share in (LONG(0.5), LONG(0.5), LONG(1)):
            k.append((v + share*h*k[-1][1], force(x + share*h*k[-1][0], m)/m[:, None]))
        x, v = (now + h/6*(k[0][i] + 2*k[1][i] + 2*k[2][i] + k[3][i]) for i, now in enumerate((x, v)))
    return numpy.hstack([x, v])


@pytest.mark.parametrize("integrator", ["leapfrog", "rk4"])
@pytest.mark.parametrize("model, force, count", [(SPRINGS, springs_force, 4), (BODIES, bodies_force, 3)], ids=["springs", "bodies"])
def test_the_error_is_that_of_48_bits(words, folder, model, force, count, integrator):
    """1e4 times smaller than that of floats, and momentum changes by roundings of velocities alone, 3 u^2 of each in a step."""
    names = ["x_x", "x_y", "v_x", "v_y"]
    masses = [1.1, 0.7, 1.9, 1.3][:count]
    places = PLACES[:count]*([1, 1, 1, 1] if model == SPRINGS else [8, 8, 1, 1])
    points = csv_of([*names, "m"], numpy.hstack([places, numpy.array(masses)[:, None]]))
    (folder / "ties.csv").write_text("a,b,rest\n0,1,0.1\n1,2,0.07\n2,3,0.13\n")
    links = 'links = { relation = "ties"; file = "ties.csv"; };' if model == SPRINGS else ""
    m = numpy.array([given(mass) for mass in masses])
    begin = numpy.array([[given(value) for value in row] for row in places])
    wanted = in_long(force, begin, m, integrator, 64)
    error = {}
    for settings in (links, links + DOUBLE):
        expected = words(model, points, settings=settings, integrator=integrator)
        found = numbers(expected[1], names, count)
        error[settings] = float(abs(found - wanted).max())
        if settings.endswith(DOUBLE):
            momentum = (m[:, None]*(found[:, 2:] - begin[:, 2:])).sum(0)
            assert (abs(momentum) < 64*3*2.0**-48*(m[:, None]*abs(found[:, 2:])).sum(0)).all(), momentum
            for engine, threads in ENGINES[:3 if integrator == "leapfrog" else 1]:
                assert words(model, points, engine=engine, threads=threads, settings=settings, integrator=integrator) == expected, engine
    assert error[links + DOUBLE] < 1e-4*error[links] and error[links + DOUBLE] < 1e-12, error


SUMS = """
model sums
param q = 1
state total = 0
state least = 0
state most = 0
state many = 0
state is = 0
all others
step 1
total' = sum(o in others: o.q) - total
least' = min(o in others: o.q, q) - least
most' = max(o in others: o.q, q) - most
many' = count(o in others: o.q > q) - many
is' = any(o in others: o.q > q) - is
"""


def test_folds_of_a_hundred_terms(words):
    """Terms of all sizes that cancel, against exact sums: 3 (1 + 2^-20) u^2 for each addition. Numbers that differ in their second words alone are in order."""
    random = numpy.random.default_rng(11)
    half = random.standard_normal(50)*2.0**random.integers(-20, 20, 50)
    given_to = {"cancel": numpy.concatenate([half, -half*(1 + 2.0**-30*random.integers(-8, 8, 50))]), "close": 1 + 2.0**-44*random.permutation(100)}
    for name, q in given_to.items():
        q = numpy.array([float(given(value)) for value in q])
        points = csv_of(["q"], q[:, None])
        expected = words(SUMS, points, settings=DOUBLE, steps=1, integrator="euler")
        rows = expected[1][-100:]
        exact = [fractions.Fraction(value) for value in q]
        for i, row in enumerate(rows):
            others = exact[:i] + exact[i + 1:]
            bound = 3*(1 + 2.0**-20)*2.0**-48*sum(float(abs(sum(others[:k + 1]))) for k in range(99)) + 2.0**-48*float(abs(sum(others)))
            assert abs(float(sum(others) - fractions.Fraction(float(row["total"])))) <= bound, (name, i)
            assert float(row["least"]) == min(q) and float(row["most"]) == max(q)
            assert int(float(row["many"])) == (q > q[i]).sum() and float(row["is"]) == (q > q[i]).any()
        assert words(SUMS, points, engine="isa", settings=DOUBLE, steps=1, integrator="euler") == expected
        few = csv_of(["q"], q[40:60, None])
        found = [words(SUMS, few, engine=engine, threads=threads, settings=DOUBLE, steps=1, integrator="euler") for engine, threads in ENGINES]
        assert all(one == found[0] for one in found)


NEAR = """
model cells
state x = 0
state v = 0
state n = 0
near touch(x, 0.0001)
step 1
x' = v
v' = 0
n' = count(o in touch) - n
"""


def pairs_at_the_reach():
    """Two and two, 1 or 2^10 units from 0, where first words are farther apart than the reach; each second one leaves or comes, 2^-35 in a step."""
    rows = []
    for i, at in enumerate([1000.0, -1010.0, 3.0, 1030.0, -5.0, 1050.0, 2000.0, 0.25]):
        way = -1 if i % 2 else 1
        rows += [[at, 0, 0], [at + 0.0001 - way*2.0**-35*(i % 5 + 0.5), way*2.0**-35, 0]]
    return rows


@pytest.mark.parametrize("skin", [0, 0.3, 20])
def test_nobody_within_the_reach_is_missed(words, skin):
    begin = [[fractions.Fraction(float(given(value))) for value in row] for row in pairs_at_the_reach()]
    points = csv_of(["x", "v", "n"], begin)
    expected = words(NEAR, points, settings=f"{DOUBLE} skin = {float(skin)};", steps=6, integrator="euler", every=1)
    reach = fractions.Fraction(float(given(0.0001)))
    changes = set()
    for row in expected[1]:
        i, step = int(row["object"]), int(row["step"])
        if step:
            of = [at[0] + (step - 1)*at[1] for at in begin]
            near = sum(abs(of[i] - other) < reach for k, other in enumerate(of) if k != i)
            assert int(float(row["n"])) == near, (i, step)
            changes.add((i, near))
    assert len(changes) > len(begin)    # some come, some go
    for engine, threads in ENGINES if skin == 0.3 else ENGINES[:1]:
        assert words(NEAR, points, engine=engine, threads=threads, settings=f"{DOUBLE} skin = {float(skin)};", steps=6, integrator="euler", every=1) == expected


def test_who_is_in_the_list_beyond_the_reach_changes_no_bit(words):
    """Of an object alone a sum is +0, and it is with others in its list."""
    model = NEAR.replace("v' = 0", "v' = sum(o in touch: o.x - x)").replace("0.0001", "0.5")
    points = csv_of(["x", "v"], [[0, -0.0], [0.7, -0.0], [1.6, 0], [1.9, -0.0], [9, -0.0]])
    found = {tuple(words(model, points, engine=engine, settings=f"{DOUBLE} skin = {skin};", steps=8)[0])
             for skin, engine in (("0.0", "isa"), ("0.5", "fast"), ("100.0", "rtl"), ("100.0", "fast"))}
    assert len(found) == 1


MEMORY = """
model memory
param m = 1.1
state x = 0
state v = 0
state w = 0
links ties(k = 7.3, s = 0.1)
step 2^-10
F = sum(o in ties: o.k*(o.x - x) + o.s)
x' = v
v' = F/m
w' = 0
repeat 3
    project w = w + 0.25*sum(o in ties: o.w - w) + 0.1*h*(x - prev(x))
end
when sum(o in ties: o.x) > 0.34: v = 0.75*v
remember o in ties: o.s = o.s + h*(o.v - v)
"""


def test_what_pairs_remember_and_what_is_repeated_has_48_bits(words):
    rows = numpy.array([[0.1, 0.3, 0.7], [0.35, -0.1, 0.2]])
    names = ["x", "v", "w"]
    points = csv_of(names, rows)
    x, v, w = (numpy.array([given(value) for value in column]) for column in rows.T)
    h, s = LONG(2)**-10, given(0.1)*numpy.ones(2, LONG)
    for _ in range(48):
        before = x
        x = x + h/2*v
        v = v + h*(given(7.3)*(x[::-1] - x) + s)/given(1.1)
        x = x + h/2*v
        for _ in range(3):
            w = w + (w[::-1] - w)/4 + given(0.1)*h*(x - before)
        v = numpy.where(x[::-1] > given(0.34), LONG(0.75)*v, v)
        s = s + h*(v[::-1] - v)
    settings = DOUBLE + 'links = { relation = "ties"; file = "ties.csv"; };'

    def run(engine, threads):
        return words(MEMORY, points, engine=engine, threads=threads, settings=settings, steps=48)
    expected = run("fast", 1)
    assert abs(numbers(expected[1], names, 2) - numpy.array([x, v, w]).T).max() < 1e-12
    assert all(run(engine, threads) == expected for engine, threads in ENGINES)


@pytest.fixture(autouse=True)
def ties(folder):
    (folder / "ties.csv").write_text("a,b\n0,1\n")


SUN = """
model {name}
kind {other}(m, x[2])
param m = 1.1
state x[2] = (0, 0)
state v[2] = (0, 0)
all others({other})
step 2^-10
F = m*sum(o in others: o.m*(o.x - x)/norm(o.x - x)^3)
x' = v
v' = F/m
"""


def kinds(folder, start, engine, both=(DOUBLE, DOUBLE)):
    groups = []
    for name, other, row, mass, double in (("suns", "moons", PLACES[0], 1.3, both[0]), ("moons", "suns", PLACES[2], 0.7, both[1])):
        (folder / f"{name}.ode").write_text(SUN.format(name=name, other=other))
        (folder / f"{name}.csv").write_text(csv_of(["x_x", "x_y", "v_x", "v_y", "m"], [[*row, mass]]))
        groups.append(f'{{ program = "{name}.ode"; integrator = "leapfrog"; points = "{name}.csv"; {double} }}')
    (folder / "k.scene").write_text(f"steps = 64; groups = ( {', '.join(groups)} );\n")
    return start("--scene", "k.scene", "-e", engine, "--all")


def test_kinds_read_both_words_of_each_other(start, folder):
    said = {engine: kinds(folder, start, engine) for engine in ("isa", "fast", "rtl")}
    assert all(done.returncode == 0 for done in said.values()), said["isa"].stderr
    lines = {engine: [line for line in done.stdout.splitlines() if "   object " in line] for engine, done in said.items()}
    assert lines["isa"] == lines["fast"] == lines["rtl"]
    found = numpy.array([float(line.split()[1]) for line in lines["isa"]]).reshape(2, 4)
    begin = numpy.array([[given(value) for value in row] for row in PLACES[[0, 2]]])
    m = numpy.array([given(1.3), given(0.7)])
    assert abs(found - in_long(bodies_force, begin, m, "leapfrog", 64)).max() < 1e-12
    assert abs((m[:, None]*(found - begin)[:, 2:]).sum(0)).max() < 1e-13


def test_kinds_of_one_form(start, folder):
    done = kinds(folder, start, "fast", (DOUBLE, ""))
    expected = "group 'suns' is in double-single, and group 'moons' is not: kinds that see each other have words of one form"
    assert done.returncode == 2 and expected in done.stderr


SPEEDS = """
model speeds
state x = 0
state v = 0
state m = 0
all others
step 2^-7
x' = v
v' = sum(o in others: o.x - x)
m' = 0
project m = sum(o in others: o.v)
"""


@pytest.mark.parametrize("integrator", ["leapfrog", "rk4"])
@pytest.mark.parametrize("engine", ["isa", "rtl"])
def test_what_others_see_is_made_before_they_read_it(words, integrator, engine):
    """A speed that nobody needs as a pair until others see it; of three objects two see the sum of all speeds but their own."""
    points = csv_of(["x", "v"], [[0.1, 1], [0.5, -0.3], [1.7, 0.2]])
    lines, rows = words(SPEEDS, points, settings=DOUBLE, integrator=integrator, engine=engine)
    assert lines == words(SPEEDS, points, settings=DOUBLE, integrator=integrator)[0]
    v, m = (numpy.array([float(row[name]) for row in rows[-3:]]) for name in "vm")
    assert abs(m - (v.sum() - v)).max() < 1e-13 and abs(v - [1, -0.3, 0.2]).min() > 0.01


def test_what_does_not_fit(fp3, tmp_path):
    (tmp_path / "cloth.ode").write_text(SPRINGS.replace("[2] = (0, 0)", "[3] = (0, 0, 0)"))
    done = subprocess.run([fp3, "compile", "cloth.ode", "--double-single", "-i", "rk4"], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2 and "object registers, configuration 'world' has 64" in done.stderr
