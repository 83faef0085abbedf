"""What make world says of physics: it holds, and does not where a scene is another one than theory takes it for."""

import pathlib
import sys

import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
import world  # noqa: E402
from fp3world import physics  # noqa: E402
from fp3world import scene as world_scene  # noqa: E402

CHECKS = {check.__name__: check for check in world.CHECKS}
# Something else than what is compared with: what is replaced in the scene, by what.
BROKEN = {
    "chain": ('grid = "structural";', 'grid = "structural"; set = { k = 100.1; };'),
    "membrane": ("k = 60.0", "k = 60.1"),
    "cloth": ("only    = {", "set = { air = 0.0011; }; only = {"),
    "net": ("k = 6.0;", "k = 12.0;"),
    "rope": ("rest = 0.06", "rest = 0.0601"),
    "bridge": ("k = 100000.0", "k = 98000.0"),
    "planets": ("points  = ", "set = { G = 39.4; }; points  = "),
    "eight": ("0.00137281119", "0.001373"),
    "plummer": ('"leapfrog"', '"euler"'),
    "free": ("set     = { m = 0.00333;", "spread = { m = [0.001, 0.005]; }; set = {"),
    "pair": ("g_y = 0.0;", "g_y = 0.0; m = 0.011;"),
    "gas": ("damp = 0.0;", "damp = 0.02;"),
    "dam": ("count = [20, 40]", "count = [20, 34]"),
    "balls": ("objects = 300;", "objects = 300; set = { g_y = -9.8; };"),
    "players": ("v_x = 3.0;", "v_x = 3.0; k = 9100.0;"),
    "cradle": ("x = -0.16;", "x = -0.161;"),
    "slope": ("mu = 0.6;", "mu = 0.61;"),
    "belt": ("u = 2.0;", "u = 2.1;"),
    "glancing": ("mu = 0.3;", "mu = 0.31;"),
    "pyramid": ("[-0.05, 0.05]", "[-0.053, 0.053]"),
    "breaking": ("load = 120.0;", "load = 121.0;"),
    "plastic": ("far = 0.1;", "far = 0.101;"),
    "clocks": ("w = [0.0, 1.0];", "w = [0.0, 1.02];"),
    "neurons": ("v = 1.0;", "v = 1.01;"),
}


@pytest.fixture
def lab(build, tmp_path):
    return physics.Lab(build / "fp3", tmp_path, True)


@pytest.mark.parametrize("name", [name for name in CHECKS if name not in ("heap", "pile")])  # test_granular.py has the pile
def test_it_holds_and_can_fail(lab, monkeypatch, name):
    rows = list(CHECKS[name](lab))
    assert rows and all(row["holds"] for row in rows), [row for row in rows if not row["holds"]]
    assert all(set(row) == {"scene", "what", "expected", "found", "within", "why", "holds"} for row in rows)
    scene, text_of = {"free": "stars"}.get(name, name), world_scene.text_of
    assert text_of(scene).count(BROKEN[name][0]) == 1
    monkeypatch.setattr(world_scene, "text_of", lambda other: text_of(other).replace(*BROKEN[name]) if other == scene else text_of(other))
    assert not all(row["holds"] for row in CHECKS[name](lab))
