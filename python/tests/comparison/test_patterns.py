"""Patterns of a residual: bin means, the share that they explain, and the description."""

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf import Rig, Run
from jbf.comparison.bins import Bin, Binned
from jbf.comparison.patterns import bin_means, find_failures, pattern_along, pattern_words
from jbf.estimation.campaign import Campaign
from jbf.estimation.samples import Samples

Array = npt.NDArray[np.float64]
Bins = tuple[Bin, ...]
DIRECTIONS = (Bin(direction=-1), Bin(direction=1))
RUNS = tuple(Bin(name) for name in "abcde")


def samples_of(*counted: Array) -> Samples:
    """Samples with the given masks of counted samples, one array for each run."""
    masks = tuple(c.astype(bool) for c in counted)
    names = tuple(f"{i}" for i in range(len(masks)))
    return Samples(names, (0.01,) * len(masks), masks, tuple(m.astype(float) for m in masks))


def binned(bins: Bins, *places: list[int]) -> Binned:
    return Binned("run", bins, [np.array(p, dtype=np.intp) for p in places])


def description(bins: Bins, means: list[float], counts: Any = 100, errors: Any = None) -> str:
    """Description of a pattern of bin means with a number of samples in each bin."""
    axis = Binned("run" if bins[0].name else "direction", bins, [], "N m")
    count = np.broadcast_to(np.array(counts, dtype=np.intp), len(bins))
    return pattern_words(axis, np.array(means), count, None if errors is None else np.array(errors))


def test_bin_means_use_only_counted_samples_that_have_a_bin() -> None:
    axis = binned(RUNS[:3], [0, 0, 2, -1, 0], [2, 2, -1, 0])
    residuals = [np.array([1.0, 3.0, -4.0, 50.0, 100.0]), np.array([-5.0, 9.0, 50.0, 5.0])]
    samples = samples_of(np.array([1, 1, 1, 1, 0]), np.array([1, 0, 1, 1]))
    means, counts = bin_means(axis, samples, residuals)
    assert counts.tolist() == [3, 0, 2]
    assert means.tolist() == [3.0, 0.0, -4.5]


def test_pattern_share_is_the_explained_square_minus_one_variance_per_bin() -> None:
    """Three bins of ten samples explain 50 N^2 of a sum of squares of 95 N^2."""
    axis = binned(RUNS[:4], [0] * 10 + [1] * 10 + [2] * 10 + [-1] * 5)
    residuals = np.repeat([2.0, -1.0, 0.0, 3.0], [10, 10, 10, 5])
    samples = samples_of(np.ones(35))
    found = pattern_along(axis, samples, [residuals], 0.5)
    assert found is not None
    assert found.share == pytest.approx((50.0 - 3 * 0.25) / 95.0, rel=1e-12)
    assert found.means_n.tolist() == [2.0, -1.0, 0.0, 0.0]
    assert found.counts.tolist() == [10, 10, 10, 0]
    assert found.bins == RUNS[:4]
    assert found.to_dict() == {"axis": "run", "where": found.where, "share": 0.5184}
    # A pattern whose share equals the minimum share is reported.
    assert pattern_along(axis, samples, [residuals], 0.5, found.share) is not None
    assert pattern_along(axis, samples, [residuals], 0.5, np.nextafter(found.share, 1.0)) is None


@pytest.mark.parametrize(("share", "reported"), [(0.0097, False), (0.0103, True)])
def test_pattern_below_1_percent_is_not_reported_by_default(share: float, reported: bool) -> None:
    """Residuals m + 1 and m - 1 have the mean square 1 + m^2, of which the bin explains m^2."""
    mean = np.sqrt(share / (1.0 - share))
    residual = mean + np.tile([1.0, -1.0], 100)
    axis, samples = binned(RUNS[:1], [0] * 200), samples_of(np.ones(200))
    assert (pattern_along(axis, samples, [residual], 1e-6) is not None) == reported


@pytest.mark.parametrize(("excess", "reported"), [(-0.01, False), (0.01, True)])
@pytest.mark.parametrize("significance", [6.0, 9.0])
def test_pattern_is_reported_if_its_square_exceeds_the_chi_square_threshold(
    significance: float, excess: float, reported: bool
) -> None:
    """Chi-square with three degrees of freedom has mean 3 and standard deviation sqrt(6)."""
    noise = 0.7
    explained = (3.0 + significance * np.sqrt(6.0) + excess) * noise**2
    residual = np.full(30, np.sqrt(explained / 30.0))
    axis = binned(RUNS[:4], [0] * 10 + [1] * 10 + [3] * 10)
    samples = samples_of(np.ones(30))
    options = {} if significance == 6.0 else {"significance": significance}  # the default is 6
    found = pattern_along(axis, samples, [residual], noise, 0.0, **options)
    assert (found is not None) == reported


