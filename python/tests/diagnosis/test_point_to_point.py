"""Diagnosis of an axis whose position controller holds it between moves."""

import pytest
from jbf import Drive, Rig, Run, diagnose
from point_to_point import FORCE_NOISE_N, TRUTH, point_to_point


def test_holding_force_between_moves_causes_neither_an_effect_nor_residual_structure() -> None:
    runs = point_to_point([6, 7], duration_s=8.0)
    found = diagnose(Rig(), runs, law="coulomb")
    assert (found.verdict, found.effects) == ("missing", ("inertia",)), found.summary()
    assert not found.residual_structure
    assert found.steps[-1].held_out_rms < 1.05 * FORCE_NOISE_N
    for name, true in TRUTH.items():
        parameter = found.model.parameters[name]
        assert parameter.stderr is not None
        assert abs(parameter.value - true) < 3.0 * parameter.stderr, name


@pytest.mark.parametrize("seeds", [(6,), pytest.param((8, 9), marks=pytest.mark.extended)])
def test_lag_of_the_load_cell_is_not_attributed_to_the_motion(seeds: tuple[int, ...]) -> None:
    """A low-pass filter of six samples; without it, the errors of the acceleration seem large."""
    runs = [
        Run.from_arrays(run.time_s, None, run.friction, position_m=run.position_m, name=run.name)
        for run in point_to_point(seeds, duration_s=6.0, lag_s=0.012)
    ]
    found = diagnose(Rig(drive=Drive("linear", "force")), runs, law="coulomb")
    assert found.effects == ("sensor_lag",), found.summary()
    assert found.model.parameters["sensor_lag.tau_s"].value == pytest.approx(0.012, rel=0.15)
    for name, true in TRUTH.items():
        assert found.model.parameters[name].value == pytest.approx(true, rel=0.01), name
    # The estimate from the records alone takes jumps of the force for noise.
    assert found.steps[-1].noise_rms == pytest.approx(FORCE_NOISE_N, rel=0.05)
