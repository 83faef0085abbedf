"""rounds against a model of its header: which rounds a run has, when each begins, when the run ends."""

import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge

from bundles import settings

WORD = 1 << 32
HIGH = 0x10000


class Run:
    """A run, and the sequencer around rounds: what is left to issue, and the last part of a visit."""

    def __init__(self, dut, chance, steps, visit, clock, phases):
        self.dut, self.chance = dut, chance
        self.steps, self.visit, self.clock = steps, visit, clock
        self.left, self.base = steps, clock                # steps of rounds to come; the last step before them
        self.rounds, self.aborted = 0, False
        self.asked, self.due = False, False                # a stop waits for the end of a last part; it comes in this cycle
        self.closes = False                                # nothing is left to issue, as of this cycle
        self.issue, self.store = 0, 0                      # cycles left; of these in a last part
        self.rest = 0                                      # cycles since the last issue
        self.phases, self.phase = phases, 0                # of a step; that the round before ended, if it was not the last
        self.size = 0
        self.shown = {}
        self.count = chance.choice((1, 1, 5))

    def ends(self):
        return self.aborted or (self.left == 0 and self.phase == 0) or self.count == 0

    def inputs(self, stop=0, illegal=0):
        dut = self.dut
        now = {"stop_i": stop, "illegal_i": illegal, "count_i": self.count, "issuing_i": int(self.issue > 0),
               "storing_i": int(0 < self.issue <= self.store), "partial_i": int(self.phase > 0)}
        for name, value in now.items():
            if self.shown.get(name) != value:
                getattr(dut, name).value = value
        self.shown = now

    def check(self, settle, stop, illegal):
        """One cycle: what is seen, and what it changes."""
        dut, storing = self.dut, 0 < self.issue <= self.store
        assert dut.running_o.value == 1
        assert bool(dut.abort_o.value) == bool(illegal or self.due), "a stop between the stores of a visit, or one that is lost"
        self.asked = not self.due and (self.asked or stop == 1)
        self.due = self.asked and not storing
        opens, aborts = dut.open_o.value == 1, dut.abort_o.value == 1
        assert dut.begin_o.value == int(opens and not self.aborted), "fetch begins though the run is aborted, or does not begin"
        assert bool(dut.closed_o.value) == (self.closes and not self.aborted and not aborts), "a round ends unseen, or one that was aborted"
        self.closes = False
        if opens:
            size = self.left if self.visit == 0 or self.visit > self.left else self.visit
            if self.phase:                                 # the step goes on
                size, self.left, self.base = self.size, self.left + self.size, (self.base - self.size) % WORD
            assert self.rest >= settle + 2, f"a round opens {self.rest} cycles after the last issue"
            assert size and self.count
            assert (dut.steps_o.value.integer, dut.base_o.value.integer) == (size, self.base), (self.steps, self.visit, self.left)
            begins = not self.aborted and not aborts
            self.size = size
            self.left, self.base, self.rounds = self.left - size, (self.base + size) % WORD, self.rounds + 1
            self.issue = self.chance.randrange(1, 30) if begins else 0
            self.store = self.chance.randrange(self.issue + 1)
        elif self.issue:
            if self.issue == 1:
                assert dut.end_o.value == self.base
            self.issue = 0 if aborts else self.issue - 1
            if self.issue == 0 and not aborts:
                self.phase, self.closes = (self.phase + 1) % self.phases, True
            if self.issue == 0 and self.phase == 0 and self.chance.random() < 0.1:
                self.count = 0                             # the last object falls asleep
        self.rest = 0 if self.issue or opens else self.rest + 1
        self.aborted = self.aborted or aborts


async def run(dut, chance, steps, visit, clock, stop_at=None, illegal_at=None, phases=1):
    """To its end; returns the number of rounds. Hangs are seen."""
    settle = int(dut.SETTLE.value)
    this = Run(dut, chance, steps, visit, clock, phases)
    dut.settings_i.value, dut.start_i.value = settings(dut, steps=steps, visit=visit, clock=clock), 1
    this.inputs()
    await RisingEdge(dut.clk_i)
    dut.start_i.value = 0
    cycle = 0
    while True:
        stop, illegal = int(cycle == stop_at), int(cycle == illegal_at)
        this.inputs(stop, illegal)
        await FallingEdge(dut.clk_i)
        if dut.running_o.value == 0:
            break
        this.check(settle, stop, illegal)
        assert this.rest <= settle + 5, "nothing begins, and the run does not end"
        await RisingEdge(dut.clk_i)
        cycle += 1
    assert this.ends() and this.rest >= settle + 1, "the run ends too soon"
    await RisingEdge(dut.clk_i)
    return this.rounds


