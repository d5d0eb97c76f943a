"""Local polynomials against exact ones, and a motion at other instants against closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from jbf.records.findings.finding import Finding
from jbf.records.motion.imposed import ImposedMotion
from jbf.records.motion.smoothing import HALF_WIDTHS, _design, _even, local_fit, smooth

N = 41
EVEN: Any = 0.02 * np.arange(N)
UNEVEN: Any = EVEN + 0.004 * np.sin(7.0 * np.arange(N))


def cubic(t: Any) -> tuple[Any, Any, Any]:
    """A path, its speed and its acceleration."""
    return (2.0 + 0.3 * t - 1.5 * t**2 + 4.0 * t**3, 0.3 - 3.0 * t + 12.0 * t**2, -3.0 + 24.0 * t)


@pytest.mark.parametrize("half", HALF_WIDTHS)
@pytest.mark.parametrize("time", [EVEN, UNEVEN], ids=["even", "uneven"])
@pytest.mark.parametrize("local", [False, True])
def test_a_cubic_is_fitted_exactly(half: int, time: Any, local: bool) -> None:
    """By every window, at the ends, too; with one error for all speeds or one for each."""
    path, speed, acceleration = cubic(time)
    sd: Any = np.full(N, 1e-3) if local else 1e-3
    found = local_fit(time, path, speed, 1e-4, sd, half)
    np.testing.assert_allclose(found[0], path, atol=1e-9)
    np.testing.assert_allclose(found[1], speed, atol=1e-7)
    np.testing.assert_allclose(found[2], acceleration, atol=1e-5)
    assert all(len(part) == N for part in found)


def textbook(time: Any, i: int, half: int, sd_path: float, sd_speed: Any, order: int) -> Any:
    """Standard errors of speed and acceleration at a sample by weighted least squares."""
    width = min(2 * half + 1, len(time))
    first = min(max(i - width // 2, 0), len(time) - width)
    index = np.arange(first, first + width)
    t = time[index] - time[i]
    k = np.arange(order + 1)
    rows = np.vstack(
        (
            t[:, None] ** k / sd_path,
            k * t[:, None] ** np.maximum(k - 1, 0) / np.broadcast_to(sd_speed, N)[index][:, None],
        )
    )
    covariance = np.linalg.inv(rows.T @ rows)
    return np.sqrt(covariance[1, 1]), 2.0 * np.sqrt(covariance[2, 2])


@pytest.mark.parametrize(("half", "order"), [(1, 3), (2, 3), (4, 5), (8, 5)])
@pytest.mark.parametrize("time", [EVEN, UNEVEN], ids=["even", "uneven"])
def test_errors_are_those_of_least_squares(half: int, order: int, time: Any) -> None:
    """Of a cubic in a short window, of a quintic in a longer one; whole windows at the ends."""
    path, speed, _ = cubic(time)
    loud = np.where(np.arange(N) < 20, 1e-3, 5e-3)
    for sd in (1e-3, loud):
        *_, error, of_acceleration = local_fit(time, path, speed, 2e-4, sd, half)
        for i in (0, 1, half, 20, N - half - 1, N - 2, N - 1):
            wanted = textbook(time, i, half, 2e-4, sd, order)
            assert error[i] == pytest.approx(wanted[0], rel=1e-5)
            assert of_acceleration[i] == pytest.approx(wanted[1], rel=1e-5)


@pytest.mark.parametrize("half", [1, 2, 4, 8])
def test_noise_is_smoothed_as_least_squares_would(half: int) -> None:
    """The same whether windows are shared or each stands alone; a far path loses no digits."""
    random = np.random.default_rng(half)
    path, speed, _ = cubic(EVEN)
    path = path + 2e-4 * random.standard_normal(N)
    speed = speed + 1e-3 * random.standard_normal(N)
    shared = local_fit(EVEN, path, speed, 2e-4, 1e-3, half)
    alone = local_fit(EVEN, path, speed, 2e-4, np.full(N, 1e-3), half)
    for a, b in zip(shared, alone, strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-6, atol=1e-9)
    far = local_fit(EVEN, path + 1e4, speed, 2e-4, 1e-3, half)
    np.testing.assert_allclose(far[1], shared[1], atol=1e-6)


def test_a_record_shorter_than_its_window_is_one_window() -> None:
    """Of which every sample sees all."""
    t = EVEN[:5]
    path, speed, acceleration = cubic(t)
    found = local_fit(t, path, speed, 1e-4, 1e-3, 8)
    np.testing.assert_allclose(found[1], speed, atol=1e-6)
    np.testing.assert_allclose(found[2], acceleration, atol=1e-4)


def test_samples_are_even_but_for_rounding() -> None:
    """A millionth of a step."""
    assert _even(EVEN)
    for share, even in ((0.9e-6, True), (1.2e-6, False)):
        moved = EVEN.copy()
        moved[-1] += 0.02 * share
        assert _even(moved) == even


def test_rows_of_powers_over_their_errors() -> None:
    """Of the path, then of the speed, whose slopes are in seconds."""
    u = np.array([[-1.0, 0.0, 0.5]])
    rows = _design(u, 3, 0.1, 2.0, np.array([[4.0]]))[0]
    assert rows[2].tolist() == [0.5, 0.25, 0.125, 0.0625]
    np.testing.assert_allclose(rows[5], np.array([0.0, 1.0, 1.0, 0.75]) / 0.1 / 4.0)
    assert rows.shape == (6, 4)


def test_windows_grow_while_they_agree() -> None:
    """Of a cubic all of them do: the error is that of the widest. A corner keeps them short."""
    path, speed, acceleration = cubic(EVEN)
    _, found, slope, error = smooth(EVEN, path, speed, 2e-4, 1e-3)
    np.testing.assert_allclose(found, speed, atol=1e-7)
    np.testing.assert_allclose(slope, acceleration, atol=1e-5)
    np.testing.assert_allclose(error, local_fit(EVEN, path, speed, 2e-4, 1e-3, 16)[3])
    corner = 0.5 * np.abs(EVEN - 0.4)
    whole = np.concatenate(([0.0], np.cumsum(0.5 * (corner[1:] + corner[:-1]) * 0.02)))
    _, found, slope, error = smooth(EVEN, whole, corner, 1e-6, 1e-5)
    assert abs(found[20]) < 0.01
    np.testing.assert_allclose(found[:17], corner[:17], atol=1e-6)
    np.testing.assert_allclose(slope[2:15], -0.5, atol=1e-3)
    np.testing.assert_allclose(slope[26:-2], 0.5, atol=1e-3)
    # The samples beside it know less than those far from it.
    assert error[20] > 2.0 * error[8]


def test_three_samples_are_smoothed_by_the_shortest_window() -> None:
    """And no more are asked for."""
    t = EVEN[:3]
    path, speed, _ = cubic(t)
    found = smooth(t, path, speed, 1e-4, 1e-3)
    np.testing.assert_allclose(found[1], speed, atol=1e-7)
    np.testing.assert_allclose(found[3], local_fit(t, path, speed, 1e-4, 1e-3, 1)[3])


TIME = np.array([0.0, 1.0, 2.0, 4.0, 5.0])


def motion(v: list[float], a: list[float], rest: str = "00000", known: str = "11111") -> Any:
    """A motion at five instants."""
    resting, sign_known = (np.array([c == "1" for c in text]) for text in (rest, known))
    error = np.array([1.0, 2.0, 3.0, 1.0, 1.0])
    return ImposedMotion(np.array(v), np.array(a), 3.0 * TIME, error, resting, sign_known)


def test_a_motion_at_other_instants_is_on_cubics_through_speed_and_acceleration() -> None:
    """Of a cubic it is that cubic; at the samples it is the motion itself."""
    v = 1.0 + 0.5 * TIME - 0.3 * TIME**2 + 0.1 * TIME**3
    a = 0.5 - 0.6 * TIME + 0.3 * TIME**2
    at = np.array([0.0, 0.25, 1.0, 1.7, 3.0, 3.9, 5.0])
    found = motion(v.tolist(), a.tolist()).at(TIME, at)
    np.testing.assert_allclose(found.velocity_m_s, 1.0 + 0.5 * at - 0.3 * at**2 + 0.1 * at**3)
    np.testing.assert_allclose(found.angle_rad, 3.0 * at)
    np.testing.assert_allclose(found.acceleration_m_s2, np.interp(at, TIME, a))
    assert found.velocity_error_m_s.tolist() == [2.0, 2.0, 2.0, 3.0, 3.0, 3.0, 1.0]
    assert found.sign_known.all()
    assert not found.resting.any()


def test_between_a_rest_and_a_motion_the_speed_is_a_line_from_where_it_starts() -> None:
    """By the motion's own acceleration; before that it is at rest."""
    m = motion([0.0, 0.0, 0.5, 0.5, 0.0], [0.0, 0.0, 1.0, -2.0, 0.0], "11001")
    at = np.array([0.5, 1.25, 1.5, 1.75, 2.0, 4.1, 4.25, 4.5])
    found = m.at(TIME, at)
    # It starts at 1.5 s and ends at 4.25 s.
    np.testing.assert_allclose(found.velocity_m_s, [0, 0, 0, 0.25, 0.5, 0.3, 0.0, 0.0], atol=1e-12)
    assert found.resting.tolist() == [True, True, True, False, False, False, True, True]
    np.testing.assert_allclose(found.acceleration_m_s2, [0, 0, 0, 1.0, 1.0, -2.0, 0.0, 0.0])
    slow = motion([0.0, 0.0, 0.5, 0.5, 0.0], [0.0, 0.0, 0.1, -0.1, 0.0], "11001").at(TIME, at)
    # Slower than the step lasts: from sample to sample.
    np.testing.assert_allclose(slow.velocity_m_s, [0.0, 0.125, 0.25, 0.375, 0.5, 0.45, 0.375, 0.25])
    still = motion([0.0, 0.0, 0.5, 0.5, 0.0], [0.0, 0.0, -1.0, 1.0, 0.0], "11001").at(TIME, at)
    np.testing.assert_allclose(still.velocity_m_s, slow.velocity_m_s)


