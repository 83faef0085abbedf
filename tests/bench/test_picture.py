"""README's picture: the model's own lines, drawn from what was measured; where luck counts for nothing."""

import importlib.util
import re
import subprocess
import sys

import pytest


@pytest.fixture(scope="module")
def picture(root):
    spec = importlib.util.spec_from_file_location("picture", root / "tools/picture.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_it_shows_the_equations_of_the_model(root, picture):
    """A model that has changed makes it stale, as other states of it would."""
    shown = re.sub(r"<[^>]*>", "", (root / "docs/picture.svg").read_text()).replace("&gt;", ">")
    lines = picture.equations()
    assert len(lines) == 6 and all(line in shown for line in lines)
    assert "docs/picture.svg" in (root / "README.md").read_text()


def test_it_is_what_is_drawn_from_its_figures(root, build, tmp_path):
    pytest.importorskip("matplotlib", reason="needs matplotlib: make setup-bench")
    done = subprocess.run([sys.executable, root / "tools/picture.py", "--fp3", build / "bin/fp3", "--output", tmp_path / "x.svg",
                           "--figures", root / "docs/picture.json"], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "x.svg").read_text() == (root / "docs/picture.svg").read_text()


def test_a_step_that_is_right_by_luck_counts_as_the_finer_ones(picture):
    def point(h, ns, error, **more):
        return {"engine": "fast", "threads": 1, "method": None, "integrator": "rk4", "arithmetic": "plain", "h": h, "tolerance": None,
                "ns_per_object": ns, "error_worst": error, **more}
    points = [point(1, 10, 1e-2), point(1 / 2, 20, 1e-6), point(1 / 4, 40, 1e-4), point(1 / 8, 80, 1e-7), point(1 / 16, 160, 5e-7),
              point(1, 5, 1e-9, threads=2), point(1, 5, 1e-9, engine="gsl"), point(1 / 2, 15, 1e-3, integrator="heun")]
    assert picture.frontier(points, "fast") == [[10, 1e-2], [15, 1e-3], [20, 1e-4], [80, 1e-7]]


def test_places_are_those_of_kepler(picture):
    """Pericentre, apocentre, and the end of the first quarter of the ellipse, where the anomaly is pi/2."""
    pi = 3.141592653589793
    for t, at in ((0, (0.5, 0)), (pi, (-1.5, 0)), (pi / 2 - 0.5, (-0.5, 0.75**0.5)), (2 * pi * 7, (0.5, 0))):
        assert picture.place(t) == pytest.approx(at, abs=1e-12)
