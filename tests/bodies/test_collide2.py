"""Where two shapes in the plane touch: against distances by all corners and edges and depths by all axes, in double."""

import platform
import subprocess

import numpy as np
import plane
import pytest

ULP = 2.0 ** -24


@pytest.fixture(scope="module")
def many(build, long):
    return plane.pairs(np.random.default_rng(5), 200_000 if long else 5000, build)


def test_the_least_gap_is_that_of_all_corners_and_edges(many):
    r, made = many
    wanted, extent, count = plane.truth(r, made), plane.extents(made), made["manifold"]["count"]
    some = count > 0
    assert some.mean() > 0.5 and (count == 2).mean() > 0.1 and (~some).mean() > 0.1
    reach, slack = r["reach"].astype(float), 2.0 ** -15 * extent
    assert (wanted[some] <= (reach + slack)[some]).all()
    assert (wanted[~some] >= (reach - slack)[~some]).all()
    error = np.abs(plane.least(made) - wanted)[some] / extent[some]
    assert error.max() <= 2.0 ** -15
    assert np.quantile(error, 0.97) <= 2.0 ** -22 and np.median(error) <= 2.0 ** -24


def test_points_are_on_both_surfaces(many):
    """The deepest always; the other one where no radius rounds a tilted edge. Half a gap along the normal leads to a, the other half to b."""
    r, made = many
    p, q = plane.cores(r, made)
    m, extent = made["manifold"], plane.extents(made)
    gap, arm, normal = (np.asarray(m[name] if name == "normal" else m["point"][name], float) for name in ("gap", "arm", "normal"))
    for k in (0, 1):
        deepest = gap[:, k] <= plane.least(made)
        for core, radius, sign in ((p, made["a"]["radius"], -1), (q, made["b"]["radius"], 1)):
            on = arm[:, k] + sign * 0.5 * gap[:, k, None] * normal
            off = np.abs(plane.depth(core, radius.astype(float), on[:, None])[:, 0]) / extent
            seen = (k < m["count"]) & (deepest | ((made["a"]["radius"] == 0) & (made["b"]["radius"] == 0)))
            assert seen.sum() > 400
            assert off[seen].max() <= 2.0 ** -14
            assert np.quantile(off[seen], 0.97) <= 2.0 ** -21


def test_normals_and_order(many):
    _, made = many
    m = made["manifold"]
    normal, two = m["normal"].astype(float), m["count"] == 2
    assert np.abs((normal ** 2).sum(1) - 1).max() <= 2.0 ** -20
    way = (m["point"]["arm"][:, 1] - m["point"]["arm"][:, 0]).astype(float)
    assert (way[:, 1] * normal[:, 0] - way[:, 0] * normal[:, 1])[two].min() >= 0


def test_the_normal_is_the_shortest_way_out(many):
    """Moved along the normal by the gap, the shapes touch."""
    r, made = many
    some = made["manifold"]["count"] > 0
    p, q = plane.cores(r, made)
    moved = q - (plane.least(made)[:, None] * made["manifold"]["normal"])[:, None]
    left = np.abs(plane.core_gap(p, moved) - sum(plane.radii(made)))[some] / plane.extents(made)[some]
    assert left.max() <= 2.0 ** -13
    assert np.quantile(left, 0.97) <= 2.0 ** -21


def test_swapped_shapes_touch_at_the_same_places(many, build):
    r, made = many
    other = r.copy()
    for side, with_ in ("ab", "ba"):
        other[side], other["pose_" + side] = r[with_], r["pose_" + with_]
    swapped = plane.ask(build, other)
    some = (made["manifold"]["count"] > 0) & (swapped["manifold"]["count"] > 0)
    extent = plane.extents(made)
    assert some.sum() >= 0.99 * (made["manifold"]["count"] > 0).sum()
    assert (np.abs(plane.least(made) - plane.least(swapped))[some] / extent[some]).max() <= 2.0 ** -15
    turned = (np.abs(made["manifold"]["normal"] + swapped["manifold"]["normal"]).max(1) < 1e-4)[some]
    assert turned.mean() > 0.95
    same = np.where(turned & (made["manifold"]["count"] == swapped["manifold"]["count"])[some])[0]
    first, back = made["manifold"][some][same], swapped["manifold"][some][same]
    way = (r["pose_a"]["at"].astype(float) - r["pose_b"]["at"])[some][same]
    for k in (0, 1):
        one = first["count"] == k + 1
        off = first["point"]["arm"][one, 0] + way[one] - back["point"]["arm"][one, k]
        assert np.quantile(np.abs(off).max(1) / extent[some][same][one], 0.95) <= 2.0 ** -14


