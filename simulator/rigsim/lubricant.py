"""Effects on the lubricant, which change the effective speed of the film."""

from __future__ import annotations

import math

from .warmth import Warmth, thinner

Parameters = dict[str, dict[str, float]]


class Lubricant:
    """Effective speed of the film with `thermal_thinning`, `shear_thinning` and `vogel_viscosity`.

    The heat is stored as h = beta T (-), so that only beta q (1/J) and tau (s) matter.
    """

    def __init__(
        self, effects: Parameters, transition_speed: float, warmth: Warmth | None = None
    ) -> None:
        self.b_k = effects.get("vogel_viscosity", {}).get("B", 0.0)
        self.warmth = warmth if self.b_k else None
        thermal = effects.get("thermal_thinning")
        self.heats = thermal is not None
        self.heating = thermal["beta_q"] if thermal else 0.0
        self.cooling = 1.0 / thermal["tau"] if thermal else 0.0
        shear = effects.get("shear_thinning")
        self.shear_speed = shear["U_c"] if shear else 0.0
        self.shear_power = shear["n"] if shear else 1.0
        self._scale = 1.0 / transition_speed

    def film_speed(self, speed: float, heat: float, time_s: float = 0.0) -> float:
        """Return the film speed |Ub| (-) at speed |U| (m/s), heat beta T (-) and time (s)."""
        if speed <= 0.0:
            return 0.0
        ub = speed * self._scale
        if self.shear_speed > 0.0:
            ub /= 1.0 + (speed / self.shear_speed) ** self.shear_power
        ub *= self.thickness(time_s)
        if self.heats:
            ub *= math.exp(-heat)
        return ub

    def thickness(self, time_s: float) -> float:
        """Viscosity relative to that at the reference temperature, at a time (s)."""
        if self.warmth is None:
            return 1.0
        return thinner(self.b_k, self.warmth.at(time_s))

    def heat_rate(self, power_w: float, heat: float) -> float:
        """Time derivative of the heat beta T (1/s) at a friction power of one bearing (W)."""
        return self.heating * power_w - self.cooling * heat
