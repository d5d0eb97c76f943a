"""Weights of samples: noise that depends on force or run, and heavy tails."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from by_hand import LAW, Array, assert_recovered, coulomb
from jbf import Rig, Run, diagnose
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.terms.noise_variance import (
    force_weights,
    heavy_tails,
    robust_weights,
    run_weights,
    variance_by_force,
    variance_by_run,
)
from jbf.diagnosis.terms.proposal import is_accepted
from jbf.estimation.campaign import Campaign
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from jbf.estimation.variance import robust_size
from linear_campaigns import fit_from_truth, reversing_runs
from scipy import special, stats
from term_models import model_of

NOISE_N = 0.1
Change = Callable[[int, Array, np.random.Generator], Array]
"""Recorded force from the number of the run, friction (N) and random generator."""


def fitted(change: Change, *, seed: int = 0) -> tuple[Problem, Solution]:
    """Coulomb's law fitted to reversing runs; their motion does not determine F_s."""
    runs = reversing_runs(lambda i, t, f, random: change(i, f, random), seed=seed)
    return fit_from_truth(Campaign.prepare(Rig(), runs))


def weighted_after_fit(change: Change, seed: int = 0) -> tuple[Campaign, Solution]:
    """The campaign with all accepted terms of the residual-error model, and the first fit."""
    problem, solution = fitted(change, seed=seed)
    return weighted(problem, solution), solution


def weighted(problem: Problem, solution: Solution) -> Campaign:
    """The campaign after each accepted term, in the order of acceptance."""
    campaign = problem.campaign
    for term in (variance_by_force, variance_by_run, heavy_tails):
        model = model_of(problem, solution)
        proposal = term(model)
        if proposal is not None and is_accepted(proposal, model):
            campaign = proposal.campaign
            problem, solution = fit_from_truth(campaign)
    return campaign


def white(i: int, f: Array, random: np.random.Generator) -> Array:
    return np.asarray(f + NOISE_N * random.standard_normal(len(f)))


def kinds_of(draw: Callable[[int, Array], Array]) -> list[str]:
    """Kinds of findings for residuals that depend on the number of the run and its friction."""
    problem, solution = fitted(lambda i, f, random: f)
    residuals = [draw(i, f) for i, f in enumerate(problem.predict(solution.values))]
    return kinds(problem, replace(solution, residuals=residuals, noise=WHITE))


def kinds(problem: Problem, solution: Solution) -> list[str]:
    """Kinds of findings that concern the noise variance."""
    proposals = [w(problem, solution, DEFAULT) for w in (force_weights, run_weights)]
    return [f[1].kind for f in proposals if f is not None]


@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(seed, marks=pytest.mark.extended) for seed in range(1, 6))]
)
def test_samples_with_white_gaussian_noise_are_not_weighted(seed: int) -> None:
    campaign, _ = weighted_after_fit(white, seed)
    assert campaign.more_findings == ()
    assert campaign.samples.level is None


def test_chance_differences_of_noise_between_short_runs_are_rarely_reported() -> None:
    """The extremes of six noise levels from 260 samples each often differ by a quarter."""
    problem, solution = fitted(lambda i, f, random: f)
    samples = solution.samples.within([np.cumsum(c) <= 260 for c in solution.samples.counted])
    differ = uneven = 0
    for seed in range(30):
        random = np.random.default_rng(seed)
        draws = [random.standard_normal(len(r)) for r in solution.residuals]
        drawn = replace(solution, residuals=draws, noise=WHITE, samples=samples)
        uneven += bool(kinds(problem, drawn))
        sizes = [np.std(r[c]) for r, c in zip(draws, samples.counted, strict=True)]
        differ += max(sizes) > 1.1 * min(sizes)
    assert differ > 20
    assert uneven <= 1


@pytest.mark.parametrize("share", [0.03, 0.06])
def test_noise_proportional_to_the_force_is_estimated_and_weighted(share: float) -> None:
    campaign, solution = weighted_after_fit(
        lambda i, f, random: f + np.hypot(0.05, share * f) * random.standard_normal(len(f))
    )
    (found,) = campaign.more_findings
    assert (found.kind, found.unit) == ("noise_with_force", "1")
    assert found.size == pytest.approx(share, rel=0.15)
    samples = campaign.samples
    force = samples.flat([np.abs(p.friction) for p in campaign.prepared])
    weighted = samples.flat(solution.residuals) * samples.flat(samples.weight)
    large = force > np.median(force)
    assert np.std(weighted[large]) == pytest.approx(np.std(weighted[~large]), rel=0.06)
    assert max(float(w.max()) for w in samples.weight) <= 1.0


