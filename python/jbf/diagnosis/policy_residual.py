"""Sections of the policy: tests of the residual structure."""

from __future__ import annotations

from dataclasses import dataclass

from jbf.comparison.patterns import LEAST_SHARE, SIGNIFICANCE
from jbf.estimation.settings import documented

FIVE_SIGMA = "1 in 2 million for Gaussian noise"
ONE_IN_TEN_THOUSAND = "1 campaign in 10,000"
SET_BEFORE = "fixed before any campaign was examined"


@dataclass(frozen=True)
class Patterns:
    """Thresholds for patterns of the residual along an axis, for example over the speed."""

    min_share: float = documented(
        LEAST_SHARE, "share of the mean square that a pattern must explain", "as in a comparison"
    )
    min_sigma: float = documented(
        SIGNIFICANCE,
        "minimum excess over the value expected by chance, in standard deviations",
        "as in a comparison",
    )


@dataclass(frozen=True)
class Tones:
    """Thresholds for residual structure at one frequency."""

    chance: float = documented(
        1e-7, "probability of a spectral line by chance, over all lines of a run", SET_BEFORE
    )
    min_share: float = documented(0.008, "minimum share of the mean square in a tone", SET_BEFORE)
    min_samples: int = documented(
        64, "minimum number of samples for a run to be tested", "convention"
    )
    min_periods: float = documented(
        8.0, "minimum number of periods within a run", "slower structure is a pattern over time"
    )


@dataclass(frozen=True)
class Ripples:
    """Thresholds for periodic residual structure over the travel.

    The significance level and the share of the mean square are those of `Tones`.
    """

    min_periods: float = documented(
        8.0, "minimum number of periods within the travel", "longer waves are patterns"
    )
    min_bins: float = documented(
        4.0, "minimum number of travel bins within a pitch", "twice the limit of sampling"
    )
    min_runs: int = documented(3, "minimum number of runs that show the ripple", "convention")
    max_common_share: float = documented(
        0.5,
        "maximum share of the ripple's power that one common phase explains",
        "above it an effect describes the ripple",
    )
    weaker_runs: float = documented(
        2.0 / 3.0,
        "share of the runs, those with the weakest ripple, that must also show it",
        "a tone has this pitch in a few runs only",
    )
    weaker_chance: float = documented(
        1e-3, "probability of the ripple in these runs by chance", "1 in 1000"
    )
    max_tone_share: float = documented(
        0.8,
        "share of the ripple's mean square above which a fixed frequency explains it equally well",
        "at half a line width from its centre a line loses a fifth of its power",
    )


@dataclass(frozen=True)
class Replicates:
    """Thresholds for residual structure that repeats with a periodic motion."""

    min_sigma: float = documented(5.0, "minimum correlation, in standard errors", FIVE_SIGMA)
    min_share: float = documented(
        0.03, "minimum share of the mean square that repeats", "simulated campaigns"
    )
    min_pairs: int = documented(
        100, "minimum number of pairs of replicates for a run to be tested", "convention"
    )
    memory_lags: tuple[float, ...] = documented(
        (0.5, 0.6, 0.7, 0.8, 0.9),
        "lags, in periods, at which a correlation is attributed to the noise",
        "a repeating error has both signs between half a period and a whole one",
    )


@dataclass(frozen=True)
class Bursts:
    """Thresholds for residual structure at isolated instants."""

    min_sigma: float = documented(
        5.0, "standard deviations beyond which an innovation is large", FIVE_SIGMA
    )
    min_share: float = documented(
        0.008, "minimum share of the mean square in large innovations", "simulated campaigns"
    )
    chance: float = documented(
        1e-4, "probability of neighbours of the same sign by chance", ONE_IN_TEN_THOUSAND
    )
    clip_sigma: float = documented(
        3.0, "standard deviations at which innovations are clipped in this test", "convention"
    )


@dataclass(frozen=True)
class Momentum:
    """Thresholds for disturbances found by the momentum residual of short windows."""

    intervals: int = documented(
        8,
        "number of sampling intervals of a window",
        "impacts last 4 to 8 samples; errors of the speed dominate shorter windows",
    )
    min_sigma: float = documented(
        6.0,
        "standard errors beyond which a momentum residual is a disturbance",
        "the largest of a run is 2.3 to 4.2 in six simulated drives without a disturbance",
    )
    min_share: float = documented(
        0.1, "minimum share of the mean square in such windows", "simulated drives with impacts"
    )


@dataclass(frozen=True)
class Constancy:
    """Thresholds for parameters that differ between runs."""

    chance: float = documented(1e-8, "significance level of the disagreement", SET_BEFORE)
    min_ratio: float = documented(
        2.5,
        "minimum ratio of chi-square to its degrees of freedom",
        "simulated campaigns: a noise model is never exact",
    )
    min_sensitivity: float = documented(
        1e-3,
        "relative sensitivity of a run below which it does not determine a direction of the "
        "parameters",
        "convention",
    )


@dataclass(frozen=True)
class Strokes:
    """Thresholds for friction levels that differ between strokes.

    The share of the mean square is that of `Patterns`, the significance level that of `Constancy`.
    """

    min_strokes: int = documented(
        3, "minimum number of strokes for a run to be tested", "two degrees of freedom"
    )
    min_samples: int = documented(
        8, "minimum number of samples for half a stroke to be tested", "convention"
    )
