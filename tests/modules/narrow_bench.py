"""narrow against exact arithmetic: to nearest and by draws, in both formats."""

import os
import random
import struct
from fractions import Fraction

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge

BITS, BIAS, NAN = {"1": (7, 127, 0x7fc0), "2": (10, 15, 0x7e00)}[os.environ["FP3_STORAGE"]]
INFINITY = (2 * BIAS + 1) << BITS


def number(word):
    return Fraction(struct.unpack("<f", struct.pack("<I", word))[0])


def expected(word, draw):
    """The narrow word, and whether a number became infinite. draw: None to nearest."""
    sign, size = word >> 31 << 15, word & 0x7fffffff
    if size >= 0x7f800000:
        return (NAN if size > 0x7f800000 else sign | INFINITY), False
    value, least = number(size), 1 - BIAS - BITS
    place = max((size >> 23) - 127 - BITS, least)
    units = value / Fraction(2) ** place
    rest = units - int(units)
    up = (rest > Fraction(1, 2) or (rest == Fraction(1, 2) and int(units) % 2)) if draw is None else int(rest * 65536) + draw > 65535
    count = int(units) + up
    narrow = count if place == least else (place - least << BITS) + count      # a subnormal number's place is that of the least normal ones
    return sign | min(narrow, INFINITY), narrow >= INFINITY


def words(chance):
    yield from (0, 1 << 31, 1, 0x7f7fffff, 0xff7fffff, 0x7f800000, 0xff800000, 0x7f800001, 0xffc00000, 0x007fffff, 0x00800000)
    for exponent in (*range(86, 116), *range(126, 130), *range(140, 145), 0, 1, 253, 254):
        for fraction in (0, 1, 0x7fffff, 0x1000, 0xfff, 0x1001, 0x8000, 0x7fff, 0x8001, 0x18000, 0x3000, 0x7ff000, 0x7fefff, 0x7f8000, 0x7f7fff):
            yield chance.getrandbits(1) << 31 | exponent << 23 | fraction
        yield from (chance.getrandbits(1) << 31 | exponent << 23 | chance.getrandbits(23) for _ in range(12))


@cocotb.test()
async def narrow_rounds_as_exact_arithmetic(dut):
    chance = random.Random(1)
    cocotb.start_soon(Clock(dut.clk_i, 10, "ns").start())
    given = [(word, draw) for word in words(chance) for draw in (None, 0, 0xffff, chance.getrandbits(16))] + 2 * [(0, None)]
    for i, (word, _) in enumerate(given):
        await FallingEdge(dut.clk_i)
        before = given[i - 1][1] if i else None              # a draw comes a cycle after its word
        dut.word_i.value = word
        dut.draws_i.value = before is not None
        dut.random_i.value = before or 0
        if i > 1:
            asked, narrow, over = given[i - 2], *expected(*given[i - 2])
            assert (dut.narrow_o.value, dut.over_o.value) == (narrow, over), \
                f"{asked[0]:#010x}, draw {asked[1]}: {dut.narrow_o.value.integer:#06x} {dut.over_o.value}, expected {narrow:#06x} {over}"
