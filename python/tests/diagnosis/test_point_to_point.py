"""Diagnosis of an axis whose position controller holds it between moves."""

from jbf import Rig, diagnose
from point_to_point import TRUTH, point_to_point


def test_holding_force_between_moves_causes_neither_an_effect_nor_residual_structure() -> None:
    runs = point_to_point([6, 7], duration_s=12.0)
    found = diagnose(Rig(), runs, law="coulomb")
    assert (found.verdict, found.effects) == ("missing", ("inertia",)), found.summary()
    assert not found.residual_structure
    assert found.steps[-1].held_out_rms < 1.05 * 0.3
    for name, true in TRUTH.items():
        parameter = found.model.parameters[name]
        assert parameter.stderr is not None
        assert abs(parameter.value - true) < 3.0 * parameter.stderr, name
