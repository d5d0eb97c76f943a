"""Rig and runs of a session, with the trim and exclusion of each run."""

from __future__ import annotations

import json
import math
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import PurePosixPath
from typing import Any

from jbf.errors import InputError, JbfError
from jbf.estimation.prepared import Prepared
from jbf.importing.ledger import NAME as LEDGER
from jbf.records.checks import MIN_SAMPLES
from jbf.records.rig import Rig, read_rig
from jbf.records.run import Run
from jbf.records.run_files import read_runs
from jbf.text_files import read_text
from jbf.workbench.equivalent_commands import Steps
from jbf.workbench.files import Folder

Span = tuple[float, float]


@dataclass
class Bench:
    """Rig and runs that are open in a session.

    Attributes
    ----------
    rig_name, run_names
        Names of the files in the folder.
    rig, runs
        The rig, and the complete runs.
    trims
        Used interval of each trimmed run, s.
    imported
        Recordings in the folder from which the runs were imported; empty otherwise.
    excluded
        Runs that are excluded from fits.
    findings
        Data-quality findings of each run examined so far.
    """

    rig_name: str
    run_names: tuple[str, ...]
    rig: Rig
    runs: tuple[Run, ...]
    trims: dict[str, Span] = field(default_factory=dict)
    imported: tuple[str, ...] = ()
    excluded: set[str] = field(default_factory=set)
    findings: dict[str, list[dict[str, Any]]] = field(default_factory=dict)

    @classmethod
    def read(
        cls,
        folder: Folder,
        rig_name: str,
        run_names: Sequence[str],
        progress: Callable[[str, int, int], None] | None = None,
    ) -> Bench:
        """Read a rig and runs from files of the folder.

        Raises
        ------
        InputError
            A name is not in the folder, or a file is wrong.
        """
        rig = read_rig(folder.path(rig_name))
        paths = [folder.path(name) for name in run_names]
        runs = read_runs(paths, rig, need_friction=False)
        if progress is not None:
            progress("read", len(runs), len(runs))
        imported = _imported(folder, PurePosixPath(rig_name).parent)
        return cls(rig_name, tuple(run_names), rig, tuple(runs), imported=imported)

    def run(self, name: str) -> Run:
        """Run with a given name, without its trim.

        Raises
        ------
        InputError
            There is no such run.
        """
        for run in self.runs:
            if run.name == name:
                return run
        raise InputError(file=name, problem="this run is not open", remedy="select an open run")

    def trim(self, name: str, span: Span | None) -> None:
        """Restrict a run to an interval, s; None restores the complete run.

        Raises
        ------
        InputError
            Too few samples would remain.
        """
        run = self.run(name)
        if span is None:
            self.trims.pop(name, None)
            return
        first, last = sorted(map(float, span))
        if not math.isfinite(first + last):
            raise InputError(
                file=name, problem="an end is not a number", remedy="give two instants, s"
            )
        remaining = int(((run.time_s >= first) & (run.time_s <= last)).sum())
        if remaining < MIN_SAMPLES:
            problem = f"only {remaining} samples would remain"
            raise InputError(file=name, problem=problem, remedy=f"keep at least {MIN_SAMPLES}")
        self.trims[name] = (first, last)

    def leave_out(self, name: str, out: bool) -> None:
        """Exclude a run from fits, or include it again."""
        self.run(name)
        (self.excluded.add if out else self.excluded.discard)(name)

    def used_runs(self) -> tuple[Run, ...]:
        """Trimmed runs that are not excluded from fits.

        Raises
        ------
        InputError
            All runs are excluded.
        """
        runs = tuple(self._trimmed(run) for run in self.runs if run.name not in self.excluded)
        if not runs:
            raise InputError(problem="all runs are excluded", remedy="include at least one")
        return runs

    def used(self) -> dict[str, list[float] | None]:
        """Trim of each run that is not excluded from fits; None for a complete run."""
        names = (run.name for run in self.runs if run.name not in self.excluded)
        return {name: list(self.trims[name]) if name in self.trims else None for name in names}

    def _trimmed(self, run: Run) -> Run:
        """Part of a run within its time limits in `trims`; the run itself without limits."""
        if run.name not in self.trims:
            return run
        first, last = self.trims[run.name]
        return run.select((run.time_s >= first) & (run.time_s <= last))

    def steps(self) -> Steps:
        """Steps of the session that produced these runs, for the equivalent commands."""
        rows = zip(self.runs, self.run_names, strict=True)
        folder = PurePosixPath(self.rig_name).parent
        return Steps(
            rig=self.rig_name,
            runs=[name for run, name in rows if run.name not in self.excluded],
            imported=self.imported,
            map=(folder / "map.toml").as_posix(),
            out=folder.as_posix(),
            trims=dict(self.trims),
        )

    def examine_runs(self, changed: Any) -> None:
        """Examine all runs for recording artefacts in a thread; call `changed` after each run."""

        def look() -> None:
            for run in self.runs:
                self.findings[run.name] = _findings(self.rig, run)
                changed()

        threading.Thread(target=look, daemon=True).start()

    def to_list(self) -> list[Mapping[str, Any]]:
        """Data of the runs for the page."""
        return [
            {
                "name": run.name,
                "file": file,
                "samples": len(run),
                "duration_s": run.duration_s,
                "from_s": float(run.time_s[0]),
                "to_s": float(run.time_s[-1]),
                "columns": sorted(run.columns()),
                "trim": self.trims.get(run.name),
                "excluded": run.name in self.excluded,
                "findings": self.findings.get(run.name),
            }
            for run, file in zip(self.runs, self.run_names, strict=True)
        ]


def _imported(folder: Folder, parent: PurePosixPath) -> tuple[str, ...]:
    """Recordings from which a campaign was imported, if these are next to its folder."""
    try:
        ledger = json.loads(read_text(folder.path((parent / LEDGER).as_posix())))
        names = [(parent.parent / str(file["file"])).as_posix() for file in ledger["files"]]
        exist = all(folder.path(name).is_file() for name in names)
    except (JbfError, ValueError, KeyError, TypeError):
        return ()
    return tuple(names) if exist else ()


def _findings(rig: Rig, run: Run) -> list[dict[str, Any]]:
    try:
        return [f.to_dict() for f in Prepared.of(rig, run).examined.findings]
    except JbfError as error:
        return [{"kind": "unusable", "words": str(error), "run": run.name, "done": "none"}]
