"""fp3 stress: its quick form holds; a wrong coefficient turns it red; bad input; the page from what it wrote."""

import importlib.util
import json
import math
import re
import subprocess
import sys
import tomllib

import pytest

FIELDS = {"name", "model", "integrator", "arithmetic", "expected", "measured", "tolerance", "holds", "why", "section", "relation"}
SECTIONS = ["stability", "steps", "events", "drift", "reversal", "chance", "stagnation", "subnormal", "failures", "chaos"]


@pytest.fixture
def stress(fp3, tmp_path):
    """Runs `fp3 stress --quick`; gives its results."""

    def run(*arguments, status=0):
        path = tmp_path / "stress.json"
        path.unlink(missing_ok=True)
        done = subprocess.run([fp3, "stress", "--quick", "--json", path, *map(str, arguments)], capture_output=True, text=True, timeout=200)
        run.said = done.stdout + done.stderr
        assert done.returncode == status, run.said
        return json.loads(path.read_text())["results"] if path.exists() else None

    return run


@pytest.mark.parametrize("section", SECTIONS)
def test_a_section_holds(stress, section):
    rows = stress("-i", "rk4", "--only", section)
    assert rows and all(set(row) == FIELDS and row["holds"] and row["section"] == section and not row["why"] for row in rows)


@pytest.mark.long
@pytest.mark.parametrize("name", ["flush", "cell", "fused_full", "bfloat", "middle", "log"])
def test_another_arithmetic(stress, name):
    """Asked for by name, it runs in the sections that are left out of the quick form, too, and nothing else does. In 7 bits roundings
    hide the limits, and long runs stand still."""
    rows = stress("-i", "rk4", "--arithmetic", name)
    hidden = {"stability", "drift", "chaos"} if name == "bfloat" else set()
    assert all(row["holds"] and row["arithmetic"] == name for row in rows)
    assert {row["section"] for row in rows} == {"stability", "steps", "drift", "stagnation", "subnormal", "failures", "chaos"} - hidden


@pytest.mark.long
def test_sums_of_logarithms_are_too_large_in_the_mean(stress):
    """By 0.015 last places, so that a planet's energy falls in each step by 4 times that; a last place is ln 2 2^-23 of a number."""
    row, = [row for row in stress("-i", "rk4", "--arithmetic", "log", "--only", "drift")]
    assert row["expected"] == pytest.approx(-4 * 0.015 * math.log(2) * 2 ** -23, rel=0.02) and row["measured"] == pytest.approx(row["expected"], rel=0.1)


def test_every_arithmetic_of_a_named_configuration_is_tried(stress, root):
    """One row of sw/lab/stress/lab.c for each."""
    found = {row["arithmetic"] for row in stress("--only", "failures")}
    said = tomllib.loads((root / "isa/configs.toml").read_text(encoding="utf-8"))
    defaults = {key: said["key"][key]["default"] for key in ("arithmetic", "fraction")}
    of = {config["name"]: (config.get("multiply_add") == "fused", *(config.get(key, default) for key, default in defaults.items())) for config in said["config"]}
    assert {of[name] for name in found & of.keys()} | {of["many_full"]} == set(of.values())
    assert found - of.keys() == {"plain", "compensated", "double_single"}


def test_stability_limits_are_those_of_the_books(stress):
    """2 sqrt 2 and 2.785 (Hairer and Wanner, Solving Ordinary Differential Equations II, IV.2); 2 for Verlet's method. Of rkc8
    2 w0/w1, w1 = T_8'(w0)/T_8''(w0), as a + b T_8 is 1 at w0 and -w0: Sommeijer, Shampine and Verwer 1997."""
    w = 1 + 2 / 13 / 64
    u = math.acosh(w)
    slope = 8 * math.sinh(8 * u) / math.sinh(u)
    beta = 2 * w * (64 * math.cosh(8 * u) - w * slope) / (w * w - 1) / slope
    rows = {(row["integrator"], row["name"]): row for row in stress("-i", "rk4", "-i", "verlet", "-i", "rkc8", "--only", "stability")}
    for integrator, degrees, limit in [("rk4", 0, 2.785293563), ("rk4", 90, math.sqrt(8)), ("verlet", 90, 2), ("rkc8", 0, beta)]:
        row = rows[integrator, f"limit of h|lambda| at {degrees} degrees from decay"]
        assert row["expected"] == pytest.approx(limit, rel=1e-6)
        assert row["measured"] == pytest.approx(limit, rel=1e-3) and row["tolerance"] == pytest.approx(limit / 1000)


def test_what_is_judged_in_double_single(stress):
    """Its errors are told in units of its own; its overflow is that of a product, in an earlier step."""
    end = [row for row in stress("-i", "rk4", "--only", "steps") if row["arithmetic"] == "double_single" and "2^-48" in row["name"]]
    assert len(end) == 1 and abs(end[0]["measured"] - end[0]["expected"]) < 100 < end[0]["tolerance"] < 2000
    assert any(row["arithmetic"] == "double_single" and "in step 97: overflow" in row["name"] for row in stress("--only", "failures"))


@pytest.mark.long
def test_in_double_the_coefficients_are_those_of_the_program(stress):
    """Of rk6, 1/3 and others as FP32 has them: 1.2e-5; as they are, -3.5e-7 (by a program of its own, in double)."""
    row = [row for row in stress("-i", "rk6", "--only", "drift") if row["arithmetic"] == "compensated" and row["name"].startswith("energy")][0]
    assert row["expected"] == pytest.approx(1.186e-5, rel=0.01)


