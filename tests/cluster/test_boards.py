"""Four chips, one world: each rank drives a simulated board of its own over a serial line. And chips of several lanes, on the bus."""

import contextlib
import re
import subprocess

import pytest

from simulated_board import board

# Links; near; all others. Each is small: a byte takes 40 cycles on a simulated line.
SCENES = {
    "cloth": """grid = { position = "x"; along = "xz"; count = [6, 6]; spacing = 0.05; origin = [0.0, 2.0, 0.0]; };
                links = { relation = "springs"; grid = ["structural", "shear"]; rest = "rest"; }; integrator = "semi_implicit_euler";""",
    "balls": 'grid = { position = "x"; count = [4, 3, 1]; spacing = 0.099; origin = [0.1, 0.1, 0.1]; }; integrator = "semi_implicit_euler";',
    "heap": """objects = 45; random = { position = "x"; from = [0.05, 0.06, 0.05]; to = [0.5, 0.5, 0.35]; apart = 0.1; seed = 1; };
               program = "balls.ode"; integrator = "semi_implicit_euler";""",
    "stars": 'objects = 40; random = { position = "x"; from = [-1.0, -1.0, -1.0]; to = [1.0, 1.0, 1.0]; apart = 0.01; seed = 1; }; integrator = "euler";',
}
RANK = re.compile(r"^rank (\d+) +(\d+) objects, (\d+) guests; (?:(\d+) cycles; )?(\d+) bytes to other ranks(?:; (\d+) words on the bus)?"
                  r"(?:, (\d+) requests, (\d+) bytes on the line)?$", re.M)

FLAGS = re.compile(r"^flags .*", re.M)


@pytest.fixture
def run(mpirun, fp3, root, tmp_path):
    """The recording of a scene, byte for byte, what each rank did, and what was printed."""

    def made(name, ranks, engine, config, steps, *more):
        text = SCENES[name] if "program" in SCENES[name] else f'program = "{name}.ode"; {SCENES[name]}'
        (tmp_path / f"{name}.scene").write_text(f"steps = 1;\ngroups = ( {{ {text} }} );\n")
        for model in ("cloth", "balls", "stars"):
            (tmp_path / f"{model}.ode").write_text((root / f"programs/world/{model}.ode").read_text())
        out = tmp_path / f"{name}-{ranks}-{engine}-{config}.csv"
        done = mpirun(ranks, fp3, "run", "--scene", tmp_path / f"{name}.scene", "-e", engine, "-c", config, "--steps", steps, "--output", out, *more)
        assert done.returncode == 0, done.stdout + done.stderr
        return out.read_bytes(), [[int(word or 0) for word in row] for row in RANK.findall(done.stdout)], done.stdout

    return made


@contextlib.contextmanager
def boards(fp3, count, config):
    """Boards, and their ports as --port has them."""
    with contextlib.ExitStack() as stack:
        yield ",".join([stack.enter_context(board(fp3, "--config", config))[1] for _ in range(count)])


@pytest.mark.parametrize("name, steps", [("cloth", 2), pytest.param("balls", 2, marks=pytest.mark.long)])
def test_four_boards_are_one_world(run, fp3, name, steps):
    """The recording of one process, the cycles of four chips on the bus; guests came, and each line carried what the words need."""
    one, _, _ = run(name, 1, "fast", "world", steps)
    with boards(fp3, 4, "world") as ports:
        four, ranks, said = run(name, 4, "board", "world", steps, "--port", ports)
    assert four == one and len(one) > 1000
    _, chips, _ = run(name, 4, "rtl", "world", steps)
    assert [row[:5] for row in ranks] == [row[:5] for row in chips]
    assert len(ranks) == 4 and sum(row[1] for row in ranks) in (36, 12)
    assert int(re.search(r"^cycles +(\d+)$", said, re.M)[1]) == max(row[3] for row in ranks) > 0
    for _, _, guests, _, sent, words, requests, line in ranks:
        assert guests > 0 and sent > 0 and line > 4 * words + 2 * 6 * requests


@pytest.mark.parametrize("name, engine, config, ranks, steps", [
    ("cloth", "rtl", "fabric", 3, 8), ("heap", "rtl", "fabric", 3, 30), ("heap", "rtl", "world", 4, 60), ("stars", "rtl", "fabric", 3, 3),
    ("stars", "rtl", "world", 4, 3), ("heap", "fast", "world", 5, 60), ("heap", "rtl", "world_log", 4, 60), ("heap", "fast", "world_log", 5, 60)])
def test_chips_of_one_lane_and_of_several(run, name, engine, config, ranks, steps):
    """What objects read is of the own lane, of another lane or of another chip; balls find new neighbours on the way. The flags, too."""
    one, _, alone = run(name, 1, "fast", "world" if config == "fabric" else config, steps)
    many, rows, said = run(name, ranks, engine, config, steps)
    assert many == one and len(one) > 1000
    assert len(rows) == ranks and all(row[1] > 0 and row[2] > 0 for row in rows)
    assert FLAGS.findall(said) == FLAGS.findall(alone) != []


