"""`fp3 compile --tolerance`: the image, the assembly and the values of an adaptive run are that run, on every engine."""
import re

import pytest
from runs import fp3

PLANET = """shared mu = 1
state v[2] = (0, sqrt(3))
state r[2] = (0.5, 0)
v' = -mu*r/norm(r)^3
r' = v
step 0.015625
span 2
"""
UP = "param k = 1\nstate y = 1\ny' = k*y*y\nstep 0.01\nspan 2\n"


@pytest.fixture
def compiled(tmp_path):
    def make(*options, text=PLANET, tolerance="1e-4"):
        model = tmp_path / "m.ode"
        model.write_text(text)
        files = [tmp_path / name for name in ("m.fp3", "m.s", "m.cfg")]
        fp3("compile", model, "--tolerance", tolerance, *options, "--image", files[0], "-o", files[1], "--params", files[2])
        return model, *files

    return make


def told(out):
    """The words of final states, a t of two as an image has them, and how objects stepped, in any order."""
    out = re.sub(r"^t +\S+ +(0x\w{8}) (0x\w{8}) +object (\d+)$", r"t - \1 object \3\nt_low - \2 object \3", out, flags=re.M)
    words = re.findall(r"^(\w+) +\S+ +(0x\w{8}) +object (\d+)$", out, re.M)
    return sorted(words) + re.findall(r"^((?:accepted|rejected|smallest step|largest step|failed) .*)$", out, re.M)


@pytest.mark.parametrize("config, options", [("single_full", []), ("single_full", ["-k", "-i", "ralston3"]), ("many_full", [])])
def test_image_and_assembly_are_the_run_of_the_model(compiled, config, options):
    model, image, assembly, values = compiled("-c", config, *options)
    objects = ["-N", "3", "--spread", "until=0:2"] if config == "many_full" else []
    alike = ["-c", config, "--all", *objects]
    expected = told(fp3("run", model, "--tolerance", "1e-4", *options, *alike, "-e", "isa").stdout)
    assert len(expected) > 12
    for program, engine in ((image, "isa"), (image, "rtl"), (assembly, "isa")) + ((image, "fast"),) * (config == "many_full"):
        assert told(fp3("run", program, "--params", values, *alike, "-e", engine).stdout) == expected, (engine, program)


def test_values_can_be_others(compiled):
    """The file has formulas: what they are made of can be replaced, and is what the model is given."""
    model, image, _, values = compiled("-c", "single_full")
    others = ["--set", "tolerance=1e-3", "--set", "until=1.5", "--set", "h_next=0.1", "--set", "mu=0.9", "-c", "single_full", "-e", "isa"]
    assert told(fp3("run", image, "--params", values, *others).stdout) == told(fp3("run", model, "--tolerance", "1e-4", *others).stdout)
    first = values.read_text().splitlines()[0]
    assert first == "# Adaptive steps: fp3 run PROGRAM --params with this file runs until each object has come to `until`."
    fixed = values.with_name("fixed.cfg")
    fp3("compile", model, "--params", fixed)
    assert "#" not in fixed.read_text().splitlines()[0].split(";")[0]


def test_snapshots(compiled, tmp_path):
    model, image, _, values = compiled("-c", "many_full")
    shots = ["-c", "many_full", "-N", "2", "-e", "isa", "--times", "0,0.1,1.5", "--observe", "t_low,r_x", "--output"]
    fp3("run", model, "--tolerance", "1e-4", "--until", "2", *shots, tmp_path / "model.csv")
    fp3("run", image, "--params", values, *shots, tmp_path / "image.csv")
    assert (tmp_path / "image.csv").read_bytes() == (tmp_path / "model.csv").read_bytes()
    done = fp3("run", image, "--params", values, "-c", "many_full", "-e", "isa", "--output", tmp_path / "never.csv", status=2)
    assert "adaptive steps have no number in common: expected times" in done.stderr and not (tmp_path / "never.csv").exists()


