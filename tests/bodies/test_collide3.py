"""Where two shapes in space touch: against separations along every direction that features give, in double."""

import numpy as np
import pytest
import solids
from solids import BALL, BOX, CAPSULE, HULL, STRAIGHT, TRIANGLE

REACH = 0.25
AT_REST = (0, 0, 0, 1, 0, 0, 0)


@pytest.fixture
def ask(build):
    return solids.Solids(build / "tests/solids3")


def shape(ask, rng, size=1.0):
    """A random one of each kind, sharp or rounded."""
    kind = rng.integers(0, 7)
    radius = float(rng.choice([0, 0.05, 0.3])) * size
    if kind == 0:
        return ask.make(BALL, rng.normal(size=3) * rng.choice([0, 0.3]) * size, 0.4 * size)
    if kind in (1, 2):
        return ask.make(BOX, rng.uniform(0.2, 0.8, size=3) * size, radius, solids.random_pose(rng, 0.3 * size) if kind == 2 else STRAIGHT)
    return ask.make((CAPSULE, TRIANGLE, HULL, HULL)[kind - 3], rng.normal(size=(2 if kind == 3 else 3 if kind == 4 else rng.integers(4, 11), 3)) * 0.6 * size, radius)


def manifolds(answers):
    return [np.frombuffer(answer, solids.MANIFOLD)[0] for answer in answers]


def touching(ask, made):
    """The answers behind those of the makers, which all succeeded."""
    answers = ask.answers()
    assert [answer[4:40] for answer in answers[:made] if answer[:4] != b"\0\0\0\0"] == []
    return answers[made:]


def slack_of(a, b):
    """What collide3.h allows a least gap to be below the truth."""
    inner = [s["inner"] for s in (a, b) if s["faces"]]
    return min(inner, default=0) / 128 + 1e-4 * min(a["extent"], b["extent"]) + 1e-5 * (a["extent"] + b["extent"])


def check(m, a, b, on_a, on_b, reach):
    """One manifold; on_a, on_b: corners in the world, from a's position."""
    size, slack, radii = float(a["extent"] + b["extent"]), slack_of(a, b), float(a["radius"]) + float(b["radius"])
    gap = solids.signed_distance(on_a, on_b)[0] - radii
    count, normal, points = int(m["count"]), m["normal"].astype(float), m["point"][:m["count"]]
    if gap > reach + 1e-5 * size:
        assert count == 0
    if gap < reach - slack:
        assert count > 0
    if count == 0:
        return
    least = points["gap"].min()
    assert gap - slack <= least <= gap + 1e-4 * min(a["extent"], b["extent"]) + 1e-5 * size
    assert points["gap"].max() <= reach and abs(np.linalg.norm(normal) - 1) < 1e-6
    assert abs(solids.along(on_a, on_b, normal[None])[0] - radii - least) <= slack
    beside = 2e-6 * size if count != 2 else 0.03 * size        # two edges that are parallel within 0.1 rad
    for point in points:
        for hull, radius, sign in ((on_a, float(a["radius"]), -1), (on_b, float(b["radius"]), 1)):
            core = point["arm"] + sign * normal * (float(point["gap"]) / 2 + radius)
            away = solids.signed_distance(hull, core[None])[0] if len(hull) > 1 else np.linalg.norm(core - hull[0])
            assert -beside - slack * (least < 0) <= away <= beside + 2e-4 * size


