"""Structures of scenes: where a grid, a random filling and a file put objects, what they link, and each kind of setting refused in its line."""

import itertools
import math
import re
import struct
import subprocess

import pytest

PROBE = """model probe "adds up its links: k of each, rest of each, the numbers of those at the other ends"
shared once = 1 [1/s]
param  number = 0 [1]
param  w = 1 [1]
state  x[3] = (0, 0, 0) [m]
state  ks = 0 [1]
state  rests = 0 [m]
state  others = 0 [1]
links  springs(k = 1 [1], rest = 0.5 [m])
step   1 [s]
x'      = (0*once)*x
ks'     = once*sum(o in springs: o.k)
rests'  = once*sum(o in springs: o.rest)
others' = once*sum(o in springs: o.number)
"""


def single(value):
    return struct.unpack("f", struct.pack("f", value))[0]


@pytest.fixture
def probe(record, folder):
    """Objects of the probe, after one step by Euler's method: their links are counted."""
    (folder / "probe.ode").write_text(PROBE)

    def probe(settings, points=None):
        if points:
            (folder / "points.csv").write_text(points)
        return record(f'steps = 1;\ngroups = ( {{ program = "probe.ode"; integrator = "euler"; {settings} }} );\n')[-1]
    return probe


KINDS = {"structural": lambda d: sorted(d) == [0, 0, 1], "shear": lambda d: max(d) == 1 and sum(d) > 1, "bending": lambda d: sorted(d) == [0, 0, 2]}


@pytest.mark.parametrize("count", [(7,), (4, 3), (3, 4, 2), (1, 5), (2, 1, 1)])
@pytest.mark.parametrize("kinds", [("structural",), ("shear",), ("bending",), ("bending", "structural", "shear")])
def test_a_grid_links_each_pair_once(probe, count, kinds):
    """Beside all pairs of places, tried one by one: how many links, the sum of the numbers at their other ends, and of the lengths."""
    objects = math.prod(count)
    full = (*count, 1, 1)[:3]
    places = [(x, y, z) for z in range(full[2]) for y in range(full[1]) for x in range(full[0])]
    spacing = (0.5, 0.25, 2.0)[:len(count)]
    found = probe(f'grid = {{ position = "x"; count = {list(count)}; spacing = {list(spacing)}; origin = [1.0, 2.0, 3.0]; }}; '
                  f'spread = {{ number = [0, {objects - 1}]; }}; '
                  f'links = {{ relation = "springs"; grid = {str(list(kinds)).replace(chr(39), chr(34))}; rest = "rest"; set = {{ k = 3; }}; }};')
    assert len(found) == objects
    for i, one in enumerate(found):
        at = [1 + 0.5 * places[i][0], 2 + (0.25 if len(count) > 1 else 0) * places[i][1], 3 + (2 if len(count) > 2 else 0) * places[i][2]]
        assert [one["x_x"], one["x_y"], one["x_z"]] == at
        linked = [j for j in range(objects) if any(KINDS[kind]([abs(a - b) for a, b in zip(places[i], places[j])]) for kind in kinds)]
        assert one["ks"] == 3 * len(linked)
        assert one["others"] == sum(linked)
        lengths = [math.hypot(*(s * (a - b) for s, a, b in zip(spacing, places[i], places[j]))) for j in linked]
        assert one["rests"] == pytest.approx(sum(lengths), rel=1e-6)


def test_a_grid_lies_along_other_axes(probe):
    found = probe('grid = { position = "x"; count = [2, 3]; spacing = [0.5, -1.0]; along = "zx"; }; links = { relation = "springs"; grid = "shear"; };')
    assert [(one["x_x"], one["x_y"], one["x_z"]) for one in found] == [(-b, 0, 0.5 * a) for b in range(3) for a in range(2)]
    assert [one["rests"] for one in found] == [0.5, 0.5, 1, 1, 0.5, 0.5]  # what the model says, where no field is named


