"""The blocks of a page that are run.

A block is checked if the line before it, blank ones not counted, is a comment of these:

    <!-- checked -->                     its commands are run; what they print is compared
    <!-- checked, times of: planning --> the same; in lines whose first word is `planning` (more
                                         words after commas) every number stands for any number
    <!-- checked as: small.yaml -->      it is put into this file, for later commands of the page

It is indented by four spaces or fenced. A command follows "$ " and goes on after a backslash at the
end of a line; the lines up to the next one are what it prints, errors included. "..." stands for
anything within a line. A command that does not exit with 0 has a last line "(exit code 1)". All
commands of a page run in one scratch folder with the program, the missions and the docs in it.

What follows ">>> ", and goes on after "... " on the next lines, are statements of Python: all of a
page run in one interpreter, for which `import skycap` is the module that was built.
"""

import dataclasses
import json
import pathlib
import re
import subprocess

MARK = re.compile(r"^<!-- checked(?:(, times of| as): (.+?))? -->$")
NUMBER = re.compile(r"\d+(?:\.\d+)?")
MOST_SECONDS = 900  # of a command: it hangs, also on a machine with other work
PYTHON = "/usr/bin/python3"  # for which the module is built
PROMPT, CONTINUED = ">>> ", "..."


@dataclasses.dataclass
class Block:
    """Lines of a page, without their indentation; `first` counts from 0."""

    first: int
    lines: list
    indent: str
    kind: str  # None, "as" or "times of"
    argument: str


@dataclasses.dataclass
class Step:
    """A command and what the page says that it prints."""

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
        """The output without the blank lines that part it from the next command."""
        return "\n".join(self.output).rstrip("\n").split("\n") if any(self.output) else []


def blocks(lines):
    """The checked blocks of a page, in order."""
    found = []
    for number, line in enumerate(lines):
        mark = MARK.match(line)
        if line.startswith("<!-- checked") and not mark:
            raise SystemExit(f"line {number + 1}: {line} is no mark that docs_blocks.py knows")
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
    """A blank line belongs to an indented block if the next one does."""
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
    """The interpreter of a page, which runs from its first statement on."""

    def __init__(self, folder, environment):
        self._folder, self._environment, self._process = folder, environment, None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self._process:
            self._process.communicate()

    def run(self, step):
        """What the statement prints."""
        if not self._process:
            self._process = subprocess.Popen(
                [PYTHON, pathlib.Path(__file__).with_name("docs_session.py")], cwd=self._folder,
                env=self._environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self._process.stdin.write(json.dumps(step.statement()) + "\n")
        self._process.stdin.flush()
        printed = json.loads(self._process.stdout.readline()).rstrip("\n")
        return printed.split("\n") if printed else []


def run(step, folder, environment):
    """What the command prints, and its exit code as a line if it is not 0."""
    done = subprocess.run(
        ["bash", "-c", step.shell()], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=MOST_SECONDS, text=True,
        check=False)
    printed = done.stdout.rstrip("\n").split("\n") if done.stdout else []
    return printed + ([f"(exit code {done.returncode})"] if done.returncode else [])


def agrees(written, printed, words_of_times):
    """Whether the page's line stands for the printed one."""
    if written.split()[:1] and written.split()[0] in words_of_times:
        written, printed = (NUMBER.sub("0", line) for line in (written, printed))
    pattern = ".*".join(re.escape(part) for part in written.split("..."))
    return re.fullmatch(pattern, printed) is not None


def renewed(step, printed, words_of_times):
    """The output that the page should have; the page's own lines where they agree."""
    written = step.expected()
    if len(written) == len(printed):
        printed = [old if agrees(old, new, words_of_times) else new
                   for old, new in zip(written, printed)]
    return printed + step.output[len(written):]
