"""Worlds of rigid bodies on 1, 2 and 3 ranks: islands are divided, and every rank has the same world behind each step."""

import re
import subprocess

import pytest

PLANE = """
steps = 150;
bodies = (
    { name = "ground"; type = "static"; x = [0.0, -1.0]; shapes = { box = [60.0, 1.0]; friction = 0.8; }; },
    { name = "brick"; count = (4, "4 - i"); x = ("1.02*(j + i/2) - 20", "i + 0.5"); shapes = { box = [0.5, 0.5]; }; },
    { name = "tower"; count = [3, 3]; x = ("4*i - 10", "j + 0.5"); shapes = { box = [0.4, 0.5]; restitution = 0.1; }; },
    { name = "belt"; type = "kinematic"; x = [6.0, 0.5]; v = [-0.6, 0.0]; shapes = { box = [2.0, 0.2]; belt = 0.5; }; },
    { name = "ball"; count = 6; x = ("0.7*n + 4", "2 + n"); v = [0.0, -3.0]; shapes = { circle = 0.3; restitution = 0.8; rolling = 0.1; }; },
    { name = "link"; count = (3, 5); x = ("4*i + 12 + 0.5*j", 6.0); shapes = { capsule = ( [-0.2, 0.0], [0.2, 0.0] ); radius = 0.06; }; },
    { name = "load"; count = 3; x = ("4*n + 14.8", 6.0); shapes = { circle = 0.4; density = "100*n + 1"; }; },
    { name = "car"; x = [-30.0, 1.2]; shapes = { box = [1.2, 0.3]; }; },
    { name = "wheel"; count = 2; x = ("2*n - 31", 0.6); shapes = { circle = 0.4; friction = 1.2; }; },
    { name = "arm"; count = 4; x = ("2*n + 30", 4.0); shapes = { box = [0.6, 0.2]; }; },
    { name = "knob"; count = 4; x = ("2*n + 31", 4.0); w = 3.0; shapes = { circle = 0.2; }; }
);
joints = (
    { count = 3; hinge = ["ground", "link[5*n]"]; at = ("4*n + 11.75", 6.0); },
    { count = (3, 4); hinge = ["link[5*i + j]", "link[5*i + j + 1]"]; at = ("4*i + 12.25 + 0.5*j", 6.0); },
    { count = 3; hinge = ["link[5*n + 4]", "load[n]"]; at = ("4*n + 14.4", 6.0); force = 2000.0; },
    { count = 2; wheel = ["car", "wheel[n]"]; at = ("2*n - 31", 0.6); axis = [0.0, 1.0]; hertz = 4.0; speed = -12.0; most = 20.0; },
    { weld = ["arm[0]", "knob[0]"]; at = [30.5, 4.0]; torque = 30.0; },
    { slider = ["arm[1]", "knob[1]"]; at = [32.5, 4.0]; axis = [1.0, 0.0]; limits = [-0.1, 0.4]; },
    { rod = ["arm[2]", "knob[2]"]; anchor_a = [0.0, 0.0]; anchor_b = [0.0, 0.1]; },
    { gear = ["arm[3]", "knob[3]"]; ratio = -2.0; }
);
"""
SPACE = """
dimensions = 3;
steps = 90;
bodies = (
    { name = "ground"; type = "static"; shapes = { plane = [0.0, 1.0, 0.0]; }; },
    { name = "thing"; count = [3, 3, 2]; x = ("2*j - 3 + 0.1*random", "0.8 + 1.1*i", "k + 0.1*random"); q = ("random", "random - 0.5", "random - 0.5", "random - 0.5");
      one_of = ( { box = [0.4, 0.3, 0.2]; rolling = 0.05; }, { sphere = 0.4; restitution = 0.7; }, { capsule = ( [-0.2, 0.0, 0.0], [0.2, 0.0, 0.0] ); radius = 0.25; },
                 { hull = ( [0.5, 0.0, 0.0], [-0.4, 0.4, 0.0], [-0.4, -0.4, 0.0], [0.0, 0.0, 0.6] ); } ); },
    { name = "cube"; count = (3, "3 - i"); x = ("10 + 1.02*(j + i/2)", "i + 0.5", 0.0); shapes = { box = [0.5, 0.5, 0.5]; }; },
    { name = "belt"; type = "kinematic"; x = [0.0, 0.2, 5.0]; v = [0.0, 0.0, -1.0]; shapes = { box = [4.0, 0.2, 0.5]; surface = [1.0, 0.0, 0.0]; }; },
    { name = "arm"; count = 6; x = ("3*n - 30", 2.5, 0.0); shapes = { box = [0.5, 0.2, 0.1]; }; },
    { name = "knob"; count = 6; x = ("3*n - 29", 2.5, 0.0); spin = [1.0, 2.0, 3.0]; shapes = { box = [0.2, 0.1, 0.3]; }; }
);
joints = (
    { ball = ["arm[0]", "knob[0]"]; at = [-29.5, 2.5, 0.0]; limits = [0.0, 1.0]; },
    { hinge = ["arm[1]", "knob[1]"]; at = [-26.5, 2.5, 0.0]; axis = [0.0, 1.0, 0.0]; speed = 3.0; most = 2.0; },
    { slider = ["arm[2]", "knob[2]"]; at = [-23.5, 2.5, 0.0]; axis = [1.0, 0.0, 0.0]; limits = [-0.1, 0.1]; speed = 1.0; most = 0.2; force = 0.15; },
    { weld = ["arm[3]", "knob[3]"]; at = [-20.5, 2.5, 0.0]; force = 2.0; },
    { rod = ["arm[4]", "knob[4]"]; anchor_a = [0.0, 0.0, 0.0]; anchor_b = [0.0, 0.1, 0.0]; },
    { wheel = ["arm[5]", "knob[5]"]; at = [-14.5, 2.5, 0.0]; axis = [0.0, 1.0, 0.0]; axle = [0.0, 0.0, 1.0]; hertz = 4.0; }
);
"""
WORLDS = {"plane": PLANE, "space": SPACE}


