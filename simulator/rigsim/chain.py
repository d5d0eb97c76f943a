"""Signal chain of one run, for a rigid or a compliant drive: state, rates and friction."""

from __future__ import annotations

from collections.abc import Sequence

from .bearing import Base
from .contact import Contact, Path
from .film import Film
from .lubricant import Lubricant, Parameters
from .other import OtherFriction
from .warmth import Warmth


class Chain:
    """Signal chain of one rig: lubricant, film, contact, other friction and sensor lag.

    The state contains eps and phi. If the corresponding effects are active, heat beta T (-),
    bristle deflection (m), lagged friction (N) and the time (s) for the temperature follow, in this
    order.
    """

    def __init__(
        self,
        base: Base,
        effects: Parameters,
        film_start: tuple[float, float] | None = None,
        warmth: Warmth | None = None,
    ) -> None:
        self.load_n = base.load_n
        self.film_start = film_start
        memory = effects.get("film_memory", {}).get("factor", 1.0)
        self.film = Film.of(base, memory)
        self.lubricant = Lubricant(effects, base.U_tr, warmth)
        self.contact = Contact(effects, self.film, base.f_m)
        self.other = OtherFriction(effects)
        self.lag_s = effects.get("sensor_lag", {}).get("tau", 0.0)
        self.size = 2
        self.heat_at = self._slot(self.lubricant.heats)
        self.bristle_at = self._slot(self.contact.sigma > 0.0)
        self.lag_at = self._slot(self.lag_s > 0.0)
        self.time_at = self._slot(self.lubricant.warmth is not None)

    def _slot(self, wanted: bool) -> int:
        if not wanted:
            return -1
        self.size += 1
        return self.size - 1

    @property
    def bristled(self) -> bool:
        """True if the contact has a bristle, so that friction at rest is a state."""
        return self.bristle_at >= 0

    def start(self, v: float, acceleration: float, path: Path) -> list[float]:
        """Return the state at the start of a run that begins at the surface speed `v` (m/s).

        The film is cold and at the transition, or at `film_start` (eps, phi). A run that begins at
        rest has a relaxed bristle; one that begins in motion has a fully deflected bristle. The
        reading of a load cell with lag equals the force.
        """
        y = [*(self.film_start or self.film.start()), *([0.0] * (self.size - 2))]
        sign = (v > 0.0) - (v < 0.0)
        if self.bristle_at >= 0 and sign:
            y[self.bristle_at] = sign * self.unsigned(y, v, sign, path) / self.contact.sigma
        if self.lag_at >= 0:
            force = self.bearing(y, v, sign, path)
            y[self.lag_at] = force + self.other.force(v, sign, acceleration)
        return y

    def _film_speed(self, y: Sequence[float], speed: float) -> float:
        heat = y[self.heat_at] if self.heat_at >= 0 else 0.0
        time_s = y[self.time_at] if self.time_at >= 0 else 0.0
        return self.lubricant.film_speed(speed, heat, time_s)

    def unsigned(self, y: Sequence[float], v: float, sign: int, path: Path) -> float:
        """Sliding friction coefficient of the contact, without its sign (-)."""
        speed = abs(v)
        return self.contact.coefficient(y[0], self._film_speed(y, speed), speed, sign, path)

    def bearing(
        self, y: Sequence[float], v: float, sign: int, path: Path, held_n: float | None = None
    ) -> float:
        """Friction force of a bearing (N).

        The force is that of the bristle if there is one, `held_n` if the journal sticks, and
        otherwise that of sliding.
        """
        if self.bristle_at >= 0:
            return self.load_n * self.contact.sigma * y[self.bristle_at]
        if held_n is not None:
            return held_n
        if sign == 0:
            return 0.0
        return sign * self.load_n * self.unsigned(y, v, sign, path)

    def cell(
        self,
        y: Sequence[float],
        v: float,
        sign: int,
        acceleration: float,
        path: Path,
        held_n: float | None = None,
    ) -> float:
        """Reading of the load cell (N), with lag but without offset and drift."""
        if self.lag_at >= 0:
            return y[self.lag_at]
        return self.bearing(y, v, sign, path, held_n) + self.other.force(v, sign, acceleration)

    def rates(
        self,
        y: Sequence[float],
        v: float,
        sign: int,
        acceleration: float,
        path: Path,
        held_n: float | None = None,
    ) -> list[float]:
        """Time derivatives (1/s) of the state at the surface speed `v` (m/s)."""
        speed = abs(v)
        ub = self._film_speed(y, speed)
        out = list(self.film.rates(y[0], y[1], ub))
        if self.time_at >= 0:
            # Thin oil leaves the gap sooner: the squeeze rate is proportional to 1/mu.
            thick = self.lubricant.thickness(y[self.time_at])
            out = [rate / thick for rate in out]
        if self.size == 2:
            return out
        if self.heat_at >= 0:
            power = abs(self.bearing(y, v, sign, path, held_n) * v)
            out.append(self.lubricant.heat_rate(power, y[self.heat_at]))
        if self.bristle_at >= 0:
            unsigned = self.contact.coefficient(y[0], ub, speed, sign, path)
            out.append(self.contact.bristle_rate(y[self.bristle_at], v, unsigned))
        if self.lag_at >= 0:
            force = self.bearing(y, v, sign, path, held_n)
            force += self.other.force(v, sign, acceleration)
            out.append((force - y[self.lag_at]) / self.lag_s)
        if self.time_at >= 0:
            out.append(1.0)
        return out
