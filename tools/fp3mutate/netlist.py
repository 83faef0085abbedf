"""A module and what it contains as a netlist with mutants in it: yosys elaborates it, makes them and writes it again.

A simulator compiles the netlist once. Which mutant is active, the file `mutant` says in the folder where the simulator runs: 0 is none of them.
"""

import random
import re
import subprocess
from pathlib import Path
from typing import NamedTuple

# As in tests/formal/netlist.py; an undefined bit becomes an input without a name.
MAP = ("setattr -mod -unset keep_hierarchy *; flatten -noscopeinfo; expose -evert t:*fp3_*; memory_map; opt -full -nodffe -nosdff; "
       "setattr -unset init; dffunmap; techmap; opt_expr; opt_clean; setundef -anyseq; aigmap; opt_clean")
# What a memory is given becomes an output of the circuit, what it gives an input: where all it is given is the same, so is what it gives.
MEMORIES = ("ram_1r1w", "lutram_1r1w", "ram_registered", "rom_registered")
# A clock that stands still is no mutant of logic: where it is made by a mutant, it comes later than the other clocks, too.
CLOCKS = {"CLK", "clk_i", "RD_CLK", "WR_CLK", "s_axi_aclk"}


class Failed(Exception):
    """A tool said no."""


class Mutant(NamedTuple):
    """One change of a netlist. number: what the file `mutant` must say."""
    number: int
    module: str                          # of rtl/, without fp3_
    line: str                            # the command of yosys that makes it, without its number

    def field(self, name):
        found = re.findall(rf"-{name} (\S+)", self.line)
        return found[-1] if found else ""

    @property
    def place(self):
        """The cell, its port and bit."""
        return f"{self.field('cell')}.{self.field('port')}[{self.field('portbit') or 0}]"

    @property
    def source(self):
        """File and line."""
        return re.sub(r":(\d+)\.\d+-[\d.]+$", r":\1", self.field("src"))

    def row(self):
        return {"mutant": self.number, "mode": self.field("mode"), "place": self.place, "wire": self.field("wire"), "source": self.source}


def said(path, script, folder):
    """Runs yosys. YoWASP's sees the folder where it starts and those below it."""
    done = subprocess.run([path, "-q", "-p", script], cwd=folder, capture_output=True, text=True)
    if done.returncode:
        raise Failed("yosys failed: " + " ".join((done.stderr or done.stdout).split())[-800:])


def modules_of(name):
    """All forms of a module, as yosys selects them."""
    return f"A:hdlname=fp3_{name} A:hdlname=\\fp3_{name}"


def zeros(memory):
    return (f"{memory[0]}  initial begin : zeros_{memory.start()}\n    integer at;\n"
            f"    for (at = 0; at <= {memory[2]}; at = at + 1) {memory[1]} [at] = 0;\n  end\n")


