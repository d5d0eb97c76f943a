"""Friction that does not arise in the bearing but is measured by the load cell."""

from __future__ import annotations

from .lubricant import Parameters


class OtherFriction:
    """Sum of `coulomb_drag`, `quadratic_drag` and `inertia`, added to the bearing friction."""

    def __init__(self, effects: Parameters) -> None:
        self.coulomb = effects.get("coulomb_drag", {}).get("F_d", 0.0)
        self.quadratic = effects.get("quadratic_drag", {}).get("c", 0.0)
        self.leak = effects.get("inertia", {}).get("m_e", 0.0)

    def force(self, v: float, sign: int, acceleration: float) -> float:
        """Return the additional force (N) at surface speed `v` (m/s) and acceleration (m/s^2)."""
        return self.coulomb * sign + self.quadratic * v * abs(v) + self.leak * acceleration
