"""Tests of tests/checks/nightly: its list is complete, each check has its turn, and runs are limited."""
import datetime, importlib.machinery, importlib.util, pathlib, subprocess, tempfile, unittest

root = pathlib.Path(__file__).resolve().parents[2]
loader = importlib.machinery.SourceFileLoader("nightly", str(root / "tests/checks/nightly"))
nightly = importlib.util.module_from_spec(importlib.util.spec_from_loader("nightly", loader))
loader.exec_module(nightly)

date = datetime.date(2026, 1, 1)


class NightlyTest(unittest.TestCase):
    def test_every_check_script_is_run_by_a_machine(self):
        commands = (root / ".ci/run").read_text() + "".join(check.command for check in nightly.checks(date))
        scripts = [path.name for path in (root / "tests/checks").iterdir()
                   if path.is_file() and not path.suffix and path.name != "nightly"]
        self.assertGreater(len(scripts), 10)
        ci = ["format", "language", "docs"]  # names in a loop of .ci/run
        missing = [name for name in scripts if f"checks/{name}" not in commands and name not in ci]
        self.assertEqual(missing, [])

    def test_every_check_starts_within_as_many_nights_as_checks_take_turns(self):
        started = set()
        for night in range(sum(check.turn == "rotating" for check in nightly.checks(date))):
            remaining = 6 * 60
            for check in nightly.in_order(date + datetime.timedelta(night)):
                if check.minutes <= remaining:
                    remaining -= check.minutes
                    started.add(check.name)
        self.assertEqual(started, {check.name for check in nightly.checks(date)})

    def test_a_check_fails_passes_or_exceeds_its_time(self):
        with tempfile.TemporaryDirectory() as folder:
            log = pathlib.Path(folder) / "log"
            for command, verdict in (("echo said", "passed"), ("exit 3", "failed"),
                                     ("sleep 1000 & echo $!; wait", "exceeded its time")):
                check = nightly.Check("name", command, "daily", 1)
                self.assertEqual(nightly.run(check, log, 2 if "sleep" in command else 60), verdict)
            sleeper = log.read_text().strip()
            state = subprocess.run(["ps", "-o", "stat=", "-p", sleeper], capture_output=True, text=True)
            self.assertIn(state.stdout.strip()[:1], ("", "Z"))  # killed with its parent


if __name__ == "__main__":
    unittest.main()
