"""Shapes in the plane for tests: records for build/tests/geometry2, random shapes, and in double, from corners alone, what they must give."""

import subprocess

import numpy as np

POINT = ("<f4", 2)
MAKER = [("kind", "<u4"), ("radius", "<f4"), ("points", "<f4", (8, 2))]
POSE = [("at", *POINT), ("turn", *POINT)]                # turn: cosine and sine
REQUEST = np.dtype([("what", "<u4"), ("a", MAKER), ("b", MAKER), ("pose_a", POSE), ("pose_b", POSE), ("reach", "<f4"), ("ends", "<u4"),
                    ("to_a", POSE), ("to_b", POSE)])
SHAPE = [("count", "<u4"), ("columns", "<f4", (2, 2, 8)), ("radius", "<f4"), ("extent", "<f4"), ("middle", *POINT)]    # columns: corner, normal; x, y
MASS = [("mass", "<f8"), ("centre", "<f8", 2), ("inertia", "<f8")]
MANIFOLD = [("normal", *POINT), ("point", [("arm", *POINT), ("gap", "<f4")], 2), ("count", "<u4")]
APART = [("gap", "<f4"), ("normal", *POINT), ("arm_a", *POINT), ("arm_b", *POINT)]
HIT = [("fraction", "<f4"), ("normal", *POINT), ("arm", *POINT)]
ANSWER = np.dtype([("failed", "<u4"), ("a", SHAPE), ("b", SHAPE), ("bounds", "<f4", (2, 2)), ("manifold", MANIFOLD), ("is_hit", "<u4"),
                   ("overlaps", "<u4"), ("apart", APART), ("hit", HIT),
                   ("mass", MASS), ("together", MASS), ("text", "S128")])
COLLIDE, LINK, MAKE, MEASURE, RAY, IMPACT, CAST = range(7)


def requests(count, what=COLLIDE):
    """Two discs of radius 1 in one place."""
    made = np.zeros(count, REQUEST)
    made["what"] = what
    for side in "ab":
        made[side]["kind"] = made[side]["radius"] = 1
        made["pose_" + side]["turn"][:, 0] = 1
    return made


def ask(build, records):
    done = subprocess.run([build / "tests/geometry2"], input=records.tobytes(), capture_output=True, check=True, timeout=300)
    answers = np.frombuffer(done.stdout, ANSWER)
    assert len(answers) == len(records)
    return answers


# ---- random shapes ----

def shapes(rng, to, size, kinds=range(9), sharp=0.5):
    """Fills makers with shapes of about that size each."""
    count = len(to)
    to["kind"] = rng.choice(list(kinds), count)
    polygon = to["kind"] >= 3
    step = 2 * np.pi / np.maximum(to["kind"], 1)
    angle = np.arange(8) * step[:, None] + rng.uniform(-0.2, 0.2, (count, 8)) * step[:, None] + rng.uniform(0, 2 * np.pi, (count, 1))
    stretch = np.exp(rng.uniform(-1.5, 0, (count, 1)))
    x, y = np.cos(angle), np.sin(angle) * stretch
    turn = rng.uniform(0, 2 * np.pi, (count, 1))
    points = np.stack([x * np.cos(turn) - y * np.sin(turn), x * np.sin(turn) + y * np.cos(turn)], 2) * size[:, None, None]
    points += (rng.uniform(-0.5, 0.5, (count, 1, 2)) * (to["kind"] != 1)[:, None, None]) * size[:, None, None]
    to["points"] = points
    box = to["kind"] == 0
    to["points"][box, 0] = rng.uniform(0.1, 1, (box.sum(), 2)) * size[box, None]
    angles = rng.uniform(0, 2 * np.pi, box.sum()) * (rng.uniform(size=box.sum()) < 0.7)
    to["points"][box, 2] = np.stack([np.cos(angles), np.sin(angles)], 1)
    radius = np.where(rng.uniform(size=count) < sharp, 0, rng.uniform(0.01, 0.7, count)) * size
    to["radius"] = np.where(to["kind"] == 1, rng.uniform(0.1, 1, count) * size, radius)
    return polygon


def turns(rng, to, quarter=0.2):
    angle = rng.uniform(0, 2 * np.pi, len(to))
    angle = np.where(rng.uniform(size=len(to)) < quarter, np.round(angle / (np.pi / 2)) * np.pi / 2, angle)
    to["turn"] = np.stack([np.cos(angle), np.sin(angle)], 1)


# ---- the same in double ----

def turned(pose, p):
    """Points (N, points, 2) or directions as the pose turns them."""
    c, s = (pose["turn"][:, k].astype(float)[:, None] for k in (0, 1))
    return np.stack([c * p[..., 0] - s * p[..., 1], s * p[..., 0] + c * p[..., 1]], 2)


