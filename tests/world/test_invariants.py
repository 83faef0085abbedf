"""Invariants of all objects: `sum(objects: ...)` and `sum(pairs o in NAME: ...)`, what runs made of them, and what steps that are too long do to them."""

import json
import math
import re
import subprocess

import numpy as np
import pytest

A = """
kind   b(x[2], q)
shared K = 3
param  m = 1
param  R = 0.1
state  x[2] = (0, 0)
state  v[2] = (0, 0)
links  ties(k = 2, rest = 0.5)
links  seats(b, w = 3)
near   touch(x, R + o.R + 0.1)
near   far(x, b.x, 0.5)
all    others
all    suns(b)
step   0.001
x' = v
v' = 0*(sum(o in ties: o.k*o.x) + sum(o in seats: o.w*o.x) + sum(o in touch: o.x) + sum(o in far: o.x) + sum(o in others: o.x) + sum(o in suns: o.q*o.x))
invariant own   = K*sum(objects: 0.5*m*dot(v, v)) - 2*t
invariant tie   = sum(pairs o in ties: o.k*(norm(o.x - x) - o.rest)^2*m*o.m)
invariant seat  = sum(pairs o in seats: o.w*norm(o.x - x)*m*o.q)
invariant near_ = sum(pairs o in touch: m*o.m + o.R)
invariant far_  = sum(pairs o in far: m*o.q*(o.x - x))
invariant all_  = sum(pairs o in others: m*o.m*(o.x.x - x.x))
invariant sun   = sum(pairs o in suns: m*o.q)
"""
B = "param q = 1\nstate x[2] = (0, 0)\nstep 0.001\nx' = (0.25, 0)\ninvariant own = sum(objects: q)\n"


def told(done):
    """Of each invariant its first value, its change, and that relative to its size; with a check also the change in the second run."""
    lines = re.findall(r"^invariant +(\w+) of all objects: was (\S+), changed by (\S+), relative ([^\s;]+)(?:; in the second run by (\S+))?$", done.stdout, re.M)
    return {name: tuple(float(value or "nan") for value in values) for name, *values in lines}


def table(path, head, columns):
    path.write_text(head + "\n" + "\n".join(",".join(map(repr, row)) for row in zip(*(column.tolist() for column in columns))) + "\n")


def test_each_pair_counts_once_in_every_relation(start, folder):
    """The same sums by numpy, over the objects at the start and at the end of the run."""
    random = np.random.default_rng(5)
    count, suns, h, steps = 40, 9, 0.001, 100
    x, v, y = (random.uniform(-0.5, 0.5, (n, 2)).astype(np.float32).astype(float) for n in (count, count, suns))
    m, radius, q = random.uniform(1, 2, count), random.uniform(0, 0.2, count), random.uniform(1, 2, suns)
    ends = np.array([(i, j) for i in range(count) for j in range(i) if (i + j) % 7 == 0])
    seats = np.array([(i, i % suns) for i in range(0, count, 3)])
    k = random.uniform(1, 2, len(ends))
    table(folder / "a.csv", "x_x,x_y,v_x,v_y,m,R", [*x.T, *v.T, m, radius])
    table(folder / "b.csv", "x_x,x_y,q", [*y.T, q])
    table(folder / "ties.csv", "a,b,k", [*ends.T, k])
    table(folder / "seats.csv", "a,b", seats.T)
    (folder / "a.ode").write_text(A)
    (folder / "b.ode").write_text(B)
    (folder / "x.scene").write_text(f"""steps = {steps};
groups = ( {{ program = "a.ode"; integrator = "euler"; points = "a.csv";
              links = ( {{ relation = "ties"; file = "ties.csv"; }}, {{ relation = "seats"; file = "seats.csv"; }} ); }},
           {{ program = "b.ode"; integrator = "euler"; points = "b.csv"; }} );""")

    def sums(t):
        at, sun = x + v*t, y + np.array([0.25, 0])*t
        way = at[None] - at[:, None]
        apart, to_suns = np.linalg.norm(way, axis=2), sun[None] - at[:, None]
        a, b = ends.T
        once = np.triu(np.ones((count, count)), 1)
        i, j = seats.T
        return {"own": 3*(m*(v*v).sum(1)).sum()/2 - 2*t + q.sum(), "tie": (k*(apart[a, b] - 0.5)**2*m[a]*m[b]).sum(),
                "seat": (3*np.linalg.norm(to_suns[i, j], axis=1)*m[i]*q[j]).sum(),
                "near_": ((m[:, None]*m[None] + radius[None])*(apart < radius[:, None] + radius[None] + 0.1)*once).sum(),
                **{f"far__{axis}": (m[:, None]*q[None]*to_suns[..., n]*(np.linalg.norm(to_suns, axis=2) < 0.5)).sum() for n, axis in enumerate("xy")},
                "all_": (m[:, None]*m[None]*way[..., 0]*once).sum(), "sun": m.sum()*q.sum()}

    first, last = sums(0), sums(steps*h)
    for options in ((), ("--check",)):
        found = told(start("--scene", "x.scene", "--engine", "isa", *options))
        assert found.keys() == first.keys() and len(first) == 8
        for name, (was, change, *_) in found.items():
            assert was == pytest.approx(first[name], rel=1e-6, abs=1e-6), name
            assert change == pytest.approx(last[name] - first[name], rel=0.06, abs=2e-4), name
    assert all(abs(last[name] - first[name]) > 0.01 for name in ("tie", "seat", "near_", "far__x")), "the pairs change"


