"""What theory says of the scenes, beside what their objects do: balls that push each other."""

import math

import numpy as np
from fp3world import scene as ws
from fp3world.physics import relative, row, runge_kutta

R = 0.05
M = 0.01


def with_values(name, **values):
    """The scene with other values of its model's shared params."""
    text = ws.text_of(name)
    for key, value in values.items():
        text = ws.replace(text, rf" {key} = [^;]*;", f" {key} = {value};") if f" {key} =" in text else ws.replace(text, "set     = {", f"set     = {{ {key} = {value};")
    return text


def pair(lab):
    """A spring and a damper between two: exp(-pi d/sqrt(w^2 - d^2)), d = c/m, w^2 = 2 k/m (Cundall and Strack, Geotechnique 29, 1979)."""
    for damp in (0.05, 0.2, 0.4):
        found, _ = lab.record(with_values("pair", damp=damp))
        x, v = found["v_x"][0], found["v_x"][-1]
        d, w = damp / M, math.sqrt(2 * 100 / M)
        yield relative("pair", f"speed after, of that before, at a damping of {damp:g} N s/m", math.exp(-math.pi * d / math.sqrt(w * w - d * d)),
                       (v[1] - v[0]) / (x[0] - x[1]), 2 * d * 2.0 ** -14 + 1e-3, "contact begins and ends between two steps: up to a step of damping, 2 d h, more or less")
        yield row("pair", f"momentum after, at a damping of {damp:g} N s/m, of that of a ball", 0, v.sum() / abs(v[0]), 1e-6, "both evaluate the same expression: forces are exact negatives")


def players(lab):
    """What a player does to a ball, that ball does to the player: momentum of both kinds together."""
    text, steps = ws.text_of("players"), 1024
    kinds = [(lab.record(text, "--group", name, "--every", 64, "--steps", steps)[0], m) for name, m in (("players", 62.5), ("balls", 0.5))]
    total = sum(m * np.stack([found["v_x"], found["v_y"]], -1).sum(1) for found, m in kinds)
    size = max(sum(m * np.hypot(found["v_x"], found["v_y"]).sum(1) for found, m in kinds))
    yield row("players", f"momentum gained in {steps} steps by both kinds, of the sum of all momenta", 0, np.linalg.norm(total - total[0], axis=1).max() / size, 8 * math.sqrt(steps) * 2.0 ** -24,
              "both kinds evaluate the same expression: what is left is a rounding of 2^-24 of a speed in each step, up or down")


# ---- Newton's cradle ----

def struck(v, places, steps, h):
    """The five balls of cradle.ode in double, by the classical method of Runge and Kutta: what they do after the first one, with this speed, comes to the others."""
    k, m, over = 250000, 0.1, 9.81

    def slopes(y):
        into = np.maximum(0, y[0, :-1] - y[0, 1:])  # y: out of where it hangs
        push = k * into * np.sqrt(into / 0.0625) / m
        return np.stack([y[1], np.concatenate([[0], push]) - np.concatenate([push, [0]]) - over * y[0]])
    return runge_kutta(slopes, np.stack([np.zeros(places), np.eye(places)[0] * v]), steps, h)


def cradle(lab):
    """Herrmann and Schmaelzle 1981: of five that touch the last one takes nearly all, and the others move a little."""
    found, times = lab.record(ws.text_of("cradle"), "--every", 8)
    x, v, turn, swing, m = found["x"] - 0.125 * np.arange(5), found["v"], math.sqrt(9.81), 0.16, 0.1
    after = int(np.searchsorted(times, math.pi / 2 / turn + 0.04))
    late, h = times[after] - math.pi / 2 / turn, 2.0 ** -14
    double = struck(swing * turn, 5, round(late / h), late / round(late / h))[-1, 1]
    why = "leapfrog errs by (h/T)^2 of a contact of 4 ms, 65 steps, and the same of the time at which it begins"
    yield relative("cradle", "speed of the last ball, of that of the first before", double[4] / (swing * turn), v[after, 4] / (swing * turn), 5e-4, why)
    yield row("cradle", "largest difference of a ball's speed from a simulation in double, of that", 0, abs(v[after] - double).max() / (swing * turn), 1e-3, why)
    before = int(np.searchsorted(times, math.pi / 2 / turn)) - 4
    pull = -9.81 * m * x.sum(1)
    gained = m * (v[after] - v[before]).sum() - ((pull[before + 1:after + 1] + pull[before:after]) / 2 * np.diff(times[before:after + 1])).sum()
    yield row("cradle", "momentum that the balls gain as they meet, but for strings, of that of the first", 0, gained / (m * swing * turn), 1e-5, "forces are exact negatives; a rounding of 2^-24 of a speed in each of 700 steps")
    energy = m * (v ** 2).sum(1) / 2 + m * 9.81 * (x ** 2).sum(1) / 2
    apart = (np.diff(x, axis=1) >= 0).all(1)  # nothing is in springs then
    yield row("cradle", "largest change of energy between contacts, of all", 0, abs(energy[apart] / energy[0] - 1).max(), 1e-3, why)


