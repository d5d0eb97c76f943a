"""Random effects between runs: offset, gain and drift that differ from run to run."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from by_hand import Array, coulomb
from jbf import Diagnosis, Rig, Run, diagnose
from jbf.diagnosis.deviations import Deviation, allowing_for, deviation
from jbf.diagnosis.policy import DEFAULT
from jbf.estimation.campaign import Campaign
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from linear_campaigns import fit_from_truth, reversing_runs
from shared import shared

NOISE_N = 0.1
Extra = Callable[[int, Array, Array], Array]
"""Additional force from the number of the run, time (s) and friction (N)."""


def fitted(extra: Extra, *, runs: int = 6) -> tuple[Problem, Solution]:
    """Coulomb's law fitted to reversing runs; their motion does not determine F_s."""
    records = reversing_runs(
        lambda i, t, f, random: f + NOISE_N * random.standard_normal(len(t)) + extra(i, t, f),
        runs=runs,
    )
    return fit_from_truth(Campaign.prepare(Rig(), records))


def clearest(problem: Problem, solution: Solution, least_gain: float = 0.0) -> Deviation | None:
    return deviation(problem, solution, problem.campaign.samples, DEFAULT, least_gain)


def deviates(sd: float) -> Array:
    """Six values with mean zero and this standard deviation."""
    raw = np.array([0.4, -1.3, 0.9, -0.2, 1.5, -1.1])
    values: Array = sd * (raw - raw.mean()) / raw.std(ddof=1)
    return values


def constant(values: Sequence[float] | Array) -> Extra:
    return lambda i, t, f: np.full(len(t), values[i])


# ---- a single deviation -------------------------------------------------------------------------


def test_standard_deviation_of_offsets_between_runs_is_estimated() -> None:
    offsets_n = deviates(0.15)
    problem, solution = fitted(constant(offsets_n))
    found = clearest(problem, solution)
    assert found is not None
    assert (found.finding.kind, found.finding.unit) == ("level_by_run", "N")
    assert found.finding.size == pytest.approx(0.15, rel=0.1)
    between = found.samples.between
    assert between is not None
    assert between.names == ("zero",)
    for column in between.directions:
        np.testing.assert_allclose(column, found.finding.size)
    # Conditional means of the random effects.
    without = found.samples.without_deviations(solution.residuals, WHITE)
    estimates = [float(np.mean(r - w)) for r, w in zip(solution.residuals, without, strict=True)]
    np.testing.assert_allclose(estimates, offsets_n, atol=0.03)


def test_standard_deviation_of_gains_between_runs_is_estimated() -> None:
    gains = deviates(0.05)
    problem, solution = fitted(lambda i, t, f: gains[i] * f)
    found = clearest(problem, solution)
    assert found is not None
    assert (found.finding.kind, found.finding.unit) == ("gain_by_run", "1")
    assert found.finding.size == pytest.approx(0.05, rel=0.15)
    between = found.samples.between
    assert between is not None
    for column, force in zip(between.directions, problem.predict(solution.values), strict=True):
        np.testing.assert_allclose(column[:, 0], found.finding.size * force, rtol=1e-9)


def test_standard_deviation_of_drifts_between_runs_is_estimated() -> None:
    rates_n_s = deviates(0.03)
    problem, solution = fitted(lambda i, t, f: rates_n_s[i] * (t - np.mean(t)))
    found = clearest(problem, solution)
    assert found is not None
    assert (found.finding.kind, found.finding.unit) == ("drift_by_run", "N/s")
    assert found.finding.size == pytest.approx(0.03, rel=0.15)


