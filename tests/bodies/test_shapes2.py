"""Makers, bounds and masses of shapes in the plane, against hulls by all triples, points on the surface, and polygons of many sides."""

import numpy as np
import plane
import pytest


def made_of(build, kind, points, radius=0.0, turn=(1, 0), at=(0, 0), reach=0.0):
    r = plane.requests(1, plane.MAKE)
    points = np.asarray(points, float).reshape(-1, 2)
    r["b"]["kind"], r["b"]["radius"], r["pose_b"]["turn"], r["pose_b"]["at"], r["reach"] = kind, radius, turn, at, reach
    r["b"]["points"][0, :len(points)] = points
    return plane.ask(build, r)[0]


@pytest.mark.parametrize("kind, points, radius, text", [
    (1, [(0, 0)], 0, "a disc has radius 0"),
    (1, [(0, 0)], -1, "radius -1 of a shape is not 0 or from 1e-06 to 1e+06"),
    (1, [(0, 0)], np.nan, "radius nan"),
    (1, [(0, np.inf)], 1, "corner 0 of a shape: (0, inf) is not within 1e+06"),
    (1, [(0, 1.1e6)], 1, "corner 0 of a shape: (0, 1.1e+06) is not within 1e+06"),
    (1, [(0, 0)], 1.1e6, "radius 1.1e+06"),
    (1, [(0, 0)], 0.9e-6, "radius 9e-07"),
    (2, [(1, 2), (1, 2)], 1, "the ends of a capsule are one point"),
    (2, [(1, 2), (1, np.nan)], 1, "corner 1 of a shape: (1, nan)"),
    (0, [(0, 1), (0, 0), (1, 0)], 0, "half a box is 0 by 1, not from 1e-06 to 1e+06"),
    (0, [(1, np.nan), (0, 0), (1, 0)], 0, "half a box is 1 by nan"),
    (0, [(1, 1), (0, 0), (1, 1)], 0, "a box is turned by (1, 1), which is no turn"),
    (0, [(1, 1), (1e6, 0), (1, 0)], 0, "corner 1 of a shape"),
    (0, [(0.01, 0.01), (9e5, 0), (1, 0)], 0, "a box of 0.02 by 0.02 is too small so far away"),
    (3, [(0, 0), (1, 1), (2, 2)], 1, "the points of a polygon are on a line"),
    (4, [(0, 0), (1, 1), (1, 1), (0, 0)], 0, "the points of a polygon are on a line"),
    (3, [(0, 0), (1, 0), (0.5, 1e-5)], 0, "the points of a polygon are on a line"),
    (8, [(3, 3)] * 8, 0, "the points of a polygon are on a line"),
    (9, [(0, 0)], 0, "a polygon has 3 to 8 points, not 9")])
def test_what_is_no_shape_is_refused(build, kind, points, radius, text):
    answer = made_of(build, kind, points, radius)
    assert answer["failed"] == 2 and answer["text"].decode().startswith(text)
    assert answer["b"].tobytes() == bytes(answer["b"].nbytes)


@pytest.mark.parametrize("kind, points, radius", [
    (1, [(1e6, -1e6)], 1e-6), (1, [(0, 0)], 1e6), (2, [(0, 0), (1e-6, 0)], 0), (2, [(1e6, 1e6), (-1e6, -1e6)], 1e6),
    (0, [(1e-6, 1e6), (0, 0), (1, 0)], 0), (3, [(0, 0), (1e-5, 0), (0, 1e-5)], 0), (3, [(-1e6, -1e6), (1e6, -1e6), (0, 1e6)], 1e6)])
def test_the_ends_of_the_ranges_are_shapes(build, kind, points, radius):
    assert made_of(build, kind, points, radius)["failed"] == 0


