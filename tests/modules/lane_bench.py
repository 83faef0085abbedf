"""lane against a model of its header, where nobody sleeps: registers, constants, a store, a status for each object. The bench is the
sequencer, the host and the arithmetic: a result is any number, with any flags."""

import collections
import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge

from bundles import Bundle, seen

OBJECT, STATUS, COUNT, CONSTANT = 0, 1, 2, 4               # host/lane_host.vh
GRAVE = 0b10100                                            # invalid, overflow
ONE, TWO, HALF, MINUS_ZERO = 0x3f800000, 0x40000000, 0x3f000000, 0x80000000
LANE, RECORD = 1, 0


class Bench:
    def __init__(self, dut, seed):
        self.dut, self.chance = dut, random.Random(seed)
        parameter = lambda name: int(getattr(dut, name).value)
        self.contexts, self.registers, self.rows = parameter("CONTEXTS"), parameter("REGISTERS"), parameter("STORE_WORDS") >> 3 + RECORD
        self.end, self.result, self.gap, self.z_late = (parameter(name) for name in ("TO_END", "TO_RESULT", "GAP", "Z_LATE"))
        self.bundles = {name: Bundle(dut, name) for name in ("ISSUE", "RETIRE", "ACCESS", "REPORT", "OPERANDS", "RESULT", "WRITTEN")}
        self.drives = collections.deque(collections.defaultdict(dict) for _ in range(self.result + self.z_late + 8))
        self.checks = collections.deque({} for _ in range(self.result + self.z_late + 8))
        self.reg, self.constants, self.store, self.status, self.count = {}, {}, {}, collections.defaultdict(int), 0
        self.seen, self.flags = collections.Counter(), (0, 0, 1, 2, 5, 17)

    async def start(self):
        dut = self.dut
        cocotb.start_soon(Clock(dut.clk_i, 10, "ns").start())
        dut.index_i.value, dut.rst_i.value = LANE, 1
        for _ in range(self.result + 12):
            await self.cycle()
        dut.rst_i.value = 0
        self.seen.clear()

    async def cycle(self):
        dut, now = self.dut, self.drives.popleft()
        self.drives.append(collections.defaultdict(dict))
        dut.issue_i.value = self.bundles["ISSUE"].pack(record_shift=RECORD, **now["issue"])
        dut.retire_i.value = self.bundles["RETIRE"].pack(**now["retire"])
        dut.access_i.value = self.bundles["ACCESS"].pack(**now["access"])
        dut.result_i.value = self.bundles["RESULT"].pack(**(now["result"] or {"value": self.chance.getrandbits(32), "flags": 0b11111}))
        dut.report_i.value = self.bundles["REPORT"].pack(asleep=1)
        dut.data_i.value = now.get("data", self.chance.getrandbits(32))
        await FallingEdge(dut.clk_i)
        expected = self.checks.popleft()
        self.checks.append({})
        for name, port in (("operands", dut.operands_o), ("written", dut.written_o), ("report", dut.report_o)):
            got = self.bundles[name.upper()].fields_of(seen(port))
            for field, value in expected.get(name, {}).items():
                assert got[field] == value, f"{name}: {field} is {got[field]:#x}, expected {value:#x}: {expected['why']}"
                self.seen[field] += 1
            if name == "written" and "written" not in expected:
                assert (got["end"], got["valid"]) == (0, 0), "something ends that was not issued"
            if name == "report" and "report" not in expected:
                assert got["flags"] == got["answer"] == 0, "flags or an answer of nothing"
        await RisingEdge(dut.clk_i)

    async def idle(self, cycles):
        for _ in range(cycles):
            await self.cycle()

    # The host -------------------------------------------------------------------------------------
    async def access(self, space, address, word=None, lane=LANE):
        """A write of a word, or a read, which is checked."""
        self.drives[0]["access"] = {"valid": 1, "write": int(word is not None), "space": space, "lane": lane, "address": address}
        if word is not None:
            self.drives[0]["data"] = word
            self.checks[3]["report"] = {}                  # nobody hears the answer to a write
        elif lane == LANE:
            held = {OBJECT: self.store.get(address), STATUS: self.status[address], COUNT: self.count}[space]
            self.checks[3].update(report={"answer": held}, why=f"space {space}, word {address}")
        await self.cycle()
        await self.idle(4)

    async def set_up(self, count, failed=False):
        """failed: objects have any status before."""
        self.count = count
        await self.access(COUNT, 0, count)
        for number in range(self.registers):
            self.constants[number] = self.chance.getrandbits(32)
            await self.access(CONSTANT, number, self.constants[number], lane=self.chance.randrange(2))
        for row in range(self.rows):
            self.status[row] = self.chance.getrandbits(32) if failed else 0
            await self.access(STATUS, row, self.status[row])
            for number in range(self.registers):
                self.store[row << 3 + RECORD | number] = self.chance.getrandbits(32)
                await self.access(OBJECT, row << 3 + RECORD | number, self.store[row << 3 + RECORD | number])
        await self.access(OBJECT, 3, 0xdeadbeef, lane=0)   # of another lane
        await self.idle(self.end + 4)

    async def read_all(self):
        await self.idle(self.result + self.z_late + 8)
        for row in range(self.rows):
            await self.access(STATUS, row)
            for number in range(self.registers):
                await self.access(OBJECT, row << 3 + RECORD | number)
        await self.access(COUNT, 0)
        await self.access(OBJECT, 3, lane=0)
        await self.idle(self.end + 4)

    # An instruction --------------------------------------------------------------------------------
    def operand(self, context):
        """(its address, what it holds)."""
        number = self.chance.randrange(self.registers)
        if self.chance.random() < 0.3:
            return self.contexts * self.registers + number, self.constants[number]
        return context * self.registers + number, self.reg.get((context, number))

    def issue(self, kind, context, row, d, step, **marks):
        chance, executed = self.chance, row < self.count
        now, end, last = self.drives[0], self.drives[self.end], self.drives[self.result]
        why = f"{kind} of context {context}, row {row}, r{d}, step {step}"
        issue = {"context": context, "register": d, "row": row, "in_last": marks.get("in_last", 0), "st": int(kind == "st")}
        end["retire"].update(valid=1, context=context, register=d, row=row, load=int(kind == "ld"), arithmetic=int(kind == "arithmetic"), **marks)
        last["data"] = step
        operands, late, written = {}, {}, {"end": 3 if executed else 1, "valid": int(executed and kind != "st")}
        if kind == "st":
            issue["x"] = context * self.registers + d
            if executed:
                self.store[row << 3 + RECORD | d] = self.reg[context, d]
        elif kind == "ld":
            value, flags = self.store[row << 3 + RECORD | d], 0
        else:
            (issue["x"], x), (issue["y"], y), (z_at, z) = (self.operand(context) for _ in range(3))
            issue["one"], issue["twice"], issue["halve"] = chance.choice(((0, 0, 0), (0, 0, 0), (1, 0, 0), (1, 1, 0), (1, 0, 1)))
            zero = chance.randrange(2)
            issue["subtract"] = chance.randrange(2)
            x = (TWO if issue["twice"] else HALF if issue["halve"] else ONE) if issue["one"] else x
            self.drives[self.z_late]["issue"].update(zero=zero, z=z_at)
            operands = {"x": x, "y": y, "subtract": issue["subtract"], "twice": issue["twice"], "halve": issue["halve"]}
            late = {"z": MINUS_ZERO if zero else z}
            value, flags = chance.getrandbits(32), chance.choice(self.flags)
            last["result"] = {"value": value, "flags": flags}
        now["issue"].update(issue)
        if executed and kind != "st":
            self.reg[context, d] = value
            written |= {"context": context, "object": row, "register": d, "value": value, "flags": flags}
            if kind == "arithmetic":
                if flags & GRAVE and not self.status[row] >> 5:
                    self.status[row] |= (step & 0x7ffffff) << 5
                self.status[row] |= flags
        for at, key, fields in ((3, "operands", operands), (3 + self.z_late, "operands", late), (self.result + 1, "written", written)):
            if executed or key == "written":
                known = {name: word for name, word in fields.items() if word is not None}
                self.checks[at].setdefault(key, {}).update(known)
                self.checks[at]["why"] = why
        self.checks[self.result + 1]["report"] = {"flags": flags if executed and kind == "arithmetic" else 0}

    async def sweep(self, kind, contexts, base, d, step, **marks):
        for context in contexts:
            self.issue(kind, context, base + context, d, step, **marks)
            await self.cycle()
        await self.idle(max(0, self.gap - len(contexts)))

    async def round(self, steps, instructions):
        """Batch after batch: loads, some random instructions in each of the steps, stores."""
        for batch, base in enumerate(range(0, self.count + 1, self.contexts)):
            contexts = range(self.contexts)
            if base + self.contexts > self.rows:
                break
            for number in range(self.registers):
                await self.sweep("ld", contexts, base, number, steps[0], begins=int(number == 0), batch=batch & 1)
            for step in [step for step in steps for _ in range(instructions)]:
                await self.sweep("arithmetic", contexts, base, self.chance.randrange(self.registers), step, batch=batch & 1)
            for number in range(self.registers):
                await self.sweep("st", contexts, base, number, steps[-1], in_last=1, ends=int(number == self.registers - 1), batch=batch & 1)


@cocotb.test()
async def lane_executes_for_the_objects_that_are_there(dut):
    """Operands, results, flags, the store and the status of objects, of contexts without one, and of rows behind the last."""
    bench = Bench(dut, 1)
    await bench.start()
    await bench.set_up(bench.contexts + 1)
    await bench.round([0x7fffff0], 16)
    await bench.read_all()
    await bench.set_up(bench.rows, failed=True)            # the store is full
    await bench.round([5], 3)
    await bench.read_all()
    assert min(bench.seen[name] for name in ("x", "y", "z", "end", "flags", "answer")) > 40, bench.seen


@cocotb.test()
async def lane_keeps_the_step_of_the_first_failure(dut):
    bench = Bench(dut, 2)
    await bench.start()
    for flags in ((0, 1, 5), (0, 2, 17), (1, 2, 5, 17)):   # an overflow, an invalid operation, either
        bench.flags = (0, *flags)
        await bench.set_up(2)
        await bench.round(range(1, 9), 1)
        await bench.read_all()
