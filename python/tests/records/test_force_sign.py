"""A friction force with the wrong sign, which drives the motion instead of opposing it."""

from typing import Any

import numpy as np
import pytest
from jbf import Rig, Run
from jbf.estimation.prepared import Prepared
from jbf.records.findings.finding import Finding
from jbf.records.findings.force_sign import find_wrong_sign
from jbf.records.motion.estimated_motion import EstimatedMotion
from known_motions import Array, white

SAMPLES = 2000
TIME_S: Any = 0.01 * np.arange(SAMPLES)
SPEED_M_S: Any = 0.1 * np.sin(2.3 * TIME_S + 0.2)
NOISE = white(SAMPLES, 1)
LONG_S: Any = 0.02 * np.arange(3000)
MOTIONS = (0.1, pytest.param(0.7, marks=pytest.mark.extended), 6.0)
"""Angular frequencies of slow, typical and fast motions, 1/s."""


def exact_motion(speed: Array, sign_known: Any = True) -> EstimatedMotion:
    """A motion with known speed, acceleration and path."""
    a, path, error = np.gradient(speed, 0.01), np.cumsum(speed) * 0.01, np.zeros(len(speed))
    sign_known = np.broadcast_to(sign_known, len(speed)).copy()
    return EstimatedMotion(speed, a, path, error, error > 0.0, sign_known)


def findings_of(push: float, v: Any = SPEED_M_S, sign_known: Any = True, usable: Any = True) -> Any:
    """Findings of a force that opposes the motion by `push`, with offset, mass and spring."""
    motion = exact_motion(v, sign_known)
    force = push * np.sign(v) + 3.0 + 0.2 * motion.acceleration - 5.0 * motion.angle_rad
    run = Run.from_arrays(TIME_S, v, force + 0.1 * NOISE)
    return find_wrong_sign(run, motion, np.broadcast_to(usable, SAMPLES).copy())


def test_friction_that_drives_the_motion_is_reported_with_its_size() -> None:
    (finding,) = findings_of(-2.0)
    assert finding.size == pytest.approx(-2.0, abs=0.05)
    assert (finding.kind, finding.channel, finding.unit) == ("sign", "friction_n", "N")
    assert findings_of(2.0) == findings_of(0.0) == []


@pytest.mark.parametrize("samples", [300, 2000])
@pytest.mark.parametrize(("of_limit", "found"), [(0.98, False), (1.02, True)])
def test_driving_force_is_reported_beyond_8_standard_errors_and_0_3_of_spread(
    samples: int, of_limit: float, found: bool
) -> None:
    """The standard error is the jackknife over twelve parts, computed here by dense least squares.

    The limit is the standard error in the short record, and the spread of the force in the long
    one, to which the force of a mass is added.
    """
    speed = SPEED_M_S[:samples]
    motion = exact_motion(speed)
    moving = np.abs(speed) > 0.02 * np.max(np.abs(speed))
    terms = (np.sign(speed), np.ones(samples), motion.acceleration, motion.angle_rad)
    design = np.stack(terms, axis=1)[moving]
    force = NOISE[:samples][moving]
    if samples == 2000:
        force = 0.1 * force + design[:, 2] / np.std(design[:, 2])
    part = np.arange(len(force)) * 12 // len(force)

    def push_of(kept: Any) -> float:
        return float(np.linalg.lstsq(design[kept], force[kept], rcond=None)[0][0])

    push = push_of(slice(None))
    error = float(np.std([push_of(part != k) for k in range(12)])) * np.sqrt(11.0)
    added = 0.0
    for _ in range(60):
        # The added force increases the spread, so that the limit is iterated.
        spread = float(np.std(force + added * design[:, 0]))
        added = -of_limit * max(8.0 * error, 0.3 * spread) - push
    assert (8.0 * error > 0.3 * spread) == (samples == 300)
    all_forces = np.zeros(samples)
    all_forces[moving] = force + added * design[:, 0]
    run = Run.from_arrays(TIME_S[:samples], speed, all_forces)
    assert (find_wrong_sign(run, motion, np.ones(samples, dtype=bool)) != []) == found


def test_driving_force_is_reported_only_with_100_usable_samples_of_known_sign() -> None:
    few = np.zeros(SAMPLES, dtype=bool)
    few[np.linspace(0, SAMPLES - 1, 95).astype(int)] = True
    assert findings_of(-2.0, sign_known=few) == findings_of(-2.0, usable=few) == []
    few[np.linspace(5, SAMPLES - 5, 40).astype(int)] = True
    assert findings_of(-2.0, sign_known=few) != []


def test_driving_force_is_reported_only_with_enough_samples_in_both_directions() -> None:
    for forward, sizes in ((0.65, [pytest.approx(-2.0, abs=0.03)]), (0.85, [])):
        way = np.where(np.arange(SAMPLES) < forward * SAMPLES, 0.1, -0.1)
        findings = findings_of(-2.0, way + 0.02 * np.sin(9.0 * TIME_S))
        assert [finding.size for finding in findings] == sizes


def prepared_findings(force: Array, speed: Array) -> list[Finding]:
    run = Run.from_arrays(LONG_S, speed + white(3000, 2, 1e-5), force + white(3000, 1, 0.3))
    return list(Prepared.of(Rig(), run).examined.findings)


def stribeck(omega: float) -> tuple[Array, Array, Array]:
    """Speed, friction and acceleration of a sinusoidal motion with a Stribeck curve."""
    v: Array = 0.1 * np.sin(omega * LONG_S + 0.2)
    friction = np.tanh(v / 1e-3) * (5.0 + 3.0 * np.exp(-np.abs(v) / 0.02)) + 10.0 * v
    return v, friction, 0.1 * omega * np.cos(omega * LONG_S + 0.2)


@pytest.mark.parametrize("omega", MOTIONS)
@pytest.mark.parametrize("size", [0.2, 5.0])
def test_wrong_sign_of_stribeck_friction_is_detected_at_any_speed(
    omega: float, size: float
) -> None:
    v, friction, _ = stribeck(omega)
    assert prepared_findings(size * friction, v) == []
    (finding,) = prepared_findings(-size * friction, v)
    assert (finding.kind, finding.channel) == ("sign", "friction_n")
    assert finding.size == pytest.approx(-5.5 * size, rel=0.3)


@pytest.mark.parametrize("omega", MOTIONS)
def test_weight_inertia_and_spring_forces_are_not_reported_as_wrong_sign(omega: float) -> None:
    v, friction, a = stribeck(omega)
    path = np.cumsum(v) * 0.02
    for other in (50.0, -80.0 * a / np.std(a), 80.0 * a / np.std(a), -400.0 * path):
        assert prepared_findings(0.02 * friction + other, v) == []


def test_unidirectional_motion_or_random_walk_noise_has_no_wrong_sign_finding() -> None:
    v = 0.05 + 0.03 * np.sin(0.7 * LONG_S)
    assert prepared_findings(-8.0 - 10.0 * v, v) == []
    random_walk = 0.05 * np.cumsum(white(3000, 0))
    assert prepared_findings(random_walk, stribeck(0.7)[0]) == []
