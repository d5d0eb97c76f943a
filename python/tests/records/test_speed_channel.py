"""A recorded speed with a delay, derived from the path, or with an offset at standstill."""

from typing import Any

import numpy as np
import pytest
from jbf import Run
from jbf.records.motion.derived_speed import derived_speed
from jbf.records.motion.estimated_motion import estimate_motion
from jbf.records.motion.speed_delay import filtered_speed
from jbf.records.motion.speed_zero import speed_zero
from jbf.records.motion.window_comparisons import window_comparisons
from known_motions import STEP_S, TIME_S, Array, integrated, path_of, quantised, speed_of, white
from scipy import signal

PATH_M, SPEED_M_S = path_of(TIME_S), speed_of(TIME_S)
COUNT_M = 1e-4
COUNTED_M = quantised(PATH_M, COUNT_M)
ALTERNATING = np.where(np.arange(800) % 2, -1.0, 1.0)


@pytest.mark.parametrize("delay_steps", [1.6, 3.0])
def test_delay_of_a_filtered_speed_is_recovered(delay_steps: float) -> None:
    delay_s = delay_steps * STEP_S
    finding: Any = filtered_speed("a", TIME_S, PATH_M, speed_of(TIME_S - delay_s))
    assert (finding.kind, finding.channel, finding.unit) == ("filtered_speed", "velocity_m_s", "s")
    assert finding.size == pytest.approx(delay_s, rel=0.03)


@pytest.mark.parametrize("delay_steps", [-0.9, 0.0, 0.3, 1.2])
def test_delay_of_up_to_one_and_a_half_samples_is_corrected_in_the_motion(
    delay_steps: float,
) -> None:
    speed = speed_of(TIME_S - delay_steps * STEP_S) + white(len(TIME_S), 5, 5e-3)
    motion = estimate_motion(Run.from_arrays(TIME_S, speed, position_m=PATH_M), None)
    sizes = [f.size for f in motion.findings if f.kind == "late_speed"]
    assert len(sizes) == (delay_steps != 0.0)
    assert sizes == [pytest.approx(delay_steps * STEP_S, rel=0.1)] * len(sizes)
    np.testing.assert_allclose(motion.velocity[5:-5], speed_of(TIME_S)[5:-5], atol=1e-2)


def estimated_delay(speed: Array) -> tuple[float, float]:
    """Delay and standard error, s: regression of windowed speeds on speed and acceleration of the
    path, jackknife over twelve parts, of the window with the smallest error."""
    estimates = []
    for window in window_comparisons(TIME_S, PATH_M, speed):
        design = np.stack([window.by_path, window.acceleration], axis=1)
        part = np.arange(len(design)) * 12 // len(design)
        delays = []
        for kept in (part >= 0, *(part != k for k in range(12))):
            solution = np.linalg.lstsq(design[kept], window.by_speed[kept], rcond=None)[0]
            delays.append(-float(solution[1]))
        estimates.append((float(np.std(delays[1:])) * np.sqrt(11.0), delays[0]))
    error_s, delay_s = min(estimates)
    return delay_s, error_s


def test_speed_delay_is_reported_from_six_jackknife_standard_errors_on() -> None:
    decisions = set()
    for delay_steps in np.arange(1.3, 2.5, 0.1):
        speed = speed_of(TIME_S - delay_steps * STEP_S) + white(len(TIME_S), 2, 0.01)
        delay_s, error_s = estimated_delay(speed)
        finding = filtered_speed("a", TIME_S, PATH_M, speed)
        expected = delay_s >= max(6.0 * error_s, 1.5 * STEP_S)
        assert (finding is not None) == expected
        assert finding is None or finding.size == pytest.approx(delay_s, rel=1e-6)
        decisions.add(expected)
    assert decisions == {True, False}


def test_delay_of_an_exponentially_decaying_speed_is_not_reported() -> None:
    """A delayed exponential equals a scaled one, so that the delay is not identifiable."""
    decaying = np.exp(-0.5 * TIME_S)
    assert filtered_speed("a", TIME_S, -2.0 * decaying, 1.1 * decaying) is None


def backward_difference(path: Array, span: int) -> Array:
    speed = np.zeros(len(path))
    speed[span:] = (path[span:] - path[:-span]) / (span * STEP_S)
    return speed


@pytest.mark.parametrize("span", [1, 2, 5, 12])
def test_speed_from_backward_differences_is_recognised_with_half_a_span_delay(span: int) -> None:
    finding: Any = derived_speed("a", TIME_S, COUNTED_M, backward_difference(COUNTED_M, span))
    assert (finding.kind, finding.channel) == ("coarse_speed", "velocity_m_s")
    assert (finding.size, finding.unit) == (span, "samples")
    assert f"{0.5 * span * 1e3 * STEP_S:.3g} ms late" in finding.words


def test_difference_over_messages_that_arrive_together_is_recognised() -> None:
    """Stamps of arrival: a message that waits for the previous one causes a huge difference."""
    stamps = TIME_S.copy()
    stamps[100:700:60] = stamps[101:701:60] - 1e-5
    speed = np.concatenate(([0.0], np.diff(COUNTED_M) / np.diff(stamps)))
    assert np.max(np.abs(speed)) > 50.0 * np.quantile(np.abs(speed), 0.95)
    finding: Any = derived_speed("a", stamps, COUNTED_M, speed)
    assert finding.kind == "coarse_speed"


@pytest.mark.parametrize("span", [2, 8])
def test_speed_from_central_differences_is_recognised_without_a_delay(span: int) -> None:
    speed, half = np.zeros(len(TIME_S)), span // 2
    speed[half:-half] = (COUNTED_M[span:] - COUNTED_M[:-span]) / (span * STEP_S)
    finding: Any = derived_speed("a", TIME_S, COUNTED_M, speed)
    assert (finding.size, "late" in finding.words) == (span, False)


