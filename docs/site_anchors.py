"""Heading anchors in GitHub's format, so that links work on GitHub and on the site."""

import re


def slugify(heading, separator):
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", separator)
