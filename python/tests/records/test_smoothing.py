"""Smoothed motions against known motions: coverage, time stamps, delays and invariances."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from jbf.records.motion.acceleration_jumps import Jumps
from jbf.records.motion.even_clock import even_clock
from jbf.records.motion.reading_errors import is_even
from jbf.records.motion.readings import ForceReadings, ReadingErrors, Readings
from jbf.records.motion.smoothing import smooth
from known_motions import Array, quantised
from read_motions import COUNT, FINE, NOISE, STEP_S, motion_of, readings_of

KINDS = ["sine", "trapezoids", "saturated steps", "hand-guided"]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("channels", ["position and velocity", "position", "velocity"])
def test_intervals_of_two_standard_errors_cover_the_true_motion(kind: str, channels: str) -> None:
    position, velocity, acceleration = motion_of(kind)
    readings = readings_of(position, velocity)
    missing = np.full(len(position), np.nan)
    if channels == "position":
        readings = replace(readings, velocity=missing)
    if channels == "velocity":
        readings = replace(readings, position=missing)
    motion = smooth(readings)
    for column, true in ((1, velocity), (2, acceleration)):
        sd = np.sqrt(motion.covariance[:, column, column])
        off = np.abs(motion.mean[:, column] - true)
        assert np.mean(off < 2.0 * sd) > 0.92
        assert np.sqrt(np.mean(off**2)) < 1.5 * np.sqrt(np.mean(sd**2))


@pytest.mark.parametrize("kind", KINDS)
def test_smoothed_velocity_is_closer_to_the_truth_than_its_reading(kind: str) -> None:
    position, velocity, _ = motion_of(kind)
    motion = smooth(readings_of(position, velocity))
    errors = motion.errors
    assert np.std(motion.mean[:, 1] - velocity) < 0.4 * NOISE
    assert np.sqrt(errors.velocity_variance) == pytest.approx(NOISE, rel=0.1)
    assert np.sqrt(errors.position_variance) == pytest.approx(COUNT / np.sqrt(12.0), rel=0.1)


@pytest.mark.parametrize("jitter_s", [5e-5, 5e-4, 1.5e-3])
def test_jitter_of_the_stamps_of_an_even_clock_does_not_change_the_motion(jitter_s: float) -> None:
    position, velocity, acceleration = motion_of("hand-guided")
    readings = readings_of(position, velocity)
    random = np.random.default_rng(7)
    stamps = np.sort(readings.time_s + random.normal(0.0, jitter_s, len(velocity)))
    jittered = replace(readings, time_s=stamps)
    even = even_clock(stamps)
    assert even is not None
    if jitter_s > 1e-4:
        assert is_even(jittered, even)
    motion = smooth(replace(jittered, time_s=even))
    expected = smooth(readings)
    error = np.std(expected.mean[:, 2] - acceleration)
    assert np.std(motion.mean[:, 2] - acceleration) < 1.3 * error


def test_samples_off_their_even_stamps_have_errors_that_grow_with_the_speed() -> None:
    """Even stamps of uneven instants: the error of the position is speed times jitter."""
    t = np.arange(30_000) * STEP_S / FINE
    random = np.random.default_rng(9)
    instants = STEP_S * np.arange(3000) + random.normal(0.0, 2e-4, 3000)
    position = np.interp(instants, t, 10.0 * (1.0 - np.cos(1.0 * t)))
    velocity = np.interp(instants, t, 10.0 * np.sin(1.0 * t))
    errors = smooth(readings_of(position, velocity)).errors
    assert np.sqrt(errors.stamp_variance) == pytest.approx(2e-4, rel=0.1)


def test_samples_at_uneven_instants_with_true_stamps_are_not_on_an_even_clock() -> None:
    t = np.arange(30_000) * STEP_S / FINE
    random = np.random.default_rng(11)
    instants = STEP_S * np.arange(3000) + random.uniform(-1e-3, 1e-3, 3000)
    position = np.interp(instants, t, 10.0 * (1.0 - np.cos(1.0 * t)))
    readings = replace(readings_of(position, 0.0 * position), time_s=instants)
    even = even_clock(instants)
    assert even is not None
    assert not is_even(replace(readings, velocity=np.full(3000, np.nan)), even)


@pytest.mark.parametrize("loop_s", [0.0103, 0.0047])
def test_even_clock_is_recovered_from_stamps_truncated_to_milliseconds(loop_s: float) -> None:
    true = 3.0 + loop_s * np.arange(2000)
    even = even_clock(np.floor(1e3 * true) / 1e3)
    assert even is not None
    # A constant offset of the clock is irrelevant: only its steps matter.
    np.testing.assert_allclose(np.diff(even), loop_s, rtol=1e-4)


def test_even_clock_allows_missing_samples_and_refuses_a_changing_rate() -> None:
    random = np.random.default_rng(2)
    stamps = np.delete(0.01 * np.arange(500) + random.normal(0.0, 1e-4, 500), [50, 51, 300])
    even = even_clock(stamps)
    assert even is not None
    np.testing.assert_allclose(even, stamps, atol=6e-4)
    assert even_clock(np.cumsum(np.linspace(0.01, 0.02, 500))) is None
    assert even_clock(0.01 * np.arange(500)) is None


@pytest.mark.parametrize("delay", [-0.5, 0.0, 0.3, 1.0])
@pytest.mark.parametrize("kind", KINDS)
def test_delay_of_the_velocity_is_recovered_in_samples(kind: str, delay: float) -> None:
    position, velocity, acceleration = motion_of(kind)
    at = np.arange(len(velocity)) - delay
    late = np.interp(at, np.arange(len(velocity)), velocity)
    motion = smooth(readings_of(position, late))
    errors = motion.errors
    assert errors.velocity_delay_s == pytest.approx(delay * STEP_S, abs=0.05 * STEP_S)
    sd = np.sqrt(motion.covariance[:, 2, 2])
    assert np.median(np.abs(motion.mean[:, 2] - acceleration) / sd) < 1.0


def test_motion_does_not_depend_on_the_unit_the_zero_or_the_direction_of_time() -> None:
    position, velocity, _ = motion_of("trapezoids", 1000)
    readings = readings_of(position, velocity)
    motion = smooth(readings)

    def velocity_of(**changes: Any) -> Array:
        return np.asarray(smooth(replace(readings, **changes)).mean[:, 1])

    scale = 1e3
    np.testing.assert_allclose(
        velocity_of(
            position=scale * readings.position,
            velocity=scale * readings.velocity,
            position_floor=scale**2 * readings.position_floor,
            velocity_floor=scale**2 * readings.velocity_floor,
        )
        / scale,
        motion.mean[:, 1],
        atol=1e-3 * NOISE,
    )
    np.testing.assert_allclose(
        velocity_of(position=readings.position + 50.0), motion.mean[:, 1], atol=1e-3 * NOISE
    )
    back = velocity_of(position=readings.position[::-1], velocity=-readings.velocity[::-1])
    np.testing.assert_allclose(-back[::-1], motion.mean[:, 1], atol=0.02 * NOISE)


def test_long_record_is_smoothed_with_the_velocity_noise_recovered_within_5_percent() -> None:
    position, velocity, _ = motion_of("hand-guided", 24_000)
    motion = smooth(readings_of(position, velocity))
    errors = motion.errors
    assert np.sqrt(errors.velocity_variance) == pytest.approx(NOISE, rel=0.05)
    sd = np.sqrt(motion.covariance[:, 1, 1])
    assert np.mean(np.abs(motion.mean[:, 1] - velocity) < 2.0 * sd) > 0.92


def test_estimated_motion_of_one_to_five_samples_is_finite() -> None:
    position, velocity, _ = motion_of("sine", 20)
    for n in range(1, 6):
        motion = smooth(readings_of(position[:n], velocity[:n]))
        assert np.isfinite(motion.mean).all()


@pytest.mark.parametrize(("kind", "order", "share"), [("sine", 4, 2e-4), ("trapezoids", 3, 1.5e-3)])
def test_acceleration_is_smooth_in_a_sine_and_jumps_in_a_trapezoid(
    kind: str, order: int, share: float
) -> None:
    position, velocity, acceleration = motion_of(kind)
    # The encoder has a high resolution; with a coarse one both models have equal residuals.
    readings = replace(
        readings_of(position, velocity),
        position=quantised(position, 1e-3 * COUNT),
        position_floor=(1e-3 * COUNT) ** 2 / 12.0,
    )
    motion = smooth(readings)
    assert motion.errors.order == order
    usual = np.median(np.abs(motion.mean[:, 2] - acceleration))
    assert usual < share * np.max(np.abs(acceleration))


@pytest.mark.parametrize("order", [3, 4])
def test_lower_bound_is_just_below_the_likelihood_by_quadrature(order: int) -> None:
    """Two steps: the likelihood is an integral over the precision factors w = 1 / c of both, which
    have the density exp(-w)."""
    three = Readings(
        np.array([0.0, 0.1, 0.2]),
        np.array([0.0, 0.011, 0.05]),
        np.array([0.02, 0.21, 0.55]),
        1e-8,
        1e-8,
        np.ones(3),
        np.ones(3),
    )
    errors = ReadingErrors(1e-6, 1e-4, 0.0, 1e-1, order)
    log_w = np.linspace(-25.0, 5.0, 301)
    logs = np.array(
        [
            [three.log_likelihood(errors, np.exp([-a, -b]), np.zeros(3)) for a in log_w]
            for b in log_w
        ]
    )
    density = log_w - np.exp(log_w)
    logs += density[:, None] + density[None, :]
    step = log_w[1] - log_w[0]
    likelihood = np.max(logs) + np.log(np.sum(np.exp(logs - np.max(logs))) * step**2)
    bound = three.lower_bound(errors, three.corners(errors, 200))
    assert likelihood - 2.0 < bound < likelihood


def test_forces_place_a_corner_in_the_step_in_which_the_acceleration_jumps() -> None:
    """Forces are read between the samples of a coarse encoder, and one reading is missing."""
    corner_s = 1.5022
    time = STEP_S * np.arange(600)
    after = np.maximum(time - corner_s, 0.0)
    position = 0.3 * time - 3.0 * after**2
    readings = readings_of(position, np.gradient(position, STEP_S)).positions()
    smoothed = smooth(readings)
    instants = time[:-1] + 0.3 * STEP_S
    rows = np.tile([0.0, 0.5, 2.0], (len(instants), 1))
    true = 2.0 * np.where(instants > corner_s, -6.0, 0.0)
    true += 0.5 * (0.3 - 6.0 * np.maximum(instants - corner_s, 0.0))
    noisy = true + np.random.default_rng(3).normal(0.0, 0.05, len(true))
    variances = np.full(len(true), 0.05**2)
    variances[100] = np.inf
    located = smoothed.with_corners_located_by(ForceReadings(instants, rows, noisy, variances))
    step = int(corner_s / STEP_S)
    assert abs(int(np.argmax(located.corners)) - step) <= 1
    acceleration = np.where(time > corner_s, -6.0, 0.0)
    # Without the forces, the corner is smoothed over several steps, with too small an error.
    worst = [
        np.max(np.abs(m.mean[:, 2] - acceleration) / np.sqrt(m.covariance[:, 2, 2]))
        for m in (smoothed, located)
    ]
    assert worst[1] < 3.0 < worst[0]


def reversing(time: Array, turn_s: float) -> Array:
    """Position, velocity and acceleration of a motion that turns, shape (n, 3).

    The acceleration jumps from -6 to -2 at the reversal.
    """
    since = time - turn_s
    acceleration = np.where(since < 0.0, -6.0, -2.0)
    return np.column_stack((0.5 * acceleration * since**2, acceleration * since, acceleration))


@pytest.mark.parametrize("turn_s", [1.5001, 1.5022, 1.5049])
def test_known_jump_of_the_acceleration_is_not_smoothed(turn_s: float) -> None:
    """The jump is within a step of a coarse encoder, close to either sample or between them."""
    time = STEP_S * np.arange(600)
    position, velocity, acceleration = reversing(time, turn_s).T
    smoothed = smooth(readings_of(position, velocity).positions())
    jumps = Jumps(np.array([turn_s]), np.array([4.0]), np.array([1e-5]))
    followed = smoothed.with_corners_located_by(None, jumps)
    near = np.abs(time - turn_s) < 10.0 * STEP_S
    errors = [np.abs(m.mean[near, 2] - acceleration[near]) for m in (smoothed, followed)]
    assert np.max(errors[1]) < 0.25 < 1.0 < np.max(errors[0])
    assert np.all(errors[1] < 4.0 * np.sqrt(followed.covariance[near, 2, 2]))
    # The states at other instants contain the jump as well.
    between = time[near] + 0.4 * STEP_S
    mean, _, _ = followed.at(between)
    true = reversing(between, turn_s)
    assert mean[:, 2] == pytest.approx(true[:, 2], abs=0.25)
    assert mean[:, :2] == pytest.approx(true[:, :2], abs=0.01)


def test_motion_of_jumps_is_the_double_integral_of_their_acceleration() -> None:
    jumps = Jumps(np.array([0.2, 0.35, 0.8]), np.array([3.0, -5.0, 2.0]), np.zeros(3))
    fine = 1e-5 * np.arange(100_001)
    acceleration = (fine[:, None] > jumps.instants_s) @ jumps.sizes
    velocity = 1e-5 * np.cumsum(acceleration)
    expected = np.column_stack((1e-5 * np.cumsum(velocity), velocity, acceleration))
    chosen = slice(5_000, None, 9_000)
    assert jumps.at(fine[chosen]) == pytest.approx(expected[chosen], abs=1e-4)


def test_sample_close_to_an_uncertain_jump_has_a_large_error_of_the_acceleration() -> None:
    """The instant is wrong by 0.4 ms, two of its standard errors, and a sample is between."""
    time = STEP_S * np.arange(600)
    turn_s = time[375] + 2e-4
    position, velocity, acceleration = reversing(time, turn_s).T
    smoothed = smooth(readings_of(position, velocity).positions())
    instants, size = np.array([time[375] - 2e-4]), np.array([4.0])
    followed = smoothed.with_corners_located_by(None, Jumps(instants, size, np.array([2e-4])))
    sd = np.sqrt(followed.covariance[:, 2, 2])
    off = np.abs(followed.mean[:, 2] - acceleration)
    assert np.all(off[365:386] < 3.0 * sd[365:386])
    assert off[375] > 1.0


@pytest.mark.parametrize(("order", "variance"), [(3, 5.0 * 0.02), (4, 5.0 * 0.02**3 / 3.0)])
def test_process_noise_at_an_uncertain_jump_has_the_variance_of_its_size(
    order: int, variance: float
) -> None:
    """Variance of the acceleration after a step of 20 ms, with jerk or snap of intensity 5."""
    errors = ReadingErrors(1e-8, 1e-4, 0.0, 5.0, order)
    jumps = Jumps(np.array([0.1001, 0.35]), np.array([4.0, 4.0]), np.array([1e-3, 1e-3]))
    factors = jumps.corners(0.02 * np.arange(30), errors)
    # The first jump may be on either side of the sample at 0.1 s, the second is within a step.
    assert np.flatnonzero(factors).tolist() == [4, 5]
    assert factors[4:6] * variance == pytest.approx(16.0)
