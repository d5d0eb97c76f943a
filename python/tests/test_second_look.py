"""What the residuals of a right model tell of the noise and of the runs: made by hand, of a kind
and size that are known."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest
from by_hand import LAW, Array, coulomb
from jbf import Rig, Run
from jbf.diagnosis.deviations import allowing_for, deviation
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.second_look import SecondLook, second_look
from jbf.diagnosis.uneven_noise import HUBER, noise_sizes
from jbf.estimation.campaign import Campaign
from jbf.estimation.minimum import settle
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from jbf.records.findings.finding import Finding
from scipy import stats

RUNS = 6
NOISE_N = 0.1
Change = Callable[[int, Array, np.random.Generator], Array]
"""Of a run's number, its friction and a source of chance: the force that is read."""


def campaign(change: Change, seed: int) -> Campaign:
    """Runs of half a minute that turn round, each at times of its own: a zero is no friction."""
    random = np.random.default_rng(seed)
    t = np.arange(0.0, 30.0, 0.02)
    runs = []
    for i in range(RUNS):
        rate = 1.0 + 0.17 * i
        v = 0.12 * np.sin(rate * t) + 0.05 * np.sin(0.618 * rate * t + i)
        force = change(i, coulomb(t, v, v), random)
        runs.append(Run.from_arrays(t, v, force, name=f"run {i}"))
    return Campaign.prepare(Rig(), runs)


def fitted(campaign: Campaign) -> tuple[Problem, Solution]:
    """The law that made the runs, fitted to them; at such speeds nothing tells of F_s."""
    problem = Problem(campaign, "coulomb", "journal", (), {"F_s_n": 6.0})
    start = problem.starts({"F_s_n": 6.0, **LAW})[0]
    near = problem.solution(start, campaign.samples, WHITE, False)
    return problem, settle(problem, near)


def looked(change: Change, seed: int = 0) -> tuple[SecondLook, Solution]:
    problem, solution = fitted(campaign(change, seed))
    return second_look(problem, solution, DEFAULT), solution


def deviating(change: Change, among: Sequence[int] = range(RUNS)) -> tuple[Campaign, Solution]:
    """The campaign with the clearest deviation of its runs allowed for, and the fit before."""
    return allowed(campaign(change, 0).only(list(among)))


def allowed(whole: Campaign) -> tuple[Campaign, Solution]:
    problem, solution = fitted(whole)
    found = deviation(problem, solution, whole.samples, DEFAULT)
    return whole if found is None else allowing_for(whole, found), solution


def only(seen: SecondLook) -> Finding:
    """The one finding, which goes for all runs."""
    assert seen.found
    (finding,) = seen.campaign.more_findings
    assert finding.channel == "friction_n"
    assert finding.run == ", ".join(f"run {i}" for i in range(RUNS))
    return finding


def gaussian(random: np.random.Generator, n: int) -> Array:
    return NOISE_N * random.standard_normal(n)


def deviations(sd: float) -> Array:
    """One for each run, whose standard deviation is what it is."""
    raw = np.array([0.4, -1.3, 0.9, -0.2, 1.5, -1.1])
    found: Array = sd * (raw - raw.mean()) / raw.std(ddof=1)
    return found


# ---- nothing ----------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(6))
def test_white_gaussian_noise_asks_for_nothing(seed: int) -> None:
    seen, _ = looked(lambda i, f, random: f + gaussian(random, len(f)), seed)
    assert not seen.found
    assert seen.campaign.more_findings == ()
    assert seen.campaign.samples.between is None
    assert seen.campaign.samples.level is None


def test_short_runs_of_even_noise_are_seldom_called_uneven() -> None:
    # Six runs of 500 samples: their sizes scatter by chance.
    problem, solution = fitted(campaign(lambda i, f, random: f, 0))
    short = [np.arange(len(c)) < 500 for c in solution.samples.counted]
    samples = solution.samples.within(short)
    uneven = 0
    for seed in range(30):
        random = np.random.default_rng(seed)
        e = [gaussian(random, len(r)) for r in solution.residuals]
        seen = second_look(problem, replace(solution, residuals=e, samples=samples), DEFAULT)
        uneven += seen.found
    assert uneven <= 1


