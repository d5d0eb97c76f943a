"""Errors that recur in each period of the motion: lack of fit with replicates."""

from collections.abc import Sequence
from functools import cache

import numpy as np
import pytest
from jbf.diagnosis import Remainder
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.residual_structure.periodic import find_replicates
from jbf.estimation.campaign import Campaign
from scipy import signal
from slides import Array, Mask, slides, solution_with, white_noise

PERIOD = 100
N = 9 * PERIOD


def two_harmonics(n: int, period: int = PERIOD) -> Array:
    """A periodic motion whose half periods differ."""
    angle = 2.0 * np.pi * np.arange(n) / period
    return np.asarray(np.sin(angle) + 0.3 * np.sin(2.0 * angle + 0.5))


@cache
def periodic(*counts: int, step_s: float = 0.05) -> Campaign:
    """Slides with a periodic velocity that never reverses."""
    return slides([0.1 + 0.02 * two_harmonics(n) for n in counts], step_s=step_s)


def wave(n: int, harmonic: int = 7) -> Array:
    """A recurring error of mean square one, of opposite sign half a period later."""
    return np.asarray(np.sqrt(2.0) * np.sin(2.0 * np.pi * harmonic * np.arange(n) / PERIOD + 0.3))


def not_recurring(n: int) -> Array:
    """A wave of mean square one whose autocorrelation at one period is zero."""
    signs = np.resize([1.0, 1.0, -1.0, -1.0], n // PERIOD + 1)
    return np.asarray(wave(n, 9) * np.repeat(signs, PERIOD)[:n])


def recurring_in(
    *residuals: Array,
    campaign: Campaign | None = None,
    counted: Sequence[Mask] | None = None,
    **policy: float,
) -> list[Remainder]:
    given = periodic(*(len(r) for r in residuals)) if campaign is None else campaign
    samples = given.samples if counted is None else given.samples.within(counted)
    _, solution = solution_with(given, residuals, samples=samples)
    return find_replicates(given.prepared, solution, DEFAULT.with_values(policy))


def runs_named(remainder: Remainder) -> list[str]:
    return remainder.where.rsplit(" in ", 1)[1].split(", ")


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_error_that_recurs_with_the_motion_is_reported_with_its_share(unit: float) -> None:
    """The recurring part has 1.44 of a mean square of 2.44, or 77 % of the RMS."""
    residual = unit * (1.2 * wave(N) + not_recurring(N))
    (found,) = recurring_in(residual)
    assert found.axis == "period"
    assert found.share == pytest.approx(1.44 / 2.44, rel=1e-6)
    assert "77 % of the residual RMS" in found.where
    assert recurring_in(unit * not_recurring(N)) == []
    for part, there in ((0.99, True), (1.01, False)):
        assert bool(recurring_in(residual, **{"replicates.min_share": part * 1.44 / 2.44})) == there


@pytest.mark.parametrize("unit", [1e-3, 1e3])
def test_significance_of_a_recurring_wave_is_the_square_root_of_its_pairs(unit: float) -> None:
    """Products of white noise have a standard deviation equal to the mean square."""
    for part, found in ((0.99, True), (1.01, False)):
        sigma = part * float(np.sqrt(N - PERIOD))
        assert bool(recurring_in(unit * wave(N), **{"replicates.min_sigma": sigma})) == found


def test_significance_of_a_recurring_error_is_lower_if_it_covers_part_of_the_record() -> None:
    """The products have a long-run variance above that of white noise."""
    residual = wave(9 * PERIOD) * np.repeat([1.0] * 6 + [0.0] * 3, PERIOD)
    (found,) = recurring_in(residual, **{"replicates.min_sigma": 1.0})
    white = found.share * float(np.sqrt(8 * PERIOD))
    assert recurring_in(residual, **{"replicates.min_sigma": 0.9 * white}) == []


def test_constant_residual_is_not_reported_as_a_recurring_error() -> None:
    """A constant is also correlated half a period later, where the wave has the opposite sign."""
    assert recurring_in(np.full(N, 1.5)) == []
    (found,) = recurring_in(1.5 + wave(N))
    assert found.share == pytest.approx(2.0 / 3.25, rel=1e-6)


@pytest.mark.parametrize("lag", [0.5, 0.6, 0.7, 0.8, 0.9])
def test_share_of_a_recurring_error_excludes_the_correlation_of_the_noise(lag: float) -> None:
    """The mean product of 1 + cos is at least 1 - 1/2, and 1 + cos(pi / lag) / 2 a period later."""
    residual = 1.0 + np.cos(np.pi * np.arange(20_000) / (lag * PERIOD))
    (found,) = recurring_in(
        residual, **{"replicates.min_share": 1e-3, "replicates.min_sigma": 1e-6}
    )
    expected = 0.5 * (1.0 + np.cos(np.pi / lag)) / 1.5
    assert found.share == pytest.approx(expected, abs=5e-3)


@pytest.mark.parametrize("memory_s", [0.2, 4.0, 20.0])
def test_coloured_noise_is_not_reported_as_a_recurring_error(memory_s: float) -> None:
    """The memory of the noise may be longer than a period of five seconds."""
    keep = float(np.exp(-0.05 / memory_s))
    campaign = periodic(3000, 3000)
    for seed in range(5):
        white, kicks = white_noise(campaign, seed), white_noise(campaign, 100 + seed)
        slow = [signal.lfilter([np.sqrt(1.0 - keep**2)], [1.0, -keep], e) for e in kicks]
        assert recurring_in(*(a + b for a, b in zip(white, slow, strict=True))) == []


def test_only_runs_with_a_recurring_error_are_named() -> None:
    noise = white_noise(periodic(4000, 4000, 4000), 3)
    (found,) = recurring_in(noise[0] + wave(4000), noise[1], noise[2] + wave(4000))
    assert runs_named(found) == ["a", "c"]
    assert found.share == pytest.approx(2.0 / 5.0, abs=0.04)


def test_run_without_a_period_is_excluded_from_recurring_errors() -> None:
    ramp = np.linspace(0.1, 0.2, N)
    residual = 1.2 * wave(N) + not_recurring(N)
    assert recurring_in(residual, campaign=slides([ramp], step_s=0.05)) == []
    motions = [ramp, 0.1 + 0.02 * two_harmonics(N)]
    (found,) = recurring_in(100.0 * residual, residual, campaign=slides(motions, step_s=0.05))
    assert runs_named(found) == ["b"]
    assert found.share == pytest.approx(1.44 / 2.44, rel=1e-6)


@pytest.mark.parametrize(("pairs", "found"), [(99, False), (100, True)])
def test_recurring_error_is_not_reported_for_a_run_with_fewer_than_100_sample_pairs(
    pairs: int, found: bool
) -> None:
    n = PERIOD + pairs
    assert bool(recurring_in(5.0 * wave(n))) == found
    (both,) = recurring_in(5.0 * wave(n), wave(3000))
    assert runs_named(both) == (["a", "b"] if found else ["b"])


def test_recurring_error_is_estimated_without_pairs_of_excluded_samples() -> None:
    n = 4000
    bad = np.arange(n) % (2 * PERIOD) < 30
    noise = white_noise(periodic(n), 5)[0]
    assert recurring_in(np.where(bad, 100.0, noise), counted=[~bad]) == []
    (found,) = recurring_in(np.where(bad, 100.0, noise + wave(n)), counted=[~bad])
    assert found.share == pytest.approx(0.5, abs=0.05)
