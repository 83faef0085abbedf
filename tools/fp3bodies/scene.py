"""Scenes of rigid bodies as data, the same for fp3 and for every peer.

A scene has bodies of one shape each, pins between them, and gravity. Two surfaces have the geometric mean of their frictions, and the
larger one of their restitutions. Nothing sleeps. A scene in the plane can be lifted into space, for engines that have no other. Scenes with
other joints or with chains are for fp3 alone, which is then compared with itself (hashes.py); there bodies sleep.
"""

import dataclasses
import math

import numpy as np

STEP, SUBSTEPS = 1 / 60, 4


class Refused(Exception):
    """An engine has not what a scene needs; says what."""


@dataclasses.dataclass
class Body:
    shape: str                  # disc (ball in space), box, capsule (along x), polygon (in the plane; its corners anticlockwise)
    size: tuple                 # radius; half sizes; half length and radius; corners about the centre of mass
    at: tuple
    angle: float = 0.0          # in the plane
    q: tuple = (1.0, 0.0, 0.0, 0.0)  # in space: w, x, y, z
    v: tuple = ()
    w: object = 0.0             # in space: three
    fixed: bool = False
    moving: bool = False        # fixed, but for its speed, which nothing changes
    fast: bool = False          # must not pass through anything
    friction: float = 0.6
    restitution: float = 0.0
    density: float = 1.0
    mass: float = 0.0           # in place of the density
    inertia: tuple = ()         # in space, in place of that of its shape; in the plane one number


@dataclasses.dataclass
class Pin:
    """Two bodies share a point. In the plane, and where a plane is lifted, they turn about an axis; in space in any way."""
    a: int                      # -1: the world
    b: int
    at: tuple                   # where it is at first


@dataclasses.dataclass
class Joint:
    """Any other joint of fp3; more: words of fp3_joint_def, anchors in the axes of the bodies."""
    type: str
    a: int                      # -1: the world
    b: int
    more: dict


@dataclasses.dataclass
class Scene:
    name: str
    bodies: list
    pins: list = dataclasses.field(default_factory=list)
    joints: list = dataclasses.field(default_factory=list)
    chains: list = dataclasses.field(default_factory=list)  # lists of corners: ground of the world, to the left of the way along them
    gravity: tuple = (0.0, -10.0)
    step: float = STEP
    substeps: int = SUBSTEPS
    planar: bool = False        # in space, but nothing leaves the plane z = 0

    @property
    def dimensions(self):
        return len(self.gravity)

    def loose(self):
        """Which bodies are not held."""
        return np.array([not (body.fixed or body.moving) for body in self.bodies])


# ---- masses ----

def polygon(corners):
    """Area, centre, and second moment of area about it."""
    x, y = np.array(corners, dtype=float).T
    x2, y2 = np.roll(x, -1), np.roll(y, -1)
    cross = x * y2 - x2 * y
    area = cross.sum() / 2
    cx, cy = ((x + x2) * cross).sum() / 6 / area, ((y + y2) * cross).sum() / 6 / area
    about = ((x * x + x * x2 + x2 * x2 + y * y + y * y2 + y2 * y2) * cross).sum() / 12
    return area, (cx, cy), about - area * (cx * cx + cy * cy)


def moments(body, dimensions):
    """Area or volume, and second moments about the centre for a density of 1: one in the plane, three in space."""
    if body.shape == "disc":
        r, = body.size
        if dimensions == 2:
            return math.pi * r * r, (math.pi * r ** 4 / 2,)
        return 4 / 3 * math.pi * r ** 3, (8 / 15 * math.pi * r ** 5,) * 3
    if body.shape == "box":
        volume = 2 ** dimensions * math.prod(body.size)
        square = [a * a for a in body.size]
        return volume, ((volume * sum(square) / 3,) if dimensions == 2 else tuple(volume * (sum(square) - own) / 3 for own in square))
    if body.shape == "capsule" and dimensions == 2:
        a, r = body.size
        half = math.pi * r * r / 2  # a half disc, whose centre is 4r/3pi from its edge
        centre = 4 * r / (3 * math.pi)
        ends = 2 * (math.pi * r ** 4 / 4 - half * centre ** 2 + half * (a + centre) ** 2)
        return 4 * a * r + 2 * half, (4 * a * r * (a * a + r * r) / 3 + ends,)
    if body.shape == "polygon" and dimensions == 2:
        area, _, about = polygon(body.size)
        return area, (about,)
    raise Refused(f"no moments of a {body.shape} in {dimensions} dimensions")


