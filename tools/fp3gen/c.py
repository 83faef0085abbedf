"""Headers for the software."""

from .check import Bad, NAME
from .configs import condition, config_value, given
from .estimates import estimates
from .isa import GIVES, MORE, UNITS, WRITES, counter_of
from .logarithms import curves, sums
from .registers import address_rows, counter_rows, exceptions, field_rows, shown, shown_word
from .text import MARK, columns

STRING_LIMIT = 4095  # bytes of a string literal that every C11 compiler takes


def c_header(file, source, body, guard=None):
    guard = guard or f"FP3_GEN_{file.upper()}_H"
    return [f"/* {MARK.format(source=source)} */", f"#ifndef {guard}", f"#define {guard}",
            "/* clang-format off */", "", *body, "", "/* clang-format on */", "#endif"]


def defines(rows):
    return columns([(f"#define {name} ", str(value)) for name, value in rows])


def x_macro(name, rows, arguments="X"):
    cells = [[f"    X({row[0]}, "] + [f"{c}, " for c in row[1:-1]] + [f"{row[-1]})"] for row in rows]
    lines = [f"#define {name}({arguments})"] + columns(cells)
    width = max(map(len, lines))
    return [line.ljust(width) + " \\" for line in lines[:-1]] + [lines[-1]]


def quote(text):
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def initialisers(name, rows):
    """The rows of a table, each value by the name of its field."""
    cells = [["    {"] + [f".{field} = {value}, " for field, value in row[:-1]]
             + [f".{row[-1][0]} = {row[-1][1]}}},"] for row in rows]
    lines = [f"#define {name}", *columns(cells)]
    width = max(map(len, lines))
    return [line.ljust(width) + " \\" for line in lines[:-1]] + [lines[-1].rstrip(",")]


def enumeration(prefix, names):
    return ["typedef enum {", *[f"    FP3_{prefix}_{name.upper()}," for name in names], f"    FP3_{prefix}_COUNT",
            f"}} fp3_{prefix.lower()};"]


def isa_c(isa, regs):
    return c_header("isa", "isa/isa.toml and registers.toml", [
        *defines([("FP3_ISA_REVISION", isa["revision"])]), "",
        "/* Fields of the 32-bit word. */",
        *defines([(f"FP3_FIELD_{name.upper()}_{end}", pair[i]) for name, pair in isa["field"].items()
                  for i, end in enumerate(("HI", "LO"))]), "",
        "/* Banks, as an operand names them. */",
        *defines([(f"FP3_BANK_{name.upper()}_{key.upper()}", bank[key])
                  for name, bank in isa["bank"].items() for key in ("base", "count")]),
        *defines([(f"FP3_BANK_{name.upper()}_PREFIX", f"'{bank['prefix']}'")
                  for name, bank in isa["bank"].items()]), "",
        "/* Bits of numbers. */",
        *defines([(f"FP3_BITS_{name.upper()}", f"0x{value:08x}u") for name, value in isa["bits"].items()]), "",
        "/* A code from here on is all ones in field op, and the rest in field c. */",
        *defines([("FP3_CODE_MORE", MORE)]), "",
        "enum fp3_opcode {",
        *columns([(f"    FP3_OP_{op['name'].upper()} ", f"= {op['code']},") for op in isa["op"]]),
        "};", "",
        "/* The hardware's counters: docs/registers.md. */",
        *enumeration("COUNTER", [row["name"] for row in regs["counter"]]), "",
        "/* Exceptions, as bits. */", "enum {",
        *columns([(f"    FP3_FLAG_{name.upper()} ", f"= 1u << {lo},") for name, (_, lo) in exceptions(regs).items()]),
        "};"], guard="FP3_ISA_H")


def operations_c(isa, flags):
    def row(op):
        return [("code", f"FP3_OP_{op['name'].upper()}"), ("name", quote(op["name"])),
                ("operands", quote("".join(op["operands"]))), ("sources", max(0, len(op["operands"]) - 1 - ("number" in op))),
                ("path", " | ".join(f"FP3_UNIT_{unit.upper()}" for unit in op["path"])),
                ("counter", f"FP3_COUNTER_{counter_of(op).upper()}"),
                ("needs", f"FP3_KEY_{op.get('needs', 'none').upper()}"),
                ("raises", f"0x{sum(1 << flags[name][0] for name in op.get('raises', [])):02x}"),
                ("writes", f"FP3_WRITES_{op.get('writes', 'always').upper()}"),
                ("commutes", int(op.get("commutes", False))),
                ("gives", f"FP3_GIVES_{op.get('gives', 'nothing').upper()}"),
                ("takes_field", int("takes" in op)),
                ("number", f"'{op['number']}'" if "number" in op else "0"),
                ("computes", f"FP3_OP_{op['computes'].upper()}" if "computes" in op else "0"),
                ("is_first", int(op.get("stands") == "a"))]

    return c_header("operations", "isa/isa.toml", [
        "/* Functional units. */", "enum {",
        *columns([(f"    FP3_UNIT_{unit.upper()} ", f"= 1u << {i},") for i, unit in enumerate(UNITS)]), "};", "",
        "typedef enum {", *[f"    FP3_WRITES_{word.upper()}," for word in WRITES], "} fp3_writes;", "",
        "typedef enum {", *[f"    FP3_GIVES_{word.upper()}," for word in GIVES], "} fp3_gives;", "",
        "/* Of fp3_operations. */", *initialisers("FP3_OPERATION_ROWS", [row(op) for op in isa["op"]])])


