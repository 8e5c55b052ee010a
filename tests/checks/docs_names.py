"""Checks that names on a page exist: links, paths, commands with their options, keys of mission files,
tests, and identifiers of the sources.
"""

import functools
import json
import pathlib
import re
import shlex
import subprocess

import docs_messages
import docs_results

CODE_SPAN = re.compile(r"`([^`]+)`")
LINK = re.compile(r"\]\(([^)\s]+)\)")
COMMAND = re.compile(
    r"(?<!\S)(?:(?:\./)?skycap |skycap_ros2 |cmake --|ctest --|build/|tests/checks/|docs/)")
PATH = re.compile(r"[\w./-]+/[\w.-]+\.\w+")
TEST_NAME = re.compile(r"[A-Z]\w+\.[A-Z]\w+\*?")
KEY = re.compile(r"[a-z_]+(?:\.[a-z_]+)+")
IDENTIFIER = re.compile(r"(?:\w+::)*([a-z]+(?:_[a-z0-9]+)+)(?:\(\))?|(?:\w+::)+(\w+)")
RECORDS = "docs/development/results/"
GENERATED = re.compile(r"<!-- generated: .*?<!-- end of generated -->", re.DOTALL)
FILE_TYPES = ("bin", "csv", "hold", "html", "journal", "json", "las", "laz", "pcd", "plan", "ply", "rawlog", "tum",
              "xyz")
SCRIPTS = re.compile(r"skycap|docs/[^/]+\.py|docs/build_site|docs/pictures/\w+|tests/(checks|fuzz|faults)/\w+")
PLACEHOLDER = re.compile(r"[A-Z]{2,}|\.\.\.|\bN\b")


class Names:
    """Existing names: tracked files, commands and options of the program, keys, tests."""

    def __init__(self, root, program):
        self.root, self.program = root, program
        listed = subprocess.run(["git", "ls-files"], cwd=root, capture_output=True, text=True,
                                check=True).stdout.split("\n")
        self.files = {name for name in listed if name}
        sources = [root / name for name in self.files
                   if name.endswith((".cpp", ".h", ".in", ".txt", ".yaml", ".json"))]
        self.words = set()
        self.tests = set()
        for source in sources:
            text = source.read_text(encoding="utf-8")
            self.words.update(re.findall(r"\w+", text))
            self.tests.update(f"{suite}.{name}" for suite, name in re.findall(
                r"TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\)", text))
        schema = json.loads((root / "missions/mission.schema.json").read_text())
        self.keys = set(keys_of(schema))
        self.messages = docs_messages.listed(
            (root / docs_messages.PAGE).read_text(encoding="utf-8"))
        self.fields = set()
        for fields in docs_results.listed_fields(
                (root / docs_results.PAGE).read_text(encoding="utf-8")).values():
            self.fields |= {part for field in fields for part in with_parents(field)}
        scripts = [root / name for name in self.files if SCRIPTS.fullmatch(name)]
        self.script_options = set(re.findall(
            r"--[a-z][a-z-]+", " ".join(script.read_text(encoding="utf-8") for script in scripts)))
        self.presets = {preset["name"] for preset in json.loads(
            (root / "CMakePresets.json").read_text())["configurePresets"]}

    @functools.cache
    def help(self, verb):
        """Returns the output of `skycap VERB --help`; empty if the command does not exist."""
        if verb not in self.verbs():
            return None
        return subprocess.run([self.program / "skycap", verb, "--help"], capture_output=True,
                              text=True, check=True).stdout

    @functools.cache
    def ros2_help(self):
        """Returns the output of `skycap_ros2 --help`; empty if it is not built."""
        program = self.program / "skycap_ros2"
        if not program.exists():
            return None
        return subprocess.run([program, "--help"], capture_output=True, text=True,
                              check=True).stdout

    @functools.cache
    def program_help(self):
        """What `skycap --help` prints: the options of all commands, and the commands."""
        return subprocess.run([self.program / "skycap", "--help"], capture_output=True, text=True,
                              check=True).stdout

    @functools.cache
    def verbs(self):
        text = self.program_help()
        return re.findall(r"^  ([\w-]+) ", text[text.index("Subcommands"):], re.MULTILINE)

    def has_path(self, path):
        path = path.rstrip("/")
        return path in self.files or any(name.startswith(path + "/") for name in self.files)


def with_parents(field):
    """Returns the names of a field and of the objects that contain it, with and without list
    marks."""
    parts = field.split(".")
    for count in range(1, len(parts) + 1):
        name = ".".join(parts[:count])
        yield name
        yield name.replace("[]", "")


def keys_of(schema, prefix=""):
    for name, property in schema.get("properties", {}).items():
        yield prefix + name
        yield from keys_of(property, prefix + name + ".")


def complaints(page, text, names):
    """Yields (line number from 1, problem) for a page with a path relative to the root. Records of
    other versions and generated parts may contain other names."""
    lines = text.split("\n")
    for number, line in enumerate(lines, 1):
        for target in LINK.findall(CODE_SPAN.sub("", line)):
            yield from ((number, wrong) for wrong in link_complaints(page, target, names))
    if str(page) == "CHANGELOG.md" or str(page).startswith(RECORDS):
        return
    for number, code in code_of(without_generated(text).split("\n")):
        yield from ((number, wrong) for wrong in code_complaints(code, names))


