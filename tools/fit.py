#!/usr/bin/env python3
"""How many lanes of a configuration an FPGA has room for at most: synthesises a group of four, by yosys.

    tools/fit.py --config fabric
    tools/fit.py --config fabric --set registers=32 --set select=0      with other keys of isa/configs.toml

Prints what a lane takes, and the most lanes for which the device has enough. The scheduler, the bus and what a placer leaves empty are not
counted, so fewer lanes fit. Cells are the fewest logic cells that a lane takes: one for a LUT, two for a carry, six for a distributed RAM of
16 words of 4 bits. It takes about a minute. Netlists and logs go to build/synth/, and are made again if files or keys change.
"""

import argparse
import pathlib
import sys

import chip
import synth
from fp3fpga import flow
from fp3fpga.families import DEVICES
from fp3gen.check import Bad
from fp3gen.read import load

CELLS = {"LUT4": 1, "CCU2C": 2, "TRELLIS_DPR16X4": 6}
NAMES = {"cells": "logic cells", "ff": "flip-flops", "dsp": "multipliers", "ebr": "block RAMs"}


def of_lane(tools, config, keys):
    """What a lane takes of each, of a configuration with these keys."""
    row = chip.array(argparse.Namespace(config=config, lanes=2 * synth.LANES["group"], set=keys))
    _, wrapper, _ = synth.lanes(row, synth.LANES["group"])
    name = f"fit-{row['name']}"
    (synth.ROOT / synth.WORK).mkdir(parents=True, exist_ok=True)
    synth.synthesise(tools, name, wrapper, [], "ecp5", flow.has_own("ecp5", row))
    found = synth.cells(synth.ROOT / synth.WORK / f"{name}.json")
    used = {**synth.figures(name, synth.FAMILIES["ecp5"]), "cells": sum(n * found[cell] for cell, n in CELLS.items())}
    return {figure: used[figure] / synth.LANES["group"] for figure in ("lut4", *NAMES)}


def most(lane, has):
    """The most lanes, and what limits them."""
    room = {**has, "cells": has["lut4"]}
    return min((int(room[figure] // lane[figure]), name) for figure, name in NAMES.items() if lane[figure])


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--config", choices=[row["name"] for row in load(synth.ROOT).configs if row["interleave"] and row["schedulers"] == row["tiles"] == 1],
                        required=True)
    parser.add_argument("--set", metavar="KEY=VALUE", type=chip.setting, action="append", default=[], help="a key of isa/configs.toml; may be repeated")
    parser.add_argument("--device", choices=[name for name, device in DEVICES.items() if device.family == "ecp5"], default="LFE5U-85F",
                        help="default: %(default)s")
    parser.add_argument("--tools", type=pathlib.Path, default=flow.TOOLS, help="where yosys is (default: %(default)s)")
    args = parser.parse_args()
    chip.check_settings(parser, args.set, "--config says whose lanes they are")
    return args


def main():
    args = arguments()
    try:
        flow.require(args.tools, ("yosys",))
        lane = of_lane(args.tools, args.config, args.set)
    except (Bad, RuntimeError) as problem:
        sys.exit(f"fit.py: {problem}")
    lanes, least = most(lane, DEVICES[args.device].has)
    print(f"a lane of {args.config}: {lane['lut4']:.0f} LUT4, {lane['cells']:.0f} cells, {lane['ff']:.0f} flip-flops, {lane['dsp']:.0f} multipliers, "
          f"{lane['ebr']:.0f} block RAMs; at most {lanes} on an {args.device}, by its {least}")


if __name__ == "__main__":
    main()
