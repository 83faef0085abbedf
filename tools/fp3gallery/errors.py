"""How far what a scene of the gallery gives is from what it should give.

Each function yields rows with what is said, what is expected and what is found. Scenes of programs/world have the rows of
tools/world.py. What is expected of the others comes from a closed form, from a published value, or from the model's equations,
which tools/ode_reader.py reads, by rk4 in double with a quarter of the step.
"""

import re

import numpy as np
import ode_reader
from fp3bodies import scene as lab_scene
from fp3bodies import standing
from fp3gallery import recorded
from fp3world import bodies
from fp3world import contact
from fp3world import physics
from fp3world import scene as ws
from fp3world import water

FINER = 4


def row(what, expected, found):
    return {"what": what, "expected": None if expected is None else float(expected), "found": float(found)}


# ---- runs, and the same in double ----

def record(lab, scene, *options):
    return ws.record(lab.fp3, ws.put(lab.folder, scene.text(lab.folder), scene.name), *options)


def in_double(scene, found, start, steps, every):
    """[snapshot, state, object]: the model's equations from where the recording begins, by rk4."""
    text = scene.path.read_text(encoding="utf-8")
    model = ode_reader.read(scene.folder / re.search(r'program *= "(.*?)"', text)[1])
    params = {name: np.float32(value).astype(float) for name, value in model.params.items()}
    given = dict(re.findall(r"(\w+) = ([\d.e+-]+);", re.search(r"\bset += \{(.*?)\}", text)[1]))
    params |= {name: np.float32(float(value)).astype(float) for name, value in given.items() if name in params}
    h, y = float(np.float32(float(given["h"]))) / FINER, np.array([found[name][start] for name in model.names])
    rows = [y]
    for n in range(steps * FINER):
        k = []
        for share in (0, 0.5, 0.5, 1):
            k.append(model.slopes((n + share) * h, y + share * h * k[-1] if k else y, params))
        y = y + h / 6 * (k[0] + 2 * k[1] + 2 * k[2] + k[3])
        if (n + 1) % (every * FINER) == 0:
            rows.append(y)
    return np.array(rows), model.names


def apart(found, truth, names, shown):
    """[snapshot, object]: the distance of these states."""
    return np.sqrt(sum((found[name][:len(truth)] - truth[:, names.index(name)]) ** 2 for name in shown))


def chaotic(distance, times, one, looks, at, off, unit):
    """What is left of a prediction: the worst object at some times, and when the first and half of all are far off. at: how a time is said."""
    for t in looks:
        yield row(f"largest distance of {one} from where it is in double, {at.format(t)}", 0, distance[np.searchsorted(times, t * 0.999999)].max())
    for which, of_all in ((f"when the first {one.split()[-1]} is", distance.max(1)), ("when half of them are", np.median(distance, 1))):
        late = np.flatnonzero(of_all > off[0])
        if len(late):
            yield row(f"{which} {off[0]:g}{off[1]} off, {unit}", None, times[late[0]])


# ---- scenes of their own ----

def flag(lab, scene, steps=512):
    found, _ = record(lab, scene, "--every", steps, "--steps", steps)
    h, m, air, c, wave = 2.0 ** -10, *(float(np.float32(x)) for x in (0.001, 0.004, 0.005, 6.2831853 / 0.9))
    count = (20, 32)
    springs = physics.springs_of_grid(count, 0.05, [(["structural", "shear"], 100), (["bending"], 10)])
    x, v = ws.vectors(found, "x")[0], ws.vectors(found, "v")[0]
    moves = (np.arange(len(x)) >= count[0])[:, None]
    for n in range(steps):
        wind = np.zeros_like(x)
        wind[:, 0], wind[:, 2] = 6, 3 * np.sin(wave * (x[:, 0] - 6 * n * h))
        v = v + h * moves * ((springs.forces(x, v, c) + air * (wind - v)) / m + np.array([0, -9.81, 0]))
        x = x + h * v
    yield row(f"largest difference of a coordinate from the same {steps} steps in double, m", 0, abs(ws.vectors(found, "x")[-1] - x).max())


def bobs(found):
    """Places of both masses of double pendulums."""
    x, y = np.sin(found["a1"]), -np.cos(found["a1"])
    return x, y, x + np.sin(found["a2"]), y - np.cos(found["a2"])


