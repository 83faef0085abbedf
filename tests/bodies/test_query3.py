"""Distances, rays, casts and times of impact in space: against separations in double, at the place found and along the way to it."""

import numpy as np
import pytest
import solids
from solids import BALL, BOX, CAPSULE, HULL, TRIANGLE

APART = np.dtype([("is", "u4"), ("overlap", "u4"), ("gap", "f4"), ("normal", "3f4"), ("arm_a", "3f4"), ("arm_b", "3f4")])
HIT = np.dtype([("is", "u4"), ("fraction", "f4"), ("normal", "3f4"), ("arm", "3f4")])
AT_REST = np.array((0, 0, 0, 1, 0, 0, 0), "f4")


@pytest.fixture
def ask(build):
    return solids.Solids(build / "tests/solids3")


def shape(ask, rng, round_ones=True):
    """The number, the corners and the radius."""
    kind, radius = rng.integers(0, 5), float(rng.choice([0, 0.25])) if round_ones else 0.0
    if kind == 0:
        p, radius = rng.normal(size=(1, 3)) * 0.2, 0.5
        return ask.make(BALL, p, radius), p, radius
    if kind == 1:
        half = rng.uniform(0.2, 0.8, size=3)
        return ask.make(BOX, half, radius), np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half, radius
    p = rng.normal(size=({2: 2, 3: 3, 4: 5}[kind], 3)) * 0.6
    return ask.make((CAPSULE, TRIANGLE, HULL)[kind - 2], p, radius), p, radius


def between(q, other, fraction):
    """The chord between two quaternions."""
    q, other = q / np.linalg.norm(q), other / np.linalg.norm(other)
    return q + fraction * ((-other if q @ other < 0 else other) - q)


def answers(ask, made, kind):
    found = ask.answers()
    assert [answer[4:40] for answer in found[:made] if answer[:4] != b"\0\0\0\0"] == []
    return np.frombuffer(b"".join(found[made:]), kind)


def test_measure(ask):
    """Gap, both points and overlap, far apart and in each other."""
    rng = np.random.default_rng(1)
    cases = []
    for _ in range(150):
        a, b = shape(ask, rng), shape(ask, rng)
        cases.append((a, b, solids.random_pose(rng, 10), solids.random_pose(rng)))
    for a, b, pose_a, pose_b in cases:
        pose_b[:3] = pose_a[:3] + rng.normal(size=3) * rng.choice([0.5, 2, 20])
        ask.ask(48, solids.MEASURE, a[0], b[0], pose_a, pose_b)
    for found, (a, b, pose_a, pose_b) in zip(answers(ask, 300, APART), cases):
        on_a, on_b = (solids.placed(p[1], pose, pose_a[:3]) for p, pose in zip((a, b), (pose_a, pose_b)))
        gap = solids.signed_distance(on_a, on_b)[0] - a[2] - b[2]
        n = found["normal"].astype(float)
        assert found["is"] and abs(found["gap"] - gap) < (2e-5 + 1e-5 * abs(gap) if gap + a[2] + b[2] > 1e-4 else 0.02)
        assert abs(np.linalg.norm(n) - 1) < 1e-6 and abs(gap) < 1e-4 or bool(found["overlap"]) == (gap < 0)
        assert np.allclose(found["arm_b"] - found["arm_a"].astype(float), found["gap"] * n, atol=3e-5 if gap + a[2] + b[2] > 1e-4 else 0.05)
        if gap + a[2] + b[2] > 1e-4:
            for hull, arm, radius in ((on_a, found["arm_a"], a[2]), (on_b, found["arm_b"], b[2])):
                assert abs(solids.signed_distance(hull, arm[None].astype(float))[0] - radius) < 3e-5


def test_rays(ask):
    """The place is on the surface, and everything before it is outside; a miss is outside all along; the normal is against the ray."""
    rng = np.random.default_rng(2)
    cases = []
    for _ in range(110):
        s = shape(ask, rng)
        pose = solids.random_pose(rng, 10)
        start = (rng.normal(size=3) * rng.choice([0.1, 3, 3, 30])).astype("f4")
        cases.append((s, pose, start, (rng.normal(size=3) * 0.5 - start * rng.choice([0.5, 1.5, 1.5])).astype("f4")))
    for s, pose, start, way in cases:
        ask.ask(32, solids.RAY, s[0], pose, pose[:3] + start, way)
    hits = 0
    for found, (s, pose, start, way) in zip(answers(ask, 110, HIT), cases):
        hull, start = solids.placed(s[1], pose, pose[:3]), (pose[:3] + start).astype("f4").astype(float) - pose[:3]
        slack = 2.0 ** -16 * (2 + np.linalg.norm(start) + np.linalg.norm(way))

        def outside(fraction):
            at = (start + fraction * way)[None]
            return (solids.signed_distance(hull, at)[0] if len(hull) > 1 else np.linalg.norm(hull - at)) - s[2]
        until = float(found["fraction"]) if found["is"] else 1
        assert all(outside(until * f) >= -slack for f in np.linspace(0, 1, 15)[:-1 if found["is"] else None]) or until == 0
        if found["is"]:
            assert (until == 0 and outside(0) < slack) or abs(outside(until)) < slack
            assert np.allclose(found["arm"], start + until * way, atol=slack) and found["normal"].astype(float) @ way < 1e-5
            assert abs(np.linalg.norm(found["normal"].astype(float)) - 1) < 1e-5
            hits += until > 0
    assert 30 < hits < 90


