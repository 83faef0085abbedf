#!/usr/bin/env python3
"""Gathers the rows that fp3 compare wrote, one file per model, into one file, and says how they stand.

    tools/models.py --output build/results/models.json build/results/models/*.json
"""
import argparse
import json
import os
import sys


def gather(paths):
    rows, left_out = [], []
    for path in sorted(paths):
        with open(path) as file:
            part = json.load(file)
        rows += part["rows"]
        left_out += part["left_out"]
    return {"rows": rows, "left_out": left_out}


def write(path, data):
    """All or nothing, as a reader may come at any time."""
    temporary = f"{path}.{os.getpid()}"
    with open(temporary, "w") as file:
        json.dump(data, file, indent=1)
        file.write("\n")
    os.replace(temporary, path)


def within(rows, name, other, most):
    """How many rows have both slopes, and how many of these are no more than `most` apart."""
    both = [row for row in rows if row[name] is not None and row[other] is not None]
    return sum(abs(row[name] - row[other]) <= most for row in both), len(both)


def summary(rows):
    compared = sum(row["compared"] for row in rows)
    yield f"{len(rows)} rows, {sum(row['mismatches'] for row in rows)} of {compared} words differ"
    for machine in ("many_full", "single_full", "sixteen"):
        ratios = sorted(row[machine]["predicted"] / row[machine]["bound"] for row in rows)
        close = sum(ratio <= 1.05 for ratio in ratios)
        exact = sum(row[machine]["predicted"] == row[machine]["measured"] for row in rows)
        yield (f"{machine}: {close} rows within 5 % of the bound, the worst {100 * (ratios[-1] - 1):.1f} % above it; "
               f"{exact} predicted exactly")
    for text, name, other in (("measured slopes within 0.2 of the order", "measured_order", "order"),
                              ("... of the same integrator's in double", "measured_order", "method_order"),
                              ("finest slopes in double within 0.2 of the order", "finest_order", "order")):
        good, both = within(rows, name, other, 0.2)
        yield f"{text}: {good} of {both} rows"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", required=True, help="the file to write")
    parser.add_argument("parts", nargs="+", help="files of fp3 compare --json")
    arguments = parser.parse_args()
    data = gather(arguments.parts)
    write(arguments.output, data)
    print("\n".join(summary(data["rows"])))


if __name__ == "__main__":
    sys.exit(main())
