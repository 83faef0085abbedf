"""Figures of the pages: those that are exact are not out of date without a word, and pages say of each how it stands."""

import functools
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import time

import pytest

pytestmark = pytest.mark.xdist_group("evidence")        # what is read is read once

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
from fp3evidence import figures as fig  # noqa: E402
from fp3evidence import inputs, measure, probes, told  # noqa: E402
from fp3gen.read import load  # noqa: E402
import pages  # noqa: E402


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
    for path, text in told.pages(figures, fig.records(), fig.anywhere(figures, states)).items():
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
results = "log"
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
    assert fig.changed(figure, recorded(h="5.0 ab"), now | {"h": "5.0 cd"}) == ["h"]
    assert fig.changed(figure, recorded(h="5.0 ab"), now | {"h": "5.1 cd"}) == [], "another tool says it in other words"
    assert fig.changed(figure, recorded(h="ab"), now | {"h": "5.0 cd"}) == ["h"]
    peers = fig.read(TEXT + 'peers = ["heyoka"]\n')
    assert fig.anywhere(peers, {"a.x": ["tools", "heyoka"], "a.y": ["heyoka"]}) == {"a.x": ["tools"], "a.y": []}


def test_what_is_out_of_date_is_told():
    found = fig.read(TEXT)
    assert [line.split(" ")[:2] for line in fig.out_of_date(found, {"a.x": ["tools"], "a.y": []})] == [["a.x", "is"]]
    old = fig.read(TEXT + 'old = "it takes a night"\n')
    assert [line.split(" ")[:2] for line in fig.out_of_date(old, {"a.x": ["tools"], "a.y": []})] == [["a.y", "is"]], "old must not outlive its cause"
    timed = fig.read(TEXT.replace("exact", "time"))
    assert list(fig.out_of_date(timed, {"a.x": ["tools"], "a.y": []})) == []


def test_a_time_beside_other_work_is_old():
    exact, timed = fig.read(TEXT)["a.x"], fig.read(TEXT.replace("exact", "time"))["a.x"]
    known = recorded() | {"load": 1.5}
    assert fig.changed(timed, known, known["inputs"]) == [fig.BUSY] and fig.changed(exact, known, known["inputs"]) == []
    assert fig.changed(timed, known | {"load": 0.1}, known["inputs"]) == []
    assert told.line("make x", known, [fig.BUSY]).endswith("Its inputs have not changed since. Other work ran beside it.*")


def test_work_counts_until_it_is_known_to_be_ours():
    """A loop whose end nobody has waited for, and the same one after that."""
    def ours():
        found = resource.getrusage(resource.RUSAGE_CHILDREN)
        return found.ru_utime + found.ru_stime
    before = measure.busy() + ours()
    words = [sys.executable, "-c", "import time\nend = time.process_time() + 1\nwhile time.process_time() < end: pass"]
    mine = ours()
    with subprocess.Popen(words) as process:
        while measure.busy() + ours() < before + 0.5:
            time.sleep(0.01)
        assert ours() == mine
        process.wait()
    assert ours() > mine + 0.9 and measure.busy() + ours() > before + 0.9


def test_hardware_is_what_is_left_of_its_text(root, tmp_path, monkeypatch):
    """A comment, and a part that no configuration has, change nothing; a sum changes those that have it."""
    shutil.copytree(root / "rtl", tmp_path / "rtl")
    monkeypatch.setattr(probes, "described", functools.partial(load, root))
    monkeypatch.setattr(probes, "ROOT", tmp_path)

    def made():
        probes.made_of.cache_clear()
        try:
            return probes.hardware("single", "world")[0]("")
        finally:
            probes.made_of.cache_clear()

    lists, before = tmp_path / "rtl/lane/fp3_lists.v", made()
    text = lists.read_text()
    lists.write_text(text.replace("localparam LIST_W", "localparam NONE = 0; // none\n    reg q; always @(posedge clk_i) q <= rst_i;\n    localparam LIST_W")
                     .replace("sum_q   <= base_q +", "sum_q   <= (NONE ? {STORE_W{q}} : base_q) +"))
    assert "NONE ?" in lists.read_text() and made() == before
    lists.write_text(text.replace("sum_q   <= base_q +", "sum_q   <= base_q -"))
    after = made()
    assert [one.split()[0] for one, other in zip(after, before) if one != other] == ["world"]


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


