"""The iCE40 versions in rtl/fpga/ice40 equal the generic modules whose places they take, cycle by cycle."""

import os
import pathlib
import re
import subprocess

import pytest

from bugs import few

MODULES = ("counters", "fp_mul_product", "ram_forward")


def model():
    """yosys's own of the device's multiplier."""
    bin = pathlib.Path(os.environ["FP3_YOSYS"]).resolve().parent.parent
    text = next(bin.glob("**/share/ice40/cells_sim.v")).read_text()
    return re.search(r"^module SB_MAC16 \(.*?^endmodule$", text, re.M | re.S)[0]


def bench(root, tmp_path, broken=None):
    """Build and run ice40_bench.v, perhaps with a bug: (module, right, wrong)."""
    files = [tmp_path / "model.v"]
    files[0].write_text(model())
    for module in MODULES:
        text = (root / f"rtl/fpga/ice40/fp3_{module}.v").read_text()
        if broken and broken[0] == module:
            assert text.count(broken[1]) == 1
            text = text.replace(broken[1], broken[2])
        files.append(tmp_path / f"ice40_{module}.v")
        files[-1].write_text(re.sub(rf"^module fp3_{module}\b", f"module ice40_{module}", text, flags=re.M))
    built = subprocess.run(["iverilog", "-g2012", "-DFP3_CHECK", "-s", "ice40_bench", "-c", "rtl/fp3.f",
                            "-o", tmp_path / "bench.vvp", "tests/fpga/ice40_bench.v", *files],
                           cwd=root, capture_output=True, text=True)
    assert built.returncode == 0, built.stderr
    return subprocess.run(["vvp", "-n", tmp_path / "bench.vvp"], capture_output=True, text=True).stdout


def test_equal(root, tmp_path):
    said = bench(root, tmp_path)
    assert said == "PASS: 5000 cycles, 0 errors\n"


BUGS = {
    "tiles exchanged": ("fp_mul_product", "i[1] ? bh : bl", "i[0] ? bh : bl"),
    "no register at the inputs": ("fp_mul_product", ".A_REG(CUTS[0])", ".A_REG(1'b0)"),
    "no register at the product": ("fp_mul_product", ".PIPELINE_16x16_MULT_REG2(CUTS[1])", ".PIPELINE_16x16_MULT_REG2(1'b0)"),
    "a write is not forwarded": ("ram_forward", "write_i && write_addr_i == read_addr_i", "1'b0"),
    "a waiting carry is not shown": ("counters", "one_q  <= waits[at]", "one_q  <= waits[at] && !read_i"),
    "a carry is added twice": ("counters", "(wait_q & ~added) | carry", "wait_q | carry"),
    "a clear forgets the memory": ("counters", "fresh_q <= clear_i ? {N{1'b1}} : fresh_q & ~added", "fresh_q <= clear_i ? {N{1'b0}} : fresh_q & ~added"),
    "a clear meets an addition": ("counters", "own_q  <= !read_i && !clear_i", "own_q  <= !read_i"),
    "the turn of a word is lost": ("counters", "one_q && !read_i && !clear_i", "one_q && !read_i && !clear_i && at_q != 3'd6"),
}


@pytest.mark.parametrize("bug", few(((bug, bug) for bug in BUGS), lambda row: BUGS[row[0]][0]))
def test_finds(root, tmp_path, bug):
    said = bench(root, tmp_path, BUGS[bug])
    assert "FAIL" in said or "a carry is lost" in said, said
