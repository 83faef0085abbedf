"""Scenes of rigid bodies: fp3 run --scene has the bits of the calls in Python, on every engine, and files are whole or not there."""

import csv
import os
import pathlib
import re
import subprocess
import sys

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("FP3_BUILD", ROOT / "build"))
os.environ["FP3_HOME"] = str(BUILD)
sys.path.insert(0, str(ROOT / "python"))
if BUILD.name != "build" and "libasan" not in os.environ.get("LD_PRELOAD", ""):
    pytest.skip("sanitizers have to be there before Python", allow_module_level=True)

import fp3 as package  # noqa: E402

WORLD = """# a chain of two links hangs over a heap
steps = 40;
gravity = [0.5, -10.0];
h = 0.02;
substeps = 3;
bodies = (
    { name = "ground"; type = "static"; shapes = ( { box = [20.0, 1.0]; centre = [0.0, -1.0]; friction = 0.9; },
      { chain = { count = 4; at = ("8 - corner", "0.1*corner^2"); }; } ); },
    { name = "brick"; count = (3, "3 - i"); x = ("1.05*(j + i/2)", "i + 0.5"); angle = "0.01*n";
      one_of = ( { box = [0.5, 0.5]; }, { circle = 0.5; restitution = 0.4; }, { capsule = ([-0.2, 0.0], [0.2, 0.0]); radius = 0.3; } ); },
    { name = "link"; count = 2; x = ("i - 5", 5); v = [0.0, 2.0]; w = 1.0; may_not_sleep = true;
      shapes = { polygon = ( [-0.5, -0.1], [0.5, -0.1], [0.0, 0.2] ); density = 3.0; mask = 0x3; }; },
    { name = "eye"; x = [1.0, 1.0]; type = "kinematic"; v = [0.1, 0.0]; shapes = { circle = 0.5; is_sensor = true; }; }
);
joints = (
    { hinge = ["ground", "link[0]"]; at = [-5.0, 5.0]; limits = [-2.0, 2.0]; speed = 1.0; most = 5.0; },
    { count = 1; rod = ["link[n]", "link[n + 1]"]; anchor_a = [0.5, 0.0]; hertz = 3.0; damping = 0.2; }
);
"""


def world():
    """The same by calls."""
    made = package.Bodies(gravity=(0.5, -10), h=0.02, substeps=3)
    ground = made.add(type="static")
    made.attach(ground, package.box(20, 1, centre=(0, -1), friction=0.9))
    made.chain(ground, [(8 - i, 0.1 * i**2) for i in range(4)])
    shapes = [package.box(0.5, 0.5), package.circle(0.5, restitution=0.4), package.capsule((-0.2, 0), (0.2, 0), 0.3)]
    bricks = [(i, j) for i in range(3) for j in range(3 - i)]
    for n, (i, j) in enumerate(bricks):
        made.attach(made.add(x=(1.05 * (j + i / 2), i + 0.5), angle=0.01 * n), shapes[n % 3])
    links = [made.add(x=(i - 5, 5), v=(0, 2), w=1, may_not_sleep=True) for i in range(2)]
    for link in links:
        made.attach(link, package.polygon([(-0.5, -0.1), (0.5, -0.1), (0, 0.2)], density=3, mask=3))
    eye = made.add(x=(1, 1), type="kinematic", v=(0.1, 0))
    made.attach(eye, package.circle(0.5, is_sensor=True))
    made.join("hinge", ground, links[0], anchor_a=(-5, 5), limits=(-2, 2), speed=1, most=5)
    made.join("rod", links[0], links[1], anchor_a=(0.5, 0), hertz=3, damping=0.2)
    return made


def start(command, *arguments, folder, code=0):
    done = subprocess.run([command, *arguments], cwd=folder, capture_output=True, text=True)
    assert done.returncode == code, done.stderr
    return done.stdout if code == 0 else done.stderr


@pytest.fixture
def run(fp3, tmp_path):
    def with_text(text, *arguments, code=0):
        (tmp_path / "x.scene").write_text(text)
        return start(fp3, "run", "--scene", "x.scene", *arguments, folder=tmp_path, code=code)
    return with_text


def hash_of(said):
    return re.search(r"^hash +([0-9a-f]{16})$", said, re.M)[1]


def test_a_scene_has_the_bits_of_calls(run):
    made = world()
    made.step(40)
    said = run(WORLD)
    assert hash_of(said) == f"{made.hash:016x}"
    assert re.search(r"^bodies +10, of which \d+ are awake$", said, re.M) and "joints           2, of which 0 broke" in said
    assert hash_of(run(WORLD, "-n", "41")) != hash_of(said)


@pytest.mark.parametrize("engine, steps", [("fast", 40), ("isa", 8), pytest.param("rtl", 2, marks=pytest.mark.long)])
def test_each_engine_has_the_same_bits(run, engine, steps):
    said = run(WORLD, "-e", engine, "-n", str(steps))
    assert f"laws on engine {engine}" in said
    assert hash_of(said) == hash_of(run(WORLD, "-n", str(steps)))


def test_the_hardware_has_the_same_bits(run):
    text = "steps = 1; substeps = 2; bodies = ( { type = \"static\"; shapes = { box = [2.0, 0.5]; }; }, { x = [0.0, 0.99]; v = [1.0, 0.0]; shapes = { circle = 0.5; }; } );"
    assert hash_of(run(text, "-e", "rtl")) == hash_of(run(text))


