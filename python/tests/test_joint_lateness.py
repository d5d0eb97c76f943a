"""Each run's lateness and the law in one least-squares problem: against the normal equations by
hand, and on runs that are late by times that are known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from by_hand import Array, coulomb
from jbf import Rig, Run
from jbf.diagnosis import late_channels
from jbf.diagnosis.late_channels import on_time
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.shifted import SETTLED, Shifted, by_one_clock, jointly, moved
from jbf.estimation.campaign import Campaign
from jbf.estimation.joint_lateness import (
    LINEAR_S,
    DriftStep,
    LatenessStep,
    drift_step,
    lateness_step,
)
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from late_runs import fitted
from scipy import stats

NOISE_N = 0.005
T = np.arange(0.0, 20.01, 0.02)
LATE_S = (24e-3, -6e-3, 31e-3, 9e-3)


def motion(run: int, t: Array, swing: float = 0.05) -> Array:
    """Never turns round; wanders at rates of the run's own, or stays at 0.1 m/s."""
    rate = 3.0 + 0.4 * run
    v: Array = 0.1 + swing * (0.6 * np.sin(rate * t) + 0.4 * np.sin(0.618 * rate * t + run))
    return v


def acceleration(run: int, t: Array) -> Array:
    rate = 3.0 + 0.4 * run
    slow = 0.618 * rate
    a: Array = 0.05 * (0.6 * rate * np.cos(rate * t) + 0.4 * slow * np.cos(slow * t + run))
    return a


def campaign(
    late_s: Sequence[float], *, seed: int = 0, still: int | None = None, noise_n: float = NOISE_N
) -> Campaign:
    """Coulomb's law at the instants at which its force was read; one run may keep its speed."""
    random, runs = np.random.default_rng(seed), []
    for i, late in enumerate(late_s):
        swing = 0.0 if i == still else 0.05
        v = motion(i, T - late, swing)
        force = coulomb(T, v, v) + noise_n * random.standard_normal(len(T))
        runs.append(Run.from_arrays(T, motion(i, T, swing), force, name=f"run {i}"))
    return Campaign.prepare(Rig(), runs)


def as_it_is(problem: Problem, solution: Solution) -> Shifted:
    return Shifted(problem, solution, np.zeros(len(problem.campaign.prepared)), 0.0)


def by_hand(
    problem: Problem, solution: Solution, accelerations: Sequence[Array]
) -> tuple[Array, Array]:
    """Lateness and its covariance by the normal equations: friction is F_c + F_v v, so its
    derivatives are one, the speed, and -F_v times the acceleration."""
    viscous = dict(zip(problem.names, solution.values.tolist(), strict=True))["F_v_n_s_m"]
    rows, right, runs = [], [], len(accelerations)
    for i, (residual, a) in enumerate(zip(solution.residuals, accelerations, strict=True)):
        keep = solution.samples.counted[i]
        late = np.zeros((len(a), runs))
        late[:, i] = -viscous * a
        speed = problem.campaign.prepared[i].motion.velocity_m_s
        rows.append(np.column_stack([np.ones(len(a)), speed, late])[keep])
        right.append(residual[keep])
    x, y = np.concatenate(rows), np.concatenate(right)
    found, *_ = np.linalg.lstsq(x, y, rcond=None)
    left = y - x @ found
    return found[2:], (float(left @ left) / len(y) * np.linalg.inv(x.T @ x))[2:, 2:]


def white(problem: Problem, solution: Solution) -> LatenessStep:
    return lateness_step(problem, replace(solution, noise=WHITE))


def test_a_step_solves_the_normal_equations_of_lateness_and_law() -> None:
    there = fitted(campaign((2e-3, -1e-3, 3e-3)))
    found = white(*there)
    wanted, covariance = by_hand(*there, [acceleration(i, T) for i in range(3)])
    assert found.told.all()
    np.testing.assert_allclose(found.late_s, wanted, atol=2e-5)
    np.testing.assert_allclose(found.late_s, (2e-3, -1e-3, 3e-3), atol=4e-4)
    np.testing.assert_allclose(found.covariance_s2, covariance, rtol=0.02, atol=1e-11)


