"""The page of a survey, seen as a customer sees it."""

import json
import math
import pathlib
import tempfile
import unittest

from chromium import HOSTILE, MISSION, Page, check_figures, main, plan, points_of_ply, run


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
        check_figures(self, self.page, self.summary, 30)

    def test_5_holes_sum_to_what_is_missing(self):
        total = float(self.page.all("#missing-sum")[0].get_attribute("data-area"))
        surface, belief = self.summary["surface"], self.summary["belief"]
        self.assertAlmostEqual(total / surface["area_m2"], 1 - belief["predicted_coverage"], 4)

    def test_5b_a_click_on_a_hole_shows_it(self):
        page = self.page
        self.assertGreater(len(self.summary["surface"]["holes"]), 0)
        page.browser.execute_script("window.shown.panel.viewer.look('top', false)")
        page.browser.execute_script("window.shown.panel.set_layers(['measured', 'ground'])")
        for i, hole in enumerate(self.summary["surface"]["holes"]):
            layer = "unreachable" if hole["reason"] == "unreachable" else "missing"
            page.click(f"[data-hole='{i}']")
            page.wait("new Promise((done) => setTimeout(done, 900))")  # it flies there
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


if __name__ == "__main__":
    main()