def test_random_pairs(ask, long):
    """Gap, normal and points of a on b and of b on a; and distances."""
    rng = np.random.default_rng(20 if long else 1)
    for _ in range(80 if long else 1):
        few = 160
        cases = []
        for i in range(few):
            size, other = 10 ** rng.uniform(-2, 2), 10 ** rng.uniform(-0.5, 0.5)
            a, b = shape(ask, rng, size), shape(ask, rng, size * other)
            poses = solids.random_pose(rng, 10 * size), solids.random_pose(rng)
            poses[1][:3] = poses[0][:3] + rng.normal(size=3) * rng.choice([0.3, 0.7, 1.2]) * size * max(other, 1)
            cases.append((a, b, poses, REACH * size))
        for a, b, (pose_a, pose_b), reach in cases:
            ask.shape(a)
            ask.shape(b)
            ask.collide(a, pose_a, b, pose_b, reach)
            ask.collide(b, pose_b, a, pose_a, reach)
            ask.distance(a, pose_a, b, pose_b)
        answers = touching(ask, 2 * few)
        hits = 0
        for i, (_, _, poses, reach) in enumerate(cases):
            a, b = map(solids.read_shape, answers[5 * i:5 * i + 2])
            there, back = manifolds(answers[5 * i + 2:5 * i + 4])
            on_a, on_b = (solids.placed(solids.core(s), pose, poses[0][:3]) for s, pose in zip((a, b), poses))
            check(there, a, b, on_a, on_b, reach)
            shift = poses[1][:3].astype(float) - poses[0][:3]
            check(back, b, a, on_b - shift, on_a - shift, reach)
            hits += there["count"] > 0
            found = np.frombuffer(answers[5 * i + 4], solids.CLOSEST)[0]
            truth, size = solids.signed_distance(on_a, on_b)[0], float(a["extent"] + b["extent"])
            assert found["rounds"] < 40
            assert abs(found["distance"] - max(truth, 0)) <= 1e-5 * max(truth, 0) + 1e-6 * size
            assert found["least"] <= max(truth, 0) + 1e-6 * size
        assert hits > few / 3


def test_a_box_and_the_hull_of_its_corners(ask):
    """Fifteen directions by half sides, and those of the faces and edges of hulls."""
    rng = np.random.default_rng(4)
    cases = []
    for _ in range(200):
        halves, inside = rng.uniform(0.2, 1, size=(2, 3)), [solids.random_pose(rng, 0.2) for _ in "ab"]
        numbers = [ask.make(BOX, half, 0.0, pose) for half, pose in zip(halves, inside)]
        corners = [np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]) * half for half in halves]
        numbers += [ask.make(HULL, solids.placed(p, pose)) for p, pose in zip(corners, inside)]
        pose = solids.random_pose(rng), solids.random_pose(rng, 0.8)
        cases.append((numbers, pose))
    for numbers, pose in cases:
        ask.collide(numbers[0], pose[0], numbers[1], pose[1], REACH)
        ask.collide(numbers[2], pose[0], numbers[3], pose[1], REACH)
    all_of = manifolds(touching(ask, 800))
    alike = hits = 0
    for box, hull in zip(all_of[::2], all_of[1::2]):
        assert (box["count"] > 0) == (hull["count"] > 0)
        if box["count"]:
            hits += 1
            assert abs(box["point"]["gap"][:box["count"]].min() - hull["point"]["gap"][:hull["count"]].min()) < 0.01
            alike += np.allclose(box["normal"], hull["normal"], atol=1e-4) and box["count"] == hull["count"]
    assert hits > 60 and alike > 0.9 * hits


def test_the_origin_does_not_matter(ask):
    """Both moved by the same way, exactly: the same bits."""
    rng = np.random.default_rng(6)
    cases = []
    for _ in range(60):
        pair = shape(ask, rng), shape(ask, rng)
        poses = [solids.random_pose(rng) for _ in "ab"]
        for pose in poses:
            pose[:3] = np.round(pose[:3] * 64) / 64
        cases.append((pair, poses))
    for (a, b), (pose_a, pose_b) in cases:
        ask.collide(a, pose_a, b, pose_b, REACH)
        for pose in (pose_a, pose_b):
            pose[:3] += (4096, -8192, 1000)
        ask.collide(a, pose_a, b, pose_b, REACH)
    answers = touching(ask, 120)
    assert answers[::2] == answers[1::2] and sum(m["count"] > 0 for m in manifolds(answers)) > 20


