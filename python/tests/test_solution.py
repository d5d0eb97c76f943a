"""What follows from the values at which a search ended."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, replace
from typing import Any

import numpy as np
import pytest
from jbf.estimation.noise import Noise
from jbf.estimation.solution import Solution
from made_of import record, samples_of

N = 6
COLOURED = Noise(0.1, 0.5)
RUNS = [record(0.02 * np.arange(N), name=name) for name in "ab"]
COUNTED = [np.arange(N) < 4, np.arange(N) < 1]
SAMPLES = samples_of(RUNS, COUNTED)


def solution(**more: Any) -> Solution:
    residuals = [
        np.array([1.0, -1.0, 2.0, 2.0, 9.0, 9.0]),
        np.array([5.0, 9.0, 9.0, 9.0, 9.0, 9.0]),
    ]
    jacobian = [np.arange(12.0).reshape(N, 2), np.ones((N, 2))]
    values = np.array([1.0, 2.0, 3.0])
    whole = Solution((), values, residuals, jacobian, COLOURED, 0.0, True, "", SAMPLES)
    return replace(whole, **more)


def test_its_parameters_are_those_that_were_fitted() -> None:
    """One of three was held; of nothing that is known of the derivatives it is all of them."""
    assert solution().free == 2
    assert solution(jacobian=[np.ones((N, 2))]).free == 2
    assert solution(jacobian=[]).free == 3


def test_its_rms_is_of_what_counts() -> None:
    assert solution().rms_n == pytest.approx(np.sqrt((1 + 1 + 4 + 4 + 25) / 5.0))


def test_its_rows_are_those_of_its_samples_and_its_noise() -> None:
    there = solution()
    r, j = there.stacked()
    wanted = SAMPLES.stacked(there.residuals, there.jacobian, COLOURED)
    assert (r.tolist(), j.tolist()) == (wanted[0].tolist(), wanted[1].tolist())


def test_it_is_one_with_itself_alone_and_stays_what_it_is() -> None:
    """What a solution promises is kept under it."""
    there = solution()
    assert there != solution()
    assert {there: 1}[there] == 1
    with pytest.raises(FrozenInstanceError):
        there.converged = False  # type: ignore[misc]
