"""A floorplan for lanes on an LFE5U-85F: where each lane's multipliers and block RAMs are.

Placed freely, a chip full of lanes does not legalise, or its nets are too long. Multipliers and block RAMs stand in rows; with
those of a lane pinned near each other, the placer puts the rest of the lane between them.
"""

import collections
import re

# Sites as nextpnr names them, X../Y../NAME: thirteen blocks side by side, each with four multipliers in each of three rows
# and four block RAMs in each of four.
BLOCKS = (4, 13, 22, 31, 40, 49, 58, 69, 78, 87, 96, 105, 114)
MULTIPLIERS = [(x + at, f"MULT18_{name}") for x in BLOCKS for at, name in ((0, 0), (1, 1), (4, 4), (5, 5))]
MULTIPLIER_ROWS = (10, 34, 58)
RAMS = [(x + 2 * n, f"EBR{n}") for x in BLOCKS for n in range(4)]
# The chip in three bands, each with one row of multipliers: its rows of block RAMs, the middle of its cells, and its share of
# the lanes.
RAM_ROWS = ((22,), (46,), (70, 82))
MIDDLES = (13, 40, 74)
SHARES = (0.30, 0.26, 0.44)
MOST = len(MULTIPLIERS) // 3           # lanes of a band, three multipliers each
# The scheduler is between the two lower bands, where the ring of lanes begins and ends: its block RAMs, and the multipliers of
# each band that have no lane beside them, if there is room for the lanes elsewhere.
SCHEDULER = [(x, y, name) for x, name in RAMS[3:5] for y in (46, 22)]
SPACES = (4, 8, 0)
LANES = 51                             # three multipliers of a row each
LANES_OF_5 = 40                        # five block RAMs each
GROUP = 4                              # lanes that hear the same in the same cycle

# Inputs to which nextpnr leads a zero by wire; that of others is a setting of the cell.
ZEROS = {"CCU2C": re.compile("CIN|D[01]"), "MULT18X18D": re.compile("SIGNED[AB]|SOURCE[AB]|RST[0-3]"), "TRELLIS_FF": re.compile("DI|M")}

OWNER = re.compile(r"g_group\[(\d+)\]\.u_group\.g_lane\[(\d+)\]|g_own\.g_lane\[(\d+)\]")


def spread(lanes):
    """For each band, the first of the three multipliers of each of its lanes, as even as can be."""
    bands = [0, 0, 0]
    for _ in range(lanes):
        bands[min((band for band in range(3) if bands[band] < MOST), key=lambda band: (bands[band] + 0.5) / SHARES[band])] += 1
    rows = []
    for band, n in enumerate(bands):
        first = SPACES[band] if 3 * n <= len(MULTIPLIERS) - SPACES[band] else 0
        rows.append([(band, first + round(i * (len(MULTIPLIERS) - 3 - first) / max(1, n - 1))) for i in range(n)])
    return rows


def ring(lanes):
    """The places of all lanes in an order in which neighbours are near, and the last is near the first: along the lowest
    row, and back in groups that take turns between the two others."""
    low, middle, far = spread(lanes)
    order, back = list(far), {0: list(reversed(middle)), 1: list(reversed(low))}
    take, turn = -len(order) % GROUP or GROUP, 0
    while back[0] or back[1]:
        turn = turn if back[turn] else 1 - turn
        order += back[turn][:take]
        del back[turn][:take]
        take, turn = GROUP, 1 - turn
    return order


def rams(places, each):
    """For each place its block RAMs, the nearest first. Pairs are exchanged until that helps no more; far ones count so much that none is far: nextpnr
    gives its care to the worst path that it expects, and to no other if that is much worse."""
    sites = [(x, y, name) for y in sorted(sum(RAM_ROWS, ())) for x, name in RAMS if (x, y, name) not in SCHEDULER]
    middles = [(MULTIPLIERS[first + 1][0], MIDDLES[band]) for band, first in sorted(places) for _ in range(each)]

    def cost(i, site):
        return (abs(middles[i][0] - site[0]) + abs(middles[i][1] - site[1])) ** 4 if i < len(middles) else 0

    better = True
    while better:
        better = False
        for a in range(len(middles)):
            for b in range(a + 1, len(sites)):
                if cost(a, sites[b]) + cost(b, sites[a]) < cost(a, sites[a]) + cost(b, sites[b]):
                    sites[a], sites[b] = sites[b], sites[a]
                    better = True
    own = {place: sorted(sites[each * i:each * (i + 1)], key=lambda site, i=i: cost(each * i, site)) for i, place in enumerate(sorted(places))}
    return [own[place] for place in places]


def owner(cell):
    """The lane that a cell belongs to; None: the scheduler's."""
    found = OWNER.search(cell)
    if not found:
        return None
    return int(found[3]) if found[3] else GROUP * int(found[1]) + int(found[2])


