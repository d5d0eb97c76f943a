"""Saturation: a force that stands at the end of its range."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.records.findings.finding import Finding
from jbf.records.findings.steps import step_of
from jbf.records.run import Run

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

LEAST = 5
"""So many readings at one extreme, to the digit, where noise would make each another,"""
TIMES = 2.0
"""and so many times as many as at any of the next levels: tails of a noise thin out."""
NEXT = 3
"""Levels next to the extreme that are looked at."""
COARSE = 0.6
"""Noise, in steps of the converter, below which a plateau is one level without saturation."""
ALIKE = 0.2
"""Lower quartile of a noise's third differences over their median; it is 0.47 of white noise."""
ROUGH = 1.2
"""Third over second differences of a noise: 1.8 where it is white; a curve has less than one."""
REACH = 15
"""Samples round one at an end that are set aside with it: of those there only the low ones are
left. (Not by their own size, which would leave the low ones.)"""


def saturated(values: Array) -> tuple[Mask, list[float]]:
    """True round readings that stand at an end of the range; and these ends."""
    from scipy import ndimage  # most of a second to import

    mask = np.zeros(len(values), dtype=bool)
    ends: list[float] = []
    noise = _noise(values)
    if noise == 0.0 or noise < COARSE * step_of(values):
        return mask, ends
    for way in (1.0, -1.0):
        levels, counts = np.unique(-way * values, return_counts=True)
        at = way * values == -levels[0]
        if counts[0] >= max(LEAST, TIMES * np.max(counts[1 : 1 + NEXT], initial=0)):
            mask |= ndimage.maximum_filter1d(at, REACH)
            ends.append(float(-way * levels[0]))
    return mask, ends


def _noise(values: Array) -> float:
    """Noise where nothing stands still: readings at an end have none."""
    inner = (values > np.min(values)) & (values < np.max(values))
    inside = np.flatnonzero(inner[:-3] & inner[1:-2] & inner[2:-1] & inner[3:])
    if len(inside) < 30:
        return 0.0
    low, middle = np.quantile(np.abs(np.diff(values, 3)[inside]), [0.25, 0.5])
    bend = float(np.median(np.abs(np.diff(values, 2)[inside])))
    # The bends of a law that has no noise are of any size, most next to none, or smooth.
    noisy = low > ALIKE * middle and middle > ROUGH * bend
    return float(middle / 0.6745 / np.sqrt(20.0)) if noisy else 0.0


def find_saturation(run: Run) -> tuple[list[Finding], Mask]:
    """Readings at the end of the force's range, and where they are."""
    assert run.friction_n is not None
    mask, ends = saturated(run.friction_n)
    if not ends:
        return [], mask
    share = float(np.mean(np.isin(run.friction_n, ends)))
    unit = run.quantities.force
    said = " and ".join(f"{end:.4g} {unit}" for end in sorted(ends))
    words = (
        f"the {run.quantities.noun} stands at the end of its range, {said}, "
        f"in {100.0 * share:.2g} % of the run"
    )
    size = float(np.max(np.abs(ends)))
    return [Finding("saturation", "friction_n", run.name, size, unit, "set aside", words)], mask
