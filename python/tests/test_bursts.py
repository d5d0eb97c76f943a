"""Bursts among innovations of known size: which are told, with their times and sizes, by hand."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf.diagnosis.bursts import find_bursts
from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.policy import DEFAULT
from made_of import record, samples_of
from scipy import special

Array = npt.NDArray[np.float64]
STEP_S = 0.02
N = 2000
ONE = 0.6745
"""Innovations that are all so large have a robust standard deviation of one."""


def quiet(n: int = N) -> Array:
    """Innovations of unit size, whose neighbours cancel: + + - -."""
    found: Array = ONE * np.where(np.arange(n) % 4 < 2, 1.0, -1.0)
    return found


def with_bursts(at: dict[int, float], length: int = 4, n: int = N) -> Array:
    """The same with bursts of one sign (first sample to size)."""
    e = quiet(n)
    for k, size in at.items():
        e[k : k + length] = size
    return e


def runs(*e: Array) -> list[Any]:
    return [record(STEP_S * np.arange(len(x)), name="abc"[i]) for i, x in enumerate(e)]


def told(
    *e: Array, unit: float = 1.0, residuals: list[Array] | None = None, **policy: Any
) -> list[Remainder]:
    prepared = runs(*e)
    scaled = [unit * x for x in e]
    given = replace(DEFAULT, **policy)
    return find_bursts(prepared, samples_of(prepared), scaled, residuals or scaled, given)


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_a_burst_is_told_with_its_size_its_time_and_its_share(unit: float) -> None:
    (one,) = told(with_bursts({1000: 8.0}), unit=unit)
    assert one.axis == "time"
    assert one.where == f"1 burst, of {8.0 * unit:.2g} N: at 20.0 s in a"
    assert told(with_bursts({1000: 8.0}), unit=unit, burst_share=one.share) == [one]
    assert one.share == pytest.approx(256.0 / (256.0 + (N - 4) * ONE**2))
    assert told(quiet(), unit=unit) == []


@pytest.mark.parametrize(
    ("size", "there"), [(4.95, False), (-4.95, False), (5.05, True), (-5.05, True)]
)
def test_innovations_beyond_five_deviations_are_large(size: float, there: bool) -> None:
    # Of just five deviations they are not.
    assert told(with_bursts({1000: 5.0})) == told(with_bursts({1000: -5.0})) == []
    for unit in (0.01, 100.0):
        assert bool(told(with_bursts({1000: size}), unit=unit)) == there


@pytest.mark.parametrize(("length", "there"), [(1, False), (2, False), (4, True), (8, True)])
def test_what_does_not_last_is_a_glitch(length: int, there: bool) -> None:
    """Neighbours of one sign at three deviations: 9 a pair, in chance's 3 sqrt(pairs usual)."""
    assert bool(told(with_bursts({1000: 50.0}, length))) == there


def test_neighbours_of_either_sign_are_glitches() -> None:
    e = with_bursts({1000: 9.0}, 6)
    e[1000:1006] *= [1.0, -1.0, 1.0, -1.0, 1.0, -1.0]
    assert told(e) == []


@pytest.mark.parametrize(("share", "there"), [(0.9, True), (1.1, False)])
def test_bursts_have_a_share_that_matters(share: float, there: bool) -> None:
    whole = 256.0 / (256.0 + (N - 4) * ONE**2)
    for unit in (1e-3, 1e3):
        given = told(with_bursts({1000: 8.0}), unit=unit, burst_share=share * whole)
        assert bool(given) == there


def test_large_innovations_within_half_a_second_are_one_burst() -> None:
    for gap_s, count in ((0.44, 1), (0.56, 2)):
        second = 1000 + 3 + round(gap_s / STEP_S)
        (found,) = told(with_bursts({1000: 8.0, second: 9.0}))
        noun = "1 burst, of 9 N: at " if count == 1 else "2 bursts, the largest 9 N: at "
        assert found.where.startswith(noun + f"{STEP_S * second:.1f} s in a")
        assert found.where.count(" s in a") == count


def test_the_four_largest_are_named_largest_first() -> None:
    one = with_bursts({100: 6.0, 500: 11.0, 900: 8.0})
    other = with_bursts({200: 9.0, 600: 12.0, 1500: 7.0})
    (found,) = told(one, other)
    assert found.where == (
        "6 bursts, the largest 12 N: at 12.0 s in b, 10.0 s in a, 4.0 s in b, 18.0 s in a"
    )


def test_a_burst_stands_where_its_residual_is_largest() -> None:
    e = with_bursts({1000: 8.0})
    residual = np.zeros(N)
    residual[1002], residual[1001], residual[1500] = -40.0, 30.0, 99.0
    (found,) = told(e, residuals=[residual])
    assert found.where == "1 burst, of 40 N: at 20.0 s in a"
    residual[1000:1004] = [-50.0, 30.0, 45.0, 0.0]
    (found,) = told(e, residuals=[residual])
    assert found.where == "1 burst, of 50 N: at 20.0 s in a"


def test_what_does_not_count_is_no_burst() -> None:
    e = with_bursts({400: 8.0, 1000: 9.0})
    prepared = runs(e)
    here = np.ones(N)
    here[990:1010] = 0.0
    (found,) = find_bursts(prepared, samples_of(prepared, [here]), [e], [e], DEFAULT)
    assert found.where == "1 burst, of 8 N: at 8.0 s in a"
    here[390:410] = 0.0
    assert find_bursts(prepared, samples_of(prepared, [here]), [e], [e], DEFAULT) == []
    nothing = samples_of(prepared, [np.zeros(N)])
    assert find_bursts(prepared, nothing, [e], [e], DEFAULT) == []


def test_without_any_noise_a_burst_is_all_there_is() -> None:
    e = np.zeros(N)
    assert told(e) == []
    e[1000:1004] = 2.0
    (found,) = told(e)
    assert found.where == "1 burst, of 2 N: at 20.0 s in a"
    assert found.share == 1.0


def test_what_is_so_small_that_its_squares_are_nothing_is_no_burst() -> None:
    assert told(with_bursts({1000: 8.0}), unit=1e-170) == []


def test_beside_a_burst_innovations_of_just_five_deviations_are_none() -> None:
    (found,) = told(with_bursts({400: 8.0, 1000: 5.0}))
    assert found.where == "1 burst, of 8 N: at 8.0 s in a"


@pytest.mark.parametrize(("part", "there"), [(0.9, False), (1.1, True)])
def test_neighbours_of_one_sign_are_no_chance(part: float, there: bool) -> None:
    """Four samples of eight deviations, cut to three: three pairs of 9 and two at the edges, whose
    other halves cancel; each deviates by three times what is usual."""
    usual = (4 * 9.0 + (N - 4) * ONE**2) / N
    first, last = quiet()[999], quiet()[1004]
    product = 3 * 9.0 + 3.0 * (first + last)
    chance = special.ndtr(-product / np.sqrt(5 * 9.0 * usual))
    assert bool(told(with_bursts({1000: 8.0}), burst_chance=part * chance)) == there


def test_only_pairs_that_both_count_last() -> None:
    """Of twenty large ones every other does not count: none has a neighbour."""
    e = with_bursts({1000: 8.0}, 20)
    prepared = runs(e)
    here = np.ones(N)
    here[1001:1020:2] = 0.0
    assert find_bursts(prepared, samples_of(prepared, [here]), [e], [e], DEFAULT) == []
    here[1001:1008] = 1.0
    assert len(find_bursts(prepared, samples_of(prepared, [here]), [e], [e], DEFAULT)) == 1
