"""The floorplan of a chip full of lanes: every number of lanes has sites of its own, and a netlist gets them."""

import sys

import pytest


@pytest.fixture
def floorplan(root, monkeypatch):
    monkeypatch.setattr(sys, "path", [str(root / "tools"), *sys.path])
    from fp3gen import floorplan as module
    return module


def test_no_site_is_given_twice(floorplan):
    for lanes in range(1, floorplan.LANES + 1):
        places = floorplan.ring(lanes)
        sites = [(row, first + i) for row, first in places for i in range(3)]
        assert len(set(sites)) == 3 * lanes and all(0 <= site < len(floorplan.MULTIPLIERS) for _, site in sites)
        for each in (4, 5) if lanes <= floorplan.LANES_OF_5 else (4,):
            rams = [site for one in floorplan.rams(places, each) for site in one]
            assert len(set(rams)) == len(rams) == each * lanes and not set(rams) & set(floorplan.SCHEDULER)


def test_neighbours_are_near(floorplan):
    """Also the first and the last, which say and hear what the scheduler does."""
    places = floorplan.ring(36)
    at = [(floorplan.MULTIPLIERS[first][0], floorplan.MULTIPLIER_ROWS[row]) for row, first in places]
    groups = at[::floorplan.GROUP] + [at[-1], at[0]]
    assert max(abs(a[0] - b[0]) + abs(a[1] - b[1]) for a, b in zip(groups, groups[1:])) <= 80


@pytest.mark.parametrize("lanes", [8, 36, 38, 40])
def test_no_block_ram_is_far_from_its_lane(floorplan, lanes):
    """One that is far is the worst path that nextpnr expects, and so the only one that it cares for."""
    places = floorplan.ring(lanes)
    far = [abs(x - floorplan.MULTIPLIERS[first + 1][0]) + abs(y - floorplan.MIDDLES[band])
           for (band, first), own in zip(places, floorplan.rams(places, 5)) for x, y, _ in own]
    assert max(far) <= 40 and sum(far) / len(far) < 20


def netlist(lanes, multipliers=3, rams=4):
    cells = {}
    for lane in range(lanes):
        group = f"u.g_group[{lane // 4}].u_group.g_lane[{lane % 4}].u_lane"
        names = [f"ram{i}" for i in range(rams - 1)] + ["u_store.m"]
        cells |= {f"{group}.{name}": {"type": "DP16KD", "attributes": {}, "connections": {}, "port_directions": {}} for name in names}
        cells |= {f"u.g_own.g_lane[{lane}].g_stream[0].u_unit.m{i}": {"type": "MULT18X18D", "attributes": {}, "connections": {}, "port_directions": {}}
                  for i in range(multipliers)}
    cells["u.u_program"] = {"type": "DP16KD", "attributes": {}, "connections": {}, "port_directions": {}}
    return {"modules": {"top": {"cells": cells}}}


@pytest.mark.parametrize("rams", [4, 5])
def test_a_netlist_is_pinned_lane_by_lane(floorplan, rams):
    design = netlist(6, rams=rams)
    assert floorplan.pin(design, 6) == 6 * (3 + rams) + 1
    cells = design["modules"]["top"]["cells"]
    sites = [cell["attributes"]["BEL"] for cell in cells.values() if cell["attributes"]]
    assert len(set(sites)) == len(sites) and cells["u.u_program"]["attributes"]["BEL"] == "X{}/Y{}/{}".format(*floorplan.SCHEDULER[0])
    for lane in range(6):
        own = [cell["attributes"]["BEL"] for name, cell in cells.items() if floorplan.owner(name) == lane]
        columns = [int(site[1:site.index("/")]) for site in own]
        assert max(columns) - min(columns) <= 24


@pytest.mark.parametrize("lanes, multipliers, rams", [(5, 3, 4), (6, 4, 4), (6, 3, 6)])
def test_another_netlist_is_refused(floorplan, lanes, multipliers, rams):
    with pytest.raises(ValueError, match="does not have 6 lanes"):
        floorplan.pin(netlist(lanes, multipliers, rams), 6)


def test_five_block_rams_have_room_in_fewer_lanes(floorplan):
    with pytest.raises(ValueError, match="41 lanes of at most three multipliers and 4 block RAMs"):
        floorplan.pin(netlist(41, rams=5), 41)


def cell(type, **bits):
    """A cell with an output Z, Q, F0, S0 or COUT, and the bits of its ports."""
    ports = {port: "output" if port in ("Z", "Q", "S0") else "input" for port in bits}
    return {"type": type, "attributes": {}, "connections": {port: [bit] for port, bit in bits.items()}, "port_directions": ports}


