"""A lane that adds and multiplies at once: the bits of the same program elsewhere, in the cycles that were predicted."""

import re
import subprocess

import pytest

LANES, CONTEXTS = 4, 30


@pytest.fixture
def run(fp3, tmp_path):
    def run(program, *options, status=0):
        done = subprocess.run([fp3, "run", program, *map(str, options)], cwd=tmp_path, capture_output=True, text=True, timeout=600)
        assert done.returncode == status, done.stdout + done.stderr
        return done.stdout + done.stderr

    return run


def states(out):
    return re.findall(r"^\w+ +\S+ +0x\w{8}   object \d+$", out, re.MULTILINE)


def cycles(out):
    return int(re.search(r"^cycles +(\d+)$", out, re.MULTILINE)[1])


def ship(root, run, program, *options):
    return run(program, "--params", root / "programs/ship.cfg", "--spread", "C=30000:50000", "--all", *options)


def test_the_ship_takes_fourteen_cycles_and_has_its_bits(root, run):
    objects = LANES * CONTEXTS
    full = [ship(root, run, root / "programs/ship_dual.s", "-c", "dual", "-N", objects, "-n", n) for n in (3, 8)]
    assert cycles(full[1]) - cycles(full[0]) == 5 * 14 * CONTEXTS
    other = ship(root, run, root / "programs/ship_scale.s", "-c", "shared", "-e", "isa", "-N", 64, "-n", 8)
    assert len(states(other)) == 128
    few = ship(root, run, root / "programs/ship_dual.s", "-c", "dual", "-N", 64, "-n", 8, "--visit", 3)
    assert states(few) == states(other)


@pytest.mark.parametrize("config, model, other", [("dual", "lorenz", "shared"), ("dual", "robertson", "shared"), ("dual", "double_spring", "shared"),
                                                  ("dual_full", "kepler", "shared_full"), ("dual_full", "arenstorf", "shared_full")])
def test_a_compiled_model_has_its_bits_and_its_cycles(root, fp3, run, config, model, other):
    path = root / f"programs/{model}.ode"
    text = subprocess.run([fp3, "compile", path, "-c", config], capture_output=True, text=True, check=True).stdout
    told = float(re.search(r"([\d.]+) cycles per object-step", text)[1])
    full = [run(path, "-c", config, "-N", LANES * CONTEXTS, "-n", n) for n in (2, 5)]
    assert (cycles(full[1]) - cycles(full[0])) / (3 * LANES * CONTEXTS) == pytest.approx(told, rel=1e-5)
    few = [run(path, "-c", name, "-e", engine, "-N", 7, "-n", 9)
           for name, engine in ((config, "rtl"), (config, "isa"), (config, "fast"), (other, "isa"))]
    assert len(states(few[0])) == 7 * len(set(re.findall(r"^\.state +(\w+)", text, re.MULTILINE)))
    assert all(states(out) == states(few[0]) for out in few)


@pytest.mark.parametrize("more, count", [([], 13), (["--with", "own-weights"], 12)])
def test_the_folded_ship_takes_thirteen_cycles_or_twelve(root, fp3, run, tmp_path, more, count):
    """13 products and 13 sums, or 12 of each: as many as there are instructions on `lanes`."""
    done = subprocess.run([fp3, "compile", root / "programs/ship.ode", "-c", "dual", "-i", "rk4_paper", "--with", "fold-step",
                           "--with", "fold-product", *more, "-o", tmp_path / "x.s", "--params", tmp_path / "x.cfg"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    full = [run("x.s", "-c", "dual", "--params", tmp_path / "x.cfg", "-N", LANES * CONTEXTS, "-n", n) for n in (3, 8)]
    assert cycles(full[1]) - cycles(full[0]) == 5 * count * CONTEXTS


def test_a_lane_without_an_object_raises_nothing(run, tmp_path):
    """The registers of three lanes are 0 and the constant is infinite: their product would be invalid."""
    (tmp_path / "x.s").write_text(".state x = r0\n.shared k\n.temp p = r1\nstep: mul p, x, k\nadd x, x, 1.0\n")
    assert re.search("^flags +none$", run("x.s", "-c", "dual", "-N", 1, "-n", 2, "--set", "x=1", "--set", "k=inf"), re.MULTILINE)
    assert re.search("^flags +invalid$", run("x.s", "-c", "dual", "-N", 1, "-n", 2, "--set", "x=0", "--set", "k=inf", status=3), re.MULTILINE)


@pytest.mark.parametrize("word, wrong", [
    ("add r1, r2, k0", "word 0 (add) writes a sum to a register of odd number"),
    ("mul r2, r2, k0", "word 0 (mul) writes a product to a register of even number"),
    ("sub r0, r2, r4", "word 0 (sub) reads two registers of even number"),
    ("mul r1, r3, r3", "word 0 (mul) reads two registers of odd number"),
    ("addh r0, r1, k0", "word 0 (addh) adds a scaled value to a register of odd number"),
    ("subt r0, k0, r2", "word 0 (subt) scales a register of even number"),
    ("rcp r0, r2", "word 0 (rcp) writes an estimate to a register of even number"),
    ("rsqrt r1, r3", "word 0 (rsqrt) estimates from a register of odd number")])
@pytest.mark.parametrize("engine", ["rtl", "isa", "fast"])
def test_sums_and_products_are_apart(run, tmp_path, engine, word, wrong):
    (tmp_path / "x.s").write_text(f"step:\n    {word}\n")
    config = "dual_full" if word.startswith("r") else "dual"
    said = run("x.s", "-c", config, "-e", engine, status=2)
    assert f"{wrong}: configuration '{config}' keeps sums in registers of even number" in said
