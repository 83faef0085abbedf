"""What a configuration takes and gives on each device, as tables, for tools/pages.py: docs/synth.json, with what was measured here (tools/measured.py), to
docs/sizes.md and between the marks of docs/integration.md and docs/chip_results.md.

A figure that was not measured is "–".
"""

import pathlib
import sys
import tomllib

from fp3fpga import flow
from fp3fpga.families import DEVICES, FAMILIES
from fp3gen.text import between, evidence, markdown

ROOT = pathlib.Path(__file__).resolve().parents[1]
UNTIMED = "no registers around its multipliers"
FIGURES = {"lut4": "LUT", "ff": "FF", "dsp": "DSP", "ebr": "block RAM"}

# The device of a configuration that is for one.
FOR = {"small": "iCE40UP5K"}
# For each need the configuration, and whether the time of one step counts there or the steps of all objects.
NEEDS = [(row["take"], row["name"], "all" if "store_words" in row else "step", *FOR.get(row["name"], "").split())
         for row in tomllib.loads((ROOT / "isa/configs.toml").read_text(encoding="utf-8"))["config"] if "take" in row]
NEEDS.sort(key=lambda need: need[1] == "paper")  # what is for comparison alone comes last


def processors(rows):
    """The rows of docs/sizes.md."""
    order = {device: n for n, device in enumerate(DEVICES)}
    rows = [row for row in rows if row["top"] == "fp3" and row["device"] in order]
    if not rows:
        sys.exit("no processor was measured: run `make sizes` first")
    rows.sort(key=lambda row: (order[row["device"]], row["fmax_best"] is None, row["grade"], row["lut4"]))
    # What was not placed is the same at each grade: one row, and none beside one with a clock.
    first = {}
    for row in rows:
        first.setdefault((row["device"], row["config"]), row)
    return [row for row in rows if row["fmax_best"] or row is first[row["device"], row["config"]]]


def number(x, digits=0):
    return "–" if x is None else f"{x:,.{digits}f}"


def too_much(row):
    return ", ".join(f"{percent:.0f} % of {FIGURES[figure]}" for figure, percent in row["over"].items())


def obstacle(row):
    """Why it is not to be used on the device, or nothing."""
    return too_much(row) if row["over"] else UNTIMED if row.get("untimed") else ""


def clock(row):
    if row["over"]:
        return f"does not fit: {too_much(row)}"
    if row.get("untimed"):
        return f"not timed: {UNTIMED}"
    if row["fmax_best"] is None:
        return "not placed" if FAMILIES[DEVICES[row["device"]].family].tool else "synthesis only"
    return f"{row['fmax_median']:.1f} / {row['fmax_best']:.1f}"


def per(row, figure, unit):
    """Object-steps per second of a figure's unit, in millions."""
    steps = row["object_steps_per_second"]
    return None if steps is None or not row[figure] else steps * unit / row[figure] / 1e6


def sizes(rows):
    return markdown(
        ["device", "grade", "configuration", "LUT", "carry", "cells", "FF", "DSP", "block RAM", "MHz, median / best", "seeds",
         "cycles per object-step", "million object-steps/s", "per 1,000 LUT", "per DSP"],
        [[row["device"], row["grade"] if row["grade"] and row["fmax_best"] else "–", f"`{row['config']}`", number(row["lut4"]), number(row["carry"]), number(row["comb"]), number(row["ff"]),
          row["dsp"], row["ebr"], clock(row), ", ".join(map(str, row["seeds"])) or "–", number(row["cycles"], 2),
          number(row["object_steps_per_second"] and row["object_steps_per_second"] / 1e6, 2),
          number(per(row, "lut4", 1000), 2), number(per(row, "dsp", 1), 2)] for row in rows])


def devices(rows):
    measured = {row["device"]: row["tools"] for row in rows}
    return markdown(["device", "family", "package", "LUT", "FF", "DSP", "block RAM", "tools"],
                    [[name, FAMILIES[DEVICES[name].family].maker, DEVICES[name].package or "–",
                      *(number((DEVICES[name].has or {}).get(figure)) for figure in FIGURES), ", ".join(tools)]
                     for name, tools in measured.items()])


def commands(rows):
    """How each device was synthesised and placed, as families.py has it."""
    lines = []
    for name in {row["device"]: 0 for row in rows}:
        family = FAMILIES[DEVICES[name].family]
        lines.append(f"- {name}: `{family.synth.format(top='top', json='NETLIST')}`")
        if family.tool:
            words = flow.place(name, "GRADE", "PINS" if family.pin else None, seed="SEED", mhz="200", json="NETLIST", report="REPORT")
            lines.append(f"  and `{' '.join([family.tool, *words])}`")
    return lines


