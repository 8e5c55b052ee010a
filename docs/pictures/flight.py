"""Pictures of flight safety, drawn from stated figures and from the summary of a survey."""

import math

from svg import Svg


def house(svg, x, ground, scale, colour="stone"):
    """Draws a building 10 m wide and 9 m high."""
    w, h = 10 * scale, 6 * scale
    svg.polygon([(x, ground), (x, ground - h), (x + w / 2, ground - 9 * scale), (x + w, ground - h), (x + w, ground)],
                fill=colour, stroke="soft")


def drone(svg, x, y, size=1.0, colour="ink"):
    a = 11 * size
    svg.line(x - a, y, x + a, y, stroke=colour, width=2.4 * size)
    for side in (-a, a):
        svg.line(x + side, y, x + side, y - 5 * size, stroke=colour, width=1.6 * size)
        svg.line(x + side - 7 * size, y - 5 * size, x + side + 7 * size, y - 5 * size, stroke=colour, width=1.6 * size)
    svg.rect(x - 5 * size, y - 3 * size, 10 * size, 7 * size, 2, fill=colour)


def verified():
    svg = Svg(900, 640, "What is verified and what is not",
              "Side view of a survey site: legs and returns are verified, the airspace outside the unknown box is assumed free.")
    ground = 440
    svg.rect(20, 50, 860, ground - 50, fill="amber", fill_opacity=0.07)
    svg.rect(20, ground, 860, 34, fill="stone", fill_opacity=0.6)
    svg.rect(330, 130, 330, ground - 130, fill="paper")
    svg.rect(330, 130, 330, ground - 130, fill="red", fill_opacity=0.10, stroke="red", dash="7 5")
    svg.text(344, 152, "flight.unknown_box", 12.5, "red", bold=True)
    # Measured free space around the building.
    free = [(330, 200), (470, 172), (660, 196), (660, 360), (612, 408), (590, 330), (590, 264), (505, 214), (420, 264),
            (420, 330), (396, 410), (330, 396)]
    svg.polygon(free, fill="green", fill_opacity=0.22)
    house(svg, 435, ground, 14)
    svg.text(505, 404, "building", 12.5, "ink", "middle")
    svg.text(505, 262, "unknown space", 12, "red", "middle")
    svg.text(505, 278, "counts as obstacle", 12, "red", "middle")
    # Route.
    route = [(130, 372), (356, 340), (372, 236), (505, 186), (634, 234), (640, 330)]
    svg.polyline(route, stroke="green", width=3)
    for place in route[1:]:
        svg.circle(*place, 4.5, fill="paper", stroke="green", width=2.4)
    svg.line(130, ground, 130, 408, stroke="amber", width=3, dash="4 5")
    svg.line(130, 408, 130, 372, stroke="green", width=3)
    svg.arrow([(640, 330), (640, 92), (130, 92), (130, 368)], "blue", 2.2, dash="9 5")
    svg.text(650, 88, "return altitude", 12.5, "blue")
    svg.text(196, 84, "return from every point of the route", 12.5, "blue")
    drone(svg, 356, 334)
    svg.line(100, ground, 160, ground, stroke="ink", width=4)
    svg.text(130, 458, "pad", 12, "ink", "middle")
    # Unobserved obstacles: a tree, a wire.
    svg.line(250, ground, 250, 424, stroke="amber", width=4)
    svg.circle(250, 408, 20, fill="amber", fill_opacity=0.35, stroke="amber")
    svg.line(690, 300, 872, 312, stroke="amber", width=1.6)
    svg.line(700, ground, 700, 300, stroke="amber", width=3)
    svg.line(862, ground, 862, 312, stroke="amber", width=3)
    svg.text(770, 290, "wire", 12, "amber", "middle")
    svg.text(276, 412, "tree", 12, "amber")
    for number, x, y, colour in ((1, 412, 205, "green"), (2, 110, 390, "green"), (3, 560, 110, "blue"),
                                 (4, 210, 240, "amber"), (5, 100, 424, "amber"), (6, 778, 326, "amber")):
        svg.badge(x, y, number, colour)
    rows = [(1, "green", "Legs keep the clearance to unknown space, measured points, ground, prior data and airspace limits."),
            (2, "green", "Climb and descent keep it above the first metres."),
            (3, "blue", "The return at the stated altitude keeps it, from every point of the route."),
            (4, "amber", "Outside the box, space is assumed free except for measured points and prior data: the pilot must check it."),
            (5, "amber", "The pad and the first metres of the climb: the pilot must check them."),
            (6, "amber", "Wires and moving objects are not verified anywhere: the pilot must check them.")]
    for i, (number, colour, text) in enumerate(rows):
        x, y = 34, 502 + 23 * i
        svg.badge(x, y - 4, number, colour, 8.5)
        svg.text(x + 16, y, text, 13)
    svg.text(34, 34, "Verified", 14, "green", bold=True)
    svg.text(104, 34, "and", 14, "soft")
    svg.text(136, 34, "to be checked by the pilot", 14, "amber", bold=True)
    return svg


