"""What a run costs at a clock, spread values, progress on a terminal, and where the compiler sees an error."""

import os
import pty
import re
import select
import subprocess
import threading
import time

import pytest

MODEL = "state x = 1\nstate v = 0\nparam k = 1\nx' = v\nv' = -k*x\nstep 0.01\n"


@pytest.fixture
def start(fp3, tmp_path):
    (tmp_path / "m.ode").write_text(MODEL)

    def start(*arguments, **options):
        return subprocess.run([fp3, *arguments], cwd=tmp_path, capture_output=True, text=True, timeout=120, **options)
    return start


def states(text):
    return re.findall(r"^\w+ +\S+ +0x\w+   object \d+$", text, re.M)


def counters(text):
    return re.findall(r"^(?:cycles|retired|issued_\w+|stall_\w+|object_steps|flags) .*$", text, re.M)


# ---- the clock ----

@pytest.mark.parametrize("clock, hertz", [("130MHz", 130e6), ("1.5 GHz", 1.5e9), ("32.768kHz", 32768), ("5e7Hz", 5e7)])
def test_a_run_takes_its_cycles_at_the_clock(start, clock, hertz):
    out = start("run", "m.ode", "-n", "100", "-c", "many_full", "--clock", clock).stdout
    cycles, steps = (int(re.search(rf"^{name} +(\d+)$", out, re.M)[1]) for name in ("cycles", "object_steps"))
    seconds, said = re.search(r"^time +(\S+) s at \S+ MHz: (\d+) cycles$", out, re.M).groups()
    assert int(said) == cycles and float(seconds) == pytest.approx(cycles / hertz, rel=1e-5)
    assert float(re.search(r"^per object-step +(\S+) s$", out, re.M)[1]) == pytest.approx(cycles / hertz / steps, rel=1e-5)
    assert re.search(r"^simulator +\S+ s, \S+ cycles/second; simulation time, not FPGA time$", out, re.M)


def test_a_bus_that_waits_takes_longer_and_changes_nothing_else(start):
    """The same transfers, bits and counters; 0 to 3 cycles for each channel of each transfer more."""
    outs = [start("run", "m.ode", "-n", "9", "-c", "many_full", "-N", "5", "--clock", "1GHz", *more).stdout
            for more in ([], *(["--bus-waits", seed] for seed in "123"))]
    (transfers, cycles), *waited = [tuple(map(int, re.search(r"^bus +\S+ s: (\d+) transfers in (\d+) cycles$", out, re.M).groups())) for out in outs]
    for out, (count, took) in zip(outs[1:], waited):
        assert count == transfers and cycles + transfers < took < cycles + 6 * transfers
        assert states(out) == states(outs[0]) and counters(out) == counters(outs[0]) != []
    assert len(set(waited)) > 1                            # two seeds may have the same sum
    done = start("run", "m.ode", "--engine", "isa", "--bus-waits", "1")
    assert done.returncode == 2 and "--bus-waits: only the hardware" in done.stderr


@pytest.mark.parametrize("clock", ["", "130", "MHz", "0MHz", "-1MHz", "130mHz", "130MHzz", "0x10MHz", "infMHz", "nanGHz", "1e999Hz", "1e-320Hz"])
def test_what_is_no_frequency(start, clock):
    done = start("run", "m.ode", "--clock", clock)
    assert done.returncode == 2 and "expected a number above 0 and Hz, kHz, MHz or GHz" in done.stderr
    assert "no frequency" in done.stderr and done.stdout == ""


def test_instructions_have_no_clock(start):
    done = start("run", "m.ode", "-e", "isa", "--clock", "1MHz")
    assert done.returncode == 2 and "--clock: only the hardware" in done.stderr
    assert re.search("^simulator .* instructions/second;", start("run", "m.ode", "-e", "isa").stdout, re.M)


# ---- spread ----

