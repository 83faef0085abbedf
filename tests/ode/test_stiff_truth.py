"""The truth of stiff models: published numbers, closed forms, events, switches, the path between steps, and where there is none."""
import math
import os
import re
import subprocess

import pytest
from runs import BUILD

PROGRAMS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../programs")
OREGONATOR = """param s = 77.27
param w = 0.161
param q = 8.375e-6
state a = 1
state b = 2
state c = 3
step 0.001
span 360
a' = s*(b + a*(1 - q*a - b))
b' = (c - (1 + a)*b)/s
c' = w*(a - c)
"""
HIRES = """state a = 1
state b = 0
state c = 0
state d = 0
state e = 0
state f = 0
state g = 0
state i = 0.0057
step 0.001
span 321.8122
a' = -1.71*a + 0.43*b + 8.32*c + 0.0007
b' = 1.71*a - 8.75*b
c' = -10.03*c + 0.43*d + 0.035*e
d' = 8.32*b + 1.71*c - 1.12*d
e' = -1.745*e + 0.43*f + 0.43*g
f' = -280*f*i + 0.69*d + 1.71*e - 0.43*f + 0.69*g
g' = 280*f*i - 1.81*g
i' = -280*f*i + 1.81*g
"""
VAN_DER_POL = """state x = 2
state v = 0
step 0.001
span 2
x' = v
v' = 1e6*((1 - x^2)*v - x)
"""
# A first-order exothermic reaction in a cooled tank (the equations of Uppal, Ray and Poore, 1974), its temperature read by a fast sensor.
REACTOR = """state x = 0
state y = 0
state z = 0
step 0.001
span 100
x' = -x + 0.11*(1 - x)*exp(y/(1 + y/20))
y' = -y + 1.54*(1 - x)*exp(y/(1 + y/20)) - 1.5*z
z' = 1e5*(y - z)
"""
# Falls on the ground and rebounds with 0.8 of its speed; s follows v.
BALL = """param k = 1e5
state x = 1
state v = 0
state s = 0
step 0.001
span 3
x' = v
v' = -9.81
s' = k*(v - s)
when x <= 0 and v < 0: v = -0.8*v
"""
# x climbs by 1, and by 3 above 1; the pulses of u are half of each second; y follows both.
SWITCHED = """param k = 1e5
state x = 0
state y = 0
step 0.001
span 2
u = sin(2*pi*t) > 0 ? 1 : 0
x' = x < 1 ? 1 : 3
y' = k*(x + u - y)
"""


@pytest.fixture
def write(tmp_path):
    def write(text):
        (tmp_path / "m.ode").write_text(text)
        return tmp_path / "m.ode"

    return write


def run(path, t, *values):
    return subprocess.run([BUILD + "/tests/models", "truth", path, str(t), *values], capture_output=True, text=True, timeout=60)


def truth(path, t, *values):
    done = run(path, t, *values)
    assert done.returncode == 0, done.stderr
    return {name: float(x) for name, x in map(str.split, done.stdout.splitlines())}


# Test Set for Initial Value Problem Solvers, release 2.4 (Mazzia and Magherini, Bari, 2008), where it has the problem.
PUBLISHED = {
    "van_der_pol_stiff": ("van_der_pol_stiff", 2000, {"x": 1.706167732170469, "v": -0.8928097010248125e-3}),
    "oregonator": (OREGONATOR, 360, {"a": 0.1000814870318523e1, "b": 0.1228178521549917e4, "c": 0.1320554942846706e3}),
    "hires": (HIRES, 321.8122, {"a": 0.7371312573325668e-3, "b": 0.1442485726316185e-3, "c": 0.5888729740967575e-4, "d": 0.1175651343283149e-2,
                                "e": 0.2386356198831331e-2, "f": 0.6238968252742796e-2, "g": 0.2849998395185769e-2, "i": 0.2850001604814231e-2}),
    "van der Pol": (VAN_DER_POL, 2, {"x": 0.1706167732170483e1, "v": -0.8928097010247975}),
    "robertson": ("robertson", 1e11, {"y1": 0.2083340149701255e-7, "y2": 0.8333360770334713e-13, "y3": 0.9999999791665050, "mass": 1}),
}


@pytest.mark.smoke
@pytest.mark.parametrize("name", PUBLISHED)
def test_published_numbers(write, name):
    text, end, expected = PUBLISHED[name]
    path = write(text) if "\n" in text else os.path.join(PROGRAMS, f"{text}.ode")
    assert truth(path, end) == pytest.approx(expected, rel=1e-8)


