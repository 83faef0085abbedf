"""The models in programs/, and where they really are: closed forms, invariants, published values."""

import cmath
import math
import re
import subprocess

import pytest
from tables import kepler

pytestmark = pytest.mark.smoke
NAMES = ["arenstorf", "bouncing_ball", "double_pendulum", "double_spring", "duffing", "elastic_pendulum",
         "fitzhugh_nagumo", "kepler", "lorenz", "lotka_volterra", "oscillator", "pendulum", "projectile", "rc_ladder",
         "rigid_body", "robertson", "roessler", "ship", "ship_drag", "sir", "thermostat", "three_body", "van_der_pol",
         "van_der_pol_stiff"]
EVENTS = ["bouncing_ball", "thermostat"]  # no way back
CLOSED = ["double_spring", "oscillator", "ship", "ship_drag"]  # all states have closed forms


@pytest.fixture
def models(build):
    def models(*arguments):
        return subprocess.run([build / "tests" / "models", *map(str, arguments)], text=True, capture_output=True,
                              timeout=120)

    return models


@pytest.fixture
def show(models, root):
    """A model as lines, {kind: [words]}."""
    def show(name):
        got = models("show", root / f"programs/{name}.ode")
        assert (got.returncode, got.stderr) == (0, "")
        lines = [line.split(" ") for line in got.stdout.splitlines()]
        return {kind: [line[1:] for line in lines if line[0] == kind]
                for kind in ("model", "state", "param", "invariant")}

    return show


@pytest.fixture
def truth(models, root):
    def truth(name, time, **values):
        got = models("truth", root / f"programs/{name}.ode", repr(time), *(f"{k}={v!r}" for k, v in values.items()))
        assert (got.returncode, got.stderr) == (0, "")
        return {line.split()[0]: float(line.split()[1]) for line in got.stdout.splitlines()}

    return truth


def times(model):
    return [float(model["model"][0][2]) * k / 8 for k in range(1, 9)]


def test_the_list_is_complete(root):
    assert [path.stem for path in sorted(root.glob("programs/*.ode"))] == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_a_model_says_what_it_is(name, show, root):
    model = show(name)
    (called, step, span, *doc), = model["model"]
    text = (root / f"programs/{name}.ode").read_text()
    assert called == name and doc
    assert math.frexp(float(step))[0] == 0.5 and float(span) % float(step) == 0 and float(span) >= 50 * float(step)
    assert text.startswith("# ") and "\n# Equations" in text and "umbers: " in text
    assert max(map(len, text.splitlines())) <= 110


@pytest.mark.parametrize("name", NAMES)
def test_two_truths_agree_all_the_way(name, show, truth):
    """The command fails where the closed form, or the second method, says otherwise."""
    model = show(name)
    for t in times(model):
        truth(name, t)
    assert all(state[2] == "exact" for state in model["state"]) == (name in CLOSED)


@pytest.mark.parametrize("name", [name for name in NAMES if name not in [*EVENTS, "duffing"]])  # which starts at t = 0
def test_a_step_back_and_a_step_forth_is_none(name, show, truth):
    model = show(name)
    step, starts = float(model["model"][0][1]), {s[0]: float(s[1]) for s in model["state"]}
    before = {k: v for k, v in truth(name, -step).items() if k in starts}
    assert before != starts
    after = truth(name, step, **before)
    for state, start in starts.items():
        assert after[state] == pytest.approx(start, rel=1e-10, abs=1e-10)


@pytest.mark.parametrize("name", ["arenstorf", "double_pendulum", "double_spring", "elastic_pendulum", "kepler", "lotka_volterra",
                                  "pendulum", "rigid_body", "robertson", "sir", "three_body"])
def test_invariants_are_constant(name, show, truth):
    model = show(name)
    start = truth(name, 0)
    assert model["invariant"]
    for t in times(model):
        now = truth(name, t)
        for invariant, in model["invariant"]:
            assert now[invariant] == pytest.approx(start[invariant], abs=2e-11 * max(1, abs(start[invariant])))


@pytest.mark.parametrize("name, old, new", [
    ("ship", "exact s = s(0) + T/C*t", "exact s = s(0) + 1.00001*T/C*t"),
    ("oscillator", "w  = sqrt(k/m - d^2)", "w  = sqrt(k/m - 1.001*d^2)"),
    ("ship_drag", "v' = (T", "v' = (1.000001*T"),
])
def test_a_wrong_closed_form_is_found(name, old, new, models, root, tmp_path):
    text = (root / f"programs/{name}.ode").read_text()
    assert text.count(old) == 1
    path = tmp_path / f"{name}.ode"
    path.write_text(text.replace(old, new))
    got = models("truth", path, 10)
    assert (got.returncode, got.stdout) == (1, "")
    assert got.stderr.startswith("two solutions of ") and "the closed form says" in got.stderr


