"""Lubricating film: model without inertia, (3.18) and (3.19) of Cohn (1998), in eps and phi."""

from __future__ import annotations

import math
from dataclasses import dataclass

from .bearing import Base

HALF_PI = 0.5 * math.pi
START_PHI = 0.15


@dataclass(frozen=True)
class Film:
    """Constants of the film equations of one rig; rates are per second."""

    load_group: float
    eps_tr: float
    stiffness: float
    viscous: float
    clock_hz: float

    @classmethod
    def of(cls, base: Base, clock_factor: float = 1.0) -> Film:
        """Create the film of `base` with its rate multiplied by `clock_factor` (-)."""
        return cls(
            load_group=base.load_group,
            eps_tr=base.transition_eccentricity(),
            stiffness=base.K0,
            viscous=base.viscous_factor,
            clock_hz=base.clock_hz * clock_factor,
        )

    def start(self) -> tuple[float, float]:
        """Return the state (eps, phi) at the start of a run."""
        return self.eps_tr, START_PHI

    def asperity_load(self, eps: float) -> float:
        """Asperity load W = K0 (eps - eps_tr)^2 above the transition, otherwise 0 (-)."""
        gap = eps - self.eps_tr
        return self.stiffness * gap * gap if gap > 0.0 else 0.0

    def rates(self, eps: float, phi: float, ub: float) -> tuple[float, float]:
        """Time derivatives of eps (1/s) and phi (rad/s) at the dimensionless speed |Ub| = `ub`."""
        d = 1.0 - eps * eps
        root = math.sqrt(d)
        j11 = HALF_PI / (d * root)
        j12 = -2.0 * eps / (d * d)
        j22 = HALF_PI * (1.0 + 2.0 * eps * eps) / (d * d * root)
        fb = self.load_group
        sin_phi = math.sin(phi)
        push = fb * math.cos(phi) - self.asperity_load(eps) + fb * j12 * sin_phi / j11
        eps_dot = push / (j22 - j12 * j12 / j11)
        phi_dot = (0.5 * j11 * eps * ub - j12 * eps_dot - fb * sin_phi) / (j11 * eps)
        return eps_dot * self.clock_hz, phi_dot * self.clock_hz

    def shear(self, eps: float, ub: float) -> float:
        """Viscous part of the friction coefficient at the dimensionless speed |Ub| = `ub` (-)."""
        return self.viscous * ub / math.sqrt(1.0 - eps * eps) / self.load_group
