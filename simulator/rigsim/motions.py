"""Commanded motions, divided into pieces with a smooth speed of one sign."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

Curve = Callable[[float], float]


@dataclass(frozen=True)
class Piece:
    """Piece of a motion from `t0` to `t1` (s), with a smooth speed of one sign.

    It returns surface speed, position and acceleration (SI units).
    """

    t0: float
    t1: float
    speed: Curve
    position: Curve
    acceleration: Curve
    sign: int


@dataclass(frozen=True)
class Motion:
    """Commanded surface motion of the journal, from 0 to `duration_s`."""

    name: str
    duration_s: float
    pieces: tuple[Piece, ...]


def _sign(value: float) -> int:
    return (value > 0.0) - (value < 0.0)


def _cut(
    t0: float, t1: float, speed: Curve, position: Curve, acceleration: Curve, zeros: Sequence[float]
) -> list[Piece]:
    edges = [t0, *[z for z in sorted(zeros) if t0 + 1e-9 < z < t1 - 1e-9], t1]
    return [
        Piece(a, b, speed, position, acceleration, _sign(speed(0.5 * (a + b))))
        for a, b in pairwise(edges)
    ]


def multisine(
    name: str, duration_s: float, tones: Sequence[tuple[float, float, float]], bias: float = 0.0
) -> Motion:
    """Create a motion with the speed `bias + sum A sin(w t + p)`.

    `tones` are (A m/s, w rad/s, p rad).
    """
    start = sum(-a / w * math.cos(p) for a, w, p in tones)

    def speed(t: float) -> float:
        return bias + sum(a * math.sin(w * t + p) for a, w, p in tones)

    def position(t: float) -> float:
        return bias * t - start - sum(a / w * math.cos(w * t + p) for a, w, p in tones)

    def acceleration(t: float) -> float:
        return sum(a * w * math.cos(w * t + p) for a, w, p in tones)

    fastest = max(w for _, w, _ in tones)
    grid = np.arange(0.0, duration_s, 0.05 / fastest) + 1e-7
    values = [speed(float(t)) for t in grid]
    zeros = [
        float(brentq(speed, grid[i], grid[i + 1], xtol=1e-14))
        for i in range(len(grid) - 1)
        if values[i] * values[i + 1] < 0.0
    ]
    pieces = _cut(0.0, duration_s, speed, position, acceleration, zeros)
    return Motion(name, duration_s, tuple(pieces))


def sine(name: str, duration_s: float, amplitude: float, omega: float, bias: float = 0.0) -> Motion:
    """Create a motion with the speed `bias + amplitude sin(omega t)` (m/s, rad/s)."""

    def speed(t: float) -> float:
        return bias + amplitude * math.sin(omega * t)

    def position(t: float) -> float:
        return bias * t + amplitude / omega * (1.0 - math.cos(omega * t))

    def acceleration(t: float) -> float:
        return amplitude * omega * math.cos(omega * t)

    zeros: list[float] = []
    if abs(bias) < abs(amplitude):
        first = math.asin(-bias / amplitude)
        for k in range(-1, int(duration_s * omega / (2.0 * math.pi)) + 2):
            zeros.append((first + 2.0 * math.pi * k) / omega)
            zeros.append((math.pi - first + 2.0 * math.pi * k) / omega)
    pieces = _cut(0.0, duration_s, speed, position, acceleration, zeros)
    return Motion(name, duration_s, tuple(pieces))


def _ramp(t0: float, v0: float, v1: float, t1: float, x0: float) -> tuple[Curve, Curve, Curve]:
    slope = (v1 - v0) / (t1 - t0)

    def speed(t: float) -> float:
        return v0 + slope * (t - t0)

    def position(t: float) -> float:
        return x0 + (v0 + 0.5 * slope * (t - t0)) * (t - t0)

    def acceleration(_t: float) -> float:
        return slope

    return speed, position, acceleration


def polyline(name: str, knots: Sequence[tuple[float, float]]) -> Motion:
    """Create a motion whose speed is linear between `knots` (time s, speed m/s).

    Two adjacent knots with zero speed define a rest.
    """
    pieces: list[Piece] = []
    x = 0.0
    for (t0, v0), (t1, v1) in pairwise(knots):
        if t1 <= t0:
            raise ValueError(f"motion {name}: knots must move forward in time, got {t0} then {t1}")
        speed, position, acceleration = _ramp(t0, v0, v1, t1, x)
        zeros = [t0 - v0 * (t1 - t0) / (v1 - v0)] if v0 * v1 < 0.0 else []
        pieces += _cut(t0, t1, speed, position, acceleration, zeros)
        x = position(t1)
    return Motion(name, knots[-1][0], tuple(pieces))


def triangle(name: str, duration_s: float, amplitude: float, omega: float) -> Motion:
    """Create a motion with a triangular speed that starts at zero.

    Its peak is `amplitude` (m/s), and its period 2 pi/omega.
    """
    quarter = 0.5 * math.pi / omega
    heights = (0.0, amplitude, 0.0, -amplitude)
    knots = [(0.0, 0.0)]
    while knots[-1][0] < duration_s:
        k = len(knots)
        knots.append((k * quarter, heights[k % 4]))
    (ta, va), (tb, vb) = knots[-2], knots[-1]
    knots[-1] = (duration_s, va + (vb - va) * (duration_s - ta) / (tb - ta))
    return polyline(name, knots)


def stop_and_go(
    name: str,
    moves: Sequence[tuple[float, float]],
    top: float,
    ramp_s: float,
    plateau_s: float,
    duration_s: float,
) -> Motion:
    """Create a motion of trapezoidal moves with the speed `top` (m/s) and rests between them.

    `moves` contains start (s) and direction (+1 or -1) of each move.
    """
    knots = [(0.0, 0.0)]
    for start, direction in moves:
        if start > knots[-1][0]:
            knots.append((start, 0.0))
        knots.append((start + ramp_s, direction * top))
        knots.append((start + ramp_s + plateau_s, direction * top))
        knots.append((start + 2.0 * ramp_s + plateau_s, 0.0))
    if duration_s > knots[-1][0]:
        knots.append((duration_s, 0.0))
    return polyline(name, knots)


def steps(name: str, speeds: Sequence[float], hold_s: float, ramp_s: float = 0.5) -> Motion:
    """Create a motion of constant speeds (m/s) for `hold_s` each, joined by ramps.

    The motion begins and ends at rest.
    """
    knots = [(0.0, 0.0)]
    for v in speeds:
        knots.append((knots[-1][0] + ramp_s, v))
        knots.append((knots[-1][0] + hold_s, v))
    knots.append((knots[-1][0] + ramp_s, 0.0))
    return polyline(name, knots)


def sweep(name: str, top: float, rise_s: float) -> Motion:
    """Create a slow sweep from rest to `top` (m/s) in `rise_s` and back, for a Stribeck curve."""
    return polyline(name, [(0.0, 0.0), (rise_s, top), (2.0 * rise_s, 0.0)])
