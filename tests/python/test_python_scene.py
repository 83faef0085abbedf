"""fp3.Scene and the tables: what the command runs and measures."""

import csv
import re
import subprocess
import time

import numpy as np
import pytest

import fp3

SPRING = "param k = 40\nparam m = 0.5\nstate x = 0.1\nstate v = 0\nstep 0.0078125\nspan 1\nv' = -k*x/m\nx' = v\n"


@pytest.fixture
def printed(fp3):
    """Final states of all objects, as `fp3 run --scene` prints them: {(name, object): bits}."""
    def printed(*arguments):
        done = subprocess.run([fp3, "run", *map(str, arguments), "--all"], capture_output=True, text=True, timeout=300)
        assert done.returncode == 0, done.stderr
        return {(name, int(number)): int(bits, 16) for name, bits, number in re.findall(r"^(\w+) +\S+ +0x([0-9a-f]{8}) .*?object (\d+)", done.stdout, re.M)}
    return printed


@pytest.mark.parametrize("engine", ["fast", "isa"])
def test_a_scene_has_the_bits_of_the_command(root, printed, engine):
    path = root / "programs/mixed.scene"
    expected = printed("--scene", path, "-e", engine)
    with fp3.Scene(path, engine=engine) as scene:
        assert scene.objects == 120 and [len(group) for group in scene.groups] == [48, 72] and scene.steps == 64
        scene.run()
        seen = 0
        for group in scene.groups:
            for name in group.names:
                for i, word in enumerate(group[name].view(np.uint32)):
                    if (name, group.first + i) in expected:
                        assert expected[name, group.first + i] == word, (name, i)
                        seen += 1
    assert seen == 48 * 4 + 72 * 4


def test_parts_of_a_run_change_no_bit(root):
    whole, parts = (fp3.Scene(root / "programs/mixed.scene", engine="fast") for _ in range(2))
    whole.run(70)
    for steps in (1, 2, 67):
        parts.run(steps)
    assert np.array_equal(whole.groups[0]["r_x"], parts.groups[0]["r_x"])
    shares = []
    parts.run(200, progress=shares.append)
    assert shares[-1] == 1


def test_values_of_a_group(tmp_path):
    (tmp_path / "spring.ode").write_text(SPRING)
    (tmp_path / "s.scene").write_text('config = "many_full"; engine = "fast"; steps = 32;\ngroups = ({ program = "spring.ode"; objects = 3; spread = { x = [0.1, 0.3]; }; });\n')
    stiff, soft = fp3.Scene(tmp_path / "s.scene", values={0: {"k": 80}}), fp3.Scene(tmp_path / "s.scene")
    for scene in (stiff, soft):
        scene.run()
    expected = fp3.solve_ivp(tmp_path / "spring.ode", (0, 0.25), {"x": np.linspace(0.1, 0.3, 3)}, params={"k": 80})
    assert np.array_equal(stiff.groups[0]["x"], expected["x"][:, -1]) and not np.array_equal(stiff.groups[0]["x"], soft.groups[0]["x"])


def test_a_scene_with_chosen_steps_and_pairs(tmp_path):
    (tmp_path / "spring.ode").write_text(SPRING)
    (tmp_path / "s.scene").write_text('config = "many_full"; engine = "fast";\ngroups = ({ program = "spring.ode"; objects = 3; tolerance = 1e-5; until = 1.0; });\n')
    scene = fp3.Scene(tmp_path / "s.scene")
    scene.run()
    assert np.array_equal(scene.groups[0]["x"], fp3.solve_ivp(tmp_path / "spring.ode", (0, 1), objects=3, rtol=1e-5)["x"][:, -1])
    (tmp_path / "d.scene").write_text('config = "many_full"; engine = "fast"; steps = 8;\ngroups = ({ program = "spring.ode"; objects = 2; double_single = true; });\n')
    scene = fp3.Scene(tmp_path / "d.scene")
    scene.run()
    assert scene.groups[0]["x"].tolist() == fp3.solve_ivp(tmp_path / "spring.ode", (0, 0.0625), objects=2, arithmetic="double-single")["x"][:, -1].tolist()


