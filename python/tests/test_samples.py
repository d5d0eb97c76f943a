"""Which samples count: parts of them, and what two models share, on a run of four samples."""

from __future__ import annotations

import numpy as np
import pytest
from jbf import Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.likelihood import likelihood_gain
from jbf.estimation.noise import WHITE
from jbf.estimation.samples import Samples, least_weights
from jbf.estimation.solution import Solution


def samples(*weights: float) -> Samples:
    """One run; a sample of full weight counts."""
    weight = np.array(weights)
    return Samples(("a",), (0.01,), (weight == 1.0,), (weight,))


def solution(residuals: list[float], kept: Samples) -> Solution:
    r = [np.array(residuals)]
    cost = kept.cost(r, WHITE)
    return Solution((), np.zeros(0), r, [np.zeros((4, 0))], WHITE, cost, True, "", kept)


def test_two_models_share_the_smaller_of_their_weights() -> None:
    both = least_weights(samples(1.0, 0.5, 1.0, 0.0), samples(1.0, 1.0, 0.25, 1.0))
    assert both.weight[0].tolist() == [1.0, 0.5, 0.25, 0.0]
    assert both.counted[0].tolist() == [True, False, False, False]


def test_a_gain_is_of_the_samples_that_both_models_keep() -> None:
    # The second sample, which the richer model leaves out, is not to its credit.
    richer = solution([1.0, 50.0, 1.0, 1.0], samples(1.0, 0.0, 1.0, 1.0))
    simpler = solution([2.0, 7.0, 2.0, 2.0], samples(1.0, 1.0, 1.0, 1.0))
    assert likelihood_gain(richer, simpler) == pytest.approx(3.0 * np.log(4.0))


def test_halves_and_masks_take_weight_and_count_alike() -> None:
    first, second = samples(1.0, 0.5, 1.0, 1.0).halves()
    assert first.weight[0].tolist() == [1.0, 0.5, 0.0, 0.0]
    assert second.weight[0].tolist() == [0.0, 0.0, 1.0, 1.0]
    assert (first.count, second.count) == (1, 2)


def test_what_does_not_count_has_no_say_in_a_test() -> None:
    kept = samples(1.0, 0.5, 1.0, 0.0)
    assert kept.tested().weight[0].tolist() == [1.0, 0.0, 1.0, 0.0]
    assert kept.rms([np.array([3.0, 90.0, 4.0, 90.0])]) == pytest.approx(np.sqrt(12.5))
    assert kept.square([np.array([3.0, 2.0, 4.0, 90.0])]) == pytest.approx(26.0)


def test_a_run_that_turns_at_once_does_not_count_where_a_model_has_it_at_rest() -> None:
    t = np.arange(0.0, 10.0, 0.01)
    v = 0.1 * np.sin(t - 0.015)
    run = Run.from_arrays(t, v, 5.0 * np.sign(v) + 2.0, position_m=-0.1 * np.cos(t - 0.015))
    (turning,) = Campaign.prepare(Rig(), [run]).samples.counted
    assert not turning[0]
    (moving,) = Campaign.prepare(Rig(), [run.select(t > 0.5)]).samples.counted
    assert moving[0]
