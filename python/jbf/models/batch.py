"""Parallel evaluation of the journal law for many parameter sets (sweeps, samples, starts)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf import _core
from jbf.errors import InputError
from jbf.models.catalogue import find_clock
from jbf.models.chain import core_refusals
from jbf.models.vocabulary import Clock
from jbf.records.arguments import numbers, one_of, the_rig
from jbf.records.rig import Rig

Array = npt.NDArray[Any]
METHODS = ("euler", "rk4")


def _refuse(key: str, problem: str, remedy: str) -> InputError:
    return InputError(key=key, problem=problem, remedy=remedy)


def _column(value: npt.ArrayLike, key: str) -> npt.NDArray[np.float64]:
    try:
        column = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise _refuse(
            key, "is not a number or an array of numbers", "give one number, or one per set"
        ) from None
    if column.ndim > 1:
        raise _refuse(key, f"has {column.ndim} dimensions", "give one number, or one per set")
    return column


def _sets(columns: dict[str, npt.ArrayLike]) -> npt.NDArray[np.float64]:
    """Parameter sets as an array with one row per set; scalars are broadcast."""
    arrays = {key: _column(value, key) for key, value in columns.items()}
    count = max((a.size for a in arrays.values() if a.ndim), default=1)
    for key, a in arrays.items():
        if a.ndim and a.size != count:
            raise _refuse(key, f"has {a.size} values where another has {count}", "give one per set")
    table = np.empty((count, len(arrays)))
    for i, a in enumerate(arrays.values()):
        table[:, i] = a
    return table


def _result(out: Array | None, shape: tuple[int, int], dtype: np.dtype[Any]) -> Array:
    if out is None:
        return np.empty(shape, dtype)
    if not isinstance(out, np.ndarray):
        raise _refuse("out", "is not an array", f"make it np.empty({shape}, np.{dtype})")
    if out.shape != shape or out.dtype != dtype or not out.flags.c_contiguous:
        raise _refuse("out", "does not fit", f"make it np.empty({shape}, np.{dtype})")
    return out


def batch(
    rig: Rig,
    velocity: npt.ArrayLike,
    dt_s: float,
    *,
    f_m: npt.ArrayLike,
    U_tr_m_s: npt.ArrayLike,
    K0: npt.ArrayLike,
    gamma: npt.ArrayLike,
    load_n: npt.ArrayLike | None = None,
    clock: Clock = "journal",
    method: str = "euler",
    data: npt.ArrayLike | None = None,
    dtype: npt.DTypeLike = np.float64,
    out: Array | None = None,
) -> Array:
    """Compute the friction coefficients of many parameter sets, or their sums of squared errors.

    Sets are evaluated in parallel on all cores, with the best SIMD instruction set of the machine.
    The results are bitwise identical for all instruction sets. Films start at the transition
    eccentricity.

    Parameters
    ----------
    rig : Rig
        Bearing, lubricant and load.
    velocity : array, shape (n,) or (n, sets)
        Surface speed, m/s, at samples with spacing `dt_s`: one motion for all sets, or one per set.
    dt_s : float
        Step, s; there are no substeps.
    f_m, U_tr_m_s, K0, gamma, load_n : float or array of shape (sets,)
        Parameters of the law, and load on one bearing, N (by default that of the rig).
    clock : str
        Definition of the time constant of the film: ``"journal"`` (tbar = t U_tr/R) or ``"thesis"``
        (tbar = t/1 s).
    method : str
        ``"euler"`` or ``"rk4"``.
    data : array, shape (n,), optional
        Measured friction coefficients: the result is then the sum of squares of each set.
    dtype : dtype
        ``np.float64`` or ``np.float32``: the precision of steps and result.
    out : array, optional
        Array in which to store the coefficients, which avoids an allocation.

    Returns
    -------
    array, shape (n, sets), or (sets,) if `data` is given

    Raises
    ------
    InputError
        An array has the wrong shape, or a parameter is out of its range.

    Examples
    --------
    >>> import numpy as np
    >>> speed = 0.1 * np.sin(np.arange(0.0, 2.0, 0.001))
    >>> sets = np.array([0.2, 0.3])
    >>> one = {"U_tr_m_s": 0.055, "K0": 6.5e5, "gamma": 33.0}
    >>> jbf.batch(jbf.Rig.thesis(), speed, 1e-3, f_m=sets, **one).shape
    (2000, 2)
    """
    the_rig(rig)
    find_clock(clock)
    one_of(method, METHODS, "method")
    try:
        precision = np.dtype(dtype)
    except TypeError:
        raise _refuse("dtype", "is not a dtype", "choose np.float64 or np.float32") from None
    if precision not in (np.dtype(np.float64), np.dtype(np.float32)):
        raise _refuse("dtype", f"is {precision}", "choose np.float64 or np.float32")
    if not (isinstance(dt_s, int | float) and 0.0 < dt_s < math.inf):
        raise _refuse("dt_s", f"{dt_s!r} is not positive and finite", "give seconds")
    if rig.bearing is None or rig.lubricant is None:
        raise InputError(
            problem="the rig has no [bearing] or no [lubricant]",
            remedy="the law journal requires both: add them",
        )
    if load_n is None and rig.load is None:
        raise InputError(problem="the rig has no [load]", remedy="add [load], or give load_n")
    load = rig.load.normal_n if load_n is None and rig.load is not None else load_n
    assert load is not None
    sets = _sets({"f_m": f_m, "U_tr_m_s": U_tr_m_s, "K0": K0, "gamma": gamma, "load_n": load})
    speeds = numbers(velocity, "velocity_m_s", precision)
    each = speeds.ndim == 2
    if speeds.ndim not in (1, 2) or (each and speeds.shape[1] != len(sets)):
        raise _refuse(
            "velocity_m_s",
            f"has shape {speeds.shape}",
            f"give (samples,) or (samples, {len(sets)})",
        )
    if not np.isfinite(speeds).all():
        raise _refuse(
            "velocity_m_s", "contains values that are not finite", "fill or remove the gaps"
        )
    b = rig.bearing
    with core_refusals():
        core = _core.BatchRig(
            radius_m=b.radius_m,
            length_m=b.length_m,
            clearance_m=b.clearance_m,
            mass_kg=b.mass_kg,
            count=b.count,
            viscosity_pa_s=rig.lubricant.viscosity_pa_s,
            clock=clock,
            method=method,
        )
        single = precision == np.dtype(np.float32)
        if data is not None:
            recorded = numbers(data, "data", precision)
            if recorded.shape != speeds.shape[:1]:
                raise _refuse(
                    "data", f"has shape {recorded.shape}", "give one coefficient per sample"
                )
            squares = core.squares_f32 if single else core.squares_f64
            return squares(sets, speeds.reshape(-1), each, dt_s, recorded)
        result = _result(out, (len(speeds), len(sets)), precision)
        friction = core.friction_f32 if single else core.friction_f64
        friction(sets, speeds.reshape(-1), each, dt_s, result.reshape(-1))
    return result
