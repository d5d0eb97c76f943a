"""Angles that restart at each turn, and angles that count the turns."""

import numpy as np
import pytest
from jbf.records.angles import continuous

TIME_S = 0.1 * np.arange(400)
SLOW, FAST, SWING = 3.0 * TIME_S, 80.0 * (1.0 - np.exp(-0.9 * TIME_S)), 5.0 * np.sin(TIME_S)
"""Rotation at 0.3 rad per sample, a coast-down from 7 rad per sample, and a swing."""


@pytest.mark.parametrize("angle", [SLOW, SWING, -SLOW])
@pytest.mark.parametrize("low", [0.0, -np.pi])
def test_angle_that_restarts_at_each_turn_becomes_continuous(angle: np.ndarray, low: float) -> None:
    wrapped = np.mod(angle - low, 2.0 * np.pi) + low
    result = continuous(wrapped)
    np.testing.assert_allclose(result - result[0], angle - angle[0], atol=1e-9)


@pytest.mark.parametrize("angle", [SLOW, FAST, -FAST])
def test_angle_that_counts_turns_is_unchanged_at_any_speed(angle: np.ndarray) -> None:
    assert float(np.max(np.abs(np.diff(FAST)))) > 2.0 * np.pi
    np.testing.assert_array_equal(continuous(angle), angle)


def test_single_wrong_reading_does_not_shift_later_angles() -> None:
    angle = SLOW.copy()
    angle[200] += 4.0
    result = continuous(angle)
    np.testing.assert_allclose(np.delete(result, 200), np.delete(SLOW, 200), atol=1e-9)