def test_the_page_lists_the_models(show, root):
    page = (root / "docs/models.md").read_text().split("## The models", 1)[1]
    rows = {cells[0].strip("`"): cells[1:] for cells in
            (re.split(r"\s*\|\s*", line.strip("| ")) for line in page.splitlines() if line.startswith("| `"))}
    assert sorted(rows) == NAMES
    for name, (what, states, known, step, span) in rows.items():
        model = show(name)
        (_, its_step, its_span, *doc), = model["model"]
        closed = ["closed form"] if name in CLOSED else []
        assert what == " ".join(doc) and states == ", ".join(f"`{s[0]}`" for s in model["state"])
        assert known == ", ".join(closed + [f"`{i}`" for i, in model["invariant"]])
        assert (float(step), float(span)) == (float(its_step), float(its_span))


# ---- what is known otherwise --------------------------------------------------------------------

def test_the_ship_is_where_the_solution_of_equations_1_says(truth):
    v, rate = 2.9e5 / 4.1e4, 4.1e4 / 8.7e5
    got = truth("ship", 60.0)
    assert got["v"] == pytest.approx(v * -math.expm1(-60 * rate), rel=1e-12)
    assert got["s"] == pytest.approx(v * (60 + math.expm1(-60 * rate) / rate), rel=1e-12)


def test_drag_lets_nobody_pass_the_final_speed(truth):
    final = math.sqrt(2.9e5 / 5.8e3)
    assert truth("ship_drag", 2000.0)["v"] == pytest.approx(final, rel=1e-12)
    assert truth("ship_drag", 60.0, v=0.0)["v"] == pytest.approx(
        final * math.tanh(60 * math.sqrt(2.9e5 * 5.8e3) / 8.7e5), rel=1e-11)


def test_without_drag_a_ball_flies_a_parabola(truth):
    got = truth("projectile", 4.0, k=0.0)
    a = math.radians(35)
    assert got["r_x"] == pytest.approx(160 * math.cos(a), rel=1e-12)
    assert got["r_z"] == pytest.approx(1.8 + 160 * math.sin(a) - 9.81 * 8, rel=1e-12)


def test_a_ball_falls_as_fast_as_drag_and_gravity_are_equal(truth):
    got = truth("projectile", 100.0)
    assert got["v_z"] == pytest.approx(-math.sqrt(9.81 / (0.5 * 1.2 * 0.47 * math.pi * 0.0366**2 / 0.145)), rel=1e-9)
    assert (got["v_x"], got["v_y"]) == (pytest.approx(5, rel=1e-9), pytest.approx(2, rel=1e-9))


def agm(a, b):
    for _ in range(40):
        a, b = (a + b) / 2, math.sqrt(a * b)
    return a


@pytest.mark.parametrize("amplitude", [0.1, 1.0, 2.0, 3.0])
def test_a_pendulum_comes_back_after_its_period(amplitude, truth):
    got = truth("pendulum", 2 * math.pi / math.sqrt(9.81) / agm(1, math.cos(amplitude / 2)), theta=amplitude)
    assert got["theta"] == pytest.approx(amplitude, rel=1e-11) and abs(got["omega"]) < 1e-10


@pytest.mark.parametrize("rho", [0.5, 14.0, 28.0])
def test_lorenz_has_an_integral_where_beta_is_2_sigma(rho, truth):
    got = truth("lorenz", 1.0, beta=20.0, rho=rho, x=3.0)
    assert got["x"] ** 2 - 20 * got["z"] == pytest.approx(9 * math.exp(-20), abs=1e-9)


def test_lorenz_sinks_along_its_axis(truth):
    got = truth("lorenz", 3.0, x=0.0, y=0.0, z=30.0)
    assert (got["x"], got["y"], got["z"]) == (0, 0, pytest.approx(30 * math.exp(-8), rel=1e-11))


def test_van_der_pol_is_on_its_limit_cycle(truth):
    got = truth("van_der_pol", 3 * 6.663286859323130)
    assert got["x"] == pytest.approx(2.008619860874843, rel=1e-13) and abs(got["v"]) < 1e-13
    assert truth("van_der_pol", 15 * 6.663286859323130, x=0.5)["x"] != pytest.approx(0.5, abs=0.1)


