"""tile as its host sees it: each object gets the steps of its visits, whatever batch it is in and whenever the run is stopped. The
program adds and multiplies small integers, so a model in Python has the same values."""

import collections
import random
import struct

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge

from bundles import Bundle, seen

CONTROL, STATUS, RECORD, STEPS, STEP, LAST, SIZE, VISIT = 0x10, 0x14, 0x18, 0x20, 0x24, 0x28, 0x2c, 0x38
CONSTANTS, AWAKE, PROGRAM, OBJECTS = 0x2000, 0x3000, 0x8000, 2 << 16
START, STOP, RUNNING, DONE = 1, 2, 1, 2                    # bits of CONTROL, and of STATUS
ADD, MUL, LD, ST = 1, 3, 7, 9
K = 64                                                     # the first constant, as an operand
# Sums in registers of even number, products in those of odd number, so that it runs with two streams, too.
LOADS = [(LD, d, 0, 0) for d in (1, 0, 3, 2)]
WORK = [(ADD, 0, 0, K), (MUL, 1, 1, K + 1), (ADD, 2, 2, 1), (MUL, 3, 0, K + 1)]
STORES = [(ST, d, 0, 0) for d in (1, 0, 3, 2)]


def word(op, d, a, b):
    return op << 27 | d << 21 | a << 14 | b << 7


def after(steps, r0, r1, r2, r3):
    """What WORK makes of the four registers, so many times; the constants are 1 and 2."""
    for _ in range(steps):
        r0, r1 = r0 + 1, 2 * r1
        r2, r3 = r2 + r1, 2 * r0
    return [r0, r1, r2, r3]


class Bench:
    def __init__(self, dut, seed):
        self.dut, self.chance, self.answer = dut, random.Random(seed), Bundle(dut, "ANSWER")
        self.contexts, self.lanes, self.store = (int(getattr(dut, name).value) for name in ("CONTEXTS", "LANES", "STORE_WORDS"))
        self.objects = {}                                  # (lane, row): what the host wrote

    async def start(self):
        dut = self.dut
        cocotb.start_soon(Clock(dut.clk_i, 10, "ns").start())
        for name in ("req_valid_i", "req_write_i", "req_addr_i", "req_wdata_i"):
            getattr(dut, name).value = 0
        dut.rst_i.value = 1
        await self.idle(64)
        dut.rst_i.value = 0
        for at, value in enumerate(LOADS + WORK + STORES):
            await self.write(PROGRAM + 4 * at, word(*value))
        for at, value in ((STEP, len(LOADS)), (LAST, len(LOADS + WORK)), (SIZE, len(LOADS + WORK + STORES)), (RECORD, 3)):
            await self.write(at, value)
        for n, value in enumerate((1, 2)):
            await self.write(CONSTANTS + 4 * n, number(value))

    async def idle(self, cycles):
        for _ in range(cycles):
            await RisingEdge(self.dut.clk_i)

    async def request(self, write, address, data):
        """One at a time; its address and its data stand until the answer."""
        dut = self.dut
        dut.req_valid_i.value, dut.req_write_i.value, dut.req_addr_i.value, dut.req_wdata_i.value = 1, write, address, data
        await RisingEdge(dut.clk_i)
        dut.req_valid_i.value = 0
        for _ in range(64):
            await FallingEdge(dut.clk_i)
            got = self.answer.fields_of(seen(dut.answer_o))
            await RisingEdge(dut.clk_i)
            if got["wrote"] or got["read"]:
                assert (got["wrote"], got["read"]) == (write, 1 - write)
                return got
        raise AssertionError(f"no answer from 0x{address:x}")

    async def write(self, address, data, refused=0):
        got = await self.request(1, address, data)
        assert got["write_error"] == refused, f"a write of 0x{data:x} to 0x{address:x} is{' not' if refused else ''} refused"

    async def read(self, address):
        got = await self.request(0, address, 0)
        assert not got["read_error"], f"a read from 0x{address:x} is refused"
        return got["rdata"]

    def spot(self, lane, row, register):
        return OBJECTS | (lane * self.store + 8 * row + register) << 2

    async def set_up(self, counts):
        """So many objects in each lane; the row behind them is of nobody."""
        for lane, count in enumerate(counts):
            await self.write(AWAKE + 4 * lane, count)
            for row in range(count + 1):
                self.objects[lane, row] = [1 + self.chance.randrange(1000) for _ in range(4)]
                for register, value in enumerate(self.objects[lane, row]):
                    await self.write(self.spot(lane, row, register), number(value))

    async def run(self, steps, visit, stop_after=None):
        """The status at its end."""
        for at, value in ((STEPS, steps), (VISIT, visit), (CONTROL, START)):
            await self.write(at, value)
        if stop_after is not None:
            await self.idle(stop_after)
            await self.write(CONTROL, STOP)
        for _ in range(500):
            if not (status := await self.read(STATUS)) & RUNNING:
                return status
        raise AssertionError("the run does not end")

    async def held(self, lane, row):
        return [struct.unpack("f", struct.pack("I", await self.read(self.spot(lane, row, register))))[0] for register in range(4)]


def number(value):
    return struct.unpack("I", struct.pack("f", value))[0]


@cocotb.test()
async def tile_steps_each_object_of_each_batch(dut):
    """Three batches, the last of them not full and not as long in every lane; what is behind the last object stays."""
    bench = Bench(dut, 1)
    await bench.start()
    counts = [3 * bench.contexts - 1 - 2 * lane for lane in range(bench.lanes)]
    await bench.set_up(counts)
    assert await bench.run(5, 2) == DONE
    for (lane, row), first in bench.objects.items():
        steps = 5 if row < counts[lane] else 0
        assert await bench.held(lane, row) == after(steps, *first), f"lane {lane}, row {row}"


@cocotb.test()
async def tile_is_stopped_between_visits(dut):
    """Stopped at any moment, each object is as one of its visits left it: all that a visit stores, or nothing of it."""
    bench = Bench(dut, 2)
    await bench.start()
    stopped = collections.Counter()
    for _ in range(12):
        if not stopped["runs"] % 6:                        # numbers stay small enough to be exact
            await bench.set_up([bench.contexts + 1] * bench.lanes)
            made = dict.fromkeys(bench.objects, 0)
        stopped["runs"] += 1
        stopped["early"] += await bench.run(2, 1, bench.chance.randrange(500)) != DONE
        for (lane, row), first in bench.objects.items():
            now = await bench.held(lane, row)
            visits = int(now[0]) - first[0]
            assert now == after(visits, *first), f"lane {lane}, row {row}: {now} is half of a visit"
            assert 0 <= visits - made[lane, row] <= 2
            made[lane, row] = visits
    assert stopped["early"] > stopped["runs"] // 2


@cocotb.test()
async def tile_refuses_a_record_out_of_range(dut):
    bench, kept = Bench(dut, 3), 3
    await bench.start()
    for value in (*range(64), *(3 | 1 << bit for bit in range(3, 32)), *(1 << bit for bit in range(3, 32)), 0xffffffff):
        refused = not 3 <= value <= 6
        await bench.write(RECORD, value, refused)
        kept = kept if refused else value
        assert await bench.read(RECORD) == kept
