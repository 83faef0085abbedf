#!/usr/bin/env python3
"""The polynomials of sw/compiler/functions/ and pairs/: minimax by Remez' exchange, coefficients rounded to FP32;
and those of double-single (pair_*.c): by Chebyshev's nodes, in fractions, coefficients as doubles.

    tools/polynomials.py       prints the coefficients, highest power first, and two errors of each: before and
                               after the rounding, relative to the function
    tools/polynomials.py --check   says which of them the C sources do not have
"""

import math
import pathlib
import re
import struct
import sys
from fractions import Fraction
from typing import Callable, NamedTuple

ROOT = pathlib.Path(__file__).resolve().parent.parent
GRID = 2000
ROUNDS = 30


class Polynomial(NamedTuple):
    name: str                        # of the array in C
    function: Callable[[float], float]
    weight: Callable[[float], float]  # what an error of the polynomial does to the function, relatively
    first: float
    last: float
    count: int


def series(terms):
    return lambda x: math.fsum(term * x ** i for i, term in enumerate(terms))


def log_rest(r):
    """(log(1 + r) - r + r^2/2)/r^3"""
    if abs(r) < 0.02:
        return math.fsum((-r) ** i / (i + 3) for i in range(30))
    return (math.log1p(r) - r + r * r / 2) / r ** 3


# Where the weight is 0 an error does no harm, but the exchange needs some weight everywhere.
POLYNOMIALS = [
    Polynomial("rest", series([1 / math.factorial(i + 2) for i in range(25)]),
               lambda r: max(r * r / math.exp(r), 0.005), -0.70, 0.70, 6),
    Polynomial("odd", series([1 / math.factorial(2 * i + 3) for i in range(15)]), lambda z: z + 1e-3, 0, 0.4901, 3),
    Polynomial("even", series([1 / math.factorial(2 * i + 2) for i in range(15)]), lambda z: z + 1e-3, 0, 0.4901, 3),
    Polynomial("log_rest", log_rest, lambda r: max(r * r * abs(r / math.log1p(r)) if r else 0, 0.004), -0.2930, 0.4144, 7),
    Polynomial("atanh_rest", series([1 / (2 * i + 3) for i in range(40)]), lambda z: z + 1e-4, 0, 0.02945, 4),
]


class Fine(NamedTuple):
    name: str
    terms: list[Fraction]  # of the function's series, from power 0; the error counts absolutely
    last: float            # from 0 to here
    count: int


def bernoulli(count):
    """B_0, B_2, B_4, ..."""
    numbers = [Fraction(1)]
    for n in range(1, 2 * count):
        numbers.append(-sum(math.comb(n + 1, k) * b for k, b in enumerate(numbers)) / (n + 1))
    return numbers[::2]


def over_factorial(numbers, first):
    return [Fraction(b) / math.factorial(first + 2 * k) for k, b in enumerate(numbers)]


SIGNS = [(-1) ** (k + 1) for k in range(20)]
HALF_COTH = over_factorial(bernoulli(30), 0)[1:]  # (r/2 coth(r/2) - 1)/z
FINE = [
    Fine("sine_48", over_factorial(SIGNS, 3), 2.4684, 7),
    Fine("cosine_48", over_factorial(SIGNS, 2), 2.4684, 8),
    Fine("cotangent_48", [b * (-4) ** (k + 1) for k, b in enumerate(HALF_COTH)], 0.6173, 8),
    Fine("half_coth_48", HALF_COTH, 0.1205, 5),
]


def fine_coefficients(p):
    """Lowest power first, of the polynomial that is right at Chebyshev's nodes."""
    nodes = [Fraction(p.last / 2 * (1 - math.cos(math.pi * (i + 0.5) / p.count))) for i in range(p.count)]
    return [float(c) for c in solve([[x ** k for k in range(p.count)] for x in nodes], [value(p.terms, x) for x in nodes])]


