"""Adaptive steps: each object has its own time, on every engine the same bits; right to the tolerance, or refused by name."""
import json
import math
import os
import pathlib
import re

import pytest
from runs import fp3, number
from tables import has_estimate, read

# Kepler, from the pericentre; after whole periods of 2 pi a^(3/2) it is there again.
PLANET = """param e = 0.5
state v[2] = (0, sqrt(3))
state r[2] = (0.5, 0)
v' = -r/norm(r)^3
r' = v
step 0.015625
span 6.283185307179586
"""
ROBERTSON = pathlib.Path(__file__).parents[2] / "programs/robertson.ode"
PAIRS = {"cash_karp": 6e-3, "dopri5": 6e-3, "tsit5": 6e-3, "rk8": 6e-3, "ralston3": 2e-2, "heun": 4e-2}
DECAY = """param rate = 1
state y = 1
state c = 0
y' = -rate*y + cos(t)
c' = cos(t)
step 0.01
span 4
"""


def ends(out):
    """Numbers that a run ends with, by object and name."""
    found = {}
    for name, bits, low, n in re.findall(r"^(\w+) +\S+ +(0x[0-9a-f]{8})( 0x[0-9a-f]{8})? +object (\d+)$", out, re.M):
        found.setdefault(int(n), {})[name] = bits
        if low:
            found[int(n)][name + "_low"] = low.strip()
    return found


def run(path, *arguments, config="single_full", engine="isa", status=0):
    done = fp3("run", path, "-e", engine, "-c", config, "--all", *arguments, status=status)
    return ends(done.stdout), done


def value(of, name, n=0):
    return number(of[n][name])


# The objects end at different times, after different numbers of attempts: nobody waits for anybody.
SPREAD = ["--tolerance", "1e-4", "--spread", "until=0:5", "-N", "7"]


@pytest.mark.parametrize("arithmetic", [[], ["-k"]])
def test_engines_and_machines_agree(written, arithmetic):
    path = written(PLANET)
    seen = [run(path, *SPREAD, *arithmetic, config="many_full", engine=e)[0] for e in ("isa", "rtl", "fast")]
    assert seen[0] == seen[1] == seen[2] and len(seen[0]) == 7
    assert value(seen[0], "t", 0) == 0 and value(seen[0], "accepted", 0) == 0, "an end at the start"
    assert len({value(seen[0], "accepted", n) for n in range(7)}) > 3
    for n in (2, 6):
        alone = [run(path, "--tolerance", "1e-4", "--set", f"until={5 * n / 6!r}", *arithmetic, engine=e)[0][0]
                 for e in ("isa", "rtl", "fast")]
        of_many = {name: bits for name, bits in seen[0][n].items() if name != "slept"}
        assert alone[0] == alone[1] == alone[2] == of_many


def test_visits_change_nothing(written):
    path = written(PLANET)
    whole, short = (run(path, *SPREAD, *visit, config="many_full")[0] for visit in ([], ["--visit", "3"]))
    assert whole == short


def test_sleepers_cost_nothing(written):
    """A run ends when the last object does, and what it costs is what objects do until their ends."""
    path = written(PLANET)
    of, done = run(path, *SPREAD, config="many_full")
    attempts = sum(value(of, "accepted", n) + value(of, "rejected", n) for n in range(1, 7)) + 1
    assert int(re.search(r"^object_steps +(\d+)", done.stdout, re.M)[1]) == attempts


@pytest.mark.parametrize("name", PAIRS)
def test_error_follows_tolerance(written, name):
    path = written(PLANET)
    errors = []
    for tolerance in (1e-3, 1e-4, 1e-5):
        of, _ = run(path, "-i", name, "--tolerance", tolerance)
        at = [value(of, x) for x in ("v_x", "v_y", "r_x", "r_y")]
        errors.append(math.dist(at, (0, math.sqrt(3), 0.5, 0)))
        assert value(of, "t") == pytest.approx(2 * math.pi, rel=1e-7)
    assert errors[0] > errors[1] > errors[2] and errors[0] > 10 * errors[2]
    assert errors[2] < PAIRS[name]


