"""A mission that is surveyed in one second, and the program, for the tests in this folder."""

import os
import pathlib
import subprocess
import tempfile
import unittest

import skycap

PROGRAM = os.environ["SKYCAP_PROGRAM"]

CUBE = """v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv -1 -1 2\nv 1 -1 2\nv 1 1 2\nv -1 1 2
f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"""

MISSION = """scene: {model: cube.obj}
sensor: {width: 160, height: 120}
planner: {name: skycap, density: 1000, resolution_radius: 0.2}
limits: {max_views: 3}
scan:
  sensor: velodyne_vlp16
  orbit: {radius: 5, min_height: 1, circles: 1, speed: 100}
evaluation: {coverage_distance: 0.1, samples: 1000, attainable_views: 0}
"""


class SmallMission(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        (self.folder / "cube.obj").write_text(CUBE)
        self.file = self.folder / "cube.yaml"
        self.file.write_text(MISSION)

    def load(self, **settings):
        return skycap.Mission.load(
            self.file, {key.replace("__", "."): value for key, value in settings.items()})

    def run_program(self, *arguments):
        return subprocess.run([PROGRAM, *map(str, arguments)], cwd=self.folder, text=True,
                              capture_output=True, check=False)


def box(half_width, half_depth, height):
    """Returns a closed mesh of a box on the plane z = 0."""
    corners = [(x * half_width, y * half_depth, z * height)
               for z in (0, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    sides = [(3, 2, 1, 0), (4, 5, 6, 7)] + [
        (i, (i + 1) % 4, (i + 1) % 4 + 4, i + 4) for i in range(4)]
    triangles = [half for a, b, c, d in sides for half in ((a, b, c), (a, c, d))]
    return skycap.Mesh(corners, triangles)
