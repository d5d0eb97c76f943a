"""The noise that a model leaves."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.estimation.noise import WHITE, Noise, estimate_noise
from jbf.estimation.problem import Lines, Problem
from jbf.estimation.samples import Samples

Array = npt.NDArray[np.float64]


def noise_at(
    problem: Problem, samples: Samples, values: Array, lines: Lines | None = None
) -> Noise:
    """The noise description that fits the residuals at some values, the runs' deviations apart; of
    many long runs, those of some. `lines` are the residuals there, if they are known."""
    which = problem.searched
    samples = samples if len(which) == len(samples.runs) else samples.only(which)
    residuals = problem.residuals(values, which) if lines is None else lines[0]
    residuals = samples.without_deviations(residuals, WHITE)
    masked = [r * c for r, c in zip(residuals, samples.counted, strict=True)]
    return estimate_noise(masked, samples.steps_s, samples.counted, problem.campaign.most_noise_n)
