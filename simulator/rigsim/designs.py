"""Rigs of other designs, with geometry, oil, load and friction drawn from realistic ranges.

The effects of the catalogue are sized for the standard rig. In this module they are scaled to the
rig, so that an effect of strength 1 has the same ratio to the friction on a light rig as on a heavy
one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.integrate import odeint

from .bearing import Base, Bearing
from .catalogue import draw
from .film import Film
from .lubricant import Parameters
from .seeds import Rng, log_uniform, stream

USUAL_FORCE_N = 24.0  # f_m F of the rig for which the catalogue is sized
USUAL_RADIUS_M = 0.0127
COUNTS_PER_TURN = (8192, 10000, 15000, 20000, 36000)
PUSHES_N = {
    "coulomb_drag": ("F_d",),
    "quadratic_drag": ("c",),
    "inertia": ("m_e",),
    "sensor_offset": ("b",),
    "sensor_drift": ("d",),
    "sensor_hysteresis": ("w",),
}
"""Parameters in newtons, or in newtons per another unit, by effect."""


@dataclass(frozen=True)
class Design:
    """Random rig with its logger, and matching speeds (m/s) and noise (N)."""

    base: Base
    rate_hz: float
    counts_per_rad: float
    top_m_s: float
    noise_n: float


def _base(rng: Rng) -> Base:
    radius = log_uniform(rng, 0.008, 0.022)
    bearing = Bearing(
        radius_m=round(radius, 5),
        length_m=round(radius * rng.uniform(1.1, 1.9), 5),
        clearance_m=round(radius * log_uniform(rng, 0.0025, 0.006), 8),
        mass_kg=round(log_uniform(rng, 1.0, 5.0), 2),
        viscosity_pa_s=round(log_uniform(rng, 0.0012, 0.006), 6),
    )
    return Base(
        f_m=float(rng.uniform(0.15, 0.30)),
        U_tr=float(rng.uniform(0.04, 0.08)),
        K0=log_uniform(rng, 2.5e5, 1.0e6),
        gamma=float(rng.uniform(15.0, 40.0)),
        load_n=round(log_uniform(rng, 50.0, 250.0), 1),
        bearing=bearing,
    )


def _turns(base: Base) -> bool:
    """Return True if the film of a rig carries the load at speed and not at rest."""
    if not 80.0 < base.load_group < 1500.0:
        return False
    touching = base.transition_eccentricity() + math.sqrt(base.load_group / base.K0)
    return touching < 0.995 and 0.15 < base.viscous_factor < 0.9


def draw_design(seed: int) -> Design:
    """Draw the rig and logger of a seed."""
    rng = stream(seed, "design")
    base = _base(rng)
    while not _turns(base):
        base = _base(rng)
    return Design(
        base=base,
        rate_hz=float(rng.choice([50.0, 100.0, 200.0], p=[0.5, 0.4, 0.1])),
        counts_per_rad=float(rng.choice(COUNTS_PER_TURN)) / (2.0 * math.pi),
        top_m_s=base.U_tr * float(rng.uniform(1.7, 2.4)),
        noise_n=float(rng.uniform(0.01, 0.025)) * base.f_m * base.load_n,
    )


def _heat_w(base: Base) -> float:
    """Approximate friction power of a bearing at a speed of 1.5 U_tr (W)."""
    shear = Film.of(base).shear(base.transition_eccentricity(), 1.5)
    return base.load_n * base.U_tr * (0.05 * base.f_m + shear)


def draw_effect(name: str, base: Base, rng: Rng, strength: float = 1.0) -> dict[str, float]:
    """Draw random parameters of an effect, scaled to a rig."""
    values = draw(name, rng, strength)
    share = base.f_m * base.load_n / USUAL_FORCE_N
    for key in PUSHES_N.get(name, ()):
        values[key] *= share
    if name == "sensor_nonlinearity":  # the same share of the reading at the force of the rig
        values["c"] /= share**2
    if name == "drive_compliance":  # the drive is sized for the torque; its modes stay
        turned = share * base.bearing.radius_m / USUAL_RADIUS_M
        values = {key: value * turned for key, value in values.items()}
    if name == "thermal_thinning":
        values["beta_q"] *= _heat_w(Base()) / _heat_w(base)
    return values


def draw_effects(
    names: tuple[str, ...], base: Base, seed: int, strength: float = 1.0
) -> Parameters:
    """Draw the parameters of several effects, each from the random stream of its name."""
    return {n: draw_effect(n, base, stream(seed, "effect", n), strength) for n in names}


def draw_film_start(base: Base, speed_m_s: float, rng: Rng) -> tuple[float, float]:
    """Draw the film state (eps, phi) of a run that begins in motion, before the film has settled.

    The state is that of another steady speed, up to three times slower or faster, or that of the
    transition. In a run that begins at rest the shaft is on its asperities or still approaching
    them.
    """
    film = Film.of(base)
    eps, phi = film.start()
    ub = abs(speed_m_s) / base.U_tr
    if ub < 0.02:
        # With soft asperities alone the shaft would pass through the bush; there the film also
        # carries.
        gap = min(math.sqrt(film.load_group / film.stiffness), 0.9 * (1.0 - film.eps_tr))
        standing = film.eps_tr + gap
        return float(rng.uniform(eps, standing)), phi * float(rng.uniform())
    if rng.random() < 0.25:
        return eps, phi
    other = ub * log_uniform(rng, 1.0 / 3.0, 3.0)
    states = odeint(
        lambda _t, y: film.rates(y[0], y[1], other),
        film.start(),
        np.array([0.0, 60.0 / film.clock_hz]),
        tfirst=True,
    )
    return float(states[-1, 0]), float(states[-1, 1])
