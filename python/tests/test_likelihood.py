"""Gains in twice the log likelihood, and what samples are worth: small systems solved by hand."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from jbf.estimation.blocks import blocks_of
from jbf.estimation.likelihood import (
    effective_share,
    gain_of_most,
    independent_share,
    least_squares,
    likelihood_gain,
    next_step_gain,
    promised_gain,
    share_of_gain,
    spanned,
    unexplained,
    unexplained_square,
)
from jbf.estimation.noise import LONGEST_MEMORY_S, WHITE
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution

Array = npt.NDArray[np.float64]


def samples_of(weight: list[Array], step_s: float = 0.02) -> Samples:
    names = tuple(f"{i}" for i in range(len(weight)))
    counted = tuple(w > 0.0 for w in weight)
    return Samples(names, (step_s,) * len(weight), counted, tuple(weight))


def solved(
    residuals: list[Array], samples: Samples, jacobian: list[Array] | None = None
) -> Solution:
    """A solution of these residuals, with the cost that they have."""
    ways = jacobian or [np.zeros((len(r), 0)) for r in residuals]
    cost = samples.cost(residuals, WHITE)
    return Solution((), np.zeros(0), residuals, ways, WHITE, cost, True, "", samples)


# ---- gains -------------------------------------------------------------------------------------


def test_a_gain_is_the_count_times_the_log_of_the_squares() -> None:
    """Residuals of 6 N that become 3 N, at each of 100 samples: 100 log 4."""
    samples = samples_of([np.ones(60), np.ones(40)])
    before = solved([np.full(60, 6.0), np.full(40, -6.0)], samples)
    after = solved([np.full(60, 3.0), np.full(40, 3.0)], samples)
    assert likelihood_gain(after, before) == pytest.approx(100.0 * np.log(4.0))
    assert likelihood_gain(before, after) == pytest.approx(-100.0 * np.log(4.0))


def test_models_that_weigh_samples_unlike_are_compared_by_the_smaller_weights() -> None:
    """What the richer one leaves out is no gain of its own, nor any loss."""
    whole, part = np.ones(100), np.concatenate((np.zeros(40), np.ones(60)))
    before = solved([np.full(100, 2.0)], samples_of([whole]))
    after = solved([np.concatenate((np.full(40, 9.0), np.ones(60)))], samples_of([part]))
    assert likelihood_gain(after, before) == pytest.approx(60.0 * np.log(4.0))


def test_a_gain_of_most_is_no_gain_of_one_sample() -> None:
    """A sample a hundred standard deviations off, which one of two models follows; and a level of
    half a standard deviation everywhere, which the other does not know."""
    drawn = np.random.default_rng(4).standard_normal(1000)
    samples = samples_of([np.ones(600), np.ones(400)])
    off = drawn.copy()
    off[700] += 100.0
    followed = solved([drawn[:600], drawn[600:]], samples)
    of_one = solved([off[:600], off[600:]], samples)
    assert likelihood_gain(followed, of_one) > 2000.0
    assert 0.0 < gain_of_most(followed, of_one) < 1.1 * 3.5**2
    level = solved([drawn[:600] + 0.5, drawn[600:] + 0.5], samples)
    assert gain_of_most(followed, level) == pytest.approx(250.0, rel=0.15)
    assert gain_of_most(level, followed) < -180.0
    # In units of what is left: of half the size all of it is the same.
    halves = [
        solved([0.5 * r for r in solution.residuals], samples) for solution in (followed, of_one)
    ]
    assert gain_of_most(*halves) == pytest.approx(gain_of_most(followed, of_one))


def test_where_most_is_fitted_exactly_every_gain_is_one_of_most() -> None:
    samples = samples_of([np.ones(100)])
    exact, before = (solved([size * np.ones(100)], samples) for size in (0.0, 1.0))
    assert gain_of_most(exact, before) == np.inf


def test_what_a_step_promises_is_by_what_it_leaves() -> None:
    """Of the vector (3, 4) a step along the first axis leaves 4: 25 becomes 16."""
    r, j = np.array([3.0, 4.0]), np.array([[1.0], [0.0]])
    assert promised_gain(r, j, 10) == pytest.approx(10.0 * np.log(25.0 / 16.0))
    assert promised_gain(r, np.zeros((2, 1)), 10) == 0.0
    solution = solved([r], samples_of([np.ones(2)]), [j])
    assert next_step_gain(solution) == pytest.approx(2.0 * np.log(25.0 / 16.0))
    converged = solved([np.array([0.0, 4.0])], samples_of([np.ones(2)]), [j])
    assert next_step_gain(converged) == pytest.approx(0.0, abs=1e-12)


# ---- columns of a design -----------------------------------------------------------------------

DESIGN = np.array([[1.0, 0.0, 1.0], [0.0, 2.0, 2.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
"""Three columns, of which the third is the sum of the others."""
TARGET = np.array([3.0, 8.0, -1.0, 2.0])


@pytest.mark.parametrize("scale", [1e-200, 1e-3, 1.0, 1e200])
def test_what_columns_do_not_explain_is_what_lies_across_them(scale: float) -> None:
    """However long they are: only their directions matter."""
    assert unexplained(scale * DESIGN, TARGET) == pytest.approx([0.0, 0.0, -1.0, 2.0], abs=1e-12)
    assert unexplained_square(scale * DESIGN, TARGET) == pytest.approx(5.0)
    span = spanned(scale * DESIGN)
    assert span.shape == (4, 2)
    assert span.T @ span == pytest.approx(np.eye(2), abs=1e-12)
    assert span @ (span.T @ TARGET) == pytest.approx([3.0, 8.0, 0.0, 0.0], abs=1e-12)


def test_columns_of_nothing_explain_nothing() -> None:
    empty = np.column_stack([np.zeros(4), DESIGN[:, 0], np.zeros(4)])
    assert unexplained(empty, TARGET) == pytest.approx([0.0, 8.0, -1.0, 2.0])
    assert spanned(empty).shape == (4, 1)
    assert spanned(np.zeros((4, 2))).shape == (4, 0)
    assert unexplained(np.zeros((4, 2)), TARGET) == pytest.approx(TARGET)


def test_the_step_along_columns_is_the_shortest_that_explains_most() -> None:
    """Of two columns that are one, each by its length takes half; one of nothing stays put."""
    assert least_squares(DESIGN[:, :2], TARGET) == pytest.approx([3.0, 4.0])
    twice = np.column_stack([DESIGN[:, 0], DESIGN[:, 0], np.zeros(4)])
    assert least_squares(twice, TARGET) == pytest.approx([1.5, 1.5, 0.0])
    assert least_squares(1e-2 * DESIGN[:, :2], TARGET) == pytest.approx([300.0, 400.0])
    assert least_squares(1e3 * twice, TARGET) == pytest.approx([1.5e-3, 1.5e-3, 0.0])


# ---- what a sample is worth --------------------------------------------------------------------


def by_definition(runs: list[Array], step_s: float) -> float:
    """Bartlett's formula, one lag after the other, to the first that chance could make."""
    middle = np.mean(np.concatenate(runs))
    count = sum(map(len, runs))

    def lagged(k: int) -> float:
        return sum(float(np.sum((e[k:] - middle) * (e[: len(e) - k] - middle))) for e in runs)

    rho = 0.0
    for k in range(1, int(0.6 / step_s) + 2):
        own = lagged(k) / lagged(0)
        if own < 2.0 / np.sqrt(count):
            break
        rho += own
    return 1.0 / (1.0 + 2.0 * rho)


