"""The effect of a time delay: its predictions, and its estimate from the jumps at reversals.

Predictions are compared with Coulomb's law shifted in time; the error of an estimate is far below a
sampling step.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from by_hand import LAW, Array, coulomb
from delayed_runs import DELAY, fitted, value
from jbf import Model, ParameterValue, Rig, Run, compare, fit
from jbf.estimation.campaign import Campaign
from jbf.estimation.delay_scan import LEAST_STEPS, exact_delay
from jbf.estimation.likelihood import independent_share
from jbf.estimation.minimum import settle
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from jbf.estimation.standard_errors import StandardErrors, standard_errors
from jbf.models.delayed_reading import TAU, DelayedChain
from jbf.models.driven_motion import reversals
from jbf.records.motion.estimated_motion import EstimatedMotion
from scipy.stats import norm

STEP_S, TAU_S, NOISE_N = 0.02, 0.0471, 0.2
EXTENDED = pytest.mark.extended


def delayed_runs(
    seed: int, count: int = 4, duration_s: float = 20.0, speed_noise_m_s: float = 1e-4
) -> list[Run]:
    """Coulomb friction with a delay and white noise, in runs with many reversals."""
    random = np.random.default_rng(seed)
    time = np.arange(0.0, duration_s, STEP_S)
    runs = []
    for i in range(count):
        rate, phase = 1.1 + 0.37 * i, random.uniform(0.0, 6.0)

        v, delayed_v = (
            0.12 * np.sin(rate * t + phase) + 0.05 * np.sin(1.618 * rate * t)
            for t in (time, time - TAU_S)
        )
        force = coulomb(time, delayed_v, v) + NOISE_N * random.standard_normal(len(time))
        noisy = v + speed_noise_m_s * random.standard_normal(len(time))
        runs.append(Run.from_arrays(time, noisy, force, name=f"run {i}"))
    return runs


def rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


@cache
def solved(
    held: bool = False, speed_noise_m_s: float = 1e-4
) -> tuple[Problem, Solution, StandardErrors]:
    """Least-squares fit whose delay is determined by the samples between the jumps."""
    known = {**LAW, "F_s": 5.0, TAU: 0.045}
    fixed = {"F_s": 5.0, **({TAU: TAU_S} if held else {})}
    campaign = Campaign.prepare(Rig(), delayed_runs(3, 2, 12.0, speed_noise_m_s))
    problem = Problem(campaign, "coulomb", "journal", DELAY, fixed)
    start = problem.starts({n: known[n] for n in problem.names})[0]
    near = settle(problem, problem.solution(start, problem.samples_at(start), WHITE, False))
    return problem, near, standard_errors(problem, near)


def test_delay_error_from_jumps_is_below_six_percent_of_a_sampling_step() -> None:
    problem, solution, errors = solved()
    found = exact_delay(problem, solution, errors, solution.values)
    assert abs(found.values[problem.names.index(TAU)] - TAU_S) < 4.0 * found.sd_s
    which = problem.open.index(problem.names.index(TAU))
    assert found.sd_s < min(0.06 * STEP_S, errors.error(which))
    assert rms(np.concatenate(found.residuals)) == pytest.approx(NOISE_N, rel=0.1)


def test_law_parameters_follow_a_change_of_delay_as_in_a_regression() -> None:
    """At nearly constant acceleration a delay has the effect of slightly lower dry friction.

    At a given delay Coulomb's parameters are a linear regression, solved here. Without a jump the
    error of the delay is that of least squares.
    """
    t, tau_s, runs = np.arange(0.0, 20.01, STEP_S), 0.03, []

    def speed(i: int, delay_s: float) -> Array:
        return 0.05 + 0.02 * (t - delay_s) + 0.02 * np.sin((0.5 + 0.1 * i) * (t - delay_s))

    random = np.random.default_rng(3)
    for i in range(2):
        v = speed(i, tau_s)
        force = coulomb(t, v, v) + 0.005 * random.standard_normal(len(t))
        runs.append(Run.from_arrays(t, speed(i, 0.0), force, name=f"{i}"))
    problem, solution = fitted(Campaign.prepare(Rig(), runs), DELAY)

    def regression(delay_s: float) -> Array:
        # Exclude the first samples, whose force acted before the recorded motion begins.
        v = np.concatenate([speed(i, delay_s)[5:] for i in (0, 1)])
        x = np.column_stack([np.ones(len(v)), v])
        y = np.concatenate([p.friction[5:] for p in problem.campaign.prepared])
        return np.linalg.lstsq(x, y, rcond=None)[0]

    slope = (regression(tau_s + 1e-3) - regression(tau_s - 1e-3)) / 2e-3
    errors, which = standard_errors(problem, solution), problem.names.index(TAU)
    start = solution.values.copy()
    start[which] += 2e-3
    found = exact_delay(problem, solution, errors, start)
    change = found.values - start
    assert change[which] == pytest.approx(-2e-3, rel=0.05)
    for name, expected in zip(("F_c", "F_v"), slope, strict=True):
        i = problem.names.index(name)
        assert change[i] == pytest.approx(expected * change[which], rel=0.03), name
    assert found.sd_s == pytest.approx(errors.error(problem.open.index(which)), rel=0.05)


def test_delay_from_jumps_and_its_error_are_moments_of_a_mixture_likelihood() -> None:
    """Each sample near a jump was read on one side of it or the other; brute force on a fine grid.

    Minus twice the log likelihood: squares clipped at 5 standard deviations away from the jumps,
    `-2 log((1 - p) exp(-r0^2 / 2) + p exp(-r1^2 / 2))` next to them.
    """
    problem, solution, errors = solved(speed_noise_m_s=1e-3)
    dry, viscous = (value(problem, solution, n) for n in ("F_c", "F_v"))
    noise_rms = solution.rms
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
            v = p.motion.at(t, read).velocity
            after = np.where(gone > 0.0, np.sign(v), -np.sign(v))
            far = np.abs(gone) > 0.1
            after = np.where(far, np.sign(v), after)
            before = np.where(far, after, -after)
            errors = (p.friction - dry * sign - viscous * v for sign in (before, after))
            squares = [np.minimum((error / noise_rms) ** 2, 25.0) for error in errors]
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
    assert found.values[problem.names.index(TAU)] == pytest.approx(mean, abs=0.1 * sd)
    assert found.sd_s == pytest.approx(sd, rel=0.05)


def test_no_delay_is_estimated_from_jumps_if_it_is_fixed_unidentifiable_or_too_small() -> None:
    problem, solution, errors = solved()
    which = problem.names.index(TAU)
    k = problem.open.index(which)
    still, endless = errors.sensitive.copy(), errors.sd.copy()
    still[k], endless[k] = False, np.inf
    for changed in (replace(errors, sensitive=still), replace(errors, sd=endless)):
        assert exact_delay(problem, solution, changed, solution.values) is None
    held = solved(held=True)
    assert exact_delay(*held, held[1].values) is None
    for steps, there in ((0.98 * LEAST_STEPS, False), (1.02 * LEAST_STEPS, True)):
        values = solution.values.copy()
        values[which] = steps * STEP_S
        assert (exact_delay(problem, solution, errors, values) is not None) == there


@pytest.mark.parametrize("seed", [0, *(pytest.param(s, marks=EXTENDED) for s in (1, 2, 3))])
def test_fitted_delay_is_within_its_error_and_the_rms_equals_the_noise(seed: int) -> None:
    runs = delayed_runs(seed)
    found = fit(Rig(), runs, ["time_delay"], law="coulomb")
    tau = found.parameters[TAU]
    assert tau.stderr < 0.05 * STEP_S
    assert abs(tau.value - TAU_S) < 4.0 * tau.stderr
    assert found.rms == pytest.approx(NOISE_N, rel=0.05)
    # One of 4,000 samples on the wrong side of a reversal would multiply the RMS by 1.3.
    fresh = delayed_runs(seed + 100)
    errors = [(r.friction - found.model.predict(r))[r.time_s > TAU_S] for r in fresh]
    assert rms(np.concatenate(errors)) < 1.15 * NOISE_N
    # A prediction estimates the motion of a run again, without the other runs.
    again = np.concatenate([r.friction - found.model.predict(r) for r in runs])
    change = np.concatenate(found.residuals) - again
    assert rms(change) < 0.01 * NOISE_N
    assert np.max(np.abs(change)) < 0.2 * NOISE_N
    assert compare(found.model, runs).rms == pytest.approx(NOISE_N, rel=0.05)


TIME = np.arange(0.0, 12.0, STEP_S)
RATE = 1.7
VALUES = {**LAW, "F_s": LAW["F_c"]}


def delayed_model(tau_s: float, stderr: float | None = None) -> Model:
    tau = ParameterValue(tau_s, stderr)
    return Model(Rig(), law="coulomb", effects=["time_delay"], parameters={**VALUES, TAU: tau})


def friction(v: Array) -> Array:
    return LAW["F_c"] * np.sign(v) + LAW["F_v"] * v


def known_motion(
    time: Array, velocity: Array, acceleration: Array, error: float
) -> EstimatedMotion:
    rest = velocity == 0.0
    path = np.concatenate(([0.0], np.cumsum(velocity[1:] * np.diff(time))))
    return EstimatedMotion(velocity, acceleration, path, np.full(len(time), error), rest, ~rest)


@pytest.mark.parametrize("tau_s", [0.033, 0.151])
def test_delayed_force_jumps_within_one_sample_at_reversals(tau_s: float) -> None:
    late = friction(0.1 * np.sin(RATE * (TIME - tau_s) + 0.3))
    jumps = (np.pi * np.arange(1, 8) - 0.3) / RATE + tau_s
    near = np.min(np.abs(TIME[:, None] - jumps[None, :]), axis=1) < 1e-3
    settled = (3.0 * tau_s < TIME) & ~near
    run = Run.from_arrays(TIME, 0.1 * np.sin(RATE * TIME + 0.3))
    error = np.abs(delayed_model(tau_s).predict(run) - late)[settled]
    assert np.count_nonzero(np.diff(np.sign(late))) >= 6
    assert np.max(error) < 0.02 * LAW["F_c"]


@pytest.mark.parametrize("begins_s", [2.004, 2.0101, 2.0163])
def test_force_of_a_motion_that_starts_between_samples_is_delayed_within_two_percent(
    begins_s: float,
) -> None:
    tau_s = 0.033
    run = Run.from_arrays(TIME, 0.02 * np.maximum(TIME - begins_s, 0.0))
    late = friction(0.02 * np.maximum(TIME - tau_s - begins_s, 0.0))
    error = np.abs(delayed_model(tau_s).predict(run) - late)
    assert np.max(error) < 0.02 * LAW["F_c"]


def test_sensor_drift_is_not_delayed_in_a_model_with_a_time_delay() -> None:
    run = Run.from_arrays(TIME, np.full(len(TIME), 0.1))
    values = {**VALUES, TAU: 0.3, "sensor_drift.d": 2.0}
    model = Model(Rig(), "coulomb", ["time_delay", "sensor_drift"], values)
    late = TIME > 0.3 + STEP_S
    expected = friction(np.full(len(TIME), 0.1)) + 2.0 * TIME
    np.testing.assert_allclose(model.predict(run)[late], expected[late], rtol=1e-9)


def test_expected_force_near_a_reversal_is_smoothed_by_the_errors_of_time_and_delay() -> None:
    """`F_c (2 Phi(t / sd) - 1)`, where sd is the root of the sum of both variances."""
    time = np.arange(0.0, 2.0, STEP_S)
    tau_s, turn_s, slope, error, delay_sd_s = 0.0471, 1.0071, 0.1, 2e-4, 3e-3
    v = slope * (time - turn_s)
    motion = known_motion(time, v, np.full(len(time), slope), error)
    run = Run.from_arrays(time, v, np.zeros(len(time)))
    model = delayed_model(tau_s)
    chain = DelayedChain(Rig(), "coulomb", "journal", model.effects, list(model.parameters))
    reading = chain.read(model.values, run, time, motion, delay_sd_s)
    gone_s = time - tau_s - turn_s
    sd_s = np.hypot(error / slope, delay_sd_s)
    expected = LAW["F_c"] * (2.0 * norm.cdf(gone_s / sd_s) - 1.0)
    expected += LAW["F_v"] * slope * gone_s
    settled = time > tau_s + STEP_S
    np.testing.assert_allclose(reading.mean_n[settled], expected[settled], atol=0.02)
    jump = reading.after_n - reading.before_n
    np.testing.assert_allclose(jump[settled], 2.0 * LAW["F_c"], rtol=0.01)


@pytest.mark.parametrize("begins_s", [0.5002, 0.5191])
@pytest.mark.parametrize("way", [1.0, -1.0], ids=["start", "stop"])
def test_start_or_stop_between_samples_follows_acceleration(begins_s: float, way: float) -> None:
    time = np.arange(0.0, 1.0, STEP_S)
    there = np.arange(0.4, 0.6, 1e-3)

    def speed(t: Array) -> Array:
        return 0.3 * np.maximum(way * (t - begins_s), 0.0)

    v = speed(time)
    motion = known_motion(time, v, np.where(v > 0.0, 0.3 * way, 0.0), 1e-4)
    interpolated = motion.at(time, there)
    np.testing.assert_allclose(interpolated.velocity, speed(there), atol=1e-12)
    np.testing.assert_array_equal(interpolated.resting, speed(there) == 0.0)
    # The instant is independent of the samples around it.
    (turn_s,) = reversals(there + 0.4e-3, motion.at(time, there + 0.4e-3)).at_s
    assert turn_s == pytest.approx(begins_s, abs=1e-9)
