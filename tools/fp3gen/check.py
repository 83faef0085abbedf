"""Checks that the readers of isa/*.toml share. A mistake is raised as Bad, said for the person who edits the file."""

import re

NAME = re.compile(r"[a-z][a-z0-9_]*")


class Bad(Exception):
    """What is wrong with an input file, said for the person who edits it."""


def need(condition, file, message):
    if not condition:
        raise Bad(f"isa/{file}: {message}")


def keys(table, file, where, required, optional=()):
    """Exactly the known keys, and values of the expected types."""
    need(isinstance(table, dict), file, f"{where}: a table is expected")
    known = {**required, **dict(optional)}
    for key, value in table.items():
        need(key in known, file, f"{where}: unknown key '{key}' (known: {', '.join(known)})")
        kind = known[key]
        need(isinstance(value, kind) and not (kind is int and isinstance(value, bool)), file,
             f"{where}: '{key}' must be of type {kind.__name__}, not {value!r}")
    for key in required:
        need(key in table, file, f"{where}: '{key}' is missing")


def named(rows, file, what):
    """Names that are identifiers, each once."""
    seen = set()
    for row in rows:
        name = row["name"]
        need(NAME.fullmatch(name), file, f"{what} '{name}': a name is lower-case letters, digits, _")
        need(name not in seen, file, f"{what} '{name}' is defined twice")
        seen.add(name)


def bit_ranges(fields, file, where):
    """[high, low] pairs inside 32 bits that do not overlap."""
    owner = {}
    for name, pair in fields.items():
        need(isinstance(pair, list) and len(pair) == 2 and all(type(n) is int for n in pair)
             and 31 >= pair[0] >= pair[1] >= 0, file,
             f"{where}: field '{name}' must be [high, low] with 31 >= high >= low >= 0, not {pair!r}")
        for bit in range(pair[1], pair[0] + 1):
            need(bit not in owner, file,
                 f"{where}: fields '{owner.get(bit)}' and '{name}' overlap in bit {bit}")
            owner[bit] = name
    return owner
