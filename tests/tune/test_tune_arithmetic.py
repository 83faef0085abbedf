"""fp3 tune among arithmetics: what each costs in LUT ns, why one is chosen, and that its scene keeps the tolerance on its configuration."""

import json
import math
import re
import subprocess
import sys
import tomllib

import pytest

DECAY = "state x = 1\nparam k = 1\nx' = -k*x\nexact x = exp(-k*t)\nstep 0.03125\nspan 2\n"
ROOTS = "state x = 1\nparam k = 1\nx' = -k*(x > 0.5 ? x : sqrt(x)/(1 + x*x))\nstep 0.03125\nspan 2\n"


@pytest.fixture
def tune(fp3, tmp_path):
    (tmp_path / "m.ode").write_text(DECAY)
    (tmp_path / "roots.ode").write_text(ROOTS)

    def run(*arguments):
        done = subprocess.run([fp3, "tune", *map(str, arguments), "--json", "out.json"], cwd=tmp_path, capture_output=True, text=True, timeout=300)
        path = tmp_path / "out.json"
        return done, json.loads(path.read_text()) if path.exists() else None
    return run


def known(root):
    """Of each configuration its LUT4 and MHz."""
    text = (root / "sw/lab/tune/placed.c").read_text(encoding="utf-8")
    return {name: (int(luts), float(mhz)) for name, luts, mhz in re.findall(r'\{"(\w+)", (\d+), ([\d.]+)\}', text)}


def test_the_cheapest_arithmetic_is_chosen(tune, fp3, root, tmp_path):
    done, found = tune("m.ode", "--tolerance", "1e-4", "--spread", "k=0.5:2", "--arithmetic", "all", "--output", "m.scene", "--objects", "50")
    rows, of = {row["config"]: row for row in found["arithmetics"]}, known(root)
    assert done.returncode == 0 and rows.keys() >= {"many_full", "flush", "cell", "bfloat", "middle", "log"}
    assert {name for name, row in rows.items() if not row["met"]} == {"bfloat"} and re.search(r"^bfloat .* left out: .*rounds by 0.0039$", done.stdout, re.M)
    rows.pop("bfloat")
    for name, row in rows.items():
        assert (row["lut4"], row["mhz"]) == of[name] and row["error"] <= 1e-4
        assert row["lut_ns"] == pytest.approx(row["lut4"] * row["cycles"] * 1e3 / row["mhz"])
    for name in ("flush", "log"):
        row = rows[name]
        alone = tune("m.ode", "--tolerance", "1e-4", "--spread", "k=0.5:2", "-c", name)[1]
        assert (alone["cycles"], alone["integrator"], alone["config"], alone["arithmetics"]) == (row["cycles"], row["integrator"], name, [])
    first, second = sorted(rows.values(), key=lambda row: row["lut_ns"])[:2]
    assert found["config"] == first["config"] and found["cycles"] == first["cycles"]
    said = re.search(r"^configuration +(\w+) costs least: ([\d.]+) of the LUTs of (\w+), ([\d.]+) of the cycles and ([\d.]+) of the clock make ([\d.]+) of its LUT ns$",
                     done.stdout, re.M)
    assert (said[1], said[3]) == (first["config"], second["config"])
    assert [float(said[i]) for i in (2, 4, 5, 6)] == pytest.approx([first[key] / second[key] for key in ("lut4", "cycles", "mhz", "lut_ns")], abs=6e-4)
    assert f'config = "{first["config"]}";' in (tmp_path / "m.scene").read_text()
    keeps_the_tolerance(fp3, tmp_path)


def keeps_the_tolerance(fp3, folder):
    """50 objects by the scene, against the closed form."""
    out = subprocess.run([fp3, "run", "--all", "--scene", "m.scene"], cwd=folder, capture_output=True, text=True, check=True).stdout
    found = [float(x) for x in re.findall(r"^x +(\S+) ", out, re.M)]
    assert len(found) == 50 and all(abs(x - math.exp(-2 * (0.5 + 1.5 * i / 49))) <= 1e-4 for i, x in enumerate(found))


def test_a_configuration_that_cannot_run_the_model_is_told_and_left_out(tune, tmp_path):
    """Functions: truncated, with constants of 24 bits, without `round`. Alone, or as the first, such a configuration is refused."""
    (tmp_path / "sine.ode").write_text("state x = 1\nstate v = 0\nx' = v\nv' = -sin(x)\nstep 0.0625\nspan 1\n")
    done, found = tune("sine.ode", "--tolerance", "1e-2", "--arithmetic", "cell", "--arithmetic", "bfloat", "--arithmetic", "log", "--arithmetic", "flush")
    rows = {row["config"]: row for row in found["arithmetics"]}
    assert done.returncode == 0 and {name for name, row in rows.items() if row["met"]} == {"many_full", "flush"} and not rows["flush"]["why"]
    for config, why in (("cell", "truncates"), ("bfloat", "numbers of 24 bits"), ("log", "needs `round`")):
        assert why in rows[config]["why"] and rows[config]["lut_ns"] is rows[config]["error"] is None
        assert re.search(rf"^{config} .* left out: .*{why}", done.stdout, re.M)
    for config in ("bfloat", "log"):
        done, found = tune("sine.ode", "--tolerance", "1e-2", "-c", config, "--arithmetic", "flush")
        assert done.returncode == 2 and "sin(x)" in done.stderr


