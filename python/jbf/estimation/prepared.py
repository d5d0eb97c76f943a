"""One run made ready for many fits: the motion it imposed, and the core's copy of that."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf.errors import InputError
from jbf.models.chain import imposed_as_read
from jbf.models.driven import Driven
from jbf.models.driven_motion import driven_motion
from jbf.records.checks import MIN_SAMPLES, frozen
from jbf.records.findings.examine import Examined, examine, examine_readings
from jbf.records.findings.finding import Finding
from jbf.records.findings.noisy_load import find_noisy_load, steady_load
from jbf.records.findings.own_clock import own_clock
from jbf.records.findings.pushing import find_pushing
from jbf.records.findings.repeated_rows import as_read
from jbf.records.findings.slow_temperature import find_slow_temperature
from jbf.records.findings.smooth_force import find_smooth_force
from jbf.records.findings.steps import find_steps
from jbf.records.motion.imposed import ImposedMotion
from jbf.records.motion.readings import ReadingErrors
from jbf.records.rig import Rig
from jbf.records.run import Run, require, run_on

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


APART = 2
"""Spacing of the samples of a coast-down, in lags at which the correlation of the acceleration's
errors vanishes."""
FINER = 1.5
"""A motion read so many times as often as the force tells more than at the force's instants."""


def slides(motion: ImposedMotion) -> Mask:
    """Return where friction has a known direction, shape (n,).

    At rest friction is any force up to the breakaway level in either direction: it balances
    whatever the drive holds. Such a sample has no residual, and neither has one near a reversal.
    """
    sliding: Mask = motion.sign_known & ~motion.resting
    return sliding


class NoMotion(InputError):
    """A run in which nothing moves, or not in a known direction."""


def coasting(rig: Rig) -> float | None:
    """Known mass, kg, or inertia, kg m^2, of a coast-down; None where a friction was recorded."""
    drive = rig.drive
    return drive.moved if drive is not None and drive.friction == "none" else None


