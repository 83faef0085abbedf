"""The writer of Kanata logs, fed by hand: what it makes of instructions that no hardware made."""

import subprocess

import check
import pytest

pytestmark = pytest.mark.smoke

# Composed: it has its own loads and stores.      the number of the word
MANY = """
.state s slept
.shared eps
first:
    lds slept                                   # 0
    ld  s                                       # 1
step:
    add s, s, s                                 # 2
    sleep slept, s, eps                         # 3
last:
    mul s, s, s                                 # 4
    st  s                                       # 5
    st  slept                                   # 6
"""
SINGLE = """
.state v
.param p
.temp  t
step:
    mul  t, p, p                                # 0
    add  v, v, p                                # 1
    madd v, p, t, v                             # 2
"""


@pytest.fixture
def write(build, tmp_path):
    """Feeds events to the writer; what the command said and the log's path."""
    def run(source, config, events, log=None):
        (tmp_path / "x.s").write_text(source)
        log = log or tmp_path / "x.kanata"
        done = subprocess.run([build / "tests/kanata_log", tmp_path / "x.s", config, log], capture_output=True, text=True,
                              input="".join(f"{event}\n" for event in events))
        return done, log
    return run


NO_OBJECT, ASLEEP, EXECUTED = 1, 2, 3           # outcomes


def end(issued, ended, pc, bits=None, outcome=EXECUTED, context=0, scheduler=0, lane=0, obj=0, flags=0):
    """bits: what is written; None: nothing is."""
    return f"t {issued} {ended} {scheduler} {lane} {context} {pc} {outcome} {obj} {int(bits is not None)} {bits or 0:08x} {flags}"


# What a visit of two steps makes of the words of MANY, in order: (word, what it writes or None, outcome).
AWAKE = [(0, 0), (1, 0x3f800000), (2, 0x40000000), (3, None), (2, 0x40000000), (3, None), (4, 0x40800000), (5, None), (6, None)]
VISITS = [[(pc, bits, EXECUTED) for pc, bits in AWAKE],              # stays awake
          [(pc, 5 if n == 3 else bits if n not in (4, 5) else None, ASLEEP if n in (4, 5) else EXECUTED)
           for n, (pc, bits) in enumerate(AWAKE)],                   # falls asleep in the first step
          [(pc, 3 if n == 0 else None, NO_OBJECT if n else EXECUTED) for n, (pc, _) in enumerate(AWAKE)],   # slept before
          [(pc, None, NO_OBJECT) for pc, _ in AWAKE]]                # the lane has no object


def visits(latency, schedulers=1, cycle=100, order=VISITS):
    """Contexts 0 to 3 of each scheduler make one visit of two steps; a second lane does what nobody asks for."""
    events = []
    for n in range(len(AWAKE)):
        for context, visit in enumerate(order):
            pc, bits, outcome = visit[n]
            for scheduler in range(schedulers):
                events.append(end(cycle, cycle + latency, pc, bits, outcome, context, scheduler, 0, 10 * scheduler + context, 1))
                events.append(end(cycle, cycle + latency + 1, pc, 1, EXECUTED, context, scheduler, 1, 99))
            cycle += 1
        cycle += 20
    return events


