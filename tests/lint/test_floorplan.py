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
        assert len(set(floorplan.quads(places))) == lanes


def test_neighbours_are_near(floorplan):
    """Also the first and the last, which say and hear what the scheduler does."""
    places = floorplan.ring(36)
    at = [(floorplan.MULTIPLIERS[first][0], floorplan.MULTIPLIER_ROWS[row]) for row, first in places]
    groups = at[::floorplan.GROUP] + [at[-1], at[0]]
    assert max(abs(a[0] - b[0]) + abs(a[1] - b[1]) for a, b in zip(groups, groups[1:])) <= 70


def netlist(lanes, multipliers=3):
    cells = {}
    for lane in range(lanes):
        group = f"u.g_group[{lane // 4}].u_group.g_lane[{lane % 4}].u_lane"
        cells |= {f"{group}.ram{i}": {"type": "DP16KD", "attributes": {}, "connections": {}, "port_directions": {}} for i in range(4)}
        cells |= {f"u.g_own.g_lane[{lane}].u_arith.m{i}": {"type": "MULT18X18D", "attributes": {}, "connections": {}, "port_directions": {}}
                  for i in range(multipliers)}
    cells["u.u_program"] = {"type": "DP16KD", "attributes": {}, "connections": {}, "port_directions": {}}
    return {"modules": {"top": {"cells": cells}}}


def test_a_netlist_is_pinned_lane_by_lane(floorplan):
    design = netlist(6)
    assert floorplan.pin(design, 6) == 6 * 7
    cells = design["modules"]["top"]["cells"]
    sites = [cell["attributes"]["BEL"] for cell in cells.values() if cell["attributes"]]
    assert len(set(sites)) == 42 and not cells["u.u_program"]["attributes"]
    for lane in range(6):
        own = [cell["attributes"]["BEL"] for name, cell in cells.items() if floorplan.owner(name) == lane]
        columns = [int(site[1:site.index("/")]) for site in own]
        assert max(columns) - min(columns) <= 24


@pytest.mark.parametrize("lanes, multipliers", [(5, 3), (6, 4)])
def test_another_netlist_is_refused(floorplan, lanes, multipliers):
    with pytest.raises(ValueError, match="does not have 6 lanes"):
        floorplan.pin(netlist(lanes, multipliers), 6)


def test_only_idle_carries_are_cut(floorplan):
    def carry(cin, cout):
        return {"type": "CCU2C", "attributes": {}, "connections": {"CIN": [cin], "COUT": [cout]},
                "port_directions": {"CIN": "input", "COUT": "output"}}
    design = {"modules": {"top": {"cells": {"a": carry("0", 5), "b": carry(5, 6)}}}}
    assert floorplan.trim(design) == 1
    cells = design["modules"]["top"]["cells"]
    assert (cells["a"]["connections"]["COUT"], cells["b"]["connections"]["COUT"]) == ([5], ["x"])