@dataclass(frozen=True)
class Prepared:
    """One run, ready: its motion, its usual step, and what its recording did. Which of its samples
    count, `Samples` says. With `friction_n` a model is compared: the run's readings, without what
    its converter's steps are known to add."""

    rig: Rig
    run: Run
    motion: ImposedMotion
    friction_n: Array
    step_s: float
    examined: Examined
    recorded: tuple[Array, ImposedMotion] | None = None
    """The instants at which the motion was recorded, s, and the motion there, where the force was
    read at others."""

    @property
    def converter_step_n(self) -> float:
        """The step of the run's converter, N; zero where it is none to speak of."""
        return max((f.size for f in self.examined.findings if f.kind == "steps"), default=0.0)

    @property
    def has_noise(self) -> bool:
        """Whether the record holds the noise of the force: not that of a command, a filtered force,
        or one that follows from the motion."""
        read = coasting(self.rig) is None
        return read and all(f.kind != "smooth_force" for f in self.examined.findings)

    @property
    def drawn_at_hz(self) -> float:
        """The rate at which the force was read, Hz, where lines were drawn between; else zero."""
        drawn = (f for f in self.examined.findings if (f.kind, f.unit) == ("interpolated", "Hz"))
        return max((f.size for f in drawn), default=0.0)

    @property
    def motion_as_read(self) -> tuple[Array, ImposedMotion]:
        """The instants at which the motion was read, s, and the motion there."""
        return self.recorded or (self.run.time_s, self.motion)

    @classmethod
    def of(
        cls,
        rig: Rig,
        run: Run,
        period_s: float | None = None,
        starts: Sequence[ReadingErrors] = (),
    ) -> Prepared:
        """Estimate the motion of a run.

        Parameters
        ----------
        period_s
            At which other runs of the same logger read the force, where that is known.
        starts
            Errors of the readings of other runs of the same logger.

        Raises
        ------
        InputError
            The run has no friction.
        NoMotion
            Nothing moves in it.
        """
        run = as_read(run_on(rig, run))
        moved = coasting(rig)
        if moved is None:
            require(run, "friction_n", "a comparison with the model")
        instants, motion = imposed_as_read(rig, run, starts)
        if motion.clock_s is not None:
            run = replace(run, time_s=frozen(motion.clock_s))
        recorded = None
        own = own_clock(run)
        if run.read:
            # The model is compared at the readings of the force, and at no others.
            recorded = (instants, motion)
            there = run.read.get("friction_n", np.ones(len(run), dtype=bool))
            moving = (run.time_s >= instants[0]) & (run.time_s <= instants[-1])
            run = replace(run.select(there & moving), read={})
            motion = motion.at(instants, run.time_s)
        read = moved is None and not run.steady
        if read:
            assert run.friction_n is not None
            examined = examine(run, motion.velocity_m_s, period_s)
        elif moved is None:
            examined = Examined((), np.ones(len(run), dtype=bool))
        else:
            recorded = recorded or (instants, motion)
            run = run.select(_independent(motion))
            motion = motion.at(recorded[0], run.time_s)
            run = replace(run, friction_n=frozen(-moved * motion.acceleration_m_s2))
            examined = Examined((_derived(run, moved),), np.ones(len(run), dtype=bool))
        if examined.native is not None:
            native = examined.native
            instants, motion = recorded = recorded or (run.time_s, motion)
            motion = motion.at(instants, native.time_s)
            run = run.at(native.time_s, native.values)
            of_readings = examine_readings(run, motion.velocity_m_s)
            steps = find_steps(run, of_readings.usable, drawn=True)
            found = (*examined.findings, *of_readings.findings, *steps)
            examined = Examined(found, of_readings.usable)
        if not np.all(motion.resting) and not np.any(motion.sign_known):
            raise NoMotion(
                file=run.path or run.name,
                column="velocity_m_s",
                problem="of no sample is it known which way the motion goes",
                mend="leave this run out, or record a smoother speed",
            )
        if np.all(motion.resting):
            raise NoMotion(
                file=run.path or run.name,
                problem=f"{run.quantities.mover} never moves",
                mend="leave this run out, or record one with motion",
            )
        more = (
            *run.reading,
            *own,
            *motion.findings,
            *(_of_readings(run, motion, examined) if read else ()),
            *find_noisy_load(run.name, run.load_n),
            *find_slow_temperature(run),
        )
        examined = replace(examined, findings=(*examined.findings, *more))
        step_s = float(np.median(np.diff(run.time_s)))
        if run.load_n is not None:
            # Before anything resamples it: lines drawn through noise are not white any more.
            run = replace(run, load_n=frozen(steady_load(run.load_n)))
        assert run.friction_n is not None
        return cls(rig, run, motion, run.friction_n, step_s, examined, recorded)

    @property
    def slides(self) -> Mask:
        """True where friction has a known direction (:func:`slides`), shape (n,)."""
        return slides(self.motion)

    @property
    def readings_n(self) -> Array:
        """The run's readings, N."""
        assert self.run.friction_n is not None
        return self.run.friction_n

    def finding(self, more: Sequence[Finding]) -> Prepared:
        """The run with more findings."""
        whole = (*self.examined.findings, *more)
        return replace(self, examined=replace(self.examined, findings=whole))

    def shifted(self, late_s: float, drift: float) -> Prepared:
        """The run with its force compared with the motion so long before.

        Parameters
        ----------
        late_s
            How late the force is in the middle of the run, s.
        drift
            By how much later it gets in a second.
        """
        instants, motion = self.motion_as_read
        time = self.run.time_s
        middle = 0.5 * (time[0] + time[-1])
        read = time - late_s - drift * (time - middle)
        # What was read before the motion begins, or after it ends, cannot be compared.
        kept = (read >= instants[0]) & (read <= instants[-1])
        run = self.run.select(kept).at(read[kept], self.readings_n[kept])
        usable = self.examined.usable[kept]
        assert run.friction_n is not None
        return replace(
            self,
            run=run,
            motion=motion.at(instants, run.time_s),
            friction_n=run.friction_n,
            examined=replace(self.examined, usable=usable),
            recorded=(instants, motion),
        )

    @cached_property
    def core(self) -> Driven:
        """The core's copy of the motion.

        Where the force was read more seldom than the motion, the motion between is the core's, too:
        where it sets in, and turns round, matters.
        """
        time = self.run.time_s
        if self.recorded is None:
            return driven_motion(self.rig, self.run, self.motion)
        instants, motion = self.recorded
        if self.step_s < FINER * float(np.median(np.diff(instants))):
            return driven_motion(self.rig, self.run, self.motion)
        inside = (instants > time[0]) & (instants < time[-1])
        whole = np.union1d(instants[inside], time)
        run = self.run.at(whole, np.interp(whole, time, self.friction_n))
        driven = driven_motion(self.rig, run, motion.at(instants, whole))
        kept = np.searchsorted(whole, time)
        return Driven(driven.motion, kept if driven.kept is None else driven.kept[kept])

    def __getstate__(self) -> dict[str, Any]:
        """What goes to another process: the core's copy is made again there."""
        return {name: value for name, value in vars(self).items() if name != "core"}


def _independent(motion: ImposedMotion) -> Mask:
    """Samples so far apart that the errors of their accelerations are independent, shape (n,).

    The covariance of the errors at two instants is the product of the smoother's gains between them
    and the covariance at the later one.
    """
    count, errors = len(motion.velocity_m_s), motion.errors
    if errors is None:
        return np.ones(count, dtype=bool)
    middle = count // 2
    lag, shared = 0, errors.covariance[middle]
    while lag < middle and shared[2, 2] > 0.0:
        lag += 1
        shared = errors.gain[middle - lag] @ shared
    every = int(np.clip(APART * lag, 1, max(count // MIN_SAMPLES, 1)))
    kept: Mask = np.arange(count) % every == 0
    return kept


def _of_readings(run: Run, motion: ImposedMotion, examined: Examined) -> list[Finding]:
    """Findings on readings of a force, next to the motion."""
    without_noise = _without_noise(run, slides(motion) & examined.usable, examined)
    return [*find_pushing(run, motion, examined.usable), *without_noise]


def _derived(run: Run, moved: float) -> Finding:
    """A finding that the friction follows from the deceleration."""
    said = run.quantities
    words = f"the {said.noun} is {moved:.5g} {said.unit('kg')} times the deceleration"
    return Finding("converted", "friction_n", run.name, moved, said.unit("kg"), "once", words)


def _without_noise(run: Run, sliding: Mask, examined: Examined) -> list[Finding]:
    """A finding where the force shows no noise: the steps of a converter are noise."""
    if any(f.kind == "steps" for f in examined.findings):
        return []
    return find_smooth_force(run, sliding)
