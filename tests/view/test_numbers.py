"""A page holds the recording's numbers, to the error that it tells; what is no recording is refused."""

import subprocess

import h5py
import numpy
import pytest

from unpacked import Page


def within(page, name, truth):
    """All values are there, none further off than the page says."""
    column, made = page.columns[name], page.values(name)
    assert made.shape == truth.shape
    assert (numpy.isnan(made) == ~numpy.isfinite(truth)).all()
    good = numpy.isfinite(truth)
    assert (abs(made[good] - truth[good].astype(float)) <= column["bound"] * (1 + 1e-9) + 1e-300).all()
    if not column["isFloat"]:
        assert column["bound"] <= (float(truth[good].max()) - float(truth[good].min())) / 2 / 65534 * (1 + 1e-9)


@pytest.mark.smoke
@pytest.mark.parametrize("name", ["balls.h5", "balls.csv"])
def test_16_bits(run, root, tmp_path, name):
    run("run", "--scene", root / "programs/world/balls.scene", "-n", "300", "--every", "10", "--output", "balls.h5")
    run("run", "--scene", root / "programs/world/balls.scene", "-n", "300", "--every", "10", "--output", "balls.csv")
    said = run("view", name, "-o", "page.html").stdout
    page = Page(tmp_path / "page.html")
    with h5py.File(tmp_path / "balls.h5") as file:
        for state in ("x_x", "x_y", "x_z", "v_x", "v_y", "v_z"):
            within(page, state, file[state][()])
            assert f"{state} " in said and "+-" in said
            assert (page.columns[state]["least"], page.columns[state]["most"]) == (file[state][()].min(), file[state][()].max())
        assert page.about["steps"] == {"first": 0, "every": 10, "last": 300} and page.about["times"] == {"h": file.attrs["h"]}
    assert page.about["radius"] == (0.05000000074505806 if name.endswith("h5") else 0)
    speed = next(field for field in page.about["fields"] if field["name"] == "|v|")
    assert len(speed["columns"]) == 3 and page.about["fields"][page.about["colour"]] == speed if name.endswith("h5") else page.about["colour"] == -1


def test_32_bits(run, balls, tmp_path):
    assert "+-" not in run("view", balls, "--exact").stdout
    page = Page(tmp_path / "balls.html")
    with h5py.File(tmp_path / balls) as file:
        for state in ("x_x", "x_y", "v_z"):
            assert (page.values(state).view(numpy.uint32) == file[state][()].view(numpy.uint32)).all()


def test_links(run, root, tmp_path):
    run("run", "--scene", root / "programs/world/cloth.scene", "-n", "20", "--every", "10", "--output", "c.h5")
    run("view", "c.h5")
    with h5py.File(tmp_path / "c.h5") as file:
        assert (Page(tmp_path / "c.html").links() == file["links:springs"][()]).all()


def test_every_and_observe(run, balls, tmp_path):
    run("view", balls, "--every", "7", "--observe", "v_y")
    page = Page(tmp_path / "balls.html")
    assert set(page.columns) == {"x_x", "x_y", "x_z", "v_x", "v_y", "v_z"}, "the position and the colour are there, too"
    run("view", balls, "--every", "7", "--observe", "v_y", "--colour", "v_y")
    page = Page(tmp_path / "balls.html")
    assert set(page.columns) == {"x_x", "x_y", "x_z", "v_y"}
    with h5py.File(tmp_path / balls) as file:
        within(page, "v_y", file["v_y"][::7])
        assert page.about["snapshots"] == 6 and page.about["steps"] == {"first": 0, "every": 70, "last": 350}


