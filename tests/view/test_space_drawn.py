"""Bodies in space, in pictures and in the page, beside a truth that shares nothing with sw/view: rays that walk to the nearest surface."""

import json
import re

import numpy
import pytest
from test_bodies_drawn import BACK, GREY, MARK, TOUCH, is_about, pale
from test_pictures import pictures

h5py = pytest.importorskip("h5py")

WIDTH, HEIGHT, TURN = 120, 90, (25, 30)
SEE = numpy.array([(-4, 4), (-2, 3), (-3, 3)], float)
BALL, PILL, BOX, PLANE, ASLEEP, SENSOR = range(6)               # objects; a box is rounded
PLACES = numpy.array([(-2.5, 0.3, 0.5), (0.5, 0.6, 1.2), (0.3, 0.2, -0.8), (0, -1, 0), (2.6, 0, 0.3), (-0.9, 1.5, 1.5)])
TURNS = numpy.array([(0.9, 0.2, 0.3, 0.1), (0.5, 0.3, -0.6, 0.4), (2, 0.4, 1, -0.3), (1, 0, 0, 0), (1, 0.2, 0.1, 0.5), (1, 0, 0, 0)])
HALF, RADIUS, ENDS = numpy.array([1.2, 0.5, 0.7]), {BALL: 0.9, PILL: 0.4, BOX: 0.15, ASLEEP: 0.05, SENSOR: 0.6}, numpy.array([(-1, 0, 0), (1, 0, 0)])
SMALL = numpy.array([0.5, 0.8, 0.4])
CORNERS = numpy.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]     # anticlockwise from outside
NORMAL = numpy.array([0, 1, 0.2]) / numpy.hypot(1, 0.2)
STOPS = numpy.array([[52, 41, 122], [38, 98, 168], [22, 146, 156], [74, 184, 112], [170, 205, 66], [250, 218, 72]])


def record(path):
    """Two snapshots; in the second the ball is turned by 0.3 about an axis across its own."""
    def triangles(first):
        return [(first + side[0], first + side[k], first + side[k + 1]) for side in SIDES for k in (1, 2)]
    shapes = [(BALL, [(0, 0, 0)], 0), (PILL, ENDS, 0), (BOX, CORNERS * HALF, 0), (PLANE, [0 * NORMAL, NORMAL], 2), (ASLEEP, CORNERS * SMALL, 0), (SENSOR, [(0, 0, 0)], 0)]
    radii = [0.9, 0.4, 0.15, numpy.inf, 0.05, 0.6]
    with h5py.File(path, "w") as file:
        file["step"], file["time"] = numpy.arange(2, dtype="u8"), numpy.arange(2) * 0.1
        file["time"].attrs["units"] = "s"
        for k, name in enumerate("xyz"):
            file[f"x_{name}"] = numpy.tile(PLACES[:, k], (2, 1))
            file[f"x_{name}"].attrs["units"] = "m"
        turns = numpy.array([TURNS, TURNS])
        turns[1, BALL] = (0.9 - 0.03, 0.2 + 0.135, 0.3 + 0.015, 0.1 - 0.045)
        for k, name in enumerate("wxyz"):
            file[f"q_{name}"] = turns[:, :, k]
        file["at_rest"] = numpy.where(numpy.arange(6) == ASLEEP, -1.0, 0)[None].repeat(2, axis=0)
        file["number"] = numpy.tile(numpy.arange(6.0), (2, 1))
        file["shapes:of"] = numpy.array([(of, len(corners), of == SENSOR, kind) for of, corners, kind in shapes], "u4")
        file["shapes:radius"] = numpy.array(radii)[:, None]
        file["shapes:corners"] = numpy.concatenate([corners for _, corners, _ in shapes])
        file["shapes:triangles"] = numpy.array(triangles(3) + triangles(13), "u4")
        file["joints:of"] = numpy.array([(PLANE, ASLEEP, 0, 1)], "u4")
        file["joints:anchors"] = numpy.array([(*PLACES[ASLEEP] - PLACES[PLANE], 0, 0, 0)])
        file["contacts:of"] = numpy.array([(1, PLANE, BALL)], "u4")
        file["contacts:points"] = numpy.array([(-3, -1, 2, 0, 1, 0, 5.0)])


# ---- the truth ----

