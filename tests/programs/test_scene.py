"""`fp3 run --scene`: each group as its program alone, what is printed, and each kind of bad file."""

import re
import shutil
import subprocess

import pytest

VALUES = {"T": 2.9e5, "C": 4.1e4, "rm": 1.2e-6, "v": 0.5, "s": 3.0}
H = 0.0078125


@pytest.fixture
def folder(root, tmp_path):
    """A folder with programs and parameters, to write scenes into."""
    for name in ("ship.s", "ship_madd.s", "ship_scale.s", "ship_sleep.s", "ship.cfg"):
        shutil.copy(root / "programs" / name, tmp_path)
    return tmp_path


@pytest.fixture
def run(fp3, folder):
    def start(*arguments, cwd=folder):
        done = subprocess.run([fp3, "run", *arguments], cwd=cwd, capture_output=True, text=True, timeout=300)
        assert done.returncode in (0, 1, 2), done.stderr
        return done

    return start


@pytest.fixture
def scene(run, folder):
    def start(text, *arguments):
        (folder / "x.scene").write_text(text)
        return run("--scene", "x.scene", *arguments)

    return start


def group(program, objects, **values):
    pairs = " ".join(f"{name} = {float(value)};" for name, value in {**VALUES, **values}.items())
    return f'{{ program = "{program}"; objects = {objects}; set = {{ {pairs} }}; }}'


def file(config, groups, steps=9, **settings):
    lines = [f'config = "{config}"; steps = {steps}; h = {H};', *(f"{key} = {value};" for key, value in settings.items())]
    return "\n".join([*lines, "groups = (", ",\n".join(groups), ");"])


def states(text):
    """Of each object its states, in the order of the objects."""
    found = {}
    for name, bits, number in re.findall(r"^(\w+) +\S+ +(0x\w{8})   object (\d+)$", text, re.M):
        found.setdefault(int(number), {})[name] = bits
    return [found[number] for number in range(len(found))]


def alone(run, fp3, folder, program, objects, config, steps, **values):
    subprocess.run([fp3, "asm", folder / program, "-o", folder / "alone.fp3"], check=True)
    sets = [f"--set={name}={value}" for name, value in {**VALUES, "h": H, **values}.items()]
    done = run("alone.fp3", "--engine", "isa", "--config", config, "--objects", str(objects), "--steps", str(steps),
               "--all", *sets)
    assert done.returncode == 0, done.stderr
    return states(done.stdout)


@pytest.mark.parametrize("config,groups,visit", [
    ("array", [("ship.s", 50, {}), ("ship_madd.s", 7, {"T": 1e5})], 0),
    ("array", [("ship.s", 3, {}), ("ship_madd.s", 60, {"v": -2}), ("ship.s", 31, {"C": 0})], 4),
    ("array", [("ship.s", 1, {}), ("ship.s", 1, {"T": 1}), ("ship.s", 1, {"T": 2}), ("ship_madd.s", 1, {})], 0),
    ("shared", [("ship_scale.s", 30, {}), ("ship_madd.s", 45, {"s": -0.0})], 2),
    ("shared", [("ship.s", 5, {})], 3),
])
def test_each_group_is_what_it_is_alone(run, scene, fp3, folder, config, groups, visit):
    text = file(config, [group(program, objects, **values) for program, objects, values in groups],
                **({"visit": visit} if visit else {}))
    expected = [state for program, objects, values in groups
                for state in alone(run, fp3, folder, program, objects, config, 9, **values)]
    for engine in ("rtl", "isa"):
        done = scene(text, "--all", "--engine", engine)
        assert done.returncode == 0, done.stderr
        assert states(done.stdout) == expected
        steps = [int(n) for n in re.findall(r"^object_steps +(\d+)$", done.stdout, re.M)]
        assert steps == [9 * objects for _, objects, _ in groups] + [9 * len(expected)]


@pytest.mark.smoke
def test_what_is_printed(scene):
    done = scene(file("array", [group("ship.s", 100), group("ship_madd.s", 60)]))
    assert done.returncode == 0, done.stderr
    out = done.stdout
    assert re.findall(r"^group (\d) +(\S+), objects (\d+) to (\d+)$", out, re.M) == [
        ("0", "ship.s", "0", "99"), ("1", "ship_madd.s", "100", "159")]
    assert re.findall(r"^more +(\d+) objects", out, re.M) == ["92", "52"]
    schedulers = [tuple(map(int, row)) for row in re.findall(r"^  scheduler (\d+) +(\d+)  group (\d), (\d+) objects$", out, re.M)]
    assert [scheduler for scheduler, *_ in schedulers] == [0, 1, 2, 3]
    for number, objects in ((0, 100), (1, 60)):
        assert sum(n for *_, of, n in schedulers if of == number) == objects
    cycles = [scheduler[1] for scheduler in schedulers]
    assert f"{100 * (max(cycles) - min(cycles)) / max(cycles):.1f}" == re.search(r"^  imbalance +(\S+) %$", out, re.M)[1]
    assert int(re.search(r"^cycles +(\d+)$", out, re.M)[1]) == max(cycles)
    assert "balance" not in scene(file("array", [group("ship.s", 4)]), "--engine", "isa").stdout


