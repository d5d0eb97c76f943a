"""A rig and its runs, made ready once for many fits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from jbf.errors import InputError
from jbf.estimation.converter import curve_rms_n, noise_before
from jbf.estimation.noise_floor import most_noise
from jbf.estimation.prepared import NoMotion, Prepared, coasting
from jbf.estimation.samples import Samples
from jbf.estimation.work import Work
from jbf.models.catalogue import Effect
from jbf.models.driven import Driven
from jbf.models.own_effects import ALWAYS
from jbf.models.requirements import has_angle, has_path, has_position
from jbf.records.arguments import list_of_runs
from jbf.records.findings.finding import Finding
from jbf.records.findings.noisy_load import steady_load
from jbf.records.findings.repeated_run import copies, repeated
from jbf.records.findings.slow_temperature import recorded_temperature
from jbf.records.motion.roughness import noise_of
from jbf.records.motion.same_logger import further_starts
from jbf.records.recorded_load import recorded_load
from jbf.records.rig import Rig
from jbf.records.run import Run

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

LEFT_OF_BIAS = 0.3
"""Share of the bias of coarse steps that is left where it was taken off: the noise and the force by
which it is known are estimates."""
LOADS_DIFFER = 0.05
"""Loads that differ by less than this share are one load."""
TEMPERATURES_DIFFER_K = 2.0
"""Temperatures that differ by less, K, are one: it changes an oil by a tenth, dry friction by a
hundredth or two, and a thermometer sits where the friction is not."""
SMOOTHS_FORCE = frozenset((
    "sensor_hysteresis", "sensor_lag", "time_delay", "backlash", "drive_compliance",
))  # fmt: skip
"""Effects that filter a force or a motion. They are not tried where errors of the acceleration are
a large part of the residual: they would smooth these."""
NEEDS_RECORDED_FORCE = SMOOTHS_FORCE | {"inertia_leak", "sensor_nonlinearity", "sensor_drift"}
"""Effects that are not tried without a recorded force. Play and springs act between what is driven
and what is read; of a coast-down they would explain how its acceleration was smoothed."""
MOTION_SHARE = 0.1
"""Mean share of the motion's errors in the variance that is a large part."""
NEEDS_TIME = frozenset((
    "inertia_leak", "sensor_hysteresis", "sensor_lag", "time_delay", "sensor_drift", "backlash",
    "drive_compliance", "thermal_thinning", "film_memory", "wear_in", "warm_up", "dwell_stiction",
    "presliding",
))  # fmt: skip
"""Effects that are not tried on steady states."""
NOISE_SPAN = 3.29
"""Standard deviations between the quantiles of white noise at 5 % and at 95 %."""


