"""Fixed geometry of the rig and the four parameters of its base friction law."""

from __future__ import annotations

import math
from dataclasses import dataclass

from scipy.optimize import brentq


@dataclass(frozen=True)
class Bearing:
    """Geometry, lubricant and number of equal journal bearings on the shaft."""

    radius_m: float = 0.0127
    length_m: float = 0.01905
    clearance_m: float = 5.08e-5
    mass_kg: float = 2.27
    count: int = 4
    viscosity_pa_s: float = 0.002


@dataclass(frozen=True)
class Base:
    """A bearing under load with its base friction parameters.

    f_m: largest asperity friction coefficient (-); U_tr: transition speed (m/s);
    K0: asperity stiffness constant (-); gamma: viscous slope factor (-);
    load_n: normal load on one bearing (N).
    """

    f_m: float = 0.26
    U_tr: float = 0.06
    K0: float = 7.5e5
    gamma: float = 33.0
    load_n: float = 104.0
    bearing: Bearing = Bearing()

    @property
    def load_group(self) -> float:
        """Load number Fb = C^2 F/(mu U_tr L^3), equation (3.1) of Cohn (1998), dimensionless."""
        b = self.bearing
        return b.clearance_m**2 * self.load_n / (b.viscosity_pa_s * self.U_tr * b.length_m**3)

    @property
    def viscous_factor(self) -> float:
        """Factor gamma (C R/L^2) 2 pi of the shear term in equation (3.14) of Cohn (1998)."""
        b = self.bearing
        return self.gamma * b.clearance_m * b.radius_m / b.length_m**2 * 2.0 * math.pi

    @property
    def clock_hz(self) -> float:
        """Time scale U_tr/R of the film: dimensionless time per second (1/s)."""
        return self.U_tr / self.bearing.radius_m

    def transition_eccentricity(self) -> float:
        """Transition eccentricity eps_tr, the root of equation (3.20) of Cohn (1998) in (0, 1)."""
        target = 4.0 * self.load_group**2

        def excess(eps: float) -> float:
            d = 1.0 - eps * eps
            square = math.pi**2 / (4.0 * d**3) + 4.0 * eps * eps / d**4
            return eps * eps * square / target - 1.0

        return float(brentq(excess, 1e-9, 1.0 - 1e-9, xtol=1e-15, rtol=1e-14))
