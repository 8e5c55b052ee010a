"""Tests the report of a survey through the user interface."""

import json
import math
import pathlib
import tempfile
import unittest

from chromium import HOSTILE, MISSION, Page, check_figures, main, plan, points_of_ply, run


class ReportTest(unittest.TestCase):
    """A survey whose report contains all parts, created once."""

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.results = plan(cls.folder, MISSION % "teapot", "--max-views", "6")
        # The name of a mission file contains no '/', but a summary is not trusted.
        cls.summary = json.loads((cls.results / "summary.json").read_text())
        cls.summary["mission"] = HOSTILE
        (cls.results / "summary.json").write_text(json.dumps(cls.summary))
        run("report", str(cls.results))
        cls.page = Page(cls.results / "report.html")
        cls.page.tell_first_frame(f"{cls.summary['points']} points")

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
        check_figures(self, self.page, self.summary, 30)

    def test_5_holes_sum_to_what_is_missing(self):
        total = float(self.page.all("#missing-sum")[0].get_attribute("data-area"))
        surface, belief = self.summary["surface"], self.summary["estimate"]
        self.assertAlmostEqual(total / surface["area_m2"], 1 - belief["estimated_coverage"], 4)

    def test_5b_a_click_on_a_hole_shows_it(self):
        page = self.page
        self.assertGreater(len(self.summary["surface"]["holes"]), 0)
        page.browser.execute_script("window.shown.panel.viewer.look('top', false)")
        page.browser.execute_script("window.shown.panel.set_layers(['measured', 'ground'])")
        for i, hole in enumerate(self.summary["surface"]["holes"][:len(page.all("tr.pick"))]):
            layer = "unreachable" if hole["reason"] == "unreachable" else "missing"
            page.click(f"[data-hole='{i}']")
            self.come_to_rest()
            seen = page.get(f"""(() => {{
                const {{ viewer }} = window.shown.panel;
                viewer.camera.updateMatrixWorld();
                const place = viewer.on_screen(new THREE.Vector3(...{hole["centre"]}));
                return [place.x / viewer.canvas.clientWidth, place.y / viewer.canvas.clientHeight,
                  viewer.layers["{layer}"].visible, viewer.marks.children.length]; }})()""")
            self.assertAlmostEqual(seen[0], 0.5, 1)
            self.assertAlmostEqual(seen[1], 0.5, 1)
            self.assertEqual(seen[2:], [True, 1])
        page.browser.execute_script("""
            for (const box of document.querySelectorAll("[data-layer]")) if (!box.checked) box.click();""")

    def come_to_rest(self):
        """Waits until the camera has reached the clicked object. The duration depends on the
        machine."""
        self.page.wait("""new Promise((done) => {
            const look = () => window.shown.panel.viewer.movement ? setTimeout(look, 20) : done(true);
            look(); })""")

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
        self.look_around()
        for box in page.all("[data-layer]"):
            layer = f"window.shown.panel.viewer.layers['{box.get_attribute('data-layer')}'].visible"
            before = box.is_selected()
            self.assertEqual(page.get(layer), before)
            box.click()
            self.assertNotEqual(box.is_selected(), before)
            self.assertNotEqual(page.get(layer), before)
            box.click()
            self.assertEqual(page.get(layer), before)
        self.replay()
        for row in page.all("tr.pick")[:2]:
            page.browser.execute_script("arguments[0].click()", row)
        page.browser.execute_script("window.shown.panel.tell_view(1)")
        self.assertIn("View 1", page.all(".card h3")[0].text)
        page.all(".card .close")[0].click()
        self.assertEqual(page.all(".card"), [])
        self.click_a_view_and_a_point()
        for summary in page.all("details summary"):
            page.browser.execute_script("arguments[0].click()", summary)
        page.browser.execute_script("dispatchEvent(new Event('beforeprint'))")
        self.assertEqual(len(page.all(".pictures img")), 2)
        self.assertEqual(page.complaints(), [])

    def look_around(self):
        """Checks that each button moves the camera to the side that it names."""
        page = self.page
        page.browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [
            {"name": "prefers-reduced-motion", "value": "reduce"}]})  # no animations
        seen_from = {"N": (1, 1), "E": (0, 1), "S": (1, -1), "W": (0, -1), "top": (2, 1)}
        for button in page.all("[data-look]"):
            button.click()
            self.assertLess(page.pixels()["most"], 0.999)
            away = page.get("""(({ camera, controls }) => camera.position.clone().sub(controls.target)
                .normalize().toArray())(window.shown.panel.viewer)""")
            side = button.get_attribute("data-look")
            if side in seen_from:
                axis, sign = seen_from[side]
                self.assertGreater(sign * away[axis], 0.9, side)
            else:
                self.assertTrue(away[0] < 0 and away[1] < 0 < away[2], side)
        page.browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})

    def replay(self):
        page = self.page
        slide = """
            const slider = document.getElementById("replay");
            slider.value = %s;
            slider.dispatchEvent(new Event("input"));"""
        page.browser.execute_script(slide % "0")
        self.assertIn("view 0 (0 to ", page.all(".now")[0].text)
        button = page.all("#play")[0]
        self.assertEqual(button.text, "replay")
        button.click()
        self.assertEqual(button.text, "pause")
        page.wait("new Promise((done) => setTimeout(done, 2000))")
        button.click()
        self.assertEqual(button.text, "replay")
        now = int(page.get("document.getElementById('replay').value"))
        self.assertGreater(now, 0)
        self.assertIn(f"view {now} (0 to ", page.all(".now")[0].text)
        page.browser.execute_script(slide % "slider.max")

    def click_a_view_and_a_point(self):
        """Clicks a view and a point with the mouse at their screen positions."""
        page = self.page
        self.come_to_rest()
        page.browser.execute_script("window.shown.panel.viewer.look('overview', false)")
        view, *place = page.get("""(() => {
            const { viewer, canvas } = window.shown.panel;
            viewer.draw();
            const views = window.shown.data.summary.per_view;
            for (let i = 0; i < views.length; ++i) {
              const { x, y } = viewer.on_screen(new THREE.Vector3(...views[i].position));
              if (x > 0 && y > 0 && x < canvas.clientWidth && y < canvas.clientHeight &&
                  viewer.view_at(x, y) === i) return [i, x, y];
            } })()""")
        page.click_canvas(*place)
        self.assertEqual(page.all(".card h3")[0].text, f"View {view}")
        drawn = page.get("""(() => {
            const canvas = document.querySelector(".card canvas");
            const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
            return data.filter((value, i) => i % 4 === 1 && value > 60).length / (data.length / 4); })()""")
        self.assertGreater(drawn, 0.01)  # the points measured from the view
        page.all(".card .close")[0].click()
        page.click("[data-layer='views']")
        x, y = page.get("[0, 1].map((i) => window.shown.panel.canvas[i ? 'clientHeight' : 'clientWidth'] / 2)")
        page.click_canvas(x, y)
        self.assertEqual(page.all(".card h3")[0].text, "Point")
        told = [float(part) for part in page.all(".card dd")[0].text.split(",")]
        off = page.browser.execute_script("""
            const { viewer } = window.shown.panel, [told, x, y] = arguments;
            const seen = viewer.on_screen(new THREE.Vector3(...told));
            return Math.hypot(seen.x - x, seen.y - y);""", told, x, y)
        self.assertLess(off, 10)  # within the click radius, shown to 1 cm
        page.all(".card .close")[0].click()
        page.click("[data-layer='views']")

    def test_7b_the_route_keeps_off_the_end_of_free_space(self):
        page = self.page
        nearest = page.get("""(() => {
            const { count, positions } = window.shown.clouds.free, { data } = window.shown;
            let least = Infinity;
            for (const sortie of data.summary.flight.route.sorties) {
              for (const [x, y, z] of sortie.legs.flatMap((leg) => leg.points)) {
                for (let i = 0; i < 3 * count; i += 3) {
                  least = Math.min(least, Math.hypot(positions[i] - x, positions[i + 1] - y, positions[i + 2] - z));
                }
              }
            }
            return [count, least, data.clouds.free.step, data.summary.flight.clearance_m.total]; })()""")
        count, least, step, asked = nearest
        self.assertGreater(count, 100)
        self.assertGreaterEqual(least, asked - step)  # grid spacing
        before = page.pixels()
        page.click("[data-layer='free']")
        self.assertNotEqual(page.pixels(), before)
        page.click("[data-layer='free']")

    def test_8_measures_a_distance(self):
        page = self.page
        page.browser.execute_script("window.shown.panel.viewer.look('S', false)")
        page.all("#measure")[0].click()
        # Two points that are not hidden.
        places = page.get("""(() => {
            const { viewer } = window.shown.panel, { positions, count } = viewer.main, found = [];
            viewer.camera.updateMatrixWorld();
            for (let i = 0; i < count && found.length < 2; i += 7) {
              const place = Array.from(positions.subarray(3 * i, 3 * i + 3));
              const { x, y } = viewer.on_screen(new THREE.Vector3(...place)), hit = viewer.point_at(x, y);
              const is_far = !found.length || Math.hypot(...place.map((v, k) => v - found[0].place[k])) > 3;
              if (hit && hit.name === "measured" && hit.index === i && is_far) found.push({ x, y, place });
            }
            return found; })()""")
        for place in places:
            page.click_canvas(place["x"], place["y"])
        self.assertIn("Distance", page.all(".card h3")[0].text)
        told = [float(value.text.replace("\u2009", "").split()[0]) for value in page.all(".card dd")]
        one, other = (place["place"] for place in places)
        self.assertAlmostEqual(told[0], math.dist(one, other), delta=0.006)  # two decimals are shown
        self.assertAlmostEqual(told[1], math.dist(one[:2], other[:2]), delta=0.006)
        self.assertAlmostEqual(told[2], other[2] - one[2], delta=0.006)
        page.all("#measure")[0].click()
        self.assertEqual(page.all(".card"), [])

    def test_9_works_in_the_hand(self):
        page = Page(self.results / "report.html", 390, 844)
        try:
            self.assertIsNone(page.failure)
            self.assertGreater(page.pixels()["colours"], 100)
            self.assertEqual(page.get("document.documentElement.clientWidth"), 390)
            self.assertEqual(page.get("document.documentElement.scrollWidth"), 390)
            self.assertEqual(page.complaints(), [])
        finally:
            page.close()


