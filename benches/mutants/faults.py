"""Deliberate faults: read from tables, put into a copy of the tree, one at a time, and tested."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import tomlkit

KEYS = ("what", "file", "old", "new", "test")
LONGEST_S = 1800.0
"""A test that takes longer with a fault in the code has noticed it."""


@dataclass(frozen=True)
class Mutant:
    """One fault: in `file`, `old` stands once; with `new` in its place `test` must fail."""

    table: str
    what: str
    file: str
    old: str
    new: str
    test: str

    @property
    def name(self) -> str:
        """Table and fault, as rows show it and `--only` finds it."""
        return f"{self.table}: {self.what}"


@dataclass(frozen=True)
class Outcome:
    """What became of a mutant: `noticed`, `LIVES`, `does not apply` or `test fails without it`."""

    mutant: Mutant
    word: str
    took_s: float

    @property
    def good(self) -> bool:
        """True where the tests did their work."""
        return self.word == "noticed"


def read_table(path: Path) -> list[Mutant]:
    """The mutants of one file; a ValueError where a table is not one.

    A `test` that is a list holds the arguments of `cargo test`, any other is a command.
    """
    found = []
    for i, table in enumerate(tomlkit.parse(path.read_text("utf-8")).unwrap()["mutant"], 1):
        if set(table) != set(KEYS):
            raise ValueError(f"{path.name}, mutant {i}: the keys are {', '.join(KEYS)}")
        test = table["test"]
        if isinstance(test, list):
            test = shlex.join(["cargo", "test", "--quiet", *test])
        found.append(Mutant(path.stem, **{**table, "test": test}))
    return found


class Copy:
    """The tree as it lies on the disk, what git ignores left out, in a folder of its own."""

    def __init__(self, root: Path, folder: Path) -> None:
        self.root, self.folder = root, folder
        listed = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
        names = subprocess.run(listed, cwd=root, capture_output=True, check=True).stdout
        built = [p.relative_to(root) for p in (root / "python" / "jbf").glob("_core*.so")]
        for name in [*(Path(os.fsdecode(n)) for n in names.split(b"\0") if n), *built]:
            if (root / name).is_file():
                (folder / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(root / name, folder / name)

    @cached_property
    def environment(self) -> dict[str, str]:
        """Python finds the copy first; cargo builds beside the tree's own target."""
        parts = ("python", "simulator", "benches", "python/tests")
        return os.environ | {
            "PATH": os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"])),
            "PYTHONPATH": os.pathsep.join(str(self.folder / part) for part in parts),
            # A file changed twice within a second has the compiled form of its first text.
            "PYTHONDONTWRITEBYTECODE": "1",
            "CARGO_TARGET_DIR": str(self.root / "target" / "mutants"),
        }

    def passes(self, test: str) -> bool:
        """True where a command succeeds in the copy."""
        try:
            done = subprocess.run(
                test,
                shell=True,
                cwd=self.folder,
                env=self.environment,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                timeout=LONGEST_S,
            )
        except subprocess.TimeoutExpired:
            return False
        return done.returncode == 0

    def has_place(self, mutant: Mutant) -> bool:
        """True where the place of a fault is there once."""
        path = self.folder / mutant.file
        text = path.read_text("utf-8") if path.is_file() else ""
        return text.count(mutant.old) == 1 and mutant.new != mutant.old

    def apply(self, mutant: Mutant) -> None:
        """Put a fault in."""
        path = self.folder / mutant.file
        path.write_text(path.read_text("utf-8").replace(mutant.old, mutant.new), "utf-8")

    def restore(self, mutant: Mutant) -> None:
        """Take the fault out; the file is newer than before, as builds want it."""
        shutil.copyfile(self.root / mutant.file, self.folder / mutant.file)


def try_one(copy: Copy, mutant: Mutant, passing: dict[str, bool]) -> Outcome:
    """Whether a mutant's test notices it. `passing` keeps which tests pass without any fault."""
    begun = time.monotonic()

    def outcome(word: str) -> Outcome:
        return Outcome(mutant, word, time.monotonic() - begun)

    if not copy.has_place(mutant):
        return outcome("does not apply")
    # A test that fails anyway notices nothing.
    if mutant.test not in passing:
        passing[mutant.test] = copy.passes(mutant.test)
    if not passing[mutant.test]:
        return outcome("test fails without it")
    copy.apply(mutant)
    try:
        return outcome("LIVES" if copy.passes(mutant.test) else "noticed")
    finally:
        copy.restore(mutant)
