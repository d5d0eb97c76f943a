"""Weights that a fit gives its samples: against outliers, and by the colour of their noise, beside
least squares and generalised least squares by numpy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from by_hand import LAW, Array, coulomb, four_runs
from jbf import Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.left_out import left_out_rms
from jbf.estimation.minimum import MOST_FORGIVEN, minimum
from jbf.estimation.noise import Noise
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from jbf.estimation.weighting import best_weighting, huber, student

NOISE_N = 0.1
HELD = {"F_s_n": 6.0}
"""Motions that never turn round tell nothing of it."""


def fitted(runs: list[Run]) -> tuple[Problem, Solution]:
    problem = Problem(Campaign.prepare(Rig(), runs), "coulomb", "journal", (), HELD)
    return problem, minimum(problem, [HELD])


def read(force: Callable[[int, Run], Array], seed: int = 0) -> list[Run]:
    """Runs by Coulomb's law in noise, and something more that was read in each."""
    runs = four_runs(coulomb, noise_n=NOISE_N, seed=seed)
    return [
        replace(r, friction_n=np.asarray(r.friction_n) + force(i, r)) for i, r in enumerate(runs)
    ]


def off_n(solution: Solution) -> float:
    """How far a solution is from the law on motions of another campaign without noise, RMS."""
    runs = four_runs(coulomb, noise_n=0.0, seed=9)
    problem = Problem(Campaign.prepare(Rig(), runs), "coulomb", "journal", (), HELD)
    return problem.campaign.samples.rms(problem.residuals(solution.values))


# ---- the weights themselves ------------------------------------------------------------------


def test_hubers_weights_pull_no_more_than_at_their_limit() -> None:
    off = np.array([0.0, 0.5, 1.345, 2.69, 13.45])
    # Psi (Huber 1964): the residual up to 1.345, and 1.345 beyond; a squared weight is psi over it.
    pull = off * huber(off) ** 2
    np.testing.assert_allclose(pull, [0.0, 0.5, 1.345, 1.345, 1.345])
    np.testing.assert_array_equal(huber(off[:3]), 1.0)


def test_students_weights_are_its_density() -> None:
    # minus two logs of t's density of 3 degrees of freedom: its slope is twice the pull.
    off = np.linspace(0.1, 20.0, 50)
    h = 1e-5

    def cost(x: Array) -> Array:
        found: Array = 4.0 * np.log(1.0 + x**2 / 3.0)
        return found

    slope = (cost(off + h) - cost(off - h)) / (2.0 * h)
    np.testing.assert_allclose(2.0 * off * student(off) ** 2, slope, rtol=1e-6)
    assert np.all(np.diff((off * student(off) ** 2)[off > np.sqrt(3.0)]) < 0.0)


# ---- which of them ---------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(4))
def test_of_gaussian_noise_the_plain_fit_is_the_answer(seed: int) -> None:
    problem, plain = fitted(four_runs(coulomb, noise_n=NOISE_N, seed=seed))
    assert best_weighting(problem, plain) is plain


@pytest.mark.parametrize("seed", range(3))
def test_a_run_that_is_often_off_does_not_draw_the_others(seed: int) -> None:
    random = np.random.default_rng(seed)

    def wild(i: int, run: Run) -> Array:
        found: Array = (random.random(len(run)) < 0.3) * np.sign(run.velocity_m_s) * (i == 0)
        return found

    problem, plain = fitted(read(wild, seed))
    found = best_weighting(problem, plain)
    assert found is not plain
    assert left_out_rms(problem, found) < 0.97 * left_out_rms(problem, plain)
    # What it was not fitted to, and knows nothing of what was off.
    assert off_n(found) < 0.6 * off_n(plain)
    # The same samples count, and those that are off count less.
    far = np.abs(found.samples.flat(found.residuals)) > 6.0 * NOISE_N
    weight = found.samples.flat(found.samples.weight)
    assert weight[far].max() < weight[~far].min() + 0.2
    assert found.samples.count == plain.samples.count


