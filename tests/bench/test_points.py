"""bench points: every field is there, other solvers come near the truth, and a wrong bit or a wrong truth stops it."""

import json
import math
import os
import subprocess

import pytest

ENGINE = "fast"
pytestmark = pytest.mark.xdist_group("points")  # measured once
FIELDS = {"model", "engine", "method", "integrator", "arithmetic", "config", "threads", "objects", "steps", "h", "tolerance",
          "error_median", "error_worst", "ns_per_object", "cycles", "repeats"}
CONFIGS = ("many_full", "single_full", "many", "single", "lanes", "uncut", "paper")
SOLVERS = {("gsl", name) for name in ("rkf45", "rk8pd", "msadams", "msbdf", "rk4")} \
    | {("sundials", name) for name in ("cvode adams", "cvode bdf", "arkode erk3", "arkode erk4", "arkode erk5", "arkode erk8")} \
    | {("plain_c", name) for name in ("scalar", "vectors")}


def bench(build, *arguments):
    return subprocess.run([build / "bench/bench", "points", *arguments, "--engine", ENGINE, "--quick"], capture_output=True,
                          text=True, timeout=300)


@pytest.fixture(scope="module")
def oscillator(build, root, tmp_path_factory):
    path = tmp_path_factory.mktemp("bench") / "oscillator.json"
    done = bench(build, root / "programs/oscillator.ode", "-i", "rk4", "-i", "leapfrog", "--json", path)
    assert done.returncode == 0, done.stderr
    return json.loads(path.read_text())


def test_every_field_and_every_solver_is_there(oscillator):
    points = oscillator["points"]
    assert all(set(point) == FIELDS for point in points)
    assert SOLVERS <= {(point["engine"], point["method"]) for point in points}
    measured = {(point["integrator"], point["arithmetic"]) for point in points if point["engine"] == ENGINE}
    assert {("rk4", "plain"), ("rk4", "folded"), ("leapfrog", "plain")} <= measured                # others may be hopeless
    assert {name for name, _ in measured} == {"rk4", "leapfrog"}
    for point in points:
        assert 0 < point["error_median"] <= point["error_worst"] and point["objects"] > 0
        assert (point["h"] is None) != (point["tolerance"] is None)
        if point["engine"] == "rtl":
            assert point["cycles"] > 0 and point["config"] in CONFIGS and point["ns_per_object"] is None
        else:
            assert point["ns_per_object"] > 0 and point["repeats"] > 0 and point["cycles"] is None


def test_the_same_error_on_the_engine_and_on_the_hardware(oscillator):
    def errors(engine):
        return {(point["integrator"], point["arithmetic"], point["steps"]): point["error_worst"]
                for point in oscillator["points"] if point["engine"] == engine}
    assert errors(ENGINE).items() <= errors("rtl").items() and len(errors(ENGINE)) > 10      # what is hopeless has cycles only


def test_several_configurations_have_cycles(oscillator):
    """All of them, as this model needs neither estimates nor selections."""
    assert set(CONFIGS) == {point["config"] for point in oscillator["points"] if point["engine"] == "rtl"}


def test_smaller_steps_and_tolerances_give_smaller_errors(oscillator):
    rk4 = {point["steps"]: point["error_median"] for point in oscillator["points"]
           if point["engine"] == ENGINE and (point["integrator"], point["arithmetic"]) == ("rk4", "compensated")}
    assert math.log2(rk4[64] / rk4[128]) > 3.5                # fourth order
    assert set(rk4) & set(range(17)) <= {1, 2, 4, 8, 16}
    for engine, method in SOLVERS - {("plain_c", "scalar"), ("plain_c", "vectors"), ("gsl", "rk4")}:
        of = {point["tolerance"]: point["error_median"] for point in oscillator["points"] if point["method"] == method}
        assert of[1e-6] < 1e-3 and of[1e-6] < of[1e-2] / 10, (engine, method)       # of 1e-10 one or another takes too long


def test_threads_are_for_what_is_near_the_front(oscillator):
    """What is far from it with one thread is not run."""
    def of(threads):
        return {(point["integrator"], point["arithmetic"], point["steps"]) for point in oscillator["points"]
                if point["engine"] == ENGINE and point["threads"] == threads}
    if os.cpu_count() > 1:
        assert set() < of(os.cpu_count()) < of(1)


def test_predicted_cycles_grow_by_a_step(oscillator):
    cycles = {point["steps"]: point["cycles"] for point in oscillator["points"]
              if (point["config"], point["integrator"], point["arithmetic"]) == ("many_full", "rk4", "plain")}
    assert (cycles[256] - cycles[128]) / 128 == pytest.approx((cycles[128] - cycles[64]) / 64)