# ---- the noise --------------------------------------------------------------------------------


@pytest.mark.parametrize("share", [0.03, 0.06])
def test_noise_that_grows_with_the_force(share: float) -> None:
    def change(i: int, f: Array, random: np.random.Generator) -> Array:
        return f + np.hypot(0.05, share * f) * random.standard_normal(len(f))

    seen, solution = looked(change)
    found = only(seen)
    assert (found.kind, found.unit, found.done) == ("noise_with_force", "1", "weighed")
    assert found.size == pytest.approx(share, rel=0.15)
    # Weighed by it the noise is as large at large forces as at small ones.
    samples = seen.campaign.samples
    force = samples.flat([np.abs(p.friction_n) for p in seen.campaign.prepared])
    r = samples.flat([a * w for a, w in zip(solution.residuals, samples.weight, strict=True)])
    large = force > np.median(force)
    assert np.std(r[large]) == pytest.approx(np.std(r[~large]), rel=0.06)
    plain = solution.samples.flat(solution.residuals)
    assert np.std(plain[large]) > 1.15 * np.std(plain[~large])
    assert max(float(w.max()) for w in samples.weight) <= 1.0


@pytest.mark.parametrize("ratio", [1.5, 4.0])
def test_noise_that_differs_by_run(ratio: float) -> None:
    seen, solution = looked(
        lambda i, f, random: f + gaussian(random, len(f)) * (ratio if i == 2 else 1.0)
    )
    found = only(seen)
    assert (found.kind, found.unit, found.done) == ("noise_by_run", "1", "weighed")
    # The extremes of six sizes, each known to 4 % or so.
    assert found.size == pytest.approx(ratio, rel=0.2)
    weights = [w[c] for w, c in zip(*by_run(seen), strict=True)]
    for w in weights:
        np.testing.assert_allclose(w, w[0], rtol=1e-12)
    others = np.mean([w[0] for i, w in enumerate(weights) if i != 2])
    assert others / weights[2][0] == pytest.approx(ratio, rel=0.1)
    assert solution.samples.level is None


def by_run(seen: SecondLook) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
    return seen.campaign.samples.weight, seen.campaign.samples.counted


def test_equal_readings_of_a_coarse_converter_are_not_quiet() -> None:
    """In a run whose converter takes steps larger than the noise most readings are equal."""

    def coarse(i: int, force: Array, random: np.random.Generator) -> Array:
        read = force + NOISE_N * random.standard_normal(len(force))
        return 10.0 * NOISE_N * np.round(read / (10.0 * NOISE_N)) if i == 2 else read

    problem, solution = fitted(campaign(coarse, 3))
    sizes, _ = noise_sizes(problem, solution, DEFAULT)
    # Its rounding is three times the noise of the others: it counts for less, none for nothing.
    least = [float(np.min(s)) for s in sizes]
    assert least[2] == min(least)
    assert min(least) > 0.2


@pytest.mark.parametrize("samples", [60, 190, 1501])
def test_of_few_samples_no_size_of_noise_is_told(samples: int) -> None:
    """Noise that grows steeply with the force: of six runs' 1140 samples no bin has two hundred."""

    def steep(i: int, force: Array, random: np.random.Generator) -> Array:
        sd = 0.01 + np.maximum(np.abs(force) - 5.0, 0.0)
        return force + sd * random.standard_normal(len(force))

    whole = campaign(steep, 2)
    runs = [p.run.select(slice(samples)) for p in whole.prepared]
    problem, solution = fitted(Campaign.prepare(Rig(), runs))
    sizes, found = noise_sizes(problem, solution, DEFAULT)
    enough = solution.samples.count >= 1200
    assert enough == (samples > 200)
    assert ("noise_with_force" in {f.kind for f in found}) == enough
    assert all(np.ptp(s) > 0.0 for s in sizes) == enough


