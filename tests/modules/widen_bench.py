"""widen: every number of both formats."""

import os
import struct

import cocotb
from cocotb.triggers import Timer


def expected(narrow):
    if os.environ["FP3_STORAGE"] == "1":
        return narrow << 16
    if narrow & 0x7c00 == 0x7c00:
        return narrow >> 15 << 31 | 0x7f800000 | (narrow & 0x3ff) << 13
    return struct.unpack("<I", struct.pack("<f", struct.unpack("<e", struct.pack("<H", narrow))[0]))[0]


@cocotb.test()
async def widen_keeps_every_number(dut):
    for narrow in [*range(0x440), *range(0x440, 0x10000, 61), *range(0x7bf0, 0x8010)]:
        dut.narrow_i.value = narrow
        await Timer(1, "ns")
        assert dut.word_o.value == expected(narrow), f"{narrow:#06x}: {dut.word_o.value.integer:#010x}, expected {expected(narrow):#010x}"
