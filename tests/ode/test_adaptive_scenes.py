"""Scenes whose groups choose their steps: each group as it is alone, beside groups with fixed steps, on every engine."""
import re
import subprocess

import pytest
from runs import BUILD, fp3

PLANET = """state v[2] = (0, sqrt(3))
state r[2] = (0.5, 0)
v' = -r/norm(r)^3
r' = v
step 0.015625
span 6.25
"""
BLOW_UP = "param k = 1\nstate y = 1\ny' = k*y*y\nstep 0.01\nspan 2\n"
CHOOSING = '{ program = "planet.ode"; objects = 3; tolerance = 1e-4; until = 3.0; spread = { until = [0.0, 3.0]; }; }'
FIXED = '{ program = "planet.ode"; objects = 2; integrator = "leapfrog"; spread = { v_y = [1.5, 1.7]; }; }'


@pytest.fixture
def scene(tmp_path):
    (tmp_path / "planet.ode").write_text(PLANET)
    (tmp_path / "up.ode").write_text(BLOW_UP)
    (tmp_path / "hold.s").write_text(".state x\n.shared h\nfirst:\nadd x, x, h\nstep:\nadd x, x, h\n")

    def run(groups, *options, settings="", engine="isa", config="many_full", status=0):
        text = f'config = "{config}"; {settings}\ngroups = (\n' + ",\n".join(groups) + "\n);\n"
        (tmp_path / "x.scene").write_text(text)
        return fp3("run", "--scene", tmp_path / "x.scene", "-e", engine, *options, status=status)

    return run


def states(text):
    """Of each object, what it holds but for the attempt in which it fell asleep."""
    found = {}
    for name, bits, number in re.findall(r"^(\w+) +\S+ +(0x\w{8})   object (\d+)$", text, re.M):
        found.setdefault(int(number), {})[name] = bits
    return [found[number] for number in range(len(found))]


@pytest.mark.parametrize("first", [CHOOSING, FIXED])
def test_groups_of_both_kinds_are_what_they_are_alone(scene, tmp_path, first):
    """Fewer fixed steps than attempts, so that the ones end before the others; in either order."""
    path = tmp_path / "planet.ode"
    of = {CHOOSING: ["--tolerance", "1e-4", "--until", "3", "--spread", "until=0:3", "-N", "3"],
          FIXED: ["-i", "leapfrog", "-n", "9", "--spread", "v_y=1.5:1.7", "-N", "2"]}
    groups = [first, CHOOSING if first == FIXED else FIXED]
    alone = [state for group in groups
             for state in states(fp3("run", path, "-c", "shared_full", "-e", "isa", "--all", *of[group]).stdout)]
    assert len(alone) == 5
    for engine in ("isa", "rtl", "fast"):
        done = scene(groups, settings="steps = 9; h = 0.015625;", config="shared_full", engine=engine)
        assert states(done.stdout) == alone, engine
        steps = [int(n) for n in re.findall(r"^object_steps +(\d+)$", done.stdout, re.M)]
        assert steps[groups.index(FIXED)] == 18 and steps[2] == steps[0] + steps[1]
    none = scene(groups, "--steps", "0", config="shared_full").stdout
    steps = [int(n) for n in re.findall(r"^object_steps +(\d+)$", none, re.M)]
    assert steps[groups.index(FIXED)] == 0 and steps[groups.index(CHOOSING)] > 18


@pytest.mark.parametrize("config", ["single_full", "many_full"])
def test_one_group_is_a_run_of_its_model(scene, tmp_path, config):
    """Also where one object cannot sleep, and the run is several."""
    group = '{ program = "planet.ode"; objects = 1; tolerance = 1e-4; until = 3.0; absolute = 1e-6; compensated = true; }'
    alone = fp3("run", tmp_path / "planet.ode", "-c", config, "-N", "1", "-e", "rtl", "-k", "--tolerance", "1e-4", "--until", "3",
                "--set", "absolute=1e-6").stdout
    done = scene([group], config=config, engine="rtl").stdout
    assert states(done) == states(alone)
    said = [re.findall(r"^(?:accepted|rejected|smallest step|largest step|object_steps|cycles|  cycles) .*$", out, re.M) for out in (done, alone)]
    assert said[0][:-3] == said[1][:-2], "a group has a line object_steps of its own"
    cycles = int(re.search(r"^cycles +(\d+)$", done, re.M)[1])
    assert re.search(rf"^  cycles +{cycles} ", done, re.M) and re.search(rf"^  scheduler 0 +{cycles} ", done, re.M)
    assert re.search(rf"^  cycles +{cycles} ", alone, re.M)


def test_snapshots_are_those_of_the_model(scene, tmp_path):
    options = ["--times", "0,0.1,2.3,3", "--observe", "t,r_x,accepted", "--output"]
    for engine in ("isa", "rtl"):
        fp3("run", tmp_path / "planet.ode", "-c", "many_full", "-e", engine, "--tolerance", "1e-4", "--until", "3", "-N", "3",
            "--spread", "until=0:3", *options, tmp_path / "model.csv")
        scene([CHOOSING], *options, tmp_path / "scene.csv", engine=engine)
        assert (tmp_path / "scene.csv").read_bytes() == (tmp_path / "model.csv").read_bytes()
    done = scene([CHOOSING], "--output", tmp_path / "never.csv", status=2)
    assert "adaptive steps have no number in common: expected times of snapshots" in done.stderr
    assert not (tmp_path / "never.csv").exists()


