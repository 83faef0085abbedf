"""master against its header, with a memory that somebody else wrote (cocotbext-axi) and a model of the hub.

Each word is moved once and in order, no byte outside of the range is written, no burst crosses 4 KB, every request is answered to who
asked, and a transfer ends whatever memory or the processor answers. All channels wait by chance, but in the test of speed.
"""

import os
import pathlib
import random
import tomllib

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge, with_timeout
from cocotbext.axi import AxiBus, AxiRam

REGISTERS = tomllib.loads(pathlib.Path(os.environ["FP3_MAP"]).read_text(encoding="utf-8"))["transfer"]
AT = {row["name"].removeprefix("transfer_"): row["at"] for row in REGISTERS}
LOAD, STORE, STAY, WAIT, LIST, LAST, AGAIN, OTHERWISE = 1, 2, 4, 8, 16, 32, 64, 128
RUN, SKIP = 8, 16                                          # their lowest bits
RUNNING, DONE, MEMORY_ERROR, REFUSED = 1, 2, 4, 8
STREAM, ALONE = 0x20000, 0x2000                            # places; with and without the bit of parameter STREAM
WROTE, WRITE_ERROR, READ, READ_ERROR = 1 << 35, 1 << 34, 1 << 33, 1 << 32
SIZE = 1 << 16                                             # bytes of memory
REST = 4


class Hub:
    """Takes requests when it likes, answers a write after 2 cycles and a read after 14."""

    def __init__(self, dut, chance):
        self.dut, self.chance, self.words, self.refused, self.asked = dut, chance, {}, set(), []
        self.due, self.cycle, self.rested, self.alone, self.waits = {}, 0, 0, False, 0.2

    async def run(self):
        dut = self.dut
        while True:
            answer = self.due.pop(self.cycle, 0)
            for i, name in enumerate(("read_error_i", "read_i", "write_error_i", "wrote_i")):
                getattr(dut, name).value = answer >> 32 + i & 1
            dut.rdata_i.value = answer & 0xffffffff
            dut.req_ready_i.value = int(self.chance.random() >= self.waits)
            await FallingEdge(dut.clk_i)
            if dut.req_valid_o.value == 1 and dut.req_ready_i.value == 1:
                write = dut.req_write_o.value == 1
                self.take(write, dut.req_addr_o.value.integer, dut.req_wdata_o.value.integer if write else 0)
            await RisingEdge(dut.clk_i)
            self.cycle += 1

    def take(self, write, address, data):
        streams = bool(address & STREAM)
        assert streams and not self.alone or self.cycle > self.rested, f"{address:#x} is asked for beside one that has to be alone"
        assert streams or not self.due, f"{address:#x} has to be alone"
        self.alone, self.asked = not streams, [*self.asked, (write, address)]
        bad = address in self.refused or address % 4 != 0
        if write and not bad:
            self.words[address] = data
        at = self.cycle + (2 if write else 14)
        if not streams:
            self.rested = at + REST
        assert not self.due.get(at, 0) & (WROTE if write else READ)
        self.due[at] = self.due.get(at, 0) | (WROTE | bad * WRITE_ERROR if write else READ | bad * READ_ERROR | (0 if bad else self.words.get(address, 0)))


