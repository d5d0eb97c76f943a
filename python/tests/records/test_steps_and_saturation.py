"""Converter findings: quantisation step, saturation, and decimal digits of the force."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from jbf import Run
from jbf.records.findings.digits import last_digit
from jbf.records.findings.examine import examine
from jbf.records.findings.saturation import find_saturation, saturated
from jbf.records.findings.steps import find_steps, step_of
from jbf.records.quantities import ROTARY
from known_motions import Array, quantised, white

SAMPLES = 2000
TIME_S: Any = 0.01 * np.arange(SAMPLES)
WAVE: Any = 10.0 * np.sin(0.7 * TIME_S)
NOISE = white(SAMPLES, 1)


def run_of(force: Any) -> Run:
    """A run whose friction is a torque."""
    run = Run.from_arrays(TIME_S, 0.1 * np.sin(0.7 * TIME_S + 0.1), force, name="a")
    return replace(run, quantities=ROTARY)


@pytest.mark.parametrize(
    ("values", "digit"),
    [([1.25, 3.5, -2.0], 0.01), ([99, 100], 1.0), ([0, 0], 0.0), ([np.pi, 1.0], 1e-9 * np.pi)],
)
def test_last_digit_is_a_decimal_step_or_1e_minus_9_of_largest(values: Any, digit: float) -> None:
    assert last_digit(np.array(values, float)) == pytest.approx(digit)


def test_quantisation_step_is_recovered_if_levels_are_missing_or_uneven() -> None:
    levels = quantised(WAVE, 0.5)
    assert step_of(levels) == pytest.approx(0.5)
    assert step_of(levels[(levels != 2.0) & (levels != -3.0)]) == pytest.approx(0.5)
    assert step_of(levels + 0.01 * np.sin(levels)) == pytest.approx(0.5, rel=0.03)
    assert step_of(WAVE) == 0.0


@pytest.mark.parametrize(
    ("values", "step"),
    [
        (np.tile([0.0, 1.0, 2.0], 100), 0.0),  # three levels may also be those of a noise-free law
        (np.tile([0.0, 1.0, 2.0, 3.0], 100), 1.0),
        (np.repeat(np.arange(20.0), 5), 1.0),  # levels are a fifth of the samples
        (np.repeat(np.arange(26.0), 4)[:100], 0.0),
        (np.repeat(np.cumsum(np.where(np.arange(40) % 5 == 4, 1.14, 1.0)), 10), 1.0),
        (np.repeat(np.cumsum(np.where(np.arange(40) % 5 == 4, 1.16, 1.0)), 10), 0.0),
        (np.repeat(np.cumsum(np.where(np.arange(100) < 8, 1.4, 1.0)), 10), 1.0),
        (np.repeat(np.cumsum(np.where(np.arange(100) < 12, 1.4, 1.0)), 10), 0.0),
    ],
)
def test_quantisation_step_requires_few_levels_at_integer_multiples_of_the_step(
    values: Array, step: float
) -> None:
    """Nine of ten levels must be an integer number of steps apart, within 3 % of at least five."""
    assert step_of(values) == pytest.approx(step)


def test_quantisation_step_of_interpolated_readings_tolerates_rounding_errors() -> None:
    corners = np.tile(np.arange(5.0), 20) + 1e-4 * NOISE[:100]
    assert step_of(corners, drawn=True) == pytest.approx(1.0, abs=1e-3)
    assert step_of(corners) == 0.0


def test_quantisation_step_is_reported_only_if_above_half_of_the_noise() -> None:
    usable = np.ones(SAMPLES, dtype=bool)
    assert find_steps(run_of(quantised(WAVE + NOISE, 0.3)), usable) == []
    (finding,) = find_steps(run_of(quantised(WAVE + NOISE, 0.7)), usable)
    assert (finding.kind, finding.size, finding.unit) == ("steps", pytest.approx(0.7), "N m")


def test_quantisation_step_is_estimated_from_usable_readings_only() -> None:
    first = np.arange(SAMPLES) < 1000
    run = run_of(np.where(first, quantised(WAVE + NOISE, 0.7), WAVE))
    assert find_steps(run, np.ones(SAMPLES, dtype=bool)) == []
    assert len(find_steps(run, first)) == 1


def clipped(low: float = -np.inf, high: float = np.inf, noise: float = 0.3) -> Any:
    return np.clip(WAVE + noise * NOISE, low, high)


def test_saturation_at_either_limit_is_detected_with_seven_samples_on_each_side() -> None:
    force = clipped(-8.0, 9.0)
    mask, ends = saturated(force)
    assert ends == [9.0, -8.0]
    at_end = np.isin(force, ends)
    np.testing.assert_array_equal(mask, np.convolve(at_end, np.ones(15), "same") > 0.5)
    assert saturated(clipped(high=9.0))[1] == [9.0]
    assert saturated(clipped(low=-8.0))[1] == [-8.0]
    mask, ends = saturated(clipped())
    assert (mask.any(), ends) == (False, [])


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_equal_extreme_readings_are_saturation_from_five_readings_on(sign: float) -> None:
    for count, found in ((4, False), (5, True)):
        values = clipped()
        values[100 : 100 + 60 * count : 60] = sign * 20.0
        assert (saturated(values)[1] == [sign * 20.0]) == found


def test_plateau_of_a_force_quantised_above_its_noise_is_not_saturation() -> None:
    assert saturated(np.round(clipped(-8.0, 8.0, 0.3)))[1] == []
    assert saturated(np.round(clipped(-8.0, 8.0, 0.75)))[1] != []


@pytest.mark.parametrize("force", [WAVE, np.sign(WAVE), np.clip(WAVE, -8.0, 8.0)])
def test_noise_free_force_is_not_saturated_even_if_it_has_a_plateau(force: Array) -> None:
    assert saturated(force)[1] == []


def test_saturation_finding_has_the_largest_limit_of_both_directions() -> None:
    (finding,), _ = find_saturation(run_of(clipped(-8.0, 9.0)))
    assert (finding.kind, finding.channel) == ("saturation", "friction_n")
    assert (finding.size, finding.unit, finding.done) == (9.0, "N m", "excluded")
    assert find_saturation(run_of(clipped(low=-8.0)))[0][0].size == 8.0
    assert find_saturation(run_of(clipped()))[0] == []


@pytest.mark.parametrize(
    ("of_peak", "step_n"),
    [(0.8, 0.0), (0.87, 0.1), pytest.param(0.95, 0.1, marks=pytest.mark.extended)],
)
def test_usable_readings_next_to_saturation_are_unbiased(of_peak: float, step_n: float) -> None:
    time_s = 0.02 * np.arange(3000)
    speed = 0.1 * np.sin(0.3 * time_s + 0.4)
    size = 15.0 + 10.0 * np.exp(-np.abs(speed) / 0.02) + 40.0 * np.abs(speed)
    friction = np.tanh(speed / 0.002) * size
    unclipped = friction + white(3000, 11, 0.3)
    limit = of_peak * float(np.quantile(np.abs(unclipped), 0.995))
    force = np.clip(unclipped, -limit, limit)
    force = quantised(force, step_n) if step_n else force
    examined = examine(Run.from_arrays(time_s, speed, force))
    (finding,) = examined.findings
    assert (finding.kind, finding.size) == ("saturation", pytest.approx(limit, abs=0.06))
    assert not examined.usable[np.abs(unclipped) > limit + step_n].any()
    residual = ((force - friction) * np.sign(speed))[examined.usable & (np.abs(speed) > 0.01)]
    assert abs(np.mean(residual)) < 0.3 * (0.1 + 3.0 / np.sqrt(len(residual)))
    assert np.mean(examined.usable) > 0.8 * np.mean(np.abs(unclipped) < limit - 1.2)


def test_constant_levels_of_dry_friction_are_not_saturation() -> None:
    level = 20.0 * np.sign(WAVE)
    for force in (level, quantised(level + 0.3 * NOISE, 0.9), quantised(level + 0.3 * NOISE, 0.05)):
        assert "saturation" not in {f.kind for f in examine(run_of(force)).findings}
