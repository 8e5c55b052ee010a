"""Draws SVG pictures that are readable in light and dark: a canvas with named colours, text, arrows,
dimension lines and projections. Standard library only."""

import math
from html import escape

COLOURS = {
    "paper": ("#ffffff", "#0d1117"),
    "ink": ("#1f2328", "#e6edf3"),
    "soft": ("#59636e", "#9da7b3"),
    "line": ("#d1d9e0", "#3d444d"),
    "panel": ("#f3f5f8", "#1a2028"),
    "stone": ("#c3cad2", "#4d5661"),
    "blue": ("#0969da", "#58a6ff"),
    "green": ("#1a7f37", "#3fb950"),
    "amber": ("#b35900", "#e3a33c"),
    "red": ("#cf222e", "#ff7b72"),
    "violet": ("#8250df", "#bc8cff"),
}
FONT = "system-ui, 'Segoe UI', 'DejaVu Sans', Helvetica, Arial, sans-serif"


def number(value):
    text = f"{value:.1f}"
    return text[:-2] if text.endswith(".0") else text


class Svg:
    """A picture under construction. Coordinates are pixels, with y down."""

    def __init__(self, width, height, title, description):
        self.width, self.height = width, height
        self.title, self.description = title, description
        self.parts = []

    def add(self, part):
        self.parts.append(part)

    @staticmethod
    def style(fill=None, stroke=None, width=1.5, dash=None, opacity=None, fill_opacity=None):
        parts = [f"fill:var(--{fill})" if fill else "fill:none"]
        if fill_opacity is not None:
            parts.append(f"fill-opacity:{fill_opacity:g}")
        if stroke:
            parts.append(f"stroke:var(--{stroke});stroke-width:{width:g}")
            parts.append("stroke-linejoin:round;stroke-linecap:round")
        if dash:
            parts.append(f"stroke-dasharray:{dash}")
        if opacity is not None:
            parts.append(f"opacity:{opacity:g}")
        return ";".join(parts)

    def rect(self, x, y, w, h, radius=0, **style):
        self.add(f'<rect x="{number(x)}" y="{number(y)}" width="{number(w)}" height="{number(h)}"'
                 f' rx="{number(radius)}" style="{self.style(**style)}"/>')

    def circle(self, x, y, radius, **style):
        self.add(f'<circle cx="{number(x)}" cy="{number(y)}" r="{number(radius)}" style="{self.style(**style)}"/>')

    def points(self, places, radius, colour):
        """Adds many equal dots as one element."""
        path = "".join(f"M{number(x)} {number(y)}h0" for x, y in places)
        self.add(f'<path d="{path}" style="fill:none;stroke:var(--{colour});stroke-width:{2 * radius:g};'
                 'stroke-linecap:round"/>')

    def line(self, x1, y1, x2, y2, stroke="ink", **style):
        self.polyline([(x1, y1), (x2, y2)], stroke=stroke, **style)

    def polyline(self, places, stroke="ink", **style):
        path = " ".join(f"{number(x)},{number(y)}" for x, y in places)
        self.add(f'<polyline points="{path}" style="{self.style(stroke=stroke, **style)}"/>')

    def polygon(self, places, **style):
        path = " ".join(f"{number(x)},{number(y)}" for x, y in places)
        self.add(f'<polygon points="{path}" style="{self.style(**style)}"/>')

    def path(self, data, **style):
        self.add(f'<path d="{data}" style="{self.style(**style)}"/>')

    def text(self, x, y, text, size=13, colour="ink", anchor="start", bold=False, turn=None, halo=False):
        """Adds one or more lines, separated by newlines. `y` is the first baseline."""
        extra = ";font-weight:600" if bold else ""
        extra += ";stroke:var(--paper);stroke-width:4px;paint-order:stroke;stroke-linejoin:round" if halo else ""
        rotate = f' transform="rotate({turn:g} {number(x)} {number(y)})"' if turn else ""
        for i, row in enumerate(str(text).split("\n")):
            self.add(f'<text x="{number(x)}" y="{number(y + 1.3 * size * i)}"{rotate} text-anchor="{anchor}" '
                     f'style="fill:var(--{colour});font-size:{size:g}px{extra}">{escape(row)}</text>')

    def arrow_head(self, x, y, angle, colour, size=8):
        side = [(x - size * math.cos(angle + turn), y - size * math.sin(angle + turn)) for turn in (0.42, -0.42)]
        self.polygon([(x, y), *side], fill=colour)

    def arrow(self, places, colour="ink", width=1.8, dash=None, both=False):
        """Adds a polyline with an arrowhead at its end, or at both ends."""
        self.polyline(places, stroke=colour, width=width, dash=dash)
        ends = [(places[-2], places[-1])] + ([(places[1], places[0])] if both else [])
        for (x1, y1), (x2, y2) in ends:
            self.arrow_head(x2, y2, math.atan2(y2 - y1, x2 - x1), colour)

    def dimension(self, x1, y1, x2, y2, label, colour="soft", offset=(6, 4), anchor="start", size=12):
        """Adds a double arrow with a label next to its middle."""
        self.arrow([(x1, y1), (x2, y2)], colour, 1.3, both=True)
        self.text((x1 + x2) / 2 + offset[0], (y1 + y2) / 2 + offset[1], label, size, colour, anchor)

    def badge(self, x, y, label, colour="blue", radius=10):
        self.circle(x, y, radius, fill=colour)
        self.text(x, y + 4.3, label, 12, "paper", "middle", bold=True)

    def box(self, x, y, width, height, title, lines="", colour="ink", fill="panel", size=12.5):
        """Adds a rounded box with a title and small text."""
        self.rect(x, y, width, height, 8, fill=fill, stroke=colour)
        self.text(x + width / 2, y + 22, title, 14, colour, "middle", bold=True)
        if lines:
            self.text(x + width / 2, y + 41, lines, size, "ink", "middle")

    def write(self, path):
        light = ";".join(f"--{name}:{pair[0]}" for name, pair in COLOURS.items())
        dark = ";".join(f"--{name}:{pair[1]}" for name, pair in COLOURS.items())
        head = (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width} {self.height}" '
                f'width="{self.width}" height="{self.height}" role="img" aria-labelledby="t d">\n'
                f'<title id="t">{escape(self.title)}</title>\n<desc id="d">{escape(self.description)}</desc>\n'
                f"<style>:root{{{light}}}\n@media (prefers-color-scheme:dark){{:root{{{dark}}}}}\n"
                f"text{{font-family:{FONT}}}</style>\n")
        paper = (f'<rect width="{self.width}" height="{self.height}" rx="10" '
                 'style="fill:var(--paper)"/>\n')
        path.write_text(head + paper + "\n".join(self.parts) + "\n</svg>\n", encoding="utf-8")