@pytest.mark.parametrize("config, schedulers", [("many", 1), ("array", 4)])
@pytest.mark.parametrize("latency", [17, 16, 23])
def test_what_is_not_executed_is_flushed(write, config, schedulers, latency):
    done, log = write(MANY, config, visits(latency, schedulers))
    assert done.returncode == 0, done.stderr
    found = check.read(log.read_text(), schedulers, 24)
    assert len(found) == 9 * 4 * schedulers
    for scheduler in range(schedulers):
        for context in range(4):
            mine = [one for one in found if one.thread == 24 * scheduler + context]
            assert [one.label.split(":")[0] for one in mine] == list("012323456")
            assert ["fx"[one.flushed] for one in mine] == list(
                ["fffffffff", "ffffxxfff", "fxxxxxxxx", "xxxxxxxxx"][context]), (scheduler, context)
            assert all(one.ended - one.issued == latency + 1 for one in mine)
            assert all(f"scheduler {scheduler}, context {context}\n" in one.detail for one in mine)
    said = [one.detail.split("\n")[1] for one in found if one.thread == 1]
    assert said == ["object 1: slept = awake (0x00000000) inexact", "object 1: s = 1.0 (0x3f800000) inexact",
                    "object 1: s = 2.0 (0x40000000) inexact", "object 1: slept = step 5 (0x00000005) inexact",
                    "object 1: not executed, the object sleeps", "object 1: not executed, the object sleeps",
                    "object 1: s = 4.0 (0x40800000) inexact", "object 1: stored", "object 1: stored"]
    assert [one.detail.split("\n")[1] for one in found if one.thread == 0][3] == "object 0: no change"
    assert found[-1].detail.split("\n")[1] == "not executed: no object"


def test_an_object_removed_is_called_so(write):
    done, log = write(MANY, "many", [end(0, 17, 0, 0xffffffff)])
    assert done.returncode == 0 and "slept = removed by the host" in check.read(log.read_text(), 1, 24)[0].detail


def test_stages_of_interleaved_contexts(write):
    done, log = write(MANY, "many", visits(21))
    one = [one for one in check.read(log.read_text(), 1, 24) if one.thread == 0]
    at = [[(name, end - begin) for _, name, begin, end in instruction.stages] for instruction in one]
    arithmetic = [("Is", 1), ("Rd", 3), ("Mu", 8), ("Ad", 8), ("Wb", 2)]
    memory, compare = [("Is", 1), ("Rd", 3), ("Me", 16), ("Wb", 2)], [("Is", 1), ("Rd", 3), ("Cm", 16), ("Wb", 2)]
    assert at == [memory, memory, arithmetic, compare, arithmetic, compare, arithmetic, memory, memory]
    assert one[2].label == "2: add  s, s, s" and one[5].label == "3: sleep slept, s, eps"


def test_stages_where_schedulers_share_the_arithmetic(write):
    """A sum waits instead of being multiplied by 1, a product instead of being added to -0."""
    done, log = write(MANY, "shared", [end(0, 22, 2, 0), end(1, 23, 4, 0, scheduler=1)])
    assert [[(name, end - begin) for _, name, begin, end in one.stages] for one in check.read(log.read_text(), 2, 24)] == [
        [("Is", 1), ("Rd", 4), ("Wa", 8), ("Ad", 8), ("Wb", 2)], [("Is", 1), ("Rd", 4), ("Mu", 8), ("Wa", 8), ("Wb", 2)]]


@pytest.mark.parametrize("config, latency", [("many_full", 21), ("shared_full", 22), ("single_full", 5)])
def test_a_value_is_made_beside_the_multiplier(write, config, latency):
    """Sums of half or twice wait there, where schedulers share."""
    is_many = latency > 5
    source = "step:\n    max r0, r1, r2\n    rsqrt r3, r1\n" + ("    addh r4, r1, r2\n" if is_many else "")
    loads = 2 * is_many
    events = [end(0, latency, loads, 1), end(30, 30 + latency, loads + 1, 1)]
    events += [end(60, 60 + latency, loads + 2, 1)] * is_many
    done, log = write(source, config, events)
    found = [[name for _, name, *_ in one.stages] for one in check.read(log.read_text(), None, None)]
    read = ["Rd"] * is_many
    assert found[:2] == [["Is", *read, "Va", "Ad", "Wb"]] * 2
    assert found[2:] == [["Is", *read, "Wa" if config == "shared_full" else "Mu", "Ad", "Wb"]] * is_many


