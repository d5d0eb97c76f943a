"""Spatial periods (pitches) at which a drive's force repeats: starting values for their fit.

The likelihood of a pitch has one maximum for each pitch that the travel can resolve. The width of
the maxima decreases with the length of the travel, so that a search from a distant start does not
converge to the highest one. The starting values are therefore the highest lines of the spatial
spectrum of the force. Before this, the dependence of the force on speed, acceleration and, once per
turn, angle is removed, independently of the law.

The maximum over all pitches increases the gain by chance. In noise, the highest line of all
resolvable pitches has a gain of `2 log(pitches)` in twice the log likelihood. There are fewer
pitches than samples, and the threshold contains a penalty of `3 log(samples)` for amplitude, phase
and pitch.

The motion is that of the campaign as it was prepared. A motion that was estimated again with a
model without the periodic force may be so rough that it explains this force.
"""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np

from jbf.arrays import Array, Mask
from jbf.estimation.campaign import Campaign
from jbf.estimation.prepared import Prepared
from jbf.records.rig import Rig

LINES = 3
"""Number of highest spectral lines that are tried, each after removal of the higher ones."""
BINS_A_PITCH = 4.0
"""Number of position bins in the shortest pitch that is searched."""
MOST_BINS = 2**15
"""Largest number of position bins."""
PADDING = 8
"""Spectral lines per resolution width."""
KNOTS = 8
"""Number of knots in each direction of a piecewise linear friction-speed curve."""

Knots = list[tuple[float, Array]]

_pitches_of: WeakKeyDictionary[Campaign, dict[bool, tuple[float, ...]]] = WeakKeyDictionary()
_regressions: WeakKeyDictionary[Campaign, _Regression] = WeakKeyDictionary()


def pitches(campaign: Campaign, *, along: bool) -> tuple[float, ...]:
    """Most likely pitches of a campaign, m, the most likely first; empty for a short travel.

    With `along`, the force in the direction of motion is used instead of the force itself.
    """
    campaign = campaign.first or campaign
    by_direction = _pitches_of.setdefault(campaign, {})
    if along not in by_direction:
        by_direction[along] = _pitches(campaign, along)
    return by_direction[along]


def longest_pitch(campaign: Campaign) -> float:
    """Longest pitch, m, with the required number of periods within the travel of the runs.

    The pitch is infinite for runs without travel.
    """
    angles = np.concatenate([p.motion.angle_rad[moving] for p, moving in campaign.moving])
    span = float(np.ptp(angles)) * campaign.arm_m if len(angles) else 0.0
    return span / campaign.settings.conditions.min_pitch_periods if span > 0.0 else np.inf


def known_pitches(rig: Rig) -> tuple[float, ...]:
    """Pitches known from a rig's [drive]: travel per turn of screw and motor, m (rad for a joint).

    The result is empty if the rig's [drive] does not determine it.
    """
    drive = rig.drive
    if drive is None:
        return ()
    turn = 2.0 * np.pi if drive.motion == "rotary" else drive.pitch_m
    if turn is None or (drive.motion == "rotary" and drive.gear_ratio == 1.0):
        return ()
    turns = (turn,) if drive.motion == "linear" else ()
    return tuple(dict.fromkeys((*turns, turn / drive.gear_ratio)))


