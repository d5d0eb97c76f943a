"""Bursts of large innovations of one sign: thresholds, times, sizes and shares in closed form."""

import re
from functools import cache

import numpy as np
import pytest
from jbf.diagnosis import Remainder
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.residual_structure.bursts import find_bursts
from scipy import special
from slides import STEP_S, Array, Mask, numbers_in, steady_slides

N = 2000
UNIT = 0.6745
"""Innovations of this constant magnitude have a robust standard deviation of one."""
SHARE_8 = 4 * 8.0**2 / (4 * 8.0**2 + (N - 4) * UNIT**2)
"""Share of the mean square of four innovations of eight standard deviations."""

campaign_of = cache(steady_slides)


def quiet() -> Array:
    """Innovations with the sign pattern + + - -, whose neighbours are uncorrelated on average."""
    return np.asarray(UNIT * np.where(np.arange(N) % 4 < 2, 1.0, -1.0))


def with_bursts(bursts: dict[int, float], length: int = 4) -> Array:
    """Innovations of constant magnitude with bursts of constant size (first sample to size)."""
    signal = quiet()
    for start, size in bursts.items():
        signal[start : start + length] = size
    return signal


def bursts_in(
    *innovations: Array,
    residuals: list[Array] | None = None,
    counted: Mask | None = None,
    **policy: float,
) -> list[Remainder]:
    campaign = campaign_of(*(len(e) for e in innovations))
    samples = campaign.samples if counted is None else campaign.samples.within([counted])
    given = DEFAULT.with_values(policy)
    return find_bursts(campaign.prepared, samples, innovations, residuals or innovations, given)


def times(remainder: Remainder) -> list[tuple[float, str]]:
    """Time (s) and run of each burst, in the order of the description."""
    return [(float(t), run) for t, run in re.findall(r"([\d.]+) s in (\w)", remainder.where)]


def largest_n(remainder: Remainder) -> float:
    return numbers_in(r"([\d.e+-]+) N: at", remainder.where)[0]


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_burst_is_reported_with_its_size_time_and_share_in_any_unit(unit: float) -> None:
    signal = unit * with_bursts({1000: 8.0})
    (found,) = bursts_in(signal)
    assert found.axis == "time"
    assert times(found) == [(20.0, "a")]
    assert largest_n(found) == pytest.approx(8.0 * unit)
    assert found.share == pytest.approx(SHARE_8)
    assert bursts_in(unit * quiet()) == []
    assert bool(bursts_in(signal, **{"bursts.min_share": 0.99 * SHARE_8}))
    assert bursts_in(signal, **{"bursts.min_share": 1.01 * SHARE_8}) == []


@pytest.mark.parametrize(("size", "large"), [(4.95, False), (5.0, False), (5.05, True)])
def test_burst_requires_innovations_beyond_five_robust_sigma(size: float, large: bool) -> None:
    for unit in (-100.0, -0.01, 0.01, 100.0):
        assert bool(bursts_in(unit * with_bursts({1000: size}))) == large


@pytest.mark.parametrize(("length", "found"), [(1, False), (2, False), (4, True), (8, True)])
def test_one_or_two_successive_outliers_are_not_a_burst(length: int, found: bool) -> None:
    assert bool(bursts_in(with_bursts({1000: 50.0}, length))) == found


def test_large_innovations_of_alternating_sign_are_not_a_burst() -> None:
    signal = with_bursts({1000: 9.0}, 6)
    signal[1001:1006:2] *= -1.0
    assert bursts_in(signal) == []


@pytest.mark.parametrize(("part", "found"), [(0.9, False), (1.1, True)])
def test_burst_requires_a_significant_correlation_of_neighbours(part: float, found: bool) -> None:
    """Four values clipped at three: three pairs with the product 9, and two pairs at the edges."""
    mean_square = (4 * 9.0 + (N - 4) * UNIT**2) / N
    product = 3 * 9.0 + 3.0 * (quiet()[999] + quiet()[1004])
    probability = float(special.ndtr(-product / np.sqrt(5 * 9.0 * mean_square)))
    assert (
        bool(bursts_in(with_bursts({1000: 8.0}), **{"bursts.chance": part * probability})) == found
    )


@pytest.mark.parametrize(("gap_s", "count"), [(0.44, 1), (0.56, 2)])
def test_large_innovations_within_half_a_second_are_one_burst(gap_s: float, count: int) -> None:
    second = 1003 + round(gap_s / STEP_S)
    (found,) = bursts_in(with_bursts({1000: 8.0, second: 9.0}))
    assert len(times(found)) == count
    assert largest_n(found) == 9.0
    assert times(found)[0][0] == pytest.approx(STEP_S * second, abs=0.051)


def test_four_largest_bursts_are_listed_in_order_of_size() -> None:
    first = with_bursts({100: 6.0, 500: 11.0, 900: 8.0})
    (found,) = bursts_in(first, with_bursts({200: 9.0, 600: 12.0, 1500: 7.0}))
    assert found.where.startswith("6 bursts")
    assert largest_n(found) == 12.0
    assert times(found) == [(12.0, "b"), (10.0, "a"), (4.0, "b"), (18.0, "a")]


def test_size_and_time_of_a_burst_are_those_of_its_largest_residual() -> None:
    residual = np.zeros(N)
    residual[1000:1004], residual[1500] = [-50.0, 30.0, 45.0, 0.0], 99.0
    (found,) = bursts_in(with_bursts({1000: 8.0}), residuals=[residual])
    assert largest_n(found) == 50.0
    residual[1003] = 60.0
    (found,) = bursts_in(with_bursts({1000: 8.0}), residuals=[residual])
    assert (largest_n(found), times(found)) == (60.0, [(20.1, "a")])


def test_no_burst_is_reported_at_samples_excluded_from_the_fit() -> None:
    signal = with_bursts({400: 8.0, 1000: 9.0})
    counted = np.ones(N, dtype=bool)
    counted[990:1010] = False
    (found,) = bursts_in(signal, counted=counted)
    assert (largest_n(found), times(found)) == (8.0, [(8.0, "a")])
    counted[390:410] = False
    assert bursts_in(signal, counted=counted) == []
    assert bursts_in(signal, counted=np.zeros(N, dtype=bool)) == []


def test_burst_requires_adjacent_samples_that_the_fit_uses() -> None:
    signal = with_bursts({1000: 8.0}, 20)
    counted = np.ones(N, dtype=bool)
    counted[1001:1020:2] = False
    assert bursts_in(signal, counted=counted) == []
    counted[1001:1008] = True
    assert len(bursts_in(signal, counted=counted)) == 1
