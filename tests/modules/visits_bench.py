"""visits against a model of its header: a list of rows, the object of each context, who sleeps. The bench issues instructions of
visits in a random order, and says of each by chance what it finds: a small change, an object that sleeps."""

import collections
import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge

APART = 8                                                  # cycles between two instructions of one context
FIELDS = "context begins ends in_last lds sleep less nonzero"
Instruction = collections.namedtuple("Instruction", FIELDS)
INPUTS = ("rst_i", "round_i", "take_i", "take_e2_i", "context_e2_i", "context_w1_i", "valid_i", "begins_i", "ends_i", "in_last_i", "lds_i",
          "sleep_i", "context_i", "less_i", "nonzero_i", "st_context_i", "host_clear_i", "host_wake_i", "host_row_i")


def visit(chance, context, length, asleep):
    """The instructions of a visit: loads first, stores last, in between a sleep now and then."""
    first, last = 1 + chance.randrange(length), chance.randrange(length)
    for i in range(length):
        in_last = i >= length - last and i > 0
        lds = i < first and not in_last and chance.random() < 0.7
        yield Instruction(context, i == 0, i == length - 1, in_last, lds, not lds and chance.random() < 0.6, chance.random() < asleep,
                          chance.random() < asleep / 4)


class Model:
    """What the header says, instruction by instruction."""

    def __init__(self, contexts):
        self.list = collections.deque()
        self.left = 0
        self.row, self.absent, self.asleep = [None] * contexts, [None] * contexts, [None] * contexts   # nothing is known after a reset

    def take(self):
        """W-6, the first of a visit: the list's head, if there is one for this round."""
        if not self.left:
            return None
        self.left -= 1
        return self.list.popleft()

    def execute(self, it, row):
        """W: whether it is executed, there is no object, it falls asleep; and whether it is not awake afterwards."""
        c = it.context
        if it.begins:
            self.row[c], self.absent[c], self.asleep[c] = row, row is None, False
        absent, before = self.absent[c], self.asleep[c]
        executed = not absent and not (before and not it.in_last)
        sleeps = executed and it.sleep and it.less and not before
        self.absent[c] = absent or (executed and it.lds and it.nonzero)
        self.asleep[c] = before or sleeps
        back = self.row[c] if it.ends and not self.absent[c] and not self.asleep[c] else None
        return executed, absent, sleeps, self.absent[c] or self.asleep[c], back


