"""Adaptive steps, and fixed steps cut at events, where objects see each other: all make the same steps, chosen by the worst."""

import math
import re

import numpy as np
import pytest

DECAY = """\
state x = 1
param w = 1
param k = 0
{relation}
step 0.0078125
x' = -w*x + k*sum(o in ties: o.x - x)
"""
KEPLER = """\
state v[2] = (0, 0)
state r[2] = (0, 0)
all others
step 2^-10
v' = sum(o in others: 4*(o.r - r)/norm(o.r - r)^3)
r' = v
"""
FALL = """\
state x = 0
state v = 0
state at = 0
state n = 0
near ties(x, 0.01)
step 0.015625
x' = v + 0*sum(o in ties: o.x)
v' = -1
at' = 0
n' = 0
when root(x) falling: {then}
"""
BOUNCE = FALL.format(then="v = -v, at = t, n = n + 1")
TOLD = r"^(\w+) +(\S+) +0x([0-9a-f]{8})(?: 0x[0-9a-f]{8})?   object (\d+)$"


@pytest.fixture
def run(start, folder):
    """What each object holds in the end: of each name a list of words, and of numbers."""
    def run(model, objects, *options, engine="fast", code=0):
        (folder / "m.ode").write_text(model)
        done = start("m.ode", "-N", objects, "--engine", engine, "--all", *options)
        assert done.returncode == code, done.stdout + done.stderr
        words, numbers = {}, {}
        for name, number, word, _ in re.findall(TOLD, done.stdout, re.M):
            words.setdefault(name, []).append(word)
            numbers.setdefault(name, []).append(float(number))
        return done.stderr if code else (words, {name: np.array(column) for name, column in numbers.items()})
    return run


@pytest.mark.parametrize("spread", ["w=1:4", "w=4:1"])
@pytest.mark.parametrize("relation", ["all ties", "near ties(x, 0.5)"])
def test_the_worst_object_chooses(run, relation, spread):
    """Where nobody feels a neighbour, the steps of a world are those of its worst object alone, wherever it stands."""
    model, options = DECAY.format(relation=relation), ("--tolerance", "1e-4", "--set", "absolute=1e-9", "--until", 2)
    alone, _ = run(model, 1, "--set", "w=4", *options)
    world, _ = run(model, 5, "--spread", spread, *options)
    worst = 4 if spread == "w=1:4" else 0
    for name in ("t", "h_next", "accepted", "rejected", "smallest", "largest"):
        assert world[name] == alone[name]*5, name
    assert world["x"][worst] == alone["x"][0] and len(set(world["x"])) == 5


def test_a_close_encounter(run, fp3, root):
    """Both bodies of a pair go the way of one around a fixed centre, with an error no larger than a third above its own."""
    options = ("--tolerance", "1e-5", "--until", 2*math.pi)
    _, pair = run(KEPLER, 2, *options, "--spread", "r_x=0.1:-0.1", "--spread", "v_y=4.358898943540674:-4.358898943540674")
    _, one = run((root / "tests/ode/adaptive/kepler_09.ode").read_text(), 1, "-c", "many_full", *options)
    error = [max(abs(found["r_x"][0] - 0.1), abs(found["r_y"][0]), abs(found["v_x"][0])/43) for found in (pair, one)]
    assert error[0] < 4/3*error[1] < 2e-3, error
    assert pair["r_x"][0] == -pair["r_x"][1] and abs(pair["accepted"][0] - one["accepted"][0]) <= 2


MIXED = """\
state x = 1
state moves = 1
state n = 0
param w = 1
near ties(x, 0.5, s = 0)
step 0.0078125
x' = -w*moves*x + 0.5*sum(o in ties: o.x - x)
moves' = 0
n' = 0
project n = sum(o in ties: o.s)
remember o in ties: o.s = o.s + 1
when root(x - 0.6) falling: moves = 0
"""


@pytest.mark.parametrize("options", [
    ("--tolerance", "1e-3"), ("-i", "rk4"), pytest.param(("-i", "dopri5", "-k", "--tolerance", "1e-3"), marks=pytest.mark.long)])
