"""Models in logarithmic arithmetic: the words of all engines and of the compiler's reference, errors, and what is refused."""

import math
import re
import subprocess

import pytest
import random_models


@pytest.fixture
def fp3_run(fp3, tmp_path):
    def fp3_run(*arguments, status=0):
        done = subprocess.run([fp3, *map(str, arguments)], cwd=tmp_path, capture_output=True, text=True, timeout=120)
        assert done.returncode == status, done.stdout + done.stderr
        return done.stdout + done.stderr

    return fp3_run


@pytest.fixture(scope="session")
def words_agree(root, build):
    """{model: (words, differing, rounding error)}, and those that were refused, {model: why}."""
    def words_agree(config, integrator, steps):
        done = subprocess.run([build / "tests/words_agree", config, integrator, str(steps), *sorted(root.glob("programs/*.ode"))],
                              capture_output=True, text=True, timeout=300)
        assert done.returncode == 0, done.stderr
        rows = re.findall(r"^(\w+) (\d+) words (\d+) differ (\S+)$", done.stdout, re.M)
        return {name: (int(words), int(differ), float(error)) for name, words, differ, error in rows}, dict(re.findall(r"^(\w+) refused (.*)$", done.stdout, re.M))

    return words_agree


def test_all_engines_have_the_same_words_and_rounding_errors_are_those_of_binary32(words_agree):
    """By rk4, with objects that differ. Errors are measured against the same method in double: up to 2.0 times binary32's, in the mean 0.8."""
    logs, refused = words_agree("log", "rk4", 100)
    floats, _ = words_agree("many_full", "rk4", 100)
    assert set(refused) == {"double_pendulum", "duffing", "pendulum"} and all("needs `round`" in why for why in refused.values())
    assert len(logs) == 21 and all(words >= 6 and differ == 0 for words, differ, _ in logs.values()), logs
    ratio = {name: logs[name][2] / floats[name][2] for name in logs}
    assert max(ratio.values()) < 4 and math.exp(sum(map(math.log, ratio.values())) / len(ratio)) < 1.5, ratio


@pytest.mark.parametrize("integrator, models", [("ros2", 21), ("semi_implicit_euler", 12), ("rkc6_damped", 21)])
def test_other_methods_have_the_same_words(words_agree, integrator, models):
    found, _ = words_agree("log", integrator, 20)
    assert len(found) == models and all(words >= 6 and differ == 0 for words, differ, _ in found.values()), found


def test_random_models_have_the_bits_of_the_reference(build, tmp_path):
    """Odd models, methods and starts, in plain arithmetic on the isa engine; passes that need floats, and numbers without a word, are refused."""
    cases = []
    for case in random_models.cases(77, 120, tmp_path):
        model, integrator, _, _, *rest = case.split(" ")
        cases.append(" ".join([model, integrator, "log", "0", *rest]))
    done = subprocess.run([build / "tests/random_models"], input="\n".join(cases) + "\n", capture_output=True, text=True, timeout=200)
    answers = done.stdout.splitlines()
    assert done.returncode == 0 and len(answers) == 120 and not [answer for answer in answers if answer.startswith("bad")], answers
    assert answers.count("same") > 40, answers


def test_nothing_corrects_a_quotient_or_a_root(root, fp3_run):
    """Each is one operation and a product; a force takes an rsqrt and no Newton step."""
    text = fp3_run("compile", root / "programs/kepler.ode", "-c", "log", "--report")
    cycles = {config: int(re.search(r"^cycles per object-step +(\d+)$", fp3_run("compile", root / "programs/kepler.ode", "-c", config, "--report"), re.M)[1])
              for config in ("log", "many_full")}
    assert cycles["log"] < cycles["many_full"], (cycles, text)


@pytest.mark.parametrize("expression, exact", [("1/p", lambda p: 1 / p), ("3/p", lambda p: 3 / p), ("sqrt(p)", math.sqrt), ("p/sqrt(p)", math.sqrt), ("1/p^3", lambda p: p ** -3),
                                               ("p^1.5", lambda p: p ** 1.5), ("atan(p)", math.atan), ("asin(p/16)", lambda p: math.asin(p / 16))])
def test_functions_of_numbers(fp3_run, tmp_path, expression, exact):
    """Computed by the machine, as p is a state; both conversions cost up to 0.7 times 2^-24 each."""
    (tmp_path / "f.ode").write_text(f"model f\nstate p = 1\nstate y = 0\nstep 1\np' = -p\ny' = {expression}\n")
    out = fp3_run("run", "f.ode", "-c", "log", "-e", "isa", "-i", "euler", "-N", 60, "-n", 1, "--all", "--spread", "p=1:15.75")
    found = [float(y) for y in re.findall(r"^y +(\S+)", out, re.M)]
    assert len(found) == 60
    for i, y in enumerate(found):
        assert y == pytest.approx(exact(1 + i * 0.25), rel=5 * 2 ** -24)


def test_a_root_of_zero_is_zero(fp3_run, tmp_path):
    (tmp_path / "f.ode").write_text("model f\nstate p = 0\nstate y = 1\nstate z = 1\nstep 1\np' = -p\ny' = sqrt(p)\nz' = p*(p + 2)^0.5\n")
    out = fp3_run("run", "f.ode", "-c", "log", "-e", "isa", "-i", "euler", "-N", 1, "-n", 1, "--all")
    assert re.findall(r"^([yz]) +(\S+)", out, re.M) == [("y", "1"), ("z", "1")], out


