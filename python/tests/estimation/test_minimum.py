"""The minimum of a fit: coloured noise, other likelihood maxima, robust weights."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from by_hand import LAW, Array, coulomb, four_runs
from campaigns import campaign
from coulomb_problems import HELD, STEP_S, autoregressive, coulomb_problem
from jbf import Run
from jbf.estimation.approach import approach
from jbf.estimation.campaign import Campaign
from jbf.estimation.held_out import held_out_by_run
from jbf.estimation.likelihood import likelihood_gain, noise_at
from jbf.estimation.minimum import (
    best_weighting,
    huber,
    minimum,
    polish,
    search_peaks,
    settle,
    student,
)
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.problem import Problem
from jbf.estimation.search import other_peaks, search_solution
from jbf.estimation.settings import DEFAULT as SETTINGS
from jbf.estimation.solution import Solution

NOISE_N = 0.1


def runs_with(more: Callable[[int, Run], Array], seed: int = 0) -> list[Run]:
    runs = four_runs(coulomb, noise_rms=NOISE_N, seed=seed)
    return [replace(r, friction=r.friction + more(i, r)) for i, r in enumerate(runs)]


def fitted(runs: list[Run]) -> tuple[Problem, Solution]:
    problem = coulomb_problem(runs)
    return problem, minimum(problem, [HELD])


def regression(
    problem: Problem, noise: Noise | None = None, weights: Array | None = None
) -> tuple[Array, Array]:
    """Least squares for F_c and F_v with samples or innovations; estimates and residuals."""
    rows, forces = [], []
    for p, c in zip(problem.campaign.prepared, problem.campaign.samples.counted, strict=True):
        v = p.motion.velocity[c]
        rows.append(np.stack([np.sign(v), v], axis=1))
        forces.append(p.friction[c])
    j, y = np.concatenate(rows), np.concatenate(forces)
    design, response = j, y
    if noise is not None:
        design = np.concatenate([noise.innovations(x, STEP_S) for x in rows])
        response = np.concatenate([noise.innovations(x, STEP_S) for x in forces])
    if weights is not None:
        design, response = design * weights[:, None], response * weights
    values, *_ = np.linalg.lstsq(design, response, rcond=None)
    return values, y - j @ values


def rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def test_fit_is_weighted_by_coloured_noise_only_if_the_rms_hardly_increases() -> None:
    weighted = 0
    for seed in (1, 3, 4, 6):
        noise = [autoregressive(10 * seed + i, 0.3, 0.5, 501) for i in range(4)]
        problem, found = fitted(runs_with(lambda i, run, noise=noise: noise[i], seed))  # type: ignore[misc]
        coloured = noise_at(problem, found.samples, found.values)
        assert coloured.colour > 0.0
        assert 0.1 < coloured.memory_s < 0.6
        generalised, residual = regression(problem, coloured)
        plain, least = regression(problem)
        allowed = rms(residual) < SETTINGS.noise.max_rms_ratio * rms(least)
        assert found.noise == (coloured if allowed else WHITE)
        weighted += allowed
        wanted, other = (generalised, plain) if allowed else (plain, generalised)
        assert abs(found.values[2] - wanted[1]) < 0.1 * abs(found.values[2] - other[1])
    assert weighted == 3


@pytest.mark.parametrize("height", [1.0, 3.0])
def test_fit_of_a_wrong_law_is_not_weighted_by_the_coloured_noise_model(height: float) -> None:
    runs = runs_with(lambda i, r: height * np.sign(r.velocity) * np.exp(-r.time_s / 2.0))
    problem, found = fitted(runs)
    assert found.noise == WHITE
    noise = noise_at(problem, found.samples, found.values)
    assert noise.colour > 0.0
    values, least = regression(problem)
    _, coloured = regression(problem, noise)
    # With weights for this colour the fit would be far worse.
    assert rms(coloured) > 1.1 * SETTINGS.noise.max_rms_ratio * rms(least)
    assert found.rms <= SETTINGS.noise.max_rms_ratio * rms(least)
    np.testing.assert_allclose(found.values[[0, 2]], values, rtol=1e-3)


def test_other_peaks_are_the_two_lowest_minima_within_the_bounds() -> None:
    """Minima near 2e-3 exp(k pi / 6); the search has ended at that of k = 2."""
    evaluated: list[float] = []

    def square(values: Array) -> float:
        evaluated.append(float(values[1]))
        x = float(np.log(values[1] / 2e-3))
        return (x - 0.01) ** 2 + 1.0 - float(np.cos(12.0 * x))

    here = np.array([7.0, 2e-3 * np.exp(np.pi / 3.0)])
    found = other_peaks(square, here, 1, 1e-6, 1e2)
    places = [np.log(v[1] / 2e-3) * 6.0 / np.pi for v in found]
    assert places == pytest.approx([0.0, 1.0], abs=0.1)
    assert all(v[0] == 7.0 for v in found)
    # The minimum at which the search has ended is not among them.
    at_best = other_peaks(square, np.array([7.0, 2e-3]), 1, 1e-6, 1e2)
    assert [np.log(v[1] / 2e-3) * 6.0 / np.pi for v in at_best] == pytest.approx([1, -1], abs=0.1)
    evaluated.clear()
    other_peaks(square, here, 1, 1e-6, 1e2)
    assert min(evaluated) == pytest.approx(here[1] / 5.0)
    assert max(evaluated) == pytest.approx(here[1] * 5.0)
    evaluated.clear()
    inside = other_peaks(square, here, 1, 2.2e-3, 1e-2)
    assert all(2.2e-3 < v[1] < 1e-2 for v in inside)
    assert all(2.2e-3 < place < 1e-2 for place in evaluated)


@pytest.mark.extended
def test_resonance_of_a_drive_is_recovered_from_a_wrong_starting_frequency() -> None:
    name = "drive_compliance.J"
    rig, runs, truth = campaign(8, ("drive_compliance",))
    problem = Problem(Campaign.prepare(rig, runs), "journal", "journal", ("drive_compliance",))
    right = truth["effects"]["drive_compliance"]["J"]
    which = problem.names.index(name)
    likeliest = minimum(problem, [{name: right}])
    for factor in (0.2, 5.0):
        start = problem.starts({name: factor * right})[0]
        end = search_solution(problem, problem.samples_at(start), start, WHITE, 60)
        found = search_peaks(problem, settle(problem, end))
        assert abs(found.values[which] / right - 1.0) < 0.2
        # As likely as the maximum next to the truth: within one standard error.
        assert likelihood_gain(likeliest, found) < 1.0
    held = Problem(problem.campaign, "journal", "journal", problem.effects, {name: right})
    start = settle(held, approach(held, [[{}]], 60))
    assert search_peaks(held, start) is start


def test_huber_weights_limit_the_influence_to_1_345_standard_deviations() -> None:
    """Psi of Huber (1964): the residual up to 1.345, and 1.345 above."""
    off = np.array([0.0, 0.5, 1.345, 2.69, 13.45])
    np.testing.assert_allclose(off * huber(off) ** 2, [0.0, 0.5, 1.345, 1.345, 1.345])
    np.testing.assert_array_equal(huber(off[:3]), 1.0)


def test_student_weights_have_the_derivative_of_the_log_density() -> None:
    """Minus twice the log of Student's density with 3 degrees of freedom (Lange et al. 1989)."""
    off = np.linspace(0.1, 20.0, 50)
    h = 1e-5
    up, down = (4.0 * np.log(1.0 + (off + s * h) ** 2 / 3.0) for s in (1.0, -1.0))
    np.testing.assert_allclose(2.0 * off * student(off) ** 2, (up - down) / (2.0 * h), rtol=1e-6)


