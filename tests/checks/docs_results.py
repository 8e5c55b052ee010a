"""Compares the fields listed in docs/reference/results.md with the output of real commands.

A list of fields is between <!-- fields: FILE --> and <!-- end of fields -->: the code spans in the
first cells of its tables. A span that begins with a dot continues the first one of its cell.
"""

import json
import pathlib
import re
import subprocess
import tempfile

PAGE = pathlib.PurePosixPath("docs/reference/results.md")
LIST = re.compile(r"<!-- fields: (\S+) -->\n(.*?)<!-- end of fields -->", re.DOTALL)
SPAN = re.compile(r"`([^`]+)`")
# Objects that occur in several places and are listed once.
ALIASES = {"flight.fleet.vehicles[].sorties[]": "flight.route.sorties[]",
           "flight.written[].surface": "surface", "flight.written[].targets": "targets"}
# Maps whose keys are names of parts or settings. Their fields are not listed individually.
MAPS = ("settings", "planning_time_parts_s", "per_view[].planning_time_parts_s")
# Objects of compare.json with the fields of summary.json.
MAPS += ("coverage.surface", "coverage.planned", "coverage.flown", "coverage.patched",
         "photos.planned", "photos.patched")

TEAPOT = """
scene: {model: 'builtin:teapot', longest_side: 10.0}
sensor: {width: 160, height: 100, noise: {sigma: 0.03}}
planner: {name: skycap, preset: building, density: 100, resolution_radius: 0.3,
          view_distance: 12}
evaluation: {coverage_distance: 0.2, samples: 2000, visible_directions: 20, attainable_views: 0}
flight: {vehicle: m350_rtk, clearance: 2.0, pad_slope_deg: 1,
         unknown_box: {min: [-7, -7, 0], max: [7, 7, 7]}}
site: {latitude_deg: 51.75, longitude_deg: -1.25, ellipsoid_height: 100, geoid_undulation: 47}
limits: {max_views: 6}
"""
PHOTOS = """
sensor: {photo_camera: mavic_3e_wide}
photo: {gsd: 0.003, patterns: []}
prior: [{file: house.city.json, role: target, uncertainty: 0.1}]
limits: {stand_off: 3}
flight: {vehicle: mavic_3e, free_space: assumed, position_error: 0.1, clearance: 2}
site: {latitude_deg: 51.75, longitude_deg: -1.25, ellipsoid_height: 100, geoid_undulation: 47}
"""
TARGET = "prior:\n  - {file: house.city.json, role: target}\n"
CORNERS = [(x, y, z) for z in (0, 4) for x, y in ((-3, -3), (3, -3), (3, 3), (-3, 3))]
SIDES = [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [4, 5, 6, 7], [0, 3, 2, 1]]
HOUSE = {
    "type": "CityJSON", "version": "2.0",
    "transform": {"scale": [1, 1, 1], "translate": [0, 0, 0]},
    "vertices": CORNERS,
    "CityObjects": {"house": {"type": "Building", "geometry": [{
        "type": "MultiSurface", "lod": "2", "boundaries": [[side] for side in SIDES],
        "semantics": {"surfaces": [{"type": "WallSurface"}, {"type": "RoofSurface"},
                                   {"type": "GroundSurface"}],
                      "values": [0, 0, 0, 0, 1, 2]}}]}}}
# Surveys by purpose.
SURVEYS = {
    "fly-through": (TEAPOT, ["--set", "flight.views=replanned", "--set", "flight.style=fly-through",
                             "--set", "sensor.exposure=0.001"]),
    "fleet": (TEAPOT, ["--set", "flight.vehicles=[m350_rtk, m350_rtk]",
                       "--set", "flight.pads=[[-16, -14, 0], [16, 14, 0]]"]),
    "re-flight": (TEAPOT, ["--set", "flight.style=fly-through", "--set", "sensor.exposure=0.001",
                           "--set", "sensor.capture=moving"]),
    "target": (TEAPOT + TARGET, ["--set", "limits.max_views=2"]),
    "consumer drone": (TEAPOT, ["--set", "flight.vehicle=mini_2", "--set", "flight.clearance=3.5",
                                "--set", "limits.max_views=2"]),
    "no route": (TEAPOT, ["--set", "site.max_height=9"]),
    "pattern": (TEAPOT, ["--planner", "dome", "--set", "site.max_height=14"]),
    "SEE++": (TEAPOT, ["--set", "flight.vehicle=none", "--planner", "see++"]),
}


