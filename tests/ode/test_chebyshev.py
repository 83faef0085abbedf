"""Stabilised explicit methods: steps that usual explicit methods cannot take, on more states than implicit ones take; roundings."""
import math
import os
import re
import struct

import pytest
from runs import fp3, number
from tables import chebyshev_step
from test_stiff import cycles, model, rows, states  # noqa: F401

FOLDER = os.path.dirname(os.path.abspath(__file__))
LADDER, FRONT = os.path.join(FOLDER, "../../programs/rc_ladder.ode"), os.path.join(FOLDER, "large/front.ode")
ONE = ("-c", "many_full", "-e", "isa", "-N", 1)


@pytest.fixture
def table(tmp_path):
    def write(stages, damping="2/13"):
        path = tmp_path / f"s{stages}.cfg"
        path.write_text(f'name = "s{stages}"; doc = "d"; source = "s"; kind = "chebyshev"; order = 2; stages = {stages}; damping = "{damping}";\n')
        return path

    return write


def ladder(t):
    """Its voltages, by its modes."""
    u = [5.0] * 8
    for k in range(1, 9):
        angle = (2 * k - 1) * math.pi / 17
        mode = [math.sin(i * angle) for i in range(1, 9)]
        weight = 5 * sum(mode) / sum(a * a for a in mode) * math.exp(-4000 * math.sin(angle / 2) ** 2 * t)
        u = [a - weight * b for a, b in zip(u, mode)]
    return {f"u_{i + 1}": a for i, a in enumerate(u)}


def front(steps=2000):
    """At t = 1, by the classic method with short steps, in double."""
    def f(c):
        padded = [1.0, *c, 0.0]
        return [100 * (a - 2 * b + d) + 4 * b * (1 - b) for a, b, d in zip(padded, padded[1:], padded[2:])]

    c, h = [round(1 - i / 21, 3) for i in range(1, 21)], 1 / steps
    for _ in range(steps):
        k1 = f(c)
        k2 = f([a + h / 2 * k for a, k in zip(c, k1)])
        k3 = f([a + h / 2 * k for a, k in zip(c, k2)])
        k4 = f([a + h * k for a, k in zip(c, k3)])
        c = [a + h / 6 * (p + 2 * q + 2 * r + s) for a, p, q, r, s in zip(c, k1, k2, k3, k4)]
    return {f"c_{i + 1}": a for i, a in enumerate(c)}


def run(path, integrator, span, steps, *more):
    out = fp3("run", path, "-i", integrator, *ONE, "--set", f"h={span/steps!r}", "--steps", steps, *more).stdout
    return states(out), cycles(out)


def off(got, truth):
    return max(abs(got[name] - truth[name]) for name in truth)


def is_lost(got):
    return any(abs(x) > 1e10 or math.isnan(x) for x in got.values())


def test_the_ladder_takes_steps_that_rk4_cannot(table):
    """It begins with a jump, which damping 2/13 leaves in all modes. 178 steps are the fewest of rk4 that do not grow."""
    truth = ladder(0.125)
    got, price = run(LADDER, "rkc6_damped", 0.125, 28)
    assert off(got, truth) < 1e-3
    assert off(run(LADDER, "rkc8", 0.125, 28)[0], truth) > 0.01
    assert is_lost(run(LADDER, "rk4", 0.125, 28, "--allow-failures")[0])
    edge, of_edge = run(LADDER, "rk4", 0.125, 178)
    assert off(edge, truth) < 1e-4 and price < 0.4 * of_edge


def test_a_front_of_twenty_states():
    truth = front()
    got, price = run(FRONT, "rkc6_damped", 1, 20)
    assert off(got, truth) < 2e-4
    implicit, of_implicit = run(FRONT, "ros3p", 1, 20)
    assert off(implicit, truth) < 3e-5 and of_implicit < price
    assert is_lost(run(FRONT, "rk4", 1, 20, "--allow-failures")[0])
    edge, of_edge = run(FRONT, "rk4", 1, 144)
    assert off(edge, truth) < 1e-5 and price < 0.3 * of_edge


def test_adaptive_steps_go_beyond_the_limit_of_others():
    out = fp3("run", LADDER, "-i", "rkc8", *ONE, "--tolerance", "1e-3").stdout
    got = states(out)
    assert off(got, ladder(0.125)) < 3e-3 and got["largest"] > 2 * 2.785 / 3966
    other = cycles(fp3("run", LADDER, "-i", "dopri5", *ONE, "--tolerance", "1e-3").stdout)
    assert cycles(out) < 0.6 * other


DRIVEN = "state x = 1\nstate y = 0.5\nx' = -20*(x - t*t) + y\ny' = x - y^3 + t\nstep 0.0625\nspan 1\n"
BALL = "state x = 1\nstate v = 0\nx' = v\nv' = -9.81 - 0.1*v\nwhen x < 0 and v < 0: v = -0.8*v\nstep 0.0625\nspan 1\n"


@pytest.mark.smoke
@pytest.mark.parametrize("stages", [3, 7])
def test_the_order_holds_with_t_in_every_arithmetic(model, table, tmp_path, stages):  # noqa: F811
    made = rows(tmp_path, model(DRIVEN), "-i", table(stages), "--most-steps", 128)
    assert {row["arithmetic"] for row in made} == {"plain", "compensated"} | ({"double_single"} if stages == 3 else set())  # its words
    for row in made:
        assert row["mismatches"] == 0 and row["compared"] > 0
        assert row["order"] == 2 and row["method_order"] == pytest.approx(2, abs=0.25)
        assert all(row[machine]["predicted"] == row[machine]["measured"] for machine in ("many_full", "single_full", "sixteen"))


