"""Motions and friction forces in closed form, with noise and quantisation as sensors add them."""

from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

STEP_S = 0.01
"""Sampling interval of the motions below, s."""
TIME_S: Any = STEP_S * np.arange(800)


def speed_of(time_s: Any) -> Any:
    """Speed, m/s: two sines without a common period."""
    return 0.2 * np.sin(1.7 * time_s + 0.4) + 0.05 * np.sin(4.3 * time_s)


def path_of(time_s: Any) -> Any:
    """The integral of `speed_of`, m."""
    return -0.2 / 1.7 * np.cos(1.7 * time_s + 0.4) - 0.05 / 4.3 * np.cos(4.3 * time_s)


def reversing_force(time_s: Any, seed: int, noise_rms: float = 0.3) -> Array:
    """Friction of 20 N that reverses, with white noise independent at each instant, N."""
    force: Array = 20.0 * np.tanh(50.0 * np.sin(0.3 * time_s)) + white(len(time_s), seed, noise_rms)
    return force


def reading_instants(rate_hz: float, time_s: Any) -> Array:
    """Instants of a clock with a given rate over the duration of a record, s."""
    instants: Array = np.arange(-0.3 / rate_hz, time_s[-1] + 2.0 / rate_hz, 1.0 / rate_hz)
    return instants


def white(samples: int, seed: int, size: float = 1.0) -> Array:
    """White Gaussian noise of standard deviation `size`."""
    noise: Array = size * np.random.default_rng(seed).standard_normal(samples)
    return noise


def quantised(values: Any, step: float) -> Array:
    """Values rounded to integer multiples of a step."""
    rounded: Array = step * np.round(np.asarray(values) / step)
    return rounded


def integrated(speed: Any, step_s: float) -> Array:
    """The path of a speed by the trapezoidal rule, from zero."""
    path: Array = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * step_s)))
    return path


def places(mask: Any) -> list[int]:
    """Indices at which a mask is true."""
    return [int(i) for i in np.flatnonzero(mask)]
