"""Compares the exit codes that docs/reference/cli.md lists with those in the sources of the commands,
and the commands of the list with those of the program."""

import pathlib
import re
import signal

PAGE = pathlib.PurePosixPath("docs/reference/cli.md")
ROW = re.compile(r"^\| (\d+) \| ([^|]+) \|", re.MULTILINE)
RETURNED = (re.compile(r"\breturn (\d+);"), re.compile(r"\? (\d+) : (\d+);"),
            re.compile(r"\breport_failure\(.*, (\d+)\);"), re.compile(r"\bexit_\w+ = (\d+)\b"))
TERMINATED = re.compile(r"\b128 \+ SIGTERM\b")


def returned_codes(root):
    """The exit codes in the sources of the commands."""
    codes = set()
    for source in sorted((root / "missions" / "cli").rglob("*.[ch]*")):
        text = source.read_text(encoding="utf-8")
        for pattern in RETURNED:
            codes.update(int(code) for match in pattern.finditer(text) for code in match.groups())
        if TERMINATED.search(text):
            codes.add(128 + signal.SIGTERM)
    return codes


def complaints(root, verbs):
    """Yields what is wrong with the page's table of exit codes."""
    text = (root / PAGE).read_text(encoding="utf-8")
    section = re.search(r"^## Exit codes\n(.*?)^## ", text, re.MULTILINE | re.DOTALL)
    rows = ROW.findall(section[1]) if section else []
    listed, returned = {int(code) for code, _ in rows}, returned_codes(root)
    for code in sorted(returned - listed):
        yield f"commands return the exit code {code}, which is not listed"
    for code in sorted(listed - returned):
        yield f"no command returns the exit code {code}"
    for code, commands in rows:
        for command in re.findall(r"`([\w-]+)`", commands):
            if command not in verbs:
                yield f"exit code {code}: there is no command {command}"
