#!/usr/bin/env python3
"""Writes what completes a command line, from what the command says of itself.

    tools/completion.py bash build/bin/fp3 > fp3        for share/bash-completion/completions
    tools/completion.py zsh build/bin/fp3 > _fp3        for share/zsh/site-functions
"""

import pathlib
import re
import sys

from manpage import commands, said, split

# Values that an option takes, where they are names: which command prints them, and how.
NAMES = {"config": (("info",), r"^(\w+): "), "integrator": (("compile", "--list"), r"^  (\w+) +order"), "engine": (("run", "--help"), r"\b(rtl|isa|fast|board)\b")}


def options(lines):
    """short or none, long, whether it takes a value, meaning."""
    for line in lines:
        found = re.match(r" +(?:-(\w|\?), +)?--([\w-]+)(\[?=\S+)?(?: +(.*))?$", line)
        if found:
            yield found[1], found[2], found[3] or "", found[4] or ""


def read(program):
    """The subcommands with their meaning, and of each its options."""
    listed = commands(split(said(program, "--help"))[3])
    return {name: (meaning, list(options(split(said(program, name, "--help"))[2]))) for name, meaning in listed}


def names(program):
    return {option: sorted(set(re.findall(pattern, said(program, *command), re.M))) for option, (command, pattern) in NAMES.items()}


def bash(of, values):
    yield "# Completes the command fp3. Written by tools/completion.py."
    yield "_fp3() {"
    yield '    local command=${COMP_WORDS[1]} word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} words='
    yield "    COMPREPLY=()"
    yield "    # bash takes --name=value for three words"
    yield '    [ "$word" = = ] && word=""'
    yield '    [ "$before" = = ] && before=${COMP_WORDS[COMP_CWORD-2]}'
    yield "    case $COMP_CWORD in"
    yield f"    1) mapfile -t COMPREPLY < <(compgen -W '{' '.join(of)}' -- \"$word\") && return ;;"
    yield "    esac"
    yield "    case $before in"
    for option, words in values.items():
        shorts = {f"-{short}" for _, its in of.values() for short, long, *_ in its if long == option and short}
        yield f"    {' | '.join(sorted(shorts) + ['--' + option])}) words='{' '.join(words)}' ;;"
    yield "    esac"
    yield '    if [ -z "$words" ] && [ "${word:0:1}" = - ]; then'
    yield "        case $command in"
    for name, (_, its) in of.items():
        yield f"        {name}) words='{' '.join('--' + long + ('=' if value.startswith('=') else '') for _, long, value, _ in its)}' ;;"
    yield "        esac"
    yield "    fi"
    yield '    [ -z "$words" ] || mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")'
    yield '    [[ ${COMPREPLY[0]-} != *= ]] || compopt -o nospace'
    yield "}"
    yield "complete -o default -F _fp3 fp3"


def quoted(text):
    """Within an argument of _arguments that stands in single quotes."""
    return re.sub(r"([\[\]:\\])", r"\\\1", text).replace("'", "'\\''")


def zsh(of, values):
    yield "#compdef fp3\n# Completes the command fp3. Written by tools/completion.py."
    yield "_fp3() {\n    local -a commands=("
    for name, (meaning, _) in of.items():
        yield f"        '{name}:{quoted(meaning)}'"
    yield "    )"
    yield "    if (( CURRENT == 2 )); then\n        _describe command commands\n        return\n    fi"
    yield "    local command=$words[2]\n    shift words\n    (( CURRENT-- ))\n    case $command in"
    for name, (_, its) in of.items():
        yield f"    {name}) _arguments \\"
        for short, long, value, meaning in its:
            what = f":{long}:({' '.join(values[long])})" if long in values else f":{long}:_files" if value.startswith("=") else ""
            begin = f"(-{short} --{long})'{{-{short},--{long}}}'" if short and short != "?" else f"--{long}"
            equals = "=" if value.startswith("=") and not begin.startswith("(") else ""
            yield f"        '{begin}{equals}[{quoted(meaning)}]{what}' \\"
        yield "        '*:file:_files' ;;"
    yield "    esac\n}\n_fp3 \"$@\""


def main():
    kinds = {"bash": bash, "zsh": zsh}
    if len(sys.argv) != 3 or sys.argv[1] not in kinds:
        sys.exit(__doc__)
    program = str(pathlib.Path(sys.argv[2]).resolve())
    print("\n".join(kinds[sys.argv[1]](read(program), names(program))))


if __name__ == "__main__":
    main()
