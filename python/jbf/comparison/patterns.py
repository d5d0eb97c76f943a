"""Patterns of a residual: axes along which bin means differ significantly from zero."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf.arrays import Array
from jbf.comparison.axes import all_axes
from jbf.comparison.bins import Axis, Bin, Binned, labels
from jbf.estimation.campaign import Campaign
from jbf.estimation.samples import Samples

Counts = npt.NDArray[np.intp]

LEAST_SHARE = 0.01
"""Fraction of the residual's mean square below which a pattern is not reported."""
SIGNIFICANCE = 6.0
"""Required excess of the explained sum of squares over chance, in standard deviations."""
STRONG_SHARE = 0.02
"""Fraction of the explained sum of squares below which a bin is omitted from the text."""
WHOLE_AXIS_SHARE = 0.8
"""Fraction of the bins above which a pattern covers the whole axis."""


@dataclass(frozen=True)
class Failure:
    """Residual pattern along one axis.

    Attributes
    ----------
    axis
        `velocity`, `direction`, `regime` (for a law without a film: `speed range`),
        `acceleration`, `angle`, `time`, `run`, `time since a rest` or
        `distance since a reversal`.
    where
        Text that describes the pattern.
    share
        Fraction of the residual's mean square that the means of the bins explain, 0 to 1.
    bins, means_n, counts
        The bins, and for each the mean of record minus prediction (N) and the number of samples.
    """

    axis: Axis
    where: str
    share: float
    bins: tuple[Bin, ...]
    means_n: Array
    counts: Counts

    @property
    def labels(self) -> tuple[str, ...]:
        """Label of each bin of the pattern, as text."""
        return labels(self.axis, self.bins)

    def to_dict(self) -> dict[str, Any]:
        """Return the pattern as a JSON-serialisable dict."""
        return {"axis": self.axis, "where": self.where, "share": round(self.share, 4)}


def find_failures(
    campaign: Campaign,
    samples: Samples,
    residuals: Sequence[Array],
    u_tr: float | None,
    noise_rms: float,
) -> tuple[Failure, ...]:
    """Find the axes along which the residual (record minus prediction) has a pattern.

    The pattern with the largest share is first.
    """
    axes = all_axes(campaign, u_tr)
    patterns = (pattern_along(axis, samples, residuals, noise_rms) for axis in axes)
    return tuple(sorted((f for f in patterns if f is not None), key=lambda f: -f.share))


def bin_means(axis: Binned, samples: Samples, residuals: Sequence[Array]) -> tuple[Array, Counts]:
    """Mean residual in each bin, N, and number of included samples."""
    r, places = samples.flat(residuals), samples.flat(axis.places)
    in_bins = places >= 0
    counts = np.bincount(places[in_bins], minlength=len(axis.bins))
    sums = np.bincount(places[in_bins], weights=r[in_bins], minlength=len(axis.bins))
    return sums / np.maximum(counts, 1), counts


def pattern_along(
    axis: Binned,
    samples: Samples,
    residuals: Sequence[Array],
    noise_rms: float,
    least_share: float = LEAST_SHARE,
    significance: float = SIGNIFICANCE,
    told_of: Sequence[Array] | None = None,
) -> Failure | None:
    """Test the residuals (N) for a pattern along an axis; None if it is not significant.

    Parameters
    ----------
    noise_rms
        Standard deviation of the noise without a pattern, N.
    least_share
        Fraction of the mean square that the means of the bins must explain beyond chance.
    significance
        Required excess of the explained part over chance, in standard deviations.
    told_of
        Residuals, N, whose means are reported in text and numbers, if they differ from the tested
        ones.
    """
    r = samples.flat(residuals)
    total = float(r @ r)
    means, counts = bin_means(axis, samples, residuals)
    used = int(np.count_nonzero(counts))
    explained = float(np.sum(counts * means**2))
    # Under the null hypothesis, the mean of each bin explains one noise variance.
    chance = used * noise_rms**2
    spread = np.sqrt(2.0 * used) * noise_rms**2
    share = (explained - chance) / total if total > 0 else 0.0
    if share < least_share or explained < chance + significance * spread:
        return None
    described_means = means if told_of is None else bin_means(axis, samples, told_of)[0]
    words = pattern_words(axis, described_means, counts, significant_means=means)
    return Failure(axis.axis, words, share, axis.bins, described_means, counts)


def pattern_words(
    axis: Binned, means: Array, counts: Counts, significant_means: Array | None = None
) -> str:
    """Describe the pattern of bin means along an axis.

    `significant_means` holds the means that select the bins, if they differ.
    """
    weight = counts * (means if significant_means is None else significant_means) ** 2
    unit = axis.force_unit
    # With very many bins, even the largest fraction of a bin is small.
    strong = (weight > STRONG_SHARE * weight.sum()) | (weight == weight.max())
    directions = np.array([b.direction for b in axis.bins])
    both_ways = bool(np.all(directions != 0)) and strong.sum() > 1
    if both_ways and np.all(np.sign(means[strong]) == directions[strong]):
        size = np.average(np.abs(means[strong]), weights=counts[strong])
        lead = f"sign of v: record above the model by {size:.2g} {unit} in the direction of motion"
    elif both_ways and np.all(np.sign(means[strong]) == -directions[strong]):
        size = np.average(np.abs(means[strong]), weights=counts[strong])
        lead = f"sign of v: record below the model by {size:.2g} {unit} in the direction of motion"
    elif np.all(means[strong] > 0) or np.all(means[strong] < 0):
        size = np.average(means[strong], weights=counts[strong])
        lead = f"one sign throughout: record minus model {size:+.2g} {unit}"
    else:
        lead = ""
    worst = np.argsort(-np.where(strong, counts * means**2, -1.0), kind="stable")[:2]
    spots = "; ".join(f"{means[i]:+.2g} {unit} at {axis.labels[i]}" for i in worst if strong[i])
    if not lead:
        return f"most {spots}"
    throughout = strong.sum() / max(np.count_nonzero(counts), 1) > WHOLE_AXIS_SHARE
    return f"{f'all of {axis.axis}, ' if throughout else ''}{lead}; most {spots}"