def test_what_a_law_can_say_as_well_is_no_lateness() -> None:
    """Speeds that rise nearly evenly: a force that is late is a little less of dry friction."""
    runs, random = [], np.random.default_rng(3)
    for i, late in enumerate((6e-3, 2e-3, 4e-3)):
        rate = 0.5 + 0.1 * i

        def speed(t: Array, rate: float = rate) -> Array:
            v: Array = 0.05 + 0.02 * t + 0.02 * np.sin(rate * t)
            return v

        v = speed(T - late)
        force = coulomb(T, v, v) + NOISE_N * random.standard_normal(len(T))
        runs.append(Run.from_arrays(T, speed(T), force, name=f"run {i}"))
    there = fitted(Campaign.prepare(Rig(), runs))
    found = white(*there)
    rises = [0.02 + 0.02 * (0.5 + 0.1 * i) * np.cos((0.5 + 0.1 * i) * T) for i in range(3)]
    wanted, covariance = by_hand(*there, rises)
    np.testing.assert_allclose(found.late_s, wanted, atol=0.1 * np.sqrt(covariance[0, 0]))
    np.testing.assert_allclose(found.covariance_s2, covariance, rtol=0.02)
    # What they have in common is all but the law's: as good as nothing is known of it.
    assert np.min(np.diag(covariance)) > 5.0 * np.var(NOISE_N / (20.0 * rises[0])) / len(T)
    assert covariance[0, 1] > 0.5 * covariance[0, 0]


