"""docs/drawings: each drawing is that of its source, says what isa/*.toml says, and stands on a page with words beside it."""

import re
import shutil
import subprocess
import sys

import pytest

DRAWINGS = "docs/drawings"
NEEDED = ["tools", "isa", "rtl", "sw", "programs", "docs"]
ALT = re.compile(r"!\[([^\]]*)\]\(drawings/([\w.]+)\)")


def draw(root, *line):
    return subprocess.run([sys.executable, "-B", root / "tools/draw.py", *line], capture_output=True, text=True, timeout=120)


@pytest.fixture
def copy(root, tmp_path):
    """What drawings need, to be changed: files that nobody changes are links."""
    for name in NEEDED:
        (tmp_path / name).symlink_to(root / name)
    for name in ("isa", "docs", "tools"):
        (tmp_path / name).unlink()
        shutil.copytree(root / name, tmp_path / name)
    return tmp_path


def change(path, before, after):
    text = path.read_text()
    assert before in text
    path.write_text(text.replace(before, after, 1))


def test_none_is_stale(root):
    done = draw(root, "--check")
    assert done.returncode == 0, done.stderr
    assert len(list((root / DRAWINGS).glob("*.svg"))) >= 15


@pytest.mark.parametrize("file, before, after, stale", [
    ("docs/drawings/solo.pikchr", "stalls by cause", "stalls", {"solo"}),
    ("isa/registers.toml", "at = 0x3100", "at = 0x3200", {"address_map"}),
    ("isa/configs.toml", "contexts = 24", "contexts = 28", {"time"}),
    ("docs/drawings/solo.svg", "scoreboard", "scorebord", {"solo"}),
])
def test_a_change_makes_drawings_stale(copy, file, before, after, stale):
    change(copy / file, before, after)
    done = draw(copy, "--root", copy, "--check")
    assert {name[:-1] for name in re.findall(r"\w+\.(?=\w+: stale)", done.stderr)} == stale
    assert done.returncode == bool(stale)


def test_a_drawing_without_a_source_is_found(copy):
    (copy / DRAWINGS / "left.svg").write_text("<svg/>")
    assert "left.svg: has no source" in draw(copy, "--root", copy, "--check").stderr


def test_a_name_that_is_not_there_ends_the_drawing(copy):
    for kind, name in (("module", "regfiles"), ("word", "vist"), ("op", "fma"), ("register", "step_s"), ("config", "many.lane"), ("nothing", "")):
        change(copy / DRAWINGS / "solo.pikchr", "//", f"// @{{{kind}.{name}}}")
        done = draw(copy, "--root", copy, "--check")
        assert done.returncode and f"@{{{kind}.{name}}}: there is nothing of this name" in done.stderr
        change(copy / DRAWINGS / "solo.pikchr", f"// @{{{kind}.{name}}}", "//")


def test_drawn_again_they_are_the_same(root, tmp_path):
    code = "import sys; sys.path.insert(0, 'tools'); import draw; sys.exit(any(draw.version(kind) != draw.TOOLS[kind][2] for kind in draw.TOOLS))"
    if subprocess.run([sys.executable, "-B", "-c", code], cwd=root, timeout=60).returncode:
        pytest.skip("the tools that draw are not here: make setup-docs")
    done = draw(root, "--again", tmp_path)
    assert done.returncode == 0, done.stderr
    for path in (root / DRAWINGS).glob("*.svg"):
        assert (tmp_path / path.name).read_bytes() == path.read_bytes(), path.name


def test_each_stands_on_a_page_with_what_it_shows(root):
    found = [alt for path in root.glob("docs/*.md") for alt in ALT.findall(path.read_text(encoding="utf-8"))]
    assert {name for _, name in found} == {path.name for path in (root / DRAWINGS).glob("*.svg")}
    assert [name for alt, name in found if len(alt) < 60] == []


def test_the_address_map_has_all_of_it(root):
    sys.path.insert(0, str(root / "tools"))
    from fp3gen.read import load
    source = (root / DRAWINGS / "address_map.pikchr").read_text()
    registers = load(root).registers
    for row in registers["window"] + registers["space"]:
        assert f"@{{name.{row['name']}}}" in source, row["name"]


def test_the_compiler_has_all_passes_that_are_on(root):
    source = (root / DRAWINGS / "compiler.dot").read_text()
    on = re.findall(r'^ *X\([A-Z_]+, "([\w-]+)", 0,', (root / "sw/include/fp3/compile.h").read_text(), re.M)
    assert len(on) >= 9
    for name in on:
        assert f"@{{pass.{name}}}" in source, name


def test_light_and_dark(root):
    """Every colour has two forms, and text is large enough."""
    for path in (root / DRAWINGS).glob("*.svg"):
        text = path.read_text()
        light, dark = re.search(r"<style>svg\{.*?\}(.*)@media\(prefers-color-scheme:dark\)\{(.*)\}", text).groups()
        names = [re.findall(r"([\w.-]+)\{", rules) for rules in (light, dark)]
        assert names[0] == names[1] and ".page" in names[0], path.name
        body = text[text.index("</style>"):]
        assert not re.search(r'(?:fill|stroke)="(?!none)|(?:fill|stroke):', body), path.name
        assert all(float(size) >= 12 for size in re.findall(r'font-size[:="]+([\d.]+)', body)), path.name
