"""Trajectories of the journal law, with or without the journal mass, to a given tolerance.

For the prediction of a complete rig with its effects use :class:`jbf.Model`. This module is for the
analysis of the law alone, with a specified error.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf import _core
from jbf.arrays import Array
from jbf.errors import InputError, did_you_mean, quoted
from jbf.models.catalogue import find_clock
from jbf.models.chain import core_refusals
from jbf.models.vocabulary import Clock
from jbf.records.arguments import by_name, described, numbers, the_rig
from jbf.records.rig import Rig
from jbf.records.toml_file import number

Motion = tuple[npt.ArrayLike, npt.ArrayLike | tuple[float, float, float]]

_NAMES = {"f_m": "f_m", "U_tr_m_s": "u_tr_m_s", "K0": "k0", "gamma": "gamma"}


@dataclass(frozen=True)
class Trajectory:
    """State of the film and friction coefficient along one motion.

    Attributes
    ----------
    time_s : array, shape (n,)
        Sample times, s.
    friction_coefficient : array, shape (n,)
        Friction coefficient with the sign of the speed. At rest it excludes the contribution of the
        asperities, which is set-valued.
    x, y : arrays, shape (n,)
        ``eps cos(phi)`` and ``eps sin(phi)``.
    steps : int
        Number of steps of the integrator.
    derivatives : array, shape (n, 4), or None
        Derivatives of the friction coefficient with respect to ``f_m``, ``U_tr_m_s`` (including the
        dependence of eps_tr), ``K0`` and ``gamma``, if they were requested.

    Examples
    --------
    >>> import numpy as np
    >>> rig = jbf.Rig.thesis()
    >>> law = {"f_m": 0.25, "U_tr_m_s": 0.055, "K0": 6.5e5, "gamma": 33.0}
    >>> t = np.linspace(0.0, 2.0, 201)
    >>> along = jbf.trajectory(rig, law, t, sine=(0.1, 6.0), derivatives=True)
    >>> along.derivatives.shape
    (201, 4)
    """

    time_s: Array
    friction_coefficient: Array
    x: Array
    y: Array
    steps: int
    derivatives: Array | None = None

    @property
    def eps(self) -> Array:
        """Eccentricity ratio of the journal, shape (n,)."""
        return np.hypot(self.x, self.y)

    @property
    def phi_rad(self) -> Array:
        """Attitude angle of the journal, rad, shape (n,)."""
        return np.arctan2(self.y, self.x)


def trajectory(
    rig: Rig,
    parameters: Mapping[str, float],
    time_s: npt.ArrayLike,
    velocity: npt.ArrayLike | None = None,
    *,
    sine: tuple[float, float, float] | tuple[float, float] | None = None,
    model: str = "journal",
    clock: Clock = "journal",
    tolerance: float = 1e-6,
    eps: float | None = None,
    phi_rad: float | None = None,
    derivatives: bool = False,
) -> Trajectory:
    """Integrate the journal law along one motion.

    Parameters
    ----------
    rig
        Bearing, lubricant and load.
    parameters
        ``f_m``, ``U_tr_m_s``, ``K0`` and ``gamma``.
    time_s : array, shape (n,)
        Sample times, increasing, s.
    velocity : array, shape (n,)
        Surface speed at `time_s`, m/s, interpolated linearly. The run starts at the first sample.
    sine : (amplitude in m/s, omega in rad/s[, bias in m/s])
        Sinusoidal motion instead of `velocity`: ``U = bias + amplitude sin(omega t)``. The run
        starts at time zero.
    model
        ``journal`` (reduced) or ``journal_full`` (with the mass of the journal).
    clock
        ``journal`` (tbar = t U_tr/R) or ``thesis`` (tbar = t/1 s).
    tolerance
        Error of the friction coefficient; any positive value is valid.
    eps, phi_rad
        Initial state of the film: by default eps_tr and 0.15 rad.
    derivatives
        True to compute the derivatives of the friction coefficient with respect to the parameters.
        They are the exact derivatives of the discrete solution (automatic differentiation with dual
        numbers), as required for the convergence of a fit.

    Returns
    -------
    Trajectory
        State of the film and friction coefficient at each time.

    Raises
    ------
    InputError
        The rig lacks bearing, lubricant or load, a name is unknown, or a value is out of bounds.

    Examples
    --------
    >>> import numpy as np
    >>> rig = jbf.Rig.thesis()
    >>> law = {"f_m": 0.25, "U_tr_m_s": 0.055, "K0": 6.5e5, "gamma": 33.0}
    >>> t = np.linspace(0.0, 2.0, 201)
    >>> along = jbf.trajectory(rig, law, t, sine=(0.1, 6.0))
    >>> along.friction_coefficient.shape
    (201,)
    """
    if (velocity is None) == (sine is None):
        raise InputError(
            problem="a motion is either velocity_m_s or sine", remedy="give one of the two"
        )
    motion: npt.ArrayLike | tuple[float, float, float]
    if sine is not None:
        motion = _sine(sine)
    else:
        assert velocity is not None
        motion = numbers(velocity, "velocity_m_s", flat=True)
    return trajectories(
        rig,
        parameters,
        [(time_s, motion)],
        model=model,
        clock=clock,
        tolerance=tolerance,
        eps=eps,
        phi_rad=phi_rad,
        derivatives=derivatives,
    )[0]


def trajectories(
    rig: Rig,
    parameters: Mapping[str, float],
    runs: Sequence[Motion],
    *,
    model: str = "journal",
    clock: Clock = "journal",
    tolerance: float = 1e-6,
    eps: float | None = None,
    phi_rad: float | None = None,
    derivatives: bool = False,
) -> list[Trajectory]:
    """Integrate the journal law along many motions, on all cores.

    The other arguments are those of `trajectory`.

    Parameters
    ----------
    runs
        Pairs of sample times and either speeds at them (an array), or the tuple ``(amplitude,
        omega, bias)`` of a sine. A tuple of three numbers is a sine.

    Returns
    -------
    list of Trajectory
        One per run.

    Raises
    ------
    InputError
        As in `trajectory`.

    Examples
    --------
    >>> import numpy as np
    >>> rig = jbf.Rig.thesis()
    >>> law = {"f_m": 0.25, "U_tr_m_s": 0.055, "K0": 6.5e5, "gamma": 33.0}
    >>> t = np.linspace(0.0, 2.0, 201)
    >>> runs = [(t, (0.1, omega, 0.0)) for omega in (3.0, 6.0)]
    >>> len(jbf.trajectories(rig, law, runs))
    2
    """
    the_rig(rig)
    for section in ("bearing", "lubricant", "load"):
        if getattr(rig, section) is None:
            raise InputError(problem=f"the rig has no [{section}]", remedy="add the section")
    assert rig.bearing is not None
    assert rig.lubricant is not None
    assert rig.load is not None
    given = by_name(parameters, "parameters")
    for name in given:
        if name not in _NAMES:
            raise InputError(
                problem=f"{quoted(name)} is not a parameter of the law",
                remedy=did_you_mean(name, list(_NAMES)),
            )
    for name in _NAMES:
        if name not in given:
            raise InputError(problem=f"the parameter {name} is missing", remedy="give its value")
    values = {core: number(given[name], f"parameters.{name}") for name, core in _NAMES.items()}
    pairs = motions_of(runs)
    times = [time for time, _ in pairs]
    starts = [float(time[0]) for time, motion in pairs if is_record(motion) and len(time)]
    if len(set(starts)) > 1 or (starts and len(starts) < len(pairs) and starts[0] != 0.0):
        raise InputError(
            problem="the runs start at different times", remedy="shift them to start at zero"
        )
    b = rig.bearing
    with core_refusals():
        done = _core.trajectories(
            [(time, _motion(motion, time)) for time, motion in pairs],
            model=model,
            clock=find_clock(clock),
            tolerance=number(tolerance, "tolerance"),
            start_time_s=starts[0] if starts else None,
            start_eps=None if eps is None else number(eps, "eps"),
            start_phi_rad=None if phi_rad is None else number(phi_rad, "phi_rad"),
            **values,
            radius_m=b.radius_m,
            length_m=b.length_m,
            clearance_m=b.clearance_m,
            mass_kg=b.mass_kg,
            count=b.count,
            viscosity_pa_s=rig.lubricant.viscosity_pa_s,
            load_n=rig.load.normal_n,
            derivatives=derivatives,
        )
    return [Trajectory(time, *columns) for time, columns in zip(times, done, strict=True)]


def is_record(motion: npt.ArrayLike | tuple[float, float, float]) -> bool:
    """Whether a motion is an array of speeds, not the three numbers of a sine."""
    return not (isinstance(motion, tuple) and len(motion) == 3)


def motions_of(
    runs: object,
) -> list[tuple[Array, npt.ArrayLike | tuple[float, float, float]]]:
    """Times and motion of each run, converted to arrays and numbers; errors name the run."""
    if isinstance(runs, str) or not isinstance(runs, Iterable):
        raise InputError(
            problem=f"runs is {described(runs)}", remedy="give a list of pairs (times, motion)"
        )
    return [_pair(i, run) for i, run in enumerate(runs)]


def _pair(place: int, run: object) -> tuple[Array, npt.ArrayLike | tuple[float, float, float]]:
    """Times (as an array) and motion of one run."""
    if not (isinstance(run, tuple | list) and len(run) == 2):
        raise InputError(
            problem=f"run {place} is {described(run)}", remedy="give a pair (times, motion)"
        )
    time, motion = run
    times = numbers(time, f"the times of run {place}", flat=True)
    if is_record(motion):
        return times, numbers(motion, f"the motion of run {place}", flat=True)
    return times, _sine(motion)


def _sine(given: object) -> tuple[float, float, float]:
    """Amplitude, angular frequency and bias of a sine, as numbers."""
    if not (isinstance(given, tuple | list) and len(given) in (2, 3)):
        raise InputError(
            problem=f"sine is {described(given)}",
            remedy="give (amplitude in m/s, omega in rad/s), optionally with a bias",
        )
    amplitude, omega, *bias = (number(x, "sine") for x in given)
    return amplitude, omega, bias[0] if bias else 0.0


def _motion(
    motion: npt.ArrayLike | tuple[float, float, float], time: Array
) -> tuple[float, float, float] | tuple[Array, Array]:
    if isinstance(motion, tuple) and len(motion) == 3:
        return motion
    return time, np.ascontiguousarray(motion, dtype=np.float64)