def test_random_numbers_follow_the_seed_and_the_entry(run):
    text = 'bodies = ( %s { count = 3; x = ["random", "random"]; angle = "random"; shapes = { circle = 0.1; }; } );'
    row = re.compile(r"^body 2 +(\S+) +(\S+)", re.M)
    first = [float(x) for x in row.search(run(text % "", "-n", "0")).groups()]
    assert all(0 < x < 1 for x in first) and first[0] != first[1]
    assert [float(x) for x in row.search(run(text % "", "-n", "0", "--seed", "7")).groups()] != first
    seeds = [run(f"{file}{text % ''}", "-n", "0", *option) for file in ("", "seed = 0; ", "seed = 7; ") for option in ((), ("--seed", "0"))]
    assert len({said.split("hash")[0].split("body", 1)[1] for said in seeds}) == 2 and seeds[4] != seeds[5]         # 0 is a seed, and the default
    assert run("seed = 7; " + text % "", "-n", "0").splitlines()[:4] == run(text % "", "-n", "0", "--seed", "7").splitlines()[:4]


def test_a_file_of_points(run, tmp_path):
    (tmp_path / "stones.csv").write_text("# three stones\nx,y,size\n0,1,0.5\n2,1,0.25\n4.5,1,0.125\n")
    (tmp_path / "ground.csv").write_text("x,y\n9,0\n-9,0\n")
    said = run('bodies = ( { type = "static"; shapes = { chain = "ground.csv"; }; },\n'
               '{ name = "stone"; points = "stones.csv"; x = ["x", "y"]; shapes = { circle = "size"; }; } );', "-n", "0", "--output", "x.h5")
    assert re.search(r"^stone\[2\] +4\.5 +1 +0 ", said, re.M)
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "x.h5") as file:
        assert file["shapes:radius"][:, 0].tolist() == [0, 0.5, 0.25, 0.125]
        assert file["shapes:of"][:].tolist() == [[0, 2, 0, 2], [1, 1, 0, 0], [2, 1, 0, 0], [3, 1, 0, 0]]
        assert file["shapes:corners"][:2].tolist() == [[9, 0, 0], [-9, 0, 0]]
    assert "x.csv would overwrite" not in said
    assert "would overwrite points or ground stones.csv" in run((tmp_path / "x.scene").read_text(), "--output", "stones.csv", code=2)


def test_a_recording_has_what_python_reads(run, tmp_path):
    run(WORLD, "-n", "400", "--output", "x.csv", "--every", "160", "--contacts", "changes.csv")
    rows = list(csv.DictReader((tmp_path / "x.csv").open(newline="")))
    assert list(rows[0]) == ["step", "time [s]", "object", "x_x [m]", "x_y [m]", "angle [1]", "v_x [m/s]", "v_y [m/s]", "w [1/s]", "at_rest [s]"]
    assert [int(row["step"]) for row in rows[::10]] == [0, 160, 320, 400]
    made, changes = world(), []
    for step in range(401):
        if step:
            made.step(1)
            changes += [(str(step), name, len(made.changes(name))) for name in ("began", "ended", "hit") if len(made.changes(name))]
        mine = [row for row in rows if int(row["step"]) == step]
        if mine:
            wanted = np.column_stack([made.read(name, made.handles) for name in ("x", "angle", "v", "w", "at_rest")])
            assert np.array_equal([[float(value) for value in list(row.values())[3:]] for row in mine], wanted)
    told = list(csv.DictReader((tmp_path / "changes.csv").open(newline="")))
    assert changes and [key for key in dict.fromkeys((row["step"], row["change"]) for row in told)] == [(step, name) for step, name, _ in changes]
    assert len(told) == sum(count for _, _, count in changes)
    assert {row["a"] for row in told} <= {"ground", *(f"brick[{i}]" for i in range(6)), "link[0]", "link[1]", "eye"}


def test_hdf5_has_shapes_joints_and_contacts(run, tmp_path):
    h5py = pytest.importorskip("h5py")
    run(WORLD, "--output", "x.h5", "--times", "0,0.4", "--observe", "x,angle,contacts")
    made = world()
    made.step(20)
    with h5py.File(tmp_path / "x.h5") as file:
        assert np.array_equal(file["angle"][1], made.read("angle", made.handles)) and file["time"][:].tolist() == [0, 0.4]
        assert "v_x" not in file and file["shapes:of"][:, 0].tolist() == [0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9]
        assert file["shapes:of"][-1].tolist() == [9, 1, 1, 1]                                # a sensor
        assert file["joints:of"][:].tolist() == [[0, 7, 1, 2], [7, 8, 0, 2]]
        assert file["joints:anchors"][:].tolist() == [[-5, 5, 0, 0, 0, 0], [0.5, 0, 0, 0, 0, 0]]
        of, points = file["contacts:of"][:], file["contacts:points"][:]
        touching = made.contacts()
        assert len(touching) > 4 and np.array_equal(points[of[:, 0] == 1][:, :2], touching["point"])
        assert np.allclose(points[of[:, 0] == 1][:, 6], touching["impulse"] * 3 / 0.02, rtol=1e-12)
    run(WORLD, "--output", "x.h5", "--group", "link")
    with h5py.File(tmp_path / "x.h5") as file:
        assert file["x_x"].shape == (2, 2) and file["joints:of"][:].tolist() == [[0, 1, 0, 2]]


