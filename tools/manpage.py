#!/usr/bin/env python3
"""Writes a man page from what a command says of itself: `COMMAND --help`, and `COMMAND X --help` for each X of its list.

    tools/manpage.py build/bin/fp3 > fp3.1
"""

import os
import pathlib
import re
import subprocess
import sys

# No line is broken: troff does that.
WIDE = {**os.environ, "ARGP_HELP_FMT": "rmargin=10000", "LC_ALL": "C"}
# What every subcommand says, too.
COMMON = ("Mandatory or optional arguments to long options", "for any corresponding short options")
EVERYWHERE = ("-?, --help", "--usage", "-V, --version")


def said(*command):
    return subprocess.run(command, env=WIDE, capture_output=True, text=True, check=True).stdout


def escaped(text):
    """Text as troff prints it: no request at the start of a line, hyphens that can be copied."""
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return re.sub(r"^([.'])", r"\\&\1", text, flags=re.M)


def is_option(line):
    return re.match(r" {2,6}-\S", line)


def split(text):
    """The usages, the description, the options and what follows them."""
    lines = text.splitlines()
    usages = [re.sub(r"^(Usage: |  or:  )", "", line) for line in lines if re.match(r"Usage: |  or:  ", line)]
    rest = lines[len(usages):]
    first = next(i for i, line in enumerate(rest) if is_option(line))
    last = max(i for i, line in enumerate(rest) if is_option(line))
    after = [line for line in rest[last + 1:] if not line.startswith(COMMON)]
    return usages, " ".join(rest[:first]).strip(), rest[first:last + 1], after


def options(lines):
    for line in lines:
        names, _, meaning = line.strip().partition("  ")
        yield f".TP\n.B {escaped(names)}\n{escaped(meaning.strip())}"


def commands(lines):
    return [line.split(None, 1) for line in lines if re.match(r"  \w", line)]


def section(program, name):
    usages, about, its_options, after = split(said(program, name, "--help"))
    yield f".SS {escaped(usages[0].split(' [')[0])}"
    for usage in usages:
        yield f"\\fB{escaped(usage)}\\fR\n.br"
    yield f".PP\n{escaped(about)}"
    yield from options(line for line in its_options if not line.strip().startswith(EVERYWHERE))
    for line in after:
        yield escaped(line) if line else ".PP"


def page(program):
    usages, about, its_options, after = split(said(program, "--help"))
    name, version = said(program, "--version").split()
    listed = commands(after)
    yield f'.TH {name.upper()} 1 "" "{name} {version}"'
    yield f".SH NAME\n{name} \\- {escaped(about[0].lower() + about[1:].rstrip('.'))}"
    yield ".SH SYNOPSIS\n" + "\n.br\n".join(f"\\fB{escaped(usage)}\\fR" for usage in usages)
    yield ".SH DESCRIPTION"
    for line in after:
        if not re.match(r"  \w|Commands:", line):
            yield escaped(line) if line else ".PP"
    yield ".SH OPTIONS"
    yield from options(its_options)
    yield ".SH COMMANDS"
    for command, meaning in listed:
        yield f".TP\n.B {escaped(command)}\n{escaped(meaning)}"
    for command, _ in listed:
        yield from section(program, command)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    print("\n".join(page(str(pathlib.Path(sys.argv[1]).resolve()))))


if __name__ == "__main__":
    main()
