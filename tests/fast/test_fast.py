"""The fast engine: the bits, flags and failures of the isa engine, however it executes; its cache."""

import os
import pathlib
import re
import shutil
import stat
import struct
import subprocess
import tempfile
import zlib

import pytest

from bugs import Bug, few

KINDS = ["x86-64", "x86-64-v3", "x86-64-v4"]


@pytest.fixture
def run(fp3, root, tmp_path):
    """`fp3 run -e fast`, with a cache of its own; gives what it printed, without the time."""

    def start(*arguments, engine="fast", status=0, **environment):
        done = subprocess.run([fp3, "run", "-e", engine, *map(str, arguments)], cwd=root, capture_output=True, text=True,
                              env={**os.environ, "FP3_CACHE_DIR": str(tmp_path / "cache"), **environment}, timeout=120)
        assert done.returncode == status, done.stdout + done.stderr
        start.how = re.search(r"^time .*; (.*)$", done.stdout, re.M)
        start.how = start.how and start.how[1]
        start.stderr = done.stderr
        return re.sub(r"^(time|simulator|cycles|issued|paired|retired|stall)\S* .*\n", "", done.stdout, flags=re.M)

    return start


def has(kind):
    flags = next(line for line in open("/proc/cpuinfo") if line.startswith("flags"))
    return kind == "x86-64" or (" avx512dq " if kind == "x86-64-v4" else " avx2 ") in flags


def random_streams(build, tmp_path, *arguments, fast, seed=1):
    out = subprocess.run([build / "tests/random_stream", "--engine", "fast", "--vary", "--seed", str(seed), *map(str, arguments)],
                         env={**os.environ, "FP3_FAST": fast, "FP3_CACHE_DIR": str(tmp_path / "cache")},
                         capture_output=True, text=True, timeout=3000)
    assert out.returncode == 0, out.stdout + out.stderr
    return out.stdout


def test_random_programs_are_interpreted_alike(build, tmp_path, long):
    """Every configuration, with roundings, flushing and flags at random; values, flags, status, sleep, failures."""
    out = random_streams(build, tmp_path, "--instructions", 20_000_000 if long else 1_500_000, fast="interpreter")
    fell = re.findall(r"in (\d+) objects fell asleep, (\d+) objects failed", out)
    assert sum(int(n[0]) for n in fell) > 30 and sum(int(n[1]) for n in fell) > 1000, out


@pytest.mark.parametrize("kind", KINDS)
def test_random_programs_are_compiled_alike(build, tmp_path, kind, long):
    """One session, whose programs are compiled in seconds (200 on each of four configurations)."""
    if not has(kind):
        pytest.skip(f"no {kind} here")
    for i, config in enumerate(["single_full", "many_full", "crowd", "lanes"] if long else ["many_full"]):
        random_streams(build, tmp_path, "--config", config, "--streams", 800 if long else 1, fast=kind,
                       seed=1 + 1000 * i + KINDS.index(kind) * 100 if long else {"x86-64": 1, "x86-64-v3": 7, "x86-64-v4": 2}[kind])
    assert len(list((tmp_path / "cache").glob("*.so"))) > 2, "nothing was compiled"


@pytest.mark.parametrize("model, name", [("ship.ode", "v"), ("kepler.ode", "r_x"), ("pendulum.ode", "theta"),
                                         ("bouncing_ball.ode", "v")])
def test_models_have_the_bits_of_the_isa_engine(run, root, model, name):
    """Estimates, comparisons, sines; objects that differ, in vectors that are not all full."""
    options = [f"programs/{model}", "-c", "many_full", "--steps", 40, "-N", 150, "--all", "--visit", 7,
               "--spread", f"{name}=0.5:1.5", "--allow-failures"]
    expected = run(*options, engine="isa")
    for fast in [*filter(has, KINDS), "interpreter"]:
        assert run(*options, FP3_FAST=fast) == expected, (model, fast)
        assert run.how.startswith("interpreter" if fast == "interpreter" else f"native {fast}"), run.how


