"""t in equations: right at every stage of every integrator, counted exactly, and refused where FP32 ends."""
import json
import os
import re
import struct
import subprocess

import pytest
from runs import BUILD, fp3, number

RUNGE_KUTTA = ["euler", "midpoint", "heun", "ralston3", "rk4", "rk38", "dopri5", "rk6", "rk8"]
MOVERS = ["rk4_paper", "semi_implicit_euler", "verlet", "leapfrog", "forest_ruth", "pefrl", "yoshida6", "blanes_moan6", "stoermer_verlet"]
MOST = 2**24

# x = 1/(1 + t^2): no function that the hardware approximates.
WITCH = """state v = 0
state x = 1
x' = v
v' = 8*t^2*x^3 - 2*x^2
exact x = 1/(1 + t^2)
exact v = -2*t/(1 + t^2)^2
invariant one = x*(1 + t^2)
step 0.03125
span 2
"""
# One state; t alone, in a definition, with states and without.
DRIVEN = """param a = 0.5 [1/s]
state y = 0.25
state z = 0 [s]
drive = a*t - (a*t)^2/8
y' = a*(drive - y) - 1e-3*t*y*a^2
z' = t*a
exact z = z(0) + a*t^2/2
step 0.0625 [s]
span 4 [s]
"""
SOLO = """state y = 0
y' = 100*(t - y)
step 0.01
"""


def ends(*arguments):
    """The bits that a run ends with, by name and object."""
    out = fp3("run", *arguments).stdout
    return {(name, int(number)): bits
            for name, bits, number in re.findall(r"^(\w+) +\S+ +(0x[0-9a-f]{8}) +object (\d+)$", out, re.M)}


def f32(x):
    return struct.unpack("<f", struct.pack("<f", x))[0]


def rows(path, tmp_path, *arguments):
    fp3("compare", path, *arguments, "--json", tmp_path / "rows.json")
    return {(row["integrator"], row["arithmetic"]): row for row in json.loads((tmp_path / "rows.json").read_text())["rows"]}


# ---- every stage of every integrator ----

@pytest.mark.parametrize("integrator", RUNGE_KUTTA + MOVERS)
def test_the_order_holds_for_equations_with_t(written, tmp_path, integrator):
    """Nodes off by a tenth of a step leave order 1."""
    row = rows(written(WITCH), tmp_path, "--quick", "--most-steps", 1024, "-i", integrator)[integrator, "plain"]
    short = 0.7 if integrator == "rk8" else 0.15  # two steps longer it diverges, two shorter there is only noise
    assert row["order"] - short <= row["finest_order"] <= row["order"] + 0.9, row  # dopri5: 5.8, its last errors are small


@pytest.mark.parametrize("integrator", ["rk4", "dopri5", "rk4_paper", "pefrl", "stoermer_verlet"])
def test_every_engine_has_the_bits_of_the_equations(written, tmp_path, integrator):
    free = re.sub("exact.*\n", "", WITCH)  # objects start elsewhere, where its closed form does not hold
    found = rows(written(free if integrator in MOVERS else DRIVEN), tmp_path, "--most-steps", 8, "-i", integrator)
    assert found and all(row["mismatches"] == 0 < row["compared"] for row in found.values())


def test_only_what_needs_it_counts(written):
    path = written("state a = 1\nstate b = 1\na' = -a\nb' = t\nstep 1")
    assert "steps" in fp3("compile", path).stdout
    for_a = fp3("compile", path, "--observe", "a").stdout
    assert "steps" not in for_a.split("\n\n", 1)[1] and "time step" in for_a
    assert "steps" in fp3("compile", path, "--observe", "a", "--without", "dead").stdout


# ---- many objects, visits, long runs ----

@pytest.mark.parametrize("engine", ["isa", "rtl"])
@pytest.mark.parametrize("integrator", ["rk4", "verlet"])
def test_visits_and_runs_change_no_bit(written, engine, integrator):
    path = written(WITCH)
    whole = ends(path, "-i", integrator, "-c", "many_full", "-N", 40, "--all", "-n", 12, "-e", "isa")
    assert {number(bits) for (name, _), bits in whole.items() if name == "steps"} == {12.0} and len(whole) == 3 * 40
    assert ends(path, "-i", integrator, "-c", "many_full", "-N", 40, "--all", "-n", 12, "-e", engine, "--visit", 5) == whole


def test_a_million_steps(written):
    """A sum of a million steps of 0.01 in FP32 would be off by a percent."""
    end = ends(written(SOLO), "-i", "euler", "-n", 10**6, "-e", "isa")
    assert number(end["steps", 0]) == 10**6
    t = 10**6 * f32(0.01)
    assert abs(number(end["y", 0]) - (t - f32(0.01))) <= 2 * 2**-24 * 2**14


@pytest.mark.parametrize("n", [0, 1, 3, 999_999, 12_345_677, MOST - 1, -5, -MOST])
def test_t_is_the_product_rounded_once(written, n):
    path = written("state y = 0\ny' = t\nstep 0.01")
    end = ends(path, "-i", "euler", "-e", "isa", "-n", 1, "--set", f"steps={n}")
    assert number(end["steps", 0]) == n + 1
    assert number(end["y", 0]) == f32(f32(0.01) * f32(n * f32(0.01)))


