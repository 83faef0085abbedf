"""slip_tx against RFC 1055, with pauses on the line and resets within an escape."""

import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge, Timer

END, ESCAPE = 0xc0, 0xdb


def escaped(byte):
    return {END: [ESCAPE, 0xdc], ESCAPE: [ESCAPE, 0xdd]}.get(byte, [byte])


@cocotb.test()
async def slip_tx_escapes_and_forgets_at_a_reset(dut):
    chance = random.Random(1)
    cocotb.start_soon(Clock(dut.clk_i, 10, "ns").start())
    dut.rst_i.value, dut.valid_i.value, dut.ready_i.value, dut.end_i.value, dut.byte_i.value = 1, 0, 0, 0, 0
    await RisingEdge(dut.clk_i)
    left, byte, end = [], None, False
    for _ in range(4000):
        await FallingEdge(dut.clk_i)
        reset = chance.random() < 0.05
        if reset:                                          # the packet is over; another one begins behind it
            left = []
        if not left:
            end, byte = chance.random() < 0.2, chance.choice((END, ESCAPE, 0xdc, 0xdd, chance.randrange(256)))
            left = [END] if end else escaped(byte)
        valid, ready = int(not reset and chance.random() < 0.8), chance.randrange(2)
        dut.rst_i.value, dut.valid_i.value, dut.ready_i.value, dut.end_i.value, dut.byte_i.value = int(reset), valid, ready, int(end), byte
        await Timer(1, "ns")
        if valid:
            assert dut.valid_o.value == 1 and dut.byte_o.value == left[0]
            assert dut.ready_o.value == int(ready and len(left) == 1)
            if ready:
                left.pop(0)
        await RisingEdge(dut.clk_i)