def test_unweighted_fit_is_returned_if_noise_is_gaussian() -> None:
    for seed in range(3):
        problem, plain = fitted(four_runs(coulomb, noise_rms=NOISE_N, seed=seed))
        assert best_weighting(problem, plain) is plain


def iteratively_reweighted(problem: Problem, weights: Callable[[Array], Array]) -> Array:
    """Four rounds of weighted least squares, scaled by the median absolute residual."""
    values, residual = regression(problem)
    for _ in range(4):
        scale = np.median(np.abs(residual)) / 0.6745
        values, residual = regression(problem, weights=weights(np.abs(residual) / scale))
    return values


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.extended)])
def test_robust_weights_are_used_if_outliers_in_one_run_raise_the_held_out_error(seed: int) -> None:
    random = np.random.default_rng(seed)
    # In one run three of ten samples deviate by ten standard deviations.
    runs = runs_with(
        lambda i, run: (random.random(len(run)) < 0.3) * np.sign(run.velocity) * (i == 0), seed
    )
    early = np.arange(501) < 30
    spoilt = [replace(r, friction=r.friction + 20.0 * early) for r in runs]
    # Excluded samples have zero weight, regardless of their residuals.
    kept = coulomb_problem(spoilt).campaign.without([early] * 4)
    problem = Problem(kept, "coulomb", "journal", (), HELD)
    plain = minimum(problem, [HELD])
    found = best_weighting(problem, plain)
    assert not any(w[early].any() for w in found.samples.weight)
    assert np.linalg.norm(np.concatenate(held_out_by_run(problem, found))) < 0.97 * np.linalg.norm(
        np.concatenate(held_out_by_run(problem, plain))
    )
    # Iteratively reweighted least squares by NumPy, with either kind of weights.
    ends = [iteratively_reweighted(problem, weights) for weights in (huber, student)]
    assert min(np.max(np.abs(found.values[[0, 2]] / end - 1.0)) for end in ends) < 1e-3
    speed = np.linspace(0.05, 0.15, 11)
    true = LAW["F_c"] + LAW["F_v"] * speed
    before, after = (rms(s.values[0] + s.values[2] * speed - true) for s in (plain, found))
    assert after < 0.6 * before
    far = np.abs(found.samples.flat(found.residuals)) > 6.0 * NOISE_N
    weight = found.samples.flat(found.samples.weight)
    assert weight[far].max() < weight[~far].min() + 0.2
    assert found.samples.count == plain.samples.count