TABLES = pathlib.Path(__file__).parents[2] / "programs/integrators"
ESTIMATED = sorted(path.stem for path in TABLES.glob("*.cfg") if has_estimate(read(path)))
LINEAR = {"decay": ("state x = 1\nx' = -x\nstep 1\n", math.exp(-4)), "swing": ("state x = 1\nstate v = 0\nx' = v\nv' = -x\nstep 1\n", math.cos(4))}


@pytest.mark.parametrize("name", ESTIMATED)
@pytest.mark.parametrize("text, end", LINEAR.values(), ids=LINEAR)
def test_linear_equations_end_within_a_small_multiple_of_the_tolerance(written, name, text, end):
    """An estimate that is 0 on them, whatever the step or at one step alone, would accept anything. h = 1, 1/4 and 8 are what people begin with."""
    path = written(text)
    for tolerance in (1e-2, 1e-4):
        for first in (0.01, 0.25, 1, 8):
            of, _ = run(path, "-i", name, "--tolerance", tolerance, "--until", 4, "--set", f"h_next={first}", "-N", 1, config="many_full")
            error = abs(value(of, "x") - end)
            assert error < 16 * tolerance and error < tolerance * value(of, "accepted") / 2, (tolerance, first)


def test_time_is_that_of_the_object(written):
    """c' = cos(t) is right only if every stage of every attempt has its own t."""
    of, _ = run(written(DECAY), "--tolerance", "1e-6", "--spread", "until=1:9", "-N", "5", config="many_full")
    for n in range(5):
        t = value(of, "t", n)
        assert t == 1 + 2 * n
        assert value(of, "c", n) == pytest.approx(math.sin(t), abs=2e-6)
        assert value(of, "y", n) == pytest.approx((math.cos(t) + math.sin(t) + math.exp(-t)) / 2, abs=3e-6)


def test_end_is_exact_and_steps_are_counted(written):
    of, done = run(written(DECAY), "--tolerance", "1e-5", "--until", "3.3")
    assert of[0]["t"] == "0x40533333"
    accepted, rejected = value(of, "accepted"), value(of, "rejected")
    assert re.search(rf"^accepted +{accepted:.0f}$", done.stdout, re.M)
    assert re.search(rf"^rejected +{rejected:.0f}$", done.stdout, re.M)
    assert 0 < value(of, "smallest") <= value(of, "largest") < 3.3


def test_a_first_step_that_is_no_good(written):
    """Too long or too short: what the first step is does not matter but for the attempts that it takes."""
    path = written(PLANET)
    for first in ("1e3", "1e-6", "3e38"):
        of, _ = run(path, "--tolerance", "1e-5", "--set", f"h_next={first}")
        assert math.dist([value(of, x) for x in ("r_x", "r_y")], (0.5, 0)) < 4e-3


def test_overflow_in_a_stage_is_a_rejected_step(written):
    path = written("state y = 1\ny' = -y*y*y*y*y*y*y*y*y\nstep 1e9\nspan 4")
    of, done = run(path, "--tolerance", "1e-4")
    assert "overflow" in done.stdout, "some stage is beyond FP32"
    assert value(of, "y") == pytest.approx((1 + 8 * 4) ** (-1 / 8), rel=1e-3)


def time_of(of, n=0):
    return value(of, "t", n) + value(of, "t_low", n)


def each_engine(path, *arguments, config="single_full", status=0):
    """The ends of a run that are the same on both machines of one object, and on all three of many."""
    engines = ("isa", "rtl") if config == "single_full" else ("isa", "rtl", "fast")
    seen = [run(path, *arguments, config=config, engine=e, status=status)[0] for e in engines]
    assert all(one == seen[0] for one in seen)
    return seen[0]


