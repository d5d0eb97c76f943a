"""A recorded speed that was made of the recorded path: a difference of counts over some samples.

Such a speed is redundant, comes in coarse steps, and is late where the difference looks back. It is
identified where it equals the difference within 5 % of its own step in 90 % of the samples in
motion.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.records.findings.finding import Finding
from jbf.records.motion.roughness import noise_of, quantum_of, step_of

Array = npt.NDArray[np.float64]

SPANS = range(1, 13)
"""Differences over so many samples are looked for."""
USUAL = 0.95
"""Quantile that stands for the largest speed; a few percent of it are motion."""
ALIKE = 0.9
"""Share of the samples in motion at which the speed must be the difference."""
TO = 0.05
"""A speed is the difference where it is so near to it, as a share of its own coarse step."""
COARSE = 3.0
"""A difference that is smoother than so many times that is as good as a measured speed."""


def derived_speed(name: str, time: Array, path: Array, speed: Array) -> Finding | None:
    """A finding where a speed is a difference of the path; None where it was measured."""
    if len(time) < 4 * SPANS[-1]:
        return None
    step = quantum_of(path) or step_of(path)
    # Over some samples: a slow difference is zero between two counts. And not of the largest one:
    # messages that arrive at once make a difference without bounds.
    local = np.convolve(np.abs(speed), np.ones(SPANS[-1]) / SPANS[-1], "same")
    moving = local > 0.02 * float(np.quantile(np.abs(speed), USUAL))
    usual = float(np.median(np.diff(time)))
    for span in SPANS:
        difference = (path[span:] - path[:-span]) / (time[span:] - time[:-span])
        tolerance = TO * step / (span * usual)
        middle = moving[span // 2 : span // 2 + len(difference)]
        if noise_of(difference[middle]) < COARSE * tolerance:
            continue
        # Looking back, and to both sides.
        for after in sorted({0, span // 2}):
            where = slice(span - after, len(time) - after)
            kept = moving[where]
            if kept.sum() < 50:
                continue
            near = np.abs(speed[where] - difference)[kept] <= tolerance
            if near.mean() > ALIKE:
                return _finding(name, span, (0.5 * span - after) * usual)
    return None


def _finding(name: str, span: int, late_s: float) -> Finding:
    words = f"the speed is a difference of the path over {span} samples"
    if late_s > 0.0:
        words += f", {1e3 * late_s:.3g} ms late"
    done = "left aside; the path alone tells the motion"
    return Finding("coarse_speed", "velocity_m_s", name, float(span), "samples", done, words)


def centred_speed(time: Array, path: Array) -> Array:
    """A speed of the path alone that is not late: what a rest is known by."""
    found: Array = np.gradient(path, time)
    return found
