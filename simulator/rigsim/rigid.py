"""Runs with a rigid drive: the journal moves exactly as commanded."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import odeint

from .chain import Chain
from .contact import Path
from .motions import Motion, Piece

RTOL, ATOL = 1e-9, 1e-11
DONE = "Integration successful."
TIGHT = 1e-9  # s; instants closer than this are treated as one


class _Trip:
    """Sliding distance, rests and angle of the journal, accumulated over the pieces of a motion."""

    def __init__(self, radius_m: float, start_angle: float) -> None:
        self.radius_m = radius_m
        self.start_angle = start_angle
        self.done = Path()
        self.rest_from: float | None = None

    def at(self, piece: Piece, t: float) -> Path:
        """Return the history of the motion at time `t` (s), within `piece`."""
        x = piece.position(t)
        moved = abs(x - piece.position(piece.t0))
        done = self.done
        dwell = t - self.rest_from if self.rest_from is not None else done.dwell_s
        angle = self.start_angle + x / self.radius_m
        return Path(done.slid_m + moved, done.since_rest_m + moved, dwell, angle)

    def enter(self, piece: Piece) -> None:
        """Begin `piece`: a rest starts the dwell time, and the next motion ends it."""
        if piece.sign == 0:
            if self.rest_from is None:
                self.rest_from = piece.t0
            self.done.since_rest_m = 0.0
        elif self.rest_from is not None:
            self.done.dwell_s = piece.t0 - self.rest_from
            self.done.since_rest_m = 0.0
            self.rest_from = None

    def leave(self, piece: Piece) -> None:
        """End `piece`: add its distance and its duration to the accumulated ones."""
        self.done = self.at(piece, piece.t1)


def run_rigid(
    chain: Chain, motion: Motion, times: NDArray[np.float64], radius_m: float, start_angle: float
) -> NDArray[np.float64]:
    """Simulate a run; return the force on the load cell (N) at `times` (s).

    Offset and drift are not included.
    """
    force = np.zeros(len(times))
    first = motion.pieces[0]
    v, a = first.speed(0.0), first.acceleration(0.0)
    trip = _Trip(radius_m, start_angle)
    y = np.array(chain.start(v, a, trip.at(first, 0.0)))
    absolute = np.full(chain.size, ATOL)
    if chain.bristle_at >= 0:
        absolute[chain.bristle_at] = 1e-13
    for piece in motion.pieces:
        trip.enter(piece)
        last = piece is motion.pieces[-1]
        inside = (times >= piece.t0) & ((times < piece.t1) | last)
        between = times[(times > piece.t0 + TIGHT) & (times < piece.t1 - TIGHT)]
        grid = np.concatenate([[piece.t0], between, [piece.t1]])

        def rates(t: float, y: NDArray[np.float64], piece: Piece = piece) -> list[float]:
            state = y.tolist()
            v, a = piece.speed(t), piece.acceleration(t)
            return chain.rates(state, v, piece.sign, a, trip.at(piece, t))

        # LSODA refuses a piece if rounding carries its last step beyond the end: move the end.
        for beyond in (1e-7, 2e-7):
            states, info = odeint(
                rates,
                y,
                grid,
                tfirst=True,
                rtol=RTOL,
                atol=absolute,
                tcrit=[piece.t1 + beyond],
                mxstep=100_000,
                full_output=True,
            )
            if info["message"] == DONE:
                break
        if info["message"] != DONE:
            raise RuntimeError(f"{motion.name}, piece from {piece.t0} s: {info['message']}")
        rows = np.searchsorted(grid, times[inside] - TIGHT)
        for i, row in zip(np.flatnonzero(inside), rows, strict=True):
            t = float(times[i])
            v = piece.speed(t)
            sign = piece.sign if abs(v) > 1e-12 else 0
            path = trip.at(piece, t)
            force[i] = chain.cell(states[row].tolist(), v, sign, piece.acceleration(t), path)
        y = states[-1]
        trip.leave(piece)
    return force
