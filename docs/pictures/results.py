"""Pictures drawn from survey results: mission file, coverage, report."""

import csv
import json
import math
import pathlib
import struct
import sys
import time
import xml.etree.ElementTree as xml
import zipfile

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service

from svg import Plot, Svg

KML = "{http://www.opengis.net/kml/2.2}"
EARTH_RADIUS = 6371008.8  # [m]; a site is at most some kilometres wide


class Lazy:
    """A value that is computed on first use."""

    def __init__(self, make):
        self._make, self._value = make, None

    @property
    def value(self):
        if self._value is None:
            self._value = self._make()
        return self._value


def summary_of(folder):
    file = folder / "summary.json"
    if not file.exists():
        sys.exit(f"draw: error: {file} does not exist; run the commands at the top of docs/pictures/draw")
    return json.loads(file.read_text(encoding="utf-8"))


def setting(summary, key, default=None):
    """Returns a key of the mission file from the settings of a summary, flat or nested."""
    node = summary["settings"]
    if key in node:
        return node[key]
    for part in key.split("."):
        if not isinstance(node, dict) or part not in node:
            return default
        node = node[part]
    return node


def read_mission(folder):
    """Reads the data for the pictures of the flight: the summary, and the waypoints of the KMZ
    file."""
    summary = summary_of(folder)
    flight, wayline = summary["flight"], read_kmz(folder / "mission.kmz")
    return {
        "clearance": flight["clearance_m"],
        "return_height": wayline["return_height"],
        "takeoff_climb": wayline["takeoff_climb"],
        "pad": flight["pad"],
        "waypoints": [tuple(leg["points"][-1]) for leg in flight["route"]["sorties"][0]["legs"] if leg["to"] is not None],
        "ellipsoid_height": float(setting(summary, "site.ellipsoid_height")),
        "geoid_undulation": float(setting(summary, "site.geoid_undulation")),
        "file": "mission.kmz",
    }


def read_kmz(file):
    """Returns the waypoints with altitudes and actions, as DJI's applications read them from
    waylines.wpml."""
    with zipfile.ZipFile(file) as archive:
        root = xml.fromstring(archive.read("wpmz/waylines.wpml"))
        template = xml.fromstring(archive.read("wpmz/template.kml"))
    space = root[0].find(f".//{KML}Placemark")[-1].tag.split("}")[0] + "}"

    def find(node, name):
        return node.find(f".//{space}{name}")

    config = find(root, "missionConfig")
    latitude, longitude, _ = map(float, find(template, "takeOffRefPoint").text.split(","))
    home = (latitude, longitude)
    points = []
    for mark in root.iter(f"{KML}Placemark"):
        longitude, latitude = map(float, mark.find(f".//{KML}coordinates").text.split(",")[:2])
        actions = []
        for action in mark.iter(f"{space}action"):
            kind = find(action, "actionActuatorFunc").text
            values = {child.tag.split("}")[1]: child.text for child in find(action, "actionActuatorFuncParam")}
            actions.append((kind, values))
        points.append({"latitude": latitude, "longitude": longitude, "height": float(find(mark, "executeHeight").text),
                       "index": int(find(mark, "index").text), "speed": float(find(mark, "waypointSpeed").text),
                       "heading": float(find(mark, "waypointHeadingAngle").text), "actions": actions})
    return {"points": points, "home": home,
            "return_height": float(find(config, "globalRTHHeight").text),
            "takeoff_climb": float(find(config, "takeOffSecurityHeight").text),
            "finish": find(config, "finishAction").text, "lost": find(config, "executeRCLostAction").text}


ACTIONS = {"takePhoto": "photo", "gimbalRotate": "gimbal", "rotateYaw": "turn", "hover": "wait"}


def action_text(kind, values):
    if kind == "gimbalRotate":
        return f"gimbal {float(values['gimbalPitchRotateAngle']):.0f}°"
    if kind == "rotateYaw":
        return f"turn to {float(values['aircraftHeading']) % 360:.0f}°"
    if kind == "hover":
        return f"wait {float(values['hoverTime']):g} s"
    return ACTIONS.get(kind, kind)


