"""Typical magnitudes of a campaign as robust quantiles.

Neither inertia at a reversal nor a bad sample determines a scale.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf.errors import InputError
from jbf.estimation.campaign import Campaign
from jbf.estimation.prepared import Prepared

Array = npt.NDArray[np.float64]

Mask = npt.NDArray[np.bool_]
HUM = 0.02
"""Fraction of the top speed below which a speed is not used for a scale.

It only starts a search.
"""


@dataclass(frozen=True)
class Scales:
    """Typical magnitudes of a campaign.

    Attributes
    ----------
    whole_n
        Median friction.
    kinetic_n, viscous_n_s_m
        Intercept and slope of a line, over speed, through the friction in the direction of motion
        of the slow and the fast half of the samples.
    breakaway_n
        High quantile of the friction at low speed.
    slow_m_s, usual_m_s
        Quantiles of the speed, m/s.
    stroke_m, resolved_m
        Typical distance between reversals, and the shortest one that the samples resolve near a
        reversal, m.
    """

    whole_n: float
    kinetic_n: float
    viscous_n_s_m: float
    breakaway_n: float
    slow_m_s: float
    usual_m_s: float
    stroke_m: float
    resolved_m: float


def scales(campaign: Campaign) -> Scales:
    """Compute the typical magnitudes of a campaign's runs from samples in motion.

    Raises
    ------
    InputError
        There is no such sample.
    """
    moving = moving_samples(campaign)
    if not any(map(np.any, moving)):
        raise InputError(
            file=campaign.prepared[0].run.path or campaign.prepared[0].run.name,
            column="velocity_m_s",
            problem="of no sample that counts, in any run, is it known which way it moves",
            mend="record strokes of many samples each, or check the unit of time",
        )
    v = np.concatenate(
        [p.motion.velocity[m] for p, m in zip(campaign.prepared, moving, strict=True)]
    )
    f = np.concatenate([p.friction[m] for p, m in zip(campaign.prepared, moving, strict=True)])
    speed, along = np.abs(v), f * np.sign(v)
    whole = max(float(np.median(np.abs(f))), 1e-5)
    slow, usual = (float(q) for q in np.quantile(speed, [0.1, 0.5]))
    slow_m_s, usual_m_s = max(slow, 1e-9), max(usual, 1e-9)
    low, high = speed <= usual, speed >= usual
    f_low, f_high = float(np.median(along[low])), float(np.median(along[high]))
    v_low, v_high = float(np.median(speed[low])), float(np.median(speed[high]))
    slope = max((f_high - f_low) / (v_high - v_low), 0.0) if v_high > 1.2 * v_low else 0.0
    kinetic = max(f_low - slope * v_low, 0.5 * whole)
    breakaway = max(float(np.quantile(along[low], 0.9)), 1.1 * kinetic)
    ways = np.concatenate([_strokes(p, m) for p, m in zip(campaign.prepared, moving, strict=True)])
    # A drive that settles overshoots slightly; those distances are not strokes.
    stroke = max(float(np.median(ways[ways >= 0.1 * np.max(ways)])), 1e-9)
    step = float(np.median([p.step_s for p in campaign.prepared]))
    resolved = min(max(0.1 * slow_m_s * step, 1e-7 * stroke), 1e-2 * stroke)
    return Scales(whole, kinetic, slope, breakaway, slow_m_s, usual_m_s, stroke, resolved)


def moving_samples(campaign: Campaign) -> list[Mask]:
    """Mask of the samples that count and are in motion, one a run."""
    return [
        _moving(p, counted)
        for p, counted in zip(campaign.prepared, campaign.samples.counted, strict=True)
    ]


def _moving(p: Prepared, counted: Mask) -> Mask:
    """Mask of samples in motion; noise near zero speed has neither a direction nor a travel."""
    speed = np.abs(p.motion.velocity)
    top = float(np.quantile(speed, 0.99)) or float(np.max(speed))
    found: Mask = counted & (speed > HUM * top)
    return found


def _strokes(p: Prepared, moving: Mask) -> Array:
    """Distances between reversals, m; the whole travel without a reversal."""
    v = p.motion.velocity
    steps = 0.5 * (v[1:] + v[:-1]) * np.diff(p.run.time_s)
    path = np.concatenate(([0.0], np.cumsum(steps)))
    sign = np.sign(v)
    known = np.flatnonzero(moving)
    turned = known[1:][sign[known[1:]] != sign[known[:-1]]]
    ways = np.abs(np.diff(path[turned]))
    return ways if len(ways) else np.array([float(np.ptp(path))])