def test_pattern_sizes_are_those_of_the_second_residual_if_given() -> None:
    axis, samples = binned(RUNS[:2], [0] * 50 + [1] * 50), samples_of(np.ones(100))
    tested, reported = np.repeat([1.0, 0.0], 50), np.repeat([7.0, -9.0], 50)
    found = pattern_along(axis, samples, [tested], 0.01, told_of=[reported])
    assert found is not None
    assert found.share == pytest.approx((50.0 - 2e-4) / 50.0)
    assert found.means_n.tolist() == [7.0, -9.0]
    # A bin whose mean is zero in the tested residual is not named.
    assert "+7 N at run a" in found.where
    assert "run b" not in found.where
    assert pattern_along(axis, samples, [0.0 * tested], 0.01, told_of=[reported]) is None


def test_pattern_description_has_the_sign_and_the_mean_size_over_all_samples() -> None:
    """300 samples of 1 N m and 100 samples of 3 N m have a mean size of 1.5 N m."""
    for means, relation in (
        ([-1.0, 3.0], "record above the model by 1.5 N m"),
        ([1.0, -3.0], "record below the model by 1.5 N m"),
        ([1.0, 3.0], "record minus model +1.5 N m"),
        ([-1.0, -3.0], "record minus model -1.5 N m"),
    ):
        assert relation in description(DIRECTIONS, means, [300, 100])


def test_pattern_description_omits_direction_if_one_deviates_or_a_bin_rests() -> None:
    assert "record minus model +3 N m" in description(DIRECTIONS, [0.001, 3.0])
    with_rest = (*DIRECTIONS, Bin("at rest"))
    assert "direction of motion" not in description(with_rest, [-1.0, 1.0, 1.0])


@pytest.mark.parametrize(("other", "named"), [(-0.142, False), (-0.144, True)])
def test_bins_below_2_percent_of_square_are_not_named(other: float, named: bool) -> None:
    """x^2 / (1 + x^2) is 0.02 at x = 1/7."""
    assert ("run b" in description(RUNS[:2], [1.0, other])) == named


def test_pattern_description_names_the_bins_with_the_largest_explained_square() -> None:
    """10 samples of 2 N m explain 40 (N m)^2; 100 samples of 1 and -0.9 N m explain 100 and 81."""
    words = description(RUNS[:3], [2.0, 1.0, -0.9], [10, 100, 100])
    assert words == "most +1 N m at run b; -0.9 N m at run c"
    found_elsewhere = description(RUNS[:3], [1.0, -8.0, 2.0], errors=[3.0, 0.1, 3.0])
    assert found_elsewhere.endswith("most +2 N m at run c; +1 N m at run a")


@pytest.mark.parametrize(("counts", "throughout"), [([100] * 5, False), ([100] * 4 + [0], True)])
def test_pattern_in_over_4_of_5_bins_is_called_all(counts: list[int], throughout: bool) -> None:
    words = description(RUNS, [1.0, 1.0, 1.0, 1.0, 0.01], counts)
    assert words.startswith("all of run") == throughout


def two_runs() -> Campaign:
    runs = []
    for seed, duration_s in ((1, 60.0), (2, 41.0)):
        time = np.arange(0.0, duration_s, 0.02)
        speed = 0.12 * np.sin(0.9 * time) * np.sin(0.23 * time + 0.3 * seed)
        runs.append(Run.from_arrays(time, speed, 20.0 * np.sign(speed), name=f"{seed}"))
    return Campaign.prepare(Rig(), runs)


def noise_of(campaign: Campaign) -> list[Array]:
    random = np.random.default_rng(5)
    return [random.normal(0.0, 1.0, len(p.run)) for p in campaign.prepared]


def test_residual_of_white_noise_has_no_failures() -> None:
    campaign = two_runs()
    assert find_failures(campaign, campaign.samples, noise_of(campaign), 0.05, 1.0) == ()


def test_step_between_runs_is_the_largest_failure_with_its_share_and_means() -> None:
    campaign = two_runs()
    step = [r + level for r, level in zip(noise_of(campaign), (0.5, -0.5), strict=True)]
    found = find_failures(campaign, campaign.samples, step, 0.05, 1.0)
    assert found[0].axis == "run"
    # The step explains 0.25 of the mean square 1.25.
    assert found[0].share == pytest.approx(0.2, abs=0.03)
    assert found[0].means_n == pytest.approx([0.5, -0.5], abs=0.1)
    shares = [f.share for f in found]
    assert shares == sorted(shares, reverse=True)
