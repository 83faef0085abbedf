#!/usr/bin/env python3
"""Objects that see each other: the same bits everywhere, how fast, how many cycles, and whether physics holds.

    tools/world.py                                     all of it, at its full length
    tools/world.py --quick                             the same in seconds, for the tests
    tools/world.py --parts hashes physics
    tools/world.py --parts hashes --scenes belt slope                              of these scenes alone; the rows of others stay

Writes build/results/world.json; parts that are not measured stay as they were in it. Exit code 1: words differ, something does
not hold, or a peer fails.
"""

import argparse
import json
import pathlib
import re
import sys
import tempfile
import time

import bench
from fp3world import bodies
from fp3world import chip
from fp3world import combinations
from fp3world import contact
from fp3world import friction
from fp3world import hashes as world_hashes
from fp3world import memory
from fp3world import physics as world_physics
from fp3world import rhythm
from fp3world import scene
from fp3world import speed as world_speed
from fp3world import water

PARTS = ("combinations", "hashes", "speed", "chip", "physics")
# What theory says of the scenes: each a function of a Lab that yields rows.
CHECKS = [world_physics.chain, world_physics.membrane, world_physics.cloth, world_physics.net, world_physics.rope, world_physics.bridge,
          bodies.planets, bodies.eight, bodies.plummer, bodies.free, contact.pair, contact.gas, contact.balls, contact.heap, water.dam,
          contact.players, contact.cradle, friction.slope, friction.belt, friction.glancing, friction.pile, friction.pyramid, memory.breaking, memory.plastic, rhythm.clocks,
          rhythm.neurons]

SCENES_OF = {bodies.free: {"stars", "net", "balls"}}  # of a check that has another name than its scene


def measure(options, part, folder, say):
    """What a part adds to the file."""
    if part == "combinations":
        return {"combinations": combinations.measure(options.fp3, folder, say, is_quick=options.quick)}
    if part == "hashes":
        rows, refused = world_hashes.measure(options.fp3, folder, options.quick, say, options.scenes)
        return {"hashes": rows, "refused": refused}
    if part == "speed":
        rows, failed = world_speed.measure(options, folder, say)
        return {"speed": rows, "peers_failed": failed}
    if part == "chip":
        rows, refused = chip.measure(options.fp3, folder, options.quick, say)
        return {"chip": rows, "refused_on_chip": refused}
    found, lab = [], world_physics.Lab(options.fp3, folder, options.quick)
    for check in CHECKS[:3] if options.quick else CHECKS:  # tests/world/test_world_physics.py has the quick form of each
        if options.scenes and not SCENES_OF.get(check, {check.__name__}) & set(options.scenes):
            continue
        rows = [row for row in check(lab) if not options.scenes or row["scene"] in options.scenes]
        found += rows
        say(f"physics of {check.__name__}: {sum(row['holds'] for row in rows)} of {len(rows)} rows hold")
    return {"physics": found}


def joined(options, data, part, found, about):
    """What is found of a part, and when; what is found of some scenes takes the place of their rows alone."""
    when = {"date": about["date"], "revision": about["revision"], "load": about["load"]}
    if not options.scenes:
        return found, when | {"rows": len(found[part])}

    def scene_of(row):
        return re.match(r"\w+", row["scene"])[0]
    joined = {key: sorted([row for row in data.get(key, []) if scene_of(row) not in options.scenes] + rows, key=scene_of if key == "hashes" else lambda row: 0)
              for key, rows in found.items()}
    before = data.get("measured", {}).get(part, when)
    later = [one for one in before.get("later", []) if not set(one["scenes"]) <= set(options.scenes)]
    return joined, before | {"rows": len(joined[part]), "later": later + [when | {"scenes": sorted(options.scenes)}]}


def measure_all(options, folder):
    """Parts one by one, each written at once; yields what is wrong."""
    begin, data = time.monotonic(), bench.kept(options)
    about = bench.about(options) | {"command": "make world" + (" QUICK=1" if options.quick else "")}
    measured = data.get("measured", {})

    def say(text):
        print(f"world: {text}, {time.monotonic() - begin:.0f} s so far", file=sys.stderr, flush=True)
    for part in options.parts:
        found = measure(options, part, folder, say)
        rows, measured[part] = joined(options, data, part, found, about)
        data |= {"about": about, "measured": measured} | rows
        bench.write(options.output, json.dumps(data, indent=1) + "\n")
        yield from wrong(found)


def wrong(found):
    """What differs, does not hold or failed, in words."""
    yield from found.get("peers_failed", [])
    for row in combinations.wrong(found.get("combinations", [])):
        yield f"{row['relation']}, {row['feature']}, {row['engine']}: {row['state']}"
    for row in found.get("hashes", []) + found.get("speed", []):
        if row.get("words_differing"):
            yield f"{row['scene']}, {row['engine']}, {row['variant']}: {row['words_differing']} words differ"
    for row in found.get("physics", []):
        if not row["holds"]:
            yield f"{row['scene']}, {row['what']}: found {row['found']:.6g}, expected {row['expected']:.6g} within {row['within']:.2g}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--fp3", type=pathlib.Path, default=bench.ROOT / "build/fp3", help="the command")
    parser.add_argument("--bench", type=pathlib.Path, default=bench.ROOT / "build/bench/world", help="the program that measures time")
    parser.add_argument("--peers", type=pathlib.Path, default=bench.ROOT / ".venv-bench/bin/python",
                        help="a Python that may have Taichi, Warp and other peers (default: that of make setup-bench)")
    parser.add_argument("--quick", action="store_true", help="few steps, small scenes")
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=PARTS, help="only these (default: all)")
    parser.add_argument("--scenes", nargs="+", choices=[*scene.names(), "pile"], help="of hashes and physics, the rows of these scenes only")
    parser.add_argument("--output", type=pathlib.Path, default=bench.ROOT / "build/results/world.json", help="the file to write")
    options = parser.parse_args()
    if options.scenes and not set(options.parts) <= {"hashes", "physics"}:
        parser.error("expected --parts hashes or physics beside --scenes")
    errors = 0
    try:
        with tempfile.TemporaryDirectory() as folder:
            for error in measure_all(options, pathlib.Path(folder)):
                print(f"world: {error}", file=sys.stderr)
                errors += 1
    except scene.Failed as why:
        print(f"world: {why}", file=sys.stderr)
        return 1
    print(f"{errors} rows differ, do not hold or could not be made")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
