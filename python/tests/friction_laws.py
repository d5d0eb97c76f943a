"""Friction laws implemented independently of jbf, with the integrators of SciPy."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
from jbf import Run
from scipy.integrate import solve_ivp

Array = npt.NDArray[np.float64]
Speed = Callable[[float], float]


def stroke_speed(amplitude_m: float, omega: float, second: float = 0.37) -> Speed:
    """Speed (m/s) of two superposed sines that start from rest."""

    def speed(t: float) -> float:
        waves = np.cos(omega * t) + 0.6 * np.cos(second * omega * t + 1.0)
        return float(amplitude_m * omega * min(2.0 * t, 1.0) * waves)

    return speed


def _bristle(speed: Speed, t: Array, slope: Callable[[float, float], float]) -> Array:
    """Integrate a state from zero whose rate depends on the speed, at the times `t`."""
    return driven(lambda s, y: slope(speed(s), y), t)


def driven(rate: Callable[[float, float], float], t: Array) -> Array:
    """Integrate a state from zero with a given rate (time, state), at the times `t`."""
    result = solve_ivp(
        lambda s, y: [rate(s, y[0])],
        (t[0], t[-1]),
        [0.0],
        method="LSODA",
        t_eval=t,
        rtol=1e-9,
        atol=1e-12,
        max_step=float(t[1] - t[0]),
    )
    assert result.success
    return np.asarray(result.y[0])


def dahl(speed: Speed, t: Array, *, fc: float, s0: float, exponent: float, fv: float) -> Array:
    """Dahl law with any exponent (N)."""

    def slope(v: float, f: float) -> float:
        u = 1.0 - f / fc * np.sign(v)
        return float(s0 * v * np.abs(u) ** exponent * np.sign(u))

    v = np.array([speed(x) for x in t])
    return _bristle(speed, t, slope) + fv * v


def lugre(
    speed: Speed,
    t: Array,
    *,
    fc: float,
    fs: float,
    vs: float,
    s0: float,
    s1: float,
    vd: float,
    fv: float,
) -> Array:
    """LuGre law in the form of Olsson (N)."""

    def level(v: float | Array) -> float | Array:
        return fc + (fs - fc) * np.exp(-((v / vs) ** 2))

    def rate(v: float, z: float) -> float:
        return float(v - abs(v) * z * s0 / level(v))

    z = _bristle(speed, t, rate)
    v = np.array([speed(x) for x in t])
    damped = s1 * np.exp(-((v / vd) ** 2)) * (v - np.abs(v) * z * s0 / level(v))
    return s0 * z + damped + fv * v


def maxwell_slip(
    speed: Speed,
    t: Array,
    *,
    fc: float,
    s0: float,
    exponent: float,
    fv: float,
    excess: float = 0.0,
    vs: float = 1.0,
) -> Array:
    """Generalised Maxwell slip (N) as four hundred elements of equal stiffness.

    The slip displacements sample a virgin curve of the given exponent; the level falls with the
    speed by `excess`.
    """
    elements, finer = 400, 4
    u = (np.arange(elements) + 0.5) / elements
    if exponent == 1.0:
        slip = -np.log(u) * fc / s0
    else:
        slip = (1.0 - u ** (1.0 / exponent - 1.0)) / (1.0 - exponent) * fc / s0
    step = (t[1] - t[0]) / finer
    fine = t[0] + step * np.arange(finer * (len(t) - 1) + 1)
    v = np.array([speed(x) for x in fine])
    bent = np.zeros(elements)
    force = np.zeros(len(fine))
    level = 1.0 + excess / fc * np.exp(-((v / vs) ** 2))
    for i, displacement in enumerate(0.5 * (v[1:] + v[:-1]) * step, start=1):
        bent = np.clip(bent + displacement, -slip * level[i], slip * level[i])
        force[i] = s0 * np.mean(bent)
    return force[::finer] + fv * v[::finer]


def elasto_plastic(
    speed: Speed, t: Array, *, fc: float, s0: float, breakaway: float, fv: float
) -> Array:
    """Elasto-plastic law of Dupont with an exponential approach to the steady force (N)."""

    def alpha(share: float) -> float:
        return 0.0 if share <= breakaway else (1.0 - breakaway / share) / (1.0 - breakaway)

    return _single_state(speed, t, alpha, fc, s0, fv)


def _single_state(
    speed: Speed, t: Array, alpha: Callable[[float], float], fc: float, s0: float, fv: float
) -> Array:
    def slope(v: float, f: float) -> float:
        share = f / fc * np.sign(v)
        return float(s0 * v * (1.0 - alpha(share) * share))

    v = np.array([speed(x) for x in t])
    return _bristle(speed, t, slope) + fv * v


def stribeck(
    speed: Speed, t: Array, *, fc: float, fs: float, vs: float, delta: float, fv: float
) -> Array:
    """The Stribeck curve (N)."""
    v = np.array([speed(x) for x in t])
    return (fc + (fs - fc) * np.exp(-((np.abs(v) / vs) ** delta)) + fv * np.abs(v)) * np.sign(v)


def rate_and_state(
    speed: Speed, t: Array, *, f0: float, a: float, b: float, dc: float, v0: float, fv: float
) -> Array:
    """Rate-and-state friction with the ageing law (N), from steady sliding at the first sample."""
    result = solve_ivp(
        lambda s, y: [1.0 - abs(speed(s)) * y[0] / dc],
        (t[0], t[-1]),
        [dc / abs(speed(t[0]))],
        method="LSODA",
        t_eval=t,
        rtol=1e-9,
        atol=1e-12,
        max_step=float(t[1] - t[0]),
    )
    assert result.success
    v = np.array([speed(x) for x in t])
    psi = f0 + b * np.log(v0 * result.y[0] / dc)
    friction: Array = a * np.arcsinh(v / (2.0 * v0) * np.exp(psi / a)) + fv * v
    return friction


def seven(
    speed: Speed,
    t: Array,
    *,
    kt: float,
    fc: float,
    fv: float,
    fs: float,
    vs: float,
    tau: float,
    gamma: float,
) -> Array:
    """The seven-parameter model as a state machine on a time grid of 0.1 ms (N)."""
    dt = 1e-4
    fine = np.arange(t[0], t[-1] + dt, dt)
    v = np.array([speed(x) for x in fine])
    late = np.array([speed(max(x - tau, t[0])) for x in fine])
    force = np.zeros_like(fine)
    sliding, bent, at_stop, grown, stuck_for = False, 0.0, fs, fs, 0.0
    direction = 0.0
    for i in range(len(fine)):
        part = 1.0 / (1.0 + (late[i] / vs) ** 2)
        if sliding and np.sign(v[i]) != direction:
            sliding, at_stop, stuck_for, bent = False, grown * part, 0.0, force[i - 1]
        if not sliding:
            stuck_for += dt
            grown = at_stop + (fs - at_stop) * stuck_for / (stuck_for + gamma)
            bent += kt * v[i] * dt
            if bent * np.sign(v[i]) >= fc + grown * part:
                sliding, direction = True, np.sign(v[i])
        force[i] = direction * (fc + grown * part) if sliding else bent
    return np.interp(t, fine, force + fv * v)


def record(
    speed: Speed,
    t: Array,
    friction: Array,
    noise_rms: float,
    seed: int,
    name: str = "run",
    count_m: float = 1e-7,
) -> Run:
    """A run of a linear axis: position in counts of 0.1 um, speed and friction with noise."""
    rng = np.random.default_rng(seed)
    v = np.array([speed(x) for x in t])
    position = np.concatenate(([0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t))))
    return Run.from_arrays(
        t,
        v + 1e-4 * np.max(np.abs(v)) * rng.standard_normal(len(t)),
        friction + noise_rms * rng.standard_normal(len(t)),
        position_m=count_m * np.round(position / count_m),
        name=name,
    )
