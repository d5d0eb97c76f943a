"""The noise that a model leaves: of which samples, of which runs and with which limit."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf.estimation.between_runs import BetweenRuns
from jbf.estimation.noise import WHITE, estimate_noise
from jbf.estimation.noise_at import noise_at
from jbf.estimation.samples import Samples
from scipy import signal

Array = npt.NDArray[np.float64]
N, STEP_S = 3000, 0.02
VALUES = np.zeros(1)


def coloured(seed: int, memory_s: float) -> Array:
    """A first-order process of so long a memory, in white noise as large as half of it."""
    random = np.random.default_rng(seed)
    phi = np.exp(-STEP_S / memory_s)
    kicks = random.normal(0.0, np.sqrt(1.0 - phi**2), N)
    slow: Array = signal.lfilter([1.0], [1.0, -phi], kicks)
    return slow + random.normal(0.0, 0.5, N)


def samples(counted: list[npt.NDArray[np.bool_]]) -> Samples:
    names = tuple(f"{i}" for i in range(len(counted)))
    weight = tuple(c.astype(float) for c in counted)
    return Samples(names, (STEP_S,) * len(counted), tuple(counted), weight)


def problem(residuals: list[Array], searched: list[int], most_n: float | None = None) -> Any:
    """A model that leaves these, of runs of which some are searched."""

    def left(values: Array, which: list[int]) -> list[Array]:
        assert values is VALUES
        return [residuals[i] for i in which]

    campaign = SimpleNamespace(most_noise_n=most_n)
    return SimpleNamespace(searched=searched, residuals=left, campaign=campaign)


def test_what_does_not_count_says_nothing_of_the_noise() -> None:
    """Not even where it is a thousand times as large as what counts."""
    counted = [np.arange(N) % 100 > 9] * 2
    residuals = [coloured(i, 0.2) for i in range(2)]
    wild = [np.where(c, r, 1e3) for r, c in zip(residuals, counted, strict=True)]
    found = noise_at(problem(wild, [0, 1]), samples(counted), VALUES)
    masked = [np.where(c, r, 0.0) for r, c in zip(residuals, counted, strict=True)]
    assert found == estimate_noise(masked, [STEP_S] * 2, counted)
    assert not found.white


def test_of_many_runs_those_that_are_searched_tell_it() -> None:
    every = [np.ones(N, dtype=bool)] * 3
    residuals = [coloured(1, 0.1), np.random.default_rng(2).standard_normal(N), coloured(3, 0.4)]
    given = samples(every)
    for which in ([0], [2], [0, 2], [0, 1, 2]):
        own = [residuals[i] for i in which]
        wanted = estimate_noise(own, [STEP_S] * len(own), every[: len(own)])
        assert noise_at(problem(residuals, which), given, VALUES) == wanted
    assert noise_at(problem(residuals, [1]), given, VALUES) == WHITE


def test_residuals_that_are_known_are_not_asked_for() -> None:
    residuals = [coloured(1, 0.2)]
    given = problem([], [0])
    every = samples([np.ones(N, dtype=bool)])
    found = noise_at(given, every, VALUES, (residuals, [np.zeros((N, 0))]))
    assert found == noise_at(problem(residuals, [0]), every, VALUES)


def test_colour_is_held_to_what_the_records_say() -> None:
    """Of 1.25 N^2 the noise has 0.36 at most, colour and all."""
    residuals, every = [coloured(1, 0.4)], samples([np.ones(N, dtype=bool)])
    free, held = (noise_at(problem(residuals, [0], most), every, VALUES) for most in (None, 0.6))
    share = 0.36 / float(np.mean(residuals[0] ** 2))
    assert held.coloured_share(STEP_S) == pytest.approx(share, rel=1e-6)
    assert free.coloured_share(STEP_S) > 2.0 * share


def test_what_runs_deviate_by_is_no_colour() -> None:
    """A zero of the run's own, 3 N beside a noise of 1 N, remembers for ever."""
    noise = np.random.default_rng(4).standard_normal(N)
    every = samples([np.ones(N, dtype=bool)])
    between = BetweenRuns(("zero",), (np.full((N, 1), 3.0),), 1.0)
    known = Samples(every.runs, every.steps_s, every.counted, every.weight, between)
    assert noise_at(problem([noise + 3.0], [0]), known, VALUES) == WHITE
    assert not noise_at(problem([noise + 3.0], [0]), every, VALUES).white
