"""The proofs: adder and multiplier against yosys's IEEE 754 model, pipelines against the plain core."""

from functools import partial
from pathlib import Path

import product
from aig import FALSE, Aig, Question
from netlist import core, facts, model, take_out

FLAGS = ("NX", "UF", "OF", "DZ", "NV")                   # bit 0 first


class Different(Exception):
    """Not equal: the message has an example."""


class Unclear(Exception):
    """Not proved, but no example either."""


class Proof:
    """One core beside the model, on the same operands."""

    def __init__(self, fmt):
        self.fmt, self.g = fmt, Aig()
        # IEEE 754 has no format without infinities, but each finite one is in the format with an exponent bit more.
        self.model = fmt._replace(exp=fmt.exp + 1) if fmt.finite else fmt
        self.a, self.b = (self.g.word(name, fmt.exp + fmt.frac + 1) for name in "ab")
        self.ours = self.theirs = None                   # {z_o, flags_o}; (value, flags)

    def read(self, word):
        """An operand as the core is to read it, and whether its exponent field is not 0."""
        fraction, field = word[:self.fmt.frac], word[self.fmt.frac:-1]
        normal = self.g.differ(field, [FALSE] * len(field))
        if self.fmt.subnormal:
            return word, normal
        return [self.g.both(normal, bit) for bit in fraction] + word[self.fmt.frac:], normal

    def modelled(self, word):
        """An operand in the model's format: the exponent's bias is larger by its top bit."""
        if not self.fmt.finite:
            return word
        *low, top = field = word[self.fmt.frac:-1]
        normal = self.g.differ(field, [FALSE] * len(field))
        return word[:self.fmt.frac] + low + [self.g.both(normal, top ^ 1), top] + word[-1:]

    def narrowed(self, result):
        """A result of the model's in the format without infinities: the largest number, or +0, if it is not in there."""
        g, ((*fraction_and_low, below, top, sign), flags) = self.g, result
        fraction, low = fraction_and_low[:self.fmt.frac], fraction_and_low[self.fmt.frac:]
        over = g.both(top, below)
        in_range = g.either(top, g.both(below, g.differ(low, [FALSE] * len(low))))
        under = in_range ^ 1
        lost = g.both(under, g.differ(fraction_and_low + [below], [FALSE] * (len(fraction_and_low) + 1)))
        value = [g.both(in_range, g.either(over, bit)) for bit in fraction + low + [top]] + [g.both(in_range, sign)]
        nx, uf, of, dz, nv = flags
        return value, [g.either(g.either(over, lost), nx), g.either(uf, lost), g.either(of, over), dz, nv]

    def expect(self, result, tiny):
        """The model's result; if it is tiny and the core flushes, a zero of its sign, with UF and NX."""
        if self.fmt.finite:
            return self.narrowed(result)
        if self.fmt.subnormal:
            return result
        value, flags = result
        return ([self.g.both(bit, tiny ^ 1) for bit in value[:-1]] + value[-1:],
                [self.g.either(bit, tiny) for bit in flags[:2]] + flags[2:])

    def words(self):
        return self.ours["z_o"] + self.ours["flags_o"], self.theirs[0] + self.theirs[1]

    def example(self, inputs):
        a, b, z, flags, want, want_flags = self.g.values(
            inputs, (self.a, self.b, self.ours["z_o"], self.ours["flags_o"], *self.theirs))
        n = (len(self.a) + 3) // 4
        sub = f" sub={inputs['sub']}" if "sub" in inputs else ""
        return (f"a={a:0{n}x} b={b:0{n}x}{sub}: expected {want:0{n}x} flags {want_flags:05b}, "
                f"got {z:0{n}x} flags {flags:05b}")

    @staticmethod
    def result(outputs):
        return outputs["o"], [outputs[flag][0] for flag in FLAGS]


