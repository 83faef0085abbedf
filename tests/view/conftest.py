"""A page of fp3 view, and a browser without a display that looks at it."""

import io
import shutil
import subprocess
import time

import pytest

OPTIONS = ["--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
           "--force-device-scale-factor=1", "--hide-scrollbars", "--disable-dev-shm-usage", "--lang=en"]


class Page:
    """What a user does with a page, and what it shows."""

    def __init__(self, driver):
        self.driver = driver

    def open(self, path, wait=True):
        self.driver.get(path.as_uri())
        if wait:
            self.wait(lambda: self.data("drawn") is not None and self.data("loaded") == str(self.script("return fp3.about.snapshots")))

    def wait(self, is_so, seconds=60):
        end = time.monotonic() + seconds
        while not is_so():
            assert time.monotonic() < end, f"{seconds} s, and: {self.text('message')}; {self.console()}"
            time.sleep(0.02)

    def size(self, width, height):
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})

    def script(self, text, *arguments):
        return self.driver.execute_script(text, *arguments)

    def data(self, name):
        return self.script("return document.body.dataset[arguments[0]]", name)

    def of(self, name):
        return self.driver.find_element("id", name)

    def text(self, name):
        return self.script("return document.getElementById(arguments[0]).textContent", name)

    def key(self, keys):
        self.of("scene").send_keys(keys)

    def console(self):
        return [entry["message"] for entry in self.driver.get_log("browser")]

    def click(self, x, y):
        """A point of the picture, in parts of its size."""
        from selenium.webdriver import ActionChains
        canvas = self.of("scene")
        size = canvas.size
        ActionChains(self.driver).move_to_element_with_offset(canvas, round((x - 0.5) * size["width"]), round((y - 0.5) * size["height"])).click().perform()

    def drag(self, x, y, button="left"):
        from selenium.webdriver import ActionChains
        ActionChains(self.driver).move_to_element_with_offset(self.of("scene"), 0, 0).click_and_hold().move_by_offset(x, y).release().perform()

    def picture(self, path=None):
        """The page's pixels, rows of (red, green, blue)."""
        import numpy
        from PIL import Image
        png = self.driver.get_screenshot_as_png()
        if path:
            path.write_bytes(png)
        return numpy.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)

    def scene(self):
        """The pixels of the picture of the objects."""
        box = self.of("scene").rect
        return self.picture()[round(box["y"]):round(box["y"] + box["height"]), round(box["x"]):round(box["x"] + box["width"])]


@pytest.fixture(scope="session")
def driver():
    if not (shutil.which("chromium") and shutil.which("chromedriver")):
        pytest.skip("no chromium: make setup-view installs it")
    webdriver = pytest.importorskip("selenium.webdriver", reason="no selenium: make setup-view installs it")
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    for option in OPTIONS:
        options.add_argument(option)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    from selenium.webdriver.chrome.service import Service
    made = webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)
    yield made
    made.quit()


@pytest.fixture
def page(driver):
    """Empty at first, 1,200 x 800; no error may be in its console in the end."""
    made = Page(driver)
    made.size(1200, 800)
    made.console()
    yield made
    assert made.console() == []


@pytest.fixture
def run(fp3, root, tmp_path):
    """The command in an empty folder."""
    def run(*arguments, code=0, **options):
        done = subprocess.run([str(part) for part in [fp3, *arguments]], cwd=tmp_path, capture_output=True, text=True, timeout=300, **options)
        assert done.returncode == code, done.stdout + done.stderr
        return done
    return run


@pytest.fixture
def balls(run, root):
    """60 balls that fall into a box, recorded as HDF5."""
    run("run", "--scene", root / "programs/world/balls.scene", "-n", "400", "--every", "10", "--output", "balls.h5")
    return "balls.h5"
