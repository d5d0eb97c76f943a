"""Motions with known accelerations, read by an encoder and a tachometer."""

import numpy as np
from jbf.records.motion.readings import Readings
from known_motions import Array, quantised

STEP_S, FINE = 0.005, 10
COUNT = 2.0 * np.pi / 4096.0
NOISE = 0.02


def driven(acceleration: Array) -> tuple[Array, Array, Array]:
    """Position, velocity and acceleration at the samples of an acceleration on a finer grid."""
    h = STEP_S / FINE
    velocity = np.concatenate(([0.0], np.cumsum(0.5 * h * (acceleration[1:] + acceleration[:-1]))))
    position = np.concatenate(([0.0], np.cumsum(0.5 * h * (velocity[1:] + velocity[:-1]))))
    return position[::FINE], velocity[::FINE], acceleration[::FINE]


def motion_of(kind: str, samples: int = 3000) -> tuple[Array, Array, Array]:
    """A motion of 15 s: smooth, with corners of the velocity, or with random accelerations."""
    t = np.arange(samples * FINE) * STEP_S / FINE
    if kind == "sine":
        return driven(4.0 * np.cos(2.0 * t))
    if kind == "trapezoids":
        phase = np.mod(t, 3.0)
        up, down = phase < 0.4, (phase > 1.0) & (phase < 1.4)
        return driven(np.where(up, 5.0, 0.0) - np.where(down, 10.0, 0.0) + 5.0 * (phase > 2.6))
    if kind == "saturated steps":
        # A drive at its limit in either direction, and a velocity loop that settles.
        level = np.where(np.mod(t, 2.0) < 1.0, 1.5, -1.5)
        velocity, acceleration = 0.0, np.empty(len(t))
        for k, target in enumerate(level):
            acceleration[k] = np.clip(40.0 * (target - velocity), -12.0, 12.0)
            velocity += acceleration[k] * STEP_S / FINE
        return driven(acceleration)
    random = np.random.default_rng(5)
    knots = random.normal(0.0, 4.0, samples // 40 + 2)
    return driven(np.interp(t, 0.2 * np.arange(len(knots)), knots))


def readings_of(position: Array, velocity: Array, seed: int = 1) -> Readings:
    """An encoder and a tachometer that read a motion."""
    n = len(position)
    noisy = velocity + np.random.default_rng(seed).normal(0.0, NOISE, n)
    return Readings(
        STEP_S * np.arange(n),
        quantised(position, COUNT),
        noisy,
        COUNT**2 / 12.0,
        1e-12,
        np.ones(n),
        np.ones(n),
    )
