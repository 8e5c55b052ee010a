"""The survey loop, from scan to mission files."""

from svg import Svg


def survey_loop():
    svg = Svg(860, 470, "The survey loop",
              "Sensor, planner, path check and move form a loop; at its end the mission files are written.")
    boxes = {
        "measure": (40, 60, "1  Measure", "sensor or simulator\nreturns a scan", "blue"),
        "update": (330, 60, "2  Update", "planner stores points,\nupdates its model", "violet"),
        "propose": (620, 60, "3  Propose", "planner proposes the\nnext view, or ends", "violet"),
        "verify": (620, 220, "4  Verify", "is there a path that\nkeeps the clearance?", "green"),
        "move": (330, 220, "5  Move", "fly to the view; or you\nmove your own sensor", "blue"),
    }
    for x, y, title, lines, colour in boxes.values():
        svg.box(x, y, 200, 84, title, lines, colour)
    svg.arrow([(240, 102), (328, 102)])
    svg.text(284, 92, "points,\npose".split("\n")[0], 12, "soft", "middle")
    svg.text(284, 120, "and pose", 12, "soft", "middle")
    svg.arrow([(530, 102), (618, 102)])
    svg.arrow([(720, 144), (720, 218)])
    svg.text(728, 186, "view", 12, "soft")
    svg.arrow([(620, 262), (532, 262)], "green")
    svg.text(576, 252, "clear", 12, "green", "middle")
    svg.arrow([(330, 262), (140, 262), (140, 146)])
    svg.text(150, 252, "at the next view", 12, "soft")
    svg.polyline([(790, 220), (790, 182)], stroke="amber", width=1.8)
    svg.arrow([(790, 182), (790, 146)], "amber")
    svg.text(796, 176, "rejected:", 12, "amber")
    svg.text(796, 192, "next one", 12, "amber")
    svg.arrow([(720, 60), (720, 30), (20, 30), (20, 396), (38, 396)], "violet", dash="5 4")
    svg.text(440, 22, "complete, or a limit is reached", 12.5, "violet", "middle")
    steps = [("order views", "shortest tour"), ("verify legs", "and every return"), ("split", "sorties by energy"),
             ("write files", "read back, verify")]
    for i, (title, lines) in enumerate(steps):
        x = 40 + 205 * i
        svg.box(x, 360, 165, 70, title, lines, "green" if i in (1, 3) else "ink")
        if i:
            svg.arrow([(x - 40, 396), (x - 2, 396)])
    svg.text(40, 350, "After the survey: the mission", 13, "soft")
    svg.text(40, 455, "The scene mesh is known to the simulator and the evaluation only, never to planner and flight.", 12.5,
             "soft")
    return svg