def test_a_sign_is_known_between_two_that_are_known_and_alike() -> None:
    """Not across a reversal, nor beside a rest; at a sample as the sample says."""
    v = [1.0, 1.0, -1.0, -1.0, -1.0]
    at = np.array([0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 4.5, 5.0])
    found = motion(v, [0.0] * 5).at(TIME, at)
    assert found.sign_known.tolist() == [True, True, True, False, True, True, True, True, True]
    found = motion([1.0] * 5, [0.0] * 5, known="11011").at(TIME, at)
    assert found.sign_known.tolist() == [True, True, True, False, False, False, True, True, True]
    resting = motion([0.0, 0.0, 1.0, 1.0, 1.0], [0.0] * 5, "11000").at(TIME, at)
    assert resting.sign_known.tolist() == [True, True, True, False, True, True, True, True, True]


def test_columns_that_were_left_aside_or_converted() -> None:
    """By the kind of the finding."""
    kinds = ("glitches", "no_speed", "units")
    findings = tuple(Finding(k, f"column of {k}", "a", 0.0, "1", "", "") for k in kinds)
    empty = np.zeros(0)
    mask = np.zeros(0, dtype=bool)
    found = ImposedMotion(empty, empty, empty, empty, mask, mask, findings)
    assert found.aside == {"column of no_speed", "column of units"}
