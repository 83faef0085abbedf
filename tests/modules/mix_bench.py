"""mix against the same in Python, a number in each cycle."""

import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge

ALL = 0xffffffff


def mixed(x):
    x = (~x + (x << 15)) & ALL
    x ^= x >> 12
    x = (x + (x << 2)) & ALL
    x ^= x >> 4
    x = x * 2057 & ALL
    return x ^ x >> 16


@cocotb.test()
async def mix_mixes(dut):
    chance, due = random.Random(1), []
    cocotb.start_soon(Clock(dut.clk_i, 10, "ns").start())
    for number in [0, 1, ALL, *(1 << i for i in range(32)), *(chance.getrandbits(32) for _ in range(500)), 0, 0, 0, 0]:
        await FallingEdge(dut.clk_i)
        if len(due) == 4:
            asked = due.pop(0)
            assert dut.mixed_o.value == mixed(asked), f"{asked:#010x}: {dut.mixed_o.value.integer:#010x}, expected {mixed(asked):#010x}"
        dut.number_i.value = number
        due.append(number)