def pendulums(lab, scene):
    found, times = record(lab, scene, "--every", 64, "--observe", "w1,w2,a1,a2,energy")
    truth, names = in_double(scene, found, 0, 8192, 64)
    *_, x, y = bobs(found)
    *_, true_x, true_y = bobs({name: truth[:, names.index(name)] for name in names})
    yield row("largest change of the energy in 8 s, J", 0, abs(found["energy"] - found["energy"][0]).max())
    yield from chaotic(np.hypot(x - true_x, y - true_y), times, "a lower mass", (2, 4), "after {} s, m", (0.1, " m"), "s")


def arenstorf(lab, scene):
    found, _ = record(lab, scene, "--observe", "r_x,r_y,jacobi", "--times", f"0,{17.0652165601579625588917206249!r}")
    x, y, jacobi = (abs(found[name][-1] - found[name][0])[0] for name in ("r_x", "r_y", "jacobi"))
    yield row("distance from the start after a period, as a share of the moon's distance", 0, np.hypot(x, y))
    yield row("change of Jacobi's integral after a period", 0, jacobi)


def van_der_pol(lab, scene):
    """The test set for initial value problem solvers (Mazzia and Magherini, Bari, 2008) has the solution at 2000."""
    found, _ = record(lab, scene, "--times", "0,2000")
    yield row("x at t = 2000, as the Test Set for Initial Value Problem Solvers has it", 1.706167732170469, found["x"][-1, 0])


def duffing(lab, scene):
    found, _ = record(lab, scene, "--every", 256, "--steps", 256 * 30)
    truth, names = in_double(scene, found, 0, 256 * 30, 256)
    yield from chaotic(apart(found, truth, names, ["x", "v"]), np.arange(len(truth)), "an oscillator", (2, 5), "after {} periods", (0.1, ""), "periods")


def ships(lab, scene):
    """Of v' = (T - C v)/m from rest, after as many seconds as a ship has been under way."""
    found, times = record(lab, scene)
    m, c, thrust = 8.7e5, 4.1e4, np.float32(np.linspace(1.2e5, 3.6e5, 48)).astype(float)
    t = times[-1] - np.arange(48) * 235 // 47
    true_v = thrust / c * (1 - np.exp(-c * t / m))
    true_s = thrust / c * (t - m / c * (1 - np.exp(-c * t / m)))
    yield row("largest relative error of a speed at the end", 0, abs(found["v"][-1] / true_v - 1).max())
    yield row("largest relative error of a distance at the end", 0, abs(found["s"][-1] / true_s - 1).max())


def lorenz(lab, scene):
    found, times = record(lab, scene, "--every", 64)
    truth, names = in_double(scene, found, 0, 16384, 64)
    yield from chaotic(apart(found, truth, names, ["x", "y", "z"]), times, "a point", (1, 8), "at t = {}", (1, ""), "units of time")


# ---- all of them ----

# Of the scenes of programs/world: the function, the first words of the rows, and what they are called here, if not so.
WORLD = {"heap": (contact.heap, {"force on the floor": ""}),
         "plummer": (bodies.plummer, {"energy after": "", "change of angular momentum": "",
                                            "radius that has": "radius within which half of the mass is, mean from t = 4 on"}),
         "dam": (water.dam, {"speed of the front": "speed of the front from t = 1.3 on, in sqrt(2 g a)", "largest change of density": ""}),
         "eight": (bodies.eight, {"how far bodies are from where they were": "largest distance of a body from its start, after a period",
                                        "largest change of energy": ""}),
         "chain": (physics.chain, {"angular frequency of mode 1,": "", "largest error of the 32": "largest relative error of the 32 frequencies"})}
OWN = {function.__name__: function for function in (flag, pendulums, arenstorf, van_der_pol, duffing, ships, lorenz)}


def of(lab, scene):
    if scene.name in OWN:
        yield from OWN[scene.name](lab, scene)
        return
    check, words = WORLD[scene.name]
    for found in check(lab):
        for word, name in words.items():
            if found["what"].startswith(word):
                yield row(name or found["what"], found["expected"], found["found"])


# ---- rigid bodies ----

