"""Objects that fail in a run: which one first, in which step, by what, on every configuration; and exit code 3."""

import json
import pathlib
import re
import subprocess
import tomllib

import pytest

ROOT = pathlib.Path(__file__).parents[2]
# The program adds a product to itself: not where sums and products are apart.
CONFIGS = [row["name"] for row in tomllib.loads((ROOT / "isa/configs.toml").read_text())["config"] if row.get("multiply_add") != "dual" and not row.get("storage")]
FINITE = [row["name"] for row in tomllib.loads((ROOT / "isa/configs.toml").read_text())["config"] if row.get("arithmetic") == "cell"]
# x doubles a times; t is no state; y has a part of its own in the last part.
GROWS = ".state x y\n.param a\n.temp t\nfirst: add t, -0.0, -0.0\nstep: mul x, x, a\nlast: add y, x, x\n"


@pytest.fixture
def run(fp3, tmp_path):
    def start(source, *arguments, code=0):
        (tmp_path / "x.s").write_text(source)
        done = subprocess.run([fp3, "run", "x.s", *arguments], cwd=tmp_path, capture_output=True, text=True, timeout=300)
        assert done.returncode == code, done.stdout + done.stderr
        return done

    return start


def values(**pairs):
    return [f"--set={name}={value}" for name, value in pairs.items()]


def told(done):
    """What stdout and stderr say of the first failure; they agree."""
    row = re.search(r"^failed +(\d+) of (\d+), first (.*)$", done.stdout, re.M)
    line = re.fullmatch(r"fp3 run: (.*); (\d+) of (\d+) objects failed \(with --allow-failures the exit code is 0\)\n", done.stderr)
    assert row and line and row[3] == line[1] and (row[1], row[2]) == (line[2], line[3]), done.stdout + done.stderr
    return row[3], int(row[1]), int(row[2])


@pytest.mark.parametrize("config", CONFIGS)
def test_every_configuration_tells_the_first_failure(run, config):
    for engine in ("isa", "rtl"):
        which = ("--config", config, "--engine", engine)
        grows = values(a=2.0**20, x=1.0, y=0)   # 2^120 after 6 steps
        assert told(run(GROWS, *which, "--steps", "9", *grows, code=3))[0] == "object 0 in step 7: overflow"
        done = run(GROWS, *which, "--steps", "6", *grows)
        assert not done.stderr and not re.search("^failed", done.stdout, re.M)
        done = run(GROWS, *which, "--steps", "9", "--allow-failures", *grows)
        assert not done.stderr and "first object 0 in step 7: overflow" in done.stdout
        if config in FINITE:
            for number in ("inf", "nan"):
                done = run(GROWS, *which, *values(a=number, x=1, y=0), code=2)
                assert f"'a' is {number}: expected a finite number" in done.stderr
            continue
        # 0 times infinity; a state that is infinite without any exception; one that is NaN from the start.
        assert told(run(GROWS, *which, "--steps", "9", *values(a="inf", x=0, y=0), code=3))[0] == "object 0 in step 1: invalid"
        assert told(run(GROWS, *which, *values(a="inf", x=1, y=0), code=3))[0] == "object 0 in step 1: state x is infinite"
        assert told(run(GROWS, *which, *values(a=1, x="nan", y=0), code=3))[0] == "object 0 before its first step: state x is NaN"
        # Small numbers are no failures.
        done = run(GROWS, *which, "--steps", "9", *values(a=2.0**-40, x=1.1, y=0))
        assert re.search("^flags .*underflow", done.stdout, re.M) and "failed" not in done.stdout