def test_threads_do_not_matter(run):
    options = ["programs/kepler.ode", "-c", "many_full", "--steps", 60, "-N", 20000, "--all", "--spread", "r_x=0.9:1.1"]
    one = run(*options, "--threads", 1)
    assert run(*options, "--threads", 2) == one == run(*options, "--threads", 5)


def test_threads_and_memory_of_the_caller(build):
    """Also: versions; two engines in two threads."""
    out = subprocess.run([build / "tests/hooks"], capture_output=True, text=True, timeout=60)
    assert (out.returncode, out.stdout) == (0, "ok\n"), out.stdout + out.stderr


@pytest.mark.long
def test_threads_share_nothing_unguarded(root, build, tmp_path):
    """The same under the thread sanitizer, in which the rooms that have threads are compiled."""
    (tmp_path / "empty.c").write_text("int main(void) { return 0; }\n")
    if subprocess.run(["gcc", "-fsanitize=thread", "-o", tmp_path / "empty", tmp_path / "empty.c"], capture_output=True).returncode or \
            subprocess.run([tmp_path / "empty"], capture_output=True).returncode:
        pytest.skip("gcc has no thread sanitizer that runs here")
    if build.name.endswith("-san"):
        pytest.skip("the rest of the library has another sanitizer")
    sources = [*(root / "sw/engine/fast").glob("[!s]*.c"), *(root / "sw/engine").glob("*.c"), *(path for room in ("common", "isa", "board") for path in (root / "sw/engine" / room).glob("*.c")), root / "sw/base/threads.c", root / "tests/fast/hooks.c"]
    made = subprocess.run(["gcc", "-fsanitize=thread", "-std=c11", "-D_GNU_SOURCE", "-O1", "-g", "-w", "-ffp-contract=off", "-Isw/include", "-Isw", "-Isim",
                           "-o", tmp_path / "hooks", *sources, build / "lib/libfp3.a", *"-lgsl -lgslcblas -lconfig -lz -ldl -lm".split()],
                          cwd=root, capture_output=True, text=True, timeout=300)
    assert made.returncode == 0, made.stderr
    out = subprocess.run([tmp_path / "hooks"], capture_output=True, text=True, timeout=120)
    assert (out.returncode, out.stdout, out.stderr) == (0, "ok\n", ""), out.stdout + out.stderr


def test_more_objects_than_any_store_has(run):
    out = run("programs/ship.ode", "-c", "many_full", "-N", 300000, "--steps", 3)
    assert "object_steps     900000\n" in out


def test_failures_are_told_as_the_isa_engine_does(run, tmp_path):
    model = tmp_path / "burst.ode"
    model.write_text("param a = 1\nstate x = 1\nx' = a*x*x*x\nstep 0.25\n")
    options = [model, "-c", "many_full", "--steps", 300, "-N", 40, "--spread", "a=0.001:2"]
    expected = run(*options, engine="isa", status=3)
    assert run(*options, status=3) == expected and re.search(r"failed +\d+ of 40, first object \d+ in step \d+: overflow", expected)
    assert run(*options, status=3, FP3_FAST="interpreter") == expected


# What is before the steps, in a step, and behind them.
UNREAD = {"stored_twice": ("", "", "madd b, x, big, big\nst b\nadd b, one, one\nst b\n"),
          "not_chosen": ("", "", "mul y, big, big\nsel b, one, one, y\nst b\n"),
          "dead": ("", "", "mul b, big, big\nadd b, one, one\nst b\n"),
          "of_the_first_step": ("mul y, big, one\n", "mul b, y, big\nmul y, one, one\n", "st b\n")}


