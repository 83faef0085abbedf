"""Quotients and roots where subnormal numbers are flushed: right for every exponent of both operands, or visibly refused."""

import re
import subprocess

import pytest

CONFIGS = ["flush", "cell"]
MODEL = """model edge "quotients and roots at the ends of the range"
state a = 8e37 "over"
state b = 8e37 "under"
state q = 0 "quotient"
state r = 0 "root"
step 1
span 2
a' = 0*a
b' = 0*b
q' = a/b
r' = sqrt(b)
"""


@pytest.fixture
def run(fp3, tmp_path):
    (tmp_path / "edge.ode").write_text(MODEL)

    def start(config, engine, a, b, *more):
        return subprocess.run([fp3, "run", "edge.ode", "-c", config, "-e", engine, "-i", "euler", "-n", "1", "-N", "1", "--set", f"a={a}", "--set", f"b={b}",
                               *more], cwd=tmp_path, capture_output=True, text=True, timeout=120)

    return start


@pytest.mark.parametrize("engine", ["isa", "fast", "rtl"])
@pytest.mark.parametrize("config", CONFIGS)
def test_quotients_and_roots_of_large_numbers(run, config, engine):
    for b in (8e37, 3.2e38):                                        # 2^126 is 8.5e37
        done = run(config, engine, 1e38, b)
        found = {name: float(value) for name, value in re.findall(r"^(\w) +(\S+) +0x", done.stdout, re.M)}
        assert done.returncode == 0 and not done.stderr, done
        assert abs(found["q"] / (1e38 / b) - 1) < 2.5e-7 and abs(found["r"] / b**0.5 - 1) < 2.5e-7, done.stdout


@pytest.mark.parametrize("engine", ["isa", "fast", "rtl"])
@pytest.mark.parametrize("config", CONFIGS)
def test_no_quotient_and_no_root(run, config, engine):
    for a, b in ((1, 0), (1e-30, 0), (0, 0), (0, -1e-30), (1, 2e-38), (1e38, 1), (1, -1e-30)):
        assert run(config, engine, a, b).returncode == 3, (a, b)
    assert run(config, engine, 4e37, 1).returncode == 0


@pytest.fixture(scope="module")
def stated(root):
    """Of each expression, its largest error on each configuration."""
    text = (root / "docs/arithmetic.md").read_text(encoding="utf-8").split("## Quotients and roots without")[1].split("\n## ")[0]
    return {name: dict(zip(CONFIGS, map(float, errors))) for name, *errors in re.findall(r"^\| `(.*?)` \| ([\d.]+) \| ([\d.]+) \|", text, re.M)}


@pytest.mark.parametrize("config", CONFIGS)
def test_every_exponent(build, stated, config):
    done = subprocess.run([build / "tests/flushed", config], capture_output=True, text=True, timeout=120)
    rows = re.findall(r"^(.*?): (\d+) checked, (\d+) wrong, (\d+) refused, ([\d.]+) ulp$", done.stdout, re.M)
    assert done.returncode == 0 and {row[0] for row in rows} == stated.keys(), done.stdout
    for name, checked, _, refused, ulp in rows:
        assert int(checked) >= 255**2 and int(refused) > 0, name
        assert 0 < float(ulp) <= stated[name][config], (name, ulp)


def test_a_stiff_integrator_warns(fp3, tmp_path):
    """Elimination multiplies by reciprocals of pivots, which are not scaled."""
    (tmp_path / "stiff.ode").write_text("state x = 1\nstep 0.1\nspan 1\nx' = -x*x\n")
    for config, said in (("flush", True), ("cell", True), ("many_full", False)):
        done = subprocess.run([fp3, "compile", "stiff.ode", "-c", config, "-i", "ros2", "-o", "stiff.hex"], cwd=tmp_path, capture_output=True, text=True,
                              timeout=60)
        assert done.returncode == 0 and ("derivative of the equations that is 2^126 or more" in done.stderr) == said, done.stderr


@pytest.mark.parametrize("config, why", [("flush", "needs subnormal numbers, and configuration 'flush' flushes them"),
                                         ("cell", "needs rounding to nearest, and configuration 'cell' truncates")])
def test_exact_division_is_refused(fp3, tmp_path, config, why):
    (tmp_path / "edge.ode").write_text(MODEL)
    done = subprocess.run([fp3, "compile", "edge.ode", "-c", config, "--with=exact-division"], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode != 0 and f"`exact-division` {why}" in done.stderr