def test_a_box_is_exact(build):
    b = made_of(build, 0, [(0.3, 2), (1, -1), (1, 0)], 0.25)["b"]
    x, y = np.float32(0.3), np.float32(2)
    assert b["count"] == 4 and b["radius"] == 0.25
    assert (plane.corners(b)[:4] == np.float32([[1 - x, -1 - y], [1 + x, -1 - y], [1 + x, -1 + y], [1 - x, -1 + y]])).all()
    assert plane.normals(b)[:4].tolist() == [[0, -1], [1, 0], [0, 1], [-1, 0]]
    assert b["middle"].tolist() == [1, -1]


def hull(points):
    """The corners by all pairs: an edge has no point to its right. Anticlockwise, from the lowest of the leftmost."""
    p = points.astype(float)
    follow = {}
    for i in range(len(p)):
        for k in range(len(p)):
            d, e = p[k] - p[i], p - p[i]
            if i != k and np.all(np.delete(d[0] * e[:, 1] - d[1] * e[:, 0], [i, k]) > 0):
                follow[i] = k
    at = min(follow, key=lambda i: tuple(p[i]))
    found = [at]
    while follow[found[-1]] != at:
        found.append(follow[found[-1]])
    return points[found]


def test_polygons_are_hulls(build):
    """Of points in any order, with some inside: the corners, their normals, the middle and the extent."""
    rng = np.random.default_rng(1)
    r = plane.requests(600, plane.MAKE)
    size = 10.0 ** rng.uniform(-4, 5, len(r))
    r["b"]["kind"], r["b"]["radius"] = rng.integers(3, 9, len(r)), 0
    r["b"]["points"] = (rng.normal(size=(len(r), 8, 2)) * size[:, None, None]).astype(np.float32)
    same = 0
    for asked, made in zip(r["b"], plane.ask(build, r)):
        points = asked["points"][:asked["kind"]]
        corners, b = hull(points), made["b"]
        assert made["failed"] == 0 and 3 <= b["count"] <= len(corners)
        found = plane.corners(b)[:b["count"]].astype(float)
        extent = np.abs(points - points[0]).max()
        assert (plane.corners(b)[b["count"]:] == found[-1]).all() and (plane.normals(b)[b["count"]:] == plane.normals(b)[b["count"] - 1]).all()
        lost = [p for p in corners if tuple(p) not in set(map(tuple, plane.corners(b)[:b["count"]]))]
        assert len(lost) + b["count"] == len(corners)
        for p in lost:
            assert plane.depth(found[None], np.zeros(1), p[None, None].astype(float)).max() < extent * 2.0 ** -13
        if not lost:
            assert (plane.corners(b)[:b["count"]] == corners).all()
            same += 1
        way = np.roll(found, -1, 0) - found
        normal = np.stack([way[:, 1], -way[:, 0]], 1) / np.sqrt((way ** 2).sum(1))[:, None]
        assert np.abs(normal - plane.normals(b)[:b["count"]]).max() < 2.0 ** -21 * max(1, np.abs(found).max() / np.sqrt((way ** 2).sum(1)).min())
        assert np.abs(found.mean(0) - b["middle"]).max() < 2.0 ** -21 * np.abs(found).max()
        far = np.sqrt((found ** 2).sum(1)).max()
        assert far <= b["extent"] <= far * (1 + 2e-6)
    assert same > 590


def test_the_order_of_the_points_does_not_matter(build):
    rng = np.random.default_rng(2)
    points = np.float32([(0, 0), (2, 0.1), (3, 1), (2.5, 2), (1, 2.2), (0.5, 0.5), (1, 1), (-0.5, 1)])
    one = made_of(build, 8, points)["b"].tobytes()
    for _ in range(20):
        assert made_of(build, 8, rng.permutation(points))["b"].tobytes() == one


def outline(shape, pose, steps):
    """Points on the rounded boundary, in order: arcs around each corner."""
    p = plane.placed(shape[None], pose[None])[0][:shape["count"]]
    way = np.roll(p, -1, 0) - p
    if len(p) == 1:
        turns = [(0, 2 * np.pi)]
    else:
        angle = np.arctan2(-way[:, 0], way[:, 1])
        before = np.roll(angle, 1)
        turns = [(b, b + (a - b) % (2 * np.pi)) for a, b in zip(angle, before)]
    arcs = []
    for corner, (begin, end) in zip(p, turns):
        t = np.linspace(begin, end, steps)
        arcs.append(corner + float(shape["radius"]) * np.stack([np.cos(t), np.sin(t)], 1))
    return np.concatenate(arcs)