class Add(Proof):
    def __init__(self, yosys, files, fmt):
        super().__init__(fmt)
        g, sub = self.g, self.g.word("sub", 1)
        operands = {"a_i": self.a, "b_i": self.b, "sub_i": sub}
        self.ours = yosys.map(core(yosys, files, "fp3_fp_add", fmt, 0), "fp3_fp_add").graft(g, operands)
        (a, _), (b, _) = self.read(self.a), self.read(self.b)
        a, b = self.modelled(a), self.modelled(b)
        both = [self.result(model(yosys, operation, self.model).graft(g, {"a": a, "b": b})) for operation in ("sub", "add")]
        value, flags = (g.choose(sub[0], x, y) for x, y in zip(*both))
        fraction = value[:fmt.frac]                      # a tiny sum is exact: it shows
        tiny = g.both(self.read(value)[1] ^ 1, g.differ(fraction, [FALSE] * len(fraction)))
        self.theirs = self.expect((value, flags), tiny)
        of = facts(yosys, "add_cases", fmt).graft(g, operands)
        self.distance, self.far, self.subtract = of["distance_o"], of["far_o"][0], of["subtract_o"][0]
        about = [*self.distance, self.far, self.subtract]
        self.question = Question(g, [g.differ(*self.words())], about)
        self.nothing = Question(g, [], about)

    def split(self):
        """The cases by name, each a list of literals that must all be true."""
        for k in range(self.fmt.frac + 5):              # the slow ones first: they share a pool
            for name, sign in ("subtract", self.subtract), ("add", self.subtract ^ 1):
                if k == self.fmt.frac + 4:
                    yield f"{name}, distance above {k - 1}", [sign, self.far]
                else:
                    yield f"{name}, distance {k}", [sign] + [lit ^ 1 ^ (k >> i & 1)
                                                             for i, lit in enumerate(self.distance)]

    def cases(self):
        split = dict(self.split())
        yield "no pair outside the cases", partial(self.complete, split)
        for name, case in split.items():
            yield name, partial(self.equal, case)

    def complete(self, split):
        if inputs := self.nothing.ask(*([lit ^ 1 for lit in case] for case in split.values())):
            raise Different(f"no case holds {inputs}")
        return "proved"

    def equal(self, case=()):
        if inputs := self.question.ask(*case):
            raise Different(self.example(inputs))
        return "proved"


class Mul(Proof):
    def __init__(self, yosys, files, fmt):
        super().__init__(fmt)
        g = self.g
        uncut = core(yosys, files, "fp3_fp_mul", fmt, 0)
        self.inner = take_out(uncut, "fp3_fp_mul", "fp_mul_product")
        width = 2 * fmt.frac + 2
        operands = {"a_i": self.a, "b_i": self.b}
        free = g.word("product", width)
        of = facts(yosys, "mul_facts", self.model).graft(
            g, {"a_i": self.modelled(self.a)[:-1], "b_i": self.modelled(self.b)[:-1], "product_i": free})
        self.ours = yosys.map(uncut, "fp3_fp_mul").graft(g, {**operands, "product.Y": free})
        (a, a_normal), (b, b_normal) = self.read(self.a), self.read(self.b)
        self.finite = of["finite_o"][0]
        if not fmt.subnormal:
            self.finite = g.both(self.finite, g.both(a_normal, b_normal))
        normal = g.choose(self.finite, of["normal_product_o"], g.word("otherwise", width))
        factors = {"a": self.modelled(a), "b": self.modelled(b), "product.Y": normal}
        outputs = model(yosys, "mul", self.model).graft(g, factors)
        cut_off = model(yosys, "mul", self.model._replace(nearest=False)).graft(g, factors)
        tiny = g.both(self.finite, self.read(cut_off["o"])[1] ^ 1)       # before rounding
        self.theirs = self.expect(self.result(outputs), tiny)
        self.facts, self.factors = of, (outputs["product.A"], outputs["product.B"])

    def cases(self):
        yield "all pairs, whatever the product", self.equal
        yield "our product is of the significands", self.our_factors
        yield "the model's product is of the normal significands", self.their_factors
        yield "the tiles make the product", self.tiles

    def equal(self):
        wrong = self.g.differ(*self.words())
        inputs = Question(self.g, [self.facts["possible_o"][0], wrong]).ask()
        if not inputs:
            return "proved"
        # The product may be one that these operands do not have: look for one that they have.
        real = self.g.times(self.facts["sig_a_o"], self.facts["sig_b_o"])
        other = self.g.differ(real, self.g.word("product", len(real)))
        inputs = Question(self.g, [wrong, other ^ 1]).ask()
        raise Different(self.example(inputs)) if inputs else Unclear("the product needs a closer description")

    def our_factors(self):
        wrong = self._unlike(("sig_a_o", "sig_b_o"), (self.ours["product.A"], self.ours["product.B"]))
        return self._none(Question(self.g, [wrong]))

    def their_factors(self):
        wrong = self._unlike(("normal_a_o", "normal_b_o"), self.factors)
        return self._none(Question(self.g, [self.finite, wrong]))

    def tiles(self):
        product.prove(*self.inner)
        return "proved"

    def _unlike(self, names, words):
        """One literal: not these facts are multiplied. Words may be wider, with zeros on top."""
        unlike = FALSE
        for name, word in zip(names, words):
            fact = self.facts[name] + [FALSE] * (len(word) - len(self.facts[name]))
            unlike = self.g.either(unlike, self.g.differ(fact, word))
        return unlike

    def _none(self, question):
        if inputs := question.ask():
            raise Different(self.example(inputs))
        return "proved"


