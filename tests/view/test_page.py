"""The page in a browser: it plays, scrubs, turns and picks, wide and narrow, and no text of a file gets out of its place."""

import h5py
import numpy
import pytest

pytestmark = pytest.mark.xdist_group("browser")


@pytest.fixture
def shown(run, balls, page, tmp_path):
    run("view", balls, "--plane", "y=0", "--box", "0:1,0:2,0:1")
    page.open(tmp_path / "balls.html")
    return page


def differ(a, b):
    return (abs(a - b).max(axis=2) > 24).sum()


def colours(pixels):
    return len(numpy.unique(pixels.reshape(-1, 3), axis=0))


def test_it_plays_and_stops(shown):
    shown.script("document.getElementById('speed').value = 120")
    before = shown.scene()
    assert colours(before) > 500, "an empty picture"
    shown.of("play").click()
    assert shown.of("play").get_attribute("aria-label") == "Pause"
    shown.wait(lambda: shown.data("playing") == "false")
    assert shown.data("drawn") == "40" and "step 400 · snapshot 41 of 41 · 300 objects" in shown.text("facts")
    assert differ(before, shown.scene()) > 5000
    shown.of("play").click()
    shown.wait(lambda: int(shown.data("drawn")) not in (0, 40))
    shown.of("play").click()
    assert shown.data("playing") == "false"


def test_it_plays_in_real_time(shown):
    """As many seconds pass as the recording has. It is the first speed where that is 1 s to 2 min; others say what they are."""
    from selenium.webdriver.support.select import Select
    seconds = shown.script("return fp3.time(40) - fp3.time(0)")
    speed = Select(shown.of("speed"))
    texts = [option.text for option in speed.options]
    assert texts[0] == "real time" and f"10 / s ({shown.script('return fp3.number(arguments[0], 2)', 10 * seconds / 40)}\u00d7)" in texts
    assert (speed.first_selected_option.text == "real time") == (1 <= seconds <= 120)
    speed.select_by_visible_text("real time")
    shown.script("fp3.begun = performance.now(); document.getElementById('play').click()")
    shown.wait(lambda: shown.data("playing") == "false" or shown.data("drawn") == "40")
    passed = shown.script("return performance.now() - fp3.begun") / 1000
    assert seconds * 0.9 <= passed, (seconds, passed)


def test_it_scrubs(shown, balls, tmp_path):
    from selenium.webdriver import ActionChains
    scrub = shown.of("scrub")
    ActionChains(shown.driver).move_to_element(scrub).click().perform()
    shown.wait(lambda: shown.data("drawn") == "20")
    with h5py.File(tmp_path / balls) as file:
        assert float(shown.text("now").split()[2]) == pytest.approx(file["time"][20], rel=1e-5)
    assert "snapshot 21 of 41" in scrub.get_attribute("aria-valuetext")


def test_what_the_page_unpacks_is_the_recording(shown, balls, tmp_path):
    with h5py.File(tmp_path / balls) as file:
        for i, name in enumerate(shown.script("return fp3.about.columns.map(c => c.name)")):
            made = numpy.array(shown.script("const c = fp3.about.columns[arguments[0]]; return Array.from(c.codes, (x, at) => fp3.value(c, at))", i))
            bound = shown.script("return fp3.about.columns[arguments[0]].bound", i)
            assert abs(made - file[name][()].reshape(-1)).max() <= bound * (1 + 1e-9)


def test_exact_pages_are_exact(run, balls, page, tmp_path):
    run("view", balls, "--exact")
    page.open(tmp_path / "balls.html")
    with h5py.File(tmp_path / balls) as file:
        made = page.script("const c = fp3.about.columns.find(c => c.name === 'v_y'); return Array.from(new Uint32Array(c.codes.buffer))")
        assert made == file["v_y"][()].view(numpy.uint32).reshape(-1).tolist()
    assert colours(page.scene()) > 500


def front(page, object):
    """Where an object is in the picture."""
    seen = page.script("""const {axes, world, camera, about} = fp3, at = fp3.scene.snapshot * about.objects + arguments[0];
        const p = axes.map((c, k) => world.of(k, fp3.value(c, at))); return camera.see(p[0], p[1], p[2] || 0);""", object)
    return seen["x"], seen["y"]