def test_stages_of_a_multiply_add_that_is_rounded_once(write):
    """It is added a cycle earlier than a chained product, and so is a sum. A value is as late as a product."""
    source = "step:\n    fmadd r0, r1, r2, r3\n    add r4, r1, r2\n    mul r5, r1, r2\n    max r6, r1, r2\n"
    done, log = write(source, "single_fused", [end(0, 4, 0, 1), end(10, 14, 1, 1), end(20, 23, 2, 1), end(30, 33, 3, 1)])
    assert [[(name, end - begin) for _, name, begin, end in one.stages] for one in check.read(log.read_text(), None, None)] == [
        [("Is", 1), ("Mu", 1), ("Ad", 2), ("Wb", 1)], [("Is", 1), ("Ad", 3), ("Wb", 1)], [("Is", 1), ("Mu", 2), ("Wb", 1)],
        [("Is", 1), ("Va", 2), ("Wb", 1)]]


@pytest.mark.parametrize("config, add, mul", [("single", 2, 2), ("uncut", 1, 1)])
def test_stages_of_one_object(write, config, add, mul):
    """The addition ends after the product that was issued before it, or with it: rows go by issue."""
    chain = add + mul
    events = [end(20, 21 + chain, 2, 0x7fc00000), end(11, 12 + add, 1, 0xbf800000, flags=0b10100), end(10, 11 + mul, 0, 0x3f000000)]
    done, log = write(SINGLE, config, events)
    assert done.returncode == 0, done.stderr
    found = check.read(log.read_text(), 1, 1)
    assert [[(name, begin, end) for _, name, begin, end in one.stages] for one in found] == [
        [("Is", 10, 11), ("Mu", 11, 11 + mul), ("Wb", 11 + mul, 12 + mul)],
        [("Is", 11, 12), ("Ad", 12, 12 + add), ("Wb", 12 + add, 13 + add)],
        [("Is", 20, 21), ("Mu", 21, 21 + mul), ("Ad", 21 + mul, 21 + chain), ("Wb", 21 + chain, 22 + chain)]]
    assert [one.label for one in found] == ["0: mul  t, p, p", "1: add  v, v, p", "2: madd v, p, t, v"]
    assert [one.detail for one in found] == ["object 0: t = 0.5 (0x3f000000)",
                                            "object 0: v = -1.0 (0xbf800000) invalid overflow",
                                            "object 0: v = nan (0x7fc00000)"]


def test_loads_and_stores_of_the_composer_have_their_place(write):
    """The image has one word; its visit loads, executes and stores."""
    done, log = write(".state s\nstep:\n    add s, s, s\n", "many", [end(0, 17, 0, 1), end(24, 41, 1, 2), end(48, 65, 2)])
    found = check.read(log.read_text(), 1, 24)
    assert [one.label for one in found] == ["0: ld   s", "1: add  s, s, s", "2: st   s"]
    assert [one.flushed for one in found] == [False] * 3 and found[2].detail.endswith("object 0: stored")


def test_another_program_in_another_scheduler_has_its_own_labels(write):
    events = [end(0, 17, 0, 1), end(0, 17, 0, 1, scheduler=1) + " 08200000", end(1, 18, 0, 1),
              end(1, 18, 0, scheduler=1) + " ffffffff"]
    done, log = write(MANY, "shared", events)
    assert [one.label for one in check.read(log.read_text(), 2, 24)] == [
        "0: lds  slept", "0: add  slept, s, s", "0: lds  slept", "0: 0xffffffff"]


def test_nothing_is_a_log_as_well(write):
    done, log = write(SINGLE, "single", [])
    assert done.returncode == 0 and log.read_text() == "Kanata\t0004\nC=\t0\n"


