"""The ECP5 versions in rtl/fpga/ecp5, and those in rtl/fpga/wide, equal the generic modules whose places they take, cycle by cycle."""

import re
import subprocess

import pytest

from bugs import few

BENCHES = {"ecp5_bench": ("fp_mul_product", "multiply", "mux4", "ram_registered", "wide"), "ecp5_tables_bench": ("multiply", "rom_registered")}


def place(module):
    return ("wide", "fp3_fp_mul_product") if module == "wide" else ("ecp5", f"fp3_{module}")


def run(root, tmp_path, name, broken=None):
    """Build and run a bench, perhaps with a bug: (module, right, wrong)."""
    files = []
    for module in BENCHES[name]:
        family, module = place(module)
        text = (root / f"rtl/fpga/{family}/{module}.v").read_text()
        if broken and place(broken[0]) == (family, module):
            assert text.count(broken[1]) == 1
            text = text.replace(broken[1], broken[2])
        files.append(tmp_path / f"{family}_{module}.v")
        files[-1].write_text(re.sub(rf"^(module|    +(?=(?:fp3_multiply|{module}) #)) *fp3_({module[4:]}|multiply)\b", rf"\1 {family}_\2", text, flags=re.M))
    built = subprocess.run(["iverilog", "-g2012", "-Wall", "-Wno-timescale", "-s", name, "-c", "rtl/fp3.f",
                            "-o", tmp_path / "bench.vvp", f"tests/fpga/{name}.v", "tests/fpga/ecp5_primitives.v",
                            *files], cwd=root, capture_output=True, text=True)
    assert built.returncode == 0 and not built.stderr, built.stderr
    return subprocess.run(["vvp", "-n", tmp_path / "bench.vvp"], capture_output=True, text=True).stdout


@pytest.mark.parametrize("name", BENCHES)
def test_equal(root, tmp_path, name):
    assert re.fullmatch(r"PASS: \d000 cycles, 0 errors\n", run(root, tmp_path, name))


BUGS = {
    "row twice": ("fp_mul_product", "rows_c[23:16], 4'b0000}", "rows_c[15:8], 4'b0000}"),
    "carry where there is none": ("fp_mul_product", "16'h7888", "16'h788e"),
    "middle sum loses its carry": ("fp_mul_product", "{1'b0, lh[FRAC:0]} + {1'b0, hl[FRAC:0]}",
                                   "{1'b0, lh[FRAC:0] + hl[FRAC:0]}"),
    "no register at the output": ("multiply", 'OUT = CUTS[1] ? "CLK0"', 'OUT = 1\'b0 ? "CLK0"'),
    "no register at a product's operands": ("multiply", 'IN = CUTS[0] ? "CLK0"', 'IN = 1\'b0 ? "CLK0"'),
    "a signed product is none": ("multiply", "IS_SIGNED = SIGNED != 0", "IS_SIGNED = 1'b0"),
    "halves of a table's word exchanged": ("rom_registered", "{out_b, out_a}", "{out_a, out_b}"),
    "a table's blocks are equal": ("rom_registered", "WIDE * block + ", ""),
    "words of a choice exchanged": ("mux4", ".A(d2_i[i]), .B(d3_i[i])", ".A(d3_i[i]), .B(d2_i[i])"),
    "late bit of a choice inverted": ("mux4", ".ALUT(high), .BLUT(low)", ".ALUT(low), .BLUT(high)"),
    "halves of a word exchanged": ("ram_registered", "{out_b, out_a}", "{out_a, out_b}"),
    "a byte is not written": ("ram_registered", "ADDR_W == 10 ? 3", "ADDR_W == 10 ? 1"),
    "words above the first 16384 are those below": ("ram_registered", "upper_q[1] ? high : low", "low"),
    "which half of a large memory is known too early": ("ram_registered", "upper_q[1] ? high : low", "upper_q[0] ? high : low"),
    "a wide product is late": ("wide", ".ON(CUTS[1])", ".ON(1)"),
    "no register behind the memory": ("ram_registered", '.REGMODE_A("OUTREG"), .REGMODE_B("OUTREG")',
                                      '.REGMODE_A("NOREG"), .REGMODE_B("NOREG")'),
}


@pytest.mark.parametrize("bug", few(((bug, bug) for bug in BUGS), lambda row: BUGS[row[0]][0]))
def test_finds(root, tmp_path, bug):
    name = next(name for name, modules in reversed(BENCHES.items()) if BUGS[bug][0] in modules)
    said = run(root, tmp_path, name, BUGS[bug])
    assert "FAIL" in said, said
