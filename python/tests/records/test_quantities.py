"""Records of a slide and of a joint with equal numbers in the units of each drive."""

import re
from functools import cache
from pathlib import Path
from typing import Any

import jbf
import pytest
from jbf import Comparison, Diagnosis, Fit, Model, Rig, Run
from jbf.cli import main
from jbf.models.catalogue import laws, parameters_of
from jbf.models.parameter_units import unit_of, units_of
from jbf.records.drive import Drive
from jbf.records.quantities import BEARING, LINEAR, ROTARY
from jbf.records.run_requirements import run_on
from rigsim import AxisRun, axis_campaign

SLIDE = Rig(drive=Drive("linear", "force"))
JOINT = Rig(drive=Drive("rotary", "current", torque_constant_n_m_a=0.5, inertia_kg_m2=4.0))
HIDDEN = ("inertia", "sensor_offset")
LINEAR_UNIT = re.compile(r"\bN\b(?! m)|(?<!N )\bm/s\b|\d m\b|\(m\)")
"""Units that a rotary drive does not have."""
TORQUE_SCALE, ANGLE_SCALE = 1.0 / 3000.0, 30.0
PARAMETER_SCALES = {
    "F_c": TORQUE_SCALE,
    "F_v": TORQUE_SCALE / ANGLE_SCALE,
    "inertia.m_e": TORQUE_SCALE / ANGLE_SCALE,
    "sensor_offset.b": TORQUE_SCALE,
}


@cache
def records() -> list[AxisRun]:
    return axis_campaign(21, HIDDEN)[0]


def runs_of(rig: Rig, torque: float = 1.0, angle: float = 1.0) -> list[Run]:
    """The records as runs of a rig, with forces and motions multiplied by these factors."""
    runs = []
    for r in records():
        place: Any = {"position_m" if rig == SLIDE else "angle_rad": angle * r.path}
        runs.append(Run.from_arrays(r.time_s, angle * r.velocity, torque * r.force_n, **place))
    return runs


@cache
def fitted(rig: Rig) -> Fit:
    return jbf.fit(rig, runs_of(rig)[:2], HIDDEN, law="coulomb")


@cache
def compared(rig: Rig) -> Comparison:
    model = Model(rig, "coulomb", parameters={"F_c": 4.0, "F_v": 20.0})
    return jbf.compare(model, runs_of(rig)[:1])


@cache
def diagnosed(rig: Rig, torque: float = 1.0, angle: float = 1.0) -> Diagnosis:
    return jbf.diagnose(rig, runs_of(rig, torque, angle), law="coulomb")


def test_fit_of_a_joint_equals_that_of_a_slide_with_the_same_numbers() -> None:
    slide, joint = fitted(SLIDE), fitted(JOINT)
    assert (slide.params, slide.rms) == (joint.params, joint.rms)


def assert_scaled(large: Fit, small: Fit) -> None:
    for name, factor in PARAMETER_SCALES.items():
        assert small[name].value == pytest.approx(factor * large[name].value, rel=1e-4), name
        assert small[name].stderr == pytest.approx(factor * large[name].stderr, rel=0.02), name


def test_estimates_and_standard_errors_scale_with_torque_and_angle() -> None:
    """Millinewton metres and tens of radians per second instead of newton metres and radians."""
    runs = runs_of(JOINT, TORQUE_SCALE, ANGLE_SCALE)[:2]
    small = jbf.fit(JOINT, runs, HIDDEN, law="coulomb")
    assert_scaled(fitted(JOINT), small)


@pytest.mark.extended
def test_diagnosis_finds_the_same_machine_terms_if_force_and_position_are_scaled() -> None:
    large, small = diagnosed(SLIDE), diagnosed(SLIDE, TORQUE_SCALE, ANGLE_SCALE)
    for found in (large, small):
        assert (found.verdict, found.effects) == ("adequate", ()), found.summary()
        assert set(found.machine) == set(HIDDEN)
    assert_scaled(large.fit, small.fit)


