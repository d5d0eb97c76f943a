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
"""Standard deviation of a place somewhere in a stretch, as a share of it."""


def instant_errors_n(p: Prepared, prediction: Array, least_n: float) -> Array:
    """Standard error of a prediction (N) behind each reversal whose instant is not known to the
    sample, until it is less than `least_n`; zero elsewhere, shape (n,)."""
    motion = p.motion
    found = np.zeros(len(prediction))
    if len(prediction) < 3:
        return found
    rate_n_s = np.abs(np.gradient(prediction, p.run.time_s))
    unknown = np.flatnonzero(np.diff(np.concatenate(([0], ~motion.sign_known, [0])).astype(int)))
    for first, end in zip(unknown[::2], unknown[1::2], strict=True):
        if first == 0 or end == len(prediction) or motion.resting[first - 1 : end + 1].any():
            continue
        velocity = motion.velocity_m_s[first - 1 : end + 1]
        if velocity[0] * velocity[-1] >= 0.0:
            continue
        # The jump lies somewhere between two samples whose signs are known.
        lasts_s = float(p.run.time_s[end] - p.run.time_s[first - 1])
        slope = abs(float(velocity[-1] - velocity[0])) / lasts_s
        error = float(np.max(motion.velocity_error_m_s[first:end]))
        error_s = min(error / slope, MOST * lasts_s)
        behind = error_s * rate_n_s[first:]
        small = np.flatnonzero(behind[end - first :] < least_n)
        last = end - first + (int(small[0]) if len(small) else len(behind))
        found[first : first + last] = np.maximum(found[first : first + last], behind[:last])
    return found
