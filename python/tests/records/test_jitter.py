"""Jitter: uneven time stamps, and positions read at other instants than their stamps."""

from typing import Any

import numpy as np
import pytest
from jbf import Run
from jbf.records.motion.estimated_motion import estimate_motion
from jbf.records.motion.jitter import jittered_path, uneven_stamps
from known_motions import integrated, path_of, quantised, speed_of, white

STEP_S = 0.01
ALTERNATING: Any = np.where(np.arange(1000) % 2, -1.0, 1.0)


def stamps(size_s: float, samples: int = 400) -> Any:
    """Time stamps with white jitter, s."""
    return STEP_S * np.arange(samples) + white(samples, 5, size_s)


@pytest.mark.parametrize("size_s", [1.2e-4, 1e-3])
def test_jitter_size_is_estimated_from_fourth_differences_of_the_time_stamps(size_s: float) -> None:
    """Fourth differences are 16 times the size; in unit white noise their variance is 70."""
    finding: Any = uneven_stamps("a", STEP_S * np.arange(1000) + size_s * ALTERNATING)
    assert finding.size == pytest.approx(16.0 * size_s / 0.6745 / np.sqrt(70.0))


def test_time_stamp_jitter_is_reported_from_sixty_one_samples_on() -> None:
    assert uneven_stamps("a", stamps(1e-3)[:60]) is None
    assert uneven_stamps("a", stamps(1e-3)[:61]) is not None


def test_time_stamps_with_a_smoothly_changing_or_constant_rate_have_no_jitter() -> None:
    time_s = STEP_S * np.arange(600)
    assert uneven_stamps("a", time_s + 0.2 * time_s**2) is None
    assert uneven_stamps("a", np.round(time_s, 3)) is None


def test_time_stamp_jitter_is_reported_only_if_nine_of_ten_steps_are_alike() -> None:
    # Each missing sample causes one step of twice the length.
    for every, found in ((8, False), (20, True)):
        lossy = np.delete(stamps(1e-3), np.arange(0, 400, every))
        assert (uneven_stamps("a", lossy) is not None) == found


def shaken(size_s: float, count: float = 1e-12, samples: int = 4000, ripple: bool = False) -> Any:
    """Finding of a slow motion whose positions were read at other instants than their stamps."""
    time_s: Any = STEP_S * np.arange(samples)
    wave = np.sin(2.0 * np.pi / 6.0 * np.arange(samples))
    off_s = size_s * (wave if ripple else white(samples, 6))
    path = path_of(0.2 * (time_s + off_s)) / 0.2
    return jittered_path("a", time_s, quantised(path, count), speed_of(0.2 * time_s))


def test_position_jitter_is_recovered_from_noise_that_grows_with_the_speed() -> None:
    finding: Any = shaken(1e-3)
    assert (finding.kind, finding.channel, finding.unit) == ("jitter", "time_s", "s")
    assert finding.size == pytest.approx(1e-3, rel=0.25)


def test_small_quantised_periodic_and_short_deviations_are_not_jitter() -> None:
    assert shaken(0.5e-4) is None
    assert shaken(1e-3, count=1e-3) is None
    assert shaken(1e-2, ripple=True) is None
    assert shaken(1e-3, samples=200) is None


def test_position_noise_that_does_not_grow_with_speed_is_not_reported_as_jitter() -> None:
    time_s: Any = STEP_S * np.arange(4000)
    path = path_of(0.2 * time_s) / 0.2 + white(4000, 7, 1e-4)
    speed = speed_of(0.2 * time_s)
    assert jittered_path("a", time_s, path, speed) is None
    uneven = time_s + 2e-3 * np.random.default_rng(8).uniform(-1.0, 1.0, 4000)
    assert jittered_path("a", uneven, path, speed) is None


@pytest.mark.parametrize("slow_noise", [0.0, 5e-5])
def test_position_noise_at_low_speed_is_subtracted_from_the_jitter(slow_noise: float) -> None:
    """Three constant speeds, read alternately before and after the time stamp.

    Fifth differences are 32 times the size; of unit white noise their variance is 252.
    """
    delay_s, unit = 2e-3, 32.0 / 0.6745 / np.sqrt(252.0)
    speed: Any = np.repeat([0.1, 0.45, 1.0], 300)
    path = integrated(speed, STEP_S) + (delay_s * speed + slow_noise) * ALTERNATING[:900]
    finding: Any = jittered_path("a", STEP_S * np.arange(900), path, speed)
    floor = np.min(np.abs(np.diff(path))) / np.sqrt(12.0)
    slow = max(unit * (0.1 * delay_s + slow_noise), floor)
    fast = unit * (delay_s + slow_noise)
    assert finding.size == pytest.approx(np.sqrt(fast**2 - slow**2), rel=1e-3)


@pytest.mark.parametrize("even", [True, False])
def test_finding_of_time_stamp_jitter_states_which_instants_are_used(even: bool) -> None:
    """Even instants with wrong stamps, or uneven instants with correct stamps."""
    stamped = stamps(3e-4, 1000)
    read = STEP_S * np.arange(1000) if even else stamped
    path = quantised(path_of(read), 1e-6)
    motion = estimate_motion(Run.from_arrays(stamped, position_m=path), None)
    (done,) = (f.done for f in motion.findings if f.kind == "jitter")
    assert ("regular clock" in done) == even
    assert (motion.clock_s is not None) == even