@pytest.mark.long
def test_a_model_with_events_has_no_other_solvers_and_says_so(build, root, tmp_path):
    done = bench(build, root / "programs/bouncing_ball.ode", "-i", "euler", "--json", tmp_path / "ball.json")
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "ball.json").read_text())
    assert {point["engine"] for point in found["points"]} == {ENGINE, "rtl", "plain_c"}
    assert {"gsl", "sundials"} <= {row["engine"] for row in found["left_out"] if "events" in row["why"]}


def test_a_wrong_bit_of_the_engine_stops_it(build, root, tmp_path):
    done = bench(build, root / "programs/oscillator.ode", "-i", "rk4", "--flip", "--json", tmp_path / "x.json")
    assert done.returncode == 1 and f"variant 0: {ENGINE} has" in done.stderr and not (tmp_path / "x.json").exists()


def test_a_truth_that_disagrees_stops_it(build, root, tmp_path):
    text = (root / "programs/ship.ode").read_text()
    wrong = text.replace("exact v = T/C + ", "exact v = 1.0000001*T/C + ")
    assert wrong != text
    (tmp_path / "ship.ode").write_text(wrong)
    done = bench(build, tmp_path / "ship.ode", "-i", "rk4", "--json", tmp_path / "x.json")
    assert done.returncode == 1 and "two solutions of 'v'" in done.stderr and not (tmp_path / "x.json").exists()


