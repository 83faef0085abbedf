"""The parameters of the RTL: the keys of a configuration by name, and CONFIG, which is all of them."""

import textwrap

from .configs import MASK_BITS, keys_of
from .text import MARK, columns

GROUP = 4  # lanes that hear the same in the same cycle
GROUPS = [("parameter integer ", "GROUP ", f"= {GROUP},", " // lanes that hear the same in the same cycle"),
          ("parameter integer ", "GROUPS ", "= (LANES + GROUP - 1) / GROUP", "")]
WORD = 32  # bits of CONFIG for each key, the first in the low ones


def bits(key):
    return MASK_BITS if key.endswith("_cuts") else WORD


def default_row(known):
    """What fp3's parameters are unless they are set."""
    return {name: key.get("default", key["range"][0]) for name, key in known.items()}


def config_range(known):
    return f"[{WORD * len(known) - 1}:0]"


def config_word(row):
    """CONFIG of a configuration, for a module that stands alone."""
    return f"{WORD * len(keys_of(row))}'h" + "".join(f"{row[key]:08x}" for key in reversed(keys_of(row)))


def parameters_verilog(known, regs):
    """The parameters of fp3."""
    defaults = default_row(known)
    rows = [(f"parameter [{bits(key) - 1}:0] ", f"{key.upper()} ", f"= {defaults[key]}, ", f"// {known[key]['meaning']}")
            for key in known]
    words = [key.upper() if bits(key) == WORD else f"{WORD - bits(key)}'d0, {key.upper()}" for key in reversed(known)]
    return [f"// {MARK.format(source='isa/configs.toml')}",
            "// Included in the parameter list of fp3: set what you need by name, and leave CONFIG and what follows it alone.",
            *columns(rows), f"// All of them, {WORD} bits each, the first in the low ones. The lint_off: each parameter is declared",
            "// with its width; Verilator asks it of the plain number that sets one.",
            "// verilator lint_off WIDTHCONCAT", f"parameter {config_range(known)} CONFIG = {{",
            *textwrap.wrap(", ".join(words) + "},", 110, initial_indent="    ", subsequent_indent="    "),
            "// verilator lint_on WIDTHCONCAT",
            "// Of a byte address: its top says the scheduler, all ones: all of them (docs/registers.md).",
            f"parameter integer ADDRESS_W = {regs['address']['scheduler'][1]} + (TILES * SCHEDULERS > 1 ? $clog2(TILES * SCHEDULERS + 1) : 0),", *columns(GROUPS)]


def config_keys_verilog(row):
    """The parameters of all other modules; CONFIG says what this row says unless it is set."""
    known = keys_of(row)
    rows = [("parameter integer " if bits(key) == WORD else f"parameter [{bits(key) - 1}:0] ", f"{key.upper()} ",
             f"= CONFIG[{WORD * i + bits(key) - 1}:{WORD * i}],", "") for i, key in enumerate(known)] + GROUPS
    return [f"// {MARK.format(source='isa/configs.toml')}", "// Included by rtl/config/config.vh.",
            f"parameter {config_range(known)} CONFIG = {config_word(row)},", *columns(rows)]


def shown_verilog(regs, known):
    """The registers whose fields are keys of a configuration."""
    out = []
    for reg in regs["register"]:
        if reg.get("fields") and all(name in known for name in reg["fields"]):
            out += [f"localparam [31:0] REGISTER_{reg['name'].upper()} =",
                    " |\n".join(f"    ({name.upper()} & {(2 << hi - lo) - 1}) << {lo}"
                                for name, (hi, lo) in reg["fields"].items()) + ";"]
    return [f"// {MARK.format(source='isa/registers.toml')}",
            "// Included inside a module that includes config.vh: registers that show the configuration.", *out]
