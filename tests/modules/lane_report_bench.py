"""lane_report against its header: what a lane adds to the report of those before it."""

import collections
import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge

from bundles import Bundle, seen

OBJECT, STATUS = 0, 1                                      # host/lane_host.vh


async def reports(dut, cycles, seed):
    """(what this lane was told, what the lane before said, what is reported) of each cycle after the first ones. The lane before is in step."""
    chance, report = random.Random(seed), Bundle(dut, "REPORT")
    cocotb.start_soon(Clock(dut.clk_i, 10, "ns").start())
    told, before = collections.deque(maxlen=5), collections.deque(maxlen=5)
    for cycle in range(cycles):
        dut.rst_i.value = int(cycle < 6)
        now = {"count_i": chance.randrange(1 << len(dut.count_i)), "longest_i": chance.randrange(1 << len(dut.longest_i)), "flags_i": chance.choice((0, 1 << chance.randrange(5))),
               "valid_i": int(cycle > 8 and chance.random() < 0.5), "batch_i": chance.randrange(2), "context_i": chance.randrange(1 << len(dut.context_i)),
               "asleep_i": chance.randrange(2), "mine_i": int(chance.random() < 0.3), "space_i": chance.randrange(7), "copied_i": 0,
               "stored_i": chance.getrandbits(32), "status_i": chance.getrandbits(32),
               "raised_i": chance.randrange(2), "no_room_i": chance.randrange(2)}
        told.appendleft(now)
        now["copied_i"] = int(not (len(told) > 3 and told[3]["mine_i"]) and chance.random() < 0.3)
        asked = len(told) > 3 and told[3]["mine_i"] or now["copied_i"]       # the answers of lanes that are not asked are 0
        news = told[2] if len(told) > 2 else dict.fromkeys(now, 0)
        before.appendleft({"count": chance.randrange(1 << len(dut.count_i)), "longest": chance.randrange(1 << len(dut.longest_i)), "flags": chance.choice((0, 1 << chance.randrange(5))),
                           "answer": 0 if asked else chance.choice((0, chance.getrandbits(32))), "asleep": chance.randrange(2),
                           "raised": chance.randrange(2), "no_room": chance.randrange(2), "valid": news["valid_i"], "batch": news["batch_i"], "context": news["context_i"]})
        for name, value in now.items():
            getattr(dut, name).value = value
        dut.report_i.value = report.pack(**before[0])
        await FallingEdge(dut.clk_i)
        if cycle > 12:
            yield told, before, report.fields_of(seen(dut.report_o))
        await RisingEdge(dut.clk_i)


@cocotb.test()
async def lane_report_is_asleep_only_where_every_lane_is(dut):
    found = collections.Counter()
    async for told, before, got in reports(dut, 200, 1):
        assert got["asleep"] == (before[0]["asleep"] and told[0]["asleep_i"])
        assert (got["valid"], got["batch"], got["context"]) == (told[2]["valid_i"], told[2]["batch_i"], told[2]["context_i"])
        found[got["asleep"], before[0]["asleep"], told[0]["asleep_i"]] += 1
    assert len(found) == 4


@cocotb.test()
async def lane_report_has_the_largest_count_and_all_flags(dut):
    async for told, before, got in reports(dut, 200, 2):
        assert got["count"] == max(before[1]["count"], told[1]["count_i"])
        assert got["longest"] == max(before[1]["longest"], told[1]["longest_i"])
        assert got["flags"] == before[0]["flags"] | told[0]["flags_i"]
        assert got["raised"] == before[0]["raised"] | told[0]["raised_i"] and got["no_room"] == before[0]["no_room"] | told[0]["no_room_i"]


@cocotb.test()
async def lane_report_answers_the_host_for_its_lane(dut):
    async for told, before, got in reports(dut, 400, 3):
        own = {OBJECT: told[0]["stored_i"], STATUS: told[0]["status_i"]}.get(told[3]["space_i"], told[0]["count_i"])
        own = told[0]["stored_i"] if told[0]["copied_i"] else own
        assert got["answer"] == before[0]["answer"] | (own if told[3]["mine_i"] or told[0]["copied_i"] else 0)
