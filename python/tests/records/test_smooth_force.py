"""Forces without noise: commands of a controller, and filtered readings."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from jbf import Model, Rig, Run, compare
from known_motions import quantised, white
from scipy.signal import butter, filtfilt

TIME_S: Any = 0.002 * np.arange(6000)
SPEED_M_S: Any = 0.1 * np.sin(2.0 * TIME_S) + 0.04 * np.sin(5.3 * TIME_S)
FORCE_N: Any = 5.0 * np.tanh(300.0 * SPEED_M_S) + 40.0 * SPEED_M_S
MODEL = Model(Rig(), "coulomb", parameters={"F_c": 5.0, "F_v": 30.0})


def run_with(friction: Any) -> Run:
    return Run.from_arrays(TIME_S, SPEED_M_S, friction, name="a")


@pytest.mark.parametrize("digits", [4, pytest.param(6, marks=pytest.mark.extended), 15])
def test_noise_floor_of_a_command_is_unknown_and_no_error_is_relative_to_it(digits: int) -> None:
    comparison = compare(MODEL, [run_with(np.round(FORCE_N, digits))])
    assert "smooth_force" in {f.kind for f in comparison.findings}
    assert comparison.to_dict()["noise_rms"] is None
    assert comparison.rms > 0.1
    for text in (comparison.summary(), repr(comparison)):
        assert "unknown" in text
        assert "times the noise" not in text


@pytest.mark.parametrize("cut", [0.05, 0.2])
def test_low_pass_filtered_force_has_no_known_noise_floor(cut: float) -> None:
    filtered = filtfilt(*butter(4, cut), FORCE_N + white(len(TIME_S), 1, 0.3))
    comparison = compare(MODEL, [run_with(filtered)])
    assert [f.kind for f in comparison.findings] == ["smooth_force"]


@pytest.mark.parametrize("noise_rms", [0.005, 0.3])
@pytest.mark.parametrize("step_n", [0.0, 0.02, 0.5])
def test_noise_or_converter_steps_are_a_known_noise_floor(noise_rms: float, step_n: float) -> None:
    force = FORCE_N + white(len(TIME_S), 2, noise_rms)
    comparison = compare(MODEL, [run_with(quantised(force, step_n) if step_n else force)])
    assert "smooth_force" not in {f.kind for f in comparison.findings}
    expected_n = np.hypot(noise_rms, step_n / np.sqrt(12.0))
    assert comparison.noise_rms == pytest.approx(expected_n, rel=0.35)


def test_noise_floor_is_that_of_the_runs_that_show_noise() -> None:
    noisy = replace(run_with(FORCE_N + white(len(TIME_S), 3, 0.1)), name="b")
    comparison = compare(MODEL, [run_with(FORCE_N), noisy])
    assert comparison.noise_rms == pytest.approx(0.1, rel=0.05)
