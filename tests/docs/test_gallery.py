"""The gallery: its scenes are short, run everywhere with the same bits, and its page and pictures are those of its data."""

import json
import math
import pathlib
import re
import struct
import sys
import zlib

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
pytest.importorskip("numpy")
import gallery  # noqa: E402
import measured  # noqa: E402
from fp3evidence.told import bare  # noqa: E402
from fp3gallery import page  # noqa: E402
from fp3world import scene as ws  # noqa: E402

DATA = json.loads((ROOT / "docs/gallery.json").read_text(encoding="utf-8"))
FEW = 8                                                 # steps
WHOLE = {"arenstorf", "van_der_pol"}                    # they choose their own, and are short
HARDWARE = {"eight", "chain", "ships", "arenstorf"}
BY_NAME = {scene.name: scene for scene in gallery.SCENES}


@pytest.mark.parametrize("name", BY_NAME)
def test_a_scene_is_short_and_says_what_is_seen(name):
    lines = BY_NAME[name].path.read_text(encoding="utf-8").splitlines()
    assert len(lines) <= 20
    assert lines[0].startswith("# ") and lines[0].endswith((".", ":"))


OF_BODIES = [name for name, scene in BY_NAME.items() if scene.is_bodies]


@pytest.mark.parametrize("name", [name for name in BY_NAME if name not in OF_BODIES])
def test_engines_have_the_same_bits(fp3, tmp_path, name):
    scene = BY_NAME[name]
    steps = [] if name in WHOLE else ["--steps", FEW]
    whole, _ = ws.words_of(ws.call(fp3, scene.path, "--engine", "fast", "--all", *steps))
    assert len(whole) == DATA["scenes"][name]["rows"][0]["objects"]
    path = ws.put(tmp_path, scene.text(tmp_path, bool(scene.changes)), name)
    found = [ws.words_of(ws.call(fp3, path, "--engine", engine, "--all", *steps))[0] for engine in ["fast", "isa"] + ["rtl"] * (name in HARDWARE)]
    assert len({ws.hash_of(words) for words in found}) == 1
    start, _ = ws.words_of(ws.call(fp3, path, "--engine", "fast", "--all", "--steps", 0)) if steps else (None, None)
    assert start is None or ws.differing(found[0], start) > 0                # something moves


@pytest.mark.parametrize("name", ["eight", "chain", "arenstorf", "van_der_pol", "ships", "flag", "pendulums", "plummer"])
def test_a_whole_scene_has_the_hash_of_the_page(fp3, name):
    words, _ = ws.words_of(ws.call(fp3, BY_NAME[name].path, "--engine", "fast", "--all"))
    assert ws.hash_of(words) == DATA["scenes"][name]["rows"][0]["hash"]


def hash_of_bodies(fp3, path, *options):
    return re.search(r"^hash +(\w{16})$", ws.call(fp3, path, *options), re.M)[1]


@pytest.mark.parametrize("name", OF_BODIES)
def test_bodies_have_the_hash_of_the_page(fp3, tmp_path, name):
    """The whole scene by built-in laws, the small form by engines; something moves."""
    rows, scene = DATA["scenes"][name]["rows"], BY_NAME[name]
    path = ws.put(tmp_path, scene.text(tmp_path, is_small=True), name)
    assert hash_of_bodies(fp3, scene.path) == rows[0]["hash"]
    assert {hash_of_bodies(fp3, path, "--steps", scene.steps, *options) for options in ((), ("-e", "fast"), ("-e", "isa"))} == {rows[1]["hash"]}
    assert hash_of_bodies(fp3, path, "--steps", 0) != rows[1]["hash"]


def test_what_a_recording_of_bodies_says(fp3, tmp_path):
    """Of what moves and what does not, where shapes are, and how far hinges are apart: not at all before the first step."""
    pytest.importorskip("h5py")
    from fp3gallery import recorded
    found = recorded.Recording(fp3, tmp_path, BY_NAME["ragdolls"], "--steps", 200, "--every", 100)
    assert found.times.tolist() == pytest.approx([0, 100 / 60, 200 / 60]) and found.moves.tolist() == [False] * 17 + [True] * 48
    outlines = dict(found.shapes(0))
    assert outlines[0].max(0) == pytest.approx((18, 0)) and outlines[17].max(0) - outlines[17].min(0) == pytest.approx((0.3, 0.9), abs=1e-3)
    assert 1e-6 < found.gap() < 0.1
    found.angle[:, 17:] += 0.1
    assert found.gap() > 0.05


def test_the_data_are_of_all_scenes_and_engines_agree():
    assert list(DATA["scenes"]) == list(BY_NAME) and len(BY_NAME) == 20
    for name, found in DATA["scenes"].items():
        hashes, engines = {}, {row["engine"] for row in found["rows"]} | {row["engine"] for row in found["refused"]}
        for row in found["rows"]:
            hashes.setdefault(row["form"], set()).add(row["hash"])
        assert {len(some) for some in hashes.values()} == {1}, name
        assert engines == {"fast", "isa", "rtl"} | ({page.BUILT_IN} if name in OF_BODIES else set()), name
        assert found["errors"] and all(math.isfinite(row["found"]) for row in found["errors"]), name
        assert found["rows"][0]["ns_per_object_step"] > 0, name


def test_the_page_is_that_of_the_data():
    assert bare((ROOT / "docs/gallery.md").read_text(encoding="utf-8")) == page.page(gallery.SCENES, DATA)


def test_clocks_are_those_of_place_and_route():
    clocks = measured.clocks()
    assert DATA["mhz"] and DATA["mhz"] == {config: clocks.get(config) for config in DATA["mhz"]}


# ---- pictures ----

def pixels(png):
    """Width, height, and the bytes that are packed."""
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    at, size, packed = 8, None, b""
    while at < len(png):
        length, kind = struct.unpack(">I4s", png[at:at + 8])
        body = png[at + 8:at + 8 + length]
        size = struct.unpack(">II", body[:8]) if kind == b"IHDR" else size
        packed += body if kind == b"IDAT" else b""
        at += length + 12
    return size, zlib.decompress(packed)


def is_blank(png):
    """All rows but a few are as the first one, or their filters say so."""
    (width, height), raw = pixels(png)
    row = len(raw) // height
    rows = [raw[k * row + 1:(k + 1) * row] for k in range(height)]
    return len(set(rows)) < height // 4


def test_every_scene_has_a_picture_with_something_on_it():
    paths = sorted((ROOT / "docs/gallery").iterdir())
    assert [path.name for path in paths] == sorted(f"{name}.png" for name in BY_NAME)
    for path in paths:
        (width, height), _ = pixels(path.read_bytes())
        assert 720 <= width <= 960 and 270 <= height <= 540 and not is_blank(path.read_bytes()), path.name
        assert path.stat().st_size <= 300e3, path.name
    assert sum(path.stat().st_size for path in paths) <= 2.5e6


def test_a_blank_picture_is_seen():
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    def picture(raw):
        parts = (b"IHDR", struct.pack(">IIBBBBB", 100, 400, 8, 2, 0, 0, 0)), (b"IDAT", zlib.compress(raw)), (b"IEND", b"")
        return b"\x89PNG\r\n\x1a\n" + b"".join(chunk(*part) for part in parts)
    assert is_blank(picture((b"\0" + bytes([238, 240, 244]) * 100) * 400))
    assert not is_blank(picture(b"".join(b"\0" + bytes([k % 250, k // 250, 3]) * 100 for k in range(400))))
