"""hub against its header: who is asked and when, what comes back, and that nobody is asked or answered in reset."""

import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge, Timer

WROTE, READ = 1 << 35, 1 << 33
MASK = (1 << 36) - 1
PENDING = 0x70                                             # and 0x74: the registers that hub itself shows


@cocotb.test()
async def hub_asks_and_answers(dut):
    chance, n, quiet, stream = random.Random(1), dut.N.value, dut.QUIET.value, dut.STREAM.value
    cocotb.start_soon(Clock(dut.clk_i, 10, "ns").start())
    dut.rst_i.value = 1
    for name in ("req_valid_i", "req_write_i", "req_addr_i", "req_wdata_i", "answer_i", "irq_i"):
        getattr(dut, name).value = 0
    for _ in range(2):                                     # an answer is a register behind the one of its address
        await RisingEdge(dut.clk_i)
    asked, held, answer, ago, shows = 0, None, 0, quiet, False
    for _ in range(3000):
        await FallingEdge(dut.clk_i)
        reset = chance.random() < 0.3
        valid, write = chance.random() < 0.6, chance.randrange(2)
        who = chance.choice((*range(n + 1), 255, chance.randrange(n) ^ 1 << chance.randrange(8)))
        inside = chance.choice((chance.getrandbits(24), PENDING + chance.randrange(-4, 12)))
        address, data, irqs = who << 24 | inside, chance.getrandbits(32), chance.getrandbits(n)
        answers = [chance.getrandbits(36) if chance.random() < 0.5 else 0 for _ in range(n)]
        dut.rst_i.value, dut.req_valid_i.value, dut.req_write_i.value = int(reset), int(valid), write
        dut.req_addr_i.value, dut.req_wdata_i.value = address, data
        dut.answer_i.value, dut.irq_i.value = sum(word << 36 * i for i, word in enumerate(answers)), irqs
        await Timer(1, "ns")
        # What the last cycle asked for, in this one.
        assert dut.req_valid_o.value == asked
        if held:
            assert (dut.req_write_o.value, dut.req_addr_o.value, dut.req_wdata_o.value) == held
        got = dut.answer_o.value.integer
        assert got == (answer & ~(WROTE | READ) if reset else answer) & MASK, "an answer in reset, or another one"
        streams = bool(address & stream)
        taken = valid and (streams or ago >= quiet)
        assert dut.req_ready_o.value == int(not reset and (streams or ago >= quiet))
        nobody = who != 255 and who >= n
        answer = (irqs >> 32 * (held[1] >> 2 & 1) & 0xffffffff) if shows else 0
        for word in answers:
            answer |= word
        asked = 0 if reset or not taken else (1 if nobody else (1 << n) - 1 if who == 255 else 1 << who)
        shows = not reset and (not nobody and PENDING <= inside < PENDING + 8 if taken else shows)
        if taken:
            held = (write, 1 if nobody else address & 0xffffff, data)
        ago = quiet if reset else 0 if taken and write and streams else ago + 1
        await RisingEdge(dut.clk_i)
