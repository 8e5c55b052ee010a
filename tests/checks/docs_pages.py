"""Checks the form of the documentation: page sizes, headings, pictures, and links from the
index."""

import pathlib
import re
import statistics

WORDS_OF_A_USER_PAGE = 1800
WORDS_OF_A_TUTORIAL = 900
MEDIAN_WORDS = 700
USER_PAGES = ("docs/tutorials/", "docs/howto/", "docs/explanation/")
PICTURE = re.compile(r"!\[([^\]]*)\]\(([^)\s]+)\)|<img [^>]*src=\"([^\"]+)\"")
PICTURE_FOLDER = "docs/images/"
PICTURE_TYPES = (".png", ".jpg", ".svg")


def is_stub(name):
    """Returns true for old pages in docs, which link to the new ones."""
    return re.fullmatch(r"docs/[\w-]+\.md", name) is not None and name != "docs/index.md"


def words(text):
    """Returns the words of a page without code blocks, comments and link addresses."""
    text = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"^(?: {4}.*\n)+", "", text, flags=re.MULTILINE)
    text = re.sub(r"\]\([^)]*\)", "]", text)
    return sum(1 for word in text.split() if re.search(r"\w", word))


def page_complaints(name, text):
    """Yields (line number, problem) for a page."""
    if is_stub(name):
        return
    headings = re.findall(r"^# (.+)$", re.sub(r"^```.*?^```", "", text, flags=re.S | re.M), re.M)
    if len(headings) != 1:
        yield 1, f"the page has {len(headings)} headings of the first level; it needs one"
    if name.startswith(USER_PAGES) or name in ("README.md", "docs/index.md"):
        limit = WORDS_OF_A_TUTORIAL if name.startswith("docs/tutorials/") else WORDS_OF_A_USER_PAGE
        if (count := words(text)) > limit:
            yield 1, f"the page has {count} words; at most {limit} are allowed"
    if name.startswith(("docs/tutorials/", "docs/howto/")):
        if not re.search(r"^(```| {4}\S)", text, re.MULTILINE):
            yield 1, "the page has no command or example"
    for number, line in enumerate(text.split("\n"), 1):
        for label, target, source in PICTURE.findall(line):
            if not source and not label.strip():
                yield number, f"the picture {target} has no description"


def linked_pages(page, text):
    """Returns the pages and pictures that a page links to, relative to the root."""
    targets = re.findall(r"\]\(([^)\s#]+)", text) + [found[2] for found in PICTURE.findall(text)]
    targets += re.findall(r"(?:src|srcset)=\"([^\"\s]+)", text)
    for target in targets:
        if target and not re.match(r"\w+:", target):
            parts = []
            for part in (page.parent / target).parts:
                if part == "..":
                    parts[-1:] = []
                else:
                    parts.append(part)
            yield str(pathlib.PurePosixPath(*parts))


def tree_complaints(root, files):
    """Yields (file, problem) for the documentation as a whole: sizes, and files without links to
    them."""
    pages = [name for name in files if name.endswith(".md")
             and (name.startswith("docs/") or "/" not in name)]
    linked, sizes = set(), []
    for name in pages:
        text = (root / name).read_text(encoding="utf-8")
        linked.update(linked_pages(pathlib.PurePosixPath(name), text))
        sizes += [words(text)] if name.startswith(USER_PAGES) else []
    if sizes and statistics.median(sizes) > MEDIAN_WORDS:
        yield "docs", (f"the median user page has {statistics.median(sizes):.0f} words; at most "
                       f"{MEDIAN_WORDS} are allowed")
    for name in sorted(files):
        if name.endswith(".md") and name.startswith("docs/") and not is_stub(name):
            if name not in linked and name != "docs/index.md":
                yield name, "no page links to it"
        elif name.startswith(PICTURE_FOLDER) and name.endswith(PICTURE_TYPES):
            if name not in linked:
                yield name, "no page shows this picture"
