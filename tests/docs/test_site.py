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


def test_every_function_of_a_header_is_declared_once(root, pages):
    for path in root.glob("sw/include/fp3/*.h"):
        text = re.sub(r"/\*.*?\*/|^#define.*?[^\\]$|\{[^{}]*\}", "", path.read_text(), flags=re.S | re.M)
        functions = set(re.findall(r"^(?!typedef)[\w ]+[ *](fp3_\w+)\(", text, re.M))
        declared = re.findall(r"^`+\{c:function\} .*?(fp3_\w+)\(", (pages / f"api/{path.stem}.md").read_text(), re.M)
        assert len(set(declared)) == len(declared) and set(declared) == functions, (path.name, functions ^ set(declared))


def test_a_declaration_has_its_parameters_its_errors_and_its_members(site, tmp_path):
    (tmp_path / "x.h").write_text("""/* SPDX */
/* fp3/x.h - things that
 * matter. More. */
FP3_API_BEGIN

/* What to open. */
typedef struct {
    int size; /* of one; 0 (default): {0} */
    /* Where: both. */
    double *x, *y;
    /* The time. */
    double t;
} fp3_x;

/* Opens *x, see docs/models.md. size: 2 or more. FP3_E_ARGUMENT: size is 1; *x is NULL. The caller closes it with fp3_x_close. */
fp3_status fp3_x_open(int size,
                      fp3_x **x);
/* Frees it. */
void fp3_x_close(fp3_x **x);

FP3_API_END
""")
    pages = site.Pages([tmp_path / "x.h"])
    assert "\n".join(pages.page(tmp_path / "x.h")).strip() == """# fp3/x.h

Things that matter. More.




`````{c:struct} fp3_x
What to open.
````{c:member} int size
of one; 0 (default): {0}
````

Where: both.

````{c:member} double *x

````

````{c:member} double *y

````

````{c:member} double t
The time.
````

`````

`````{c:function} fp3_status fp3_x_open(int size, fp3_x **x)
Opens `*x`, see [models.md](../models.md). The caller closes it with {c:func}`fp3_x_close`.

:param size: 2 or more.
:retval FP3_E_ARGUMENT: size is 1; `*x` is NULL.
`````

`````{c:function} void fp3_x_close(fp3_x **x)
Frees it.
`````"""
    assert "| [fp3/x.h](x.md) | Things that matter |" in pages.index()
    assert pages.page_linked("`fp3_x_open()`, [`fp3_x`](y.md), `fp3_z`\n    `fp3_x`\n") == "{c:func}`fp3_x_open`, [`fp3_x`](y.md), `fp3_z`\n    `fp3_x`\n"


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
    tutorial = (tmp_path / "html/tutorials/game_loop.html").read_text()
    for language, part in (("ode", '<span class="kd">state</span>'), ("c", '<span class="cp">#include'), ("console", '<span class="gp">$ </span>')):
        assert re.search(f'<div class="highlight-{language} .*?{re.escape(part)}', tutorial, re.S), language
    assert 'href="../api/batch.html#c.fp3_batch"' in tutorial


def test_every_plot_and_drawing_has_colours_for_dark_pages(root, monkeypatch):
    monkeypatch.syspath_prepend(root / "tools")
    from plot import for_dark
    for path in root.glob("docs/**/*.svg"):
        assert path.read_text().count("@media(prefers-color-scheme:dark)") == 1, f"{path.name}: tools/plot.py {path}"
    drawn = for_dark('<svg x="1"><path style="fill: #ffffff; stroke: #0072b2"/><g color="black"/></svg>')
    assert '<svg x="1">\n<style>' in drawn and '[style*="fill: #ffffff"]' in drawn and '[color="black"]{color:#e6edf3!important}' in drawn
    assert "#0072b2\"]" not in drawn and for_dark(drawn) == drawn
