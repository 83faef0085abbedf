"""A master of AXI4-Lite that is not ours (cocotbext-axi) attacks the processor: legal and illegal transfers, several under way, reads and writes
at once, with pauses at random in every channel. test_bus.py starts it inside the simulator.

FP3_TRANSFERS: how many. FP3_SEED: of the chance. FP3_MAP: isa/registers.toml. FP3_RUN: a file of what there is, of the writes
before a run, and of what it ends with, as JSON.
"""

import json
import os
import random
import tomllib
from pathlib import Path

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, Timer, with_timeout
from cocotbext.axi import AxiLiteBus, AxiLiteMaster, AxiResp

TRANSFERS = int(os.environ["FP3_TRANSFERS"])
SEED = int(os.environ["FP3_SEED"])
MAP = tomllib.loads(Path(os.environ["FP3_MAP"]).read_text())
AT = {row["name"]: row["at"] for row in MAP["register"] + MAP["window"]}
RUN = json.loads(Path(os.environ["FP3_RUN"]).read_text())
SPACE = 1 << RUN["space_bit"]                              # bytes
COPIES, OBJECTS, STATUS = (SPACE * next(row["at"] for row in MAP["space"] if row["name"] == name) for name in ("copies", "objects", "status"))
REGISTERS, WORDS = RUN["registers"], RUN["memory"]
NOWHERE = SPACE // 2                                       # from here on no lane has words, of objects or their status
HANG = 60_000                                              # ns; an access takes some 300, and a dozen may be before it


class Processor:
    """What a host knows of it: the words that it wrote and may read again, and what has to be refused."""

    def __init__(self, dut, chance):
        self.master = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "s_axi"), dut.s_axi_aclk, dut.s_axi_aresetn, reset_active_level=False)
        self.chance, self.words, self.count = chance, {}, 0
        for channel in (self.master.write_if.aw_channel, self.master.write_if.w_channel, self.master.write_if.b_channel,
                        self.master.read_if.ar_channel, self.master.read_if.r_channel):
            channel.set_pause_generator(self.pauses())

    def pauses(self):
        while True:
            rate = self.chance.choice((0, 0.1, 0.5, 0.9))
            for _ in range(self.chance.randrange(1, 60)):
                yield self.chance.random() < rate

    async def write(self, address, data, size=4):
        self.count += 1
        transfer = self.master.write(address, data.to_bytes(4, "little")[:size])
        return (await with_timeout(cocotb.start_soon(transfer), HANG, "ns")).resp

    async def read(self, address):
        self.count += 1
        got = await with_timeout(cocotb.start_soon(self.master.read(address, 4)), HANG, "ns")
        return got.resp, int.from_bytes(got.data, "little")

    async def put(self, address, data):
        assert await self.write(address, data) == AxiResp.OKAY, f"a write to {address:#x} was refused"

    async def get(self, address):
        resp, data = await self.read(address)
        assert resp == AxiResp.OKAY, f"a read of {address:#x} was refused"
        return data


def kept(chance):
    """An address that keeps what is written, and a value that it takes."""
    kind = chance.randrange(5)
    if kind == 0:
        return AT[chance.choice(("steps", "visit", "clock") if RUN["store"] else ("steps",))], chance.getrandbits(32)
    if kind == 1:
        return AT[chance.choice(("step", "last", "size"))], chance.randrange(WORDS + 1)
    if kind == 2:
        return AT["constants"] + 4 * chance.randrange(REGISTERS), chance.getrandbits(32)
    if kind == 3:
        return AT["interrupt"], chance.randrange(2)
    return of_an_object(chance), chance.getrandbits(32)


def of_an_object(chance):
    return OBJECTS + 4 * chance.randrange(RUN["words"])


