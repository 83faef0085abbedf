"""Pictures: what is drawn, with which labels; gnuplot that is not there, fails, or has no room."""

import os
import re
import resource
import shutil
import signal
import xml.etree.ElementTree as xml

import pytest

pytestmark = pytest.mark.skipif(not shutil.which("gnuplot"), reason="needs gnuplot: make setup")
SVG = "{http://www.w3.org/2000/svg}"


def texts(path):
    """What is written in a picture."""
    return [" ".join("".join(node.itertext()).split()) for node in xml.parse(path).getroot().iter(f"{SVG}text")]


def upright(path):
    """What is written along the axes to the left."""
    return [" ".join("".join(node.itertext()).split()) for node in xml.parse(path).getroot().iter(f"{SVG}g")
            if "rotate(270)" in node.attrib.get("transform", "") and "".join(node.itertext()).strip()]


def strokes(path):
    """The colours in which lines are drawn, outside the frame and the grid."""
    found = set()
    for node in xml.parse(path).getroot().iter():
        found |= set(re.findall(r"rgb\( *(\d+), *(\d+), *(\d+)\)", " ".join(node.attrib.values())))
    return {tuple(map(int, colour)) for colour in found} - {(0, 0, 0), (221, 221, 221), (255, 255, 255), (128, 128, 128)}


def draw(start, program, *arguments, **options):
    return start(program, "-e", "isa", "--plot", "out.svg", *arguments, output=None, **options).path.with_name("out.svg")


BLUE, RED, GREEN = (0, 114, 178), (213, 94, 0), (0, 158, 115)


def drawn(path, colour=BLUE):
    """The lines in this colour, without their samples in the legend: lists of points, from above to below."""
    red, green, blue = colour
    paths = re.findall(rf"rgb\( *{red}, *{green}, *{blue}\)' [^>]*?d='([^']*)'", path.read_text().replace('"', "'"))
    lines = [[tuple(map(float, point)) for point in re.findall(r"[ML]([-\d.]+),([-\d.]+)", d)] for d in paths]
    return [line for line in ([point for point in line if point[0] < 0.82 * 960] for line in lines) if line]


def size(line):
    return [max(values) - min(values) for values in zip(*line)]


def ends(path):
    """The dots at the ends of curves in planes."""
    return [tuple(map(float, re.match(r"translate\(([\d.]+),([\d.]+)\)", node.attrib["transform"]).groups()))
            for node in xml.parse(path).getroot().iter(f"{SVG}use") if "scale(3.90)" in node.attrib.get("transform", "")]


def test_two_states_and_their_phase_plane(start):
    path = draw(start, "oscillator.ode", "-n", "300")
    said = texts(path)
    assert "oscillator, rk4, h = 0.0078125 s, 1 of 1 object" in said
    # Each state over time and in the phase plane: the position to the right. One object has one colour.
    assert [said.count(label) for label in ("v [m/s]", "x [m]", "time [s]", "phase plane", "v", "x")] == [2, 2, 1, 1, 0, 0]
    assert strokes(path) == {BLUE} and len(drawn(path)) == 3
    assert said.index("phase plane") > said.index("time [s]") and upright(path) == ["v [m/s]", "x [m]", "v [m/s]"]
    # x, s is its velocity; and neither is that of the other.
    assert upright(draw(start, "oscillator.ode", "-n", "30", "--observe", "x,v")) == ["x [m]", "v [m/s]", "v [m/s]"]
    assert upright(draw(start, "lorenz.ode", "-n", "30", "--observe", "x,z")) == ["x", "z", "z"]


def test_a_dot_is_where_the_curve_ends(start):
    path = draw(start, "oscillator.ode", "-n", "300")
    assert ends(path) == [pytest.approx(drawn(path)[2][-1], abs=0.02)]


def test_every_state_with_its_velocity_has_a_phase_plane(start):
    path = draw(start, "double_pendulum.ode", "-n", "50")
    assert texts(path).count("phase plane") == 2 and upright(path)[-2:] == ["w1 [rad/s]", "w2 [rad/s]"] and texts(path).count("a2 [rad]") == 2


