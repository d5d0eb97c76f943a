"""Voltage in the place of a torque, coast-downs without a force, steady states without a time.

The machines are simulated here by their equations of motion, with SciPy's integrator or in closed
form; no model of the package takes part.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from jbf import diagnose, fit, import_files
from jbf.cli import main
from jbf.errors import InputError
from jbf.importing.cutting.settings import CutSettings
from jbf.importing.formats.table import Options
from jbf.importing.mapping import Map
from jbf.records.drive import Drive
from scipy.integrate import solve_ivp

INERTIA, COULOMB, VISCOUS, WEIGHT = 0.012, 0.08, 0.004, 0.6


def written(path: Path, header: str, *columns: np.ndarray) -> Path:
    np.savetxt(path, np.column_stack(columns), "%.6g", ",", header=header, comments="")
    return path


def swings(folder: Path, starts_rad: list[float], seed: int) -> list[Path]:
    """Free swings of a pendulum with dry and viscous friction; an encoder records degrees."""
    rng = np.random.default_rng(seed)

    def slopes(_: float, state: np.ndarray) -> list[float]:
        angle, speed = state
        friction = COULOMB * np.tanh(speed / 1e-3) + VISCOUS * speed
        return [speed, -(friction + WEIGHT * np.sin(angle)) / INERTIA]

    time = np.arange(0.0, 4.0, 0.002)
    files = []
    for number, start in enumerate(starts_rad):
        solution = solve_ivp(slopes, (0.0, 4.0), [start, 0.0], "LSODA", time, rtol=1e-8, atol=1e-9)
        angle = np.degrees(solution.y[0] + 2e-4 * rng.standard_normal(len(time)))
        name = folder / f"swing{number}.csv"
        files.append(written(name, "time [s],angle [deg]", time, angle))
    return files


def coast_map() -> Map:
    return Map(
        columns={"time_s": "time [s]", "angle_rad": "angle [deg]"},
        rig={"drive": {"motion": "rotary", "friction": "none", "inertia_kg_m2": INERTIA}},
    )


def test_friction_and_weight_are_recovered_from_a_free_swing_without_a_force(
    tmp_path: Path,
) -> None:
    files = swings(tmp_path, [1.5, -1.2, 2.0, -1.8], seed=21)
    found = import_files(files, coast_map())
    result = diagnose(found.rig, found.runs, law="coulomb")
    assert result.verdict == "adequate"
    assert result.machine == ("gravity",)
    parameters = result.model.parameters
    for name, true in {"F_c": COULOMB, "F_v": VISCOUS, "gravity.G": WEIGHT}.items():
        parameter = parameters[name]
        assert abs(parameter.value - true) < max(4.0 * parameter.stderr, 0.01 * true), name


def test_import_of_a_record_without_force_asks_only_for_the_inertia(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (file,) = swings(tmp_path, [1.0], seed=3)
    assert main(["import", str(file)]) == 0
    text = (tmp_path / "map.toml").read_text()
    assert text.count('= "?"') == 1
    assert 'inertia_kg_m2 = "?"' in text


def test_coast_down_without_a_known_mass_is_refused() -> None:
    with pytest.raises(InputError, match="mass_kg"):
        Drive("linear", "none")


def motor(rng: np.random.Generator) -> np.ndarray:
    """Time (s), voltage (V), angle (rad), speed (rad/s) of a motor, shape (n, 4).

    kS = 0.25 V, kV = 0.12 V s/rad and kA = 0.015 V s^2/rad; 50 Euler steps a sample.
    """
    step, k_s, k_v, k_a = 0.005, 0.25, 0.12, 0.015
    time = np.arange(0.0, 12.0, step)
    voltage = 6.0 * np.sin(0.8 * time) + 3.0 * np.sin(2.3 * time)
    speed, angle = np.zeros(len(time)), np.zeros(len(time))
    for i in range(1, len(time)):
        v, x = speed[i - 1], angle[i - 1]
        parts = 50
        for _ in range(parts):
            push = voltage[i - 1] - k_v * v
            if v == 0.0 and abs(push) <= k_s:
                continue
            direction = np.sign(v) if v != 0.0 else np.sign(push)
            after = v + (push - k_s * direction) / k_a * step / parts
            v = 0.0 if v * after < 0.0 else after
            x += v * step / parts
        speed[i], angle[i] = v, x
    return np.column_stack([time, voltage, angle, speed + 0.01 * rng.standard_normal(len(time))])


def test_parameters_fitted_to_a_motor_voltage_are_feedforward_constants_in_volts(
    tmp_path: Path,
) -> None:
    log = motor(np.random.default_rng(8))
    header = "time [s],motor voltage [V],position [rad],velocity [rad/s]"
    found = import_files(written(tmp_path / "log.csv", header, *log.T))
    assert found.rig.drive is not None
    assert found.rig.drive.friction == "voltage"
    result = fit(found.rig, found.runs, ["inertia"], law="coulomb")
    values = {name: p.value for name, p in result.parameters.items()}
    assert values["F_c"] == pytest.approx(0.25, rel=0.02)
    assert values["F_v"] == pytest.approx(0.12, rel=0.01)
    assert values["inertia.m_e"] == pytest.approx(0.015, rel=0.02)
    text = result.report()
    assert "V s/rad" in text
    assert "V s^2/rad" in text
    assert "N m" not in text


def test_voltage_column_is_ignored_if_a_torque_is_recorded(tmp_path: Path) -> None:
    log = motor(np.random.default_rng(9))
    header = "time [s],motor voltage [V],position [rad],velocity [rad/s],torque [Nm]"
    file = written(tmp_path / "log.csv", header, *log.T, 0.1 * log[:, 1])
    found = import_files(file)
    assert found.rig.drive is not None
    assert found.rig.drive.friction == "torque"
    assert "voltage_v" not in found.runs[0].columns()


def stribeck_table(path: Path, rng: np.random.Generator) -> Path:
    """Stribeck curve in rpm, N m: F_c = 0.5, F_s = 0.9, v_s = 3 rad/s, delta = 2, F_v = 0.01."""
    rpm = np.geomspace(1.0, 1000.0, 24)
    rpm = np.concatenate([rpm, -rpm])
    speed = rpm * np.pi / 30.0
    torque = np.sign(speed) * (0.5 + 0.4 * np.exp(-((speed / 3.0) ** 2))) + 0.01 * speed
    torque += 0.005 * rng.standard_normal(len(speed))
    return written(path, "speed [rpm],torque [Nm]", rpm, torque)


def test_stribeck_curve_is_recovered_from_imported_rows_without_time(
    tmp_path: Path,
) -> None:
    file = stribeck_table(tmp_path / "curve.csv", np.random.default_rng(4))
    assert main(["import", str(file)]) == 0
    map_file = tmp_path / "map.toml"
    map_file.write_text(map_file.read_text().replace("# [file]", "[file]\nsteady = true"))
    found = import_files(file, map_file, out=tmp_path / "curve")
    result = fit(found.rig, found.runs, law="stribeck")
    true = {"F_c": 0.5, "F_s": 0.9, "v_s": 3.0, "F_v": 0.01}
    for name, value in true.items():
        parameter = result.parameters[name]
        assert abs(parameter.value - value) < 4.0 * parameter.stderr, name
        assert parameter.stderr < 0.05 * value, name


def test_law_without_memory_is_selected_and_adequate_for_steady_states(tmp_path: Path) -> None:
    file = stribeck_table(tmp_path / "curve.csv", np.random.default_rng(5))
    columns = {"speed_rpm": "speed [rpm]", "torque_n_m": "torque [Nm]"}
    rig = {"drive": {"motion": "rotary", "friction": "torque"}}
    found = import_files(file, Map(columns=columns, rig=rig, options=Options(steady=True)))
    result = diagnose(found.rig, found.runs, law="auto")
    assert result.model.law == "stribeck"
    assert result.verdict == "adequate"
    assert "inertia" in result.not_tried


def test_friction_proportional_to_the_transmitted_torque_is_identified(tmp_path: Path) -> None:
    rng = np.random.default_rng(6)
    time = np.arange(0.0, 60.0, 0.01)
    speed = 2.0 * np.sin(2.0 * time)
    load = np.where(time < 20.0, 2.0, np.where(time < 40.0, 6.0, 10.0))
    torque = np.sign(speed) * (0.2 + 0.05 * load) + 0.01 * rng.standard_normal(len(time))
    header = "time [s],speed [rad/s],torque [Nm],load torque [Nm]"
    file = written(tmp_path / "gear.csv", header, time, speed, torque, load)
    found = import_files(file)
    assert "load_n_m" in found.runs[0].columns()
    result = diagnose(found.rig, found.runs, law="coulomb")
    assert result.model.effects == ("dry_load_dependence",)
    assert result.steps[-1].held_out_rms < 0.0105


def test_fit_of_steady_states_does_not_depend_on_their_order(tmp_path: Path) -> None:
    file = stribeck_table(tmp_path / "curve.csv", np.random.default_rng(7))
    header, *rows = file.read_text().splitlines()
    shuffled = tmp_path / "shuffled.csv"
    order = np.random.default_rng(8).permutation(len(rows))
    shuffled.write_text("\n".join([header, *(rows[i] for i in order)]) + "\n")
    columns = {"speed_rpm": "speed [rpm]", "torque_n_m": "torque [Nm]"}
    rig = {"drive": {"motion": "rotary", "friction": "torque"}}
    mapping = Map(columns=columns, rig=rig, options=Options(steady=True))
    one, other = (
        fit(found.rig, found.runs, law="stribeck")
        for found in (import_files(file, mapping), import_files(shuffled, mapping))
    )
    assert one.noise_floor == pytest.approx(other.noise_floor)
    assert one["F_c"].value == pytest.approx(other["F_c"].value, rel=1e-6)


def test_steady_states_are_not_cut_at_rests_or_cycles(tmp_path: Path) -> None:
    file = stribeck_table(tmp_path / "curve.csv", np.random.default_rng(9))
    columns = {"speed_rpm": "speed [rpm]", "torque_n_m": "torque [Nm]"}
    rig = {"drive": {"motion": "rotary", "friction": "torque"}}
    cut = CutSettings(by=("cycles",))
    mapping = Map(columns=columns, rig=rig, options=Options(steady=True), cut=cut)
    with pytest.raises(InputError, match="steady states"):
        import_files(file, mapping)


def test_backlash_is_not_tried_in_a_diagnosis_of_a_free_swing(tmp_path: Path) -> None:
    files = swings(tmp_path, [1.5], seed=22)
    found = import_files(files, coast_map())
    result = diagnose(found.rig, found.runs, law="coulomb")
    assert "backlash" in result.not_tried
    assert "backlash" not in result.effects


def test_model_file_of_a_voltage_driven_motor_has_coefficients_in_volts(tmp_path: Path) -> None:
    log = motor(np.random.default_rng(10))
    header = "time [s],motor voltage [V],position [rad],velocity [rad/s]"
    found = import_files(written(tmp_path / "log.csv", header, *log.T))
    fit(found.rig, found.runs, law="coulomb").model.save(tmp_path / "m.toml")
    lines = (tmp_path / "m.toml").read_text().splitlines()
    units = {line.partition(" = ")[0]: line.partition(" # ")[2] for line in lines}
    assert (units["F_c"], units["F_v"]) == ("V", "V s/rad")


@pytest.mark.extended
def test_standard_errors_of_a_free_swing_contain_the_errors_of_its_acceleration(
    tmp_path: Path,
) -> None:
    standardised = []
    for seed in (31, 33, 36):
        found = import_files(swings(tmp_path, [1.5, -1.2, 2.0, -1.8], seed), coast_map())
        result = fit(found.rig, found.runs, ["gravity"], law="coulomb")
        for name, true in {"F_c": COULOMB, "F_v": VISCOUS}.items():
            parameter = result.parameters[name]
            standardised.append((parameter.value - true) / parameter.stderr)
    assert np.sqrt(np.mean(np.square(standardised))) < 1.6