def test_two_random_effects_are_found_one_after_the_other() -> None:
    offsets_n, gains = deviates(0.3), deviates(0.03)[::-1]
    problem, solution = fitted(lambda i, t, f: gains[i] * f + offsets_n[i])
    first = clearest(problem, solution)
    assert first is not None
    second_problem, second_solution = fit_from_truth(allowing_for(problem.campaign, first))
    second = clearest(second_problem, second_solution)
    assert second is not None
    both = allowing_for(second_problem.campaign, second)
    sizes = {f.kind: f.size for f in both.more_findings}
    assert sizes["level_by_run"] == pytest.approx(0.3, rel=0.15)
    assert sizes["gain_by_run"] == pytest.approx(0.03, rel=0.3)
    between = both.samples.between
    assert between is not None
    assert set(between.names) == {"zero", "gain"}
    assert all(direction.shape[1] == 2 for direction in between.directions)
    assert clearest(*fit_from_truth(both)) is None


def test_gain_of_a_random_effect_is_that_of_run_means_less_the_log_determinant() -> None:
    problem, solution = fitted(constant((0.5, -0.3, 0.1, -0.4)), runs=4)
    samples = problem.campaign.samples
    found = clearest(problem, solution)
    assert found is not None
    assert found.samples.between is not None
    centred = [e - np.mean(e[c]) for e, c in zip(solution.residuals, samples.counted, strict=True)]
    gain = samples.cost(solution.residuals, solution.noise) - samples.cost(centred, WHITE)
    volume = found.samples.between.log_determinant(samples.weight, samples.steps_s, WHITE)
    assert volume > 0.0
    assert found.gain == pytest.approx(gain - volume, rel=0.02)
    assert clearest(problem, solution, 0.99 * found.gain) is not None
    assert clearest(problem, solution, 1.01 * found.gain) is None


@pytest.mark.parametrize("offsets_n", [(0.5, -0.3, 0.1, -0.4), (-2.8, -1.3, -1.9, -2.4)])
def test_noise_within_runs_excludes_the_differences_between_runs(
    offsets_n: tuple[float, ...],
) -> None:
    found = clearest(*fitted(constant(offsets_n), runs=4))
    assert found is not None
    assert found.samples.between is not None
    assert found.samples.between.sigma_n == pytest.approx(NOISE_N, rel=0.35)


@pytest.mark.parametrize(
    "offsets_n",
    [
        pytest.param((0.2, 0.2, 0.2, 0.2), id="equal offsets"),
        pytest.param((0.0, 0.5), id="two runs"),
    ],
)
def test_no_random_effect_is_found_if_runs_are_equal_or_fewer_than_three(
    offsets_n: tuple[float, ...],
) -> None:
    assert clearest(*fitted(constant(offsets_n), runs=len(offsets_n))) is None


# ---- in a diagnosis -----------------------------------------------------------------------------


def _four_runs(mass_kg: float, offsets_n: tuple[float, ...]) -> list[Run]:
    """Faster reversing runs with an inertia and a separate offset for each run."""
    random, runs = np.random.default_rng(11), []
    t = np.arange(0.0, 20.0, 0.02)
    for i, offset_n in enumerate(offsets_n):
        rate = 2.0 + 0.3 * i
        v = 0.12 * np.sin(rate * t) + 0.05 * np.sin(0.618 * rate * t + i)
        a = 0.12 * rate * np.cos(rate * t) + 0.0309 * rate * np.cos(0.618 * rate * t + i)
        force = coulomb(t, v, a) + mass_kg * a + offset_n + NOISE_N * random.standard_normal(len(t))
        runs.append(Run.from_arrays(t, v, force, name=f"run {i}"))
    return runs


@shared
def _diagnosis(mass_kg: float, offsets_n: tuple[float, ...]) -> Diagnosis:
    return diagnose(Rig(), _four_runs(mass_kg, offsets_n), law="coulomb")


def test_effect_is_found_next_to_offsets_that_differ_by_run() -> None:
    found = _diagnosis(2.0, (0.5, -0.3, 0.1, -0.4))
    assert found.effects == ("inertia_leak",)
    sizes = {f.kind: f.size for f in found.findings}
    assert sizes["level_by_run"] == pytest.approx(np.std((0.5, -0.3, 0.1, -0.4), ddof=1), rel=0.2)
    mass = found.fit.parameters["inertia_leak.m_e_kg"]
    assert mass.stderr is not None
    assert abs(mass.value - 2.0) < 4.0 * mass.stderr
