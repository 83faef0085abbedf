"""Scenes on 1, 2, 3, 4 and 8 ranks, on every engine: the same bits. Ranks share the processors of one machine here."""

import os
import pathlib
import re
import shutil
import subprocess
import time

import pytest

# Links; near, whose guests change; all others; a program of several phases; links again.
AROUND = {"cloth": (2, 3, 4, 8), "balls": (2, 3, 6), "stars": (2, 4), "dam": (3,), "rope": (2,)}


@pytest.mark.parametrize("name", AROUND)
def test_ranks_give_the_same_bits(hash_of, root, name):
    scene = root / f"programs/world/{name}.scene"
    one = hash_of(scene, 1, "fast", 20)
    assert len(one[0]) > 1000
    for ranks in AROUND[name]:
        assert hash_of(scene, ranks, "fast", 20) == one, ranks


def test_objects_that_wander_are_divided_anew(hash_of, root, tmp_path):
    """Two fast streams of balls mix: after some 1400 steps a rank needs five times the guests that it had at first, and all are divided anew."""
    scene = mixed(root, tmp_path, "near")
    scene.write_text(re.sub(r"v_x = (-?)1\.0", r"v_x = \g<1>5.0", (root / "programs/world/gas.scene").read_text()))
    assert hash_of(scene, 3, "fast", 1800) == hash_of(scene, 1, "fast", 1800)


def test_a_failure_on_one_rank_is_told_as_by_one_process(mpirun, fp3, root, tmp_path):
    """The run is made again on all ranks, or the one whose object failed would wait for the others."""
    (tmp_path / "balls.ode").write_text((root / "programs/world/balls.ode").read_text())
    text = (root / "programs/world/gas.scene").read_text()
    both = 'only = { objects = [7, 8]; set = { x_x = 0.5; x_y = 0.5; x_z = 0.5; }; };'
    (tmp_path / "gas.scene").write_text(re.sub("only .*", both, text))
    said = [mpirun(ranks, fp3, "run", "--scene", tmp_path / "gas.scene", "-e", "fast", "--steps", 1) for ranks in (1, 3)]
    assert [done.returncode for done in said] == [3, 3] and "object 7 in step 1: invalid" in said[0].stderr
    assert said[0].stderr.splitlines()[0] in said[1].stderr


# Links stand at rows, which change as others come near; and what pairs remember goes with them.
MIXED = {"more": [("near touch(x, 2*R)", "shared drag = 1e-4 [N*s/m]\nshared knot = 1 [N/m]\nshared pull = 0.01 [N]\nlinks rods(k = 1 [N/m], w = 1)\nnear touch(x, 2*R, n = 0)\nnear far(x, 5*R)"),
                  ("\nx' = v\nv' = g + (", "\nx' = v\nremember o in touch: o.n = o.n + 1\nremember o in rods: o.w = norm(o.x - x) < 9*R ? o.w : 0.5\n"
                                "K = sum(o in rods: o.w*o.k*(o.x - x)) - sum(o in far: drag*(v - o.v)) - sum(o in touch: o.n*knot*(o.x - x))\nv' = g + (K + ")]}
MIXED["all"] = [*MIXED["more"], ("links rods", "all others\nlinks rods"), ("K = ", "K = sum(o in others: pull*(o.x - x)/(R + norm(o.x - x))) + ")]


def mixed(root, folder, name):
    """Gas whose balls are in several relations."""
    model, text = ((root / f"programs/world/{file}").read_text() for file in ("balls.ode", "gas.scene"))
    for old, new in MIXED.get(name, []):
        assert old in model
        model = model.replace(old, new)
    (folder / "balls.ode").write_text(model)
    (folder / "rods.csv").write_text("a,b\n" + "".join(f"{i},{(7 * i + 3) % 240}\n" for i in range(0, 240, 2)))
    text = text.replace("objects = 300", "objects = 240").replace("integrator", 'links = { relation = "rods"; file = "rods.csv"; };\n        integrator', 1) if name in MIXED else text
    (folder / "gas.scene").write_text(text)
    return folder / "gas.scene"


