"""Starting values of a fit, estimated from typical magnitudes of the data.

The parameters of a law in newtons differ by orders of magnitude between machines. The catalogue
entry of a parameter names the quantity of the data from which its starting value is computed
(`jbf_core::page::Start`). Without such a name, the starting value is that of the catalogue. The
magnitudes are quantiles, which are robust against outliers and inertial forces at reversals.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from jbf.arrays import Array, Mask
from jbf.errors import InputError
from jbf.estimation.campaign import Campaign
from jbf.estimation.pitches import known_pitches, longest_pitch, mass, pitches
from jbf.estimation.prepared import Prepared
from jbf.models.catalogue import Parameter
from jbf.records.findings.slow_temperature import recorded_temperature

Starts = tuple[float, ...]
CELL_ERROR = 0.03
"""Starting value of a load-cell error, as a fraction of the largest force."""
MAX_CELL_HYSTERESIS = 0.25
"""Largest half-width of the hysteresis of a load cell, as a fraction of the largest force. A wider
loop is friction or elasticity of the machine."""
SHORTEST_M = 1e-9
"""Lower limit of a stroke, m, which is used for a drive that does not move."""
BEYOND = 0.1
"""Margin added to the stroke at either end, as a fraction of the travel of the runs. Waves whose
slope vanishes at the ends of the stroke can then describe a slope at those of the runs."""


@dataclass(frozen=True)
class Scales:
    """Typical magnitudes of the friction, speed and stroke of a campaign.

    Attributes
    ----------
    median_n
        Median friction, N.
    kinetic_n, viscous_n_s_m
        Intercept and slope of a line, over speed, through the friction in the direction of motion
        of the slow and the fast half of the samples.
    breakaway_n
        High quantile of the friction at low speed, N.
    slow_m_s, usual_m_s
        Quantiles of the speed, m/s.
    stroke_m, resolved_m
        Typical distance between reversals, and the shortest one that the samples resolve near a
        reversal, m.
    """

    median_n: float
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
        No sample is in motion.
    """
    moving = campaign.moving
    if not any(np.any(m) for _, m in moving):
        raise InputError(
            file=campaign.prepared[0].run.path or campaign.prepared[0].run.name,
            column="velocity_m_s",
            problem="the direction of motion is undetermined at every usable sample",
            remedy="record strokes of many samples each, or check the unit of time",
        )
    v = np.concatenate([p.motion.velocity[m] for p, m in moving])
    f = np.concatenate([p.friction[m] for p, m in moving])
    speed, along = np.abs(v), f * np.sign(v)
    median_n = max(float(np.median(np.abs(f))), 1e-5)
    slow, median_speed = (float(q) for q in np.quantile(speed, [0.1, 0.5]))
    slow_m_s, usual_m_s = max(slow, 1e-9), max(median_speed, 1e-9)
    low, high = speed <= median_speed, speed >= median_speed
    f_low, f_high = float(np.median(along[low])), float(np.median(along[high]))
    v_low, v_high = float(np.median(speed[low])), float(np.median(speed[high]))
    slope = max((f_high - f_low) / (v_high - v_low), 0.0) if v_high > 1.2 * v_low else 0.0
    kinetic = max(f_low - slope * v_low, 0.5 * median_n)
    breakaway = max(float(np.quantile(along[low], 0.9)), 1.1 * kinetic)
    distances = np.concatenate([_strokes(p, m) for p, m in moving])
    # Overshoots of a drive at the end of a stroke are not strokes.
    stroke = max(float(np.median(distances[distances >= 0.1 * np.max(distances)])), 1e-9)
    step = float(np.median([p.step_s for p in campaign.prepared]))
    resolved = min(max(0.1 * slow_m_s * step, 1e-7 * stroke), 1e-2 * stroke)
    return Scales(median_n, kinetic, slope, breakaway, slow_m_s, usual_m_s, stroke, resolved)


def _strokes(p: Prepared, moving: Mask) -> Array:
    """Distances between reversals of a run, m; the whole travel if there is no reversal."""
    v = p.motion.velocity
    steps = 0.5 * (v[1:] + v[:-1]) * np.diff(p.run.time_s)
    path = np.concatenate(([0.0], np.cumsum(steps)))
    sign = np.sign(v)
    directed = np.flatnonzero(moving)
    turned = directed[1:][sign[directed[1:]] != sign[directed[:-1]]]
    distances = np.abs(np.diff(path[turned]))
    return distances if len(distances) else np.array([float(np.ptp(path))])


