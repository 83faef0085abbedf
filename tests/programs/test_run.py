"""`fp3 run`: what it prints, and each kind of bad input."""

import re
import struct
import subprocess
import sys
import zlib

import pytest


@pytest.fixture
def image(fp3, root, tmp_path):
    path = tmp_path / "ship.fp3"
    subprocess.run([fp3, "asm", root / "programs/ship.s", "-o", path], check=True)
    return path


@pytest.fixture
def run(fp3, root, tmp_path):
    def start(*arguments):
        done = subprocess.run([fp3, "run", *arguments], cwd=tmp_path, capture_output=True, text=True, timeout=300)
        assert done.returncode in (0, 1, 2), done.stderr
        return done

    return start


@pytest.fixture
def params(root):
    return ["--params", root / "programs/ship.cfg"]


def fails(done, code, message):
    assert done.returncode == code, done.stdout + done.stderr
    assert re.search(message, done.stderr), done.stderr


@pytest.mark.smoke
@pytest.mark.parametrize("engine", ["rtl", "isa"])
def test_run_prints_states_and_counters(run, image, params, engine):
    done = run(image, "--engine", engine, "--steps", "10", *params)
    assert done.returncode == 0, done.stderr
    for row in (r"v +0\.0\d+ +0x3\w{7}", r"s +0\.0\d+ ", r"object_steps +10", r"retired +303", r"flags +inexact"):
        assert re.search("^" + row, done.stdout, re.M), done.stdout


def test_both_engines_print_the_same_states(run, image, params):
    states = {engine: re.findall(r"^[vs] .*0x\w+", run(image, "--engine", engine, "--steps", "99", *params).stdout, re.M)
              for engine in ("rtl", "isa")}
    assert len(states["rtl"]) == 2 and states["rtl"] == states["isa"]


@pytest.mark.parametrize("engine", ["rtl", "isa"])
def test_who_was_found_asleep_is_not_visited_again(run, tmp_path, engine):
    """The program's own lds finds what its own store has left: from the second visit on there is nobody to visit."""
    (tmp_path / "x.s").write_text(".state v z\nfirst: lds z\nld v\nstep: add v, v, 1.0\nlast: add z, v, v\nst v\nst z\n")
    counts = set()
    for steps in ("3", "30"):
        out = run("x.s", "--engine", engine, "-c", "many", "--visit", "1", "--steps", steps, "--set", "v=4", "--set", "z=0").stdout
        assert re.search(r"^v +5 .*object 0$", out, re.M) and re.search(r"^z .* 0x41200000 ", out, re.M), out
        counts.add(re.search(r"^issued_memory +(\d+)$", out, re.M)[1])
    assert len(counts) == 1, "each visit more loads something"


def test_many_objects_print_eight_and_the_rest_on_demand(run, image, params):
    many = ("--config", "array", "--objects", "20", "--visit", "3", "--steps", "7", *params)
    states = {}
    for engine in ("rtl", "isa"):
        short, whole = (run(image, "--engine", engine, *many, *more).stdout for more in ((), ("--all",)))
        states[engine] = re.findall(r"^[vs] .*object \d+$", whole, re.M)
        assert len(states[engine]) == 40
        assert re.findall(r"^[vs] .*object \d+$", short, re.M) == states[engine][:16]
        assert re.search(r"^more +12 objects", short, re.M) and not re.search("^more", whole, re.M)
        assert re.search(r"^object_steps +140$", whole, re.M)
    assert states["rtl"] == states["isa"]


@pytest.fixture
def sleeper(fp3, root, tmp_path):
    path = tmp_path / "sleeper.fp3"
    subprocess.run([fp3, "asm", root / "programs/ship_sleep.s", "-o", path], check=True)
    return path


