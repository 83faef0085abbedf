"""Hostile command lines, models, assembly and images. Each row: the command, its exit code if that is not 2, and what it must
say. Nothing crashes, hangs, gives a number, or loses a file."""

import os
import random
import shutil
import struct
import subprocess
import zlib
from concurrent.futures import ThreadPoolExecutor

import pytest

SWING = "state x = 1\nstate v = 0\nparam k = 1\nx' = v\nv' = -k*x\nstep 0.01\n"
ONE = ".state x\nstep:\n    add x, x, 1.0\n"
LIMITS = "from 0 to 4294967295"


@pytest.fixture
def folder(fp3, tmp_path):
    (tmp_path / "m.ode").write_text(SWING)
    (tmp_path / "p.s").write_text(ONE)
    (tmp_path / "empty").write_text("")
    (tmp_path / "empty.ode").write_text("")
    (tmp_path / "empty.s").write_text("")
    (tmp_path / "folder.ode").mkdir()
    (tmp_path / "loop.ode").symlink_to("loop.ode")
    (tmp_path / "gone.ode").symlink_to("nowhere")
    (tmp_path / "ro").write_text("kept")
    subprocess.run([fp3, "asm", "p.s", "-o", "p.fp3"], cwd=tmp_path, check=True)
    return tmp_path