UP = '{ program = "up.ode"; objects = 2; tolerance = 1e-4; until = 2.0; spread = { k = [0.0, 1.0]; }; }'


def test_who_failed_is_named(scene):
    """Object numbers are those of the scene; exceptions of a rejected attempt are no failure of either group."""
    stuck = r"object 3 at t = \S+ of 2, after \d+ steps and \d+ rejected attempts: "
    for engine in ("isa", "rtl", "fast"):
        done = scene([FIXED, UP], settings="steps = 5;", config="shared_full", engine=engine, status=3)
        assert re.search(stuck + ".*; 1 of 4 objects failed", done.stderr), done.stderr
        assert re.findall(r"^failed +(\d of \d), first object (\d)", done.stdout, re.M) == [("1 of 2", "3")]
    both = [UP, '{ program = "up.ode"; objects = 2; integrator = "euler"; spread = { k = [0.0, 1e30]; }; }']
    done = scene(both, settings="steps = 9;", config="shared_full", status=3)
    assert re.search("object 1 at t = .*; 2 of 4 objects failed", done.stderr)
    assert re.findall(r"^failed +(\d of \d), first object (\d)", done.stdout, re.M) == [("1 of 2", "1"), ("1 of 2", "3")]
    assert scene([UP], "--allow-failures").returncode == 0


def test_steps_limit_attempts_where_all_groups_choose(scene):
    for options, settings in ((["--steps", "5"], ""), ([], "steps = 5;")):
        done = scene([CHOOSING], *options, settings=settings, status=3)
        assert re.search(r"object 1 at t = \S+ of 1.5, after 5 steps and 0 rejected attempts: no attempt is left.*; 2 of 3", done.stderr)


def test_a_c_program_runs_them(scene, tmp_path):
    """fp3_adaptive_run is what the command does."""
    told = scene([CHOOSING, FIXED], settings='engine = "isa"; steps = 9;', config="shared_full").stdout
    done = subprocess.run([f"{BUILD}/tests/scene_api", tmp_path / "x.scene"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert f"{re.search(r'^cycles +(.*)$', told, re.M)[1]} cycles" in done.stdout


def group(settings, program="planet.ode"):
    return f'{{ program = "{program}"; objects = 2;\n{settings} }}'


@pytest.mark.parametrize("groups, message", [
    ([group("tolerance = 0; until = 1.0;")], ":4: tolerance: found '0', expected a number above 0"),
    ([group("tolerance = -1e-3; until = 1.0;")], ":4: tolerance: found '-1e-3', expected a number above 0"),
    ([group('tolerance = "1e-3"; until = 1.0;')], ":4: tolerance: found a text, expected a number"),
    ([group("tolerance = 1e-3;\nuntil = 0.0;")], ":5: until: found '0.0', expected a number above 0"),
    ([group("tolerance = 1e-3; until = 1.0;\nabsolute = 0;")], ":5: absolute: found '0', expected a number above 0"),
    ([group("tolerance = 1e-3;")], ":4: tolerance: expected 'until', too, the time at which the objects of this group end"),
    ([group("maxstep = 1.0;")], ":4: maxstep: expected a tolerance, too: without a tolerance all steps are h long"),
    ([group("absolute = 1e-3;")], ":4: absolute: expected a tolerance, too"),
    ([group("tolerance = 1e-8; until = 1.0;")], ":3: 'tolerance' is 1e-08: expected a number from 1.19e-07"),
    ([group("tolerance = 1e-3; until = 1e39;")], "x.scene:3: until is 1e+39: expected a number below 3.4028236e38"),
    ([group("tolerance = 1e-3; until = 1.0; spread = { until = [-1.0, 1.0]; };")], ":3: 'until' is -1: expected a finite time"),
    ([group("tolerance = 1e-3; until = 1.0; set = {\nh = 0.5; };")], ":5: the program has no 'h'"),
    ([group('tolerance = 1e-3; until = 1.0; integrator = "rk4";')], "x.scene:3: "),
    ([group("tolerance = 1e-3; until = 1.0;", "hold.s")], ":4: tolerance: only a model (*.ode) is compiled"),
    ([group("tolerance = 1e-3; until = 1.0;\nborn = 3;")], ":5: born, gone: are steps that a scene has in common"),
    ([group("gone = 3;"), group("tolerance = 1e-3; until = 1.0;")], ":4: born, gone: are steps that a scene has in common"),
    ([group("tolerance = 1e-3; until = 1.0;"), group("set = { x = 0.0; h = 1.0; };", "hold.s")],
     ":5: a run of this program cannot be split by adaptive steps of another group"),
])
def test_refused(scene, groups, message):
    done = scene(groups, config="shared_full", status=2)
    assert message in done.stderr and done.stdout == ""


def test_what_has_no_meaning_with_them(scene, tmp_path):
    assert "--cycle-limit: a limit applies to one run" in scene([CHOOSING], "--cycle-limit", "99", status=2).stderr
    assert "x.scene:1: no program has an 'h'" in scene([CHOOSING], settings="h = 0.5;", status=2).stderr
    assert "adaptive steps need `sleep`, which configuration 'lanes' does not have" in scene([CHOOSING], config="lanes", status=2).stderr
