"""fp3 tune: the choice holds, costs what it says, and runs as it is; what is refused, and what has no answer."""

import csv
import json
import math
import pathlib
import re
import subprocess
import sys
import tomllib

import pytest

# The right-hand side is steep between the 32 objects of the sample, which lie at multiples of 1/32.
COMB = """state x = 1
param a = 0
x' = -(1 + 20*sin(32*pi*a)^2)*(x - 0.5)
exact x = 0.5 + 0.5*exp(-(1 + 20*sin(32*pi*a)^2)*t)
step 0.0078125
span 1
"""
# Slow for long, then fast: y grows from a small flame to a large one (Shampine, Numerical Solution of ODEs, 1994).
FLAME = "state y = 0.001\ny' = y^2 - y^3\nstep 0.5\nspan 1000\n"
DECAY = "state x = 1\nparam k = 1\nx' = -k*x\nexact x = exp(-k*t)\nstep 0.03125\nspan 2\n"


@pytest.fixture
def tune(fp3, tmp_path):
    (tmp_path / "m.ode").write_text(DECAY)

    def tune(*arguments, cwd=tmp_path):
        done = subprocess.run([fp3, "tune", *map(str, arguments), "--json", "out.json"], cwd=cwd, capture_output=True, text=True, timeout=600)
        path = pathlib.Path(cwd) / "out.json"
        return done, json.loads(path.read_text()) if path.exists() else None
    return tune


def cycles(fp3, folder, *arguments):
    done = subprocess.run([fp3, "run", *map(str, arguments), "-e", "rtl"], cwd=folder, capture_output=True, text=True, timeout=600, check=True)
    return int(re.search(r"^cycles +(\d+)$", done.stdout, re.M)[1])


# ---- the choice ----

