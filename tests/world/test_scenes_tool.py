"""make scenes in its quick form: rows of each part, what is wrong with them is told, and pages are made of them."""

import copy
import json
import subprocess
import sys

import pytest

pytestmark = pytest.mark.xdist_group("scenes_tool")  # measured once


@pytest.fixture(scope="module")
def part(root, path_of_tools):
    import scenes
    return scenes.part_of


@pytest.fixture(scope="module")
def path_of_tools(root):
    sys.path.insert(0, str(root / "tools"))
    yield
    sys.path.remove(str(root / "tools"))


@pytest.fixture(scope="module")
def scenes(root, build, tmp_path_factory):
    path = tmp_path_factory.mktemp("scenes") / "scenes.json"

    def run(*options):
        done = subprocess.run([sys.executable, root / "tools/scenes.py", "--quick", "--fp3", build / "fp3", "--output", path, *options], capture_output=True, text=True, timeout=300)
        assert done.returncode == 0, done.stderr
        return json.loads(path.read_text(encoding="utf-8"))
    return run


@pytest.fixture(scope="module")
def measured(scenes):
    return scenes("--parts", "curves", "skipped")


def test_shorter_steps_have_smaller_errors(measured):
    own = {(row["scene"], row["method"], row["k"]): row for row in measured["curves"] if row["engine"] == "fp3"}
    assert {scene for scene, *_ in own} == {"cloth", "stars"}
    for (scene, method, k), row in own.items():
        assert 0 < row["error"] < 0.1 and 1 < row["ns_per_object_step"] < 1e5 and row["h"] == 2.0 ** -k
        longer = own.get((scene, method, k - 1))
        assert longer is None or longer["error"] / row["error"] == pytest.approx(2 if method == "semi_implicit_euler" else 4, rel=0.1)


def test_what_is_left_out_saves_something(measured):
    by = {(row["scene"], row["way"], row["what"]): row for row in measured["skipped"]}
    asleep = by["heap", "sleep", "all asleep (`rest`)"]
    assert asleep["cycles_per_object_step"] == 0 and asleep["share"] < 0.6 and asleep["error"] < 2e-2
    for scene in ("heap", "dam"):
        skins = [by[scene, "lists", f"lists, skin {skin}"] for skin in ("1", "0.3 (default)", "0.1")]
        assert all(row["words_differing"] == 0 for row in skins) and skins[0]["cycles_per_object_step"] > skins[1]["cycles_per_object_step"] > skins[2]["cycles_per_object_step"]
    assert by["heap", "lists", "lists, skin 1"]["share_of_cycles"] < 0.8
    still = by["balls", "kinds", "as a kind that does not move"]
    assert still["share_of_cycles"] < 0.6 and still["error"] < 1e-2
    assert by["cloth", "outputs", "no recording"]["words_differing"] == 0
    assert 0 < by["stars", "precision", "FP32"]["error"] < by["stars", "precision", "bfloat16 (`world_bfloat`)"]["error"]
    assert by["lorenz", "precision", "records of 16 bits (`many_half`)"]["error"] > 0


def test_the_rows_of_other_scenes_stay(measured, scenes):
    found = scenes("--parts", "curves", "--scenes", "stars")
    assert found["skipped"] == measured["skipped"]
    assert [row for row in found["curves"] if row["scene"] == "cloth"] == [row for row in measured["curves"] if row["scene"] == "cloth"]
    assert sorted(row["k"] for row in found["curves"] if row["scene"] == "stars" and row["engine"] == "fp3") == [4, 5]


def test_what_is_wrong_is_told(measured, part):
    curves, skipped = part("curves"), part("skipped")
    assert list(curves.wrong(measured["curves"])) == list(skipped.wrong(measured["skipped"])) == []
    row = next(row for row in measured["curves"] if (row["scene"], row["engine"], row["method"]) == ("cloth", "fp3", "semi_implicit_euler"))
    other = row | {"engine": "another", "error": 1.5 * row["error"]}
    assert list(curves.wrong([row, other])) == [f"cloth, another, semi_implicit_euler, 2^-{row['k']} s: an error of {other['error']:.3g}, and fp3 has {row['error']:.3g} by the same method"]
    shorter = row | {"k": row["k"] + 1}
    assert len(list(curves.wrong([row, shorter]))) == 1 and "expected half" in list(curves.wrong([row, shorter]))[0]
    assert list(curves.wrong([row | {"error": None}])) == ["cloth: fp3 never ends near the truth"]
    assert list(curves.wrong([row, {"scene": "cloth", "engine": "taichi", "method": "x", "k": 3, "failed": "it bursts"}])) == ["cloth, taichi, x, 2^-3 s: it bursts"]
    same = copy.deepcopy(next(row for row in measured["skipped"] if row["way"] == "lists" and not row["is_first"]))
    assert len(list(skipped.wrong([same | {"words_differing": 3}]))) == 1
    assert len(list(skipped.wrong([same | {"error": 0.1}]))) == len(list(skipped.wrong([same | {"error": float("nan")}]))) == 1


