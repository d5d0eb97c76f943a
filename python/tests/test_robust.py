"""Sizes and squares that a few samples do not decide."""

from __future__ import annotations

import numpy as np
import pytest
from jbf.estimation.robust import CLIPPED, clipped_square, robust_size


def test_a_robust_size_is_the_median_over_that_of_a_normal() -> None:
    assert robust_size(np.array([1.0, -2.0, 30.0])) == pytest.approx(2.0 / 0.6745)
    assert robust_size(np.zeros(0)) == 0.0
    drawn = np.random.default_rng(1).standard_normal(20000)
    assert robust_size(drawn) == pytest.approx(1.0, abs=0.02)


def test_squares_count_to_three_and_a_half_standard_deviations() -> None:
    assert CLIPPED == 3.5
    errors = np.array([0.5, -1.0, 3.4, -7.0, 1e9])
    assert clipped_square(errors, 2.0) == pytest.approx(0.25 + 1.0 + 3.4**2 + 7.0**2 + 7.0**2)
    # Of the normal's variance a clip there takes a thousandth.
    drawn = np.random.default_rng(2).standard_normal(200_000)
    assert clipped_square(drawn, 1.0) / len(drawn) == pytest.approx(0.9988, abs=0.01)
