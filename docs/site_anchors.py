"""Anchors of headings as GitHub makes them, so that links hold there and on the site."""

import re


def slugify(heading, separator):
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", separator)