class Bench:
    def __init__(self, dut):
        self.dut, self.chance = dut, random.Random(1)
        self.contexts = int(dut.CONTEXTS.value)
        self.model = Model(self.contexts)
        self.pipe = collections.deque([None] * 9, 9)       # instructions: 0 is in W-6, 6 in W, 8 in W+2
        self.told = {}                                     # what each of them does, by its place in the pipe
        self.shown = dict.fromkeys(INPUTS)
        self.seen = collections.Counter()
        self.probes = collections.deque([None] * 3, 3)     # contexts that a store asks for
        self.back = None                                   # put back at the end of this cycle

    async def start(self):
        cocotb.start_soon(Clock(self.dut.clk_i, 10, "ns").start())
        for _ in range(20):                                # old instructions leave the pipeline
            await self.cycle(rst_i=1)
        for _ in range(2):
            await self.cycle()

    async def cycle(self, new=None, **inputs):
        """One cycle in which `new` is in W-6."""
        dut, model, at = self.dut, self.model, self.pipe
        at.appendleft(new and [new, None, None])
        e0, e2, e3, w1, w0, late, end = (at[i] for i in (0, 2, 3, 5, 6, 7, 8))
        now = dict.fromkeys(INPUTS, 0)
        now["take_i"] = int(e0 is not None and e0[0].begins)
        if e2:
            now["take_e2_i"], now["context_e2_i"] = int(e2[0].begins), e2[0].context
        if w1:
            now["context_w1_i"] = w1[0].context
        if w0:
            now["valid_i"] = 1
            for name in ("begins", "ends", "in_last", "lds", "sleep", "context", "less"):
                now[f"{name}_i"] = int(getattr(w0[0], name))
        now["nonzero_i"] = int(late[0].nonzero) if late else self.chance.randrange(2)
        asked = self.chance.randrange(self.contexts)
        self.probes.appendleft(None if any(it and it[0].context == asked for it in at) else asked)
        now["st_context_i"] = asked
        now.update(inputs)
        for name, value in now.items():
            if self.shown[name] != value:
                getattr(dut, name).value = value
        self.shown = now
        await FallingEdge(dut.clk_i)
        if now["rst_i"]:
            await RisingEdge(dut.clk_i)
            return
        assert dut.count_o.value == len(model.list), f"{dut.count_o.value.integer} objects are on the list, expected {len(model.list)}"
        if e3:
            self.check_row(dut.row_e3_o, e3)
        if w0:
            w0[2] = told = model.execute(w0[0], w0[1])
            self.seen.update(name for name, is_so in zip(("executed", "absent", "asleep"), told) if is_so)
            assert (dut.executed_o.value, dut.absent_o.value, dut.sleeps_o.value) == told[:3], (w0, told)
        else:
            assert dut.executed_o.value == 0 and dut.sleeps_o.value == 0
        if late:
            self.check_row(dut.row_late_o, late)
        if end:
            assert dut.asleep_o.value == end[2][3], end
            if end[2][4] is not None:
                model.list.append(end[2][4])
                self.seen["back"] += 1
        if (asked := self.probes[2]) is not None and model.absent[asked] is not None:
            self.check_store(asked)
        if e0 and e0[0].begins:
            e0[1] = model.take()
        if now["round_i"]:
            model.left = len(model.list)
        if now["host_wake_i"]:
            model.list.append(now["host_row_i"])
        if now["host_clear_i"]:
            model.list.clear()
        await RisingEdge(dut.clk_i)

    def check_row(self, port, it):
        row = it[1] if it[0].begins else self.model.row[it[0].context]
        assert row is None or port.value == row, f"row {port.value.integer}, expected {row}: {it}"

    def check_store(self, context):
        dut, model = self.dut, self.model
        assert dut.st_absent_o.value == model.absent[context] and dut.st_asleep_o.value == model.asleep[context], context
        assert model.row[context] is None or model.absent[context] or dut.st_row_o.value == model.row[context], context
        self.seen["stores"] += 1

    async def round(self, asleep, most=6):
        """Every object is visited once; perhaps more contexts begin than there are objects."""
        chance = self.chance
        await self.cycle(round_i=1)
        todo = [[] for _ in range(self.contexts)]
        last = [-APART] * self.contexts
        visits, length, now = self.model.left + chance.randrange(self.contexts), chance.randrange(1, most), 0
        while visits or any(todo):
            now += 1
            free = [c for c in range(self.contexts) if now - last[c] >= APART and (todo[c] or visits)]
            if not free or chance.random() < 0.1:
                await self.cycle()
                continue
            context = chance.choice(free)
            if not todo[context]:
                todo[context], visits = list(visit(chance, context, length, asleep)), visits - 1
            last[context] = now
            await self.cycle(todo[context].pop(0))
        for _ in range(12):
            await self.cycle()

    async def wake(self, rows):
        await self.cycle(host_clear_i=1)
        for row in rows:
            await self.cycle(host_wake_i=1, host_row_i=row)

    async def run(self, rounds, asleep):
        rows = 1 << int(self.dut.ROW_W.value)
        for _ in range(rounds):
            if self.chance.random() < 0.4 or not self.model.list:
                await self.wake(self.chance.sample(range(rows), self.chance.choice((1, self.contexts + 1, rows, self.chance.randrange(rows)))))
            await self.round(asleep)


@cocotb.test()
async def visits_visits_each_object_once_a_round(dut):
    bench = Bench(dut)
    await bench.start()
    await bench.run(6, 0)
    assert bench.seen["executed"] > 50 and bench.seen["absent"] > 5 and bench.seen["back"] > 20 and bench.seen["stores"] > 20


@cocotb.test()
async def visits_puts_back_nobody_who_is_absent(dut):
    """Contexts without an object, and objects that were found asleep."""
    bench = Bench(dut)
    await bench.start()
    for _ in range(8):
        await bench.wake(range(3))
        await bench.round(0.5)
        await bench.round(0.5)
    assert bench.seen["absent"] > 20


@cocotb.test()
async def visits_never_lets_an_object_fall_asleep_twice(dut):
    bench = Bench(dut)
    await bench.start()
    await bench.run(8, 0.8)
    assert bench.seen["asleep"] > 20


@cocotb.test()
async def visits_visits_nobody_who_fell_asleep(dut):
    """Round after round without a host, until all sleep."""
    bench = Bench(dut)
    await bench.start()
    await bench.wake(range(16))
    for _ in range(20):
        await bench.round(0.2)
        if not bench.model.list:
            break
    assert not bench.model.list
