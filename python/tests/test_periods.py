"""What comes again with the motion and what does not, in residuals put together by hand."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.replicates import find_replicates
from jbf.estimation.noise import WHITE
from made_of import record, samples_of

Array = npt.NDArray[np.float64]
PERIOD = 100
STEP_S = 0.05


def turning(n: int, period: int = PERIOD) -> Array:
    """The speed of a motion with this period, in samples."""
    turn = 2.0 * np.pi * np.arange(n) / period
    found: Array = np.sin(turn) + 0.3 * np.sin(2.0 * turn + 0.5)
    return found


def error(n: int, period: int = PERIOD) -> Array:
    """What comes again, of unit RMS: it swings seven times a period."""
    found: Array = np.sqrt(2.0) * np.sin(14.0 * np.pi * np.arange(n) / period + 0.3)
    return found


def told(
    *residuals: Array,
    speeds: list[Array] | None = None,
    counted: list[npt.NDArray[Any]] | None = None,
    **policy: Any,
) -> list[Remainder]:
    prepared: list[Any] = [
        record(
            STEP_S * np.arange(len(r)),
            name="abc"[i],
            velocity=turning(len(r)) if speeds is None else speeds[i],
        )
        for i, r in enumerate(residuals)
    ]
    samples = samples_of(prepared, counted)
    solution: Any = SimpleNamespace(residuals=list(residuals), noise=WHITE, samples=samples)
    return find_replicates(prepared, solution, replace(DEFAULT, **policy))


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_an_error_is_told_with_its_share(unit: float) -> None:
    """Half as large as the noise in its RMS: a fifth of the whole square."""
    noise = np.random.default_rng(1).standard_normal((2, 6000))
    (found,) = told(*(unit * (0.5 * error(6000) + e) for e in noise))
    assert found.axis == "period"
    assert found.share == pytest.approx(0.2, abs=0.02)
    size = float(np.sqrt(found.share))
    assert found.where == (
        f"error that comes again with each period, {100 * size:.0f} % of the residual's RMS, "
        "in a, b"
    )
    assert told(*(unit * e for e in noise)) == []


@pytest.mark.parametrize(("share", "there"), [(0.95, True), (1.0, True), (1.05, False)])
def test_an_error_has_a_share_that_matters(share: float, there: bool) -> None:
    residual = 0.5 * error(6000) + np.random.default_rng(1).standard_normal(6000)
    (found,) = told(residual)
    assert bool(told(residual, replicate_share=share * found.share)) == there


@pytest.mark.parametrize(("sigma", "there"), [(0.85, True), (1.15, False)])
def test_an_error_stands_above_the_spread_of_its_products(sigma: float, there: bool) -> None:
    """A product of two noises of mean square L has the variance L^2: of 5900 pairs the sum strays
    by sqrt(5900) L, and the error's is its share of all of them."""
    residual = 0.5 * error(6000) + np.random.default_rng(2).standard_normal(6000)
    (found,) = told(residual)
    beyond = found.share * np.sqrt(5900.0)
    assert bool(told(residual, replicate_sigma=sigma * beyond)) == there


def test_an_error_alone_is_all_of_the_residual() -> None:
    (found,) = told(3.0 * error(3000))
    assert found.share == pytest.approx(1.0)
    assert " 100 % of the residual's RMS, in a" in found.where


def test_only_runs_in_which_it_is_are_named() -> None:
    noise = np.random.default_rng(3).standard_normal((3, 4000))
    (found,) = told(noise[0] + error(4000), noise[1], noise[2] + error(4000))
    assert found.where.endswith(", in a, c")
    # Of the square 5 the errors have 2.
    assert found.share == pytest.approx(0.4, abs=0.04)


def test_a_run_without_a_period_says_nothing_and_the_next_one_does() -> None:
    residual = error(3000) + np.random.default_rng(4).standard_normal(3000)
    once = np.linspace(-1.0, 1.0, 3000)
    assert told(residual, speeds=[once]) == []
    (found,) = told(residual, residual, speeds=[once, turning(3000)])
    assert found.where.endswith(", in b")


@pytest.mark.parametrize(("pairs", "there"), [(99, False), (100, True)])
def test_a_hundred_pairs_are_needed(pairs: int, there: bool) -> None:
    """Of a run that has fewer nothing is asked; the next one has its say."""
    n = PERIOD + pairs
    short, long = 5.0 * error(n), error(3000)
    assert bool(told(short)) == there
    (found,) = told(short, long)
    assert found.where.endswith(", in a, b" if there else ", in b")


def test_pairs_are_of_samples_that_both_count() -> None:
    n = 4000
    bad = np.arange(n) % (2 * PERIOD) < 30
    noise = np.random.default_rng(5).standard_normal(n)
    wild = np.where(bad, 100.0, noise)
    assert told(wild, counted=[~bad]) == []
    (found,) = told(np.where(bad, 100.0, noise + error(n)), counted=[~bad])
    assert found.share == pytest.approx(0.5, abs=0.05)


def test_what_never_forgets_does_not_come_again() -> None:
    """A level is as like itself half a period ago as a whole one."""
    n = 3000
    noise = np.random.default_rng(6).standard_normal(n)
    assert told(np.full(n, 2.0) + noise) == []


@pytest.mark.parametrize("share", [0.5, 0.6, 0.7, 0.8, 0.9])
def test_memory_is_the_least_product_between_half_a_period_and_a_whole_one(share: float) -> None:
    """A wave about a level that is least like itself after this share of a period: there its mean
    product is 1 - 1/2, a period apart 1 + cos(pi / share) / 2, of a square of 3/2."""
    n = 20_000
    residual = 1.0 + np.cos(np.pi * np.arange(n) / (share * PERIOD))
    (found,) = told(residual, replicate_share=1e-3, replicate_sigma=1e-6)
    assert found.share == pytest.approx(0.5 * (1.0 + np.cos(np.pi / share)) / 1.5, abs=5e-3)
