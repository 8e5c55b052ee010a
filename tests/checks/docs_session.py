"""Runs statements of a page one after the other, as Python's own prompt does, but of an exception
shows the last line alone. Each line of standard input is a statement, as JSON; so is each answer,
what it prints."""

import code
import contextlib
import io
import json
import sys
import traceback


class Prompt(code.InteractiveInterpreter):
    def showtraceback(self):
        self.write("".join(traceback.format_exception_only(*sys.exc_info()[:2])))


def main():
    prompt = Prompt({"__name__": "__main__"})
    for line in sys.stdin:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
            prompt.runsource(json.loads(line) + "\n", "<page>", "single")
        print(json.dumps(printed.getvalue()), flush=True)


if __name__ == "__main__":
    main()
