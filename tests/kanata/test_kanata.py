"""The writer of Kanata logs, fed by hand: what it makes of issues and retirements that no hardware made."""

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
S, SLEPT = 0, 1                                 # registers of MANY


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


def issue(cycle, pc, context=0, unit=0):
    return f"i {cycle} {unit} {context} {pc}"


def retire(cycle, reg, bits, context=0, unit=0, lane=0, obj=0, flags=0):
    return f"r {cycle} {unit} {lane} {context} {obj} {reg} {bits:08x} {flags}"


def in_order(events):
    """Retirements of a cycle come first, as the engine tells them."""
    return sorted(events, key=lambda event: (int(event.split()[1]), event[0] == "i"))


# Which words of MANY write what: {pc: (register, bits)}; the rest is issued and writes nothing.
ALL = {0: (SLEPT, 0), 1: (S, 0x3f800000), 2: (S, 0x40000000), 4: (S, 0x40800000)}
VISITS = [ALL,                                                        # stays awake
          {**ALL, 3: (SLEPT, 5)},                                     # falls asleep in the first of two steps
          {0: (SLEPT, 3)},                                            # slept before: absent
          {}]                                                         # the lane has no object


def visits(latency, units=1, cycle=100, all_writes=VISITS):
    """Contexts 0 to 3 of each unit make one visit of two steps."""
    events = []
    for number, pc in enumerate([0, 1, 2, 3, 2, 3, 4, 5, 6]):
        for context, writes in enumerate(all_writes):
            for unit in range(units):
                events.append(issue(cycle, pc, context, unit))
                asleep = 3 in writes and number in (4, 5)             # after its sleep, before the last part
                if pc in writes and not asleep:
                    events.append(retire(cycle + latency, *writes[pc], context, unit, obj=10 * unit + context, flags=1))
                    events.append(retire(cycle + latency + 1, *writes[pc], context, unit, lane=1, obj=99))
            cycle += 1
        cycle += 20
    return in_order(events)


@pytest.mark.parametrize("config, units", [("many", 1), ("array", 4)])
@pytest.mark.parametrize("latency", [17, 16, 23])
def test_what_sleeps_is_flushed(write, config, units, latency):
    done, log = write(MANY, config, visits(latency, units))
    assert done.returncode == 0, done.stderr
    found = check.read(log.read_text(), units, 24)
    assert len(found) == 9 * 4 * units
    for unit in range(units):
        for context in range(4):
            mine = [one for one in found if one.thread == 24 * unit + context]
            assert [one.label.split(":")[0] for one in mine] == list("012323456")
            assert ["fx"[one.flushed] for one in mine] == list(
                ["fffffffff", "ffffxxfff", "fxxxxxxxx", "xxxxxxxxx"][context]), (unit, context)
            assert all(one.ended - one.issued == latency + 1 for one in mine)
            assert all(f"unit {unit}, context {context}\n" in one.detail for one in mine)
    said = [one.detail.split("\n")[1] for one in found if one.thread == 1]
    assert said == ["object 1: slept = awake (0x00000000) inexact", "object 1: s = 1.0 (0x3f800000) inexact",
                    "object 1: s = 2.0 (0x40000000) inexact", "object 1: slept = step 5 (0x00000005) inexact",
                    "object 1: not executed, it sleeps", "object 1: not executed, it sleeps",
                    "object 1: s = 4.0 (0x40800000) inexact", "object 1: stored", "object 1: stored"]
    assert [one.detail.split("\n")[1] for one in found if one.thread == 0][3] == "object 0: no change"
    assert found[-1].detail.split("\n")[1] == "not executed: no object"


def test_an_object_removed_is_called_so(write):
    done, log = write(MANY, "many", [issue(0, 0), retire(17, SLEPT, 0xffffffff)])
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
    events = [issue(0, 2), issue(1, 4, unit=1), retire(22, S, 0), retire(23, S, 0, unit=1)]
    done, log = write(MANY, "shared", events)
    assert [[(name, end - begin) for _, name, begin, end in one.stages] for one in check.read(log.read_text(), 2, 24)] == [
        [("Is", 1), ("Rd", 4), ("Wa", 8), ("Ad", 8), ("Wb", 2)], [("Is", 1), ("Rd", 4), ("Mu", 8), ("Wa", 8), ("Wb", 2)]]


