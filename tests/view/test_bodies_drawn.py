"""Shapes of rigid bodies in pictures and in the page: where they are, how they are turned, who sleeps, what joins and touches them."""

import hashlib

import numpy
import pytest

from test_pictures import pictures

h5py = pytest.importorskip("h5py")

BACK, GREY, PLAIN, MARK, TOUCH = (238, 240, 244), (128, 128, 128), (36, 87, 199), (191, 26, 20), (196, 120, 0)
SCENE = """steps = 90;
bodies = (
    { name = "ground"; type = "static"; x = [0.0, -1.0]; shapes = ( { box = [10.0, 1.0]; }, { chain = ( [4.0, 1.0], [4.5, 3.0], [7.0, 5.0] ); } ); },
    { name = "still"; x = [-3.0, 0.5]; shapes = { box = [0.5, 0.5]; }; },
    { name = "ball"; x = [-1.0, 0.5]; w = -2.0; v = [1.0, 0.0]; shapes = { circle = 0.5; }; },
    { name = "pill"; x = [3.0, 0.3]; may_not_sleep = true; shapes = { capsule = ([-0.5, 0.0], [0.5, 0.0]); radius = 0.3; }; },
    { name = "bob"; count = 2; x = ("2*i - 7", 3); v = (0, "-8*i"); shapes = { polygon = ( [-0.4, -0.3], [0.4, -0.3], [0.0, 0.5] ); radius = 0.1; }; },
    { name = "tilt"; type = "static"; x = [1.5, 4.0]; angle = 0.5; shapes = { box = [1.0, 0.1]; }; },
    { name = "eye"; type = "static"; x = [-3.0, 0.5]; shapes = { circle = 1.0; is_sensor = true; }; }
);
joints = ( { hinge = ["ground", "bob[0]"]; at = [-6.0, 4.0]; }, { rod = ["ground", "bob[1]"]; anchor_a = [-5.0, 5.5]; force = 2.0; } );
"""
SEE = ["--see", "-8:8,-1:5", "--width", "640", "--height", "480"]
HASH = "891ef219390280c5"        # if a change of the drawing is meant, a failure prints the new one


@pytest.fixture
def world(run, tmp_path):
    (tmp_path / "x.scene").write_text(SCENE)
    run("run", "--scene", "x.scene", "--every", "10", "--observe", "contacts", "--output", "x.h5")
    return tmp_path / "x.h5"


def pixel(made, x, y):
    """Of a place in the world: --see fits into 640 x 480 with 1.28 times the room."""
    scale = 640 / (16 * 1.28)
    return tuple(int(c) for c in made[round(240 - (y - 2) * scale), round(320 + x * scale)])


def pale(ink, share):
    return tuple(round(a + (b - a) * share) for a, b in zip(ink, BACK))


def is_about(found, ink):
    return max(abs(a - b) for a, b in zip(found, ink)) <= 1


def test_the_pixels_are_known(run, world, tmp_path):
    """Of the start, where the file says where bodies are."""
    run("view", "x.h5", *SEE, "--at", "0", "--png", "a.png")
    found = hashlib.sha256(pictures(tmp_path / "a.png")[0].tobytes()).hexdigest()[:16]
    assert found == HASH


