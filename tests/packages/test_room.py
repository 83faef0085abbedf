"""There is room for the next setting, key, counter and instruction, and each is a row of a table: in a copy of the tree rows are
added, everything generated anew, and the processor asked under Icarus."""

import json
import os
import re
import shutil
import subprocess
import sys

import pytest

import simulate

WORD = 0x12345


def replace(path, *pairs):
    text = path.read_text()
    for old, new in pairs:
        assert text.count(old) == 1, f"{path} has {text.count(old)} of {old!r}"
        text = text.replace(old, new)
    path.write_text(text)


@pytest.fixture
def copy(root, tmp_path):
    """What the generator reads and writes, and the bench."""
    for name in ("isa", "tools", "rtl", "sim", "sw/gen", "sw/include", "docs", "programs/integrators"):
        shutil.copytree(root / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(root / "fp3.core", tmp_path)
    return tmp_path


def changed(root, copy):
    """The files that differ or are new, without those that are generated."""
    names = {path.relative_to(copy) for path in copy.rglob("*") if path.is_file() and path.suffix in (".v", ".vh", ".toml")}
    return {str(name) for name in names if not {"gen", "build"} & set(name.parts)
            and not ((root / name).exists() and (copy / name).read_bytes() == (root / name).read_bytes())}


def run(copy, config, session):
    """What a session says, in a copy whose tables have changed."""
    done = subprocess.run([sys.executable, copy / "tools/generate.py"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    made = subprocess.run([sys.executable, copy / "tools/tops.py", config], capture_output=True, text=True, timeout=60)
    assert made.returncode == 0, made.stderr
    subprocess.run(["iverilog", "-g2012", "-Wno-timescale", "-DFP3_CHECK", *simulate.shape(config), "-s", "replay", "-c", "rtl/fp3.f", "-o", "room.vvp",
                    "sim/replay.v", f"build/rtl/fp3_{config}.v"], cwd=copy, check=True, timeout=60)
    (copy / "room.session").write_text("".join(line + "\n" for line in [*session, f"e {len(session):x} 0"]))
    done = subprocess.run(["vvp", "-n", copy / "room.vvp", f"+session={copy / 'room.session'}"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout
    return done.stdout


def shown(said):
    return [word if word == "error" else int(word, 16) for _, word in re.findall(r"^([0-9a-f]{8}) (error|[0-9a-f]{8})$", said, re.M)]


SETTING = """
[[register]]
name = "margin"
at = 0x0078
access = "rw"
{more}range = [2, 9]
reset = 5
doc = "A setting."

# Counters of"""


@pytest.mark.parametrize("config, more", [("single", ""), ("many", ""), ("lanes", 'needs = ["store_words"]\n'), ("dual", "")])
def test_a_setting_is_a_row_and_the_module_that_uses_it(root, copy, config, more):
    replace(copy / "isa/registers.toml", ("\n# Counters of", SETTING.format(more=more)))
    replace(copy / "rtl/front/fp3_fetch.v", ("    assign valid_o = valid_2q;\n",
                                         "    assign valid_o = valid_2q;\n    always @(posedge clk_i) if (start_i) $display(\"margin %0d\", setting_margin);\n"))
    store = config != "single"
    program = ["w 8000 38200000", "w 8004 48200000"] if store else ["w 8000 08200080"]                       # ld, st; add
    objects = ["w 3000 1"] if config in ("lanes", "dual") else ["w 3100 0"] if store else []
    said = run(copy, config, ["s 78 0", "w 78 9", "s 78 0", *program, *objects, "w 20 1", "w 24 0", "w 28 1", f"w 2c {len(program)}",
                              "w 10 1", "p 14 1", "s 14 0"])
    assert shown(said) == [5, 9, 2] and "margin 7" in said                 # a bundle has it less its least
    assert changed(root, copy) == {"isa/registers.toml", "rtl/front/fp3_fetch.v"}


@pytest.mark.parametrize("value", [1, 10, 0x80000005, 0x15])
def test_a_setting_out_of_its_range_is_refused(copy, value):
    replace(copy / "isa/registers.toml", ("\n# Counters of", SETTING.format(more="")))
    with pytest.raises(AssertionError, match="FAIL"):
        run(copy, "single", [f"w 78 {value:x}"])


def test_a_setting_that_needs_a_store_is_not_there_without(copy):
    replace(copy / "isa/registers.toml", ("\n# Counters of", SETTING.format(more='needs = ["store_words"]\n')))
    assert shown(run(copy, "single", ["s 78 0"])) == ["error"]


KEY = """[key.extra]
range    = [0, 15]
default  = 0
feature  = [55, 52]
meaning  = "a key of the second word"

[key.add_latency]"""


@pytest.mark.parametrize("value", [0, 9])
def test_features_go_on_in_a_second_word(root, copy, value):
    replace(copy / "isa/configs.toml", ("[key.add_latency]", KEY), ('name = "single"\n', f'name = "single"\nextra = {value}\n'))
    features, more = shown(run(copy, "single", ["s c 0", "s 48 0"]))
    assert features == 0x0402021b | (value != 0) << 7 and more == value << 20
    assert changed(root, copy) == {"isa/configs.toml"}
    # The map of SystemRDL has them, and the software expects these words.
    done = subprocess.run([root / ".venv/bin/python", root / "tests/packages/read_map.py", "rdl", copy / "rtl/gen/fp3.rdl", "fp3_single"],
                          capture_output=True, text=True, timeout=120)
    fields = {name: {field[0]: field[4] for field in fields} for name, _, fields in json.loads(done.stdout)["fp3_single"]["registers"]}
    assert fields["0.features_more"] == {"neighbours": 0, "exchange": 0, "finite": 0, "fused": 0, "logarithmic": 0, "fraction": 0, "storage": 0, "mixed": 0,
                                         "counters": 0, "master": 0, "keep": 0, "overlap": 0, "extra": value}
    assert fields["0.features"]["more"] == (value != 0)
    (copy / "words.c").write_text('#include "machine/config.h"\n#include "gen/registers.h"\n#include <stdio.h>\n#include <string.h>\n'
                                  "const fp3_config c[] = {FP3_CONFIG_ROWS};\n"
                                  'int main(void) { int i = 0; while (strcmp(c[i].name, "single")) i++;\n'
                                  '#define X(NAME, word) printf("%x ", (unsigned)(word));\nFP3_SHOWN(X, &c[i]) return 0; }\n')
    shutil.copytree(root / "sw/machine", copy / "sw/machine")
    shutil.copytree(root / "sw/base", copy / "sw/base")
    subprocess.run(["gcc", "-std=c11", "-Wno-unused", f"-I{copy}/sw", f"-I{copy}/sw/include", "words.c", "-o", "words"], cwd=copy, check=True)
    words = [int(word, 16) for word in subprocess.run([copy / "words"], capture_output=True, text=True, check=True).stdout.split()]
    assert words[-1] == value << 20 and (words[-4] >> 7 & 1) == (value != 0)


OWN = """[key.own]
range    = [0, 1]
default  = 0
needs    = ["chain", "store_words"]
excludes = ["select"]
feature  = [49, 49]
meaning  = "an arithmetic of its own"

[key.add_latency]"""
UNIT = """`default_nettype none
`include "unit/socket.vh"
module fp3_own_arith #(
`include "config/config.vh"
) (
    input  wire                   clk_i,
    input  wire [`FP3_OPERANDS_W-1:0] operands_i,
    output wire [`FP3_RESULT_W-1:0]   result_o
);
    `FP3_OPERANDS_FIELDS
    assign `FP3_OPERANDS = operands_i;
    fp3_delay #(.W(37), .N(UNIT_LATENCY)) u_result (.clk_i(clk_i), .rst_i(1'b0), .d_i({5'd0, operands_x ^ operands_y}), .q_o(result_o));
endmodule
`default_nettype wire
"""


def test_an_arithmetic_is_a_key_a_module_and_its_line(root, copy):
    """What it needs and excludes stands in the key's table; the module here gives x ^ y."""
    (copy / "rtl/unit/fp3_own_arith.v").write_text(UNIT)
    replace(copy / "isa/configs.toml", ("[key.add_latency]", OWN), ('name = "many"\n', 'name = "many"\nown = 1\n'))
    replace(copy / "rtl/unit/fp3_unit.v", ("        if (FUSED != 0) begin : g_fused", """        if (OWN != 0) begin : g_own
            fp3_own_arith #(.CONFIG(CONFIG)) u_arith (.clk_i(clk_i), .operands_i(operands_i), .result_o(result_o));
        end else if (FUSED != 0) begin : g_fused"""))
    madd = 4 << 27 | 1 << 21 | 64 << 14 | 1 << 7 | 1                                                      # r1 = r1 + k0 * r1
    said = run(copy, "many", ["w 2000 3", "w 20004 5", "w 3100 0", "w 8000 38200000", f"w 8004 {madd:x}", "w 8008 48200000", "w 20 1", "w 24 1",
                              "w 28 2", "w 2c 3", "w 10 1", "p 14 1", "s 14 0", "s 20004 0"])
    assert shown(said) == [2, 3 ^ 5]
    assert changed(root, copy) == {"isa/configs.toml", "rtl/unit/fp3_unit.v", "rtl/unit/fp3_own_arith.v"}
    parameters = [f"-Pfp3.{text}=1" for text in ("OWN", "SELECT")]
    done = subprocess.run(["iverilog", "-g2005", "-t", "null", "-c", "rtl/fp3.f", "-s", "fp3", *parameters, "rtl/fp3.v"], cwd=copy, capture_output=True, text=True)
    assert done.returncode != 0 and "OWN_excludes_SELECT" in done.stderr
    replace(copy / "isa/configs.toml", ("own = 1\n", "own = 1\nselect = 1\n"))
    done = subprocess.run([sys.executable, copy / "tools/generate.py"], capture_output=True, text=True, timeout=60)
    assert done.returncode != 0 and "config 'many': own = 1 needs select = 0" in done.stderr


COUNTERS = "".join(f'[[counter]]\nname = "spare_{i}"\ndoc = "Never."\n' for i in range(20))


@pytest.mark.parametrize("config", ["single", "small"])
def test_there_may_be_more_than_sixteen_counters(copy, config):
    """The counter of cycles comes after twenty others, and counts what it counts where it is the first."""
    session = ["w 8000 08200080", "w 20 7", "w 24 0", "w 28 1", "w 2c 1", "w 10 1", "p 14 1", "s 80 0", "s 88 0", "s b0 0"]
    cycles, adds, retired = shown(run(copy, config, session))
    assert adds == retired == 7 < cycles
    replace(copy / "isa/registers.toml", ('[[counter]]\nname = "cycles"\n', COUNTERS + '[[counter]]\nname = "cycles"\n'))
    for name in ("solo/fp3_solo.v",):
        spare = ", ".join(f"event_spare_{i}" for i in range(20))
        replace(copy / "rtl" / name, ("    assign event_cycles           = running_q;\n", f"    assign event_cycles           = running_q;\n    assign {{{spare}}} = 20'd0;\n"))
    said = shown(run(copy, config, [*session[:-3], *(f"s {at:x} 0" for at in range(0x80, 0x80 + 8 * 34 + 16, 4))]))
    assert said[0:40] == [0] * 40 and said[40] == cycles and said[42] == adds and said[52] == retired
    assert "error" not in said[:68] and said[68:] == ["error"] * 4


OP = """
[[op]]
name     = "plus"
code     = {code}
operands = ["d", "a", "b"]
path     = ["adder"]
raises   = ["invalid", "overflow", "underflow", "inexact"]
meaning  = "d = a + b"
"""


@pytest.mark.parametrize("code", [148, 149, 255])
def test_an_instruction_may_have_its_code_in_field_c(root, copy, code):
    with open(copy / "isa/isa.toml", "a", encoding="utf-8") as file:
        file.write(OP.format(code=code))
    replace(copy / "rtl/front/fp3_decode.v", ("plain_add   = op == OP_ADD ||", "plain_add   = op == OP_ADD || op == OP_PLUS ||"))
    one = 0x3f800000
    word = 31 << 27 | 1 << 21 | 64 << 14 | 65 << 7 | code - 128                                           # r1 = k0 + k1
    session = [f"w 2000 {one:x}", f"w 2004 {one:x}", "w 20 1", "w 24 0", "w 28 1", "w 2c 1"]
    start = ["w 10 1", "p 14 1", "s 14 0", "s 20004 0", "w 20004 0"]
    said = shown(run(copy, "single", [*session, f"w 8000 {word:x}", *start, f"w 8000 {word ^ 1:x}", *start,
                                      f"w 8000 {0x08000000 | word & 0x07ffff80:x}", *start]))
    assert said == [2, 0x40000000, 4, 0, 2, 0x40000000]                    # done; the next code is illegal; an add is what it was
    assert f"0x{word & ~0x07ffff80 | 2 << 21 | 65 << 7:08x}" in (copy / "docs/isa.md").read_text()         # its example there
    (copy / "code.c").write_text('#include "machine/operation.h"\n#include <stdio.h>\n#include <stdlib.h>\n'
                                 "int main(int n, char **v) { fp3_instruction i; (void)n; if (fp3_word_decode((uint32_t)strtoul(v[1], 0, 16), &i, NULL)) return 1;\n"
                                 'printf("%u %u %u %u %u %x", i.op, i.d, i.a, i.b, i.c, (unsigned)fp3_word_encode(&i)); return 0; }\n')
    for room in ("machine", "base"):
        shutil.copytree(root / "sw" / room, copy / "sw" / room)
    sources = [copy / "sw/machine/operation.c", copy / "sw/machine/config.c", *sorted((copy / "sw/base").glob("status.c"))]
    subprocess.run(["gcc", "-std=c11", "-D_GNU_SOURCE", f"-I{copy}/sw", f"-I{copy}/sw/include", "code.c", *sources, "-o", "code", "-lm"],
                   cwd=copy, check=True, env=os.environ)
    assert subprocess.run([copy / "code", f"{word:x}"], capture_output=True, text=True).stdout == f"{code} 1 64 65 0 {word:x}"
    assert subprocess.run([copy / "code", f"{word ^ 1:x}"]).returncode == 1