@pytest.mark.parametrize("is_cast", [0, 1])
def test_impacts(ask, is_cast):
    """At the fraction the gap is at most slop, before it at least half; where nothing is hit, all along."""
    rng = np.random.default_rng(3)
    cases, slop = [], 0.01
    for _ in range(60):
        a, b = shape(ask, rng), shape(ask, rng)
        poses = [solids.random_pose(rng) for _ in range(4)]
        poses[2][:3] = poses[0][:3] + rng.normal(size=3) * 3
        poses[3][:3] = poses[0][:3] - rng.normal(size=3) * 0.7
        if is_cast:
            poses[1], poses[3][3:] = poses[0], poses[2][3:]
        cases.append((a, b, poses))
    for a, b, poses in cases:
        if is_cast:
            ask.ask(32, solids.CAST, a[0], b[0], poses[0], poses[2], poses[3][:3] - poses[2][:3], slop)
        else:
            ask.ask(32, solids.IMPACT, a[0], b[0], *poses, slop)
    hits = 0
    for found, (a, b, poses) in zip(answers(ask, 120, HIT), cases):
        def gap(fraction):
            at = [np.concatenate([p[:3] + fraction * (q[:3].astype(float) - p[:3]), between(p[3:].astype(float), q[3:].astype(float), fraction)])
                  for p, q in (poses[:2], poses[2:])]
            on_a, on_b = (solids.placed(s[1], pose, at[0][:3]) for s, pose in zip((a, b), at))
            return (solids.signed_distance(on_a, on_b)[0] if len(on_a) + len(on_b) > 2 else np.linalg.norm(on_a - on_b)) - a[2] - b[2]
        until = float(found["fraction"]) if found["is"] else 1
        eps = 2e-4
        if until == 0:
            assert gap(0) < slop + eps
            continue
        assert all(gap(until * f) >= slop / 2 - eps for f in np.linspace(0, 1, 12))
        if found["is"]:
            assert gap(until) <= slop + eps
            hits += 1
    assert hits > 10


def test_a_bullet_stops_at_a_thin_wall(ask):
    """A way of 1e4 walls; and a rod that turns into it."""
    wall, bullet = ask.make(BOX, (0.005, 5, 5)), ask.make(BALL, (0, 0, 0), 0.01)
    rod = ask.make(CAPSULE, [(0, 0, 0), (2, 0, 0)], 0.01)
    turn = (np.cos(np.pi / 4), 0, 0, np.sin(np.pi / 4))
    ask.ask(32, solids.CAST, wall, bullet, AT_REST, (-20, 0.3, 0.2, 1, 0, 0, 0), (100, 0, 0), 0.002)
    ask.ask(32, solids.IMPACT, wall, rod, AT_REST, AT_REST, (-1, 0, 0, *turn), (-1, 0, 0, 1, 0, 0, 0), 0.002)
    first, second = answers(ask, 3, HIT)
    assert first["is"] and 19.985 - 0.002 <= 100 * first["fraction"] <= 19.985 and np.allclose(first["normal"], (-1, 0, 0), atol=1e-4)
    # The tip is at 1 - 0.005 - 0.01 where the angle from the wall is asin(0.4925); the chord of a quarter turn.
    angle = np.pi / 2 - np.arcsin(0.4925)
    truth = 0.5 - np.tan(angle / 2 - np.pi / 8) / np.tan(np.pi / 8) / 2
    assert second["is"] and truth - 0.004 < second["fraction"] < truth


def test_degenerate_queries(ask):
    """Nothing that is not finite comes of what is finite, and nothing hangs."""
    rng = np.random.default_rng(4)
    numbers = [shape(ask, rng)[0] for _ in range(30)] + [ask.make(BALL, (0, 0, 0), 0.0), ask.make(CAPSULE, [(0, 0, 0), (1e-3, 0, 0)]),
                                                           ask.make(BOX, (1e3, 1e-3, 1)), ask.make(TRIANGLE, [(0, 0, 0), (1e3, 0, 0), (0, 1e3, 0)])]
    poses, odd = [], [np.nan, np.inf, 3e38, 1e-40]
    for _ in range(900):
        p = np.concatenate([AT_REST] * 4).astype("f4")
        p[rng.integers(0, 28, size=8)] += rng.integers(-2, 3, size=8)
        if rng.uniform() < 0.1:
            p[rng.integers(0, 28)] = rng.choice(odd)
        poses.append(p)
        a, b = (int(rng.choice(numbers)) for _ in "ab")
        slop = float(rng.choice([0, 0.01, -1, np.nan]))
        ask.ask(48, solids.MEASURE, a, b, p[:14])
        ask.ask(32, solids.RAY, a, p[:7], p[7:13])
        ask.ask(32, solids.IMPACT, a, b, p, slop)
        ask.ask(32, solids.CAST, a, b, p[:14], p[14:17], slop)
    found, some = ask.answers()[34:], 0
    for i, answer in enumerate(found):
        words = np.frombuffer(answer, "f4")[2 if i % 4 == 0 else 1:]
        used = poses[i // 4][:[14, 13, 28, 17][i % 4]]
        is_hit = np.frombuffer(answer, "u4")[0]
        some += is_hit
        assert np.isfinite(words).all(), (i, words)
        assert not is_hit or np.isfinite(used).all()
        assert i % 4 == 0 or not is_hit or 0 <= words[0] <= 1
    assert some > 1000