def test_words_are_the_same_everywhere(run, long, options):
    """On each engine, with two threads, and (all) with eight lanes."""
    options = (*options, "--until", 0.03125, "--spread", "w=0.1:8", "--spread", "x=0.61:0.7")
    engines = [("isa",), ("fast", "--threads", 1), ("fast", "--threads", 2), ("rtl",), *([("rtl", "-c", "fabric")] if long else [])]
    found = [run(MIXED, 3, *options, *more, engine=engine) for engine, *more in engines]
    assert all(words == found[0][0] for words, _ in found)
    assert set(found[0][1]["moves"]) == {0, 1} and found[0][1]["rejected"][0] > 0


def test_a_rejected_attempt_is_not_remembered(run):
    model = "state x = 0\nstate n = 0\nall others\nnear ties(x, 1, s = 0)\nstep 0.5\nx' = cos(20*t)\nn' = 0\n" \
            "project n = sum(o in ties: o.s)\nremember o in ties: o.s = o.s + 1\n"
    _, found = run(model, 2, "--tolerance", "1e-4", "--until", 1)
    assert found["rejected"][0] > 0 and list(found["n"]) == list(found["accepted"] - 1)
    late = model.replace("step 0.5", "step 0.01").replace("cos(20*t)", "t^6*cos(60*t)")  # attempts are rejected when much is remembered
    _, found = run(late, 2, "--tolerance", "1e-6", "--until", 1)
    assert found["rejected"][0] > 0 and found["accepted"][0] > 20 and list(found["n"]) == list(found["accepted"] - 1)
    for engine in ("isa", "fast"):
        _, found = run(late + "when root(x - 1e-3) any: x = x\n", 2, "--tolerance", "1e-6", "--until", 1, engine=engine)
        assert found["rejected"][0] > 3 and list(found["n"]) == list(found["accepted"] - 1)


@pytest.mark.parametrize("options", [(), ("--tolerance", "1e-4")])
def test_each_bounce_is_located(run, options):
    """Three balls fall from 1, 1.5 and 2 and bounce once each, at the root of 2 x; all make the steps that end there."""
    _, found = run(BOUNCE, 3, "--until", 3, "--spread", "x=1:2", *options)
    hit = np.sqrt(2*np.array([1, 1.5, 2]))
    locate = 2**-24*3 if options else 2**-10*0.015625
    assert list(found["n"]) == [1, 1, 1] and (np.abs(found["at"] - hit) < 4e-7 + 4*locate).all(), found["at"] - hit
    assert np.abs(found["x"] - (hit*(3 - hit) - (3 - hit)**2/2)).max() < 2e-5 and len(set(found["accepted"])) == 1


@pytest.mark.parametrize("options", [(), ("--tolerance", "1e-4")])
def test_one_that_stops_stays(run, options):
    """The others go on: one stands at the ground, and the last one has not reached it."""
    _, found = run(FALL.format(then="at = t, stop"), 3, "--until", 1.5, "--spread", "x=0.5:2", *options)
    assert list(found["stopped"]) == [1, 0, 0] and abs(found["x"][0]) < 2e-5 and abs(found["at"][0] - 1) < 2e-5
    assert np.abs(found["x"][1:] - (np.array([1.25, 2]) - 1.125)).max() < 2e-6 and list(found["t"]) == [1.5]*3


@pytest.mark.parametrize("options", [("-i", "rk4"), ("--tolerance", "1e-4")])
def test_times_of_each_object_end_steps(run, options):
    """A condition in t of one object ends the steps of all, so nobody steps over his own."""
    model = "state x = 0\nstate c = 0\nstate apart = 0\nparam on = 0\nall ties\nstep 0.25\nx' = t > on ? 1 : 0\nc' = 1\napart' = 0\n" \
            "project apart = max(o in ties: abs(o.c - c), apart)\n"
    _, found = run(model, 4, "--until", 2, "--spread", "on=0.1:1.3", *options)
    assert np.abs(found["x"] - (2 - np.linspace(0.1, 1.3, 4))).max() < 1e-6 and list(found["apart"]) == [0]*4


