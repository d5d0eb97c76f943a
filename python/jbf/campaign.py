"""Runs made ready once for many fits: imposed motion, the core's copy of it, and which samples
may drive a fit or a verdict."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf import _core
from jbf.conditioning import ImposedMotion
from jbf.errors import InputError
from jbf.model import core_motion, has_angle, has_path, imposed
from jbf.record import Run, require
from jbf.rig import Rig

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

LOADS_DIFFER = 0.05
"""Loads that differ by less than this share are one load."""


@dataclass(frozen=True)
class Prepared:
    """One run, ready."""

    run: Run
    motion: ImposedMotion
    core: _core.Motion
    friction_n: Array
    trusted: Mask
    step_s: float


@dataclass(frozen=True)
class Campaign:
    """A rig and its runs, ready."""

    rig: Rig
    prepared: tuple[Prepared, ...]

    @classmethod
    def prepare(cls, rig: Rig, runs: Sequence[Run]) -> Campaign:
        """Estimate each run's motion once.

        Raises
        ------
        InputError
            No run at all, a run without friction, or one in which nothing moves.
        """
        runs = list(runs)
        if not runs:
            raise InputError(problem="no run was given", mend="name at least one CSV file")
        prepared = []
        for run in runs:
            require(run, "friction_n", "a comparison with the model")
            motion = imposed(rig, run)
            assert run.friction_n is not None
            if np.all(motion.resting) or not np.any(motion.trusted):
                raise InputError(
                    file=run.path or run.name,
                    problem="the shaft never moves",
                    mend="leave this run out, or record one with motion",
                )
            prepared.append(
                Prepared(
                    run=run,
                    motion=motion,
                    core=core_motion(rig, run, motion),
                    friction_n=run.friction_n,
                    trusted=motion.trusted,
                    step_s=float(np.median(np.diff(run.time_s))),
                )
            )
        return cls(rig, tuple(prepared))

    @property
    def motions(self) -> list[_core.Motion]:
        """The core's copies of the motions."""
        return [p.core for p in self.prepared]

    @property
    def samples(self) -> int:
        """Trusted samples in all runs."""
        return sum(int(p.trusted.sum()) for p in self.prepared)

    @property
    def has_angle(self) -> bool:
        """True where every run has the shaft's angle."""
        return all(has_angle(self.rig, p.run) for p in self.prepared)

    @property
    def has_loads(self) -> bool:
        """True where the loads differ, within a run or from run to run."""
        usual = self.rig.load.normal_n if self.rig.load is not None else None
        means = [
            usual if p.run.load_n is None else float(np.median(p.run.load_n)) for p in self.prepared
        ]
        known = [m for m in means if m is not None]
        spans = [
            np.ptp(np.quantile(p.run.load_n, [0.05, 0.95]))
            for p in self.prepared
            if p.run.load_n is not None
        ]
        span = max([*spans, max(known) - min(known)]) if known else 0.0
        return bool(known) and span > LOADS_DIFFER * max(known)

    def lacking(self, needs: Sequence[str]) -> str | None:
        """What these runs do not hold of what an effect needs, in words; None where nothing."""
        if "angle" in needs and not self.has_angle:
            return "not every run has the shaft's angle"
        if "path" in needs and not all(has_path(self.rig, p.run) for p in self.prepared):
            return "not every run has the path of the drive"
        if "loads" in needs and not self.has_loads:
            return "all runs have one load, under which it changes nothing"
        return None

    def shows(self, needs: Sequence[str]) -> bool:
        """True where every run holds what an effect needs of the record."""
        return self.lacking(needs) is None

    def only(self, indices: Sequence[int]) -> Campaign:
        """The campaign of some of the runs."""
        return Campaign(self.rig, tuple(self.prepared[i] for i in indices))
