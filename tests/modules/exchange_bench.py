"""exchange against its header: which lane says which word, and which lanes hear it WAY cycles later."""

import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge

from bundles import Bundle, seen, settings

OBJECT, EVERY = 0, 6                                       # host/lane_host.vh
ALL, LANE = 31, 20                                         # of a word of the list


class Bench:
    def __init__(self, dut, seed):
        self.dut, self.chance = dut, random.Random(seed)
        parameter = lambda name: int(getattr(dut, name).value)
        self.lanes, self.registers, self.store = (parameter(name) for name in ("LANES", "REGISTERS", "STORE_WORDS"))
        self.way = parameter("TIMING_END") + 1 + parameter("GROUPS")
        self.reach, self.around, self.access = (Bundle(dut, name) for name in ("REACH", "AROUND", "ACCESS"))
        self.record, self.published, self.half, self.list = 0, 0, 0, []

    async def start(self):
        dut = self.dut
        cocotb.start_soon(Clock(dut.clk_i, 10, "ns").start())
        for name in ("write_i", "write_addr_i", "write_value_i", "settings_i", "half_i", "copy_i", "abort_i"):
            getattr(dut, name).value = 0
        dut.rst_i.value = 1
        for _ in range(3):
            await RisingEdge(dut.clk_i)
        dut.rst_i.value = 0

    async def set_up(self, copies, words):
        """Any list, any published words."""
        dut, rows = self.dut, self.store // 8
        self.record, self.half = self.chance.randrange(4), self.chance.randrange(2)
        self.published = sum(1 << word for word in self.chance.sample(range(self.registers), words))
        self.list = [[(self.chance.randrange(self.lanes), self.chance.randrange(rows >> self.record), 0),
                      (self.chance.randrange(self.lanes), self.chance.randrange(rows >> self.record), self.chance.randrange(2))] for _ in range(copies)]
        for at, (lane, row, to_all) in enumerate(place for pair in self.list for place in pair):
            dut.write_i.value, dut.write_addr_i.value, dut.write_value_i.value = 1, at, to_all << ALL | lane << LANE | row
            await RisingEdge(dut.clk_i)
        dut.write_i.value = 0
        dut.settings_i.value, dut.half_i.value = settings(dut, record=self.record, published=self.published & 0xffffffff, published_more=self.published >> 32, copies=2 * copies), self.half
        for _ in range(3):
            await RisingEdge(dut.clk_i)

    def address(self, row, word):
        return (row << 3 + self.record | word) | self.half * self.store // 2

    async def copy(self, abort_at=None):
        """What the lanes hear, cycle by cycle, up to the end: those that say a word, and those that get one."""
        dut, says, gets, cycle, ended = self.dut, [], [], 0, None
        dut.copy_i.value = 1
        await RisingEdge(dut.clk_i)
        dut.copy_i.value = 0
        while ended is None or cycle < ended + 4 * self.way:
            dut.abort_i.value = int(cycle == abort_at)
            await FallingEdge(dut.clk_i)
            reach, access = self.reach.fields_of(seen(dut.reach_o)), self.access.fields_of(seen(dut.access_o))
            around = self.around.fields_of(reach["around"])
            busy = dut.busy_o.value == 1
            assert not any(reach[name] for name in ("valid", "load")), "an instruction reads"
            if reach["copy"]:
                assert busy and not any(around[name] for name in ("each", "entry", "ldn", "ldl", "inside"))
                says.append((cycle, around["turn"], reach["row"], around["offset"], around["half"]))
            if access["valid"]:
                assert busy and access["write"] == 1
                gets.append((cycle, access["space"], access["lane"], access["address"]))
            if dut.copied_o.value == 1:
                assert ended is None and abort_at is None
                ended = cycle
            if cycle == abort_at:
                ended = cycle + 1
            cycle += 1
            await RisingEdge(dut.clk_i)
        return says, gets, ended

    def check(self, says, gets, ended):
        words = [word for word in range(self.registers) if self.published >> word & 1]
        expected = [(word, *pair) for word in words for pair in self.list]
        assert [said[1:] for said in says] == [(lane, row, word, self.half) for word, (lane, row, _), _ in expected]
        for (said, *_), (got, space, lane, address), (word, _, to) in zip(says, gets, expected, strict=True):
            assert got == said + self.way, f"a word comes after {got - said} cycles"
            assert (space, address) == (EVERY if to[2] else OBJECT, self.address(to[1], word)) and (to[2] or lane == to[0])
        assert not gets or ended > gets[-1][0], "the end comes before the last copy"


@cocotb.test()
async def exchange_copies_each_published_word_of_the_list(dut):
    bench = Bench(dut, 1)
    await bench.start()
    for copies, words in ((1, 1), (3, 2), (1, bench.registers), (7, 3), (bench.store // 2, 1), (20, 4), (2, 5)):
        await bench.set_up(copies, words)
        bench.check(*await bench.copy())


@cocotb.test()
async def exchange_takes_a_cycle_for_each_copy(dut):
    bench, least = Bench(dut, 2), None
    await bench.start()
    for copies, words in ((0, 3), (3, 0), (0, 0), (1, 1), (9, 2), (30, 4)):
        await bench.set_up(copies, words)
        says, gets, ended = await bench.copy()
        bench.check(says, gets, ended)
        around = ended - (words * (copies + 2) if copies else 0)
        assert least in (None, around)
        least = around


@cocotb.test()
async def exchange_is_silent_after_an_abort(dut):
    bench = Bench(dut, 3)
    await bench.start()
    for abort in range(0, 30, 3):
        await bench.set_up(5, 3)
        says, gets, ended = await bench.copy(abort_at=abort)
        assert all(cycle <= abort for cycle, *_ in says + gets)
        await bench.set_up(4, 2)
        bench.check(*await bench.copy())