def stroke(campaign: Campaign) -> tuple[float, float]:
    """Lowest and highest position of the strokes of all runs, m (rad for a joint).

    Both are computed from the motion only, so that no information on held-out forces is used.
    """
    angles = np.concatenate([p.motion.angle_rad[moving] for p, moving in campaign.moving])
    places = angles * campaign.arm_m
    if not len(places):
        return -SHORTEST_M, SHORTEST_M
    low, high = float(np.min(places)), float(np.max(places))
    margin = max(BEYOND * (high - low), SHORTEST_M)
    return low - margin, high + margin


def _stiffness(s: Scales) -> Starts:
    """Starting values of a contact stiffness: breakaway force divided by a displacement.

    The displacements are a tenth of a stroke, the smallest resolved distance and their geometric
    mean.
    """
    long, short = 0.1 * s.stroke_m, s.resolved_m
    distances = (long, float(np.sqrt(long * short)), short)
    return tuple(s.breakaway_n / distance for distance in distances)


RULES: dict[str, Callable[[Scales], Starts]] = {
    "kinetic": lambda s: (s.kinetic_n, s.median_n),
    "breakaway": lambda s: (s.breakaway_n,),
    "breakaway_excess": lambda s: (s.breakaway_n - s.kinetic_n,),
    "viscous": lambda s: (s.viscous_n_s_m, 0.0),
    "stribeck_speed": lambda s: (s.slow_m_s, 0.3 * s.usual_m_s, s.usual_m_s),
    "usual_speed": lambda s: (s.usual_m_s,),
    "slowness": lambda s: (0.5 / s.usual_m_s, 5.0 / s.usual_m_s),
    "stiffness": _stiffness,
    "slip_distance": lambda s: tuple(share * s.stroke_m for share in (1e-2, 1e-1, 1e-3)),
    "damping": lambda s: (0.05 * s.kinetic_n / s.usual_m_s,),
    "drag": lambda s: (0.1 * s.kinetic_n,),
}
"""Rules by their name in a catalogue entry: from magnitudes to starting values, likeliest first."""
LINEAR_RULES: dict[str, Callable[[Scales], Starts]] = {
    "drive_play": lambda s: tuple(share * s.stroke_m for share in (1e-2, 1e-3, 1e-4)),
    # A drive that deflects by a hundredth or a thousandth of a stroke under the friction, and
    # oscillates well within the duration of a stroke.
    "drive_stiffness": lambda s: tuple(
        s.breakaway_n / (share * s.stroke_m) for share in (1e-2, 1e-3)
    ),
    "drive_inertia": lambda s: (
        s.breakaway_n / (1e-2 * s.stroke_m) * (0.02 * s.stroke_m / s.usual_m_s) ** 2,
    ),
    "drive_damping": lambda s: (s.breakaway_n / s.usual_m_s,),
}
"""Rules for linear axes where the catalogue values are those of a shaft."""


def _reference_temperature(campaign: Campaign) -> Starts:
    """Starting value of the reference temperature of the lubricant's viscosity, C.

    If the rig has none, the mean of the recorded temperatures is used, rounded to one degree.
    """
    lubricant = campaign.rig.lubricant
    if lubricant is not None and lubricant.temperature_c is not None:
        return (lubricant.temperature_c,)
    recorded = [recorded_temperature(p.run) for p in campaign.prepared]
    means = [float(np.mean(celsius)) for celsius in recorded if celsius is not None]
    return (float(np.round(np.mean(means))),) if means else ()


def _largest_n(campaign: Campaign) -> float:
    """Largest recorded force, N, as the 99 % quantile of its magnitude."""
    forces = np.concatenate([p.friction[np.isfinite(p.friction)] for p in campaign.prepared])
    return max(float(np.quantile(np.abs(forces), 0.99)), 1e-5)


def _run_times(campaign: Campaign) -> Starts:
    """Starting values of a time constant, s: 0.3 and 0.1 of the median duration of a run."""
    median_s = float(np.median([p.run.duration_s for p in campaign.prepared]))
    return (0.3 * median_s, 0.1 * median_s)