def test_events(model, table, tmp_path):  # noqa: F811
    path = model(BALL)
    made = rows(tmp_path, path, "-i", table(5), "--most-steps", 64, "--quick", "--arithmetic", "compensated")
    assert len(made) == 1 and made[0]["order"] == 1
    adaptive = [states(fp3("run", path, "-i", table(5), "--tolerance", "1e-4", "-c", "many_full", "-N", 2, "-e", e).stdout) for e in ("isa", "rtl", "fast")]
    exact = states(fp3("run", path, "-i", "rk4", *ONE, "--set", f"h={2.0**-14!r}", "--steps", 2**14).stdout)
    assert adaptive[0] == adaptive[1] == adaptive[2]
    assert abs(adaptive[0]["x"] - exact["x"]) < 2e-3


def test_folding_changes_nothing(model, table):  # noqa: F811
    """slope h is one number anyway."""
    plain, folded = (fp3("compile", model(DRIVEN), "-i", table(6), "--with", name).stdout for name in ("common", "fold-step"))
    assert plain.split("\n\n", 1)[1] == folded.split("\n\n", 1)[1] and plain.count("madd") > 20  # behind the title


def spread(first, last, objects):
    """The values that --spread gives."""
    return [struct.unpack("<f", struct.pack("<f", first + (last - first) * i / (objects - 1)))[0] for i in range(objects)]


def one_step(path, integrator, objects, *spreads):
    """What each state of each object is."""
    csv = path.parent / "one.csv"
    fp3("run", path, "-i", integrator, "-c", "many_full", "-e", "isa", "-N", objects, "--steps", 1, "--output", csv, *spreads)
    head, *lines = csv.read_text().split()
    ends = [line.split(",") for line in lines if line.startswith("1,")]
    assert len(ends) == objects
    return {name: [float(line[i]) for line in ends] for i, name in enumerate(head.split(","))}


@pytest.mark.parametrize("stages", [4, 12, 20])
def test_roundings_do_not_grow_with_the_stages_where_nothing_is_fast(model, table, stages):  # noqa: F811
    """In units of 2^-24 an increment from 0 to h p, of itself, and what a slow decay leaves of 1; 200 objects each."""
    path = model("param p = 1\nparam q = 1\nstate z = 1\nstate x = 0\nstate y = 1\nz' = z - z\nx' = p*z\ny' = -q*y\nstep 0.7\n")
    made = one_step(path, table(stages), 200, "--spread", "p=0.5:1.5", "--spread", "q=0:2")
    h = number(f"{0x3f333333:08x}")
    assert all(abs(x / (h * p) - 1) < 8 * 2**-24 for p, x in zip(spread(0.5, 1.5, 200), made["x"]))
    t = {"stages": stages, "damping": 2 / 13}
    for q, y in zip(spread(0, 2, 200), made["y"]):
        assert abs(y - chebyshev_step(t, lambda u: [-q * u[0]], [1.0], h)[0]) < 6 * 2**-24


@pytest.mark.parametrize("stages", [4, 12, 20])
def test_what_is_fast_is_off_by_few_units_of_the_state(model, table, stages):  # noqa: F811
    path = model("param q = 1\nstate y = 1\ny' = -q*y\nstep 1\n")
    limit = 0.65 * (stages**2 - 1)
    made = one_step(path, table(stages), 500, "--spread", f"q=0:{limit}")
    t = {"stages": stages, "damping": 2 / 13}
    worst = max(abs(y - chebyshev_step(t, lambda u: [-q * u[0]], [1.0], 1.0)[0]) for q, y in zip(spread(0, limit, 500), made["y"]))
    assert worst < 128 * 2**-24


def test_the_estimate_is_that_of_the_paper(model, table):  # noqa: F811
    """One attempt from 1 with h = 0.5, whose error may be twice the tolerance: accepted just above, rejected just below."""
    path = model("state y = 1\ny' = -y\nstep 0.5\nspan 1\n")
    end, = chebyshev_step({"stages": 5, "damping": 2 / 13}, lambda u: [-u[0]], [1.0], 0.5)
    estimate = abs(0.8 * (1 - end) + 0.4 * 0.5 * (-1 - end))
    for factor, accepted in ((1.01, 1), (0.99, 0)):
        out = fp3("run", path, "-i", table(5), *ONE, "--tolerance", repr(estimate / 2 * factor), "--steps", 1, "--allow-failures").stdout
        assert (states(out)["accepted"], states(out)["rejected"]) == (accepted, 1 - accepted)


def test_adaptive_words_are_those_of_the_equations(model, table, tmp_path):  # noqa: F811
    for row in rows(tmp_path, model(DRIVEN), "-i", table(4), "--tolerance", "1e-3", "--quick"):
        assert row["mismatches"] == 0 and row["compared"] > 0


def test_a_slope_that_the_host_knows(model, table):  # noqa: F811
    """Its formula would double with each stage."""
    path = model("param p = 0.3\nstate x = 1\nx' = p\nstep 0.5\n")
    for more in ([], ["--tolerance", "1e-3", "--until", "2"]):
        out = fp3("run", path, "-i", table(20), *ONE, *(more or ["--steps", "4"])).stdout
        assert states(out)["x"] == pytest.approx(1.6, rel=2e-7)
    fp3("compile", path, "-i", table(20), "-o", path.parent / "x.s", "--params", path.parent / "x.cfg")
    assert "these values alone" not in (path.parent / "x.cfg").read_text(), "a formula that is too long is none"