class Fma(Mul):
    """Fused multiply-add. As with the multiplication, one free word stands for the product on both sides."""
    def __init__(self, yosys, files, fmt):
        Proof.__init__(self, fmt)
        g, self.c, self.sub = self.g, self.g.word("c", fmt.exp + fmt.frac + 1), self.g.word("sub", 1)
        uncut = core(yosys, files, "fp3_fp_fma", fmt, 0)
        self.inner = take_out(uncut, "fp3_fp_fma", "fp_mul_product")
        self.core = yosys.map(uncut, "fp3_fp_fma")
        self.models = [model(yosys, "muladd", fmt._replace(nearest=nearest)) for nearest in (fmt.nearest, False)]
        width = 2 * fmt.frac + 2
        free = g.word("product", width)
        (a, _), (b, _) = self.read(self.a), self.read(self.b)
        self.facts = of = facts(yosys, "mul_facts", fmt).graft(g, {"a_i": a[:-1], "b_i": b[:-1], "product_i": free})
        self.finite = of["finite_o"][0]
        self.ours = self.by_core(self.a, self.b, free)
        self.theirs, self.factors = self.by_model(self.a, self.b, g.choose(self.finite, of["normal_product_o"], g.word("otherwise", width)))
        operands, cases = {"z_i": self.c, "subtract_i": self.sub}, facts(yosys, "fma_cases", fmt, SUBNORMAL=int(fmt.subnormal))
        case = cases.graft(g, operands | {"x_i": self.a, "y_i": self.b})
        self.distance, self.zeros = case["distance_o"], case["zeros_o"]
        self.below, self.above, self.minus, self.plain, self.tiny, self.movable = (
            case[f"{name}_o"][0] for name in ("below", "above", "minus", "plain", "tiny", "movable"))
        about = [*self.distance, *self.zeros, self.below, self.above, self.minus, self.plain, self.tiny, self.movable, of["possible_o"][0]]
        self.question = Question(g, [g.differ(*self.words())], about)
        self.nothing = Question(g, [], about)
        # Core and model are asked one by one whether normal factors in place of a subnormal one make a difference.
        x, y, product = case["moved_x_o"], case["moved_y_o"], of["normal_product_o"]
        ours, (theirs, _) = self.by_core(x, y, product), self.by_model(x, y, product)
        plain = cases.graft(g, operands | {"x_i": x, "y_i": y})["plain_o"][0]
        of = facts(yosys, "mul_facts", fmt).graft(g, {"a_i": x[:-1], "b_i": y[:-1], "product_i": product})
        fit = g.both(g.both(plain, of["finite_o"][0]), g.both(of["possible_o"][0], g.differ(product, of["normal_product_o"]) ^ 1))
        self.moves = {"the core": Question(g, [g.differ(self.ours["z_o"] + self.ours["flags_o"], ours["z_o"] + ours["flags_o"])], about),
                      "the model": Question(g, [g.differ(self.theirs[0] + self.theirs[1], theirs[0] + theirs[1])], about),
                      "the cases": Question(g, [fit ^ 1], about)}

    def by_core(self, x, y, product):
        return self.core.graft(self.g, {"x_i": x, "y_i": y, "z_i": self.c, "subtract_i": self.sub, "product.Y": product, "no_product_i": [FALSE]})

    def by_model(self, x, y, product):
        """What is expected, and the two words that are multiplied; product is that of the normal significands."""
        g, fmt, (a, _), (b, _), (c, _) = self.g, self.fmt, *map(self.read, (x, y, self.c))
        factors = {"a": a[:-1] + [g.differ([a[-1]], self.sub)], "b": b, "c": c, "product.Y": product}
        outputs, cut_off = (rounding.graft(g, factors) for rounding in self.models)
        magnitude, flags = self.result(cut_off)
        tiny = g.both(self.read(magnitude)[1] ^ 1, g.either(g.differ(magnitude[:fmt.frac], [FALSE] * fmt.frac), flags[0]))
        return self.expect(self.invalid(self.result(outputs), a, b), tiny), (outputs["product.A"], outputs["product.B"])

    def invalid(self, result, a, b):
        """754 leaves open whether infinity times zero is invalid if a quiet NaN is added. Ours is."""
        g, (value, flags) = self.g, result
        def is_all(word, bit):
            return g.differ(word, [bit] * len(word)) ^ 1
        def clash(x, y):
            return g.both(g.both(is_all(x[self.fmt.frac:-1], 1), is_all(x[:self.fmt.frac], 0)), is_all(y[:-1], 0))
        return value, flags[:4] + [g.either(flags[4], g.either(clash(a, b), clash(b, a)))]

    def split(self):
        """Normal factors by the distance of the exponents; a subnormal one by whether it can be moved, and the zeros in front of it."""
        fmt = self.fmt
        equal = lambda word, n: [lit ^ 1 ^ (n >> i & 1) for i, lit in enumerate(word)]
        yield "no normal factor", [self.tiny]
        for name, sign in (("subtract", self.minus), ("add", self.minus ^ 1)):
            yield f"{name}, far below", [sign, self.below, self.plain]
            yield f"{name}, far above", [sign, self.above, self.plain]
            for k in range(3 * fmt.frac + 13):
                yield (f"{name}, distance {k - 2 * fmt.frac - 6}",
                       [sign, self.below ^ 1, self.above ^ 1, *equal(self.distance, k), self.plain])
            yield f"{name}, a factor that cannot be moved", [sign, self.plain ^ 1, self.tiny ^ 1, self.movable ^ 1]
        for n in range(1, fmt.frac + 1 if fmt.subnormal else 1):
            yield f"{n} zeros in front of a factor", [self.movable, *equal(self.zeros, n)]

    def cases(self):
        split = dict(self.split())
        yield "no operands outside the cases", partial(self.complete, split)
        for name, case in split.items():
            if case[0] != self.movable:
                yield name, partial(self.equal, case)
                continue
            for whose, question in self.moves.items():
                yield f"{name}: {whose}", partial(self.moved, question, case)
        yield "our product is of the significands", self.our_factors
        yield "the model's product is of the normal significands", self.their_factors
        yield "the tiles make the product", self.tiles

    def complete(self, split):
        if inputs := self.nothing.ask(*([lit ^ 1 for lit in case] for case in split.values())):
            raise Different(f"no case holds {inputs}")
        return "proved"

    def moved(self, question, case):
        """What core or model makes of the factors is what it makes of the normal ones in their place, whose cases are proved."""
        if not question.ask(self.facts["possible_o"][0], *case):
            return "proved"
        return f"{self.equal(case)}, as it is"

    def equal(self, case=()):
        possible = self.facts["possible_o"][0]
        if not (inputs := self.question.ask(possible, *case)):
            return "proved"
        # The product may be one that these operands do not have: look for one that they have.
        real = self.g.times(self.facts["sig_a_o"], self.facts["sig_b_o"])
        other = self.g.differ(real, self.g.word("product", len(real)))
        wrong = self.g.differ(*self.words())
        inputs = Question(self.g, [wrong, other ^ 1, *case]).ask()
        raise Different(self.example(inputs)) if inputs else Unclear("the product needs a closer description")

    def example(self, inputs):
        c, = self.g.values(inputs, (self.c,))
        return f"c={c:0{(len(self.c) + 3) // 4}x} " + super().example(inputs)


