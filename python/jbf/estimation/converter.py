"""What a converter's steps make of a mean reading.

Of a force f with Gaussian noise of s the mean of readings in steps q is off by
`(q / pi) exp(-2 (pi s / q)^2) sin(2 pi f / q)`, its first and largest harmonic (Widrow 1956): a
curve of the force that no sample averages out, and that comes again with the motion.
"""

from __future__ import annotations

import numpy as np


def curve_rms_n(step_n: float, residual_rms_n: float) -> float:
    """RMS of that curve, N; zero without steps.

    Parameters
    ----------
    step_n
        The converter's step, N; zero where it is much finer than the noise.
    residual_rms_n
        RMS of a residual: the noise, and the steps'.
    """
    if step_n <= 0.0:
        return 0.0
    noise = np.sqrt(max(residual_rms_n**2 - step_n**2 / 12.0, 0.0))
    return float(step_n / np.pi * np.exp(-2.0 * (np.pi * noise / step_n) ** 2) / np.sqrt(2.0))