def mass(body, dimensions):
    """Mass, and moments of inertia about its centre."""
    volume, second = moments(body, dimensions)
    density = body.mass / volume if body.mass else body.density
    return density * volume, tuple(body.inertia) or tuple(density * one for one in second)


def energy(scene, v, w):
    """Kinetic energy of the loose bodies, in the plane or with one moment for all axes."""
    m, turning = zip(*(mass(body, scene.dimensions) for body in scene.bodies))
    loose = scene.loose()
    spin = (np.array([one[0] for one in turning]) * (w * w if w.ndim == 1 else (w * w).sum(1)))
    return float(((np.array(m) * (v * v).sum(1) + spin) / 2)[loose].sum())


# ---- from the plane into space ----

DEPTH = 0.5  # half of a box's or polygon's size along z


def lifted(scene):
    """The same in space. A disc becomes a ball with a disc's moment."""
    if scene.dimensions == 3:
        return scene
    bodies = []
    for body in scene.bodies:
        m, (about,) = mass(body, 2)
        size = (*body.size, DEPTH) if body.shape == "box" else body.size
        spin = (0.0, 0.0, float(body.w))
        bodies.append(dataclasses.replace(body, size=size, at=(*body.at, 0.0), q=(math.cos(body.angle / 2), 0.0, 0.0, math.sin(body.angle / 2)),
                                          v=(*(body.v or (0.0, 0.0)), 0.0), w=spin, mass=m, inertia=(about,) * 3))
    return dataclasses.replace(scene, bodies=bodies, pins=[Pin(pin.a, pin.b, (*pin.at, 0.0)) for pin in scene.pins], gravity=(*scene.gravity, 0.0), planar=True)


# ---- scenes to stand and to be fast in ----

def ground(half, friction=0.6, **more):
    return Body("box", (half, 1.0), (0.0, -1.0), fixed=True, friction=friction, **more)


def pyramid(base):
    """Rows of base, base - 1, ... 1 boxes of 1 m."""
    boxes = [Body("box", (0.5, 0.5), (column - (base - 1 - row) / 2, row + 0.5)) for row in range(base) for column in range(base - row)]
    return Scene(f"pyramid {base}", [ground(base), *boxes])


def pyramid_in_space(base):
    """Of cubes, side by side in a plane that nothing holds them in."""
    made = lifted(pyramid(base))
    return dataclasses.replace(made, name=f"pyramid {base} of cubes", planar=False)


def stacks(count=10, high=10):
    boxes = [Body("box", (0.5, 0.5), (3.0 * (column - (count - 1) / 2), row + 0.5)) for column in range(count) for row in range(high)]
    return Scene(f"{count} stacks of {high}", [ground(3.0 * count), *boxes])