@pytest.mark.parametrize("every", [1, 2, 3])
def test_csv_by_hand(run, tmp_path, every):
    """Odd steps and times, numbers that are none, whole numbers, a constant."""
    rows = [(0, 0.0), (3, 0.25), (4, 0.5), (9, 4.0)]
    text = "step,time [s],object,p_x [m],p_y [m],n,c\n"
    truth = {name: [] for name in ("p_x", "p_y", "n", "c")}
    for k, (step, time) in enumerate(rows):
        for i in range(3):
            values = [["nan", "1e30", "-3"][i] if k == 1 else f"{i + k / 3}", f"{k * i - 1.5}", str(1000 * k + i), "0.1"]
            text += f"{step},{time},{i},{','.join(values)}\n"
            for name, value in zip(truth, values):
                truth[name].append(float(value))
    (tmp_path / "a.csv").write_text(text)
    run("view", "a.csv", "--every", str(every))
    page = Page(tmp_path / "a.html")
    for name, values in truth.items():
        within(page, name, numpy.array(values, numpy.float32).reshape(4, 3)[::every])
    assert page.columns["n"]["bound"] == page.columns["c"]["bound"] == 0
    times = page.about["times"]
    steps = page.about["steps"]
    if isinstance(steps, dict):
        steps = [min(steps["first"] + k * steps["every"], steps["last"]) for k in range(len(rows[::every]))]
    if isinstance(times, dict):
        times = [step * times["h"] for step in steps]
    assert list(zip(steps, times)) == rows[::every]


HEAD = "step,time [s],object,p_x [m],p_y [m]\n"
BROKEN = {
    "": "empty, expected a recording",
    "a,b\n1,2\n": "a.csv:1: found no recording, expected a head 'step,time,object,...'",
    "step,object\n0,0\n": "found no recording",
    HEAD: "the recording has no snapshot",
    HEAD + "0,0,0,1,x\n": "a.csv:2:9: found 'x', expected a number",
    HEAD + "0,0,0,1\n": "a.csv:2:8: found 4 numbers, expected 5: a number for each name of the head",
    HEAD + "0,0,0,1,2,3\n": "a.csv:2:11: found '3', expected the end of the line: the head has no more names",
    HEAD + "0,0,1,1,2\n": "a.csv:2:1: found step 0 of object 1, expected a later step of object 0",
    HEAD + "0,0,0,1,2\n0,0,2,1,2\n": "a.csv:3:1: found step 0 of object 2, expected the same step of object 1",
    HEAD + "0,0,0,1,2\n1,0,1,1,2\n": "a.csv:3:1: found step 1 of object 1, expected the same step of object 1",
    HEAD + "0,0,0,1,2\n0,0,0,1,2\n": "a.csv:3:1: found step 0 of object 0, expected a later step of object 0",
    HEAD + "0,0,0,1,2\n0,0,1,1,2\n1,0,0,1,2\n": "a.csv:4: found the end of the file, expected all objects of the last step",
    HEAD + "0,0,0,1,2\n0,0,1,1,2\n1,0,0,1,2\n2,0,0,1,2\n": "a.csv:5:1: found the next step, expected all objects of the snapshot before",
    HEAD + "0,0,0,1,2\n1,0,0,1,2\n1,0,1,1,2\n": "a.csv:4:1: found one object more, expected as many as the first step has",
    HEAD + "0,0,0,1,1e300\n": "a.csv:2:9: found '1e300', expected a number in the range of FP32",
    HEAD + "-1,0,0,1,2\n": "a.csv:2:1: found '-1', expected a number in decimal digits",
    "step,object,p_x,p_x\n": "a.csv:1:17: found 'p_x', expected a name that no other column has",
    "step,object,p_x [m\n": "a.csv:1:13: found 'p_x [m', expected a unit in brackets",
    HEAD + "0,0,0,1,2\0\n": "a.csv:2:10: found a NUL, expected text",
    "# lines\n\n" + HEAD + "\n 0 , 0,0,1,\tz\n": "a.csv:5:13: found 'z', expected a number",
}


@pytest.mark.smoke
@pytest.mark.parametrize("text", BROKEN)
def test_what_is_broken_is_refused(run, tmp_path, text):
    (tmp_path / "a.csv").write_text(text)
    assert BROKEN[text] in run("view", "a.csv", code=2).stderr.replace(" error:", "")
    assert not (tmp_path / "a.html").exists()


