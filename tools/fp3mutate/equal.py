"""Whether a mutant can be told from the module at all: two copies of one circuit, in which `mutant` is 0 and its number, get the same inputs.

By induction over registers that correspond. Both copies begin in the same state. At first all registers are taken to be equal in both copies; one
that may differ a cycle later, although those that are left are equal, is left out; until nothing more has to be. If the outputs are equal then,
they are equal for ever, whatever the inputs and the first state. This says yes or "not shown": a mutant that is seen only in states that no run
reaches, or by inputs that nobody gives, is not shown to be equal.
"""

from aig import FALSE, TRUE, Aig, Netlist, Question, Unanswered

SECONDS = 10              # for one question
ROUNDS = 60               # of registers that are left out


class Circuit:
    """text: AIGER with the input word `mutant`."""

    def __init__(self, text, label):
        self.netlist = Netlist(text, label)
        self.order = sorted(self.netlist.ands)               # fan-ins have smaller numbers

    def copy(self, aig, number, states):
        """(outputs, next states) of one copy in which the registers hold `states`."""
        netlist, value = self.netlist, {0: FALSE, **states}
        for name, lits in netlist.inputs.items():
            word = [TRUE if number >> i & 1 else FALSE for i in range(len(lits))] if name == "mutant" else aig.word(name, len(lits))
            value.update((lit // 2, bit) for lit, bit in zip(lits, word, strict=True))
        for i, lit in enumerate(netlist.undefined):
            value[lit // 2], = aig.word(f"undefined {i}", 1)
        for node in self.order:
            a, b = netlist.ands[node]
            value[node] = aig.both(value[a // 2] ^ (a & 1), value[b // 2] ^ (b & 1))
        read = lambda lit: value[lit // 2] ^ (lit & 1)
        return [read(lit) for word in netlist.outputs.values() for lit in word], {latch: read(lit) for latch, lit in netlist.latches.items()}

    def is_equal(self, number):
        """Whether this mutant is shown to be the module itself."""
        try:
            return self.corresponds(number)
        except Unanswered:
            return False

    def corresponds(self, number):
        apart = set()
        for _ in range(ROUNDS):
            aig = Aig()
            mine = {latch: aig.word(f"state {latch}", 1)[0] for latch in self.netlist.latches}
            other = {latch: aig.word(f"other {latch}", 1)[0] if latch in apart else lit for latch, lit in mine.items()}
            (said, mine), (told, other) = self.copy(aig, 0, mine), self.copy(aig, number, other)
            if any_differs(aig, said, told):
                return False
            kept = [latch for latch in mine if latch not in apart]
            more = differing(aig, [mine[latch] for latch in kept], [other[latch] for latch in kept])
            if not more:
                return True
            apart |= {kept[i] for i in more}
        return False


def any_differs(aig, some, others):
    wrong = aig.differ(some, others)
    return wrong != FALSE and (wrong == TRUE or Question(aig, [wrong], seconds=SECONDS).ask() is not None)


def differing(aig, some, others):
    """The places in two words that may differ: those of one example at least, or none."""
    wrong = aig.differ(some, others)
    if wrong == FALSE:
        return []
    found = Question(aig, [wrong], seconds=SECONDS).ask()
    if found is None:
        return []
    return [i for i, (a, b) in enumerate(zip(*(bits_of(aig, found, word) for word in (some, others)))) if a != b]


def bits_of(aig, inputs, word):
    return aig.values(inputs, [[lit] for lit in word])