def test_all_labels_are_within_the_picture(start):
    """The lowest is that of the last panel, or of the phase plane; below its line are the lower parts of letters."""
    for program, names in (("oscillator.ode", "x,v"), ("kepler.ode", "r_x"), ("kepler.ode", "r_x,r_y")):
        root = xml.parse(draw(start, program, "-n", "30", "--observe", names)).getroot()
        places = [float(re.match(r"translate\([-\d.]+,([-\d.]+)\)", node.attrib["transform"])[1]) for node in root.iter(f"{SVG}g")
                  if node.attrib.get("transform", "").startswith("translate") and "".join(node.itertext()).strip()]
        assert max(places) + 5 <= float(root.attrib["height"])


def test_an_orbit_has_one_scale(start):
    """Kepler's ellipse with eccentricity 0.5 is 2 wide and 3^(1/2) high. A velocity over a position fills its panel."""
    path = draw(start, "kepler.ode", "-n", "800", "--observe", "r_x,r_y")
    wide, high = size(drawn(path)[-1])
    assert wide / high == pytest.approx(2 / 3**0.5, rel=0.01) and texts(path).count("orbit") == 1 and "phase plane" not in texts(path)
    wide, high = size(drawn(draw(start, "oscillator.ode", "-n", "800", "--observe", "x,v"))[-1])
    assert wide > 500 and high > 300


def test_an_orbit_stands_beside_panels_of_vectors(start):
    """The components of a vector have a panel, with a colour and a dash each. A vector whose derivative is no state is no position."""
    path = draw(start, "kepler.ode", "-n", "800")
    said = texts(path)
    assert upright(path) == ["v", "r", "r_y"] and {"v_x", "v_y", "r_x", "r_y"} <= set(said) and said.count("orbit") == 1
    assert strokes(path) == {BLUE, RED} and len(drawn(path)) == 3 and len(drawn(path, RED)) == 2
    wide, high = size(drawn(path)[2])
    assert wide / high == pytest.approx(2 / 3**0.5, rel=0.01)
    assert "orbit" not in texts(draw(start, "kepler.ode", "-n", "50", "--observe", "v_x,v_y"))
    assert "orbit" not in texts(draw(start, "rigid_body.ode", "-n", "50"))
    assert "orbit" in texts(draw(start, "kepler.ode", "-n", "50", "--observe", "r_x,r_y,energy"))


def test_bodies_in_one_plane_and_objects_have_their_colours(start):
    path = draw(start, "three_body.ode", "-n", "400")
    said = texts(path)
    assert upright(path) == ["v1", "v2", "v3", "r1", "r2", "r3", "y"] and said[-3:] == ["r1", "r2", "r3"] and strokes(path) == {BLUE, RED, GREEN}
    (wide, high), (other, _) = size(drawn(path)[-1]), size(drawn(path, GREEN)[-1])
    assert wide == pytest.approx(other, rel=0.02) and wide / high == pytest.approx(3.02, rel=0.02)    # the figure eight
    assert len({(round(x), round(y)) for x, y in ends(path)}) == 3
    path = draw(start, "kepler.ode", "-c", "many_full", "-N", "3", "--spread", "v_y=1.5:1.7", "-n", "200")
    assert upright(path) == ["v_x", "v_y", "r_x", "r_y", "r_y"] and texts(path).count("object 2") == 5 and strokes(path) == {BLUE, RED, GREEN}
    assert [len(drawn(path, colour)) for colour in (BLUE, RED, GREEN)] == [5, 5, 5]


def test_of_three_components_the_two_that_go_farthest(start):
    """With one scale, and as tall as it has to be."""
    path = draw(start, "projectile.ode", "-n", "64")
    wide, high = size(drawn(path)[-1])
    assert upright(path) == ["r [m]", "v [m/s]", "r_z [m]"] and "r_x [m]" in texts(path) and "phase plane" not in texts(path)
    assert wide / high == pytest.approx(96.4 / 19.9, rel=0.02) and high < 140


@pytest.mark.parametrize("text, alike", [
    ("param k = 1 [1/s]\nstate x = 1 [m]\nstate y = 0 [m]\nstep 0.125 [s]\nx' = -k*y\ny' = 2*k*x\n", True),
    ("param k = 1 [1/s]\nstate p = 1 [K]\nstate q = 0 [K]\nstep 0.125 [s]\np' = -k*q\nq' = 2*k*p\n", True),
    ("param c = 1 [m/kg/s]\nparam d = 2 [kg/m/s]\nstate p = 1 [m]\nstate q = 0 [kg]\nstep 0.125 [s]\np' = -c*q\nq' = d*p\n", False),
    ("state x = 1\nstate y = 0\nstep 0.125\nx' = -y\ny' = 2*x\n", False), ("state p[2] = (1, 0)\nstep 0.125\np.x' = -p.y\np.y' = 2*p.x\n", True),
    ("state x = 1 [1]\nstate v = 0 [1]\nstep 0.125 [1]\nx' = v\nv' = -2*x\n", True), ("state x = 1\nstate v = 0\nstep 0.125\nx' = v\nv' = -2*x\n", False)])
