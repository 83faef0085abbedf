"""Programs of groups that see each other: how many phases they have, and that every sum sees the value of its place.

A machine in Python makes the phases of several programs round by round, as engines do. What it finds is compared with one model that has
all objects as states of its own, so that no relation is in it.
"""

import ctypes
import re
import subprocess
import sys

import numpy
import pytest

f32 = numpy.float32


@pytest.fixture(scope="module")
def lib(root):
    sys.path.insert(0, str(root / "python"))
    from fp3 import _declarations, _library  # pylint: disable=import-outside-toplevel
    sys.path.pop(0)
    made = _library.library()
    made.d = _declarations
    return made


class Joined:
    """Groups by name: a model's text, or a text and an integrator of its own."""

    def __init__(self, lib, groups, integrator, adaptive=False, **compile_):
        self.lib, self.d = lib, lib.d
        self.error = self.d.fp3_error()
        self.list = (self.d.fp3_joined * len(groups))()
        self.names, self.kept = list(groups), []
        for i, (name, text) in enumerate(groups.items()):
            text, method = text if isinstance(text, tuple) else (text, integrator)
            made, pointer, report = lib.default(self.d.fp3_program_def), ctypes.POINTER(self.d.fp3_program)(), ctypes.c_char_p()
            made.integrator, made.is_adaptive = method.encode(), adaptive
            for key, value in compile_.items():
                setattr(made.compile, key, value)
            status = lib.fp3_program_read(text.encode(), len(text), f"{name}.ode".encode(), made, pointer, report, self.error)
            assert status == 0, report.value or self.error.text
            self.kept.append((made, name.encode()))
            self.list[i] = self.d.fp3_joined(name=self.kept[-1][1], program=pointer, **{"def": ctypes.pointer(made)})
        self.before = [self.assembly(i) for i in range(len(groups))]

    def join(self):
        return self.lib.fp3_programs_join(self.list, len(self.list), self.error)

    def refused(self):
        assert self.join() == self.d.FP3_E_PROGRAM
        return self.error.text.decode()

    def joined(self):
        assert self.join() == 0, self.error.text.decode()
        return self

    def program(self, i):
        return self.list[i].program.contents

    def compiled(self, i):
        return self.program(i).compiled.contents

    def assembly(self, i):
        return self.compiled(i).assembly.decode()

    def phases(self):
        return [self.compiled(i).phases for i in range(len(self.list))]

    def foreign(self, i):
        found, count = ctypes.POINTER(self.d.fp3_foreign)(), ctypes.c_size_t()
        assert self.lib.fp3_program_foreign(self.list, len(self.list), i, found, ctypes.byref(count), self.error) == 0, self.error.text
        words = {w.word.decode(): (w.group, w.of.decode()) for w in found[:count.value]}
        self.lib.free(found)
        return words

    def inputs(self, i, start, h):
        """Words of an object by name, and shared constants."""
        compiled, model = self.compiled(i), self.program(i).model.contents
        params = (ctypes.c_double * model.param_count)(*(start.get(q.name.decode(), q.value) for q in model.params[:model.param_count]))
        initial = (ctypes.c_double * model.state_count)(*(start.get(q.name.decode(), q.value) for q in model.states[:model.state_count]))
        values = (ctypes.c_float * compiled.input_count)()
        assert self.lib.fp3_compiled_inputs(self.program(i).compiled, params, initial, h, values, self.error) == 0, self.error.text
        return {q.name.decode(): (f32(v), q.is_shared) for q, v in zip(compiled.inputs[:compiled.input_count], values)}

    def relations(self, i):
        """Of each relation the group that it sees."""
        model = self.program(i).model.contents
        kinds = [k.name.decode() for k in model.kinds[:model.kind_count]]
        return {r.name.decode(): i if r.of_kind == self.d.FP3_NONE else self.names.index(kinds[r.of_kind]) for r in model.relations[:model.relation_count]}

    def __del__(self):
        for one in self.list:
            self.lib.fp3_program_close(ctypes.byref(one.program))


OPS = {"add": lambda a, b: a + b, "sub": lambda a, b: a - b, "mul": lambda a, b: a * b, "madd": lambda a, b, c: f32(a * b) + c,
       "msub": lambda a, b, c: c - f32(a * b), "lt": lambda a, b: f32(a < b), "le": lambda a, b: f32(a <= b), "sel": lambda a, b, c: a if c != 0 else b,
       "rsb": lambda a, b: b - a}


