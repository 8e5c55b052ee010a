"""Drives reports in Debian's Chromium: skycap report and view, seen as a customer sees them.

PROGRAM is the program that makes the pages. Exit code 77: there is no browser to test with.
"""

import json
import math
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.by import By
except ImportError:
    print("skipped: python3-selenium is not installed")
    sys.exit(77)

CHROMIUM, DRIVER = "/usr/bin/chromium", "/usr/bin/chromedriver"
# Without these Chromium has no WebGL on a machine without a graphics card.
FLAGS = ["--headless=new", "--no-sandbox", "--use-angle=swiftshader",
         "--enable-unsafe-swiftshader", "--hide-scrollbars", "--disable-dev-shm-usage"]
HOSTILE = "</script><img src=x onerror=document.title=1><!-- \"'\\n" + "x" * 200
MISSION = """
name: "%s"
scene: {model: 'builtin:teapot', longest_side: 10.0}
sensor: {width: 160, height: 100, noise: {sigma: 0.03}}
planner: {name: skycap, preset: building, density: 100, resolution_radius: 0.3,
          view_distance: 12}
evaluation: {registration_distance: 0.2, samples: 3000, visible_directions: 30, ceiling_views: 0}
flight: {vehicle: m350_rtk, clearance: 2.0, unknown_box: {min: [-7, -7, 0], max: [7, 7, 7]}}
site: {latitude_deg: 51.75, longitude_deg: -1.25, ellipsoid_height: 100, geoid_undulation: 47,
       no_fly: [{corners: [[20, 20], [24, 20], [24, 24]], bottom: 0, top: 30}]}
limits: {max_views: 12}
"""


def run(*arguments):
    done = subprocess.run([os.environ["PROGRAM"], *arguments], capture_output=True, text=True)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"skycap {' '.join(arguments)}: {done.stderr}")
    return done


def plan(folder, mission, *options):
    file = folder / "mission.yaml"
    file.write_text(mission)
    run("plan", str(file), "--out", str(folder / "out"), "--quiet", *options)
    return folder / "out"


def points_of_ply(path):
    """x, y, z of a binary PLY of ours."""
    content = path.read_bytes()
    header, body = content.split(b"end_header\n", 1)
    sizes = {b"float": 4, b"uint": 4, b"uchar": 1}
    count, stride = 0, 0
    for line in header.split(b"\n"):
        words = line.split()
        if words[:2] == [b"element", b"vertex"]:
            count = int(words[2])
        elif words[:1] == [b"property"]:
            stride += sizes[words[1]]
    return [struct.unpack_from("<3f", body, i * stride) for i in range(count)]


class Page:
    """A report in a browser window."""

    def __init__(self, file, width=1280, height=900):
        options = Options()
        options.binary_location = CHROMIUM
        for flag in FLAGS + [f"--window-size={width},{height}"]:
            options.add_argument(flag)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        self.browser = webdriver.Chrome(service=Service(DRIVER), options=options)
        self.browser.set_script_timeout(300)
        self.browser.get(f"file://{file}")
        self.failure = self.wait("window.skycap.then((s) => { window.shown = s; return null; })")

    def wait(self, promise):
        return self.browser.execute_async_script(
            "const done = arguments[0];"
            f"Promise.resolve({promise}).then(done, (failure) => done(String(failure)));")

    def get(self, expression):
        return self.browser.execute_script(f"return {expression};")

    def all(self, selector):
        return self.browser.find_elements(By.CSS_SELECTOR, selector)

    def complaints(self):
        return [entry["message"] for entry in self.browser.get_log("browser")
                if entry["level"] in ("SEVERE", "WARNING")]

    def requests(self):
        entries = [json.loads(entry["message"])["message"]
                   for entry in self.browser.get_log("performance")]
        return [entry["params"]["request"]["url"] for entry in entries
                if entry["method"] == "Network.requestWillBeSent"]

    def pixels(self):
        """How many colours the picture holds, and the renderer's error."""
        return self.browser.execute_script("""
            const viewer = window.shown.panel.viewer, gl = viewer.renderer.getContext();
            viewer.draw();
            const { width, height } = viewer.canvas, data = new Uint8Array(4 * width * height);
            gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, data);
            const colours = new Map();
            for (let i = 0; i < data.length; i += 4) {
              const key = data[i] << 16 | data[i + 1] << 8 | data[i + 2];
              colours.set(key, (colours.get(key) || 0) + 1);
            }
            const most = Math.max(...colours.values()) / (width * height);
            return { colours: colours.size, most, error: gl.getError() };""")

    def close(self):
        self.browser.quit()