def test_predators_follow_their_prey_around(truth):
    rest = truth("lotka_volterra", 20.0, x=1.0, y=0.5)
    assert (rest["x"], rest["y"]) == (1, 0.5), "d/c and a/b are at rest"
    little = truth("lotka_volterra", 2 * math.pi / math.sqrt(2 / 3), x=1 + 1e-6, y=0.5)
    assert little["x"] - 1 == pytest.approx(1e-6, rel=1e-4), "small swings have the frequency sqrt(a d)"


def test_a_nerve_fires_again_and_again(truth):
    is_up = [truth("fitzhugh_nagumo", float(t))["v"] > 1 for t in range(0, 101, 2)]
    assert sum(now and not then for then, now in zip(is_up, is_up[1:])) >= 2
    quiet = [truth("fitzhugh_nagumo", float(t), I=0.0)["v"] for t in (60, 100)]
    assert quiet == [pytest.approx(-1.2, abs=0.05)] * 2


def test_a_symmetric_top_precesses_as_it_should(truth):
    got = truth("rigid_body", 5.0, A=2.0, B=2.0, C=3.0, w_x=0.3, w_y=0.0, w_z=2.0)
    w = 0.3 * cmath.exp(1j * (3 - 2) / 2 * 2.0 * 5.0)
    assert (got["w_x"], got["w_y"], got["w_z"]) == (
        pytest.approx(w.real, rel=1e-11), pytest.approx(w.imag, rel=1e-11), 2.0)


def test_a_body_about_its_axis_turns_by_half_the_angle(truth):
    got = truth("rigid_body", 3.0, w_x=0.0, w_y=0.0, w_z=0.7)
    assert (got["e0"], got["e_z"]) == (pytest.approx(math.cos(1.05)), pytest.approx(math.sin(1.05)))


@pytest.mark.parametrize("t", [0.5, 2.0, math.pi, 2 * math.pi, 12.5, -7.0])
def test_a_planet_is_where_keplers_equation_says(t, truth):
    got = truth("kepler", t)
    (x, y), (vx, vy) = kepler(0.5, t)
    assert [got["r_x"], got["r_y"], got["v_x"], got["v_y"]] == pytest.approx([x, y, vx, vy], abs=2e-10)


@pytest.mark.parametrize("name, frequency, x1, x2", [("slow", 2 / (1 + math.sqrt(5)), 1.0, (1 + math.sqrt(5)) / 2),
                                                     ("fast", (1 + math.sqrt(5)) / 2, (1 + math.sqrt(5)) / 2, -1.0)])
def test_two_springs_swing_in_their_modes(name, frequency, x1, x2, truth):
    got = truth("double_spring", 3.0, x1=x1, x2=x2)
    swing = math.cos(10 * frequency * 3.0)
    assert [got["x1"], got["x2"]] == pytest.approx([x1 * swing, x2 * swing], abs=1e-10)


def test_arenstorfs_orbit_closes(truth):
    got = truth("arenstorf", 17.0652165601579625588917206249)
    assert (got["r_x"], got["r_y"]) == (pytest.approx(0.994, abs=1e-9), pytest.approx(0, abs=1e-9))
    assert (got["v_x"], got["v_y"]) == (pytest.approx(0, abs=1e-8), pytest.approx(-2.0015851063790825, abs=1e-8))


EIGHT = {"r1": (0.97000436, -0.24308753), "r2": (-0.97000436, 0.24308753), "r3": (0, 0),
         "v1": (0.466203685, 0.43236573), "v2": (0.466203685, 0.43236573), "v3": (-0.93240737, -0.86473146)}


@pytest.mark.parametrize("thirds, follows", [(3, "123"), (1, "312"), (2, "231"), (-3, "123")])
def test_three_bodies_follow_each_other_along_an_eight(thirds, follows, truth):
    """Period and starts as published, with eight digits; each body is where another one was a third of a period before."""
    got = truth("three_body", thirds * 6.32591398 / 3)
    for body, before in zip("123", follows):
        for what in "rv":
            now = [got[f"{what}{body}_{axis}"] for axis in "xy"]
            assert now == pytest.approx(EIGHT[what + before], abs=1e-7), (body, what)
    assert got["energy"] == pytest.approx(-1.287142, abs=1e-6)


def test_an_epidemic_ends_where_its_invariant_says(truth):
    got = truth("sir", 2000.0)
    assert got["I"] < 1e-12 and got["S"] - math.log(got["S"]) / 2 == pytest.approx(1 - math.log(0.999) / 2, rel=1e-10)


