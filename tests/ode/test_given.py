"""What equations have of a param and of h: the FP32 number nearest to what is written, in double-single a sum of two; all else is
computed from that, whichever way a value takes to the program."""

import re
import struct
import subprocess

import pytest

MODEL = """state x = 1
state v = 0
param w = 3
param m = 1
x' = w*v
v' = -w*x/m
step 0.0078125
span 1
"""
DRIVEN = MODEL.replace("-w*x/m", "-w*x/m + cos(w*t)/(3*m)")


def single(value):
    return struct.unpack("f", struct.pack("f", value))[0]


def pair(value):
    return single(value) + single(value - single(value))


WRITTEN = {"w": 2.1, "m": 0.85, "h": 0.01}
# What programs make of them is another FP32 number if it is made of what is written.
assert all(single(made(*WRITTEN.values())) != single(made(*map(single, WRITTEN.values())))
           for made in (lambda w, m, h: 1/m, lambda w, m, h: w/m, lambda w, m, h: h*w, lambda w, m, h: h*w/m, lambda w, m, h: w*w/m))


def states(fp3, folder, *arguments):
    done = subprocess.run([fp3, "run", *map(str, arguments), "-e", "isa", "-n", "100"], cwd=folder, capture_output=True, text=True, check=True, timeout=120)
    found = re.findall(r"^([xv]) +(\S+)", done.stdout, re.M)
    assert len(found) == 2
    return found


def settings(values):
    return [word for name, value in values.items() for word in ("--set", f"{name}={value!r}")]


@pytest.mark.parametrize("text", [MODEL, DRIVEN], ids=["free", "driven"])
@pytest.mark.parametrize("options", [[], ["-k"], ["-i", "stoermer_verlet"], ["-i", "ros2"], ["-i", "cash_karp", "--tolerance", "1e-4", "--until", "1"]], ids=" ".join)
def test_values_that_share_an_fp32_number_give_the_same_bits(fp3, tmp_path, text, options):
    if "stoermer_verlet" in options:
        text = "state x = 1\nstate v = 0\nparam w = 3\nparam m = 1\nx' = v\nv' = -w*w*x/m\nstep 0.0078125\nspan 1\n"
    (tmp_path / "m.ode").write_text(text)
    values = {name: value for name, value in WRITTEN.items() if name != "h" or "--tolerance" not in options}
    near = {name: single(value) for name, value in values.items()}
    assert near != values
    first, second = (states(fp3, tmp_path, "m.ode", "-c", "many_full", "-N", 1, *options, *settings(given)) for given in (values, near))
    assert first == second


def test_double_single_has_two_words_of_them(fp3, tmp_path):
    (tmp_path / "m.ode").write_text(MODEL)
    runs = [states(fp3, tmp_path, "m.ode", "-c", "many_full", "-N", 1, "--double-single", *settings({name: near(value) for name, value in WRITTEN.items()}))
            for near in (float, pair, single)]
    assert runs[0] == runs[1] != runs[2]


@pytest.mark.parametrize("arithmetic", [[], ["--with", "fold-step", "--with", "fold-product"], ["--double-single"]], ids=["plain", "folded", "double-single"])
def test_a_program_and_its_formulas_have_the_same(fp3, tmp_path, arithmetic):
    """The image, with the formulas that the compiler writes for what it is given, runs as the model does."""
    (tmp_path / "m.ode").write_text(DRIVEN)
    subprocess.run([fp3, "compile", "m.ode", *arithmetic, "--image", "m.fp3", "--params", "m.cfg", *settings(WRITTEN), "-c", "many_full"], cwd=tmp_path, check=True)
    image = states(fp3, tmp_path, "m.fp3", "--params", "m.cfg", "-c", "many_full", "-N", 1)
    if "--with" not in arithmetic:              # an option of compile alone
        model = states(fp3, tmp_path, "m.ode", "-c", "many_full", "-N", 1, *arithmetic, *settings(WRITTEN))
        assert [(name, float(x)) for name, x in image] == [(name, float(f"{single(float(x)):.9g}")) for name, x in model]
    if "--double-single" not in arithmetic:     # whose formulas are for the values that were given
        again = settings({name: single(value) for name, value in WRITTEN.items()})
        assert image == states(fp3, tmp_path, "m.fp3", "--params", "m.cfg", "-c", "many_full", "-N", 1, *again)


def test_a_folded_scene_has_the_same(fp3, tmp_path):
    (tmp_path / "m.ode").write_text(DRIVEN)
    found = []
    for near in (float, single):
        values = " ".join(f"{name} = {near(WRITTEN[name])!r};" for name in ("w", "m"))
        (tmp_path / "m.scene").write_text(f'config = "many_full"; engine = "isa"; steps = 100; h = {near(WRITTEN["h"])!r};\n'
                                          f'groups = ( {{ program = "m.ode"; folded = true; objects = 1; set = {{ {values} }}; }} );\n')
        done = subprocess.run([fp3, "run", "--scene", "m.scene"], cwd=tmp_path, capture_output=True, text=True, check=True)
        found.append(re.findall(r"^([xv]) +(\S+)", done.stdout, re.M))
    assert found[0] == found[1] and len(found[0]) == 2


def test_a_start_follows_the_params_that_are_given(fp3, tmp_path):
    (tmp_path / "m.ode").write_text("param g = 9\nparam l = 1\nstate a = 0.5\nstate w = sqrt(g/l)\na' = w\nw' = -(g/l)*sin(a)\nstep 0.0078125\nspan 1\n")

    def starts(*options):
        out = subprocess.run([fp3, "run", "m.ode", "-e", "isa", "-c", "many_full", "-N", "2", "-n", "0", *options], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
        return [float(x) for x in re.findall(r"^w +(\S+)", out, re.M)]
    assert starts() == [3, 3]
    assert starts("--set", "l=4") == [1.5, 1.5]
    assert starts("--spread", "l=1:4") == [3, 1.5]
    assert starts("--set", "l=4", "--set", "w=2") == [2, 2]
    (tmp_path / "m.scene").write_text('config = "many_full"; engine = "isa"; steps = 0;\ngroups = ( { program = "m.ode"; objects = 2; set = { l = 4; }; } );\n')
    out = subprocess.run([fp3, "run", "--scene", "m.scene"], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert re.findall(r"^w +(\S+)", out, re.M) == ["1.5", "1.5"]
    done = subprocess.run([fp3, "run", "m.ode", "-n", "0", "--set", "l=-1"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2 and "'w' is nan: expected a finite number" in done.stderr
