"""Images: back to text, what is refused in them, and what `fp3 info` says of them."""

import os
import re
import struct
import subprocess
import tomllib
import zlib

import pytest

pytestmark = pytest.mark.smoke

PROGRAMS = ["ship", "ship_madd", "ship_paper", "ship_sleep"]
SOURCE = """
.state v s
.shared h
.const half 0.5
.temp k0                        # spelled like a constant: %k0 is the constant
first: add k0, -0.0, -0.0
step: madd v, h, %k0, half
mark: sub s, s, 3.0
last: mul s, s, bits:0x7f800001
"""


@pytest.fixture
def run(fp3, tmp_path):
    def run(*arguments):
        return subprocess.run(
            [fp3, *map(str, arguments)], cwd=tmp_path, text=True, capture_output=True, timeout=60
        )

    return run


@pytest.fixture
def image(run, tmp_path):
    """SOURCE as the words of its image."""
    (tmp_path / "in.s").write_text(SOURCE)
    assert run("asm", "in.s", "-o", "in.fp3").returncode == 0
    data = (tmp_path / "in.fp3").read_bytes()
    return list(struct.unpack(f"<{len(data) // 4}I", data))


def sealed(words):
    """With a good CRC, so that the damage is found for what it is."""
    body = struct.pack(f"<{len(words) - 1}I", *words[:-1])
    return body + struct.pack("<I", zlib.crc32(body))


@pytest.mark.parametrize("name", PROGRAMS)
def test_programs_come_back_from_text_bit_for_bit(run, root, tmp_path, name):
    assert run("asm", root / "programs" / f"{name}.s", "-o", "a.fp3").returncode == 0
    assert run("dis", "a.fp3", "-o", "a.s").returncode == 0
    assert run("asm", "a.s", "-o", "b.fp3").returncode == 0
    assert (tmp_path / "a.fp3").read_bytes() == (tmp_path / "b.fp3").read_bytes()
    text = (tmp_path / "a.s").read_text()
    assert ".state  v = r0\n" in text and "step:\n" in text


def test_text_of_an_image(run, image):
    assert run("dis", "in.fp3").stdout == (
        ".state  v = r0\n.state  s = r1\n.temp   k0 = r2\n.shared h = k1\n.const  half = k2 0.5\n"
        "first:\n    add  k0, -0.0, -0.0\n"
        "step:\n    madd v, h, %k0, half\nmark:\n    sub  s, s, 3.0\n"
        "last:\n    mul  s, s, bits:0x7f800001\n"
    )


@pytest.mark.parametrize(
    ("word", "text"),
    [
        ("0x08000000", "add  r0, r0, r0"),
        ("0x0FFFFF80", "add  r63, k63, k63"),
        ("0x20400a03", "madd r2, r0, r20, r3"),
        ("0x30402080", "sleep r2, r0, k1"),
        ("0x38400000", "ld   r2"),
        ("0x40400000", "lds  r2"),
        ("0x4fe00000", "st   r63"),
    ],
)
def test_single_words(run, word, text):
    assert run("dis", "--word", word).stdout == text + "\n"


@pytest.mark.parametrize(
    ("word", "why"),
    [
        ("0x0", "0x00000000 is no instruction: opcode 0 is unknown"),
        ("0xffffffff", "0xffffffff is no instruction: opcode 255 is unknown"),
        ("0x08000001", "add has no operand c, but the field holds 1 instead of 0"),
        ("0x30402081", "sleep has no operand c, but the field holds 1 instead of 0"),
        ("0x38404000", "ld has no operand a, but the field holds 1 instead of 0"),
        ("0x40400080", "lds has no operand b, but the field holds 1 instead of 0"),
        ("0x4840007f", "st has no operand c, but the field holds 127 instead of 0"),
        ("0xf8000013", "0xf8000013 is no instruction: opcode 147 is unknown"),
        ("0xf8200001", "next has no operand d, but the field holds 1 instead of 0"),
        ("0xf8004080", "each has no operand a, but the field holds 1 instead of 0"),
        ("08000000", "expected a word as 0x and one to eight hexadecimal digits"),
        ("0x108000000", "expected a word as 0x and one to eight hexadecimal digits"),
        ("0x", "expected a word"),
        ("0x12g", "expected a word"),
    ],
)
def test_single_words_refused(run, word, why):
    got = run("dis", "--word", word)
    assert got.returncode == 2 and why in got.stderr and not got.stdout


