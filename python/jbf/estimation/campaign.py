"""Runs made ready once for many fits: imposed motion, the core's copy of it, and which samples
may drive a fit or a verdict."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf import _core
from jbf.errors import InputError
from jbf.models.catalogue import Effect
from jbf.models.chain import core_motion, imposed
from jbf.models.own_effects import ALWAYS
from jbf.models.requirements import has_angle, has_path
from jbf.records.motion.imposed import ImposedMotion
from jbf.records.rig import Rig
from jbf.records.run import Run, require

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

LOADS_DIFFER = 0.05
"""Loads that differ by less than this share are one load."""


@dataclass(frozen=True)
class Prepared:
    """One run, ready.

    A verdict looks at the `trusted` samples. A fit gives each sample its `weight`, 0 to 1: that of
    a trusted one is 1, and one next to a jump that is itself fitted has little.
    """

    rig: Rig
    run: Run
    motion: ImposedMotion
    friction_n: Array
    trusted: Mask
    step_s: float
    weight: Array

    @cached_property
    def core(self) -> _core.Motion:
        """The core's copy of the motion."""
        return core_motion(self.rig, self.run, self.motion)

    def __getstate__(self) -> dict[str, Any]:
        """What goes to another process: the core's copy is made again there."""
        return {name: value for name, value in vars(self).items() if name != "core"}


@dataclass(frozen=True)
class Campaign:
    """A rig and its runs, ready.

    `most_noise_n` is the most that the noise on the friction can be, N, by what comes again in
    the records; None where nothing does.
    """

    rig: Rig
    prepared: tuple[Prepared, ...]
    most_noise_n: float | None = None

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
                    rig=rig,
                    run=run,
                    motion=motion,
                    friction_n=run.friction_n,
                    trusted=motion.trusted,
                    step_s=float(np.median(np.diff(run.time_s))),
                    weight=motion.trusted.astype(float),
                )
            )
        from jbf.estimation.noise import most_noise

        campaign = cls(rig, tuple(prepared))
        return replace(campaign, most_noise_n=most_noise(campaign))

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

    def lacking(self, effect: Effect) -> str | None:
        """What these runs do not hold of what an effect needs, in words; None where nothing."""
        needs = effect.needs
        for column in effect.columns:
            if column not in ALWAYS and any(column not in p.run.columns() for p in self.prepared):
                return f"not every run has the column {column}"
        if "angle" in needs and not self.has_angle:
            return "not every run has the shaft's angle"
        if "path" in needs and not all(has_path(self.rig, p.run) for p in self.prepared):
            return "not every run has the path of the drive"
        if "loads" in needs and not self.has_loads:
            return "all runs have one load, under which it changes nothing"
        return None

    def shows(self, effect: Effect) -> bool:
        """True where every run holds what an effect needs of the record."""
        return self.lacking(effect) is None

    def only(self, indices: Sequence[int]) -> Campaign:
        """The campaign of some of the runs."""
        return self.of([self.prepared[i] for i in indices])

    def of(self, prepared: Iterable[Prepared]) -> Campaign:
        """The campaign with other samples, or fewer runs, of the same rig and instruments."""
        return replace(self, prepared=tuple(prepared))