def test_sections_stay_whose_figures_were_not_measured():
    def page(*parts):
        marks = {of: f"<!-- evidence {of} -->\n<!-- evidence end -->\n\n" if of else "" for _, of, _ in parts}
        return "# T\n\n" + "\n\n".join(f"## {head}\n\n{marks[of]}{text}" for head, of, text in parts) + "\n"
    old = page(("A", "a", "1"), ("More", "", "2"), ("B", "b", "3"), ("Gone", "", "4"), ("C", "c", "5"))
    new = page(("B", "b", "6"), ("New", "", "7"))
    assert pages.joined(new, old, ".md") == page(("A", "a", "1"), ("More", "", "2"), ("B", "b", "6"), ("C", "c", "5"), ("New", "", "7"))
    assert pages.joined(old, old, ".md") == old and pages.joined(new, "# T\n", ".md") == new
    old = "<nav><a href='#x'>x</a></nav>\n<h2 id='x'>x</h2>\n<svg>1</svg>\n<h2 id='z'>z</h2>\n<svg>2</svg></html>\n"
    new = "<nav><a href='#z'>z</a></nav>\n<h2 id='z'>z</h2>\n<svg>3</svg></html>\n"
    assert pages.joined(new, old, ".html") == ("<nav><a href='#x'>x</a><a href='#z'>z</a></nav>\n<h2 id='x'>x</h2>\n<svg>1</svg>\n<h2 id='z'>z</h2>\n"
                                               "<svg>3</svg></html>\n")


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


# ---- measuring ----

TREE = """[inputs]
sources = ["*.txt"]
[[figure]]
name = "a"
page = "docs/page.md"
what = "a"
kind = "exact"
command = "sh -c 'echo a >>log'"
results = "log"
report = "sh -c 'echo report >>log'"
minutes = 1
inputs = ["sources"]
[[figure]]
name = "b.times"
page = "docs/page.md"
what = "b"
kind = "time"
command = "sh -c 'test ! -e stop && echo b >>log'"
results = "log"
minutes = 2
inputs = ["one.*"]
"""


@pytest.fixture
def tree(tmp_path):
    """A project with two figures, whose measurements leave a line each, on a machine that has other work."""
    shutil.copytree(ROOT / "tools", tmp_path / "tools", ignore=shutil.ignore_patterns("__pycache__"))
    path = tmp_path / "tools/fp3evidence/figures.py"
    path.write_text(path.read_text(encoding="utf-8").replace("IDLE = 0.3 ", "IDLE = 999 "), encoding="utf-8")
    (tmp_path / "docs").mkdir()
    for name, text in {"one.txt": "1\n", "two.txt": "2\n", "docs/evidence.toml": TREE, ".gitignore": "tools/\nlog\nstop\n",
                       "docs/page.md": "# P\n\n<!-- evidence a b.times -->\n<!-- evidence end -->\n"}.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    commit(tmp_path, "init", "-q")
    return tmp_path


def commit(tree, *before):
    for words in ([before] if before else []) + [("add", "-A"), ("-c", "user.name=x", "-c", "user.email=x@x", "commit", "-qm", "x")]:
        subprocess.run(["git", *words], cwd=tree, check=True, capture_output=True)


def evidence(tree, *words):
    """Its exit code, what was measured, and what it said."""
    (tree / "log").unlink(missing_ok=True)
    done = subprocess.run([sys.executable, tree / "tools/evidence.py", *words], cwd=tree, capture_output=True, text=True)
    return done.returncode, (tree / "log").read_text().split() if (tree / "log").exists() else [], done.stdout + done.stderr


def test_what_is_old_is_measured_and_the_rest_is_left(tree):
    (tree / "stop").touch()
    code, log, said = evidence(tree)
    assert (code, log) == (1, ["a", "report"]) and "exit code 1" in said and "2 of 2: b.times, about 2 min" in said
    (tree / "stop").unlink()
    assert evidence(tree)[:2] == (0, ["b"]), "a run that failed goes on where it was"
    assert evidence(tree)[:2] == (0, []) and "0 of 2 figures are old" in evidence(tree, "--list")[2]
    page = (tree / "docs/page.md").read_text()
    assert page.count("Its inputs have not changed since.") == 2 and (tree / "docs/figures.md").read_text().count("| fresh |") == 2
    (tree / "two.txt").write_text("3\n")
    code, log, said = evidence(tree)
    assert (code, log) == (2, []) and "before these are committed: two.txt" in said
    commit(tree)
    said = evidence(tree, "--list")[2]
    assert "a        old    exact" in said and "sources (two.txt)" in said and "b.times  fresh" in said and "1 of 2 figures are old" in said
    assert evidence(tree, "--lines")[:2] == (0, []) and (tree / "docs/page.md").read_text().count("Some of its inputs have changed since.") == 1
    assert evidence(tree, "--kind", "time")[:2] == (0, []) and evidence(tree, "--only", "b")[:2] == (0, ["b"])
    assert evidence(tree)[:2] == (0, ["a", "report"])
    revision = subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=tree, capture_output=True, text=True, check=True).stdout.strip()
    assert (tree / "docs/page.md").read_text().count(f"revision `{revision}`") == 2


def test_what_changes_while_it_is_measured_is_not_recorded(tree):
    (tree / "docs/evidence.toml").write_text(TREE.replace("echo a >>log", "echo a >>log; echo 4 >two.txt"), encoding="utf-8")
    commit(tree)
    code, log, said = evidence(tree, "--only", "a")
    assert code == 1 and log[0] == "a" and "changed while it was measured" in said and not (tree / "docs/evidence.json").exists()


