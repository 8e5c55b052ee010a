"""Surveys from Python are bitwise equal to those of the program."""

import concurrent.futures
import subprocess
import sys
import threading
import time
import unittest

import skycap
from small_mission import SmallMission


class WholeSurvey(SmallMission):
    def test_writes_the_bytes_of_the_program(self):
        for planner in ("skycap", "see++"):
            by_program = self.folder / "program"
            by_python = self.folder / "python"
            ran = self.run_program("plan", self.file, "--planner", planner, "--quiet", "--out",
                                   by_program)
            self.assertEqual((ran.returncode, ran.stderr), (0, ""))
            survey = skycap.plan(self.load(planner__name=planner), out=by_python)
            for name in ("cloud.ply", "coverage.ply", "views.csv", "trajectory.tum"):
                self.assertEqual((by_python / name).read_bytes(), (by_program / name).read_bytes(),
                                 f"{planner}: {name}")
            self.assertAlmostEqual(survey.summary["coverage"], survey.coverage)
            self.assertEqual(survey.end, "view_limit")

    def test_tells_of_each_view(self):
        told = []
        survey = skycap.plan(self.load(), progress=lambda view, coverage: told.append(
            (view.points, coverage)))
        self.assertEqual([points for points, _ in told], [view.points for view in survey.views])
        self.assertEqual([coverage for _, coverage in told], survey.coverages.tolist())
        self.assertEqual(len(survey.cloud), survey.views[-1].points)
        self.assertEqual(survey.cloud.xyz.shape, (len(survey.cloud), 3))

    def test_ends_with_what_its_listener_raises(self):
        def refuse(view, coverage):
            raise LookupError(f"seen {view.points}")

        with self.assertRaisesRegex(LookupError, "^seen [1-9]"):
            skycap.plan(self.load(), progress=refuse)

    def test_lets_other_threads_go_on(self):
        mission = self.load(sensor__width=640, sensor__height=480)
        worker = threading.Thread(target=skycap.plan, args=[mission])
        worker.start()
        ticks = 0
        while worker.is_alive():
            time.sleep(0.001)
            ticks += 1
        self.assertGreater(ticks, 10)

    def test_hears_an_interrupt_and_leaves_what_there_is(self):
        out = self.folder / "interrupted"
        script = (
            "import os, signal, sys, time, skycap\n"
            "def interrupt(view, coverage):\n"
            "    if view.distance == 0.0: os.kill(os.getpid(), signal.SIGINT); time.sleep(0.5)\n"
            "mission = skycap.Mission.load(sys.argv[1], {'limits.max_views': 200})\n"
            "try:\n"
            "    skycap.plan(mission, out=sys.argv[2], progress=interrupt)\n"
            "except KeyboardInterrupt:\n"
            "    sys.exit(7)\n")
        ran = subprocess.run([sys.executable, "-c", script, self.file, out], check=False)
        self.assertEqual(ran.returncode, 7)
        self.assertIn('"interrupted"', (out / "summary.json").read_text())
        # Header, the first view, and possibly the view that was being planned.
        self.assertLessEqual(len((out / "views.csv").read_text().splitlines()), 3)


class OwnLoop(SmallMission):
    def survey_of(self, mission, views):
        simulation = skycap.Simulation(mission)
        planner = skycap.Planner(mission)
        view, taken = simulation.first_view, []
        while view and len(taken) < views:
            view_taken = view
            view = planner.next_view(*simulation.scan(view_taken, len(taken)))
            taken.append((view_taken.position.tolist(), planner.last_step.points_new))
        return taken, planner.cloud().xyz.tobytes()

    def test_goes_the_way_of_the_whole_survey(self):
        mission = self.load()
        survey = skycap.plan(mission)
        taken, cloud = self.survey_of(mission, 3)
        self.assertEqual([(taken.view.position.tolist(), taken.step.points_new)
                          for taken in survey.views], taken)
        self.assertEqual(survey.cloud.xyz.tobytes(), cloud)

    def test_goes_the_same_way_in_several_threads_at_once(self):
        mission = self.load()
        expected = self.survey_of(mission, 3)
        found = []
        workers = [threading.Thread(target=lambda: found.append(self.survey_of(mission, 3)))
                   for _ in range(4)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        self.assertEqual(found, 4 * [expected])

    def test_takes_calls_of_several_threads_one_after_the_other(self):
        mission = self.load()
        simulation = skycap.Simulation(mission)
        planner = skycap.Planner(mission)
        scan = simulation.scan(simulation.first_view, 0)
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            calls = [pool.submit(planner.next_view, *scan) for _ in range(4)]
        self.assertEqual([call.exception() for call in calls], 4 * [None])
        self.assertEqual(set(planner.cloud().views.tolist()), {0})  # the other views added no points


if __name__ == "__main__":
    unittest.main()
