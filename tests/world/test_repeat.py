"""Projections that are repeated have the bits of the same lines written several times, on every engine, and what is refused."""

import re
import subprocess

import numpy
import pytest
from test_world import PROJECTED, balls, chain, compile_, fliers, floats, row, script  # noqa: F401, pylint: disable=unused-import

ENGINES = [("isa", 1), ("fast", 1), ("fast", 2), ("interpreter", 2), ("rtl", 1), ("rtl@fabric", 1)]
# Contact by positions (Mueller, Heidelberger, Hennix and Ratcliff, 2007), for all balls at once.
PILE = """
shared R = 0.05 [m]
shared g[3] = (0, 0, -9.81) [m/s^2]
state x[3] = (0, 0, 0) [m]
state v[3] = (0, 0, 0) [m/s]
state push = 0 [m]
near touch(x, 2*R, n = 0)
step 0.002 [s]
x' = v
v' = g
push' = 0
repeat 3
    project x = x + 0.4*sum(o in touch: (1 - 2*R/norm(o.x - x))*(o.x - x))
    project x.z = max(x.z, R), push = push + norm(sum(o in touch: o.x - x))/64
end
project v = (x - prev(x))/h
{more}remember o in touch: o.n = o.n + 1 + push/R
"""
LATER = """repeat 2
    project v = v + 0.1*sum(o in touch: o.v - v)
end
repeat 4
    project push = push + norm(x - prev(x))
end
"""
STOPS = "when root(x.z - 4*R) falling: stop\n"
TIES = PROJECTED.replace("project x = x + sum", "repeat 5\nproject x = x + sum").replace("project v", "end\nproject v")
LAST = """
param over_m = 1 [1/kg]
state x = 0 [m]
state v = 0 [m/s]
links springs(k = 100 [N/m], rest = 0.5 [m])
step 0.01 [s]
x' = v
v' = over_m*sum(o in springs: o.k*(o.x - x - o.rest))
repeat 7
    project x = x + 0.2*sum(o in springs: o.x - x - o.rest), v = v + 0.01*sum(o in springs: o.v - v)
end
"""


def unrolled(model):
    """Each `repeat N` .. `end` as N times its lines."""
    return re.sub(r"repeat (\d+)\n(.*?)end\n", lambda found: found[2] * int(found[1]), model, flags=re.S)


@pytest.mark.parametrize("name, integrator, arithmetic", [
    ("pile", "semi_implicit_euler", "plain"), ("later", "leapfrog", "compensated"), ("stops", "semi_implicit_euler", "plain"),
    ("ties", "euler", "plain"), ("last", "rk4", "plain"), ("last", "leapfrog", "compensated")])
def test_engines_have_the_bits_of_the_lines_written_out(script, name, integrator, arithmetic):
    model, lines, words = {
        "pile": (PILE.format(more=""), fliers(60), "x_x x_y x_z v_x v_y v_z push"), "later": (PILE.format(more=LATER), balls(40), "x_x x_y x_z v_x v_y v_z push"),
        "stops": (PILE.format(more=STOPS), fliers(40), "x_x x_y x_z v_x v_y v_z push stopped"),
        "ties": (TIES, ["objects 4", row("state", "x", [3, -2, 7, 1]), row("state", "v", [2, 4, -6, 8]),
                        *(f"links ties {a} {b} {k}" for a, b, k in ((0, 1, 2), (1, 2, 1), (2, 0, 4), (0, 2, 1)))], "x v w"),
        "last": (LAST, chain(30), "x v")}[name]
    lines = [*lines, "run 1", "run 6", f"print {words}"]
    expected = script(unrolled(model), lines, "isa", integrator, arithmetic)
    assert len(set(expected[0].split())) > 3 and "repeat" not in unrolled(model)
    for engine, threads in ENGINES:
        if arithmetic == "plain" or engine != "rtl@fabric":
            assert script(model, lines, engine, integrator, arithmetic, threads) == expected, engine


def test_a_program_has_the_lines_once(fp3, tmp_path):
    lengths = []
    for times in (2, 63):
        (tmp_path / "last.ode").write_text(LAST.replace("repeat 7", f"repeat {times}"))
        report = subprocess.run([fp3, "compile", "last.ode", "-i", "rk4", "--report"], cwd=tmp_path, capture_output=True, text=True, timeout=60, check=True).stdout
        lengths.append(re.search(r"instructions +(\d+)", report)[1])
        assert f"cycles of phase 5       {times} times " in report and re.search(r"phases of a step +(\d+)", report)[1] == str(4 + times)
    assert lengths[0] == lengths[1]