@dataclass(frozen=True, eq=False)
class Campaign:
    """A rig and its runs, ready.

    Attributes
    ----------
    prepared
        The runs.
    samples
        The samples at which the runs tell the sign of the friction.
    most_noise_n
        The most that the noise on the friction can be, N, by what comes again in the records; None
        where nothing does.
    work
        What fits to it may cost yet; shared by every campaign that is made of this one.
    """

    rig: Rig
    prepared: tuple[Prepared, ...]
    samples: Samples
    most_noise_n: float | None = None
    more_findings: tuple[Finding, ...] = ()
    work: Work = field(default_factory=Work)

    @classmethod
    def prepare(cls, rig: Rig, runs: Sequence[Run]) -> Campaign:
        """Estimate each run's motion once; a run that was given twice is one run, and one in which
        nothing moves is left out where another moves.

        Raises
        ------
        InputError
            No run at all, a run without friction, none in which anything moves, or a force that is
            zero throughout.
        """
        runs = list_of_runs(runs)
        if not runs:
            raise InputError(problem="no run was given", mend="name at least one CSV file")
        again = copies(runs)
        ready, without_motion = _each(rig, {i: r for i, r in enumerate(runs) if i not in again})
        prepared = tuple(
            p.finding([repeated(p.run, runs[k]) for k in again if again[k] == i])
            for i, p in ready.items()
        )
        if not any(np.any(p.friction_n) for p in prepared):
            raise InputError(
                file=prepared[0].run.path or prepared[0].run.name,
                column="friction_n",
                problem="zero in every sample of every run",
                mend="check that the force was connected, and its scale",
            )
        samples = Samples.of(prepared)
        work = Work.of(sum(len(p.friction_n) for p in prepared))
        noise = most_noise(prepared, samples)
        return cls(rig, prepared, samples, noise, tuple(without_motion), work)

    @property
    def named(self) -> str:
        """What a message calls it: the file of its first run."""
        first = self.prepared[0].run
        return str(first.path or first.name)

    @property
    def motions(self) -> list[Driven]:
        """The core's copies of the motions."""
        return [p.core for p in self.prepared]

    @property
    def has_angle(self) -> bool:
        """True where every run has the shaft's angle."""
        return all(has_angle(self.rig, p.run) for p in self.prepared)

    @property
    def steady(self) -> bool:
        """Whether a run holds steady states in the place of a course in time."""
        return any(p.run.steady for p in self.prepared)

    @property
    def force_has_clock(self) -> bool:
        """Whether the force was read in time: not one of steady states, nor of a deceleration."""
        return not self.steady and coasting(self.rig) is None

    @property
    def motion_share(self) -> float:
        """Mean share of the motion's errors in the variance of the residuals."""
        motion = self.samples.motion
        return 0.0 if motion is None else motion.mean_share(self.samples.weight)

    @property
    def motion_uncertain(self) -> bool:
        """Whether the motion's errors are a large part of the variance."""
        return self.motion_share > MOTION_SHARE

    @property
    def has_loads(self) -> bool:
        """True where the loads differ, within a run or from run to run."""
        usual = self.rig.load.normal_n if self.rig.load is not None else None
        loads = [recorded_load(self.rig, p.run) for p in self.prepared]
        means = [usual if load is None else float(np.median(load)) for load in loads]
        known = [m for m in means if m is not None]
        spans = [_span(load) for load in loads if load is not None]
        span = max([*spans, max(known) - min(known)]) if known else 0.0
        return bool(known) and span > LOADS_DIFFER * max(known)

    @cached_property
    def temperature_range_c(self) -> tuple[float, float] | None:
        """The lowest and the highest of the recorded temperatures, C; None where not every run has
        one."""
        every = [recorded_temperature(p.run) for p in self.prepared]
        known = [celsius for celsius in every if celsius is not None]
        if not known or len(known) < len(every):
            return None
        return float(min(map(np.min, known))), float(max(map(np.max, known)))

    @property
    def temperatures_k(self) -> float | None:
        """How far they go, K, within runs and from run to run."""
        if self.temperature_range_c is None:
            return None
        low, high = self.temperature_range_c
        return high - low

    def lacking(self, effect: Effect) -> str | None:
        """What these runs do not hold of what an effect needs, in words; None where nothing."""
        needs = effect.needs
        if coasting(self.rig) is not None and effect.name in NEEDS_RECORDED_FORCE:
            return "no force was recorded"
        if effect.name in NEEDS_TIME and self.steady:
            return "steady states do not show it"
        if effect.name in SMOOTHS_FORCE and self.motion_uncertain:
            return "errors of the acceleration are a large part of the residual"
        for column in effect.columns:
            if column not in ALWAYS and any(column not in p.run.columns() for p in self.prepared):
                return f"not every run has the column {column}"
        if "angle" in needs and not self.has_angle:
            return f"not every run has {self.rig.quantities.mover}'s angle"
        if "path" in needs and not all(has_path(self.rig, p.run) for p in self.prepared):
            return "not every run has the path of the drive"
        if "position" in needs and not all(has_position(p.run) for p in self.prepared):
            return "not every run has a position or an angle"
        if "loads" in needs and not self.has_loads:
            return "all runs have one load, under which it changes nothing"
        if "temperatures" in needs:
            span_k = self.temperatures_k
            if span_k is None:
                return "not every run has the column temperature_c"
            if span_k < TEMPERATURES_DIFFER_K:
                return (
                    f"the temperature stays within {span_k:.2g} K: what it changes takes "
                    f"{TEMPERATURES_DIFFER_K:g} K to show"
                )
        return None

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What the recording did, run by run."""
        return (*(f for p in self.prepared for f in p.examined.findings), *self.more_findings)

    def with_findings(self, findings: Sequence[Finding]) -> Campaign:
        """The campaign with findings that took a model to see."""
        return replace(self, more_findings=(*self.more_findings, *findings))

    @property
    def step_n(self) -> float:
        """The largest step of a converter that is as large as the noise, N; zero without one."""
        return max((f.size for f in self.findings if f.kind == "steps"), default=0.0)

    def steps_rms_n(self, residual_rms_n: float) -> float:
        """What a converter's steps make of mean readings and no model takes off, RMS in N; zero
        without one.

        Noise smooths it; how large that is the readings say. A residual of this RMS holds what
        the model lacks, too, and is no less than the noise.
        """
        if self.step_n <= 0.0:
            return 0.0
        taken = self.samples.rms([p.readings_n - p.friction_n for p in self.prepared])
        if taken > 0.0:
            return LEFT_OF_BIAS * taken
        pairs = zip(self.prepared, self.samples.counted, strict=True)
        moves = [np.diff(p.readings_n)[at[1:] & at[:-1]] for p, at in pairs]
        noise_n = noise_before(self.step_n, np.concatenate(moves))
        return curve_rms_n(self.step_n, min(noise_n, residual_rms_n))

    def without(self, masks: Sequence[Mask]) -> Campaign:
        """The campaign with more samples set aside, one mask a run."""
        return replace(self, samples=self.samples.within([~m for m in masks]))

    def only(self, which: Sequence[int]) -> Campaign:
        """The campaign of some of the runs: the instruments, and so the noise, are the same."""
        return replace(
            self,
            prepared=tuple(self.prepared[i] for i in which),
            samples=self.samples.only(which),
        )


def _span(load: Array) -> float:
    """How far a load goes within a run, N, beyond what its own noise does."""
    low, high = np.quantile(steady_load(load), [0.05, 0.95])
    noise = NOISE_SPAN * noise_of(load)
    return float(np.sqrt(max(float(high - low) ** 2 - noise**2, 0.0)))


def _each(rig: Rig, runs: Mapping[int, Run]) -> tuple[dict[int, Prepared], list[Finding]]:
    """The runs that move, and a finding on each of the others.

    Each is looked at anew where the others tell of their logger: at what rate it read the force, or
    other errors of the motion's readings.
    """
    found: dict[int, Prepared] = {}
    refused: list[NoMotion] = []
    without_motion = []
    for i, run in runs.items():
        try:
            found[i] = Prepared.of(rig, run)
        except NoMotion as error:
            refused.append(error)
            without_motion.append(_without_motion(run, error))
    if not found:
        raise refused[0]
    rates = {i: rate for i, p in found.items() if (rate := p.drawn_at_hz) > 0.0}
    period_s = 1.0 / float(np.median(list(rates.values()))) if rates else None
    errors = [p.motion.errors for p in found.values()]
    starts = further_starts(
        [e.smoothed for e in errors if e is not None and e.smoothed is not None]
    )
    for i in found if starts or period_s is not None else ():
        with suppress(NoMotion):
            found[i] = Prepared.of(rig, runs[i], None if i in rates else period_s, starts)
    return found, without_motion


def _without_motion(run: Run, error: NoMotion) -> Finding:
    """A finding on a run that is left out."""
    words = f"{error.problem}: the run is left out"
    return Finding(
        "no_motion", "velocity_m_s", run.name, float(len(run)), "samples", "left out", words
    )
