"""Recorded load and temperature: their use in predictions, and recovery of their effects."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from by_hand import Array
from campaigns import campaign
from jbf import Model, Rig, Run, diagnose, fit
from jbf.errors import InputError
from jbf.estimation.campaign import Campaign
from jbf.estimation.problem import Problem
from jbf.records.rig import Lubricant
from rigsim import axis_campaign

TIME = 0.02 * np.arange(3000)
BODY_C = 20.0 + 12.0 * (1.0 - np.exp(-TIME / 25.0))
"""A body that warms with a time constant of 25 s."""
DRY, VISCOUS = "dry_temperature_dependence", "viscous_temperature_dependence"
COULOMB: dict[str, Any] = {"law": "coulomb"}
EXTENDED = pytest.mark.extended


def slide_run(celsius: Array | None, name: str = "run", seed: int = 3) -> Run:
    v = 0.1 * np.sin(0.5 * TIME)
    noise = 0.2 * np.random.default_rng(seed).standard_normal(len(TIME))
    force = 6.0 * np.sign(v) + 40.0 * v + noise
    return Run.from_arrays(TIME, v, force, temperature_c=celsius, name=name)


def drive_runs(seed: int, *effects: str, **options: Any) -> list[Run]:
    runs = []
    for r in axis_campaign(seed, effects, **options)[0]:
        columns = {"position_m": r.path, "load_n": r.load_n, "temperature_c": r.temperature_c}
        runs.append(Run.from_arrays(r.time_s, r.velocity, r.force_n, name=r.name, **columns))
    return runs


def test_run_without_temperature_is_rejected_if_the_model_requires_one() -> None:
    model = Model(Rig(), effects=[DRY], **COULOMB)
    assert np.isfinite(model.predict(slide_run(BODY_C))).all()
    with pytest.raises(InputError, match=f"temperature_c.*{DRY}"):
        model.predict(slide_run(None))
    with pytest.raises(InputError, match="temperature_c"):
        fit(Rig(), [slide_run(None)], [DRY], **COULOMB)


def test_mean_of_a_noisy_load_is_used_in_predictions_and_in_resampled_runs() -> None:
    """Interpolated noise is not white and would not be recognised as noise."""
    v, model = 0.1 * np.sin(0.5 * TIME), Model(Rig.thesis())
    load = 104.0 * (1.0 + 0.03 * np.random.default_rng(0).standard_normal(len(TIME)))
    mean = np.full(len(TIME), np.mean(load))
    found, expected = (model.predict(Run.from_arrays(TIME, v, load_n=n)) for n in (load, mean))
    np.testing.assert_array_equal(found, expected)
    force = 20.0 * np.tanh(v / 0.002) + 0.3 * np.random.default_rng(9).standard_normal(len(TIME))
    run = Run.from_arrays(TIME, v, force, load_n=load)
    (prepared,) = Campaign.prepare(Rig.thesis(), [run]).prepared
    for other in (prepared.shifted(7e-3, 0.0).run, prepared.run.at(TIME[:-1] + 3e-3, TIME[:-1])):
        np.testing.assert_allclose(np.asarray(other.load_n), np.mean(load))


def test_prediction_scales_dry_and_viscous_friction_with_the_temperature() -> None:
    """`F_c (1 + a (T - T_0)) sign(v) + F_v exp(B / (T + 95) - B / (T_0 + 95)) v`."""
    run = slide_run(BODY_C)
    values = {"F_c": 6.0, "F_s": 6.0, "F_v": 40.0}
    own = {f"{DRY}.a": -0.01, f"{DRY}.T_0": 25.0, f"{VISCOUS}.B": 700.0, f"{VISCOUS}.T_0": 20.0}
    model = Model(Rig(), effects=[DRY, VISCOUS], parameters={**values, **own}, **COULOMB)
    law = Model(Rig(), parameters=values, **COULOMB)
    v = (law.predict(run) - 6.0 * np.sign(run.velocity)) / 40.0
    viscosity = np.exp(700.0 / (BODY_C + 95.0) - 700.0 / 115.0)
    expected = 6.0 * (1.0 - 0.01 * (BODY_C - 25.0)) * np.sign(v) + 40.0 * viscosity * v
    moving = np.abs(v) > 0.005
    np.testing.assert_allclose(model.predict(run)[moving], expected[moving], atol=1e-9)


def test_reference_temperature_is_that_of_the_lubricant_or_the_mean_of_the_record() -> None:
    def fixed(rig: Rig, effect: str, law: str) -> dict[str, float]:
        campaign_ = Campaign.prepare(rig, [slide_run(BODY_C)])
        problem = Problem(campaign_, law, "journal", (effect,))
        assert not {problem.names[i] for i in problem.open} & set(problem.fixed)
        return problem.fixed

    assert fixed(Rig(), DRY, "coulomb") == {f"{DRY}.T_0_c": round(float(np.mean(BODY_C)))}
    rig = replace(Rig.thesis(), lubricant=Lubricant(0.002, 40.0))
    expected = {"vogel_viscosity.C_c": -95.0, "vogel_viscosity.T_0_c": 40.0}
    assert fixed(rig, "vogel_viscosity", "journal") == expected


def test_fit_does_not_depend_on_the_reference_temperature() -> None:
    """With a (T - T_0) the coefficient for another reference T_1 is `a / (1 + a (T_1 - T_0))`."""
    runs = drive_runs(31, DRY, runs=3)
    found = fit(Rig(), runs, [DRY], **COULOMB)
    reference = found[f"{DRY}.T_0"]
    assert reference.held
    assert reference.stderr is None
    assert not found[f"{DRY}.a"].held
    other = fit(Rig(), runs, [DRY], fixed={f"{DRY}.T_0": 10.0}, **COULOMB)
    assert other.rms == pytest.approx(found.rms, rel=1e-6)
    slope = found[f"{DRY}.a"].value
    expected = slope / (1.0 + slope * (10.0 - reference.value))
    assert other[f"{DRY}.a"].value == pytest.approx(expected, rel=1e-3)


def warming_slide(step_s: float, *, also_warm: bool = False) -> list[Run]:
    """Three runs with a cold start, whose dry friction falls with warming, and a warm run."""
    random = np.random.default_rng(1)
    time = np.arange(0.0, 40.0, step_s)
    runs = []
    for k in range(4 if also_warm else 3):
        v = (0.02 + 0.005 * k) * np.sin((0.9 + 0.2 * k) * time + k)
        cold = np.exp(-time / 12.0) if k < 3 else np.zeros(len(time))
        force = 6.0 * (1.0 + 0.25 * cold) * np.sign(v) + 0.2 * random.standard_normal(len(time))
        path = np.concatenate(([0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(time))))
        celsius = 34.0 - 16.0 * cold
        columns = {"position_m": path, "temperature_c": celsius}
        runs.append(Run.from_arrays(time, v, force, name=f"run_{k}", **columns))
    return runs


def test_temperature_coefficient_of_dry_friction_is_recovered_within_its_error() -> None:
    """Friction `6 (1 + 0.25 (34 - T) / 16)` has a known relative slope at the reference T_0."""
    found = fit(Rig(), warming_slide(0.04, also_warm=True), [DRY], **COULOMB)
    reference = found[f"{DRY}.T_0"].value
    level = 1.0 + 0.25 * (34.0 - reference) / 16.0
    slope = found[f"{DRY}.a"]
    assert abs(slope.value + 0.25 / 16.0 / level) < 4.0 * slope.stderr
    assert slope.stderr < 0.1 * abs(slope.value)
    assert found.rms == pytest.approx(0.2, rel=0.05)


@EXTENDED
def test_diagnosis_is_ambiguous_if_temperature_is_confounded_with_time() -> None:
    found = diagnose(Rig(), warming_slide(0.08), **COULOMB)
    assert found.verdict == "ambiguous"
    (name,) = found.effects
    assert {name, *found.alternatives[name]} >= {"warm_up", DRY}
    assert found.next_experiment is not None


@EXTENDED
@pytest.mark.parametrize(("step_s", "also_warm"), [(0.08, True), (0.01, False)])
def test_temperature_effect_is_identified_if_one_run_is_warm_or_sampling_is_dense(
    step_s: float, also_warm: bool
) -> None:
    found = diagnose(Rig(), warming_slide(step_s, also_warm=also_warm), **COULOMB)
    assert (found.verdict, found.effects) == ("missing", (DRY,))


@EXTENDED
@pytest.mark.parametrize("course", ["wandering", "warming", "days"])
def test_no_temperature_effect_is_diagnosed_if_friction_is_independent_of_it(course: str) -> None:
    found = diagnose(Rig(), drive_runs(33, temperature=course), **COULOMB)
    assert (found.verdict, found.effects) == ("adequate", ())
    assert not {DRY, VISCOUS} & set(found.not_tried)


@EXTENDED
@pytest.mark.xfail(strict=True, reason="the verdict is unexplained: a coarse thermometer's steps")
def test_dry_and_viscous_temperature_dependence_are_named_with_a_coarse_thermometer() -> None:
    found = diagnose(Rig(), drive_runs(32, DRY, VISCOUS, thermometer="coarse"), **COULOMB)
    assert (found.verdict, set(found.effects)) == ("missing", {DRY, VISCOUS})
    assert "held_samples" in {f.kind for f in found.findings if f.channel == "temperature_c"}


@EXTENDED
def test_temperature_dependence_of_the_viscosity_of_a_bearing_is_recovered() -> None:
    rig, runs, truth = campaign(71, ("vogel_viscosity",))
    found = diagnose(rig, runs)
    assert (found.verdict, found.effects) == ("missing", ("vogel_viscosity",))
    assert not any(found.alternatives.values())
    steepness = found.model.parameters["vogel_viscosity.B_k"]
    expected = truth["effects"]["vogel_viscosity"]["B"]
    assert abs(steepness.value - expected) < 4.5 * steepness.stderr + 0.02 * expected