LINES = {
    # commands
    "": "Usage: ",
    "nope": "found 'nope', expected a command: asm compile",
    "RUN m.ode": "found 'RUN', .*did you mean run",
    "comple m.ode": "did you mean compile",
    "--nope": "unrecognized option '--nope'",
    "run": "expected a program, or --scene FILE",
    "compile": "expected a model",
    "compare": "expected a model",
    "tune": "expected a model",
    "tune m.ode m.ode": "expected one model or scene",
    "asm": "expected a source",
    "dis": "expected an image or --word",
    "run m.ode m.ode": "found 'm.ode', expected one program",
    "compile m.ode m.ode": "expected one model",
    "asm p.s p.s": "expected one source",
    "bench p.s": r"found 'p.s', expected a model \(\*.ode\)",
    "bench m.ode --steps 3": "found --steps and 'm.ode': with MODEL there are",
    "bench --quick": "found --quick, expected MODEL",
    "bench -i rk4": "found --integrator, expected MODEL",
    "info p.fp3 p.fp3": "expected one image",
    "dis p.fp3 --word 0x1": "expected an image or --word",
    # options
    "run m.ode --stesp 3": "no option --stesp; did you mean --steps",
    "run m.ode --Steps 3": "no option --Steps; did you mean --steps",
    "run m.ode --zzzzzzzz": r"no option --zzzzzzzz\n",
    "run m.ode --": None,
    "run m.ode -- --steps": "found '--steps', expected one program",
    "run m.ode --steps": "option '--steps' requires an argument",
    "run m.ode -n": "option requires an argument -- 'n'",
    "run m.ode --all=yes": "option '--all' doesn't allow an argument",
    "run m.ode --s 3": "option '--s' is ambiguous",
    "run m.ode -y": "invalid option -- 'y'",
    "run m.ode --steps 1 --steps 2": "--steps is given twice",
    "run m.ode -n 1 --steps=1": "--steps is given twice",
    "run m.ode -n1 -n1": "--steps is given twice",
    "compile m.ode -o a -o b": "--output is given twice",
    "compile m.ode --config many_full -c single": "--config is given twice",
    # numbers
    "run m.ode --steps -1": f"--steps: '-1' is no number {LIMITS}",
    "run m.ode --steps 4294967296": f"'4294967296' is no number {LIMITS}",
    "run m.ode --steps 99999999999999999999999": LIMITS,
    "run m.ode --steps 1e3": f"'1e3' is no number {LIMITS}",
    "run m.ode --steps 0x10": LIMITS,
    "run m.ode --steps=": f"'' is no number {LIMITS}",
    "run m.ode --steps +5": LIMITS,
    "run m.ode --steps 5.0": LIMITS,
    "run m.ode --objects 0": "'0' is no number from 1 to 4294967295",
    "run m.ode --objects 4294967295": "configuration 'single_full' has room for 1 object",
    "run m.ode -c many_full -N 4294967295": "4294967295 objects: .* has room for",
    "run m.ode --visit 0": "from 1 to 4294967295",
    "run m.ode --visit 2": "--visit: configuration 'single_full' does not interleave",
    "run m.ode -e isa --threads 2": "--threads: only engine fast has threads, not engine 'isa'",
    "run m.ode --threads 2": "not engine 'rtl'",
    "tune m.ode --tolerance 1e-3 --spread k=1:2 --set k=1": "found both --set and --spread of 'k'",
    "tune m.ode --tolerance 1e-3 --set k=1 --spread k=1:2": "found both --set and --spread of 'k'",
    f"run {300 * 'long/'}m.ode": "^fp3 run: long/.*long.*\\.\\.\\..*/m.ode: cannot open: No such file or directory$",
    "run m.ode --cycle-limit -5": "from 0 to 18446744073709551615",
    "run m.ode --clock 5": "no frequency",
    "bench -n 0": "from 1 to 10000000",
    "bench -n 10000001": "from 1 to 10000000",
    "compare m.ode --most-steps 7": "from 8 to 8388608",
    "compare m.ode --most-steps 8388609": "from 8 to 8388608",
    "compare m.ode --span 0": "found '0', expected a number above 0",
    "compare m.ode --span nan": "--span: 'nan' is no number",
    "compare m.ode --span 1e999": "--span: '1e999' is no number",
    "compare m.ode --span ten": "--span: 'ten' is no number",
    "compare m.ode --span=": "--span: '' is no number",
    "dis --word 1": "expected a word as 0x",
    "dis --word 0x": "expected a word as 0x",
    "dis --word 0x100000000": "expected a word as 0x",
    "dis --word 0xffffffff": "0xffffffff",
    # values
    "run m.ode --set x": "'x' is not name=value",
    "run m.ode --set =1": "'' is no name",
    "run m.ode --set x=": "'x=': '' is no number",
    "run m.ode --set x=1;y=2": "is no number",
    "run m.ode --set y=1": "no 'y'",
    "run m.ode --set x=1e39": "'x' is 1e\\+39|too large|expected",
    "run m.ode --set h=0": "expected",
    "run m.ode --set h=-1": "expected",
    "run m.ode --set h=1e-50": "expected",
    "run m.ode --set h=nan": "expected|no number",
    "run m.ode --set k=1/0": "expected|no number|finite",
    "run m.ode -o 16": "-o, --output: found '16', expected a file \\(./16\\); the number of objects is -N, --objects",
    "run m.ode --spread x=1": "is not name=first:last",
    "run m.ode --spread h=1:2": "'h' is spread",
    "run p.fp3": "'x' has no value",
    # names
    "run m.ode -c nope": "no configuration 'nope': there are",
    "compile m.ode -c nope": "no configuration 'nope': there are",
    "run m.ode -c": "requires an argument",
    "run m.ode -e nope": "no engine 'nope': there are rtl, isa, fast and board",
    "run m.ode -i nope": "no integrator 'nope': there are",
    "compile m.ode -i nope.cfg": "nope.cfg: cannot open",
    "compile m.ode --with nope": "found 'nope', expected a pass",
    "compile m.ode --observe nope": "no state 'nope'",
    "compile m.ode --set x=1": "expected --params FILE, too",
    "run p.s -i rk4": "only a model",
    "run p.s --compensated": "only a model",
    "run m.ode --scene m.ode": "the scene names its programs",
    "run --scene m.ode --model": "known by their names",
    "run m.ode -e isa --kanata log": "only the hardware",
    "run m.ode -e isa --bus-log log": "only the hardware",
    # files
    "run nope.ode": "nope.ode: cannot open: No such file",
    "run folder.ode": "folder.ode: cannot read: Is a directory",
    "run loop.ode": "loop.ode: cannot open: Too many levels",
    "run gone.ode": "gone.ode: cannot open: No such file",
    "run m.ode/x": "m.ode/x: cannot open: Not a directory",
    "run /dev/null": "/dev/null: ",
    "run /dev/zero": "/dev/zero: longer than 67108864 bytes",
    "compile /dev/null": "found end of file",
    "run empty": "empty: ",
    "run empty.ode": "empty.ode:1:1: error: found end of file",
    "run empty.s": "empty.s:1:1: error: ",
    "run --scene empty": "empty:1: ",
    "run m.ode --params empty.ode": None,
    "run m.ode --params nope": "nope: cannot open",
    "run m.ode --params folder.ode": "folder.ode: ",
    "run m.ode": None,
    "compile p.s": r"expected a model \(\*.ode, or --model\)",
    "compile --model p.s": "p.s:1:1: error: ",
    "compare p.fp3": "expected a model",
    "asm m.ode": "m.ode:1:1: error: ",
    "dis m.ode": "m.ode: ",
    "info m.ode": "m.ode: ",
    "run -": "-: ",
    "bench -p -": "each configuration reads it again",
    "bench nope": "programs/nope.ode: cannot open",
    "bench -": "programs/-.ode: cannot open",
    "bench ./m.ode -j m.ode": "would overwrite MODEL ./m.ode",
    "bench -p nope": "no program programs/nope.s or programs/nope.ode",
    "compile m.ode -o folder.ode": "folder.ode: cannot write: Is a directory",
    "compile m.ode -o nowhere/x": "nowhere/x: cannot write: No such file",
    "compile m.ode -o m.ode": "would overwrite MODEL m.ode",
    "run m.ode --kanata p.fp3/x": "cannot write: Not a directory",
    "asm p.s -o loop.ode": "cannot write: Too many levels",
}


