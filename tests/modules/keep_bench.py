"""keep against its header: what goes to a list that is made, what becomes of the list's word, who raises a flag."""

import collections
import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge

LENGTH, NO_ROOM, AHEAD = 20, 0xfff, 4
CYCLES = 3000


class Instruction:
    """`keep`, `raise` or neither, and what they are told."""

    def __init__(self, chance, rows, store):
        self.kind = chance.choice(("keep", "keep", "raise", None))
        self.first, self.away = int(chance.random() < 0.3), int(chance.random() < 0.2)
        self.other = chance.randrange(rows)
        self.place, self.length = chance.randrange(store), chance.choice((chance.randrange(6), chance.randrange(4096), NO_ROOM))
        self.room = chance.choice((chance.randrange(6), self.length, self.length + 1 & NO_ROOM)) | chance.choice((0, 0x5a5000))
        self.condition = chance.choice((0, 1 << 31, 0x3f800000, 0xbf800000, 0x7fc00000, chance.getrandbits(32)))
        self.word = self.length << LENGTH | self.place if self.kind != "raise" else self.condition

    def ends(self):
        """(place and row that are written, or nothing; the list's word; a flag is raised; there is no room)"""
        if self.kind != "keep":
            return None, None, self.kind == "raise" and not self.away and self.word >> 31 == 1, False
        length, room = 0 if self.first else self.length, self.room & NO_ROOM
        takes = not self.away and self.condition >> 31 == 1
        full = takes and length >= room
        return (self.place + length, self.other) if takes and not full else None, \
            (NO_ROOM if full else length + takes) << LENGTH | self.place, False, full


async def instructions(dut, seed):
    """The instructions of the last cycles, the newest first."""
    chance, rows, store = random.Random(seed), 1 << len(dut.other_r3_i), 1 << len(dut.place_o)
    cocotb.start_soon(Clock(dut.clk_i, 10, "ns").start())
    told = collections.deque([Instruction(chance, rows, store) for _ in range(8)], maxlen=8)
    for cycle in range(CYCLES):
        dut.rst_i.value = int(cycle < 8)
        told.appendleft(Instruction(chance, rows, store))
        now, late, later = told[1], told[3], told[4]       # in cycles 0, 2 and 3: the newest is a cycle before its own
        dut.keep_i.value, dut.raise_i.value, dut.first_i.value = int(now.kind == "keep"), int(now.kind == "raise"), now.first
        dut.other_r3_i.value = told[0].other
        dut.away_i2_i.value = late.away
        dut.list_i3_i.value, dut.room_i3_i.value, dut.takes_i3_i.value = later.word, later.room, later.condition >> 31
        await FallingEdge(dut.clk_i)
        if cycle > 20:
            yield told[4], told[5]
        await RisingEdge(dut.clk_i)


@cocotb.test()
async def keep_writes_the_rows_of_others(dut):
    assert int(dut.AHEAD.value) == AHEAD
    found = collections.Counter()
    async for now, _ in instructions(dut, 1):
        written = now.ends()[0]
        assert dut.write_o.value == int(written is not None)
        if written:
            assert (int(dut.place_o.value), int(dut.row_o.value)) == (written[0] % (1 << len(dut.place_o)), written[1])
        found[now.kind, written is not None, now.first] += 1
    assert min(found["keep", True, 0], found["keep", True, 1]) > 50


@cocotb.test()
async def keep_counts_the_entries(dut):
    found = collections.Counter()
    async for _, before in instructions(dut, 2):
        _, word, raised, full = before.ends()
        assert dut.keeps_i4_o.value == int(before.kind == "keep")
        if word is not None:
            assert int(dut.list_i4_o.value) == word % (1 << 32), f"{int(dut.list_i4_o.value):08x} instead of {word:08x}"
        assert (dut.raised_o.value, dut.no_room_o.value) == (int(raised), int(full))
        found[raised, full] += 1
    assert min(found[True, False], found[False, True]) > 50
