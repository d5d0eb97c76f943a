"""Settings of the estimation: every number in it that influences a verdict, by topic.

A diagnosis passes them as the field `estimation` of its policy. They belong to the samples of a
campaign (`Samples.settings`), so that each statistic of these samples uses the same ones.
Tolerances and limits of iterations are not settings: they are constants next to their algorithms.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


def documented(default: Any, decides: str, source: str) -> Any:
    """Dataclass field with a default, what it decides, and the source of the value."""
    return field(default=default, metadata={"decides": decides, "source": source})


@dataclass(frozen=True)
class NoiseSettings:
    """Settings for the noise model of the force and the noise floor of the records."""

    longest_memory_s: float = documented(
        0.6,
        "longest correlation time, s, that counts as noise and not as residual structure",
        "convention: filters of instruments are faster, strokes are slower",
    )
    min_gain: float = documented(
        20.0,
        "minimum gain in twice the log likelihood for a model of coloured noise",
        "two parameters; lack of fit must not be absorbed as noise",
    )
    max_gain_factor: float = documented(
        4.0,
        "multiple of the gain that a quadratic model predicts from which on no colour is searched",
        "bounds the error of the quadratic model; avoids an unnecessary search",
    )
    max_rms_ratio: float = documented(
        1.02,
        "maximum ratio of the RMS of a fit with coloured noise, or with errors of the motion, to "
        "that of the ordinary fit with the same motion",
        "close to one for noise; above it, lack of fit would be absorbed",
    )
    clip_sigma: float = documented(
        3.5,
        "standard deviations at which the contribution of a sample to a robust gain is clipped",
        "1 in 2000 for Gaussian noise",
    )
    min_floor_samples: int = documented(
        300,
        "minimum number of samples, at rest or repeated, for an estimate of the total noise",
        "relative standard error of 4 %",
    )
    min_rest_samples: int = documented(60, "minimum number of samples of a rest", "convention")
    min_repeated_samples: int = documented(
        100, "minimum number of repeated samples of a run for a noise estimate", "four blocks of 25"
    )
    min_floor_ratio: float = documented(
        1.04,
        "minimum ratio of total to white noise for the total noise to be the noise floor",
        "coloured noise gives few independent samples: a clear excess is required",
    )
    max_floor_ratio: float = documented(
        3.0,
        "ratio of total to white noise above which the total noise is not instrument noise",
        "convention: such a difference is friction",
    )


@dataclass(frozen=True)
class VarianceSettings:
    """Settings for the long-run (HAC) variance of scores."""

    window_s: float = documented(
        3.0, "length of the windows, s", "five times the longest correlation time of a noise model"
    )
    min_windows: int = documented(
        8, "minimum number of windows of a run; for fewer, the windows are shortened", "convention"
    )
    min_runs: int = documented(
        3, "minimum number of runs for an estimate of their scatter", "two degrees of freedom"
    )
    chance: float = documented(
        0.01, "significance level for scatter of windows or runs beyond white noise", "1 in 100"
    )


@dataclass(frozen=True)
class BlockSettings:
    """Settings for the blocks of the residual whose signs are reversed in the wild bootstrap."""

    min_length_s: float = documented(
        1.0, "minimum length of a block, s", "longer than the longest correlation time of noise"
    )
    min_memories: float = documented(
        4.0, "minimum length of a block, in correlation times of the residual", "independence"
    )


@dataclass(frozen=True)
class ConditionSettings:
    """Ranges of operating conditions that the runs must cover for an effect to be a candidate."""

    min_load_difference: float = documented(
        0.05, "minimum relative difference for two loads to count as different", "convention"
    )
    min_temperature_difference_k: float = documented(
        2.0,
        "minimum difference, K, for two temperatures to count as different",
        "changes an oil's viscosity by a tenth; a thermometer is not at the contact",
    )
    min_pitch_periods: float = documented(
        2.0, "minimum number of periods of a wave within the travel", "a longer one is a variation"
    )
    max_time_ratio: float = documented(
        3.0, "longest time constant, in durations of the longest run", "4 % from a linear trend"
    )


@dataclass(frozen=True)
class FilmSettings:
    """Limits for films that the records can resolve."""

    max_steps: float = documented(
        200.0,
        "steps of a film per sampling interval above which a law is not evaluated",
        "the film is then independent of its state at the previous sample",
    )
    any_steps: float = documented(
        1e5, "total number of steps up to which a law is always evaluated", "some milliseconds"
    )
    gap_steps: float = documented(
        4.5,
        "minimum gap, in sampling intervals, after which the state of a film is unknown",
        "linear interpolation of the motion over a longer step is inaccurate",
    )
    max_speed_ratio: float = documented(
        5.0,
        "ratio of a transition speed to the highest recorded speed above which it is not searched",
        "such a film is not visible, and its equations are stiff",
    )


@dataclass(frozen=True)
class TransientSettings:
    """Settings for the exclusion of initial-state transients from a fit."""

    max_difference: float = documented(
        0.2,
        "fraction of the noise below which two initial states give the same friction",
        "increases the variance by 4 %",
    )
    max_share_film: float = documented(
        0.5, "share of a run above which nothing is excluded for a film", "convention: half remains"
    )
    max_share_contact: float = documented(
        0.75,
        "share of a run above which nothing is excluded for a law with a bristle",
        "a run may be a single stroke, half of which deflects the contact",
    )
    max_share_backlash: float = documented(
        0.5,
        "share of a campaign above which nothing is excluded for a load cell with backlash",
        "a run whose force never reverses is excluded, unless most runs are such",
    )
    max_share_sliding: float = documented(
        0.2,
        "share of a run above which nothing is excluded for presliding or dwell stiction",
        "a model must predict short runs, such as cycles, from the start",
    )
    before_s: float = documented(6.0, "duration of the motions before a run, s", "convention")
    film_speeds: tuple[float, ...] = documented(
        (1e-3, 0.1, 1.0),
        "speeds of these motions for a film, as fractions of the run's top speed",
        "a film at rest, a thin one, and the thickest one",
    )
    contact_speeds: tuple[float, ...] = documented(
        (-1.0, 0.0, 1.0),
        "speeds of these motions for contacts and backlash, as fractions of the top speed",
        "both directions, and a rest",
    )
    film_margin: float = documented(
        1.5, "factor on the excluded duration for a film", "the film may be slower than the model's"
    )
    contact_margin: float = documented(
        1.1, "factor on the excluded duration for a contact", "its deflection is known better"
    )
    min_new_share: float = documented(
        1e-3,
        "minimum share of additionally excluded samples for a model to be refitted",
        "one in a thousand; fewer hardly change a fit",
    )
    min_reported_ratio: float = documented(
        2.0, "minimum ratio of a reported start to the typical residual", "convention"
    )


@dataclass(frozen=True)
class JumpSettings:
    """Settings for the detection of friction jumps, and of samples with an uncertain jump time."""

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
    """Settings for time delays of the force by run, and for the drift of its clock."""

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
        3, "parts of a run from whose delays a drift is estimated", "a line has two parameters"
    )
    min_part_samples: int = documented(
        60, "minimum number of samples of a part for an estimate of its delay", "convention"
    )
    max_edge_likelihood: float = documented(
        0.01, "likelihood at the ends of the range above which the delay is unknown", "1 in 100"
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
        "the force must not lead the motion in that fit",
    )


@dataclass(frozen=True)
class QuantisationSettings:
    """Settings for the bias of readings by coarse quantisation."""

    remaining_bias: float = documented(
        0.3,
        "share of the corrected bias below which a mean residual does not count as structure",
        "the noise and the force that determine the bias are estimates",
    )


@dataclass(frozen=True)
class HeldOutSettings:
    """Settings for held-out prediction errors."""

    max_folds: int = documented(
        12, "number of folds above which groups of runs are held out together", "computing time"
    )
    parts: int = documented(10, "parts of a single run; every other one is held out", "convention")
    min_information: float = documented(
        1e-4,
        "share of the information below which the remaining runs do not determine a parameter",
        "a hundred times the standard error",
    )
    extrapolation_margin: float = documented(
        0.1,
        "relative distance outside the range of the other runs up to which a run is not an "
        "extrapolation",
        "convention",
    )
    extrapolation_share: float = documented(
        0.05, "share of a run's samples that must be beyond all others", "more than single samples"
    )
    min_units: int = documented(6, "minimum number of units for a paired comparison", "convention")
    min_unit_samples: int = documented(16, "minimum number of samples of a stroke", "convention")


@dataclass(frozen=True)
class MotionSettings:
    """Settings for errors of the estimated motion in the likelihood."""

    coast_down_spacing: float = documented(
        2.0, "spacing of used samples of a coast-down, in correlation lengths", "independent errors"
    )
    min_share: float = documented(
        0.01,
        "share of the motion's errors in the variance below which they are neglected",
        "changes standard errors by half a per cent",
    )
    min_delay_share: float = documented(
        1e-3,
        "share of the mean variance, with a delay, below which it is not attributed to the clocks",
        "the motion is exact: the model lacks an effect",
    )
    min_noise_share: float = documented(
        1e-3,
        "minimum standard deviation of the noise, relative to the RMS force",
        "accuracy of a friction model; a command has no noise of its own",
    )
    scale_prior: float = documented(
        1.0,
        "prior standard deviation of the logarithm of the scale of the motion's errors",
        "the standard errors of the smoother are right within a factor of three",
    )
    huber_sigma: float = documented(
        2.5, "standard errors beyond which a residual is downweighted", "Huber (1964)"
    )
    max_small_share: float = documented(
        0.1,
        "mean share of the motion's errors in the variance up to which the RMS must be almost that "
        "of ordinary least squares",
        "the errors of a sample are smaller than a third of its noise",
    )
    max_rms_ratio: float = documented(
        1.25,
        "maximum RMS of a fit, relative to the smallest RMS of the fits compared with it",
        "large estimated errors of the motion can make a worse fit likelier",
    )
    min_delay_sigma: float = documented(
        5.0,
        "minimum delay of the force in all runs, in standard errors, for it to be corrected; its "
        "square is the least gain over the opposite delay",
        "1 in 2 million for Gaussian noise",
    )
    delay_range_samples: float = documented(
        16.0, "largest delay searched, of either sign, in shortest sampling intervals", "convention"
    )
    max_delay_minima: int = documented(
        3, "local minima of the sum of squares at which this delay is fitted", "convention"
    )
    max_clock_deviance: float = documented(
        9.0, "least difference of the deviance that identifies the force's clock", "three sigma"
    )
    min_smoothness_gain: float = documented(
        10.0,
        "decrease of the deviance for which the smoothness of the motion is changed, or its "
        "corners are located again",
        "three standard deviations",
    )
    roughness_factor: float = documented(
        30.0,
        "factor on the noise intensity; the change of the parameters is a systematic error, and an "
        "effect must fit better with the smaller smoothing as well",
        "convention: about one and a half decades",
    )


@dataclass(frozen=True)
class PeriodSettings:
    """Settings for the detection of periodic motions, whose records are replicates."""

    min_samples: int = documented(
        100, "minimum number of samples for a run to be tested for a period", "convention"
    )
    min_correlation: float = documented(
        0.9, "minimum autocorrelation of the speed at a period", "convention"
    )
    max_difference: float = documented(
        0.02,
        "standard deviation of the difference between periods, relative to that of the speed",
        "repeated motions; merely similar motions are not replicates",
    )


@dataclass(frozen=True)
class Settings:
    """Settings of the estimation that influence a verdict, by topic."""

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
"""Default settings of the estimation."""
