"""Where a fit starts, taken from the data: a law in newtons has no one scale that suits a watch
and a press.

Each rule is found by the parameter's name, which is the same in every law; a parameter without
a rule starts where the catalogue says. Everything is a robust quantile, so that neither
inertia at a reversal nor a bad sample sets a scale.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from jbf.estimation.campaign import Campaign, Prepared
from jbf.models.catalogue import Parameter

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Starts = tuple[float, ...]

HUM = 0.02
"""Speeds below this share of the top are no motion to take a scale from."""


FASTEST_FILM = 5.0
"""A search looks for transition speeds up to so many times the fastest on record."""


@dataclass(frozen=True)
class Scales:
    """The sizes of a campaign.

    Attributes
    ----------
    whole_n
        Median friction.
    kinetic_n, viscous_n_s_m
        Friction in the direction of motion on a line through the slow and the fast half.
    breakaway_n
        High quantile of slow friction.
    slow_m_s, usual_m_s
        Quantiles of the speed, m/s.
    stroke_m, resolved_m
        Typical way between reversals, and the shortest that the samples resolve near one, m.
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
    """The sizes of a campaign's runs, from samples that move."""
    moving = [_moving(p) for p in campaign.prepared]
    v = np.concatenate(
        [p.motion.velocity_m_s[m] for p, m in zip(campaign.prepared, moving, strict=True)]
    )
    f = np.concatenate([p.friction_n[m] for p, m in zip(campaign.prepared, moving, strict=True)])
    speed, along = np.abs(v), f * np.sign(v)
    whole = max(float(np.median(np.abs(f))), 1e-5)
    slow_m_s, usual_m_s = (max(float(q), 1e-9) for q in np.quantile(speed, [0.1, 0.5]))
    low, high = speed <= usual_m_s, speed >= usual_m_s
    f_low, f_high = float(np.median(along[low])), float(np.median(along[high]))
    v_low, v_high = float(np.median(speed[low])), float(np.median(speed[high]))
    slope = max((f_high - f_low) / (v_high - v_low), 0.0) if v_high > 1.2 * v_low else 0.0
    kinetic = max(f_low - slope * v_low, 0.5 * whole)
    breakaway = max(float(np.quantile(along[low], 0.9)), 1.1 * kinetic)
    ways = np.concatenate([_strokes(p) for p in campaign.prepared])
    # A drive that settles overshoots by a little: those ways are no strokes.
    stroke = max(float(np.median(ways[ways >= 0.1 * np.max(ways)])), 1e-9)
    step = float(np.median([p.step_s for p in campaign.prepared]))
    resolved = min(max(0.1 * slow_m_s * step, 1e-7 * stroke), 1e-2 * stroke)
    return Scales(whole, kinetic, slope, breakaway, slow_m_s, usual_m_s, stroke, resolved)


def _moving(p: Prepared) -> Mask:
    """Samples in motion: a hum near zero speed has neither a direction nor a way."""
    speed = np.abs(p.motion.velocity_m_s)
    top = float(np.quantile(speed, 0.99)) or float(np.max(speed))
    found: Mask = p.trusted & ~p.motion.resting & (speed > HUM * top)
    return found


def _strokes(p: Prepared) -> Array:
    """Ways between reversals, m; the whole way where there is none."""
    v = p.motion.velocity_m_s
    steps = 0.5 * (v[1:] + v[:-1]) * np.diff(p.run.time_s)
    path = np.concatenate(([0.0], np.cumsum(steps)))
    sign = np.sign(v)
    known = np.flatnonzero(_moving(p))
    turned = known[1:][sign[known[1:]] != sign[known[:-1]]]
    ways = np.abs(np.diff(path[turned]))
    return ways if len(ways) else np.array([float(np.ptp(path))])


def _stiffness(s: Scales) -> Starts:
    """Breakaway over a tenth of a stroke, over the shortest way resolved, and between them."""
    long, short = 0.1 * s.stroke_m, s.resolved_m
    ways = (long, float(np.sqrt(long * short)), short)
    return tuple(s.breakaway_n / way for way in ways)


_RULES: dict[str, Callable[[Scales], Starts]] = {
    "F_c_n": lambda s: (s.kinetic_n, s.whole_n),
    "F_s_n": lambda s: (s.breakaway_n,),
    "F_s_inf_n": lambda s: (s.breakaway_n - s.kinetic_n,),
    "F_v_n_s_m": lambda s: (s.viscous_n_s_m, 0.0),
    "v_s_m_s": lambda s: (s.slow_m_s, 0.3 * s.usual_m_s),
    "v_d_m_s": lambda s: (s.usual_m_s,),
    "sigma_0_n_m": _stiffness,
    "k_t_n_m": _stiffness,
    # A law in newtons presses with one.
    "presliding.sigma_1_m": _stiffness,
    "sigma_1_n_s_m": lambda s: (0.05 * s.kinetic_n / s.usual_m_s,),
    "coulomb_drag.F_d_n": lambda s: (0.1 * s.kinetic_n,),
}
"""Name to starting values, likeliest first."""

_LINEAR_RULES: dict[str, Callable[[Scales], Starts]] = {
    # A drive that gives by a hundredth or a thousandth of a stroke under the friction, and
    # swings well within the time of a stroke.
    "drive_compliance.k_n_m_rad": lambda s: tuple(
        s.breakaway_n / (share * s.stroke_m) for share in (1e-2, 1e-3)
    ),
    "drive_compliance.J_kg_m2": lambda s: (
        s.breakaway_n / (1e-2 * s.stroke_m) * (0.02 * s.stroke_m / s.usual_m_s) ** 2,
    ),
    "drive_compliance.c_n_m_s_rad": lambda s: (s.breakaway_n / s.usual_m_s,),
}
"""The same for a drive on a linear axis, whose catalogue values are those of a shaft."""


def _bounded(pages: dict[str, Parameter], campaign: Campaign) -> dict[str, Parameter]:
    """Pages of parameters that the data bound: a film that carries the load only at several times
    the fastest speed on record never shows, and its equations grow stiff."""
    name = "U_tr_m_s"
    if name not in pages:
        return {}
    top = max(float(np.max(np.abs(p.motion.velocity_m_s))) for p in campaign.prepared)
    page = pages[name]
    upper = min(page.upper, max(FASTEST_FILM * top, 2.0 * max(page.starts)))
    return {name: replace(page, upper=upper)}


def with_starts(pages: dict[str, Parameter], campaign: Campaign) -> dict[str, Parameter]:
    """The pages of a problem's parameters, their starting values taken from the data.

    A law that scales with the load keeps the catalogue's: its coefficients know no newtons. Of a
    law with a film the data bound the transition speed.
    """
    if "F_c_n" not in pages:
        return pages | _bounded(pages, campaign)
    rules = dict(_RULES)
    if campaign.rig.bearing is None:
        rules |= _LINEAR_RULES
    sizes = scales(campaign)
    found = {}
    for name, page in pages.items():
        if name in rules:
            inside = (float(np.clip(x, page.lower, page.upper)) for x in rules[name](sizes))
            page = replace(page, starts=tuple(dict.fromkeys(inside)))
        found[name] = page
    return found
