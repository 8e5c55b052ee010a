"""Metadata of the module, and its functions other than surveys."""

import ast
import ctypes
import inspect
import json
import pathlib
import shutil
import struct
import subprocess
import sys
import unittest

import numpy as np

import skycap
from skycap import _skycap
from small_mission import SmallMission, box

STUBS = pathlib.Path(skycap.__file__).parent


class Module(unittest.TestCase):
    def test_leaves_numpy_for_later(self):
        script = "import sys, skycap; skycap.models(); sys.exit('numpy' in sys.modules)"
        self.assertEqual(subprocess.run([sys.executable, "-c", script], check=False).returncode, 0)

    def test_leaves_the_elementary_functions_of_others_alone(self):
        def address(library, function):
            return ctypes.cast(library[function], ctypes.c_void_p).value

        module, libm = ctypes.CDLL(_skycap.__file__), ctypes.CDLL("libm.so.6")
        for function in ("sin", "exp", "powf"):  # exported functions would take precedence over those of libm
            self.assertEqual(address(module, function), address(libm, function), function)

    def test_documents_everything(self):
        for name in skycap.__all__:
            if name == "__version__":
                continue
            thing = getattr(skycap, name)
            self.assertTrue(inspect.getdoc(thing), name)
            if not inspect.isclass(thing):
                inspect.signature(thing)
                continue
            for member, value in vars(thing).items():
                if not member.startswith("_"):
                    self.assertTrue(inspect.getdoc(value), f"{name}.{member}")

    def test_has_stubs_that_tell_the_truth(self):
        stub = ast.parse((STUBS / "__init__.pyi").read_text(encoding="utf-8"))
        told = {node.name: node for node in stub.body
                if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
        self.assertEqual({*told, "__version__"}, set(skycap.__all__))
        for name, node in told.items():
            thing = getattr(skycap, name)
            if isinstance(node, ast.FunctionDef):
                self.assertEqual([argument.arg for argument in node.args.args],
                                 list(inspect.signature(thing).parameters), name)
            elif name != "Error":
                members = {member.name for member in node.body}
                for member in node.body:
                    told_args = [argument.arg for argument in member.args.args]
                    is_method = told_args[:1] == ["self"] and not member.decorator_list
                    if is_method and not member.name.startswith("_"):
                        signature = inspect.signature(getattr(thing, member.name))
                        self.assertEqual(told_args[1:], list(signature.parameters), member.name)
                self.assertEqual({m for m in members if not m.startswith("_")},
                                 {m for m in vars(thing) if not m.startswith("_")}, name)

    @unittest.skipUnless(shutil.which("mypy"), "mypy is not installed")
    def test_has_stubs_that_mypy_accepts_and_uses(self):
        mypy = shutil.which("mypy")
        interpreter = pathlib.Path(mypy).read_text(encoding="utf-8").splitlines()[0][2:].split()[0]
        ran = subprocess.run([interpreter, "-m", "mypy", "--strict", "-p", "skycap"],
                             capture_output=True, text=True, cwd=STUBS.parent, check=False)
        self.assertEqual(ran.returncode, 0, ran.stdout + ran.stderr)
        for use, is_right in (("x: float = skycap.model('teapot').area", True),
                              ("for piece in skycap.scan(skycap.Mission.load('m')): len(piece)", True),
                              ("x: str = skycap.model('teapot').area", False),
                              ("skycap.Planner(skycap.Mission.load('m')).next_view()", False)):
            ran = subprocess.run([interpreter, "-m", "mypy", "--strict", "-c",
                                  "import skycap\n" + use], capture_output=True, text=True,
                                 cwd=STUBS.parent, check=False)
            self.assertEqual(ran.returncode == 0, is_right, use + "\n" + ran.stdout)


class Errors(SmallMission):
    def test_are_the_messages_of_the_program(self):
        self.file.write_text(self.file.read_text() + "colour: red\n")
        with self.assertRaises(skycap.Error) as raised:
            self.load()
        self.assertEqual(raised.exception.kind, "bad_config")
        self.assertIn("cube.yaml:9: ", str(raised.exception))
        ran = self.run_program("plan", self.file)
        self.assertIn(str(raised.exception), ran.stderr)

    def test_are_none_for_prior_data_which_takes_a_plug_in(self):
        (self.folder / "old, town.geojson").write_text(json.dumps({
            "type": "Feature", "properties": {"height": 5}, "geometry": {
                "type": "Polygon",
                "coordinates": [[[8.0, 47.0], [8.0001, 47.0], [8.0001, 47.0001], [8.0, 47.0]]]}}))
        mission = self.load(site__latitude_deg=47.0, site__longitude_deg=8.0,
                            site__ellipsoid_height=400,
                            prior=[{"file": "old, town.geojson", "role": "obstacle", "base": 400,
                                    "vertical": "ellipsoid"}])
        self.assertEqual(mission.name, self.load().name)

    def test_name_the_setting(self):
        with self.assertRaisesRegex(skycap.Error, "limits.max_views"):
            self.load(limits__max_views="many")

    def test_name_the_file(self):
        with self.assertRaisesRegex(skycap.Error, "nothing.yaml") as raised:
            skycap.Mission.load(self.folder / "nothing.yaml")
        self.assertEqual(raised.exception.kind, "bad_file")

    def test_of_numpy_types_are_none(self):
        mission = self.load(seed=np.int64(7), limits__ground_clearance=np.float64(0.5),
                            start__position=np.array([3.0, 0, 1]), start__look_at=(0, 0, 1))
        self.assertEqual(mission.seed, 7)
        self.assertEqual(skycap.Simulation(mission).first_view.position.tolist(), [3, 0, 1])


class Scans(SmallMission):
    def test_hold_the_returns_of_the_program(self):
        ran = self.run_program("scan", self.file, "--quiet", "--out", self.folder / "scan")
        self.assertEqual((ran.returncode, ran.stderr), (0, ""))
        header = (self.folder / "scan/scan.las").read_bytes()[:375]
        returns = np.concatenate(list(skycap.scan(self.load())))
        self.assertEqual(struct.unpack_from("<Q", header, 247)[0], len(returns))
        most_x, least_x, most_y, least_y, most_z, least_z = struct.unpack_from("<6d", header, 179)
        # LAS stores multiples of 1 mm or less.
        self.assertLess(np.abs(returns["xyz"].max(0) - (most_x, most_y, most_z)).max(), 1e-3)
        self.assertLess(np.abs(returns["xyz"].min(0) - (least_x, least_y, least_z)).max(), 1e-3)
        self.assertTrue((np.diff(returns["time"]) >= 0).all())
        self.assertTrue((returns["return_number"] <= returns["returns_of_shot"]).all())
        self.assertLess(returns["channel"].max(), 16)

    def test_take_another_sensor_and_refuse_a_camera(self):
        first = next(skycap.scan(self.load(), sensor="ouster_os1_64"))
        self.assertGreater(first["channel"].max(), 16)
        with self.assertRaisesRegex(skycap.Error, "is a camera"):
            skycap.scan(self.load(), sensor="intel_d435")


class Certificates(unittest.TestCase):
    def test_know_how_near_a_leg_comes(self):
        tower = box(5, 5, 30)
        route = [(-20, -12, 10), (20, -12, 10), (20, -12, 31), (-20, 8, 31), (-20, 12, 5)]
        legs = skycap.verify_route(route, 2.0, mesh=tower, ground_height=0.0)
        self.assertEqual([leg.is_clear for leg in legs], [True, True, False, True])
        self.assertAlmostEqual(legs[0].clearance, 7.0, places=5)   # south of the wall at y = -5
        self.assertAlmostEqual(legs[2].clearance, 1.0, places=5)   # above the roof
        self.assertAlmostEqual(legs[2].on_obstacle[2], 30.0)
        self.assertEqual(legs[2].on_leg[2] - legs[2].on_obstacle[2], 1.0)

    def test_count_points_volumes_fence_and_ground(self):
        leg = [(0, 0, 10), (10, 0, 10)]
        square = [(-5, -5), (15, -5), (15, 5), (-5, 5)]
        column = skycap.Prism("mast", [(4, 3), (6, 3), (6, 4), (4, 4)])
        for obstacles, distance in (
                ({"cloud": np.float32([[5, 4, 10]]), "cloud_radius": 1.0}, 3.0),
                ({"no_fly": [column]}, 3.0),
                ({"fence": skycap.Prism("fence", square, 0, 12)}, 2.0),
                ({"ground_height": 4.0}, 6.0),
                ({"no_fly": [column], "ground_height": 9.0}, 1.0)):
            (proof,) = skycap.verify_route(leg, 0.5, **obstacles)
            self.assertAlmostEqual(proof.clearance, distance, places=5, msg=str(obstacles))
        (proof,) = skycap.verify_route(leg, 0.5, no_fly=[column])
        self.assertIn("mast", proof.obstacle)
        (proof,) = skycap.verify_route(leg, 0.5)
        self.assertEqual((proof.is_clear, proof.obstacle, proof.on_leg), (True, "", None))

    def test_have_their_former_names_for_one_version(self):
        with self.assertWarnsRegex(DeprecationWarning, "skycap.certify is now skycap.verify_route"):
            (check,) = skycap.certify([(0, 0, 10), (10, 0, 10)], 0.5)
        with self.assertWarnsRegex(DeprecationWarning, "is_proven is now is_clear"):
            self.assertTrue(check.is_proven)
        with self.assertWarns(DeprecationWarning):
            self.assertIs(skycap.LegProof, skycap.LegCheck)
        with self.assertRaises(AttributeError):
            skycap.certified

    def test_refuse_places_that_are_none(self):
        with self.assertRaisesRegex(skycap.Error, "point 1 of the route has a non-finite position"):
            skycap.verify_route([(0, 0, 0), (np.inf, 0, 0)], 1.0)


class Evaluations(unittest.TestCase):
    def test_measure_distance_and_share(self):
        sheet = skycap.Mesh([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2), (0, 2, 3)])
        x, y = np.meshgrid(np.linspace(0, 0.5, 51), np.linspace(0, 1, 101))
        points = np.stack([x, y, np.full_like(x, 0.003)], axis=-1).reshape(-1, 3)
        found = skycap.evaluate(points, sheet, distance=0.01)
        self.assertAlmostEqual(found.mean, 0.003, places=7)
        self.assertAlmostEqual(found.largest, 0.003, places=7)
        # Half of the sheet, plus the reach of the distance beyond it: sqrt(0.01^2 - 0.003^2)
        self.assertAlmostEqual(found.coverage, 0.5 + 0.0095, delta=0.002)
        self.assertAlmostEqual(found.area, 1.0)
        self.assertAlmostEqual(found.density, len(points))
        for wrong in ({"distance": 0.0}, {"distance": 1.0, "samples": 0}):
            with self.assertRaises(skycap.Error):
                skycap.evaluate(points, sheet, **wrong)


