"""issue against its header: what the lanes are told of each instruction, now, at its end and with its result."""

import collections
import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge

from bundles import Bundle, seen

SHARED = 1                                                 # the upper bit of an operand: a shared constant
UNITS = ("to_add", "to_mul", "to_chain", "to_sleep", "to_memory")


def instruction(chance, registers, choices, marks):
    """A decoded instruction, as front/decoded.vh has it."""
    def operand():
        return chance.randrange(2 * registers)
    unit = chance.choice(UNITS)
    d = {"legal": 1, unit: 1, "d": chance.randrange(registers), "a": operand(), "b": operand(), "c": operand()}
    if unit == "to_memory":
        d["st"] = chance.randrange(2)
        d["lds"] = int(not d["st"] and chance.randrange(2))
    elif unit in ("to_add", "to_chain"):
        d["subtract"] = chance.randrange(2)
    if unit == "to_add":
        d["choice"] = chance.randrange(1, choices) if chance.random() < 0.5 else 0
        d["twice"], d["halve"] = chance.choice(((0, 0), (1, 0), (0, 1))) if not d["choice"] else (0, 0)
    return d, marks


class Bench:
    def __init__(self, dut, seed):
        self.dut, self.chance = dut, random.Random(seed)
        self.contexts, self.registers = int(dut.CONTEXTS.value), int(dut.REGISTERS.value)
        self.bundles = {name: Bundle(dut, name) for name in ("DECODED", "MARKS", "ISSUE", "RETIRE")}
        self.end, self.result, self.z_late = (int(getattr(dut, name).value) for name in ("TO_END", "TO_RESULT", "Z_LATE"))
        # What is expected in the cycles to come: 0 is the next one.
        self.expected = collections.deque({} for _ in range(self.result + self.z_late + 8))
        self.step, self.record, self.seen = 0, self.chance.randrange(4), collections.Counter()
        self.row = 0                                       # of context 0 in this batch

    async def start(self):
        dut = self.dut
        cocotb.start_soon(Clock(dut.clk_i, 10, "ns").start())
        for name in ("open_i", "issue_i", "first_i", "batch_i", "current_i", "decoded_i", "marks_i", "around_i", "base_i", "end_i"):
            getattr(dut, name).value = 0
        dut.settings_i.value, dut.rst_i.value = self.record, 1         # the record is its lowest bits
        for _ in range(self.result + self.z_late + 8):
            await RisingEdge(dut.clk_i)
        dut.rst_i.value = 0

    async def cycle(self, what=None, first=0, batch=0, context=0, opens=0):
        """One cycle, in which `what` issues for a context."""
        dut = self.dut
        dut.issue_i.value, dut.first_i.value, dut.batch_i.value, dut.open_i.value = int(what is not None), first, batch, opens
        dut.current_i.value = 1 << context if what else self.chance.getrandbits(self.contexts)
        if what:
            decoded, marks = what
            dut.decoded_i.value, dut.marks_i.value = self.bundles["DECODED"].pack(**decoded), self.bundles["MARKS"].pack(**marks)
            self.tell(decoded, marks, first, batch, context)
        self.expected[self.end]["round"] = opens
        await FallingEdge(dut.clk_i)
        self.check(what)
        await RisingEdge(dut.clk_i)
        self.expected.popleft()
        self.expected.append({})

    def tell(self, d, marks, first, batch, context):
        """What one instruction makes the lanes hear, and when."""
        get = collections.defaultdict(int, d)
        shared = self.contexts

        def spot(operand):
            return ((shared if operand // self.registers == SHARED else context) * self.registers) + operand % self.registers
        if first:
            if marks["begins"]:
                self.row = 0 if self.opened else self.row + self.contexts
                self.opened = False
            self.step = int(self.dut.end_i.value) if marks["in_last"] else (
                int(self.dut.base_i.value) if marks["begins"] else self.step) + marks["newstep"] & 0xffffffff
        row = (self.row + context) % (1 << int(self.dut.ROW_W.value))
        valued, load = get["choice"] != 0, get["to_memory"] and not get["st"]
        self.expected[1]["issue"] = {
            "choice": get["choice"], "subtract": get["subtract"], "twice": get["twice"], "halve": get["halve"],
            "one": int(get["to_add"] and not valued), "st": get["st"], "in_last": marks["in_last"], "record_shift": self.record, "context": context,
            "register": d["d"], "x": spot(d["d"] if get["st"] else d["a"]), "y": spot(d["b"]), "row": row}
        self.expected[1 + self.z_late]["z"] = {"zero": get["to_mul"], "z": spot(d["c"] if get["to_chain"] or valued else d["a"])}
        self.expected[1 + self.end]["retire"] = {
            "valid": 1, **{name: marks[name] for name in ("begins", "ends", "in_last")}, "lds": get["lds"], "sleep": get["to_sleep"],
            "load": int(load), "arithmetic": int(not get["to_memory"] and not get["to_sleep"]), "batch": batch, "context": context,
            "register": d["d"], "row": row}
        self.expected[1 + self.result]["step"] = self.step

    def check(self, what):
        dut, now = self.dut, self.expected[0]
        for bundle, port, keys in (("ISSUE", dut.issue_o, ("issue", "z")), ("RETIRE", dut.retire_o, ("retire",))):
            got = self.bundles[bundle].fields_of(seen(port))
            for key in keys:
                for name, value in now.get(key, {}).items():
                    assert got[name] == value, f"{key}: {name} is {got[name]}, expected {value}: {now[key]}"
                self.seen[key] += key in now
            if bundle == "RETIRE":
                assert got["round"] == now.get("round", 0)
                assert now.get("retire") or not any(got[name] for name in ("valid", "lds", "sleep", "load", "arithmetic"))
            else:
                assert now.get("issue") or not got["st"], "a store that nobody issues"
        if "step" in now:
            assert dut.step_o.value == now["step"], f"step {dut.step_o.value.integer}, expected {now['step']}"
        kind = [what[0].get(name, 0) if what else 0 for name in UNITS]
        add, mul, chain, sleep, memory = kind
        assert dut.issued_o.value == memory << 4 | sleep << 3 | chain << 2 | mul << 1 | add
        if what:
            assert (dut.adds_o.value, dut.muls_o.value) == (add or chain, mul or chain)

    async def round(self, batches, steps, sizes, made=None):
        """A round of a random program: sizes of its first, its step and its last part. Fewer steps are made where all fall asleep."""
        chance, registers = self.chance, self.registers
        base = chance.getrandbits(32)
        self.dut.base_i.value, self.dut.end_i.value = base, base + steps & 0xffffffff
        self.opened = True
        await self.cycle(opens=1)
        first, step, last = sizes
        places = [(i, False, False) for i in range(first)] + [(i, i == 0, False) for i in range(step)] * (made or steps) + [(i, False, True) for i in range(last)]
        choices = 1 << int(self.dut.CHOICE_W.value)
        for batch in range(batches):
            alive = chance.sample(range(self.contexts), chance.randrange(1, self.contexts + 1))
            for number, (_, newstep, in_last) in enumerate(places):
                marks = {"begins": int(number == 0), "ends": int(number == len(places) - 1), "newstep": int(newstep), "in_last": int(in_last)}
                what = instruction(chance, registers, choices, marks)
                for n, context in enumerate(sorted(alive)):
                    await self.cycle(what, int(n == 0), batch & 1, context)
                    while chance.random() < 0.2:
                        await self.cycle()
        for _ in range(self.result + self.z_late + 6):
            await self.cycle()


@cocotb.test()
async def issue_names_operands_and_ends_of_each_instruction(dut):
    bench = Bench(dut, 1)
    await bench.start()
    for _ in range(4):
        await bench.round(2, 2, (2, 4, 3))
    assert bench.seen["issue"] == bench.seen["z"] == bench.seen["retire"] > 100


@cocotb.test()
async def issue_gives_each_object_its_row(dut):
    """Batch after batch, and from row 0 on in each round."""
    bench = Bench(dut, 2)
    await bench.start()
    for batches in (1, 3, 4, 2):
        await bench.round(batches, 1, (1, 1, 1))


@cocotb.test()
async def issue_counts_the_steps(dut):
    """Of a first part the number is that of the step before; of a last part, of the last step; with a step part alone, too."""
    bench = Bench(dut, 3)
    await bench.start()
    for sizes in ((1, 1, 0), (0, 1, 0), (0, 2, 1), (2, 1, 2)):
        await bench.round(2, 3, sizes)
    await bench.round(2, 4, (1, 1, 2), made=2)