def gas(lab):
    """Maxwell: components of the velocity are normally distributed, speeds are as their root of a sum of squares."""
    steps = 16384 if lab.quick else 65536
    found, times = lab.record(ws.text_of("gas"), "--every", 512, "--steps", steps)
    x, v = ws.vectors(found, "x"), ws.vectors(found, "v")
    moving = M * (v ** 2).sum((1, 2)) / 2
    yield relative("gas", "kinetic energy, most of the time all there is, J", moving[0], np.median(moving), 0.05, "balls touch 5 % of the time, and have some of it in springs then")
    later = v[len(times) // 4:]
    speeds = np.sqrt((later ** 2).sum(2)).ravel() / math.sqrt((later ** 2).mean())
    many = len(speeds) / 2  # of two snapshots, 0.125 s apart, a ball has collided once or more
    square = math.sqrt((speeds ** 2).mean() / 3)
    yield row("gas", "fourth moment of a component, of the square of the second", 3, (later ** 4).mean() / (later ** 2).mean() ** 2, 4 * math.sqrt(24 / (3 * many)), "4 standard deviations")
    yield relative("gas", "mean speed, of the root of the mean square", math.sqrt(8 / (3 * math.pi)), speeds.mean() / math.sqrt((speeds ** 2).mean()), 4 * 0.42 / math.sqrt(many), "likewise")
    at = np.sort(speeds / square)
    maxwell = np.array([math.erf(s / math.sqrt(2)) - math.sqrt(2 / math.pi) * s * math.exp(-s * s / 2) for s in at])
    yield row("gas", "largest distance of the speeds' distribution from Maxwell's", 0, abs(maxwell - (np.arange(len(at)) + 0.5) / len(at)).max(), 1.95 / math.sqrt(many),
              "Kolmogorov and Smirnov: exceeded once in a thousand")
    yield row("gas", "share of the kinetic energy along x, which had all of it", 1 / 3, (later[..., 0] ** 2).sum() / (later ** 2).sum(), 4 * math.sqrt(4 / 9 / many), "4 standard deviations")
    yield row("gas", "who is outside of the box", 0, int(((x < 0) | (x > 1)).any(2).sum()), 0, "walls are as stiff as balls")


def at_rest(name, found, stiff, count, since):
    """From a snapshot on."""
    y = found["x_y"][-1]
    floor = (stiff * np.maximum(0, R - y)).sum()
    weight = count * M * 9.81
    v = ws.vectors(found, "v")[since:]
    moving = (M * (v ** 2).sum((1, 2)) / 2).max() / count / (M * 9.81 * R)
    yield relative(name, "force on the floor, N", weight, floor, 1e-4, "what still moves: 1e-6 m g R of a ball, and a rounding of 2^-24 of 0.05 m in each of those on the floor")
    yield row(name, "largest kinetic energy of a ball at rest, mean over balls, of m g R", 0, moving, 1e-6, "the figure that is asked for")


def balls(lab):
    """They have 40 s to come to rest, and stay so for 100,000 steps more."""
    since, steps = 40960, 8192 if lab.quick else 102400
    found, _ = lab.record(ws.text_of("balls"), "--steps", since + steps, "--every", 2048)
    yield from at_rest("balls", found, 100, 300, since // 2048)


def heap(lab):
    """Likewise, where there is time for 10,000 balls."""
    since, steps = 81920, 102400
    if not lab.quick:
        found, _ = lab.record(ws.text_of("heap"), "--steps", since + steps, "--every", 8192)
        yield from at_rest("heap", found, 1000, 10000, since // 8192)