def test_the_command_measures_the_same(fp3, root, tmp_path):
    """fp3 bench MODEL: a table of what no faster point is as accurate as, and all points as JSON."""
    done = subprocess.run([fp3, "bench", "ship", "-i", "euler", "--quick", "--json", tmp_path / "x.json"], cwd=root, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    data = json.loads((tmp_path / "x.json").read_text())
    assert set(data) == {"problems", "points", "left_out"} and all(set(point) == FIELDS for point in data["points"])
    assert data["problems"][0]["model"] == "ship" and {point["integrator"] for point in data["points"] if point["engine"] == "fast"} == {"euler"}
    for engine, column in (("fast, 1 thread", "ns_per_object"), ("rtl many_full", "cycles"), ("rtl single_full", "cycles")):
        costs = [float(line.split()[-1]) for line in done.stdout.splitlines() if line.startswith(engine)]
        assert costs and costs == sorted(costs)
        known = [point[column] for point in data["points"] if point[column]]
        assert all(any(cost == pytest.approx(value, rel=1e-3) for value in known) for cost in costs)


def test_adaptive_steps_are_rows_of_their_own(build, tmp_path):
    """By tolerances; the hardware has the bits of the engine and cycles; what takes too many attempts is left out."""
    (tmp_path / "a.ode").write_text("state y = 1\ny' = cos(t) - y\nstep 0.01\nspan 4\n")
    done = subprocess.run([build / "bench/bench", "points", tmp_path / "a.ode", "-i", "heun", "--engine", "isa", "--quick", "--json",
                           tmp_path / "x.json"], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    data = json.loads((tmp_path / "x.json").read_text())
    points = [point for point in data["points"] if point["integrator"] == "heun adaptive"]
    assert {point["tolerance"] for point in points} == {1e-2, 1e-4} and all(point["h"] is point["steps"] is None for point in points)
    for arithmetic in ("plain", "compensated"):
        of = {point["config"] or point["engine"]: point for point in points if point["arithmetic"] == arithmetic and point["tolerance"] == 1e-2}
        assert set(of) == {"isa", "many_full", "single_full"} and len({point["error_worst"] for point in of.values()}) == 1
        assert 1e-4 < of["isa"]["error_median"] <= of["isa"]["error_worst"] < 6e-3 and of["isa"]["ns_per_object"] > 0 and of["isa"]["objects"] == 64
        assert 300 < of["many_full"]["cycles"] < of["single_full"]["cycles"] < 5000
    left = [(row["tolerance"], row["why"]) for row in data["left_out"] if row["integrator"] == "heun adaptive"]
    assert left == 2 * [(1e-6, "an object does not come to its end")]


def test_steps_that_are_cut_at_events_are_rows_of_their_own(build, root, tmp_path):
    """By time steps, beside those that are not cut: with the same h far nearer the truth. The hardware has the bits and cycles."""
    done = bench(build, root / "programs/bouncing_ball.ode", "-i", "rk4", "--json", tmp_path / "ball.json")
    assert done.returncode == 0, done.stderr
    points = json.loads((tmp_path / "ball.json").read_text())["points"]
    cut = [point for point in points if point["integrator"] == "rk4 cut"]
    assert all(point["h"] > 0 and point["steps"] and point["tolerance"] is None and point["h"] * point["steps"] >= 2 for point in cut)
    assert {point["arithmetic"] for point in cut} == {"plain", "compensated", "double_single"}

    def errors(engine, integrator):
        return {point["steps"]: point["error_median"] for point in points if (point["engine"], point["integrator"], point["arithmetic"]) == (engine, integrator, "compensated")}
    ours, plain, hardware = errors(ENGINE, "rk4 cut"), errors("rtl", "rk4"), errors("rtl", "rk4 cut")
    assert 0 < min(ours.values()) < 3e-5 and len(set(ours) & set(plain)) > 1         # others may be hopeless
    assert all(ours[steps] < plain[steps] / 50 for steps in set(ours) & set(plain))
    assert hardware and all(error == ours.get(steps, error) for steps, error in hardware.items())
    assert {point["config"] for point in cut if point["engine"] == "rtl"} == {"many_full", "single_full"}


def test_where_there_is_no_event_nothing_is_cut(oscillator):
    assert not [point for point in oscillator["points"] if (point["integrator"] or "").endswith(" cut")]


@pytest.mark.parametrize("text, why", [("model a\nstate x = 1\nstep 0.1\nx' = -x +\n", "a.ode:5:"), (None, "No such file")])
def test_a_bad_model_is_refused(build, tmp_path, text, why):
    if text:
        (tmp_path / "a.ode").write_text(text)
    done = bench(build, tmp_path / "a.ode", "--json", tmp_path / "x.json")
    assert done.returncode not in (0, -11) and why in done.stderr and not (tmp_path / "x.json").exists()


def test_without_a_compiler_it_says_so(build, root, tmp_path):
    done = subprocess.run([build / "bench/bench", "points", root / "programs/ship.ode", "--quick", "--engine", ENGINE, "-i", "euler",
                           "--json", tmp_path / "x.json"], env={"PATH": "/usr/bin:/bin", "FP3_CC": "no-such-cc"},
                          capture_output=True, text=True, timeout=120)
    assert done.returncode != 0 and "no-such-cc" in done.stderr and not (tmp_path / "x.json").exists()


@pytest.mark.long
def test_one_configuration_is_measured_alone(fp3, root, tmp_path):
    """In its own arithmetic: Cell's is truncated, and so less accurate."""
    errors = {}
    for config in ("many_full", "cell"):
        done = subprocess.run([fp3, "bench", root / "programs/oscillator.ode", "--quick", "-c", config, "-i", "rk4", "--json", tmp_path / config],
                              capture_output=True, text=True, timeout=200)
        assert done.returncode == 0, done.stderr
        points = json.loads((tmp_path / config).read_text())["points"]
        assert {(point["engine"], point["config"]) for point in points} == {("fast", None), ("rtl", config)}
        errors[config] = min(point["error_median"] for point in points if point["arithmetic"] == "plain" and point["integrator"] == "rk4")
    assert errors["cell"] > 2 * errors["many_full"]
    done = subprocess.run([fp3, "bench", root / "programs/kepler.ode", "--quick", "-c", "single", "-i", "rk4"], capture_output=True, text=True, timeout=200)
    assert done.returncode == 2 and "nothing to measure on configuration 'single': " in done.stderr, done.stderr


def without_times(fp3, root, *arguments):
    return subprocess.run([fp3, "bench", root / "programs/oscillator.ode", "--no-times", *arguments], capture_output=True, text=True, timeout=200)


def test_without_times_two_runs_write_the_same(fp3, root, tmp_path):
    """Whatever the speed of the machine: also in an arithmetic whose engine is slow, the same steps are tried."""
    steps = {}
    for config in ("many_full", "flush"):
        for turn in range(2):
            done = without_times(fp3, root, "-i", "rk4", "--config", config, "--json", tmp_path / f"{turn}.json")
            assert done.returncode == 0, done.stderr
        assert (tmp_path / "0.json").read_text() == (tmp_path / "1.json").read_text()
        points = json.loads((tmp_path / "0.json").read_text())["points"]
        assert {point["engine"] for point in points} == {"rtl"} and all(point["ns_per_object"] is None for point in points)
        steps[config] = {point["steps"] for point in points if point["arithmetic"] == "compensated"}
    assert len(steps["many_full"] & steps["flush"]) > 6


def test_times_are_left_out_of_one_configuration_only(fp3, root):
    done = without_times(fp3, root)
    assert done.returncode == 2 and "found --no-times, expected --config" in done.stderr
