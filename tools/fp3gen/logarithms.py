"""The tables of logarithmic arithmetic: quadratics that rtl/lns/lns_*.v and sw/machine/lns.c evaluate.

docs/logarithmic.md says what they are for. Every function value comes from decimal, whose exp and ln are correctly rounded, so each
machine makes the same tables. A quadratic goes through the function at three Chebyshev nodes. Its coefficients are then rounded,
from the highest to the lowest; each absorbs what it can of the error of those before it.
"""

import decimal
import functools
import math

UNIT = 2.0 ** 28          # sums of table values are counted in 2^-28
HALF = 16                 # half of the last place of a result, in these
NODES = (0.5 - math.sqrt(3) / 4, 0.5, 0.5 + math.sqrt(3) / 4)
ENDS = (0.0, 1.0)
CONTEXT = decimal.Context(prec=34)
LN2 = CONTEXT.ln(decimal.Decimal(2))


def power(x):
    """2^x"""
    return CONTEXT.exp(CONTEXT.multiply(decimal.Decimal(x), LN2))


def log(x):
    return CONTEXT.divide(CONTEXT.ln(x), LN2)


def of_sum(r):
    """log2(1 + 2^-r)"""
    return float(log(CONTEXT.add(1, power(-r))))


def of_difference(r):
    """r < 4: 2 + log2((1 - 2^-r) / r), which is smooth where log2(1 - 2^-r) is not; above: -log2(1 - 2^-r)."""
    if r == 0:
        return float(CONTEXT.add(2, log(LN2)))
    rest = CONTEXT.subtract(1, power(-r))
    return float(CONTEXT.add(2, log(CONTEXT.divide(rest, decimal.Decimal(r))))) if r < 4 else -float(log(rest))


def of_log(x):
    """log2(1 + x) - x"""
    return float(CONTEXT.subtract(log(CONTEXT.add(1, decimal.Decimal(x))), decimal.Decimal(x)))


def of_power(x):
    """1 + x - 2^x"""
    return float(CONTEXT.subtract(CONTEXT.add(1, decimal.Decimal(x)), power(x)))


def fit(function, start, width):
    """(u, value) at nodes and ends of an interval, and the quadratic's first two coefficients, of u and u^2 in 0 .. 1."""
    # The end of an interval is approached from inside: another function may begin there.
    points = [(u, function(start + u * width * (1 - 2.0 ** -40))) for u in (*NODES, *ENDS)]
    (u0, y0), (u1, y1), (u2, y2) = points[:3]
    second = ((y2 - y1) / (u2 - u1) - (y1 - y0) / (u1 - u0)) / (u2 - u0)
    return points, second


def slope(points, curve):
    """Of the line through what a rounded coefficient of u^2 leaves at the outer nodes."""
    (u0, y0), (u2, y2) = points[0], points[2]
    return (y2 - y0) / (u2 - u0) - curve * (u0 + u2)


def centre(points, linear, curve):
    """The constant that makes the errors on both sides equal."""
    errors = [y - linear * u - curve * u * u for u, y in points]
    return (max(errors) + min(errors)) / 2


def sum_interval(word):
    """Where the interval of a word starts, its width: 256 below 8, 128 up to 16, 128 up to 32."""
    if word < 256:
        return word / 32, 1 / 32
    return (8 + (word - 256) / 16, 1 / 16) if word < 384 else (16 + (word - 384) / 8, 1 / 8)


@functools.cache
def sums():
    """1,024 words of a sum, then a difference: c0 - c1 * u + (c2 * u + c3) * u, c0 signed in 2^-28, c1 in 2^-24, c2 in 2^-25, c3 in 2^-31.

    c0 contains the half that rounds the result, or where a difference is inverted (r >= 4), what an inversion of all bits needs.
    """
    words = []
    for function in (of_sum, of_difference):
        for word in range(512):
            start, width = sum_interval(word)
            points, second = fit(function, start, width)
            c2, c1 = max(0, round(second * 2.0 ** 25)) + 1, 1 << 18
            while c1 >> 18:                         # the first interval of a sum would need 2^18
                c2 -= 1
                fall = max(0, round(-slope(points, c2 / 2.0 ** 25) * 2.0 ** 31))
                c1 = -(-fall // 128)
            rounds = -HALF - 1 if function is of_difference and start >= 4 else HALF
            c0 = round(centre(points, -fall / 2.0 ** 31, c2 / 2.0 ** 25) * UNIT) + rounds
            words.append((c0, c1, c2, c1 * 128 - fall))
    return words


@functools.cache
def curves():
    """1,024 words of log2(1 + x) - x, then 1 + x - 2^x, x in 0 .. 1: c0 + c1 * v - c2 * v^2, c0 and c2 in 2^-28, c1 signed in 2^-27.

    At x = 0 both are 0.
    """
    words = []
    for function in (of_log, of_power):
        for word in range(512):
            points, second = fit(function, word / 512, 1 / 512)
            c2 = round(-second * UNIT)
            linear = slope(points, -c2 / UNIT)
            c1 = round(linear * 2.0 ** 27)
            c0 = 0 if word == 0 else round(centre(points, linear, -c2 / UNIT) * UNIT)
            words.append((c0, c1, c2))
    return words


SUM_BITS = (30, 18, 12, 7)
CURVE_BITS = (25, 18, 10)


def packed(words, bits):
    """Each word's coefficients in one number, the first on top."""
    def pack(word):
        number = 0
        for value, width in zip(word, bits):
            number = number << width | value & (1 << width) - 1
        return number
    return [pack(word) for word in words]
