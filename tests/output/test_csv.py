"""What is written as CSV: names, units, numbers, times; what is refused; files that are whole or not there."""

import math
import resource
import signal
import struct

import peak
import pytest


def word(text):
    return "0x%08x" % struct.unpack("<I", struct.pack("<f", float(text)))


def single(text):
    """The float that a decimal stands for."""
    return struct.unpack("<f", struct.pack("<f", float(text)))[0]


@pytest.mark.smoke
@pytest.mark.parametrize("engine", ["isa", "rtl", "fast"])
def test_snapshots_have_the_bits_that_a_run_prints(start, engine):
    which = ("-e", engine, "-c", "many_full", "-N", "5", "--spread", "m=8e5:9e5")
    whole = start("ship.ode", *which, "-n", "9", "--every", "4")
    assert whole.header == ["step", "time [s]", "object", "v [m/s]", "s [m]"]
    assert [(row["step"], row["time"], row["object"]) for row in whole.rows] == \
        [(str(n), str(n), str(i)) for n in (0, 4, 8, 9) for i in range(5)]
    for steps in (0, 4, 8, 9):
        printed = start("ship.ode", *which, "-n", steps, output=None).printed()
        for (name, number), (value, bits) in printed.items():
            assert whole.of(steps, number)[name] == value and word(value) == bits
    assert start("ship.ode", *which, "-n", "9", "--every", "4").path.read_bytes().count(b"\r\n") == 21


def test_without_every_there_are_start_and_end(start):
    assert [row["step"] for row in start("ship.ode", "-n", "9").rows] == ["0", "9"]
    assert [row["step"] for row in start("ship.ode", "-n", "0").rows] == ["0"]
    assert [row["step"] for row in start("ship.ode", "-n", "9", "--every", "9").rows] == ["0", "9"]
    assert [row["step"] for row in start("ship.ode", "-n", "9", "--every", "100").rows] == ["0", "9"]


@pytest.mark.parametrize("engine", ["isa", "rtl"])
def test_definitions_and_invariants_are_of_the_states_in_double(start, tmp_path, engine):
    (tmp_path / "m.ode").write_text(
        "param k = 2 [kg/s^2]\nparam m = 0.5 [kg]\nshared w = 0.5 [1/s]\nstate x = 1 [m]\nstate v = 0 [m/s]\nstep 0.125 [s]\n"
        "a = -k*x/m\nshare = x*t\nx' = v\nv' = a\n"
        "invariant energy = (m*v^2 + k*x^2)/2\ninvariant phase = sin(w*t)\ninvariant pure = 1\n")
    done = start("m.ode", "-e", engine, "-c", "many_full", "-N", "3", "--spread", "k=1:4", "-n", "6", "--every", "2",
                 "--observe", "energy,x,a,v,phase,pure")
    assert done.header == ["step", "time [s]", "object", "energy [kg*m^2/s^2]", "x [m]", "a [m/s^2]", "v [m/s]", "phase [1]", "pure"]
    for row in done.rows:
        x, v, k, t = single(row["x"]), single(row["v"]), 1 + 1.5 * int(row["object"]), 0.125 * int(row["step"])
        assert float(row["energy"]) == pytest.approx((0.5 * v**2 + k * x**2) / 2, rel=1e-15)
        assert float(row["a"]) == pytest.approx(-k * x / 0.5, rel=1e-15, abs=1e-300)
        assert float(row["phase"]) == pytest.approx(math.sin(t / 2), rel=1e-15) and row["pure"] == "1"


def test_the_time_of_an_object_is_what_it_counts(start, tmp_path):
    (tmp_path / "m.ode").write_text("state x = 1\nstep 0.5\nx' = cos(t)\ninvariant late = t + 0*x\n")
    done = start("m.ode", "-e", "isa", "-c", "many_full", "-N", "3", "--spread", "steps=0:20", "-n", "4", "--every", "2",
                 "--observe", "late,steps")
    for row in done.rows:
        counted = int(row["step"]) + 10 * int(row["object"])
        assert float(row["steps"]) == counted and float(row["late"]) == 0.5 * counted
        assert float(row["time"]) == 0.5 * int(row["step"])