def test_no_number_of_one_object_rejects_for_all(run):
    """The last one has no derivative behind t = 2, and its error is 0 before: nobody goes beyond."""
    model = "state x = 1\nparam most = 0\nall ties\nstep 0.01\nx' = -0.25 + 0*sqrt(most - t) + 0*sum(o in ties: o.x)\n"
    said = run(model, 3, "--until", 3, "--tolerance", "1e-3", "--set", "maxstep=1", "--spread", "most=20:2", code=3)
    assert re.search(r"object 0 at t = (1\.99999\d*|2(\.000000\d*)?) of 3, .*too short to change t.*; 3 of 3 objects failed", said), said


@pytest.mark.parametrize("engine", ["isa", "fast", "rtl"])
def test_a_rejected_attempt_puts_all_back(run, engine):
    """Of one attempt that is too long nothing is left but a shorter next one, in objects that could have made it, too."""
    options = ("--tolerance", "1e-4", "--set", "h_next=0.5", "--until", 2, "--spread", "w=8:0.001", "--spread", "x=0.61:0.7", "-k")
    model = MIXED.replace("when", "# when")
    began, _ = run(model, 3, *options, "--steps", 0, "--allow-failures", engine=engine)
    words, found = run(model, 3, *options, "--steps", 1, "--allow-failures", engine=engine)
    assert list(found["rejected"]) == [1]*3 and (found["h_next"] < 0.5).all()
    assert {name for name in words if words[name] != began[name]} == {"h_next", "rejected"}


def test_repeated_projections_are_made_one_by_one(run):
    model = "state x = 1\nstate n = 0\nall ties\nstep 0.1\nx' = -x\nn' = 0\nrepeat 3\nproject n = n + 1 + 0*sum(o in ties: o.x)\nend\n"
    _, found = run(model, 2, "--until", 1, "--tolerance", "1e-3")
    assert list(found["n"]) == list(3*found["accepted"])


def test_the_ends(run):
    model = DECAY.format(relation="near ties(x, 0.001)")
    words, found = run(model, 1, "--until", 1, "--tolerance", "1e-3")
    assert abs(found["x"][0] - math.exp(-1)) < 1e-3 and words["t"] == ["3f800000"]
    _, found = run(model, 3, "--until", 1, "--set", "t=1", "--tolerance", "1e-3")
    assert list(found["accepted"]) == [0, 0, 0] and list(found["x"]) == [1, 1, 1]


def test_double_single(run):
    """The worst object chooses for all, to tolerances that FP32 does not reach, with the same words on each engine."""
    model, error = DECAY.format(relation="near ties(x, 4)"), {}
    for tolerance in ("1e-7", "1e-9"):
        _, found = run(model, 3, "-i", "ralston3", "--double-single", "--tolerance", tolerance, "--until", 1, "--spread", "w=1:4")
        error[tolerance] = np.abs(found["x"] - np.exp([-1, -2.5, -4])).max()
        assert len(set(found["accepted"])) == 1 and found["rejected"][0] > 0
    assert 10*error["1e-9"] < 5e-9 < error["1e-7"], error
    options = ("-i", "heun", "--double-single", "--tolerance", "1e-4", "--until", 0.25, "--spread", "x=0.02:0.04")
    found = [run(BOUNCE, 3, *options, engine=engine) for engine in ("isa", "fast", "rtl")]
    assert found[0][0] == found[1][0] == found[2][0] and list(found[0][1]["n"]) == [1, 1, 0]
    assert abs(found[0][1]["at"][0] - 0.2) < 1e-6


def test_times_of_each_object_in_double_single(run):
    """A time has two words there: one that all share is kept, one of each object alone is refused."""
    model = "state x = 0\n{} on = 0.3\nall ties\nstep 0.25\nx' = (t > on ? 1 : 0) + sum(o in ties: o.x - x)\n"
    for options in (("-i", "heun", "--tolerance", "1e-6"), ("-i", "rk4")):
        _, found = run(model.format("shared"), 2, *options, "--double-single", "--until", 2)
        assert np.abs(found["x"] - 1.7).max() < 1e-12
        said = run(model.format("param"), 2, *options, "--double-single", "--until", 2, code=2)
        assert "a time that ends steps, and that each object has for itself, has two words in double-single" in said and "expected a 'shared' param" in said