def pin(netlist, lanes):
    """Writes the sites into the netlist (yosys's JSON, one module `top`). How many cells it pinned."""
    cells = netlist["modules"]["top"]["cells"]
    mine = collections.defaultdict(lambda: {"MULT18X18D": [], "DP16KD": []})
    for name in sorted(cells):
        lane = owner(name)
        if lane is not None and cells[name]["type"] in ("MULT18X18D", "DP16KD"):
            mine[lane][cells[name]["type"]].append(name)
    each = max((len(m["DP16KD"]) for m in mine.values()), default=0)
    most = 4 if lanes > LANES_OF_5 else 5
    if sorted(mine) != list(range(lanes)) or any(len(m["MULT18X18D"]) > 3 or len(m["DP16KD"]) > most for m in mine.values()):
        raise ValueError(f"the netlist does not have {lanes} lanes of at most three multipliers and {most} block RAMs")
    places = ring(lanes)
    control = sorted(name for name in cells if cells[name]["type"] == "DP16KD" and owner(name) is None)
    for name, (x, y, bel) in zip(control, SCHEDULER, strict=False):
        cells[name]["attributes"]["BEL"] = f"X{x}/Y{y}/{bel}"
    for lane, ((row, first), near) in enumerate(zip(places, rams(places, each))):
        sites = [f"X{x}/Y{MULTIPLIER_ROWS[row]}/{name}" for x, name in MULTIPLIERS[first:first + 3]]
        own = sorted(mine[lane]["DP16KD"], key=lambda name: (".u_store" in name, name))     # the store's may be the fifth
        for name, site in [*zip(mine[lane]["MULT18X18D"], sites), *zip(own, [f"X{x}/Y{y}/{bel}" for x, y, bel in near])]:
            cells[name]["attributes"]["BEL"] = site
    return sum("BEL" in cell["attributes"] for cell in cells.values())


def is_control(name, cell):
    """Whether a cell belongs to what all lanes have in common: the scheduler, its host port, the bus."""
    return owner(name) is None and "g_group" not in name and cell["type"] != "$scopeinfo"


def control(netlist):
    """A netlist of the scheduler alone, with the cells of lanes that it speaks to, but not what is behind them."""
    top = netlist["modules"]["top"]
    own = {name for name, cell in top["cells"].items() if is_control(name, cell)}
    clock = {bit for name in own for bit in top["cells"][name]["connections"].get("CLK", [])}
    nets = {bit for name in own for bits in top["cells"][name]["connections"].values() for bit in bits if isinstance(bit, int)} - clock
    near = {name for name, cell in top["cells"].items() if any(not nets.isdisjoint(bits) for bits in cell["connections"].values())}
    cells = {name: cell for name, cell in top["cells"].items() if name in own | near}
    return {**netlist, "modules": {**netlist["modules"], "top": {**top, "cells": cells}}}


def settle(netlist, placed):
    """Pins the scheduler's logic where it was placed alone (nextpnr's JSON). How many cells it pinned. What stays free: carries
    and distributed memory, of which nextpnr makes cells that have no attributes here, and the flip-flops behind them; a LUT
    with several flip-flops behind it, of which nextpnr joins any one to it, or with one of a lane."""
    cells, there = netlist["modules"]["top"]["cells"], placed["modules"]["top"]["cells"]
    driver, behind = {}, collections.defaultdict(list)
    for name, cell in cells.items():
        for port, bits in cell["connections"].items():
            if cell["port_directions"][port] == "output":
                driver |= dict.fromkeys(bits, name)
        if cell["type"] == "TRELLIS_FF":
            behind[cell["connections"]["DI"][0]].append(is_control(name, cell))

    def can(name):
        cell = cells[name]
        return is_control(name, cell) and cell["type"] == "LUT4" and behind[cell["connections"]["Z"][0]] in ([], [True])

    def is_settled(name):
        cell = cells[name]
        if cell["type"] != "TRELLIS_FF":
            return can(name)
        before = driver.get(cell["connections"]["DI"][0])
        return is_control(name, cell) and (before is None or cells[before]["type"] not in ("LUT4", "CCU2C", "TRELLIS_DPR16X4") or can(before))

    settled = [name for name in there if name in cells and is_settled(name)]
    for name in settled:
        cells[name]["attributes"]["BEL"] = there[name]["attributes"]["NEXTPNR_BEL"]
    return len(settled)


def ground(netlist):
    """Gives each lane a LUT for the zeros that nextpnr would lead there from one cell of the chip: those of multipliers and flip-flops,
    and where carries begin. router1 rips that net up, which goes everywhere, again and again. How many inputs were changed."""
    top = netlist["modules"]["top"]
    bit = 1 + max(bit for cell in top["cells"].values() for bits in cell["connections"].values() for bit in bits if isinstance(bit, int))
    zeros, changed = {}, 0
    for name, cell in top["cells"].items():
        found = OWNER.search(name)
        if not found or cell["type"] not in ZEROS:
            continue
        for port, bits in cell["connections"].items():
            if "0" in bits and ZEROS[cell["type"]].fullmatch(port):
                mine = zeros.setdefault(name[:found.end()] + ".zero", bit + len(zeros))
                cell["connections"][port] = [mine if b == "0" else b for b in bits]
                changed += bits.count("0")
    inputs = dict.fromkeys("ABCD", "input")
    for name, mine in zeros.items():
        top["cells"][name] = {"hide_name": 0, "type": "LUT4", "parameters": {"INIT": "0" * 16}, "attributes": {},
                              "port_directions": {**inputs, "Z": "output"}, "connections": {**{port: ["0"] for port in inputs}, "Z": [mine]}}
    return changed


def trim(netlist):
    """Takes away carries that nobody reads: for each, nextpnr would spend a cell to lead it out. How many there were."""
    cells = netlist["modules"]["top"]["cells"].values()
    read = {bit for c in cells for port, bits in c["connections"].items() if c["port_directions"][port] == "input" for bit in bits}
    idle = [c for c in cells if c["type"] == "CCU2C" and not read & set(c["connections"].get("COUT", [0]))]
    for cell in idle:
        cell["connections"]["COUT"], cell["port_directions"]["COUT"] = ["x"], "output"
    return len(idle)