def free_space():
    svg = Svg(860, 400, "How a voxel becomes free",
              "A voxel is free if all pixels that its bounding sphere touches, plus a margin of one pixel, measured a point beyond it.")
    camera = (60, 210)
    wall = 720
    rays = [-0.24 + 0.04 * i for i in range(13)]
    missing = {2, 3}
    for i, slope in enumerate(rays):
        end = wall if i not in missing else 830
        y = camera[1] + slope * (end - camera[0])
        svg.line(*camera, end, y, stroke="soft" if i not in missing else "amber", width=1,
                 dash=None if i not in missing else "4 4")
        if i not in missing:
            svg.circle(end, y, 3.5, fill="blue")
    svg.polyline([(wall + 4, 60), (wall + 4, 98)], stroke="soft", width=5)
    svg.polyline([(wall + 4, 180), (wall + 4, 390)], stroke="soft", width=5)
    svg.rect(40, 192, 26, 36, 4, fill="ink")
    svg.text(54, 250, "sensor", 12, "ink", "middle")

    def voxel(x, y, side, colour, label, note):
        svg.rect(x - side / 2, y - side / 2, side, side, fill=colour, fill_opacity=0.3, stroke=colour, width=2)
        svg.circle(x, y, side * 0.707, stroke=colour, width=1.2, dash="3 3")
        svg.text(x, y + side * 0.707 + 18, label, 13, colour, "middle", bold=True, halo=True)
        svg.text(x, y + side * 0.707 + 34, note, 12, "soft", "middle", halo=True)

    voxel(430, 262, 46, "green", "free", "all touched pixels measured beyond it")
    voxel(560, 122, 46, "amber", "unknown", "touches pixels without return")
    voxel(wall - 6, 262, 46, "red", "occupied", "contains a measured point")
    svg.dimension(wall - 56, 350, wall, 350, "", "violet")
    svg.line(wall - 56, 180, wall - 56, 360, stroke="violet", width=1.4, dash="5 4")
    svg.text(wall - 28, 378, "map error", 12, "violet", "middle", halo=True)
    svg.text(792, 132, "no return:\nunknown", 12, "amber", "middle", halo=True)
    svg.text(40, 40, "A voxel is a quarter of the clearance wide: 0.5 m at 2.00 m", 13, "ink")
    svg.text(40, 60, "Free: its bounding sphere, plus one pixel on each side, lies in front of the measured depths.", 12.5,
             "soft")
    return svg


def frames_and_altitudes(mission):
    """Draws the altitude references of a mission: site altitude and geoid undulation."""
    ellipsoid, undulation = mission["ellipsoid_height"], mission["geoid_undulation"]
    amsl = ellipsoid - undulation
    height = mission["return_height"]
    pad = mission["pad"]
    svg = Svg(880, 520, "Frames and altitude references",
              "The same point in the local frame, above take-off, above sea level and above the ellipsoid.")
    ground, top = 330, 90
    svg.rect(20, ground, 840, 26, fill="stone", fill_opacity=0.6)
    house(svg, 330, ground, 13)
    drone(svg, 560, top)
    svg.circle(560, top, 3, fill="red")
    svg.line(120, ground, 180, ground, stroke="ink", width=4)
    svg.text(150, ground + 19, "take-off point (home)", 12, "ink", "middle")
    svg.line(40, 420, 860, 420, stroke="blue", width=2)
    svg.text(44, 412, "geoid: mean sea level (EGM96)", 12, "blue")
    svg.line(40, 474, 860, 474, stroke="violet", width=2)
    svg.text(44, 492, "WGS84 ellipsoid", 12, "violet")
    # Axes of the mission frame, at the middle of the building's base.
    svg.arrow([(395, ground), (395, ground - 66)], "red", 2.2)
    svg.arrow([(395, ground), (461, ground)], "red", 2.2)
    svg.text(402, ground - 54, "z up", 12, "red")
    svg.text(440, ground - 8, "x east", 12, "red")
    svg.text(395, ground + 19, "origin: site.latitude_deg, longitude_deg", 12, "red", "middle")
    svg.line(572, top, 822, top, stroke="soft", width=1)
    for x, low, value, label, colour in ((600, ground, height + pad[2], "local z", "red"),
                                         (670, ground, height, "above\ntake-off", "green"),
                                         (740, 420, height + pad[2] + amsl, "AMSL", "blue"),
                                         (810, 474, height + pad[2] + ellipsoid, "above\nellipsoid", "violet")):
        svg.dimension(x, top, x, low, "", colour)
        svg.text(x + 7, 190, f"{value:.0f} m", 13, colour, bold=True)
        svg.text(x + 7, 207, label, 12, colour)
    svg.dimension(250, ground + 26, 250, 420, f"{amsl:.0f} m", "soft")
    svg.dimension(250, 420, 250, 474, f"geoid undulation {undulation:.0f} m", "soft")
    svg.text(40, 40, f"Return altitude of a survey of the Radcliffe Camera: {height:.0f} m above take-off", 14, "ink", bold=True)
    svg.text(40, 60, f"site.ellipsoid_height {ellipsoid:.0f} m, site.geoid_undulation {undulation:.0f} m", 12.5, "soft")
    svg.text(560, 74, "vehicle", 12, "ink", "middle")
    return svg


