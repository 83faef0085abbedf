"""Headers for the RTL, and a top module for each configuration."""

import re

from .configs import MASK_BITS, given
from .estimates import estimates
from .isa import code_bits
from .logarithms import CURVE_BITS, SUM_BITS, curves, packed, sums
from .registers import address_rows, counter_rows, field_rows, stream_mask
from .text import MARK, columns


def verilog_header(source, sections):
    """Localparams, to be included inside a module."""
    out = [f"// {MARK.format(source=source)}",
           "// Included inside a module, which uses the names that it needs; hence the lint_off.",
           "// verilator lint_off UNUSEDPARAM"]
    for title, rows in sections:
        out += ["", f"// {title}"]
        out += columns([(f"localparam {kind}{name} ", f"= {value};") for kind, name, value in rows])
    return out + ["", "// verilator lint_on UNUSEDPARAM"]


def isa_verilog(isa):
    bits = code_bits(isa)
    return verilog_header("isa/isa.toml", [
        ("The revision that register `id` shows.",
         [("[7:0] ", "ISA_REVISION", f"8'd{isa['revision']}")]),
        ("Fields of the 32-bit word.",
         [("", f"{name.upper()}_{end}", pair[i]) for name, pair in isa["field"].items()
          for i, end in enumerate(("HI", "LO"))]),
        ("Banks, as an operand names them.",
         [("", f"BANK_{name.upper()}_{key.upper()}", bank[key]) for name, bank in isa["bank"].items()
          for key in ("base", "count")]),
        ("Bits of numbers.",
         [("[31:0] ", f"BITS_{name.upper()}", f"32'h{value:08x}") for name, value in isa["bits"].items()]),
        ("Codes of instructions, and the bits of one.",
         [("", "CODE_W", bits)] + [(f"[{bits - 1}:0] ", f"OP_{op['name'].upper()}", f"{bits}'d{op['code']}") for op in isa["op"]]),
    ])


def mnemonic_verilog(isa):
    """For benches: an opcode as text, padded with blanks."""
    bits, width = code_bits(isa), max(len(op["name"]) for op in isa["op"])
    rows = [(f"        {bits}'d{op['code']}: ", f'mnemonic = "{op["name"]:<{width}}";') for op in isa["op"]]
    rows.append(("        default: ", f'mnemonic = "{"?":<{width}}";'))
    return [f"// {MARK.format(source='isa/isa.toml')}", "// Included inside a module.",
            f"function [8*{width}-1:0] mnemonic(input [{bits - 1}:0] code);",
            "    case (code)", *columns(rows), "    endcase", "endfunction"]


def estimates_verilog():
    def line(values):
        return "    " + ", ".join(f"9'h{value:03x}" for value in values)

    table = estimates()[::-1]
    return [f"// {MARK.format(source='estimates() there')}",
            "// Included inside a module. Word i is ESTIMATES[9*i +: 9].",
            "localparam [9*2048-1:0] ESTIMATES = {",
            ",\n".join(line(table[i:i + 12]) for i in range(0, 2048, 12)), "};"]


