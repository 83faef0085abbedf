"""Figures of the pages: those that are exact are not out of date without a word, and pages say of each how it stands."""

import pathlib
import subprocess
import sys

import pytest

pytestmark = pytest.mark.xdist_group("evidence")        # what is read is read once

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
from fp3evidence import figures as fig  # noqa: E402
from fp3evidence import inputs, probes, told  # noqa: E402


@pytest.fixture(scope="module")
def figures():
    return fig.read()


@pytest.fixture(scope="module")
def states(figures, build):
    return fig.states(figures, build / "bin/fp3")


def test_exact_figures_are_fresh_or_say_why_not(figures, states):
    assert len(figures) > 50 and {figure.kind for figure in figures.values()} == set(fig.KINDS)
    assert list(fig.out_of_date(figures, states)) == []


def test_pages_say_how_their_figures_stand(figures, states):
    """Else: make evidence LINES=1."""
    for path, text in told.pages(figures, fig.records(), states).items():
        assert path.read_text(encoding="utf-8") == text, f"{path.name}: make evidence LINES=1"


def test_every_record_is_of_a_figure(figures):
    assert sorted(fig.records().keys() - figures.keys()) == []


# ---- what is seen ----

TEXT = """[inputs]
tools = ["tools/evidence.py"]
[[figure]]
name = "a.{name}"
each = ["x", "y"]
page = "docs/figures.md"
what = "of {name}"
kind = "exact"
command = "make {name}"
minutes = 1
inputs = ["tools", "docs/evidence.toml"]
"""


def recorded(**changes):
    now = inputs.now(fig.read(TEXT)["a.x"], "")
    return {"revision": "0123abc", "date": "2026-01-02", "machine": "a machine", "inputs": now | changes}


def test_a_figure_for_each_name():
    found = fig.read(TEXT)
    assert [(figure.name, figure.what, figure.command) for figure in found.values()] == [("a.x", "of x", "make x"), ("a.y", "of y", "make y")]
    assert found["a.x"].globs("tools") == ("tools/evidence.py",)


def test_an_input_that_changed_is_named():
    figure = fig.read(TEXT)["a.x"]
    now = recorded()["inputs"]
    assert fig.changed(figure, recorded(), now) == []
    assert fig.changed(figure, recorded(tools="another"), now) == ["tools"]
    assert fig.changed(figure, None, now) == [fig.UNKNOWN]
    assert fig.changed(figure, recorded(heyoka=None), now | {"heyoka": "1.0"}) == [], "who was not there then cannot have changed"
    assert fig.changed(figure, recorded(heyoka="0.9"), now | {"heyoka": None}) == [], "who is not here cannot be asked"
    assert fig.changed(figure, recorded(heyoka="0.9"), now | {"heyoka": "1.0"}) == ["heyoka"]


def test_what_is_out_of_date_is_told():
    found = fig.read(TEXT)
    assert [line.split(" ")[:2] for line in fig.out_of_date(found, {"a.x": ["tools"], "a.y": []})] == [["a.x", "is"]]
    old = fig.read(TEXT + 'old = "it takes a night"\n')
    assert [line.split(" ")[:2] for line in fig.out_of_date(old, {"a.x": ["tools"], "a.y": []})] == [["a.y", "is"]], "old must not outlive its cause"
    timed = fig.read(TEXT.replace("exact", "time"))
    assert list(fig.out_of_date(timed, {"a.x": ["tools"], "a.y": []})) == []


@pytest.mark.parametrize("wrong, said", [
    ('kind = "guess"', "kind 'guess', expected exact"), ('inputs = ["tooling"]', "input 'tooling', expected a name in [inputs]"),
    ('inputs = ["tools/*.none"]', "no file is 'tools/*.none'"), ("colour = 1", "unknown key 'colour'")])
def test_a_wrong_description_is_refused(wrong, said):
    key = wrong.partition(" ")[0]
    text = "".join(f"{wrong}\n" if line.startswith(f"{key} ") else line for line in TEXT.splitlines(True)) + (f"{wrong}\n" if key == "colour" else "")
    with pytest.raises(inputs.Wrong) as refused:
        inputs.now(fig.read(text)["a.x"], "")
    assert said in str(refused.value)


