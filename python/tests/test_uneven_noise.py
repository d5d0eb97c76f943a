"""Sizes of noise differ, or do not, whatever the unit and however many samples each is of."""

from __future__ import annotations

import numpy as np
import pytest
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.uneven_noise import _uneven
from jbf.estimation.robust import robust_size

COUNTS = np.array([210, 40, 90, 700])


@pytest.mark.parametrize("unit", [1e-4, 1.0, 1e4])
def test_noise_of_one_size_is_even_but_for_chance(unit: float) -> None:
    random = np.random.default_rng(2)
    even = uneven = apart = 0
    for _ in range(200):
        drawn = [unit * random.normal(0.0, 1.0, n) for n in COUNTS]
        sizes = np.array([robust_size(x) for x in drawn])
        apart += sizes.max() > DEFAULT.uneven_noise * sizes.min()
        even += _uneven(sizes, COUNTS, DEFAULT)
        uneven += _uneven(sizes * np.array([1.0, 1.0, 4.0, 1.0]), COUNTS, DEFAULT)
    # That so few samples are far apart by chance is usual, and nothing.
    assert apart > 30
    assert even <= 4
    assert uneven > 180
