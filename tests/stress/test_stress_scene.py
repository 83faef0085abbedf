"""fp3 stress SCENE: how near its limits a scene comes, beside what theory says of it; and the warning of fp3 run beyond them."""

import json
import math
import re
import subprocess

import numpy as np
import pytest

LIMITS = {"semi_implicit_euler": (2, 2), "leapfrog": (2, 2), "rk4": (8 ** 0.5, 2.785294), "midpoint": (1.151803, 2)}
CHAIN = """shared k = 100
param w = 1
state u = 0
state v = 0
links s
u' = v
v' = w*sum(o in s: k*(o.u - u))
step 0.05
"""
PAIR = """shared c = 3
state x = 0
state v = 0
links s
x' = v
v' = sum(o in s: c*(o.v - v))
step 0.05
"""
BALLS = """shared R = 0.05
shared m = 0.01
shared stiff = 3000
shared damp = 0.2
state x[2] = (0, 0)
state v[2] = (0, 0)
near touch(x, 2*R)
step 1/480
F = sum(o in touch: stiff*(norm(o.x - x) - 2*R)/norm(o.x - x)*(o.x - x) + damp*(o.v - v))
x' = v
v' = (0, -9.81) + (F + stiff*(max(0, R - x.x) - max(0, x.x + R - 3), max(0, R - x.y)))/m
"""


@pytest.fixture
def call(fp3, tmp_path):
    def call(command, groups, *options, code=0, steps=256, **files):
        for name, text in files.items():
            (tmp_path / f"{name}.ode").write_text(text)
        path = tmp_path / "x.scene"
        path.write_text(f'config = "world"; steps = {steps}; groups = ( {groups} );')
        done = subprocess.run([fp3, command, *([path] if command == "stress" else ["--scene", path]), *options], cwd=tmp_path, capture_output=True, text=True, timeout=200)
        assert done.returncode == code, done.stdout + done.stderr
        return done
    return call


@pytest.fixture
def rows(call, tmp_path):
    """By their first words."""
    def rows(groups, **how):
        call("stress", groups, "--json", tmp_path / "r.json", **how)
        return {re.match("h omega|h c/m|growth|objects", row["name"])[0]: row for row in json.loads((tmp_path / "r.json").read_text())["results"]}
    return rows


@pytest.mark.parametrize("integrator, limit", [(name, limits[0]) for name, limits in LIMITS.items()])
def test_springs_of_a_chain_have_the_limit_of_the_books(rows, integrator, limit):
    """omega = 2 sqrt(k/m) cos(pi/2N) of N free masses. Either side of the limit."""
    def of(share):
        h = share * limit / (20 * math.cos(math.pi / 16))
        return rows(f'{{ program = "m.ode"; integrator = "{integrator}"; grid = {{ count = 8; }}; links = {{ relation = "s"; grid = "structural"; }}; set = {{ h = {h!r}; }};'
                    "only = { objects = 3; set = { u = 1e-9; }; }; }", code=3 if share > 1 else 0, m=CHAIN)
    for share in (0.99, 1.05):
        found = of(share)
        assert found["h omega"]["measured"] == pytest.approx(share * limit, rel=1e-3) and found["h omega"]["expected"] == pytest.approx(limit, rel=1e-6)
        assert found["h omega"]["holds"] == (share < 1) and found["growth"]["measured"] >= 1


@pytest.mark.parametrize("integrator, limit", [(name, limits[1]) for name, limits in LIMITS.items()])
def test_dampers_of_a_pair_have_the_limit_of_the_books(rows, integrator, limit):
    """Two free masses: 2 c/m. Beyond it a small error grows by |R(-2 c h/m)|."""
    for share in (0.98, 1.2):
        found = rows(f'{{ program = "m.ode"; integrator = "{integrator}"; grid = {{ count = 2; }}; links = {{ relation = "s"; grid = "structural"; }};'
                     f' set = {{ h = {share * limit / 6!r}; }}; }}', code=3 if share > 1 else 0, m=PAIR, steps=20)
        assert found["h c/m"]["measured"] == pytest.approx(share * limit, rel=1e-3) and found["h c/m"]["expected"] == pytest.approx(limit, rel=1e-5)
        z = -share * limit
        grown = {"rk4": abs(1 + z + z * z / 2 + z ** 3 / 6 + z ** 4 / 24), "midpoint": abs(1 + z + z * z / 2)}.get(integrator, abs(1 + z))
        assert found["growth"]["measured"] == pytest.approx(max(1, grown), rel=0.02)