def test_options_replace_settings(scene):
    text = file("array", [group("ship.s", 4)])
    assert "object_steps     20" in scene(text, "--steps", "5").stdout
    assert "object_steps     0" in scene(text, "--steps", "0").stdout
    assert "scheduler 1" in scene(text, "--config", "shared").stdout
    assert "balance" not in scene(text, "--engine", "isa").stdout
    text = text.replace('config = "array";', "")
    assert scene(text, "--config", "array").returncode == 0
    done = scene(text)
    assert done.returncode == 2 and 'x.scene:1: expected config = "..."' in done.stderr


def test_a_spread_is_even_and_reciprocals_follow(run, scene, fp3, folder):
    values = "m = 1.0; rm = \"1/m\"; T = 1.0; C = 4.1e4; v = 0.5; s = 3.0;"
    text = file("array", ['{ program = "ship.s"; objects = 5; set = { %s };'
                          " spread = { T = [1e5, 3e5]; m = (8e5, 4e5); }; }" % values])
    done = scene(text, "--all")
    assert done.returncode == 0, done.stderr
    for number, (thrust, mass) in enumerate(((1e5, 8e5), (1.5e5, 7e5), (2e5, 6e5), (2.5e5, 5e5), (3e5, 4e5))):
        expected = alone(run, fp3, folder, "ship.s", 1, "array", 9, T=thrust, rm=1 / mass)
        assert states(done.stdout)[number] == expected[0]


def test_sleep_is_told_by_group(scene):
    ships = [group("ship_sleep.s", 3, eps=1e9), group("ship_madd.s", 2), group("ship_sleep.s", 2, eps=0, slept=4)]
    for engine in ("rtl", "isa"):
        out = scene(file("array", ships), "--engine", engine).stdout
        assert re.findall(r"^asleep +(.*)$", out, re.M) == ["3 of 3, since steps 1 to 1", "2 of 2, since steps 4 to 4"]
        assert re.findall(r"^object_steps +(\d+)$", out, re.M) == ["3", "18", "0", "21"]


def test_paths_begin_at_the_scene(run, folder, fp3, tmp_path_factory):
    subprocess.run([fp3, "asm", folder / "ship.s", "-o", folder / "ship.fp3"], check=True)
    (folder / "y.scene").write_text('config = "array"; groups = ({ program = "ship.fp3"; objects = 3; params = "ship.cfg"; },'
                                    f'{{ program = "{folder}/ship_madd.s"; objects = 3; params = "ship.cfg"; }});')
    done = run("--scene", folder / "y.scene", cwd=tmp_path_factory.mktemp("elsewhere"))
    assert done.returncode == 0, done.stderr


