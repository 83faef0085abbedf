"""The assembler: what it encodes, what it refuses and with which words."""

import random
import struct
import subprocess
import tomllib
import zlib

import pytest

pytestmark = pytest.mark.smoke


@pytest.fixture
def run(fp3, tmp_path):
    """Runs `fp3 ARGUMENTS` in an empty directory."""

    def run(*arguments, **options):
        return subprocess.run(
            [fp3, *map(str, arguments)], cwd=tmp_path, text=True, errors="replace",
            capture_output=True, timeout=60, **options,
        )

    return run


@pytest.fixture
def assemble(run, tmp_path):
    """Assembles text (or bytes); gives the image's words."""

    def assemble(source, *arguments):
        data = source if isinstance(source, bytes) else source.encode()
        (tmp_path / "in.s").write_bytes(data)
        got = run("asm", "in.s", "-o", "out.fp3", *arguments)
        assert (got.returncode, got.stderr) == (0, ""), got.stderr
        return words_of(tmp_path / "out.fp3")

    return assemble


def words_of(path):
    data = path.read_bytes()
    return list(struct.unpack(f"<{len(data) // 4}I", data))


def code_of(words):
    return words[9 : 9 + words[3]]


def constants_of(words):
    at = 9 + words[3]
    return {words[at + 2 * i]: words[at + 2 * i + 1] for i in range(words[6])}


def symbols_of(words):
    at = 9 + words[3] + 2 * words[6]
    kinds = ["state", "param", "temp", "shared", "const", "label", "worst"]
    found = []
    for i in range(words[7]):
        head, *name = words[at + 9 * i : at + 9 * i + 9]
        text = struct.pack("<8I", *name).rstrip(b"\0").decode()
        found.append((kinds[head >> 24], text, head & 0xFFFFFF))
    return found


def f32(value):
    return struct.unpack("<I", struct.pack("<f", value))[0]


# ---- what is encoded ----------------------------------------------------------------------------


def test_words_are_those_of_isa_toml(assemble, root):
    isa = tomllib.loads((root / "isa" / "isa.toml").read_text())
    seed = 4
    choose = random.Random(seed)
    lines, expected = [], []
    alone = [op for op in isa["op"] if op.get("needs") not in ("neighbours", "keep")]  # those have an order: tests/world; these are a driver's
    for _ in range(500):
        op = choose.choice(alone)
        word, text = op["code"] << isa["field"]["op"][1], []
        for letter in op["operands"]:
            bank = isa["bank"]["object" if letter == "d" else choose.choice(["object", "shared"])]
            index = choose.randrange(bank["count"])
            if letter == "d" and op["name"] in ("sleep", "lds"):
                index = 43  # a program sleeps in one register
            word |= bank["base"] + index << isa["field"][letter][1]
            text.append(f"{bank['prefix']}{index}")
        lines.append(f"{op['name']} {', '.join(text)}")
        expected.append(word)
    got = code_of(assemble("step:\n" + "\n".join(lines)))
    for line, want, word in zip(lines, expected, got, strict=True):
        assert f"{word:08x}" == f"{want:08x}", f"seed {seed}: {line}"


def test_image_layout(assemble):
    words = assemble(
        """
        .state v s          # comments
        .param T ; of both kinds
        .temp  t = r9
        .shared h
        .const third = k5 0.33333334
        first: add t, v, s
        step:  mul v, h, third
        mark:  sub s, v, 2.5
        last:  add s, s, T
        """
    )
    assert words[:9] == [
        int.from_bytes(b"FP3I", "little"), 3, len(words), 4, 1, 3, 2, 7, 10 | 6 << 16,
    ]
    assert constants_of(words) == {5: f32(0.33333334), 1: f32(2.5)}
    assert symbols_of(words) == [
        ("state", "v", 0), ("state", "s", 1), ("param", "T", 2), ("temp", "t", 9),
        ("shared", "h", 0), ("const", "third", 5), ("label", "mark", 2),
    ]
    assert words[-1] == zlib.crc32(struct.pack(f"<{len(words) - 1}I", *words[:-1]))