PAIRS = """[inputs]
sources = ["one.txt"]
""" + "".join(f"""[[figure]]
name = "{name}"
page = "docs/page.md"
what = "{name}"
kind = "{kind}"
command = "{command}"
results = "log"
minutes = {minutes}
inputs = ["sources"]
""" for name, kind, command, minutes in (
    ("first", "exact", "sh first.sh first second", 4), ("second", "error", "sh second.sh second first", 3), ("third", "exact", "sh first.sh third", 2),
    ("time", "time", "sh time.sh time", 1), ("of_time", "exact", "sh time.sh time", 1)))
# Leaves marks of its begin and end; with a second word it waits for the begin of that one.
STEP = """echo $1 begins >>log
for i in $(seq 100); do [ -z "$2" ] || grep -q "$2 begins" log && break; sleep 0.05; done
sleep 0.2
echo $1 ends >>log
"""


def test_two_at_a_time_but_times_alone_and_one_of_each_target(tree):
    (tree / "docs/evidence.toml").write_text(PAIRS, encoding="utf-8")
    (tree / "docs/page.md").write_text("# P\n\n" + "\n".join(f"<!-- evidence {name} -->\n<!-- evidence end -->\n" for name in
                                                            ("first", "second", "third", "time of_time")), encoding="utf-8")
    for name in ("first", "second", "time"):
        (tree / f"{name}.sh").write_text(STEP, encoding="utf-8")
    commit(tree)
    code, log, said = evidence(tree, "--kind", "exact", "--kind", "error")
    events = list(zip(log[::2], log[1::2]))
    at = {event: number for number, event in enumerate(events)}
    assert code == 0, said
    assert max(at["first", "begins"], at["second", "begins"]) < min(at["first", "ends"], at["second", "ends"]), "two at a time"
    assert at["third", "begins"] > at["first", "ends"], "of one target after each other"
    assert events[-2:] == [("time", "begins"), ("time", "ends")], "what has a time runs last, and alone"
    assert "of 4: time, of_time" in said and set(fig.json.loads((tree / "docs/evidence.json").read_text())) == {"first", "second", "third", "time", "of_time"}


def test_a_stop_ends_what_runs_and_the_rest_is_measured_later(tree):
    (tree / "docs/evidence.toml").write_text(TREE.replace("echo a >>log", "echo a >>log; sleep 60"), encoding="utf-8")
    commit(tree)
    process = subprocess.Popen([sys.executable, tree / "tools/evidence.py", "--only", "a"], cwd=tree, stderr=subprocess.PIPE, text=True)
    while not (tree / "log").exists():
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    said = process.communicate(timeout=30)[1]
    assert process.returncode == 1 and "stopped; what was measured is recorded" in said and not (tree / "docs/evidence.json").exists()
    (tree / "docs/evidence.toml").write_text(TREE, encoding="utf-8")
    commit(tree)
    assert evidence(tree)[:2] == (0, ["a", "report", "b"])


def test_a_missing_package_is_told(tree):
    (tree / "tools/bench.py").write_text("import no_such_package\n", encoding="utf-8")
    code, _, said = evidence(tree, "--list")
    assert code == 2 and "has no package 'no_such_package': make setup" in said and "Traceback" not in said


def test_what_takes_hours_is_measured_by_name_and_old_goes_out_when_it_is_fresh(tree):
    text = TREE.replace('minutes = 1\n', 'minutes = 1\nby_name = true\nold = "it takes hours"\n').replace('inputs = ["one.*"]\n', 'inputs = ["one.*"]\nafter = "a"\n')
    (tree / "docs/evidence.toml").write_text(text, encoding="utf-8")
    commit(tree)
    code, log, said = evidence(tree)
    assert (code, log) == (0, ["b"]) and "1 of 2 figures are old" in evidence(tree, "--list")[2] and "without a: ONLY=NAME" in evidence(tree, "--list")[2]
    assert (tree / "docs/evidence.toml").read_text() == text
    assert evidence(tree, "--only", "b.times", "a")[:2] == (0, ["a", "report", "b"]), "b.times is measured after a"
    assert (tree / "docs/evidence.toml").read_text() == text.replace('old = "it takes hours"\n', "")


def test_what_needs_another_waits_for_it():
    every = fig.read(PAIRS.replace('command = "sh second.sh second first"\n', 'command = "sh second.sh second first"\nafter = "first"\n'))
    first, second, third = (measure.Job([every[name]], {}) for name in ("first", "second", "third"))
    assert not measure.may_start(second, [], [first, second]) and not measure.may_start(second, [first], [second]) and measure.may_start(second, [third], [second])
    assert measure.may_start(first, [], [first, second]) and not measure.may_start(third, [first], [third])
