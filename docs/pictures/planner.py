"""The steps of the planners skycap, SEE++ and of the volumetric planners, from their formulas."""

import math

from svg import Plot, Svg


def near_probability(distance, reach, noise):
    """Returns the probability that a point at `distance`, with isotropic normal noise, is within
    `reach`."""
    if noise == 0:
        return 1.0 if distance < reach else 0.0
    if distance < 1e-9:
        distance = 1e-9
    a, b = (reach + distance) / (noise * math.sqrt(2)), (reach - distance) / (noise * math.sqrt(2))
    tail = noise / (distance * math.sqrt(2 * math.pi)) * (math.exp(-b * b) - math.exp(-a * a))
    return max(0.0, 0.5 * (math.erf(a) + math.erf(b)) - tail)


def covered(rays_per_area, noise):
    """Returns 1 - mean over the grid's offsets of prod(1 - p). Lengths are in units of the coverage
    distance."""
    spacing = 1.0 / math.sqrt(rays_per_area)
    reach = int((1.0 + 4.0 * noise) / spacing) + 1
    steps, missed = 6, 0.0
    for i in range(steps):
        for j in range(steps):
            u, v = (i + 0.5) / steps * spacing, (j + 0.5) / steps * spacing
            product = 1.0
            for a in range(-reach, reach + 1):
                for b in range(-reach, reach + 1):
                    distance = math.hypot(a * spacing - u, b * spacing - v)
                    product *= 1.0 - near_probability(distance, 1.0, noise)
            missed += product
    return 1.0 - missed / steps**2


def coverage_model():
    svg = Svg(860, 400, "Coverage model", "Probability that a patch is covered, against rays per area, for three noise levels.")
    plot = Plot(svg, 70, 70, 520, 260, (-3, 3), (0, 1))
    plot.axes(range(-3, 4), [0, 0.25, 0.5, 0.75, 1], "rays per r_d² (one view, faced head-on)", "probability that the patch is covered",
              lambda t: {-3: "1/8", -2: "1/4", -1: "1/2"}.get(t, str(2**t)), lambda t: f"{100 * t:.0f}%")
    for noise, colour, label, place in ((0.2, "green", "noise 0.2 r_d", 6), (1.0, "amber", "1 r_d", 12), (2.0, "red", "2 r_d", 16)):
        places = [(k / 4, covered(2 ** (k / 4), noise)) for k in range(-12, 13)]
        plot.curve(places, colour)
        x, y = plot.at(*places[place])
        svg.text(x + 10, y + 14, label, 12.5, colour, halo=True)
    svg.text(70, 34, "More rays and less noise make coverage more likely", 14, "ink", bold=True)
    # Inset: the patch and its rays.
    x0, y0, step = 700, 92, 26
    for i in range(5):
        for j in range(4):
            svg.circle(x0 + i * step, y0 + j * step, 3, fill="blue")
    svg.circle(x0 + 1.6 * step, y0 + 1.4 * step, 34, fill="green", fill_opacity=0.2, stroke="green")
    svg.circle(x0 + 1.6 * step, y0 + 1.4 * step, 2.5, fill="green")
    svg.text(x0 + 2 * step, y0 + 4 * step + 14, "returns around a point;", 12, "soft", "middle")
    svg.text(x0 + 2 * step, y0 + 4 * step + 30, "circle: coverage distance r_d", 12, "soft", "middle")
    svg.text(700 + 52, 272, "Strengths of several\nviews add up:\nH = -ln(1 - F)", 12.5, "ink", "middle")
    return svg