def test_where_nobody_sees_others_the_lines_are_written_out(fp3, tmp_path):
    model = "state x = 1\nstate v = 1\nstep 0.01\nx' = v\nv' = -x\nrepeat 3\nproject x = x/sqrt(x^2 + v^2), v = v*1.5\nend\nproject v = v - x\n"
    found = []
    for text in (model, unrolled(model)):
        (tmp_path / "m.ode").write_text(text)
        found.append(subprocess.run([fp3, "compile", "m.ode", "-o", "/dev/stdout"], cwd=tmp_path, capture_output=True, timeout=60, check=True).stdout)
    assert re.sub(rb"#.*", b"", found[0]) == re.sub(rb"#.*", b"", found[1])    # notes have the numbers of lines


HEAD = "state x = 0\nlinks ties\nstep 1\nx' = 0\n"
BODY = "project x = x + sum(o in ties: o.x)\n"


@pytest.mark.parametrize("text, at, expected", [
    ("repeat 2\n" + BODY, "5:1", "found 'repeat', expected an `end` behind the projections that are repeated"),
    ("end\n", "5:1", "found 'end', expected a `repeat` before it"),
    ("repeat 2\nend\n", "6:1", "found 'end', expected a projection between `repeat` and `end`"),
    ("repeat 0\n" + BODY + "end\n", "5:8", "found '0', expected a number of times from 1 to 63"),
    ("repeat 64\n" + BODY + "end\n", "5:8", "found '64', expected a number of times from 1 to 63"),
    ("repeat 2\nrepeat 2\n" + BODY + "end\nend\n", "6:1", "found 'repeat', expected `end` first (line 5 has a `repeat`)"),
    ("repeat 2\nwhen x > 1: x = 0\n" + BODY + "end\n", "6:1", "found 'when', expected project, for or end (line 5 has a `repeat`)"),
    ("repeat 2\nfor i in 1..2: when x > i: x = 0\n" + BODY + "end\n", "6:16", "found 'when', expected project, for or end (line 5 has a `repeat`)"),
    ("repeat x\n" + BODY + "end\n", "5:8", "found 'x', expected "),
    ("when root(sum(o in ties: o.x)) any: x = 0\nrepeat 2\n" + BODY + "end\n", "5:11", "this event compares a sum over neighbours with what it was when the step "
     "began, and `repeat` (line 6) has changed the neighbours since")])
