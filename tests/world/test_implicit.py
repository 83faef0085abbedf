"""Linearly implicit steps of objects that see each other: the matrix has derivatives by an object's own states, and the order stays 2."""

import csv
import subprocess

import numpy
import pytest
from test_world import compile_, row, script  # noqa: F401, pylint: disable=unused-import

GAMMA = 1 + 2 ** -0.5
N = 12
SCENE = """steps = {steps}; h = {h!r};
groups = ( {{ program = "m.ode"; integrator = "ros2"; points = "p.csv"; {links} }} );
"""
CLOTH = """
shared c = 0.3
state x[2] = (0, 0)
state v[2] = (0, 0)
links springs(k = 40, rest = 0.25)
step 0.03125
x' = v
v' = (1 + 0.5*sin(3*t))*sum(o in springs: o.k*(1 - o.rest/norm(o.x - x))*(o.x - x) + c*(o.v - v)) - 2*norm(v)*v
"""
GRAINS = """
shared R = 0.15
state x[2] = (0, 0)
state v[2] = (0, 0)
near touch(x, 2*R)
step 0.03125
x' = v
v' = sum(o in touch: 60*(2*R/norm(o.x - x) - 1)*(x - o.x) + 0.5*(o.v - v)) - 3*v
"""
STARS = """
param m = 1
state x[2] = (0, 0)
state v[2] = (0, 0)
all others
step 0.03125
x' = v
v' = sum(o in others: o.m/(dot(o.x - x, o.x - x) + 0.0625)^1.5*(o.x - x)) - v/m
"""
# A term that has another sum in it; what is counted; and a most, which the matrix leaves out.
CROWD = """
state x = 0
state v = 0
near touch(x, 0.75)
step 0.03125
rho = sum(o in touch: (0.5625 - (o.x - x)^2)^2)
x' = v
v' = sum(o in touch: 4*rho*(x - o.x)) - 5*count(o in touch: o.x > x)*v + 3*max(o in touch: o.x - x, -0.5*x) - 2*x
"""


def pairs(x):
    return x[None] - x[:, None], numpy.linalg.norm(x[None] - x[:, None], axis=-1) + numpy.eye(N)


def cloth(t, y, _):
    x, v = y[:, :2], y[:, 2:]
    way, far = pairs(x)
    k = numpy.where(abs(numpy.subtract.outer(numpy.arange(N), numpy.arange(N))) == 1, 40 + numpy.add.outer(numpy.arange(N), numpy.arange(N)) % 5, 0)
    force = (k * (1 - 0.25 / far))[..., None] * way + 0.3 * (k > 0)[..., None] * (v[None] - v[:, None])
    return numpy.hstack([v, (1 + 0.5 * numpy.sin(3 * t)) * force.sum(1) - 2 * numpy.linalg.norm(v, axis=1)[:, None] * v])


def grains(_, y, __):
    x, v = y[:, :2], y[:, 2:]
    way, far = pairs(x)
    force = 60 * (0.3 / far - 1)[..., None] * -way + 0.5 * (v[None] - v[:, None])
    return numpy.hstack([v, (force * ((far < 0.3) & ~numpy.eye(N, dtype=bool))[..., None]).sum(1) - 3 * v])


def mass(i):
    return 0.5 + 0.125 * i


def stars(_, y, __):
    x, v = y[:, :2], y[:, 2:]
    way, _ = pairs(x)
    pull = mass(numpy.arange(N))[None, :, None] / (numpy.sum(way ** 2, -1, keepdims=True) + 0.0625) ** 1.5 * way
    return numpy.hstack([v, pull.sum(1) - v / mass(numpy.arange(N))[:, None]])


def crowd(_, y, fixed):
    """fixed: the most of each object's neighbours, if it counts as constant."""
    x, v = y.T
    way = x[None] - x[:, None]
    near = (abs(way) < 0.75) & ~numpy.eye(N, dtype=bool)
    rho = (near * (0.5625 - way ** 2) ** 2).sum(1)
    most = numpy.maximum(numpy.where(near, way, -9).max(1), -0.5 * x) if fixed is None else fixed
    return numpy.stack([v, (near * 4 * rho[:, None] * -way).sum(1) - 5 * (near & (way > 0)).sum(1) * v + 3 * most - 2 * x], 1)