def scheduler():
    """A LUT and its flip-flop, which tell a lane and hear it; a LUT with two flip-flops, one with a lane's; a carry with one."""
    lane = "u.g_group[0].u_group.g_lane[0].u_lane."
    return {"modules": {"top": {"cells": {
        "u.lut": cell("LUT4", A=20, Z=2), "u.ff": cell("TRELLIS_FF", CLK=1, DI=2, Q=3),
        "u.both": cell("LUT4", A=3, Z=4), "u.ff1": cell("TRELLIS_FF", CLK=1, DI=4, Q=5), "u.ff2": cell("TRELLIS_FF", CLK=1, DI=4, Q=6),
        "u.theirs": cell("LUT4", A=5, Z=7), lane + "ff": cell("TRELLIS_FF", CLK=1, DI=7, Q=8), lane + "behind": cell("LUT4", A=8, Z=20),
        lane + "far": cell("LUT4", A=8, Z=21),
        "u.carry": cell("CCU2C", A0=6, S0=9), "u.sum": cell("TRELLIS_FF", CLK=1, DI=9, Q=10), "u.after": cell("TRELLIS_FF", CLK=1, DI=10, Q=11),
    }}}}


def test_the_scheduler_alone(floorplan):
    cells = floorplan.control(scheduler())["modules"]["top"]["cells"]
    assert set(scheduler()["modules"]["top"]["cells"]) - set(cells) == {"u.g_group[0].u_group.g_lane[0].u_lane.far"}


def test_what_nextpnr_may_join_otherwise_stays_free(floorplan):
    design, placed = scheduler(), scheduler()
    for i, one in enumerate(placed["modules"]["top"]["cells"].values()):
        one["attributes"]["NEXTPNR_BEL"] = f"X{i}/Y1/SLICEA.LUT0"
    assert floorplan.settle(design, placed) == 3
    settled = {name for name, one in design["modules"]["top"]["cells"].items() if one["attributes"]}
    assert settled == {"u.lut", "u.ff", "u.after"}
    assert design["modules"]["top"]["cells"]["u.ff"]["attributes"]["BEL"] == "X1/Y1/SLICEA.LUT0"


def test_only_idle_carries_are_cut(floorplan):
    def carry(cin, cout):
        return {"type": "CCU2C", "attributes": {}, "connections": {"CIN": [cin], "COUT": [cout]},
                "port_directions": {"CIN": "input", "COUT": "output"}}
    design = {"modules": {"top": {"cells": {"a": carry("0", 5), "b": carry(5, 6)}}}}
    assert floorplan.trim(design) == 1
    cells = design["modules"]["top"]["cells"]
    assert (cells["a"]["connections"]["COUT"], cells["b"]["connections"]["COUT"]) == ([5], ["x"])


def test_each_lane_has_a_zero_of_its_own(floorplan):
    """For what nextpnr would lead there from one cell; the scheduler's zeros and other inputs stay as they are."""
    def cell(kind, **connections):
        return {"type": kind, "connections": {port: list(bits) for port, bits in connections.items()}, "attributes": {},
                "port_directions": {port: "output" if port == "Z" else "input" for port in connections}}
    lane = "u.g_group[1].u_group.g_lane[2].u_lane"
    cells = {f"{lane}.carry": cell("CCU2C", CIN="0", A0=[7], B0="0"), f"{lane}.m": cell("MULT18X18D", A1="0", SIGNEDA="0", SIGNEDB=[7]),
             f"{lane.replace('[2]', '[0]')}.q": cell("TRELLIS_FF", DI="0", LSR="0"), "u.u_hub.carry": cell("CCU2C", CIN="0", Z=[9])}
    before = {name: dict(row["connections"]) for name, row in cells.items()}
    assert floorplan.ground({"modules": {"top": {"cells": cells}}}) == 3
    assert set(cells) - set(before) == {"u.g_group[1].u_group.g_lane[2].zero", "u.g_group[1].u_group.g_lane[0].zero"}
    first, second = (cells[name]["connections"]["Z"] for name in sorted(set(cells) - set(before), reverse=True))
    assert first != second and all(floorplan.owner(name) is not None for name in cells if "zero" in name)
    changed = {f"{lane}.carry": {"CIN": first}, f"{lane}.m": {"SIGNEDA": first}, f"{lane.replace('[2]', '[0]')}.q": {"DI": second}}
    assert {name: cells[name]["connections"] for name in before} == {name: {**row, **changed.get(name, {})} for name, row in before.items()}