def test_values_spread_as_in_a_scene(start, tmp_path):
    options = ["-c", "many_full", "-n", "7", "-e", "isa"]
    (tmp_path / "m.scene").write_text(
        'config = "many_full"; engine = "isa"; steps = 7;\n'
        'groups = ( { program = "m.ode"; objects = 5; spread : { x = [1.0, 2.0]; k = [4.0, 1.0]; }; } );\n')
    one = start("run", "m.ode", *options, "-N", "5", "--spread", "x=1:2", "--spread", "k=4:2^0")
    assert len(states(one.stdout)) == 10 and states(one.stdout) == states(start("run", "--scene", "m.scene").stdout)
    single = start("run", "m.ode", *options, "-N", "5", "--set", "x=1.25", "--set", "k=3.25").stdout
    assert states(single)[0].split()[:3] == states(one.stdout)[2].split()[:3]
    # Of --set and of --spread each, what is said last counts.
    again = start("run", "m.ode", *options, "-N", "5", "--set", "x=7", "--set", "x=1.25", "--set", "k=3.25").stdout
    assert states(again) == states(single)


@pytest.mark.parametrize("options", [["--set", "x=1", "--spread", "x=1:2"], ["--spread", "k=1:2", "--spread", "x=1:2", "--set", "x=1"]])
def test_a_value_is_set_or_spread(start, options):
    done = start("run", "m.ode", "-e", "isa", *options)
    assert done.returncode == 2 and "found both --set and --spread of 'x'" in done.stderr and not done.stdout


def test_some_values_are_set_and_others_spread(start):
    assert start("run", "m.ode", "-e", "isa", "-c", "many_full", "--set", "k=1", "--spread", "x=1:2").returncode == 0


@pytest.mark.parametrize("text, message", [
    ("x", "'x' is not name=first:last"), ("x=1", "is not name=first:last"), ("x=1:", "'' is no number"),
    ("x=:1", "'' is no number"), ("x=1:2:3", "'2:3' is no number"), ("x=1:inf", "finite"), ("x=nan:1", "finite"),
    ("h=0.1:0.2", "'h' is spread"), ("y=1:2", "no 'y'"), ("1x=1:2", "'1x' is no name")])
def test_what_cannot_be_spread(start, text, message):
    done = start("run", "m.ode", "-e", "isa", "--spread", text)
    assert done.returncode == 2 and message in done.stderr, done.stderr


# ---- progress ----

def on_terminal(command, cwd):
    """What arrives on standard output, and on a terminal that is standard error."""
    ours, theirs = pty.openpty()
    with subprocess.Popen(command, cwd=cwd, stdout=subprocess.PIPE, stderr=theirs, text=True) as started:
        os.close(theirs)
        shown, end = b"", time.monotonic() + 120
        while time.monotonic() < end:
            if not select.select([ours], [], [], 1)[0]:
                continue
            try:
                got = os.read(ours, 65536)
            except OSError:  # nobody has the other end any more
                break
            if not got:
                break
            shown += got
        out = started.stdout.read()
    os.close(ours)
    return started.returncode, out, shown.decode()


@pytest.mark.parametrize("options", [["-n", "10000"], pytest.param(["-n", "1000", "-c", "many_full", "--visit", "100"], marks=pytest.mark.long),
                                     pytest.param(["-n", "50000", "-e", "isa"], marks=pytest.mark.long)])
def test_a_long_run_says_how_far_it_is_and_is_the_same(fp3, start, tmp_path, options):
    start("run", "m.ode")
    command = [fp3, "run", "m.ode", *options]
    for _ in range(6):  # as long as it takes on this machine: it says nothing for two seconds
        begin = time.monotonic()
        code, out, shown = on_terminal(command, tmp_path)
        if shown:
            break
        command[4] = str(int(3 / (time.monotonic() - begin) * int(command[4])))
    assert code == 0 and re.search(r"\rfp3 run: running, \d+ %, [2-9] s +\r", shown)
    shares = [int(share) for share in re.findall(r"(\d+) %", shown)]
    assert shares == sorted(shares) and all(0 <= share <= 100 for share in shares)
    assert re.search(r"\r +\r$", shown)  # the line is gone
    silent = start(*command[1:])
    assert silent.stderr == "" and states(silent.stdout) == states(out) and counters(silent.stdout) == counters(out) != []


