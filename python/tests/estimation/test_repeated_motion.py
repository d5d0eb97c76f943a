"""Detection of the period of a repeated motion, on motions with a known period."""

import numpy as np
import pytest
from by_hand import Array
from jbf.estimation.noise_floor import period_samples


def wave(count: int, period: int) -> Array:
    """A sine with its second harmonic, whose half periods differ."""
    turn = 2.0 * np.pi * np.arange(count) / period
    return np.sin(turn) + 0.3 * np.sin(2.0 * turn + 0.5)


@pytest.mark.parametrize("period", [7, 20, 61, 150])
@pytest.mark.parametrize("mean", [0.0, -2.0])
def test_period_is_exact_and_independent_of_the_mean_speed(period: int, mean: float) -> None:
    """The period is the first repetition, not a multiple of it."""
    assert period_samples(mean + wave(5 * period + 130, period)) == period


@pytest.mark.parametrize(("count", "found"), [(99, None), (100, 20)])
def test_period_is_detected_only_from_a_hundred_samples_on(count: int, found: int | None) -> None:
    assert period_samples(wave(count, 20)) == found


@pytest.mark.parametrize(
    "velocity",
    [
        np.zeros(300),
        np.full(300, -0.7),
        np.linspace(-1.0, 1.0, 300),
        np.random.default_rng(1).standard_normal(400),
    ],
    ids=["rest", "constant", "ramp", "noise"],
)
def test_motion_that_does_not_repeat_has_no_period(velocity: Array) -> None:
    assert period_samples(velocity) is None


@pytest.mark.parametrize(("noise", "found"), [(0.010, 100), (0.018, None)])
@pytest.mark.parametrize("unit", [1e-3, 1e3])
def test_period_is_detected_only_if_repetitions_agree_within_two_percent(
    noise: float, found: int | None, unit: float
) -> None:
    """The difference of two noises has sqrt(2) times their standard deviation."""
    sine = np.sqrt(2.0) * np.sin(2.0 * np.pi * np.arange(2000) / 100)
    random = np.random.default_rng(2)
    assert period_samples(unit * (sine + noise * random.standard_normal(2000))) == found


@pytest.mark.parametrize(("second", "period"), [(0.5, 80), (0.8, 80), (0.995, 40)])
def test_period_covers_two_strokes_if_their_sizes_differ(second: float, period: int) -> None:
    stroke = np.sin(2.0 * np.pi * np.arange(40) / 40)
    assert period_samples(np.tile(np.concatenate((stroke, second * stroke)), 8)) == period


@pytest.mark.parametrize(("period", "found"), [(150, 150), (240, None)])
def test_period_is_detected_up_to_three_quarters_of_the_record(
    period: int, found: int | None
) -> None:
    assert period_samples(wave(300, period)) == found