def matrix(q):
    w, x, y, z = numpy.asarray(q) / numpy.linalg.norm(q)
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def eye():
    """Where the eye is, in metres; right, up, back; and pixels a tangent."""
    azimuth, elevation = numpy.radians(TURN)
    right = numpy.array([numpy.cos(azimuth), 0, -numpy.sin(azimuth)])
    back = numpy.array([numpy.sin(azimuth) * numpy.cos(elevation), numpy.sin(elevation), numpy.cos(azimuth) * numpy.cos(elevation)])
    tangent = numpy.tan(numpy.radians(17.5))
    middle, half = SEE.mean(axis=1), numpy.ptp(SEE, axis=1) / 2
    return middle + back * numpy.linalg.norm(half) * 1.04 / tangent, numpy.array([right, numpy.cross(back, right), back]), HEIGHT / 2 / tangent


def seen(x):
    at, axes, zoom = eye()
    right, up, back = axes @ (numpy.asarray(x) - at)
    return numpy.array([WIDTH / 2 - right / back * zoom, HEIGHT / 2 + up / back * zoom])


def pixel(made, x):
    column, row = seen(x)
    return tuple(int(c) for c in made[int(row), int(column)])


def on_frame():
    """Pixels of the edges of what is seen, which the truth leaves out."""
    found = numpy.zeros((HEIGHT, WIDTH), bool)
    for a, b in ((a, b) for a in CORNERS for b in CORNERS if (b - a).sum() == 2 == abs(a - b).sum()):
        for share in numpy.linspace(0, 1, 150):
            column, row = seen(SEE.mean(axis=1) + (a + (b - a) * share) * numpy.ptp(SEE, axis=1) / 2).astype(int)
            found[row - 1:row + 2, column - 1:column + 2] = True
    return found


def distance(of, p):
    """From points of the body's axes to its surface."""
    if of in (BOX, ASLEEP):
        d = abs(p) - (HALF if of == BOX else SMALL)
        return numpy.linalg.norm(numpy.maximum(d, 0), axis=-1) + numpy.minimum(d.max(axis=-1), 0) - RADIUS[of]
    if of == PILL:
        p = p - numpy.clip(p[..., :1], -1, 1) * [1, 0, 0]
    return numpy.linalg.norm(p, axis=-1) - RADIUS[of] if of != PLANE else p @ NORMAL


def gradient(of, p):
    return numpy.stack([distance(of, p + step) - distance(of, p - step) for step in 1e-5 * numpy.eye(3)], axis=-1) / 2e-5


def truth(solid):
    """For each part of a pixel what is met first, and its colour."""
    at, axes, zoom = eye()
    y, x = numpy.mgrid[0:2 * HEIGHT, 0:2 * WIDTH] / 2 + 0.25
    ways = numpy.stack([(x - WIDTH / 2) / zoom, (HEIGHT / 2 - y) / zoom, -numpy.ones_like(x)], axis=-1) @ axes
    ways /= numpy.linalg.norm(ways, axis=-1, keepdims=True)
    nearest, colours = numpy.full(x.shape, numpy.inf), numpy.tile(numpy.array(BACK, float), (*x.shape, 1))
    for of in solid:
        turn = matrix(TURNS[of])
        origin, way = (at - PLACES[of]) @ turn, ways @ turn
        near = numpy.linalg.norm(numpy.cross(way, origin), axis=-1) < 2         # the others go past it
        far, gap = numpy.full(x.shape, numpy.inf), numpy.full(x.shape, numpy.inf)
        if of == PLANE:
            far, gap = numpy.where(way @ NORMAL < 0, -(origin @ NORMAL) / (way @ NORMAL), numpy.inf), numpy.zeros(x.shape)
        else:
            walked = numpy.zeros(near.sum())
            for _ in range(60):
                walked += (left := distance(of, origin + walked[:, None] * way[near]))
            far[near], gap[near] = walked, left
        p = origin + numpy.where(numpy.isfinite(far), far, 0)[..., None] * way
        is_met = (abs(gap) < 2e-3) & (far < nearest)
        if of == PLANE:         # a disc within the ball around all that is seen, from above alone
            is_met &= numpy.linalg.norm(p + PLACES[PLANE] - SEE.mean(axis=1), axis=-1) < numpy.linalg.norm(numpy.ptp(SEE, axis=1) / 2)
        normal = gradient(of, p)
        towards = numpy.clip((normal @ turn.T @ axes.T) @ [-5, 8, 10] / 14, 0, 1)
        light = 0.5 + 0.5 * towards
        if of in (BALL, PILL):
            light *= numpy.where((normal[..., 1] * normal[..., 0 if of == BALL else 2]) < 0, 13 / 16, 1)
        ink = pale(GREY, 0.6) if of == PLANE else pale(STOPS[of], 0.6 if of == ASLEEP else 0.3)
        colours = numpy.where(is_met[..., None], light[..., None] * ink, colours)
        nearest = numpy.where(is_met, far, nearest)
    return colours.reshape(HEIGHT, 2, WIDTH, 2, 3).mean(axis=(1, 3))


