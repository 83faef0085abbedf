"""The engine board: hardware behind a serial line. The simulated board is the whole top, pins of the line included."""

import contextlib
import ctypes
import itertools
import os
import pty
import re
import signal
import subprocess
import threading
import time
import tty

import pytest

from simulated_board import board


@contextlib.contextmanager
def host(fp3, ship, port):
    """A run that has the port and does not end by itself."""
    process = subprocess.Popen([fp3, "run", *ship[:-1], "1000000", "--engine", "board", "--port", port], stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
    try:
        while process.poll() is None and port not in opened(process):
            time.sleep(0.02)
        time.sleep(0.5)                                    # in the middle of it
        assert process.poll() is None, "the host has ended"
        yield process
    finally:
        process.kill()
        process.communicate()


def opened(process):
    with contextlib.suppress(OSError):                     # it has just ended, or closed a file
        return {os.readlink(entry) for entry in os.scandir(f"/proc/{process.pid}/fd")}
    return set()


@contextlib.contextmanager
def peer(answer):
    """A port with somebody else behind it: answer(bytes) is what comes back."""
    master, line = pty.openpty()
    tty.setraw(line)
    ended = threading.Event()

    def talk():
        while not ended.is_set():
            with contextlib.suppress(OSError):
                os.write(master, answer(os.read(master, 4096)))
    thread = threading.Thread(target=talk, daemon=True)
    thread.start()
    try:
        yield os.ttyname(line)
    finally:
        ended.set()
        os.write(line, b"x")
        thread.join()
        os.close(line)
        os.close(master)


def packet(content):
    """As docs/board.md has it."""
    import zlib
    content += zlib.crc32(content).to_bytes(4, "little")
    return b"\xc0" + content.replace(b"\xdb", b"\xdb\xdd").replace(b"\xc0", b"\xdb\xdc") + b"\xc0"


def run(fp3, *arguments, **options):
    return subprocess.run([fp3, "run", *arguments], capture_output=True, text=True, timeout=120, **options)


def fails(done, *words):
    assert done.returncode == 1, done.stdout + done.stderr
    assert all(word in done.stderr for word in words), done.stderr


def same(done, expected):
    """All but what the host's clock says."""
    assert done.returncode == expected.returncode, done.stderr
    assert done.stderr == expected.stderr
    rows = [[line for line in one.stdout.splitlines() if not re.match("board |simulator ", line)] for one in (done, expected)]
    assert rows[0] == rows[1] and len(rows[0]) > 10


@pytest.fixture(scope="module")
def ship(root, fp3, tmp_path_factory):
    image = tmp_path_factory.mktemp("ship") / "ship.fp3"
    subprocess.run([fp3, "asm", root / "programs/ship.s", "-o", image], check=True)
    return [image, "--params", root / "programs/ship.cfg", "--steps", "5"]


def test_one_object_has_the_bits_and_counters_of_rtl(fp3, ship, tmp_path):
    with board(fp3) as (_, port):
        log = tmp_path / "x.session"
        done = run(fp3, *ship, "--engine", "board", "--port", port, "--bus-log", log)
        same(done, run(fp3, *ship, "--bus-log", tmp_path / "rtl.session"))
        whole = (tmp_path / "rtl.session").read_text().splitlines()
        rows, more = iter(log.read_text().splitlines()[:-1]), []              # those of rtl, and what clears the memories before
        for line in [line for line in whole if line[0] not in "he"]:
            more += itertools.takewhile(lambda row: row != line, rows)
        assert not list(rows) and more and all(row[0] == "w" and row.endswith(" 00000000") for row in more)
        for name, more in (("board.csv", ["--engine", "board", "--port", port]), ("rtl.csv", [])):   # reads between runs
            assert run(fp3, *ship, *more, "--output", tmp_path / name, "--every", "1").returncode == 0
        assert (tmp_path / "board.csv").read_text() == (tmp_path / "rtl.csv").read_text()
        fails(run(fp3, *ship, "--engine", "board", "--port", port, "-c", "many"), "has configuration 'single', not 'many'")
        done = run(fp3, *ship, "--engine", "board", "--port", port, "--cycle-limit", "10")
        assert done.returncode == 2 and "no cycle limit" in done.stderr


def test_nothing_of_an_earlier_host_is_left(fp3, build, tmp_path):
    """Hardware keeps its memories from one host to the next: what the next one does not write is 0 all the same."""
    (tmp_path / "x.s").write_text(".state x\n.state y\n.shared k\nstep:\nmul y, y, k\nadd x, x, y\n")
    subprocess.run([fp3, "asm", tmp_path / "x.s", "-o", tmp_path / "x.fp3"], check=True)
    with board(fp3, "--config", "many") as (_, port):
        done = run(fp3, tmp_path / "x.s", "-N", "3", "--steps", "1", "-c", "many", "--engine", "board", "--port", port,
                   "--set", "x=0", "--set", "y=3e38", "--set", "k=2")
        assert done.returncode == 3 and "inf" in done.stdout
        found = subprocess.run([build / "tests/at_first", port, tmp_path / "x.fp3"], capture_output=True, text=True)
        assert (found.stdout, found.stderr) == ("0 0 0 0, 3 in 4, all bytes\n", "")  # the registers of an object in one request


def test_many_objects_of_a_model_on_a_noisy_line(root, fp3):
    """Every object fails, or none does, as in rtl; and packets were really lost."""
    what = [root / "programs/lotka_volterra.ode", "--integrator", "heun", "--objects", "12", "--steps", "3", "--all",
            "--spread", "x=0.5:1e30", "-c", "many"]
    with board(fp3, "--config", "many", "--noise", "7") as (_, port):
        done = run(fp3, *what, "--engine", "board", "--port", port)
    expected = run(fp3, *what)
    assert expected.returncode == 3, expected.stderr
    same(done, expected)
    assert int(re.search(r"(\d+) sent again", done.stdout)[1]) > 0


def test_a_board_that_goes_away(fp3, ship):
    with board(fp3) as (process, port), host(fp3, ship, port) as other:
        fails(run(fp3, *ship, "--engine", "board", "--port", port), port, "another program uses the port")
        process.send_signal(signal.SIGKILL)
        out, said = other.communicate(timeout=60)
        assert other.returncode == 1 and not out and "the other side has gone" in said, said


def test_a_host_that_goes_away_leaves_a_board_that_the_next_one_can_use(fp3, ship):
    with board(fp3) as (_, port):
        with host(fp3, ship, port) as other:
            other.kill()
            assert other.wait() == -signal.SIGKILL
        same(run(fp3, *ship, "--engine", "board", "--port", port), run(fp3, *ship))


def test_what_else_may_be_behind_a_port(fp3, ship, tmp_path):
    at = lambda port, *more: run(fp3, *ship, "--engine", "board", "--port", port, *more)
    fails(at("/dev/no-such-port"), "/dev/no-such-port: No such file", "plugged in")
    (tmp_path / "file").write_text("")
    for port in (tmp_path / "file", "/dev/null"):
        fails(at(port), f"{port}: not a serial port")
    with peer(lambda got: b"\x55\xc0" * 3) as port:
        fails(at(port), "none of them was an answer", "--baud")
        done = at(port, "--baud", "1234")
        assert done.returncode == 2 and "there are 9600" in done.stderr
    with peer(lambda got: b"") as port:
        fails(at(port), "no answer at 115200 baud", "bitstream")
    sequence = lambda got: got.lstrip(b"\xc0").replace(b"\xdb\xdc", b"\xc0").replace(b"\xdb\xdd", b"\xdb")[:1]
    with peer(lambda got: packet(sequence(got) + b"\0" + b"\x63" + b"3PF")) as port:
        fails(at(port), "revision 99 of the instruction set")
    with peer(lambda got: packet(sequence(got) + b"\0" + bytes(4))) as port:
        fails(at(port), "not FP3", "0x00000000")


def without_the_rights_of_root():
    """Of what root may read and write all the same; others never could."""
    for capability in (1, 2):                              # CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH
        ctypes.CDLL(None).prctl(24, capability)            # PR_CAPBSET_DROP


def test_a_port_of_somebody_else(fp3, ship, tmp_path):
    (tmp_path / "port").touch(mode=0)
    fails(run(fp3, *ship, "--engine", "board", "--port", tmp_path / "port", preexec_fn=without_the_rights_of_root),
          "port: Permission denied", "the group that owns the port, often dialout")


def test_hardware_of_no_configuration(root, fp3, ship):
    """It is FP3, but made with parameters that have no name: with --config and without."""
    revision = int(re.search(r"^revision = (\d+)", (root / "isa/isa.toml").read_text(), re.M)[1])

    def answer(got):
        content = got.lstrip(b"\xc0").replace(b"\xdb\xdc", b"\xc0").replace(b"\xdb\xdd", b"\xdb")
        return packet(content[:1] + b"\0" + (bytes([revision]) + b"3PF" if content[2:6] == bytes(4) else bytes(4)))
    with peer(answer) as port:
        fails(run(fp3, *ship, "--engine", "board", "--port", port), port, "none of this libfp3's configurations")
        fails(run(fp3, *ship, "--engine", "board", "--port", port, "-c", "single"), "is not configuration 'single': at 0x0004", "it has 0x00000000")


def test_options_that_do_not_go_together(fp3, ship):
    for arguments, said in ((["--engine", "board"], "expected --port"), (["--port", "x"], "only engine board"),
                            (["--engine", "board", "--port", "x", "--kanata", "y"], "engine rtl")):
        done = run(fp3, *ship, *arguments)
        assert done.returncode == 2 and said in done.stderr, done.stderr
    done = subprocess.run([fp3, "board", "--config", "paper"], capture_output=True, text=True, timeout=20)
    assert done.returncode == 1 and "fp3_board_paper.so" in done.stderr
