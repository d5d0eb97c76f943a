"""Insert the faults of `faults.toml` one at a time and report which the fast tests detect.

    python benches/mutation/faults.py [--only WORDS] [--least N]

Each fault is a wrong sign, a swapped argument or a dropped term in physics, likelihood, estimation
or verdict. A fault in Python is tested by the test files that import its module, the nearest first;
a fault in Rust by the arguments of `cargo test` in its entry.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import tomlkit

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE)]

from imports import by_imports  # noqa: E402
from processor import run  # noqa: E402
from tree_copy import TreeCopy  # noqa: E402
from trial import Bench  # noqa: E402

ROOT = HERE.parents[1]
LONGEST_S = 900.0
"""Limit of the processor time of one Rust test, s; a test that exceeds it detects the fault."""


@dataclass(frozen=True)
class InsertedFault:
    """Deliberate fault: in `file`, the text `old` occurs once and is replaced by `new`."""

    what: str
    file: str
    old: str
    new: str
    test: tuple[str, ...] = ()
    operator: str = "by hand"

    @property
    def name(self) -> str:
        """Name of the fault in the output."""
        return self.what

    @property
    def line(self) -> int:
        """Number of the first line that the fault changes."""
        text = (ROOT / self.file).read_text("utf-8")
        return text[: text.index(self.old)].count("\n") + 1

    def applied(self, source: str) -> str:
        """Return the source with the fault; raise if `old` does not occur exactly once."""
        if source.count(self.old) != 1:
            raise SystemExit(f"faults.toml: the text of '{self.what}' is not once in {self.file}")
        return source.replace(self.old, self.new)


def read_faults(path: Path) -> list[InsertedFault]:
    """Read the faults of a TOML file."""
    entries = tomlkit.parse(path.read_text("utf-8")).unwrap()["fault"]
    return [InsertedFault(**{**e, "test": tuple(e.get("test", ()))}) for e in entries]


def noticed_by_cargo(copy: TreeCopy, fault: InsertedFault) -> bool:
    """Return True if a Rust test passes without the fault and fails with it."""
    path = copy.folder / fault.file
    before = path.read_text("utf-8")
    command = ["cargo", "test", "--quiet", *fault.test]
    if run(command, copy.folder, copy.environment, LONGEST_S)[0] != 0:
        raise SystemExit(f"'{fault.what}': its test fails or times out without the fault")
    path.write_text(fault.applied(before), "utf-8")
    try:
        built = [*command, "--no-run"]
        if run(built, copy.folder, copy.environment, LONGEST_S)[0] != 0:
            raise SystemExit(f"'{fault.what}': the fault does not compile")
        return run(command, copy.folder, copy.environment, LONGEST_S)[0] != 0
    finally:
        path.write_text(before, "utf-8")


def main() -> int:
    """Insert the selected faults; return 1 if fewer than `--least` were detected."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--only", default="", help="faults whose description contains this")
    parser.add_argument("--least", type=int, default=0, help="fail where fewer are noticed")
    parser.add_argument("--budget", type=float, default=90.0, help="seconds of tests, assumed")
    parser.add_argument("--table", type=Path, default=HERE / "faults.toml")
    chosen = parser.parse_args()
    faults = [f for f in read_faults(chosen.table) if chosen.only in f.what]
    reach = by_imports(ROOT)
    noticed = 0
    with tempfile.TemporaryDirectory(prefix="faults-") as folder:
        bench = Bench(TreeCopy(ROOT, Path(folder)))
        for fault in faults:
            if fault.test:
                caught, by = noticed_by_cargo(bench.copy, fault), " ".join(fault.test)
            else:
                tests = reach.chosen(fault.file, fault.line, chosen.budget)
                trial = bench.tried(fault, tests)
                caught, by = trial.caught, trial.by
            noticed += caught
            print(f"{'noticed' if caught else 'NOT NOTICED':<12} {fault.what}: {by}", flush=True)
    print(f"{noticed} of {len(faults)} noticed")
    return int(noticed < chosen.least)


if __name__ == "__main__":
    sys.exit(main())