def test_a_click_picks_and_plots(shown):
    nearest = shown.script("""const {axes, world, camera, about} = fp3; let best = 0, least = Infinity;
        for (let i = 0; i < about.objects; i++) {
          const p = axes.map((c, k) => world.of(k, fp3.value(c, i))), away = camera.see(...p).away;
          if (away < least) [best, least] = [i, away];
        } return best;""")
    shown.click(*front(shown, nearest))
    assert shown.data("picked") == str(nearest) and shown.text("picked") == f"Object {nearest}"
    shown.wait(lambda: shown.script("return document.querySelectorAll('#plots figure').length") == 6)
    names = shown.script("return [...document.querySelectorAll('#plots b')].map(b => b.textContent)")
    assert names == ["x_x [m]", "x_y [m]", "x_z [m]", "v_x [m/s]", "v_y [m/s]", "v_z [m/s]"]
    shown.wait(lambda: shown.script("return document.querySelector('#plots output').textContent"))  # once it is drawn
    said = shown.script("return document.querySelector('#plots output').textContent")
    value, sign, bound, unit = said.split()
    assert sign == "±" and unit == "m"
    truth = shown.script("return fp3.value(fp3.axes[0], arguments[0])", nearest)
    assert float(value) == pytest.approx(truth, rel=1e-5) and float(bound) > 0
    # The plot's curve: some pixels are not background. A click in its middle goes to the middle of time.
    plot = shown.driver.find_element("css selector", "#plots canvas")
    assert shown.script("const c = arguments[0]; return new Set(new Uint32Array(c.getContext('2d').getImageData(0, 0, c.width, c.height).data.buffer)).size", plot) > 3
    plot.click()
    shown.wait(lambda: shown.data("drawn") == "20")
    shown.key("\ue00c")  # escape
    assert shown.data("picked") == "-1" and not shown.of("panel").is_displayed()


def test_beside_all_objects_nothing_is_picked(shown):
    shown.click(0.02, 0.5)
    assert shown.data("picked") == "-1"


def test_the_mouse_turns_moves_and_zooms(shown):
    from selenium.webdriver import ActionChains
    from selenium.webdriver.common.actions.wheel_input import ScrollOrigin
    one = shown.scene()
    shown.drag(120, 40)
    two = shown.scene()
    assert differ(one, two) > 3000 and shown.data("picked") in (None, "-1"), "a drag is no click"
    ActionChains(shown.driver).scroll_from_origin(ScrollOrigin.from_element(shown.of("scene")), 0, -400).perform()
    three = shown.scene()
    assert differ(two, three) > 3000 and shown.script("return fp3.camera.near") > 1.3
    shown.of("reset").click()
    shown.script("document.activeElement.blur()")
    assert differ(one, shown.scene()) < 50


def test_two_fingers_zoom(shown):
    box = shown.of("scene").rect
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

    def touch(kind, *apart):
        shown.driver.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": kind, "touchPoints": [{"x": x + way * a, "y": y, "id": i} for a in apart for i, way in enumerate((-1, 1))]})
    touch("touchStart", 50)
    touch("touchMove", 75)
    touch("touchMove", 100)
    touch("touchEnd")
    assert shown.script("return fp3.camera.near") == pytest.approx(2, rel=0.1)
    assert shown.data("picked") in (None, "-1")


def test_keys(shown):
    shown.key("\ue014\ue014\ue014")  # right
    shown.wait(lambda: shown.data("drawn") == "3")
    shown.key("\ue012")
    shown.wait(lambda: shown.data("drawn") == "2")
    shown.key("\ue010")  # end
    shown.wait(lambda: shown.data("drawn") == "40")
    shown.key("nn")
    assert shown.data("picked") == "1"
    shown.key("p")
    assert shown.data("picked") == "0"
    old = shown.script("return document.documentElement.dataset.theme")
    shown.key("d")
    assert shown.script("return document.documentElement.dataset.theme") != old
    shown.key("?")
    assert shown.of("about-box").is_displayed() and "kept to" in shown.text("holds")
    shown.driver.switch_to.active_element.send_keys("\ue00c")
    assert not shown.of("about-box").is_displayed()