def test_turned_as_a_whole(ask):
    """The same gaps, and a normal that turns along."""
    rng = np.random.default_rng(7)
    cases = []
    for _ in range(60):
        a, b = ask.make(BOX, rng.uniform(0.3, 0.8, size=3)), shape(ask, rng)
        cases.append((a, b, solids.random_pose(rng), solids.random_pose(rng, 0.7)))
    q = np.array([0.5, -0.1, 0.7, 0.4]) / np.linalg.norm([0.5, -0.1, 0.7, 0.4])

    def turned(pose):
        w, v = pose[3], pose[4:].astype(float)
        return np.concatenate([solids.turn(q) @ pose[:3], [q[0] * w - q[1:] @ v], q[0] * v + w * q[1:] + np.cross(q[1:], v)]).astype("f4")
    for a, b, pose_a, pose_b in cases:
        ask.collide(a, pose_a, b, pose_b, REACH)
        ask.collide(a, turned(pose_a), b, turned(pose_b), REACH)
    found = manifolds(touching(ask, 120))
    alike = hits = 0
    for one, other in zip(found[::2], found[1::2]):
        if one["count"] and other["count"]:
            hits += 1
            assert abs(one["point"]["gap"][:one["count"]].min() - other["point"]["gap"][:other["count"]].min()) < 0.01
            alike += np.allclose(solids.turn(q) @ one["normal"], other["normal"], atol=1e-3)
    assert hits > 20 and alike > 0.9 * hits


CUBE = np.array([(x, y, z) for z in (-0.5, 0.5) for y in (-0.5, 0.5) for x in (-0.5, 0.5)])


