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
RAMS = [[(x + 2 * n, f"EBR{n}") for n in range(4)] for x in BLOCKS]
RAM_ROWS = (22, 46, 70, 82)
LANES = 51                             # three multipliers of a row each
LANES_OF_5 = 41                        # five block RAMs each, and some for the scheduler
# Where the middle of a lane's cells is, if the lanes of each row of multipliers share a third of the chip.
MIDDLES = (18, 46, 76)
GROUP = 4                              # lanes that hear the same in the same cycle

OWNER = re.compile(r"g_group\[(\d+)\]\.u_group\.g_(?:lane|dual)\[(\d+)\]|g_lane\[(\d+)\]\.u_arith")


def spread(lanes):
    """For each row of multipliers, the first of the three of each of its lanes, as even as can be."""
    rows = []
    for row, n in enumerate(lanes // 3 + (i < lanes % 3) for i in (1, 0, 2)):
        rows.append([(row, round(i * (len(MULTIPLIERS) - 3) / max(1, n - 1))) for i in range(n)])
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


def exchanged(places, sites, column):
    """The sites in an order in which each place's, the first, are together nearest to it. Pairs are exchanged until that helps no more."""
    sites = list(sites)

    def distance(i, site):
        if i >= len(places):
            return 0
        row, first = places[i]
        return (MULTIPLIERS[first + 1][0] - column(site)) ** 2 + 1.5 * (MIDDLES[row] - site[1]) ** 2

    better = True
    while better:
        better = False
        for a in range(len(places)):
            for b in range(a + 1, len(sites)):
                if distance(a, sites[b]) + distance(b, sites[a]) < distance(a, sites[a]) + distance(b, sites[b]) - 1e-9:
                    sites[a], sites[b] = sites[b], sites[a]
                    better = True
    return sites


def rams(places, each):
    """For each place its block RAMs, four side by side; a fifth is in a block that no lane has as a whole."""
    quads = exchanged(places, [(block, y) for y in RAM_ROWS for block in range(len(BLOCKS))], lambda quad: BLOCKS[quad[0]] + 3)
    sites = [[(x, y, name) for x, name in RAMS[block]] for block, y in quads]
    if each <= 4:
        return sites[:len(places)]
    rest = exchanged(places, [(x, y, name) for quad in sites[len(places):] for x, y, name in quad], lambda site: site[0])
    return [[*quad, one] for quad, one in zip(sites[:len(places)], rest, strict=False)]


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
    for lane, ((row, first), near) in enumerate(zip(places, rams(places, each))):
        sites = [f"X{x}/Y{MULTIPLIER_ROWS[row]}/{name}" for x, name in MULTIPLIERS[first:first + 3]]
        own = sorted(mine[lane]["DP16KD"], key=lambda name: (".u_store" in name, name))     # the store's may be the fifth
        for name, site in [*zip(mine[lane]["MULT18X18D"], sites), *zip(own, [f"X{x}/Y{y}/{bel}" for x, y, bel in near])]:
            cells[name]["attributes"]["BEL"] = site
    return sum(len(names) for m in mine.values() for names in m.values())


def trim(netlist):
    """Takes away carries that nobody reads: for each, nextpnr would spend a cell to lead it out. How many there were."""
    cells = netlist["modules"]["top"]["cells"].values()
    read = {bit for c in cells for port, bits in c["connections"].items() if c["port_directions"][port] == "input" for bit in bits}
    idle = [c for c in cells if c["type"] == "CCU2C" and not read & set(c["connections"].get("COUT", [0]))]
    for cell in idle:
        cell["connections"]["COUT"], cell["port_directions"]["COUT"] = ["x"], "output"
    return len(idle)
