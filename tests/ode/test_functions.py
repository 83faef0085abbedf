"""Functions of states: as near to the truth as docs/compiler.md says, in as many instructions, on every engine."""
import math
import re
import subprocess
import sys

import pytest
from runs import functions

EXACTLY = {"exp": "exp(x)", "log": "log(x)", "log2": "log2(x)", "sinh": "sinh(x)", "cosh": "cosh(x)", "tanh": "tanh(x)",
           "expm1": "expm1(x)", "log1p": "log1p(x)", "logistic": "logistic(x)"}
NUMBERS = ["x^-2.5", "x^(1/3)", "x^-0.7"]        # exponents that are numbers
PARAMS = ["x^1.4", "x^3", "x^-31", "x^100.5", "x^n"]


def run(*command):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def stated(root):
    """Of each function in the table: its instructions and its error."""
    text = (root / "docs/compiler.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (`.*?) \| .* \| ([\w ,]+) \| ([\d.]+) \|$", text.split("### Exponentials")[1].split("\n## ")[0], re.M)
    return {name: (instructions, float(error)) for name, instructions, error in rows}


@pytest.fixture(scope="module")
def measured(build):
    """The same, measured for every 40,009th float."""
    done = run(build / "tests/every_float", 40009)
    assert done.returncode == 0, done.stderr
    return {line.split()[0]: line for line in done.stdout.splitlines()}


def error(line):
    return float(re.search(r"([\d.einf]+) ulp at", line)[1])


def instructions(line):
    return re.search(r"(\d+) instructions", line)[1]


def test_functions_are_as_near_as_is_stated(stated, measured):
    rows = {name: f"`{shown}`" for name, shown in EXACTLY.items()}
    rows |= {name: "`x^n`, n a number" for name in NUMBERS} | {name: "`x^n`, n of params" for name in PARAMS}
    assert rows.keys() <= measured.keys()
    for name, row in rows.items():
        count, most = stated[row]
        assert 0 < error(measured[name]) <= most, measured[name]
        assert count == instructions(measured[name]), measured[name]


CIRCULAR = {"sin": (2**-24, "`sin(x)`"), "cos": (2**-24, "`cos(x)`"), "tan": (1, "`tan(x)`"), "atan": (1, "`atan(x)`"),
            "asin": (1, "`asin(x)`"), "acos": (1, "`acos(x)`")}


def test_every_function_is_measured():
    """atan2 has two operands: tests/ode/accuracy.c measures it."""
    assert functions() == EXACTLY.keys() | CIRCULAR.keys() | {"atan2"}


def test_circular_functions_are_as_near_as_is_stated(root, measured):
    """Sine and cosine by their absolute error, which every_float counts in units of 2^-24."""
    text = (root / "docs/compiler.md").read_text(encoding="utf-8")
    rows = {name: (count, float(most)) for name, count, most in re.findall(
        r"^\| (`\w+\(x\)`) \| .* \| (\d+) \| ([\d.e-]+)(?: ulp)? \| .* \|$", text.split("### Functions")[1].split("\n##")[0], re.M)}
    for name, (unit, row) in CIRCULAR.items():
        count, most = rows[row]
        assert most / 3 < error(measured[name]) * unit <= most, measured[name]
        assert count == instructions(measured[name]), measured[name]


def test_half_powers_are_as_near_as_is_stated(stated, measured):
    for names, row in [(["x^0.5", "x^1.5", "x^2.5", "x^3.5"], "`x^0.5` ... `x^3.5`"),
                       (["x^-0.5", "x^-1.5"], "`x^-0.5`, `x^-1.5`")]:
        assert all(0 < error(measured[name]) <= stated[row][1] for name in names)
        ends = [instructions(measured[names[0]]), instructions(measured[names[-1]])]
        assert re.findall(r"\d+", stated[row][0]) == ends


def test_results_that_are_subnormal_are_within_a_unit_or_two(measured):
    for line in measured.values():
        assert float(re.search(r"([\d.]+) subnormal units", line)[1]) <= 2.1, line


@pytest.mark.smoke
@pytest.mark.parametrize("config", ["single_full", "many_full"])
@pytest.mark.parametrize("engine", ["isa", "rtl"])
def test_special_cases_and_bits_on_the_engines(build, engine, config):
    """Values and flags: of the special cases those of the docs, of some hundred arguments those of one operation after the other."""
    done = run(build / "tests/function_values", engine, config)
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.fullmatch(r"[1-9]\d{3,4} values, 0 wrong\n", done.stdout)


@pytest.mark.smoke
def test_powers_with_tiny_exponents(tmp_path, build):
    """Whatever the exponent's size: 0 and infinity of 0, and 1 of any other number."""
    path = tmp_path / "m.ode"
    path.write_text("step 1\nparam n = 1\nstate x = 1\nstate y = 0\nx' = 0\ny' = x^n\n", encoding="utf-8")
    for n in (3e-16, 2e-16, 1e-20, 1e-40, 5e-324):
        for sign, x, power in ((1, "0", "0"), (-1, "0", "inf"), (1, "1e-45", "1"), (-1, "3e38", "1"), (1, "0.5", "1")):
            done = run(build / "fp3", "run", path, "-e", "isa", "-c", "single_full", "-i", "euler", "-n", 1, "--set", f"x={x}",
                       "--set", f"n={sign * n}", "--allow-failures")
            assert re.search(rf"^y +{power} ", done.stdout, re.M), (n, sign, x, done.stdout + done.stderr)
    assert re.search("^y +1 ", run(build / "fp3", "run", path, "-c", "single_full", "-i", "euler", "-n", 1, "--set", "x=0", "--set", "n=0").stdout, re.M)


@pytest.mark.smoke
def test_polynomials_are_those_that_the_tool_computes(root):
    done = run(sys.executable, root / "tools/polynomials.py", "--check")
    assert done.returncode == 0, done.stderr
    errors = [float(line.split()[-1]) for line in done.stdout.splitlines() if ": " in line]
    assert errors[:5] == pytest.approx([0] * 5, abs=4e-8) and errors[5:] == pytest.approx([0] * 4, abs=2e-15)


@pytest.mark.smoke
@pytest.mark.parametrize("function, key", [("exp(x)", "round"), ("log(x)", "round"), ("x^0.3", "round"), ("x^0.5", "select")])
def test_a_configuration_without_the_unit_is_refused(tmp_path, build, function, key):
    path = tmp_path / "m.ode"
    path.write_text(f"step 1\nstate x = 1\nx' = {function}\n", encoding="utf-8")
    done = run(build / "fp3", "compile", path, "-i", "euler", "-c", "shared", "-o", tmp_path / "m.s")
    assert done.returncode == 2, done.stdout
    assert "x' = " in done.stderr and re.search("needs `(select|round|reciprocal = estimate or mixed)`", done.stderr), done.stderr


@pytest.mark.smoke
def test_a_sum_of_functions_is_integrated(tmp_path, build):
    """Decay with an exponential rate: y' = -exp(y) from 0 is -log(1 + t)."""
    path = tmp_path / "m.ode"
    path.write_text("step 1/128\nspan 8\nstate y = 0\ny' = -exp(y)\nexact y = -log(1 + t)\n", encoding="utf-8")
    done = run(build / "fp3", "run", path, "-i", "rk4", "-c", "single_full", "--steps", 1024)
    assert done.returncode == 0, done.stderr
    assert float(re.search(r"^y +(\S+)", done.stdout, re.M)[1]) == pytest.approx(-math.log(9), abs=5e-6)
