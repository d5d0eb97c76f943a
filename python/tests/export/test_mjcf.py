"""Elements of MuJoCo joints: their force along imposed and free motions in MuJoCo itself."""

import sys
import xml.etree.ElementTree as ET
from typing import Any

import jbf
import numpy as np
import pytest
from jbf import export
from jbf.export.reference import Reference
from joint_runs import AXIS, JOINT, joint_runs
from scipy.integrate import solve_ivp

DRY = {"F_c": 5.0, "F_s": 5.0, "F_v": 2.0}
STRIBECK = DRY | {"F_s": 8.0, "v_s": 0.1}
LUGRE = STRIBECK | {"sigma_0": 2e3, "sigma_1": 3.0}
SPRINGS = {"F_c": 5.0, "F_v": 2.0, "sigma_0": 2e3}
STEP_S = 0.0005

CASES = {
    "coulomb": ("coulomb", (), DRY),
    "drag_and_cogging": (
        "coulomb",
        ("quadratic_drag", "cogging", "cogging_2", "inertia"),
        DRY
        | {"quadratic_drag.c": 0.7, "inertia.m_e": 0.05}
        | {"cogging.A": 0.5, "cogging.pitch": 2 * np.pi / 7, "cogging.phase": 0.4}
        | {"cogging_2.A": 0.2, "cogging_2.pitch": 2 * np.pi / 14, "cogging_2.phase": 1.0},
    ),
    "presliding": ("coulomb", ("presliding",), DRY | {"presliding.sigma": 3e3}),
    "stribeck": ("stribeck", (), STRIBECK),
    "lugre": ("lugre", (), LUGRE | {"v_d": 100.0}),
    "decaying_damping": ("lugre", (), LUGRE | {"v_d": 0.1}),
    "dahl": ("dahl", (), SPRINGS),
    "maxwell_slip": ("maxwell_slip", (), SPRINGS),
    "elasto_plastic": ("elasto_plastic", (), SPRINGS),
    "thinning": ("coulomb", ("viscous_thinning",), DRY | {"viscous_thinning.w": 1.0}),
    "asymmetry": ("coulomb", ("dry_asymmetry",), DRY | {"dry_asymmetry.a": 0.2}),
}
EXACT = {
    "coulomb", "drag_and_cogging", "presliding", "lugre", "dahl", "maxwell_slip",
}  # fmt: skip


def model_of(name: str, rig: jbf.Rig = JOINT) -> jbf.Model:
    law, effects, values = CASES[name]
    return jbf.Model(rig, law, effects, values)


def mujoco() -> Any:
    return pytest.importorskip("mujoco", "4.0.0", reason="needs MuJoCo: pip install mujoco>=4.0")


def imposed(xml: str, reference: Reference) -> list[np.ndarray]:
    """Friction that MuJoCo computes along the motions of a reference."""
    engine, forces = mujoco(), []
    model = engine.MjModel.from_xml_string(xml)
    model.opt.timestep = STEP_S
    for run, velocity, position in zip(
        reference.runs, reference.velocity, reference.position, strict=True
    ):
        data = engine.MjData(model)
        time_s = np.arange(0.0, run.time_s[-1], STEP_S)
        v = np.interp(time_s, run.time_s, velocity)
        x = np.interp(time_s, run.time_s, position)
        force = np.empty(len(time_s))
        for k in range(len(time_s)):
            data.qpos[0], data.qvel[0] = x[k], v[k]
            engine.mj_forward(model, data)
            driven = data.qfrc_actuator[0]
            data.qacc[0] = 0.0
            engine.mj_inverse(model, data)
            force[k] = data.qfrc_inverse[0] - driven
            engine.mj_step(model, data)
        forces.append(np.interp(run.time_s, time_s, force))
    return forces


@pytest.mark.parametrize("name", CASES)
def test_ledger_states_the_error_that_mujoco_has_along_the_runs(name: str) -> None:
    mujoco()
    model, runs = model_of(name), joint_runs()[:1]
    exported = export.to(model, "mjcf", runs)
    reference = Reference.of(model, runs)
    error = reference.rms_error(imposed(exported.files["_test.xml"], reference))
    share = error / reference.friction_rms
    assert exported.ledger.evaluated_by.startswith("MuJoCo")
    assert share == pytest.approx(exported.ledger.share, rel=0.1, abs=1e-3)
    if name in EXACT:
        assert exported.ledger.term(model.law).status == "exact"
        assert exported.ledger.share < 1e-3
    else:
        assert {term.status for term in exported.ledger.terms} & {"approximate", "none"}