def symbol(image, number):
    return 9 + image[3] + 2 * image[6] + 9 * number


def put(at, value):
    def change(image):
        image[at(image) if callable(at) else at] = value

    return change


def swap_symbols(image):
    a, b = symbol(image, 0), symbol(image, 1)
    image[a : a + 9], image[b : b + 9] = image[b : b + 9], image[a : a + 9]


DAMAGE = [
    ("another magic", put(0, 0x464C457F), "not an FP3 image"),
    ("another revision", put(1, 99), "made for revision 99 of the instruction set; this is revision 3"),
    ("total too large", put(2, 5000), "truncated: "),
    ("total too small", put(2, 20), " words after the end of the image"),
    ("code count", put(3, 5), "damaged: its parts have"),
    ("code count overflows", put(3, 0xFFFFFFFF), "damaged: its parts have"),
    ("symbol count overflows", put(7, 0x1C71C71D), "damaged: its parts have"),
    ("step after last", put(4, 3), "the step part is 3 to 3 of 4 code words"),
    ("last after the end", put(5, 5), "the step part is 1 to 5 of 4 code words"),
    ("registers miscounted", put(8, 0x00050004), "damaged: word 8 is 0x00050004, expected"),
    ("constant out of range", put(lambda i: 9 + i[3], 64), "value 0 is for shared constant 64 of 64"),
    ("constant twice", put(lambda i: 9 + i[3], 3), "shared constant 3 has two values"),
    ("unknown class", put(lambda i: symbol(i, 0), 9 << 24), "symbol 0 is of the unknown class 9"),
    ("register out of range", put(lambda i: symbol(i, 0), 64), "state 'v' is register 64 of 64"),
    ("label out of range", put(lambda i: symbol(i, 5), 5 << 24 | 5), "label 'mark' is at 5, after the 4 code words"),
    ("two names for one", put(lambda i: symbol(i, 1), 0), "'v' and 's' are both r0"),
    ("name twice", put(lambda i: symbol(i, 1) + 1, ord("v")), "the name 'v' stands for two things"),
    ("no name", put(lambda i: symbol(i, 1) + 1, 0), "symbol 1 has '' for a name"),
    ("strange name", put(lambda i: symbol(i, 1) + 1, 0x1B), "symbol 1 has '?' for a name"),
    ("bytes after a name", put(lambda i: symbol(i, 1) + 8, 1 << 8), "damaged: word"),
    ("name without an end", lambda i: i.__setitem__(slice(symbol(i, 1) + 1, symbol(i, 1) + 9), [0x61616161] * 8), "symbol 1 has 'aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa' for a name"),
    ("const without a value", put(lambda i: symbol(i, 4), 3 << 24 | 2), "shared 'half' has a value"),
    ("value without its const", put(lambda i: 9 + i[3], 9), "const 'half' has no value"),
    ("order", swap_symbols, "damaged: word"),
]  # fmt: skip


@pytest.mark.parametrize(("damage", "why"), [d[1:] for d in DAMAGE], ids=[d[0] for d in DAMAGE])
def test_damaged_images_are_refused(run, tmp_path, image, damage, why):
    damage(image)
    (tmp_path / "bad.fp3").write_bytes(sealed(image))
    for command in ("info", "dis"):
        got = run(command, "bad.fp3")
        assert got.returncode == 2 and not got.stdout
        assert got.stderr.startswith(f"fp3 {command}: bad.fp3: ") and why in got.stderr, got.stderr


SLEEPY = """
.state v slept
.temp t
.shared eps
first: lds slept
step: add v, v, t
sleep slept, v, eps
last: st slept
"""


def test_a_program_that_sleeps_comes_back_from_text(run, tmp_path):
    (tmp_path / "in.s").write_text(SLEEPY)
    assert run("asm", "in.s", "-o", "in.fp3", "--listing", "in.lst").returncode == 0
    assert run("dis", "in.fp3").stdout == (
        ".state  v = r0\n.state  slept = r1\n.temp   t = r2\n.shared eps = k0\n"
        "first:\n    lds  slept\nstep:\n    add  v, v, t\n    sleep slept, v, eps\nlast:\n    st   slept\n"
    )
    assert "    2 30202000     7  sleep slept, v, eps\n" in (tmp_path / "in.lst").read_text()


