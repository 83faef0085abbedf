"""make site: every page, header and subcommand is in it, and no link of it leads nowhere."""

import html
import importlib.util
import re
import subprocess
import sys

import pytest

pytestmark = pytest.mark.xdist_group("site")


@pytest.fixture(scope="module")
def pages(root, build, tmp_path_factory):
    output = tmp_path_factory.mktemp("site")
    done = subprocess.run([sys.executable, root / "tools/site.py", "--fp3", build / "bin/fp3", "--output", output], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return output / "pages"


@pytest.fixture
def site(root, monkeypatch):
    monkeypatch.syspath_prepend(root / "tools")
    spec = importlib.util.spec_from_file_location("site_tool", root / "tools/site.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_all_pages_headers_and_subcommands_are_there(root, fp3, pages):
    there = {path.relative_to(pages).as_posix() for path in pages.rglob("*.md")}
    assert {path.relative_to(root / "docs").as_posix() for path in root.glob("docs/**/*.md")} <= there
    assert {f"api/{path.stem}.md" for path in root.glob("sw/include/fp3/*.h")} <= there
    commands = re.findall(r"^  (\w+)\t", subprocess.run([fp3, "--help"], capture_output=True, text=True, check=True).stdout, re.M)
    assert len(commands) > 10 and {f"man/{name}.md" for name in commands} <= there
    assert "--engine" in (pages / "man/run.md").read_text()


def test_every_function_of_a_header_has_a_heading(root, pages):
    for path in root.glob("sw/include/fp3/*.h"):
        text = re.sub(r"/\*.*?\*/|^#define.*?[^\\]$", "", path.read_text(), flags=re.S | re.M)
        functions = set(re.findall(r"^[\w ]+[ *](fp3_\w+)\(", text, re.M))
        page = (pages / f"api/{path.stem}.md").read_text()
        headed = set(re.findall(r"`(fp3_\w+)`", " ".join(re.findall(r"^##+ (.*)$", page, re.M))))
        assert all(name in headed or f"{name}(" in page for name in functions), (path.name, functions - headed)
        assert not functions or len(functions & headed) > 0.6 * len(functions), (path.name, functions - headed)


def test_the_navigation_goes_by_readers_and_has_every_page(site, root, pages):
    docs = sorted(root.glob("docs/**/*.md"))
    found = site.sorted_by_reader(docs)
    assert sorted(name for names in found.values() for name in names) == sorted(path.relative_to(root / "docs").as_posix()[:-3] for path in docs)
    assert found["games"][0].startswith("tutorials/") and found["FPGAs"][0] == "tutorials/fpga"
    index = (pages / "index.md").read_text()
    assert all(f":caption: {title}\n" in index for title in site.READERS.values())


def test_a_page_that_does_not_say_of_whom_it_is_is_an_error(site, monkeypatch, tmp_path):
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs/some.md").write_text("# Some\n\n*Guide, for nobody.*\n")
    monkeypatch.setattr(site, "ROOT", tmp_path)
    with pytest.raises(SystemExit, match=r"some.md: expected a line like \*Guide, for games"):
        site.sorted_by_reader([tmp_path / "docs/some.md"])


def test_a_folder_with_other_files_is_left_alone(site, build, tmp_path):
    (tmp_path / "mine.txt").write_text("x")
    with pytest.raises(SystemExit, match="no site of this tool"):
        site.make(str(build / "bin/fp3"), tmp_path, None)
    assert (tmp_path / "mine.txt").read_text() == "x"


def test_links_are_those_of_the_site(site, root):
    files = set()
    text = "[a](../README.md#try-it) [b](models.md) [c](../sw/include/fp3/batch.h) [d](../examples/drone.ode) `[e](x.md)` [`f`](isa.md#ld) late. `h` [g](https://x.y)"
    assert site.moved(text, root / "docs/command.md", files) == \
        "[a](index.md#try-it) [b](models.md) [c](api/batch.md) [d](files/examples/drone.ode) `[e](x.md)` [`f`](isa.md#ld) late. `h` [g](https://x.y)"
    assert [path.name for path in files] == ["drone.ode"]


def test_sphinx_finds_no_mistake(root, build, pages, tmp_path):
    sphinx = root / ".venv/bin/sphinx-build"
    if not sphinx.exists():
        pytest.skip("needs Sphinx: make setup-docs")
    done = subprocess.run([sphinx.parent / "python", "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html", pages, tmp_path / "html"], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    index = html.unescape((tmp_path / "html/index.html").read_text())
    assert "field-programmable physics" in index and (tmp_path / "html/search.html").exists()