def test_a_run_that_fails_writes_nothing(run, tmp_path):
    """A motor that is far too strong."""
    text = """steps = 400; bodies = ( { name = "a"; type = "static"; }, { name = "b"; x = [1.0, 0.0]; v = [1e12, 0.0]; gravity = 1e12; shapes = { circle = 1e-6; }; } );
joints = ( { hinge = ["a", "b"]; at = [1e6, 0.0]; speed = 1e9; most = 1e12; } );"""
    said = run(text, "--output", "x.csv", "--contacts", "y.csv", code=3)
    assert re.search(r"^fp3 run: x\.scene: .*finite", said, re.M)
    assert [path.name for path in tmp_path.iterdir()] == ["x.scene"]


def body(text):
    return "bodies = (\n{ name = \"a\"; %s }\n);" % text


def joint(text):
    return 'bodies = ( { name = "a"; shapes = { circle = 1.0; }; }, { name = "b"; type = "static"; }, { name = "c"; count = 3; } );\njoints = (\n{ %s }\n);' % text


def solid(text):
    return joint(text).replace("circle", "sphere")


@pytest.mark.parametrize("text, message", [
    (body("x = 3;"), r"2: x: found '3', expected two numbers"),
    (body('x = ["n", 1];'), r"2: mismatched element type in array, expected \( \) around a list in which numbers and texts are mixed"),
    (body("x = [1.0, 1e13];"), r"2: a: x\[1\] is 1e\+13, expected -1e\+12 to 1e\+12"),
    (body("\nspin_damping = -1.0;"), r"3: a: spin_damping is -1, expected 0 to 1e\+12"),
    (body('count = 3; x = ("i +", 0);'), r'2: x: "i \+": column 4: found end of file, expected a number'),
    (body('count = (2, "j");'), r"2: count: \"j\": found 'j', expected a name of this entry: n, random, i"),
    (body("count = 2.5;"), r"2: count is 2.5, expected a whole number from 0 to 1000000"),
    (body('angle = "1/0";'), r"2: angle: .* \(this is infinite\)"),
    (body('type = "dynamc";'), r"2: type: found 'dynamc', expected \"dynamic\""),
    (body("shape = {};"), r"2: found 'shape', expected a setting of a body: .* \(did you mean 'shapes'\?\)"),
    (body("shapes = {};"), r"2: shape: expected one of circle = RADIUS"),
    (body("shapes = {\nbox = [1.0, 1.0];\nfriction = -1.0; };"), r"4: box: friction is -1, expected 0 to 1e\+06"),
    (body("shapes = { circle = 1.0; radius = 2.0; };"), r"2: radius: a circle has none but circle = RADIUS"),
    (body("shapes = { polygon = ([0.0, 0.0], [1.0, 0.0]); };"), r"2: polygon: a polygon has 3 to 8 points, not 2"),
    (body('shapes = { polygon = { count = 9; at = ("cos(corner)", "sin(corner)"); }; };'), r"2: polygon: found 9 corners, expected at most 8"),
    (body("shapes = { chain = ([0.0, 0.0], [1.0, 0.0]); };"), r"2: chain: a chain is ground"),
    (body("one_of = ();"), r"2: one_of: .* expected a list of shapes"),
    (body('points = "none.csv";'), r"2: none.csv: cannot open"),
    (body("count = 0;"), r"1: bodies: found no body, expected one"),
    ("h = 2.0;\n" + body(""), r"1: h is 2, expected 9.53674e-07 to 1"),
    ("\nsubsteps = 65;\n" + body(""), r"2: substeps: found '65', expected an integer from 1 to 64"),
    ("substeps = 0;" + body(""), r"1: substeps: found '0', expected an integer from 1 to 64"),
    (body("count = (100000, 100000, 100000); x = 3;"), r"2: expected at most 1000000 copies"),
    (joint('rod = ["a", "b"];\naxis = [0.0, 1.0];'), r"4: axis: a rod has none, expected it of slider or wheel"),
    ('engine = "board";' + body(""), r"1: engine: found 'board', expected \"isa\", \"fast\" or \"rtl\""),
    ("step = 3;\n" + body(""), r"1: found 'step', expected a setting of a scene of bodies: .*\(did you mean 'steps'\?\)"),
    ('bodies = ( { name = "a"; },\n{ name = "a"; } );', r"2: name: found 'a' again"),
    (joint(""), r"3: joint: expected rod, hinge"),
    (joint('hinge = ["a", "q"];'), r"3: hinge: found 'q', expected the name of a body"),
    (joint('hinge = ["a", "c"];'), r"3: hinge: there are 3 bodies 'c', expected c\[NUMBER\]"),
    (joint('hinge = ["a", "c[3]"];'), r"3: hinge: found c\[3\], and there are c\[0\] to c\[2\]"),
    (joint('hinge = ["a", "a"];'), r"3: hinge: joins a body with itself"),
    (joint('rod = ["a", "b"]; at = [0.0, 1.0];'), r"3: at: a rod is not at a point"),
    (joint('hinge = ["a", "b"]; limits = [2.0, 1.0];'), r"3: hinge: low, 2, is above high, 1"),
    (joint('count = 2; hinge = ["a", "c[n]"];\nmost = "-n";'), r"4: hinge, copy 1: most is -1, expected 0 to 1e\+12"),
])
def test_a_wrong_scene_is_refused_where_it_is_wrong(run, text, message):
    assert re.search(r"^fp3 run: x\.scene:" + message, run(text, code=2), re.M)