def test_what_pushes_away_has_no_frequency(rows):
    """Two masses push each other away by 100 u and 10 v, and each is held by a spring of 25 and a damper of 3: they swing together, with 5, and part by
    exp(t sqrt(175)), which is no frequency, and has no limit of h."""
    model = PAIR.replace("c*(o.v - v))", "100*(x - o.x) + 10*(v - o.v))")
    group = '{ program = "m.ode"; integrator = "leapfrog"; grid = { count = 2; }; links = { relation = "s"; grid = "structural"; }; set = { h = 0.01; }; }'
    held = rows(group, m=model.replace("o.v))", "o.v)) - 25*x - 3*v"), steps=1)
    assert held["h omega"]["measured"] == pytest.approx(0.05, rel=1e-3) and held["h c/m"]["measured"] == pytest.approx(0.03, rel=1e-3)
    assert rows(group, m=model, steps=1).keys() == {"growth"}


@pytest.mark.parametrize("is_first", [True, False])
def test_the_limit_is_that_of_the_group_that_swings(rows, is_first):
    """A wall that never moves, and steps by Euler's method, has no part in the limit of who swings at it."""
    ball = "kind wall(x)\nstate x = 0\nstate v = 0\nnear of_wall(x, wall.x, 10)\nx' = v\nv' = sum(o in of_wall: 100*(o.x - x) - 3*v)\nstep 0.1\n"
    groups = ['{ program = "wall.ode"; integrator = "euler"; objects = 1; }', '{ program = "ball.ode"; integrator = "semi_implicit_euler"; objects = 1; }']
    found = rows(", ".join(groups if is_first else groups[::-1]), ball=ball, wall="state x = 0\nx' = 0\nstep 0.1\n")
    assert [found["h omega"][key] for key in ("integrator", "expected", "measured")] == ["semi_implicit_euler", pytest.approx(2), pytest.approx(1, rel=1e-3)]
    assert [found["h c/m"][key] for key in ("integrator", "expected", "measured")] == ["semi_implicit_euler", pytest.approx(2), pytest.approx(0.3, rel=1e-3)]