@pytest.mark.parametrize("name", MIXED)
def test_several_relations_and_what_pairs_remember(hash_of, mpirun, fp3, root, tmp_path, name):
    scene, steps = mixed(root, tmp_path, name), 160 if name == "more" else 64  # engine isa takes long where each sees all
    one = hash_of(scene, 1, "fast", steps)
    assert all(hash_of(scene, *of, steps) == one for of in ((2, "fast"), (3, "isa")))
    done = mpirun(2, fp3, "run", "--scene", scene, "-e", "fast", "--steps", steps // 2 - 7, "--checkpoint", tmp_path / "x.ck")
    assert done.returncode == 0, done.stderr
    assert hash_of(scene, 3, "fast", steps, "--restart", tmp_path / "x.ck")[1] == one[1]


@pytest.mark.parametrize("name", ["near", "more"])
def test_runs_go_on_after_a_failure(mpirun, fp3, root, tmp_path, name):
    """Object 7 overflows after some 70 steps, in a state that nobody sees. The run is made again then, with the guests of those steps, and with what
    pairs remembered; the steps that come need those of now."""
    text = mixed(root, tmp_path, name).read_text()
    model = (tmp_path / "balls.ode").read_text().replace("near touch", "state e = 0\nnear touch") + "\ne' = 1e4*e\n"
    (tmp_path / "balls.ode").write_text(model)
    (tmp_path / "gas.scene").write_text(re.sub("only .*", "only = ( { objects = [7]; set = { e = 1.0; }; } );", text))
    left = []
    for ranks in (1, 3):
        out = tmp_path / f"{ranks}.csv"
        done = mpirun(ranks, fp3, "run", "--scene", tmp_path / "gas.scene", "-e", "fast", "--steps", 160, "--allow-failures", "--output", out)
        assert done.returncode == 0 and re.search("1 of (300|240), first object 7 in step ", done.stdout), done.stdout + done.stderr
        left.append((out.read_bytes(), re.search(r"failed +.*", done.stdout)[0]))
    assert left[0] == left[1]


def test_nobody_is_a_guest_for_objects_that_are_astray(hash_of, mpirun, fp3, tmp_path):
    """All but two of a grid overflow in the first step, along x, where ranks divide it: nobody is near the others then."""
    (tmp_path / "far.ode").write_text("shared R = 0.25\nstate x[3] = (0, 0, 0)\nstate v[3] = (0, 0, 0)\nnear touch(x, 2*R)\nstep 2\n"
                                      "F = sum(o in touch: o.x - x)\nx' = v\nv' = F\n")
    scene = tmp_path / "far.scene"
    scene.write_text('groups = ( { program = "far.ode"; integrator = "semi_implicit_euler"; set = { v_x = 3e38; };\n'
                     '  grid = { position = "x"; count = [16, 4, 4]; spacing = 1.0; }; only = { objects = [7, 8]; set = { v_x = 0.0; }; }; } );\n')
    assert hash_of(scene, 2, "fast", 9, "--allow-failures") == hash_of(scene, 1, "fast", 9, "--allow-failures")
    told = mpirun(2, fp3, "run", "--scene", scene, "-e", "fast", "--steps", 9, "--allow-failures").stdout
    assert "254 of 256, first object 0 in step 1" in told and told.count(" 0 guests; 0 bytes to other ranks") == 2, told


SMALL = """steps = 40;
groups = ( { program = "cloth.ode"; integrator = "semi_implicit_euler";
  grid = { position = "x"; along = "xz"; count = [12, 12]; spacing = 0.05; origin = [0.0, 2.0, 0.0]; };
  links = { relation = "springs"; grid = ["structural", "shear"]; rest = "rest"; };
  only = { objects = [0, 11]; set = { w = 0.0; }; }; } );
"""


@pytest.fixture
def small(root, tmp_path):
    (tmp_path / "cloth.ode").write_text((root / "programs/world/cloth.ode").read_text())
    (tmp_path / "small.scene").write_text(SMALL)
    return tmp_path / "small.scene"


def test_engines_give_the_same_bits_on_ranks(hash_of, small):
    """Two ranks of hardware are two chips, each with a part of the cloth."""
    one = hash_of(small, 1, "fast", 40)
    assert {len(one[0]) > 1000} == {True}
    for engine, ranks in (("isa", 1), ("isa", 3), ("rtl", 2), ("rtl", 4)):
        assert hash_of(small, ranks, engine, 40)[0] == one[0], (engine, ranks)


@pytest.mark.parametrize("name, engine", [("comets", "fast"), pytest.param("comets", "rtl", marks=pytest.mark.long), ("mixed", "fast"), ("fleet", "isa")])
def test_groups_that_see_nobody(mpirun, fp3, root, name, engine):
    """Objects that sleep, lifetimes, several programs, adaptive steps: what is printed is the same."""
    said = []
    for ranks in (1, 3):
        done = mpirun(ranks, fp3, "run", "--scene", root / f"programs/{name}.scene", "-e", engine, "--steps", 50, "--all")
        assert done.returncode == 0, done.stderr
        said.append([line for line in done.stdout.splitlines() if " 0x" in line])
    assert len(said[0]) > 3 and said[0] == said[1]


def test_rank_0_speaks_alone(mpirun, fp3, root):
    done = mpirun(3, fp3, "run", "--scene", root / "programs/world/cloth.scene", "-e", "fast", "--steps", 5)
    assert len(re.findall(r"^flags ", done.stdout, re.M)) == 1


def test_bad_input_is_told_once(mpirun, fp3, tmp_path):
    (tmp_path / "bad.scene").write_text("steps = 3;\ngroups = ( { program = 5; } );\n")
    done = mpirun(3, fp3, "run", "--scene", tmp_path / "bad.scene")
    assert done.returncode == 2 and done.stderr.count("bad.scene:1: expected config") == 1, done.stderr
    done = mpirun(3, fp3, "run", "--scene", tmp_path / "bad.scene", "--checkpoint-every", 0)
    assert done.returncode != 0 and done.stderr.count("--checkpoint-every") == 1, done.stderr


def test_bad_input_is_told_by_a_rank_0_that_comes_late(mpirun, fp3):
    """The others have found the error long before, and mpirun kills all ranks when one of them ends."""
    run = (fp3, "run", "--checkpoint-every", 0)
    done = mpirun(1, "sh", "-c", 'sleep 0.3; exec "$@"', "-", *run, ":", "-n", 2, *run)
    assert done.returncode != 0 and done.stderr.count("--checkpoint-every") == 1, done.stderr


def test_what_one_process_alone_can_do_is_refused(mpirun, fp3, root, tmp_path):
    done = mpirun(2, fp3, "run", "--scene", root / "programs/comets.scene", "-e", "rtl", "--bus-log", tmp_path / "log")
    assert done.returncode == 2 and "by one process, not by several" in done.stderr and not (tmp_path / "log").exists()


@pytest.mark.parametrize("integrator", ["verlet", "rk4"])
def test_words_of_other_ranks_come_between_phases_of_hardware(hash_of, small, integrator):
    small.write_text(SMALL.replace("semi_implicit_euler", integrator))
    assert hash_of(small, 2, "rtl", 3) == hash_of(small, 1, "fast", 3)


def test_processes_that_mpi_does_not_see_are_refused(mpirun, fp3, root, tmp_path):
    """As under the mpirun of another MPI: else each would run all objects and write the same file."""
    done = subprocess.run([fp3, "run", "--scene", root / "programs/world/cloth.scene", "-e", "fast", "--output", tmp_path / "x.csv"],
                          capture_output=True, text=True, timeout=60, env=os.environ | {"PMI_SIZE": "3"} | {"OMPI_MCA_btl": "self"})
    assert done.returncode == 1 and "3 processes were started, and MPI sees 1" in done.stderr and not (tmp_path / "x.csv").exists()


def test_births_where_objects_see_each_other_are_refused(mpirun, fp3, root, tmp_path):
    text = (root / "programs/world/stars.scene").read_text().replace('"stars', f'"{root}/programs/world/stars')
    (tmp_path / "x.scene").write_text(text.replace("integrator", "born = [0, 9]; integrator"))
    done = mpirun(2, fp3, "run", "--scene", tmp_path / "x.scene", "-e", "fast", "--steps", 4)
    assert done.returncode == 2 and "cannot be neighbours in several ranks" in done.stderr, done.stderr


def test_near_objects_of_two_positions_are_refused(mpirun, fp3, root, tmp_path):
    """Ranks divide the objects by one."""
    model = (root / "programs/world/balls.ode").read_text().replace("near touch", "shared fast = 1 [m/s]\nnear other(v, fast)\nnear touch") + "when any(o in other): v = 0.5*v\n"
    (tmp_path / "balls.ode").write_text(model)
    (tmp_path / "x.scene").write_text('steps = 2;\ngroups = ( { program = "balls.ode"; integrator = "euler"; '
                                      'grid = { position = "x"; along = "xz"; count = [6, 6]; spacing = 0.2; }; } );\n')
    one, two = (mpirun(ranks, fp3, "run", "--scene", tmp_path / "x.scene", "-e", "fast", "--allow-failures") for ranks in (1, 2))
    assert one.returncode == 0, one.stderr
    assert two.returncode == 2 and "several ranks: relations `near` of different positions" in two.stderr, two.stderr


LIVES = 'config = "many_full"; steps = 60; groups = ( { program = "kepler.ode"; objects = 24; born = [0, 0]; gone = [30, 76]; } );\n'


@pytest.mark.parametrize("wrong", ["spacing", "steps", "links", "config", "lives"])
def test_ranks_with_other_files_are_refused(mpirun, small, root, fp3, wrong):
    """A copy of the scene on another node that is not the same: rank 1 has one of its own here."""
    text = {"spacing": SMALL.replace("0.05", "0.06"), "steps": SMALL.replace("steps = 40", "steps = 41"), "links": SMALL.replace(', "shear"', ""),
            "config": 'config = "fabric";\n' + SMALL, "lives": LIVES}[wrong]
    if wrong == "lives":
        shutil.copy(root / "programs/kepler.ode", small.parent)
        small.write_text(text)
        text = text.replace("30, 76", "76, 30")  # runs are cut at the same steps
    (small.parent / "other.scene").write_text(text)
    out = small.parent / "x.csv"
    choose = 'S=$1; [ "${OMPI_COMM_WORLD_RANK:-$PMI_RANK}" = 1 ] && S=$2; exec "$0" run --scene $S -e fast --output $3'
    done = mpirun(3, "sh", "-c", choose, fp3, small, small.parent / "other.scene", out, timeout=40)
    assert done.returncode == 2 and "the ranks have different programs, scenes or options" in done.stderr, done.stdout + done.stderr
    assert not out.exists()


CHOOSE = 'if [ "${OMPI_COMM_WORLD_RANK:-$PMI_RANK}" = 1 ]; then exec $0 $2; else exec $0 $1; fi'


@pytest.mark.parametrize("one, other, told", [
    ("--checkpoint a.ck", "", "--checkpoint"), ("--output a.h5 --every 3", "--output a.h5 --every 5", "--every"),
    ("-n 9 --checkpoint a.ck --checkpoint-every 3", "--steps=8 --checkpoint a.ck --checkpoint-every 3", "--steps"),
    ("--all", "", "--all"), ("--output a.csv --observe x_x,x_y", "--output a.csv --observe x_x", "--observe")])
def test_ranks_with_other_options_are_refused(mpirun, small, fp3, one, other, told):
    """Each would wait for what the other never does."""
    run = f"run --scene {small} -e fast"
    done = mpirun(2, "sh", "-c", f"cd {small.parent}; {CHOOSE}", fp3, f"{run} {one}", f"{run} {other}", timeout=60)
    assert done.returncode == 2 and f"fp3 run: {told}: rank 1 and rank 0 do not have the same value of this option" in done.stderr, done.stdout + done.stderr
    assert sorted(path.name for path in small.parent.iterdir()) == ["cloth.ode", "small.scene"]


def test_where_ranks_cut_a_run_is_compared_before_they_run(mpirun, small, fp3):
    """Scenes of other lengths: up to the first checkpoint nothing differs. Threads may differ. What fp3 verify compares may not."""
    (small.parent / "other.scene").write_text(SMALL.replace("steps = 40", "steps = 50"))
    more = "-e fast --checkpoint a.ck --checkpoint-every 20"
    in_folder = f"cd {small.parent}; {CHOOSE}"
    done = mpirun(2, "sh", "-c", in_folder, fp3, f"run --scene small.scene {more}", f"run --scene other.scene {more}", timeout=40)
    assert done.returncode == 2 and "the ranks have different programs, scenes or options" in done.stderr and not (small.parent / "a.ck").exists()
    done = mpirun(2, "sh", "-c", in_folder, fp3, f"run --scene small.scene {more} --threads 1", f"run --scene ./small.scene {more}", timeout=40)
    assert done.returncode == 0 and "hash" in done.stdout, done.stderr
    for one, other, told in (("--from 20", "--from 10", "--from: rank 1"), ("a.ck.1", "a.ck", "different programs, scenes or options")):
        done = mpirun(2, "sh", "-c", in_folder, fp3, f"verify {one} {'' if 'ck' in one else 'a.ck'}", f"verify {other} {'' if 'ck' in other else 'a.ck'}", timeout=40)
        assert done.returncode == 2 and told in done.stderr and done.stdout == "", done.stderr


def test_a_rank_ends_with_its_mpirun(fp3, root, tmp_path):
    """Not only when MPI notices: here it reads a pipe whose writer never ends, before there is any MPI."""
    os.mkfifo(tmp_path / "pipe")
    start = subprocess.Popen(["sh", "-c", f"{fp3} run {root}/programs/kepler.ode --params pipe & echo $!; wait"], cwd=tmp_path, stdout=subprocess.PIPE, text=True,
                             env=os.environ | {"OMPI_COMM_WORLD_SIZE": "2", "OMPI_COMM_WORLD_RANK": "0"})
    rank = int(start.stdout.readline())

    def state():
        try:
            return pathlib.Path(f"/proc/{rank}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()[0]
        except OSError:
            return "Z"
    while state() != "S" or "fp3" not in pathlib.Path(f"/proc/{rank}/cmdline").read_text(encoding="ascii").split("\0")[0] \
            or not any(path.exists() and os.readlink(path).endswith("/pipe") for path in pathlib.Path(f"/proc/{rank}/fd").iterdir()):
        assert state() != "Z"
        time.sleep(0.01)
    with (tmp_path / "pipe").open("wb", buffering=0) as pipe:
        pipe.write(b"k")
        start.kill()
        start.wait()
        end = time.monotonic() + 30
        while state() != "Z":
            assert time.monotonic() < end, "the rank goes on"
            time.sleep(0.01)
