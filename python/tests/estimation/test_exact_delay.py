"""Delay estimated from the jumps at reversals, with an error far below a sampling step."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from by_hand import LAW, Array
from delayed_runs import DELAY, fitted, value
from jbf import Rig, Run, compare, fit
from jbf.estimation.campaign import Campaign
from jbf.estimation.exact_delay import LEAST_STEPS, exact_delay
from jbf.estimation.likelihood import independent_share
from jbf.estimation.minimum import settle
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from jbf.estimation.spread import Spread, spread
from jbf.models.driven_motion import reversals
from jbf.models.late_reading import TAU
from scipy.stats import norm

STEP_S, TAU_S, NOISE_N = 0.02, 0.0471, 0.2
EXTENDED = pytest.mark.extended


def delayed_runs(
    seed: int, count: int = 4, duration_s: float = 20.0, speed_noise_m_s: float = 1e-4
) -> list[Run]:
    """Coulomb friction with a delay and white noise, in runs that reverse often."""
    random = np.random.default_rng(seed)
    time = np.arange(0.0, duration_s, STEP_S)
    runs = []
    for i in range(count):
        rate, phase = 1.1 + 0.37 * i, random.uniform(0.0, 6.0)

        def speed(t: Array, rate: float = rate, phase: float = phase) -> Array:
            v: Array = 0.12 * np.sin(rate * t + phase) + 0.05 * np.sin(1.618 * rate * t)
            return v

        v = speed(time - TAU_S)
        force = LAW["F_c_n"] * np.sign(v) + LAW["F_v_n_s_m"] * v
        force = force + NOISE_N * random.standard_normal(len(time))
        noisy = speed(time) + speed_noise_m_s * random.standard_normal(len(time))
        runs.append(Run.from_arrays(time, noisy, force, name=f"run {i}"))
    return runs


@cache
def solved(held: bool = False, speed_noise_m_s: float = 1e-4) -> tuple[Problem, Solution, Spread]:
    """A fit by least squares, whose delay is determined by the samples between the jumps."""
    known = {**LAW, "F_s_n": 5.0, TAU: 0.045}
    fixed = {"F_s_n": 5.0, **({TAU: TAU_S} if held else {})}
    campaign = Campaign.prepare(Rig(), delayed_runs(3, 2, 12.0, speed_noise_m_s))
    problem = Problem(campaign, "coulomb", "journal", DELAY, fixed)
    start = problem.starts({n: known[n] for n in problem.names})[0]
    near = settle(problem, problem.solution(start, problem.samples_at(start), WHITE, False))
    return problem, near, spread(problem, near)


def test_delay_error_from_jumps_is_below_six_percent_of_a_sampling_step() -> None:
    problem, solution, errors = solved()
    found = exact_delay(problem, solution, errors, solution.values)
    assert found is not None
    assert abs(found.values[problem.names.index(TAU)] - TAU_S) < 4.0 * found.sd_s
    assert found.sd_s < min(
        0.06 * STEP_S, errors.error(problem.open.index(problem.names.index(TAU)))
    )
    residual = np.concatenate(found.residuals)
    assert np.sqrt(np.mean(residual**2)) == pytest.approx(NOISE_N, rel=0.1)


def test_other_parameters_are_refitted_as_the_delay_changes() -> None:
    """At nearly constant acceleration a delay has the effect of slightly lower dry friction.

    At a given delay Coulomb's parameters are a linear regression, solved here. Without a jump the
    error of the delay is that of least squares.
    """
    t, tau_s, runs = np.arange(0.0, 20.01, STEP_S), 0.03, []

    def speed(i: int, delay_s: float) -> Array:
        at = t - delay_s
        v: Array = 0.05 + 0.02 * at + 0.02 * np.sin((0.5 + 0.1 * i) * at)
        return v

    random = np.random.default_rng(3)
    for i in range(2):
        force = LAW["F_c_n"] + LAW["F_v_n_s_m"] * speed(i, tau_s)
        noise = 0.005 * random.standard_normal(len(t))
        runs.append(Run.from_arrays(t, speed(i, 0.0), force + noise, name=f"{i}"))
    problem, solution = fitted(Campaign.prepare(Rig(), runs), DELAY)

    def regression(delay_s: float) -> Array:
        # Without the first samples, whose force acted before the recorded motion begins.
        v = np.concatenate([speed(i, delay_s)[5:] for i in (0, 1)])
        x = np.column_stack([np.ones(len(v)), v])
        y = np.concatenate([p.friction_n[5:] for p in problem.campaign.prepared])
        found: Array = np.linalg.lstsq(x, y, rcond=None)[0]
        return found

    slope = (regression(tau_s + 1e-3) - regression(tau_s - 1e-3)) / 2e-3
    errors, which = spread(problem, solution), problem.names.index(TAU)
    start = solution.values.copy()
    start[which] += 2e-3
    found = exact_delay(problem, solution, errors, start)
    assert found is not None
    change = found.values - start
    assert change[which] == pytest.approx(-2e-3, rel=0.05)
    for name, expected in zip(("F_c_n", "F_v_n_s_m"), slope, strict=True):
        i = problem.names.index(name)
        assert change[i] == pytest.approx(expected * change[which], rel=0.03), name
    assert found.sd_s == pytest.approx(errors.error(problem.open.index(which)), rel=0.05)


def test_delay_and_its_error_are_moments_of_a_mixture_likelihood() -> None:
    """Each sample near a jump was read on one side of it or the other; brute force on a fine grid.

    Minus twice the log likelihood: squares clipped at 5 standard deviations away from the jumps,
    `-2 log((1 - p) exp(-r0^2 / 2) + p exp(-r1^2 / 2))` next to them.
    """
    problem, solution, errors = solved(speed_noise_m_s=1e-3)
    dry, viscous = (value(problem, solution, n) for n in ("F_c_n", "F_v_n_s_m"))
    noise_n = solution.rms_n
    counted = [r * c for r, c in zip(solution.residuals, solution.samples.counted, strict=True)]
    share = independent_share(counted, solution.samples.steps_s)

    def cost(tau_s: float) -> float:
        total = 0.0
        for p in problem.campaign.prepared:
            t = p.run.time_s
            turns = reversals(t, p.motion)
            read = np.maximum(t - tau_s, t[0])
            nearest = np.argmin(np.abs(read[:, None] - turns.at_s[None, :]), axis=1)
            gone = read - turns.at_s[nearest]
            v = p.motion.at(t, read).velocity_m_s
            after = np.where(gone > 0.0, np.sign(v), -np.sign(v))
            far = np.abs(gone) > 0.1
            after = np.where(far, np.sign(v), after)
            before = np.where(far, after, -after)
            squares = [
                np.minimum(((p.friction_n - dry * s - viscous * v) / noise_n) ** 2, 25.0)
                for s in (before, after)
            ]
            over = np.where(far, 1.0, norm.cdf(gone / turns.sd_s[nearest]))
            doubt = np.minimum(over, 1.0 - over) > 0.5 * np.exp(-0.5 * 3.5**2)
            with np.errstate(divide="ignore"):
                mixed = (1.0 - over) * np.exp(-0.5 * squares[0]) + over * np.exp(-0.5 * squares[1])
                mixture = -2.0 * np.log(mixed)
            sure = share * np.where(over > 0.5, squares[1], squares[0])
            total += float(np.sum(np.where(doubt, mixture, sure)))
        return total

    delays = np.linspace(TAU_S - 6e-3, TAU_S + 6e-3, 241)
    costs = np.array([cost(d) for d in delays])
    likelihood = np.exp(-0.5 * (costs - costs.min()))
    likelihood /= likelihood.sum()
    mean = float(np.sum(likelihood * delays))
    sd = float(np.sqrt(np.sum(likelihood * (delays - mean) ** 2)))
    found = exact_delay(problem, solution, errors, solution.values)
    assert found is not None
    assert found.values[problem.names.index(TAU)] == pytest.approx(mean, abs=0.1 * sd)
    assert found.sd_s == pytest.approx(sd, rel=0.05)


def test_no_delay_from_jumps_if_the_parameter_is_fixed_undetermined_or_too_small() -> None:
    problem, solution, errors = solved()
    which = problem.names.index(TAU)
    k = problem.open.index(which)
    still, endless = errors.moved.copy(), errors.sd.copy()
    still[k], endless[k] = False, np.inf
    for changed in (replace(errors, moved=still), replace(errors, sd=endless)):
        assert exact_delay(problem, solution, changed, solution.values) is None
    held = solved(held=True)
    assert exact_delay(*held, held[1].values) is None
    for steps, there in ((0.98 * LEAST_STEPS, False), (1.02 * LEAST_STEPS, True)):
        values = solution.values.copy()
        values[which] = steps * STEP_S
        assert (exact_delay(problem, solution, errors, values) is not None) == there


@pytest.mark.parametrize("seed", [0, *(pytest.param(s, marks=EXTENDED) for s in (1, 2, 3))])
def test_fit_recovers_the_delay_within_its_error_and_leaves_an_rms_equal_to_the_noise(
    seed: int,
) -> None:
    runs = delayed_runs(seed)
    found = fit(Rig(), runs, ["time_delay"], law="coulomb")
    tau = found.parameters[TAU]
    assert tau.stderr is not None
    assert tau.stderr < 0.05 * STEP_S
    assert abs(tau.value - TAU_S) < 4.0 * tau.stderr
    assert found.rms_n == pytest.approx(NOISE_N, rel=0.05)
    # One sample on the wrong side of a reversal among 4,000 would make the RMS 1.3 times as large.
    fresh = delayed_runs(seed + 100)
    errors = [(r.friction_n - found.model.predict(r))[r.time_s > TAU_S] for r in fresh]
    assert np.sqrt(np.mean(np.concatenate(errors) ** 2)) < 1.15 * NOISE_N
    again = np.concatenate([r.friction_n - found.model.predict(r) for r in runs])
    np.testing.assert_allclose(np.concatenate(found.residuals), again, atol=1e-9)
    compared = compare(found.model, runs)
    assert compared.rms_n == pytest.approx(NOISE_N, rel=0.05)