@pytest.mark.parametrize("config", ["many_full", "world"])    # with a status of each object, and without
@pytest.mark.parametrize("name", UNREAD)
def test_what_nothing_reads_fails_all_the_same(run, fp3, tmp_path, name, config):
    """The compiler of native code leaves out what has no reader, unless it is told of one: an overflow would go unseen."""
    first, step, last = UNREAD[name]
    (tmp_path / "x.s").write_text(".state x b\n.temp y\n.const big 3e38\n.const one 1\nld x\n" + first + "step:\nadd x, x, one\n" + step + "last:\n" + last + "st x\n")
    subprocess.run([fp3, "asm", "x.s", "-o", "x.fp3"], cwd=tmp_path, check=True)
    options = [tmp_path / "x.fp3", "-c", config, "--steps", 3, "-N", 2, "--set", "x=1", "--set", "b=0"]
    expected = run(*options, engine="isa", status=3)
    assert run(*options, status=3) == expected and run.how.startswith("native"), run.how
    assert re.search(r"^flags +overflow", expected, re.M)


def test_subnormal_numbers(run, tmp_path):
    """They are multiplied by other means than the processor's, in stretches of steps; the bits and flags are the same."""
    model = tmp_path / "decay.ode"
    model.write_text("param a = 1\nstate x = 1e-37\nx' = -a*x\nstep 0.01\n")
    options = [model, "-c", "many_full", "--steps", 1500, "-N", 70, "--all", "--spread", "x=1e-36:1e-42", "--set", "a=1.25"]
    expected = run(*options, engine="isa")
    assert run(*options) == expected == run(*options, FP3_FAST="interpreter")
    small = [bits for bits in re.findall(r" 0x([0-9a-f]{8}) ", expected) if 0 < int(bits, 16) < 0x00800000]
    assert len(small) > 60 and "underflow" in expected, expected


def test_products_around_the_subnormal_numbers(build, long):
    """By every way to multiply that there is here: values, and what is raised."""
    out = subprocess.run([build / "tests/products", str(1_000_000 if long else 10_000)], capture_output=True, text=True, timeout=600)
    assert out.returncode == 0 and out.stdout.endswith("\n0 wrong\n"), out.stdout


# exp2 at the end of its range: of each number, the bits of 2 to its integral part.
POWERS = {"-126.0": 0x00800000, "-127.0": 0x00400000, "-148.5": 2, "-149.0": 1, "-149.5": 1, "-150.0": 0, "-1000.0": 0}
BUGS = [
    Bug("2^-149 is 0", "sw/engine/fast/lanes.h", "n < 150", "n < 149"),
    Bug("2^-150 is not 0", "sw/engine/fast/lanes.h", "n < 150", "n < 151"),
    Bug("2^-127 is 0", "sw/engine/fast/lanes.h", "is_tiny = n > 126", "is_tiny = n > 127"),
    Bug("-149.5 is rounded", "sw/engine/fast/lanes.h", "(significand >> shift)) | (is_over & 1024)", "((significand + (1 << (shift - 1))) >> shift)) | (is_over & 1024)"),
]


@pytest.mark.parametrize("engine", ["isa", "rtl", "interpreter", *KINDS])
def test_exp2_at_the_end_of_its_range(run, tmp_path, engine):
    if engine in KINDS and not has(engine):
        pytest.skip("not on this processor")
    (tmp_path / "x.s").write_text("\n".join([f".state {' '.join(f'p{i}' for i in range(len(POWERS)))}", "step:",
                                            *(f"exp2 p{i}, {number}" for i, number in enumerate(POWERS))]) + "\n")
    said = run(tmp_path / "x.s", "-c", "many_full", "-n", 1, *(f"--set=p{i}=1" for i in range(len(POWERS))),
               engine=engine if engine in ("isa", "rtl") else "fast", FP3_FAST=engine)
    assert {int(i): int(bits, 16) for i, bits in re.findall(r"^p(\d) .* (0x\w{8})", said, re.M)} == dict(enumerate(POWERS.values())), said


