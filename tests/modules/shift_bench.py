"""shift_right_sticky against its header: every amount, also beyond the width."""

import random

import cocotb
from cocotb.triggers import Timer


@cocotb.test()
async def shift_moves_by_every_amount(dut):
    chance, width, bits, unit = random.Random(1), dut.W.value, dut.N.value, dut.UNIT.value
    for n in range(1 << bits):
        for d in [0, 1, 1 << width - 1, (1 << width) - 1, *(1 << i for i in range(width)), *(chance.getrandbits(width) for _ in range(20))]:
            dut.d_i.value, dut.n_i.value = d, n
            await Timer(1, "ns")
            by = n * unit
            want = d >> by, int(d & (1 << by) - 1 != 0)
            assert (dut.q_o.value.integer, int(dut.sticky_o.value)) == want, f"{d:#x} by {by}"
