"""tools/judge.py, the judge of fp3 tune from outside: it reads models as the compiler does, finds choices good, and bad ones bad."""

import json
import subprocess
import sys

import pytest

np = pytest.importorskip("numpy")


@pytest.fixture
def judge(root, build, tmp_path):
    def judge(*arguments, fp3=build / "fp3"):
        done = subprocess.run([sys.executable, root / "tools/judge.py", "--fp3", fp3, "--truths", build / "tests/truths", "--objects", "8",
                               "--output", tmp_path / "judge.json", *map(str, arguments)], capture_output=True, text=True, timeout=300)
        return done, json.loads((tmp_path / "judge.json").read_text())["rows"]
    return judge


def test_the_reader_reads_all_models_as_the_compiler_does(root, fp3):
    """A step of explicit Euler is h times the slopes."""
    sys.path.insert(0, str(root / "tools"))
    from ode_reader import read
    paths = [*(root / "programs").glob("*.ode"), *(root / "tests/tune/judged").glob("*.ode")]
    assert len(paths) == 40
    for path in paths:
        out = subprocess.run([fp3, "run", path, "-i", "euler", "-c", "many_full", "-e", "isa", "-N", "1", "-n", "1", "--output", "-"], capture_output=True, text=True, check=True).stdout
        lines = [line.split(",") for line in out.splitlines() if line.count(",") > 2 or line[:1].isdigit()]
        before, after = (np.array([float(x) for x in line[3:]]) for line in lines[1:3])
        model, h = read(path), float(lines[2][1])
        with np.errstate(invalid="ignore"):
            moved = h * model.slopes(0.0, before[:, None], {name: np.float32(p).astype(float)[..., None] for name, p in model.params.items()})[:, 0]
        assert np.allclose(before, model.start(model.params, 1)[:, 0], rtol=1e-7), path.name
        assert np.all(np.abs(after - before - moved) <= 2e-6 * (np.abs(before) + np.abs(moved)) + 1e-12), (path.name, after - before, moved)


@pytest.mark.parametrize("model, how", [("selkov", "fixed"), *(pytest.param(*row, marks=pytest.mark.long) for row in (("dose", "cut"), ("robertson", "adaptive")))])
def test_a_choice_holds(judge, model, how):
    done, rows = judge("--models", model, "--tolerances", "1e-3")
    assert done.returncode == 0 and "1 of 1 rows hold" in done.stdout, done.stdout + done.stderr
    assert rows[0]["objects"] == 8 and rows[0]["within"] == 1 and 0 < rows[0]["worst"] <= 1e-3
    assert how == ("adaptive" if rows[0]["h"] is None else "cut" if rows[0]["cut"] else "fixed")


@pytest.mark.parametrize("model, worse", [("selkov", r"s/^h .*/h = 1.5;/; s/^steps .*/steps = 16;/"), pytest.param("robertson", r"s/tolerance = [^;]*;/tolerance = 0.3;/", marks=pytest.mark.long)])
def test_a_bad_choice_fails(judge, build, tmp_path, model, worse):
    """Of a tuner that writes another scene."""
    liar = tmp_path / "liar"
    liar.write_text(f'#!/bin/sh\n{build / "fp3"} "$@" || exit\n[ "$1" != tune ] || for file; do case $file in *.scene) sed -i "{worse}" "$file";; esac; done\n')
    liar.chmod(0o755)
    done, rows = judge("--models", model, "--tolerances", "1e-3", fp3=liar)
    assert done.returncode == 1 and "FAILS" in done.stdout and rows[0]["within"] < 0.95, done.stdout + done.stderr


def test_an_event_that_the_truth_has_just_after_the_end_may_be_just_before_it(root, tmp_path):
    """By tolerance * span at most: then the object is where the truth will be."""
    pytest.importorskip("scipy")
    sys.path.insert(0, str(root / "tools"))
    import judge
    (tmp_path / "saw.ode").write_text("state y = 1\ny' = -1\nwhen root(y) falling: y = 1\nstep 0.1\nspan 0.9996\n")
    model, tolerance, span = judge.read(tmp_path / "saw.ode"), 1e-3, 0.9996
    times, states, y0 = np.array([[0.5], [span]]), np.array([[[0.5]], [[0.9999]]]), np.ones((1, 1))

    def worst(beyond):
        truth, happened = judge.truth_of(tmp_path / "saw.ode", model, {}, model.names, {}, y0, times, np.ones(1), None, beyond)
        assert np.allclose(truth[:, 0, 0], [0.5, 1 - span])
        return judge.errors_of(states, y0, truth, happened, times, span, tolerance)[0]
    assert worst(tolerance * span) < tolerance and worst(2e-4) > 0.9