def test_sliding_axis_becomes_a_slide_joint_with_the_same_force() -> None:
    mujoco()
    model, runs = model_of("drag_and_cogging", AXIS), joint_runs(AXIS)[:1]
    exported = export.to(model, "mjcf", runs)
    reference = Reference.of(model, runs)
    error = reference.rms_error(imposed(exported.files["_test.xml"], reference))
    assert error < 1e-3 * reference.friction_rms


def test_free_motion_with_a_bristle_agrees_with_an_integration_of_the_law() -> None:
    engine = mujoco()
    inertia = 0.05
    values = LUGRE | {"v_d": 100.0, "inertia.m_e": inertia}
    model = jbf.Model(JOINT, "lugre", ["inertia"], values)
    exported = export.to(model, "mjcf", joint_runs())
    simulated = engine.MjModel.from_xml_string(exported.files["_test.xml"])
    simulated.opt.timestep = 1e-4
    data = engine.MjData(simulated)
    p = LUGRE

    def drive(t: float) -> float:
        return 12.0 * np.sin(3.0 * t)

    def slope(t: float, y: np.ndarray) -> list[float]:
        _, v, z = y
        level = p["F_c"] + (p["F_s"] - p["F_c"]) * np.exp(-((v / p["v_s"]) ** 2))
        z_rate = v - abs(v) * z * p["sigma_0"] / level
        friction = p["sigma_0"] * z + p["sigma_1"] * z_rate + p["F_v"] * v
        return [v, (drive(t) - friction) / inertia, z_rate]

    solution = solve_ivp(slope, (0.0, 2.0), [0.0, 0.0, 0.0], "LSODA", rtol=1e-8, atol=1e-10)
    for k in range(20000):
        data.qfrc_applied[0] = drive(1e-4 * k)
        engine.mj_step(simulated, data)
    travel = np.ptp(solution.y[0])
    assert travel > 0.5
    assert data.qpos[0] == pytest.approx(solution.y[0, -1], abs=0.01 * travel)


def test_joint_with_frictionloss_holds_half_of_its_friction_level() -> None:
    engine = mujoco()
    values = DRY | {"inertia.m_e": 0.05}
    exported = export.to(jbf.Model(JOINT, "coulomb", ["inertia"], values), "mjcf", joint_runs())
    model = engine.MjModel.from_xml_string(exported.files["_test.xml"])
    data = engine.MjData(model)
    data.qfrc_applied[0] = 2.5
    for _ in range(2000):
        engine.mj_step(model, data)
    assert 0.0 <= data.qvel[0] < 1e-4


def test_include_file_gives_its_values_to_a_joint_of_its_class(tmp_path: Any) -> None:
    engine = mujoco()
    exported = export.to(
        model_of("drag_and_cogging"), "mjcf", joint_runs(), settings=export.Settings(joint="elbow")
    )
    exported.save(tmp_path / "elbow.xml")
    robot = """<mujoco><include file="elbow.xml"/><worldbody><body>
      <joint name="elbow" class="elbow_friction" axis="0 1 0"/>
      <geom type="capsule" size="0.02" fromto="0 0 0 0.3 0 0"/></body></worldbody></mujoco>"""
    (tmp_path / "robot.xml").write_text(robot)
    model = engine.MjModel.from_xml_path(str(tmp_path / "robot.xml"))
    assert model.dof_frictionloss[0] == pytest.approx(5.0)
    assert model.dof_armature[0] == pytest.approx(0.05)
    assert model.nu == 0
    assert len(model.actuator_biasprm) == 2