def pyramid(found):
    """Bricks are what has four corners, behind the ground."""
    bricks = [lab_scene.Body("box", (0.5, 0.5), (0.0, 0.0))] * 820
    yield row("deepest overlap of two bricks after 10 s, m", 0, standing.deepest(lab_scene.Scene("", bricks), found.x[-1, 1:821], found.angle[-1, 1:821]))


def ragdolls(found):
    yield row("largest distance ever of both points of a hinge, m", 0, found.gap())


def car(found):
    yield from ragdolls(found)


def dominoes(found):
    """Each is 0.2 m thick and 2 m high, and 0.8 m from the next one."""
    begins = [np.interp(0.05, -found.angle[:, k], found.times) for k in (21, 41)]
    yield row("speed of the run, m/s", None, 20 / (begins[1] - begins[0]))


def tumbler(found):
    turn = found.angle[-1, 0]
    own = found.x[-1, 1:] @ np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    yield row("how many of 400 bodies have left the drum after 20 s", 0, (abs(own).max(1) > 9.5).sum())


def castle(found):
    """Bricks are behind the ground, layer by layer."""
    yield row("how many of 144 bricks have come down by a layer after 8 s", None, (found.x[-1, 1:145, 1] < found.x[0, 1:145, 1] - 0.5).sum())


def agm(a, b):
    while abs(a - b) > 1e-15 * a:
        a, b = (a + b) / 2, np.sqrt(a * b)
    return a


def top(found):
    """Two boxes of density 1; Euler's equations have a solution, in which each half period of sn is a flip (Landau and Lifshitz, Mechanics, section 37)."""
    boxes = [(np.array(half), high - 0.5 * 0.032 / 0.096) for half, high in (((0.8, 0.1, 0.1), 0), ((0.1, 0.4, 0.1), 0.5))]
    inertia = sum(8 * half.prod() * ((half @ half - half ** 2) / 3 + high ** 2 * np.array([1, 0, 1])) for half, high in boxes)
    spins = np.einsum("tk,tkj->tj", found.spin[:, 0], found.axes[:, 0])
    energy, turn = (spins ** 2 @ inertia), np.linalg.norm(spins * inertia, axis=1)
    low, middle, high = np.sort(inertia)
    if turn[0] ** 2 < energy[0] * middle:
        low, high = high, low
    rate = (high - middle) * (turn[0] ** 2 - energy[0] * low)
    share = (middle - low) * (energy[0] * high - turn[0] ** 2) / rate
    between = np.pi / agm(1, np.sqrt(1 - share)) / np.sqrt(rate / (low * middle * high))
    up = found.axes[:, 0, 1, 1]
    flips = [found.times[n] - up[n] * (found.times[n + 1] - found.times[n]) / (up[n + 1] - up[n]) for n in np.flatnonzero(up[1:] * up[:-1] < 0)]
    yield row("time between two flips, s: the mean of 40 s", between, (flips[-1] - flips[0]) / (len(flips) - 1))
    yield row("largest relative change of energy", 0, abs(energy / energy[0] - 1).max())
    yield row("largest relative change of angular momentum", 0, abs(turn / turn[0] - 1).max())


def tippe(found):
    """Friction at one point of a sphere keeps the angular momentum along the way from there to the centre of mass (Jellett, 1872)."""
    masses, centre = np.array([0.2, 2 * 0.5 ** 3]) * 4 / 3 * np.pi, np.array([0, -0.3])
    low = masses @ centre / masses.sum()
    about = masses @ (0.4 * np.array([1, 0.25]))
    across = about + masses @ (centre - low) ** 2
    axis = found.axes[:, 1, :, 1]
    along = (found.spin[:, 1] * axis).sum(1)[:, None] * axis
    kept = ((about * along + across * (found.spin[:, 1] - along)) * ([0, 1, 0] + low * axis)).sum(1)
    yield row("cosine of the top's tilt after 8 s", None, axis[-1, 1])
    yield row("largest relative change of Jellett's integral", 0, abs(kept / kept[0] - 1).max())


OF_BODIES = {function.__name__: function for function in (pyramid, ragdolls, car, dominoes, tumbler, castle, top, tippe)}


def of_bodies(fp3, folder, scene):
    """With a snapshot of each step."""
    yield from OF_BODIES[scene.name](recorded.recording_of(fp3, folder, scene, "--every", 1))
