"""Opens Skycap's reports in Debian's Chromium, for the tests in this folder.

PROGRAM is the program that creates the reports. Exit code 77: no browser is installed.
"""

import json
import os
import pathlib
import struct
import subprocess
import sys
import unittest

try:
    from selenium import webdriver
    from selenium.common.exceptions import JavascriptException
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.by import By
except ImportError:
    print("skipped: python3-selenium is not installed")
    sys.exit(77)

CHROMIUM, DRIVER = "/usr/bin/chromium", "/usr/bin/chromedriver"
# Chromium requires these flags for WebGL on a machine without a graphics card.
FLAGS = ["--headless=new", "--no-sandbox", "--use-angle=swiftshader",
         "--enable-unsafe-swiftshader", "--hide-scrollbars", "--disable-dev-shm-usage"]
HOSTILE = "</script><img src=x onerror=document.title=1><!-- \"'\n" + "x" * 10_000
MISSION = """
name: "%s"
scene: {model: 'builtin:teapot', longest_side: 10.0}
sensor: {width: 160, height: 100, noise: {sigma: 0.03}}
planner: {name: skycap, preset: building, density: 100, resolution_radius: 0.3,
          view_distance: 12}
evaluation: {coverage_distance: 0.2, samples: 3000, visible_directions: 30, attainable_views: 0}
flight: {vehicle: m350_rtk, clearance: 2.0, unknown_box: {min: [-7, -7, 0], max: [7, 7, 7]}}
site: {latitude_deg: 51.75, longitude_deg: -1.25, ellipsoid_height: 100, geoid_undulation: 47,
       no_fly: [{corners: [[20, 20], [24, 20], [24, 24]], floor: 0, ceiling: 30}]}
limits: {max_views: 12}
"""


def run(*arguments):
    done = subprocess.run([os.environ["PROGRAM"], *arguments], capture_output=True, text=True)
    if done.returncode not in (0, 1, 10):  # success, negative result, no next view
        raise RuntimeError(f"skycap {' '.join(arguments)}: {done.stderr}")
    return done


def plan(folder, mission, *options):
    file = folder / "mission.yaml"
    file.write_text(mission)
    run("plan", str(file), "--out", str(folder / "out"), "--quiet", *options)
    return folder / "out"


def write_scaled(results, views, points):
    """Multiplies the views and points of a package's summary and cloud, with small offsets."""
    summary = json.loads((results / "summary.json").read_text())
    first = summary["per_view"]
    summary["per_view"] = [{**first[i % len(first)], "view": i} for i in range(views)]
    for i, view in enumerate(summary["per_view"]):
        view["position"] = [x + 0.01 * (i // len(first)) for x in view["position"]]
    summary["views"] = views
    (results / "summary.json").write_text(json.dumps(summary))
    content = (results / "cloud.ply").read_bytes()
    header, body = content.split(b"end_header\n", 1)
    count = int(header.split(b"element vertex ")[1].split(b"\n")[0])
    stride = len(body) // count
    copies = -(-points // count)
    shifted = []
    for copy in range(copies):
        block = bytearray(body)
        for i in range(0, len(block), stride):  # in x and y only, by less than the point spacing
            x, y = struct.unpack_from("<2f", block, i)
            struct.pack_into("<2f", block, i, x + 0.003 * (copy % 17), y + 0.003 * (copy // 17))
        shifted.append(bytes(block))
    body = b"".join(shifted)[:points * stride]
    header = header.replace(b"element vertex %d" % count, b"element vertex %d" % points)
    (results / "cloud.ply").write_bytes(header + b"end_header\n" + body)


def column_of_ply(path, first, form):
    """Returns values of each vertex in a binary PLY file, starting at the property `first`."""
    content = path.read_bytes()
    header, body = content.split(b"end_header\n", 1)
    sizes = {b"float": 4, b"uint": 4, b"uchar": 1}
    count, stride, offset = 0, 0, 0
    for line in header.split(b"\n"):
        words = line.split()
        if words[:2] == [b"element", b"vertex"]:
            count = int(words[2])
        elif words[:1] == [b"property"]:
            if words[2] == first:
                offset = stride
            stride += sizes[words[1]]
    return [struct.unpack_from(form, body, i * stride + offset) for i in range(count)]


def points_of_ply(path):
    return column_of_ply(path, b"x", "<3f")


def colours_of_ply(path):
    return column_of_ply(path, b"red", "<3B")


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
        if width < 500:  # headless windows have a minimum width
            self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
                "width": width, "height": height, "deviceScaleFactor": 2, "mobile": True})
        self.browser.get(pathlib.Path(file).as_uri())
        self.failure = self.wait("""window.skycap.then(async (s) => {
            window.shown = s;
            if (!s.panel) return null;
            const { viewer } = s.panel, gl = viewer.renderer.getContext();
            const finish = () => gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
            while (viewer.is_waiting) await new Promise(requestAnimationFrame);
            finish();
            window.first_frame = performance.now();
            viewer.draw();
            finish();
            window.all_points = performance.now();
            return null; })""")

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
        """Returns the number of colours in the view, and the renderer's error."""
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

    def click(self, selector):
        """Clicks the element, even if it is covered or outside the window."""
        self.browser.execute_script("document.querySelector(arguments[0]).click()", selector)

    def click_canvas(self, x, y):
        """Clicks with the mouse at a position in the 3-D view."""
        left, top = self.browser.execute_script("""
            const { canvas } = window.shown.panel;
            canvas.scrollIntoView({ block: "center" });
            const box = canvas.getBoundingClientRect();
            return [box.left, box.top];""")
        for kind in ("mousePressed", "mouseReleased"):
            self.browser.execute_cdp_cmd("Input.dispatchMouseEvent", {
                "type": kind, "x": left + x, "y": top + y, "button": "left", "clickCount": 1})

    def tell_first_frame(self, what):
        first, whole = (self.get(f"window.{name}") / 1000 for name in ("first_frame", "all_points"))
        print(f"{what}: first frame {first:.2f} s after the page was opened, with all points {whole:.2f} s")

    def close(self):
        self.browser.quit()


SCALES = {"share": 100, "millimetres": 1000, "minutes": 1 / 60}


def check_figures(test, page, summary, least):
    """Checks that each labelled value on the page equals that of the summary, to the shown
    precision."""
    figures = page.get("""Array.from(document.querySelectorAll("[data-figure]"), (e) =>
        [e.dataset.figure, e.dataset.form, e.textContent])""")
    test.assertGreater(len(figures), least)
    for path, form, text in figures:
        value = summary
        for key in path.split("."):
            if key == "length":
                value = len(value)
            else:
                value = value[int(key)] if isinstance(value, list) else value[key]
        if form == "text":
            test.assertEqual(text, value)
            continue
        number = "".join(c for c in text if c in "0123456789.-")
        shown, decimals = float(number), len(number.partition(".")[2])
        scale = 1000 if form == "seconds" and value < 1 else SCALES.get(form, 1)
        test.assertAlmostEqual(shown, value * scale, delta=0.51 * 10 ** -decimals, msg=path)


def main():
    """Runs the tests of the calling file."""
    for program, package in ((CHROMIUM, "chromium"), (DRIVER, "chromium-driver")):
        if not os.path.exists(program):
            print(f"skipped: {program} is missing; install {package}")
            sys.exit(77)
    os.environ.pop("DISPLAY", None)  # prevents skycap view from opening a browser
    os.environ.pop("WAYLAND_DISPLAY", None)
    unittest.main(verbosity=2)
