"""Samples at standstill, where friction balances the force of a position controller."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from jbf import Model, Rig, Run, compare, fit
from jbf.records.motion.estimated_motion import estimate_motion
from point_to_point import BREAKAWAY_N, COULOMB_N, TRUTH, point_to_point


@pytest.mark.parametrize(
    ("law", "effects", "options"),
    [
        pytest.param("coulomb", ["inertia"], {}, marks=pytest.mark.extended),
        pytest.param("stribeck", ["inertia"], {}, marks=pytest.mark.extended),
        ("coulomb", ["inertia", "sensor_offset"], {"bias_n": 5.0}),
        pytest.param("coulomb", ["inertia"], {"integral_1_s": 8.0}, marks=pytest.mark.extended),
    ],
    ids=["held", "held, stribeck", "held against a load", "creeping under an integral controller"],
)
def test_sliding_parameters_are_recovered_if_a_controller_holds_between_moves(
    law: str, effects: list[str], options: Any
) -> None:
    found = fit(Rig(), point_to_point([1, 2, 3], **options), effects, law=law)
    for name, true in TRUTH.items():
        parameter = found.parameters[name]
        assert parameter.stderr is not None
        assert abs(parameter.value - true) < 3.0 * parameter.stderr, name
        assert parameter.stderr < 0.01 * true, name
    # The expected residual is white noise of 0.3 N.
    assert found.rms == pytest.approx(0.3, rel=0.05)


def held_with(run: Run, force_n: float) -> Run:
    """The run with a different holding force at rest."""
    assert run.friction is not None
    resting = estimate_motion(run, None).resting
    assert 0.2 < np.mean(resting) < 0.8
    return replace(run, friction=np.where(resting, force_n, 0.0) + run.friction)


@pytest.mark.parametrize("force_n", [-2.0, pytest.param(0.5, marks=pytest.mark.extended)])
def test_holding_force_changes_neither_the_fit_nor_the_residual(force_n: float) -> None:
    runs = point_to_point([4, 5], duration_s=10.0)
    others = [held_with(run, force_n) for run in runs]
    one, other = (fit(Rig(), each, ["inertia"], law="coulomb") for each in (runs, others))
    for name, parameter in one.parameters.items():
        assert other.parameters[name].value == pytest.approx(parameter.value, rel=1e-6), name
    model = Model(Rig(), "coulomb", ["inertia"], {**TRUTH, "F_s": BREAKAWAY_N})
    left, again = compare(model, runs), compare(model, others)
    assert again.rms == pytest.approx(left.rms) == pytest.approx(0.3, rel=0.05)
    assert left.rms < 0.1 * COULOMB_N
    assert not again.failures