def clearance_budget(flight):
    """Draws the clearance budget from the summary of a survey."""
    terms = [("vehicle radius", flight["vehicle_radius"], "ink"), ("position error", flight["position_error"], "blue"),
             ("tracking error", flight["tracking_error"], "violet"), ("map error", flight["map_error"], "amber"),
             ("margin", flight["margin"], "green")]
    total = sum(term[1] for term in terms)
    svg = Svg(860, 330, "Clearance budget", "Vehicle radius, three errors and margin add up to the clearance.")
    left, scale, y = 70, 640 / total, 150
    svg.rect(left + total * scale, 60, 70, 230, fill="stone", stroke="soft")
    svg.text(left + total * scale + 70, 50, "obstacle, or unknown space", 12.5, "ink", "end")
    x = left
    for i, (name, size, colour) in enumerate(terms):
        width = size * scale
        svg.rect(x, y - 26, width, 52, fill=colour, fill_opacity=0.55, stroke=colour)
        row = 106 if i in (0, 2, 4) else 84
        middle = x + width / 2
        if i in (1, 3):
            svg.line(middle, row + 6, middle, y - 28, stroke=colour, width=1)
        anchor, shift = {1: ("end", 12), 3: ("start", -12)}.get(i, ("middle", 0))
        svg.text(middle + shift, row, f"{name} {size:.2f} m", 12.5, colour, anchor, bold=True)
        x += width
    reach, turn = flight["vehicle_radius"] * scale, 0.2
    svg.polyline([(left + reach * math.cos(a * turn / 8), y + reach * math.sin(a * turn / 8)) for a in range(-8, 9)],
                 stroke="ink", width=1.4, dash="4 4")
    drone(svg, left, y, 1.2)
    svg.text(left, y + 44, "vehicle's", 12, "ink", "middle")
    svg.text(left, y + 60, "centre", 12, "ink", "middle")
    svg.dimension(left, 250, left + total * scale, 250, f"flight.clearance {total:.2f} m, verified along every leg", "ink",
                  (0, -10), "middle", 13.5)
    worst = sum(term[1] for term in terms[:3])
    svg.dimension(left, 286, left + worst * scale, 286, "", "red")
    svg.text(left + worst * scale + 10, 290, f"{worst:.2f} m: radius, position and tracking", 12.5, "red")
    return svg


def return_profile(mission):
    """Draws the returns from the waypoints of a mission: altitude against distance from the pad."""
    places, height, pad = mission["waypoints"], mission["return_height"], mission["pad"]
    reach = max(((x - pad[0]) ** 2 + (y - pad[1]) ** 2) ** 0.5 for x, y, _ in places)
    svg = Svg(860, 420, "Return to launch", "Climb to the return altitude, level flight to the pad, descent.")
    left, right, ground = 90, 820, 350
    scale_x, scale_z = (right - left - 30) / reach, 250 / (height + 4)

    def at(place):
        distance = ((place[0] - pad[0]) ** 2 + (place[1] - pad[1]) ** 2) ** 0.5
        return left + 20 + distance * scale_x, ground - (place[2] - pad[2]) * scale_z

    for z in range(0, int(height) + 1, 10):
        y = ground - z * scale_z
        svg.line(left, y, right, y, stroke="line", width=1)
        svg.text(left - 8, y + 4, z, 12, "soft", "end")
    level = ground - height * scale_z
    ordered = sorted(places, key=lambda place: at(place)[0])
    for i, place in enumerate(ordered):
        x, y = at(place)
        svg.line(x, y - 7, x, level, stroke="blue", width=1.4)
        svg.circle(x, y, 5, fill="paper", stroke="green", width=2.4)
    far = at(ordered[-1])[0]
    svg.arrow([(far, level), (left + 20, level)], "blue", 2.4)
    climb = mission["takeoff_climb"]
    svg.arrow([(left + 20, level), (left + 20, ground - climb * scale_z)], "blue", 2.4)
    svg.line(left + 20, ground - climb * scale_z, left + 20, ground, stroke="amber", width=3, dash="3 5")
    svg.line(left, ground, right, ground, stroke="ink", width=2)
    svg.text(left + 20, ground + 18, "pad", 12, "ink", "middle")
    svg.text(left + 44, ground + 18, "dashed: not verified, like the first metres of the climb", 12, "amber")
    svg.text((left + right) / 2, ground + 40, f"horizontal distance from the pad, 0 to {reach:.0f} m", 12.5, "ink", "middle")
    svg.text(left, 40, f"Return altitude {height:.0f} m above take-off: the lowest whole metre that is verified", 14, "ink", bold=True)
    svg.text(left, 60, f"{len(places)} waypoints of {mission['file']}; the return is verified from every point between them, too.", 12.5,
             "soft")
    svg.text(right, level - 8, "level flight", 12, "blue", "end")
    svg.text(left - 44, (ground + level) / 2, "m above take-off", 12, "soft", "middle", turn=-90)
    return svg