def test_the_world_may_be_turned_and_moved(many, build):
    """Far from the origin the positions differ by what they lose there, and nothing else does."""
    r, made = many
    rng = np.random.default_rng(6)
    other, angle = r.copy(), rng.uniform(0, 2 * np.pi, len(r))
    c, s = np.cos(angle), np.sin(angle)
    away = other["pose_b"]["at"].astype(float) - other["pose_a"]["at"]
    other["pose_a"]["at"] = 0
    other["pose_b"]["at"] = np.stack([c * away[:, 0] - s * away[:, 1], s * away[:, 0] + c * away[:, 1]], 1)
    for pose in ("pose_a", "pose_b"):
        x, y = r[pose]["turn"].astype(float).T
        other[pose]["turn"] = np.stack([c * x - s * y, s * x + c * y], 1)
    turned = plane.ask(build, other)
    some = (made["manifold"]["count"] > 0) & (turned["manifold"]["count"] > 0)
    assert some.sum() >= 0.99 * (made["manifold"]["count"] > 0).sum()
    assert (np.abs(plane.least(made) - plane.least(turned))[some] / plane.extents(made)[some]).max() <= 2.0 ** -15
    x, y = made["manifold"]["normal"].astype(float).T
    off = np.abs(np.stack([c * x - s * y, s * x + c * y], 1) - turned["manifold"]["normal"]).max(1)[some]
    assert np.quantile(off, 0.95) <= 1e-5
    base = rng.integers(-8, 8, (len(r), 2)) * 2.0 ** np.ceil(np.log2(plane.extents(made)))[:, None]   # nothing is lost where it is so even
    grid = 2.0 ** (np.ceil(np.log2(plane.extents(made))) - 16)[:, None]
    for pose in ("pose_a", "pose_b"):
        other[pose]["at"] = np.round(other[pose]["at"] / grid) * grid
    here = plane.ask(build, other)
    for pose in ("pose_a", "pose_b"):
        other[pose]["at"] += base
    assert (plane.ask(build, other)["manifold"] == here["manifold"]).all()


def test_boxes_on_each_other_keep_their_normal(build):
    """Equal boxes with the tilt and the depth of a pile at rest: two points, and always a's normal."""
    rng = np.random.default_rng(7)
    r = plane.requests(1000)
    for side in "ab":
        r[side]["kind"], r[side]["radius"] = 0, 0
        r[side]["points"][:, :3] = [[0.5, 0.5], [0, 0], [1, 0]]
        tilt = rng.uniform(-1e-5, 1e-5, len(r))
        r["pose_" + side]["turn"] = np.stack([np.cos(tilt), np.sin(tilt)], 1)
    r["pose_b"]["at"] = np.stack([rng.uniform(-0.6, 0.6, len(r)), 1 - rng.uniform(-0.005, 0.01, len(r))], 1)
    r["reach"] = 0.02
    made = plane.ask(build, r)["manifold"]
    sine, cosine = r["pose_a"]["turn"][:, 1], r["pose_a"]["turn"][:, 0]
    assert (made["count"] == 2).all()
    assert (made["normal"] == np.stack([-sine, cosine], 1)).all()
    assert (made["point"]["arm"][:, 1, 0] < made["point"]["arm"][:, 0, 0]).all()


@pytest.mark.parametrize("reach", [0, 0.1])
def test_touching_exactly(build, reach):
    """Numbers that are exact: a box on a box, a disc on a box, discs, a capsule's end at a capsule's end, and coincident discs."""
    r = plane.requests(5)
    r["reach"] = reach
    for side in "ab":
        r[side]["points"][:2, :3] = [[0.5, 0.25], [0, 0], [1, 0]]
        r[side]["kind"][0], r[side]["radius"][0] = 0, 0
        r[side]["kind"][3], r[side]["radius"][3], r[side]["points"][3, :2] = 2, 0.25, [[-0.5, 0], [0.5, 0]]
    r["a"]["kind"][1], r["a"]["radius"][1] = 0, 0
    r["b"]["points"][[1, 2, 4]] = r["a"]["points"][[2, 4]] = 0
    r["b"]["radius"][1], r["b"]["radius"][2] = 0.5, 0.5
    r["pose_b"]["at"] = [[0.25, 0.5], [0.25, 0.75], [1.5, 0], [1.5, 0], [0, 0]]
    made = plane.ask(build, r)["manifold"]
    assert made["normal"].tolist() == [[0, 1], [0, 1], [1, 0], [1, 0], [0, 1]]
    assert made["count"].tolist() == [2, 1, 1, 1, 1]
    assert made["point"]["gap"][:, 0].tolist() == [0, 0, 0, 0, -2]
    assert made["point"]["arm"].tolist()[0] == [[0.5, 0.25], [-0.25, 0.25]]
    assert made["point"]["arm"][1:4, 0].tolist() == [[0.25, 0.25], [1, 0], [0.75, 0]]


