"""Shapes in space: makers and what they refuse, hulls by brute force, bounds, mass against tetrahedra and closed forms."""

import itertools

import numpy as np
import pytest
import solids
from solids import BALL, BOX, CAPSULE, HULL, TRIANGLE


@pytest.fixture
def ask(build):
    return solids.Solids(build / "tests/solids3")


def made(ask, *shapes):
    """What the makers say, and the shapes."""
    for shape in shapes:
        ask.make(*shape)
    for i in range(len(shapes)):
        ask.shape(i)
    answers = ask.answers()
    said = [answer[4:].partition(b"\0")[0].decode() for answer in answers[:len(shapes)]]
    return said, [solids.read_shape(answer) for answer in answers[len(shapes):]]


def faces_of(points):
    """Of a hull, by all threes of points: normal, offset, and the numbers of the points in each plane."""
    found = {}
    size = np.ptp(points, axis=0).max()
    p, q, r = np.swapaxes(points[np.array(list(itertools.combinations(range(len(points)), 3)))], 0, 1)
    normals = np.cross(q - p, r - p)
    length = np.linalg.norm(normals, axis=1)
    keep = length > 1e-5 * size * size
    normals = normals[keep] / length[keep, None]
    for m, at in zip(np.concatenate([normals, -normals]), np.concatenate([p[keep], p[keep]])):
        height = points @ m - m @ at
        if height.max() <= 1e-5 * size:
            found.setdefault(frozenset(np.flatnonzero(height >= -1e-5 * size)), (m, (height + m @ at).max()))
    return found


def tetrahedra(points):
    """Volume, centre and inertia about it, by fans of each face from the middle of the points."""
    o = points.mean(0)
    volume, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for inside, (n, _) in faces_of(points).items():
        p = points[sorted(inside)] - o
        u = np.cross(n, [1, 0, 0] if abs(n[0]) < 0.6 else [0, 1, 0])
        at = p - p.mean(0)
        p = p[np.argsort(np.arctan2(at @ np.cross(n, u), at @ u))]
        for k in range(1, len(p) - 1):
            t = np.array([p[0], p[k], p[k + 1]])
            v = abs(np.linalg.det(t)) / 6
            volume += v
            first += v / 4 * t.sum(0)
            second += v / 20 * (np.outer(t.sum(0), t.sum(0)) + t.T @ t)
    c = first / volume
    second -= volume * np.outer(c, c)
    return volume, c + o, np.trace(second) * np.eye(3) - second


def check_hull(shape, points):
    """Faces, corners and halves of a hull are those of the points."""
    count, halves = int(shape["count"]), int(shape["halves"])
    corner = solids.core(shape)
    truth = faces_of(points)
    assert shape["faces"] == len(truth) and count + len(truth) == halves // 2 + 2
    assert set(map(tuple, corner)) <= set(map(tuple, points))
    wanted = sorted(map(tuple, np.round([np.append(n, d) for n, d in truth.values()], 4) + 0.0))
    found = np.append(shape["normal"][:len(truth)], shape["offset"][:len(truth), None], 1).astype(float)
    assert np.allclose(sorted(map(tuple, np.round(found, 4) + 0.0)), wanted, atol=2e-4)
    assert (solids.core(shape) @ found[:, :3].T <= found[:, 3] + 1e-6 * np.abs(points).max()).all()
    start = shape["from"][:halves]
    for f in range(len(truth)):
        half, around = shape["first"][f], []
        while not around or half != shape["first"][f]:
            assert shape["face"][half] == f and shape["from"][shape["next"][half]] == start[half ^ 1]
            around.append(start[half])
            half = shape["next"][half]
        p, n = corner[around], found[f, :3]
        assert (np.cross(np.roll(p, -1, 0) - p, np.roll(p, -2, 0) - np.roll(p, -1, 0)) @ n > 0).all()      # convex, anticlockwise


CUBE = np.array(list(itertools.product([-1, 1], repeat=3)), float)
G = (1 + 5 ** 0.5) / 2
TWENTY = np.array([(0, a, b * G) for a in (-1, 1) for b in (-1, 1)] + [(a, b * G, 0) for a in (-1, 1) for b in (-1, 1)]
                  + [(b * G, 0, a) for a in (-1, 1) for b in (-1, 1)])
TWELVE = np.concatenate([CUBE, *([np.roll(p, k) for p in [(0, a / G, b * G) for a in (-1, 1) for b in (-1, 1)]] for k in range(3))])
DRUM = np.array([(np.cos(a), np.sin(a), z) for z in (-0.2, 0.3) for a in np.arange(16) * np.pi / 8])
WITH_MORE = np.concatenate([CUBE, [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0.5, 0.2, 1), (-1, -1, -1), (1, 1, 1), (0.3, 1, -1)]])


