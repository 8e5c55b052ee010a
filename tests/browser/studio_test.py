"""Tests skycap studio with real clicks in a browser: from a city model tile to an exported flight."""

import concurrent.futures
import json
import math
import os
import pathlib
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import unittest
import urllib.request
import zipfile

from accessibility import AXE, audit
from chromium import CHROMIUM, DRIVER, FLAGS, MISSION, main, run  # skips without selenium

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "clients"))
import skycap_live

from selenium import webdriver
from selenium.common.exceptions import StaleElementReferenceException
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.actions import interaction
from selenium.webdriver.common.actions.action_builder import ActionBuilder
from selenium.webdriver.common.actions.pointer_input import PointerInput
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select, WebDriverWait

PATIENCE = int(os.environ.get("PATIENCE", "240"))  # seconds; only a failing test waits this long


def building(name, x):
    """Returns a CityGML building of 12 x 10 x 8 m in UTM zone 32."""
    low, high = (676300.0 + x, 5403900.0, 380.0), (676312.0 + x, 5403910.0, 388.0)
    corner = lambda i: " ".join(str((high if i >> k & 1 else low)[k]) for k in range(3))
    faces = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (1, 3, 7, 5), (3, 2, 6, 7), (2, 0, 4, 6))
    members = "".join(
        "<gml:surfaceMember><gml:Polygon><gml:exterior><gml:LinearRing><gml:posList>"
        + " ".join(corner(i) for i in (*face, face[0]))
        + "</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon></gml:surfaceMember>"
        for face in faces)
    return (f'<core:cityObjectMember><bldg:Building gml:id="{name}"><bldg:lod2Solid><gml:Solid '
            f'srsName="EPSG:25832" srsDimension="3"><gml:exterior><gml:CompositeSurface>{members}'
            "</gml:CompositeSurface></gml:exterior></gml:Solid></bldg:lod2Solid></bldg:Building>"
            "</core:cityObjectMember>")


BLOCK = "".join(f"v {x} {y} {z}\n" for x, y, z in (
    (-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0), (-2, -2, 5), (2, -2, 5), (2, 2, 5), (-2, 2, 5))) + """
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
"""
INSPECTION = """
name: block
site: {latitude_deg: 51.7535, longitude_deg: -1.254, ellipsoid_height: 111.5, geoid_undulation: 46.7}
sensor: {photo_camera: mavic_3e_wide}
inspection: {range: 7, share: 0.9, spacing: 0.25, moves: 1500, searches: 1}
prior: [{file: block.obj, role: target, uncertainty: 0.1}]
flight: {vehicle: mavic_3e, free_space: assumed, position_error: 0.1, clearance: 2}
"""


def tile():
    return ('<?xml version="1.0"?><core:CityModel xmlns:core="http://www.opengis.net/citygml/2.0" '
            'xmlns:bldg="http://www.opengis.net/citygml/building/2.0" '
            'xmlns:gml="http://www.opengis.net/gml">'
            + "".join(building(f"house_{i}", 45.0 * i) for i in range(3)) + "</core:CityModel>\n")


