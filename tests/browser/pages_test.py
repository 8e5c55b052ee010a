"""Tests reports with little, much or foreign content, and those of other commands."""

import array
import collections
import json
import math
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

from chromium import (HOSTILE, MISSION, JavascriptException, Page, check_figures, colours_of_ply,
                      main, plan, run, write_scaled)


class OtherPagesTest(unittest.TestCase):
    """Reports with little or no content, and those of skycap view."""

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

    def test_prior_data(self):
        """Prior data can be hidden. Data that are too large are not drawn, with a note on the
        page."""
        (self.folder / "few.obj").write_text("v 20 0 0\nv 21 0 0\nv 20 1 0\nv 20 0 9\n"
                                             "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
        side = 101  # 20,000 triangles are drawn
        corners = "".join(f"v {i % side} {i // side} 0\n" for i in range(side * side))
        faces = "".join(f"f {i} {i + 1} {i + side + 1}\nf {i} {i + side + 1} {i + side}\n"
                        for row in range(side - 1) for i in range(row * side + 1, row * side + side))
        (self.folder / "many.obj").write_text(corners + faces + "f 1 2 103\n")
        (self.folder / "mission.yaml").write_text(MISSION % "priors" +
            "prior: [{file: few.obj, role: obstacle}, {file: many.obj, role: terrain}]\n")
        run("view", str(self.folder / "mission.yaml"), "--out", str(self.folder / "m.html"))
        page = Page(self.folder / "m.html")
        try:
            self.assertIsNone(page.failure)
            legend = page.all(".legend")[0].text
            self.assertIn("prior: obstacle", legend)
            self.assertNotIn("prior: terrain", legend)
            self.assertIn("many.obj has too many triangles to display", legend)
            page.click("[data-layer='priors']")
            self.assertEqual(page.get("window.shown.panel.viewer.layers.priors.visible"), False)
            self.assertEqual(page.complaints(), [])
        finally:
            page.close()

    def test_a_file_with_a_hostile_name(self):
        cloud = self.folder / "<img src=x>'\".xyz"
        cloud.write_text("0 0 0\n1 0 0\n0 1 0\n")
        run("view", str(cloud))
        page = Page(cloud.with_suffix(".html"))
        try:
            self.assertIsNone(page.failure)
            self.assertEqual(page.get("document.querySelector('h1').textContent"), cloud.name)
            self.assertEqual(page.all("img"), [])
            self.assertEqual(page.complaints(), [])
        finally:
            page.close()

    def test_a_cloud_of_one_point(self):
        """A cloud of one point has no spacing and therefore no density."""
        cloud = self.folder / "one.xyz"
        cloud.write_text("1 2 3\n")
        run("view", str(cloud))
        page = Page(self.folder / "one.html")
        try:
            self.assertIsNone(page.failure)
            self.assertIn("1 point", page.get("document.querySelector('.facts').textContent"))
            page.browser.execute_script("window.shown.panel.set_colour('density')")
            self.assertEqual(page.get("window.shown.clouds.measured.density[0]"), 0)
            self.assertEqual(page.pixels()["error"], 0)
            self.assertEqual(page.complaints(), [])
        finally:
            page.close()

    def test_maps_of_coverage_have_their_colours(self):
        results = plan(self.folder, MISSION % "maps")
        for name in ("coverage.ply", "true_coverage.ply"):
            run("view", str(results / name))
            page = Page((results / name).with_suffix(".html"))
            try:
                self.assertIsNone(page.failure)
                self.assertEqual(page.get("document.getElementById('colour').value"), "file")
                written = colours_of_ply(results / name)
                drawn = page.get("""Array.from(window.shown.panel.viewer.layers.measured.geometry
                    .getAttribute("colour").array)""")
                self.assertEqual(collections.Counter(zip(drawn[::3], drawn[1::3], drawn[2::3])),
                                 collections.Counter(written))
                self.assertEqual(page.complaints(), [])
            finally:
                page.close()

    def test_more_points_than_a_page_shows(self):
        """Uses three million points. POINTS=10000000 in the environment sets another number."""
        count = 100_000
        layers = int(os.environ.get("POINTS", 3_000_000)) // count
        one = array.array("f", [0.0]) * (3 * count)
        one[0::3] = array.array("f", (10 * math.cos(i / 1000 * math.tau) for i in range(count)))
        one[1::3] = array.array("f", (10 * math.sin(i / 1000 * math.tau) for i in range(count)))
        with open(self.folder / "many.ply", "wb") as file:
            file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {count * layers}\n"
                       "property float x\nproperty float y\nproperty float z\nend_header\n".encode())
            for layer in range(layers):
                one[2::3] = array.array("f", (0.0005 * (layer + layers * (i // 1000)) for i in range(count)))
                one.tofile(file)
        started = time.monotonic()
        run("view", str(self.folder / "many.ply"))
        print(f"{count * layers} points: written in {time.monotonic() - started:.1f} s")
        page = Page(self.folder / "many.html")
        try:
            self.assertIsNone(page.failure)
            page.tell_first_frame(f"1 million points of {count * layers}")
            self.assertEqual(page.get("window.shown.data.clouds.measured.of"), count * layers)
            self.assertEqual(page.get("window.shown.clouds.measured.count"), 1_000_000)
            self.assertGreater(page.pixels()["colours"], 100)
            self.assertEqual(page.complaints(), [])
        finally:
            page.close()

    def test_an_interrupted_survey(self):
        mission = self.folder / "mission.yaml"
        mission.write_text(MISSION.replace("max_views: 12", "max_views: 400")
                                  .replace("density: 100", "density: 1000") % "stopped")
        survey = subprocess.Popen(
            [os.environ["PROGRAM"], "plan", str(mission), "--out", str(self.folder / "out"), "--verbose"],
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        for line in survey.stderr:
            if line.split()[:1] == ["2"]:  # the row of the third view
                survey.send_signal(signal.SIGINT)
                break
        survey.stderr.read()
        self.assertEqual(survey.wait(), 1)
        survey.stderr.close()
        subprocess.run([os.environ["PROGRAM"], "report", str(self.folder / "out")], check=True,
                       stdout=subprocess.DEVNULL)
        page = self.shows(self.folder / "out" / "report.html")
        self.assertIn("incomplete: interrupted", page)

    def test_an_empty_survey(self):
        results = plan(self.folder, MISSION % "nothing", "--max-views", "2")
        summary = json.loads((results / "summary.json").read_text())
        summary.update(views=0, points=0, per_view=[], stop_reason="interrupted", complete=False)
        for key in ("flight", "surface", "estimate"):
            summary.pop(key)
        (results / "summary.json").write_text(json.dumps(summary))
        for name in ("cloud.ply", "coverage.ply"):
            (results / name).unlink()
        run("report", str(results))
        self.assertIn("incomplete: interrupted", self.shows(results / "report.html"))

    def test_many_views_and_points(self):
        """The page shows one of 2 million points. 200 views can be replayed."""
        results = plan(self.folder, MISSION % "many")
        write_scaled(results, 200, 2_000_000)
        run("report", str(results))
        page = Page(results / "report.html")
        try:
            self.assertIsNone(page.failure)
            page.tell_first_frame("1 million points of 2 million")
            self.assertEqual(page.get("window.shown.clouds.measured.count"), 1_000_000)
            self.assertEqual(page.get("window.shown.data.clouds.measured.of"), 2_000_000)
            self.assertGreater(page.pixels()["colours"], 500)
            page.browser.execute_script("window.shown.panel.set_colour('density')")
            self.assertGreater(page.pixels()["colours"], 500)
            page.browser.execute_script("window.shown.panel.show_view(100)")
            self.assertIn("view 100 (0 to 199)", page.all(".now")[0].text)
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
            # Names in result files are not trusted.
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

    def test_a_district(self):
        script = pathlib.Path(__file__).parents[1] / "benchmarks" / "district_city.py"
        town = subprocess.run([sys.executable, script, "3"], check=True, capture_output=True).stdout
        (self.folder / "town.city.json").write_bytes(town)
        quarter = self.folder / "quarter.yaml"
        quarter.write_text("map: town.city.json\nvertical: ellipsoid\nmerge_distance: 0\n"
                           "targets: {id: [house_0000, house_0001]}\n"
                           "set: {limits.max_views: 2, evaluation.samples: 2000,\n"
                           "      evaluation.visible_directions: 20, evaluation.attainable_views: 0}\n")
        out = self.folder / "out"
        run("district", str(quarter), "--quiet", "--out", str(out))
        summary = json.loads((out / "district.json").read_text())
        summary["district"] = summary["targets"][1]["title"] = HOSTILE
        (out / "district.json").write_text(json.dumps(summary))
        run("report", str(out))
        page = Page(out / "district.html")
        try:
            self.assertIsNone(page.failure)
            check_figures(self, page, summary, 20)
            self.assertEqual(len(page.all("svg.map .target")), 2)
            self.assertEqual(len(page.all("svg.map .pad")), len(summary["pads"]))
            self.assertIn("</script>", page.get("document.body.innerText"))
            self.assertEqual(page.all("img"), [])
            links = page.get("Array.from(document.querySelectorAll('#targets a'), "
                             "(link) => link.getAttribute('href'))")
            self.assertEqual(len(links), 2)
            for link in links:
                self.assertTrue((out / link).is_file(), link)
            self.assertEqual(page.complaints(), [])
        finally:
            page.close()

    def test_a_flight_compared_with_its_plan(self):
        results = plan(self.folder, MISSION % "flown")
        rows = (results / "mission.csv").read_text().splitlines()
        log = self.folder / "aborted.csv"
        log.write_text("\n".join(rows[:len(rows) // 2]) + "\n")
        run("compare", str(results), str(log))
        text = self.shows(results / "compare" / "compare.html")
        for words in ("Flight compared with its plan", "Missed captures", "not flown", "Patch mission",
                      "Distance to the surface"):
            self.assertIn(words.lower(), text.lower())

    def test_scans(self):
        """Scans of a laser and a camera with navigation errors of about 0.2 m."""
        mission = self.folder / "mission.yaml"
        # The platform flies around the scene with its left side facing it, so the camera must look left.
        for sensor, turned in (("velodyne_vlp16", 0), ("see_d435", 90)):
            out = self.folder / sensor
            mission.write_text("""
name: %s
scene: {model: 'builtin:teapot', longest_side: 10.0}
evaluation: {coverage_distance: 0.2}
scan: {sensor: %s, frame_period: 1.0, navigation: {horizontal_sigma: 0.2},
       mount: {rotation_deg: [0, 0, %d]},
       orbit: {radius: 12, min_height: 3, circles: 1, speed: 20}}
""" % (sensor, sensor, turned))
            run("scan", str(mission), "--out", str(out), "--quiet")
            summary = {**json.loads((out / "scan.json").read_text()), "mission": HOSTILE}
            (out / "scan.json").write_text(json.dumps(summary))
            run("report", str(out))
            page = Page(out / "scan.html")
            try:
                self.assertIsNone(page.failure)
                self.assertEqual(page.get("document.querySelector('h1').textContent"), HOSTILE)
                check_figures(self, page, summary, 2)
                self.assertGreater(page.pixels()["colours"], 500)
                for mode in ("time", "height", "incidence", "density"):
                    page.browser.execute_script("window.shown.panel.set_colour(arguments[0])", mode)
                    self.assertEqual(page.get("document.getElementById('colour').value"), mode)
                    self.assertGreater(page.pixels()["colours"], 100, mode)
                page.browser.execute_script("window.shown.panel.show_view(1)")
                self.assertIn(" 1 (0 to ", page.all(".now")[0].text)
                self.assertEqual(page.get("window.shown.data.trajectory.believed.points.length"),
                                 page.get("window.shown.data.trajectory.flown.points.length"))
                self.assertEqual(page.all("img"), [])
                self.assertEqual(page.complaints(), [])
            finally:
                page.close()

    def test_a_survey_that_goes_on(self):
        """The page of a running survey reloads after the next scan and keeps the user's view, until
        the survey is finished."""
        mission = self.folder / "mission.yaml"
        mission.write_text("".join(line for line in (MISSION % "live").splitlines(True)
                                   if not line.startswith("flight:"))
                           .replace("max_views: 12", "max_views: 4"))
        survey = self.folder / "survey"
        call = ["next", str(mission), "--survey", str(survey), "--quiet", "--json"]
        answer = json.loads(run(*call).stdout)
        page = None
        # Actions that prevent a reload, and actions that allow it again.
        follow = "document.getElementById('follow')"
        replay = "document.getElementById('replay')"
        slide = "(%s.value = '%d', %s.dispatchEvent(new Event('input')))"
        at_rest = {2: (slide % (replay, 0, replay), slide % (replay, 1, replay)),
                   3: (f"({follow}.click(), {follow}.textContent.startsWith('paused'))", f"{follow}.click()")}
        try:
            for number in range(4):
                if number in at_rest:
                    self.wait_for(page, at_rest[number][0])
                self.measure(call, answer["view"], number)
                if page is None:
                    for verb in ("report", "view"):  # these commands link to it
                        self.assertIn(str(survey / "report.html"), run(verb, str(survey)).stdout)
                    page = Page(survey / "report.html")
                    self.assertIsNone(page.failure)
                    page.browser.execute_script("""
                        const { panel } = window.shown;
                        panel.viewer.look("N", false);
                        panel.set_colour("height");
                        panel.set_layers(["measured", "views", "missing"]);
                        delete panel.viewer.layers.views;  // as if it came later""")
                    turned = page.get("window.shown.panel.viewer.camera.position.toArray()")
                if number in at_rest:
                    time.sleep(2 * 5)  # twice the page's reload period
                    self.assertIn(f"{number} scans so far", page.get("document.body.innerText"))
                    page.browser.execute_script(at_rest[number][1])
                self.wait_for(page, f"document.body.innerText.includes('{number + 1} scan')")
                answer = json.loads(run(*call).stdout)
            self.assertEqual(answer["state"], "view_limit")
            self.wait_for(page, "document.body.innerText.includes('run skycap finish to write the package')")
            self.assertEqual(page.get("""["ground", "views"].map((name) =>
                window.shown.panel.viewer.layers[name].visible)"""), [False, True])
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
        """Adds a cloud to the survey: the upper half-shell of the teapot, approximated by spheres,
        from the view."""
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
        """Waits until the condition holds, also across reloads of the page."""
        deadline = time.monotonic() + 120
        while time.monotonic() < deadline:
            try:
                page.browser.execute_async_script("const done = arguments[0];"
                    "window.skycap.then((s) => { window.shown = s; done(); }, done);")
                if page.get(f"Boolean({condition})"):
                    return
            except JavascriptException:
                pass  # the page is reloading
            time.sleep(0.2)
        self.fail(f"never: {condition}")


if __name__ == "__main__":
    main()
