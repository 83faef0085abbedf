"""A model (*.ode) as functions of NumPy: a reader of its own, which shares nothing with the compiler that it helps to judge.

    model = read("programs/kepler.ode")
    model.slopes(t, states, params)         rows of an array for each number of a state, a column for each object

What has no effect on the solution is left out: units, texts, closed forms, invariants, projections.
"""

import re

import numpy as np

TOKEN = re.compile(r"\s*(\d+(?:\.(?!\.)\d*)?(?:[eE][-+]?\d+)?|\.\d+(?:[eE][-+]?\d+)?|\w+|\.\.|<=|>=|==|!=|.)")
LEVELS = (("or",), ("and",), ("<", "<=", ">", ">=", "==", "!="), ("+", "-"), ("*", "/"))
LOGICAL = {"or": "np.logical_or", "and": "np.logical_and"}


def vector(*parts):
    return np.array(np.broadcast_arrays(*parts), float)


FUNCTIONS = {
    **{name: getattr(np, name) for name in ("sqrt", "sin", "cos", "tan", "exp", "log", "log2", "expm1", "log1p", "sinh", "cosh", "tanh", "abs")},
    "atan": np.arctan, "asin": np.arcsin, "acos": np.arccos, "atan2": np.arctan2, "logistic": lambda x: 1 / (1 + np.exp(-x)),
    "dot": lambda a, b: (a * b).sum(0), "norm": lambda a: np.sqrt((a * a).sum(0)),
    "cross": lambda a, b: vector(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]),
    "max": lambda *a: np.max(vector(*a), 0), "min": lambda *a: np.min(vector(*a), 0),
}
GATHER = {"sum": lambda parts: sum(parts), "prod": lambda parts: np.prod(vector(*parts), 0),
          "max": lambda parts: np.max(vector(*parts), 0), "min": lambda parts: np.min(vector(*parts), 0)}


class Parser:
    """An expression as text of Python."""

    def __init__(self, text):
        self.tokens = TOKEN.findall(text.strip()) + ["end"]

    def take(self, *wanted):
        if wanted and self.tokens[0] not in wanted:
            raise ValueError(f"found '{self.tokens[0]}', expected {wanted}")
        return self.tokens.pop(0)

    def has(self, *which):
        return self.tokens[0] in which and self.tokens.pop(0)

    def choice(self):
        first = self.level(0)
        if not self.has("?"):
            return first
        yes = self.choice()
        self.take(":")
        return f"np.where({first}, {yes}, {self.choice()})"

    def level(self, depth):
        if depth == len(LEVELS):
            return self.sign()
        if depth == 2 and self.has("not"):
            return f"np.logical_not({self.level(depth)})"
        left = self.level(depth + 1)
        while op := self.has(*LEVELS[depth]):
            right = self.level(depth + 1)
            left = f"{LOGICAL[op]}({left}, {right})" if op in LOGICAL else f"({left} {op} {right})"
        return left

    def sign(self):
        op = self.has("-", "+")
        return f"({op}{self.sign()})" if op else self.power()

    def power(self):
        base = self.behind(self.atom())
        return f"({base}**{self.sign()})" if self.has("^") else base

    def behind(self, value):
        while op := self.has(".", "["):
            if op == ".":
                value = f"{value}[{'xyzw'.index(self.take())}]"
            else:
                value = f"{value}[({self.choice()}) - 1]"
                self.take("]")
        return value

    def gathered(self):
        """Behind the bracket of `i in 1..4: ...`."""
        name = self.take()
        self.take("in")
        first, _, last = self.choice(), self.take(".."), self.choice()
        self.take(":")
        text = f"[{self.choice()} for {name} in range({first}, {last} + 1)]"
        self.take(")")
        return text

    def list(self):
        parts = [self.choice()]
        while self.has(","):
            parts.append(self.choice())
        self.take(")")
        return parts

    def atom(self):
        token = self.take()
        if token == "(":
            if self.tokens[1] == "in":
                return f"vector(*{self.gathered()})"
            parts = self.list()
            return f"vector({', '.join(parts)})" if len(parts) > 1 else f"({parts[0]})"
        if token in FUNCTIONS | GATHER and self.has("("):
            if self.tokens[1] == "in":
                return f"GATHER['{token}']({self.gathered()})"
            return f"FUNCTIONS['{token}']({', '.join(self.list())})"
        if not re.match(r"[\w.]", token):
            raise ValueError(f"found '{token}', expected a value")
        return token if token[0].isdigit() or token[0] == "." else f"v['{token}']" if not re.fullmatch("[ijk]", token) else token


def expression(text):
    parser = Parser(text)
    code = parser.choice()
    parser.take("end")
    return compile(code, text, "eval")


def parts_of(text):
    """At the commas outside all brackets."""
    found, depth = [""], 0
    for c in text:
        depth += (c in "([") - (c in ")]")
        found = found + [""] if c == "," and not depth else found[:-1] + [found[-1] + c]
    return [part.strip() for part in found]


