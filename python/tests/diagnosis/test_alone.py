"""Minimum distinguishable strength of an effect: probabilities against simulated gains."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from by_hand import coulomb
from jbf import Rig, Run
from jbf.diagnosis.alone import (
    NEVER,
    Change,
    chance_apart,
    chance_found,
    left_apart,
    times_alone,
    worth,
)
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.power import non_centrality, power
from jbf.diagnosis.strength import RunsAtHand
from jbf.estimation.campaign import Campaign
from scipy import stats

Array = npt.NDArray[np.float64]
PRICE, TIE, CHANCE, DRAWS = 30.0, 8.0, 0.8, 40_000


def simulated_gains(correlation: float, size: float) -> tuple[Array, Array]:
    """Gains of an effect of this size (in units of the noise), and of a correlated rival."""
    observed = np.array([size, 0.0]) + np.random.default_rng(2).standard_normal((DRAWS, 2))
    rival = np.array([correlation, np.sqrt(1.0 - correlation**2)])
    return observed[:, 0] ** 2, (observed @ rival) ** 2


@pytest.mark.parametrize(("unexplained", "margin"), [(4.0, 8.0), (3.0, 2.0), (10.0, 40.0)])
def test_difference_of_gains_is_normal_with_four_times_its_mean_as_variance(
    unexplained: float, margin: float
) -> None:
    expected = stats.norm.sf(margin, loc=unexplained**2, scale=2.0 * unexplained)
    assert chance_apart(unexplained, margin) == pytest.approx(float(expected))


@pytest.mark.parametrize("parameters", [1, 3])
def test_detection_probability_is_that_of_a_noncentral_chi_square(parameters: int) -> None:
    found = chance_found(np.array([10.0, 30.0]), parameters, 25.0)
    assert found == pytest.approx(stats.ncx2.sf([10.0, 30.0], parameters, 25.0), abs=1e-6)


@pytest.mark.parametrize("correlation", [0.3, 0.8, 0.9])
def test_effect_of_the_returned_strength_is_distinguished_with_the_given_probability(
    correlation: float,
) -> None:
    size = np.sqrt(non_centrality(PRICE, 1, CHANCE))
    rivals = {"rival": (size * np.sqrt(1.0 - correlation**2), TIE)}
    times = times_alone(PRICE, 1, size**2, rivals, CHANCE)
    own, rival = simulated_gains(correlation, times * size)
    alone = float(np.mean((own > PRICE) & (own - rival > TIE)))
    # The two events are treated as independent, which requires slightly more than necessary.
    assert CHANCE - 0.01 < alone < CHANCE + 0.06


def test_strength_is_one_without_rivals_and_infinite_with_an_inseparable_rival() -> None:
    square = non_centrality(PRICE, 1, CHANCE)
    assert times_alone(PRICE, 1, square, {}, CHANCE) == pytest.approx(1.0, abs=1e-6)
    assert times_alone(PRICE, 1, square, {"rival": (100.0, TIE)}, CHANCE) < 1.01
    for unexplained in (0.0, 0.01):
        rivals = {"far": (100.0, TIE), "near": (unexplained, TIE)}
        assert times_alone(PRICE, 1, square, rivals, CHANCE) == np.inf


def test_distinguishable_strength_far_above_the_threshold_depends_on_the_rival_only() -> None:
    """Far above the threshold the strength follows from l^2 - 1.683 l = margin at 80 %."""
    square = non_centrality(PRICE, 1, CHANCE)
    quantile = 2.0 * stats.norm.ppf(CHANCE)
    needed = 0.5 * (quantile + np.sqrt(quantile**2 + 4.0 * TIE))
    rivals = {"rival": (2.0 * needed / NEVER, TIE)}
    times = times_alone(PRICE, 1, square, rivals, CHANCE)
    assert times == pytest.approx(0.5 * NEVER, rel=0.01)


def test_sample_counts_with_at_most_three_standard_deviations() -> None:
    assert worth(np.array([1.0, -2.0, 100.0])) == pytest.approx(1.0 + 4.0 + 9.0)


def swings(velocity_noise: float = 0.0) -> Candidates:
    """Reversing slides with a noise of a hundredth of the friction."""
    runs = []
    for k, rate in enumerate((1.1, 1.7, 2.3)):
        t = np.arange(0.0, 30.0, 0.02)
        v = 0.1 * np.sin(rate * t)
        noise, error = np.random.default_rng(k).standard_normal((2, len(t)))
        force = coulomb(t, v, v) + 0.05 * noise
        runs.append(Run.from_arrays(t, v + velocity_noise * error, force, name=f"{k}"))
    return Candidates(Campaign.prepare(Rig(), runs), "coulomb", "journal")


def test_unexplained_part_of_a_change_is_the_residual_of_a_regression_on_the_rival() -> None:
    at_hand = RunsAtHand(swings(), ())
    random = np.random.default_rng(5)
    lengths = [len(f) for f in at_hand.now]
    changes = [0.02 * random.standard_normal((n, 2)) for n in lengths]
    mixed = [c @ np.array([[0.6], [0.8]]) for c in changes]
    own = Change(mixed, None, at_hand.shown(mixed))
    first = [c[:, :1] for c in changes]
    rival = Change(first, None, at_hand.shown(first))
    design = at_hand.shown(first)[:, 0]
    target = at_hand.shown(mixed)[:, 0]
    residual = target - design * float(design @ target) / float(design @ design)
    assert left_apart(own, rival, at_hand) == pytest.approx(np.sqrt(worth(residual)), rel=1e-6)
    assert left_apart(own, own, at_hand) == pytest.approx(0.0, abs=1e-6)


def test_effects_are_compared_only_at_samples_that_have_weight_in_both() -> None:
    """A rival without weight in the second half is compared in the first half only."""
    at_hand = RunsAtHand(swings(), ())
    lengths = [len(f) for f in at_hand.now]
    random = np.random.default_rng(5)
    everywhere = [random.standard_normal((n, 1)) for n in lengths]
    first_half = [(np.arange(n) < n // 2).astype(float) for n in lengths]
    own = Change(everywhere, None, at_hand.shown(everywhere))
    weighted = [c * s[:, None] for c, s in zip(everywhere, first_half, strict=True)]
    rival = Change(weighted, first_half, at_hand.shown(weighted))
    assert left_apart(own, rival, at_hand) < 1e-4
    assert left_apart(rival, own, at_hand) < 1e-4
    all_samples = Change(weighted, None, at_hand.shown(weighted))
    assert left_apart(own, all_samples, at_hand) > 10.0


@pytest.mark.parametrize("velocity_noise", [0.0, 1e-3])
def test_delay_and_lag_are_confounded_if_instants_of_reversals_are_uncertain(
    velocity_noise: float,
) -> None:
    """With an exact velocity they differ within a sample of 20 ms."""
    names = ["time_delay", "sensor_lag"]
    found = {p.effect: p for p in power(swings(velocity_noise), (), names)}
    for name, other in (names, names[::-1]):
        own = found[name]
        assert own.found_80 is not None
        if velocity_noise:
            assert other in own.like
            assert own.alone_80 is None or own.alone_80 > 1.2 * own.found_80
        else:
            assert own.alone_80 is not None
            assert own.alone_80 < 2e-3