def _pitches(campaign: Campaign, along: bool) -> tuple[float, ...]:
    """Pitches, m, of the highest lines in the spatial spectrum of the remaining force."""
    regression = _regression(campaign)
    place, rest, speed = regression.place, regression.remaining, regression.speed
    if len(place) < PADDING * KNOTS:
        return ()
    span = float(np.ptp(place))
    fine = max(_sample_spacing(campaign), span / MOST_BINS)
    count, least = int(span / fine), campaign.settings.conditions.min_pitch_periods
    if count < least * BINS_A_PITCH:
        return ()
    bins = np.minimum((place - place.min()) / fine, count - 1).astype(np.intp)
    signal = rest * np.sign(speed) if along else rest
    signal = signal - np.mean(signal)
    length = PADDING * count
    # Number of periods within the travel for each line of the padded spectrum.
    periods = np.arange(length // 2 + 1) / PADDING * (span / (count * fine))
    resolved = (periods >= least) & (periods * BINS_A_PITCH <= count)
    highest: list[float] = []
    for _ in range(LINES):
        power = np.abs(np.fft.rfft(np.bincount(bins, signal, count), length)) ** 2
        power[~resolved] = 0.0
        k = int(np.argmax(power))
        if power[k] <= 0.0:
            break
        highest.append(float(span / periods[k]))
        # With unequal numbers of passes over the positions, side lobes of a high line may exceed a
        # lower line.
        signal = signal - fitted_wave(2.0 * np.pi * place / highest[-1], signal)[1]
        resolved[max(k - 2 * PADDING, 0) : k + 2 * PADDING + 1] = False
    return tuple(highest)


def fitted_wave(phase: Array, values: Array) -> tuple[float, Array]:
    """Amplitude and values of the cosine and sine of a phase (rad) with the best fit to values."""
    pair = np.stack([np.cos(phase), np.sin(phase)], axis=1)
    solution, *_ = np.linalg.lstsq(pair, values, rcond=None)
    return float(np.hypot(*solution)), np.asarray(pair @ solution)


def mass(campaign: Campaign) -> float | None:
    """Mass that the dependence of the force on the acceleration suggests, kg.

    None if the runs contain too few samples, or if the dependence has the wrong sign.
    """
    found = _regression(campaign.first or campaign).mass_kg
    return found if found > 0.0 else None


@dataclass(frozen=True)
class _Regression:
    """Regression of the force of a campaign on speed, acceleration and angle.

    Attributes
    ----------
    place, remaining, speed
        Position, m, force that the regression does not explain, N, and speed, m/s, of the moving
        samples.
    mass_kg
        Coefficient of the acceleration.
    """

    place: Array
    remaining: Array
    speed: Array
    mass_kg: float = 0.0


def _regression(campaign: Campaign) -> _Regression:
    """Return the regression of the force of a campaign, computed once."""
    if campaign not in _regressions:
        _regressions[campaign] = _regress(campaign)
    return _regressions[campaign]


def _regress(campaign: Campaign) -> _Regression:
    """Compute the regression by least squares, run by run in triangular form."""
    pairs = campaign.moving
    place = np.concatenate([p.motion.angle_rad[m] for p, m in pairs]) * campaign.arm_m
    speed = np.concatenate([p.motion.velocity[m] for p, m in pairs])
    if len(speed) < PADDING * KNOTS:
        return _Regression(place, np.concatenate([p.friction[m] for p, m in pairs]), speed)
    knots = _knots(speed)
    # Each run has its own load and temperature, so the means in each direction are removed for each
    # run (Frisch & Waugh 1933). A triangular factor replaces the rows of each run.
    factors, scales = [], []
    for p, m in pairs:
        regressors = _regressors(p, m, knots)
        scales.append(np.sum(regressors**2, axis=0))
        rows = _centred_by_direction(
            np.column_stack([regressors, p.friction[m]]), p.motion.velocity[m]
        )
        factors.append(np.linalg.qr(rows, mode="r"))
    scale = np.maximum(np.sqrt(np.sum(scales, axis=0) / len(speed)), 1e-300)
    factor = np.concatenate(factors)
    solution, *_ = np.linalg.lstsq(factor[:, :-1] / scale, factor[:, -1], rcond=1e-9)
    rest = []
    for p, m in pairs:
        regressors = _regressors(p, m, knots)
        remaining = p.friction[m] - (regressors / scale) @ solution
        rest.append(_centred_by_direction(remaining[:, None], p.motion.velocity[m])[:, 0])
    return _Regression(place, np.concatenate(rest), speed, float(solution[0] / scale[0]))


def _regressors(p: Prepared, moving: Mask, knots: Knots) -> Array:
    """Regressors of the force of a run on speed, acceleration and angle, shape (n, k)."""
    angle, motion = p.motion.angle_rad[moving], p.motion
    hats = _hat_functions(motion.velocity[moving], knots)
    return np.stack([motion.acceleration[moving], np.cos(angle), np.sin(angle), *hats], axis=1)


def _centred_by_direction(rows: Array, speed: Array) -> Array:
    """Rows minus their means in each direction of motion."""
    centred: Array = rows.copy()
    for one_way in (speed > 0.0, speed < 0.0):
        if one_way.any():
            centred[one_way] -= np.mean(rows[one_way], axis=0)
    return centred


def _knots(speed: Array) -> Knots:
    """Knots of a piecewise linear function of speed, for each direction of motion."""
    by_direction = []
    for sign in (-1.0, 1.0):
        one_way = speed * sign > 0.0
        if one_way.any():
            knots = np.unique(np.quantile(speed[one_way], np.linspace(0.0, 1.0, KNOTS)))
            by_direction.append((sign, knots))
    return by_direction


def _hat_functions(speed: Array, knots: Knots) -> list[Array]:
    """Piecewise linear basis functions of speed, for each direction."""
    functions = []
    for sign, positions in knots:
        one_way = speed * sign > 0.0
        for hat in np.eye(len(positions)):
            functions.append(np.where(one_way, np.interp(speed, positions, hat), 0.0))
    return functions


def _sample_spacing(campaign: Campaign) -> float:
    """Typical distance between the positions of successive samples, m."""
    steps = [np.abs(np.diff(p.motion.angle_rad))[m[1:] & m[:-1]] for p, m in campaign.moving]
    return float(np.median(np.concatenate(steps))) * campaign.arm_m
