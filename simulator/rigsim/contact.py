"""Effects in the contact, which change the friction of asperities and film.

They act in this order: running-in scales f_m; film friction is added; then Kato's dwell term and
the Stribeck excess; then direction asymmetry and position ripple multiply the sum. The bristle of
`presliding`, if present, deflects towards this unsigned coefficient.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from .film import Film
from .lubricant import Parameters


@dataclass
class Path:
    """History of the motion at one instant, as far as the contact depends on it."""

    slid_m: float = 0.0  # distance slid in the run
    since_rest_m: float = 0.0  # distance slid since the last rest
    dwell_s: float = 0.0  # length of that rest; 0 before the first
    angle_rad: float = 0.0  # journal angle


class Contact:
    """Friction coefficient of the contact with its effects."""

    def __init__(self, effects: Parameters, film: Film, f_m: float) -> None:
        self.film = film
        self.f_m = f_m
        self.wear = effects.get("running_in")
        self.dwell = effects.get("dwell_stiction")
        self.excess = effects.get("stribeck_excess")
        self.ripple = effects.get("position_ripple")
        self.asymmetry = effects.get("direction_asymmetry", {}).get("a", 0.0)
        self.sigma = effects.get("presliding", {}).get("sigma", 0.0)

    def coefficient(self, eps: float, ub: float, speed: float, sign: int, path: Path) -> float:
        """Return the unsigned coefficient (-) at film speed `ub` (-) and speed |v| (m/s)."""
        f_m = self.f_m
        if self.wear is not None:
            f_m *= 1.0 + self.wear["a"] * math.exp(-path.slid_m / self.wear["s_0"])
        f = f_m * self.film.asperity_load(eps) / self.film.load_group
        f += self.film.shear(eps, ub)
        if self.dwell is not None and path.dwell_s > 0.0:
            f += self._aged(self.dwell, path)
        if self.excess is not None:
            ratio = max(speed, 0.0) / self.excess["v_s"]
            f += self.excess["a"] * math.exp(-(ratio ** self.excess["n"]))
        f *= 1.0 + self.asymmetry * sign
        if self.ripple is not None:
            f *= 1.0 + self.ripple["a"] * math.cos(path.angle_rad - self.ripple["theta_0"])
        return f

    @staticmethod
    def _aged(p: dict[str, float], path: Path) -> float:
        strength = -math.expm1(-((path.dwell_s / p["t_0"]) ** p["m"]))
        return p["a"] * strength * math.exp(-path.since_rest_m / p["s_0"])

    def bristle_rate(self, z: float, v: float, unsigned: float) -> float:
        """Time derivative (m/s) of the bristle deflection `z` (m) at surface speed `v` (m/s)."""
        if v == 0.0 or unsigned <= 0.0:
            return v
        return v - abs(v) * self.sigma * z / unsigned
