"""fp3/batch.h: the same bits as fp3 run, values that are made of others follow, what cannot be is refused."""

import csv
import os
import struct
import subprocess

import pytest

ARITHMETICS = {"plain": [], "compensated": ["--compensated"], "double_single": ["--double-single"]}
# What is set for all, what is spread over the objects.
MODELS = {"ship": (["m=9.1e5"], ["T=1e5:3e5", "s=0:0.1"]), "oscillator": (["k=0.1"], ["m=0.5:2", "c=0.01:1"]),
          "duffing": ([], ["gamma=0.1:0.3", "w=1:1.5", "x=0.9:1.1"]), "lorenz": (["sigma=9.7"], ["rho=20:28"]),
          "pendulum": (["g=9.8"], ["l=0.5:2", "theta=0.1:3"]), "bouncing_ball": (["g=9.8", "h=0.015625"], ["e=0.7:0.9"]),
          "rigid_body": ([], ["A=0.9:1.1", "B=1.9:2.1"])}


@pytest.fixture(scope="module")
def script(build):
    """What the program prints that obeys these lines."""
    def script(model, lines, *options, status=0):
        done = subprocess.run([build / "tests/batch_script", *map(str, options), str(model)], input="\n".join(lines) + "\n",
                              capture_output=True, text=True, timeout=300)
        assert (done.returncode, done.stderr) == (status, ""), done.stdout + done.stderr
        return done.stdout.splitlines()
    return script


@pytest.fixture(scope="module")
def ran(fp3, tmp_path_factory):
    """Names of the states, and a line for each object, as fp3 run records them in the end."""
    def ran(program, steps, objects, *options):
        out = tmp_path_factory.mktemp("run") / "run.csv"
        done = subprocess.run([fp3, "run", program, "-e", "isa", "-c", "many_full", "-N", str(objects), "-n", str(steps), "--output", out,
                               *options], capture_output=True, text=True, timeout=300)
        assert done.returncode == 0, done.stderr
        head, *rows = list(csv.reader(out.open()))
        columns = [i for i, name in enumerate(head) if name.split(" ")[0] not in ("step", "time", "object", "life")]
        last, number = rows[-objects:], float if "--double-single" in options else single
        return [head[i].split(" ")[0] for i in columns], [[number(float(row[i])) for i in columns] for row in last]
    return ran


def single(value):
    """Nine digits of a CSV are one FP32 number."""
    return struct.unpack("f", struct.pack("f", value))[0]


def numbers(lines):
    return [[float(word) for word in line.split()] for line in lines]


def given(sets, spreads):
    return ([f"set {text.replace('=', ' ')}" for text in sets] +
            [f"spread {text.replace('=', ' ').replace(':', ' ')}" for text in spreads])


def options(sets, spreads):
    return [f"--set={text}" for text in sets] + [f"--spread={text}" for text in spreads]


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
@pytest.mark.parametrize("model", MODELS)
def test_bits_are_those_of_fp3_run(root, script, ran, model, arithmetic):
    program, (sets, spreads) = root / f"programs/{model}.ode", MODELS[model]
    names, rows = ran(program, 70, 7, *options(sets, spreads), *ARITHMETICS[arithmetic])
    read = "wide" if arithmetic == "double_single" else "read"
    for engine in ("fast", "isa"):
        lines = script(program, [*given(sets, spreads), "step 13", "step 57", f"{read} {' '.join(names)}"], "-n", 7, "-a", arithmetic, "-e", engine)
        assert numbers(lines) == rows, engine
    assert len({tuple(row) for row in rows}) > 1


def test_numbers_of_the_model(root, script, ran, tmp_path):
    """What is made of no value at all is an input, too."""
    (tmp_path / "m.ode").write_text("model m\nstate x = 1\nstate y = 0\nstep 0.01\nspan 1\nx' = y - 8/3*x\ny' = 28/9 - x*y\n")
    names, rows = ran(tmp_path / "m.ode", 30, 2)
    assert numbers(script(tmp_path / "m.ode", ["step 30", "read x y"], "-n", 2)) == rows


@pytest.mark.parametrize("integrator", ["euler", "leapfrog", "stoermer_verlet", "rk6"])
def test_integrators(root, script, ran, integrator):
    model = "pendulum" if integrator == "stoermer_verlet" else "oscillator"
    program, (sets, spreads) = root / f"programs/{model}.ode", MODELS[model]
    names, rows = ran(program, 40, 5, *options(sets, spreads), "-i", integrator)
    assert numbers(script(program, [*given(sets, spreads), "step 1", "step 39", f"read {' '.join(names)}"], "-n", 5, "-i", integrator)) == rows


