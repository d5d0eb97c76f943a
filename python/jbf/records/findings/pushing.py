"""A friction that pushes: its sign turned, the force drives the motion that it should brake."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.records.findings.finding import Finding
from jbf.records.motion.imposed import ImposedMotion
from jbf.records.run import Run

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

SURE = 8.0
"""Standard errors by which the force must push,"""
SHARE = 0.3
"""and share of the force's own swing: what offset, inertia and a spring leave is not a sign."""
STRETCHES = 12
"""Parts of the record that are left out in turn, for the error."""
LEAST = 100
"""Samples of motion that tell something, a quarter of them each way."""
SLOW = 0.02
"""Share of the top speed below which a force need not be friction's."""


def find_pushing(run: Run, motion: ImposedMotion, usable: Mask) -> list[Finding]:
    """A force that goes with the motion, whichever way that is.

    An offset, a mass and a spring push at times as well: their forces are fitted beside the one
    that turns with the motion. A record of one direction cannot tell an offset from friction.
    """
    assert run.friction_n is not None
    v = motion.velocity_m_s
    moves = motion.sign_known & usable & (np.abs(v) > SLOW * float(np.max(np.abs(v))))
    way = np.sign(v[moves])
    if len(way) < LEAST or abs(float(np.mean(way))) > 0.5:
        return []
    path = motion.angle_rad[moves]
    x = np.stack([way, np.ones(len(way)), motion.acceleration_m_s2[moves], path], axis=1)
    scale = np.maximum(np.std(x, axis=0), 1e-12)
    scale[1] = 1.0
    x[:, 2:] -= np.mean(x[:, 2:], axis=0)
    x /= scale
    push, error = _with_way(x, run.friction_n[moves])
    push, error = push / scale[0], error / scale[0]
    if push > -max(SURE * error, SHARE * float(np.std(run.friction_n[moves]))):
        return []
    said = run.quantities
    words = (
        f"the {said.noun} goes with the motion, by {-push:.3g} {said.force}: "
        f"{said.friction_column} is against it where it is "
        "positive with a positive speed; turn its sign, or the speed's and the position's"
    )
    return [Finding("sign", "friction_n", run.name, push, said.force, "none", words)]


def _with_way(x: Array, force: Array) -> tuple[float, float]:
    """The force that turns with the motion, and its standard error from stretches left out."""
    part = np.arange(len(force)) * STRETCHES // len(force)
    normal = np.stack([x[part == k].T @ x[part == k] for k in range(STRETCHES)])
    right = np.stack([x[part == k].T @ force[part == k] for k in range(STRETCHES)])

    def turned(matrix: Array, vector: Array) -> float:
        return float(np.linalg.lstsq(matrix, vector, rcond=1e-10)[0][0])

    whole, sums = normal.sum(0), right.sum(0)
    left = [turned(whole - n, sums - r) for n, r in zip(normal, right, strict=True)]
    return turned(whole, sums), float(np.std(left)) * np.sqrt(STRETCHES - 1)