@pytest.mark.parametrize("engine", ["rtl", "isa"])
def test_who_sleeps_is_told(run, sleeper, params, engine):
    many = ("--config", "shared", "--engine", engine, *params)
    done = run(sleeper, *many, "--steps", "900", "--set", "eps=2e-3", "--visit", "100")
    step = int(re.search(r"^slept +(\d+) +0x0000\w+   object 0$", done.stdout, re.M)[1])
    assert 1 < step < 900
    assert re.search(rf"^asleep +48 of 48, since steps {step} to {step}$", done.stdout, re.M)
    assert re.search(rf"^object_steps +{48 * step}$", done.stdout, re.M)
    done = run(sleeper, *many, "--steps", "9", "--set", "eps=0", "--set", "slept=5", "--objects", "3")
    assert re.search(r"^object_steps +0$", done.stdout, re.M)
    fails(run(sleeper, *many, "--set", "eps=0", "--set", "slept=0.5"), 2, "'slept' is 0.5: expected the number of a step")


def test_the_cycles_are_told_by_scheduler(run, image, params):
    out = run(image, "--config", "array", "--steps", "5", *params).stdout
    assert re.findall(r"^occupancy of scheduler (\d)$", out, re.M) == list("0123")
    assert "occupancy" not in run(image, "--engine", "isa", *params).stdout


def test_the_pipeline_is_logged(run, image, params, root, tmp_path):
    done = run(image, "--config", "array", "--objects", "8", "--steps", "3", "--kanata", "log", *params)
    retired = re.search(r"^retired +(\d+)$", done.stdout, re.M)[1]
    check = subprocess.run([sys.executable, root / "tests/kanata/check.py", "log", "--schedulers", "4", "--contexts", "24"],
                           cwd=tmp_path, capture_output=True, text=True)
    assert check.returncode == 0 and f"{retired} instructions" in check.stdout, check.stdout + check.stderr
    fails(run(image, "--engine", "isa", "--kanata", "log2", *params), 2, "only the hardware")
    fails(run(image, "--kanata", "nonesuch/log", *params), 2, "nonesuch/log")


def test_only_so_many_objects_fit(run, image, params):
    fails(run(image, "--objects", "2", *params), 2, "2 objects: configuration 'single' has room for 1 object; 'many' and 'many_full' have room for more")
    fails(run(image, "--config", "array", "--objects", "10000", *params), 2, "has room for 512 at most")
    fails(run(image, "--objects", "0", *params), 2, "'0' is no number from 1 to 4294967295")
    fails(run(image, "--visit", "0", *params), 2, "'0' is no number from 1")


def blocks(page):
    """The indented blocks of a page, as they would be copied from it."""
    return [re.sub("^    ", "", block, flags=re.M) for block in re.findall(r"(?:^(?:    .*)?\n)+", page.read_text(), re.M)]


def test_the_programs_of_the_pages_compute_what_they_say(root, fp3, tmp_path):
    """tests/docs runs all commands; this looks at the results of one."""
    texts = (text for text in blocks(root / "docs/assembly.md") if "step:" in text)
    for name in ("euler.s", "page.s"):
        (tmp_path / name).write_text(next(texts))
    for name in ("euler", "page"):
        subprocess.run([fp3, "asm", f"{name}.s", "-o", f"{name}.fp3"], cwd=tmp_path, check=True, timeout=60)
    values = {"T": 1.2e6, "C": 5e4, "rm": 4e-7, "h": 0.0078125, "v": 0, "s": 0}
    done = subprocess.run([fp3, "run", "euler.fp3", "-c", "single", "--steps", "1000", *(word for item in values.items() for word in ("--set", "%s=%g" % item))],
                          cwd=tmp_path, capture_output=True, text=True, timeout=60)
    v = s = 0.0
    for _ in range(1000):
        v += 0.0078125 * (1.2e6 - 5e4 * v) * 4e-7
        s += 0.0078125 * v
    got = dict(re.findall(r"^([vs]) +(\S+)", done.stdout, re.M))
    assert float(got["v"]) == pytest.approx(v, rel=1e-5) and float(got["s"]) == pytest.approx(s, rel=1e-5)