@pytest.mark.parametrize("step_s", [0.02, 0.25])
@pytest.mark.parametrize("length", [1, 4, 12])
def test_a_sample_is_worth_what_its_autocorrelations_leave(length: int, step_s: float) -> None:
    """Moving means of so many samples, in runs of unlike length, about a level."""
    random = np.random.default_rng(length)
    runs = [
        2.0 + np.convolve(random.standard_normal(n), np.ones(length), "valid") for n in (400, 250)
    ]
    found = independent_share(runs, (step_s, step_s))
    assert found == pytest.approx(by_definition(runs, step_s), rel=1e-9)
    assert found == pytest.approx(1.0 / length, rel=0.5) or step_s > 0.1


def test_the_sum_ends_with_the_longest_memory_of_a_noise() -> None:
    """Of what never forgets 0.6 s are summed, and the sample after them."""
    ramp = np.linspace(-1.0, 1.0, 4000)
    for step_s, lags in ((0.02, 31), (0.125, 5), (1.0, 1)):
        found = independent_share([ramp], (step_s,))
        assert found == pytest.approx(1.0 / (1 + 2 * lags), rel=0.03)
    # The finest step of all runs says how many samples that is.
    both = independent_share([ramp, ramp], (0.125, 0.02))
    assert both == pytest.approx(1.0 / 63.0, rel=0.03)


