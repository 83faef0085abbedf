"""`remove`: an object whose event ends its life, against the rule in Python around an engine on which nobody is removed; the same words on every engine."""

import csv
import re
import subprocess

import numpy
import pytest
from test_living import ALL_KINDS, STATES, all_kinds
from test_remember import COUNTED
from test_rest import ALL, MODEL, REST
from test_world import floats, row, script  # noqa: F401

AWAY = "when x.x*x.x + x.y*x.y > 1.3: v = -v, w = w + 1, {}\nwhen w > 6: {}\n"
ALONE = """state x[2] = (0, 0)
state v[2] = (0, 0)
state w = 0
step 0.01
x' = v
v' = (0, t) + x
w' = 1
"""
HIT = "state hit = 0\nhit' = 0\n"


def random_states(n, seed, names):
    random = numpy.random.default_rng(seed)
    return {name: random.uniform(-1, 1, n).astype(numpy.float32) for name in names}


class Rule:
    """Step by step: whoever the event has hit lives no longer. `live` knows of nobody who is removed."""

    def __init__(self, program, model, config, integrator, world):
        self.command = ["stdbuf", "-oL", program, f"isa@{config}", "1", model, integrator, "plain"]
        self.world = world

    def tell(self, lines):
        self.process.stdin.write("".join(line + "\n" for line in lines))
        self.process.stdin.flush()

    def words(self, name):
        self.tell([f"print {name}"])
        return self.process.stdout.readline().strip()

    def run(self):
        """The words after each part, and how many are removed then."""
        world, step, found, gone = self.world, 0, [], []
        self.process = subprocess.Popen(self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.tell(world.begin(0))
        for told, steps in world.parts:
            for name, who, value in told:
                born, end = world.lives.get(who, (0, 0))
                self.tell([f"set {'hit' if name == 'is_removed' else name} {who} {value}"])
                if name == "is_removed":
                    self.tell([f"live {who} 1 1000000000 0" if value else f"live {who} 1 {born} {end}"])
            for _ in range(steps):
                before = floats(self.words("hit"))
                self.tell(["run 1"])
                step += 1
                for who in numpy.flatnonzero(floats(self.words("hit")) > before):
                    self.tell([f"live {who} 1 {min(world.lives.get(who, (0, 0))[0], step - 1)} {step}"])
            found += [self.words(name) for name in [*world.states, "hit"]]
            gone.append(numpy.count_nonzero(floats(found[-1])))
        self.process.stdin.close()
        self.process.wait()
        return found, gone


class World:
    """Its objects, and what happens: before each part of a run something is written."""

    def __init__(self, text, event, lines, states, parts, lives=None):
        self.text, self.event, self.given, self.states, self.parts, self.lives = text, event, lines, states, parts, lives or {}

    def begin(self, skin):
        return [*(re.sub(r"^(near \S+ \S+) \S+", rf"\1 {skin}", line) for line in self.given), *(f"live {i} 1 {b} {g}" for i, (b, g) in self.lives.items())]

    def lines(self, skin):
        yield from self.begin(skin)
        for told, steps in self.parts:
            yield from (f"set {name} {who} {value}" for name, who, value in told)
            yield f"run {steps}"
            yield "print " + " ".join([*self.states, "is_removed"])
        yield "failure"


PARTS = [([], 7), ([("is_removed", 1, 1), ("v_x", 2, 0.5)], 12), ([("is_removed", 1, 0)], 1), ([], 30)]
WORLDS = {
    "alone": World(ALONE, AWAY, ["objects 40", *(row("state", name, values) for name, values in random_states(40, 4, STATES.split()).items())], STATES.split(), PARTS),
    "sees": World(ALL_KINDS, AWAY, all_kinds(24, 6), STATES.split(), PARTS),
    "lives": World(ALL_KINDS, AWAY, all_kinds(24, 7), STATES.split(), PARTS, {0: (3, 30), 5: (9, 0), 6: (0, 20), 7: (0, 8)}),
    "formed": World(ALL_KINDS, AWAY + "rest when w < -1000 for 1\n", all_kinds(24, 8), STATES.split(), PARTS, {5: (9, 0), 6: (0, 20)}),
}
HOW = {"world": [("isa", 1, 0), ("fast", 1, 0), ("fast", 2, 0.3), ("interpreter", 1, 0.1), ("rtl", 1, 0.1)],
       "many_full": [("isa", 1, 0), ("fast", 1, 0), ("fast", 2, 0), ("interpreter", 1, 0), ("rtl", 1, 0)],
       "single_full": [("isa", 1, 0), ("fast", 1, 0), ("rtl", 1, 0)]}


@pytest.fixture
def rule(build, tmp_path):
    def rule(world, integrator, config):
        path = tmp_path / "hit.ode"
        path.write_text(world.text + HIT + world.event.format("hit = 1", "hit = 1"))
        return Rule(build / "tests/world_script", path, config, integrator, world).run()
    return rule


def check(script, world, wanted, integrator, config):
    for engine, threads, skin in HOW[config]:
        *found, failure = script(world.text + world.event.format("remove", "remove"), list(world.lines(skin)), f"{engine}@{config}", integrator, threads=threads)
        assert failure == "none" and found == wanted, (engine, threads, skin, next(i for i, (a, b) in enumerate(zip(found, wanted)) if a != b))


@pytest.mark.parametrize("name, integrator, config", [
    ("alone", "rk4", "many_full"), ("sees", "leapfrog", "world"), ("lives", "leapfrog", "world"), ("formed", "leapfrog", "world"),
    *(pytest.param(name, "rk4", "world", marks=pytest.mark.long) for name in ("sees", "lives", "formed"))])
def test_who_is_removed_is_as_the_rule_says(script, rule, name, integrator, config):
    wanted, gone = rule(WORLDS[name], integrator, config)
    assert 1 < gone[0] < gone[1] < gone[-1] < len(wanted[0].split()) - 1, gone
    check(script, WORLDS[name], wanted, integrator, config)


def test_one_object(script, rule):
    """Of a machine that has one alone."""
    world = World(ALONE, AWAY, ["objects 1", "state x_x 1", "state v_x 0.4"], STATES.split(), [([], 20), ([], 30), ([("is_removed", 0, 0), ("x_x", 0, 0.5)], 9)])
    wanted, gone = rule(world, "rk4", "single_full")
    assert gone == [0, 1, 0] and wanted[:5] != wanted[6:11]
    check(script, world, wanted, "rk4", "single_full")


def test_pairs_forget_who_is_removed_and_links_do_not(script, rule):
    n = 30
    text = COUNTED.replace("step 1\n", "links ties(m = 1)\nstep 1\n").replace("s' = sum(o in touch: o.n)", "s' = sum(o in touch: o.n) + 100*sum(o in ties: o.m)")
    world = World(text + "remember o in ties: o.m = o.m + 1\n", "when x > 36 and v > 1: v = -1, {}\nwhen seen > 90: {}\n",
                  [f"objects {n}", row("state", "x", [(i * 11) % 41 for i in range(n)]), row("state", "v", [(i * 5) % 7 - 3 for i in range(n)]), "near touch 4 1 x",
                   *(f"links ties {a} {b} 1" for i in range(n - 1) for a, b in ((i, i + 1), (i + 1, i)))], ["x", "v", "s", "seen"],
                  [([], 6), ([("is_removed", 4, 1), ("is_removed", 9, 1)], 5), ([("is_removed", 4, 0), ("is_removed", 9, 0)], 9)])
    wanted, gone = rule(world, "euler", "world")
    assert 2 < gone[1] < gone[2] < n - 5, gone
    check(script, world, wanted, "euler", "world")


@pytest.mark.parametrize("model", [MODEL, pytest.param(ALL, marks=pytest.mark.long)])
def test_what_leans_on_it_wakes(script, rule, model):
    """Objects at rest, of which some are removed by themselves, and some by the caller: the rule of sleep, with the ends that the rule here finds."""
    random = numpy.random.default_rng(3)
    columns = {"x_x": random.uniform(0, 2.5, 16), "x_y": random.uniform(0, 2.5, 16), "v_x": random.normal(0, 0.3, 16), "v_y": random.normal(0, 0.3, 16)}
    world = World(model.format(rest=REST.replace("0.02", "0.1")), "when t > 0.5 and x.x > 1.5 and v.x*v.x > 0.0004: {}\nwhen x.y > 1.5 and t > 0.75: v = (0, 0), {}\n",
                  ["objects 16", *(row("state", name, values) for name, values in columns.items()), "near touch 0.4 0.1 x_x x_y", "links ties 0 1 4", "links ties 1 0 4",
                   *(["all others"] if model is ALL else [])], ["x_x", "x_y", "v_x", "v_y", "at_rest"],
                  [([], 60), ([], 30), ([("is_removed", 3, 1), ("is_removed", 8, 1)], 40), ([("is_removed", 3, 0)], 30)])
    wanted, gone = rule(world, "euler", "world")
    assert any("bf800000" in line for line in wanted[4::6]) and 0 < gone[1] < gone[2] < 14, gone
    check(script, world, wanted, "euler", "world")


def test_other_words_and_lanes(script):
    world, text = World(ALL_KINDS, AWAY, all_kinds(24, 6), STATES.split(), PARTS[:2]), ALL_KINDS + AWAY.format("remove", "remove")
    for config, others in (("world_bfloat", ("fast", "rtl")), ("world_log", ("fast",)), ("fabric", ("fast", "rtl"))):
        found = [script(text, list(world.lines(0.1)), f"{engine}@{config}", "euler") for engine in ("isa", *others)]
        assert all(one == found[0] for one in found) and len(set(found[0][-2].split())) == 2, config


def test_who_fails_is_found(script):
    """The run that finds out removes the same objects: whoever comes to the same place as another one, and is alone there at last, does not fail."""
    model = "state x = 0\nstate s = 0\nnear touch(x, 2)\nstep 1\nx' = 0\ns' = sum(o in touch: (o.x - x)/abs(o.x - x))\nwhen t >= {}: remove\n"
    lines = ["objects 3", row("state", "x", [0, 1, 1]), "near touch 2 0.5 x", "set is_removed 2 1", "run 4", "failure", "set is_removed 2 0", "run 3", "failure"]
    seen = script(model.format(100), lines, "isa", "euler")
    assert seen[0] == "none" and "step" in seen[1] and "at the same place" in seen[1]
    for engine in ("fast", "interpreter", "rtl"):
        assert script(model.format(100), lines, engine, "euler") == seen, engine
    for engine in ("isa", "fast", "rtl"):
        assert script(model.format(4), lines, engine, "euler") == ["none", "none"], engine
    grows = "state x = 0\nnear touch(x, 2)\nstep 1\nx' = 15*x + sum(o in touch: 0*o.x)\nwhen x > 3e38: remove\n"
    for engine in ("isa", "fast", "rtl"):
        lines = ["objects 2", "state x 0 1", "near touch 2 0.5 x", "run 40", "failure", "run 2", "failure"]
        assert script(grows, lines, engine, "euler") == ["object 1 in step 32: overflow", "none"], engine
        assert script(ALONE.replace("w' = 1", "w' = 15*w").replace("0.01", "1") + "when w > 3e38: remove\n", ["objects 2", "state w 0 1", *lines[3:]], f"{engine}@many_full", "euler") == [
            "object 1 in step 32: overflow", "none"], engine


BULLET = """model bullet
kind wall(x[2])
state x[2] = (-1, 0)
state v[2] = (3, 0)
near touch(x, wall.x, 0.5)
step 0.0078125
x' = v
v' = (0, 0)
{}
"""
WALL = """model wall
kind bullet(x[2])
state x[2] = (0, 0)
state s = 0
state y = 0
near hit(x, bullet.x, 0.5)
near beside(x, 0.6)
step 0.0078125
x' = (0, 0)
s' = sum(o in hit: o.x.x) + 0.01*count(o in beside)
y' = max(o in beside: o.x.y, 0)
{}
"""
SCENE = """groups = ( {{ program = "bullet.ode"; integrator = "rk4"; objects = 5; spread = {{ x_y = [-1.0, 1.0]; }}; {} }},
           {{ program = "wall.ode"; integrator = "rk4"; objects = 9; spread = {{ x_y = [-1.0, 1.0]; }}; }} );
"""


@pytest.fixture
def shoot(fp3, tmp_path):
    def shoot(bullet, wall, *options, scene="", status=0):
        (tmp_path / "bullet.ode").write_text(BULLET.format(bullet))
        (tmp_path / "wall.ode").write_text(WALL.format(wall))
        (tmp_path / "x.scene").write_text("steps = 60;\n" + SCENE.format(scene))
        done = subprocess.run([fp3, "run", "--scene", "x.scene", "--all", "-c", "world", *map(str, options)], cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == status, done.stdout + done.stderr
        return re.findall(r"^(\w+) +\S+ +0x(\w+) +object", done.stdout, re.M), done.stdout + done.stderr
    return shoot


HITS = "when count(o in touch) > 1: remove"
HIT_LONG = "when s > 0.012: remove"


def test_several_groups(shoot, tmp_path):
    """A bullet that touches walls is gone, and so is a wall that has been near bullets for long. The same words as with a lifetime that the scene gives."""
    words, said = shoot(HITS, HIT_LONG, "--engine", "isa", "--every", 1, "--output", "x.csv", "--group", "bullet")
    lives = {(int(one["object"]), int(one["step"])): int(one["life"]) for one in csv.DictReader((tmp_path / "x.csv").read_text().splitlines())}
    ends = {min(step for (who, step), life in lives.items() if who == i and life == 2) for i in range(5)}
    assert len(ends) == 1 and 16 < min(ends) < 50, ends
    assert re.search("^alive +0 of 5, 0 not born yet, 5 gone$", said, re.M) and re.search("^alive +7 of 9, 0 not born yet, 2 gone$", said, re.M), said
    for options in (("fast", "--threads", 1), ("fast", "--threads", 2), ("rtl",)):
        assert shoot(HITS, HIT_LONG, "--engine", *options)[0] == words
    told = shoot("", HIT_LONG, "--engine", "isa", scene=f"gone = {min(ends)};")[0]
    first = [i for i, (name, _) in enumerate(words) if name == "is_removed"][:5]  # those of the bullets
    assert told == [one for i, one in enumerate(words) if i not in first]


def test_checkpoints_and_recordings(shoot, tmp_path):
    whole = shoot(HITS, "", "--engine", "isa")[0]
    for half, engine in ((10, "rtl"), (30, "fast"), (50, "isa")):
        file = tmp_path / f"{half}.checkpoint"
        shoot(HITS, "", "--engine", engine, "--steps", half, "--checkpoint", file)
        assert shoot(HITS, "", "--engine", engine, "--restart", file, "--every", 10, "--output", f"{half}.csv", "--group", "bullet")[0] == whole
        first = list(csv.DictReader((tmp_path / f"{half}.csv").read_text().splitlines()))[0]
        assert int(first["life"]) == 1 + (float(first["is_removed"]) == 1)


@pytest.mark.parametrize("config, near, pull", [("many_full", "", "0"), ("world", "near touch(x, 0.01)\n", "sum(o in touch: o.x)")])
def test_a_batch(build, tmp_path, config, near, pull):
    """An object that an event has removed keeps its handle; who gets its number afterwards, or starts again, lives."""
    (tmp_path / "m.ode").write_text(f"state x = 0\nstate v = 0.5\n{near}step 0.125\nx' = v\nv' = {pull}\nwhen x > 1: remove\n")
    lines = ["spread v 1 4", "step 4", "read x is_removed", "numbers", "remove 3", "add 1", "step 1", "read x is_removed", "restart", "step 4", "read x is_removed"]
    done = subprocess.run([build / "tests/batch_script", tmp_path / "m.ode", "-n", "4", "-c", config], input="\n".join(lines), capture_output=True, text=True, check=True)
    said = [line for line in done.stdout.splitlines() if re.fullmatch(r"[\d.]+ [01]", line)]
    assert said == ["0.5 0", "1 0", "1.125 1", "1.5 1", "0.625 0", "1.25 1", "1.125 1", "0.0625 0", "0.5 0", "1 0", "1.125 1", "0.25 0"], done.stdout


def test_what_is_refused(fp3, tmp_path, shoot):
    (tmp_path / "alone.ode").write_text("state x = 0\nstep 0.125\nx' = 1\nwhen x > 1: remove\n")

    def said(*options):
        done = subprocess.run([fp3, *options], cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 2, done.stdout + done.stderr
        return done.stderr
    assert "the program removes objects: configuration 'world' has no sleep: all its objects make all steps" in said("run", "alone.ode", "-c", "world")
    for option, value in (("--until", "1"), ("--tolerance", "1e-3")):
        assert "line 4: `remove` ends a life after a step that all objects make" in said("run", "alone.ode", "-i", "cash_karp", option, value)
    assert "births and ends of objects split the run" in said("run", "alone.ode", "--steps", "9", "--cycle-limit", "99999", "-e", "rtl", "-c", "many_full")


def test_check_compares_runs_on_which_objects_are_removed(fp3, tmp_path):
    """One of two is removed at the end of the step in which it goes beyond 1: half the step leaves it nearer to 1."""
    (tmp_path / "near.ode").write_text("state x = 0\nnear touch(x, 9)\nstep 0.125\nx' = sum(o in touch: (x - o.x)/4)\nwhen x > 1: remove\n")
    done = subprocess.run([fp3, "run", "near.ode", "--objects", "2", "--spread", "x=0:0.9", "--steps", "16", "-i", "rk4", "-e", "isa", "--all", "--check"],
                          cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0 and "\nnot looked at " in done.stdout and "1 of 2" in done.stdout, done.stdout + done.stderr
    error = [float(found) for found in re.findall(r"^x .* error (\S+),", done.stdout, re.M)]
    assert len(error) == 2 and 0.02 < min(error) and max(error) < 0.05, done.stdout


@pytest.mark.parametrize("line, message", [
    ("when x > 1: remove, x = 0", "4:19: error: found ',', expected the end of the line (`remove` comes last)"),
    ("when x > 1: x = 0, remove, v = 1", "4:26: error: found ',', expected the end of the line (`remove` comes last)"),
    ("when x > 1: remove now", "4:20: error: found 'now', expected the end of the line (`remove` comes last)"),
    ("when x > 1: stop, remove", "4:17: error: found ',', expected the end of the line (`stop` comes last)"),
    ("project x = 1, remove", "4:1: error: found 'project', expected an event (a projection removes nothing)"),
    ("state is_removed = 0\nwhen x > 1: remove", "5:13: error: found 'remove', expected no 'is_removed' beside it (line 4 declares this one)"),
    ("when x > 1: remove\nparam is_removed = 0", "5:7: error: found 'is_removed', expected a new name (line 4 declares this one)"),
    ("when x > 1: remove\nis_removed' = 1", "5:1: error: found 'is_removed', expected only one equation like this"),
])
def test_messages(fp3, tmp_path, line, message):
    (tmp_path / "x.ode").write_text(f"model one\nstate x = 0\nstate v = 1\n{line}\nstep 0.1\nx' = v\nv' = -v\n")
    done = subprocess.run([fp3, "compile", "x.ode"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2 and message in done.stderr, done.stderr


def test_remove_is_a_name_as_well_and_several_events_share_one_state(fp3, tmp_path):
    (tmp_path / "x.ode").write_text("state remove = 1\nstate q[2] = (1, 1)\nremove' = -1\nq' = (0, 0)\nwhen root(remove) falling: q.x = 7, remove = 3, q[2] = 5\nstep 0.125\n"
                                    "for i in 1..2: when q[i] > 6: remove\nwhen remove > 9: remove\n")
    done = subprocess.run([fp3, "run", "x.ode", "--steps", "20"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0 and re.search("^q_x +7 ", done.stdout, re.M) and re.search("^is_removed +1 ", done.stdout, re.M), done.stdout + done.stderr
    assert re.search("^alive +0 of 1, 0 not born yet, 1 gone$", done.stdout, re.M) and re.search("^object_steps +8$", done.stdout, re.M)
