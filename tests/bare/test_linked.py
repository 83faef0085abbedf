"""Objects that see each other, more than the store holds: one list of transfers on simulated hardware, or a refusal with its reason."""

import json
import subprocess

import pytest

# Words that others read and no step changes, words of one object alone, two relations, one with fields.
WEB = """model web "points on threads"
param p = 1
param q = 0.5
state x = 0
state v = 0
links ties(k = 1, rest = 0.25)
links far
step 0.0078125
x' = v
v' = sum(o in ties: o.k*o.p*(o.x - x - o.rest)) + 0.125*sum(o in far: o.x - x) - q*v + 0.5*t
"""


# Near in a plane, and linked; both move by a tenth of the reach in some steps.
SWARM = """model swarm "points that push those near them"
param q = 0.5
state x[2] = (0, 0)
state v[2] = (0, 0)
near close(x, 0.1)
links ties
step 0.0078125
push = sum(o in close: (0.1 - norm(o.x - x))*(x - o.x))
x' = v
v' = 40*push + sum(o in ties: o.x - x) - q*(x - (0.5, 0.5))
"""

TWO_SIZES = """model sizes "points that reach differently far"
param r = 0.1
state x[2] = (0, 0)
near close(x, r + o.r)
step 0.125
x' = sum(o in close: x - o.x)
"""


@pytest.fixture
def linked(root, build, tmp_path):
    def linked(scene, steps, config="world_memory", roam=()):
        (tmp_path / "web.ode").write_text(WEB, encoding="utf-8")
        (tmp_path / "swarm.ode").write_text(SWARM, encoding="utf-8")
        if isinstance(scene, str):
            (tmp_path / "it.scene").write_text(f"groups = ( {{ {scene} }} );\n", encoding="utf-8")
            scene = tmp_path / "it.scene"
        return subprocess.run([build / "bench/alone", "linked", config, scene, str(steps), "3000", "20", *map(str, roam)], capture_output=True, text=True, timeout=120)
    return linked


NET = """program = "web.ode"; integrator = "INTEGRATOR"; grid = { count = [24, 50]; };
         spread = { p = [0.5, 1.5]; q = [0.25, 0.75]; x = [-1.0, 1.0]; v = [0.5, -0.25]; };
         links = ( { relation = "ties"; grid = "structural"; }, { relation = "far"; grid = ["shear", "bending"]; } ); """


@pytest.mark.parametrize("config, integrator, steps", [
    ("world_memory", "semi_implicit_euler", 1), ("world_memory", "semi_implicit_euler", 3), ("world_memory", "heun", 2), ("world_overlap", "heun", 3)])
def test_chunks_have_the_words_of_fast(linked, config, integrator, steps):
    """One step, an odd number of them, and steps of two phases: bench/alone compares the words."""
    done = linked(NET.replace("INTEGRATOR", integrator), steps, config)
    assert done.returncode == 0, done.stderr
    row = json.loads(done.stdout)
    assert row["chunks"] > 1 and row["ghosts"] > 0 and row["host_accesses_between_steps"] == 0


STAR = """program = "web.ode"; objects = 1500; links = ( { relation = "ties"; file = "star.csv"; }, { relation = "far"; file = "star.csv"; } ); """
# No list alone is too long; the cut shows it, after all numbers of chunks have been tried.
STARS = """program = "web.ode"; integrator = "INTEGRATOR"; objects = 4800;
         links = ( { relation = "ties"; file = "near.csv"; }, { relation = "far"; file = "far.csv"; } ); """


@pytest.mark.parametrize("scene, said", [
    ("programs/world/balls.scene", "need a distance above 0"), ('program = "sizes.ode"; objects = 9;', "of one reach"), ("programs/world/stars.scene", "all others are more"), ("programs/world/breaking.scene", "remember"),
    (NET + "born = 2;", "come and go"), (STAR, "object 0 and the 1499 that it sees have no room in the 16384 words of configuration 'world_memory'"),
    (STARS, "object 0 and the 1200 that it sees have no room"), ('program = "one.ode"; objects = 9;', "see no others")])
def test_what_chunks_cannot_do_is_refused(linked, root, tmp_path, scene, said):
    for name, others in (("star", range(1, 1500)), ("near", range(1, 601)), ("far", range(601, 1201))):
        (tmp_path / f"{name}.csv").write_text("a,b\n" + "".join(f"0,{i}\n" for i in others), encoding="utf-8")
    (tmp_path / "sizes.ode").write_text(TWO_SIZES, encoding="utf-8")
    (tmp_path / "one.ode").write_text("state x = 1\nx' = -x\nstep 0.125\n", encoding="utf-8")
    done = linked(root / scene if scene.endswith(".scene") else scene.replace("INTEGRATOR", "semi_implicit_euler"), 1)
    assert done.returncode == 1 and said in done.stderr and not done.stdout, done.stderr


@pytest.mark.parametrize("config, steps, said", [("world", 1, "need `master` and `neighbours`"), ("world_memory", 0, "1 to 16777216 steps")])
def test_other_hardware_and_other_steps_are_refused(linked, config, steps, said):
    done = linked(NET.replace("INTEGRATOR", "semi_implicit_euler"), steps, config)
    assert done.returncode == 1 and said in done.stderr and not done.stdout, done.stderr


@pytest.mark.parametrize("objects, ties", [(1, ""), (2, "0,1\n"), (1100, "")])
@pytest.mark.parametrize("steps", [1, 3])
def test_few_links_or_none(linked, tmp_path, objects, ties, steps):
    (tmp_path / "ties.csv").write_text("a,b\n" + ties, encoding="utf-8")
    (tmp_path / "far.csv").write_text("a,b\n", encoding="utf-8")
    done = linked(f'program = "web.ode"; objects = {objects}; links = ( {{ relation = "ties"; file = "ties.csv"; }}, {{ relation = "far"; file = "far.csv"; }} );', steps)
    assert done.returncode == 0 and json.loads(done.stdout)["ghosts"] == 0, done.stderr


