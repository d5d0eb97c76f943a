"""A drive with inertia, gravity, viscous and set-valued Coulomb friction, driven tick by tick.

Between two ticks of the controller the torque is constant, so the viscous motion is an exponential
in closed form; a reversal, a stop and a breakaway are events. Gravity is taken at the start of each
piece, and a piece is at most one tick long.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Control = Callable[[int, float, float], float]
"""The torque of a tick, from its number, position and velocity."""


@dataclass(frozen=True)
class Plant:
    """Parameters of a drive; SI units, rotary or linear.

    Attributes
    ----------
    inertia
        kg m^2 or kg.
    coulomb, viscous
        Friction torque, N m, and its slope, N m s/rad (or N, N s/m).
    gravity
        Amplitude of the weight's torque, N m (or N).
    swings
        True where the weight acts with the sine of the angle, False where it is constant.
    """

    inertia: float
    coulomb: float
    viscous: float
    gravity: float
    swings: bool


@dataclass(frozen=True)
class Trajectory:
    """The motion between events: pieces of constant torque without a change of the friction's sign.

    Attributes
    ----------
    time, position, velocity
        At the start of each piece and, last, at the end, shape (n + 1,).
    before, after
        Acceleration at the start and at the end of each piece, shape (n,).
    torque
        The drive's torque in each piece, shape (n,).
    """

    time: Array
    position: Array
    velocity: Array
    before: Array
    after: Array
    torque: Array

    def at(self, instants: Array) -> tuple[Array, Array, Array, Array]:
        """Position, velocity, acceleration and torque at instants, each of shape (n,)."""
        k = np.clip(np.searchsorted(self.time, instants, "right") - 1, 0, len(self.before) - 1)
        h = self.time[k + 1] - self.time[k]
        s = np.clip((instants - self.time[k]) / np.where(h > 0.0, h, 1.0), 0.0, 1.0)
        a0, a1 = self.before[k], self.after[k]
        acceleration = a0 + s * (a1 - a0)
        velocity = self.velocity[k] + h * s * (a0 + 0.5 * s * (a1 - a0))
        position = self.position[k] + h * s * self.velocity[k]
        position += h**2 * s**2 * (0.5 * a0 + s * (a1 - a0) / 6.0)
        return position, velocity, acceleration, self.torque[k]


def run(plant: Plant, control: Control, tick_s: float, ticks: int, start: float) -> Trajectory:
    """Drive a plant from rest at a position."""
    m, f, d = plant.inertia, plant.coulomb, plant.viscous
    t, x, v = 0.0, start, 0.0
    rows: list[tuple[float, float, float, float, float, float]] = []
    for tick in range(ticks):
        u = control(tick, x, v)
        left = tick_s
        while left > 1e-12:
            weight = plant.gravity * (math.sin(x) if plant.swings else 1.0)
            drive = u - weight
            if v == 0.0:
                if abs(drive) <= f:
                    rows.append((t, x, 0.0, 0.0, 0.0, u))
                    t, left = t + left, 0.0
                    continue
                sign = math.copysign(1.0, drive)
            else:
                sign = math.copysign(1.0, v)
            force = drive - sign * f
            a0 = (force - d * v) / m
            last = force / d  # the velocity approached
            h = left
            # Does the velocity reach zero within the piece?
            if v != 0.0 and sign * last < 0.0:
                h = min(left, m / d * math.log1p(-v / last))
            decay = math.exp(-d / m * h)
            ended = last + (v - last) * decay
            if h < left or sign * ended < 0.0:
                ended = 0.0
            rows.append((t, x, v, a0, (force - d * ended) / m, u))
            x += last * h - (v - last) * m / d * math.expm1(-d / m * h)
            t, v, left = t + h, ended, left - h
    columns = np.array(rows).T
    return Trajectory(
        np.append(columns[0], t),
        np.append(columns[1], x),
        np.append(columns[2], v),
        columns[3],
        columns[4],
        columns[5],
    )
