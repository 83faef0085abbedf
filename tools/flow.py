"""How a netlist is made and placed, for tools/synth.py, tools/chip.py and tools/bitstream.py alike. What differs between families
is in tools/families.py."""

import pathlib

from families import DEVICES, FAMILIES
from fp3gen import fusesoc

ROOT = pathlib.Path(__file__).resolve().parents[1]
WITHOUT_REGISTERS = ("mux4.v",)  # where a family has its own, it pays in every configuration


def has_own(family, row):
    """Whether a configuration takes the family's own versions of modules that have registers. Those inside an ECP5's multipliers pay
    where there are cuts; the machine for one object has others."""
    return family != "ecp5" or bool(row.get("interleave"))


def is_untimed(family, row):
    """Whether place and route would not see how slow the multipliers are: it knows those with registers around them
    (cuts 0 and 1) alone."""
    return not FAMILIES[family].timed and row["mul_cuts"] & 3 != 3


def sources(family, own, board=False):
    """The files of the processor, perhaps with a board's; a file of the family takes the place of the one of that name."""
    files = {pathlib.Path(name).name: f"rtl/{name}" for name in fusesoc.rtl_sources(ROOT, "*.v")}
    if board:
        files |= {path.name: path.relative_to(ROOT).as_posix() for path in sorted((ROOT / "rtl/board").glob("*.v"))}
    for path in sorted((ROOT / "rtl/fpga" / family).glob("*.v")):
        if (path.name in files and (own or path.name in WITHOUT_REGISTERS)) or (board and path.name == "board_clock.v"):
            files[path.name] = path.relative_to(ROOT).as_posix()
    return list(files.values())


def place(device, grade, limits=None, routed=None, **given):
    """The placer's arguments. limits: a file of constraints, None where the ports are registers; routed: a file for the packer;
    given: json, report, seed, mhz."""
    family = FAMILIES[DEVICES[device].family]
    words = [DEVICES[device].more, family.place, family.limits if limits else family.alone, family.bitstream.routed if routed else ""]
    return " ".join(words).format(grade=grade, limits=limits, routed=routed, **given).split()