class FleetReportTest(unittest.TestCase):
    """The report of a fleet contains the data of the summary."""

    def test_each_vehicle_has_its_way_its_row_and_its_times(self):
        with tempfile.TemporaryDirectory() as temporary:
            results = plan(pathlib.Path(temporary), (MISSION % "teapot").replace("vehicle: m350_rtk, ", ""),
                           "--set", "flight.vehicles=[generic, generic]",
                           "--set", "flight.pads=[[-12, -12, 0], [12, 12, 0]]")
            summary = json.loads((results / "summary.json").read_text())
            fleet = summary["flight"]["fleet"]
            page = Page(results / "report.html")
            try:
                self.assertIsNone(page.failure)
                check_figures(self, page, summary, 30)
                page.browser.execute_script("document.getElementById('view').scrollIntoView()")
                shown = "window.shown.panel.viewer.layers['%s'].visible"
                self.assertEqual([page.get(shown % "fleet"), page.get(shown % "route")], [True, False])
                together = page.pixels()
                page.click("[data-layer='fleet']")
                self.assertNotEqual(page.pixels(), together)
                files = {file.text for file in page.all("#files td:first-child")}
                self.assertLessEqual({"timetable.csv"} | {row["file"] for row in fleet["timetable"]}, files)
                text = page.get("document.getElementById('flight').textContent")
                for row in fleet["timetable"]:
                    self.assertIn(f"{row['landing_s']:.1f} s", text)
                flown = sorted(view for vehicle in fleet["vehicles"] for view in vehicle["order"])
                self.assertEqual(flown, sorted(summary["flight"]["route"]["order"]))
                self.assertEqual(page.complaints(), [])
            finally:
                page.close()


if __name__ == "__main__":
    main()