def never_read(chance):
    return chance.choice((AT["control"], AT["program"] + 4 * chance.randrange(WORDS), AT["constants"] + 4 * REGISTERS,
                          OBJECTS + 4 * RUN["words"], OBJECTS + NOWHERE + 4 * chance.randrange(SPACE // 8),
                          chance.choice([at for at in range(0x4c, 0x80, 4) if at not in (AT["version"], AT["pending"], AT["pending_more"])]), COPIES + 4 * chance.randrange(SPACE // 4)))


def never_written(chance):
    return chance.choice((AT["id"], AT["shape"], AT["status"], AT["fault"], AT["flags"], AT["array"], AT["features_more"], AT["version"],
                          0x80 + 4 * chance.randrange(26), AT["program"] + 4 * (WORDS + chance.randrange(99)), AT["size"] + COPIES,
                          AT["constants"] + 4 * REGISTERS, STATUS + NOWHERE + 4 * chance.randrange(SPACE // 8),
                          *([] if RUN["store"] else [AT["wake"], AT["visit"], STATUS + 4 * chance.randrange(SPACE // 4)])))


async def together(transfers):
    """All of them begin in this order, and none waits for another one's response."""
    return [await task for task in [cocotb.start_soon(transfer) for transfer in transfers]]


async def several(cpu):
    """Many transfers under way, some of them illegal: each gets its own response."""
    chance = cpu.chance
    all_of_them = [AT["constants"] + 4 * r for r in range(REGISTERS)] + list({of_an_object(chance) for _ in range(REGISTERS)})
    where = chance.sample(all_of_them, chance.randrange(2, 12))
    legal = [chance.random() < 0.8 for _ in where]
    values = [chance.getrandbits(32) for _ in where]
    done = await together(cpu.write(at if good else never_written(chance), value) for at, good, value in zip(where, legal, values))
    assert done == [AxiResp.OKAY if good else AxiResp.SLVERR for good in legal], (where, legal, done)
    cpu.words.update({at: value for at, good, value in zip(where, legal, values) if good})
    known = [at if at in cpu.words else never_read(chance) for at in where]
    got = await together(cpu.read(at) for at in known)
    assert got == [(AxiResp.OKAY, cpu.words[at]) if at in cpu.words else (AxiResp.SLVERR, 0) for at in known], (known, got)


async def writer(cpu, left):
    chance = cpu.chance
    while cpu.count < left:
        kind = chance.randrange(9)
        address, value = kept(chance)
        if kind < 3:
            await cpu.put(address, value)
            cpu.words[address] = value
        elif kind == 3:                                    # an index that the program has no room for
            assert await cpu.write(AT[chance.choice(("step", "last", "size"))], WORDS + 1 + chance.getrandbits(30)) == AxiResp.SLVERR
            if RUN["store"]:                               # an object that has no row
                assert await cpu.write(AT[chance.choice(("awake", "wake"))], RUN["store"] + chance.getrandbits(31)) == AxiResp.SLVERR
        elif kind == 4:                                    # some bytes of a word
            size = chance.randrange(1, 4)
            assert await cpu.write(address + chance.randrange(5 - size), value, size) == AxiResp.SLVERR
        elif kind == 5:
            assert await cpu.write(never_written(chance), value) == AxiResp.SLVERR
        elif kind == 6:
            assert await cpu.write(AT["control"], 3) == AxiResp.SLVERR       # start and stop at once
        elif kind == 7:
            await several(cpu)
        elif cpu.words:
            address = chance.choice(list(cpu.words))
            assert await cpu.get(address) == cpu.words[address], f"{address:#x}"


async def reader(cpu, left):
    """Beside the writer: what never changes, and what there is not."""
    fixed = {AT[name]: await cpu.get(AT[name]) for name in ("id", "shape", "memory", "features", "features_more", "array", "store", "status")}
    assert fixed[AT["id"]] >> 8 == 0x465033
    while cpu.count < left:
        if cpu.chance.random() < 0.5:
            address = cpu.chance.choice(list(fixed))
            assert await cpu.get(address) == fixed[address]
        else:
            assert await cpu.read(never_read(cpu.chance)) == (AxiResp.SLVERR, 0)


async def load(cpu):
    for address, word in RUN["setup"]:
        await cpu.put(address, word)


async def refused_while_running(cpu, transfers):
    chance, status = cpu.chance, None
    await cpu.put(AT["steps"], 0xffffffff)
    await cpu.put(AT["interrupt"], 3)
    await cpu.put(AT["control"], 1)
    for _ in range(transfers):
        address, value = kept(chance)
        if chance.random() < 0.3:
            address = AT["program"] + 4 * chance.randrange(WORDS)
        if address != AT["interrupt"]:
            assert await cpu.write(address, value) == AxiResp.SLVERR, f"{address:#x} was written during a run"
        if address >= AT["constants"]:
            assert await cpu.read(address) == (AxiResp.SLVERR, 0)
        status = await cpu.get(AT["status"])
        assert status == 1
    await cpu.put(AT["control"], 2)
    while (status := await cpu.get(AT["status"])) & 1:
        pass
    assert status == 8


async def right_run(cpu, dut, quiet):
    """The processor is what it was: the program ends with the bits that it ends with elsewhere, and says so by its interrupt.
    quiet: nobody wants the interrupt until the end has been read."""
    await load(cpu)
    await cpu.put(AT["interrupt"], 2 if quiet else 3)
    assert dut.irq.value == 0
    await cpu.put(AT["control"], 1)
    if quiet:
        while await cpu.get(AT["status"]) & 1:
            assert dut.irq.value == 0
        await ClockCycles(dut.s_axi_aclk, 3)
        assert dut.irq.value == 0 and await cpu.get(AT["interrupt"]) == 2, "irq without enable"
        await cpu.put(AT["interrupt"], 1)
    for _ in range(100):
        if dut.irq.value == 1:
            break
        await ClockCycles(dut.s_axi_aclk, 100)
    assert dut.irq.value == 1 and await cpu.get(AT["status"]) == 2 and await cpu.get(AT["interrupt"]) == 3
    for address, bits in RUN["end"]:
        assert await cpu.get(address) == bits, f"{address:#x}"
    await cpu.put(AT["interrupt"], 2)
    await ClockCycles(dut.s_axi_aclk, 3)
    assert dut.irq.value == 0 and await cpu.get(AT["interrupt"]) == 0


async def a_failure_interrupts(cpu, dut):
    """Of numbers that are too large, long before the run ends; the write that disables it takes it back."""
    await load(cpu)
    for address in (address for address, _ in RUN["setup"] if address >= OBJECTS):
        await cpu.put(address, 0x7f7fffff)
    await cpu.put(AT["steps"], 0xffffffff)
    await cpu.put(AT["interrupt"], 0xe)
    await cpu.put(AT["control"], 1)
    for _ in range(100):
        if dut.irq.value == 1:
            break
        await ClockCycles(dut.s_axi_aclk, 100)
    assert dut.irq.value == 1 and await cpu.get(AT["status"]) == 1 and await cpu.get(AT["interrupt"]) == 0xc
    await cpu.put(AT["interrupt"], 0)
    await ClockCycles(dut.s_axi_aclk, 3)
    assert dut.irq.value == 0
    await cpu.put(AT["control"], 2)
    while await cpu.get(AT["status"]) & 1:
        pass
    await cpu.put(AT["interrupt"], 0xa)
    assert await cpu.get(AT["interrupt"]) == 0


@cocotb.test()
async def attack(dut):
    chance = random.Random(SEED)
    cpu = Processor(dut, chance)
    cocotb.start_soon(Clock(dut.s_axi_aclk, 10, "ns").start())
    dut.s_axi_aresetn.value = 0
    await Timer(95, "ns")
    dut.s_axi_aresetn.value = 1
    while cpu.count < TRANSFERS:
        left = min(TRANSFERS, cpu.count + 1000)
        both = [cocotb.start_soon(writer(cpu, left)), cocotb.start_soon(reader(cpu, left))]
        for task in both:
            await task
        await load(cpu)
        await refused_while_running(cpu, 20)
        cpu.words.clear()
        for quiet in (True, False):
            await right_run(cpu, dut, quiet)
    await a_failure_interrupts(cpu, dut)
    dut._log.info("%d transfers answered as they must be", cpu.count)