def test_each_body_is_where_it_is(run, world, tmp_path):
    """In the middle of each the colour of what it does; beside it the one behind it."""
    run("view", "x.h5", *SEE, "--film", "f.png")
    film = pictures(tmp_path / "f.png")
    with h5py.File(world) as file:
        x, y, rest = (file[name][:] for name in ("x_x", "x_y", "at_rest"))
        assert rest[-1, 1] == -1 and rest[0, 1] == 0
    for snapshot in (0, 9):
        assert is_about(pixel(film[snapshot], x[snapshot, 3] - 0.2, y[snapshot, 3]), pale(PLAIN, 0.3))
        assert is_about(pixel(film[snapshot], x[snapshot, 3] + 0.7, y[snapshot, 3]), pale(PLAIN, 0.3))        # its end is round
        assert is_about(pixel(film[snapshot], x[snapshot, 3] + 0.76, y[snapshot, 3] + 0.26), BACK)
        for way in (0.8, -0.8):
            assert is_about(pixel(film[snapshot], 1.5 + way * numpy.cos(0.5), 4 + way * numpy.sin(0.5)), pale(GREY, 0.3))
            assert is_about(pixel(film[snapshot], 1.5 + way * numpy.cos(0.5), 4 - way * numpy.sin(0.5)), BACK)
        assert is_about(pixel(film[snapshot], 5, -0.5), pale(GREY, 0.3)) and is_about(pixel(film[snapshot], 0, 3), BACK)
    assert is_about(pixel(film[0], -3.2, 0.6), pale(PLAIN, 0.3)) and is_about(pixel(film[9], -3.2, 0.6), pale(PLAIN, 0.6))       # it sleeps
    assert is_about(pixel(film[0], -3, 1.3), pale(GREY, 0.8))                                                   # a sensor, behind it


def test_a_circle_shows_how_it_is_turned(run, world, tmp_path):
    run("view", "x.h5", *SEE, "--film", "f.png")
    film = pictures(tmp_path / "f.png")
    with h5py.File(world) as file:
        x, y, angle = (file[name][:, 2] for name in ("x_x", "x_y", "angle"))
    for snapshot in (0, 4):
        on = [sum(pixel(film[snapshot], x[snapshot] + r * numpy.cos(a), y[snapshot] + r * numpy.sin(a))) for a in (angle[snapshot], angle[snapshot] + 2)
              for r in (0.2, 0.25, 0.3)]
        assert min(on[3:]) > max(on[:3]) + 20
    assert abs(angle[4] - angle[0]) > 0.5


def test_joints_until_they_break_and_contacts_if_asked(run, world, tmp_path):
    run("view", "x.h5", *SEE, "--film", "f.png", "--contacts")
    run("view", "x.h5", *SEE, "--film", "g.png")
    film, without = pictures(tmp_path / "f.png"), pictures(tmp_path / "g.png")
    with h5py.File(world) as file:
        assert file["joints:of"][:, 3].tolist() == [10, 1]
        of, points = file["contacts:of"][:], file["contacts:points"][:]
    for made in (film, without):
        assert is_about(pixel(made[0], -6, 4), MARK) and is_about(pixel(made[9], -6, 4), MARK)
        assert is_about(pixel(made[0], -5, 4.2), MARK) and not is_about(pixel(made[9], -5, 4.2), MARK)
    pills = points[(of[:, 0] == 9) & (of[:, 2] == 3)]
    assert len(pills) == 1 and pills[0, 6] > 5
    assert is_about(pixel(film[9], *pills[0, :2]), TOUCH) and not is_about(pixel(without[9], *pills[0, :2]), TOUCH)
    assert (film[0] == without[0]).all()


def test_every_second_snapshot(run, world, tmp_path):
    run("view", "x.h5", *SEE, "--film", "f.png", "--contacts")
    run("view", "x.h5", *SEE, "--film", "g.png", "--contacts", "--every", "2")
    film, thin = pictures(tmp_path / "f.png"), pictures(tmp_path / "g.png")
    assert len(thin) == 5 and all((a == b).all() for a, b in zip(film[::2], thin))


