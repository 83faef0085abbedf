"""Objects that see each other on several lanes: a neighbour in another lane is a copy. The words of the isa engine, the cycles that were foreseen."""

import re
import subprocess

import pytest

CLOTH = """steps = 1;
groups = ( {{ program = "cloth.ode"; integrator = "semi_implicit_euler";
  grid = {{ position = "x"; along = "xz"; count = [{side}, {side}]; spacing = 0.05; }};
  links = ( {{ relation = "springs"; grid = ["structural", "shear"]; rest = "rest"; }},
            {{ relation = "springs"; grid = "bending"; rest = "rest"; set = {{ k = 10.0; }}; }} );
  only = {{ objects = [0, {last}]; set = {{ w = 0.0; }}; }}; }} );
"""


def ended(binary, *arguments, **environment):
    done = subprocess.run([binary, *map(str, arguments)], capture_output=True, text=True, timeout=1800, env=environment or None)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def figures(line):
    """objects, rows, copies, words, cycles, cycles of copies."""
    return [int(word) for word in re.fullmatch(r"objects (\d+), rows (\d+), copies (\d+), words (\d+), cycles (\d+), of copies (\d+)\n", line).groups()]


@pytest.fixture
def cloth(root, tmp_path):
    def cloth(side):
        (tmp_path / "cloth.ode").write_text((root / "programs/world/cloth.ode").read_text())
        (tmp_path / "cloth.scene").write_text(CLOTH.format(side=side, last=side - 1))
        return tmp_path / "cloth.scene"
    return cloth


def test_lists_by_chance_on_eight_lanes(build, long):
    for seed in range(1, 6 if long else 2):
        assert re.fullmatch(r"\d{3,} runs, 0 failed\n", ended(build / "tests/neighbours", seed, "fabric", 25 if long else 12))     # 25: what its store has room for


@pytest.mark.parametrize("name, steps", [("chain", 20), ("cloth", 3), ("planets", 10), ("balls", 10)])
def test_scenes_on_eight_lanes(root, build, cloth, name, steps):
    """Links, all others, those that are near; batches of all lanes, and several phases."""
    scene = cloth(10) if name == "cloth" else root / f"programs/world/{name}.scene"     # the store has no room for the 400 of cloth.scene
    objects, rows, copies, words, cycles, of_copies = figures(ended(build / "tests/lanes_scene", scene, "fabric", steps))
    assert rows == -(-objects // 8) and copies > 0 and words > 0 and 0 < of_copies < cycles


@pytest.mark.long
@pytest.mark.parametrize("lanes", [2, 5, 38])
def test_other_numbers_of_lanes(root, build, tmp_path, monkeypatch, cloth, lanes):
    """Two lanes, a group that is not full, and what fills a chip: built, and tested as the named ones are."""
    monkeypatch.syspath_prepend(root / "tools")
    from fp3fpga import one_config
    from fp3gen.read import load
    row = next(row for row in load(root).configs if row["name"] == "fabric") | {"name": "some", "lanes": lanes, "store_words": 16384}
    tree = tmp_path / "some"
    one_config.build(row, tree, build)
    sanitize = ["-fsanitize=address,undefined"] if build.name.endswith("-san") else []
    for name in ("neighbours", "lanes_scene"):
        one_config.run("gcc", *sanitize, "-o", tree / name, build / f"obj/tests/cosim/{name}.o", tree / "own.o", build / "lib/libfp3.a", *one_config.LIBS)
    assert re.fullmatch(r"\d{3,} runs, 0 failed\n", ended(tree / "neighbours", lanes, "some", FP3_RTL_DIR=str(tree)))
    for scene, steps in ((root / "programs/world/balls.scene", 3), (cloth(56 if lanes == 38 else 14), 2)):
        *_, copies, _, cycles, of_copies = figures(ended(tree / "lanes_scene", scene, "some", steps, FP3_RTL_DIR=str(tree)))
        assert of_copies < 0.3 * cycles and (copies or scene.name == "balls.scene")    # few balls touch at first


@pytest.mark.parametrize("lanes, most", [(2, 520), (8, 1900), (38, 5650)])
def test_a_large_cloth_is_cut_well(build, cloth, lanes, most):
    """16,384 masses: how many copies lanes need of each other's. A copy takes a cycle for each of six words, and 2 more go by between words."""
    *_, copies, words, cycles, of_copies = figures(ended(build / "tests/lanes_scene", cloth(128), "fabric", 1, lanes))
    assert 0 < copies <= most and words == 6 and of_copies < words * (copies + 2) + 32 < cycles
