"""And-inverter graphs, and questions about them that cadical answers.

A literal is 2 * node + inverted; node 0 is the constant false, so 0 and 1 are the constants.
Equal ANDs share one node, so two circuits of the same shape get the same literals.

    g = Aig()
    a, b = g.word("a", 32), g.word("b", 32)
    z = netlist.graft(g, {"a_i": a, "b_i": b})["z_o"]
    model = Question(g, [g.differ(z, a)]).ask([g.neg(b[31])])    # None: no such input
"""

import subprocess
import tempfile
from pathlib import Path

FALSE, TRUE = 0, 1


class Unbalanced(Exception):
    """A circuit that is not a feed-forward pipeline with equal paths."""


class Unanswered(Exception):
    """A question takes too long."""


class Aig:
    def __init__(self):
        self.fanin = [None]          # per node: None for the constant and inputs, else two literals
        self.inputs = {}             # word name -> literals, bit 0 first
        self._known = {}             # fan-in pair -> literal

    def word(self, name, width):
        """The literals of an input word, made at the first call."""
        if name not in self.inputs:
            self.inputs[name] = [self._node(None) for _ in range(width)]
        return self.inputs[name]

    def both(self, a, b):
        if a > b:
            a, b = b, a
        if a == FALSE or a == b ^ 1:
            return FALSE
        if a == TRUE or a == b:
            return b
        if (a, b) not in self._known:
            self._known[a, b] = self._node((a, b))
        return self._known[a, b]

    def either(self, a, b):
        return self.both(a ^ 1, b ^ 1) ^ 1

    def choose(self, select, a, b):
        """select ? a : b, word by word."""
        return [self.either(self.both(select, x), self.both(select ^ 1, y)) for x, y in zip(a, b)]

    def differ(self, a, b):
        """One literal: words a and b are not equal."""
        if len(a) != len(b):
            raise ValueError(f"words of {len(a)} and {len(b)} bits")
        result = FALSE
        for x, y in zip(a, b):
            unequal = self.either(self.both(x, y ^ 1), self.both(x ^ 1, y))
            result = self.either(result, unequal)
        return result

    def times(self, a, b):
        """The product of two words, row by row."""
        total = [FALSE] * (len(a) + len(b))
        for i, y in enumerate(b):
            carry = FALSE
            for j, x in enumerate([*a, FALSE], i):
                x = self.both(x, y)
                half = self.differ([total[j]], [x])
                carry, total[j] = (self.either(self.both(total[j], x), self.both(half, carry)),
                                   self.differ([half], [carry]))
        return total

    def values(self, inputs, words):
        """The words' values, given those of the input words."""
        true = [False] * len(self.fanin)
        for name, lits in self.inputs.items():
            for i, lit in enumerate(lits):
                true[lit // 2] = bool(inputs[name] >> i & 1)
        read = lambda lit: true[lit // 2] != (lit & 1)
        for node, fanin in enumerate(self.fanin):          # fan-ins come first
            if fanin:
                true[node] = read(fanin[0]) and read(fanin[1])
        return [sum(read(lit) << i for i, lit in enumerate(word)) for word in words]

    def _node(self, fanin):
        self.fanin.append(fanin)
        return 2 * (len(self.fanin) - 1)


class Netlist:
    """A circuit read from an ASCII AIGER file with symbols, as yosys writes it."""

    def __init__(self, text, label):
        """label: names the circuit's undefined bits, which are inputs of any value."""
        self.label = label
        lines = iter(text.splitlines())
        header = next(lines).split()
        if header[0] != "aag" or any(int(n) for n in header[8:]):
            raise ValueError(f"not a plain ASCII AIGER file: {' '.join(header)}")
        n_in, n_latch, n_out, n_and, n_bad, n_assumed = map(int, (header[2:] + ["0", "0"])[:6])
        row = lambda: [int(n) for n in next(lines).split()]
        ins = [row()[0] for _ in range(n_in)]
        latches = [row() for _ in range(n_latch)]
        self.latches = {r[0] // 2: r[1] for r in latches}
        self.first = {r[0] // 2: [*r, 0][2] for r in latches}      # 0, 1, or the latch itself: any
        outs = [row()[0] for _ in range(n_out)]
        self.bad = [row()[0] for _ in range(n_bad)]                # assertions that fail
        self.assumed = [row()[0] for _ in range(n_assumed)]
        self.ands = {r[0] // 2: r[1:] for r in (row() for _ in range(n_and))}
        self.inputs, self.outputs, named = {}, {}, set()
        for line in lines:
            if line == "c":
                break
            symbol, name = line.split(" ", 1)
            words, lits = (self.inputs, ins) if symbol[0] == "i" else (self.outputs, outs)
            if symbol[0] == "i":
                named.add(ins[int(symbol[1:])])
            if symbol[0] in "io":
                base, _, bit = name.partition("[")
                words.setdefault(base, {})[int(bit.rstrip("]") or 0)] = lits[int(symbol[1:])]
        for words in (self.inputs, self.outputs):
            for name, bits in words.items():
                words[name] = [bits[i] for i in range(len(bits))]
        self.undefined = [lit for lit in ins if lit not in named]

    def order(self):
        """Nodes from inputs to outputs, registers counted as wires; refuses a loop."""
        done, open_ = set(), set()
        for root in (lit for word in self.outputs.values() for lit in word):
            stack = [root // 2]
            while stack:
                node = stack[-1]
                below = self._below(node)
                if node in open_ or node in done or not below:
                    stack.pop()
                    open_.discard(node)
                    if below and node not in done:
                        done.add(node)
                        yield node
                    continue
                open_.add(node)
                for lit in below:
                    if lit // 2 in open_:
                        raise Unbalanced("the circuit feeds back on itself")
                    if lit // 2 not in done:
                        stack.append(lit // 2)

    def graft(self, aig, words):
        """Rebuild the outputs' logic in aig, inputs taken from words, each register a wire."""
        value = {0: FALSE}
        for name, lits in self.inputs.items():
            if name in words:
                value.update((lit // 2, bit) for lit, bit in zip(lits, words[name], strict=True))
        for i, lit in enumerate(self.undefined):
            value[lit // 2], = aig.word(f"{self.label} undefined {i}", 1)
        read = lambda lit: value[lit // 2] ^ (lit & 1)
        for node in self.order():
            below = [read(lit) for lit in self._below(node)]
            value[node] = below[0] if node in self.latches else aig.both(*below)
        return {name: [read(lit) for lit in lits] for name, lits in self.outputs.items()}

    def depth(self):
        """Registers from inputs to outputs, the same on every path; refuses unequal paths."""
        level = {0: None}            # None: constant or undefined, at home at every depth
        level.update((lit // 2, None) for lit in self.undefined)
        for name, lits in self.inputs.items():
            level.update((lit // 2, 0) for lit in lits)
        for node in self.order():
            level[node] = self._meet(level, self._below(node))
            if node in self.latches and level[node] is not None:
                level[node] += 1
        return self._meet(level, [lit for lits in self.outputs.values() for lit in lits])

    def _below(self, node):
        return [self.latches[node]] if node in self.latches else self.ands.get(node, ())

    @staticmethod
    def _meet(level, lits):
        depths = {level[lit // 2] for lit in lits} - {None}
        if len(depths) > 1:
            raise Unbalanced(f"paths that cross {sorted(depths)} registers meet")
        return depths.pop() if depths else None


class Question:
    """Can all the given literals of an Aig be true at once?"""

    def __init__(self, aig, wanted, about=(), seconds=None):
        """about: literals that further clauses may speak of. After `seconds` there is no answer: Unanswered."""
        self.aig, self.seconds = aig, seconds
        self.wanted = list(wanted)
        clauses = ["-1 0"]           # variable n + 1 is node n
        seen, stack = {0}, [lit // 2 for lit in [*wanted, *about]]
        while stack:
            node = stack.pop()
            if node in seen:
                continue
            seen.add(node)
            if aig.fanin[node]:
                a, b = aig.fanin[node]
                y, a_, b_ = node + 1, self._dimacs(a), self._dimacs(b)
                clauses.append(f"-{y} {a_} 0\n-{y} {b_} 0\n{y} {-a_} {-b_} 0")
                stack += [a // 2, b // 2]
        self._nodes = seen
        self._clauses = clauses

    def ask(self, *also):
        """None if no input does it, else the input words of one that does.

        also: clauses to add, each a literal or a list of them.
        """
        extra = [[lit] for lit in self.wanted] + [c if isinstance(c, list) else [c] for c in also]
        for lit in (lit for clause in extra for lit in clause):
            if lit // 2 not in self._nodes:
                raise ValueError("a constraint outside the question's cone")
        rows = self._clauses + [" ".join(str(self._dimacs(l)) for l in c) + " 0" for c in extra]
        n_clauses = 3 * (len(self._clauses) - 1) + 1 + len(extra)
        with tempfile.TemporaryDirectory(prefix="fp3-prove-") as folder:
            cnf = Path(folder) / "question.cnf"
            cnf.write_text(f"p cnf {len(self.aig.fanin)} {n_clauses}\n" + "\n".join(rows) + "\n")
            run = subprocess.run(["cadical", "-q", "--unsat", *(["-t", str(self.seconds)] if self.seconds else []), str(cnf)], capture_output=True, text=True)
        if run.returncode == 20 and "s UNSATISFIABLE" in run.stdout:
            return None
        if run.returncode == 0 and self.seconds:
            raise Unanswered(f"no answer within {self.seconds} s")
        if run.returncode != 10:
            raise RuntimeError(f"cadical ended with {run.returncode}: {run.stderr or run.stdout}")
        true = {int(n) for line in run.stdout.splitlines() if line[0] == "v"
                for n in line[2:].split() if int(n) > 0}
        return {name: sum((lit // 2 + 1 in true) << i for i, lit in enumerate(lits))
                for name, lits in self.aig.inputs.items()}

    @staticmethod
    def _dimacs(lit):
        return -(lit // 2 + 1) if lit & 1 else lit // 2 + 1