def test_what_is_seen_at_first(run, world, tmp_path):
    """All that moves; the ground goes on beyond."""
    small = ["--at", "0", "--width", "320", "--height", "180"]
    run("view", "x.h5", *small, "--png", "a.png")
    made = pictures(tmp_path / "a.png")[0]
    grey = [row for row in range(180) if is_about(made[row, 160].tolist(), pale(GREY, 0.3))]
    assert len(grey) > 12 and is_about(made[grey[5], 1].tolist(), pale(GREY, 0.3)) and is_about(made[-1, 160].tolist(), BACK)
    run("view", "x.h5", *small, "--png", "b.png", "--position", "x_y,x_x")
    assert not (abs(pictures(tmp_path / "b.png")[0].astype(int) - pale(GREY, 0.3)).max(axis=2) < 2).any()         # points at other axes
    assert "--see: the position has 2 axes, found a range for 1" in run("view", "x.h5", "--see", "0:1", "--png", "a.png", code=2).stderr
    assert "--see: found 1:1" in run("view", "x.h5", "--see", "1:1,0:1", "--png", "a.png", code=2).stderr
    assert "no shapes of bodies" in run("view", "x.h5", "--contacts", "--position", "v", "--png", "a.png", code=2).stderr


@pytest.mark.parametrize("table, row, column, value", [("shapes:of", 0, 0, 99), ("shapes:of", 1, 1, 0), ("shapes:of", 1, 1, 2**31), ("shapes:of", 2, 1, 1),
                                                       ("shapes:radius", 0, 0, -1), ("shapes:corners", 0, 1, float("nan")), ("joints:of", 1, 1, 8)])
def test_a_broken_table_is_refused(run, world, tmp_path, table, row, column, value):
    with h5py.File(world, "r+") as file:
        file[table][row, column] = value
    assert f"x.h5: row {row}" in run("view", "x.h5", "--png", "a.png", code=2).stderr or table == "shapes:of"
    assert "fits no other table" in run("view", "x.h5", "--png", "a.png", code=2).stderr and not (tmp_path / "a.png").exists()


def test_a_table_of_another_shape_is_refused(run, world):
    with h5py.File(world, "r+") as file:
        rows = file["shapes:corners"][:]
        del file["shapes:corners"]
        file["shapes:corners"] = rows[:, :2]
    assert "'shapes:corners' has 2 columns, expected 3" in run("view", "x.h5", "--png", "a.png", code=2).stderr


# ---- the page ----

def seen(page, x, y):
    return tuple(page.script("const {world, camera} = fp3, c = camera.see(world.of(0, arguments[0]), world.of(1, arguments[1]), 0); return [c.x, c.y]", x, y))


def shown(page, x, y):
    at, made = seen(page, x, y), page.scene()
    return tuple(int(c) for c in made[int(at[1] * len(made)), int(at[0] * len(made[0]))])


def test_the_page_has_the_same(page, run, world, tmp_path):
    run("view", "x.h5", "-o", "x.html", "--contacts", "--see", "-8:8,-1:5")
    page.open(tmp_path / "x.html")
    assert page.script("return document.documentElement.dataset.theme") == "light" or page.key("d") is None
    page.wait(lambda: page.data("drawn") == "0")
    assert is_about(shown(page, 3, 0.3), pale(PLAIN, 0.3)) and is_about(shown(page, 5, -0.5), pale(GREY, 0.3)) and is_about(shown(page, 0, 3), BACK)
    assert is_about(shown(page, -3.2, 0.6), pale(PLAIN, 0.3))
    page.script("fp3.go(9)")
    page.wait(lambda: page.data("drawn") == "9")
    assert is_about(shown(page, -3.2, 0.6), pale(PLAIN, 0.6)) and page.script("return fp3.bodies.contacts.length") > 5
    page.click(*seen(page, 3.4, 0.3))
    assert page.data("picked") == "3"
    page.click(*seen(page, -3.2, 0.6))
    assert page.data("picked") == "1"                      # of two the one in front, not the sensor
    assert page.script("const [a, b] = [[0, 0], [1, 1]].map(([x, y]) => fp3.camera.see(fp3.world.of(0, x), fp3.world.of(1, y), 0)), box = document.getElementById('scene');"
                       "return Math.abs((b.x - a.x) * box.clientWidth / ((a.y - b.y) * box.clientHeight) - 1) < 1e-3")
