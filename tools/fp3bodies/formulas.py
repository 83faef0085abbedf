"""What theory says of the truths, in double: nothing here knows an engine. tests/bodies/test_lab.py integrates each of them on its own."""

import math

import numpy as np


# ---- friction ----

def slid(angle, friction, g, t):
    """How far a block slides down a slope, from rest. Coulomb; Goldstein, Classical Mechanics, chapter 1."""
    return max(0.0, g * (math.sin(angle) - friction * math.cos(angle)) * t * t / 2)


def braked(speed, friction, g, t=math.inf):
    """How far a block slides on a level, after a time."""
    t = min(t, speed / (friction * g))
    return speed * t - friction * g * t * t / 2


def rolled(speed, friction, g, share, t):
    """Speed in the end, and how far after t, of what slides at first without turning; share: its moment of inertia of m r^2.
    It rolls when r w = v: after share v0/((1 + share) mu g). Landau and Lifshitz, Mechanics, section 38."""
    end = speed / (1 + share)
    until = (speed - end) / (friction * g)
    return end, speed * until - friction * g * until ** 2 / 2 + end * (t - until)


def rolling(angle, g, share):
    """Acceleration of what rolls down a slope without sliding, if friction is above share/(1 + share) tan(angle)."""
    return g * math.sin(angle) / (1 + share)


def swing(friction, weight, stiff, mass, speed):
    """How far a spring is stretched at most by a block on a belt: friction carries it until k x = mu N, and it leaves with the belt's speed."""
    return friction * weight / stiff + speed * math.sqrt(mass / stiff)


# ---- pendulums ----

def mean(a, b):
    """The arithmetic-geometric mean."""
    for _ in range(60):
        a, b = (a + b) / 2, math.sqrt(a * b)
    return a


def quarter(m):
    """K(m), the complete elliptic integral of the first kind: Abramowitz and Stegun 17.6.3."""
    return math.pi / (2 * mean(1.0, math.sqrt(1 - m)))


def period(about, mass, length, g, angle):
    """Of a pendulum, about: moment about its pivot. Landau and Lifshitz, Mechanics, section 11."""
    return 2 * math.pi * math.sqrt(about / (mass * g * length)) / mean(1.0, math.cos(angle / 2))


def rods(angles, length, about, mass, g, t, steps=6000):
    """Angles from straight down, at first and after each step, of rods that hang on each other, from rest: Lagrange's equations by the classical
    Runge-Kutta method. about: a rod's moment about its centre."""
    count = len(angles)
    below = count - np.arange(count) - 0.5  # rods that each turns with itself, its own as a half
    arms = mass * length ** 2 * np.minimum.outer(below, below)
    arms[np.diag_indices(count)] += about - mass * length ** 2 / 4

    def slopes(y):
        angle, w = y
        apart = angle[:, None] - angle
        return np.array([w, np.linalg.solve(arms * np.cos(apart), -(arms * np.sin(apart)) @ (w * w) - mass * g * length * below * np.sin(angle))])
    y, h = np.array([angles, np.zeros(count)]), t / steps
    path = [y[0]]
    for _ in range(steps):
        p = slopes(y)
        q = slopes(y + h / 2 * p)
        r = slopes(y + h / 2 * q)
        y = y + h / 6 * (p + 2 * q + 2 * r + slopes(y + h * r))
        path.append(y[0])
    return np.array(path)


# ---- impacts ----

def bounced(high, restitution, g, t):
    """How high a ball is that has fallen from there: Goldsmith, Impact, chapter 1. restitution: below 1."""
    speed = math.sqrt(2 * g * high)
    if t < speed / g:
        return high - g * t * t / 2
    t -= speed / g
    while speed > 1e-9:
        speed *= restitution
        if t < 2 * speed / g:
            return t * (speed - g * t / 2)
        t -= 2 * speed / g
    return 0.0


# ---- what stands ----

def hung(count, length, weight, span):
    """Slopes of rods between two pins at one height, and the pull along: a rod lies along the mean of the forces at its ends."""
    down = weight * (np.arange(count) - (count - 1) / 2)

    def wide(along):
        return (length * along / np.hypot(along, down)).sum()
    low, high = 0.0, weight * count * 1e3
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (middle, high) if wide(middle) < span else (low, middle)
    return down / low, low