@pytest.mark.parametrize("config", ["single", "many", "lanes"])
@pytest.mark.parametrize("engine", ["isa", "rtl"])
def test_an_exception_counts_whatever_becomes_of_it(run, config, engine):
    which = ("--config", config, "--engine", engine, "--steps", "5")
    # Of a temp that the step after reads, or nobody; of the first part; of the last part.
    source = ".state x\n.temp t\nstep: add x, x, 1.0\nmul t, x, 1e38\n"
    assert told(run(source, *which, *values(x=0), code=3))[0] == "object 0 in step 5: overflow"
    source = ".state x\n.temp t\nfirst: mul t, 1e38, 1e38\nstep: add x, x, 1.0\n"
    assert told(run(source, *which, *values(x=0), code=3))[0] == "object 0 in step 1: overflow"
    source = ".state x\n.temp t\nstep: add x, x, 1.0\nlast: mul t, x, 1e38\n"
    assert told(run(source, *which, *values(x=0), code=3))[0] == "object 0 in step 5: overflow"
    # One after the other: the first tells.
    source = ".state x\n.temp t\nstep: mul x, x, x\nsub t, x, x\n"
    done = run(source, *which, *values(x=1e10), code=3)
    assert told(done)[0] == "object 0 in step 2: overflow" and re.search("^flags +invalid overflow", done.stdout, re.M)


@pytest.mark.parametrize("engine", ["isa", "rtl"])
@pytest.mark.parametrize("config,visit", [("single", 0), ("many", 0), ("many", 1), ("many", 2), ("lanes", 3)])
def test_what_is_computed_ahead_is_of_the_next_step(run, config, visit, engine):
    which = ("--config", config, "--engine", engine, *(["--visit", str(visit)] if visit else []))
    # t is for the next step, by way of u; the first part computes it for the first step of a visit.
    ahead = ".state x y\n.temp t u\nfirst: mul u, x, 1e38\nadd t, u, 1.0\nstep: mul y, t, 0.5\nadd x, x, 1.0\nmul u, x, 1e38\nadd t, u, 1.0\n"
    done = run(ahead, *which, "--steps", "4", *values(x=0, y=0))
    assert re.search("^flags .*overflow", done.stdout, re.M) and not done.stderr
    assert told(run(ahead, *which, "--steps", "5", *values(x=0, y=0), code=3))[0] == "object 0 in step 5: overflow"
    # The last part, or a state, has it in the same step.
    now = ahead + "last: add y, t, 1.0\n"
    assert told(run(now, *which, "--steps", "4", *values(x=0, y=0), code=3))[0] == "object 0 in step 4: overflow"
    now = ".state x y\nstep: add x, x, 1.0\nmul y, x, 1e38\n"
    run(now, *which, "--steps", "3", *values(x=0, y=0))
    assert told(run(now, *which, "--steps", "4", *values(x=0, y=0), code=3))[0] == "object 0 in step 4: overflow"


@pytest.mark.parametrize("engine", ["isa", "rtl"])
def test_what_sleep_alone_reads_is_of_its_step(run, engine):
    which = ("--config", "many", "--engine", engine)
    source = ".state x z\n.temp u\nstep: add x, x, 1.0\nmul u, x, 1e38\nsleep z, u, 1.0\n"
    assert not run(source, *which, "--steps", "3", *values(x=0, z=0)).stderr
    assert told(run(source, *which, "--steps", "4", *values(x=0, z=0), code=3))[0] == "object 0 in step 4: overflow"


@pytest.mark.parametrize("engine", ["isa", "rtl"])
@pytest.mark.parametrize("config", ["single_full", "many_full"])
def test_a_right_run_does_not_fail(fp3, tmp_path, config, engine):
    def start(text, integrator, steps, *options):
        (tmp_path / "m.ode").write_text(text)
        return subprocess.run([fp3, "run", "m.ode", "-c", config, "-e", engine, "-i", integrator, "-n", str(steps), *options],
                              cwd=tmp_path, capture_output=True, text=True, timeout=300)

    # x is 0 after 4 steps: 1/x is computed ahead, and is of step 5.
    text = "state x = 4\nstate y = 1\nstep 1\nx' = -1\ny' = 1/x + x^1.3\n"
    for integrator, y in (("euler", 16.7796564), ("midpoint", 14.8401756)):
        for visit in ([], ["--visit", "1"]) if config == "many_full" else ([],):
            done = start(text, integrator, 4, *visit)
            assert done.returncode == 0 and not done.stderr, done.stdout + done.stderr
            assert float(re.search(r"^y +(\S+)", done.stdout, re.M)[1]) == pytest.approx(y, abs=1e-5)
            done = start(text, integrator, 5, *visit)
            assert done.returncode == 3 and told(done)[0] == "object 0 in step 5: invalid", done.stdout + done.stderr


