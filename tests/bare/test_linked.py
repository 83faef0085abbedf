"""Objects that see each other by links, more than the store holds: one list of transfers on simulated hardware, or a refusal with its reason."""

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


@pytest.fixture
def linked(root, build, tmp_path):
    def linked(scene, steps, config="world_memory"):
        (tmp_path / "web.ode").write_text(WEB, encoding="utf-8")
        if isinstance(scene, str):
            (tmp_path / "it.scene").write_text(f"groups = ( {{ {scene} }} );\n", encoding="utf-8")
            scene = tmp_path / "it.scene"
        return subprocess.run([build / "bench/alone", "linked", config, scene, str(steps), "3000", "20"], capture_output=True, text=True, timeout=120)
    return linked


NET = """program = "web.ode"; integrator = "INTEGRATOR"; grid = { count = [24, 50]; };
         spread = { p = [0.5, 1.5]; q = [0.25, 0.75]; x = [-1.0, 1.0]; v = [0.5, -0.25]; };
         links = ( { relation = "ties"; grid = "structural"; }, { relation = "far"; grid = ["shear", "bending"]; } ); """


@pytest.mark.parametrize("integrator, steps", [("semi_implicit_euler", 1), ("semi_implicit_euler", 3), ("heun", 2)])
def test_chunks_have_the_words_of_fast(linked, integrator, steps):
    """One step, an odd number of them, and steps of two phases: bench/alone compares the words."""
    done = linked(NET.replace("INTEGRATOR", integrator), steps)
    assert done.returncode == 0, done.stderr
    row = json.loads(done.stdout)
    assert row["chunks"] > 1 and row["ghosts"] > 0 and row["host_accesses_between_steps"] == 0


STAR = """program = "web.ode"; objects = 1500; links = ( { relation = "ties"; file = "star.csv"; }, { relation = "far"; file = "star.csv"; } ); """
# No list alone is too long; the cut shows it, after all numbers of chunks have been tried.
STARS = """program = "web.ode"; integrator = "INTEGRATOR"; objects = 4800;
         links = ( { relation = "ties"; file = "near.csv"; }, { relation = "far"; file = "far.csv"; } ); """


@pytest.mark.parametrize("scene, said", [
    ("programs/world/balls.scene", "near objects change"), ("programs/world/stars.scene", "all others are more"), ("programs/world/breaking.scene", "remember"),
    (NET + "born = 2;", "come and go"), (STAR, "object 0 and the 1499 that it sees have no room in the 16384 words of configuration 'world_memory'"),
    (STARS, "object 0 and the 1200 that it sees have no room"), ('program = "one.ode"; objects = 9;', "see no others")])
def test_what_chunks_cannot_do_is_refused(linked, root, tmp_path, scene, said):
    for name, others in (("star", range(1, 1500)), ("near", range(1, 601)), ("far", range(601, 1201))):
        (tmp_path / f"{name}.csv").write_text("a,b\n" + "".join(f"0,{i}\n" for i in others), encoding="utf-8")
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
