#!/usr/bin/env python3
"""How fast a recording is written: fp3 run --output FILE.h5 beside dd, which writes the same bytes to the same disk.

    tools/bench_output.py OUTPUT.json --fp3 build/fp3 [--quick]

10^6 ships, 100 snapshots, 2 states (--quick: 10^5 ships). The two take turns; each has to have its bytes on the disk before its clock
stops. The files lie beside OUTPUT.json, and go away. The memory is the most that the command had at once.
"""

import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
SNAPSHOTS, STATES, REPEATS = 100, 2, 3


def on_disk(path):
    descriptor = os.open(path, os.O_RDONLY)
    os.fsync(descriptor)
    os.close(descriptor)


def timed(command, path):
    """Seconds until the bytes are on the disk, and MB of memory at most."""
    path.unlink(missing_ok=True)
    os.sync()
    begin = time.monotonic()
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as program:
        said = program.stderr.read()
        _, status, used = os.wait4(program.pid, 0)
        program.returncode = os.waitstatus_to_exitcode(status)
    if program.returncode:
        sys.exit(f"bench_output.py: {command[0]}: exit code {program.returncode}: {said.strip()}")
    on_disk(path)
    return time.monotonic() - begin, used.ru_maxrss * 1024 / 1e6


def measure(fp3, folder, objects):
    ours, theirs = folder / "recording.h5", folder / "recording.dd"
    run = [fp3, "run", "programs/ship.ode", "--engine", "fast", "--config", "many_full", "--objects", str(objects), "--steps", str(SNAPSHOTS), "--every", "1", "--output", ours]
    copy = ["dd", f"if={ours}", f"of={theirs}", "bs=1M"]
    try:
        turns = [(timed(run, ours), timed(copy, theirs)) for _ in range(REPEATS)]
        size = ours.stat().st_size
    finally:
        ours.unlink(missing_ok=True)
        theirs.unlink(missing_ok=True)
    seconds, dd = (statistics.median(turn[i][0] for turn in turns) for i in range(2))
    return {"program": "ship", "objects": objects, "snapshots": SNAPSHOTS, "states": STATES, "bytes": size, "seconds": seconds,
            "dd_seconds": dd, "ratio_to_dd": dd / seconds, "memory_mb": max(turn[0][1] for turn in turns), "repeats": REPEATS}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output", type=pathlib.Path, help="the file to write")
    parser.add_argument("--fp3", type=pathlib.Path, default=ROOT / "build/fp3", help="the command")
    parser.add_argument("--quick", action="store_true", help="a tenth of the objects")
    options = parser.parse_args()
    row = measure(options.fp3.resolve(), options.output.resolve().parent, 100000 if options.quick else 1000000)
    options.output.write_text(json.dumps({"output": [row]}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