class Design:
    """A top with parameters. `read` are more sources and options for yosys, `modules` those that get mutants."""

    def __init__(self, yosys, root, folder, top, parameters, modules, read=""):
        self.yosys, self.root, self.folder, self.top, self.modules = yosys, root, folder, top, modules
        self.parameters, self.read = parameters, read
        self.mutants = []

    def path(self, name):
        """As yosys sees it from the root."""
        return (self.folder / name).relative_to(self.root)

    def sources(self):
        return " ".join(str(path.relative_to(self.root)) for path in sorted(self.root.glob("rtl/**/*.v")) if "fpga" not in path.parts)

    def elaborate(self):
        sources = f"{self.sources()} {self.read}"
        chosen = " ".join(f"-chparam {name} {value}" for name, value in self.parameters.items())
        said(self.yosys, f"read_verilog -defer -DFP3_TRACE -I rtl -I rtl/gen {sources}; "
             f"hierarchy -check -top {self.top} {chosen}; rename -top {self.top}; "
             f"chformal -remove; delete t:$print t:$check; proc; opt; memory_collect; opt_clean; write_rtlil {self.path('design.il')}", self.root)

    def choose(self, seed, count):
        """`count` mutants of each module, by chance; fewer, where there are fewer."""
        lists = {name: self.folder / f"{name}.list" for name in self.modules}
        script = "".join(f"; mutate -list {2 * count + 20} -seed {seed % 2**31} -o {self.path(path.name)} {modules_of(name)} fp3_{name}"
                         for name, path in lists.items())
        said(self.yosys, f"read_rtlil {self.path('design.il')}{script}", self.root)
        for name, path in lists.items():
            found = [line.removeprefix("mutate ").strip() for line in path.read_text().splitlines()]
            found = sorted({line for line in found if not CLOCKS & {*re.findall(r"-(?:port|wire) \\?(\S+)", line)}})
            if not found:
                raise Failed(f"{self.top}: nothing to change in {name}, or it is not in there")
            random.Random(seed).shuffle(found)
            self.mutants += [Mutant(len(self.mutants) + 1 + i, name, line) for i, line in enumerate(found[:count])]
        return self.mutants

    def width(self):
        return max(1, len(self.mutants).bit_length())

    def write_script(self):
        (self.folder / "mutants.ys").write_text("".join(f"mutate -ctrl mutant {self.width()} {mutant.number} {mutant.line}\n" for mutant in self.mutants))

    def apply(self):
        """Writes netlist.v with all mutants in it."""
        self.write_script()
        said(self.yosys, f"read_rtlil {self.path('design.il')}; script {self.path('mutants.ys')}; opt_clean; "
             f"write_verilog -noattr {self.path('written.v')}; write_rtlil {self.path('mutants.il')}", self.root)
        self.write("netlist.v")

    def write(self, name, constants=""):
        """The top takes the number of the active mutant from a file, and has the constants that a bench asks for."""
        # As FP3_ZEROS does, of which yosys would make a cell for each word. A table has its own.
        text = re.sub(r"(?m)^  reg (?:\[\d+:0\] )?(\S+) +\[(\d+):0\];\n(?!  initial)", zeros, (self.folder / "written.v").read_text())
        if self.mutants:
            head, tail = re.split(rf"(?m)(?=^module {self.top}\()", text)
            width = self.width()
            tail = re.sub(r",\s*mutant\s*\);", ");", tail, count=1)
            read = f"  reg [{width-1}:0] fp3_mutant [0:0];\n  initial $readmemh(\"mutant\", fp3_mutant);\n"
            tail, made = re.subn(r"  input (\[\d+:0\] )?mutant;\n", lambda _: read, tail, count=1)
            tail, wired = re.subn(r"  wire (\[\d+:0\] )?mutant;\n", f"  wire [{width-1}:0] mutant = fp3_mutant[0];\n", tail, count=1)
            if not made or not wired:
                raise Failed(f"{self.top}: yosys gave it no input `mutant`")
            text = head + tail
        at = re.search(rf"(?m)^module {self.top}\([^;]*;\n", text)
        text = text[:at.end()] + constants + text[at.end():]
        (self.folder / name).write_text("`timescale 1ns/1ps\n" + text)

    def circuit(self, top):
        """The and-inverter graph of the top, or of a module in it, flattened: the text of an AIGER file."""
        outside = "".join(f"; blackbox {modules_of(name)}" for name in MEMORIES if name not in self.modules and self.top != f"fp3_{name}")
        said(self.yosys, f"read_rtlil {self.path('mutants.il')}; hierarchy -top {top}{outside}; {MAP}; "
             f"write_aiger -ascii -symbols {self.path('circuit.aag')}", self.root)
        # An index within a name is none of a bit.
        return re.sub(r"(?m)^([io]\d+ )(.*?)(\[\d+\])?$", lambda row: row[1] + row[2].replace("[", "<").replace("]", ">") + (row[3] or ""),
                      (self.folder / "circuit.aag").read_text())