@pytest.mark.parametrize("turn", [0, 0.3, np.pi / 4, np.pi / 2])
@pytest.mark.parametrize("shift", [(0, 0), (0.3, 0.2)])
@pytest.mark.parametrize("kind, points", [(BOX, (0.5, 0.5, 0.5)), (HULL, CUBE)], ids=["boxes", "hulls"])
def test_a_face_on_a_face_does_not_flicker(ask, turn, shift, kind, points):
    """A box on an equal one, with noise in each pose: one normal, and the same four points in the same order, which hold all of the area."""
    rng = np.random.default_rng(8)
    box = ask.make(kind, points)
    for _ in range(60):
        noise = rng.uniform(-2e-6, 2e-6, size=(2, 7))
        ask.collide(box, np.array(AT_REST) + noise[0], box, np.array([*shift, 0.999, np.cos(turn / 2), 0, 0, np.sin(turn / 2)]) + noise[1], 0.02)
    found = manifolds(touching(ask, 1))
    assert {int(m["count"]) for m in found} == {4}
    for m in found:
        assert np.allclose(m["normal"], (0, 0, 1), atol=2e-5) and np.allclose(m["point"]["gap"], -0.001, atol=2e-5)
        assert np.allclose(m["point"]["arm"], found[0]["point"]["arm"], atol=1e-4)
    arms = found[0]["point"]["arm"][:, :2].astype(float)
    x, y = arms.T
    assert (0.8 * x + 0.6 * y).argmax() == 0
    area = (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2
    whole = {0: (1, 0.56), 0.3: (0.79, 0.45), np.pi / 4: (0.58, 0.4), np.pi / 2: (1, 0.56)}[turn][shift[0] > 0]
    assert area > whole - 0.02 and np.allclose(found[0]["point"]["arm"][:, 2], 0.4995, atol=1e-4)


def test_an_edge_across_an_edge(ask):
    """Two boxes, each stood on an edge: one point, and the way out is between the edges."""
    box = ask.make(BOX, (0.5, 0.5, 0.5))
    high = 2 ** 0.5 / 2
    ask.collide(box, (0, 0, 0, np.cos(np.pi / 8), np.sin(np.pi / 8), 0, 0), box, (0.1, 0.2, 2 * high - 0.05, np.cos(np.pi / 8), 0, np.sin(np.pi / 8), 0), 0)
    m, = manifolds(touching(ask, 1))
    assert m["count"] == 1 and np.allclose(m["normal"], (0, 0, 1), atol=1e-6)
    assert np.allclose(m["point"][0]["arm"], (0.1, 0, high - 0.025), atol=1e-5) and abs(m["point"][0]["gap"] + 0.05) < 1e-5


def test_capsules(ask):
    """Side by side: two points. Crossed, through each other, along each other: one or two, and a normal that makes sense."""
    c = ask.make(CAPSULE, [(-1, 0, 0), (1, 0, 0)], 0.25)
    across = (np.cos(np.pi / 4), 0, 0, np.sin(np.pi / 4))
    for at, turn in (((0.5, 0, 0.4), (1, 0, 0, 0)), ((0, 0, 0.4), across), ((0, 0, 0), across), ((0.5, 0, 0), (1, 0, 0, 0)), ((2.4, 0, 0), (1, 0, 0, 0))):
        ask.collide(c, AT_REST, c, (*at, *turn), 0)
    beside, crossed, through, within, end = manifolds(touching(ask, 1))
    assert beside["count"] == 2 and sorted(np.round(beside["point"]["arm"][:2, 0], 5)) == [-0.5, 1] and np.allclose(beside["point"]["gap"][:2], -0.1)
    assert beside["normal"].tolist() == [0, 0, 1] and crossed["count"] == 1 and abs(crossed["point"][0]["gap"] + 0.1) < 1e-6
    assert through["count"] == 1 and np.allclose(np.abs(through["normal"]), (0, 0, 1), atol=1e-6) and abs(through["point"][0]["gap"] + 0.5) < 1e-6
    assert within["count"] == 2 and abs(within["normal"][0]) < 1e-6 and np.allclose(within["point"]["gap"][:2], -0.5)
    assert end["count"] == 1 and np.allclose(end["normal"], (1, 0, 0)) and np.allclose(end["point"][0]["arm"], (1.2, 0, 0))


def test_a_capsule_on_a_box_has_two_points(ask):
    box, c = ask.make(BOX, (1, 1, 0.5)), ask.make(CAPSULE, [(-0.5, 0, 0), (0.5, 0, 0)], 0.25)
    for x in (0, 0.8, 1.4):
        ask.collide(box, AT_REST, c, (x, 0, 0.745, 1, 0, 0, 0), 0.02)
    for m, ends in zip(manifolds(touching(ask, 2)), ((-0.5, 0.5), (0.3, 1), (0.9, 1))):
        assert m["count"] == 2 and np.allclose(m["normal"], (0, 0, 1)) and np.allclose(m["point"]["gap"][:2], -0.005, atol=1e-6)
        assert np.allclose(sorted(m["point"]["arm"][:2, 0]), ends, atol=2e-4)


def test_a_plane(ask):
    """The corners below it, the four that stand for them, and a plane on a turned body."""
    rng = np.random.default_rng(9)
    cases = []
    for i in range(60):
        normal = rng.normal(size=3)
        cases.append((shape(ask, rng), normal / np.linalg.norm(normal), solids.random_pose(rng, 10), solids.random_pose(rng)))
    for number, normal, ground, pose in cases:
        pose[:3] = ground[:3] + solids.turn(ground[3:]) @ (normal * rng.uniform(0, 1))
        ask.shape(number)
        ask.plane(normal, 0.3, ground, number, pose, 0.1)
    answers = touching(ask, 60)
    hits = 0
    for i, (_, normal, ground, pose) in enumerate(cases):
        s, m = solids.read_shape(answers[2 * i]), manifolds([answers[2 * i + 1]])[0]
        p = solids.placed(solids.core(s), pose, ground[:3])
        n = solids.turn(ground[3:]) @ normal
        gaps = p @ n - float(np.float32(0.3)) - s["radius"]
        assert m["count"] == min((gaps <= 0.1).sum(), 4) or (abs(gaps - 0.1) < 1e-5).any() or m["count"] >= 3
        if m["count"]:
            hits += 1
            points = m["point"][:m["count"]]
            assert np.allclose(m["normal"], n, atol=1e-6) and abs(points["gap"].min() - gaps.min()) < 2e-3
            surface = points["arm"] - np.outer(points["gap"] / 2, n)
            assert np.allclose(surface @ n, 0.3, atol=1e-5)
            corner = points["arm"] + np.outer(points["gap"] / 2 + s["radius"], n)
            assert np.linalg.norm(corner[:, None] - p[None], axis=2).min(1).max() < 1e-5
    assert hits > 30


def test_points_are_matched_by_place(ask):
    old, new = np.zeros(2, solids.MANIFOLD)
    old["count"], new["count"] = 3, 4
    old["point"]["arm"] = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (9, 9, 9)]
    new["point"]["arm"] = [(0.02, 1, 0), (0.01, 0, 0), (0, 0.02, 0), (5, 5, 5)]
    for near in (0.1, 0.0):
        ask.ask(4, solids.MATCH, np.frombuffer(old.tobytes() + new.tobytes(), "f4"), near)
    assert [list(answer) for answer in ask.answers()] == [[2, 0, 4, 4], [4, 4, 4, 4]]