GOOD = group("ship.s", 3)
BAD = [
    ("", r"x\.scene:1: expected groups = "),
    ("steps = ;", r"x\.scene:1: syntax error"),
    ("\nstep = 3;", r"x\.scene:2: found 'step', expected a setting of a scene: config, engine, steps, visit, seed, h, groups \(did you mean 'steps'\?\)"),
    ("\n\nsteps = 1.5;", r"x\.scene:3: steps: found '1\.5', expected an integer from 0 to 4294967295"),
    ("steps = -1;", r"x\.scene:1: steps: found '-1', expected an integer from 0 to 4294967295"),
    ("visit = 0;", r"x\.scene:1: visit: found '0', expected an integer from 1 to 4294967295"),
    ("config = 3;", r"x\.scene:1: config: found '3', expected a text in quotes"),
    ("h = \"1/2\";", r"x\.scene:1: h: found a text, expected a number"),
    ("groups = { };", r"x\.scene:1: groups: found a group \{ \}, expected a list"),
    ("groups = ();", r"x\.scene:1: expected a group in groups"),
    ("groups = (\n3);", r"x\.scene:2: expected a group, \{ program = "),
    ("groups = (\n{ objects = 3; });", r"x\.scene:2: expected a program in this group"),
    ("groups = (\n{ program = \"ship.s\"; });", r"x\.scene:2: expected the number of objects of this group"),
    ("groups = ({\nprogram = \"ship.s\";\nobjects = 0; });", r"x\.scene:3: objects: found '0', expected an integer from 1 to 4294967295"),
    ("groups = ({\nprogram = 3; objects = 1; });", r"x\.scene:2: program: found '3', expected a text in quotes"),
    ("groups = ({\nprogram = \"ship.c\"; objects = 1; });",
     r"x\.scene:2: found program 'ship\.c', expected a name that ends in \.ode, \.s or \.fp3"),
    ("groups = ({ program = \"nonesuch.s\"; objects = 1; });", r"nonesuch\.s"),
    ("groups = ({ program = \"nonesuch.fp3\"; objects = 1; });", r"nonesuch\.fp3"),
    ("groups = ({ program = \"bad.s\"; objects = 1; });", r"bad\.s:2:1: error: found 'jump'"),
    ("groups = ({ program = \"ship.s\"; objects = 1;\ncolour = 1; });",
     r"x\.scene:2: found 'colour', expected a setting of a group: program, integrator, compensated, double_single, folded, tolerance, until, absolute, maxstep, objects, params, set, spread"),
    ("groups = ({ program = \"ship.s\"; objects = 1; params = \"nonesuch.cfg\"; });", r"x\.scene:1: nonesuch\.cfg: cannot open"),
    ("groups = ({ program = \"ship.s\"; objects = 1;\nset = 3; });", r"x\.scene:2: set: found '3', expected a group"),
    ("groups = ({ program = \"ship.s\"; objects = 1; set = { v = 0.0; s = 0.0; C = 1.0; rm = 1.0;\nT = \"two\"; }; });",
     r"x\.scene:2: 'T' is two: 'two' has no value"),
    ("groups = ({ program = \"ship.s\"; objects = 1; spread = {\nT = [1, 2, 3]; }; });",
     r"x\.scene:2: T: found a list \[ \] of 3, expected a pair of numbers \[FIRST, LAST\]"),
    ("groups = ({ program = \"ship.s\"; objects = 1; spread = { T = 1; }; });", r"x\.scene:1: T: found '1', expected a pair"),
    ("groups = ({ program = \"ship.s\"; objects = 1; spread = { T = [\"a\", \"b\"]; }; });", r"T: found a text, expected a number"),
    ("h = 0.5; config = \"array\";\ngroups = (%s,\n{ program = \"ship.s\"; objects = 1; });" % GOOD,
     r"x\.scene:3: '\w+' has no value"),
    ("h = 0.5; config = \"array\"; groups = (\n%s);" % group("ship.s", 3, mass=1), r"x\.scene:2: the program has no 'mass'"),
    ("config = \"array\"; groups = (\n{ program = \"ship.s\"; objects = 2; params = \"ship.cfg\"; spread = { h = [1, 2]; }; });",
     r"x\.scene:2: 'h' is spread, but is one value for all objects"),
    ("\nh = 1.0; groups = ({ program = \"still.s\"; objects = 1; });", r"x\.scene:2: no program has an 'h'"),
    ("config = \"nonesuch\"; groups = ({ program = \"still.s\"; objects = 1; set = { x = 1; }; });", r"x\.scene:1: config: no configuration 'nonesuch'"),
    (file("shared", 3 * [GOOD]), r"x\.scene:2: found 3 groups, each with a program of its own: configuration 'shared' has 2 schedulers"),
    (file("single", [GOOD]), r"x\.scene:3: objects: found 3, expected at most 1: configuration 'single' has room for 1 object"),
    (file("array", [group("ship.s", 300), group("ship.s", 200)]),
     r"x\.scene:2: the objects of all groups need the stores of 5 schedulers: configuration 'array' has 4"),
    (file("array", [GOOD, group("ship_scale.s", 2)]), r"x\.scene:2: group 1: word \d+ is an addition of half or twice, which configuration 'array'"),
]


@pytest.mark.smoke
@pytest.mark.parametrize("text,message", BAD)
def test_a_bad_scene_is_refused(scene, folder, text, message):
    (folder / "bad.s").write_text(".state x\njump x\n")
    (folder / "still.s").write_text(".state x\nstep:\nadd x, x, 1.0\n")
    done = scene(text if "config" in text else 'config = "array"; ' + text)
    assert done.returncode == 2, done.stdout + done.stderr
    assert re.search(message, done.stderr), done.stderr
    assert done.stdout == "" and done.stderr.count("\n") == 1


