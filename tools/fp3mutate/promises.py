"""Mutants of a module whose promises a specification of tests/formal states: may one of them be broken in a run from reset?

The specification is the design, and the mutants lie in its module: one circuit for all of them, in which their number is an input. What holds in
such a run may still break the induction, which is not asked.
"""

from pathlib import Path

from aig import FALSE, TRUE, Netlist, Question
from induction import READ, Run
from netlist import MAP
from subject import parameters

from .netlist import Design, said
from .rungs import Rung


class Spec(Design):
    """`read` is the subject of tests/formal; its shape is that of the first seeded bug."""

    def elaborate(self):
        subject, shape = self.read, {**parameters(self.read.bugs[0][3]), "LEMMAS": 0}
        ours = [next(self.root.glob(f"rtl/*/{name}")) for name in subject.sources if name.endswith(".v")]
        files = [*ours, *(self.root / "tests/formal" / name for name in (f"{subject.spec}.v", *subject.models))]
        said(self.yosys, f"read_verilog -formal -I rtl {' '.join(str(path.relative_to(self.root)) for path in files)}; "
             f"chparam {' '.join(f'-set {name} {value}' for name, value in shape.items())} {subject.spec}; "
             f"hierarchy -top {subject.spec}; proc; opt_clean; memory_collect; memory_map; write_rtlil {self.path('design.il')}", self.root)

    def apply(self):
        self.write_script()
        said(self.yosys, f"read_rtlil {self.path('design.il')}; script {self.path('mutants.ys')}; write_rtlil {self.path('mutants.il')}; "
             f"{READ.format(top=self.top)}; {MAP}; write_aiger -ascii -symbols {self.path('promises.aag')}", self.root)


class Promises(Rung):
    name = "promises"

    def build(self):
        self.netlist = Netlist((self.design.folder / "promises.aag").read_text(), self.design.top)

    def run(self, number, folder: Path):
        """As Machine.refute of tests/formal/induction.py, in a circuit in which the mutant is an input."""
        run, first = Fixed(self.netlist, number), self.netlist.first
        run.begin(lambda latch: run.free(f"state {latch}") if first[latch] > 1 else first[latch])
        for cycle in range(self.design.read.cycles):
            broken = run.cycle()
            if broken != FALSE and Question(run.aig, [*run.assumed, broken]).ask():
                return False, f"a promise is broken in cycle {cycle}"
        return True, ""


class Fixed(Run):
    """A run of one mutant."""

    def __init__(self, netlist, number):
        super().__init__(netlist)
        self.fixed = {f"input {lit}": TRUE if number >> i & 1 else FALSE for i, lit in enumerate(netlist.inputs.get("mutant", []))}

    def free(self, name):
        known = self.fixed.get(name.partition(", ")[2])
        return super().free(name) if known is None else known