@pytest.mark.parametrize(
    ("at", "word", "why"),
    [
        (0, 8 << 27 | 5 << 21, "code word 2 sleeps in r1, but an earlier word in r5: a program has one sleep register"),
        (2, 6 << 27 | 0 << 21, "code word 2 sleeps in r0, but an earlier word in r1: a program has one sleep register"),
        (2, 8 << 27 | 0 << 21, "code word 2 sleeps in r0, but an earlier word in r1: a program has one sleep register"),
        (None, 2, "r2, in which objects sleep, is the temp 't' and not a state"),
    ],
)
def test_images_that_sleep_in_the_wrong_register_are_refused(run, tmp_path, at, word, why):
    (tmp_path / "in.s").write_text(SLEEPY)
    assert run("asm", "in.s", "-o", "in.fp3").returncode == 0
    data = (tmp_path / "in.fp3").read_bytes()
    words = list(struct.unpack(f"<{len(data) // 4}I", data))
    if at is None:
        words[9], words[11] = 8 << 27 | word << 21, 6 << 27 | word << 21
    else:
        words[9 + at] = word
    (tmp_path / "bad.fp3").write_bytes(sealed(words))
    for command in ("info", "dis"):
        got = run(command, "bad.fp3")
        assert (got.returncode, got.stderr) == (2, f"fp3 {command}: bad.fp3: {why}\n")


def test_every_truncation_and_every_flipped_bit_is_refused(run, tmp_path, image):
    data = sealed(image)
    some = [*range(0, 60), *range(60, len(data), 37), len(data) - 1]
    for length in some:
        (tmp_path / "bad.fp3").write_bytes(data[:length])
        got = run("info", "bad.fp3")
        assert got.returncode == 2, f"the first {length} of {len(data)} bytes"
        assert ("truncated" if length >= 4 else "not an FP3 image") in got.stderr
    for at in some[:-1]:
        (tmp_path / "bad.fp3").write_bytes(data[:at] + bytes([data[at] ^ 0x10]) + data[at + 1 :])
        assert run("info", "bad.fp3").returncode == 2, f"byte {at}"


def test_an_illegal_code_word_is_named(run, tmp_path, image):
    image[10] = 0
    (tmp_path / "bad.fp3").write_bytes(sealed(image))
    got = run("dis", "bad.fp3", "-o", "out.s")
    assert got.returncode == 2
    assert got.stderr == "fp3 dis: bad.fp3: code word 1: 0x00000000 is no instruction: opcode 0 is unknown\n"
    assert not (tmp_path / "out.s").exists()
    assert "1 illegal" in run("info", "bad.fp3").stdout, "info shows what dis refuses"


@pytest.mark.parametrize("command", ["info", "dis"])
def test_what_is_no_image(run, tmp_path, command):
    got = run(command, "none.fp3")
    assert (got.returncode, got.stderr) == (2, f"fp3 {command}: none.fp3: cannot open: No such file or directory\n")
    for data in (b"", b"F", b"step: add r0, r0, r0\n", bytes(4096)):
        (tmp_path / "bad.fp3").write_bytes(data)
        got = run(command, "bad.fp3")
        assert (got.returncode, got.stderr) == (2, f"fp3 {command}: bad.fp3: not an FP3 image\n")


def test_dis_does_not_overwrite_its_image(run, tmp_path, image):
    before = (tmp_path / "in.fp3").read_bytes()
    assert run("dis", "in.fp3", "-o", "in.fp3").returncode == 2
    assert (tmp_path / "in.fp3").read_bytes() == before


# ---- info ---------------------------------------------------------------------------------------