@pytest.mark.parametrize("arguments, message", [
    ("--config many", "--config: .*bodies need no configuration"), ("-e isa --threads 2", "threads is 2, expected 1 with an engine"), ("--check", "--check, --strict: "),
    ("--plot x.svg", "--plot: .*fp3 view draws"), ("--checkpoint-every 5", "expected --checkpoint FILE"), ("--tolerance 1e-3", "--tolerance: only a model"),
    ("-e board --port x", "--port, --baud: "), ("-e nix", "--engine: found 'nix', expected isa, fast or rtl"), ("--visit 2", "--visit: "),
    ("--clock 1MHz", "--clock: "), ("--allow-failures", "--allow-failures: "), ("--group a", "nothing is recorded"),
    ("--output x.csv --group q", "--group: found 'q', expected the name of bodies"), ("--output x.csv --observe xx", r"bodies have no value 'xx' \(did you mean 'x'\?\)"),
    ("--output x.csv --observe contacts", "only HDF5 .* has contacts"), ("--output x.csv --observe x,x_x", "'x_x' is observed twice"),
    ("--output x.csv --times 0.1,0.11", "time 0.11 is no multiple of h"), ("--contacts x.scene", "would overwrite --scene"), ("--native x -e fast", "--native: "),
    ("--set a=1", "values are in the scene"),
])
def test_an_option_that_says_nothing_of_bodies_is_refused(run, tmp_path, arguments, message):
    assert re.search(message, run(body("shapes = { circle = 1.0; };"), *arguments.split(), code=2))
    assert [path.name for path in tmp_path.iterdir()] == ["x.scene"]


def test_other_commands_say_who_takes_bodies(fp3, root, tmp_path):
    (tmp_path / "x.scene").write_text(body(""))
    assert "fp3 run alone takes a scene of bodies" in start(fp3, "tune", "x.scene", "--tolerance", "1e-3", folder=tmp_path, code=2)
    assert "expected --scene x.scene" in start(fp3, "run", "x.scene", folder=tmp_path, code=2)
    assert "--contacts: expected a --scene of bodies" in start(fp3, "run", root / "programs/kepler.ode", "--contacts", "x.csv", folder=tmp_path, code=2)


@pytest.mark.parametrize("name, bodies, joints", [("pyramid", 822, 0), ("car", 24, 23), ("dominoes", 62, 0), ("heap", 62, 1), ("hills", 42, 0)])
def test_the_scenes_of_the_project_run(fp3, root, name, bodies, joints):
    said = start(fp3, "run", "--scene", f"programs/bodies/{name}.scene", "-n", "20", folder=root)
    assert f"bodies           {bodies}, of which" in said and (f"joints           {joints}, of which 0 broke" in said or not joints)


def test_a_joint_at_a_place_of_the_world(run, tmp_path):
    """(1, 2) and (-0.5, 0.25) in the axes of two bodies that are turned."""
    h5py = pytest.importorskip("h5py")
    run("""bodies = ( { name = "a"; x = ["3 - (cos(0.5) - 2*sin(0.5))", "4 - (sin(0.5) + 2*cos(0.5))"]; angle = 0.5; },
{ name = "b"; x = ["3 + 0.5*cos(2) + 0.25*sin(2)", "4 + 0.5*sin(2) - 0.25*cos(2)"]; angle = 2.0; } );
joints = ( { weld = ["a", "b"]; at = [3.0, 4.0]; } );""", "-n", "0", "--output", "x.h5")
    with h5py.File(tmp_path / "x.h5") as file:
        assert np.allclose(file["joints:anchors"][0], [1, 2, 0, -0.5, 0.25, 0], rtol=0, atol=1e-14)


def test_a_recording_says_when_a_joint_broke(run, tmp_path):
    h5py = pytest.importorskip("h5py")
    said = run("""bodies = ( { name = "a"; type = "static"; }, { name = "b"; count = 2; x = ("i", -1); shapes = { circle = 0.3; }; } );
joints = ( { rod = ["a", "b[0]"]; }, { rod = ["a", "b[1]"]; force = 1.0; } );""", "-n", "40", "--every", "10", "--output", "x.h5")
    assert "joints           2, of which 1 broke" in said
    with h5py.File(tmp_path / "x.h5") as file:
        assert file["joints:of"][:].tolist() == [[0, 1, 0, 5], [0, 2, 0, 1]]


SPACE = """dimensions = 3;
steps = 30;
gravity = [0.0, -10.0, 1.0];
bodies = (
    { name = "ground"; type = "static"; shapes = ( { plane = [0.0, 1.0, 0.1]; centre = [0.0, 0.25, 0.0]; friction = 0.3; surface = [0.5, 0.0, 0.0]; },
      { box = [1.0, 2.0, 3.0]; centre = [-4.0, 1.0, 0.0]; q = [1.0, 0.0, 0.5, 0.0]; } ); },
    { name = "thing"; count = [2, 2]; x = ("j", "1 + i", "0.1*n"); q = (1, "i", "j", 0); v = [0.0, 1.0, 0.0]; spin = ("n", 0, 1);
      one_of = ( { box = [0.4, 0.3, 0.2]; radius = 0.05; }, { sphere = 0.4; centre = [0.1, 0.0, 0.0]; }, { capsule = ([-0.2, 0.0, 0.1], [0.2, 0.0, 0.0]); radius = 0.2; },
                 { hull = ([0.5, 0.0, 0.0], [-0.4, 0.4, 0.0], [-0.4, -0.4, 0.0], [0.0, 0.0, 0.6]); density = 2.0; } ); }
);
joints = ( { ball = ["thing[0]", "thing[1]"]; at = [0.5, 1.25, 0.0]; },
           { hinge = ["ground", "thing[3]"]; anchor_a = [1.0, 2.0, 0.5]; axis = [0.0, 0.0, 1.0]; limits = [-1.0, 1.0]; } );
"""