def test_a_scene_stands_for_itself(run, scene, folder):
    text = file("array", [GOOD])
    for options, message in ((["ship.fp3"], "--scene: found 'ship.fp3'"),
                             (["--objects", "3"], "the scene says how many objects"),
                             (["--set", "T=1"], "values are in the scene"),
                             (["--kanata", "log"], "--kanata: expected one program"),
                             (["--engine", "abacus"], "no engine 'abacus'")):
        done = scene(text, *options)
        assert done.returncode == 2 and message in done.stderr, done.stderr
    done = run("--scene", "nonesuch.scene")
    assert done.returncode == 2 and "nonesuch.scene: cannot open" in done.stderr
    done = scene(text, "--cycle-limit", "500")
    assert done.returncode == 1 and "limit of 500 cycles" in done.stderr and "balance of schedulers" in done.stdout


def test_the_bus_log_of_a_scene_names_each_scheduler(scene, folder):
    assert scene(file("array", [group("ship.s", 4), group("ship_madd.s", 4)]), "--bus-log", "log").returncode == 0
    addresses = {line.split()[1] for line in (folder / "log").read_text().splitlines() if line[0] == "w"}
    assert len(addresses) > 4 * 20


def test_the_examples_run_as_printed(run, root, folder):
    page = (root / "docs/scenes.md").read_text()
    blocks = [re.sub("^    ", "", block, flags=re.M) for block in re.findall(r"(?:^(?:    .*)?\n)+", page, re.M)]
    (folder / "page.scene").write_text(next(block for block in blocks if "groups" in block))
    assert run("--scene", "page.scene").returncode == 0
    done = run("--scene", "programs/fleet.scene", cwd=root)
    assert done.returncode == 0, done.stderr
    printed = next(block for block in blocks if "balance of schedulers" in block).strip("\n")
    assert printed in done.stdout
    isa = run("--scene", "programs/fleet.scene", "--engine", "isa", cwd=root)
    rows = [re.findall(r"^[vs] .*$", out, re.M) for out in (done.stdout, isa.stdout)]
    assert len(rows[0]) == 32 and rows[0] == rows[1]


@pytest.mark.smoke
def test_models_in_a_scene_are_compiled_for_it(run, root):
    """Planets and springs on two schedulers that share their units: each as it is alone, in C."""
    scene = run("--scene", root / "programs/mixed.scene", "--steps", "20")
    isa = run("--scene", root / "programs/mixed.scene", "--steps", "20", "--engine", "isa")
    alone = run(root / "programs/double_spring.ode", "-i", "leapfrog", "-c", "many_full", "--engine", "isa", "--steps", "20")
    states = [[line.split()[:3] for line in done.stdout.splitlines() if re.search(r"0x[0-9a-f]{8} +object", line)]
              for done in (scene, isa, alone)]
    assert all(done.returncode == 0 for done in (scene, isa, alone)) and len(states[0]) > 16
    assert states[0] == states[1] and states[2][0] in states[0]


def test_a_c_program_runs_a_scene(run, root, build):
    """The example that the page names, by public headers alone: what the command prints, its errors."""
    source = (root / "tests/programs/scene_api.c").read_text()
    assert set(re.findall("#include (.*)", source)) == {"<fp3/scene.h>", "<stdio.h>"}
    assert "](../tests/programs/scene_api.c)" in (root / "docs/scenes.md").read_text()

    def start(path):
        return subprocess.run([build / "tests/scene_api", path], capture_output=True, text=True, timeout=300)

    scene = root / "programs/mixed.scene"
    done, told = start(scene), run("--scene", scene).stdout
    assert (done.returncode, done.stderr) == (0, "")
    firsts = re.findall(r"^group \d+ +(\S+), .*\n(\w+) +(\S+) ", told, re.M)
    assert len(firsts) == 2
    assert done.stdout.splitlines() == [f"{path}: {name} = {value}" for path, name, value in firsts] + [
        re.search(r"^cycles +(\d+)$", told, re.M)[1] + " cycles"]
    done = start("nonesuch.scene")
    assert (done.returncode, done.stdout, done.stderr) == (2, "", "nonesuch.scene: cannot open: No such file or directory\n")


def test_the_last_of_many_objects_has_what_all_share(fp3, tmp_path):
    """Objects get their values in blocks; g*k is made of a shared param and of one that differs."""
    (tmp_path / "many.ode").write_text("shared g = 1\nparam k = 1\nstate x = 0.1\nstate v = k\nstep 0.0078125\nx' = v\nv' = -g*k*x\n")

    def last(*arguments):
        subprocess.run([fp3, "run", "many.ode", "-c", "many_full", "-e", "fast", "-n", "3", "--set", "g=3", "--output", "o.csv", *arguments],
                       cwd=tmp_path, check=True, capture_output=True)
        return (tmp_path / "o.csv").read_text().splitlines()[-1].split(",")[-2:]

    assert last("--objects", "5000", "--spread", "k=1:2") == last("--set", "k=2")