@pytest.mark.parametrize("bug", [pytest.param(None, id="as it is"), *few((bug.name, bug) for bug in BUGS)])
def test_a_wrong_exp2_is_seen(root, tmp_path, bug):
    """The same numbers, in the lanes of the fast engine alone."""
    text = (root / "sw/engine/fast/lanes.h").read_text()
    (tmp_path / "lanes.h").write_text(bug.put(text) if bug else text)
    (tmp_path / "x.c").write_text("#define FP3_NEAREST 1\n#define FP3_SUBNORMAL 1\n#define FP3_FINITE 0\n#define FP3_FLAGS 1\n#include <stdio.h>\n#include \"lanes.h\"\n"
                                  "int main(void) {" + "".join(f'printf("%d ", ((fp3_i)fp3_exp2((fp3_v){{0}} + {number}f))[0]);' for number in POWERS) + "}\n")
    subprocess.run(["gcc", "-O1", "-ffp-contract=off", "-frounding-math", "-Wno-psabi", tmp_path / "x.c", "-o", tmp_path / "x"], check=True)
    said = subprocess.run([tmp_path / "x"], capture_output=True, text=True, check=True).stdout
    assert (said.split() == [str(bits) for bits in POWERS.values()]) == (bug is None), said


ESTIMATE_BUGS = [
    Bug("an exact entry is not reached", "sw/engine/fast/place.h", "0x3f000004, 0x3f800002", "0x3efffffc, 0x3f7ffffc"),
    Bug("an entry is passed", "sw/engine/fast/place.h", "0x3f000004, 0x3f800002", "0x3f000040, 0x3f800020"),
    Bug("no step of Newton's", "sw/engine/fast/lanes.h", "(fp3_i)FP3_QUIET_MADD(y, off, y) & FP3_NUMBER(RCP_CUT)", "(fp3_i)y & FP3_NUMBER(RCP_CUT)"),
    Bug("inexact is raised", "sw/engine/fast/lanes.h", "FP3_QUIETLY 8", "FP3_QUIETLY 4"),
    Bug("the largest numbers are ordinary", "sw/engine/fast/place.h", "251 << 23", "254 << 23"),
    Bug("the least number is halved", "sw/engine/fast/place.h", "0x01000000", "0x00800000"),
]
# Of 8 lanes, whose products are exact.
ESTIMATE_BUGS_OF_8 = [
    Bug("no product is above 1", "sw/engine/fast/lanes.h", "(((fp3_i)left >> 31) & unit)", "0"),
    Bug("all entries have the same bits", "sw/engine/fast/lanes.h", "unit = odd + FP3", "unit = FP3"),
    Bug("the next entry is an own one", "sw/engine/fast/lanes.h", "u * next, 17) << 14", "u * next, 18) << 14"),
    Bug("inexact is raised by a step of Newton's", "sw/engine/fast/lanes.h", "-(u * next), next, ", "-(u * next), next * 0.9f, "),
    Bug("what is tiny is ordinary", "sw/engine/fast/place.h", "251 << 23", "252 << 23"),
]


@pytest.mark.parametrize("kind, bug", [*(pytest.param(kind, None, id=f"{kind}, as it is") for kind in KINDS),
                                       *few((bug.name, "x86-64-v4", bug) for bug in ESTIMATE_BUGS),
                                       *few((bug.name, "x86-64-v3", bug) for bug in ESTIMATE_BUGS_OF_8)])
def test_estimates(root, tmp_path, kind, bug):
    """As they are, and wrong: without their table a processor with 8 or 16 lanes has to compute them exactly."""
    if not has(kind):
        pytest.skip("not on this processor")
    (tmp_path / "engine/fast").mkdir(parents=True)
    for name in ("lanes.h", "place.h"):
        text = (root / "sw/engine/fast" / name).read_text()
        (tmp_path / "engine/fast" / name).write_text(bug.put(text) if bug and bug.file.endswith(name) else text)
    subprocess.run(["gcc", "-O1", f"-march={kind}", "-ffp-contract=off", "-frounding-math", "-Wno-psabi", f"-I{tmp_path}", f"-I{root}/sw", f"-I{root}/sw/include",
                    root / "tests/fast/estimates.c", root / "sw/machine/estimate.c", "-o", tmp_path / "x"], check=True)
    out = subprocess.run([tmp_path / "x"], capture_output=True, text=True, timeout=300)
    assert (out.stdout == "0 wrong\n") == (bug is None), out.stdout