def test_blocks_of_links_follow_each_other(probe, folder):
    """Of a grid with one k, of it with another one, from a file; a column that one has alone is the model's default in the others."""
    (folder / "more.csv").write_text("# two more\na,b,rest\n\n0 , 3,7\r\n1,4, 0.25\n")
    found = probe('grid = { count = 5; }; links = ( { relation = "springs"; grid = "structural"; set = { k = 2; }; }, '
                  '{ relation = "springs"; grid = "bending"; rest = "rest"; }, { relation = "springs"; file = "more.csv"; } );')
    assert [one["ks"] for one in found] == [2 + 1 + 1, 4 + 1 + 1, 4 + 2, 4 + 1 + 1, 2 + 1 + 1]
    assert [one["rests"] for one in found] == [0.5 + 2 + 7, 1 + 2 + 0.25, 1 + 4, 1 + 2 + 7, 0.5 + 2 + 0.25]


def test_points_and_values_of_some(probe):
    found = probe('points = "points.csv"; grid = { count = 4; }; links = { relation = "springs"; grid = "structural"; }; '
                  'only = ( { objects = (0, "2..3"); set = { number = 9; }; }, { objects = "3..3"; set = { number = 1.5; x_y = -1; }; } );',
                  points="x_x,number\n 1,10\n2.5e-1,11\n-3,12\n4,13\n")
    assert [one["x_x"] for one in found] == [1, 0.25, -3, 4]
    assert [one["x_y"] for one in found] == [0, 0, 0, -1]
    assert [one["others"] for one in found] == [11, 9 + 9, 11 + 1.5, 9]


BOX = 'groups = ( {{ program = "balls.ode"; integrator = "semi_implicit_euler"; objects = {n}; random = {{ position = "x"; from = [0.1, 0.2, -1.0]; to = [1.1, 0.7, 1.0]; apart = {apart}; seed = {seed}; }}; }} );\n'


def test_a_random_filling(record):
    """In the box, apart, the same for the same seed: the first object's place is splitmix64's, computed here as well."""
    first, same, other = (record("steps = 0;\n" + BOX.format(n=200, apart=0.1, seed=seed))[0] for seed in (7, 7, 8))
    assert first == same and first != other
    state, numbers = 7, []
    for _ in range(3):
        state = (state + 0x9e3779b97f4a7c15) % 2**64
        z = state
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9 % 2**64
        z = (z ^ z >> 27) * 0x94d049bb133111eb % 2**64
        numbers.append((z ^ z >> 31) >> 11)
    low, high = (0.1, 0.2, -1.0), (1.1, 0.7, 1.0)
    assert [first[0]["x_" + axis] for axis in "xyz"] == [pytest.approx(single(a + n / 2**53 * (b - a)), rel=1e-7) for n, a, b in zip(numbers, low, high)]
    places = [tuple(one["x_" + axis] for axis in "xyz") for one in first]
    assert len(places) == 200 and all(a <= x <= b for place in places for x, a, b in zip(place, low, high))
    assert min(math.dist(*pair) for pair in itertools.combinations(places, 2)) >= 0.1 - 1e-9
    for axis, middle, half in ((0, 0.6, 0.5), (1, 0.45, 0.25), (2, 0, 1)):  # the whole box, not a corner of it
        assert abs(sum(place[axis] for place in places) / 200 - middle) < half / 4


def test_a_box_that_is_too_small(refused):
    said = refused("steps = 0;\n" + BOX.format(n=5000, apart=0.1, seed=1))
    assert said.startswith("2: random: ") and "of 5000 objects found a place that is 0.1 apart" in said
    assert 300 < int(said.split()[2]) < 1400  # of at most 1909 in the densest packing


# ---- what is refused ------------------------------------------------------------------------------

CHAIN = 'steps = 1;\ngroups = ( {{ program = "chain.ode";\n{} }} );\n'
CLOTH = 'steps = 1;\ngroups = ( {{ program = "cloth.ode"; integrator = "euler";\n{} }} );\n'
BALLS = CLOTH.replace("cloth", "balls")
LINKED = 'links = { relation = "springs"; grid = "structural"; };'

