"""What the compiler makes of h and params stands in the file of values as a formula: whoever sets h or a param, in whichever
way, gets the bits of a program that was compiled with that value."""

import re
import subprocess

import pytest


@pytest.fixture
def start(fp3, root, tmp_path):
    def start(*arguments, code=0):
        done = subprocess.run([fp3, *map(str, arguments)], cwd=tmp_path, capture_output=True, text=True, timeout=300)
        assert done.returncode == code, done.stdout + done.stderr
        return done

    return start


def states(text):
    found = re.findall(r"^(\w+) +\S+ +(0x\w{8})   object (\d+)$", text, re.M)
    assert found, text
    return found


FOLDED = ["--with", "fold-step", "--with", "fold-product"]
CASES = [
    ("double_spring", "rk4", [], {"h": 0.0013, "m": 0.7}), ("double_spring", "rk4", FOLDED, {"h": 0.0013, "k": 31.3}),
    ("double_spring", "pefrl", FOLDED, {"h": 0.003, "m": 1.1}), ("ship", "rk4_paper", FOLDED, {"h": 0.3, "m": 7.7e5, "C": 3.3e4}),
    ("oscillator", "dopri5", FOLDED + ["-k"], {"h": 0.011}), ("kepler", "verlet", FOLDED, {"h": 0.007}),
    ("rigid_body", "rk4", FOLDED, {"h": 0.03}), ("projectile", "heun", FOLDED, {"h": 0.07}), ("arenstorf", "rk4", [], {"h": 0.0003}),
]


@pytest.mark.parametrize("model,integrator,options,other", CASES)
def test_a_value_that_is_set_is_computed_with(start, root, tmp_path, model, integrator, options, other):
    ode = root / f"programs/{model}.ode"
    make = ("compile", ode, "-i", integrator, *options)
    sets = [f"--set={name}={value}" for name, value in other.items()]
    run = ("run", "x.fp3", "-c", "single_full", "-e", "isa", "-n", 7, "--params")
    start(*make, "--image", "x.fp3", "--params", "own.cfg")
    start(*make, "--params", "other.cfg", *sets)
    wanted = states(start(*run, "other.cfg").stdout)
    assert wanted != states(start(*run, "own.cfg").stdout)
    assert states(start(*run, "own.cfg", *sets).stdout) == wanted                     # set on the line
    text = (tmp_path / "own.cfg").read_text()
    for name, value in other.items():
        text, count = re.subn(rf"^{name} = [^;]+;", f"{name} = {value};", text, flags=re.M)
        assert count == 1, text
    (tmp_path / "own.cfg").write_text(text)
    assert states(start(*run, "own.cfg").stdout) == wanted                            # edited by hand
    if not options:
        assert states(start("run", ode, "-i", integrator, "-e", "isa", "-n", 7, *sets).stdout) == wanted  # the model itself


def test_a_scene_computes_again(start, root, tmp_path):
    make = ("compile", root / "programs/double_spring.ode", "-c", "shared_full", *FOLDED)
    start(*make, "--image", "x.fp3", "--params", "x.cfg")
    (tmp_path / "x.scene").write_text('config = "shared_full"; engine = "isa"; steps = 5; h = 0.003; groups = ({ program = "x.fp3";'
                                      ' objects = 2; params = "x.cfg"; spread = { m = [0.5, 0.8]; }; });')
    found = states(start("run", "--scene", "x.scene").stdout)
    for number, m in enumerate((0.5, 0.8)):
        start(*make, "--params", "y.cfg", "--set", "h=0.003", "--set", f"m={m}")
        alone = states(start("run", "x.fp3", "-c", "shared_full", "-e", "isa", "-n", 5, "--objects", 1, "--params", "y.cfg").stdout)
        assert [row[:2] for row in found if row[2] == str(number)] == [row[:2] for row in alone]


def test_a_derived_value_that_does_not_agree_is_refused(start, root):
    start("compile", root / "programs/double_spring.ode", *FOLDED, "--image", "x.fp3", "--params", "x.cfg")
    run = ("run", "x.fp3", "-c", "single_full", "-e", "isa", "--params", "x.cfg")
    done = start(*run, "--set", "c7=0.25", code=2)
    assert done.stderr == "fp3 run: 'c7' is 0.25, but it is 0.5*h, which is 0.0009765625: leave it out\n"
    assert states(start(*run, "--set", "c7=0.0009765625").stdout) == states(start(*run).stdout)
    assert "'c7' is 0.0009765625, but it is 0.5*h" in start(*run, "--set", "c7=0.0009765625", "--set", "h=0.5", code=2).stderr


def test_a_position_before_the_start_holds_for_its_values_alone(start, root, tmp_path):
    ode = root / "programs/double_spring.ode"
    start("compile", ode, "-i", "stoermer_verlet", "--image", "x.fp3", "--params", "x.cfg")
    run = ("run", "x.fp3", "-c", "single_full", "-e", "isa", "-n", 5, "--params", "x.cfg")
    assert states(start(*run).stdout)[:4] == states(start("run", ode, "-i", "stoermer_verlet", "-e", "isa", "-n", 5).stdout)[:4]
    for other in ("h=0.01", "m=0.6", "x1=0.5", "v1=0.1"):
        assert "'x1_before' was computed for h = 0.001953125" in start(*run, "--set", other, code=2).stderr


@pytest.mark.parametrize("text,message", [
    ('a = "b"; b = "a + 1";', "x.cfg:1: 'a' is computed from itself, or from too many other values"),
    ('a = "b*2"; ', "x.cfg:1: 'a' is b*2: 'b' has no value"),
    ('a = "2*";', "x.cfg:1: 'a' is 2*: column 3: found end of"),
    ('a = "";', "x.cfg:1: 'a' is : column 1: found end of"),
    ('a = "1/b"; b = 0;', "x.cfg:1: 'a' is 1/b: column 1: found '1', expected a finite value"),
    ('a = "log(b)"; b = -1;', "x.cfg:1: 'a' is log(b): column 1: found 'log', expected a finite value"),
    ('a = "1e300*b"; b = 1e6;', "x.cfg:1: 'a' is 1e+306: expected"),
    ('a = "b"; b = 1; c = 2;', "x.cfg:1: the program has no 'c'"),
    ('a = 1; b = "a";', "x.cfg:1: the program has no 'b'"),
    ('a = "b; b"; b = 1;', "x.cfg:1: 'a' is b; b: column 2: found"),
])
def test_wrong_formulas_are_refused(start, tmp_path, text, message):
    (tmp_path / "x.s").write_text(".state x\n.param a\nstep: add x, x, a\n")
    (tmp_path / "x.cfg").write_text(f"x = 0.0; {text}")
    done = start("run", "x.s", "-e", "isa", "--params", "x.cfg", code=2)
    assert message in done.stderr, done.stderr


def test_formulas_of_formulas(start, tmp_path):
    (tmp_path / "x.s").write_text(".state x\n.param a\nstep: add x, x, a\n")
    (tmp_path / "x.cfg").write_text('x = 0.0; a = "c^2 + sqrt(b) - 1.5e-3*0"; b = "4*c"; c = 4;')
    assert ("x", "0x41a00000", "0") in states(start("run", "x.s", "-e", "isa", "--params", "x.cfg").stdout)
    assert ("x", "0x3f800000", "0") not in states(start("run", "x.s", "-e", "isa", "--params", "x.cfg", "--set", "c=1").stdout)