def test_folded(root, fp3, script, ran, tmp_path):
    program, sets = root / "programs/oscillator.ode", ["k=3.1", "m=1.7", "h=0.013"]
    subprocess.run([fp3, "compile", program, "-c", "many_full", "--with=fold-step", "--with=fold-product", *options(sets, []), "--image",
                    tmp_path / "f.fp3", "--params", tmp_path / "f.cfg"], check=True)
    _, rows = ran(tmp_path / "f.fp3", 400, 2, "--params", tmp_path / "f.cfg", "--observe=v,x")
    lines = [*given(sets, []), "step 400", "read v x"]
    assert numbers(script(program, lines, "-n", 2, "-a", "folded")) == rows
    assert numbers(script(program, lines, "-n", 2)) != rows


STARTS = "param a = 2\nparam b = 3\nparam c = 0.1\nstate x = a*b + 0.1\nstate y = b\nstate z = 7\nstep 0.125\nx' = -c*x\ny' = -y\nz' = b - z\n"


@pytest.mark.parametrize("engine", ["fast", "isa", "rtl"])
def test_starts_follow_params(script, ran, tmp_path, engine):
    """As with --set, before the first step and after a restart; a start that is written follows no more."""
    (tmp_path / "m.ode").write_text(STARTS)

    def told(*lines, objects=3):
        return numbers(script(tmp_path / "m.ode", [*lines], "-n", objects, "-e", engine))

    def run(*options, steps=4):
        return ran(tmp_path / "m.ode", steps, 3, *options)[1]
    spread, same = ["--spread=a=0.3:0.7", "--set=b=0.7"], ["spread a 0.3 0.7", "set b 0.7"]
    assert told(*same, "step 4", "read x y z") == run(*spread) != run()
    assert told(*same, "read x")[1] == [single(0.5 * single(0.7) + 0.1)]
    assert told("step 2", *same, "restart", "step 4", "read x y z") == run(*spread)
    assert told("set x 5", *same, "set y 6", "step 4", "read x y z") == run(*spread, "--set=x=5", "--set=y=6")
    assert told("set c 0.2", "set z 1", "read x y z") == [[single(6.1), 3, 1]] * 3
    some = told("write x 1 5", *same, "write y 0 8 9", "step 2", "restart", "read x y", "set b 0.5", "read x y")
    assert some == [[single(0.3 * single(0.7) + 0.1), 8], [5, 9], [single(single(0.7) * single(0.7) + 0.1), single(0.7)],
                    [single(single(0.3) * 0.5 + 0.1), 8], [5, 9], [single(single(0.7) * 0.5 + 0.1), 0.5]]


@pytest.mark.parametrize("arithmetic", ["compensated", "double_single"])
def test_starts_follow_params_in_two_words(script, ran, tmp_path, arithmetic):
    (tmp_path / "m.ode").write_text(STARTS)
    rows = ran(tmp_path / "m.ode", 5, 600, "--spread=a=0.3:0.7", "--set=b=0.7", *ARITHMETICS[arithmetic])[1]
    lines = ["spread a 0.3 0.7", "set b 0.7", "step 5", f"{'wide' if arithmetic == 'double_single' else 'read'} x y z"]
    assert numbers(script(tmp_path / "m.ode", lines, "-n", 600, "-a", arithmetic)) == rows


def test_the_hardware_gives_the_same(root, script):
    program, (sets, spreads) = root / "programs/ship.ode", MODELS["ship"]
    lines = [*given(sets, spreads), "step 5", "write T 1 2e5", "set m 8e5", "step 5", "read v s T"]
    assert script(program, lines, "-n", 6, "-e", "rtl") == script(program, lines, "-n", 6)


def test_values_that_change_on_the_way(root, script, ran):
    """As runs of their own, each of which begins where the one before has ended."""
    program = root / "programs/oscillator.ode"
    lines = script(program, ["spread m 0.5 2", "step 10", "read v x", "double m 1 0.1 0.3", "set h 0.01", "write c 3 0.25", "step 10", "read v x",
                             "double x 2 0.3", "set k 7", "step 10", "read v x m c k h"], "-n", 4)
    m, c, h = [0.5, 1.0, 1.5, 2.0], [0.5] * 4, 0.0078125
    at = [[0, 1]] * 4
    for part, k in enumerate((40, 40, 7)):
        if part == 1:
            m[1:3], c[3], h = [0.1, 0.3], 0.25, 0.01
        if part == 2:
            at[2] = [at[2][0], 0.3]
        at = [ran(program, 10, 1, *[f"--set={name}={value!r}" for name, value in zip("mckhvx", (m[i], c[i], k, h, *at[i]))])[1][0] for i in range(4)]
        assert [row[:2] for row in numbers(lines[4 * part:4 * part + 4])] == at, part