def estimates_c():
    table = estimates()
    lines = [", ".join(f"{value:3}" for value in table[i:i + 16]) + "," for i in range(0, 2048, 16)]
    return c_header("estimates", "estimates() there", [
        "/* Fractions of 9 bits: see estimate.c. */",
        "static const unsigned short fp3_estimates[2048] = {", *[f"    {line}" for line in lines], "};"])


def logarithms_c():
    def rows(words):
        cells = ["{" + ", ".join(map(str, word)) + "}," for word in words]
        return ["    " + " ".join(cells[i:i + 4]) for i in range(0, len(cells), 4)]

    return c_header("logarithms", "logarithms.py there", [
        "/* See lns.c. */", "#include <stdint.h>", "",
        "typedef struct {", "    int32_t c0;", "    uint32_t c1, c2, c3;", "} fp3_lns_sum;", "",
        "typedef struct {", "    int32_t c0, c1, c2;", "} fp3_lns_curve;", "",
        "static const fp3_lns_sum fp3_lns_sums[1024] = {", *rows(sums()), "};", "",
        "static const fp3_lns_curve fp3_lns_curves[1024] = {", *rows(curves()), "};"])


def registers_c(regs, revision):
    def at(address):
        return f"0x{address:04x}u"

    shows = [(row, shown(row, regs, revision, "(config)->{}".format, "(({}) != 0)", "{}u")) for row in regs["register"]
             if "shows" in row and row["name"] != "version"]
    return c_header("registers", "isa/registers.toml", [
        "/* Byte addresses of 32-bit words. */",
        *defines([(f"FP3_ADDR_{row['name'].upper()}", at(row["at"])) for row in regs["register"] + regs["transfer"]]), "",
        "/* Fields of registers. */",
        *defines([("FP3_" + name, value) for name, value in field_rows(regs)]), "",
        "/* X(NAME, word): the registers that show the configuration, and what they must show for this one. */",
        *x_macro("FP3_SHOWN", [(row["name"].upper(), shown_word(row, values)) for row, values in shows], "X, config"),
        "#define FP3_ID_LETTERS " + hex(next(row["shows"][1] for row in regs["register"] if row["name"] == "id")) + "u", "",
        "/* Counters: 48 bits in two words each, low word first. */",
        *defines([(f"FP3_ADDR_COUNTER_{row['name'].upper()}", at(a)) for row, a in counter_rows(regs)]), "",
        "/* X(NAME, name, address) */",
        *x_macro("FP3_COUNTERS", [(row["name"].upper(), quote(row["name"]), at(a))
                                  for row, a in counter_rows(regs)]), "",
        "/* Windows onto the memories. */",
        *defines([(f"FP3_ADDR_WINDOW_{row['name'].upper()}", at(row["at"])) for row in regs["window"]]), "",
        "/* The parts of an address, and what they say. bit: where its space begins, key `space_bit` and the field of this name. */",
        *defines([("FP3_" + name, value) for name, value in address_rows(regs)]),
        "#define FP3_ADDRESS_OF(bit, scheduler, address) ((uint32_t)(scheduler) << ((bit) + FP3_ADDRESS_SPACE_BITS) | (address))",
        "#define FP3_ADDRESS_IN(bit, space, word) ((uint32_t)(space) << (bit) | (uint32_t)(word) << 2)",
    ])


def configs_c(known, configs):
    fields = [(f"    uint32_t {name}; ", f"/* {key['meaning']} */") for name, key in known.items()]
    return c_header("configs", "isa/configs.toml", [
        "#include <stdint.h>", "",
        "typedef struct {", "    const char *name, *doc;", "    const char *take; /* the need that it serves; NULL: it is there to be compared */", *columns(fields), "} fp3_config;", "",
        *enumeration("KEY", known), "#define FP3_KEY_NONE FP3_KEY_COUNT",
        f"#define FP3_KEYS_SET {len(given(known))} /* the first ones; the others follow from them */", "",
        "/* Of fp3_keys. */",
        *initialisers("FP3_KEY_ROWS", [
            [("name", quote(condition(name, known))), ("lack", quote(key["lack"]) if "lack" in key else "NULL"),
             ("choices", f'{{{", ".join(map(quote, key["choices"]))}}}' if "choices" in key else "{0}"), ("offset", f"offsetof(fp3_config, {name})")] for name, key in known.items()]), "",
        "/* X(name, doc, schedulers of all tiles, lanes of each, what may issue in each at once, space_bit, master) */",
        *x_macro("FP3_CONFIGS", [(row["name"], quote(row["doc"]), str(row["tiles"] * row["schedulers"]),
                                  str(row["lanes"]), str(1 + row["dual"]), str(row["space_bit"]), str(row["master"])) for row in configs]), "",
        "/* Of fp3_configs. */",
        *initialisers("FP3_CONFIG_ROWS", [
            [("name", quote(row["name"])), ("doc", quote(row["doc"])), ("take", quote(row["take"]) if row.get("take") else "NULL")]
            + [(name, config_value(name, row[name])) for name in known] for row in configs])])


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