def test_time_holds_what_a_short_step_adds(written):
    """Without an error each step is 5 times the one before. Of ten none but the last ones would change t = 1000 at all."""
    path = written("state y = 1\ny' = 0*y\nstep 1\nspan 1\n")
    h = 2**-22 * 1.25
    of = each_engine(path, "--tolerance", "1e-5", "--set", "t=1000", "--set", f"h_next={h!r}", "--until", "3000", "--steps", "10",
                     "--allow-failures")
    assert value(of, "accepted") == 10
    assert abs(time_of(of) - 1000 - sum(h * 5**n for n in range(10))) <= 10 * 1000 * 2**-49
    assert value(of, "t_low") != 0


@pytest.mark.parametrize("start, span", [(2**30, 256), (-2**24 - 2, 2), (0, 2**-110)])
def test_steps_are_as_short_as_they_must_be_anywhere(written, start, span):
    """y = 3 e^-((t - start) 8/span): all of that is next to one last place of t, or t is almost 0."""
    path = written(f"param rate = {8 / span!r}\nstate y = 3\ny' = -rate*y\nstep {span / 64!r}\nspan 1\n")
    times = ["--set", f"t={start}", "--set", f"until={start + span}", "--tolerance", "1e-5"]
    alone = each_engine(path, *times)[0]
    many = each_engine(path, *times, "--spread", f"rate={8 / span!r}:{4 / span!r}", "-N", "2", config="many_full")
    assert {name: many[0][name] for name in alone} == alone
    for n, factor in enumerate((8, 4)):
        assert value(many, "t", n) == start + span and value(many, "t_low", n) == 0
        assert value(many, "y", n) == pytest.approx(3 * math.exp(-factor), rel=2e-3)
        assert value(many, "accepted", n) > 5


def test_time_goes_through_zero(written):
    of = each_engine(written(DECAY), "--tolerance", "1e-5", "--set", "t=-5", "--until", "3")
    assert (time_of(of), value(of, "c")) == (3, pytest.approx(math.sin(3) + math.sin(5), abs=2e-5))


def test_the_start_has_two_words(written):
    of = each_engine(written(DECAY), "--tolerance", "1e-5", "--set", "t=0.1", "--until", "3", "--steps", "1", "--allow-failures", "--set", "h_next=2^-40")
    assert time_of(of) == pytest.approx(0.1 + 2**-40, abs=1e-16)


@pytest.mark.parametrize("first, moves", [("2^-126", True), ("2^-130", False)])
def test_the_shortest_step_is_normal(written, first, moves):
    """A subnormal one counts as none: the object has failed where it is."""
    path = written("state y = 1\ny' = -y\nstep 1\nspan 1\n")
    for config in ("single_full", "many_full"):
        of, _ = run(path, "--tolerance", "1e-4", "--set", f"h_next={first}", "-N", "1", config=config, status=0 if moves else 3)
        assert (value(of, "t"), value(of, "accepted") > 50) == ((1, True) if moves else (0, False))


@pytest.mark.parametrize("integrator, most", [("cash_karp", 1.66), ("dopri5", 1.66)])
def test_an_attempt_costs_little_more_than_a_fixed_step(integrator, most):
    """What surrounds the method, beside the shortest right-hand side there is."""
    path = os.path.join(os.path.dirname(__file__), "adaptive", "van_der_pol_10.ode")
    count = [int(re.search(r"^instructions +(\d+)", fp3("compile", path, "-i", integrator, "-c", "many_full", "--report", *options).stdout, re.M)[1])
             for options in (["--tolerance", "1e-5"], [])]
    assert count[0] < most * count[1]


