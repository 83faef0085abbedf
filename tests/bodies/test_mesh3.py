"""Ground of triangles: nothing catches on inner edges, and the nearest triangle by brute force is found."""

import numpy as np
import pytest
import solids
from solids import BALL, BOX, CAPSULE, HULL

TOUCH = np.dtype([("found", "u4"), ("touch", [("triangle", "u4"), ("normal", "3f4"), ("count", "u4"), ("point", [("arm", "3f4"), ("gap", "f4")], 4)], 16)])
AT_REST = (0, 0, 0, 1, 0, 0, 0)


@pytest.fixture
def ask(build):
    return solids.Solids(build / "tests/solids3")


def mesh(ask, points, triangles):
    words = np.asarray(triangles, "<u4").reshape(-1)
    ask.ask(132, solids.MESH, len(points), len(words) // 3, points, words.view("<f4"))


def heights(ask, z, step=1.0):
    ask.ask(132, solids.HEIGHTS, z.shape[1], z.shape[0], (step, step), z)


def triangles_of(z, step=1.0):
    points = np.array([(i * step, j * step, z[j, i]) for j in range(z.shape[0]) for i in range(z.shape[1])])
    n = z.shape[1]
    corners = [c for j in range(z.shape[0] - 1) for i in range(n - 1) for c in ((j * n + i, j * n + i + 1, (j + 1) * n + i + 1),
                                                                              (j * n + i, (j + 1) * n + i + 1, (j + 1) * n + i))]
    return points, np.array(corners)


def from_triangles(t, at):
    """How far a point is from each of (N, 3, 3): from its plane where its foot is inside, else from the nearest side."""
    n = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    n /= np.linalg.norm(n, axis=1)[:, None]
    side, to = np.roll(t, -1, 1) - t, at - t
    inside = (np.einsum("nki,nki->nk", np.cross(side, to), n[:, None] + 0 * side) >= 0).all(1)
    along = np.clip((side * to).sum(2) / (side ** 2).sum(2), 0, 1)
    sides = np.linalg.norm(to - along[..., None] * side, axis=2).min(1)
    return np.where(inside, np.abs((to[:, 0] * n).sum(1)), sides)


def touches(answers):
    return [np.frombuffer(answer, TOUCH)[0] for answer in answers]


SLIDERS = [(BOX, (0.5, 0.4, 0.3), 0.0, 0.3), (BOX, (0.5, 0.4, 0.2), 0.1, 0.3), (BALL, (0, 0, 0), 0.3, 0.3),
           (CAPSULE, [(-0.5, 0, 0), (0.5, 0, 0)], 0.2, 0.2), (HULL, [(-0.5, 0, -0.3), (0.5, -0.2, -0.3), (0.3, 0.5, -0.3), (0, 0, 0.6)], 0.0, 0.3)]


@pytest.mark.parametrize("kind, points, radius, high", SLIDERS, ids=["box", "rounded", "ball", "capsule", "hull"])
@pytest.mark.parametrize("deep", [1e-6, 1e-3, 0.03])
def test_what_slides_does_not_catch(ask, kind, points, radius, high, deep):
    """Over a flat mesh, whose triangles have many shapes, each normal is straight up, exactly; and the load is carried everywhere."""
    rng = np.random.default_rng(1)
    flat, corners = triangles_of(np.zeros((9, 9)))
    flat[:, :2] += rng.uniform(-0.3, 0.3, size=(81, 2))
    mesh(ask, flat, corners[rng.permutation(len(corners))])
    number = ask.make(kind, points, radius)
    for i in range(150):
        turn = 0.01 * i
        ask.ask(4 + 16 * 84, solids.GROUND, number, AT_REST, (1.5 + i / 30, 2 + i / 40, high - deep, np.cos(turn), 0, 0, np.sin(turn)), 0.01)
    answers = ask.answers()
    assert answers[0][:4] == answers[1][:4] == b"\0\0\0\0"
    for found in touches(answers[2:]):
        assert 0 < found["found"] <= 16
        for touch in found["touch"][:found["found"]]:
            assert touch["normal"].tolist() == [0, 0, 1] and touch["count"] > 0
            gaps = touch["point"]["gap"][:touch["count"]]
            assert (gaps > -deep - 1e-5).all() and ((gaps < -deep + 1e-5).all() or kind in (BALL, BOX) or radius)
        assert abs(min(t["point"]["gap"][:t["count"]].min() for t in found["touch"][:found["found"]]) + deep) < 1e-5


def test_a_ball_on_hills(ask):
    """The least gap is that to the nearest triangle of all, and a normal is not beyond the hills' own."""
    rng = np.random.default_rng(2)
    z = rng.uniform(0, 0.8, size=(8, 8)).astype("f4")
    points, corners = triangles_of(z.astype(float))
    heights(ask, z)
    ball = ask.make(BALL, (0, 0, 0), 0.25)
    pose = solids.random_pose(rng)
    places = []
    for _ in range(150):
        x, y = rng.uniform(1, 6, size=2)
        places.append((x, y, z[int(y):int(y) + 2, int(x):int(x) + 2].max() + rng.uniform(0, 0.3)))
        ask.ask(4 + 16 * 84, solids.GROUND, ball, pose, (*solids.placed([places[-1]], pose)[0], 1, 0, 0, 0), 0.2)
    hits = 0
    for place, found in zip(places, touches(ask.answers()[2:])):
        gap = from_triangles(points[corners], np.array(place)).min() - 0.25
        if gap > 0.2 - 1e-4:
            continue
        hits += 1
        least = min(t["point"]["gap"][0] for t in found["touch"][:found["found"]])
        assert 0 < found["found"] <= 16 and abs(least - gap) < 1e-4
    assert hits > 60


def test_one_side_ends_and_ridges(ask):
    """From below nothing touches; at the ground's end the normal may point outwards; over a ridge it turns from one side's to the other's."""
    points = [(-2, 0, -1), (-2, 4, -1), (0, 0, 0), (0, 4, 0), (2, 0, -1), (2, 4, -1)]
    mesh(ask, points, [(0, 2, 3), (0, 3, 1), (2, 4, 5), (2, 5, 3)])
    ball = ask.make(BALL, (0, 0, 0), 0.5)
    places = [(1, 2, -0.9), (2.3, 2, -1.1), (0, 2, 0.45), (0.05, 2, 0.45), (-0.05, 2, 0.45), (1, 2, 0)]
    for place in places:
        ask.ask(4 + 16 * 84, solids.GROUND, ball, AT_REST, (*place, 1, 0, 0, 0), 0.1)
    below, end, top, right, left, face = touches(ask.answers()[2:])
    assert below["found"] == 0 and end["found"] >= 1 and end["touch"][0]["normal"][0] > 0.8
    assert top["found"] >= 1 and all(np.allclose(t["normal"], (0, 0, 1), atol=1e-6) for t in top["touch"][:top["found"]])
    for found, sides, sign in ((right, (2, 3), 1), (left, (0, 1), -1)):
        assert found["found"] == 1 and found["touch"][0]["triangle"] in sides
        assert np.allclose(found["touch"][0]["normal"], np.array([sign * 0.05, 0, 0.45]) / np.hypot(0.05, 0.45), atol=1e-5)
    assert face["found"] >= 1 and np.allclose(face["touch"][0]["normal"], np.array([1, 0, 2]) / 5 ** 0.5, atol=1e-6)


def test_what_meshes_refuse(ask):
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (2, 0, 0)], float)
    mesh(ask, points, [(0, 1, 2), (0, 1, 4)])
    mesh(ask, points, [(0, 1, 2), (0, 1, 3)])
    mesh(ask, points, np.zeros((0, 3)))
    mesh(ask, points * np.nan, [(0, 1, 2)])
    heights(ask, np.zeros((1, 5)))
    heights(ask, np.full((3, 3), np.inf))
    heights(ask, np.zeros((3, 3)), -1.0)
    said = [answer[4:].partition(b"\0")[0].decode() for answer in ask.answers()]
    for text, part in zip(said, ("triangle 1 has corner 4 of 4 points", "triangle 1 has its corners on a line", "from 1 to 2^28 triangles, not 0", "must be finite",
                                 "from 2 to 10,000", "must be finite", "spacings above 0")):
        assert part in text