class Machine:
    """Objects of several groups, whose `all` relations see everybody."""

    def __init__(self, joined, starts, h):
        self.joined, self.groups = joined, []
        for i, name in enumerate(joined.names):
            code = [line.split("#")[0].strip() for line in joined.assembly(i).split("\nstep:\n")[1].splitlines()]
            code = [re.split(r"[ ,]+", line) for line in code if line and not line.endswith(":")]
            phases = [[]]
            for line in code:
                phases[-1].append(line)
                if line[0] == "phase":
                    phases.append([])
            given = [joined.inputs(i, start, h) for start in starts[name]]
            records = [{k: v for k, (v, shared) in one.items() if not shared} for one in given]
            shared = {k: v for k, (v, is_shared) in given[0].items() if is_shared}
            self.groups.append((phases, records, shared, joined.foreign(i), joined.relations(i)))
            assert len(phases) == joined.phases()[i]

    def neighbours(self, group, me, relation, seen):
        _, _, shared, foreign, relations = self.groups[group]
        other = relations[relation]
        for j, record in enumerate(seen[other]):
            if other == group and j != me:
                yield record
            elif other != group:
                constants = self.groups[other][2]
                yield {word: record.get(of, constants.get(of)) for word, (g, of) in foreign.items() if g == other}
        assert shared is not None

    def visit(self, group, me, phase, seen):
        record, shared = self.groups[group][1][me], self.groups[group][2]
        is_phased = any(line[0] in ("phase", "each") for part in self.groups[group][0] for line in part)
        regs = {} if is_phased else dict(record)

        def value(text, other):
            if re.match(r"-?[0-9.]", text):
                return f32(text)
            return other[text] if other is not None else regs[text] if text in regs else shared[text]

        def execute(line, other):
            op, *operands = line
            if op == "ld":
                regs[operands[0]] = record.get(operands[0], f32(0))
            elif op == "st":
                record[operands[0]] = regs[operands[0]]
            elif op == "ldn":
                regs[operands[0]] = other[operands[1]]
            elif op.endswith("n") and op[:-1] in OPS:
                regs[operands[0]] = f32(OPS[op[:-1]](value(operands[1], None), other[operands[2]]))
            elif op != "phase":
                regs[operands[0]] = f32(OPS[op](*(value(text, None) for text in operands[1:])))

        at, lines = 0, self.groups[group][0][phase]
        while at < len(lines):
            if lines[at][0] != "each":
                execute(lines[at], None)
                at += 1
                continue
            end = at
            while lines[end][0] != "next":
                end += 1
            for other in self.neighbours(group, me, lines[at][1], seen):
                for line in lines[at + 1:end]:
                    execute(line, other)
            at = end + 1
        if not is_phased:
            record.update({name: v for name, v in regs.items() if name in record})

    def step(self):
        for phase in range(max(self.joined.phases())):
            seen = [[dict(record) for record in records] for _, records, *_ in self.groups]
            for group, (phases, records, *_) in enumerate(self.groups):
                for me in range(len(records)):
                    if phase < len(phases):
                        self.visit(group, me, phase, seen)

    def state(self, name, word):
        return [float(record[word]) for record in self.groups[self.joined.names.index(name)][1]]


def run(joined, starts, h, steps):
    machine = Machine(joined, starts, h)
    for _ in range(steps):
        machine.step()
    return machine


# ---- balls and weights, and one model of all of them --------------------------------------------

BALLS = """
kind weights(x, v, m)
param m = 2
shared g = 1
state x = 0
state v = 0
all them(weights)
{others}
step 0.25
x' = v
v' = (sum(o in them: o.m*(o.x - x)*(1 + (o.x - x)*(o.x - x))){sum} - g*x)/m
{more}
"""
WEIGHTS = """
kind balls(x, m, g)
param m = 3
state x = 0
state v = 0
all them(balls)
step 0.25
x' = v
v' = sum(o in them: o.m*o.g*(o.x - x))/m - x*x*x
{more}
"""
FREE = """
param m = 3
state x = 0
state v = 0
step 0.25
x' = v
v' = -2*x - x*x*x
{more}
"""
STEADY = """
param m = 3
state x = 0
state v = 0
step 0.25
x' = v
v' = 1
"""
STILL = """
param m = 3
state x = 0
state v = 0
step 0.25
x' = 0
v' = 0
"""
OTHERS = dict(others="all others", sum=" + 0.5*sum(o in others: o.x - x)")
ALONE = dict(others="", sum="")
STARTS = {"balls": [dict(x=0.1, v=0.3, m=2), dict(x=-0.4, v=0.1, m=1.5)], "weights": [dict(x=0.7, v=-0.2, m=3), dict(x=-0.3, v=0.5, m=2.5)]}


