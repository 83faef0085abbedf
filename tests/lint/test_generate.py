"""The generated files are fresh, and a mistake in isa/*.toml is reported with its file and place."""

import re
import shutil
import subprocess
import sys

import pytest


def generate(root, *arguments):
    return subprocess.run([sys.executable, root / "tools/generate.py", *arguments],
                          capture_output=True, text=True, timeout=60)


def copied(root, folder):
    """What the generator reads and writes."""
    for name in ("isa", "tools", "rtl", "sw/gen", "sw/include", "docs", "programs/integrators", "python"):
        shutil.copytree(root / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(root / "fp3.core", folder)
    return folder


@pytest.fixture
def copy(root, tmp_path):
    """A tree to spoil."""
    return copied(root, tmp_path)


@pytest.fixture(scope="module")
def one_copy(root, tmp_path_factory):
    """A tree for many tests, which mend what they spoil."""
    return copied(root, tmp_path_factory.mktemp("copy"))


def replace(path, old, new):
    text = path.read_text()
    assert old in text, f"{path} has no {old!r} to replace"
    path.write_text(text.replace(old, new, 1))


@pytest.mark.smoke
def test_files_are_fresh(root):
    done = generate(root, "--check")
    assert (done.returncode, done.stderr) == (0, "")


def test_a_second_run_changes_nothing(copy):
    assert generate(copy).stdout == ""


@pytest.mark.parametrize("name", ["rtl/gen/isa.vh", *(pytest.param(name, marks=pytest.mark.long) for name in (
    "sw/gen/registers.h", "docs/isa.md", "rtl/gen/fp3.rdl", "python/fp3/_declarations.py"))])
def test_check_names_the_stale_file_and_mends_nothing(copy, name):
    path = copy / name
    spoiled = path.read_text() + "\n"
    path.write_text(spoiled)
    done = generate(copy, "--check")
    assert done.returncode != 0
    assert f"{name}: stale" in done.stderr and done.stderr.count("stale") == 1
    assert path.read_text() == spoiled
    assert generate(copy).stdout == f"wrote {name}\n"
    assert generate(copy, "--check").returncode == 0


def test_a_removed_file_and_an_orphan_are_named(copy):
    (copy / "sw/gen/configs.h").unlink()
    (copy / "rtl/gen/fp3_gone.v").write_text("")
    (copy / "sw/include/fp3/isa.h").rename(copy / "sw/include/fp3/gone.h")
    done = generate(copy, "--check")
    assert done.returncode != 0
    assert "sw/gen/configs.h: missing" in done.stderr
    assert "rtl/gen/fp3_gone.v: not generated any more" in done.stderr
    assert "sw/include/fp3/isa.h: missing" in done.stderr
    assert "sw/include/fp3/gone.h: not generated any more" in done.stderr
    assert "engine.h" not in done.stderr
    generate(copy)
    assert (copy / "sw/gen/configs.h").exists() and not (copy / "rtl/gen/fp3_gone.v").exists()
    assert not (copy / "sw/include/fp3/gone.h").exists() and (copy / "sw/include/fp3/engine.h").exists()


def test_a_new_module_reaches_the_core_file(copy):
    (copy / "rtl/lib/novel.v").write_text("module novel; endmodule\n")
    assert "fp3.core: stale" in generate(copy, "--check").stderr
    generate(copy)
    assert "      - rtl/lib/novel.v\n" in (copy / "fp3.core").read_text()


def test_the_version_stands_once(copy):
    """In status.h; register, map and core follow it."""
    status = copy / "sw/include/fp3/status.h"
    status.write_text(re.sub(r'(#define FP3_VERSION) ".*"', r'\1 "7.8.9"', status.read_text()))
    said = generate(copy).stdout
    assert "wrote rtl/gen/host_map.vh" in said and "wrote rtl/gen/fp3.rdl" in said
    assert (copy / "fp3.core").read_text().splitlines()[2:5] == ["name: fp3:fp3:fp3:7.8.9", "description: A field-programmable physics processor",
                                                                 "license: Apache-2.0"]
    assert "REGISTER_VERSION = (32'd9 & 255) << 0 | (32'd8 & 255) << 8 | (32'd7 & 65535) << 16;" in (copy / "rtl/gen/host_map.vh").read_text()
    status.write_text(status.read_text().replace('"7.8.9"', '"7.8"'))
    assert "status.h: there must be a line" in generate(copy, "--check").stderr


@pytest.mark.parametrize("old, new, message", [
    ('"rk38", ', "", "rk38: in no family"), ('"rk38"', '"rk39"', "rk38: in no family"), ('"rk38"', '"rk38", "rk39"', "rk39: no such integrator"),
    ('"rk6"', '"rk4"', "'rk4' is in 'Runge-Kutta, order 4' and in 'Runge-Kutta, order 5 to 8'"), ('"#d55e00"', '"red"', "'Runge-Kutta, order 4': found colour 'red'"),
    ('"#d55e00"', '"#e69f00"', "integrators: two families have one colour"), ("[[solvers]]\nname ", "[[solver]]\nname ", "expected integrators and solvers"), ('"ros2"', "2", "members are names")])
def test_families_are_whole(copy, old, new, message):
    replace(copy / "programs/integrators/families.toml", old, new)
    done = generate(copy, "--check")
    assert done.returncode == 1 and "programs/integrators/families.toml: " in done.stderr and message in done.stderr


# File, what is replaced in it (None: appended), and what the message must say.
MISTAKES = [
    ("isa.toml", "code     = 2", "code     = 1", "op 'sub': code 1 is already taken by 'add'"),
    ("isa.toml", "code     = 3", "code     = 0", "op 'mul': code 0 is not in 1 .. 30, nor in 128 .. 255"),
    ("isa.toml", "code     = 3", "code     = 31", "op 'mul': code 31 is not in 1 .. 30, nor in 128 .. 255"),
    ("isa.toml", "code     = 3", "code     = 256", "op 'mul': code 256 is not in 1 .. 30, nor in 128 .. 255"),
    ("isa.toml", "code     = 4", "code     = 128", "op 'madd': code 128 is not in 1 .. 30"),
    ("isa.toml", "code     = 3", 'code     = "3"', "op 'mul': 'code' must be of type int"),
    ("isa.toml", "code     = 3", "kode     = 3", "op 'mul': unknown key 'kode'"),
    ("isa.toml", "code     = 3\n", "", "op 'mul': 'code' is missing"),
    ("isa.toml", 'name     = "sub"', 'name     = "add"', "op 'add' is defined twice"),
    ("isa.toml", 'name     = "sub"', 'name     = "s-b"', "op 's-b': a name is"),
    ("isa.toml", '["multiplier"]', '["divider"]', "op 'mul': there is no path ['divider']"),
    ("isa.toml", '["multiplier", "adder"]', '["adder", "multiplier"]', "op 'madd': there is no path ['adder', 'multiplier']"),
    ("isa.toml", '["invalid", "overflow"', '["nvalid", "overflow"', "op 'add': there is no exception 'nvalid'"),
    ("isa.toml", "commutes = true", "commutes = 1", "op 'add': 'commutes' must be of type bool"),
    ("isa.toml", 'needs    = "estimate"', 'commutes = true\nneeds    = "estimate"', "op 'rcp': commutes, but has no operand b"),
    ("isa.toml", 'gives    = "word"', 'gives    = "work"', "op 'ldn': gives 'work' is not one of nothing, word, field"),
    ("isa.toml", 'number   = "a"', 'number   = "d"', "op 'ldn': number must be the last operand"),
    ("isa.toml", 'needs    = "interleave"', 'number   = "d"\nneeds    = "interleave"', "op 'ld': gives nothing that it could number or compute with"),
    ("isa.toml", 'computes = "add"\n', "", "op 'addn': computes and stands go together"),
    ("isa.toml", 'computes = "add"', 'computes = "madd"', "op 'addn': computes must name an instruction of registers d, a, b"),
    ("isa.toml", 'stands   = "b"', 'stands   = "c"', "op 'addn': stands must be a or b, and b the number"),
    ("isa.toml", 'writes   = "never"', 'writes   = "seldom"', "op 'st': writes 'seldom' is not one of"),
    ("isa.toml", "nan        = 0x7fc00000", "nan        = 0x17fc00000", "[bits]: nan = 0x17fc00000 is no pattern of 32 bits"),
    ("isa.toml", "minus_zero = 0x80000000\n", "", "[bits]: 'minus_zero' is missing"),
    ("isa.toml", '["d", "a", "b"]', '["d", "b"]', "op 'add': operands must be"),
    ("isa.toml", "a  = [20, 14]", "a  = [21, 14]", "fields 'd' and 'a' overlap in bit 21"),
    ("isa.toml", "op = [31, 27]", "op = [32, 27]", "field 'op' must be [high, low]"),
    ("isa.toml", "c  = [6, 0]\n", "", "[field] must define op, d, a, b, c"),
    ("isa.toml", "base = 64", "base = 63", "overlap in code 63"),
    ("isa.toml", "base = 64", "base = 65", "bank 'shared' does not fit"),
    ("isa.toml", "revision = 3", "revision = 0", "revision"),
    ("isa.toml", "revision = 3", "revision = ", "isa/isa.toml: Invalid value (at line 4"),
    ("registers.toml", "at = 0x0024", "at = 0x0020", "'steps' and 'step' overlap at 0x0020"),
    ("registers.toml", "at = 0x0024", "at = 0x0022", "'step': 0x0022 is not the address of a word"),
    ("registers.toml", "at = 0x0024", "at = 0x0084", "'step' and 'counter cycles' overlap at 0x0084"),
    ("registers.toml", "at = 0x0024", "at = 0x2800", "'step' at 0x2800 lies in the windows"),
    ("registers.toml", "at = 0x0080", "at = 0x00a0", "at must be 128, for at most 48 counters"),
    ("registers.toml", "at = 0x2000", "at = 0x2f04", "window 'constants' has no room"),
    ("registers.toml", "constants = [15, 8]", "constants = [15, 7]", "fields 'registers' and 'constants' overlap in bit 7"),
    ("registers.toml", 'access = "wo"', 'access = "w"', "'control': access 'w' is not one of"),
    ("registers.toml", 'name = "fault"', 'name = "flags"', "register 'flags' is defined twice"),
    ("registers.toml", 'name = "issued_mul"', 'name = "issued_mull"', "there must be a counter 'issued_mul'"),
    ("registers.toml", "invalid = [4, 4]", "invalid = [5, 4]", "register 'flags' must have a bit for each exception"),
    ("registers.toml", 'needs = ["store_words"]', 'needs = ["store"]', "'record' needs, shows or holds 'store', which is no key"),
    ("registers.toml", 'shows = ["registers", "registers", "contexts"]', 'shows = ["registers", "contexts"]', "'shows' must have a key for each field"),
    ("registers.toml", 'shows = ["more"]', 'shows = ["zero"]', "'features' needs, shows or holds 'zero', which is no key"),
    ("registers.toml", "range = [3, 6]", "range = [3, 8]", "register 'record': range [3, 8] is empty, or its field has no room for it"),
    ("registers.toml", "range = [3, 6]", "range = [4, 6]", "register 'record': it is reset to 3, which is not in its range"),
    ("registers.toml", "range = [3, 6]", "range = [3]", "register 'record': range must be [least, most], not [3]"),
    ("registers.toml", 'range = [0, "program_words"]', 'range = [0, "lanes"]', "register 'step': range: 'lanes' is no key that is a power of two"),
    ("registers.toml", 'access = "wo"\nstream = true\ndoc = "Instruction', 'access = "wo"\ndoc = "Instruction', "'awake' has no address bit that says that it streams"),
    ("registers.toml", "at = 0x0024", "at = 0x0f00", "'step' at 0x0f00 is not below the counters"),
    ("registers.toml", "reset = 3", "reset = 8", "register 'record': 'reset' must be the value of its only field"),
    ("registers.toml", 'ended = "enable",', 'ended = "enabled",', "register 'interrupt': 'interrupt' names 'enabled', which is no field"),
    ("configs.toml", "mul_latency = 13", "mul_latency = 1", "config 'paper': mul_latency 1 is less than"),
    ("configs.toml", "mul_cuts = 0x04", "mul_cuts = 0x8000", "config 'single': mul_cuts = 0x8000 is not in 0x0000 .. 0x"),
    ("configs.toml", 'multiply_add = "none"', 'multiply_add = "never"', "config 'paper': multiply_add = 'never' is not one of none, chain, fused, dual"),
    ("configs.toml", 'multiply_add = "none"', "multiply_add = true", "config 'paper': 'multiply_add' must be of type int"),
    ("configs.toml", "round = 1", "round = 2", "config 'single_full': round = 2 is not in 0 .. 1"),
    ("configs.toml", 'default  = "chain"', 'default  = "chained"', "key 'multiply_add': its default must be one of none, chain, fused, dual"),
    ("configs.toml", "program_words = 2048", "program_words = 8193", "program_words = 8193 is not in 2 .. 8192"),
    ("configs.toml", "default  = 32", "default  = 24", "registers = 24 is not a power of two"),
    ("configs.toml", "contexts = 24", "contexts = 65", "config 'many': contexts = 65 is not in 1 .. 64"),
    ("configs.toml", "tiles = 4", "tiles = 65", "config 'array': tiles = 65 is not in 1 .. 64"),
    ("configs.toml", "lanes = 8", "lanes = 8\nschedulers = 2", "config 'lanes': lanes share one scheduler"),
    ("configs.toml", "neighbours = 1", "neighbours = 1\nschedulers = 2", "config 'world': with neighbours a tile has one scheduler"),
    ("configs.toml", "store_words = 512\n", "store_words = 8\n", "config 'lanes': store_words = 8 holds no object"),
    ("configs.toml", "store_words = 512\n", "store_words = 520\n", "config 'lanes': store_words = 520 is not a power of two"),
    ("configs.toml", 'name = "uncut"', 'name = "uncut"\nselect = 1\nmultiply_add = "none"', "config 'uncut': select = 1 needs multiply_add = chain or multiply_add = fused"),
    ("isa.toml", 'needs    = "sleep"', 'needs    = "slept"', "op 'sleep': needs 'slept', which is no key"),
    ("isa.toml", 'needs    = "sleep"', 'needs    = "contexts"', "op 'sleep': needs 'contexts', which is no key"),
    ("configs.toml", 'name = "uncut"', 'name = "uncut"\nmultiply_add = "fused"\nround = 1',
     "config 'uncut': for one object, multiply_add = fused with select, reciprocal or round needs mul_latency of at least 2"),
    ("configs.toml", 'name = "uncut"', 'name = "uncut"\ncontexts = 2', "config 'uncut': contexts = 2 needs store_words"),
    ("configs.toml", 'name = "uncut"', 'name = "uncut"\nsleep = 1', "config 'uncut': sleep = 1 needs store_words"),
    ("configs.toml", "registers = 64", "registres = 64", "config 'single_full': unknown key 'registres'"),
    ("configs.toml", "store_words = 8192", 'store_words = 8192\nwriteback = "slot"', "config 'many': writeback = slot needs store_words = 0"),
    ("configs.toml", 'name = "uncut"', 'name = "uncut"\nexceptions = "object"', "config 'uncut': exceptions = object needs store_words"),
    ("configs.toml", 'name = "uncut"', 'name = "uncut"\nchain = 0', "config 'uncut': chain = 0, but multiply_add == 1 says 1"),
    ("configs.toml", 'name = "uncut"', 'name = "uncut"\ninterleave = 1', "config 'uncut': interleave = 1, but store_words > 0 says 0"),
    ("configs.toml", "# What follows from these.", '[key.late]\nrange = [0, 1]\nis = "lanes > 1"\nmeaning = "x"\n[key.later]\nrange = [0, 1]\nmeaning = "x"', "keys with 'is' come last"),
    ("configs.toml", 'is       = "store_words > 0"', 'is       = "store_words > 0"\ndefault = 1', "key 'interleave': with 'is' nothing else decides"),
    ("configs.toml", "[key.lanes]", "[key.lames]", "there must be a key 'lanes'"),
    ("configs.toml", "range    = [1, 64]", "range    = [64, 1]", "key 'tiles': range must be [least, most], not [64, 1]"),
    ("configs.toml", "window program", "window programs", "key 'program_words': 'window programs' is neither a window"),
    ("configs.toml", "default  = 1\nneeds", "default  = 65\nneeds", "key 'tiles': its default 65 is not in 1 .. 64"),
    ("configs.toml", 'needs    = ["chain or fused"]', 'needs    = ["chian or fused"]', "key 'select': needs or excludes 'chian', which is no key"),
    ("configs.toml", 'meaning  = "words of instruction memory"\n', "", "key 'program_words': 'meaning' is missing"),
    ("configs.toml", 'meaning  = "1: exceptions are flagged"', 'meaning  = "flags"\nlack = "a flag"', "key 'flags': it has a 'lack', but no instruction"),
    ("configs.toml", 'name = "single"', 'name = "paper"', "config 'paper' is defined twice"),
    ("timing.toml", "cycles  = 14", "cycles  = -14", "[settle]: cycles = -14 is not in 0 .. 255"),
    ("timing.toml", "cycles  = 14", 'cycles  = "14"', "[settle]: 'cycles' must be of type int"),
    ("timing.toml", "rtl     = true", "rtl     = 1", "[share]: 'rtl' must be of type bool"),
    ("timing.toml", 'meaning = "from a result to its write"\n', "", "[write]: 'meaning' is missing"),
    ("timing.toml", "[gap]", "[gaps]", "top level: unknown key 'gaps'"),
    ("timing.toml", '[gap]\ncycles  = 5\nrtl     = true\nmeaning = "from an issue to the next issue of the same context, beyond the latency"\n',
     "", "top level: 'gap' is missing"),
]


@pytest.mark.parametrize("file, old, new, message", MISTAKES, ids=[m[3] for m in MISTAKES])
def test_a_mistake_is_reported(root, one_copy, monkeypatch, file, old, new, message):
    """By what is called before anything is written: the next test has the command."""
    monkeypatch.syspath_prepend(root / "tools")
    from generate import Bad, outputs
    right = (one_copy / "isa" / file).read_text()
    replace(one_copy / "isa" / file, old, new)
    try:
        with pytest.raises(Bad) as bad:
            outputs(one_copy)
    finally:
        (one_copy / "isa" / file).write_text(right)
    assert str(bad.value).startswith(f"isa/{file}: ") and message in str(bad.value)


@pytest.mark.parametrize("file, old, new, message", [MISTAKES[0], MISTAKES[-1]], ids=["the first", "the last"])
def test_nothing_is_written_after_a_mistake(copy, file, old, new, message):
    replace(copy / "isa" / file, old, new)
    before = {path: path.stat().st_mtime_ns for path in copy.rglob("*")}
    done = generate(copy)
    assert done.returncode != 0 and done.stderr.startswith(f"generate.py: isa/{file}: ") and message in done.stderr
    assert {path: path.stat().st_mtime_ns for path in copy.rglob("*") if "__pycache__" not in path.parts} == before


def test_a_missing_file_is_named(copy):
    (copy / "isa/configs.toml").unlink()
    done = generate(copy)
    assert done.returncode != 0 and "isa/configs.toml: No such file" in done.stderr


@pytest.mark.parametrize("old, new, told", [
    ("fp3_status fp3_batch_run(", "fp3_statuz fp3_batch_run(", "fp3_statuz"),
    ("size_t objects; ", "size_t objects : 3; ", "objects : 3"),
    ("fp3_status fp3_batch_restart(fp3_batch *batch);", "fp3_batch_restart;", "expected a declaration in one of our forms")])
def test_a_header_of_another_form_is_refused(copy, old, new, told):
    """What the reader for Python does not know it does not guess."""
    replace(copy / "sw/include/fp3/batch.h", old, new)
    done = generate(copy, "--check")
    assert done.returncode != 0 and told in done.stderr, done.stderr