@pytest.mark.parametrize(
    ("version", "absent"),
    [("3.3", {"dcmotor", "springyield"}), ("3.7.0", {"springyield"}), ("4.0", set())],
)
@pytest.mark.parametrize("name", ["lugre", "maxwell_slip", "drag_and_cogging"])
def test_older_version_of_mujoco_gets_no_elements_of_newer_ones(
    name: str, version: str, absent: set[str]
) -> None:
    settings = export.Settings(mujoco=version)
    exported = export.to(model_of(name), "mjcf", joint_runs(), settings=settings)
    for text in exported.files.values():
        root = ET.fromstring(text)
        words = {e.tag for e in root.iter()} | {key for e in root.iter() for key in e.attrib}
        assert not words & absent
        if version == "3.3":
            damping = [e.attrib["damping"] for e in root.iter() if "damping" in e.attrib]
            assert all(len(value.split()) == 1 for value in damping)


def test_yielding_springs_are_stated_to_be_wrong_with_rk4() -> None:
    exported = export.to(model_of("maxwell_slip"), "mjcf", joint_runs())
    assert any("RK4" in note for note in exported.ledger.notes)
    root = ET.fromstring(exported.files["_test.xml"])
    springs = root.findall("tendon/fixed")
    stiffness = [float(s.attrib["stiffness"]) for s in springs]
    levels = [float(s.attrib["springyield"]) * k for s, k in zip(springs, stiffness, strict=True)]
    assert (sum(stiffness), sum(levels)) == pytest.approx((2e3, 5.0), rel=1e-6)


@pytest.mark.parametrize(
    ("rig", "settings"),
    [
        (jbf.Rig.thesis(), export.Settings()),
        (jbf.Rig(drive=jbf.Drive("rotary", "voltage")), export.Settings()),
        (JOINT, export.Settings(mujoco="new")),
    ],
)
def test_rig_or_version_without_a_joint_form_is_refused(
    rig: jbf.Rig, settings: export.Settings
) -> None:
    runs = joint_runs(rig)
    with pytest.raises(jbf.InputError):
        export.to(jbf.Model(rig, "coulomb"), "mjcf", runs, settings=settings)


def test_without_mujoco_the_ledger_has_the_same_loss(monkeypatch: pytest.MonkeyPatch) -> None:
    mujoco()
    model, runs = model_of("decaying_damping"), joint_runs()[:1]
    measured = export.to(model, "mjcf", runs).ledger
    monkeypatch.setitem(sys.modules, "mujoco", None)
    computed = export.to(model, "mjcf", runs).ledger
    assert not computed.evaluated_by.startswith("MuJoCo")
    assert computed.share == pytest.approx(measured.share, abs=1e-3)


def statuses(exported: export.Exported) -> dict[str, str]:
    return {term.name: term.status for term in exported.ledger.terms}


def test_static_level_that_a_bristle_does_not_have_is_stated() -> None:
    values = {"F_c": 4.0, "F_s": 6.0, "F_v": 2.0, "presliding.sigma": 3e3}
    model = jbf.Model(JOINT, "coulomb", ["presliding"], values)
    found = statuses(export.to(model, "mjcf", joint_runs(step_s=0.02)))
    assert found == {"coulomb": "approximate", "presliding": "exact"}


def test_quadratic_drag_is_kept_where_a_dry_level_replaces_the_bristle() -> None:
    values = DRY | {"F_s": 5.3, "v_s": 0.3, "delta": 0.3, "quadratic_drag.c": 0.7}
    model = jbf.Model(JOINT, "stribeck", ["quadratic_drag"], values)
    exported = export.to(model, "mjcf", joint_runs(step_s=0.02))
    law = exported.ledger.term("stribeck")
    assert "lugre" not in exported.text
    assert law.values["damping_2"] == 0.7
    assert statuses(exported)["quadratic_drag"] == "approximate"


@pytest.mark.parametrize("v_s", [1e-3, 0.01])
def test_static_level_of_a_fitted_bristle_is_that_of_the_runs(v_s: float) -> None:
    values = {"F_c": 10.0, "F_s_inf": 3.0, "F_v": 10.0, "v_s": v_s}
    model = jbf.Model(JOINT, "seven_parameter", parameters=values)
    ledger = export.to(model, "mjcf", joint_runs(step_s=0.02)).ledger
    static = ledger.term("seven_parameter").values.get("lugre_static", 0.0)
    assert static < 1.05 * (10.0 + 3.0)
    assert ledger.share < 0.02