def test_keys_work_on_controls(shown):
    """But for the keys that a control needs itself."""
    shown.of("trails").click()
    shown.of("trails").send_keys("\ue014")
    shown.wait(lambda: shown.data("drawn") == "1")
    shown.of("scrub").send_keys("\ue014")
    shown.wait(lambda: shown.data("drawn") == "2")
    shown.of("trails").send_keys(" ")
    assert not shown.of("trails").is_selected() and shown.data("playing") != "true"


def test_colours_have_a_legend(shown):
    from selenium.webdriver.support.select import Select
    assert shown.text("field") == "|v| [m/s]"
    one = shown.scene()
    Select(shown.of("colour")).select_by_visible_text("x_y [m]")
    assert shown.text("field") == "x_y [m]" and float(shown.text("least")) < float(shown.text("most"))
    assert differ(one, shown.scene()) > 1000
    Select(shown.of("colour")).select_by_visible_text("one colour")
    assert not shown.of("legend").is_displayed()


def test_links_and_trails(run, root, page, tmp_path):
    run("run", "--scene", root / "programs/world/cloth.scene", "-n", "100", "--every", "10", "--output", "c.h5")
    run("view", "c.h5")
    page.open(tmp_path / "c.html")
    page.wait(lambda: page.script("return fp3.scene.pairs !== undefined"))
    page.key("\ue010")
    one = page.scene()
    page.of("links").click()
    page.script("document.activeElement.blur()")
    assert differ(one, page.scene()) > 1000
    run("run", root / "programs/kepler.ode", "-n", "300", "--every", "4", "--output", "k.h5")
    run("view", "k.h5")
    page.open(tmp_path / "k.html")
    assert page.script("return fp3.isFlat && fp3.scene.trails") and page.text("legend").startswith("|v|")
    one = page.scene()
    page.key("\ue010")
    page.wait(lambda: page.data("drawn") == "75")
    assert differ(one, page.scene()) > 500


def test_who_is_not_there_is_not_drawn(run, page, tmp_path):
    rows = [(k, i) for k in range(2) for i in range(4)]
    life = {(0, 0): 0, (0, 1): 1, (0, 2): 2, (0, 3): 1}
    text = "step,object,r_x [m],r_y [m],life\n"
    for k, i in rows:
        text += f"{k},{i},{'nan' if (k, i) == (0, 3) else i},{i},{life.get((k, i), 1)}\n"
    (tmp_path / "a.csv").write_text(text)
    run("view", "a.csv")
    page.open(tmp_path / "a.html")
    assert page.script("return [0, 1, 2, 3].map(i => fp3.scene.isShown(0, i))") == [False, True, False, False]
    page.click(*front(page, 0))
    assert page.data("picked") == "-1"
    page.click(*front(page, 1))
    assert page.data("picked") == "1"
    one = page.scene()
    page.key("\ue014")
    page.wait(lambda: page.data("drawn") == "1")
    assert differ(one, page.scene()) > 100


@pytest.mark.parametrize("width, height", [(1920, 1080), (768, 1024), (360, 740), (740, 360)])
def test_it_fits_the_screen(shown, width, height):
    shown.size(width, height)
    shown.script("fp3.redraw()")
    shown.key("n")
    shown.wait(lambda: shown.script("return document.getElementById('scene').width === document.getElementById('scene').clientWidth"))
    assert shown.script("return [document.documentElement.scrollWidth, innerWidth]") == [width, width]
    for name in ("play", "scrub", "colour", "help", "theme", "scene"):
        box = shown.script("const b = document.getElementById(arguments[0]).getBoundingClientRect(); return [b.left, b.top, b.right, b.bottom]", name)
        assert box[0] >= 0 and box[1] >= 0 and box[2] <= width and box[3] <= height and box[2] - box[0] >= 24, (name, box)
    assert shown.of("scene").rect["height"] >= 0.15 * height and colours(shown.scene()) > 100


def test_controls_have_names(shown):
    assert shown.script("""return [...document.querySelectorAll("button, input, select, canvas")].filter(e => !(e.getAttribute("aria-label") ||
        e.textContent.trim() && e.tagName === "BUTTON" || e.labels && e.labels[0] && e.labels[0].textContent.trim() || e.ariaHidden === "true")).map(e => e.outerHTML)""") == []


EVIL = "</script><script>document.title='evil'</script><!--<script>\"'&<img src=x onerror=document.title='evil'>"