def test_a_linearly_implicit_method_has_no_limit(stress):
    rows = stress("-i", "rodas3", "--only", "stability")
    assert len(rows) == 3 and all(row["expected"] is None and row["measured"] is None and row["tolerance"] == 0 for row in rows)


@pytest.mark.parametrize("integrator, section, factor, is_found", [
    ("rk4", "stability", 1, False), ("rk4", "stability", 1.01, True), ("rk4", "steps", 1.1, True),
    ("rk4", "reversal", 1.1, True), ("verlet", "stability", 1.01, True), ("rkc8", "stability", 1.01, True),
    ("ros2", "stability", 1, False), ("ros2", "stability", 10, True), ("ros2", "steps", 1.5, True)])
def test_a_wrong_coefficient_is_found(build, integrator, section, factor, is_found):
    done = subprocess.run([build / "tests/spoiled", integrator, section, str(factor)], capture_output=True, text=True, timeout=100)
    assert done.returncode == 0, done.stderr
    wrong = int(re.fullmatch(r"\d+ results, (\d+) do not hold\n", done.stdout)[1])
    assert (wrong > 0) == is_found, done.stdout


def test_a_model(stress, root):
    rows = stress(root / "programs/pendulum.ode", "--all")
    assert {row["section"] for row in rows} == {"invariants", "steps", "reversal", "chance"}
    assert all(set(row) == FIELDS and row["holds"] for row in rows)
    assert stress.said.count("\nok ") + stress.said.startswith("ok ") == len(rows) and f"{len(rows)} results, 0 do not hold" in stress.said


def test_a_model_that_is_not_what_it_says_turns_red(stress, tmp_path):
    """A closed form that is none; params whose product overflows in FP32 and not in double."""
    model = tmp_path / "wrong.ode"
    model.write_text("param a = 1\nstate x = 1\nx' = -a*x\nstep 0.125\nspan 2\nexact x = x(0)*exp(-2*a*t)\n")
    rows = stress(model, status=3)
    assert [row["name"] for row in rows if not row["holds"]] == ["solutions in double by two methods that agree"]
    assert "FAIL steps: wrong, rk4, plain: " in stress.said and re.search(r"why: .*closed form", stress.said), stress.said
    model.write_text("param a = 1\nstate x = 1e15\nx' = a*(x^3 - x^3)\nstep 0.125\nspan 2\n")
    wrong = [row for row in stress(model, status=3) if not row["holds"]]
    assert any(row["section"] == "chance" and "fail in FP32 alone" in row["why"] and "object 0 in step 1: " in row["why"] for row in wrong), wrong


def test_bad_input(stress, tmp_path, root):
    for arguments, message in [(["--only", "nope"], "no section 'nope': there are stability, steps"),
                               (["--only", "steps", root / "programs/ship.ode"], "found --only with a model"),
                               ([tmp_path / "none.ode"], "none.ode"), ([root / "programs/ship.s"], "expected"),
                               (["--arithmetic", "nope"], "no arithmetic 'nope': there are plain, compensated, flush"),
                               (["--arithmetic", "cell", root / "programs/ship.ode"], "found --arithmetic with a model"),
                               (["-i", "rk5"], "no integrator 'rk5'"), ([root / "programs/ship.ode", "-i", "verlet", "--only", "x"], "--only")]:
        assert stress(*arguments, status=2) is None
        assert message in stress.said, stress.said
    model = tmp_path / "bad.ode"
    model.write_text("state x = 1\nx' = y\nstep 1\n")
    assert stress(model, status=2) is None and f"{model}:2:6: error: " in stress.said


@pytest.mark.skipif(not importlib.util.find_spec("matplotlib"), reason="needs matplotlib: make setup-bench")
def test_the_page(root, tmp_path, fp3):
    """From a small result; of the quick form none is written."""
    tool, path = [sys.executable, root / "tools/pages.py", "stress", "--results", tmp_path, "--docs"], tmp_path / "stress.json"
    part = tmp_path / "part.json"
    subprocess.run([fp3, "stress", "--quick", "-i", "rk4", "--only", "stability", "--json", part], check=True, capture_output=True)
    found = json.loads(part.read_text())
    rows = found["results"]
    rows[0] |= {"holds": False, "why": "it is not so"}
    found["curves"] += [{"figure": figure, "series": "rk4, plain", "x": [0.1, 0.2], "y": [1e-5, 1e-3]} for figure in ("steps", "energy", "place")]
    found["about"] = {"form": "quick", "date": "2026-01-01", "command": "make stress", "revision": "abc"}
    path.write_text(json.dumps(found))
    done = subprocess.run([*tool, root / "docs"], capture_output=True, text=True)
    assert done.returncode == 1 and "is of the quick form, the page is of the full one: run `make stress`" in done.stderr
    found["about"]["form"] = "full"
    path.write_text(json.dumps(found))
    subprocess.run([*tool, tmp_path], check=True)
    page = (tmp_path / "stress.md").read_text()
    assert "it is not so" in page and f"{len(rows)} results, of which {len(rows) - 1} hold" in page
    assert f"{rows[1]['expected']:.4f} / {rows[1]['measured']:.4f}" in page
    assert "h\\|lambda\\|" in page
    for name in re.findall(r"\((stress_\w+\.svg)\)", page):
        subprocess.run([sys.executable, "-c", "import sys, xml.dom.minidom as m; m.parse(sys.argv[1])", tmp_path / name], check=True)