def geotiff(latitude, longitude, half, side=64):
    """Returns a GeoTIFF in WGS84 around a position: red in the north-west, green, blue and white in the other quarters."""
    north = half / 111_200
    east = north / math.cos(math.radians(latitude))
    colours = ((255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 255))
    pixels = b"".join(bytes(colours[2 * (row >= side // 2) + (column >= side // 2)]) for row in range(side) for column in range(side))
    shorts = lambda *values: struct.pack(f"<{len(values)}H", *values)
    doubles = lambda *values: struct.pack(f"<{len(values)}d", *values)
    longs = lambda value: struct.pack("<I", value)
    entries = [(256, 4, longs(side)), (257, 4, longs(side)), (258, 3, shorts(8, 8, 8)), (259, 3, shorts(1)), (262, 3, shorts(2)),
               (273, 4, longs(8)), (277, 3, shorts(3)), (278, 4, longs(side)), (279, 4, longs(len(pixels))),
               (33550, 12, doubles(2 * east / side, 2 * north / side, 0)),
               (33922, 12, doubles(0, 0, 0, longitude - east, latitude + north, 0)),
               (34735, 3, shorts(1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 1, 2048, 0, 1, 4326))]
    size = {3: 2, 4: 4, 12: 8}
    at = 8 + len(pixels)
    table, more = struct.pack("<H", len(entries)), b""
    after = at + 2 + 12 * len(entries) + 4
    for tag, kind, content in entries:
        table += struct.pack("<HHI", tag, kind, len(content) // size[kind])
        if len(content) <= 4:
            table += content.ljust(4, b"\0")
        else:
            table += longs(after + len(more))
            more += content
    return b"II*\0" + longs(at) + pixels + table + longs(0) + more


class Studio:
    """A running studio and a browser that shows it."""

    def __init__(self, what, folder):
        self.folder = folder
        self.program = subprocess.Popen(
            [os.environ["PROGRAM"], "studio", str(what), "--no-browser"],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        lines = [self.program.stdout.readline() for _ in range(3)]
        self.address = lines[1].split()[1]
        options = Options()
        options.binary_location = CHROMIUM
        for flag in FLAGS + ["--window-size=1024,768"]:
            options.add_argument(flag)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.browser = webdriver.Chrome(service=Service(DRIVER), options=options)
        self.clicks = 0
        self.open()

    def open(self):
        self.browser.get(self.address)
        self.wait("body[data-ready]")

    def wait(self, selector):
        """Waits until the element is visible."""
        return WebDriverWait(self.browser, PATIENCE, 0.05, [StaleElementReferenceException]).until(
            lambda browser: next((one for one in browser.find_elements(By.CSS_SELECTOR, selector)
                                  if one.is_displayed()), None), selector)

    def wait_for(self, condition):
        return WebDriverWait(self.browser, PATIENCE, 0.05, [StaleElementReferenceException]).until(
            lambda _: condition())

    def click(self, element):
        """Clicks with the mouse at the centre of the element."""
        if isinstance(element, str):
            element = self.wait(element)
        self.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", element)
        ActionChains(self.browser).click(element).perform()
        self.clicks += 1

    def button(self, text):
        return self.wait_for(lambda: next(
            (one for one in self.browser.find_elements(By.TAG_NAME, "button")
             if one.text == text and one.is_displayed() and one.is_enabled()), None))

    def canvas(self, selector, action):
        """Performs an action in the 3-D view of a frame, whose panel is `panel` in scripts."""
        self.browser.switch_to.frame(self.wait(selector + "[data-ready=true]"))
        self.browser.execute_async_script(
            "const done = arguments[0]; window.skycap.then((s) => { window.panel = s.panel; done(); });")
        canvas = self.browser.find_element(By.TAG_NAME, "canvas")
        self.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", canvas)
        try:
            return action(canvas)
        finally:
            self.browser.switch_to.default_content()

    def click_canvas(self, selector, places):
        """Clicks at places in a 3-D view, as fractions of its width and height."""
        def act(canvas):
            for x, y in places:
                ActionChains(self.browser).move_to_element_with_offset(
                    canvas, round(x * canvas.size["width"] / 2), round(y * canvas.size["height"] / 2)).click().perform()
        self.canvas(selector, act)

    def drag_handle(self, selector, name, by):
        """Drags the first handle of an object in a 3-D view by some pixels."""
        def act(canvas):
            at = self.browser.execute_script(
                "const one = window.panel.editor.handles.find((handle) => handle.object.id === arguments[0]);"
                "return window.panel.viewer.on_screen(one.place);", name)
            chain = ActionChains(self.browser).move_to_element_with_offset(
                canvas, round(at["x"] - canvas.size["width"] / 2), round(at["y"] - canvas.size["height"] / 2))
            chain.click_and_hold().move_by_offset(by[0] // 2, by[1] // 2).move_by_offset(
                by[0] - by[0] // 2, by[1] - by[1] // 2).release().perform()
        self.canvas(selector, act)

    def field_of(self, label, selector):
        """Returns the control with a visible label."""
        return self.wait_for(lambda: next(
            (self.browser.find_element(By.ID, one.get_attribute("for"))
             for one in self.browser.find_elements(By.CSS_SELECTOR, selector + " label")
             if one.text == label and one.is_displayed()), None))

    def field(self, label):
        return self.wait(f"input[aria-label='{label}']")

    def enter(self, label, value):
        field = self.field(label)
        self.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", field)
        chain = ActionChains(self.browser).click(field).key_down(Keys.CONTROL).send_keys("a").key_up(Keys.CONTROL)
        chain.send_keys(str(value), Keys.TAB).perform()

    def picture(self, name):
        """Saves a screenshot for a person, if a folder is given."""
        if "PICTURES" in os.environ:
            self.browser.save_screenshot(f"{os.environ['PICTURES']}/{name}.png")

    def complaints(self):
        return [entry["message"] for entry in self.browser.get_log("browser")
                if entry["level"] == "SEVERE" and "409 (Conflict)" not in entry["message"]]

    def message(self):
        return self.browser.find_element(By.ID, "message").text

    def api(self, path):
        with urllib.request.urlopen(self.address + "api/" + path) as answer:
            return json.load(answer)

    def close(self):
        """Ends the studio with Ctrl-C and returns its exit code."""
        self.browser.quit()
        self.program.send_signal(signal.SIGINT)
        code = self.program.wait(PATIENCE)
        self.program.stdout.close()
        self.program.stderr.close()
        return code


class StudioTest(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.studio = None

    def tearDown(self):
        if self.studio:
            self.studio.picture("0_end_of_" + self._testMethodName)  # shows the cause of a failure
            self.assertEqual(self.studio.complaints(), [])
            self.assertEqual(self.studio.close(), 0)
        self.temporary.cleanup()

    def start(self, what):
        self.studio = Studio(self.folder / what, self.folder)
        return self.studio

    def audit(self, state):
        """Fails if the page in this state violates an accessibility rule."""
        texts = audit(self, self.studio.browser, state)
        print(f"{state}: {texts} texts checked{'' if AXE else '; axe-core is not installed'}")

    def test_from_a_tile_to_an_exported_photo_flight(self):
        (self.folder / "tile.gml").write_text(tile())
        studio = self.start("tile.gml")
        frame = studio.wait("#site iframe[data-objects='3']")
        studio.picture("1_tile")
        studio.browser.switch_to.frame(frame)
        studio.click(studio.browser.find_elements(By.CSS_SELECTOR, "path")[1])
        studio.browser.switch_to.default_content()
        target = studio.browser.find_element(By.CSS_SELECTOR, "#site input[list=objects]")
        studio.wait_for(lambda: target.get_attribute("value") == "house_1")
        studio.click("#site input[value=mavic_3e_wide]")
        studio.picture("2_target")
        studio.click("#create")
        studio.wait("#plan-now")
        self.assertTrue((self.folder / "house_1.yaml").exists(), studio.message())
        studio.picture("3_mission")
        studio.click("#plan-now")
        link = studio.wait("#results a[data-file='mission.kmz']")
        studio.picture("4_results")
        studio.click(link)
        print(f"from the tile to the KMZ: {studio.clicks} clicks")
        self.assertLessEqual(studio.clicks, 12)
        with urllib.request.urlopen(link.get_attribute("href")) as answer:
            kmz = answer.read()
        self.assertEqual(kmz, (self.folder / "results/house_1/mission.kmz").read_bytes())
        with zipfile.ZipFile(self.folder / "results/house_1/mission.kmz") as archive:
            photos = archive.read("wpmz/waylines.wpml").decode().count("orientedShoot")
        self.assertGreater(photos, 8)
        # The command line writes the same files from the mission that the page has written.
        run("plan", str(self.folder / "house_1.yaml"), "--out", str(self.folder / "again"))
        self.assertEqual((self.folder / "again/mission.kmz").read_bytes(), kmz)

    def test_plans_a_model_edits_its_mission_and_exports_for_another_vehicle(self):
        (self.folder / "mission.yaml").write_text(MISSION % "pot" + "# a comment\n")
        studio = self.start("mission.yaml")
        views = studio.wait("#mission input[data-key='limits.max_views']")
        views.clear()
        views.send_keys("-3", Keys.TAB)
        text = studio.browser.find_element(By.CSS_SELECTOR, "#mission textarea")
        studio.wait_for(lambda: "max_views: -3" in text.get_attribute("value"))
        studio.click("#check")
        output = studio.wait("#mission div[data-running=false]")
        self.assertIn("limits.max_views", output.text)
        self.assertIn("exit code 2", output.text)
        studio.picture("5_check")
        self.audit("mission with an error")
        views.clear()
        views.send_keys("3", Keys.TAB)
        studio.wait_for(lambda: "max_views: 3}" in text.get_attribute("value"))
        studio.click("#plan")
        studio.wait("#results a[data-file='mission.kmz']")
        saved = (self.folder / "mission.yaml").read_text()
        self.assertEqual(saved, MISSION.replace("max_views: 12", "max_views: 3") % "pot" + "# a comment\n")
        Select(studio.wait("#format")).select_by_value("litchi")
        studio.click("#export")
        studio.wait("#results a[data-file='mission.litchi.csv']")
        studio.picture("6_export")
        self.audit("export")
        self.assertFalse(list(self.folder.glob(".*")), "drafts are removed")

    def test_shows_a_change_on_disk_and_overwrites_nothing(self):
        file = self.folder / "mission.yaml"
        file.write_text(MISSION % "pot")
        studio = self.start("mission.yaml")
        name = studio.wait("#mission input[data-key=name]")
        name.clear()
        name.send_keys("mine", Keys.TAB)
        studio.wait_for(lambda: "changed" in studio.browser.find_element(By.ID, "mission").text)
        file.write_text(MISSION % "theirs")
        studio.click("#save")
        studio.wait("#mission div[role=alert]")
        studio.picture("7_conflict")
        self.audit("conflict")
        self.assertEqual(file.read_text(), MISSION % "theirs")
        studio.click(studio.button("Keep this text and replace the file"))
        studio.wait_for(lambda: "name: mine" in file.read_text())

    def test_adds_files_and_replaces_none_without_a_question(self):
        studio = self.start("")
        outside = tempfile.TemporaryDirectory()
        self.addCleanup(outside.cleanup)
        source = pathlib.Path(outside.name) / "tile.gml"
        source.write_text(tile() + " " * 3_000_000)  # several pieces
        chooser = studio.wait("#chooser")
        chooser.send_keys(str(source))
        studio.wait_for(lambda: (self.folder / "tile.gml").exists())
        self.assertEqual((self.folder / "tile.gml").read_bytes(), source.read_bytes())
        studio.button("tile.gml")
        studio.picture("10_added")
        source.write_text(tile())
        chooser.send_keys(str(source))
        studio.wait("dialog")
        studio.picture("11_question")
        studio.click(studio.button("Keep it"))
        studio.wait_for(lambda: "No file added" in studio.wait("#sent").text)
        self.assertGreater((self.folder / "tile.gml").stat().st_size, 3_000_000)
        chooser.send_keys(str(source))
        studio.wait("dialog")
        studio.click(studio.button("Replace it"))
        studio.wait_for(lambda: (self.folder / "tile.gml").read_text() == tile())
        # A dropped web page is rejected, and nothing remains of it.
        studio.browser.execute_script("""
            const transfer = new DataTransfer();
            transfer.items.add(new File(["<script>"], arguments[0]));
            document.querySelector("#drop").dispatchEvent(
                new DragEvent("drop", { dataTransfer: transfer, bubbles: true, cancelable: true }));""", "evil.html")
        studio.wait_for(lambda: "evil.html" in studio.message())
        self.audit("message")
        studio.browser.get_log("browser")  # the rejection
        studio.browser.execute_script("""
            const transfer = new DataTransfer();
            transfer.items.add(new File(["name: dropped\\n"], "dropped.yaml"));
            document.querySelector("#drop").dispatchEvent(
                new DragEvent("drop", { dataTransfer: transfer, bubbles: true, cancelable: true }));""")
        studio.button("dropped.yaml")
        self.assertEqual((self.folder / "dropped.yaml").read_text(), "name: dropped\n")
        self.assertEqual(sorted(one.name for one in self.folder.iterdir()), ["dropped.yaml", "tile.gml"])

    def test_draws_the_take_off_point_and_the_airspace(self):
        file = self.folder / "mission.yaml"
        file.write_text("# top\n" + MISSION % "pot" + "# end\n")
        studio = self.start("mission.yaml")
        frame = ".drawing iframe"
        area = studio.wait("#mission textarea")
        text = lambda: area.get_attribute("value")
        studio.click(studio.button("Show in 3-D"))
        studio.wait(frame + "[data-ready=true]")
        studio.click("[data-tool=takeoff]")
        studio.click_canvas(frame, [(-0.6, 0.5)])
        studio.wait_for(lambda: "takeoff: [" in text())
        first = studio.field("take-off x").get_attribute("value")
        studio.drag_handle(frame, "flight.takeoff", (40, 10))
        studio.wait_for(lambda: studio.field("take-off x").get_attribute("value") != first)
        studio.enter("take-off y", -14.5)
        studio.wait_for(lambda: ", -14.5, " in text())
        studio.click("[data-tool=rally]")
        studio.click_canvas(frame, [(0.5, 0.6)])
        studio.wait_for(lambda: "rally: [[" in text())
        studio.enter("rally 1 z", 0)
        studio.click("[data-tool=geofence]")
        studio.click_canvas(frame, [(-0.8, 0.7), (0.8, 0.7), (0.8, -0.3), (-0.8, -0.3)])
        studio.click(studio.button("Finish"))
        studio.wait_for(lambda: "geofence: [[" in text())
        for i, (x, y) in enumerate(((-60, -60), (60, -60), (60, 60), (-60, 60))):
            studio.enter(f"geofence corner {i + 1} x", x)
            studio.enter(f"geofence corner {i + 1} y", y)
        studio.wait_for(lambda: "geofence: [[-60, -60], [60, -60], [60, 60], [-60, 60]]" in text())
        studio.enter("no-fly 1 ceiling", 25)
        studio.wait_for(lambda: "ceiling: 25" in text())
        studio.click("[data-tool=no_fly]")
        studio.click_canvas(frame, [(0.6, 0.3), (0.75, 0.3), (0.7, 0.4)])
        studio.click(studio.button("Finish"))
        studio.wait_for(lambda: "ceiling: 25}, {corners" in text())
        studio.click("[data-tool=scene]")
        studio.click_canvas(frame, [(-0.3, 0.3), (0.3, -0.2)])
        studio.wait_for(lambda: "scene_box:" in text())
        studio.wait_for(lambda: "flight.rally conflicts" in studio.wait("#checked").text)  # a DJI vehicle
        studio.picture("12_drawing")
        studio.click("[data-tool=geofence]")
        self.audit("drawing")
        studio.click(studio.button("Stop drawing"))
        studio.click(studio.button("Remove rally 1"))
        studio.wait_for(lambda: "rally" not in text())
        before = text()
        studio.click(studio.button("Remove target box"))
        studio.wait_for(lambda: "scene_box" not in text())
        studio.click("#mission .undo")
        studio.wait_for(lambda: text() == before)
        studio.click("#mission .redo")
        studio.wait_for(lambda: text() != before)
        studio.enter("take-off x", 16)
        studio.enter("take-off y", -16)
        studio.enter("take-off z", 0)
        studio.wait_for(lambda: "takeoff: [16, -16, 0]" in text())
        studio.click(studio.button("Remove no-fly 2"))
        studio.wait_for(lambda: "corners" not in text().split("ceiling: 25}")[1])
        studio.wait_for(lambda: studio.wait("#checked").text == "Check passed.")
        for fact in ("views", "minutes of flight", "MB"):
            self.assertIn(fact, studio.wait("#estimate").text)
        studio.click("#save")
        studio.wait_for(lambda: file.read_text() == text())
        saved = file.read_text()
        self.assertTrue(saved.startswith("# top\n") and saved.endswith("# end\n"))
        self.assertEqual(run("check", str(file)).returncode, 0)

    def test_edits_the_views_of_a_plan_and_verifies_the_route(self):
        shutil.copy("missions/radcliffe_camera.yaml", self.folder / "mission.yaml")
        run("plan", str(self.folder / "mission.yaml"), "--planner", "skycap", "--out", str(self.folder / "plan"),
            "--quiet", "--set", "evaluation.attainable_views=0", "--set", "evaluation.samples=5000",
            "--set", "planner.goal=views", "--set", "flight.views=survey")
        studio = self.start("")
        studio.click(studio.button("plan"))
        studio.click("#edit-views")
        frame = "#results .drawing iframe"
        views = Select(studio.wait("#views"))
        count = len(views.options)
        self.assertGreater(count, 10)
        self.assertTrue(studio.wait("#results .undo").get_attribute("disabled"))
        studio.drag_handle(frame, "3", (25, 0))
        studio.wait_for(lambda: studio.wait("#verdict").text == "Changed; not verified.")
        studio.click("#add-view")
        studio.wait_for(lambda: len(views.options) == count + 1)
        studio.click("#remove-view")
        studio.wait_for(lambda: len(views.options) == count)
        for _ in range(3):
            studio.click("#results .undo")
        studio.click("#verify")
        verdict = studio.wait("#verdict[data-exit='0']")
        print(f"verified after {verdict.get_attribute('data-seconds')} s")
        self.assertLessEqual(float(verdict.get_attribute("data-seconds")), 2.0)
        self.assertIn("verified for every leg", verdict.text)
        studio.picture("13_verified")
        self.audit("verified views")
        self.assertTrue((self.folder / "plan_edited/mission.kmz").exists())
        # A view inside the building: the first leg that violates the clearance is named.
        views.select_by_index(5)
        for axis in "xyz":
            studio.enter(f"View: {axis} [m]", {"x": 0, "y": 0, "z": 20}[axis])
        studio.click("#verify")
        verdict = studio.wait("#verdict[data-exit='1']")
        self.assertIn("Not verified: leg ", verdict.text)
        self.assertIn(views.options[5].text, verdict.text)
        studio.picture("14_not_verified")
        self.audit("views that are not verified")

    def test_edits_the_replanned_views_of_a_plan(self):
        (self.folder / "mission.yaml").write_text(MISSION % "pot")
        run("plan", str(self.folder / "mission.yaml"), "--out", str(self.folder / "plan"), "--quiet",
            "--set", "flight.views=replanned")
        replanned = json.loads((self.folder / "plan/summary.json").read_text())["flight"]["replanned"]
        self.assertTrue(replanned["is_flown"])
        studio = self.start("")
        studio.click(studio.button("plan"))
        studio.click("#edit-views")
        views = Select(studio.wait("#views"))
        self.assertEqual(len(views.options), len(replanned["stations"]))
        for i, station in enumerate(replanned["stations"]):
            views.select_by_index(i)
            for name, value in zip("xyz", station["position"]):
                shown = studio.wait(f"#view-editor input[data-name={name}]").get_attribute("value")
                self.assertAlmostEqual(float(shown), value, delta=0.006)

    def test_edits_the_corners_of_an_inspection_and_verifies_the_flight(self):
        (self.folder / "block.obj").write_text(BLOCK)
        (self.folder / "block.yaml").write_text(INSPECTION)
        run("plan", str(self.folder / "block.yaml"), "--out", str(self.folder / "plan"), "--quiet")
        vertices = json.loads((self.folder / "plan/summary.json").read_text())["inspection"]["vertices"]
        studio = self.start("")
        studio.click(studio.button("plan"))
        studio.click("#edit-views")
        frame = "#results .drawing iframe"
        corners = Select(studio.wait("#views"))
        self.assertEqual(len(corners.options), len(vertices))
        corners.select_by_index(2)
        for name, value in zip("xyz", vertices[2]["position"]):
            shown = studio.wait(f"#view-editor input[data-name={name}]").get_attribute("value")
            self.assertAlmostEqual(float(shown), value, delta=0.006)
        # The unchanged corners give the planned flight.
        studio.click("#verify")
        verdict = studio.wait("#verdict[data-exit='0']")
        print(f"inspection verified after {verdict.get_attribute('data-seconds')} s")
        self.assertIn("continuous flight of", verdict.text)
        self.assertNotIn("slowed", verdict.text)
        # A corner is dragged, another one added and removed, and a leg slowed.
        studio.drag_handle(frame, "2", (20, 0))
        studio.wait_for(lambda: studio.wait("#verdict").text == "Changed; not verified.")
        studio.click("#add-view")
        studio.wait_for(lambda: len(corners.options) == len(vertices) + 1)
        self.assertIn("new corner", corners.options[3].text)
        studio.click("#remove-view")
        studio.wait_for(lambda: len(corners.options) == len(vertices))
        for _ in range(3):
            studio.click("#results .undo")
        studio.wait_for(lambda: studio.wait("#results .undo").get_attribute("disabled"))
        corners.select_by_index(len(vertices) - 2)
        studio.enter("View: Delay [s]", 5)
        studio.click("#verify")
        verdict = studio.wait("#verdict[data-exit='0']")
        studio.picture("20_inspection")
        self.audit("inspection")
        edited = json.loads((self.folder / "plan_edited/summary.json").read_text())["inspection"]
        planned = json.loads((self.folder / "plan/summary.json").read_text())["inspection"]
        # Neighbouring legs are slowed, too, if the change of speed is too sudden.
        self.assertGreater(edited["duration_s"], planned["duration_s"] + 5 - vertices[-2]["delay_s"] - 0.01)
        # A corner above the block violates the clearance: the leg is named by its corners.
        corners.select_by_index(3)
        for name, value in (("x [m]", 0), ("y [m]", 0), ("z [m]", 6)):
            studio.enter("View: " + name, value)
        studio.click("#verify")
        verdict = studio.wait("#verdict[data-exit='1']")
        self.assertIn("Not verified: leg ", verdict.text)
        self.assertIn("4: corner 3", verdict.text)
        studio.picture("21_inspection_not_verified")
        for _ in range(3):
            studio.click("#results .undo")
        studio.click("#verify")
        studio.wait("#verdict[data-exit='0']")
        studio.click("#open-edited")
        studio.wait_for(lambda: Select(studio.wait("#results select")).first_selected_option.text == "plan_edited")
        studio.wait(frame + "[data-ready=true]")
        self.assertTrue(studio.wait("#results a[data-file='mission.kmz']"))

    def test_edits_the_views_of_a_fleet_and_verifies_all_distances(self):
        (self.folder / "mission.yaml").write_text(MISSION.replace(
            "vehicle: m350_rtk", "vehicles: [m350_rtk, m350_rtk], pads: [[-70, 0, 0], [70, 0, 0]]") % "pot")
        run("plan", str(self.folder / "mission.yaml"), "--out", str(self.folder / "plan"), "--quiet")
        fleet = json.loads((self.folder / "plan/summary.json").read_text())["flight"]["fleet"]
        orders = [one["order"] for one in fleet["vehicles"]]
        studio = self.start("")
        studio.click(studio.button("plan"))
        studio.click("#edit-views")
        views = Select(studio.wait("#views"))
        self.assertEqual(len(views.options), sum(len(one) for one in orders))
        self.assertIn(f"view {orders[0][0]}, vehicle 1", views.options[0].text)
        self.assertIn(f"view {orders[1][-1]}, vehicle 2", views.options[-1].text)
        studio.drag_handle("#results .drawing iframe", "1", (12, 0))
        studio.wait_for(lambda: studio.wait("#verdict").text == "Changed; not verified.")
        studio.click("#verify")
        verdict = studio.wait("#verdict[data-exit='0']")
        print(f"fleet verified after {verdict.get_attribute('data-seconds')} s")
        for text in (f"vehicle 1 m350_rtk, {len(orders[0])} waypoint", f"vehicle 2 m350_rtk, {len(orders[1])} waypoint",
                     "separation minimum"):
            self.assertIn(text, verdict.text)
        studio.picture("22_fleet")
        self.audit("fleet")
        timetable = self.folder / "plan_edited/timetable.csv"
        self.assertEqual(run("check", str(self.folder / "mission.yaml"), "--route", str(timetable)).returncode, 0)
        # The view is given to the other vehicle.
        views.select_by_index(1)
        studio.enter("View: Vehicle", 2)
        studio.wait_for(lambda: f"view {orders[0][1]}, vehicle 2" in views.options[-1].text)
        studio.click("#verify")
        studio.wait_for(lambda: f"vehicle 2 m350_rtk, {len(orders[1]) + 1} waypoint" in studio.wait("#verdict").text)
        studio.enter("View: Vehicle", 3)
        studio.wait_for(lambda: "from 1 to 2" in studio.message())
        # A view inside the object: it is named with its vehicle.
        for name, value in (("x [m]", 0), ("y [m]", 0), ("z [m]", 2)):
            studio.enter("View: " + name, value)
        studio.click("#verify")
        verdict = studio.wait("#verdict[data-exit='1']")
        self.assertIn("vehicle 2", verdict.text)

    def test_shows_an_orthophoto_as_the_ground(self):
        (self.folder / "mission.yaml").write_text(MISSION % "pot")
        (self.folder / "ortho.tif").write_bytes(geotiff(51.75, -1.25, 60))
        run("plan", str(self.folder / "mission.yaml"), "--out", str(self.folder / "plan"), "--quiet")
        studio = self.start("mission.yaml")

        def check(selector):
            """The corners are 60 m from the origin; north-west is red."""
            def act(_):
                studio.wait_for(lambda: studio.browser.execute_script(
                    "return !!(window.panel.viewer.layers.background || { userData: {} }).userData.is_loaded"))
                return studio.browser.execute_script("""
                    const { background } = window.panel.viewer.layers, canvas = document.createElement("canvas");
                    const image = background.material.map.image, context = canvas.getContext("2d");
                    canvas.width = image.width;
                    canvas.height = image.height;
                    context.drawImage(image, 0, 0);
                    return [[...background.geometry.getAttribute("position").array], [...context.getImageData(8, 8, 1, 1).data]];""")
            places, colour = studio.canvas(selector, act)
            for found, expected in zip(places, (-60, 60, 0, 60, 60, 0, 60, -60, 0, -60, -60, 0)):
                self.assertAlmostEqual(found, expected, delta=0.3)
            for found, expected in zip(colour, (255, 0, 0)):
                self.assertAlmostEqual(found, expected, delta=12)

        Select(studio.field_of("Background", "#mission")).select_by_value("ortho.tif")
        studio.click(studio.button("Show in 3-D"))
        check(".drawing iframe")
        studio.picture("23_orthophoto")
        studio.click("nav button[data-step=files]")
        studio.click(studio.button("plan"))
        studio.wait("#results iframe[data-ready=true]")
        Select(studio.field_of("Background", "#results")).select_by_value("ortho.tif")
        studio.wait_for(lambda: "background" in studio.wait("#results iframe").get_attribute("src"))
        check("#results iframe")
        studio.click("#edit-views")
        studio.wait("#views option")
        check("#results iframe")
        studio.picture("24_orthophoto_of_results")
        self.assertIn("skycap view plan --out=plan_background.html --background=ortho.tif", studio.wait("#results code").text)

    def test_creates_a_mission_with_several_targets(self):
        (self.folder / "tile.gml").write_text(tile())
        studio = self.start("tile.gml")
        target = studio.browser.find_element(By.CSS_SELECTOR, "#site input[list=objects]")
        for number in (0, 2):
            studio.browser.switch_to.frame(studio.wait("#site iframe[data-objects='3']"))
            studio.click(studio.browser.find_elements(By.CSS_SELECTOR, "path")[number])
            studio.browser.switch_to.default_content()
            studio.wait_for(lambda: target.get_attribute("value") == f"house_{number}")
            if number == 0:
                studio.click("#more-targets")
                studio.wait_for(lambda: target.get_attribute("value") == "")
        self.audit("several targets")
        studio.picture("25_targets")
        studio.click("#create")
        studio.wait("#plan-now")
        self.assertIn("coordinate system ETRS89 / UTM zone 32N", studio.wait("#site pre").text)
        # The file names no vertical datum: the choice is shown with the program's warning.
        self.assertTrue(studio.wait("#georeference").get_attribute("open"))
        self.assertIn("missing vertical datum", studio.wait("#site pre").text)
        text = (self.folder / "house_0.yaml").read_text()
        self.assertIn("house_0", text)
        self.assertIn("house_2", text)
        self.assertNotIn("house_1", text)

    def test_draws_and_drags_by_touch(self):
        (self.folder / "mission.yaml").write_text(MISSION % "pot")
        studio = self.start("mission.yaml")
        area = studio.wait("#mission textarea")
        text = lambda: area.get_attribute("value")

        def touch(element, places):
            """Moves a finger over an element: offsets from its centre."""
            chain = ActionBuilder(studio.browser, mouse=PointerInput(interaction.POINTER_TOUCH, "finger"), duration=50)
            finger = chain.pointer_action
            finger.move_to(element, *places[0]).pointer_down()
            for place in places[1:]:
                finger.move_to(element, *place)
            finger.pointer_up()
            chain.perform()

        def tap(element):
            studio.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", element)
            touch(element, [(0, 0)])

        tap(studio.button("Show in 3-D"))
        frame = ".drawing iframe"
        studio.wait(frame + "[data-ready=true]")
        tap(studio.wait("[data-tool=takeoff]"))
        studio.canvas(frame, lambda canvas: touch(canvas, [(round(-0.25 * canvas.size["width"]), round(0.25 * canvas.size["height"]))]))
        studio.wait_for(lambda: "takeoff: [" in text())
        first = text()

        def drag(canvas):
            at = studio.browser.execute_script(
                "return window.panel.viewer.on_screen(window.panel.editor.handles.find((one) => one.object.id === 'flight.takeoff').place)")
            x, y = round(at["x"] - canvas.size["width"] / 2), round(at["y"] - canvas.size["height"] / 2)
            touch(canvas, [(x + 8 * step, y + 2 * step) for step in range(6)])
        studio.canvas(frame, drag)
        studio.wait_for(lambda: text() != first)
        self.assertIn("takeoff: [", text())
        studio.picture("26_touch")

    def test_shows_the_survey_while_it_is_planned(self):
        shutil.copy("missions/radcliffe_camera.yaml", self.folder / "mission.yaml")
        studio = self.start("mission.yaml")
        studio.click("#plan")
        frame = studio.wait(".drawing iframe[data-ready=true]")
        count = lambda: int(frame.get_attribute("data-views") or 0)
        studio.wait_for(lambda: count() > 3)
        early = count()
        studio.wait_for(lambda: count() > early)
        self.assertIn("points", studio.wait("#growth").text)
        # The measured points appear, too. Their number grows, or is halved by a larger stride.
        points = lambda: int(frame.get_attribute("data-points") or 0)
        shown = points()
        self.assertGreater(shown, 1000)
        self.assertLessEqual(shown, 100_000)
        studio.wait_for(lambda: points() != shown)
        drawn = studio.canvas(".drawing iframe", lambda _: studio.browser.execute_script(
            "const { layers } = window.panel.viewer;"
            "return [layers.survey.geometry.getAttribute('position').count, layers.survey.visible, layers.measured.visible];"))
        self.assertGreater(drawn[0], 1000)
        self.assertEqual(drawn[1:], [True, False])
        studio.picture("15_growth")
        self.audit("plan that runs")
        studio.click("nav button[data-step=run]")
        studio.click(next(one for one in studio.browser.find_elements(By.CSS_SELECTOR, ".job[data-running=true] button")
                          if one.is_displayed()))
        studio.wait_for(lambda: not [job for job in studio.api("state")["jobs"] if job["running"]])

    def test_shows_and_holds_a_live_survey(self):
        (self.folder / "mission.yaml").write_text(MISSION % "pot")
        server = subprocess.Popen(
            [os.environ["PROGRAM"], "serve", str(self.folder / "mission.yaml"), "--survey", str(self.folder / "live"),
             "--port", "0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.addCleanup(lambda: (server.terminate(), server.wait(PATIENCE), server.stdout.close()))
        client = skycap_live.Survey(server.stdout.readline().strip())
        self.addCleanup(lambda: client.__exit__())
        first = client.next()["view"]
        studio = self.start("")
        studio.click(studio.button("live"))
        studio.wait("#live-state[data-state=running]")
        depth = [8000 if 50 < i % 160 < 110 and 30 < i // 160 < 75 else 0 for i in range(160 * 100)]
        scan = lambda: client.add_depth(struct.pack("<16000H", *depth), 160, 100, 0.001,
                                        first["position"] + first["quaternion_xyzw"])
        studio.click("#hold")
        studio.wait("#live-state[data-state=held]")
        self.assertTrue((self.folder / "live/live.hold").exists())
        with concurrent.futures.ThreadPoolExecutor() as background:
            answer = background.submit(scan)
            # The next leg is shown before the client receives it.
            frame = studio.wait("#live iframe[data-ready=true]")
            studio.wait_for(lambda: "collision-free" in studio.wait("#live table").text)
            studio.wait_for(lambda: frame.get_attribute("data-objects") == "3")  # leg, view and vehicle
            self.assertFalse(answer.done())
            studio.picture("18_held")
            self.audit("live survey that is held")
            studio.click("#resume")
            self.assertEqual(answer.result(PATIENCE)["state"], "view")
        studio.wait("#live-state[data-state=running]")
        self.assertFalse((self.folder / "live/live.hold").exists())
        self.audit("live survey")
        studio.picture("19_live")
        server.terminate()
        studio.wait("#live-state[data-state=ended]")
        self.audit("live survey that has ended")

    def test_compares_variants(self):
        (self.folder / "mission.yaml").write_text(MISSION % "pot")
        studio = self.start("mission.yaml")
        studio.click("#variants summary")
        for ending in ("_mission", "_survey_views", "_replanned", "_fly_through", "_oblique"):
            row = f"#variants tr[data-variant={ending}]"
            studio.click(row + " button")
            studio.wait_for(lambda: len(studio.browser.find_elements(By.CSS_SELECTOR, row + " button")) == 2
                            or studio.browser.find_elements(By.CSS_SELECTOR, row + " .bad"))
        studio.browser.execute_script("document.querySelector('#variants').scrollIntoView()")
        studio.picture("16_variants")
        self.audit("variants")
        row = studio.wait("#variants tr[data-variant=_replanned]")
        self.assertIn("skycap plan mission.yaml --out=results/mission_replanned --set=flight.views=replanned", row.text)
        summary = json.loads((self.folder / "results/mission_replanned/summary.json").read_text())
        minutes = sum(one["duration_s"] for one in summary["flight"]["route"]["sorties"]) / 60
        self.assertIn(f"{minutes:.1f}", row.text)
        self.assertIn(f"{100 * summary['flight']['written'][0]['coverage_visible']:.2f}%", row.text)

    def test_reloads_a_mission_that_changed_on_disk(self):
        file = self.folder / "mission.yaml"
        file.write_text(MISSION % "pot")
        studio = self.start("mission.yaml")
        area = studio.wait("#mission textarea")
        file.write_text(MISSION % "theirs")
        studio.wait_for(lambda: "name: \"theirs\"" in area.get_attribute("value"))
        self.assertIn("reloaded", studio.wait("#mission").text)
        self.audit("reloaded mission")

    def test_finds_a_command_after_the_page_was_closed_and_cancels_it(self):
        shutil.copy("missions/radcliffe_camera.yaml", self.folder / "mission.yaml")
        studio = self.start("mission.yaml")
        studio.click("#plan")
        studio.wait("#mission div[data-running=true]")
        studio.browser.get("about:blank")
        self.assertTrue([job for job in studio.api("state")["jobs"] if job["running"]])
        studio.open()
        studio.wait("#mission div[data-running=true]")  # the survey is followed again
        studio.click("nav button[data-step=run]")
        studio.wait(".job[data-running=true]")
        # The 3-D view of the survey is another job.
        studio.wait_for(lambda: "view" in "".join(
            one.text for one in studio.browser.find_elements(By.CSS_SELECTOR, ".job pre")))
        studio.picture("8_run")
        self.audit("command that runs")
        plan = next(one for one in studio.browser.find_elements(By.CSS_SELECTOR, ".job") if "skycap plan" in one.text)
        studio.click(plan.find_element(By.TAG_NAME, "button"))
        studio.wait_for(lambda: not [job for job in studio.api("state")["jobs"] if job["running"]])
        self.assertTrue((self.folder / "results/mission").exists())

    def test_works_with_the_keyboard_alone(self):
        (self.folder / "tile.gml").write_text(tile())
        studio = self.start("")
        focus = lambda: studio.browser.switch_to.active_element
        def tab_to(condition):
            for _ in range(200):
                ActionChains(studio.browser).send_keys(Keys.TAB).perform()
                if condition(focus()):
                    return focus()
            self.fail("not reached with the Tab key")
        tab_to(lambda one: one.text == "tile.gml").send_keys(Keys.ENTER)
        studio.wait("#site iframe[data-objects='3']")
        tab_to(lambda one: one.get_attribute("list") == "objects").send_keys("house_2")
        tab_to(lambda one: one.get_attribute("id") == "create").send_keys(Keys.ENTER)
        studio.wait("#plan-now")
        self.assertTrue(list(self.folder.glob("*.yaml")), studio.message())
        # An object of the airspace, without the mouse.
        tab_to(lambda one: one.get_attribute("id") == "draw-now").send_keys(Keys.ENTER)
        studio.wait(".drawing iframe[data-ready=true]")
        text = studio.browser.find_element(By.CSS_SELECTOR, "#mission textarea")
        tab_to(lambda one: one.get_attribute("data-tool") == "no_fly").send_keys(Keys.ENTER)
        tab_to(lambda one: one.text == "Enter numbers instead").send_keys(Keys.ENTER)
        studio.wait_for(lambda: "no_fly: [{corners: [[20, 20]" in text.get_attribute("value"))
        tab_to(lambda one: one.get_attribute("aria-label") == "no-fly 1 ceiling").send_keys(Keys.CONTROL + "a" + Keys.NULL + "33", Keys.TAB)
        studio.wait_for(lambda: "ceiling: 33" in text.get_attribute("value"))
        for step in ("site", "mission", "results"):
            studio.click(f"nav button[data-step={step}]")
            for summary in studio.browser.find_elements(By.CSS_SELECTOR, f"#{step} details:not([open]) > summary"):
                studio.click(summary)
            shown = [one for one in studio.browser.find_elements(
                By.CSS_SELECTOR, f"#{step} input, #{step} select, #{step} textarea, #{step} iframe")
                     if one.is_displayed()]
            self.assertTrue(shown)
            for one in shown:
                self.assertTrue(one.accessible_name, one.get_attribute("outerHTML"))

    def test_has_no_accessibility_violation(self):
        (self.folder / "mission.yaml").write_text(MISSION % "pot")
        (self.folder / "tile.gml").write_text(tile())
        run("plan", str(self.folder / "mission.yaml"), "--out", str(self.folder / "results/mission"), "--quiet")
        studio = self.start("mission.yaml")
        texts = 0
        studio.click(studio.button("Show in 3-D"))
        studio.wait(".drawing iframe[data-ready=true]")
        studio.click("#check")
        studio.wait("#mission div[data-running=false]")
        for summary in studio.browser.find_elements(By.CSS_SELECTOR, "#mission summary"):
            if summary.is_displayed():
                studio.click(summary)
        studio.wait("#variants tbody tr")
        texts += audit(self, studio.browser, "mission")
        studio.click("nav button[data-step=results]")
        Select(studio.wait("#results select")).select_by_value("results/mission")
        studio.click("#edit-views")
        studio.wait("#views option")
        studio.click("#verify")
        studio.wait("#verdict[data-exit]")
        texts += audit(self, studio.browser, "results")
        studio.picture("17_results")
        studio.click("nav button[data-step=files]")
        studio.click(studio.button("tile.gml"))
        studio.wait("#site iframe[data-objects='3']")
        studio.click("#georeference summary")
        texts += audit(self, studio.browser, "site")
        for step in ("files", "run"):
            studio.click(f"nav button[data-step={step}]")
            texts += audit(self, studio.browser, step)
        studio.click("nav button[data-step=files]")
        studio.wait("#chooser").send_keys(str(self.folder / "tile.gml"))
        studio.wait("dialog")
        texts += audit(self, studio.browser, "question")
        studio.click(studio.button("Keep it"))
        print(f"{texts} texts checked{'' if AXE else '; axe-core is not installed'}")

    def test_fits_a_small_screen(self):
        (self.folder / "mission.yaml").write_text(MISSION % "pot")
        studio = self.start("mission.yaml")
        for step in ("files", "site", "mission", "run", "results", "live"):
            studio.click(f"nav button[data-step={step}]")
            wide = studio.browser.execute_script("return document.documentElement.scrollWidth > innerWidth")
            self.assertFalse(wide, step)


if __name__ == "__main__":
    main()
