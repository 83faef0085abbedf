"""widen: every number of both formats."""

import os
import struct

import cocotb
from cocotb.triggers import Timer


def expected(half):
    if os.environ["FP3_STORAGE"] == "1":
        return half << 16
    if half & 0x7c00 == 0x7c00:
        return half >> 15 << 31 | 0x7f800000 | (half & 0x3ff) << 13
    return struct.unpack("<I", struct.pack("<f", struct.unpack("<e", struct.pack("<H", half))[0]))[0]


@cocotb.test()
async def widen_keeps_every_number(dut):
    for half in [*range(0x440), *range(0x440, 0x10000, 61), *range(0x7bf0, 0x8010)]:
        dut.half_i.value = half
        await Timer(1, "ns")
        assert dut.word_o.value == expected(half), f"{half:#06x}: {dut.word_o.value.integer:#010x}, expected {expected(half):#010x}"