@pytest.mark.parametrize("line", LINES)
def test_a_command_line(hostile, refused, folder, line):
    if LINES[line] is None:  # allowed, odd as it looks
        assert hostile({}, line.split()).returncode == 0
    else:
        refused({}, line.split(), LINES[line])


# ---- models ----

def model(expression):
    return f"state x = 1\nx' = {expression}\nstep 0.01\n"


MODELS = {
    "binary": (bytes(range(256)) * 40, r"x\.ode:1:1: error: "),
    "an image": (b"FP3I\0\0\0\0", r"x\.ode:1:"),
    "one NUL": ("\0", r"x\.ode:1:1: error: "),
    "a NUL in a line": (SWING.replace("-k", "-\0k"), r"x\.ode:5:7: error: "),
    "UTF-16": (SWING.encode("utf-16"), r"x\.ode:1:1: error: "),
    "a lone byte order mark": (b"\xef\xbb\xbf", r"x\.ode:1:\d: error: found end of file"),
    "two byte order marks": (b"\xef\xbb\xbf" * 2 + SWING.encode(), r"x\.ode:1:1: error: "),
    "bytes that are no UTF-8": (b"state \xff\xfe = 1\n", r"x\.ode:1:7: error: "),
    "old Mac lines": (SWING.replace("\n", "\r"), r"x\.ode:1:\d+: error: "),
    "an escape sequence": ("state \x1b[31mx = 1\n", r"x\.ode:1:7: error: "),
    "a line of 1 MiB": (model("x" + " + x" * 262144), r"x\.ode:"),
    "a comment of 2 MiB": ("#" * (2 << 20), r"x\.ode:"),
    "a name of 1 MiB": ("state " + "x" * (1 << 20) + " = 1\n", r"x\.ode:"),
    "parentheses, 100,000 deep": (model("(" * 100000 + "x" + ")" * 100000), r"x\.ode:\d:\d+: error: .*deep"),
    "minus signs, 100,000 deep": (model("-" * 100000 + "x"), r"x\.ode:\d:\d+: error: .*deep"),
    "powers, 100,000 deep": (model("x" + "^1" * 100000), r"x\.ode:\d:\d+: error: "),
    "choices, 100,000 deep": (model("x < 1 ? " * 100000 + "x"), r"x\.ode:\d:\d+: error: "),
    "100,000 states": ("".join(f"state s{i} = 1\ns{i}' = 1\n" for i in range(50000)), r"x\.ode:"),
    "100,000 errors": ("? ?\n" * 20000, "20 errors; there may be more"),
    "a number of 100,000 digits": (model("x * " + "9" * 100000), r"x\.ode:2:"),
    "a number beyond double": (model("x * 1e999"), r"x\.ode:2:10: error: found '1e999'"),
    "an odd number": (model("x * 1.2.3"), r"x\.ode:2:10: error: found '1\.2\.3'"),
    "no step": ("state x = 1\nx' = 1\n", "expected a time step"),
    "a step of 0": (model("x").replace("0.01", "0"), r"x\.ode:3:6: error: found '0'"),
    "a step below FP32": (model("x").replace("0.01", "1e-50"), r"x\.ode:3:6: error: "),
    "a step that is no number": (model("x").replace("0.01", "nan"), r"x\.ode:3:"),
    "no equation": ("state x = 1\nstep 0.01\n", "expected an equation for this state"),
    "itself": ("state x = 1\ny = y + 1\nx' = y\nstep 0.01\n", r"x\.ode:2:5: error: "),
    "an exponent that is a state": (model("2^x"), r"x\.ode:2:"),
    "a text without an end": ('param k = 1 "no end\n' + model("x"), r"x\.ode:1:"),
    "a unit without an end": ("param k = 1 [m\n" + model("x"), r"x\.ode:"),
    "the wrong unit": ("param k = 1 [kg]\nstate x = 1 [m]\nx' = k\nstep 0.01 [s]\n", r"x\.ode:3:"),
    "a product that leaves FP32": (model("x * 1e30 * 1e30 + 1e60"), r"x\.ode:2:\d+: error: .*FP32"),
    "words for the whole configuration": (model(" + ".join(f"x^{2 + i % 7}*{i}.5" for i in range(2000))), r"x\.ode|needs"),
}


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("command", ["compile", "run -e isa"])
def test_a_model(refused, name, command):
    text, message = MODELS[name]
    refused({"x.ode": text}, [*command.split(), "x.ode"], message)


