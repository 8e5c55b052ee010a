"""Tests skycap studio with real clicks in a browser: from a city model tile to an exported flight."""

import json
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import unittest
import urllib.request
import zipfile

from chromium import CHROMIUM, DRIVER, FLAGS, MISSION, main, run  # skips without selenium

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
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


def tile():
    return ('<?xml version="1.0"?><core:CityModel xmlns:core="http://www.opengis.net/citygml/2.0" '
            'xmlns:bldg="http://www.opengis.net/citygml/building/2.0" '
            'xmlns:gml="http://www.opengis.net/gml">'
            + "".join(building(f"house_{i}", 45.0 * i) for i in range(3)) + "</core:CityModel>\n")


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
        return WebDriverWait(self.browser, PATIENCE, 0.05).until(
            lambda browser: next((one for one in browser.find_elements(By.CSS_SELECTOR, selector)
                                  if one.is_displayed()), None), selector)

    def wait_for(self, condition):
        return WebDriverWait(self.browser, PATIENCE, 0.05).until(lambda _: condition())

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
            self.assertEqual(self.studio.complaints(), [])
            self.assertEqual(self.studio.close(), 0)
        self.temporary.cleanup()

    def start(self, what):
        self.studio = Studio(self.folder / what, self.folder)
        return self.studio

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
        self.assertEqual(file.read_text(), MISSION % "theirs")
        studio.click(studio.button("Keep this text and replace the file"))
        studio.wait_for(lambda: "name: mine" in file.read_text())

    def test_finds_a_command_after_the_page_was_closed_and_cancels_it(self):
        shutil.copy("missions/radcliffe_camera.yaml", self.folder / "mission.yaml")
        studio = self.start("mission.yaml")
        studio.click("#plan")
        studio.wait("#mission div[data-running=true]")
        studio.browser.get("about:blank")
        self.assertTrue([job for job in studio.api("state")["jobs"] if job["running"]])
        studio.open()
        studio.click("nav button[data-step=run]")
        studio.wait(".job[data-running=true]")
        studio.wait_for(lambda: "view" in studio.wait(".job pre").text)
        studio.picture("8_run")
        studio.click(studio.button("Cancel"))
        studio.wait(".job[data-running=false]")
        self.assertTrue((self.folder / "results/mission").exists())

    def test_works_with_the_keyboard_alone(self):
        (self.folder / "tile.gml").write_text(tile())
        studio = self.start("")
        focus = lambda: studio.browser.switch_to.active_element
        def tab_to(condition):
            for _ in range(200):
                focus().send_keys(Keys.TAB)
                if condition(focus()):
                    return focus()
            self.fail("not reached with the Tab key")
        tab_to(lambda one: one.text == "tile.gml").send_keys(Keys.ENTER)
        studio.wait("#site iframe[data-objects='3']")
        tab_to(lambda one: one.get_attribute("list") == "objects").send_keys("house_2")
        tab_to(lambda one: one.get_attribute("id") == "create").send_keys(Keys.ENTER)
        studio.wait("#plan-now")
        self.assertTrue(list(self.folder.glob("*.yaml")), studio.message())
        for step in ("site", "mission", "results"):
            studio.click(f"nav button[data-step={step}]")
            for summary in studio.browser.find_elements(By.CSS_SELECTOR, f"#{step} summary"):
                studio.click(summary)
            shown = [one for one in studio.browser.find_elements(
                By.CSS_SELECTOR, f"#{step} input, #{step} select, #{step} textarea, #{step} iframe")
                     if one.is_displayed()]
            self.assertTrue(shown)
            for one in shown:
                self.assertTrue(one.accessible_name, one.get_attribute("outerHTML"))

    def test_fits_a_small_screen(self):
        (self.folder / "mission.yaml").write_text(MISSION % "pot")
        studio = self.start("mission.yaml")
        for step in ("files", "site", "mission", "run", "results"):
            studio.click(f"nav button[data-step={step}]")
            wide = studio.browser.execute_script("return document.documentElement.scrollWidth > innerWidth")
            self.assertFalse(wide, step)


if __name__ == "__main__":
    main()
