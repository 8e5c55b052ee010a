"""Pages with little, much or foreign things in them, and those of other verbs."""

import json
import math
import pathlib
import tempfile
import time
import unittest

from chromium import (HOSTILE, MISSION, JavascriptException, Page, check_figures, main, plan, run,
                      write_scaled)


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

    def test_an_empty_survey(self):
        results = plan(self.folder, MISSION % "nothing", "--max-views", "2")
        summary = json.loads((results / "summary.json").read_text())
        summary.update(views=0, points=0, per_view=[], stop_reason="interrupted", complete=False)
        for key in ("flight", "surface", "belief"):
            summary.pop(key)
        (results / "summary.json").write_text(json.dumps(summary))
        for name in ("cloud.ply", "coverage.ply"):
            (results / name).unlink()
        run("report", str(results))
        self.assertIn("it was interrupted", self.shows(results / "report.html"))

    def test_many_views_and_points(self):
        """Of 2 million points the page shows one; 200 views can be replayed."""
        results = plan(self.folder, MISSION % "many")
        write_scaled(results, 200, 2_000_000)
        run("report", str(results))
        page = Page(results / "report.html")
        try:
            self.assertIsNone(page.failure)
            self.assertEqual(page.get("window.shown.clouds.measured.count"), 1_000_000)
            self.assertEqual(page.get("window.shown.data.clouds.measured.of"), 2_000_000)
            self.assertGreater(page.pixels()["colours"], 500)
            page.browser.execute_script("window.shown.panel.set_colour('density')")
            self.assertGreater(page.pixels()["colours"], 500)
            page.browser.execute_script("window.shown.panel.show_view(100)")
            self.assertIn("view 100 of 199", page.all(".now")[0].text)
            self.assertEqual(page.complaints(), [])
        finally:
            page.close()

    def test_trials_and_comparisons(self):
        mission = self.folder / "mission.yaml"
        mission.write_text(MISSION % "teapot")
        out = self.folder / "out"
        options = ["--max-views", "4", "--quiet", "--out", str(out)]
        run("plan", str(mission), "--trials", "3", *options)
        run("benchmark", str(mission), "--planners", "see,see++,skycap", "--trials", "2", *options)
        for name, data, charts in (("trials", "trials", 4), ("benchmark", "results", 9)):
            summary = json.loads((out / f"{data}.json").read_text())
            # A name in a file of results may come from anywhere.
            cell = summary["results"][0] if "results" in summary else summary
            cell["mission"] = HOSTILE
            (out / f"{data}.json").write_text(json.dumps(summary))
            run("report", str(out))
            page = Page(out / f"{name}.html")
            try:
                self.assertIsNone(page.failure)
                check_figures(self, page, summary, 20)
                self.assertIn("</script>", page.get("document.body.innerText"))
                self.assertEqual(page.all("img"), [])
                self.assertGreaterEqual(len(page.all(".chart canvas")), charts)
                blank = page.get("""Array.from(document.querySelectorAll(".chart canvas"), (canvas) =>
                    canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data
                      .every((value) => value === 0)).filter(Boolean).length""")
                self.assertEqual(blank, 0)
                self.assertEqual(page.complaints(), [])
            finally:
                page.close()

    def test_scans(self):
        """A laser's and a camera's, whose navigation is wrong by some 0.2 m."""
        mission = self.folder / "mission.yaml"
        # The carrier goes round to the left: a camera has to look there.
        for sensor, turned in (("velodyne_vlp16", 0), ("see_d435", 90)):
            out = self.folder / sensor
            mission.write_text("""
name: %s
scene: {model: 'builtin:teapot', longest_side: 10.0}
evaluation: {registration_distance: 0.2}
scan: {sensor: %s, frame_period: 1.0, navigation: {horizontal_sigma: 0.2},
       mount: {rotation_deg: [0, 0, %d]},
       orbit: {radius: 12, lowest: 3, circles: 1, speed: 20}}
""" % (json.dumps(HOSTILE.replace("/", "")), sensor, turned))
            run("scan", str(mission), "--out", str(out), "--quiet")
            page = Page(out / "scan.html")
            try:
                self.assertIsNone(page.failure)
                check_figures(self, page, json.loads((out / "scan.json").read_text()), 2)
                self.assertGreater(page.pixels()["colours"], 500)
                for mode in ("time", "height", "incidence", "density"):
                    page.browser.execute_script("window.shown.panel.set_colour(arguments[0])", mode)
                    self.assertEqual(page.get("document.getElementById('colour').value"), mode)
                    self.assertGreater(page.pixels()["colours"], 100, mode)
                page.browser.execute_script("window.shown.panel.show_view(1)")
                self.assertIn(" 1 of ", page.all(".now")[0].text)
                self.assertEqual(page.get("window.shown.data.trajectory.believed.points.length"),
                                 page.get("window.shown.data.trajectory.flown.points.length"))
                self.assertEqual(page.all("img"), [])
                self.assertEqual(page.complaints(), [])
            finally:
                page.close()

    def test_a_survey_that_goes_on(self):
        """Its page is read again when the next scan is in, and stays as it was turned."""
        mission = self.folder / "mission.yaml"
        mission.write_text("".join(line for line in (MISSION % "live").splitlines(True)
                                   if not line.startswith("flight:")))
        survey = self.folder / "survey"
        call = ["next", str(mission), "--survey", str(survey), "--quiet", "--json"]
        answer = json.loads(run(*call).stdout)
        page = None
        try:
            for number in range(3):
                self.measure(call, answer["view"], number)
                if page is None:
                    page = Page(survey / "report.html")
                    self.assertIsNone(page.failure)
                    page.browser.execute_script("""
                        const { panel } = window.shown;
                        panel.viewer.look("N", false);
                        panel.set_colour("height");""")
                    turned = page.get("window.shown.panel.viewer.camera.position.toArray()")
                self.wait_for(page, f"document.body.innerText.includes('{number + 1} scan')")
                answer = json.loads(run(*call).stdout)
            self.wait_for(page, "window.shown")
            self.assertEqual(page.get("document.getElementById('colour').value"), "height")
            for now, before in zip(page.get("window.shown.panel.viewer.camera.position.toArray()"), turned):
                self.assertAlmostEqual(now, before, 3)
            self.assertGreater(page.pixels()["colours"], 100)
            run("finish", str(mission), "--survey", str(survey))
            self.wait_for(page, "!document.getElementById('follow') && document.getElementById('files')")
            self.assertEqual(page.complaints(), [])
        finally:
            if page:
                page.close()

    def measure(self, call, view, number):
        """Hands in a cloud: the teapot's upper half-shell as spheres would have it, from the view."""
        points = []
        for i in range(4000):
            z = 0.2 + 4.6 * ((i * 0.6180339887) % 1.0)
            angle = 2.399963 * i
            radius = math.sqrt(max(0.0, 9.0 - (z - 2.0) ** 2))
            points.append(f"{radius * math.cos(angle)} {radius * math.sin(angle)} {z}\n")
        cloud = self.folder / f"scan_{number}.xyz"
        cloud.write_text("".join(points))
        pose = " ".join(str(x) for x in view["position"] + view["quaternion_xyzw"])
        run(*call, "--scan", str(cloud), "--pose", pose, "--world", "--id", f"scan {number}")

    def wait_for(self, page, condition):
        """Until it holds, in whatever page is there by then."""
        deadline = time.monotonic() + 120
        while time.monotonic() < deadline:
            try:
                page.browser.execute_async_script("const done = arguments[0];"
                    "window.skycap.then((s) => { window.shown = s; done(); }, done);")
                if page.get(f"Boolean({condition})"):
                    return
            except JavascriptException:
                pass  # the page is being read
            time.sleep(0.2)
        self.fail(f"never: {condition}")


if __name__ == "__main__":
    main()