def space():
    made = package.Bodies(dimensions=3, gravity=(0, -10, 1))
    ground = made.add(type="static")
    made.attach(ground, package.plane((0, 1, 0.1), centre=(0, 0.25, 0), friction=0.3, surface=(0.5, 0, 0)))
    made.attach(ground, package.box(1, 2, 3, centre=(-4, 1, 0), q=(1, 0, 0.5, 0)))
    shapes = [package.box(0.4, 0.3, 0.2, radius=0.05), package.sphere(0.4, centre=(0.1, 0, 0)), package.capsule((-0.2, 0, 0.1), (0.2, 0, 0), 0.2),
              package.hull([(0.5, 0, 0), (-0.4, 0.4, 0), (-0.4, -0.4, 0), (0, 0, 0.6)], density=2)]
    things = [made.add(x=(j, 1 + i, 0.1 * (2 * i + j)), q=(1, i, j, 0), v=(0, 1, 0), spin=(2 * i + j, 0, 1)) for i in range(2) for j in range(2)]
    for thing, shape in zip(things, shapes):
        made.attach(thing, shape)
    return made, ground, things


def test_a_scene_in_space_has_the_bits_of_calls(run, tmp_path):
    h5py = pytest.importorskip("h5py")
    said = run(SPACE, "--output", "x.h5", "--every", "30", "--contacts", "x.csv", "--observe", "contacts")
    made, ground, things = space()
    with h5py.File(tmp_path / "x.h5") as file:
        a, b = file["joints:anchors"][0, :3], file["joints:anchors"][0, 3:]
        assert np.allclose(a, [0.5, 0.25, 0], atol=1e-15) and np.allclose(b, [0.1, 0.25, -0.5], atol=1e-15)    # a quarter of a turn about y
        made.join("ball", things[0], things[1], anchor_a=a, anchor_b=b)
        made.join("hinge", ground, things[3], anchor_a=(1, 2, 0.5), anchor_b=(0, 0, 0), axis=(0, 0, 1), limits=(-1, 1))
        made.step(30)
        assert hash_of(said) == f"{made.hash:016x}"
        for name in ("x", "q", "v", "spin"):
            assert np.array_equal(np.stack([file[f"{name}_{k}"][1] for k in ("wxyz" if name == "q" else "xyz")], axis=1), made.read(name, made.handles))
        assert file["shapes:of"][:].tolist() == [[0, 2, 0, 2], [0, 8, 0, 2], [1, 8, 0, 0], [2, 1, 0, 0], [3, 2, 0, 0], [4, 4, 0, 0]]
        corners, triangles, above = file["shapes:corners"][:], file["shapes:triangles"][:], np.array([0, 1, 0.1]) / np.hypot(1, 0.1)
        assert np.isinf(file["shapes:radius"][:, 0]).tolist() == [True] + 5 * [False] and corners[18].tolist() == [np.float32(0.1), 0, 0]
        assert np.allclose([corners[1] - corners[0], corners[0]], [above, 0.25 * above[1] * above], atol=1e-6)       # a plane: a point of it, and one above
        whose = np.digitize(triangles, [2, 10, 18, 19, 21])
        assert (whose == whose[:, :1]).all() and np.bincount(whose[:, 0]).tolist() == [0, 12, 12, 0, 0, 4]
        for shape, volume in ((1, 48), (2, 0.192), (5, 0.9 * 0.8 / 2 * 0.6 / 3)):       # above 0: anticlockwise as seen from outside
            assert np.linalg.det(corners[triangles[whose[:, 0] == shape]]).sum() / 6 == pytest.approx(volume, rel=1e-6)
        assert len(file["contacts:of"]) > 0
        assert np.array_equal(file["contacts:points"][:, 3:6][file["contacts:of"][:, 0] == 1], made.contacts()["normal"])
    assert hash_of(run(SPACE, "-n", "4", "-e", "isa")) == hash_of(run(SPACE, "-n", "4"))


@pytest.mark.parametrize("text, message", [
    ("dimensions = 4;" + body(""), r"1: dimensions: found '4', expected 2, a plane, or 3, space"),
    ("dimensions = 3;" + body("x = [0, 1];"), r"2: x: found a list \[ \] of 2, expected three numbers"),
    ("dimensions = 3;" + solid('weld = ["a", "b"];\nrest = 0.5;'), r"4: weld: rest is 0.5, and a weld in space has none"),
    ("dimensions = 3;" + solid('ball = ["a", "b"];\nrest = 0;'), r"4: ball: rest is 0, and a ball in space has none"),
    ("dimensions = 3;" + solid('ball = ["a", "b"];\nlimits = [-1, 1];'), r"4: ball: limits of a ball are -1 and 1, expected 0 and an angle from 0 to pi"),
    ("dimensions = 3;" + solid('weld = ["a", "b"];\naxis = [0, 1, 0];'), r"4: axis: a weld has none, expected it of hinge, slider, wheel or ball"),
    ("dimensions = 3;" + solid('rod = ["a", "b"];\naxis = [0, 1, 0];'), r"4: axis: a rod has none"),
    ("dimensions = 3;" + solid('ball = ["a", "b"];\naxle = [0, 1, 0];'), r"4: axle: a ball has none, expected it of wheel"),
    ("dimensions = 3;" + solid('slider = ["a", "b"];\naxle = [0, 1, 0];'), r"4: axle: a slider has none"),
    ("dimensions = 3;" + body("angle = 1;"), r"2: angle: a plane alone has it, and the scene has dimensions = 3"),
    ("dimensions = 3;" + body("shapes = { circle = 1; };"), r"2: circle: a plane alone has it"),
    ("dimensions = 3;" + body("q = [1, 0, 0];"), r"2: q: .* expected four numbers"),
    ("dimensions = 3;" + body("q = [0, 0, 0, 0];"), r"2: a: the length of q is 0"),
    ("dimensions = 3;" + solid('gear = ["a", "b"];'), r"3: gear: a plane alone has it"),
    (body("shapes = { sphere = 1; };"), r"2: sphere: space alone has it, and the scene has dimensions = 2"),
    (body("spin = [0, 1];"), r"2: spin: space alone has it"),
    (joint('ball = ["a", "b"];'), r"3: ball: space alone has it"),
])
def test_what_a_plane_or_space_has_not_is_refused(run, text, message):
    assert re.search(r"^fp3 run: x\.scene:" + message, run(text, code=2), re.M)