REFUSED = {
    "an end before its issue": ("single", [end(5, 4, 1, 1)], "cycle 4: word 1 of scheduler 0, context 0, issued in cycle 5"),
    "an end in the cycle of its issue": ("single", [end(4, 4, 1, 1)], "cycle 4: word 1"),
    "no such context": ("many", [end(5, 22, 0, 1, context=24)], "context 24, issued in cycle 5: out of range"),
    "no such scheduler": ("shared", [end(5, 22, 0, 1, scheduler=2)], "scheduler 2, context 0"),
    "no such word": ("single", [end(5, 8, 65536, 1)], "word 65536 of"),
    "no such configuration": ("nonesuch", [], "no configuration 'nonesuch'"),
    "too long": ("single", ["n 2000001"], "the run issued more than 2000000 instructions: log fewer steps or objects"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_is_said_and_nothing_is_written(write, name):
    config, events, said = REFUSED[name]
    done, log = write(SINGLE if config in ("single", "nonesuch") else MANY, config, events)
    assert done.returncode != 0 and said in done.stderr and done.stderr.count("\n") == 1, done.stderr
    assert not log.exists()


def test_a_failure_leaves_the_file_as_it_was(write, tmp_path):
    log = tmp_path / "old.kanata"
    log.write_text("what was there")
    done, _ = write(SINGLE, "single", [end(3, 3, 1, 0)], log)
    assert done.returncode != 0 and str(log) in done.stderr and log.read_text() == "what was there"
    done, _ = write(SINGLE, "single", [end(0, 3, 1, 0)], log)
    assert done.returncode == 0 and log.read_text().startswith("Kanata")


def test_a_path_that_cannot_be_written_is_named(write, tmp_path):
    done, _ = write(SINGLE, "single", [end(0, 3, 1, 0)], tmp_path / "none/x.kanata")
    assert done.returncode != 0 and "none/x.kanata" in done.stderr


# The counters in the order of docs/registers.md: cycles, 5 * issued, retired, 6 * stalls, paired.
def occupancy(build, *counters, paired=0):
    done = subprocess.run([build / "tests/kanata_log", "occupancy", *map(str, counters), str(paired)], capture_output=True, text=True)
    assert done.returncode == 0 and len(counters) == 13, done.stderr
    return done.stdout


def test_occupancy_is_a_table_that_adds_up(build):
    assert occupancy(build, 1000, 100, 200, 300, 0, 50, 650, 10, 240, 0, 0, 0, 100) == """\
occupancy of scheduler 0
  issued_add                  100   10.0 %  ####
  issued_mul                  200   20.0 %  ########
  issued_chain                300   30.0 %  ############
  issued_memory                50    5.0 %  ##
  stall_fetch                  10    1.0 %
  stall_dependency            240   24.0 %  ##########
  stall_drain                 100   10.0 %  ####
  cycles                     1000  100.0 %
  adder in use                400   40.0 %  ################
  multiplier in use           500   50.0 %  ####################
"""


def test_cycles_of_two_instructions_are_counted_once(build):
    assert occupancy(build, 1000, 666, 667, 0, 0, 0, 1000, 0, 0, 0, 0, 0, 0, paired=333) == """\
occupancy of scheduler 0
  issued_add                  666   66.6 %  ###########################
  issued_mul                  667   66.7 %  ###########################
  less paired                 333   33.3 %  #############
  cycles                     1000  100.0 %
  adder in use                666   66.6 %  ###########################
  multiplier in use           667   66.7 %  ###########################
"""


@pytest.mark.parametrize("parts", [[1, 1, 1], [1] * 7, [1, 2, 3, 5, 7, 11, 13, 17, 19, 23, 29], [999999, 1],
                                   [2**47, 2**40 + 1, 3], [1]])
def test_shares_add_up_to_100(build, parts):
    shares = parts + [0] * (11 - len(parts))
    rows = occupancy(build, sum(parts), *shares[:5], sum(shares[:5]), *shares[5:]).splitlines()
    shown = [row.split() for row in rows if row.startswith(("  issued", "  stall"))]
    assert sum(round(10 * float(row[2])) for row in shown) == 1000
    assert all(abs(float(row[2]) - 100 * int(row[1]) / sum(parts)) < 0.1 + 1e-9 for row in shown)


def test_a_run_of_no_cycles_has_an_occupancy_too(build):
    assert occupancy(build, *[0] * 13) == "occupancy of scheduler 0\n  cycles                        0    0.0 %\n"