def test_a_few_wild_samples_do_not_draw_the_fit() -> None:
    share = 0.05
    random = np.random.default_rng(1)

    def wild(i: int, run: Run) -> Array:
        v = run.velocity_m_s
        found: Array = 4.0 * (random.random(len(run)) < share) * np.sign(v) * (np.abs(v) > 0.1)
        return found

    problem, plain = fitted(read(wild))
    assert abs(plain.values[2] / LAW["F_v_n_s_m"] - 1.0) > 0.1
    found = best_weighting(problem, plain)
    assert off_n(found) < 0.3 * off_n(plain)


# ---- colour ----------------------------------------------------------------------------------


def by_numpy(problem: Problem, noise: Noise | None = None) -> tuple[Array, float]:
    """Least squares for F_c and F_v, of samples or of innovations; the RMS of the residuals."""
    rows, forces = [], []
    for p in problem.campaign.prepared:
        v = p.motion.velocity_m_s
        rows.append(np.stack([np.sign(v), v], axis=1))
        forces.append(p.friction_n)
    if noise is None:
        j, y = np.concatenate(rows), np.concatenate(forces)
    else:
        j, y = (
            np.concatenate([noise.innovations(x, 0.02) for x in values])
            for values in (rows, forces)
        )
    values, *_ = np.linalg.lstsq(j, y, rcond=None)
    left = np.concatenate(forces) - np.concatenate(rows) @ values
    return values, float(np.sqrt(np.mean(left**2)))


def slow(seed: int, n: int, sd: float, memory_s: float = 0.2) -> Array:
    """A first-order process of so long a memory."""
    phi = np.exp(-0.02 / memory_s)
    kicks = np.random.default_rng(seed).normal(0.0, sd * np.sqrt(1.0 - phi**2), n)
    found = np.zeros(n)
    for k in range(n):
        found[k] = kicks[k] + (phi * found[k - 1] if k else 0.0)
    return found


def test_coloured_noise_weighs_as_generalised_least_squares() -> None:
    apart, plainly = [], []
    for seed in range(4):
        noise = [slow(10 * seed + i, 501, 0.5, 0.3) for i in range(4)]
        problem, found = fitted(read(lambda i, run, noise=noise: noise[i], seed))
        assert found.noise.colour > 0.0
        assert 0.1 < found.noise.memory_s < 0.6
        wanted, rms = by_numpy(problem, found.noise)
        plain, least = by_numpy(problem)
        assert least < rms < MOST_FORGIVEN * least
        assert found.rms_n == pytest.approx(rms, rel=1e-3)
        apart.append(abs(found.values[2] - wanted[1]))
        plainly.append(abs(plain[1] - wanted[1]))
    # It is that answer, and not plain least squares.
    assert np.mean(apart) < 0.1 * np.mean(plainly)


def worn_in(height: float) -> Callable[[int, Run], Array]:
    """Friction that sinks as the run goes on: smooth, and none of Coulomb's law."""

    def force(i: int, run: Run) -> Array:
        found: Array = height * np.sign(run.velocity_m_s) * np.exp(-run.time_s / 2.0)
        return found

    return force


@pytest.mark.parametrize("height", [1.0, 3.0])
def test_the_error_of_a_wrong_law_is_not_forgiven_as_colour(height: float) -> None:
    problem, found = fitted(read(worn_in(height)))
    assert found.noise.colour > 0.0
    values, least = by_numpy(problem)
    assert least > 2.0 * NOISE_N
    # Weighed by its colour it would be.
    _, coloured = by_numpy(problem, found.noise)
    assert coloured > 1.1 * MOST_FORGIVEN * least
    assert found.rms_n <= MOST_FORGIVEN * least
    np.testing.assert_allclose(found.values[[0, 2]], values, rtol=1e-3)