def test_blow_up_is_named(written):
    """y' = y^2 is infinite at t = 1: no step gets there."""
    path = written("param k = 1\nstate y = 1\ny' = k*y*y\nstep 0.01\nspan 2")
    for engine, config, spread in (("isa", "single_full", []), ("rtl", "many_full", ["--spread", "k=0:1", "-N", "3"]),
                                   ("fast", "many_full", ["--spread", "k=0:1", "-N", "3"])):
        _, done = run(path, "--tolerance", "1e-4", *spread, config=config, engine=engine, status=3)
        said = re.search(r"object (\d) at t = (\S+) of 2, after \d+ steps and \d+ rejected attempts: (.*?);", done.stderr)
        assert said, done.stderr
        assert said[1] == ("2" if spread else "0")
        assert float(said[2]) == pytest.approx(1, abs=1e-3)
        assert re.search("too short to change t|not finite", said[3])


@pytest.mark.parametrize("options", [["-i", "cash_karp", "--tolerance", "1e-3"], ["-i", "dopri5", "--tolerance", "5e-5"]])
def test_who_is_stuck_stays_stuck(options):
    """Where an object cannot sleep it goes on making attempts that are none: they change nothing, not even the next step."""
    seen = [run(ROBERTSON, *options, "-N", "1", config=config, status=3)[0][0] for config in ("single_full", "many_full")]
    seen[1].pop("slept")
    assert seen[0] == seen[1] and number(seen[0]["accepted"]) > 50


def test_no_attempt_left(written):
    _, done = run(written(PLANET), "--tolerance", "1e-5", "--steps", "10", status=3)
    assert re.search(r"object 0 at t = [\d.]+ of 6.28\d+, after 10 steps and 0 rejected attempts: no attempt is left", done.stderr)


def test_events_are_found_to_their_tolerance(written):
    """A ball that falls 1 m bounces at sqrt(2/g), up to `locate` late."""
    path = written("state x = 1\nstate v = 0\nx' = v\nv' = -9.75\nwhen x < 0 and v < 0: x = -x, v = -v\nstep 0.01\nspan 1")
    first = math.sqrt(2 / 9.75)
    for locate in (1e-3, 1e-5):
        of, _ = run(path, "--tolerance", "1e-6", "--set", f"locate={locate}", "--until", "0.6")
        speed = 9.75 * first
        after = 0.6 - first
        assert value(of, "x") == pytest.approx(speed * after - 9.75 / 2 * after * after, abs=2 * speed * locate + 1e-6)
        assert value(of, "h_next") > 0.05  # an event says nothing about the steps after it


SHOTS = ["--tolerance", "1e-5", "--times", "0,0.1,3.3,4", "--output", "-", "--observe", "t,y,c,late,accepted"]


def shots(path, config, engine, *options):
    text = fp3("run", path, "-e", engine, "-c", config, *SHOTS, *options).stdout
    return [row.split(",") for row in text.splitlines()[1:]]


def test_snapshots_are_at_their_times(written):
    """Each object is at just this time, or at its own end; what the times cut off does not shorten later steps."""
    path = written(DECAY + "invariant late = c - sin(t)\n")
    many = ["-N", "3", "--spread", "until=2:4"]
    rows = shots(path, "many_full", "isa", *many)
    assert rows == shots(path, "many_full", "rtl", *many) == shots(path, "many_full", "fast", *many)
    assert [float(row[1]) for row in rows[::3]] == [0, 0.10000000149011612, 3.299999952316284, 4]
    for number, time, n, t, y, c, late, accepted in rows:
        until = (2, 3, 4)[int(n)]
        assert float(t) == pytest.approx(min(float(time), until), rel=1e-8)
        assert float(c) == pytest.approx(math.sin(float(t)), abs=2e-5)
        assert float(late) == pytest.approx(float(c) - math.sin(float(t)), abs=1e-8), "t of the object"
    alone = shots(path, "single_full", "rtl")
    assert [row[3:] for row in alone] == [row[3:] for row in rows[2::3]]
    whole, _ = run(path, "--tolerance", "1e-5")
    assert float(alone[-1][-1]) <= value(whole, "accepted") + 4


