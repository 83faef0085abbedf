"""How the rtl engine finds the issue of what ends: in_flight.c, fed by hand."""

import subprocess

import pytest

pytestmark = pytest.mark.smoke

EXECUTED, ASLEEP = 3, 2


@pytest.fixture(scope="module")
def words(fp3, tmp_path_factory):
    """Instruction words by their text."""
    folder = tmp_path_factory.mktemp("words")
    texts = ["add r0, r1, r1", "mul r2, r1, r1", "madd r0, r1, r2, r3", "st r0", "sleep r5, r0, r1"]
    (folder / "x.s").write_text("step:\n" + "".join(f"    {text}\n" for text in texts))
    subprocess.run([fp3, "asm", "x.s", "--hex", "x.hex"], cwd=folder, check=True)
    code = [line.split()[0] for line in (folder / "x.hex").read_text().splitlines() if line[:1] not in "/"]
    return dict(zip(texts, code[9:]))


@pytest.fixture
def pair(build, words):
    """Of every end, the cycle of its issue and its pc; and whether all had one."""
    def run(config, events):
        lines = [f"i {cycle} {scheduler} {context} {pc} {words[text]}" if kind == "i" else " ".join(map(str, [kind, cycle, scheduler, context, pc, *text]))
                 for kind, cycle, scheduler, context, pc, text in events]
        done = subprocess.run([build / "tests/in_flight", config], input="".join(f"{line}\n" for line in lines), capture_output=True,
                              text=True)
        assert done.stderr == ""
        return [tuple(map(int, line.split())) if line != "nothing" else None for line in done.stdout.splitlines()], done.returncode == 0
    return run


def issue(cycle, pc, text, context=0, scheduler=0):
    return "i", cycle, scheduler, context, pc, text


def end(cycle, reg=None, context=0, scheduler=0, lane=0, outcome=EXECUTED):
    return "e", cycle, scheduler, lane, context, (outcome, int(reg is not None), reg or 0)


def test_a_short_one_overtakes_and_the_writes_of_a_register_keep_their_order(pair):
    """One object: the product overtakes two sums into one register."""
    events = [issue(0, 1, "add r0, r1, r1"), issue(1, 1, "add r0, r1, r1"), issue(2, 0, "mul r2, r1, r1"),
              end(5, 2), end(6, 0), end(7, 0)]
    assert pair("single", events) == ([(2, 0), (0, 1), (1, 1)], True)


def test_contexts_end_in_the_order_of_issue_whatever_they_write(pair):
    events = [issue(0, 7, "st r0"), issue(1, 7, "st r0", 1), issue(24, 8, "sleep r5, r0, r1"), issue(25, 8, "sleep r5, r0, r1", 1),
              end(30), end(31, context=1, outcome=ASLEEP), end(54, 5), end(55, context=1, outcome=ASLEEP)]
    assert pair("many", events) == ([(0, 7), (1, 7), (24, 8), (25, 8)], True)


def test_every_lane_ends_everything(pair):
    """The second lane a cycle later; the first is further by then."""
    events = [issue(0, 0, "add r0, r1, r1"), issue(24, 1, "mul r2, r1, r1"), end(30, 0), end(31, 0, lane=1),
              end(54, 2), end(55, 2, lane=1)]
    assert pair("lanes", events) == ([(0, 0), (0, 0), (24, 1), (24, 1)], True)


def test_schedulers_do_not_answer_for_each_other(pair):
    events = [issue(0, 3, "add r0, r1, r1", scheduler=n) for n in range(3)] + [end(30, 0, scheduler=2), end(30, 0, scheduler=3)]
    assert pair("array", events) == ([(0, 3), None], False)


def test_a_long_run_goes_round(pair):
    """More issues than the queue has places, each ended when a thousand later ones have issued."""
    events, expected = [], []
    for n in range(3000):
        events.append(issue(n, n % 100, "add r0, r1, r1", n % 24))
        if n >= 1000:
            events.append(end(n, 0, (n - 1000) % 24))
            expected.append((n - 1000, (n - 1000) % 100))
    assert pair("many", events) == (expected, True)


ADD = issue(4, 0, "add r0, r1, r1")
LOST = {
    "a write of another register": ("single", [ADD, end(8, 5)]),
    "a second write": ("single", [ADD, end(8, 0), end(9, 0)]),
    "a write before its issue": ("single", [end(3, 0), ADD]),
    "a write in the cycle of its issue": ("single", [ADD, end(4, 0)]),
    "another context": ("many", [ADD, end(21, 0, context=2)]),
    "another register of a context": ("many", [ADD, end(21, 1)]),
    "an end twice": ("many", [ADD, end(21, 0), end(21, 0)]),
}


@pytest.mark.parametrize("name", LOST)
def test_what_was_not_issued_is_noticed(pair, name):
    config, events = LOST[name]
    found, is_all = pair(config, events)
    assert None in found and not is_all


def test_after_an_end_without_an_issue_nothing_is_paired_however_long_it_goes_on(pair):
    """Each queue has room for 1,024 instructions in flight."""
    events = [end(1, 0)]
    for n in range(3000):
        events += [issue(2 * n + 2, 0, "add r0, r1, r1"), end(2 * n + 3, 0)]
    pairs, all_paired = pair("many", events)
    assert pairs == [None] * 3001 and not all_paired