def free_space_memory():
    svg = Svg(860, 360, "Free-space memory", "A point is empty, measured or unknown, depending on its depth in a past image.")
    eye = (70, 190)
    wall = [(520, 50), (520, 150), (600, 150), (600, 318)]
    svg.polygon([eye, (520, 60), (520, 150), (600, 166), (600, 310)], fill="green", fill_opacity=0.16)
    svg.polygon([(520, 60), (800, 40), (800, 330), (600, 310), (600, 166), (520, 150)], fill="red", fill_opacity=0.10)
    svg.polyline(wall, stroke="soft", width=5)
    for place in ((520, 60), (520, 90), (520, 120), (520, 148), (600, 180), (600, 212), (600, 244), (600, 276), (600, 308)):
        svg.line(*eye, *place, stroke="soft", width=0.8)
        svg.circle(*place, 3.5, fill="blue")
    svg.rect(46, 174, 26, 32, 4, fill="ink")
    svg.text(58, 226, "past view", 12, "ink", "middle")
    for x, y, colour, label, note in ((350, 196, "green", "empty", "in front of the measured surface"),
                                      (600, 228, "blue", "measured", "on the measured surface"),
                                      (640, 96, "red", "unknown", "behind the measured surface")):
        svg.circle(x, y, 9, fill=colour, stroke="paper", width=2)
        svg.text(x + 16, y - 2, label, 13.5, colour, bold=True, halo=True)
        svg.text(x + 16, y + 15, note, 12, "ink", halo=True)
    svg.text(30, 28, "One projection per past depth image answers each query", 14, "ink", bold=True)
    svg.text(30, 340, "Used for planning only. Legs are verified separately: there, a ray without a return does not make space free.", 12.5,
             "soft")
    return svg


def surfel(svg, x, y, angle, size, colour, dash=None, normal=None):
    dx, dy = math.cos(angle) * size / 2, math.sin(angle) * size / 2
    svg.line(x - dx, y - dy, x + dx, y + dy, stroke=colour, width=5, dash=dash)
    if normal is not None:
        svg.arrow([(x, y), (x + 24 * math.cos(normal), y + 24 * math.sin(normal))], colour, 1.4)


def predicted_surface():
    """Draws the patches k = 0, 1, 2 to scale, with the offsets and edges of the formulas."""
    h = 18.0
    svg = Svg(900, 420, "Predicted surface", "Patches straight ahead, over an edge, up a step, and on the back of a thin object.")
    svg.text(30, 34, "Where the measured surface ends, four kinds of patches are predicted", 14, "ink", bold=True)
    kinds = (("straight ahead", "at 1.6 h 2^k u"), ("over an edge", "at 1.1 h (u - 2^k n), facing u"),
             ("up a step", "at 1.1 h (u + 2^k n), facing -u"), ("back of a thin object", "at -h (2^k - 1) u - 1.1 h n"))
    for column, (title, note) in enumerate(kinds):
        left = 24 + 218 * column
        svg.rect(left, 56, 204, 280, 8, fill="panel")
        svg.text(left + 102, 80, title, 13.5, "ink", "middle", bold=True)
        svg.text(left + 102, 322, note, 12, "soft", "middle")
        x, y = left + (48, 96, 96, 140)[column], (210, 170, 230, 200)[column]
        for i in range(2 if column == 0 else 4):
            surfel(svg, x - i * h * 1.05, y, 0, h * 0.85, "blue")
        svg.arrow([(x, y), (x, y - 38)], "soft", 1.3)
        svg.text(x - 6, y - 28, "n", 12, "soft", "end")
        svg.arrow([(x, y), (x + 28, y)], "soft", 1.3)
        svg.text(x + 30, y - 5, "u", 12, "soft")
        svg.circle(x, y, 3, fill="ink")
        for k, colour in enumerate(("red", "amber", "violet")):
            edge = max(h, 0.8 * h * 2**k) * 0.86
            if column == 0:
                place, turn, label = (x + 1.6 * h * 2**k, y), 0, (x + 1.6 * h * 2**k, y + 22 + 16 * (k == 0))
            elif column == 3:
                place, turn = (x - h * (2**k - 1), y + 1.1 * h + 5 * k), 0
                label = (place[0], y + 1.1 * h + (24, 42, 30)[k])
            else:
                side = 1 if column == 1 else -1
                place, turn = (x + 1.1 * h + 4 * k, y + side * 1.1 * h * 2**k), math.pi / 2
                label = (place[0] + 26, place[1] + 4 + side * 6 * (k == 2))
            surfel(svg, *place, turn, edge, colour)
            svg.text(*label, f"k = {k}", 11.5, colour, "middle")
    svg.line(40, 366, 64, 366, stroke="blue", width=5)
    svg.text(72, 370, "measured surfels, h apart", 12.5, "ink")
    svg.line(270, 366, 294, 366, stroke="red", width=5)
    svg.text(302, 370, "predicted patches: squares of max(h, 0.8 h 2^k); overlapping ones are drawn side by side", 12.5, "ink")
    svg.text(40, 398, "Patches in known space are dropped. Each kind counts by the success of earlier predictions of that kind.", 12.5,
             "soft")
    return svg