@pytest.mark.parametrize("unit", [1e-3, 1.0])
def test_inverse_squared_weights_are_linear_in_the_squared_force(unit: float) -> None:
    """Sensor noise of 0.5 N plus 5 % of forces up to 25 N, at random phases."""
    t = np.arange(0.0, 60.0, 0.02)
    speeds = [np.sin((1.0 + 0.2 * i) * t + 0.4) for i in range(3)]
    runs = [Run.from_arrays(t, v, coulomb(t, v, v), name=f"{i}") for i, v in enumerate(speeds)]
    problem, solution = fit_from_truth(Campaign.prepare(Rig(), runs))
    force = problem.predict(solution.values)
    random = np.random.default_rng(1)
    residuals = [unit * np.hypot(0.5, 0.05 * f) * random.standard_normal(len(f)) for f in force]
    drawn = replace(solution, residuals=residuals, noise=WHITE)
    weights, found = force_weights(problem, drawn, DEFAULT)
    squares = np.concatenate(force) ** 2
    inverse = np.concatenate(weights) ** -2.0
    slope, level = np.polyfit(squares, inverse, 1)
    np.testing.assert_allclose(slope * squares + level, inverse, rtol=1e-9)
    assert level / slope == pytest.approx((0.5 / 0.05) ** 2, rel=0.3)
    assert found.size == pytest.approx(0.05 * unit, rel=0.1)
    assert inverse.min() == pytest.approx(1.0)


def test_noise_that_decreases_with_the_force_is_not_weighted() -> None:
    random = np.random.default_rng(2)
    assert kinds_of(lambda i, f: np.sqrt(81.0 - f**2) * random.standard_normal(len(f))) == []


@pytest.mark.parametrize("ratio", [1.5, 4.0])
def test_ratio_of_noise_between_runs_is_estimated_and_weighted(ratio: float) -> None:
    sizes_n = [NOISE_N * (ratio if i == 2 else 1.0) for i in range(6)]
    campaign, _ = weighted_after_fit(
        lambda i, f, random: f + sizes_n[i] * random.standard_normal(len(f))
    )
    (found,) = campaign.more_findings
    assert (found.kind, found.unit) == ("noise_by_run", "1")
    # Ratio of the extremes of six noise levels, each with an error of about 4 %.
    assert found.size == pytest.approx(ratio, rel=0.2)
    samples = campaign.samples
    weights = [w[c] for w, c in zip(samples.weight, samples.counted, strict=True)]
    for weight in weights:
        np.testing.assert_allclose(weight, weight[0], rtol=1e-12)
    others = np.mean([w[0] for i, w in enumerate(weights) if i != 2])
    assert others / weights[2][0] == pytest.approx(ratio, rel=0.1)


@pytest.mark.parametrize(("ratio", "expected"), [(1.15, []), (1.4, ["noise_by_run"])])
def test_runs_are_weighted_if_noise_differs_by_a_quarter(ratio: float, expected: list[str]) -> None:
    # Every run has the same draws, so that only the ratio differs.
    noise = np.random.default_rng(3).standard_normal(10_000)
    assert kinds_of(lambda i, f: (ratio if i == 2 else 1.0) * noise[: len(f)]) == expected


def test_smooth_model_error_in_one_run_is_not_noise_of_that_run() -> None:
    random, wave = np.random.default_rng(4), 5.0 * np.sin(0.01 * np.arange(10_000))
    found = kinds_of(lambda i, f: random.standard_normal(len(f)) + (i == 2) * wave[: len(f)])
    assert "noise_by_run" not in found


def test_equal_readings_of_a_coarse_converter_are_not_taken_for_low_noise() -> None:
    """In steps of ten times the noise the rounding error is three times the noise of other runs."""

    def coarse(i: int, f: Array, random: np.random.Generator) -> Array:
        read = white(i, f, random)
        return 10.0 * NOISE_N * np.round(read / (10.0 * NOISE_N)) if i == 2 else read

    problem, solution = fitted(coarse, seed=3)
    weights, _ = run_weights(problem, solution, DEFAULT)
    least = [float(np.min(w)) for w in weights]
    assert least[2] == min(least)
    assert min(least) > 0.2