@pytest.mark.parametrize("config, latency", [("many_full", 21), ("shared_full", 22), ("single_full", 5)])
def test_a_value_is_made_beside_the_multiplier(write, config, latency):
    """Sums of half or twice wait there, where schedulers share."""
    source = "step:\n    max r0, r1, r2\n    rsqrt r3, r1\n" + ("    addh r4, r1, r2\n" if latency > 5 else "")
    loads = 2 * (latency > 5)
    events = [issue(0, loads), issue(30, loads + 1), retire(latency, 0, 1), retire(30 + latency, 3, 1)]
    events += [issue(60, loads + 2), retire(60 + latency, 4, 1)] * (latency > 5)
    done, log = write(source, config, in_order(events))
    found = [[name for _, name, _, _ in one.stages] for one in check.read(log.read_text(), None, None)]
    read = ["Rd"] * (latency > 5)
    assert found[:2] == [["Is", *read, "Va", "Ad", "Wb"]] * 2
    assert found[2:] == [["Is", *read, "Wa" if config == "shared_full" else "Mu", "Ad", "Wb"]] * (latency > 5)


def test_what_slept_says_nothing_of_the_next_visit(write):
    """Each kind of object comes once after each other kind."""
    orders = [VISITS[n:] + VISITS[:n] for n in (0, 1, 2, 3, 0, 3, 1, 0)]
    events = [event for n, order in enumerate(orders) for event in visits(17, cycle=5000 * n, all_writes=order)]
    done, log = write(MANY, "many", events)
    found = check.read(log.read_text(), 1, 24)
    for n, order in enumerate(orders):
        for context in range(4):
            mine = [one for one in found[36 * n:36 * n + 36] if one.thread == context]
            assert ["fx"[one.flushed] for one in mine] == list(
                ["fffffffff", "ffffxxfff", "fxxxxxxxx", "xxxxxxxxx"][VISITS.index(order[context])]), (n, context)


@pytest.mark.parametrize("slept, flushed", [(0, [False] * 3), (7, [False, True, True])])
def test_nothing_follows_the_lds_of_an_absent_object(write, slept, flushed):
    """Neither sleep nor st writes anything in any case: only what lds loaded says whether they were executed."""
    source = ".state s slept\n.shared eps\nfirst:\n lds slept\nstep:\n sleep slept, s, eps\nlast:\n st s\n"
    done, log = write(source, "many", [issue(0, 0), retire(17, SLEPT, slept), issue(24, 1), issue(48, 2)])
    assert [one.flushed for one in check.read(log.read_text(), 1, 24)] == flushed


def test_units_do_not_answer_for_each_other(write):
    done, log = write(MANY, "array", [issue(0, 1, 0, unit) for unit in range(4)] + [retire(17, S, 0, unit=2)])
    assert [one.flushed for one in check.read(log.read_text(), 4, 24)] == [True, True, False, True]


@pytest.mark.parametrize("config, add, mul", [("single", 2, 2), ("uncut", 1, 1)])
def test_stages_of_one_object(write, config, add, mul):
    chain = add + mul
    events = [issue(10, 0), issue(11, 1), retire(11 + mul, 2, 0x3f000000), retire(12 + add, 0, 0xbf800000, flags=0b10100),
              issue(20, 2), retire(21 + chain, 0, 0x7fc00000)]
    done, log = write(SINGLE, config, in_order(events))
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


def test_the_writes_of_a_register_are_told_apart_by_their_order(write):
    """The multiplication overtakes the two additions."""
    events = [issue(0, 1), issue(1, 1), issue(2, 0), retire(5, 2, 3), retire(6, 0, 1), retire(7, 0, 2)]
    done, log = write(SINGLE, "single", in_order(events))
    assert [one.ended for one in check.read(log.read_text(), 1, 1)] == [7, 8, 6]


def test_what_never_retires_is_flushed(write):
    done, log = write(SINGLE, "single", [issue(0, 1)])
    (one,) = check.read(log.read_text(), 1, 1)
    assert one.flushed and one.ended > one.issued