def test_a_page_says_it_of_its_tables():
    found, records = fig.read(TEXT), {"a.x": recorded(), "a.y": recorded()}
    page = "# T\n\n<!-- evidence a.x a.y -->\nwhatever\n<!-- evidence end -->\n\n| a |\n"
    text = told.lines(page, found, records, {"a.x": [], "a.y": ["tools"]})
    assert text == ("# T\n\n<!-- evidence a.x a.y -->\n"
                    "*Measured 2026-01-02 by `make x`, revision `0123abc`, on a machine. Its inputs have not changed since.*\n\n"
                    "*Measured 2026-01-02 by `make y`, revision `0123abc`, on a machine. Some of its inputs have changed since.*\n"
                    "<!-- evidence end -->\n\n| a |\n")
    assert told.lines(text, found, records, {"a.x": [], "a.y": ["tools"]}) == text


def test_comments_and_layout_change_no_hash_and_words_do():
    def same(name, a, b):
        return inputs.bare(name, a) == inputs.bare(name, b)
    assert same("a.c", "int f(void) {\n  return 1; /* one */\n}\n", "// f\nint f( void ) { return 1; }\n")
    assert same("a.v", "`define A 1 // one\nassign z = a;\n", "`define A 1\n  assign  z = a ;\n")
    assert same("a.py", "a = 1\n# one\n", "a = 1\n") and same("a.ode", "# x\nstate x\n", "state x\n")
    for name, a, b in (("a.c", "return 1;", "return 2;"), ("a.c", 's = "// a";', 's = "// b";'), ("a.v", "`define A 1\nb", "`define A\n1 b"),
                       ("a.c", "int ab;", "int a b;"),
                       ("a.py", "a = '#'\n", "a = '# '\n"), ("a.csv", "# 1\n", "# 2\n"), ("a.c", "#define A\nb;", "#define A b;")):
        assert not same(name, a, b), (name, a, b)
    assert inputs.of_texts([("a.c", "x"), ("b.c", "y")]) != inputs.of_texts([("a.c", "y"), ("b.c", "x")])


def test_a_probe_is_asked_again_when_the_command_is_another(tmp_path, monkeypatch):
    asked = []
    monkeypatch.setattr(probes, "KEPT", tmp_path / "kept/probes.json")
    monkeypatch.setitem(probes.PROBES, "p", (lambda fp3: asked.append(fp3) or ["said"], ()))
    fp3 = tmp_path / "fp3"
    assert probes.ask("p", fp3) is None
    fp3.write_text("1")
    assert probes.ask("p", fp3) == probes.ask("p", fp3) and len(asked) == 1
    fp3.write_text("2")
    assert probes.ask("p", fp3) and len(asked) == 2


def test_the_words_of_a_program_are_probed(fp3, tmp_path):
    """Another step size is another value, not another program; another equation is."""
    text = (ROOT / "programs/oscillator.ode").read_text(encoding="utf-8")
    images = []
    for number, changed in enumerate((text, text + "# a comment\n", text.replace("x' = v", "x' = v + v"))):
        model = tmp_path / str(number) / "oscillator.ode"
        model.parent.mkdir()
        model.write_text(changed, encoding="utf-8")
        images.append(probes.image(fp3, model))
    assert images[0] == images[1] != images[2] and probes.image(fp3, tmp_path / "none.ode") == b"refused"


def test_the_list_names_each_figure(fp3):
    def listed(*words):
        return subprocess.run([sys.executable, ROOT / "tools/evidence.py", "--list", "--fp3", fp3, "--only", *words], capture_output=True, text=True)
    done = listed("combinations", "bodies.hashes")
    assert done.returncode == 0 and [line.split()[0] for line in done.stdout.splitlines()[:-1]] == ["combinations", "bodies.hashes"]
    done = listed("worlds")
    assert done.returncode == 2 and "no figure 'worlds'" in done.stderr
