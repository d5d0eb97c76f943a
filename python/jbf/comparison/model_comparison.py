"""Comparison of several models on the same runs, with standard errors of their differences."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from jbf.arrays import Array
from jbf.comparison.comparison import Comparison
from jbf.errors import InputError
from jbf.estimation.held_out_comparison import independent_units
from jbf.estimation.settings import DEFAULT
from jbf.results import Result

Unit = Literal["run", "stroke"]


@dataclass(frozen=True)
class ModelError:
    """Error of one model in a comparison of several.

    Attributes
    ----------
    name
        Name of the model.
    rms
        Root mean square of record minus prediction over the common samples, in the unit of the
        record.
    difference
        `rms` minus that of the best model.
    stderr
        Standard error of the difference; nan for the best model, and if there is only one unit.
    """

    name: str
    rms: float
    difference: float
    stderr: float

    def to_dict(self) -> dict[str, Any]:
        """Return the errors as a JSON-serialisable dict."""
        stderr = self.stderr if np.isfinite(self.stderr) else None
        return {
            "model": self.name,
            "rms": self.rms,
            "difference": self.difference,
            "stderr": stderr,
        }


@dataclass(frozen=True, repr=False)
class ModelComparison(Result):
    """Comparison of several models with the same runs.

    Attributes
    ----------
    models
        Errors of the models, the smallest first.
    comparisons
        Comparison of each model with the runs, by name, in the same order.
    nobs
        Number of samples that are included for all models.
    unit, units
        Kind of the independent units ("run" or "stroke") and their number.

    Notes
    -----
    The errors of two models in the same run are correlated, so that the standard error of their
    difference is generally smaller than that of either error. With the sums of squares S_iu of
    model i in the units u, the difference ``sqrt(sum(S_iu)/n) - sqrt(sum(S_bu)/n)`` is computed
    again without each of the m units. Its standard error is ``sqrt((m - 1)/m sum((d_u -
    mean(d))^2))`` (delete-one jackknife; Efron & Tibshirani, An Introduction to the Bootstrap,
    1993, ch. 11). The units are the runs, or their strokes if there are fewer than six runs. The
    error of a model that was fitted to these runs is biased downwards: use runs that were not used
    in any fit.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 20.0, 0.02)
    >>> v = 0.1 * np.sin(2.0 * t)
    >>> noise = 0.2 * np.random.default_rng(0).standard_normal(len(t))
    >>> run = jbf.Run.from_arrays(t, v, 5.0 * np.sign(v) + 20.0 * v + noise)
    >>> models = {
    ...     name: jbf.Model(jbf.Rig(), "coulomb", parameters={"F_c": force, "F_v": 20.0})
    ...     for name, force in (("right", 5.0), ("wrong", 5.3))
    ... }
    >>> compared = jbf.compare(models, [run])
    >>> best, other = compared.models
    >>> (best.name, other.name, compared.unit)
    ('right', 'wrong', 'stroke')
    >>> other.difference > 3.0 * other.stderr
    True
    """

    models: tuple[ModelError, ...]
    comparisons: dict[str, Comparison]
    nobs: int
    unit: Unit
    units: int

    @property
    def force_unit(self) -> str:
        """Unit of the errors: N, or N m for a rotary drive."""
        return next(iter(self.comparisons.values())).model.rig.quantities.force

    def to_dict(self) -> dict[str, Any]:
        """Return the comparison as a JSON-serialisable dict."""
        return {
            **next(iter(self.comparisons.values())).model.units_for_json(),
            "models": [m.to_dict() for m in self.models],
            "samples": self.nobs,
            "unit": self.unit,
            "units": self.units,
        }


def compare_models(comparisons: Mapping[str, Comparison]) -> ModelComparison:
    """Compare models on the samples that all of them include; see `jbf.compare`.

    Raises
    ------
    InputError
        No sample is included for all models.
    """
    several = list(comparisons.values())
    by_run = zip(*(c.samples.counted for c in several), strict=True)
    masks = [np.logical_and.reduce(mask) for mask in by_run]
    counted = dict(enumerate(masks))
    nobs = int(sum(np.count_nonzero(mask) for mask in masks))
    if not nobs:
        raise InputError(
            problem="no sample is common to all of these models", remedy="compare fewer models"
        )
    prepared = several[0].campaign.prepared
    units = independent_units(counted, prepared)
    sizes = np.array([np.count_nonzero(in_unit) for _, in_unit in units])
    squares = {
        name: np.array([np.sum(c.residuals[i][counted[i]][in_unit] ** 2) for i, in_unit in units])
        for name, c in comparisons.items()
    }
    rms = {
        name: float(
            np.sqrt(sum(np.sum(r[m] ** 2) for r, m in zip(c.residuals, masks, strict=True)) / nobs)
        )
        for name, c in comparisons.items()
    }
    order = sorted(rms, key=lambda name: rms[name])
    best = order[0]
    rows = tuple(
        ModelError(
            name,
            rms[name],
            rms[name] - rms[best],
            np.nan if name == best else difference_error(squares[name], squares[best], sizes),
        )
        for name in order
    )
    runs = sum(bool(mask.any()) for mask in masks)
    unit: Unit = "run" if runs >= DEFAULT.held_out.min_units else "stroke"
    return ModelComparison(
        rows, {name: comparisons[name] for name in order}, nobs, unit, len(units)
    )


def difference_error(a: Array, b: Array, sizes: npt.NDArray[np.int_]) -> float:
    """Jackknife standard error of the difference of two models' RMS values over common units.

    Parameters
    ----------
    a, b
        Sums of squares of the two models by unit, shape (m,).
    sizes
        Number of samples of each unit, shape (m,).
    """
    count = len(sizes)
    if count < 2:
        return float("nan")
    rest = sizes.sum() - sizes
    without = np.sqrt((a.sum() - a) / rest) - np.sqrt((b.sum() - b) / rest)
    return float(np.sqrt((count - 1) / count * np.sum((without - without.mean()) ** 2)))
