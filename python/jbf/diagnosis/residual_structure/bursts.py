"""Test for structure at isolated instants: bursts of large innovations of one sign.

Single large innovations are heavy-tailed noise or recording glitches and are independent of their
neighbours. A burst of friction lasts for several samples: the neighbours of its largest innovation
have the same sign. The statistic is the correlation of large innovations with their neighbours,
clipped to limit the influence of a single value. Its distribution without bursts is standard
normal.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import special

from jbf.arrays import Array, Mask
from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.policy import Policy
from jbf.estimation.prepared import Prepared
from jbf.estimation.samples import Samples
from jbf.records.counts import count_of

APART_S = 0.5
"""Largest time between two samples of the same event, s, if the sampling interval is shorter.

It concerns the text only.
"""
NO_NOISE = 1e-9
"""Share of the largest innovation below which the other innovations are rounding errors."""
NAMED = 4
"""Number of events listed in the description. It concerns the text only."""


def find_bursts(
    prepared: Sequence[Prepared],
    samples: Samples,
    innovations: Sequence[Array],
    residuals: Sequence[Array],
    policy: Policy,
) -> list[Remainder]:
    """Test for isolated bursts of friction, from large innovations of one sign.

    The size of a burst is reported from the residuals (record minus prediction). Without bursts the
    list is empty.
    """
    flat = samples.flat(innovations)
    if not len(flat):
        return []
    # The scale is the median absolute value, which bursts hardly increase.
    # In a record without noise, half of the innovations are zero.
    sizes = np.abs(flat)
    sigma = max(float(np.median(sizes)) / 0.6745, NO_NOISE * float(np.max(sizes)))
    if samples.motion is not None:
        # The noise of a drive's force is at least a share of the force (`min_noise_share`).
        least = samples.settings.motion.min_noise_share
        sigma = max(sigma, least * samples.rms([p.friction for p in prepared]))
    if sigma == 0.0:
        return []
    large = flat[sizes > policy.bursts.min_sigma * sigma]
    share = float(np.sum(large**2)) / max(float(flat @ flat), 1e-300)
    if share < policy.bursts.min_share:
        return []
    if _lasting_chance(innovations, samples, sigma, policy) > policy.bursts.chance:
        return []
    where = [
        (np.abs(e) > policy.bursts.min_sigma * sigma) & counted
        for e, counted in zip(innovations, samples.counted, strict=True)
    ]
    return [describe_events("time", "burst", prepared, residuals, where, share)]


def describe_events(
    axis: str,
    noun: str,
    prepared: Sequence[Prepared],
    residuals: Sequence[Array],
    where: Sequence[Mask],
    share: float,
) -> Remainder:
    """Describe events in the residual: their number, the largest size, and the largest instants.

    Parameters
    ----------
    axis, noun
        Kind of structure, and the singular name of an event, for example `burst`.
    residuals
        Record minus prediction, in the force unit of the rig, one array per run.
    where
        Whether a sample belongs to an event, one array per run.
    share
        Share of the mean square of the residual.
    """
    events: list[tuple[float, float, str]] = []
    for r, within, p in zip(residuals, where, prepared, strict=True):
        index = np.flatnonzero(within)
        time, apart_s = p.run.time_s[index], max(APART_S, 1.5 * p.step_s)
        for group in np.split(index, np.flatnonzero(np.diff(time) > apart_s) + 1):
            if len(group):
                top = int(group[np.argmax(np.abs(r[group]))])
                events.append((abs(float(r[top])), float(p.run.time_s[top]), p.run.name))
    events.sort(reverse=True)
    largest = ", ".join(f"{time:.1f} s in {name}" for _, time, name in events[:NAMED])
    unit = prepared[0].run.quantities.force
    size = "of" if len(events) == 1 else "the largest"
    words = f"{count_of(len(events), noun)}, {size} {events[0][0]:.2g} {unit}: at {largest}"
    return Remainder(axis, words, min(share, 1.0))


def _lasting_chance(
    innovations: Sequence[Array], samples: Samples, sigma: float, policy: Policy
) -> float:
    """p-value of the agreement in sign of large innovations with their neighbours."""
    product, square, clip = 0.0, 0.0, policy.bursts.clip_sigma
    clipped = np.clip(samples.flat(innovations) / sigma, -clip, clip)
    usual = float(np.mean(clipped**2))
    for e, counted in zip(innovations, samples.counted, strict=True):
        x = np.clip(e / sigma, -clip, clip)
        large = np.abs(e) > policy.bursts.min_sigma * sigma
        pairs = counted[1:] & counted[:-1] & (large[1:] | large[:-1])
        product += float(np.sum((x[1:] * x[:-1])[pairs]))
        square += clip**2 * usual * int(pairs.sum())
    return float(special.ndtr(-product / np.sqrt(square))) if square > 0.0 else 1.0
