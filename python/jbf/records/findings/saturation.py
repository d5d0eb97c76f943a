"""Saturation: readings of the force at the end of its range."""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array, Mask
from jbf.records.findings.finding import Finding
from jbf.records.findings.steps import step_of
from jbf.records.run import Run

MIN_READINGS = 5
"""Minimum number of identical readings at an extreme value of a noisy channel."""
MIN_LEVEL_RATIO = 2.0
"""Minimum ratio of the number of readings at the extreme level to that at adjacent levels."""
ADJACENT_LEVELS = 3
"""Number of levels next to the extreme that are compared."""
MIN_NOISE_STEPS = 0.6
"""Noise, in quantisation steps, below which a plateau is one level without saturation."""
MIN_QUARTILE_RATIO = 0.2
"""Lower quartile of the third differences of noise over their median; 0.47 for white noise."""
MIN_ROUGHNESS = 1.2
"""Ratio of third to second differences of noise: 1.8 for white noise, less than one for a curve."""
EXCLUDED_SAMPLES = 15
"""Window around a saturated sample that is excluded, samples.

The unclipped readings in this window are a selection of the lower values, and would bias the force.
"""


def saturated(values: Array) -> tuple[Mask, list[float]]:
    """Mask of the samples near saturated readings, and the saturated values."""
    from scipy import ndimage  # importing takes most of a second

    mask = np.zeros(len(values), dtype=bool)
    ends: list[float] = []
    noise = _noise(values)
    if noise == 0.0 or noise < MIN_NOISE_STEPS * step_of(values):
        return mask, ends
    for sign in (1.0, -1.0):
        levels, counts = np.unique(-sign * values, return_counts=True)
        at = sign * values == -levels[0]
        if counts[0] >= max(
            MIN_READINGS, MIN_LEVEL_RATIO * np.max(counts[1 : 1 + ADJACENT_LEVELS], initial=0)
        ):
            mask |= ndimage.maximum_filter1d(at, EXCLUDED_SAMPLES)
            ends.append(float(-sign * levels[0]))
    return mask, ends


def _noise(values: Array) -> float:
    """Standard deviation of the noise, without the constant readings at the ends; 0 if smooth."""
    inner = (values > np.min(values)) & (values < np.max(values))
    inside = np.flatnonzero(inner[:-3] & inner[1:-2] & inner[2:-1] & inner[3:])
    if len(inside) < 30:
        return 0.0
    low, middle = np.quantile(np.abs(np.diff(values, 3)[inside]), [0.25, 0.5])
    bend = float(np.median(np.abs(np.diff(values, 2)[inside])))
    # Without noise, most of the higher differences of a friction law are nearly zero.
    noisy = low > MIN_QUARTILE_RATIO * middle and middle > MIN_ROUGHNESS * bend
    return float(middle / 0.6745 / np.sqrt(20.0)) if noisy else 0.0


def find_saturation(run: Run) -> tuple[list[Finding], Mask]:
    """Report saturated readings of the force, and mask the samples near them.

    Returns
    -------
    findings : list of Finding
    mask : ndarray
        True at the excluded samples, shape (n,).
    """
    assert run.friction is not None
    mask, ends = saturated(run.friction)
    if not ends:
        return [], mask
    share = float(np.mean(np.isin(run.friction, ends)))
    unit = run.quantities.force
    values = " and ".join(f"{end:.4g} {unit}" for end in sorted(ends))
    words = (
        f"the {run.quantities.noun} is saturated at {values} in {100.0 * share:.2g} % of the run"
    )
    size = float(np.max(np.abs(ends)))
    return [Finding("saturation", "friction_n", run.name, size, unit, "excluded", words)], mask