# ---- meshes and heights ----

GROUND = """dimensions = 3; steps = 30;
bodies = ( { name = "ground"; type = "static"; shapes = ( %s ); }, { x = [0.5, 1.4, 0.9]; shapes = { box = [0.2, 0.3, 0.2]; }; } );
"""
POINTS = [(-3, 0, -3), (3, 0, -3), (3, 0.5, 3), (-3, 0.5, 3)]
OBJ = """# from a modeller
mtllib x.mtl
o slope
v -3 0 -3
v 3.0 0 -3 1.0
v 3e0 0.5 3
  v -3 0.5 3
vt 0 0
vn 0 1 0
usemtl grey
s off
f 4/1/1 3//1 -3 1/1
"""


def test_a_mesh_has_the_bits_of_calls(run, tmp_path):
    """In the scene, with a file of points, and from a file of a modeller, whose face of four corners is two triangles; recordings have them."""
    def wanted(triangles):
        made = package.Bodies(dimensions=3)
        made.mesh(made.add(type="static"), POINTS, triangles, friction=0.3)
        made.attach(made.add(x=(0.5, 1.4, 0.9)), package.box(0.2, 0.3, 0.2))
        made.step(30)
        assert len(made.contacts())
        return f"{made.hash:016x}"
    text = "{ mesh = { points = %s; triangles = ([3, 2, 1], (3, \"2 - 1\", 0)); }; friction = 0.3; }"
    assert hash_of(run(GROUND % (text % "([-3, 0, -3], [3, 0, -3], (3, 0.5, \"6/2\"), [-3, 0.5, 3])"))) == wanted([(3, 2, 1), (3, 1, 0)])
    (tmp_path / "p.csv").write_text("x,y,z\n" + "".join(f"{x},{y},{z}\n" for x, y, z in POINTS))
    assert hash_of(run(GROUND % (text % '"p.csv"'))) == wanted([(3, 2, 1), (3, 1, 0)])
    (tmp_path / "hill.obj").write_text(OBJ)
    assert hash_of(run(GROUND % '{ mesh = "hill.obj"; friction = 0.3; }', "--output", "x.h5")) == wanted([(3, 2, 1), (3, 1, 0)])
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "x.h5") as file:
        assert file["shapes:triangles"][:2].tolist() == [[3, 2, 1], [3, 1, 0]] and file["shapes:corners"][:4].tolist() == [list(p) for p in POINTS]
    assert "would overwrite points or ground hill.obj" in run((tmp_path / "x.scene").read_text(), "--output", "hill.obj", code=2)


def test_heights_have_the_bits_of_calls(run, tmp_path):
    """Rows in the scene, a formula, and a file without a head."""
    made = package.Bodies(dimensions=3, gravity=(0, 0, -10))
    made.heights(made.add(type="static"), 0.75, 1.0, [[0.5, 0.25 * j, 0] for j in range(4)])
    made.attach(made.add(x=(0.5, 1.4, 0.9)), package.box(0.2, 0.3, 0.2))
    made.step(30)
    assert len(made.contacts())
    text = "gravity = [0, 0, -10]; " + GROUND % "{ heights = %s; spacing = [0.75, 1]; }"
    (tmp_path / "hill.csv").write_text("# heights\n0.5, 0, 0\n0.5,0.25,0\n\n0.5,0.5,0\n0.5,0.75,0\n")
    for heights in ("([0.5, 0, 0], (0.5, \"1/4\", 0), [0.5, 0.5, 0], [0.5, 0.75, 0])", '"hill.csv"',
                    '{ count = [3, 4]; at = "(column - 1)*(column - 2)/4 + 0.25*row*column*(2 - column)"; }'):
        assert hash_of(run(text % heights)) == f"{made.hash:016x}", heights


