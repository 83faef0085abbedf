"""What theory says of the scenes, beside what their objects do: friction that remembers how far a contact is stretched."""

import math
import re

import numpy as np
from fp3world import granular
from fp3world import scene as ws
from fp3world.physics import relative, row

R, M, K, KT, G = 0.05, 0.01, 2000, 1000, 9.81


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


def glancing(lab):
    """The same law by LAMMPS, in double, at three steps (granular.py); and what no law of contact can change."""
    why = "some hundred roundings of 2^-24 of each speed, and of 0.1 m in an overlap of 2 mm, which contact multiplies"
    for part in granular.table()["glancing"]:
        text = ws.replace(ws.text_of("glancing"), "steps = 1024;", f"steps = {round(0.25 / part['h'])};")
        text = ws.replace(text, 'integrator = "semi_implicit_euler";', 'integrator = "semi_implicit_euler"; compensated = true;')
        text = re.sub(r"(?<=set     = \{)", f" h = {part['h']!r};", text)
        found, times = of_grains(lab, text, "--every", round(granular.EVERY / part["h"]))
        theirs = np.array(part["rows"])
        ours = np.stack([found[name] for name in ("x_x", "x_y", "v_x", "v_y", "w")], -1)
        off = abs(ours[np.searchsorted(times, theirs[:, 0])] - theirs[:, 1:].reshape(-1, 2, 5)).max((0, 1))
        for what, most in (("place from LAMMPS, of R", off[:2].max() / R), ("speed from LAMMPS, of 1 m/s", off[2:4].max()), ("surface's speed from LAMMPS, of 1 m/s", R * off[4])):
            yield row("glancing", f"largest difference of a {what}, at h = 1/{1 / part['h']:.0f} s", 0, most, 1e-5, why)
    v = ours[:, :, 2:4]
    yield row("glancing", "momentum after, of m 1 m/s", 0, abs((v[-1] - v[0]).sum(0)).max(), 1e-5,
              "both evaluate the same expression: forces are exact negatives, and some hundred roundings of 2^-24 are left")


def heaped(lab, seed, mu=granular.MU):
    """Where the balls of granular.Pile end."""
    pile = granular.Pile(seed)
    points = lab.folder / "points.csv"
    points.write_text("x_x,x_y\n" + "".join(f"{x:.9g},{y:.9g}\n" for x, y in pile.x), encoding="utf-8")
    text = f"""steps = {pile.steps}; groups = (
        {{ program = "{ws.FOLDER}/grains.ode"; integrator = "semi_implicit_euler"; points = "points.csv"; set = {{ mu = {mu!r}; }};
           only = {{ objects = "0..{granular.HELD - 1}"; set = {{ loose = 0.0; turn = 0.0; }}; }}; }},
        {{ program = "{ws.FOLDER}/floor.ode"; integrator = "euler"; objects = 1; set = {{ x_y = {granular.BELOW}; mu = {mu!r}; }}; }} );"""
    found, _ = of_grains(lab, text, "--every", pile.steps)
    return np.stack([found[name][-1, granular.HELD:] for name in ("x_x", "x_y")], -1)


def pile(lab):
    """Heaps of the same starts by LAMMPS (granular.py); chaos keeps no single place, so the mean angle of some heaps is compared."""
    expected = np.array(granular.table()["pile"])
    found = np.array([granular.Pile.angle(heaped(lab, seed)) for seed in granular.SEEDS[:1 if lab.quick else None]])
    yield row("pile", f"angle of repose, mean of {len(found)} heaps of {granular.BALLS} balls on a rough plate, degrees", expected.mean(), found.mean(), 1,
              f"one heap differs from another by {expected.std(ddof=1):.2f} in LAMMPS and by {found.std(ddof=1) if len(found) > 1 else 0:.2f} here, one standard deviation")


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