def _down_to_sample(campaign: Campaign, page: Parameter) -> Starts:
    """Starting values of a delay, s: the catalogue's, and thirds down to the resolved one."""
    least, step = min(page.starts), float(np.median([p.step_s for p in campaign.prepared]))
    count = int(np.ceil(np.log(max(least / (0.25 * step), 1.0)) / np.log(3.0)))
    return (*page.starts, *(least / 3.0**k for k in range(1, count + 1)))


CAMPAIGN_RULES: dict[str, Callable[[Campaign, Parameter], Starts]] = {
    "mass": lambda c, _: () if (kg := mass(c)) is None else (kg,),
    "pitch": lambda c, _: (*pitches(c, along=False), *known_pitches(c.rig)),
    "ripple_pitch": lambda c, _: (*pitches(c, along=True), *known_pitches(c.rig)),
    "run_time": lambda c, _: _run_times(c),
    "stroke_middle": lambda c, _: (0.5 * sum(stroke(c)),),
    "stroke_half": lambda c, _: (0.5 * float(np.diff(stroke(c))[0]),),
    "reference_temperature": lambda c, _: _reference_temperature(c),
    "cell_play": lambda c, _: (CELL_ERROR * _largest_n(c),),
    "cell_cubic": lambda c, _: (CELL_ERROR / _largest_n(c) ** 2,),
    "lateness": _down_to_sample,
}
"""Rules that use the runs, for laws in newtons; those of `OF_ANY_LAW` apply to every law.

If the result is empty, the catalogue values apply.
"""
OF_ANY_LAW = ("reference_temperature", "cell_play", "cell_cubic", "lateness")
"""Rules that apply to every law, because they concern quantities of the records."""
PITCHES = ("pitch", "ripple_pitch")


def _limited(page: Parameter, campaign: Campaign, in_newtons: bool) -> Parameter:
    """Limit the upper bound of a parameter to the values that the data resolve.

    A film with a transition speed of several times the highest recorded speed has no influence on
    the record, and its equations are stiff. The travel must contain several periods of a pitch. The
    hysteresis of a load cell is limited by `MAX_CELL_HYSTERESIS`. A delay is limited to a fraction
    of the shortest run, and any other time to a multiple of the longest run: a slower process
    cannot be distinguished from a trend.
    """
    limit = np.inf
    if page.bound == "transition_speed":
        top = max(float(np.max(np.abs(p.motion.velocity))) for p in campaign.prepared)
        limit = max(campaign.settings.film.max_speed_ratio * top, 2.0 * max(page.starts))
    elif page.start in PITCHES and in_newtons:
        limit = max(longest_pitch(campaign), page.lower * (1.0 + 1e-6))
    elif page.start == "cell_play":
        largest_n = _largest_n(campaign)
        limit = max(MAX_CELL_HYSTERESIS * largest_n, page.lower + 1e-6 * largest_n)
    elif page.unit == "s":
        durations_s, settings = [p.run.duration_s for p in campaign.prepared], campaign.settings
        is_delay = page.start == "lateness"
        shortest_s = settings.delays.max_run_share * min(durations_s)
        limit = shortest_s if is_delay else settings.conditions.max_time_ratio * max(durations_s)
        limit = limit if limit > page.lower else np.inf
    return replace(page, upper=min(page.upper, limit))


def _inside(page: Parameter, starts: Starts) -> Parameter:
    """Return a catalogue entry with these starting values, clipped to its bounds.

    The entry is unchanged if `starts` is empty.
    """
    inside = (float(np.clip(x, page.lower, page.upper)) for x in starts)
    return replace(page, starts=tuple(dict.fromkeys(inside)) or page.starts)


def with_starts(
    pages: dict[str, Parameter], campaign: Campaign, in_newtons: bool
) -> dict[str, Parameter]:
    """Return the catalogue entries of a problem's parameters with starting values from the data.

    A law that scales with the load keeps the catalogue values, because its coefficients are not in
    newtons. For a law with a film, the data limit the transition speed.
    """
    sizes = scales(campaign) if in_newtons else None
    rules = RULES if campaign.rig.bearing is not None else RULES | LINEAR_RULES
    with_values = {}
    for name, page in pages.items():
        page = _limited(page, campaign, in_newtons)
        starts = page.starts if page.unit == "s" else ()
        if sizes is not None and page.start in rules:
            starts = rules[page.start](sizes)
        elif page.start in (CAMPAIGN_RULES if in_newtons else OF_ANY_LAW):
            starts = CAMPAIGN_RULES[page.start](campaign, page)
        with_values[name] = _inside(page, starts)
    return with_values