class Plot:
    """Axes in a rectangle of a picture: maps values to pixels and draws ticks."""

    def __init__(self, svg, left, top, width, height, x_range, y_range):
        self.svg, self.left, self.top, self.w, self.h = svg, left, top, width, height
        self.x_range, self.y_range = x_range, y_range

    def at(self, x, y):
        (x0, x1), (y0, y1) = self.x_range, self.y_range
        return (self.left + self.w * (x - x0) / (x1 - x0), self.top + self.h * (1 - (y - y0) / (y1 - y0)))

    def axes(self, x_ticks, y_ticks, x_label, y_label, x_text=str, y_text=str):
        svg = self.svg
        for tick in y_ticks:
            x, y = self.at(self.x_range[0], tick)
            svg.line(x, y, x + self.w, y, stroke="line", width=1)
            svg.text(x - 8, y + 4, y_text(tick), 12, "soft", "end")
        for tick in x_ticks:
            x, y = self.at(tick, self.y_range[0])
            svg.line(x, y, x, y + 5, stroke="soft", width=1)
            svg.text(x, y + 19, x_text(tick), 12, "soft", "middle")
        svg.line(self.left, self.top + self.h, self.left + self.w, self.top + self.h, stroke="soft")
        svg.text(self.left + self.w / 2, self.top + self.h + 38, x_label, 12.5, "ink", "middle")
        svg.text(self.left, self.top - 12, y_label, 12.5, "ink")

    def curve(self, places, colour, width=2.2, dash=None):
        self.svg.polyline([self.at(x, y) for x, y in places], stroke=colour, width=width, dash=dash)
