"""Nothing depends on what memories and registers hold at power-up, or on the moment of a reset.

For simulation the RTL gives its memories zeros, and always the registers of reset a one, as an FPGA does. Here that is taken out: everything
is x, so that what is not reset shows; or it is random, since an `if` in Verilog takes an x for a zero. sim/replay.v looks for x and resets.
"""

import random
import re
import shutil
import subprocess

import pytest

import simulate
from bugs import few

ZEROS = "initial for (i = 0; i < (1 << ADDR_W); i = i + 1) memory[i] = {W{1'b0}};"
RANDOM = ZEROS.replace("{W{1'b0}}", "{$random, $random, $random, $random}")
POWER_UP = {"lib/fp3_lutram_1r1w.v": ZEROS, "lib/fp3_ram_1r1w.v": ZEROS, "lib/fp3_ram_registered.v": ZEROS, "fp3.v": "initial          reset_q = {RESET{1'b1}};",
            "lane/fp3_lane_group.v": "initial             rst_q = 1'b1;"}
INITIAL = re.compile(r"\binitial\b|\breg\b[^;]*?=(?!=)")

# What a test runs: configuration, objects, steps, resets.
SHORT = {"single": (1, 1, 4), "many": (1, 1, 1)}
LONG = {"single": (1, 20, 20), "many": (6, 1, 20), "lanes": (9, 1, 4), "dual": (5, 1, 4), "array": (10, 1, 4), "shared": (6, 1, 8), "many_full": (3, 1, 8)}


def start(*command, cwd=None):
    return subprocess.run([str(word) for word in command], cwd=cwd, capture_output=True, text=True, timeout=500)


def undefined(root, to, fill="", bug=None):
    """A copy of the sources in which memories and registers have `fill` at power-up, perhaps with a bug: (file, right, wrong)."""
    for folder in ("rtl", "sim"):
        shutil.copytree(root / folder, to / folder, ignore=shutil.ignore_patterns("fpga"))
    for file, text, other in [*((file, text, fill if text == ZEROS else "") for file, text in POWER_UP.items()),
                              *([bug] if bug else [])]:
        path = to / "rtl" / file
        assert path.read_text().count(text) == 1, f"{file}, expected once: {text!r}"
        path.write_text(path.read_text().replace(text, other))
    return to


def compiled(tree, config, *more):
    done = start("iverilog", "-g2012", *simulate.shape(config), "-s", "replay", "-c", "rtl/fp3.f",
                 "-o", "x.vvp", "sim/replay.v", simulate.top(config), *more, cwd=tree)
    assert done.returncode == 0, done.stderr
    return tree / "x.vvp"


def record(root, fp3, at, config, objects, steps):
    """A run of objects that fall asleep, where there is sleep; of sums and products kept apart, where they have to be."""
    image, session = at / "x.fp3", at / f"{config}.session"
    program, *more = ("ship_sleep", "--set", "eps=1e9") if simulate.key(config, "SLEEP") else \
                     ("ship_dual", ) if simulate.key(config, "MULTIPLY_ADD") == 3 else ("ship_madd", )
    assert start(fp3, "asm", root / f"programs/{program}.s", "-o", image).returncode == 0
    done = start(fp3, "run", image, "-c", config, "-N", objects, "--steps", steps, "--params", root / "programs/ship.cfg", *more,
                 "--bus-log", session)
    assert done.returncode == 0, done.stderr
    rows = session.read_text().splitlines()
    begin = next(i for i, row in enumerate(rows) if row.startswith("p")) - 1        # the start
    # The status of an object counts from what the host wrote; the command takes it for the 0 of power-up. Its space is 3, from bit 16 on.
    clears = [f"w {row.split()[1]} 00000000" for row in rows if row[0] == "r" and int(row.split()[1], 16) >> 16 & 3 == 3]
    rows = [*rows[:begin], *clears, *rows[begin:-1]]
    session.write_text("\n".join([*rows, f"e {len(rows):x} 0"]) + "\n")
    return session


