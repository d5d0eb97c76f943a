"""Axes along which a residual is examined: each function assigns the samples to bins.

An axis shows where the model fails. It sorts samples into few bins; the model fails along an axis
if the mean residual differs between its bins.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from jbf.arrays import Array
from jbf.comparison.bins import Axis, Bin, Binned, Places
from jbf.estimation.campaign import Campaign
from jbf.estimation.prepared import Prepared

ANGLE_BINS = 24
TIME_BINS = 12
SPEED_BINS = 12
FORCE_BINS = 16
BOUNDARY_SHARE = 0.2
"""Fraction of the transition speed U_tr below which asperities carry most of the load."""


def _both_directions(bins: Sequence[Bin], *, with_rest: bool = False) -> tuple[Bin, ...]:
    """Bins for backward motion, followed by equal bins for forward motion."""
    backward = [replace(b, direction=-1, with_rest=with_rest) for b in bins]
    return (*backward, *(replace(b, direction=1) for b in bins))


def _signs(v: Array) -> Places:
    """Direction of motion of each sample: 1 forward, 0 backward, -1 at rest."""
    return np.where(v > 0, 1, np.where(v < 0, 0, -1)).astype(np.intp)


def _direction(campaign: Campaign, u_tr: float | None) -> Binned:
    """Bin samples by the direction of motion."""
    places = [_signs(p.motion.velocity) for p in campaign.prepared]
    return Binned("direction", _both_directions([Bin()]), places)


def _velocity(campaign: Campaign, u_tr: float | None) -> Binned:
    """Bin samples by signed speed."""
    speeds = np.concatenate([np.abs(p.motion.velocity) for p in campaign.prepared])
    moving = speeds[speeds > 0.0]
    edges = np.quantile(moving, np.linspace(0, 1, SPEED_BINS + 1)[1:-1])
    # At constant speed the quantiles are equal except for rounding; empty bins are removed.
    edges = edges[np.diff(edges, prepend=np.min(moving)) > 1e-9 * np.max(moving)]
    edges = edges[np.unique(np.digitize(moving, edges))[1:] - 1]
    count = len(edges) + 1
    middle = [float(np.median(moving[np.digitize(moving, edges) == i])) for i in range(count)]
    unit = campaign.rig.quantities.speed
    bins = [Bin(centre=-m, unit=unit, direction=-1) for m in middle]
    bins += [Bin(centre=m, unit=unit, direction=1) for m in middle]
    places = []
    for p in campaign.prepared:
        v = p.motion.velocity
        size = np.digitize(np.abs(v), edges)
        places.append(np.where(v > 0, size + count, np.where(v < 0, size, -1)).astype(np.intp))
    return Binned("velocity", tuple(bins), places)


def _regime(campaign: Campaign, u_tr: float | None) -> Binned:
    """Bin samples by lubrication regime (law with a film), otherwise by thirds of the speeds."""
    speeds = [np.abs(p.motion.velocity) for p in campaign.prepared]
    axis: Axis = "regime"
    if u_tr is not None:
        names: tuple[str, ...] = ("boundary", "mixed", "full film")
        edges = np.array([BOUNDARY_SHARE, 1.0]) * u_tr
    else:
        axis, unit = "speed range", campaign.rig.quantities.speed
        all_speeds = np.concatenate(speeds)
        edges = np.quantile(all_speeds[all_speeds > 0.0], [1 / 3, 2 / 3])
        names = (
            f"slow (to {edges[0]:.2g} {unit})",
            "medium",
            f"fast (over {edges[1]:.2g} {unit})",
        )
    places = [
        np.where(p.motion.resting, 0, 1 + np.digitize(speed, edges)).astype(np.intp)
        for p, speed in zip(campaign.prepared, speeds, strict=True)
    ]
    return Binned(axis, tuple(Bin(name) for name in ("at rest", *names)), places)


def _acceleration(campaign: Campaign, u_tr: float | None) -> Binned:
    """Bin samples by the acceleration along the motion."""
    places = []
    for p in campaign.prepared:
        v, a = p.motion.velocity, p.motion.acceleration
        steady = np.abs(a) < 0.02 * float(np.max(np.abs(a), initial=0.0))
        kind = np.where(a * v > 0, 1, 0) + np.where(v > 0, 2, 0)
        places.append(np.where(steady | (v == 0.0), -1, kind).astype(np.intp))
    return Binned("acceleration", _both_directions([Bin("slowing"), Bin("speeding up")]), places)


def _angle(campaign: Campaign, u_tr: float | None) -> Binned:
    """Bin samples by the angle of the shaft."""
    width = 2.0 * np.pi / ANGLE_BINS
    middles = [float(np.degrees((i + 0.5) * width)) for i in range(ANGLE_BINS)]
    places = []
    for p in campaign.prepared:
        turned = np.mod(p.motion.angle_rad, 2.0 * np.pi)
        kind = np.minimum((turned / width).astype(np.intp), ANGLE_BINS - 1)
        # Angle-dependent friction changes sign with the motion, other angle-dependent forces do
        # not: bins per direction distinguish both.
        signed = np.where(p.motion.velocity < 0, kind, kind + ANGLE_BINS)
        places.append(np.where(p.motion.resting, -1, signed).astype(np.intp))
    return Binned("angle", _both_directions([Bin(centre=m, unit="deg") for m in middles]), places)


def _time(campaign: Campaign, u_tr: float | None) -> Binned:
    """Bin samples by the time in the run."""
    longest = max(p.run.duration_s for p in campaign.prepared)
    edges = longest * np.linspace(0, 1, TIME_BINS + 1)
    spans = [Bin(span=pair, unit="s") for pair in pairwise(edges.tolist())]
    places = []
    for p in campaign.prepared:
        kind = np.digitize(p.run.time_s - p.run.time_s[0], edges[1:-1])
        places.append(np.where(p.motion.velocity > 0, kind + TIME_BINS, kind).astype(np.intp))
    return Binned("time", _both_directions(spans, with_rest=True), places)


def _since(campaign: Campaign, axis: Axis, measure: Callable[[Prepared], Array]) -> Binned:
    """Bin samples by the increase of a measure since the last event."""
    values = [measure(p) for p in campaign.prepared]
    positive = np.concatenate([v[np.isfinite(v) & (v > 0)] for v in values])
    unit = "s" if axis == "time since a rest" else campaign.rig.quantities.length
    if len(positive) < 100:
        return Binned(axis, (), [])
    edges = np.unique(np.quantile(positive, [0.05, 0.1, 0.2, 0.4, 0.7]))
    ends = [-np.inf, *edges.tolist(), np.inf]
    spans = [Bin(span=pair, unit=unit) for pair in pairwise(ends)]
    places = []
    for p, v in zip(campaign.prepared, values, strict=True):
        ok = np.isfinite(v) & (v > 0)
        kind = np.digitize(v, edges)
        kind = np.where(p.motion.velocity > 0, kind + len(spans), kind)
        places.append(np.where(ok & ~p.motion.resting, kind, -1).astype(np.intp))
    return Binned(axis, _both_directions(spans), places)


def _after_events(p: Prepared, event: npt.NDArray[np.bool_], measure: Array) -> Array:
    """Increase of `measure` since the last event at each sample; NaN before the first event."""
    index = np.where(event, np.arange(len(event)), -1)
    last = np.maximum.accumulate(index)
    since = measure - measure[np.maximum(last, 0)]
    return np.where(last >= 0, since, np.nan)


def _time_since_rest(p: Prepared) -> Array:
    """Time since the last rest, s; NaN before the first rest."""
    return _after_events(p, p.motion.resting, p.run.time_s)


def _distance_since_reversal(p: Prepared) -> Array:
    """Distance since the last reversal, m; NaN before the first reversal."""
    v = p.motion.velocity
    travelled = np.concatenate(
        ([0.0], np.cumsum(0.5 * (np.abs(v[1:]) + np.abs(v[:-1])) * np.diff(p.run.time_s)))
    )
    sign = np.sign(v)
    turned = np.concatenate(([False], (sign[1:] != sign[:-1]) & (sign[1:] != 0)))
    return _after_events(p, turned, travelled)


def _run(campaign: Campaign, u_tr: float | None) -> Binned:
    """Bin samples by run."""
    bins = tuple(Bin(p.run.name) for p in campaign.prepared)
    places = [np.full(len(p.run), i, dtype=np.intp) for i, p in enumerate(campaign.prepared)]
    return Binned("run", bins, places)


def force_axis(forces: Sequence[Array], error: float = 0.0, unit: str = "N") -> Binned:
    """Bin samples by a force, which reveals a nonlinear load cell.

    Parameters
    ----------
    forces
        Force of each sample, one array per run.
    error
        Standard error of these forces. Edges are removed until few samples are close to each edge.
        At most half as many samples as in the smaller neighbouring bin may lie within two standard
        errors of an edge. Otherwise the assignment to bins would be correlated with the sign of the
        error.
    """
    every = np.concatenate(list(forces))
    edges = np.unique(np.quantile(every, np.linspace(0, 1, FORCE_BINS + 1)[1:-1]))
    if error > 0.0:
        edges = _distinct(np.sort(every), edges, 2.0 * error)
    count = len(edges) + 1
    places = [np.digitize(f, edges).astype(np.intp) for f in forces]
    sorted_ = np.concatenate(places)
    bins = tuple(
        Bin(centre=float(np.median(every[sorted_ == i])), unit=unit)
        if np.any(sorted_ == i)
        else Bin("none")
        for i in range(count)
    )
    return Binned("force", bins, places, unit)


def _distinct(values: Array, edges: Array, reach: float) -> Array:
    """Remove bin edges that have too many samples within the error of the values."""
    while len(edges):
        below = np.searchsorted(values, edges)
        counts = np.diff(np.concatenate(([0], below, [len(values)])))
        smaller = np.maximum(np.minimum(counts[:-1], counts[1:]), 1)
        close_samples = np.searchsorted(values, edges + reach) - np.searchsorted(
            values, edges - reach
        )
        crowded = close_samples / smaller
        worst = int(np.argmax(crowded))
        if crowded[worst] <= 0.5:
            break
        edges = np.delete(edges, worst)
    return edges


def all_axes(campaign: Campaign, u_tr: float | None) -> list[Binned]:
    """Assign the samples of a campaign to bins along every axis that its records permit.

    Parameters
    ----------
    u_tr
        Transition speed of the model, m/s, which separates the regimes; None for a law without a
        film.
    """
    unit = campaign.rig.quantities.force
    of_states = [make(campaign, u_tr) for make in (_direction, _velocity, _regime, _run)]
    if campaign.steady:
        return [replace(a, force_unit=unit) for a in of_states if a.bins]
    axes = [*of_states[:-1], _acceleration(campaign, u_tr), _time(campaign, u_tr), of_states[-1]]
    if campaign.has_angle:
        axes.append(_angle(campaign, u_tr))
    axes.append(_since(campaign, "time since a rest", _time_since_rest))
    axes.append(_since(campaign, "distance since a reversal", _distance_since_reversal))
    return [replace(a, force_unit=unit) for a in axes if a.bins]
