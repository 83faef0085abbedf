"""What theory says of the scenes, beside what their objects do: friction that remembers how far a contact is stretched."""

import math

import numpy as np
from fp3world import scene as ws
from fp3world.contact import with_values
from fp3world.physics import relative, row

R, M, K, KT, G = 0.05, 0.01, 2000, 1000, 9.81
H = 2.0 ** -12


def of_grains(lab, text, *options):
    """The balls alone: nothing moves the floor."""
    return lab.record(text, "--group", "grains", *options)


def slope(lab):
    """Coulomb's law: a block begins to slide where the tangent of the angle is mu. A ball rolls with 5/7 of a block's speed without friction
    (Goldstein, Classical Mechanics, chapter 1)."""
    found, times = of_grains(lab, ws.text_of("slope"), "--every", 64)
    rate = 0.125
    for block, mu in enumerate((0.8, 0.6, 0.4, 0.2)):
        v = found["v_x"][:, block]
        # v = g sqrt(1 + mu^2) rate (t - begin)^2/2 at first, so the root of v is a straight line
        sliding = (v > 0.02) & (v < 0.1)
        along = np.polyfit(times[sliding], np.sqrt(v[sliding]), 1)
        yield row("slope", f"angle at which a block begins to slide, friction {mu:g}", math.atan(mu), rate * -along[1] / along[0], 1e-4,
                  "the root of the speed is a straight line but for the angle's square, up to 0.05^2 at 0.1 m/s")
    at = np.argmin(abs(times - 4))
    yield relative("slope", "how far the spring of a block that holds is stretched, m", M * G * math.sin(rate * times[at]) / KT, found["x_x"][at, 0], 2e-3,
                   "4.7e-5 m, and a rounding of 2^-24 of the overlap, whose force is the limit of no block that holds; dampers lag by ct/kt = 0.5 ms of 4 s")
    at = np.argmin(abs(times - 3))
    yield relative("slope", "speed of a ball that rolls, m/s", 5 / 7 * G / rate * (1 - math.cos(rate * times[at])), found["v_x"][at, 4], 1e-3,
                   "the spring of the contact is stretched meanwhile, by 1e-5 m of some metres")


def belt(lab):
    """Friction mu m g alone: the block has the belt's speed after u/(mu g), the ball rolls after 2 u/(7 mu g), with 2/7 of it (Goldstein, chapter 1)."""
    found, times = of_grains(lab, ws.text_of("belt"), "--every", 4)
    u, mu = 2.0, 0.4
    for what, body, share, has in (("block has the speed of the belt", 0, 1, found["v_x"][:, 0]), ("ball rolls", 1, 2 / 7, found["v_x"][:, 1])):
        first = int(np.argmax(has >= share * u * (1 - 1e-3)))
        yield relative("belt", f"time until a {what}, s", share * u / (mu * G), times[first], 1e-2, "0.1 % earlier than that, read off every 1 ms; in the end the damper of the contact takes part")
        yield relative("belt", f"speed then, where a {what}, m/s", share * u, has[-1], 1e-4, "the contact's damper leaves no swing; a rounding of 2^-24 in each step")
    back = found["x_x"][0, 0] + u * times[-1] - found["x_x"][-1, 0]
    yield relative("belt", "how far the belt runs ahead of the block, m", u * u / (2 * mu * G), back, 2e-3, "the block is put down at the height at which it rests: what swings takes 1e-3 of its weight")