def test_pages_show_where_fp3_loses(measured, part):
    pytest.importorskip("matplotlib")
    rows = [row for row in measured["curves"] if row["scene"] == "cloth"]
    row = next(row for row in rows if row["engine"] == "fp3")
    better = row | {"engine": "taichi", "error": 1e-9, "ns_per_object_step": 0.1}
    worse = row | {"engine": "warp", "ns_per_object_step": 3 * row["ns_per_object_step"]}
    own = [row for row in rows if row["engine"] == "fp3"]
    made = part("curves").pages([*own, better, worse], measured["about"])
    page = "\n".join(made["scene_errors.md"])
    assert "Taichi, semi_implicit_euler beats FP3" in page and ", Warp 3." in page and "**1e-09**" in page
    assert "<svg" in made["scene_errors_cloth.svg"] and "Warp, semi_implicit_euler" in made["scene_errors_cloth.svg"]
    assert "No one beats FP3's best rows" in "\n".join(part("curves").pages([*own, worse], measured["about"])["scene_errors.md"])
    page = "\n".join(part("skipped").pages(measured["skipped"], measured["about"])["skipping.md"])
    assert "| the same bits |" in page and "all asleep" in page


def test_limits_of_scenes_hold(root, build, tmp_path, part):
    """Those that take no second; and a theory that is wrong, or a limit beyond which nothing grows, is told."""
    stress = part("stress")
    bench = stress.Bench(build / "fp3", tmp_path, True)
    rows = [row for check in (stress.dampers, stress.told, stress.wave, stress.drift, stress.held) for row in check(bench)]
    assert len(rows) > 10 and list(stress.wrong(rows)) == []
    page = "\n".join(stress.pages(rows, None)["stress.md"])
    assert f"measures {len(rows)} figures, of which {len(rows)} hold" in page and "h 2c/m beyond which" in page
    spoiled = [row | stress.row(row["scene"], row["what"], 1.01 * row["expected"], row["found"], row["within"], row["why"]) for row in rows if row["scene"] == "dampers"]
    assert len(list(stress.wrong(spoiled))) == 3 and "does not hold" in "\n".join(stress.pages(spoiled, None)["stress.md"])
    assert stress.limit(lambda h: h > 1.001, 1) == pytest.approx(1.001, abs=2e-3) and stress.limit(lambda h: False, 1) != stress.limit(lambda h: False, 1)
    assert stress.bounded("x", "y", stress.AT_LEAST, 2, 1, "")["holds"] is False and stress.bounded("x", "y", stress.AT_MOST, 2, 1, "")["holds"]


def test_choices_for_scenes_keep_their_tolerance(scenes, measured, part):
    """And one that does not, or a looser tolerance that costs more, is told."""
    tuned = part("tuned")
    rows = scenes("--parts", "tuned")["tuned"]
    assert [(row["scene"], row["tolerance"]) for row in rows] == [(scene, tolerance) for scene in ("chain", "planets") for tolerance in (1e-1, 1e-2)]
    assert list(tuned.wrong(rows)) == [] and all(row["met"] and row["error_held_out"] <= row["tolerance"] and row["held_out"] == 2 for row in rows)
    assert "4 of 4 choices keep their tolerance" in "\n".join(tuned.pages(rows, None)["tuning.md"])
    assert len(list(tuned.wrong([*rows[1:], rows[0] | {"met": False}]))) == 1
    assert list(tuned.wrong([rows[0] | {"cycles": 2 * rows[1]["cycles"]}, rows[1]]))[0].startswith("tuned: chain: a looser tolerance costs more")
    nothing = {"scene": "chain", "tolerance": 1e-3, "met": None, "steps": 32, "why": ""}
    assert list(tuned.wrong([nothing])) == [] and "for 1 of 1 rows nothing meets it" in "\n".join(tuned.pages([nothing], None)["tuning.md"])