def random_registers(tree, config, session):
    """A second top that gives each register a random value: their names are those of a wave file."""
    start("vvp", "-n", compiled(tree, config), f"+session={session}", f"+waves={tree / 'x.vcd'}", "+limit=1")
    scope, rows = [], []
    for line in (tree / "x.vcd").read_text().splitlines():
        words = line.split()
        if line.startswith("$scope"):
            scope.append(words[2])
        elif line.startswith("$upscope"):
            scope.pop()
        elif line.startswith("$var reg") and scope[1:2] == ["dut"]:
            rows.append(f"{'.'.join(scope)}.{words[4]} = {{{', '.join(['$random(seed)'] * -(-int(words[2]) // 32))}}};")
    assert len(rows) > 100
    text = "\n".join(["module fill;", "integer seed = 1;", "initial begin", 'if (!$value$plusargs("fill=%d", seed)) seed = 1;', "#1;", *rows,
                      "end", "endmodule", ""])
    (tree / "fill.v").write_text(text)
    return ["-s", "fill", "fill.v"]


def resets(vvp, session, count, seed):
    return start("vvp", "-n", vvp, f"+session={session}", f"+resets={count}", f"+seed={seed}", f"+fill={seed}").stdout


def test_nothing_else_is_initialised(root):
    """What the tests take out is all that there is; a table of constants is no state. Synthesis sees no contents of a memory, which not every
    device can load, and for which some tools would walk through all words."""
    found = {}
    for path in sorted((root / "rtl").rglob("*.v")):
        text = re.sub(r"`ifdef FP3_(CHECK|ZEROS).*?`endif", "", path.read_text(), flags=re.S)
        count = len(INITIAL.findall(re.sub(r"//.*", "", text)))
        if count and "board" not in path.parts:   # a board's line is idle at power-up
            found[str(path.relative_to(root / "rtl"))] = count
    registers = [name for name, text in POWER_UP.items() if text != ZEROS]
    assert found == {**dict.fromkeys(registers, 1), "fp/fp3_fp_estimate.v": 1, "lib/fp3_rom_registered.v": 1, "fpga/ice40/fp3_counters.v": 1}


@pytest.mark.parametrize("fill", ["unknown", "random"])
@pytest.mark.parametrize("config", LONG)
def test_resets_at_random_moments(root, fp3, tmp_path, long, config, fill):
    """No x is seen, and the run after resets has the answers, cycles and retirements of a fresh one."""
    if not long and (config not in SHORT or (config, fill) == ("many", "random")):
        pytest.skip("only with --long")
    tree = undefined(root, tmp_path, RANDOM if fill == "random" else "")
    *run, count = (LONG if long else SHORT)[config]
    session = record(root, fp3, tmp_path, config, *run)
    # The RTL's own checks hold from the first reset on; random registers break them before, where x does not.
    vvp = compiled(tree, config, *(random_registers(tree, config, session) if fill == "random" else ["-DFP3_CHECK"]))
    for seed in random.Random().sample(range(10**9), 3 if long else 1):
        said = resets(vvp, session, count, seed)
        assert "PASS " in said and "FAIL" not in said, f"+resets +seed={seed} +fill={seed}: {said}"


BUGS = {
    # what is wrong: (configuration, fill, (file, right, wrong), what the bench says)
    "a response without reset": ("single", "", ("bus/fp3_responses.v", "{gone_q, filled_q, taken_q} <= {3*(DEPTH_W+1){1'b0}}",
                                                "{gone_q, taken_q} <= {2*(DEPTH_W+1){1'b0}}"), "the bus or the interrupt is unknown"),
    "a flag without reset": ("single", "", ("solo/fp3_scoreboard.v", "if (rst_i) busy_q <=", "if (1'b0) busy_q <="), "something unknown issues or retires"),
    "an enable without reset": ("single", "", ("host/fp3_host_port.v", "was_running_q, flags_q, irq_enable_q, ended_q} <= 12'd0",
                                              "was_running_q, flags_q, ended_q} <= 11'd0"), "the bus or the interrupt is unknown"),
}


@pytest.mark.parametrize("name", few((name, name) for name in BUGS))
def test_finds(root, fp3, tmp_path, name):
    config, fill, bug, message = BUGS[name]
    vvp = compiled(undefined(root, tmp_path, fill, bug), config, "-DFP3_CHECK")
    said = resets(vvp, record(root, fp3, tmp_path, config, 1, 1), 2, 1)
    assert message in said and "PASS" not in said, said
