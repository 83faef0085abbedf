"""Objects that are born and gone: in scenes, in outputs, when they fail; bad lifetimes and their messages."""

import csv
import io
import os
import re
import shutil
import subprocess

import h5py
import pytest

H = 0.0078125
ENGINES = ("isa", "fast", "rtl")
DECAY = "param a = 1 [1/s]\nstate x = 1\nstate y = 0 [s]\nx' = -a*x\ny' = x\nstep 0.125 [s]\n"
# x becomes a times x; t is no state.
GROWS = ".state x\n.param a\nstep: mul x, x, a\n"


@pytest.fixture
def run(fp3, tmp_path):
    def start(*arguments, code=0):
        done = subprocess.run([fp3, "run", *map(str, arguments)], cwd=tmp_path, capture_output=True, text=True, timeout=300,
                              env={**os.environ, "FP3_CACHE_DIR": str(tmp_path / "cache")})
        assert done.returncode == code, done.stdout + done.stderr
        return done

    return start


@pytest.fixture
def scene(run, tmp_path):
    def start(text, *arguments, code=0):
        (tmp_path / "x.scene").write_text(text)
        return run("--scene", "x.scene", *arguments, code=code)

    return start


def group(program, objects, rest=""):
    return f'{{ program = "{program}"; objects = {objects}; {rest} }}'


def file(config, steps, *groups):
    return f'config = "{config}"; steps = {steps};\ngroups = (\n' + ",\n".join(groups) + ");\n"


def states(text):
    found = {}
    for name, bits, number in re.findall(r"^(\w+) +\S+ +(0x\w{8})   object (\d+)$", text, re.M):
        found.setdefault(int(number), {})[name] = bits
    return [found[number] for number in range(len(found))]


@pytest.mark.parametrize("seed", [1])
def test_objects_hold_what_they_hold_alone(root, build, tmp_path, seed):
    done = subprocess.run([build / "tests/lives", str(seed), root / "programs"], capture_output=True, text=True, timeout=300,
                          env={**os.environ, "FP3_CACHE_DIR": str(tmp_path)})
    assert done.returncode == 0, f"{done.stdout}{done.stderr}\nrepeat with: build/tests/lives {seed} programs"


def test_a_spread_of_births_and_of_values(run, scene, tmp_path):
    (tmp_path / "decay.ode").write_text(DECAY)
    born, gone = [0, 3, 6, 9, 12], [4, 6, 9, 11, 14]   # 4 + 10 i / 4, rounded down
    text = file("many_full", 12, group("decay.ode", 5, "spread = { a = [1.0, 2.0]; }; born = [0, 12]; gone = [4, 14];"))
    expected = [states(run("decay.ode", "-c", "many_full", "-e", "isa", "-N", 5, "--spread", "a=1:2", "-n", max(0, min(g, 12) - b),
                           "--all").stdout)[i] for i, (b, g) in enumerate(zip(born, gone))]
    for engine in ENGINES:
        out = scene(text, "-e", engine).stdout
        assert states(out) == expected
        assert re.search("^alive +(.*)$", out, re.M)[1] == "1 of 5, 0 not born yet, 4 gone"
        assert re.findall("^object_steps +(.*)$", out, re.M) == ["12", "12"]
    # Falling, as well; one object has the first.
    out = scene(file("many_full", 9, group("decay.ode", 3, "born = [8, 0]; gone = 0x9;"), ), "-e", "isa").stdout
    assert re.findall("^object_steps +(.*)$", out, re.M) == ["15", "15"]
    out = scene(file("single_full", 9, group("decay.ode", 1, "born = [8, 0];")), "-e", "isa").stdout
    assert re.findall("^object_steps +(.*)$", out, re.M) == ["1", "1"]


def test_groups_have_lifetimes_of_their_own(run, scene, tmp_path):
    (tmp_path / "decay.ode").write_text(DECAY)
    (tmp_path / "other.ode").write_text(DECAY.replace("-a*x", "-2*a*x"))
    first, last = group("decay.ode", 3, "born = 5;"), group("other.ode", 4, "gone = 7;")
    for engine in ENGINES:
        out = scene(file("array", 10, first, last), "-e", engine, "--all").stdout
        assert re.findall("^object_steps +(.*)$", out, re.M) == ["15", "28", "43"]
        expected = [state for name, objects, steps in (("decay.ode", 3, 5), ("other.ode", 4, 7)) for state in
                    states(run(name, "-c", "array", "-e", "isa", "-N", objects, "-n", steps).stdout)]
        assert states(out) == expected