def kmz(folder):
    """Draws the plan view, altitude profile and actions of mission.kmz."""
    wayline = read_kmz(folder / "mission.kmz")
    points, home = wayline["points"], wayline["home"]
    latitude0, longitude0 = home

    def east_north(latitude, longitude):
        return (math.radians(longitude - longitude0) * EARTH_RADIUS * math.cos(math.radians(latitude0)),
                math.radians(latitude - latitude0) * EARTH_RADIUS)

    places = [east_north(point["latitude"], point["longitude"]) for point in points]
    svg = Svg(920, 760, "mission.kmz as the pilot sees it", "Plan view, altitude profile and actions of each waypoint.")
    svg.text(30, 34, f"mission.kmz: {len(points)} waypoints, numbered by wpml:index", 15, "ink", bold=True)
    svg.text(30, 56, f"Altitudes are above take-off. Return altitude {wayline['return_height']:.0f} m; safe take-off altitude "
             f"{wayline['takeoff_climb']:.0f} m; finish: {wayline['finish']}; signal lost: {wayline['lost']}.", 12.5, "soft")
    # Plan view.
    left, top, size = 30, 84, 390
    svg.rect(left, top, size, size, 8, fill="panel")
    xs, ys = [x for x, _ in places] + [0.0], [y for _, y in places] + [0.0]
    span = max(max(xs) - min(xs), max(ys) - min(ys)) * 1.16
    cx, cy = (max(xs) + min(xs)) / 2, (max(ys) + min(ys)) / 2

    def at(x, y):
        return left + size / 2 + (x - cx) / span * size, top + size / 2 - (y - cy) / span * size

    svg.polyline([at(0, 0), *(at(*place) for place in places), at(0, 0)], stroke="green", width=2)
    for (x, y), point in zip(places, points):
        px, py = at(x, y)
        heading = math.radians(point["heading"])
        if any(kind == "takePhoto" for kind, _ in point["actions"]):
            tip = (px + 26 * math.sin(heading), py - 26 * math.cos(heading))
            svg.arrow([(px, py), tip], "violet", 1.4)
    hx, hy = at(0, 0)
    svg.rect(hx - 7, hy - 7, 14, 14, 3, fill="amber")
    svg.text(hx, hy + 22, "home", 12, "amber", "middle", bold=True)
    for (x, y), point in zip(places, points):
        photo = any(kind == "takePhoto" for kind, _ in point["actions"])
        px, py = at(x, y)
        if math.hypot(px - hx, py - hy) < 14:
            if not photo:
                continue
            px, py = px - 17, py - 6
        if photo:
            svg.badge(px, py, point["index"], "blue", 9)
        else:
            svg.circle(px, py, 4, fill="paper", stroke="green", width=1.8)
    bar = 10 if span < 120 else 20
    svg.line(left + 16, top + size - 18, left + 16 + bar / span * size, top + size - 18, stroke="ink", width=2)
    svg.text(left + 16, top + size - 26, f"{bar} m", 12)
    svg.arrow([(left + size - 22, top + 48), (left + size - 22, top + 20)], "ink", 1.6)
    svg.text(left + size - 22, top + 64, "N", 12, "ink", "middle")
    # Altitude profile along the flight.
    lengths, total = [], 0.0
    previous = (0.0, 0.0, wayline["takeoff_climb"])
    for (x, y), point in zip(places, points):
        total += math.dist(previous, (x, y, point["height"]))
        previous = (x, y, point["height"])
        lengths.append(total)
    home_again = total + math.hypot(*places[-1])
    highest = max(max(point["height"] for point in points), wayline["return_height"]) + 4
    plot = Plot(svg, 478, 120, 412, 300, (0, home_again), (0, highest))
    step = 10 if highest < 80 else 20
    plot.axes(range(0, int(home_again) + 1, 100 if home_again < 700 else 200), range(0, int(highest) + 1, step),
              "distance flown [m]", "altitude above take-off [m]")
    level = plot.at(0, wayline["return_height"])[1]
    svg.line(478, level, 890, level, stroke="amber", width=1.6, dash="6 4")
    svg.text(886, level - 6, "return altitude", 12, "amber", "end")
    plot.curve([(0, 0), (0, wayline["takeoff_climb"]), *((d, p["height"]) for d, p in zip(lengths, points))], "green", 2)
    for distance, point in zip(lengths, points):
        x, y = plot.at(distance, point["height"])
        photo = any(kind == "takePhoto" for kind, _ in point["actions"])
        if photo:
            svg.badge(x, y, point["index"], "blue", 8)
        else:
            svg.circle(x, y, 3, fill="paper", stroke="green")
    # Actions.
    svg.text(30, 508, "Actions at the waypoints", 14, "ink", bold=True)
    photos = [point for point in points if any(kind == "takePhoto" for kind, _ in point["actions"])]
    rows = math.ceil(len(photos) / 2)
    size = min(12.5, 200 / max(rows, 1) / 1.25)
    for i, point in enumerate(photos):
        x, y = 38 + 446 * (i // rows), 532 + (i % rows) * min(25, 205 / max(rows, 1))
        svg.badge(x, y - 4, point["index"], "blue", 8.5)
        text = ", ".join(action_text(kind, values) for kind, values in point["actions"])
        svg.text(x + 16, y, f"{point['height']:.1f} m, heading {point['heading'] % 360:.0f}°: {text}", size)
    svg.text(30, 744, "Arrows: heading of the photo. Small circles: waypoints without photo (above the pad, and corners around obstacles).", 12, "soft")
    return svg


def coverage_over_views(folder):
    """Draws the ground-truth coverage after each view and the planner's final estimate."""
    summary = summary_of(folder)
    with open(folder / "views.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    scale = summary["coverage_visible"] / summary["coverage"]
    svg = Svg(860, 400, "Coverage over views", "Coverage of a survey by the planner skycap, view by view.")
    count = len(rows)
    plot = Plot(svg, 80, 90, 480, 240, (0, count), (0, 1))
    plot.axes(range(0, count + 1, 2 if count < 30 else 10), [0, 0.25, 0.5, 0.75, 1], "views", "covered fraction",
              str, lambda t: f"{100 * t:.0f}%")
    truth = [(0, 0), *((i + 1, float(row["coverage"]) * scale) for i, row in enumerate(rows))]
    plot.curve(truth, "green")
    for i, (x, y) in enumerate(truth[1:]):
        svg.circle(*plot.at(x, y), 3.2, fill="green")
        del i
    estimate = summary["estimate"]["estimated_coverage"]
    x, y = plot.at(count, estimate)
    svg.circle(x, y, 6, fill="violet")
    end = plot.at(count, truth[-1][1])[1]
    svg.text(578, end + 4, f"ground truth: {100 * truth[-1][1]:.1f}% of the visible surface", 12.5, "green")
    svg.text(578, min(y, end - 18) + 4, f"planner estimate at the end: {100 * estimate:.1f}%", 12.5, "violet")
    stop = summary["estimate"]["stop"]
    gain, least = summary["estimate"]["next_gain"], float(setting(summary, "planner.min_gain", 0.0))
    svg.text(80, 36, f"A survey of the Radcliffe Camera ends after {count} views", 14, "ink", bold=True)
    svg.text(80, 56, f"Stop reason {stop}: the best remaining view would add {100 * gain:.2f}% of the known surface.",
             12.5, "soft")
    svg.text(578, 300, f"planner.min_gain: {100 * least:.2f}%", 12.5, "soft")
    return svg


def read_ply(file):
    """Returns the vertex columns of a binary little-endian PLY file by name."""
    data = file.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    kinds = {"float": "f", "double": "d", "uchar": "B", "uint8": "B", "uint": "I", "uint32": "I", "int": "i", "ushort": "H"}
    names, code, count = [], "<", 0
    for row in data[:end].decode("ascii").splitlines():
        words = row.split()
        if words[:2] == ["element", "vertex"]:
            count = int(words[2])
        elif words[0] == "property":
            names.append(words[2])
            code += kinds[words[1]]
    rows = struct.iter_unpack(code, data[end:end + struct.calcsize(code) * count])
    return names, list(rows)


def coverage_classes(folder):
    """Draws the samples of true_coverage.ply from two sides."""
    names, rows = read_ply(folder / "true_coverage.ply")
    index = {name: i for i, name in enumerate(names)}
    summary = summary_of(folder)
    svg = Svg(900, 420, "Coverage classes", "Surface samples of the teapot: covered, missed, not attainable, not visible.")
    wanted = 7000
    step = max(1, len(rows) // wanted)

    def kind(row):
        if row[index["covered"]]:
            return "green"
        if not row[index["visible"]]:
            return "violet"
        return "red" if row[index["attainable"]] else "amber"

    counts = {colour: 0 for colour in ("green", "red", "amber", "violet")}
    for row in rows:
        counts[kind(row)] += 1
    extents = [(min(row[index[axis]] for row in rows), max(row[index[axis]] for row in rows)) for axis in "xyz"]
    for view, (left, across, up, facing) in enumerate(((40, "x", "z", ("ny", -1)), (470, "x", "y", ("nz", 1)))):
        low, high = extents["xyz".index(across)]
        low_up, high_up = extents["xyz".index(up)]
        scale = 360 / (high - low)
        for colour in ("green", "violet", "amber", "red"):
            dots = []
            for row in rows[::step]:
                if kind(row) != colour or row[index[facing[0]]] * facing[1] < 0:
                    continue
                dots.append((left + (row[index[across]] - low) * scale, 90 + (high_up - row[index[up]]) * scale))
            if dots:
                svg.points(dots, 1.7 if colour == "green" else 2.4, colour)
        svg.text(left + 180, 80, ("from the south", "from above")[view], 12.5, "soft", "middle")
    svg.text(40, 34, "Surface samples of the teapot, by what a survey measured", 14, "ink", bold=True)
    total = len(rows)
    labels = (("green", "covered: a point within the coverage distance"), ("red", "attainable, but not covered"),
              ("amber", "visible, but not covered by the reference views"), ("violet", "not visible from any admissible position"))
    for i, (colour, label) in enumerate(labels):
        x, y = 60 + 430 * (i % 2), 352 + 26 * (i // 2)
        svg.circle(x, y - 4, 6, fill=colour)
        svg.text(x + 14, y, f"{100 * counts[colour] / total:.1f}%  {label}", 12.5)
    svg.text(40, 408, f"Planner {summary['planner']}, {summary['views']} views; coverage distance "
             f"{1000 * float(setting(summary, 'evaluation.coverage_distance')):g} mm.", 12, "soft")
    return svg


# Kinds of patches of coverage.ply by colour; all other colours are shades of green: covered.
PATCH_COLOURS = {(255, 170, 0): "amber", (215, 30, 40): "red", (120, 60, 200): "violet"}


def coverage_map(folder):
    """The patches of coverage.ply, from two sides."""
    names, rows = read_ply(folder / "coverage.ply")
    index = {name: i for i, name in enumerate(names)}
    summary = summary_of(folder)
    svg = Svg(900, 440, "Coverage map", "Patches of the surface as the planner knows it: covered, undersampled, unobserved.")
    colour_of = [PATCH_COLOURS.get(row[index["red"]:index["red"] + 3], "green") for row in rows]
    extents = [(min(row[index[axis]] for row in rows), max(row[index[axis]] for row in rows)) for axis in "xyz"]
    scale = 300 / max(high - low for low, high in extents)
    for left, across, sign, label in ((70, "x", 1, "from the south"), (500, "x", -1, "from the north")):
        low, high = extents["xyz".index(across)]
        top = extents[2][1]
        for colour in ("green", "violet", "amber", "red"):
            dots = []
            for row, own in zip(rows, colour_of):
                if own != colour or row[index["ny"]] * sign > 0:
                    continue
                offset = row[index[across]] - low if sign > 0 else high - row[index[across]]
                dots.append((left + offset * scale, 84 + (top - row[index["z"]]) * scale))
            if dots:
                svg.points(dots, 1.7 if colour == "green" else 2.4, colour)
        svg.text(left + 150, 66, label, 12.5, "soft", "middle")
    svg.text(40, 34, f"Coverage map of the bunny after {summary['views']} views", 14, "ink", bold=True)
    labels = (("green", "covered"), ("amber", "undersampled"), ("red", "unobserved, predicted"), ("violet", "unreachable"))
    for i, (colour, label) in enumerate(labels):
        x = 60 + 200 * i
        svg.circle(x, 408, 6, fill=colour)
        svg.text(x + 14, 412, label, 12.5)
    svg.text(40, 434, "coverage.ply contains these patches with position, normal and colour.", 12, "soft")
    return svg


# Parts of a report: selector of its element, and the point of its box that gets the number (0 to 1).
REPORT_PARTS = ((".verdict", (1.06, 0.5), "Status", "complete, or why the survey stopped"),
                (".lights", (1, 0), "Main values", "with the rule of each colour"),
                (".stage", (0.5, 0), "3-D view", "points, views and route; drag to turn,\nwheel to zoom, click for values"),
                (".legend", (1, 0), "Legend", "coverage, and the route's verified\nclearance by colour"),
                (".stage + .bar", (1, 0), "Layers and directions", "colour of the points, visible layers,\nview from N, E, S, W, top"),
                (".stage + .bar + .bar", (-0.012, 0.5), "Replay", "the survey view by view"),
                ("main > section:nth-of-type(2) h2", (0.2, 0.5), "Uncovered surface",
                 "largest gaps first, with reason, position\nand nearest view; click to show the gap"))


def screenshot(page, width, height, selectors):
    """Returns a PNG screenshot of a report in headless Chromium, as base64, and the boxes of its elements."""
    options = Options()
    options.binary_location = "/usr/bin/chromium"
    for flag in ("--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                 "--hide-scrollbars", f"--window-size={width},{height}"):
        options.add_argument(flag)
    browser = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
    try:
        browser.set_script_timeout(600)
        browser.get(page.resolve().as_uri())
        browser.execute_async_script("const done = arguments[0]; window.skycap.then((s) => {"
                                     " s.panel.viewer.draw(); done(); });")
        time.sleep(2)  # for the last requested frame
        boxes = [browser.execute_script("""
            const box = document.querySelector(arguments[0]).getBoundingClientRect();
            return [box.x, box.y, box.width, box.height];""", selector) for selector in selectors]
        image = browser.execute_cdp_cmd("Page.captureScreenshot", {
            "format": "png", "captureBeyondViewport": True,
            "clip": {"x": 0, "y": 0, "width": width, "height": height, "scale": 1}})
        return image["data"], boxes
    finally:
        browser.quit()


def annotated_report(folder):
    width, height = 1280, 1500
    image, boxes = screenshot(folder / "report.html", width, height, [part[0] for part in REPORT_PARTS])
    svg = Svg(1060, 820, "The report of a survey", "Screenshot of the report with its parts numbered.")
    scale = 640 / width
    svg.add(f'<image href="data:image/png;base64,{image}" x="20" y="50" width="640" height="{height * scale:.0f}"/>')
    svg.rect(20, 50, 640, height * scale, 4, stroke="soft", width=1)
    svg.text(20, 34, "report.html of a survey, and its parts", 15, "ink", bold=True)
    for number, ((_, point, title, text), box) in enumerate(zip(REPORT_PARTS, boxes), 1):
        svg.badge(20 + scale * (box[0] + point[0] * box[2]), 50 + scale * (box[1] + point[1] * box[3]), number, "blue", 12)
        row = 76 + 78 * (number - 1)
        svg.badge(690, row - 5, number, "blue", 12)
        svg.text(712, row, title, 14, "ink", bold=True)
        svg.text(712, row + 20, text, 12.5, "soft")
    svg.text(678, 650, "Further down the page", 14, "ink", bold=True)
    svg.text(678, 672, "curves of coverage and planning time, the flight\nwith clearance and energy, the clearance budget,\n"
             "the return altitude, accuracy, files with checksums,\nand all settings", 12.5, "soft")
    return svg