@pytest.mark.parametrize(
    ("text", "bits"),
    [
        ("0.5", 0x3F000000), ("-0.0", 0x80000000), ("0", 0), ("+2", 0x40000000), (".5", 0x3F000000),
        ("1e3", 0x447A0000), ("1E+3", 0x447A0000), ("0x1.8p-1", 0x3F400000), ("inf", 0x7F800000),
        ("-inf", 0xFF800000), ("nan", 0x7FC00000), ("-nan", 0xFFC00000), ("bits:0x7f800001", 0x7F800001),
        ("bits:0x3", 3), ("0.16666667", 0x3E2AAAAB), ("1.4e-45", 1), ("3.4028235e38", 0x7F7FFFFF),
        # Ties and near-ties of the nearest rounding, where going through a double would go wrong.
        ("1.000000059604644775390625", 0x3F800000), ("1.0000000596046447753906251", 0x3F800001),
        ("1.00000017881393432617187499999999", 0x3F800001),
        ("7.1e-46", 1),
    ],
)  # fmt: skip
def test_numbers(assemble, text, bits):
    words = assemble(f".const c {text}\nstep: add r0, c, {text}")
    assert constants_of(words) == {0: bits}
    assert code_of(words)[0] & 0x3FFF == 64 << 7, "the number and the constant of its bits are one"


def test_one_constant_for_all_uses_of_the_same_bits(assemble):
    words = assemble("step: add r0, 0.5, 5e-1\nmul r0, 0x1p-1, -0.0\nsub r0, 0.0, bits:0x80000000")
    assert constants_of(words) == {0: f32(0.5), 1: 0x80000000, 2: 0}


def test_registers_named_by_number_are_not_given_to_names_and_numbers(assemble):
    words = assemble(".temp a b\n.shared h\nstep: add r0, a, k0\nmul r2, b, 0.5\nsub a, h, k2")
    assert symbols_of(words) == [("temp", "a", 1), ("temp", "b", 3), ("shared", "h", 1)]
    assert constants_of(words) == {3: f32(0.5)}


def test_a_name_hides_the_register_that_is_spelled_alike(assemble):
    words = assemble(".temp k1 = r5\n.const %k1 0.25\nstep: add r0, k1, %k1")
    assert code_of(words)[0] & 0x1FFFFF == 5 << 14 | 65 << 7
    assert constants_of(words) == {1: f32(0.25)}


SLEEPERS = {
    "a state": ".state v slept\n.shared eps\nstep: sleep slept, v, eps",
    "declared later": "step: sleep slept, v, eps\n.shared eps\n.state v slept",
    "twice": ".state slept\nstep: sleep slept, r0, 0.5\nlast: sleep slept, 1.0, 0.5",
    "by name and by number": ".state slept = r5\nstep: sleep slept, r1, 0.5\nsleep r5, r1, 0.5",
    "without a name": ".temp t\nstep: sleep r9, t, 0.5",
    "a program that loads and stores": ".state slept\nstep: lds slept\nld r7\nsleep slept, r7, 0.5\nst r7\nst slept",
    "called like an instruction": ".state sleep\nstep: lds: sleep sleep, r7, 0.5",
}


@pytest.mark.parametrize("source", SLEEPERS.values(), ids=SLEEPERS.keys())
def test_sleep_takes_one_state_or_a_register_without_a_name(assemble, source):
    words = code_of(assemble(source))
    sleeps = [word for word in words if word >> 27 == 6]
    assert sleeps and len({word >> 21 & 63 for word in words if word >> 27 in (6, 8)}) == 1


def test_words_of_the_object_store(assemble):
    words = code_of(assemble("step: sleep r2, r0, k1\nld r2\nlds r2\nst r2\nst r63"))
    assert words == [0x30402080, 0x38400000, 0x40400000, 0x48400000, 0x4FE00000]


def test_a_register_that_a_load_or_store_names_is_not_given_to_a_name(assemble):
    words = assemble(".temp a b\nstep: ld r0\nst r1\nadd a, b, b")
    assert symbols_of(words) == [("temp", "a", 2), ("temp", "b", 3)] and words[8] == 4


def test_names_may_be_declared_after_their_use(assemble):
    assert code_of(assemble("step: add v, v, v\n.state v = r7")) == [1 << 27 | 7 << 21 | 7 << 14 | 7 << 7]