@pytest.mark.parametrize("engine", ["isa", "rtl"])
@pytest.mark.parametrize("config,visit", [("many", 0), ("many", 2), ("array", 3), ("lanes", 2), ("crowd", 1)])
def test_a_store_and_visits_change_nothing(run, config, visit, engine):
    done = run(GROWS, "--config", config, "--engine", engine, "--objects", "30", "--steps", "9",
               *(["--visit", str(visit)] if visit else []), *values(a=2.0**20, x=1.0, y=0), code=3)
    assert told(done) == ("object 0 in step 7: overflow", 30, 30)
    assert len(re.findall("^x +inf", done.stdout, re.M)) == 8


SCENE = """config = "{config}"; engine = "{engine}"; steps = 9; visit = {visit};
groups = ({{ program = "calm.s"; objects = 7; set = {{ v = 1.0; }}; }},
          {{ program = "grows.s"; objects = 5; set = {{ y = 0.0; x = 1.0; }}; spread = {{ a = [2.0, 1e9]; }}; }});"""


@pytest.mark.parametrize("engine", ["isa", "rtl"])
@pytest.mark.parametrize("config,visit", [("array", 20), ("shared", 2)])
def test_a_scene_tells_the_group(fp3, tmp_path, engine, config, visit):
    (tmp_path / "calm.s").write_text(".state v\nstep: add v, v, v\n")
    (tmp_path / "grows.s").write_text(GROWS)
    (tmp_path / "x.scene").write_text(SCENE.format(config=config, engine=engine, visit=visit))
    done = subprocess.run([fp3, "run", "--scene", "x.scene"], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 3, done.stdout + done.stderr
    a = [2.0, 2.5e8, 5e8, 7.5e8, 1e9]          # 3.4e38 is the largest number
    step = [next((n for n in range(1, 10) if float(x) ** n > 3.4e38), None) for x in a]
    first = min(s for s in step if s)
    assert step[0] is None and [s for s in step if s] == [5] * 4
    groups = done.stdout.split("group ")
    assert "failed" not in groups[1] and f"failed           4 of 5, first object 8 in step {first}: overflow" in groups[2]
    assert done.stderr.startswith(f"fp3 run: object 8 in step {first}: overflow; 4 of 12 objects failed")


SLEEPY = ".state x slept\n.param a eps\n.temp d\nstep: mul d, x, a\nsleep slept, d, eps\nadd x, d, -0.0\n"


@pytest.mark.parametrize("engine", ["isa", "rtl"])
@pytest.mark.parametrize("visit", [1, 3, 50])
def test_who_sleeps_in_time_does_not_fail(fp3, tmp_path, engine, visit):
    (tmp_path / "s.s").write_text(SLEEPY)
    text = f'''config = "many"; engine = "{engine}"; steps = 50; visit = {visit};
groups = ({{ program = "s.s"; objects = 3; set = {{ a = 1e3; slept = 0.0; }};
             spread = {{ x = [1e-9, 1e9]; eps = [1e30, 0.0]; }}; }});'''
    (tmp_path / "x.scene").write_text(text)
    done = subprocess.run([fp3, "run", "--scene", "x.scene"], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 3, done.stdout + done.stderr
    assert "asleep           2 of 3, since steps 1 to 1\n" in done.stdout     # eps is 1e30 and 5e29
    assert "failed           1 of 3, first object 2 in step 10: overflow\n" in done.stdout, done.stdout


def test_all_outputs_are_there(run, tmp_path):
    done = run(GROWS, "--config", "single", "--steps", "9", "--kanata", "log", "--bus-log", "bus", *values(a=1e9, x=1, y=0), code=3)
    assert (tmp_path / "log").read_text().startswith("Kanata") and "h " in (tmp_path / "bus").read_text()
    assert re.search(r"^x +inf +0x7f800000   object 0$", done.stdout, re.M) and re.search("^cycles ", done.stdout, re.M)


def test_a_run_that_ends_early_has_its_own_exit_code(run):
    done = run(GROWS, "--config", "single", "--steps", "1000", "--cycle-limit", "500", *values(a=1e9, x=1, y=0), code=1)
    assert "limit of 500 cycles" in done.stderr and re.search("^flags .*overflow", done.stdout, re.M)


@pytest.mark.parametrize("engine", ["isa", "rtl"])
@pytest.mark.parametrize("derivative,what", [
    ("-sqrt(x - 2)", "invalid"), ("1/(x - 1)", "invalid"), ("x*x*1e30", "overflow"),
])
def test_models_fail_in_words(fp3, tmp_path, engine, derivative, what):
    (tmp_path / "m.ode").write_text(f"state x = 1\nstep 0.5\nx' = {derivative}\n")
    for config in ("single_full", "many_full"):
        done = subprocess.run([fp3, "run", "m.ode", "-c", config, "-e", engine, "-i", "euler", "-n", "3"], cwd=tmp_path,
                              capture_output=True, text=True, timeout=300)
        assert done.returncode == 3, done.stdout + done.stderr
        assert re.match(rf"object 0 in step [12]: {what}$", told(done)[0]), done.stderr


def models(root):
    return sorted(path.stem for path in (root / "programs").glob("*.ode"))


def pytest_generate_tests(metafunc):
    if "model" in metafunc.fixturenames:
        metafunc.parametrize("model", models(ROOT))


def test_the_models_of_the_project_do_not_fail(fp3, root, model):
    """No exception that counts is raised on the way: their span, or its first part."""
    text = (root / f"programs/{model}.ode").read_text()
    step, span = (float(eval(re.search(rf"^{key} +([-\d.e/^]+)", text, re.M)[1].replace("^", "**"))) for key in ("step", "span"))
    steps = str(min(4000, max(1, round(span / step))))
    for integrator in ("rk4", "midpoint"):   # they fit whatever the model
        done = subprocess.run([fp3, "run", f"programs/{model}.ode", "-e", "isa", "-i", integrator, "-n", steps], cwd=root,
                              capture_output=True, text=True, timeout=300)
        assert done.returncode == 0, done.stdout + done.stderr


def test_tables_of_measurements_say_which_row_failed(fp3, root, tmp_path):
    (tmp_path / "x.s").write_text(GROWS)
    (tmp_path / "x.cfg").write_text("a = 1e3; x = 1.0; y = 0.0;")
    done = subprocess.run([fp3, "bench", "--program", tmp_path / "x.s", "--config", "many", "--steps", "1000", "--params",
                           tmp_path / "x.cfg", "--json", tmp_path / "x.json"], cwd=root, capture_output=True, text=True, timeout=300)
    assert re.search(r"words; failed: object 0 in step 13: overflow$", done.stdout, re.M), done.stdout + done.stderr
    assert done.returncode == 3 and done.stderr == "fp3 bench: x, many: object 0 in step 13: overflow\n"
    assert json.loads((tmp_path / "x.json").read_text())["runs"][0]["failed"] == "object 0 in step 13: overflow"
    (tmp_path / "m.ode").write_text("state x = 1e4\nstep 1\nspan 3\nx' = -x*x\n")
    done = subprocess.run([fp3, "compare", "m.ode", "-i", "euler", "--json", "m.json"], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 3 and done.stderr == "fp3 compare: euler, plain: object 0 in step 4: overflow\n"
    rows = [line for line in done.stdout.splitlines() if " euler " in line]
    assert rows and all("; failed: object 0 in step 4: overflow" in row for row in rows), done.stdout + done.stderr
    assert all(row["failed"] == "object 0 in step 4: overflow" for row in json.loads((tmp_path / "m.json").read_text())["rows"])
