"""A force that is recorded late, read in the chain at the instant at which it acted: closed forms,
and delays that jumps tell to a share of a sample."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from by_hand import LAW, Array
from jbf import Model, ParameterValue, Rig, Run, compare, fit
from jbf.diagnosis.candidates import Candidates
from jbf.estimation.campaign import Campaign
from jbf.models.driven_motion import reversals
from jbf.models.late_reading import TAU, LateChain
from jbf.records.motion.imposed import ImposedMotion
from scipy.stats import norm

STEP_S = 0.02
TAU_S = 0.0471
NOISE_N = 0.2
LATE = Model(Rig(), "coulomb", ["time_delay"], {**LAW, "F_s_n": LAW["F_c_n"], TAU: TAU_S})


def moving(time: Array, velocity: Array, acceleration: Array, error: float) -> ImposedMotion:
    """A motion of which everything is known."""
    rest = velocity == 0.0
    angle = np.concatenate(([0.0], np.cumsum(velocity[1:] * np.diff(time))))
    errors = np.full(len(time), error)
    return ImposedMotion(velocity, acceleration, angle, errors, rest, ~rest)


def coulomb(v: Array) -> Array:
    """Friction of the law, N."""
    found: Array = LAW["F_c_n"] * np.sign(v) + LAW["F_v_n_s_m"] * v
    return found


def test_close_to_a_reversal_the_mean_of_both_sides_is_expected() -> None:
    time = np.arange(0.0, 2.0, STEP_S)
    turn, slope, error = 1.0071, 0.1, 2e-4
    v = slope * (time - turn)
    motion = moving(time, v, np.full(len(time), slope), error)
    run = Run.from_arrays(time, v, np.zeros(len(time)))
    chain = LateChain(Rig(), "coulomb", "journal", LATE.effects, list(LATE.parameters))
    # The error of the delay and that of the reversal's instant blur the jump together.
    sd = np.hypot(error / slope, 3e-3)
    reading = chain.read(LATE.values, run, time, motion, 3e-3)
    gone = time - TAU_S - turn
    expected = LAW["F_c_n"] * (2.0 * norm.cdf(gone / sd) - 1.0) + LAW["F_v_n_s_m"] * slope * gone
    settled = time > TAU_S + STEP_S
    np.testing.assert_allclose(reading.mean_n[settled], expected[settled], atol=0.02)
    both = reading.after_n - reading.before_n
    np.testing.assert_allclose(both[settled], 2.0 * LAW["F_c_n"], rtol=0.01)


def test_the_drift_of_a_cell_keeps_its_own_clock() -> None:
    time = np.arange(0.0, 2.0, STEP_S)
    run = Run.from_arrays(time, np.full(len(time), 0.1))
    model = Model(
        Rig(),
        law="coulomb",
        effects=["time_delay", "sensor_drift"],
        parameters={**LAW, "F_s_n": LAW["F_c_n"], TAU: 0.3, "sensor_drift.d_n_s": 2.0},
    )
    late = time > 0.3 + STEP_S
    expected = coulomb(np.full(len(time), 0.1)) + 2.0 * time
    np.testing.assert_allclose(model.predict(run)[late], expected[late], rtol=1e-9)


@pytest.mark.parametrize("begins", [0.5002, 0.507, 0.5191])
def test_between_samples_a_motion_sets_in_and_ends_where_its_acceleration_says(
    begins: float,
) -> None:
    time = np.arange(0.0, 1.0, STEP_S)
    there = np.arange(0.4, 0.6, 1e-3)
    for way, v_at in (
        (1.0, lambda t: 0.3 * np.maximum(t - begins, 0.0)),
        (-1.0, lambda t: 0.3 * np.maximum(begins - t, 0.0)),
    ):
        v = v_at(time)
        motion = moving(time, v, np.where(v > 0.0, 0.3 * way, 0.0), 1e-4)
        moved = motion.at(time, there)
        np.testing.assert_allclose(moved.velocity_m_s, v_at(there), atol=1e-12)
        np.testing.assert_array_equal(moved.resting, v_at(there) == 0.0)
        # The same instant, whichever samples lie round it.
        (turn,) = reversals(there + 0.4e-3, motion.at(time, there + 0.4e-3)).at_s
        assert turn == pytest.approx(begins, abs=1e-9)


def late_runs(seed: int, count: int = 4) -> list[Run]:
    """Friction as it was so long before, and noise."""
    random = np.random.default_rng(seed)
    time = np.arange(0.0, 20.0, STEP_S)
    runs = []
    for i in range(count):
        rate, phase = 1.1 + 0.37 * i, random.uniform(0.0, 6.0)

        def speed(t: Array, rate: float = rate, phase: float = phase) -> Array:
            v: Array = 0.12 * np.sin(rate * t + phase) + 0.05 * np.sin(1.618 * rate * t)
            return v

        force = coulomb(speed(time - TAU_S)) + NOISE_N * random.standard_normal(len(time))
        noisy = speed(time) + 1e-4 * random.standard_normal(len(time))
        runs.append(Run.from_arrays(time, noisy, force, name=f"run {i}"))
    return runs


@pytest.mark.parametrize("seed", range(4))
def test_jumps_tell_a_delay_to_a_share_of_a_sample(seed: int) -> None:
    found = fit(Rig(), late_runs(seed), ["time_delay"], law="coulomb")
    tau = found.parameters[TAU]
    assert tau.stderr is not None
    assert tau.stderr < 0.05 * STEP_S
    assert abs(tau.value - TAU_S) < 4.0 * tau.stderr
    # What is left of the fit, and of runs that it has not seen, is the noise.
    assert found.rms_n == pytest.approx(NOISE_N, rel=0.05)
    left = [r.friction_n - found.model.predict(r) for r in late_runs(seed + 100)]
    sure = np.concatenate(left)[np.concatenate([r.time_s > TAU_S for r in late_runs(seed + 100)])]
    # One sample on the wrong side of one reversal in 4,000 would make it 1.3 times as much.
    assert np.sqrt(np.mean(sure**2)) < 1.15 * NOISE_N
    residuals = np.concatenate(found.residuals)
    again = np.concatenate([r.friction_n - found.model.predict(r) for r in late_runs(seed)])
    np.testing.assert_allclose(residuals, again, atol=1e-9)


def test_a_delay_that_is_held_stays_where_it_is() -> None:
    held = fit(Rig(), late_runs(0), ["time_delay"], law="coulomb", fixed={TAU: 0.05})
    assert held.parameters[TAU].value == 0.05


def test_a_delay_that_is_less_sure_predicts_less_of_a_jump() -> None:
    run = late_runs(1, 1)[0]
    sharp, unsure = (
        replace(LATE, parameters={**LATE.parameters, TAU: ParameterValue(TAU_S, error)})
        for error in (1e-5, 5e-3)
    )
    apart = np.abs(sharp.predict(run) - unsure.predict(run))
    turns = reversals(run.time_s, moving(run.time_s, run.velocity_m_s, np.zeros(len(run)), 0.0))
    near = np.min(np.abs(run.time_s[:, None] - TAU_S - turns.at_s[None, :]), axis=1)
    assert np.max(apart[near > 0.05]) < 1e-9
    assert np.max(apart[near < 3e-3]) > 0.2 * LAW["F_c_n"]


def test_beside_a_delay_the_score_of_another_effect_is_of_the_samples_that_count() -> None:
    candidates = Candidates(Campaign.prepare(Rig(), late_runs(2)), "coulomb", "journal")
    near = candidates.converge(["time_delay"])
    assert near.samples.count < candidates.campaign.samples.count
    # The ramps beside the jumps seem to ask for a lag, and would for anything.
    for name in ("sensor_offset", "sensor_drift", "quadratic_drag"):
        assert candidates.score_test(["time_delay", name], near) < 12.0


def test_a_comparison_is_of_what_the_model_predicts() -> None:
    found = fit(Rig(), late_runs(3), ["time_delay"], law="coulomb")
    beside = compare(found.model, late_runs(3))
    for prediction, own in zip(
        beside.predictions, found.model.predict_many(late_runs(3)), strict=True
    ):
        np.testing.assert_allclose(prediction, own, atol=1e-9)
    assert beside.rms_n == pytest.approx(NOISE_N, rel=0.05)