@pytest.fixture
def space(tmp_path):
    record(tmp_path / "x.h5")
    return tmp_path / "x.h5"


LOOK = ["--see", ",".join(f"{a}:{b}" for a, b in SEE), "--colour", "number"]
SHOT = [*LOOK, "--turn", ":".join(map(str, TURN)), "--width", str(WIDTH), "--height", str(HEIGHT)]


def without(path, *objects):
    """The same without these objects' shapes, joints and contacts."""
    with h5py.File(path, "r+") as file:
        for of in objects:
            file["x_x"][:, of] = numpy.nan


def test_what_is_nearest_is_seen_where_it_is_in_its_light(run, space, tmp_path):
    """All but the sensor and the joint."""
    without(space, SENSOR)
    with h5py.File(space, "r+") as file:
        file["joints:of"][0, 3] = 0
    run("view", "x.h5", *SHOT, "--at", "0", "--png", "a.png")
    made, expected, frame = pictures(tmp_path / "a.png")[0].astype(int), truth([BALL, PILL, BOX, PLANE, ASLEEP]), on_frame()
    differ = abs(made - expected).max(axis=2) > 3
    assert differ[~frame].mean() < 0.005 and frame.mean() < 0.2, f"{differ[~frame].mean():.4f}"
    assert all((abs(expected - pale(ink, share)).max(axis=2) < 90).any() for ink, share in ((STOPS[ASLEEP], 0.6), (STOPS[BOX], 0.3)))


def test_a_ball_shows_how_it_is_turned_and_its_joint_breaks(run, space, tmp_path):
    run("view", "x.h5", *SHOT, "--film", "f.png", "--contacts")
    first, second = (made.astype(int) for made in pictures(tmp_path / "f.png"))
    assert is_about(pixel(first, PLACES[ASLEEP]), MARK) and not is_about(pixel(second, PLACES[ASLEEP]), MARK)        # before all bodies
    assert is_about(pixel(second, (-3, -1, 2)), TOUCH) and not is_about(pixel(first, (-3, -1, 2)), TOUCH)
    assert is_about(pixel(second, (-3, -0.5, 2)), TOUCH)            # the largest force has 60 pixels
    differ = abs(first - second).max(axis=2) > 20
    assert differ.sum() > 20 and is_about(pixel(first, PLACES[BOX]), pixel(second, PLACES[BOX]))


def test_a_sensor_is_a_veil(run, space, tmp_path):
    run("view", "x.h5", *SHOT, "--at", "0", "--png", "a.png")
    without(space, SENSOR)
    run("view", "x.h5", *SHOT, "--at", "0", "--png", "b.png")
    made, bare = (pictures(tmp_path / name)[0].astype(int) for name in ("a.png", "b.png"))
    change = abs(made - bare).max(axis=2)
    assert 80 < (change > 0).sum() < 1000 and 5 < numpy.median(change[change > 0]) < 60


def test_a_rounded_sensor_veils_once(run, space, tmp_path):
    """Faces, edges and corners of a box of a radius: one veil over the background, whose light differs."""
    without(space, BALL, PILL, PLANE, ASLEEP, SENSOR)
    inks = []
    for sensor in (0, 1):
        with h5py.File(space, "r+") as file:
            file["shapes:of"][2, 2], file["joints:of"][0, 3] = sensor, 0
        run("view", "x.h5", *SHOT, "--at", "0", "--png", "a.png")
        inks.append(pictures(tmp_path / "a.png")[0].astype(int))
    on = (abs(inks[0] - BACK).max(axis=2) > 20) & ~on_frame()
    away = (inks[1] - BACK)[on].sum(axis=1) / 3                       # a veil in the least light makes it 42 darker, a second one 29 more
    assert on.sum() > 150 and -45 < away.min() < -20, (on.sum(), away.min())


