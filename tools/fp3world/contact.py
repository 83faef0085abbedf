"""What theory says of the scenes, beside what their objects do: balls that push each other."""

import math

import numpy as np
from fp3world import scene as ws
from fp3world.physics import relative, row

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
