"""Objects that are born and gone where objects see each other: the words of a run without those that do not live, on every engine."""

import csv
import re

import numpy
import pytest
from test_remember import BREAKING, COUNTED, GRAINS, fallen
from test_world import ENGINES, WORLDS, balls, floats, row, script  # noqa: F401

# Links with a field, near and all, by every function; no hidden state goes from step to step.
ALL_KINDS = """
shared R = 0.4
param m = 1
state x[2] = (0, 0)
state v[2] = (0, 0)
state w = 0
links ties(k = 1)
near touch(x, R)
all others
step 0.01
F = sum(o in ties: o.k*(o.x - x)) + sum(o in touch: (R - norm(o.x - x))*(x - o.x)) + sum(o in others: 0.01*o.m*(o.x - x))
x' = v
v' = F/m
n = count(o in touch: o.x.x > x.x) + 10*any(o in touch) + 100*count(o in ties) + 0.001*count(o in others)
w' = n + 0.1*min(o in others: o.x.x, x.x) + 0.01*max(o in ties: o.k, 0)
"""


def all_kinds(n, seed):
    random = numpy.random.default_rng(seed)
    m = random.uniform(0.5, 2, n).astype(numpy.float32)
    return [f"objects {n}", row("param", "over_m", 1 / m.astype(float)), row("param", "m", m),
            *(row("state", name, random.uniform(-1, 1, n)) for name in STATES.split()),
            *(f"links ties {a} {b} {random.uniform(0.5, 2)!r}" for a in range(n) for b in random.permutation(n)[:random.integers(5)] if b != a),
            "near touch 0.4 0.1 x_x x_y", "all others"]


STATES = "x_x x_y v_x v_y w"
LIVING = {**WORLDS, **{f"kinds {n}": (ALL_KINDS, all_kinds(n, n), STATES) for n in (3, 17, 40)}}