def whole(weights, has_others, more=()):
    """All of it as one object's model."""
    ball, lines = ["a1", "a2"], ["step 0.25"]
    m = {"a1": 2, "a2": 1.5, "b1": 3, "b2": 2.5}
    for name, start in zip(["a1", "a2", "b1", "b2"], STARTS["balls"] + STARTS["weights"]):
        speed = 0 if weights is STILL and name not in ball else start["v"]
        lines += [f"state {name} = {start['x']}", f"state v{name} = {speed}"]
    for me in ball:
        force = " + ".join(f"{m[o]}*({o} - {me})*(1 + ({o} - {me})*({o} - {me}))" for o in ("b1", "b2"))
        own = f" + 0.5*({ball[me == 'a1']} - {me})" if has_others else ""
        lines += [f"{me}' = v{me}", f"v{me}' = ({force}{own} - {me})/{m[me]}"]
    for me in ("b1", "b2"):
        force = " + ".join(f"{m[o]}*({o} - {me})" for o in ball)
        of = {WEIGHTS: f"({force})/{m[me]} - {me}*{me}*{me}", FREE: f"-2*{me} - {me}*{me}*{me}", STEADY: "1", STILL: "0"}
        lines += [f"{me}' = v{me}", f"v{me}' = {of[weights]}"]
    return "\n".join([*lines, *more])