SPRING = """links s(k = 4)
param m = 1
state x = 0
state v = 0
step 0.0625
x' = v
v' = sum(o in s: o.k*(o.x - x))/m
invariant energy = sum(objects: 0.5*m*v^2) + sum(pairs o in s: 0.5*o.k*(o.x - x)^2)
invariant momentum = sum(objects: m*v)
"""
FIVE = 'integrator = "leapfrog"; grid = { count = 5; }; links = { relation = "s"; grid = "structural"; }; only = { objects = 1; set = { x = 1.0; }; };'


@pytest.fixture
def spring(start, folder):
    """Five masses in a chain, of which one is pulled aside; `pair` is the term of the potential energy."""
    def spring(*options, model=SPRING, group=FIVE):
        (folder / "s.ode").write_text(model)
        (folder / "s.scene").write_text(f'config = "world"; engine = "fast"; steps = 200; groups = ( {{ program = "s.ode"; {group} }} );')
        return start("--scene", "s.scene", *options)
    return spring


def test_a_good_run_keeps_them_and_strict_is_silent(spring):
    done = spring("--check", "--strict=0.2", group=FIVE + " set = { h = 0.0078125; };")
    energy, momentum = (told(done)[name] for name in ("energy", "momentum"))
    assert done.returncode == 0 and done.stderr == "", done.stderr
    assert energy[0] == 4 and abs(energy[2]) < 1e-4 and abs(momentum[2]) < 1e-6 and abs(energy[3]) < abs(energy[1])
    assert spring("--strict", group=FIVE + " set = { h = 0.0078125; };").stderr == ""


@pytest.mark.parametrize("was, now", [("+ sum(pairs", "- sum(pairs"), ("0.5*o.k*(o.x - x)^2", "o.k*(o.x - x)^2")])
def test_a_wrong_pair_term_is_not_conserved(spring, was, now):
    """Nor by the second run, which tells it from a step that is too long."""
    done = spring("--check", "--strict=0.2", model=SPRING.replace(was, now), group=FIVE + " set = { h = 0.0078125; };")
    first, change, relative, again = told(done)["energy"]
    assert done.returncode == 3 and "energy of all objects has changed by" in done.stderr and "and --strict allows 0.2" in done.stderr
    assert abs(relative) > 0.2 and again == pytest.approx(change, rel=0.05)
    plain = spring(model=SPRING.replace(was, now), group=FIVE + " set = { h = 0.0078125; };")
    assert plain.returncode == 0 and re.search(r"s\.ode: warning: energy of all objects has changed by \S+ of its size, from \S+ to \S+$", plain.stderr, re.M)


def test_a_step_too_long_changes_them(spring):
    """Euler's method adds energy: by (1 + w^2 h^2) a step at most. Half the step, half of that."""
    euler = FIVE.replace("leapfrog", "euler") + " set = { h = 0.015625; };"
    done = spring("--check", "--strict", group=euler)
    first, change, relative, again = told(done)["energy"]
    assert done.returncode == 3 and 0.05 < relative and 0.3 < again/change < 0.6 and abs(told(done)["momentum"][2]) < 1e-6
    assert "energy of all objects has changed" in spring(group=euler).stderr
    assert spring("--strict", group=euler).returncode == 3


