#!/usr/bin/env python3
"""A bitstream for a board: yosys, nextpnr, the family's packer. `make bitstream BOARD=ulx3s [CONFIG=many]`.

    tools/bitstream.py ulx3s                       the board's own configuration
    tools/bitstream.py icebreaker --config paper --seed 3
    tools/bitstream.py --list

boards/boards.toml says what a board is. Netlist, logs and report go to build/bitstream/work/, the bitstream to
build/bitstream/BOARD-CONFIG.{bit,bin,fs}. It is there only if the timing is met at the board's clock: whatever fails
ends the command with 1, and leaves none.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tomllib

from fp3fpga import flow
import tops
from fp3fpga.families import DEVICES, FAMILIES
from fp3gen import verilog
from fp3gen.check import Bad
from fp3gen.read import load

ROOT = pathlib.Path(__file__).resolve().parents[1]
BOARDS = ROOT / "boards/boards.toml"
WORK = pathlib.Path("build/bitstream/work")  # relative: the tools run in ROOT and see no more than that
KEYS = {"doc": str, "device": str, "grade": int, "oscillator_hz": int, "clock_hz": int, "baud": int, "light_low": int,
        "config": str, "top": str, "constraints": str}
TOPS = ("fp3_board_top", "fp3_pictures_top")

BOARD_DEVICES = [name for name, device in DEVICES.items() if FAMILIES[device.family].bitstream]


class Failed(Exception):
    """What ends the command, in words for its user."""


# ---- what a board is ----------------------------------------------------------------------------

def read_boards(path=BOARDS):
    """The entries of boards.toml by name, each with its keys checked."""
    try:
        boards = tomllib.loads(path.read_text(encoding="utf-8")).get("board", {})
    except tomllib.TOMLDecodeError as error:
        raise Bad(f"{path.name}: {error}") from None
    for name, row in boards.items():
        wrong = faults(row, path.parent)
        if wrong:
            raise Bad(f"{path.name}: board '{name}': {wrong[0]}")
    return boards


def faults(row, folder):
    """What is wrong with an entry, the first first."""
    if row.get("device") not in BOARD_DEVICES:
        return [f"'device' is to be one of {', '.join(BOARD_DEVICES)}"]
    wrong = [f"unknown key '{key}'" for key in row if key not in KEYS]
    wrong += [f"'{key}' is missing, or no {kind.__name__}" for key, kind in KEYS.items() if type(row.get(key)) is not kind]
    if wrong:
        return wrong
    wrong = [f"'{key}' is to be more than 0" for key in ("oscillator_hz", "clock_hz", "baud") if row[key] < 1]
    if row["grade"] not in DEVICES[row["device"]].grades:
        wrong.append(f"'grade' is to be one of {', '.join(map(str, DEVICES[row['device']].grades))}")
    if row["light_low"] not in (0, 1):
        wrong.append("'light_low' is to be 0 or 1")
    if row["top"] not in TOPS:
        wrong.append(f"'top' is to be one of {', '.join(TOPS)}")
    if not (folder / row["constraints"]).is_file():
        wrong.append(f"there is no {row['constraints']}")
    # Host and board may differ by 3.5 % (docs/board.md); half of that is left to the host.
    if not wrong and (divisor(row) < 4 or abs(row["clock_hz"] / divisor(row) / row["baud"] - 1) > 0.0175):
        wrong.append(f"a clock of {row['clock_hz']} Hz makes no {row['baud']} baud: {divisor(row)} cycles in a bit")
    return wrong


def divisor(row):
    """As rtl/board/fp3_board_top.v has it."""
    return (row["clock_hz"] + row["baud"] // 2) // row["baud"]


def choose(table, name, what):
    if name not in table:
        raise Failed(f"no {what} '{name}': there are {', '.join(table)}")
    return table[name]


# ---- the sources --------------------------------------------------------------------------------

def family_of(board):
    return DEVICES[board["device"]].family


def sources(board, config):
    """Those around the processor are of the board's top."""
    family = family_of(board)
    files = [*flow.sources(family, flow.has_own(family, config), board=True), tops.write(config, load(ROOT)).relative_to(ROOT).as_posix()]
    if board["top"] == "fp3_board_top":
        return files
    own = [path.relative_to(ROOT).as_posix() for folder in ("video", f"fpga/{family}") for path in sorted((ROOT / "rtl" / folder).glob("*.v"))
           if folder == "video" or path.stem.startswith("fp3_pictures_")]
    return [path for path in files if pathlib.Path(path).stem not in ("fp3_board", "fp3_board_clock", "fp3_board_top")] + own


def address_bits(config):
    return next(width for port in verilog.ports(config, load(ROOT).registers) if port
                for _, width, name in [port] if name == "s_axi_awaddr")


def parameters(board, config):
    """Of each top."""
    return {"PIN_HZ": board["oscillator_hz"], "CLOCK_HZ": board["clock_hz"], "BAUD": board["baud"],
            "LIGHT_LOW": board["light_low"], "ADDRESS_W": address_bits(config)}


