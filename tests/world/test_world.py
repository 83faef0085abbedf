"""Objects that see each other: the same words on every engine, the equations' own solution, and what is refused."""

import itertools
import math
import subprocess

import numpy
import pytest

CHAIN = """
param m = 2 [kg]
state x = 0 [m]
state v = 0 [m/s]
links springs(k = 100 [N/m], rest = 0.5 [m])
step 0.01 [s]
F = sum(o in springs: o.k*(o.x - x - o.rest))
x' = v
v' = F/m
"""
CLOTH = """
param w = 1000 [1/kg] "inverse of the mass"
shared mg[3] = (0, -0.00981, 0) [N]
shared c = 0.003 [N*s/m]
state x[3] = (0, 0, 0) [m]
state v[3] = (0, 0, 0) [m/s]
links springs(k = 10 [N/m], rest = 0.1 [m])
step 0.001 [s]
F = sum(o in springs: o.k*(1 - o.rest/norm(o.x - x))*(o.x - x) + c*(o.v - v))
x' = v
v' = w*(F + mg)
"""
STARS = """
param m = 1
shared soft = 0.05
state x[2] = (0, 0)
state v[2] = (0, 0)
all others
step 0.01
a = sum(o in others: o.m/(dot(o.x - x, o.x - x) + soft^2)^1.5*(o.x - x))
x' = v
v' = a
"""
BALLS = """
shared R = 0.05 [m]
shared stiff = 100 [N/m]
shared damp = 0.05 [N*s/m]
param m = 0.01 [kg]
state x[3] = (0, 0, 0) [m]
state v[3] = (0, 0, 0) [m/s]
near touch(x, 2*R)
step 0.001 [s]
F = sum(o in touch: stiff*(norm(o.x - x) - 2*R)/norm(o.x - x)*(o.x - x) + damp*(o.v - v))
x' = v
v' = F/m
"""
# Two relations in one equation, and a sum in the term's factor: two loops of a phase, one after the other.
MIXED = """
param m = 1
state x = 0
state v = 0
links ties(k = 1)
all others
step 0.01
p = sum(o in others: (o.x - x)/(1 + (o.x - x)^2))
F = sum(o in ties: o.k*(o.x - x)*(1 + p))
x' = v
v' = F/m + 0.1*p
"""
# Contacts by projections: an object moves out of its neighbours' way, then of the floor, then has the speed at which it came there.
PILE = """
shared R = 0.05 [m]
shared g = 9.81 [m/s^2]
state x[3] = (0, 0, 0) [m]
state v[3] = (0, 0, 0) [m/s]
near touch(x, 2*R)
step 0.001 [s]
x' = v
v' = (0, -g, 0)
project x = x + sum(o in touch: (0.5*(norm(o.x - x) - 2*R)/norm(o.x - x))*(o.x - x))/max(1, count(o in touch))
project x.y = max(x.y, R), x.z = any(o in touch: o.x.y < x.y) ? x.z : x.z + 0.001*R
project v = (x - prev(x))/h
"""


@pytest.fixture(scope="module")
def script(build, tmp_path_factory):
    """What the lines of a script print, on an engine."""
    def script(model, lines, engine="isa", integrator="leapfrog", arithmetic="plain", threads=1, status=0):
        path = tmp_path_factory.mktemp("world") / "model.ode"
        path.write_text(model)
        done = subprocess.run([build / "tests/world_script", engine, str(threads), path, integrator, arithmetic], input="\n".join(lines) + "\n",
                              capture_output=True, text=True, timeout=120)
        assert (done.returncode, done.stderr) == (status, ""), done.stdout + done.stderr
        return done.stdout.splitlines()
    return script


def floats(line):
    return numpy.array([int(word, 16) for word in line.split()], dtype=numpy.uint32).view(numpy.float32).astype(float)


def row(kind, name, values):
    return f"{kind} {name} " + " ".join(repr(float(numpy.float32(value))) for value in values)