def test_what_it_cannot_do_is_refused(run, fp3, root, tmp_path):
    run("programs/ship.ode", "-c", "many_full", "--cycle-limit", 100, status=2)
    assert "no cycles" in run.stderr
    run("programs/ship.ode", "-c", "many_full", "-N", 2**25 + 1, status=2)
    assert "room for 33554432" in run.stderr
    run("programs/ship.ode", "-c", "single_full", "-N", 2, status=2)
    assert "room for 1 object" in run.stderr


def test_what_executes_it_can_be_chosen(run):
    for asked, how in [("interpreter,x86-64", "interpreter x86-64 (asked for)"), ("x86-64,interpreter", "interpreter x86-64 (asked for)"),
                       ("x86-64", "native x86-64"), ("", run("programs/ship.ode", "-c", "many_full") and run.how)]:
        run("programs/ship.ode", "-c", "many_full", FP3_FAST=asked)
        assert run.how == how, asked
    for asked in ("nope", "x86-64-v", "x86-64,", "interpreter,nope", "x" * 5000):
        run("programs/ship.ode", "-c", "many_full", status=0 if asked == "x86-64," else 2, FP3_FAST=asked)
        assert asked == "x86-64," or "FP3_FAST: found '" in run.stderr and "expected interpreter, x86-64" in run.stderr


# ---- the cache ----

SHIP = ["programs/ship.ode", "-c", "many_full", "--steps", 100, "-N", 20]


def entries(tmp_path):
    return sorted((tmp_path / "cache").iterdir())


def test_a_program_is_compiled_once(run, tmp_path):
    first = run(*SHIP)
    (entry,) = entries(tmp_path)
    made = entry.stat().st_mtime_ns
    assert run(*SHIP, FP3_CC="cc") == first and entries(tmp_path) == [entry] and entry.stat().st_mtime_ns == made
    run("programs/kepler.ode", *SHIP[1:])
    assert len(entries(tmp_path)) == 2


@pytest.mark.parametrize("harm", ["cut", "bit", "command", "empty", "other", "directory"])
def test_a_damaged_entry_is_made_again(run, tmp_path, harm):
    expected = run(*SHIP)
    (entry,) = entries(tmp_path)
    data = entry.read_bytes()
    entry.unlink()
    if harm == "directory":
        entry.mkdir()
    elif harm == "other":  # whole, and of another program
        run("programs/kepler.ode", *SHIP[1:])
        entries(tmp_path)[0].rename(entry)
    else:
        middle = len(data) // 10  # of the library's code, which opens with any bits
        entry.write_bytes({"cut": data[:middle], "empty": b"", "command": data.replace(b"-nostdlib", b"-nostdliB"),
                           "bit": data[:middle] + bytes([data[middle] ^ 1]) + data[middle + 1:]}[harm])
    assert run(*SHIP) == expected and run.how.startswith("native")
    assert harm == "directory" or entry.read_bytes() == data


def test_processes_at_the_same_time_share_it(fp3, root, tmp_path):
    environment = {**os.environ, "FP3_CACHE_DIR": str(tmp_path / "cache")}
    several = [subprocess.Popen([fp3, "run", "-e", "fast", *map(str, SHIP)], cwd=root, env=environment,
                                stdout=subprocess.PIPE, text=True) for _ in range(4)]
    said = {re.sub("time .*", "", process.communicate(timeout=60)[0]) for process in several}
    assert len(said) == 1 and all(process.returncode == 0 for process in several)
    assert [entry.suffix for entry in entries(tmp_path)] == [".so"]


@pytest.mark.parametrize("compiler", ["/nonexistent/cc", "false", "true"])
def test_without_a_compiler_it_interprets(run, tmp_path, compiler):
    expected = run(*SHIP)
    for entry in entries(tmp_path):
        entry.unlink()
    assert run(*SHIP, FP3_CC=compiler) == expected
    assert run.how.startswith("interpreter x86-64") and entries(tmp_path) == []