def test_of_nothing_each_sample_is_as_independent_as_can_be() -> None:
    assert independent_share([np.zeros(50)], (0.02,)) == 1.0


def test_the_share_of_a_solution_is_of_its_weighted_innovations() -> None:
    random = np.random.default_rng(3)
    slow = np.repeat(random.standard_normal(100), 5)
    weight = np.where(np.arange(500) % 3 == 0, 0.5, 1.0)
    solution = solved([slow], samples_of([weight]))
    wanted = independent_share([slow * weight], (0.02,))
    assert wanted < 0.5
    assert effective_share(solution) == wanted
    # It is known once and for all.
    assert effective_share(solution) == wanted


def test_a_gain_in_white_noise_counts_in_full_and_one_in_slow_noise_by_its_share() -> None:
    random = np.random.default_rng(4)
    samples = samples_of([np.ones(2000)])
    way = np.sin(0.01 * np.arange(2000))
    white = random.standard_normal(2000)
    slow = np.repeat(random.standard_normal(200), 10)
    for noise, low, high in ((white, 0.8, 1.0), (slow, 0.03, 0.25)):
        after = solved([noise], samples)
        before = solved([noise + way], samples)
        assert low <= share_of_gain(after, before) <= high
        assert share_of_gain(after, before) <= effective_share(after)


def test_a_gain_where_the_noise_is_larger_counts_by_its_long_run_variance() -> None:
    """Noise ten times as large where the two models differ: white, but 0.1 + 0.9 / 100 of it is."""
    n = 4000
    here = np.arange(n) % 10 == 0
    noise = np.random.default_rng(5).standard_normal(n) * np.where(here, 10.0, 1.0)
    samples = samples_of([np.ones(n)])
    after = solved([noise], samples)
    before = solved([noise + 0.1 * here], samples)
    white = np.mean(noise**2)
    assert effective_share(after) > 0.9
    assert share_of_gain(after, before) == pytest.approx(white / 100.0, rel=0.35)
    # Between models that differ everywhere alike it counts in full.
    evenly = solved([noise + 0.1 * np.where(np.arange(n) % 2, 1.0, -1.0)], samples)
    assert share_of_gain(after, evenly) > 0.75


# ---- blocks ------------------------------------------------------------------------------------


def test_blocks_are_a_second_long_or_four_memories_and_none_spans_two_runs() -> None:
    samples = samples_of([np.ones(120), np.concatenate((np.zeros(30), np.ones(70)))])
    assert blocks_of(samples, 1.0).tolist() == [0, 50, 100, 120, 170]
    # A sample worth a fiftieth remembers 25: four times as much is a hundred.
    assert blocks_of(samples, 0.02).tolist() == [0, 100, 120]
    rare = samples_of([np.ones(3), np.ones(2)], step_s=5.0)
    # Two at least, of white noise; a step of more than a second is a block by itself no more.
    assert blocks_of(rare, 1.0).tolist() == [0, 2, 3]
    assert blocks_of(rare, 10.0).tolist() == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("step_s", [0.02, 0.1])
def test_autocorrelations_are_summed_until_they_sink_into_chance(step_s: float) -> None:
    """By products of each sample with those behind it: up to two over the root of their number,
    and no further than noise remembers."""
    near, longest = 0, int(LONGEST_MEMORY_S / step_s) + 1
    for seed in range(30):
        random = np.random.default_rng(seed)
        kicks = [random.standard_normal(n) for n in (900, 700)]
        runs = [k[8:] + 0.075 * sum(k[8 - i : len(k) - i] for i in range(1, 8)) for k in kicks]
        middle = np.concatenate(runs).mean()
        off = [r - middle for r in runs]
        whole = sum(float(r @ r) for r in off)
        chance = 2.0 / np.sqrt(sum(map(len, runs)))
        added = 0.0
        for lag in range(1, longest + 1):
            rho = sum(float(r[lag:] @ r[:-lag]) for r in off) / whole
            if rho < chance:
                break
            near += rho < 1.5 * chance
            added += rho
        found = independent_share(runs, [step_s] * 2)
        assert found == pytest.approx(1.0 / (1.0 + 2.0 * added))
    assert near > 20
