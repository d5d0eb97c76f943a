"""Interpolation of a motion in closed form, and runs shifted in time."""

from typing import Any

import numpy as np
import pytest
from jbf import Rig, Run
from jbf.estimation.prepared import Prepared
from jbf.records.motion.estimated_motion import EstimatedMotion
from known_motions import white
from numpy.polynomial import Polynomial

INSTANTS_S = np.array([0.0, 1.0, 2.0, 4.0, 5.0])
DURATION_S = 20.0


def motion(v: Any, a: Any, rest: str = "00000", known: str = "11111") -> EstimatedMotion:
    """A motion at five instants; its masks are given as ones and zeros."""
    resting, sign_known = (np.array([c == "1" for c in text]) for text in (rest, known))
    error = np.array([1.0, 2.0, 3.0, 1.0, 1.0])
    return EstimatedMotion(np.array(v), np.array(a), 3.0 * INSTANTS_S, error, resting, sign_known)


def test_speed_is_interpolated_by_cubics_that_match_speed_and_acceleration() -> None:
    at_s, cubic = np.array([0.0, 0.25, 1.0, 1.7, 3.0, 3.9, 5.0]), Polynomial([1.0, 0.5, -0.3, 0.1])
    a = cubic.deriv()(INSTANTS_S)
    found = motion(cubic(INSTANTS_S), a).at(INSTANTS_S, at_s)
    np.testing.assert_allclose(found.velocity, cubic(at_s))
    np.testing.assert_allclose(found.angle_rad, 3.0 * at_s)
    np.testing.assert_allclose(found.acceleration, np.interp(at_s, INSTANTS_S, a))
    # The error is the larger one of the two neighbours.
    assert found.velocity_error_m_s.tolist() == [2.0, 2.0, 2.0, 3.0, 3.0, 3.0, 1.0]
    assert (found.sign_known & ~found.resting).all()


def test_start_and_stop_next_to_a_rest_are_extrapolated_with_acceleration() -> None:
    """A start at 1 m/s^2 is 0.5 s before 0.5 m/s; a stop at -2 m/s^2 is 0.25 s after 0.5 m/s."""
    at_s = np.array([0.5, 1.25, 1.5, 1.75, 2.0, 4.1, 4.25, 4.5])
    v, rest = [0.0, 0.0, 0.5, 0.5, 0.0], "11001"
    found = motion(v, [0.0, 0.0, 1.0, -2.0, 0.0], rest).at(INSTANTS_S, at_s)
    np.testing.assert_allclose(found.velocity, [0, 0, 0, 0.25, 0.5, 0.3, 0, 0], atol=1e-12)
    assert found.resting.tolist() == [True, True, True, False, False, False, True, True]
    np.testing.assert_allclose(found.acceleration, [0, 0, 0, 1.0, 1.0, -2.0, 0.0, 0.0])
    # If the acceleration is too small for the interval or has the wrong sign, the speed is
    # interpolated linearly.
    for a in ([0.0, 0.0, 0.1, -0.1, 0.0], [0.0, 0.0, -1.0, 1.0, 0.0]):
        linear = motion(v, a, rest).at(INSTANTS_S, at_s)
        expected = [0.0, 0.125, 0.25, 0.375, 0.5, 0.45, 0.375, 0.25]
        np.testing.assert_allclose(linear.velocity, expected)


@pytest.mark.parametrize(
    ("v", "rest", "known", "unknown_s"),
    [
        ([1.0, 1.0, -1.0, -1.0, -1.0], "00000", "11111", [1.5]),  # a reversal in between
        ([1.0] * 5, "00000", "11011", [1.5, 2.0, 3.0]),
        ([0.0, 0.0, 1.0, 1.0, 1.0], "11000", "11111", [1.5]),  # between rest and motion
    ],
)
def test_sign_of_motion_is_known_only_between_samples_of_equal_known_sign(
    v: Any, rest: str, known: str, unknown_s: Any
) -> None:
    at_s = np.array([0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 4.5, 5.0])
    found = motion(v, [0.0] * 5, rest, known).at(INSTANTS_S, at_s)
    assert at_s[~found.sign_known].tolist() == unknown_s


def speed(time_s: Any) -> Any:
    return 0.12 * np.sin(3.0 * time_s) + 0.05 * np.sin(0.618 * 3.0 * time_s)


@pytest.fixture(scope="module")
def prepared() -> Prepared:
    time_s = np.arange(0.0, DURATION_S + 0.01, 0.02)
    v = speed(time_s)
    force = 5.0 * np.sign(v) + 20.0 * v + white(len(time_s), 0, 0.03)
    return Prepared.of(Rig(), Run.from_arrays(time_s, v, force))


@pytest.mark.parametrize(("delay_s", "drift"), [(7.3e-3, 0.0), (-31e-3, 0.0), (25e-3, 2e-3)])
def test_delayed_force_is_compared_with_the_motion_at_earlier_instants(
    prepared: Prepared, delay_s: float, drift: float
) -> None:
    """A drift increases the delay in proportion to the time from mid-run."""
    time_s = prepared.run.time_s
    at_s = time_s - delay_s - drift * (time_s - 0.5 * DURATION_S)
    inside = (at_s >= time_s[0]) & (at_s <= time_s[-1])
    assert 1 <= np.sum(~inside) <= 3
    found = prepared.shifted(delay_s, drift)
    np.testing.assert_array_equal(found.friction, prepared.friction[inside])
    np.testing.assert_allclose(found.run.time_s, at_s[inside], atol=1e-12)
    expected = speed(at_s[inside])
    np.testing.assert_allclose(found.motion.velocity[3:-3], expected[3:-3], atol=5e-6)
    known = found.motion.sign_known
    assert (found.motion.velocity * expected)[known].min() > 0.0
    assert np.sum(~known) <= 8 * np.count_nonzero(np.diff(np.sign(expected))) + 4


def test_zero_delay_and_drift_change_neither_force_nor_motion(prepared: Prepared) -> None:
    same = prepared.shifted(0.0, 0.0)
    np.testing.assert_array_equal(same.friction, prepared.friction)
    unchanged = prepared.motion.velocity
    np.testing.assert_allclose(same.motion.velocity, unchanged, rtol=0.0, atol=1e-15)
    assert not prepared.motion.sign_known.all()
    np.testing.assert_array_equal(same.motion.sign_known, prepared.motion.sign_known)