def test_who_is_quick_or_has_no_terminal_is_silent(fp3, start, tmp_path):
    start("run", "m.ode")
    code, out, shown = on_terminal([fp3, "run", "m.ode", "-e", "isa"], tmp_path)
    assert (code, shown) == (0, "") and states(out)
    assert start("compare", "m.ode", "-i", "rk4", "--most-steps", "2048").stderr == ""


def test_nothing_stands_in_what_is_typed(fp3, tmp_path):
    started = []
    for command in ("run - --model -e isa", "run -e isa --model /dev/stdin", "compile -"):
        ours, theirs = pty.openpty()
        started.append((ours, subprocess.Popen([fp3, *command.split()], cwd=tmp_path, stdin=theirs, stdout=subprocess.DEVNULL,
                                               stderr=theirs)))
        os.write(ours, b"state x = 1\n")
    time.sleep(3)
    assert [os.read(ours, 65536) for ours, _ in started] == [b"state x = 1\r\n"] * 3
    for ours, process in started:                          # the end of what is typed: each has read it, and refuses it
        os.write(ours, b"\x04")
        assert process.wait(60) == 2
        assert re.search(rb":1:7: error: found 'x', expected an equation", os.read(ours, 65536))


def test_a_warning_has_a_line_of_its_own(fp3, tmp_path):
    """Whose model arrives late, when the line is up."""
    os.mkfifo(tmp_path / "late.ode")
    late = threading.Thread(target=write_late, args=(tmp_path / "late.ode",))
    late.start()
    code, _, shown = on_terminal([fp3, "run", "late.ode", "-e", "isa", "-i", "verlet"], tmp_path)
    late.join()
    assert code == 0 and re.search(r"\rfp3 run: reading and compiling, 2 s +\r", shown)
    assert re.search(r"\r +\rfp3 run: late.ode: warning: .*\r\n$", shown)


def write_late(path):
    with open(path, "w", encoding="utf-8") as pipe:
        time.sleep(3)
        pipe.write("state x = 1\nstate v = 0\nx' = v\nv' = -x - v\nstep 0.01\n")


@pytest.mark.parametrize("command", ["compare m.ode", "bench -p ./m.ode -n 400000"])
def test_long_tables_say_that_they_go_on(fp3, start, tmp_path, command):
    start("run", "m.ode")
    with subprocess.Popen([fp3, *command.split()], cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=(ends := pty.openpty())[1]) as started:
        assert select.select([ends[0]], [], [], 60)[0], "nothing on the terminal"
        shown = os.read(ends[0], 100).decode()
        started.kill()
    assert re.match(rf"\rfp3 {command.split()[0]}: .*\d s", shown), shown


# ---- what the compiler refuses ----

ABSOLUTE = "state x = 1\nstate v = 0\nx' = v\nv' = -x - 0.1*v*abs(v)\nstep 0.01\n"


@pytest.mark.parametrize("command", [["compile"], ["run"], ["bench", "-c", "single", "-p"]])
@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_what_the_compiler_refuses_has_a_place(start, tmp_path, command, mark):
    (tmp_path / "abs.ode").write_text(mark + ABSOLUTE, encoding="utf-8")
    done = start(*command, "abs.ode", *([] if "-c" in command else ["-c", "single"]))
    assert done.returncode == 2
    assert done.stderr.startswith("abs.ode:4:17: error: ") and "needs `select`, which configuration 'single'" in done.stderr
    assert "\n    v' = -x - 0.1*v*abs(v)\n                    ^\n" in done.stderr


def test_an_integrator_that_does_not_fit_names_the_equation(start, tmp_path):
    (tmp_path / "drag.ode").write_text(ABSOLUTE)
    done = start("run", "drag.ode", "-i", "stoermer_verlet")
    assert done.returncode == 2 and re.match(r"drag\.ode:4:\d+: error: integrator 'stoermer_verlet' has no velocity", done.stderr)
    assert done.stderr.count("\n") == 3


