"""Comparison of models by held-out samples.

It has three parts: the log predictive density of held-out samples (`predictive_deviance`), the
independent units of paired comparisons (`independent_units`), and the runs whose prediction from
the others is an extrapolation (`extrapolated_runs`).

Notes
-----
The covariance of a predictive density is that of the noise plus that due to the uncertainty of the
parameters. Prediction errors in the directions of the derivatives with respect to uncertain
parameters therefore have little weight. The log determinant of the covariance is the penalty for
this uncertainty (Geisser & Eddy 1979; Bjornstad 1990).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf.arrays import Array, Mask
from jbf.estimation.campaign import Campaign
from jbf.estimation.held_out import HeldOutPart
from jbf.estimation.noise import Noise
from jbf.estimation.prepared import Prepared
from jbf.estimation.samples import Samples
from jbf.estimation.settings import DEFAULT, HeldOutSettings
from jbf.estimation.solution import Solution
from jbf.records.recorded_load import recorded_load

Strokes = npt.NDArray[np.intp]
Units = list[tuple[int, Mask]]
"""Index of the run of each unit, and a mask of the run's included samples in the unit."""


def mean_square(solution: Solution, samples: Samples, noise: Noise) -> tuple[float, int]:
    """Mean square of the innovations of a fit on the given samples, N^2, and their number."""
    r = samples.whitened(solution.residuals, noise)
    return float(r @ r) / max(len(r), 1), len(r)


def predictive_deviance(
    solution: Solution,
    parts: Sequence[HeldOutPart],
    samples: Samples,
    noise: Noise,
    variance: float,
) -> float:
    """Minus twice the log predictive density of all held-out parts, up to a common constant.

    The parts are held out of fits near the solution, whose derivatives are used; each sample is in
    one of them. The weights of the samples, the noise model for whitening, and the variance of the
    innovations, N^2, are common to all compared models.
    """
    moments = []
    for part in parts:
        jacobian = [solution.jacobian[i] for i in part.runs]
        e, j = samples.only(part.runs).stacked(part.residuals, jacobian, noise)
        # Select after the whitening, because the first innovation of a held-out part depends on
        # the preceding sample.
        weight = [samples.weight[i] > 0.0 for i in part.runs]
        held_out = np.concatenate([m[w] for m, w in zip(part.masks, weight, strict=True)])
        e, j = e[held_out], j[held_out]
        moments.append((part.identified, float(e @ e), j.T @ e, j.T @ j))
    total = np.sum([information for *_, information in moments], axis=0)
    sizes = np.sqrt(np.diag(total))
    sizes[sizes <= 0.0] = 1.0
    deviance = 0.0
    for identified, square, gradient, information in moments:
        size, among = sizes[identified], np.ix_(identified, identified)
        scale = np.outer(size, size)
        # A parameter that no other run identifies has a prior of a hundred times its final error.
        prior = samples.settings.held_out.min_information * np.eye(len(scale))
        after = total[among] / scale + prior
        before = after - information[among] / scale
        gradient = gradient[identified] / size
        square -= float(gradient @ np.linalg.solve(after, gradient))
        _, after_det = np.linalg.slogdet(after)
        _, before_det = np.linalg.slogdet(before)
        deviance += square / variance + float(after_det - before_det)
    return deviance


def stroke_of(p: Prepared) -> Strokes:
    """Index of the stroke of each sample; -1 if the sample is not known to be in motion.

    A stroke ends where the motion reverses.
    """
    motion = p.motion
    moving = np.flatnonzero(p.motion.slides)
    strokes = np.full(len(motion.velocity), -1, dtype=np.intp)
    if len(moving):
        sign = np.sign(motion.velocity[moving])
        strokes[moving] = np.cumsum(np.diff(sign, prepend=sign[0]) != 0.0)
    return strokes


def independent_units(
    counted: Mapping[int, Mask],
    prepared: Sequence[Prepared],
    settings: HeldOutSettings = DEFAULT.held_out,
) -> Units:
    """Divide samples into independent units: runs, or strokes if there are few runs.

    `counted` has the included samples by the index of the run, and `prepared` all runs. Without the
    latter, the runs are the units.
    """
    runs = {i: mask for i, mask in counted.items() if mask.any()}
    if len(runs) >= settings.min_units or not prepared:
        return [(i, np.ones(np.count_nonzero(mask), dtype=bool)) for i, mask in runs.items()]
    units = []
    for i, mask in runs.items():
        stroke = stroke_of(prepared[i])[mask]
        members = [stroke == k for k in range(int(np.max(stroke, initial=-1)) + 1)]
        units += [
            (i, unit) for unit in members if np.count_nonzero(unit) >= settings.min_unit_samples
        ]
    return units


@dataclass(frozen=True)
class ExtrapolatedRun:
    """A run whose speed or load is beyond the range of all others.

    The prediction of such a run from the others is an extrapolation. Its error depends more on the
    form of the law than on the fit, and is not used as a held-out error.

    Attributes
    ----------
    run
        Index of the run in the campaign.
    quantity
        `speed` or `load`.
    value, others
        Extreme value of this run, and the nearest one of the other runs, in the unit of the record.
        A speed has the sign of its direction; directions are compared separately. `others` is zero
        if no other run moves in this direction.
    """

    run: int
    quantity: str
    value: float
    others: float


def extrapolated_runs(campaign: Campaign) -> list[ExtrapolatedRun]:
    """Runs with a speed or a load beyond the range of all others; speed is tested first."""
    by_run: dict[int, ExtrapolatedRun] = {}
    runs, counted = campaign.prepared, campaign.samples.counted
    sizes = [int(np.count_nonzero(c)) for c in counted]
    velocities = [p.motion.velocity[c] for p, c in zip(runs, counted, strict=True)]
    loads = [recorded_load(p.rig, p.run) for p in runs]
    recorded = [load[c] for load, c in zip(loads, counted, strict=True) if load is not None]
    quantities = [("speed", sign, velocities) for sign in (1.0, -1.0)]
    if len(recorded) == len(runs):
        quantities.append(("load", 1.0, recorded))
    for quantity, sign, values in quantities:
        positive = [sign * v[sign * v > 0.0] for v in values]
        for run, value, others in _beyond(positive, sizes, campaign.settings.held_out):
            by_run.setdefault(run, ExtrapolatedRun(run, quantity, sign * value, sign * others))
    return [by_run[run] for run in sorted(by_run)]


def _beyond(
    values: Sequence[Array], sizes: Sequence[int], settings: HeldOutSettings
) -> Iterator[tuple[int, float, float]]:
    """Generate the runs of which a sufficient share of samples is beyond all other runs.

    `values` has positive values of each run, and `sizes` the number of all its samples. Generates
    the index of the run, its extreme value, and the nearest value of the other runs or zero.
    """
    if len(values) < 2:
        return
    factor = 1.0 + settings.extrapolation_margin
    for run, (own, size) in enumerate(zip(values, sizes, strict=True)):
        rest = np.concatenate([*values[:run], *values[run + 1 :]])
        low, high = float(rest.min(initial=np.inf)), float(rest.max(initial=0.0))
        most = settings.extrapolation_share * size
        if np.count_nonzero(own > factor * high) > most:
            yield run, float(own.max()), high
        elif np.count_nonzero(own < low / factor) > most:
            yield run, float(own.min()), low
