"""Rests of a shaft: samples, position, and the adjacent start and end of motion."""

from typing import Any

import numpy as np
import pytest
from jbf.records.motion import rests
from known_motions import places, quantised
from numpy.polynomial import Polynomial

COUNT_M = 1e-4
SLOW_S: Any = 5e-3 * np.arange(400)
RATE_M_S2, FINE_COUNT_M = 0.008, 7e-6


def mask(text: str) -> Any:
    """A mask given as ones and zeros."""
    return np.array([character == "1" for character in text])


def test_at_least_three_consecutive_zero_speeds_are_a_rest() -> None:
    v = np.array([0.0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0])
    assert places(rests.resting_samples(v)) == [0, 1, 2, 7, 8, 9, 10, 12, 13, 14]
    assert not rests.resting_samples(np.array([1e-300, 0.0, 0.0])).any()
    assert len(rests.resting_samples(np.array([]))) == 0


def stop(samples: int, *, hum: float = 0.0) -> tuple[Any, Any, Any]:
    """Time, path and speed of a rest with an alternating speed between 60 samples at 0.1 m/s."""
    index = np.arange(120 + samples)
    rest = (index >= 60) & (index < 60 + samples)
    speed = np.where(rest, hum * np.where(index % 2, 1.0, -1.0), 0.1)
    return 0.01 * index, np.cumsum(np.where(rest, 0.0, 1e-3)), speed


@pytest.mark.parametrize(("samples", "found"), [(19, False), (20, True), (40, True)])
def test_twenty_samples_within_one_encoder_count_are_a_rest(samples: int, found: bool) -> None:
    rest = rests.still_samples(*stop(samples), COUNT_M)
    assert places(rest) == (list(range(60, 60 + samples)) if found else [])


def test_speed_of_a_rest_is_below_0_5_percent_of_the_top_speed_or_a_given_limit() -> None:
    for share, found in ((0.99, True), (1.01, False)):
        record = (*stop(40, hum=share * 5e-3 * 0.1), COUNT_M)
        assert rests.still_samples(*record).any() == found
        assert places(rests.still_samples(*record, hum=1e-3)) == list(range(60, 100))


@pytest.mark.parametrize(("samples", "found"), [(160, True), (60, False)])
def test_standstill_with_a_noisy_speed_is_a_rest_if_its_counts_resolve_the_speed_limit(
    samples: int, found: bool
) -> None:
    """1.5 counts in 60 samples of 1 ms are 2.5 mm/s, in 160 samples 0.9 mm/s; the limit is
    0.5 percent of 0.4 m/s."""
    time_s: Any = 1e-3 * np.arange(400)
    first, end = 200 - samples // 2, 200 + samples // 2
    resting = (time_s >= 1e-3 * first) & (time_s < 1e-3 * end)
    true = np.where(resting, 0.0, 0.4)
    speed = true + 0.02 * np.random.default_rng(2).standard_normal(400)
    path = quantised(np.cumsum(true) * 1e-3, COUNT_M)
    rest = rests.still_samples(time_s, path, speed, COUNT_M)
    assert rest.any() == found
    if found:
        np.testing.assert_array_equal(rest, resting)


def test_slow_motion_under_a_noisy_speed_is_not_a_rest() -> None:
    """At 4 mm/s a count of 0.1 mm lasts for 25 samples; the noise is five times the speed."""
    time_s: Any = 1e-3 * np.arange(800)
    true = np.where(time_s < 0.1, 0.4, 0.004)
    speed = true + 0.02 * np.random.default_rng(3).standard_normal(800)
    path = quantised(np.cumsum(true) * 1e-3, COUNT_M)
    assert not rests.still_samples(time_s, path, speed, COUNT_M).any()


@pytest.mark.parametrize(("counts", "found"), [(1.4, True), (1.6, False)])
def test_standstill_is_a_rest_only_if_its_path_stays_within_1_5_counts(
    counts: float, found: bool
) -> None:
    time_s, path, speed = stop(38, hum=1e-4)
    path[79:] += counts * COUNT_M
    assert rests.still_samples(time_s, path, speed, COUNT_M)[70:90].any() == found


@pytest.mark.parametrize(
    ("terms", "slow"),
    [([0.0, RATE_M_S2], slice(190, 211)), ([-3e-5, 0.0, 0.05], slice(188, 213))],
    ids=["reversal", "two reversals"],
)
def test_slow_reversal_within_one_encoder_count_is_not_a_rest(terms: Any, slow: Any) -> None:
    speed = Polynomial(terms)
    v, path = speed(SLOW_S - 1.0), quantised(speed.integ()(SLOW_S - 1.0), FINE_COUNT_M)
    assert np.ptp(path[slow]) <= FINE_COUNT_M
    v[-1] = 0.2
    assert not rests.still_samples(SLOW_S, path, v, FINE_COUNT_M).any()


