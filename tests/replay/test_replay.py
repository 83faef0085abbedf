"""A recorded host session under Icarus: same answers, same cycles, same hash of every retirement."""

import re
import struct
import subprocess

import pytest

import simulate

SESSIONS = [("ship", "single", 30), ("ship_madd", "single", 30), ("ship_paper", "paper", 30), ("ship", "paper", 30),
            ("ship", "many", 4)]


RETIRED, FLAGS = 0xb0, 0x40


def start(*command, cwd):
    return subprocess.run([str(word) for word in command], cwd=cwd, capture_output=True, text=True, timeout=300)


@pytest.fixture
def icarus(build):
    """The replay bench of a configuration, as make has compiled it."""
    return lambda config: build / f"icarus/replay_{config}.vvp"


def record(root, fp3, tmp_path, program, config, steps, *more):
    image, session = tmp_path / "x.fp3", tmp_path / "x.session"
    assert start(fp3, "asm", f"programs/{program}.s", "-o", image, cwd=root).returncode == 0
    done = start(fp3, "run", image, "-c", config, "--steps", steps, "--params", "programs/ship.cfg",
                 "--bus-log", session, *more, cwd=root)
    assert done.returncode == 0, done.stderr
    return session


def ended(rows):
    """The text of a session: its rows, and the end that counts them."""
    rows = [row for row in rows if not row.startswith("e")]
    return "".join(row + "\n" for row in [*rows, f"e {len(rows):08x} 00000000"])


def replay(root, vvp, session, *more):
    return start("vvp", "-n", vvp, f"+session={session}", *more, cwd=root)


@pytest.mark.parametrize("program, config, steps", SESSIONS)
def test_icarus_agrees_with_verilator(root, fp3, icarus, tmp_path, program, config, steps):
    session = record(root, fp3, tmp_path, program, config, steps)
    done = replay(root, icarus(config), session)
    assert done.returncode == 0 and re.search(r"^PASS ", done.stdout, re.M), done.stdout


def test_icarus_agrees_on_a_multiply_add_that_is_rounded_once(root, fp3, icarus, tmp_path):
    """And on products and values, which end beside it: a compiled model, for one object."""
    session = tmp_path / "x.session"
    done = start(fp3, "run", "programs/projectile.ode", "-i", "rk4", "-c", "single_fused", "-n", 20, "--bus-log", session, cwd=root)
    assert done.returncode == 0, done.stderr
    done = replay(root, icarus("single_fused"), session)
    assert done.returncode == 0 and re.search(r"^PASS ", done.stdout, re.M), done.stdout


@pytest.mark.parametrize("kind, column", [("r", 2), ("h", 1), ("h", 2)])
def test_a_wrong_answer_fails(root, fp3, icarus, tmp_path, kind, column):
    """One digit of one recorded answer is changed: the bench must see it."""
    session = record(root, fp3, tmp_path, "ship", "single", 5)
    lines = session.read_text().splitlines()
    last = max(i for i, line in enumerate(lines) if line.startswith(kind))
    words = lines[last].split()
    words[column] = words[column][:-1] + ("0" if words[column][-1] != "0" else "1")
    lines[last] = " ".join(words)
    session.write_text("\n".join(lines) + "\n")
    done = replay(root, icarus("single"), session)
    assert done.returncode != 0 and "FAIL" in done.stdout and "PASS" not in done.stdout