class Model:
    def __init__(self, lines):
        self.params, self.states, self.definitions, self.rates, self.events = {"pi": np.asarray(np.pi)}, {}, [], [], []
        self.starts, self.velocities = {}, {}
        self.names = []                                   # of the states' numbers, as runs write them
        for line in lines:
            self.line(line)

    def value(self, code, names):
        return eval(code, {"np": np, "vector": vector, "FUNCTIONS": FUNCTIONS, "GATHER": GATHER, "v": names, **self.index(names)})

    @staticmethod
    def index(names):
        return {name: names[name] for name in "ijk" if name in names}

    def line(self, line):
        word = re.match(r"\w+", line)[0]
        if word in ("param", "shared", "state", "step", "span"):
            line = re.sub(r"\s\[[^\]]*\]", "", line)
        if word in ("param", "shared"):
            name, value = re.match(r"\w+\s+(\w+)(?:\[\d+\])?\s*=\s*(.*)", line).groups()
            self.params[name] = np.asarray(self.value(expression(value), self.params), float)
        elif word == "state":
            name, size, value = re.match(r"state\s+(\w+)(?:\[(\d+)\])?\s*=\s*(.*)", line).groups()
            self.names += [f"{name}_{c}" for c in ("xyz"[:int(size)] if int(size) <= 3 else range(1, int(size) + 1))] if size else [name]
            self.states[name], self.starts[name] = int(size or 0), expression(value)
        elif word in ("when", "at"):
            self.event(line)
        elif word == "for":
            name, first, last, rest = re.match(r"for (\w) in (\S+)\.\.(\S+):\s*(.*)", line).groups()
            left, right = rest.split("=", 1)
            self.rates.append((left, expression(right), name, range(int(first), int(last) + 1)))
        elif word not in ("model", "unit", "step", "span", "invariant", "exact", "project"):
            left, right = line.split("=", 1)
            if left.count("'") == 1:
                self.velocities[re.match(r"\w+", left)[0]] = right.strip()
            if "'" in left:
                self.rates.append((left, expression(right), None, (0,)))
            else:
                self.definitions.append((left.strip(), expression(right)))

    def event(self, line):
        head, actions = re.match(r"(when root\(.*?\) (?:rising|falling|any)|at t = [^:]*|when [^:]*):\s*(.*)", line).groups()
        sets = [(left.strip(), expression(right)) for left, right in (part.split("=", 1) for part in parts_of(actions))]
        if head.startswith("when root("):
            text, way = re.match(r"when root\((.*)\) (\w+)$", head).groups()
            self.events.append(("root", expression(text), {"rising": 1, "falling": -1, "any": 0}[way], sets))
        elif head.startswith("at"):
            self.events.append(("time", expression(head.split("=", 1)[1]), 0, sets))
        else:
            self.events.append(("condition", expression(head[5:]), 0, sets))

    def values(self, t, rows, params):
        """All names; rows: the states' numbers, in their order."""
        v, at = {"t": t, **params}, 0
        for name, size in self.states.items():
            v[name] = rows[at:at + size] if size else rows[at]
            at += size or 1
        for name, code in self.definitions:
            v[name] = self.value(code, v)
        return v

    def place(self, left, i=None):
        """Rows of a state or component."""
        name = re.match(r"\w+", left)[0]
        name, left = (self.velocities[name], self.velocities[name]) if "''" in left else (name, left)
        at = sum(size or 1 for size in list(self.states.values())[:list(self.states).index(name)])
        size = self.states[name] or 1
        rest = left[len(name):].strip(" '")
        if rest.startswith("."):
            return slice(at + "xyz".index(rest[1]), at + "xyz".index(rest[1]) + 1)
        if rest.startswith("["):
            k = at + int(eval(rest[1:rest.index("]")], {}, {} if i is None else i)) - 1
            return slice(k, k + 1)
        return slice(at, at + size)

    def start(self, params, objects):
        """Rows of FP32 numbers."""
        rows = [np.atleast_1d(self.value(code, params)) for code in self.starts.values()]
        rows = [row if row.ndim == 2 else row[:, None] if self.states[name] else row[None] for row, name in zip(rows, self.states)]
        return np.concatenate([np.float32(np.broadcast_to(row, (len(row), objects))) for row in rows]).astype(float)

    def slopes(self, t, rows, params):
        v, found = self.values(t, rows, params), np.zeros(np.shape(rows))
        for left, code, name, indices in self.rates:
            for i in indices:
                if name:
                    v[name] = i
                found[self.place(left, {name: i})] = self.value(code, v)
        return found


def read(path):
    lines, part = [], ""
    with open(path) as text:
        for line in text:
            line = re.sub(r'"[^"]*"', "", line.split("#")[0]).strip()
            part = f"{part} {line}".strip()
            if part and part.count("(") == part.count(")") and part[-1] not in "+-*/=,?:":
                lines.append(part)
                part = ""
    return Model(lines)
