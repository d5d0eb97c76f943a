"""Drive with inertia, gravity, viscous and set-valued Coulomb friction, integrated exactly.

Between two instants (ticks) of the controller the torque is constant, so the viscous motion is an
exponential in closed form. Reversals, stops and breakaways are events. Gravity and hidden effects
are evaluated in the middle of each piece, which is at most one tick long.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from servosim.hidden import NOTHING, Course, Together

Array = npt.NDArray[np.float64]
Control = Callable[[int, float, float], float]
"""Controller: function that returns the torque from the number of the tick, position, velocity."""


@dataclass(frozen=True)
class Plant:
    """Parameters of a drive in SI units, rotary or linear.

    Attributes
    ----------
    inertia
        kg m^2 or kg.
    coulomb, viscous
        Friction torque, N m, and its slope, N m s/rad (or N, N s/m).
    gravity
        Amplitude of the torque due to the weight, N m (or N).
    swings
        Whether the weight acts with the sine of the angle; otherwise it is constant.
    hidden
        Additional friction and forces.
    """

    inertia: float
    coulomb: float
    viscous: float
    gravity: float
    swings: bool
    hidden: Together = NOTHING


@dataclass(frozen=True)
class Trajectory:
    """Simulated motion in pieces of constant torque and constant sign of the friction.

    Attributes
    ----------
    time, position, velocity
        Values at the start of each piece and, last, at the end, shape (n + 1,).
    before, after
        Acceleration at the start and at the end of each piece, shape (n,).
    torque
        Torque of the drive in each piece, shape (n,).
    """

    time: Array
    position: Array
    velocity: Array
    before: Array
    after: Array
    torque: Array

    def at(self, instants: Array) -> tuple[Array, Array, Array, Array]:
        """Return position, velocity, acceleration and torque at instants, each of shape (n,)."""
        k = np.clip(np.searchsorted(self.time, instants, "right") - 1, 0, len(self.before) - 1)
        h = self.time[k + 1] - self.time[k]
        s = np.clip((instants - self.time[k]) / np.where(h > 0.0, h, 1.0), 0.0, 1.0)
        a0, a1 = self.before[k], self.after[k]
        acceleration = a0 + s * (a1 - a0)
        velocity = self.velocity[k] + h * s * (a0 + 0.5 * s * (a1 - a0))
        position = self.position[k] + h * s * self.velocity[k]
        position += h**2 * s**2 * (0.5 * a0 + s * (a1 - a0) / 6.0)
        return position, velocity, acceleration, self.torque[k]


def run(
    plant: Plant,
    control: Control,
    tick_s: float,
    ticks: int,
    start: float,
    random: np.random.Generator | None = None,
) -> Trajectory:
    """Simulate a plant that starts at rest at a position.

    `random` draws the quantities that vary from run to run.
    """
    m = plant.inertia
    random = np.random.default_rng(0) if random is None else random
    at = Course(0.0, start, 0.0, 0, random.uniform(0.0, 2.0 * math.pi), [])
    at.scatter = random.normal(size=64).tolist()
    direction = 0.0
    rows: list[tuple[float, float, float, float, float, float]] = []
    for tick in range(ticks):
        u = control(tick, at.position, at.velocity)
        remaining_s = tick_s
        while remaining_s > 1e-12:
            t, x, v = at.time, at.position, at.velocity
            held, drive = _held(plant, at), u - _push(plant, at)
            sign = math.copysign(1.0, drive if v == 0.0 else v)
            if sign != direction and (v != 0.0 or direction == 0.0):
                at.strokes, direction = at.strokes + (direction != 0.0), sign
            if v == 0.0 and abs(drive) <= held:
                rows.append((t, x, 0.0, 0.0, 0.0, u))
                at.time, remaining_s = t + remaining_s, 0.0
                continue
            force, damping = _sliding(plant, at, u, sign)
            half_s, a0 = 0.5 * remaining_s, (force - damping * v) / m
            middle = Course(
                time=t + half_s,
                position=x + half_s * (v + 0.5 * half_s * a0),
                velocity=v + half_s * a0,
                strokes=at.strokes,
                phase=at.phase,
                scatter=at.scatter,
            )
            if sign * middle.velocity > 0.0:
                force, damping = _sliding(plant, middle, u, sign)
            a0 = (force - damping * v) / m
            last = force / damping  # the velocity approached
            h = remaining_s
            # Does the velocity reach zero within the piece?
            if v != 0.0 and sign * last < 0.0:
                h = min(remaining_s, m / damping * math.log1p(-v / last))
            decay = math.exp(-damping / m * h)
            ended = last + (v - last) * decay
            if h < remaining_s or sign * ended < 0.0:
                ended = 0.0
            rows.append((t, x, v, a0, (force - damping * ended) / m, u))
            at.position += last * h - (v - last) * m / damping * math.expm1(-damping / m * h)
            at.time, at.velocity, remaining_s = t + h, ended, remaining_s - h
    columns = np.array(rows).T
    return Trajectory(
        np.append(columns[0], at.time),
        np.append(columns[1], at.position),
        np.append(columns[2], at.velocity),
        columns[3],
        columns[4],
        columns[5],
    )


def _weight(plant: Plant, at: Course) -> float:
    """Force of the weight, N m or N."""
    return plant.gravity * (math.sin(at.position) if plant.swings else 1.0)


def _push(plant: Plant, at: Course) -> float:
    """Weight and hidden forces that do not depend on the direction of motion, N m or N."""
    return _weight(plant, at) + plant.hidden.push(at)


def _coulomb(plant: Plant, at: Course) -> float:
    """Friction at the present speed without its viscous part, N m or N."""
    return plant.hidden.factor(at) * (plant.coulomb + plant.hidden.level(at))


def _held(plant: Plant, at: Course) -> float:
    """Largest force, N m or N, that friction holds at rest."""
    return _coulomb(plant, at) + plant.hidden.lost_share() * abs(_weight(plant, at))


def _sliding(plant: Plant, at: Course, u: float, sign: float) -> tuple[float, float]:
    """Force on the mass without viscous friction (N m or N), and the slope of this friction.

    `u` is the force of the drive, and `sign` the direction of motion. The force contains all
    friction except the part proportional to speed.
    """
    hidden, d, v = plant.hidden, plant.viscous, at.velocity
    factor = hidden.factor(at)
    extra = factor * (hidden.viscous_factor(at) * (d * v + hidden.drag(at)) - d * v)
    slope = factor * d
    net = u - hidden.push(at) - sign * _coulomb(plant, at) - extra
    # Losses are a share of the transmitted force: that of the weight and of the mass.
    through = 1.0 + sign * math.copysign(hidden.lost_share(), net - slope * v)
    return net / through - _weight(plant, at), slope / through