class ReportTest(unittest.TestCase):
    """One survey with all that a page can show, made once."""

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.results = plan(cls.folder, MISSION % "teapot")
        # A mission file's name has no '/', but a summary may come from anywhere.
        cls.summary = json.loads((cls.results / "summary.json").read_text())
        cls.summary["mission"] = HOSTILE
        (cls.results / "summary.json").write_text(json.dumps(cls.summary))
        run("report", str(cls.results))
        cls.page = Page(cls.results / "report.html")

    @classmethod
    def tearDownClass(cls):
        cls.page.close()
        cls.temporary.cleanup()

    def test_1_one_request_no_complaint(self):
        self.assertIsNone(self.page.failure)
        requests = [url for url in self.page.requests() if not url.startswith(("data:", "blob:"))]
        self.assertEqual(len(requests), 1, requests)
        self.assertEqual(self.page.complaints(), [])

    def test_2_the_picture_is_a_picture(self):
        picture = self.page.pixels()
        self.assertEqual(picture["error"], 0)
        self.assertGreater(picture["colours"], 500)
        self.assertLess(picture["most"], 0.5)

    def test_3_points_are_the_clouds_to_half_a_step(self):
        step = self.page.get("window.shown.data.clouds.measured.step")
        decoded = self.page.get("Array.from(window.shown.clouds.measured.positions)")
        truth = sorted(points_of_ply(self.results / "cloud.ply"))
        self.assertEqual(len(decoded), 3 * len(truth))
        cells = {}
        for point in truth:
            cells.setdefault(tuple(math.floor(x / step) for x in point), []).append(point)
        for i in range(0, len(decoded), 3):
            point = decoded[i:i + 3]
            cell = [math.floor(x / step) for x in point]
            near = [other for dx in (-1, 0, 1) for dy in (-1, 0, 1) for dz in (-1, 0, 1)
                    for other in cells.get((cell[0] + dx, cell[1] + dy, cell[2] + dz), [])]
            off = min(max(abs(a - b) for a, b in zip(point, other)) for other in near)
            self.assertLessEqual(off, 0.5 * step * 1.001)

    def test_4_figures_are_the_summarys(self):
        figures = self.page.get("""Array.from(document.querySelectorAll("[data-figure]"), (e) =>
            [e.dataset.figure, e.dataset.form, e.textContent])""")
        self.assertGreater(len(figures), 30)
        scales = {"share": 100, "millimetres": 1000, "minutes": 1 / 60}
        for path, form, text in figures:
            value = self.summary
            for key in path.split("."):
                value = value[int(key)] if isinstance(value, list) else value[key]
            if form == "text":
                self.assertEqual(text, value)
                continue
            number = "".join(c for c in text if c in "0123456789.-")
            shown, decimals = float(number), len(number.partition(".")[2])
            scale = 1000 if form == "seconds" and value < 1 else scales.get(form, 1)
            self.assertAlmostEqual(shown, value * scale, delta=0.51 * 10 ** -decimals, msg=path)

    def test_5_holes_sum_to_what_is_missing(self):
        total = float(self.page.all("#missing-sum")[0].get_attribute("data-area"))
        surface, belief = self.summary["surface"], self.summary["belief"]
        self.assertAlmostEqual(total / surface["area_m2"], 1 - belief["predicted_coverage"], 4)

    def test_6_hostile_name_stays_text(self):
        self.assertEqual(self.page.all("img"), [])
        self.assertEqual(self.page.get("document.querySelector('h1').textContent"),
                         self.summary["mission"])
        self.assertEqual(self.page.get("document.title.length > 100"), True)

    def test_7_every_control_does_something_and_nothing_complains(self):
        page = self.page
        page.browser.execute_script("document.getElementById('view').scrollIntoView()")
        for option in page.get("Array.from(document.querySelectorAll('#colour option'), o => o.value)"):
            page.browser.execute_script("""
                const select = document.getElementById("colour");
                select.value = arguments[0];
                select.dispatchEvent(new Event("change"));""", option)
            self.assertGreater(page.pixels()["colours"], 100, option)
        for button in page.all("[data-look]"):
            button.click()
            self.assertLess(page.pixels()["most"], 0.999)
        for box in page.all("[data-layer]"):
            before = box.is_selected()
            box.click()
            self.assertNotEqual(box.is_selected(), before)
            box.click()
        page.browser.execute_script("""
            const slider = document.getElementById("replay");
            slider.value = 0;
            slider.dispatchEvent(new Event("input"));""")
        self.assertIn("view 0 of", page.all(".now")[0].text)
        page.all("#play")[0].click()
        page.all("#play")[0].click()
        page.browser.execute_script("""
            const slider = document.getElementById("replay");
            slider.value = slider.max;
            slider.dispatchEvent(new Event("input"));""")
        for row in page.all("tr.pick")[:2]:
            page.browser.execute_script("arguments[0].click()", row)
        page.browser.execute_script("window.shown.panel.tell_view(1)")
        self.assertIn("View 1", page.all(".card h3")[0].text)
        page.all(".card .close")[0].click()
        self.assertEqual(page.all(".card"), [])
        for summary in page.all("details summary"):
            page.browser.execute_script("arguments[0].click()", summary)
        page.browser.execute_script("dispatchEvent(new Event('beforeprint'))")
        self.assertEqual(len(page.all(".pictures img")), 2)
        self.assertEqual(page.complaints(), [])

    def test_8_measures_a_distance(self):
        page = self.page
        page.browser.execute_script("window.shown.panel.viewer.look('S', false)")
        page.all("#measure")[0].click()
        places = page.get("""(() => {
            const { viewer } = window.shown.panel, { positions, count } = viewer.main, out = [];
            viewer.camera.updateMatrixWorld();
            for (const i of [0, count - 1]) {
              const seen = viewer.on_screen(new THREE.Vector3(...positions.subarray(3 * i, 3 * i + 3)));
              out.push([seen.x, seen.y]);
            }
            return out; })()""")
        for x, y in places:
            page.browser.execute_script("window.shown.panel.click(arguments[0], arguments[1])", x, y)
        self.assertIn("Distance", page.all(".card h3")[0].text)
        page.all("#measure")[0].click()

    def test_9_works_in_the_hand(self):
        page = Page(self.results / "report.html", 390, 844)
        try:
            self.assertIsNone(page.failure)
            self.assertGreater(page.pixels()["colours"], 100)
            self.assertLessEqual(page.get("document.documentElement.scrollWidth"),
                                 page.get("innerWidth"))
            self.assertEqual(page.complaints(), [])
        finally:
            page.close()


