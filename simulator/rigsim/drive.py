"""Runs with a compliant drive: a torsion spring moves the journal, which sticks or slides.

Phases of sticking and sliding are integrated one after another; events end a phase. The load cell
reports the torque of the spring while the journal sticks, and the friction while it slides. With a
bristle, friction is not set-valued, and there is only one phase.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from .chain import Chain
from .contact import Path
from .motions import Motion, Piece

Vector = NDArray[np.float64]
RTOL = 1e-9
STILL = 1e-9  # m/s; a journal with a bristle below this speed has direction zero
NUDGE = 1e-9  # rad/s given to a journal that breaks away


class CompliantDrive:
    """Simulation of one run with a drive of stiffness k, damping c and inertia J.

    The units are N m/rad, N m s/rad and kg m^2. `chain` computes the friction of the journal.
    """

    def __init__(
        self,
        chain: Chain,
        drive: dict[str, float],
        count: int,
        radius_m: float,
        start_angle: float,
    ) -> None:
        self.chain = chain
        self.k, self.c, self.J = drive["k"], drive["c"], drive["J"]
        self.radius_m = radius_m
        self.arm = count * radius_m
        self.start_angle = start_angle
        self.n = chain.size

    def run(self, motion: Motion, times: Vector, *, under_way: bool = False) -> Vector:
        """Simulate the run and return the force on the load cell (N), before offset and drift.

        `times` are the instants, s.

        The spring is relaxed at the start or, if `under_way`, deflected by the initial friction.
        """
        force = np.zeros(len(times))
        first = motion.pieces[0]
        v, a = first.speed(0.0), first.acceleration(0.0)
        inner = self.chain.start(v, a, Path(angle_rad=self.start_angle))
        self.y = np.array([*inner, 0.0, v / self.radius_m])
        if under_way:
            sign = (v > 0.0) - (v < 0.0)
            friction = self.chain.bearing(inner, v, sign, Path(angle_rad=self.start_angle))
            self.y[-2] = first.position(0.0) / self.radius_m - self.arm * friction / self.k
        self.slid = self.since_rest = self.dwell = 0.0
        self.stuck_from: float | None = None
        self.mode = 2 if self.chain.bristled else first.sign
        if self.mode == 0 or (self.mode != 2 and abs(self.y[-1]) < 1e-12):
            self._stop(0.0)
        for piece in motion.pieces:
            last = piece is motion.pieces[-1]
            inside = np.flatnonzero((times >= piece.t0) & ((times < piece.t1) | last))
            self._piece(piece, times, inside, force)
        return force

    def _piece(self, piece: Piece, times: Vector, inside: NDArray[np.intp], force: Vector) -> None:
        t = piece.t0
        pending = inside
        while t < piece.t1:
            if self.mode == 0:
                self._maybe_release(piece, t)
            upto, solution = self._phase(piece, t)
            here = pending[times[pending] < upto] if upto < piece.t1 else pending
            if len(here):
                states = solution(times[here])
                for i, state in zip(here, states.T, strict=True):
                    force[i] = self._cell(piece, float(times[i]), state.tolist())
            pending = pending[len(here) :]
            self._close(piece, t, upto, solution(upto))
            t = upto

    # phases ---------------------------------------------------------------------------

    def _phase(self, piece: Piece, t0: float) -> tuple[float, Callable[..., Vector]]:
        self.t0, self.theta0 = t0, float(self.y[-2])
        rates = self._stick_rates if self.mode == 0 else self._slip_rates
        events: list[Callable[[float, Vector], float]] = []
        if self.mode == 0:
            events = [_terminal(lambda t, y: self._overload(piece, t, y.tolist()), 1.0)]
        elif self.mode != 2:
            sign = self.mode
            events = [_terminal(lambda t, y: sign * float(y[-1]), -1.0)]
        atol = np.full(self.n + 2, 1e-11)
        if self.chain.bristle_at >= 0:
            atol[self.chain.bristle_at] = 1e-13
        if self.chain.lag_at >= 0:
            atol[self.chain.lag_at] = 1e-6  # N; its rate jumps when a drag changes sign
        out = solve_ivp(
            lambda t, y: rates(piece, t, y.tolist()),
            (t0, piece.t1),
            self.y,
            method="LSODA" if self.mode == 2 else "DOP853",
            rtol=RTOL,
            atol=atol,
            events=events or None,
            dense_output=True,
            max_step=0.5 if self.mode == 0 else 0.02,
        )
        if not out.success:
            raise RuntimeError(f"drive phase from {t0} s: {out.message}")
        return float(out.t[-1]), out.sol

    def _slip_rates(self, piece: Piece, t: float, y: list[float]) -> list[float]:
        omega = y[-1]
        v = omega * self.radius_m
        path = self._path(t, y)
        sign = self._slip_sign(v)
        friction = self.chain.bearing(y, v, sign, path)
        alpha = (self._torque(piece, t, y) - self.arm * friction) / self.J
        inner = self.chain.rates(y, v, sign, alpha * self.radius_m, path)
        return [*inner, omega, alpha]

    def _stick_rates(self, piece: Piece, t: float, y: list[float]) -> list[float]:
        held = self._torque(piece, t, y) / self.arm
        return [*self.chain.rates(y, 0.0, 0, 0.0, self._path(t, y), held), 0.0, 0.0]

    def _close(self, piece: Piece, t0: float, t1: float, y: Vector) -> None:
        path = self._path(t1, y.tolist())
        self.slid, self.since_rest = path.slid_m, path.since_rest_m
        self.y = y.copy()
        if self.mode == 2:
            self._commanded_rest(piece, t0, t1)
        elif t1 < piece.t1:
            if self.mode == 0:
                self._release(piece, t1)
            else:
                self._stop(t1)

    def _stop(self, t: float) -> None:
        self.mode = 0
        self.y[-1] = 0.0
        self.stuck_from = t
        self.since_rest = 0.0

    def _maybe_release(self, piece: Piece, t: float) -> None:
        if self._overload(piece, t, self.y.tolist()) > 0.0:
            self._release(piece, t)

    def _release(self, piece: Piece, t: float) -> None:
        torque = self._torque(piece, t, self.y.tolist())
        self.mode = 1 if torque > 0.0 or (torque == 0.0 and piece.sign > 0) else -1
        self.y[-1] = self.mode * NUDGE
        assert self.stuck_from is not None
        self.dwell = t - self.stuck_from
        self.stuck_from = None

    def _commanded_rest(self, piece: Piece, t0: float, t1: float) -> None:
        if piece.sign == 0:
            self.stuck_from = t0 if self.stuck_from is None else self.stuck_from
            self.since_rest = 0.0
            self.dwell = t1 - self.stuck_from
        else:
            self.stuck_from = None

    # instantaneous values ---------------------------------------------------------------

    def _torque(self, piece: Piece, t: float, y: list[float]) -> float:
        twist = piece.position(t) / self.radius_m - y[-2]
        return self.k * twist + self.c * (piece.speed(t) / self.radius_m - y[-1])

    def _overload(self, piece: Piece, t: float, y: list[float]) -> float:
        torque = self._torque(piece, t, y)
        sign = 1 if torque > 0.0 or (torque == 0.0 and piece.sign > 0) else -1
        static = self.chain.unsigned(y, 0.0, sign, self._path(t, y))
        return abs(torque) - self.arm * self.chain.load_n * static

    def _slip_sign(self, v: float) -> int:
        return self.mode if self.mode != 2 else (v > STILL) - (v < -STILL)

    def _path(self, t: float, y: list[float]) -> Path:
        moved = abs(y[-2] - self.theta0) * self.radius_m if self.mode != 0 else 0.0
        dwell = (
            t - self.stuck_from if self.mode == 0 and self.stuck_from is not None else self.dwell
        )
        angle = self.start_angle + y[-2]
        return Path(self.slid + moved, self.since_rest + moved, dwell, angle)

    def _cell(self, piece: Piece, t: float, y: list[float]) -> float:
        if self.mode == 0:
            held = self._torque(piece, t, y) / self.arm
            return self.chain.cell(y, 0.0, 0, 0.0, self._path(t, y), held)
        v = y[-1] * self.radius_m
        alpha = self._slip_rates(piece, t, y)[-1]
        path = self._path(t, y)
        return self.chain.cell(y, v, self._slip_sign(v), alpha * self.radius_m, path)


def _terminal(
    function: Callable[[float, Vector], float], direction: float
) -> Callable[[float, Vector], float]:
    function.terminal = True  # type: ignore[attr-defined]
    function.direction = direction  # type: ignore[attr-defined]
    return function
