"""Closed loops and their references: the six kinds of motion."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from servosim.plant import Control, Plant

Array = npt.NDArray[np.float64]

KINDS = ("steps", "trapezoids", "point_to_point", "jog", "soft", "hand")


@dataclass(frozen=True)
class Demand:
    """Speed, acceleration and torque that a motion requires.

    Attributes
    ----------
    top
        Largest velocity, rad/s or m/s.
    acceleration
        rad/s^2 or m/s^2.
    limit
        Largest torque of the drive.
    """

    top: float
    acceleration: float
    limit: float


def control_of(
    kind: str,
    plant: Plant,
    demand: Demand,
    tick_s: float,
    ticks: int,
    start: float,
    random: np.random.Generator,
) -> Control:
    """Return a controller for one run of the given kind."""
    if kind == "hand":
        return _hand(plant, demand, tick_s, ticks, random)
    # Lists: arithmetic with elements of arrays is slow.
    position, velocity = (
        reference.tolist() for reference in _reference(kind, demand, tick_s, ticks, start, random)
    )
    stiffness = 2.0 * math.pi * random.uniform(2.0, 6.0)
    bandwidth = 2.0 * math.pi * random.uniform(15.0, 40.0)
    integral = 0.0 if kind in ("point_to_point", "soft") else bandwidth / random.uniform(0.1, 0.3)
    if kind == "soft":
        stiffness, bandwidth = 2.0 * math.pi * 0.8, 2.0 * math.pi * random.uniform(2.0, 5.0)
    if kind == "jog":
        stiffness = 0.0
    gain, limit = plant.inertia * bandwidth, demand.limit
    total = 0.0

    def control(tick: int, x: float, v: float) -> float:
        nonlocal total
        error = stiffness * (position[tick] - x) + velocity[tick] - v
        command = gain * error + total
        if abs(command) < limit:
            total += gain * integral * 0.1 * error * tick_s
        return max(-limit, min(limit, command))

    return control


def _reference(
    kind: str,
    demand: Demand,
    tick_s: float,
    ticks: int,
    start: float,
    random: np.random.Generator,
) -> tuple[Array, Array]:
    """Return the reference position and velocity at each tick of the controller."""
    top, ramp = demand.top, demand.acceleration
    velocity = np.zeros(ticks)
    t, side = int(0.2 / tick_s), 1.0
    if kind == "steps":
        position = np.full(ticks, start)
        while t < ticks:
            target = start + side * random.uniform(0.1, 0.5) * top
            position[t:] = target
            t, side = t + int(random.uniform(0.5, 1.2) / tick_s), -side
        return position, velocity
    if kind == "soft":
        time = tick_s * np.arange(ticks)
        slow, fast = random.uniform(0.3, 0.6), random.uniform(1.0, 2.0)
        position = start + 0.6 * top * np.sin(2.0 * math.pi * slow * time)
        position += 0.15 * top * np.sin(2.0 * math.pi * fast * time)
        return position, np.gradient(position, tick_s)
    while t < ticks:
        speed = side * top * random.uniform(0.3, 1.0)
        if kind == "jog":
            hold = int(random.uniform(0.1, 0.5) / tick_s)
            velocity[t : t + hold] = speed
            t += hold
            side = -side if random.random() < 0.7 else side
            continue
        up = max(int(abs(speed) / (ramp * random.uniform(0.5, 1.0)) / tick_s), 1)
        hold = int(random.uniform(0.05, 0.6) / tick_s)
        shape = speed * np.interp(
            np.arange(2 * up + hold), [0, up, up + hold, 2 * up + hold], [0.0, 1.0, 1.0, 0.0]
        )
        shape = shape[: ticks - t]
        velocity[t : t + len(shape)] = shape
        rest = random.uniform(0.3, 1.0) if kind == "point_to_point" else random.uniform(0.0, 0.1)
        t, side = t + len(shape) + int(rest / tick_s), -side
    return start + tick_s * np.cumsum(velocity), velocity


def _hand(
    plant: Plant, demand: Demand, tick_s: float, ticks: int, random: np.random.Generator
) -> Control:
    """Return the controller for a human hand that tracks a smooth random motion inaccurately."""
    knots = random.normal(0.0, 0.6 * demand.top, int(ticks * tick_s / 0.25) + 3)
    time = np.arange(ticks) * tick_s / 0.25
    k = np.minimum(time.astype(int), len(knots) - 3)
    s = time - k
    smooth = s * s * (3.0 - 2.0 * s)
    target = (knots[k] * (1.0 - smooth) + knots[k + 1] * smooth).tolist()
    gain = plant.inertia * 2.0 * math.pi * 3.0

    def control(tick: int, x: float, v: float) -> float:
        # A hand carries the weight and overcomes the friction that it feels.
        carried = plant.gravity * (math.sin(x) if plant.swings else 1.0)
        friction = plant.coulomb * math.tanh(20.0 * target[tick] / demand.top)
        return carried + friction + plant.viscous * v + gain * (target[tick] - v)

    return control
