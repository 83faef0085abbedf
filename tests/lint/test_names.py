"""FP3's list of files beside a design that uses the usual names itself: no module or macro of ours clashes with another, and none of our macros reaches it."""

import os
import re
import shutil
import subprocess

import pytest

USUAL = ("arbiter adder multiply delay fetch decode regfile counters hub unit tile lane batch cut uart_rx uart_tx crc32 axi_lite fifo cache mux").split()
MACROS = "END RESULT MOVE ACCESS REPORT DRAW DECODED WIDTH".split()
# Of use to others: what they may define for us.
FOR_OTHERS = {"FP3_CHECK", "FP3_ZEROS", "FP3_TOP"}


def sources(root):
    """The files of rtl/ by name, with their text less comments."""
    return {path: re.sub(r"//.*", "", path.read_text()) for path in sorted((root / "rtl").rglob("*.v*"))}


def defined(texts):
    return {name for text in texts.values() for name in re.findall(r"`define\s+(\w+)", text)}


@pytest.mark.smoke
def test_every_module_and_macro_has_the_prefix(root):
    texts = sources(root)
    modules = {path: re.findall(r"^\s*module\s+(\w+)", text, re.M) for path, text in texts.items()}
    assert {path: names for path, names in modules.items() if path.suffix == ".v" and names != [path.stem]} == {}
    assert [path.name for path in texts if path.suffix == ".v" and not re.match(r"fp3(_|\.)", path.name)] == []
    assert sorted(name for name in defined(texts) if not name.startswith("FP3_")) == []
    assert len(modules) > 100 and len(defined(texts)) > 50


def stranger(root, folder):
    """A design whose modules and macros are ours without the prefix, and the usual ones; it is read before our list and behind it."""
    texts = sources(root)
    modules = sorted({*USUAL, *(path.stem.removeprefix("fp3_") for path in texts if path.suffix == ".v" and path.name != "fp3.v" and path.parent.name != "gen")})
    macros = sorted({*MACROS, *(name.removeprefix("FP3_") for name in defined(texts))})
    before, behind = folder / "before.v", folder / "behind.v"
    before.write_text("".join(f"`define {name} {i}\n" for i, name in enumerate(macros)) +
                      "".join(f"module {name} (output wire o); assign o = 1'b1; endmodule\n" for name in modules))
    ours = sorted(defined(texts) - FOR_OTHERS)
    behind.write_text("module stranger;\n" + "".join(f"    wire w_{name}; {name} u_{name} (.o(w_{name}));\n" for name in modules) +
                      "".join(f"    generate if (`{name} != {i}) begin {name}_has_changed u_error (); end endgenerate\n" for i, name in enumerate(macros)) +
                      "".join(f"`ifdef {name}\n    {name}_is_still_defined u_error ();\n`endif\n" for name in ours) +
                      "    fp3 u_fp3 (.s_axi_aclk(1'b0));\nendmodule\n")


@pytest.mark.parametrize("tool", ["icarus", "verilator", "yosys"])
def test_our_list_goes_beside_a_design_with_the_usual_names(root, tmp_path, tool):
    shutil.copytree(root / "rtl", tmp_path / "rtl")        # yosys sees only the directory in which it runs
    stranger(root, tmp_path)
    listed = [line for line in (root / "rtl/gen/files.f").read_text().splitlines() if line.startswith("rtl/")]
    files = ["before.v", *listed, *(f"rtl/{name}/{path.name}" for name in ("board", "video") for path in sorted((root / "rtl" / name).glob("*.v"))), "behind.v"]
    command = {
        "icarus": ["iverilog", "-g2005", "-t", "null", "-Irtl", "-s", "stranger", *files],
        "verilator": ["verilator", "--lint-only", "-Wno-lint", "-Wno-PINMISSING", "+incdir+rtl", "--top-module", "stranger", *files],
        "yosys": [os.environ["FP3_YOSYS"], "-q", "-p", f"read_verilog -Irtl {' '.join(files)}; hierarchy -check -top stranger"],
    }[tool]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=100)
    assert done.returncode == 0, done.stderr[-2000:]