def test_a_division_of_knowns_by_0_is_found_when_the_host_computes_it(refused):
    refused({"x.ode": model("x * (1/0)")}, ["run", "-e", "isa", "x.ode"], "finite|1/0")


# ---- assembly ----

SOURCES = {
    "binary": (bytes(range(256)) * 40, r"x\.s:1:1: error: "),
    "one NUL": ("\0", r"x\.s:1:1: error: "),
    "a NUL in a line": (ONE.replace("add", "a\0d"), r"x\.s:3:"),
    "UTF-16": (ONE.encode("utf-16"), r"x\.s:1:1: error: "),
    "old Mac lines": (ONE.replace("\n", "\r"), r"x\.s:"),
    "a line of 1 MiB": (ONE + "add x, x, " + "9" * (1 << 20) + "\n", r"x\.s:4:"),
    "a name of 1 MiB": (".state " + "x" * (1 << 20) + "\n", r"x\.s:1:8: error: "),
    "a million labels": ("step:\n" + "".join(f"l{i}:\n" for i in range(200000)), r"x\.s:"),
    "a million words": (".state x\nstep:\n" + "add x, x, x\n" * 70000, r"x\.s:\d+:\d+: error: .*65536"),
    "65 registers": ("".join(f".state s{i}\n" for i in range(65)) + "step:\nadd s0, s0, s64\n", r"x\.s:65:"),
    "65 constants": (".state x\nstep:\n" + "".join(f"add x, x, {i}.5\n" for i in range(65)), r"x\.s:67:"),
    "a register beyond the last": (".state x\nstep:\nadd x, x, %r64\n", r"x\.s:3:11: error: "),
    "a number beyond FP32": (ONE.replace("1.0", "1e39"), r"x\.s:3:15: error: "),
    "a number below FP32": (ONE.replace("1.0", "1e-60"), r"x\.s:3:15: error: "),
    "no step": (".state x\nadd x, x, x\n", r"x\.s:\d:\d+: error: "),
    "two steps": (ONE + "step:\n", r"x\.s:4:1: error: "),
    "20,000 errors": ("? ?\n" * 20000, "20 errors; there may be more"),
    "an escape sequence": (".state \x1b[31m\n", r"x\.s:1:8: error: "),
}


@pytest.mark.parametrize("name", SOURCES)
@pytest.mark.parametrize("command", ["asm", "run -e isa"])
def test_a_source(refused, name, command):
    text, message = SOURCES[name]
    refused({"x.s": text}, [*command.split(), "x.s"], message)


@pytest.mark.parametrize("name, text", [("m.ode", SWING), ("p.s", ONE)])
def test_line_ends_and_a_byte_order_mark_change_nothing(hostile, name, text):
    run = ["run", name, "-e", "isa", "-n", "5", "--set", "x=2"]
    cut = [line for line in hostile({name: text}, run).stdout.splitlines() if b"object " in line]
    for other in (text.replace("\n", "\r\n"), "\ufeff" + text, "\ufeff" + text.replace("\n", "\r\n"), text.rstrip("\n")):
        assert [line for line in hostile({name: other}, run).stdout.splitlines() if b"object " in line] == cut != []


# ---- images ----

def sealed(words):
    body = struct.pack(f"<{len(words)}I", *words)
    return body + struct.pack("<I", zlib.crc32(body))