def test_a_scene_that_chooses_its_steps_is_run_in_parts(tmp_path):
    """Objects that have made the attempts that were asked for go on in the next call; after the scene's own attempts they have failed."""
    (tmp_path / "spring.ode").write_text(SPRING)
    text = 'config = "many_full"; engine = "fast"; %sgroups = ({ program = "spring.ode"; objects = 3; tolerance = 1e-5; until = 1.0; });\n'
    (tmp_path / "s.scene").write_text(text % "")
    whole, parts, calls = fp3.Scene(tmp_path / "s.scene"), fp3.Scene(tmp_path / "s.scene"), 0
    whole.run()
    while (parts.groups[0]["t"] < 1).any():
        parts.run(3)
        assert parts.failure() is None
        calls += 1
    assert calls > 2 and parts.groups[0]["x"].tolist() == whole.groups[0]["x"].tolist()
    (tmp_path / "few.scene").write_text(text % "steps = 3; ")
    few = fp3.Scene(tmp_path / "few.scene")
    with pytest.raises(fp3.FailedError, match="3 objects failed, first object 0 at t = .* no attempt is left"):
        few.run()
    (tmp_path / "explodes.ode").write_text("state x = 1\nstep 0.125\nx' = 1e30*x*x\n")
    (tmp_path / "stuck.scene").write_text(text.replace("spring", "explodes") % "")
    with pytest.raises(fp3.FailedError):
        fp3.Scene(tmp_path / "stuck.scene").run(100000)


def test_what_a_scene_refuses(root, tmp_path):
    (tmp_path / "bad.scene").write_text('config = "many_full";\ngroups = ({ program = "none.ode"; objects = 3; });\n')
    with pytest.raises(fp3.Error) as said:
        fp3.Scene(tmp_path / "bad.scene")
    assert said.value.file and said.value.line == 2
    (tmp_path / "explodes.ode").write_text("state x = 1\nstep 0.125\nx' = 1e20*x*x\n")
    (tmp_path / "fails.scene").write_text('config = "many_full"; engine = "fast"; steps = 4;\ngroups = ({ program = "explodes.ode"; objects = 3; });\n')
    with pytest.raises(fp3.FailedError, match="3 objects failed, first object 0 in step 1: overflow"):
        fp3.Scene(tmp_path / "fails.scene").run()
    (tmp_path / "later.ode").write_text("param a = 1\nstate x = 1\nstep 0.125\nx' = a*x*x\n")
    (tmp_path / "later.scene").write_text('config = "many_full"; engine = "fast"; steps = 4000;\ngroups = ({ program = "later.ode"; objects = 3; spread = { a = [0.01, 0.03]; }; });\n')
    with pytest.raises(fp3.FailedError, match="3 objects failed, first object 2 in step"):
        fp3.Scene(tmp_path / "later.scene").run()  # one after the other, in several parts
    scene = fp3.Scene(root / "programs/mixed.scene", engine="fast")
    for misuse, told in ((lambda: scene.groups[0]["z"], "no 'z'"), (lambda: scene.run(-1), "steps"), (lambda: fp3.Scene(root / "programs/mixed.scene", engine="x"), "x"),
                         (lambda: fp3.Scene(root / "programs/mixed.scene", values={2: {}}), "values"), (lambda: fp3.Scene(root / "programs/mixed.scene", values={0: {"zz": 1}}), "zz")):
        with pytest.raises(fp3.Error, match=told):
            misuse()
    scene.close()
    with pytest.raises(fp3.ArgumentError, match="closed"):
        scene.run()
    with pytest.raises(fp3.ArgumentError, match="closed"):
        scene.groups[0]["r_x"]


# ---- tables ----


def test_the_tuner(tmp_path, root):
    tuning = fp3.tune(SPRING, 1e-3, ranges={"k": np.array([30, 50])}, params={"m": 0.4}, held_out=16)
    assert tuning.met and tuning.choice["error_held_out"] < 1e-3 and tuning.choice["held_out"] == 16 and len(tuning.rows) > 20
    assert {row["arithmetic"] for row in tuning.rows} >= {"plain", "folded"} and "tried" not in tuning.choice
    (tmp_path / "text.ode").write_text(SPRING)
    (tmp_path / "found.scene").write_text(tuning.scene.replace('program = "text"', 'program = "text.ode"'))
    scene = fp3.Scene(tmp_path / "found.scene", engine="fast")
    scene.run()
    assert np.isfinite(scene.groups[0]["x"]).all() and "Tuning(" in repr(tuning)
    with pytest.raises(fp3.FailedError, match="no truth"):
        fp3.tune(root / "programs/lorenz.ode", 1e-7, span=24)


