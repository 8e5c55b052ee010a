"""Arrays as input of the planner, and arrays that refer to its data."""

import gc
import tracemalloc
import unittest

import numpy as np

import skycap
from small_mission import SmallMission

LIVE = """
sensor: {width: 120, height: 90, horizontal_fov_deg: 60, vertical_fov_deg: 46}
planner:
  name: skycap
  scene_box: {min: [-2, -2, -2], max: [2, 2, 2]}
  density: 4000
  resolution_radius: 0.1
evaluation: {coverage_distance: 0.05}
"""


def measure_ball(camera, view):
    """External simulator: casts rays at the unit ball around the origin."""
    pose = view.pose()
    rays = camera.rays().reshape(-1, 3) @ pose[:3, :3].T
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    halfway = -rays @ view.position
    gap = np.linalg.norm(view.position + halfway[:, None] * rays, axis=1)
    pixels = np.flatnonzero((halfway > 0) & (gap < 1))
    distance = halfway[pixels] - np.sqrt(1 - gap[pixels] ** 2)
    points = view.position + distance[:, None] * rays[pixels]
    return points.astype(np.float32), pose, pixels.astype(np.uint32)


def ball_mesh(rings):
    """Returns the unit ball with `rings` circles of latitude and twice as many meridians."""
    latitude, longitude = np.meshgrid(np.linspace(-np.pi / 2, np.pi / 2, rings + 1),
                                      np.linspace(0, 2 * np.pi, 2 * rings, endpoint=False),
                                      indexing="ij")
    vertices = np.stack([np.cos(latitude) * np.cos(longitude),
                         np.cos(latitude) * np.sin(longitude), np.sin(latitude)], axis=-1)
    number = np.arange(vertices.shape[0] * vertices.shape[1]).reshape(vertices.shape[:2])
    a, b = number[:-1], np.roll(number, -1, axis=1)[:-1]
    c, d = np.roll(number, -1, axis=1)[1:], number[1:]
    quads = np.stack([a, b, c, d], axis=-1).reshape(-1, 4)
    return skycap.Mesh(vertices.reshape(-1, 3), np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]))


class ForeignSimulator(unittest.TestCase):
    def test_cannot_be_a_base_class(self):
        with self.assertRaises(TypeError):
            type("Mine", (skycap.Planner,), {})

    def test_has_a_ball_surveyed_to_the_end(self):
        mission = skycap.Mission.parse(LIVE, "ball.yaml")
        planner = skycap.Planner(mission)
        view, views = skycap.look_at([3, 0, 1], [0, 0, 0]), 0
        while view:
            view = planner.next_view(*measure_ball(mission.camera, view))
            views += 1
            self.assertLess(views, 40)
        points = planner.cloud().xyz
        self.assertLess(np.abs(np.linalg.norm(points, axis=1) - 1).max(), 1e-5)
        found = skycap.evaluate(points, ball_mesh(100), mission.coverage_distance)
        self.assertGreater(found.coverage, 0.97)


class Arrays(SmallMission):
    def setUp(self):
        super().setUp()
        self.mission = self.load()
        self.simulation = skycap.Simulation(self.mission)
        self.scan = self.simulation.scan(self.simulation.first_view, 0)
        self.planner = skycap.Planner(self.mission)

    def test_of_scans_and_clouds_are_read_only_and_not_copied(self):
        points, pose, pixels = self.scan
        self.assertEqual((points.dtype, points.shape[1:]), (np.float32, (3,)))
        self.assertEqual((pixels.dtype, pixels.shape), (np.uint32, points.shape[:1]))
        self.assertEqual((pose.dtype, pose.shape), (np.float64, (4, 4)))
        self.planner.next_view(*self.scan)
        shown = self.planner.cloud()
        self.assertTrue(np.shares_memory(shown.xyz, shown.xyz))
        for array in (points, pixels, shown.xyz, shown.views):
            self.assertFalse(array.flags.writeable)
            self.assertFalse(array.flags.owndata)

    def test_outlive_what_gave_them(self):
        self.planner.next_view(*self.scan)
        points = self.planner.cloud().xyz
        copy = points.copy()
        self.planner = None
        gc.collect()
        self.assertTrue(np.array_equal(points, copy))

    def test_of_other_types_mean_the_same(self):
        points, pose, pixels = self.scan
        other = skycap.Planner(self.mission)
        view = self.planner.next_view(points, pose, pixels)
        same = other.next_view(np.asfortranarray(points, np.float64), pose.tolist(),
                               pixels.astype(np.int64))
        self.assertEqual(view.position.tolist(), same.position.tolist())
        self.assertEqual(self.planner.cloud().xyz.tobytes(), other.cloud().xyz.tobytes())

    def test_that_are_right_are_not_copied(self):
        points, pose, pixels = self.scan
        def peak(*scan):
            planner = skycap.Planner(self.mission)
            tracemalloc.start()  # numpy reports the memory of its arrays to tracemalloc
            try:
                planner.next_view(*scan)
                return tracemalloc.get_traced_memory()[1]
            finally:
                tracemalloc.stop()
        self.assertLess(peak(points, pose, pixels), points.nbytes // 2)
        self.assertGreater(peak(points.astype(np.float64), pose, pixels), points.nbytes)

    def test_that_are_not_aligned_mean_the_same(self):
        points, pose, pixels = self.scan
        packet = b"!" + points.tobytes()
        shifted = np.frombuffer(packet, np.float32, offset=1).reshape(points.shape)
        self.assertFalse(shifted.flags.aligned)
        view = self.planner.next_view(points, pose, pixels)
        same = skycap.Planner(self.mission).next_view(shifted, pose, pixels)
        self.assertEqual(view.position.tolist(), same.position.tolist())

    def test_of_the_cloud_keep_the_planner_from_moving_it(self):
        self.planner.next_view(*self.scan)
        points = self.planner.cloud().xyz
        with self.assertRaisesRegex(BufferError, "still in use"):
            self.planner.next_view(*self.scan)
        with self.assertRaises(BufferError):
            self.planner.replacement_view()
        del points
        self.planner.next_view(*self.scan)

    def test_that_would_harm_are_refused(self):
        points, pose, pixels = self.scan
        skewed = pose.copy()
        skewed[0, 0] += 0.1
        far = pose.copy()
        far[0, 3] += 1e9
        broken = points.copy()
        broken[1, 2] = np.nan
        for arguments, kind, message in (
                ((points[:, :2], pose, pixels), ValueError, "shape"),
                ((points, pose[:3], pixels), ValueError, r"\(4, 4\)"),
                ((points, skewed, pixels), ValueError, "rotation"),
                ((broken, pose, pixels), skycap.Error, r"invalid point \(number 1\): it is not finite"),
                ((points, pose, pixels[:-1]), skycap.Error, "each point requires one"),
                ((points, pose, pixels[::-1]), skycap.Error, "are not ascending"),
                ((np.zeros((0, 3)), pose), skycap.Error, "no point of the scene"),
                ((points, pose, pixels.astype(np.int64) + 2**32), ValueError, "32-bit integers"),
                ((points, pose, pixels.astype(np.int64) - 2**31), ValueError, "32-bit integers"),
                ((points, pose, pixels + 0.5), ValueError, "integers"),
                ((points, far, pixels), skycap.Error, "has a position"),
                (("points", pose), TypeError, "")):
            with self.subTest(message), self.assertRaisesRegex(kind, message):
                self.planner.next_view(*arguments)


if __name__ == "__main__":
    unittest.main()
