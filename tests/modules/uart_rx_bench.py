"""uart_rx against its header: bytes, stop bits and breaks."""

import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge


@cocotb.test()
async def uart_rx_tells_a_bad_stop_bit(dut):
    chance, divisor, heard = random.Random(1), dut.DIVISOR.value, []
    cocotb.start_soon(Clock(dut.clk_i, 10, "ns").start())
    dut.rst_i.value, dut.rxd_i.value = 1, 1
    await ClockCycles(dut.clk_i, 3)
    dut.rst_i.value = 0

    async def listen():
        while True:
            await FallingEdge(dut.clk_i)
            if dut.valid_o.value == 1:
                heard.append((dut.byte_o.value.integer, int(dut.bad_o.value)))
    cocotb.start_soon(listen())

    async def send(byte, stop=1, rest=1):
        for bit in [0, *(byte >> i & 1 for i in range(8)), stop]:
            dut.rxd_i.value = bit
            await ClockCycles(dut.clk_i, divisor)
        dut.rxd_i.value = 1
        await ClockCycles(dut.clk_i, rest)
    told = []
    await ClockCycles(dut.clk_i, 3 * divisor)
    for _ in range(60):
        kind = chance.randrange(5)
        byte = chance.choice((0, 255, 0x55, 0xaa, chance.randrange(256)))
        if kind == 0:                                      # noise, another baud rate
            await send(byte, stop=0, rest=2 * divisor)
            told.append((byte, 1))
        elif kind == 1:                                    # a break of any length is one bad byte
            dut.rxd_i.value = 0
            await ClockCycles(dut.clk_i, divisor * chance.randrange(11, 40))
            dut.rxd_i.value = 1
            await ClockCycles(dut.clk_i, 2 * divisor)
            told.append((0, 1))
        else:                                              # nothing between two bytes
            await send(byte, rest=chance.choice((0, 0, 5)))
            told.append((byte, 0))
    await ClockCycles(dut.clk_i, 12 * divisor)
    assert heard == told