def test_what_is_behind_the_eye_has_no_mark(run, space, tmp_path):
    """A contact, a joint, a segment without a radius and a ball there; of a joint from before the eye to behind it, its part before it."""
    without(space, *range(6))
    run("view", "x.h5", *SHOT, "--at", "0.1", "--png", "bare.png")
    at, axes, _ = eye()
    def behind(right, up, deep):
        return at + axes.T @ [right, up, deep]
    before = at - 12 * axes[2]
    def place(file, of, x):
        for k, name in enumerate("xyz"):
            file[f"x_{name}"][:, of] = x[k]
    with h5py.File(space, "r+") as file:
        for of in (BALL, PILL, ASLEEP, PLANE):
            place(file, of, behind(0.6, 0.4, 3))
        for k, name in enumerate("wxyz"):
            file[f"q_{name}"][...] = numpy.full((2, 6), float(k == 0))
        file["shapes:radius"][1] = 0
        file["shapes:corners"][11:13] = [(0, 0, 0), (0.2, 0, 0)]
        file["joints:of"][0, 3], file["joints:anchors"][0] = 2, (0.3, 0, 0, 0, 0, 0)
        file["contacts:points"][0, :3] = behind(0.6, 0.4, 3)
    run("view", "x.h5", *SHOT, "--at", "0.1", "--png", "a.png", "--contacts")
    assert (pictures(tmp_path / "a.png")[0] == pictures(tmp_path / "bare.png")[0]).all()
    with h5py.File(space, "r+") as file:
        place(file, ASLEEP, before)
        file["joints:anchors"][0] = 0
        file["shapes:of"][4, 2] = 1
    run("view", "x.h5", *SHOT, "--at", "0.1", "--png", "a.png", "--contacts")
    made = pictures(tmp_path / "a.png")[0].astype(int)
    near = before + 0.9 * (behind(0.6, 0.4, 3) - before) * 12 / 15
    assert is_about(pixel(made, before), MARK) and is_about(pixel(made, (before + near) / 2), MARK)
    away = 2 * seen(before) - seen((before + near) / 2)               # on the other side there is nothing
    assert not is_about(tuple(int(c) for c in made[int(away[1]), int(away[0])]), MARK)


def test_a_hull_whose_triangles_were_not_recorded_is_a_ball_at_each_corner(run, space, tmp_path):
    without(space, BALL, PILL, BOX, PLANE, SENSOR)
    with h5py.File(space, "r+") as file:
        del file["shapes:triangles"]
        file["joints:of"][0, 3] = 0
        file["shapes:radius"][4] = 0
    run("view", "x.h5", *SHOT, "--at", "0", "--png", "a.png")
    made, corners = pictures(tmp_path / "a.png")[0].astype(int), PLACES[ASLEEP] + CORNERS * SMALL @ matrix(TURNS[ASLEEP]).T
    assert all(not is_about(pixel(made, x), BACK) for x in corners) and is_about(pixel(made, corners.mean(axis=0)), BACK)


def test_the_far_side_of_the_ground_is_not_drawn(run, space, tmp_path):
    run("view", "x.h5", *LOOK, "--turn", "25:-40", "--width", "120", "--height", "90", "--png", "a.png")
    made = pictures(tmp_path / "a.png")[0].astype(int)
    grey = abs(made - made.mean(axis=2, keepdims=True)).max(axis=2) < 3
    assert not (grey & (made[:, :, 0] < 180)).any() and (made != BACK).any()


def test_a_face_that_goes_past_the_eye_is_cut(run, space, tmp_path):
    """A wall 3 m wide, whose near end is 1 m behind the eye."""
    at, axes, zoom = eye()
    long = at[2] + (1 + axes[2, :2] @ (at[:2] - [PLACES[ASLEEP][0], -1.6])) / axes[2, 2] - PLACES[ASLEEP][2]
    with h5py.File(space, "r+") as file:
        file["shapes:corners"][13:21] = CORNERS * [1.45, 0.35, long - 0.05]
        for k, name in enumerate("wxyz"):
            file[f"q_{name}"][:, ASLEEP] = k == 0
        file["x_y"][:, ASLEEP] = -2
        file["joints:of"][0, 3] = 0
    without(space, BALL, PILL, BOX, PLANE, SENSOR)
    run("view", "x.h5", *SHOT, "--at", "0", "--png", "a.png")
    made = pictures(tmp_path / "a.png")[0].astype(int)
    y, x = numpy.mgrid[0:HEIGHT, 0:WIDTH] + 0.5
    ways = numpy.stack([(x - WIDTH / 2) / zoom, (HEIGHT / 2 - y) / zoom, -numpy.ones_like(x)], axis=-1) @ axes
    top = at + ways * ((-1.6 - at[1]) / ways[..., 1])[..., None] - PLACES[ASLEEP]           # where a ray comes to the height of its top
    on, off = (abs(top[..., 0]) < 1.2) & (top[..., 2] > 2 - long) & ~on_frame(), (abs(top[..., 0]) > 3.5) & ~on_frame()
    assert on.sum() > 500 and (abs(made[on] - made[on][0]).max(axis=1) <= 1).all() and sum(made[on][0]) < sum(BACK) - 60
    assert off.sum() > 1000 and (made[off] == BACK).all()