@pytest.mark.parametrize("order", [1, 2])
def test_filtered_difference_of_counts_is_recognised_as_derived_from_them(order: int) -> None:
    """A low-pass of 1.4 samples, applied once or twice, on a central difference."""
    filtered = np.gradient(COUNTED_M, STEP_S)
    for _ in range(order):
        filtered = signal.lfilter([0.5], [1.0, -0.5], filtered)
    finding: Any = derived_speed("a", TIME_S, COUNTED_M, filtered)
    assert (finding.kind, "filtered difference" in finding.words) == ("coarse_speed", True)


@pytest.mark.parametrize("share", [0.03, 0.3, 3.0])
def test_speed_with_noise_of_its_own_is_not_a_filtered_difference(share: float) -> None:
    """The noise is a share of the quantisation error of a central difference."""
    size = share * COUNT_M / np.sqrt(24.0) / STEP_S
    noisy = SPEED_M_S + white(len(TIME_S), 7, size)
    assert derived_speed("a", TIME_S, COUNTED_M, noisy) is None


@pytest.mark.parametrize("speed_step", [0.0, 0.01])
def test_speed_of_whole_counts_per_sample_is_not_a_filtered_difference(speed_step: float) -> None:
    """Between the ramps the path has no quantisation errors, which any filter would repeat."""
    ramp = np.linspace(0.0, 4.0, 10)
    move = np.concatenate([ramp, np.full(500, 4.0), ramp[::-1]])
    speed = np.tile(np.concatenate([move, -move]), 4) * COUNT_M / STEP_S
    time_s = STEP_S * np.arange(len(speed))
    path = quantised(integrated(speed, STEP_S), COUNT_M)
    recorded = speed if speed_step == 0.0 else quantised(speed, speed_step)
    assert derived_speed("a", time_s, path, recorded) is None


def test_speed_is_not_a_path_difference_if_independent_long_short_or_at_rest() -> None:
    assert derived_speed("a", TIME_S, COUNTED_M, SPEED_M_S) is None
    assert derived_speed("a", TIME_S, COUNTED_M, backward_difference(COUNTED_M, 13)) is None
    coarse = backward_difference(COUNTED_M, 1)
    assert derived_speed("a", TIME_S[:47], COUNTED_M[:47], coarse[:47]) is None
    assert derived_speed("a", TIME_S, 0.0 * PATH_M, 0.0 * PATH_M) is None


def at_standstill(offset: float, noise: float = 0.0, samples: int = 100, step: float = 1e-5) -> Any:
    """Corrected speed, speed limit of a rest, and finding of a shaft that rests between two motions
    at 0.1 m/s."""
    index = np.arange(400)
    speed = np.where((index >= 150) & (index < 150 + samples), 0.0, 0.1)
    path = quantised(np.cumsum(speed) * STEP_S, step)
    recorded = speed + offset + noise * ALTERNATING[:400] * (speed == 0.0)
    return speed_zero("a", TIME_S[:400], path, recorded, step, "m/s")


@pytest.mark.parametrize("offset", [2e-3, -2e-3])
def test_speed_offset_at_standstill_is_subtracted_from_all_samples(offset: float) -> None:
    speed, hum, finding = at_standstill(offset)
    np.testing.assert_allclose(speed[160:240], 0.0, atol=1e-12)
    assert (speed[0], hum) == pytest.approx((0.1, 0.1))
    assert (finding.kind, finding.unit) == ("speed_zero", "m/s")
    assert finding.size == pytest.approx(offset)


@pytest.mark.parametrize(
    ("offset", "samples"), [(2e-3, 55), (3.5e-5, 100), (0, 100)], ids=["short", "small", "none"]
)
def test_short_or_small_speed_offset_at_rest_is_not_corrected(offset: Any, samples: int) -> None:
    speed, hum, finding = at_standstill(offset, samples=samples)
    assert (hum, speed[0], finding) == (0.0, 0.1 + offset, None)


def test_speed_offset_is_reported_from_60_samples_and_4_counts_of_drift_on() -> None:
    assert at_standstill(2e-3, samples=65)[2] is not None
    assert at_standstill(4.5e-5)[2] is not None


def test_speed_offset_is_reported_beyond_five_standard_errors_of_its_mean() -> None:
    # The last moving sample already has the position of the rest.
    error = 1e-4 / np.sqrt(201.0 / 20.0)
    assert at_standstill(4.9 * error, 1e-4, 200, 1e-7)[2] is None
    assert at_standstill(5.1 * error, 1e-4, 200, 1e-7)[2] is not None


@pytest.mark.parametrize("count_m_s", [0.0, 4e-3])
def test_run_with_a_speed_offset_rests_where_its_position_is_constant(count_m_s: float) -> None:
    """A tachometer with an offset, or a quantised speed whose levels are shifted by half a step."""
    phase = np.mod(TIME_S, 4.0)
    true = 0.08 * np.clip(np.minimum(phase - 0.503, 3.007 - phase), 0.0, 0.5)
    offset = 0.5 * count_m_s if count_m_s else -2e-3
    noisy = true + white(len(TIME_S), 3, 1e-5)
    recorded = offset + (quantised(true, count_m_s) if count_m_s else noisy)
    path = quantised(integrated(true, STEP_S), 5e-6)
    motion = estimate_motion(Run.from_arrays(TIME_S, recorded, position_m=path), None)
    (finding,) = motion.findings
    assert (finding.kind, finding.size) == ("speed_zero", pytest.approx(offset, abs=2e-5))
    assert motion.resting[true == 0.0].mean() > 0.9
    assert not motion.resting[true > 0.02].any()