def test_who_does_not_end_has_failed(compiled):
    """The flags of rejected attempts are no failure; an end that is not reached is one."""
    _, image, _, values = compiled("-c", "many_full", text=UP)
    for engine in ("isa", "rtl"):
        alike = ["--params", values, "-c", "many_full", "-e", engine, "-N", "3"]
        done = fp3("run", image, *alike, "--spread", "k=0:1", status=3)
        assert re.search(r"object 2 at t = \S+ of 2, after \d+ steps and \d+ rejected attempts: .*; 1 of 3", done.stderr), done.stderr
    alike[5] = "isa"
    done = fp3("run", image, *alike, "--set", "k=0.25", "--steps", "4", status=3)
    assert re.search(r"object 0 at t = \S+ of 2, after 4 steps and 0 rejected attempts: no attempt is left", done.stderr)
    assert fp3("run", image, *alike, "--set", "k=0.25").returncode == 0


def test_what_nobody_observes_is_not_told(compiled):
    model, image, _, values = compiled("-c", "many_full", "--observe", "r_x")
    alike = ["-c", "many_full", "-e", "isa", "-N", "1"]
    out = fp3("run", image, "--params", values, *alike).stdout
    assert "accepted" not in out and "rejected" not in out
    of_model = told(fp3("run", model, "--tolerance", "1e-4", *alike).stdout)
    assert {word for word in told(out) if word[0] in ("v_x", "r_x", "t", "t_low")} < set(of_model)
    done = fp3("run", image, "--params", values, *alike, "--steps", "3", status=3)
    assert re.search(r"object 0 at t = \S+ of 2: no attempt is left", done.stderr)


@pytest.mark.parametrize("line, message", [
    ("until = -1.0;", "m.cfg:2: 'until' is -1: expected a finite time that does not come before t, 0"),
    ("t = 5.0;", "'until' is 2: expected a finite time that does not come before t, 5"),
    ("t_low = 1e-3;", "m.cfg:2: 't_low' is 0.001: expected the second word of t, 0, whose sum rounds to t"),
    ("h_next = 0.0;", "m.cfg:2: 'h_next' is 0: expected a finite number above 0"),
    ("tolerance = -1e-4;", "m.cfg:2: 'tolerance' is -0.0001: expected a finite number above 0"),
    ("absolute = 0;", "m.cfg:2: 'absolute' is 0: expected a finite number above 0"),
])
def test_values_that_are_refused(compiled, line, message):
    _, image, assembly, values = compiled("-c", "many_full")
    name = line.split()[0]
    lines = [other for other in values.read_text().splitlines()[1:] if not other.startswith(name + " ")]
    values.write_text("\n".join(["#", line, *lines]) + "\n")
    for program in (image, assembly):
        assert message in fp3("run", program, "--params", values, "-c", "many_full", "-e", "isa", status=2).stderr


def test_what_is_refused(compiled, tmp_path):
    model, image, _, values = compiled("-c", "single_full")
    run = ["run", image, "--params", values, "-e", "isa"]
    done = fp3(*run, "-c", "many_full", status=2)
    assert "adaptive steps of many objects need 'sleep': expected a program that is compiled for configuration 'many_full'" in done.stderr
    assert "--cycle-limit: a limit applies to one run" in fp3(*run, "-c", "single_full", "--cycle-limit", "99", status=2).stderr
    done = fp3("bench", "--program", image, "--params", values, "-c", "single_full", status=2)
    assert "the program has adaptive steps, expected fixed ones" in done.stderr
    never = tmp_path / "never.fp3"
    for options, message in ((["--tolerance", "0"], "--tolerance: found '0', expected a number above 0"),
                             (["--tolerance", "1e-4", "-i", "rk4"], "integrator 'rk4' has none"),
                             (["--tolerance", "1e-9", "--params", tmp_path / "never.cfg"], "'tolerance' is 1e-09: expected a number from 1.19e-07")):
        assert message in fp3("compile", model, *options, "--image", never, status=2).stderr
        assert not never.exists() and not (tmp_path / "never.cfg").exists()


def test_a_group_of_a_scene(compiled, tmp_path):
    model, image, _, values = compiled("-c", "shared_full")
    group = '{{ program = "m.{}"; objects = 2; {} }}'
    fixed = group.format("ode", "")
    of = {}
    for name, how in (("ode", "tolerance = 1e-4; until = 2.0;"), ("fp3", 'params = "m.cfg";')):
        (tmp_path / "x.scene").write_text(f'config = "shared_full"; steps = 3; engine = "isa"; groups = ({group.format(name, how)}, {fixed});')
        of[name] = told(fp3("run", "--scene", tmp_path / "x.scene").stdout)
    assert of["ode"] == of["fp3"] and len(of["ode"]) > 20
