"""Models where inverses are made by logarithms: the words of all engines and of the compiler's reference, errors, every exponent, and what is refused."""

import math
import pathlib
import re
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/logarithmic.md").read_text(encoding="utf-8").split("## The mixed lane")[1].split("\n## ")[0]


def start(*arguments, status=0, **options):
    done = subprocess.run([*map(str, arguments)], capture_output=True, text=True, timeout=200, **options)
    assert done.returncode == status, done.stdout + done.stderr
    return done.stdout + done.stderr


def agree(build, config, integrator):
    out = start(build / "tests/words_agree", config, integrator, 50, *sorted(ROOT.glob("programs/*.ode")))
    rows = re.findall(r"^(\w+) (\d+) words (\d+) differ (\S+)$", out, re.M)
    assert len(rows) == len(out.splitlines()) == 24 and all(int(words) >= 6 and differ == "0" for _, words, differ, _ in rows), out
    return {name: float(error) for name, _, _, error in rows}


def test_all_engines_have_the_same_words_and_rounding_errors_are_those_of_estimates(build):
    mixed, plain = agree(build, "pairs", "rk4"), agree(build, "many_full", "rk4")
    ratio = {name: mixed[name] / plain[name] for name in mixed}
    assert mixed != plain and max(ratio.values()) < 1.5 and math.exp(sum(map(math.log, ratio.values())) / len(ratio)) < 1.2, ratio


def test_elimination_has_the_same_words(build):
    agree(build, "pairs", "ros2")


def test_every_exponent(build):
    """Right, or refused; of subnormal operands and reciprocals, too."""
    stated = dict(re.findall(r"^\| `(.*)` \| (\d\.\d+) \|$", PAGE, re.M))
    rows = re.findall(r"^(.*?): (\d+) checked, 0 wrong, (\d+) refused, ([\d.]+) ulp$", start(build / "tests/flushed", "pairs"), re.M)
    assert {row[0] for row in rows} == stated.keys() and len(rows) == 8
    for name, checked, refused, ulp in rows:
        assert int(checked) == 255**2 and int(refused) > 0 and float(stated[name]) - 0.05 < float(ulp) <= float(stated[name]), (name, ulp)


MODEL = "state a = 1\nstate b = 1\nstate q = 0\nstate r = 0\nstep 1\na' = 0*a\nb' = 0*b\nq' = {}\nr' = {}\n"


@pytest.fixture
def run(fp3, tmp_path):
    def run(engine, quotient, root, a, b, status):
        (tmp_path / "edge.ode").write_text(MODEL.format(quotient, root))
        out = start(fp3, "run", "edge.ode", "-c", "pairs", "-e", engine, "-i", "euler", "-n", "1", "-N", "1", "--all", "--set", f"a={a}", "--set", f"b={b}",
                    status=status, cwd=tmp_path)
        return {name: float(value) for name, value in re.findall(r"^(\w) +(\S+) +0x", out, re.M)}

    return run


@pytest.mark.parametrize("engine", ["isa", "fast", "rtl"])
def test_large_and_small_divisors(run, engine):
    """From 2^126 on the reciprocal is subnormal; below 2^-128 it overflows, also where only a number near 0 becomes of it."""
    for b in (8e37, 1.2e38, 3.2e38, 1e-38, 3.1e-39):
        found = run(engine, "a/b", "sqrt(b)", 1e38 if b > 1 else 1, b, 0)
        assert found["q"] == pytest.approx((1e38 if b > 1 else 1) / b, rel=5e-7) and found["r"] == pytest.approx(b**0.5, rel=5e-7), found
    assert run(engine, "0*b", "sqrt(b)", 1, 2e-44, 0)["r"] == pytest.approx(1.4142e-22, rel=0.03)
    for b in (2.8e-39, 1e-44, 0):
        run(engine, "a/(1 + 1/b)" if b else "1/b", "0*b", 1e30, b, 3)


def test_an_image_is_refused_where_inverses_are_made_in_another_way(fp3, tmp_path):
    kepler = ROOT / "programs/kepler.ode"
    start(fp3, "compile", kepler, "-c", "pairs", "--compensated", "--image=mixed.fp3", "-o", "mixed.s", cwd=tmp_path)
    start(fp3, "compile", kepler, "-c", "many_full", "--compensated", "--image=floats.fp3", "-o", "floats.s", cwd=tmp_path)
    mixed = "floats with inverses by logarithms"
    for image, config, made, has in (("mixed", "many_full", mixed, "floats"), ("mixed", "log", mixed, "logarithms"), ("floats", "pairs", "floats", mixed)):
        said = start(fp3, "run", f"{image}.fp3", "-c", config, "-e", "isa", cwd=tmp_path, status=2)
        assert f"the program is made for {made}: words of configuration '{config}' are {has}" in said
    assert "\n.words  mixed\n" in "\n" + (tmp_path / "mixed.s").read_text() and ".words  floats" in (tmp_path / "floats.s").read_text()
    out = start(fp3, "info", "mixed.fp3", cwd=tmp_path)
    assert re.findall(r"^for +(\w+)$", out, re.M) == ["pairs"] and re.search(r"^needs .*\bmixed\b", out, re.M)
    assert "pairs" not in re.findall(r"^for +(\w+)$", start(fp3, "info", "floats.fp3", cwd=tmp_path), re.M)
    start(fp3, "dis", "mixed.fp3", "--header", "mixed.h", cwd=tmp_path)
    assert ".arithmetic = 7,\n" in (tmp_path / "mixed.h").read_text()
