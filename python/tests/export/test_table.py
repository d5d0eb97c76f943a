"""Tables of friction against speed, cogging maps, and the TwinCAT list."""

import re

import jbf
import numpy as np
import pytest
from jbf import export
from joint_runs import AXIS, JOINT, joint_runs

STRIBECK = {"F_c": 5.0, "F_s": 8.0, "v_s": 0.1, "F_v": 2.0}


def columns(text: str) -> dict[str, np.ndarray]:
    head, *rows = text.strip().split("\n")
    values = np.array([[float(cell) for cell in row.split(",")] for row in rows])
    return dict(zip(head.split(","), values.T, strict=True))


def test_table_of_stribeck_law_is_the_curve_at_its_points() -> None:
    model = jbf.Model(JOINT, "stribeck", parameters=STRIBECK)
    table = columns(export.to(model, "table", joint_runs()).text)
    speed, torque = table["velocity_rad_s"], table["torque_n_m"]
    assert len(speed) == 20
    assert np.all(np.diff(speed) > 0.0)
    assert torque == pytest.approx(model.steady_friction(speed), rel=0.01)


def test_more_points_reduce_the_error_between_the_points() -> None:
    model = jbf.Model(JOINT, "stribeck", parameters=STRIBECK | {"F_s": 12.0})
    speeds = np.geomspace(0.01, 1.5, 300)
    errors = []
    for points in (6, 10, 20):
        settings = export.Settings(points=points)
        table = columns(export.to(model, "table", joint_runs(), settings=settings).text)
        assert len(table["velocity_rad_s"]) <= points
        read = np.interp(speeds, table["velocity_rad_s"], table["torque_n_m"])
        errors.append(np.sqrt(np.mean((read - model.steady_friction(speeds)) ** 2)))
    assert errors[0] > 2.0 * errors[1] > 4.0 * errors[2]


def test_ledger_states_the_error_that_reading_the_table_has() -> None:
    model = jbf.Model(JOINT, "lugre", parameters=STRIBECK | {"sigma_0": 2e3, "sigma_1": 3.0})
    runs = joint_runs()
    exported = export.to(model, "table", runs)
    table = columns(exported.text)
    squares, total = 0.0, 0.0
    for run in runs:
        sliding = np.abs(run.velocity) > 1e-3
        force = model.predict(run)[sliding]
        read = np.interp(run.velocity, table["velocity_rad_s"], table["torque_n_m"])[sliding]
        squares, total = squares + np.sum((read - force) ** 2), total + np.sum(force**2)
    assert exported.ledger.share == pytest.approx(np.sqrt(squares / total), rel=0.1)
    assert exported.ledger.term("lugre").status == "approximate"


def test_asymmetric_friction_has_different_levels_in_both_directions() -> None:
    values = {"F_c": 5.0, "F_v": 1e-3, "dry_asymmetry.a": 0.2}
    model = jbf.Model(JOINT, "coulomb", ["dry_asymmetry"], values)
    table = columns(export.to(model, "table", joint_runs()).text)
    assert table["torque_n_m"][0] == pytest.approx(-4.0, rel=1e-2)
    assert table["torque_n_m"][-1] == pytest.approx(6.0, rel=1e-2)


def test_weight_inertia_and_sensor_are_not_part_of_table_or_loss() -> None:
    values = {"F_c": 5.0, "F_v": 2.0}
    more = {"gravity.G": 7.0, "inertia.m_e": 2.0, "sensor_offset.b": 1.0}
    plain = jbf.Model(JOINT, "coulomb", parameters=values)
    full = jbf.Model(JOINT, "coulomb", ["gravity", "inertia", "sensor_offset"], values | more)
    a, b = (export.to(model, "table", joint_runs()) for model in (plain, full))
    assert columns(a.text)["torque_n_m"] == pytest.approx(columns(b.text)["torque_n_m"])
    assert a.ledger.share == pytest.approx(b.ledger.share, rel=1e-6)
    assert {b.ledger.term(name).status for name in full.effects} == {"external"}


def test_cogging_map_is_the_wave_without_friction() -> None:
    values = {"F_c": 5.0, "cogging.A": 0.5, "cogging.pitch": 2 * np.pi / 7, "cogging.phase": 0.4}
    model = jbf.Model(JOINT, "coulomb", ["cogging"], values)
    exported = export.to(model, "table", joint_runs())
    cogging = columns(exported.files["_cogging.csv"])
    angle = cogging["angle_rad"]
    assert (angle[0], angle[-1]) == pytest.approx((0.0, 2 * np.pi))
    assert cogging["torque_n_m"] == pytest.approx(0.5 * np.sin(7 * angle - 0.4), abs=1e-9)
    without = export.to(jbf.Model(JOINT, "coulomb", parameters={"F_c": 5.0}), "table", joint_runs())
    assert exported.ledger.share == pytest.approx(without.ledger.share, rel=0.05)


