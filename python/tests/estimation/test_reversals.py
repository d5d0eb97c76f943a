"""Error of a prediction after a reversal whose instant is as uncertain as the speed.

The standard error of the instant is that of the speed over the acceleration; the prediction is off
by its rate of change times that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from by_hand import Array
from campaigns import campaign
from jbf import Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.prepared import Prepared
from jbf.estimation.problem import Problem
from jbf.estimation.reversals import instant_errors_n
from jbf.records.motion.imposed import ImposedMotion
from rigsim.motions import sine

STEP_S = 0.1
SLOW = (sine("slow", 160.0, 0.02, 0.05),)


def prepared(
    velocity: Sequence[float], *, error: float | Array = 1e-3, unknown: Sequence[int] = ()
) -> Prepared:
    """A run with a given motion; `unknown` are samples at which its sign is not known."""
    v = np.array(velocity)
    n = len(v)
    long = np.where(np.arange(200) < 100, 0.2, -0.2)
    run = Run.from_arrays(STEP_S * np.arange(200), long, 5.0 * np.sign(long) + 0.01 * np.cos(long))
    made = Prepared.of(Rig(), run)
    rest = v == 0.0
    known = ~rest & ~np.isin(np.arange(n), unknown)
    errors = np.broadcast_to(np.asarray(error, dtype=float), (n,)).copy()
    motion = ImposedMotion(v, np.zeros(n), STEP_S * np.cumsum(v), errors, rest, known)
    short = made.run.select(np.arange(200) < n)
    return replace(made, run=short, motion=motion, friction_n=made.friction_n[:n])


def step_behind(n: int, turn: int, rate_n_s: float, memory: int) -> Array:
    """A prediction that changes at a rate for some samples after a reversal."""
    slope = np.zeros(n)
    slope[turn : turn + memory] = rate_n_s
    found: Array = np.concatenate(([0.0], np.cumsum(slope[:-1] * STEP_S)))
    return found


def ramp(p: Prepared, rate_n_s: float = 10.0) -> Array:
    """A prediction that changes at a constant rate."""
    return rate_n_s * np.asarray(p.run.time_s)


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_error_after_a_reversal_is_rate_of_change_times_error_of_the_instant(unit: float) -> None:
    """2 mm/s at 2 m/s^2 are 1 ms: 0.05 N at 50 N/s, until it falls below the least size."""
    p = prepared([0.2] * 3 + [0.1, -0.1] + [-0.2] * 11, error=2e-3)
    prediction = unit * step_behind(16, 3, 50.0, 6)
    rate = np.abs(np.gradient(prediction, p.run.time_s))
    found = instant_errors_n(p, prediction, 0.02 * unit)
    np.testing.assert_array_equal(found[:4], 0.0)
    np.testing.assert_allclose(found[4:10], 1e-3 * rate[4:10])
    assert found[5] == pytest.approx(0.05 * unit)
    np.testing.assert_array_equal(found[10:], 0.0)
    # The rate falls to half at the ninth sample.
    assert instant_errors_n(p, prediction, 0.03 * unit)[9] == 0.0


def test_error_of_the_instant_is_at_most_that_of_a_uniform_distribution_over_a_step() -> None:
    """Its error is at most that of a uniform distribution, `1 / sqrt(12)` of their distance."""
    p = prepared([0.2] * 4 + [-0.2] * 8, error=1e3)
    found = instant_errors_n(p, ramp(p), 1e-9)
    np.testing.assert_allclose(found[4:], STEP_S * 10.0 / np.sqrt(12.0), rtol=0.01)


def test_samples_of_unknown_sign_belong_to_the_reversal() -> None:
    """The slope is that between the known samples, the error the largest among them."""
    error = np.array([9.0, 1e-3, 5e-3, 1e-3, 2e-3, 9.0, 9.0, 9.0])
    p = prepared([0.2, 0.2, 0.1, -0.1, -0.2, -0.2, -0.2, -0.2], error=error, unknown=(2, 3))
    found = instant_errors_n(p, ramp(p), 1e-9)
    np.testing.assert_array_equal(found[:2], 0.0)
    np.testing.assert_allclose(found[2:], 10.0 * 5e-3 / (0.4 / 0.3))


def test_force_error_of_the_instant_of_a_reversal_applies_until_the_next_reversal() -> None:
    error = np.where(np.arange(11) < 6, 1e-3, 1e-4)
    p = prepared([0.2] * 3 + [-0.2] * 4 + [0.2] * 4, error=error)
    first, second = 1e-3 / 4.0 * 20.0, 1e-4 / 4.0 * 20.0
    found = instant_errors_n(p, ramp(p, 20.0), 1e-9)
    np.testing.assert_allclose(found, [0.0] * 3 + [first] * 4 + [second] * 4)
    # A rate that begins later than the reversal has no error by its instant.
    p = prepared([0.2] * 3 + [-0.2] * 8)
    late = np.maximum(ramp(p) - ramp(p)[6], 0.0)
    assert not instant_errors_n(p, late, 1e-9).any()


@pytest.mark.parametrize(
    ("velocity", "unknown", "first"),
    [
        ([1.0, 1.0, -1.0, -1.0, -1.0], (), 2),
        ([1.0, 0.1, -0.1, -1.0, -1.0], (1, 2), 1),
        # A stop between two directions is no reversal, nor is a start.
        ([1.0, 0.0, -1.0, -1.0, -1.0], (), None),
        ([0.0, 1.0, 1.0, 2.0, 2.0], (), None),
        ([1.0, 0.0, 0.0, 1.0, -1.0], (), 4),
    ],
)
def test_reversal_is_a_change_of_known_sign_without_a_rest(
    velocity: list[float], unknown: tuple[int, ...], first: int | None
) -> None:
    p = prepared(velocity, unknown=unknown)
    found = np.flatnonzero(instant_errors_n(p, ramp(p), 1e-9))
    assert (int(found[0]) if len(found) else None) == first


def test_error_is_zero_in_a_record_of_two_samples() -> None:
    two = prepared([0.2, -0.2])
    assert instant_errors_n(two, np.array([1.0, -1.0]), 0.0).tolist() == [0.0, 0.0]


# ---- simulated slow reversals --------------------------------------------------------------------


def true_model(seed: int, effects: tuple[str, ...]) -> tuple[Problem, Array, float]:
    """A campaign of slow sines, the parameters with which it was simulated, and its noise."""
    rig, runs, truth = campaign(seed, effects, motions=SLOW)
    problem = Problem(Campaign.prepare(rig, runs), "journal", "journal", effects)
    known = {name.removesuffix("_m_s"): value for name, value in truth["base"].items()}
    for effect, values in truth["effects"].items():
        known |= {f"{effect}.{name}": value for name, value in values.items()}
    names = [name.removesuffix("_m_s").removesuffix("_s") for name in problem.names]
    return problem, np.array([known[name] for name in names]), truth["noise_n"]


@pytest.mark.parametrize(
    "seeds", [range(20, 23), pytest.param(range(23, 32), marks=pytest.mark.extended)]
)
def test_errors_after_slow_reversals_are_as_large_as_predicted(seeds: range) -> None:
    """The residuals of the true model, in units of noise and predicted error."""
    doubtful, others = [], []
    for seed in seeds:
        problem, values, noise_n = true_model(seed, ("sensor_lag",))
        (p,), (prediction,) = problem.campaign.prepared, problem.predict(values)
        error_n = instant_errors_n(p, prediction, 0.5 * noise_n)
        residual = p.friction_n - prediction
        counted = p.motion.sign_known
        behind = counted & (error_n > 0.0)
        doubtful.append(residual[behind] / np.hypot(noise_n, error_n[behind]))
        others.append(residual[counted & (error_n == 0.0)] / noise_n)
        assert 0 < behind.sum() < 0.1 * counted.sum()
        assert np.max(error_n) > 2.0 * noise_n
    assert 0.4 < np.sqrt(np.mean(np.concatenate(doubtful) ** 2)) < 2.0
    assert np.sqrt(np.mean(np.concatenate(others) ** 2)) == pytest.approx(1.0, abs=0.05)
