"""Random models, integrators and ways to compile them, for random_models.c."""
import random
import re
from pathlib import Path

CHANGES_BITS = re.findall(r'^    X\(\w+, "[a-z-]+", ([01]),', (Path(__file__).parents[2] / "sw/include/fp3/compile.h").read_text(encoding="utf-8"), re.M)
PASSES, KEEPING = len(CHANGES_BITS), CHANGES_BITS.index("1")  # those that keep the bits come first
INTEGRATORS = ["euler", "midpoint", "heun", "ralston3", "rk4", "rk38", "dopri5", "rk6", "rk4_paper", "semi_implicit_euler",
               "verlet", "leapfrog", "forest_ruth", "pefrl", "yoshida6", "stoermer_verlet"]
CONFIGS = ["single_full", "many_full", "sixteen"]
PLAIN = ["single", "many", "uncut", "paper", "shared"]  # without comparison, selection, estimates
NAMES = ["h_", "steps_", "t0", "t1", "over_m", "c1", "kept2", "step_", "r0", "k0", "add", "x_lost", "x", "v", "m", "p1",
         "madd", "a234567890123456789012345678901", "b234567890123456789012345678901", "h2", "e", "over_h", "x_before"]


class Maker:
    """One model as text."""

    def __init__(self, rng, is_plain):
        self.rng = rng
        self.kinds = 11 if is_plain else 24
        names = rng.sample(NAMES, len(NAMES))
        self.states = [names.pop() for _ in range(rng.choice([1, 2, 2, 3, 4]))]
        self.params = [names.pop() for _ in range(rng.randint(0, 3))]
        self.known = list(self.params)
        self.values = list(self.states)
        self.definitions = []
        self.times = rng.choice([[], [], ["t"]])
        self.values += self.times
        self.names = names
        self.made = []

    def number(self):
        return self.rng.choice(["0", "(-0)", "1", "2", "0.5", "3", "0.1", "1.5e-3", "4", "7", "1e10", "(-1)", "(-2)", "(-0.25)"])

    def leaf(self):
        kind = self.rng.random()
        if kind < 0.65:
            return self.rng.choice(self.values)
        if kind < 0.85 and self.known:
            return self.rng.choice(self.known)
        return self.number()

    def condition(self, depth):
        a, b = self.expression(depth), self.expression(depth)
        kind = self.rng.randrange(5)
        if kind == 0:
            return f"not ({self.condition(depth - 1) if depth > 0 else a})"
        if kind == 1 and depth > 0:
            return f"(({self.condition(depth - 1)}) {self.rng.choice(['and', 'or'])} ({self.condition(depth - 1)}))"
        if kind == 2:
            return f"({a} {self.rng.choice(['and', 'or'])} {b})"
        return f"({a} {self.rng.choice(['<', '<=', '>', '>=', '==', '!='])} {b})"

    def expression(self, depth):
        """Now and then one that was there before, or a sum or product of it turned round."""
        if depth <= 0:
            return self.leaf()
        if self.made and self.rng.random() < 0.2:
            a, op, b = self.rng.choice(self.made)
            return self.rng.choice([f"({a} {op} {b})", f"({b} {op} {a})"])
        return self.new(depth)

    def new(self, depth):
        a, b = self.expression(depth - 1), self.expression(self.rng.randrange(depth))
        kind = self.rng.randrange(self.kinds)
        if kind < 9:
            self.made.append((a, self.rng.choice(["+", "-", "*", "*"]), b))
            return "({} {} {})".format(*self.made[-1])
        if kind == 9:
            return f"(-{a})"
        if kind == 10:  # what costs nothing, and what only looks like it
            op, unit = self.rng.choice("+-*"), self.rng.choice(["0", "(-0)", "1"])
            return self.rng.choice([f"({a} {op} {unit})", f"({unit} {op} {a})"])
        if kind == 11:
            return f"({a})/({b})"
        if kind == 12:
            return f"({a})/sqrt({b})"
        if kind == 13:
            return f"({a})/({self.rng.choice(['', '-'])}sqrt({b}))^{self.rng.randint(0, 5)}"
        if kind == 14:
            base = self.rng.choice(self.values)
            return f"{self.rng.choice(['', '-'])}{base}^{self.rng.choice(['0', '1', '2', '3', '7', '8', '(-1)', '(-2)', '(-3)'])}"
        if kind == 15:
            return f"sqrt({a})^{self.rng.choice(['2', '3', '(-1)', '(-3)'])}"
        if kind == 16:
            return f"{self.rng.choice(['min', 'max'])}({a}, {b})"
        if kind == 17:
            return f"abs({a})"
        if kind == 18:
            return f"({self.condition(depth - 2)} ? {a} : {b})"
        if kind == 19:
            return f"{self.rng.choice(['sin', 'cos', 'sqrt'])}({a})"
        if kind == 20:
            return f"atan2({a}, {b})"
        if kind == 21:
            return f"{self.rng.choice(['exp', 'log', 'log2', 'expm1', 'log1p', 'logistic', 'sinh', 'cosh', 'tanh'])}({a})"
        if kind == 22:
            exponent = self.rng.choice(["0.5", "(-0.5)", "1.5", "(-1.5)", "4.5", "9", "(1/3)", "(-0.7)", *self.params])
            return f"{self.rng.choice(['', f'{b}/'])}{self.rng.choice(self.values)}^{exponent}"
        return f"{self.rng.choice(['tan', 'atan', 'asin', 'acos'])}({a})"

    def derivative(self, state):
        kind = self.rng.random()
        if kind < 0.08:
            return "0"
        if kind < 0.14:
            return self.number()
        if kind < 0.2 and self.known:
            return self.rng.choice(self.known)
        if kind < 0.5:
            return self.rng.choice(self.states)
        if kind < 0.55:
            return state
        return self.expression(self.rng.randint(1, 4))

    def event(self):
        states = self.rng.sample(self.states, self.rng.randint(1, min(3, len(self.states))))
        sets = [f"{s} = {self.rng.choice([self.expression(1), self.expression(2), self.leaf(), '-' + s])}" for s in states]
        return f"when {self.condition(self.rng.randint(0, 2))}: {', '.join(sets)}"

    def text(self):
        rng = self.rng
        lines = [f"{rng.choice(['param', 'shared'])} {p} = {rng.choice(['2', '0.3', '-1.7', '1', '0.5', '9.81'])}"
                 for p in self.params]
        lines += [f"state {s} = {rng.choice(['1', '0.5', '-2', '0', '0.125'])}" for s in self.states]
        for _ in range(rng.randint(0, 3)):
            name = self.names.pop()
            if rng.random() < 0.3:
                used, made = self.values, self.made
                self.values, self.made = self.known or ["1"], []
                lines.append(f"{name} = {self.expression(2)}")
                self.values, self.made = used, made
                self.known.append(name)
            else:
                lines.append(f"{name} = {self.expression(2)}")
                self.values.append(name)
        lines += [f"{s}' = {self.derivative(s)}" for s in self.states]
        if rng.random() < 0.3 and self.kinds > 11:  # conditions need `select`
            lines += [self.event() for _ in range(rng.randint(1, 3))]
        return "\n".join(lines + [f"step {rng.choice(['0.125', '0.01', '1', '2'])}", "span 1", ""])