def test_what_is_no_repetition(fp3, tmp_path, text, at, expected):
    (tmp_path / "m.ode").write_text(HEAD + text)
    done = subprocess.run([fp3, "compile", "m.ode", "-i", "euler"], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2 and f"m.ode:{at}: " in done.stderr and expected in done.stderr, done.stderr


def test_repeat_and_end_are_names_as_well(fp3, tmp_path):
    (tmp_path / "m.ode").write_text("state repeat = 1\nstate end = 1\nstep 1\nrepeat' = end\nend' = -repeat\n")
    subprocess.run([fp3, "compile", "m.ode"], cwd=tmp_path, capture_output=True, timeout=60, check=True)


ROPE = """steps = 3000;
groups = ( { program = "rope.ode"; integrator = "semi_implicit_euler"; grid = { position = "x"; along = "x"; count = [21]; spacing = 0.1; };
  links = { relation = "rods"; grid = ["structural"]; }; only = { objects = [0]; set = { w = 0.0; }; }; } );
"""


@pytest.mark.parametrize("is_coloured", [False, True])
def test_the_rope_of_the_page(fp3, root, tmp_path, is_coloured):
    """How far rods are stretched, and what a step costs on the hardware, as the page has it: half of the stretch for twice the repetitions."""
    page = (root / "docs/relations.md").read_text()
    lines = re.search(r'^    model rope(?:.*\n)+?    project v.*\n', page, re.M)[0].replace("\n    ", "\n")
    links, loop = re.search(r"^((?:    links .*\n)+)(    repeat 8\n(?:.*\n)+?    end\n)\nA single repetition", page, re.M).groups()
    rows = ("largest stretch of a rod then", "cycles of a step on `world`")
    scene = ROPE
    if is_coloured:
        lines = re.sub(r"links.*\n", lambda _: links, re.sub(r"repeat 8\n(?:.*\n)+?end\n", lambda _: loop, lines))
        rows = ("the same with two colours: stretch", r"\.\.\. cycles")
        scene = re.sub(r"links = .*?}", 'links = ( { relation = "even"; file = "0.csv"; }, { relation = "odd"; file = "1.csv"; } )', ROPE)
        for first in (0, 1):
            (tmp_path / f"{first}.csv").write_text("a,b\n" + "".join(f"{i},{i + 1}\n" for i in range(first, 20, 2)))
    (tmp_path / "rope.scene").write_text(scene)
    table = [[cell.strip() for cell in re.search(rf"^\| {name} \|(.*)\|$", page, re.M)[1].split("|")] for name in ("`repeat`", *rows)]
    for times, stretch, cycles in zip(*table):
        (tmp_path / "rope.ode").write_text(lines.replace("repeat 8", f"repeat {times}"))
        hardware = subprocess.run([fp3, "run", "--scene", "rope.scene", "-e", "rtl", "--steps", "10"], cwd=tmp_path, capture_output=True, text=True, timeout=60, check=True).stdout
        assert round(int(re.search(r"cycles +(\d+)", hardware)[1]) / 10) == int(cycles.replace(",", "")), hardware
        if times not in ("2", "32"):                                   # the others take seconds
            continue
        subprocess.run([fp3, "run", "--scene", "rope.scene", "-e", "fast", "--output", "r.csv"], cwd=tmp_path, capture_output=True, timeout=60, check=True)
        head, *rows = [line.split(",") for line in (tmp_path / "r.csv").read_text().splitlines()]
        at = numpy.array([[float(row[k]) for k, name in enumerate(head) if name.startswith("x_")] for row in rows[-21:]])
        found = numpy.linalg.norm(numpy.diff(at, axis=0), axis=1).max() / 0.1 - 1
        assert abs(100 * found - float(stretch.split()[0])) < 0.006 * 10 ** (times == "2"), (times, found)


MOVED = """\
model {name}
{kind}state x = 1
state v = 0
all others{of}
step 0.125
x' = v
v' = sum(o in others: o.x - x)
{body}project v = (x - prev(x))/h
"""
PULL = "project x = x + 0.1*sum(o in others: o.x - x)\n"
ROUND = "repeat {}\n" + PULL + "end\n"
TOLERANCE = 'integrator = "cash_karp"; tolerance = 1e-3; until = 0.5; '


def pair(bodies, settings):
    """Two groups of one object each."""
    return [(MOVED.format(name=a, kind=f"kind {b}(x)\n", of=f"({b})", body=body), settings + f"objects = 1; set = {{ x = {x}; }};")
            for a, b, body, x in zip("ab", "ba", bodies, (0.0, 1.0))]


@pytest.mark.parametrize("settings", ["steps", TOLERANCE, 'integrator = "rk4"; until = 0.5; '])
def test_each_repetition_sees_what_the_one_before_has_left(together, settings):
    """In steps that all objects choose, too: there no loop of the program repeats."""
    one = MOVED.format(name="a", kind="", of="", body="{}")
    settings = ('integrator = "rk4"; ' if settings == "steps" else settings) + "objects = 3; spread = { x = [0.0, 1.0]; };"
    assert together((one.format(ROUND.format(3)), settings), engine="isa") == together((one.format(3*PULL), settings), engine="isa")


@pytest.mark.parametrize("settings", ['integrator = "leapfrog"; ', 'integrator = "rk4"; ', 'integrator = "ros2"; ', TOLERANCE])
def test_kinds_repeat_round_by_round(together, settings):
    """Two groups that repeat have the words of one group; beside a group that does not, or once, each repetition is a projection of its own."""
    whole = together((MOVED.format(name="a", kind="", of="", body=ROUND.format(3)), settings + "objects = 2; spread = { x = [0.0, 1.0]; };"), engine="isa")
    assert together(*pair(2*[ROUND.format(3)], settings), engine="isa") == whole
    for body in ("", PULL, ROUND.format(5)):
        found = together(*pair((ROUND.format(3), body), settings), engine="isa")
        assert found == together(*pair((3*PULL, body), settings), engine="isa") and found["x"] != whole["x"]


def test_repetitions_of_kinds_on_every_engine(together):
    groups = pair((ROUND.format(4), ROUND.format(2) + "remember o in seen: o.s = o.s + 1\n"), 'integrator = "heun"; ')
    groups[1] = (groups[1][0].replace("all others", "near seen(x, a.x, 2, s = 0)\nall others"), groups[1][1])
    found = [together(*groups, engine=engine) for engine in ("isa", "fast", "rtl")]
    assert found[0] == found[1] == found[2]


def test_so_many_repetitions_of_kinds(together):
    """Of leapfrog, 40; and beside a kind that never moves, all, as a loop of the program."""
    most = together(*pair(2*[ROUND.format(40)], 'integrator = "leapfrog"; '), engine="isa")
    assert most["x"][0] != most["x"][1]
    said = together(*pair(2*[ROUND.format(41)], 'integrator = "leapfrog"; '), code=2, engine="isa")
    assert "too many projections and events: a sum over another kind is at one of the first 63 places of a step, and each repetition has its own" in said
    still = "model b\nstate x = 1\nstep 0.125\nx' = 0\n"
    assert together(pair(2*[ROUND.format(63)], 'integrator = "leapfrog"; ')[0], (still, "objects = 1;"), engine="isa")["x"][1] == "3f800000"
