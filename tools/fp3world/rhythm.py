"""What theory says of the scenes, beside what their objects do: those that turn or fire in time with each other."""

import math

import numpy as np
from fp3world import scene as ws
from fp3world.contact import with_values
from fp3world.friction import least
from fp3world.physics import row, runge_kutta

N, CENTRE, SLOW, H = 20, 0.5, np.linspace(-0.5, 0.5, 20), 2.0 ** -4


def together(u):
    """How much in step oscillators are that feel u sin(phase - their own)."""
    return np.sqrt(1 - (SLOW / u) ** 2).mean()


def critical():
    """The least K with which all are in step: u = K r(u) has a solution from 0.5 on (Kuramoto 1984, chapter 5, for as many as there are)."""
    u = np.linspace(0.5, 1, 100001)
    return (u / np.sqrt(1 - (SLOW[:, None] / u) ** 2).mean(0)).min()


def in_step(found):
    """Phases relative to the middle of all: nobody has moved by more than a tenth in the last quarter."""
    phase = found["phase"] - found["phase"].mean(1, keepdims=True)
    return abs(phase[-1] - phase[3 * len(phase) // 4]).max() < 0.1


def clocks(lab):
    """Adler 1946: in step with a driver from pull = |w - w_driver| on, behind it by arcsin of both's quotient; slower ones pass it with
    sqrt(dw^2 - pull^2). Kuramoto 1984: of oscillators alone."""
    def record(**values):
        return lab.record(with_values("clocks", **values), "--group", "clocks", "--every", 8, "--steps", 2048)
    found, times = lab.record(ws.text_of("clocks"), "--group", "clocks", "--every", 1024)
    u = 0.5
    for _ in range(200):
        u = 0.6 * together(u) + 0.2
    lag = found["phase"][-1] - CENTRE * times[-1]
    why = "a rounding of 2^-24 of 32 in each of twenty phases, 2e-6, and the estimates of sin"
    yield row("clocks", "largest error of a phase, all in step with each other and a driver, rad", 0, abs(lag - np.arcsin(SLOW / u)).max(), 2e-5, why)
    yield row("clocks", "how much all are in step, 1: all alike", together(u), np.hypot(np.cos(lag).mean(), np.sin(lag).mean()), 1e-5, why)
    found, times = record(K=0.0, pull=0.3)
    lag = found["phase"] - CENTRE * times[:, None]
    held = abs(SLOW) < 0.25  # of those that are as fast as they can be it takes longer
    yield row("clocks", "largest error of a lag behind a driver alone, arcsin(dw/pull), rad", 0, abs(lag[-1, held] - np.arcsin(SLOW[held] / 0.3)).max(), 2e-5, why)
    for one in (N - 1, N - 3):
        turns = np.arange(1, int(lag[-1, one] / 2 / math.pi) + 1)
        when = np.interp(2 * math.pi * turns, lag[:, one], times)
        beat = 2 * math.pi * (turns[-1] - turns[0]) / (when[-1] - when[0])
        yield row("clocks", f"how fast one passes the driver that is faster by {SLOW[one]:.4g} rad/s and feels 0.3 of it, rad/s", math.sqrt(SLOW[one] ** 2 - 0.09), beat, 1e-3,
                  "times between snapshots, half a second apart, along a straight line")
    why = "how finely it is looked for; near the least one the way into step takes as long as the run"
    parts = 0.05 if lab.quick else 5e-3
    yield row("clocks", "least pull that keeps all in step with a driver alone, rad/s", 0.5, least(lambda pull: in_step(record(K=0.0, pull=pull)[0]), 0.49, 0.51, 0.5 * parts), 1e-2, why)
    K = critical()
    yield row("clocks", "least K that keeps all in step without a driver, rad/s", K, least(lambda K: in_step(record(K=K, pull=0.0)[0]), 0.98 * K, 1.02 * K, K * parts), 2e-2 * K, why)


def nerves(count, steps, h):
    """programs/world/neurons.ode and synapses.ode by the classical method of Runge and Kutta, in double: v after each step."""
    v, w, s, g = np.full(count, -1.19940803), np.full(count, -0.62426004), np.zeros(count), np.full(count, 0.3)
    v[0] = 1.0
    after, before = np.roll(np.arange(count), -1), np.roll(np.arange(count), 1)  # a synapse excites the next one

    def slopes(y):
        v, w, s, g = y
        fires = 1 / (1 + np.exp(-8 * v))
        return np.stack([v - v * v * v / 3 - w + (2 - v) * (g * s)[before], 0.08 * (v + 0.7 - 0.8 * w), 0.5 * fires * (1 - s) - 0.25 * s, 0.02 * fires * fires[after] * (1 - g)])
    return runge_kutta(slopes, np.stack([v, w, s, g]), steps, h)


def neurons(lab):
    """The same equations and steps in double; one turn of the ring after the other."""
    steps = 1024 if lab.quick else 2048
    found, times = lab.record(ws.text_of("neurons"), "--group", "neurons", "--every", 8, "--steps", steps)
    weights, _ = lab.record(ws.text_of("neurons"), "--group", "synapses", "--every", 8, "--steps", steps)
    double = nerves(8, steps, H)[7::8]
    why = "2,048 roundings of 2^-24 of 2, which a nerve that is about to fire multiplies"
    yield row("neurons", f"largest difference of v from a simulation in double in {times[-1]:g} units of time, of 4 from top to bottom", 0, abs(found["v"][1:] - double[:, 0]).max(), 2e-4, why)
    yield row("neurons", "largest difference of what synapses have learnt", 0, abs(weights["g"][1:] - double[:, 3]).max(), 1e-5, why)
    yield row("neurons", "how often one fires after the one before it, of all times at which one fires", 1, order(found["v"]), 0, "the ring has one way round")


def order(v):
    """Of all times at which somebody fires, how many follow those of the neuron before."""
    who = [(step, one) for step in range(1, len(v)) for one in range(v.shape[1]) if v[step - 1, one] < 0 <= v[step, one]]
    ones = [one for _, one in sorted(who)]
    return sum((b - a) % v.shape[1] == 1 for a, b in zip(ones, ones[1:])) / max(1, len(ones) - 1)
