"""A multiply-add that is rounded once: programs say that they want it, and the compiler knows what it is good for."""

import re

import pytest
from runs import fp3

QUOTIENTS = """model quotients
state x = 1.7 "grows"
state y = 3.3 "grows"
state q = 0 "sum of quotients"
state s = 0 "sum of roots"
step 0.25
span 8
x' = 0.37
y' = 0.11
q' = x/y
s' = sqrt(x)
"""


def states(said):
    """The bits of the states of object 0, by name."""
    return {row[1]: row[2] for row in re.finditer(r"^(\w+) .* (0x[0-9a-f]{8}(?: 0x[0-9a-f]{8})?) +object 0$", said, re.M)}


def numbers(said):
    return {row[1]: float(row[2]) for row in re.finditer(r"^(\w+) +(\S+) .*object 0$", said, re.M)}


def cycles(model, config, *options):
    return int(re.search(r"^cycles per object-step +(\d+)$", fp3("compile", model, "-c", config, "--report", *options).stdout, re.M)[1])


@pytest.mark.parametrize("made, taken, what", [
    ("many_full", "fused_full", "is a chained multiply-add, which configuration 'fused_full' does not have"),
    ("fused_full", "many_full", "is a multiply-add that is rounded once, which configuration 'many_full' does not have")])
def test_a_program_for_the_other_rounding_is_refused(root, tmp_path, made, taken, what):
    fp3("compile", root / "programs/ship.ode", "-c", made, f"--image={tmp_path / 'ship.fp3'}")
    assert what in fp3("run", tmp_path / "ship.fp3", "-c", taken, "-e", "isa", status=2).stderr


@pytest.mark.parametrize("engine", ["isa", "fast", "rtl"])
def test_quotients_and_roots_are_those_of_the_longer_way(tmp_path, engine):
    """Without `chain`, which here changes bits; with one instruction less for each remainder they are still rounded correctly."""
    (tmp_path / "quotients.ode").write_text(QUOTIENTS)
    said = {}
    for config in ("many_full", "fused_full"):
        image, params = tmp_path / f"{config}.fp3", tmp_path / f"{config}.params"
        fp3("compile", tmp_path / "quotients.ode", "-c", config, "-i", "euler", "--with=exact-division", "--without=chain",
            f"--image={image}", f"--params={params}")
        said[config] = states(fp3("run", image, f"--params={params}", "-c", config, "-e", engine, "-N", 1, "-n", 30).stdout)
    assert said["many_full"] == said["fused_full"] and len(said["many_full"]) == 4 and said["many_full"]["q"] != "0x00000000"


def test_a_pair_takes_less(root):
    """Measured: 718 of 1,074 cycles, 360 of 488. The error of a product is one instruction; the states agree to a few units of 48 bits."""
    kepler = root / "programs/kepler.ode"
    assert cycles(kepler, "fused_full", "--double-single") < 0.7 * cycles(kepler, "many_full", "--double-single")
    assert cycles(kepler, "fused_full", "--with=exact-division") < 0.75 * cycles(kepler, "many_full", "--with=exact-division")
    assert cycles(kepler, "fused_full", "--double-single", "--without=fuse") == cycles(kepler, "many_full", "--double-single")
    one, other = (numbers(fp3("run", kepler, "-c", config, "-e", "isa", "-N", 1, "-n", 800, "--double-single").stdout)
                  for config in ("many_full", "fused_full"))
    assert one.keys() == other.keys() >= {"r_x", "r_y", "v_x", "v_y"}
    assert all(abs(one[name] - other[name]) < 1e-11 for name in ("r_x", "r_y", "v_x", "v_y"))
    assert one != other