def most_of(y):
    x = y[:, 0]
    way = x[None] - x[:, None]
    return numpy.maximum(numpy.where((abs(way) < 0.75) & ~numpy.eye(N, dtype=bool), way, -9).max(1), -0.5 * x)


def start(name):
    random = numpy.random.default_rng(11)
    i = numpy.arange(N)
    if name == "crowd":
        y = numpy.stack([0.3 * i - 1.5 + 0.03 * random.standard_normal(N), 0.2 * random.standard_normal(N)], 1)
    elif name == "cloth":
        y = numpy.hstack([numpy.stack([0.25 * i, 0 * i], 1) + 0.03 * random.standard_normal((N, 2)), 0.5 * random.standard_normal((N, 2))])
    else:
        apart = 0.27 if name == "grains" else 0.9
        y = numpy.hstack([apart * numpy.stack([i % 4, i // 4], 1) + 0.01 * random.standard_normal((N, 2)), 0.1 * random.standard_normal((N, 2))])
    return y.astype(numpy.float32).astype(float)


WORLDS = {"cloth": (CLOTH, cloth), "grains": (GRAINS, grains), "stars": (STARS, stars), "crowd": (CROWD, crowd)}
STATES = {"crowd": ["x", "v"]}


def matrices(f, t, y):
    """Of each object, by differences: the others stay where they are."""
    fixed, e, found = most_of(y) if f is crowd else None, 1e-6, numpy.zeros((N, y.shape[1], y.shape[1]))
    for i in range(N):
        for s in range(y.shape[1]):
            d = numpy.zeros_like(y)
            d[i, s] = e
            found[i, :, s] = (f(t, y + d, fixed)[i] - f(t, y - d, fixed)[i]) / (2 * e)
    return found


def implicit(f, y, h, steps):
    """ROS2 as its authors write it, in double, with these matrices."""
    for n in range(steps):
        t, one = n * h, numpy.eye(y.shape[1]) - GAMMA * h * matrices(f, n * h, y)
        by_time = GAMMA * h * (f(t + 1e-6, y, None) - f(t - 1e-6, y, None)) / 2e-6
        k1 = numpy.linalg.solve(one, (f(t, y, None) + by_time)[..., None])[..., 0]
        k2 = numpy.linalg.solve(one, (f(t + h, y + h * k1, None) - 2 * k1 - by_time)[..., None])[..., 0]
        y = y + h * (1.5 * k1 + 0.5 * k2)
    return y


def classic(f, y, h, steps):
    for n in range(steps):
        t = n * h
        a = f(t, y, None)
        b = f(t + h / 2, y + h / 2 * a, None)
        c = f(t + h / 2, y + h / 2 * b, None)
        y = y + h / 6 * (a + 2 * b + 2 * c + f(t + h, y + h * c, None))
    return y


@pytest.fixture
def end(record, folder):
    """What the objects hold after steps of a world."""
    def end(name, h, steps, engine="fast"):
        states = STATES.get(name, ["x_x", "x_y", "v_x", "v_y"])
        (folder / "m.ode").write_text(WORLDS[name][0])
        with (folder / "p.csv").open("w") as file:
            writer = csv.writer(file)
            writer.writerow(states + ["m"] * (name == "stars"))
            writer.writerows([*map(repr, map(float, y)), *([mass(i)] if name == "stars" else [])] for i, y in enumerate(start(name)))
        (folder / "l.csv").write_text("a,b,k\n" + "".join(f"{i},{i + 1},{40 + (2 * i + 1) % 5}\n" for i in range(N - 1)))
        links = 'links = { relation = "springs"; file = "l.csv"; };' if name == "cloth" else ""
        last = record(SCENE.format(steps=steps, h=h, links=links), "-e", engine)[-1]
        return numpy.array([[one[state] for state in states] for one in last])
    return end


@pytest.mark.parametrize("name", WORLDS)
def test_a_step_is_that_of_its_authors_with_each_objects_own_matrix(end, name):
    """On every engine, in the same words."""
    found = end(name, 2.0 ** -5, 3)
    for engine in ("isa", "rtl"):
        assert numpy.array_equal(end(name, 2.0 ** -5, 3, engine), found), engine
    wanted = implicit(WORLDS[name][1], start(name), 2.0 ** -5, 3)
    assert abs(found - wanted).max() < 3e-6 < 1e-3 < abs(wanted - classic(WORLDS[name][1], start(name), 2.0 ** -5, 3)).max()


@pytest.mark.parametrize("engine", ["isa", "fast"])
def test_another_kind_is_seen_at_both_stages(record, folder, engine):
    """The stars, half of them of a kind of its own."""
    y, found = start("stars"), []
    states = ["x_x", "x_y", "v_x", "v_y"]
    for own, other, first in (("a", "b", 0), ("b", "a", N // 2)):
        pull = STARS.split("v' = ")[1].strip().removesuffix(" - v/m")
        (folder / f"{own}.ode").write_text(STARS.replace("all others", f"kind {other}(x[2], m)\nall others\nall guests({other})")
                                           .replace(" - v/m", f" + {pull.replace('others', 'guests')} - v/m"))
        (folder / f"{own}.csv").write_text(",".join([*states, "m"]) + "\n" + "".join(
            ",".join(map(repr, map(float, [*y[i], mass(i)]))) + "\n" for i in range(first, first + N // 2)))
    groups = ", ".join(f'{{ program = "{name}.ode"; integrator = "ros2"; points = "{name}.csv"; }}' for name in "ab")
    for name in "ab":
        found += record(f"steps = 3; h = 0.03125;\ngroups = ( {groups} );\n", "-e", engine, "--group", name)[-1]
    assert abs(numpy.array([[one[state] for state in states] for one in found]) - implicit(stars, y, 2.0 ** -5, 3)).max() < 3e-6


@pytest.mark.parametrize("name", WORLDS)
def test_the_order_is_2(end, name):
    wanted = classic(WORLDS[name][1], start(name), 2.0 ** -10, 128)
    one, two = (abs(end(name, 1 / steps, steps // 8) - wanted).max() for steps in (128, 256))
    assert 3.4 < one / two < 4.8 and two > 3e-5, (one, two)


def test_drag_may_be_much_faster_than_the_step(end, monkeypatch):
    """h c is 94: contacts push, and the speed is what drag leaves of it. rk4 blows up there."""
    def sticky(t, y, _):
        return grains(t, y, None) - 2997 * numpy.hstack([0 * y[:, 2:], y[:, 2:]])
    monkeypatch.setitem(WORLDS, "grains", (GRAINS.replace("- 3*v", "- 3000*v"), sticky))
    wanted, found = classic(sticky, start("grains"), 2.0 ** -11, 512), end("grains", 2.0 ** -5, 8)
    assert abs(found[:, :2] - wanted[:, :2]).max() < 1e-5 < 1e-4 < abs(wanted[:, :2] - start("grains")[:, :2]).max()
    assert abs(found[:, 2:] - wanted[:, 2:]).max() < 0.01 * abs(wanted[:, 2:]).max()
    explicit = classic(sticky, start("grains"), 2.0 ** -5, 8)
    assert not abs(explicit).max() < 1e6


APART = "state x = 0\nstate v = 0\nnear touch(x, 0.1)\nstep 1\nx' = v\nv' = sum(o in touch: 4*(x - o.x))\n"


def test_one_who_is_too_far_changes_no_bit(script, tmp_path):  # noqa: F811
    """Not even the sign of a 0: the sum of no derivatives is -0, whoever is in the list. With one stage it is seen."""
    table = tmp_path / "one.cfg"
    table.write_text('name = "one"; doc = "one stage"; source = "this test"; kind = "rosenbrock"; order = 1; gamma = 1; A = (()); G = (()); b = (1);')
    lines = ["objects 3", row("state", "x", [0, 0.3, 0.7]), row("state", "v", [-0.0, 0, -0.0])]
    found = {tuple(script(APART, [*lines, f"near touch 0.1 {skin} x", "run 1", "print x v"], engine, table))
             for skin in (0.001, 5) for engine in ("isa", "fast")}
    assert len(found) == 1, found


ROD = "state x = 0\nstate v = 0\nlinks rods(rest = 1)\nstep 1\nx' = v\nv' = 0.25*sum(o in rods: o.x - x - o.rest)\n"


def rod(script, integrator, v, omega, steps):  # noqa: F811
    """Of 21 masses, where the fastest swing has omega = 1."""
    lines = ["objects 21", row("state", "x", range(21)), row("state", "v", v),
             *(f"links rods {a} {b} {b - a}" for i in range(20) for a, b in ((i, i + 1), (i + 1, i)))]
    said = script(ROD.replace("step 1", f"step {omega!r}"), [*lines, "run 1", f"go {steps - 1}", "print v"], "fast", integrator)
    return numpy.array([int(word, 16) for word in said[-1].split()], dtype=numpy.uint32).view(numpy.float32).astype(float)


def test_springs_between_objects_grow_at_no_step(script):  # noqa: F811
    """docs/integrators.md: explicit methods end where h omega is 2.83, and 2; these steps damp, also what moves as a whole."""
    v = [(-1) ** i for i in range(21)]
    for integrator, last, over in (("rk4", 2.8, 2.9), ("leapfrog", 1.99, 2.02)):
        assert abs(rod(script, integrator, v, last, 400)).max() < 30 and not abs(rod(script, integrator, v, over, 400)).max() < 30, integrator
    for omega in (2, 10, 100, 1000):
        assert abs(rod(script, "ros2", v, omega, 400)).max() < 3, omega
    left = [rod(script, "ros2", [1] * 21, omega, 1)[10] for omega in (0.1, 0.3, 1, 3, 10)]
    assert left == pytest.approx([0.99979, 0.98656, 0.64833, 0.13668, 0.01359], rel=1e-3)


def test_derivatives_are_made_in_the_loop_of_the_sum(fp3, folder):
    for name, (model, _) in WORLDS.items():
        (folder / "m.ode").write_text(model)
        made = subprocess.run([fp3, "compile", "m.ode", "-c", "world", "-i", "ros2"], cwd=folder, capture_output=True, text=True, timeout=60)
        assert made.stdout.count(" each ") == (4 if name == "crowd" else 2), made.stdout + made.stderr


FREE = """name = "mine"; doc = "of order 1, and in two stages"; source = "this test"; kind = "rosenbrock"; order = {order}; gamma = {gamma};
A = ((), ({a})); G = ((), ({below}));
b = ("1/2", "1/2");"""


@pytest.mark.parametrize("table, is_taken", [((2, 0.5, 1, -1), True), ((1, 1, 0, 0), True), ((2, 0.5, 0.5, -0.5), False)])
def test_tables_that_need_no_exact_matrix(compile_, tmp_path, table, is_taken):  # noqa: F811
    (tmp_path / "mine.cfg").write_text(FREE.format(**dict(zip(("order", "gamma", "a", "below"), table))))
    code, said = compile_(APART, "-i", tmp_path / "mine.cfg")
    assert (code == 0) == is_taken and (is_taken or "derivatives by states of neighbours" in said[0]), said


@pytest.mark.parametrize("integrator", ["ros3p", "rodas3"])
def test_tables_of_higher_order_say_which_one_to_take(compile_, integrator):  # noqa: F811
    code, said = compile_(APART, "-i", integrator)
    assert code == 2 and "needs derivatives by states of neighbours, too; 'ros2' has its order without them" in said[0], said