def line_of_sight():
    svg = Svg(860, 400, "Line-of-sight confidence", "Weight c = exp(-L / 0.15 d) of a predicted patch.")
    plot = Plot(svg, 70, 80, 360, 240, (0, 0.45), (0, 1))
    plot.axes([0, 0.1, 0.2, 0.3, 0.4], [0, 0.25, 0.5, 0.75, 1], "unknown length L before the patch, in view distances d",
              "weight c of the patch", lambda t: f"{t:g}", lambda t: f"{100 * t:.0f}%")
    plot.curve([(i / 200, math.exp(-i / 200 / 0.15)) for i in range(91)], "violet")
    x, y = plot.at(0.15, math.exp(-1))
    svg.circle(x, y, 4, fill="violet")
    svg.text(x + 8, y - 6, "L = 0.15 d: 37%", 12.5, "violet")
    svg.text(70, 34, "Unknown space in front of a predicted patch may contain an occluding object", 14, "ink", bold=True)
    # Sight line.
    left, right, row = 490, 820, 200
    svg.rect(left - 4, row - 16, 26, 32, 4, fill="ink")
    svg.text(left + 9, row + 34, "view", 12, "ink", "middle")
    length = right - left - 30
    svg.line(left + 24, row, right, row, stroke="green", width=3)
    svg.line(right - 0.45 * length, row - 40, right - 0.45 * length, row + 40, stroke="soft", width=1, dash="4 4")
    start = right - 0.45 * length
    total = sum(2**i for i in range(5))
    position = right
    for i in range(5):
        size = 0.45 * length * 2**i / total
        unknown = i in (1, 2, 3)
        svg.line(position, row, position - size, row, stroke="red" if unknown else "green", width=7)
        svg.line(position - size, row - 9, position - size, row + 9, stroke="ink", width=1)
        position -= size
    svg.line(right, row - 26, right, row + 26, stroke="violet", width=6)
    svg.text(right, row - 36, "patch", 12, "violet", "middle")
    svg.dimension(start, row + 60, right, row + 60, "last 0.45 d, in five pieces", "soft", (0, 18), "middle")
    svg.text(left + 24, row - 14, "known empty", 12, "green")
    svg.text(start + 74, row - 20, "unknown", 12, "red", "middle")
    svg.text(left, 330, "L is the sum of the unknown pieces. Surfels have c = 1.", 12.5, "soft")
    return svg


