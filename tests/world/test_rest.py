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
CALM = {False: "0.02", True: "0.2"}  # where one that moves wakes all, they sleep sooner


class World:
    """Balls at random, and what happens to them at the beginning of each part of a run."""

    def __init__(self, seed, is_living, is_all=False):
        self.is_all = is_all
        self.random = random = numpy.random.default_rng(seed)
        self.n = n = int(random.integers(6, 20))
        self.columns = {"x_x": random.uniform(0, 2.5, n), "x_y": random.uniform(0, 2.5, n), "v_x": random.normal(0, 0.3, n), "v_y": random.normal(0, 0.3, n)}
        self.drone = (random.random(n) < 0.1) & (not is_all)
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
        path.write_text(model.format(rest=COUNTED.replace("0.02", CALM[world.is_all])))
        return Rule(build / "tests/world_script", world, path).run()
    return rule


HOW = [("isa@world", 1, 0.1), ("fast@world", 1, 0), ("fast@world", 2, 0.3), ("interpreter@world", 1, 0.1), ("rtl@world", 1, 0.05), ("rtl@fabric", 1, 0.1)]


# What the rule says nothing of: integrators of several phases, and what pairs remember. Whom everybody sees sleeps when all do.
MORE = {"leapfrog": MODEL, "rk4": MODEL, "verlet": MODEL,
        "remember": MODEL.replace("x, R)", "x, R, s[2] = (0, 0))").replace("- 8*v", "- 8*v + 3*sum(o in touch: o.s)") + "remember o in touch: o.s = o.s + h*(o.v - v)\n"}
ALL = MODEL.replace("links ties(k = 4)", "links ties(k = 4)\nall others").replace("sum(o in touch", "sum(o in others: 0.0005*(o.x - x)) + sum(o in touch")


@pytest.mark.parametrize("is_living", [False, True])
@pytest.mark.parametrize("is_all", [False, True])
def test_who_sleeps_is_as_the_rule_says(script, rule, is_living, is_all, long):
    slept, model = [], ALL if is_all else MODEL
    for seed in range(1, 41 if long else 5):
        world = World(seed, is_living, is_all)
        wanted, how_many = rule(world, model)
        slept += [n for n in how_many if n < world.n or is_all]
        for engine, threads, skin in HOW if long else HOW[:4] if seed > 1 or is_all else HOW[4 + is_living:5 + is_living]:
            found = script(model.format(rest=REST.replace("0.02", CALM[is_all])), [*world.begin(skin), *world.lines(skin)], engine, "euler", threads=threads)
            assert found == wanted, (seed, engine, skin, next(i for i, (a, b) in enumerate(zip(found, wanted)) if a != b))
    assert max(slept) > 3 and sum(n > 0 for n in slept) > len(slept) / 8, slept


@pytest.mark.parametrize("which", [which if which in ("rk4", "remember") else pytest.param(which, marks=pytest.mark.long) for which in MORE])
def test_engines_agree(script, which, long):
    slept, text = 0, MORE[which].format(rest=REST)
    for seed in range(1, 11 if long else 2):
        world = World(seed, which != "remember" and seed % 2)
        found = [script(text, [*world.begin(skin), *world.lines(skin)], engine, "euler" if which == "remember" else which, threads=threads)
                 for engine, threads, skin in (HOW if long else HOW[:5])]
        assert all(one == found[0] for one in found), (seed, [how for how, one in zip(HOW, found) if one != found[0]])
        slept += sum(line.count("bf800000") for line in found[0][4::5])
    assert slept > 3


def test_pairs_that_are_awake_remember_while_others_sleep(script):
    """Rows move when some fall asleep: what a pair remembers goes with it. Two groups far apart; the one of lower numbers lies still."""
    text = MORE["remember"].replace("v' = drone", "v' = x.x > 50 ? F - 8*v + 3*sum(o in touch: o.s) - (5 + 3*cos(9*t))*(x - (100.4, 0)) : drone")
    lines = ["objects 7", "state x_x 0 0.3 0.6 100 100.3 100.5 100.9", "state x_y 0 0 0 0 0 0.1 0", "near touch 0.4 0.1 x_x x_y", "none ties", "run 400", "print x_x x_y v_x v_y"]
    without = script(text.format(rest=""), lines, "isa", "euler")
    forgetful = script(text.format(rest="").replace("o.s = o.s", "o.s = 0*o.s"), lines, "isa", "euler")
    for engine, threads, skin in HOW[:5]:
        *words, sleeps = script(text.format(rest=REST), [*(line.replace("0.4 0.1", f"0.4 {skin}") for line in lines), "print at_rest"], engine, "euler", threads=threads)
        assert sleeps.split()[:3] == ["bf800000"]*3 and "bf800000" not in sleeps.split()[3:]
        assert [word.split()[3:] for word in words] == [word.split()[3:] for word in without] != [word.split()[3:] for word in forgetful], engine