def test_a_cache_that_cannot_be_written(run, tmp_path):
    """No cache at all, a file in its place, a directory that others write to: compiled all the same, nothing left behind."""
    expected = run(*SHIP)
    (tmp_path / "file").write_text("")
    (tmp_path / "open").mkdir()
    (tmp_path / "open").chmod(0o777)
    for place in [tmp_path / "file", tmp_path / "open", "/dev/null/x", "/proc/none"]:
        assert run(*SHIP, FP3_CACHE_DIR=str(place), TMPDIR=str(tmp_path)) == expected
        assert run.how.startswith("native"), place
    assert not list((tmp_path / "open").iterdir()) and not list(tmp_path.glob(".fp3-*"))


def test_a_full_disk(fp3, root, tmp_path):
    """No file may grow beyond 8 kB: what cannot be compiled is interpreted, and nothing is left."""
    environment = {**os.environ, "FP3_CACHE_DIR": str(tmp_path / "cache"), "TMPDIR": str(tmp_path)}
    done = subprocess.run(["bash", "-c", 'trap "" XFSZ; ulimit -f 8; exec "$@"', "-", fp3, "run", "-e", "fast", *map(str, SHIP)], cwd=root,
                          env=environment, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0 and "interpreter" in done.stdout, done.stdout + done.stderr
    assert not list(tmp_path.glob("**/.fp3-*")) and not list((tmp_path / "cache").glob("*"))


def test_the_cache_is_its_owner_s(run, tmp_path):
    run(*SHIP)
    assert stat.S_IMODE((tmp_path / "cache").stat().st_mode) == 0o700


def plant(run, tmp_path):
    """The one entry, with other code and a right checksum: what an attacker would leave there. It prints when it is loaded."""
    expected = run(*SHIP)
    (entry,) = entries(tmp_path)
    data = entry.read_bytes()
    size, = struct.unpack("<Q", data[-16:-8])
    text = data[-16 - size:-16]
    source = 'void planted(void) __attribute__((constructor)); int puts(const char *); void planted(void) { puts("planted"); }'
    subprocess.run(["gcc", "-shared", "-fPIC", "-x", "c", "-", "-o", entry], input=source, text=True, check=True)
    body = entry.read_bytes() + text
    entry.write_bytes(body + struct.pack("<QII", size, zlib.crc32(body), 0x46335046))
    return expected, entry


def test_an_entry_that_is_somebody_else_s_is_not_loaded(run, tmp_path):
    expected, entry = plant(run, tmp_path)
    assert "planted" in run(*SHIP, status=0), "the plant works where it is the user's own"
    entry.chmod(0o666)
    assert run(*SHIP) == expected and run.how.startswith("native"), "others can write to it"
    _, entry = plant(run, tmp_path)
    if os.geteuid() == 0:
        os.chown(entry, 12345, 12345)
        assert run(*SHIP) == expected and entry.stat().st_uid == 0
    _, entry = plant(run, tmp_path)
    entry.rename(tmp_path / "elsewhere")
    entry.symlink_to(tmp_path / "elsewhere")
    assert run(*SHIP) == expected and not entry.is_symlink()


def test_a_cache_below_a_directory_of_others_is_not_used(run, tmp_path):
    """Who can rename a directory above the cache can put another in its place. A sticky one is no such door."""
    expected = run(*SHIP)
    above = tmp_path / "above"
    (above / "cache").mkdir(parents=True, mode=0o700)
    above.chmod(0o777)
    cache = {"FP3_CACHE_DIR": str(above / "cache")}
    assert run(*SHIP, **cache) == expected
    assert run.how.startswith("native") and run.how.endswith(f"(no cache: other users can write to {above})") and not list((above / "cache").iterdir())
    assert run(*SHIP, FP3_FAST="interpreter", **cache) == expected
    above.chmod(0o1777)
    assert run(*SHIP, **cache) == expected and run.how.endswith(run.how.split()[-1]) and "no cache" not in run.how
    assert list((above / "cache").iterdir())
    above.chmod(0o777)
    assert run(*SHIP, FP3_CACHE_DIR=str(above / "cache"), TMPDIR=str(above)) == expected, "nor is a place for temporary files"
    assert run.how.startswith("interpreter") and f"other users can write to {above}" in run.how


def test_a_command_with_its_owner_s_rights_takes_no_program_from_its_caller(fp3):
    """The environment is the caller's: a command that is setuid must not start what FP3_CC names, nor trust his cache."""
    if os.geteuid() != 0:
        pytest.skip("needs root")
    with tempfile.TemporaryDirectory() as folder:
        os.chmod(folder, 0o755)
        command = shutil.copy(fp3, folder)
        shutil.copy(fp3.parents[1] / "programs/ship.ode", folder)
        os.chown(command, 65534, 65534)
        os.chmod(command, 0o4755)
        pathlib.Path(folder, "cc").write_text(f"#!/bin/sh\ntouch {folder}/started\nexit 1\n")
        os.chmod(folder + "/cc", 0o755)
        os.chmod(folder, 0o777)
        environment = {**os.environ, "FP3_CC": folder + "/cc", "FP3_CACHE_DIR": folder + "/cache", "HOME": folder, "TMPDIR": folder}
        done = subprocess.run([command, "run", "-e", "fast", "ship.ode", *map(str, SHIP[1:])], cwd=folder, capture_output=True, text=True, env=environment, timeout=60)
        assert done.returncode == 0, done.stderr
        assert sorted(os.listdir(folder)) == ["cc", command.split("/")[-1], "ship.ode"], done.stdout


@pytest.mark.parametrize("deaf", ["", "trap '' TERM; "])
def test_a_compiler_that_hangs_is_ended(run, tmp_path, fast_clock, deaf):
    expected = run(*SHIP)
    for entry in entries(tmp_path):
        entry.unlink()
    (tmp_path / "cc").write_text(f"#!/bin/bash\n{deaf}for ((;;)); do :; done\n")
    (tmp_path / "cc").chmod(0o755)
    assert run(*SHIP, FP3_CC=str(tmp_path / "cc"), **fast_clock) == expected
    assert run.how.startswith("interpreter") and "took longer than 120 s" in run.how, run.how


# ---- native code in a file ----


@pytest.fixture
def native(fp3, root, tmp_path):
    """`fp3 compile --native` of a model; gives the file."""

    def make(model, name, **environment):
        done = subprocess.run([fp3, "compile", model, "-c", "many_full", "--native", "-o", tmp_path / name], cwd=root, capture_output=True, text=True,
                              env={**os.environ, "FP3_CACHE_DIR": str(tmp_path / "none"), **environment}, timeout=120)
        assert done.returncode == 0, done.stderr
        return tmp_path / name

    return make


MODEL = ["programs/ship.ode", "-c", "many_full", "--steps", 100, "-N", 20]


def test_a_program_goes_to_a_machine_without_a_compiler(run, native, tmp_path):
    file = native("programs/ship.ode", "ship.native")
    there = {"FP3_CC": "/nonexistent/cc", "FP3_CACHE_DIR": "/dev/null/x"}
    expected = run(*MODEL)
    assert run(*MODEL, "--native", file, **there) == expected and run.how.startswith("native x86-64")
    assert run(*MODEL, "--native", file, FP3_FAST="interpreter", **there) == expected and run.how.startswith("interpreter")
    plain = native("programs/ship.ode", "plain.native", FP3_FAST="x86-64")
    assert run(*MODEL, "--native", plain, **there) == expected and run.how == "native x86-64"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cache", "plain.native", "ship.native"]


def resealed(data, old, new):
    """With another text and the checksum of that: as a program that is right, but another, would have."""
    assert data.count(old) >= 1 and len(old) == len(new)
    body = data[:-16].replace(old, new)
    return body + data[-16:-8] + zlib.crc32(body).to_bytes(4, "little") + data[-4:]


def test_a_file_of_native_code_that_does_not_fit_is_refused(run, native):
    """Another program, configuration, version, processor; damaged at any place; none at all: with a reason, and without a number."""
    file = native("programs/ship.ode", "ship.native")
    data = file.read_bytes()
    version = re.search(rb"/\* fp3 (\S+) (\S+) \*/", data)
    cases = {"of another program": ["programs/kepler.ode", "-c", "many_full"], "or for another configuration": ["programs/ship.ode", "-c", "small"]}
    for said, other in cases.items():
        assert run(*other, "--native", file, status=2) == "" and said in run.stderr, run.stderr
    spoiled = {"made by another version": resealed(data, version[0], version[0].replace(version[1], b"9" * len(version[1]))),
               "is native code for x86-64-v9": resealed(data, version[0], version[0].replace(version[2], b"x86-64-v9"[:len(version[2])].ljust(len(version[2])))),
               "of another program": resealed(data, b"fp3_mul(", b"fp3_add(")}
    if len(version[2]) < len("x86-64-v9"):
        del spoiled["is native code for x86-64-v9"]
    for n in (0, 15, len(data) // 2, len(data) - 1):
        spoiled[f"is damaged ({n})"] = data[:n]
    for place in range(0, len(data), len(data) // 12):
        spoiled[f"is damaged, at {place}"] = data[:place] + bytes([data[place] ^ 16]) + data[place + 1:]
    for said, text in spoiled.items():
        file.write_bytes(text)
        assert run(*MODEL, "--native", file, status=2) == "" and re.split(r",? \(|, at", said)[0] in run.stderr, (said, run.stderr)
    file.unlink()
    run(*MODEL, "--native", file, status=2)
    assert "cannot open" in run.stderr
    run(*MODEL, "--native", file, engine="isa", status=2)
    assert "executes no native code" in run.stderr


def test_native_code_that_cannot_be_written(fp3, root, tmp_path):
    for environment, output in [({"FP3_CC": "false"}, tmp_path / "x"), ({}, tmp_path / "no" / "x"), ({}, "/dev/null/x")]:
        done = subprocess.run([fp3, "compile", "programs/ship.ode", "-c", "many_full", "--native", "-o", output], cwd=root, capture_output=True,
                              text=True, env={**os.environ, **environment}, timeout=60)
        assert done.returncode in (1, 2) and done.stderr.startswith("fp3 compile: ") and not list(tmp_path.iterdir()), done.stderr


@pytest.mark.parametrize("links", [False, True])
def test_a_constant_that_is_a_nan(fp3, tmp_path, links):
    """Native code takes no shared constant for a NaN, so such a program is interpreted: alone and among neighbours, quiet and signalling."""
    (tmp_path / "x.ode").write_text("model x \"x\"\nstate x = 1\nstate y = 0\n" + "links others\n" * links + "step 0.01\n"
                                    + ("x' = 0*sum(o in others: o.x - x)" if links else "x' = 0*x") + "\ny' = 0\nproject y = x < 0.625 ? x : 2\n")
    (tmp_path / "l.csv").write_text("a,b\n0,1\n")
    subprocess.run([fp3, "compile", tmp_path / "x.ode", "--config", "world", "-i", "euler", "-o", tmp_path / "x.s"], check=True)
    text = (tmp_path / "x.s").read_text()
    found = []
    for bits in ("bits:0x40400000", "bits:0x7fc12345", "bits:0x7fa00000"):
        (tmp_path / "y.s").write_text(re.sub(r"(sel +y, x, )2.0", rf"\g<1>{bits}", text))
        subprocess.run([fp3, "asm", tmp_path / "y.s", "-o", tmp_path / "y.img"], check=True)
        runs = [subprocess.run([fp3, "run", tmp_path / "y.img", "-c", "world", "-e", engine, "-N", "2", *(["--links", f"others={tmp_path}/l.csv"] if links else []),
                                "--set", "x=1", "--set", "y=0", "--set", "h=0.01", "--steps", "2", "--all"], capture_output=True, text=True) for engine in ("isa", "fast")]
        said = [(run.returncode, run.stderr, re.findall(r"^(?:y|flags) .*$", run.stdout, re.M)) for run in runs]
        assert said[0] == said[1]
        found.append(said[0][2])
    assert "0x40400000" in found[0][0] and "0x7fc00000" in found[1][0] and found[2][-1] != found[1][-1]