@pytest.mark.parametrize("table, row, column, value", [("shapes:triangles", 0, 1, 2), ("shapes:triangles", 0, 0, 99), ("shapes:triangles", 23, 2, 21),
                                                       ("shapes:radius", 2, 0, numpy.inf), ("shapes:radius", 0, 0, numpy.nan)])
def test_a_broken_table_of_space_is_refused(run, space, tmp_path, table, row, column, value):
    with h5py.File(space, "r+") as file:
        file[table][row, column] = value
    assert "fits no other table" in run("view", "x.h5", "--png", "a.png", code=2).stderr and not (tmp_path / "a.png").exists()


def test_without_turns_bodies_are_points(run, space, tmp_path):
    with h5py.File(space, "r+") as file:
        del file["q_z"]
    run("view", "x.h5", "--png", "a.png")
    assert "no shapes of bodies" in run("view", "x.h5", "--contacts", "--png", "b.png", code=2).stderr


# ---- the page ----

def test_the_page_draws_the_same_space(page, run, space, tmp_path):
    """In the middle of each body the colour that the picture has there, and a click that picks it."""
    run("view", "x.h5", *LOOK, "-o", "x.html", "--contacts")
    run("view", "x.h5", *LOOK, "--turn", "31.5126787:20.0535228", "--at", "0", "--width", "1200", "--height", "670", "--png", "a.png", "--contacts")
    page.open(tmp_path / "x.html")
    assert page.script("return document.documentElement.dataset.theme") == "light" or page.key("d") is None
    page.wait(lambda: page.data("drawn") == "0")
    drawn = pictures(tmp_path / "a.png")[0]
    scene = page.scene()
    places = {BALL: PLACES[BALL] + [0.2, 0.5, 0.3], PILL: PLACES[PILL], BOX: PLACES[BOX] + [0.9, 0.4, 0], PLANE: numpy.array([-2, -1.4, 2]), ASLEEP: PLACES[ASLEEP] + [0, 0.4, 0]}
    for of, place in places.items():
        x, y = page.script("const c = fp3.camera.see(...Array.from(arguments, (x, k) => fp3.world.of(k, x))); return [c.x, c.y]", *place.tolist())
        ours, theirs = scene[int(y * len(scene)), int(x * len(scene[0]))], drawn[int(y * len(drawn)), int(x * len(drawn[0]))].astype(int)
        assert abs(ours - theirs).max() < 12, (of, ours, theirs)
        page.click(x, y)
        assert page.data("picked") == str(of)
    page.script("fp3.go(1)")
    page.wait(lambda: page.data("drawn") == "1")
    assert page.script("return fp3.bodies.contacts.length") == 1


def shapes_of_page(run, tmp_path):
    run("view", "x.h5", *LOOK, "-o", "x.html")
    return json.loads(re.search(r'id="about">(.*?)</script>', (tmp_path / "x.html").read_text(), re.S)[1])["bodies"]["shapes"]


def test_edges_are_where_a_surface_bends(run, space, tmp_path):
    """A box has 12, and none across its faces; a sheet of six squares has its border, and a fold: round if it has a radius, a line if it bends enough."""
    assert [len(shape["edges"]) for shape in shapes_of_page(run, tmp_path)] == [1, 1, 12, 1, 12, 1]
    for high, radius, folds in ((0, 0, 0), (0, 0.1, 0), (0.1, 0, 0), (0.1, 0.1, 2), (0.5, 0, 0), (0.7, 0, 2)):
        points = [(x, high * (x == 3), z) for z in range(3) for x in range(4)]
        with h5py.File(space, "r+") as file:
            for name in ("shapes:of", "shapes:radius", "shapes:corners", "shapes:triangles"):
                del file[name]
            file["shapes:of"], file["shapes:radius"] = numpy.array([(PLANE, 12, 0, 2)], "u4"), numpy.full((1, 1), radius)
            file["shapes:corners"] = numpy.array(points, float)
            file["shapes:triangles"] = numpy.array([(4 * z + x + a, 4 * z + x + b, 4 * z + x + c) for z in range(2) for x in range(3)
                                                    for a, b, c in ((0, 4, 5), (0, 5, 1))], "u4")
        edges = {tuple(edge) for edge in shapes_of_page(run, tmp_path)[0]["edges"]}
        border = {(k, k + 1) for k in (0, 1, 2, 8, 9, 10)} | {(k, k + 4) for k in (0, 3, 4, 7)}
        assert edges == border | ({(2, 6), (6, 10)} if folds else set()), (high, radius)