@pytest.mark.parametrize("lines, message", [
    ("v 1 2\n", r"hill\.obj:1:6: found .*, expected three numbers of a point"),
    ("v 1 2 x\n", r"hill\.obj:1:7: found 'x', expected a number"),
    ("v 1 2 inf\n", r"hill\.obj:1:7: found 'inf', expected a finite number"),
    ("v 0 0 0\nf 1 1 \\\n 1\n", r"hill\.obj:2:7: found '\\', expected all of a statement in one line"), ("\nw 1\n", r"hill\.obj:2:1: found 'w', expected v, f, or another word"),
    ("v 0 0 0\nv 1 0 0\nf 1 2\n", r"hill\.obj:3:6: found .*, expected three corners of a face, or more"),
    ("v 0 0 0\nv 1 0 0\nf 1 2 3/2\n", r"hill\.obj:3:7: found '3', expected the number of a point above"),
    ("v 0 0 0\nv 1 0 0\nf 1 2 0\n", r"hill\.obj:3:7: found '0'"), ("v 0 0 0\nf -1 -2 1\n", r"hill\.obj:2:6: found '-2'"), ("f 1.5 1 1\n", r"hill\.obj:1:3: found '1.5'"),
    ("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", r"mesh: triangle 0 has its corners on a line"), ("v 0 0 0\n", r"mesh: a mesh needs from 1 to"), ("f /1 2 3\n", r"hill\.obj:1:3: found nothing, expected a number")])
def test_a_wrong_file_of_a_modeller_is_refused_where_it_is_wrong(run, tmp_path, lines, message):
    (tmp_path / "hill.obj").write_text(lines)
    said = run(GROUND % '{ mesh = "hill.obj"; }', code=2).replace("error: ", "")
    assert re.search(r"^fp3 run: x\.scene:2: " + message, said, re.M)


@pytest.mark.parametrize("shape, message", [
    ("{ mesh = 3; }", r"2: mesh: found '3', expected a file of Wavefront's format"), ('{ mesh = "none.obj"; }', r"2: none\.obj: "),
    ("{ mesh = { points = ([0, 0, 0]); }; }", "2: mesh: expected points = "), ("{ mesh = { points = ([0, 0, 0]); triangles = ([0, 1, 2.5]); }; }", "2: triangles: found 2.5, expected"),
    ("{ mesh = { points = ([0, 0, 0]); triangles = ([0, 1, 2]); }; }", "2: mesh: triangle 0 has corner 1 of 1 points"),
    ("{ mesh = { points = ([0, 0]); triangles = (); }; }", "2: points: .* expected three numbers"), ("{ mesh = { points = ([0, 0, 0]); triangles = (); }; }", "2: mesh: a mesh needs from 1"),
    ("{ mesh = { points = ([0, 0, 0]); triangle = (); }; }", r"2: found 'triangle', .*\(did you mean 'triangles'\?\)"), ("{ mesh = 3; radius = 1; }", "2: radius: a mesh has none"),
    ("{ mesh = 3; spacing = [1, 1]; }", "2: spacing: a mesh has none"), ("{ heights = 3; }", "2: heights: found '3', expected rows of numbers"),
    ("{ heights = ([0, 1], [0]); }", "2: heights: expected rows of as many numbers"), ("{ heights = ([0, 1], [0, 1e7]); }", "2: heights: a mesh's points must be finite and at most 1e6"),
    ("{ heights = ([0, 1]); }", "2: heights: heights need from 2"), ("{ heights = ([0, 1], [0, 1]); spacing = [1, 0]; }", "2: heights: .*spacings above 0"),
    ('{ heights = { count = [2, 1]; at = 0; }; }', "2: count: found 2 and 1, expected two whole numbers"), ('{ heights = { count = [10000, 10000]; at = 0; }; }', "2: count: .* at most 1000000 heights"),
    ('{ heights = { count = [2, 2]; at = "i"; }; }', r"2: at: \"i\": found 'i', expected a name of this entry: n, random, column, row"),
    ('{ heights = { count = [2, 2]; }; }', "2: heights: expected count = "), ('{ heights = "bad.csv"; }', r"2: bad\.csv:2: found 3 heights, expected 2"),
    ('{ heights = "text.csv"; }', r"2: text\.csv:1:3: found 'x', expected a number"),
    ('{ heights = "nan.csv"; }', r"2: nan\.csv:2:3: found 'nan', expected a height from -1e6 to 1e6"), ('{ heights = "far.csv"; }', r"2: far\.csv:2:1: found '-1000001', expected a height")])
def test_wrong_ground_is_refused_where_it_is_wrong(run, tmp_path, shape, message):
    (tmp_path / "bad.csv").write_text("1,2\n3,4,5\n")
    (tmp_path / "text.csv").write_text("1,x\n")
    (tmp_path / "nan.csv").write_text("1,2\n3,nan\n")
    (tmp_path / "far.csv").write_text("1e6,-1000000\n-1000001,0\n")
    assert re.search(r"^fp3 run: x\.scene:" + message, run(GROUND % shape, code=2).replace("error: ", ""), re.M)


def test_ground_has_a_body_that_does_not_move_and_is_in_space(run):
    assert "mesh: triangles and heights are ground" in run((GROUND % "{ mesh = { points = ([0, 0, 0], [1, 0, 0], [0, 1, 0]); triangles = ([0, 1, 2]); }; }").replace("static", "dynamic"), code=2)
    assert "2: heights: space alone has it" in run("dimensions = 2;\nbodies = ( { shapes = { heights = 3; }; } );", code=2)


# ---- checkpoints ----