IMAGES = {  # what is done to the words before their sum, and what is said
    "the magic": (lambda w: [w[0] ^ 1, *w[1:]], "x.fp3: "),
    "the revision": (lambda w: [w[0], w[1] + 1, *w[2:]], "revision"),
    "fewer words than it says": (lambda w: [*w[:2], w[2] + 1, *w[3:]], "x.fp3: "),
    "more words than it says": (lambda w: [*w, 0], "x.fp3: "),
    "4 billion words of code": (lambda w: [*w[:3], 0xffffffff, *w[4:]], "x.fp3: "),
    "no code": (lambda w: [*w[:3], 0, *w[4:]], "x.fp3: "),
    "a step behind the last": (lambda w: [*w[:4], 9, *w[5:]], "x.fp3: "),
    "a last behind the end": (lambda w: [*w[:5], 9, *w[6:]], "x.fp3: "),
    "4 billion constants": (lambda w: [*w[:6], 0xffffffff, *w[7:]], "x.fp3: "),
    "counts that overflow together": (lambda w: [*w[:6], 0x80000000, 0x80000000, *w[8:]], "x.fp3: "),
    "4 billion symbols": (lambda w: [*w[:7], 0xffffffff, *w[8:]], "x.fp3: "),
    "other registers than it uses": (lambda w: [*w[:8], w[8] + 1, *w[9:]], "x.fp3: "),
}


@pytest.mark.parametrize("name", IMAGES)
@pytest.mark.parametrize("command", ["run -e isa --set x=1", "dis", "info"])
def test_an_image(refused, folder, name, command):
    whole = (folder / "p.fp3").read_bytes()
    change, message = IMAGES[name]
    words = change(list(struct.unpack(f"<{len(whole) // 4 - 1}I", whole[:-4])))
    refused({"x.fp3": sealed(words)}, [*command.split(), "x.fp3"], message)


def test_every_truncated_image_is_refused(refused, folder):
    whole = (folder / "p.fp3").read_bytes()
    for size in range(len(whole)):
        refused({"x.fp3": whole[:size]}, ["dis", "x.fp3"], "x.fp3: ")


def test_every_flipped_bit_of_an_image_is_refused(refused, folder):
    whole = (folder / "p.fp3").read_bytes()
    chance = random.Random(1)
    for bit in chance.sample(range(8 * len(whole)), 200):
        bad = bytearray(whole)
        bad[bit // 8] ^= 1 << bit % 8
        refused({"x.fp3": bytes(bad)}, ["run", "x.fp3", "-e", "isa", "--set", "x=1"], "x.fp3: ")


# ---- what is no file ----

def test_a_pipe_without_a_writer_or_a_reader_ends(fp3, folder, fast_clock):
    silent, deaf = b"pipe.ode: a pipe that no process writes into", b"pipe.ode: cannot write: "
    cases = [(["compile", "pipe.ode"], silent), (["run", "m.ode", "--params", "pipe.ode"], silent), (["asm", "p.s", "-o", "pipe.ode"], deaf)]
    for number in range(len(cases)):                                       # a pipe each: they wait at the same time
        (folder / str(number)).mkdir()
        for name in ("m.ode", "p.s"):
            shutil.copy(folder / name, folder / str(number))
        os.mkfifo(folder / str(number) / "pipe.ode")
    with ThreadPoolExecutor() as pool:
        ended = list(pool.map(lambda n: subprocess.run([fp3, *cases[n][0]], cwd=folder / str(n), capture_output=True, timeout=60,
                                                          env={**os.environ, **fast_clock}), range(len(cases))))
    for done, (_, message) in zip(ended, cases):
        assert done.returncode == 2 and message in done.stderr


def test_streams_that_are_closed(fp3, folder):
    for shell, code in (("compile m.ode >&-", 1), ("compile m.ode -o - >&-", 2), ("compile - <&-", 2), ("info >&- 2>&-", 1)):
        done = subprocess.run(["sh", "-c", f"{fp3} {shell}"], cwd=folder, capture_output=True, timeout=60)
        assert done.returncode == code, shell
    assert (folder / "m.ode").read_text() == SWING


def test_a_name_in_a_scene_does_not_control_the_terminal(hostile, folder):
    """Neither what is printed nor a message: ESC, and the controls of UTF-8 (U+009B begins a sequence, too)."""
    name = "x\x1b[2J\u009b2J\u00e9.s"
    scene = 'config = "many"; groups = ({ program = "%s"; objects = 2; set = { x = 1.0; }; });'
    for at in ([], ["--steps", "99999999999"]):
        done = hostile({name: ONE, "x.scene": scene % name}, ["run", "-e", "isa", "--scene", "x.scene", *at])
        said = (done.stdout + done.stderr).decode()
        assert "\x1b" not in said and "\u009b" not in said
    assert "x?[2J??2J\u00e9.s" in hostile({}, ["run", "-e", "isa", "--scene", "x.scene"]).stdout.decode()
    done = hostile({"x.scene": scene % ("\u009b" + name[:-2] + "none.s")}, ["run", "-e", "isa", "--scene", "x.scene"])
    assert done.returncode == 2 and b"cannot open" in done.stderr and "\u009b" not in done.stderr.decode()
