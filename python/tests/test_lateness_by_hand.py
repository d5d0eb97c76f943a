"""Where squares are least over a grid of lateness, and what runs have in common: worked by hand."""

from __future__ import annotations

import numpy as np
import pytest
from by_hand import Array
from jbf.estimation.lateness import (
    LEAST_SAMPLES,
    _common,
    _drift,
    _Place,
    _place,
    _spread,
    _valley,
)
from scipy import stats

GRID = np.linspace(-0.04, 0.04, 41)
"""Steps of 2 ms."""
STEP_S = 0.002
NOWHERE = _Place(0.0, np.inf)


def bowl(at: float, bend: float, floor: float = 0.0) -> Array:
    """Squares that are least at a lateness: `bend` is their second derivative."""
    found: Array = floor + 0.5 * bend * (GRID - at) ** 2
    return found


# ---- one run -----------------------------------------------------------------------------------


@pytest.mark.parametrize("at", [0.0, 0.0013, -0.0247, 0.0379])
@pytest.mark.parametrize("bend", [2e4, 5e8])
def test_a_parabola_is_least_at_its_vertex_and_its_variance_is_two_over_its_bend(
    at: float, bend: float
) -> None:
    """Twice the log likelihood falls by one where it is a standard deviation off: 2 / bend."""
    found = _place(GRID, bowl(at, bend), 1000)
    assert found.value == pytest.approx(at, abs=1e-9)
    assert found.variance == pytest.approx(2.0 / bend, rel=1e-6)


def test_squares_above_one_a_sample_make_it_as_much_less_sure() -> None:
    for floor, more in ((50.0, 1.0), (100.0, 1.0), (300.0, 3.0)):
        found = _place(GRID, bowl(0.002, 1e6, floor), 100)
        assert found.value == pytest.approx(0.002, abs=1e-9)
        assert found.variance == pytest.approx(more * 2e-6)


@pytest.mark.parametrize("tell", [_place, _valley])
def test_few_samples_or_an_end_of_the_range_tell_nothing(tell: object) -> None:
    assert callable(tell)
    costs = bowl(0.01, 1e6)
    assert LEAST_SAMPLES == 60
    assert np.isfinite(tell(GRID, costs, 60).variance)
    assert tell(GRID, costs, 59) == NOWHERE
    for out in (-0.05, -0.0395, 0.0395, 0.05):
        assert tell(GRID, bowl(out, 1e6), 1000) == NOWHERE
    # Next to the ends it is told.
    for inside in (-0.0376, 0.0376):
        assert np.isfinite(_place(GRID, bowl(inside, 1e6), 1000).variance)


def test_squares_that_are_flat_tell_nothing() -> None:
    assert _place(GRID, np.ones(len(GRID)), 1000) == NOWHERE


def test_a_valley_is_the_mean_of_its_likelihood() -> None:
    """Of a parabola that is a normal density's: its mean, its variance and what the steps leave."""
    at, sd = 0.0031, 0.006
    found = _valley(GRID, bowl(at, 2.0 / sd**2), 1000)
    assert found.value == pytest.approx(at, abs=1e-6)
    assert found.variance == pytest.approx(sd**2 + STEP_S**2 / 12.0, rel=1e-3)
    # Four in each sample: half as sure.
    wide = _valley(GRID, bowl(at, 4.0 / sd**2) + 400.0, 100)
    assert wide.variance == pytest.approx(2.0 * sd**2 + STEP_S**2 / 12.0, rel=0.02)


def test_two_valleys_are_told_by_their_weights() -> None:
    """Of two places that are as likely the mean lies between."""
    costs = np.full(len(GRID), 1e3)
    costs[[10, 20]] = 0.0
    found = _valley(GRID, costs, 1000)
    assert found.value == pytest.approx(0.5 * (GRID[10] + GRID[20]))
    assert found.variance == pytest.approx(0.01**2 + STEP_S**2 / 12.0)
    # e to one as likely: 1 / (1 + e) of the way from the one to the other.
    costs[20] = 2.0
    assert _valley(GRID, costs, 1000).value == pytest.approx(GRID[10] + 0.02 / (1.0 + np.e))


@pytest.mark.parametrize(("end", "told"), [(0.0095, True), (0.0105, False)])
def test_a_hundredth_at_the_ends_of_the_range_may_lie_outside(end: float, told: bool) -> None:
    costs = np.full(len(GRID), 1e3)
    costs[20] = 0.0
    for ends in ([0], [-1], [0, -1]):
        here = costs.copy()
        # Together they have this share of all.
        here[ends] = -2.0 * np.log(end / (1.0 - end) / len(ends))
        assert (_valley(GRID, here, 1000) != NOWHERE) == told


