"""Local polynomials through path and speed, against exact polynomials and least squares."""

from typing import Any

import numpy as np
import pytest
from jbf.records.motion.smoothing import HALF_WIDTHS, local_fit, smooth
from known_motions import integrated, white

SAMPLES = 41
EVEN_S: Any = 0.02 * np.arange(SAMPLES)
UNEVEN_S: Any = EVEN_S + 0.004 * np.sin(7.0 * np.arange(SAMPLES))
TIMES = pytest.mark.parametrize("time_s", [EVEN_S, UNEVEN_S], ids=["even", "uneven"])


def cubic(t: Any) -> tuple[Any, Any, Any]:
    """A path, its speed and its acceleration."""
    return (2.0 + 0.3 * t - 1.5 * t**2 + 4.0 * t**3, 0.3 - 3.0 * t + 12.0 * t**2, -3.0 + 24.0 * t)


@pytest.mark.parametrize("half", HALF_WIDTHS)
@TIMES
def test_cubic_path_is_fitted_exactly_at_all_samples_and_both_ends(half: int, time_s: Any) -> None:
    path, speed, acceleration = cubic(time_s)
    for sd in (1e-3, np.full(SAMPLES, 1e-3)):
        fit = local_fit(time_s, path, speed, 1e-4, sd, half)
        np.testing.assert_allclose(fit[0], path, atol=1e-9)
        np.testing.assert_allclose(fit[1], speed, atol=1e-7)
        np.testing.assert_allclose(fit[2], acceleration, atol=1e-5)


def least_squares(
    time_s: Any, path: Any, speed: Any, i: int, half: int, sd_path: float, sd_speed: Any
) -> tuple[Any, Any]:
    """Coefficients at a sample and their covariance by weighted least squares.

    The polynomial is a cubic for windows of less than four samples on each side, else a quintic.
    """
    order = 3 if half < 4 else 5
    width = min(2 * half + 1, len(time_s))
    first = min(max(i - width // 2, 0), len(time_s) - width)
    window = slice(first, first + width)
    t, k = time_s[window] - time_s[i], np.arange(order + 1)
    sd = np.broadcast_to(sd_speed, len(time_s))[window]
    slopes = k * t[:, None] ** np.maximum(k - 1, 0)
    rows = np.vstack((t[:, None] ** k / sd_path, slopes / sd[:, None]))
    target = np.concatenate(((path[window] - path[i]) / sd_path, speed[window] / sd))
    return np.linalg.lstsq(rows, target, rcond=None)[0], np.linalg.inv(rows.T @ rows)


@pytest.mark.parametrize("half", [1, 2, 4, 8])
@TIMES
def test_local_fit_of_noisy_samples_equals_weighted_least_squares(half: int, time_s: Any) -> None:
    path, speed, _ = cubic(time_s)
    path = path + white(SAMPLES, half, 2e-4)
    speed = speed + white(SAMPLES, half + 10, 1e-3)
    for sd in (1e-3, np.where(np.arange(SAMPLES) < 20, 1e-3, 5e-3)):
        fit = local_fit(time_s, path, speed, 2e-4, sd, half)
        for i in (0, 1, half, 20, SAMPLES - half - 1, SAMPLES - 1):
            best, covariance = least_squares(time_s, path, speed, i, half, 2e-4, sd)
            expected = (path[i] + best[0], best[1], 2.0 * best[2])
            assert [part[i] for part in fit[:3]] == pytest.approx(expected, rel=1e-5)
            errors = np.sqrt(covariance[1, 1]), 2.0 * np.sqrt(covariance[2, 2])
            assert (fit[3][i], fit[4][i]) == pytest.approx(errors, rel=1e-5)


def test_record_shorter_than_the_window_is_fitted_as_one_window() -> None:
    path, speed, acceleration = cubic(EVEN_S[:5])
    found = local_fit(EVEN_S[:5], path, speed, 1e-4, 1e-3, 8)
    np.testing.assert_allclose(found[1], speed, atol=1e-6)
    np.testing.assert_allclose(found[2], acceleration, atol=1e-4)
    path, speed, _ = cubic(EVEN_S[:3])
    shortest = local_fit(EVEN_S[:3], path, speed, 1e-4, 1e-3, 1)
    for value, expected in zip(smooth(EVEN_S[:3], path, speed, 1e-4, 1e-3), shortest, strict=False):
        np.testing.assert_allclose(value, expected)


def test_smooth_motion_is_fitted_with_the_widest_smoothing_window() -> None:
    path, speed, acceleration = cubic(EVEN_S)
    _, found, slope, error = smooth(EVEN_S, path, speed, 2e-4, 1e-3)
    np.testing.assert_allclose(found, speed, atol=1e-7)
    np.testing.assert_allclose(slope, acceleration, atol=1e-5)
    np.testing.assert_allclose(error, local_fit(EVEN_S, path, speed, 2e-4, 1e-3, 16)[3])


def test_smoothing_window_is_narrower_at_a_corner_of_the_speed() -> None:
    corner = 0.5 * np.abs(EVEN_S - 0.4)
    _, found, slope, error = smooth(EVEN_S, integrated(corner, 0.02), corner, 1e-6, 1e-5)
    assert abs(found[20]) < 0.01
    np.testing.assert_allclose(found[:17], corner[:17], atol=1e-6)
    np.testing.assert_allclose(slope[2:15], -0.5, atol=1e-3)
    np.testing.assert_allclose(slope[26:-2], 0.5, atol=1e-3)
    assert error[20] > 2.0 * error[8]