WAYS = {
    "plain": "step:\nadd r0, r0, r0",
    "one line": "step:add\tr0 , r0 ,r0 # x",
    "byte order mark and CR": "\ufeffstep:\r\n\tadd r0, r0, r0\r\n",
    "labels in a row": "first:\nstep:\nx: y:\nadd r0, r0, r0\nlast:",
    "comments": "\n\n;\n#\nstep: ; step: step:\nadd r0, r0, r0 ;add\n\n",
    "anything in a comment": "step: add r0, r0, r0 # Gr\u00fc\u00dfe \0 \x01",
    "a very long line": "step: add r0, r0, r0" + " " * 300000 + "# " + "x" * 300000,
}


@pytest.mark.parametrize("source", WAYS.values(), ids=WAYS.keys())
def test_ways_to_write_the_same(assemble, source):
    assert code_of(assemble(source)) == [1 << 27]


def test_as_many_as_there_are(assemble):
    names = [f"n{i}" for i in range(64)]
    consts = "\n".join(f".const c{i} {i}" for i in range(64))
    words = assemble(f".temp {' '.join(names)}\n{consts}\nstep:\n" + "add n63, n0, 63\n" * 65536)
    assert (words[3], words[8]) == (65536, 64 | 64 << 16)


# ---- what is refused ----------------------------------------------------------------------------

