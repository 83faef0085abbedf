"""Reference pages: docs/isa.md, registers.md and configurations.md."""

from .configs import condition, given, spoken
from .isa import MORE, word
from .registers import ACCESS, counter_rows
from .text import markdown, page


def layout(fields):
    """The word as a picture."""
    rule, bits, names = "+", " ", "|"
    for name, (hi, lo) in sorted(fields.items(), key=lambda item: -item[1][0]):
        bits += f"{hi} .. {lo}".center(9) + " "
        names += name.center(9) + "|"
        rule += "-" * 9 + "+"
    return ["```text", bits.rstrip(), rule, names, rule, "```"]


def example(isa, op):
    banks = isa["bank"]
    pick = {"d": ("object", 2), "a": ("object", 0), "b": ("shared", 1), "c": ("object", 3)}
    if "number" in op:
        pick[op["number"]] = ("object", 1)
    is_field = "field" in (op.get("gives"), op.get("takes"))
    text = ", ".join(str(pick[x][1]) if is_field and x == op.get("number") else f"{banks[pick[x][0]]['prefix']}{pick[x][1]}" for x in op["operands"])
    code = word(isa, op, {x: banks[b]["base"] + n for x, (b, n) in pick.items()})
    return text, code


def isa_page(isa, known):
    fields, banks = isa["field"], isa["bank"]
    unit = {"store": "object store"}
    noted = [op for op in isa["op"] if "note" in op]

    def path(op):
        return ", then ".join(unit.get(name, name) for name in op["path"])

    def row(op):
        text, code = example(isa, op)
        return [f"[`{op['name']}`](#{op['name']})" if op in noted else f"`{op['name']}`", op["code"], f"`{op['meaning']}`", path(op),
                f"`{condition(op['needs'], known)}`" if "needs" in op else "", f"`{' '.join(filter(None, (op['name'], text)))}`", f"`0x{code:08x}`"]

    body = [
        f"Revision {isa['revision']}. Every instruction is one 32-bit word. Values are IEEE 754 binary32 numbers.",
        "[Assembly language](assembly.md) has whole programs; the [glossary](glossary.md) explains record, visit, part, phase and list.",
        "", "## The word", "", "A word has five fields:", "", *layout(fields), "",
        "`op` is the instruction's code, `d` its destination; `a`, `b` and `c` are its operands. A field that the instruction",
        f"does not use must be 0. Codes from {MORE} on stand in `c`: `op` is all ones, and `c` is the code minus {MORE}. So these instructions have no",
        "operand `c`. A word whose code is not in the table below ends the run as illegal. Code 0 is unused, so erased memory is illegal, too.", "",
        "## Registers and constants", "",
        "An operand's value in its field is the number of a register or of a constant:", "",
        *markdown(["value", "in assembly", "what it is"],
                  [[f"{b['base']} .. {b['base'] + b['count'] - 1}",
                    f"`{b['prefix']}0` .. `{b['prefix']}{b['count'] - 1}`",
                    {"object": "the object's own registers; a destination is always one of these",
                     "shared": "constants that all objects of a scheduler share; written by the host"}[name]]
                   for name, b in banks.items()]), "",
        "A configuration may have fewer registers, and leave out instructions: [configurations](configurations.md).", "",
        "## Instructions", "",
        "The table's columns are the instruction's name, its code, what it does, the functional units that its operands go through, what the",
        "configuration must say, and an example with its word. Operands are written in the order d, a, b, c. `record[d]` is word d of the",
        "object's record. The unit *value* compares, selects, estimates and rounds; *sequence* is the scheduler's control of loops and phases.",
        "Names with a link have a note below.", "",
        *markdown(["name", "code", "meaning", "unit", "needs", "example", "word"], [row(op) for op in isa["op"]]),
        "", "Results are rounded to nearest, ties to even, with gradual underflow; a NaN result is always 7FC00000. The configuration `flush` flushes subnormal",
        "numbers to zero, and `cell` has neither infinity nor NaN: [arithmetic](arithmetic.md) has its results. An instruction can raise the flags invalid,",
        "overflow, underflow and inexact. The fifth flag, divide by zero, is raised by `rcp` and `rsqrt` with [logarithms](logarithmic.md) alone."]
    for op in noted:
        body += ["", f"### {op['name']}", op["note"]]
    return page("Instruction set", "isa/isa.toml", body)


def bit_text(pair):
    return str(pair[0]) if pair[0] == pair[1] else f"{pair[0]}:{pair[1]}"


