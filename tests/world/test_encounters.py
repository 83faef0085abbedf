"""Close encounters with steps that the worst object chooses, beside a simulation in double: Burrau's three bodies and 30 stars."""

import re

import numpy as np
import pytest

COLUMNS = 8  # of the extrapolation


def attract(masses):
    """The derivative of positions and velocities, [2, body, component]; G is 1."""
    def slopes(y):
        apart = y[0][None] - y[0][:, None]
        squares = (apart ** 2).sum(-1) + np.eye(len(masses))
        return np.stack([y[1], (apart * (masses / (squares * np.sqrt(squares)))[..., None]).sum(1)])
    return slopes


def midpoint(slopes, y, h, parts):
    """Gragg, SIAM Journal on Numerical Analysis 2, 1965: the error has even powers of h/parts alone."""
    before, now = y, y + h / parts * slopes(y)
    for _ in range(parts - 1):
        before, now = now, before + 2 * h / parts * slopes(now)
    return (before + now + h / parts * slopes(now)) / 2


def truth(masses, x, v, end, most):
    """Bulirsch and Stoer, Numerische Mathematik 8, 1966: positions in the end, with an error of at most `most` in each step."""
    slopes, y, t, h = attract(np.array(masses)), np.stack([x, v]).astype(float), 0.0, 1e-3
    while t < end:
        h, row = min(h, end - t), []
        for k in range(1, COLUMNS + 1):
            row = [midpoint(slopes, y, h, 2 * k), *row]
            for i in range(1, k):
                row[i] = row[i - 1] + (row[i - 1] - row[i]) / ((k / (k - i)) ** 2 - 1)
        error = np.abs(row[-1] - row[-2]).max() / most
        if error <= 1:
            y, t = row[-1], t + h
        h *= min(2, max(0.2, 0.9 * (error + 1e-30) ** (-1 / (2 * COLUMNS - 1))))
    return y[0]


@pytest.fixture
def hold(start, folder):
    """What the objects of a scene hold in the end: of each name a list of numbers."""
    def hold(text, *options):
        (folder / "x.scene").write_text(text)
        done = start("--scene", "x.scene", "--all", *options)
        assert done.returncode == 0, done.stderr
        found = {}
        for name, number in re.findall(r"^(\w+) +(\S+) +0x.*object \d+$", done.stdout, re.M):
            found.setdefault(name, []).append(float(number))
        return {name: np.array(numbers) for name, numbers in found.items()}
    return hold


@pytest.fixture
def burrau(root):
    return (root / "programs/burrau.scene").read_text().replace("world/", "")


def places(found):
    """Of the bodies, from the sides: side 1 goes from body 2 to body 3, and the centre of mass is 0."""
    sides = np.stack([found["r_x"], found["r_y"]], 1)
    from_second = np.stack([sides[0] + sides[1], 0 * sides[0], sides[0]])
    return from_second - np.array([3, 4, 5]) @ from_second / 12


def test_burrau(hold, burrau):
    """To 3e-4 at t = 10; steps of one length that cost as much lose the bodies at the first one."""
    x = np.array([[1, 3], [-2, -1], [1, -1]])
    true = truth([3, 4, 5], x, 0 * x, 10, 1e-11)
    error = {}
    for tolerance in ("1e-5", "1e-6", "3e-8"):
        found = hold(burrau.replace("3e-8", tolerance))
        error[tolerance] = np.abs(places(found) - true).max()
        attempts = found["accepted"][0] + found["rejected"][0]
        assert attempts < 700 and found["smallest"][0] < 1e-4 and found["largest"][0] > 0.1, found
    assert error["3e-8"] < 3e-4 < error["1e-6"] < 1e-2 < error["1e-5"] < 0.3, error
    fixed = re.sub(r"tolerance .*\n.*until .*", "", burrau).replace("groups =", f"steps = {attempts:.0f}; h = {10/attempts};\ngroups =")
    assert np.abs(places(hold(fixed, "--allow-failures")) - true).max() > 1


def test_burrau_has_the_same_words_everywhere(hold, burrau, long):
    short = burrau.replace("10.0", "2.0" if long else "1.0").replace("tolerance   = 3e-8", "tolerance   = 1e-5").replace("M = 12.0", "M = 12.0; h_next = 1.0")
    found = [hold(short, *options) for options in (["-e", "isa"], ["-e", "fast", "--threads", 1], ["-e", "fast", "--threads", 2], ["-e", "rtl"])]
    assert all((one[name] == found[0][name]).all() for one in found for name in found[0]) and found[0]["rejected"][0] > 0


def test_thirty_stars(hold, folder):
    """Of Plummer's sphere, two of which pass each other within 0.0034 at t = 2.2: the error falls with the tolerance, and steps of one length lose both."""
    head, *rows = [line for line in (folder / "plummer.csv").read_text().splitlines() if line[0] != "#"][:31]
    (folder / "some.csv").write_text("\n".join([head, *rows]))
    start = np.array([row.split(",") for row in rows], np.float32).astype(float)
    true = truth([1 / 32] * 30, start[:, :3], start[:, 3:], 3, 1e-7)
    group = 'program = "stars.ode"; integrator = "cash_karp"; points = "some.csv"; set = { m = 0.03125; };'
    error, attempts = [], []
    for settings in ("tolerance = 1e-3;", "tolerance = 1e-4;", "tolerance = 1e-5;", ""):
        most = "until = 3.0;" if settings else ""
        found = hold(f"{'' if settings else 'steps = 256; h = 0.01171875;'} groups = ( {{ {group} {settings} {most} }} );\n")
        error.append(np.abs(np.stack([found[f"x_{axis}"] for axis in "xyz"], 1) - true).max())
        attempts.append(found["accepted"][0] + found["rejected"][0] if settings else 256)
    assert error[2] < 1e-3 < 5*error[2] < error[1] < 1e-2 < 5*error[1] < error[0] < 0.1 < error[3] and attempts[2] < 200 < attempts[3], (error, attempts)