def test_who_does_not_live_costs_no_cycles(scene, tmp_path):
    (tmp_path / "decay.ode").write_text(DECAY)

    def cycles(rest, objects=240):
        out = scene(file("many_full", 20, group("decay.ode", objects, rest)), "-e", "rtl").stdout
        return int(re.search("^cycles +(.*)$", out, re.M)[1])

    full, none = cycles(""), cycles("born = 21;")
    assert none == 0
    assert cycles("born = 20;") == 0 and cycles("gone = 60;") == full
    # Half the time; births in all steps, each of which ends a visit of those who live.
    assert 0.49 * full < cycles("born = 10;") < 0.52 * full
    assert 0.49 * full < cycles("born = [0, 21];") < 0.7 * full


def test_outputs_tell_who_lives(scene, tmp_path):
    (tmp_path / "decay.ode").write_text(DECAY)
    text = file("many_full", 12, group("decay.ode", 3, "born = [0, 8]; gone = [6, 20];"))   # 0 to 6, 4 to 13, 8 to 20
    whole = states(scene(text).stdout)
    for engine in ENGINES:
        done = scene(text, "-e", engine, "--every", 2, "--output", "x.csv")
        assert states(done.stdout) == whole and re.findall("^object_steps +(.*)$", done.stdout, re.M) == ["18", "18"]
        rows = list(csv.DictReader(io.StringIO((tmp_path / "x.csv").read_text())))
        assert list(rows[0]) == ["step", "time [s]", "object", "x", "y [s]", "life"]
        for object_, (born, gone) in enumerate(((0, 6), (4, 13), (8, 20))):
            mine = [row for row in rows if int(row["object"]) == object_]
            assert [int(row["life"]) for row in mine] == [0 if n < born else 1 if n < gone else 2 for n in range(0, 13, 2)]
            assert all(row["x"] == "1" for row in mine if int(row["step"]) <= born)
            assert len({row["x"] for row in mine if born <= int(row["step"]) <= gone}) == len(range(born, min(gone, 12) + 1, 2))
        done = scene(text, "-e", engine, "--times", "0.25,1", "--observe", "y", "--output", "-")
        assert re.findall(r"^\d+,[0-9.]+,1,\S+,(\d)\r?$", done.stdout, re.M) == ["0", "1"]


def test_hdf5_tells_who_lives(scene, tmp_path):
    (tmp_path / "decay.ode").write_text(DECAY)
    scene(file("many_full", 4, group("decay.ode", 2, "born = [0, 2]; gone = 3;")), "--every", 1, "--output", "x.h5")
    with h5py.File(tmp_path / "x.h5") as of:
        assert of["life"][:].tolist() == [[1, 0], [1, 0], [1, 1], [2, 2], [2, 2]] and of["life"].dtype == "uint32"
        assert "alive" in of["life"].attrs["description"]


def test_pictures_tell_who_lives(scene, tmp_path):
    if not shutil.which("gnuplot"):
        pytest.skip("needs gnuplot: make setup")
    (tmp_path / "decay.ode").write_text(DECAY)
    scene(file("many_full", 4, group("decay.ode", 1, "born = 2;")), "--every", 1, "--plot", "x.svg")
    text = re.sub("<[^>]*>", "", (tmp_path / "x.svg").read_text())
    assert "life" in text and "phase plane" in text


def test_failures_are_told_by_their_steps(scene, tmp_path):
    (tmp_path / "grows.s").write_text(GROWS)
    values = "set = { a = 1048576.0; x = 1.0; };"   # 2^120 after 6 steps
    text = file("many_full", 30, group("grows.s", 6, values + " born = [11, 1]; gone = [18, 8];"))
    for engine in ENGINES:
        done = scene(text, "-e", engine, code=3)
        assert re.search("^failed +(.*)$", done.stdout, re.M)[1] == "6 of 6, first object 5 in step 8: overflow", engine
        # Gone before it happens.
        scene(text.replace("gone = [18, 8]", "gone = [17, 7]"), "-e", engine)
        # In a recording, too; of the first object alone.
        done = scene(text.replace("gone = [18, 8]", "gone = [18, 7]"), "-e", engine, "--every", 4, "--output", "x.csv", code=3)
        assert "1 of 6, first object 0 in step 18: overflow" in done.stdout, engine


def test_a_program_that_sleeps(root, scene, tmp_path):
    values = "set = { C = 4.1e4; rm = 1.2e-6; T = 2.9e5; v = 0.0; s = 0.0; slept = 0.0; eps = 1e9; h = 0.5; };"
    text = file("many_full", 9, group(root / "programs/ship_sleep.s", 4, values + "born = [0, 9]; gone = 20;"))
    for engine in ENGINES:
        out = scene(text, "-e", engine).stdout
        assert re.search("^asleep +(.*)$", out, re.M)[1] == "3 of 4, since steps 1 to 7", engine