def test_compare_tells_what_each_makes_of_them(fp3, spring, folder):
    """Of the same steps as `run --check`, beside the solution, which keeps them. Half the step, half of what Euler's method adds. The energy of an object
    alone is not kept by the equations either: the one that is pulled aside begins with none, and gets half of 0.5 k x^2 from its springs."""
    model = SPRING + "invariant own = 0.5*m*v^2\n"
    told_at = {name: values for name, values in told(spring("--check", model=model, group=FIVE.replace("leapfrog", "euler"))).items()}

    def compared(model, *options):
        (folder / "s.ode").write_text(model)
        done = subprocess.run([fp3, "compare", "s.scene", "--json", "x.json", *map(str, options)], cwd=folder, capture_output=True, text=True, timeout=60)
        assert done.returncode == 0, done.stderr
        rows = json.loads((folder / "x.json").read_text())["invariants"]
        for row in rows:
            change = re.escape(f"{row['change']:.1e}")
            assert re.search(rf"^ *{row['h']:.6g}  {row['group'] or 'all objects'} +{row['invariant']} .* {change} ", done.stdout, re.M)
        return {(row["invariant"], row["parts"]): row for row in rows}

    found = compared(model, "--steps", 200)
    energy = found["energy", 1]
    # Energy grows, so it is largest in the end, where --check looks.
    assert energy["first"] == told_at["energy"][0] == 4 and energy["step"] == 200 and energy["group"] is None
    assert energy["change"] == pytest.approx(told_at["energy"][1], rel=0.06) and energy["relative"] == pytest.approx(told_at["energy"][2], rel=0.06)
    assert energy["method_change"] == pytest.approx(energy["change"], rel=1e-3) and abs(energy["solution_change"]) < 1e-5
    assert all(abs(found["momentum", parts][who]) < 1e-5 for parts in (1, 2, 4) for who in ("relative", "method_change", "solution_change"))
    short = compared(model, "--steps", 16)
    assert [short["energy", parts]["change"]/short["energy", 2*parts]["change"] for parts in (1, 2)] == pytest.approx([2.4, 2.2], rel=0.1)
    own = short["own", 4]
    assert own["group"] == "s" and own["object"] == 1 and own["relative"] is None and own["first"] == 0
    assert own["solution_change"] == pytest.approx(own["change"], rel=0.1) and own["solution_change"] > 1
    # A wrong term: the solution does not keep it.
    wrong = compared(model.replace("+ sum(pairs", "- sum(pairs"), "--steps", 16)["energy", 1]
    assert abs(wrong["solution_change"]) > 1
    (folder / "s.scene").write_text((folder / "s.scene").read_text().replace("} );", "gone = 8; } );"))
    assert {name for name, _ in compared(model, "--steps", 16)} == {"own"}


def test_three_bodies_at_rest(start, folder):
    """Burrau, 1913: masses 3, 4 and 5 at the corners of a triangle with sides 3, 4 and 5. Their energy is -(12/5 + 15/4 + 20/3); one passage is too
    close for steps of 2^-10."""
    (folder / "burrau.ode").write_text((folder / "stars.ode").read_text())
    (folder / "burrau.csv").write_text("m,x_x,x_y\n3,1,3\n4,-2,-1\n5,1,-1\n")
    (folder / "burrau.scene").write_text('steps = 3072; groups = ( { program = "burrau.ode"; integrator = "leapfrog"; points = "burrau.csv"; set = { h = 0.0009765625; }; } );')
    plain, strict = (start("--scene", "burrau.scene", "--engine", "isa", *options) for options in ((), ("--check", "--strict")))
    assert told(plain)["energy"][0] == pytest.approx(-(12/5 + 15/4 + 20/3)) and told(plain)["energy"][2] > 0.9
    assert plain.returncode == 0 and "energy of all objects has changed by 1 of its size" in plain.stderr
    assert strict.returncode == 3 and abs(told(strict)["momentum_x"][2]) < 1e-6 and told(strict).keys() == told(plain).keys()
    right = start("--scene", "burrau.scene", "--engine", "isa", "--check", "--strict", "--steps", 512)
    assert right.returncode == 0 and right.stderr == "" and all(abs(relative) < 1e-5 for _, _, relative, _ in told(right).values())
    rows = re.findall(r"^all objects +(\w+): error (\S+) RMS, (\S+) at most, of object (\d)$", strict.stdout, re.M)
    each = re.findall(r"^(\w+) .*object (\d) +error (\S+), relative", strict.stdout, re.M)
    for name, rms, most, object_ in rows:
        errors = {int(number): float(error) for word, number, error in each if word == name}
        assert float(most) == max(errors.values()) == errors[int(object_)]
        assert float(rms) == pytest.approx(math.sqrt(sum(error**2 for error in errors.values())/3), rel=0.1)
    assert len(rows) == 6


def test_scenes_of_the_project_keep_theirs(start):
    for scene, bound in (("membrane", 1e-5), ("eight", 1e-5), ("planets", 1e-5), ("players", 1e-3)):
        done = start("--scene", f"{scene}.scene", "--engine", "fast")
        assert done.returncode == 0 and done.stderr == "" and told(done) and all(abs(relative) < bound for _, _, relative, _ in told(done).values()), scene


def test_who_comes_and_goes_has_none(spring):
    done = spring("--check", group=FIVE + " gone = 100;")
    assert done.returncode == 0 and not told(done) and "not looked at    what underflows, and invariants" in done.stdout


