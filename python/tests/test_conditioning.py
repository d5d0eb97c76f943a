"""The estimate of the imposed motion, against motions that are known exactly."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from jbf import Run
from jbf.records.motion import smoothing
from jbf.records.motion.imposed import impose
from jbf.records.motion.roughness import noise_of

RADIUS_M = 0.0127
STEP_RAD = 1.0 / 2387.3
Array = npt.NDArray[np.float64]


def recorded(
    time: Array, speed: Array, path: Array, *, sd: float = 1e-4, angle: bool = True, seed: int = 0
) -> Run:
    """What an encoder and a noisy tachometer make of a motion."""
    random = np.random.default_rng(seed)
    noisy = np.where(speed == 0.0, 0.0, speed + random.normal(0.0, sd, len(time)))
    counts = np.round(path / RADIUS_M / STEP_RAD) * STEP_RAD
    return Run.from_arrays(time, noisy, angle_rad=counts if angle else None)


@pytest.mark.parametrize("omega", [0.1, 1.0, 2.0])
def test_a_sine_is_smoothed(omega: float) -> None:
    t = np.arange(0.0, 40.0, 0.02)
    v = 0.127 * np.sin(omega * t)
    m = impose(recorded(t, v, 0.127 / omega * (1.0 - np.cos(omega * t))), RADIUS_M)
    assert np.std(m.velocity_m_s - v) < 0.35e-4
    gap = m.acceleration_m_s2 - 0.127 * omega * np.cos(omega * t)
    assert np.std(gap) < 2e-3 + 0.02 * 0.127 * omega
    # The stated errors are honest: most speeds lie within three of them.
    off = np.abs(m.velocity_m_s - v) / m.velocity_error_m_s
    assert np.mean(off < 3.0) > 0.95
    # Where the sign is trusted it is right.
    sure = m.sign_known & ~m.resting
    np.testing.assert_array_equal(np.sign(m.velocity_m_s[sure]), np.sign(v[sure]))
    assert np.mean(m.sign_known) > 0.98


def test_without_an_angle_the_speed_alone_is_smoothed() -> None:
    t = np.arange(0.0, 40.0, 0.02)
    v = 0.127 * np.sin(t)
    m = impose(recorded(t, v, -0.127 * np.cos(t), angle=False), RADIUS_M)
    assert np.std(m.velocity_m_s - v) < 0.6e-4


def test_corners_and_rests_of_a_trapezoid_survive() -> None:
    t = np.arange(0.0, 12.0, 0.02)
    v = 0.05 * np.clip(np.minimum(t - 2.0, 8.0 - t), 0.0, 1.0)
    path = np.concatenate(([0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * 0.02)))
    m = impose(recorded(t, v, path), RADIUS_M)
    assert np.max(np.abs(m.velocity_m_s - v)) < 4e-4
    np.testing.assert_array_equal(m.resting, v == 0.0)
    assert np.all(m.velocity_m_s[m.resting] == 0.0)
    # The second rest is placed better than the encoder's step shows it.
    last = m.angle_rad[-1] * RADIUS_M
    assert abs(last - path[-1]) < 0.3 * STEP_RAD * RADIUS_M


def test_a_clean_record_is_left_alone() -> None:
    t = np.arange(0.0, 10.0, 0.01)
    v = 0.1 * np.sin(3.0 * t) + 0.02 * np.sin(11.0 * t)
    m = impose(Run.from_arrays(t, v), RADIUS_M)
    np.testing.assert_allclose(m.velocity_m_s, v, atol=2e-5)


def test_uneven_samples_are_fine() -> None:
    random = np.random.default_rng(3)
    t = np.cumsum(random.uniform(0.01, 0.03, 1500))
    v = 0.127 * np.sin(t)
    m = impose(recorded(t, v, -0.127 * np.cos(t)), RADIUS_M)
    assert np.std(m.velocity_m_s - v) < 0.4e-4


@pytest.mark.parametrize("sd", [1e-4, 0.3])
def test_noise_of_a_smooth_signal(sd: float) -> None:
    random = np.random.default_rng(1)
    t = np.arange(0.0, 60.0, 0.02)
    signal = 10.0 * np.tanh(20.0 * np.sin(t)) + random.normal(0.0, sd, len(t))
    assert noise_of(signal) == pytest.approx(sd, rel=0.15 if sd > 0.01 else 5.0)


# ---- records of real machines ---------------------------------------------------------------


def stroke_and_rest() -> tuple[Array, Array, Array]:
    """Time, speed and place of a slider that moves by 0.2 mm and rests for half a second."""
    t = np.arange(0.0, 12.0, 0.005)
    phase = np.mod(t, 2.0)
    way = np.where(np.mod(t, 4.0) < 2.0, 1.0, -1.0)
    speed = np.where(phase < 1.4, way * 2.5e-4 * np.sin(np.pi * phase / 1.4) ** 2, 0.0)
    place = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(t))))
    return t, speed, place


def test_a_rest_whose_speed_hums_is_a_rest() -> None:
    t, speed, place = stroke_and_rest()
    hum = 4e-7 * np.sin(40.0 * t) * (speed == 0.0)
    run = Run.from_arrays(t, speed + hum, position_m=np.round(place, 7))
    m = impose(run, None)
    deep = (speed == 0.0) & (np.mod(t, 2.0) > 1.5) & (np.mod(t, 2.0) < 1.9)
    assert m.resting[deep].all()
    assert not m.velocity_m_s[m.resting].any()
    assert not m.resting[np.abs(speed) > 0.02 * speed.max()].any()


def test_a_slow_reversal_is_no_rest() -> None:
    t = np.arange(0.0, 60.0, 0.02)
    v = 0.127 * np.sin(0.1 * t)
    m = impose(recorded(t, v, 1.27 * (1.0 - np.cos(0.1 * t))), RADIUS_M)
    assert not m.resting.any()


def test_positions_without_a_step_are_not_believed_to_the_last_digit() -> None:
    t, speed, place = stroke_and_rest()
    random = np.random.default_rng(3)
    noisy = place + 2e-7 * random.standard_normal(len(t))
    run = Run.from_arrays(t, speed + 2e-6 * random.standard_normal(len(t)), position_m=noisy)
    m = impose(run, None)
    moving = np.abs(speed) > 2e-5
    assert np.std((m.velocity_m_s - speed)[moving]) < 1.5e-6
    off = np.abs(m.velocity_m_s - speed)[moving] / m.velocity_error_m_s[moving]
    assert np.mean(off < 4.0) > 0.95


def test_a_speed_that_disagrees_with_the_place_is_believed_less() -> None:
    t = np.arange(0.0, 20.0, 0.005)
    v = 0.1 * np.sin(2.0 * t)
    place = np.round(0.05 * (1.0 - np.cos(2.0 * t)), 7)
    late = 0.1 * np.sin(2.0 * (t - 0.004))
    m = impose(Run.from_arrays(t, late, position_m=place), None)
    assert np.std(m.velocity_m_s - v) < 0.2 * np.std(late - v)


def test_uneven_noise_is_uneven_error() -> None:
    t = np.arange(0.0, 40.0, 0.01)
    v = 0.1 * np.sin(0.5 * t)
    loud = (t > 10.0) & (t < 20.0)
    random = np.random.default_rng(4)
    noise = np.where(loud, 2e-3, 1e-4) * random.standard_normal(len(t))
    m = impose(Run.from_arrays(t, v + noise), None)
    inside = (t > 11.0) & (t < 19.0)
    quiet = (t > 22.0) & (t < 38.0)
    ratio = np.median(m.velocity_error_m_s[inside]) / np.median(m.velocity_error_m_s[quiet])
    assert ratio > 5.0
    sure = m.sign_known & ~m.resting
    np.testing.assert_array_equal(np.sign(m.velocity_m_s[sure]), np.sign(v[sure]))


def test_an_angle_without_a_radius_goes_by_its_speed() -> None:
    t = np.arange(0.0, 10.0, 0.01)
    v = 0.1 * np.sin(t)
    angle = 3.0 * (1.0 - np.cos(t))
    m = impose(Run.from_arrays(t, v, angle_rad=angle), None)
    assert np.max(np.abs(m.velocity_m_s - v)) < 2e-5
    np.testing.assert_allclose(m.angle_rad, angle, rtol=0.0, atol=1e-5)


@pytest.mark.parametrize("half", [1, 4, 16])
def test_even_samples_share_their_windows(half: int, monkeypatch: pytest.MonkeyPatch) -> None:
    random = np.random.default_rng(5)
    time = np.round(0.02 * np.arange(120), 3)
    speed = np.sin(time) + 1e-3 * random.standard_normal(120)
    path = 1.0 - np.cos(time) + 1e-4 * random.standard_normal(120)
    short = smoothing.local_fit(time, path, speed, 1e-4, 1e-3, half)
    monkeypatch.setattr(smoothing, "_even", lambda time: False)
    for got, expected in zip(
        short, smoothing.local_fit(time, path, speed, 1e-4, 1e-3, half), strict=True
    ):
        np.testing.assert_allclose(got, expected, rtol=1e-7, atol=1e-9)
