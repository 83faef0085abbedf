#!/usr/bin/env python3
"""Whole scenes in the laboratory: error against run time, stability, tuning, skipping.

    tools/scenes.py                                    all of it, beside everyone who is installed
    tools/scenes.py --quick                            the same in seconds, for the tests
    tools/scenes.py --parts curves --scenes cloth      only these; the rows of other scenes stay

Writes build/results/scenes.json; parts that are not measured stay as they were in it. Exit code 1: something is wrong with a row, or could
not be measured.
"""

import argparse
import importlib
import json
import pathlib
import sys
import tempfile
import time

import bench
from fp3world.scene import Failed

# A part is a module of fp3scenes/ of this name. It has
#   measure(options, say)   its rows, each with its `scene`; options: as of this tool, and `folder` for files that go when all is done
#   wrong(rows)             yields what is wrong with them, in words
#   pages(rows, about)      files of docs/, each with its lines or a section of them; pictures, too (tools/pages.py); about: when and where
#   SCENES                  whose names --scenes takes
PARTS = [
    "skipped",
    "curves",
    "stress",
    "tuned",
]


def part_of(name):
    return importlib.import_module(f"fp3scenes.{name}")


def joined(options, old, rows):
    """What is found of some scenes takes the place of their rows alone."""
    return [row for row in old if options.scenes and row["scene"] not in options.scenes] + rows


def measure(options):
    """Parts one by one, each written at once; yields what is wrong."""
    begin, data = time.monotonic(), bench.kept(options)
    about = bench.about(options) | {"command": "make scenes" + (" QUICK=1" if options.quick else "")}
    measured = data.get("measured", {})

    def say(text):
        print(f"scenes: {text}, {time.monotonic() - begin:.0f} s so far", file=sys.stderr, flush=True)
    for name in options.parts:
        part = part_of(name)
        if options.scenes and not set(options.scenes) & set(part.SCENES):
            continue
        rows = part.measure(options, say)
        measured[name] = {key: about[key] for key in ("date", "revision", "load")}
        data |= {"about": about, "measured": measured, name: joined(options, data.get(name, []), rows)}
        bench.write(options.output, json.dumps(data, indent=1) + "\n")
        yield from part.wrong(rows)


def pages(results):
    """Of the parts that were measured."""
    data, made = results("scenes.json", "scenes"), {}
    for name in PARTS:
        if name in data:
            made |= part_of(name).pages(data[name], data["about"] | data["measured"][name])
    return made


def main():
    scenes = sorted({scene for name in PARTS for scene in part_of(name).SCENES})
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--fp3", type=pathlib.Path, default=bench.ROOT / "build/fp3", help="the command")
    parser.add_argument("--peers", type=pathlib.Path, default=bench.ROOT / ".venv-bench/bin/python",
                        help="a Python that may have Taichi, Warp and other peers (default: that of make setup-bench)")
    parser.add_argument("--quick", action="store_true", help="few steps, small scenes")
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=PARTS, help="only these (default: all)")
    parser.add_argument("--scenes", nargs="+", choices=scenes, metavar="SCENE", help=f"only these (default: all): {', '.join(scenes)}")
    parser.add_argument("--output", type=pathlib.Path, default=bench.ROOT / "build/results/scenes.json", help="the file to write")
    options = parser.parse_args()
    errors = 0
    try:
        with tempfile.TemporaryDirectory() as folder:
            options.folder = pathlib.Path(folder)
            for error in measure(options):
                print(f"scenes: {error}", file=sys.stderr)
                errors += 1
    except Failed as why:
        print(f"scenes: {why}", file=sys.stderr)
        return 1
    print(f"{errors} rows are wrong or could not be made")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
