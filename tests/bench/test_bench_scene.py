"""fp3 bench SCENE: a step of a scene, by engine fast with one thread and with all, the same bits."""

import json
import os
import shutil
import subprocess

import pytest

LONG_WAY = """model runaway "leaves FP32"
state x = 1
step 1
x' = 1000*x
"""


@pytest.fixture
def bench(fp3, root):
    def bench(*arguments):
        return subprocess.run([fp3, "bench", *map(str, arguments)], cwd=root, capture_output=True, text=True, timeout=300, check=False)
    return bench


@pytest.mark.parametrize("scene, objects", [("world/chain", 34), ("world/balls", 300), ("mixed", 120)])
def test_rows(bench, tmp_path, scene, objects):
    done = bench(f"programs/{scene}.scene", "--steps", 12, "--quick", "--json", tmp_path / "speed.json")
    assert done.returncode == 0 and "engine isa: 0 words differ after " in done.stdout, done.stderr
    found = json.loads((tmp_path / "speed.json").read_text())
    assert (found["objects"], found["steps"]) == (objects, 12) and 1 <= found["isa"]["steps"] <= 12
    threads = [row["threads"] for row in found["rows"]]
    assert threads == [1, os.cpu_count()][:len(threads)] and len(threads) == min(2, os.cpu_count())
    for row in found["rows"]:
        ns = row["ns_per_object_step"]
        assert ns > 0 and row["words_differing"] == 0
        assert row["million_object_steps_per_second"] == pytest.approx(1e3 / ns)
        assert row["steps_in_a_frame"] == pytest.approx(1e9 / 60 / ns / objects)
        assert f"{row['engine']:<22}  {row['threads']:7}  {ns:14.4g}" in done.stdout


@pytest.mark.long
def test_more_objects_take_longer(bench, tmp_path, root):
    """What is timed is the scene: its steps are found, and four times the objects take between two and eight times as long."""
    shutil.copy(root / "programs/world/net.ode", tmp_path)
    took = {24: [], 48: []}
    for side in 2 * (24, 48):           # the better of two: the machine may be busy
        scene = (root / "programs/world/net.scene").read_text().replace("[128, 128]", f"[{side}, {side}]").replace('"0..127"', "[0, 1]")
        (tmp_path / "net.scene").write_text(scene)
        done = bench(tmp_path / "net.scene", "--quick", "--json", tmp_path / "speed.json")
        assert done.returncode == 0, done.stderr
        found = json.loads((tmp_path / "speed.json").read_text())
        assert found["objects"] == side * side and 64 <= found["steps"] <= 4096
        took[side].append(found["rows"][0]["ns_per_object_step"] * side * side)
    assert 2 < min(took[48]) / min(took[24]) < 8


@pytest.mark.parametrize("name, program, more", [
    ("runaway.ode", LONG_WAY, 'integrator = "euler"'),
    ("quiet.s", ".state x\n.const p inf\nstep:\n    mul x, p, p\n", "set = { x = 1.0; }")])      # raises no flag
def test_a_failure_is_told(bench, tmp_path, name, program, more):
    (tmp_path / name).write_text(program)
    (tmp_path / "it.scene").write_text(f'steps = 100; config = "many_full"; groups = ( {{ program = "{name}"; {more}; objects = 4; }} );\n')
    done = bench(tmp_path / "it.scene", "--quick")
    assert done.returncode == 3 and "an object failed in these steps" in done.stderr and "steps in 1/60 s" in done.stdout


def test_objects_that_are_not_there_make_no_step(bench, tmp_path, root):
    shutil.copy(root / "programs/oscillator.ode", tmp_path)
    text = 'steps = 64; config = "many_full"; groups = ( {{ program = "oscillator.ode"; integrator = "rk4"; objects = 64; born = {}; }} );\n'
    for born, code in ((1000, 2), (32, 0)):
        (tmp_path / "late.scene").write_text(text.format(born))
        done = bench(tmp_path / "late.scene", "--quick", "--steps", 64, "--json", tmp_path / "speed.json")
        assert done.returncode == code, done.stderr
        assert "no object makes a step in the first 64" in done.stderr or code == 0
    found = json.loads((tmp_path / "speed.json").read_text())["rows"][0]    # half the steps
    assert found["steps_in_a_frame"] == pytest.approx(2 * 1e9 / 60 / found["ns_per_object_step"] / 64)


@pytest.mark.parametrize("scene", ["dam", "heap"])
def test_a_scene_that_is_too_large_for_isa_is_not_compared(bench, root, scene):
    """dam has few enough objects, but its records are larger."""
    done = bench(root / f"programs/world/{scene}.scene", "--steps", 8)
    assert done.returncode == 0 and "engine isa: not compared, the scene is too large for isa" in done.stdout, done.stderr


@pytest.mark.parametrize("arguments, words", [
    (["programs/mixed.scene", "--csv", "x.csv"], "found --csv and 'programs/mixed.scene'"),
    (["programs/mixed.scene", "kepler"], "expected one scene, or models"),
    (["programs/mixed.scene", "programs/mixed.scene"], "expected one scene"),
    (["nonesuch.scene"], "nonesuch.scene: cannot open"),
    (["programs/comets.scene"], "programs/comets.scene:12: adaptive steps: expected a scene of fixed steps"),
    (["programs/mixed.scene", "--steps", "0"], "--steps"),
    (["--quick"], "found --quick, expected MODEL or SCENE"),
    (["kepler", "--steps", "5"], "found --steps and 'kepler': with MODEL there are")])
def test_what_is_refused(bench, arguments, words):
    done = bench(*arguments)
    assert done.returncode == 2 and words in done.stderr and not done.stdout


def test_a_scene_is_not_overwritten(bench, tmp_path, root):
    shutil.copy(root / "programs/mixed.scene", tmp_path / "mixed.scene")
    before = (tmp_path / "mixed.scene").read_bytes()
    done = bench(tmp_path / "mixed.scene", "--json", tmp_path / "mixed.scene")
    assert done.returncode == 2 and "would overwrite" in done.stderr and (tmp_path / "mixed.scene").read_bytes() == before