def test_nothing_crashes_and_nothing_becomes_nan(build, long):
    """Shapes of all sizes that makers take; poses far away, not finite, without a turn; deep, coincident, parallel."""
    rng = np.random.default_rng(8)
    r = plane.requests(200_000 if long else 5000)
    for side in "ab":
        plane.shapes(rng, r[side], 10.0 ** rng.uniform(-5, 5, len(r)), sharp=0.3)
        plane.turns(rng, r["pose_" + side], 0.5)
        r["pose_" + side]["at"] = 10.0 ** rng.uniform(-9, 6, (len(r), 2)) * rng.choice([-1, 0, 1], (len(r), 2))
    alike = rng.uniform(size=len(r)) < 0.3
    r["b"][alike], r["pose_b"]["turn"][alike] = r["a"][alike], r["pose_a"]["turn"][alike]
    r["pose_b"]["at"][alike] = r["pose_a"]["at"][alike] * rng.choice([1, 1, 1.0000001, -1], alike.sum())[:, None]
    r["reach"] = rng.choice([0, 1e-3, 10], len(r))
    made = plane.ask(build, r)
    made = made[made["failed"] == 0]["manifold"]
    assert len(made) > 0.9 * len(r) and (made["count"] > 0).mean() > 0.3
    assert np.isfinite(made["normal"]).all() and np.isfinite(made["point"]["arm"]).all() and np.isfinite(made["point"]["gap"]).all()
    wild = rng.choice([0, 1, -1, 2, 1e20, 3e38, 1e-40, np.inf, -np.inf, np.nan], (len(r), 8))
    for k, (pose, part) in enumerate((pose, part) for pose in ("pose_a", "pose_b") for part in ("at", "turn")):
        chosen = rng.uniform(size=len(r)) < 0.5
        r[pose][part][chosen] = wild[chosen, 2 * k:2 * k + 2]
    made = plane.ask(build, r)
    made = made[made["failed"] == 0]["manifold"]
    assert np.isfinite(made["normal"]).all() and np.isfinite(made["point"]["arm"]).all() and np.isfinite(made["point"]["gap"]).all()


# ---- chains ----

def slide(rng, count, width, kind, radius, tilt, gap):
    """A shape over a floor of 100 edges from right to left, at places that are more often near a joint; each edge asked once."""
    r = plane.requests(count * 100, plane.LINK)
    edge = np.tile(np.arange(100), count)
    r["a"]["points"][:, :4, 0] = (50 - edge)[:, None] * width - np.arange(-1, 3) * width
    r["a"]["radius"] = 0
    r["ends"] = np.where(edge == 0, 1, 0) + np.where(edge == 99, 2, 0)
    x = rng.uniform(-20, 20, count) * width
    near = rng.uniform(size=count) < 0.7
    x[near] = (np.round(x / width) * width + rng.choice([-1, 1], count) * (0.5 + rng.uniform(-0.01, 0.01, count)))[near]
    r["b"]["kind"], r["b"]["radius"] = kind, radius
    half = 0.5 - radius
    r["b"]["points"][:, :3] = {0: [[half, half], [0, 0], [1, 0]], 1: [[0, 0]] * 3, 2: [[-half, 0], [half, 0], [0, 0]]}[kind]
    r["pose_b"]["turn"] = np.stack([np.cos(tilt), np.sin(tilt)], -1)
    corners = np.array([[sx * half, sy * half * (kind != 2)] for sx in (-1, 1) for sy in (-1, 1)]) * (kind != 1)
    low = (np.sin(tilt) * corners[:, 0] + np.cos(tilt) * corners[:, 1]).min() - radius
    r["pose_b"]["at"] = np.stack([np.repeat(x, 100), np.full(len(r), gap - low)], 1)
    r["reach"] = 0.02
    return r


