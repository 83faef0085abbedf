"""Objects at rest fall asleep by islands and wake: who, and when, against the rule in Python; the same words on every engine."""

import re
import subprocess

import numpy
import pytest
from test_world import floats, script  # noqa: F401

# Balls that push each other and are braked, some of them on links; drones fly on whatever happens.
MODEL = """
shared R = 0.4
state drone = 0
state x[2] = (0, 0)
state v[2] = (0, 0)
links ties(k = 4)
near touch(x, R)
{rest}
step 0.0078125
F = sum(o in ties: o.k*(norm(o.x - x) - 0.5)*(o.x - x)) + sum(o in touch: 40*(R - norm(o.x - x))*(x - o.x))
x' = v
drone' = 0
v' = drone > 0 ? 0*v : F - 8*v
"""
REST = "rest when norm(v) < 0.02 for 0.0625"
COUNTED = """state at_rest2 = 0
at_rest2' = 0
project at_rest2 = norm(v) < 0.02 ? at_rest2 + h/0.0625 : 0"""
STATES = ["x_x", "x_y", "v_x", "v_y"]
EVERY, REACH = 16, 0.4


class World:
    """Balls at random, and what happens to them at the beginning of each part of a run."""

    def __init__(self, seed, is_living, is_all=False):
        self.is_all = is_all
        self.random = random = numpy.random.default_rng(seed)
        self.n = n = int(random.integers(6, 20))
        self.columns = {"x_x": random.uniform(0, 2.5, n), "x_y": random.uniform(0, 2.5, n), "v_x": random.normal(0, 0.3, n), "v_y": random.normal(0, 0.3, n)}
        self.drone = random.random(n) < 0.1
        for k, name in enumerate(("v_x", "v_y")):
            self.columns[name] = numpy.where(self.drone, random.normal(0, 2, n), self.columns[name])
        pairs = {tuple(sorted(map(int, random.permutation(n)[:2]))) for _ in range(int(random.integers(0, 4)))}
        self.links = [ends for a, b in sorted(pairs) for ends in ((a, b), (b, a))]
        self.parts = [int(steps) for steps in random.integers(1, 60, 7)]
        total = sum(self.parts)
        self.born = random.integers(0, total, n)*(random.random(n) < 0.2)*is_living
        self.gone = numpy.where((random.random(n) < 0.2) & bool(is_living), self.born + random.integers(1, total, n), 0)
        self.told = []
        for _ in self.parts:
            kind, who = random.choice(["nothing", "nothing", "push", "wake", "sleep"]), int(random.integers(n))
            self.told.append({"push": [("v_x", who, 0.5)], "wake": [("at_rest", who, 0.0)], "sleep": [("at_rest", who, -1.0)], "nothing": []}[kind])

    def begin(self, skin):
        return [f"objects {self.n}", *(f"state {name} " + " ".join(repr(float(numpy.float32(v))) for v in column) for name, column in self.columns.items()),
                "state drone " + " ".join("1" if d else "0" for d in self.drone), f"near touch {REACH} {skin} x_x x_y",
                *(f"links ties {a} {b} 4" for a, b in self.links), *([] if self.links else ["none ties"]),
                *(["all others"] if self.is_all else []), *(f"live {i} 1 {b} {g}" for i, (b, g) in enumerate(zip(self.born, self.gone)) if b or g)]

    def lines(self, skin):
        for told, steps in zip(self.told, self.parts):
            yield from (f"set {name} {who} {value}" for name, who, value in told)
            yield f"run {steps}"
            yield "print " + " ".join([*STATES, "at_rest"])

    def lives(self, step):
        return (self.born <= step) & ((step < self.gone) | (self.gone == 0))


