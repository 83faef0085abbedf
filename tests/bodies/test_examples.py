"""The examples with rigid bodies: a box in C and ten in Python, which the page shows; a game and a tower in space in both; a tower in C++."""

import math
import os
import pathlib
import re
import runpy
import subprocess
import sys
import textwrap

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("FP3_BUILD", ROOT / "build"))
os.environ["FP3_HOME"] = str(BUILD)
sys.path.insert(0, str(ROOT / "python"))
if BUILD.name != "build" and "libasan" not in os.environ.get("LD_PRELOAD", ""):
    pytest.skip("sanitizers have to be there before Python", allow_module_level=True)


def said(tmp_path, name, *compiler):
    """What an example prints, compiled without a warning."""
    library, sanitize = BUILD / "lib/libfp3.so.0", ["-fsanitize=address,undefined"] if BUILD.name != "build" else []
    program = tmp_path / pathlib.Path(name).stem
    subprocess.run([*compiler, "-O2", "-Wall", "-Wextra", "-Wshadow", "-Wconversion", "-Werror", *sanitize, f"-I{ROOT}/sw/include", ROOT / "examples" / name, library,
                    f"-Wl,-rpath,{library.parent}", "-lm", "-o", program], check=True)
    return subprocess.run([program], capture_output=True, text=True, check=True, timeout=60).stdout


def test_a_box_in_c(tmp_path):
    """In 25 lines, as the page shows them: the box lies on the ground."""
    text, page = (ROOT / "examples/bodies.c").read_text(), (ROOT / "docs/bodies.md").read_text()
    assert len(text.splitlines()) <= 25 and textwrap.indent(text, "    ") in page
    x, y, angle = map(float, said(tmp_path, "bodies.c", "gcc", "-std=c11").split())
    assert y == pytest.approx(0.5, abs=1e-3) and abs(x) < 1 and angle / (math.pi / 2) == pytest.approx(round(angle / (math.pi / 2)), abs=1e-3)


def test_ten_boxes_in_python(capsys):
    page = (ROOT / "docs/bodies.md").read_text()
    block = re.search(r"^    import numpy as np\n(?:    .*\n)+", page, re.M)[0]
    assert len(block.splitlines()) == 10
    exec(textwrap.dedent(block))
    printed = capsys.readouterr().out
    assert printed.endswith(" 0\n") and len(printed.splitlines()) == 10


def test_a_game_has_the_same_bits_in_c_and_python(tmp_path, capsys):
    """And played at once or late, with a guess that was wrong."""
    runpy.run_path(str(ROOT / "examples/bridge.py"), run_name="__main__")
    printed = capsys.readouterr().out
    assert said(tmp_path, "bridge.c", "gcc", "-std=c11") == printed
    guess, played = re.search(r"at ([\d.]+) by guess, at ([\d.]+) as played", printed).groups()
    here, there = re.search(r"here: (.*)\nthere: (.*)\n", printed).groups()
    assert guess != played and here == there
    points, high, frame = re.match(r"(\d+) points, ([\d.]+) m high, goal in frame (\d+), hash [0-9a-f]{16}$", here).groups()
    assert 0 < int(points) <= 90 and 1.3 < float(high) < 3 and 0 < int(frame) < 540


def test_a_tower_in_space_has_the_same_bits_in_c_and_python(tmp_path, capsys):
    """And a shot does what its trial did."""
    runpy.run_path(str(ROOT / "examples/castle.py"), run_name="__main__")
    printed = capsys.readouterr().out
    assert said(tmp_path, "castle.c", "gcc", "-std=c11") == printed
    trials = dict(re.findall(r"aim (\d): (\d+) bricks fall", printed))
    aim, fallen = re.search(r"shot with (\d): (\d+) of 96 bricks fell, hash [0-9a-f]{16}\n$", printed).groups()
    assert len(trials) == 4 and trials[aim] == fallen == max(trials.values(), key=int) and 20 < int(fallen) < 96


def test_a_tower_in_cpp(tmp_path):
    """As C++17, which has no C in it: what was opened is closed, and what is refused is an exception."""
    text = (ROOT / "examples/tower.cpp").read_text()
    printed = said(tmp_path, "tower.cpp", "g++", "-std=c++17", "-Wpedantic")
    hits, stand, refused = re.match(r"(\d+) hits by the ball, and (\d+) of 8 boxes stand\nrefused: (.*)\n$", printed).groups()
    assert int(hits) > 0 and int(stand) < 4 and "no such body" in refused and "#define" not in text
