"""Patterns of a residual, by hand: means of bins, what they explain, and the words for it."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from jbf.comparison.bins import Bin, Binned
from jbf.comparison.patterns import Failure, bin_means, pattern_along, pattern_words
from jbf.estimation.samples import Samples

Array = npt.NDArray[np.float64]
WAYS = (Bin(direction=-1), Bin(direction=1))
RUNS = tuple(Bin(name) for name in "abcde")


def samples_of(*counted: Array) -> Samples:
    """Runs of which these samples count."""
    masks = tuple(c.astype(bool) for c in counted)
    names = tuple(f"{i}" for i in range(len(masks)))
    return Samples(names, (0.01,) * len(masks), masks, tuple(m.astype(float) for m in masks))


def binned(bins: tuple[Bin, ...], *places: list[int], unit: str = "N") -> Binned:
    return Binned("run", bins, [np.array(p, dtype=np.intp) for p in places], unit)


def words(
    bins: tuple[Bin, ...],
    means: list[float],
    counts: list[int] | None = None,
    found: list[float] | None = None,
) -> str:
    """Of bins of as many samples each, where nothing else is said."""
    axis = Binned("run" if bins is RUNS or bins[0].name else "direction", bins, [], "N m")
    many = np.array([100] * len(bins) if counts is None else counts, dtype=np.intp)
    return pattern_words(axis, np.array(means), many, None if found is None else np.array(found))


def test_means_are_of_the_samples_that_count_and_have_a_bin() -> None:
    """Of a bin without samples the mean is zero, of no samples."""
    axis = binned(RUNS[:3], [0, 0, 2, -1, 0], [2, 2, -1, 0])
    residuals = [np.array([1.0, 3.0, -4.0, 50.0, 100.0]), np.array([-5.0, 9.0, 50.0, 5.0])]
    samples = samples_of(np.array([1, 1, 1, 1, 0]), np.array([1, 0, 1, 1]))
    means, counts = bin_means(axis, samples, residuals)
    assert counts.tolist() == [3, 0, 2]
    assert means.tolist() == [3.0, 0.0, -4.5]
    # One sample is its own mean.
    lone, _ = bin_means(binned(RUNS[:1], [0]), samples_of(np.ones(1)), [np.array([7.0])])
    assert lone.tolist() == [7.0]


def test_the_share_is_what_the_means_explain_beyond_one_variance_a_bin() -> None:
    """Of 95 N^2 three bins of ten samples explain 50, chance a variance for each bin in use."""
    places = [0] * 10 + [1] * 10 + [2] * 10 + [-1] * 5
    residuals = np.repeat([2.0, -1.0, 0.0, 3.0], [10, 10, 10, 5])
    axis, samples = binned(RUNS[:4], places), samples_of(np.ones(35))
    found = pattern_along(axis, samples, [residuals], 0.5)
    assert found is not None
    assert found.share == pytest.approx((50.0 - 3 * 0.25) / 95.0, rel=1e-12)
    assert found.means_n.tolist() == [2.0, -1.0, 0.0, 0.0]
    # Just that much is told, and what is just above chance.
    assert pattern_along(axis, samples, [residuals], 0.5, found.share) is not None
    assert pattern_along(axis, samples, [residuals], 0.5, np.nextafter(found.share, 1.0)) is None
    flat = np.full(32, 0.5)
    alone = binned(RUNS[:2], [0] * 16 + [1] * 16)
    # Of two bins chance is 2, and each of six spreads 2: 8 of a square of 1/4.
    even = pattern_along(alone, samples_of(np.ones(32)), [flat], 0.5, 0.0, 15.0)
    assert even is not None
    assert pattern_along(alone, samples_of(np.ones(32)), [flat], 0.5, 0.0, 15.01) is None
    assert found.counts.tolist() == [10, 10, 10, 0]
    assert (found.axis, found.bins) == ("run", RUNS[:4])
    assert found.labels == ("run a", "run b", "run c", "run d")
    assert found.where == "most +2 N at run a; -1 N at run b"
    assert found.to_dict() == {"axis": "run", "where": found.where, "share": 0.5184}


@pytest.mark.parametrize(("share", "told"), [(0.0097, False), (0.0103, True)])
def test_less_than_a_hundredth_of_the_mean_square_is_not_told(share: float, told: bool) -> None:
    """Unit swings about a mean m: of their square 1 + m^2 the mean explains m^2."""
    size = np.sqrt(share / (1.0 - share))
    swings = size + np.tile([1.0, -1.0], 100)
    axis, samples = binned(RUNS[:1], [0] * 200), samples_of(np.ones(200))
    assert (pattern_along(axis, samples, [swings], 1e-6) is not None) == told


@pytest.mark.parametrize(("more", "told"), [(-0.01, False), (0.01, True)])
def test_three_bins_must_stand_above_chance_by_their_own_spread(more: float, told: bool) -> None:
    """A chi-square of three degrees has the deviation sqrt(6); here nine are asked for."""
    noise = 0.7
    least = (3.0 + 9.0 * np.sqrt(6.0) + more) * noise**2
    residuals = np.full(30, np.sqrt(least / 30.0))
    axis = binned(RUNS[:4], [0] * 10 + [1] * 10 + [3] * 10)
    found = pattern_along(axis, samples_of(np.ones(30)), [residuals], noise, 0.0, 9.0)
    assert (found is not None) == told


def test_the_test_is_of_one_residual_and_the_words_of_another() -> None:
    """`told_of` gives the sizes, in the bins that the tested residual finds."""
    axis, samples = binned(RUNS[:2], [0] * 50 + [1] * 50), samples_of(np.ones(100))
    tested = np.repeat([1.0, 0.0], 50)
    told = np.repeat([7.0, -9.0], 50)
    found = pattern_along(axis, samples, [tested], 0.01, told_of=[told])
    assert found is not None
    assert found.share == pytest.approx((50.0 - 2e-4) / 50.0)
    assert found.means_n.tolist() == [7.0, -9.0]
    assert found.where == "one sign throughout: record minus model +7 N; most +7 N at run a"
    assert pattern_along(axis, samples, [0.0 * tested], 0.01, told_of=[told]) is None


@pytest.mark.parametrize(("other", "named"), [(-0.142, False), (-0.144, True)])
def test_bins_with_a_fiftieth_of_what_is_explained_have_a_part(other: float, named: bool) -> None:
    """x^2 / (1 + x^2) is two hundredths at x = 1/7."""
    said = words(RUNS[:2], [1.0, other])
    if named:
        assert said == "most +1 N m at run a; -0.14 N m at run b"
    else:
        assert said == "one sign throughout: record minus model +1 N m; most +1 N m at run a"


def test_a_bin_with_just_a_fiftieth_has_no_part() -> None:
    """Of 49 and 1."""
    said = words(RUNS[:2], [7.0, -1.0])
    assert said == "one sign throughout: record minus model +7 N m; most +7 N m at run a"


def test_sizes_are_means_over_samples() -> None:
    """Of 300 samples at 1 N m and 100 at 3 N m, 1.5 N m."""
    counts = [300, 100]
    whole = "all of direction, sign of v: record"
    assert words(WAYS, [-1.0, 3.0], counts).startswith(f"{whole} above the model by 1.5 N m in")
    assert words(WAYS, [1.0, -3.0], counts).startswith(f"{whole} below the model by 1.5 N m in")
    assert words(WAYS, [1.0, 3.0], counts).startswith(
        "all of direction, one sign throughout: record minus model +1.5 N m"
    )
    assert words(WAYS, [-1.0, -3.0], counts).startswith(
        "all of direction, one sign throughout: record minus model -1.5 N m"
    )


def test_one_bin_alone_has_no_sign_of_motion() -> None:
    assert words(WAYS, [0.001, 3.0]) == (
        "one sign throughout: record minus model +3 N m; most +3 N m at v > 0"
    )


def test_where_a_bin_holds_both_ways_there_is_no_sign_of_motion() -> None:
    said = words((*WAYS, Bin("at rest")), [-1.0, 1.0, 1.0])
    assert said == "most -1 N m at v < 0; +1 N m at v > 0"


def test_the_two_named_explain_most_not_the_largest_means() -> None:
    """Ten samples at 2 N m explain 40, a hundred at 1 N m and at -0.9 N m 100 and 81."""
    said = words(RUNS[:3], [2.0, 1.0, -0.9], [10, 100, 100])
    assert said == "most +1 N m at run b; -0.9 N m at run c"


@pytest.mark.parametrize(("counts", "throughout"), [([100] * 5, False), ([100] * 4 + [0], True)])
def test_more_than_four_fifths_of_the_bins_in_use_are_all(
    counts: list[int], throughout: bool
) -> None:
    said = words(RUNS, [1.0, 1.0, 1.0, 1.0, 0.01], counts)
    assert said.startswith("all of run, one sign") == throughout


def test_bins_are_named_by_where_the_pattern_was_found() -> None:
    """The largest mean does not count where nothing was found."""
    said = words(RUNS[:3], [1.0, -8.0, 2.0], found=[3.0, 0.1, 3.0])
    assert said == (
        "one sign throughout: record minus model +1.5 N m; most +2 N m at run c; +1 N m at run a"
    )


def test_a_failure_rounds_its_share_to_four_places() -> None:
    failure = Failure("run", "here", 0.123456, RUNS, np.zeros(5), np.zeros(5, dtype=np.intp))
    assert failure.to_dict() == {"axis": "run", "where": "here", "share": 0.1235}
