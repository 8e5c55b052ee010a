#!/usr/bin/env python3
"""Regenerates the generated parts of docs/reference from the program.

A part is between two comments of a page:

    <!-- generated: commands -->
    <!-- end of generated -->

    docs/generate_reference.py --program build/release           update the pages
    docs/generate_reference.py --program build/release --check   compare only; exit code 1: stale

Requires skycap in the build folder, and skycap_ros2 and the Python module (in python/) for their
parts. With --skip-missing, parts whose program is not built remain unchanged.
"""

import argparse
import ast
import difflib
import inspect
import os
import pathlib
import re
import subprocess
import sys

import source_messages

ROOT = pathlib.Path(__file__).resolve().parents[1]
PAGES = ROOT / "docs" / "reference"
PART = re.compile(r"(<!-- generated: ([\w+ ]+) -->\n)(.*?)(<!-- end of generated -->)", re.DOTALL)


class MissingProgram(Exception):
    """A part requires a program or module that is not built."""


def cell(text):
    """Returns the text as a table cell, with Markdown characters escaped."""
    text = text.replace("&", "&amp;").replace("<", "&lt;").replace("|", "\\|")
    return re.sub(r"(?<!\w)([*_])|([*_])(?!\w)", r"\\\1\2", text)


def code(text):
    return f"`{text}`" if text else ""