def gran_hooke_history(x, v, w, m, k, c, kt, ct, mu, steps):
    """Two balls in space, in double, by the equations of LAMMPS, pair_style gran/hooke/history (https://docs.lammps.org/pair_gran.html):
    the spring s is a vector that turns with the contact. Speeds at every step."""
    x, v, w = (np.array(of, dtype=float) for of in (x, v, w))
    s, speeds = np.zeros(3), [np.concatenate([v.ravel(), R * w.ravel()])]
    for _ in range(steps):
        way = x[0] - x[1]
        d = np.linalg.norm(way)
        force, torque = np.zeros(3), np.zeros(3)
        if d < 2 * R:
            n = way / d
            apart = v[0] - v[1]
            along = apart - apart @ n * n - R * np.cross(w[0] + w[1], n)
            s = s + H * along
            s = s - s @ n * n
            normal = (k * (2 * R - d) - c * (apart @ n)) * n
            tangent = -(kt * s + ct * along)
            most = mu * np.linalg.norm(normal)
            if np.linalg.norm(tangent) > most:
                tangent *= most / np.linalg.norm(tangent)
                s = -(tangent + ct * along) / kt
            force, torque = normal + tangent, -R * np.cross(n, tangent)
        else:
            s = np.zeros(3)
        v = v + H / m * np.array([force, -force])
        w = w + H / (0.4 * m * R * R) * torque
        x = x + H * v
        speeds.append(np.concatenate([v.ravel(), R * w.ravel()]))
    return x, np.array(speeds)


def glancing(lab):
    """The same law in double; and what no law of contact can change."""
    found, _ = of_grains(lab, ws.text_of("glancing"), "--every", 1)
    v = np.stack([found["v_x"], found["v_y"], 0 * found["v_x"]], -1)
    w = np.stack([0 * found["w"], 0 * found["w"], found["w"]], -1)
    x = np.stack([found["x_x"], found["x_y"], 0 * found["x_x"]], -1)
    places, speeds = gran_hooke_history(x[0], v[0], w[0], M, K, 1, KT, 0.5, 0.3, len(v) - 1)
    ours = np.concatenate([v.reshape(len(v), -1), R * w.reshape(len(v), -1)], 1)
    why = "500 roundings of 2^-24 of each speed and of 0.1 m in each place, which contact multiplies"
    yield row("glancing", "largest difference of a speed from the same law in double, m/s", 0, abs(ours - speeds).max(), 1e-5, why)
    yield row("glancing", "largest difference of a place in the end, m", 0, abs(x[-1] - places).max(), 1e-5, why)
    yield row("glancing", "momentum after, of m 1 m/s", 0, abs((v[-1] - v[0]).sum(0)).max(), 1e-5, "both evaluate the same expression: forces are exact negatives, and 500 roundings of 2^-24 are left")


def least(stands, low, high, parts):
    """With how much something stands, by halves down to a part: it must not with low, and must with high."""
    if stands(low) or not stands(high):
        return math.nan
    while high - low > parts:
        middle = (low + high) / 2
        low, high = (low, middle) if stands(middle) else (middle, high)
    return (low + high) / 2


def pyramid(lab):
    """Statics of three cylinders: contacts need friction tan(15 deg) between them, and a third of that on the floor (Timoshenko and Young,
    Engineering Mechanics, chapter 2: the upper one presses along lines of 30 deg, and each lower one, which does not turn, has the same drag on both sides)."""
    text = ws.text_of("pyramid")

    def stands(text):
        return of_grains(lab, text, "--steps", 4096)[0]["x_y"][-1, 1] > 0.13
    angle = math.tan(math.pi / 12)
    why = "balls are put down with overlaps that swing, so contacts slide a little at first; and how finely it is looked for"
    for what, old, expected in (("between balls", "x_y = 0.05; mu = 0.5", angle), ("on the floor", "set     = { mu = 0.5", angle / 3)):
        found = least(lambda mu: stands(ws.replace(text, old, old.replace("mu = 0.5", f"mu = {mu!r}"))), expected - 0.008, expected + 0.008, 0.02 if lab.quick else 5e-4)  # pylint: disable=cell-var-from-loop
        yield row("pyramid", f"friction {what} without which it falls", expected, found, 4e-3, why)
    found, times = of_grains(lab, text, "--steps", 8192, "--every", 2048)
    yield relative("pyramid", "force on the floor, N", 3 * M * G, K * (R - found["x_y"][-1, [0, 2]]).sum(), 1e-3, "a rounding of 2^-24 of 0.05 m in overlaps of 7e-5 m")
    creep = max(abs(found[name][-1] - found[name][-2]).max() for name in ("x_x", "x_y"))
    yield row("pyramid", f"how far a ball creeps in {times[-1] - times[-2]:g} s, m", 0, creep, 2e-6, "springs that remember hold: what still swings, and roundings of 2^-24 of 0.1 m")