@pytest.mark.parametrize("options, expected", [
    (("--spread", "until=1:2"), "object 1 has another 'until' than object 0: objects that see each other make the same adaptive steps"),
    (("--spread", "h_next=0.1:0.2"), "object 1 has another 'h_next' than object 0"),
    (("--spread", "t=0:0.5"), "object 1 has another 't' than object 0")])
def test_what_differs_is_refused(run, options, expected):
    assert expected in run(DECAY.format(relation="all ties"), 3, "--until", 2, "--tolerance", "1e-3", *options, code=2)


def test_what_does_not_go_with_it(run):
    rest = DECAY.format(relation="near ties(x, 0.1)") + "rest when x < 0.1 for 1\n"
    assert "adaptive steps are those of all objects that see each other" in run(rest, 2, "--until", 1, "--tolerance", "1e-3", code=2)
    remove = DECAY.format(relation="near ties(x, 0.1)") + "when x < 0.1: remove\n"
    assert "`remove` ends a life after a step that all objects make" in run(remove, 2, "--until", 1, code=2)


@pytest.mark.parametrize("body, expected", [
    ("st all\n", "r1 is a .worst, which all objects compare behind the phase that stores it: expected a phase, and not the last one, that does"),
    ("st x\nphase\nld x\nst x\n", "r1 is a .worst"),
    ("st x\nst all\nphase\nld x\nst x\nst all\n", "r1 is a .worst"),
    ("add x, x, 1.0\n", "r1 is a .worst")])
def test_a_worst_that_nobody_compares(start, folder, body, expected):
    (folder / "m.s").write_text(f".state x\n.worst all\nstep:\n{body if body[0] == 'a' else 'ld x' + chr(10) + body}")
    done = start("m.s", "--engine", "isa", "-c", "world", "-N", 2, "--steps", 1)
    assert done.returncode == 2 and expected in done.stderr


LARGEST = {"add w{}, x, 4.0": 0x40a00000, "sub w{}, x, 2.0": 0xbf800000, "mul w{}, x, 0.0": 0, "abs w{}, x\nmul w{}, w{}, -0.0": 0x80000000,
           "abs w{}, x\nrsqrt w{}, w{}": 0x7f800000, "rsqrt w{}, x": 0x7fc00000}


@pytest.mark.parametrize("engine", ["isa", "fast", "rtl"])
def test_the_largest_word(start, folder, engine):
    """By hand, of -1, 0 and 1: the largest number, with its sign; +0 before -0; a NaN before all."""
    who = range(len(LARGEST))
    makes = "\n".join(f"{code.replace('{}', str(i))}\nst w{i}" for i, code in enumerate(LARGEST))
    sees = "\n".join(f"ld w{i}\nadd y{i}, w{i}, -0.0" for i in who)
    ends = "\n".join(f"st y{i}" for i in who)
    states, worst = " ".join(f"y{i}" for i in who), " ".join(f"w{i}" for i in who)
    (folder / "m.s").write_text(f".state x {states}\n.worst {worst}\nstep:\nld x\n{makes}\nphase\n{sees}\n{ends}\n")
    values = ("--spread", "x=-1:1", *(f"--set=y{i}=0" for i in who))
    done = start("m.s", "--engine", engine, "-c", "world", "-N", 3, "--steps", 1, "--all", *values, "--allow-failures")
    found = re.findall(r"^y\d .* 0x(\w+)   object", done.stdout, re.M)
    assert [int(word, 16) for word in found] == list(LARGEST.values())*3, done.stdout + done.stderr


# ---- groups that see each other ----

PAIR = KEPLER.replace("all others", "{kind}all others{of}").replace("state v", "model {name}\nstate v", 1)
LINE = """\
model {name}
state x = 0
state v = 0
{kind}all others{of}
step 2^-10
x' = v
v' = sum(o in others: 16*(o.x - x)/(0.01 + (o.x - x)^2))
"""
BALL = """\
model {name}
{kind}state x = 1
state v = 0
state n = 0
state at = 0
near ties(x, {of}0.01)
step 0.015625
x' = v + 0*sum(o in ties: o.x)
v' = -1
n' = 0
at' = 0
{event}"""
EVENTS = {"root": "when root(x) falling: v = -v, at = t, n = n + 1\n", "condition": "when x < 0 and v < 0: v = -v, at = t, n = n + 1\n", "none": ""}
CHOSEN = 'integrator = "cash_karp"; tolerance = 1e-4; until = 3.0; '
CUT = 'integrator = "rk4"; until = 3.0; '


