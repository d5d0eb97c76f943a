"""Wrong sign of the friction: the force acts in the direction of the motion, not against it."""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array, Mask
from jbf.records.findings.finding import Finding
from jbf.records.motion.estimated_motion import EstimatedMotion
from jbf.records.run import Run

MIN_SIGMAS = 8.0
"""Smallest force in the direction of the motion, in standard errors."""
SHARE = 0.3
"""Smallest force in the direction of the motion, relative to the standard deviation of the force.

A smaller force may be a residual of the fitted offset, inertia and spring.
"""
JACKKNIFE_BLOCKS = 12
"""Number of blocks of the record for the jackknife standard error."""
LEAST = 100
"""Minimum number of samples in motion; at least a quarter must be in each direction."""
SLOW = 0.02
"""Speed, relative to the top speed, below which the force may have causes other than friction."""


def find_wrong_sign(run: Run, motion: EstimatedMotion, usable: Mask) -> list[Finding]:
    """Report a force with the wrong sign, which acts in the direction of the motion.

    Forces of an offset, an inertia and a spring also act in this direction in part of a record;
    these forces are fitted together with the friction. In a record of one direction, an offset
    cannot be distinguished from friction.
    """
    assert run.friction is not None
    v = motion.velocity
    moves = motion.sign_known & usable & (np.abs(v) > SLOW * float(np.max(np.abs(v))))
    direction = np.sign(v[moves])
    if len(direction) < LEAST or abs(float(np.mean(direction))) > 0.5:
        return []
    path = motion.angle_rad[moves]
    x = np.stack([direction, np.ones(len(direction)), motion.acceleration[moves], path], axis=1)
    scale = np.maximum(np.std(x, axis=0), 1e-12)
    scale[1] = 1.0
    x[:, 2:] -= np.mean(x[:, 2:], axis=0)
    x /= scale
    push, error = _reversing_force(x, run.friction[moves])
    push, error = push / scale[0], error / scale[0]
    if push > -max(MIN_SIGMAS * error, SHARE * float(np.std(run.friction[moves]))):
        return []
    quantities = run.quantities
    words = (
        f"{quantities.friction_column} has the wrong sign: it drives the motion ({-push:.3g} "
        f"{quantities.force}). Positive {quantities.noun} must oppose positive velocity: negate "
        f"{quantities.friction_column}"
    )
    return [Finding("sign", "friction_n", run.name, push, quantities.force, "none", words)]


def _reversing_force(x: Array, force: Array) -> tuple[float, float]:
    """Force that reverses with the motion (fitted with regressors `x`), and its jackknife error."""
    part = np.arange(len(force)) * JACKKNIFE_BLOCKS // len(force)
    normal = np.stack([x[part == k].T @ x[part == k] for k in range(JACKKNIFE_BLOCKS)])
    right = np.stack([x[part == k].T @ force[part == k] for k in range(JACKKNIFE_BLOCKS)])

    def turned(matrix: Array, vector: Array) -> float:
        return float(np.linalg.lstsq(matrix, vector, rcond=1e-10)[0][0])

    total, sums = normal.sum(0), right.sum(0)
    leave_one_out = [turned(total - n, sums - r) for n, r in zip(normal, right, strict=True)]
    return turned(total, sums), float(np.std(leave_one_out)) * np.sqrt(JACKKNIFE_BLOCKS - 1)
