"""Glitches of the force: single outliers, deviating ends of a record, breakaway peaks."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from jbf import Rig, Run, fit
from jbf.records.findings.ends import loose_ends
from jbf.records.findings.examine import examine
from jbf.records.findings.glitches import find_glitches, glitches
from known_motions import Array, places, white

SAMPLES = 2000
TIME_S: Any = 0.01 * np.arange(SAMPLES)
SPEED_M_S: Any = 0.2 * np.sin(1.7 * TIME_S + 0.4)
FORCE_N: Any = 5.0 * np.sign(SPEED_M_S) + 20.0 * SPEED_M_S
WAVE: Any = 10.0 * np.sin(0.7 * TIME_S)
ALTERNATING: Any = np.cumsum(np.tile([0.0, 1.0, 0.0, -1.0], 250))
"""Every second difference is one, so that the estimated noise is exactly 1 / 0.6745 / sqrt(6)."""
NOISE_OF_ALTERNATING = 1.0 / 0.6745 / np.sqrt(6.0)


def with_jumps(*jumps: tuple[int, float], noise: float = 0.1) -> Array:
    """A noisy sine with offsets at single samples."""
    values: Array = WAVE + white(SAMPLES, 1, noise)
    for i, size in jumps:
        values[i] += size
    return values


def test_outliers_of_either_sign_are_found_at_their_samples() -> None:
    assert places(glitches(with_jumps((500, 3.0), (900, -3.0)))) == [500, 900]
    assert not glitches(with_jumps()).any()


@pytest.mark.parametrize(("noises", "found"), [(7.8, False), (8.2, True)])
def test_jump_is_an_outlier_if_it_exceeds_eight_standard_deviations_of_the_noise(
    noises: float, found: bool
) -> None:
    values = ALTERNATING.copy()
    values[502] += noises * NOISE_OF_ALTERNATING
    assert glitches(values).any() == found


def test_no_outlier_is_reported_if_more_than_two_percent_of_the_samples_deviate() -> None:
    jumps = [(20 + 40 * k, 3.0) for k in range(40)]
    assert glitches(with_jumps(*jumps)).sum() == 40
    assert not glitches(with_jumps(*jumps, (1700, 3.0))).any()


def test_size_of_a_glitch_finding_is_the_largest_distance_from_the_mean_of_neighbours() -> None:
    force = with_jumps((200, 3.0), (500, -7.0), (700, 3.0))
    speed = np.full(SAMPLES, 0.1)
    (finding,), mask = find_glitches(Run.from_arrays(TIME_S, speed, force, name="a"), speed)
    assert places(mask) == [200, 500, 700]
    assert finding.size == pytest.approx(abs(force[500] - 0.5 * (force[499] + force[501])))
    assert (finding.kind, finding.channel, finding.run) == ("glitches", "friction_n", "a")
    assert (finding.unit, finding.done) == ("N", "set aside")


@pytest.mark.parametrize(
    ("before", "after", "first", "last"),
    [
        (0.1, -0.1, 998, 1003),  # a reversal at sample 1000
        (0.0, 0.1, 998, 1003),  # a start from rest
        (0.0019, 0.1, 998, 1003),  # slower than a fiftieth of the top speed: rest
        (0.0021, 0.1, None, None),  # a change of speed only
    ],
)
def test_peak_within_three_samples_of_breakaway_is_not_an_outlier(
    before: float, after: float, first: int | None, last: int | None
) -> None:
    speed = np.where(np.arange(SAMPLES) <= 1000, before, after)
    not_reported = []
    for sample in range(994, 1008):
        force = with_jumps((sample, 9.0))
        _, mask = find_glitches(Run.from_arrays(TIME_S, speed, force), speed)
        if not mask[sample]:
            not_reported.append(sample)
    assert not_reported == ([] if first is None or last is None else list(range(first, last + 1)))


@pytest.mark.parametrize("count", [1, 2, 3, 4])
@pytest.mark.parametrize("last", [False, True])
def test_up_to_three_deviating_samples_at_an_end_of_a_record_are_outliers(
    count: int, last: bool
) -> None:
    values = white(1000, 1)
    part = slice(len(values) - count, None) if last else slice(count)
    values[part] += 60.0
    expected = np.zeros(len(values), dtype=bool)
    # Four samples are a change of level, not an outlier.
    expected[part] = count <= 3
    np.testing.assert_array_equal(loose_ends(TIME_S[:1000], values, 1), expected)


@pytest.mark.parametrize(("jump", "found"), [(3.99, False), (4.01, True)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_end_sample_is_an_outlier_if_it_deviates_by_four_times_the_largest_change(
    jump: float, found: bool, sign: float
) -> None:
    values = np.arange(200) % 2.0
    values[0] = values[1] + sign * jump
    assert loose_ends(TIME_S[:200], values, 1)[0] == found


def test_outlier_in_the_last_sample_of_a_parabola_is_found_if_sampling_is_uneven() -> None:
    time_s = np.cumsum(np.random.default_rng(3).uniform(0.5, 1.5, 200)) * 0.01
    path = 3.0 + 20.0 * time_s - 4.0 * time_s**2 + white(200, 4, 1e-4)
    assert not loose_ends(time_s, path, 3).any()
    path[-1] += 0.02
    assert places(loose_ends(time_s, path, 3)) == [199]


def noisy_run(force: Any, speed: Any = None) -> Run:
    v = SPEED_M_S + white(SAMPLES, 5, 1e-4) if speed is None else speed
    return Run.from_arrays(TIME_S, v, force, name="a")


@pytest.mark.parametrize("end", [0, SAMPLES - 1])
def test_outlier_at_an_end_of_the_force_is_a_glitch_and_not_usable(end: int) -> None:
    force = FORCE_N + white(SAMPLES, 6, 0.1)
    force[end] = 400.0
    found = examine(noisy_run(force))
    assert places(~found.usable) == [end]
    assert [f.kind for f in found.findings] == ["glitches"]
    # A larger outlier within the record does not hide it.
    force[500] = 900.0
    found = examine(noisy_run(force))
    assert set(places(~found.usable)) == {end, 500}


def test_fit_changes_by_less_than_0_2_percent_if_the_first_row_is_corrupt() -> None:
    clean, corrupt = [], []
    for seed in (6, 8):
        force, speed = FORCE_N + white(SAMPLES, seed, 0.1), SPEED_M_S + white(SAMPLES, 5, 1e-4)
        clean.append(noisy_run(force.copy(), speed.copy()))
        speed[0], force[0] = 99.0, -1234.5
        corrupt.append(noisy_run(force, speed))
    expected = fit(Rig(), clean, law="coulomb")
    found = fit(Rig(), corrupt, law="coulomb")
    for name, value in expected.values.items():
        assert found.values[name] == pytest.approx(value, rel=2e-3), name
