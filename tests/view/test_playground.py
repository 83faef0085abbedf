"""The playground: equations edited in a page run there, with the bits of the command."""

import hashlib
import re
import subprocess

import pytest


@pytest.fixture
def shown(root, page):
    """The page, with the result of its first run."""
    path = root / "build/playground/index.html"
    if not path.exists():
        pytest.skip("no build/playground/index.html: make setup-playground playground")
    if page.driver.current_url != path.as_uri():
        page.open(path, wait=False)
    else: # to load it again takes longer
        page.script("page.number = 0; delete document.body.dataset.done; of('engine').value = 'isa'; of('config').value = of('config').options[0].value; of('model').value = 'kepler'; choose()")
    done(page, 1)
    return page


def done(page, number=None):
    """Waits for the run that was asked for last."""
    page.wait(lambda: page.script("return !timer && page.number > 0 && document.body.dataset.done === String(page.number)") and
              (number is None or page.data("done") == str(number)), 60)


def change(page, **controls):
    """Sets controls by their names as a user does, and waits for the run."""
    before = page.script("return page.number")
    for name, value in controls.items():
        page.script("""const control = document.getElementById(arguments[0]); control.value = arguments[1];
            control.dispatchEvent(new Event(control.tagName === 'SELECT' ? 'change' : 'input'))""", name, value)
    page.wait(lambda: page.script("return page.number") > before)
    done(page)


def messages(page):
    return page.script("return [...document.querySelectorAll('#messages li')].map(item => item.textContent)")


def drawn(page, name):
    return page.script("return document.getElementById(arguments[0]).toDataURL()", name)


@pytest.fixture
def commands(fp3, tmp_path):
    """The hash of what the command records by the words that the page shows, as tools/everywhere.py has it."""
    def commands(page):
        program, *_ = words = page.text("command").split()[2:]
        (tmp_path / program).write_text(page.script("return document.getElementById('text').value"))
        ran = subprocess.run([fp3, "run", *words], cwd=tmp_path, capture_output=True, text=True, timeout=60)
        assert ran.returncode == 0, ran.stderr
        said = [line for line in (ran.stdout + ran.stderr).splitlines() if re.match(r"flags |.*failed|object \d+ ", line)]
        return hashlib.sha256((tmp_path / "out.csv").read_bytes() + "\n".join(said).encode()).hexdigest()[:16]
    return commands


def test_it_runs_at_once(shown, commands):
    assert shown.text("state") == "done" and messages(shown) == []
    assert re.fullmatch("[0-9a-f]{16}", shown.text("hash")) and shown.text("hash") == commands(shown)
    assert int(shown.text("cycles")) > 50 and "0x" in shown.text("said")
    assert drawn(shown, "time") != drawn(shown, "phase") and len(drawn(shown, "phase")) > 3000
    assert shown.script("return [of('across'), of('up')].map(s => s.selectedOptions[0].text)") == ["r_x", "r_y"]


@pytest.mark.parametrize("model, more", [
    ("kepler", {"arithmetic": "--compensated"}),
    ("lorenz", {"arithmetic": "--double-single", "steps": "300"}),
    ("ship", {"engine": "fast"}),
    ("van_der_pol_stiff", {"steps": "500"}),
    ("bouncing_ball", {"integrator": "rk8"}),
    ("van_der_pol", {"more": "--tolerance 1e-4 --objects 6 --spread mu=1:4 --times 0.5,1,2"})])
def test_the_hash_is_the_commands(shown, commands, model, more):
    change(shown, model=model)
    change(shown, **more)
    assert messages(shown) == [] and shown.text("state") == "done"
    assert shown.text("hash") == commands(shown)


def test_a_scene_has_the_hash_of_every_machine(shown, root):
    """That of the first row in docs/everywhere.md."""
    change(shown, steps="40", more="-N 40 --spread v_y=0.5:1.2 --every 20")
    row = re.search(r"^\| kepler \| `(\w+)`", (root / "docs/everywhere.md").read_text(), re.M)
    assert shown.text("hash")[:8] == row[1]


