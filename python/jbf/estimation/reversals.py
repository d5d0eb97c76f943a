"""What the instant of a reversal costs, where it is known no better than the speed is.

Where the motion turns round slowly, the speed's own error moves the instant at which friction
jumps: by its standard error over the acceleration. The samples within which the jump may lie do
not count (`Samples`). An instrument that follows late spreads the jump over its memory, and with it
the error of the instant: so many newtons as the reading moves in that time.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.estimation.prepared import Prepared

Array = npt.NDArray[np.float64]

MOST = 0.29
"""Standard deviation of a place somewhere between two samples, as a share of their distance."""


def instant_errors_n(p: Prepared, prediction: Array, least_n: float) -> Array:
    """Standard error of a prediction (N) behind each reversal, from its instant's, until it is less
    than `least_n`; zero elsewhere, shape (n,)."""
    motion, time_s = p.motion, p.run.time_s
    found = np.zeros(len(prediction))
    if len(prediction) < 3:
        return found
    rate_n_s = np.abs(np.gradient(prediction, time_s))
    befores, afters = _reversals(p)
    for k, (before, after) in enumerate(zip(befores, afters, strict=True)):
        between_s = float(time_s[after] - time_s[before])
        slope = float(abs(motion.velocity_m_s[after] - motion.velocity_m_s[before])) / between_s
        error = float(np.max(motion.velocity_error_m_s[before : after + 1]))
        error_s = min(error / slope, MOST * between_s)
        last = befores[k + 1] if k + 1 < len(befores) else len(prediction)
        behind_n = error_s * rate_n_s[before + 1 : last + 1]
        # It dies away from where the sign is known again.
        small = np.flatnonzero(behind_n[after - before - 1 :] < least_n)
        if len(small):
            behind_n = behind_n[: after - before - 1 + int(small[0])]
        found[before + 1 : before + 1 + len(behind_n)] = behind_n
    return found


def _reversals(p: Prepared) -> tuple[list[int], list[int]]:
    """The last samples of one sign before each reversal, and the first of the other after it, where
    the motion does not rest between."""
    motion = p.motion
    known = np.flatnonzero(motion.sign_known & ~motion.resting & (motion.velocity_m_s != 0.0))
    turned = np.flatnonzero(np.diff(np.sign(motion.velocity_m_s[known])) != 0.0)
    befores, afters = known[turned], known[turned + 1]
    rests = np.concatenate(([0], np.cumsum(motion.resting)))
    moving = rests[afters] == rests[befores]
    return befores[moving].tolist(), afters[moving].tolist()
