"""Joint dynamics of robot descriptions and of Isaac Lab."""

import ast
import json
import xml.etree.ElementTree as ET

import jbf
import numpy as np
import pytest
from jbf import export
from joint_runs import AXIS, JOINT, joint_runs

COULOMB = {"F_c": 5.0, "F_s": 5.0, "F_v": 2.0}


def read(target: str, exported: export.Exported) -> dict[str, float]:
    """Values of the main file of an export, by the name of the field."""
    if target == "isaac":
        values: dict[str, float] = {}
        for node in ast.walk(ast.parse(exported.text)):
            if isinstance(node, ast.keyword) and isinstance(node.value, ast.Constant):
                values[str(node.arg)] = node.value.value
        return values
    (dynamics,) = ET.fromstring(exported.text).iter("dynamics")
    if target == "urdf":
        return {name: float(value) for name, value in dynamics.attrib.items()}
    return {element.tag: float(element.text or "nan") for element in dynamics}


@pytest.mark.parametrize("rig", [JOINT, AXIS])
@pytest.mark.parametrize("target", ["urdf", "sdf", "isaac"])
def test_coulomb_friction_is_exact(target: str, rig: jbf.Rig) -> None:
    model = jbf.Model(rig, "coulomb", parameters=COULOMB)
    exported = export.to(model, target, joint_runs(rig))
    dry, viscous = {"isaac": ("dynamic_friction", "viscous_friction")}.get(
        target, ("friction", "damping")
    )
    values = read(target, exported)
    assert (values[dry], values[viscous]) == (5.0, 2.0)
    assert exported.ledger.term("coulomb").status == "exact"
    assert exported.ledger.share < 1e-9


@pytest.mark.parametrize("target", ["urdf", "sdf", "isaac"])
def test_stribeck_friction_has_the_fitted_values_with_the_least_error(target: str) -> None:
    parameters = COULOMB | {"F_s": 8.0, "v_s": 0.1}
    model, runs = jbf.Model(JOINT, "stribeck", parameters=parameters), joint_runs()
    exported = export.to(model, target, runs)
    assert exported.ledger.term("stribeck").status == "approximate"
    velocity = np.concatenate([run.velocity for run in runs])
    moving = np.abs(velocity) > 1e-3
    force = np.concatenate([model.predict(run) for run in runs])[moving]
    columns = np.stack([np.sign(velocity), velocity], axis=1)[moving]
    _, squares, _, _ = np.linalg.lstsq(columns, force, rcond=None)
    least = np.sqrt(squares[0] / np.sum(force**2))
    assert exported.ledger.share == pytest.approx(least, rel=0.05)


def test_isaac_static_level_is_that_of_the_law_and_units_are_stated() -> None:
    parameters = COULOMB | {"F_s": 8.0, "v_s": 0.1, "inertia.m_e": 0.3}
    model = jbf.Model(JOINT, "stribeck", ["inertia"], parameters)
    exported = export.to(model, "isaac", joint_runs(), settings=export.Settings(joint="knee"))
    values = read("isaac", exported)
    assert values["friction"] == 8.0
    assert values["friction"] > values["dynamic_friction"]
    assert values["armature"] == 0.3
    described = json.loads(exported.files["_values.json"])
    assert {name: entry["value"] for name, entry in described.items()} == {
        name: values[name] for name in described
    }
    assert described["viscous_friction"]["unit"] == "N m s/rad"


@pytest.mark.parametrize("rig", [JOINT, AXIS])
def test_mujoco_reads_the_dynamics_of_the_urdf(rig: jbf.Rig) -> None:
    mujoco = pytest.importorskip("mujoco", reason="needs MuJoCo: pip install mujoco")
    model = jbf.Model(rig, "coulomb", parameters=COULOMB)
    exported = export.to(model, "urdf", joint_runs(rig))
    loaded = mujoco.MjModel.from_xml_string(exported.text)
    assert loaded.dof_frictionloss[0] == 5.0
    damping = np.ravel(loaded.dof_damping)[0]
    assert damping == 2.0


def test_mean_of_a_user_defined_effect_is_part_of_the_fitted_values() -> None:
    k = jbf.Parameter("k", "N", "level", lower=0.0, upper=10.0, null=0.0, starts=(1.0,))
    jbf.register_effect(
        lambda velocity, k: k * np.tanh(velocity / 1e-3), parameters=[k], name="packing"
    )
    try:
        model = jbf.Model(JOINT, "coulomb", ["packing"], COULOMB | {"packing.k": 1.5})
        exported = export.to(model, "urdf", joint_runs())
    finally:
        jbf.forget_effect("packing")
    assert read("urdf", exported)["friction"] == pytest.approx(6.5, rel=0.02)
    assert exported.ledger.term("packing").status == "approximate"


def test_isaac_law_with_a_fitted_level_is_approximate() -> None:
    values = COULOMB | {"F_s": 8.0, "presliding.sigma": 20.0}
    model = jbf.Model(JOINT, "coulomb", ["presliding"], values)
    ledger = export.to(model, "isaac", joint_runs()).ledger
    assert ledger.term("coulomb").status == "approximate"
    exact = jbf.Model(JOINT, "coulomb", parameters=COULOMB | {"F_s": 8.0})
    assert export.to(exact, "isaac", joint_runs()).ledger.term("coulomb").status == "exact"


@pytest.mark.parametrize(
    ("law", "effect", "values", "static"),
    [
        ("lugre", "coulomb_drag", {"sigma_0": 2e3, "coulomb_drag.F_d": 2.0}, 9.0),
        ("coulomb", "stribeck_excess", {"stribeck_excess.a": 1.5}, 8.5),
    ],
)
def test_isaac_static_level_contains_the_effects_that_add_to_it(
    law: str, effect: str, values: dict[str, float], static: float
) -> None:
    model = jbf.Model(JOINT, law, [effect], COULOMB | {"F_s": 7.0} | values)
    exported = export.to(model, "isaac", joint_runs(step_s=0.02))
    assert read("isaac", exported)["friction"] == static


def test_drag_whose_level_is_fitted_is_approximate() -> None:
    values = COULOMB | {"sigma_0": 2e3, "coulomb_drag.F_d": 2.0, "v_d": 100.0}
    model, runs = jbf.Model(JOINT, "lugre", ["coulomb_drag"], values), joint_runs(step_s=0.02)
    for target, status in (("urdf", "approximate"), ("mjcf", "exact")):
        assert export.to(model, target, runs).ledger.term("coulomb_drag").status == status


@pytest.mark.parametrize("joint", ["left-elbow", "1", 'a"b'])
def test_isaac_joint_that_is_not_an_identifier_is_refused(joint: str) -> None:
    model = jbf.Model(JOINT, "coulomb", parameters=COULOMB)
    settings = export.Settings(joint=joint)
    with pytest.raises(jbf.InputError, match="identifier"):
        export.to(model, "isaac", joint_runs(step_s=0.02), settings=settings)
