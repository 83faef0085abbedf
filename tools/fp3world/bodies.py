"""What theory says of the scenes, beside what their objects do: bodies that attract each other."""

import numpy as np
from fp3world import scene as ws
from fp3world.physics import relative, row


def energy(x, v, m, soft):
    """Of bodies with G 1."""
    first, second = np.triu_indices(len(x), 1)
    apart = ((x[first] - x[second]) ** 2).sum(1)
    return (m * (v ** 2).sum(1)).sum() / 2 - (m[first] * m[second] / np.sqrt(apart + soft ** 2)).sum()


def eight(lab):
    """Chenciner and Montgomery, Annals of Mathematics 152 (2000): after a period everybody is back."""
    found, times = lab.record(ws.text_of("eight"), "--every", 64)
    x, v = ws.vectors(found, "x"), ws.vectors(found, "v")
    why = "4,608 roundings of 2^-25 of x and of v, which come to 2e-6 by chance, and grow on the way"
    yield row("eight", "how far bodies are from where they were a period before", 0, np.linalg.norm(x[-1] - x[0], axis=1).max(), 1e-4, why)
    yield row("eight", "how far the middle body is from the crossing after half a period", 0, np.linalg.norm(x[len(x) // 2, 2]), 1e-4, why)
    third = x[len(x) // 3]
    yield row("eight", "how far bodies are from each other's places after a third of a period", 0,
              min(np.linalg.norm(third - x[0, order], axis=1).max() for order in ([1, 2, 0], [2, 0, 1])), 1e-4, why)
    energies = [energy(a, b, np.ones(3), 0) for a, b in zip(x, v)]
    yield row("eight", "largest change of energy", 0, max(abs(e - energies[0]) for e in energies), 2e-5, why)
    yield row("eight", "angular momentum", 0, max(abs(np.cross(a, b)[:, 2].sum()) for a, b in zip(x, v)), 2e-5, why)


def momentum(scene, relation, found, steps):
    """Of objects of equal mass that nothing holds; of all that moves."""
    v = ws.vectors(found, "v")
    moving = max(np.linalg.norm(at, axis=1).sum() for at in v)
    return row(scene, f"momentum gained in {steps} steps by `{relation}`, of the sum of all momenta", 0, max(np.linalg.norm(at.sum(0) - v[0].sum(0)) for at in v) / moving,
               8 * np.sqrt(steps) * 2.0 ** -24, "forces of a pair are exact negatives: what is left is a rounding of 2^-24 of a speed in each step, up or down")


def free(lab):
    """Objects of each kind of relation that nothing holds: Goldstein, Classical Mechanics, chapter 1."""
    steps = 512 if lab.quick else 4096
    text = ws.text_of("stars")
    found, _ = lab.record(text, "--every", steps // 8, "--steps", steps)
    yield momentum("stars", "all", found, steps)
    text = ws.replace(ws.text_of("net"), r"only    = [^;]*; set = [^;]*; };\n? *};", "set = { g_y = 0.0; }; only = { objects = 0; set = { v_x = 1.0; }; };")
    text = ws.replace(text, r"count = \[128, 128\]", "count = [24, 24]")
    found, _ = lab.record(text, "--every", steps // 8, "--steps", steps)
    yield momentum("net", "links", found, steps)
    text = ws.replace(ws.text_of("balls"), r"apart = 0.1", "apart = 0.08")
    text = ws.replace(text, "objects = 300;", "objects = 300; set = { g_y = 0.0; side = 1e6; };")
    text = ws.replace(text, r"from = \[[^]]*\]; to = \[[^]]*\]", "from = [500.0, 500.0, 500.0]; to = [500.6, 500.6, 500.6]")
    found, _ = lab.record(text, "--every", steps // 8, "--steps", steps)
    yield momentum("balls", "near", found, steps)


def plummer(lab):
    """Plummer's sphere (Monthly Notices 71, 1911) stays as it is: half of its mass is within 1.305 of its scale, which is 3 pi/16."""
    steps = 512 if lab.quick else 2048
    found, times = lab.record(ws.text_of("plummer"), "--every", 64, "--steps", steps)
    x, v = ws.vectors(found, "x"), ws.vectors(found, "v")
    m = np.full(400, 1 / 400)
    energies = [energy(a, b, m, 0.05) for a, b in zip(x, v)]
    yield relative("plummer", f"energy after {times[-1]:g} units of time", energies[0], energies[-1], 1e-4, "leapfrog: (h v/soft)^2/24 of those few pairs that are within the softening")
    spin = [np.cross(a, b).sum(0) / 400 for a, b in zip(x, v)]
    yield row("plummer", "change of angular momentum", 0, np.linalg.norm(spin[-1] - spin[0]), steps * 2.0 ** -24,
              "a kick along the line between two changes nothing: what is left is a rounding of 2^-24 of x v in each step")
    yield momentum("plummer", "all", found, steps)
    moving, total = (m * (v ** 2).sum(2)).sum(1) / 2, np.array(energies)
    later = slice(len(times) // 2, None)
    yield row("plummer", "kinetic energy, of what is bound", 0.5, (moving[later] / (moving[later] - total[later])).mean(), 0.02, "the virial theorem, for 400 bodies: 1/(2 sqrt(400)) of it by chance")
    half = np.median(np.linalg.norm(x[later] - np.median(x[later], axis=1, keepdims=True), axis=2), axis=1).mean()
    yield relative("plummer", "radius that has half of the mass", 1.305 * 3 * np.pi / 16, half, 0.08, "400 bodies: the radius of the 200th is uncertain by 1/sqrt(400) of itself; softening makes it some percent larger")


def planets(lab):
    """Kepler's third law, for a year: Goldstein, Classical Mechanics, chapter 3. The angle around the sun is 2 pi sqrt(1 + m) t/a^1.5."""
    found, times = lab.record(ws.text_of("planets"), "--every", 32)
    m, *_ = np.loadtxt(ws.FOLDER / "planets.csv", delimiter=",", skiprows=3).T
    x, v = ws.vectors(found, "x"), ws.vectors(found, "v")
    for body, name in ((1, "mercury"), (3, "the earth"), (5, "jupiter")):
        way = x[:, body] - x[:, 0]
        turned = np.unwrap(np.arctan2(way[:, 1], way[:, 0]))
        yield relative("planets", f"angle of {name} in a year", 2 * np.pi * np.sqrt(1 + m[body]) / np.linalg.norm(way[0]) ** 1.5 * times[-1], turned[-1] - turned[0], 1e-4,
                       "jupiter, 1e-3 of the sun and 4 au away, pulls at the others and at the sun")
    energies = [energy(a, b / np.sqrt(39.478418), m, 0) for a, b in zip(x, v)]
    yield relative("planets", "energy after a year, of G and the sun's mass over au", energies[0], energies[-1], 2e-5, "rk4 errs by (w h)^4/120 of a turn of mercury, and 2,048 roundings of 2^-25 in each planet's x and v")
    momentum_of = m @ v[-1] - m @ v[0]
    yield row("planets", "change of momentum in a year, of the sum of all momenta", 0, np.linalg.norm(momentum_of) / (m * np.linalg.norm(v[0], axis=1)).sum(), 8 * np.sqrt(2048) * 2.0 ** -24,
              "a rounding of 2^-24 of the sun's speed in each step, up or down; forces of unequal masses differ by one more")