LEVEL = """model level
state x[2] = (0, 0) [m]
step 0.0078125 [s]
x' = (0, 0) [m/s]
"""
PUSHER = """model pusher
state x[2] = (0, 0) [m]
state v[2] = (0, 0) [m/s]
step 0.0078125 [s]
x' = v
v' = (0, 0) [m/s^2]
"""
HEAP = """model heap
kind level(x[2] [m])
kind pusher(x[2] [m])
state x[2] = (0, 0) [m]
state v[2] = (0, 0) [m/s]
near touch(x, 0.5)
near stand(x, level.x, 0.5)
near pushed(x, pusher.x, 0.5)
rest when norm(v) < 0.02 for 0.25 [s]
step 0.0078125 [s]
a = sum(o in touch: 400*(0.5 - norm(o.x - x))*(x - o.x)) + sum(o in stand: 400*(0.5 - norm(o.x - x))*(x - o.x)) + sum(o in pushed: 400*(0.5 - norm(o.x - x))*(x - o.x))
x' = v
v' = a + (0, -4) - 8*v
"""
OBSERVER = """model observer
kind heap(x[2] [m])
state x[2] = (0, 0) [m]
state s = 0 [m*s]
near seen(x, heap.x, 100)
step 0.0078125 [s]
x' = (0, 0) [m/s]
s' = sum(o in seen: o.x.y)
"""
SCENE = """steps = 8;
groups = (
  {{ program = "heap.ode"; integrator = "{integrator}"; objects = 3; {skin} set = {{ x_x = 0.0; }}; spread = {{ x_y = [0.3, 1.1]; }}; {ties} }},
  {{ program = "level.ode"; integrator = "{integrator}"; objects = 1; {gone} }},
  {{ program = "pusher.ode"; integrator = "{integrator}"; objects = 1; set = {{ x_x = {start}; x_y = 0.3; v_x = 1.0; }}; }},
  {{ program = "observer.ode"; integrator = "{integrator}"; objects = 1; }}
);
"""


