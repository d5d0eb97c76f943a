"""A rig and its runs, prepared once for many fits.

The properties of a campaign, such as the ranges of load and temperature, determine which effects
the runs can show.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from jbf.arrays import Array, Mask
from jbf.errors import InputError
from jbf.estimation.noise_floor import noise_upper_bound
from jbf.estimation.prepared import NoMotion, Prepared, coasting
from jbf.estimation.quantisation import bias_rms, noise_before_converter
from jbf.estimation.samples import Samples
from jbf.estimation.settings import DEFAULT, MotionSettings, Settings
from jbf.estimation.work import TimeLimit, Work
from jbf.models.catalogue import Effect
from jbf.models.driven import Driven
from jbf.models.requirements import has_angle, has_path, has_position
from jbf.models.user_effects import COLUMNS_OF_EVERY_RUN
from jbf.records.arguments import list_of_runs
from jbf.records.findings.finding import Finding
from jbf.records.findings.noisy_load import steady_load
from jbf.records.findings.repeated_run import copies, repeated
from jbf.records.findings.slow_temperature import recorded_temperature
from jbf.records.motion.position import travel_of
from jbf.records.motion.roughness import noise_of
from jbf.records.motion.same_logger import further_starts
from jbf.records.recorded_load import recorded_load
from jbf.records.rig import Rig
from jbf.records.run import Run
from jbf.records.weight_angle import check_weight_angles

DISTORTS_FORCE = frozenset((
    "sensor_hysteresis", "sensor_lag", "sensor_nonlinearity", "time_delay", "backlash",
    "drive_compliance",
))  # fmt: skip
"""Effects that filter a force or a motion, or distort the force.

These effects can describe errors of the motion, and must explain more than these. The estimated
acceleration is too small at its peaks, where the force is largest, as for a curved characteristic
of the sensor.
"""
FILTERS_FORCE = DISTORTS_FORCE - {"sensor_nonlinearity"}
"""Effects that filter the force or the motion in time.

They can also describe errors of time stamps, and smooth the noise of a recorded load.
"""
NEEDS_RECORDED_FORCE = DISTORTS_FORCE | {"inertia", "sensor_drift"}
"""Effects that are not tried without a recorded force.