def mixed(count=2000, restitution=0.0):
    """Boxes, discs and capsules in turn fall into a box."""
    wide = max(8, round(math.sqrt(count / 1.25)))
    place = np.random.default_rng(1)
    half = 0.6 * wide + 0.5
    walls = [ground(half + 2.0)] + [Body("box", (1.0, 2.0 * wide), (side * (half + 1.0), 2.0 * wide), fixed=True) for side in (-1, 1)]
    bodies = []
    for k in range(count):
        at = (1.2 * (k % wide - (wide - 1) / 2) + place.uniform(-0.05, 0.05), 1.2 * (k // wide) + 0.7)
        shape, size = (("box", (0.45, 0.45)), ("disc", (0.5,)), ("capsule", (0.25, 0.25)))[k % 3]
        bodies.append(Body(shape, size, at, angle=place.uniform(-0.3, 0.3), restitution=restitution))
    return Scene(f"mixed {count}" + (f", restitution {restitution:g}" if restitution else ""), [*walls, *bodies])


def chain(count, heavy=0.0):
    """Rods hang from the world, one on another, at first along x; with a heavy body at the end, straight down."""
    bodies, pins = [], []
    for k in range(count):
        along = (k + 0.5, 0.0) if not heavy else (0.0, -k - 0.5)
        bodies.append(Body("box", (0.5, 0.125), along, angle=0.0 if not heavy else -math.pi / 2, density=4.0))
        pins.append(Pin(k - 1, k, (float(k), 0.0) if not heavy else (0.0, -float(k))))
    if heavy:
        bodies.append(Body("disc", (0.5,), (0.0, -float(count)), mass=heavy))
        pins.append(Pin(count - 1, count, (0.0, -float(count))))
    return Scene(f"chain of {count}" + (f", {heavy:g} kg at its end" if heavy else ""), bodies, pins)


def grid(side=30):
    """Discs pinned to their neighbours half way, the first row to the world."""
    bodies = [Body("disc", (0.4,), (float(column), -float(row))) for row in range(side) for column in range(side)]
    pins = [Pin(-1, column, (float(column), 0.0)) for column in range(side)]
    for k in range(side * side):
        x, y = bodies[k].at
        pins += [Pin(k, k + 1, (x + 0.5, y))] if k % side < side - 1 else []
        pins += [Pin(k, k + side, (x, y - 0.5))] if k < side * (side - 1) else []
    return Scene(f"grid of {side} x {side} pins", bodies, pins)


def wall(high=20, wide=50):
    """Bricks of 0.4 x 0.2 x 0.2 m in space, each course half a brick off, with half bricks at its ends."""
    edge = 0.2 * wide
    courses = [[(0.2, 0.4 * k + 0.2 - edge) for k in range(wide)], [(0.1, 0.1 - edge), *((0.2, 0.4 * k + 0.4 - edge) for k in range(wide - 1)), (0.1, edge - 0.1)]]
    bricks = [Body("box", (half, 0.1, 0.1), (x, 0.2 * row + 0.1, 0.0), density=1000.0) for row in range(high) for half, x in courses[row % 2]]
    return Scene(f"wall of {len(bricks)} bricks", [Body("box", (0.4 * wide, 1.0, 5.0), (0.0, -1.0, 0.0), fixed=True), *bricks], gravity=(0.0, -10.0, 0.0))


DOMINO = {"high": 1.0, "thick": 0.15, "apart": 0.35, "push": 1.0}


def dominoes(count=30, apart=None):
    """Each is pinned at the lower corner about which it turns; the first one is pushed. Nothing rubs, so that theory has no free number."""
    h, d, s = DOMINO["high"], DOMINO["thick"], apart or DOMINO["apart"]
    bodies = [ground(count * (d + s) + 2.0, friction=0.0)]
    pins = []
    for k in range(count):
        x = k * (d + s)
        w = -DOMINO["push"] if k == 0 else 0.0
        bodies.append(Body("box", (d / 2, h / 2), (x - d / 2, h / 2), friction=0.0, w=w, v=(-w * h / 2, -w * d / 2) if k == 0 else ()))
        pins.append(Pin(-1, k + 1, (x, 0.0)))  # to the world: a floor holds it up, and what is pinned to another does not touch it
    return Scene(f"{count} dominoes, {s:g} apart", bodies, pins)


def bullets(count=20, thick=0.1):
    """Small discs of 50 to 430 m/s against a thin wall."""
    bodies = [Body("box", (thick / 2, 2.0 * count), (0.0, 0.0), fixed=True)]
    bodies += [Body("disc", (0.05,), (-3.0 - 0.01 * k, 2.0 * (k - count / 2)), v=(50.0 + 20.0 * k, 0.0), fast=True) for k in range(count)]
    return Scene(f"{count} bullets", bodies, gravity=(0.0, 0.0))


# ---- scenes for fp3 alone ----

LIMB = {"size": (0.2, 0.08), "density": 300.0}


def ragdolls(count=2):
    """Figures of eleven parts over stairs; their hinges have limits, and the necks springs."""
    bodies, joints = [], []

    def part(a, shape, size, at, anchor_a, anchor_b, **limits):
        if a is not None:
            joints.append(Joint("hinge", a, len(bodies), {"anchor_a": anchor_a, "anchor_b": anchor_b, **limits}))
        bodies.append(Body(shape, size, at, density=LIMB["density"], w=0.5 if a is None else 0.0))
        return len(bodies) - 1
    for k in range(count):
        x, y = 3.0 * k + 1.5, 0.2 * (3 * k + 1) + 1.25
        body = part(None, "box", (0.15, 0.3), (x, y), None, None)
        part(body, "disc", (0.14,), (x, y + 0.46), (0.0, 0.3), (0.0, -0.16), hertz=8.0, has_limits=1, low=-0.7, high=0.7)
        for side, low, high in ((-1, -1.2, 1.2), (1, -1.2, 1.2)):
            upper = part(body, "capsule", LIMB["size"], (x + side * 0.4, y + 0.25), (side * 0.18, 0.25), (-side * 0.22, 0.0), has_limits=1, low=low, high=high)
            part(upper, "capsule", LIMB["size"], (x + side * 0.84, y + 0.25), (side * 0.22, 0.0), (-side * 0.22, 0.0), has_limits=1, low=-1.5, high=1.5)
        for side in (-1, 1):
            thigh = part(body, "box", (0.07, 0.22), (x + side * 0.09, y - 0.54), (side * 0.09, -0.3), (0.0, 0.24), has_limits=1, low=-0.8, high=0.8)
            part(thigh, "box", (0.06, 0.22), (x + side * 0.09, y - 1.02), (0.0, -0.24), (0.0, 0.24), has_limits=1, low=-1.5, high=0.1)
    stairs = [(float(k + end), 0.2 * k) for k in range(3 * count - 1, -1, -1) for end in (1, 0)]
    return Scene(f"{count} ragdolls", bodies, joints=joints, chains=[[*stairs, (-6.0, 0.0)]])


def car(planks=8):
    """A car with springs and a motor drives over hills and a bridge; each type of joint is there: it pulls a load by a rope, a lid is welded, two gears turn, a lift slides."""
    hull = ((-1.4, -0.3), (1.4, -0.3), (1.4, 0.0), (0.5, 0.4), (-1.0, 0.45), (-1.4, 0.1))
    centre = polygon(hull)[1]
    hull = tuple((x - centre[0], y - centre[1]) for x, y in hull)
    bodies = [Body("polygon", hull, (-2.0, 0.9), density=80.0)]
    bodies += [Body("disc", (0.4,), (-2.0 + side * 0.9, 0.4), density=60.0, friction=0.9) for side in (-1, 1)]
    bodies += [Body("box", (0.4, 0.25), (-5.0, 0.25), density=40.0, friction=0.3), Body("box", (0.3, 0.1), (-2.2, 1.6), density=20.0),
               Body("disc", (0.3,), (-6.5, 2.0)), Body("disc", (0.6,), (-7.4, 2.0)), Body("box", (0.3, 0.3), (-9.0, 1.5), density=20.0)]
    joints = [Joint("wheel", 0, k, {"anchor_a": (side * 0.9 - centre[0], -0.45), "axis": (0.0, 1.0), "hertz": 5.0, "speed": -12.0, "most": 120.0})
              for k, side in ((1, -1), (2, 1))]
    joints += [Joint("rod", 0, 3, {"anchor_a": (-1.3, -0.2), "anchor_b": (0.4, 0.0), "has_limits": 1, "low": 0.0, "high": 1.5}),
               Joint("weld", 0, 4, {"anchor_a": (-0.2, 0.6), "anchor_b": (0.0, -0.1), "hertz": 6.0}),
               Joint("hinge", -1, 5, {"anchor_a": (-6.5, 2.0), "speed": 2.0, "most": 5.0}), Joint("hinge", -1, 6, {"anchor_a": (-7.4, 2.0)}),
               Joint("gear", 5, 6, {"ratio": 0.5}),
               Joint("slider", -1, 7, {"anchor_a": (-9.0, 1.5), "axis": (0.0, 1.0), "has_limits": 1, "low": -0.5, "high": 1.0, "speed": 0.5, "most": 500.0})]
    first = len(bodies)
    bodies += [Body("box", (0.5, 0.06), (4.5 + k, 0.5), density=30.0) for k in range(planks)]
    joints += [Joint("hinge", first + k - 1 if k else -1, first + k, {"anchor_a": (0.5, 0.0) if k else (4.0, 0.5), "anchor_b": (-0.5, 0.0)}) for k in range(planks)]
    joints.append(Joint("hinge", -1, first + planks - 1, {"anchor_a": (4.0 + planks, 0.5), "anchor_b": (0.5, 0.0)}))
    near = [(3.9 - 0.5 * k, 0.5 * max(0.0, (3.9 - 0.5 * k) / 3.9) + (0.1 * math.sin(1.7 * k) if 9 < k < 14 else 0.0)) for k in range(30)]
    far = [(4.1 + planks + 0.5 * k, 0.5 + 0.1 * math.sin(1.3 * k)) for k in range(20, -1, -1)]
    return Scene("car", bodies, joints=joints, chains=[near, far])


FAST = [lambda: pyramid(10), lambda: pyramid(20), lambda: pyramid(40), lambda: pyramid(100), stacks, mixed, lambda: chain(200), grid,
        lambda: chain(20, heavy=1000.0), wall, lambda: pyramid_in_space(20), lambda: pyramid_in_space(40)]
