#!/usr/bin/env python3
"""Which figures of the pages are out of date, and measures those again: docs/evidence.toml describes them.

    tools/evidence.py --list                   each figure: fresh or not, and why; minutes to measure it
    tools/evidence.py                          measures what is out of date, in the order of the description
    tools/evidence.py --only world.chip bench  these alone, fresh or not; of `bench` all that begin with it
    tools/evidence.py --kind exact             of one kind
    tools/evidence.py --lines                  only what pages say of it: docs/figures.md, and a line beside each table

A run that was stopped goes on where it was: what is measured is recorded at once. Exit code 1: a command failed, and its figures stay as
they were; 2: wrong words.
"""

import argparse
import itertools
import os
import pathlib
import shlex
import subprocess
import sys
import time

import bench
from fp3evidence import figures as fig
from fp3evidence import inputs, probes, told

PAGES = ("docs/", "README.md")          # which measuring writes


def chosen(figures, words):
    """Those that are named, or whose names begin with a word and a dot."""
    if not words:
        return figures
    for word in words:
        if not any(name == word or name.startswith(f"{word}.") for name in figures):
            raise inputs.Wrong(f"no figure '{word}': --list names them")
    return {name: figure for name, figure in figures.items() if any(name == word or name.startswith(f"{word}.") for word in words)}


def files(figure, name, revision):
    """Some that have changed, of an input that is files."""
    if not revision or name not in figure.inputs or name in probes.PROBES:
        return ""
    some = list(itertools.islice(inputs.changed_files(figure.globs(name), revision), 3))
    return f" ({', '.join(some[:2])}{', ...' if some[2:] else ''})" if some else ""


def say(figures, found):
    """A line for each figure, and why it is not fresh: also by which files."""
    known, width = fig.records(), max(map(len, figures))
    for name, figure in figures.items():
        why = [one + files(figure, one, known.get(name, {}).get("revision")) for one in found[name]]
        state = "old" if why else "fresh"
        print(f"{name:{width}}  {state:5}  {figure.kind:5}  {figure.minutes:4g} min  {figure.page}" +
              (f": {'; '.join(why)}" if why else "") + (f" ({figure.old})" if figure.old else ""))
    stale = [figure for name, figure in figures.items() if found[name]]
    print(f"{len(stale)} of {len(figures)} figures are old; to measure them takes about {minutes(stale):g} minutes, and a night what is placed")


def minutes(figures):
    """Of the commands: some measure several figures. What is synthesised and placed is not counted."""
    return sum({figure.command: figure.minutes for figure in figures if "primitives" not in figure.inputs}.values())


def uncommitted():
    """Sources that no revision has."""
    said = subprocess.run(["git", "status", "--porcelain", "--untracked-files=no"], cwd=fig.ROOT, capture_output=True, text=True, check=True).stdout
    return [line[3:] for line in said.splitlines() if not line[3:].startswith(PAGES)]


def run(command):
    """As if nobody had called make before."""
    mine = {name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")}
    return subprocess.run(shlex.split(command), cwd=fig.ROOT, env=mine).returncode


def measure(of, fp3):
    """Figures of one command. Why it failed, or nothing: then they are recorded."""
    before = {figure.name: inputs.now(figure, fp3) for figure in of}
    load, date, begin = os.getloadavg()[0], time.strftime("%Y-%m-%d"), time.monotonic()
    for command in dict.fromkeys([of[0].command, *(figure.report for figure in of if figure.report)]):
        code = run(command)
        if code:
            return f"`{command}`: exit code {code}"
    inputs.forget()
    found = fig.records()
    for figure in of:
        now = inputs.now(figure, fp3)
        # Of a probe that could not be asked before the command had built it, the answer after it counts.
        if any(before[figure.name][name] not in (None, now[name]) for name in now):
            return f"{figure.name}: its inputs have changed while it was measured"
        found[figure.name] = {"revision": bench.said("git", "rev-parse", "--short", "HEAD"), "date": date, "machine": machine(), "load": round(load, 1),
                              "seconds": round(time.monotonic() - begin), "inputs": now}
    fig.record(found)
    return None


def machine():
    return f"{os.cpu_count()} processors, {bench.processor()}"


def measure_all(figures, fp3):
    """Yields what failed."""
    commands = {}
    for figure in figures.values():
        commands.setdefault(figure.command, []).append(figure)
    begin, left = time.monotonic(), minutes(figures.values())
    for number, of in enumerate(commands.values(), 1):
        print(f"evidence: {number} of {len(commands)}: {', '.join(figure.name for figure in of)}, about {of[0].minutes:g} min; "
              f"{(time.monotonic() - begin) / 60:.0f} min so far, about {left:g} to go", file=sys.stderr, flush=True)
        why = measure(of, fp3)
        left -= minutes(of)
        if why:
            print(f"evidence: {why}", file=sys.stderr)
            yield why


def put_lines(figures, fp3):
    """Writes the pages whose lines are others now."""
    for path, text in told.pages(figures, fig.records(), fig.anywhere(figures, fig.states(figures, fp3))).items():
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            bench.write(path, text)
            print(f"wrote {path.relative_to(fig.ROOT)}")


def work(options):
    every = fig.read()
    if not options.fp3.exists() and any(name in probes.PROBES for figure in every.values() for name in figure.inputs):
        raise inputs.Wrong(f"{options.fp3} is not there, and probes ask it: make all")
    figures = {name: figure for name, figure in chosen(every, options.only).items() if figure.kind in (options.kind or fig.KINDS)}
    if options.list:
        say(figures, fig.states(figures, options.fp3))
        return 0
    failed = []
    if not options.lines:
        if uncommitted():
            raise inputs.Wrong(f"a revision cannot say what is measured before these are committed: {', '.join(uncommitted()[:5])}")
        found = fig.states(figures, options.fp3)
        wanted = figures if options.only else {name: figure for name, figure in figures.items() if found[name]}
        try:
            failed = list(measure_all(wanted, options.fp3))
        except KeyboardInterrupt:
            failed = ["stopped"]
            print("evidence: stopped; what was measured is recorded", file=sys.stderr)
    inputs.forget()
    put_lines(every, options.fp3)
    return 1 if failed else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--fp3", type=pathlib.Path, default=probes.KEPT.parents[1] / "bin/fp3", help="the command")
    parser.add_argument("--list", action="store_true", help="what is out of date, and why")
    parser.add_argument("--lines", action="store_true", help="only write what pages say of it")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="these figures, also if they are fresh")
    parser.add_argument("--kind", choices=fig.KINDS, action="append", help="figures of this kind; may be repeated")
    options = parser.parse_args()
    try:
        return work(options)
    except (inputs.Wrong, probes.Failed) as why:
        print(f"evidence: {why}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
