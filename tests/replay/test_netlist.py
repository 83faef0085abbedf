"""Netlists give the bits and the cycles of the source, with the block RAM and the multipliers of the device."""

import random
import re
import subprocess

import pytest


def netlist(root, build, family, top):
    bench = build / f"netlist/{family}_{top}.vvp"
    subprocess.run([root / "tools/netlist.sh", family, top, bench], cwd=root, check=True)
    return bench, bench.with_suffix(".v").read_text()


def cells(text):
    """Which cells there are."""
    return set(re.findall(r"^  ([A-Z][A-Z0-9_]+) ", text, re.M))


def run(bench, *more):
    done = subprocess.run(["vvp", "-n", bench, *more], capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.startswith("PASS"), done.stdout


CELLS = {"ecp5-gates": {"CCU2C", "TRELLIS_FF", "TRELLIS_DPR16X4", "DP16KD", "MULT18X18D"},
         "ecp5": {"LUT4", "CCU2C", "TRELLIS_FF", "TRELLIS_DPR16X4", "DP16KD", "MULT18X18D"},
         "ice40": {"SB_LUT4", "SB_CARRY", "SB_RAM40_4K", "SB_MAC16"}}


@pytest.mark.parametrize("family", ["ecp5-gates", *(pytest.param(name, marks=pytest.mark.long) for name in ("ecp5", "ice40"))])
def test_the_netlist_agrees_with_verilator(root, fp3, build, tmp_path, long, family):
    """A recorded session of the ship: answers, cycles and the hash of retirements."""
    image, session = tmp_path / "x.fp3", tmp_path / "x.session"
    bench, text = netlist(root, build, family, "single")
    assert cells(text) >= CELLS[family]
    subprocess.run([fp3, "asm", root / "programs/ship.s", "-o", image], check=True)
    subprocess.run([fp3, "run", image, "-c", "single", "--steps", "20" if long else "2", "--params", root / "programs/ship.cfg",
                    "--bus-log", session], check=True, capture_output=True)
    run(bench, f"+session={session}")


@pytest.mark.long
@pytest.mark.parametrize("family", ["ecp5", "ice40"])
def test_units_agree_with_the_source(root, build, long, family):
    """Adder and multiplier, value and flags, on random operands."""
    bench, text = netlist(root, build, family, "units")
    assert {"ecp5": "MULT18X18D", "ice40": "SB_MAC16"}[family] in cells(text)
    run(bench, f"+pairs={20000 if long else 200}", f"+seed={random.randrange(1, 2**31)}")