def number(word):
    return float(np.array([int(word[:8], 16)], np.uint32).view(np.float32)[0])


@pytest.mark.parametrize("integrator", ["cash_karp", "dopri5", "rkc8", pytest.param("heun", marks=pytest.mark.long)])
def test_a_pair_of_two_kinds(together, integrator):
    """Two bodies make the same steps, in every bit, whether they are of one group or of two: in a plane, or on a line where the plane takes too many registers."""
    model, x, v, words = PAIR, "r_x", "v_y", "r[2]"
    if integrator != "cash_karp":
        model, x, v, words = LINE, "x", "v", "x"
    settings = f'integrator = "{integrator}"; tolerance = 1e-5; until = 6.25; ' + ("double_single = true; " if integrator == "heun" else "")
    whole = together((model.format(name="a", kind="", of=""), settings + f"objects = 2; spread = {{ {x} = [0.1, -0.1]; {v} = [4.35, -4.35]; }};"))
    parts = [(model.format(name=a, kind=f"kind {b}({words})\n", of=f"({b})"), settings + f"objects = 1; set = {{ {x} = {sign * 0.1}; {v} = {sign * 4.35}; }};")
             for a, b, sign in (("a", "b", 1), ("b", "a", -1))]
    assert together(*parts) == whole and number(whole["rejected"][0]) > (1 if integrator == "heun" else 5)


def ball(name, other, height, event, settings):
    kind, of = (f"kind {other}(x)\n", f"{other}.x, ") if other else ("", "")
    return BALL.format(name=name, kind=kind, of=of, event=EVENTS[event]), settings + (f"objects = 1; set = {{ x = {height}; }};" if other else 'points = "heights.csv";')


@pytest.mark.parametrize("settings", [CHOSEN, CUT])
@pytest.mark.parametrize("event", ["root", "condition"])
def test_events_of_another_kind(together, folder, settings, event):
    """An event of one kind ends the steps of all, also of a kind without events; they are those of one group in which its objects have the event, far away."""
    heights, events = (1.0, 30.0, 2.0), (event, "none", event)
    (folder / "heights.csv").write_text("x\n" + "\n".join(map(str, heights)) + "\n")
    whole = together(ball("a", None, None, event, settings))
    found = together(*(ball(a, b, x, what, settings) for a, b, x, what in zip("abc", "bca", heights, events)))
    assert found == whole and [number(word) for word in found["n"]] == [1, 0, 1] and len(set(found["t"])) == 1


@pytest.mark.parametrize("settings", [CHOSEN, pytest.param(CUT, marks=pytest.mark.long)])
def test_kinds_have_the_same_words_everywhere(together, settings):
    """A root in one kind, a condition in another, no event in a third, what pairs remember, and a fourth that stands still and makes steps of its own."""
    kinds = [list(ball(a, b, x, what, settings.replace("3.0", "0.375"))) for a, b, x, what in zip("abc", "bca", (0.03125, 30.0, 0.0625), ("root", "none", "condition"))]
    kinds[0][0] = "kind floor(y)\n".join(kinds[0][0].split("\n", 1)).replace("model a", "model a\n") \
        .replace("0.01)", "0.5, s = 0)\nall grounds(floor)") + "project n = n + 0*sum(o in grounds: o.y)\nremember o in ties: o.s = o.s + 1\n"
    floor = ("model floor\nstate y = 0.5\nstep 0.5\ny' = 0\n", "objects = 2;")
    found = [together(floor, *kinds, engine=engine) for engine in ("isa", "fast", "rtl")]
    assert found[0] == found[1] == found[2] and [number(word) for word in found[0]["n"]] == [1, 0, 1]


