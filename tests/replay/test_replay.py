"""A recorded host session under Icarus: same answers, same cycles, same hash of every retirement."""

import re
import subprocess

import pytest

SESSIONS = [("ship", "single"), ("ship_madd", "single"), ("ship_paper", "paper"), ("ship", "paper")]


def start(*command, cwd):
    return subprocess.run([str(word) for word in command], cwd=cwd, capture_output=True, text=True, timeout=300)


@pytest.fixture
def icarus(build):
    """The replay bench of a configuration, as make has compiled it."""
    return lambda config: build / f"icarus/replay_{config}.vvp"


def record(root, fp3, tmp_path, program, config, steps):
    image, session = tmp_path / "x.fp3", tmp_path / "x.session"
    assert start(fp3, "asm", f"programs/{program}.s", "-o", image, cwd=root).returncode == 0
    done = start(fp3, "run", image, "-c", config, "--steps", steps, "--params", "programs/ship.cfg",
                 "--bus-log", session, cwd=root)
    assert done.returncode == 0, done.stderr
    return session


def replay(root, vvp, session, *more):
    return start("vvp", "-n", vvp, f"+session={session}", *more, cwd=root)


@pytest.mark.parametrize("program, config", SESSIONS)
def test_icarus_agrees_with_verilator(root, fp3, icarus, tmp_path, program, config):
    session = record(root, fp3, tmp_path, program, config, 30)
    done = replay(root, icarus(config), session)
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


def test_the_bench_compiles_without_a_warning(root):
    done = start("iverilog", "-g2012", "-Wall", "-Wno-timescale", "-s", "replay", "-t", "null", "-c", "rtl/fp3.f",
                 "sim/replay.v", "rtl/gen/fp3_single.v", cwd=root)
    assert (done.returncode, done.stdout + done.stderr) == (0, "")


def test_committed_sessions_are_what_the_host_sends(root, fp3, tmp_path):
    """`make sessions` records them again."""
    committed = sorted(root.glob("programs/*.session"))
    assert committed
    for path in committed:
        program, config, _ = path.name.split(".")
        assert record(root, fp3, tmp_path, program, config, 100).read_text() == path.read_text(), path.name


def test_the_wave_preset_names_signals_that_exist(root, fp3, icarus, tmp_path):
    session, dump = record(root, fp3, tmp_path, "ship_madd", "single", 2), tmp_path / "x.vcd"
    assert replay(root, icarus("single"), session, f"+waves={dump}").returncode == 0
    scope, known = [], set()
    for line in dump.read_text().splitlines():
        words = line.split()
        if line.startswith("$scope"):
            scope.append(words[2])
        elif line.startswith("$upscope"):
            scope.pop()
        elif line.startswith("$var"):
            known.add(".".join([*scope, "".join(words[4:-1])]))
        elif line.startswith("$enddefinitions"):
            break
    shown = {line for line in (root / "sim/fp3.gtkw").read_text().splitlines() if line.startswith("replay.")}
    assert len(shown) > 30 and shown <= known, sorted(shown - known)
    assert "madd" in bytes.fromhex("".join(f"{int(bits, 2):064x}" for bits in re.findall(
        r"^b([01]{100,256}) ", dump.read_text(), re.M))).decode("latin-1"), "no mnemonic to be read"


def test_the_last_of_64_contexts_is_addressed(root, tmp_path):
    """The largest build: the objects' window is full, and the constants are a context beyond it."""
    wrapper, session, bench = tmp_path / "fp3_crowd.v", tmp_path / "x.session", tmp_path / "x.vvp"
    text = (root / "rtl/gen/fp3_many.v").read_text()
    assert re.search(r"\.CONTEXTS +\(16\)", text)
    wrapper.write_text(re.sub(r"(\.CONTEXTS +)\(16\)", r"\1(64)", text).replace("fp3_many", "fp3_crowd"))
    words = {0x2000: 0x11111111, 0x4000: 0x22222222, 0x4100: 0x33333333, 0x7f00: 0x44444444}
    session.write_text("".join(f"{kind} {at:04x} {word:08x}\n" for kind in "wr" for at, word in words.items()))
    start("iverilog", "-g2012", "-DTOP=fp3_crowd", "-s", "replay", "-c", "rtl/fp3.f", "-o", bench, "sim/replay.v",
          wrapper, cwd=root)
    done = replay(root, bench, session)
    assert done.returncode == 0 and "PASS" in done.stdout, done.stdout


@pytest.mark.parametrize("parameter, value, rule", [
    ("REGISTERS", 24, "REGISTERS_must_be"), ("PROGRAM_WORDS", 2048, "PROGRAM_WORDS_must_be"),
    ("CONTEXTS", 65, "CONTEXTS_must_be"), ("ADD_LATENCY", 0, "ADD_LATENCY_must_be"),
    ("MUL_LATENCY", 0, "MUL_LATENCY_must_be")])
def test_a_parameter_that_cannot_be_built_stops_elaboration(root, parameter, value, rule):
    done = start("iverilog", "-g2005", "-t", "null", "-c", "rtl/fp3.f", "-s", "fp3", f"-Pfp3.{parameter}={value}",
                 "rtl/fp3.v", cwd=root)
    assert done.returncode != 0 and rule in done.stderr + done.stdout, done.stderr
