"""Glitches of the force: single outliers, deviating ends of a record, breakaway peaks."""

from typing import Any

import numpy as np
import pytest
from jbf import Rig, Run, fit
from jbf.records.findings.ends import end_outliers
from jbf.records.findings.examine import examine
from jbf.records.findings.glitches import find_glitches, glitches
from known_motions import Array, places, white

SAMPLES = 2000
TIME_S: Any = 0.01 * np.arange(SAMPLES)
SPEED_M_S: Any = 0.2 * np.sin(1.7 * TIME_S + 0.4)
FORCE_N: Any = 5.0 * np.sign(SPEED_M_S) + 20.0 * SPEED_M_S
WAVE: Any = 10.0 * np.sin(0.7 * TIME_S)
ALTERNATING: Any = np.cumsum(np.tile([0.0, 1.0, 0.0, -1.0], 250))
NOISE_OF_ALTERNATING = 1.0 / 0.6745 / np.sqrt(6.0)
"""Every second difference is one; in unit white noise second differences have a variance of 6."""


def with_jumps(*jumps: tuple[int, float]) -> Array:
    """A noisy sine with offsets at single samples."""
    values: Array = WAVE + white(SAMPLES, 1, 0.1)
    for i, size in jumps:
        values[i] += size
    return values


@pytest.mark.parametrize(("sd", "found"), [(7.8, False), (8.2, True)])
def test_force_jump_beyond_eight_standard_deviations_is_an_outlier(sd: float, found: bool) -> None:
    values = ALTERNATING.copy()
    values[502] += sd * NOISE_OF_ALTERNATING
    assert glitches(values).any() == found


def test_no_force_outlier_is_reported_if_over_two_percent_of_samples_deviate() -> None:
    jumps = [(20 + 40 * k, 3.0) for k in range(40)]
    assert glitches(with_jumps(*jumps)).sum() == 40
    assert not glitches(with_jumps(*jumps, (1700, 3.0))).any()


def test_force_glitch_size_is_the_largest_distance_from_the_neighbours_mean() -> None:
    force = with_jumps((200, 3.0), (500, -7.0), (700, 3.0))
    speed = np.full(SAMPLES, 0.1)
    (finding,), mask = find_glitches(Run.from_arrays(TIME_S, speed, force, name="a"), speed)
    assert places(mask) == [200, 500, 700]
    assert finding.size == pytest.approx(abs(force[500] - 0.5 * (force[499] + force[501])))
    assert (finding.kind, finding.channel, finding.run) == ("glitches", "friction_n", "a")
    assert (finding.unit, finding.done) == ("N", "excluded")


@pytest.mark.parametrize(
    ("before", "after", "breakaway"),
    [
        (0.1, -0.1, True),  # a reversal at sample 1000
        (0.0, 0.1, True),  # a start from rest
        (0.0019, 0.1, True),  # below a fiftieth of the top speed: a rest
        (0.0021, 0.1, False),  # a change of speed only
    ],
)
def test_force_peak_within_three_samples_of_breakaway_is_not_an_outlier(
    before: float, after: float, breakaway: bool
) -> None:
    speed = np.where(np.arange(SAMPLES) <= 1000, before, after)
    for sample in range(994, 1008):
        force = with_jumps((sample, 9.0))
        _, mask = find_glitches(Run.from_arrays(TIME_S, speed, force), speed)
        assert mask[sample] == (not breakaway or not 998 <= sample <= 1003), sample


@pytest.mark.parametrize("count", [1, 2, 3, 4])
@pytest.mark.parametrize("last", [False, True])
def test_up_to_three_deviating_samples_at_a_record_end_are_outliers(count: int, last: bool) -> None:
    values, expected = white(1000, 1), np.zeros(1000, dtype=bool)
    part = slice(1000 - count, None) if last else slice(count)
    values[part] += 60.0
    # Four samples are a step change, not an outlier.
    expected[part] = count <= 3
    np.testing.assert_array_equal(end_outliers(TIME_S[:1000], values, 1), expected)


def test_end_sample_is_an_outlier_beyond_four_times_the_largest_change() -> None:
    for jump, found in ((3.99, False), (-3.99, False), (4.01, True), (-4.01, True)):
        values = np.arange(200) % 2.0
        values[0] = values[1] + jump
        assert end_outliers(TIME_S[:200], values, 1)[0] == found, jump


def test_outlier_at_the_end_of_a_parabola_is_detected_if_sampling_is_uneven() -> None:
    time_s = np.cumsum(np.random.default_rng(3).uniform(0.5, 1.5, 200)) * 0.01
    path = 3.0 + 20.0 * time_s - 4.0 * time_s**2 + white(200, 4, 1e-4)
    assert not end_outliers(time_s, path, 3).any()
    path[-1] += 0.02
    assert places(end_outliers(time_s, path, 3)) == [199]


def noisy_speed() -> Any:
    return SPEED_M_S + white(SAMPLES, 5, 1e-4)


@pytest.mark.parametrize("end", [0, SAMPLES - 1])
def test_outlier_at_an_end_of_the_force_is_a_glitch_and_not_usable(end: int) -> None:
    force = FORCE_N + white(SAMPLES, 6, 0.1)
    force[end] = 400.0
    examined = examine(Run.from_arrays(TIME_S, noisy_speed(), force))
    assert places(~examined.usable) == [end]
    assert [f.kind for f in examined.findings] == ["glitches"]
    # A larger outlier within the record does not mask it.
    force[500] = 900.0
    examined = examine(Run.from_arrays(TIME_S, noisy_speed(), force))
    assert set(places(~examined.usable)) == {end, 500}


def test_fit_changes_by_under_0_2_percent_if_the_first_rows_are_corrupt() -> None:
    clean, corrupt = [], []
    for seed in (6, 8):
        force, speed = FORCE_N + white(SAMPLES, seed, 0.1), noisy_speed()
        clean.append(Run.from_arrays(TIME_S, speed, force))
        speed[0], force[0] = 99.0, -1234.5
        corrupt.append(Run.from_arrays(TIME_S, speed, force))
    expected = fit(Rig(), clean, law="coulomb").params
    assert fit(Rig(), corrupt, law="coulomb").params == pytest.approx(expected, rel=2e-3)
