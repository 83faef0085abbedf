"""Pictures and films without a display: the same pixels on every machine, what was recorded and nothing between."""

import hashlib
import os
import shutil
import struct
import subprocess
import zlib

import numpy
import pytest


def chunks(data):
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at = 8
    while at < len(data):
        size, name = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        assert struct.unpack(">I", data[at + 8 + size:at + 12 + size])[0] == zlib.crc32(name + body)
        yield name.decode(), body
        at += 12 + size


def rows(packed, width, height):
    """Each row begins with the number of its filter: here always the difference from the left."""
    flat = numpy.frombuffer(zlib.decompress(packed), numpy.uint8).reshape(height, 1 + 3 * width)
    assert (flat[:, 0] == 1).all()
    return numpy.cumsum(flat[:, 1:].reshape(height, width, 3), axis=1, dtype=numpy.uint8)


def pictures(path):
    listed = list(chunks(path.read_bytes()))
    width, height, *kind = struct.unpack(">IIBBBBB", listed[0][1])
    assert listed[0][0] == "IHDR" and listed[-1] == ("IEND", b"") and kind == [8, 2, 0, 0, 0]
    film = [body for name, body in listed if name == "acTL"]
    made = [rows(body if name == "IDAT" else body[4:], width, height) for name, body in listed if name in ("IDAT", "fdAT")]
    if film:
        numbers = [struct.unpack(">I", body[:4])[0] for name, body in listed if name in ("fcTL", "fdAT")]
        assert numbers == list(range(len(numbers))) and struct.unpack(">II", film[0]) == (len(made), 0)
    return made


# Balls of several sizes that hide each other, a plane, a box, something that is not there, colours.
SOME = "step,time [s],object,p_x [m],p_y [m],p_z [m],r [m],q\n" + "".join(
    f"{k},{k / 8},{i},{(i * 7 % 5) - 2 + k / 16},{(i * 3 % 4) / 2},{'nan' if i == 11 else i % 3 - k / 8},{0.2 + (i % 4) / 8},{i * i % 13}\n"
    for k in range(4) for i in range(24))
ARGUMENTS = ["--size", "r", "--colour", "q", "--plane", "y=0", "--box", "-2:3,0:2,-1:2", "--width", "320", "--height", "200"]
# If a change of the drawing is meant, these are the new ones that a failure prints.
HASHES = {
    "balls": "3ae68bab0ae095a1",
    "turned": "22915407f22b73f2",
    "trail": "621ad17436b730b5",
    "links": "29adefdb0062c749",
}


def is_known(name, made):
    assert hashlib.sha256(made.tobytes()).hexdigest()[:16] == HASHES[name], f"{name}: other pixels"


@pytest.fixture
def some(tmp_path):
    (tmp_path / "some.csv").write_text(SOME)
    return "some.csv"


@pytest.mark.smoke
def test_the_pixels_are_known(run, some, tmp_path):
    run("view", some, *ARGUMENTS, "--png", "a.png")
    is_known("balls", pictures(tmp_path / "a.png")[0])
    run("view", some, *ARGUMENTS, "--png", "b.png", "--turn", "-120:75", "--up", "z", "--at", "0.125")
    is_known("turned", pictures(tmp_path / "b.png")[0])
    assert not (tmp_path / "some.html").exists()


def test_the_pixels_of_a_run_are_known(run, root, tmp_path):
    run("run", root / "programs/kepler.ode", "-n", "300", "--every", "3", "--output", "k.csv")
    run("view", "k.csv", "--position", "r", "--png", "k.png", "--width", "200", "--height", "150")
    is_known("trail", pictures(tmp_path / "k.png")[0])
    run("run", "--scene", root / "programs/world/cloth.scene", "-n", "512", "--every", "128", "--output", "c.h5")
    run("view", "c.h5", "--png", "c.png", "--width", "300", "--height", "300")
    is_known("links", pictures(tmp_path / "c.png")[0])


def test_a_film_has_each_snapshot(run, some, tmp_path):
    run("view", some, *ARGUMENTS, "--film", "f.png", "--rate", "12", "--png", "p.png", "--at", "0.25", "-o", "page.html")
    film = pictures(tmp_path / "f.png")
    assert len(film) == 4 and (film[2] == pictures(tmp_path / "p.png")[0]).all() and (film[1] != film[2]).any()
    assert (tmp_path / "page.html").exists()
    control = next(body for name, body in chunks((tmp_path / "f.png").read_bytes()) if name == "fcTL")
    assert struct.unpack(">HH", control[20:24]) == (1, 12)