def test_cogging_map_of_a_linear_axis_covers_the_range_of_the_runs() -> None:
    values = {"F_c": 5.0, "cogging.A": 0.5, "cogging.pitch": 0.03}
    runs = joint_runs(AXIS)
    exported = export.to(jbf.Model(AXIS, "coulomb", ["cogging"], values), "table", runs)
    position = columns(exported.files["_cogging.csv"])["position_m"]
    assert position[0] == pytest.approx(min(np.min(run.position_m) for run in runs), abs=1e-3)
    assert position[-1] == pytest.approx(max(np.max(run.position_m) for run in runs), abs=1e-3)


def test_drive_with_a_rated_torque_gets_percent_and_a_twincat_list() -> None:
    drive = jbf.Drive("rotary", "percent", rated_torque_n_m=2.0, gear_ratio=5.0)
    model = jbf.Model(jbf.Rig(drive=drive), "coulomb", parameters={"F_c": 5.0, "F_v": 2.0})
    exported = export.to(model, "table", joint_runs())
    table = columns(exported.text)
    assert table["percent"] == pytest.approx(table["torque_n_m"] / 10.0 * 100.0)
    text = exported.files["_twincat.lis"]
    entries = dict(line.split() for line in text.strip().split("\n"))
    count = int(entries["frict_comp.table_entries"])
    assert count <= 20
    pairs = [
        (int(entries[f"frict_comp.table[{i}].in"]), int(entries[f"frict_comp.table[{i}].out"]))
        for i in range(count)
    ]
    assert pairs[0] == (0, 0)
    speeds = [speed for speed, _ in pairs]
    assert speeds == sorted(set(speeds))
    for speed, level in pairs[1:]:
        # 0.001 deg/s and 0.1 % of 10 N m
        torque = 5.0 + 2.0 * np.deg2rad(1e-3 * speed)
        assert level == pytest.approx(torque / 10.0 * 1000.0, rel=0.01)
    assert re.search(r"frict_comp\.mode\s+3\n", text)


def test_drive_with_a_current_gets_amperes_and_no_twincat_list() -> None:
    drive = jbf.Drive("rotary", "current", torque_constant_n_m_a=0.05, gear_ratio=100.0)
    model = jbf.Model(jbf.Rig(drive=drive), "coulomb", parameters={"F_c": 5.0, "F_v": 2.0})
    exported = export.to(model, "table", joint_runs())
    table = columns(exported.text)
    assert table["current_a"] == pytest.approx(table["torque_n_m"] / 5.0)
    assert set(exported.files) == {""}


def test_load_and_temperature_dependence_have_the_values_at_the_medians() -> None:
    names = ["dry_load_dependence", "dry_temperature_dependence"]
    values = {
        "F_c": 5.0,
        "F_v": 1e-3,
        "dry_load_dependence.mu": 0.1,
        "dry_temperature_dependence.a_1_k": -0.01,
        "dry_temperature_dependence.T_0_c": 40.0,
    }
    model = jbf.Model(JOINT, "coulomb", names, values)
    (run, _) = joint_runs()
    n = len(run)
    loaded = jbf.Run.from_arrays(
        run.time_s, run.velocity, load_n=np.full(n, 20.0), temperature_c=np.full(n, 50.0)
    )
    table = columns(export.to(model, "table", [loaded]).text)
    constant = model.predict(loaded)[np.argmax(run.velocity)]
    assert table["torque_n_m"][-1] == pytest.approx(constant, rel=1e-2)


@pytest.mark.parametrize("points", [3, 0, 5000])
def test_number_of_points_out_of_range_is_refused(points: int) -> None:
    model = jbf.Model(JOINT, "coulomb")
    with pytest.raises(jbf.InputError, match="points"):
        export.to(model, "table", joint_runs(), settings=export.Settings(points=points))


def test_twincat_list_of_a_long_table_extends_to_its_fastest_speed() -> None:
    drive = jbf.Drive("rotary", "percent", rated_torque_n_m=2.0, gear_ratio=5.0)
    values = {"F_c": 5.0, "F_s": 8.0, "v_s": 0.1, "F_v": 2.0}
    model, runs = jbf.Model(jbf.Rig(drive=drive), "stribeck", parameters=values), joint_runs()
    exported = export.to(model, "table", runs, settings=export.Settings(points=100))
    entries = dict(line.split() for line in exported.files["_twincat.lis"].strip().split("\n"))
    count = int(entries["frict_comp.table_entries"])
    assert count <= 20
    fastest = float(columns(exported.text)["velocity_rad_s"][-1])
    last = int(entries[f"frict_comp.table[{count - 1}].in"])
    assert last == round(1e3 * np.rad2deg(fastest))
    level = int(entries[f"frict_comp.table[{count - 1}].out"])
    assert level == pytest.approx(100.0 * (5.0 + 2.0 * fastest), rel=0.01)