def test_a_run_may_begin_where_another_ended(written):
    path = written(DRIVEN)
    whole = ends(path, "-n", 30, "-e", "isa")
    half = ends(path, "-n", 13, "-e", "isa")
    values = [word for name in ("y", "z") for word in ("--set", f"{name}={number(half[name, 0]):.9g}")]
    assert ends(path, "-n", 17, "-e", "isa", "--set", "steps=13", *values) == whole


# ---- where it ends ----

LIMIT = "the program counts its steps in FP32, which ends at 16777216"


@pytest.mark.parametrize("engine", ["isa", "rtl"])
@pytest.mark.parametrize("config", ["single_full", "many_full"])
def test_more_steps_than_fp32_counts_are_refused(written, engine, config):
    path, run = written(SOLO), ("run", "-e", engine, "-c", config)
    refused = fp3(*run, path, "-n", MOST + 1, status=2)
    assert LIMIT in refused.stderr and refused.stdout == ""
    assert LIMIT in fp3(*run, path, "-n", 8, "--set", f"steps={MOST - 7}", status=2).stderr
    end = ends(path, "-e", engine, "-c", config, "-n", 7, "--set", f"steps={MOST - 7}")
    assert number(end["steps", 0]) == MOST


def test_an_image_knows_it_too(written, tmp_path):
    image, params = tmp_path / "m.fp3", tmp_path / "m.cfg"
    fp3("compile", written(SOLO), "-c", "single_full", "--image", image, "--params", params)
    run = ("run", image, "-c", "single_full", "-e", "isa", "--params", params)
    assert LIMIT in fp3(*run, "-n", MOST + 1, status=2).stderr
    assert LIMIT in fp3(*run, "-n", 2, "--set", f"steps={MOST - 1}", status=2).stderr
    assert ends(*run[1:], "-n", 3) == ends(tmp_path / "m.ode", "-e", "isa", "-n", 3)
    params.write_text(re.sub(r"^steps.*\n", "", params.read_text(), flags=re.M))
    assert number(ends(*run[1:], "-n", 3)["steps", 0]) == 3


def test_groups_of_a_scene_count_for_themselves(written, tmp_path):
    written(SOLO)
    (tmp_path / "free.ode").write_text("state y = 1\ny' = -y\nstep 1")
    scene = tmp_path / "x.scene"
    text = """config = "array"; engine = "isa"; steps = %d;
    groups = ( { program = "free.ode"; objects = 2; },
               { program = "m.ode"; objects = 3; set = { steps = 16777000; }; },
               { program = "m.ode"; objects = 2; spread = { steps = [0, 10]; }; } );"""
    scene.write_text(text % 216)
    found = re.findall(r"^steps +(\S+) .*object (\d)", fp3("run", "--scene", scene).stdout, re.M)
    assert found == [("16777216", "2"), ("16777216", "3"), ("16777216", "4"), ("216", "5"), ("226", "6")]
    scene.write_text(text % 217)
    assert "group 1: 217 steps from 'steps' = 16777000 on" in fp3("run", "--scene", scene, status=2).stderr


@pytest.mark.parametrize("steps", ["0.5", "16777217", "-16777217", "1e30"])
def test_a_start_between_steps_is_refused(written, tmp_path, steps):
    text = "expected a whole number from -16777216 to 16777216"
    assert text in fp3("run", written(SOLO), "--set", f"steps={steps}", "-e", "isa", status=2).stderr
    written(".state steps\nstep: add steps, steps, 1.0", "m.s")
    assert text in fp3("run", tmp_path / "m.s", "--set", f"steps={steps}", "-e", "isa", status=2).stderr


def test_stoermer_begins_at_0(written):
    refused = fp3("run", written(WITCH), "-i", "stoermer_verlet", "--set", "steps=5", "-e", "isa", status=2)
    assert "'steps' is 5: integrator 'stoermer_verlet' begins at 0" in refused.stderr


def test_a_model_without_t_has_no_steps(written):
    refused = fp3("run", written("state y = 1\ny' = -y\nstep 1"), "--set", "steps=5", "-e", "isa", status=2)
    assert "the program has no 'steps'" in refused.stderr


def test_the_reference_counts_no_further(written):
    """It would take a minute to compute, and be wrong."""
    job = f"{written(SOLO)} euler single_full 7f 0 {MOST + 1} 0 0 0 1 all\n"
    done = subprocess.run([os.path.join(BUILD, "tests/random_models")], input=job, capture_output=True, text=True)
    assert done.stdout == f"refused: {MOST + 1} steps of equations with t: FP32 counts to {MOST}\n"


# ---- h and steps mean the same in every program ----

@pytest.mark.parametrize("line, expected", [
    (".state h", "1:8: error: found 'h', expected another name ('h' is the time step, a .shared"),
    (".param h = r3", "1:8: error: found 'h', expected another name ('h' is the time step, a .shared"),
    (".param steps", "1:8: error: found 'steps', expected another name ('steps' is how many steps"),
    (".shared steps", "1:9: error: found 'steps', expected another name ('steps' is how many steps"),
])
def test_an_assembly_program_cannot_use_them_otherwise(written, tmp_path, line, expected):
    path = written(f"{line}\n.state x\nstep: add x, x, 1.0", "m.s")
    assert expected in fp3("asm", path, "-o", tmp_path / "m.fp3", status=2).stderr
    assert not (tmp_path / "m.fp3").exists()


def test_objects_do_not_sleep_in_steps(written, tmp_path):
    path = written(".state steps\nstep: sleep steps, steps, 1.0", "m.s")
    assert "in which objects sleep, is 'steps'" in fp3("asm", path, "-o", tmp_path / "m.fp3", status=2).stderr