WRONG = [
    (CHAIN, "grid = 3;", "3: grid: found '3', expected a group, { position = ...; count = ...; ... }"),
    (CHAIN, "grid = { };", "3: expected count, 1 to 3 numbers of objects"),
    (CHAIN, "grid = { count = 0; };", "3: count: found '0', expected an integer from 1 to 33554432"),
    (CHAIN, "grid = { count = [2, 2, 2, 2]; };", "3: count: found a list [ ] of 4, expected 1 to 3 numbers of objects"),
    (CHAIN, "grid = { count = [33554432, 2]; };", "3: count: found 67108864 objects, expected at most 33554432"),
    (CHAIN, "grid = { count = 3; size = 2; };", "3: found 'size', expected a setting of grid: position, count, spacing, origin, along"),
    (CHAIN, "objects = 3;\ngrid = { count = 3; };", "3: objects: the grid says how many there are"),
    (CHAIN, "grid = { count = 3; along = \"x\"; };", "3: along: expected position, too"),
    (CHAIN, "grid = { position = \"q\"; count = 3; spacing = 1; };", "3: position: found 'q', expected a state"),
    (CHAIN, "grid = { position = \"u\"; count = 3; };", "3: expected spacing, a number"),
    (CHAIN, "grid = { position = \"u\"; count = 3; spacing = 0.0; };", "3: spacing: found 0, expected a distance other than 0"),
    (CHAIN, "grid = { position = \"u\"; count = [3, 2]; spacing = 1; };", "3: the grid has 2 axes, along 'xy', and the position has 1 component"),
    (CLOTH, "grid = { position = \"x\"; count = [3, 2]; spacing = [1.0]; };", "3: spacing: found a list [ ] of 1, expected 2 numbers [x, y]"),
    (CLOTH, "grid = { position = \"x\"; count = [3, 2]; spacing = 1; along = \"xx\"; };", "3: the grid has 2 axes, along 'xx', and the position has 3 components, each for one axis"),
    (CLOTH, "grid = { position = \"x\"; count = [3, 2]; spacing = 1; along = \"x\"; };", "3: along: found 'x', expected a letter for each of the 2 axes"),
    (CLOTH, "grid = { position = \"x\"; count = [3, 2]; spacing = 1; origin = 5; };", "3: origin: found '5', expected 3 numbers [x, y, z]"),
    (CHAIN, "grid = { count = 3; };\nlinks = 5;", "4: links: found '5', expected a group, { relation = ...; grid = ... or file = ...; ... }"),
    (CHAIN, "grid = { count = 3; };\nlinks = { grid = \"shear\"; };", "4: expected relation, the name of links in the model"),
    (CHAIN, "grid = { count = 3; };\nlinks = { relation = \"spring\"; grid = \"shear\"; };", "4: relation: found 'spring', expected links of the model (did you mean 'springs'?)"),
    (CHAIN, "grid = { count = 3; };\nlinks = { relation = \"springs\"; };", "4: expected one of grid and file in links"),
    (CHAIN, "grid = { count = 3; };\nlinks = { relation = \"springs\"; grid = \"diagonal\"; };", "4: grid: found 'diagonal', expected \"structural\", \"shear\" or \"bending\""),
    (CHAIN, "objects = 3;\nlinks = { relation = \"springs\";\ngrid = \"shear\"; };", "5: grid: this group has no grid"),
    (CHAIN, "grid = { count = 3; };\nlinks = { relation = \"springs\"; grid = \"structural\"; rest = \"rest\"; };", "4: links 'springs' have no field 'rest'"),
    (CHAIN, "grid = { count = 3; };\nlinks = { relation = \"springs\"; grid = \"structural\"; set = { c = 1; }; };", "4: links 'springs' have no field 'c'"),
    (CHAIN, "grid = { count = 3; };\nlinks = { relation = \"springs\"; grid = \"structural\"; set = { k = 1e50; }; };", "4: k: found '1e50', expected a number below 3.4028236e38"),
    (CLOTH, "grid = { count = 3; };\nlinks = { relation = \"springs\"; grid = \"structural\"; rest = \"k\"; set = { k = 1; }; };", "4: links of 'springs': field 'k' has two columns"),
    (CHAIN, "objects = 3;\nlinks = { relation = \"springs\"; file = \"no.csv\"; };", "4: no.csv"),
    (CHAIN, "objects = 3;\nlinks = { relation = \"springs\"; file = \"links.csv\"; rest = \"k\"; };", "4: rest: only a grid knows the length"),
    (CHAIN, "objects = 3;\nlinks = { relation = \"springs\"; file = \"links.csv\"; };", "4: links.csv:3:3: error: found object 3, expected a whole number from 0 to 2"),
    (CHAIN, "points = \"links.csv\";\n" + LINKED, "4: grid: this group has no grid"),
    (CHAIN, "grid = { count = 3; };\npoints = \"links.csv\";", "4: points: found 2 lines of numbers, expected 3, one for each object of the grid"),
    (CHAIN, "points = \"head.csv\";", "3: points: 'head.csv' has no object"),
    (CHAIN, "objects = 2;\npoints = \"links.csv\";", "3: objects: the file of points says how many there are"),
    (CLOTH, "grid = { count = 3; };\nrandom = { };", "4: found grid and random, expected one of them"),
    (CLOTH, "random = { };", "2: expected the number of objects of this group"),
    (CLOTH, "objects = 3;\nrandom = { position = \"x\"; from = [0, 0, 0]; to = [1, 0, 1]; apart = 0.1; };", "4: to: found 0, expected a number above that of from, 0"),
    (CLOTH, "objects = 3;\nrandom = { position = \"x\"; from = [0, 0]; to = [1, 1]; apart = 0.1; };", "4: from: found a list [ ] of 2, expected 3 numbers [x, y, z]"),
    (CLOTH, "objects = 3;\nrandom = { position = \"x\"; from = [0, 0, 0]; to = [1, 1, 1]; };", "4: expected apart, the least distance of two objects"),
    (CLOTH, "objects = 3;\nrandom = { position = \"x\"; from = [0, 0, 0]; to = [1, 1, 1]; apart = -1; };", "4: apart: found '-1', expected a distance of 0 or more"),
    (CHAIN, "grid = { count = 3; };\nonly = 3;", "4: only: found '3', expected a group, { objects = ...; set = { ... }; }"),
    (CHAIN, "grid = { count = 3; };\nonly = { set = { w = 0.0; }; };", "4: expected objects, numbers of objects"),
    (CHAIN, "grid = { count = 3; };\nonly = { objects = 3; set = { w = 0.0; }; };", "4: objects: found '3', expected an integer from 0 to 2"),
    (CHAIN, "grid = { count = 3; };\nonly = { objects = \"1..3\"; set = { w = 0.0; }; };", "4: objects: found '1..3', expected numbers from 0 to 2"),
    (CHAIN, "grid = { count = 3; };\nonly = { objects = \"2..1\"; set = { w = 0.0; }; };", "4: objects: found '2..1', expected numbers of objects"),
    (CHAIN, "grid = { count = 3; };\nonly = { objects = 1; };", "4: expected set, a group of values"),
    (CHAIN, "grid = { count = 3; };\nonly = { objects = 1;\nset = { q = 0.0; }; };", "5: the model has no state or param 'q'"),
    (CHAIN, "grid = { count = 3; };\nset = { w = \"2*3\"; };\nonly = { objects = 1;\nset = { w = 0.0; }; };\n" + LINKED, "6: 'w' is 0, but it is 2*3, which is 6: leave it out"),
    (CHAIN, "grid = { count = 3; };\nskin = 0.5;\n" + LINKED, "4: skin: the program has no relation `near`"),
    (BALLS, "objects = 3;\nskin = -1;", "4: skin: found '-1', expected a share of the reach, 0 to 1000"),
    (BALLS, "objects = 3;\nskin = 1001;", "4: skin: found '1001', expected a share of the reach, 0 to 1000"),
    (BALLS, "objects = 3;\nskin = \"wide\";", "4: skin: found a text, expected a number"),
]