def test_which_axes_have_one_scale(start, tmp_path, text, alike):
    """An ellipse, 1 wide and 2^(1/2) high, of values with the same unit; else it fills the plane."""
    (tmp_path / "m.ode").write_text(text)
    wide, high = size(drawn(draw(start, "m.ode", "-n", "64"))[-1])
    assert wide / high == pytest.approx(1 / 2**0.5, rel=0.02) if alike else wide > 550


def test_other_names_have_no_phase_plane(start):
    path = draw(start, "kepler.ode", "-n", "50", "--observe", "r_x,energy")
    assert "phase plane" not in texts(path) and {"r_x", "energy", "time"} <= set(texts(path)) and strokes(path) == {BLUE}
    path = draw(start, "lorenz.ode", "-n", "50")
    assert "phase plane" not in texts(path) and upright(path) == ["x", "y", "z"]


def test_curves_go_where_the_values_are(start, tmp_path):
    """A straight line of 5 points is 5 points at equal distances, from the left to the right."""
    (tmp_path / "m.ode").write_text("state x = 0 [m]\nstep 1 [s]\nx' = 2\n")
    path = draw(start, "m.ode", "-n", "4", "--every", "1")
    marks = [tuple(map(float, re.match(r"translate\(([\d.]+),([\d.]+)\)", node.attrib["transform"]).groups()))
             for node in xml.parse(path).getroot().iter(f"{SVG}use") if "translate" in node.attrib.get("transform", "")]
    (x0, y0), *_, (x4, y4) = marks
    assert len(marks) == 5 and x4 > x0 and y4 < y0
    for i, (x, y) in enumerate(marks):
        assert x == pytest.approx(x0 + i * (x4 - x0) / 4, abs=0.2) and y == pytest.approx(y0 + i * (y4 - y0) / 4, abs=0.2)


def test_eight_objects_of_many(start):
    said = texts(draw(start, "ship.ode", "-c", "many_full", "-N", "300", "--spread", "T=1e5:3e5", "-n", "9"))
    assert "ship, rk4, h = 1 s, 8 of 300 objects" in said
    assert [name for name in said if name.startswith("object ")] == 3 * [f"object {i * 299 // 7}" for i in range(8)]
    said = texts(draw(start, "ship.ode", "-c", "many_full", "-N", "8", "-n", "9"))
    assert "ship, rk4, h = 1 s, 8 of 8 objects" in said and said.count("object 7") == 3


def test_png_and_a_file_besides(start, tmp_path):
    done = start("ship.ode", "-n", "9", "--every", "3", "--plot", "out.PNG")
    assert (tmp_path / "out.PNG").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n" and (tmp_path / "out.PNG").read_bytes()[-8:-4] == b"IEND"
    assert [row["step"] for row in done.rows] == ["0", "3", "6", "9"]
    # Alone it has some 1000 snapshots.
    done = start("ship.ode", "-e", "isa", "-n", "5001", "--plot", "out.svg")
    assert [row["step"] for row in done.rows] == [str(n) for n in [*range(0, 5001, 6), 5001]]


@pytest.mark.parametrize("values", [("1e30", "1e30", "nan"), ("nan", "1", "nan"), ("3", "1", "3"), ("0", "0", "0"), ("1e38", "1", "-1e38"), ("1e-45", "1", "0")])
def test_any_numbers_are_drawn(start, tmp_path, values):
    (tmp_path / "x.s").write_text(".state x y\n.param a\nstep: mul x, x, a\n mul y, x, -1.0\n")
    x, a, y = values
    for steps in (0, 1, 60):
        said = texts(draw(start, "x.s", "--set", f"x={x}", "--set", f"a={a}", "--set", f"y={y}", "--allow-failures", "-n", steps, "--every", "1"))
        # Ranges are of numbers.
        sizes = [abs(float(text)) for text in said if re.fullmatch(r"[-+.0-9e]+", text)]
        assert len(sizes) > 8 and max(sizes) <= max(61, *(2 * abs(float(v)) for v in values if v != "nan"))


