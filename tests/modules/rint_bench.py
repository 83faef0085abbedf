"""fp_rint against Python's round() and trunc()."""

import math
import random
import struct

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge


def bits(value):
    return struct.unpack("<I", struct.pack("<f", value))[0]


def number(word):
    return struct.unpack("<f", struct.pack("<I", word))[0]


def rounded(word, nearest):
    if word >> 23 & 255 >= 150:                            # no fraction, an infinity, or no number
        return word
    value = number(word)
    return bits(math.copysign(round(value) if nearest else math.trunc(value), value))


@cocotb.test()
async def rint_rounds_every_kind_of_number(dut):
    chance, nearest, cut = random.Random(1), dut.NEAREST.value, dut.CUT.value
    words = [bits(s * k / 8) for k in range(100) for s in (1.0, -1.0)]
    for e in range(118, 153):                              # near every integral value and half, for each place of the point
        for f in (0, 1, 0x400000, 0x7fffff, 0x200000, 0x600000, 0x3fffff, 0x400001):
            words += [e << 23 | f, 1 << 31 | e << 23 | f]
        words += [e << 23 | chance.getrandbits(23) & ~((1 << chance.randrange(24)) - 1) for _ in range(20)]
    words += [0, 1 << 31, 1, 0x007fffff, 0x00800000, 0x7f7fffff, 0x7f800000, 0xff800000, 0x7fc00000, 0x7f800001]
    words += [chance.getrandbits(32) for _ in range(500)]
    cocotb.start_soon(Clock(dut.clk_i, 10, "ns").start())
    due = []
    for word in [*words, 0, 0, 0]:
        await FallingEdge(dut.clk_i)
        if len(due) == 1 + cut:
            asked = due.pop(0)
            assert dut.z_o.value == rounded(asked, nearest), f"{asked:#010x} ({number(asked)}): {dut.z_o.value.integer:#010x}"
        dut.a_i.value = word
        due.append(word)
