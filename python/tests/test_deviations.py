"""Deviations of the runs: what they cost, when they are refused, and whom they give way to."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from by_hand import Array, coulomb
from jbf import Rig, Run, diagnose
from jbf.diagnosis import deviations, rounds
from jbf.diagnosis.deviations import deviation
from jbf.diagnosis.policy import DEFAULT
from jbf.estimation.between_runs import BetweenRuns
from jbf.estimation.campaign import Campaign
from jbf.estimation.minimum import minimum
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution

ZEROS = (0.5, -0.3, 0.1, -0.4)
NOISE_N = 0.1
Friction = Callable[[Array, Array, Array], Array]


def runs_of(friction: Friction, more: Callable[[int, Array], Array]) -> list[Run]:
    """Runs that turn round, each at times of its own: a zero is no friction."""
    random, runs = np.random.default_rng(11), []
    t = np.arange(0.0, 20.0, 0.02)
    for i in range(len(ZEROS)):
        rate = 2.0 + 0.3 * i
        v = 0.12 * np.sin(rate * t) + 0.05 * np.sin(0.618 * rate * t + i)
        a = 0.12 * rate * np.cos(rate * t) + 0.0309 * rate * np.cos(0.618 * rate * t + i)
        force = friction(t, v, a) + more(i, t) + NOISE_N * random.standard_normal(len(t))
        runs.append(Run.from_arrays(t, v, force, name=f"run {i}"))
    return runs


def zeroed(friction: Friction, zeros: tuple[float, ...] = ZEROS) -> list[Run]:
    return runs_of(friction, lambda i, t: np.full(len(t), zeros[i]))


def fitted(zeros: tuple[float, ...] = ZEROS) -> tuple[Problem, Solution]:
    """The law that made the runs; at such speeds nothing tells of F_s."""
    campaign = Campaign.prepare(Rig(), zeroed(coulomb, zeros))
    problem = Problem(campaign, "coulomb", "journal", (), {"F_s_n": 6.0})
    return problem, minimum(problem, [{}])


def test_what_freedom_costs_is_a_determinant() -> None:
    random = np.random.default_rng(5)
    sizes = (40, 60)
    directions = tuple(0.4 * random.standard_normal((n, 2)) for n in sizes)
    weights = [random.uniform(0.2, 1.0, n) for n in sizes]
    weights[0][3:6] = 0.0
    between = BetweenRuns(("zero", "gain"), directions, 0.3)
    # By hand: of the correlation matrix of the weighted innovations.
    noise, expected = Noise(0.1, 0.3), 0.0
    for d, w in zip(directions, weights, strict=True):
        n = noise.innovations(d * w[:, None], 0.02)[w > 0.0]
        whole = np.eye(len(n)) + n @ n.T / 0.3**2
        expected += float(np.linalg.slogdet(whole)[1])
    assert between.log_determinant(weights, (0.02, 0.02), noise) == pytest.approx(expected)


def test_a_zero_of_its_own_is_found_and_must_gain_enough() -> None:
    problem, solution = fitted()
    samples = problem.campaign.samples
    found = deviation(problem, solution, samples, DEFAULT)
    assert found is not None
    assert found.finding.kind == "level_by_run"
    assert found.finding.size == pytest.approx(np.std(ZEROS, ddof=1), rel=0.1)
    assert found.samples.between is not None
    # Against a fit by hand: each run's mean, and what the freedom to deviate costs.
    r = [e - np.mean(e[c]) for e, c in zip(solution.residuals, samples.counted, strict=True)]
    # What deviates had passed for colour as well as it could.
    assert solution.noise.colour > 0.01
    white = samples.cost(solution.residuals, solution.noise) - samples.cost(r, WHITE)
    volume = found.samples.between.log_determinant(samples.weight, samples.steps_s, WHITE)
    assert found.gain == pytest.approx(white - volume, rel=0.01)
    assert volume > 0.02 * white
    assert deviation(problem, solution, samples, DEFAULT, 0.99 * found.gain) is not None
    assert deviation(problem, solution, samples, DEFAULT, 1.01 * found.gain) is None


@pytest.mark.parametrize("zeros", [ZEROS, (-2.8, -1.3, -1.9, -2.4)])
def test_by_how_much_runs_differ_is_no_noise(zeros: tuple[float, ...]) -> None:
    """What deviations are measured by is the noise within runs, whatever differs between them."""
    problem, solution = fitted(zeros)
    found = deviation(problem, solution, problem.campaign.samples, DEFAULT)
    assert found is not None
    assert found.samples.between is not None
    # The law makes a little of the zeros its own: less than they are by far.
    assert found.samples.between.sigma_n == pytest.approx(NOISE_N, rel=0.35)


@pytest.mark.parametrize(
    ("before_n", "effect_n", "apart_n", "as_much"),
    [
        # Beside so much noise all leave as little: one explains less than four fifths.
        (0.17665, 0.17557, 0.17529, False),
        (0.17665, 0.17530, 0.17529, True),
        # Of much, the effect explains nearly all, and leaves a little more, or too much.
        (2.0, 1.029, 1.0, True),
        (2.0, 1.031, 1.0, False),
        # Where deviations explain nothing, an effect that explains something does as much.
        (1.0, 0.99, 1.0, True),
        (1.0, 1.01, 1.0, False),
    ],
)
def test_an_effect_says_as_much_as_deviations_where_it_explains_as_much(
    before_n: float, effect_n: float, apart_n: float, as_much: bool
) -> None:
    assert rounds._says_as_much(before_n, effect_n, apart_n, 1.03) == as_much


def test_runs_that_agree_do_not_deviate() -> None:
    problem, solution = fitted((0.2, 0.2, 0.2, 0.2))
    assert deviation(problem, solution, problem.campaign.samples, DEFAULT) is None


@pytest.mark.parametrize(("worse", "refused"), [(0.99, False), (1.01, True)])
def test_what_predicts_runs_left_out_worse_is_refused(
    worse: float, refused: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    problem, solution = fitted()
    rms: list[float] = []

    def by_run(problem: Problem, solution: Solution) -> list[Array]:
        # Asked of the fit with the deviation first; an error of its own in every run alike.
        rms.append(worse * DEFAULT.no_worse if not rms else 1.0)
        return [np.full(50, rms[-1]) for _ in ZEROS]

    monkeypatch.setattr(deviations, "left_out_by_run", by_run)
    found = deviation(problem, solution, problem.campaign.samples, DEFAULT)
    assert (found is None) == refused
    rms.clear()
    lenient = replace(DEFAULT, no_worse=1.1 * DEFAULT.no_worse)
    assert deviation(problem, solution, problem.campaign.samples, lenient) is not None


def test_one_odd_run_is_no_judge(monkeypatch: pytest.MonkeyPatch) -> None:
    problem, solution = fitted()
    ratios = iter([[1.5, 1.0, 1.0, 1.0], [1.0, 1.0, 1.0, 1.0]])
    monkeypatch.setattr(
        deviations, "left_out_by_run", lambda p, s: [np.full(50, r) for r in next(ratios)]
    )
    assert deviation(problem, solution, problem.campaign.samples, DEFAULT) is not None


def test_an_effect_gives_way_to_runs_that_differ() -> None:
    found = diagnose(Rig(), zeroed(coulomb, (0.9, 0.5, 0.1, 0.6)), law="coulomb")
    assert found.verdict == "adequate"
    assert {f.kind for f in found.findings} == {"level_by_run"}
    # The offset that the runs share was the best effect, and is not needed beside their spread.
    assert found.effects == ()


def test_an_effect_stays_beside_runs_that_differ() -> None:
    runs = zeroed(lambda t, v, a: coulomb(t, v, a) + 2.0 * a)
    found = diagnose(Rig(), runs, law="coulomb")
    assert "level_by_run" in {f.kind for f in found.findings}
    assert found.effects == ("inertia_leak",)
    assert [s.effects for s in found.steps] == [(), ("inertia_leak",)]


def test_a_drift_of_its_own_rate() -> None:
    rates = (0.05, -0.03, 0.02, -0.04)
    runs = runs_of(coulomb, lambda i, t: rates[i] * (t - np.mean(t)))
    found = diagnose(Rig(), runs, law="coulomb")
    (drift,) = [f for f in found.findings if f.kind == "drift_by_run"]
    assert drift.unit == "N/s"
    assert drift.size == pytest.approx(np.std(rates, ddof=1), rel=0.15)
    assert (found.verdict, found.effects) == ("adequate", ())