@pytest.fixture
def scene(tmp_path, request):
    path = tmp_path / "world.scene"
    path.write_text(WORLDS[request.param])
    return path


def ran(mpirun, fp3, scene, ranks, *more):
    """What is printed but for the time and what ranks did, both files, and the rows of each rank."""
    names = [scene.parent / name for name in ("where.csv", "contacts.csv")]
    done = mpirun(ranks, fp3, "run", "--scene", scene, "--every", 15, "--output", names[0], "--contacts", names[1], "--all", *more)
    assert done.returncode == 0, done.stdout + done.stderr
    rows = [int(found) for found in re.findall(r"^rank \d+ +(\d+) rows", done.stdout, re.M)]
    return re.sub(r"^(time|rank|exchange) .*\n", "", done.stdout, flags=re.M), [name.read_bytes() for name in names], rows


@pytest.mark.parametrize("scene", WORLDS, indirect=True)
def test_ranks_give_bodies_the_same_bits(mpirun, fp3, scene):
    """With every joint, heavy trees, impacts, belts, joints that break and bodies that fall asleep; and laws on an engine for the first steps."""
    said, files, none = ran(mpirun, fp3, scene, 1)
    assert none == [] and "hash" in said and len(files[0].splitlines()) > 100 and b"hit" in files[1]
    assert "broke" in said and ", of which 0 broke" not in said
    for ranks in (2, 3):
        *same, rows = ran(mpirun, fp3, scene, ranks)
        assert same == [said, files], ranks
        assert len(rows) == ranks and min(rows) > 0.7 * max(rows), rows
    alone, both = (ran(mpirun, fp3, scene, ranks, "-e", "isa", "--steps", 3) for ranks in (1, 2))
    assert alone[:2] == both[:2]


OTHERS = {"plane": [("friction = 0.8", "friction = 0.7"), ("steps = 150", "steps = 151"), ("restitution = 0.8", "restitution = 0.7"),
                    ("speed = -12.0", "speed = -11.0"), ("100*n + 1", "100*n + 2")],
          "space": [("surface = [1.0, 0.0, 0.0]", "surface = [1.0, 0.0, 0.1]"), ("[0.0, 0.0, 0.6]", "[0.0, 0.0, 0.7]"), ("hertz = 4.0", "hertz = 5.0")]}


@pytest.mark.parametrize("scene", WORLDS, indirect=True)
def test_ranks_with_other_worlds_are_refused(mpirun, fp3, scene, request):
    """They differ in one value, which no step has shown yet: also of a form, and the steps of the file."""
    kind = request.node.callspec.params["scene"]
    for old, new in OTHERS[kind]:
        assert old in WORLDS[kind], old
        other = scene.with_name("other.scene")
        other.write_text(WORLDS[kind].replace(old, new))
        choose = '[ "$OMPI_COMM_WORLD_RANK$PMI_RANK" = 1 ] && exec "$0" run --scene "$2"; exec "$0" run --scene "$1"'
        done = mpirun(2, "sh", "-c", choose, fp3, scene, other, timeout=40)
        assert done.returncode == 2 and done.stderr.count("ranks have different worlds of bodies") == 1, (new, done.stderr)


def test_a_rank_without_memory_tells_the_others(build):
    done = subprocess.run([build / "tests/short_of_memory"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0 and done.stdout == "0 failed\n", done.stdout + done.stderr
