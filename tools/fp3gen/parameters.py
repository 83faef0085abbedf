"""The parameters of the RTL: the keys of a configuration by name, and CONFIG, which is all of them."""

import re
import textwrap

from .configs import MASK_BITS, condition, derive, either, given, plain, verilog_of
from .text import MARK, columns

WORD = 32  # bits of CONFIG for each key, the first in the low ones


def bits(key):
    return MASK_BITS if key.endswith("_cuts") else WORD


def default_row(known):
    """What fp3's parameters are unless they are set."""
    return derive({name: known[name].get("default", known[name]["range"][0]) for name in given(known)}, known)


def config_range(known):
    return f"[{WORD * len(given(known)) - 1}:0]"


def derived(known):
    """Keys that follow from others; not to be set."""
    return columns([("parameter integer ", f"{name.upper()} ", f"= {verilog_of(key)},") for name, key in known.items() if "is" in key])


def follow(known):
    """All of these in one number: of fp3's parameters, and of what its other parameters say."""
    at, terms = 0, []
    for name, key in known.items():
        if "is" in key:
            terms.append(f"{name.upper()} << {at}")
            at += key["range"][1].bit_length()
    return " | ".join(terms)


def config_word(row, known):
    """CONFIG of a configuration, for a module that stands alone."""
    return f"{WORD * len(given(known))}'h" + "".join(f"{row[key]:08x}" for key in reversed(given(known)))


def numbered(key):
    """What the numbers of choices stand for."""
    return "".join(f"{number}: {name}, " for number, name in enumerate(key.get("choices", ())))[:-2] + ". " * ("choices" in key)


def rule(text):
    """Words as part of a module's name."""
    return re.sub(r"\W+", "_", text).upper()


def parameters_verilog(known, regs):
    """The parameters of fp3."""
    defaults = default_row(known)
    rows = [(f"parameter [{bits(key) - 1}:0] ", f"{key.upper()} ", f"= {defaults[key]}, ", f"// {numbered(known[key])}{known[key]['meaning']}")
            for key in given(known)]
    words = [key.upper() if bits(key) == WORD else f"{WORD - bits(key)}'d0, {key.upper()}" for key in reversed(given(known))]
    return [f"// {MARK.format(source='isa/configs.toml')}", "// Included in parameter lists: by rtl/config/config.vh, where CONFIG is given and says the keys, and by fp3.",
            "`ifdef FP3_OF_CONFIG", *config_keys_verilog(defaults, known), "`else",
            "// Of fp3: set what you need by name, and leave CONFIG and what follows it alone.", *columns(rows), f"// All of them, {WORD} bits each, the first in the low ones. The lint_off: each parameter is declared",
            "// with its width; Verilator asks it of the plain number that sets one.",
            "// verilator lint_off WIDTHCONCAT", f"parameter {config_range(known)} CONFIG = {{",
            *textwrap.wrap(", ".join(words) + "},", 110, initial_indent="    ", subsequent_indent="    "),
            "// verilator lint_on WIDTHCONCAT",
            "// verilator lint_off UNUSEDPARAM", *derived(known), "// verilator lint_on UNUSEDPARAM",
            "// Whoever sets one of these is told (rtl/config/fp3_config_rules.v).",
            *textwrap.wrap(f"parameter integer FOLLOW = {follow(known)},", 110, subsequent_indent="    "),
            "// Of a byte address: its top says the scheduler, all ones: all of them (docs/registers.md).",
            f"parameter integer ADDRESS_W = SPACE_BIT + {regs['address']['space']} + (TILES * SCHEDULERS > 1 ? $clog2(TILES * SCHEDULERS + 1) : 0)",
            "`endif"]


def config_keys_verilog(row, known):
    """The parameters of all other modules; CONFIG says what this row says unless it is set."""
    rows = [("parameter integer " if bits(key) == WORD else f"parameter [{bits(key) - 1}:0] ", f"{key.upper()} ",
             f"= CONFIG[{WORD * i + bits(key) - 1}:{WORD * i}],") for i, key in enumerate(given(known))]
    lines = [f"parameter {config_range(known)} CONFIG = {config_word(row, known)},", *columns(rows), *derived(known)]
    return [*lines[:-1], lines[-1].rstrip(",")]


def config_rules_verilog(known):
    """What the keys' tables say of a configuration: a broken rule names a module that does not exist."""
    rules = [(f"FOLLOW != -1 && FOLLOW != ({follow(known)})", "FP3_has_a_parameter_set_that_follows_from_others")]
    for name, key in known.items():
        this, (low, high) = name.upper(), key["range"]
        asks, says = f"{this} {'<' if 'full' in key else '>'} {plain(key)}", rule(condition(name, known))
        if bits(name) == WORD and "is" not in key:
            power, said = key.get("power_of_two"), f"{this}_must_be_{low}_to_{high}"
            wrong = [f"{this} < {low}", f"{this} > {high}"] + [f"({this} & ({this} - 1)) != 0"] * bool(power)
            rules.append((" || ".join(wrong), said + "_and_a_power_of_two" * bool(power)))
        for others in (either(words) for words in key.get("needs", [])):
            none = " && ".join(f"{other.upper()} == 0" for other in others)
            rules.append((f"{asks} && {none}", f"{says}_needs_{'_or_'.join(rule(condition(other, known)) for other in others)}"))
        rules += [(f"{asks} && {other.upper()} != 0", f"{says}_excludes_{rule(condition(other, known))}") for other in key.get("excludes", [])]
    return [f"// {MARK.format(source='isa/configs.toml')}", "// Included by rtl/config/fp3_config_rules.v, within a generate block.",
            *(f"if ({wrong}) begin : g_{said.lower()}\n    {said} u_error ();\nend" for wrong, said in rules)]