def test_the_scene_runs_and_keeps_the_tolerance(tune, fp3, tmp_path):
    (tmp_path / "out").mkdir()
    done, row = tune("m.ode", "--tolerance", "1e-4", "--spread", "k=0.5:2", "--output", "out/m.scene", "--objects", "50")
    assert done.returncode == 0 and row["met"] and row["error_held_out"] <= 1e-4 and row["held_out"] == 64
    out = subprocess.run([fp3, "run", "--all", "--scene", "out/m.scene"], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    found = [float(x) for x in re.findall(r"^x +(\S+) ", out, re.M)]
    assert len(found) == 50
    for i, x in enumerate(found):
        assert abs(x - math.exp(-2 * (0.5 + 1.5 * i / 49))) <= 1e-4


def test_the_cost_is_that_of_the_hardware(tune, fp3, tmp_path):
    done, row = tune("m.ode", "--tolerance", "1e-3", "--spread", "k=0.5:2", "--output", "m.scene")
    assert done.returncode == 0
    assert cycles(fp3, tmp_path, "--scene", "m.scene") == pytest.approx(24 * row["cycles"], abs=0.5)
    base = cycles(fp3, tmp_path, "m.ode", "-c", "many_full", "-N", "24", "-n", "64")
    assert base == pytest.approx(24 * row["baseline_cycles"], abs=0.5)
    assert row["cost_ratio"] == pytest.approx(row["cycles"] / row["baseline_cycles"], rel=1e-6)


def test_nothing_that_was_tried_is_cheaper_and_good_enough(tune):
    row = tune("m.ode", "--tolerance", "1e-4", "--spread", "k=0.5:2")[1]
    good = [r for r in row["tried"] if r["error"] is not None and r["error"] <= 1e-4 / 1.25]
    assert good and min(r["cycles"] for r in good) == row["cycles"] < row["baseline_cycles"]
    assert {(r["integrator"], r["arithmetic"]) for r in row["tried"]} >= {("euler", "plain"), ("rk6", "folded"), ("rk4", "compensated")}


def test_the_sensitivity_is_that_of_the_equations(tune, tmp_path):
    """x = x0 exp(k t): a unit in the last place of k, 2^-23, moves ln x by 4 times that in the end."""
    (tmp_path / "m.ode").write_text("state x = 1\nparam k = 1.5\nx' = k*x\nexact x = exp(k*t)\nstep 0.0078125\nspan 4\n")
    done, row = tune("m.ode", "--tolerance", "1e-3")
    assert done.returncode == 0 and row["sensitive"] == "k"
    assert row["sensitivity"] == pytest.approx(4 * 2**-23, rel=1e-2)
    assert "one unit in the last place of 'k' alone moves the result by 4.77e-07" in done.stdout


def test_what_the_sample_misses_the_held_out_objects_find(tune, tmp_path):
    (tmp_path / "comb.ode").write_text(COMB)
    done, row = tune("comb.ode", "--tolerance", "1e-3", "--spread", "a=0:1")
    assert done.returncode == 0 and row["met"] and row["error_held_out"] <= 1e-3
    assert row["rounds"] > 1 and row["sample"] >= 32 + 64
    assert "earlier samples failed" in done.stdout
    assert f"must meet {1e-3 / 1.25 ** row['rounds']:g}" in done.stdout and row["error"] <= 1e-3 / 1.25 ** row["rounds"]


def test_a_scene_is_tuned_as_its_model_is(tune, tmp_path):
    (tmp_path / "s.scene").write_text('config = "many_full"; steps = 64; h = 0.03125;\n'
                                      'groups = ({ program = "m.ode"; objects = 7; spread = { k = [0.5, 2.0]; }; });\n')
    scene = tune("s.scene", "--tolerance", "1e-3", "--output", "t.scene")[1]
    model = tune("m.ode", "--tolerance", "1e-3", "--spread", "k=0.5:2")[1]
    assert scene == model
    assert "objects = 7;" in (tmp_path / "t.scene").read_text()


def test_one_set_of_parameters_is_said_to_be_one(tune):
    done, row = tune("m.ode", "--tolerance", "1e-3")
    assert done.returncode == 0 and "only one set of parameters was tried" in done.stdout
    assert row["met"] and row["error_held_out"] is None and row["held_out"] == 0


def test_one_object_has_a_choice_of_its_own(tune):
    row = tune("m.ode", "--tolerance", "1e-3", "-c", "single_full")[1]
    assert row["met"] and row["cost_ratio"] < 1


# ---- between the objects and the times that the tuner has seen ----

RELAXING = "param mu = 8\nstate v = 0\nstate x = 2\nstep 0.03125\nspan 48\nv' = mu*(1 - x^2)*v - x\nx' = v\n"
TURNING = "state x = 1\nstate v = 0\nx' = v\nv' = -x\nstep 0.03125\nspan 16\n"
FALLING = "param e = 0.75\nstate v = 0\nstate x = 1\nstep 0.0009765625\nspan 2\nv' = -9.81\nx' = v\nwhen x < 0 and v < 0: x = -e*x, v = -e*v\n"


def run_scene(fp3, folder, row, times):
    """Objects with their states at times, from the scene that was written."""
    at = ["--every", "1"] if row["h"] else ["--times", ",".join(map(repr, times))]
    subprocess.run([fp3, "run", "--scene", "m.scene", "--output", "m.csv", *at], cwd=folder, capture_output=True, check=True)
    objects = {}
    with open(folder / "m.csv") as lines:
        for line in csv.DictReader(lines):
            objects.setdefault(int(line["object"]), []).append((int(line["step"]), float(line["time"]), line))
    return objects


def worst_of(truths, row, first, last, folder, fp3, names, name):
    """The largest error of 64 objects, judged here alone."""
    objects = run_scene(fp3, folder, row, [row["span"] * (i + 1) / 2000 for i in range(2000)])
    assert len(objects) == 64
    worst = 0
    for i, looks in objects.items():
        times = [step * row["h"] if row["h"] else time for step, time, _ in looks if time > 0]
        assert len(times) == (row["steps"] if row["h"] else 2000)
        value = first + (last - first) * i / 63
        out = subprocess.run([truths, "m.ode", f"{name}={value!r}"], cwd=folder, input=" ".join(map(repr, times)), capture_output=True, text=True, check=True)
        rows = [[float(x) for x in line.split()] for line in out.stdout.splitlines()]
        sizes = rows.pop()
        for (_, _, line), truth in zip((look for look in looks if look[1] > 0), rows, strict=True):
            worst = max(worst, *(abs(float(line[n]) - y) / size for n, y, size in zip(names, truth, sizes)))
    return worst


@pytest.mark.parametrize("model, tolerance, name, first, last, states", [pytest.param(RELAXING, 1e-3, "mu", 7.9, 8.1, ("v", "x"), marks=pytest.mark.long), (TURNING, 1e-5, "x", 0.5, 2, ("x", "v"))])
def test_other_objects_keep_the_tolerance_all_the_time(tune, fp3, build, tmp_path, model, tolerance, name, first, last, states):
    (tmp_path / "m.ode").write_text(model)
    done, row = tune("m.ode", "--tolerance", tolerance, "--spread", f"{name}={first}:{last}", "--output", "m.scene", "--objects", "64")
    assert done.returncode == 0 and row["met"], done.stderr
    assert worst_of(build / "tests/truths", row, first, last, tmp_path, fp3, states, name) <= tolerance


def test_steps_end_with_the_span(tune, tmp_path):
    (tmp_path / "m.ode").write_text(TURNING)
    done = tune("m.ode", "--tolerance", "1e-5")[0]
    assert done.returncode == 0 and "the largest after each step" in done.stdout
    assert abs(float(re.search(r" steps to ([\d.]+):", done.stdout)[1]) - 16) < 6e-7
    row = tune("m.ode", "--tolerance", "1e-5", "--span", "100")[1]
    late = [abs(r["steps"] * r["h"] - 100) for r in row["tried"] if r["h"] and r["why"] == "meets the target"]
    assert late and max(late) < 5e-7, late  # h alone is rounded by up to 3e-8 of it, so that 3e-6 may be missing


def test_an_event_a_little_early_or_late_is_no_jump(tune, tmp_path):
    (tmp_path / "m.ode").write_text(FALLING)
    done, row = tune("m.ode", "--tolerance", "1e-3", "--spread", "e=0.7:0.8")
    assert done.returncode == 0 and row["met"] and row["error_held_out"] <= 1e-3
    assert row["cost_ratio"] < 1  # to be on the same side of each event at each step takes far more, if it can be had


# ---- adaptive steps ----

def flame(t, start):
    """1/y + log(1/y - 1) = 1/start + log(1/start - 1) - t, solved by bisection."""
    def late(y):
        return 1 / y + math.log(1 / y - 1) - 1 / start - math.log(1 / start - 1) + t
    low, high = start, 1 - 1e-15
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (middle, high) if late(middle) > 0 else (low, middle)
    return low


def states(out, name):
    return [float(x) for x in re.findall(rf"^{name} +(\S+) ", out, re.M)]


@pytest.fixture
def burnt(tune, tmp_path):
    (tmp_path / "f.ode").write_text(FLAME)
    done, row = tune("f.ode", "--tolerance", "1e-2", "--spread", "y=0.00098:0.00102", "--output", "f.scene", "--objects", "144", "--hardware")
    assert done.returncode == 0 and row["met"] and row["error_held_out"] <= 1e-2
    assert row["adaptive_tolerance"] > 0 and row["h"] is None and row["steps"] == 0 and row["cost_ratio"] < 0.2
    return done, row


def test_an_adaptive_choice_runs_as_a_scene(burnt, fp3, tune, tmp_path):
    done, row = burnt
    out = subprocess.run([fp3, "run", "--all", "--scene", "f.scene"], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    found = states(out, "y")
    assert len(found) == 144 and max(found) > 0.9
    for i, y in enumerate(found):
        assert abs(y - flame(1000, 0.00098 + 0.00004 * i / 143)) <= 1e-2
    assert sum(states(out, "accepted") + states(out, "rejected")) / 144 == pytest.approx(row["attempts"], rel=0.05)
    assert cycles(fp3, tmp_path, "--scene", "f.scene") / 144 == pytest.approx(row["cycles"], rel=0.15)
    trimmed = tomllib.loads(done.stdout[done.stdout.index("[[config]]"):])["config"][0]
    assert (trimmed["sleep"], trimmed["select"], trimmed["reciprocal"]) == (1, 1, "estimate")
    assert tune("f.scene", "--tolerance", "1e-2")[1] == row  # a scene with a tolerance has steps of its own, and can be tuned again


def test_each_adaptive_candidate_is_run(burnt):
    tried = [r for r in burnt[1]["tried"] if r["adaptive"]]
    assert {(r["integrator"], r["arithmetic"]) for r in tried} >= {(i, a) for i in ("dopri5", "heun", "ralston3", "rodas3") for a in ("plain", "compensated")}
    run = [r for r in tried if r["arithmetic"] == "plain"]
    assert all(r["attempts"] > 8 and r["adaptive_tolerance"] > 0 and r["absolute"] > 0 and math.isfinite(r["lowest"]) for r in run)


def test_errors_on_the_way_count_and_looks_cost_nothing(tune, fp3, tmp_path):
    # A hill at a quarter of the span; in the end nothing is left of it.
    (tmp_path / "h.ode").write_text("state x = 0.0183\nx' = -8*(t - 1)*x\nexact x = x(0)*exp(4 - 4*(t - 1)^2)\nstep 0.015625\nspan 4\n")
    row = tune("h.ode", "--tolerance", "1e-2")[1]
    tried = next(r for r in row["tried"] if r["adaptive"] and r["arithmetic"] == "plain" and r["why"] == "meets the target")
    found = []
    for until in (i / 16 for i in range(1, 65)):  # up to each of these ends it makes the same steps, but the last one
        command = [fp3, "run", "h.ode", "-e", "isa", "-i", tried["integrator"], "--tolerance", str(tried["adaptive_tolerance"]), "--until", str(until),
                   "--set", f"absolute={tried['absolute']}"]
        out = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True).stdout
        start, peak = 0.0183, 0.0183 * math.exp(4)
        found.append(abs(states(out, "x")[0] - start * math.exp(4 - 4 * (until - 1) ** 2)) / peak)
        attempts = states(out, "accepted")[0] + states(out, "rejected")[0]
    assert max(found) > 10 * found[-1] and max(found) > 1.1 * max(found[15::16])
    assert tried["error"] == pytest.approx(max(found), rel=0.1) and tried["attempts"] == attempts


# ---- hardware ----

def test_the_trimmed_configuration_is_one_and_has_what_it_needs(tune, root):
    done = tune("m.ode", "--tolerance", "1e-3", "--spread", "k=0.5:2", "--hardware")[0]
    text = done.stdout[done.stdout.index("[[config]]"):]
    found = tomllib.loads(text)["config"][0]
    assert (found["select"], found["reciprocal"], found["round"], found["sleep"]) == (0, "none", 0, 0)
    assert found["registers"] < 64 and found["program_words"] < 2048 and found["store_words"] < 16384
    sys.path.insert(0, str(root / "tools"))
    from fp3gen import read
    assert found.keys() - {"name", "doc"} <= read.__dict__.keys() | set(tomllib.loads((root / "isa/configs.toml").read_text())["key"])
    page = (root / "docs/results.md").read_text()
    sizes = (root / "docs/sizes.md").read_text()
    known = int(re.search(r"^\| LFE5U-25F \| \S+ \| `many_full` \| ([\d,]+) \|", sizes, re.M)[1].replace(",", ""))
    saved = [int(re.search(rf"^\| {name} \| [\d,]+ \| -(\d+) \|", page, re.M)[1]) for name in ("no sleep", "no selection", "no estimates")]
    assert f"has {known}, placed" in text and f"about {known - sum(saved)}:" in text and "not known, and not included" in text


# ---- no answer ----

def test_a_tolerance_that_nothing_meets(tune, tmp_path):
    # What FP32 rounds grows by exp(5), and an event makes each integrator with fixed steps one of first order, in double-single, too.
    (tmp_path / "e.ode").write_text("state x = 1\nx' = x + 0.001*tanh(x)*atan(sin(x)*exp(-x))\nwhen x > 2: x = x - 1\nstep 0.0625\nspan 5\n")
    (tmp_path / "old.scene").write_text("as it was")
    done, row = tune("e.ode", "--tolerance", "4e-7", "--output", "old.scene")
    assert done.returncode == 3 and not row["met"] and row["cost_ratio"] is None
    assert re.search(r"nothing meets the tolerance 4e-07: the smallest error that was found is \S+, by \w+, \w+", done.stderr)
    assert (tmp_path / "old.scene").read_text() == "as it was"


def test_without_a_truth_there_is_no_choice(tune, root):
    done, row = tune(root / "programs/lorenz.ode", "--tolerance", "1e-3", "--span", "60")
    assert done.returncode == 3 and "no truth to measure errors against: two solutions of" in done.stderr and row is None


@pytest.mark.parametrize("arguments, said", [
    (["m.ode"], "expected --tolerance"),
    (["m.ode", "--tolerance", "0"], "found '0', expected a number above 0"),
    (["m.ode", "--tolerance", "-1e-3"], "expected a number above 0"),
    (["m.ode", "--tolerance", "nan"], "no number"),
    (["m.ode", "--tolerance", "1e-30"], "the tolerance is 1e-30: expected 1e-07 or more, because configuration 'many_full' rounds by 6e-08"),
    (["m.ode", "--tolerance", "1"], "below 1"),
    (["m.ode", "--tolerance", "1e-3", "--span", "1e9"], "the span 1e+09 is"),
    (["m.ode", "--tolerance", "1e-3", "--span", "0.01"], "expected 1 to"),
    (["m.ode", "--tolerance", "1e-3", "--spread", "q=0:1"], "'q'"),
    (["m.ode", "--tolerance", "1e-3", "--set", "steps=5"], "'steps'"),
    (["m.ode", "--tolerance", "1e-3", "-c", "array"], "several schedulers"),
    (["m.ode", "--tolerance", "1e-3", "-c", "nope"], "'nope'"),
    (["m.ode", "--tolerance", "1e-3", "--output", "m.ode"], "m.ode"),
    (["m.s", "--tolerance", "1e-3"], "expected a model"),
    (["two.scene", "--tolerance", "1e-3"], "found 2 groups, expected one"),
    (["life.scene", "--tolerance", "1e-3"], "found lifetimes"),
    (["one.scene", "--tolerance", "1e-3", "--set", "k=1"], "are in the scene"),
])
def test_what_is_refused(tune, tmp_path, arguments, said):
    group = '{ program = "m.ode"; objects = 2; }'
    (tmp_path / "one.scene").write_text(f'config = "many_full"; steps = 64; groups = ({group});\n')
    (tmp_path / "two.scene").write_text(f'config = "array"; steps = 64; groups = ({group}, {group});\n')
    (tmp_path / "life.scene").write_text(f'config = "many_full"; steps = 64; groups = ({group.replace("}", "born = 3; }")});\n')
    done, row = tune(*arguments)
    assert done.returncode == 2 and said in done.stderr and row is None, done.stderr


# ---- truth, table ----

def test_steps_that_miss_a_pulse_have_an_error(tune, fp3, tmp_path):
    (tmp_path / "pulse.ode").write_text("state x = 0\nx' = -x + ((t > 5 and t < 5.0625) ? 160 : 0)\nstep 0.5\nspan 6\n")
    done, row = tune("pulse.ode", "--tolerance", "1e-2", "--output", "p.scene")
    assert done.returncode == 0 and row["met"]
    assert row["baseline_error"] > 0.1
    out = subprocess.run([fp3, "run", "--scene", "p.scene"], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    x = float(re.search(r"^x +(\S+)", out, re.M)[1])
    top = 160*(1 - math.exp(-0.0625))
    assert abs(x - top*math.exp(-0.9375)) <= 1e-2*top



def test_truths_at_several_times(root, build, tmp_path):
    """And what stoermer_verlet starts from is the truth a step before, also where the equations bend or jump on the way there."""
    for name, force in (("bends", "-abs(x)"), ("jumps", "x > 0"), ("near_a_pole", "-1/(x + 1)^2")):
        (tmp_path / f"{name}.ode").write_text(f"state x = 0.03\nstate v = 0.7\nx' = v\nv' = {force}\nstep 0.125\nspan 1\n")
    names = ["pendulum", "oscillator", "projectile", "robertson", "bouncing_ball", "thermostat", "kepler", "arenstorf"]
    models = [*(root / f"programs/{name}.ode" for name in names), *sorted(tmp_path.glob("*.ode"))]
    out = subprocess.run([build / "tests/truths", *models], capture_output=True, text=True, check=True).stdout.split()
    assert out[::5] == [model.stem for model in models]
    assert all(float(error) < 1e-9 for error in out[1::5] + out[2::5]) and set(out[3::5]) == {"1"}  # FP3_E_ARGUMENT: times go upwards
    assert all(float(error) < 3e-13 for error in out[4::5]), out


def test_the_table_of_all_models(fp3, root, tmp_path):
    out = tmp_path / "tune.json"
    subprocess.run([sys.executable, root / "tools/tune.py", "--fp3", fp3, "--output", out, "--quick", "--models", "ship"], cwd=root, check=True, capture_output=True)
    rows = json.loads(out.read_text())["rows"]
    assert [(row["model"], row["tolerance"]) for row in rows] == [("ship", 1e-3), ("ship", 1e-4)]
    for row in rows:
        assert row["met"] and row["error_held_out"] <= row["tolerance"] and 0 < row["cost_ratio"] < 1
        assert row["integrator"] and row["arithmetic"] and (row["adaptive_tolerance"] if row["h"] is None else row["h"]) > 0
    subprocess.run([sys.executable, root / "tools/pages.py", "tune", "--results", tmp_path, "--docs", tmp_path], cwd=root, check=True)
    assert f"| {rows[0]['cost_ratio']:.2f} `{rows[0]['integrator']}`" in (tmp_path / "tuning.md").read_text()


@pytest.mark.parametrize("start, moves", [("0", False), ("1e-6", True)])
def test_a_model_that_does_not_move_tells_nothing(tune, tmp_path, start, moves):
    """Any step keeps a spring of 1e6 at rest."""
    (tmp_path / "m.ode").write_text(f"state x = {start}\nstate v = 0\nx' = v\nv' = -1e6*x\nstep 0.01\nspan 0.0625\n")
    done, _ = tune("m.ode", "--tolerance", "1e-2")
    assert (done.returncode, "no object of the sample ever moves" in done.stderr) == ((0, False) if moves else (2, True)), done.stderr
