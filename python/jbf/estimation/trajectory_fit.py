"""Fit of the base law along exactly known motions, with exact derivatives.

The motions are known exactly (a sine of the drive) and not only as recorded samples. The step size
of the solver follows from the tolerance and not from the sampling. For records with effects, noise
on the speed and unknown signs, use :func:`jbf.fit`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import optimize

from jbf.arrays import Array
from jbf.errors import InputError
from jbf.estimation.estimates import Estimates
from jbf.estimation.identifiability import reason_not_identifiable
from jbf.models.catalogue import Parameter, find_parameter, parameters_of
from jbf.models.parameter_value import ParameterValue
from jbf.models.trajectory import Motion, is_record, motions_of, trajectories
from jbf.models.vocabulary import Clock
from jbf.records.arguments import by_name, described, numbers
from jbf.records.rig import Rig
from jbf.records.toml_file import number
from jbf.threads import one_blas_thread

REST_SHARE = 1e-9
"""Fraction of the top speed below which a sample is at rest, where friction is set-valued."""


@dataclass(frozen=True, repr=False)
class TrajectoryFit(Estimates):
    """Parameters of the base law, fitted along exactly known motions.

    Attributes
    ----------
    parameters
        Name to value with standard error, for independent residuals of equal variance.
    sum_of_squares
        Sum of squares of the residual friction coefficients.
    nobs
        Number of fitted samples.
    evaluations
        Number of simulations of all runs, each with its derivatives.
    converged, message
        Convergence flag and message of the search.

    Examples
    --------
    >>> import numpy as np
    >>> rig = jbf.Rig.thesis()
    >>> law = {"f_m": 0.25, "U_tr_m_s": 0.055, "K0": 6.5e5, "gamma": 33.0}
    >>> t = np.linspace(0.0, 2.0, 201)
    >>> runs = [(t, (0.05, 6.0, 0.04))]
    >>> measured = [jbf.trajectories(rig, law, runs)[0].friction_coefficient]
    >>> fit = jbf.fit_trajectories(rig, runs, measured, start={"f_m": 0.3})
    >>> fit.converged, fit.nobs
    (True, 201)
    """

    parameters: dict[str, ParameterValue]
    sum_of_squares: float
    nobs: int
    evaluations: int
    converged: bool
    message: str

    def _facts(self) -> Mapping[str, Any]:
        """Entries that a result adds to `to_dict`, in addition to its parameters."""
        return {
            "sum_of_squares": self.sum_of_squares,
            "samples": self.nobs,
            "evaluations": self.evaluations,
            "converged": self.converged,
            "message": self.message,
        }


@one_blas_thread
def fit_trajectories(
    rig: Rig,
    runs: Sequence[Motion],
    friction_coefficient: Sequence[npt.ArrayLike],
    *,
    start: Mapping[str, float] | None = None,
    model: str = "journal",
    clock: Clock = "journal",
    tolerance: float = 1e-6,
    eps: float | None = None,
    phi_rad: float | None = None,
) -> TrajectoryFit:
    """Fit ``f_m``, ``U_tr_m_s``, ``K0`` and ``gamma`` to friction along known motions.

    Parameters
    ----------
    rig
        Bearing, lubricant and load.
    runs, model, clock, tolerance, eps, phi_rad
        As in :func:`jbf.trajectories`.
    friction_coefficient
        Measured friction over load, one array of shape (n,) a run; NaN where nothing was measured.
        Samples at rest are excluded: friction is set-valued there.
    start
        Starting values; those of the catalogue by default.

    Returns
    -------
    TrajectoryFit
        The estimates with their standard errors.

    Raises
    ------
    InputError
        As :func:`jbf.trajectories`; also if the friction of a run differs in shape from its times,
        or has too few samples.

    Notes
    -----
    The sum of squared differences between simulated and measured coefficients is minimised in the
    logarithms of the parameters, with derivatives that are exact for the steps taken. The standard
    errors are those of linear least squares at the minimum.

    Examples
    --------
    >>> import numpy as np
    >>> rig = jbf.Rig.thesis()
    >>> law = {"f_m": 0.25, "U_tr_m_s": 0.055, "K0": 6.5e5, "gamma": 33.0}
    >>> t = np.linspace(0.0, 2.0, 201)
    >>> runs = [(t, (0.05, 6.0, 0.04))]
    >>> measured = [jbf.trajectories(rig, law, runs)[0].friction_coefficient]
    >>> fit = jbf.fit_trajectories(rig, runs, measured, start={"f_m": 0.3})
    >>> round(fit.params["f_m"], 4)
    0.25
    """
    pages = parameters_of("journal", ())
    given = {
        find_parameter(name, pages): number(value, f"start.{name}")
        for name, value in by_name(start or {}, "start").items()
    }
    first = np.array([given.get(name, page.starts[0]) for name, page in pages.items()])
    low = np.log([page.lower for page in pages.values()])
    high = np.log([page.upper for page in pages.values()])
    runs = motions_of(runs)
    if isinstance(friction_coefficient, str) or not isinstance(friction_coefficient, Iterable):
        description = described(friction_coefficient)
        raise InputError(
            problem=f"the friction is {description}", remedy="give a list, one array per run"
        )
    measured = [numbers(f, f"the friction of run {i}") for i, f in enumerate(friction_coefficient)]
    keep = _usable(runs, measured)
    data = np.concatenate(measured)[keep]
    if len(data) <= len(first):
        raise InputError(
            problem=f"{len(data)} usable samples are too few for {len(first)} parameters",
            remedy="give more samples with motion",
        )
    evaluations = 0
    last: tuple[bytes, Array, Array] | None = None

    def evaluate(x: Array) -> tuple[Array, Array]:
        """Residuals and their Jacobian in the logarithms of the parameters."""
        nonlocal evaluations, last
        if last is None or last[0] != x.tobytes():
            evaluations += 1
            values = np.exp(np.clip(x, low, high))
            done = trajectories(
                rig,
                dict(zip(pages, values.tolist(), strict=True)),
                runs,
                model=model,
                clock=clock,
                tolerance=tolerance,
                eps=eps,
                phi_rad=phi_rad,
                derivatives=True,
            )
            f = np.concatenate([d.friction_coefficient for d in done])[keep]
            by = np.concatenate([d.derivatives for d in done if d.derivatives is not None])
            last = (x.tobytes(), f - data, by[keep] * values)
        return last[1], last[2]

    def residuals(x: Array) -> Array:
        """Residuals at the logarithms `x` of the parameters."""
        return evaluate(x)[0]

    def slopes(x: Array) -> Array:
        """Jacobian of the residuals at the logarithms `x` of the parameters."""
        return evaluate(x)[1]

    optimum = optimize.least_squares(
        residuals,
        np.clip(np.log(first), low, high),
        jac=slopes,
        method="lm",
        xtol=1e-8,
        ftol=1e-8,
        gtol=1e-8,
        max_nfev=200,
    )
    values = np.exp(np.clip(optimum.x, low, high))
    errors = _errors(optimum, values)
    sensitive = np.linalg.norm(np.asarray(optimum.jac), axis=0) > 0.0
    parameters = {
        name: _parameter(page, float(v), float(e), sensitive=bool(s))
        for (name, page), v, e, s in zip(pages.items(), values, errors, sensitive, strict=True)
    }
    return TrajectoryFit(
        parameters=parameters,
        sum_of_squares=2.0 * float(optimum.cost),
        nobs=len(data),
        evaluations=evaluations,
        converged=bool(optimum.status > 0),
        message=str(optimum.message),
    )


def _parameter(page: Parameter, value: float, error: float, *, sensitive: bool) -> ParameterValue:
    """Fitted parameter with its standard error; held, with a reason, if not identifiable."""
    note = reason_not_identifiable(
        page, value, error, sensitive=sensitive, separate=bool(np.isfinite(error))
    )
    return ParameterValue(value, None if note else error, note, note is not None)


def _errors(optimum: optimize.OptimizeResult, values: Array) -> Array:
    """Standard errors of the parameters; NaN if they are not separately identifiable."""
    jacobian = np.asarray(optimum.jac)
    size = np.linalg.norm(jacobian, axis=0)
    size[size == 0.0] = np.nan
    unit = jacobian / size
    if not np.isfinite(unit).all() or np.linalg.cond(unit) > 1e6:
        return np.full(len(values), np.nan)
    variance = 2.0 * optimum.cost / (len(jacobian) - len(values))
    covariance = variance * np.linalg.inv(unit.T @ unit)
    return np.asarray(np.sqrt(np.diag(covariance)) / size * values)


def _usable(runs: Sequence[Motion], measured: Sequence[Array]) -> npt.NDArray[np.bool_]:
    """Mask of the samples that were measured and are in motion, all runs concatenated."""
    if len(runs) != len(measured):
        raise InputError(
            problem=f"{len(runs)} runs and {len(measured)} frictions",
            remedy="give one array of friction coefficients per run",
        )
    usable = []
    for i, ((time, motion), friction) in enumerate(zip(runs, measured, strict=True)):
        t = np.asarray(time, dtype=float)
        if friction.shape != t.shape:
            raise InputError(
                problem=f"run {i}: friction of shape {friction.shape}, times of {t.shape}",
                remedy="give one friction coefficient per time (NaN where missing)",
            )
        if is_record(motion):
            speed = np.asarray(motion, dtype=float)
        else:
            amplitude, omega, bias = (float(x) for x in np.asarray(motion))
            speed = bias + amplitude * np.sin(omega * t)
        top = float(np.max(np.abs(speed), initial=0.0))
        usable.append(np.isfinite(friction) & (np.abs(speed) > REST_SHARE * top))
    if not usable:
        raise InputError(problem="no run was given", remedy="give at least one")
    return np.concatenate(usable)
