"""A run prepared for many fits, with its estimated motion as an input of the compiled core."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from jbf.arrays import Array, Mask
from jbf.errors import InputError
from jbf.estimation.settings import DEFAULT, MotionSettings
from jbf.models.chain import sampled_motion
from jbf.models.driven import Driven
from jbf.models.driven_motion import driven_motion
from jbf.records.checks import MIN_SAMPLES, frozen
from jbf.records.findings.examine import Examined, examine, examine_readings
from jbf.records.findings.finding import Finding
from jbf.records.findings.force_sign import find_wrong_sign
from jbf.records.findings.noisy_load import find_noisy_load, steady_load
from jbf.records.findings.repeated_rows import as_read
from jbf.records.findings.separate_clock import separate_clock
from jbf.records.findings.slow_temperature import find_slow_temperature
from jbf.records.findings.smooth_force import find_smooth_force
from jbf.records.findings.steps import find_steps
from jbf.records.motion.estimated_motion import EstimatedMotion
from jbf.records.motion.readings import ReadingErrors
from jbf.records.rig import Rig
from jbf.records.run import Run
from jbf.records.run_requirements import require, run_on

FINER = 1.5
"""Ratio of the sampling rates of motion and force above which all motion samples are used."""


class NoMotion(InputError):
    """Error for a run without motion, or without a known direction of motion."""


def coasting(rig: Rig) -> float | None:
    """Mass, kg, or inertia, kg m^2, of a coast-down; None if the friction was recorded."""
    drive = rig.drive
    return drive.moved if drive is not None and drive.friction == "none" else None


@dataclass(frozen=True)
class Prepared:
    """One prepared run: its estimated motion, corrected force and recording artefacts.

    `Samples` defines which of its samples are included in a fit.

    Attributes
    ----------
    rig, run
        The rig, and the run as read.
    motion
        Motion estimated at the times of the force.
    friction
        Force with which a model is compared, N: the readings, corrected for the known quantisation
        bias of their converter.
    step_s
        Typical sampling interval, s.
    examined
        Recording artefacts of the run.
    """

    rig: Rig
    run: Run
    motion: EstimatedMotion
    friction: Array
    step_s: float
    examined: Examined
    recorded: tuple[Array, EstimatedMotion] | None = None
    """Times of the recorded motion, s, and the motion there, if the force has other times."""
    excluded: Mask | None = None
    """Samples excluded because they depend on an unrecorded state, shape (n,); None if none."""

    @property
    def converter_step_n(self) -> float:
        """Quantisation step of the force converter, N; zero if it is negligible."""
        return max((f.size for f in self.examined.findings if f.kind == "steps"), default=0.0)

    @property
    def has_noise(self) -> bool:
        """Whether the friction record contains the noise of a force sensor.

        False for a command, a filtered force, or a force derived from the motion.
        """
        read = coasting(self.rig) is None
        return read and all(f.kind != "smooth_force" for f in self.examined.findings)

    @property
    def drawn_at_hz(self) -> float:
        """Original sampling rate of the force, Hz, if samples are interpolated; otherwise zero."""
        drawn = (f for f in self.examined.findings if (f.kind, f.unit) == ("interpolated", "Hz"))
        return max((f.size for f in drawn), default=0.0)

    @property
    def motion_as_read(self) -> tuple[Array, EstimatedMotion]:
        """Times of the motion readings, s, and the motion at these times."""
        return self.recorded or (self.run.time_s, self.motion)

    @classmethod
    def of(
        cls,
        rig: Rig,
        run: Run,
        period_s: float | None = None,
        starts: Sequence[ReadingErrors] = (),
        settings: MotionSettings = DEFAULT.motion,
    ) -> Prepared:
        """Prepare a run: examine its record and estimate its motion.

        Parameters
        ----------
        period_s
            Sampling interval of the force in other runs of the same logger, if known, s.
        starts
            Errors of the motion readings of other runs of the same logger, as starting values.
        settings
            Settings of the motion.

        Raises
        ------
        InputError
            The run lacks a friction column.
        NoMotion
            The run contains no motion.
        """
        run = as_read(run_on(rig, run))
        moved = coasting(rig)
        if moved is None:
            require(run, "friction_n", "a comparison with the model")
        instants, motion = sampled_motion(rig, run, starts)
        if motion.clock_s is not None:
            run = replace(run, time_s=frozen(motion.clock_s))
        recorded = None
        clock_findings = separate_clock(run)
        if run.read:
            # The model is compared only at the readings of the force.
            recorded = (instants, motion)
            has_force = run.read.get("friction_n", np.ones(len(run), dtype=bool))
            moving = (run.time_s >= instants[0]) & (run.time_s <= instants[-1])
            run = replace(run.select(has_force & moving), read={})
            motion = motion.at(instants, run.time_s)
        read = moved is None and not run.steady
        if read:
            assert run.friction is not None
            examined = examine(run, motion.velocity, period_s)
        elif moved is None:
            examined = Examined((), np.ones(len(run), dtype=bool))
        else:
            recorded = recorded or (instants, motion)
            run = run.select(_independent(motion, settings.coast_down_spacing))
            motion = motion.at(recorded[0], run.time_s)
            run = replace(run, friction=frozen(-moved * motion.acceleration))
            examined = Examined((_derived(run, moved),), np.ones(len(run), dtype=bool))
        if examined.native is not None:
            native = examined.native
            instants, motion = recorded = recorded or (run.time_s, motion)
            motion = motion.at(instants, native.time_s)
            run = run.at(native.time_s, native.values)
            of_readings = examine_readings(run, motion.velocity)
            steps = find_steps(run, of_readings.usable, drawn=True)
            findings = (*examined.findings, *of_readings.findings, *steps)
            examined = Examined(findings, of_readings.usable)
        if not np.all(motion.resting) and not np.any(motion.sign_known):
            raise NoMotion(
                file=run.path or run.name,
                column="velocity_m_s",
                problem="the direction of motion is undetermined at every sample",
                remedy="leave this run out, or record a smoother speed",
            )
        if np.all(motion.resting):
            raise NoMotion(
                file=run.path or run.name,
                problem=f"{run.quantities.mover} never moves",
                remedy="leave this run out, or record one with motion",
            )
        more = (
            *run.reading,
            *clock_findings,
            *motion.findings,
            *(_of_readings(run, motion, examined) if read else ()),
            *find_noisy_load(run.name, run.load_n),
            *find_slow_temperature(run),
        )
        examined = replace(examined, findings=(*examined.findings, *more))
        step_s = float(np.median(np.diff(run.time_s)))
        if run.load_n is not None:
            # Filter before any resampling: interpolated noise is no longer white.
            run = replace(run, load_n=frozen(steady_load(run.load_n)))
        assert run.friction is not None
        return cls(rig, run, motion, run.friction, step_s, examined, recorded)

    @property
    def readings_n(self) -> Array:
        """Force readings of the run as recorded, N."""
        assert self.run.friction is not None
        return self.run.friction

    def finding(self, more: Sequence[Finding]) -> Prepared:
        """Return the run with additional findings."""
        findings = (*self.examined.findings, *more)
        return replace(self, examined=replace(self.examined, findings=findings))

    def shifted(self, delay_s: float, drift: float, margin_s: float = 0.0) -> Prepared:
        """Return the run with its force shifted to earlier times.

        `delay_s` is the delay of the force in the middle of the run, and `drift` its increase per
        second. Readings closer than `margin_s` to the start or the end of the motion are dropped.
        """
        instants, motion = self.motion_as_read
        time = self.run.time_s
        middle = 0.5 * (time[0] + time[-1])
        read = time - delay_s - drift * (time - middle)
        # Readings from before the start or after the end of the motion cannot be compared.
        kept = (read >= instants[0] + margin_s) & (read <= instants[-1] - margin_s)
        run = self.run.select(kept).at(read[kept], self.readings_n[kept])
        usable = self.examined.usable[kept]
        excluded = self.excluded
        if excluded is not None:
            # The state belongs to the motion, whose time is that of the shifted readings.
            excluded = np.interp(read[kept], time, excluded.astype(float)) > 0.0
        assert run.friction is not None
        return replace(
            self,
            run=run,
            motion=motion.at(instants, run.time_s),
            friction=run.friction,
            examined=replace(self.examined, usable=usable),
            recorded=(instants, motion),
            excluded=excluded,
        )

    def without(self, mask: Mask) -> Prepared:
        """Exclude the samples of a mask, shape (n,). They remain excluded after a shift."""
        return replace(self, excluded=mask if self.excluded is None else self.excluded | mask)

    @property
    def selectable(self) -> Mask:
        """Mask of the samples with a known direction of sliding and a usable reading."""
        return self.motion.slides & self.examined.usable

    @cached_property
    def core(self) -> Driven:
        """Motion of the run as an input of the compiled core.

        The input contains the motion before the first force reading, on which the state of the
        friction there depends. If the force was read less often than the motion, it also contains
        the motion between the readings, because the times of starts and reversals matter.
        """
        time = self.run.time_s
        if self.recorded is None:
            return driven_motion(self.rig, self.run, self.motion)
        instants, recorded = self.recorded
        is_finer = self.step_s >= FINER * float(np.median(np.diff(instants)))
        further = (instants < (time[-1] if is_finer else time[0])) & ~np.isin(instants, time)
        if not np.any(further):
            return driven_motion(self.rig, self.run, self.motion)
        both = np.concatenate([time, instants])
        used = np.concatenate([np.ones(len(time), dtype=bool), further])
        order = np.argsort(both, kind="stable")
        order = order[used[order]]
        joint = both[order]
        run = self.run.at(joint, np.interp(joint, time, self.friction))
        driven = driven_motion(self.rig, run, _joined(self.motion, recorded, order))
        kept = np.searchsorted(joint, time)
        return Driven(driven.motion, kept if driven.kept is None else driven.kept[kept])

    def __getstate__(self) -> dict[str, Any]:
        """Return the state for pickling, without the object of the compiled core.

        That object is created again at the first access after unpickling.
        """
        return {name: value for name, value in vars(self).items() if name != "core"}


def _joined(motion: EstimatedMotion, other: EstimatedMotion, order: Array) -> EstimatedMotion:
    """Return the samples of two motions in a common order, without their joint errors.

    `order` has indices into the samples of the first motion followed by those of the second one.
    """
    kinematic = ("velocity", "acceleration", "angle_rad", "velocity_error_m_s")
    samples: dict[str, Any] = {
        name: np.concatenate([getattr(motion, name), getattr(other, name)])[order]
        for name in (*kinematic, "resting", "sign_known")
    }
    return replace(motion, errors=None, **samples)


def _independent(motion: EstimatedMotion, spacing: float) -> Mask:
    """Mask of samples so far apart that their acceleration errors are independent, shape (n,).

    The covariance of the errors at two times is the product of the smoother gains between them and
    the covariance at the later time.
    """
    count, errors = len(motion.velocity), motion.errors
    if errors is None:
        return np.ones(count, dtype=bool)
    middle = count // 2
    lag, shared = 0, errors.covariance[middle]
    while lag < middle and shared[2, 2] > 0.0:
        lag += 1
        shared = errors.gain[middle - lag] @ shared
    spacing_count = int(np.clip(spacing * lag, 1, max(count // MIN_SAMPLES, 1)))
    return np.asarray(np.arange(count) % spacing_count == 0)


def _of_readings(run: Run, motion: EstimatedMotion, examined: Examined) -> list[Finding]:
    """Findings on the force readings of a run in relation to its motion."""
    wrong_sign = find_wrong_sign(run, motion, examined.usable)
    if any(f.kind == "steps" for f in examined.findings):
        return [*wrong_sign]  # quantisation steps count as noise
    return [*wrong_sign, *find_smooth_force(run, motion.slides & examined.usable)]


def _derived(run: Run, moved: float) -> Finding:
    """Finding that the friction was derived from the deceleration of a mass or inertia `moved`."""
    quantities = run.quantities
    mass = f"{moved:.5g} {quantities.unit('kg')}"
    words = f"the {quantities.noun} is computed as {mass} times the deceleration"
    return Finding("converted", "friction_n", run.name, moved, quantities.unit("kg"), "once", words)