def test_only_what_has_changed_is_computed_again(root, script):
    """A value that is refused is another object's affair: until it is mended nothing runs, then all goes on."""
    lines = ["spread m 1 4", "step 5", "write m 2 0", "step 5", "read v x", "write m 2 3", "step 5", "read v x"]
    told = script(root / "programs/oscillator.ode", lines, "-n", 4)
    assert told[0] == "error 1: object 2: 1/m (line 17 of the model) is inf: expected a finite number"
    assert told[5:] == script(root / "programs/oscillator.ode", ["spread m 1 4", "step 5", "step 5", "read v x"], "-n", 4)
    assert told[1:5] == script(root / "programs/oscillator.ode", ["spread m 1 4", "step 5", "read v x"], "-n", 4)


@pytest.mark.parametrize("count", [1, 63, 64, 65, 511, 512, 513, 1025])
def test_any_number_of_objects(root, script, count):
    """Each one is as if it were alone, also where only some have changed."""
    program = root / "programs/oscillator.ode"
    some = sorted({0, count // 3, count // 2, count - 1})
    lines = ["spread m 1 4", "step 2", *[f"double m {i} {1 + i / 7}" for i in some], *[f"write x {i} {i % 5}" for i in some], "step 3", "read v x m"]
    rows = numbers(script(program, lines, "-n", count))
    for i in some:
        start = 1 if count == 1 else (1 - i / (count - 1)) + i / (count - 1) * 4
        alone = script(program, [f"set m {start!r}", "step 2", f"set m {1 + i / 7!r}", f"set x {i % 5}", "step 3", "read v x m"])
        assert numbers(alone) == [rows[i]], i


def test_a_block_is_computed_as_its_objects_are(root, script):
    """One of them comes below the start of double on the way: the others keep their bits, and if it matters it is named."""
    model = ("model m\nparam a = 2\nparam b = 3\nparam c = 1\nstate x = 1\nstep 0.1\nspan 1\n"
             "x' = (c + a*b)*x/(b + 1) - cos(a)*exp(-b) + max(sqrt(b + 1), c - a)\n")
    some = [(3, 1e-200, 3e-200), (7, 0.1, 0.7), (11, 1.7, 1e-9), (600, 0, 1e-300), (601, 2.5, 2)]
    lines = [f"double {name} {i} {value}" for i, *values in some for name, value in zip("ab", values)]
    told = script(model, [*lines, "set c 0", "double a 599 1e-200", "double b 599 1e-200", "double b 3 800", "step 1", "double b 3 3e-200", "set c 0.3",
                          "step 7", "read x"], "-n", 700, "-x")
    assert told[0].startswith("error 1: object 3: ") and "none below 2.2e-308 on the way" in told[0]
    rows = numbers(told[1:])
    for i, a, b in [*some, (5, 2, 3), (599, 1e-200, 1e-200)]:
        assert numbers(script(model, [f"set a {a}", f"set b {b}", "set c 0.3", "step 7", "read x"], "-x")) == [rows[i]], i


def test_restart_and_time(root, script):
    told = script(root / "programs/oscillator.ode", ["spread x 1 2", "step 8", "time", "set h 0.25", "step 2", "time", "read x", "restart", "time",
                                                     "read x", "step 8", "time", "set h 0.0078125", "restart", "step 8", "read x v"], "-n", 3)
    assert told[:2] == ["0.0625", "0.5625"] and told[5:9] == ["0", "1", "1.5", "2"] and told[9] == "2"
    assert told[10:] == script(root / "programs/oscillator.ode", ["spread x 1 2", "step 8", "read x v"], "-n", 3)


@pytest.mark.parametrize("engine", ["fast", "isa", "rtl"])
@pytest.mark.parametrize("model, names", [("oscillator", "x v m"), ("duffing", "x v steps")])
def test_objects_that_come_and_go(root, script, model, names, engine):
    """Who is removed makes no step. Who is born has the lowest number and the defaults, and begins anew."""
    lines = ["spread x 1 2", "remove 4 1", "step 5", f"read {names}", "add 1", "write x 1 9", "step 4", f"read {names}", "add 2", "numbers", "add 1", "remove 1", "remove 6 6",
             "remove 0 2 3 5 6 7", "step 2", "add 2", "numbers", "restart", "step 3", f"read {names}", "failure", "remove 8 9", "step 1", "failure"]
    program = root / f"programs/{model}.ode"

    def ran(*lines):
        return script(program, [*lines, f"read {names}"], "-n", 6)
    told = script(program, lines, "-n", 6, "-e", engine)
    old, new = ran("spread x 1 2", "step 9"), ran("write x 0 9", "step 4")
    assert [told[i] for i in (0, 2, 3, 5)] == [ran("spread x 1 2", "step 5")[i] for i in (0, 2, 3, 5)]
    assert [told[6 + i] for i in (0, 1, 2, 3, 5)] == [old[0], new[0], old[2], old[3], old[5]]
    assert told[12:16] == ["error 3: 2 more objects: 5 of 6 live, and there is room for 1", "0 -1 2 3 -1 5 1", "0 6 2 3 -1 5", "5"]
    assert told[16].endswith("its object, number 1, was removed, and another object has its number") and told[17].endswith("object 1 occurs twice")
    assert told[18:21] == ["-1 -1 -1 -1 -1 -1 -1 -1 0 1", "8 9 -1 -1 -1 -1", "2"]
    assert told[21:23] == ran("step 3")[:2] and told[27:] == ["0 failed: "]*2


def test_who_is_removed_does_not_fail(script):
    model = "model m\nparam k = 0.01\nstate x = 1\nstep 1\nspan 1\nx' = k*x*x\n"
    lines = ["write k 1 1e9", "write k 3 1e9", "remove 3", "step 2", "failure", "remove 1", "failure", "step 2", "failure", "add 2", "step 1", "failure", "read k"]
    told = script(model, lines, "-n", 6, "-x")
    assert told == [f"1 failed: {told[0].split(': ', 1)[1]}", "error 1: no complete run since the last write or load", "0 failed: ", "0 failed: ", *[told[4]]*6]
    assert told[0].startswith("1 failed: object 1 in step ") and single(float(told[4])) == single(0.01)
    assert told == script(model, lines, "-n", 6, "-x", "-e", "isa") == script(model, lines, "-n", 6, "-x", "-e", "rtl")


def test_adaptive_objects_that_come_and_go(root, script):
    lines = ["spread r_x 0.4 0.6", "set until 1", "step 100000", "remove 1", "set until 2", "step 100000", "add 1", "write until 1 1", "write r_x 1 0.5", "step 100000", "read t r_x v_y"]
    told = script(root / "programs/kepler.ode", lines, "-n", 3, "-t", 1e-4)
    others = script(root / "programs/kepler.ode", ["spread r_x 0.4 0.6", "set until 1", "step 100000", "read t r_x v_y", "set until 2", "step 100000", "read t r_x v_y"], "-n", 3, "-t", 1e-4)
    assert told == [others[3], others[1], others[5]] == script(root / "programs/kepler.ode", lines, "-n", 3, "-t", 1e-4, "-e", "isa")


def test_a_text_and_a_compiled_program(root, script):
    lines = [*given(*MODELS["oscillator"]), "step 9", "read v x"]
    program = root / "programs/oscillator.ode"
    assert script(program, lines, "-n", 3) == script(program.read_text(), lines, "-n", 3, "-x") == script(program, lines, "-n", 3, "-m", "many_full")


def test_a_program_for_one_object_refuses_a_param_of_each_object(root, script):
    """Registers run short, so its params are constants, which a group of objects has once."""
    program, lines = root / "tests/ode/large/three_in_space.ode", ["set m1 1.5", "step 9", "read v1_x r3_z"]
    told = script(program, ["write m1 1 1.5", "step 9", *lines], "-n", 3, "-m", "single_full")
    assert told[0] == "error 1: 'm1' differs between objects: the program was compiled for one object"
    assert told[1:] == script(program, lines, "-n", 3)


def test_assembly(root, script, ran):
    program = root / "programs/ship.s"
    values = [f"{name}={0.1 + i / 16}" for i, name in enumerate(["v", "s", "T", "C", "rm", "h"])]
    states, rows = ran(program, 12, 2, *options(values, []))
    assert numbers(script(program, [*given(values, []), "step 12", f"read {' '.join(states)}"], "-n", 2)) == rows


def test_adaptive_steps(root, script, ran):
    program = root / "programs/kepler.ode"
    names, rows = ran(program, 1000000, 3, "--tolerance=1e-4", "--spread=r_x=0.4:0.6", "--until=3", "--times=3")
    lines = script(program, ["spread r_x 0.4 0.6", "set until 3", "step 1000000", f"wide {' '.join(names)}"], "-n", 3, "-t", 1e-4)
    assert [list(map(single, row)) for row in numbers(lines)] == [list(map(single, row)) for row in rows]
    lines = script(program, ["set until 1.5", "step 1000000", "read t", "set until 3", "step 1000000", "read t", "set until 1", "set tolerance 0",
                             "step 1"], "-t", 1e-4)
    assert lines[:2] == ["1.5", "3"] and "'tolerance' is 0" in lines[2]


def test_fixed_steps_that_are_cut_at_events(script):
    """Frames of a game: each object bounces where it meets the floor. h may be changed between frames."""
    ball = "param e = 0.8\nstate v = 0\nstate x = 1\nx' = v\nv' = -9.81\nwhen root(x) falling: x = 0, v = -e*v\nstep 0.0078125\n"
    frames = [line for i in range(1, 61) for line in (f"set until {i / 60}", "step 1000")]
    lines = ["spread x 0.5 1.5", *frames, "read x", "set h 0.03125", "set until 1.5", "step 1000", "read x"]
    told = numbers(script(ball, lines, "-n", 3, "-t", 0, "-x"))

    def flight(x, until, e=0.8, g=9.81):
        t, v = (2*x/g)**0.5, (2*x*g)**0.5*e
        while t + 2*v/g < until:
            t, v = t + 2*v/g, v*e
        return (until - t)*v - g/2*(until - t)**2
    for objects, until in ((told[:3], 1), (told[3:], 1.5)):
        assert [row[0] for row in objects] == pytest.approx([flight(x, until) for x in (0.5, 1, 1.5)], abs=2e-6)
    assert told == numbers(script(ball, lines, "-n", 3, "-t", 0, "-x", "-e", "isa"))


@pytest.mark.parametrize("line, message", [
    ("set mass 1", "the model has no 'mass'"),
    ("set omga 1", "the model has no 'omga'; did you mean 'omega'?"),
    ("read theta omeg", "the model has no 'omeg'; did you mean 'omega'?"),
    ("write thet 0 1", "the model has no 'thet'; did you mean 'theta'?"),
    ("write l 3 1", "object 3, count 1: there are 3 objects"),
    ("write l 2 1 1", "object 2, count 2: there are 3 objects"),
    ("write theta 18446744073709551615 1 1", "object 18446744073709551615, count 2: there are 3 objects"),
    ("write g 0 9", "'g' is one number for all objects"),
    ("set l nan", "'l' is nan: expected a finite number"),
    ("set theta inf", "'theta' is inf: expected a finite number"),
    ("write l 1 1 -inf", "object 2: 'l' is -inf: expected a finite number"),
    ("write theta 1 nan", "object 1: 'theta' is nan: expected a finite number"),
    ("set h 0", "'h' is 0: expected a time step"),
    ("set h -1", "'h' is -1: expected a time step"),
    ("set h nan", "'h' is nan: expected a finite number"),
    ("set h 1e39", "'h' is 1e+39: expected a time step"),
    ("step 4294967296", "4294967296 steps: a run has 4294967295 at most"),
])
@pytest.mark.parametrize("engine", ["fast", "isa"])
def test_what_is_refused_changes_nothing(root, script, line, message, engine):
    told = script(root / "programs/pendulum.ode", ["step 3", line, "read omega theta l", "step 3", "read omega theta l"], "-n", 3, "-e", engine)
    assert told[0].startswith(f"error 1: {message[:20]}") and message.split(":")[-1].split(" is ")[-1] in told[0]
    good = script(root / "programs/pendulum.ode", ["step 3", "read omega theta l", "step 3", "read omega theta l"], "-n", 3, "-e", engine)
    assert told[1:] == good


def test_who_names_a_vector_is_told_its_first_component(root, script):
    assert script(root / "examples/drone.ode", ["set F 1"]) == ["error 1: the model has no 'F'; did you mean 'F_x'?"]


def test_the_ends_of_fp32(root, script):
    """Rounded once: what becomes an infinity is refused, the last that does not is taken; what is given and too small becomes 0."""
    model = "model m\nparam l = 1\nparam k = 2\nstate x = 0\nstate v = 0\nstep 1\nspan 1\nx' = v\nv' = l*k - x\n"
    for line, expected in (("l 1 1e-46", None), ("l 1 4e-46", None), ("l 1 1.7e38", None), ("l 1 1.8e38", "object 1: l*k"),
                           ("x 0 1e39", "object 0: x at the start"), ("v 1 7e-46", None), ("v 1 7.1e-46", None)):
        told = script(model, [f"double {line}", "step 1"], "-n", 2, "-x")
        assert not told if expected is None else len(told) == 1 and f"error 1: {expected}" in told[0] and "FP32" in told[0], told
    # What moves, and what nothing is made of, is rounded at once.
    told = script(model, ["step 1", "double x 1 1e39", "double x 1 -1e-46", "read x", "double x 1 3e38", "read x"], "-n", 2, "-x")
    assert told[0].split(": expected")[0] == "error 1: object 1: 'x' is 1e+39"
    assert told[2] == "-0" and numbers(told[3:])[1] == [single(3e38)]
    # A constant of nature does not silently become 0.
    told = script("model m\nparam l = 1e-50\nstate x = 1\nstep 1\nspan 1\nx' = x*l\n", ["step 1"], "-n", 2, "-x")
    assert len(told) == 1 and told[0].startswith("error 1: 'l' is 1e-50: expected 0 or a number above"), told


@pytest.mark.parametrize("engine", ["fast", "isa", "rtl"])
def test_columns_lie_beside_each_other(script, root, engine):
    """x y z of each object with two numbers between, which stay; both ways, for states and a param."""
    model, names = root / "programs/lorenz.ode", "x y z rho"
    lines = ["spread x 0.9 1.1", "spread rho 20 28", "step 5"]
    plain = numbers(script(model, [*lines, f"read {names}"], "-n", 3, "-e", engine))
    told = numbers(script(model, [*lines, f"beside 6 {names}", f"move 4 {names}", f"read {names}"], "-n", 3, "-e", engine))
    assert told[:3] == [[*row, -7, -7] for row in plain] and plain[0] != plain[1]
    assert told[3:] == [plain[1], plain[2], plain[2]]
    assert script(model, ["beside 3 x y z rho"], "-n", 3, "-e", engine)[0] == "error 1: stride 3: expected at least 4, one for each name"
    assert script(model, ["beside 2 x q"], "-n", 3, "-e", engine)[0].startswith("error 1: the model has no 'q'")


STICK = "model m\nparam steer = 1\nparam m = 8e5\nstate x = 0\nstep 0.015625\nspan 1\nx' = steer*steer/m - {0}steer*x\n"


@pytest.mark.parametrize("own", ["", "0*"])
def test_a_value_that_decays_ends_at_zero(script, own):
    """Through all small numbers of FP32 and of double, also where only what is computed from it is in the program. Params of common size
    whose product is too small are refused."""
    decay = [f"1e{power}" for power in (-3, -17, -20, -37, -39, -44, -46, -60, -155, -200, -307, -310)]
    lines = [line for value in decay for line in (f"double steer 1 -{value}", "step 1", "read steer")]
    told = script(STICK.format(own), lines, "-n", 2, "-x")
    assert [single(float(word)) for word in told[1::2]] == [-single(float(value)) for value in decay]
    assert "expected 0 or" in script(STICK.format(own).replace("steer = 1", "steer = 1e-20"), ["double steer 1 1e-21", "step 1"], "-n", 2, "-x")[0]


def test_a_step_in_which_objects_fail_says_so(root, script):
    """In this step and in those that follow, as long as somebody has failed; all steps are made. With may_fail it does not."""
    model = "model m\nparam k = 2\nstate x = 1\nstep 1\nspan 1\nx' = k*x*x\n"
    lines = ["write k 2 1e6", "step 2", "read x", "step 7", "step 1", "read x", "remove 2 3", "step 1", "set k 0", "restart", "add 2", "set k 0", "step 1", "read x"]
    for engine in ("fast", "isa"):
        told = script(model, lines, "-n", 4, "-x", "-i", "euler", "-f", "-e", engine)
        assert told[:2] == ["21", "21"] and told[3:5] == ["21", "error 6: 4 of 4 objects failed, first object 2 in step 3: overflow"]
        assert told[5] == "error 6: 4 of 4 objects failed, first object 0 before its first step: state x is infinite"
        assert told[6:] == ["inf"] * 4 + [told[5].replace("4", "2")] + ["1"] * 4
        quiet = script(model, lines, "-n", 4, "-x", "-i", "euler", "-e", engine)
        assert quiet == [line for line in told if "error" not in line]


def test_a_step_of_a_few_attempts_has_not_failed(script):
    """A loop goes on until all have reached `until`. Who is stuck, or has a state that is not finite on its way, has failed."""
    model = "model m\nparam k = 0\nstate x = 1\nstep 0.125\nspan 1\nx' = k*x*x\n"
    lines = ["set until 40", *["step 2", "read t"]*2, "step 100", "read t", "write k 1 1", "set until 90"]
    told = script(model, [*lines, "step 2", "failure", "step 200", "failure"], "-n", 2, "-x", "-t", 1e-4, "-f")
    assert told[0] == told[1] != told[2] == told[3] != told[4] == told[5] == "40" and told[6] == "0 failed: ", told
    assert told[7] == "error 6: 1 of 2 objects failed, first " + told[8].removeprefix("1 failed: ") and told[8].endswith("too short to change t"), told
    cut = script(model, ["set until 64", "write k 1 1e30", "step 4", "failure"], "-n", 2, "-x", "-t", 0, "-f", "-i", "euler")
    assert cut[0].startswith("error 6: 1 of 2 objects failed, first object 1 ") and cut[0].endswith("state x is not finite"), cut


def test_a_start_of_40_nested_products_opens_at_once(script):
    """Each component of a product is in two of the next one: there are 2^40 ways through them."""
    model = f"param a = 1\nstate x[3] = {'cross((0, 0, 1), '*40}(a, 0, 0){')'*40}\nstep 0.125\nspan 1\nx' = -x\n"
    assert script(model, ["read x_x", "set a 0", "step 1", "read x_x"], "-n", 2, "-x") == ["1", "1", "0", "0"]


def test_who_failed(root, script):
    told = script("model m\nparam k = 2\nstate x = 1\nstep 1\nspan 1\nx' = k*x*x\n", ["write k 2 1e6", "step 9", "failure"], "-n", 4, "-x")
    assert told[0].startswith("4 failed: object 2 in step ") and told[0].endswith("overflow"), told


def test_a_step_that_is_counted_or_kept_is_not_changed(root, script):
    told = script(root / "programs/duffing.ode", ["set h 0.01", "step 1", "set h 0.02", "restart", "set h 0.02", "step 1", "time"])
    assert len(told) == 2 and "the equations have t" in told[0] and told[1] == "0.02"
    told = script(root / "programs/pendulum.ode", ["step 1", "set h 0.02", "set theta 3", "write omega 0 1", "set l 3", "step 1"], "-i", "stoermer_verlet")
    assert len(told) == 3 and "one step before" in told[0] and "'theta'" in told[1] and "'omega'" in told[2]


@pytest.mark.parametrize("options, message", [
    (["-n", 0], "0 objects"), (["-n", 1 << 26], "67108864 objects"), (["-n", 1 << 33], "8589934592 objects"), (["-e", "quick"], "no engine 'quick'"),
    (["-c", "manny"], "manny"), (["-i", "rk5"], "rk5"), (["-h", "-1"], "expected a time step"), (["-n", 2, "-c", "single_full"], "room for 1 object")])
def test_what_cannot_be_opened(root, script, options, message):
    told = script(root / "programs/oscillator.ode", ["read x"], *options, status=1)
    assert len(told) == 1 and told[0].startswith("error ") and message in told[0]


def test_a_model_with_an_error_has_its_place(script, root):
    assert script("model m\nstate x = 0\nstep 1\nx' = y\n", [], "-x", status=1)[0].startswith("error 2: text:")
    assert "none.ode" in script(root / "none.ode", [], status=1)[0]


WORK = ["spread m 0.5 2", "step 700", "read x v", "set k 0.2", "step 700", "read x v"]


def test_threads_and_memory_of_the_caller_change_no_bit(root, script):
    model, objects = root / "programs/oscillator.ode", ("-n", 6000, "-j", 3)
    assert script(model, WORK, *objects, "-o") == script(model, WORK, *objects)


def test_native_code_from_a_file_changes_no_bit(root, fp3, script, tmp_path):
    model, objects, native = root / "programs/oscillator.ode", ("-n", 600), tmp_path / "oscillator.native"
    subprocess.run([fp3, "compile", model, "-i", "rk4", "-c", "many_full", "--native", "-o", native], check=True, capture_output=True, timeout=300)
    assert script(model, WORK, *objects, "-N", native) == script(model, WORK, *objects)
    told = script(root / "programs/ship.ode", ["read s"], *objects, "-N", native, status=1)
    assert len(told) == 1 and "another program" in told[0]


def test_two_threads(build, root):
    done = subprocess.run([build / "tests/batch_threads", root / "programs/oscillator.ode", "m", "x"], capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.long
def test_two_threads_under_the_thread_sanitizer(root):
    env = {name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL", "FP3_BUILD")}
    program = "build-tsan/tests/batch_threads"
    subprocess.run(["make", "-C", root, "SAN=thread", program], env=env, check=True, capture_output=True, timeout=3000)
    done = subprocess.run([root / program, root / "programs/oscillator.ode", "m", "x"], env=env, capture_output=True, text=True, timeout=600)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


LOOKS = ["spread m 0.5 2", "write c 1 0.25", "column x", "step 3", "column x", "read x", "write x 2 0.5", "column x", "read x"]


@pytest.mark.parametrize("arithmetic", ["plain", "compensated"])
def test_a_column_is_where_the_objects_are(root, script, arithmetic):
    """Without a copy it has what a copy has: starts before the first step, then what the steps and the caller have left."""
    told = script(root / "programs/oscillator.ode", LOOKS, "-n", 5, "-a", arithmetic)
    start, moved, copied, written, again = (told[5 * i:5 * i + 5] for i in range(5))
    assert start == ["1"] * 5 and moved == copied != start and len(set(moved)) == 5
    assert written == again and written[2] == "0.5"
    assert script(root / "examples/drone.ode", ["write F_x 1 0.5", "column F_x"], "-n", 3) == ["0", "0.5", "0"]
    assert script(root / "programs/oscillator.ode", ["column m"], "-n", 3) == ["none"], "the program has 1/m alone"


def test_where_there_is_no_column(root, script):
    program = root / "programs/oscillator.ode"
    lines = ["column x"]
    assert script(program, lines, "-n", 3, "-e", "isa") == ["none"] and script(program, lines, "-n", 3, "-a", "double_single") == ["none"]
    assert script(root / "programs/kepler.ode", ["column mu", "column h"], "-n", 3) == ["none", "none"], "what all share"
    assert script(program, ["column y"], "-n", 3)[0].startswith("error 1: the model has no 'y'")
    assert "1/m" in script(program, ["write m 1 0", "column x"], "-n", 3)[0]


SEEN = "param k = 4\nstate x = 0\nstate v = 0\n{relation}\n{rest}\nstep 0.03125\nx' = v\nv' = {term}\n"
NEAR = "near ties(x, 0.6)", "sum(o in ties: k*(x - o.x))"


def seen(tmp_path, relation, term, rest=""):
    path = tmp_path / "seen.ode"
    path.write_text(SEEN.format(relation=relation, term=term, rest=rest))
    return path


@pytest.mark.parametrize("method", ["semi_implicit_euler", "leapfrog"])  # one phase a step, and two: in another column after each step, or not
@pytest.mark.parametrize("relation, term", [NEAR, ("all ties", NEAR[1])])
def test_a_column_of_objects_that_see_each_other_is_asked_for_again(tmp_path, script, method, relation, term):
    lines = ["spread x 0 2", "column x", "step 1", "column x", "read x", "column k", "step 2", "column x", "read x", "column v", "read v", "write x 1 7",
             "column x", "restart", "column x", "step 3", "column v", "read v"]
    told = script(seen(tmp_path, relation, term), lines, "-n", 5, "-i", method)
    start, one, one_read, k, three, three_read, v, v_read, written, again, last, last_read = (told[5 * i:5 * i + 5] for i in range(12))
    assert start == again == ["0", "0.5", "1", "1.5", "2"] and k == ["4"] * 5
    assert one == one_read and three == three_read and v == v_read == last == last_read and len({tuple(x) for x in (start, one, three)}) == 3
    assert written == three[:1] + ["7"] + three[2:]


def test_objects_in_another_order_have_no_column(tmp_path, script):
    """Those who do not live, lists of many, and sleep."""
    near = seen(tmp_path, *NEAR)
    assert script(near, ["spread x 0 2", "step 1", "remove 1", "step 1", "column x"], "-n", 3)[-1] == "none"
    for count, is_there in ((256, True), (257, False)):
        told = script(near, ["spread x 0 100", "step 1", "column x", "read x"], "-n", count)
        assert told[:-count] == (told[-count:] if is_there else ["none"]), count
    assert script(seen(tmp_path, *NEAR, rest="rest when abs(v) < 0.1 for 0.5"), ["step 1", "column x"], "-n", 3) == ["none"]