def test_texts_stay_texts(run, balls, page, tmp_path):
    with h5py.File(tmp_path / balls, "a") as file:
        file.attrs["model"] = file.attrs["description"] = EVIL
        file["x_x"].attrs["units"] = file["v_x"].attrs["units"] = file["x_x"].attrs["description"] = EVIL
        file["evil<script>alert(1)</script>"] = file["x_x"][()]
    run("view", balls, "--position", "x_y,x_z")
    page.open(tmp_path / "balls.html")
    page.key("n")
    assert page.script("return document.title") == EVIL and page.text("title") == EVIL and page.text("doc") == EVIL
    assert page.script("return document.images.length") == 0
    (tmp_path / f"{EVIL.replace('/', '|')}.csv").write_text("step,object,r_x [m],r_y [m]\n0,0,1,2\n")
    run("view", f"{EVIL.replace('/', '|')}.csv", "-o", "e.html")
    page.open(tmp_path / "e.html")
    assert "evil" not in page.script("return document.title")[:4]


def test_it_loads_nothing(shown):
    assert shown.script("return performance.getEntriesByType('resource').map(e => e.name)") == []
    tried = shown.driver.execute_async_script("const done = arguments[0]; fetch('https://127.0.0.1:1/').then(() => done('loaded'), () => done('refused'))")
    assert tried == "refused" and "Content Security Policy" in shown.console()[0]


def test_a_page_that_is_cut_says_so(run, balls, page, tmp_path):
    run("view", balls)
    text = (tmp_path / "balls.html").read_text()
    cut = text[:text.index('<script type="text/plain" id="d1-0"')] + "<script>fp3.end()</script>"
    (tmp_path / "cut.html").write_text(cut)
    page.open(tmp_path / "cut.html", wait=False)
    page.wait(lambda: "not complete" in page.text("message"))


def test_one_object_one_snapshot(run, page, tmp_path):
    (tmp_path / "a.csv").write_text("step,object,r_x [m],r_y [m]\n0,0,1,2\n")
    run("view", "a.csv")
    page.open(tmp_path / "a.html")
    page.of("play").click()
    page.click(*front(page, 0))
    assert page.data("picked") == "0" and "step 0 · snapshot 1 of 1 · 1 object" in page.text("facts")


def inner(drawn):
    """What has neighbours on all sides: no lines."""
    return numpy.logical_and.reduce([numpy.roll(drawn, way, axis) for axis in (0, 1) for way in (-1, 0, 1)])


@pytest.fixture
def alike(run, page, tmp_path):
    """The page and fp3 view --png draw by themselves: the same balls in the same places and colours."""
    from PIL import Image

    def alike(name, *arguments):
        run("view", name, *arguments, "-o", "p.html")
        page.open(tmp_path / "p.html")
        page.script("document.documentElement.dataset.theme = 'light'; document.getElementById('legend').style.display = 'none'")
        page.key("x\ue010")
        page.wait(lambda: page.data("drawn") == str(page.script("return fp3.about.snapshots - 1")))
        page.script("document.activeElement.blur()")
        one = page.scene()
        run("view", name, *arguments, "--png", "p.png", "--width", str(one.shape[1]), "--height", str(one.shape[0]))
        two = numpy.asarray(Image.open(tmp_path / "p.png")).astype(int)
        drawn = [inner(abs(picture - numpy.array([238, 240, 244])).sum(axis=2) > 200) for picture in (one, two)]
        both = drawn[0] & drawn[1]
        assert drawn[0].sum() > 2000 and both.sum() > 0.95 * (drawn[0] | drawn[1]).sum()
        assert abs(one[both] - two[both]).mean() < 12
    return alike


def test_pictures_are_what_the_page_shows(balls, alike):
    alike(balls)
    alike(balls, "--exact")
    alike(balls, "--position", "x_z,x_y", "--size", "0.05")
    alike(balls, "--up", "z", "--box", "0:2,0:2,0:2")


@pytest.mark.parametrize("more", [[], ["--exact"]])
def test_a_value_that_never_changes_has_its_place(alike, tmp_path, more):
    """It has no steps to count, and may be far from the middle of what is seen."""
    (tmp_path / "a.csv").write_text("step,object,p_x [m],p_y [m],p_z [m]\n0,0,0.3,0.1,0.7\n0,1,0.5,0.1,0.7\n")
    alike("a.csv", "--box", "0:2,0:1,0:1", "--size", "0.1", *more)
