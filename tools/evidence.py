#!/usr/bin/env python3
"""Which figures of the pages are out of date, and measures those again: docs/evidence.toml describes them.

    tools/evidence.py --list                   each figure: fresh or not, and why; minutes to measure it
    tools/evidence.py                          measures what is out of date: exact figures and errors two at a time, then times, each alone
    tools/evidence.py --only world.chip bench  these alone, fresh or not; of `bench` all that begin with it
    tools/evidence.py --kind exact             of one kind
    tools/evidence.py --lines                  only what pages say of it: docs/figures.md, and a line beside each table

A run that was stopped goes on where it was: what is measured is recorded at once. What a command says goes to build/evidence/NAME.txt. Figures
that are placed for hours are measured when they are named. Exit code 1: a command failed, and its figures stay as they were, while the others went on;
2: wrong words, or a package is missing.
"""

import argparse
import itertools
import pathlib
import subprocess
import sys



def missing(why):
    """Of this Python, which need not be the one of make."""
    print(f"evidence: {sys.executable} has no package '{why.name}': make setup, or start it with another Python (PYTHON=)", file=sys.stderr)
    return 2


try:
    import bench
    from fp3evidence import figures as fig
    from fp3evidence import inputs, measure, probes, told
except ModuleNotFoundError as lacking:
    sys.exit(missing(lacking))

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


def say(every, figures, found):
    """A line for each figure, and why it is not fresh: also by which files."""
    known, width = fig.records(), max(map(len, figures))
    for name, figure in figures.items():
        why = [one + files(figure, one, known.get(name, {}).get("revision")) for one in found[name]]
        state = "old" if why else "fresh"
        print(f"{name:{width}}  {state:5}  {figure.kind:5}  {measure.minutes_of(figure, known):5.3g} min  {figure.page}" +
              (f": {'; '.join(why)}" if why else "") + (f" ({figure.old})" if figure.old else ""))
    stale = [name for name in figures if found[name]]
    asked = jobs_of(every, [name for name in stale if not figures[name].by_name], known)
    named = ", ".join(name for name in stale if figures[name].by_name)
    print(f"{len(stale)} of {len(figures)} figures are old; to measure them takes about {measure.minutes(asked):.0f} minutes" +
          (f", without {named}: ONLY=NAME" if named else ""))


def uncommitted():
    """Sources that no revision has."""
    said = subprocess.run(["git", "status", "--porcelain", "--untracked-files=no"], cwd=fig.ROOT, capture_output=True, text=True, check=True).stdout
    return [line[3:] for line in said.splitlines() if not line[3:].startswith(PAGES)]


def jobs_of(every, wanted, known):
    """The commands that measure what is wanted; each with all of its figures."""
    commands = {}
    for figure in every.values():
        commands.setdefault(figure.command, []).append(figure)
    return [measure.Job(figures, known) for figures in commands.values() if any(figure.name in wanted for figure in figures)]


def put_lines(figures, found):
    """Writes the pages whose lines are others now."""
    for path, text in told.pages(figures, fig.records(), fig.anywhere(figures, found)).items():
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            bench.write(path, text)
            print(f"wrote {path.relative_to(fig.ROOT)}")


def work(options):
    every = fig.read()
    if not options.fp3.exists() and any(name in probes.PROBES for figure in every.values() for name in figure.inputs):
        raise inputs.Wrong(f"{options.fp3} is not there, and probes ask it: make all")
    figures = {name: figure for name, figure in chosen(every, options.only).items() if figure.kind in (options.kind or fig.KINDS)}
    if options.list:
        say(every, figures, fig.states(figures, options.fp3))
        return 0
    failed = []
    if not options.lines:
        if uncommitted():
            raise inputs.Wrong(f"a revision cannot say what is measured before these are committed: {', '.join(uncommitted()[:5])}")
        found = fig.states(figures, options.fp3)
        wanted = figures if options.only else [name for name, figure in figures.items() if found[name] and not figure.by_name]
        try:
            for why in measure.measure_all(jobs_of(every, wanted, fig.records()), fig.prepare(), options.fp3):
                failed.append(why)
        except KeyboardInterrupt:
            failed.append("stopped")
            print("evidence: stopped; what was measured is recorded", file=sys.stderr)
        for why in failed:
            print(f"evidence: failed: {why.splitlines()[0]}", file=sys.stderr)
    inputs.forget()
    found = fig.states(every, options.fp3)
    if done := [name for name, figure in every.items() if figure.old and not found[name]]:
        fig.drop_old(done)
        print(f"docs/evidence.toml: no line `old` of {', '.join(done)}, which are fresh")
    put_lines(every, found)
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
    except ModuleNotFoundError as why:
        return missing(why)


if __name__ == "__main__":
    sys.exit(main())
