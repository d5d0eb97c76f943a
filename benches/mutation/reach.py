"""Tests that run each line of the package, with their durations, measured by coverage contexts.

    python benches/mutation/reach.py [TESTS ...] --out FILE

Every test file runs alone. A test that uses a fixture built by another test also reaches the lines
of that fixture. Therefore all tests of a file are assigned to each of its lines, those that run the
line first.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import coverage
from processor import run

ROOT = Path(__file__).resolve().parents[2]
LONGEST_S = 900.0
"""Limit of the processor time of one test file, s."""
ANY = "0"
"""Key that represents all lines of a module."""
BACK = 12
"""Number of preceding lines that are searched for the beginning of a statement."""


@dataclass(frozen=True)
class Chosen:
    """Tests for one mutant, the quickest first, with their duration without the mutant, s."""

    tests: tuple[str, ...]
    seconds: float


@dataclass(frozen=True)
class Reach:
    """Duration of every test, s, and for each line of each module the tests that run it."""

    seconds: dict[str, float]
    lines: dict[str, dict[str, list[str]]]

    @classmethod
    def read(cls, path: Path) -> Reach:
        """Read a file written by `write`."""
        held = json.loads(path.read_text("utf-8"))
        tests, by_file = list(held["seconds"]), held["lines"]
        named = {
            m: {n: [tests[i] for i in of] for n, of in at.items()} for m, at in by_file.items()
        }
        return cls(held["seconds"], named)

    def write(self, path: Path) -> None:
        """Write the data as JSON, with each test represented by its index in a list."""
        place = {test: i for i, test in enumerate(self.seconds)}
        lines = {
            m: {n: [place[t] for t in of if t in place] for n, of in at.items()}
            for m, at in sorted(self.lines.items())
        }
        text = json.dumps({"seconds": self.seconds, "lines": lines}, separators=(",", ":"))
        path.write_text(text.replace('},"', '},\n"').replace('],"', '],\n"') + "\n", "utf-8")

    def by_file(self) -> Reach:
        """Combine tests to test files and lines to modules: smaller, and valid for longer."""
        seconds: dict[str, float] = defaultdict(float)
        for test, took in self.seconds.items():
            seconds[test.split("::")[0]] += took
        lines = {}
        for module, at in self.lines.items():
            reached = Counter(f for of in at.values() for f in {t.split("::")[0] for t in of})
            # Files that reach most lines per second come first.
            order = sorted(reached, key=lambda f: (seconds[f] + 0.2) / reached[f])
            lines[module] = {ANY: order}
        return Reach({k: round(v, 1) for k, v in sorted(seconds.items())}, lines)

    def chosen(self, module: str, line: int, budget_s: float) -> Chosen:
        """Select the tests of the files that run a line, the quickest first, within `budget_s`.

        The tests of those files that run the line come first, then all others, because they may use
        a fixture that has run it. A line that runs during the import of its module is assigned all
        tests that reach the module. A line without tests, such as a later line of a long statement,
        uses those of the preceding line.
        """
        at = self.lines.get(module, {})
        near = next((str(n) for n in range(line, line - BACK, -1) if str(n) in at), ANY)
        direct = at.get(near) or list({test: None for of in at.values() for test in of})
        cost: dict[str, float] = defaultdict(float)
        for test, took in self.seconds.items():
            cost[test.split("::")[0]] += took
        files: dict[str, None] = dict.fromkeys(test.split("::")[0] for test in direct)
        chosen: list[str] = []
        spent = 0.0
        for file in files if ANY in at else sorted(files, key=cost.__getitem__):
            if not chosen or spent + cost[file] <= budget_s:
                chosen.append(file)
                spent += cost[file]
        inside = [t for t in self.seconds if t.split("::")[0] in chosen]
        place = {file: i for i, file in enumerate(chosen)}
        inside.sort(key=lambda t: (t not in direct, place[t.split("::")[0]], self.seconds[t]))
        return Chosen(tuple(inside), spent)


def measured(files: list[str], folder: Path, limit_s: float = LONGEST_S) -> None:
    """Run each test file under coverage and store its results in `folder`.

    Existing results are reused.
    """
    for file in files:
        name = file.removesuffix(".py").replace("/", "-")
        data, report = folder / f"{name}.cov", folder / f"{name}.xml"
        if report.is_file():
            continue
        command = [sys.executable, "-m", "pytest", "-p", "no:xdist", "-p", "no:cacheprovider", file]
        command += ["--cov=jbf", "--cov-report=", "--cov-context=test", f"--junitxml={report}"]
        environment = os.environ | {"COVERAGE_FILE": str(data)}
        code, output, errors = run(command, ROOT, environment, limit_s)
        if code is None:
            print(
                f"{file}: skipped, because it takes more than {limit_s:.0f} s",
                file=sys.stderr,
                flush=True,
            )
            continue
        print(f"{file}: {output.splitlines()[-1] if output else errors[-200:]}", flush=True)


def _passed(report: Path) -> Iterator[tuple[str, float]]:
    """Generate name and duration (s) of each test that passed, from a JUnit report."""
    for case in ElementTree.parse(report).iter("testcase"):
        if not any(part.tag in ("failure", "error", "skipped") for part in case):
            yield case.get("name", ""), float(case.get("time", "0"))


def gathered(folder: Path) -> Reach:
    """Combine the coverage data and reports of all test files in `folder`."""
    seconds: dict[str, float] = {}
    lines: dict[str, dict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
    for report in sorted(folder.glob("*.xml")):
        data = coverage.CoverageData(str(report.with_suffix(".cov")))
        data.read()
        contexts = {c.rsplit("|", 1)[0] for c in data.measured_contexts() if c}
        took = dict(_passed(report))
        seconds |= {c: took[c.split("::", 1)[1]] for c in contexts if c.split("::", 1)[1] in took}
        for measured_file in data.measured_files():
            module = Path(measured_file).relative_to(ROOT).as_posix()
            for line, names in data.contexts_by_lineno(measured_file).items():
                reached = {c.rsplit("|", 1)[0] for c in names if c} & set(seconds)
                lines[module][str(line)] += sorted(reached)
    return Reach(seconds, lines)


def main() -> None:
    """Measure all test files and write the combined data."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("tests", nargs="*", help="files of tests (python/tests)")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--by-file", type=Path, help="also the short form, for a sample in CI")
    parser.add_argument("--data", type=Path, help="where to keep what was measured, to go on there")
    parser.add_argument(
        "--longest", type=float, default=LONGEST_S, help="processor time per file, s"
    )
    options = parser.parse_args()
    files = options.tests or sorted(
        p.relative_to(ROOT).as_posix() for p in (ROOT / "python" / "tests").glob("**/test_*.py")
    )
    with tempfile.TemporaryDirectory() as folder:
        kept = options.data or Path(folder)
        kept.mkdir(parents=True, exist_ok=True)
        measured(files, kept, options.longest)
        reach = gathered(kept)
    reach.write(options.out)
    if options.by_file:
        reach.by_file().write(options.by_file)


if __name__ == "__main__":
    main()