def test_run_shows_all_errors_as_compile_does(start, tmp_path):
    (tmp_path / "bad.ode").write_text("state x = 1\nx' = y\nz = 3 + * 2\nstep 0\n")
    run, compiled = start("run", "bad.ode"), start("compile", "bad.ode")
    assert run.returncode == compiled.returncode == 2 and run.stderr == compiled.stderr
    assert len(re.findall(r"^bad\.ode:\d+:\d+: error: ", run.stderr, re.M)) >= 3


# ---- models beyond the reference ----

STIFF = "state x = 2\nstate v = 0\nx' = v\nv' = 1e6*(1 - x*x)*v - x\nstep 0.0001\nspan 10000\n"
ENDLESS = "state x = 1\nx' = 100*x^2\nstep 0.125\nspan 1.9\n"


def test_a_model_that_has_no_truth_is_compared_as_far_as_it_can_be(start, tmp_path):
    (tmp_path / "endless.ode").write_text(ENDLESS)
    done = start("compare", "endless.ode", "-i", "euler", "--json", "out.json")
    assert done.returncode == 3 and "no reference, so no measured order and no error" in done.stdout
    assert re.search(r"GSL's \w+ does not reach time \S+: it made \d+ steps and came to time \S+, ", done.stdout)
    assert re.search(r"^endless +euler +plain .* nan 0 of [1-9]\d*; failed: object 0 in step \d+: \w+$", done.stdout, re.M)
    assert '"floor": null' in (tmp_path / "out.json").read_text() and "no_reference" in (tmp_path / "out.json").read_text()


def test_a_stiff_model_that_a_method_fails_on_is_compared(start, tmp_path):
    (tmp_path / "stiff.ode").write_text(STIFF)
    done = start("compare", "stiff.ode", "-i", "euler", "--json", "out.json")
    assert done.returncode == 3 and "no reference" not in done.stdout
    assert re.search(r"^stiff +euler +plain .* inf 0 of [1-9]\d*; failed: object 0 in step \d+: \w+$", done.stdout, re.M)


def test_bench_needs_nothing_of_the_repository_for_a_model(start):
    done = start("bench", "-p", "m.ode", "-c", "single_full", "-n", "20")
    assert done.returncode == 0 and "mismatches 0" in done.stdout, done.stderr


def test_a_name_that_there_is_not_is_answered_with_those_that_there_are(start, tmp_path):
    for command in (["compile", "m.ode", "-c", "nope"], ["run", "m.ode", "-c", "nope"], ["bench", "-p", "m.ode", "-c", "nope"]):
        done = start(*command)
        assert done.returncode == 2 and re.search("no configuration 'nope': there are .*single_full", done.stderr), done.stderr
    done = start("run", "m.ode", env={"PATH": "/usr/bin", "FP3_RTL_DIR": str(tmp_path)})
    assert done.returncode == 1 and done.stderr.endswith(f"looked in {tmp_path}\n")


def test_the_hardware_is_looked_for_in_sensible_places(fp3, start, tmp_path):
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin/fp3").write_bytes(fp3.read_bytes())
    (tmp_path / "bin/fp3").chmod(0o755)
    done = subprocess.run([tmp_path / "bin/fp3", "run", "m.ode"], cwd=tmp_path, capture_output=True, text=True) if start("info") else None
    places = done.stderr.strip().split("looked in ")[1].split(", ")
    assert done.returncode == 1 and places[0] == str(tmp_path / "lib/fp3") and len(places) == len(set(places)) == 2
    assert not any(".." in place for place in places)


@pytest.mark.smoke
def test_a_letter_is_the_same_option_in_every_command(fp3):
    def says(*words):
        return subprocess.run([fp3, *words, "--help"], capture_output=True, text=True, check=True, timeout=60).stdout
    commands = re.findall(r"^  (\w+)\t", says(), re.M)
    names = {}
    for command in commands:
        for letter, name in re.findall(r"^ +-(\w), --([\w-]+)", says(command), re.M):
            names.setdefault(letter, {}).setdefault(name, []).append(command)
    assert len(names["o"]["output"]) >= 5 and "run" in names["N"]["objects"]
    assert {letter: of for letter, of in names.items() if len(of) > 1} == {}
