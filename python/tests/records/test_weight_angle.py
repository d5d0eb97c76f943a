"""The angle of a link that turns with several joints: its column and the weight over it."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import jbf
import numpy as np
import pytest
from jbf.importing.import_files import import_files
from jbf.importing.mapping import Map

RIG = jbf.Rig(drive=jbf.Drive("rotary", "torque"))
TIME_S = np.arange(0.0, 30.0, 0.01)
COULOMB, WEIGHT, HANGS_RAD, NOISE = 3.0, 5.0, 0.7, 0.05


def arm_rows(seed: int) -> Iterator[np.ndarray]:
    """Time, angles of two joints, speed and torque of the second one, whose link is weighed."""
    shoulder = 0.9 * np.sin((0.41 + 0.1 * seed) * TIME_S + seed)
    elbow = 1.1 * np.sin(0.8 * TIME_S)
    speed = 0.88 * np.cos(0.8 * TIME_S)
    noise = NOISE * np.random.default_rng(seed).standard_normal(len(TIME_S))
    weight = WEIGHT * np.sin(shoulder + elbow - HANGS_RAD)
    yield from (TIME_S, shoulder, elbow, speed, COULOMB * np.sign(speed) + weight + noise)


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    """A folder of two runs whose link angle is that of both joints."""
    for seed in range(2):
        time_s, shoulder, elbow, speed, torque = arm_rows(seed)
        columns = (time_s, elbow, speed, torque, shoulder + elbow)
        header = "time_s,angle_rad,velocity_rad_s,torque_n_m,weight_angle_rad"
        np.savetxt(tmp_path / f"{seed}.csv", np.transpose(columns), "%.9g", ",", header=header,
                   comments="")  # fmt: skip
    return tmp_path


def fitted(runs: list[jbf.Run]) -> jbf.Fit:
    return jbf.fit(RIG, runs, ["gravity"], law="coulomb")


def test_weight_over_the_sum_of_two_joint_angles_is_recovered(arm: Path) -> None:
    runs = jbf.read_runs(arm, RIG)
    fit = fitted(runs)
    assert fit.rms < 1.1 * NOISE, fit.report()
    assert fit.parameters["F_c"].value == pytest.approx(COULOMB, rel=0.01)
    assert fit.parameters["gravity.G"].value == pytest.approx(WEIGHT, rel=0.01)
    angle = fit.parameters["gravity.theta_0_rad"].value
    assert np.angle(np.exp(1j * (angle - HANGS_RAD))) == pytest.approx(0.0, abs=0.01)
    over_joint = fitted([replace(run, extra={}) for run in runs])
    assert over_joint.rms > 10.0 * fit.rms


def test_fit_is_unchanged_if_the_weight_angle_restarts_each_turn(arm: Path) -> None:
    runs = jbf.read_runs(arm, RIG)
    wrapped = [
        replace(run, extra={"weight_angle_rad": np.angle(np.exp(1j * a))})
        for run in runs
        for a in run.extra.values()
    ]
    assert fitted(wrapped).rms == pytest.approx(fitted(runs).rms, rel=1e-6)


@pytest.mark.parametrize("effects", [["gravity"], ["gravity", "time_delay"]])
def test_prediction_is_unchanged_if_the_weight_angle_restarts_each_turn(effects: list[str]) -> None:
    values = {"gravity.G": WEIGHT, "time_delay.tau_s": 0.033}
    kept = {name: v for name, v in values.items() if name.split(".")[0] in effects}
    model = jbf.Model(RIG, law="coulomb", effects=effects, parameters=kept)
    angle, speed = 1.1 * np.sin(0.8 * TIME_S), 0.88 * np.cos(0.8 * TIME_S)
    link = angle + 4.0 * np.sin(0.4 * TIME_S)
    turned, restarting = (
        jbf.Run.from_arrays(TIME_S, speed, angle_rad=angle, extra={"weight_angle_rad": a})
        for a in (link, np.angle(np.exp(1j * link)))
    )
    np.testing.assert_allclose(model.predict(restarting), model.predict(turned), atol=1e-9)


def test_import_map_defines_the_weight_angle_by_an_expression(tmp_path: Path) -> None:
    file = tmp_path / "arm.csv"
    header = "t [s],q2 [deg],q3 [deg],dq3 [rad/s],tau3 [N m]"
    time_s, shoulder, elbow, speed, torque = arm_rows(0)
    rows = np.transpose([time_s, np.degrees(shoulder), np.degrees(elbow), speed, torque])
    np.savetxt(file, rows, "%.9g", ",", header=header, comments="")
    columns = {
        "time_s": "t",
        "angle_rad": "q3",
        "velocity_rad_s": "dq3",
        "torque_n_m": "tau3",
        "weight_angle_rad": "q2 + q3",
    }
    drive = {"motion": "rotary", "friction": "torque"}
    (run,) = import_files(file, Map(columns, rig={"drive": drive}), whole=True).runs
    assert run.extra["weight_angle_rad"] == pytest.approx(shoulder + elbow, abs=1e-6)


def test_runs_with_and_without_weight_angle_are_refused_together(arm: Path) -> None:
    first, second = jbf.read_runs(arm, RIG)
    with pytest.raises(jbf.InputError, match="weight_angle_rad") as error:
        fitted([first, replace(second, extra={})])
    assert error.value.file == str(second.path)


@pytest.mark.parametrize("known", [True, False])
def test_prediction_over_another_angle_than_that_of_the_fit_is_refused(
    arm: Path, known: bool
) -> None:
    with_angle = jbf.read_runs(arm, RIG)
    without = [replace(run, extra={}) for run in with_angle]
    runs, others = (with_angle, without) if known else (without, with_angle)
    fitted(runs).model.save(arm / "model.toml")
    model = jbf.Model.load(arm / "model.toml")
    assert len(model.predict(runs[0])) == len(TIME_S)
    with pytest.raises(jbf.InputError, match="weight_angle_rad") as error:
        model.predict(others[0])
    assert error.value.file == str(others[0].path)


def test_bad_cell_of_the_weight_angle_is_reported_with_its_row(arm: Path) -> None:
    file = arm / "0.csv"
    lines = file.read_text().splitlines()
    lines[4] = lines[4].rsplit(",", 1)[0] + ",north"
    file.write_text("\n".join(lines) + "\n")
    with pytest.raises(jbf.InputError, match="weight_angle_rad") as error:
        jbf.read_run(file, RIG)
    assert error.value.row == 5


def test_slide_with_a_weight_angle_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "slide.csv"
    rows = np.transpose([TIME_S, np.sin(TIME_S), np.sign(np.cos(TIME_S)), TIME_S])
    header = "time_s,position_m,friction_n,weight_angle_rad"
    np.savetxt(file, rows, "%.9g", ",", header=header, comments="")
    with pytest.raises(jbf.InputError, match="weight_angle_rad"):
        jbf.read_run(file, jbf.Rig(drive=jbf.Drive("linear", "force")))
