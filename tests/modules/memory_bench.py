"""The memories of lib/ against their headers: contents at power-up, latency, and a read in the cycle of a write.

FP3_LATENCY: cycles from an address to its word. FP3_FORWARD: a read sees the write of its own cycle. FP3_ENABLE: there is a read_i.
"""

import os
import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge, Timer

LATENCY, FORWARD, ENABLE = (int(os.environ[name]) for name in ("FP3_LATENCY", "FP3_FORWARD", "FP3_ENABLE"))


async def accesses(dut, pairs):
    """pairs: of each cycle, (address to read or None, (address, word) to write or None). Checks each word that is shown."""
    words, pipe, held = {}, [], None
    cocotb.start_soon(Clock(dut.clk_i, 10, "ns").start())
    dut.write_i.value = 0
    await RisingEdge(dut.clk_i)
    for read, write in pairs:
        await FallingEdge(dut.clk_i)
        dut.write_i.value = int(write is not None)
        if write is not None:
            dut.write_addr_i.value, dut.write_value_i.value = write
        if ENABLE:
            dut.read_i.value = int(read is not None)
        if read is not None:
            dut.read_addr_i.value = read
        await Timer(1, "ns")
        if LATENCY == 0:
            pipe, held = [], words.get(read, 0) if read is not None else None
        if held is not None:
            assert dut.read_value_o.value == held, f"{held:#x} is expected, {dut.read_value_o.value.integer:#x} is there"
        if read is not None and LATENCY:
            seen = write[1] if FORWARD and write and write[0] == read else words.get(read, 0)
            same = not FORWARD and LATENCY == 2 and write and write[0] == read                # anything, says the header
            pipe.append(None if same else seen)
            if len(pipe) == LATENCY:
                held = pipe.pop(0)
        elif LATENCY and not ENABLE:
            held = None
        if write is not None:
            words[write[0]] = write[1]
        await RisingEdge(dut.clk_i)


@cocotb.test()
async def memory_is_zero_at_power_up(dut):
    size = 1 << dut.ADDR_W.value
    await accesses(dut, [(i, None) for i in range(size)] + [(0, None)] * 2)


@cocotb.test()
async def memory_keeps_what_is_written(dut):
    chance, bits, width = random.Random(1), dut.ADDR_W.value, dut.W.value
    near = [0, 1, 1 << bits - 1, (1 << bits - 1) + 1, (1 << bits) - 1]

    def address():
        return chance.choice(near) if chance.random() < 0.7 else chance.randrange(1 << bits)
    await accesses(dut, [(address() if not ENABLE or chance.random() < 0.7 else None,
                          (address(), chance.getrandbits(width)) if chance.random() < 0.6 else None) for _ in range(3000)])
