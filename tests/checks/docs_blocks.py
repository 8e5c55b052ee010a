"""Checked blocks of a page.

A block is checked if one of these comments precedes it, with or without blank lines between:

    <!-- checked -->                     runs its commands and compares their output
    <!-- checked, times of: planning --> the same, but in lines that start with the word `planning`
                                         (more words after commas) numbers match any number
    <!-- checked as: small.yaml -->      writes it to this file, for later commands of the page

Blocks are indented by four spaces or fenced. A command follows "$ " and continues after a backslash
at the end of a line. The lines up to the next command are its output, including errors. "..." matches
any text within a line. If the exit code is not 0, the last line is "(exit code 1)". All commands of a
page run in one scratch folder with the program, the missions and the docs.

Lines after ">>> ", continued after "... ", are Python statements. All statements of a page run in one
interpreter, in which `import skycap` imports the built module.
"""

import dataclasses
import json
import pathlib
import re
import subprocess

MARK = re.compile(r"^<!-- checked(?:(, times of| as): (.+?))? -->$")
# Number or range with its unit of time: a duration near 1 s is printed in s or ms.
NUMBER = re.compile(r"\d+(?:\.\d+)?(?: to \d+(?:\.\d+)?)?(?: (?:us|ms|s|min|h)\b)?")
MOST_SECONDS = 900  # limit for one command, sufficient on a busy machine
PYTHON = "/usr/bin/python3"  # the module is built for this interpreter
PROMPT, CONTINUED = ">>> ", "..."


@dataclasses.dataclass
class Block:
    """Lines of a page without their indentation. `first` is the index of the first one."""

    first: int
    lines: list
    indent: str
    kind: str  # None, "as" or "times of"
    argument: str


@dataclasses.dataclass
class Step:
    """A command and its output according to the page."""

    command: list  # lines as written, from "$ " or ">>> " on
    output: list

    def is_python(self):
        return self.command[0].startswith(PROMPT)

    def shell(self):
        return "\n".join(self.command)[2:]

    def statement(self):
        return "\n".join(line[len(PROMPT):] for line in self.command)

    def goes_on_with(self, line):
        if self.output:
            return False
        if self.is_python():
            return line.split(" ")[0] == CONTINUED
        return self.command[-1].endswith("\\")

    def expected(self):
        """Returns the output without the blank lines before the next command."""
        return "\n".join(self.output).rstrip("\n").split("\n") if any(self.output) else []


def blocks(lines):
    """Returns the checked blocks of a page in order."""
    found = []
    for number, line in enumerate(lines):
        mark = MARK.match(line)
        if line.startswith("<!-- checked") and not mark:
            raise SystemExit(f"line {number + 1}: unknown mark {line}")
        if mark:
            found.append(block_after(lines, number, mark))
    return found


def block_after(lines, number, mark):
    first = number + 1
    while first < len(lines) and not lines[first].strip():
        first += 1
    if first == len(lines) or not lines[first].startswith(("    ", "```")):
        raise SystemExit(f"line {number + 1}: no block follows")
    fenced = lines[first].startswith("```")
    first += fenced
    last = first
    while last < len(lines) and (lines[last] != "```" if fenced else is_indented(lines, last)):
        last += 1
    indent = "" if fenced else "    "
    kind = (mark[1] or "").strip(", ") or None
    return Block(first, [line[len(indent):] for line in lines[first:last]], indent, kind, mark[2])


def is_indented(lines, number):
    """Returns true if the line belongs to an indented block. A blank line does if the next one
    does."""
    if lines[number].strip():
        return lines[number].startswith("    ")
    return number + 1 < len(lines) and lines[number + 1].startswith("    ")


def steps(block):
    found = []
    for line in block.lines:
        if line.startswith(("$ ", PROMPT)):
            found.append(Step([line], []))
        elif not found:
            raise SystemExit(f"line {block.first + 1}: a checked block starts with '$ COMMAND'")
        elif found[-1].goes_on_with(line):
            found[-1].command.append(line)
        else:
            found[-1].output.append(line)
    return found


class Session:
    """Python interpreter of a page, which runs from its first statement on."""

    def __init__(self, folder, environment):
        self._folder, self._environment, self._process = folder, environment, None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self._process:
            self._process.communicate()

    def run(self, step):
        """Returns the output of the statement."""
        if not self._process:
            self._process = subprocess.Popen(
                [PYTHON, pathlib.Path(__file__).with_name("docs_session.py")], cwd=self._folder,
                env=self._environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self._process.stdin.write(json.dumps(step.statement()) + "\n")
        self._process.stdin.flush()
        printed = json.loads(self._process.stdout.readline()).rstrip("\n")
        return printed.split("\n") if printed else []


def run(step, folder, environment):
    """Returns the output of the command, with the exit code as a line if it is not 0."""
    done = subprocess.run(
        ["bash", "-c", step.shell()], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=MOST_SECONDS, text=True,
        check=False)
    printed = done.stdout.rstrip("\n").split("\n") if done.stdout else []
    return printed + ([f"(exit code {done.returncode})"] if done.returncode else [])


def agrees(written, printed, words_of_times):
    """Returns true if the page's line matches the printed one."""
    if written.split()[:1] and written.split()[0] in words_of_times:
        written, printed = (NUMBER.sub("0", line) for line in (written, printed))
    pattern = ".*".join(re.escape(part) for part in written.split("..."))
    return re.fullmatch(pattern, printed) is not None


def renewed(step, printed, words_of_times):
    """Returns the updated output. Matching lines of the page are kept."""
    written = step.expected()
    if len(written) == len(printed):
        printed = [old if agrees(old, new, words_of_times) else new
                   for old, new in zip(written, printed)]
    return printed + step.output[len(written):]