def view_selection():
    svg = Svg(900, 460, "View selection", "Candidate views around a cluster of targets, and a batch with its tour.")
    svg.text(30, 34, "Candidate views around the largest clusters of missing surface, and a short tour through a batch", 14, "ink", bold=True)
    # Left: directions.
    cx, cy, reach = 200, 330, 190
    svg.line(90, cy, 310, cy, stroke="blue", width=5)
    for i in range(-2, 3):
        svg.line(cx + 22 * i - 9, cy, cx + 22 * i + 9, cy, stroke="red", width=5)
    for tilt, colour in ((0, "ink"), (31, "violet"), (-31, "violet"), (54, "amber"), (-54, "amber")):
        a = math.radians(tilt)
        x, y = cx + reach * math.sin(a), cy - reach * math.cos(a)
        svg.arrow([(x, y), (cx + 26 * math.sin(a), cy - 26 * math.cos(a))], colour, 1.6)
        svg.circle(x, y, 7, fill=colour)
        svg.text(x, y - 13, f"{abs(tilt)}°", 12.5, colour, "middle")
    svg.dimension(cx + 8, cy - 44, cx + 8, cy - reach + 14, "d", "soft", (6, 10))
    svg.text(cx, cy + 24, "one of 40 clusters of targets", 12.5, "red", "middle")
    svg.text(cx, cy + 42, "five directions each, off the normal", 12, "soft", "middle")
    # Right: batch and tour.
    building = [(600, 190), (760, 190), (760, 320), (680, 320), (680, 270), (600, 270)]
    svg.polygon(building, fill="stone", stroke="soft")
    for x1, y1, x2, y2 in ((760, 206, 760, 310), (690, 320, 752, 320), (608, 190, 668, 190)):
        svg.line(x1, y1, x2, y2, stroke="red", width=5)
    now = (500, 300)
    stops = [(640, 100), (850, 240), (725, 405)]
    svg.polyline([now, stops[0]], stroke="green", width=3)
    svg.arrow([now, stops[0]], "green", 3)
    svg.arrow([stops[0], stops[1]], "soft", 1.6, dash="6 4")
    svg.arrow([stops[1], stops[2]], "soft", 1.6, dash="6 4")
    svg.circle(*now, 7, fill="ink")
    svg.text(now[0], now[1] + 22, "current view", 12, "ink", "middle")
    for i, (x, y) in enumerate(stops):
        svg.badge(x, y, i + 1, "green" if i == 0 else "soft")
    svg.text(656, 96, "flown now; planning then repeats", 12.5, "green")
    svg.text(30, 446, "Rank: gain over (cost of a view + path). A batch has at most five views, each with half the first one's gain or more.",
             12.5, "soft")
    return svg


def see_update():
    svg = Svg(900, 400, "One update of SEE++", "Core points, frontiers and outliers; the proposed view; the view moved clear of an occlusion.")
    svg.text(30, 34, "Classify", 14, "ink", bold=True)
    svg.text(470, 34, "Propose, and avoid occlusions", 14, "ink", bold=True)
    # Points of a measured wall, whose density decreases to the right.
    dense = [(60 + 17 * i + 5 * ((i * 7 + j * 3) % 3), 150 + 17 * j + 4 * ((i + 2 * j) % 3)) for i in range(11) for j in range(8)]
    rim = [(256 + 6 * (j % 2), 150 + 17 * j) for j in range(8)]
    beyond = [(300, 170), (330, 252), (352, 140), (390, 218)]
    for x, y in dense:
        svg.circle(x, y, 3.4, fill="green")
    for x, y in rim:
        svg.circle(x, y, 4.2, fill="amber")
    for x, y in beyond:
        svg.circle(x, y, 3.4, fill="soft")
    svg.circle(150, 218, 36, stroke="green", width=1.6, dash="4 3")
    svg.line(150, 218, 186, 218, stroke="green", width=1.4)
    svg.text(164, 213, "r", 12.5, "ink")
    for i, (colour, label) in enumerate((("green", "core: at least k points within r"),
                                         ("amber", "frontier: not core, with core and outlier neighbours"),
                                         ("soft", "outlier"))):
        svg.circle(66, 322 + 22 * i, 5, fill=colour)
        svg.text(80, 326 + 22 * i, label, 12.5)
    # View proposal in section.
    wall, f = 330, (640, 330)
    for i in range(9):
        svg.circle(490 + 17 * i, wall, 3.4, fill="green")
    svg.circle(*f, 5, fill="amber")
    svg.text(f[0] + 8, wall + 20, "frontier f", 12.5, "amber")
    view = (640, 110)
    svg.arrow([view, (640, 318)], "red", 1.6, dash="6 4")
    svg.circle(*view, 7, stroke="red", width=2, fill="paper")
    svg.text(628, 106, "f + d n", 12.5, "red", "end")
    for x, y in ((622, 200), (634, 206), (646, 202), (656, 208), (628, 214)):
        svg.circle(x, y, 3.4, fill="soft")
    svg.text(612, 212, "occluding points", 12, "soft", "end")
    clear = (784, 162)
    svg.arrow([clear, (650, 322)], "blue", 2)
    svg.circle(*clear, 7, fill="blue")
    svg.text(clear[0], clear[1] - 14, "clear direction", 12.5, "blue", "middle")
    svg.dimension(690, 110, 690, 326, "", "soft")
    svg.text(698, 126, "d", 12.5, "soft")
    svg.text(470, 382, "The clear direction is farthest from all occluding directions.", 12.5, "soft")
    return svg


