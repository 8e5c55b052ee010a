"""Runs Python statements one after the other, like the interactive interpreter, but prints only the last
line of an exception. Each line of standard input is a JSON string with a statement. Each line of
standard output is a JSON string with its output.
"""

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
