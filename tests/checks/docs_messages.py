"""Looks up the errors on pages in docs/reference/messages.md."""

import re

PAGE = "docs/reference/messages.md"
ROW = re.compile(r"\| `(.*)` \| (.*) \|")
ERROR = re.compile(r"skycap(?:_ros2)?: error: (.*)")
VALUE = "…"


def listed(text):
    """Returns the listed messages as lists of their fixed parts, in order."""
    found = []
    for problem, remedy in ROW.findall(text):
        message = f"{problem}; {plain(remedy)}" if remedy.strip() else problem
        parts = [part.strip() for part in message.replace("\\|", "|").split(VALUE)]
        found.append([part for part in parts if part])
    return found


def plain(cell):
    """Returns the text of a cell without Markdown escapes."""
    return re.sub(r"\\([|*_])", r"\1", cell).replace("&lt;", "<").replace("&amp;", "&")


def holds(message, parts):
    place = 0
    for part in parts:
        place = message.find(part, place)
        if place < 0:
            return False
        place += len(part)
    return True


def complaints(text, messages):
    """Yields (line number, problem) for the errors on a page."""
    for number, line in enumerate(text.split("\n"), 1):
        for message in ERROR.findall(line.strip()):
            is_pattern = "FILE:LINE" in message or VALUE in message or "..." in message
            if not is_pattern and not any(holds(message, parts) for parts in messages):
                yield number, f"{PAGE} does not list the error '{message}'"