def _outliers(count: int, samples: int, unit: float = 1.0) -> Array:
    """Residuals with a robust standard deviation of one, some of them ten times as large."""
    e = 0.6745 * np.where(np.arange(samples) % 2, 1.0, -1.0)
    e[:count] = 10.0
    return unit * e


def _weights_of(residuals: list[Array], heavy: float = 6.0) -> tuple[list[Array], list[float]]:
    """Huber weights of residuals that are all counted, and the sizes of the findings."""
    time = [0.02 * np.arange(len(e)) for e in residuals]
    runs = [
        Run.from_arrays(t, 0.1 + 0.01 * np.sin(t + i), 5.0 + 0.1 * np.sin(3.0 * t), name=f"{i}")
        for i, t in enumerate(time)
    ]
    _, solution = fit_from_truth(Campaign.prepare(Rig(), runs))
    solution = replace(solution, residuals=residuals, noise=WHITE)
    proposal = robust_weights(solution, DEFAULT.with_values({"noise.min_tail_ratio": heavy}))
    return ([], []) if proposal is None else (list(proposal[0]), [proposal[1].size])


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_weight_of_an_outlier_is_that_of_huber(unit: float) -> None:
    """The squared weight is 2.5 standard deviations over the residual."""
    (weight,), sizes = _weights_of([_outliers(20, 1000, unit)])
    np.testing.assert_allclose(weight[:20], np.sqrt(DEFAULT.noise.huber_sigma / 10.0), rtol=1e-6)
    assert np.all(weight[20:] == 1.0)
    assert sizes == [0.02]
    assert DEFAULT.noise.huber_sigma == 2.5


@pytest.mark.parametrize(
    ("outliers", "samples", "heavy", "found"),
    [
        # At least five samples beyond four standard deviations.
        (4, 1000, 6.0, False),
        (5, 1000, 6.0, True),
        # The outliers must be `heavy` times as frequent as in a normal distribution, here 32
        # samples.
        (round(0.9 * 20.0 * special.ndtr(-4.0) * 50_000), 50_000, 10.0, False),
        (round(1.1 * 20.0 * special.ndtr(-4.0) * 50_000), 50_000, 10.0, True),
    ],
)
def test_heavy_tails_require_a_minimum_number_and_share_of_outliers(
    outliers: int, samples: int, heavy: float, found: bool
) -> None:
    _, sizes = _weights_of([_outliers(outliers, samples)], heavy)
    assert bool(sizes) == found


def test_heavy_tails_of_student_noise_are_weighted_once() -> None:
    campaign, solution = weighted_after_fit(
        lambda i, f, random: f + NOISE_N * random.standard_t(3.0, len(f))
    )
    found = {f.kind: f for f in campaign.more_findings}["heavy_tails"]
    robust_sd = stats.t.ppf(stats.norm.cdf(0.6745), 3.0) / 0.6745
    assert found.size == pytest.approx(2.0 * stats.t.sf(4.0 * robust_sd, 3.0), rel=0.2)
    sigma = robust_size(solution.samples.flat(solution.residuals))
    samples = campaign.samples
    assert samples.level is not None
    for weight, counted, level, residual in zip(
        samples.weight, samples.counted, samples.level, solution.residuals, strict=True
    ):
        huber = np.minimum(
            1.0, DEFAULT.noise.huber_sigma * sigma / np.abs(residual[counted] * level[counted])
        )
        np.testing.assert_allclose((weight[counted] / level[counted]) ** 2, huber, rtol=0.05)
    assert weighted(*fit_from_truth(campaign)) is campaign


def test_diagnosis_recovers_the_law_in_noise_with_heavy_tails() -> None:
    runs = reversing_runs(
        lambda i, t, f, random: f + NOISE_N * random.standard_t(3.0, len(t)),
        runs=3,
        duration_s=20.0,
    )
    found = diagnose(Rig(), runs, law="coulomb")
    assert (found.verdict, found.effects) == ("adequate", ())
    assert "heavy_tails" in {f.kind for f in found.findings}
    for name, true in LAW.items():
        assert_recovered(found.fit.parameters[name], true)