HEAD = ("param m = 1\nshared G = 1\nstate x = 0\nlinks ties(k = 1)\nnear touch(x, 1, s = 0)\nstep 1\nx' = sum(o in ties: o.x) + sum(o in touch: o.s)\n"
        "remember o in touch: o.s = 1\n")


@pytest.mark.parametrize("line, place, expected", [
    ("invariant q = sum(objects: m)*x", "9:31", "found 'x', expected what all objects share, as this invariant is of all of them; or put it into sum(objects: ...)"),
    ("invariant q = sum(objects: sum(objects: m))", "9:28", "found 'sum', expected a term without another sum"),
    ("invariant q = sum(objects: sum(o in ties: o.x))", "9:28", "found 'sum', expected a term without another sum over neighbours"),
    ("invariant q = sum(pairs o in touch: o.s)", "9:37", "found 'o.s', expected a field that keeps its value"),
    ("invariant q = sum(pairs o in nobody: o.m)", "9:30", "found 'nobody', expected the name of a relation, as in sum(pairs o in springs: ...)"),
    ("invariant q = sum(pairs o in ties: o.y)", "9:38", "found 'y', expected a name that is defined above"),
    ("invariant q = max(objects: m)", "9:15", "found 'max', expected sum, which alone goes over all objects"),
    ("invariant q = sum(objects m)", "9:19", "found 'objects', expected a name that is defined above"),
    ("invariant q = sum(o in ties: o.k)", "9:15", "found 'sum', expected a sum over neighbours in an equation only"),
    ("d = sum(o in ties: o.k)\ninvariant q = sum(objects: d)", "10:15", "expected an invariant without a sum over neighbours (of all objects: sum(objects: ...)"),
    ("d = sum(objects: m)", "9:5", "found 'sum', expected a sum over all objects in an invariant only")])
def test_the_language_says_what_it_expects(fp3, tmp_path, line, place, expected):
    (tmp_path / "m.ode").write_text(HEAD + line + "\n")
    done = subprocess.run([fp3, "compile", "m.ode", "-c", "world"], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2 and done.stderr.startswith(f"m.ode:{place}: error: ") and expected in done.stderr, done.stderr


def test_a_program_has_nothing_of_them(fp3, folder):
    code = []
    for text in (SPRING, SPRING[:SPRING.index("invariant")]):
        (folder / "m.ode").write_text(text)
        done = subprocess.run([fp3, "compile", "m.ode", "-c", "world"], cwd=folder, capture_output=True, text=True, timeout=60)
        assert done.returncode == 0, done.stderr
        code.append(done.stdout)
    assert code[0] == code[1]


def test_a_recording_refuses_them(spring):
    done = spring("--output", "x.csv", "--observe", "energy")
    assert done.returncode == 2 and "'energy' is an invariant of all objects together, and a recording looks at each object by itself" in done.stderr


def test_units_of_groups_fit(start, folder):
    for name, other, unit in (("a", "b", "kg"), ("b", "a", "m")):
        (folder / f"{name}.ode").write_text(f"model {name}\nkind {other}(q [1])\nparam q = 1 [1]\nparam w = 1 [{unit}]\nstate x = 0\nall s({other})\nstep 1\n"
                                            "x' = sum(o in s: o.q)\ninvariant e = sum(objects: w)\n")
    (folder / "x.scene").write_text('groups = ( { program = "a.ode"; objects = 1; integrator = "euler"; }, { program = "b.ode"; objects = 1; integrator = "euler"; } );')
    done = start("--scene", "x.scene")
    assert done.returncode == 2 and "invariant 'e' is in [kg], and in [m] in group 'b', which it is added to" in done.stderr


FLYING = "shared reach = 1\nstate x = 0\nstate v = 0\nnear touch(x, reach)\nstep 0.0625\nx' = v\nv' = sum(o in touch: 0*o.x)\n"


@pytest.mark.parametrize("speed, is_told", [(15.9, False), (16.1, True)])
def test_what_moves_farther_than_its_relation_reaches_is_told(start, folder, speed, is_told):
    (folder / "f.ode").write_text(FLYING)
    (folder / "f.scene").write_text('config = "world"; steps = 3; groups = ( { program = "f.ode"; integrator = "leapfrog"; objects = 3; '
                                    f'spread = {{ x = [0, 100]; v = [0, -{speed}]; }}; }} );')
    done = start("--scene", "f.scene", "--strict")
    wanted = "object 2: it moves by 1.01 in a step of h = 0.0625, farther than 'touch' reaches, 1: it may pass others unseen; use a shorter step"
    assert done.returncode == (3 if is_told else 0) and (wanted in done.stderr) == is_told, done.stderr
