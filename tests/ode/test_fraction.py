"""Numbers with fewer fraction bits: models on every engine, quotients and roots, and what is refused since it counts on 24 bits."""

import math
import pathlib
import re
import subprocess

import pytest
import random_models
from runs import fp3

PROGRAMS = pathlib.Path(__file__).resolve().parents[2] / "programs"
CONFIGS = {"bfloat": 7, "middle": 15}
MODELS = ("ship", "oscillator", "kepler", "lotka_volterra", "roessler", "ship_drag", "arenstorf", "lorenz")
RUNS = [(model, integrator) for model in MODELS for integrator in ("rk4", "euler")] + [("oscillator", "leapfrog"), ("kepler", "leapfrog"), ("lorenz", "dopri5")]


def states(said):
    return re.findall(r"^(\w+) +(\S+) .*(0x[0-9a-f]{8})", said, re.M)


def value(said, name):
    return next(float(number) for found, number, _ in states(said) if found == name)


@pytest.mark.parametrize("config", CONFIGS)
@pytest.mark.parametrize("model, integrator", RUNS)
def test_engines_give_the_same_bits(model, integrator, config):
    """And the bits below the fraction are 0."""
    said = {engine: states(fp3("run", PROGRAMS / f"{model}.ode", "-i", integrator, "-c", config, "-e", engine, "-N", 3, "--steps", 40).stdout)
            for engine in ("isa", "fast", "rtl")}
    assert said["isa"] and said["isa"] == said["fast"] == said["rtl"]
    below = (1 << 23 - CONFIGS[config]) - 1
    assert all(int(bits, 16) & below == 0 for _, _, bits in said["isa"])
    assert any(int(bits, 16) for _, _, bits in said["isa"])


@pytest.mark.parametrize("config", CONFIGS)
def test_random_models_have_the_bits_of_their_equations(build, tmp_path, config):
    """Odd models, integrators, sets of passes and starts; some on the hardware. Functions are refused."""
    cases = [line.split() for line in random_models.cases(f"fraction {config}", 150, tmp_path, 0.2)]
    text = "".join(" ".join([*words[:2], config, *words[3:]]) + "\n" for words in cases)
    done = subprocess.run([build / "tests/random_models"], input=text, capture_output=True, text=True)
    answers = done.stdout.splitlines()
    bad = [(case, answer) for case, answer in zip(cases, answers) if answer.startswith("bad")]
    assert done.returncode == 0 and not bad and len(answers) == len(cases), (bad[:3], done.stderr)
    assert answers.count("same") > 0.4 * len(cases)


def test_the_error_is_that_of_the_fraction(tmp_path):
    """Of an oscillator by rk4 over one period: cos(2 pi) is 1."""
    off = {}
    (tmp_path / "m.ode").write_text("state x = 1\nstate v = 0\nstep 0.1\nspan 6\nx' = v\nv' = -x\n")
    for config in ("many_full", *CONFIGS):
        said = fp3("run", tmp_path / "m.ode", "-i", "rk4", "-c", config, "-e", "isa", "-N", 1, "--steps", 64, "--set", f"h={2 * math.pi / 64}").stdout
        off[config] = abs(value(said, "x") - 1)
    assert off["many_full"] < off["middle"] < 64 * 2 ** -16 < off["bfloat"] < 64 * 2 ** -8, off


@pytest.mark.parametrize("config, most", [      # a little more than the largest found
    ("bfloat", {"1/x": 0.71, "a/x": 1.3, "1/x:large": 0.71, "a/x:large": 1.4, "sqrt(x)": 1.32, "1/sqrt(x)": 0.88, "a/sqrt(x)": 1.5}),
    ("middle", {"1/x": 1.15, "a/x": 1.7, "1/x:large": 1.15, "a/x:large": 2.3, "sqrt(x)": 1.68, "1/sqrt(x)": 1.27, "a/sqrt(x)": 1.7})])
def test_quotients_and_roots(build, config, most):
    """In units of the last place."""
    said = subprocess.run([build / "tests/accuracy", config], capture_output=True, text=True, check=True).stdout
    found = {name: float(off) for name, off in re.findall(r"^(\S+) +(\S+) ulp$", said, re.M)}
    assert found.keys() == most.keys()
    for name, limit in most.items():
        assert 0.5 < found[name] <= limit, (name, found[name])


def test_a_series_is_as_long_as_the_fraction_needs(tmp_path):
    (tmp_path / "m.ode").write_text("state x = 2\nstate y = 0\nstep 1\nspan 1\nx' = 0\ny' = 1/x + 1/sqrt(x)\n")
    made = {config: int(re.search(r"^instructions +(\d+)", fp3("compile", tmp_path / "m.ode", "-i", "euler", "-c", config, "--report").stdout, re.M)[1])
            for config in ("many_full", *CONFIGS)}
    assert made["bfloat"] == made["middle"] < made["many_full"] - 1, made


MODEL = "param k = 2\nstate x = 1\nstate y = 0\nstep 0.25\nspan 2\nx' = -k*x\ny' = {}\n"


@pytest.mark.parametrize("config", CONFIGS)
@pytest.mark.parametrize("expression, options, message", [
    ("sin(x)", [], r"m\.ode:7:6: .*y' = sin\(x\): its constants are made for numbers of 24 bits, and configuration '{}' has {}"),
    ("x^k", [], r"m\.ode:7:7: .*x\^k: its constants are made for numbers of 24 bits, and configuration '{}' has {}"),
    ("x", ["--double-single"], "double-single counts on numbers of 24 bits, and configuration '{}' has {}"),
    ("1/x", ["--with=exact-division"], "`exact-division` counts on numbers of 24 bits, and configuration '{}' has {}")])
def test_what_counts_on_24_bits_is_refused(tmp_path, config, expression, options, message):
    (tmp_path / "m.ode").write_text(MODEL.format(expression))
    done = fp3("compile", tmp_path / "m.ode", "-c", config, *options, status=2)
    assert re.search(message.format(config, CONFIGS[config] + 1), done.stderr), done.stderr


@pytest.mark.parametrize("engine", ["isa", "fast", "rtl"])
@pytest.mark.parametrize("config", CONFIGS)
def test_steps_are_counted_as_far_as_the_fraction_goes(tmp_path, config, engine):
    most = 2 << CONFIGS[config]
    (tmp_path / "m.ode").write_text(MODEL.format("t"))
    run = ("run", tmp_path / "m.ode", "-c", config, "-e", engine, "-N", 1, "-i", "euler", "--set", "h=2^-12", "--steps")
    if engine != "rtl" or config == "bfloat":
        assert fp3(*run, most).stdout
    assert f"counts its steps in {config}, which ends at {most}" in fp3(*run, most + 1, status=2).stderr


@pytest.mark.parametrize("engine", ["isa", "fast", "rtl"])
def test_what_the_host_writes_is_rounded_to_nearest_even(tmp_path, engine):
    (tmp_path / "m.ode").write_text(MODEL.format("0*x"))
    run = ("run", tmp_path / "m.ode", "-c", "bfloat", "-e", engine, "-N", 1, "-i", "euler", "-n", 1, "--set", "k=0", "--set")
    for given, bits in {"1.00390625": "0x3f800000", "1.01171875": "0x3f820000", "1.004": "0x3f810000", "-3.4e38": None, "1e-42": "0x00000000", "1e-40": "0x00010000"}.items():
        if bits:
            assert ("x", bits) in [(name, word) for name, _, word in states(fp3(*run, f"x={given}").stdout)], given
        else:
            assert "numbers with fewer fraction bits do not reach it" in fp3(*run, f"x={given}", status=2).stderr
