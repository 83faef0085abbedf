"""How a netlist is made and placed, for tools/synth.py, tools/chip.py and tools/bitstream.py alike. What differs between families
is in tools/fp3fpga/families.py."""

import importlib.metadata
import pathlib
import re
import subprocess

from fp3fpga.families import DEVICES, FAMILIES
from fp3gen import fusesoc

ROOT = pathlib.Path(__file__).resolve().parents[2]
TOOLS = ROOT / ".venv/bin"       # where `make setup-fpga` and `make setup-boards` put the tools
WITHOUT_REGISTERS = ("fp3_mux4.v",)  # where a family has its own, it pays in every configuration


def tool(folder, name):
    """A program's path: as YoWASP's package names it, else by its own name."""
    packaged = folder / f"yowasp-{name}"
    return packaged if packaged.exists() else folder / name


def require(folder, names):
    """Fails if a program is not there. The first one takes minutes, so this comes before it."""
    absent = [name for name in names if not tool(folder, name).exists()]
    if absent:
        raise RuntimeError(f"there is no {' and no '.join(absent)} in {folder}: run make setup-fpga")


def version(path):
    """A program's name and version: of YoWASP's package as pip has it, else as it says itself."""
    if path.name.startswith("yowasp-"):
        for found in path.parent.parent.glob(f"lib/python3*/site-packages/{path.name.replace('-', '_')}-*.dist-info"):
            return f"{path.name} {importlib.metadata.Distribution.at(found).version}"
        return path.name
    said = subprocess.run([str(path), "--version"], capture_output=True, text=True)
    found = re.search(r"(?i)\bnextpnr-(\d\S*?)\)|^yosys (\S+)", said.stdout + said.stderr, re.M)
    return f"{path.name} {found[1] or found[2]}" if found else path.name


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
    for path in sorted((ROOT / "rtl/fpga" / (FAMILIES[family].own or family)).glob("*.v")):
        if (path.name in files and (own or path.name in WITHOUT_REGISTERS)) or (board and path.name == "fp3_board_clock.v"):
            files[path.name] = path.relative_to(ROOT).as_posix()
    return list(files.values())


def place(device, grade, limits=None, routed=None, **given):
    """The placer's arguments. limits: a file of constraints, None where the ports are registers; routed: a file for the packer;
    given: json, report, seed, mhz."""
    family = FAMILIES[DEVICES[device].family]
    words = [DEVICES[device].more, family.place, family.limits if limits else family.alone, family.bitstream.routed if routed else ""]
    return " ".join(words).format(grade=grade, limits=limits, routed=routed, **given).split()