def elaborate(board, config):
    """yosys, up to a checked hierarchy."""
    given = " ".join(f"-chparam {key} {value}" for key, value in parameters(board, config).items())
    return (f"read_verilog -lib {FAMILIES[family_of(board)].bitstream.cells}; "
            f"read_verilog -defer -DFP3_TOP=fp3_{config['name']} -Irtl {' '.join(sources(board, config))}; "
            f"hierarchy -check -top {board['top']} {given}; ")


# ---- the flow -----------------------------------------------------------------------------------

def run(tools, command, log, what):
    """Run a tool; its output goes to a log."""
    path = flow.tool(tools, command[0])
    if not path.exists():
        raise Failed(f"there is no {path}: run make setup-boards")
    with open(ROOT / log, "w", encoding="utf-8") as out:
        done = subprocess.run([path, *command[1:]], cwd=ROOT, stdout=out, stderr=subprocess.STDOUT)
    if done.returncode:
        said = (ROOT / log).read_text(encoding="utf-8", errors="replace").splitlines()
        errors = [line.strip() for line in said if "ERROR" in line] or said[-3:]
        raise Failed(f"{what} failed: {' / '.join(errors[:3])} ({log})")


def clock_of(report, board):
    """MHz of the clock that has the least room, and what of the device is used. The report must speak of a clock at all. A clock of
    which the constraints say more than of the processor's is as fast as that says; its MHz are told as the processor's would be."""
    wanted = board["clock_hz"] / 1e6
    rooms = [row["achieved"] / max(row.get("constraint", wanted) / wanted, 1) for row in report["fmax"].values()]
    if not rooms:
        raise Failed("place and route has timed no clock")
    mhz = min(rooms)
    if mhz < wanted:
        raise Failed(f"the timing is not met: {mhz:.2f} MHz is possible, {wanted:g} MHz is wanted. "
                     "Try another SEED=, a smaller CONFIG=, or a lower clock_hz in boards/boards.toml")
    return mhz, {cell: row for cell, row in report["utilization"].items() if row["used"]}


def check(board, config):
    if flow.is_untimed(family_of(board), config):
        raise Failed(f"configuration '{config['name']}' has no registers around its multipliers (bits 0 and 1 of mul_cuts); "
                     f"place and route for {family_of(board)} then does not see how slow they are")


def make(name, board, config, seed, tools):
    """The bitstream's path, the clock, and the cells used."""
    check(board, config)
    family, stem = FAMILIES[family_of(board)], WORK / f"{name}-{config['name']}"
    out = WORK.parent / f"{stem.name}{family.bitstream.suffix}"
    part = out.with_suffix(".part")
    (ROOT / WORK).mkdir(parents=True, exist_ok=True)
    for old in (out, part, f"{stem}.report.json"):
        (ROOT / old).unlink(missing_ok=True)
    routed = f"{stem}.routed"

    synth = family.synth.format(top=board["top"], json=f"{stem}.json")
    run(tools, ["yosys", "-q", "-p", f"{elaborate(board, config)}{synth}"],
        f"{stem}.yosys.log", "synthesis")
    # A clock that is missed is told from the report.
    run(tools, [family.tool, *flow.place(board["device"], board["grade"], f"boards/{board['constraints']}", routed, json=f"{stem}.json",
                                         report=f"{stem}.report.json", mhz=f"{board['clock_hz'] / 1e6:g}", seed=seed)],
        f"{stem}.nextpnr.log", "place and route")
    mhz, used = clock_of(json.loads((ROOT / f"{stem}.report.json").read_text(encoding="utf-8")), board)
    run(tools, family.bitstream.pack.format(routed=routed, out=part).split(), f"{stem}.pack.log", "packing")
    (ROOT / part).replace(ROOT / out)
    return out, mhz, used


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("board", nargs="?")
    parser.add_argument("--config", help="default: that of the board")
    parser.add_argument("--seed", type=int, default=1, help="of the placement (default: %(default)s)")
    parser.add_argument("--tools", type=pathlib.Path, default=flow.TOOLS, help="where the tools are (default: %(default)s)")
    parser.add_argument("--list", action="store_true", help="the boards")
    args = parser.parse_args()
    try:
        boards = read_boards()
        if args.list:
            for name, row in boards.items():
                print(f"{name}: {row['doc']}, {row['config']} at {row['clock_hz'] / 1e6:g} MHz, {row['baud']} baud")
            return
        if not args.board:
            raise Failed(f"which board? BOARD= is one of {', '.join(boards)}")
        board = choose(boards, args.board, "board")
        configs = {row["name"]: row for row in load(ROOT).configs}
        config = choose(configs, args.config or board["config"], "configuration")
        out, mhz, used = make(args.board, board, config, args.seed, args.tools)
    except (Bad, Failed, OSError) as error:
        sys.exit(f"bitstream.py: {error}")
    for cell, row in used.items():
        print(f"  {cell:<16} {row['used']:>7} of {row['available']}")
    print(f"{out}: {mhz:.2f} MHz possible, {board['clock_hz'] / 1e6:g} MHz used, {board['baud']} baud")


if __name__ == "__main__":
    main()