@pytest.mark.parametrize("spoil, message", [
    (lambda f: f.__delitem__("step"), "expected a dataset 'step'"),
    (lambda f: f.create_dataset("late", data=numpy.zeros((3, 2))), "'v_x' has 300 objects, and 'late' has 2"),
    (lambda f: f.create_dataset("late", data=numpy.zeros((3, 300))), "'late' has 3 snapshots, and 'step' has 41"),
    (lambda f: f.create_dataset("links:x", data=numpy.array([[0, 300]])), "link 0 of 'x' names object 300, and there are 300"),
    (lambda f: f.create_dataset("big", data=numpy.full((41, 300), 1e300)), "'big' has numbers beyond the range of FP32"),
])
def test_broken_hdf5_is_refused(run, balls, tmp_path, spoil, message):
    with h5py.File(tmp_path / balls, "a") as file:
        spoil(file)
    assert message in run("view", balls, code=2).stderr
    assert not (tmp_path / "balls.html").exists()


def test_cut_hdf5_is_refused(run, balls, tmp_path):
    whole = (tmp_path / balls).read_bytes()
    for size in (0, 100, 3000, len(whole) // 2, len(whole) - 1000):
        (tmp_path / "cut.h5").write_bytes(whole[:size])
        assert "cut.h5" in run("view", "cut.h5", code=2).stderr
    assert "cannot open" in run("view", "nothing.h5", code=2).stderr
    assert not list(tmp_path.glob("*.html"))


def test_numbers_elsewhere_are_not_read(run, balls, tmp_path):
    """A file may name other files; a page must not show them."""
    (tmp_path / "secret").write_bytes(b"secret " * 20000)
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["z"] = numpy.zeros((41, 300))
    with h5py.File(tmp_path / balls, "a") as file:
        file["linked"] = h5py.ExternalLink("other.h5", "/z")
        file.create_dataset("outside", (41, 300), "f4", external=[("secret", 0, 41 * 300 * 4)])
    run("view", balls)
    assert set(Page(tmp_path / "balls.html").columns) == {"x_x", "x_y", "x_z", "v_x", "v_y", "v_z"}


# ---- what is drawn where ----

def positions(run, tmp_path, head, *arguments, code=0):
    (tmp_path / "p.csv").write_text(head + "\n" + ",".join("0" for _ in head.split(",")) + "\n")
    done = run("view", "p.csv", *arguments, code=code)
    return Page(tmp_path / "p.html").about if code == 0 else done.stderr


@pytest.mark.parametrize("head, arguments, axes", [
    ("step,object,v_x [m/s],v_y [m/s],r_x [m],r_y [m]", [], ["r_x", "r_y"]),
    ("step,object,r_x [AU],r_y [AU],r_z [AU]", [], ["r_x", "r_y", "r_z"]),
    ("step,time [s],object,v [m/s],s [m]", [], ["s", "v"]),
    ("step,object,a,b,c", ["--position", "c,a"], ["c", "a"]),
    ("step,object,a,b,c", ["--position", "b"], ["b"]),
    ("step,object,u [m]", ["--position", "object,u"], ["object", "u"]),
    ("step,time [s],object,u [m]", ["--position", "time,u"], ["time", "u"]),
    ("step,object,q_x,q_y,q_z,r_x [m],r_y [m]", ["--position", "q"], ["q_x", "q_y", "q_z"]),
])
def test_the_position(run, tmp_path, head, arguments, axes):
    about = positions(run, tmp_path, head, *arguments)
    assert [about["columns"][k]["name"] for k in about["position"]["columns"]] == axes
    units = {about["columns"][k]["unit"] for k in about["position"]["columns"]}
    assert about["position"]["hasOneScale"] == (len(units) == 1)


@pytest.mark.parametrize("position, radius", [("x", 0.05), ("x_z,x_y", 0.05), ("v", 0), ("x_x,v_x", 0), ("object,x_y", 0)])
def test_a_reach_is_a_size_where_it_is_measured(run, balls, tmp_path, position, radius):
    run("view", balls, "--position", position)
    assert Page(tmp_path / "balls.html").about["radius"] == pytest.approx(radius)


@pytest.mark.parametrize("head, arguments, message", [
    ("step,object,a,b [kg]", [], "no position found: no vector (name_x, name_y) has the unit of a length. There are a, b [kg]: name"),
    ("step,object,a", ["--position", "z"], "no value is called 'z': there are a, and object"),
    ("step,object,a", ["--position", "a,a,a,a"], "--position: found 'a,a,a,a', expected one to three names"),
    ("step,object,r_x [m],r_y [m]", ["--colour", "w"], "no value is called 'w'"),
    ("step,object,r_x [m],r_y [m]", ["--size", "-1"], "--size: found '-1', expected a radius above 0"),
    ("step,object,r_x [m],r_y [m]", ["--size", "w"], "no value is called 'w'"),
    ("step,object,a [m],b [s]", ["--position", "a,b", "--size", "1"], "a radius has no length there"),
    ("step,object,r_x [m],r_y [m]", ["--plane", "w=1"], "--plane: found 'w=1', expected x, y or z"),
    ("step,object,r_x [m],r_y [m]", ["--plane", "x=1/0"], "--plane: '1/0' is no number"),
    ("step,object,r_x [m],r_y [m]", ["--plane", "z=1"], "--plane: the position has no z"),
    ("step,object,r_x [m],r_y [m]", ["--box", "1:0,0:1"], "expected the smaller number first"),
    ("step,object,r_x [m],r_y [m]", ["--box", "0:1,0:1,0:1"], "--box: the position has 2 axes"),
    ("step,object,r_x [m],r_y [m]", ["--every", "0"], "--every: '0' is no number from 1"),
    ("step,object,r_x [m],r_y [m]", ["--up", "x"], "--up: found 'x', expected y or z"),
    ("step,object,r_x [m],r_y [m]", ["-o", "p.csv"], "--output p.csv would overwrite RECORDING p.csv"),
])
def test_what_cannot_be_drawn_is_refused(run, tmp_path, head, arguments, message):
    assert message in positions(run, tmp_path, head, *arguments, code=2)
    assert not (tmp_path / "p.html").exists()


def test_a_page_of_somebody_else_stays(run, balls, tmp_path):
    (tmp_path / "balls.html").write_text("<p>mine")
    assert "balls.html exists, and is no page of fp3 view" in run("view", balls, code=2).stderr
    assert (tmp_path / "balls.html").read_text() == "<p>mine"
    run("view", balls, "-o", "balls.html")
    run("view", balls)


def test_from_a_pipe_to_a_pipe(run, root, tmp_path, fp3):
    csv = run("run", root / "programs/kepler.ode", "-n", "4", "--every", "1", "--output", "-").stdout
    made = run("view", "-", "--position", "r", "-o", "-", input=csv)
    assert made.stdout.startswith("<!doctype html>") and made.stdout.endswith("</html>\n") and "kept to" in made.stderr
    assert "expected --output FILE" in run("view", "-", input=csv, code=2).stderr


def test_many_columns_take_time_in_proportion(run, root, tmp_path, fp3):
    """It took the square: 4 s of a processor for these 1.2 million numbers, now below 0.1 s."""
    names, row = ",".join(f"c{i}" for i in range(4000)), ",".join(f"{i}.5" for i in range(4000))
    (tmp_path / "wide.csv").write_text(f"step,time [s],object,{names}\n" + "".join(f"{k},{k},0,{row}\n" for k in range(300)))
    done = subprocess.run(["prlimit", "--cpu=2", fp3, "view", tmp_path / "wide.csv", "--position", "c0", "--observe", "c3999", "-o", tmp_path / "wide.html"])
    assert done.returncode == 0


def test_too_much_is_refused_before_it_is_read(run, tmp_path):
    with h5py.File(tmp_path / "big.h5", "w") as file:
        file["step"] = numpy.arange(3000, dtype=numpy.uint64)
        for name in ("r_x", "r_y"):
            file.create_dataset(name, (3000, 100000), "f4", chunks=(1, 100000)).attrs["units"] = "m"
    assert "choose fewer with --every and --observe" in run("view", "big.h5", code=2).stderr