def thinnest(joints=None):
    """Thickness, of its mean radius, below which a half circle's arch falls: no line of thrust stays inside. Milankovitch (1907) has 0.1075
    for joints everywhere; Heyman, The Stone Skeleton (1995), chapter 2. joints: how many parts, as thrust must be inside at their joints alone."""
    angle = np.linspace(0, np.pi / 2, 2000) if joints is None else np.pi * np.arange(joints // 2 + 1) / joints
    angle = angle[1:]  # from the crown

    def stands(thick):
        """The pulls at the crown, at some heights, with which thrust stays inside at each joint: is there one for all?"""
        inner, outer = 1 - thick / 2, 1 + thick / 2
        weight = angle * (outer ** 2 - inner ** 2) / 2
        first = (outer ** 3 - inner ** 3) / 3 * (1 - np.cos(angle))  # weight times its distance from the crown
        for top in np.linspace(outer, inner, 9):
            least = ((inner * weight * np.sin(angle) - first) / (top - inner * np.cos(angle))).max()
            share, free = top - outer * np.cos(angle), outer * weight * np.sin(angle) - first  # share times the pull must not be above
            least = max([least, *(free / share)[share < 0]])
            if least <= (free / share)[share > 0].min():
                return True
        return False
    low, high = 0.02, 0.3
    while high - low > 1e-5:
        middle = (low + high) / 2
        low, high = (low, middle) if stands(middle) else (middle, high)
    return high


def tension(pin, links, link, end, g):
    """What a pin of a hanging chain carries."""
    return (end + (links - pin) * link) * g


# ---- tops ----

def flips(moments, spin):
    """Seconds between two changes of sign of the spin about the middle axis, of a free body: Landau and Lifshitz, Mechanics, section 37."""
    a, b, c = moments
    twice = sum(i * w * w for i, w in zip(moments, spin))
    square = sum((i * w) ** 2 for i, w in zip(moments, spin))
    if square < twice * b:  # names the axes so that it turns about the third
        a, c = c, a
    rate = math.sqrt((c - b) * (square - twice * a) / (a * b * c))
    return 2 * quarter((b - a) * (twice * c - square) / ((c - b) * (square - twice * a))) / rate


def precession(across, along, spin, torque, cosine):
    """The slow steady precession of a heavy top, across and along: its moments about the pivot; torque: m g l; spin: about its axis.
    I1 W^2 cos - I3 w W + m g l = 0: Goldstein, Classical Mechanics, section 5.7."""
    root = math.sqrt((along * spin) ** 2 - 4 * across * cosine * torque)
    return 2 * torque / (along * spin + root)


# ---- dominoes ----

def wave(high, thick, apart, g, count=60):
    """Speed, m/s, of a long row of dominoes that turn about pinned corners without rubbing: van Leeuwen, physics/0401018. Each leans on the next
    with h sin(t - t') = (s + d) cos t' - d; all keep their energy between collisions; in one, the row's momentum along its only way to move stays."""
    h, d, s = high, thick, apart
    about = (h * h + d * d) / 3

    def train(head):
        """Angles and rates, of the head's, of all."""
        angles, rates = [head], [1.0]
        for _ in range(count):
            last = angles[-1]
            angle = last + math.asin(min(1.0, ((s + d) * math.cos(last) - d) / h))
            rates.append(rates[-1] * max(0.0, 1 - (s + d) * math.sin(last) / (h * math.cos(angle - last))))
            angles.append(angle)
        angles, rates = np.array(angles), np.array(rates)
        return g / 2 * (h * np.cos(angles) + d * np.sin(angles)).sum(), about / 2 * (rates ** 2).sum()
    nodes, weights = np.polynomial.legendre.leggauss(24)
    until = math.asin(s / h)
    points = [train(until * (1 + node) / 2) for node in nodes]
    (first, still), (last, moving) = train(0.0), train(until)
    w = 1.0
    for _ in range(4 * count):
        energy = first + still * w * w
        t = until / 2 * sum(weight / math.sqrt((energy - high_) / slow) for weight, (high_, slow) in zip(weights, points))
        before = math.sqrt((energy - last) / moving)
        w = before * moving / (moving + about / 2)
    return (s + d) / t
