"""Noise model of the instrument: white noise and a coloured part with a correlation time.

The residual of a correct model is noise. It is described as white noise plus a first-order
coloured part (correlation time tau), which is an ARMA(1,1) process at uniform steps. Its one-step
innovations are white; likelihoods and standard errors are computed from them. The correlation time
is limited (`NoiseSettings`), so that slow residual structure is not described as noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy import optimize, special

from jbf import _core
from jbf.arrays import Array, Mask
from jbf.estimation.settings import DEFAULT, NoiseSettings


@dataclass(frozen=True)
class Noise:
    """White plus first-order coloured noise.

    Attributes
    ----------
    memory_s
        Correlation time of the coloured part, s.
    colour
        From 0 (white) to 1 (all coloured): one minus the ratio of the moving-average to the
        autoregressive coefficient.

    Notes
    -----
    At uniform steps dt the noise r is an ARMA(1,1) process with white innovations e:
    ``r(t) - phi r(t - dt) = e(t) - phi (1 - colour) e(t - dt)`` with ``phi = exp(-dt / memory_s)``.
    """

    memory_s: float = 0.0
    colour: float = 0.0

    def innovations(self, values: Array, step_s: float) -> Array:
        """Whiten noise values of shape (n,) or (n, k), at uniform steps, along the first axis."""
        if self.white:
            return values
        phi, white_share = self._coefficients(step_s)
        return _core.first_order_filter((1.0, -phi), -phi * white_share, values)

    def coloured(self, innovations: Array, step_s: float) -> Array:
        """Generate noise from its innovations, shape (n,) or (n, k), at uniform steps."""
        if self.white:
            return innovations
        phi, white_share = self._coefficients(step_s)
        return _core.first_order_filter((1.0, -phi * white_share), -phi, innovations)

    @property
    def white(self) -> bool:
        """Whether the noise is white."""
        return self.colour <= 0.0 or self.memory_s <= 0.0

    def _coefficients(self, step_s: float) -> tuple[float, float]:
        """Autoregressive coefficient phi for one step, and moving-average coefficient over phi."""
        return float(np.exp(-step_s / self.memory_s)), 1.0 - self.colour

    def coloured_share(self, step_s: float) -> float:
        """Fraction of the variance in the coloured part, 0 to 1."""
        if self.white:
            return 0.0
        phi_squared = float(np.exp(-2.0 * step_s / self.memory_s))
        white_share = 1.0 - self.colour
        if white_share <= 0.0:
            return 1.0
        ratio = ((1.0 + phi_squared * white_share**2) / white_share - (1.0 + phi_squared)) / (
            1.0 - phi_squared
        )
        return ratio / (1.0 + ratio)

    def with_share(self, share: float, step_s: float) -> Noise:
        """Return noise with the same correlation time and the given coloured share (below 1)."""
        if share <= 0.0:
            return WHITE
        phi_squared = float(np.exp(-2.0 * step_s / self.memory_s))
        total = share / (1.0 - share) * (1.0 - phi_squared) + 1.0 + phi_squared
        white_share = (total - np.sqrt(total**2 - 4.0 * phi_squared)) / (2.0 * phi_squared)
        return Noise(self.memory_s, float(1.0 - white_share))


WHITE = Noise()


def innovation_cost(
    noise: Noise, residuals: Sequence[Array], steps: Sequence[float], masks: Sequence[Mask]
) -> float:
    """Cost of a noise model: ``n log(mean square innovation)``, -2 x log likelihood + constant."""
    total, count = 0.0, 0
    for residual, step, mask in zip(residuals, steps, masks, strict=True):
        e = noise.innovations(residual, step)[mask]
        total += float(e @ e)
        count += len(e)
    return count * float(np.log(max(total, 1e-300) / max(count, 1)))


def _cost_derivatives(
    noise: Noise, residuals: Sequence[Array], steps: Sequence[float], masks: Sequence[Mask]
) -> tuple[Array, Array]:
    """Gradient and Gauss-Newton Hessian of :func:`innovation_cost`.

    The variables are the logarithm of the correlation time and the colour.
    """
    total, count, slope, curvature = 0.0, 0, np.zeros(2), np.zeros((2, 2))
    for residual, step, mask in zip(residuals, steps, masks, strict=True):
        phi, white_share = float(np.exp(-step / noise.memory_s)), 1.0 - noise.colour
        feedback = -phi * white_share
        e = _core.first_order_filter((1.0, -phi), feedback, residual)
        # Derivatives of e(t) = r(t) - phi r(t-1) + phi (1 - colour) e(t-1).
        phi_by_memory = (0.0, phi * step / noise.memory_s)
        by_memory = _core.first_order_filter(phi_by_memory, feedback, white_share * e - residual)
        by_colour = _core.first_order_filter((0.0, -phi), feedback, e)
        derivatives = np.column_stack([by_memory, by_colour])[mask]
        innovations = e[mask]
        total += float(innovations @ innovations)
        slope += innovations @ derivatives
        curvature += derivatives.T @ derivatives
        count += len(innovations)
    scale = 2.0 * count / max(total, 1e-300)
    return scale * slope, scale * curvature


def estimate_noise(
    residuals: Sequence[Array],
    steps: Sequence[float],
    masks: Sequence[Mask],
    most_n: float | None = None,
    settings: NoiseSettings = DEFAULT.noise,
) -> Noise:
    """Estimate the noise model of residuals, white plus a coloured part, by maximum likelihood.

    The noise is white unless the gain of a coloured part exceeds its threshold. The standard
    deviation of the coloured part is limited to `most_n`, N, if it is given. Without this limit,
    the noise model would absorb the smooth error of a wrong model.
    """
    shortest = 2.0 * min(steps)
    longest = max(settings.longest_memory_s, 2.0 * shortest)
    low, high = np.log(shortest), np.log(longest)

    def unpack(x: Array) -> Noise:
        """Noise model for the search variables: log of the correlation time, and colour."""
        memory, colour = special.expit(x)
        return Noise(float(np.exp(low + (high - low) * memory)), float(colour))

    def cost(x: Array) -> float:
        """Cost (`innovation_cost`) at the search variables."""
        return innovation_cost(unpack(x), residuals, steps, masks)

    @lru_cache(maxsize=1)
    def derivatives(values: bytes) -> tuple[Array, Array]:
        """Gradient and Hessian of the cost, cached by the bytes of the search variables."""
        x = np.frombuffer(values)
        slope, curvature = _cost_derivatives(unpack(x), residuals, steps, masks)
        unit = special.expit(x)
        inner = unit * (1.0 - unit) * [high - low, 1.0]
        # The small diagonal regularises the step for variables without influence on the cost.
        return slope * inner, curvature * np.outer(inner, inner) + 1e-6 * np.eye(2)

    def slope(x: Array) -> Array:
        """Gradient of the cost."""
        return derivatives(x.tobytes())[0]

    def curvature(x: Array) -> Array:
        """Hessian of the cost."""
        return derivatives(x.tobytes())[1]

    starts = [np.array([m, c]) for m in (-1.0, 1.5) for c in (-4.0, -1.5, 0.5)]
    best = min(starts, key=cost)
    white = innovation_cost(WHITE, residuals, steps, masks)
    promised = 0.5 * float(slope(best) @ np.linalg.solve(curvature(best), slope(best)))
    coloured = white - settings.min_gain
    if cost(best) - settings.max_gain_factor * promised >= coloured:
        return WHITE
    # For a unit curvature, a slope of 0.3 corresponds to less than 0.1 in twice the log likelihood.
    optimum = optimize.minimize(
        cost,
        best,
        method="trust-exact",
        jac=slope,
        hess=curvature,
        options={"maxiter": 40, "gtol": 0.3},
    )
    if optimum.fun >= coloured:
        return WHITE
    noise = unpack(optimum.x)
    if most_n is None:
        return noise
    square = sum(float(np.sum(r[m] ** 2)) for r, m in zip(residuals, masks, strict=True))
    square /= max(sum(int(m.sum()) for m in masks), 1)
    step = float(np.median(steps))
    max_share = most_n**2 / max(square, 1e-300)
    return noise if noise.coloured_share(step) <= max_share else noise.with_share(max_share, step)