def test_long_stop_between_equal_or_opposite_speeds_is_a_rest() -> None:
    inside = np.abs(SLOW_S - 1.0) < 0.4
    for moving in (np.full(400, 0.01), RATE_M_S2 * (SLOW_S - 1.0)):
        v = np.where(inside, 0.0, moving)
        path = quantised(np.cumsum(v) * 5e-3, FINE_COUNT_M)
        v[-1] = 0.2
        assert rests.still_samples(SLOW_S, path, v, FINE_COUNT_M)[140:260].all()
    # Speeds of the order of rounding errors on both sides are not a reversal.
    v = np.where(np.abs(SLOW_S - 1.0) < 0.8, 0.0, 1e-15 * np.sign(SLOW_S - 1.0))
    v[-1] = 1.0
    assert rests.still_samples(SLOW_S, np.zeros(400), v, FINE_COUNT_M)[45:355].all()


@pytest.mark.parametrize(("share", "found"), [(0.7, False), (1.1, True), (1.3, True)])
def test_stop_of_twice_the_time_of_a_slow_reversal_is_a_rest(share: float, found: bool) -> None:
    """At 8 mm/s^2 a reversal stays within 1.5 counts of 7 um for 2 sqrt(2 s / a) = 0.1 s."""
    within_s = 2.0 * np.sqrt(2.0 * 1.5 * FINE_COUNT_M / RATE_M_S2)
    beyond = np.maximum(np.abs(SLOW_S - 1.0) - share * within_s, 0.0)
    v = RATE_M_S2 * np.sign(SLOW_S - 1.0) * beyond
    path = quantised(0.5 * v * beyond, FINE_COUNT_M)
    v[-1] = 0.2
    rest = rests.still_samples(SLOW_S, path, v, FINE_COUNT_M)
    assert rest.any() == found
    if found:
        np.testing.assert_array_equal(rest[100:300], (beyond == 0.0)[100:300])


@pytest.mark.parametrize(
    ("v", "a", "edges"),
    [
        (0.25, 1.0, [5, 32, 33, 34]),  # started 0.25 s (2.5 samples) before
        (0.25, -1.0, [5, 6, 7, 34]),
        (-0.25, -1.0, [5, 32, 33, 34]),
        (0.0, 1.0, [5, 34]),
        (0.1 + 1e-9, 1.0, [5, 33, 34]),
        (100.0, 1.0, [5, *range(15, 35)]),  # at most twenty samples
    ],
)
def test_rest_edges_extend_to_the_extrapolated_motion_start(v: float, a: float, edges: Any) -> None:
    rest = mask("0" * 5 + "1" * 30 + "0" * 5)
    motion = (np.where(rest, 0.0, v), np.where(rest, 0.0, a))
    assert places(rests.rest_edges(rest, 0.1 * np.arange(40), *motion)) == edges


def test_speed_next_to_a_rest_is_backward_if_acceleration_contradicts_it() -> None:
    rest = mask("110000011")
    time_s: Any = 0.1 * np.arange(9)
    v = np.array([0.0, 0.0, -0.05, -0.02, 0.1, 0.2, 0.04, 0.0, 0.0])
    a = np.array([0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 1.0, 0.0, 0.0])
    assert places(rests.backward_near_rest(rest, time_s, v, a)) == [2, 3, 6]
    assert places(rests.backward_near_rest(rest, time_s, -v, -a)) == [2, 3, 6]
    # The correction begins at the rest and ends at the first consistent sample.
    v[2] = 0.2
    assert places(rests.backward_near_rest(rest, time_s, v, a)) == [6]
    assert not rests.backward_near_rest(mask("0" * 9), time_s, v, a).any()
    assert not rests.backward_near_rest(mask("0"), time_s[:1], v[:1], a[:1]).any()


def test_direction_next_to_a_rest_is_uncertain_up_to_a_threshold_of_the_path() -> None:
    rest = mask("11000011")
    path = np.array([0.0, 0.0, 0.5, 1.0, 3.0, 4.0, 4.9, 4.9])
    v = np.array([0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0])
    assert places(rests.uncertain_near_rest(rest, path, v, 0.9)) == [2]
    assert places(rests.uncertain_near_rest(rest, path, v, 1.0)) == [2, 3, 5]
    assert places(rests.uncertain_near_rest(rest, path, -v, 0.9)) == [2, 3, 4, 5]
    assert places(rests.uncertain_near_rest(mask("00000011"), path, v, 0.95)) == [5]
    assert not rests.uncertain_near_rest(mask("0" * 8), path, v, 0.9).any()


def test_uncertain_speed_at_a_rest_is_zeroed_if_opposite_to_a_certain_one() -> None:
    v = np.array([0.0, -0.1, 0.1, 0.5, -0.1, 0.4, -0.1, 0.2, 0.0])
    rests.without_swings(mask("100000001"), v, mask("100101001"))
    assert v.tolist() == [0.0, 0.0, 0.1, 0.5, -0.1, 0.4, 0.0, 0.2, 0.0]
    without_rest = np.array([-0.1, 0.5, -0.1])
    rests.without_swings(mask("000"), without_rest, mask("010"))
    assert without_rest.tolist() == [-0.1, 0.5, -0.1]