STEP = "step:\nadd r0, r0, r0\n"
LONG = "n" * 32
REFUSED = [
    # name, source, expected: "line:column: error: ..." each
    ("unknown mnemonic", "step:\n  ad r0, r0, r0", ["2:3: error: found 'ad', expected an instruction; is it 'add'?"]),
    ("mnemonic in capitals", "step: MADD r0, r0, r0, r0", ["1:7: error: found 'MADD', expected an instruction; is it 'madd'?"]),
    ("no mnemonic at all", STEP + "divide r0, r1", ["3:1: error: found 'divide', expected an instruction, a label or a directive"]),
    ("undefined name", "step:\nadd r0, vel, r0", ["2:9: error: found 'vel', expected a declared name, a register or a number"]),
    ("undefined name, once each", "step:\nadd r0, vel, vel\nadd r0, vel, x", ["2:9: error: found 'vel'", "3:14: error: found 'x'"]),
    ("undefined name, suggestion", ".state velocity\nstep: add r0, velocty, r0", ["2:15: error: found 'velocty', expected a declared name; is it 'velocity'?"]),
    ("label as operand", "step: here: add r0, here, r0", ["1:21: error: found 'here', expected a declared name, a register or a number (this is a label)"]),
    ("duplicate name", ".state v\n.param v\n" + STEP, ["2:8: error: found 'v', expected a new name (line 1 declares this one)"]),
    ("duplicate label", "x:\nx:\n" + STEP, ["2:1: error: found 'x', expected a new name (line 1 declares this one)"]),
    ("label and name", ".temp x\nx:\n" + STEP, ["2:1: error: found 'x', expected a new name (line 1 declares this one)"]),
    ("register taken twice", ".temp a = r3\n.state b = r3\n" + STEP, ["2:12: error: found 'r3', expected a register that is free (line 1 takes this one)"]),
    ("register of the wrong bank", ".state v = k3\n" + STEP, ["1:12: error: found 'k3', expected a register r0 to r63 for a .state"]),
    ("constant of the wrong bank", ".shared h = r3\n" + STEP, ["1:13: error: found 'r3', expected a register k0 to k63 for a .shared"]),
    ("fixed register out of range", ".state v = r64\n" + STEP, ["1:12: error: found 'r64', expected a register r0 to r63 for a .state"]),
    ("fixed register missing", ".state v =\n" + STEP, ["1:11: error: found end of line, expected a register r0 to r63 for a .state"]),
    ("shared destination", ".shared h\nstep: add h, r0, r0", ["2:11: error: found 'h', expected an object register as destination (this is a shared constant)"]),
    ("raw shared destination", "step: add k3, r0, r0", ["1:11: error: found 'k3', expected an object register as destination (this is a shared constant)"]),
    ("number as destination", "step: add 1.0, r0, r0", ["1:11: error: found '1.0', expected an object register as destination"]),
    ("shared constant to load", "step: ld k3", ["1:10: error: found 'k3', expected an object register as destination (this is a shared constant)"]),
    ("shared constant to store", ".shared h\nstep: st h", ["2:10: error: found 'h', expected an object register to store (this is a shared constant)"]),
    ("number to store", "step: st 1.0", ["1:10: error: found '1.0', expected an object register to store"]),
    ("nothing to load", "step: ld", ["1:9: error: found end of line, expected operand d: ld d"]),
    ("two to load", "step: ld r0, r1", ["1:12: error: found ',', expected end of line: ld d"]),
    ("undefined name to store", "step: st vel", ["1:10: error: found 'vel', expected a declared name, a register or a number"]),
    ("too few operands of sleep", "step: sleep r0, r1", ["1:19: error: found end of line, expected ',' and operand b: sleep d, a, b"]),
    ("sleep badly written", "step: slep r0, r1, r2", ["1:7: error: found 'slep', expected an instruction; is it 'sleep'?"]),
    ("sleep in a temp", ".temp F\nstep: sleep F, r1, 0.5", ["2:13: error: found 'F', expected a .state, or a register without a name, to sleep in (line 1 declares a .temp)"]),
    ("sleep in a param", ".param T\nstep: sleep T, r1, 0.5", ["2:13: error: found 'T', expected a .state, or a register without a name, to sleep in (line 1 declares a .param)"]),
    ("sleep in a temp by its number", ".temp F = r4\nstep: sleep %r4, r1, 0.5", ["2:13: error: found '%r4', expected a .state, or a register without a name, to sleep in (line 1"]),
    ("lds of a temp", ".temp F\nstep: lds F", ["2:11: error: found 'F', expected a .state, or a register without a name, to sleep in (line 1 declares a .temp)"]),
    ("sleep in a shared constant", ".shared h\nstep: sleep h, r1, 0.5", ["2:13: error: found 'h', expected an object register as destination (this is a shared constant)"]),
    ("two sleep registers", ".state one two\nstep: sleep one, r5, 0.5\n  sleep two, r5, 0.5", ["3:9: error: found 'two', expected 'one', the program's sleep register (line 2)"]),
    ("two sleep registers without names", "step: sleep r1, r5, 0.5\nlast: sleep r2, r5, 0.5", ["2:13: error: found 'r2', expected 'r1', the program's sleep register (line 1)"]),
    ("lds of another register", "step: lds r1\nsleep r2, r5, 0.5", ["2:7: error: found 'r2', expected 'r1', the program's sleep register (line 1)"]),
    ("every wrong sleep", ".temp a\n.state s t\nstep: sleep a, r5, 0.5\nsleep s, r5, 0.5\nsleep t, r5, 0.5", ["3:13: error: found 'a', expected a .state", "5:7: error: found 't', expected 's', the program's sleep register (line 4)"]),
    ("too few operands", "step: add r0, r1", ["1:17: error: found end of line, expected ',' and operand b: add d, a, b"]),
    ("too few operands of madd", "step: madd r0, r1, r2", ["1:22: error: found end of line, expected ',' and operand c: madd d, a, b, c"]),
    ("too few operands of rcp", "step: rcp r0", ["1:13: error: found end of line, expected ',' and operand a: rcp d, a"]),
    ("too many operands of abs", "step: abs r0, r1, r2", ["1:17: error: found ',', expected end of line: abs d, a"]),
    ("too few operands of sel", "step: sel r0, r1, r2", ["1:21: error: found end of line, expected ',' and operand c: sel d, a, b, c"]),
    ("no operands", "step: add", ["1:10: error: found end of line, expected operand d: add d, a, b"]),
    ("empty operand", "step: add r0, , r1", ["1:15: error: found ',', expected operand a: add d, a, b"]),
    ("comma forgotten", "step: add r0 r1, r2", ["1:14: error: found 'r1', expected ',' and operand a: add d, a, b"]),
    ("too many operands", "step: add r0, r1, r2, r3", ["1:21: error: found ',', expected end of line: add d, a, b"]),
    ("register out of range", "step: add r0, r64, k99999999999", ["1:15: error: found 'r64', expected a register r0 to r63 or k0 to k63", "1:20: error: found 'k99999999999', expected"]),
    ("register badly written", "step: add r0, %x1, %", ["1:15: error: found '%x1', expected a register as %r5 or %k5", "1:20: error: found '%', expected"]),
    ("number malformed", "step: add r0, 1.2.3, 0x", ["1:15: error: found '1.2.3', expected a number", "1:22: error: found '0x', expected a number"]),
    ("number with a tail", "step: add r0, 1.5f, 12abc", ["1:15: error: found '1.5f', expected a number", "1:21: error: found '12abc', expected a number"]),
    ("number overflows", "step: add r0, 1e39, -3.4028236e38", ["1:15: error: found '1e39', expected a number below 3.4028236e38", "1:21: error: found '-3.4028236e38', expected"]),
    ("number underflows to 0", ".const c 7.0e-46\nstep: add r0, c, 1e-9999", ["1:10: error: found '7.0e-46', expected 0 or a number above 7e-46", "2:18: error: found '1e-9999'"]),
    ("number too long", "step: add r0, r0, 0." + "1" * 300, ["1:19: error: found '0.1111"]),
    ("bits malformed", "step: add r0, bits:0x123456789, bits:12", ["1:15: error: found 'bits:0x123456789', expected FP32 bits as bits:0x", "1:33: error: found 'bits:12'"]),
    ("sign of a name", ".temp t\nstep: add r0, -t, r0", ["2:15: error: found '-t', expected a number"]),
    ("const without value", ".const c\n" + STEP, ["1:9: error: found end of line, expected a number"]),
    ("const with a name for value", ".const c x\n" + STEP, ["1:10: error: found 'x', expected a number"]),
    ("raw const of the wrong bank", ".const %r1 0.5\n" + STEP, ["1:8: error: found '%r1', expected a shared constant %k0 to %k63"]),
    ("unknown directive", ".stat v\n" + STEP, ["1:1: error: found '.stat', expected .state, .param, .temp, .shared, .const, .worst or .words"]),
    ("directive without a name", ".state # none\n" + STEP, ["1:8: error: found end of line, expected a name"]),
    ("directive with a number", ".state v 3\n" + STEP, ["1:10: error: found '3', expected a name"]),
    ("reserved name", ".state step\n.temp inf\n" + STEP, ["1:8: error: found 'step', expected a name ('step' has a meaning of its own)", "2:7: error: found 'inf'"]),
    ("name too long", f".state {LONG}\n{LONG}:\n" + STEP, [f"1:8: error: found '{LONG}', expected a name of at most 31 characters", "2:1: error:"]),
    ("too many object registers", ".temp " + " ".join(f"n{i}" for i in range(65)) + "\nstep: add n64, n64, n64", ["1:253: error: found 'n64', expected no more than 64 object registers"]),
    ("too many names", ".temp " + " ".join(f"n{i}" for i in range(200)) + "\nstep: add n64, n64, n64", ["error: found 'n64', expected no more than 64 object registers", "error: found 'n128', expected no more than 128 names"]),
    ("too many shared constants", ".shared " + " ".join(f"n{i}" for i in range(65)) + "\n" + STEP, ["error: found 'n64', expected no more than 64 shared constants"]),
    ("too many numbers", "step:\n" + "\n".join(f"add r0, r0, {i}" for i in range(65)), ["66:13: error: found '64', expected no more than 64 shared constants"]),
    ("too many instructions", "step:\n" + "add r0, r0, r0\n" * 65537, ["65538:1: error: found 'add', expected no more than 65536 instructions"]),
    ("too many labels", "".join(f"l{i}:\n" for i in range(1025)) + STEP, ["1025:1: error: found 'l1024', expected no more than 1024 labels"]),
    ("no step", "first:\nadd r0, r0, r0\n", ["3:1: error: found end of file, expected the label 'step:' somewhere"]),
    ("empty file", "", ["1:1: error: found end of file, expected the label 'step:' somewhere"]),
    ("empty step part", "add r0, r0, r0\nstep:\nlast:\nadd r0, r0, r0", ["3:1: error: found 'last', expected an instruction after 'step:' (line 2)"]),
    ("empty step part at the end", "add r0, r0, r0\nstep:", ["2:6: error: found end of file, expected an instruction after 'step:' (line 2)"]),
    ("first after step", "step:\nadd r0, r0, r0\nfirst:", ["3:1: error: found 'first', expected it before 'step:' (line 1)"]),
    ("step after last", "last:\nstep:\nadd r0, r0, r0", ["2:1: error: found 'step', expected it before 'last:' (line 1)"]),
    ("first after code", "add r0, r0, r0\nfirst:\n" + STEP, ["2:1: error: found 'first', expected it before the first instruction"]),
    ("step twice", STEP + STEP, ["3:1: error: found 'step', expected one 'step:' only (line 1 has it)"]),
    ("number alone", STEP + "1.0", ["3:1: error: found '1.0', expected an instruction, a label or a directive"]),
    ("strange characters", STEP + "add r0, r0, \u2212r1 @", ["3:13: error: found '\\xe2\\x88\\x92', expected operand b"]),
    ("binary", bytes(range(256)), ["1:1: error: found '\\x00\\x01", "2:1: error: found '\\x0b\\x0c', expected", "2:246: error: found end of file"]),
]  # fmt: skip