@pytest.mark.parametrize("number", range(len(WRONG)))
def test_each_setting_is_refused_in_its_line(refused, folder, number):
    scene, settings, expected = WRONG[number]
    (folder / "links.csv").write_text("a,b\n0,1\n1,3\n")
    (folder / "head.csv").write_text("# nothing\nu,v\n\n")
    assert expected in refused(scene.format(settings))


def test_missing_links_are_named(start, folder):
    (folder / "x.scene").write_text(CHAIN.format("objects = 3;"))
    done = start("--scene", "x.scene")
    assert done.returncode == 2 and "linked by 'springs' (line 12 of the model), and no links are given" in done.stderr and "columns a,b,k" in done.stderr


TABLES = [
    ("", "1:1: error: found nothing, expected a line of names"),
    ("u,1x\n", "1:3: error: found '1x', expected the name of a column"),
    ("u,\n", "1:3: error: found nothing, expected the name of a column"),
    ("u, v ,u\n", "1:7: error: found 'u', expected a name that no other column has"),
    ("u,v\n1,2\n3\n", "3:2: error: found 1 numbers, expected 2"),
    ("u,v\n1,2,3\n", "2:5: error: found '3', expected the end of the line"),
    ("u,v\n\n# no\n1, x\n", "4:4: error: found 'x', expected a number"),
    ("u,v\n1,nan\n", "2:3: error: found 'nan', expected a finite number"),
    ("u,v\n1,\n", "2:3: error: found nothing, expected a number"),
]


