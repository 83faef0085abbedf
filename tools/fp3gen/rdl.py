"""rtl/gen/fp3.rdl, the register map in SystemRDL 2.0: one scheduler's, and that of every configuration."""

import textwrap

from .registers import counter_rows, shown
from .text import MARK

SW = {"ro": "r", "rw": "rw", "wo": "w"}


def text(words):
    return '"' + words.replace("\\", "\\\\").replace('"', '\\"') + '"'


def product(keys):
    return " * ".join(key.upper() for key in keys)


def present(row):
    """Where a configuration lacks what the row needs, there is no such register or memory."""
    return [f"ispresent = {' && '.join(f'{key.upper()} > 0' for key in row['needs'])};"] if "needs" in row else []


def field(properties, name, pair, reset):
    bits = f"[{pair[0]}:{pair[1]}]"
    return f"field {{ {' '.join(properties)} }} {name}{bits}{'' if reset is None else f' = {reset}'};"


def register_fields(row, regs, revision):
    """The fields; a register without any has one, `value`."""
    fields = row.get("fields") or {"value": [31, 0]}
    pulses = row["access"] == "wo"
    shows = shown(row, regs, revision, str.upper, "({}) > 0 ? 1 : 0") if "shows" in row else None
    interrupts = row.get("interrupt", {})
    for i, (name, pair) in enumerate(fields.items()):
        if shows:
            yield field(["sw = r;", "hw = na;"], name, pair, shows[i])
        elif name in interrupts:
            yield field(["sw = rw;", "onwrite = woclr;", "hw = w;", "level intr;"], name, pair, 0)
        else:
            hw = "w" if row["access"] == "ro" else "r"
            yield field([f"sw = {SW[row['access']]};", f"hw = {hw};"] + ["singlepulse;"] * (pulses and pair[0] == pair[1]), name, pair, row.get("reset", 0))
    for name, enable in interrupts.items():
        yield f"{name}->enable = {enable};"


def block(head, lines, tail):
    return [head + " {", *["    " + line for line in lines], "} " + tail + ";"]


def memory(row, is_space):
    words = product(row["holds"])
    if "instead" in row:
        words = f"{words} > 0 ? {words} : {product(row['instead'])}"
    elif set(row["holds"]) & set(row.get("needs", ())):  # the compiler wants a word of memories that are not there, too
        words = f"{words} > 0 ? {words} : 1"
    inner = []
    if "fields" in row:
        inner = block("reg", [field([f"sw = {SW[row['access']]};"], name, pair, None) for name, pair in row["fields"].items()],
                      f"word[{words}]")
    return block("external mem", [f"desc = {text(row['doc'])};", *present(row), f"mementries = {words};", "memwidth = 32;",
                                  f"sw = {SW[row['access']]};", *inner], f"{row['name']} @ {row['at']} << SPACE_BIT" if is_space else f"{row['name']} @ 0x{row['at']:04x}")


def scheduler(isa, regs, known, defaults):
    """One scheduler's registers and memories; the parameters are the keys of a configuration."""
    names = [key for key in known if not key.endswith("_cuts")]
    parameters = ",\n".join(f"    longint unsigned {key.upper()} = {defaults[key]}" for key in names)
    registers = []
    for row in regs["register"]:
        registers += block("reg", [f"desc = {text(row['doc'])};", *present(row), *register_fields(row, regs, isa["revision"])],
                           f"{row['name']} @ 0x{row['at']:04x}")
    registers += [f"fp3_counter {row['name']} @ 0x{at:04x}; {row['name']}->desc = {text(row['doc'])};" for row, at in counter_rows(regs)]
    first, transfers = regs["transfer"][0], []
    for row in regs["transfer"]:
        transfers += block("reg", [f"desc = {text(row['doc'])};", *register_fields(row, regs, isa["revision"])], f"{row['name']} @ 0x{row['at'] - first['at']:x}")
    transfers = block("addrmap", present(first) + transfers, f"transfers @ 0x{first['at']:04x}")
    memories = [line for row in regs["window"] for line in memory(row, False)]
    memories += [line for row in regs["space"] for line in memory(row, True)]
    return ["// Counters have no value before the first run starts.", "regfile fp3_counter {",
            "    default sw = r; default hw = w;", "    reg { field {} value[31:0]; } low @ 0x0;",
            "    reg { field {} value[31:0]; } high @ 0x4;", "};", "",
            "addrmap fp3_scheduler #(", parameters, ") {", "    default regwidth = 32;",
            *["    " + line for line in block("addrmap", registers, "registers @ 0x0") + transfers + memories], "};"]


def config_map(row, regs):
    count = row["tiles"] * row["schedulers"]
    first = row["space_bit"] + regs["address"]["space"]
    values = ", ".join(f".{key.upper()}({value})" for key, value in row.items() if isinstance(value, int) and not key.endswith("_cuts"))
    kind = textwrap.wrap(f"fp3_scheduler #({values})", 110, subsequent_indent="    ")

    def instance(name):
        return [*["    " + line for line in kind[:-1]], f"    {kind[-1]} {name};"]

    lines = [f"addrmap fp3_{row['name']} {{", f"    desc = {text(row['doc'])};"]
    if count == 1:
        return lines + instance("scheduler @ 0x0") + ["};"]
    last = (1 << count.bit_length()) - 1
    lines += instance(f"scheduler[{count}] @ 0x0 += 0x{1 << first:x}")
    lines += ["    // A write goes to all schedulers, a read gives the OR of all."]
    return lines + instance(f"broadcast @ 0x{last << first:x}") + ["};"]


def rdl_file(isa, regs, known, configs, defaults):
    out = [f"// {MARK.format(source='isa/registers.toml and isa/configs.toml')}",
           "// SystemRDL 2.0: the map of one scheduler, then that of each configuration, whose module has the same name.", "",
           *scheduler(isa, regs, known, defaults)]
    for row in configs:
        out += ["", *config_map(row, regs)]
    return out
