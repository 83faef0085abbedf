"""What theory says of rigid bodies, beside what an engine's bodies do.

A truth is a function of `make`, which makes an engine of a scene, and yields rows (what, expected, found, within). Its first line names the
source; formulas.py has what is computed. An engine that has not what a scene needs refuses the truth and says what.
"""

import dataclasses
import math

import numpy as np
from fp3bodies import formulas
from fp3bodies import scene as sc
from fp3bodies.scene import Body, Pin, Scene, ground

G = 10.0
SECOND = round(1 / sc.STEP)
DOWN = (0.0, -G)


def relative(what, expected, found, share):
    return what, expected, found, share * abs(expected)


def path(engine, seconds, of=lambda engine: engine.places()):
    """What is seen after each step."""
    found = []
    for _ in range(round(seconds * SECOND)):
        engine.step()
        found.append(of(engine))
    return np.array(found)


def turned(angle, x, y):
    c, s = math.cos(angle), math.sin(angle)
    return c * x - s * y, s * x + c * y


def on_slope(angle, shape, size, high, friction, **more):
    """A body on a long slope that goes down to the right, made by turning everything."""
    at = {"angle": -angle, "friction": friction}
    return Scene("slope", [Body("box", (100.0, 1.0), turned(-angle, 80.0, -1.0), fixed=True, **at), Body(shape, size, turned(-angle, 0.0, high), **at, **more)])


def edge(stands, low, high, parts):
    """With how much something stands, by halves down to a part: it must not with low, and must with high."""
    if stands(low) or not stands(high):
        return math.nan
    while high - low > parts:
        middle = (low + high) / 2
        low, high = (low, middle) if stands(middle) else (middle, high)
    return (low + high) / 2


# ---- friction ----