def test_info_of_the_programs(run, root):
    said = {}
    for name in PROGRAMS:
        assert run("asm", root / "programs" / f"{name}.s", "-o", f"{name}.fp3").returncode == 0
        got = run("info", f"{name}.fp3")
        assert got.returncode == 0
        said[name] = [" ".join(line.split()) for line in got.stdout.splitlines()]
    assert "step part 30: 8 add, 4 sub, 18 mul" in said["ship"], "the 30 operations of Equations (1)"
    assert "step part 30: 8 add, 4 sub, 18 mul" in said["ship_paper"]
    assert "first part 9: 9 add" in said["ship_paper"], "the register initialisations"
    assert "step part 20: 2 add, 8 mul, 6 madd, 4 msub" in said["ship_madd"]
    assert "step part 23: 3 add, 1 sub, 8 mul, 6 madd, 4 msub, 1 sleep" in said["ship_sleep"]
    assert "state v s" in said["ship"] and "param T C rm" in said["ship"] and "shared h" in said["ship"]
    assert "for paper" in said["ship"]
    assert not [line for line in said["ship"] if line.startswith("needs")] and "needs sleep, multiply_add = chain" in said["ship_sleep"]
    assert "not for paper: word 0 is a chained multiply-add, which configuration 'paper' does not have" in said["ship_madd"]


def test_info_without_memory_is_no_answer(fp3, run, root, tmp_path):
    """That a program does not fit is what the engine says of the program; all else is an error."""
    assert run("asm", root / "programs/ship.s", "-o", "x.fp3").returncode == 0
    text = "#include <stddef.h>\nvoid *__libc_calloc(size_t, size_t);\nvoid *calloc(size_t n, size_t size) { return n * size > 3000 ? NULL : __libc_calloc(n, size); }\n"
    subprocess.run(["gcc", "-shared", "-fPIC", "-x", "c", "-", "-o", tmp_path / "few.so"], input=text, text=True, check=True)
    done = subprocess.run([fp3, "info", "x.fp3"], cwd=tmp_path, env={**os.environ, "LD_PRELOAD": str(tmp_path / "few.so")}, capture_output=True, text=True)
    assert done.returncode == 1 and done.stderr == "fp3 info: out of memory\n" and "memory" not in done.stdout, done.stdout + done.stderr
    done = subprocess.run([fp3, "info", "x.fp3"], cwd=tmp_path, env={**os.environ, "FP3_RTL_DIR": "/nonexistent"}, capture_output=True, text=True)
    assert done.returncode == 0 and "for         paper" in done.stdout, "hardware that is not installed does not count"


def test_info_says_what_a_program_needs(run, tmp_path):
    """Keys of a configuration, each once."""
    (tmp_path / "x.s").write_text("step: madd r0, r1, r1, r0\nmsub r0, r1, r1, r0\naddh r0, r0, r1\nrcp r2, r0\n"
                                  "rsqrt r2, r2\nabs r2, r2\nsel r0, r1, r2, r2\nlt r1, r0, r2\n")
    assert run("asm", "x.s", "-o", "x.fp3").returncode == 0
    said = run("info", "x.fp3").stdout
    assert re.search(r"^needs +select, multiply_add = chain, reciprocal = estimate or mixed, multiply_add = dual or schedulers > 1$", said, re.M), said
    assert re.findall(r"^for +(\w+)$", said, re.M) == ["shared_full"]
    assert "not for single_full: word 2 is an addition of half or twice" in " ".join(said.split())
    (tmp_path / "x.s").write_text("step: abs r0, r1\nrcp r2, r0\n")
    assert run("asm", "x.s", "-o", "x.fp3").returncode == 0
    said = " ".join(run("info", "x.fp3").stdout.split())
    assert "not for many: word 0 is a comparison or selection, which configuration 'many' does not have" in said
    assert "for single_full" in said and "step part 2: 1 abs, 1 rcp" in said


def test_info_of_the_build(run, root):
    said = run("info").stdout
    ops = tomllib.loads((root / "isa/isa.toml").read_text())["op"]
    names, left_out = [op["name"] for op in ops], [op["name"] for op in ops if op.get("needs") in ("neighbours", "keep", "fused")]
    assert f"instruction set revision 3: {' '.join(names)}\n" in said and "rcp" in names
    assert re.search(r"^shared: [^\n]+\n(  [^w][^\n]+\n)+  without: fmadd fmsub min max [^\n]+ mull stl keep raise hold\n", said, re.M), said
    assert re.search(rf"^shared_full: [^\n]+\n(  [^w][^\n]+\n)+  without: {' '.join(left_out)}\n", said, re.M), said
    for name in (root / "rtl" / "gen").glob("fp3_*.v"):
        assert f"\n{name.stem.removeprefix('fp3_')}: " in said