def test_time_begins_at_birth(scene, tmp_path):
    (tmp_path / "clock.ode").write_text("state x = 0 [s^2]\nx' = t\nstep 1 [s]\n")
    text = file("many_full", 10, group("clock.ode", 3, "born = [0, 8];"))
    for engine in ENGINES:
        assert [s["steps"] for s in states(scene(text, "-e", engine).stdout)] == ["0x41200000", "0x40c00000", "0x40000000"]
        # To 2^24 and no further, counted by the steps that each makes.
        begin = "set = { steps = 16777209; };"
        scene(text.replace("born = [0, 8];", begin + "born = [3, 8];"), "-e", engine)
        done = scene(text.replace("born = [0, 8];", begin + "born = [2, 8];"), "-e", engine, code=2)
        assert "8 steps from 'steps' = 16777209 on" in done.stderr, engine


BAD = [
    ("born = 1; gone = 1;", r"x\.scene:3: gone: object 0 of this group is gone after step 1, expected a step after its birth, 1"),
    ("gone = 0;", r"x\.scene:3: gone: object 0 of this group is gone after step 0, expected a step after its birth, 0"),
    ("born = [0, 9]; gone = 5;", r"x\.scene:3: gone: object 2 of this group is gone after step 5, expected a step after its birth, 6"),
    ("born = -1;", r"x\.scene:3: born: found '-1', expected an integer from 0 to 4294967295"),
    ("gone = 4294967296;", r"x\.scene:3: gone: found '4294967296', expected an integer from 0 to 4294967295"),
    ("gone = 1e3;", r"x\.scene:3: gone: found '1e3', expected an integer"),
    ("\nborn = 0.5;", r"x\.scene:4: born: found '0\.5', expected an integer"),
    ("\nborn = [1];", r"x\.scene:4: born: found a list \[ \] of 1, expected a step, or two: \[FIRST, LAST\]"),
    ("born = [1, 2, 3];", r"x\.scene:3: born: .*expected a step, or two"),
    ("born = [];", r"x\.scene:3: born: .*expected a step, or two"),
    ("born = [1, -2];", r"x\.scene:3: born: found '-2'"),
    ('born = "1";', r"x\.scene:3: born: found '1', expected an integer|x\.scene:3: born: found .*expected an integer"),
    ("bron = 1;", r"x\.scene:3: found 'bron'.*did you mean 'born'"),
]


@pytest.mark.parametrize("rest,message", BAD)
def test_bad_lifetimes(scene, tmp_path, rest, message):
    (tmp_path / "decay.ode").write_text(DECAY)
    done = scene(file("many_full", 4, group("decay.ode", 4, rest)), code=2)
    assert re.search(message, done.stderr), done.stderr
    assert not done.stdout


def test_where_lifetimes_cannot_be(root, scene, tmp_path):
    (tmp_path / "decay.ode").write_text(DECAY)
    done = scene(file("lanes", 4, group(root / "programs/ship.s", 4, f'params = "{root}/programs/ship.cfg";\nborn = 2;')), code=2)
    assert "x.scene:4: born, gone: configuration 'lanes' has no sleep: all its objects make all steps" in done.stderr
    done = scene(file("many_full", 4, group("decay.ode", 4, "born = 2;")), "--cycle-limit", 99, code=2)
    assert "births and ends of objects split the run" in done.stderr
    scene(file("many_full", 4, group("decay.ode", 4, "born = 4;")), "--cycle-limit", 10**9)
    # A last part that does more than complete values.
    (tmp_path / "adds.s").write_text(".state x\nstep: add x, x, 1.0\nlast: add x, x, 1.0\n")
    done = scene(file("many_full", 4, group("adds.s", 4, "set = { x = 0.0; }; born = 2;")), code=2)
    assert re.search(r"x\.scene:3: a run of this program cannot be split by births and ends of objects: after 4 steps 'x'", done.stderr)
    # A state of that name.
    (tmp_path / "named.ode").write_text("param a = 1 [1/s]\nstate life = 1\nlife' = -a*life\nstep 0.125 [s]\n")
    named = file("many_full", 4, group("named.ode", 4, "born = 2;"))
    assert "'life' cannot be observed" in scene(named, "--output", "x.csv", code=2).stderr and not (tmp_path / "x.csv").exists()
    scene(named.replace("born = 2;", ""), "--output", "x.csv")
    # Several groups have columns of their own.
    text = file("array", 4, group("decay.ode", 4), group("decay.ode", 3))
    done = scene(text, "--output", "y.csv", code=2)
    assert "x.scene:2: --output, --plot: the scene has 2 groups, and a recording" in done.stderr and not (tmp_path / "y.csv").exists()