def test_what_updates_lose_is_observed_where_it_is_named(start):
    assert start("ship.ode", "-k", "-n", "2").names[3:] == ["v", "s"]
    done = start("ship.ode", "-k", "-n", "2", "--observe", "v_lost", "--observe", "v,s")
    assert done.names[3:] == ["v_lost", "v", "s"] and float(done.of(2)["v_lost"]) != 0


def test_the_states_of_assembly(start, root):
    values = ("--params", root / "programs/ship.cfg")
    done = start("ship_sleep.s", *values, "-c", "shared", "-N", "2", "--set", "eps=2e-3", "-n", "900", "--every", "300")
    assert done.names == ["step", "time", "object", "v", "s", "slept"]
    assert done.of(900)["slept"] == str(int(done.printed()["slept", 0][1], 16)) and int(done.of(900)["slept"]) > 1


def test_a_program_without_a_time_step_has_no_time(start, tmp_path):
    (tmp_path / "x.s").write_text(".state x\nstep: add x, x, 1.0\n")
    done = start("x.s", "--set", "x=0", "-n", "3", "--every", "1")
    assert done.header == ["step", "object", "x"] and [row["x"] for row in done.rows] == ["0", "1", "2", "3"]
    done = start("x.s", "--set", "x=0", "--times", "1", code=2)
    assert "the program has no time step h" in done.stderr and not done.path.exists()


def test_numbers_that_are_none(start, tmp_path):
    (tmp_path / "x.s").write_text(".state x y z\n.param a\nstep: mul x, x, a\n mul y, x, -1.0\n sub z, x, x\n")
    done = start("x.s", "--set", "x=1e30", "--set", "a=1e30", "--set", "y=-0.0", "--set", "z=0", "--every", "1", code=3)
    assert done.rows[0] == {"step": "0", "object": "0", "x": "1.00000002e+30", "y": "-0", "z": "0"}
    assert done.rows[1] == {"step": "1", "object": "0", "x": "inf", "y": "-inf", "z": "nan"}
    (tmp_path / "m.ode").write_text("state x = 1\nstep 1\nx' = x\ninvariant none = exp(800 + x) - exp(900 + x)\ninvariant much = exp(800*x)\n")
    assert list(start("m.ode", "--observe", "none,much").rows[0].values())[3:] == ["nan", "inf"]  # C has -nan there


# ---- times ----

@pytest.mark.parametrize("h, times, steps", [
    ("0.1", "0.1,0.3,0.7,1", (1, 3, 7, 10)), ("0.1", "0.30000000447034836", (3,)), ("2^-7", "0,1/128,3/64", (0, 1, 6)),
    ("1/3", "1/3,1,100", (1, 3, 300)), ("0.3", "0.9,1.2", (3, 4))])
def test_times_are_steps(start, h, times, steps):
    done = start("ship.ode", "-e", "isa", "--set", f"h={h}", "--times", times)
    assert [int(row["step"]) for row in done.rows] == list(steps)
    assert done.counter("object_steps") == max(steps[-1], 1) * (steps[-1] > 0)
    assert start("ship.ode", "-e", "isa", "--set", f"h={h}", "--times", times, "-n", "400").counter("object_steps") == 400


@pytest.mark.parametrize("times, message", [
    ("1.5", "time 1.5 is no multiple of h = 1: the nearest are 1 and 2"), ("3,2", "time 2 does not come after 3"),
    ("2,2", "time 2 does not come after 2"), ("-1", "time -1 is out of range"), ("1e10", "out of range"),
    ("7", "time 7 is beyond the end of the run, 6: 6 steps"), ("", "'' is no time"), ("1,", "'' is no time"),
    ("x", "'x' is no time"), ("1/0", "is no time"), ("1.0000001", "no multiple")])
def test_what_is_no_time(start, times, message):
    done = start("ship.ode", "--times", times, "-n", "6", code=2)
    assert message in done.stderr and not done.path.exists() and done.stdout == "", done.stderr


# ---- what is refused ----