@pytest.mark.parametrize(("source", "expected"), [r[1:] for r in REFUSED], ids=[r[0] for r in REFUSED])
def test_refused(run, tmp_path, source, expected):
    data = source if isinstance(source, bytes) else source.encode()
    (tmp_path / "in.s").write_bytes(data)
    got = run("asm", "in.s", "-o", "out.fp3", "--hex", "out.hex", "--listing", "out.lst")
    assert got.returncode == 2
    assert got.stdout == ""
    assert [f.name for f in tmp_path.iterdir()] == ["in.s"], "a refused program leaves nothing behind"
    errors = [line for line in got.stderr.splitlines() if ": error: " in line]
    assert len(errors) == len(expected), got.stderr
    for error, text in zip(errors, expected, strict=True):
        assert error.startswith("in.s:") and text in error, f"expected: {text}\ngot:      {error}"


def test_error_shows_the_line_and_a_caret(run, tmp_path):
    (tmp_path / "in.s").write_text("step:\n\tadd r0, \x1bvel, r0\n" + STEP)
    got = run("asm", "in.s")
    assert got.stderr.splitlines()[:3] == [
        "in.s:2:10: error: found '\\x1b', expected operand a: add d, a, b",
        "     add r0, ?vel, r0",
        "             ^",
    ]


