"""Reads and checks isa/*.toml."""

import re
import tomllib
from typing import NamedTuple

from .check import Bad, keys
from .configs import check_configs, check_keys
from .isa import check_isa, PATHS
from .registers import check_keys_named, check_registers, exceptions, show_keys, show_version
from .timing import check_timing


class Machine(NamedTuple):
    """What isa/ says: tables as their files have them, keys by name, and rows of configurations with every key."""
    isa: dict
    registers: dict
    keys: dict
    configs: list
    timing: dict


def read(root, file):
    path = root / "isa" / file
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise Bad(f"isa/{file}: {error.strerror}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise Bad(f"isa/{file}: {error}") from None


def version(root):
    """The project's, as status.h has it: the numbers of "0.1.0"."""
    found = re.search(r'^#define FP3_VERSION "(\d+)\.(\d+)\.(\d+)"$', (root / "sw/include/fp3/status.h").read_text(encoding="utf-8"), re.M)
    if not found:
        raise Bad('sw/include/fp3/status.h: there must be a line #define FP3_VERSION "MAJOR.MINOR.PATCH"')
    return [int(number) for number in found.groups()]


def load(root):
    isa, regs, configs, timing = (read(root, f"{name}.toml") for name in ("isa", "registers", "configs", "timing"))
    keys(configs, "configs.toml", "top level", {"key": dict, "config": list})
    show_keys(regs, configs["key"])
    show_version(regs, version(root))
    check_registers(regs, sorted(set(PATHS.values())))
    known = check_keys(configs["key"], regs, root)
    check_keys_named(regs, known)
    check_timing(timing)
    check_isa(isa, known, list(exceptions(regs)))
    return Machine(isa, regs, known, check_configs(configs["config"], known), timing)