@pytest.mark.parametrize("size", [1e-3, 1, 1e3])
@pytest.mark.parametrize("points", [CUBE, TWENTY, TWELVE, DRUM, WITH_MORE], ids=["cube", "20 faces", "12 faces", "drum", "more"])
def test_a_hull_of_known_points(ask, points, size):
    rng = np.random.default_rng(len(points))
    for _ in range(1 if points is DRUM else 4):
        p = (points[rng.permutation(len(points))] * size @ solids.turn(rng.normal(size=4)).T).astype("f4").astype(float)
        (said,), (shape,) = made(ask, (HULL, p))
        assert said == "" and shape["count"] == (8 if points is WITH_MORE else len(points))
        check_hull(shape, p)


def test_random_hulls(ask, long):
    rng = np.random.default_rng(5)
    all_points = []
    for _ in range(400 if long else 30):
        p = rng.normal(size=(rng.integers(4, 33 if long else 20), 3))
        if rng.uniform() < 0.3:
            p /= np.linalg.norm(p, axis=1)[:, None]
        all_points.append((p * 10 ** rng.uniform(-3, 3) + rng.normal(size=3)).astype("f4").astype(float))
    said, shapes = made(ask, *((HULL, p) for p in all_points))
    assert len(faces_of(CUBE)) == 6
    for text, shape, p in zip(said, shapes, all_points):
        if np.ptp(p, axis=0).max() > 1e-2:          # below, a shift of 1 has taken the digits
            assert text == ""
            check_hull(shape, p)


FLAT = [(x, y, 0) for x in (0, 1, 2) for y in (0, 1, 2)]


@pytest.mark.parametrize("shape, says", [
    ((HULL, FLAT), "they are flat"), ((HULL, CUBE[:3]), "from 4 to 32 points, not 3"), ((HULL, np.zeros((33, 3))), "not 33"),
    ((HULL, np.ones((6, 3))), "too close"), ((HULL, [(i, 2 * i, 3 * i) for i in range(8)]), "they are flat"),
    ((HULL, [*CUBE[:5], (np.nan, 0, 0)]), "must be finite"), ((HULL, 1e7 * CUBE), "at most 1e6"), ((HULL, CUBE, -1.0), "not negative"),
    ((BALL, (0, np.inf, 0), 1.0), "must be finite"), ((BALL, (0, 0, 0), np.nan), "must be finite"), ((CAPSULE, [(0, 0, 0), (0, 0, 2e6)], 1.0), "1e6"),
    ((BOX, (1, 0, 1)), "at least 1e-6"), ((BOX, (1, np.nan, 1)), "must be finite"), ((BOX, (1, 1, 1), 0.0, (0, 0, 0, 0, 0, 0, 0)), "must be finite"),
    ((BOX, (1e-6, 1, 1), 0.0, (1e5, 0, 0, 1, 0, 0, 0)), "too thin"), ((TRIANGLE, [(0, 0, 0), (1, 1, 1), (2, 2, 2)]), "on a line"),
    ((TRIANGLE, [(0, 0, 0), (0, 0, 0), (1, 0, 0)]), "on a line")])
def test_what_is_refused(ask, shape, says):
    (said,), (left,) = made(ask, shape)
    assert says in said and left["count"] == 0


def test_a_capsule_without_length_is_a_ball(ask):
    said, shapes = made(ask, (CAPSULE, [(1, 2, 3), (1, 2, 3)], 0.5), (CAPSULE, [(1, 2, 3), (1, 2, 4)], 0.5))
    assert said == ["", ""] and [shape["count"] for shape in shapes] == [1, 2]


def test_bounds(ask):
    rng = np.random.default_rng(3)
    poses = [solids.random_pose(rng, 100) for _ in range(40)]
    numbers = [ask.make(HULL, rng.normal(size=(8, 3)), 0.25) for _ in poses]
    for number, pose in zip(numbers, poses):
        ask.shape(number)
        ask.ask(24, solids.BOUNDS, number, pose, 0.125)
    answers = ask.answers()[len(poses):]
    for i, pose in enumerate(poses):
        p = solids.placed(solids.core(solids.read_shape(answers[2 * i])), pose)
        low, high = np.frombuffer(answers[2 * i + 1], "f4").astype(float).reshape(2, 3)
        wide = np.concatenate([(p.min(0) - 0.375) - low, high - (p.max(0) + 0.375)])
        assert (wide >= 0).all() and (wide < 1.5e-4).all()


def tensor(i):
    return np.array([[i[0], i[3], i[4]], [i[3], i[1], i[5]], [i[4], i[5], i[2]]])


def masses(ask, shapes, *parts):
    for shape in shapes:
        ask.make(*shape)
    for part in parts:
        ask.mass(*part)
    return [np.frombuffer(answer, solids.MASS_OF)[0] for answer in ask.answers()[len(shapes):]]