def test_caret_in_a_very_long_line(run, tmp_path):
    (tmp_path / "in.s").write_text("step:\nadd r0, r0," + " " * 100000 + "?" + "x" * 100000)
    lines = run("asm", "in.s").stderr.splitlines()
    assert lines[0] == "in.s:2:100012: error: found '?', expected operand b: add d, a, b"
    assert len(lines) == 3 and len(lines[1]) < 120
    assert lines[1][lines[2].index("^")] == "?"


def test_several_errors_in_the_order_of_the_source_up_to_a_limit(run, tmp_path):
    (tmp_path / "in.s").write_text(".temp t\nstep:\nadd x1, t, t\nadd t, t\n" + "add t, y, z\n" + "bad\n" * 50)
    lines = run("asm", "in.s").stderr.splitlines()
    errors = [line.split(":")[1] for line in lines if ": error: " in line]
    assert errors == sorted(errors, key=int) and len(errors) == 20
    assert lines[-1] == "20 errors; there may be more"


# ---- files --------------------------------------------------------------------------------------


def test_missing_source(run):
    got = run("asm", "none.s", "-o", "out.fp3")
    assert (got.returncode, got.stderr) == (2, "fp3 asm: none.s: cannot open: No such file or directory\n")


def test_source_is_a_directory(run, tmp_path):
    (tmp_path / "in.s").mkdir()
    got = run("asm", "in.s")
    assert (got.returncode, got.stderr) == (2, "fp3 asm: in.s: cannot read: Is a directory\n")


def test_unreadable_source(run):
    """The first page of a process is not mapped, so reading it fails even for root."""
    got = run("asm", "/proc/self/mem")
    assert (got.returncode, got.stderr) == (1, "fp3 asm: /proc/self/mem: cannot read: Input/output error\n")