async def reset(dut):
    cocotb.start_soon(Clock(dut.clk_i, 10, "ns").start())
    for name in ("start_i", "stop_i", "illegal_i", "issuing_i", "storing_i", "count_i", "partial_i", "copied_i", "settings_i"):
        getattr(dut, name).value = 0
    dut.rst_i.value = 1
    for _ in range(3):
        await RisingEdge(dut.clk_i)
    dut.rst_i.value = 0
    return random.Random(1)


def near(chance):
    """A number of steps near the edges: of a half word, and of the word."""
    return max(1, min(WORD - 1, chance.choice((1, HIGH, 2 * HIGH, 5 * HIGH, WORD // 2, WORD - HIGH, WORD)) + chance.randrange(-3, 4)))


@cocotb.test()
async def rounds_divides_the_steps_into_visits(dut):
    chance, most = await reset(dut), 0
    for _ in range(30):
        steps = chance.choice((near(chance), chance.randrange(1, WORD), chance.randrange(1, 9)))
        visit = chance.choice((0, steps, max(1, steps - 1), min(WORD - 1, steps + 1), -(-steps // chance.randrange(1, 5)), near(chance),
                               steps ^ HIGH, (steps + HIGH) % WORD))
        if visit and steps // visit > 6:
            visit = 0
        most = max(most, await run(dut, chance, steps, visit, chance.randrange(WORD)))
    assert most >= 4


@cocotb.test()
async def rounds_visits_beyond_65536_steps(dut):
    """Both halves of a number count: 65,537 steps are one visit of 65,537, two of 65,536, and five of 16,000."""
    chance = await reset(dut)
    for steps, visit, rounds in ((HIGH + 1, HIGH + 1, 1), (HIGH + 1, HIGH, 2), (HIGH + 1, 16000, 5), (HIGH - 1, HIGH, 1), (3 * HIGH, HIGH + 2, 3),
                                 (5, 5 * HIGH + 1, 1), (2 * HIGH + 3, HIGH + 5, 2), (WORD - 1, WORD - 1, 1), (WORD - 1, WORD // 2, 2)):
        for _ in range(20):                                # some end early, as everybody sleeps
            if await run(dut, chance, steps, visit, 7) == rounds:
                break
        else:
            raise AssertionError(f"{steps} steps in visits of {visit} are never {rounds} rounds")


@cocotb.test()
async def rounds_compares_all_bits(dut):
    """Numbers of steps and visits that differ in one bit, or in a high one and the other way in the lowest; of each the first round."""
    chance = await reset(dut)
    for bit in range(32):
        steps = chance.randrange(1, WORD)
        for steps, visit in ((1 << bit, 1), (steps, steps ^ 1 << bit)):
            await run(dut, chance, steps, visit, 0, stop_at=3 * int(dut.SETTLE.value))


@cocotb.test()
async def rounds_never_begins_fetch_after_an_abort(dut):
    """A stop, or an illegal word, in each cycle of a run of two rounds."""
    chance = await reset(dut)
    cycles = int(dut.SETTLE.value) + 20
    for cycle in range(cycles):
        await run(dut, chance, 2, 1, 0, stop_at=cycle)
    for cycle in range(cycles - 12, cycles):
        await run(dut, chance, 2, 1, 0, illegal_at=cycle)


@cocotb.test()
async def rounds_starts_again_after_a_stop(dut):
    chance = await reset(dut)
    for _ in range(5):
        await run(dut, chance, 6, 2, 0, stop_at=chance.randrange(100))
        await run(dut, chance, 6, 2, 0)


@cocotb.test()
async def rounds_goes_on_with_a_step_of_several_phases(dut):
    chance, rounds = await reset(dut), 0
    for phases in (2, 3, 5):
        for _ in range(8):
            steps = chance.randrange(1, 5)
            made = await run(dut, chance, steps, 1, chance.randrange(WORD), phases=phases)
            assert made % phases == 0
            rounds = max(rounds, made)
            await run(dut, chance, steps, 1, 0, stop_at=chance.randrange(200), phases=phases)
    assert rounds >= 15