@pytest.mark.parametrize("engine", ["fast", "rtl"])
def test_objects_that_fail_on_one_rank(mpirun, fp3, root, tmp_path, engine):
    """All ranks make the run again to find out who, though only one has seen a flag."""
    (tmp_path / "cloth.ode").write_text((root / "programs/world/cloth.ode").read_text())
    (tmp_path / "x.scene").write_text(f"steps = 1;\ngroups = ( {{ program = \"cloth.ode\"; {SCENES['cloth']} only = {{ objects = 0; set = {{ w = 1e37; }}; }}; }} );\n")
    said = []
    for ranks in (1, 3):
        done = mpirun(ranks, fp3, "run", "--scene", tmp_path / "x.scene", "-e", engine, "-c", "world", "--steps", 2, timeout=40)
        assert done.returncode == 3, done.stderr
        said.append(re.findall(r"^failed .*", done.stdout, re.M) + FLAGS.findall(done.stdout))
    assert said[0] == said[1] and re.search("[1-9] of 36", said[0][0])


@pytest.mark.parametrize("ranks, ports, said", [
    (1, "A,B,C", "found 3 ports, expected one: each process has a board, and there is one process (mpirun -n 3 starts"),
    (3, "A,B", "found 2 ports, expected 3, with commas between them: one for each rank"),
    (2, "A", "found 1 port, expected 2"),
    (2, "A,", "found 'A,', expected a name before and behind each comma"),
])
def test_a_port_for_each_rank(mpirun, fp3, root, ranks, ports, said):
    done = mpirun(ranks, fp3, "run", "--scene", root / "programs/world/cloth.scene", "-e", "board", "--port", ports)
    assert done.returncode == 2 and done.stderr.count(said) == 1, done.stderr


def test_more_ranks_than_objects(mpirun, fp3, root, tmp_path):
    """Ranks decide together when guests are chosen again, and a rank without objects makes no step."""
    (tmp_path / "x.scene").write_text('steps = 1;\ngroups = ( { program = "balls.ode"; integrator = "semi_implicit_euler"; objects = 2; } );\n')
    (tmp_path / "balls.ode").write_text((root / "programs/world/balls.ode").read_text())
    done = mpirun(3, fp3, "run", "--scene", tmp_path / "x.scene", "-e", "fast", timeout=40)
    assert done.returncode == 2 and "each rank needs an object, and the scene has 2" in done.stderr, done.stderr


def test_the_boards_of_one_program_need_a_configuration(mpirun, fp3, root):
    done = mpirun(2, fp3, "run", root / "programs/lotka_volterra.ode", "-e", "board", "--port", "A,B")
    assert done.returncode == 2 and "--port: expected --config, too" in done.stderr, done.stderr


def test_one_board_of_another_configuration(mpirun, fp3, root):
    with boards(fp3, 1, "many") as first, boards(fp3, 1, "single") as second:
        done = mpirun(2, fp3, "run", root / "programs/lotka_volterra.ode", "-e", "board", "--port", f"{first},{second}", "-c", "many", "--objects", 4)
    assert done.returncode != 0 and "has configuration 'single', not 'many'" in done.stderr, done.stderr


def test_the_command_of_the_page(mpirun, mpi_environment, root, fp3, tmp_path):
    """tools/four.sh, with two boards, also as root; and where they leave something else than one process."""
    (tmp_path / "balls.scene").write_text(f"steps = 1;\ngroups = ( {{ program = \"balls.ode\"; {SCENES['balls']} }} );\n")
    (tmp_path / "balls.ode").write_text((root / "programs/world/balls.ode").read_text())
    four = lambda command: subprocess.run([root / "tools/four.sh", command, tmp_path / "balls.scene", "1", "2"], capture_output=True, text=True,
                                          timeout=100, env={key: value for key, value in mpi_environment.items() if "ROOT" not in key})
    done = four(fp3)
    assert done.returncode == 0 and done.stdout.endswith("2 boards leave, bit for bit, what one process leaves\n"), done.stdout + done.stderr
    assert len(RANK.findall(done.stdout)) == 2
    (tmp_path / "other").write_text(f"""#!/bin/sh
case "$*" in
*"engine board"*) exec {fp3} $(echo "$@" | sed "s/engine board --port [^ ]*/engine fast/") ;;
*"engine fast"*) exec {fp3} $(echo "$@" | sed "s/--steps 1/--steps 2/") ;;
*) exec {fp3} "$@" ;;
esac
""")
    (tmp_path / "other").chmod(0o755)
    done = four(tmp_path / "other")
    assert done.returncode == 1 and "differ" in done.stdout + done.stderr, done.stdout + done.stderr