@pytest.mark.parametrize("option", ["-o", "--hex", "--listing"])
def test_unwritable_output(run, tmp_path, option):
    (tmp_path / "in.s").write_text(STEP)
    got = run("asm", "in.s", option, "none/out")
    assert (got.returncode, got.stderr) == (2, "fp3 asm: none/out: cannot write: No such file or directory\n")
    (tmp_path / "directory").mkdir()
    assert run("asm", "in.s", option, "directory").returncode == 2
    got = run("asm", "in.s", option, "/dev/full")
    assert (got.returncode, got.stderr) == (1, "fp3 asm: /dev/full: cannot write: No space left on device\n")


def test_outputs_are_replaced_whole_or_not_at_all(run, tmp_path):
    (tmp_path / "in.s").write_text(STEP)
    (tmp_path / "target.fp3").write_text("before")
    (tmp_path / "target.fp3").chmod(0o640)
    (tmp_path / "out.fp3").symlink_to("target.fp3")
    (tmp_path / "bad.s").write_text("nonsense")
    assert run("asm", "bad.s", "-o", "out.fp3").returncode == 2
    assert (tmp_path / "target.fp3").read_text() == "before"
    assert run("asm", "in.s", "-o", "out.fp3").returncode == 0
    assert (tmp_path / "out.fp3").is_symlink()
    assert (tmp_path / "target.fp3").read_bytes()[:4] == b"FP3I"
    assert (tmp_path / "target.fp3").stat().st_mode & 0o777 == 0o640
    assert not list(tmp_path.glob(".fp3-*"))


def test_hex_holds_the_words_of_the_image(assemble, root, tmp_path):
    words = assemble((root / "programs" / "ship.s").read_text(), "--hex", "out.hex")
    lines = (tmp_path / "out.hex").read_text().splitlines()
    assert [int(line.split("//")[0], 16) for line in lines] == words
    assert lines[10].endswith("// 1: mul  t, C, v")


def test_listing_shows_each_word_beside_its_line(assemble, root, tmp_path):
    source = (root / "programs" / "ship.s").read_text()
    words = assemble(source, "--listing", "out.lst")
    lines = (tmp_path / "out.lst").read_text().splitlines()[1:]
    body = lines[: len(source.splitlines())]
    assert [line[22:] for line in body] == source.splitlines()
    assert [int(line[15:20]) for line in body] == list(range(1, len(body) + 1))
    coded = [line.split() for line in body if line[:5].strip()]
    assert [int(c[1], 16) for c in coded] == code_of(words)
    assert [int(c[0]) for c in coded] == list(range(words[3]))
    registers = {line.split()[0]: line.split()[1:] for line in lines[len(body) + 2 :]}
    assert registers["k3"] == [".const", "sixth", "0.16666667"] and registers["k4"] == ["-0.0"]


def test_dev_stdout_redirected_to_a_file_is_added_to(fp3, tmp_path):
    (tmp_path / "in.s").write_text(STEP)
    with open(tmp_path / "log", "w") as log:
        print("before", file=log, flush=True)
        command = [fp3, "asm", "in.s", "--hex", "/dev/stdout"]
        subprocess.run(command, cwd=tmp_path, stdout=log, check=True)
        log.seek(0, 2)
        print("after", file=log)
    lines = (tmp_path / "log").read_text().splitlines()
    assert (lines[0], lines[1], lines[-1]) == ("before", "49335046  // magic", "after")


def test_usage_errors(run):
    for arguments in [("asm",), ("asm", "a.s", "b.s"), ("asm", "--frob"), ("frob",), (), ("--frob",)]:
        got = run(*arguments)
        assert got.returncode == 2 and got.stderr and not got.stdout, arguments


@pytest.mark.parametrize("command", [[], ["asm"], ["dis"], ["run"], ["bench"], ["info"]])
def test_help_of_every_command(run, command):
    got = run(*command, "--help")
    assert got.returncode == 0 and got.stdout.startswith(" ".join(["Usage: fp3", *command]))


def test_version(run):
    assert run("--version").stdout.startswith("fp3 ")
