"""counters against its header: every event counts once, two cycles later; a clear forgets those of its cycle and of the one before."""

import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge, Timer


async def drive(dut, cycles, clears, far=False):
    chance, n = random.Random(1), dut.N.value
    cocotb.start_soon(Clock(dut.clk_i, 10, "ns").start())
    dut.clear_i.value, dut.event_i.value, dut.read_i.value, dut.index_i.value, dut.high_i.value = 1, 0, 0, 0, 0
    await RisingEdge(dut.clk_i)
    await RisingEdge(dut.clk_i)
    count, events, due = [0] * n, 0, None
    if far:                                                # nearly at the end of the low word, with the uppermost bit
        await FallingEdge(dut.clk_i)
        dut.clear_i.value = 0
        for k in range(n):
            count[k] = (1 << 47) + (1 << 32) - 3 - k
            dut.g_counter[k].count_q.value = count[k]
        await Timer(1, "ns")
    for _ in range(cycles):
        if not far:
            await FallingEdge(dut.clk_i)
        clear, now = chance.random() < clears, chance.getrandbits(n)
        index, high = chance.randrange(n), chance.randrange(2)
        dut.clear_i.value, dut.event_i.value, dut.index_i.value, dut.high_i.value = int(clear), now, index, high
        dut.read_i.value = 1
        await Timer(1, "ns")
        if due is not None:
            assert dut.value_o.value == due[1], f"counter {due[0]} shows {dut.value_o.value.integer}, not {due[1]}"
        due = (index, count[index] >> 32 * high & 0xffffffff)
        count = [0 if clear else old + (events >> k & 1) for k, old in enumerate(count)]
        events = 0 if clear else now
        await RisingEdge(dut.clk_i)
        far = False


@cocotb.test()
async def counters_count_each_event(dut):
    await drive(dut, 1500, 0.02)


@cocotb.test()
async def counters_forget_at_a_clear(dut):
    await drive(dut, 1500, 0.3)


@cocotb.test()
async def counters_have_a_high_word(dut):
    await drive(dut, 400, 0, far=True)