def extreme(ask, rng):
    """Tiny, huge, thin, needle-like, flat or far from its own origin: all that makers take."""
    size = 10 ** rng.uniform(-3, 3)
    kind, radius = rng.integers(0, 6), float(rng.choice([0, 1e-3, 1])) * size
    away = rng.normal(size=3) * size * rng.choice([0, 0, 1, 100])
    if kind == 0:
        return ask.make(BALL, away, radius)
    if kind == 1:
        return ask.make(CAPSULE, away + rng.normal(size=(2, 3)) * size * rng.choice([1e-5, 1]), radius)
    if kind == 2:
        return ask.make(TRIANGLE, away + rng.normal(size=(3, 3)) * size * [1, rng.choice([1e-3, 1]), 1], radius)
    if kind == 3:
        return ask.make(BOX, np.maximum(size * 10 ** rng.uniform(-3, 0, size=3), 2e-6), radius, np.append(away, rng.normal(size=4)).astype("f4"))
    return ask.make(HULL, away + rng.normal(size=(rng.integers(4, 33), 3)) * size * [1, rng.choice([1e-2, 1]), rng.choice([1e-2, 1])], radius)


def test_degenerate_input(ask, long):
    """No crash, no endless loop, no number that is not finite: shapes in one place, grid poses that make everything parallel, any reach."""
    rng = np.random.default_rng(10)
    tried = finite = 0
    for _ in range(40 if long else 1):
        numbers = [extreme(ask, rng) for _ in range(120)]
        poses = []
        for _ in range(4000):
            a, b = rng.choice(numbers, 2) if rng.uniform() < 0.8 else [rng.choice(numbers)] * 2
            pose = [np.array(AT_REST, "f4"), np.array(AT_REST, "f4")]
            for p in pose:
                if rng.uniform() < 0.5:
                    p[3:] = rng.integers(-1, 2, size=4)
                if rng.uniform() < 0.3:
                    p[3:] = rng.normal(size=4)
                if rng.uniform() < 0.5:
                    p[:3] = rng.integers(-2, 3, size=3) * 10 ** float(rng.integers(-3, 4))
                if rng.uniform() < 0.02:
                    p[rng.integers(0, 7)] = rng.choice([np.nan, np.inf, -np.inf, 3e38, 1e-40])
            reach = float(rng.choice([0, 1e-3, 1, 1e6, 3e38, np.inf, -1, np.nan]))
            poses.append(np.concatenate(pose))
            ask.collide(int(a), pose[0], int(b), pose[1], reach)
            ask.plane((0, 0, 1), float(rng.choice([0, 1e6])), pose[0], int(b), pose[1], reach)
        answers = ask.answers()[120:]
        for i, m in enumerate(np.frombuffer(b"".join(answers), solids.MANIFOLD)):
            used = m["point"][:m["count"]]
            tried += m["count"] > 0
            assert m["count"] <= 4 and np.isfinite(m["normal"]).all() and np.isfinite(used["arm"]).all() and np.isfinite(used["gap"]).all(), i
            assert not m["count"] or abs(np.linalg.norm(m["normal"].astype(float)) - 1) < 1e-5, i
            finite += bool(np.isfinite(poses[i // 2]).all())
            assert m["count"] == 0 or np.isfinite(poses[i // 2]).all()
    assert tried > 1000 and finite > 2000