Backlash and compliance act between the driven part and the sensor. In a coast-down these two
effects would describe the smoothing of its acceleration.
"""
NEEDS_TIME = frozenset((
    "inertia", "sensor_hysteresis", "sensor_lag", "time_delay", "sensor_drift", "backlash",
    "drive_compliance", "thermal_thinning", "film_memory", "running_in", "warm_up",
    "dwell_stiction", "presliding",
))  # fmt: skip
"""Effects that are not tried on steady states."""
NOISE_SPAN = 3.29
"""Interval between the 5 % and 95 % quantiles of white noise, in standard deviations."""
HUM = 0.02
"""Fraction of the top speed below which a sample is not used for a scale of the motion."""


@dataclass(frozen=True, eq=False)
class Campaign:
    """A rig and its prepared runs.

    Attributes
    ----------
    rig
        The rig.
    prepared
        The prepared runs.
    samples
        The included samples, at which the runs determine the sign of the friction.
    most_noise_n
        Upper limit of the noise on the friction, N, from parts of the records that repeat; None if
        no part repeats.
    more_findings
        Findings from fitted models, in addition to those of the runs.
    work
        Remaining budget for fits, shared by all campaigns derived from this one.
    first
        The campaign as it was prepared, from which this one is derived; None for that one.
    """

    rig: Rig
    prepared: tuple[Prepared, ...]
    samples: Samples
    most_noise_n: float | None = None
    more_findings: tuple[Finding, ...] = ()
    work: Work = field(default_factory=Work)
    first: Campaign | None = None

    @classmethod
    def prepare(
        cls,
        rig: Rig,
        runs: Sequence[Run],
        settings: Settings = DEFAULT,
        time_limit: TimeLimit | None = None,
    ) -> Campaign:
        """Prepare each run, including the estimate of its motion.

        A duplicate of a run is dropped. A run without motion is excluded if another run has motion.

        Raises
        ------
        InputError
            No run, a run without friction, no run with motion, or a force that is zero throughout.
            The column `weight_angle_rad` in some runs only.
        Unfinished
            The time limit is reached.
        """
        runs = list_of_runs(runs)
        if not runs:
            raise InputError(problem="no run was given", remedy="name at least one CSV file")
        check_weight_angles(rig, runs)
        originals = copies(runs)
        ready, without_motion = _each(
            rig,
            {i: r for i, r in enumerate(runs) if i not in originals},
            settings.motion,
            time_limit,
        )
        prepared = tuple(
            p.finding([repeated(p.run, runs[k]) for k in originals if originals[k] == i])
            for i, p in ready.items()
        )
        if not any(np.any(p.friction) for p in prepared):
            raise InputError(
                file=prepared[0].run.path or prepared[0].run.name,
                column="friction_n",
                problem="is zero in every sample of every run",
                remedy="check the force sensor and its scale",
            )
        samples = Samples.of(prepared, settings)
        work = Work.of(sum(len(p.friction) for p in prepared), time_limit)
        noise = noise_upper_bound(prepared, samples)
        first = cls(rig, prepared, samples, noise, tuple(without_motion), work)
        return replace(first, first=first)

    @property
    def settings(self) -> Settings:
        """Settings of the estimation, those of the samples."""
        return self.samples.settings

    @property
    def named(self) -> str:
        """Name of the campaign in error messages: the file of its first run."""
        first = self.prepared[0].run
        return str(first.path or first.name)

    @property
    def motions(self) -> list[Driven]:
        """Motions of the runs as inputs of the compiled core."""
        return [p.core for p in self.prepared]

    @property
    def has_angle(self) -> bool:
        """Whether every run contains the shaft angle."""
        return all(has_angle(self.rig, p.run) for p in self.prepared)

    @property
    def steady(self) -> bool:
        """Whether the runs contain steady states instead of time series."""
        return any(p.run.steady for p in self.prepared)

    @cached_property
    def travel(self) -> float | None:
        """Largest distance between two positions of a run, m (rad for a rotary drive).

        From the recorded position, otherwise from the speed. None for steady states.
        """
        return (
            None if self.steady else max(travel_of(p.run, self.rig.radius_m) for p in self.prepared)
        )

    @property
    def force_has_clock(self) -> bool:
        """Whether the force is a time series of readings, not of steady states or decelerations."""
        return not self.steady and coasting(self.rig) is None

    @property
    def motion_share(self) -> float:
        """Mean share of the motion's errors in the variance of the residuals."""
        motion = self.samples.motion
        return 0.0 if motion is None else motion.mean_share(self.samples.weight)

    @property
    def has_loads(self) -> bool:
        """Whether the load varies, within a run or between runs."""
        stated = self.rig.load.normal_n if self.rig.load is not None else None
        loads = [recorded_load(self.rig, p.run) for p in self.prepared]
        means = [stated if load is None else float(np.median(load)) for load in loads]
        recorded = [m for m in means if m is not None]
        spans = [_span(load) for load in loads if load is not None]
        span = max([*spans, max(recorded) - min(recorded)]) if recorded else 0.0
        min_difference = self.settings.conditions.min_load_difference
        return bool(recorded) and span > min_difference * max(recorded)

    @cached_property
    def temperature_range_c(self) -> tuple[float, float] | None:
        """Lowest and highest recorded temperature, C; None if a run has no temperatures."""
        recorded = [recorded_temperature(p.run) for p in self.prepared]
        temperatures = [celsius for celsius in recorded if celsius is not None]
        if not temperatures or len(temperatures) < len(recorded):
            return None
        return float(min(map(np.min, temperatures))), float(max(map(np.max, temperatures)))

    def missing_requirement(self, effect: Effect) -> str | None:
        """Reason why the runs cannot show an effect; None if they meet all of its requirements."""
        needs, conditions = effect.needs, self.settings.conditions
        if coasting(self.rig) is not None and effect.name in NEEDS_RECORDED_FORCE:
            return "no force was recorded"
        if effect.name in NEEDS_TIME and self.steady:
            return "steady states do not contain it"
        for column in effect.columns:
            if column not in COLUMNS_OF_EVERY_RUN and any(
                column not in p.run.columns() for p in self.prepared
            ):
                return f"the column {column} is missing in some runs"
        if "angle" in needs and not self.has_angle:
            return f"{self.rig.quantities.mover}'s angle is missing in some runs"
        if "path" in needs and not all(has_path(self.rig, p.run) for p in self.prepared):
            return "the position of the drive is missing in some runs"
        if "position" in needs and not all(has_position(p.run) for p in self.prepared):
            return "a position or an angle is missing in some runs"
        if "loads" in needs and not self.has_loads:
            return "all runs have the same load"
        if "temperatures" in needs:
            if self.temperature_range_c is None:
                return "the column temperature_c is missing in some runs"
            low, high = self.temperature_range_c
            span_k, least_k = high - low, conditions.min_temperature_difference_k
            if span_k < least_k:
                return (
                    f"the temperature varies by {span_k:.2g} K only; the effect "
                    f"requires {least_k:g} K"
                )
        return None

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Recording artefacts of all runs, run by run."""
        return (*(f for p in self.prepared for f in p.examined.findings), *self.more_findings)

    def with_findings(self, findings: Sequence[Finding]) -> Campaign:
        """Return the campaign with additional findings from a fitted model."""
        return replace(self, more_findings=(*self.more_findings, *findings))

    @property
    def step_n(self) -> float:
        """Largest quantisation step of the force comparable with its noise, N; zero if none."""
        return max((f.size for f in self.findings if f.kind == "steps"), default=0.0)

    def steps_rms(self, residual_rms: float) -> float:
        """RMS of the uncorrected quantisation bias of the mean readings, N.

        The RMS is zero without a quantisation step. The noise, which smooths the quantisation
        error, is estimated from the readings. The residual RMS also contains lack of fit, and is
        therefore an upper limit of the noise.
        """
        if self.step_n <= 0.0:
            return 0.0
        taken = self.samples.rms([p.readings_n - p.friction for p in self.prepared])
        if taken > 0.0:
            return self.settings.quantisation.remaining_bias * taken
        pairs = zip(self.prepared, self.samples.counted, strict=True)
        moves = [np.diff(p.readings_n)[at[1:] & at[:-1]] for p, at in pairs]
        noise_rms = noise_before_converter(self.step_n, np.concatenate(moves))
        return bias_rms(self.step_n, min(noise_rms, residual_rms))

    @property
    def arm_m(self) -> float:
        """Radius that converts an angle to a path, m; 1 for a drive."""
        return 1.0 if self.rig.bearing is None else self.rig.bearing.radius_m

    @cached_property
    def moving(self) -> list[tuple[Prepared, Mask]]:
        """The runs, each with the mask of the included samples in motion.

        Speeds near zero, which may be noise, are excluded.
        """
        pairs = []
        for p, counted in zip(self.prepared, self.samples.counted, strict=True):
            speed = np.abs(p.motion.velocity)
            top = float(np.quantile(speed, 0.99)) or float(np.max(speed))
            pairs.append((p, np.asarray(counted & (speed > HUM * top))))
        return pairs

    def without(self, masks: Sequence[Mask]) -> Campaign:
        """Return the campaign without the samples that are True in the masks, one mask per run."""
        prepared = tuple(p.without(m) for p, m in zip(self.prepared, masks, strict=True))
        samples = self.samples.within([~m for m in masks])
        return replace(self, prepared=prepared, samples=samples)

    def only(self, selection: Sequence[int]) -> Campaign:
        """Return the campaign restricted to the runs with these indices."""
        return replace(
            self,
            prepared=tuple(self.prepared[i] for i in selection),
            samples=self.samples.only(selection),
        )


def _span(load: Array) -> float:
    """Range of a load within a run, N, with the contribution of its noise removed."""
    low, high = np.quantile(steady_load(load), [0.05, 0.95])
    noise = NOISE_SPAN * noise_of(load)
    return float(np.sqrt(max(float(high - low) ** 2 - noise**2, 0.0)))


def _each(
    rig: Rig, runs: Mapping[int, Run], settings: MotionSettings, time_limit: TimeLimit | None
) -> tuple[dict[int, Prepared], list[Finding]]:
    """Prepare all runs; return those with motion by index, and a finding for each of the others.

    Runs are prepared again if the other runs provide the sampling rate of the force, or further
    starting values for the errors of the motion readings.
    """
    prepared: dict[int, Prepared] = {}
    refused: list[NoMotion] = []
    without_motion = []
    for i, run in runs.items():
        if time_limit is not None:
            time_limit.check()
        try:
            prepared[i] = Prepared.of(rig, run, settings=settings)
        except NoMotion as error:
            refused.append(error)
            words = f"{error.problem}: the run is left out"
            count = float(len(run))
            without_motion.append(
                Finding("no_motion", "velocity_m_s", run.name, count, "samples", "left out", words)
            )
    if not prepared:
        raise refused[0]
    rates = {i: rate for i, p in prepared.items() if (rate := p.drawn_at_hz) > 0.0}
    period_s = 1.0 / float(np.median(list(rates.values()))) if rates else None
    errors = [p.motion.errors for p in prepared.values()]
    starts = further_starts(
        [e.smoothed for e in errors if e is not None and e.smoothed is not None]
    )
    for i in prepared if starts or period_s is not None else ():
        if time_limit is not None:
            time_limit.check()
        with suppress(NoMotion):
            prepared[i] = Prepared.of(
                rig, runs[i], None if i in rates else period_s, starts, settings
            )
    return prepared, without_motion
