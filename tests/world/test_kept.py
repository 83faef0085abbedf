"""Lists of near objects that the hardware makes itself, and one list of all: the words and flags of the engine isa, no host between steps, and what is too much."""

import re
import subprocess

import pytest
from test_living import LIVING, Scene
from test_world import BALLS, PILE, balls, fliers, script  # noqa: F401, pylint: disable=unused-import

STATES = "x_x x_y x_z v_x v_y v_z"
# Two lists, one of them given; and a position in a plane.
TIED = """
state x[2] = (0, 0)
state v[2] = (0, 0)
near touch(x, 0.1)
links ties(k = 1)
step 0.01
F = sum(o in touch: (norm(o.x - x) - 0.1)/norm(o.x - x)*(o.x - x)) + sum(o in ties: 0.1*o.k*(o.x - x))
x' = v
v' = F
"""


def tied(n):
    return [f"objects {n}", "state x_x " + " ".join(repr(0.09 * (i % 7)) for i in range(n)), "state x_y " + " ".join(repr(0.08 * (i // 7)) for i in range(n)),
            "state v_x " + " ".join(repr(0.3 * ((i * 5) % 11 - 5)) for i in range(n)), "near touch 0.1 0.02 x_x x_y",
            *(f"links ties {i} {(i + 3) % n} 1" for i in range(n))]


@pytest.mark.parametrize("model, start, states, integrators", [(BALLS, balls, STATES, ("euler", "leapfrog")), (BALLS, fliers, STATES, ("leapfrog", "rk4")),
                                                               (PILE, balls, STATES, ("leapfrog",)), (TIED, tied, "x_x x_y v_x", ("leapfrog",))],
                         ids=["balls", "fliers", "pile", "tied"])
def test_lists_made_by_the_hardware_change_no_bit(script, model, start, states, integrators):  # noqa: F811
    for integrator in integrators:
        lines = [*start(60), "flags 1", "flags 30", f"print {states}", "flags 9", f"print {states}", "failure"]
        assert script(model, lines, "rtl@world_keep", integrator) == script(model, lines, "isa@world_keep", integrator), integrator


def test_a_skin_of_nothing_has_lists_made_in_each_step(script):  # noqa: F811
    lines = [*fliers(30, 0), "flags 20", f"print {STATES}"]
    assert script(BALLS, lines, "rtl@world_keep") == script(BALLS, lines, "isa@world_keep")


SCENE = """
steps = 10;
groups = ( { program = "m.ode"; integrator = "semi_implicit_euler"; objects = 40;
             random = { position = "x"; from = [0.05, 0.05, 0.05]; to = [0.5, 0.5, 0.5]; apart = 0.09; seed = 1; }; } );
"""


def test_the_host_has_nothing_to_do_between_steps(fp3, tmp_path):
    (tmp_path / "m.ode").write_text(BALLS)
    (tmp_path / "m.scene").write_text(SCENE)

    def said(config, steps):
        done = subprocess.run([fp3, "run", "--scene", "m.scene", "-c", config, "--engine", "rtl", "--steps", str(steps), "--clock", "100MHz"], cwd=tmp_path, capture_output=True,
                              text=True, timeout=120)
        assert done.returncode == 0, done.stderr
        return int(re.search(r"([\d,]+) transfers", done.stdout)[1].replace(",", ""))
    assert abs(said("world_keep", 12) - said("world_keep", 6)) < 4        # it asks whether the run is over
    assert said("world", 12) > said("world", 6) + 6 * 40


@pytest.mark.parametrize("steps, message", [(1, "object 0 has more than"), (40, "has more than")])
def test_a_list_without_room_is_told(script, steps, message):  # noqa: F811
    """120 records of 16 words leave room for 103 entries of each, and all fall together: in the first list already, or in one that the hardware makes."""
    n = 120
    far, near = [0.2 * i for i in range(n)], [0.0005 * i for i in range(n)]
    lines = [f"objects {n}", "state x_x " + " ".join(map(repr, near if steps == 1 else far)), "state v_x " + " ".join(repr(-x / 0.03) for x in far),
             "near touch 0.1 0.02 x_x x_y x_z", f"go {steps}"]
    said = script(BALLS, lines, "rtl@world_keep", "euler")
    assert message in said[0] and "neighbours in a list: the store of configuration 'world_keep' has room for so many" in said[0], said


# Points in a row. From step 4 to 6 some have NaN as their position; others jump meanwhile, so lists are made.
LOST = """model lost "points that come back from nowhere"
param kick = 0
state lost = 0
state y = 0
state x = 0
state n = 0
near close(x, 0.125)
step 0.0078125
q = lost*lost
y' = 0.25
x' = 0.25
lost' = 0
n' = sum(o in close: 1)
project x = y + (t < 0.03 ? 0 : t < 0.05 ? q - q : 0) + (t > 0.03 ? kick : 0)
"""
NOWHERE = """steps = 8;
groups = ( { program = "lost.ode"; integrator = "euler"; objects = 100; spread = { x = [0.0, 3.0]; y = [0.0, 3.0]; };
             only = ( { objects = "10..40"; set = { lost = 1e30; }; }, { objects = "60..62"; set = { kick = 0.03; }; } ); } );
"""


def test_an_object_that_comes_from_nowhere_has_moved(fp3, tmp_path):
    """Nobody is near a NaN, so the lists made then do not have the object."""
    (tmp_path / "lost.ode").write_text(LOST)
    (tmp_path / "lost.scene").write_text(NOWHERE)

    def words(engine):
        done = subprocess.run([fp3, "run", "--scene", "lost.scene", "-c", "world_keep", "--engine", engine, "--all", "--allow-failures"], cwd=tmp_path, capture_output=True, text=True,
                              timeout=120)
        assert done.returncode == 0, done.stderr
        return [line for line in done.stdout.splitlines() if "  object " in line]
    assert len(words("rtl")) == 500 and words("rtl") == words("isa")


# Without softening an object that saw itself would be a NaN.
STARS = """
param m = 1
state x[2] = (0, 0)
state v[2] = (0, 0)
all others
step 0.01
x' = v
v' = sum(o in others: o.m/dot(o.x - x, o.x - x)^1.5*(o.x - x))
"""
# Few words a turn, and records of 16 words: 481 of them, and a row of each, are in half of the store.
OTHER = [f"y{i}" for i in range(9)]
CROWD = "\n".join([*(f"state {name} = 0" for name in ("x", "s", *OTHER)), "all others", "step 1", *(f"{name}' = 0" for name in ("x", *OTHER)),
                   "s' = sum(o in others: o.x)\n"])
MOST = 481


def stars(n):
    return [f"objects {n}", "state x_x " + " ".join(repr(0.5 * i - (i % 3)) for i in range(n)), "state x_y " + " ".join(repr(0.3 * (i * i % 11)) for i in range(n)),
            "param m " + " ".join(repr(0.01 * (i + 1)) for i in range(n)), "all others"]


@pytest.mark.parametrize("objects", [1, 2, 3, 24, 25, 49])
def test_nobody_sees_itself_in_the_list_of_all(script, objects):  # noqa: F811
    lines = [*stars(objects), "flags 1", "flags 5", "print x_x x_y v_x v_y", "failure"]
    assert script(STARS, lines, "rtl@world_keep", "rk4") == script(STARS, lines, "isa@world", "rk4")


@pytest.mark.parametrize("name", ["kinds 3", "kinds 17"])
def test_all_and_near_objects_that_come_and_go(script, name):  # noqa: F811
    """Links, near objects and all others: with births the host makes the near list, without them the hardware does."""
    scene = Scene(LIVING[name], 5, 19)
    assert script(scene.model, scene.whole(3), "rtl@world_keep") == script(scene.model, scene.whole(3), "isa")
    lines = [*scene.lines(list(range(scene.n)), scene.columns), "flags 12", "print " + " ".join(scene.states)]
    assert script(scene.model, lines, "rtl@world_keep") == script(scene.model, lines, "isa")


def test_as_many_as_the_store_holds_see_each_other(script):  # noqa: F811
    def said(objects, engine):
        return script(CROWD, [f"objects {objects}", "state x " + " ".join(str(i % 7) for i in range(objects)), "all others", "go 1", "print s"], engine, "euler")
    assert said(MOST, "rtl@world_keep") == said(MOST, "isa@world_keep")
    assert said(MOST + 1, "rtl@world_keep")[0] == f"error engine 'rtl': the store of configuration 'world_keep' has no room for a list of all {MOST + 1} objects: " \
        "its 16384 words are full"


def test_guests_are_in_the_list_of_all(fp3, tmp_path):
    """Two groups: each object sees all others of its own, and all of the other group, which are guests in its store."""
    for one, two in ("ab", "ba"):
        (tmp_path / f"{one}.ode").write_text(f"kind {two}(x[2])\nstate x[2] = (0, 0)\nall mine\nall theirs({two})\nstep 0.25\n"
                                             "x' = sum(o in mine: (o.x - x)/norm(o.x - x)) + 0.1*sum(o in theirs: o.x - x)\n")
    groups = ", ".join(f'{{ program = "{name}.ode"; integrator = "leapfrog"; objects = {count}; random = {{ position = "x"; from = [0, 0]; to = [9, 9]; apart = 0.1; '
                       f'seed = {count}; }}; }}' for name, count in (("a", 5), ("b", 26)))
    (tmp_path / "m.scene").write_text(f"steps = 6;\ngroups = ( {groups} );\n")

    def said(engine, config):
        done = subprocess.run([fp3, "run", "--scene", "m.scene", "--engine", engine, "-c", config, "--all"], cwd=tmp_path, capture_output=True, text=True, timeout=120)
        assert done.returncode == 0, done.stderr
        return re.findall("0x[0-9a-f]{8} .*", done.stdout)
    assert said("rtl", "world_keep") == said("isa", "world") and len(said("isa", "world")) == 62