def drifting(drift: float, *, seed: int = 0, noise_n: float = NOISE_N) -> Campaign:
    """Runs of 20 s and 10 s whose forces were read by a clock that was started with each."""
    random, runs = np.random.default_rng(seed), []
    for i, t in enumerate((T, T[: len(T) // 2 + 1])):
        v = motion(i, t - drift * t)
        force = coulomb(t, v, v) + noise_n * random.standard_normal(len(t))
        runs.append(Run.from_arrays(t, motion(i, t), force, name=f"run {i}"))
    return Campaign.prepare(Rig(), runs)


def test_a_step_of_one_clock_solves_the_normal_equations() -> None:
    drift = 1.2e-4
    problem, solution = fitted(drifting(drift))
    viscous = dict(zip(problem.names, solution.values.tolist(), strict=True))["F_v_n_s_m"]
    rows, right = [], []
    for i, (p, residual) in enumerate(
        zip(problem.campaign.prepared, solution.residuals, strict=True)
    ):
        t, keep = p.run.time_s, solution.samples.counted[i]
        late = -viscous * acceleration(i, t) * t
        rows.append(np.column_stack([np.ones(len(t)), p.motion.velocity_m_s, late])[keep])
        right.append(residual[keep])
    x, y = np.concatenate(rows), np.concatenate(right)
    wanted, *_ = np.linalg.lstsq(x, y, rcond=None)
    left = y - x @ wanted
    variance = (float(left @ left) / len(y) * np.linalg.inv(x.T @ x))[2, 2]
    found = drift_step(problem, replace(solution, noise=WHITE))
    assert found.drift == pytest.approx(wanted[2], rel=0.02)
    assert found.drift == pytest.approx(drift, abs=4.0 * variance**0.5)
    assert found.variance == pytest.approx(variance, rel=0.02)
    assert found.square == pytest.approx(found.drift**2 / found.variance)


def test_beside_a_delay_a_drift_is_what_the_delay_does_not_say() -> None:
    """Forces that are all late by 3 ms: alone a drift takes half of it in their length; beside a
    delay it is none. The delay of a model that has one is not put in twice."""
    random, runs = np.random.default_rng(5), []
    for i in range(2):
        v = motion(i, T - 3e-3)
        force = coulomb(T, v, v) + NOISE_N * random.standard_normal(len(T))
        runs.append(Run.from_arrays(T, motion(i, T), force, name=f"run {i}"))
    there = fitted(Campaign.prepare(Rig(), runs))
    alone, beside = drift_step(*there), drift_step(*there, beside_delay=True)
    assert alone.drift == pytest.approx(1.5 * 3e-3 / 20.0, rel=0.3)
    assert alone.square > 50.0
    assert beside.square < 9.0
    assert beside.variance == pytest.approx(4.0 * alone.variance, rel=0.3)
    delayed = fitted(Campaign.prepare(Rig(), runs), ("time_delay",))
    assert drift_step(*delayed, beside_delay=True) == drift_step(*delayed)


def test_a_clock_that_no_run_tells_has_no_drift() -> None:
    """The force of a speed that is held is the same at any time."""
    still = [motion(0, T, 0.0) for _ in range(2)]
    random = np.random.default_rng(1)
    runs = [
        Run.from_arrays(T, v, coulomb(T, v, v) + 0.005 * random.standard_normal(len(T)), name=n)
        for v, n in zip(still, "ab", strict=True)
    ]
    found = drift_step(*fitted(Campaign.prepare(Rig(), runs)))
    assert (found.drift, found.variance, found.square) == (0.0, np.inf, 0.0)


@pytest.mark.parametrize("drift", [1.2e-4, -6e-4, 3e-3])
def test_one_clock_is_found_together_with_the_law(drift: float) -> None:
    """From far: at the end of the longer run by 2 ms, -12 ms or 60 ms, of 8 ms a step at most."""
    problem, solution = fitted(drifting(drift))
    found = by_one_clock(problem, as_it_is(problem, solution))
    step = drift_step(found.problem, found.solution)
    assert found.drift == pytest.approx(drift, abs=4.0 * step.variance**0.5)
    lasts_s = np.array([p.run.duration_s for p in problem.campaign.prepared])
    np.testing.assert_allclose(found.late_s, 0.5 * found.drift * lasts_s)
    assert step.square <= SETTLED**2
    assert found.solution.rms_n == pytest.approx(NOISE_N, rel=0.05)


def test_a_clock_that_is_right_is_left_alone() -> None:
    """Forty lots of noise, of which none tells a drift at one in 10,000."""
    asked = []
    for seed in range(40):
        problem, solution = fitted(drifting(0.0, seed=seed))
        asked.append(drift_step(problem, solution).square)
        assert late_channels._drifting(problem, solution, DEFAULT) is None
    # Wald's statistic is a chi-square of one degree: its mean is one, its median 0.45.
    assert 0.5 < np.mean(asked) < 1.7
    assert 0.2 < np.median(asked) < 0.9


def test_only_a_hint_of_a_drift_is_followed(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[float] = []

    def follow(first: Problem, start: Shifted) -> Shifted:
        asked.append(start.drift)
        return start

    monkeypatch.setattr(late_channels, "by_one_clock", follow)
    problem, solution = fitted(drifting(0.0, seed=0))
    for square, times in ((stats.chi2.isf(0.0501, 1), 0), (stats.chi2.isf(0.0499, 1), 1)):
        step = DriftStep(float(np.sqrt(square)), 1.0)
        monkeypatch.setattr(late_channels, "drift_step", lambda *at, told=step: told)
        assert late_channels._drifting(problem, solution, DEFAULT) is None
        assert asked == [0.0] * times


def test_beside_a_delay_each_run_is_as_late_as_it_is_beside_that() -> None:
    """A delay of all runs is a part of each one's: what is known of either is known of both."""
    problem, solution = fitted(campaign((12e-3, 9e-3, 13e-3)), ("time_delay",))
    found = white(problem, solution)
    delay_s = dict(zip(problem.names, solution.values.tolist(), strict=True))["time_delay.tau_s"]
    np.testing.assert_allclose(found.late_s + delay_s, (12e-3, 9e-3, 13e-3), atol=4e-4)
    alone = white(*fitted(campaign((0.0,) * 3)))
    np.testing.assert_allclose(np.diag(found.covariance_s2), np.diag(alone.covariance_s2), rtol=0.1)


def test_of_runs_on_time_the_chance_is_even() -> None:
    """Wald's test under its hypothesis: its probabilities are uniform (Kolmogorov & Smirnov)."""
    chances = [lateness_step(*fitted(campaign((0.0,) * 3, seed=s))).chance for s in range(60)]
    assert stats.kstest(chances, "uniform").pvalue > 0.02
    late = lateness_step(*fitted(campaign((0.0, 0.0, 2e-3)))).chance
    assert late < 1e-8


def test_a_run_at_one_speed_tells_nothing_and_takes_the_others_mean() -> None:
    step = lateness_step(*fitted(campaign((4e-3, 2e-3, 30e-3), still=2)))
    assert step.told.tolist() == [True, True, False]
    assert step.late_s[2] == 0.0
    assert step.covariance_s2.shape == (2, 2)
    variances = np.diag(step.covariance_s2)
    wanted = np.average([5e-3, 1e-3], weights=1.0 / variances)
    assert step.mean_s(np.array([5e-3, 1e-3, 7.0])) == pytest.approx(wanted)
    found = jointly(*first_and(campaign((4e-3, 2e-3, 30e-3), still=2)))
    assert 2e-3 < found.late_s[2] < 4e-3


def first_and(campaign: Campaign) -> tuple[Problem, Shifted]:
    problem, solution = fitted(campaign)
    return problem, as_it_is(problem, solution)


def test_where_no_run_tells_there_is_nothing_to_ask() -> None:
    nothing = LatenessStep(np.zeros(2), np.zeros((0, 0)), np.zeros(2, dtype=bool))
    assert nothing.chance == 1.0
    assert nothing.mean_s(np.array([1.0, 2.0])) == 0.0
    # Told worse than a step may go: of no use.
    assert not np.any(lateness_step(*fitted(campaign((0.0, 0.0), noise_n=30.0))).told)


@pytest.mark.parametrize("start_s", [(0.0,) * 4, (0.0, 20e-3, 0.0, 30e-3)])
def test_runs_end_where_they_belong_wherever_they_begin(start_s: tuple[float, ...]) -> None:
    """What all are late by is found with what they differ by, over several steps as they must be:
    the largest is four times as late as a step goes."""
    problem = fitted(campaign(LATE_S))[0]
    late_s = np.array(start_s)
    there = fitted(moved(problem, late_s, 0.0))
    found = jointly(problem, Shifted(*there, late_s, 0.0))
    assert max(LATE_S) > 3.0 * LINEAR_S
    np.testing.assert_allclose(found.late_s, LATE_S, atol=4e-4)
    assert found.solution.rms_n == pytest.approx(NOISE_N, rel=0.05)
    assert found.campaign is found.problem.campaign


def test_runs_on_time_stay() -> None:
    for seed in range(4):
        problem, before = first_and(campaign((0.0,) * 4, seed=seed))
        assert np.max(np.abs(jointly(problem, before).late_s)) < 4e-4


def test_a_delay_of_all_becomes_the_runs_lateness() -> None:
    problem, solution = fitted(campaign(LATE_S), ("time_delay",))
    found = jointly(problem, as_it_is(problem, solution))
    assert found.problem.effects == ()
    np.testing.assert_allclose(found.late_s, LATE_S, atol=4e-4)


def test_a_lateness_told_beside_another_model_is_told_anew() -> None:
    """Runs were shifted by what a wrong model said; what is told after is the whole."""
    whole = campaign(LATE_S)
    problem = fitted(whole)[0]
    wrong = np.array(LATE_S) - np.array((3e-3, -2e-3, 1e-3, 0.0))
    told = [
        late_channels._finding(p.run.name, late, 0.0)
        for p, late in zip(whole.prepared, wrong.tolist(), strict=True)
    ]
    before = moved(problem, wrong, 0.0).with_findings(told)
    again = on_time(*fitted(before), DEFAULT)
    assert again is not None
    assert [f.kind for f in again.more_findings] == ["late_channel"] * 4
    np.testing.assert_allclose([f.size for f in again.more_findings], LATE_S, atol=4e-4)
    assert fitted(again)[1].rms_n == pytest.approx(NOISE_N, rel=0.05)
    # And then there is nothing left to tell.
    assert on_time(*fitted(again), DEFAULT) is None


def test_a_mass_in_one_run_is_no_lateness_of_a_tenth_of_a_second() -> None:
    """Of viscous friction of 20 N s/m, 2 kg more are 100 ms less."""
    random, runs = np.random.default_rng(0), []
    for i in range(4):
        force = coulomb(T, motion(i, T), motion(i, T)) + (2.0 * acceleration(i, T) if i == 0 else 0)
        force = force + NOISE_N * random.standard_normal(len(T))
        runs.append(Run.from_arrays(T, motion(i, T), force, name=f"run {i}"))
    problem, before = first_and(Campaign.prepare(Rig(), runs))
    assert jointly(problem, before) is before
    assert on_time(problem, before.solution, DEFAULT) is None


def test_a_delay_of_all_runs_stays_the_instruments() -> None:
    """On the way to where all are late alike runs seem to differ."""
    for seed in range(3):
        there = fitted(campaign((30e-3,) * 4, seed=seed))
        assert late_channels._found(*there, DEFAULT) is None


def test_without_noise_nothing_says_how_surely() -> None:
    step = lateness_step(*fitted(campaign((0.0,) * 3, noise_n=0.0)))
    assert np.all(np.isfinite(step.late_s))
    assert 0.0 <= step.chance <= 1.0
    assert 0.0 <= step.differ_chance(np.zeros(3), 0.5) <= 1.0
    # Nothing at all is left: of no run is it said that it is surely on time.
    problem, solution = fitted(campaign((0.0,) * 3, noise_n=0.0))
    exact = replace(solution, residuals=[np.zeros(len(r)) for r in solution.residuals], noise=WHITE)
    step = lateness_step(problem, exact)
    assert not np.any(step.told)
    assert step.chance == 1.0