def test_compare_holds_every_word_against_the_equations(written, tmp_path):
    """Engines and equations, and the fixed steps that are as good: on this orbit they are many more."""
    path = written(PLANET.replace("sqrt(3)", "sqrt(19)").replace("0.5", "0.1").replace("0.015625", "1e-3"))
    out = tmp_path / "rows.json"
    fp3("compare", path, "--tolerance", "1e-5", "-i", "dopri5", "-i", "rk4", "--most-steps", "2048", "--json", out)
    rows = json.loads(out.read_text())["rows"]
    assert {(row["arithmetic"], row["tolerance"]) for row in rows} == {(a, t) for a in ("plain", "compensated") for t in (1e-5,)}
    for row in rows:
        assert row["mismatches"] == 0 and row["compared"] == 3 * (1 + 24) * 11
        assert row["error"] < 0.5 and row["accepted"] > 3 * row["rejected"]
        for machine in ("single_full", "many_full"):
            assert row[machine + "_fixed"]["error"] <= row["error"]
            assert row[machine + "_fixed"]["ratio"] > 4


@pytest.mark.parametrize("options, message", [
    (["--tolerance", "0"], "--tolerance: found '0', expected a number above 0"),
    (["--tolerance", "-1e-3"], "--tolerance: found '-1e-3', expected a number above 0"),
    (["--tolerance", "1e-8"], "'tolerance' is 1e-08: expected a number from 1.19e-07"),
    (["--tolerance", "1e-9", "-k"], "'tolerance' is 1e-09: expected a number from 7.45e-09"),
    (["--tolerance", "2"], "'tolerance' is 2: expected a number"),
    (["--tolerance", "1e-5", "--set", "absolute=0"], "'absolute' is 0: expected a finite number from 7.89e-31 on"),
    (["--tolerance", "1e-5", "--until", "0"], "--until: found '0', expected a number above 0"),
    (["--tolerance", "1e-5", "--set", "until=-1"], "'until' is -1: expected a finite time that does not come before t, 0"),
    (["--tolerance", "1e-5", "--set", "h_next=0"], "'h_next' is 0: expected a finite number above 0"),
    (["--tolerance", "1e-5", "--set", "h=0.1"], "the program has no 'h'"),
    (["--tolerance", "1e-5", "-i", "rk4"], "integrator 'rk4' has none"),
    (["--tolerance", "1e-5", "--output", "x.csv"], "--tolerance: objects have no step in common; expected --times"),
    (["--tolerance", "1e-5", "--output", "x.csv", "--times", "1,1"], "time 1 does not come after 1 in FP32"),
    (["--tolerance", "1e-5", "--output", "x.csv", "--times", "-1"], "time -1 is before the start of object 0, 0"),
    (["--tolerance", "1e-5", "--output", "x.csv", "--times", "1e39"], "until is 1e+39: expected a number below 3.4028236e38"),
    (["--tolerance", "1e-5", "--cycle-limit", "99"], "--cycle-limit: a limit applies to one run"),
    (["--tolerance", "1e-5", "-c", "lanes"], "adaptive steps need `sleep`, which configuration 'lanes' does not have"),
])
def test_refused(written, options, message):
    done = fp3("run", written(PLANET), "-e", "isa", *options, status=2)
    assert message in done.stderr


def test_names_of_the_model(written):
    path = written("param until = 3\nstate y = 1\ny' = -until*y\nstep 0.1\n")
    done = fp3("run", path, "-e", "isa", "--tolerance", "1e-4", status=2)
    assert "adaptive steps add a 'until' of their own: found one in the model" in done.stderr