def corners(shape):
    """(..., 8, 2): the last one is there again in place of those that are none."""
    return np.moveaxis(shape["columns"][..., 0, :, :], -2, -1)


def normals(shape):
    return np.moveaxis(shape["columns"][..., 1, :, :], -2, -1)


def placed(shape, pose):
    """The corners in the world."""
    return turned(pose, corners(shape).astype(float)) + pose["at"].astype(float)[:, None, :]


def to_edges(p, q):
    """The distances of points q from the edges of p, (N, points, edges), and from their lines, outside positive, NaN without a line."""
    start, way = p, np.roll(p, -1, 1) - p
    square = (way ** 2).sum(2)
    from_start = q[:, :, None] - start[:, None]
    with np.errstate(invalid="ignore", divide="ignore"):
        at = np.clip((from_start * way[:, None]).sum(3) / square[:, None], 0, 1)
        outside = (from_start[..., 0] * way[:, None, :, 1] - from_start[..., 1] * way[:, None, :, 0]) / np.sqrt(square)[:, None]
    nearest = from_start - np.nan_to_num(at)[..., None] * way[:, None]
    return np.sqrt((nearest ** 2).sum(3)), outside


def core_gap(p, q):
    """The distance of two cores, or minus the shortest way out of each other."""
    apart = np.minimum(to_edges(p, q)[0].min((1, 2)), to_edges(q, p)[0].min((1, 2)))
    with np.errstate(invalid="ignore"):
        axes = np.concatenate([to_edges(p, q)[1].min(1), to_edges(q, p)[1].min(1)], 1)
    widest = np.nanmax(np.where(np.isnan(axes), -np.inf, axes), 1)
    return np.where((widest < 0) & (widest > -np.inf), widest, apart)


def depth(p, radius, q):
    """How far points q (N, points, 2) are outside a rounded shape, negative inside."""
    distance, outside = to_edges(p, q)
    outside = np.nanmax(np.where(np.isnan(outside), -np.inf, outside), 2)
    away = distance.min(2)
    return np.where((outside <= 0) & (outside > -np.inf), -away, away) - radius[:, None]


# ---- pairs that nearly touch ----

def pairs(rng, count, build, target=0.3, kinds=range(9)):
    """Pairs of random shapes that nearly touch, and the answers."""
    r = requests(count)
    size = 10.0 ** rng.uniform(-3, 3, count)
    shapes(rng, r["a"], size, kinds)
    shapes(rng, r["b"], size * 10.0 ** rng.uniform(-1, 1, count), kinds)
    turns(rng, r["pose_a"])
    turns(rng, r["pose_b"])
    return moved(rng, r, build, target)


def moved(rng, r, build, target=0.3):
    """Shapes moved along the way between them until their gap is about a part of their size; and the answers."""
    r["what"] = MAKE
    made = ask(build, r)
    assert (made["failed"] == 0).all(), made["text"][made["failed"] != 0][:3]
    r["what"] = COLLIDE
    extent = np.minimum(made["a"]["extent"], made["b"]["extent"]).astype(float)
    wanted = extent * rng.uniform(-target, target, len(r)) * 10.0 ** rng.uniform(-4, 0, len(r))
    angle = rng.uniform(0, 2 * np.pi, len(r))
    way = np.stack([np.cos(angle), np.sin(angle)], 1)
    far = (made["a"]["extent"].astype(float) + made["b"]["extent"])[:, None] * 1.1
    r["pose_a"]["at"] = rng.uniform(-10, 10, (len(r), 2)) * extent[:, None]
    for _ in range(5):
        r["pose_b"]["at"] = r["pose_a"]["at"] + far * way
        far -= (truth(r, made) - wanted)[:, None]
    r["pose_b"]["at"] = r["pose_a"]["at"] + far * way
    r["reach"] = extent * rng.uniform(0, 0.1, len(r))
    return r, ask(build, r)


def cores(r, made):
    base = r["pose_a"]["at"].astype(float)
    here = {side: r["pose_" + side].copy() for side in "ab"}
    p, q = (placed(made[side], here[side]) - base[:, None] for side in "ab")
    return p, q


def radii(made):
    return [made[side]["radius"].astype(float) for side in "ab"]


def truth(r, made):
    return core_gap(*cores(r, made)) - sum(radii(made))


def least(made):
    points = made["manifold"]["point"]["gap"].astype(float)
    return np.where(made["manifold"]["count"] == 2, points.min(1), points[:, 0])


def extents(made):
    return made["a"]["extent"].astype(float) + made["b"]["extent"]