def test_loads_and_stores_of_the_composer_have_their_place(write):
    """The image has one word; its visit loads, executes and stores."""
    done, log = write(".state s\nstep:\n    add s, s, s\n", "many",
                      [issue(0, 0), retire(17, 0, 1), issue(24, 1), retire(41, 0, 2), issue(48, 2)])
    found = check.read(log.read_text(), 1, 24)
    assert [one.label for one in found] == ["0: ld   s", "1: add  s, s, s", "2: st   s"]
    assert [one.flushed for one in found] == [False] * 3 and found[2].detail.endswith("object 0: stored")


def test_the_last_part_is_where_the_composer_puts_it(write):
    """The object falls asleep in the first of two steps, and is stored."""
    source = ".state s slept\n.shared eps\nstep:\n sleep slept, s, eps\n"
    done, log = write(source, "many", [issue(0, 0), retire(17, SLEPT, 0), issue(24, 1), retire(41, S, 0), issue(48, 2),
                                       retire(65, SLEPT, 1), issue(72, 2), issue(96, 3)])
    found = check.read(log.read_text(), 1, 24)
    assert [one.label.split()[1] for one in found] == ["lds", "ld", "sleep", "sleep", "st"]
    assert [one.flushed for one in found] == [False, False, False, True, False]


def test_another_program_in_another_unit_has_its_own_labels(write):
    events = [issue(0, 0), issue(0, 0, unit=1) + " 08200000", issue(1, 0), issue(1, 0, unit=1) + " ffffffff"]
    done, log = write(MANY, "shared", events)
    assert [one.label for one in check.read(log.read_text(), 2, 24)] == [
        "0: lds  slept", "0: add  slept, s, s", "0: lds  slept", "0: 0xffffffff"]


def test_nothing_is_a_log_as_well(write):
    done, log = write(SINGLE, "single", [])
    assert done.returncode == 0 and log.read_text() == "Kanata\t0004\nC=\t0\n"


REFUSED = {
    "a write of nothing": ("single", [issue(0, 0), retire(3, 5, 0)], "cycle 3: unit 0 wrote register 5 of context 0: no"),
    "a second write": ("single", [issue(0, 0), retire(3, 2, 0), retire(4, 2, 0)], "cycle 4"),
    "a write before its issue": ("single", [retire(3, 2, 0), issue(4, 0)], "cycle 3"),
    "a write in the cycle of its issue": ("single", [issue(4, 0), retire(4, 2, 0)], "cycle 4"),
    "another context": ("many", [issue(0, 1, 3), retire(17, S, 0, context=2)], "of context 2: no"),
    "another latency": ("many", [issue(0, 1), issue(24, 1), retire(17, S, 0), retire(40, S, 0)], "cycle 40"),
    "a write twice": ("many", [issue(0, 1), retire(17, S, 0), retire(17, S, 0)], "cycle 17"),
    "a write of a store": ("many", [issue(0, 5), retire(17, S, 0)], "wrote register 0"),
    "back in time": ("single", [issue(5, 0), issue(4, 1)], "cycle 4: unit 0 issued word 1"),
    "no such context": ("many", [issue(5, 0, 24)], "for context 24: out of range"),
    "no such unit": ("shared", [issue(5, 0, 0, 2)], "unit 2 issued"),
    "no such word": ("single", [issue(5, 65536)], "issued word 65536"),
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
    done, _ = write(SINGLE, "single", [retire(3, 5, 0)], log)
    assert done.returncode != 0 and str(log) in done.stderr and log.read_text() == "what was there"
    done, _ = write(SINGLE, "single", [issue(0, 0)], log)
    assert done.returncode == 0 and log.read_text().startswith("Kanata")


def test_a_path_that_cannot_be_written_is_named(write, tmp_path):
    done, _ = write(SINGLE, "single", [issue(0, 0)], tmp_path / "none/x.kanata")
    assert done.returncode != 0 and "none/x.kanata" in done.stderr


# The counters in the order of docs/registers.md: cycles, 5 * issued, retired, 6 * stalls.
def occupancy(build, *counters):
    done = subprocess.run([build / "tests/kanata_log", "occupancy", *map(str, counters)], capture_output=True, text=True)
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