def grid(n):
    """A cloth of n x n: positions a little off their places, and both entries of each link."""
    random = numpy.random.default_rng(7)
    at = numpy.array([(0.1 * (i % n), 0.1 * (i // n), 0) for i in range(n * n)]) + 0.004 * random.standard_normal((n * n, 3))
    links = []
    for i in range(n * n):
        for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1), (1, -1), (-1, 1), (2, 0), (-2, 0), (0, 2), (0, -2)):
            x, y = i % n + dx, i // n + dy
            if 0 <= x < n and 0 <= y < n:
                links.append((i, y * n + x, 10, numpy.float32(0.1 * numpy.hypot(dx, dy))))
    return at, links


def cloth(n):
    at, links = grid(n)
    w = [0 if i in (0, n - 1) else 1000 for i in range(n * n)]
    return [f"objects {n * n}", row("param", "w", w), *(row("state", f"x_{'xyz'[k]}", at[:, k]) for k in range(3)),
            *(f"links springs {a} {b} {k} {float(rest)!r}" for a, b, k, rest in links)]


def chain(n):
    ends = [(i, i + 1) for i in range(n - 1)]
    return [f"objects {n}", row("state", "x", [0.5 * i + 0.03 * (i * 7 % 5) for i in range(n)]), row("param", "over_m", [1 + 0.1 * (i % 3) for i in range(n)]),
            *(f"links springs {a} {b} 100 {0.5 if b > a else -0.5}" for pair in ends for a, b in (pair, pair[::-1]))]


def stars(n):
    random = numpy.random.default_rng(3)
    at, speed = random.uniform(-1, 1, (n, 2)), 0.1 * random.standard_normal((n, 2))
    return [f"objects {n}", row("param", "m", random.uniform(0.01, 0.1, n)), *(row("state", f"x_{'xy'[k]}", at[:, k]) for k in range(2)),
            *(row("state", f"v_{'xy'[k]}", speed[:, k]) for k in range(2)), "all others"]


def balls(n, skin=0.02):
    random = numpy.random.default_rng(5)
    at = numpy.array(list(itertools.islice(itertools.product(range(8), repeat=3), n))) * 0.095 + 0.002 * random.standard_normal((n, 3))
    return [f"objects {n}", *(row("state", f"x_{'xyz'[k]}", at[:, k]) for k in range(3)), f"near touch 0.1 {skin} x_x x_y x_z"]


def fliers(n, skin=0.02):
    """Balls that do not touch at first, and fly 0.3 m in 60 steps: who is near whom is another matter every few steps."""
    random = numpy.random.default_rng(6)
    at = numpy.array(list(itertools.islice(itertools.product(range(5), repeat=3), n))) * 0.15 + 0.01 * random.standard_normal((n, 3))
    speed = 3 * random.standard_normal((n, 3))
    return [f"objects {n}", *(row("state", f"{q}_{'xyz'[k]}", of[:, k]) for q, of in (("x", at), ("v", speed)) for k in range(3)),
            f"near touch 0.1 {skin} x_x x_y x_z"]


def mixed(n):
    return [f"objects {n}", row("state", "x", [0.3 * i + 0.01 * (i * i % 7) for i in range(n)]), "all others",
            *(f"links ties {i} {(i + k) % n} {1 + 0.1 * k}" for i in range(n) for k in range(1, 1 + i % 4))]


WORLDS = {"chain": (CHAIN, chain(21), "x v"), "cloth": (CLOTH, cloth(9), "x_x x_y x_z v_x v_y v_z"), "stars": (STARS, stars(37), "x_x x_y v_x v_y"),
          "balls": (BALLS, balls(75), "x_x x_y x_z v_x v_y v_z"), "mixed": (MIXED, mixed(19), "x v"), "pile": (PILE, balls(75), "x_x x_y x_z v_x v_y v_z")}


@pytest.mark.parametrize("integrator, arithmetic", [("euler", "plain"), ("leapfrog", "plain"), ("heun", "plain"), ("rk4", "plain"), ("verlet", "plain"),
                                                    ("rk4", "compensated"), ("leapfrog", "compensated")])
@pytest.mark.parametrize("name", WORLDS)
def test_engines_have_the_same_words(script, name, integrator, arithmetic):
    model, lines, states = WORLDS[name]
    lines = [*lines, "run 7", "run 16", f"print {states}", "failure"]
    wanted = script(model, lines, "isa", integrator, arithmetic)
    assert len(set(wanted[0].split())) > 5 and wanted[-1] == "none", wanted
    for engine, threads in (("fast", 1), ("fast", 3), ("interpreter", 1)):
        assert script(model, lines, engine, integrator, arithmetic, threads) == wanted, (engine, threads)


@pytest.mark.parametrize("kind", ["x86-64", "x86-64-v3"])
def test_lesser_processors_have_the_same_words(script, monkeypatch, kind):
    for name in ("cloth", "balls"):
        model, lines, states = WORLDS[name]
        lines = [*lines, "run 20", f"print {states}"]
        wanted = script(model, lines)
        monkeypatch.setenv("FP3_FAST", kind)
        assert script(model, lines, "fast") == wanted
        monkeypatch.delenv("FP3_FAST")


EXACT = """
param w = 1
state x = 0
state s = 0
links ties(k = 1)
step 1
x' = 0
s' = w*sum(o in ties: o.k*(o.x - x))
"""


def ties(seed, n):
    """Of each object none to 20 in any order, or as on a grid with holes. All is exact, and none who is at infinity sees another one there:
    so whoever takes a neighbour that is not his, or himself, raises invalid."""
    random = numpy.random.default_rng(seed)
    at = [math.inf if i and random.random() < 0.3 else 2.0 ** random.integers(4) * (1 + i % 7) for i in range(n)]
    lines = [f"objects {n}", row("state", "x", at), "links ties 0 1 1"]
    for i in range(n):
        if random.random() < (0, 0.3, 0.9)[seed % 3]:
            continue
        ways = [w for w in (-17, -16, -1, 1, 2, 16) if random.random() < 0.9] if seed % 2 else random.integers(-n, n, random.integers(21))
        others = [int(i + w) for w in ways if w and 0 <= i + w < n]
        lines += [f"links ties {i} {k} {2.0 ** (0 if seed % 5 else int(random.integers(-2, 3)))!r}" for k in others if min(at[k], at[i]) < math.inf]
    return lines


@pytest.mark.parametrize("kind", ["x86-64", "x86-64-v3", "x86-64-v4", "interpreter"])
def test_lists_of_any_kind(script, monkeypatch, kind):
    """With holes, with objects that have no neighbour, of the same fields or not: words, and flags. isa goes through them one by one."""
    monkeypatch.setenv("FP3_FAST", kind)
    for seed in range(40):
        lines = [*ties(seed, (2, 5, 16, 31, 48, 100, 333)[seed % 7]), "flags 1", "print x s", "flags 3", "print s"]
        assert script(EXACT, lines, "fast", "euler", threads=1 + seed % 2) == script(EXACT, lines, "isa", "euler"), seed


def test_a_list_is_stale_when_somebody_has_moved_by_half_the_skin(build):
    done = subprocess.run([build / "tests/world_near"], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (0, "624 checked, 0 wrong\n"), done.stdout


@pytest.mark.parametrize("kind", ["x86-64", "x86-64-v3", "x86-64-v4"])
@pytest.mark.parametrize("words", ["mul r, r, n", "add r, n, -0.0", "sub r, n, r", "max r, r, n", "min r, n, r"])
def test_a_loop_may_keep_more_than_folds(fp3, tmp_path, monkeypatch, words, kind):
    """The product of the neighbours, the last one, and what alternates; the largest and the smallest are folds. Object 0 has no neighbour and r = 3: with
    what another one of its vector sees, the product would overflow, which nobody raises. Then it sees it, too."""
    monkeypatch.setenv("FP3_FAST", kind)
    (tmp_path / "x.s").write_text(f".state x r\n.temp ties n\nstep:\nld x\nld r\nld ties\neach ties\nldn n, x\n{words}\nnext\nst r\n")
    points = [(i / 8, -1 if i % 5 else 2) for i in range(40)]
    points[0], points[7], points[8] = (1, 3), (1, 1), (3e38, 1)
    links = {(max(i, k), min(i, k)) for i in range(40) for k in ((i * n + n) % 40 for n in range(1, 1 + i % 5)) if not {0, 7, 8} & {i, k} and i != k}
    (tmp_path / "p.csv").write_text("x,r\n" + "".join(f"{x},{r}\n" for x, r in points))
    (tmp_path / "x.scene").write_text('config = "world"; groups = ( { program = "x.s"; points = "p.csv"; links = { relation = "ties"; file = "l.csv"; }; } );')
    for more in ({(8, 7)}, {(8, 7), (8, 0)}):
        (tmp_path / "l.csv").write_text("a,b\n" + "".join(f"{a},{b}\n" for a, b in sorted(links | more)))
        said = {}
        for engine in ("isa", "fast"):
            out = subprocess.run([fp3, "run", "--scene", tmp_path / "x.scene", "-e", engine, "--all"], capture_output=True, text=True)
            said[engine] = out.stdout + out.stderr
        assert f"native {kind}" in said["fast"], said["fast"]
        ends = {engine: [line for line in text.splitlines() if " 0x" in line or line.startswith("flags") or "failed" in line] for engine, text in said.items()}
        assert len(ends["isa"]) >= 81 and ends["isa"] == ends["fast"]
        assert ("overflow" in said["isa"]) == (words == "mul r, r, n" and len(more) > 1)


SEEN_BY_ALL = "state x = 0\nstate s = 0\nall others\nstep 1\nx' = 0\ns' = sum(o in others: o.x - x)\n"


@pytest.mark.parametrize("kind", ["x86-64", "x86-64-v3", "x86-64-v4"])
@pytest.mark.parametrize("n", [1, 2, 3, 16, 17, 33, 520])
def test_all_others_of_any_number(script, monkeypatch, kind, n):
    """Vectors that are not full, and in each of them the object that does not see itself."""
    lines = [*stars(n), f"run {2 if n > 100 else 9}", "print x_x x_y v_x v_y", "failure"]
    if n > 512:  # more than engine isa has room for
        wanted = script(STARS, lines, "interpreter")
    else:
        wanted = script(STARS, lines)
    monkeypatch.setenv("FP3_FAST", kind)
    for engine, threads in (("fast", 1), ("fast", 2), ("interpreter", 1)):
        assert script(STARS, lines, engine, threads=threads) == wanted, (engine, threads)
    for alone in {0, 1, 15, 16} if n == 17 else ():  # at infinity, so it would raise invalid if it saw itself, and nobody else does
        lines = [f"objects {n}", row("state", "x", [math.inf if i == alone else i for i in range(n)]), "all others", "flags 1", "print s"]
        assert script(SEEN_BY_ALL, lines, "fast", "euler") == script(SEEN_BY_ALL, lines, "isa", "euler"), alone


def test_time_and_other_integrators(script):
    """t in a term; stages that follow each other; many kicks and drifts."""
    driven = STARS.replace("a = sum(", "a = cos(3*t)*sum(")
    for integrator in ("rk4", "heun", "rkc8", "forest_ruth"):
        lines = [*stars(9), "run 4", "run 5", "print x_x v_y"]
        wanted = script(driven if integrator in ("rk4", "heun") else STARS, lines, "isa", integrator)
        for engine in ("fast", "interpreter"):
            assert script(driven if integrator in ("rk4", "heun") else STARS, lines, engine, integrator) == wanted, (integrator, engine)


@pytest.mark.parametrize("engine", ["isa", "fast", "interpreter", "rtl"])
def test_neighbours_see_also_what_a_phase_leaves_alone(script, engine):
    """Leapfrog's first phase moves x alone, and is done before neighbours read x and w: w goes to the other half of the store with x. All is exact."""
    model = "state x = 0\nstate v = 0\nstate w = 0\nlinks ties\nstep 1\nx' = v\nv' = sum(o in ties: o.x - x)\nw' = sum(o in ties: o.x - o.w)\n"
    x, v, w = [3, -2, 7], [2, 4, -6], [5, 1, 8]
    lines = ["objects 3", row("state", "x", x), row("state", "v", v), row("state", "w", w),
             *(f"links ties {a} {b}" for a, b in ((0, 1), (1, 2), (2, 0), (0, 2)))]
    for _ in range(3):
        x = [x[i] + v[i] / 2 for i in range(3)]
        sees = [(1, 2), (2,), (0,)]
        v, w = [[old[i] + sum(x[k] - of[k if of is w else i] for k in sees[i]) for i in range(3)] for old, of in ((v, x), (w, w))]
        x = [x[i] + v[i] / 2 for i in range(3)]
    assert [list(floats(line)) for line in script(model, [*lines, "run 2", "run 1", "print x v w"], engine)] == [x, v, w]


ENGINES = ["isa", "fast", "interpreter", "rtl"]
PROJECTED = """
state x = 0
state v = 0
state w = 0
links ties(k = 1)
step 1
x' = v
v' = 0
w' = sum(o in ties: o.x)
project x = x + sum(o in ties: o.k*(o.x - x))/4
project w = w + sum(o in ties: o.x - x), x = 2*x
project v = v - sum(o in ties: o.w)
"""


@pytest.mark.parametrize("engine", ENGINES)
def test_a_projection_sees_what_the_one_before_left_of_all_objects(script, engine):
    """Each is one more phase. All is exact."""
    x, v, w = [3, -2, 7, 1], [2, 4, -6, 8], [0, 0, 0, 0]
    links = [(0, 1, 2), (1, 2, 1), (2, 0, 4), (0, 2, 1)]
    lines = ["objects 4", row("state", "x", x), row("state", "v", v), *(f"links ties {a} {b} {k}" for a, b, k in links)]

    def total(term):
        return [sum(term(i, b, k) for a, b, k in links if a == i) for i in range(4)]
    for _ in range(3):
        w = [old + more for old, more in zip(w, total(lambda i, b, k: x[b]))]
        x = [old + speed for old, speed in zip(x, v)]
        x = [old + more / 4 for old, more in zip(x, total(lambda i, b, k: k * (x[b] - x[i])))]
        w, x = [old + more for old, more in zip(w, total(lambda i, b, k: x[b] - x[i]))], [2 * old for old in x]
        v = [old - less for old, less in zip(v, total(lambda i, b, k: w[b]))]
    for integrator in ("euler", "semi_implicit_euler"):
        found = [list(floats(line)) for line in script(PROJECTED, [*lines, "run 2", "run 1", "print x v w"], engine, integrator)]
        assert found == [x, v, w] or integrator != "euler"
        assert integrator == "euler" or found == [list(floats(line)) for line in script(PROJECTED, [*lines, "run 3", "print x v w"], "isa", integrator)]


EVENTS = """
state x = 0
state sick = 0
state late = 0
state r = 1
links ties(w = 1)
step 1
x' = r
r' = 0
sick' = 0
late' = 0
when root(sum(o in ties: o.w*(o.x - x)) - 20) falling: late = x
when sick == 0 and sum(o in ties: o.w*o.sick) >= 2: sick = 1, x = x - 8
when any(o in ties: o.sick > 0 and o.x < x): x = x + 16
"""


@pytest.mark.parametrize("engine", ENGINES)
def test_an_event_sees_what_the_one_before_left_of_all_objects(script, engine):
    """An illness that two sick neighbours, or one that counts twice, pass on; roots of sums. All is exact."""
    n = 20
    x, sick, late = [4 * (i * 5 % n) for i in range(n)], [int(i in (0, 5)) for i in range(n)], [0] * n
    links = [(i, (i + k) % n, w) for i in range(n) for k, w in ((1, 1), (2, 1), (7, 2)) if i % 4 != 3]
    rate = [1 + i % 3 for i in range(n)]
    lines = [f"objects {n}", *(row("state", name, of) for name, of in (("x", x), ("sick", sick), ("r", rate))), *(f"links ties {a} {b} {w}" for a, b, w in links)]

    def over(term):
        return [[term(a, b, w) for a, b, w in links if a == i] for i in range(n)]

    def root():
        return [sum(terms) - 20 for terms in over(lambda a, b, w: w * (x[b] - x[a]))]
    for _ in range(6):
        before, x = root(), [old + more for old, more in zip(x, rate)]
        late = [x[i] if was > 0 >= now else late[i] for i, (was, now) in enumerate(zip(before, root()))]
        falls = [not sick[i] and sum(terms) >= 2 for i, terms in enumerate(over(lambda a, b, w: w * sick[b]))]
        x, sick = [old - 8 * fall for old, fall in zip(x, falls)], [int(was or fall) for was, fall in zip(sick, falls)]
        x = [old + 16 * any(terms) for old, terms in zip(x, over(lambda a, b, w: sick[b] and x[b] < x[a]))]
    assert 2 < sum(sick) < n and any(late)
    assert [list(floats(line)) for line in script(EVENTS, [*lines, "run 2", "run 4", "print x sick late"], engine, "euler")] == [x, sick, late]


FOLDS = {  # of the differences to an object's neighbours
    "sum(o in {r}: o.x - x)": lambda d: sum(d), "count(o in {r})": len, "count(o in {r}: o.x - x > 2)": lambda d: sum(e > 2 for e in d),
    "any(o in {r}: o.x - x > 2)": lambda d: any(e > 2 for e in d), "any(o in {r})": lambda d: len(d) > 0,
    "min(o in {r}: o.x - x, 3)": lambda d: min([3, *d]), "max(o in {r}: o.x - x, -3)": lambda d: max([-3, *d]),
    "max(o in {r}: abs(o.x - x)*(o.x - x), 0) - min(o in {r}: o.x - x, 1e30)": lambda d: max([0, *(abs(e) * e for e in d)]) - min([float(numpy.float32(1e30)), *d])}


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("relation", ["links r", "near r(x, 4)", "all r"])
def test_folds_over_neighbours(script, engine, relation):
    """In an equation and in a projection, of objects with many neighbours and with none; a count of none is +0."""
    x = [0, 1, 1.5, 3.5, 7, 30, 100, 104, 103, -40] + [300 + 5 * i for i in range(20)]
    lines = [f"objects {len(x)}", row("state", "x", x)]
    if relation == "links r":
        links = sorted({(i, (i * k + k) % len(x)) for i in range(0, len(x), 2) for k in range(1, 1 + i % 5) if (i * k + k) % len(x) != i})
        lines += [f"links r {a} {b}" for a, b in links]
        seen = [[b for a, b in links if a == i] for i in range(len(x))]
    elif relation == "all r":
        lines += ["all r"]
        seen = [[b for b in range(len(x)) if b != i] for i in range(len(x))]
    else:
        lines += ["near r 4 1 x"]
        seen = [[b for b in range(len(x)) if b != i and abs(x[b] - x[i]) < 4] for i in range(len(x))]
    assert relation == "all r" or {len(others) for others in seen} > {0, 1}
    for k, (text, value) in enumerate(FOLDS.items()):
        fold = text.format(r="r")
        wanted = [float(value([x[b] - x[i] for b in others])) for i, others in enumerate(seen)]
        equation = f"s' = {fold}" if k % 2 else f"s' = 0\nproject s = {fold}"
        found = script(f"state x = 0\nstate s = 0\n{relation}\nstep 1\nx' = 0\n{equation}\n", [*lines, "run 1", "print s", "failure"], engine, "euler")
        assert (list(floats(found[0])), found[1]) == (wanted, "none"), text
        assert "80000000" not in found[0] or "min" in text or "max" in text or "sum" in text


@pytest.mark.parametrize("engine", ["isa", "fast", "interpreter"])
def test_zeros_and_nans_among_terms_do_not_depend_on_the_skin(script, engine):
    """Object 1 has a term of -0, object 2 a NaN; others are in the list and not near."""
    model = "state x = 0\nstate y = 0\nstate s = 0\nstate u = 0\nnear r(x, 4)\nstep 1\nx' = 0\ny' = 0\ns' = 0\nu' = 0\n" \
            "project s = min(o in r: o.y*o.y*o.y - o.y*o.y*o.y*o.y, 0), u = max(o in r: -o.y, -5)\n"
    lines = ["objects 6", row("state", "x", [0, 1, 2, 7, 8, 9]), row("state", "y", [1, 0, 3e38, 2, 1, 0])]
    found = {tuple(script(model, [*lines, f"near r 4 {skin} x", "run 1", "print s u"], engine, "euler")) for skin in (0, 5, 9)}
    assert len(found) == 1, found


# ---- the equations themselves, in double ----

def of_cloth(n):
    at, links = grid(n)
    w = numpy.array([0 if i in (0, n - 1) else 1000 for i in range(n * n)], dtype=float)[:, None]
    a, b = (numpy.array([link[k] for link in links]) for k in range(2))
    k, rest = (numpy.array([float(link[j]) for link in links])[:, None] for j in (2, 3))

    def slope(x, v):
        way, total = x[b] - x[a], numpy.zeros_like(x)
        numpy.add.at(total, a, k * (1 - rest / numpy.linalg.norm(way, axis=1)[:, None]) * way + 0.003 * (v[b] - v[a]))
        return w * (total + numpy.array([0, -0.00981, 0]))
    return at.astype(numpy.float32).astype(float), numpy.zeros_like(at), slope


def of_stars(n):
    random = numpy.random.default_rng(3)
    at, speed = random.uniform(-1, 1, (n, 2)), 0.1 * random.standard_normal((n, 2))
    m = random.uniform(0.01, 0.1, n)

    def slope(x, v):
        way = x[None] - x[:, None]
        return ((m[None] / ((way ** 2).sum(2) + 0.05 ** 2) ** 1.5)[..., None] * way).sum(1)
    return at, speed, slope


def of_balls(n):
    lines = balls(n)
    at = numpy.array([[float(word) for word in line.split()[2:]] for line in lines[1:4]]).T

    def slope(x, v):
        way = x[None] - x[:, None]
        far = numpy.sqrt((way ** 2).sum(2)) + numpy.eye(n)
        touch = ((far < 0.1) & ~numpy.eye(n, dtype=bool))[..., None]
        return (touch * (100 * ((far - 0.1) / far)[..., None] * way + 0.05 * (v[None] - v[:, None]))).sum(1) / 0.01
    return at, numpy.zeros_like(at), slope


def rk4(x, v, slope, h, steps):
    for _ in range(steps):
        k1, l1 = v, slope(x, v)
        k2, l2 = v + h / 2 * l1, slope(x + h / 2 * k1, v + h / 2 * l1)
        k3, l3 = v + h / 2 * l2, slope(x + h / 2 * k2, v + h / 2 * l2)
        k4, l4 = v + h * l3, slope(x + h * k3, v + h * l3)
        x, v = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), v + h / 6 * (l1 + 2 * l2 + 2 * l3 + l4)
    return x, v


@pytest.mark.parametrize("name, model, lines, reference, h, dimensions",
                         [("cloth", CLOTH, cloth(9), of_cloth(9), 0.001, 3), ("stars", STARS, stars(37), of_stars(37), 0.01, 2),
                          ("balls", BALLS, balls(75), of_balls(75), 0.001, 3)])
def test_rk4_is_that_of_the_whole_system(script, name, model, lines, reference, h, dimensions):
    states = " ".join(f"{q}_{'xyz'[k]}" for q in "xv" for k in range(dimensions))
    found = numpy.array([floats(line) for line in script(model, [*lines, "run 40", f"print {states}"], "fast", "rk4")]).T
    x, v = rk4(*reference, h, 40)
    assert abs(found[:, :dimensions] - x).max() < 4e-6 * max(1, abs(x).max())
    assert abs(found[:, dimensions:] - v).max() < 1e-4 * max(1, abs(v).max())


def test_forces_of_a_pair_are_exact_negatives(script):
    """Masses are equal, so all speeds of two add up to 0, in every bit; of many to what rounding leaves."""
    lines = ["objects 2", "state x 0.1 0.9", "state v 0.25 -0.25", "links springs 0 1 37 0.3", "links springs 1 0 37 -0.3", "run 500", "print v"]
    for integrator in ("leapfrog", "rk4"):
        a, b = floats(script(CHAIN, lines, "fast", integrator)[0])
        assert a == -b != 0
    n = 60
    found = [floats(line) for line in script(BALLS, [*balls(n), "run 200", "print v_x v_y v_z"], "fast")]
    for speed in found:
        assert abs(speed.sum()) < n * 200 * 2 ** -24 * abs(speed).max()


def test_skins_and_lists_change_no_bit(script):
    """Nor do they beside all pairs, of which the condition leaves out the same ones."""
    for model, start in ((BALLS, balls), (BALLS, fliers), (PILE, balls)):
        *before, near = start(75)
        first, *_, wanted = (script(model, [*before, "all touch", *run, "print x_x x_y x_z v_x"], "fast") for run in ((), ("run 60",)))
        assert sum(abs(floats(a) - floats(b)).max() > 0.01 for a, b in zip(first, wanted)) == 4
        for skin, engine in itertools.product((0, 1e-4, 0.02, 0.3, 5), ("fast", "isa")):
            assert script(model, [*start(75, skin), "run 60", "print x_x x_y x_z v_x"], engine) == wanted, (start, skin)


def test_runs_may_be_split(script):
    for name, (model, lines, states) in WORLDS.items():
        whole = script(model, [*lines, "run 12", f"print {states}"], "fast")
        assert script(model, [*lines, *["run 1"] * 5, "run 7", f"print {states}"], "fast") == whole, name


def test_who_flies_to_infinity_fails_and_the_others_go_on(script):
    lines = ["objects 3", "state x_x 0 0.01 5", "state x_y 0 3.4e38 0", "state v_y 0 3e38 0", "near touch 0.1 0.02 x_x x_y x_z", "run 30", "failure", "print x_x x_y v_x"]
    wanted = script(BALLS, lines, "isa", "euler")
    assert wanted[0] == "object 1 in step 1: overflow" and len(wanted) == 4
    for engine in ("fast", "interpreter"):
        assert script(BALLS, lines, engine, "euler") == wanted


@pytest.mark.parametrize("engine", ["isa", "fast", "interpreter", "rtl"])
def test_two_at_one_place_are_told(script, engine):
    """It is the first object that fails, its step, and with whom it is at the same place; nobody else fails."""
    lines = ["objects 4", "state x_x 3 0.5 7 0.5", "near touch 0.1 0.02 x_x x_y x_z", "run 1", "failure", "run 3", "print x_x"]
    failure, x = script(BALLS, lines, engine, "semi_implicit_euler")
    assert failure == "object 1 in step 1: invalid, at the same place as object 3"
    x = x.split()
    assert x[-3] == x[-1] and len(set(x[-4:])) == 3


def test_who_fails_is_found(script):
    lines = ["objects 5", "state x 0 1 2 3 4", "links springs 1 3 1e38 -1e3", "run 9", "failure"]
    for engine in ("isa", "fast", "interpreter"):
        assert script(CHAIN, lines, engine) == ["object 1 in step 1: overflow"]


def crowd():
    """Enough fliers that engine fast has them stand cell by cell, numbered at random."""
    random = numpy.random.default_rng(8)
    n, places = 500, random.permutation(729)
    at = numpy.array(list(itertools.product(range(9), repeat=3)))[places[:n]] * 0.13 + 0.01 * random.standard_normal((n, 3))
    speed = 3 * random.standard_normal((n, 3))
    return [f"objects {n}", *(row("state", f"{q}_{'xyz'[k]}", of[:, k]) for q, of in (("x", at), ("v", speed)) for k in range(3))], n


@pytest.mark.parametrize("engine, threads", [("fast", 1), ("fast", 3), ("interpreter", 2)])
def test_where_an_object_stands_changes_no_bit(script, engine, threads):
    """What is read and written between runs is each one's own, while all stand cell by cell, in a new order, or at their numbers again."""
    start, n = crowd()
    model = BALLS.replace("R = 0.05", "R = 0.1")
    near, states = "near touch 0.2 {} x_x x_y x_z", "print x_x x_y x_z v_x v_y v_z"
    lines = [*start, near.format(0.02), "run 20", states, "all touch", "run 2", states, near.format(1e-4), "run 50", states,
             row("state", "v_z", [i % 7 for i in range(n)]), "run 20", states, "failure"]
    wanted = script(model, lines, "isa")
    assert len(set(wanted)) == 4 * 6 + 1 and wanted[-1] == "none"
    assert script(model, lines, engine, threads=threads) == wanted


def test_a_program_without_neighbours_finds_objects_at_their_numbers(script, tmp_path):
    start, n = crowd()
    (tmp_path / "grows.ode").write_text("state u = 1\nstep 1\nu' = u")
    lines = [*start, "near touch 0.1 0.02 x_x x_y x_z", "run 30", f"load {tmp_path / 'grows.ode'}", row("state", "u", [3e38 if i == 321 else i for i in range(n)]),
             "run 3", "failure", "print u"]
    wanted = script(BALLS, lines, "isa")
    assert wanted[0] == "object 321 in step 1: overflow"
    assert script(BALLS, lines, "fast") == wanted


def test_who_flies_to_infinity_is_named_where_objects_stand_in_cells(script):
    start, n = crowd()
    lines = [*start, "near touch 0.1 0.02 x_x x_y x_z", "run 30", row("state", "x_y", [3.4e38 if i in (333, 406) else 0.01 * i for i in range(n)]),
             row("state", "v_y", [3e38 if i in (333, 406) else 0 for i in range(n)]), "run 5", "failure", "print x_y"]
    wanted = script(BALLS, lines, "isa", "euler")
    assert wanted[0] == "object 333 in step 31: overflow"
    for engine in ("fast", "interpreter"):
        assert script(BALLS, lines, engine, "euler") == wanted


# ---- what is refused ----

@pytest.mark.parametrize("lines, message", [
    (["run 1"], "error the list of neighbours 'springs' has not been given"),
    (["links springs 1 1 1 1", "run 1"], "error list 'springs': object 1 has the neighbour 1, expected another one of the group's 3 objects"),
    (["links springs 0 3 1 1", "run 1"], "error list 'springs': object 0 has the neighbour 3, expected another one of the group's 3 objects"),
    (["all springs", "run 1"], "error list 'springs': entries have fields, but none are given"),
    (["near springs 1 0 x", "run 1"], "error list 'springs': entries have fields, but none are given"),
    (["without springs fields", "run 1"], "error list 'springs': entries without their fields"),
    (["without springs neighbours", "run 1"], "error list 'springs': entries without their neighbours"),
    (["all spring", "run 1"], "error the program has no list of neighbours 'spring'"),
    (["all x", "run 1"], "error the program has no list of neighbours 'x'")])
def test_lists_are_checked(script, lines, message):
    for engine in ("isa", "fast"):
        assert script(CHAIN, ["objects 3", *lines], engine, status=2) == [message]


def test_nobody_is_near_a_nan(script):
    for value, engine in itertools.product(("nan", "inf"), ("isa", "fast", "interpreter")):
        said = script(BALLS, ["objects 3", f"state x_y 0 0 {value}", "near touch 0.1 0.02 x_x x_y x_z", "run 1", "failure"], engine)
        assert said == [f"object 2 before its first step: state x_y is {'NaN' if value == 'nan' else 'infinite'}"]
    assert script(BALLS, ["objects 3", "near touch 1 0 x_x R", "run 1"], status=2) == ["error list 'touch': the program has no state 'R'"]


def test_a_reach_has_two_ends(script):
    """Those in which the squares of distances are neither lost nor infinite in FP32."""
    for near in ("0 0", "-1 0", "nan 0", "8.8e-16 0", "9.3e18 0", "inf 0", "1 -1", "1 nan", "1 9.3e18"):
        said = script(BALLS, ["objects 3", f"near touch {near} x_x x_y x_z", "run 1"], status=2)
        assert said[0].startswith("error list 'touch': reach ") and said[0].endswith("expected a reach from 2^-50 to 2^63 and a skin from 0 to 2^63")
    for near in (f"{2**-50} {2**-50}", f"{2**63} {2**63}", "1 0"):
        assert script(BALLS, ["objects 3", f"near touch {near} x_x x_y x_z", "run 1"]) == []


def test_a_list_of_those_near_may_be_replaced(script):
    """By all others and back, between runs: the bits are those of a list that is near from the first."""
    *before, near = fliers(75)
    parts = [[near, "run 20"], ["all touch", "run 20"], [near, "run 20"]]
    for engine in ("isa", "fast"):
        wanted = script(BALLS, [*before, near, "run 60", "print x_x v_x"], engine)
        assert script(BALLS, [*before, *itertools.chain(*parts), "print x_x v_x"], engine) == wanted


@pytest.fixture
def compile_(fp3, tmp_path):
    def compile_(text, *options, config="world"):
        path = tmp_path / "m.ode"
        path.write_text(text)
        done = subprocess.run([fp3, "compile", path, "-c", config, *options], capture_output=True, text=True, timeout=60)
        return done.returncode, done.stderr.replace(f"{tmp_path}/", "").splitlines()
    return compile_


HEAD = "state x = 0 [m]\nstate y[2] = (0, 0)\nparam q = 1\nshared r = 1 [m]\nlinks ties(k = 1 [1/s])\nnear around(x, r)\nall others\nstep 1 [s]\ny' = (0, 0)/1\n"


@pytest.mark.parametrize("line, place, expected", [
    ("x' = sum(o in ties: o.k*(o.x - x) + sum(p in ties: p.k*p.x))", "10:37", "found 'sum', expected a term without another sum over neighbours"),
    ("x' = sum(o in ties: o.k*o)", "10:25", "found 'o', expected a state, param or field of the neighbour, as in o.x"),
    ("x' = sum(o in ties: o.k*o.z)", "10:27", "found 'z', expected a name that is defined above"),
    ("x' = sum(o in ties: o.k*o.x*o.y.z)", "10:31", "found 'y.z', expected a component .x or .y of it"),
    ("x' = prod(o in ties: o.k*o.x)", "10:6", "found 'prod', expected sum, min, max, count or any, which go over neighbours"),
    ("x' = max(o in ties: o.k*o.x)", "10:28", "found ')', expected an operator or ',' and the value that 'max' begins with"),
    ("x' = min(o in ties: o.k*o.x, x)", "10:6", "expected"),
    ("x' = 0*x*count(q)", "10:16", "found 'q', expected neighbours, as in count(o in touch)"),
    ("x' = 0*x*count(o in ties 1)", "10:26", "expected ':' and a term for each neighbour"),
    ("x' = 0*x*any(o in ties: sum(p in ties: p.k))", "10:25", "expected a term without another sum over neighbours"),
    ("x' = sum(o in others: o.k*o.x)", "10:25", "found 'k', expected a name that is defined above"),
    ("x' = sum(o in ties: o.x)", "10:1", "expected"),
    ("x' = sum(x in ties: 1 [1/s])", "10:10", "expected a new name (line 1 declares this one)"),
    ("x' = 0*x*sum(o in ties: o.k)\ninvariant e = sum(o in others: q)", "11:15", "found 'sum', expected a sum over neighbours in an equation only"),
    ("near x(x, r)\nx' = 0*x", "10:6", "expected a new name (line 1 declares this one)"),
    ("near w(x, q)\nx' = 0*x", "10:11", "expected a distance in the unit of 'x', of numbers and shared params"),
    ("near w(q, r)\nx' = 0*x", "10:8", "expected the position: a state, a number or a vector of 2 or 3"),
    ("near w\nx' = 0*x", "10:7", "expected '(', the position and the reach, as in near touch(x, 0.2)"),
    ("links w(k 1)\nx' = 0*x", "10:11", "expected '=' and the default value of links"),
    ("links\nx' = 0*x", "10:6", "expected a name, as in links springs")])
def test_the_language_says_what_it_expects(compile_, line, place, expected):
    code, said = compile_(HEAD + line + "\n")
    assert code == 2 and said[0].startswith(f"m.ode:{place}: error: ") and expected in said[0], said


def test_what_does_not_go_with_neighbours(compile_):
    code, said = compile_(CHAIN, "-i", "stoermer_verlet")
    assert code == 2 and "the positions one step before the first need sums over neighbours there; 'leapfrog' has the same order" in said[0], said


def test_other_configurations_say_where_it_is(compile_):
    code, said = compile_(CHAIN, config="many_full")
    assert code == 2 and said[0] == "m.ode:5:1: error: 'springs' needs `neighbours`, which configuration 'many_full' does not have; it is in 'world'"


@pytest.mark.parametrize("command", [("bench",), ("compare",), ("stress",), ("tune", "--tolerance", "1e-3", "-c", "world")])
def test_commands_for_one_object_refuse(fp3, tmp_path, command):
    (tmp_path / "chain.ode").write_text(CHAIN)
    done = subprocess.run([fp3, command[0], "chain.ode", *command[1:]], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2 and "objects of model 'chain' see each other ('springs', line 5), and this command computes each object alone" in done.stderr


# ---- programs written by hand ----

ASSEMBLY = """.state x
.temp list d
step:
    ld x
    ld list
{body}
"""


@pytest.mark.parametrize("body, expected", [
    ("each list\n ldn d, x\n add x, x, d", "the program ends within a loop over neighbours"),
    ("ldn d, x\n st x", "code word 2: instructions that read a neighbour, and 'next', belong in a loop, behind 'each'"),
    ("each list\n each list\n next\n next", "code word 3: a loop over neighbours ends before another, or a phase, begins or ends"),
    ("each list\n phase\n next", "code word 3: a loop over neighbours ends before another, or a phase, begins or ends"),
    ("st x\n each list\n ldn d, x\n next", "code word 4: a phase loads all words before it stores any"),
    ("each list\n ldn d, x\n st x\n next", "code word 4: a loop over neighbours stores nothing"),
    ("each list\n ldn d, x\n next\n st x\n phase\n ld x", "word r0 is read by neighbours: each phase stores it, or none does"),
    ("each list\n ldl d\n next\n each list\n next\n st x", "code word 6: two loops over one list read different numbers of fields"),
    ("each list\n" + " ldl d\n" * 65 + " next\n st x", "code word 67: an entry of a list has at most 64 fields"),
    ("each list\n next\n st x\nlast:\n add x, x, x", "a program with neighbours has a step part alone, no first and no last part"),
    ("rsbn x, x, x\n st x", "code word 2: instructions that read a neighbour, and 'next', belong in a loop, behind 'each'"),
    ("mull x, x, 0\n st x", "code word 2: instructions that read a neighbour, and 'next', belong in a loop, behind 'each'"),
    ("st x\n each list\n addn d, d, x\n next", "code word 4: a phase loads all words before it stores any"),
    ("each list\n muln d, d, k3\n next\n st x", "code word 3: a word of a neighbour's record is read, not a shared constant"),
    ("each list\n addn d, d, x\n next\n st x\n phase\n ld x", "word r0 is read by neighbours: each phase stores it, or none does"),
    ("each list\n mull d, d, 1\n next\n each list\n ldl d\n next\n st x", "code word 7: two loops over one list read different numbers of fields"),
    ("st x\n repeat 2\n ld x\n st x", "code word 6: the program ends within a repetition, without 'again'"),
    ("st x\n again\n ld x\n st x", "code word 3: 'again' ends a repetition, behind 'repeat'"),
    ("st x\n repeat 2\n ld x\n st x\n repeat 2\n ld x\n st x\n again", "code word 6: a repetition ends, with 'again', before another begins"),
    ("each list\n again\n next", "code word 3: a loop over neighbours ends before another, or a phase, begins or ends"),
    ("st x\n repeat 0\n ld x\n st x\n again", "expected a number of times, 1 to 63"),
    ("st x\n repeat 64\n ld x\n st x\n again", "expected a number of times, 1 to 63"),
    ("st x\n repeat x\n ld x\n st x\n again", "expected a number of times, 1 to 63"),
    ("each list\n mull d, d, 64\n next\n st x", "expected the number of a field, 0 to 63"),
    ("each list\n keep d, x, k0\n next\n st x", "code word 3: 'keep', 'raise' and 'hold' are words that the driver of the hardware adds to a program: an image has none"),
    ("raise x\n st x", "code word 2: 'keep', 'raise' and 'hold' are words"),
    ("st x\n hold 0\n ld x\n st x", "code word 3: 'keep', 'raise' and 'hold' are words"),
    ("st x\n hold 64\n ld x\n st x", "expected a number of words, 0 to 63"),
    ("each list\n mull d, d, x\n next\n st x", "expected the number of a field, 0 to 63")])
def test_programs_that_cannot_be(fp3, tmp_path, body, expected):
    (tmp_path / "p.s").write_text(ASSEMBLY.format(body=body))
    done = subprocess.run([fp3, "asm", "p.s", "-o", "p.fp3"], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2 and expected in done.stderr, done.stderr


def test_each_phase_on_hardware_loads_the_list_that_it_goes_through(fp3, tmp_path):
    """A register that holds a list holds it until the phase ends."""
    phase = "ld x\nld {}\neach ties\nldn n, x\nadd x, x, n\nnext\nst x\n"
    (tmp_path / "ties.csv").write_text("a,b\n0,1\n")
    for second, status in (("y", 2), ("ties", 0)):
        (tmp_path / "p.s").write_text(".state x\n.state y\n.temp ties n\nstep:\n" + phase.format("ties") + "phase\n" + phase.format(second))
        done = subprocess.run([fp3, "run", "p.s", "-c", "world", "-e", "rtl", "-N", "2", "--links", "ties=ties.csv", "--spread", "x=1:2", "--set", "y=0"], cwd=tmp_path,
                              capture_output=True, text=True, timeout=60)
        assert done.returncode == status and ("word 10" in done.stderr) == (status == 2), done.stdout + done.stderr


def test_lists_may_fill_a_store_to_the_last_word(fp3, tmp_path):
    """128 records of 8 words, and 64 lists of 112 words in each half of 8,192. One more neighbour has no room."""
    (tmp_path / "p.s").write_text(".state x\n.temp ties n\nstep:\nld x\nld ties\neach ties\nldn n, x\nadd x, x, n\nnext\nst x\n")
    pairs = [f"{a},{b}\n" for a in range(128) for b in range(a) if a ^ b > 15]
    for more, status in ((["1,0\n"], 2), ([], 0)):
        (tmp_path / "ties.csv").write_text("a,b\n" + "".join(pairs + more))
        done = subprocess.run([fp3, "run", "p.s", "-c", "world", "-e", "rtl", "-N", "128", "--links", "ties=ties.csv", "--set", "x=0"], cwd=tmp_path,
                              capture_output=True, text=True, timeout=60)
        assert done.returncode == status and ("its 16384 words are full" in done.stderr) == (status == 2), done.stdout + done.stderr


@pytest.mark.parametrize("model, forms", [(CHAIN, {"rsbn", "ldl"}), (CLOTH, {"rsbn", "mull"})])
def test_assembly_is_read_again(fp3, tmp_path, model, forms):
    """The compiler's text, an image, and the text of the image are one program."""
    (tmp_path / "chain.ode").write_text(model)
    for command in (["compile", "chain.ode", "-c", "world", "-i", "rk4", "-o", "a.s", "--image", "a.fp3"], ["asm", "a.s", "-o", "b.fp3"], ["dis", "b.fp3", "-o", "c.s"],
                    ["asm", "c.s", "-o", "c.fp3"]):
        subprocess.run([fp3, *command], cwd=tmp_path, check=True, timeout=60)
    a, b, c = ((tmp_path / f"{name}.fp3").read_bytes() for name in "abc")
    assert b == c and len(a) == len(b)
    assert {"each", "next", "phase"} | forms < {line.split()[0] for line in (tmp_path / "c.s").read_text().splitlines() if line.startswith(" ")}