@pytest.mark.parametrize("text, expected", TABLES)
def test_a_file_is_refused_with_line_and_column(refused, folder, text, expected):
    (folder / "points.csv").write_text(text)
    assert refused(CHAIN.format('points = "points.csv";')).startswith(f"3: points.csv:{expected}")


def test_columns_that_the_program_does_not_have(refused, start, folder):
    (folder / "points.csv").write_text("# u\nu,speed\n1,2\n3,4\n")
    (folder / "links.csv").write_text("a,b\n0,1\n")
    (folder / "x.scene").write_text(CHAIN.format('points = "points.csv"; links = { relation = "springs"; file = "links.csv"; };'))
    done = start("--scene", "x.scene")
    assert done.returncode == 2 and "points.csv:2: the program has no 'speed'" in done.stderr
    (folder / "links.csv").write_text("b,a\n0,1\n")
    assert "links.csv:1:1: error: expected a head of a,b and the names of fields" in refused((folder / "x.scene").read_text())
    (folder / "links.csv").write_text("a,b,stiff\n0,1,2\n")
    (folder / "points.csv").write_text("u\n1\n3\n")
    assert "links.csv: links of 'springs': the model has no field 'stiff'" in refused((folder / "x.scene").read_text())


# ---- fp3 run without a scene -----------------------------------------------------------------------

def test_links_of_one_program(start, folder):
    """As many objects as are linked, on engine fast and configuration world; the bits of isa, of an image, and of assembly."""
    (folder / "l.csv").write_text("a,b,k\n0,1,100\n1,2,50\n4,2,25\n")
    options = ["--spread", "v=0:1", "-n", "50", "--all"]
    done = start("chain.ode", "--links", "springs=l.csv", *options)
    assert done.returncode == 0 and "object 4" in done.stdout and "object 5" not in done.stdout and "cycles" not in done.stdout

    def states(text):
        return [line for line in text.splitlines() if "   object " in line]
    assert len(set(states(done.stdout))) == 10
    slow = start("chain.ode", "--links", "springs=l.csv", *options, "-e", "isa", "-c", "world", "-N", "5")
    assert states(slow.stdout) == states(done.stdout)
    fp3 = slow.args[0]
    subprocess.run([fp3, "compile", "chain.ode", "-o", "c.s", "--image", "c.fp3", "--params", "c.cfg"], cwd=folder, check=True)
    for program in ("c.s", "c.fp3"):
        again = start(program, "--params", "c.cfg", "--links", "springs=l.csv", *options)
        assert states(again.stdout) == states(done.stdout), again.stderr


@pytest.mark.parametrize("config, lanes", [("world", 1), ("fabric", 8)])
@pytest.mark.parametrize("integrator", ["euler", "rk4"])
def test_cycles_are_those_of_the_report(fp3, start, folder, integrator, config, lanes):
    """Lists of one length and full batches, a ring in each lane: the lines of --report say all that a step takes."""
    objects, batches, neighbours = 72, 3, 2
    (folder / "rings.csv").write_text("a,b\n" + "".join(f"{ring + i},{ring + (i + 1) % objects}\n" for ring in range(0, lanes * objects, objects) for i in range(objects)))
    report = subprocess.run([fp3, "compile", "chain.ode", "-c", config, "-i", integrator, "--report", "--image", "c.fp3"], cwd=folder, check=True, capture_output=True, text=True).stdout
    lines = re.findall(r"cycles of phase \d+ +(\d+) per object, (\d+) per turn of springs; (\d+) per batch; (\d+) per phase", report)
    assert len(lines) == {"euler": 1, "rk4": 4}[integrator]
    step = sum(objects * (a + neighbours * turn) + batches * batch + around for a, turn, batch, around in (map(int, line) for line in lines))
    runs = [start("chain.ode", "-i", integrator, "--links", "springs=rings.csv", "-n", n, "-e", "rtl", "-c", config).stdout for n in (1, 3)]
    once, thrice = (int(re.search(r"^cycles +(\d+)", run, re.M)[1]) for run in runs)
    assert thrice - once == 2 * step and (config == "fabric" or once == step + 36)
    info = subprocess.run([fp3, "info", "c.fp3"], cwd=folder, check=True, capture_output=True, text=True).stdout
    said = [line for line in report.splitlines() if "cycles of" in line]
    assert "\n".join([f"for         {config}", *said]) in info


