"""Errors that come again with the motion, beside what comes again by chance: sums by hand."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.replicates import MIN_PAIRS, _remembered, find_replicates
from jbf.estimation.noise import WHITE
from made_of import record, samples_of

Array = npt.NDArray[np.float64]
PERIOD = 60
PERIODS = 9
N = PERIOD * PERIODS
PAIRS = N - PERIOD


def turns(harmonic: int) -> Array:
    """A wave of unit mean square, so many times a period."""
    found: Array = np.sqrt(2.0) * np.cos(2.0 * np.pi * harmonic * np.arange(N) / PERIOD)
    return found


def comes_again(size: float) -> Array:
    """An error that is there in each period, and the other way round half a period later."""
    return size * turns(3)


def comes_not(size: float) -> Array:
    """One whose sign is the same in the next period as often as not."""
    signs = np.resize([1.0, 1.0, -1.0, -1.0], PERIODS)
    found: Array = size * turns(7) * np.repeat(signs, PERIOD)
    return found


def told(
    *residuals: Array,
    moves: list[bool] | None = None,
    counted: list[npt.NDArray[Any]] | None = None,
    **policy: Any,
) -> list[Remainder]:
    """Of runs that repeat their motion, but for those that are said not to."""
    prepared = []
    for i, r in enumerate(residuals):
        speed = 0.1 + 0.02 * turns(1)[: len(r)]
        if moves is not None and not moves[i]:
            speed = np.linspace(0.1, 0.2, len(r))
        prepared.append(record(0.02 * np.arange(len(r)), name="abc"[i], velocity=speed))
    solution: Any = SimpleNamespace(
        residuals=list(residuals), noise=WHITE, samples=samples_of(prepared, counted)
    )
    return find_replicates(prepared, solution, replace(DEFAULT, **policy))


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_the_share_is_what_the_next_period_knows(unit: float) -> None:
    """1.44 of 2.44 N^2 come again: seven tenths of the RMS."""
    (found,) = told(unit * (comes_again(1.2) + comes_not(1.0)))
    assert found.axis == "period"
    assert found.share == pytest.approx(1.44 / 2.44)
    assert found.where == (
        "error that comes again with each period, 77 % of the residual's RMS, in a"
    )
    assert told(unit * comes_not(1.0)) == []


def test_what_the_noise_remembers_half_a_period_later_is_none_of_it() -> None:
    """A level of 1.5 N is as much one period later as in between; of waves of 1 N on it, which are
    the other way round there, twice their square is left: of 3.25 N^2."""
    assert told(np.full(N, 1.5)) == []
    (found,) = told(1.5 + comes_again(1.0))
    assert found.share == pytest.approx(2.0 / 3.25)


def test_what_is_remembered_is_the_least_between_half_a_period_and_a_whole_one() -> None:
    """Mean products of samples that both count, at five shares of a period."""
    asked = set()
    for seed in range(40):
        random = np.random.default_rng(seed)
        r = 2.0 + random.standard_normal(100)
        counted = random.uniform(size=100) < 0.8
        lags = (20, 24, 28, 32, 36)
        means = [
            np.mean([r[i] * r[i + k] for i in range(100 - k) if counted[i] and counted[i + k]])
            for k in lags
        ]
        assert _remembered(r, counted, 40) == pytest.approx(min(means))
        asked.add(lags[int(np.argmin(means))])
    assert asked == set(lags)


def test_nothing_is_remembered_of_no_pairs_and_never_less_than_nothing() -> None:
    ones = np.ones(40)
    assert _remembered(ones, np.zeros(40, dtype=bool), 20) == 0.0
    assert _remembered(np.where(np.arange(40) % 2, 1.0, -1.0), ones > 0.0, 1) == 0.0
    # Of a period of one sample the next one is between.
    assert _remembered(ones, ones > 0.0, 1) == 1.0


@pytest.mark.parametrize(("part", "there"), [(0.99, True), (1.01, False)])
def test_it_stands_above_chance_by_the_root_of_the_pairs(part: float, there: bool) -> None:
    """A product of noises deviates by the mean square: all of it is sqrt(n) of that."""
    sigma = part * np.sqrt(PAIRS)
    for unit in (1e-3, 1e3):
        assert bool(told(comes_again(unit), replicate_sigma=sigma)) == there


def test_a_product_that_strays_for_long_is_less_sure() -> None:
    """Where the error is large for two thirds of the record and none in the last, few products
    are independent."""
    burst = comes_again(1.0) * np.repeat([1.0] * 6 + [0.0] * 3, PERIOD)
    (found,) = told(burst, replicate_sigma=1.0)
    assert told(burst, replicate_sigma=0.9 * found.share * np.sqrt(PAIRS)) == []


@pytest.mark.parametrize(("part", "there"), [(0.99, True), (1.01, False)])
def test_a_share_that_matters_is_told(part: float, there: bool) -> None:
    given: dict[str, Any] = {"replicate_share": part * 1.44 / 2.44}
    assert bool(told(comes_again(1.2) + comes_not(1.0), **given)) == there


def test_runs_add_up_and_those_in_which_it_comes_again_are_named() -> None:
    """Runs without a period or with few pairs are stepped over, wherever they stand."""
    loud, quiet = comes_again(1.2) + comes_not(1.0), comes_not(1.0)
    (found,) = told(quiet, loud, replicate_sigma=1.0)
    assert found.where.endswith(" in b")
    assert found.share == pytest.approx(1.44 / 3.44)
    (found,) = told(loud, 100.0 * loud, loud, moves=[True, False, True])
    assert found.where.endswith(" in a, c")
    (found,) = told(loud, loud, moves=[False, True])
    assert found.share == pytest.approx(1.44 / 2.44)
    few = np.arange(N) < PERIOD + 20
    (found,) = told(loud, loud, counted=[few, np.ones(N)])
    assert found.where.endswith(" in b")
    assert told(loud, moves=[False]) == []


@pytest.mark.parametrize(("pairs", "there"), [(MIN_PAIRS - 1, False), (MIN_PAIRS, True)])
def test_a_hundred_pairs_say_something(pairs: int, there: bool) -> None:
    assert MIN_PAIRS == 100
    mask = np.arange(N) < PERIOD + pairs
    assert bool(told(comes_again(1.0), counted=[mask])) == there


def test_samples_that_do_not_count_are_in_no_pair() -> None:
    bad = (np.arange(N) % (3 * PERIOD)) < 10
    wild = np.where(bad, 1e3, comes_again(1.0))
    (found,) = told(wild, counted=[~bad])
    assert found.share == pytest.approx(1.0, abs=0.1)
