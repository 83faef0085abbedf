#!/usr/bin/env python3
"""What LAMMPS makes of scenes of grains, for the rows of make world and its tests: tools/fp3world/lammps.json. Heaps take some minutes.

    .venv-bench/bin/python tools/granular.py           writes it (make granular); that Python has LAMMPS after make setup-bench
    .venv-bench/bin/python tools/granular.py --check   makes the balls that collide again, and compares: exit code 1 if more than rounding differs
"""

import argparse
import sys

import numpy as np
from fp3world import granular


def differs(was, now):
    """Where LAMMPS gives something else: the largest difference of a number."""
    def numbers(data):
        return np.array([row for part in data for row in part["rows"]])
    return abs(numbers(was) - numbers(now)).max()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="compare the balls that collide with what is there")
    options = parser.parse_args()
    if options.check:
        most = differs(granular.table()["glancing"], list(granular.glancing()))
        print(f"granular: the largest difference of a number is {most:.2g}")
        return int(not most < 1e-9)
    granular.TABLE.write_text(granular.text(granular.made()), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