def registers_page(regs):
    parts = regs["address"]
    body = ["Byte addresses of 32-bit words on the bus, AXI4-Lite. An address has these parts, S being the key `space_bit` of the",
            "[configuration](configurations.md), which register `array` shows: 16, or more if the store of all lanes has more than 64 KB.", "",
            *markdown(["bits", "part"], [
                [f"S+{parts['space']} and above", "the scheduler, tile by tile; all ones: all of them, where a write goes to all and a read gives the OR of all"],
                [f"S+{parts['space'] - 1} to S", "the space: 0 for the registers and windows below"],
                ["S-1 to 2", "the word within objects and status; 0 above bit 15 in space 0"]]), "",
            "![The address map: an address names a scheduler, a space and a word; space 0 has the registers, counters and windows with their "
            "addresses, spaces 1 to 3 are copies, objects and status](drawings/address_map.svg)", "",
            "[Put FP3 into a design](integration.md#the-bus) says which accesses are refused, what a reset does, and how many address bits a port has.",
            "A word of program, constants, objects or status that was never written has an arbitrary value, so a host writes every word that a run needs,",
            "and the status of its objects, before it starts.", "",
            "Each scheduler has all of the following.", "", "## Registers", "",
            *markdown(["address", "name", "access", "fields", "meaning"],
                      [[f"0x{row['at']:04x}", f"`{row['name']}`", ACCESS[row["access"]],
                        ", ".join(f"`{name}` [{bit_text(pair)}]"
                                  for name, pair in row.get("fields", {}).items()), row["doc"]]
                       for row in regs["register"]]), "",
            "## Registers of transfers", "",
            "With `master`: they move words between memory and the processor ([memory.md](memory.md)). They are the same ones for all schedulers. Written",
            "while a transfer runs they answer with an error.", "",
            *markdown(["address", "name", "access", "fields", "meaning"],
                      [[f"0x{row['at']:04x}", f"`{row['name']}`", ACCESS[row["access"]],
                        ", ".join(f"`{name}` [{bit_text(pair)}]" for name, pair in row.get("fields", {}).items()), row["doc"]]
                       for row in regs["transfer"]]), "",
            "## Counters", "",
            "Counters of the last run: 48 bits in two words, low word first, read only; they wrap. While a program runs the two words may",
            "not belong together: read the high word, the low word and the high word again, until both high words are the same. Every running",
            "cycle either issues an instruction or is counted as one of the stalls. A configuration with `counters = 0` has no counters: bit",
            "`counters` of `features_more` is 1.", "",
            *markdown(["address", "name", "counts"],
                      [[f"0x{a:04x}", f"`{row['name']}`", row["doc"]] for row, a in counter_rows(regs)]), "",
            "## Windows", "", "Onto the memories; refused with an error while a program runs.", "",
            *markdown(["address", "name", "words", "access", "meaning"],
                      [[f"0x{row['at']:04x}", f"`{row['name']}`", row["words"], ACCESS[row["access"]],
                        row["doc"]] for row in regs["window"]]), "",
            "## Spaces", "", "The large memories, likewise.", "",
            *markdown(["space", "name", "access", "fields", "meaning"],
                      [[row["at"], f"`{row['name']}`", ACCESS[row["access"]],
                        ", ".join(f"`{name}` [{bit_text(pair)}]" for name, pair in row.get("fields", {}).items()),
                        row["doc"]] for row in regs["space"]])]
    return page("Host registers", "isa/registers.toml", body)


def configs_page(known, configs):
    body = ["Each named configuration is a module `fp3_<name>` (`make top CONFIG=<name>`) with no parameters left, and a name",
            "that `fp3 run --config` takes.", ""]
    body += ["These are the ones to take ([what they need and give](integration.md#choose-a-configuration)):", ""]
    body += markdown(["you have", "take", "what it is"], [[row["take"], f"`{row['name']}`", row["doc"]] for row in sorted(configs, key=lambda row: row["name"] == "paper") if row["take"]])
    body += ["", "The others are steps on the way from one of these to another, or compute in another arithmetic. Pages, the tuner and tests compare",
             "them. The engines `isa` and `fast` know all; `make all` builds their simulated hardware, `make install` leaves it out.", ""]
    body += markdown(["name", "what it is"], [[f"`{row['name']}`", row["doc"]] for row in configs if not row["take"]])
    body += [""] + markdown(["", *[f"`{row['name']}`" for row in configs], "meaning"],
                            [[f"`{key}`", *[spoken(known[key], row[key]) for row in configs],
                              known[key]["meaning"]] for key in given(known)])
    body += ["", "These names follow from them; [registers.md](registers.md), the parameters of modules and `fp3_config` have them:", ""]
    body += markdown(["", "is, or is 1 where", "meaning"], [[f"`{key}`", condition(key, known), known[key]["meaning"]] for key in known if key not in given(known)])
    return page("Configurations", "isa/configs.toml", body)