@pytest.mark.parametrize("row, message", [
    ("embedded = (1, 0, 0); embedded_order = 1;", "embedded: found the length 3, expected 2"),
    ("embedded = (1, 1); embedded_order = 1;", "embedded: found the sum 2, expected 1"),
    ('embedded = ("1/2", "1/2"); embedded_order = 1;', "embedded: found 0 as the error of y' = a y, whatever the step"),
    ("embedded = 1; embedded_order = 1;", "embedded: found"),
    ("embedded = (1, 0);", "found no 'embedded_order', expected one"),
    ("embedded_order = 1;", "found no 'embedded', expected one"),
    ("embedded = (1, 0); embedded_order = 0;", "embedded_order: found '0', expected an integer from 1 to 8"),
    ("embedded = (1, 0); embedded_order = 2;", "embedded_order 2 claimed: the weights have order 1"),
    ("embedded = (1, 0); embedded_order = 1; late_position = true;", "a late position has no error estimate"),
])
def test_tables(written, tmp_path, row, message):
    table = tmp_path / "mine.cfg"
    table.write_text('name = "mine"; doc = "d"; source = "s"; kind = "runge-kutta"; order = 2;\n'
                     f'A = ((), (1)); b = ("1/2", "1/2");\n{row}\n')
    done = fp3("run", written(PLANET), "-e", "isa", "--tolerance", "1e-4", "-i", table, status=2)
    assert message in done.stderr


@pytest.mark.parametrize("wall", [0.05, 0.3, 0.5, 0.9, 0.99])
@pytest.mark.parametrize("integrator", ["cash_karp", "dopri5", "tsit5", "heun"])
def test_no_step_passes_over_an_event_and_back(written, integrator, wall):
    """Behind a wall for a part of a period, which a step may be longer than: what tells is that the speed has changed its sign."""
    path = written("param wall = 0.5\nparam e = 0.9\nstate x = 0\nstate v = 1\nstate n = 0\nstep 0.01\nspan 20\nx' = v\nv' = -x\nn' = 0\n"
                 "when x > wall and v > 0: v = -e*v, n = n + 1\n")
    amplitude, bounces, t = 1.0, 0, math.asin(wall)
    while t < 20 and amplitude > wall:  # back at the wall after the time on its other side
        bounces += 1
        amplitude = math.hypot(wall, 0.9*math.sqrt(amplitude**2 - wall**2))
        t += 2*math.pi - 2*math.acos(wall/amplitude) if amplitude > wall else math.inf
    for tolerance in ("1e-2", "1e-3", "1e-4"):
        of, _ = run(path, "-i", integrator, "--tolerance", tolerance, "--set", f"wall={wall}", "--set", "absolute=1e-4", "--set", "locate=1e-3",
                    engine="fast")
        assert value(of, "n") == bounces, tolerance


def test_a_derivative_that_is_no_number_is_told(written):
    _, done = run(written("state x = 0\nstate y = 0\nstep 0.5\nspan 6\nx' = y/x\ny' = 0\n"), "--tolerance", "1e-4", status=3)
    assert "or it has no derivative there: an operation gave no number (0/0, a root below 0)" in done.stderr
    _, done = run(written("state y = 1\ny' = y*y\nstep 0.01\nspan 2"), "--tolerance", "1e-4", status=3)
    assert "0/0" not in done.stderr


def test_states_too_small_for_their_tolerance_are_told(tmp_path):
    """An oscillator of 1e-9: what `absolute` leaves free is 100,000 times its states."""
    path = tmp_path / "tiny.ode"
    path.write_text("state x = 1e-9\nstate v = 0\nx' = v\nv' = -x\nstep 0.03125\nspan 16\n")
    run = ("run", path, "--tolerance", "1e-4", "-c", "many_full", "-N", 1, "-e", "isa")
    assert "warning: no state starts above 1e-09" in fp3(*run).stderr
    assert "warning" not in fp3(*run, "--set", "absolute=1e-13").stderr
    assert "warning" not in fp3(*run, "--set", "x=1").stderr
    (tmp_path / "t.scene").write_text('config = "many_full"; engine = "isa";\ngroups = ( { program = "tiny.ode"; objects = 1; tolerance = 1e-4; until = 16.0; } );\n')
    assert "tiny.ode: warning: no state starts above 1e-09" in fp3("run", "--scene", tmp_path / "t.scene").stderr