def reported_units(fit: Fit) -> dict[str, str]:
    """Unit of each estimate in the text of a fit."""
    text = fit.report().partition("\n[[Correl")[0].partition("\nWhat")[0]
    lines = [line for line in text.splitlines() if "+/-" in line]
    return {line.split()[0]: line.split("  ")[-1].strip() for line in lines}


def test_fit_report_has_parameter_names_and_units_of_a_joint_or_slide() -> None:
    joint, slide = reported_units(fitted(JOINT)), reported_units(fitted(SLIDE))
    effects = {"inertia.m_e": "kg m^2", "sensor_offset.b": "N m"}
    assert joint == {"F_c": "N m", "F_v": "N m s/rad"} | effects
    effects = {"inertia.m_e": "kg", "sensor_offset.b": "N"}
    assert slide == {"F_c": "N", "F_v": "N s/m"} | effects


def test_comparison_plot_labels_have_the_units_of_a_joint_or_slide() -> None:
    for result, speed, friction in (
        (compared(JOINT), "Speed (rad/s)", "Friction torque (N m)"),
        (compared(SLIDE), "Speed (m/s)", "Friction force (N)"),
    ):
        axes = result.plot()[0]
        assert (axes.get_xlabel(), axes.get_ylabel()) == (speed, friction)


def test_json_of_a_comparison_has_the_units_of_the_rig() -> None:
    assert compared(JOINT).to_dict()["units"] == ROTARY.to_dict()
    assert compared(SLIDE).to_dict()["units"]["force"] == "N"
    plain = jbf.compare(Model(Rig(), law="coulomb"), runs_of(SLIDE)[:1]).to_dict()
    assert plain["units"] == {"force": "N", "motion": "m", "velocity": "m/s"}


def test_prediction_file_of_a_rotary_joint_has_a_torque_column(tmp_path: Path) -> None:
    fitted(JOINT).model.save(tmp_path / "model.toml")
    run_on(JOINT, runs_of(JOINT)[0]).write_csv(tmp_path / "run.csv")
    names = [str(tmp_path / name) for name in ("model.toml", "run.csv", "out.csv")]
    assert main(["predict", *names[:2], "--out", names[2]]) == 0
    assert (tmp_path / "out.csv").read_text().startswith("time_s,torque_n_m\n")


def test_catalogue_units_are_converted_to_those_of_a_linear_or_rotary_drive() -> None:
    units = [ROTARY.unit(si) for si in ("N", "N s/m", "N/m", "kg", "m", "1/N^2", "s")]
    assert units == ["N m", "N m s/rad", "N m/rad", "kg m^2", "rad", "1/(N m)^2", "s"]
    assert [LINEAR.unit(si) for si in ("N m/rad", "kg m^2", "N")] == ["N/m", "kg", "N"]
    assert BEARING.unit("N m/rad") == "N m/rad"


def test_load_coefficients_are_forces_for_a_drive_but_ratios_for_a_bearing() -> None:
    chosen = ("presliding", "stribeck_excess", "dwell_stiction")
    for quantities, force, stiffness in ((LINEAR, "N", "N/m"), (ROTARY, "N m", "N m/rad")):
        units = units_of("coulomb", chosen, quantities)
        assert units["presliding.sigma"] == stiffness
        assert units["stribeck_excess.a"] == units["dwell_stiction.a"] == force
    units = units_of("journal", chosen, BEARING)
    assert units["presliding.sigma"] == "1/m"
    assert units["stribeck_excess.a"] == ""


@pytest.mark.parametrize("law", [name for name, page in laws().items() if not page.needs_bearing])
def test_drive_parameter_has_the_units_of_its_motion(law: str) -> None:
    effects = tuple(name for name, page in jbf.effects().items() if law not in page.refused)
    known = parameters_of(law, effects)
    for name, page in known.items():
        rotary, linear = (unit_of(name, page, law, q) for q in (ROTARY, LINEAR))
        assert LINEAR_UNIT.search(rotary) is None, name
        assert rotary not in ("m", "kg", "1/m", "s/m"), name
        assert "N m" not in linear, name
        assert linear not in ("1/m", "kg m^2"), name
