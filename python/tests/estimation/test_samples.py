"""Samples that count, their weights, parts, innovations and blocks, on small arrays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from by_hand import Array
from coulomb_problems import STEP_S, arma_innovations, samples_of
from jbf import Rig, Run
from jbf.estimation.between_runs import BetweenRuns
from jbf.estimation.blocks import blocks_of
from jbf.estimation.campaign import Campaign
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.samples import Samples

COUNTED = (np.array([True, True, False, True]), np.array([True, False, True]))
WEIGHT = (np.array([1.0, 0.5, 0.0, 1.0]), np.array([1.0, 0.25, 1.0]))
SAMPLES = Samples(("a", "b"), (0.02, 0.1), COUNTED, WEIGHT)
VALUES = [np.array([1.0, 2.0, 3.0, 4.0]), np.array([5.0, 6.0, 7.0])]
COLOURED = Noise(0.1, 0.5)


def lists(arrays: tuple[Array, ...] | None) -> list[list[float]]:
    assert arrays is not None
    return [a.tolist() for a in arrays]


def test_samples_count_if_the_sign_of_motion_is_known_and_the_reading_is_usable() -> None:
    t = np.arange(0.0, 10.0, 0.01)
    v = 0.1 * np.sin(t - 0.015)
    run = Run.from_arrays(t, v, 5.0 * np.sign(v) + 2.0, position_m=-0.1 * np.cos(t - 0.015))
    campaign = Campaign.prepare(Rig(), [run])
    (p,), (counted,) = campaign.prepared, campaign.samples.counted
    np.testing.assert_array_equal(counted, p.motion.sign_known & p.examined.usable)
    np.testing.assert_array_equal(campaign.samples.weight[0], counted.astype(float))
    assert 0 < np.count_nonzero(~counted) < 30
    # A run that reverses at once begins with a sample of unknown sign.
    assert not counted[0]
    (moving,) = Campaign.prepare(Rig(), [run.select(t > 0.5)]).samples.counted
    assert moving[0]


def test_rms_is_over_counted_samples_and_sum_of_squares_over_weighted_samples() -> None:
    assert SAMPLES.count == 5
    assert SAMPLES.flat(VALUES).tolist() == [1.0, 2.0, 4.0, 5.0, 7.0]
    assert SAMPLES.rms(VALUES) == pytest.approx(np.sqrt((1 + 4 + 16 + 25 + 49) / 5.0))
    # Weights multiply residuals: 1 + 1 + 16 + 25 + 2.25 + 49.
    assert SAMPLES.square(VALUES) == pytest.approx(94.25)
    empty = SAMPLES.within([np.zeros(4, dtype=bool), np.zeros(3, dtype=bool)])
    assert (empty.count, empty.rms(VALUES), empty.square(VALUES)) == (0, 0.0, 0.0)
    assert empty.cost(VALUES, WHITE) == 0.0


def test_only_selects_all_properties_of_the_given_runs() -> None:
    level = tuple(0.5 * np.ones(len(w)) for w in WEIGHT)
    between = BetweenRuns(("zero",), (np.ones((4, 1)), 2.0 * np.ones((3, 1))), 0.7)
    one = replace(SAMPLES, level=level, between=between).only([1])
    assert (one.runs, one.steps_s) == (("b",), (0.1,))
    assert one.counted[0] is COUNTED[1]
    assert one.weight[0] is WEIGHT[1]
    assert one.level is not None
    assert one.level[0] is level[1]
    assert one.between is not None
    assert one.between.directions == (between.directions[1],)
    assert SAMPLES.only([1, 0]).runs == ("b", "a")
    assert SAMPLES.only([0]).between is None


def test_halves_split_each_run_in_its_middle() -> None:
    first, second = SAMPLES.halves()
    assert lists(first.counted) == [[True, True, False, False], [True, False, False]]
    assert lists(first.weight) == [[1.0, 0.5, 0.0, 0.0], [1.0, 0.0, 0.0]]
    assert lists(second.counted) == [[False, False, False, True], [False, False, True]]
    assert lists(second.weight) == [[0.0, 0.0, 0.0, 1.0], [0.0, 0.25, 1.0]]


def test_weighed_multiplies_weights_and_accumulates_the_noise_level() -> None:
    level = [np.full(4, 0.5), np.full(3, 0.8)]
    robust = [np.full(4, 0.1), np.full(3, 1.0)]
    once = SAMPLES.weighed(level, robust, None)
    np.testing.assert_allclose(once.weight[0], [0.05, 0.025, 0.0, 0.05])
    np.testing.assert_allclose(once.weight[1], [0.8, 0.2, 0.8])
    # Robust weights do not change the noise level.
    assert lists(once.level) == [[0.5] * 4, [0.8] * 3]
    twice = once.weighed(level, robust, None)
    assert twice.level is not None
    np.testing.assert_allclose(twice.level[1], 0.64)
    np.testing.assert_allclose(twice.weight[0][0], 0.0025)


def test_stacked_rows_are_innovations_of_weighted_residuals_and_derivatives() -> None:
    slopes = [np.stack([v, v**2], axis=1) for v in VALUES]
    r, j = SAMPLES.stacked(VALUES, slopes, COLOURED)
    rows, columns = [], []
    for v, w, step, slope in zip(VALUES, WEIGHT, SAMPLES.steps_s, slopes, strict=True):
        keep = w > 0.0
        rows.append(arma_innovations(v * w, step, COLOURED)[keep])
        columns.append(arma_innovations(slope * w[:, None], step, COLOURED)[keep])
    np.testing.assert_allclose(r, np.concatenate(rows))
    np.testing.assert_allclose(j, np.concatenate(columns))
    second, _ = SAMPLES.stacked(VALUES, slopes, COLOURED, [1])
    np.testing.assert_allclose(second, rows[1])
    assert len(r) == 6
    wanted = 6.0 * np.log(float(r @ r) / 6.0)
    assert SAMPLES.cost(VALUES, COLOURED) == pytest.approx(wanted)


def test_innovations_are_zero_at_samples_that_do_not_count() -> None:
    """With full weights, with the noise level only, and of all samples with weight."""
    level = (np.full(4, 0.5), np.full(3, 0.25))
    samples = replace(SAMPLES, level=level)
    has_weight = [w > 0.0 for w in WEIGHT]
    for found, weights, masks in (
        (samples.innovations(VALUES, COLOURED), WEIGHT, COUNTED),
        (samples.plain_innovations(VALUES, COLOURED), level, COUNTED),
    ):
        for e, v, w, c, step in zip(found, VALUES, weights, masks, samples.steps_s, strict=True):
            np.testing.assert_allclose(e, arma_innovations(v * c * w, step, COLOURED) * c)
    weighted = samples.weighted_innovations(VALUES, COLOURED)
    for e, v, w, c, step in zip(weighted, VALUES, WEIGHT, has_weight, SAMPLES.steps_s, strict=True):
        np.testing.assert_allclose(e, arma_innovations(v * w, step, COLOURED) * c)
    plain = SAMPLES.plain_innovations(VALUES, WHITE)
    assert [e.tolist() for e in plain] == [[1.0, 2.0, 0.0, 4.0], [5.0, 0.0, 7.0]]


def test_predicted_deviation_of_a_run_is_removed_with_shrinkage() -> None:
    """An offset with a deviation of 2 N; three readings of 3 N in noise of 1 N predict 36/13 N."""
    every = np.ones(3, dtype=bool)
    between = BetweenRuns(("zero",), (np.full((3, 1), 2.0),), 1.0)
    samples = Samples(("a",), (0.02,), (every,), (np.ones(3),), between)
    (left,) = samples.without_deviations([np.full(3, 3.0)], WHITE)
    np.testing.assert_allclose(left, 3.0 - 36.0 / 13.0)
    (e,) = samples.innovations([np.full(3, 3.0)], WHITE)
    np.testing.assert_allclose(e, left)
    # Along its only direction the covariance is 1 + 12.
    r, _ = samples.stacked([np.full(3, 3.0)], [np.zeros((3, 0))], WHITE)
    np.testing.assert_allclose(r, 3.0 / np.sqrt(13.0))
    assert samples.cost([np.full(3, 3.0)], WHITE) == pytest.approx(3.0 * np.log(9.0 / 13.0))
    assert SAMPLES.without_deviations(VALUES, WHITE) == VALUES


def test_blocks_last_a_second_or_four_memories_and_do_not_span_runs() -> None:
    samples = samples_of([np.ones(120), np.concatenate((np.zeros(30), np.ones(70)))])
    assert samples.steps_s == (STEP_S, STEP_S)
    assert blocks_of(samples, 1.0).tolist() == [0, 50, 100, 120, 170]
    # A sample worth a fiftieth: the memory is 25 samples on either side.
    assert blocks_of(samples, 0.02).tolist() == [0, 100, 120]
    sparse = samples_of([np.ones(3), np.ones(2)], step_s=5.0)
    assert blocks_of(sparse, 1.0).tolist() == [0, 2, 3]
    assert blocks_of(sparse, 10.0).tolist() == [0, 1, 2, 3, 4]