# ---- how it grows ------------------------------------------------------------------------------


def growing(lates: list[float], samples: int = 300, lasts_s: float = 30.0) -> tuple[Array, Array]:
    """Squares of each sample over the grid, where each third of a run is late by so much."""
    time = np.linspace(0.0, lasts_s, samples, endpoint=False)
    third = np.minimum((3 * time / lasts_s).astype(int), len(lates) - 1)
    at = np.array(lates)[third]
    return 0.5 * 1e4 * (GRID[:, None] - at[None, :]) ** 2, time


def test_a_lateness_grows_along_the_line_through_the_thirds_of_a_run() -> None:
    squares, time = growing([-0.01, 0.0, 0.01])
    found = _drift(GRID, squares, time, _place)
    # Middles are a third of the time apart; a third has 100 samples of variance 2 / 1e4 each.
    apart = time[-1] / 3.0
    assert found.value == pytest.approx(0.01 / apart, rel=0.02)
    assert found.variance == pytest.approx(2e-6 / (2.0 * apart**2), rel=0.02)
    again, time = growing([0.004, 0.004, 0.004])
    assert _drift(GRID, again, time, _place).value == pytest.approx(0.0, abs=1e-9)


def test_a_third_that_tells_nothing_is_left_out() -> None:
    """Two of them still have a slope, one has none."""
    squares, time = growing([-0.01, 0.2, 0.01])
    apart = 2.0 * time[-1] / 3.0
    found = _drift(GRID, squares, time, _place)
    assert found.value == pytest.approx(0.02 / apart, rel=0.02)
    assert found.variance == pytest.approx(2e-6 / (0.5 * apart**2), rel=0.02)
    squares, time = growing([0.2, -0.2, 0.01])
    assert _drift(GRID, squares, time, _place) == NOWHERE
    assert _drift(GRID, np.zeros((len(GRID), 0)), np.zeros(0), _place) == NOWHERE
    # Sixty samples a third are enough.
    for samples, told in ((183, True), (160, False)):
        squares, time = growing([-0.01, 0.0, 0.01], samples)
        assert (_drift(GRID, squares, time, _place) != NOWHERE) == told


def test_thirds_that_tell_it_better_count_for_more() -> None:
    """Values 0, 0 and 6 ms, the last of a weight of four: the slope of weighted least squares."""
    squares, time = growing([0.0, 0.0, 0.006])
    last = time >= time[-1] * 2.0 / 3.0
    squares[:, last] *= 4.0
    middles = time[-1] * np.array([1.0, 3.0, 5.0]) / 6.0
    wanted = np.polyfit(middles, [0.0, 0.0, 0.006], 1, w=[1.0, 1.0, 2.0])[0]
    assert _drift(GRID, squares, time, _place).value == pytest.approx(wanted, rel=0.03)


# ---- of all runs -------------------------------------------------------------------------------


def test_what_runs_share_is_their_weighted_mean() -> None:
    """1 and 4 with precisions of 3 and 1: 7/4; a chi-square of half its square over its variance.
    They differ by 9 * 3/4 in their chi-square of one: as much less sure is the mean."""
    places = [_Place(1.0, 1.0 / 3.0), _Place(4.0, 1.0), NOWHERE]
    found = _common(places)
    assert found is not None
    assert found[0] == pytest.approx(1.75)
    square = 1.75**2 * 4.0 / 6.75
    assert found[1] == pytest.approx(stats.chi2.sf(0.5 * square, 1))


def test_runs_that_agree_better_than_chance_are_no_surer_for_that() -> None:
    found = _common([_Place(2.0, 1.0)] * 4)
    assert found is not None
    assert found == pytest.approx((2.0, stats.chi2.sf(0.5 * 16.0, 1)))
    one = _common([_Place(-3.0, 1.0)])
    assert one == pytest.approx((-3.0, stats.chi2.sf(4.5, 1)))
    assert _common([NOWHERE, NOWHERE]) is None
    assert _common([]) is None


def test_of_three_runs_their_spread_is_known() -> None:
    """Values 5, 7 and 9 of unit variance: Q = 8 of two degrees, and 3 beyond chance."""
    places = [_Place(v, 1.0) for v in (5.0, 7.0, 9.0)]
    assert _spread([*places, NOWHERE]) == pytest.approx((np.sqrt(3.0), np.exp(-2.0)))
    assert _spread(places[:2]) is None
    assert _spread([places[0]] * 4) is None
