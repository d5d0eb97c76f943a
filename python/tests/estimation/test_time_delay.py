"""Predictions of a force that is recorded with a delay, against Coulomb's law shifted in time."""

from __future__ import annotations

import numpy as np
import pytest
from by_hand import LAW, Array
from jbf import Model, ParameterValue, Rig, Run
from jbf.models.driven_motion import reversals
from jbf.models.late_reading import TAU, LateChain
from jbf.records.motion.imposed import ImposedMotion
from scipy.stats import norm

STEP_S = 0.02
TIME = np.arange(0.0, 12.0, STEP_S)
RATE = 1.7
VALUES = {**LAW, "F_s_n": LAW["F_c_n"]}


def delayed_model(tau_s: float, stderr: float | None = None) -> Model:
    """Coulomb's law recorded with a delay."""
    tau = ParameterValue(tau_s, stderr)
    return Model(Rig(), law="coulomb", effects=["time_delay"], parameters={**VALUES, TAU: tau})


def friction(v: Array) -> Array:
    """Coulomb and viscous friction, N."""
    force: Array = LAW["F_c_n"] * np.sign(v) + LAW["F_v_n_s_m"] * v
    return force


def sine_run() -> Run:
    """A sine of 0.1 m/s."""
    return Run.from_arrays(TIME, 0.1 * np.sin(RATE * TIME + 0.3))


def known_motion(time: Array, velocity: Array, acceleration: Array, error: float) -> ImposedMotion:
    """A motion with a given standard error of the speed."""
    rest = velocity == 0.0
    path = np.concatenate(([0.0], np.cumsum(velocity[1:] * np.diff(time))))
    return ImposedMotion(velocity, acceleration, path, np.full(len(time), error), rest, ~rest)


@pytest.mark.parametrize("tau_s", [0.033, 0.151])
def test_delayed_force_jumps_within_one_sample_at_reversals(tau_s: float) -> None:
    """No sample lies between the two levels of the jump."""
    late = friction(0.1 * np.sin(RATE * (TIME - tau_s) + 0.3))
    jumps = (np.pi * np.arange(1, 8) - 0.3) / RATE + tau_s
    near = np.min(np.abs(TIME[:, None] - jumps[None, :]), axis=1) < 1e-3
    settled = (3.0 * tau_s < TIME) & ~near
    error = np.abs(delayed_model(tau_s).predict(sine_run()) - late)[settled]
    assert np.count_nonzero(np.diff(np.sign(late))) >= 6
    assert np.max(error) < 0.02 * LAW["F_c_n"]


@pytest.mark.parametrize("begins_s", [2.004, 2.0101, 2.0163])
def test_delayed_force_at_a_start_between_samples_follows_from_the_acceleration(
    begins_s: float,
) -> None:
    tau_s = 0.033
    run = Run.from_arrays(TIME, 0.02 * np.maximum(TIME - begins_s, 0.0))
    late = friction(0.02 * np.maximum(TIME - tau_s - begins_s, 0.0))
    error = np.abs(delayed_model(tau_s).predict(run) - late)
    assert np.max(error) < 0.02 * LAW["F_c_n"]


def test_zero_delay_does_not_change_the_prediction() -> None:
    plain = Model(Rig(), law="coulomb", parameters=VALUES).predict(sine_run())
    np.testing.assert_array_equal(plain, delayed_model(0.0).predict(sine_run()))


def test_sensor_drift_is_not_delayed() -> None:
    """The drift is added after the delay: `F(t - tau) + d t`."""
    run = Run.from_arrays(TIME, np.full(len(TIME), 0.1))
    model = Model(
        Rig(),
        law="coulomb",
        effects=["time_delay", "sensor_drift"],
        parameters={**VALUES, TAU: 0.3, "sensor_drift.d_n_s": 2.0},
    )
    late = TIME > 0.3 + STEP_S
    expected = friction(np.full(len(TIME), 0.1)) + 2.0 * TIME
    np.testing.assert_allclose(model.predict(run)[late], expected[late], rtol=1e-9)


def test_mean_force_near_a_reversal_is_blurred_by_the_errors_of_instant_and_delay() -> None:
    """`F_c (2 Phi(t / sd) - 1)`, sd the root of both variances."""
    time = np.arange(0.0, 2.0, STEP_S)
    tau_s, turn_s, slope, error, delay_sd_s = 0.0471, 1.0071, 0.1, 2e-4, 3e-3
    v = slope * (time - turn_s)
    motion = known_motion(time, v, np.full(len(time), slope), error)
    run = Run.from_arrays(time, v, np.zeros(len(time)))
    model = delayed_model(tau_s)
    chain = LateChain(Rig(), "coulomb", "journal", model.effects, list(model.parameters))
    reading = chain.read(model.values, run, time, motion, delay_sd_s)
    gone_s = time - tau_s - turn_s
    sd_s = np.hypot(error / slope, delay_sd_s)
    expected = LAW["F_c_n"] * (2.0 * norm.cdf(gone_s / sd_s) - 1.0)
    expected += LAW["F_v_n_s_m"] * slope * gone_s
    settled = time > tau_s + STEP_S
    np.testing.assert_allclose(reading.mean_n[settled], expected[settled], atol=0.02)
    jump = reading.after_n - reading.before_n
    np.testing.assert_allclose(jump[settled], 2.0 * LAW["F_c_n"], rtol=0.01)


@pytest.mark.parametrize("begins_s", [0.5002, 0.5191])
@pytest.mark.parametrize("way", [1.0, -1.0], ids=["start", "stop"])
def test_start_and_stop_between_samples_are_interpolated_by_the_acceleration(
    begins_s: float, way: float
) -> None:
    time = np.arange(0.0, 1.0, STEP_S)
    there = np.arange(0.4, 0.6, 1e-3)

    def speed(t: Array) -> Array:
        v: Array = 0.3 * np.maximum(way * (t - begins_s), 0.0)
        return v

    v = speed(time)
    motion = known_motion(time, v, np.where(v > 0.0, 0.3 * way, 0.0), 1e-4)
    interpolated = motion.at(time, there)
    np.testing.assert_allclose(interpolated.velocity_m_s, speed(there), atol=1e-12)
    np.testing.assert_array_equal(interpolated.resting, speed(there) == 0.0)
    # The instant does not depend on the samples around it.
    (turn_s,) = reversals(there + 0.4e-3, motion.at(time, there + 0.4e-3)).at_s
    assert turn_s == pytest.approx(begins_s, abs=1e-9)
