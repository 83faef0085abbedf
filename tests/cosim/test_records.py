"""Programs that load and store within a step: what their states are, and which of them fails when, by every engine."""

import re
import subprocess

import pytest

pytestmark = pytest.mark.smoke

# y counts down; from the step in which it is 0, x is infinite, which raises no flag. Between two steps both are in their records
# alone, and the register of y holds what is infinite in each step.
PROGRAM = """
.state y
.state x
.param down
.temp  t
step:
    ld    y
    ld    x
    ld    down
    sub   y, y, down
    st    y
    rcp   t, y
    abs   t, t
    add   x, x, t
    st    x
    sub   t, down, down
    rcp   y, t
    add   x, t, down
"""
WAYS = [("isa", ""), ("fast", "interpreter"), ("fast", ""), ("rtl", "")]


@pytest.fixture
def run(fp3, tmp_path):
    path = tmp_path / "records.s"
    path.write_text(PROGRAM)

    def start(engine, how, y, steps, *more, status=0):
        done = subprocess.run([fp3, "run", path, "-c", "many_full", "-e", engine, "-N", "30", "--steps", str(steps), "--visit", "2", "--all",
                               "--set", f"y={y}", "--set", "x=0", "--set", "down=1", *more],
                              env={"FP3_FAST": how, "FP3_CACHE_DIR": str(tmp_path / "cache"), "PATH": "/usr/bin:/bin"}, capture_output=True, text=True)
        assert done.returncode == status, done.stdout + done.stderr
        return done.stdout

    return start


def states(out):
    return re.findall(r"^([xy]) +(\S+) +0x(\w+) +object (\d+)$", out, re.M)


@pytest.mark.parametrize("engine, how", WAYS)
def test_states_are_in_their_records(run, engine, how):
    """x is 1/9 + 1/8 + ... + 1/5, by estimates of nine bits."""
    found = states(run(engine, how, 10, 5))
    assert len(found) == 60 and len({row[:3] for row in found}) == 2, found
    values = {row[0]: float(row[1]) for row in found}
    assert values["y"] == 5 and 0 < sum(1 / n for n in range(5, 10)) - values["x"] < 2**-8, values
    assert found == states(run("isa", "", 10, 5))


@pytest.mark.parametrize("engine, how", WAYS)
def test_a_failure_is_that_of_the_record(run, engine, how):
    out = run(engine, how, 3, 7, status=3)
    assert re.search(r"^failed +30 of 30, first object 0 in step 3: state x is infinite$", out, re.M), out


# An object that falls asleep stores nothing from then on but in the last part; its first store in the step part is behind `sleep`.
ASLEEP = """
.state x
.state s
.param eps
.temp  d
first:
    lds   s
    ld    x
    ld    eps
step:
    mul   d, x, 0.5
    add   x, x, 1.0
    sleep s, d, eps
    st    x
last:
    st    s
"""
# No number that a record of 16 bits holds, in the word that is kept whole.
LARGE = """
.state x slept
first:
    ld    x
    ld    slept
step:
    add   x, x, 1.0
    add   slept, slept, 1e9
    sleep slept, 1.0, 0.5
last:
    st    x
    st    slept
"""
KEPT = {"asleep between two stores": (ASLEEP, "many_full", "-N 4 --spread x=-6:3 --set s=0 --set eps=1 --steps 6"),
        "beside a word that the host writes": (ASLEEP, "many_half", "-N 2 --spread x=-6:3 --set s=70000 --set eps=1 --steps 2"),
        "a whole word beyond binary16": (LARGE, "many_half", "-N 2 --set x=0 --set slept=0 --steps 3")}


@pytest.mark.parametrize("name", KEPT)
def test_sleepers_keep_their_words(fp3, tmp_path, name):
    text, config, options = KEPT[name]
    path = tmp_path / "program.s"
    path.write_text(text)

    def told(engine, how):
        done = subprocess.run([fp3, "run", path, "-c", config, "-e", engine, "--all", *options.split()], capture_output=True, text=True,
                              env={"FP3_FAST": how, "FP3_CACHE_DIR": str(tmp_path / "cache")})
        assert done.returncode == 0, done.stdout + done.stderr
        return re.findall(r"^(\w+ +\S+ +0x\w+ +object \d+|flags .*)$", done.stdout, re.M)

    isa = told("isa", "")
    assert len(isa) > 4
    for engine, how in WAYS[1:]:
        assert told(engine, how) == isa, (engine, how)