class Scene:
    """The objects of a world, that live from `born` to `gone`, each at random."""

    def __init__(self, world, seed, steps):
        self.model, lines, states = world
        random = numpy.random.default_rng(seed)
        self.n, self.steps, self.states = int(lines[0].split()[1]), steps, states.split()
        self.other = [line for line in lines if line.split()[0] in ("near", "all")]
        self.links = [line.split() for line in lines if line.startswith("links")]
        self.columns = {name: numpy.array([float(word) for word in words]) for kind, name, *words in map(str.split, lines) if kind in ("state", "param")}
        self.born = random.integers(0, steps, self.n) * (random.random(self.n) < 0.5)
        self.gone = numpy.where(random.random(self.n) < 0.5, self.born + random.integers(1, steps + 1, self.n), 0)

    def lives(self, step):
        return [i for i in range(self.n) if self.born[i] <= step and (step < self.gone[i] or not self.gone[i])]

    def lines(self, who, columns, skin=None):
        place = {str(object_): str(i) for i, object_ in enumerate(who)}
        near = [line if skin is None else re.sub(r"^(near \S+ \S+) \S+", rf"\1 {skin}", line) for line in self.other]
        return [f"objects {len(who)}", *(row("state", name, values[who]) for name, values in columns.items()), *near,
                *(f"none {name}" for name in {words[1] for words in self.links}),
                *(" ".join(["links", name, place[a], place[b], *fields]) for _, name, a, b, *fields in self.links if a in place and b in place)]

    def whole(self, parts, skin=None):
        """One run, in so many parts."""
        return [*self.lines(list(range(self.n)), self.columns, skin), *(f"live {i} 1 {b} {g}" for i, (b, g) in enumerate(zip(self.born, self.gone)) if b or g),
                *(line for i in range(parts) for line in (f"run {self.steps * (i + 1) // parts - self.steps * i // parts}", "print " + " ".join(self.states)))]

    def without_the_dead(self, script, integrator, parts):
        """From change to change, and to the end of each part, a scene of those that live and of no others."""
        columns = {**{name: numpy.zeros(self.n) for name in self.states}, **{name: values.copy() for name, values in self.columns.items()}}
        told = [self.steps * (i + 1) // parts for i in range(parts)]
        ends = sorted({*told, *(int(s) for s in (*self.born, *self.gone) if 0 < s < self.steps)})
        wanted = []
        for begin, end in zip([0, *ends], ends):
            who = self.lives(begin)
            if who:
                printed = script(self.model, [*self.lines(who, columns), f"run {end - begin}", "print " + " ".join(self.states)], "isa", integrator)
                for name, line in zip(self.states, printed):
                    columns[name][who] = floats(line)
            if end in told:
                wanted += [" ".join(f"{bits:08x}" for bits in columns[name].astype(numpy.float32).view(numpy.uint32)) for name in self.states]
        return wanted


@pytest.mark.parametrize("name, integrator", [*((name, "leapfrog") for name in LIVING), *(
    pytest.param(name, "rk4", marks=[] if name in ("kinds 17", "chain", "mixed") else pytest.mark.long) for name in LIVING)])
def test_those_who_do_not_live_are_in_nobodys_list(script, name, integrator):
    scene = Scene(LIVING[name], 5, 19)
    wanted = scene.without_the_dead(script, integrator, 3)
    assert len(set(wanted[-1].split())) > 2
    for engine, threads in (("isa", 1), ("fast", 1), ("fast", 2), ("interpreter", 1), ("rtl", 1)):
        for skin in (0.1, 0, 3) if scene.other and engine != "rtl" else (0.1,):
            assert script(scene.model, scene.whole(3, skin), engine, integrator, threads=threads) == wanted, (engine, threads, skin)


def test_many_in_rows_by_where_they_are(script):
    """More than 256 that are near each other: engine fast has them in an order of its own, and those that live in front."""
    scene = Scene((WORLDS["balls"][0], balls(500), WORLDS["balls"][2]), 8, 30)
    wanted = scene.without_the_dead(script, "leapfrog", 4)
    for engine, threads, skin in (("isa", 1, 0.02), ("fast", 1, 0), ("fast", 2, 0), ("fast", 2, 0.02), ("interpreter", 1, 0)):
        assert script(scene.model, scene.whole(4, skin), engine, threads=threads) == wanted, (engine, threads, skin)


def test_links_that_are_given_while_some_do_not_live(script):
    """New links replace those of all objects, and one is there as soon as both of its ends live."""
    model = "state x = 0\nstate s = 0\nlinks ties(k = 1)\nstep 1\nx' = 0\ns' = sum(o in ties: o.k*o.x)\n"
    begin = ["objects 4", row("state", "x", [1, 10, 100, 1000]), "live 1 1 2 0", "live 3 1 0 4"]
    lines = [*begin, *(f"links ties {a} {b} 1" for a, b in ((0, 1), (1, 0), (0, 2), (2, 0))), "run 1", "print s", "run 1", "print s",
             *(f"links ties {a} {b} 2" for a, b in ((0, 1), (1, 0), (2, 3), (3, 2), (1, 3))), "run 1", "print s", "run 2", "print s",
             "live 1 1 0 5", "live 3 1 5 0", "run 1", "print s", "live 0 4 0 0", "run 1", "print s"]
    wanted = [[100, 0, 1, 0], [200, 0, 2, 0], [220, 2002, 2002, 200], [260, 4006, 4002, 400], [260, 4006, 6002, 600], [280, 6008, 8002, 800]]
    for engine in ENGINES:
        assert [list(floats(line)) for line in script(model, lines, engine, "euler")] == wanted, engine


def test_who_is_dead_has_not_failed_and_failures_name_the_living(script):
    """At one place: invalid as soon as both live. The run that finds out who failed has the lifetimes of the first."""
    model = "state x = 0\nstate s = 0\nnear touch(x, 2)\nstep 1\nx' = 0\ns' = sum(o in touch: 1/sqrt(o.x - x))\n"
    lines = ["objects 3", row("state", "x", [0, 1, 1]), "near touch 2 0.5 x", "live 1 1 0 3", "live 2 1 5 0", "run 4", "failure", "run 3", "failure"]
    seen = script(model, lines, "isa", "euler")
    for engine in ENGINES:
        assert script(model, lines, engine, "euler") == seen, engine


# ---- what pairs remember ----

# As one group, and as one whose engine is formed anew for those that live (sw/engine/kinds.c); nobody falls asleep.
FORMED = "rest when x < -1000 for 1\n"
HOW = [("isa", 1), ("fast", 1), ("fast", 2), ("interpreter", 1), ("rtl", 1)]


def lives_of(n, steps, seed):
    random = numpy.random.default_rng(seed)
    born = random.integers(0, steps, n)*(random.random(n) < 0.4)
    return born, numpy.where(random.random(n) < 0.5, born + random.integers(1, steps, n), steps + 9)


def told(born, gone):
    return [f"live {i} 1 {b} {g}" for i, (b, g) in enumerate(zip(born, gone))]


@pytest.mark.parametrize("more", ["", FORMED])
def test_near_pairs_forget_who_goes(script, more):
    """Exact: how long each pair has been near while both lived. In the end some live again that had gone."""
    n, parts = 30, (5, 7, 4)
    start, speed = [(i * 11) % 41 for i in range(n)], [(i * 5) % 7 - 3 for i in range(n)]
    x, v, s, seen, lasted, since, wanted = start, speed, [0] * n, [0] * n, {}, {}, []
    born, gone = lives_of(n, 12, 3)
    again = [i for i in range(n) if i % 3 == 0]
    for step in range(sum(parts)):
        lives = [born[i] <= step < gone[i] or (step >= 12 and i in again) for i in range(n)]
        lasted, since = ({pair: value for pair, value in of.items() if lives[pair[0]] and lives[pair[1]]} for of in (lasted, since))

        def near(i, j, lives=lives):
            return i != j and abs(x[i] - x[j]) < 4 and lives[i] and lives[j]
        s = [s[i] + sum(lasted.get((i, j), 0) for j in range(n) if near(i, j)) for i in range(n)]
        x = [a + b*live for a, b, live in zip(x, v, lives)]
        seen = [sum(since.get((i, j), 0) for j in range(n) if near(i, j)) if lives[i] else seen[i] for i in range(n)]
        v = [-b if (a < 0 or a > 40) and live else b for a, b, live in zip(x, v, lives)]
        pairs = [(i, j) for i in range(n) for j in range(n) if near(i, j)]
        since = {pair: since[pair] if pair in since else None for pair in pairs}
        # `t` is the time of the object that remembers
        made = [sum(born[i] <= k < gone[i] or (k >= 12 and i in again) for k in range(step + 1)) for i in range(n)]
        since = {pair: made[pair[0]] if value is None else value for pair, value in since.items()}
        lasted = {pair: lasted.get(pair, 0) + 1 for pair in pairs}
        if step + 1 in (5, 12, 16):
            wanted += [x, s, seen]
    assert {1, 2, 4} <= set(lasted.values()) and any(born[i] == 0 and gone[i] < 12 for i in again)
    runs = [f"run {parts[0]}", "print x s seen", f"run {parts[1]}", "print x s seen", *(f"live {i} 1 0 0" for i in again), f"run {parts[2]}", "print x s seen"]
    for engine, threads in HOW:
        for skin in (1,) if "rtl" in engine else (0, 100):
            lines = [f"objects {n}", row("state", "x", start), row("state", "v", speed), f"near touch 4 {skin} x", *told(born, gone), *runs]
            assert [list(floats(line)) for line in script(COUNTED + more, lines, engine, "euler", threads=threads)] == wanted, (engine, skin)


@pytest.mark.parametrize("more", ["", FORMED])
def test_links_remember_while_an_end_does_not_live(script, more):
    """Exact: a link that broke before one of its ends went is broken when both live again, and one that did not goes on."""
    n, parts = 40, (3, 4, 5)
    x, v = [4*i + (i * 7 % 5) for i in range(n)], [(i * 3 % 5) - 2 for i in range(n)]
    links = {(i, j): 1 for i in range(n) for j in range(n) if abs(i - j) == 1}
    begin = [f"objects {n}", row("state", "x", x), row("state", "v", v), *(f"links ties {a} {b} 1 1" for a, b in links)]
    born, gone = lives_of(n, 7, 5)
    back = [i for i in range(n) if i % 2]
    wanted, kept = [], set()
    for step in range(sum(parts)):
        lives = [born[i] <= step < gone[i] or (step >= 7 and i in back) for i in range(n)]
        there = {pair for pair in links if lives[pair[0]] and lives[pair[1]]}
        kept |= {pair for pair in links if pair not in there and not links[pair]}
        pull = [sum(links[i, j] * (x[j] - x[i]) for j in (i - 1, i + 1) if (i, j) in there) for i in range(n)]
        x, v = [a + b*live for a, b, live in zip(x, v, lives)], [a + b / 4 for a, b in zip(v, pull)]
        links = {pair: (whole if abs(x[pair[1]] - x[pair[0]]) <= 8 else 0) if pair in there else whole for pair, whole in links.items()}
        if step + 1 in (3, 7, 12):
            wanted += [x, v]
    assert any(pair in there for pair in kept) and 0 < sum(links.values()) < len(links)
    runs = [f"run {parts[0]}", "print x v", f"run {parts[1]}", "print x v", *(f"live {i} 1 0 0" for i in back), f"run {parts[2]}", "print x v"]
    for engine, threads in [*HOW, ("rtl@fabric", 1)]:
        assert [list(floats(line)) for line in script(BREAKING + more, [*begin, *told(born, gone), *runs], engine, "euler", threads=threads)] == wanted, engine


@pytest.mark.parametrize("n, integrator", [(24, "leapfrog"), pytest.param(24, "rk4", marks=pytest.mark.long), (300, "leapfrog")])
def test_grains_that_come_and_go(script, n, integrator, long):
    """The same words on every engine, with each skin; with 300, engine fast has an order of its own."""
    born, gone = lives_of(n, 30, 7)
    found = set()
    for engine, threads in HOW[:4] if n == 300 else [*HOW, ("rtl@fabric", 1)] if long else HOW:
        for skin in (0.02,) if "rtl" in engine else (0, 0.02):
            lines = [*fallen(n, skin), *told(born, gone), "run 13", "run 17", "print x_x x_y x_z v_x v_y v_z", "failure"]
            found.add(tuple(script(GRAINS, lines, engine, integrator, threads=threads)))
    assert len(found) == 1 and found.pop()[-1] == "none"


def test_who_fails_is_found_where_pairs_remember(script):
    """The run that finds out begins with what links held when the first one began, also of those that did not live then."""
    model = "state x = 0\nstate s = 0\nlinks ties(n = 1)\nstep 1\nx' = 0\ns' = sum(o in ties: o.n)\nremember o in ties: o.n = 16*o.n\n"
    lines = ["objects 3", *(f"links ties {a} {b} {n}" for a, b, n in ((0, 1, 0), (1, 0, 0), (1, 2, 1), (2, 1, 1))), "live 2 1 0 20", "run 15", "run 10", "live 2 1 0 0", "run 20", "failure"]
    seen = script(model, lines, "isa", "euler")
    assert seen == ["object 1 in step 37: overflow"]
    for engine, threads in HOW:
        assert script(model, lines, engine, "euler", threads=threads) == seen, engine


COMES = """steps = 24;
groups = ( { program = "all.ode"; integrator = "leapfrog"; objects = 30;
             random = { position = "x"; from = [-1.0, -1.0]; to = [1.0, 1.0]; apart = 0.01; seed = 3; };
             links = { relation = "ties"; file = "ties.csv"; }; born = [0, 40]; gone = [20, 59]; } );
"""


def test_a_scene_on_every_engine_and_on_eight_lanes(start, folder):
    """What is written of each snapshot, with who lives; the links that a recording tells are all."""
    (folder / "all.ode").write_text(ALL_KINDS)
    (folder / "ties.csv").write_text("a,b,k\n" + "".join(f"{a},{b},{1 + a / 8}\n" for a, b in ((i, (7 * i + 3) % 30) for i in range(30)) if a < b))
    (folder / "x.scene").write_text(COMES)
    said = {}
    for options in (("-e", "isa"), ("-e", "fast"), ("-e", "rtl"), ("-e", "rtl", "-c", "fabric"), ("-e", "fast", "-c", "fabric", "--threads", 2)):
        done = start("--scene", "x.scene", *options, "--every", 5, "--output", "x.csv")
        assert done.returncode == 0, done.stderr
        assert re.search("^alive +1[0-9] of 30, 11 not born yet, 4 gone$", done.stdout, re.M), done.stdout
        said[options] = (folder / "x.csv").read_text()
    assert len(set(said.values())) == 1
    lives = {(int(one["step"]), int(one["object"])): int(one["life"]) for one in csv.DictReader(said[("-e", "isa")].splitlines())}
    assert [lives[5, i] for i in (0, 4, 5)] == [1, 1, 0] and [lives[20, i] for i in (0, 1, 15, 16)] == [2, 1, 1, 0]


def test_what_is_refused(start, refused, folder, build):
    (folder / "alone.ode").write_text("state x = 0\nstep 1\nx' = 1\n")
    assert "has no sleep" in refused('config = "world"; steps = 3;\ngroups = ( { program = "alone.ode"; objects = 3; born = 1; } );\n')
    text = 'steps = 3;\ngroups = ( { program = "stars.ode"; objects = 3; born = [0, 1]; spread = { x_x = [0, 1]; }; } );\n'
    (folder / "x.scene").write_text(text)
    done = start("--scene", "x.scene", "--cycle-limit", 9, "-e", "rtl")
    assert done.returncode == 2 and "births and ends of objects split the run" in done.stderr, done.stderr
