"""Settings of the estimation: every number in it that influences a verdict, by concern.

A diagnosis passes them as the field `estimation` of its policy. They belong to the samples of a
campaign (`Samples.settings`), so that each statistic of these samples uses the same ones.
Tolerances and limits of iterations are not settings: they are constants next to their algorithms.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


def documented(default: Any, decides: str, source: str) -> Any:
    """Return a dataclass field with its default, what it decides, and the source of the value."""
    return field(default=default, metadata={"decides": decides, "source": source})


@dataclass(frozen=True)
class NoiseSettings:
    """Noise model of the force, and noise floor of the records."""

    longest_memory_s: float = documented(
        0.6,
        "longest correlation time, s, that is noise and not residual structure",
        "convention: filters of instruments are faster, strokes are slower",
    )
    min_gain: float = documented(
        20.0,
        "gain in twice the log likelihood from which the noise is coloured",
        "two parameters; the error of a wrong model must not be taken for noise",
    )
    max_gain_factor: float = documented(
        4.0,
        "multiple of the gain that a quadratic model predicts from which on no colour is searched",
        "bounds the error of the quadratic model; avoids an unnecessary search",
    )
    max_rms_ratio: float = documented(
        1.02,
        "ratio of the RMS of a fit with coloured noise, or with errors of the motion, to that of "
        "the plain fit up to which it is accepted",
        "close to one for noise; the error of a wrong model would be absorbed above it",
    )
    clip_sigma: float = documented(
        3.5,
        "standard deviations at which the contribution of a sample to a robust gain is clipped",
        "1 in 2000 of Gaussian noise",
    )
    min_floor_samples: int = documented(
        300,
        "number of samples at rest or repeated from which they give the total noise",
        "relative standard error of 4 %",
    )
    min_rest_samples: int = documented(60, "samples from which a rest gives noise", "convention")
    min_repeated_samples: int = documented(
        100,
        "number of repeated samples of a run from which their noise is used",
        "four blocks of 25",
    )
    min_floor_ratio: float = documented(
        1.04,
        "ratio of the total noise to the white noise from which the total noise is the floor",
        "coloured noise gives few independent samples: a clear excess is required",
    )
    max_floor_ratio: float = documented(
        3.0,
        "ratio of the total noise to the white noise above which it is no noise of the instrument",
        "convention: such a difference is friction",
    )


@dataclass(frozen=True)
class VarianceSettings:
    """Long-run (HAC) variance of scores."""

    window_s: float = documented(
        3.0, "length of the windows, s", "five times the longest correlation time of a noise model"
    )
    min_windows: int = documented(
        8, "number of windows of a run below which they are shortened", "convention"
    )
    min_runs: int = documented(
        3,
        "number of runs from which the scatter between runs is estimated",
        "two degrees of freedom",
    )
    chance: float = documented(
        0.01,
        "significance level at which the scatter of windows or runs exceeds that of white noise",
        "1 in 100",
    )


@dataclass(frozen=True)
class BlockSettings:
    """Blocks of the residual whose signs are reversed to calibrate the threshold."""

    min_length_s: float = documented(
        1.0, "length of a block, s, at least", "longer than the longest correlation time of noise"
    )
    min_memories: float = documented(
        4.0, "length of a block, in correlation times of the residual, at least", "independence"
    )


@dataclass(frozen=True)
class ConditionSettings:
    """Operating conditions that the runs must cover for an effect to be a candidate."""

    min_load_difference: float = documented(
        0.05, "relative difference from which loads differ", "convention"
    )
    min_temperature_difference_k: float = documented(
        2.0,
        "difference, K, from which temperatures differ",
        "changes an oil's viscosity by a tenth; a thermometer is not at the contact",
    )
    max_motion_share: float = documented(
        0.1,
        "mean share of the motion's errors in the variance above which no effect that filters a "
        "force or a motion is a candidate, and the smoothness of the motion is estimated",
        "such an effect would smooth these errors",
    )
    min_pitch_periods: float = documented(
        4.0,
        "periods within the travel from which a wave over it has a pitch",
        "a longer wave is a variation along the stroke, which has its own effect",
    )


@dataclass(frozen=True)
class FilmSettings:
    """Films that the records can resolve."""

    max_steps: float = documented(
        200.0,
        "steps of a film per sampling interval above which a law is not evaluated",
        "the film has forgotten its state at the previous sample two hundred times over",
    )
    any_steps: float = documented(
        1e5, "total number of steps that is evaluated in any case", "some milliseconds"
    )
    gap_steps: float = documented(
        4.5,
        "sampling intervals from which on a step is a gap, after which a film's state is unknown",
        "a longer step hides more of a motion than a straight line follows",
    )
    max_speed_ratio: float = documented(
        5.0,
        "ratio of a transition speed to the highest recorded speed above which it is not searched",
        "such a film is not visible, and its equations are stiff",
    )


@dataclass(frozen=True)
class TransientSettings:
    """Initial-state transients, which are excluded from a fit."""

    max_difference: float = documented(
        0.2,
        "fraction of the noise below which two initial states give the same friction",
        "increases the variance by 4 %",
    )
    max_share_film: float = documented(
        0.5,
        "share of a run above which nothing is excluded for a film",
        "convention: half of a run must remain",
    )
    max_share_contact: float = documented(
        0.75,
        "the same for a contact",
        "a run may be a single stroke, half of which deflects the contact",
    )
    max_share_backlash: float = documented(
        0.5,
        "share of a campaign above which nothing is excluded for a load cell with backlash",
        "a run whose force never reverses is excluded, unless most runs are such",
    )
    before_s: float = documented(
        6.0, "duration of the simulated motions before a run, s", "convention"
    )
    film_speeds: tuple[float, ...] = documented(
        (1e-3, 0.1, 1.0),
        "speeds of these motions for a film, as fractions of the run's top speed",
        "a film at rest, a thin one, and the thickest one",
    )
    contact_speeds: tuple[float, ...] = documented(
        (-1.0, 1.0),
        "speeds of these motions for contacts and backlash, as fractions of the top speed",
        "either side",
    )
    film_margin: float = documented(
        1.5, "factor on the excluded duration for a film", "the film may be slower than the model's"
    )
    contact_margin: float = documented(
        1.1, "factor on the excluded duration for a contact", "its deflection is known better"
    )
    min_new_share: float = documented(
        1e-3,
        "share of the samples that must be excluded in addition for a model to be fitted again",
        "one in a thousand; fewer hardly change a fit",
    )
    min_reported_ratio: float = documented(
        2.0, "ratio to the usual residual from which an excluded start is reported", "convention"
    )


@dataclass(frozen=True)
class JumpSettings:
    """Samples next to jumps of the predicted friction."""

    min_share: float = documented(
        0.1, "share of the largest friction above which a change may be a jump", "convention"
    )
    min_ratio: float = documented(
        3.0,
        "ratio of a jump to the changes next to it",
        "a resolved rise, as of an accelerated mass, is not a jump",
    )
    max_timing_error: float = documented(
        0.5,
        "fraction of the noise above which the error of a jump's time excludes a sample from tests",
        "increases the variance by a quarter",
    )


@dataclass(frozen=True)
class DelaySettings:
    """Time delays of the force by run, and drift of its clock."""

    linear_s: float = documented(
        8e-3,
        "time shift, s, over which the force is linear: samples closer to a reversal do not "
        "determine a delay, nor do runs with a larger standard error",
        "convention",
    )
    search_ranges_s: tuple[tuple[float, float], ...] = documented(
        ((0.04, 0.002), (0.008, 0.0005)),
        "range and step, s, of the delays that are searched at first, and after a shift",
        "convention: larger delays are not searched",
    )
    drift_parts: int = documented(
        3, "parts of a run from whose delays a growth is estimated", "a line has two parameters"
    )
    min_part_samples: int = documented(
        60, "number of samples of a part from which its delay is estimated", "convention"
    )
    max_edge_likelihood: float = documented(
        0.01,
        "likelihood at the ends of the searched range above which the delay is unknown",
        "1 in 100",
    )
    max_run_share: float = documented(
        0.1, "share of the shortest run above which a delay or lag is not plausible", "convention"
    )
    max_drift: float = documented(
        2e-3,
        "relative drift between two clocks above which it is not plausible",
        "twenty times that of two quartz crystals",
    )
    reserve_s: float = documented(
        20e-3,
        "delay, s, that is not corrected while the common delay is fitted; at least one sample",
        "no force may be early in that fit",
    )


@dataclass(frozen=True)
class QuantisationSettings:
    """Bias of readings by coarse quantisation."""

    remaining_bias: float = documented(
        0.3,
        "share of the corrected bias below which a mean residual is no structure",
        "the noise and the force that determine the bias are estimates",
    )


@dataclass(frozen=True)
class HeldOutSettings:
    """Held-out errors of prediction."""

    max_folds: int = documented(
        12, "number of folds above which groups of runs are held out together", "computing time"
    )
    parts: int = documented(10, "parts of a single run; every other one is held out", "convention")
    min_information: float = documented(
        1e-4,
        "share of the information on a parameter below which the remaining runs do not determine "
        "it",
        "a hundred times the standard error",
    )
    extrapolation_margin: float = documented(
        0.1,
        "share of the largest value of all runs within which a value is no extrapolation",
        "convention",
    )
    extrapolation_share: float = documented(
        0.05, "share of a run's samples that must be beyond all others", "no single samples"
    )
    min_units: int = documented(6, "number of units from which they are paired", "convention")
    min_unit_samples: int = documented(16, "samples from which a stroke is a unit", "convention")


@dataclass(frozen=True)
class MotionSettings:
    """Errors of the estimated motion in the likelihood."""

    coast_down_spacing: float = documented(
        2.0,
        "distance of the samples of a coast-down that count, in correlation lengths of the "
        "acceleration's errors",
        "independent errors",
    )
    min_share: float = documented(
        0.01,
        "mean share of the motion's errors in the variance below which they are neglected",
        "changes standard errors by half a per cent",
    )
    min_delay_share: float = documented(
        1e-3,
        "mean share below which a delay of the force is no error of the clocks",
        "the motion is exact: the model lacks an effect",
    )
    scale_prior: float = documented(
        1.0,
        "prior standard deviation of the logarithm of the scale of the motion's errors",
        "the standard errors of the smoother are right within a factor of three",
    )
    huber_sigma: float = documented(
        2.5,
        "standard errors by noise and motion beyond which a residual has less weight",
        "Huber (1964)",
    )
    min_delay_sigma: float = documented(
        5.0,
        "standard errors from which a delay of the force in all runs is corrected",
        "1 in 2 million of Gaussian noise",
    )
    max_delay_samples: float = documented(
        2.0, "sampling intervals up to which such a delay is plausible", "convention"
    )
    max_clock_deviance: float = documented(
        9.0,
        "difference of the deviance up to which the clock of the force is not identifiable",
        "three standard deviations",
    )
    min_smoothness_gain: float = documented(
        10.0,
        "decrease of the deviance for which the smoothness of the motion is changed",
        "three standard deviations",
    )
    roughness_factor: float = documented(
        30.0,
        "factor on the noise intensity whose change of the parameters is a systematic error",
        "convention: about one and a half decades",
    )


@dataclass(frozen=True)
class PeriodSettings:
    """Detection of motions that repeat, whose records are replicates."""

    min_samples: int = documented(
        100, "number of samples of a run that is tested for a period", "convention"
    )
    min_correlation: float = documented(
        0.9,
        "autocorrelation of the speed at a period, at least",
        "convention: the same motion again",
    )
    max_difference: float = documented(
        0.02,
        "standard deviation of the difference between periods, relative to that of the speed",
        "a repeated motion; a similar one is no replicate",
    )


@dataclass(frozen=True)
class Settings:
    """Numbers of the estimation that influence a verdict, by concern."""

    noise: NoiseSettings = NoiseSettings()
    variance: VarianceSettings = VarianceSettings()
    blocks: BlockSettings = BlockSettings()
    conditions: ConditionSettings = ConditionSettings()
    film: FilmSettings = FilmSettings()
    transient: TransientSettings = TransientSettings()
    jumps: JumpSettings = JumpSettings()
    delays: DelaySettings = DelaySettings()
    quantisation: QuantisationSettings = QuantisationSettings()
    held_out: HeldOutSettings = HeldOutSettings()
    motion: MotionSettings = MotionSettings()
    periods: PeriodSettings = PeriodSettings()


DEFAULT = Settings()
"""Settings where none are given."""
