"""The register file of the host port, from isa/registers.toml: its masks and tables, and the bundles SETTINGS and EVENTS."""

import textwrap

from .registers import number, settings, shown, shown_word
from .text import MARK

GROUP = 8  # the port reads its registers in groups of this many


def mask(rows):
    """A bit for each of these registers; one that needs a key of the configuration has it where that key is not 0."""
    terms = {}
    for row in rows:
        key = " && ".join(f"{key.upper()} != 0" for key in row.get("needs", ()))
        terms[key] = terms.get(key, 0) | 1 << number(row)
    return " | ".join(f"({key} ? 32'h{bits:08x} : 32'd0)" if key else f"32'h{bits:08x}" for key, bits in terms.items())


def bound(value):
    return f"32'd{value}" if isinstance(value, int) else value.upper()


def width(row):
    """Bits that a setting has in its register, and in the bundle: there it is less its least."""
    least, most = row.get("range", [0, 0xffffffff])
    return f"32'd{(most - least).bit_length()}" if isinstance(most, int) else f"$clog2({most.upper()} + 1)"


def table(name, cells, count):
    """A word for each register, the first in the low bits; cells: the text of those that are not 0, by number."""
    words = ", ".join(cells.get(i, "32'd0") for i in reversed(range(count)))
    return [f"localparam [{32 * count - 1}:0] {name} = {{",
            *textwrap.wrap(words + "};", 116, initial_indent="    ", subsequent_indent="    ", break_long_words=False)]


def host_map_verilog(regs, revision):
    registers = regs["register"]
    kept = settings(regs)
    count = GROUP * (max(map(number, registers)) // GROUP + 1)
    ranged = {}
    for row in kept:
        if "range" in row:
            ranged.setdefault(tuple(row["range"]), []).append(row)
    numbers = {number(row): row for row in kept}
    lows = {number(row): " + ".join(["32'd0", *map(width, kept[:i])]) for i, row in enumerate(kept)}
    constants = [(number(row), f"REGISTER_{row['name'].upper()}",
                  shown_word(row, shown(row, regs, revision, str.upper, "(({}) != 0 ? 1 : 0)", "32'd{}")))
                 for row in registers if "shows" in row]
    lines = [
        "// By the number of a register, its address / 4: whether it can be read, and written.",
        f"localparam integer REGISTER_COUNT = {count};",
        f"localparam [31:0] READABLE = {mask([row for row in registers if row['access'] != 'wo'])};",
        f"localparam [31:0] WRITABLE = {mask([row for row in registers if row['access'] != 'ro'])};",
        "// The settings of a run: how many bits each keeps (0: it is no setting), where they are in SETTINGS, what is",
        "// subtracted from the word, and what is kept after a reset.",
        f"localparam [31:0] IS_SETTING = {mask(kept)};",
        *table("SETTING_BITS", {i: width(row) for i, row in numbers.items()}, count),
        *table("SETTING_AT", lows, count),
        *table("SETTING_LEAST", {i: bound(row["range"][0]) for i, row in numbers.items() if "range" in row}, count),
        *table("SETTING_RESET", {i: f"32'd{row.get('reset', 0) - row.get('range', [0])[0]}" for i, row in numbers.items()}, count),
        "// The ranges of settings: the least and the most of each, and which registers have it.",
        f"localparam integer RANGES = {len(ranged)};",
        *(f"localparam [{32 * len(ranged) - 1}:0] {name} = {{{', '.join(reversed(cells))}}};" for name, cells in (
            ("RANGE_LEAST", [bound(least) for least, _ in ranged]), ("RANGE_MOST", [bound(most) for _, most in ranged]),
            ("RANGE_OF", [f"32'h{sum(1 << number(row) for row in rows):08x}" for rows in ranged.values()]))),
        "// What the registers show that show the configuration.",
        *(f"localparam [31:0] {name} = {word};" for _, name, word in constants),
        *table("SHOWN", {i: name for i, name, _ in constants}, count)]
    return [f"// {MARK.format(source='isa/registers.toml')}",
            "// Included inside a module that includes config.vh.", "// verilator lint_off UNUSEDPARAM", *lines,
            "// verilator lint_on UNUSEDPARAM"]


def bundle(name, what, source, fields):
    """The macros of a bundle; fields: names and widths, the first in the low bits."""
    low = name.lower().removesuffix("s")
    wires = [f"    wire {'' if size == '1' else f'[{size}-1:0] '}{low}_{field};" for field, size in fields]
    return [f"// {MARK.format(source=source)}", f"// The bundle {name}: {what} front/decoded.vh shows how a bundle is used.",
            f"`define FP3_{name}_W ({' + '.join(size for _, size in fields)})",
            f"`define FP3_{name}_FIELDS \\", "    /* verilator lint_off UNUSEDSIGNAL */ \\", *[f"{wire} \\" for wire in wires],
            "    /* verilator lint_on UNUSEDSIGNAL */",
            f"`define FP3_{name} {{{', '.join(f'{low}_{field}' for field, _ in reversed(fields))}}}"]


def settings_verilog(regs):
    return bundle("SETTINGS", "what the host has set for a run, each less the least of its range.", "isa/registers.toml",
                  [(row["name"], width(row)) for row in settings(regs)])


def events_verilog(regs):
    return bundle("EVENTS", "what the counters count in a cycle.", "isa/registers.toml",
                  [(row["name"], "1") for row in regs["counter"]])