def fine_error(p, coefficients):
    points = [Fraction(p.last * i / 40) for i in range(41)]
    return max(float(abs(x * (value(p.terms, x) - value(map(Fraction, coefficients), x)))) for x in points)


def solve(rows, right):
    """Gauss with pivots."""
    rows = [row + [value] for row, value in zip(rows, right)]
    n = len(rows)
    for i in range(n):
        best = max(range(i, n), key=lambda k: abs(rows[k][i]))
        rows[i], rows[best] = rows[best], rows[i]
        for k in range(i + 1, n):
            factor = rows[k][i] / rows[i][i]
            rows[k] = [b - factor * a for a, b in zip(rows[i], rows[k])]
    x = [0.0] * n
    for i in reversed(range(n)):
        x[i] = (rows[i][n] - sum(rows[i][j] * x[j] for j in range(i + 1, n))) / rows[i][i]
    return x


def value(coefficients, x):
    return sum(c * x ** i for i, c in enumerate(coefficients))


def chebyshev(p, count):
    middle, half = (p.first + p.last) / 2, (p.last - p.first) / 2
    return [middle - half * math.cos(math.pi * i / count) for i in range(count + 1)]


def largest_in_turn(errors):
    """The index of the largest error between two changes of sign."""
    found = []
    for i, error in enumerate(errors):
        if not found or (error > 0) != (errors[found[-1]] > 0):
            found.append(i)
        elif abs(error) > abs(errors[found[-1]]):
            found[-1] = i
    return found


def minimax(p):
    """Coefficients, lowest power first."""
    points, nodes = chebyshev(p, GRID), chebyshev(p, p.count)
    for _ in range(ROUNDS):
        rows = [[x ** k for k in range(p.count)] + [(-1) ** i / p.weight(x)] for i, x in enumerate(nodes)]
        coefficients = solve(rows, [p.function(x) for x in nodes])[:-1]
        errors = [p.weight(x) * (p.function(x) - value(coefficients, x)) for x in points]
        turns = largest_in_turn(errors)
        while len(turns) > p.count + 1:
            turns.pop(0 if abs(errors[turns[0]]) < abs(errors[turns[-1]]) else -1)
        if len(turns) < p.count + 1 or [points[i] for i in turns] == nodes:
            break
        nodes = [points[i] for i in turns]
    return coefficients


def rounded(x):
    return struct.unpack("f", struct.pack("f", x))[0]


def error(p, coefficients):
    return max(p.weight(x) * abs(p.function(x) - value(coefficients, x)) for x in chebyshev(p, GRID))


def in_c(name):
    """The coefficients that the compiler has, highest power first."""
    for path in ("functions/exponential.c", "functions/logarithm.c", "pairs/pair_circular.c", "pairs/pair_exponential.c"):
        text = (ROOT / "sw/compiler" / path).read_text(encoding="utf-8")
        found = re.search(rf"static const double {name}\[\] = {{(.*?)}};", text, re.S)
        if found:
            return [float(word) for word in found[1].replace("\n", " ").split(",")]
    return []


def main():
    wrong = []
    for p in POLYNOMIALS:
        exact = minimax(p)
        coefficients = [rounded(c) for c in exact]
        print(f"{p.name}: {error(p, exact):.2g} {error(p, coefficients):.2g}")
        print("   ", ", ".join(f"{c:.9g}" for c in reversed(coefficients)))
        if [rounded(c) for c in in_c(p.name)] != coefficients[::-1]:
            wrong.append(p.name)
    for p in FINE:
        coefficients = fine_coefficients(p)
        print(f"{p.name}: as doubles {fine_error(p, coefficients):.2g}")
        print("   ", ", ".join(f"{c!r}" for c in reversed(coefficients)))
        if in_c(p.name) != coefficients[::-1]:
            wrong.append(p.name)
    if "--check" in sys.argv[1:] and wrong:
        sys.exit("polynomials.py: not as in sw/compiler: " + ", ".join(wrong))


if __name__ == "__main__":
    main()
