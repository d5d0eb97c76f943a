"""Trial of one mutant: it is inserted into a copy of the tree, tested, and removed."""

from __future__ import annotations

import difflib
import re
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from processor import run
from reach import Chosen
from sites import Fault
from tree_copy import TreeCopy

FAILED = re.compile(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$", re.MULTILINE)
NO_TESTS, PASSED, USAGE = 5, 0, 4


@dataclass
class Trial:
    """Result of the trial of a mutant.

    The result is `caught`, `timeout` (also caught), `survived` or `not reached`.
    """

    name: str
    file: str
    line: int
    operator: str
    diff: list[str]
    word: str = "not reached"
    tests: int = 0
    by: str | None = None
    took_s: float = 0.0
    package: str = ""
    seed: int = 0

    @property
    def caught(self) -> bool:
        """True if a test failed or exceeded its time limit."""
        return self.word in ("caught", "timeout")

    def row(self) -> dict[str, Any]:
        """Return the result of the mutant as a dictionary for a JSON line."""
        return asdict(self)


@dataclass
class Bench:
    """Copy of the tree for trials, with the tests that pass in it without a mutant."""

    copy: TreeCopy
    sound: dict[str, bool] = field(default_factory=dict)

    def pytest(
        self, tests: list[str], limit_s: float, without: Sequence[str] = ()
    ) -> tuple[int | None, str]:
        """Run tests in the copy, in order, up to the first failure, except those in `without`.

        Returns the exit code (None: out of time) and the output.
        """
        command = [sys.executable, "-m", "pytest", "-x", "-rfE", "--tb=no"]
        command += ["-p", "no:cacheprovider", *tests]
        command += [word for test in without for word in ("--deselect", test)]
        environment = self.copy.environment | {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
        code, output, _ = run(command, self.copy.folder, environment, limit_s)
        return code, output

    def is_sound(self, test: str) -> bool:
        """Return True if a test passes without a mutant; otherwise its failure is not evidence."""
        if test not in self.sound:
            code, _ = self.pytest([test], 600.0)
            self.sound[test] = code == PASSED
        return self.sound[test]

    def tried(self, fault: Fault, chosen: Chosen) -> Trial:
        """Insert a mutant into the copy, run its tests and return the result."""
        path = self.copy.folder / fault.file
        before = path.read_text("utf-8")
        after = fault.applied(before)
        lines = difflib.unified_diff(before.splitlines(), after.splitlines(), lineterm="", n=0)
        diff = [line for line in lines if line[:3] not in ("---", "+++") and line[:2] != "@@"]
        trial = Trial(fault.name, fault.file, fault.line, fault.operator, diff)
        # A test file may have been removed since the measurement.
        tests = [t for t in chosen.tests if (self.copy.folder / t.split("::")[0]).is_file()]
        trial.tests = len(tests)
        limit_s = 60.0 + 6.0 * chosen.seconds
        begun = time.monotonic()
        struck_off: list[str] = []
        while tests:
            path.write_text(after, "utf-8")
            try:
                code, output = self.pytest(tests, limit_s, struck_off)
            finally:
                path.write_text(before, "utf-8")
            match = FAILED.search(output)
            trial.by = match.group(1) if match else None
            # A mutant that cannot be imported also reports missing tests.
            if code == NO_TESTS or (code == USAGE and not self.is_sound(tests[0])):
                raise RuntimeError(f"{fault.name}: its tests cannot be found\n{output[-800:]}")
            trial.word = "timeout" if code is None else "survived" if code == PASSED else "caught"
            # Tests that take as long without the mutant have not noticed it.
            if code is None and self.pytest(tests, limit_s, struck_off)[0] is None:
                trial.word = "not reached"
            # A test that fails without the mutant is removed, and the others run again.
            by = trial.by
            if code == 1 and by is not None and by not in struck_off and not self.is_sound(by):
                if by in tests:
                    tests.remove(by)
                else:
                    struck_off.append(by)
                trial.word, trial.by = "survived", None
                continue
            break
        trial.took_s = round(time.monotonic() - begun, 1)
        return trial