def test_texts_are_no_commands(start, tmp_path):
    (tmp_path / "m.ode").write_text("model m \"it's `touch pwned` $HOME @x %d \\\\n\"\nstate x = 1 [m^2/s]\nstep 1 [s]\nx' = 0\n")
    assert "x [m^2/s]" in texts(draw(start, "m.ode")) and not (tmp_path / "pwned").exists()
    # Nor is what stands in the user's own settings.
    (tmp_path / ".gnuplot").write_text("exit status 3\n")
    draw(start, "m.ode", env={**os.environ, "HOME": str(tmp_path)})


# ---- what is refused ----

@pytest.mark.parametrize("arguments, message", [
    ("ship.ode --plot x.pdf", "x.pdf: expected the name of a picture that ends in .svg or .png"), ("ship.ode --plot -", "that ends in .svg or .png"),
    ("three_body.ode --plot x.svg -c many_full -N 2 --observe v1_x,v1_y,v2_x,v2_y,v3_x,v3_y,r1_x,r1_y,r2_x,r2_y,r3_x,r3_y,energy",
     "a picture has room for 12 panels over time, not for 13: observe fewer names"),
    ("ship.ode --plot x.svg -n 500000 --every 1", "500001 snapshots of 2 names of 1 objects are too many to draw"),
    ("ship.ode --plot x.svg --output ./x.svg", "--output ./x.svg and --plot x.svg are one file"),
    ("ship.ode --plot nowhere/x.svg", "cannot write"), ("ship.ode --plot x.svg --compress", "--compress: expected --output FILE"),
    ("ship.ode --plot x.svg --observe q", "is called 'q'")])
def test_what_is_refused(start, tmp_path, arguments, message):
    program, *rest = arguments.split()
    done = start(program, *rest, "-e", "isa", output=None, code=2)
    assert message in done.stderr and done.stdout == "" and list(tmp_path.iterdir()) == [], done.stderr


def test_without_gnuplot_nothing_is_run(start, tmp_path):
    done = start("ship.ode", "-e", "isa", "-n", "4000000000", "--plot", "x.svg", output=None, code=1, env={**os.environ, "PATH": str(tmp_path)})
    assert "drawn by gnuplot, which is not installed (Debian's package gnuplot-nox)" in done.stderr and list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("script, message", [
    ("[ $1 = --version ] || { echo 'line 7: no such thing' >&2; exit 2; }", "gnuplot: line 7: no such thing"),
    ("[ $1 = --version ] || exit 3", "gnuplot ends with 3"), ("exit 4", "gnuplot does not start: it ends with 4"),
    ("[ $1 = --version ] || kill -9 $$", "gnuplot ends with -1")])
def test_gnuplot_fails(start, tmp_path, script, message):
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin/gnuplot").write_text(f"#!/bin/sh\n{script}\n")
    (tmp_path / "bin/gnuplot").chmod(0o755)
    (tmp_path / "x.svg").write_text("before")
    done = start("ship.ode", "-e", "isa", "--plot", "x.svg", output=None, code=1, env={**os.environ, "PATH": f"{tmp_path / 'bin'}:{os.environ['PATH']}"})
    assert message in done.stderr and (tmp_path / "x.svg").read_text() == "before", done.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bin", "x.svg"]


@pytest.mark.parametrize("when", ["", "[ $1 = --version ] || "])
def test_gnuplot_hangs(start, tmp_path, fast_clock, when):
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin/gnuplot").write_text(f"#!/bin/bash\n{when}for ((;;)); do :; done\n")
    (tmp_path / "bin/gnuplot").chmod(0o755)
    done = start("ship.ode", "-e", "isa", "--plot", "x.svg", output=None, code=1, env={**os.environ, **fast_clock, "PATH": f"{tmp_path / 'bin'}:{os.environ['PATH']}"})
    assert "gnuplot took longer than 120 s, and was ended" in done.stderr, done.stderr


def test_a_full_disk_is_told(start, tmp_path):
    (tmp_path / "full.svg").symlink_to("/dev/full")
    done = start("ship.ode", "-e", "isa", "--plot", "full.svg", output=None, code=1)
    assert "full.svg: cannot write: No space left on device" in done.stderr

    def small():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (30000, 30000))
    for name in ("x.svg", "x.png"):
        done = start("ship.ode", "-e", "isa", "--plot", name, "-n", "20", output=None, code=1, preexec_fn=small)
        assert f"{name}: cannot write: File too large" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["full.svg"]