@pytest.fixture
def heap(fp3, tmp_path):
    """What each object of a small heap holds after so many steps, by name; bits, or what is said where it is refused."""
    for name, text in (("heap", HEAP.replace("[m/s^2]", "")), ("level", LEVEL), ("pusher", PUSHER), ("observer", OBSERVER)):
        (tmp_path / f"{name}.ode").write_text(re.sub(r" \[[^\]]*\]", "", text))

    def heap(steps, *options, engine="isa", integrator="euler", gone="", start=-50.0, skin="", status=0):
        (tmp_path / "heap.scene").write_text(SCENE.format(integrator=integrator, gone=gone, start=start, skin=skin, ties=""))
        done = subprocess.run([fp3, "run", "--scene", "heap.scene", "--all", "--engine", engine, "--config", "world", "--steps", str(steps), *map(str, options)],
                              cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == status, done.stdout + done.stderr
        if status:
            return done.stderr
        found = {}
        for name, value, bits in re.findall(r"^(\w+) +(\S+) +(0x\w+) +object", done.stdout, re.M):
            found.setdefault(name, []).append((float(value), bits))
        found["object_steps"] = int(re.search(r"^object_steps +(\d+)", done.stdout, re.M)[1])
        return found
    return heap


@pytest.mark.parametrize("integrator", ["euler", pytest.param("rk4", marks=pytest.mark.long)])
def test_a_heap_on_the_ground_sleeps_until_its_ground_is_gone(heap, integrator):
    """Another kind that never moves keeps nobody awake; where it goes, those that stand on it wake, and fall."""
    whole = heap(256, integrator=integrator)
    assert [value for value, _ in whole["at_rest"]] == [-1, -1, -1]
    more = heap(616, integrator=integrator)
    assert more["object_steps"] == whole["object_steps"]  # of the heap
    height = sum(value for value, _ in whole["x_y"][:3])
    assert more["s"][0][0] - whole["s"][0][0] == pytest.approx(360*0.0078125*height, rel=1e-4)  # who sleeps is seen where it lies
    assert heap(616, engine="fast", integrator=integrator) == more
    assert all(value < -2 for value, _ in heap(1300, integrator=integrator, gone="gone = 256;")["x_y"][:3])
    woken = heap(276, integrator=integrator, gone="gone = 256;")
    for engine, options, skin in (("fast", ("--threads", 2), ""), ("fast", ("--threads", 1), "skin = 0.0;"), ("rtl", (), "skin = 0.1;")):
        assert heap(276, *options, engine=engine, integrator=integrator, gone="gone = 256;", skin=skin) == woken, engine


def test_who_moves_and_never_rests_wakes_those_it_touches(heap):
    before = heap(640, start=-5.5)
    assert [value for value, _ in before["at_rest"]] == [-1, -1, -1]
    after = heap(672, start=-5.5)
    assert [value for value, _ in after["at_rest"]] == [0, 0, 0] and after == {**heap(672, engine="fast", start=-5.5), "object_steps": after["object_steps"]}
    assert after["x_x"][0][0] > 0.01


def test_a_checkpoint_has_those_that_sleep(heap, tmp_path):
    for half in (100, 640, 650):
        file = tmp_path / f"{half}.checkpoint"
        heap(half, "--checkpoint", file, start=-5.5)
        again = heap(700, "--restart", file, start=-5.5)
        assert {**again, "object_steps": 0} == {**heap(700, start=-5.5), "object_steps": 0}


def test_nobody_awake_takes_no_cycle(fp3, tmp_path):
    (tmp_path / "one.ode").write_text("model one\nstate x = 0\nstate v = 1\nrest when v < 0.1 for 0.5\nstep 0.125\nx' = v\nv' = -v\n")
    said = [subprocess.run([fp3, "run", "one.ode", "--objects", "3", "--engine", "rtl", "--config", "world", "--steps", steps, "--all"], cwd=tmp_path, capture_output=True, text=True).stdout
            for steps in ("31", "32", "4000")]
    cycles = [int(re.search(r"^cycles +(\d+)", text, re.M)[1]) for text in said]
    assert cycles[0] < cycles[1] == cycles[2] and re.findall("^[xv] .*", said[1], re.M) == re.findall("^[xv] .*", said[2], re.M)


def test_refused(heap, fp3, tmp_path):
    (tmp_path / "one.ode").write_text("model one\nstate x = 0\nstate v = 1\nrest when v < 0.1 for 1\nstep 0.1\nx' = v\nv' = -v\n")

    def said(*options):
        done = subprocess.run([fp3, "run", "one.ode", *options], cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 2, done.stdout + done.stderr
        return done.stderr
    assert "objects that fall asleep at rest: a program has `sleep`, as for steps that each object chooses" in said("-c", "many_full", "--tolerance", "1e-3")
    assert "objects that fall asleep at rest: a configuration that interleaves is needed" in said("-c", "single_full")


@pytest.mark.parametrize("line, message", [
    ("rest when v < 0.1", "4:18: error: found end of line, expected an operator or `for`, and then a time"),
    ("rest when v < 0.1 for 0", "4:23: error: found '0', expected a time above 0"),
    ("rest when v < 0.1 for -1", "4:23: error: found '-', expected a time above 0"),
    ("rest when v < 0.1 for 1e-60", "4:23: error: found '1e-60', expected a time step from"),
    ("rest when v < 0.1 for 1 [m]", "4:23: error: found '1', expected the unit of the step (line 6)"),
    ("rest when v < 0.1 for v", "4:23: error: found 'v', expected a number"),
    ("rest when (v, v) for 1", "4:11: error: found '(', expected a number as the condition"),
    ("rest when v < 0.1 for 1\nrest when v < 0.2 for 1", "5:1: error: found 'rest', expected only one 'rest' (line 4 has one)"),
    ("for i in 1..2: rest when v < i for 1", "4:16: error: found 'rest', expected only one 'rest' (line 4 has one) (where i = 2)"),
    ("state at_rest = 0\nrest when v < 0.1 for 1", "5:1: error: found 'rest', expected no 'at_rest' beside it (line 4 declares this one)"),
    ("rest when v < 0.1 for 1\nparam at_rest = 0", "5:7: error: found 'at_rest', expected a new name (line 4 declares this one)"),
    ("rest when v < 0.1 for 1\nat_rest' = 1", "5:1: error: found 'at_rest', expected only one equation like this"),
])
def test_messages(fp3, tmp_path, line, message):
    (tmp_path / "x.ode").write_text(f"model one\nstate x = 0\nstate v = 1\n{line}\n\nstep 0.1 [s]\nx' = v\nv' = -v\n".replace("\n\nstep", "\n\nstep" if "\n" not in line else "\nstep"))
    done = subprocess.run([fp3, "compile", "x.ode"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2 and message in done.stderr, done.stderr