def test_what_fp3_run_refuses(start, folder):
    (folder / "l.csv").write_text("a,b,k\n0,1,100\n1,2,50\n")
    (folder / "x.scene").write_text(CHAIN.format("grid = { count = 3; }; " + LINKED))
    for arguments, expected in [(["chain.ode"], "no links are given: links = (...) of a scene or --links of fp3 run gives them, with columns a,b,k"),
                                (["chain.ode", "--links", "springs"], "--links: found 'springs', expected NAME=FILE"),
                                (["chain.ode", "--links", "springs=l.csv", "-N", "2"], "l.csv:3:3: error: found object 2, expected a whole number from 0 to 1"),
                                (["chain.ode", "--links", "touch=l.csv"], "l.csv: links of 'touch': the model has no relation 'touch'"),
                                (["balls.ode", "-i", "euler", "--links", "touch=l.csv"], "the model finds the objects of 'touch' by itself"),
                                (["chain.ode", "--links", "springs=l.csv", "-c", "many_full"], "'springs' needs `neighbours`"),
                                (["--scene", "x.scene", "--links", "springs=l.csv"], "--scene: links are in the scene, not in --links"),
                                (["cloth.ode", "-i", "euler", "--links", "springs=l.csv", "--observe", "F_x", "--output", "o.csv"],
                                 "'springs' is added up in line 21 of the model, and a recording looks at each object by itself")]:
        done = start(*arguments)
        assert done.returncode in (1, 2) and expected in done.stderr, (arguments, done.stderr)
    assert not (folder / "o.csv").exists()


def test_an_input_is_not_overwritten(start, folder):
    (folder / "p.csv").write_text("u\n0.1\n0.2\n")
    (folder / "l.csv").write_text("a,b\n0,1\n")
    (folder / "x.scene").write_text(CHAIN.format('points = "p.csv"; links = { relation = "springs"; file = "l.csv"; };'))
    for name in ("p.csv", "l.csv"):
        before = (folder / name).read_text()
        done = start("--scene", "x.scene", "--output", name)
        assert done.returncode == 2 and f"--output {name} would overwrite points or links" in done.stderr
        assert (folder / name).read_text() == before
    assert start("--scene", "x.scene", "--output", "o.csv").returncode == 0
    done = start("chain.ode", "--links", "springs=l.csv", "--output", "l.csv")
    assert done.returncode == 2 and "--output l.csv would overwrite --links l.csv" in done.stderr


def test_objects_that_do_not_see_each_other_are_placed_too(root, fp3, record, folder):
    """On a machine of old, with its lifetimes; and the tuner takes no values of each object."""
    (folder / "ship.ode").write_text((root / "programs/ship.ode").read_text())
    (folder / "p.csv").write_text("v,T\n1,2e5\n2,2.5e5\n3,3e5\n")
    text = 'config = "many_full"; steps = 3;\ngroups = ( { program = "ship.ode"; points = "p.csv"; gone = 2; only = { objects = 1; set = { s = 5; }; }; } );\n'
    rows = record(text, "-e", "isa")
    assert [one["v"] for one in rows[0]] == [1, 2, 3] and [one["s"] for one in rows[0]] == [0, 5, 0]
    assert rows == record(text)
    (folder / "x.scene").write_text(text.replace("gone = 2; ", ""))
    done = subprocess.run([fp3, "tune", "x.scene", "--tolerance", "1e-3"], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 2 and "has a value of its own for each object" in done.stderr, done.stderr