@pytest.mark.parametrize("options, said", [
    (["--compensated"], "compensated arithmetic needs sums whose rounding errors are floats, and configuration 'log' is logarithmic"),
    (["--double-single"], "double-single needs sums"),
    (["--with=exact-division"], "`exact-division` needs sums"),
    (["--tolerance=1e-4"], "time in two words, as adaptive steps have it, needs sums")])
def test_what_needs_floats_is_refused(root, fp3_run, options, said):
    command = "run" if "tolerance" in options[0] else "compile"
    assert said in fp3_run(command, root / "programs/kepler.ode", "-c", "log", *options, status=2)


@pytest.mark.parametrize("name, at", [("sin", 3), ("cos", 3), ("tan", 3), ("exp", 3), ("log", 3), ("log2", 3), ("expm1", 3), ("tanh", 3), ("sinh", 3)])
def test_functions_that_need_exponents_are_refused_by_name(fp3_run, tmp_path, name, at):
    (tmp_path / "f.ode").write_text(f"model f\nstate y = 1\ny' = {name}(y)\nstep 0.1\n")
    out = fp3_run("compile", "f.ode", "-c", "log", status=2)
    assert re.search(rf"f\.ode:{at}:\d+: error: .*{name}\(y\): needs `round`, which configuration 'log' does not have", out), out


WORDS = {"many_full": "floats", "flush": "flushed floats", "cell": "floats of Cell's SPU", "bfloat": "floats of 7 fraction bits",
         "middle": "floats of 15 fraction bits", "log": "logarithms"}


@pytest.mark.parametrize("made, engine", [(made, engine) for made in WORDS for engine in ("isa", "fast")] + [("log", "rtl"), ("flush", "rtl")])
def test_an_image_for_other_words_is_refused(root, fp3_run, made, engine):
    """A quotient without a correction has nine bits where rcp is an estimate, and one for gradual underflow is wrong for large divisors
    where numbers are flushed. An image goes through its text, too, and a configuration of the same words takes it."""
    fp3_run("compile", root / "programs/kepler.ode", "-c", made, "--image=made.fp3", "-o", "made.s")
    fp3_run("asm", "made.s", "-o", "again.fp3")
    for other, has in WORDS.items():
        for image in ("made.fp3", "again.fp3"):
            out = fp3_run("run", image, "-c", other, "-e", engine, "--steps", 1, status=2)
            assert ("'v_x' has no value" if other == made else
                    f"the program is made for {WORDS[made]}: words of configuration '{other}' are {has}") in out


def test_configurations_of_the_same_words_share_images(root, fp3_run):
    fp3_run("compile", root / "programs/ship.ode", "-c", "many_full", "--without=chain", "--image=ship.fp3")
    for config in ("fused_full", "single_full"):
        assert "has no value" in fp3_run("run", "ship.fp3", "-c", config, "-e", "isa", "--steps", 1, status=2)


def test_who_executes_an_image(root, fp3_run):
    fp3_run("compile", root / "programs/kepler.ode", "-c", "log", "--image=logs.fp3")
    out = fp3_run("info", "logs.fp3")
    assert re.findall(r"^for +(\w+)$", out, re.M) == ["log", "world_log"] and re.search(r"^needs .*\blogarithmic\b", out, re.M)
    assert "sw/bare gives hardware binary32" in fp3_run("dis", "logs.fp3", "--header", "logs.h", status=2)
    assert "  words are logarithms, products and quotients are exact; flags" in fp3_run("info")


def test_an_image_as_text_keeps_what_it_is_for(fp3_run, tmp_path):
    (tmp_path / "x.s").write_text(".words floats\n.state x\nstep:\nadd x, x, x\n")
    fp3_run("asm", "x.s", "-o", "x.fp3")
    assert fp3_run("dis", "x.fp3").startswith(".words  floats\n")
    for words in ("floats 7", "floats 22", "flushed", "flushed 7", "cell", "logarithms", "truncated", "truncated_flushed 15", "mixed"):
        (tmp_path / "x.s").write_text(f".words {words}\n.state x\nstep:\nadd x, x, x\n")
        fp3_run("asm", "x.s", "-o", "x.fp3")
        assert fp3_run("dis", "x.fp3").startswith(f".words  {words}\n")
    kinds, fraction = "floats, logarithms, flushed, cell, truncated, truncated_flushed or mixed", "a number of fraction bits from 7 to 22, or the end of the line"
    for text, said in ((".words", f"expected {kinds}"), (".words any", f"found 'any', expected {kinds}"),
                       (".words floats\n.words floats", "expected one '.words' only (line 1 has it)"), (".words floats x", f"found 'x', expected {fraction}"),
                       (".words floats 23", f"found '23', expected {fraction}"), (".words floats 6", f"found '6', expected {fraction}"),
                       (".words cell 7", "x.s:1:8: error: found 'cell', expected floats, flushed, truncated or truncated_flushed before fraction bits"),
                       (".words floats 7 7", "expected the end of the line")):
        (tmp_path / "x.s").write_text(f"{text}\n.state x\nstep:\nadd x, x, x\n")
        assert said in fp3_run("asm", "x.s", "-o", "x.fp3", status=2)
