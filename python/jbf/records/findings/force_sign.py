"""Wrong sign of the friction: the force drives the motion instead of opposing it."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.records.findings.finding import Finding
from jbf.records.motion.estimated_motion import EstimatedMotion
from jbf.records.run import Run

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

SURE = 8.0
"""Standard errors by which the force must drive the motion."""
SHARE = 0.3
"""Least driving force relative to the standard deviation of the force.

A smaller one may remain from offset, inertia and a spring.
"""
STRETCHES = 12
"""Number of parts of the record that are left out in turn, for the standard error."""
LEAST = 100
"""Least number of samples in motion; at least a quarter of them in each direction."""
SLOW = 0.02
"""Share of the top speed below which the force may be due to other causes than friction."""


def find_wrong_sign(run: Run, motion: EstimatedMotion, usable: Mask) -> list[Finding]:
    """Find a force that acts in the direction of the motion.

    An offset, an inertia and a spring also act in this direction at times; their forces are fitted
    together with the friction. A record of one direction cannot separate an offset from friction.
    """
    assert run.friction is not None
    v = motion.velocity
    moves = motion.sign_known & usable & (np.abs(v) > SLOW * float(np.max(np.abs(v))))
    way = np.sign(v[moves])
    if len(way) < LEAST or abs(float(np.mean(way))) > 0.5:
        return []
    path = motion.angle_rad[moves]
    x = np.stack([way, np.ones(len(way)), motion.acceleration[moves], path], axis=1)
    scale = np.maximum(np.std(x, axis=0), 1e-12)
    scale[1] = 1.0
    x[:, 2:] -= np.mean(x[:, 2:], axis=0)
    x /= scale
    push, error = _reversing_force(x, run.friction[moves])
    push, error = push / scale[0], error / scale[0]
    if push > -max(SURE * error, SHARE * float(np.std(run.friction[moves]))):
        return []
    said = run.quantities
    words = (
        f"{said.friction_column} has the wrong sign: it drives the motion ({-push:.3g} "
        f"{said.force}). Positive {said.noun} must oppose positive velocity: negate "
        f"{said.friction_column}"
    )
    return [Finding("sign", "friction_n", run.name, push, said.force, "none", words)]


def _reversing_force(x: Array, force: Array) -> tuple[float, float]:
    """Return the force that reverses with the motion, and its standard error by the jackknife."""
    part = np.arange(len(force)) * STRETCHES // len(force)
    normal = np.stack([x[part == k].T @ x[part == k] for k in range(STRETCHES)])
    right = np.stack([x[part == k].T @ force[part == k] for k in range(STRETCHES)])

    def turned(matrix: Array, vector: Array) -> float:
        return float(np.linalg.lstsq(matrix, vector, rcond=1e-10)[0][0])

    whole, sums = normal.sum(0), right.sum(0)
    left = [turned(whole - n, sums - r) for n, r in zip(normal, right, strict=True)]
    return turned(whole, sums), float(np.std(left)) * np.sqrt(STRETCHES - 1)