def mechanics(rng, is_plain):
    """Positions and their velocities, for splittings and Stoermer."""
    m = Maker(rng, is_plain)
    pairs = [(m.names.pop(), m.names.pop()) for _ in range(rng.randint(1, 3))]
    positions = [x for x, _ in pairs]
    m.states = [s for pair in pairs for s in pair]
    m.params = [p for p in m.params if p not in m.states]
    m.known = list(m.params)
    m.values = (positions if rng.random() < 0.7 else list(m.states)) + m.times
    equations = {x: v for x, v in pairs}
    equations.update({v: m.expression(rng.randint(1, 3)) for _, v in pairs})
    m.derivative = equations.__getitem__
    rng.shuffle(m.states)
    return m.text()


def table(rng):
    """An explicit Runge-Kutta table of order 1 with odd coefficients."""
    stages = rng.randint(1, 5)
    pick = lambda: rng.choice(["0", "1", "\"1/2\"", "\"-1/3\"", "\"2/3\"", "-1", "2", "0.3", "0.25"])
    rows = ["(" + ", ".join(pick() for _ in range(i)) + ")" for i in range(stages)]
    b = [rng.choice([0, 1, -1, 2, 0.5, 0.25]) for _ in range(stages)]
    b[rng.randrange(stages)] += 1 - sum(b)
    late = rng.choice(["true", "false"])
    return (f"name = \"odd\"; doc = \"\"; source = \"\"; kind = \"runge-kutta\"; order = 1; late_position = {late};\n"
            f"A = ({', '.join(rows)});\nb = ({', '.join(map(repr, b))});\n")


def case(rng, folder, number, rtl=0.0):
    """Files for one case; its line."""
    model = folder / f"{number}.ode"
    kind = rng.random()
    is_plain = rng.random() < 0.25
    if kind < 0.3:
        integrator = rng.choice(INTEGRATORS[9:])
        model.write_text(mechanics(rng, is_plain))
    elif kind < 0.45:
        integrator = folder / f"{number}.cfg"
        integrator.write_text(table(rng))
        model.write_text(Maker(rng, is_plain).text())
    else:
        integrator = rng.choice(INTEGRATORS[:9] if kind < 0.9 else INTEGRATORS)
        model.write_text(Maker(rng, is_plain).text())
    states = [line.split()[1] for line in model.read_text().splitlines() if line.startswith("state ")]
    passes = rng.choice([(1 << KEEPING) - 1, (1 << KEEPING) - 1, rng.getrandbits(KEEPING), 0, rng.getrandbits(PASSES)])
    observed = "all" if rng.random() < 0.7 else ",".join(rng.sample(states, rng.randint(1, len(states))))
    return (f"{model} {integrator} {rng.choice(PLAIN if is_plain else CONFIGS)} {passes:x} {int(rng.random() < 0.3)} {rng.choice([0, 1, 2, 3, 5, 9])} "
            f"{rng.choice([0, 0, 1, 2])} {int(rng.random() < rtl)} {int(rng.random() < 0.3)} {rng.getrandbits(32)} {observed}")


def cases(seed, count, folder, rtl=0.0):
    return [case(random.Random(f"{seed} {i}"), folder, i, rtl) for i in range(count)]
