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

    def shows(self, needs: Sequence[str]) -> bool:
        """True where every run holds what an effect needs of the record."""
        paths = all(has_path(self.rig, p.run) for p in self.prepared)
        return (self.has_angle or "angle" not in needs) and (paths or "path" not in needs)

    def only(self, indices: Sequence[int]) -> Campaign:
        """The campaign of some of the runs."""
        return Campaign(self.rig, tuple(self.prepared[i] for i in indices))
