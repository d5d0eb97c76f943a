"""The spread of a random effect by the formulas of DerSimonian & Laird (1986), worked by hand."""

from __future__ import annotations

import numpy as np
import pytest
from jbf.estimation.random_effect import spread_between
from scipy import stats


def test_of_equal_precisions_it_is_what_the_sample_variance_has_above_one() -> None:
    """Estimates of unit error: their variance 4 is 3 more than chance; Q = 8 of two degrees."""
    spread, chance, times = spread_between(np.array([5.0, 7.0, 9.0]), np.ones(3))
    assert spread == pytest.approx(np.sqrt(3.0))
    # Half of Q, by a chi-square of two degrees: exp(-4 / 2).
    assert chance == pytest.approx(np.exp(-2.0))
    assert times == pytest.approx(4.0)


def test_of_unequal_precisions_the_better_known_count_for_more() -> None:
    """Mean 4, Q = 16 + 4 = 20 of one degree; 19 over 5 - 17 / 5."""
    spread, chance, times = spread_between(np.array([0.0, 5.0]), np.array([1.0, 4.0]))
    assert spread == pytest.approx(np.sqrt(19.0 / 1.6))
    assert chance == pytest.approx(stats.chi2.sf(10.0, 1))
    assert times == pytest.approx(20.0)


def test_runs_that_agree_have_no_spread() -> None:
    assert spread_between(np.full(4, 2.5), np.array([1.0, 2.0, 3.0, 4.0])) == (0.0, 1.0, 0.0)
    # Nor those that differ by less than their errors.
    spread, chance, times = spread_between(np.array([-0.5, 0.5]), np.ones(2))
    assert spread == 0.0
    assert times == pytest.approx(0.5)
    assert chance == pytest.approx(stats.chi2.sf(0.25, 1))


def test_the_unit_of_the_estimates_is_that_of_the_spread() -> None:
    estimates, precisions = np.array([1.0, 4.0, 2.0, 9.0]), np.array([1.0, 3.0, 2.0, 5.0])
    one = spread_between(estimates, precisions)
    other = spread_between(1e3 * estimates, 1e-6 * precisions)
    assert other[0] == pytest.approx(1e3 * one[0])
    assert other[1:] == pytest.approx(one[1:])