def test_mass_of_hulls_and_of_several(ask):
    rng = np.random.default_rng(11)
    points = [(rng.normal(size=(n, 3)) + 3 * rng.normal(size=3)).astype("f4").astype(float) for n in (4, 6, 9, 14)]
    *one, together = masses(ask, [(HULL, p) for p in points], *([(i, 2.0 + i)] for i in range(4)), [(i, 2.0 + i) for i in range(4)])
    total, inertia, moment = 0, 0, 0
    for i, (p, m) in enumerate(zip(points, one)):
        volume, centre, own = tetrahedra(p)
        assert np.isclose(m["mass"], (2 + i) * volume, rtol=1e-9)
        assert np.allclose(m["centre"], centre, atol=1e-9) and np.allclose(tensor(m["inertia"]), (2 + i) * own, rtol=1e-8, atol=1e-8)
        a = solids.turn(m["q"])
        assert np.allclose(a @ np.diag(m["moment"]) @ a.T, tensor(m["inertia"]), rtol=1e-12, atol=1e-12) and np.isclose(np.linalg.norm(m["q"]), 1)
        total, moment = total + m["mass"], moment + m["mass"] * centre
        inertia = inertia + (2 + i) * own + m["mass"] * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    c = moment / total
    assert np.isclose(together["mass"], total, rtol=1e-12) and np.allclose(together["centre"], c)
    assert np.allclose(tensor(together["inertia"]), inertia - total * (c @ c * np.eye(3) - np.outer(c, c)), rtol=1e-8, atol=1e-8)


def rounded_box(h, r):
    """Volume and the integral of x^2, by slices across x, which are rounded rectangles."""
    nodes, weights = np.polynomial.legendre.leggauss(200)

    def slices(k):
        y, z = (h[i] for i in range(3) if i != k)
        t = (nodes + 1) * np.pi / 4                                    # beyond the core at x = h + r sin t
        rho, x = r * np.cos(t), h[k] + r * np.sin(t)
        area = 4 * y * z + 4 * rho * (y + z) + np.pi * rho ** 2
        whole = 4 * y * z + 4 * r * (y + z) + np.pi * r ** 2
        cap = weights * area * rho * np.pi / 4
        return 2 * (h[k] * whole + cap.sum()), 2 * (h[k] ** 3 / 3 * whole + (cap * x ** 2).sum())
    second = [slices(k)[1] for k in range(3)]
    return slices(0)[0], np.array([second[1] + second[2], second[0] + second[2], second[0] + second[1]])


@pytest.mark.parametrize("half, radius", [((0.5, 0.3, 0.2), 0.1), ((0.1, 0.2, 0.1), 0.5), ((1e-3, 1e-3, 1e-3), 1.0), ((0.5, 0.4, 0.3), 0.0)])
def test_mass_of_a_rounded_box(ask, half, radius):
    m, = masses(ask, [(BOX, half, radius, (1, 2, 3, 1, 0, 0, 0))], [(0, 3.0)])
    volume, inertia = rounded_box(np.float32(half).astype(float), float(np.float32(radius)))
    assert np.isclose(m["mass"], 3 * volume, rtol=1e-5 if radius else 1e-6)
    assert np.allclose(m["inertia"][:3], 3 * inertia, rtol=1e-5 if radius else 1e-6)
    assert np.allclose(m["centre"], (1, 2, 3), atol=1e-6) and np.allclose(m["inertia"][3:], 0, atol=1e-6 * m["inertia"][0])


def test_mass_of_round_shapes(ask):
    """A ball, a capsule on a slant, a triangle with a radius: Steiner's volume; a segment weighs nothing."""
    a, b, r = np.array([1, 2, 0.5]), np.array([2, 2.5, -0.5]), 0.25
    t = np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0]], float)
    ball, capsule, plate, segment = masses(ask, [(BALL, a, r), (CAPSULE, [a, b], r), (TRIANGLE, t, r), (CAPSULE, [a, b])], *([(i, 2.0)] for i in range(4)))
    v = 4 / 3 * np.pi * r ** 3
    assert np.isclose(ball["mass"], 2 * v) and np.allclose(ball["inertia"][:3], 2 * v * 0.4 * r * r) and np.allclose(ball["centre"], a)
    length, u = np.linalg.norm(b - a), (b - a) / np.linalg.norm(b - a)
    tube = np.pi * r * r * length
    along = 2 * (v * 0.4 + tube / 2) * r * r
    across = 2 * (tube * (r * r / 4 + length ** 2 / 12) + v * (0.4 * r * r + length ** 2 / 4 + 3 / 8 * length * r))
    assert np.allclose(tensor(capsule["inertia"]), across * np.eye(3) + (along - across) * np.outer(u, u)) and np.isclose(capsule["mass"], 2 * (v + tube))
    round_edge = 3 + 5 ** 0.5
    assert np.isclose(plate["mass"], 2 * (1 * 2 * r + round_edge * np.pi / 2 * r * r + v), rtol=1e-5)
    assert segment["mass"] == 0 and (segment["inertia"] == 0).all()