def volumetric_ray():
    svg = Svg(860, 400, "A ray of a volumetric planner", "Voxels along a candidate's ray and what the gains count.")
    side, left, top, columns, rows = 34, 60, 80, 12, 7
    # A previous view on the left observed the column of occupied voxels. Voxels behind it are in shadow.
    occupied = {(5, 2), (5, 3), (5, 4)} | {(9, 6), (10, 6), (8, 6)}
    for i in range(columns):
        for j in range(rows):
            if (i, j) in occupied:
                colour = "blue"
            elif i < 5 and 0 <= j <= 5 and abs(j - 3) <= 1 + i // 2:
                colour = "green"
            elif 5 < i <= 10 and 2 <= j <= 4:
                colour = "violet"
            elif 5 <= i and j in (0, 1):
                colour = "green" if j == 1 - (i > 8) or i < 9 else "amber"
            else:
                colour = "amber"
            svg.rect(left + side * i, top + side * j, side, side, fill=colour, fill_opacity=0.32, stroke="line", width=1)
    svg.rect(14, top + side * 3 + 2, 26, 30, 4, fill="soft")
    svg.text(28, top + side * 4 + 16, "past", 11.5, "soft", "middle")
    svg.text(28, top + side * 4 + 30, "view", 11.5, "soft", "middle")
    view, end = (left + side * 6.2, top - 22), (left + side * 9.3, top + side * 6.4)
    svg.arrow([view, end], "red", 2.6)
    svg.circle(*view, 7, fill="red")
    svg.text(view[0] - 14, view[1] + 4, "candidate view", 12.5, "red", "end")
    svg.text(end[0] + 12, top + side * 7 + 18, "ray ends: p ≥ 0.5", 12, "red", "middle")
    legend = (("green", "free: p < 0.2"), ("amber", "uncertain, or unmeasured"), ("blue", "occupied: p > 0.8"),
              ("violet", "shadow of a return, unmeasured"))
    for i, (colour, label) in enumerate(legend):
        svg.rect(510, 92 + 26 * i, 16, 16, 3, fill=colour, fill_opacity=0.45, stroke=colour)
        svg.text(534, 105 + 26 * i, label, 12.5)
    gains = (("OA, UV", "V H of all, or of uncertain, voxels"), ("RSV, RSE", "surface directly after uncertain voxels"),
             ("PC", "shadowed voxels, by depth"), ("AF", "rays that meet a surface, or a shadow"), ("AE", "mean H of rays that meet a surface"))
    for i, (gain, text) in enumerate(gains):
        svg.text(510, 226 + 24 * i, gain, 13, "ink", bold=True)
        svg.text(584, 226 + 24 * i, text, 12.5)
    svg.text(40, 36, "What one ray of a candidate view contributes", 14, "ink", bold=True)
    svg.text(40, 386, "An unmeasured voxel has p = 0.5, so the visibility V halves from voxel to voxel.", 12.5, "soft")
    return svg