def run_whole(fp3, folder, text, integrator, steps):
    (folder / "whole.ode").write_text(text)
    done = subprocess.run([fp3, "run", "whole.ode", "-i", integrator, "-e", "fast", "--steps", str(steps), "--output", "w.csv"], cwd=folder,
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    head, *_, last = (folder / "w.csv").read_text().splitlines()
    names = [re.split(r"[ \[]", name)[0] for name in head.split(",")]
    return dict(zip(names, map(float, last.split(","))))


METHODS = {"euler": 1, "semi_implicit_euler": 1, "leapfrog": 2, "verlet": 2, "heun": 2, "rk4": 4, "rk8": 11, "rkc8": 8, "yoshida6": 8}
SPLITTINGS = ("semi_implicit_euler", "leapfrog", "verlet", "yoshida6")


@pytest.mark.parametrize("others", [ALONE, OTHERS], ids=["alone", "others"])
@pytest.mark.parametrize("weights", [WEIGHTS, FREE, STEADY, STILL], ids=["each other", "one way", "steady", "still"])
@pytest.mark.parametrize("integrator", METHODS)
def test_every_sum_sees_the_value_of_its_place(lib, fp3, tmp_path, integrator, weights, others):
    """Weights that stand still cost no phases."""
    if weights is STEADY and integrator == "rk8":
        pytest.skip("too many constants")
    if weights is STILL and integrator in SPLITTINGS:
        pytest.skip("a splitting moves positions")
    starts = STARTS if weights is not STILL else {**STARTS, "weights": [dict(s, v=0) for s in STARTS["weights"]]}
    joined = Joined(lib, {"balls": BALLS.format(**others, more=""), "weights": weights.format(more="")}, integrator).joined()
    machine = run(joined, starts, 0.25, 3)
    wanted = run_whole(fp3, tmp_path, whole(weights, others is OTHERS), integrator, 3)
    got = [*machine.state("balls", "x"), *machine.state("balls", "v"), *machine.state("weights", "x"), *machine.state("weights", "v")]
    assert got == pytest.approx([wanted[n] for n in ("a1", "a2", "va1", "va2", "b1", "b2", "vb1", "vb2")], rel=2e-5, abs=2e-6)
    most = METHODS[integrator]
    if weights is STILL and others is ALONE:
        assert joined.phases() == [1, 1]
    else:
        assert joined.phases()[0] == most and joined.phases()[1] == (1 if weights is STILL else most)


def ends(lib, fp3, folder, integrator, balls, weights, more, steps=3):
    """Of balls and weights with these lines: what they have, and what the whole has."""
    groups = {"balls": BALLS.format(**ALONE, more=balls), "weights": WEIGHTS.format(more=weights)}
    joined = Joined(lib, groups, integrator).joined()
    machine = run(joined, STARTS, 0.25, steps)
    wanted = run_whole(fp3, folder, whole(WEIGHTS, False, more), integrator, steps)
    got = [*machine.state("balls", "x"), *machine.state("weights", "x"), *machine.state("balls", "v"), *machine.state("weights", "v")]
    assert got == pytest.approx(
        [wanted[n] for n in ("a1", "a2", "b1", "b2", "va1", "va2", "vb1", "vb2")], rel=2e-5, abs=2e-6)
    return joined


PULL = "project x = x + 0.1*sum(o in them: o.x - x)"
TO_WEIGHTS = "a1 = a1 + 0.1*(b1 - a1 + b2 - a1), a2 = a2 + 0.1*(b1 - a2 + b2 - a2)"
TO_BALLS = "b1 = b1 + 0.1*(a1 - b1 + a2 - b1), b2 = b2 + 0.1*(a1 - b2 + a2 - b2)"
HALF = "project x = 0.5*x"


@pytest.mark.parametrize("integrator, phases", [("rk4", 4), ("leapfrog", 2), ("euler", 1), ("rkc8", 8)])
@pytest.mark.parametrize("balls, weights, more, extra", [
    (PULL, "", ["project " + TO_WEIGHTS], 1),                                            # these have no such place: they end with what they have
    (PULL, PULL, [f"project {TO_WEIGHTS}, {TO_BALLS}"], 1),
    (PULL, HALF, [f"project {TO_WEIGHTS}, b1 = 0.5*b1, b2 = 0.5*b2"], 1),
    (PULL, HALF + "\n" + PULL, [f"project {TO_WEIGHTS}, b1 = 0.5*b1, b2 = 0.5*b2", "project " + TO_BALLS], 2),
    (HALF + "\n" + PULL, PULL, [f"project a1 = 0.5*a1, a2 = 0.5*a2, {TO_BALLS}", "project " + TO_WEIGHTS], 2),
], ids=["one", "both", "half", "two and one", "one and two"])
def test_projections(lib, fp3, tmp_path, integrator, phases, balls, weights, more, extra):
    joined = ends(lib, fp3, tmp_path, integrator, balls, weights, more)
    assert max(joined.phases()) == phases + extra


@pytest.mark.parametrize("integrator", ["rk4", "verlet", "euler"])
@pytest.mark.parametrize("condition, there", [("sum(o in them: o.x) > 0.3", "b1 + b2 > 0.3"),
                                              ("root(sum(o in them: o.x) - 0.3) any", "root(b1 + b2 - 0.3) any")])
def test_events(lib, fp3, tmp_path, integrator, condition, there):
    ends(lib, fp3, tmp_path, integrator, f"when {condition}: v = -0.5*v", "", [f"when {there}: va1 = -0.5*va1, va2 = -0.5*va2"], steps=8)


def test_who_is_not_seen_stays_as_it_was(lib):
    groups = {"balls": BALLS.format(**ALONE, more=""), "weights": FREE.format(more=""), "others": FREE.format(more="")}
    joined = Joined(lib, groups, "rk4").joined()
    assert joined.assembly(2) == joined.before[2] and joined.assembly(1) != joined.before[1]
    assert joined.phases() == [4, 4, 1]
    assert joined.foreign(0) == {"weights_x": (1, "x"), "weights_m": (1, "m")} and joined.foreign(1) == joined.foreign(2) == {}


def test_three_groups_in_a_circle(lib):
    """Each sees the next one; each part of a scene has phases of its own."""
    text = "kind {}(x, m)\nparam m = 1\nstate x = 1\nstate v = 0\nall them({})\nstep 0.1\nx' = v\nv' = sum(o in them: o.m*(o.x - x))"
    groups = {a: text.format(b, b) for a, b in ("ab", "bc", "ca", "de", "ed")}
    assert Joined(lib, groups, "rk4").joined().phases() == [4] * 5


READER = "state y = 0\nkind balls({words})\nall them({used})\nstep 1\ny' = sum(o in them: o.{word})\n"
LEAST = "state x = 0 [m]\nparam m = 1 [kg]\nstate p[3] = (0, 0, 0)\nstep 1\nx' = 0*x\np' = 0*p\n"


@pytest.mark.parametrize("words, word, name, expected", [
    ("x [s]", "x", "balls", "a.ode:2: group 'a': 'x' is in [s], and in [m] in group 'balls'"),
    ("m", "m", "ball", "a.ode:2: group 'a': there is no group 'balls'; did you mean 'ball'?"),
    ("mm", "mm", "balls", "a.ode:2: group 'a': the model of group 'balls' has no state or param 'mm'; did you mean 'm'?"),
    ("p[2]", "p.x", "balls", "a.ode:2: group 'a': 'p' has another size in the model of group 'balls'"),
    ("p", "p", "balls", "a.ode:2: group 'a': the model of group 'balls' has no state or param 'p'"),
])
def test_words_that_do_not_fit(lib, words, word, name, expected):
    made = Joined(lib, {"a": READER.format(words=words, word=word, used="balls"), name: LEAST}, "rk4")
    assert made.refused().startswith(expected)


def test_groups_that_do_not_fit(lib):
    reader = READER.format(words="x", word="x", used="balls")
    made = Joined(lib, {"a": reader, "balls": (LEAST, "euler")}, "rk4")
    assert "'rk4', and group 'balls' by 'euler': kinds that see each other step by one method" in made.refused()
    made = Joined(lib, {"a": reader, "balls": LEAST, "b": LEAST}, "rk4")
    made.list[2].name = b"balls"
    assert "a.ode:2: group 'a': there are two groups 'balls'" in made.refused()
    made.list[0].name = made.list[1].name
    made.list[2].name = b"b"
    assert "kind 'balls' is this group itself" in made.refused()


def test_units_may_be_written_in_other_words(lib):
    reader = READER.format(words="w [1/s*m]", word="w", used="balls")
    assert Joined(lib, {"a": reader, "balls": "param w = 1 [m/s]\nstate x = 0\nstep 1\nx' = 0"}, "rk4").join() == 0
    assert Joined(lib, {"a": reader, "balls": "param w = 1\nstate x = 0\nstep 1\nx' = 0"}, "rk4").join() == 0


MEMORY = """
kind balls(x, m)
state x = 1
state v = 0
links ties(balls, s = 0)
step 0.1
x' = v
v' = sum(o in ties: o.s + o.x)
remember o in ties: o.s = o.s + o.m*(o.x - x)
"""


@pytest.mark.parametrize("integrator, phases", [("euler", 2), ("rk4", 5)])
def test_what_pairs_remember_is_of_the_ends_of_both(lib, integrator, phases):
    """The others have no such place, so it comes behind all their phases."""
    made = Joined(lib, {"a": MEMORY, "balls": FREE.format(more="")}, integrator).joined()
    assert made.phases() == [phases, phases - 1] and made.compiled(0).looks >> 63 == 1
    assert made.compiled(0).phase[63] == phases - 1 and not made.compiled(1).shows >> 63


@pytest.mark.parametrize("engine", ["isa", "fast"])
@pytest.mark.parametrize("integrator", ["euler", "rk4", "verlet", "rkc8"])
def test_who_is_seen_has_the_bits_of_before(lib, fp3, tmp_path, integrator, engine):
    """A program with phases and without a loop."""
    made = Joined(lib, {"balls": BALLS.format(**ALONE, more=""), "weights": FREE.format(more="")}, integrator)
    values, found = made.inputs(1, dict(x=0.7, v=-0.2), 0.25), set()
    made.joined()
    for text in (made.before[1], made.assembly(1)):
        (tmp_path / "w.s").write_text(text)
        words = {**values, **made.inputs(1, dict(x=0.7, v=-0.2), 0.25)}
        given = [f"--set={n}={float(v)!r}" for n, (v, _) in words.items() if re.search(rf"^\.\w+ +{n}\b", text, re.M)]
        done = subprocess.run([fp3, "run", "w.s", "-c", "world", "-e", engine, "--steps", "5", "--output", "w.csv", *given], cwd=tmp_path,
                              capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        head, *_, last = (tmp_path / "w.csv").read_text().splitlines()
        row = dict(zip(head.split(","), last.split(",")))
        found.add((row["x"], row["v"]))
    assert len(found) == 1