@pytest.mark.parametrize("keep, why", [(lambda rows: rows[:-1], "it was cut off"), (lambda rows: rows[:len(rows) // 2], "it was cut off"),
                                       (lambda rows: [*rows, rows[-2]], "a line follows the end"),
                                       (lambda rows: [*rows[:-2], rows[-1]], "some are missing")])
def test_a_session_that_is_not_whole_fails(root, fp3, icarus, tmp_path, keep, why):
    session = record(root, fp3, tmp_path, "ship", "single", 3)
    session.write_text("".join(row + "\n" for row in keep(session.read_text().splitlines())))
    done = replay(root, icarus("single"), session)
    assert done.returncode != 0 and why in done.stdout and "PASS" not in done.stdout, done.stdout


@pytest.mark.parametrize("text", ["", "x 0000 00000000\n", "w 0\n", "w 0ffc 00000000\n"],
                         ids=["empty", "unknown", "short", "refused"])
def test_a_bad_session_fails(root, icarus, tmp_path, text):
    session = tmp_path / "bad.session"
    session.write_text(text)
    done = replay(root, icarus("single"), session)
    assert done.returncode != 0 and "FAIL" in done.stdout


def test_a_missing_session_fails(root, icarus, tmp_path):
    assert replay(root, icarus("single"), tmp_path / "none").returncode != 0


def test_a_hang_ends_at_the_limit(root, fp3, icarus, tmp_path):
    """A run that takes longer than the limit looks like one that never ends."""
    session = record(root, fp3, tmp_path, "ship", "single", 30)
    done = replay(root, icarus("single"), session, "+limit=1000")
    assert done.returncode != 0 and "the cycle limit was reached" in done.stdout and "PASS" not in done.stdout


def reset_in_the_middle(session, times, length):
    """A recorded run, reset at each of these times for so many cycles; then what there is, and a run of nothing.

    That run sets what a run needs except for the objects, so it must find none.
    """
    lines = session.read_text().splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith("p"))
    head = lines[:start]
    show = [f"s {line.split()[1]} 00000000" for line in lines[start:] if line.startswith("r")]
    registers = [line for line in head if line.startswith("w") and int(line.split()[1], 16) & 0xffffff < 0x80]
    counters = [f"s {address:08x} 00000000" for address in range(0x80, 0x80 + 13 * 8, 8)]
    soon = [f"s {address:08x} 00000000" for address in (RETIRED, FLAGS, RETIRED)]
    rows = []
    for cycles in times:
        rows += [*head, f"z {cycles:x} {length:x}", *soon, *show, *registers, lines[start], *counters]
    session.write_text(ended(rows))
    return session


@pytest.mark.parametrize("config, objects, times", [("many", 6, (37, 150, 334, 601)), pytest.param("lanes", 8, (600,), marks=pytest.mark.long), pytest.param("dual", 4, (300, 441), marks=pytest.mark.long),
                                                    ("single", 1, (37, 150, 333))])
def test_a_reset_of_one_cycle_is_a_reset(root, fp3, icarus, tmp_path, long, config, objects, times):
    """In the middle of a run it leaves what a long one leaves: memories as they are, and nothing on its way."""
    times = times if long else times[-2:]
    shown = []
    for length in (1, 80):
        session = record(root, fp3, tmp_path, "ship_dual" if config == "dual" else "ship_madd", config, 2 if objects > 1 else 20, "-N", objects)
        done = replay(root, icarus(config), reset_in_the_middle(session, times, length))
        assert done.returncode == 0, done.stdout
        *rows, last = done.stdout.splitlines()
        shown.append((rows, last.split(", ")[3]))        # ... and the hash of all retirements
        assert len(rows) > 30 * len(times) and "hash " in last
        soon = [rows[i * len(rows) // len(times) + k] for i in range(len(times)) for k in range(3)]
        assert all(row.endswith(" 00000000") for row in soon), f"something ends after a reset: {soon}"
        if objects > 1:                                  # every counter but the first, cycles, and the last, drain
            assert all(row.endswith(" 00000000") for row in rows if 0x88 <= int(row[:8], 16) < 0xe0), rows
    assert shown[0] == shown[1]


def test_a_reset_of_one_cycle_ends_stores_and_flags(root, icarus, tmp_path):
    """Two objects are loaded, doubled until they overflow, and stored. Reset in each cycle in which the results end and the
    stores are on their way: what has not been written by then stays away, as after a long reset."""
    ld, add, st = 0x38000000, 0x08000000, 0x48000000                       # of r0
    program = [f"w {at:08x} {word:08x}" for at, word in [(0x8000, ld), (0x8004, add), (0x8008, st), (0x38, 0)]]
    objects = [(0x20000 + 32 * n, 0x7f7ffff0 + n) for n in range(2)]
    start = [f"w {at:08x} {word:08x}" for at, word in [
        (0x24, 1), (0x28, 2), (0x2c, 3), (0x20, 1), (0x18, 3), (0x3000, 0), (0x3100, 0), (0x3100, 1), *objects, (0x10, 1)]]
    show = ["s 00000040 0", *(f"s {at:08x} 0" for at, _ in objects)]      # flags of the run, and the objects
    shown = []
    for length in (1, 80):
        rows = [*program, *(row for cycles in range(82, 94) for row in (*start, f"z {cycles:x} {length:x}", *show))]
        (tmp_path / "x.session").write_text(ended(rows))
        done = replay(root, icarus("many"), tmp_path / "x.session")
        assert done.returncode == 0, done.stdout
        shown.append(done.stdout.splitlines()[:-1])
    assert shown[0] == shown[1]
    assert shown[0][1:3] == [f"{at:08x} {value:08x}" for at, value in objects], "the first reset is before the stores"
    assert shown[0][-2:] == [f"{at:08x} 7f800000" for at, _ in objects], "the last reset is after the stores"


def test_all_are_asked_while_one_runs(root, fp3, icarus, tmp_path):
    """A scheduler that runs refuses sooner than the other answers: the hub waits for both."""
    session = record(root, fp3, tmp_path, "ship_madd", "shared", 4)
    lines = session.read_text().splitlines()
    head = lines[:next(i for i, line in enumerate(lines) if line.startswith("p")) - 1]       # without the start
    asked = ["s 000e0000 0", "s 000e0000 0", "s 00040000 0", "s 00000014 0"]
    session.write_text(ended([*head, "w 00000010 00000001", *asked]))
    done = replay(root, icarus("shared"), session, "+limit=20000")
    rows = done.stdout.splitlines()                     # the first says the limit
    assert done.returncode == 0, done.stdout
    assert rows[1:3] == ["000e0000 error"] * 2 and rows[3].startswith("00040000 4650") and rows[4] == "00000014 00000001", rows


@pytest.mark.parametrize("config", ["single", "lanes", "dual", "array"])
def test_the_bench_compiles_without_a_warning(root, config):
    done = start("iverilog", "-g2012", "-Wall", "-Wno-timescale", *simulate.shape(config), "-s", "replay", "-t", "null",
                 "-c", "rtl/fp3.f", "sim/replay.v", simulate.top(config), cwd=root)
    assert (done.returncode, done.stdout + done.stderr) == (0, "")


def hash_of_trace(cycles, order=lambda lanes: lanes):
    """What tests/replay/trace.v retires in so many cycles, lane by lane, as FNV-1a over bytes, low byte first."""
    value = 0xcbf29ce484222325
    for time in range(cycles):
        for n in order(range(6)):
            mix = 2654435761 * (64 * time + n + 1) % 2**32
            if mix >> 31:
                for byte in struct.pack("<5I", n, 1000 * time + n, mix & 63, mix, mix >> 26 & 31):
                    value = (value ^ byte) * 0x100000001b3 % 2**64
    return value


@pytest.fixture(scope="module")
def trace(root, tmp_path_factory):
    """The bench around tests/replay/trace.v: a function that replays a text."""
    where = tmp_path_factory.mktemp("trace")
    done = start("iverilog", "-g2012", "-Wall", "-Wno-timescale", "-Irtl", "-DFP3_TOP=trace", "-DFP3_ADDRESS_W=26", "-DFP3_SCHEDULERS=2", "-DFP3_LANES=6",
                 "-s", "replay", "-o", where / "x.vvp", "sim/replay.v", "tests/replay/trace.v", cwd=root)
    assert (done.returncode, done.stdout + done.stderr) == (0, "")

    def run(text, *more):
        (where / "x.session").write_text(ended(text.splitlines()))
        return replay(root, where / "x.vvp", where / "x.session", *more)
    return run


@pytest.mark.smoke
def test_the_hash_is_over_lanes_in_their_order(trace):
    value, other = hash_of_trace(40), hash_of_trace(40, reversed)
    assert value != other
    for number, good in [(value, True), (other, False)]:
        done = trace(f"w ffffff00 00000028\nr 00000000 ffffffff\nh {number >> 32:08x} {number % 2**32:08x}\n")
        assert (done.returncode == 0) == good and ("PASS" in done.stdout) == good, done.stdout
    assert f"got {value:016x}" in done.stdout


@pytest.mark.smoke
def test_addresses_have_the_bits_of_their_port(trace):
    """26 for two schedulers: one of them, or, with all ones, both."""
    assert trace("r 02345678 fdcba987\nr ff800000 fc7fffff\n").returncode == 0
    done = trace("r 02345678 0000a987\n")
    assert done.returncode != 0 and "address 02345678: expected 0000a987, got fdcba987" in done.stdout


@pytest.mark.smoke
def test_each_scheduler_has_its_text(trace, tmp_path):
    assert trace("w ffffff00 00000008\nr 00000000 ffffffff\n", f"+waves={tmp_path / 'x.vcd'}").returncode == 0
    text = texts_in_waves((tmp_path / "x.vcd").read_text())
    assert "madd   r00 r00 r33 r03" in text and "msub   r00 r00 r33 r03" in text and re.search(r"r\d+=[0-9a-f]{8}", text)


def test_committed_sessions_are_what_the_host_sends(root, fp3, tmp_path):
    """`make sessions` records them again."""
    committed = sorted(root.glob("programs/*.session"))
    assert committed
    for path in committed:
        program, config, _ = path.name.split(".")
        assert record(root, fp3, tmp_path, program, config, 100).read_text() == path.read_text(), path.name


def names_in_waves(dump):
    """Of a VCD: every signal as a wave viewer calls it."""
    scope, known = [], set()
    for line in dump.splitlines():
        words = line.split()
        if line.startswith("$scope"):
            scope.append(words[2])
        elif line.startswith("$upscope"):
            scope.pop()
        elif line.startswith("$var"):
            known.add(".".join([*scope, "".join(words[4:-1])]))
        elif line.startswith("$enddefinitions"):
            break
    return known


def texts_in_waves(dump):
    """All texts that a VCD shows, in one."""
    return bytes.fromhex("".join(f"{int(bits, 2):064x}" for bits in re.findall(
        r"^b([01]{60,256}) ", dump, re.M))).decode("latin-1")


@pytest.mark.parametrize("preset, config, objects", [("fp3", "single", 1), ("many", "many", 24), ("many", "lanes", 16),
                                                     *(pytest.param("many", config, 12, marks=pytest.mark.long) for config in ("shared", "array"))])
def test_icarus_agrees_and_the_wave_preset_names_signals_that_exist(root, fp3, icarus, tmp_path, preset, config, objects):
    session, path = record(root, fp3, tmp_path, "ship_madd", config, 1, "-N", objects), tmp_path / "x.vcd"
    done = replay(root, icarus(config), session, f"+waves={path}")
    assert done.returncode == 0 and re.search(r"^PASS ", done.stdout, re.M), done.stdout
    dump = path.read_text()
    shown = {line for line in (root / f"sim/{preset}.gtkw").read_text().splitlines() if line.startswith("replay.")}
    missing = shown - names_in_waves(dump)
    assert len(shown) > 30 and not missing, sorted(missing)
    assert "madd   r" in texts_in_waves(dump), "no mnemonic to be read"


@pytest.mark.long
def test_64_contexts_take_turns(root, tmp_path):
    """The largest build: each of 64 objects is loaded, doubled three times and stored, all in one sweep each."""
    wrapper, session, bench = tmp_path / "fp3_largest.v", tmp_path / "x.session", tmp_path / "x.vvp"
    text = simulate.top("array").read_text().replace("fp3_array", "fp3_largest")
    text, found = re.subn(r"(\.CONTEXTS +)\(24\)", r"\1(64)", text)
    assert found == 1
    wrapper.write_text(text)
    ld, add, st = 0x38000000, 0x08000000, 0x48000000                       # of r0
    every = 7 << 18
    lines = [*(f"w {every | at:08x} {word:08x}" for at, word in [
        (0x8000, ld), (0x8004, add), (0x8008, st), (0x24, 1), (0x28, 2), (0x2c, 3), (0x20, 3), (0x18, 3)]),
        f"w {every | 0x3000:08x} 00000000", "r 00000004 00402020"]
    for n in range(64):                                                    # object n of every scheduler at 8 * n
        lines += [f"w {every | 0x20000 + 32 * n:08x} {0x3f800000 + n:08x}", f"w {every | 0x3100:08x} {n:08x}"]
    lines += [f"w {every | 0x10:08x} 00000001", f"p {every | 0x14:08x} 00000001"]
    for u in range(4):
        lines += [f"r {u << 18 | 0x20000 + 32 * n:08x} {0x41000000 + n:08x}" for n in range(64)]
        lines += [f"r {u << 18 | at:08x} {word:08x}" for at, word in ((0x14, 2), (0x88, 3 * 64), (0xa8, 2 * 64))]
    session.write_text(ended(lines))
    done = start("iverilog", "-g2012", *simulate.shape("array"), "-DFP3_TOP=fp3_largest", "-s", "replay", "-c", "rtl/fp3.f", "-o",
                 bench, "sim/replay.v", wrapper, cwd=root)
    assert done.returncode == 0, done.stderr
    done = replay(root, bench, session)
    assert done.returncode == 0 and "PASS" in done.stdout, done.stdout


MANY = ["STORE_WORDS=64", "CONTEXTS=4", "ADD_LATENCY=2"]


@pytest.mark.parametrize("parameters, rule", [
    (["REGISTERS=24"], "REGISTERS_must_be"), (["PROGRAM_WORDS=16384"], "PROGRAM_WORDS_must_be"),
    (["SELECT=1", "MULTIPLY_ADD=0"], "SELECT_needs_MULTIPLY_ADD_CHAIN_or_MULTIPLY_ADD_FUSED"), (["MULTIPLY_ADD=2", "ROUND=1"], "MULTIPLY_ADD_FUSED_for_one_object_with"),
    (["CHAIN=0"], "FP3_has_a_parameter_set_that_follows_from_others"), ([*MANY, "SPACE_BIT=22"], "FP3_has_a_parameter_set_that_follows_from_others"),
    ([*MANY, "CONTEXTS=65"], "CONTEXTS_must_be"), (["ADD_LATENCY=0"], "ADD_LATENCY_must_be"),
    (["MUL_LATENCY=0"], "MUL_LATENCY_must_be"), ([*MANY, "ADD_LATENCY=0", "MUL_LATENCY=3"], "ADD_LATENCY_must_be"),
    ([*MANY, "MUL_LATENCY=0", "ADD_LATENCY=3"], "MUL_LATENCY_must_be"), (["CONTEXTS=2"], "needs_STORE_WORDS"),
    (["LANES=2"], "needs_STORE_WORDS"), (["SLEEP=1"], "needs_STORE_WORDS"), ([*MANY, "WRITEBACK=1"], "WRITEBACK_excludes_STORE_WORDS"),
    ([*MANY, "STORE_WORDS=48"], "STORE_WORDS_must_be"), ([*MANY, "STORE_WORDS=16"], "STORE_WORDS_must_be"),
    ([*MANY, "SCHEDULERS=2", "LANES=2"], "SCHEDULERS_must_be"), ([*MANY, "LANES=65"], "LANES_must_be_1_to_64"),
    (["EXCEPTIONS=2"], "EXCEPTIONS_OBJECT_needs_STORE_WORDS"), ([*MANY, "MULTIPLY_ADD=3", "ROUND=1"], "MULTIPLY_ADD_DUAL_excludes_ROUND"), (["ARITHMETIC=6"], "ARITHMETIC_must_be"), ([*MANY, "ADD_LATENCY=1"], "needs_latencies_of_3")])
def test_parameters_that_cannot_be_built_stop_elaboration(root, parameters, rule):
    done = start("iverilog", "-g2005", "-t", "null", "-c", "rtl/fp3.f", "-s", "fp3",
                 *[f"-Pfp3.{parameter}" for parameter in parameters], "rtl/fp3.v", cwd=root)
    assert done.returncode != 0 and rule in done.stderr + done.stdout, done.stderr


def test_the_parameters_beside_these_can_be_built(root):
    done = start("iverilog", "-g2005", "-t", "null", "-c", "rtl/fp3.f", "-s", "fp3",
                 *[f"-Pfp3.{parameter}" for parameter in MANY], "rtl/fp3.v", cwd=root)
    assert done.returncode == 0, done.stderr