def test_robust_weights_reduce_the_bias_of_the_slope_by_few_outliers() -> None:
    """In squared held-out errors the outliers would mask the improvement at all other samples."""
    random = np.random.default_rng(1)

    def wild(i: int, run: Run) -> Array:
        v = run.velocity
        return 4.0 * (random.random(len(run)) < 0.05) * np.sign(v) * (np.abs(v) > 0.1)

    problem, plain = fitted(runs_with(wild))
    slope = LAW["F_v"]
    assert abs(plain.values[2] / slope - 1.0) > 0.1
    found = best_weighting(problem, plain)
    assert abs(found.values[2] - slope) < 0.3 * abs(plain.values[2] - slope)


def test_polished_fit_has_the_least_squares_estimates() -> None:
    """A solution within a gain of 0.5 of the minimum is continued to the estimates."""
    problem, exact = fitted(runs_with(lambda i, run: np.zeros(len(run))))
    values = exact.values.copy()
    values[2] *= 1.0005
    near = problem.solution(values, exact.samples, exact.noise)
    gain = likelihood_gain(exact, near)
    assert 0.01 < gain < 0.5
    found = polish(problem, near)
    wanted, _ = regression(problem, None if exact.noise.white else exact.noise)
    assert abs(likelihood_gain(exact, found)) < 0.01 * gain
    assert found.values[2] == pytest.approx(wanted[1], rel=1e-4)