def cut(yosys, files, fmt, operation, mask):
    """A pipelined core is the uncut one, as many cycles later as its mask has ones.

    core() has refused all state but plain registers on one clock. Without feedback, and with n registers
    on every path, a signal behind k of them is at time t the function of the operands at t - k that it is
    in the same circuit with wires for registers: by induction, since what meets in a gate is equally late.
    So it is enough that all paths are equally long and that the circuit with wires is the uncut core.
    Constants, and undefined bits (equally named in both circuits), fit in at every depth. The product is taken
    out of both, as its algebra is shown here, too: cadical need not know it.
    """
    g, words = Aig(), []
    names = {"fma": ("fma_late", "fma_late"), "fma early": ("fma_late", "fma_early")}.get(operation, (f"fp3_fp_{operation}",) * 2)
    files = files | {f"{name}.v": Path(__file__).with_name(f"{name}.v").read_text() for name in names if name.startswith("fma")}
    for name, cuts in zip(names, (0, mask)):
        design = core(yosys, files, name, fmt, cuts)
        if cuts:
            check_depth(yosys.map(design, name, flatten=True), cuts)
        if operation in ("mul", "fma", "fma early"):
            product.prove(*take_out(design, name, "fp_mul_product"))
        netlist = yosys.map(design, name)
        inputs = {port: g.word(port, len(lits)) for port, lits in netlist.inputs.items() if port != "clk_i"}
        outputs = netlist.graft(g, inputs)
        words.append([lit for port in sorted(outputs) for lit in outputs[port]])
    wrong = g.differ(*words)
    if wrong == FALSE:
        return f"proved, same ANDs, latency {mask.bit_count()}"
    if inputs := Question(g, [wrong]).ask():
        raise Different("differs from the uncut core: " + " ".join(f"{k}={v:x}" for k, v in inputs.items()))
    return f"proved, latency {mask.bit_count()}"


def check_depth(netlist, mask):
    depth = netlist.depth()
    if depth != mask.bit_count():
        raise Different(f"{depth} registers between operands and result, expected {mask.bit_count()}")