def listed_fields(text):
    """Returns the listed fields of each file."""
    found = {}
    for name, lists in LIST.findall(text):
        fields = found.setdefault(name, set())
        for line in lists.split("\n"):
            if line.startswith("| `"):
                fields |= fields_of(SPAN.findall(line.split(" | ")[0]))
    return found


def fields_of(spans):
    first, fields = "", set()
    parents = set()
    for span in spans:
        if span.startswith("."):
            fields.add(first + span)
            parents.add(first)
        else:
            first = span
            fields.add(span)
    return fields - parents


def written_fields(value, path=""):
    """Yields the fields of a JSON value: lists without objects, empty values and scalars."""
    path = ALIASES.get(path, path)
    if isinstance(value, dict) and value and path not in MAPS:
        for name, entry in value.items():
            yield from written_fields(entry, f"{path}.{name}" if path else name)
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for entry in value:
            yield from written_fields(entry, path + "[]")
    else:
        yield path


def run(program, folder, *arguments):
    done = subprocess.run([program / "skycap", *arguments], cwd=folder, capture_output=True,
                          text=True, check=False)
    if done.returncode not in (0, 1):
        raise SystemExit(f"skycap {' '.join(map(str, arguments))}: {done.stderr}")
    return done.stdout


def documents(program, folder):
    """Yields (file, content) for the results of small commands."""
    (folder / "house.city.json").write_text(json.dumps(HOUSE), encoding="utf-8")
    for name, (mission, options) in SURVEYS.items():
        file = folder / f"{name}.yaml"
        file.write_text(mission, encoding="utf-8")
        run(program, folder, "plan", file, "--out", name, "--quiet", "--no-report", *options)
        yield "summary.json", (folder / name / "summary.json").read_text(encoding="utf-8")
    run(program, folder, "fly-test", "fleet", "--flights", "2", "--returns", "2", "--quiet")
    yield "fly_test.json", (folder / "fleet" / "fly_test.json").read_text(encoding="utf-8")
    (folder / "photos.yaml").write_text(PHOTOS, encoding="utf-8")
    run(program, folder, "plan", "photos.yaml", "--out", "photos", "--quiet", "--no-report")
    for name in ("target", "photos"):
        flown = (folder / name / "mission.csv").read_text(encoding="utf-8").splitlines(True)
        (folder / "aborted.csv").write_text("".join(flown[:len(flown) // 2]), encoding="utf-8")
        for planned in (name, f"{name}.yaml"):
            run(program, folder, "compare", planned, "aborted.csv", "--out", "compared", "--quiet")
            yield "compare.json", (folder / "compared" / "compare.json").read_text(encoding="utf-8")
    yield "evaluation.json", run(program, folder, "evaluate", "--cloud", "SEE++/cloud.ply",
                                 "--model", "SEE++.yaml", "--json", "--quiet")


def all_written(program):
    """Returns the fields of each file over all commands."""
    found = {}
    with tempfile.TemporaryDirectory() as name:
        for file, text in documents(program, pathlib.Path(name)):
            found.setdefault(file, set()).update(written_fields(json.loads(text)))
    return {file: without_parents(fields) for file, fields in found.items()}


def without_parents(fields):
    """Removes fields that are null or empty in one file and objects in another."""
    return {field for field in fields
            if not any(other.startswith((field + ".", field + "[]")) for other in fields)}


def complaints(text, program):
    """Yields the problems of the listed fields."""
    listed, written = listed_fields(text), all_written(program)
    for file in sorted(listed.keys() | written.keys()):
        there, here = written.get(file, set()), listed.get(file, set())
        for field in sorted(there - here):
            yield f"{file} has the field {field}, which is not listed"
        for field in sorted(here - there):
            yield f"{file} has no field {field}"
