"""Catalogue of the simulated effects: parameters, null values, and random draws of typical size.

A `Spread` defines the range of a parameter at strength 1 and the power of the strength by which it
scales. At strength 1 the RMS of an effect is of the order of the noise, or up to a few times that,
in at least one run of the standard campaign.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

TURN = 2.0 * math.pi


@dataclass(frozen=True)
class Spread:
    """Range of one parameter, with the power of the strength by which it scales.

    The distribution is log-uniform for a positive range, and uniform for one that starts at 0.
    """

    low: float
    high: float
    unit: str
    power: float = 0.0
    signed: bool = False

    def draw(self, rng: np.random.Generator, strength: float) -> float:
        """Draw a value of the parameter at `strength`, with a random sign if `signed`."""
        if self.low > 0.0:
            value = float(np.exp(rng.uniform(math.log(self.low), math.log(self.high))))
        else:
            value = float(rng.uniform(self.low, self.high))
        if self.signed and rng.random() < 0.5:
            value = -value
        return value * math.pow(strength, self.power)


CATALOGUE: dict[str, dict[str, Spread]] = {
    "drive_compliance": {
        "k": Spread(50.0, 110.0, "N m/rad", -1.0),
        "c": Spread(0.04, 0.10, "N m s/rad"),
        "J": Spread(0.002, 0.005, "kg m^2"),
    },
    "backlash": {"gap": Spread(0.003, 0.01, "rad", 1.0)},
    "load_dependence": {"p": Spread(0.5, 1.1, "-", 1.0), "q": Spread(0.5, 1.5, "-", 1.0)},
    "thermal_thinning": {
        "beta_q": Spread(0.05, 0.13, "1/J", 1.0),
        "tau": Spread(60.0, 160.0, "s"),
    },
    "vogel_viscosity": {"B": Spread(600.0, 1000.0, "K", 1.0)},
    "shear_thinning": {"U_c": Spread(0.08, 0.16, "m/s", -1.0), "n": Spread(0.8, 1.5, "-")},
    "film_memory": {"factor": Spread(2.0, 3.0, "-")},
    "presliding": {"sigma": Spread(1200.0, 3000.0, "1/m", -1.0)},
    "dwell_stiction": {
        "a": Spread(0.05, 0.09, "-", 1.0),
        "t_0": Spread(2.0, 6.0, "s"),
        "m": Spread(0.5, 0.8, "-"),
        "s_0": Spread(0.0015, 0.004, "m"),
    },
    "stribeck_excess": {
        "a": Spread(0.03, 0.07, "-", 1.0),
        "v_s": Spread(0.008, 0.02, "m/s"),
        "n": Spread(1.0, 2.0, "-"),
    },
    "direction_asymmetry": {"a": Spread(0.08, 0.14, "-", 1.0, signed=True)},
    "position_ripple": {
        "a": Spread(0.10, 0.22, "-", 1.0),
        "theta_0": Spread(0.0, TURN, "rad"),
    },
    "running_in": {"a": Spread(0.18, 0.35, "-", 1.0), "s_0": Spread(0.8, 2.5, "m")},
    "coulomb_drag": {"F_d": Spread(0.5, 1.2, "N", 1.0)},
    "quadratic_drag": {"c": Spread(40.0, 100.0, "N s^2/m^2", 1.0)},
    "inertia": {"m_e": Spread(3.0, 7.0, "kg", 1.0)},
    "sensor_hysteresis": {"w": Spread(0.5, 1.2, "N", 1.0)},
    "sensor_nonlinearity": {"c": Spread(3.5e-4, 4.5e-4, "1/N^2", 1.0, signed=True)},
    "sensor_lag": {"tau": Spread(0.06, 0.15, "s", 1.0)},
    "time_delay": {"tau": Spread(0.03, 0.12, "s", 1.0)},
    "sensor_offset": {"b": Spread(0.35, 0.8, "N", 1.0, signed=True)},
    "sensor_drift": {"d": Spread(0.008, 0.02, "N/s", 1.0, signed=True)},
}

BY_THERMOMETER = ("vogel_viscosity",)
"""Effects that can be observed only if the temperature varies, which is then recorded."""

NULLS: dict[str, dict[str, float]] = {
    "drive_compliance": {"k": math.inf},
    "backlash": {"gap": 0.0},
    "load_dependence": {"p": 0.0, "q": 0.0},
    "thermal_thinning": {"beta_q": 0.0},
    "vogel_viscosity": {"B": 0.0},
    "shear_thinning": {"U_c": math.inf},
    "film_memory": {"factor": 1.0},
    "presliding": {"sigma": math.inf},
    "inertia": {"m_e": 0.0},
    "coulomb_drag": {"F_d": 0.0},
    "quadratic_drag": {"c": 0.0},
    "sensor_hysteresis": {"w": 0.0},
    "sensor_nonlinearity": {"c": 0.0},
    "sensor_lag": {"tau": 0.0},
    "time_delay": {"tau": 0.0},
    "sensor_offset": {"b": 0.0},
    "sensor_drift": {"d": 0.0},
    **{
        name: {"a": 0.0}
        for name in (
            "dwell_stiction",
            "stribeck_excess",
            "direction_asymmetry",
            "position_ripple",
            "running_in",
        )
    },
}


def draw(name: str, rng: np.random.Generator, strength: float = 1.0) -> dict[str, float]:
    """Draw random parameters of the effect `name` at `strength` (usual values: 0.6 to 1.5)."""
    if name not in CATALOGUE:
        raise ValueError(f"no effect named {name!r}; there are {', '.join(CATALOGUE)}")
    values = {key: spread.draw(rng, strength) for key, spread in CATALOGUE[name].items()}
    if name == "film_memory":  # a slower or a faster film, by the same factor
        slower = rng.random() < 0.5
        values["factor"] **= -strength if slower else strength
    return values


def check(effects: dict[str, dict[str, float]]) -> dict[str, dict[str, float]]:
    """Return `effects` without those at their null value; raise for an unknown name."""
    active = {}
    for name, values in effects.items():
        if name not in CATALOGUE:
            raise ValueError(f"no effect named {name!r}; there are {', '.join(CATALOGUE)}")
        if set(values) != set(CATALOGUE[name]):
            wanted = ", ".join(CATALOGUE[name])
            raise ValueError(f"effect {name} takes {wanted}; got {', '.join(values)}")
        if any(values[key] != null for key, null in NULLS[name].items()):
            active[name] = values
    return active