class OtherPagesTest(unittest.TestCase):
    """Pages with little or nothing in them, and those of skycap view."""

    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)

    def tearDown(self):
        self.temporary.cleanup()

    def shows(self, file):
        page = Page(file)
        try:
            self.assertIsNone(page.failure)
            self.assertEqual(page.complaints(), [])
            return page.get("document.body.innerText")
        finally:
            page.close()

    def test_a_survey_of_one_view_without_a_vehicle(self):
        mission = MISSION % "one"
        mission = "\n".join(line for line in mission.split("\n") if not line.startswith("flight:"))
        results = plan(self.folder, mission, "--max-views", "1", "--planner", "see++")
        self.assertIn("one", self.shows(results / "report.html"))

    def test_a_folder_without_clouds(self):
        results = plan(self.folder, MISSION % "bare", "--max-views", "2")
        for name in ("cloud.ply", "coverage.ply"):
            (results / name).unlink()
        run("report", str(results))
        self.assertIn("bare", self.shows(results / "report.html"))

    def test_a_cloud_and_a_mission(self):
        cloud = self.folder / "cloud.xyz"
        cloud.write_text("".join(f"{i % 10} {i // 10} {i % 7}\n" for i in range(100)))
        run("view", str(cloud))
        self.assertIn("cloud.xyz", self.shows(self.folder / "cloud.html"))
        (self.folder / "mission.yaml").write_text(MISSION % "before")
        run("view", str(self.folder / "mission.yaml"), "--out", str(self.folder / "m.html"))
        self.assertIn("before", self.shows(self.folder / "m.html"))


if __name__ == "__main__":
    for program, package in ((CHROMIUM, "chromium"), (DRIVER, "chromium-driver")):
        if not os.path.exists(program):
            print(f"skipped: {program} is missing; install {package}")
            sys.exit(77)
    os.environ.pop("DISPLAY", None)  # skycap view opens nothing here
    os.environ.pop("WAYLAND_DISPLAY", None)
    unittest.main(verbosity=2)
