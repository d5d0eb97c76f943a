"""Noise model of the residuals of a model."""

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
    """Estimate the noise model of the residuals at some values, without the random effects of runs.

    With many long runs, a selection of runs is used. `lines` holds the residuals and derivatives at
    these values, if they are known.
    """
    which = problem.searched
    samples = samples if len(which) == len(samples.runs) else samples.only(which)
    residuals = problem.residuals(values, which) if lines is None else lines[0]
    residuals = samples.without_deviations(residuals, WHITE)
    masked = [r * c for r, c in zip(residuals, samples.counted, strict=True)]
    most_n, settings = problem.campaign.most_noise_n, samples.settings.noise
    return estimate_noise(masked, samples.steps_s, samples.counted, most_n, settings)