class Rule:
    """The rule, step by step, around an engine on which nobody sleeps: those who do are put back where they were."""

    def __init__(self, program, world, model):
        self.world, self.step, self.found = world, 0, []
        self.process = subprocess.Popen(["stdbuf", "-oL", program, "isa", "1", model, "euler", "plain"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.tell(world.begin(0))
        n = world.n
        self.now = {name: numpy.asarray(column, dtype=numpy.float32) for name, column in world.columns.items()}
        self.at_rest, self.asleep, self.lived = numpy.zeros(n, numpy.float32), numpy.zeros(n, bool), world.lives(0)

    def tell(self, lines):
        self.process.stdin.write("".join(line + "\n" for line in lines))
        self.process.stdin.flush()

    def state(self, name, column):
        return f"state {name} " + " ".join(repr(float(value)) for value in column)

    def islands(self, members, there):
        """Of the objects that are there: each pair that is linked or near, and of `members` the sets that such pairs make."""
        x, y = (self.now[name].astype(float) for name in ("x_x", "x_y"))
        near = {(i, j) for i in range(self.world.n) for j in range(self.world.n) if i != j and (self.world.is_all or (x[i] - x[j])**2 + (y[i] - y[j])**2 < REACH*REACH)}
        pairs = {(i, j) for i, j in near | set(self.world.links) if there[i] and there[j]}
        island = list(range(self.world.n))
        for i, j in pairs:
            if members[i] and members[j] and island[i] != island[j]:
                island = [island[i] if k == island[j] else k for k in island]
        return pairs, island

    def wake(self, movers, hit):
        """Who touches a mover wakes, with the island. Returns the movers that touch a sleeper."""
        pairs, island = self.islands(self.asleep, movers | self.asleep)
        touching = {j for i, j in pairs if self.asleep[i] and movers[j]}
        hit = {island[i] for i in hit if self.asleep[i]} | {island[i] for i, j in pairs if self.asleep[i] and movers[j]}
        for i in range(self.world.n):
            if self.asleep[i] and island[i] in hit:
                self.asleep[i], self.at_rest[i] = False, 0
        return touching

    def settle(self, told):
        lives = self.world.lives(self.step)
        changed = bool(told) or (lives != self.lived).any()
        for name, who, value in told:
            if name == "at_rest":
                self.at_rest[who] = value
                if lives[who]:
                    self.asleep[who] = value < 0
            else:
                self.now[name][who] = value
        if not changed:
            return
        touched = {who for name, who, _ in told if name != "at_rest"}
        self.asleep &= lives
        gone = self.lived & ~lives
        for i in range(self.world.n):
            if lives[i] and not self.lived[i]:
                self.asleep[i] = self.at_rest[i] < 0
        self.lived = lives
        self.wake((lives & ~self.asleep) | gone, touched)

    def advance(self):
        world, lives = self.world, self.lived
        self.tell([*(self.state(name, column) for name, column in self.now.items()), self.state("at_rest2", self.at_rest), "run 1", "print " + " ".join([*STATES, "at_rest2"])])
        after = {name: floats(self.process.stdout.readline()).astype(numpy.float32) for name in [*STATES, "at_rest"]}
        moved = lives & ~self.asleep
        for name in STATES:
            self.now[name] = numpy.where(moved, after[name], self.now[name])
        self.at_rest = numpy.where(moved, after["at_rest"], self.at_rest)
        self.step += 1
        rests = moved & (self.at_rest >= 1) & (self.step % EVERY == 0)
        touching = self.wake(moved, set())
        if rests.any():
            _, island = self.islands(moved, moved)
            kept = {island[i] for i in range(world.n) if moved[i] and (not rests[i] or i in touching)}
            for i in range(world.n):
                if moved[i] and island[i] not in kept:
                    self.asleep[i], self.at_rest[i] = True, -1

    def run(self):
        """The words after each part, and how many slept then."""
        rows, slept = [], []
        for told, steps in zip(self.world.told, self.world.parts):
            self.settle(told)
            for i in range(steps):
                if i and (self.world.lives(self.step) != self.lived).any():
                    self.settle([])
                self.advance()
            rows += [" ".join(f"{word:08x}" for word in column.astype(numpy.float32).view(numpy.uint32)) for column in [*(self.now[name] for name in STATES), self.at_rest]]
            slept.append(int(self.asleep.sum()))
        self.process.stdin.close()
        self.process.wait()
        return rows, slept


@pytest.fixture
def rule(build, tmp_path):
    def rule(world, model):
        path = tmp_path / "counted.ode"
        path.write_text(model.format(rest=COUNTED))
        return Rule(build / "tests/world_script", world, path).run()
    return rule


HOW = [("isa@world", 1, 0.1), ("fast@world", 1, 0), ("fast@world", 2, 0.3), ("interpreter@world", 1, 0.1), ("rtl@world", 1, 0.05), ("rtl@fabric", 1, 0.1)]


# What the rule says nothing of: integrators of several phases, and what pairs remember. Whom everybody sees sleeps when all do.
MORE = {"leapfrog": MODEL, "rk4": MODEL, "verlet": MODEL,
        "remember": MODEL.replace("x, R)", "x, R, s[2] = (0, 0))").replace("- 8*v", "- 8*v + 3*sum(o in touch: o.s)") + "remember o in touch: o.s = o.s + h*(o.v - v)\n"}
ALL = MODEL.replace("links ties(k = 4)", "links ties(k = 4)\nall others").replace("sum(o in touch", "sum(o in others: 0.01*(o.x - x)) + sum(o in touch")


@pytest.mark.parametrize("is_living", [False, True])
@pytest.mark.parametrize("is_all", [False, True])
def test_who_sleeps_is_as_the_rule_says(script, rule, is_living, is_all, long):
    slept, model = [], ALL if is_all else MODEL
    for seed in range(1, 41 if long else 5 if is_all else 9):
        world = World(seed, is_living, is_all)
        wanted, how_many = rule(world, model)
        slept += how_many
        for engine, threads, skin in HOW if long or seed < 3 else HOW[:2]:
            found = script(model.format(rest=REST), [*world.begin(skin), *world.lines(skin)], engine, "euler", threads=threads)
            assert found == wanted, (seed, engine, skin, next(i for i, (a, b) in enumerate(zip(found, wanted)) if a != b))
    assert max(slept) > 3 and (is_all or sum(n > 0 for n in slept) > len(slept) / 4), slept


@pytest.mark.parametrize("which", MORE)
def test_engines_agree(script, which, long):
    slept, text = 0, MORE[which].format(rest=REST)
    for seed in range(1, 11 if long else 3):
        world = World(seed, which != "remember" and seed % 2)
        found = [script(text, [*world.begin(skin), *world.lines(skin)], engine, "euler" if which == "remember" else which, threads=threads)
                 for engine, threads, skin in HOW]
        assert all(one == found[0] for one in found), (seed, [how for how, one in zip(HOW, found) if one != found[0]])
        slept += sum(line.count("bf800000") for line in found[0][4::5])
    assert slept > 10
