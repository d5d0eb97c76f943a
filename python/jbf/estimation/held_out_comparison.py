"""Comparison of models by held-out samples.

It has three parts: the log predictive density of held-out samples (`predictive_deviance`), the
independent units of paired comparisons (`independent_units`), and the runs whose prediction from
the others is an extrapolation (`extrapolated_runs`).

Notes
-----
A prediction error counts against a model to the extent that the model claims precision. The
uncertainty of the parameters makes a prediction uncertain in the directions of its derivatives, and
errors in these directions have little weight. The determinant of this covariance is the penalty
(Geisser & Eddy 1979; Bjornstad 1990).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf.estimation.campaign import Campaign
from jbf.estimation.held_out import HeldOutPart
from jbf.estimation.noise import Noise
from jbf.estimation.prepared import Prepared
from jbf.estimation.samples import Samples
from jbf.estimation.settings import DEFAULT, HeldOutSettings
from jbf.estimation.solution import Solution
from jbf.records.recorded_load import recorded_load

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Strokes = npt.NDArray[np.intp]


def mean_square(solution: Solution, samples: Samples, noise: Noise) -> tuple[float, int]:
    """Mean square of the innovations of the fit, N^2, and their number."""
    empty = [np.zeros((len(r), 0)) for r in solution.residuals]
    r, _ = samples.stacked(solution.residuals, empty, noise)
    return float(r @ r) / max(len(r), 1), len(r)


@dataclass(frozen=True)
class _Rows:
    """Sums over held-out samples that determine their predictive density.

    They are the squared errors, the products of errors and derivatives, and the products of the
    derivatives.
    """

    square: float
    pull: Array
    products: Array
    determined: Mask

    @classmethod
    def of(cls, part: HeldOutPart, solution: Solution, samples: Samples, noise: Noise) -> _Rows:
        own = [solution.jacobian[i] for i in part.runs]
        e, j = samples.only(part.runs).stacked(part.residuals, own, noise)
        # Select after the whitening: the first innovation of a half depends on the sample before
        # it.
        weight = [samples.weight[i] > 0.0 for i in part.runs]
        left = np.concatenate([m[w] for m, w in zip(part.left, weight, strict=True)])
        e, j = e[left], j[left]
        return cls(float(e @ e), j.T @ e, j.T @ j, part.determined)


def surprise(
    solution: Solution,
    parts: Sequence[HeldOutPart],
    samples: Samples,
    noise: Noise,
    variance: float,
) -> float:
    """Minus twice the log predictive density of all parts, up to a constant common to all models.

    Parameters
    ----------
    solution
        Solution whose derivatives are used.
    parts
        Held-out parts of fits near the solution; each sample is in one of them.
    samples, noise
        Weights of the samples, and the noise model for whitening, common to all compared models.
    variance
        Variance of the innovations, N^2.
    """
    rows = [_Rows.of(part, solution, samples, noise) for part in parts]
    whole = np.sum([own.products for own in rows], axis=0)
    size = np.sqrt(np.diag(whole))
    size[size <= 0.0] = 1.0
    least = samples.settings.held_out.min_information
    return sum(_of(own, whole, size, variance, least) for own in rows)


def _of(rows: _Rows, whole: Array, size: Array, variance: float, least: float) -> float:
    determined = rows.determined
    scale = np.outer(size[determined], size[determined])
    # A parameter that no other run determines has a prior of a hundred times its final error.
    known = whole[np.ix_(determined, determined)] / scale + least * np.eye(len(scale))
    before = known - rows.products[np.ix_(determined, determined)] / scale
    pull = rows.pull[determined] / size[determined]
    square = rows.square - float(pull @ np.linalg.solve(known, pull))
    _, after_det = np.linalg.slogdet(known)
    _, before_det = np.linalg.slogdet(before)
    return square / variance + float(after_det - before_det)


Units = list[tuple[int, Mask]]
"""Index of a run, and a mask of those of its counting samples that belong to the unit."""


def stroke_of(p: Prepared) -> Strokes:
    """Number of the stroke of each sample; -1 where it is not known to move.

    A stroke ends where the motion reverses.
    """
    motion = p.motion
    moving = np.flatnonzero(p.slides)
    found = np.full(len(motion.velocity), -1, dtype=np.intp)
    if len(moving):
        sign = np.sign(motion.velocity[moving])
        found[moving] = np.cumsum(np.diff(sign, prepend=sign[0]) != 0.0)
    return found


def independent_units(
    counted: Mapping[int, Mask],
    prepared: Sequence[Prepared],
    settings: HeldOutSettings = DEFAULT.held_out,
) -> Units:
    """Divide samples into units: runs, or strokes where there are fewer runs than `min_units`.

    Parameters
    ----------
    counted
        Samples that count, by the index of the run.
    prepared
        All runs; without them, the runs are the units.
    """
    runs = {i: mask for i, mask in counted.items() if mask.any()}
    if len(runs) >= settings.min_units or not prepared:
        return [(i, np.ones(np.count_nonzero(mask), dtype=bool)) for i, mask in runs.items()]
    units = []
    for i, mask in runs.items():
        stroke = stroke_of(prepared[i])[mask]
        members = [stroke == k for k in range(int(np.max(stroke, initial=-1)) + 1)]
        units += [(i, own) for own in members if np.count_nonzero(own) >= settings.min_unit_samples]
    return units


@dataclass(frozen=True)
class Beyond:
    """A run that is beyond the range of all others.

    Attributes
    ----------
    run
        Index of the run in the campaign.
    quantity
        `speed` (with its sign, so also the only run in one direction) or `load`.
    value, others
        Extreme value of this run, and the nearest one of the other runs, in the unit of the record.
    """

    run: int
    quantity: str
    value: float
    others: float


def runs_beyond(campaign: Campaign) -> list[Beyond]:
    """Runs that are beyond the range of all others, each with the first such quantity."""
    found: dict[int, Beyond] = {}
    for quantity, values in _quantities(campaign).items():
        for beyond in _beyond(quantity, values, campaign.settings.held_out):
            found.setdefault(beyond.run, beyond)
    return [found[run] for run in sorted(found)]


def _quantities(campaign: Campaign) -> dict[str, list[Array]]:
    """Speed and load at the samples that count, one array a run."""
    runs, counted = campaign.prepared, campaign.samples.counted
    speeds = [p.motion.velocity[c] for p, c in zip(runs, counted, strict=True)]
    loads = [recorded_load(p.rig, p.run) for p in runs]
    known = [load[c] for load, c in zip(loads, counted, strict=True) if load is not None]
    return {"speed": speeds} | ({"load": known} if len(known) == len(runs) else {})


def _beyond(quantity: str, values: list[Array], settings: HeldOutSettings) -> list[Beyond]:
    top = max((float(np.max(np.abs(v), initial=0.0)) for v in values), default=0.0)
    margin, found = settings.extrapolation_margin * top, []
    for run, own in enumerate(values):
        rest = [v for other, v in enumerate(values) if other != run and len(v)]
        if not len(own) or not rest:
            continue
        low, high = min(float(v.min()) for v in rest), max(float(v.max()) for v in rest)
        for outside, value, others in (
            (own > high + margin, float(own.max()), high),
            (own < low - margin, float(own.min()), low),
        ):
            if np.mean(outside) > settings.extrapolation_share:
                found.append(Beyond(run, quantity, value, others))
    return found
