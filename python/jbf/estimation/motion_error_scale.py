"""Noise of the force, and scale of the errors of the motion, that maximise the likelihood."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy import optimize

from jbf.estimation.errors_in_motion import ErrorsInMotion
from jbf.estimation.posterior_motions import moved
from jbf.estimation.prepared import coasting
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution

Array = npt.NDArray[np.float64]
RATIOS = 9
"""Number of grid points of scale / noise that bracket the minimum."""
RATIO_STEP = 0.01
"""Tolerance of the logarithm of the ratio of error scale and noise."""
MOST_SCALE = 3.0
"""Largest logarithm of the error scale, and minus the smallest."""
MOST_NOISE = 0.5
"""Logarithm of the largest noise, relative to the residual."""
EXACT_RECORD = 1e-12
"""Smallest residual relative to the largest force."""
LEAST_NOISE = -7.0
"""Logarithm of the smallest noise, relative to the residual."""


def estimate_motion_errors(problem: Problem, solution: Solution) -> ErrorsInMotion:
    """Estimate sensitivities at a solution, the noise, and the scale of the motion's errors.

    Noise and scale maximise the likelihood. The scale corrects the standard errors of the smoother,
    which are too large if the motion is smoother than the assumed noise process. The logarithm of
    the scale has a normal prior, so that the scale is 1 if the motion's errors are negligible.
    """
    prepared = problem.campaign.prepared
    predicted = [p.friction - r for p, r in zip(prepared, solution.residuals, strict=True)]
    sensitivity = [np.zeros((len(f), 3)) for f in predicted]
    for axis in range(3):
        changed, steps = zip(*(moved(p, axis) for p in prepared), strict=True)
        other = problem.chain.predict(solution.values, [p.core for p in changed])
        for derivatives, before, after, step in zip(
            sensitivity, predicted, other, steps, strict=True
        ):
            derivatives[:, axis] = np.divide(
                after - before, step, where=step > 0.0, out=derivatives[:, axis]
            )
    mass = coasting(problem.campaign.rig)
    if mass is not None:
        # The force is derived from the deceleration and contains the errors of the acceleration.
        for derivatives in sensitivity:
            derivatives[:, 2] += mass
    weights = solution.samples.weight
    errors = tuple(p.motion.errors for p in prepared)
    motion = ErrorsInMotion(errors, tuple(sensitivity), 1.0)
    largest = max(float(np.max(np.abs(f), initial=0.0)) for f in predicted)
    most = max(solution.samples.rms(solution.residuals), EXACT_RECORD * largest, 1e-150)
    settings = problem.campaign.settings.motion
    smallest = settings.min_noise_share * solution.samples.rms(predicted)
    lowest = float(np.clip(np.log(max(smallest, 1e-150) / most), LEAST_NOISE, 0.0))
    count = sum(int(np.count_nonzero(w)) for w in weights)

    def at(log_ratio: float, log_noise: float) -> ErrorsInMotion:
        """Errors of the motion with the logarithms of scale / noise and of noise / RMS."""
        scale = float(np.exp(log_ratio + log_noise))
        return replace(motion, noise=most * float(np.exp(log_noise)), scale=scale)

    def profiled(log_ratio: float) -> tuple[float, float]:
        """Smallest penalised deviance for a logarithm of scale / noise, and that of noise / RMS.

        The filter depends on the ratio only, and the deviance is convex in the logarithm of the
        noise.
        """
        unit = at(log_ratio, 0.0).whitening(weights)
        squares = unit.deviance(solution.residuals) - unit.log_determinant

        def penalised(log_noise: float) -> float:
            """Penalised deviance at the logarithm of noise / RMS."""
            deviance = squares * float(np.exp(-2.0 * log_noise)) + 2.0 * count * log_noise
            prior = ((log_ratio + log_noise) / settings.scale_prior) ** 2
            return deviance + unit.log_determinant + prior

        bounds = max(lowest, -MOST_SCALE - log_ratio), min(MOST_NOISE, MOST_SCALE - log_ratio)
        found = optimize.minimize_scalar(penalised, bounds=bounds, method="bounded")
        return float(found.fun), float(found.x)

    # A second minimum exists at low noise, where the motion's errors explain the whole residual.
    log_ratios = np.linspace(-MOST_SCALE - MOST_NOISE, MOST_SCALE - lowest, RATIOS + 2)
    least = 1 + int(np.argmin([profiled(log_ratio)[0] for log_ratio in log_ratios[1:-1]]))
    found = optimize.minimize_scalar(
        lambda log_ratio: profiled(log_ratio)[0],
        bounds=(log_ratios[least - 1], log_ratios[least + 1]),
        method="bounded",
        options={"xatol": RATIO_STEP},
    )
    return at(float(found.x), profiled(float(found.x))[1])