class Bench:
    def __init__(self, dut, seed, waits=True):
        self.dut, self.chance = dut, random.Random(seed)
        self.hub = Hub(dut, self.chance)
        self.bursts, self.sent, self.broken = [], [], set()
        self.waits = waits

    async def start(self):
        dut = self.dut
        cocotb.start_soon(Clock(dut.clk_i, 10, "ns").start())
        for name in ("host_valid_i", "host_write_i", "host_addr_i", "host_wdata_i", "req_ready_i", "wrote_i", "write_error_i", "read_i",
                     "read_error_i", "rdata_i"):
            getattr(dut, name).value = 0
        self.ram = AxiRam(AxiBus.from_prefix(dut, "m_axi"), dut.clk_i, dut.rst_i, size=SIZE)
        self.ram.write(0, bytes(self.chance.randrange(256) for _ in range(SIZE)))
        whole = {self.ram.read_if: self.ram.read_if._read, self.ram.write_if: self.ram.write_if._write}
        for one, name in ((self.ram.read_if, "_read"), (self.ram.write_if, "_write")):
            setattr(one, name, self.fail(whole[one]))
        if self.waits:
            for channel in (self.ram.write_if.aw_channel, self.ram.write_if.w_channel, self.ram.write_if.b_channel,
                            self.ram.read_if.ar_channel, self.ram.read_if.r_channel):
                channel.set_pause_generator(self.pauses())
        else:
            self.hub.waits = 0
        dut.rst_i.value = 1
        for _ in range(5):
            await RisingEdge(dut.clk_i)
        dut.rst_i.value = 0
        for one in (self.hub.run, self.watch):
            cocotb.start_soon(one())
        await RisingEdge(dut.clk_i)

    def pauses(self):
        while True:
            rate = self.chance.choice((0, 0.2, 0.8))
            for _ in range(self.chance.randrange(1, 40)):
                yield self.chance.random() < rate

    def fail(self, access):
        """Memory that answers with SLVERR where it is broken."""
        async def done(address, what):
            length = what if isinstance(what, int) else len(what)
            if self.broken & {at & ~3 for at in range(address, address + length)}:
                raise ValueError("broken memory")
            return await access(address, what)
        return done

    async def watch(self):
        """The rules of the bus that the memory does not look at: what stands stands still, and where bursts end."""
        dut, stood = self.dut, {}
        left = []                                          # beats of each burst of a store
        untold = asked = 0                                 # its bursts without a response; accesses of the host without an answer
        while True:
            await FallingEdge(dut.clk_i)
            untold -= dut.m_axi_bvalid.value == 1 and dut.m_axi_bready.value == 1
            assert untold == 0 or dut.u_transfer.busy_q.value == 1, "over, and memory has not answered"
            asked -= (dut.host_wrote_o.value == 1) + (dut.host_read_o.value == 1)
            assert asked >= 0, "the host gets an answer that is not its own"
            asked += dut.host_valid_i.value == 1 and dut.host_ready_o.value == 1
            for channel, names in (("aw", ("addr", "len", "size", "burst")), ("ar", ("addr", "len", "size", "burst")), ("w", ("data", "strb", "last"))):
                valid, ready = (getattr(dut, f"m_axi_{channel}{name}").value == 1 for name in ("valid", "ready"))
                now = tuple(getattr(dut, f"m_axi_{channel}{name}").value.integer for name in names) if valid else None
                assert stood.get(channel) in (None, now), f"{channel} does not stand still"
                stood[channel] = now if valid and not ready else None
                if not (valid and ready):
                    continue
                if channel == "w":
                    self.sent.append(now)
                    left[0] -= 1
                    assert bool(now[2]) == (left[0] == 0), "the last word of a burst"
                    left = left[left[0] == 0:]
                else:
                    address, length = now[0], now[1] + 1
                    assert now[2:] == (2, 1) and address % 4 == 0 and address // 4096 == (address + 4 * length - 1) // 4096, f"a burst {now}"
                    self.bursts.append((channel, address, length))
                    left += [length] * (channel == "aw")
                    untold += channel == "aw"

    async def access(self, address, data=None):
        """As axi_lite asks: alone, and not soon after an answer. (refused, word)"""
        dut = self.dut
        dut.host_valid_i.value, dut.host_write_i.value, dut.host_addr_i.value, dut.host_wdata_i.value = 1, int(data is not None), address, data or 0
        while True:
            await ReadOnly()
            taken = dut.host_ready_o.value == 1
            await RisingEdge(dut.clk_i)
            if taken:
                break
        dut.host_valid_i.value, dut.host_write_i.value, dut.host_addr_i.value, dut.host_wdata_i.value = 0, 1, STREAM, 0   # it stood for long enough
        while True:
            await ReadOnly()
            answer = [getattr(dut, f"host_{name}_o").value.integer for name in ("wrote", "write_error", "read", "read_error", "rdata")]
            if answer[0] or answer[2]:
                break
            await RisingEdge(dut.clk_i)
        for _ in range(REST):
            await RisingEdge(dut.clk_i)
        assert bool(answer[2]) == (data is None) and bool(answer[0]) != (data is None)
        return bool(answer[3 if data is None else 1]), answer[4] if data is None else 0

    async def get(self, name):
        refused, word = await self.access(AT[name])
        assert not refused
        return word

    async def begin(self, memory, place, words, control):
        self.bursts.clear(), self.sent.clear(), self.hub.asked.clear()
        for name, word in (("memory", memory), ("place", place), ("words", words), ("control", control)):
            assert await self.access(AT[name], word) == (False, 0)

    async def end(self):
        async def over():
            while (status := await self.get("status")) & RUNNING:
                pass
            return status
        return await with_timeout(cocotb.start_soon(over()), 2000, "us")

    async def move(self, memory, place, words, control):
        await self.begin(memory, place, words, control)
        return await self.end()

    def put(self, at, rows):
        """Descriptors, four words each."""
        self.ram.write(at, b"".join(word.to_bytes(4, "little") for row in rows for word in row))

    def word(self, address):
        return int.from_bytes(self.ram.read(address, 4), "little")

    def some(self, most=700):
        """A range of memory, and how many words: short ones, and some around the ends of bursts."""
        words = self.chance.choice((1, 2, self.chance.randrange(1, 40), 255, 256, 257, self.chance.randrange(1, most)))
        edge = 1024 * self.chance.randrange(1, 40)
        memory = self.chance.choice((edge, edge - 4, edge - 4 * words, 4 * self.chance.randrange(SIZE // 4 - words)))
        return max(0, memory), words


@cocotb.test(timeout_time=120, timeout_unit="us")
async def loads_move_each_word_once(dut):
    bench = Bench(dut, 1)
    await bench.start()
    before = bench.ram.read(0, SIZE)
    for turn in range(10):
        memory, words = bench.some()
        place = STREAM + 4 * bench.chance.randrange(1000) if turn % 5 else ALONE
        words = words if turn % 5 else min(words, 20)
        bench.hub.words = {}
        assert await bench.move(memory, place, words, LOAD) == DONE
        assert bench.hub.asked == [(True, place + 4 * i) for i in range(words)]
        assert bench.hub.words == {place + 4 * i: bench.word(memory + 4 * i) for i in range(words)}
        assert [(memory, place, words)] == [(await bench.get("memory") - 4 * words, await bench.get("place") - 4 * words, words + await bench.get("words"))]
        assert sum(length for _, _, length in bench.bursts) == words and await bench.get("error") == 0
    assert await bench.move(0x400, ALONE, 7, LOAD | STAY) == DONE
    assert bench.hub.asked == [(True, ALONE)] * 7 and bench.hub.words[ALONE] == bench.word(0x418)
    assert await bench.move(0x400, STREAM, 0, LOAD) == DONE and bench.hub.asked == bench.bursts == []
    assert bench.ram.read(0, SIZE) == before


@cocotb.test(timeout_time=120, timeout_unit="us")
async def stores_write_no_byte_outside(dut):
    bench = Bench(dut, 2)
    await bench.start()
    for _ in range(10):
        memory, words = bench.some()
        place, before = STREAM + 4 * bench.chance.randrange(1000), bytearray(bench.ram.read(0, SIZE))
        bench.hub.words = {place + 4 * i: bench.chance.getrandbits(32) for i in range(words)}
        assert await bench.move(memory, place, words, STORE) == DONE
        assert bench.hub.asked == [(False, place + 4 * i) for i in range(words)]
        before[memory:memory + 4 * words] = b"".join(word.to_bytes(4, "little") for word in bench.hub.words.values())
        assert bench.ram.read(0, SIZE) == before, "memory has other words"
        assert len(bench.sent) == words and all(strobe == 15 for _, strobe, _ in bench.sent)


@cocotb.test(timeout_time=120, timeout_unit="us")
async def the_host_is_answered_meanwhile(dut):
    bench = Bench(dut, 3)
    await bench.start()
    own = STREAM + 0x10000 - 4
    for control in (LOAD, STORE):
        bench.hub.words = {own: 5}
        await bench.begin(0x7f4, STREAM, 600, control)
        for name, word in (("memory", 4), ("words", 1), ("control", LOAD)):
            assert (await bench.access(AT[name], word))[0], "a register is written while a transfer runs"
        count = 0
        while await bench.get("status") & RUNNING:
            count += 1
            assert await bench.access(own) == (False, bench.hub.words[own])
            assert await bench.access(own, count) == (False, 0)
            assert (await bench.access(ALONE + 1))[0]
        assert count > 3 and await bench.get("status") == DONE
        moved = [at for _, at in bench.hub.asked if STREAM <= at < own]
        assert moved == [STREAM + 4 * i for i in range(600)]
    for name, word in (("memory", 2), ("place", 1), ("words", 1 << 24), ("control", 0), ("control", LOAD | STORE), ("status", 0), ("error", 0)):
        assert (await bench.access(AT[name], word))[0], f"{name} = {word} was taken"
    assert (await bench.access(AT["control"]))[0] and (await bench.access(AT["error"] + 8))[0]


@cocotb.test(timeout_time=120, timeout_unit="us")
async def a_transfer_has_its_turn_after_two_answers_at_once(dut):
    """The hub answers a write sooner than a read: both in one cycle, if the host streams both."""
    bench = Bench(dut, 8, waits=False)
    await bench.start()
    own = STREAM + 0x10000 - 4
    for data, cycles in ((None, 11), (7, 3)):              # how long until the next one, or the end
        dut.host_valid_i.value, dut.host_write_i.value, dut.host_addr_i.value, dut.host_wdata_i.value = 1, int(data is not None), own, data or 0
        await RisingEdge(dut.clk_i)
        dut.host_valid_i.value, both = 0, False
        for _ in range(cycles):
            await FallingEdge(dut.clk_i)
            both = both or (dut.host_wrote_o.value == 1 and dut.host_read_o.value == 1)
            await RisingEdge(dut.clk_i)
    assert both, "the answers do not meet"
    for _ in range(REST):
        await RisingEdge(dut.clk_i)
    assert await bench.move(0x400, STREAM, 5, LOAD) == DONE and bench.hub.words[own] == 7


@cocotb.test(timeout_time=120, timeout_unit="us")
async def an_error_of_memory_ends_a_transfer(dut):
    bench = Bench(dut, 4)
    await bench.start()
    for turn in range(8):
        words, control = 2000, (LOAD, STORE)[turn % 2]
        memory, place = 4 * bench.chance.randrange(SIZE // 4 - words), STREAM
        broken = memory + 4 * bench.chance.randrange(400)
        bench.broken, before = {broken}, bytearray(bench.ram.read(0, SIZE))
        bench.hub.words = {place + 4 * i: bench.chance.getrandbits(32) for i in range(words)} if control == STORE else {}
        assert await bench.move(memory, place, words, control) == MEMORY_ERROR
        burst = next(address for _, address, length in bench.bursts if address <= broken < address + 4 * length)
        at, wanted, done = await bench.get("error"), broken if control == LOAD else burst, bench.hub.asked
        assert at == wanted, f"{at:#x} failed, not {wanted:#x}"
        assert len(bench.bursts) <= 6, "bursts go on after an error"
        assert done == [(control == LOAD, place + 4 * i) for i in range(len(done))] and len(done) < words or control == STORE
        if control == LOAD:
            assert bench.hub.words == {place + 4 * i: bench.word(memory + 4 * i) for i in range(len(done))} and 4 * len(done) <= broken - memory
        else:
            after = bench.ram.read(0, SIZE)
            for i in range(words):
                before_it = bytes(before[memory + 4 * i:memory + 4 * i + 4])
                new = bench.hub.words[place + 4 * i].to_bytes(4, "little")
                assert after[memory + 4 * i:memory + 4 * i + 4] in (new, before_it)
                assert memory + 4 * i >= burst or after[memory + 4 * i:memory + 4 * i + 4] == new
            assert after[:memory] == before[:memory] and after[memory + 4 * words:] == before[memory + 4 * words:]
        bench.broken = set()
        assert await bench.move(memory, place, 9, LOAD) == DONE and await bench.get("error") == 0


@cocotb.test(timeout_time=120, timeout_unit="us")
async def a_refusal_ends_a_transfer(dut):
    bench = Bench(dut, 5)
    await bench.start()
    for turn in range(8):
        words, control = bench.chance.choice((1, 30, 700)), (LOAD, STORE)[turn % 2]
        memory, place = 4 * bench.chance.randrange(SIZE // 4 - words), STREAM
        number = bench.chance.randrange(words)
        bench.hub.refused, before = {place + 4 * number}, bytearray(bench.ram.read(0, SIZE))
        bench.hub.words = {place + 4 * i: bench.chance.getrandbits(32) for i in range(words)} if control == STORE else {}
        assert await bench.move(memory, place, words, control) == REFUSED
        assert await bench.get("error") == place + 4 * number
        after = bench.ram.read(0, SIZE)
        for i in range(words if control == STORE else 0):
            new = bench.hub.words[place + 4 * i].to_bytes(4, "little")
            old = bytes(before[memory + 4 * i:memory + 4 * i + 4])
            assert after[memory + 4 * i:memory + 4 * i + 4] in (old, *[new] * (i < number)), "a word that was refused"
        assert after[:memory] == before[:memory] and after[memory + 4 * words:] == before[memory + 4 * words:]
        bench.hub.refused = set()
        assert await bench.move(memory, place, 9, LOAD) == DONE
    # Beyond the bits of the bus there is nothing.
    assert await bench.move(0, 1 << dut.ADDRESS_W.value, 3, LOAD) == REFUSED and await bench.get("error") == 1 << dut.ADDRESS_W.value


@cocotb.test(timeout_time=120, timeout_unit="us")
async def a_word_takes_a_cycle(dut):
    bench = Bench(dut, 6, waits=False)
    await bench.start()
    for control in (LOAD, STORE):
        await bench.begin(0, STREAM, 2000, control)
        begin = bench.hub.cycle
        while dut.u_transfer.busy_q.value == 1:
            await RisingEdge(dut.clk_i)
        taken = bench.hub.cycle - begin
        dut._log.info("%.3f cycles a word", taken / 2000)
        assert taken <= 1.1 * 2000, f"{taken / 2000:.3f} cycles a word"


@cocotb.test(timeout_time=120, timeout_unit="us")
async def a_list_is_one_command(dut):
    """Chunks of objects come, a run begins, its end is waited for, they go back: in this order, and each once."""
    bench = Bench(dut, 7)
    await bench.start()
    at, chunks, words = 0x8000, 3, 100
    status, command = STREAM + 0x8000, ALONE + 4
    commands, runs = [], []
    for chunk in range(chunks):
        place = STREAM + 4 * chunk
        commands += [(0x400 + 4 * words * chunk, place, words, LOAD), (0x40, command, 1, LOAD), (0, status, 2, WAIT),
                     (0x2000 + 4 * words * chunk, place, words, STORE | (LAST if chunk == chunks - 1 else 0))]

    take = bench.hub.take

    def run(write, address, data):
        """The words of the status are 1 for a while after the command."""
        if write and address == command:
            runs.append(bench.hub.cycle + 200)
        bench.hub.words[status] = 1 if runs and bench.hub.cycle < runs[-1] else ended
        take(write, address, data)
        if write and STREAM <= address < status:
            bench.hub.words[address] = data ^ 0xffffffff
        if not write and STREAM <= address < status:
            assert bench.hub.cycle >= runs[-1], "a chunk goes back while its run goes on"

    bench.hub.take, ended = run, 2
    bench.put(at, commands)
    assert await bench.move(at, 0, 0, LIST) == DONE
    assert await bench.get("next") == at + 16 * len(commands) and len(runs) == chunks
    for i in range(chunks * words):
        assert bench.word(0x2000 + 4 * i) == bench.word(0x400 + 4 * i) ^ 0xffffffff
    # A run that ends otherwise ends the list, and so does what is not possible; where it is, is told.
    ended, before = 4, bench.ram.read(0x2000, 0x1000)
    assert await bench.move(at, 0, 0, LIST) == REFUSED and await bench.get("error") == status and await bench.get("next") == at + 48
    assert bench.ram.read(0x2000, 0x1000) == before
    for wrong in ((2, STREAM, 1, LOAD), (0, STREAM + 1, 1, LOAD), (0, STREAM, 1 << 24, LOAD), (0, STREAM, 1, LOAD | STORE), (0, STREAM, 1, LIST),
                  (0, STREAM, 1, 0)):
        bench.put(at, [(0x400, STREAM, 1, LOAD), wrong])
        assert await bench.move(at, 0, 0, LIST) == REFUSED and await bench.get("next") == at + 32
        assert len([one for one in bench.hub.asked if one[0]]) == 1
    bench.put(at, commands[:1])
    bench.broken = {at + 20}
    assert await bench.move(at, 0, 0, LIST) == MEMORY_ERROR and await bench.get("error") == at + 20
    # A descriptor may lie in two bursts.
    at -= 8
    bench.put(at, [(0x400, STREAM, 1, LOAD | LAST)])
    for broken, ends in ({at + 4}, MEMORY_ERROR), (set(), DONE):
        bench.broken = broken
        assert await bench.move(at, 0, 0, LIST) == ends and await bench.get("next") == at + 16
        assert await bench.get("error") == (at + 4 if broken else 0)


@cocotb.test(timeout_time=120, timeout_unit="us")
async def a_place_may_be_some_words_of_each_record(dut):
    bench = Bench(dut, 8)
    await bench.start()
    for turn, (run, skip) in enumerate(((1, 7), (6, 10), (9, 7), (64, 0), (1, 63), (63, 1), (2, 0), (64, 63))):
        words = bench.chance.choice((1, run, run + 1, bench.chance.randrange(1, 100)))
        memory, place = 4 * bench.chance.randrange(SIZE // 4 - words), STREAM + 4 * bench.chance.randrange(100)
        at = [place + 4 * (i // run * (run + skip) + i % run) for i in range(words)]
        for way in (LOAD, STORE):
            bench.hub.words = {address: bench.chance.getrandbits(32) for address in at} if way == STORE else {}
            control = way | (run & 63) << RUN | skip << SKIP
            assert await bench.move(memory, place, words, control) == DONE
            assert bench.hub.asked == [(way == LOAD, address) for address in at]
            assert bench.hub.words == {address: bench.word(memory + 4 * i) for i, address in enumerate(at)}
            bench.hub.refused = {bench.chance.choice(at[turn % 2 * (words // 2):])}
            assert await bench.move(memory, place, words, control) == REFUSED and {await bench.get("error")} == bench.hub.refused
            bench.hub.refused = set()
    assert await bench.move(0x400, ALONE, 7, LOAD | STAY | 2 << RUN | 5 << SKIP) == DONE and bench.hub.asked == [(True, ALONE)] * 7


@cocotb.test(timeout_time=120, timeout_unit="us")
async def a_part_of_a_list_is_made_again(dut):
    bench = Bench(dut, 9)
    await bench.start()
    at = 0x8004

    def one(i, control=LOAD):
        return (0x400, STREAM + 4 * i, 1, control)

    def again(to, times, control=AGAIN):
        return (at + 16 * to, 0, times, control)

    async def made(rows, outcome=DONE):
        bench.put(at, rows)
        assert await bench.move(at, 0, 0, LIST) == outcome
        return [(address - STREAM) // 4 for _, address in bench.hub.asked]

    for times in (0, 1, 5):
        assert await made([one(0), one(1), one(2), again(1, times), one(3, LOAD | LAST)]) == [0, *[1, 2] * (1 + times), 3]
        assert await made([one(0), again(0, times, AGAIN | LAST)]) == [0] * (1 + times)
        assert await bench.get("next") == at + 32
    assert await made([one(0), again(0, 2), one(1), one(2), again(2, 1), one(3, LOAD | LAST)]) == [0, 0, 0, 1, 2, 1, 2, 3]
    # Not within another one; it is as possible as other descriptors; the host has no list to go back in.
    assert await made([one(0), one(1), again(1, 1), again(0, 1, AGAIN | LAST)], REFUSED) == [0, 1, 1, 0, 1] and await bench.get("next") == at + 48
    assert await made([one(0), again(0, 1, AGAIN | LAST)]) == [0, 0], "after one that was refused"
    for wrong in (again(0, 1, AGAIN | LOAD), again(0, 1 << 24), (at + 2, 0, 1, AGAIN)):
        assert await made([one(0), wrong], REFUSED) == [0] and await bench.get("next") == at + 32
    for control in (AGAIN, AGAIN | LIST):
        assert (await bench.access(AT["control"], control))[0]


@cocotb.test(timeout_time=120, timeout_unit="us")
async def a_list_goes_on_elsewhere(dut):
    """By what a place says when bit 0 of its word is 0: forwards, backwards, out of a part that is made again and back into it."""
    bench = Bench(dut, 10)
    await bench.start()
    at, place = 0x8004, STREAM + 0x8000
    says, take = [], bench.hub.take                        # the words of the place, one after the other; the last one stays

    def told(write, address, data):
        if not write and address == place:
            bench.hub.words[place] = says.pop(0) if len(says) > 1 else says[0]
        take(write, address, data)

    bench.hub.take = told

    def one(i, control=LOAD):
        return (0x400, STREAM + 4 * i, 1, control)

    def goes(to, word=2, control=WAIT | OTHERWISE, where=place):
        return (at + 16 * to, where, word, control)

    async def made(rows, words, outcome=DONE, ends=None):
        """Which ones were moved, and where the list was then: behind its last descriptor, if nothing else is said."""
        bench.put(at, rows)
        says[:] = words
        assert await bench.move(at, 0, 0, LIST) == outcome
        assert await bench.get("next") == at + 16 * (len(rows) if ends is None else ends)
        assert outcome != DONE or await bench.get("error") == 0
        return [(address - STREAM) // 4 for write, address in bench.hub.asked if write]

    # Forwards: what is between is left out, or not; what does not fit into a number of words is another word; a word whose bit 0 is 1 says nothing.
    for words, moved in (([2], [0, 1, 2]), ([34], [0, 2]), ([1, 3, 35, 2], [0, 1, 2]), ([35, 34], [0, 2]), ([0], [0, 2]), ([2 + (1 << 24)], [0, 2])):
        assert await made([one(0), goes(3), one(1), one(2, LOAD | LAST)], words) == moved, words
    # Behind the end, and back by one that always goes: at once, or with `last`, which is for the word that is said.
    assert await made([one(0), goes(3), one(1, LOAD | LAST), one(2), goes(2, 0)], [34], ends=3) == [0, 2, 1]
    assert await made([one(0), goes(3), one(1, LOAD | LAST), one(2), goes(2, 0)], [2], ends=3) == [0, 1]
    assert await made([one(0), one(1), goes(1, 2, WAIT | OTHERWISE | LAST)], [34, 4, 2]) == [0, 1, 1, 1]
    # To itself: it asks again.
    assert await made([one(0), goes(1), one(1, LOAD | LAST)], [34, 34, 32, 2]) == [0, 1]
    # Out of a part that is made again, and back into it, as often as it is made.
    part = [one(0), goes(5), one(1), (at, 0, 2, AGAIN), one(3, LOAD | LAST), one(2), goes(2, 0)]
    for words, moved in (([2], [0, 1] * 3 + [3]), ([34], [0, 2, 1] * 3 + [3]), ([2, 34, 34, 2], [0, 1, 0, 2, 1, 0, 1, 3]), ([34, 34, 2, 2], [0, 2, 1, 0, 1, 0, 1, 3])):
        assert await made(part, words, ends=5) == moved, words
    # Out of it for good: the part is under way until the list ends, so there is no other one, and none is left for the next list.
    assert await made([one(0), goes(3), (at, 0, 2, AGAIN), one(1), goes(6), one(2), one(3, LOAD | LAST)], [2, 34]) == [0, 0, 1, 3]
    assert await made([one(0), goes(3), (at, 0, 2, AGAIN), one(1), (at + 48, 0, 1, AGAIN | LAST)], [2, 34], REFUSED) == [0, 0, 1]
    assert await made([one(0), (at, 0, 1, AGAIN | LAST)], [2]) == [0, 0]
    # A plain `wait` behind it ends the list as before; so does an error of the place, and of memory where the list was to go on.
    assert await made([one(0), goes(3), one(1), goes(0, 2, WAIT), one(2, LOAD | LAST)], [34], REFUSED, 4) == [0] and await bench.get("error") == place
    bench.hub.refused = {place}
    assert await made([one(0), goes(3), one(1), one(2, LOAD | LAST)], [34], REFUSED, 2) == [0] and await bench.get("error") == place
    bench.hub.refused = set()
    bench.broken = {at + 48 + 8}
    assert await made([one(0), goes(3), one(1), one(2, LOAD | LAST)], [34], MEMORY_ERROR, 4) == [0] and await bench.get("error") == at + 56
    bench.broken = set()
    # Alone, or with another command, it is not possible; nor where there is no address of a descriptor; the host has no list to go on with.
    for control in (OTHERWISE, LOAD | OTHERWISE, STORE | OTHERWISE, AGAIN | OTHERWISE, WAIT | LOAD | OTHERWISE):
        assert await made([one(0), goes(2, 0, control), one(1, LOAD | LAST)], [34], REFUSED, 2) == [0], control
    assert await made([one(0), (at + 33, place, 2, WAIT | OTHERWISE), one(1, LOAD | LAST)], [34], REFUSED, 2) == [0]
    for control in (OTHERWISE, WAIT | OTHERWISE, LIST | OTHERWISE, LOAD | OTHERWISE):
        assert (await bench.access(AT["control"], control))[0], control
    # A command of the host's after a list whose last wait went elsewhere is an ordinary one.
    assert await made([one(0), goes(3), one(1), one(2, LOAD | LAST)], [34]) == [0, 2]
    assert await bench.move(at, place, 2, WAIT) == REFUSED and await bench.get("error") == place