def logarithms_verilog(words, bits, *names):
    """Equal parts of the words, each a parameter."""
    width, digits, each = sum(bits), -(-sum(bits) // 4), len(words) // len(names)
    out = [f"// {MARK.format(source='logarithms.py there')}",
           f"// Included inside a module, which uses what it needs; hence the lint_off. Word i is NAME[{width}*i +: {width}].",
           "// verilator lint_off UNUSEDPARAM"]
    for part, name in enumerate(names):
        table = [f"{width}'h{word:0{digits}x}" for word in packed(words[each * part:each * (part + 1)], bits)][::-1]
        out += [f"localparam [{width}*{each}-1:0] {name} = {{",
                ",\n".join("    " + ", ".join(table[i:i + 6]) for i in range(0, each, 6)), "};"]
    return out + ["// verilator lint_on UNUSEDPARAM"]


def sums_verilog():
    return logarithms_verilog(sums(), SUM_BITS, "SUMS", "DIFFERENCES")


def curves_verilog():
    return logarithms_verilog(curves(), CURVE_BITS, "LOGS", "POWERS")


def registers_verilog(regs):
    def at(address):
        return f"16'h{address:04x}"

    return verilog_header("isa/registers.toml", [
        ("Registers.", [("[15:0] ", f"ADDR_{row['name'].upper()}", at(row["at"]))
                        for row in regs["register"] + regs["transfer"]]),
        ("Fields of registers, but for those that show keys: gen/host_map.vh has these.",
         [("", name, value) for name, value in field_rows({**regs, "register": [row for row in regs["register"] if "shows" not in row]})]),
        ("Counters: 64 bits in two words each.",
         [("", "COUNTER_COUNT", len(regs["counter"])), ("", "COUNTER_W", max(4, (len(regs["counter"]) - 1).bit_length())), ("[15:0] ", "ADDR_COUNTERS", at(regs["counters"]["at"]))]
         + [("[15:0] ", f"ADDR_COUNTER_{row['name'].upper()}", at(a)) for row, a in counter_rows(regs)]),
        ("Windows onto the memories.", [("[15:0] ", f"ADDR_WINDOW_{row['name'].upper()}", at(row["at"]))
                                        for row in regs["window"]]),
        ("The parts of an address, and what they say: a space begins at SPACE_BIT.",
         [("", name, value) for name, value in address_rows(regs)]),
        ("In space 0 an address streams if it has one of these bits: accesses there follow each other, any other one is alone.",
         [("[15:0] ", "ADDRESS_STREAM", at(stream_mask(regs)))]),
    ])


def channel(name, widths):
    """A channel of AXI4 that the processor is the master of."""
    reads = name in ("r", "b")
    rows = [("input" if reads else "output", width, f"m_axi_{name}{signal}") for signal, width in widths.items()]
    return [*rows, (rows[0][0], 1, f"m_axi_{name}valid"), ("output" if reads else "input", 1, f"m_axi_{name}ready")]


def memory_ports():
    """What a configuration with `master` has beside the bus of its host."""
    address = {"id": 1, "addr": 32, "len": 8, "size": 3, "burst": 2, "lock": 1, "cache": 4, "prot": 3}
    return [
        *channel("aw", address), *channel("w", {"data": 32, "strb": 4, "last": 1}), *channel("b", {"id": 1, "resp": 2}), None,
        *channel("ar", address), *channel("r", {"id": 1, "data": 32, "resp": 2, "last": 1}), None]


def ports(row, regs):
    """The bus of a configuration: direction, width, name; None is a blank line."""
    schedulers = row["tiles"] * row["schedulers"]
    address = row["space_bit"] + regs["address"]["space"] + (schedulers.bit_length() if schedulers > 1 else 0)
    return [("input", 1, "s_axi_aclk"), ("input", 1, "s_axi_aresetn"), None,
            ("input", address, "s_axi_awaddr"), ("input", 3, "s_axi_awprot"), ("input", 1, "s_axi_awvalid"),
            ("output", 1, "s_axi_awready"), ("input", 32, "s_axi_wdata"), ("input", 4, "s_axi_wstrb"),
            ("input", 1, "s_axi_wvalid"), ("output", 1, "s_axi_wready"), ("output", 2, "s_axi_bresp"),
            ("output", 1, "s_axi_bvalid"), ("input", 1, "s_axi_bready"), None,
            ("input", address, "s_axi_araddr"), ("input", 3, "s_axi_arprot"), ("input", 1, "s_axi_arvalid"),
            ("output", 1, "s_axi_arready"), ("output", 32, "s_axi_rdata"), ("output", 2, "s_axi_rresp"),
            ("output", 1, "s_axi_rvalid"), ("input", 1, "s_axi_rready"), None,
            *(memory_ports() if row["master"] else []), ("output", 1, "irq")]


def trace(row):
    """The ports that a top has with FP3_TRACE, likewise: one part for each scheduler (issue) and for each lane (retire), the first in
    the low bits; with `dual` two, that of sums and that of products."""
    issues = row["tiles"] * row["schedulers"] * (1 + row["dual"])
    lanes = issues * row["lanes"]
    return [("output", issues, "issue_valid_o"), ("output", 16 * issues, "issue_pc_o"),
            ("output", 16 * issues, "issue_context_o"), ("output", 32 * issues, "issue_word_o"), None,
            ("output", 2 * lanes, "retire_end_o"), ("output", lanes, "retire_valid_o"), ("output", 16 * lanes, "retire_context_o"),
            ("output", 32 * lanes, "retire_object_o"), ("output", 6 * lanes, "retire_register_o"),
            ("output", 32 * lanes, "retire_value_o"), ("output", 5 * lanes, "retire_flags_o")]


def configs_verilog(configs):
    """The cuts of the configurations, each pair once, for the bench of the cores."""
    pairs = list(dict.fromkeys((row["add_cuts"], row["mul_cuts"]) for row in configs))

    def packed(masks):
        return "{" + ", ".join(f"{MASK_BITS}'h{mask:02x}" for mask in reversed(masks)) + "}"

    width = f"[{MASK_BITS * len(pairs) - 1}:0] "
    return verilog_header("isa/configs.toml", [
        ("Cuts of the named configurations, in the order of isa/configs.toml, each pair once; the first is in the low bits.",
         [("", "CUT_PAIRS", len(pairs)), (width, "ADD_CUTS", packed([add for add, _ in pairs])),
          (width, "MUL_CUTS", packed([mul for _, mul in pairs]))])])


def attributes(root, row):
    """The lines of attributes before a port of rtl/fp3.v, by the port's name; with `master` the clock is that of a second bus."""
    text = (root / "rtl/fp3.v").read_text(encoding="utf-8")
    if row["master"]:
        text = text.replace("ASSOCIATED_BUSIF s_axi,", "ASSOCIATED_BUSIF s_axi:m_axi,")
    return {port: lines for lines, port in re.findall(r"^((?: *\(\*.*\*\)\n)+) *(?:in|out)put +wire +(\w+),$", text, re.M)}


def signals(root, row):
    """What these attributes say: by port, the kind of signal, its name there, and its parameters."""
    found = {}
    for port, lines in attributes(root, row).items():
        kind, logical = re.search(r'"xilinx\.com:signal:(\w+):1\.0 \w+ (\w+)"', lines).groups()
        parameters = re.search(r'"XIL_INTERFACENAME \w+, (.*)"', lines)[1]
        found[port] = kind, logical, dict(pair.split(" ") for pair in parameters.split(", "))
    return found


def config_verilog(row, machine, root):
    """The top module of a configuration."""
    before = attributes(root, row)

    def list_of(line):
        def listed(rows):
            return ["" if port is None else line(*port) + ("," if i < len(rows) - 1 else "") for i, port in enumerate(rows)]
        return [*listed(ports(row, machine.registers)), "`ifdef FP3_TRACE", "    ,", *listed(trace(row)), "`endif"]

    def declare(direction, width, name):
        size = f"[{width - 1}:0]" if width > 1 else ""
        return f"{before.get(name, '')}    {direction:<6} wire {size:>8} {name}"

    def value(key):
        bits = f"{MASK_BITS}'h"
        return f"{bits}{row[key]:02x}" if key.endswith("_cuts") else str(row[key])

    # What fp3 hears of memory, where there is none.
    tied = [] if row["master"] else [f"        .{port[2]:<17} ({port[1]}'d0)," for port in memory_ports() if port and port[0] == "input"]
    return [f"// fp3_{row['name']}: {row['doc']}", "//", f"// {MARK.format(source='isa/configs.toml')}",
            "`default_nettype none",
            f"module fp3_{row['name']} (", *list_of(declare), ");",
            "    // verilator lint_off PINMISSING", "    fp3 #(",
            ",\n".join(f"        .{key.upper():<15} ({value(key)})" for key in given(machine.keys)),
            "    ) u_fp3 (", *tied, *list_of(lambda d, w, name: f"        .{name:<17} ({name})"),
            "    );", "    // verilator lint_on PINMISSING", "endmodule", "`default_nettype wire"]