def test_numbers_of_another_program(write):
    """SciPy 1.10.1, solve_ivp, Radau with rtol = 1e-12 and atol = 1e-14, Jacobian given."""
    assert truth(os.path.join(PROGRAMS, "robertson.ode"), 1e4) == pytest.approx({"y1": 0.10730042853793162, "y2": 4.800166972578033e-07, "y3": 0.8926990914453726, "mass": 1}, rel=1e-8)
    assert truth(write(REACTOR), 2) == pytest.approx({"x": 0.49273456842038954, "y": 4.475748758772772, "z": 4.475557913825011}, rel=1e-8)


def test_a_closed_form(write):
    """Prothero and Robinson's equation; its Jacobian depends on t in the second."""
    for rate, text in (("k", "1e6"), ("k*(2 + sin(t))", "1e5"), ("k", "1e8")):
        path = write(f"param k = {text}\nstate y = 1\nstep 0.001\nspan 20\ny' = -{rate}*(y - cos(t)) - sin(t)\n")
        for t in (0.3, 7, 20):
            assert truth(path, t)["y"] == pytest.approx(math.cos(t), abs=1e-11)


def test_a_closed_form_is_compared_with(write):
    """The explicit method would come to the end, too: its steps are seen to be limited."""
    text = "state y = 1\nstep 0.001\nspan 20\ny' = -5e3*(y - cos(t)) - sin(t)\nexact y = "
    assert truth(write(text + "cos(t)\n"), 20)["y"] == pytest.approx(math.cos(20), abs=1e-11)
    refused = run(write(text + "cos(1.00000001*t)\n"), 20)
    assert refused.returncode == 1 and re.match(r"two solutions of 'y' at time 20: GSL's bsimp says .*, the closed form says ", refused.stderr)


def test_two_ways_have_to_agree(write):
    """Lorenz's equations, and what follows x: chaos."""
    path = write("state x = 1\nstate y = 1\nstate z = 20\nstate s = 1\nstep 0.001\nspan 40\n"
                 "x' = 10*(y - x)\ny' = x*(28 - z) - y\nz' = x*y - 8/3*z\ns' = 1e4*(x - s)\n")
    refused = run(path, 40)
    assert refused.returncode == 1 and re.match(r"two solutions of 'x' at time 40: GSL's bsimp says .*, msbdf says ", refused.stderr)


def rebounds(t):
    """The height and speed of a ball, by the formula of a throw from one bounce to the next."""
    begin, x, v = 0, 1, 0
    while True:
        hit = begin + (v + math.sqrt(v*v + 2*9.81*x))/9.81
        if hit > t:
            return x + v*(t - begin) - 9.81*(t - begin)**2/2, v - 9.81*(t - begin), begin
        begin, x, v = hit, 0, -0.8*(v - 9.81*(hit - begin))


def test_events(write):
    """A lag of 1/k: s = v + 9.81/k once 40/k have passed. Beyond time 3 there are ever more rebounds."""
    path = write(BALL)
    for t in (0.4, 0.46, 1, 1.2, 2.3874, 2.49534337, 3):
        x, v, since = rebounds(t)
        assert t - since > 40e-5
        assert truth(path, t) == pytest.approx({"x": x, "v": v, "s": v + 9.81e-5}, abs=1e-9)


def test_switches(write):
    path = write(SWITCHED)
    for t in (0.2, 0.7, 1.4, 1.9):
        x, slope = (t, 1) if t < 1 else (1 + 3*(t - 1), 3)
        assert truth(path, t) == pytest.approx({"x": x, "y": x - slope/1e5 + (t % 1 < 0.5)}, abs=1e-9)


def test_the_path_between_steps(tmp_path):
    """At 2,500 uneven times, by the truths there; and truths at several times by those of one."""
    for name, text in (("hires", HIRES), ("ball", BALL.replace("(v - s)", "(x - s)"))):
        (tmp_path / f"{name}.ode").write_text(text)
    paths = [tmp_path / "hires.ode", tmp_path / "ball.ode"]
    out = subprocess.run([BUILD + "/tests/truths", *paths], capture_output=True, text=True, check=True, timeout=100).stdout.split()
    assert out[::5] == ["hires", "ball"]
    assert max(map(float, out[1::5])) < 1e-10 and max(map(float, out[2::5])) < 3e-10, out


def test_a_budget_is_told(write):
    """Turns 1.6e8 times: too often for any method."""
    done = run(write("param w = 1e5\nstate x = 1\nstate v = 0\nstep 1\nspan 1e4\nx' = w*v\nv' = -w*x\n"), 1e4)
    assert done.returncode == 2
    assert re.fullmatch(r"GSL's bsimp does not reach time 10000: it made 50000 steps and came to time [0-9.]+, and may make no more\n", done.stderr), done.stderr