def test_nothing_meets_a_tolerance(build, tmp_path, monkeypatch):
    """Exit code 3 with figures is no exception; a search for such a model takes long, so a command in its place says so."""
    (tmp_path / "bin").mkdir()
    (tmp_path / "lib").symlink_to(build / "lib")
    (tmp_path / "bin/fp3").write_text("""#!/bin/sh
for word; do case $word in --json=*) echo '{"model": "m", "met": false, "integrator": "heun", "arithmetic": "plain", "error": 0.1, "tried": [{"integrator": "heun"}]}' >"${word#--json=}";; esac; done
exit 3
""")
    (tmp_path / "bin/fp3").chmod(0o755)
    monkeypatch.setenv("FP3_HOME", str(tmp_path))
    nothing = fp3.tune(SPRING, 1e-7)
    assert not nothing.met and nothing.scene == "" and nothing.rows == [{"integrator": "heun"}] and "nothing meets" in repr(nothing)


def test_the_stress_suite():
    results = fp3.stress(SPRING, quick=True, integrators=["rk4"])
    assert len(results) > 3 and all(row["integrator"] == "rk4" for row in results) and set(results.column("holds")) <= {True, False}
    assert isinstance(results, list) and all(isinstance(row, dict) and list(row) == results.columns for row in results)
    assert results._repr_html_().count("<tr>") == len(results) + 1
    with pytest.raises(fp3.ArgumentError, match="no column 'nothing'"):
        results.column("nothing")


def test_the_benchmark(tmp_path):
    points = fp3.bench(SPRING, quick=True, integrators=["rk4"])
    assert len(points) > 20 and {"fast"} <= set(points.column("engine")) and min(n for n in points.column("ns_per_object") if n) > 0
    with (tmp_path / "points.csv").open("w") as file:
        writer = csv.DictWriter(file, points.columns)
        writer.writeheader()
        writer.writerows(points)


@pytest.mark.parametrize("call, kind, told", [
    (lambda: fp3.tune(SPRING, 2), "ArgumentError", "tolerance"), (lambda: fp3.tune(SPRING, 1e-3, ranges={"q": (1, 2)}), "ArgumentError", "q"),
    (lambda: fp3.tune(SPRING, 1e-3, ranges={"k": (1, 2, 3)}), "ArgumentError", "pair"),
    (lambda: fp3.tune(SPRING, 1e-3, ranges={"k": np.ones((2, 1))}), "ArgumentError", "pair"), (lambda: fp3.tune("state x = y\n", 1e-3), "ProgramError", "y"),
    (lambda: fp3.bench(), "ArgumentError", "model"), (lambda: fp3.bench(SPRING, integrators=["rk5"]), "ArgumentError", "rk5"), (lambda: fp3.stress(only="nothing"), "ArgumentError", "nothing")])
def test_what_the_tables_refuse(call, kind, told):
    with pytest.raises(getattr(fp3, kind), match=told):
        call()


def test_the_import_is_quick(python):
    """Without NumPy and the library, which come with the first part that is used. Processor time: that of other load does not count."""
    assert min(float(python("import time; begin = time.process_time(); import fp3; print(time.process_time() - begin)")) for _ in range(3)) < 0.1
    assert python("import fp3, sys; print('numpy' in sys.modules, 'ctypes' in sys.modules); fp3.solve_ivp; print('numpy' in sys.modules); print(fp3.__version__)").split() == \
        ["False", "False", "True", "0.1.0"]
    with pytest.raises(AttributeError):
        fp3.nothing


def test_a_loop_costs_little_more_than_its_steps(root):
    """Two columns in, a step, two columns out, of 10,000 objects: at most 0.2 ms a frame over the library's own step."""
    drones = fp3.Batch(root / "examples/drone.ode", 10_000)
    force, frames, steps = np.zeros(10_000, np.float32), [], []
    for _ in range(400):
        begin = time.perf_counter()
        drones["F_x"], drones["F_y"] = force, force
        drones.run()
        drones["x_x"], drones["x_y"]
        between = time.perf_counter()
        drones._lib.fp3_batch_run(drones._handle.pointer, 1)
        frames.append(between - begin)
        steps.append(time.perf_counter() - between)
    assert sorted(frames)[100] - sorted(steps)[100] < 0.2e-3