CLOCK = "model clock\nkind follower(x)\nstate x = 0\n{param} on = 0.3\nall them(follower)\nstep 0.25\nx' = (t > on ? 1 : 0) + 0*sum(o in them: o.x)\n"
FOLLOWER = "model follower\nkind clock(x)\nstate x = 1\nstate n = 0\nall them(clock)\nstep 0.25\nx' = -x + 0*sum(o in them: o.x)\nn' = 0\n"


@pytest.mark.parametrize("settings", [CHOSEN, CUT])
@pytest.mark.parametrize("param", ["param", "shared"])
def test_times_of_one_kind_end_the_steps_of_all(together, param, settings):
    found = together((FOLLOWER, settings + "objects = 2;"), (CLOCK.format(param=param), settings + "objects = 3;" + (" spread = { on = [0.1, 1.3]; };" if param == "param" else "")))
    ends = [3 - on for on in ((0.1, 0.7, 1.3) if param == "param" else (0.3,) * 3)]
    assert np.abs(np.array([number(word) for word in found["x"][2:]]) - ends).max() < 1e-6
    assert abs(number(found["x"][0]) - math.exp(-3)) < 3e-4 and len(set(found["accepted"])) == len(set(found["t"])) == 1


def test_who_is_seen_alone_makes_the_same_steps(together):
    """A kind that sees nobody, and one of which none moves."""
    seen = "model clock\nstate x = 0\nstep 0.01\nx' = {}\n"
    for moves, end in (("cos(3*t)", math.sin(9) / 3), ("0", 0)):
        found = together((FOLLOWER, CHOSEN + "objects = 2;"), (seen.format(moves), CHOSEN + "objects = 1;"))
        assert abs(number(found["x"][2]) - end) < 1e-3 and len(set(found["accepted"])) == 1 and set(found["t"]) == {"40400000" + "00000000"}
        assert len(found["h_next"]) == 3 and len(set(found["h_next"])) == 1


def test_a_longest_step_is_that_of_all(together):
    found = together((FOLLOWER, CHOSEN + "objects = 1; maxstep = 0.05;"), (CLOCK.format(param="shared"), CHOSEN + "objects = 1; maxstep = 0.0625;"))
    assert {number(word) for word in found["largest"]} == {np.float32(0.05)}


@pytest.mark.parametrize("own, other, expected", [
    ("", CHOSEN, "group 'follower': it makes steps of one length, and group 'clock' chooses its steps by a tolerance"),
    (CHOSEN, CUT.replace("rk4", "cash_karp"), "it chooses its steps by a tolerance, and group 'clock' makes steps of one length up to events"),
    (CHOSEN, CHOSEN.replace("3.0", "2.0"), "object 1 has another 'until' than object 0"),
    (CHOSEN + "set = { h_next = 0.01; };", CHOSEN, "object 1 has another 'h_next' than object 0"),
    (CHOSEN.replace("cash_karp", "dopri5"), CHOSEN, "it steps by 'dopri5', and group 'clock' by 'cash_karp'"),
    (CUT + "set = { h = 0.125; };", CUT, "groups that see each other make their steps together, so give the scene one h"),
    (CHOSEN + "born = 2;", CHOSEN, "steps that a scene has in common"),
])
def test_kinds_that_cannot_make_the_same_steps(together, own, other, expected):
    assert expected in together((FOLLOWER, own + "objects = 1;"), (CLOCK.format(param="shared"), other + "objects = 1;"), code=2)


def test_what_does_not_go_with_kinds(together):
    clock = (CLOCK.format(param="shared"), CHOSEN + "objects = 1;")
    located = (FOLLOWER + EVENTS["root"].split(" v")[0] + " n = n + 1\n", CHOSEN + "objects = 1; set = { locate = 1e-3; };")
    assert "object 1 has another 'locate' than object 0" in together(located, clock, code=2)
    rest = (FOLLOWER + "rest when x < 0.1 for 1\n", CHOSEN + "objects = 1;")
    assert "adaptive steps are those of all objects that see each other" in together(rest, clock, code=2)
    free = ("model free\nstate x = 1\nstep 0.1\nx' = -x\n", "objects = 1;")
    assert "group 'free': it makes steps of one length, and group 'follower' chooses" in together((FOLLOWER, CHOSEN + "objects = 1;"), clock, free, code=2)