def choose(rows):
    """For each need the configuration, what it takes and gives on its device, or else the first where it was measured; where it was placed,
    where it has room by its counts, and where it has none."""
    lines = []
    for need, config, counts, *wanted in NEEDS:
        mine = [row for row in rows if row["config"] == config]
        first = min(mine, key=lambda row: (row["device"] not in (wanted or [row["device"]]), row["fmax_best"] is None, bool(row["over"])), default=None)
        here = [row for row in mine if DEVICES[row["device"]].has]
        placed = {row["device"] for row in here if row["fmax_best"]}
        out = {row["device"]: f"{row['device']}: {obstacle(row)}" for row in here if obstacle(row)}
        fits = [row["device"] for row in here if row["device"] not in placed | out.keys()]
        speed = None if first is None or first["latency_ns"] is None else (
            f"{first['latency_ns']:,.0f} ns a step" if counts == "step" else f"{first['object_steps_per_second'] / 1e6:.1f} million object-steps/s")
        lines.append([need, f"`{config}`", *(number(first and first[figure]) for figure in FIGURES),
                      f"{speed} on {first['device']}, grade {first['grade']}" if speed else "–",
                      *(", ".join(device for device in DEVICES if device in some) or "–" for some in (placed, fits)), "; ".join(out.values()) or "–"])
    return markdown(["you have", "take", *FIGURES.values(), "measured", "placed on", "room by its counts, not placed", "not on"], lines)


def page(rows):
    return "\n".join([
        "<!-- Generated by tools/pages.py (make report PAGES=sizes) from docs/synth.json: do not edit. -->",
        "# Sizes and clocks on devices of several families", "", "*Measured, for FPGAs.*", "",
        "`make setup-fpga sizes` measures what is below and `make report PAGES=sizes` writes this page; `make sizes DEVICE=LFE5U-25F CONFIG=single SEEDS=1,2,3`",
        "a part of it. Which configuration is for what is in [integration.md](integration.md#choose-a-configuration).", "", *evidence("sizes"), "",
        *sizes(rows), "",
        "- LUT, carry cells, flip-flops, multipliers and block RAMs are those of the netlist; cells what the placer makes of the logic (on ECP5 two for",
        "  each carry cell, and distributed RAM; on Gowin without its carry cells). LUTs have four inputs, on 7 series up to six, on Cyclone V they are ALUTs.",
        "- DSP is in multipliers of 18 by 18 bits, those of 9 by 9 as half a one, rounded up; on iCE40 16 by 16, on 7 series DSP48E1, on Cyclone V blocks.",
        "  A block RAM has 18 kbit on ECP5, Gowin and Nexus, 4 on iCE40, 36 on 7 series, 10 on Cyclone V.",
        "- Distributed RAM and shift registers are not among the LUTs. Multipliers and block RAMs are inferred from the portable modules; where `rtl/fpga/` has a",
        "  family's own version of one, that takes its place (on ECP5 those with registers only if contexts are interleaved), equal to it by a test.",
        "  An iCE40 has no distributed RAM: registers of objects and constants become block RAM there. The rows of 7 series and Cyclone V were measured while",
        "  memories had contents at power-up, for which yosys made flip-flops on Cyclone V, and with the portable multiplier: today's netlists are smaller.",
        "- Each processor has registers around its ports, which are counted: 138 for one scheduler on ECP5, 7 series and Cyclone V. The others have three pins, into which",
        "  inputs are shifted and from which the outputs' parity comes.",
        "- Seeds are those of the placement. One seed says little about the best one: on ECP5 they differ by 10 % and more. Cycles and steps are those of the ship,",
        "  by its cheapest program there ([results.md](results.md)), the speed that of the best seed.",
        "- The clock is nextpnr's estimate, with no device behind it. That of Gowin is too good: its author found it about 20 % above the vendor's tool",
        "  (nextpnr, pull request 1345, 2024), and its multipliers and memories have no delay there ([board.md](board.md)). No clock is known where the family has no open placer.",
        "- An iCE40's multipliers are in the timing only where they have registers around them, so a configuration without is not placed there, and",
        "  `make bitstream` refuses it.",
        "- On GW2AR-18 `single` has seed 2: with seed 1 an earlier netlist was not routed, as one arc found no way.",
        "- What is not placed or not in the table was not measured. Each row is measured alone, and keeps its figures until it is measured again.", "",
        "## Devices", "", *devices(rows), "",
        "What a device has is from its data sheet; a Gowin or ECP5 slice's flip-flops and LUTs are not always usable together, so that",
        "what has room here may still not be placed.", "",
        "## Commands", "", *commands(rows), ""])


def chips(rows):
    """Each chip full of lanes, as docs/chip_results.md has it."""
    lines = []
    for row in rows:
        if row["top"] == "chip":
            has = DEVICES[row["device"]].has
            lines.append([f"`{row['config']}`", row["grade"], f"{number(row['comb'])} ({100 * row['comb'] / has['lut4']:.0f} %)",
                          f"{number(row['ff'])} ({100 * row['ff'] / has['ff']:.0f} %)", row["ebr"], row["dsp"], f"{row['goal']:g}",
                          ", ".join(f"{mhz:.1f} ({seed})" for seed, mhz in zip(row["seeds"], row["fmax_all"], strict=True)), number(row["cycles"], 4),
                          number(row["object_steps_per_second"] and row["object_steps_per_second"] / 1e6)])
    return markdown(["chip", "grade", "logic cells", "FF", "block RAM", "multipliers", "MHz wanted", "MHz reached (seed)", "cycles per object-step",
                     "million object-steps/s"], lines)


def pages(rows, page_of):
    """Each page that comes from the rows, and its text; page_of: the text of a page as it is."""
    sized = processors(rows)
    return {"sizes.md": page(sized), "integration.md": between(page_of("integration.md"), "choose", choose(sized)),
            "chip_results.md": between(page_of("chip_results.md"), "chips", chips(rows))}