@pytest.mark.parametrize("program, arguments, message", [
    ("kepler.ode", "--observe=q", "nothing to observe is called 'q': there are v_x, v_y, r_x, r_y, energy, momentum, runge_x, runge_y"),
    ("kepler.ode", "--observe=mu", "is called 'mu'"), ("kepler.ode", "--observe=v_x,v_x", "'v_x' is observed twice"),
    ("kepler.ode", "--observe=", "is called ''"), ("kepler.ode", "--observe=v_x,", "is called ''"),
    ("kepler.ode", "--every=0", "'0' is no number from 1"), ("kepler.ode", "--every=-1", "is no number"),
    ("kepler.ode", "--every=1 --times=1", "expected one of them"), ("kepler.ode", "--cycle-limit=9", "--cycle-limit: a limit applies to one run"),
    ("ship.s", "--params=SHIP --observe=energy", "there are v, s; definitions and invariants are a model's"),
    ("ship.s", "--params=SHIP --observe=T", "is called 'T'"), ("time.ode", "", "'time' cannot be observed"),
    ("late.ode", "-n 17000000 --every=1", "17000000 steps from 'steps' = 0 on")])
def test_what_is_refused(start, root, tmp_path, program, arguments, message):
    (tmp_path / "time.ode").write_text("state time = 1\nstep 1\ntime' = 1\n")
    (tmp_path / "late.ode").write_text("state x = 1\nstep 1\nx' = t\n")
    done = start(program, *arguments.replace("SHIP", str(root / "programs/ship.cfg")).split(), "-e", "isa", code=2)
    assert message in done.stderr and not done.path.exists() and done.stdout == "", done.stderr


@pytest.mark.parametrize("arguments", ["--every=1", "--times=1", "--observe=v"])
def test_somewhere_it_must_be_written(start, arguments):
    assert "expected --output FILE" in start("ship.ode", arguments, output=None, code=2).stderr


def test_a_scene_of_several_groups_is_refused(start, root):
    done = start("--scene", root / "programs/mixed.scene", code=2)
    assert "mixed.scene:13: --output, --plot: the scene has 2 groups, and a recording" in done.stderr


# ---- files ----

def test_an_input_is_not_overwritten(start, tmp_path, root):
    text = (root / "programs/ship.ode").read_text()
    (tmp_path / "m.ode").write_text(text)
    assert "--output m.ode would overwrite PROGRAM m.ode" in start("m.ode", output="m.ode", code=2).stderr
    assert "are one file" in start("m.ode", "--bus-log", "x", output="./x", code=2).stderr
    assert "cannot write" in start("m.ode", output="nowhere/x.csv", code=2).stderr
    assert (tmp_path / "m.ode").read_text() == text and sorted(p.name for p in tmp_path.iterdir()) == ["m.ode"]


def test_standard_output_has_data_alone(start):
    done = start("ship.ode", "-n", "2", output="-")
    assert done.stdout.splitlines()[0] == "step,time [s],object,v [m/s],s [m]" and len(done.stdout.splitlines()) == 3
    assert "object_steps" in done.stderr


def test_a_full_disk_is_told(start):
    done = start("ship.ode", "-e", "isa", "-n", "30000", "--every", "1", output="/dev/full", code=1)
    assert "/dev/full: cannot write: No space left on device" in done.stderr

    def small():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (100000, 100000))
    for every in ("1", "400"):   # at a row, and when all is flushed
        done = start("ship.ode", "-c", "many_full", "-e", "isa", "-N", "16", "-n", "400" if every != "1" else "2000", "--every", every,
                     preexec_fn=small, code=1 if every == "1" else 0)
        assert ("out.csv: cannot write: File too large" in done.stderr) == (every == "1")
        assert done.path.exists() == (every != "1") and not list(done.path.parent.glob(".fp3-*"))


def test_the_file_of_before_stays_until_the_new_one_is_whole(killed_while_it_writes, tmp_path):
    (tmp_path / "out.csv").write_text("before")
    killed_while_it_writes("out.csv")
    assert (tmp_path / "out.csv").read_text() == "before"


def test_memory_does_not_grow_with_the_snapshots(fp3, root, tmp_path):
    def most(steps):
        done, taken = peak.run([fp3, "run", root / "programs/ship.ode", "-e", "isa", "-n", steps, "--every", "1", "--output", "out.csv"], cwd=tmp_path)
        assert done.returncode == 0 and (tmp_path / "out.csv").read_bytes().count(b"\n") == steps + 2, done.stderr
        return taken
    assert most(100000) < most(10) + 2e6