def test_roessler_without_z_is_an_oscillation_that_grows(truth):
    got = truth("roessler", 10.0, b=0.0, x=1.0, y=0.0)
    rate, w = 0.1, math.sqrt(1 - 0.1**2)
    assert got["y"] == pytest.approx(math.exp(rate * 10) * math.sin(w * 10) / w, rel=1e-10)
    assert got["x"] == pytest.approx(math.exp(rate * 10) * (math.cos(w * 10) - rate / w * math.sin(w * 10)), rel=1e-10)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_double_pendulum_swings_in_its_modes(sign, truth):
    w = math.sqrt((2 - sign * math.sqrt(2)) * 9.81)
    got = truth("double_pendulum", 2 * math.pi / w, a1=1e-5, a2=sign * math.sqrt(2) * 1e-5)
    assert (got["a1"], got["a2"]) == (pytest.approx(1e-5, rel=1e-8), pytest.approx(sign * math.sqrt(2) * 1e-5, rel=1e-8))
    assert abs(got["w1"]) < 1e-11 and abs(got["w2"]) < 1e-11


def test_a_double_pendulum_without_a_weight_below_is_a_pendulum(truth):
    above = truth("double_pendulum", 3.0, m2=0.0, a1=2.0)
    assert above["a1"] == pytest.approx(truth("pendulum", 3.0, theta=2.0)["theta"], rel=1e-10)


def test_a_spring_that_hangs_straight_bounces(truth):
    got = truth("elastic_pendulum", 3.3, r_x=0.0, r_y=-1.2)
    assert got["r_y"] == pytest.approx(-1 - 0.2 * math.cos(math.sqrt(39.24) * 3.3), rel=1e-10) and got["r_x"] == 0


def test_a_spring_that_is_stiff_swings_like_a_rod(truth):
    got = truth("elastic_pendulum", math.pi / math.sqrt(9.81), k=1e5, l=1.0, r_x=1e-3, r_y=-1.0)
    assert got["r_x"] == pytest.approx(-1e-3, rel=1e-3)


@pytest.mark.parametrize("time", [0.0005, 0.01, 0.125])
def test_a_ladder_charges_by_its_modes(time, truth):
    got, sections = truth("rc_ladder", time), range(1, 9)
    left = [0.0] * 8  # of the battery's 5 V, what each section still lacks
    for k in sections:
        angle = (2 * k - 1) * math.pi / 17
        shape = [math.sin(n * angle) for n in sections]
        part = 5 * sum(shape) / sum(s * s for s in shape) * math.exp(-4000 * math.sin(angle / 2) ** 2 * time)
        left = [a + part * s for a, s in zip(left, shape)]
    assert [got[f"u_{n}"] for n in sections] == pytest.approx([5 - a for a in left], abs=1e-10)


@pytest.mark.parametrize("time, published", [(0.4, [9.851726e-1, 3.386406e-5, 1.479357e-2]),
                                             (4.0, [9.055142e-1, 2.240418e-5, 9.446344e-2]),
                                             (40.0, [7.158050e-1, 9.184616e-6, 2.841858e-1])])
def test_robertsons_substances_are_what_lsode_prints(time, published, truth):
    """The example of LSODE's documentation (Hindmarsh, ODEPACK, 1983), at its relative tolerance of 1e-4."""
    got = truth("robertson", time)
    assert [got["y1"], got["y2"], got["y3"]] == pytest.approx(published, rel=2e-4)


def test_a_stiff_oscillator_creeps_along_its_slow_curve(truth):
    """ln x - x^2/2 grows with t/mu, but for terms of 1/mu^2."""
    x = truth("van_der_pol_stiff", 32.0)["x"]
    assert math.log(x) - x * x / 2 == pytest.approx(math.log(2) - 2 + 32 / 1000, abs=1e-6)


def test_a_stiff_oscillator_with_little_damping_is_the_other_one(truth):
    got = truth("van_der_pol_stiff", 2 * 6.663286859323130, mu=1.0, x=2.008619860874843)
    assert got["x"] == pytest.approx(2.008619860874843, rel=1e-12)


# ---- where there is no truth --------------------------------------------------------------------

def test_chaos_is_not_followed_for_ever(models, root):
    got = models("truth", root / "programs/lorenz.ode", 40)
    assert (got.returncode, got.stdout) == (1, "") and re.match(r"two solutions of 'x' at time 40: GSL's rk8pd says .*, rkck says ",
                                                                got.stderr)


@pytest.mark.parametrize("time, values, message", [
    ("nan", [], "the time is nan"), ("inf", [], "the time is inf"), ("1", ["m=nan"], "'m' is nan"),
    ("1", ["v=inf"], "'v' starts at inf"), ("1", ["m=0"], "GSL's bsimp does not reach time 1: "),
])
def test_what_cannot_be_is_refused(time, values, message, models, root):
    got = models("truth", root / "programs/ship.ode", time, *values)
    assert (got.returncode, got.stdout) == (2, "") and got.stderr.startswith(message)