def test_an_edited_equation_changes_the_motion(shown):
    old, time, phase = shown.text("hash"), drawn(shown, "time"), drawn(shown, "phase")
    text = shown.script("return document.getElementById('text').value")
    edit = shown.of("text")
    shown.script("const t = of('text'), at = t.value.indexOf(\"v' = -mu*r\") + 5; t.focus(); t.setSelectionRange(at, at)")
    edit.send_keys("-0.1*v ")
    done(shown, 2)
    assert shown.script("return document.getElementById('text').value") == text.replace("v' = -mu*r", "v' = -0.1*v -mu*r")
    assert shown.text("hash") != old and drawn(shown, "time") != time and drawn(shown, "phase") != phase


def test_a_mistake_has_line_and_column(shown):
    old = drawn(shown, "time")
    text = shown.script("return document.getElementById('text').value")
    change(shown, text=text.replace("norm(r)^3", "nrm(r)^3"))
    line = text[:text.index("norm(r)^3")].count("\n") + 1
    assert messages(shown) == [f"line {line}, column 12error: found 'nrm', expected a function (did you mean 'norm'?)"]
    assert shown.script("return document.querySelector('#marks mark').textContent") == "nrm" and shown.of("text").get_attribute("aria-invalid") == "true"
    assert (shown.text("state"), shown.text("hash")) == ("not run", "–") and drawn(shown, "time") == old
    shown.driver.find_element("css selector", "#messages button").click()
    at = shown.script("return of('text').selectionStart")
    assert shown.script("return of('text').value")[at:].startswith("nrm(r)")
    change(shown, text=text)
    assert messages(shown) == [] and shown.text("state") == "done" and shown.script("return document.querySelector('#marks mark')") is None


def test_parameters_step_and_count(shown):
    old = shown.text("hash")
    shown.script("const i = document.querySelector('#params input'); i.value = '1.5'; i.dispatchEvent(new Event('input', {bubbles: true}))")
    done(shown, 2)
    assert "--set mu=1.5" in shown.text("command") and shown.text("hash") != old
    change(shown, h="0.03125")
    assert "--set h=0.03125 --steps 400" in shown.text("command")
    change(shown, steps="many")
    assert any("'many' is no number" in one for one in messages(shown)) and shown.text("state") == "not run"


def test_objects_that_fail_are_told(shown, root):
    change(shown, text=(root / "tests/everywhere/overflow.ode").read_text(), steps="400")
    assert shown.text("state") == "objects failed" and "failed" in shown.text("said")


def test_typing_ends_a_long_run(shown):
    shown.script("of('steps').value = '4000000000'; go()")
    assert shown.text("state") == "running"
    change(shown, steps="10")
    assert shown.text("state") == "done" and "--steps 10 " in shown.text("command")


def test_a_model_that_is_not_text_breaks_nothing(shown):
    change(shown, text="</script><script>document.title = 'evil'</script> \u2603 '' \"")
    assert messages(shown) and "evil" not in shown.script("return document.title")
    change(shown, text="")
    assert messages(shown)


@pytest.mark.parametrize("width, height", [(1920, 1080), (1024, 700), (390, 844)])
def test_playground_fits_the_screen(shown, width, height):
    shown.size(width, height)
    shown.script("draw()")
    assert shown.script("return [document.documentElement.scrollWidth, innerWidth]") == [width, width]
    for name in ("model", "text", "time", "phase", "hash", "more"):
        box = shown.script("const b = document.getElementById(arguments[0]).getBoundingClientRect(); return [b.left, b.right, b.width]", name)
        assert box[0] >= 0 and box[1] <= width and box[2] >= 24, (name, box)


def test_playground_loads_nothing_and_has_two_themes(shown):
    assert [name for name in shown.script("return performance.getEntriesByType('resource').map(e => e.name)") if not name.startswith("blob:")] == []
    light = shown.script("return getComputedStyle(document.body).backgroundColor")
    shown.of("theme").click()
    assert shown.script("return getComputedStyle(document.body).backgroundColor") != light
    assert shown.script("""return [...document.querySelectorAll("button, input, select, canvas, textarea")].filter(e => !(e.getAttribute("aria-label") ||
        e.textContent.trim() && e.tagName === "BUTTON" || e.labels && e.labels[0] && e.labels[0].textContent.trim())).map(e => e.outerHTML)""") == []
