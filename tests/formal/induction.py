"""Machines with assertions: proved for ever by induction, or refuted by a run from reset. cadical answers.

    machine = Machine(yosys, "read_verilog -formal x.v; chparam -set N 4 x", "x", files)
    machine.prove()                      # raises Refuted or Unproved
    machine.refute(20)                   # raises Refuted if a run of 20 cycles breaks an assertion
"""

from aig import FALSE, Aig, Netlist, Question
from netlist import MAP

READ = "prep -top {top} -flatten; async2sync; chformal -lower; opt -full -nodffe -nosdff; dffunmap; clean"


class Refuted(Exception):
    """An assertion fails in a run from power-up."""


class Unproved(Exception):
    """An assertion fails one cycle after a state in which all hold, which no run may reach."""


class Machine:
    def __init__(self, yosys, script, top, files):
        self.netlist = Netlist(yosys.run(f"{script}; {READ.format(top=top)}; {MAP}; write_aiger -ascii -symbols out.aag",
                                         files, "out.aag"), top)
        if not self.netlist.bad:
            raise ValueError(f"{top} asserts nothing")

    def prove(self, depth=1):
        """All assertions hold in the first cycles, and in each cycle after `depth` cycles in which they hold."""
        self.refute(depth)
        run = Run(self.netlist)
        run.begin(lambda latch: run.free(f"state {latch}"))
        holds, broken = [run.cycle() ^ 1 for _ in range(depth)], run.cycle()
        if Question(run.aig, [*run.assumed, *holds, broken]).ask():
            raise Unproved("the induction fails")
        self.run(depth + 8)
        return "proved by induction"

    def run(self, cycles):
        """Raises Unproved if no run of this many cycles does what is assumed: a proof would say nothing."""
        run, first = Run(self.netlist), self.netlist.first
        run.begin(lambda latch: run.free(f"state {latch}") if first[latch] > 1 else first[latch])
        for _ in range(cycles):
            run.cycle()
        if not Question(run.aig, run.assumed).ask():
            raise Unproved(f"no run of {cycles} cycles does what is assumed")

    def refute(self, cycles):
        """Raises Refuted if an assertion can fail within this many cycles of power-up."""
        run, first = Run(self.netlist), self.netlist.first
        run.begin(lambda latch: run.free(f"state {latch}") if first[latch] > 1 else first[latch])
        for cycle in range(cycles):
            broken = run.cycle()
            if broken != FALSE and Question(run.aig, [*run.assumed, broken]).ask():
                raise Refuted(f"an assertion fails in cycle {cycle}")


class Run:
    """Cycle after cycle of a netlist in one and-inverter graph; inputs are free in each."""

    def __init__(self, netlist):
        self.netlist, self.aig, self.assumed = netlist, Aig(), []
        self._latches, self._cycle = {}, 0

    def free(self, name):
        return self.aig.word(name, 1)[0]

    def begin(self, value):
        """value: the literal that each latch starts with."""
        self._latches = {latch: value(latch) for latch in self.netlist.latches}

    def cycle(self):
        """One more cycle; the literal that some assertion fails in it."""
        netlist = self.netlist
        value = {0: FALSE, **self._latches}
        read = lambda lit: value[lit // 2] ^ (lit & 1)
        for lit in [lit for word in netlist.inputs.values() for lit in word] + netlist.undefined:
            value[lit // 2] = self.free(f"cycle {self._cycle}, input {lit}")
        for node, (a, b) in sorted(netlist.ands.items()):        # fan-ins have smaller numbers
            value[node] = self.aig.both(read(a), read(b))
        self.assumed += [read(lit) for lit in netlist.assumed]
        broken = FALSE
        for lit in netlist.bad:
            broken = self.aig.either(broken, read(lit))
        self._latches = {latch: read(lit) for latch, lit in netlist.latches.items()}
        self._cycle += 1
        return broken