def test_memory_that_gives_no_word_is_refused(root, build):
    done = subprocess.run([build / "bench/alone", "linked", "world_memory", root / "bench/alone/cloth.scene", "1", "0", "20"], capture_output=True, text=True, timeout=20)
    assert done.returncode == 2 and "RATE: expected 1 or more" in done.stderr


# Chunks with ghosts; some points are alone, most move a quarter of the reach.
CROWD = """program = "swarm.ode"; integrator = "INTEGRATOR"; objects = OBJECTS;
         random = { position = "x"; from = [0.0, 0.0]; to = [SIDE, 1.0]; apart = 0.01; seed = 3; };
         spread = { v_x = [-0.5, 0.5]; v_y = [0.25, -0.25]; q = [0.1, 4.0]; };
         links = ( { relation = "ties"; file = "ties.csv"; } ); """


@pytest.mark.parametrize("config, integrator, objects, side, steps, roam, since", [
    ("world_memory", "semi_implicit_euler", 520, 2.4, 7, 0.05, 0), ("world_memory", "heun", 500, 3.0, 5, 0.05, 3), ("world_memory", "semi_implicit_euler", 1, 1.0, 2, 0.5, 0),
    ("world_overlap", "semi_implicit_euler", 520, 4.0, 7, 0.03, 0)])
def test_lists_of_near_objects_are_made_beyond_the_store(linked, tmp_path, config, integrator, objects, side, steps, roam, since):
    """bench/alone compares the words with those of engine fast: a pair that a list misses changes them."""
    (tmp_path / "ties.csv").write_text("a,b\n" + ("0,1\n5,400\n" if objects > 1 else ""), encoding="utf-8")
    done = linked(CROWD.replace("INTEGRATOR", integrator).replace("OBJECTS", str(objects)).replace("SIDE", str(side)), steps, config, (roam, since))
    assert done.returncode == 0, done.stderr
    row = json.loads(done.stdout)
    assert row["host_accesses_between_steps"] == 0 and (row["chunks"] > 1 and row["ghosts"] > 0) == (objects > 1)


def test_a_part_too_small_for_a_batch_is_not_used(linked, tmp_path):
    """These see so many that half of the store has no room for a full batch: the list is that of hardware without parts."""
    (tmp_path / "ties.csv").write_text("a,b\n", encoding="utf-8")
    scene = CROWD.replace("INTEGRATOR", "heun").replace("OBJECTS", "500").replace("SIDE", "1.0")
    rows = [json.loads(linked(scene, 2, config, (0.05,)).stdout) for config in ("world_memory", "world_overlap")]
    assert rows[0] == rows[1] | {"config": "world_memory"} and rows[0]["objects"] / rows[0]["chunks"] > 2 * 24


def test_an_object_that_goes_too_far_ends_the_list(linked, tmp_path):
    (tmp_path / "ties.csv").write_text("a,b\n", encoding="utf-8")
    done = linked(CROWD.replace("INTEGRATOR", "semi_implicit_euler").replace("OBJECTS", "60").replace("SIDE", "1.0"), 12, roam=(0.03,))
    assert done.returncode == 1 and "has gone farther than 0.03:" in done.stderr and not done.stdout


# All come together in one place.
CROWDED = """model crowd "points that fall into the middle"
state x = 0
state n = 0
near close(x, 0.1)
step 0.0078125
x' = -20*x
n' = sum(o in close: 1)
"""


def test_a_list_without_room_ends_the_list(linked, tmp_path):
    (tmp_path / "crowd.ode").write_text(CROWDED, encoding="utf-8")
    done = linked('program = "crowd.ode"; integrator = "euler"; objects = 60; spread = { x = [-1.0, 1.0]; };', 30, roam=(1.5,))
    assert done.returncode == 1 and "a list of near objects has no room" in done.stderr and not done.stdout, done.stderr


# Points in a row; those with `lost` are nowhere for some steps. In the middle of the run others jump, so lists are made while some have no position.
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
project x = y + (WHEN ? GONE : 0) + (t > 0.03 ? kick : 0)
"""
NOWHERE = """program = "lost.ode"; integrator = "euler"; objects = 100; spread = { x = [0.0, 3.0]; y = [0.0, 3.0]; };
           only = ( { objects = "10..40"; set = { lost = 1e30; }; }, { objects = "60..62"; set = { kick = 0.03; }; } );"""
SHORT, LONG = "t < 0.03", "t < 0.03 ? 0 : t < 0.05"


@pytest.mark.parametrize("when, gone, roam, since, said", [
    (LONG, "q - q", 0.07, 0, ""), (LONG, "q - q", 1e30, 0, ""), (SHORT, "q - q", 0.07, 2, "gone farther"), (SHORT, "q - q", 1e30, 2, "gone farther"), (SHORT, "q", 0.07, 2, "gone farther"), (SHORT, "q", 1e30, 2, "gone farther")])
def test_an_object_that_comes_from_nowhere_has_moved(linked, tmp_path, when, gone, roam, since, said):
    """A NaN or infinite position is near nobody, so the lists made then do not have the object."""
    (tmp_path / "lost.ode").write_text(LOST.replace("WHEN", when).replace("GONE", gone), encoding="utf-8")
    done = linked(NOWHERE, 8, roam=(roam, since))
    assert done.returncode == (1 if said else 0) and said in done.stderr, done.stderr
