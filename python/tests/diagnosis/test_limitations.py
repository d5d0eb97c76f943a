"""Conclusions that the motions do not support: one direction, few speeds, no sliding."""

import numpy as np
import pytest
from jbf import Policy, Rig, Run
from jbf.diagnosis.verdict import limitations
from jbf.estimation.campaign import Campaign

TIME_S = 0.01 * np.arange(1200)


def limitations_text(speed: np.ndarray, **parameters: float) -> str:
    force = 3.0 * np.sign(speed) + 5.0 * speed
    force = force + 0.05 * np.random.default_rng(1).normal(size=len(speed))
    campaign = Campaign.prepare(Rig(), [Run.from_arrays(TIME_S, speed, force, name="run")])
    return " ".join(limitations(campaign, parameters, Policy()))


def to_and_fro(low: float, high: float) -> np.ndarray:
    """Strokes at constant speeds from low to high in both directions."""
    speeds = np.geomspace(low, high, 12) * (-1.0) ** np.arange(12)
    return np.repeat(speeds, 100)


@pytest.mark.parametrize(("sign", "expected"), [(1.0, True), (-1.0, True), (0.0, False)])
def test_motion_in_one_direction_is_reported_as_a_limitation(sign: float, expected: bool) -> None:
    speed = to_and_fro(0.001, 0.2)
    speed = sign * np.abs(speed) if sign else speed
    assert ("one direction" in limitations_text(speed)) == expected


@pytest.mark.parametrize(
    ("high", "expected"), [(0.0011, "hardly changes"), (0.005, "less than a decade"), (0.2, "")]
)
def test_narrow_range_of_speeds_is_reported_as_a_limitation(high: float, expected: str) -> None:
    found = limitations_text(to_and_fro(0.001, high))
    assert expected in found
    assert bool(found) == bool(expected)


@pytest.mark.parametrize(("stiffness", "expected"), [(1.0e2, True), (1.0e6, False)])
def test_strokes_within_the_presliding_displacement_are_reported_as_a_limitation(
    stiffness: float, expected: bool
) -> None:
    found = limitations_text(to_and_fro(0.001, 0.2), F_c=3.0, sigma_0=stiffness)
    assert ("presliding" in found) == expected