def without_generated(text):
    """Returns the page with blank lines instead of its generated parts
    (docs/generate_reference.py)."""
    return GENERATED.sub(lambda match: "\n" * match[0].count("\n"), text)


def code_of(lines):
    """Returns (line number, code) for code spans in paragraphs, and for the commands of blocks with
    their continuation lines."""
    paragraph, fenced, number = [], False, 0
    while number < len(lines):
        line = lines[number]
        number += 1
        fenced ^= line.startswith("```")
        if not fenced and not line.startswith(("    ", "```")):
            paragraph.append(line)
            if line.strip() and number < len(lines):
                continue
        yield from spans(paragraph, number - len(paragraph))
        paragraph = []
        first = number
        while line.endswith("\\") and number < len(lines):
            line = line[:-1] + lines[number].strip()
            number += 1
        if command := command_in(line):
            yield first, command


def spans(paragraph, lines_before):
    text = "\n".join(paragraph)
    for span in CODE_SPAN.finditer(text):
        yield lines_before + 1 + text.count("\n", 0, span.start()), span[1].replace("\n", " ")


def command_in(block_line):
    """Returns the command in a line of a block, without prompt, comment and wrapping command."""
    text = re.split(r"\s{3,}|\s#\s", block_line.strip().removeprefix("$ "))[0]
    start = COMMAND.search(text)
    return text[start.start():] if start else None


def code_complaints(code, names):
    if COMMAND.match(code):
        for command in code.split(" && "):
            yield from command_complaints(command, names)
    elif code.startswith("--"):
        option = re.split(r"[ =]", code)[0]
        if (option not in names.script_options
                and option not in names.program_help()
                and not any(option in names.help(verb) for verb in names.verbs())):
            yield f"no command has the option {option}"
    elif TEST_NAME.fullmatch(code):
        if not any(re.fullmatch(code.replace("*", ".*"), test) for test in names.tests):
            yield f"there is no test {code}"
    elif KEY.fullmatch(code) and code.split(".")[0] in names.keys:
        if (code not in names.keys and code not in names.fields
                and code.split(".")[-1] not in FILE_TYPES):
            yield f"there is no key {code}"
    elif PATH.fullmatch(code):
        if code.split("/")[0] in {name.split("/")[0] for name in names.files}:
            if not names.has_path(code):
                yield f"there is no file {code}"
    elif found := IDENTIFIER.fullmatch(code):
        word = found[1] or found[2]
        if word not in names.words:
            yield f"no source mentions {word}"


def command_complaints(command, names):
    words = shlex.split(command)
    if words[0] in ("skycap", "./skycap"):
        yield from skycap_complaints(words[1:], names)
    elif words[0] == "skycap_ros2":
        for option in (word.split("=")[0] for word in words[1:] if word.startswith("--")):
            if names.ros2_help() and option not in names.ros2_help():
                yield f"skycap_ros2 has no option {option}"
    elif "--preset" in words:
        preset = words[words.index("--preset") + 1]
        if preset not in names.presets:
            yield f"there is no preset {preset}"
    elif words[0].count("/") > 1 and words[0].startswith("build/"):
        built = words[0].split("/", 2)[2]
        if not names.has_path(source_of(built)) and not names.has_path(built):
            yield f"nothing builds {words[0]}"
    elif words[0].startswith(("tests/", "docs/")) and not names.has_path(words[0]):
        yield f"there is no {words[0]}"


def source_of(program):
    """Returns the source of a benchmark, or the folder of a test program."""
    return program.removesuffix("_test") if program.endswith("_test") else program + ".cpp"


def skycap_complaints(words, names):
    if not words or words[0] in ("test", "install") or PLACEHOLDER.search(words[0]):
        return
    help_text = names.help(words[0]) if not words[0].startswith("-") else ""
    if help_text is None:
        yield f"skycap has no verb {words[0]}"
        return
    for option in (word.split("=")[0] for word in words[1:] if word.startswith("--")):
        if not re.search(rf"(?<![\w-]){re.escape(option)}(?![\w-])",
                         help_text + names.program_help()):
            yield f"skycap {words[0]} has no option {option}"
    for word, value in zip(words, words[1:]):
        key = value.split("=")[0]
        if word == "--set" and not PLACEHOLDER.search(key) and key not in names.keys:
            yield f"there is no key {key}"
    for word in words:
        if re.match(r"(?:\.\./)?missions/", word) and not PLACEHOLDER.search(word):
            if not names.has_path(word):
                yield f"there is no file {word}"


def link_complaints(page, target, names):
    if re.match(r"\w+:", target):
        return
    path, _, anchor = target.partition("#")
    linked = (page.parent / path) if path else page
    linked = pathlib.PurePosixPath(*normal_parts(linked))
    if not names.has_path(str(linked)):
        yield f"the link to {target} leads nowhere"
    elif anchor and anchor not in anchors(names.root / linked):
        yield f"{linked} has no heading #{anchor}"


def normal_parts(path):
    parts = []
    for part in path.parts:
        if part == "..":
            parts.pop()
        else:
            parts.append(part)
    return parts


def anchors(page):
    headings = re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", re.sub(r"\\(.)", r"\1", heading).lower()).replace(" ", "-")
            for heading in headings}