def test_a_state_without_bounds_is_said(models, tmp_path):
    path = tmp_path / "blow_up.ode"
    path.write_text("state x = 1\nstep 1\nspan 1\nx' = x^2\n")
    assert models("truth", path, 0.9).stdout.split()[1].startswith("9.99999999")
    got = models("truth", path, 2)
    assert (got.returncode, got.stdout) == (2, "")
    assert re.fullmatch(r"GSL's bsimp does not reach time 2: it made \d+ steps and came to time (1|0\.9{4}\d*), where no step is short enough\n", got.stderr)


def test_time_0_is_the_start(show, truth):
    for name in NAMES:
        now = truth(name, 0)
        assert all(now[state[0]] == float(state[1]) for state in show(name)["state"])


@pytest.mark.parametrize("e", [0.75, 0.9, 0.5])
def test_a_ball_bounces_as_its_closed_form_says(truth, e):
    for t in (0.3, 0.45, 0.46, 0.9, 1.2, 1.35):
        speed, left = math.sqrt(2 * 9.81), t - math.sqrt(2 / 9.81)
        if left < 0:
            expected = {"v": -9.81 * t, "x": 1 - 9.81 * t * t / 2}
        else:
            speed *= e
            while left >= 2 * speed / 9.81:
                left -= 2 * speed / 9.81
                speed *= e
            expected = {"v": speed - 9.81 * left, "x": speed * left - 9.81 * left * left / 2}
        assert truth("bouncing_ball", t, e=e) == pytest.approx(expected, abs=1e-11)


@pytest.mark.parametrize("start, on", [(15, 1), (15, 0), (20, 0), (23, 1)])
def test_a_thermostat_switches_where_exponentials_cross(truth, start, on):
    out, tau, heat, low, high = 5, 100, 0.5, 19, 21
    for t in (1, 16, 17, 30, 47.5, 64):
        now, hot, left = start, on, t
        hot = 1 if now < low else 0 if now > high else hot
        for _ in range(20):
            end, goal = out + heat * tau * hot, high if hot else low
            until = tau * math.log((now - end) / (goal - end))
            if until > left:
                break
            now, left, hot = goal, left - until, 1 - hot
        expected = {"T": end + (now - end) * math.exp(-left / tau), "on": hot}
        assert truth("thermostat", t, T=start, on=on) == pytest.approx(expected, abs=1e-10)


@pytest.mark.parametrize("amplitude, beta, w", [(2.0, 0.25, 3.0), (0.5, 1.0, 1.5), (1.5, -0.2, 4.0)])
def test_a_driven_oscillator_follows_a_third_of_its_drive(truth, amplitude, beta, w):
    """Duffing's exact subharmonic: programs/duffing.ode says why."""
    values = {"delta": 0.0, "beta": beta, "gamma": beta * amplitude**3 / 4, "w": w, "v": 0.0, "x": amplitude,
              "alpha": (w / 3) ** 2 - 0.75 * beta * amplitude**2}
    for t in (0.7, 3.1, 8.0, 12.5):
        now = truth("duffing", t, **values)
        assert now["x"] == pytest.approx(amplitude * math.cos(w * t / 3), abs=1e-9)
        assert now["v"] == pytest.approx(-amplitude * w / 3 * math.sin(w * t / 3), abs=1e-9)


def test_a_driven_oscillator_by_a_series(truth):
    """Taylor's, of degree 24, from coefficients of products: nothing of GSL's."""
    delta, alpha, beta, gamma, w, h = 0.3, -1.0, 1.0, 0.2, 1.2, 0.125
    x, v = 1.0, 0.0
    for step in range(128):
        a, c, s = [x, v], [math.cos(w * h * step)], [math.sin(w * h * step)]
        for n in range(24):
            cube = sum(a[i] * a[j] * a[n - i - j] for i in range(n + 1) for j in range(n + 1 - i))
            force = -delta * (n + 1) * a[n + 1] - alpha * a[n] - beta * cube + gamma * c[n]
            a.append(force / ((n + 1) * (n + 2)))
            c.append(-w * s[n] / (n + 1))
            s.append(w * c[n] / (n + 1))
        x, v = (sum(k * h**n for n, k in enumerate(a)), sum(n * k * h ** (n - 1) for n, k in enumerate(a) if n))
    assert truth("duffing", 16) == pytest.approx({"v": v, "x": x}, abs=1e-9)
