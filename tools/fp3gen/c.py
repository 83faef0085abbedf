"""Headers for the software."""

from .check import Bad, NAME
from .configs import CONFIG_KEYS, config_value
from .estimates import estimates
from .registers import address_rows, counter_rows, field_rows
from .text import MARK, columns

STRING_LIMIT = 4095  # bytes of a string literal that every C11 compiler takes


def c_header(file, source, body, guard=None):
    guard = guard or f"FP3_GEN_{file.upper()}_H"
    return [f"/* {MARK.format(source=source)} */", f"#ifndef {guard}", f"#define {guard}",
            "/* clang-format off */", "", *body, "", "/* clang-format on */", "#endif"]


def defines(rows):
    return columns([(f"#define {name} ", str(value)) for name, value in rows])


def x_macro(name, rows):
    cells = [[f"    X({row[0]}, "] + [f"{c}, " for c in row[1:-1]] + [f"{row[-1]})"] for row in rows]
    lines = [f"#define {name}(X)"] + columns(cells)
    width = max(map(len, lines))
    return [line.ljust(width) + " \\" for line in lines[:-1]] + [lines[-1]]


def quote(text):
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def isa_c(isa):
    ops = isa["op"]
    return c_header("isa", "isa/isa.toml", [
        *defines([("FP3_ISA_REVISION", isa["revision"])]), "",
        "/* Fields of the 32-bit word. */",
        *defines([(f"FP3_FIELD_{name.upper()}_{end}", pair[i]) for name, pair in isa["field"].items()
                  for i, end in enumerate(("HI", "LO"))]), "",
        "/* Banks, as an operand names them. */",
        *defines([(f"FP3_BANK_{name.upper()}_{key.upper()}", bank[key])
                  for name, bank in isa["bank"].items() for key in ("base", "count")]),
        *defines([(f"FP3_BANK_{name.upper()}_PREFIX", f"'{bank['prefix']}'")
                  for name, bank in isa["bank"].items()]), "",
        "enum fp3_opcode {",
        *columns([(f"    FP3_OP_{op['name'].upper()} ", f"= {op['code']},") for op in ops]),
        "};", "",
        "/* X(NAME, code, mnemonic, operands in assembly order, unit) */",
        *x_macro("FP3_OPS", [(op["name"].upper(), str(op["code"]), quote(op["name"]),
                              quote("".join(op["operands"])), op["unit"].upper()) for op in ops]), "",
        "/* X(NAME, key): what a configuration must have for an operation. */",
        *x_macro("FP3_OP_NEEDS", [(op["name"].upper(), op["needs"]) for op in ops if "needs" in op]),
    ])


def estimates_c():
    table = estimates()
    lines = [", ".join(f"{value:3}" for value in table[i:i + 16]) + "," for i in range(0, 2048, 16)]
    return c_header("estimates", "estimates() there", [
        "/* Fractions of 9 bits: see estimate.c. */",
        "static const unsigned short fp3_estimates[2048] = {", *[f"    {line}" for line in lines], "};"])


def registers_c(regs):
    def at(address):
        return f"0x{address:04x}u"

    return c_header("registers", "isa/registers.toml", [
        "/* Byte addresses of 32-bit words. */",
        *defines([(f"FP3_ADDR_{row['name'].upper()}", at(row["at"])) for row in regs["register"]]), "",
        "/* Fields of registers. */",
        *defines([("FP3_" + name, value) for name, value in field_rows(regs)]), "",
        "/* Counters: 64 bits in two words each, low word first. */",
        *defines([(f"FP3_ADDR_COUNTER_{row['name'].upper()}", at(a)) for row, a in counter_rows(regs)]), "",
        "/* X(NAME, name, address) */",
        *x_macro("FP3_COUNTERS", [(row["name"].upper(), quote(row["name"]), at(a))
                                  for row, a in counter_rows(regs)]), "",
        "/* Windows onto the memories. */",
        *defines([(f"FP3_ADDR_WINDOW_{row['name'].upper()}", at(row["at"])) for row in regs["window"]]), "",
        "/* The parts of an address, and what they say. */",
        *defines([("FP3_" + name, value) for name, value in address_rows(regs)]),
    ])


def counters_c(regs):
    return c_header("counters", "isa/registers.toml", [
        "/* The hardware's counters: docs/registers.md. */",
        "typedef enum {", *[f"    FP3_COUNTER_{row['name'].upper()}," for row in regs["counter"]],
        "    FP3_COUNTER_COUNT", "} fp3_counter;"], guard="FP3_COUNTERS_H")


def configs_c(configs):
    return c_header("configs", "isa/configs.toml", [
        f"/* X(name, doc, {', '.join(CONFIG_KEYS)}) */",
        *x_macro("FP3_CONFIGS", [(row["name"], quote(row["doc"]),
                                  *[config_value(key, row[key]) for key in CONFIG_KEYS])
                                 for row in configs]),
    ])


def integrators_c(root):
    """The tables of integrators as string literals, so that the library needs no file to know them."""
    rows = []
    for path in sorted((root / "programs/integrators").glob("*.cfg")):
        text = path.read_text(encoding="utf-8")
        if not NAME.fullmatch(path.stem):
            raise Bad(f"{path.relative_to(root)}: a name is lower-case letters, digits and _")
        if len(text.encode()) > STRING_LIMIT:
            raise Bad(f"{path.relative_to(root)}: {len(text.encode())} bytes, more than a string of C has ({STRING_LIMIT})")
        rows.append([f"    X({path.stem},", *[f"      {quote(line)[:-1]}\\n\"" for line in text.splitlines()]])
        rows[-1][-1] += ")"
    lines = ["#define FP3_INTEGRATORS(X)", *[line for row in rows for line in row]]
    width = max(map(len, lines))
    return c_header("integrators", "programs/integrators/", [
        "/* X(name, text of the table) */",
        *[line.ljust(width) + " \\" for line in lines[:-1]], lines[-1],
    ])