def weigh(p):
    """Area, centre and inertia of a polygon, by triangles."""
    p0, q = p[0], p - p[0]
    a, b = q[:-1], q[1:]
    area = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2
    centre = (area[:, None] * (a + b)).sum(0) / 3 / area.sum()
    square = (area / 6 * ((a * a).sum(1) + (a * b).sum(1) + (b * b).sum(1))).sum()
    return area.sum(), p0 + centre, square - area.sum() * (centre ** 2).sum()


@pytest.fixture(scope="module")
def some(build):
    rng = np.random.default_rng(3)
    r = plane.requests(300, plane.MAKE)
    size = 10.0 ** rng.uniform(-3, 3, len(r))
    for side in "ab":
        plane.shapes(rng, r[side], size)
    plane.turns(rng, r["pose_b"])
    r["pose_b"]["at"] = rng.normal(size=(len(r), 2)) * 10 * size[:, None]
    r["reach"] = rng.choice([0, 0.1], len(r)) * size
    return r, plane.ask(build, r)


def test_bounds_are_tight(some):
    r, made = some
    for asked, answer in zip(r, made):
        p = outline(answer["b"], asked["pose_b"], 1001)
        slack = 2.0 ** -22 * (answer["b"]["extent"] + asked["reach"] + np.abs(asked["pose_b"]["at"]).max()) + 1e-5 * answer["b"]["radius"]
        assert np.abs(answer["bounds"] - [p.min(0) - asked["reach"], p.max(0) + asked["reach"]]).max() <= slack


def test_masses_are_those_of_polygons_of_many_sides(some):
    at_home = np.zeros(1, plane.POSE)
    at_home["turn"] = [1, 0]
    for answer in some[1]:
        parts = []
        for side, density in (("b", 2), ("a", 3)):
            shape = answer[side]
            if shape["count"] == 2 and shape["radius"] == 0:
                parts.append((0, np.zeros(2), 0))
            else:
                area, centre, inertia = weigh(outline(shape, at_home[0], 2000 if shape["radius"] else 2))
                parts.append((density * area, centre, density * inertia))
        mass, centre, inertia = parts[0]
        extent = answer["b"]["extent"]
        assert answer["mass"]["mass"] == pytest.approx(mass, rel=3e-6)
        assert answer["mass"]["inertia"] == pytest.approx(inertia, rel=6e-6)
        if mass:
            assert np.abs(answer["mass"]["centre"] - centre).max() < 1e-6 * extent
        whole = sum(p[0] for p in parts)
        assert answer["together"]["mass"] == pytest.approx(whole, rel=3e-6)
        if whole:
            centre = sum(p[0] * p[1] for p in parts) / whole
            inertia = sum(p[2] + p[0] * ((p[1] - centre) ** 2).sum() for p in parts)
            assert np.abs(answer["together"]["centre"] - centre).max() < 1e-6 * (extent + answer["a"]["extent"])
            assert answer["together"]["inertia"] == pytest.approx(inertia, rel=1e-5)


def test_known_masses(build):
    disc = made_of(build, 1, [(3, 4)], 2)["mass"]
    assert disc["mass"] == pytest.approx(8 * np.pi, rel=1e-15) and disc["inertia"] == pytest.approx(16 * np.pi, rel=1e-15)
    assert disc["centre"].tolist() == [3, 4]
    box = made_of(build, 0, [(0.5, 1.5), (1e3, 0), (1, 0)])["mass"]
    assert (box["mass"], *box["centre"]) == (6, 1000, 0) and box["inertia"] == pytest.approx(6 * (1 + 9) / 12, rel=1e-15)
