"""Effects of simulated bearings, slides and joints that the base law lacks: diagnosis and fit."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from by_hand import assert_recovered
from campaigns import campaign
from golden import axis_run, golden
from input_errors import input_error
from jbf import Diagnosis, Drive, Model, Parameter, Rig, Run, diagnose, fit
from jbf import effects as catalogue
from known_motions import integrated
from linear_campaigns import linear_diagnosis, linear_runs
from rigsim import AXIS_EFFECTS, OF_TEMPERATURE, AxisRun, axis_campaign
from rigsim.warmth import REFERENCE_C
from shared import shared

# Seeds depend on the position in this list.
LAST = ("backlash", "time_delay", "load_dependence")
OF_BEARINGS = [name for name, page in catalogue().items() if "journal" not in page.refused]
EFFECTS = (*(name for name in OF_BEARINGS if name not in LAST), *LAST)


@shared
def _diagnosis(name: str) -> tuple[Diagnosis, float]:
    """Diagnosis of a bearing with one simulated effect, and the noise (N)."""
    loads = (("two_way_0.25", 0.7), ("stop_and_go", 0.7), ("two_way_2", 1.35))
    several = loads if name == "load_dependence" else ()
    rig, runs, truth = campaign(EFFECTS.index(name) + 30, (name,), loads=several)
    return diagnose(rig, runs), truth["noise_n"]


@pytest.mark.extended
@pytest.mark.parametrize("name", EFFECTS)
def test_effect_hidden_in_a_bearing_is_named_and_the_error_falls_to_the_noise(name: str) -> None:
    found, noise_rms = _diagnosis(name)
    assert (found.verdict, found.effects) == ("missing", (name,)), found.summary()
    assert found.alternatives == {name: ()}
    first, last = found.steps[0], found.steps[-1]
    assert first.rms > last.rms
    assert first.held_out_rms > last.held_out_rms
    assert last.rms < 1.03 * noise_rms
    # The only run with rests has forces of 30 N, the others of at most 12 N: neither its breakaway
    # friction nor the nonlinearity of the sensor at this force is predicted by the others.
    if name not in ("dwell_stiction", "sensor_nonlinearity"):
        assert last.held_out_rms < 1.06 * noise_rms


@pytest.mark.extended
@pytest.mark.parametrize("name", EFFECTS)
def test_noise_floor_of_a_diagnosis_is_the_noise_of_the_simulation(name: str) -> None:
    found, noise_rms = _diagnosis(name)
    assert found.steps[-1].noise_rms == pytest.approx(noise_rms, rel=0.08)


@pytest.mark.extended
def test_diagnosis_of_a_bearing_with_coloured_noise_and_no_effect_is_adequate() -> None:
    found = diagnose(*campaign(7, coloured=True)[:2])
    assert (found.verdict, found.effects, found.residual_structure) == ("adequate", (), ())


def test_every_effect_that_the_records_of_a_bearing_can_show_is_tried() -> None:
    found = golden("bearing_nothing_missing")
    not_shown = {"load_dependence", "vogel_viscosity"}
    assert {trial.effect for trial in found.steps[0].trials} == set(EFFECTS) - not_shown
    assert not_shown <= set(found.not_tried)
    assert "same load" in found.not_tried["load_dependence"]


@pytest.mark.extended
def test_simulated_delay_is_named_together_with_a_resonance_of_the_drive() -> None:
    rig, runs, truth = campaign(202, ("drive_compliance", "time_delay"))
    found = diagnose(rig, runs)
    assert found.verdict == "missing", found.summary()
    assert set(found.effects) == {"drive_compliance", "time_delay"}
    assert found.steps[-1].rms < 1.05 * truth["noise_n"]


def test_effects_that_require_a_path_or_a_load_are_not_tried_without_one() -> None:
    found = linear_diagnosis("nothing")
    not_shown = {"drive_compliance", "gravity", "cogging", "dry_load_dependence"}
    assert not_shown <= set(found.not_tried)
    assert not not_shown & {trial.effect for trial in found.steps[0].trials}


def test_diagnosis_of_a_single_run_names_the_mass_or_an_alternative() -> None:
    found = diagnose(Rig(), linear_runs("mass")[:1], law="coulomb")
    assert found.verdict in ("missing", "ambiguous")
    alternatives = {other for others in found.alternatives.values() for other in others}
    assert "inertia" in {*found.effects, *alternatives}


STEP_S, NOISE_N = 0.01, 0.1
LEVEL_N, PEAK_N, PEAK_M_S, SLOPE_N_S_M = 6.0, 3.0, 0.02, 40.0


def _slide(
    dry: float = 0.0, peak: float = 0.0, slope: float = 0.0, offset_n: float = 0.0
) -> list[Run]:
    """A Stribeck curve whose parts are larger in positive motion, with rests."""
    records, t = [], np.arange(0.0, 24.0, STEP_S)
    phase = np.mod(t, 6.0)
    for i in range(4):
        random = np.random.default_rng([4120, i])
        v = 0.08 * np.sin((0.5 + 0.2 * i) * t + i) + 0.05 * np.sin(1.7 * t + 2.0 * i)
        v = v * np.where(phase < 4.0, np.sin(0.25 * np.pi * phase) ** 2, 0.0)
        sign = np.sign(v)
        level = LEVEL_N * (1.0 + dry * sign)
        level += PEAK_N * (1.0 + peak * sign) * np.exp(-((v / PEAK_M_S) ** 2))
        force = sign * level + SLOPE_N_S_M * (1.0 + slope * sign) * v + offset_n
        force = force + NOISE_N * random.standard_normal(len(t))
        records.append(Run.from_arrays(t, v, force, position_m=integrated(v, STEP_S), name=f"{i}"))
    return records


@pytest.mark.extended
@pytest.mark.parametrize(
    ("change", "effects"),
    [
        ({}, ()),
        ({"dry": 0.1, "peak": 0.1}, ("dry_asymmetry",)),
        ({"peak": 0.35}, ("stribeck_asymmetry",)),
        ({"slope": 0.2}, ("viscous_asymmetry",)),
        ({"dry": 0.1, "peak": 0.1, "slope": 0.1}, ("direction_asymmetry",)),
        # An offset and an asymmetry can be separated only with rests.
        ({"offset_n": 0.6}, ("sensor_offset",)),
    ],
)
def test_part_of_the_friction_that_depends_on_direction_is_named(
    change: dict[str, float], effects: tuple[str, ...]
) -> None:
    found = diagnose(Rig(), _slide(**change), law="stribeck")
    assert (found.verdict, found.effects) == ("missing" if effects else "adequate", effects)
    assert found.steps[-1].rms == pytest.approx(NOISE_N, rel=0.05)


OF_DRIVES = [name for name, page in catalogue().items() if "journal" in page.refused]
REQUIRED: dict[str, tuple[str, ...]] = {
    "torque_proportional": ("gravity",),
    "cogging_2": ("cogging",),
    "pitch_ripple_2": ("pitch_ripple",),
}
"""Effects on which the influence of another effect depends."""
SWING = 8.0
"""Ratio of the motion of a joint that carries a weight to that of a slide."""
FAST_FITS = (
    "gravity",
    "torque_proportional",
    "viscous_temperature_dependence",
)


def _page(name: str) -> Parameter:
    effect, _, short = name.partition(".")
    return next(p for p in catalogue()[effect].parameters if p.name == short)


def _with_required(name: str) -> tuple[str, ...]:
    return (*REQUIRED.get(name, ()), name)


def _runs(records: list[AxisRun], path: str) -> list[Run]:
    return [axis_run(record, path) for record in records]


@cache
def _drive(seed: int, *effects: str) -> tuple[list[Run], dict[str, Any]]:
    """Runs and true parameters of a simulated drive; a joint has an angle, a slide a position.

    The rotation of the joint is too small to distinguish a spring from a weight.
    """
    swing = SWING if "torque_proportional" in effects else 1.0
    records, truth = axis_campaign(seed, effects, swing=swing)
    joint = "gravity" in effects or (seed % 2 == 0 and "spring" not in effects)
    return _runs(records, "angle_rad" if joint else "position_m"), truth


def test_independent_simulator_has_every_effect_of_slides_and_joints() -> None:
    assert set(OF_DRIVES) <= set(AXIS_EFFECTS)


@pytest.mark.parametrize(
    "name",
    [n if n in FAST_FITS else pytest.param(n, marks=pytest.mark.extended) for n in OF_DRIVES],
)
def test_fit_with_the_true_effects_recovers_the_parameters_of_a_drive(name: str) -> None:
    hidden = _with_required(name)
    runs, truth = _drive(11, *hidden)
    drawn = {
        f"{effect}.{page.name}": value
        for effect in hidden
        for page in catalogue()[effect].parameters
        for key, value in truth["effects"][effect].items()
        if page.name.startswith(key)
    }
    stated = {f"{name}.T_0_c": REFERENCE_C} if name in OF_TEMPERATURE else {}
    stated |= {n: v for n, v in drawn.items() if _page(n).stated}
    true = {n: v for n, v in drawn.items() if n not in stated}
    # Two waves may be interchanged unless each starts at its true pitch.
    start = {n: v for n, v in true.items() if name.endswith("_2") and n.endswith("pitch")}
    fixed = {"F_s": 10.0, **stated}
    found = fit(Rig(), runs, hidden, law="coulomb", fixed=fixed, start=start)
    assert found.converged
    assert found.rms == pytest.approx(truth["noise_n"], rel=0.03)
    for parameter, value in stated.items():
        assert found[parameter].value == value
    periods = {n: _page(n).period for n in true}
    for parameter, value in {**truth["law"], **true}.items():
        estimate, period = found[parameter], periods.get(parameter)
        turns = 0.0 if period is None else period * np.round((estimate.value - value) / period)
        assert_recovered(
            replace(estimate, value=estimate.value - turns), value, errors=4.5, share=0.01
        )


# An asymmetry of a constant dry friction is equivalent to an offset in any motion.
@pytest.mark.extended
@pytest.mark.parametrize("name", [n for n in OF_DRIVES if n != "dry_asymmetry"])
def test_hidden_effect_of_a_drive_is_named_without_alternatives(name: str) -> None:
    hidden = _with_required(name)
    found = diagnose(Rig(), _drive(12, *hidden)[0], law="coulomb")
    assert (found.verdict, set(found.effects)) == ("missing", set(hidden))
    assert not any(found.alternatives.values())


@cache
def _joint_with_spring(swing: float) -> tuple[Diagnosis, float]:
    """Diagnosis of a joint with a spring, and the true stiffness (N m/rad)."""
    records, truth = axis_campaign(18, ("spring",), swing=swing, runs=2)
    rig = Rig(drive=Drive("rotary", "torque"))
    hidden: Any = truth["effects"]
    return diagnose(rig, _runs(records, "angle_rad"), law="coulomb"), hidden["spring"]["k"]


def test_spring_of_a_joint_with_a_large_rotation_is_named() -> None:
    found, stiffness = _joint_with_spring(SWING)
    assert (found.verdict, found.effects, found.machine) == ("missing", ("spring",), ())
    assert found.alternatives == {"spring": ()}
    assert_recovered(found.model.parameters["spring.k"], stiffness, errors=4.5, share=0.01)


def test_spring_of_a_joint_with_a_small_rotation_is_an_alternative_to_a_weight() -> None:
    found, _ = _joint_with_spring(1.0)
    assert (found.verdict, found.machine) == ("adequate", ("gravity",)), found.summary()
    assert found.alternatives == {"gravity": ("spring",)}
    assert "gravity cannot be distinguished from spring" in " ".join(found.summary().split())


@pytest.mark.extended
def test_running_in_of_a_simulated_drive_is_named_without_alternatives() -> None:
    records, truth = axis_campaign(16)
    law: Any = truth["law"]
    for r in records:
        slid_m = np.cumsum(np.abs(r.velocity)) * 0.01
        r.force_n[:] += 0.3 * law["F_c"] * np.sign(r.velocity) * np.exp(-slid_m / 0.8)
    found = diagnose(Rig(), _runs(records, "angle_rad"), law="coulomb")
    assert (found.verdict, found.effects) == ("missing", ("running_in",))
    assert found.alternatives == {"running_in": ()}


def test_gear_losses_are_fitted_as_an_efficiency_ratio_and_a_scaled_weight() -> None:
    """Losses of 0.3 when driving and 0.1 when driven multiply the estimated weight by 1.1."""
    records, truth = axis_campaign(17, ("gravity",), swing=SWING, runs=3)
    hidden: Any = truth["effects"]
    gravity = hidden["gravity"]
    for r in records:
        weight = gravity["G"] * np.sin(r.path - gravity["theta_0"])
        r.force_n[:] += np.where(weight * r.velocity > 0.0, 0.3, -0.1) * weight
    effects = ("gravity", "torque_proportional")
    found = fit(Rig(), _runs(records, "angle_rad"), effects, law="coulomb")
    assert found.rms == pytest.approx(truth["noise_n"], rel=0.03)
    share, weight_n = found["torque_proportional.mu"], found["gravity.G"]
    for estimate, value in ((share, 0.2 / 1.1), (weight_n, 1.1 * gravity["G"])):
        assert_recovered(estimate, value, errors=4.5, share=0.01)
    assert (1.0 - share.value) / (1.0 + share.value) == pytest.approx(0.9 / 1.3, rel=0.02)


def test_torque_proportional_friction_is_held_if_no_torque_is_transmitted() -> None:
    found = fit(Rig(), _drive(12)[0], ["torque_proportional"], law="coulomb")
    share = found["torque_proportional.mu"]
    assert (share.held, share.stderr) == (True, None)


def test_load_parameter_is_the_same_with_a_recorded_pressure() -> None:
    name = "dry_load_dependence"
    records, truth = _drive(13, name)
    runs = records[:3]  # one run at each load
    pressed = [
        replace(r, load_n=None, extra={"pressure_pa": 1e5 * np.asarray(r.load_n)}) for r in runs
    ]
    by_load, by_pressure = (
        fit(Rig(), some, [name], law="coulomb", fixed={"F_s": 10.0}) for some in (runs, pressed)
    )
    assert by_pressure[f"{name}.mu"].value == pytest.approx(by_load[f"{name}.mu"].value, rel=1e-6)
    assert by_load[f"{name}.mu"].value == pytest.approx(truth["effects"][name]["mu"], rel=0.05)


@pytest.mark.parametrize("name", OF_DRIVES)
def test_effect_of_slides_and_joints_is_rejected_for_a_bearing(name: str) -> None:
    error = input_error(Model, Rig.thesis(), effects=[name])
    assert name in str(error)


@pytest.mark.extended
def test_filter_that_smooths_the_noise_of_a_recorded_load_is_not_named() -> None:
    """The noise of the load causes 2 % of the mean square residual, and a filter halves it."""
    runs = []
    for k in range(4):
        random, t = np.random.default_rng(k), 0.005 * np.arange(4000)
        v = 0.1 * np.sin((1.0 + 0.5 * k) * t)
        load = 100.0 * 2.0**k + 20.0 * np.sin(0.7 * t + k)
        force = (5.0 + 0.5 * load) * np.sign(v) + 60.0 * v + random.normal(size=4000)
        read = load + 0.3 * random.normal(size=4000)
        runs.append(Run.from_arrays(t, v, force, load_n=read, name=f"run{k}"))
    found = diagnose(Rig(), runs, law="coulomb")
    assert (found.verdict, found.effects) == ("missing", ("dry_load_dependence",))