@pytest.mark.parametrize("config, least", [("many_full", 1e-7), ("middle", 2.56e-5), ("many_half", 8.192e-4), ("bfloat", 6.5536e-3)])
def test_what_numbers_are_too_short_for_is_refused(tune, config, least):
    """Instead of a search that cannot end well. At the limit the search begins."""
    done, found = tune("m.ode", "--tolerance", str(least * 0.999), "-c", config)
    assert done.returncode == 2 and f"expected {least:.3g} or more, because configuration '{config}' rounds by" in done.stderr and found is None
    assert tune("m.ode", "--tolerance", str(least * 1.001), "-c", config)[0].returncode in (0, 3)


@pytest.mark.long
def test_some_of_several_miss_the_tolerance(tune):
    """Near the limit of FP32 logarithms, which have no compensation, do not come as far as a sum of floats."""
    done, found = tune("m.ode", "--tolerance", "1.05e-7", "--spread", "k=0.5:2", "--arithmetic", "log", "--arithmetic", "flush")
    rows = {row["config"]: row for row in found["arithmetics"]}
    assert done.returncode == 0 and not rows["log"]["met"] and rows["flush"]["met"] and rows["log"]["error"] > 1.05e-7
    assert re.search(r"^log .* misses the tolerance$", done.stdout, re.M)


def test_a_unit_in_the_last_place_is_that_of_the_configuration(tune):
    """x moves by 1/e of a relative change of k at t = 1, and by as much at the start."""
    moves = {config: tune("m.ode", "--tolerance", "1e-1", "-c", config)[1]["sensitivity"] for config in ("many_full", "middle", "bfloat", "log")}
    assert moves["middle"] == pytest.approx(256 * moves["many_full"], rel=0.02) and moves["bfloat"] == pytest.approx(65536 * moves["many_full"], rel=0.02)
    assert moves["log"] == pytest.approx(math.log(2) * moves["many_full"], rel=0.02)


@pytest.mark.parametrize("config", ["flush", "cell", "fused_full", "middle", "log", "pairs"])
def test_errors_are_those_of_the_configuration(tune, fp3, tmp_path, config):
    done, found = tune("m.ode", "--tolerance", "1e-4", "--spread", "k=0.5:2", "-c", config, "--output", "m.scene", "--objects", "50")
    assert done.returncode == 0 and found["config"] == config and f'config = "{config}";' in (tmp_path / "m.scene").read_text()
    keeps_the_tolerance(fp3, tmp_path)


def test_truncation_misses_what_rounding_meets(tune):
    """Plain steps of `cell` lose about 4e-8 of x each, all in one direction; double-single is refused there."""
    done, found = tune("m.ode", "--tolerance", "2e-7", "--arithmetic", "cell")
    rows = {row["config"]: row for row in found["arithmetics"]}
    assert done.returncode == 0 and rows["many_full"]["met"] and rows["many_full"]["error"] < 2e-7
    alone = {row["arithmetic"]: row for row in tune("m.ode", "--tolerance", "2e-7", "-c", "cell")[1]["tried"] if row["integrator"] == "rk4"}
    assert alone["double_single"]["why"] == "double-single needs rounding to nearest, and configuration 'cell' truncates"
    if not rows["cell"]["met"]:
        assert "no other meets the tolerance" in done.stdout and rows["cell"]["lut_ns"] is None


@pytest.mark.parametrize("arguments, said", [
    (["--arithmetic", "nope"], "nope"), (["--arithmetic", "many"], "'many' computes as 'many_full' does"), (["--arithmetic", "cell", "--arithmetic", "all"], "'cell' twice"),
    (["-c", "single_full", "--arithmetic", "cell"], "LUTs and clock of configuration 'single_full' are not known")])
def test_what_is_refused(tune, arguments, said):
    done, found = tune("m.ode", "--tolerance", "1e-3", *arguments)
    assert done.returncode == 2 and said in done.stderr and found is None, done.stderr


def test_luts_and_clocks_are_those_of_the_pages(root):
    placed = {row["config"]: (row["lut4"], row["fmax_median"]) for row in json.loads((root / "docs/synth.json").read_text())["rows"]
              if (row["top"], row["device"], row["grade"]) == ("fp3", "LFE5U-85F", 6)}
    for name, (luts, mhz) in known(root).items():
        assert placed[name][0] == luts and abs(placed[name][1] - mhz) < 0.05, name


@pytest.mark.parametrize("config, model", [("many_full", "m.ode"), *((config, "roots.ode") for config in ("flush", "cell", "fused_full", "log")),
                                           *(pytest.param(config, model, marks=pytest.mark.long) for config, model in (
                                               ("many_full", "roots.ode"), ("middle", "roots.ode"), ("pairs", "m.ode"), ("pairs", "roots.ode"), ("log", "m.ode")))])
def test_a_trimmed_configuration_is_a_legal_one(tune, root, config, model):
    done = tune(model, "--tolerance", "1e-2", "-c", config, "--hardware")[0]
    trimmed = tomllib.loads(done.stdout[done.stdout.index("[[config]]"):])["config"][0]
    sys.path.insert(0, str(root / "tools"))
    from fp3gen import configs, read
    machine = read.load(root)
    whole = {row["name"]: row for row in machine.configs}[config]
    row = configs.check_configs([trimmed], machine.keys)[0]
    assert all(row[key] == whole[key] for key in ("fused", "subnormal", "nearest", "finite", "logarithmic", "fraction", "add_cuts", "mul_cuts", "add_latency", "mul_latency"))
    assert row["mixed"] == (whole["mixed"] and row["estimate"])
    assert (row["select"], row["estimate"]) == ((1, 1) if model == "roots.ode" else (0, 0)) and row["chain"] <= whole["chain"]