def table(head, rows):
    lines = [head, ["---"] * len(head), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


# Commands.

class Help:
    """Parsed output of PROGRAM [COMMAND] --help."""

    def __init__(self, program, *command):
        if not program.exists():
            raise MissingProgram(program.name)
        text = subprocess.run([program, *command, "--help"], capture_output=True, text=True,
                              check=True).stdout
        self.text = text
        self.purpose = text.strip().split("\n")[0]
        self.usage = re.search(r"Usage: (.*)", text)[1]
        self.groups = {}
        self._read_groups(text.split("\n"))

    def _read_groups(self, lines):
        rows = None
        for line in lines:
            title = re.fullmatch(r"(?:\[Option Group: )?([A-Za-z][\w ]*?)(?:\])?:?\s*", line)
            if title and (line.endswith(":") or line.startswith("[Option Group")):
                rows = self.groups.setdefault(title[1], [])
            elif re.match(r" +(?:\[Exactly|Options:)", line):  # within a group of options
                continue
            elif rows is not None and re.match(r" {2,4}\S", line):
                head, _, meaning = re.match(r"\s+(.*?)(\s{2,}|$)(.*)", line).groups()
                name, value = name_and_value(head)
                if default := re.fullmatch(r"(\w+=\S+) (.+)", value):  # one blank before the text
                    value, meaning = default.groups()
                rows.append([name, value, meaning])
            elif rows and line.startswith("     "):
                rows[-1][2] = (rows[-1][2] + " " + line.strip()).strip()

    def rows(self, *groups):
        return [row for group in groups for row in self.groups.get(group, [])]

    def options(self):
        """Returns all options except --help."""
        others = [name for name in self.groups if name not in ("Positionals", "Subcommands")]
        return [row for row in self.rows(*others) if "--help" not in row[0]]


def name_and_value(head):
    """Returns an option's names and value type from the left column."""
    if match := re.match(r"([\w.,-]+)\s+(.*)", head):
        return [match[1], match[2]]
    return [head, ""]


def argument_rows(rows):
    """Returns the rows (argument, value, meaning) of a table."""
    found = []
    for name, value, meaning in rows:
        value = re.sub(r"\s*Excludes: .*", "", value)
        meaning = re.sub(r"\s*Excludes: .*", "", meaning)
        required = "REQUIRED" in value
        value = re.sub(r"\s*REQUIRED", "", value).strip()
        meaning = meaning + (" (required)" if required else "")
        names = name.replace("{false}", "").split(",")
        found.append([", ".join(map(code, names)), cell(value_text(value)), cell(meaning)])
    return found


def value_text(value):
    """Describes an option's value in words: "UINT:INT in [1 - 100]" is an integer from 1 to 100."""
    value = re.sub(r"^(?:TEXT|UINT|FLOAT|INT):(?=\S)", "", value)
    if choices := re.fullmatch(r"\{(.*)\}", value):
        return " or ".join(choices[1].split(","))
    value = re.sub(r"\bTEXT\b", "string", value)
    value = re.sub(r"\bU?INT\b", "integer", value)
    value = re.sub(r"\bFLOAT\b", "number", value)
    value = re.sub(r"in \[(\S+) - (\S+)\]", r"from \1 to \2", value)
    value = re.sub(r"=(\S+)", r" (default: \1)", value)
    return value.replace(" ...", ", repeatable")


def commands_part(build):
    program = build / "skycap"
    overview = Help(program)
    commands = overview.rows("Subcommands")
    listed = [[f"[`{name}`](#skycap-{name})", cell(meaning)] for name, _, meaning in
              ((row[0], row[1], (row[1] + " " + row[2]).strip()) for row in commands)]
    text = "\n" + table(["Command", "Purpose"], listed)
    text += "\nOptions of the program, before or after the command:\n\n"
    text += table(["Option", "Value", "Meaning"], argument_rows(overview.options()))
    for name, *_ in commands:
        text += command_text(program, name)
    return text + "\n"


def command_text(program, name):
    helped = Help(program, name)
    text = f"\n## skycap {name}\n\n{cell(helped.purpose)}.\n\n```\n{helped.usage}\n```\n"
    if positionals := helped.rows("Positionals"):
        text += "\n" + table(["Argument", "Value", "Meaning"], argument_rows(positionals))
    if options := helped.options():
        text += "\n" + table(["Option", "Value", "Meaning"], argument_rows(options))
    return text


def ros2_part(build):
    helped = Help(build / "skycap_ros2")
    rows = argument_rows(helped.rows("Positionals")) + argument_rows(helped.options())
    return "\n" + table(["Option", "Value", "Meaning"], rows) + "\n"


# Keys.

def key_rows(build):
    printed = subprocess.run([build / "skycap", "check", "--keys"], capture_output=True, text=True,
                             check=True).stdout
    return [line for line in printed.split("\n") if line.startswith("| `")]


def section_of(row):
    path = re.match(r"\| `([^`]+)`", row)[1]
    return re.split(r"[.\[]", path)[0] if re.search(r"[.\[]", path) or path == "prior" else ""


# Keys of the section planner that are not specific to SEE and SEE++, and ablation switches.
COMMON_KEYS = re.compile(
    r"\| `planner\.(name|file|preset|goal|density|resolution_radius|spacing|view_distance|scene_box\.\w+"
    r"|wanted_coverage|target_coverage|least_gain|min_gain)`")
ABLATION_KEYS = re.compile(r"\| `planner\.(ideas|ablation)\.")


def is_see_key(row):
    return not COMMON_KEYS.match(row) and not ABLATION_KEYS.match(row)


def keys_part(build, words):
    """Returns the keys of sections; for the section planner, the keys of one kind."""
    rows = key_rows(build)
    kinds = {"planner": COMMON_KEYS.match, "see": is_see_key, "ablation": ABLATION_KEYS.match}
    chosen = []
    for word in words:
        section = {"general": "", "see": "planner", "ablation": "planner"}.get(word, word)
        found = [row for row in rows if section_of(row) == section
                 and kinds.get(word, lambda _: True)(row)]
        if not found:
            raise SystemExit(f"there are no keys of {word}")
        chosen += found
    return ("\n| Key | Value | Default | Meaning |\n| --- | --- | --- | --- |\n"
            + "\n".join(chosen) + "\n\n")


def missing_keys(build, text):
    """Returns the keys that no part of the page lists."""
    return [row for row in key_rows(build) if row not in text]


# Python.

def python_part(build):
    sys.path.insert(0, str(build / "python"))
    try:
        import skycap  # pylint: disable=import-outside-toplevel
    except ImportError as failure:
        raise MissingProgram("the Python module") from failure
    stub = ast.parse((ROOT / "python" / "__init__.pyi").read_text(encoding="utf-8"))
    text = "\n## Functions\n"
    for node in stub.body:
        if isinstance(node, ast.FunctionDef):
            text += f"\n### skycap.{node.name}\n" + function_text(node, getattr(skycap, node.name))
    text += "\n## Classes\n"
    for node in stub.body:
        if isinstance(node, ast.ClassDef):
            text += class_text(node, getattr(skycap, node.name))
    return text + "\n"


def documentation(thing):
    """Returns a docstring without the signature that pybind11 puts first."""
    text = inspect.cleandoc(getattr(thing, "__doc__", None) or "")
    text = re.sub(r"\A\w+\([^\n]*\n--\n+", "", text)
    return re.sub(r"\A\w+\(self[^\n]*\n+", "", text).strip()


def markdown(text):
    """Returns a docstring as one line of Markdown."""
    return cell(" ".join(text.split())).replace("\\|", "|")


def signature(node, prefix="", skips_self=False):
    arguments = ast.unparse(node.args)
    if skips_self:
        arguments = re.sub(r"\Aself(?:, )?", "", arguments)
    returns = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    return f"{prefix}{node.name}({arguments}){returns}"


def function_text(node, thing):
    paragraphs = map(markdown, documentation(thing).split("\n\n"))
    text = "\n\n".join(paragraphs)
    return f"\n```python\n{signature(node, 'skycap.')}\n```\n\n{text}\n"


def class_text(node, thing):
    text = f"\n### skycap.{node.name}\n\n{markdown(documentation(thing))}\n"
    rows = []
    for member in node.body:
        if isinstance(member, ast.AnnAssign):
            rows.append([code(member.target.id), code(ast.unparse(member.annotation)), ""])
        elif isinstance(member, ast.FunctionDef) and member.name not in ("__iter__", "__next__"):
            rows.append(member_row(node, member, thing))
    return text + ("\n" + table(["Member", "Type", "Meaning"], rows) if rows else "")


def member_row(node, member, thing):
    decorators = {ast.unparse(decorator) for decorator in member.decorator_list}
    meaning = markdown(documentation(getattr(thing, member.name, None))).replace("|", "\\|")
    returns = ast.unparse(member.returns).replace("|", "\\|") if member.returns else ""
    if "property" in decorators:
        return [code(member.name), code(returns), meaning]
    if member.name.startswith("__"):
        meaning = ""
    if member.name == "__init__":
        call = signature(member, skips_self=True).replace("__init__", node.name).split(" -> ")[0]
        return [code(call), "constructor", meaning]
    arguments = signature(member, skips_self=True).split(" -> ")[0].replace("|", "\\|")
    return [code(arguments), code(returns), meaning]


# Messages.

AREAS = [  # (part of the path, title of the messages); the first match is used
    (r"clients/ros2", "skycap_ros2"),
    (r"missions/cli/", "Command line"),
    (r"missions/config/preset_files|missions/config/(sensor|vehicle)_reader|sim/sensors",
     "Sensors and vehicle files"),
    (r"missions/config/(mission_rules|derived)|missions/(simulation|session)",
     "Missions that cannot work"),
    (r"missions/(config|wizard)", "Mission files"),
    (r"missions/site_data", "Prior data and `site`"),
    (r"missions/scene|sim/models", "Scenes"),
    (r"missions/online/live", "Live surveys"),
    (r"missions/online/guided", "`fly`"),
    (r"missions/online/recordings", "Recordings"),
    (r"missions/scan", "Scans"),
    (r"missions/batch|flight/district", "Campaigns and districts"),
    (r"missions/package/fleet|flight/fleet", "Several vehicles"),
    (r"flight/flown|missions/comparison", "`compare`"),
    (r"flight/calibration", "`calibrate`"),
    (r"flight/interpreter", "Checking a route file"),
    (r"flight/(export|link)", "Route files"),
    (r"^flight/", "Flight planning"),
    (r"geometry/(io|points|files)", "Point clouds, meshes and files"),
    (r"missions/(package|report|api)", "Packages and reports"),
    (r"^survey/", "Planners"),
]
OTHERS = "Other messages"


def sources():
    listed = subprocess.run(["git", "ls-files", "*.cpp", "*.h"], cwd=ROOT, capture_output=True,
                            text=True, check=True).stdout.split()
    return [name for name in listed if not name.startswith(("tests/", "examples/"))]


def area_of(name):
    return next((title for pattern, title in AREAS if re.search(pattern, name)), OTHERS)


def message_code(text):
    return code(text.replace("`", "'").replace("|", "\\|"))


def messages_part(_build):
    found = {title: {} for title in dict.fromkeys([*(title for _, title in AREAS), OTHERS])}
    for name in sorted(sources()):
        source = (ROOT / name).read_text(encoding="utf-8")
        for message in source_messages.messages_in(source):
            found[area_of(name)].setdefault(message)
    text = ""
    titles = sorted(found, key=lambda title: title == "skycap_ros2")  # the program itself first
    for title, messages in ((title, found[title]) for title in titles):
        if messages:
            rows = [[message_code(problem), cell(remedy)] for problem, remedy in
                    sorted(messages, key=lambda message: message[0].lstrip("…'\" ").lower())]
            text += f"\n## {title}\n\n" + table(["Message", "Rule or remedy"], rows)
    return text + "\n"


def part(name, build):
    """Returns the text of a generated part."""
    words = name.split()
    makers = {"commands": commands_part, "python": python_part, "messages": messages_part,
              "ros2 options": ros2_part}
    if words[0] == "keys":
        return keys_part(build, words[1:])
    if name not in makers:
        raise SystemExit(f"there is no generated part '{name}'")
    return makers[name](build)


def renewed(page, text, build, skips_missing):
    """Returns the updated page."""
    def renew(match):
        try:
            return match[1] + part(match[2], build) + match[4]
        except MissingProgram as missing:
            if not skips_missing:
                raise SystemExit(f"{page}: part '{match[2]}' needs {missing}; build it, or give "
                                 "--skip-missing") from missing
            print(f"{page}: part '{match[2]}' is not compared: {missing} is not built")
            return match[0]
    text = PART.sub(renew, text)
    if "<!-- generated: keys" in text and (rows := missing_keys(build, text)):
        raise SystemExit(f"{page}: no part lists " + ", ".join(row.split("`")[1] for row in rows))
    return text


def stale_pages(build, writes, skips_missing):
    """Updates the pages or prints the differences. Yields the stale pages."""
    for page in sorted(PAGES.glob("*.md")):
        name = page.relative_to(ROOT)
        text = page.read_text(encoding="utf-8")
        new = renewed(name, text, build, skips_missing)
        if new == text:
            continue
        yield name
        if writes:
            page.write_text(new, encoding="utf-8")
        else:
            sys.stdout.writelines(difflib.unified_diff(
                text.splitlines(True), new.splitlines(True), f"{name} as written",
                f"{name} as the program has it", n=0))


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, required=True, help="build folder")
    parser.add_argument("--check", action="store_true", help="change nothing")
    parser.add_argument("--skip-missing", action="store_true",
                        help="leave parts whose program is not built")
    arguments = parser.parse_args()
    os.environ.pop("SKYCAP_INSTRUCTION_SET", None)
    build = arguments.program.resolve()
    stale = list(stale_pages(build, not arguments.check, arguments.skip_missing))
    print(f"reference: {len(stale)} pages {'stale' if arguments.check else 'renewed'}")
    if stale and arguments.check:
        print("renew them: docs/generate_reference.py --program BUILD_FOLDER")
    return 1 if stale and arguments.check else 0


if __name__ == "__main__":
    sys.exit(main())