@pytest.mark.parametrize("kind, radius", [(0, 0), (0, 0.1), (1, 0.5), (2, 0.25)])
@pytest.mark.parametrize("width", [0.125, 1, 7])
def test_nothing_catches_on_a_joint(build, kind, radius, width):
    """The normal of each contact is (0, 1) to the last bit, and there is always one with the right gap."""
    rng = np.random.default_rng(9)
    for tilt in (0, 1e-6, 1e-3, -0.3):
        for gap in (-0.02, -0.001, 0, 0.01):
            asked = slide(rng, 40, width, kind, radius, tilt, gap)
            made = plane.ask(build, asked)["manifold"]
            some = made["count"] > 0
            assert (made["normal"][some] == [0, 1]).all()
            arms = made["point"]["arm"][..., 0][:, ::-1].T     # of one edge, not of its neighbours
            assert (some <= ((arms > asked["a"]["points"][:, 2, 0] - 3e-4) & (arms < asked["a"]["points"][:, 1, 0] + 3e-4)).any(0)).all()
            gaps = np.where(np.arange(2) < made["count"][:, None], made["point"]["gap"], 9).min(1).reshape(-1, 100).min(1)
            assert np.abs(gaps - gap).max() < 2e-5


def test_a_chain_around_a_polygon_is_that_polygon(build, long):
    """Outside of convex ground, the deepest point of all edges is that of the polygon, with its normal; corners are met once."""
    rng = np.random.default_rng(10)
    r, made = plane.pairs(rng, 30_000 if long else 1500, build, 0.1, range(3, 9))
    plane.shapes(rng, r["b"], plane.extents(made) / 3, [0, 1, 3, 4, 5, 6, 7, 8])     # no segment, whose middle is at once behind
    r["a"]["radius"] = 0
    r, made = plane.moved(rng, r, build, 0.05)
    count = made["a"]["count"].astype(int)
    link = np.repeat(r, count)
    edge = np.concatenate([np.arange(n) for n in count])
    link["what"] = plane.LINK
    for k in range(4):
        at = (edge + k - 1) % np.repeat(count, count)
        link["a"]["points"][:, k] = np.repeat(plane.corners(made["a"]), count, 0)[np.arange(len(link)), at]
    each = plane.ask(build, link)["manifold"]
    gap = np.where(each["count"] == 2, each["point"]["gap"].min(1), each["point"]["gap"][:, 0]).astype(float)
    gap[each["count"] == 0] = np.inf
    first = np.concatenate([[0], np.cumsum(count)[:-1]])
    best = np.minimum.reduceat(gap, first)
    some = made["manifold"]["count"] > 0
    extent = plane.extents(made)
    assert some.mean() > 0.5
    assert (np.isinf(best) == ~some).mean() > 0.998
    both = some & np.isfinite(best)
    assert np.quantile(np.abs(best - plane.least(made))[both] / extent[both], 0.998) <= 2.0 ** -15
    chosen = np.array([f + np.argmin(gap[f:f + n]) for f, n in zip(first, count)])
    off = np.abs(each["normal"][chosen] - made["manifold"]["normal"]).max(1)[both]
    assert np.quantile(off, 0.99) < 1e-4
    deepest = gap <= np.repeat(best + 1e-6 * extent, count)
    faces = np.abs(made["manifold"]["normal"][:, None] - plane.turned(r["pose_a"], plane.normals(made["a"]))).max(2).min(1) < 0.05
    corner = both & (made["manifold"]["count"] == 1) & ~faces
    assert corner.sum() > 100
    assert (np.add.reduceat(deepest.astype(int), first)[corner] == 1).mean() > 0.998


@pytest.mark.skipif(platform.machine() != "x86_64", reason="multiply-adds of another processor")
@pytest.mark.parametrize("name", ["shape2", "collide2", "query2"])
def test_no_compiler_fuses_a_product_with_a_sum(root, name):
    """gcc 12 makes vfmaddsub of a turn in spite of -ffp-contract=off, so the turn is written so that it cannot."""
    text = subprocess.run(["gcc", "-std=c11", "-D_GNU_SOURCE", "-O3", "-march=x86-64-v3", "-ffp-contract=off", "-S", "-o", "-", "-I", root / "sw/include", "-I",
                           root / "sw", root / f"sw/bodies/shapes/{name}.c"], capture_output=True, text=True, check=True).stdout
    assert "vmulss" in text and "vfm" not in text and "vfnm" not in text
