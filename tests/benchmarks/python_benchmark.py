"""Benchmark of the Python interface: import of the module, and transfer of two million points to a
planner and back. Prints medians.

    PYTHONPATH=build/release/python python3 tests/benchmarks/python_benchmark.py
"""

import statistics
import subprocess
import sys
import time

import numpy as np

import skycap

WIDTH, HEIGHT = 1600, 1250  # two million pixels, each with a return

MISSION = f"""
sensor: {{width: {WIDTH}, height: {HEIGHT}, horizontal_fov_deg: 60, vertical_fov_deg: 48}}
planner:
  name: skycap
  scene_box: {{min: [-9, -9, 1], max: [9, 9, 9]}}
  density: 4000
  resolution_radius: 0.1
evaluation: {{coverage_distance: 0.05}}
"""


def seconds_of(action):
    start = time.perf_counter()
    action()
    return time.perf_counter() - start


def import_time():
    """Measures a process that imports the module, minus one that does not."""
    def run(script):
        return statistics.median(
            seconds_of(lambda: subprocess.run([sys.executable, "-c", script], check=True))
            for _ in range(9))
    return run("import skycap") - run("pass")


def points_in(mission):
    """Measures the overhead of a call that adds a scan, without the planner's own work."""
    camera = mission.camera
    rays = camera.rays().reshape(-1, 3)
    points = (5 * rays).astype(np.float32)  # a wall, 5 m away
    pixels = np.arange(len(points), dtype=np.uint32)
    overheads = []
    for _ in range(5):
        planner = skycap.Planner(mission)
        took = seconds_of(lambda: planner.next_view(points, np.eye(4), pixels))
        overheads.append(took - sum(planner.last_step.times.values()))
    return statistics.median(overheads)


def points_out():
    """Measures the conversion of a planner's cloud, which keeps nearly all points, to an array."""
    mission = skycap.Mission.parse(MISSION.replace("density: 4000", "density: 1e7"), "wall.yaml")
    planner = skycap.Planner(mission)
    points = (5 * mission.camera.rays().reshape(-1, 3)).astype(np.float32)
    planner.next_view(points, np.eye(4), np.arange(len(points), dtype=np.uint32))
    assert len(planner.cloud()) > 1_000_000
    return statistics.median(seconds_of(lambda: planner.cloud().xyz) for _ in range(9))


def main():
    mission = skycap.Mission.parse(MISSION, "wall.yaml")
    print(f"import skycap          {1e3 * import_time():8.2f} ms")
    print(f"2 million points in    {1e3 * points_in(mission):8.2f} ms")
    print(f"2 million points out   {1e3 * points_out():8.2f} ms")


if __name__ == "__main__":
    main()