def test_the_nearest_snapshot(run, some, tmp_path):
    """Only what was recorded is shown: of two that are as near the earlier one."""
    for at, shown in (("0.3", "0.25"), ("0.3125", "0.25"), ("0.32", "0.375"), ("0.01", "0")):
        assert f"1 snapshot from time {shown} on" in run("view", some, *ARGUMENTS, "--png", "a.png", "--at", at).stdout
        run("view", some, *ARGUMENTS, "--png", "b.png", "--at", shown)
        assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_a_range_of_colours(run, some, tmp_path):
    """As if all values beyond it were at its ends; on the page, too."""
    told = run("view", some, *ARGUMENTS, "--range", "2:5", "--png", "a.png", "-o", "a.html").stdout
    assert "colours: from 2, dark, to 5, bright" in told
    assert '"name":"q","unit":"","columns":[4],"least":2.0,"most":5.0' in (tmp_path / "a.html").read_text()
    head, *lines = SOME.splitlines()
    cut = [",".join([*line.split(",")[:-1], str(min(5, max(2, int(line.split(",")[-1]))))]) for line in lines]
    (tmp_path / "cut.csv").write_text("\n".join([head, *cut]) + "\n")
    run("view", "cut.csv", *ARGUMENTS, "--png", "b.png")
    run("view", some, *ARGUMENTS, "--png", "c.png")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes() != (tmp_path / "c.png").read_bytes()


def test_a_film_in_real_time(run, some, tmp_path):
    """Snapshots are 1/8 s apart. What it cannot be is refused, and how fast another one is is said."""
    assert "4 snapshots from time 0 on, 8 a second: 1 times real time" in run("view", some, *ARGUMENTS, "--film", "f.png", "--rate", "real").stdout
    control = next(body for name, body in chunks((tmp_path / "f.png").read_bytes()) if name == "fcTL")
    assert struct.unpack(">HH", control[20:24]) == (1, 8)
    assert "12 a second: 1.5 times real time" in run("view", some, *ARGUMENTS, "--film", "f.png", "--rate", "12").stdout
    for text, message in ((SOME.replace("time [s]", "time [h]"), "times are in s"), (SOME.replace("time [s]", "t"), "times are in s"),
                          (SOME.splitlines()[0] + "\n0,0,0,1,2,3,1,1\n", "several snapshots"),
                          (SOME.splitlines()[0] + "\n0,0,0,1,2,3,1,1\n1,0.0001,0,1,2,3,1,1\n", "has 1e+04 snapshots, expected 1 to 1000: --every takes fewer"),
                          (SOME.splitlines()[0] + "\n0,0,0,1,2,3,1,1\n1,100,0,1,2,3,1,1\n", "has 0.01 snapshots")):
        (tmp_path / "other.csv").write_text(text)
        assert message in run("view", "other.csv", "--position", "p", "--film", "g.png", "--rate", "real", code=2).stderr
    assert not (tmp_path / "g.png").exists()


def test_readers_read_it(run, some, tmp_path):
    image = pytest.importorskip("PIL.Image", reason="no Pillow: make setup-view installs it")
    run("view", some, *ARGUMENTS, "--film", "f.png")
    with image.open(tmp_path / "f.png") as film:
        assert (film.n_frames, film.size) == (4, (320, 200))
        for n, made in enumerate(pictures(tmp_path / "f.png")):
            film.seek(n)
            assert (numpy.asarray(film.convert("RGB")) == made).all()


@pytest.mark.skipif(not shutil.which("ffprobe"), reason="no ffmpeg: make setup-view installs it")
def test_a_video_has_each_snapshot(run, some, tmp_path):
    run("view", some, *ARGUMENTS, "--film", "f.MP4", "--rate", "10")
    said = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-select_streams", "v", "-of", "csv=p=0", "-show_entries",
                           "stream=codec_type,width,height,r_frame_rate,nb_read_frames", "f.MP4"], cwd=tmp_path, capture_output=True, text=True).stdout
    assert said.split() == ["video,320,200,10/1,4"]
    (tmp_path / "film.mp4").write_text("mine")
    assert "a video is even in width and height, found 321 x 200" in run("view", some, "--film", "film.mp4", "--width", "321", "--height", "200", code=2).stderr
    assert (tmp_path / "film.mp4").read_text() == "mine"


