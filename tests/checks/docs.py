"""Checks README.md, CONTRIBUTING.md, CHANGELOG.md and docs/**/*.md, or the named pages. Runs their
checked blocks (docs_blocks.py), looks up the names in them (docs_names.py), and checks their size and
form (docs_pages.py). Without named pages it also compares the generated reference
(docs/generate_reference.py), the exit codes (docs_exit_codes.py) and the fields of results
(docs_results.py) with the program. With --write it updates the output of commands in the pages. Exit
code 1: something is stale.
"""

import argparse
import difflib
import os
import pathlib
import subprocess
import sys
import tempfile

import docs_blocks
import docs_exit_codes
import docs_messages
import docs_names
import docs_pages
import docs_results

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROOT_PAGES = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")


def scratch_folder(folder, program):
    """Creates the files that the commands of the pages require."""
    for name in ("missions", "docs", "examples", "tests"):
        (folder / name).symlink_to(ROOT / name)
    (folder / "build").mkdir()
    (folder / "build" / "release").symlink_to(program)
    (folder / "skycap").symlink_to(program / "skycap")
    return dict(os.environ, PATH=f"{program}:{os.environ['PATH']}",
                XDG_CACHE_HOME=str(folder / "cache"), PYTHONPATH=str(program / "python"))


def run_block(block, folder, environment, session):
    """Returns the updated lines of the block."""
    if block.kind == "as":
        (folder / block.argument).write_text("\n".join(block.lines) + "\n", encoding="utf-8")
        return block.lines
    words_of_times = block.argument.split(", ") if block.argument else []
    lines = []
    for step in docs_blocks.steps(block):
        printed = (session.run(step) if step.is_python()
                   else docs_blocks.run(step, folder, environment))
        lines += step.command + docs_blocks.renewed(step, printed, words_of_times)
    return lines


def run_page(text, program):
    """Returns the updated page and the blocks that were run."""
    lines = text.split("\n")
    blocks = docs_blocks.blocks(lines)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        environment = scratch_folder(folder, program)
        with docs_blocks.Session(folder, environment) as session:
            renewed = [run_block(block, folder, environment, session) for block in blocks]
    for block, new in reversed(list(zip(blocks, renewed))):
        indented = [(block.indent + line).rstrip() for line in new]
        lines[block.first:block.first + len(block.lines)] = indented
    return "\n".join(lines), blocks


def check(page, names, program, write):
    """Returns whether the page is correct, and the number of blocks that were run."""
    text = (ROOT / page).read_text(encoding="utf-8")
    renewed, run = run_page(text, program)
    checked = {block.first + 1 + i for block in run for i in range(len(block.lines))}
    wrong = [(number, complaint) for number, complaint in docs_names.complaints(page, text, names)
             if number not in checked]
    wrong += docs_pages.page_complaints(str(page), text)
    if not str(page).startswith(docs_names.RECORDS):
        wrong += docs_messages.complaints(text, names.messages)
    for number, complaint in wrong:
        print(f"{page}:{number}: {complaint}")
    if renewed != text and write:
        (ROOT / page).write_text(renewed, encoding="utf-8")
    elif renewed != text:
        sys.stdout.writelines(difflib.unified_diff(
            text.splitlines(True), renewed.splitlines(True), f"{page} as written",
            f"{page} as the program has it", n=1))
    return not wrong and (write or renewed == text), len(run)


def check_tree(names, program, write):
    """Returns whether the index, the pictures and the reference are correct."""
    wrong = list(docs_pages.tree_complaints(ROOT, names.files))
    text = (ROOT / docs_results.PAGE).read_text(encoding="utf-8")
    wrong += [(docs_results.PAGE, complaint)
              for complaint in docs_results.complaints(text, program)]
    wrong += [(docs_exit_codes.PAGE, complaint)
              for complaint in docs_exit_codes.complaints(ROOT, names.verbs())]
    for name, complaint in wrong:
        print(f"{name}: {complaint}")
    generator = [sys.executable, ROOT / "docs" / "generate_reference.py", "--program", program,
                 "--skip-missing", *([] if write else ["--check"])]
    return subprocess.run(generator, check=False).returncode == 0 and not wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", type=pathlib.Path, required=True, help="build folder")
    parser.add_argument("--write", action="store_true", help="renew the pages")
    parser.add_argument("pages", nargs="*", help="relative to the root; default: all")
    arguments = parser.parse_args()
    program = (ROOT / arguments.program).resolve()
    names = docs_names.Names(ROOT, program)
    is_tree_right = bool(arguments.pages) or check_tree(names, program, arguments.write)
    pages = arguments.pages or sorted(
        name for name in names.files
        if name in ROOT_PAGES or (name.startswith("docs/") and name.endswith(".md")))
    results = [check(pathlib.PurePosixPath(page), names, program, arguments.write)
               for page in pages]
    print(f"docs: {len(pages)} pages, {sum(count for _, count in results)} blocks run, "
          f"{sum(not good for good, _ in results)} pages stale")
    return 0 if is_tree_right and all(good for good, _ in results) else 1


if __name__ == "__main__":
    sys.exit(main())