def slope(make):
    """Coulomb; Goldstein, Classical Mechanics, chapter 1"""
    angle, t = math.pi / 6, 3.5
    engine = make(on_slope(angle, "box", (0.5, 0.25), 0.25, 0.3))
    engine.step(SECOND // 2)  # what it does when it is put down is no question of friction
    begin, speed = engine.places()[1], engine.speeds()[1]
    engine.step(round(t * SECOND))
    found = engine.places()[1] - begin - speed * t
    yield relative("how far a block slides in 3.5 s on 30 degrees, friction 0.3, m", formulas.slid(angle, 0.3, G, t), float(np.hypot(*found)), 2e-3)
    engine = make(on_slope(angle, "box", (0.5, 0.25), 0.25, 0.6))
    engine.step(SECOND)
    begin = engine.places()[1]
    engine.step(10 * SECOND)
    yield "how far it creeps in 10 s with friction 0.6, m", formulas.slid(angle, 0.6, G, 10), float(np.hypot(*(engine.places()[1] - begin))), 1e-4


def braking(make):
    """Goldstein, Classical Mechanics, chapter 1"""
    engine = make(Scene("braking", [ground(20.0, friction=0.5), Body("box", (0.5, 0.25), (0.0, 0.25), v=(5.0, 0.0), friction=0.5)]))
    engine.step(2 * SECOND)
    yield relative("how far a block slides at 5 m/s, friction 0.5, m", formulas.braked(5.0, 0.5, G), float(engine.places()[1, 0]), 5e-3)


def slide_and_roll(make):
    """Landau and Lifshitz, Mechanics, section 38"""
    speed, friction, t = 6.0, 0.2, 3
    for name, down, share in (("disc", DOWN, 0.5), ("sphere", (*DOWN, 0.0), 0.4)):
        level = ground(30.0, friction=friction) if share == 0.5 else Body("box", (30.0, 1.0, 5.0), (0.0, -1.0, 0.0), fixed=True, friction=friction)
        more = (0.0,) * (len(down) - 2)
        ball = Body("disc", (0.5,), (0.0, 0.5, *more), v=(speed, 0.0, *more), friction=friction, w=(0.0,) * 3 if more else 0.0)
        engine = make(Scene(name, [level, ball], gravity=down))
        engine.step(t * SECOND)
        end, far = formulas.rolled(speed, friction, G, share, t)
        yield relative(f"speed of a {name} that slid at 6 m/s when it rolls, m/s", end, float(engine.speeds()[1, 0]), 1e-4)
        yield relative(f"how far that {name} comes in 3 s, m", far, float(engine.places()[1, 0]), 5e-3)


def roll_down(make):
    """Landau and Lifshitz, Mechanics, section 38"""
    angle, t = math.radians(20), 3
    engine = make(on_slope(angle, "disc", (0.5,), 0.5, 0.5))
    engine.step(t * SECOND)
    yield relative("acceleration of a disc down 20 degrees, m/s^2", formulas.rolling(angle, G, 0.5), float(np.hypot(*engine.speeds()[1])) / t, 2e-3)
    flat = on_slope(angle, "disc", (0.5,), 0.5, 0.5)
    half = dataclasses.replace(flat.bodies[0], size=(100.0, 1.0, 5.0), at=(*flat.bodies[0].at, 0.0), q=(math.cos(angle / 2), 0.0, 0.0, -math.sin(angle / 2)))
    engine = make(Scene("sphere", [half, dataclasses.replace(flat.bodies[1], at=(*flat.bodies[1].at, 0.0), w=(0.0,) * 3)], gravity=(*DOWN, 0.0)))
    engine.step(t * SECOND)
    yield relative("acceleration of a sphere down 20 degrees, m/s^2", formulas.rolling(angle, G, 0.4), float(np.linalg.norm(engine.speeds()[1])) / t, 2e-3)


def cone(make):
    """Coulomb's cone is round; Goldstein, Classical Mechanics, chapter 1"""
    far = []
    for k in range(8):
        way = math.cos(k * math.pi / 4), math.sin(k * math.pi / 4)
        block = Body("box", (0.5, 0.1, 0.5), (0.0, 0.1, 0.0), v=(5.0 * way[0], 0.0, 5.0 * way[1]), w=(0.0,) * 3, friction=0.5)
        engine = make(Scene("cone", [Body("box", (20.0, 1.0, 20.0), (0.0, -1.0, 0.0), fixed=True, friction=0.5), block], gravity=(*DOWN, 0.0)))
        engine.step(2 * SECOND)
        x = engine.places()[1]
        far.append(float(x[0] * way[0] + x[2] * way[1]))
    expected = formulas.braked(5.0, 0.5, G)
    yield relative("the farthest a block slides at 5 m/s in eight directions, m", expected, max(far), 5e-3)
    yield relative("the least far, m", expected, min(far), 5e-3)


def belt(make):
    """Coulomb, and a spring: den Hartog, Mechanical Vibrations, chapter 7, with one coefficient of friction"""
    stiff, speed, friction = 20.0, 0.5, 0.4
    engine = make(Scene("belt", [Body("box", (40.0, 1.0), (0.0, -1.0), v=(speed, 0.0), moving=True, friction=friction),
                                 Body("box", (0.5, 0.25), (0.0, 0.25), v=(speed, 0.0), friction=friction, mass=1.0)]))
    most = 0.0
    for _ in range(8 * SECOND):
        x = float(engine.places()[1, 0])
        most = max(most, x)
        engine.push(1, (-stiff * x, 0.0))
        engine.step()
    yield relative("how far a belt takes a block on a spring, m", formulas.swing(friction, G, stiff, 1.0, speed), most, 1e-2)


# ---- impacts ----

def bounces(make):
    """Newton's law of restitution; Goldsmith, Impact, chapter 1"""
    high = 5.0
    for e in (0.2, 0.4, 0.6, 0.8, 1.0):
        engine = make(Scene("bounce", [ground(10.0, restitution=e, friction=0.0), Body("disc", (0.5,), (0.0, 0.5 + high), restitution=e, friction=0.0)]))
        y, v = path(engine, 6, lambda engine: (engine.places()[1, 1] - 0.5, engine.speeds()[1, 1])).T
        rises = [k + 1 for k in range(len(v) - 1) if v[k] <= 0 < v[k + 1]]
        for number in (1, 2):
            flight = slice(*rises[number - 1:number + 1]) if len(rises) > number else slice(0, 0)
            k = np.argmin(abs(v[flight])) if len(v[flight]) else None
            top = 0.0 if k is None else float(y[flight][k] + v[flight][k] ** 2 / (2 * G))  # no step ends at the top
            yield relative(f"top {number} of a ball that falls 5 m, restitution {e:g}, m", e ** (2 * number) * high, top, 1e-2)


def cradle(make):
    """Newton's cradle: the last of five equal balls leaves with the first one's speed; Herrmann and Schmälzle, American Journal of Physics 49, 761 (1981)"""
    for name, apart in (("with gaps", 0.1), ("touching", 0.0)):
        balls = [Body("disc", (0.5,), (k * (1.0 + apart) - (1.0 if k == 0 else 0.0), 0.0), v=(3.0 if k == 0 else 0.0, 0.0), restitution=1.0, friction=0.0)
                 for k in range(5)]
        engine = make(Scene("cradle", balls, gravity=(0.0, 0.0)))
        engine.step(2 * SECOND)
        v = engine.speeds()[:, 0]
        yield relative(f"speed of the last of five balls {name}, m/s", 3.0, float(v[4]), 1e-3)
        yield f"the largest speed of the others {name}, m/s", 0.0, float(abs(v[:4]).max()), 3e-3


def cube_of_balls(make):
    """6 x 6 x 6 balls as in SimBenchmark (leggedrobotics.github.io/SimBenchmark, "666" and "elastic 666"): rigid ones do not overlap, elastic ones keep their energy"""
    place, r = np.random.default_rng(1), 0.5
    surface = {"friction": 0.0, "restitution": 0.0}

    def cube(high):
        balls = [Body("disc", (r,), tuple(1.02 * np.array(at) + (0.0, high, 0.0) + place.uniform(-0.01, 0.01, 3)), density=10.0 / (4 / 3 * math.pi * r ** 3), **surface)
                 for at in np.ndindex(6, 6, 6)]
        return make(Scene("cube of balls", [Body("box", (200.0, 1.0, 200.0), (0.0, -1.0, 0.0), fixed=True, **surface), *balls], gravity=(*DOWN, 0.0)))
    deep = path(cube(0.5), 5, lambda engine: overlap(engine.places()[1:], r))
    yield "mean overlap of those of 216 balls that overlap, in 5 s, of their radius", 0.0, float(deep.mean()), 0.01
    surface["restitution"] = 1.0
    energy = path(cube(1.5), 5, lambda engine: (engine.speeds()[1:] ** 2).sum() / 2 + G * engine.places()[1:, 1].sum())
    yield "change of the energy of 216 elastic balls in 5 s, as a share", 0.0, float(abs(energy / energy[0] - 1).max()), 0.01


def overlap(x, r):
    """The mean of all pairs of balls that overlap, the floor among them, in radii."""
    first, second = np.triu_indices(len(x), 1)
    deep = np.concatenate([2 * r - np.linalg.norm(x[first] - x[second], axis=1), r - x[:, 1]])
    return deep[deep > 0].mean() / r if (deep > 0).any() else 0.0


def wall(make):
    """Nothing passes through a wall"""
    scene = sc.bullets()
    engine = make(scene)
    engine.step(SECOND)
    yield "how many of 20 bullets of 50 to 430 m/s a wall of 0.1 m stops", len(scene.bodies) - 1, int((engine.places()[1:, 0] < 0.05).sum()), 0


# ---- joints ----

def pendulum(make):
    """Landau and Lifshitz, Mechanics, section 11"""
    r, length, angle = 0.1, 1.0, 1.0
    bob = Body("disc", (r,), (length * math.sin(angle), -length * math.cos(angle)), angle=angle, mass=1.0)
    engine = make(Scene("pendulum", [bob], [Pin(-1, 0, (0.0, 0.0))]))
    x = path(engine, 28)[:, 0, 0]
    crossings = [k + x[k] / (x[k] - x[k + 1]) for k in range(len(x) - 1) if x[k] > 0 >= x[k + 1]]
    found = (crossings[-1] - crossings[0]) / (len(crossings) - 1) * sc.STEP if len(crossings) > 1 else math.nan
    yield relative("period of a pendulum of 1 m from 1 rad, s", formulas.period(r * r / 2 + length ** 2, 1.0, length, G, angle), found, 1e-4)
    last = abs(x[-2 * SECOND:]).max()
    yield relative("its amplitude after 26 s, of that at first", 1.0, float(last / math.sin(angle)), 5e-3)


def double_pendulum(make):
    """Lagrange's equations in reduced coordinates, in double; Landau and Lifshitz, Mechanics, section 5"""
    angle = math.pi / 2
    rods = [Body("box", (0.5, 0.05), (k + 0.5, 0.0), mass=1.0, inertia=(1 / 12,)) for k in range(2)]
    for substeps in (4, 16):
        engine = make(Scene("double pendulum", rods, [Pin(-1, 0, (0.0, 0.0)), Pin(0, 1, (1.0, 0.0))], substeps=substeps))
        engine.step(3 * SECOND)
        a, b = formulas.rods((angle, angle), 1.0, 1 / 12, 1.0, G, 3.0)[-1]
        tip = np.array([math.sin(a) + math.sin(b), -math.cos(a) - math.cos(b)])
        turn = float(engine.turns()[1])
        found = engine.places()[1] + 0.5 * np.array([math.cos(turn), math.sin(turn)])
        yield f"how far the tip of a double pendulum is off after 3 s, {substeps} substeps, m", 0.0, float(np.hypot(*(found - tip))), 0.02


def hanging_chain(make):
    """Statics of rods between two pins, which a catenary is the limit of: Goldstein, Classical Mechanics, chapter 2"""
    count, length, span = 20, 0.25, 3.0
    slopes, along = formulas.hung(count, length, G, span)
    angles = np.arctan(slopes)
    ends = np.concatenate([[[0.0, 0.0]], np.cumsum(length * np.stack([np.cos(angles), np.sin(angles)], 1), 0)])
    rods = [Body("box", (length / 2, 0.02), tuple((ends[k] + ends[k + 1]) / 2), angle=float(angles[k]), mass=1.0) for k in range(count)]
    pins = [Pin(k - 1, k, tuple(ends[k])) for k in range(count)] + [Pin(-1, count - 1, tuple(ends[count]))]
    engine = make(Scene("hanging chain", rods, pins))
    engine.step(2 * SECOND)
    low = path(engine, 3)[:, :, 1].min(1).mean()
    expected = min(rod.at[1] for rod in rods)
    yield relative("sag of a chain of 20 rods, 5 m over 3 m, m", -expected, -float(low), 5e-3)
    yield from pulled("what its end carries, N", [math.hypot(along, count * G / 2)], engine, [0], 5e-3)


def pulled(what, expected, engine, pins, share):
    """The pull that differs most from what it should be, as its mean of a second. No row where an engine does not tell it."""
    try:
        engine.pulls()
    except sc.Refused:
        return
    found = path(engine, 1, lambda engine: engine.pulls()[pins]).mean(0)
    worst = int(np.argmax(abs(found - expected) / expected))
    yield relative(what, float(expected[worst]), float(found[worst]), share)


def heavy_end(make):
    """Statics"""
    links, end = 20, 1000.0
    engine = make(sc.chain(links, heavy=end))
    engine.step(4 * SECOND)
    low = path(engine, 2)[:, links, 1].mean()
    yield "stretch of a chain of 20 links of 1 kg with 1,000 kg at its end, of its length", 0.0, float(-low / links - 1), 1e-2
    pins = list(range(links + 1))
    yield from pulled("what its pins carry, N: the worst", [formulas.tension(k, links, 1.0, end, G) for k in pins], engine, pins, 1e-3)


def heavy_end_in_space(make):
    """Statics"""
    links, end = 20, 1000.0
    engine = make(dataclasses.replace(sc.lifted(sc.chain(links, heavy=end)), planar=False))
    engine.step(4 * SECOND)
    x = path(engine, 2)[:, links]
    yield "stretch of that chain in space, of its length", 0.0, float(np.linalg.norm(x, axis=1).mean() / links - 1), 1e-2
    pins = list(range(links + 1))
    yield from pulled("what its balls carry, N: the worst", [formulas.tension(k, links, 1.0, end, G) for k in pins], engine, pins, 1e-3)


# ---- what stands and what falls ----

def tipping(make):
    """A block tips where the slope's tangent is its width by its height: Timoshenko and Young, Engineering Mechanics, chapter 1"""
    wide, high = 0.5, 1.0

    def stands(tangent):
        down = G / math.hypot(1, tangent)
        block = Body("box", (wide / 2, high / 2), (0.0, high / 2), friction=2.0)
        engine = make(Scene("tipping", [ground(20.0, friction=2.0), block], gravity=(-tangent * down, -down)))
        engine.step(6 * SECOND)
        return abs(float(engine.turns()[1])) < 0.3
    yield relative("tangent at which a block of 0.5 x 1 m tips", wide / high, -edge(lambda tangent: stands(-tangent), -0.55, -0.45, 5e-4), 5e-3)


def arch(make):
    """Milankovitch; Heyman, The Stone Skeleton, chapter 2: a line of thrust must stay inside, at the joints that there are"""
    parts, radius = 12, 10.0

    def stands(thick):
        engine = make(voussoirs(parts, radius, thick))
        engine.step(10 * SECOND)
        return float(engine.places()[1:, 1].max()) > 0.9 * radius
    expected = formulas.thinnest(parts)
    found = edge(stands, 0.7 * expected, 1.4 * expected, 0.01 * expected)
    yield relative("thickness, of the radius, below which an arch of 12 stones falls", expected, found, 5e-2)


def voussoirs(parts, radius, thick):
    stones = [ground(2 * radius, friction=1.0)]
    inner, outer = radius * (1 - thick / 2), radius * (1 + thick / 2)
    for k in range(parts):
        a, b = math.pi * k / parts, math.pi * (k + 1) / parts
        corners = np.array([[r * math.cos(t), r * math.sin(t)] for r, t in ((inner, a), (outer, a), (outer, b), (inner, b))])
        centre = np.array(sc.polygon(corners)[1])
        stones.append(Body("polygon", tuple(map(tuple, corners - centre)), tuple(centre), friction=1.0))
    return Scene("arch", stones)


def domino_run(make):
    """van Leeuwen, physics/0401018, without friction, pinned at the corner about which each turns"""
    h, d, count = sc.DOMINO["high"], sc.DOMINO["thick"], 30
    for apart in (0.2, 0.35, 0.5):
        engine = make(sc.dominoes(count, apart))
        angle = abs(path(engine, 6, lambda engine: engine.turns()[1:]))
        begins = []
        for k in (15, 25):
            after = int(np.argmax(angle[:, k] > 0.05))
            before = angle[after - 1, k]
            begins.append(after - 1 + (0.05 - before) / (angle[after, k] - before))
        found = 10 * (d + apart) / ((begins[1] - begins[0]) * sc.STEP) if begins[1] > begins[0] else 0.0
        yield relative(f"speed of a run of dominoes of 1 x 0.15 m, {apart:g} m apart, m/s", formulas.wave(h, d, apart, G), found, 0.1)


# ---- tops ----

def vector(q, x):
    """From a body's axes to the world's."""
    w, v = q[0], np.array(q[1:])
    return x + 2 * np.cross(v, np.cross(v, x) + w * x)


def free_top(make):
    """Landau and Lifshitz, Mechanics, section 37 (Dzhanibekov's nut)"""
    moments, spin = (0.1, 0.2, 0.3), (0.05, 5.0, 0.05)
    top = Body("box", (0.3, 0.2, 0.1), (0.0, 0.0, 0.0), w=spin, mass=1.0, inertia=moments)
    engine = make(Scene("free top", [top], gravity=(0.0, 0.0, 0.0), step=sc.STEP))

    def seen(engine):
        q, w = engine.turns()[0], engine.spins()[0]
        own = vector((q[0], *(-one for one in q[1:])), w)
        return np.array([*own, *vector(q, np.array(moments) * own)])
    expected = formulas.flips(moments, spin)
    rows = np.array([seen(engine)] + list(path(engine, 10.5 * expected, seen)))
    w, around = rows[:, :3], rows[:, 3:]
    crossings = [k + w[k, 1] / (w[k, 1] - w[k + 1, 1]) for k in range(len(w) - 1) if w[k, 1] * w[k + 1, 1] < 0]
    found = (crossings[-1] - crossings[0]) / (len(crossings) - 1) * sc.STEP if len(crossings) > 1 else math.nan
    yield relative("seconds between two flips of a free top", expected, found, 1e-3)
    twice = (w * w * moments).sum(1)
    yield "change of its energy in 10 flips, as a share", 0.0, float(abs(twice / twice[0] - 1).max()), 1e-5
    yield "change of its angular momentum, as a share", 0.0, float(np.linalg.norm(around - around[0], axis=1).max() / np.linalg.norm(around[0])), 1e-5


def heavy_top(make):
    """Goldstein, Classical Mechanics, section 5.7"""
    length, mass, across, along, spin, tilt = 0.2, 1.0, 0.02, 0.04, 20.0, math.pi / 3
    cosine = math.cos(tilt)
    rate = formulas.precession(across + mass * length ** 2, along, spin, mass * G * length, cosine)
    axis = np.array([math.sin(tilt), cosine, 0.0])
    w = np.array([0.0, rate, 0.0]) + (spin - rate * cosine) * axis
    at = length * axis
    q = (math.cos(tilt / 2), 0.0, 0.0, -math.sin(tilt / 2))  # the axis is the body's y
    top = Body("disc", (0.1,), tuple(at), q=q, v=tuple(np.cross(w, at)), w=tuple(w), mass=mass, inertia=(across, along, across))
    engine = make(Scene("heavy top", [top], [Pin(-1, 0, (0.0, 0.0, 0.0))], gravity=(*DOWN, 0.0)))
    x = path(engine, 10)[:, 0]
    turns = np.unwrap(np.arctan2(-x[:, 2], x[:, 0]))
    yield relative("rate at which a heavy top precesses, rad/s", rate, float((turns[-1] - turns[0]) / (len(x) - 1) / sc.STEP), 1e-3)
    yield "how far its tilt leaves 60 degrees in 10 s, rad", 0.0, float(abs(np.arccos(np.clip(x[:, 1] / np.linalg.norm(x, axis=1), -1, 1)) - tilt).max()), 2e-3


TRUTHS = [slope, braking, slide_and_roll, roll_down, cone, belt, bounces, cradle, cube_of_balls, wall, pendulum, double_pendulum,
          hanging_chain, heavy_end, heavy_end_in_space, tipping, arch, domino_run, free_top, heavy_top]


# What FP3 is known to miss, and by how much at most: the page says so, and more than that is an error.
SHORT = {"how far its tilt leaves 60 degrees in 10 s, rad": 0.0145}


def measure(truth, make):
    """Rows of a truth, and what an engine refuses of it."""
    rows, refused = [], []
    try:
        for what, expected, found, within in truth(make):
            rows.append({"test": truth.__name__, "what": what, "expected": float(expected), "within": float(within),
                         "found": float(found) if math.isfinite(found) else None,
                         "holds": bool(abs(found - expected) <= within), "source": truth.__doc__})
    except sc.Refused as why:
        refused.append({"test": truth.__name__, "why": str(why)})
    return rows, refused