def test_a_sheet_has_the_frequency_that_numpy_finds(rows, root, tmp_path):
    """The cloth of programs/world without weight: eigenvalues of its stiffness matrix, flat and at rest."""
    count, a = 20, 0.05
    at = np.array([(x, z) for z in range(count) for x in range(count)]) * a
    stiff = np.zeros((400, 2, 400, 2))
    for i in range(400):
        for dx, dz, k in ((1, 0, 100), (0, 1, 100), (1, 1, 100), (1, -1, 100), (2, 0, 10), (0, 2, 10)):
            x, z = i % count + dx, i // count + dz
            if 0 <= x < count and 0 <= z < count:
                j = z * count + x
                way = (at[j] - at[i]) / np.linalg.norm(at[j] - at[i])
                part = k * np.outer(way, way) * 1000
                for p, q, sign in ((i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)):
                    stiff[p, :, q] += sign * part
    free = [i for i in range(800) if i // 2 not in (0, 19)]
    omega = math.sqrt(np.linalg.eigvalsh(stiff.reshape(800, 800)[np.ix_(free, free)])[-1])
    text = (root / "programs/world/cloth.ode").read_text().replace("(0, -9.81, 0)", "(0, 0, 0)")
    scene = (root / "programs/world/cloth.scene").read_text()
    found = rows(scene[scene.index("{"):scene.rindex("}") + 1], steps=8, cloth=text)
    assert found["h omega"]["measured"] == pytest.approx(omega / 1024, rel=2e-3)


def test_balls_that_fly_apart_are_told(call):
    """Stiffness 3,000 throws balls that touch metres high. In the end none touch, so some are put side by side."""
    groups = ('{ program = "balls.ode"; integrator = "semi_implicit_euler"; objects = 100; set = { stiff = %s; };'
              ' random = { position = "x"; from = [1, 0.1]; to = [2.5, 1.5]; apart = 0.1; seed = 3; }; }')
    said = call("run", groups % "3000.0", steps=2000, balls=BALLS).stderr
    assert re.search(r"warning: object \d+: the step is too long( for equal objects side by side, each near the next)?: a small error grows [1-9]\S* times", said)
    assert call("run", groups % "1000.0", steps=2000, balls=BALLS).stderr == ""


@pytest.mark.parametrize("what", ["kinds", "remember", "born"])
def test_what_other_looks_are_blind_to_is_told(call, what):
    """Two masses at a spring, of which the second belongs to another group, is born late, or has a spring that remembers."""
    spring, other = "state x = 0\nstate v = 0\nx' = v\nstep 0.05\n", ""
    if what == "kinds":
        model = spring + "kind wall(x)\nnear of_wall(x, wall.x, 10)\nshared k = 100\nv' = sum(o in of_wall: k*(o.x - x))\n"
        other = ', { program = "wall.ode"; integrator = "leapfrog"; objects = 1; }'
        limit = 0.2
    else:
        model = spring + "links s(k = 50%s)\nv' = sum(o in s: (%so.k)*(o.x - x))\n" % ((", old = 0", "o.old + ") if what == "remember" else ("", ""))
        model += "remember o in s: o.old = 0*o.old\n" if what == "remember" else ""
        limit = 0.2
    place = "objects = 1" if what == "kinds" else "grid = { count = 2; }"
    for share, is_told in ((0.95, False), (1.1, True)):
        group = (f'{{ program = "m.ode"; integrator = "leapfrog"; {place}; set = {{ h = {share * limit!r}; }};'
                 + ('' if what == "kinds" else 'links = { relation = "s"; grid = "structural"; };') + ('born = 1;' if what == "born" else '') + ' }')
        wall = other.replace("objects = 1;", f"objects = 1; set = {{ h = {share * limit!r}; }};")
        said = call("run", group + wall, steps=128, m=model, wall=spring + "v' = 0*x\n").stderr
        assert ("the step is too long" in said) == is_told, said


MET = """state x = 0
state v = 0
near touch(x, 0.1)
x' = v
v' = sum(o in touch: 1000*(1 - 0.1/abs(o.x - x))*(o.x - x))
step 0.001
"""


def test_objects_that_fail_do_not_hold(rows):
    """Two that meet at one place have no direction: their states are NaN from then on, which no limit shows."""
    group = '{ program = "m.ode"; integrator = "semi_implicit_euler"; objects = 2; spread = { x = [0.0, 0.5]; v = [%s, 0.0]; }; }'
    found = rows(group % "500.0", code=3, steps=16, m=MET)
    assert found["growth"]["holds"] and found["objects"]["measured"] == 2 and "at the same place" in found["objects"]["why"]
    assert "objects" not in rows(group % "1.0", steps=16, m=MET)


def test_a_long_step_is_told_in_a_short_run_and_in_one_that_fails(call):
    group = '{ program = "m.ode"; integrator = "%s"; grid = { count = 2; }; links = { relation = "s"; grid = "structural"; }; set = { h = %s; }; only = { objects = 0; set = { u = %s; }; }; }'
    told = ": the step is too long: a small error grows "
    assert told in call("run", group % ("leapfrog", "30.0", "0.0"), steps=8, m=CHAIN).stderr
    assert "the step is too long" in call("run", group % ("leapfrog", "30.0", "0.0"), "--check", "--strict", code=3, steps=8, m=CHAIN).stderr
    assert told in call("run", group % ("rk4", "0.5", "0.1"), code=3, steps=200, m=CHAIN).stderr
    assert "too long" not in call("run", group % ("leapfrog", "0.15", "0.0"), "--check", steps=8, m=CHAIN).stdout


def test_results_do_not_overwrite_what_the_scene_reads(call, tmp_path):
    group = '{ program = "m.ode"; objects = 2; links = { relation = "s"; file = "l.csv"; }; }'
    (tmp_path / "l.csv").write_text("a,b\n0,1\n")
    for name in ("m.ode", "l.csv"):
        assert f"--json {name} would overwrite" in call("stress", group, "--json", name, code=2, m=CHAIN).stderr
    assert (tmp_path / "m.ode").read_text() == CHAIN and (tmp_path / "l.csv").read_text() == "a,b\n0,1\n"


def test_what_has_no_limit_is_refused(call, rows):
    group = '{ program = "m.ode"; integrator = "%s"; grid = { count = 2; }; links = { relation = "s"; grid = "structural"; }; %s }'
    assert "adaptive steps become shorter" in call("stress", group % ("dopri5", "tolerance = 1e-4; until = 1.0;"), code=2, m=PAIR).stderr
    assert "--integrator" in call("stress", group % ("rk4", ""), "--integrator", "rk4", code=2, m=PAIR).stderr
    assert rows(group % ("rk4", ""), m=PAIR, steps=1)["growth"]["measured"] == 1