class Models(unittest.TestCase):
    def test_are_those_that_come_with_skycap(self):
        self.assertIn("teapot", skycap.models())
        teapot = skycap.model("teapot")
        size = teapot.vertices.max(0) - teapot.vertices.min(0)
        self.assertAlmostEqual(size[0], 6.434, places=2)
        self.assertLess(teapot.triangles.max(), len(teapot.vertices))
        with self.assertRaisesRegex(skycap.Error, "teapot"):
            skycap.model("kettle")

    def test_of_arrays_are_checked(self):
        with self.assertRaises(skycap.Error):
            skycap.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 3)])

    def test_sensors_have_rays_through_their_pixels(self):
        self.assertIn("ouster_os1_128", skycap.sensors())
        camera = skycap.camera("intel_d435")
        rays = camera.rays()
        self.assertEqual(rays.shape, (camera.height, camera.width, 3))
        outermost = np.degrees(np.arctan(rays[0, -1, 0]))
        pixel = camera.horizontal_fov / camera.width
        self.assertAlmostEqual(np.radians(outermost), camera.horizontal_fov / 2, delta=pixel)
        with self.assertRaisesRegex(skycap.Error, "laser scanner"):
            skycap.camera("ouster_os1_128")


if __name__ == "__main__":
    unittest.main()