@pytest.mark.parametrize("program, message", [(None, "ffmpeg, which is not installed"), ("#!/bin/sh\n[ $1 = -version ] || { echo bad day >&2; exit 7; }\n", "ffmpeg: bad day")])
def test_without_ffmpeg_there_is_no_video(run, some, tmp_path, program, message):
    (tmp_path / "bin").mkdir()
    if program:
        (tmp_path / "bin/ffmpeg").write_text(program)
        (tmp_path / "bin/ffmpeg").chmod(0o755)
    env = {**os.environ, "PATH": f"{tmp_path}/bin:{os.environ['PATH'] if program else ''}"}
    assert message in run("view", some, "--film", "f.mp4", code=1, env=env).stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bin", "some.csv"]


BACK = numpy.array([238, 240, 244])


def test_a_ball_is_where_it_should_be(run, tmp_path):
    """Two balls in a plane: 6 wide and 2 high with their radii, in a picture with 1.28 times the room."""
    (tmp_path / "a.csv").write_text("step,object,p_x [m],p_y [m],q\n0,0,-2,0,0\n0,1,2,0,1\n")
    run("view", "a.csv", "--size", "1", "--png", "a.png", "--width", "768", "--height", "400")
    made = pictures(tmp_path / "a.png")[0].astype(int)
    drawn = abs(made - BACK).sum(axis=2) > 200  # not the edges of what is seen
    pixel = 768 / (6 * 1.28)  # of a metre
    for x in (-2, 2):
        part = drawn[:, int(384 + (x - 1.05) * pixel):int(384 + (x + 1.05) * pixel)]
        columns, lines = numpy.flatnonzero(part.any(axis=0)), numpy.flatnonzero(part.any(axis=1))
        assert abs(columns[-1] - columns[0] + 1 - 2 * pixel) <= 2 and abs(lines[-1] - lines[0] + 1 - 2 * pixel) <= 2
        assert abs((lines[0] + lines[-1]) / 2 - 199.5) <= 1
        assert part.sum() == pytest.approx(numpy.pi * pixel ** 2, rel=0.01)
    assert not drawn[:, 384 - 20:384 + 20].any()


def test_what_is_nearer_hides_what_is_behind(run, tmp_path):
    (tmp_path / "a.csv").write_text("step,object,p_x [m],p_y [m],p_z [m],q\n0,0,0,0,1,0\n0,1,0,0,-1,1\n")
    for way, expected in (("0:0", 0), ("180:0", 1)):
        run("view", "a.csv", "--size", "0.5", "--colour", "q", "--turn", way, "--png", "a.png", "--width", "200", "--height", "200")
        red, green, blue = pictures(tmp_path / "a.png")[0][100, 100].astype(int)
        assert (red > blue) == (expected == 1)


@pytest.mark.parametrize("arguments, message", [
    (["--png", "a.png", "--at", "0.4"], "--at: found 0.4, expected a time from 0 to 0.375"),
    (["--png", "a.png", "--at", "-0.1"], "--at: found -0.1, expected a time from 0 to 0.375"),
    (["--png", "a.png", "--range", "0:5"], "--range: nothing is coloured, expected --colour NAME"),
    (["--colour", "q", "--range", "5"], "--range: found '5', expected LEAST:MOST"),
    (["--colour", "q", "--range", "5:5"], "expected the smaller number first"),
    (["--colour", "q", "--range", "0:inf"], "--range: 'inf' is no number"),
    (["--film", "a.png", "--rate", "0"], "--rate: '0' is no number from 1 to 1000"),
    (["--at", "0"], "--at: expected --png FILE"),
    (["--png", "a.png", "--width", "8"], "--width: '8' is no number from 16 to 8192"),
    (["--png", "a.png", "--turn", "5"], "--turn: found '5', expected AZIMUTH:ELEVATION"),
    (["--png", "a.png", "--turn", "5:91"], "expected -90 to 90"),
    (["--png", "a.png", "--film", "./a.png"], "are one file"),
    (["--png", "some.csv"], "would overwrite"),
    (["--png", "nowhere/a.png"], "nowhere/a.png"),
])
def test_what_cannot_be_drawn_is_refused(run, some, tmp_path, arguments, message):
    assert message in run("view", some, *arguments, code=2).stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["some.csv"]
