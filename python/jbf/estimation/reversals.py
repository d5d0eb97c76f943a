"""Prediction error due to the uncertain time of a reversal.

If the motion reverses slowly, the error of the speed moves the time at which friction jumps, by the
standard error of the speed over the acceleration. The samples within which the jump may lie do not
count (`Samples`). A sensor with lag spreads the jump over its time constant, and the error of the
time with it. The resulting error in newtons is the change of the reading during that time.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.estimation.prepared import Prepared

Array = npt.NDArray[np.float64]

MOST = 0.29
"""Standard deviation of a uniform position between two samples, relative to their distance.

It follows from the estimator.
"""


def instant_errors_n(p: Prepared, prediction: Array, least_n: float) -> Array:
    """Standard error of a prediction (N) after each reversal, due to the error of its time.

    Shape (n,); zero elsewhere, and from where the error falls below `least_n`.
    """
    motion, time_s = p.motion, p.run.time_s
    found = np.zeros(len(prediction))
    if len(prediction) < 3:
        return found
    rate_n_s = np.abs(np.gradient(prediction, time_s))
    befores, afters = _reversals(p)
    for k, (before, after) in enumerate(zip(befores, afters, strict=True)):
        between_s = float(time_s[after] - time_s[before])
        slope = float(abs(motion.velocity[after] - motion.velocity[before])) / between_s
        error = float(np.max(motion.velocity_error_m_s[before : after + 1]))
        error_s = min(error / slope, MOST * between_s)
        last = befores[k + 1] if k + 1 < len(befores) else len(prediction)
        behind_n = error_s * rate_n_s[before + 1 : last + 1]
        # The error decays from where the sign is known again.
        small = np.flatnonzero(behind_n[after - before - 1 :] < least_n)
        if len(small):
            behind_n = behind_n[: after - before - 1 + int(small[0])]
        found[before + 1 : before + 1 + len(behind_n)] = behind_n
    return found


def _reversals(p: Prepared) -> tuple[list[int], list[int]]:
    """Last samples before each reversal, and first samples after it.

    Only reversals without a rest in between are included.
    """
    motion = p.motion
    known = np.flatnonzero(motion.sign_known & ~motion.resting & (motion.velocity != 0.0))
    turned = np.flatnonzero(np.diff(np.sign(motion.velocity[known])) != 0.0)
    befores, afters = known[turned], known[turned + 1]
    rests = np.concatenate(([0], np.cumsum(motion.resting)))
    moving = rests[afters] == rests[befores]
    return befores[moving].tolist(), afters[moving].tolist()