def test_a_missing_file_is_named(run):
    fails(run("nonesuch.fp3"), 2, "nonesuch.fp3")


def test_a_truncated_image_is_refused(run, image, tmp_path):
    whole = image.read_bytes()
    for size in (0, 3, 20, len(whole) // 2, len(whole) - 4):
        short = tmp_path / "short.fp3"
        short.write_bytes(whole[:size])
        fails(run(short), 2, "short.fp3")


def test_an_illegal_word_is_trapped_by_the_hardware(run, image, params, tmp_path):
    """The image is sound, its third word is not: only execution finds it."""
    words = list(struct.unpack(f"<{len(image.read_bytes()) // 4}I", image.read_bytes()))
    words[9 + 2] = 0xdeadbeef
    body = struct.pack(f"<{len(words) - 1}I", *words[:-1])
    bad = tmp_path / "bad.fp3"
    bad.write_bytes(body + struct.pack("<I", zlib.crc32(body)))
    done = run(bad, *params, "--config", "single")
    fails(done, 2, "word 2 is 0xdeadbeef, no instruction of configuration 'single'")
    assert re.search(r"^retired +2$", done.stdout, re.M)


def test_the_cycle_limit_ends_a_run_with_1(run, image, params):
    done = run(image, *params, "--steps", "4000000000", "--cycle-limit", "5000")
    fails(done, 1, "limit of 5000 cycles")
    assert re.search(r"^v ", done.stdout, re.M) and re.search(r"^object_steps +0$", done.stdout, re.M)


def test_parameters_are_all_needed_and_all_known(run, image, params, tmp_path):
    fails(run(image), 2, "'.*' has no value")
    fails(run(image, *params, "--set", "mass=3"), 2, "no 'mass'")
    fails(run(image, *params, "--set", "h=fast"), 2, "'fast' is no number")
    fails(run(image, *params, "--set", "h"), 2, "'h' is not name=value")
    fails(run(image, *params, "--set", "h=1e39"), 2, "'h' is 1e\\+39: expected a time step from 1.4e-45")
    fails(run(image, "--params", "nonesuch.cfg"), 2, "nonesuch.cfg")
    for text, message in (("h = ;", "x.cfg:1: syntax error"), ("\nh = true;", "x.cfg:2: h: found true or false, expected a number or"),
                          ('rm = "1/m";', "'rm' is 1/m")):
        (tmp_path / "x.cfg").write_text(text)
        fails(run(image, "--params", "x.cfg", *(f"--set={name}=1" for name in ("v", "s", "T", "C"))), 2, message)


def test_unknown_names_are_refused(run, image, params):
    fails(run(image, *params, "--config", "nonesuch"), 2, "no configuration 'nonesuch': there are .*single")
    fails(run(image, *params, "--engine", "abacus"), 2, "no engine 'abacus'")
    fails(run(image, *params, "--steps", "-1"), 2, "--steps: '-1' is no number from 0 to 4294967295")
    fails(run(image, *params, "--steps", "4294967296"), 2, "--steps: '4294967296' is no number from 0 to 4294967295")
    fails(run(), 2, "expected a program")


def test_the_bus_log_tells_the_run(run, image, params, tmp_path):
    assert run(image, *params, "--bus-log", "log").returncode == 0
    log = (tmp_path / "log").read_text()
    lines = log.splitlines()
    assert all(re.fullmatch(r"[wrp] [0-9a-f]{8} [0-9a-f]{8}|[he] [0-9a-f]{8} [0-9a-f]{8}", line) for line in lines)
    assert lines[-1] == f"e {len(lines) - 1:08x} 00000000"
    assert [line[0] for line in lines].count("h") == 1
    assert re.search(r"w 00000010 00000001\np 00000014 00000001\nr 00000014 00000002\n", log)  # start, wait, done
    fails(run(image, *params, "--bus-log", "nonesuch/log"), 2, "nonesuch/log")
