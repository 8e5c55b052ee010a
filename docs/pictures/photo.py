"""Ground sampling distance, parallax and stereo partners of planned photos."""

import math

from svg import Plot, Svg

# survey/photo/stereo_quality.cpp: expected fraction of points with k = 0, 1, ... 6 partners that have a depth.
COMPLETENESS = (0.35, 0.55, 0.80, 0.95, 0.97, 0.99, 0.99)


def photo_gsd():
    svg = Svg(860, 330, "Ground sampling distance",
              "A camera with its sensor, lens and a wall: the pixel pitch is to the focal length as the GSD to the distance.")
    svg.text(40, 34, "GSD = pixel pitch × distance / focal length", 15, "ink", bold=True)
    sensor, lens, wall, axis = 110, 210, 690, 180
    half_sensor = 40
    half_wall = half_sensor * (wall - lens) / (lens - sensor)
    half_shown = min(half_wall, 110)
    svg.rect(sensor - 10, axis - half_sensor, 10, 2 * half_sensor, fill="stone", stroke="ink")
    svg.text(sensor - 5, axis + half_sensor + 20, "sensor", 12.5, "ink", "middle")
    svg.path(f"M{lens} {axis - 30} Q{lens + 14} {axis} {lens} {axis + 30} Q{lens - 14} {axis} {lens} {axis - 30}Z",
             fill="blue", fill_opacity=0.25, stroke="blue")
    svg.text(lens, axis + 52, "lens", 12.5, "blue", "middle")
    svg.rect(wall, axis - half_shown, 14, 2 * half_shown, fill="stone", stroke="ink")
    svg.text(wall + 22, axis - half_shown + 12, "surface", 12.5, "ink")
    pitch = 8
    scale = (wall - lens) / (lens - sensor)
    for side in (-0.5, 0.5):
        svg.line(sensor, axis + side * pitch, wall, axis - side * pitch * scale, "amber", width=1.4)
    svg.rect(sensor - 10, axis - pitch / 2, 10, pitch, fill="amber")
    svg.rect(wall, axis - pitch * scale / 2, 14, pitch * scale, fill="amber")
    svg.text(wall + 22, axis + 4, "GSD", 14, "amber", bold=True)
    svg.text(sensor - 18, axis + 4, "pixel", 12.5, "amber", "end")
    svg.dimension(sensor, 270, lens, 270, "focal length", offset=(0, 20), anchor="middle")
    svg.dimension(lens, 270, wall, 270, "view distance", offset=(0, 20), anchor="middle")
    svg.text(40, 318, "Mavic 3E: pixel pitch 3.28 µm, focal length 12.29 mm; 18.8 m away the GSD is 5 mm.", 12.5, "soft")
    return svg


def pair(svg, x, degrees, title, note, colour):
    """Two photos of a point with a parallax."""
    top, foot = 100, 250
    reach = (foot - top) * math.tan(math.radians(degrees / 2))
    svg.line(x - 105, foot, x + 105, foot, "ink", width=3)
    for side in (-1, 1):
        eye = x + side * reach
        svg.line(eye, top, x, foot, colour, width=1.8)
        svg.rect(eye - 9, top - 14, 18, 12, 2, fill=colour)
    svg.circle(x, foot, 4.5, fill=colour)
    radius = 52
    angle = math.radians(degrees / 2)
    left = (x - radius * math.sin(angle), foot - radius * math.cos(angle))
    right = (x + radius * math.sin(angle), foot - radius * math.cos(angle))
    svg.path(f"M{left[0]:.1f} {left[1]:.1f} A{radius} {radius} 0 0 1 {right[0]:.1f} {right[1]:.1f}", stroke=colour)
    svg.text(x, 66, title, 14, colour, "middle", bold=True)
    svg.text(x, foot + 24, note, 12.5, "ink", "middle")


def photo_parallax():
    svg = Svg(860, 320, "Parallax",
              "Two photos of a point at 2, 15 and 70 degrees: too little for depth, good, and too different to match.")
    svg.text(40, 34, "Parallax: the angle between the rays of two photos at the surface point", 15, "ink", bold=True)
    pair(svg, 150, 2, "2°", "depth uncertain:\nthe rays are almost parallel", "red")
    pair(svg, 430, 15, "15°", "stereo partners: 5° to 40°", "green")
    pair(svg, 710, 70, "70°", "images too different\nto match", "red")
    return svg


def photo_partners():
    svg = Svg(860, 380, "Stereo partners",
              "Expected fraction of surface points with a depth, for 0 to 6 stereo partners of one photo.")
    plot = Plot(svg, 80, 80, 470, 230, (-0.5, 6.5), (0, 1))
    plot.axes(range(7), [0, 0.25, 0.5, 0.75, 1], "stereo partners k of one photo of the point",
              "points with a depth within two GSD", lambda t: "6 or more" if t == 6 else str(t), lambda t: f"{100 * t:.0f}%")
    for k, share in enumerate(COMPLETENESS):
        x, y = plot.at(k, share)
        foot = plot.at(k, 0)[1]
        colour = "green" if k >= 3 else "amber" if k == 2 else "red"
        svg.rect(x - 20, y, 40, foot - y, fill=colour, fill_opacity=0.75)
        svg.text(x, y - 6, f"{100 * share:.0f}%", 12, "ink", "middle")
    svg.text(80, 34, "Three partners, that is four photos of a point, are enough", 15, "ink", bold=True)
    x0, y0 = 700, 250
    svg.line(x0 - 100, y0, x0 + 100, y0, "ink", width=3)
    for degrees, colour in ((0, "blue"), (-24, "green"), (13, "green"), (30, "green")):
        a = math.radians(degrees)
        eye = (x0 + 150 * math.sin(a), y0 - 150 * math.cos(a))
        svg.line(*eye, x0, y0, colour, width=1.8)
        svg.rect(eye[0] - 9, eye[1] - 12, 18, 12, 2, fill=colour)
    svg.circle(x0, y0, 4.5, fill="ink")
    svg.text(x0, y0 + 24, "k = 3: the blue photo\nhas three partners", 12.5, "ink", "middle")
    return svg
