"""A run that works on a part of the store, and the host in the other one meanwhile (key `overlap`); and broken hardware, which kept.c must see."""

import re
import subprocess

import pytest

from bugs import Bug, source

CONFIG = "world_overlap"
BUGS = [
    Bug("nobody waits for a port", "fp3.v", "&& |(write ? stores : loads)", "&& 1'b0"),
    Bug("a write waits for the other port", "fp3.v", "|(write ? stores : loads)", "|(write ? loads : stores)"),
    Bug("an entry of a list has no port", "fp3_tile_scheduler.v", "issue_st || issue_keep", "issue_st"),
    Bug("both parts are at work", "fp3_host_port.v", "part_q && address[STORE_W-2] != upper_q", "1'b0"),
    Bug("no part is at work", "fp3_host_port.v", "part_q && address[STORE_W-2] != upper_q", "part_q"),
    Bug("a run of the whole store leaves a part out", "fp3_host_port.v", "&& part_q && address", "&& address"),
    Bug("records of both parts are stored", "fp3_lane_store.v", "in_part(st_whole, runs_in_part, upper)", "st_whole"),
    Bug("records of both parts are loaded", "fp3_lane_store.v", "in_part(ld_whole, runs_in_part, upper)", "ld_whole"),
    Bug("entries of both parts are loaded", "fp3_lane_store.v", "in_part(move_place, runs_in_part, upper)", "move_place"),
    Bug("lists are made in both parts", "fp3_lane_store.v", "in_part(keep_place_i3_i, runs_in_part, upper)", "keep_place_i3_i"),
    Bug("a write takes the port of loads", "fp3_lane.v", "(EXCHANGE != 0 || OVERLAP != 0) && access_write", "EXCHANGE != 0 && access_write"),
    Bug("a read takes the port of stores", "fp3_lane.v", "OVERLAP != 0 ? to_store : access_valid", "access_valid"),
    Bug("the number of the step is stored", "fp3_tile_scheduler.v", "running && OVERLAP == 0 ?", "running ?"),
]


def kept(build, tmp_path, **options):
    return subprocess.run([build / "tests/kept", "1", "60", CONFIG], cwd=tmp_path, capture_output=True, text=True, timeout=600, **options)


@pytest.mark.smoke
def test_the_host_reaches_the_part_that_a_run_leaves_out(build, tmp_path):
    """Programs by chance, against a model of the store; the run's cycles are as if nobody was there."""
    done = kept(build, tmp_path)
    moved, refused = map(int, re.search(r"^(\d+) moved, (\d+) refused within runs; .* 0 failed\n$", done.stdout).groups())
    assert done.returncode == 0 and moved > 300 and refused > 300, done.stdout


@pytest.mark.long
@pytest.mark.parametrize("bug", [pytest.param(bug, id=bug.name) for bug in BUGS])
def test_broken_hardware_is_seen(root, build, tmp_path, monkeypatch, bug):
    monkeypatch.syspath_prepend(root / "tools")
    from fp3fpga import one_config
    from fp3gen.read import load
    tree = tmp_path / "broken"
    one_config.make_tree(next(row for row in load(root).configs if row["name"] == CONFIG), tree)
    path = source(root, bug.file)
    room = tree / "rtl" / path.relative_to(root / "rtl").parts[0]
    if room.is_dir():                                      # a link to all of its files: now to each, but for this one
        room.unlink()
        room.mkdir()
        for file in path.parent.iterdir():
            (room / file.name).symlink_to(file)
        room = room / path.name
    room.unlink()
    room.write_text(bug.put(path.read_text()))
    one_config.make_hardware(CONFIG, tree, build)
    done = kept(build, tmp_path, env={"FP3_RTL_DIR": str(tree)})
    assert done.returncode, f"{bug.name}: not seen"