def test_a_run_goes_on_from_its_checkpoint(run, tmp_path):
    """In a plane and in space, from either file, on another engine: the same bits, the same chain, and recordings that meet."""
    pytest.importorskip("h5py")
    for text in (WORLD, SPACE):
        whole = run(text, "-n", "40", "--checkpoint", "x.ck", "--checkpoint-every", "15")
        chain = whole.split()[-1]
        assert len(chain) == 64 and hash_of(whole) == hash_of(run(text, "-n", "40"))
        for engine in ([], ["-e", "isa"])[:1 if text is SPACE else 2]:
            (tmp_path / "y.ck").write_bytes((tmp_path / "x.ck.1").read_bytes())
            again = run(text, "-n", "40", "--restart", "y.ck", "--checkpoint", "y.ck", *engine)
            assert hash_of(again) == hash_of(whole) and again.split()[-1] == chain and "40 of 0.0" in again and ", from step 30 on" in again
        run(text, "-n", "40", "--every", "10", "--output", "whole.csv", "--contacts", "whole_changes.csv")
        run(text, "-n", "40", "--every", "10", "--output", "rest.csv", "--contacts", "changes.csv", "--restart", "y.ck.1")
        for name in ("%s.csv", "%s_changes.csv"):
            rows = (tmp_path / (name % "whole")).read_text().splitlines()
            rest = (tmp_path / (name % "rest" if name == "%s.csv" else "changes.csv")).read_text().splitlines()
            assert rest == rows[:1] + [row for row in rows[1:] if int(row.split(",")[0]) >= 30 + ("changes" in name)]
        assert hash_of(run(text, "-n", "40", "--restart", "x.ck")) == hash_of(whole)


def test_a_joint_that_broke_stays_broken(run):
    text = SPACE.replace("limits = [-1.0, 1.0];", "limits = [-1.0, 1.0]; force = 1e-3;")
    assert "of which 1 broke" in run(text, "-n", "20", "--checkpoint", "x.ck")
    assert "of which 1 broke" in run(text, "-n", "30", "--restart", "x.ck")


@pytest.mark.parametrize("old, new, arguments, message", [
    ("h = 0.02", "h = 0.01", "", r"x\.ck: of another run: its h is 0\.02, and that of the scene is 0\.01"),
    ("substeps = 3", "substeps = 4", "", "its substeps is 3, and that of the scene is 4"), ("0.5, -10.0]", "0.5, -9.0]", "", "its gravity is -10, and that of the scene is -9"),
    ("x = [1.0, 1.0]", "x = [1.0, 1.5]", "", "the scene makes other bodies now"), ("circle = 0.5; is_sensor", "circle = 0.25; is_sensor", "", "the scene makes other shapes now"),
    ("hertz = 3.0", "hertz = 4.0", "", "the scene makes other joints now"), ("steps = 40", "steps = 10", "", "x.ck: after 20 steps, and the whole run has 10"),
    ("", "", "--checkpoint x.scene", "would overwrite"), ("", "", "--checkpoint none/x.ck", "none/x.ck")])
def test_a_checkpoint_of_another_run_is_refused(run, old, new, arguments, message):
    pytest.importorskip("h5py")
    run(WORLD, "-n", "20", "--checkpoint", "x.ck")
    assert re.search(message, run(WORLD.replace(old, new, 1), "--restart", "x.ck", *arguments.split(), code=2))


def test_checkpoints_of_bodies_of_programs_and_of_others_are_not_mixed_up(run, fp3, root, tmp_path):
    pytest.importorskip("h5py")
    assert "x.scene: no checkpoint" in run(WORLD, "--restart", "x.scene", code=2)
    world().checkpoint(tmp_path / "own.ck")
    assert "own.ck: a world that a program has written" in run(WORLD, "--restart", "own.ck", code=2)
    assert "has no command of its run: another program made the file" in start(fp3, "verify", "own.ck", folder=tmp_path, code=2)
    run(WORLD, "--checkpoint", "x.ck")
    assert package.Bodies.restart(tmp_path / "x.ck").time == 40 * 0.02
    assert "x.ck: a checkpoint of rigid bodies" in start(fp3, "run", root / "programs/kepler.ode", "-n", "50", "--restart", "x.ck", folder=tmp_path, code=2)
    start(fp3, "run", root / "programs/kepler.ode", "-n", "5", "--checkpoint", "k.ck", folder=tmp_path)
    assert "k.ck: a checkpoint, but not one of bodies" in run(WORLD, "--restart", "k.ck", code=2)


def test_verify_runs_bodies_again(run, fp3, tmp_path):
    """A checkpoint from the one before, a recording from the start or a checkpoint; another state, scene or file is found."""
    h5py = pytest.importorskip("h5py")
    run(WORLD, "--checkpoint", "x.ck", "--checkpoint-every", "25", "--output", "x.h5", "--every", "10")
    assert "x.ck: the hash of step 40 agrees, run again from step 25" in start(fp3, "verify", "x.ck", folder=tmp_path)
    assert "agrees, run again from step 25" in start(fp3, "verify", "x.ck", "-e", "fast", folder=tmp_path)
    assert "agrees, run again from step 0" in start(fp3, "verify", "x.ck", "--from", "30", folder=tmp_path)
    assert "x.h5: 5 hashes of steps 0 to 40 agree" in start(fp3, "verify", "x.h5", folder=tmp_path)
    assert "2 hashes of steps 30 to 40 agree, run again from step 25" in start(fp3, "verify", "x.h5", "--from", "30", "--restart", "x.ck.1", folder=tmp_path)
    with h5py.File(tmp_path / "x.h5", "r+") as file:
        file["hash:chain"][3, 0] ^= 1
    assert "after 30 steps" in start(fp3, "verify", "x.h5", folder=tmp_path, code=1)
    (tmp_path / "x.scene").write_text(WORLD.replace("friction = 0.9", "friction = 0.8"))
    assert "the scene makes other shapes now" in start(fp3, "verify", "x.ck", folder=tmp_path, code=2)
    assert "x.ck" in start(fp3, "verify", "x.ck", "--from", "30", folder=tmp_path, code=1)