@pytest.mark.parametrize("seed", [0, 1])
def test_heavy_tails(seed: int) -> None:
    seen, solution = looked(lambda i, f, random: f + NOISE_N * random.standard_t(3.0, len(f)), seed)
    found = {f.kind: f for f in seen.campaign.more_findings}["heavy_tails"]
    assert (found.unit, found.done) == ("1", "weighed")
    # What Student's t of three degrees of freedom has beyond four Gaussian standard deviations.
    one = stats.t.ppf(stats.norm.cdf(0.6745), 3.0) / 0.6745
    assert found.size == pytest.approx(2.0 * stats.t.sf(4.0 * one, 3.0), rel=0.2)
    flat = np.abs(solution.samples.flat(solution.residuals))
    sigma = np.median(flat) / 0.6745
    weights, counted = by_run(seen)
    level = seen.campaign.samples.level
    assert level is not None
    for w, c, s, r in zip(weights, counted, level, solution.residuals, strict=True):
        # Huber's: the square of the weight is so many standard deviations over the residual's.
        share = (w[c] / s[c]) ** 2
        wanted = np.minimum(1.0, HUBER * sigma / np.abs(r[c] * s[c]))
        np.testing.assert_allclose(share, wanted, rtol=0.05)


def test_weights_are_given_once() -> None:
    seen, _ = looked(lambda i, f, random: f + NOISE_N * random.standard_t(3.0, len(f)))
    again = second_look(*fitted(seen.campaign), DEFAULT)
    assert not again.found
    assert again.campaign is seen.campaign


# ---- the runs ---------------------------------------------------------------------------------


def test_runs_with_a_zero_of_their_own() -> None:
    zero = deviations(0.15)
    again, solution = deviating(lambda i, f, random: f + gaussian(random, len(f)) + zero[i])
    (found,) = again.more_findings
    assert (found.kind, found.unit, found.done) == ("level_by_run", "N", "a spread of the runs")
    assert found.size == pytest.approx(0.15, rel=0.1)
    samples = again.samples
    assert samples.between is not None
    assert samples.between.names == ("zero",)
    for column in samples.between.directions:
        np.testing.assert_allclose(column, found.size)
    # What the runs' deviations are told to be is what they were made with.
    told = [
        float(np.mean(r - left))
        for r, left in zip(
            solution.residuals, samples.without_deviations(solution.residuals, WHITE), strict=True
        )
    ]
    np.testing.assert_allclose(told, zero, atol=0.03)


def test_of_two_runs_no_spread_is_told() -> None:
    def change(i: int, f: Array, random: np.random.Generator) -> Array:
        return f + gaussian(random, len(f)) + 0.5 * i

    assert deviating(change, [0, 1])[0].more_findings == ()
    assert deviating(change, [0, 1, 2, 3])[0].more_findings != ()


def test_runs_with_a_gain_of_their_own() -> None:
    gain = deviations(0.05)
    again, solution = deviating(lambda i, f, random: f * (1.0 + gain[i]) + gaussian(random, len(f)))
    found = {f.kind: f for f in again.more_findings}
    assert "level_by_run" not in found
    assert found["gain_by_run"].size == pytest.approx(0.05, rel=0.15)
    assert found["gain_by_run"].unit == "1"
    between = again.samples.between
    assert between is not None
    assert between.names == ("gain",)
    force = fitted(again)[0].predict(solution.values)
    for column, f in zip(between.directions, force, strict=True):
        np.testing.assert_allclose(column[:, 0], found["gain_by_run"].size * f, rtol=1e-9)


def test_one_deviation_is_found_at_a_look() -> None:
    zero, gain = deviations(0.3), deviations(0.03)[::-1]

    def change(i: int, f: Array, random: np.random.Generator) -> Array:
        return f * (1.0 + gain[i]) + zero[i] + gaussian(random, len(f))

    first, _ = deviating(change)
    second, _ = allowed(first)
    for again, count in ((first, 1), (second, 2)):
        spreads = {f.kind: f.size for f in again.more_findings if "spread" in f.done}
        assert len(spreads) == count
        between = again.samples.between
        assert between is not None
        assert all(d.shape[1] == count for d in between.directions)
    assert spreads["level_by_run"] == pytest.approx(0.3, rel=0.15)
    assert spreads["gain_by_run"] == pytest.approx(0.03, rel=0.3)
    assert set(between.names) == {"zero", "gain"}
    assert allowed(second)[0] is second
