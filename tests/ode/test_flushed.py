"""Quotients and roots where subnormal numbers are flushed: right up to about 2^126, a warning beyond, a failure at 0 and below."""

import re
import subprocess

import pytest

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

    def start(config, engine, a, b):
        return subprocess.run([fp3, "run", "edge.ode", "-c", config, "-e", engine, "-i", "euler", "-n", "1", "-o", "1", "--set", f"a={a}", "--set", f"b={b}"],
                              cwd=tmp_path, capture_output=True, text=True, timeout=120)

    return start


@pytest.mark.parametrize("engine", ["isa", "fast", "rtl"])
@pytest.mark.parametrize("config", ["flush", "cell"])
def test_quotients_and_roots(run, config, engine):
    done = run(config, engine, 8e37, 8e37)                          # 2^126 is 8.5e37
    found = {name: float(value) for name, value in re.findall(r"^(\w) +(\S+) +0x", done.stdout, re.M)}
    assert done.returncode == 0 and abs(found["q"] - 1) < 2e-7 and abs(found["r"] / 8e37**0.5 - 1) < 5e-7, done.stdout
    assert "from about 2^126 on are wrong" in done.stderr
    assert run(config, engine, 1, 0).returncode == 3 and run(config, engine, 1, -1).returncode == 3


def test_gradual_underflow_needs_no_warning(run):
    done = run("many_full", "isa", 1e38, 1e38)
    assert done.returncode == 0 and not done.stderr
